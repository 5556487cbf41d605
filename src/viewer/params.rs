//! Parameters as the window shows them: by part, with what a person changed on top of what the
//! files say.

use std::collections::BTreeMap;

use crate::graph::value::Value;
use crate::host::params::{Raw, value_for};
use crate::host::{Content, params};
use crate::plan::model::{Param, Plan};

/// Paths of the presenting graph's parameters begin so.
pub const PRESENT: &str = "present.";

/// Values that a person set in the window, by path.
pub type Overrides = BTreeMap<String, Value>;

/// Parameters of one part.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The instance path of the part; empty: the graph's own.
    pub part: String,
    pub params: Vec<Shown>,
}

/// A parameter with the path that people give it by.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    pub path: String,
    /// The last word of the path.
    pub name: String,
    pub param: Param,
}

/// The parameters of a graph and of the one that presents it, by part: the graph's own first, those
/// of presenting last, each part as the plan has them.
pub fn groups(plan: &Plan, present: Option<&Plan>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let own = plan.params.iter().map(|p| (p.path.clone(), p));
    let shared = present.iter().flat_map(|p| &p.params).map(|p| (format!("{PRESENT}{}", p.path), p));
    for (path, param) in own.chain(shared) {
        let (part, name) = path.rsplit_once('.').unwrap_or(("", &path));
        let shown = Shown { name: name.to_owned(), param: param.clone(), path: path.clone() };
        match groups.iter_mut().find(|g| g.part == part) {
            Some(group) => group.params.push(shown),
            None => groups.push(Group { part: part.to_owned(), params: vec![shown] }),
        }
    }
    groups.sort_by_key(|g| (!g.part.is_empty(), g.part.starts_with("present")));
    groups
}

/// Puts what a person set on top of the content's values. What the graph no longer declares, or
/// declares otherwise, is left out, and comes back when the graph does.
pub fn apply(content: &mut Content, overrides: &Overrides) {
    for (path, value) in overrides {
        let (program, values, path) = match path.strip_prefix(PRESENT) {
            Some(path) => (&content.present, &mut content.present_params, path),
            None => (&content.program, &mut content.params, path.as_str()),
        };
        let declared = params::declared(program);
        let fitting = declared.get(path).and_then(|param| value_for(&Raw::Value(value.clone()), param).ok());
        if let Some(value) = fitting {
            values.insert(path.to_owned(), value);
        }
    }
}

/// Lets go of what the files say as well by now.
pub fn settle(overrides: &mut Overrides, content: &Content) {
    overrides.retain(|path, value| {
        let said = match path.strip_prefix(PRESENT) {
            Some(path) => content.present_params.get(path),
            None => content.params.get(path),
        };
        said != Some(value)
    });
}
