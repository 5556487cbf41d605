//! Where the things of a WGSL text are declared. naga keeps no places of entry points, arguments
//! and struct members, so they are found in the text, by file, as the person wrote it.

use std::collections::BTreeMap;

use super::scan::{Kind, Scan, Token};
use crate::diagnostic::{FileId, Span};

/// A module's declarations by name. A name is declared once in a module, whichever file it is in.
#[derive(Clone, Debug, Default)]
pub(super) struct Declarations {
    pub functions: BTreeMap<String, Function>,
    pub structs: BTreeMap<String, Struct>,
    /// `var`, `override`, `const` and `alias`: the place of the name.
    pub values: BTreeMap<String, Span>,
}

#[derive(Clone, Debug)]
pub(super) struct Function {
    pub name: Span,
    pub arguments: Vec<Field>,
    pub result: Option<Span>,
}

#[derive(Clone, Debug)]
pub(super) struct Struct {
    pub name: Span,
    pub members: Vec<Field>,
}

/// A struct's member or a function's argument.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub name: String,
    /// From its name to the end of its type.
    pub span: Span,
}

impl Declarations {
    /// Adds what a file declares at module scope.
    pub fn add(&mut self, file: FileId, text: &str, scan: &Scan) {
        let mut reader = Reader { file, text, tokens: &scan.tokens, at: 0 };
        while let Some(token) = reader.next() {
            match token.text(text) {
                "fn" => reader.function(self),
                "struct" => reader.structure(self),
                "var" | "override" | "const" | "alias" => reader.value(self),
                "{" => reader.skip_to(b'{', b'}'),
                "(" => reader.skip_to(b'(', b')'),
                _ => {}
            }
        }
    }

    pub fn member(&self, of: &str, name: &str) -> Option<Span> {
        self.structs.get(of)?.members.iter().find(|m| m.name == name).map(|m| m.span)
    }

    /// Where a name of any kind is declared.
    pub fn name(&self, name: &str) -> Option<Span> {
        let function = self.functions.get(name).map(|f| f.name);
        function.or_else(|| self.structs.get(name).map(|s| s.name)).or_else(|| self.values.get(name).copied())
    }

    /// All names at module scope.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.functions.keys().chain(self.structs.keys()).chain(self.values.keys()).map(String::as_str)
    }
}

struct Reader<'a> {
    file: FileId,
    text: &'a str,
    tokens: &'a [Token],
    at: usize,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Option<&'a Token> {
        let token = self.tokens.get(self.at)?;
        self.at += 1;
        Some(token)
    }

    fn next_if(&mut self, mark: u8) -> bool {
        let found = self.tokens.get(self.at).is_some_and(|t| t.is(mark));
        self.at += usize::from(found);
        found
    }

    fn span(&self, from: &Token, to: &Token) -> Span {
        Span::new(self.file, from.start, to.end)
    }

    fn name(&mut self) -> Option<(String, Span)> {
        let token = self.tokens.get(self.at).filter(|t| t.kind == Kind::Word)?;
        self.at += 1;
        Some((token.text(self.text).to_owned(), self.span(token, token)))
    }

    /// Goes behind the bracket that closes the one just read.
    fn skip_to(&mut self, open: u8, close: u8) {
        let mut depth = 1;
        while depth > 0 {
            match self.next() {
                Some(token) if token.is(open) => depth += 1,
                Some(token) if token.is(close) => depth -= 1,
                Some(_) => {}
                None => return,
            }
        }
    }

    fn value(&mut self, into: &mut Declarations) {
        if self.next_if(b'<') {
            self.skip_to(b'<', b'>');
        }
        if let Some((name, span)) = self.name() {
            into.values.entry(name).or_insert(span);
        }
    }

    fn structure(&mut self, into: &mut Declarations) {
        let Some((name, span)) = self.name() else { return };
        if !self.next_if(b'{') {
            return;
        }
        let start = self.at;
        self.skip_to(b'{', b'}');
        let members = self.fields(start, self.at.saturating_sub(1));
        into.structs.entry(name).or_insert(Struct { name: span, members });
    }

    fn function(&mut self, into: &mut Declarations) {
        let Some((name, span)) = self.name() else { return };
        if !self.next_if(b'(') {
            return;
        }
        let start = self.at;
        self.skip_to(b'(', b')');
        let arguments = self.fields(start, self.at.saturating_sub(1));
        let rest = &self.tokens[self.at..];
        let length = rest.iter().position(|t| t.is(b'{')).unwrap_or(rest.len());
        let result = match &rest[..length] {
            // The arrow, then what is returned.
            [minus, greater, first, ..] if minus.is(b'-') && greater.is(b'>') => {
                Some(self.span(first, &rest[length - 1]))
            }
            _ => None,
        };
        into.functions.entry(name).or_insert(Function { name: span, arguments, result });
    }

    /// The `name: type` of a list, by the indices of the tokens between its brackets.
    fn fields(&self, start: usize, end: usize) -> Vec<Field> {
        let tokens = self.tokens.get(start..end).unwrap_or_default();
        let mut depth = 0_i32;
        let mut starts = Vec::new();
        for (at, pair) in tokens.windows(2).enumerate() {
            depth += i32::from(pair[0].is(b'(')) - i32::from(pair[0].is(b')'));
            if depth == 0 && pair[0].kind == Kind::Word && pair[1].is(b':') {
                starts.push(at);
            }
        }
        let ends = starts.iter().skip(1).map(|next| end_of_type(tokens, *next)).chain([tokens.len()]);
        let field = |(start, end): (&usize, usize)| {
            let last = tokens[*start..end.max(*start)].iter().rfind(|t| !t.is(b',')).unwrap_or(&tokens[*start]);
            Field { name: tokens[*start].text(self.text).to_owned(), span: self.span(&tokens[*start], last) }
        };
        starts.iter().zip(ends).map(field).collect()
    }
}

