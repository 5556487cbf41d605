//! Numbered files that feed inputs, and which of them shows when.
//!
//! A scene has one line of frames' numbers: that of the files of its first sequence. Others keep to it: their
//! file of the same number shows. One whose files begin later has no particles until then, and each
//! holds its last file.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::assets::Particles;
use super::draw::Moment;
use crate::diagnostic::{Code, Diagnostic};
use crate::scene::particles::Taken;
use crate::scene::sequence::Pattern;

/// A sequence of files that feeds an input.
#[derive(Clone, Debug)]
pub struct Track {
    /// The input.
    pub input: String,
    pub frames: Frames,
    pub taken: Taken,
    /// Metres, of all frames.
    pub radius_m: f64,
    /// In place of each frame's own bounds.
    pub bounds: Option<[[f32; 3]; 2]>,
    /// No particles, with the attributes of those to come: where the files begin later than the scene.
    pub none: Option<Arc<Particles>>,
}

/// The files of a sequence, and when they show.
#[derive(Clone, Debug)]
pub struct Frames {
    pub pattern: Pattern,
    pub numbers: RangeInclusive<u64>,
    /// Frames a second.
    pub rate: f64,
    pub timeline: Timeline,
}

/// The numbers that a scene's frames have, and how many are a second: those of its first sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    pub numbers: RangeInclusive<u64>,
    pub rate: f64,
}

/// When a picture is, as somebody says it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum When {
    #[default]
    Start,
    /// A frame; of a sequence, the file's number.
    Frame(u64),
    /// Seconds since the start.
    Time(f64),
}

impl When {
    /// The moment, in a scene whose first sequence is `track`.
    pub fn moment(self, track: Option<&Track>) -> Moment {
        match (self, track) {
            (When::Start, None) => Moment::default(),
            (When::Frame(frame), None) => Moment::at_frame(frame),
            (When::Time(time_s), None) => Moment::at_time(time_s),
            (when, Some(Track { frames: Frames { timeline, .. }, .. })) => {
                let first = *timeline.numbers.start();
                let frame = match when {
                    When::Start => first,
                    When::Frame(frame) => frame,
                    When::Time(time_s) => return Moment { frame: timeline.number(when, timeline.rate), time_s },
                };
                Moment { frame, time_s: frame.saturating_sub(first) as f64 / timeline.rate }
            }
        }
    }
}

impl Timeline {
    /// The number that a sequence of some rate has come to, which may be beyond its last. All are at the
    /// first together.
    fn number(&self, when: When, rate: f64) -> u64 {
        let first = *self.numbers.start();
        let after = |time_s: f64| first.saturating_add((time_s * rate + 1e-6).floor() as u64);
        match when {
            When::Start => first,
            When::Frame(frame) if rate.total_cmp(&self.rate).is_eq() => frame.max(first),
            When::Frame(frame) => after(frame.saturating_sub(first) as f64 / self.rate),
            When::Time(time_s) => after(time_s),
        }
    }
}

impl Frames {
    /// Those of a scene's first sequence, whose numbers are the scene's.
    pub fn leading(pattern: Pattern, numbers: RangeInclusive<u64>, rate: f64) -> Self {
        let timeline = Timeline { numbers: numbers.clone(), rate };
        Self { pattern, numbers, rate, timeline }
    }

    pub fn first(&self) -> u64 {
        *self.numbers.start()
    }

    pub fn last(&self) -> u64 {
        *self.numbers.end()
    }

    /// The number that shows then: the first or last one where it is out of range.
    pub fn number(&self, when: When) -> u64 {
        self.timeline.number(when, self.rate).clamp(self.first(), self.last())
    }

    /// Whether the scene begins before these do.
    pub fn is_late(&self) -> bool {
        self.first() > *self.timeline.numbers.start()
    }

    /// The frame that is shown then; none before those of a late sequence.
    pub fn frame(&self, when: When) -> Option<u64> {
        let is_before = self.is_late() && self.timeline.number(when, self.rate) < self.first();
        (!is_before).then(|| self.number(when))
    }

    /// Frames that come after that, `count` of them at most.
    pub(super) fn next(&self, when: When, count: u64) -> impl Iterator<Item = u64> + use<> {
        let number = self.timeline.number(when, self.rate);
        let last = number.saturating_add(count).min(self.last());
        number.saturating_add(1).max(self.first())..=last
    }

    /// Whether other particles show at other times.
    pub fn moves(&self) -> bool {
        self.first() < self.last() || self.is_late()
    }

    /// What is told of a frame that the sequence does not have. By time the last one is held after the
    /// scene's end, which is no fault.
    pub(super) fn outside(&self, when: When) -> Option<Diagnostic> {
        let (first, last) = (self.first(), self.last());
        let told = |frame: u64, beyond: &str, shown: u64| {
            let name = self.pattern.name();
            let message = format!("`{name}`: frame {frame} is {beyond} {first} to {last}: {shown} is shown");
            Some(Diagnostic::warning(Code::ASSET_NOTE, message))
        };
        let leads = self.numbers == self.timeline.numbers;
        let number = self.timeline.number(when, self.rate);
        match when {
            When::Frame(frame) if frame < first && leads => told(frame, "before", first),
            When::Time(_) if number > self.timeline.number(When::Frame(*self.timeline.numbers.end()), self.rate) => {
                None
            }
            _ if number > last => told(number, "beyond", last),
            _ => None,
        }
    }
}

