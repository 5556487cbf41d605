//! What stands in brackets: lists, maps, and named or unnamed values.

use std::collections::HashMap;
use std::ops::Range;

use super::{MAX_FAULTS, Parser};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::lexer::{Bracket, TokenKind};
use crate::syntax::literal::Fault;
use crate::syntax::{Body, Kind, MAX_DEPTH, Node, Sp, Tagged};

/// An entry of a round bracket.
enum Entry {
    Field(Sp<String>, Node),
    Item(Node),
}

impl Parser {
    /// Enters a bracket, or skips it if it is too deep.
    fn enter(&mut self) -> Result<Range<usize>, Node> {
        let open = self.range();
        if self.depth < MAX_DEPTH {
            self.depth += 1;
            self.advance();
            return Ok(open);
        }
        self.fault(Fault::new(
            open.clone(),
            format!("brackets are nested more than {MAX_DEPTH} deep"),
            "this one is too deep",
        ));
        self.skip_bracket();
        Err(Node { span: self.span(open), kind: Kind::Invalid })
    }

    /// Entries up to the closing bracket, which is taken; its end.
    fn entries(&mut self, bracket: Bracket, mut entry: impl FnMut(&mut Self)) -> usize {
        let close = TokenKind::Close(bracket);
        loop {
            if matches!(self.peek(), TokenKind::Close(_) | TokenKind::End) {
                let end = self.range().end;
                self.eat(&close);
                self.depth -= 1;
                return end;
            }
            let before = self.at;
            entry(self);
            self.separator(bracket, before);
        }
    }

    pub(super) fn bracketed(&mut self, bracket: Bracket) -> Node {
        let open = match self.enter() {
            Ok(open) => open,
            Err(node) => return node,
        };
        let (mut items, mut pairs) = (Vec::new(), Vec::new());
        let end = match bracket {
            Bracket::Curly => self.entries(bracket, |parser| pairs.extend(parser.pair())),
            _ => self.entries(bracket, |parser| items.push(parser.value())),
        };
        let kind = match bracket {
            Bracket::Curly => {
                Kind::Map(self.unique("key", pairs, |key| key.as_str().map(|s| (s.value.as_str(), key.span))))
            }
            _ => Kind::List(items),
        };
        Node { span: self.span(open.start..end), kind }
    }

    /// `key: value` of a map.
    fn pair(&mut self) -> Option<(Node, Node)> {
        let key = self.value();
        if key.is_invalid() && !matches!(self.peek(), TokenKind::Colon) {
            return None;
        }
        self.colon("the key");
        let value = self.value();
        Some((key, value))
    }

    /// Drops the later of two entries of one name, and says so.
    fn unique<K, V>(
        &mut self,
        what: &str,
        entries: Vec<(K, V)>,
        name: impl Fn(&K) -> Option<(&str, Span)>,
    ) -> Vec<(K, V)> {
        let mut kept = Vec::with_capacity(entries.len());
        let mut seen: HashMap<String, Span> = HashMap::new();
        for (key, value) in entries {
            if let Some((text, span)) = name(&key) {
                if let Some(first) = seen.get(text) {
                    if self.duplicates.len() < MAX_FAULTS {
                        self.duplicates.push(duplicate(what, text, *first, span));
                    }
                    continue;
                }
                seen.insert(text.into(), span);
            }
            kept.push((key, value));
        }
        kept
    }

    pub(super) fn tagged(&mut self, name: Option<Sp<String>>) -> Node {
        let open = match self.enter() {
            Ok(open) => open,
            Err(node) => return node,
        };
        let troubles = self.troubles;
        let mut entries = Vec::new();
        let end = self.entries(Bracket::Round, |parser| {
            let entry = parser.entry();
            entries.push(entry);
        });
        let start = name.as_ref().map_or(open.start, |n| n.span.start as usize);
        let head = self.span(start..open.end);
        let body = self.body(entries);
        let is_whole = self.troubles == troubles;
        Node { span: self.span(start..end), kind: Kind::Tagged(Tagged { name, body, is_whole, head }) }
    }

    /// `name: value` or `value`.
    fn entry(&mut self) -> Entry {
        if let TokenKind::Ident(name) = self.peek().clone() {
            let next = self.peek_next();
            let is_field = matches!(next, TokenKind::Colon | TokenKind::Other('='))
                || (next.starts_value() && *next != TokenKind::Open(Bracket::Round));
            if is_field {
                let name = Sp { value: name, span: self.span(self.range()) };
                self.advance();
                self.colon(&format!("the field `{}`", name.value));
                return Entry::Field(name, self.value());
            }
        }
        let start = self.range();
        let node = self.value();
        if *self.peek() == TokenKind::Colon {
            let fault = match node.as_str() {
                Some(text) => Fault::new(start, "a field's name stands without quotes", "this is a string")
                    .hint(format!("write `{}:`, or braces in place of the brackets if this is a map", text.value)),
                None => Fault::new(start, "a `:` follows something that is not a field's name", "this is not a name"),
            };
            self.fault(fault);
            self.advance();
            let value = self.value();
            return Entry::Item(Node { kind: Kind::Invalid, ..value });
        }
        Entry::Item(node)
    }

    fn body(&mut self, entries: Vec<Entry>) -> Body {
        let first_is_field =
            matches!(entries.iter().find(|e| !matches!(e, Entry::Item(n) if n.is_invalid())), Some(Entry::Field(..)));
        let (mut fields, mut items): (Vec<(Sp<String>, Node)>, Vec<Node>) = (Vec::new(), Vec::new());
        for entry in entries {
            match entry {
                Entry::Field(name, value) => fields.push((name, value)),
                Entry::Item(node) => items.push(node),
            }
        }
        let odd = if first_is_field {
            items
                .iter()
                .find(|n| !n.is_invalid())
                .map(|n| (n.span, "this has no name", fields.first().map(|f| f.0.span)))
        } else {
            fields.first().map(|f| (f.0.span, "this has a name", items.first().map(Node::head)))
        };
        if let Some((span, label, other)) = odd {
            let range = span.start as usize..span.end as usize;
            let mut fault = Fault::new(range, "named and unnamed values stand in one bracket", label)
                .hint("name all of them, or none");
            if let Some(other) = other {
                fault = fault.see(
                    other.start as usize..other.end as usize,
                    if first_is_field { "this has one" } else { "this has none" },
                );
            }
            self.fault(fault);
        }
        if first_is_field {
            Body::Fields(self.unique("field", fields, |name| Some((&name.value, name.span))))
        } else {
            Body::Items(items)
        }
    }
}

fn duplicate(what: &str, name: &str, first: Span, second: Span) -> Diagnostic {
    Diagnostic::error(Code::DUPLICATE, format!("the {what} `{name}` is given twice"))
        .at(second, "given again here")
        .see(first, "first given here")
        .hint("keep one of them")
}
