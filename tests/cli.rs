//! The program as people run it: exit codes, what is said, what is written, and what is not.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "cli/bench.rs"]
mod bench;
#[path = "cli/declared.rs"]
mod declared;
#[path = "cli/files.rs"]
mod files;
#[path = "support/golden.rs"]
mod golden;
#[path = "support/project.rs"]
mod project;
#[path = "cli/stepping.rs"]
mod stepping;
#[path = "cli/texts.rs"]
mod texts;

use project::{Project, Run, has_adapter, shared};

/// A run that must fail so, leave no file behind, and say these words on the error stream.
fn refused(project: &Project, args: &[&str], code: i32, words: &[&str]) {
    let before = project.files();
    let run = project.run(args);
    assert_eq!(run.code, code, "{args:?} said:\n{}", run.stderr);
    for word in words {
        assert!(run.stderr.contains(word), "{args:?} does not say {word:?} but:\n{}", run.stderr);
    }
    assert_eq!(run.stdout, "", "{args:?}");
    assert!(!run.stderr.contains("panicked"), "{args:?} said:\n{}", run.stderr);
    assert_eq!(project.files(), before, "{args:?} left something behind");
}

fn good(run: Run) -> Run {
    assert_eq!(run.code, 0, "{}{}", run.stderr, run.stdout);
    run
}

#[test]
fn wrong_usage_ends_with_2() {
    let project = Project::new();
    let scene = "scenes/dots.ron";
    refused(&project, &[], 2, &["Usage"]);
    refused(&project, &["paint"], 2, &["unrecognized subcommand 'paint'"]);
    refused(&project, &["render"], 2, &["--output <FILE>"]);
    refused(&project, &["render", scene, "-o", "a.gif"], 2, &["`a.gif`: pictures are written as .png or .exr"]);
    refused(&project, &["render", scene, "-o", "no/a.png"], 2, &["there is no folder `no`", "mkdir -p no"]);
    refused(&project, &["render", scene, "-o", "scenes"], 2, &[".png or .exr"]);
    for (flag, value, words) in [
        ("--size", "0x0", "at least 1 pixel"),
        ("--size", "100000x1", "at most 32768"),
        ("--size", "big", "expected WIDTHxHEIGHT"),
        ("--radius", "0", "above 0"),
        ("--radius", "NaN", "above 0"),
        ("--radius", "-1", "above 0"),
        ("--fov", "180", "below 180"),
        ("--eye", "1,2", "three numbers"),
        ("--target", "a,b,c", "three numbers"),
        ("--time", "-1", "not below 0"),
        ("--frames", "9..1", "comes after the last"),
        ("--set", "size", "`=` between"),
        ("--backend", "glide", "possible values"),
        ("--policy", "least", "possible values"),
        ("--memory-budget", "0", "such as 1048576, 64MiB"),
        ("--memory-budget", "64 MB", "such as 1048576, 64MiB"),
        ("--dump", "picture=a.txt", "textures are written as .png or .exr"),
    ] {
        refused(&project, &["render", scene, "-o", "a.png", flag, value], 2, &[words]);
    }
    refused(&project, &["render", scene, "-o", "a.png", "--frame", "1", "--time", "1"], 2, &["cannot be used with"]);
}

#[test]
fn unreadable_input_ends_with_2_and_names_file_and_place() {
    let project = Project::new();
    project.write("note.txt", "hello");
    project.write("empty.ply", "");
    project.write("cut.csv", "x,y,z\n1,2,3\n1,2\n");
    project.write("lying.ply", LYING_PLY);
    project.write("alike.csv", "x,y,z\n1,1,1\n1,1,1\n1,1,1\n");
    project.write("one.csv", "x,y,z\n1,1,1\n");
    for (file, words) in [
        ("nothing.vtk", vec!["there is no file `nothing.vtk`"]),
        ("scenes/nothing.ron", vec!["there is no file `scenes/nothing.ron`"]),
        ("scenes", vec!["`scenes` is a folder"]),
        ("note.txt", vec!["`note.txt` is neither a scene (.ron) nor a particle or mesh file", ".bgeo"]),
        ("empty.ply", vec!["`empty.ply`: byte 0: the file is empty"]),
        ("cut.csv", vec!["`cut.csv`: line 3"]),
        ("lying.ply", vec!["`lying.ply`: "]),
        ("alike.csv", vec!["`alike.csv` gives no radius", "all particles are in one place", "--radius METRES"]),
        ("one.csv", vec!["there is one particle only", "--radius METRES"]),
    ] {
        refused(&project, &["render", file, "-o", "a.png"], 2, &words);
    }
    let asset = ["render", "scenes/dots.ron", "-o", "a.png", "--particles"];
    refused(&project, &[&asset[..], &["gone.ply"]].concat(), 2, &["there is no file `gone.ply`"]);
    refused(&project, &[&asset[..], &["empty.ply"]].concat(), 2, &["`empty.ply`: byte 0"]);
}

