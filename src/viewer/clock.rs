//! Time in the window: it plays, pauses, steps and is scrubbed, and slows when frames take long. Where a
//! scene has a sequence of files, frames are the files' numbers, at the files' rate.

use crate::host::{Track, When};

/// Frames a second of the numbers that frames bear, where no sequence says another.
pub const FRAMES_PER_SECOND: f64 = 60.0;
/// Where the slider ends at first, if nothing ends by itself.
const END_S: f64 = 10.0;
/// A frame shows at most so much time at once: what draws slower than this is shown slowed.
const LONGEST_DELTA_S: f64 = 1.0 / 15.0;

#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    pub is_playing: bool,
    /// Since the start.
    pub time_s: f64,
    /// Seconds that pass in one second.
    pub speed: f64,
    /// Of the last advance; 0 after a jump.
    pub delta_s: f64,
    /// How much slower than asked time passes: 1 is as asked.
    pub slowdown: f64,
    /// Where the slider ends.
    pub end_s: f64,
    pub beat: Beat,
    /// After the last frame of a sequence comes the first.
    pub repeats: bool,
}

/// The frames that a clock counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beat {
    /// Frames a second.
    pub rate: f64,
    /// The number of the frame at time 0.
    pub first: u64,
    /// Of a sequence, the number of its last frame.
    pub last: Option<u64>,
}

impl Default for Beat {
    fn default() -> Self {
        Self { rate: FRAMES_PER_SECOND, first: 0, last: None }
    }
}

impl Beat {
    /// That of a scene's first sequence, if it has any.
    pub fn of(track: Option<&Track>) -> Self {
        track.map_or_else(Self::default, |track| Self {
            rate: track.frames.rate,
            first: track.frames.first(),
            last: Some(track.frames.last()),
        })
    }

    fn end_s(&self) -> Option<f64> {
        self.last.map(|last| last.saturating_sub(self.first) as f64 / self.rate)
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            is_playing: false,
            time_s: 0.0,
            speed: 1.0,
            delta_s: 0.0,
            slowdown: 1.0,
            end_s: END_S,
            beat: Beat::default(),
            repeats: false,
        }
    }
}

impl Clock {
    /// The number of the frame at the time.
    pub fn frame(&self) -> u64 {
        self.frame_at(self.time_s)
    }

    pub fn frame_at(&self, time_s: f64) -> u64 {
        let frame = self.beat.first.saturating_add((time_s * self.beat.rate + 1e-6).floor().max(0.0) as u64);
        self.beat.last.map_or(frame, |last| frame.min(last.max(self.beat.first)))
    }

    /// When a frame is.
    pub fn time_of(&self, frame: u64) -> f64 {
        frame.saturating_sub(self.beat.first) as f64 / self.beat.rate
    }

    /// The number of the frame that sequences show then.
    pub fn frame_of(&self, when: When) -> u64 {
        match when {
            When::Start => self.beat.first,
            When::Frame(frame) => frame,
            When::Time(time_s) => self.frame_at(time_s),
        }
    }

    /// What sequences show at the time: the same as `render --frame` with this number.
    pub fn when(&self) -> When {
        self.beat.last.map_or(When::Start, |_| When::Frame(self.frame()))
    }

    /// Counts other frames from now on; the time stays, as far as they go.
    pub fn follow(&mut self, beat: Beat) {
        if self.beat == beat {
            return;
        }
        self.beat = beat;
        self.end_s = beat.end_s().unwrap_or_else(|| END_S.max(self.time_s));
        if beat.last.is_some() {
            self.time_s = self.time_s.min(self.end_s);
        }
    }

    pub fn play(&mut self, on: bool) {
        if on && self.is_at_end() {
            self.seek(0.0);
        }
        self.is_playing = on;
    }

    fn is_at_end(&self) -> bool {
        self.beat.last.is_some() && self.time_s >= self.end_s
    }

