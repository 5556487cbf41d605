//! Values that people give to parameters, checked against what graphs declare.

use std::collections::BTreeMap;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::graph::model::{Graph, NodeKind, Param, ParamKind};
use crate::graph::value::Value;
use crate::program::{Program, each_node};

/// A value for a parameter as somebody gave it.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Instance path, such as `shapes.stretch`.
    pub path: String,
    pub raw: Raw,
    /// Where a scene says it; absent for the command line.
    pub span: Option<Span>,
    /// A scene says it for its own graph, in whose place another is used.
    pub of_another_graph: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Raw {
    /// Typed on the command line.
    Text(String),
    Value(Value),
}

/// Every parameter that users of a program may set, by instance path: those of the graph, and
/// those of its parts that no `Use` gives a value.
pub fn declared(program: &Program) -> BTreeMap<String, &Param> {
    let mut found = BTreeMap::new();
    collect(program, &program.root, "", &[], &mut found);
    found
}

fn collect<'p>(
    program: &'p Program,
    graph: &'p Graph,
    prefix: &str,
    given: &[&str],
    found: &mut BTreeMap<String, &'p Param>,
) {
    for param in graph.params.iter().filter(|p| !given.contains(&p.name.value.as_str())) {
        found.insert(format!("{prefix}{}", param.name.value), param);
    }
    let mut parts = Vec::new();
    each_node(&graph.passes, &mut |node| {
        if let NodeKind::Use(used) = &node.kind {
            parts.push(used);
        }
    });
    for used in parts {
        if let Some(part) = program.part(graph, &used.graph.value) {
            let given: Vec<&str> = used.params.iter().map(|(name, _)| name.value.as_str()).collect();
            collect(program, part, &format!("{prefix}{}.", used.name.value), &given, found);
        }
    }
}

/// The values by instance path; later ones win over earlier ones.
pub fn resolve(given: &[Given], program: &Program, diagnostics: &mut Diagnostics) -> BTreeMap<String, Value> {
    let declared = declared(program);
    let mut values = BTreeMap::new();
    for given in given {
        let Some(param) = declared.get(&given.path) else {
            let unknown = unknown(given, program, declared.keys().map(String::as_str));
            diagnostics.push(if given.of_another_graph { left_out(unknown) } else { unknown });
            continue;
        };
        match value_for(&given.raw, param) {
            Ok(value) => _ = values.insert(given.path.clone(), value),
            Err(why) => {
                let unfit = unfit(given, param, &why);
                diagnostics.push(if given.of_another_graph { left_out(unfit) } else { unfit });
            }
        }
    }
    values
}

/// What a scene says for its own graph does not bind one that is used in its place.
fn left_out(error: Diagnostic) -> Diagnostic {
    let message = format!("{}: the scene's value is left out", error.message);
    let warning = Diagnostic::warning(error.id, message);
    Diagnostic { labels: error.labels, ..warning }
        .hint("the scene says it for its own graph, and `--graph` names another")
}

fn unknown<'a>(given: &Given, program: &Program, known: impl Iterator<Item = &'a str> + Clone) -> Diagnostic {
    let message = format!("there is no parameter `{}` in `{}`", given.path, program.root.path.display());
    let error = Diagnostic::error(code(given, Code::UNKNOWN_NAME), message);
    let error = match given.span {
        Some(span) => error.at(span, "unknown parameter"),
        None => error,
    };
    // The last word alone may be right while the path before it is forgotten.
    let same_end = known.clone().find(|path| path.rsplit('.').next() == Some(&given.path));
    match same_end {
        Some(path) => error.hint(format!("did you mean `{path}`?")),
        None => error.nearest(&given.path, known),
    }
}

fn unfit(given: &Given, param: &Param, why: &str) -> Diagnostic {
    let error = Diagnostic::error(code(given, Code::BAD_PARAMETER), format!("parameter `{}`: {why}", given.path));
    let error = match given.span {
        Some(span) => error.at(span, "given here"),
        None => error,
    };
    error.see(param.span, "declared here")
}

/// What is wrong on the command line is wrong usage.
fn code(given: &Given, in_scene: Code) -> Code {
    if given.span.is_some() { in_scene } else { Code::USAGE }
}

/// The value as the parameter's kind wants it.
///
/// # Errors
/// If it does not fit; the text gives what was expected and found.
pub fn value_for(raw: &Raw, param: &Param) -> Result<Value, String> {
    let value = match raw {
        Raw::Text(text) => parse(text, &param.kind)?,
        Raw::Value(value) => convert(value, &param.kind)?,
    };
    within(&value, param)?;
    Ok(value)
}