/// A header that promises four billion particles.
const LYING_PLY: &str = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n\
    property float y\nproperty float z\nend_header\nabcdefghijkl";

#[test]
fn mistakes_in_scenes_and_graphs_end_with_1_and_point() {
    let project = Project::new();
    let render = ["render", "scenes/dots.ron", "-o", "a.png"];
    project.edit("scenes/dots.ron", "assets/dots.csv", "assets/dot.csv");
    refused(&project, &render, 1, &["there is no file `assets/dot.csv`", "scenes/dots.ron:13"]);
    project.edit("scenes/dots.ron", "assets/dot.csv", "assets/dots.csv");
    project.edit("scenes/dots.ron", "\"size\": 1.5", "\"siz\": 1.5");
    refused(&project, &render, 1, &["there is no parameter `siz`", "did you mean `size`?", "scenes/dots.ron:16"]);
    project.edit("scenes/dots.ron", "\"siz\": 1.5", "\"size\": 99.0");
    refused(
        &project,
        &render,
        1,
        &["99.0 is above the greatest value, 10", "scenes/dots.ron:16", "graphs/dots.ron:13"],
    );
    project.edit("scenes/dots.ron", "\"size\": 99.0", "\"size\": 1.0");
    project.edit("scenes/dots.ron", "\"sun\": Light", "\"moon\": Light");
    let missing = ["nothing feeds the input `sun`", "the scene has no `sun`", "graphs/dots.ron:9", "scenes/dots.ron:3"];
    refused(&project, &render, 1, &missing);
    project.edit("scenes/dots.ron", "\"moon\": Light", "\"sun\": Light");
    project.edit("graphs/dots.ron", "\"picture\", clear", "\"pictur\", clear");
    refused(&project, &render, 1, &["`pictur`", "did you mean `picture`?", "graphs/dots.ron"]);
    project.edit("graphs/dots.ron", "\"pictur\", clear", "\"picture\", clear");
    project.edit("shaders/dots/discs.wgsl", "color * light", "colour * light");
    refused(&project, &render, 1, &["colour", "shaders/dots/discs.wgsl:42"]);
}

#[test]
fn parameters_on_the_command_line_are_checked_like_those_of_scenes() {
    let project = Project::new();
    let render = ["render", "scenes/dots.ron", "-o", "a.png", "--set"];
    let set = |value| [&render[..], &[value]].concat();
    refused(&project, &set("siz=1"), 2, &["there is no parameter `siz`", "did you mean `size`?"]);
    refused(
        &project,
        &set("size=big"),
        2,
        &["parameter `size`: expected a finite number, found `big`", "graphs/dots.ron:13"],
    );
    refused(&project, &set("size=11"), 2, &["11.0 is above the greatest value, 10"]);
    refused(&project, &set("color=1,2"), 2, &["expected a value for Color"]);
    refused(&project, &set("present.tone=ages"), 2, &["did you mean `aces`?"]);
}

#[test]
fn check_tells_findings_as_text_and_as_json() {
    let project = Project::new();
    let all = ["graphs/dots.ron", "scenes/dots.ron", "shaders/dots/discs.wgsl"];
    let fine = good(project.run(&[&["check"], &all[..]].concat()));
    assert_eq!((fine.stderr.as_str(), fine.stdout.as_str()), ("3 files checked: nothing wrong\n", ""));
    project.edit("graphs/dots.ron", "\"picture\", clear", "\"pictur\", clear");
    refused(&project, &["check", "graphs/dots.ron"], 1, &["error[", "graphs/dots.ron:31", "1 error"]);
    let json = project.run(&["check", "--format", "json", "graphs/dots.ron"]);
    assert_eq!((json.code, json.stderr.as_str()), (1, ""));
    let found: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(found[0]["severity"], "error");
    assert_eq!(
        (&found[0]["labels"][0]["file"], &found[0]["labels"][0]["line"]),
        (&"graphs/dots.ron".into(), &31.into())
    );
    refused(&project, &["check", "graphs"], 2, &["`graphs` is a folder"]);
    refused(&project, &["check", "graphs/none.ron"], 2, &["there is no graph `graphs/none.ron`"]);
    refused(&project, &["check", "scenes/assets/dots.csv"], 2, &["is no graph, scene (.ron) or shader (.wgsl)"]);
}

