//! Meshes from a scene to pixels: where bodies stand, which sides show, what materials are, what moves.

use std::path::PathBuf;

use base64::Engine as _;
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Gpu, GpuOptions};
use meniscus::files::MemoryFiles;
use meniscus::host::{Cache, Job, Moment, Session, load};

/// A square from -0.5 to 0.5 that faces +z, as a glTF file; `more` goes into its material, `node`
/// into its node, `rest` beside them.
pub fn square(more: &str, node: &str, rest: &str) -> String {
    let corners: [[f32; 3]; 4] = [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]];
    let uvs: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let indices: [u16; 6] = [0, 1, 2, 0, 2, 3];
    let times: [f32; 2] = [0.0, 1.0];
    let moves: [[f32; 3]; 2] = [[0.0; 3], [2.0, 0.0, 0.0]];
    let scales: [[f32; 3]; 2] = [[1.0; 3], [-1.0, 1.0, 1.0]];
    let mut bytes: Vec<u8> = Vec::new();
    bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(uvs.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(indices.iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(times.iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(moves.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(scales.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    let data = base64::prelude::BASE64_STANDARD.encode(&bytes);
    format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "scene": 0, "scenes": [{{ "nodes": [0] }}],
        "nodes": [{{ "mesh": 0 {node} }}],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0, "TEXCOORD_0": 1 }}, "indices": 2, "material": 0 }}] }}],
        "materials": [{{ {more} }}],
        "buffers": [{{ "byteLength": {}, "uri": "data:application/octet-stream;base64,{data}" }}],
        "bufferViews": [
            {{ "buffer": 0, "byteOffset": 0, "byteLength": 48 }}, {{ "buffer": 0, "byteOffset": 48, "byteLength": 32 }},
            {{ "buffer": 0, "byteOffset": 80, "byteLength": 12 }}, {{ "buffer": 0, "byteOffset": 92, "byteLength": 8 }},
            {{ "buffer": 0, "byteOffset": 100, "byteLength": 24 }}, {{ "buffer": 0, "byteOffset": 124, "byteLength": 24 }}],
        "accessors": [
            {{ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0] }},
            {{ "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" }},
            {{ "bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR" }},
            {{ "bufferView": 3, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1] }},
            {{ "bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC3" }},
            {{ "bufferView": 5, "componentType": 5126, "count": 2, "type": "VEC3" }}]
        {rest} }}"#,
        bytes.len()
    )
}

fn colored(color: &str, more: &str) -> String {
    square(&format!(r#""pbrMetallicRoughness": {{ "baseColorFactor": {color} }} {more}"#), "", "")
}

const WGSL: &str = r#"
#import "lib/meshes.wgsl"

struct Material {
    base_color_factor: vec4f,
    roughness_factor: f32,
}

var<uniform> material: Material;
var base_color_texture: texture_2d<f32>;
var base_color_sampler: sampler;
var<storage> meshes_bodies: array<mat4x4f>;
var<storage> meshes_instances: array<Instance>;

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

/// The picture shows x and y from -2 to 2.
@vertex
fn place(@location(0) position: vec3f, @location(3) uv0: vec2f, @location(1) instance: u32) -> Vertex {
    let i = meshes_instances[instance];
    let at = meshes_bodies[i.body] * i.body_from_mesh * vec4f(position, 1.0);
    return Vertex(vec4f(at.xy * 0.5, 0.5 + 0.1 * at.z, 1.0), uv0);
}

@fragment
fn paint(in: Vertex) -> @location(0) vec4f {
    let color = material.base_color_factor * textureSample(base_color_texture, base_color_sampler, in.uv);
    return vec4f(color.rgb, material.roughness_factor);
}
"#;

const RAISE: &str = r#"
var<storage> meshes_bodies: array<mat4x4f>;
var<storage> meshes_lift: array<f32>;
var<storage, read_write> raised: array<mat4x4f>;

@compute @workgroup_size(64)
fn raise(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&raised) {
        var body = meshes_bodies[id.x];
        body[3].y += meshes_lift[id.x];
        raised[id.x] = body;
    }
}
"#;

fn graph(values: &str, draws: &str) -> String {
    format!(
        r#"Graph(
    inputs: {{ "meshes": Meshes(optional: true, values: {{ {values} }}) }},
    resources: {{
        "color": Texture(format: Rgba16Float, size: "viewport"),
        "depth": Texture(format: Depth32Float, size: "viewport"),
        "raised": Buffer(items: "count(meshes.bodies)"),
    }},
    passes: [{draws}],
    outputs: ["color"],
)"#
    )
}

