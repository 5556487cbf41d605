//! The window without its window: files that change, parameters, resources, recording, a lost device.

#![cfg(feature = "viewer")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "viewer/desk.rs"]
mod desk;
#[path = "viewer/dropped.rs"]
mod dropped;
#[path = "viewer/graph.rs"]
mod graph;
#[path = "support/project.rs"]
mod project;
#[path = "viewer/sequences.rs"]
mod sequences;
#[path = "viewer/statistics.rs"]
mod statistics;
#[path = "viewer/trouble.rs"]
mod trouble;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use meniscus::engine::{Gpu, GpuOptions};
use meniscus::graph::value::Value;
use meniscus::viewer::action::Action;
use meniscus::viewer::core::{Recording, Tick};
use meniscus::viewer::look::{Look, SeenContent};

use desk::{Desk, PATIENCE, SCENE};
use project::{Project, has_adapter};

const SHADER: &str = "shaders/dots/discs.wgsl";

#[test]
fn a_broken_shader_keeps_the_picture_and_a_mended_one_shows() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    assert!(first == desk.fresh(), "not what `render` draws");

    desk.edit(SHADER, "settings.color * light", "settings.hue * light");
    let findings = desk.core.state.findings.clone().unwrap();
    assert!(findings.is_stale && findings.counts().0 == 1, "{findings:?}");
    assert!(!desk.core.state.reloads[0].is_good);
    assert!(desk.picture() == first, "the picture changed");

    desk.edit(SHADER, "settings.hue * light", "settings.color.zyx * light");
    let second = desk.picture();
    assert!(desk.core.state.findings.as_ref().is_none_or(|f| !f.is_stale));
    assert!(second != first && second == desk.fresh(), "the change does not show");
    assert_eq!((desk.core.state.reloads[0].is_good, desk.core.state.reloads[0].pipelines_built), (true, 1));

    // A bad graph and a bad shader at once, then both good.
    desk.edit("graphs/dots.ron", "topology: TriangleStrip", "topology: Strip");
    assert!(desk.picture() == second);
    desk.edit("graphs/dots.ron", "topology: Strip", "topology: TriangleStrip");
    assert!(desk.picture() == second);
}

#[test]
fn a_still_scene_draws_nothing() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    desk.rest();
    let frames = desk.core.state.frames;
    for _ in 0..50 {
        assert_eq!(desk.core.tick(Instant::now()), Tick::default());
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(desk.core.state.frames, frames);
    // And one that is moved draws: the planted opposite.
    let mut camera = desk.core.state.camera.unwrap();
    camera.eye.x += 0.1;
    desk.core.act(Action::Camera(camera));
    desk.rest();
    assert!(desk.core.state.frames > frames);
}

#[test]
fn a_changed_parameter_is_saved_and_all_else_stays() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    let before = desk.project.text(SCENE);
    let set = |path: &str, value| Action::Set { path: path.into(), value: Some(value) };
    desk.core.act(set("size", Value::Float(3.0)));
    desk.core.act(set("present.tone", Value::Word("none".into())));
    let changed = desk.picture();
    assert!(changed != first, "the parameter does not show");
    assert_eq!(desk.project.text(SCENE), before, "nobody asked to save");

    desk.core.act(Action::Save);
    assert!(desk.notice().starts_with("2 values saved"), "{}", desk.notice());
    let expected = before
        .replace("\"size\": 1.5", "\"size\": 3.0")
        .replace("{ \"exposure\": 0.0 }", "{ \"exposure\": 0.0, \"tone\": \"none\" }");
    assert_eq!(desk.project.text(SCENE), expected);
    desk.until("the saved scene to be read", |core| core.state.overrides.is_empty());
    assert!(desk.picture() == changed && changed == desk.fresh());

    desk.core.act(Action::SaveCamera);
    let eye = "camera: Camera(eye: (1.2, 1.1, 1.6), target: (0.0, 0.45, 0.0), fov: 40.0)";
    assert!(desk.project.text(SCENE).contains(eye), "{}", desk.project.text(SCENE));

    // A scene that is no scene any more is not written over.
    desk.project.write(SCENE, "Scene(params: [");
    desk.core.act(set("size", Value::Float(4.0)));
    desk.core.act(Action::Save);
    assert!(desk.notice().starts_with("nothing was saved"), "{}", desk.notice());
    assert_eq!(desk.project.text(SCENE), "Scene(params: [");
}

#[test]
fn a_resource_is_read_only_while_it_is_looked_at() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    let look = Look { path: "depth".into(), ..Look::default() };
    desk.core.act(Action::Look(Some(look)));
    desk.rest();
    match &desk.core.state.seen.as_ref().unwrap().content {
        Ok(SeenContent::Texture(texture)) => {
            assert_eq!((texture.width, texture.height, texture.channels), (160, 120, 1));
            let nearest = texture.texels.iter().map(|t| t[0]).fold(0.0, f32::max);
            assert!(nearest > 0.0 && nearest < 1.0, "{nearest}");
        }
        other => panic!("{other:?}"),
    }
    let look = Look { path: "particles.position".into(), ..Look::default() };
    desk.core.act(Action::Look(Some(look)));
    desk.rest();
    match &desk.core.state.seen.as_ref().unwrap().content {
        Ok(SeenContent::Buffer(buffer)) => {
            assert_eq!(buffer.table.headings().collect::<Vec<_>>(), ["x", "y", "z"]);
            let rows = desk.project.text("scenes/assets/dots.csv").lines().count() - 1;
            assert_eq!((buffer.count, buffer.bad(rows)), (rows, (0, None)));
        }
        other => panic!("{other:?}"),
    }
    let reads = desk.core.reads();
    desk.core.act(Action::Look(None));
    assert!(desk.picture() == first, "looking changed the picture");
    let mut camera = desk.core.state.camera.unwrap();
    camera.eye.x += 0.1;
    desk.core.act(Action::Camera(camera));
    desk.rest();
    assert_eq!((desk.core.reads(), desk.core.state.seen.is_some()), (reads, false));
}