#[test]
fn warnings_are_findings_only_if_denied() {
    let project = Project::new();
    project.edit("graphs/dots.ron", "\"disc_m\"", "\"unused_m\": \"2 * size\", \"disc_m\"");
    let warned = project.run(&["check", "graphs/dots.ron"]);
    assert_eq!(warned.code, 0);
    assert!(warned.stderr.contains("warning[unused]") && warned.stderr.contains("unused_m"), "{}", warned.stderr);
    refused(&project, &["check", "--deny-warnings", "graphs/dots.ron"], 1, &["warning[unused]", "1 warning"]);
    assert_eq!(good(project.run(&["check", "--format", "json", "graphs/dots.ron"])).stderr, "");
}

#[test]
fn explain_knows_every_id_that_messages_bear() {
    let project = Project::empty();
    let list = good(project.run(&["explain"])).stdout;
    assert!(list.lines().any(|id| id == "asset"));
    for id in list.lines() {
        assert!(good(project.run(&["explain", id])).stdout.len() > id.len() + 40, "{id}");
    }
    assert_eq!(good(project.run(&["explain", "error[asset]"])).stdout, good(project.run(&["explain", "asset"])).stdout);
    refused(&project, &["explain", "aset"], 2, &["there is no diagnostic `aset`", "did you mean `asset`?"]);
}

#[test]
fn plan_prints_what_would_run() {
    let project = Project::new();
    let plan = good(project.run(&["plan", "graphs/dots.ron", "--size", "320x200"]));
    assert!(plan.stdout.contains("320 x 200") && plan.stdout.contains("discs"), "{}", plan.stdout);
    let scene = good(project.run(&["plan", "scenes/dots.ron"]));
    assert!(scene.stdout.contains("800 x 600"), "{}", scene.stdout);
    let format = |format| good(project.run(&["plan", "graphs/dots.ron", "--format", format])).stdout;
    assert!(serde_json::from_str::<serde_json::Value>(&format("json")).unwrap().is_object());
    assert!(format("dot").starts_with("digraph") && format("svg").starts_with("<svg"));
    refused(&project, &["plan", "shaders/dots/discs.wgsl"], 2, &["is a shader"]);
    refused(&project, &["plan", "graphs/dots.ron", "--set", "siz=1"], 2, &["did you mean `size`?"]);
}

#[test]
fn new_makes_a_project_and_never_overwrites() {
    let project = Project::new();
    let files = ["graphs/dots.ron", "scenes/assets/dots.csv", "scenes/dots.ron", "shaders/dots/discs.wgsl"];
    assert_eq!(project.files(), files);
    project.write("graphs/dots.ron", "mine");
    refused(&project, &["new", "dots"], 2, &["`graphs/dots.ron` is there already, and nothing was written"]);
    assert_eq!(project.text("graphs/dots.ron"), "mine");
    refused(&project, &["new", "../a"], 2, &["small letters"]);
}

#[test]
fn a_copy_of_a_scene_finds_the_graph_and_not_the_scene_beside_it() {
    let project = Project::new();
    project.write("scenes/again.ron", project.text("scenes/dots.ron"));
    good(project.run(&["check", "--deny-warnings", "scenes/again.ron"]));
}

#[test]
fn info_lists_adapters_and_what_graphs_need() {
    let project = Project::empty();
    let info = project.run(&["info"]);
    assert!(info.stdout.contains("shipped graphs"), "{}", info.stdout);
    assert!(!info.stdout.contains("cannot be planned"), "{}", info.stdout);
    let json: serde_json::Value = serde_json::from_str(&project.run(&["info", "--format", "json"]).stdout).unwrap();
    let adapters = json["adapters"].as_array().unwrap();
    assert_eq!(info.code, if adapters.is_empty() { 3 } else { 0 });
}

/// The picture's pixels, which must not all be alike.
fn picture(project: &Project, name: &str) -> image::RgbaImage {
    let image = image::open(project.path(name)).unwrap().into_rgba8();
    let first = *image.get_pixel(0, 0);
    assert!(image.pixels().any(|pixel| *pixel != first), "{name} is blank");
    image
}

