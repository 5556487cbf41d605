use std::ops::RangeInclusive;
use std::path::PathBuf;

use super::*;
use crate::files::MemoryFiles;
use crate::host::sequence::Frames;
use crate::scene::particles::Taken;
use crate::scene::placement::{Placement, Up};
use crate::scene::sequence::Pattern;

fn track(rate: f64) -> Track {
    of(3..=9, rate)
}

fn of(numbers: RangeInclusive<u64>, rate: f64) -> Track {
    let pattern = Pattern::of(Path::new("f/p_##.csv")).expect("a pattern");
    Track {
        input: "particles".into(),
        frames: Frames::leading(pattern, numbers, rate),
        taken: Taken::default(),
        radius_m: 0.5,
        bounds: None,
        none: None,
    }
}

/// Frames 3 to 9 without 5 and 6; 8 is damaged. Frame n has n particles.
fn files() -> MemoryFiles {
    let csv = |n: u64| format!("x,y,z\n{}", (0..n).map(|i| format!("{i},{n},0\n")).collect::<String>());
    let whole = [3_u64, 4, 7, 9].into_iter();
    let files = whole.fold(MemoryFiles::default(), |files, n| files.with(format!("f/p_{n:02}.csv"), csv(n)));
    files.with("f/p_08.csv", "x,y,z\n1,2\n")
}

fn shown(player: &mut Player, when: When) -> (Option<usize>, Vec<String>) {
    let mut found = Diagnostics::new();
    let inputs = player.inputs(when, &mut found);
    let count = inputs.get("particles").map(|input| match input {
        Input::Particles(particles) => particles.set.count,
        other => panic!("{other:?}"),
    });
    (count, found.iter().map(|d| d.message.clone()).collect())
}

#[test]
fn what_is_missing_or_damaged_is_told_and_the_one_before_stays() {
    let mut player = Player::new(&[track(25.0)], When::Frame(3), files());
    let mut play = |frame| shown(&mut player, When::Frame(frame));
    assert_eq!(play(3), (None, vec![]), "this one is there already");
    assert_eq!(play(4), (Some(4), vec![]));
    let missing = "frame 5: there is no file `f/p_05.csv`: frame 4 is shown in its place";
    assert_eq!(play(5), (Some(4), vec![missing.to_owned()]));
    assert_eq!(play(7), (Some(7), vec![]));
    let (count, told) = play(8);
    assert_eq!(count, Some(7));
    assert!(told[0].starts_with("frame 8: `f/p_08.csv`: line 2, column 1: ") && told.len() == 1, "{told:?}");
    assert_eq!(play(9), (Some(9), vec![]));
    let beyond = "`p_##.csv`: frame 99 is beyond 3 to 9: 9 is shown";
    assert_eq!(play(99), (None, vec![beyond.to_owned()]), "the last one stays, and is there already");
    assert_eq!(play(100), (None, vec![]), "told once");
    assert_eq!(play(4), (Some(4), vec![]), "back again");
}

#[test]
fn each_frame_is_taken_as_the_scene_says() {
    let taken = Taken { placement: Placement::of_file(Up::Z, 2.0), ..Taken::default() };
    let mut player = Player::new(&[Track { taken, ..track(25.0) }], When::Start, files());
    let inputs = player.inputs(When::Frame(4), &mut Diagnostics::new());
    let Some(Input::Particles(particles)) = inputs.get("particles") else { panic!("{inputs:?}") };
    assert_eq!((particles.min, particles.max), ([0.0, 0.0, -8.0], [6.0, 0.0, -8.0]));
}

#[test]
fn a_jump_shows_what_playing_from_the_start_would() {
    let mut player = Player::new(&[track(25.0)], When::Start, files());
    let missing = "frame 6: there is no file `f/p_06.csv`: frame 4 is shown in its place";
    assert_eq!(shown(&mut player, When::Frame(6)), (Some(4), vec![missing.to_owned()]));
}

