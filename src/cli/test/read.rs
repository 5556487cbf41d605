//! Files of cases from RON: what to draw, and what must come out.

use std::fmt;
use std::path::{Path, PathBuf};

use super::WORD;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources, Span};
use crate::files::{self, DiskFiles, Kind};
use crate::graph::rows;
use crate::host::{Job, When};
use crate::program::missing_file;
use crate::syntax::{self, Decoder, Fields, Node, Sp};

const CASE_FIELDS: &[&str] =
    &["about", "scene", "graph", "particles", "size", "frame", "time", "params", "stats", "picture", "tolerance"];
const BOUNDS: &[&str] = &["min", "max"];
/// How far a picture may be off in the mean where a case does not say: drivers round differently.
const TOLERANCE: f64 = 0.002;
/// Cases are drawn often, so that they are small.
const SIZE: [u32; 2] = [160, 120];
const LARGEST_SIDE: i64 = 32_768;

/// One file.
#[derive(Debug)]
pub struct Suite {
    pub path: PathBuf,
    pub cases: Vec<Case>,
}

/// Something to draw with what must come out.
#[derive(Debug)]
pub struct Case {
    pub name: Sp<String>,
    pub job: Job,
    pub stats: Vec<Bounds>,
    pub picture: Option<Expected>,
}

/// What a statistic must be.
#[derive(Debug)]
pub struct Bounds {
    pub name: Sp<String>,
    min: Option<f64>,
    max: Option<f64>,
    pub span: Span,
}

/// A picture that must come out.
#[derive(Debug)]
pub struct Expected {
    pub path: PathBuf,
    /// Mean difference, as a part of white.
    pub tolerance: f64,
    pub span: Span,
}

impl Bounds {
    pub fn holds(&self, value: f64) -> bool {
        // A NaN is within nothing.
        !value.is_nan() && self.min.is_none_or(|min| value >= min) && self.max.is_none_or(|max| value <= max)
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.min, self.max) {
            (Some(min), Some(max)) if min == max => write!(f, "{min}"),
            (Some(min), Some(max)) => write!(f, "from {min} to {max}"),
            (Some(min), None) => write!(f, "at least {min}"),
            (None, Some(max)) => write!(f, "at most {max}"),
            (None, None) => f.write_str("a number"),
        }
    }
}

/// Reads a file with all its mistakes.
pub fn suite(path: &Path, sources: &mut Sources, found: &mut Diagnostics) -> Option<Suite> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) => {
            let message = format!("cannot read `{}`: {error}", path.display());
            found.push(Diagnostic::error(Code::FILE_UNREADABLE, message));
            return None;
        }
    };
    let file = syntax::add_bytes(sources, path, &bytes).map_err(|error| found.push(error)).ok()?;
    let node = syntax::parse(sources, file, found)?;
    let mut d = Decoder { diagnostics: found };
    let tagged = node.as_tagged().filter(|tagged| tagged.name.as_ref().is_some_and(|name| name.value == WORD));
    let Some(tagged) = tagged else {
        d.wrong(&node, "a file of cases", "`Tests(cases: {\"name\": (...)})`");
        return None;
    };
    let fields = d.body_fields(tagged, "`Tests`", &["about", "cases"])?;
    if let Some(node) = fields.get("about") {
        d.text(node, "`about`");
    }
    let entries = fields.require(&mut d, "cases").and_then(|node| d.map(node, "`cases`"))?;
    let cases = entries.into_iter().filter_map(|(name, node)| case(&mut d, path, name, node)).collect();
    Some(Suite { path: path.to_owned(), cases })
}

fn case(d: &mut Decoder<'_>, file: &Path, name: Sp<String>, node: &Node) -> Option<Case> {
    let what = format!("the case `{}`", name.value);
    let fields = d.fields(node, &what, CASE_FIELDS)?;
    if let Some(node) = fields.get("about") {
        d.text(node, "`about`");
    }
    let source = fields.require(d, "scene").and_then(|node| scene(d, file, node));
    let job = Job {
        source: source.unwrap_or_default(),
        graph: text(d, &fields, "graph"),
        particles: text(d, &fields, "particles"),
        size: Some(fields.get("size").and_then(|node| size(d, node)).unwrap_or(SIZE)),
        when: when(d, &fields, &name),
        set: params(d, &fields),
        stats: fields.get("stats").is_some(),
        ..Job::default()
    };
    let stats = stats(d, &fields);
    let picture = picture(d, file, &fields);
    if fields.lacks(&["stats", "picture"]) {
        let diagnostic = Diagnostic::error(Code::MISSING_FIELD, format!("{what} expects nothing"))
            .at(name.span, "this case")
            .hint("say `stats: {\"name\": (min: ..., max: ...)}` or `picture: \"file.png\"`");
        d.push(diagnostic);
    }
    Some(Case { name, job, stats, picture })
}

