//! `graphs/parts/signed_distance.ron` against distances in closed form.

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::{DMat3, DVec2, DVec3, DVec4};
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Gpu, GpuOptions};
use meniscus::files::MemoryFiles;
use meniscus::host::{Cache, Job, Moment, Session, load};

const GRAPH: &str = r#"Graph(
    inputs: { "meshes": Meshes },
    resources: { "color": Texture(format: Rgba32Float, size: "viewport") },
    passes: [
        Use(graph: "parts/signed_distance.ron", name: "field", params: {"cells": CELLS, "margin": 6}),
        Fullscreen(shader: "probe.wgsl", color: ["color"]),
    ],
    outputs: ["color"],
)"#;

/// Each pixel asks at a point of the grid's own box, half a margin inside: columns and rows go along x
/// and y, slabs along z.
const PROBE: &str = r#"
#import "lib/signed_distance.wgsl"

struct Params {
    field_low: vec3f,
    field_cell: f32,
}

var<uniform> params: Params;
var field_distance: texture_3d<f32>;

@fragment
fn probe(@location(0) uv: vec2f) -> @location(0) vec4f {
    let cells = vec3f(textureDimensions(field_distance)) - 6.0;
    let slab = floor(uv.x * 8.0);
    let at = vec3f(fract(uv.x * 8.0), uv.y, (slab + 0.3) / 8.0);
    let p = params.field_low + (3.0 + at * cells) * params.field_cell;
    return vec4f(p, signed_distance(field_distance, params.field_low, params.field_cell, p));
}
"#;

/// Points in the world and the distances that the part tells there.
fn probes(obj: String, bodies: &str, cells: u32) -> Vec<DVec4> {
    let scene = format!(
        r#"Scene(graph: "graph.ron", camera: Camera(eye: (0, 0, 3), target: (0, 0, 0)), size: (320, 40),
            meshes: {{"meshes": [{bodies}]}})"#
    );
    let files = MemoryFiles::default()
        .with("shape.obj", obj)
        .with("probe.wgsl", PROBE)
        .with("graph.ron", GRAPH.replace("CELLS", &cells.to_string()))
        .with("scene.ron", scene);
    let (mut sources, mut cache) = (Sources::new(), Cache::default());
    let job = Job { source: PathBuf::from("scene.ron"), ..Job::default() };
    let loaded = load(&files, &mut sources, &job, &mut cache);
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let mut session = Session::new(Gpu::open(&GpuOptions::default()).unwrap());
    session.build(loaded.content.unwrap_or_else(|| panic!("{said}"))).unwrap();
    session.draw(Moment::default(), false).unwrap();
    let light = session.light().unwrap();
    light.rgba.iter().map(|texel| DVec4::from_array(texel.map(f64::from))).collect()
}

/// The largest error, in metres.
fn worst(probes: &[DVec4], exact: impl Fn(DVec3) -> f64) -> f64 {
    probes.iter().map(|probe| (probe.w - exact(probe.truncate())).abs()).fold(0.0, f64::max)
}

/// Holds distances against a closed form: the error stays under a cell, both sides are there, and the
/// comparison tells the same shape a cell and a half away from it.
fn compare(probes: &[DVec4], cell: f64, exact: impl Fn(DVec3) -> f64) {
    let error = worst(probes, &exact);
    assert!(error < cell, "{error} m is not under {cell} m");
    let inside = probes.iter().filter(|probe| probe.w < 0.0).count();
    assert!(inside > 100 && inside < probes.len() / 2, "{inside} of {} are inside", probes.len());
    assert!(worst(probes, |p| exact(p - DVec3::new(1.5 * cell, 0.0, 0.0))) > cell);
}

const BOX: &str = "v -0.5 -0.5 -0.5\nv 0.5 -0.5 -0.5\nv 0.5 0.5 -0.5\nv -0.5 0.5 -0.5\n\
    v -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv 0.5 0.5 0.5\nv -0.5 0.5 0.5\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";

fn to_box(p: DVec3, half: DVec3) -> f64 {
    let q = p.abs() - half;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

/// A box that is turned, stretched and mirrored by its body.
pub fn of_a_box(_: &mut Engine) {
    let body = r#"(file: "shape.obj", position: (0.2, 0.1, -0.3), rotation: (0, 30, 0), scale: (-0.9, 0.5, 0.7))"#;
    let found = probes(BOX.into(), body, 32);
    let from_box = DMat3::from_rotation_y(30f64.to_radians());
    // The longest side of the box around it.
    let cell = (0.9 * 30f64.to_radians().cos() + 0.7 * 30f64.to_radians().sin()) / 32.0;
    compare(&found, cell, |p| {
        to_box(from_box.transpose() * (p - DVec3::new(0.2, 0.1, -0.3)), DVec3::new(0.45, 0.25, 0.35))
    });
}

/// A ball of 960 triangles, which is more than one batch. Its facets lie less than a sixth of a cell too deep.
pub fn of_a_sphere(_: &mut Engine) {
    let (rows, columns) = (16, 32);
    let mut obj = String::from("v 0 0.5 0\nv 0 -0.5 0\n");
    let vertex = |row: usize, column: usize| match row {
        0 => 1,
        row if row == rows => 2,
        row => 3 + (row - 1) * columns + column % columns,
    };
    for row in 1..rows {
        for column in 0..columns {
            let down = std::f64::consts::PI * row as f64 / rows as f64;
            let around = std::f64::consts::TAU * column as f64 / columns as f64;
            let (x, y, z) = (down.sin() * around.cos(), down.cos(), -down.sin() * around.sin());
            _ = writeln!(obj, "v {} {} {}", x / 2.0, y / 2.0, z / 2.0);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (vertex(row, column), vertex(row, column + 1));
            let (c, d) = (vertex(row + 1, column), vertex(row + 1, column + 1));
            let corners = [a, c, d, b];
            let face: Vec<usize> = (0..4).filter(|&k| corners[k] != corners[(k + 1) % 4]).map(|k| corners[k]).collect();
            let words: Vec<String> = face.iter().map(usize::to_string).collect();
            _ = writeln!(obj, "f {}", words.join(" "));
        }
    }
    let found = probes(obj, r#"(file: "shape.obj", position: (1, 2, 3))"#, 16);
    compare(&found, 1.0 / 16.0, |p| (p - DVec3::new(1.0, 2.0, 3.0)).length() - 0.5);
}

/// Two bodies of one file: the nearer one counts.
pub fn of_several_bodies(_: &mut Engine) {
    let body = r#"(file: "shape.obj", scale: 0.4, instances: [(position: (-0.7, 0, 0)), (position: (0.7, 0.1, 0))])"#;
    let found = probes(BOX.into(), body, 32);
    let middles = [DVec2::new(-0.28, 0.0), DVec2::new(0.28, 0.04)];
    compare(&found, 0.96 / 32.0, |p| {
        let to = middles.map(|middle| to_box(p - middle.extend(0.0), DVec3::splat(0.2)));
        to[0].min(to[1])
    });
}