#[test]
fn a_scene_becomes_a_picture() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    good(project.run(&["render", "scenes/dots.ron", "-o", "a.png", "--size", "160x120"]));
    assert_eq!(picture(&project, "a.png").dimensions(), (160, 120));
    good(project.run(&["render", "scenes/dots.ron", "-o", "b.png", "--size", "160x120"]));
    assert_eq!(std::fs::read(project.path("a.png")).unwrap(), std::fs::read(project.path("b.png")).unwrap());
    good(project.run(&[
        "render",
        "scenes/dots.ron",
        "-o",
        "c.png",
        "--size",
        "160x120",
        "--eye",
        "3,1,0",
        "--fov",
        "30",
    ]));
    assert_ne!(picture(&project, "a.png"), picture(&project, "c.png"));
    good(project.run(&["render", "scenes/dots.ron", "-o", "d.png", "--size", "160x120", "--set", "size=4"]));
    assert_ne!(picture(&project, "a.png"), picture(&project, "d.png"));
    assert_eq!(project.files().iter().filter(|f| f.ends_with(".part")).count(), 0);
}

#[test]
fn transparent_pictures_have_coverage_and_exr_is_linear() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let args = ["render", "scenes/dots.ron", "--size", "160x120", "-o"];
    good(project.run(&[&args[..], &["a.png", "--transparent"]].concat()));
    let image = picture(&project, "a.png");
    let count = |alpha| image.pixels().filter(|p| p[3] == alpha).count();
    assert!(count(0) > 1000 && count(255) > 100, "{} clear, {} covered", count(0), count(255));
    good(project.run(&[&args[..], &["a.exr"]].concat()));
    let light = image::open(project.path("a.exr")).unwrap().into_rgba32f();
    let pairs = light.pixels().zip(image.pixels());
    assert!(pairs.clone().all(|(light, shown)| (light[3] > 0.5) == (shown[3] > 127)));
    let blue = pairs.filter(|(light, _)| light[3] == 1.0).map(|(light, _)| light[2] / light[0]);
    let expected = 0.6 / 0.1;
    assert!(blue.clone().count() > 100);
    assert!(blue.into_iter().all(|ratio| (ratio - expected).abs() < 0.05), "the graph's own color, before any curve");
}

/// What a scene does not give, a graph may; what it gives wins.
#[test]
fn inputs_have_defaults() {
    let project = Project::new();
    project.edit("graphs/dots.ron", "\"sun\": Light", "\"sun\": Light(default: Light(direction: (1, -1, 0)))");
    let scene = project.text("scenes/dots.ron");
    let lines = scene.lines().filter(|line| !line.contains("\"sun\": Light"));
    project.write("dark.ron", lines.collect::<Vec<_>>().join("\n"));
    good(project.run(&["check", "--deny-warnings", "dark.ron", "scenes/dots.ron"]));
    // What bears the name and is no light is still a mistake.
    project.edit("dark.ron", "    particles: {", "    tables: {\"sun\": []},\n    particles: {");
    refused(&project, &["check", "dark.ron"], 1, &["input `sun`", "is Light, and the scene's `sun` is not"]);
    project.edit("dark.ron", "    tables: {\"sun\": []},\n", "");
    if !has_adapter() {
        return;
    }
    let drawn = |scene: &str, more: &[&str]| {
        good(project.run(&[&["render", scene, "-o", "a.png", "--size", "80x60"], more].concat()));
        std::fs::read(project.path("a.png")).unwrap()
    };
    let (lit, dark) = (drawn("scenes/dots.ron", &[]), drawn("dark.ron", &[]));
    assert_ne!(lit, dark, "the scene's sun wins");
    project.edit("graphs/dots.ron", "direction: (1, -1, 0)", "direction: (-1, -1, 0)");
    assert_ne!(drawn("dark.ron", &[]), dark, "the default lights it");
    assert_eq!(drawn("scenes/dots.ron", &[]), lit);
}

/// Rows of a table that the graph gives, and a scene's, which win.
#[test]
fn tables_have_defaults() {
    let project = Project::empty();
    let graph = r#"Graph(
        inputs: { "lamps": Table(default: [(color: (0, 0.5, 0), power: 2), (color: (1, 1, 1), power: 0)]) },
        resources: { "picture": Texture(format: Rgba16Float, size: "viewport") },
        passes: [ Fullscreen(shader: "lamps.wgsl", color: ["picture"]) ],
        outputs: ["picture"],
    )"#;
    let shader = "struct Lamp { power: f32, color: vec3f }
        var<storage, read> lamps: array<Lamp>;
        @fragment fn lit() -> @location(0) vec4f {
            var sum = vec3f(0.0);
            for (var i = 0u; i < arrayLength(&lamps); i++) { sum += lamps[i].power * lamps[i].color; }
            return vec4f(sum, 1.0);
        }";
    project.write("graphs/lamps.ron", graph);
    project.write("shaders/lamps.wgsl", shader);
    project.write("a.ron", "Scene(graph: \"lamps.ron\", camera: Camera(eye: (0, 0, 1), target: (0, 0, 0)))");
    let given = "target: (0, 0, 0)), tables: { \"lamps\": [(color: (0, 0, 1), power: 3)] })";
    project.write("b.ron", project.text("a.ron").replace("target: (0, 0, 0)))", given));
    good(project.run(&["check", "--deny-warnings", "graphs/lamps.ron", "a.ron", "b.ron"]));
    project.write("c.ron", project.text("b.ron").replace("power", "might"));
    refused(&project, &["check", "c.ron"], 1, &["the rows of `lamps`", "row 0 lacks `power` of `Lamp`"]);
    if !has_adapter() {
        return;
    }
    let drawn = |scene: &str| {
        good(project.run(&["render", scene, "-o", "a.exr", "--size", "4x4"]));
        image::open(project.path("a.exr")).unwrap().into_rgba32f().get_pixel(1, 1).0
    };
    assert_eq!(drawn("a.ron"), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(drawn("b.ron"), [0.0, 0.0, 3.0, 1.0]);
}

