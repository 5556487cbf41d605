//! Nodes into typed values. Every mismatch becomes a diagnostic and `None`, so that a reader
//! collects all of them by going on; what the parser reported already stays silent.
//!
//! `what` names the place in messages: "`mips`", "`size` of `color`".

use super::{Body, Kind, Node, Sp, Str, Tagged};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span, nearest};

/// How many findings of one file are kept.
const MAX_FINDINGS: usize = 300;

/// Collects what is wrong while nodes are turned into values.
#[derive(Debug)]
pub struct Decoder<'d> {
    pub diagnostics: &'d mut Diagnostics,
}

/// The named fields of a bracket, checked against the known ones.
#[derive(Clone, Debug)]
pub struct Fields<'n> {
    /// What messages call the owner, such as `Compute`.
    pub owner: String,
    /// The word and the opening bracket.
    pub head: Span,
    entries: Vec<(&'n Sp<String>, &'n Node)>,
    /// Known fields that were probably meant by unknown ones.
    misspelt: Vec<String>,
    /// Nothing in the bracket was unreadable.
    is_whole: bool,
}

impl<'n> Fields<'n> {
    /// The value of a field, if it is given.
    pub fn get(&self, name: &str) -> Option<&'n Node> {
        self.entry(name).map(|(_, node)| node)
    }

    /// The field with the place of its name.
    pub fn entry(&self, name: &str) -> Option<(&'n Sp<String>, &'n Node)> {
        self.entries.iter().find(|(n, _)| n.value == name).copied()
    }

    /// Whether none of the fields is given, nor anything that was probably meant as one of them.
    pub fn lacks(&self, names: &[&str]) -> bool {
        self.is_whole && names.iter().all(|name| self.get(name).is_none() && !self.misspelt.iter().any(|m| m == name))
    }

    /// The value of a field that must be given.
    pub fn require(&self, decoder: &mut Decoder<'_>, name: &str) -> Option<&'n Node> {
        let found = self.get(name);
        if self.lacks(&[name]) {
            decoder.push(
                Diagnostic::error(Code::MISSING_FIELD, format!("{} lacks the field `{name}`", self.owner))
                    .at(self.head, format!("`{name}` is missing here")),
            );
        }
        found
    }
}

