//! Cameras of mesh files: where they stand in closed form, when they move, and what is said of those that are none.

use std::path::PathBuf;

use glam::DVec3;
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Gpu, GpuOptions};
use meniscus::files::MemoryFiles;
use meniscus::host::{Cache, Content, Job, Moment, Session, load};

use super::meshes::square;

/// The picture is where the camera is and, as alpha, the tangent of half its field of view.
const WGSL: &str = "
struct Camera {
    position: vec3f,
    tan_half_fov: vec2f,
}
var<uniform> camera: Camera;

@fragment
fn tell(@location(0) uv: vec2f) -> @location(0) vec4f {
    return vec4f(camera.position, camera.tan_half_fov.y);
}
";

const GRAPH: &str = r#"Graph(
    inputs: { "camera": Camera },
    resources: { "color": Texture(format: Rgba32Float, size: "viewport") },
    passes: [Fullscreen(shader: "tell.wgsl", color: ["color"])],
    outputs: ["color"],
)"#;

/// Turned by 90 degrees about y, it looks along -x.
const TURNED: &str = r#", "name": "bow", "camera": 0, "translation": [1, 2, 3],
    "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476]"#;
/// `cameras` with one that has a right angle from top to bottom.
const WIDE: &str = r#", "cameras": [{ "name": "lens", "type": "perspective", "perspective": { "yfov": 1.5707963267948966, "znear": 0.1 } }]"#;
/// By 2 along x in a second.
const MOVED: &str = r#", "animations": [{ "name": "go", "samplers": [{ "input": 3, "output": 4 }],
    "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }]"#;