/// A graph with state moves on with time, and sees the scene's pointer and the command line's.
#[test]
fn a_new_graph_with_state_runs_and_sees_the_pointer() {
    let project = Project::empty();
    good(project.run(&["new", "sheet", "--state"]));
    let files = ["graphs/sheet.ron", "scenes/sheet.ron", "shaders/sheet/show.wgsl", "shaders/sheet/step.wgsl"];
    assert_eq!(project.files(), files);
    good(project.run(&["check", "--deny-warnings", "graphs/sheet.ron", "scenes/sheet.ron"]));
    good(project.run(&["check", "--deny-warnings", "--device", "core", "graphs/sheet.ron", "scenes/sheet.ron"]));
    if !has_adapter() {
        return;
    }
    let render = ["render", "scenes/sheet.ron", "--size", "80x60", "-o"];
    let drawn = |name: &str, more: &[&str]| {
        good(project.run(&[&render[..], &[name], more].concat()));
        std::fs::read(project.path(name)).unwrap()
    };
    let one = drawn("one.png", &["--time", "1.5"]);
    assert_eq!(drawn("again.png", &["--time", "1.5"]), one);
    assert_ne!(drawn("later.png", &["--time", "1.6"]), one);
    assert_ne!(drawn("held.png", &["--time", "1.5", "--pointer", "0.2,0,-0.3"]), one);
    assert_eq!(drawn("anew.png", &["--time", "1.5", "--set", "restart=1"]), one, "headless always starts anew");
    project.edit("scenes/sheet.ron", "(time: 1.0, at: (-0.6", "(time: 1.0, at: (-0.5");
    assert_ne!(drawn("moved.png", &["--time", "1.5"]), one);
    project.edit("scenes/sheet.ron", "(time: 2.0", "(time: 1.0");
    refused(
        &project,
        &["check", "scenes/sheet.ron"],
        1,
        &["the times of a pointer's keys must rise", "scenes/sheet.ron:"],
    );
}

