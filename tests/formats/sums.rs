//! Files that other programs wrote, value for value: `formats/sums.txt` has what other people's readers find in them, written by
//! `scripts/formats_sums.py`. The files lie beside the repository; where they are absent, the test says so and checks nothing.

use std::path::Path;

use meniscus::scene::particles::{Attribute, read};

const SUMS: &str = include_str!("sums.txt");

fn sum(values: &[f64]) -> u32 {
    let mut crc = flate2::Crc::new();
    values.iter().for_each(|value| crc.update(&value.to_le_bytes()));
    crc.sum()
}

#[test]
fn sums() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return;
    }
    let rows: Vec<Vec<&str>> = SUMS.lines().map(|line| line.split(' ').collect()).collect();
    assert!(rows.len() > 50, "the table is whole");
    for rows in rows.chunk_by(|a, b| a[0] == b[0]) {
        let name = rows[0][0];
        let path = folder.join(name);
        let set = read(&path, &std::fs::read(&path).unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"));
        for row in rows {
            let [_, attribute, components, expected] = row[..] else { panic!("{row:?}") };
            let found: &Attribute = set.attribute(attribute).unwrap_or_else(|| panic!("{name} has no `{attribute}`"));
            assert_eq!(found.components.to_string(), components, "{name}: {attribute}");
            let mut values = found.values.to_f64();
            assert_eq!(format!("{:08x}", sum(&values)), expected, "{name}: {attribute}");
            // One bit of one value is seen.
            let middle = values.len() / 2;
            values[middle] = f64::from_bits(values[middle].to_bits() ^ 1 << 29);
            assert_ne!(format!("{:08x}", sum(&values)), expected, "{name}: {attribute}");
        }
    }
}
