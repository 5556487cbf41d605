//! The meshes that scenes use, as `scripts/make_assets.py` makes them.

use std::collections::HashMap;
use std::path::PathBuf;

use glam::Vec3;
use meniscus::files::DiskFiles;
use meniscus::scene::meshes::{self, Primitive};

use super::said;

/// Whether each edge is walked once each way, so that nothing can be seen from behind. Vertices
/// count as one where they stand within a hundredth of a millimetre.
fn is_closed(primitive: &Primitive) -> bool {
    let at = |index: u32| primitive.positions[index as usize].map(|x| (x * 1e5).round() as i64);
    let mut edges: HashMap<_, i32> = HashMap::new();
    for triangle in primitive.indices.as_chunks::<3>().0 {
        let [a, b, c] = triangle.map(at);
        if a == b || b == c || c == a {
            continue;
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from, to)).or_default() += 1;
            *edges.entry((to, from)).or_default() -= 1;
        }
    }
    edges.values().all(|balance| *balance == 0)
}

/// What a primitive encloses, in cubic metres; positive if its fronts face outwards.
fn volume(primitive: &Primitive) -> f32 {
    let triangles = primitive.indices.as_chunks::<3>().0.iter();
    let six: f32 = triangles
        .map(|triangle| {
            let [a, b, c] = triangle.map(|index| Vec3::from_array(primitive.positions[index as usize]));
            a.dot(b.cross(c))
        })
        .sum();
    six / 6.0
}

#[test]
fn are_closed_and_face_outwards() {
    let tau = std::f32::consts::TAU;
    // Name, bounds, and about what each encloses.
    let expected = [
        ("block.obj", Vec3::new(0.4, 0.4, 0.4), 0.0625),
        ("pillar.obj", Vec3::new(0.32, 1.2, 0.32), 0.042),
        ("ring.obj", Vec3::new(0.66, 0.16, 0.66), tau * 0.25 * tau / 2.0 * 0.08 * 0.08),
        ("buoy.glb", Vec3::new(0.208, 0.357, 0.208), 0.005),
        ("boat.glb", Vec3::new(0.6, 0.17, 0.22), 0.0027),
    ];
    for (name, size, volumes) in expected {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/assets").join(name);
        let bytes = std::fs::read(&path).unwrap();
        let bundle = meshes::gather(&DiskFiles, &path, bytes.into());
        let model = meshes::read(&bundle).unwrap_or_else(|found| panic!("{}", said(&found, name)));
        assert!(model.diagnostics.is_empty(), "{}", said(&model.diagnostics, name));
        let bounds = model.bounds(&model.pose(None, 0.0)).unwrap();
        assert!((bounds.max - bounds.min).abs_diff_eq(size, 0.02), "{name}: {bounds:?}");
        let primitives = || model.meshes.iter().flat_map(|mesh| &mesh.primitives);
        let enclosed: f32 = primitives().map(volume).sum();
        assert!((enclosed / volumes - 1.0).abs() < 0.15, "{name}: {enclosed} of {volumes}");
        for primitive in primitives() {
            assert!(is_closed(primitive), "{name} has an open edge");
            for triangle in primitive.indices.as_chunks::<3>().0 {
                let [a, b, c] = triangle.map(|index| Vec3::from_array(primitive.positions[index as usize]));
                let normal: Vec3 = triangle.iter().map(|i| Vec3::from_array(primitive.normals[*i as usize])).sum();
                let face = (b - a).cross(c - a);
                assert!(face.length() < 1e-7 || face.normalize().dot(normal) > 0.5, "{name}: {a} {b} {c} {normal}");
            }
        }
    }
}
