//! Steps that see sequences: each has the files of its own time, however one comes to a moment.

use super::{Project, good, has_adapter, project_of};

const SUM: &str = "var<storage, read_write> sum: array<f32>;\n\
    var<storage, read> particles_mass: array<f32>;\n\
    @compute @workgroup_size(1) fn main() { sum[0] += particles_mass[0]; }";
pub const SHOW_SUM: &str = "var<storage, read> sum: array<f32>;\n\
    @fragment fn main() -> @location(0) vec4f { return vec4f(sum[0]); }";

/// Frame n has n + 2 particles, of which the first weighs ten to the power of n.
fn write_frames(project: &Project, frames: std::ops::Range<u32>) {
    for frame in frames {
        let first = format!("x,y,z,mass\n0,0,0,{}\n", 10_u32.pow(frame));
        let others: String = (0..=frame).map(|i| format!("{},0,0,0\n", i + 1)).collect();
        project.write(&format!("p_{frame}.csv"), first + &others);
    }
}

fn project(state: &str, passes: &str, more: &[(&str, &str)]) -> Project {
    let declarations = format!(
        "inputs: {{\"particles\": Particles(attributes: [\"position\", \"mass\"])}}, \
         state: {{\"sum\": Buffer(items: 1){state}}}, resources: {{\"list\": Counted(capacity: 1), \"found\": Buffer(items: 1), PICTURE}},"
    );
    let project = project_of(passes, &declarations, &[&[("sum", SUM), ("show", SHOW_SUM)], more].concat());
    write_frames(&project, 0..5);
    scene(&project, "rate: 1.0");
    project
}

fn scene(project: &Project, files: &str) {
    // A scene may name files outside of its folder.
    let particles = format!("\"particles\": (file: \"../p_#.csv\", radius: 0.1, {files})");
    project.write("scenes/it.ron", format!("Scene(graph: \"it.ron\", size: (16, 8), particles: {{{particles}}})"));
}

/// The sum after rendering, and what was said.
fn sum(project: &Project, when: &[&str]) -> (f32, String) {
    let output = if when[0] == "--frames" { "a_#.png" } else { "a.png" };
    let render = ["render", "scenes/it.ron", "-o", output, "--dump", "sum=s.csv"];
    let run = good(project.run(&[&render[..], when].concat()));
    (project.text("s.csv").lines().nth(1).unwrap().parse().unwrap(), run.stderr)
}

const ADD: &str = "Compute(shader: \"sum.wgsl\", groups: 1)";

#[test]
fn each_step_sees_the_files_of_its_time() {
    if !has_adapter() {
        return;
    }
    let project = project("", &format!("Steps(name: \"add\", rate: 1.0, passes: [{ADD}]),"), &[]);
    // One step at each frame but the first: with what begins to show then.
    for (when, expected) in [("0", 0.0), ("1", 10.0), ("2", 110.0), ("4", 11110.0)] {
        for how in [["--frame", when], ["--time", when]] {
            assert_eq!(sum(&project, &how), (expected, String::new()), "{how:?}");
        }
    }
    // One picture after the other, of which none begins anew.
    for (frames, expected) in [("0..3", 1110.0), ("2..4", 11110.0)] {
        assert_eq!(sum(&project, &["--frames", frames]), (expected, String::new()), "{frames}");
    }
    // Two steps for each file, which shows from its own time on.
    scene(&project, "rate: 0.5");
    assert_eq!(sum(&project, &["--frame", "2"]).0, 1.0 + 10.0 + 10.0 + 100.0);
    assert_eq!(sum(&project, &["--time", "3"]).0, 1.0 + 10.0 + 10.0);
    // Two files for each step.
    scene(&project, "rate: 2.0");
    assert_eq!(sum(&project, &["--frame", "4"]).0, 100.0 + 10000.0);
    // Numbers count from the first.
    scene(&project, "rate: 1.0, frames: (2, 4)");
    assert_eq!(sum(&project, &["--frame", "4"]).0, 1000.0 + 10000.0);
    // The one before stands for what is missing, and it is told once.
    scene(&project, "rate: 1.0");
    std::fs::remove_file(project.path("p_1.csv")).unwrap();
    let (found, said) = sum(&project, &["--frame", "2"]);
    assert_eq!((found, said.matches("frame 0 is shown in its place").count()), (101.0, 1), "{said}");
}