fn parse(text: &str, kind: &ParamKind) -> Result<Value, String> {
    let expected = |what: &str| format!("expected {what}, found `{text}`");
    match kind {
        ParamKind::Int => text.parse().map(Value::Int).map_err(|_| expected("a whole number")),
        ParamKind::Float => finite(text).map(Value::Float).ok_or_else(|| expected("a finite number")),
        ParamKind::Bool => text.parse().map(Value::Bool).map_err(|_| expected("`true` or `false`")),
        ParamKind::Choice(_) => convert(&Value::Word(text.to_owned()), kind),
        ParamKind::Vec2 | ParamKind::Vec3 | ParamKind::Vec4 | ParamKind::Color => {
            let inner = text.strip_prefix('(').and_then(|t| t.strip_suffix(')')).unwrap_or(text);
            let numbers: Option<Vec<f64>> = inner.split(',').map(|word| finite(word.trim())).collect();
            let numbers = numbers.ok_or_else(|| expected(&numbers_of(kind)))?;
            convert(&Value::vec(numbers), kind)
        }
    }
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

fn numbers_of(kind: &ParamKind) -> String {
    let (low, high) = components(kind);
    if low == high {
        format!("{low} numbers with commas between")
    } else {
        format!("{low} or {high} numbers with commas between")
    }
}

fn components(kind: &ParamKind) -> (usize, usize) {
    match kind {
        ParamKind::Vec2 => (2, 2),
        ParamKind::Vec3 => (3, 3),
        ParamKind::Vec4 => (4, 4),
        ParamKind::Color => (3, 4),
        _ => (1, 1),
    }
}

fn convert(value: &Value, kind: &ParamKind) -> Result<Value, String> {
    let wrong = || format!("expected a value for {}, found `{value}` ({})", kind.name(), value.kind());
    match (kind, value) {
        (ParamKind::Int, Value::Int(_)) | (ParamKind::Bool, Value::Bool(_)) => Ok(value.clone()),
        (ParamKind::Float, Value::Int(_) | Value::Float(_)) => value.as_f64().map(Value::Float).ok_or_else(wrong),
        (ParamKind::Choice(words), Value::Word(word)) => {
            let words: Vec<&str> = words.iter().map(|w| w.value.as_str()).collect();
            if words.contains(&word.as_str()) {
                return Ok(value.clone());
            }
            let list: Vec<String> = words.iter().map(|w| format!("`{w}`")).collect();
            let near = crate::diagnostic::nearest(word, words.iter().copied());
            let near = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
            Err(format!("expected one of {}, found `{word}`{near}", list.join(", ")))
        }
        (_, Value::Vector(v)) => {
            let (low, high) = components(kind);
            let numbers: Option<Vec<f64>> = v.iter().map(|part| part.as_f64()).collect();
            if low == 1 || !(low..=high).contains(&v.len()) {
                return Err(wrong());
            }
            numbers.map(Value::vec).ok_or_else(wrong)
        }
        _ => Err(wrong()),
    }
}

fn within(value: &Value, param: &Param) -> Result<(), String> {
    let bound = |bound: &Option<crate::graph::model::Sp<Value>>, index: usize| {
        let bound = &bound.as_ref()?.value;
        let mut components = bound.components();
        let place = if components.len() == 1 { 0 } else { index };
        components.nth(place)?.as_f64()
    };
    for (index, number) in value.components().enumerate() {
        let Some(number) = number.as_f64() else { continue };
        if let Some(min) = bound(&param.min, index).filter(|min| number < *min) {
            return Err(format!("{value} is below the least value, {min}"));
        }
        if let Some(max) = bound(&param.max, index).filter(|max| number > *max) {
            return Err(format!("{value} is above the greatest value, {max}"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::FileId;
    use crate::graph::model::Sp;

    fn param(kind: ParamKind, min: Option<Value>, max: Option<Value>) -> Param {
        let span = Span::new(FileId(0), 0, 0);
        let at = |value| Sp { value, span };
        Param {
            name: Sp { value: "p".to_owned(), span },
            kind,
            default: None,
            min: min.map(at),
            max: max.map(at),
            unit: None,
            about: None,
            span,
        }
    }

    fn text(text: &str, param: &Param) -> Result<Value, String> {
        value_for(&Raw::Text(text.into()), param)
    }

    #[test]
    fn words_become_values_of_the_declared_kind() {
        let int = param(ParamKind::Int, Some(Value::Int(0)), Some(Value::Int(9)));
        assert_eq!(text("5", &int), Ok(Value::Int(5)));
        assert_eq!(text("5.5", &int), Err("expected a whole number, found `5.5`".into()));
        assert_eq!(text("10", &int), Err("10 is above the greatest value, 9".into()));
        assert_eq!(text("-1", &int), Err("-1 is below the least value, 0".into()));
        let float = param(ParamKind::Float, None, None);
        assert_eq!(text("5", &float), Ok(Value::Float(5.0)));
        assert!(text("nan", &float).is_err() && text("inf", &float).is_err());
        assert_eq!(text("true", &param(ParamKind::Bool, None, None)), Ok(Value::Bool(true)));
        let vector = param(ParamKind::Vec3, None, None);
        assert_eq!(text("1, -2,3", &vector), Ok(Value::vec([1.0, -2.0, 3.0])));
        assert_eq!(text("(1,2,3)", &vector), Ok(Value::vec([1.0, 2.0, 3.0])));
        assert!(text("1,2", &vector).is_err());
        assert!(text("1,2,3,4", &param(ParamKind::Color, None, None)).is_ok());
    }

    #[test]
    fn a_misspelt_choice_gets_its_nearest() {
        let span = Span::new(FileId(0), 0, 0);
        let words = ["depth", "distance"].map(|w| Sp { value: w.to_owned(), span }).to_vec();
        let choice = param(ParamKind::Choice(words), None, None);
        assert_eq!(text("depth", &choice), Ok(Value::Word("depth".into())));
        let error = "expected one of `depth`, `distance`, found `dept`; did you mean `depth`?";
        assert_eq!(text("dept", &choice), Err(error.into()));
    }

    #[test]
    fn a_scenes_values_keep_their_kind() {
        let float = param(ParamKind::Float, None, Some(Value::Float(1.0)));
        assert_eq!(value_for(&Raw::Value(Value::Int(1)), &float), Ok(Value::Float(1.0)));
        assert!(value_for(&Raw::Value(Value::Bool(true)), &float).is_err());
        let int = param(ParamKind::Int, None, None);
        assert!(value_for(&Raw::Value(Value::Float(1.0)), &int).is_err());
        let color = param(ParamKind::Color, Some(Value::Float(0.0)), None);
        assert!(value_for(&Raw::Value(Value::vec([0.1, 0.2, -0.3])), &color).is_err());
    }
}
