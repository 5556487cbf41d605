//! The stand-in scene, and the variants of it that are checked.

use super::Way;
use super::device::Device;
use crate::graph::model::{InputDefault, InputKind, ParamKind};
use crate::graph::rows::Row;
use crate::graph::value::Value;
use crate::plan::Findings;
use crate::plan::model::{InputInfo, Param, Request};
use crate::program::Program;

/// A scene that has everything that the graph asks for, also what is optional.
pub(super) fn base(program: &Program, device: &Device) -> Request {
    let mut request = Request {
        viewport: [640, 480],
        params: Default::default(),
        inputs: Default::default(),
        capacities: Default::default(),
        roots: Vec::new(),
        stats: false,
        memory: Default::default(),
        features: device.features,
        limits: device.limits.clone(),
    };
    for input in &program.root.inputs {
        if let Some(info) = stand_in(program, &input.kind, input.default.as_ref()) {
            request.inputs.insert(input.name.value.clone(), info);
        }
    }
    request
}

fn stand_in(program: &Program, kind: &InputKind, default: Option<&InputDefault>) -> Option<InputInfo> {
    match kind {
        InputKind::Camera => Some(InputInfo::Camera),
        InputKind::Light => Some(InputInfo::Light),
        InputKind::Pointer => Some(InputInfo::Pointer),
        InputKind::Particles { .. } => Some(InputInfo::Particles {
            count: 4096,
            radius: 0.025,
            min: [-0.4, 0.0, -0.4],
            max: [0.4, 0.8, 0.4],
            // How many numbers an attribute has is not known here: 0 fits all.
            attributes: attributes(program, true).into_iter().map(|name| (name, 0)).collect(),
        }),
        InputKind::Texture { dimension } => {
            Some(InputInfo::Texture(crate::plan::stand_in_texture(dimension.as_ref().map(|d| d.value))))
        }
        InputKind::Meshes { .. } => Some(InputInfo::Meshes(crate::plan::meshes::stand_in())),
        InputKind::Buffer | InputKind::Counted => Some(InputInfo::Buffer { items: 1000, stride: 4 }),
        InputKind::Table => Some(InputInfo::Table {
            rows: match default {
                Some(InputDefault::Table(rows)) => rows.clone(),
                _ => vec![Row::default(); 4],
            },
        }),
    }
}

/// Attributes that any graph of the program asks for.
fn attributes(program: &Program, optional_too: bool) -> Vec<String> {
    let mut names = Vec::new();
    for input in program.graphs().flat_map(|g| &g.inputs) {
        if let InputKind::Particles { attributes } = &input.kind {
            names.extend(attributes.iter().filter(|a| optional_too || !a.optional).map(|a| a.name.value.clone()));
        }
    }
    names.sort();
    names.dedup();
    names
}

/// Something otherwise than in the base.
pub(super) struct Variant {
    /// Words that say what.
    pub said: String,
    pub request: Request,
    /// If several things are otherwise at once: each of them by itself. Nothing is wrong with any
    /// of them if nothing is with all together.
    pub each: Vec<Variant>,
}

impl Variant {
    fn new(said: impl Into<String>, request: Request) -> Self {
        Self { said: said.into(), request, each: Vec::new() }
    }

    fn param(base: &Request, param: &Param, value: Value) -> Self {
        let mut request = base.clone();
        let said = format!("`{}` = {value}", param.path);
        request.params.insert(param.path.clone(), value);
        Self::new(said, request)
    }
}

/// One thing at a time otherwise. `at_base` is what was found there: whether a parameter's value fits
/// where a uniform holds it was seen there, so that only parameters on which more hangs are tried.
pub(super) fn others(program: &Program, base: &Request, at_base: &Findings, way: Way) -> Vec<Variant> {
    let mut all = Vec::new();
    let mut in_arithmetic = Vec::new();
    for param in &at_base.params {
        if way == Way::Long || at_base.structural.contains(&param.path) {
            all.extend(other_values(param).into_iter().map(|value| Variant::param(base, param, value)));
        } else if at_base.arithmetic.contains(&param.path) {
            in_arithmetic.push(param);
        }
    }
    all.extend(together(base, &in_arithmetic));
    for input in program.root.inputs.iter().filter(|i| i.optional) {
        let mut request = base.clone();
        request.inputs.remove(&input.name.value);
        all.push(Variant::new(format!("`{}` absent", input.name.value), request));
    }
    let needed = attributes(program, false);
    if needed.len() < attributes(program, true).len() {
        let mut request = base.clone();
        for info in request.inputs.values_mut() {
            if let InputInfo::Particles { attributes, .. } = info {
                attributes.retain(|(name, _)| needed.contains(name));
            }
        }
        all.push(Variant::new("no optional attribute", request));
    }
    let mut empty = base.clone();
    for info in empty.inputs.values_mut() {
        if let InputInfo::Particles { count, .. } = info {
            *count = 0;
        }
    }
    if empty.inputs != base.inputs {
        all.push(Variant::new("zero particles", empty));
    }
    let mut small = base.clone();
    small.viewport = [1, 1];
    all.push(Variant::new("a viewport of 1 x 1", small));
    all
}

/// Parameters that decide no structure, all at their first other value, all at their second.
fn together(base: &Request, params: &[&Param]) -> Vec<Variant> {
    let values: Vec<Vec<Value>> = params.iter().map(|param| other_values(param)).collect();
    let most = values.iter().map(Vec::len).max().unwrap_or(0);
    let round = |i: usize| {
        let mut all = Variant::new("several parameters at their ends", base.clone());
        for (param, values) in params.iter().zip(&values) {
            if let Some(value) = values.get(i) {
                all.request.params.insert(param.path.clone(), value.clone());
                all.each.push(Variant::param(base, param, value.clone()));
            }
        }
        all
    };
    (0..most).map(round).collect()
}

/// Minimum, maximum, and the other words of a choice.
fn other_values(param: &Param) -> Vec<Value> {
    let mut values = match &param.kind {
        ParamKind::Bool => vec![Value::Bool(false), Value::Bool(true)],
        ParamKind::Choice(words) => words.iter().map(|w| Value::Word(w.value.clone())).collect(),
        _ => param
            .min
            .iter()
            .chain(&param.max)
            .map(|bound| match (&param.value, bound.as_f64()) {
                (Value::Vector(v), Some(x)) => Value::vec(vec![x; v.len()]),
                _ => bound.clone(),
            })
            .collect(),
    };
    values.retain(|value| *value != param.value);
    values
}
