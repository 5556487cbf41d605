//! The maps of glTF's materials, on a square before the camera whose quarters have other texels each. What each quarter
//! sends to the camera is foretold from glTF 2.0's appendix B, in closed form.

use std::path::Path;

use glam::{DVec3, dvec3};
use meniscus::engine::Engine;
use meniscus::files::MemoryFiles;
use serde_json::{Value, json};

use crate::samples::{FOV_DEGREES, Lights, SIZE, View, lit, png};

const EYE: DVec3 = dvec3(0.0, 0.0, 5.0);
const GRAPHS: [&str; 2] = ["imai2016.ron", "iwasaki2006.ron"];
const DARK: Lights = Lights { sky: 0, sun: None };
/// The middles of the quarters, in the order of texels: the upper row first.
const QUARTERS: [[f64; 2]; 4] = [[-0.5, 0.5], [0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]];

/// A square from -1 to 1 that faces the camera, under a texture of two by two texels. Where it is mirrored the texture's
/// right is the square's left.
fn square(material: Value, texels: &[[u8; 3]; 4], is_mirrored: bool) -> MemoryFiles {
    let corners = [[-1.0_f32, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let mut binary: Vec<u8> = Vec::new();
    corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]).for_each(|x| binary.extend(x.to_le_bytes()));
    corners.iter().flat_map(|_| [0.0_f32, 0.0, 1.0]).for_each(|x| binary.extend(x.to_le_bytes()));
    let u = |x: f32| if is_mirrored { (1.0 - x) / 2.0 } else { (1.0 + x) / 2.0 };
    corners.iter().flat_map(|[x, y]| [u(*x), (1.0 - y) / 2.0]).for_each(|x| binary.extend(x.to_le_bytes()));
    [0_u16, 2, 1, 1, 2, 3].iter().for_each(|index| binary.extend(index.to_le_bytes()));
    let view = |offset: u32, length: u32| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    let accessor = |view: u32, count: u32, kind: u32, shape: &str| {
        let mut accessor = json!({"bufferView": view, "count": count, "componentType": kind, "type": shape});
        if view == 0 {
            (accessor["min"], accessor["max"]) = (json!([-1, -1, 0]), json!([1, 1, 0]));
        }
        accessor
    };
    let file = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "square.bin", "byteLength": binary.len()}],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 32), view(128, 12)],
        "accessors": [
            accessor(0, 4, 5126, "VEC3"), accessor(1, 4, 5126, "VEC3"),
            accessor(2, 4, 5126, "VEC2"), accessor(3, 6, 5123, "SCALAR"),
        ],
        "images": [{"uri": "map.png"}],
        "samplers": [{"magFilter": 9728, "minFilter": 9728}],
        "textures": [{"source": 0, "sampler": 0}],
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "materials": [material],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0,
        }]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    });
    let files = MemoryFiles::default().with("square.gltf", file.to_string());
    files.with("square.bin", binary).with("map.png", png(2, texels))
}

/// The light of each quarter.
fn quarters(engine: &mut Engine, graph: &str, files: MemoryFiles, lights: &Lights) -> [DVec3; 4] {
    let view = View { eye: EYE, target: DVec3::ZERO };
    let light = lit(engine, graph, files, Path::new("square.gltf"), &view, lights, 0.0);
    let to_pixel = f64::from(SIZE[1]) / 2.0 / (EYE.z * (FOV_DEGREES.to_radians() / 2.0).tan());
    QUARTERS.map(|[x, y]| {
        let [column, row] = [f64::from(SIZE[0]) / 2.0 + x * to_pixel, f64::from(SIZE[1]) / 2.0 - y * to_pixel];
        let [r, g, b, a] = light[row as usize * SIZE[0] as usize + column as usize];
        assert_eq!(a, 1.0, "the square is there");
        dvec3(r.into(), g.into(), b.into())
    })
}

