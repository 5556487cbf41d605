//! Damaged files: whatever the bytes, a reader returns, and takes no more memory than they
//! justify.

use super::writers::{self, Legacy, Mode, Order, Packing, Rows, Sample, Store, Xml};
use meniscus::scene::particles::ParticleSet;

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

/// A small file of each form that each format has.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let sample = Sample::new(6);
    let mut seeds = Vec::new();
    for flags in 0..4 {
        let how = Legacy { binary: flags & 1 != 0, five: flags & 2 != 0, poly: flags == 2 };
        seeds.push(("a.vtk", writers::legacy_vtk(&sample, how)));
    }
    for mode in [Mode::Text, Mode::Inline, Mode::AppendedRaw, Mode::AppendedBase64] {
        for packing in [Packing::None, Packing::Zlib, Packing::Lz4] {
            let how = Xml { mode, packing, wide: packing != Packing::None, order: Order::Little, poly: false };
            seeds.push(("a.vtu", writers::xml_vtk(&sample, how)));
        }
    }
    for order in [None, Some(Order::Big), Some(Order::Little)] {
        seeds.push(("a.ply", writers::ply(&sample, order)));
    }
    let classic = writers::classic_bgeo(&sample);
    seeds.push(("a.bgeo.gz", writers::gzip(&classic)));
    seeds.push(("a.bgeo", classic));
    for store in [Store::Pages, Store::Packs, Store::Tuples] {
        seeds.push(("a.bgeo", writers::json_bgeo(&sample, store, Order::Little)));
    }
    seeds.push(("a.xyz", writers::xyz(&sample)));
    seeds.push(("a.xyz", writers::xyz_text(&sample)));
    seeds.push(("a.csv", writers::csv(&sample)));
    for rows in [Rows::Bare, Rows::Objects, Rows::Columns, Rows::Flat] {
        seeds.push(("a.json", writers::json(&sample, rows)));
    }
    for (wide, order) in [(false, Order::Little), (true, Order::Big)] {
        seeds.push(("a.pdb", writers::pdb(&sample, wide, order)));
    }
    seeds.push(("a.ptc", writers::ptc(&sample, 0)));
    seeds.push(("a.ptc", writers::gzip(&writers::ptc(&sample, 2))));
    seeds
}

/// Damages a file in one of the ways that disks, transfers and ill will do.
fn damage(random: &mut Random, bytes: &mut Vec<u8>) {
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(16)).min(bytes.len());
        match random.below(8) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.next() as u8,
            2 => bytes[at..end].fill([0, 0x7f, 0xff, b'9'][random.below(4)]),
            3 => bytes.truncate(at.max(1)),
            4 => drop(bytes.drain(at..end)),
            5 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            6 => {
                // More digits in a number make a count that lies.
                let digit = bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |found| at + found);
                bytes.splice(digit..digit, *b"99999999");
            }
            _ => {
                let digit = bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |found| at + found);
                bytes[digit] = b"0123456789-.e "[random.below(14)];
            }
        }
        if bytes.is_empty() {
            bytes.push(0);
        }
    }
}

fn size(set: &ParticleSet) -> usize {
    set.attributes.iter().map(|a| a.values.len() * a.values.kind().size() + a.name.len()).sum()
}

/// The most address space that this process has had, where the system tells: memory that was
/// asked for counts, even if it was never touched.
fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<usize>().ok()? * 1024)
}

fn check(name: &str, bytes: &[u8]) {
    if let Ok(set) = super::parse(name, bytes) {
        // Text spends two bytes on a number of 8; a page of the new BGEO can spend less.
        let most = bytes.len() * 64 + (1 << 20);
        assert!(size(&set) <= most, "{name}: {} bytes from {}", size(&set), bytes.len());
        for attribute in &set.attributes {
            assert_eq!(attribute.values.len(), attribute.components * set.count, "{name}: {}", attribute.name);
        }
    }
}

#[test]
fn damaged_files_neither_panic_nor_take_memory() {
    const TIMES: usize = if cfg!(debug_assertions) { 800 } else { 4000 };
    let before = peak();
    let mut random = Random(7);
    for (name, seed) in seeds() {
        for _ in 0..TIMES {
            let mut bytes = seed.clone();
            damage(&mut random, &mut bytes);
            check(name, &bytes);
        }
    }
    if let (Some(before), Some(after)) = (before, peak()) {
        // Threads of other tests reserve some; a count that is believed takes tens of GiB.
        assert!(after - before < 2 << 30, "the peak rose by {} MiB", (after - before) >> 20);
    }
}

