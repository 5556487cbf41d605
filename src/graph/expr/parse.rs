//! The text of an expression into its tree.
//!
//! From loose to tight: `or`, `and`, `not`, one comparison, `+ -`, `* / %`, unary `-`, `.x`.

use super::{Binary, Expr, ExprKind, Function, Unary};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::value::Value;

/// How deep brackets and signs may nest, and how many operators an expression may have: trees
/// are walked by recursion.
const MAX_DEPTH: usize = 48;
const MAX_TOKENS: usize = 1024;

/// Reads an expression. `at` is the place of the text in its file; `exact` says that offsets in
/// the text are offsets in the file (no escapes). Without it, everything points at the whole.
///
/// # Errors
/// `expression-syntax`, pointing at the first mistake.
pub fn parse(text: &str, at: Span, exact: bool) -> Result<Expr, Diagnostic> {
    parse_as(text, Place { at, exact, is_stat: false })
}

/// The same for a statistic, which may also read items of buffers, and sum over them.
///
/// # Errors
/// As [`parse`].
pub fn parse_stat(text: &str, at: Span, exact: bool) -> Result<Expr, Diagnostic> {
    parse_as(text, Place { at, exact, is_stat: true })
}

fn parse_as(text: &str, place: Place) -> Result<Expr, Diagnostic> {
    let at = place.at;
    let tokens = tokens(text, place)?;
    if tokens.len() > MAX_TOKENS {
        let message = format!("an expression has more than {MAX_TOKENS} words and signs");
        return Err(fault(message, at, "too long").hint("split it with names under `let`"));
    }
    let mut parser = Parser { tokens: &tokens, at: 0, depth: 0, is_stat: place.is_stat };
    if parser.peek() == &Token::End {
        return Err(fault("an expression is empty", at, "a value is expected here"));
    }
    let expr = parser.or()?;
    match parser.peek() {
        Token::End => Ok(expr),
        _ => Err(parser.unexpected("an operator or the end")),
    }
}

/// Where the text stands.
#[derive(Clone, Copy)]
struct Place {
    at: Span,
    exact: bool,
    /// Of a statistic.
    is_stat: bool,
}

impl Place {
    fn span(self, start: usize, end: usize) -> Span {
        if self.exact {
            Span::new(self.at.file, self.at.start as usize + start, self.at.start as usize + end)
        } else {
            self.at
        }
    }
}

fn fault(message: impl Into<String>, span: Span, label: impl Into<String>) -> Diagnostic {
    Diagnostic::error(Code::EXPRESSION_SYNTAX, message).at(span, label)
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(Value),
    Word(String),
    Name(String),
    Sign(&'static str),
    End,
}

impl Token {
    fn describe(&self) -> String {
        match self {
            Token::Number(value) => format!("`{value}`"),
            Token::Word(word) => format!("`'{word}'`"),
            Token::Name(name) => format!("`{name}`"),
            Token::Sign(sign) => format!("`{sign}`"),
            Token::End => "the end".into(),
        }
    }
}

/// Longer signs first.
const SIGNS: &[&str] = &["<=", ">=", "==", "!=", "(", ")", ",", "+", "-", "*", "/", "%", "<", ">", "."];

/// What people write by habit, and what is meant here.
const HABITS: &[(&str, &str)] = &[
    ("&&", "write `and`"),
    ("||", "write `or`"),
    ("!", "write `not`"),
    ("=", "compare with `==`"),
    ("**", "multiply the factors out; there is no power"),
    ("^", "multiply the factors out; there is no power"),
    ("[", "items of buffers cannot be read when a graph is planned"),
    ("?", "choose with `If` around the passes, or with `min` and `max`"),
    ("\"", "words of a choice stand in single quotes: 'word'"),
];

fn tokens(text: &str, place: Place) -> Result<Vec<(Token, Span)>, Diagnostic> {
    let mut out = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        if c.is_whitespace() {
            at += c.len_utf8();
            continue;
        }
        let (token, length) = token(text, at, c, place)?;
        out.push((token, place.span(at, at + length)));
        at += length;
    }
    out.push((Token::End, place.span(text.len(), text.len())));
    Ok(out)
}

