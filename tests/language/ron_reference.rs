//! The `ron` crate is the reference for what RON means: the same texts are accepted, with the
//! same values.

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::syntax::{self, Body, Kind, Node};
use proptest::prelude::*;

use crate::language::cases::graphs;

/// A value without what the two trees differ in by design: words of tags and kinds of numbers.
#[derive(Clone, Debug, PartialEq)]
enum Plain {
    Unit,
    Bool(bool),
    Char(char),
    Int(i64),
    /// Bits, so that NaN equals itself.
    Float(u64),
    Str(String),
    Seq(Vec<Plain>),
    Map(Vec<(Plain, Plain)>),
    Some(Box<Plain>),
    Other,
}

fn float(x: f64) -> Plain {
    Plain::Float(if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() })
}

fn sorted(mut pairs: Vec<(Plain, Plain)>) -> Plain {
    pairs.sort_by_key(|pair| format!("{pair:?}"));
    Plain::Map(pairs)
}

fn ours(node: &Node) -> Plain {
    match &node.kind {
        Kind::Bool(b) => Plain::Bool(*b),
        Kind::Int(i) => Plain::Int(*i),
        Kind::Float(x) => float(*x),
        Kind::Str(s) => Plain::Str(s.value.clone()),
        Kind::Char(c) => Plain::Char(*c),
        Kind::List(items) => Plain::Seq(items.iter().map(ours).collect()),
        Kind::Map(pairs) => sorted(pairs.iter().map(|(k, v)| (ours(k), ours(v))).collect()),
        Kind::Invalid => Plain::Other,
        Kind::Tagged(tagged) => match (tagged.name.as_ref().map(|n| n.value.as_str()), &tagged.body) {
            (Some("Some"), Body::Items(items)) if items.len() == 1 => Plain::Some(Box::new(ours(&items[0]))),
            (_, Body::Unit) => Plain::Unit,
            // `ron` tells `()` from `( )`, which means nothing.
            (_, Body::Items(items)) if items.is_empty() => Plain::Unit,
            (_, Body::Items(items)) => Plain::Seq(items.iter().map(ours).collect()),
            (_, Body::Fields(fields)) => {
                sorted(fields.iter().map(|(k, v)| (Plain::Str(k.value.clone()), ours(v))).collect())
            }
        },
    }
}

fn theirs(value: &ron::Value) -> Plain {
    match value {
        ron::Value::Unit | ron::Value::Option(None) => Plain::Unit,
        ron::Value::Option(Some(inner)) => Plain::Some(Box::new(theirs(inner))),
        ron::Value::Bool(b) => Plain::Bool(*b),
        ron::Value::Char(c) => Plain::Char(*c),
        ron::Value::String(s) => Plain::Str(s.clone()),
        ron::Value::Seq(items) if items.is_empty() => Plain::Seq(vec![]),
        ron::Value::Seq(items) => Plain::Seq(items.iter().map(theirs).collect()),
        ron::Value::Map(map) => sorted(map.iter().map(|(k, v)| (theirs(k), theirs(v))).collect()),
        ron::Value::Number(ron::Number::F32(x)) => float(f64::from(x.get())),
        ron::Value::Number(ron::Number::F64(x)) => float(x.get()),
        ron::Value::Number(number) => match i128_of(number) {
            Some(i) => i64::try_from(i).map_or(Plain::Other, Plain::Int),
            None => Plain::Other,
        },
        ron::Value::Bytes(_) => Plain::Other,
    }
}

fn i128_of(number: &ron::Number) -> Option<i128> {
    Some(match number {
        ron::Number::I8(x) => i128::from(*x),
        ron::Number::I16(x) => i128::from(*x),
        ron::Number::I32(x) => i128::from(*x),
        ron::Number::I64(x) => i128::from(*x),
        ron::Number::U8(x) => i128::from(*x),
        ron::Number::U16(x) => i128::from(*x),
        ron::Number::U32(x) => i128::from(*x),
        ron::Number::U64(x) => i128::from(*x),
        _ => return None,
    })
}

/// `()` of any kind: `ron` makes an empty sequence of `Word()` and `( )`, and a list of `[]`.
fn same(a: &Plain, b: &Plain) -> bool {
    match (a, b) {
        (Plain::Unit, Plain::Seq(items)) | (Plain::Seq(items), Plain::Unit) => items.is_empty(),
        (Plain::Seq(x), Plain::Seq(y)) => x.len() == y.len() && x.iter().zip(y).all(|(x, y)| same(x, y)),
        (Plain::Map(x), Plain::Map(y)) => {
            x.len() == y.len() && x.iter().zip(y).all(|(x, y)| same(&x.0, &y.0) && same(&x.1, &y.1))
        }
        (Plain::Some(x), Plain::Some(y)) => same(x, y),
        _ => a == b,
    }
}

