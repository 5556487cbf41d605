//! One text from a file and all that it imports, with a map back to the files.
//!
//! `#import "file.wgsl"` at the start of a line puts a file's text in front of the importing
//! file's, each file once however often it is named, so that cycles do no harm. `enable`,
//! `requires` and `diagnostic` directives move to the top, where WGSL wants them; what moved or
//! was an import is blanked in place, so that a file is one unbroken stretch of the whole.
//!
//! There are no namespaces: names are used as they are declared, and a name that two files
//! declare is naga's "redefinition", with both places.

use std::path::{Path, PathBuf};
use std::str;
use std::sync::Arc;

use super::declare::Declarations;
use super::map::{Segment, SourceMap, Unit};
use super::scan::{Kind, Scan, Token, scan};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, FileId, Sources, Span, nearest};
use crate::files::{self, Files, Found, NotFound};

/// A module's text and where it comes from.
#[derive(Debug)]
pub(super) struct Assembled {
    pub whole: String,
    pub map: SourceMap,
    pub declarations: Declarations,
    /// The text and tokens of each of `map.units`.
    pub texts: Vec<(Arc<str>, Scan)>,
    /// Index in `map.units` of the named file.
    pub named: usize,
}

/// What came of assembling: the text if every import was found, and in any case the files that a
/// watcher has to look at.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    pub assembled: Option<Assembled>,
    pub diagnostics: Diagnostics,
    pub read: Vec<PathBuf>,
}

pub(super) fn assemble(files: &dyn Files, sources: &mut Sources, name: &str, beside: Option<&Path>) -> Outcome {
    let mut reader = Reader { files, sources, out: Outcome::default(), units: Vec::new(), texts: Vec::new() };
    let found = match files::find(files, files::Kind::Shader, name, beside) {
        Ok(found) => found,
        Err(missing) => {
            reader.not_found(name, None, missing);
            return reader.out;
        }
    };
    let named = reader.visit(found, None);
    let (units, texts, mut out) = (reader.units, reader.texts, reader.out);
    if let (Some(named), false) = (named, out.diagnostics.has_errors()) {
        out.assembled = Some(join(units, texts, named));
    }
    out
}

struct Reader<'a> {
    files: &'a dyn Files,
    sources: &'a mut Sources,
    out: Outcome,
    units: Vec<Unit>,
    texts: Vec<(Arc<str>, Scan)>,
}

impl Reader<'_> {
    /// Reads a file and, before it is done, its imports: units are in the order in which they
    /// are met, `join` puts imports first.
    fn visit(&mut self, found: Found, via: Option<(usize, Span)>) -> Option<usize> {
        if let Some(at) = self.units.iter().position(|u| u.path == found.path) {
            return Some(at);
        }
        self.out.read.push(found.path.clone());
        let shown = found.path.display().to_string();
        let text: Arc<str> = match str::from_utf8(&found.bytes) {
            Ok(text) => text.into(),
            Err(error) => {
                self.out.diagnostics.push(not_utf8(&shown, &found.bytes, error.valid_up_to(), via));
                return None;
            }
        };
        let file = self.sources.add(shown, text.clone());
        let scanned = scan(&text);
        let at = self.units.len();
        self.units.push(Unit { path: found.path.clone(), file, length: text.len() as u32, via, imports: Vec::new() });
        self.texts.push((text.clone(), scanned.clone()));
        let (mut wrong, mut last_line) = (0, 0);
        for import in imports(&text, &scanned) {
            match import {
                Ok(path) => self.import(at, &found.path, &text, path),
                Err(token) => {
                    let line = self.sources.position(file, token.start as u32).line;
                    if line > last_line && wrong < WRONG_DIRECTIVES {
                        self.out.diagnostics.push(unknown_directive(file, token));
                    }
                    (wrong, last_line) = (wrong + 1, line);
                }
            }
        }
        Some(at)
    }

    fn import(&mut self, from: usize, beside: &Path, text: &str, path: Token) {
        let name = &text[path.start + 1..path.end - 1];
        let span = Span::new(self.units[from].file, path.start + 1, path.end - 1);
        match files::find(self.files, files::Kind::Shader, name, Some(beside)) {
            Ok(found) => {
                if let Some(to) = self.visit(found, Some((from, span))) {
                    self.units[from].imports.push(to);
                }
            }
            Err(missing) => self.not_found(name, Some(span), missing),
        }
    }

    fn not_found(&mut self, name: &str, span: Option<Span>, missing: NotFound) {
        let diagnostic = match (&missing.error, span) {
            (Some(error), span) => {
                let text = format!("`{name}` cannot be read: {error}");
                label(Diagnostic::error(Code::FILE_UNREADABLE, text), span, "named here")
            }
            (None, Some(span)) => Diagnostic::error(Code::IMPORT, format!("there is no shader `{name}` to import"))
                .at(span, "not found")
                .hint(looked_at(&missing.tried)),
            (None, None) => Diagnostic::error(Code::FILE_MISSING, format!("there is no shader `{name}`"))
                .hint(looked_at(&missing.tried)),
        };
        let diagnostic = match missing.error {
            None => suggest(diagnostic, name),
            Some(_) => diagnostic,
        };
        self.out.diagnostics.push(diagnostic);
        self.out.read.extend(missing.tried);
    }
}