fn token(text: &str, at: usize, c: char, place: Place) -> Result<(Token, usize), Diagnostic> {
    let rest = &text[at..];
    let digit_follows = rest[c.len_utf8()..].starts_with(|c: char| c.is_ascii_digit());
    if c.is_ascii_digit() || (c == '.' && digit_follows) {
        return number(rest, at, place);
    }
    if c == '\'' {
        let Some(length) = rest[1..].find('\'') else {
            return Err(fault("a word in quotes is never closed", place.span(at, at + 1), "this quote has no partner"));
        };
        return Ok((Token::Word(rest[1..=length].into()), length + 2));
    }
    if c.is_ascii_alphabetic() || c == '_' {
        let length = path_length(rest);
        return Ok((Token::Name(rest[..length].into()), length));
    }
    if let Some(sign) = ["[", "]"].into_iter().find(|sign| place.is_stat && rest.starts_with(sign)) {
        return Ok((Token::Sign(sign), 1));
    }
    if let Some((habit, hint)) =
        HABITS.iter().find(|(h, _)| rest.starts_with(h) && !rest.starts_with("==") && !rest.starts_with("!="))
    {
        let span = place.span(at, at + habit.len());
        return Err(fault(format!("an expression has no `{habit}`"), span, "not a sign of the language").hint(*hint));
    }
    match SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
        Some(sign) => Ok((Token::Sign(sign), sign.len())),
        None => {
            let span = place.span(at, at + c.len_utf8());
            Err(fault(format!("an expression has no `{c}`"), span, "not a sign of the language"))
        }
    }
}

/// The length of `a.b.c`; a dot belongs to it only if a name follows.
fn path_length(text: &str) -> usize {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut length = text.find(|c| !is_part(c)).unwrap_or(text.len());
    while let Some(rest) = text[length..].strip_prefix('.')
        && rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
    {
        length += 1 + rest.find(|c| !is_part(c)).unwrap_or(rest.len());
    }
    length
}

fn number(rest: &str, at: usize, place: Place) -> Result<(Token, usize), Diagnostic> {
    let bytes = rest.as_bytes();
    let is_hex = rest.starts_with("0x");
    let mut length = 0;
    while length < bytes.len() {
        let keeps = match bytes[length] {
            b'+' | b'-' => !is_hex && matches!(bytes[length - 1], b'e' | b'E'),
            c => c.is_ascii_alphanumeric() || c == b'_' || c == b'.',
        };
        if !keeps {
            break;
        }
        length += 1;
    }
    let word = &rest[..length];
    let plain: String = word.chars().filter(|c| *c != '_').collect();
    let value = match plain.strip_prefix("0x") {
        Some(hex) => i64::from_str_radix(hex, 16).ok().map(Value::Int),
        None if plain.contains(['.', 'e', 'E']) => {
            let is_decimal = plain.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
            plain.parse().ok().filter(|x: &f64| is_decimal && x.is_finite()).map(Value::Float)
        }
        None => plain.parse().ok().map(Value::Int),
    };
    match value {
        Some(value) => Ok((Token::Number(value), length)),
        None => {
            Err(fault(format!("`{word}` is not a number"), place.span(at, at + length), "a number is expected here"))
        }
    }
}

struct Parser<'a> {
    tokens: &'a [(Token, Span)],
    at: usize,
    depth: usize,
    is_stat: bool,
}

type Parsed = Result<Expr, Diagnostic>;

