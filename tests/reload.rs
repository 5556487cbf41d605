//! `watch` over real files: a good change makes a new picture, a bad one leaves the old.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/follower.rs"]
mod follower;
#[path = "support/project.rs"]
mod project;
#[path = "reload/suite.rs"]
mod suite;

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use project::{Project, has_adapter};

/// A picture takes milliseconds; machines that do much else take seconds.
const PATIENCE: Duration = Duration::from_secs(60);
const SIZE: &str = "160x120";
const SHADER: &str = "shaders/dots/discs.wgsl";

/// A running `watch` and what it says.
struct Watching<'p> {
    project: &'p Project,
    child: Child,
    lines: Receiver<String>,
}

impl Drop for Watching<'_> {
    fn drop(&mut self) {
        _ = self.child.kill();
        _ = self.child.wait();
    }
}

impl<'p> Watching<'p> {
    /// Starts, and waits for the first picture.
    fn start(project: &'p Project) -> Self {
        let args = ["watch", "scenes/dots.ron", "-o", "w.png", "--size", SIZE];
        let mut child = project.command(&args).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
        let (sender, lines) = channel();
        let stderr = child.stderr.take().unwrap();
        std::thread::spawn(move || {
            BufReader::new(stderr)
                .lines()
                .map_while(Result::ok)
                .take_while(|line| sender.send(line.clone()).is_ok())
                .count()
        });
        let watching = Self { project, child, lines };
        watching.wait_for("drawn in");
        // The files are watched a moment after the picture is there; what changes between is noticed too.
        watching
    }

    /// All that is said up to a line with `word` in it, which comes last.
    fn wait_for(&self, word: &str) -> Vec<String> {
        let mut said = Vec::new();
        loop {
            match self.lines.recv_timeout(PATIENCE) {
                Ok(line) => {
                    said.push(line);
                    if said.last().unwrap().contains(word) {
                        return said;
                    }
                }
                Err(error) => panic!("{error} before {word:?}; said:\n{}", said.join("\n")),
            }
        }
    }

    fn picture(&self) -> Vec<u8> {
        std::fs::read(self.project.path("w.png")).unwrap()
    }

    /// A good change: gives what was said of it, and the picture, which must be that of a fresh run.
    fn reloaded(&self) -> (String, Vec<u8>) {
        let said = self.wait_for("reloaded in");
        let picture = self.picture();
        let fresh = self.project.run(&["render", "scenes/dots.ron", "-o", "fresh.png", "--size", SIZE]);
        assert_eq!(fresh.code, 0, "{}", fresh.stderr);
        assert!(picture == std::fs::read(self.project.path("fresh.png")).unwrap(), "not what a fresh run draws");
        (said.last().unwrap().clone(), picture)
    }

    /// A bad change: gives what was said of it; the picture must still be `before`.
    fn refused(&self, before: &[u8]) -> String {
        let said = self.wait_for("the last good picture stays").join("\n");
        assert!(self.picture() == before, "the picture changed");
        said
    }
}

#[test]
fn good_bad_good_through_shader_import_graph_and_scene() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    project.write("shaders/lib/shade.wgsl", "fn shade(x: f32) -> f32 {\n    return 0.15 + 0.85 * x;\n}\n");
    project.edit(SHADER, "#import \"lib/packed.wgsl\"", "#import \"lib/packed.wgsl\"\n#import \"lib/shade.wgsl\"");
    project.edit(SHADER, "0.15 + 0.85 * max(dot(n_in_view, to_sun), 0.0)", "shade(max(dot(n_in_view, to_sun), 0.0))");
    let watching = Watching::start(&project);
    let first = watching.picture();

    project.edit(SHADER, "settings.color * light", "settings.color.zyx * light");
    let (line, second) = watching.reloaded();
    assert!(second != first, "the picture did not change");
    for word in ["noticing", "checking", "building", "drawing", "1 pipelines rebuilt"] {
        assert!(line.contains(word), "{line}");
    }

    project.edit(SHADER, "settings.color.zyx * light", "settings.hue * light");
    let said = watching.refused(&second);
    assert!(said.contains("error[shader]") && said.contains(SHADER), "{said}");
    project.edit(SHADER, "settings.hue * light", "settings.color * light");
    assert!(watching.reloaded().1 == first, "back where it was");

    // Only an import changes, and the error is told in it.
    project.edit("shaders/lib/shade.wgsl", "0.15 + 0.85 * x", "0.5 + y");
    let said = watching.refused(&first);
    assert!(said.contains("shaders/lib/shade.wgsl:2"), "{said}");
    project.edit("shaders/lib/shade.wgsl", "0.5 + y", "0.9 * x");
    let (line, shaded) = watching.reloaded();
    assert!(shaded != first && line.contains("1 pipelines rebuilt"), "{line}");

    project.edit("graphs/dots.ron", "size * particles.radius", "sise * particles.radius");
    assert!(watching.refused(&shaded).contains("did you mean `size`?"));
    project.edit("graphs/dots.ron", "sise * particles.radius", "2 * size * particles.radius");
    let (line, wide) = watching.reloaded();
    assert!(wide != shaded && line.contains("0 pipelines rebuilt"), "{line}");

    project.edit("scenes/dots.ron", "intensity: 3.0", "intensty: 3.0");
    assert!(watching.refused(&wide).contains("did you mean `intensity`?"));
    project.edit("scenes/dots.ron", "intensty: 3.0", "intensity: 3.0");
    project.edit("scenes/dots.ron", "(1.2, 1.1, 1.6)", "(1.9, 1.1, 1.6)");
    let (line, moved) = watching.reloaded();
    assert!(moved != wide && line.contains("0 pipelines rebuilt"), "{line}");
}

#[test]
fn files_that_are_replaced_deleted_and_restored_are_followed() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let watching = Watching::start(&project);
    let first = watching.picture();

    // As many editors save: a new file takes the old one's place.
    project.write("draft", project.text(SHADER).replace("color * light", "color.yxz * light"));
    std::fs::rename(project.path("draft"), project.path(SHADER)).unwrap();
    let second = watching.reloaded().1;
    assert!(second != first, "the picture did not change");

    let text = project.text(SHADER);
    std::fs::remove_file(project.path(SHADER)).unwrap();
    let said = watching.refused(&second);
    assert!(said.contains("error[file-missing]") && said.contains("dots/discs.wgsl"), "{said}");
    project.write(SHADER, text.replace("color.yxz * light", "color * light"));
    assert!(watching.reloaded().1 == first, "back where it was");

    // Particles are watched like everything else, and fewer of them need another buffer.
    let rows: Vec<String> = project.text("scenes/assets/dots.csv").lines().take(60).map(str::to_owned).collect();
    project.write("scenes/assets/dots.csv", rows.join("\n"));
    let fewer = watching.reloaded().1;
    assert!(fewer != first, "the picture did not change");
    project.write("scenes/assets/dots.csv", "x,y,z\n1,2,3\n1,2\n");
    assert!(watching.refused(&fewer).contains("`scenes/assets/dots.csv`: line 3"));
}
