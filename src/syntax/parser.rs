//! Tokens into a tree, with recovery: after a mistake inside a bracket, the parser goes on at
//! the next comma of that bracket.

use std::collections::HashMap;
use std::ops::Range;

use super::brackets;
use super::lexer::{self, Bracket, Token, TokenKind};
use super::literal::Fault;
use super::{Body, Kind, MAX_DEPTH, Node, Sp, Str, Tagged};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, FileId, Span};

/// Extensions of RON that may be enabled; none changes what a tree looks like.
const EXTENSIONS: &[&str] = &["unwrap_newtypes", "implicit_some", "unwrap_variant_newtypes", "explicit_struct_names"];

/// How many mistakes of form are told: a file with more is not RON.
const MAX_FAULTS: usize = 50;

pub(super) fn parse(text: &str, file: FileId, diagnostics: &mut Diagnostics) -> Option<Node> {
    let lexed = lexer::lex(text);
    let mut tokens = lexed.tokens;
    let mut faults = lexed.faults;
    faults.truncate(MAX_FAULTS);
    let repairs = brackets::balance(text, &mut tokens);
    let mut disturbed = repairs.disturbed;
    if lexed.broken_lines.is_empty() {
        faults.extend(repairs.faults);
    }
    disturbed.extend(lexed.broken_lines);
    let mut parser = Parser { file, tokens, at: 0, depth: 0, disturbed, faults, troubles: 0, duplicates: Vec::new() };
    let is_hopeless = parser.tokens.len() == 1 && !parser.faults.is_empty();
    let node = if is_hopeless { parser.nothing() } else { parser.document() };
    let mut found: Vec<Diagnostic> = parser.faults.iter().map(|fault| diagnostic(fault, file)).collect();
    found.append(&mut parser.duplicates);
    found.sort_by_key(|d| d.labels.iter().find(|l| l.primary).map(|l| l.span.start));
    found.into_iter().for_each(|d| diagnostics.push(d));
    (!node.is_invalid()).then_some(node)
}

fn diagnostic(fault: &Fault, file: FileId) -> Diagnostic {
    let span = |range: &Range<usize>| Span::new(file, range.start, range.end);
    let mut d = Diagnostic::error(Code::SYNTAX, &fault.message).at(span(&fault.range), &fault.label);
    if let Some((range, label)) = &fault.see {
        d = d.see(span(range), label);
    }
    match &fault.hint {
        Some(hint) => d.hint(hint),
        None => d,
    }
}

struct Parser {
    file: FileId,
    /// Brackets match.
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
    /// Where complaints would only follow from a mistake that was reported.
    disturbed: Vec<Range<usize>>,
    faults: Vec<Fault>,
    /// How often something was unreadable, also where nothing was said about it.
    troubles: usize,
    duplicates: Vec<Diagnostic>,
}

/// An entry of a round bracket.
enum Entry {
    Field(Sp<String>, Node),
    Item(Node),
}

impl Parser {
    fn document(&mut self) -> Node {
        while *self.peek() == TokenKind::Other('#') {
            self.attribute();
        }
        let node = self.value();
        if *self.peek() != TokenKind::End {
            let found = self.peek().describe();
            self.fault(Fault::new(
                self.range(),
                format!("expected the end of the file, found {found}"),
                "the file's one value ends before this",
            ));
        }
        node
    }

    fn nothing(&self) -> Node {
        Node { span: self.span(self.range()), kind: Kind::Invalid }
    }

    fn peek(&self) -> &TokenKind {
        &self.tokens[self.at].kind
    }

    fn peek_next(&self) -> &TokenKind {
        &self.tokens[(self.at + 1).min(self.tokens.len() - 1)].kind
    }