/// A fault of a frame that does not end the sequence, since another is shown in its place.
pub(super) fn held(why: Diagnostic, frame: u64, shown: u64) -> Diagnostic {
    let message = format!("frame {frame}: {}: frame {shown} is shown in its place", why.message);
    let warning = Diagnostic::warning(why.id, message);
    why.hints.iter().fold(warning, Diagnostic::hint)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn frames(name: &str, numbers: RangeInclusive<u64>, rate: f64) -> Frames {
        Frames::leading(Pattern::of(Path::new(name)).expect("a pattern"), numbers, rate)
    }

    fn beside(leading: &Frames, numbers: RangeInclusive<u64>, rate: f64) -> Frames {
        Frames { numbers, rate, timeline: leading.timeline.clone(), ..frames("f/foam_##.csv", 0..=0, 1.0) }
    }

    #[test]
    fn time_goes_at_the_rate_from_the_first_frame() {
        let frames = frames("f/p_##.csv", 3..=9, 10.0);
        let track = Track {
            input: "particles".into(),
            frames: frames.clone(),
            taken: Taken::default(),
            radius_m: 0.5,
            bounds: None,
            none: None,
        };
        let at = |when: When| (frames.number(when), when.moment(Some(&track)));
        let moment = |frame, time_s| Moment { frame, time_s };
        assert_eq!(at(When::Start), (3, moment(3, 0.0)));
        assert_eq!(at(When::Frame(5)), (5, moment(5, 0.2)));
        assert_eq!(at(When::Time(0.2)), (5, moment(5, 0.2)));
        assert_eq!(at(When::Time(0.19)), (4, moment(4, 0.19)));
        assert_eq!(at(When::Time(100.0)).0, 9, "the last one stays");
        assert_eq!(When::Frame(30).moment(None), Moment::at_frame(30));
    }

    #[test]
    fn all_sequences_of_a_scene_have_its_numbers() {
        let liquid = frames("f/p_##.csv", 0..=9, 10.0);
        let late = beside(&liquid, 2..=3, 10.0);
        let shown = |when: When| (liquid.frame(when), late.frame(when));
        assert_eq!([0, 1, 2, 3, 4].map(|n| shown(When::Frame(n)).1), [None, None, Some(2), Some(3), Some(3)]);
        assert_eq!(shown(When::Time(0.15)), (Some(1), None));
        assert_eq!(shown(When::Time(0.25)), (Some(2), Some(2)));
        assert_eq!(shown(When::Time(7.0)), (Some(9), Some(3)));
        // Another rate counts from the scene's first number.
        let quick = beside(&liquid, 2..=30, 20.0);
        assert_eq!([0, 1, 2, 3].map(|n| quick.frame(When::Frame(n))), [None, Some(2), Some(4), Some(6)]);
        assert_eq!(quick.frame(When::Time(0.15)), Some(3));
        // One that begins earlier is where the scene is.
        let middle = frames("f/p_##.csv", 5..=9, 10.0);
        let early = beside(&middle, 0..=9, 10.0);
        assert_eq!([When::Start, When::Frame(0), When::Frame(7)].map(|n| early.frame(n)), [Some(5), Some(5), Some(7)]);
        assert_eq!(late.next(When::Frame(0), 2).collect::<Vec<_>>(), [2]);
        assert_eq!(liquid.next(When::Frame(8), 2).collect::<Vec<_>>(), [9]);
    }

    #[test]
    fn frames_that_a_sequence_does_not_have_are_told() {
        let liquid = frames("f/p_##.csv", 2..=7, 10.0);
        let told = |frames: &Frames, when: When| frames.outside(when).map(|found| found.message);
        let says = |text: &str| Some(text.to_owned());
        assert_eq!(told(&liquid, When::Frame(8)), says("`p_##.csv`: frame 8 is beyond 2 to 7: 7 is shown"));
        assert_eq!(told(&liquid, When::Frame(0)), says("`p_##.csv`: frame 0 is before 2 to 7: 2 is shown"));
        for fine in [When::Start, When::Frame(2), When::Frame(7), When::Time(0.5), When::Time(99.0)] {
            assert_eq!(told(&liquid, fine), None, "{fine:?}");
        }
        let short = beside(&liquid, 3..=4, 10.0);
        assert_eq!(told(&short, When::Frame(5)), says("`foam_##.csv`: frame 5 is beyond 3 to 4: 4 is shown"));
        assert_eq!(told(&short, When::Time(0.3)), says("`foam_##.csv`: frame 5 is beyond 3 to 4: 4 is shown"));
        for fine in [When::Start, When::Frame(2), When::Frame(4), When::Time(99.0)] {
            assert_eq!(told(&short, fine), None, "{fine:?}");
        }
    }
}