    /// Lets real time pass, if it plays. No frame of a sequence is left out; at its end it begins anew or
    /// stands.
    pub fn advance(&mut self, real_s: f64) {
        if !self.is_playing || real_s <= 0.0 {
            return;
        }
        if self.is_at_end() {
            match self.repeats {
                true => self.time_s = 0.0,
                false => self.is_playing = false,
            }
            self.delta_s = 0.0;
            return;
        }
        let wanted = real_s * self.speed;
        let longest =
            if self.beat.last.is_some() { 1.0 / self.beat.rate } else { LONGEST_DELTA_S * self.speed.max(1.0) };
        self.delta_s = wanted.min(longest);
        let now = if self.delta_s > 0.0 { wanted / self.delta_s } else { 1.0 };
        self.slowdown += (now - self.slowdown) * 0.2;
        self.time_s += self.delta_s;
        match self.beat.last {
            Some(_) => self.time_s = self.time_s.min(self.end_s),
            None => self.end_s = self.end_s.max(self.time_s),
        }
    }

    /// Goes by whole frames, and stops there.
    pub fn step(&mut self, frames: i64) {
        let frame = self.frame().saturating_add_signed(frames).max(self.beat.first);
        let before = self.time_s;
        self.seek(self.time_of(frame));
        self.delta_s = (self.time_s - before).max(0.0);
        self.is_playing = false;
    }

    pub fn seek(&mut self, time_s: f64) {
        self.time_s = if time_s.is_finite() { time_s.max(0.0) } else { 0.0 };
        self.delta_s = 0.0;
        self.slowdown = 1.0;
        match self.beat.last {
            Some(_) => self.time_s = self.time_s.min(self.end_s),
            None => self.end_s = self.end_s.max(self.time_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stepping_goes_by_whole_frames_and_never_before_the_start() {
        let mut clock = Clock { is_playing: true, ..Clock::default() };
        clock.step(1);
        assert_eq!((clock.frame(), clock.is_playing), (1, false));
        (0..599).for_each(|_| clock.step(1));
        assert_eq!(clock.frame(), 600);
        clock.step(-1);
        assert_eq!(clock.frame(), 599);
        clock.step(-1000);
        assert_eq!((clock.frame(), clock.time_s), (0, 0.0));
    }

    #[test]
    fn slow_frames_slow_time_and_say_so() {
        let mut clock = Clock { is_playing: true, ..Clock::default() };
        (0..60).for_each(|_| clock.advance(1.0 / 60.0));
        assert!((clock.time_s - 1.0).abs() < 1e-9 && (clock.slowdown - 1.0).abs() < 1e-9);
        (0..60).for_each(|_| clock.advance(1.0));
        assert!((clock.time_s - 5.0).abs() < 1e-9, "{}", clock.time_s);
        assert!((clock.slowdown - 15.0).abs() < 0.1, "{}", clock.slowdown);
    }

    fn in_sequence() -> Clock {
        let mut clock = Clock { time_s: 99.0, ..Clock::default() };
        clock.follow(Beat { rate: 25.0, first: 3, last: Some(13) });
        clock
    }

    #[test]
    fn a_sequence_counts_its_own_frames_and_ends() {
        let mut clock = in_sequence();
        assert_eq!((clock.time_s, clock.end_s, clock.frame()), (0.4, 0.4, 13), "time goes as far as the files do");
        clock.play(true);
        assert_eq!((clock.time_s, clock.frame()), (0.0, 3), "playing from the end begins anew");
        let mut seen = vec![clock.frame()];
        for _ in 0..40 {
            // Slower than the files' rate: each frame is shown all the same.
            clock.advance(0.2);
            seen.push(clock.frame());
        }
        seen.dedup();
        assert_eq!(seen, (3..=13).collect::<Vec<_>>());
        assert!(!clock.is_playing && clock.slowdown > 4.0);
        clock.step(-1);
        assert_eq!((clock.frame(), clock.time_of(12)), (12, clock.time_s));
        (0..5).for_each(|_| clock.step(1));
        assert_eq!(clock.frame(), 13);
        clock.step(-100);
        assert_eq!(clock.frame(), 3);
    }

    #[test]
    fn a_sequence_plays_at_its_rate_and_may_repeat() {
        let mut clock = Clock { repeats: true, ..in_sequence() };
        clock.play(true);
        // 0.2 s at 25 frames a second are 5 frames, however often it is painted.
        (0..20).for_each(|_| clock.advance(0.01));
        assert_eq!(clock.frame(), 8);
        (0..21).for_each(|_| clock.advance(0.01));
        assert_eq!((clock.frame(), clock.is_playing), (3, true));
    }

    #[test]
    fn a_paused_clock_stands() {
        let mut clock = Clock::default();
        clock.advance(1.0);
        clock.seek(f64::NAN);
        assert_eq!(clock, Clock::default());
    }
}
