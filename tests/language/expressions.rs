//! Values of expressions, what stays live, and what is said about wrong ones.

use meniscus::diagnostic::{Code, Diagnostic, Diagnostics, Sources, Span, Style, render_all};
use meniscus::graph::eval::{self, Lookup, Scope};
use meniscus::graph::expr::{self, Expr, ExprKind, Function};
use meniscus::graph::value::Value;

use crate::golden;

/// Names of all sorts.
struct Names;

impl Scope for Names {
    fn name(&self, path: &str, span: Span) -> Result<Lookup, Diagnostic> {
        let value = match path {
            "grid" => Value::Int(64),
            "tiles" => Value::Int(5),
            "radius" | "particles.radius" => Value::Float(0.25),
            "streaming" => Value::Bool(true),
            "weights" => Value::Word("distance".into()),
            "map" => Value::ints([512, 100]),
            "particles.max" => Value::vec([1.0, 2.0, 4.0]),
            "viewport" => Value::ints([640, 480]),
            "time" | "camera.eye" => {
                return Ok(Lookup::Live(Expr { kind: ExprKind::Name(path.replace('.', "_")), span }));
            }
            _ => {
                return Err(
                    Diagnostic::error(Code::UNKNOWN_NAME, format!("nothing is called `{path}`")).at(span, "here")
                );
            }
        };
        Ok(Lookup::Value(value))
    }

    fn call_on_name(&self, function: Function, path: &str, span: Span) -> Result<Lookup, Diagnostic> {
        let value = match (function, path) {
            (Function::Size, "z") => Value::ints([320, 200]),
            (Function::Count, "sorted") => Value::Int(1000),
            (Function::Has, "color") => Value::Bool(false),
            _ => {
                return Err(
                    Diagnostic::error(Code::UNKNOWN_NAME, format!("nothing is called `{path}`")).at(span, "here")
                );
            }
        };
        Ok(Lookup::Value(value))
    }

    fn words(&self, path: &str) -> Option<Vec<String>> {
        (path == "weights").then(|| vec!["depth".into(), "distance".into()])
    }
}

fn parse(text: &str) -> Result<Expr, Diagnostic> {
    let mut sources = Sources::new();
    let file = sources.add("e", text);
    expr::parse(text, Span::new(file, 0, text.len()), true)
}

fn value(text: &str) -> Value {
    eval::eval(&parse(text).unwrap(), &Names).unwrap_or_else(|d| panic!("{text}: {}", d.message))
}

/// Values written as expressions of literals.
#[test]
fn expressions_have_the_values_of_the_rules() {
    let table = [
        ("1 + 2 * 3", "7"),
        ("(1 + 2) * 3", "9"),
        ("10 - 4 - 3", "3"),
        ("7 % 4 * 2", "6"),
        ("-2 + 5", "3"),
        ("- -2", "2"),
        ("1_000 + 0xff", "1255"),
        ("7 / 2", "3.5"),
        ("6 / 2", "3.0"),
        ("1e3 + .5", "1000.5"),
        ("grid + 0.5", "64.5"),
        ("ceil_div(grid, tiles)", "13"),
        ("ceil_div(65, 4)", "17"),
        ("ceil_div(-7, 2)", "-3"),
        ("ceil_div(1.5, 0.5)", "3"),
        ("ceil(grid / tiles)", "13"),
        ("floor(-0.5)", "-1"),
        ("round(2.5)", "3"),
        ("floor(7)", "7"),
        ("log2(8)", "3.0"),
        ("next_pow2(0)", "1"),
        ("next_pow2(1)", "1"),
        ("next_pow2(65)", "128"),
        ("mip_count(1)", "1"),
        ("mip_count(256)", "9"),
        ("mip_count(map)", "10"),
        ("min(3, 1.5, 2)", "1.5"),
        ("max(3, 1.5)", "3.0"),
        ("max(3, 2)", "3"),
        ("max(4)", "4"),
        ("max(map, 200)", "(512, 200)"),
        ("min((1, 5), (3, 2.0))", "(1.0, 2.0)"),
        ("(1, 2) + (3, 4)", "(4, 6)"),
        ("(1, 2) * 0.5", "(0.5, 1.0)"),
        ("2 * map", "(1024, 200)"),
        ("map / 4", "(128.0, 25.0)"),
        ("ceil(viewport * 0.3)", "(192, 144)"),
        ("-map", "(-512, -100)"),
        ("map.x", "512"),
        ("(map + 1).y", "101"),
        ("particles.max.z", "4.0"),
        ("particles.radius * 4", "1.0"),
        ("viewport.y", "480"),
        ("size(z)", "(320, 200)"),
        ("size(z).x / 2", "160.0"),
        ("count(sorted) + 1", "1001"),
        ("has(color)", "false"),
        ("not has(color)", "true"),
        ("streaming and grid > 10", "true"),
        ("not streaming or false", "false"),
        ("not grid == 10", "true"),
        ("1 == 1.0", "true"),
        ("1 != 2", "true"),
        ("2 <= 2", "true"),
        ("2 >= 3", "false"),
        ("1 < 2 and 2 < 3", "true"),
        ("true == false", "false"),
        ("weights == 'distance'", "true"),
        ("'depth' != weights", "true"),
        // The right side is not looked at where the left one decides.
        ("has(color) and nothing > 1", "false"),
        ("streaming or nothing", "true"),
    ];
    for (text, expected) in table {
        assert_eq!(value(text).to_string(), expected, "{text}");
    }
}

