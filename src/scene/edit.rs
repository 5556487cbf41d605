//! Changing a scene's text by hand's rules: a value takes the place of a value, a new entry
//! stands behind the last one, and everything else, comments and order too, stays as it was.

use glam::DVec3;

use super::camera::Camera;
use crate::diagnostic::{Diagnostics, Sources};
use crate::graph::value::Value;
use crate::syntax::{self, Body, Kind, Node};

/// What hinders an edit, as a message.
pub type Refusal = String;

/// Gives a field of the scene this text as its value.
///
/// # Errors
/// If the text is no scene.
pub fn set_field(text: &str, field: &str, value: &str) -> Result<String, Refusal> {
    let root = root(text)?;
    let fields = fields(&root)?;
    if let Some((_, node)) = fields.iter().find(|(name, _)| name == field) {
        return Ok(replaced(text, node, value));
    }
    let last = fields.last().map(|(_, node)| *node);
    let first = fields.first().map(|(_, node)| *node);
    let bracket = bracket(text, &root, '(', ')')?;
    Ok(appended(text, bracket, first.zip(last), &format!("{field}: {value}")))
}

/// Gives an entry of a map (`params`, `present`, `particles`) this text as its value.
///
/// # Errors
/// If the text is no scene, or the field no map.
pub fn set_entry(text: &str, field: &str, name: &str, value: &str) -> Result<String, Refusal> {
    let root = root(text)?;
    let Some((_, map)) = fields(&root)?.into_iter().find(|(known, _)| known == field) else {
        return set_field(text, field, &format!("{{ {name:?}: {value} }}"));
    };
    let Kind::Map(entries) = &map.kind else { return Err(format!("`{field}` is no map of names")) };
    let known = entries.iter().find(|(key, _)| key.as_str().is_some_and(|key| key.value == name));
    if let Some((_, node)) = known {
        return Ok(replaced(text, node, value));
    }
    let ends = entries.first().zip(entries.last()).map(|((first, _), (_, last))| (first, last));
    Ok(appended(text, bracket(text, map, '{', '}')?, ends, &format!("{name:?}: {value}")))
}

/// Adds this text to the list that an entry of a map is (`meshes`). An entry that is one thing becomes a list
/// of both, and one that is not there a list of one.
///
/// # Errors
/// If the text is no scene, or the field no map.
pub fn add_item(text: &str, field: &str, name: &str, item: &str) -> Result<String, Refusal> {
    let root = root(text)?;
    let map = fields(&root)?.into_iter().find(|(known, _)| known == field).map(|(_, map)| map);
    let entries = match map.map(|map| &map.kind) {
        None => return set_entry(text, field, name, &format!("[{item}]")),
        Some(Kind::Map(entries)) => entries,
        Some(_) => return Err(format!("`{field}` is no map of names")),
    };
    let known = entries.iter().find(|(key, _)| key.as_str().is_some_and(|key| key.value == name));
    let Some((_, node)) = known else { return set_entry(text, field, name, &format!("[{item}]")) };
    match &node.kind {
        Kind::List(items) => Ok(appended(text, bracket(text, node, '[', ']')?, items.first().zip(items.last()), item)),
        _ => Ok(replaced(text, node, &format!("[{}, {item}]", &text[range(node)]))),
    }
}

/// A value as scenes write it.
pub fn written(value: &Value) -> String {
    match value {
        Value::Bool(b) => b.to_string(),
        Value::Int(i) => i.to_string(),
        Value::Float(x) => format!("{x:?}"),
        Value::Word(word) => format!("{word:?}"),
        Value::Vector(_) => {
            let numbers: Vec<String> = value.numbers().map(|x| format!("{x:?}")).collect();
            format!("({})", numbers.join(", "))
        }
    }
}

/// A camera as scenes write it, to a tenth of a millimetre.
pub fn camera(camera: &Camera) -> String {
    let round = |x: f64| (x * 1e4).round() / 1e4 + 0.0;
    let triple = |v: DVec3| format!("({:?}, {:?}, {:?})", round(v.x), round(v.y), round(v.z));
    let up = if camera.up == DVec3::Y { String::new() } else { format!(", up: {}", triple(camera.up)) };
    let near = camera.near_m.map(|near| format!(", near: {near:?}")).unwrap_or_default();
    let (eye, target) = (triple(camera.eye), triple(camera.target));
    format!("Camera(eye: {eye}, target: {target}{up}, fov: {:?}{near})", round(camera.fov_degrees))
}