fn files(camera: &str, gltf: String) -> MemoryFiles {
    MemoryFiles::default()
        .with("a.gltf", gltf)
        .with("tell.wgsl", WGSL)
        .with("graph.ron", GRAPH)
        .with("scene.ron", format!(r#"Scene(graph: "graph.ron", camera: {camera}, size: (8, 4))"#))
}

/// What is loaded, and all that is said.
fn loaded(files: &MemoryFiles, job: Job) -> (Option<Content>, String) {
    let (mut sources, mut cache) = (Sources::new(), Cache::default());
    let job = Job { source: PathBuf::from("scene.ron"), ..job };
    let loaded = load(files, &mut sources, &job, &mut cache);
    (loaded.content, render_all(&loaded.diagnostics, &sources, Style::Plain))
}

fn session(files: &MemoryFiles, job: Job) -> Session {
    let (content, said) = loaded(files, job);
    let mut session = Session::new(Gpu::open(&GpuOptions::default()).unwrap());
    session.build(content.unwrap_or_else(|| panic!("{said}"))).unwrap();
    session
}

fn told(session: &mut Session) -> [f32; 4] {
    session.light().unwrap().rgba[0]
}

pub fn stand_where_their_node_does(_: &mut Engine) {
    let close = |a: DVec3, b: [f64; 3]| a.abs_diff_eq(b.into(), 1e-6);
    let turned = || square("", TURNED, WIDE);
    for (said, eye, forward, up) in [
        (r#"Camera(file: "a.gltf")"#, [1.0, 2.0, 3.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        (
            r#"(file: "a.gltf", name: "bow", position: (0, 0, 1), scale: 2)"#,
            [2.0, 4.0, 7.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
        ),
        (r#"(file: "a.gltf", name: "lens", rotation: (0, 90, 0))"#, [3.0, 2.0, -1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        (r#"(file: "a.gltf", up: Z)"#, [1.0, 3.0, -2.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]),
    ] {
        let (content, words) = loaded(&files(said, turned()), Job::default());
        let camera = content.unwrap_or_else(|| panic!("{words}")).camera;
        let found = (camera.target - camera.eye).normalize();
        assert!(close(camera.eye, eye) && close(found, forward) && close(camera.up, up), "{said}: {camera:?}");
        assert!((camera.fov_degrees - 90.0).abs() < 1e-4, "{said}: {camera:?}");
        let near = if said.contains("scale") { 0.2 } else { 0.1 };
        assert!((camera.near_m() - near).abs() < 1e-6, "{said}: {camera:?}");
    }
    let [x, y, z, tan] = {
        let mut session = session(&files(r#"Camera(file: "a.gltf")"#, turned()), Job::default());
        session.draw(Moment::default(), false).unwrap();
        told(&mut session)
    };
    assert!((tan - 1.0).abs() < 1e-5 && [x, y, z] == [1.0, 2.0, 3.0], "{x} {y} {z} {tan}");
}

pub fn move_as_their_node_does(_: &mut Engine) {
    let moving = || square("", r#", "camera": 0, "translation": [0, 0, 0]"#, &format!("{WIDE}{MOVED}"));
    let x_at = |said: &str, job: Job, times: &[f64]| {
        let mut session = session(&files(said, moving()), job);
        let x = |time_s: &f64| {
            session.draw_next(Moment::at_time(*time_s), false).unwrap();
            told(&mut session)[0]
        };
        times.iter().map(x).collect::<Vec<_>>()
    };
    let times = [0.0, 0.25, 0.5, 1.25];
    assert_eq!(x_at(r#"Camera(file: "a.gltf")"#, Job::default(), &times), [0.0, 0.5, 1.0, 0.5]);
    assert_eq!(x_at(r#"Camera(file: "a.gltf", loop: false)"#, Job::default(), &times), [0.0, 0.5, 1.0, 2.0]);
    assert_eq!(x_at(r#"Camera(file: "a.gltf", animation: None)"#, Job::default(), &times), [0.0; 4]);
    assert_eq!(x_at(r#"Camera(file: "a.gltf", animation: "go", start: 0.5)"#, Job::default(), &times[..2]), [1.0, 1.5]);
    // A file of nothing but a camera is one without a fault.
    let alone = square("", r#", "camera": 0"#, WIDE).replacen(r#""mesh": 0 ,"#, "", 1);
    let (content, words) = loaded(&files(r#"Camera(file: "a.gltf")"#, alone), Job::default());
    assert!(content.is_some() && words.is_empty(), "{words}");
    // What the command line says stands still.
    let job = Job { eye: Some([7.0, 0.0, 0.0]), ..Job::default() };
    assert_eq!(x_at(r#"Camera(file: "a.gltf")"#, job, &times[..2]), [7.0; 2]);
}

pub fn that_cannot_be_looked_through_are_told(_: &mut Engine) {
    let of = |lens: &str| {
        square("", r#", "name": "bow", "camera": 0"#, &format!(r#", "cameras": [{{ "name": "lens" {lens} }}]"#))
    };
    let perspective = |yfov: &str, znear: &str| {
        of(&format!(r#", "type": "perspective", "perspective": {{ "yfov": {yfov}, "znear": {znear} }}"#))
    };
    let top = r#", "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 9 }"#;
    let plain = r#"Camera(file: "a.gltf")"#;
    for (said, gltf, words) in [
        (
            plain,
            perspective("-3", "0.1"),
            "`a.gltf`: its camera `bow` cannot be looked through: its `yfov` is not between 0 and pi",
        ),
        (plain, perspective("0.8", "0"), "cannot be looked through: its `znear` is not above 0"),
        (plain, of(""), "cannot be looked through: it has neither `perspective` nor `orthographic`"),
        (plain, of(top), "`a.gltf`: its camera `bow` is orthographic, which is not drawn"),
        (plain, square("", "", ""), "`a.gltf` has no camera"),
        (r#"Camera(file: "a.gltf", name: "box")"#, perspective("0.8", "0.1"), "did you mean `bow`?"),
        (r#"Camera(file: "a.gltf", name: "stern")"#, square("", "", ""), "the file has no cameras"),
        (r#"Camera(file: "gone.gltf")"#, perspective("0.8", "0.1"), "there is no file `gone.gltf`"),
        (r#"Camera(file: "a.gltf", animation: "go")"#, perspective("0.8", "0.1"), "`a.gltf` has no animation `go`"),
        (
            r#"Camera(file: "a.gltf", eye: (0, 0, 1))"#,
            perspective("0.8", "0.1"),
            "`Camera` of a file has no field `eye`",
        ),
        (r#"Light(file: "a.gltf")"#, perspective("0.8", "0.1"), "Light"),
    ] {
        let (content, found) = loaded(&files(said, gltf), Job::default());
        assert!(content.is_none() && found.contains(words), "no {words:?} in:\n{found}");
    }
}