/// What a surface sends to the eye from a light of intensity 1: the mix of a
/// dielectric and a metal in glTF 2.0's appendix B.2, with the functions of B.3.
fn sent(base: DVec3, metallic: f64, roughness: f64, normal: DVec3, [x, y]: [f64; 2], to_light: DVec3) -> DVec3 {
    let (to_eye, to_light) = ((EYE - dvec3(x, y, 0.0)).normalize(), to_light.normalize());
    let half = (to_eye + to_light).normalize();
    let (nl, nv, nh, vh) = (normal.dot(to_light), normal.dot(to_eye), normal.dot(half), to_eye.dot(half));
    let squared = roughness.powi(4);
    let distribution = squared / (std::f64::consts::PI * (nh * nh * (squared - 1.0) + 1.0).powi(2));
    let shadowed = |cosine: f64| cosine + (squared + (1.0 - squared) * cosine * cosine).sqrt();
    let specular = distribution / (shadowed(nl) * shadowed(nv));
    let rest = (1.0 - vh.abs()).powi(5);
    let fresnel = 0.04 + 0.96 * rest;
    let dielectric = base * (1.0 - fresnel) / std::f64::consts::PI + fresnel * specular;
    let metal = (base + (1.0 - base) * rest) * specular;
    dielectric.lerp(metal, metallic) * nl.max(0.0)
}

/// By how much a light is off what was foretold, of the larger.
fn off(found: &[DVec3; 4], foretold: &[DVec3; 4]) -> f64 {
    let of = |(a, b): (&DVec3, &DVec3)| (*a - *b).abs().max_element() / a.max(*b).max_element().max(1e-3);
    found.iter().zip(foretold).map(of).fold(0.0, f64::max)
}

/// The renderer weighs what is scattered by all that is mirrored, appendix B by what this one light is: they differ so much.
const NEAR: f64 = 0.06;

pub fn normal_maps_turn_normals(engine: &mut Engine) {
    GRAPHS.into_iter().for_each(|graph| normal_maps_turn_normals_in(engine, graph));
}

fn normal_maps_turn_normals_in(engine: &mut Engine, graph: &str) {
    let base = dvec3(0.8, 0.4, 0.2);
    let texels = [[192, 128, 230], [64, 160, 220], [128, 220, 200], [140, 40, 220]];
    let to_light = dvec3(0.5, 0.7, 1.0);
    for (scale, is_mirrored) in [(1.0, false), (0.5, false), (1.0, true)] {
        let material = json!({
            "pbrMetallicRoughness": {"baseColorFactor": [base.x, base.y, base.z, 1.0], "metallicFactor": 0.0},
            "normalTexture": {"index": 0, "scale": scale},
        });
        let found =
            quarters(engine, graph, square(material, &texels, is_mirrored), &Lights { sky: 0, sun: Some(to_light) });
        // A texture's right and up are those of the square, and its right the square's left where that is mirrored.
        let foretold = |signs: DVec3| {
            std::array::from_fn(|quarter| {
                let texel = texels[if is_mirrored { quarter ^ 1 } else { quarter }];
                let [x, y, z] = texel.map(|texel| f64::from(texel) / 255.0 * 2.0 - 1.0);
                let normal = (dvec3(x * scale, y * scale, z) * signs).normalize();
                sent(base, 0.0, 1.0, normal, QUARTERS[quarter], to_light)
            })
        };
        let right = if is_mirrored { -1.0 } else { 1.0 };
        let found_off = off(&found, &foretold(dvec3(right, 1.0, 1.0)));
        assert!(found_off < NEAR, "{graph} {scale} {is_mirrored}: {found_off}, {found:?}");
        for (wrong, what) in [(dvec3(-right, 1.0, 1.0), "left for right"), (dvec3(right, -1.0, 1.0), "down for up")] {
            assert!(off(&found, &foretold(wrong)) > 2.0 * NEAR, "{graph} {scale} {is_mirrored}: {what} is seen");
        }
        assert!(
            off(&found, &foretold(dvec3(0.0, 0.0, 1.0))) > 2.0 * NEAR,
            "{graph} {scale} {is_mirrored}: none is seen"
        );
    }
}

pub fn green_is_rough_and_blue_is_metal(engine: &mut Engine) {
    GRAPHS.into_iter().for_each(|graph| green_is_rough_and_blue_is_metal_in(engine, graph));
}

