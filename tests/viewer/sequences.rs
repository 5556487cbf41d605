//! Numbered files in the window: played, stepped, scrubbed, recorded.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use meniscus::viewer::action::Action;
use meniscus::viewer::core::Recording;

use crate::desk::{Desk, SCENE};
use crate::project::{Project, has_adapter};

/// Frames 3 to 12, of which 6 is missing and 8 damaged. Frame n has n particles on a line.
fn project() -> Project {
    let project = Project::new();
    for frame in (3..=12).filter(|frame| *frame != 6) {
        project.write(&format!("scenes/assets/dots_{frame:02}.csv"), csv(frame));
    }
    project.write("scenes/assets/dots_08.csv", "x,y,z\n1,2\n");
    project.edit(SCENE, "(file: \"assets/dots.csv\"", "(file: \"assets/dots_##.csv\", rate: 20.0");
    project
}

fn csv(frame: u64) -> String {
    (0..frame).fold(String::from("x,y,z\n"), |mut text, i| {
        _ = writeln!(text, "{},{},0", i as f64 * 0.08 - 0.4, frame as f64 * 0.05);
        text
    })
}

fn shown(desk: &Desk) -> Option<usize> {
    desk.core.state.home?;
    desk.core.particles().first().map(|(_, count)| *count)
}

fn warnings(desk: &Desk) -> Vec<String> {
    let findings = desk.core.state.findings.iter();
    findings.flat_map(|f| f.diagnostics.iter()).map(|d| d.message.clone()).filter(|m| m.starts_with("frame")).collect()
}

fn go_to(desk: &mut Desk, frame: u64) -> Option<usize> {
    let time_s = desk.core.state.clock.time_of(frame);
    desk.core.act(Action::Seek(time_s));
    desk.rest();
    assert_eq!(desk.core.state.clock.frame(), frame);
    shown(desk)
}

#[test]
fn each_frame_is_the_one_that_render_draws() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::of(project());
    desk.rest();
    let beat = desk.core.state.clock.beat;
    assert_eq!((beat.first, beat.last, beat.rate), (3, Some(12), 20.0));
    assert!(desk.core.state.changes_over_time, "it can be played");
    let first = desk.picture();
    assert!(first == desk.fresh_with(&["--frame", "3"]), "not the first frame");
    // The camera stays, whatever the frame: that of the scene.
    for frame in [7, 4, 12] {
        assert_eq!(go_to(&mut desk, frame), Some(frame as usize));
        let picture = desk.picture();
        assert!(picture != first && picture == desk.fresh_with(&["--frame", &frame.to_string()]), "frame {frame}");
    }
    desk.core.act(Action::Step(-1));
    desk.rest();
    assert_eq!((desk.core.state.clock.frame(), shown(&desk)), (11, Some(11)));
    assert_eq!(warnings(&desk), [""; 0]);
}

#[test]
fn what_is_missing_or_damaged_is_told_and_mended() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::of(project());
    assert_eq!(go_to(&mut desk, 6), Some(5), "the one before stays");
    assert_eq!(go_to(&mut desk, 8), Some(7));
    // It is told as long as it is so, also while others are shown.
    assert_eq!(go_to(&mut desk, 9), Some(9));
    let told = warnings(&desk);
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].starts_with("frame 6: there is no file") && told[0].ends_with("frame 5 is shown in its place"));
    assert!(told[1].starts_with("frame 8: ") && told[1].contains("line 2"), "{told:?}");
    assert!(!desk.core.state.findings.as_ref().unwrap().is_stale);

    // The file that is missing is waited for, and one behind the last makes the sequence longer.
    assert_eq!(go_to(&mut desk, 6), Some(5));
    desk.project.write("scenes/assets/dots_06.csv", csv(6));
    desk.until("the frame that was missing", |core| core.particles().first().is_some_and(|(_, count)| *count == 6));
    assert_eq!(desk.core.state.clock.beat.last, Some(12));
    desk.project.write("scenes/assets/dots_13.csv", csv(13));
    desk.until("a longer sequence", |core| core.state.clock.beat.last == Some(13));
    assert_eq!(go_to(&mut desk, 13), Some(13));
}

#[test]
fn a_second_sequence_keeps_to_the_numbers_of_the_first() {
    if !has_adapter() {
        return;
    }
    let project = project();
    for frame in [5, 7] {
        project.write(&format!("scenes/assets/foam_{frame:02}.csv"), csv(frame));
    }
    let graph = project.text("graphs/dots.ron");
    let taken = "\"particles\": Particles(attributes: [\"position\"])";
    assert!(graph.contains(taken), "{graph}");
    project.edit("graphs/dots.ron", taken, &format!("{taken}, \"foam\": Particles(attributes: [\"position\"])"));
    // The first that the scene names is the one that counts.
    project.edit(
        SCENE,
        "radius: 0.02)",
        "radius: 0.02), \"foam\": (file: \"assets/foam_##.csv\", radius: 0.1, rate: 20.0)",
    );
    let mut desk = Desk::of(project);
    desk.rest();
    assert_eq!((desk.core.state.clock.beat.first, desk.core.state.clock.beat.last), (3, Some(12)));
    let both = |desk: &Desk| {
        let counts = desk.core.particles();
        let of = |name: &str| counts.iter().find(|(known, _)| *known == name).map(|(_, count)| *count);
        (of("particles"), of("foam"))
    };
    assert_eq!(both(&desk), (Some(3), Some(0)));
    for (frame, foam) in [(4, 0), (5, 5), (7, 7), (12, 7), (3, 0)] {
        go_to(&mut desk, frame);
        assert_eq!(both(&desk), (Some(frame as usize), Some(foam)), "frame {frame}");
    }
    let told = desk.core.state.findings.iter().flat_map(|f| f.diagnostics.iter()).map(|d| d.message.clone());
    let told: Vec<String> = told.filter(|message| message.contains("foam_##.csv")).collect();
    assert_eq!(told.len(), 2, "that it begins later, and that it ends sooner: {told:?}");
}

