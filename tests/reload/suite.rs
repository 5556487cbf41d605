//! The reload suite: edits through real files, each picture compared with that of a fresh start, and
//! nothing that piles up.

use std::path::PathBuf;

use crate::follower::{Follower, Outcome, fresh};
use crate::project::{Project, has_adapter};

const SIZE: [u32; 2] = [80, 60];
const GRAPH: &str = "graphs/dots.ron";
const SHADER: &str = "shaders/dots/discs.wgsl";

fn scene(project: &Project) -> PathBuf {
    project.path("scenes/dots.ron")
}

/// A project that is followed, and its first picture.
fn start(project: &Project) -> (Follower, Vec<u8>) {
    let mut follower = Follower::new(scene(project), SIZE);
    match follower.reload() {
        Outcome::Drawn { picture, .. } => (follower, picture),
        Outcome::Refused(said) => panic!("refused:\n{said}"),
    }
}

/// A good change: the picture is that of a fresh start, and another than before.
fn good(project: &Project, follower: &mut Follower, before: &[u8]) -> Vec<u8> {
    let picture = follower.drawn();
    assert!(picture == fresh(&scene(project), SIZE), "not what a fresh start draws");
    assert!(picture != before, "the picture did not change");
    picture
}

#[test]
fn a_parameter_that_is_added_and_a_format_that_changes() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let (mut follower, first) = start(&project);
    // In graph and shader, one after the other: between the two the program is not whole.
    project.edit(SHADER, "    color: vec3f,\n}", "    color: vec3f,\n    gain: f32,\n}");
    let said = follower.refused();
    assert!(said.contains("error[unbound]") && said.contains("gain"), "{said}");
    project.edit(GRAPH, "\"size\":  Float", "\"gain\": Float(default: 0.5, min: 0.0, max: 2.0), \"size\":  Float");
    assert!(follower.drawn() == first, "nothing uses it yet");
    project.edit(SHADER, "settings.color * light", "settings.gain * settings.color * light");
    let dimmed = good(&project, &mut follower, &first);
    // Another format is other memory and another pipeline; half of the light is then cut off.
    project.edit(SHADER, "settings.gain * settings", "40.0 * settings");
    let bright = good(&project, &mut follower, &dimmed);
    project.edit(GRAPH, "format: Rgba16Float", "format: Rgba8Unorm");
    let cut = good(&project, &mut follower, &bright);
    project.edit(GRAPH, "format: Rgba8Unorm", "format: R32Uint");
    let said = follower.refused();
    assert!(said.contains("error[target-mismatch]"), "{said}");
    project.edit(GRAPH, "format: R32Uint", "format: Rgba16Float");
    assert!(good(&project, &mut follower, &cut) == bright, "back where it was");
}

#[test]
fn a_bad_shader_and_a_bad_graph_at_once() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let (mut follower, first) = start(&project);
    project.edit(SHADER, "settings.color * light", "settings.hue * light");
    project.edit(GRAPH, "topology: TriangleStrip", "topolgy: TriangleStrip");
    let mut said = follower.refused();
    if !(said.contains("hue") && said.contains("topolgy")) {
        // The second save came after the first was read: both are told then.
        said = follower.refused();
    }
    assert!(said.contains("hue") && said.contains(SHADER), "{said}");
    assert!(said.contains("did you mean `topology`?") && said.contains(GRAPH), "{said}");
    // One is mended and the other is still told.
    project.edit(SHADER, "settings.hue * light", "settings.color.zxy * light");
    let said = follower.refused();
    assert!(said.contains("did you mean `topology`?") && !said.contains("hue"), "{said}");
    project.edit(GRAPH, "topolgy: TriangleStrip", "topology: TriangleStrip");
    good(&project, &mut follower, &first);
}

#[test]
fn one_save_is_one_reload_also_if_it_comes_in_strokes() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let (mut follower, first) = start(&project);
    let text = project.text(SHADER).replace("color * light", "color.yxz * light");
    // Half of the file, all of it, and touched again, as some editors save.
    project.write(SHADER, &text[..text.len() / 2]);
    project.write(SHADER, &text);
    project.write(SHADER, &text);
    let second = good(&project, &mut follower, &first);
    // Nothing is left over: what comes next is the next change.
    project.edit(SHADER, "color.yxz * light", "color * light");
    assert!(good(&project, &mut follower, &second) == first, "back where it was");
}

/// Resident memory in kilobytes, where the system tells.
fn resident_kb() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmRSS:")?.split_whitespace().next()?.parse().ok())
}

/// 90 edits, and what lives at the last against edit 30; with `MENISCUS_LONG=1` in the environment
/// 1,000 against edit 100. Every fourth edit is bad.
#[test]
fn many_edits_in_a_row_leave_nothing_behind() {
    if !has_adapter() {
        return;
    }
    let (settled, last) = if std::env::var_os("MENISCUS_LONG").is_some() { (100, 1000) } else { (30, 90) };
    let project = Project::new();
    let (mut follower, first) = start(&project);
    let whole = project.text(SHADER);
    let graph = project.text(GRAPH);
    let tints = ["color", "color.yxz", "color.zyx", "color.xzy", "color.zxy", "color.yzx"];
    let wanted: Vec<Vec<u8>> = tints
        .iter()
        .map(|tint| {
            project.write(SHADER, whole.replace("color * light", &format!("{tint} * light")));
            fresh(&scene(&project), SIZE)
        })
        .collect();
    assert!(wanted[0] == first && wanted[1] != first);
    // What was written meanwhile is noticed first.
    let mut shown = follower.drawn();
    let mut before = None;
    for edit in 1..=last {
        let tint = edit % tints.len();
        let text = whole.replace("color * light", &format!("{} * light", tints[tint]));
        if edit % 4 == 0 {
            match edit % 8 {
                0 => project.write(SHADER, text.replace(" * light", " * lihgt")),
                _ => project.write(GRAPH, graph.replace("particles.radius", "particles.radios")),
            }
            // An edit of two files may have come as two changes, the second of which draws the same.
            let said = loop {
                match follower.follow() {
                    Outcome::Drawn { picture, .. } => assert!(picture == shown, "edit {edit}"),
                    Outcome::Refused(said) => break said,
                }
            };
            assert!(said.contains("lihgt") || said.contains("radios"), "{said}");
            assert!(follower.shown() == shown, "edit {edit}");
            project.write(GRAPH, &graph);
        }
        project.write(SHADER, text);
        // Two files may be two bursts.
        shown = loop {
            match follower.follow() {
                Outcome::Drawn { picture, .. } if picture == wanted[tint] => break picture,
                Outcome::Drawn { picture, .. } => assert!(wanted.contains(&picture), "edit {edit}"),
                Outcome::Refused(said) => assert!(said.contains("lihgt"), "edit {edit}: {said}"),
            }
        };
        if edit == settled || edit == last {
            let now = (resident_kb(), follower.session.gpu().census().unwrap());
            println!("after {edit} edits: {} kB resident, {:?}", now.0.unwrap_or(0), now.1);
            if let Some((memory, census)) = before.replace(now) {
                within(memory.map(|kb| kb as f64), now.0.map(|kb| kb as f64), "kB resident");
                within(Some(census.total() as f64), Some(now.1.total() as f64), "objects on the device");
            }
        }
    }
}

fn within(before: Option<f64>, after: Option<f64>, what: &str) {
    if let (Some(before), Some(after)) = (before, after) {
        assert!(after <= before * 1.02, "{before} {what} became {after}");
    }
}
