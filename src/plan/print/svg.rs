//! A plan as a picture: passes are columns in program order, memory is rows. A bar is a
//! resource's life in its memory, with a ring where a pass reads it and a dot where one writes;
//! several bars in one row share memory.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::describe;
use super::rows::{self, Row, rows};
use crate::plan::memory;
use crate::plan::model::{ObjectId, Origin, Plan, Policy};

const COLUMN: usize = 18;
const ROW: usize = 20;
const MARGIN: usize = 16;
/// Characters of the names of resources that share a row.
const LONGEST_LABEL: usize = 48;
/// Pixels that the legend takes.
const LEGEND: usize = 720;
/// About the width of a character at the size that the text has.
const LETTER: f64 = 6.1;

/// One row of the picture: objects in the same memory.
struct Lane {
    objects: Vec<ObjectId>,
    bytes: u64,
}

struct Layout {
    rows: Vec<Row>,
    /// The column of each pass.
    column: Vec<usize>,
    lanes: Vec<Lane>,
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// The whole plan as a self-contained SVG file.
pub fn svg(plan: &Plan) -> String {
    let layout = Layout::new(plan);
    let mut out = String::new();
    let (w, h) = (layout.width, layout.height);
    _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" font-family="sans-serif" font-size="11">"#
    );
    _ = writeln!(out, r##"<rect width="{w}" height="{h}" fill="#ffffff"/>"##);
    title(plan, &mut out);
    columns(plan, &layout, &mut out);
    for (l, lane) in layout.lanes.iter().enumerate() {
        self::lane(plan, &layout, l, lane, &mut out);
    }
    legend(&layout, &mut out);
    out.push_str("</svg>\n");
    out
}

impl Layout {
    fn new(plan: &Plan) -> Self {
        let rows = rows(plan);
        let mut column = vec![0; plan.passes.len()];
        for (c, row) in rows.iter().enumerate() {
            row.passes().for_each(|p| column[p] = c);
        }
        let lanes = lanes(plan);
        let longest = |texts: &mut dyn Iterator<Item = usize>| texts.max().unwrap_or(0) as f64 * LETTER;
        let left = longest(&mut lanes.iter().map(|lane| label(plan, lane).chars().count())) as usize + 2 * MARGIN;
        let names = longest(&mut rows.iter().map(|row| rows::path(plan, row).chars().count()));
        // Names of passes lean at 60 degrees.
        let top = (names * 0.87) as usize + 4 * MARGIN;
        let lean = (names * 0.5) as usize;
        let width = (left + rows.len() * COLUMN + lean + MARGIN)
            .max(longest(&mut [summary(plan).len()].into_iter()) as usize + 2 * MARGIN)
            .max(LEGEND);
        let height = top + lanes.len() * ROW + 4 * MARGIN;
        Self { rows, column, lanes, left, top, width, height }
    }

    fn x(&self, column: usize) -> usize {
        self.left + column * COLUMN
    }

