//! What blends before, within and beside the liquid, in every method: the liquid is seen through it.

use meniscus::engine::Engine;
use meniscus::files::MemoryFiles;
use serde_json::json;

use crate::submerged::{ABOVE, light, pool};

const GRAPHS: [&str; 3] = ["imai2016.ron", "imai2014.ron", "iwasaki2006.ron"];
const SIZE: [u32; 2] = [96, 72];
const RED: f32 = 0.8;

/// A level square of 0.6 m that shines red, so much of it as `alpha` says, in or above a pool 0.5 m deep. Below an alpha of
/// a half it casts no shadow.
fn glass(graph: &str, alpha: f32, height_m: f64, layers: usize) -> MemoryFiles {
    let corners = [[-0.3_f32, -0.3], [-0.3, 0.3], [0.3, 0.3], [0.3, -0.3]];
    let mut binary: Vec<u8> = Vec::new();
    corners.iter().flat_map(|[x, z]| [*x, 0.0, *z]).for_each(|x| binary.extend(x.to_le_bytes()));
    [0_u16, 1, 2, 0, 2, 3].iter().for_each(|index| binary.extend(index.to_le_bytes()));
    let file = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "glass.bin", "byteLength": binary.len()}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "accessors": [
            {"bufferView": 0, "count": 4, "componentType": 5126, "type": "VEC3", "min": [-0.3, 0, -0.3], "max": [0.3, 0, 0.3]},
            {"bufferView": 1, "count": 6, "componentType": 5123, "type": "SCALAR"},
        ],
        "extensionsUsed": ["KHR_materials_unlit"],
        "materials": [{
            "pbrMetallicRoughness": {"baseColorFactor": [RED, 0, 0, alpha]}, "alphaMode": "BLEND", "doubleSided": true,
            "extensions": {"KHR_materials_unlit": {}},
        }],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    });
    pool(graph, "glass.gltf", ABOVE, height_m, layers).with("glass.gltf", file.to_string()).with("glass.bin", binary)
}

/// How far a picture is at most from glass over another one, around a place of the picture.
fn off(with: &[[f32; 4]], without: &[[f32; 4]], alpha: f32, [x, y]: [usize; 2]) -> f32 {
    let pixels = (y - 4..y + 4).flat_map(|row| (x - 8..x + 8).map(move |column| row * SIZE[0] as usize + column));
    let of = |at: usize| {
        let over = |channel: usize| [RED, 0.0, 0.0, 1.0][channel] * alpha + (1.0 - alpha) * without[at][channel];
        (0..4).map(|channel| (with[at][channel] - over(channel)).abs()).fold(0.0, f32::max)
    };
    pixels.map(of).fold(0.0, f32::max)
}

pub fn the_liquid_is_seen_through_glass_before_it(engine: &mut Engine) {
    // Where the square's middle is in the picture.
    let (high, alpha, middle) = (0.9, 0.4, [48, 22]);
    for graph in GRAPHS {
        let [with, without, dry] = [(alpha, 10), (0.0, 10), (0.0, 0)].map(|(alpha, layers)| {
            light(engine, &glass(graph, alpha, high, layers), &[("absorption", "3,1,0.5")], SIZE)
        });
        let found = off(&with, &without, alpha, middle);
        assert!(found < 0.004, "{graph}: {found} from the liquid behind the glass");
        // The dry scene behind it must not do, nor the liquid alone, nor the glass alone.
        for (other, alpha, what) in
            [(&dry, alpha, "no liquid"), (&without, 0.0, "no glass"), (&without, 1.0, "no light through it")]
        {
            let found = off(&with, other, alpha, middle);
            assert!(found > 0.04, "{graph}: {what} is seen, within {found}");
        }
    }
}

pub fn glass_behind_the_liquid_is_seen_through_it(engine: &mut Engine) {
    for graph in GRAPHS {
        let clear = |engine: &mut Engine, alpha: f32| {
            light(engine, &glass(graph, alpha, 0.2, 10), &[("absorption", "0,0,0")], SIZE)
        };
        let [with, without] = [0.4, 0.0].map(|alpha| clear(engine, alpha));
        let redder = |(a, b): &(&[f32; 4], &[f32; 4])| a[0] - a[1] > b[0] - b[1] + 0.1;
        let found = with.iter().zip(&without).filter(redder).count();
        // As many as the square has pixels, see the submerged one of paint.
        assert!(found > 250, "{graph}: {found} pixels are redder for glass in the liquid");
    }
}
