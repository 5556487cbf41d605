//! Tokens into a tree, with recovery: after a mistake inside a bracket, the parser goes on at
//! the next comma of that bracket.

mod content;

use std::ops::Range;

use super::brackets;
use super::lexer::{self, Bracket, Token, TokenKind};
use super::literal::Fault;
use super::{Body, Kind, Node, Sp, Str, Tagged};
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