    fn y(&self, lane: usize) -> usize {
        self.top + lane * ROW
    }
}

/// Inputs, then state, then the frame's memory under the keeping policy, by first use.
fn lanes(plan: &Plan) -> Vec<Lane> {
    let single = |id: ObjectId| Lane { objects: vec![id], bytes: memory::bytes(&plan.objects[id].kind) };
    let outside = (0..plan.objects.len())
        .filter(|id| plan.objects[*id].lifetime.is_some() && plan.objects[*id].origin != Origin::Frame)
        .map(single);
    let mut frame: Vec<Lane> = plan
        .memory
        .slots(plan.memory.policy)
        .iter()
        .map(|slot| Lane { objects: slot.objects.clone(), bytes: slot.bytes })
        .collect();
    frame.sort_by_key(|lane| lane.objects.first().map(|id| (plan.objects[*id].lifetime, *id)));
    outside.chain(frame).collect()
}

fn label(plan: &Plan, lane: &Lane) -> String {
    let size = describe::bytes(lane.bytes);
    match lane.objects.as_slice() {
        [one] => format!("{}  {size}", plan.objects[*one].path),
        several => {
            let names: Vec<&str> = several.iter().map(|id| plan.objects[*id].path.as_str()).collect();
            format!("{}  {size}", shortened(&names))
        }
    }
}

/// As many names as there is room for, and how many more.
fn shortened(names: &[&str]) -> String {
    let mut text = names.first().copied().unwrap_or_default().to_owned();
    for (i, name) in names.iter().enumerate().skip(1) {
        if text.len() + name.len() > LONGEST_LABEL {
            return format!("{text} and {} more", names.len() - i);
        }
        text.push_str(" | ");
        text.push_str(name);
    }
    text
}

fn title(plan: &Plan, out: &mut String) {
    let [w, h] = plan.viewport;
    let name = escaped(&plan.graph.display().to_string());
    _ = writeln!(out, r#"<text x="{MARGIN}" y="24" font-size="15" font-weight="bold">{name} at {w} x {h}</text>"#);
    let line = summary(plan);
    _ = writeln!(out, r##"<text x="{MARGIN}" y="42" fill="#556">{line}</text>"##);
}

fn summary(plan: &Plan) -> String {
    let memory = &plan.memory;
    format!(
        "{} passes in {} units; memory: {} keeping what skipping needs, {} at the smallest, {} without sharing",
        plan.passes.len(),
        plan.units.len(),
        describe::bytes(memory.of_frame(Policy::Keep)),
        describe::bytes(memory.of_frame(Policy::Smallest)),
        describe::bytes(memory.unshared),
    )
}

/// Columns shaded by unit, with the passes' names above and the units' below.
fn columns(plan: &Plan, layout: &Layout, out: &mut String) {
    let bottom = layout.y(layout.lanes.len());
    let mut last = None;
    for (c, row) in layout.rows.iter().enumerate() {
        let unit = plan.passes[row.first].unit;
        let (x, y) = (layout.x(c), layout.top);
        let shade = if unit.is_multiple_of(2) { "#f3f6fa" } else { "#e6ecf3" };
        let height = bottom - y;
        _ = writeln!(out, r#"<rect x="{x}" y="{y}" width="{COLUMN}" height="{height}" fill="{shade}"/>"#);
        let (tx, ty) = (x + COLUMN / 2 + 3, y - 5);
        let name = escaped(&rows::path(plan, row));
        let what = escaped(&rows::what(plan, row));
        let times = if row.times > 1 { format!(" x{}", row.times) } else { String::new() };
        let stepped = if plan.passes[row.first].steps.is_some() { r##" fill="#7040a0""## } else { "" };
        _ = writeln!(
            out,
            r#"<text transform="translate({tx},{ty}) rotate(-60)"{stepped}>{name}{times}<title>{what}</title></text>"#
        );
        if last != Some(unit) {
            let ty = bottom + 12;
            _ = writeln!(out, r##"<text x="{x}" y="{ty}" font-size="8" fill="#778">u{unit}</text>"##);
        }
        last = Some(unit);
    }
}

fn lane(plan: &Plan, layout: &Layout, l: usize, lane: &Lane, out: &mut String) {
    let (y, right) = (layout.y(l), layout.left - 8);
    let text = escaped(&label(plan, lane));
    let weight = if lane.objects.len() > 1 { r#" font-style="italic""# } else { "" };
    let ty = y + 14;
    _ = writeln!(out, r#"<text x="{right}" y="{ty}" text-anchor="end"{weight}>{text}</text>"#);
    let end = layout.x(layout.rows.len());
    _ = writeln!(out, r##"<path d="M{} {}H{end}" stroke="#d4dbe4"/>"##, layout.left, y + ROW);
    for id in &lane.objects {
        bar(plan, layout, y, *id, lane.objects.len() > 1, out);
    }
}

fn bar(plan: &Plan, layout: &Layout, y: usize, id: ObjectId, shares: bool, out: &mut String) {
    let object = &plan.objects[id];
    let Some((first, last)) = object.lifetime else { return };
    // A loop's column stands for all its iterations, so a use may lie in front of the first.
    let uses = uses(plan, layout, id);
    let from = uses.keys().next().copied().unwrap_or(layout.column[first]);
    let to = uses.keys().next_back().copied().unwrap_or(from).max(layout.column[last]);
    let is_output = plan.outputs.iter().any(|output| rows::id(plan, output.object) == id);
    let fill = match &object.origin {
        _ if is_output => "#f2b134",
        Origin::State(_) => "#b48fd6",
        Origin::Input(_) | Origin::Attribute { .. } | Origin::Mesh { .. } => "#9ccf9c",
        Origin::Frame if shares => "#6fb7c9",
        Origin::Frame => "#a9bdd3",
    };
    let (x, width) = (layout.x(from) + 1, (to - from + 1) * COLUMN - 2);
    let about = escaped(&format!("{}: {}, passes {first} to {last}", object.path, describe::object(object)));
    _ = writeln!(
        out,
        r#"<rect x="{x}" y="{}" width="{width}" height="{}" rx="4" fill="{fill}"><title>{about}</title></rect>"#,
        y + 3,
        ROW - 6
    );
    for (column, (read, write)) in uses {
        let (cx, cy) = (layout.x(column) + COLUMN / 2, y + ROW / 2);
        mark(cx, cy, read, write, out);
    }
}

/// A ring for reading, a dot for writing, a dot in a ring for both.
fn mark(cx: usize, cy: usize, read: bool, write: bool, out: &mut String) {
    let (inner, radius) = if write { ("#1b2a38", 4) } else { ("none", 3) };
    let ring = if read && write { r##"stroke="#ffffff" stroke-width="1.5""## } else { r##"stroke="#1b2a38""## };
    _ = writeln!(out, r#"<circle cx="{cx}" cy="{cy}" r="{radius}" fill="{inner}" {ring}/>"#);
}

/// In which columns an object is read and written.
fn uses(plan: &Plan, layout: &Layout, id: ObjectId) -> BTreeMap<usize, (bool, bool)> {
    let mut uses: BTreeMap<usize, (bool, bool)> = BTreeMap::new();
    for (p, pass) in plan.passes.iter().enumerate() {
        for access in pass.accesses.iter().filter(|a| rows::id(plan, a.object) == id) {
            let at = uses.entry(layout.column[p]).or_default();
            *at = (at.0 || access.read, at.1 || access.write);
        }
    }
    uses
}

fn legend(layout: &Layout, out: &mut String) {
    let y = layout.y(layout.lanes.len()) + 2 * MARGIN;
    let mut x = MARGIN;
    for (fill, text) in [
        ("#9ccf9c", "input"),
        ("#b48fd6", "state"),
        ("#a9bdd3", "memory of its own"),
        ("#6fb7c9", "shared memory"),
        ("#f2b134", "output"),
    ] {
        _ = writeln!(out, r#"<rect x="{x}" y="{}" width="22" height="12" rx="4" fill="{fill}"/>"#, y - 10);
        _ = writeln!(out, r#"<text x="{}" y="{y}">{text}</text>"#, x + 28);
        x += 28 + (text.len() as f64 * LETTER) as usize + 24;
    }
    for (read, write, text) in [(false, true, "written"), (true, false, "read"), (true, true, "both")] {
        _ = writeln!(out, r##"<rect x="{x}" y="{}" width="14" height="14" rx="4" fill="#a9bdd3"/>"##, y - 11);
        mark(x + 7, y - 4, read, write, out);
        _ = writeln!(out, r#"<text x="{}" y="{y}">{text}</text>"#, x + 19);
        x += 19 + (text.len() as f64 * LETTER) as usize + 16;
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