#[test]
fn numbered_files_are_frames() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    // Frame n has a row of n dots; there is no frame 4, and 6 is damaged.
    let row = |n: usize| format!("x,y,z\n{}", (0..n).map(|i| format!("{i},{n},0\n")).collect::<String>());
    for n in [2, 3, 5, 7] {
        project.write(&format!("scenes/assets/row_{n:03}.csv"), row(n));
    }
    project.write("scenes/assets/row_006.csv", "x,y,z\n1,2\n");
    project.edit("scenes/dots.ron", "assets/dots.csv", "assets/row_###.csv");
    let args =
        ["render", "scenes/dots.ron", "--size", "64x48", "--eye", "2,3,9", "--target", "2,3,0", "--radius", "0.3"];
    let run = good(project.run(&[&args[..], &["-o", "f_##.png", "--frames", "2..8"]].concat()));
    for words in [
        "frame 4: there is no file `scenes/assets/row_004.csv`: frame 3 is shown in its place",
        "frame 6: `scenes/assets/row_006.csv`: line 2, column 1: expected 3 cells as in the header, found 2: frame 5 is shown",
    ] {
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
    assert_eq!(run.stderr.matches("frame 8 is beyond 2 to 7: 7 is shown").count(), 1, "{}", run.stderr);
    let picture = |name: &str| std::fs::read(project.path(name)).unwrap();
    for (more, words) in [
        (["--frame", "9999"], "warning[asset-note]: `row_###.csv`: frame 9999 is beyond 2 to 7: 7 is shown"),
        (["--frame", "0"], "warning[asset-note]: `row_###.csv`: frame 0 is before 2 to 7: 2 is shown"),
    ] {
        let run = good(project.run(&[&args[..], &["-o", "one.png"], &more].concat()));
        assert_eq!(run.stderr.matches(words).count(), 1, "{}", run.stderr);
    }
    assert_eq!(picture("one.png"), picture("f_02.png"));
    // By time the last one stays, as the scene's end is no frame's number.
    let run = good(project.run(&[&args[..], &["-o", "one.png", "--time", "60"]].concat()));
    assert!(!run.stderr.contains("beyond"), "{}", run.stderr);
    assert_eq!(picture("one.png"), picture("f_07.png"));
    // Each of several goes on beyond the last, which is told once.
    let run = good(project.run(&[&args[..], &["-o", "g_##.png", "--frames", "7..10"]].concat()));
    assert_eq!(run.stderr.matches("is beyond 2 to 7").count(), 1, "{}", run.stderr);
    // A frame by itself is what it is amid others, and not what another is.
    for (frame, like) in [("2", "f_02.png"), ("5", "f_05.png"), ("4", "f_03.png"), ("8", "f_07.png"), ("7", "f_07.png")]
    {
        good(project.run(&[&args[..], &["-o", "one.png", "--frame", frame]].concat()));
        assert_eq!(picture("one.png"), picture(like), "frame {frame}");
        assert_eq!(picture("one.png"), picture(&format!("f_0{frame}.png")), "frame {frame}");
    }
    assert_ne!(picture("f_02.png"), picture("f_03.png"));
    // At 25 frames a second, the file after one of 0.04 s.
    good(project.run(&[&args[..], &["-o", "one.png", "--time", "0.05"]].concat()));
    assert_eq!(picture("one.png"), picture("f_03.png"));
    let bare = ["render", "scenes/assets/row_###.csv", "--size", "64x48", "--radius", "0.3"];
    good(project.run(&[&bare[..], &["-o", "b.png", "--frames", "2..3", "--graph", "graphs/dots.ron"]].concat()));
    let none = ["render", "scenes/assets/rows_###.csv", "-o", "c.png"];
    refused(&project, &none, 2, &["no file is named `scenes/assets/rows_###.csv` with a number in place of the `#`"]);
}

#[test]
fn sequences_are_numbered_and_dumps_hold_what_was_asked_for() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let args = ["render", "scenes/dots.ron", "--size", "64x48"];
    good(project.run(&[&args[..], &["-o", "f.png", "--frames", "1..3"]].concat()));
    let pictures: Vec<_> = project.files().into_iter().filter(|f| f.ends_with(".png")).collect();
    assert_eq!(pictures, ["f_0001.png", "f_0002.png", "f_0003.png"]);
    let dumps = ["--dump", "depth=z.exr", "--dump", "particles.position=p.ply", "--dump", "picture=p.png"];
    good(project.run(&[&args[..], &["-o", "a.png"], &dumps[..]].concat()));
    let depth = image::open(project.path("z.exr")).unwrap().into_rgba32f();
    assert!(depth.pixels().any(|p| p[0] == 0.0) && depth.pixels().any(|p| p[0] > 0.0 && p[0] < 1.0));
    let bytes = std::fs::read(project.path("p.ply")).unwrap();
    let set = meniscus::scene::particles::read(std::path::Path::new("p.ply"), &bytes).unwrap();
    assert_eq!((set.count, set.positions()[0]), (200, [0.5, 0.0, 0.0]));
    picture(&project, "p.png");
    let wrong = [&args[..], &["-o", "b.png", "--dump", "dept=z2.exr"]].concat();
    let run = project.run(&wrong);
    assert!(run.code != 0 && run.stderr.contains("did you mean `depth`?"), "{}", run.stderr);
    assert!(!project.path("z2.exr").exists());
}

#[test]
fn no_particles_are_a_warning_and_a_picture() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    project.write("none.csv", "x,y,z\n");
    let args = ["-o", "a.png", "--size", "64x48"];
    let run = good(project.run(&[&["render", "scenes/dots.ron", "--particles", "none.csv"], &args[..]].concat()));
    assert!(run.stderr.contains("warning[asset-note]") && run.stderr.contains("none.csv"), "{}", run.stderr);
    picture(&project, "a.png");
    good(project.run(&[&["render", "none.csv"], &args[..]].concat()));
    picture(&project, "a.png");
}