/// Files of one particle each; those of some frames are damaged. Counts what is read.
struct Counted {
    numbers: RangeInclusive<u64>,
    damaged: RangeInclusive<u64>,
    reads: Arc<Mutex<Vec<PathBuf>>>,
    listed: Arc<Mutex<usize>>,
    pause: Duration,
}

impl Counted {
    fn new(numbers: RangeInclusive<u64>, damaged: RangeInclusive<u64>) -> Self {
        Self { numbers, damaged, reads: Arc::default(), listed: Arc::default(), pause: Duration::ZERO }
    }
}

impl Files for Counted {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        self.reads.lock().expect("a list").push(path.to_owned());
        thread::sleep(self.pause);
        let pattern = Pattern::of(Path::new("f/p_##.csv")).expect("a pattern");
        let number = pattern.frame(&path.file_name().expect("a name").to_string_lossy());
        match number.filter(|number| self.numbers.contains(number)) {
            None => Err(io::ErrorKind::NotFound.into()),
            Some(number) if self.damaged.contains(&number) => Ok(b"x,y,z\n1,2\n".as_slice().into()),
            Some(number) => Ok(format!("x,y,z\n{number},0,0\n").as_bytes().into()),
        }
    }

    fn exists(&self, _path: &Path) -> bool {
        true
    }

    fn names(&self, _folder: &Path) -> Vec<String> {
        *self.listed.lock().expect("a number") += 1;
        self.numbers.clone().map(|n| format!("p_{n:02}.csv")).collect()
    }
}

/// The frame that is given, by where its one particle is.
fn given(player: &mut Player, frame: u64) -> Option<(Weak<Particles>, f32)> {
    let mut inputs = player.inputs(When::Frame(frame), &mut Diagnostics::new());
    let Input::Particles(particles) = inputs.remove("particles")? else { return None };
    Some((Arc::downgrade(&particles), particles.set.positions()[0][0]))
}

#[test]
fn no_more_is_held_than_is_read_ahead() {
    let mut player = Player::new(&[of(0..=60, 25.0)], When::Frame(0), Counted::new(0..=60, 70..=70));
    let mut seen = Vec::new();
    for frame in (1..40).chain([3, 50, 7, 8, 9, 60, 1, 2]) {
        let (particles, x) = given(&mut player, frame).expect("another frame");
        assert_eq!(x, frame as f32);
        seen.push(particles);
        // Nobody else keeps what was given: of all that ever were, the player holds the one at hand.
        let held = seen.iter().filter(|particles| particles.strong_count() > 0).count();
        assert!(held <= 1, "{frame}: {held}");
        assert!(player.desk.state().answers.len() <= 1 + AHEAD as usize, "{frame}");
    }
}

#[test]
fn what_nobody_wants_any_more_is_not_read() {
    let files = Counted { pause: Duration::from_millis(20), ..Counted::new(0..=60, 70..=70) };
    let reads = Arc::clone(&files.reads);
    let mut player = Player::new(&[of(0..=60, 25.0)], When::Frame(0), files);
    for jump in [10, 20, 30, 40] {
        assert_eq!(given(&mut player, jump).map(|(_, x)| x), Some(jump as f32));
    }
    // Each jump waits for its own frame, and at most for one that was being read.
    let reads = reads.lock().expect("a list");
    assert!(reads.len() <= 8, "{reads:?}");
}

#[test]
fn a_long_gap_is_crossed_at_once_and_damage_is_looked_at_once() {
    let files = Counted::new(0..=9, 3..=9);
    let (reads, listed) = (Arc::clone(&files.reads), Arc::clone(&files.listed));
    let mut player = Player::new(&[of(0..=u64::from(u32::MAX), 25.0)], When::Frame(0), files);
    for jump in [4_000_000_000, 5, 4_100_000_000, 9] {
        let mut told = Diagnostics::new();
        let inputs = player.inputs(When::Frame(jump), &mut told);
        let Some(Input::Particles(particles)) = inputs.get("particles") else { panic!("{jump}: {inputs:?}") };
        assert_eq!(particles.set.positions()[0][0], 2.0);
        assert!(told.iter().any(|d| d.message.ends_with("frame 2 is shown in its place")), "{told:?}");
    }
    // All ten files at first, then the frames themselves, those ahead, and frame 2 anew.
    let reads = reads.lock().expect("a list").len();
    assert!(reads <= 40, "{reads}");
    assert!(*listed.lock().expect("a number") <= 4);
}