impl Decoder<'_> {
    /// Keeps a finding, up to a number that nobody reads.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.0.len() < MAX_FINDINGS {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Reports that `node` is not what is expected at `what`.
    pub fn wrong(&mut self, node: &Node, what: &str, expected: &str) {
        if !node.is_invalid() {
            let message = format!("{what}: expected {expected}, found {}", node.describe());
            self.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.head(), format!("expected {expected}")));
        }
    }

    /// The fields of `(...)` or `Word(...)`; a bare word or an empty bracket has none. Unknown
    /// fields are reported and left out. `owner` is what messages say, with its backquotes.
    pub fn fields<'n>(&mut self, node: &'n Node, owner: &str, known: &[&str]) -> Option<Fields<'n>> {
        let Some(tagged) = node.as_tagged() else {
            self.wrong(node, owner, "named fields in brackets");
            return None;
        };
        self.body_fields(tagged, owner, known)
    }

    /// As [`Decoder::fields`], of a bracket whose word was looked at already.
    pub fn body_fields<'n>(&mut self, tagged: &'n Tagged, owner: &str, known: &[&str]) -> Option<Fields<'n>> {
        let mut fields = Fields {
            owner: owner.into(),
            head: tagged.head,
            entries: Vec::new(),
            misspelt: Vec::new(),
            is_whole: tagged.is_whole,
        };
        match &tagged.body {
            Body::Unit => {}
            Body::Items(_) if !tagged.is_whole => return None,
            Body::Items(items) => {
                if let Some(first) = items.iter().find(|item| !item.is_invalid()) {
                    self.push(
                        Diagnostic::error(
                            Code::WRONG_VALUE,
                            format!("{owner}: expected named fields, found {}", first.describe()),
                        )
                        .at(first.head(), "this has no name")
                        .hint(format!("the fields of {owner} are {}", list(known))),
                    );
                    return None;
                }
            }
            Body::Fields(given) => {
                for (name, value) in given {
                    if known.contains(&name.value.as_str()) {
                        fields.entries.push((name, value));
                    } else {
                        self.unknown_field(name, owner, known);
                        fields.misspelt.extend(nearest(&name.value, known.iter().copied()).map(String::from));
                    }
                }
            }
        }
        Some(fields)
    }

    pub fn unknown_field(&mut self, name: &Sp<String>, owner: &str, known: &[&str]) {
        let message = format!("{owner} has no field `{}`", name.value);
        let diagnostic = Diagnostic::error(Code::UNKNOWN_FIELD, message)
            .at(name.span, "unknown field")
            .nearest(&name.value, known.iter().copied())
            .hint(match known {
                [] => format!("{owner} has no fields"),
                _ => format!("the fields of {owner} are {}", list(known)),
            });
        self.push(diagnostic);
    }

    /// Reports a word that is none of the choices.
    pub fn unknown_word(&mut self, word: &Sp<String>, what: &str, known: &[&str]) {
        let diagnostic =
            Diagnostic::error(Code::UNKNOWN_VARIANT, format!("{what}: `{}` is not one of the choices", word.value))
                .at(word.span, "unknown word")
                .nearest(&word.value, known.iter().copied())
                .hint(format!("the choices are {}", list(known)));
        self.push(diagnostic);
    }

    /// A bare word out of a table.
    pub fn choice<T: Copy>(&mut self, node: &Node, what: &str, table: &[(&str, T)]) -> Option<T> {
        let names: Vec<&str> = table.iter().map(|(name, _)| *name).collect();
        if let Some(text) = node.as_str()
            && names.contains(&text.value.as_str())
        {
            let message = format!("{what}: expected a word, found a string");
            let diagnostic = Diagnostic::error(Code::WRONG_VALUE, message)
                .at(node.span, "expected a word")
                .hint(format!("leave out the quotes: {}", text.value));
            self.push(diagnostic);
            return None;
        }
        let Some(word) = node.as_word() else {
            self.wrong(node, what, &format!("one of {}", list(&names)));
            return None;
        };
        let found = table.iter().find(|(name, _)| *name == word.value).map(|(_, value)| *value);
        if found.is_none() {
            self.unknown_word(word, what, &names);
        }
        found
    }

    pub fn bool(&mut self, node: &Node, what: &str) -> Option<bool> {
        match node.kind {
            Kind::Bool(b) => Some(b),
            _ => {
                self.wrong(node, what, "`true` or `false`");
                None
            }
        }
    }

    pub fn int(&mut self, node: &Node, what: &str) -> Option<i64> {
        match node.kind {
            Kind::Int(i) => Some(i),
            _ => {
                self.wrong(node, what, "a whole number");
                None
            }
        }
    }

    /// A whole number from `low` to `high`.
    pub fn int_within(&mut self, node: &Node, what: &str, low: i64, high: i64) -> Option<i64> {
        let value = self.int(node, what)?;
        if (low..=high).contains(&value) {
            return Some(value);
        }
        let expected = format!("a whole number from {low} to {high}");
        self.wrong(node, what, &expected);
        None
    }

    /// A finite number, whole or not.
    pub fn float(&mut self, node: &Node, what: &str) -> Option<f64> {
        match node.kind {
            Kind::Int(i) => Some(i as f64),
            Kind::Float(x) if x.is_finite() => Some(x),
            Kind::Float(_) => {
                self.wrong(node, what, "a finite number");
                None
            }
            _ => {
                self.wrong(node, what, "a number");
                None
            }
        }
    }

    /// A tuple of `N` finite numbers.
    pub fn floats<const N: usize>(&mut self, node: &Node, what: &str) -> Option<[f64; N]> {
        let items = self.items(node, what, &format!("a tuple of {N} numbers"), N..=N)?;
        let mut out = [0.0; N];
        let mut good = true;
        for (slot, item) in out.iter_mut().zip(items) {
            match self.float(item, what) {
                Some(x) => *slot = x,
                None => good = false,
            }
        }
        good.then_some(out)
    }

    /// A string with its whole place, quotes included.
    pub fn string<'n>(&mut self, node: &'n Node, what: &str) -> Option<&'n Str> {
        let found = node.as_str();
        if found.is_none() {
            self.want_string(node, what);
        }
        found
    }

    /// A string's value and the place between its quotes.
    pub fn text(&mut self, node: &Node, what: &str) -> Option<Sp<String>> {
        self.string(node, what).map(|s| Sp { value: s.value.clone(), span: s.inner })
    }

    fn want_string(&mut self, node: &Node, what: &str) {
        match node.as_word() {
            Some(word) => {
                let message = format!("{what}: expected a string, found {}", node.describe());
                let diagnostic = Diagnostic::error(Code::WRONG_VALUE, message)
                    .at(node.span, "expected a string")
                    .hint(format!("put it in quotes: \"{}\"", word.value));
                self.push(diagnostic);
            }
            None => self.wrong(node, what, "a string"),
        }
    }

    pub fn list<'n>(&mut self, node: &'n Node, what: &str) -> Option<&'n [Node]> {
        match &node.kind {
            Kind::List(items) => Some(items),
            _ => {
                self.wrong(node, what, "a list in square brackets");
                None
            }
        }
    }

    /// The unnamed values of `(a, b)`, a count of them within `count`.
    pub fn items<'n>(
        &mut self,
        node: &'n Node,
        what: &str,
        expected: &str,
        count: std::ops::RangeInclusive<usize>,
    ) -> Option<&'n [Node]> {
        match &node.kind {
            Kind::Tagged(Tagged { name: None, body: Body::Items(items), .. }) if count.contains(&items.len()) => {
                Some(items)
            }
            Kind::Tagged(Tagged { name: None, body: Body::Items(items), .. }) => {
                let message = format!("{what}: expected {expected}, found {} values", items.len());
                self.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.span, format!("expected {expected}")));
                None
            }
            _ => {
                self.wrong(node, what, expected);
                None
            }
        }
    }

    /// The one unnamed value of `Word(value)`.
    pub fn single<'n>(&mut self, tagged: &'n Tagged, what: &str, expected: &str) -> Option<&'n Node> {
        match &tagged.body {
            Body::Items(items) if items.len() == 1 => items.first(),
            _ => {
                let message = format!("{what}: expected {expected} in the brackets");
                self.push(
                    Diagnostic::error(Code::WRONG_VALUE, message).at(tagged.head, format!("expected {expected}")),
                );
                None
            }
        }
    }

    /// A map whose keys are strings: keys with the place between their quotes, and values.
    pub fn map<'n>(&mut self, node: &'n Node, what: &str) -> Option<Vec<(Sp<String>, &'n Node)>> {
        let Kind::Map(pairs) = &node.kind else {
            self.wrong(node, what, "a map in braces");
            return None;
        };
        let mut out = Vec::with_capacity(pairs.len());
        for (key, value) in pairs {
            match key.as_str() {
                Some(text) => out.push((Sp { value: text.value.clone(), span: text.inner }, value)),
                None => self.want_string(key, &format!("a key of {what}")),
            }
        }
        Some(out)
    }
}

fn list(words: &[&str]) -> String {
    words.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>().join(", ")
}