#[test]
fn particles_by_themselves_are_framed_and_their_radius_is_told() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let run = good(project.run(&["render", "scenes/assets/dots.csv", "-o", "a.png", "--size", "160x120"]));
    assert!(run.stderr.contains("is estimated from the spacing"), "{}", run.stderr);
    let framed = picture(&project, "a.png");
    good(project.run(&["render", "scenes/assets/dots.csv", "-o", "b.png", "--size", "160x120", "--radius", "0.05"]));
    assert_ne!(framed, picture(&project, "b.png"));
    good(project.run(&["render", "scenes/assets/dots.csv", "-o", "c.png", "--size", "160x120", "--graph", "dots.ron"]));
    assert_ne!(framed, picture(&project, "c.png"));
}

#[test]
fn a_third_partys_particles_become_a_picture() {
    let Some(path) = shared("splashsurf/double_dam_break_frame_26_4732_particles.vtk") else { return };
    if !has_adapter() {
        return;
    }
    let project = Project::empty();
    let path = path.to_str().unwrap();
    let run =
        good(project.run(&["render", path, "-o", "a.png", "--size", "160x120", "--radius", "0.025", "--timings"]));
    assert!(run.stderr.contains("GPU ms") && !run.stderr.contains("estimated"), "{}", run.stderr);
    picture(&project, "a.png");
}

#[test]
fn a_size_beyond_the_device_is_wrong_usage() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    refused(
        &project,
        &["render", "scenes/dots.ron", "-o", "a.png", "--size", "32768x8"],
        2,
        &["than this device can do"],
    );
}

#[test]
fn bench_measures_passes_and_memory() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let args = ["bench", "scenes/dots.ron", "--size", "64x48", "--frames", "3", "--format"];
    let json = good(project.run(&[&args[..], &["json"]].concat())).stdout;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["frames"], &json["passes"][0]["pass"]), (&3.into(), &"discs".into()));
    assert!(json["encode"]["median_ms"].as_f64().unwrap() > 0.0);
    assert!(json["memory"]["held_bytes"].as_u64().unwrap() > 64 * 48 * 8);
    let csv = good(project.run(&[&args[..], &["csv"]].concat())).stdout;
    assert!(csv.starts_with("what,median_ms,p99_ms\ndiscs,"), "{csv}");
    assert!(good(project.run(&[&args[..], &["table"]].concat())).stdout.contains("all passes"));
}

#[test]
fn pictures_do_not_depend_on_the_policy_and_budgets_are_kept() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let base = ["render", "scenes/dots.ron", "--size", "64x48", "-o"];
    let render = |name: &str, more: &[&str]| {
        good(project.run(&[&base[..], &[name], more].concat()));
        std::fs::read(project.path(name)).unwrap()
    };
    let keep = render("keep.png", &["--policy", "keep"]);
    assert!(keep == render("smallest.png", &["--policy", "smallest"]), "the policies draw other pictures");
    assert!(keep == render("within.png", &["--memory-budget", "1MiB"]));
    let small = [&base[..], &["a.png", "--memory-budget", "16 KiB"]].concat();
    refused(&project, &small, 1, &["error[memory-budget]", "of what shows the picture", "graphs/dots.ron:"]);
    let held = |budget: &str| {
        let args = ["bench", "scenes/dots.ron", "--size", "64x48", "--frames", "1", "--format", "json"];
        let run = good(project.run(&[&args[..], &["--memory-budget", budget]].concat()));
        let json: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        json["memory"]["held_bytes"].as_u64().unwrap()
    };
    // What the planner counts is what is held, to the byte.
    let bytes = held("1GiB");
    assert_eq!(held(&bytes.to_string()), bytes);
    let less = (bytes - 1).to_string();
    refused(
        &project,
        &["bench", "scenes/dots.ron", "--size", "64x48", "--memory-budget", &less],
        1,
        &["memory-budget"],
    );
    let plan = good(project.run(&["plan", "scenes/dots.ron", "--policy", "smallest"])).stdout;
    assert!(plan.contains("the policy is \"smallest\": it was asked for"), "{plan}");
}

#[test]
fn bench_shows_statistics() {
    if !has_adapter() {
        return;
    }
    let declarations = "resources: {\"found\": Counted(capacity: 100), PICTURE}, \
        stats: {\"full\": \"count(found) / capacity(found)\", \"none\": \"1 / (count(found) - 64)\"},";
    let passes = "Clear(of: \"found\"), Compute(shader: \"find.wgsl\", groups: 1),";
    let project = project_of(passes, declarations, &[("find", FIND), ("show", SHOW_FOUND)]);
    let args = ["bench", "scenes/it.ron", "--frames", "1", "--format"];
    let json = good(project.run(&[&args[..], &["json"]].concat())).stdout;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["statistics"], serde_json::json!({ "full": 0.64, "none": null }));
    let table = good(project.run(&[&args[..], &["table"]].concat())).stdout;
    assert!(table.contains("full: 0.64\nnone: no value\n"), "{table}");
    let plan = good(project.run(&["plan", "graphs/it.ron"])).stdout;
    assert!(plan.contains("statistics: 2;") && plan.contains("full  count(found) / capacity(found)"), "{plan}");
}