#[test]
fn a_track_that_begins_late_is_empty_until_then() {
    let liquid = of(0..=3, 25.0);
    let none = decode(Path::new("a.csv"), b"x,y,z,id\n1,2,3,4\n", &liquid, &mut Diagnostics::new());
    let none = none.map(|particles| Arc::new(Particles::before(&particles.set, 0.5, None)));
    let foam = Track {
        input: "foam".into(),
        frames: Frames { timeline: liquid.frames.timeline.clone(), ..of(2..=3, 25.0).frames },
        none: none.ok(),
        ..liquid.clone()
    };
    let csv = |n: u64| format!("x,y,z\n{}", "1,2,3\n".repeat(n as usize));
    let files = (0..4).fold(MemoryFiles::default(), |files, n| files.with(format!("f/p_{n:02}.csv"), csv(n + 1)));
    let mut player = Player::new(&[liquid, foam], When::Start, files);
    let mut shown = |when| {
        let inputs = player.inputs(when, &mut Diagnostics::new());
        let count = |name: &str| match inputs.get(name) {
            Some(Input::Particles(particles)) => Some(particles.set.count),
            _ => None,
        };
        (count("particles"), count("foam"))
    };
    assert_eq!(shown(When::Frame(1)), (Some(2), None), "still empty");
    assert_eq!(shown(When::Frame(2)), (Some(3), Some(3)));
    assert_eq!(shown(When::Frame(3)), (Some(4), Some(4)));
    assert_eq!(shown(When::Time(0.05)), (Some(2), Some(0)), "back before it begins");
    assert_eq!(shown(When::Time(0.09)), (Some(3), Some(3)));
}

/// Files that take a while to read.
struct Slow(MemoryFiles, Duration);

impl Files for Slow {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        thread::sleep(self.1);
        self.0.read(path)
    }

    fn exists(&self, path: &Path) -> bool {
        self.0.exists(path)
    }
}

/// Plays at a frame each 50 ms; gives the longest wait for a frame once it is warm.
fn longest_wait(reading: Duration) -> Duration {
    let csv = |n: u64| format!("x,y,z\n{}", (0..n).map(|i| format!("{i},{n},0\n")).collect::<String>());
    let files = (0..20).fold(MemoryFiles::default(), |files, n| files.with(format!("f/p_{n:02}.csv"), csv(n + 1)));
    let track = of(0..=19, 20.0);
    let mut player = Player::new(&[track], When::Frame(0), Slow(files, reading));
    let frame = Duration::from_millis(50);
    let began = Instant::now();
    let mut longest = Duration::ZERO;
    for n in 0..20_u32 {
        thread::sleep((frame * n).saturating_sub(began.elapsed()));
        let asked = Instant::now();
        shown(&mut player, When::Frame(n.into()));
        if n > AHEAD as u32 {
            longest = longest.max(asked.elapsed());
        }
    }
    longest
}

#[test]
fn a_sequence_plays_without_a_stall() {
    // A file that takes 0.6 of a frame is there when it is asked for, one that takes three frames is not.
    let quick = (0..3).map(|_| longest_wait(Duration::from_millis(30))).min();
    assert!(quick.is_some_and(|wait| wait < Duration::from_millis(50)), "{quick:?}");
    let slow = longest_wait(Duration::from_millis(150));
    assert!(slow > Duration::from_millis(50), "{slow:?}");
}