#[test]
fn what_is_live_stays_and_the_rest_is_folded() {
    let folded = eval::fold(&parse("time * (grid / 4) + camera.eye.y").unwrap(), &Names).unwrap();
    let mut names = Vec::new();
    folded.names(&mut |name, _| names.push(name.to_string()));
    assert_eq!(names, ["time", "camera_eye"]);
    let ExprKind::Binary(_, product, _) = &folded.kind else { panic!("{folded:?}") };
    let ExprKind::Binary(_, _, factor) = &product.kind else { panic!("{product:?}") };
    assert_eq!(factor.kind, ExprKind::Literal(Value::Float(16.0)));

    let live = |name: &str| match name {
        "time" => Some(Value::Float(2.0)),
        "camera_eye" => Some(Value::vec([1.0, 10.0, 100.0])),
        _ => None,
    };
    assert_eq!(eval::eval_live(&folded, &live), Some(Value::Float(42.0)));
    assert_eq!(eval::eval_live(&folded, &|_| None), None);
}

#[test]
fn live_conditions_short_cut_too() {
    let folded = eval::fold(&parse("time > 1 and camera.eye.x > 0").unwrap(), &Names).unwrap();
    let live = |name: &str| (name == "time").then_some(Value::Float(0.0));
    assert_eq!(eval::eval_live(&folded, &live), Some(Value::Bool(false)));
}

#[test]
fn a_constant_needs_nothing_live() {
    let scope_free = eval::fold(&parse("mip_count(256) - 1").unwrap(), &Names).unwrap();
    assert_eq!(scope_free.kind, ExprKind::Literal(Value::Int(8)));
}

#[test]
fn spans_are_exact_inside_strings_without_escapes() {
    let (_, diagnostics, sources) = crate::language::cases::read_text(
        r#"Graph(let: {"a": "1 +  * 2", "b": "\u{31} + * 2", "c": r"ünit + * 2"}, passes: [], outputs: [])"#,
    );
    let spans: Vec<&str> = diagnostics.iter().map(|d| sources.snippet(d.labels[0].span)).collect();
    assert_eq!(spans, ["*", r"\u{31} + * 2", "ü"]);
}

/// Each line of `expressions/wrong.txt` is an expression; what is said about it, as it is read or
/// as it is evaluated, is in `expressions/wrong.golden`.
#[test]
fn wrong_expressions_are_told_as_the_golden_says() {
    let text = std::fs::read_to_string(golden::root().join("tests/language/expressions/wrong.txt")).unwrap();
    let mut out = String::new();
    for line in text.lines().filter(|line| !line.is_empty()) {
        let mut sources = Sources::new();
        let file = sources.add("expression", line);
        let read = expr::parse(line, Span::new(file, 0, line.len()), true);
        let diagnostic = match read.and_then(|e| eval::eval(&e, &Names)) {
            Ok(value) => panic!("`{line}` is fine: {value}"),
            Err(diagnostic) => diagnostic,
        };
        out += &render_all(&Diagnostics::from(diagnostic), &sources, Style::Plain);
        out += "\n";
    }
    golden::golden("tests/language/expressions/wrong.golden", &out);
}

#[test]
fn places_that_need_a_kind_say_so() {
    let text = "0.5 true 'a' 3";
    let mut sources = Sources::new();
    let file = sources.add("expression", text);
    let at = |from, to| Span::new(file, from, to);
    let mut diagnostics = Diagnostics::new();
    let word = Value::Word("a".into());
    diagnostics.push(eval::whole(&Value::Float(0.5), at(0, 3), "`size` of `z`").unwrap_err());
    diagnostics.push(eval::whole(&Value::Bool(true), at(4, 8), "`items` of `z`").unwrap_err());
    diagnostics.push(eval::truth(&Value::Int(3), at(13, 14), "`test` of `If`").unwrap_err());
    diagnostics.push(eval::number(&word, at(9, 12), "`rate` of `Steps`").unwrap_err());
    golden::golden("tests/language/expressions/kinds.golden", &render_all(&diagnostics, &sources, Style::Plain));
    assert_eq!(eval::whole(&Value::Int(3), at(13, 14), "x").unwrap(), 3);
    assert!(eval::truth(&Value::Bool(true), at(4, 8), "x").unwrap());
    assert_eq!(eval::number(&Value::Int(3), at(13, 14), "x").unwrap(), 3.0);
}