impl Parser<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.at].0
    }

    fn span(&self) -> Span {
        self.tokens[self.at].1
    }

    fn advance(&mut self) -> Span {
        let span = self.span();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        span
    }

    fn eat(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Token::Sign(s) if *s == sign);
        if found {
            self.advance();
        }
        found
    }

    fn eat_word(&mut self, word: &str) -> Option<Span> {
        matches!(self.peek(), Token::Name(name) if name == word).then(|| self.advance())
    }

    fn unexpected(&self, expected: &str) -> Diagnostic {
        let message = format!("expected {expected} in an expression, found {}", self.peek().describe());
        fault(message, self.span(), format!("{expected} is expected here"))
    }

    fn binary(op: Binary, a: Expr, b: Expr) -> Expr {
        let span = a.span.to(b.span);
        Expr { kind: ExprKind::Binary(op, Box::new(a), Box::new(b)), span }
    }

    fn deeper(&mut self, read: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        if self.depth >= MAX_DEPTH {
            let message = format!("an expression is nested more than {MAX_DEPTH} deep");
            return Err(fault(message, self.span(), "too deep").hint("split it with names under `let`"));
        }
        self.depth += 1;
        let expr = read(self);
        self.depth -= 1;
        expr
    }

    fn or(&mut self) -> Parsed {
        let mut left = self.and()?;
        while self.eat_word("or").is_some() {
            left = Self::binary(Binary::Or, left, self.and()?);
        }
        Ok(left)
    }

    fn and(&mut self) -> Parsed {
        let mut left = self.not()?;
        while self.eat_word("and").is_some() {
            left = Self::binary(Binary::And, left, self.not()?);
        }
        Ok(left)
    }

    fn not(&mut self) -> Parsed {
        match self.eat_word("not") {
            Some(word) => {
                let inner = self.deeper(Self::not)?;
                Ok(Expr { span: word.to(inner.span), kind: ExprKind::Unary(Unary::Not, Box::new(inner)) })
            }
            None => self.comparison(),
        }
    }

    fn comparison_sign(&mut self) -> Option<Binary> {
        let op = match self.peek() {
            Token::Sign("==") => Binary::Equal,
            Token::Sign("!=") => Binary::NotEqual,
            Token::Sign("<") => Binary::Less,
            Token::Sign("<=") => Binary::LessEqual,
            Token::Sign(">") => Binary::Greater,
            Token::Sign(">=") => Binary::GreaterEqual,
            _ => return None,
        };
        Some(op)
    }

    fn comparison(&mut self) -> Parsed {
        let left = self.sum()?;
        let Some(op) = self.comparison_sign() else { return Ok(left) };
        self.advance();
        let expr = Self::binary(op, left, self.sum()?);
        match self.comparison_sign() {
            Some(_) => {
                Err(fault("comparisons do not chain", self.span(), "a second comparison")
                    .hint("write `a < b and b < c`"))
            }
            None => Ok(expr),
        }
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        loop {
            let op = match self.peek() {
                Token::Sign("+") => Binary::Add,
                Token::Sign("-") => Binary::Subtract,
                _ => return Ok(left),
            };
            self.advance();
            left = Self::binary(op, left, self.product()?);
        }
    }

    fn product(&mut self) -> Parsed {
        let mut left = self.unary()?;
        loop {
            let op = match self.peek() {
                Token::Sign("*") => Binary::Multiply,
                Token::Sign("/") => Binary::Divide,
                Token::Sign("%") => Binary::Remainder,
                _ => return Ok(left),
            };
            self.advance();
            left = Self::binary(op, left, self.unary()?);
        }
    }

    fn unary(&mut self) -> Parsed {
        if !matches!(self.peek(), Token::Sign("-")) {
            return self.postfix();
        }
        let sign = self.advance();
        let inner = self.deeper(Self::unary)?;
        Ok(Expr { span: sign.to(inner.span), kind: ExprKind::Unary(Unary::Negate, Box::new(inner)) })
    }

    fn postfix(&mut self) -> Parsed {
        let mut expr = self.primary()?;
        if self.eat("[") {
            return self.item(expr);
        }
        while self.eat(".") {
            let component = match self.peek() {
                Token::Name(name) => ["x", "y", "z", "w"].iter().find(|c| *c == name).and_then(|c| c.chars().next()),
                _ => None,
            };
            let Some(component) = component else { return Err(self.unexpected("`x`, `y`, `z` or `w`")) };
            let span = expr.span.to(self.advance());
            expr = Expr { kind: ExprKind::Component(Box::new(expr), component), span };
        }
        Ok(expr)
    }

    /// What stands behind `buffer[`.
    fn item(&mut self, of: Expr) -> Parsed {
        if !matches!(of.kind, ExprKind::Name(_)) {
            return Err(fault("only buffers have items", of.span, "the name of a buffer is expected here"));
        }
        let index = self.deeper(Self::or)?;
        let mut end = self.span();
        if !self.eat("]") {
            return Err(self.unexpected("`]`"));
        }
        let mut members = Vec::new();
        while self.eat(".") {
            // The words behind one dot are one token.
            let Token::Name(name) = self.peek().clone() else { return Err(self.unexpected("a member's name")) };
            members.extend(name.split('.').map(str::to_owned));
            end = self.advance();
        }
        let span = of.span.to(end);
        Ok(Expr { kind: ExprKind::Item(Box::new(of), Box::new(index), members), span })
    }

    fn primary(&mut self) -> Parsed {
        let span = self.span();
        let kind = match self.peek().clone() {
            Token::Number(value) => ExprKind::Literal(value),
            Token::Word(word) => ExprKind::Literal(Value::Word(word)),
            Token::Name(name) => match name.as_str() {
                "true" => ExprKind::Literal(Value::Bool(true)),
                "false" => ExprKind::Literal(Value::Bool(false)),
                "and" | "or" | "not" => return Err(self.unexpected("a value")),
                _ if self.tokens[self.at + 1].0 == Token::Sign("(") => return self.call(&name),
                _ => ExprKind::Name(name),
            },
            Token::Sign("(") => return self.bracket(),
            Token::Sign(_) | Token::End => return Err(self.unexpected("a value")),
        };
        self.advance();
        Ok(Expr { kind, span })
    }

    /// Values between brackets, the opening one of which is at hand.
    fn list(&mut self) -> Result<(Vec<Expr>, Span), Diagnostic> {
        let open = self.advance();
        let mut items = Vec::new();
        loop {
            if matches!(self.peek(), Token::Sign(")")) {
                return Ok((items, open.to(self.advance())));
            }
            items.push(self.deeper(Self::or)?);
            match self.peek() {
                Token::Sign(",") => _ = self.advance(),
                Token::Sign(")") => {}
                Token::End => {
                    return Err(fault("a `(` in an expression is never closed", open, "this has no partner"));
                }
                _ => return Err(self.unexpected("an operator, `,` or `)`")),
            }
        }
    }

    /// `(a)` or a vector.
    fn bracket(&mut self) -> Parsed {
        let is_empty = matches!(self.tokens[self.at + 1].0, Token::Sign(")"));
        if is_empty {
            self.advance();
            return Err(self.unexpected("a value"));
        }
        let (mut items, span) = self.list()?;
        match items.len() {
            1 => Ok(Expr { span, ..items.swap_remove(0) }),
            2..=4 => Ok(Expr { kind: ExprKind::Vector(items), span }),
            n => Err(fault(format!("a vector has 2 to 4 components, not {n}"), span, format!("{n} components"))),
        }
    }

    fn call(&mut self, name: &str) -> Parsed {
        let word = self.advance();
        let (args, list) = self.list()?;
        let span = word.to(list);
        let of_stats = if self.is_stat { Function::OF_STATS } else { &[] };
        let all = || Function::ALL.iter().chain(of_stats);
        let Some((_, function)) = all().find(|(known, _)| *known == name) else {
            let known: Vec<&str> = all().map(|(known, _)| *known).collect();
            return Err(fault(format!("there is no function `{name}`"), word, "unknown function")
                .nearest(name, known.iter().copied())
                .hint(format!("the functions are {}", known.join(", "))));
        };
        let want = match function {
            Function::Min | Function::Max => 1..=usize::MAX,
            Function::CeilDiv => 2..=2,
            _ => 1..=1,
        };
        if !want.contains(&args.len()) {
            let expected = match function {
                Function::Min | Function::Max => "one value or more".to_string(),
                Function::CeilDiv => "two values".to_string(),
                _ if function.takes_name() => "one name".to_string(),
                _ => "one value".to_string(),
            };
            let message = format!("`{name}` takes {expected}, not {}", args.len());
            return Err(fault(message, span, format!("{expected} expected")));
        }
        if let Some(arg) = args.first().filter(|arg| function.takes_name() && !matches!(arg.kind, ExprKind::Name(_))) {
            return Err(fault(format!("`{name}` takes a name, not a value"), arg.span, "a name is expected here"));
        }
        Ok(Expr { kind: ExprKind::Call(*function, args), span })
    }
}
