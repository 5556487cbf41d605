//! Files that other people's writers made of the same values: `scripts/formats_oracle.py` makes them
//! and names their folder in `MENISCUS_ORACLE`. Without it, the test says so and checks nothing.

use std::fs;
use std::path::Path;

use meniscus::scene::particles::{ParticleSet, known_extension, read};

/// Numbers as their bits.
fn bits32(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect()
}

fn bits64(bytes: &[u8]) -> Vec<u64> {
    bytes.as_chunks().0.iter().map(|b| u64::from_le_bytes(*b)).collect()
}

fn f32_bits(set: &ParticleSet, name: &str) -> Vec<u32> {
    set.attribute(name).map(|a| a.to_f32().iter().map(|v| v.to_bits()).collect()).unwrap_or_default()
}

#[test]
fn oracle() {
    let Some(folder) = std::env::var_os("MENISCUS_ORACLE") else {
        eprintln!("skipped: `scripts/formats_oracle.py` makes the files");
        return;
    };
    let folder = Path::new(&folder);
    let mut checked = 0;
    let mut wrong = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if !known_extension(&path) {
            continue;
        }
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let set = read(&path, &fs::read(&path).unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"));
        // A file whose writer rounds has values of its own, those that another reader finds in it.
        let values = |column: &str| {
            let own = fs::read(folder.join(format!("{name}.{column}.values")));
            own.or_else(|_| fs::read(folder.join(format!("{column}.values")))).unwrap()
        };
        checked += 1;
        let mut expect = |what: &str, is_same: bool| {
            if !is_same {
                wrong.push(format!("{name}: {what}; {:?}", set.notes));
            }
        };
        expect("position", f32_bits(&set, "position") == bits32(&values("position")));
        if name.ends_with(".xyz") {
            continue;
        }
        expect("velocity", f32_bits(&set, "velocity") == bits32(&values("velocity")));
        let ids = set.attribute("id").map(|a| a.to_i32().iter().map(|v| *v as u32).collect::<Vec<_>>());
        expect("id", ids.as_ref() == Some(&bits32(&values("id"))));
        let masses = set.attribute("mass").map(|a| a.values.to_f64().iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        expect("mass", masses.as_ref() == Some(&bits64(&values("mass"))));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    eprintln!("{checked} files hold what was written");
    assert!(checked > 80, "{checked}");
}