#[test]
fn once_a_frame_each_sees_its_frames_file() {
    if !has_adapter() {
        return;
    }
    let project = project("", &format!("Steps(rate: PerFrame, passes: [{ADD}]),"), &[]);
    assert_eq!(sum(&project, &["--frame", "2"]).0, 111.0);
    assert_eq!(sum(&project, &["--frames", "0..2"]).0, 111.0);
    assert_eq!(sum(&project, &["--time", "3.5"]).0, 1111.0);
    scene(&project, "rate: 1.0, frames: (2, 4)");
    assert_eq!(sum(&project, &["--frame", "3"]).0, 1100.0);
}

/// What the steps read is made of the files' particles before them, in a buffer that is too small at first.
#[test]
fn what_grows_on_the_way_is_done_again() {
    if !has_adapter() {
        return;
    }
    let append = "struct List { count: atomic<u32>, items: array<u32> }\n\
        var<storage, read_write> list: List;\n\
        var<storage, read> particles_mass: array<f32>;\n\
        @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) i: vec3u) {\n\
            let at = atomicAdd(&list.count, 1u);\n\
            if at < arrayLength(&list.items) && particles_mass[i.x] >= 0.0 { list.items[at] = i.x; } }";
    let count = "struct List { count: u32, items: array<u32> }\n\
        var<storage, read> list: List;\n\
        var<storage, read_write> found: array<f32>;\n\
        @compute @workgroup_size(1) fn main() { found[0] = f32(min(list.count, arrayLength(&list.items))); }";
    let add = "var<storage, read> found: array<f32>;\n\
        var<storage, read_write> sum: array<f32>;\n\
        @compute @workgroup_size(1) fn main() { sum[0] += found[0]; }";
    let passes = "Clear(of: \"list\"), Compute(shader: \"append.wgsl\", each: Item(\"particles\")), \
        Compute(shader: \"count.wgsl\", groups: 1), \
        Steps(rate: 1.0, passes: [Compute(shader: \"add.wgsl\", groups: 1)]),";
    let project = project("", passes, &[("append", append), ("count", count), ("add", add)]);
    // The last frame alone has room enough.
    project.write("p_4.csv", "x,y,z,mass\n0,0,0,1\n");
    let (found, said) = sum(&project, &["--frame", "4"]);
    assert_eq!(found, 3.0 + 4.0 + 5.0 + 1.0, "{said}");
    assert!(said.contains("had room for 1 items"), "{said}");
}

#[test]
fn steps_before_those_that_see_files_are_done_before() {
    if !has_adapter() {
        return;
    }
    let tick = "var<storage, read_write> ticks: array<f32>;\n\
        @compute @workgroup_size(1) fn main() { ticks[0] += 1.0; }";
    let times = "var<storage, read_write> sum: array<f32>;\n\
        var<storage, read> ticks: array<f32>;\n\
        var<storage, read> particles_mass: array<f32>;\n\
        @compute @workgroup_size(1) fn main() { sum[0] += particles_mass[0] * ticks[0]; }";
    let passes = "Steps(name: \"tick\", rate: 1.0, passes: [Compute(shader: \"tick.wgsl\", groups: 1)]), \
        Steps(name: \"add\", rate: 1.0, passes: [Compute(shader: \"times.wgsl\", groups: 1)]),";
    let project = project(", \"ticks\": Buffer(items: 1)", passes, &[("tick", tick), ("times", times)]);
    assert_eq!(sum(&project, &["--frame", "2"]).0, 2.0 * 110.0);
}

/// State that is as large as there are particles cannot go over from one file to the next.
#[test]
fn state_that_begins_anew_with_each_file_is_told() {
    if !has_adapter() {
        return;
    }
    let keep = SUM.replace("sum[0] +=", "kept[0] += 1.0; sum[0] +=") + "\nvar<storage, read_write> kept: array<f32>;";
    let passes = "Steps(name: \"add\", rate: 1.0, passes: [Compute(shader: \"keep.wgsl\", groups: 1)]),";
    let project = project(", \"kept\": Buffer(items: \"count(particles)\")", passes, &[("keep", &keep)]);
    let (found, said) = sum(&project, &["--frame", "2"]);
    assert_eq!(found, 200.0, "both steps see the file of the picture");
    assert_eq!(
        said.matches("`add` begins anew with each file, and sees that of the picture only").count(),
        1,
        "{said}"
    );
}