    fn range(&self) -> Range<usize> {
        self.tokens[self.at].range.clone()
    }

    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range.start, range.end)
    }

    fn advance(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    fn eat(&mut self, kind: &TokenKind) -> bool {
        let found = self.peek() == kind;
        if found {
            self.advance();
        }
        found
    }

    fn fault(&mut self, fault: Fault) {
        self.troubles += 1;
        if self.faults.len() >= MAX_FAULTS {
            return;
        }
        let touches = |r: &Range<usize>| r.start <= fault.range.end && fault.range.start <= r.end;
        let said = self.faults.iter().any(|f| f.range.start == fault.range.start);
        if !said && !self.disturbed.iter().any(touches) {
            self.faults.push(fault);
        }
    }

    /// Where something is missing: the end of the token before.
    fn gap(&self) -> Range<usize> {
        let end = self.at.checked_sub(1).map_or(0, |before| self.tokens[before].range.end);
        end..end
    }

    /// `#![enable(...)]`, `#![type = "..."]`, `#![schema = "..."]`.
    fn attribute(&mut self) {
        let start = self.range().start;
        let mut is_good = self.eat(&TokenKind::Other('#')) && self.eat(&TokenKind::Other('!'));
        is_good &= self.eat(&TokenKind::Open(Bracket::Square));
        match self.peek().clone() {
            TokenKind::Ident(word) if word == "enable" => {
                self.advance();
                is_good &= self.eat(&TokenKind::Open(Bracket::Round));
                let mut some = false;
                while let TokenKind::Ident(name) = self.peek()
                    && EXTENSIONS.contains(&name.as_str())
                {
                    some = true;
                    self.advance();
                    if !self.eat(&TokenKind::Comma) {
                        break;
                    }
                }
                is_good &= some && self.eat(&TokenKind::Close(Bracket::Round));
            }
            TokenKind::Ident(word) if word == "type" || word == "schema" => {
                self.advance();
                is_good &= self.eat(&TokenKind::Other('=')) && matches!(self.peek(), TokenKind::Str(..));
                self.advance();
            }
            _ => is_good = false,
        }
        is_good &= *self.peek() == TokenKind::Close(Bracket::Square);
        if is_good {
            self.advance();
            return;
        }
        while !matches!(self.peek(), TokenKind::Close(Bracket::Square) | TokenKind::End) {
            self.advance();
        }
        self.eat(&TokenKind::Close(Bracket::Square));
        let known = EXTENSIONS.join(", ");
        self.fault(
            Fault::new(start..start + 1, "an attribute is not one of RON's", "here")
                .hint(format!("RON has `#![enable(...)]` with {known}; none is needed here")),
        );
    }

    /// A value; [`Kind::Invalid`] after a fault, with nothing or the faulty thing taken.
    fn value(&mut self) -> Node {
        let range = self.range();
        let kind = match self.peek().clone() {
            TokenKind::Ident(name) => return self.word(name),
            TokenKind::Open(Bracket::Round) => return self.tagged(None),
            TokenKind::Open(bracket) => return self.bracketed(bracket),
            TokenKind::Int(value) => Kind::Int(value),
            TokenKind::Float(value) => Kind::Float(value),
            TokenKind::Str(value, inner, exact) => Kind::Str(Str { value, inner: self.span(inner), exact }),
            TokenKind::Char(c) => Kind::Char(c),
            TokenKind::Bad => {
                self.troubles += 1;
                Kind::Invalid
            }
            other => {
                self.fault(expected_value(range.clone(), &other));
                return Node { span: self.span(range), kind: Kind::Invalid };
            }
        };
        self.advance();
        Node { span: self.span(range), kind }
    }

    fn word(&mut self, name: String) -> Node {
        let span = self.span(self.range());
        self.advance();
        let kind = match name.as_str() {
            "true" => Kind::Bool(true),
            "false" => Kind::Bool(false),
            "inf" => Kind::Float(f64::INFINITY),
            "NaN" => Kind::Float(f64::NAN),
            _ if *self.peek() == TokenKind::Open(Bracket::Round) => {
                return self.tagged(Some(Sp { value: name, span }));
            }
            _ => Kind::Tagged(Tagged {
                name: Some(Sp { value: name, span }),
                body: Body::Unit,
                is_whole: true,
                head: span,
            }),
        };
        Node { span, kind }
    }

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

    /// Takes a whole bracket, whatever is in it.
    fn skip_bracket(&mut self) {
        let mut open = 0usize;
        loop {
            match self.peek() {
                TokenKind::Open(_) => open += 1,
                TokenKind::Close(_) => open = open.saturating_sub(1),
                TokenKind::End => return,
                _ => {}
            }
            self.advance();
            if open == 0 {
                return;
            }
        }
    }

    /// To the next comma or closing bracket of the bracket that is open.
    fn skip_entry(&mut self) {
        while !matches!(self.peek(), TokenKind::Comma | TokenKind::Close(_) | TokenKind::End) {
            match self.peek() {
                TokenKind::Open(_) => self.skip_bracket(),
                _ => self.advance(),
            }
        }
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

    /// The comma after an entry that began at token `before`, or the complaint that it is missing.
    fn separator(&mut self, bracket: Bracket, before: usize) {
        let found = self.peek().clone();
        match &found {
            TokenKind::Comma => self.advance(),
            TokenKind::Close(_) | TokenKind::End => {}
            _ if self.at == before => {
                // Nothing was taken, which was reported.
                self.advance();
                self.skip_entry();
                self.eat(&TokenKind::Comma);
            }
            TokenKind::Other(';') => {
                self.fault(Fault::new(
                    self.range(),
                    "entries are separated by `,`, not by `;`",
                    "a `,` is expected here",
                ));
                self.advance();
            }
            kind if kind.starts_value() && !self.is_broken_here() => {
                let text = format!("expected `,` or `{}`, found {}", bracket.close(), kind.describe());
                self.fault(Fault::new(self.gap(), text, "a `,` is missing here").see(self.range(), "this comes next"));
            }
            kind => {
                let text = format!("expected `,` or `{}`, found {}", bracket.close(), kind.describe());
                self.fault(Fault::new(self.range(), text, "this is not expected here"));
                self.skip_entry();
                self.eat(&TokenKind::Comma);
            }
        }
    }

    /// Whether the token at hand lies where nothing more is to be said.
    fn is_broken_here(&self) -> bool {
        let here = self.range();
        self.disturbed.iter().any(|r| r.start <= here.start && here.start < r.end)
    }

    fn bracketed(&mut self, bracket: Bracket) -> Node {
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

    /// The colon after a key or a field's name; a `=` is taken for one.
    fn colon(&mut self, after: &str) {
        if self.eat(&TokenKind::Colon) {
            return;
        }
        let found = self.peek().describe();
        let text = format!("expected `:` after {after}, found {found}");
        if *self.peek() == TokenKind::Other('=') {
            self.fault(Fault::new(self.range(), text, "a `:` is expected here"));
            self.advance();
        } else {
            self.fault(Fault::new(self.gap(), text, "a `:` is missing here"));
        }
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

    fn tagged(&mut self, name: Option<Sp<String>>) -> Node {
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

fn expected_value(range: Range<usize>, found: &TokenKind) -> Fault {
    let fault = Fault::new(range, format!("expected a value, found {}", found.describe()), "a value is expected here");
    match found {
        TokenKind::Comma => fault.hint("remove the comma, or put a value before it"),
        TokenKind::Other('“' | '”' | '„' | '‘' | '’') => {
            fault.hint("strings stand in straight quotes: \"...\"")
        }
        _ => fault,
    }
}