/// The index behind the type that stands before the field whose name is at `next`: that of the
/// comma before the field's attributes, which may have commas of their own in brackets.
fn end_of_type(tokens: &[Token], next: usize) -> usize {
    let mut depth = 0_i32;
    for at in (0..next).rev() {
        depth += i32::from(tokens[at].is(b')')) - i32::from(tokens[at].is(b'('));
        if depth == 0 && tokens[at].is(b',') {
            return at;
        }
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Sources;
    use crate::shader::scan::scan;

    fn declared(text: &str) -> (Sources, Declarations) {
        let mut sources = Sources::new();
        let file = sources.add("a.wgsl", text);
        let mut out = Declarations::default();
        out.add(file, text, &scan(text));
        (sources, out)
    }

    #[test]
    fn members_span_their_declaration_without_attributes() {
        let (sources, d) = declared(
            "struct A { x: f32, @size(16) y: array<vec2<f32>, 4 /* n */ >, \
             @location(0) @interpolate(perspective, center) z: atomic<u32>, }",
        );
        let spans: Vec<&str> = d.structs["A"].members.iter().map(|m| sources.snippet(m.span)).collect();
        assert_eq!(spans, ["x: f32", "y: array<vec2<f32>, 4 /* n */ >", "z: atomic<u32>"]);
        assert_eq!(sources.snippet(d.member("A", "y").unwrap_or(d.structs["A"].name)), spans[1]);
    }

    #[test]
    fn functions_have_arguments_and_results() {
        let (sources, d) = declared(
            "@fragment fn main(@builtin(position) p: vec4<f32>, @location(0) uv: vec2f) -> @location(0) vec4<f32> \
             { var inner: f32; }\nfn none() {}",
        );
        let main = &d.functions["main"];
        let spans: Vec<&str> = main.arguments.iter().map(|m| sources.snippet(m.span)).collect();
        assert_eq!(spans, ["p: vec4<f32>", "uv: vec2f"]);
        assert_eq!(main.result.map(|r| sources.snippet(r)), Some("@location(0) vec4<f32>"));
        assert_eq!(sources.snippet(main.name), "main");
        assert!(d.functions["none"].result.is_none());
        assert!(d.name("inner").is_none(), "locals are not at module scope");
    }

    #[test]
    fn values_are_found_behind_their_address_space() {
        let (sources, d) =
            declared("var<storage, read_write> a: array<u32>; override b = 1u; const c = 2; alias T = f32;");
        assert_eq!(d.names().collect::<Vec<_>>(), ["T", "a", "b", "c"]);
        assert_eq!(sources.snippet(d.values["a"]), "a");
    }

    #[test]
    fn broken_texts_do_no_harm() {
        for text in
            ["fn", "fn a", "fn a(", "fn a(b:", "struct", "struct A", "struct A {", "struct A { x:", "var<", "fn a() ->"]
        {
            declared(text);
        }
    }
}