const DRAW: &str = r#"Draw(shader: "mesh.wgsl", meshes: "meshes", cull: Back, depth: Nearest("depth"),
    color: [(to: "color", clear: (0.0, 0.0, 0.0, 0.0))])"#;

fn scene(bodies: &str) -> String {
    format!(
        r#"Scene(graph: "graph.ron", camera: Camera(eye: (0, 0, 3), target: (0, 0, 0)), size: (64, 64),
    meshes: {{"meshes": [{bodies}]}})"#
    )
}

/// The files of a test: red and blue squares, the shader, a graph and a scene.
fn files(graph: String, scene: String) -> MemoryFiles {
    MemoryFiles::default()
        .with("red.gltf", colored("[1, 0, 0, 1]", ""))
        .with("blue.gltf", colored("[0, 0, 1, 1]", ""))
        .with("both_sides.gltf", colored("[0, 1, 0, 1]", r#", "doubleSided": true"#))
        .with("mesh.wgsl", WGSL)
        .with("raise.wgsl", RAISE)
        .with("graph.ron", graph)
        .with("scene.ron", scene)
}

/// The picture at points whose x and y go from -2 to 2.
fn seen(files: &MemoryFiles, moment: Moment, points: &[[f32; 2]]) -> Vec<[f32; 4]> {
    let (mut sources, mut cache) = (Sources::new(), Cache::default());
    let job = Job { source: PathBuf::from("scene.ron"), ..Job::default() };
    let loaded = load(files, &mut sources, &job, &mut cache);
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let mut session = Session::new(Gpu::open(&GpuOptions::default()).unwrap());
    session.build(loaded.content.unwrap_or_else(|| panic!("{said}"))).unwrap();
    let said = session.draw(moment, false).unwrap().diagnostics;
    assert!(said.iter().next().is_none(), "{}", render_all(&said, &sources, Style::Plain));
    let light = session.light().unwrap();
    let at = |[x, y]: &[f32; 2]| {
        let (column, row) = (((x + 2.0) * 16.0) as usize, ((2.0 - y) * 16.0) as usize);
        light.rgba[row * light.width as usize + column]
    };
    points.iter().map(at).collect()
}

const NOTHING: [f32; 4] = [0.0; 4];
const RED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];
const BLUE: [f32; 4] = [0.0, 0.0, 1.0, 1.0];
const GREEN: [f32; 4] = [0.0, 1.0, 0.0, 1.0];

pub fn bodies_stand_where_the_scene_says(_: &mut Engine) {
    let bodies = r#"(file: "red.gltf", position: (-1, 1, 0), scale: (1.5, 0.5, 1)), (file: "blue.gltf", position: (0, -1, 0),
        instances: [(), (position: (1, 0, 0), rotation: (0, 0, 45))])"#;
    let points = [[-1.6, 1.0], [-1.0, 1.4], [0.0, -1.0], [1.0, -1.0], [1.6, -1.0], [1.4, -1.4], [-1.0, -1.0]];
    let found = seen(&files(graph("", DRAW), scene(bodies)), Moment::default(), &points);
    assert_eq!(found, [RED, NOTHING, BLUE, BLUE, BLUE, NOTHING, NOTHING]);
}