fn read(text: &str) -> Result<Plain, String> {
    let mut sources = Sources::new();
    let file = sources.add("text", text);
    let mut diagnostics = Diagnostics::new();
    let node = syntax::parse(&sources, file, &mut diagnostics);
    match node {
        Some(node) if diagnostics.is_empty() => Ok(ours(&node)),
        _ => Err(render_all(&diagnostics, &sources, Style::Plain)),
    }
}

/// Both accept with one value, or both refuse.
#[track_caller]
fn agree(text: &str) {
    match (read(text), text.parse::<ron::Value>()) {
        (Ok(a), Ok(b)) => assert!(same(&a, &theirs(&b)), "{text}\nours: {a:?}\ntheirs: {:?}", theirs(&b)),
        (Ok(a), Err(error)) => panic!("ron refuses {text:?}: {error}\nours: {a:?}"),
        (Err(said), Ok(b)) => panic!("only ron accepts {text:?} as {b:?}\n{said}"),
        (Err(_), Err(_)) => {}
    }
}

#[test]
fn the_same_literals_mean_the_same() {
    let texts = [
        "0",
        "-0",
        "+5",
        "12",
        "-12",
        "1_000",
        "1_",
        "1__0",
        "_1",
        "-_1",
        "--5",
        "+-5",
        "-",
        "+",
        "0x1F",
        "-0xff",
        "0xfg",
        "0x",
        "0b101",
        "0b12",
        "0o17",
        "0o8",
        "9223372036854775807",
        "-9223372036854775808",
        "1.0",
        "-1.5",
        "1.",
        ".5",
        "-.5",
        ".",
        "1e5",
        "1E5",
        "1e+5",
        "1e-5",
        "1.5e-3",
        "1.e5",
        ".e5",
        "1e",
        "1e5_",
        "1e_5",
        "1_0.5",
        "1._5",
        "1.5.2",
        "1-2",
        "1 2",
        "inf",
        "-inf",
        "+inf",
        "NaN",
        "-NaN",
        "nan",
        "1.0e308",
        "0.1",
        "16777217.0",
        "1abc",
        "true",
        "false",
        "True",
        "true()",
        "()",
        "( )",
        "(,)",
        "(1)",
        "(1,)",
        "(1, 2)",
        "(1,,2)",
        "[]",
        "[,]",
        "[1]",
        "[1,]",
        "[1, 2]",
        "[1 2]",
        "[1; 2]",
        "{}",
        "{1: 2}",
        "{1: 2,}",
        "{1 2}",
        "{1}",
        "{\"a\": 1, 'b': [2]}",
        "{A: 1}",
        "{(1, 2): 3}",
        "A",
        "A()",
        "A(1)",
        "A (1)",
        "A(a: 1)",
        "A(a: 1,)",
        "A(a: 1, b: B(c: []))",
        "(a: 1)",
        "(a:1,b:2)",
        "(a: 1, 2)",
        "(1, a: 2)",
        "(a)",
        "(a, b)",
        "(a, b: 1)",
        "(\"a\": 1)",
        "A(a = 1)",
        "A(a 1)",
        "A[1]",
        "A{}",
        "Some(1)",
        "None",
        "Some(Some(\"x\"))",
        "\"\"",
        "\"a\"",
        "\"a\\n\\r\\t\\0\\\\\\\"\\'\"",
        "\"\\x41\"",
        "\"\\xC3\\xA9\"",
        "\"\\xC3\"",
        "\"\\u{41}\"",
        "\"\\u{1F600}\"",
        "\"\\u{}\"",
        "\"\\u{D800}\"",
        "\"\\u{1234567}\"",
        "\"\\u41\"",
        "\"\\q\"",
        "\"a\\\n   b\"",
        "\"a\\\r\n b\"",
        "\"a\nb\"",
        "\"ünï\"",
        "\"a",
        "r\"a\\n\"",
        "r#\"a\"b\"#",
        "r##\"a\"#b\"##",
        "r\"a",
        "r#\"a\"",
        "'a'",
        "'\\n'",
        "'\\''",
        "'''",
        "''",
        "'ab'",
        "'ü'",
        "'\\u{41}'",
        "'\\x41'",
        "'\\xC3'",
        "'",
        "// c\n1",
        "1 // c",
        "1 // c\n",
        "/* c */ 1",
        "/* /* c */ */ 1",
        "/* /* c */ 1",
        "/*/ 1",
        "1 /* c",
        "/",
        "1 /",
        "# 1",
        "#![enable(implicit_some)] 1",
        "#![enable(implicit_some,)] 1",
        "#![enable(unwrap_newtypes, implicit_some)] (a: 1)",
        "#![enable()] 1",
        "#![enable(nothing)] 1",
        "#![enable(implicit_some) 1",
        "#![type = \"a\"] 1",
        "#![schema = \"a\"] 1",
        "#![other] 1",
        "# ! [ enable ( implicit_some ) ] 1",
        "",
        " ",
        "\t\n\r\x0b\x0c 1\u{85}\u{200e}\u{2028}",
        "1)",
        "(1",
        "(1]",
        "[(1])",
        "]",
        "a-b",
        "a.b",
        "(a.b: 1)",
        "(a-b: 1)",
        "r(1)",
        "r",
        "b",
        "br(1)",
        "(r: 1, b: 2)",
        "(true: 1)",
        "(inf: 1)",
        "\"a\" \"b\"",
        ":",
        ",",
        "@",
        "(a: )",
        "(a: , b: 1)",
    ];
    for text in texts {
        agree(text);
    }
}

