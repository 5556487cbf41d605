//! Time in the window: it plays, pauses, steps and is scrubbed, and slows when frames take long.

/// Frames a second of the numbers that frames bear.
pub const FRAMES_PER_SECOND: f64 = 60.0;
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
}

impl Default for Clock {
    fn default() -> Self {
        Self { is_playing: false, time_s: 0.0, speed: 1.0, delta_s: 0.0, slowdown: 1.0, end_s: 10.0 }
    }
}

impl Clock {
    /// The number of the frame at the time.
    pub fn frame(&self) -> u64 {
        (self.time_s * FRAMES_PER_SECOND + 1e-6).floor().max(0.0) as u64
    }

    /// Lets real time pass, if it plays.
    pub fn advance(&mut self, real_s: f64) {
        if !self.is_playing || real_s <= 0.0 {
            return;
        }
        let wanted = real_s * self.speed;
        self.delta_s = wanted.min(LONGEST_DELTA_S * self.speed.max(1.0));
        let now = if self.delta_s > 0.0 { wanted / self.delta_s } else { 1.0 };
        self.slowdown += (now - self.slowdown) * 0.2;
        self.time_s += self.delta_s;
        self.end_s = self.end_s.max(self.time_s);
    }

    /// Goes by whole frames, and stops there.
    pub fn step(&mut self, frames: i64) {
        let frame = self.frame().saturating_add_signed(frames);
        let before = self.time_s;
        self.seek(frame as f64 / FRAMES_PER_SECOND);
        self.delta_s = (self.time_s - before).max(0.0);
        self.is_playing = false;
    }

    pub fn seek(&mut self, time_s: f64) {
        self.time_s = if time_s.is_finite() { time_s.max(0.0) } else { 0.0 };
        self.delta_s = 0.0;
        self.slowdown = 1.0;
        self.end_s = self.end_s.max(self.time_s);
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

    #[test]
    fn a_paused_clock_stands() {
        let mut clock = Clock::default();
        clock.advance(1.0);
        clock.seek(f64::NAN);
        assert_eq!(clock, Clock::default());
    }
}