fn label(diagnostic: Diagnostic, span: Option<Span>, text: &str) -> Diagnostic {
    match span {
        Some(span) => diagnostic.at(span, text),
        None => diagnostic,
    }
}

fn looked_at(tried: &[PathBuf]) -> String {
    let paths: Vec<String> = tried.iter().map(|p| format!("`{}`", p.display())).collect();
    format!("looked at {} and in the carried library", paths.join(", "))
}

/// Adds the library file whose name, whatever its folder, is the same or else nearest.
fn suggest(diagnostic: Diagnostic, name: &str) -> Diagnostic {
    let known: Vec<&str> = files::library().filter_map(|path| path.strip_prefix("shaders/")).collect();
    let by_stem = |stem: &str| known.iter().find(|path| stem_of(path) == stem).copied();
    let best =
        by_stem(stem_of(name)).or_else(|| by_stem(nearest(stem_of(name), known.iter().map(|path| stem_of(path)))?));
    match best {
        Some(best) => diagnostic.hint(format!("did you mean `{best}`?")),
        None => diagnostic,
    }
}

/// The name of a file without its folders and ending.
fn stem_of(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.strip_suffix(".wgsl").unwrap_or(file)
}

fn not_utf8(path: &str, bytes: &[u8], valid: usize, via: Option<(usize, Span)>) -> Diagnostic {
    let line = bytes[..valid].iter().filter(|b| **b == b'\n').count() + 1;
    let text = format!("`{path}` is not UTF-8 text: line {line} has bytes that are no character");
    let diagnostic = Diagnostic::error(Code::FILE_UNREADABLE, text);
    label(diagnostic, via.map(|(_, span)| span), "imported here").hint("save the file as UTF-8")
}

fn unknown_directive(file: FileId, token: Token) -> Diagnostic {
    Diagnostic::error(Code::IMPORT, "expected `#import \"file.wgsl\"` on a line of its own")
        .at(Span::new(file, token.start, token.end), "not an import")
        .hint("`#import` is the only directive that starts with `#`; there is no preprocessor")
}

/// How many wrong directives of a file are told of, one a line.
const WRONG_DIRECTIVES: usize = 20;

/// The paths of a file's imports, quotes included, or the `#` of what is no import.
fn imports<'a>(text: &'a str, scanned: &'a Scan) -> impl Iterator<Item = Result<Token, Token>> + 'a {
    let tokens = &scanned.tokens;
    let hashes = tokens.iter().enumerate().filter(|(_, t)| t.is(b'#'));
    hashes.map(move |(at, hash)| match tokens.get(at + 1..at + 3) {
        Some([word, path])
            if hash.starts_line
                && word.text(text) == "import"
                && path.kind == Kind::Text
                && path.end - path.start > 2
                && !word.starts_line
                && !path.starts_line
                && tokens.get(at + 3).is_none_or(|next| next.starts_line) =>
        {
            Ok(*path)
        }
        _ => Err(*hash),
    })
}

