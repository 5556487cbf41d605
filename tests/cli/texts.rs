//! What is said where it takes the program, a device or the disk to bring it up: each golden in
//! `texts/` is the whole text of the error stream.

use crate::golden::golden;
use crate::project::{Project, has_adapter};
use crate::{FIND, SHOW_FOUND, project_of};

/// The error stream of a run that ends so.
fn expect(name: &str, project: &Project, args: &[&str], code: i32) {
    let run = project.run(args);
    assert_eq!(run.code, code, "{args:?} said:\n{}", run.stderr);
    golden(format!("tests/cli/texts/{name}.txt"), &run.stderr);
}

#[test]
fn an_asset_that_cannot_be_read() {
    let project = Project::new();
    project.write("scenes/assets/dots.csv", "x,y,z\n1,2,3\n1,2\n");
    expect("asset", &project, &["render", "scenes/dots.ron", "-o", "a.png"], 2);
}

#[test]
fn an_asset_with_something_to_know() {
    let project = Project::new();
    project.write("scenes/assets/dots.csv", "x,y,z\n0,0,0\n1,nan,0\n0,1,0\n");
    expect("asset_note", &project, &["check", "scenes/dots.ron"], 0);
}

#[test]
fn wrong_usage() {
    let project = Project::new();
    expect("usage", &project, &["render", "scenes/dots.ron", "-o", "a.png", "--set", "siz=1"], 2);
    expect("usage_of_check", &project, &["check", "scenes/assets/dots.csv"], 2);
}

#[test]
fn a_place_that_cannot_be_written_to() {
    let project = Project::new();
    expect("output", &project, &["render", "scenes/dots.ron", "-o", "no/a.png"], 2);
    expect("output_of_new", &project, &["new", "dots"], 2);
}

#[test]
fn a_device_to_check_for_that_is_none() {
    let project = Project::new();
    expect("no_device_file", &project, &["check", "--device", "cor", "graphs/dots.ron"], 2);
    project.write("card.json", r#"{"features": ["float32-blendible"]}"#);
    expect("device_file", &project, &["check", "--device", "card.json", "graphs/dots.ron"], 2);
}

#[test]
fn counted_buffers_that_overflow() {
    if !has_adapter() {
        return;
    }
    let declarations = "resources: {\"found\": Counted(capacity: 4), PICTURE},";
    let passes = "Clear(of: \"found\"), Compute(shader: \"find.wgsl\", groups: 1),";
    let shaders = [("find", FIND), ("show", SHOW_FOUND)];
    let project = project_of(passes, declarations, &shaders);
    expect("overflow", &project, &["render", "scenes/it.ron", "-o", "a.png"], 0);
    let declarations = "state: {\"found\": Counted(capacity: 4)}, resources: {PICTURE},";
    let project = project_of(&format!("Steps(rate: 10.0, passes: [{passes}]),"), declarations, &shaders);
    expect("overflow_in_steps", &project, &["render", "scenes/it.ron", "-o", "a.png", "--time", "1"], 1);
}

/// A counted buffer to which nothing came is told of, if the graph says what that means.
#[test]
fn counted_buffers_that_stay_empty() {
    if !has_adapter() {
        return;
    }
    let declarations = "resources: {\"found\": Counted(capacity: 4, empty: \"no dot is red\"), PICTURE},";
    let passes = "Clear(of: \"found\"), Compute(shader: \"find.wgsl\", groups: 1),";
    let shaders =
        [("find", &*FIND.replace("atomicAdd(&found.count, 1u)", "atomicAdd(&found.count, 0u)")), ("show", SHOW_FOUND)];
    let project = project_of(passes, declarations, &shaders);
    expect("empty", &project, &["render", "scenes/it.ron", "-o", "a.png"], 0);
}

/// No driver: told with what to install, and exit code 3.
#[test]
#[cfg(target_os = "linux")]
fn no_adapter() {
    let project = Project::new();
    let mut command = project.command(&["render", "scenes/dots.ron", "-o", "a.png", "--backend", "vulkan"]);
    command.envs([("VK_DRIVER_FILES", "/none"), ("VK_ICD_FILENAMES", "/none"), ("VK_ADD_DRIVER_FILES", "")]);
    let run = crate::project::Run::from(command.output().unwrap());
    assert_eq!(run.code, 3, "{}", run.stderr);
    // What wgpu tells of backends differs from machine to machine.
    let (own, rest) = run.stderr.split_once("wgpu found: ").unwrap();
    let after = rest.split_once('\n').unwrap().1;
    golden("tests/cli/texts/device.txt", &format!("{own}wgpu found: ...\n{after}"));
    assert!(!project.path("a.png").exists());
}