#[test]
fn the_first_pass_that_writes_nan_is_found() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let hunt = |desk: &mut Desk| {
        desk.core.act(Action::Hunt);
        desk.until("the end of the hunt", |core| core.state.hunt.is_none());
    };
    hunt(&mut desk);
    assert_eq!(desk.notice(), "no pass of the frame writes NaN or infinity");
    desk.edit(SHADER, "settings.color * light", "settings.color * sqrt(light - 10.0)");
    desk.rest();
    hunt(&mut desk);
    assert_eq!(desk.notice(), "`discs` is the first pass that writes NaN: into `picture`");
    let look = desk.core.state.look.clone().unwrap();
    assert_eq!((look.path.as_str(), look.after.as_deref()), ("picture", Some("discs")));
}

#[test]
fn a_pass_that_is_switched_off_does_not_run() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    let ran = desk.core.state.times[0].last.as_ref().map(|report| report.passes.len());
    assert_eq!(ran, Some(1));
    desk.core.act(Action::Switch { pass: "discs".into(), on: false });
    desk.core.act(Action::Set { path: "size".into(), value: Some(Value::Float(3.0)) });
    assert!(desk.picture() == first, "the pass that is switched off ran");
    desk.core.act(Action::RunAll(true));
    assert!(desk.picture() == first, "what is switched off stays off when everything runs");
    desk.core.act(Action::RunAll(false));
    desk.core.act(Action::Switch { pass: "discs".into(), on: true });
    let larger = desk.picture();
    assert!(larger != first, "it does not run again");
    desk.core.act(Action::Set { path: "size".into(), value: None });
    assert!(larger != desk.picture() && desk.picture() == first);
}

#[test]
fn what_has_no_camera_is_framed_for_the_window() {
    if !has_adapter() {
        return;
    }
    let free = || {
        let project = Project::new();
        project.edit(SCENE, "    size: (800, 600),\n", "");
        project.edit(SCENE, "    camera: Camera(eye: (1.2, 1.1, 1.6), target: (0.0, 0.45, 0.0), fov: 40.0),\n", "");
        project
    };
    let mut desk = Desk::resized(free(), [60, 160]);
    let shown = desk.picture();
    let fresh = |desk: &Desk, size: &str| {
        let made = desk.project.run(&["render", SCENE, "-o", "fresh.png", "--size", size]);
        assert_eq!(made.code, 0, "{}", made.stderr);
        std::fs::read(desk.project.path("fresh.png")).unwrap()
    };
    assert!(shown == fresh(&desk, "60x160"), "not framed as `render` frames it");
    // Framing for another shape would show.
    let wide = Desk::resized(free(), [160, 120]);
    assert!(wide.core.state.home != desk.core.state.home);
}

#[test]
fn a_sequence_is_recorded_and_trouble_ends_it_with_a_message() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let record = |folder: &str, desk: &Desk| {
        let path = desk.project.path(folder).join("a.png");
        Action::Record(Recording { path, from: 2, to: 4, next: 2 })
    };
    std::fs::create_dir(desk.project.path("out")).unwrap();
    desk.core.act(record("out", &desk));
    desk.rest();
    let names = ["a_0002.png", "a_0003.png", "a_0004.png"];
    assert!(names.iter().all(|name| desk.project.path("out").join(name).is_file()), "{}", desk.notice());
    desk.core.act(record("no/such/folder", &desk));
    desk.rest();
    assert!(desk.notice().contains("recording ended after 0 pictures"), "{}", desk.notice());
    // A disk that is full.
    let full = PathBuf::from("/dev/full");
    if full.exists() {
        desk.core.act(Action::Shoot(full.join("a.png")));
        desk.rest();
        assert!(desk.notice().contains("cannot be written"), "{}", desk.notice());
    }
}

#[test]
fn a_lost_device_is_replaced() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    desk.core.gpu().device().destroy();
    let mut camera = desk.core.state.camera.unwrap();
    camera.eye.x += 0.1;
    desk.core.act(Action::Camera(camera));
    let began = Instant::now();
    while !desk.core.tick(Instant::now()).is_lost {
        assert!(began.elapsed() < PATIENCE, "the loss was not noticed");
        std::thread::sleep(Duration::from_millis(1));
    }
    desk.core.replace_device(Gpu::open(&GpuOptions::default()).unwrap()).unwrap();
    camera.eye.x -= 0.1;
    desk.core.act(Action::Camera(camera));
    let frames = desk.core.state.frames;
    desk.until("a picture of the new device", |core| core.state.frames > frames);
    assert!(desk.picture() == first, "the new device draws something else");
}

#[test]
fn without_a_display_it_says_so_and_ends_with_3() {
    let project = Project::new();
    let mut command = project.command(&["view", SCENE]);
    let output =
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    if cfg!(target_os = "linux") {
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(said.contains("no display") && said.contains("meniscus render"), "{said}");
    }
}