pub fn fronts_stay_fronts(_: &mut Engine) {
    let bodies = r#"(file: "red.gltf", position: (-1, 1, 0)), (file: "red.gltf", position: (1, 1, 0), rotation: (0, 180, 0)),
        (file: "blue.gltf", position: (-1, -1, 0), scale: (-1, 1, 1)),
        (file: "blue.gltf", position: (0, -1, 0), scale: (-1, 1, 1), rotation: (0, 180, 0)),
        (file: "both_sides.gltf", position: (1, -1, 0), rotation: (0, 180, 0))"#;
    let points = [[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [0.0, -1.0], [1.0, -1.0]];
    let found = seen(&files(graph("", DRAW), scene(bodies)), Moment::default(), &points);
    assert_eq!(found, [RED, NOTHING, BLUE, NOTHING, GREEN]);
}

/// A shader raises each body by its value; one draw shows only what bears a tag.
pub fn tags_and_values_and_computed_bodies(_: &mut Engine) {
    let draws = r#"Compute(shader: "raise.wgsl", each: Item("meshes")),
        Draw(shader: "mesh.wgsl", meshes: "meshes", tags: ["floats", "flies"], bind: {"meshes_bodies": "raised"},
             depth: Nearest("depth"), color: [(to: "color", clear: (0.0, 0.0, 0.0, 0.0))])"#;
    let bodies = r#"(file: "red.gltf", position: (-1, 0, 0), tags: ["floats"], values: {"lift": 1}),
        (file: "red.gltf", position: (0, 0, 0), tags: ["sinks"]), (file: "blue.gltf", position: (1, 0, 0), tags: ["x", "flies"])"#;
    let files = files(graph(r#""lift": Float(default: -1.0)"#, draws), scene(bodies));
    let points = [[-1.0, 1.0], [-1.0, 0.0], [0.0, 0.0], [0.0, -1.0], [1.0, -1.0], [1.0, 0.0]];
    assert_eq!(seen(&files, Moment::default(), &points), [RED, NOTHING, NOTHING, NOTHING, BLUE, NOTHING]);
}

pub fn absent_meshes_are_no_bodies(_: &mut Engine) {
    let draw = DRAW.replace("(0.0, 0.0, 0.0, 0.0)", "(0.25, 0.5, 0.75, 1.0)");
    let scene = scene("").replace(r#"meshes: {"meshes": []}"#, "");
    let found = seen(&files(graph("", &draw), scene), Moment::default(), &[[0.0, 0.0]]);
    assert_eq!(found, [[0.25, 0.5, 0.75, 1.0]], "the target is cleared, and nothing drawn");
}

/// Two materials in one draw: a texture of two texels, looked up without a filter, and a factor.
pub fn materials_are_bound_by_name(_: &mut Engine) {
    let mut png = std::io::Cursor::new(Vec::new());
    // Left half of the light in numbers that eyes see as even; right blue.
    let picture =
        image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba(if x == 0 { [188, 0, 0, 255] } else { [0, 0, 255, 255] }));
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let uri = base64::prelude::BASE64_STANDARD.encode(png.into_inner());
    let textured = square(
        r#""pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "baseColorFactor": [0.5, 1, 1, 1], "roughnessFactor": 0.25 }"#,
        "",
        &format!(
            r#", "textures": [{{ "source": 0, "sampler": 0 }}], "samplers": [{{ "magFilter": 9728, "minFilter": 9728 }}],
            "images": [{{ "uri": "data:image/png;base64,{uri}" }}]"#
        ),
    );
    let bodies = r#"(file: "red.gltf", position: (-1, 0, 0)), (file: "textured.gltf", position: (1, 0, 0))"#;
    let files = files(graph("", DRAW), scene(bodies)).with("textured.gltf", textured);
    let found = seen(&files, Moment::default(), &[[-1.0, 0.0], [0.75, 0.0], [1.25, 0.0]]);
    assert_eq!(found[0], RED);
    // 188 of 255 in sRGB is half of the light, times the factor's half.
    assert!((found[1][0] - 0.25).abs() < 0.005 && found[1][1..] == [0.0, 0.0, 0.25], "{:?}", found[1]);
    assert_eq!(found[2], [0.0, 0.0, 1.0, 0.25]);
}

/// A node that moves by 2 along x in a second; over and over, or once; or not at all.
pub fn animations_move_nodes(_: &mut Engine) {
    let rest = r#", "animations": [{ "name": "go", "samplers": [{ "input": 3, "output": 4, "interpolation": "LINEAR" }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }]"#;
    let moving =
        square(r#""pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0, 1] }"#, r#", "translation": [0, 0, 0]"#, rest);
    let points = [[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]];
    let at = |how: &str, time_s: f64| {
        let body = format!(r#"(file: "moving.gltf", position: (-1, 0, 0), {how})"#);
        let files = files(graph("", DRAW), scene(&body)).with("moving.gltf", moving.clone());
        seen(&files, Moment::at_time(time_s), &points).iter().map(|c| *c == RED).collect::<Vec<_>>()
    };
    assert_eq!(at("", 0.0), [true, false, false]);
    assert_eq!(at(r#"animation: "go""#, 0.5), [false, true, false]);
    assert_eq!(at("", 1.5), [false, true, false], "it plays over and over");
    assert_eq!(at("loop: false", 1.5), [false, false, true], "it stays where it ended");
    assert_eq!(at("start: 0.5", 0.0), [false, true, false]);
    assert_eq!(at("animation: None", 0.5), [true, false, false]);
}

/// An animation that takes the scale along x from 1 to -1: no side is the front all the time.
pub fn what_turns_inside_out_on_its_way_stays_seen(_: &mut Engine) {
    let rest = r#", "animations": [{ "samplers": [{ "input": 3, "output": 5 }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "scale" } }] }]"#;
    let turning =
        square(r#""pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0, 1] }"#, r#", "scale": [1, 1, 1]"#, rest);
    let at = |how: &str, time_s: f64| {
        let files = files(graph("", DRAW), scene(&format!(r#"(file: "turning.gltf", loop: false, {how})"#)));
        seen(&files.with("turning.gltf", turning.clone()), Moment::at_time(time_s), &[[0.0, 0.0]])[0]
    };
    assert_eq!([at("", 0.0), at("", 1.0), at("scale: (-1, 1, 1)", 1.0)], [RED; 3]);
    // One that stands still has a back that is not seen.
    assert_eq!(at("animation: None, rotation: (0, 180, 0)", 1.0), NOTHING);
}

/// Two half-transparent squares, one before the other, also as bodies of one file and where time moves one of them.
pub fn what_blends_goes_from_back_to_front(_: &mut Engine) {
    let glass = |color: &str, more: &str, rest: &str| {
        let factors = format!(r#""pbrMetallicRoughness": {{ "baseColorFactor": {color}, "roughnessFactor": 0.5 }}"#);
        square(&format!(r#"{factors}, "alphaMode": "BLEND""#), more, rest)
    };
    let rest = r#", "animations": [{ "samplers": [{ "input": 3, "output": 4 }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }]"#;
    let draw = DRAW.replace(r#", depth: Nearest("depth")"#, "").replace("cull: Back", "cull: None");
    let draw = draw.replace("(0.0, 0.0, 0.0, 0.0)", "(0.0, 0.0, 0.0, 0.0), blend: Premultiplied");
    let over = |bodies: &str, eye_z: f64, time_s: f64| {
        let scene = scene(bodies).replace("eye: (0, 0, 3)", &format!("eye: (0, 0, {eye_z:?})"));
        let files = files(graph("", &draw), scene)
            .with("red.gltf", glass("[0.5, 0, 0, 1]", "", ""))
            .with("blue.gltf", glass("[0, 0, 0.5, 1]", "", ""))
            .with("moving.gltf", glass("[0, 0, 0.5, 1]", r#", "translation": [0, 0, 0]"#, rest));
        seen(&files, Moment::at_time(time_s), &[[0.0, 0.0]])[0]
    };
    let (red_over_blue, blue_over_red) = ([0.5, 0.0, 0.25, 0.75], [0.25, 0.0, 0.5, 0.75]);
    let (red, blue) =
        (r#"(file: "red.gltf", position: (0, 0, 0.5))"#, r#"(file: "blue.gltf", position: (0, 0, -0.5))"#);
    for bodies in [format!("{red}, {blue}"), format!("{blue}, {red}")] {
        assert_eq!(over(&bodies, 3.0, 0.0), red_over_blue, "{bodies}");
        assert_eq!(over(&bodies, -3.0, 0.0), blue_over_red, "{bodies}");
    }
    // Bodies of one file stand on both sides of the other.
    let around = r#"(file: "blue.gltf", instances: [(position: (0, 0, 1)), (position: (0, 0, -1))])"#;
    let three = [0.25, 0.0, 0.625, 0.875];
    assert_eq!(over(&format!("{red}, {around}"), 3.0, 0.0), three);
    // The node goes along x by 2, which the body turns into -z.
    let moving = r#"(file: "moving.gltf", position: (0, 0, 1), rotation: (0, 90, 0), loop: false)"#;
    let flat = r#"(file: "red.gltf", position: (0, 0, 0), rotation: (0, 90, 0))"#;
    let wide = |time_s: f64| over(&format!("{flat}, {moving}"), 3.0, time_s);
    assert_eq!([wide(0.0), wide(1.0)], [[0.0; 4]; 2], "both are seen from their edges");
}

/// A step adds up where a node is that moves by 2 along x in a second.
const ADD: &str = r#"
#import "lib/meshes.wgsl"

struct Params {
    step: u32,
}

var<uniform> params: Params;
var<storage, read> meshes_instances: array<Instance>;
var<storage, read_write> sum: array<f32>;

@compute @workgroup_size(1)
fn add() {
    if params.step == 0u {
        sum[0] = 0.0;
        sum[1] = 0.0;
    }
    sum[0] += meshes_instances[0].body_from_mesh[3].x;
    sum[1] += 1.0;
}
"#;

const SHOW: &str = r#"
var<storage, read> sum: array<f32>;

@fragment
fn show() -> @location(0) vec4f {
    return vec4f(sum[0], sum[1], 0.0, 1.0);
}
"#;

/// Steps see animated meshes where they are at the step's time, not at the frame's.
pub fn steps_see_meshes_move(_: &mut Engine) {
    let graph = r#"Graph(
        inputs: { "meshes": Meshes },
        state: { "sum": Buffer(items: 2) },
        resources: { "color": Texture(format: Rgba32Float, size: "viewport") },
        passes: [
            Steps(rate: 10, passes: [Compute(shader: "add.wgsl", groups: 1)]),
            Fullscreen(shader: "show.wgsl", color: ["color"]),
        ],
        outputs: ["color"],
    )"#;
    let rest = r#", "animations": [{ "samplers": [{ "input": 3, "output": 4 }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }]"#;
    let at = |how: &str, time_s: f64| {
        let scene = scene(&format!(r#"(file: "moving.gltf", {how})"#));
        let moving = square("", r#", "translation": [0, 0, 0]"#, rest);
        let files = files(graph.to_owned(), scene).with("moving.gltf", moving);
        let files = files.with("add.wgsl", ADD).with("show.wgsl", SHOW);
        let [sum, steps, ..] = seen(&files, Moment::at_time(time_s), &[[0.0, 0.0]])[0];
        (f64::from(sum), steps)
    };
    let (sum, steps) = at("loop: false", 0.55);
    assert!((sum - (0.2 + 0.4 + 0.6 + 0.8 + 1.0)).abs() < 1e-5 && steps == 5.0, "{sum} in {steps}");
    let (sum, steps) = at("loop: false", 1.25);
    assert!((sum - (2.0 * 5.5 + 2.0 * 2.0)).abs() < 1e-5 && steps == 12.0, "{sum} in {steps}");
    assert_eq!(at("animation: None", 1.25), (0.0, 12.0));
}

/// Steps that come earlier in the program are done before those that see meshes move.
pub fn steps_before_those_that_see_meshes_are_done_before(_: &mut Engine) {
    let graph = r#"Graph(
        inputs: { "meshes": Meshes },
        state: { "sum": Buffer(items: 2), "ticks": Buffer(items: 1) },
        resources: { "color": Texture(format: Rgba32Float, size: "viewport") },
        passes: [
            Steps(name: "tick", rate: 20, passes: [Compute(shader: "tick.wgsl", groups: 1)]),
            Steps(name: "add", rate: 10, passes: [Compute(shader: "add.wgsl", groups: 1)]),
            Fullscreen(shader: "show.wgsl", color: ["color"]),
        ],
        outputs: ["color"],
    )"#;
    let tick =
        "var<storage, read_write> ticks: array<f32>;\n@compute @workgroup_size(1) fn tick() { ticks[0] += 1.0; }";
    let add = ADD.replace("sum[1] += 1.0", "sum[1] += ticks[0]") + "\nvar<storage, read> ticks: array<f32>;\n";
    let rest = r#", "animations": [{ "samplers": [{ "input": 3, "output": 4 }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }]"#;
    let files = files(graph.to_owned(), scene(r#"(file: "moving.gltf", loop: false)"#));
    let files = files.with("moving.gltf", square("", r#", "translation": [0, 0, 0]"#, rest));
    let files = files.with("add.wgsl", &*add).with("tick.wgsl", tick).with("show.wgsl", SHOW);
    let [_, ticks, ..] = seen(&files, Moment::at_time(0.55), &[[0.0, 0.0]])[0];
    assert_eq!(ticks, 5.0 * 11.0, "five steps, each after all of the other eleven");
}

/// The bounds are those of all places that animations take bodies to.
pub fn bounds_cover_animations(_: &mut Engine) {
    let graph = r#"Graph(
        inputs: { "meshes": Meshes },
        resources: { "color": Texture(format: Rgba32Float, size: "viewport") },
        passes: [Fullscreen(shader: "bounds.wgsl", color: ["color"])],
        outputs: ["color"],
    )"#;
    let bounds = "struct Params { meshes_min: vec3f, meshes_max: vec3f }
        var<uniform> params: Params;
        @fragment fn ends() -> @location(0) vec4f { return vec4f(params.meshes_min.x, params.meshes_max.xyz); }";
    let rest = r#", "animations": [{ "samplers": [{ "input": 3, "output": 4 }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }]"#;
    let of = |how: &str| {
        let scene = scene(&format!(r#"(file: "moving.gltf", {how})"#));
        let moving = square("", r#", "translation": [0, 0, 0]"#, rest);
        let files = files(graph.to_owned(), scene).with("moving.gltf", moving).with("bounds.wgsl", bounds);
        seen(&files, Moment::default(), &[[0.0, 0.0]])[0]
    };
    assert_eq!(of("position: (0, 1, 0)"), [-0.5, 2.5, 1.5, 0.0]);
    assert_eq!(of("animation: None"), [-0.5, 0.5, 0.5, 0.0]);
}

/// Scenes of meshes alone: the shipped graphs show what is dry.
pub fn scenes_without_particles_are_dry(_: &mut Engine) {
    let of = |graph: &str, meshes: &str| {
        let view = r#"camera: Camera(eye: (0, 0, 3), target: (0, 0, 0)), size: (64, 64)"#;
        let light = r#"lights: {"sun": Light(direction: (-0.3, -0.5, -1.0), intensity: 4.0)}"#;
        format!("Scene(graph: {graph:?}, {view}, {light}, {meshes})")
    };
    for graph in ["imai2016.ron", "imai2014.ron", "iwasaki2006.ron"] {
        let files = files(String::new(), of(graph, r#"meshes: {"meshes": ["red.gltf"]}"#));
        let found = seen(&files, Moment::default(), &[[0.0, 0.0], [0.0, 1.9], [0.0, -1.2]]);
        let [middle, above, floor] = found[..] else { panic!() };
        assert!(middle[0] > 4.0 * middle[2] && middle[3] == 1.0, "{graph}: {middle:?}");
        assert_eq!(above, NOTHING, "{graph}");
        assert!(floor[3] > 0.9 && floor[0] < 4.0 * floor[2], "{graph}: {floor:?}");
    }
    // Who has neither forgot the particles.
    let nothing = of("imai2016.ron", "");
    let (mut sources, mut cache) = (Sources::new(), Cache::default());
    let job = Job { source: PathBuf::from("scene.ron"), ..Job::default() };
    let loaded = load(&MemoryFiles::default().with("scene.ron", nothing), &mut sources, &job, &mut cache);
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    assert!(said.contains("nothing feeds the input `particles`"), "{said}");
}

/// The dry scene with squares in it, under a sky that is the same everywhere.
fn lit(bodies: &str, sky: u8, (direction, sun): ((f64, f64, f64), f64), points: &[[f32; 2]]) -> Vec<[f32; 4]> {
    let mut png = std::io::Cursor::new(Vec::new());
    let picture = image::RgbaImage::from_pixel(8, 4, image::Rgba([sky, sky, sky, 255]));
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let graph = r#"Graph(
    inputs: { "camera": Camera, "particles": Particles(attributes: ["position"]), "sun": Light, "environment": Texture,
              "meshes": Meshes },
    passes: [
        Use(graph: "parts/environment.ron", name: "sky"),
        Use(graph: "parts/dry_scene.ron", name: "dry", bind: {"sky": "sky.cube", "ambient": "sky.ambient"}, params: {"floor": false}),
    ],
    outputs: ["dry.color"],
)"#;
    // From far above, so that 1 m is 16 pixels; y of the picture is -z of the world.
    let scene = format!(
        r#"Scene(graph: "graph.ron", camera: Camera(eye: (0, 400, 0), target: (0, 0, 0), up: (0, 0, -1), fov: 0.57295), size: (64, 64),
    lights: {{"sun": Light(direction: {direction:?}, intensity: {sun:?})}}, environment: "sky.png",
    particles: {{"particles": (file: "far.csv", radius: 0.01)}}, meshes: {{"meshes": [{bodies}]}})"#
    );
    let material = |more: &str| square(&format!(r#""pbrMetallicRoughness": {{ {more} }}"#), "", "");
    let files = MemoryFiles::default()
        .with("graph.ron", graph)
        .with("scene.ron", scene)
        .with("sky.png", png.into_inner())
        .with("far.csv", "x,y,z\n1.8,0,1.8\n1.8,0.02,1.8\n")
        .with("plastic.gltf", material(r#""metallicFactor": 0, "roughnessFactor": 0.6"#))
        .with("mirror.gltf", material(r#""metallicFactor": 1, "roughnessFactor": 0"#))
        .with("metal.gltf", material(r#""metallicFactor": 1, "roughnessFactor": 0.7"#));
    seen(&files, Moment::default(), points)
}

/// Under an even sky of radiance L nothing that absorbs nothing is brighter than L, and what scatters all of it is L.
pub fn an_even_sky_makes_white_things_as_bright_as_it(_: &mut Engine) {
    let flat = "rotation: (-90, 0, 0)";
    let bodies = format!(
        r#"(file: "plastic.gltf", position: (-1, 0, 0), {flat}), (file: "mirror.gltf", position: (1, 0, 0), {flat}),
        (file: "metal.gltf", position: (0, 0, -1), {flat}), (file: "plastic.gltf", position: (0, 0, 1), rotation: (-50, 0, 0))"#
    );
    for (sky, radiance) in [(255, 1.0), (188, 0.5)] {
        let found = lit(&bodies, sky, ((0.0, -1.0, 0.0), 0.0), &[[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]);
        for (what, color, low) in [
            ("plastic", found[0], 0.985),
            ("a mirror", found[1], 0.95),
            ("metal", found[2], 0.95),
            ("slanted", found[3], 0.985),
        ] {
            for channel in &color[..3] {
                let part = channel / radiance;
                assert!((low..1.015).contains(&part), "{what} shows {part} of a sky of {radiance}");
            }
            assert_eq!(color[3], 1.0, "{what}");
        }
    }
}

/// A small square half a metre above a large one, the sun aslant, and no sky.
pub fn meshes_cast_shadows_on_meshes(_: &mut Engine) {
    let flat = "rotation: (-90, 0, 0)";
    let bodies = format!(
        r#"(file: "plastic.gltf", scale: (3, 3, 1), {flat}), (file: "plastic.gltf", position: (0, 0.5, 0), scale: 0.8, {flat})"#
    );
    let points = [[0.0, 0.0], [-0.65, 0.0], [0.65, 0.0], [0.65, 0.7]];
    let found = lit(&bodies, 0, ((1.0, -1.0, 0.0), 3.0), &points);
    // Lambert: 3 cos 45° / pi, less what is mirrored, and a little of GGX.
    let is_lit = |color: &[f32; 4]| (0.6..0.75).contains(&color[0]);
    assert!(is_lit(&found[0]) && is_lit(&found[1]) && is_lit(&found[3]), "{found:?}");
    assert!(found[2][0] < 0.01, "in the shadow: {found:?}");
    let above = lit(&bodies, 0, ((-1.0, -1.0, 0.0), 3.0), &points);
    assert!(is_lit(&above[2]) && above[1][0] < 0.01, "the shadow lies on the other side now: {above:?}");
}

pub fn what_does_not_fit_is_told(_: &mut Engine) {
    let said = |graph: String, bodies: &str| {
        let (mut sources, mut cache) = (Sources::new(), Cache::default());
        let job = Job { source: PathBuf::from("scene.ron"), ..Job::default() };
        let go = |name: &str, output: u32, path: &str| {
            format!(
                r#"{{ "name": "{name}", "samplers": [{{ "input": 3, "output": {output} }}],
                "channels": [{{ "sampler": 0, "target": {{ "node": 0, "path": "{path}" }} }}] }}"#
            )
        };
        let animations = [go("go", 4, "translation"), go("turn", 5, "scale")].join(", ");
        let many = square("", r#", "name": "sail""#, &format!(r#", "animations": [{animations}]"#));
        let files = files(graph, scene(bodies)).with("many.gltf", many);
        let loaded = load(&files, &mut sources, &job, &mut cache);
        let mut all = loaded.diagnostics;
        if let Some(content) = loaded.content {
            let mut session = Session::new(Gpu::open(&GpuOptions::default()).unwrap());
            all.extend(session.build(content).map(|b| b.diagnostics).unwrap_or_else(|d| d));
        }
        render_all(&all, &sources, Style::Plain)
    };
    let plain = || graph("", DRAW);
    let lifting =
        graph(r#""lift": Float(max: 2.0)"#, &format!(r#"Compute(shader: "raise.wgsl", each: Item("meshes")), {DRAW}"#));
    for (graph, bodies, words) in [
        (plain(), r#"(file: "red.gltf", animation: "go")"#, "`red.gltf` has no animation `go`"),
        (plain(), r#"(file: "many.gltf")"#, "`many.gltf`: of its 2 animations the first is played, `go`"),
        (plain(), r#"(file: "many.gltf")"#, "`animation:` of a body chooses; there are also `turn`"),
        (plain(), r#"(file: "red.gltf", position: (0, 0, 1e19))"#, "it reaches beyond 1e18 m"),
        (
            plain(),
            r#"(file: "many.gltf", scale: 1e18)"#,
            "`many.gltf`: node `sail`: where the scene or an animation puts it",
        ),
        (plain(), r#"(file: "gone.gltf")"#, "there is no file `gone.gltf`"),
        (plain(), r#"(file: "mesh.wgsl")"#, "its extension is not that of a mesh file"),
        (plain(), r#"(file: "red.gltf", scale: (1, 0, 1))"#, "a scale of 0 leaves nothing of a body"),
        (plain(), r#"(file: "red.gltf", colour: 3)"#, "a body has no field `colour`"),
        (lifting.clone(), r#"(file: "red.gltf")"#, "body 0 of `meshes` has no value `lift`"),
        (lifting.clone(), r#"(file: "red.gltf", values: {"lift": 3})"#, "`lift` must be at most 2, and is 3"),
        (lifting, r#"(file: "red.gltf", values: {"lift": "high"})"#, "`lift` is a Float and cannot be high"),
    ] {
        let text = said(graph, bodies);
        assert!(text.contains(words), "no {words:?} in:\n{text}");
    }
}