/// A scene or another file that can be drawn, looked for as scenes are.
fn scene(d: &mut Decoder<'_>, file: &Path, node: &Node) -> Option<PathBuf> {
    let name = d.text(node, "`scene`")?;
    match files::find(&DiskFiles, Kind::Scene, &name.value, Some(file)) {
        Ok(found) => Some(found.path),
        Err(missing) => {
            d.push(missing_file(&name.value, Kind::Scene, &missing, Some(name.span)));
            None
        }
    }
}

fn text(d: &mut Decoder<'_>, fields: &Fields<'_>, name: &str) -> Option<String> {
    fields.get(name).and_then(|node| d.text(node, &format!("`{name}`"))).map(|text| text.value)
}

fn size(d: &mut Decoder<'_>, node: &Node) -> Option<[u32; 2]> {
    let items = d.items(node, "`size`", "(width, height) in pixels", 2..=2)?;
    let [width, height] = items else { return None };
    let side = |d: &mut Decoder<'_>, node| d.int_within(node, "`size`", 1, LARGEST_SIDE);
    let (width, height) = (side(d, width), side(d, height));
    Some([u32::try_from(width?).ok()?, u32::try_from(height?).ok()?])
}

fn when(d: &mut Decoder<'_>, fields: &Fields<'_>, case: &Sp<String>) -> When {
    let frame = fields.get("frame").and_then(|node| d.int_within(node, "`frame`", 0, i64::from(u32::MAX)));
    let time = fields.get("time").and_then(|node| Some((d.float(node, "`time`")?, node)));
    match (frame, time) {
        (Some(_), Some((_, node))) => {
            let message = format!("the case `{}` says `frame` and `time`", case.value);
            d.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.span, "one of them tells when"));
            When::Start
        }
        (_, Some((time, node))) if time < 0.0 => {
            d.wrong(node, "`time`", "seconds since the start, not below 0");
            When::Start
        }
        (_, Some((time, _))) => When::Time(time),
        (Some(frame), None) => When::Frame(frame.unsigned_abs()),
        (None, None) => When::Start,
    }
}

/// Parameters by instance path, as people type them.
fn params(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Vec<(String, String)> {
    let entries = fields.get("params").and_then(|node| d.map(node, "`params`")).unwrap_or_default();
    let mut given = Vec::new();
    for (name, node) in entries {
        if let Some(value) = rows::value(d, node, &format!("`{}` of `params`", name.value)) {
            given.push((name.value, value.to_string()));
        }
    }
    given
}

fn stats(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Vec<Bounds> {
    let entries = fields.get("stats").and_then(|node| d.map(node, "`stats`")).unwrap_or_default();
    entries.into_iter().filter_map(|(name, node)| bounds(d, name, node)).collect()
}

/// `(min: 0.5, max: 1.0)`, or a number that it must be.
fn bounds(d: &mut Decoder<'_>, name: Sp<String>, node: &Node) -> Option<Bounds> {
    let what = format!("`{}` of `stats`", name.value);
    if matches!(node.kind, syntax::Kind::Int(_) | syntax::Kind::Float(_)) {
        let exact = d.float(node, &what);
        return Some(Bounds { name, min: exact, max: exact, span: node.span });
    }
    let fields = d.fields(node, &what, BOUNDS)?;
    let [min, max] = ["min", "max"].map(|name| fields.get(name).and_then(|node| d.float(node, &what)));
    if let Some((min, max)) = min.zip(max).filter(|(min, max)| min > max) {
        let message = format!("{what}: no number is at least {min} and at most {max}");
        d.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.span, "`min` is above `max`"));
    }
    Some(Bounds { name, min, max, span: node.span })
}

fn picture(d: &mut Decoder<'_>, file: &Path, fields: &Fields<'_>) -> Option<Expected> {
    let tolerance = fields.get("tolerance").and_then(|node| Some((d.float(node, "`tolerance`")?, node)));
    if let Some((_, node)) = tolerance.filter(|(tolerance, _)| !(0.0..1.0).contains(tolerance)) {
        d.wrong(node, "`tolerance`", "a part of white, from 0 to below 1");
    }
    let name = fields.get("picture").and_then(|node| d.text(node, "`picture`"))?;
    if !name.value.to_ascii_lowercase().ends_with(".png") {
        let message = format!("`{}`: expected pictures are .png files", name.value);
        d.push(Diagnostic::error(Code::WRONG_VALUE, message).at(name.span, "this file"));
    }
    let path = file.parent().unwrap_or(Path::new("")).join(&name.value);
    Some(Expected { path, tolerance: tolerance.map_or(TOLERANCE, |(tolerance, _)| tolerance), span: name.span })
}