#[test]
fn it_plays_at_the_rate_of_the_files_and_leaves_none_out() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::of(project());
    desk.rest();
    let mut seen = vec![shown(&desk).unwrap()];
    desk.core.act(Action::Play(true));
    let began = Instant::now();
    while desk.core.state.clock.is_playing {
        assert!(began.elapsed() < Duration::from_secs(60), "it does not end: {seen:?}");
        desk.core.tick(Instant::now());
        seen.extend(shown(&desk));
        seen.dedup();
        std::thread::sleep(Duration::from_millis(1));
    }
    let took = began.elapsed();
    desk.rest();
    assert_eq!(seen, [3, 4, 5, 7, 9, 10, 11, 12]);
    // Nine frames after the first, 20 a second: no sooner.
    assert!(took >= Duration::from_millis(450), "{took:?}");
    assert_eq!(desk.core.state.clock.frame(), 12);
}

#[test]
fn a_recording_writes_what_render_would() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::of(project());
    desk.rest();
    let path = desk.project.path("a_##.png");
    desk.core.act(Action::Record(Recording { path, from: 9, to: 20, next: 9 }));
    desk.until("the end of the recording", |core| core.state.recording.is_none());
    assert!(desk.notice().contains("ended after 4 pictures: the sequence ends at frame 12"), "{}", desk.notice());
    for frame in 9..=12_u64 {
        let recorded = std::fs::read(desk.project.path(&format!("a_{frame:02}.png"))).unwrap();
        assert!(recorded == desk.fresh_with(&["--frame", &frame.to_string()]), "frame {frame}");
    }
    assert!(!desk.project.path("a_13.png").exists());
}

/// A graph that adds up what the steps saw, of files that show for a second each.
fn adding(rate: f64) -> Project {
    let project = Project::new();
    for frame in 0..4 {
        project.write(&format!("scenes/assets/p_{frame}.csv"), format!("x,y,z,mass\n0,0,0,{}\n", 3_u32.pow(frame)));
    }
    let sum = "var<storage, read_write> sum: array<f32>;\nvar<storage, read> particles_mass: array<f32>;\n\
        @compute @workgroup_size(1) fn main() { sum[0] += particles_mass[0]; }";
    let show = "var<storage, read> sum: array<f32>;\n\
        @fragment fn main() -> @location(0) vec4f { return vec4f(vec3f(sum[0] / 200.0), 1.0); }";
    project.write("shaders/sum.wgsl", sum);
    project.write("shaders/show.wgsl", show);
    project.write(
        "graphs/adding.ron",
        format!(
            "Graph(inputs: {{\"particles\": Particles(attributes: [\"position\", \"mass\"])}}, \
             state: {{\"sum\": Buffer(items: 1)}}, \
             resources: {{\"picture\": Texture(format: Rgba16Float, size: \"viewport\")}}, \
             passes: [Steps(rate: {rate:?}, passes: [Compute(shader: \"sum.wgsl\", groups: 1)]), \
             Fullscreen(shader: \"show.wgsl\", color: [\"picture\"])], outputs: [\"picture\"])"
        ),
    );
    let particles = "\"particles\": (file: \"assets/p_#.csv\", radius: 0.1, rate: 1.0)";
    project.write(SCENE, format!("Scene(graph: \"adding.ron\", size: (16, 8), particles: {{{particles}}})"));
    project
}

/// Steps that lie between two pictures see the files that showed at their own time.
#[test]
fn steps_see_the_files_of_their_time() {
    if !has_adapter() {
        return;
    }
    for rate in [1.0, 3.0, 8.0] {
        let mut desk = Desk::of(adding(rate));
        desk.rest();
        for frame in 1..=3_u64 {
            desk.core.act(Action::Step(1));
            desk.rest();
            assert_eq!(desk.core.state.clock.frame(), frame);
            let picture = desk.picture();
            assert!(
                picture == desk.fresh_with(&["--frame", &frame.to_string()]),
                "frame {frame}, {rate} steps a second"
            );
        }
        // A jump, back and on, goes through all of them.
        for frame in [1, 3, 0, 2] {
            go_to(&mut desk, frame);
            let picture = desk.picture();
            assert!(picture == desk.fresh_with(&["--frame", &frame.to_string()]), "to {frame}, {rate} steps a second");
        }
        let path = desk.project.path("a_#.png");
        desk.core.act(Action::Record(Recording { path, from: 2, to: 3, next: 2 }));
        desk.until("the end of the recording", |core| core.state.recording.is_none());
        for frame in [2_u64, 3] {
            let recorded = std::fs::read(desk.project.path(&format!("a_{frame}.png"))).unwrap();
            assert!(recorded == desk.fresh_with(&["--frame", &frame.to_string()]), "recorded {frame}");
        }
    }
}