/// For so many seconds, all formats at once, each on a thread of its own and from numbers of its own:
/// `MENISCUS_FUZZ_SECONDS=600 cargo test --test formats fuzz -- --nocapture`; `MENISCUS_FUZZ_ONLY=a.json` for one
/// format. Damage heaps up, so that what is found after hours differs from what is found at once.
#[test]
fn fuzz() {
    let Some(seconds) = std::env::var("MENISCUS_FUZZ_SECONDS").ok().and_then(|s| s.parse::<u64>().ok()) else {
        eprintln!("skipped: `MENISCUS_FUZZ_SECONDS` does not say how long");
        return;
    };
    let start = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
    let mut formats: std::collections::BTreeMap<&str, Vec<Vec<u8>>> = std::collections::BTreeMap::new();
    seeds().into_iter().for_each(|(name, seed)| formats.entry(name).or_default().push(seed));
    if let Ok(only) = std::env::var("MENISCUS_FUZZ_ONLY") {
        formats.retain(|name, _| *name == only);
        assert!(!formats.is_empty(), "there is no seed called `{only}`");
    }
    std::thread::scope(|scope| {
        for (name, seeds) in &formats {
            scope.spawn(move || {
                let mut random = Random(start ^ name.len() as u64 ^ u64::from(name.as_bytes()[2]) << 32);
                let (begin, mut files) = (std::time::Instant::now(), 0_u64);
                while begin.elapsed().as_secs() < seconds {
                    let mut bytes = seeds[random.below(seeds.len())].clone();
                    for _ in 0..random.below(8) {
                        damage(&mut random, &mut bytes);
                        let file = std::panic::catch_unwind(|| check(name, &bytes));
                        assert!(file.is_ok(), "{name}, numbers from {start}: {bytes:?}");
                        files += 1;
                    }
                }
                eprintln!("{name}: {files} damaged files, none of which did harm");
            });
        }
    });
    let peak = peak().map_or_else(|| "unknown".into(), |peak| format!("{} MiB", peak >> 20));
    eprintln!("the most address space that was asked for: {peak}");
}

#[test]
fn cut_files_never_panic() {
    for (name, seed) in seeds() {
        for end in 0..seed.len() {
            check(name, &seed[..end]);
        }
    }
    let sample = Sample::new(500);
    let large = [
        ("a.vtk", writers::legacy_vtk(&sample, Legacy { binary: true, five: true, poly: false })),
        ("a.bgeo", writers::gzip(&writers::classic_bgeo(&sample))),
    ];
    for (name, bytes) in large {
        for part in 0..16 {
            assert!(super::parse(name, &bytes[..bytes.len() * part / 16]).is_err(), "{name}: {part} of 16");
        }
    }
}

#[test]
fn counts_are_not_believed() {
    // Each count in a file in turn becomes one that nothing can hold.
    for (name, seed) in seeds().into_iter().filter(|(_, seed)| seed.is_ascii()) {
        let text = String::from_utf8(seed).unwrap();
        for (at, _) in text.char_indices().filter(|(_, c)| c.is_ascii_digit()) {
            for huge in ["2147483647", "4294967295", "9223372036854775807", "18446744073709551615"] {
                let lying = format!("{}{huge}{}", &text[..at], &text[at + 1..]);
                check(name, lying.as_bytes());
            }
        }
    }
}

#[test]
fn a_small_file_that_unpacks_to_much_is_refused() {
    // 64 MiB of zeros in 64 KiB, behind a header that counts two points.
    let mut bytes = writers::classic_bgeo(&Sample::new(2));
    bytes.extend(vec![0; 64 << 20]);
    let set = super::parse("a.bgeo", &writers::gzip(&bytes)).unwrap();
    assert_eq!(set.count, 2, "what follows the particles is of no account");
    // The same behind one that counts as many as fit into 2 GiB.
    bytes[9..13].copy_from_slice(&60_000_000_i32.to_be_bytes());
    let error = super::parse("a.bgeo", &writers::gzip(&bytes)).unwrap_err();
    assert!(error.message.contains("before the end of the file"), "{error}");
}