/// What we refuse and `ron` accepts is this, on purpose.
#[test]
fn what_is_left_out_is_refused_with_a_reason() {
    let texts = [
        ("b\"a\"", "byte strings"),
        ("br\"a\"", "byte strings"),
        ("b'a'", "byte strings"),
        ("1..2", "ranges"),
        ("1u8", "suffix"),
        ("1.5f32", "suffix"),
        ("9223372036854775808", "64 bits"),
        ("1e999", "too large"),
        ("(ä: 1)", "`ä`"),
        ("(r#a: 1)", "`#`"),
        ("(a: 1, a: 2)", "given twice"),
        ("{\"a\": 1, \"a\": 2}", "given twice"),
    ];
    for (text, reason) in texts {
        assert!(text.parse::<ron::Value>().is_ok(), "ron refuses {text}");
        let said = read(text).unwrap_err();
        assert!(said.contains(reason), "{text}: {said}");
    }
    // Depth: ours is below theirs.
    let deep = |n: usize| format!("{}{}", "[".repeat(n), "]".repeat(n));
    agree(&deep(syntax::MAX_DEPTH));
    assert!(read(&deep(syntax::MAX_DEPTH + 1)).unwrap_err().contains("nested"));
    // A byte order mark is told apart from other rubbish.
    assert!(read("\u{feff}1").unwrap_err().contains("byte order mark"));
}

#[test]
fn valid_graphs_and_their_mutations_agree() {
    for path in graphs("valid") {
        let text = std::fs::read_to_string(&path).unwrap();
        agree(&text);
        // A deterministic walk over mutations that stay text.
        for (i, c) in text.char_indices().step_by(7) {
            let replacement = ["", "(", ")", "\"", ",", "a", "5", ".", "/", "\n"][i % 10];
            let mutated = format!("{}{replacement}{}", &text[..i], &text[i + c.len_utf8()..]);
            if let Ok(plain) = read(&mutated) {
                let reference = mutated.parse::<ron::Value>();
                assert!(reference.as_ref().is_ok_and(|v| same(&plain, &theirs(v))), "{reference:?}\n{mutated}");
            }
        }
    }
}

/// RON texts by construction.
fn texts() -> impl Strategy<Value = String> {
    let space = prop::sample::select(vec!["", " ", "\n  ", " /* c */ ", " // c\n"]);
    let word = "[A-Z][a-z_0-9]{0,4}";
    let leaf = prop_oneof![
        any::<i64>().prop_map(|i| i.to_string()),
        any::<f64>().prop_filter("finite", |x| x.is_finite()).prop_map(|x| format!("{x:?}")),
        any::<bool>().prop_map(|b| b.to_string()),
        any::<String>().prop_map(|s| format!("{s:?}").replace("\\u{feff}", "x")),
        "[ -~]{0,12}".prop_map(|s| format!("r##\"{}\"##", s.replace("\"##", ""))),
        any::<char>().prop_map(|c| format!("{c:?}")),
        word.prop_map(|w| w),
    ];
    leaf.prop_recursive(5, 60, 6, move |inner| {
        let gap = space.clone();
        let list = prop::collection::vec((inner.clone(), gap.clone()), 0..6).prop_map(|items| {
            items.iter().map(|(item, gap)| format!("{gap}{item}{gap}")).collect::<Vec<_>>().join(",")
        });
        let fields = prop::collection::btree_map("[a-z_]{1,6}", (inner.clone(), gap), 1..5).prop_map(|fields| {
            fields
                .iter()
                .map(|(name, (value, gap))| format!("{gap}{name}{gap}:{gap}{value}"))
                .collect::<Vec<_>>()
                .join(",")
        });
        let pairs = prop::collection::btree_map("[ -~&&[^\"\\\\]]{0,6}", inner, 0..5)
            .prop_map(|pairs| pairs.iter().map(|(k, v)| format!("\"{k}\": {v}")).collect::<Vec<_>>().join(", "));
        prop_oneof![
            list.clone().prop_map(|l| format!("[{l}]")),
            (word, list).prop_map(|(w, l)| format!("{w}({l})")),
            (word, fields.clone()).prop_map(|(w, f)| format!("{w}({f},)")),
            fields.prop_map(|f| format!("({f})")),
            pairs.prop_map(|p| format!("{{{p}}}")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn generated_texts_agree(text in texts()) {
        prop_assert!(read(&text).is_ok(), "{}", read(&text).unwrap_err());
        agree(&text);
    }
}
