//! Plans as text, JSON, DOT and SVG.

use meniscus::graph::value::Value;
use meniscus::plan::explain::{Explanation, explain};
use meniscus::plan::model::Plan;
use meniscus::plan::print;
use serde_json::Value as Json;

use crate::golden::golden;
use crate::planning::{Test, paths};

/// A bit of everything: a part, a loop, steps, a counted buffer, shared memory, something culled.
fn sample() -> Plan {
    test().plan()
}

fn test() -> Test {
    let graph = r#"Graph(
        params: { "turns": Int(default: 4, min: 0, max: 9, unit: "times", about: "how often") },
        state: { "old": Buffer(items: 16), "next": Buffer(items: 16) },
        resources: {
            "list": Counted(capacity: 50), "seen": Buffer(items: 50), "idle": Buffer(items: 5),
            "a": Texture(format: Rgba16Float, size: "viewport", layers: 2), "b": Texture(format: Rgba16Float, size: "viewport"),
            "c": Texture(format: Rgba16Float, size: "viewport"), "out": Texture(format: Rgba16Float, size: "viewport"),
        },
        passes: [
            Clear(name: "empty", of: "list"),
            Compute(name: "append", shader: "append.wgsl", each: Threads(100, 1, 1)),
            Compute(name: "use", shader: "consume.wgsl", each: Item("list"), bind: {"dst": "seen"}),
            Clear(name: "idle", of: "idle"),
            Steps(name: "sim", rate: 60, passes: [ Repeat(times: 1, swap: [("old", "next")], passes: [
                Compute(name: "step", shader: "step.wgsl", each: Item("next"), bind: {"src": "old", "dst": "next"}),
            ]) ]),
            Copy(name: "show", from: "old", to: "idle_copy"),
            Clear(name: "near", of: "a", layer: 0), Clear(name: "far", of: "a", layer: 1),
            Fullscreen(name: "join", shader: "layers.wgsl", color: ["b"], bind: {"src": "a"}),
            Repeat(times: "turns", swap: [("b", "c")], passes: [
                Fullscreen(name: "smooth", shader: "filter.wgsl", color: ["c"], bind: {"src": "b"}),
            ]),
            Use(graph: "end.ron", name: "end", bind: {"picture": "b"}),
            Fullscreen(name: "out", shader: "filter.wgsl", color: ["out"], bind: {"src": "end.result"}),
        ],
        outputs: { "picture": "out", "seen": "seen", "sim": "idle_copy" },
    )"#;
    let graph =
        graph.replace(r#""idle": Buffer(items: 5),"#, r#""idle": Buffer(items: 5), "idle_copy": Buffer(items: 16),"#);
    let end = r#"Graph(
        inputs: { "picture": Texture },
        resources: { "half": Texture(format: Rgba16Float, size: "viewport") },
        passes: [ Fullscreen(name: "mend", shader: "filter.wgsl", color: ["half"], bind: {"src": "picture"}) ],
        outputs: { "result": "half" },
    )"#;
    Test::new(&graph).with("graphs/end.ron", end).param("turns", Value::Int(5)).root("seen").root("idle_copy")
}

fn explained(name: Option<&str>) -> Vec<Explanation> {
    let (plan, sources) = test().with_sources();
    explain(&plan.unwrap(), &sources, name).unwrap_or_else(|found| panic!("{found:?}"))
}

#[test]
fn explained_as_text() {
    golden("tests/plan/explained.txt", &print::explained(&explained(None)));
}

#[test]
fn explained_as_json() {
    let json: Json = serde_json::from_str(&print::explained_json(&explained(Some("b")))).unwrap();
    assert_eq!((&json[0]["kind"], &json[0]["path"]), (&"resource".into(), &"b".into()));
    assert!(json[0]["written_by"][0].as_str().unwrap().starts_with("join"), "{json}");
    assert!(json[0]["memory"][1].as_str().unwrap().contains("shared with end.half"), "{json}");
}

