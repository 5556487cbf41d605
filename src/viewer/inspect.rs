//! Looking at a resource: what its numbers are, and how they are shown.

/// What is shown of a texture's texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channel {
    #[default]
    Rgb,
    Red,
    Green,
    Blue,
    Alpha,
    /// The length of the first three, for vectors.
    Length,
}

impl Channel {
    pub const ALL: [Channel; 6] =
        [Channel::Rgb, Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha, Channel::Length];

    pub fn name(self) -> &'static str {
        match self {
            Channel::Rgb => "RGB",
            Channel::Red => "R",
            Channel::Green => "G",
            Channel::Blue => "B",
            Channel::Alpha => "A",
            Channel::Length => "length",
        }
    }

    /// Whether texels of so many channels have it.
    pub fn is_there(self, channels: u32) -> bool {
        match self {
            Channel::Red => true,
            Channel::Green => channels >= 2,
            Channel::Rgb | Channel::Blue => channels >= 3,
            Channel::Alpha => channels >= 4,
            Channel::Length => channels >= 2,
        }
    }

    /// What shows most of texels of so many channels.
    pub fn usual(channels: u32) -> Self {
        if channels >= 3 { Channel::Rgb } else { Channel::Red }
    }

    /// The numbers of a texel that count.
    fn of(self, texel: &[f32; 4]) -> ([f32; 3], usize) {
        let [r, g, b, a] = *texel;
        match self {
            Channel::Rgb => ([r, g, b], 3),
            Channel::Red => ([r; 3], 1),
            Channel::Green => ([g; 3], 1),
            Channel::Blue => ([b; 3], 1),
            Channel::Alpha => ([a; 3], 1),
            Channel::Length => ([(r * r + g * g + b * b).sqrt(); 3], 1),
        }
    }
}

/// Bars of a histogram.
pub const BARS: usize = 96;

/// What numbers there are.
#[derive(Clone, Debug, PartialEq)]
pub struct Stats {
    /// Of those that are finite; absent if none is.
    pub range: Option<[f32; 2]>,
    pub mean: f64,
    pub nans: usize,
    pub infinities: usize,
    pub count: usize,
    /// How many numbers lie in each of [`BARS`] equal parts of the range.
    pub histogram: Vec<u32>,
}

impl Stats {
    pub fn of_texels(texels: &[[f32; 4]], channel: Channel) -> Self {
        let numbers = texels.iter().flat_map(|texel| {
            let (numbers, count) = channel.of(texel);
            numbers.into_iter().take(count)
        });
        Self::of(numbers)
    }

    pub fn of(numbers: impl Iterator<Item = f32> + Clone) -> Self {
        let (mut low, mut high, mut sum) = (f32::INFINITY, f32::NEG_INFINITY, 0.0);
        let (mut nans, mut infinities, mut count) = (0, 0, 0);
        for x in numbers.clone() {
            count += 1;
            if x.is_nan() {
                nans += 1;
            } else if x.is_infinite() {
                infinities += 1;
            } else {
                (low, high) = (low.min(x), high.max(x));
                sum += f64::from(x);
            }
        }
        let finite = count - nans - infinities;
        let range = (finite > 0).then_some([low, high]);
        let mut histogram = vec![0; BARS];
        if let Some([low, high]) = range {
            let scale = BARS as f64 / (f64::from(high) - f64::from(low)).max(f64::MIN_POSITIVE);
            for x in numbers.filter(|x| x.is_finite()) {
                let bar = ((f64::from(x) - f64::from(low)) * scale) as usize;
                histogram[bar.min(BARS - 1)] += 1;
            }
        }
        Self { range, mean: sum / finite.max(1) as f64, nans, infinities, count, histogram }
    }

    /// The range that shows most: outliers of one in a thousand on each side are left out.
    pub fn usual_range(&self) -> [f32; 2] {
        let Some([low, high]) = self.range else { return [0.0, 1.0] };
        if low == high {
            return if (0.0..=1.0).contains(&low) { [0.0, 1.0] } else { [low - 0.5, low + 0.5] };
        }
        let all: u64 = self.histogram.iter().map(|n| u64::from(*n)).sum();
        let spare = all / 1000;
        let width = (f64::from(high) - f64::from(low)) / BARS as f64;
        let first = skip(self.histogram.iter(), spare);
        let last = skip(self.histogram.iter().rev(), spare);
        let from = f64::from(low) + width * first as f64;
        let to = f64::from(high) - width * last as f64;
        if to > from { [from as f32, to as f32] } else { [low, high] }
    }
}