fn green_is_rough_and_blue_is_metal_in(engine: &mut Engine, graph: &str) {
    let base = dvec3(0.9, 0.6, 0.3);
    let texels = [[255, 100, 0], [0, 140, 255], [90, 200, 128], [255, 255, 20]];
    let to_light = dvec3(0.4, 0.5, 1.0);
    let material = json!({"pbrMetallicRoughness": {
        "baseColorFactor": [base.x, base.y, base.z, 1.0], "metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.9,
    }});
    let found = quarters(engine, graph, square(material, &texels, false), &Lights { sky: 0, sun: Some(to_light) });
    let foretold = |rough: usize, metal: usize| {
        std::array::from_fn(|quarter| {
            let [roughness, metallic] = [rough, metal].map(|channel| f64::from(texels[quarter][channel]) / 255.0);
            sent(base, metallic, (roughness * 0.9).max(0.04), DVec3::Z, QUARTERS[quarter], to_light)
        })
    };
    assert!(off(&found, &foretold(1, 2)) < NEAR, "{graph}: {found:?} for {:?}", foretold(1, 2));
    for (rough, metal) in [(2, 1), (0, 2), (1, 0)] {
        assert!(off(&found, &foretold(rough, metal)) > 2.0 * NEAR, "channels {rough} and {metal} are seen");
    }
}

pub fn red_keeps_the_light_of_the_sky_out(engine: &mut Engine) {
    GRAPHS.into_iter().for_each(|graph| red_keeps_the_light_of_the_sky_out_in(engine, graph));
}

fn red_keeps_the_light_of_the_sky_out_in(engine: &mut Engine, graph: &str) {
    let texels = [[255, 0, 10], [128, 255, 10], [60, 90, 255], [0, 255, 90]];
    let material = |strength: Option<f64>| {
        let mut material =
            json!({"pbrMetallicRoughness": {"metallicFactor": 0.0, "baseColorFactor": [0.5, 0.5, 0.5, 1.0]}});
        if let Some(strength) = strength {
            material["occlusionTexture"] = json!({"index": 0, "strength": strength});
        }
        material
    };
    let sky = Lights { sky: 255, sun: None };
    let open = quarters(engine, graph, square(material(None), &texels, false), &sky);
    assert!(
        open.iter().all(|light| (0.45..0.6).contains(&light.x)),
        "an even sky shows the base colour: {graph}: {open:?}"
    );
    for strength in [1.0, 0.75] {
        let found = quarters(engine, graph, square(material(Some(strength)), &texels, false), &sky);
        let foretold = |channel: usize| {
            let left = |quarter: usize| 1.0 + strength * (f64::from(texels[quarter][channel]) / 255.0 - 1.0);
            std::array::from_fn(|quarter| open[quarter] * left(quarter))
        };
        assert!(off(&found, &foretold(0)) < 0.01, "{graph} {strength}: {found:?} for {:?}", foretold(0));
        assert!(off(&found, &foretold(1)) > 0.1 && off(&found, &foretold(2)) > 0.1, "another channel is seen");
        // Light that falls straight in is not kept out.
        let sun = Lights { sky: 0, sun: Some(dvec3(0.0, 0.5, 1.0)) };
        let [with, without] =
            [Some(strength), None].map(|some| quarters(engine, graph, square(material(some), &texels, false), &sun));
        assert!(off(&with, &without) < 0.01, "{graph} {strength}: {with:?} for {without:?}");
    }
}

pub fn what_glows_needs_no_light(engine: &mut Engine) {
    GRAPHS.into_iter().for_each(|graph| what_glows_needs_no_light_in(engine, graph));
}

fn what_glows_needs_no_light_in(engine: &mut Engine, graph: &str) {
    let texels = [[255, 128, 0], [64, 64, 64], [0, 0, 0], [10, 200, 255]];
    let factor = dvec3(0.5, 1.0, 0.25);
    let material = json!({
        "emissiveFactor": [factor.x, factor.y, factor.z], "emissiveTexture": {"index": 0},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3.0}},
    });
    let found = quarters(engine, graph, square(material, &texels, false), &DARK);
    let foretold = |linear: fn(f64) -> f64| {
        texels.map(|texel| {
            let [r, g, b] = texel.map(|x| linear(f64::from(x) / 255.0));
            dvec3(r, g, b) * factor * 3.0
        })
    };
    let from_srgb = |x: f64| if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
    assert!(off(&found, &foretold(from_srgb)) < 0.01, "{graph}: {found:?} for {:?}", foretold(from_srgb));
    assert!(off(&found, &foretold(|x| x)) > 0.1, "texels taken for linear are seen");
}