#[test]
fn a_loop_is_explained_by_its_name_and_what_is_unknown_has_neighbours() {
    let paths = |name| explained(Some(name)).iter().map(|e| e.path.clone()).collect::<Vec<_>>();
    assert_eq!(paths("smooth"), ["smooth[0]"]);
    assert_eq!(paths("smooth[3]"), ["smooth[3]"]);
    assert_eq!(paths("idle"), ["idle", "idle"], "a culled pass and what it writes");
    let (plan, sources) = test().with_sources();
    let unknown = explain(&plan.unwrap(), &sources, Some("smoth")).unwrap_err();
    assert_eq!(unknown.message, "no pass and no resource is called `smoth`");
    assert!(unknown.hints.iter().any(|hint| hint.contains("did you mean `smooth")), "{unknown:?}");
}

#[test]
fn as_text() {
    golden("tests/plan/sample.txt", &print::text(&sample()));
}

#[test]
fn as_dot() {
    golden("tests/plan/sample.dot", &print::dot(&sample()));
}

#[test]
fn as_svg() {
    golden("tests/plan/sample.svg", &print::svg(&sample()));
}

#[test]
fn as_json() {
    golden("tests/plan/sample.json", &print::json(&sample()));
}

#[test]
fn iterations_that_differ_in_swapped_names_are_one_line() {
    let text = print::text(&sample());
    assert!(text.contains("smooth[0..4]"), "{text}");
    assert!(!text.contains("smooth[1]"), "{text}");
    assert!(text.contains("5 times"), "{text}");
}

#[test]
fn json_has_everything_of_the_plan() {
    let plan = sample();
    let json: Json = serde_json::from_str(&print::json(&plan)).unwrap();
    let list = |name: &str| json[name].as_array().unwrap_or_else(|| panic!("no {name}")).clone();
    let found: Vec<String> = list("passes").iter().map(|p| p["path"].as_str().unwrap().to_owned()).collect();
    assert_eq!(found, paths(&plan));
    assert_eq!(list("units").len(), plan.units.len());
    assert_eq!(list("resources").len(), plan.objects.len());
    assert_eq!(list("outputs").len(), 3);
    assert_eq!(json["steps"][0]["rate_hz"], 60.0);
    assert_eq!(json["rings"][0]["turn"], 1);
    assert_eq!(json["culled"][0]["path"], "idle");
    assert_eq!(json["culled"][0]["why"], "no output needs `idle`");
    assert_eq!(json["memory"]["unshared_bytes"], plan.memory.unshared);
    assert_eq!(json["params"][0]["value"], 5);
    for (pass, shown) in plan.passes.iter().zip(list("passes")) {
        let reads = pass.accesses.iter().filter(|a| a.read).count();
        let writes = pass.accesses.iter().filter(|a| a.write).count();
        assert_eq!(shown["reads"].as_array().unwrap().len(), reads);
        assert_eq!(shown["writes"].as_array().unwrap().len(), writes);
        assert_eq!(shown["unit"], pass.unit);
    }
    // Layers are told apart.
    let far = found.iter().position(|path| path == "far").unwrap();
    assert_eq!(json["passes"][far]["writes"][0]["layers"], serde_json::json!([1, 2]));
}

#[test]
fn svg_is_well_formed_and_shows_each_row_once() {
    let svg = print::svg(&sample());
    let mut reader = quick_xml_depth(&svg);
    assert_eq!(reader.remove(0), "svg");
    assert!(svg.contains("smooth[0..4] x5"), "{svg}");
    assert_eq!(svg.matches(">near<").count(), 1);
    assert!(svg.contains(">b | end.half  24.0 KiB<"), "shared memory has a row: {svg}");
}

/// The names of all elements, having checked that they nest.
fn quick_xml_depth(text: &str) -> Vec<String> {
    let (mut open, mut all) = (Vec::new(), Vec::new());
    for tag in text.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap_or_else(|| panic!("unclosed <{tag}"));
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap().to_owned();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else {
            all.push(name.clone());
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "{open:?}");
    all
}