/// How many bars hold no more than `spare` together.
fn skip<'a>(bars: impl Iterator<Item = &'a u32>, spare: u64) -> usize {
    let mut sum = 0;
    bars.take_while(|n| {
        sum += u64::from(**n);
        sum <= spare
    })
    .count()
}

/// NaN, which stands out of any picture.
pub const NAN: [u8; 3] = [255, 0, 255];
pub const INFINITE: [u8; 3] = [255, 160, 0];

/// Texels as a screen shows them: the range from black to white, as numbers and not as light.
pub fn shown(texels: &[[f32; 4]], channel: Channel, range: [f32; 2]) -> Vec<[u8; 3]> {
    let [low, high] = range.map(f64::from);
    let scale = 255.0 / (high - low).max(f64::MIN_POSITIVE);
    let byte = |x: f32| ((f64::from(x) - low) * scale).round().clamp(0.0, 255.0) as u8;
    texels
        .iter()
        .map(|texel| {
            let (numbers, count) = channel.of(texel);
            let numbers = &numbers[..count];
            if numbers.iter().any(|x| x.is_nan()) {
                NAN
            } else if numbers.iter().any(|x| x.is_infinite()) {
                INFINITE
            } else if let [r, g, b] = numbers {
                [byte(*r), byte(*g), byte(*b)]
            } else {
                [byte(numbers[0]); 3]
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_counted_and_what_is_no_number_apart() {
        let stats = Stats::of([1.0, f32::NAN, 3.0, f32::INFINITY, f32::NEG_INFINITY, 2.0].into_iter());
        assert_eq!((stats.range, stats.nans, stats.infinities, stats.count), (Some([1.0, 3.0]), 1, 2, 6));
        assert!((stats.mean - 2.0).abs() < 1e-12);
        assert_eq!((stats.histogram[0], stats.histogram[BARS - 1]), (1, 1));
        assert_eq!(stats.histogram.iter().sum::<u32>(), 3);
    }

    #[test]
    fn the_usual_range_leaves_few_outliers_out() {
        let calm = (0..10_000).map(|i| (i % 100) as f32 * 0.01);
        let stats = Stats::of(calm.chain([1e3, -1e3]));
        let [low, high] = stats.usual_range();
        assert!(low > -50.0 && high < 50.0, "{low} {high}");
        assert_eq!(Stats::of([f32::NAN].into_iter()).usual_range(), [0.0, 1.0]);
        assert_eq!(Stats::of([7.0].into_iter()).usual_range(), [6.5, 7.5]);
        assert_eq!(Stats::of(std::iter::empty()).usual_range(), [0.0, 1.0]);
        let wide = Stats::of([f32::MIN, f32::MAX].into_iter());
        assert!(wide.usual_range().iter().all(|x| x.is_finite()));
    }

    #[test]
    fn nan_and_infinity_stand_out() {
        let texels = [[0.0, 0.5, 1.0, 1.0], [f32::NAN, 0.0, 0.0, 0.0], [0.0, f32::INFINITY, 0.0, 0.0]];
        assert_eq!(shown(&texels, Channel::Rgb, [0.0, 1.0]), [[0, 128, 255], NAN, INFINITE]);
        assert_eq!(shown(&texels, Channel::Green, [0.0, 1.0])[1], [0; 3]);
        assert_eq!(shown(&texels, Channel::Red, [0.0, 0.0])[0], [0; 3]);
    }

    #[test]
    fn a_format_offers_the_channels_that_it_has() {
        let of = |channels| Channel::ALL.into_iter().filter(|c| c.is_there(channels)).count();
        assert_eq!([of(1), of(2), of(4)], [1, 3, 6]);
        assert_eq!(Channel::usual(1), Channel::Red);
    }
}
