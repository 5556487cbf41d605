//! A plan as a graph for Graphviz: passes are boxes, resources are rounded, parts are clusters.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::describe;
use super::rows::{self, Row, rows};
use crate::plan::model::{ObjectId, Origin, Plan};

/// The whole plan in the DOT language: `dot -Tsvg` draws it.
pub fn dot(plan: &Plan) -> String {
    let mut out = String::new();
    _ = writeln!(out, "digraph plan {{");
    _ = writeln!(out, "  label={}; labelloc=t; rankdir=LR; compound=true;", quoted(&plan.graph.display().to_string()));
    _ = writeln!(out, "  node [fontname=\"sans-serif\", fontsize=10]; edge [color=\"#667788\", arrowsize=0.6];");
    let rows = rows(plan);
    let used: BTreeSet<ObjectId> = objects(plan).collect();
    let mut parts = Part::default();
    for row in &rows {
        let path = &plan.passes[row.first].path;
        // What the planner made is called by its object: `shapes.ids (settle)`.
        let scope = path.split_once('/').map_or("", |(scope, _)| scope);
        parts.at(scope).lines.push(pass(plan, row));
    }
    for id in &used {
        let path = &plan.objects[*id].path;
        let is_input = plan.objects[*id].origin.input().is_some();
        let scope = if is_input { "" } else { path.rsplit_once('.').map_or("", |(scope, _)| scope) };
        parts.at(scope).lines.push(resource(plan, *id));
    }
    parts.write("", 1, &mut out);
    edges(plan, &rows, &mut out);
    out.push_str("}\n");
    out
}

/// Everything of one part, and of the parts in it.
#[derive(Default)]
struct Part {
    lines: Vec<String>,
    parts: BTreeMap<String, Part>,
}

impl Part {
    fn at(&mut self, scope: &str) -> &mut Part {
        scope
            .split('.')
            .filter(|name| !name.is_empty())
            .fold(self, |part, name| part.parts.entry(name.to_owned()).or_default())
    }

    fn write(&self, path: &str, depth: usize, out: &mut String) {
        let indent = "  ".repeat(depth);
        for line in &self.lines {
            _ = writeln!(out, "{indent}{line}");
        }
        for (name, part) in &self.parts {
            let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            _ = writeln!(out, "{indent}subgraph {} {{", quoted(&format!("cluster {path}")));
            _ = writeln!(out, "{indent}  label={}; color=\"#99aabb\"; style=rounded;", quoted(&path));
            part.write(&path, depth + 1, out);
            _ = writeln!(out, "{indent}}}");
        }
    }
}

fn pass(plan: &Plan, row: &Row) -> String {
    let path = rows::path(plan, row);
    let name = path.split_once('/').map_or(path.as_str(), |(_, name)| name);
    let label = quoted(&format!("{name}\n{}", rows::what(plan, row)));
    let unit = plan.passes[row.first].unit;
    format!("p{} [shape=box, style=filled, fillcolor=\"#dce8f4\", label={label}, tooltip=\"unit {unit}\"];", row.first)
}

fn resource(plan: &Plan, id: ObjectId) -> String {
    let object = &plan.objects[id];
    let is_output = plan.outputs.iter().any(|output| rows::id(plan, output.object) == id);
    let fill = match &object.origin {
        _ if is_output => "#f6d9a8",
        Origin::Frame => "#f4f4ee",
        Origin::State(_) => "#e6daf2",
        Origin::Input(_) | Origin::Attribute { .. } | Origin::Mesh { .. } => "#d9ecd9",
    };
    let name = object.path.rsplit('.').next().unwrap_or(&object.path);
    let name = if matches!(object.origin, Origin::Attribute { .. } | Origin::Mesh { .. }) {
        object.path.as_str()
    } else {
        name
    };
    let label = quoted(&format!("{name}\n{}", describe::object(object)));
    let edge = if is_output { ", penwidth=2" } else { "" };
    format!("r{id} [shape=box, style=\"rounded,filled\", fillcolor=\"{fill}\"{edge}, label={label}];")
}

fn objects(plan: &Plan) -> impl Iterator<Item = ObjectId> + '_ {
    plan.passes.iter().flat_map(|pass| &pass.accesses).map(|access| rows::id(plan, access.object))
}

fn edges(plan: &Plan, rows: &[Row], out: &mut String) {
    for row in rows {
        let mut seen = BTreeSet::new();
        for access in row.passes().flat_map(|p| &plan.passes[p].accesses) {
            let id = rows::id(plan, access.object);
            let (p, both) = (row.first, access.read && access.write);
            let line = match (both, access.write) {
                (true, _) => format!("  p{p} -> r{id} [dir=both];"),
                (_, true) => format!("  p{p} -> r{id};"),
                _ => format!("  r{id} -> p{p};"),
            };
            if seen.insert(line.clone()) {
                _ = writeln!(out, "{line}");
            }
        }
    }
}

/// A string of the DOT language.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}