/// Directives that stand at module scope, semicolon included, as ranges of tokens.
fn directives(text: &str, scanned: &Scan) -> Vec<std::ops::Range<usize>> {
    let tokens = &scanned.tokens;
    let (mut depth, mut out) = (0_i32, Vec::new());
    for (at, token) in tokens.iter().enumerate() {
        depth += i32::from(token.is(b'{')) - i32::from(token.is(b'}'));
        let is_directive = token.kind == Kind::Word
            && matches!(token.text(text), "enable" | "requires" | "diagnostic")
            && (at == 0 || !tokens[at - 1].is(b'@'));
        if depth != 0 || !is_directive {
            continue;
        }
        // One without an end stays where it is; naga says what is wrong with it.
        let marks = |t: &Token| t.is(b';') || t.is(b'{') || t.is(b'#');
        match tokens[at..].iter().position(marks) {
            Some(length) if tokens[at + length].is(b';') => out.push(at..at + length + 1),
            _ => {}
        }
    }
    out
}

/// The whole: directives, then each file behind what it imports.
fn join(units: Vec<Unit>, texts: Vec<(Arc<str>, Scan)>, named: usize) -> Assembled {
    let mut joined = Joined { whole: String::new(), segments: Vec::new() };
    let mut bodies: Vec<Vec<u8>> = texts.iter().map(|(text, _)| text.as_bytes().to_vec()).collect();
    let order = imports_first(&units, named);
    let mut declarations = Declarations::default();
    for &at in &order {
        let (text, scanned) = &texts[at];
        for range in directives(text, scanned) {
            joined.hoist(at, text, &scanned.tokens[range.clone()]);
            let tokens = &scanned.tokens[range];
            blank(&mut bodies[at], tokens[0].start, tokens[tokens.len() - 1].end);
        }
        for path in imports(text, scanned).flatten() {
            let hash = scanned.tokens.iter().rfind(|t| t.is(b'#') && t.start < path.start);
            blank(&mut bodies[at], hash.map_or(path.start, |h| h.start), path.end);
        }
        declarations.add(units[at].file, text, scanned);
    }
    for at in order {
        // Blanking writes spaces over whole characters, so this is the text that came in.
        let body = String::from_utf8_lossy(&bodies[at]).into_owned();
        joined.push(at, 0, &body);
    }
    let map = SourceMap { units, segments: joined.segments, named };
    Assembled { whole: joined.whole, map, declarations, texts, named }
}

/// The units in the order of their texts. With a cycle, the file that closes it comes last.
fn imports_first(units: &[Unit], named: usize) -> Vec<usize> {
    let mut order = Vec::with_capacity(units.len());
    let mut seen = vec![false; units.len()];
    let mut open = vec![(named, 0)];
    seen[named] = true;
    while let Some((at, next)) = open.last_mut() {
        match units[*at].imports.get(*next) {
            Some(&import) => {
                *next += 1;
                if !std::mem::replace(&mut seen[import], true) {
                    open.push((import, 0));
                }
            }
            None => {
                order.push(*at);
                open.pop();
            }
        }
    }
    order
}

fn blank(body: &mut [u8], start: usize, end: usize) {
    for byte in &mut body[start..end] {
        if *byte != b'\n' {
            *byte = b' ';
        }
    }
}

struct Joined {
    whole: String,
    segments: Vec<Segment>,
}

impl Joined {
    fn push(&mut self, unit: usize, offset: usize, text: &str) {
        let whole = self.whole.len() as u32;
        self.segments.push(Segment { whole, length: text.len() as u32, unit, offset: offset as u32 });
        self.whole.push_str(text);
        // A file may end in a line comment.
        self.whole.push('\n');
    }

    /// Browsers require `enable subgroups;`, naga needs and knows no such word: it is left out.
    fn hoist(&mut self, unit: usize, text: &str, tokens: &[Token]) {
        let (start, end) = (tokens[0].start, tokens[tokens.len() - 1].end);
        let mut body = text.as_bytes()[start..end].to_vec();
        if tokens[0].text(text) == "enable" {
            let words = tokens.iter().filter(|t| t.kind == Kind::Word).count();
            for (at, token) in tokens.iter().enumerate().filter(|(_, t)| t.text(text) == "subgroups") {
                if words == 2 {
                    return;
                }
                let comma = tokens.get(at + 1).filter(|next| next.is(b','));
                blank(&mut body, token.start - start, comma.unwrap_or(token).end - start);
            }
        }
        let body = String::from_utf8_lossy(&body).into_owned();
        self.push(unit, start, &body);
    }
}
