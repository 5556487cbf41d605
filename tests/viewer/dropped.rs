//! Files that are dropped on the window.

use meniscus::viewer::action::Action;

use crate::desk::{Desk, SCENE};
use crate::project::has_adapter;

/// A wall behind the particles.
const WALL: &str = "v -2 -1 -1\nv 2 -1 -1\nv 2 2 -1\nv -2 2 -1\nf 1 2 3 4\n";

#[test]
fn what_is_dropped_opens_or_says_why_not() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    desk.project.write("notes.txt", "no scene");
    desk.core.act(Action::Open(desk.project.path("notes.txt")));
    assert!(desk.notice().contains("is no scene, graph, particle file, mesh or picture"), "{}", desk.notice());
    assert!(desk.picture() == first);

    // Not what its extension says: told, and the last picture stays.
    desk.project.write("wrong.ply", "this is no ply");
    desk.core.act(Action::Open(desk.project.path("wrong.ply")));
    desk.until("an error", |core| core.state.findings.as_ref().is_some_and(|f| f.is_stale));
    assert!(desk.core.screen().texture().is_some());

    desk.core.act(Action::Open(desk.project.path(SCENE)));
    desk.until("the scene", |core| core.state.findings.is_none() && core.state.busy.is_none());
    let graph = desk.project.text("graphs/dots.ron").replace("clear: 0.0", "clear: 1.0");
    desk.project.write("graphs/other.ron", graph);
    desk.core.act(Action::Open(desk.project.path("graphs/other.ron")));
    desk.until("the other graph", |core| core.plan().is_some_and(|plan| plan.graph.ends_with("other.ron")));
    assert!(desk.picture() != first);
}

fn open(desk: &mut Desk, name: &str) {
    desk.rest();
    let before = desk.core.state.reloads.len();
    desk.core.act(Action::Open(desk.project.path(name)));
    desk.until("a file that was dropped", |core| core.state.reloads.len() > before);
    desk.rest();
}

fn given(desk: &Desk) -> (usize, bool) {
    desk.core.state.job.as_ref().map(|job| (job.meshes.len(), job.environment.is_some())).unwrap()
}

#[test]
fn a_mesh_becomes_a_body_and_a_picture_the_environment() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    desk.project.write("wall.obj", WALL);
    desk.core.act(Action::Open(desk.project.path("wall.obj")));
    assert_eq!(desk.notice(), "`dots.ron` takes no meshes");

    // Particles by themselves get a graph that takes both.
    open(&mut desk, "scenes/assets/dots.csv");
    let alone = desk.picture();
    open(&mut desk, "wall.obj");
    let with_wall = desk.picture();
    assert!(with_wall != alone, "{:?}", desk.core.state.findings);
    assert_eq!(given(&desk), (1, false));
    open(&mut desk, "wall.obj");
    assert_eq!(given(&desk), (1, false), "once is enough");
    assert!(desk.picture() == with_wall);

    // Its file is followed like all others.
    desk.edit("wall.obj", "v 2 2 -1", "v 2 0 -1");
    assert!(desk.picture() != with_wall);
    desk.edit("wall.obj", "v 2 0 -1", "v 2 2 -1");

    let sky = image::RgbImage::from_fn(8, 4, |x, _| image::Rgb([255, 30 * x as u8, 0]));
    sky.save(desk.project.path("sky.png")).unwrap();
    open(&mut desk, "sky.png");
    let with_sky = desk.picture();
    assert!(with_sky != with_wall);
    assert_eq!(given(&desk), (1, true));

    for name in ["wall.obj", "sky.png"] {
        desk.core.act(Action::TakeAway(desk.project.path(name)));
        desk.rest();
    }
    assert!(desk.picture() == alone, "all is as before");
}

#[test]
fn what_was_dropped_is_saved_into_the_scene() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    desk.core.act(Action::Save);
    assert_eq!(desk.notice(), "nothing was changed");
    let scene = "scenes/assets/dots.ron";
    for (name, more) in [("a.obj", ""), ("b.obj", "v 0 3 0\n")] {
        desk.project.write(&format!("scenes/assets/{name}"), format!("{WALL}{more}"));
    }
    let sky = image::RgbImage::from_fn(8, 4, |x, _| image::Rgb([255, 30 * x as u8, 0]));
    sky.save(desk.project.path("sky.png")).unwrap();

    // Particles alone get a scene beside them; from then on it is the scene that is written.
    open(&mut desk, "scenes/assets/dots.csv");
    open(&mut desk, "scenes/assets/a.obj");
    desk.core.act(Action::Save);
    assert_eq!(desk.notice(), "1 file saved to dots.ron");
    desk.rest();
    open(&mut desk, "scenes/assets/b.obj");
    open(&mut desk, "sky.png");
    let dropped = desk.picture();
    desk.core.act(Action::Save);
    assert_eq!(desk.notice(), "2 files saved to dots.ron");
    desk.rest();
    assert_eq!(given(&desk), (0, false), "nothing stands there twice");
    let text = desk.project.text(scene);
    assert!(text.contains("[\"a.obj\", \"b.obj\"]"), "{text}");
    assert!(text.contains(&format!("environment: {:?}", desk.project.path("sky.png"))), "{text}");
    assert!(desk.picture() == dropped, "the scene has what was dropped");

    // Whoever opens it anew sees the same.
    desk.core.act(Action::Open(desk.project.path(scene)));
    assert!(desk.picture() == dropped);
}

#[test]
fn a_mesh_opens_by_itself_where_nothing_is_open() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::empty();
    desk.project.write("wall.obj", WALL);
    desk.core.act(Action::Open(desk.project.path("wall.obj")));
    desk.until("a picture", |core| core.state.frames > 0);
    desk.rest();
    assert!(desk.core.state.findings.as_ref().is_none_or(|found| !found.is_stale), "{:?}", desk.core.state.findings);
    let bounds = desk.core.state.bounds.unwrap();
    assert_eq!(bounds.map(|end| end.to_array()), [[-2.0, -1.0, -1.0], [2.0, 2.0, -1.0]], "F frames it");
}

#[test]
fn a_mesh_or_picture_that_is_none_says_so_and_keeps_the_picture() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    open(&mut desk, "scenes/assets/dots.csv");
    let alone = desk.picture();
    for (name, text, wanted) in [
        ("wrong.glb", "this is no glb", "wrong.glb"),
        ("wrong.hdr", "this is no picture", "this is not the start of a picture"),
        ("faces.ply", "ply\nformat ascii 1.0\nelement vertex 3\nelement face 2\nend_header\n", "faces.ply"),
    ] {
        desk.project.write(name, text);
        open(&mut desk, name);
        let findings = desk.core.state.findings.clone().unwrap();
        let said: Vec<String> = findings.diagnostics.iter().map(|d| d.message.clone()).collect();
        assert!(findings.is_stale && said.iter().any(|message| message.contains(wanted)), "{name}: {said:?}");
        assert!(desk.picture() == alone, "{name}");
        desk.core.act(Action::TakeAway(desk.project.path(name)));
        desk.until("what is left", |core| core.state.findings.as_ref().is_none_or(|f| !f.is_stale));
    }
    // A mesh that works takes the place of the one that did not.
    open(&mut desk, "wrong.glb");
    desk.project.write("wall.obj", WALL);
    open(&mut desk, "wall.obj");
    assert_eq!(given(&desk), (1, false));
    assert!(desk.picture() != alone);
}