fn root(text: &str) -> Result<Node, Refusal> {
    let mut sources = Sources::new();
    let file = sources.add("scene", text);
    let mut found = Diagnostics::new();
    let node = syntax::parse(&sources, file, &mut found);
    if let Some(error) = found.iter().next() {
        return Err(format!("the scene cannot be read: {}", error.message));
    }
    node.ok_or_else(|| "the scene is empty".to_owned())
}

fn fields(root: &Node) -> Result<Vec<(String, &Node)>, Refusal> {
    let tagged = root.as_tagged().filter(|t| t.name.as_ref().is_none_or(|name| name.value == "Scene"));
    match tagged.map(|t| &t.body) {
        Some(Body::Fields(fields)) => Ok(fields.iter().map(|(name, node)| (name.value.clone(), node)).collect()),
        Some(Body::Items(items)) if items.is_empty() => Ok(Vec::new()),
        _ => Err("this is no scene".into()),
    }
}

fn range(node: &Node) -> std::ops::Range<usize> {
    node.span.start as usize..node.span.end as usize
}

fn replaced(text: &str, node: &Node, value: &str) -> String {
    let range = range(node);
    // A word that stood without quotes stays so.
    let bare = value.strip_prefix('"').and_then(|v| v.strip_suffix('"')).filter(|_| node.as_word().is_some());
    format!("{}{}{}", &text[..range.start], bare.unwrap_or(value), &text[range.end..])
}

/// Where the content of a node's bracket begins and ends.
fn bracket(text: &str, node: &Node, open: char, close: char) -> Result<[usize; 2], Refusal> {
    let range = range(node);
    let inside = text.get(range.clone()).unwrap_or_default();
    match (inside.find(open), inside.ends_with(close)) {
        (Some(at), true) => Ok([range.start + at + 1, range.end - 1]),
        _ => Err("the scene has brackets that cannot be made out".into()),
    }
}

/// Puts an entry behind the last one of a bracket, in the way in which the others stand. `ends` are the
/// first node of the first entry, or its value, and the last node of the last entry.
fn appended(text: &str, bracket: [usize; 2], ends: Option<(&Node, &Node)>, entry: &str) -> String {
    let [open, close] = bracket;
    let Some((first, last)) = ends else {
        let rest = if text[open..close].trim().is_empty() { " " } else { "," };
        let end = if rest == "," { open } else { close };
        return format!("{} {entry}{rest}{}", &text[..open], &text[end..]);
    };
    let value_end = last.span.end as usize;
    let tail = &text[value_end..close];
    let comma = after_blanks(tail).filter(|at| tail[*at..].starts_with(','));
    let is_tall = text[open..close].contains('\n');
    if !is_tall {
        let (at, entry) = match comma {
            Some(comma) => (value_end + comma + 1, format!(" {entry},")),
            None => (value_end, format!(", {entry}")),
        };
        return format!("{}{entry}{}", &text[..at], &text[at..]);
    }
    // Behind the comma, and behind a comment on the same line, which is about the entry before.
    let behind = value_end + comma.map_or(0, |comma| comma + 1);
    let line_end = text[behind..close].find('\n').map_or(behind, |at| behind + at);
    let is_remark = matches!(text[behind..line_end].trim_start(), rest if rest.is_empty() || rest.starts_with("//"));
    let at = if is_remark { line_end } else { behind };
    let indent = indent(text, first.span.start as usize);
    let missing = if comma.is_some() { "" } else { "," };
    format!("{}{missing}{}\n{indent}{entry},{}", &text[..value_end], &text[value_end..at], &text[at..])
}

/// Where the first thing stands that is neither blank nor comment.
fn after_blanks(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let blank = rest.len() - rest.trim_start().len();
        at += blank;
        let rest = &text[at..];
        if rest.starts_with("//") {
            at += rest.find('\n')?;
        } else if rest.starts_with("/*") {
            at += rest.find("*/")? + 2;
        } else {
            return (!rest.is_empty()).then_some(at);
        }
    }
}