/// A project with one graph and its shaders.
fn project_of(passes: &str, declarations: &str, shaders: &[(&str, &str)]) -> Project {
    let project = Project::empty();
    let picture = "\"picture\": Texture(format: Rgba16Float, size: \"viewport\")";
    let outputs = "outputs: [\"picture\"]";
    let show = "Fullscreen(shader: \"show.wgsl\", color: [\"picture\"])";
    let declarations = declarations.replace("PICTURE", picture);
    project.write("graphs/it.ron", format!("Graph({declarations} passes: [{passes} {show}], {outputs})"));
    project.write("scenes/it.ron", "Scene(graph: \"it.ron\", size: (16, 8))");
    for (name, text) in shaders {
        project.write(&format!("shaders/{name}.wgsl"), text);
    }
    project
}

const COUNT: &str = "var<storage, read_write> count: array<u32>;\n\
    @compute @workgroup_size(1) fn main() { count[0] += 1u; }";
const SHOW_COUNT: &str = "var<storage, read> count: array<u32>;\n\
    @fragment fn main() -> @location(0) vec4f { return vec4f(f32(count[0])); }";

/// How many steps ran until a moment.
fn steps(project: &Project, when: &[&str]) -> u32 {
    good(project.run(&[&["render", "scenes/it.ron", "-o", "a.png", "--dump", "count=c.csv"], when].concat()));
    project.text("c.csv").lines().nth(1).unwrap().parse().unwrap()
}

#[test]
fn steps_run_up_to_the_moment_that_is_asked_for() {
    if !has_adapter() {
        return;
    }
    let shaders = [("count", COUNT), ("show", SHOW_COUNT)];
    let declarations = "state: {\"count\": Buffer(items: 1)}, resources: {PICTURE},";
    let at_a_rate = "Steps(rate: 10.0, passes: [Compute(shader: \"count.wgsl\", groups: 1)]),";
    let project = project_of(at_a_rate, declarations, &shaders);
    assert_eq!(steps(&project, &["--time", "0.55"]), 5);
    assert_eq!(steps(&project, &["--frame", "30"]), 5);
    assert_eq!(steps(&project, &["--frame", "29"]), 4);
    assert_eq!(steps(&project, &[]), 0);
    let huge = ["render", "scenes/it.ron", "-o", "b.png", "--time", "1e12"];
    refused(&project, &huge, 2, &["would run 10000000000000 steps"]);
    let each_frame = at_a_rate.replace("10.0", "PerFrame");
    let project = project_of(&each_frame, declarations, &shaders);
    assert_eq!(steps(&project, &["--frame", "3"]), 4);
}

const FIND: &str = "struct Found { count: atomic<u32>, items: array<u32> }\n\
    var<storage, read_write> found: Found;\n\
    @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {\n\
        let at = atomicAdd(&found.count, 1u);\n\
        if at < arrayLength(&found.items) { found.items[at] = i; }\n\
    }";
const SHOW_FOUND: &str = "struct Found { count: u32, items: array<u32> }\n\
    var<storage, read> found: Found;\n\
    @fragment fn main() -> @location(0) vec4f { return vec4f(f32(found.items[0] + found.count)); }";

#[test]
fn a_frame_whose_counted_buffer_overflows_is_repeated_with_more_room() {
    if !has_adapter() {
        return;
    }
    let declarations = "resources: {\"found\": Counted(capacity: 4), PICTURE},";
    let passes = "Clear(of: \"found\"), Compute(shader: \"find.wgsl\", groups: 1),";
    let project = project_of(passes, declarations, &[("find", FIND), ("show", SHOW_FOUND)]);
    let run = good(project.run(&["render", "scenes/it.ron", "-o", "a.png", "--dump", "found=f.csv"]));
    let said = "`found` had room for 4 items, and 64 came: the frame was repeated";
    assert!(run.stderr.contains("note[overflow]") && run.stderr.contains(said), "{}", run.stderr);
    let mut items: Vec<u32> = project.text("f.csv").lines().skip(1).map(|line| line.parse().unwrap()).collect();
    items.sort_unstable();
    assert_eq!(items, (0..64).collect::<Vec<u32>>());
}
