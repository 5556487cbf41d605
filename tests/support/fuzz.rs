//! Damage to files: for so many tries from numbers that are the same in each run, or for so many seconds of processor
//! time from others each time. Seeds are made by the tests' own writers, so that no corpus lies in the tree.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The numbers of a test: the same in each run.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        // splitmix64
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// Damages a file in one of the ways that disks, transfers and ill will do.
fn damage(random: &mut Random, bytes: &mut Vec<u8>) {
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(16)).min(bytes.len());
        let digit = bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |found| at + found);
        match random.below(11) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.next() as u8,
            2 => bytes[at..end].fill([0, 0x7f, 0xff, b'9'][random.below(4)]),
            3 => bytes.truncate(at.max(1)),
            4 => drop(bytes.drain(at..end)),
            5 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            // More digits in a number make a count that lies.
            6 => drop(bytes.splice(digit..digit, *b"99999999")),
            // One number for another: what still parses goes deepest.
            7 | 8 => bytes[digit] = b"0123456789"[random.below(10)],
            9 => bytes[digit] = b"-.e "[random.below(4)],
            _ => {
                let from = random.below(bytes.len());
                let part = bytes[from..(from + 12).min(bytes.len())].to_vec();
                bytes.splice(at..end, part);
            }
        }
        if bytes.is_empty() {
            bytes.push(0);
        }
    }
}

/// The most address space that this process has had, where the system tells: memory that was asked for counts, even
/// if it was never touched.
pub fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<usize>().ok()? * 1024)
}

/// Time that this thread has had of a processor; where the system does not tell, time that has passed.
struct Clock(Instant);

impl Clock {
    fn now(&self) -> Duration {
        let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
        let first = told.and_then(|text| text.split_whitespace().next()?.parse().ok());
        first.map_or_else(|| self.0.elapsed(), Duration::from_nanos)
    }
}

/// A small file may take no longer than this of a processor.
const LONGEST: Duration = Duration::from_secs(2);

/// Damages each seed so many times, the same way in each run. No attempt may panic, nor take memory that a count in
/// a damaged file promises.
pub fn damaged<S>(
    seeds: &[(&'static str, S)],
    bytes: fn(&S) -> &[u8],
    (first, times): (u64, usize),
    attempt: impl Fn(&str, &S, &[u8]),
) {
    let before = peak();
    let mut random = Random(first);
    for (name, seed) in seeds {
        for _ in 0..times {
            let mut bytes = bytes(seed).to_vec();
            damage(&mut random, &mut bytes);
            attempt(name, seed, &bytes);
        }
    }
    if let (Some(before), Some(after)) = (before, peak()) {
        // Threads of other tests reserve some; a count that is believed takes tens of GiB.
        assert!(after - before < 2 << 30, "the peak rose by {} MiB", (after - before) >> 20);
    }
}

/// Damages files of each loader on a thread of its own for `MENISCUS_FUZZ_SECONDS` of that thread's processor time;
/// `MENISCUS_FUZZ_ONLY=a.json,a.ply` chooses loaders by their seeds' name. Damage heaps up, so that what is found after
/// hours differs from what is found at once. A file that does harm is kept in the folder of the tests' results.
pub fn fuzz<S: Sync>(seeds: Vec<(&'static str, S)>, bytes: fn(&S) -> &[u8], attempt: impl Fn(&str, &S, &[u8]) + Sync) {
    let said = |name: &str| std::env::var(name).ok();
    let Some(seconds) = said("MENISCUS_FUZZ_SECONDS").and_then(|s| s.parse().ok()).map(Duration::from_secs) else {
        eprintln!("skipped: `MENISCUS_FUZZ_SECONDS` does not say how long");
        return;
    };
    let mut loaders: BTreeMap<&str, Vec<S>> = BTreeMap::new();
    seeds.into_iter().for_each(|(name, seed)| loaders.entry(name).or_default().push(seed));
    if let Some(only) = said("MENISCUS_FUZZ_ONLY") {
        loaders.retain(|name, _| only.split(',').any(|chosen| chosen == *name));
        assert!(!loaders.is_empty(), "there is no seed called `{only}`");
    }
    let start = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
    std::thread::scope(|scope| {
        for (number, (name, seeds)) in loaders.iter().enumerate() {
            let (attempt, random) = (&attempt, Random(start ^ (number as u64) << 48));
            scope.spawn(move || one(name, seeds, seconds, random, bytes, attempt));
        }
    });
    let peak = peak().map_or_else(|| "unknown".into(), |peak| format!("{} MiB", peak >> 20));
    eprintln!("the most address space that was asked for: {peak}");
}

fn one<S>(
    name: &str,
    seeds: &[S],
    seconds: Duration,
    mut random: Random,
    bytes: fn(&S) -> &[u8],
    attempt: &impl Fn(&str, &S, &[u8]),
) {
    let from = random.0;
    let clock = Clock(Instant::now());
    let (begin, mut files, mut longest) = (clock.now(), 0_u64, Duration::ZERO);
    let mut before = begin;
    while before - begin < seconds {
        let seed = &seeds[random.below(seeds.len())];
        let mut damaged = bytes(seed).to_vec();
        for _ in 0..1 + random.below(8) {
            damage(&mut random, &mut damaged);
            let is_sound = catch_unwind(AssertUnwindSafe(|| attempt(name, seed, &damaged))).is_ok();
            let now = clock.now();
            longest = longest.max(now - before);
            if !is_sound || now - before > LONGEST {
                let kept = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{from:x}_{name}"));
                let what = std::fs::write(&kept, &damaged)
                    .map_or_else(|_| format!("{damaged:?}"), |()| kept.display().to_string());
                panic!("{name}, after {:?}: {what}", now - before);
            }
            before = now;
            files += 1;
        }
    }
    let spent = (before - begin).as_secs();
    eprintln!("{name}: {files} damaged files in {spent} s of processor time did no harm; the slowest took {longest:?}");
}
