//! Damaged files: whatever the bytes, a reader returns, and takes no more memory than they
//! justify.

use super::fuzz;
use super::writers::{self, Legacy, Mode, Order, Packing, Rows, Sample, Store, Xml};
use meniscus::scene::particles::ParticleSet;

/// A small file of each form that each format has.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let sample = Sample::new(6);
    let mut seeds = Vec::new();
    for flags in 0..8 {
        let how = Legacy { binary: flags & 1 != 0, five: flags & 2 != 0, poly: flags & 4 != 0 };
        seeds.push(("a.vtk", writers::legacy_vtk(&sample, how)));
    }
    for (name, poly) in [("a.vtu", false), ("a.vtp", true)] {
        for mode in [Mode::Text, Mode::Inline, Mode::AppendedRaw, Mode::AppendedBase64] {
            for packing in [Packing::None, Packing::Zlib, Packing::Lz4] {
                for (wide, order) in [(false, Order::Little), (true, Order::Little), (true, Order::Big)] {
                    seeds.push((name, writers::xml_vtk(&sample, Xml { mode, packing, wide, order, poly })));
                }
            }
        }
    }
    for order in [None, Some(Order::Big), Some(Order::Little)] {
        seeds.push(("a.ply", writers::ply(&sample, order)));
    }
    let classic = writers::classic_bgeo(&sample);
    seeds.push(("a.bgeo.gz", writers::gzip(&classic)));
    seeds.push(("a.bgeo", classic));
    for store in [Store::Pages, Store::Packs, Store::Tuples] {
        for order in [Order::Little, Order::Big] {
            seeds.push(("a.bgeo", writers::json_bgeo(&sample, store, order)));
        }
    }
    seeds.push(("a.bgeo.gz", writers::gzip(&writers::json_bgeo(&sample, Store::Pages, Order::Little))));
    seeds.push(("a.xyz", writers::xyz(&sample)));
    seeds.push(("a.xyz", writers::xyz_text(&sample)));
    let csv = writers::csv(&sample);
    let tabs = csv.iter().map(|byte| if *byte == b',' { b'\t' } else { *byte }).collect();
    let bare = b"# no header\r\n1;2;3\r\n-nan(ind);1.#INF;\r\n\r\n4e5;.5;-0\r\n".to_vec();
    seeds.extend([("a.csv", csv), ("a.csv", tabs), ("a.csv", bare)]);
    let spaces = b"# x\nx y  z [m] id\n 1 2 3 9\n4  5 6 8 \n".to_vec();
    seeds.extend([("a.csv", spaces), ("a.csv", super::PART_VTK.as_bytes().to_vec())]);
    seeds.push(("a.xyz", "\u{feff}# größe\n1 2 3\n4,5;6\n".into()));
    seeds.push((
        "a.pvd",
        b"<VTKFile type=\"Collection\"><DataSet file=\"a_0.vtu\"/><DataSet file='b'/></VTKFile>".to_vec(),
    ));
    for rows in [Rows::Bare, Rows::Objects, Rows::Columns, Rows::Flat] {
        seeds.push(("a.json", writers::json(&sample, rows)));
    }
    let nested =
        br#"[{"p": {"x": 1, "y": -2e3, "z": null}, "on": true, "t": "\u00e9\ud83d\ude00\n", "deep": [[1, [2]], {}]}]"#;
    seeds.push(("a.json", nested.to_vec()));
    for (wide, order) in [(false, Order::Little), (true, Order::Big), (false, Order::Big), (true, Order::Little)] {
        let pdb = writers::pdb(&sample, wide, order);
        seeds.extend([("a.pdb", writers::gzip(&pdb)), ("a.pdb", pdb)]);
    }
    for version in 0..3 {
        let ptc = writers::ptc(&sample, version);
        seeds.extend([("a.ptc", writers::gzip(&ptc)), ("a.ptc", ptc)]);
    }
    seeds
}

fn size(set: &ParticleSet) -> usize {
    set.attributes.iter().map(|a| a.values.len() * a.values.kind().size() + a.name.len()).sum()
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
    fuzz::damaged(&seeds(), Vec::as_slice, (7, TIMES), |name, _, bytes| check(name, bytes));
}

/// `MENISCUS_FUZZ_SECONDS=600 cargo test --test formats fuzz -- --nocapture`.
#[test]
fn fuzz() {
    fuzz::fuzz(seeds(), Vec::as_slice, |name, _, bytes| check(name, bytes));
}

#[test]
fn cut_files_never_panic() {
    for (name, seed) in seeds() {
        // There are many XML files, of some thousand bytes each.
        for end in (0..seed.len()).step_by(1 + seed.len() / 1024) {
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
        let digits = text.char_indices().filter(|(_, c)| c.is_ascii_digit());
        // Of base64 every fourth.
        for (at, _) in digits.step_by(if text.contains("base64") || text.contains("\"binary\"") { 4 } else { 1 }) {
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
