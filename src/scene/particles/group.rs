//! Columns of single numbers that belong together: `x`, `y`, `z` are a position; `velocity_x`,
//! `velocity_y`, `velocity_z` a velocity.

/// Columns that make one attribute, by their index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Group {
    pub name: String,
    pub columns: Vec<usize>,
}

/// Names of columns that stand for an attribute of another name.
const WHOLE: &[(&str, &[&str])] = &[
    ("position", &["x", "y", "z"]),
    ("normal", &["nx", "ny", "nz"]),
    ("velocity", &["vx", "vy", "vz"]),
    ("color", &["red", "green", "blue", "alpha"]),
    ("color", &["red", "green", "blue"]),
    ("color", &["r", "g", "b", "a"]),
    ("color", &["r", "g", "b"]),
];

/// Base names that mean the position, in the order in which they are looked for.
const POSITION: &[&str] = &["position", "positions", "points", "point", "pos", "p", "coordinates"];

/// How the columns of one attribute are told apart: what goes before and after the component.
const MARKS: &[(&str, &str)] = &[("_", ""), (":", ""), (".", ""), ("[", "]"), (" (", ")"), ("(", ")"), (" ", "")];

/// The sets of words for the components.
const COMPONENTS: &[&[&str]] = &[&["x", "y", "z", "w"], &["r", "g", "b", "a"], &["0", "1", "2", "3"]];

/// The attributes that columns of these names make, in the order of their first columns. The
/// position, if there is one, is named `position`.
pub(super) fn group(names: &[String]) -> Vec<Group> {
    let mut taken = vec![false; names.len()];
    let mut groups = Vec::new();
    for (name, columns) in WHOLE {
        if groups.iter().any(|g: &Group| g.name == *name) {
            continue;
        }
        if let Some(columns) = find_all(names, &taken, columns) {
            add(&mut groups, &mut taken, (*name).to_owned(), columns);
        }
    }
    for index in 0..names.len() {
        if taken[index] {
            continue;
        }
        let (name, columns) = suffixed(names, &taken, index).unwrap_or_else(|| (names[index].clone(), vec![index]));
        add(&mut groups, &mut taken, name, columns);
    }
    name_position(&mut groups);
    groups.sort_by_key(|g| g.columns.iter().min().copied());
    groups
}

fn add(groups: &mut Vec<Group>, taken: &mut [bool], name: String, columns: Vec<usize>) {
    for &column in &columns {
        taken[column] = true;
    }
    groups.push(Group { name, columns });
}

fn find_all(names: &[String], taken: &[bool], wanted: &[&str]) -> Option<Vec<usize>> {
    wanted.iter().map(|w| find(names, taken, w)).collect()
}

fn find(names: &[String], taken: &[bool], wanted: &str) -> Option<usize> {
    (0..names.len()).find(|&i| !taken[i] && names[i].trim().eq_ignore_ascii_case(wanted))
}

/// The attribute of which the column `first` is the first component, if a second is there.
fn suffixed(names: &[String], taken: &[bool], first: usize) -> Option<(String, Vec<usize>)> {
    for (before, after) in MARKS {
        for components in COMPONENTS {
            let Some(base) = base_of(&names[first], before, components[0], after) else { continue };
            let columns: Vec<usize> =
                components.iter().map_while(|c| find(names, taken, &format!("{base}{before}{c}{after}"))).collect();
            if columns.len() > 1 {
                return Some((base.to_owned(), columns));
            }
        }
    }
    None
}

fn base_of<'a>(name: &'a str, before: &str, component: &str, after: &str) -> Option<&'a str> {
    let name = name.trim().strip_suffix(after)?;
    let at = name.len().checked_sub(component.len())?;
    let (base, last) = (name.get(..at)?, name.get(at..)?);
    let base = base.strip_suffix(before)?;
    (last.eq_ignore_ascii_case(component) && !base.is_empty()).then_some(base)
}

/// Whether an attribute of this name is the position.
pub(super) fn means_position(name: &str) -> bool {
    POSITION.iter().any(|known| name.eq_ignore_ascii_case(known))
}

fn name_position(groups: &mut [Group]) {
    if groups.iter().any(|g| g.name == "position" && g.columns.len() == 3) {
        return;
    }
    for wanted in POSITION {
        let named = |g: &&mut Group| g.columns.len() == 3 && g.name.eq_ignore_ascii_case(wanted);
        if let Some(group) = groups.iter_mut().find(named) {
            "position".clone_into(&mut group.name);
            return;
        }
    }
}
