//! Files that other programs wrote. They lie beside the repository; where they are absent, the
//! tests say so and check nothing.

use std::path::PathBuf;

use meniscus::scene::particles::{Kind, ParticleSet, estimate_radius, read};

/// A name, how many numbers a row has, and their type.
type Column = (&'static str, usize, Kind);

fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: {} is not there", folder.display());
    None
}

fn load(folder: &std::path::Path, name: &str) -> ParticleSet {
    let path = folder.join(name);
    let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
    read(&path, &bytes).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn files_of_other_programs_have_their_particles() {
    let Some(folder) = folder() else { return };
    let files: [(&str, usize, &[Column]); 6] = [
        ("cube_8_particles.vtk", 8, &[("position", 3, Kind::F64)]),
        (
            "bunny_frame_14_7705_particles.vtk",
            7706,
            &[("position", 3, Kind::F32), ("id", 1, Kind::U32), ("velocity", 3, Kind::F32)],
        ),
        (
            "dam_break_frame_9_6859_particles.bgeo",
            6859,
            &[("position", 3, Kind::F32), ("id", 1, Kind::I32), ("density", 1, Kind::F32), ("velocity", 3, Kind::F32)],
        ),
        (
            "double_dam_break_frame_26_4732_particles.vtk",
            4732,
            &[("position", 3, Kind::F32), ("id", 1, Kind::U32), ("velocity", 3, Kind::F32)],
        ),
        (
            "fluid_250_particles.vtu",
            250,
            &[
                ("position", 3, Kind::F64),
                ("velocity", 3, Kind::F64),
                ("pressure", 1, Kind::F64),
                ("density", 1, Kind::F64),
                ("index", 1, Kind::I64),
            ],
        ),
        ("hilbert_46843_particles.bgeo", 46843, &[("position", 3, Kind::F32)]),
    ];
    for (name, count, attributes) in files {
        let set = load(&folder.join("splashsurf"), name);
        let found: Vec<_> = set.attributes.iter().map(|a| (a.name.as_str(), a.components, a.values.kind())).collect();
        assert_eq!(found, attributes, "{name}");
        assert_eq!((set.count, set.dropped), (count, 0), "{name}");
        assert!(set.notes.is_empty(), "{name}: {:?}", set.notes);
        for attribute in &set.attributes {
            assert_eq!(attribute.values.len(), count * attribute.components, "{name}");
        }
        assert_bounds(&set, name, 6.0);
    }
    let cube = load(&folder.join("splashsurf"), "cube_8_particles.vtk");
    assert_eq!((cube.min, cube.max), ([0.5, 0.499_509_5, 0.5], [1.0, 0.999_509_5, 1.0]));
}

fn assert_bounds(set: &ParticleSet, name: &str, largest: f32) {
    let positions = set.positions();
    for axis in 0..3 {
        let (min, max) = (set.min[axis], set.max[axis]);
        assert!(min < max && min.abs() < largest && max.abs() < largest, "{name}: {min} {max}");
        assert!(positions.iter().all(|p| (min..=max).contains(&p[axis])), "{name}");
    }
}

#[test]
fn one_frame_is_the_same_in_every_format() {
    let Some(folder) = folder() else { return };
    let original = load(&folder.join("splashsurf"), "dam_break_frame_9_6859_particles.bgeo");
    let bits = |set: &ParticleSet, name: &str| -> Option<Vec<u32>> {
        Some(set.attribute(name)?.to_f32().into_iter().map(f32::to_bits).collect())
    };
    let names = ["db6859.xyz", "db6859_bin.ply", "db6859_inline_binary.vtu", "db6859_v42.vtk", "db6859_v51_bin.vtk"];
    for name in names {
        let set = load(&folder.join("formats"), name);
        assert_eq!(set.count, 6859, "{name}");
        assert_eq!(bits(&set, "position"), bits(&original, "position"), "{name}");
        let has_more = !name.ends_with("xyz");
        assert_eq!(set.attribute("id").is_some(), has_more, "{name}");
        for attribute in ["density", "velocity"].into_iter().filter(|a| set.attribute(a).is_some()) {
            assert_eq!(bits(&set, attribute), bits(&original, attribute), "{name}: {attribute}");
        }
        if let Some(id) = set.attribute("id") {
            assert_eq!(Some(&id.values), original.attribute("id").map(|a| &a.values), "{name}");
        }
    }
}

#[test]
fn bakes_have_id_velocity_and_density() {
    let Some(folder) = folder() else { return };
    let bakes = [
        ("dd40k_22", 40432, 0.025),
        ("dd40k_30", 40432, 0.025),
        ("dd128k_22", 128_576, 0.0171),
        ("crown_76", 55760, 0.02),
        ("crown_80", 55760, 0.02),
        ("dd_sphere_20", 11492, 0.025),
        ("dd_sphere_26", 11492, 0.025),
    ];
    for (name, count, radius) in bakes {
        let set = load(&folder.join("bakes"), &format!("{name}.bgeo"));
        assert_eq!((set.count, set.dropped), (count, 0), "{name}");
        let kinds = ["id", "velocity", "density"].map(|a| set.attribute(a).map(|a| (a.components, a.values.kind())));
        assert_eq!(kinds, [Some((1, Kind::I32)), Some((3, Kind::F32)), Some((1, Kind::F32))], "{name}");
        assert_bounds(&set, name, 24.0);
        let mut ids = set.attribute("id").unwrap().to_i32();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), count, "{name}: each particle has an id of its own");
        let estimate = estimate_radius(&set.positions()).unwrap();
        assert!((0.95..1.05).contains(&(estimate / radius)), "{name}: {estimate}");
    }
    for (name, count) in [("bubbles", 6954), ("foam", 1057), ("spray", 286)] {
        let set = load(&folder.join("bakes"), &format!("dd128k_22_{name}.bgeo"));
        assert_eq!(set.count, count, "{name}");
    }
}
