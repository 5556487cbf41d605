//! What naga would overflow the stack on. It limits how deep brackets nest, but follows chains,
//! such as a sum of very many terms, by recursion without a limit.

use super::declare::Declarations;
use super::scan::{Kind, Token};

/// Tokens in a row that may each be a level: all between two separators, together with those in
/// front of the brackets around them. naga takes about 2,000 levels on a stack of 1 MiB.
const EXPRESSION: usize = 1_000;
/// `else if` in a row; about 700 on 1 MiB.
const BRANCHES: usize = 300;
/// `struct`, of which each may hold the next; about 850 on 1 MiB.
const STRUCTS: usize = 400;
/// Declarations, of which each may need the next; about 3,000 on 1 MiB.
const DECLARATIONS: usize = 1_500;

/// The token at which a text goes beyond what naga can take, and why.
pub(super) fn beyond(text: &str, tokens: &[Token]) -> Option<(Token, &'static str)> {
    let mut depth = Depth::default();
    let mut branches = 0;
    for (at, token) in tokens.iter().enumerate() {
        if depth.take(token) > EXPRESSION {
            return Some((*token, "this expression has more than 1,000 words and signs in a row"));
        }
        match token.text(text) {
            "else" if tokens.get(at + 1).is_some_and(|next| next.text(text) == "if") => branches += 1,
            "fn" => branches = 0,
            _ => {}
        }
        if branches > BRANCHES {
            return Some((*token, "this function has more than 300 `else if`"));
        }
    }
    None
}

/// Why a module has more declarations than naga can take.
pub(super) fn too_many(declarations: &Declarations) -> Option<&'static str> {
    if declarations.structs.len() > STRUCTS {
        return Some("this file and its imports have more than 400 structs");
    }
    (declarations.names().count() > DECLARATIONS)
        .then_some("this file and its imports have more than 1,500 declarations")
}

/// The opening bracket at which brackets nest deepest, and how deep.
pub(super) fn deepest(tokens: &[Token]) -> Option<(Token, i32)> {
    let (mut depth, mut deepest) = (0_i32, None);
    for token in tokens {
        match token.kind {
            Kind::Mark(b'(' | b'[' | b'{') => {
                depth += 1;
                if deepest.is_none_or(|(_, most)| depth > most) {
                    deepest = Some((*token, depth));
                }
            }
            Kind::Mark(b')' | b']' | b'}') => depth -= 1,
            _ => {}
        }
    }
    deepest
}

/// Counts tokens since the last separator, on all levels of brackets.
#[derive(Default)]
struct Depth {
    outer: Vec<usize>,
    here: usize,
    total: usize,
}

impl Depth {
    fn take(&mut self, token: &Token) -> usize {
        match token.kind {
            Kind::Mark(b'(' | b'[') => {
                self.outer.push(self.here + 1);
                (self.here, self.total) = (0, self.total + 1);
            }
            Kind::Mark(b')' | b']') => {
                self.total -= self.here;
                self.here = self.outer.pop().unwrap_or(0);
            }
            Kind::Mark(b',') => (self.here, self.total) = (0, self.total - self.here),
            Kind::Mark(b';' | b'{' | b'}') => *self = Self::default(),
            _ => (self.here, self.total) = (self.here + 1, self.total + 1),
        }
        self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::FileId;
    use crate::shader::scan::scan;

    fn found(text: &str) -> Option<&'static str> {
        beyond(text, &scan(text).tokens).map(|(_, why)| why)
    }

    #[test]
    fn long_lists_are_no_depth() {
        assert_eq!(found(&format!("const a = array<f32, 5000>({});", "1.0, ".repeat(5000))), None);
        assert_eq!(found(&format!("fn f() {{ {} }}", "x = x + 1.0;".repeat(5000))), None);
        assert_eq!(found(&format!("fn f() {{ {} }}", "f(g(1)[2]);".repeat(5000))), None);
    }

    #[test]
    fn chains_are_depth() {
        let expression = Some("this expression has more than 1,000 words and signs in a row");
        assert_eq!(found(&format!("const a = 1{};", " + 1.5".repeat(600))), expression);
        assert_eq!(found(&format!("const a = {}1;", "-".repeat(1200))), expression);
        assert_eq!(found(&format!("const a = 1{};", " + f(1, 2)".repeat(600))), expression);
        assert_eq!(found(&format!("const a = {}1{};", "f(1, x + ".repeat(400), ")".repeat(400))), expression);
        assert!(found(&format!("fn f() {{ if a {{}} {} }}", "else if b {}".repeat(400))).is_some());
    }

    #[test]
    fn declarations_are_counted() {
        let why = |text: &str| {
            let mut declarations = Declarations::default();
            declarations.add(FileId(0), text, &scan(text));
            too_many(&declarations)
        };
        let many = |count, what: &str| (0..count).map(|n| what.replace('#', &n.to_string())).collect::<String>();
        assert_eq!(why(&many(400, "struct A# { b: f32 }")), None);
        assert!(why(&many(401, "struct A# { b: f32 }")).is_some());
        assert_eq!(why(&many(1500, "const a# = 1;")), None);
        assert!(why(&many(1501, "fn a#() {}")).is_some());
    }

    #[test]
    fn unpaired_brackets_do_no_harm() {
        for text in [")))", "(((", ")(,;", "(,)],)", "a)b,c(d]"] {
            found(text);
        }
    }

    #[test]
    fn the_deepest_bracket_is_found() {
        assert_eq!(deepest(&scan("(a)[(b)](c)").tokens).map(|(t, depth)| (t.start, depth)), Some((4, 2)));
    }
}