/// The blanks that the line at `at` begins with.
fn indent(text: &str, at: usize) -> &str {
    let start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let line = &text[start..];
    &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TALL: &str = "// A scene.\nScene(\n    graph: \"a.ron\", // which\n    params: {\n        \"x\": 1.0, // about x\n        /* y */ \"y\": fast, // about y\n    },\n    size: (640, 480) // last\n)\n";

    #[test]
    fn a_value_takes_the_place_of_a_value() {
        let now = set_entry(TALL, "params", "x", "2.5").expect("an edit");
        assert_eq!(now, TALL.replace("1.0", "2.5"));
        let now = set_entry(TALL, "params", "y", &written(&Value::Word("slow".into()))).expect("an edit");
        assert_eq!(now, TALL.replace("fast", "slow"));
        assert_eq!(set_field(TALL, "size", "(8, 6)").expect("an edit"), TALL.replace("(640, 480)", "(8, 6)"));
    }

    #[test]
    fn a_new_entry_stands_behind_the_last_and_its_comment() {
        let now = set_entry(TALL, "params", "part.z", "(1.0, 2.0, 3.0)").expect("an edit");
        let line = "// about y\n        \"part.z\": (1.0, 2.0, 3.0),";
        assert_eq!(now, TALL.replace("// about y", line));
    }

    #[test]
    fn a_new_field_gets_the_comma_that_was_missing() {
        let now = set_entry(TALL, "present", "exposure", "0.5").expect("an edit");
        let lines = "(640, 480), // last\n    present: { \"exposure\": 0.5 },";
        assert_eq!(now, TALL.replace("(640, 480) // last", lines));
        root(&now).expect("RON");
    }

    #[test]
    fn flat_and_empty_brackets_stay_flat() {
        let edit = |text: &str| set_entry(text, "params", "b", "2").expect("an edit");
        assert_eq!(edit("Scene(params: {\"a\": 1})"), "Scene(params: {\"a\": 1, \"b\": 2})");
        assert_eq!(edit("Scene(params: { \"a\": 1, })"), "Scene(params: { \"a\": 1, \"b\": 2, })");
        assert_eq!(edit("Scene(params: {})"), "Scene(params: { \"b\": 2 })");
        assert_eq!(edit("Scene()"), "Scene( params: { \"b\": 2 } )");
        let commented = edit("Scene(params: { // none\n })");
        assert_eq!(commented, "Scene(params: { \"b\": 2, // none\n })");
        root(&commented).expect("RON");
    }

    #[test]
    fn an_item_joins_those_that_are_there() {
        let add = |text: &str| add_item(text, "meshes", "m", "\"b.obj\"").expect("an edit");
        assert_eq!(add("Scene(meshes: {\"m\": [\"a.obj\"]})"), "Scene(meshes: {\"m\": [\"a.obj\", \"b.obj\"]})");
        assert_eq!(
            add("Scene(meshes: {\"m\": (file: \"a.obj\")})"),
            "Scene(meshes: {\"m\": [(file: \"a.obj\"), \"b.obj\"]})"
        );
        assert_eq!(add("Scene(meshes: {\"m\": []})"), "Scene(meshes: {\"m\": [ \"b.obj\" ]})");
        assert_eq!(add("Scene(meshes: {\"n\": \"a.obj\"})"), "Scene(meshes: {\"n\": \"a.obj\", \"m\": [\"b.obj\"]})");
        assert_eq!(add("Scene()"), "Scene( meshes: { \"m\": [\"b.obj\"] } )");
        let tall = "Scene(meshes: {\"m\": [\n    \"a.obj\", // first\n]})";
        assert_eq!(add(tall), "Scene(meshes: {\"m\": [\n    \"a.obj\", // first\n    \"b.obj\",\n]})");
        assert!(add_item("Scene(meshes: [])", "meshes", "m", "1").is_err());
    }

    #[test]
    fn what_is_no_scene_is_refused() {
        assert!(set_entry("Graph(passes: [])", "params", "b", "2").is_err());
        assert!(set_entry("Scene(params: [1])", "params", "b", "2").is_err());
        assert!(set_entry("Scene(params: {", "params", "b", "2").is_err());
        assert!(set_field("", "camera", "1").is_err());
    }

    #[test]
    fn many_edits_keep_all_else() {
        let mut text = TALL.to_owned();
        for i in 0..50 {
            text = set_entry(&text, "params", &format!("p{}", i % 7), &i.to_string()).expect("an edit");
            text =
                set_field(&text, "camera", &camera(&Camera::new(DVec3::splat(f64::from(i) + 1.0), DVec3::ZERO, 40.0)))
                    .expect("an edit");
        }
        let lines: Vec<&str> = TALL.lines().collect();
        let kept = lines.iter().filter(|line| text.contains(line.trim_end_matches(" // last"))).count();
        assert_eq!(kept, lines.len(), "{text}");
        assert!(text.contains("\"p0\": 49,") && !text.contains("\"p0\": 42"), "{text}");
    }
}
