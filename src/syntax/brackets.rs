//! Brackets that do not match: which one is to blame, and tokens in which they do.
//!
//! The parser then never sees an imbalance, so one missing bracket is one message and what
//! stands around it is still read. Which repair is meant is judged by how few are needed, then by
//! how well the result agrees with the file's indentation.

use std::collections::HashMap;
use std::ops::Range;

use super::lexer::{Bracket, Token, TokenKind};
use super::literal::Fault;

/// How many mismatches are tried in every way; further ones are mended greedily.
const TRIED: u32 = 5;

/// How many mistakes are told and mended.
const MENDED: usize = 20;

/// What was repaired.
#[derive(Default)]
pub(super) struct Repairs {
    pub faults: Vec<Fault>,
    /// Byte ranges in which complaints of the parser are likely to follow from the repair.
    pub disturbed: Vec<Range<usize>>,
}

/// Makes the brackets of `tokens` match.
pub(super) fn balance(text: &str, tokens: &mut Vec<Token>) -> Repairs {
    let places = places(text, tokens);
    let marks = marks(tokens, &places);
    if simulate(&marks, 0).repairs.is_empty() {
        return Repairs::default();
    }
    let ways = if marks.len() > 100_000 { 1 } else { 3u32.pow(TRIED) };
    let best = (0..ways).map(|way| simulate(&marks, way)).min_by_key(|outcome| outcome.cost).unwrap_or_default();
    let partners = best.pairs.iter().map(|(o, c)| (marks[*o].token, marks[*c].token)).collect();
    let mut mender = Mender {
        tokens,
        places: &places,
        marks: &marks,
        pairs: &best.pairs,
        partners,
        edits: Vec::new(),
        repairs: Repairs::default(),
    };
    best.repairs.iter().take(MENDED).for_each(|repair| mender.mend(*repair));
    let Mender { edits, repairs, .. } = mender;
    if best.repairs.len() > MENDED {
        // Hardly RON: say what was found, read nothing.
        tokens.drain(..tokens.len() - 1);
    } else {
        apply(edits, tokens);
    }
    repairs
}

fn apply(mut edits: Vec<Edit>, tokens: &mut Vec<Token>) {
    // From the end, so that positions stay right; where several close at one place, the inner
    // ones come first in `edits` and must end up first.
    edits.reverse();
    edits.sort_by_key(|edit| std::cmp::Reverse(edit.at()));
    for edit in edits {
        match edit {
            Edit::Insert(at, bracket) => {
                let start = tokens[at].range.start;
                tokens.insert(at, Token { kind: TokenKind::Close(bracket), range: start..start });
            }
            Edit::Remove(at) => _ = tokens.remove(at),
            Edit::Replace(at, bracket) => tokens[at].kind = TokenKind::Close(bracket),
        }
    }
}

/// How a token stands on its line.
#[derive(Clone, Copy)]
struct Place {
    /// Column of the first token of the line.
    indent: usize,
    is_first: bool,
}

/// A bracket among the tokens.
#[derive(Clone, Copy)]
struct Mark {
    token: usize,
    bracket: Bracket,
    opens: bool,
    place: Place,
}

fn places(text: &str, tokens: &[Token]) -> Vec<Place> {
    let (mut line_end, mut indent) = (0, 0);
    let place = |(i, t): (usize, &Token)| {
        let is_first = i == 0 || t.range.start >= line_end;
        if is_first {
            (indent, line_end) = line(text, t.range.start);
        }
        if t.range.end > line_end {
            line_end = line(text, t.range.end).1;
        }
        Place { indent, is_first }
    };
    tokens.iter().enumerate().map(place).collect()
}

fn marks(tokens: &[Token], places: &[Place]) -> Vec<Mark> {
    let mark = |(token, t): (usize, &Token)| match t.kind {
        TokenKind::Open(bracket) => Some(Mark { token, bracket, opens: true, place: places[token] }),
        TokenKind::Close(bracket) => Some(Mark { token, bracket, opens: false, place: places[token] }),
        _ => None,
    };
    tokens.iter().enumerate().filter_map(mark).collect()
}

/// The column (in bytes) and the end of the line of an offset.
fn line(text: &str, at: usize) -> (usize, usize) {
    let start = text[..at].rfind('\n').map_or(0, |i| i + 1);
    (at - start, text[at..].find('\n').map_or(text.len(), |i| at + i + 1))
}

#[derive(Clone, Copy)]
enum Repair {
    /// The opening mark has no partner; it would have to come before this mark, or the end.
    Unclosed(usize, Option<usize>),
    /// The closing mark has no partner; the mark that is open there.
    Stray(usize, Option<usize>),
    /// The opening mark is closed by a mark of another kind.
    Unlike(usize, usize),
}

#[derive(Default)]
struct Outcome {
    cost: usize,
    repairs: Vec<Repair>,
    /// Opening and closing marks, inner ones first.
    pairs: Vec<(usize, usize)>,
}

/// Matches brackets; `way` has a digit of base 3 for each of the first mismatches.
fn simulate(marks: &[Mark], way: u32) -> Outcome {
    let mut out = Outcome::default();
    let mut stack: Vec<usize> = Vec::new();
    let (mut way, mut decided) = (way, 0);
    let mut i = 0;
    while i < marks.len() {
        let mark = marks[i];
        if mark.opens {
            stack.push(i);
            i += 1;
            continue;
        }
        let top = stack.last().copied();
        if let Some(open) = top.filter(|open| marks[*open].bracket == mark.bracket) {
            stack.pop();
            out.cost += usize::from(mark.place.is_first && marks[open].place.indent != mark.place.indent);
            out.pairs.push((open, i));
            i += 1;
            continue;
        }
        let is_open_below = stack.iter().any(|open| marks[*open].bracket == mark.bracket);
        let choice = if decided < TRIED { way % 3 } else { u32::from(!is_open_below) };
        (way, decided) = (way / 3, decided + 1);
        out.cost += 1000;
        match (choice, top) {
            (0, Some(open)) => {
                stack.pop();
                out.repairs.push(Repair::Unclosed(open, Some(i)));
            }
            (2, Some(open)) => {
                stack.pop();
                out.cost += 10 + usize::from(mark.place.is_first && marks[open].place.indent != mark.place.indent);
                out.repairs.push(Repair::Unlike(open, i));
                out.pairs.push((open, i));
                i += 1;
            }
            _ => {
                out.repairs.push(Repair::Stray(i, top));
                i += 1;
            }
        }
    }
    out.cost += 1000 * stack.len();
    out.repairs.extend(stack.iter().rev().map(|open| Repair::Unclosed(*open, None)));
    out
}

enum Edit {
    /// Before the token.
    Insert(usize, Bracket),
    Remove(usize),
    Replace(usize, Bracket),
}

impl Edit {
    fn at(&self) -> usize {
        match self {
            Edit::Insert(at, _) | Edit::Remove(at) | Edit::Replace(at, _) => *at,
        }
    }
}

struct Mender<'a> {
    tokens: &'a [Token],
    places: &'a [Place],
    marks: &'a [Mark],
    pairs: &'a [(usize, usize)],
    /// The token that closes what a token opens.
    partners: HashMap<usize, usize>,
    edits: Vec<Edit>,
    repairs: Repairs,
}

impl Mender<'_> {
    fn mend(&mut self, repair: Repair) {
        match repair {
            Repair::Unclosed(open, before) => self.close(open, before),
            Repair::Stray(close, open) => {
                let (at, bracket) = (self.marks[close].token, self.marks[close].bracket);
                let range = self.tokens[at].range.clone();
                let what = format!("a `{}` closes nothing", bracket.close());
                let label = match open {
                    Some(open) => format!("a `{}` is open here", self.marks[open].bracket.open()),
                    None => "nothing is open here".into(),
                };
                self.repairs.faults.push(Fault::new(range.clone(), what, label).hint("remove it"));
                self.repairs.disturbed.push(range);
                self.edits.push(Edit::Remove(at));
            }
            Repair::Unlike(open, close) => {
                let (opener, closer) = (self.marks[open], self.marks[close]);
                let what = format!("a `{}` is closed by a `{}`", opener.bracket.open(), closer.bracket.close());
                let range = self.tokens[closer.token].range.clone();
                let fault = Fault::new(range, what, format!("`{}` is expected here", opener.bracket.close()))
                    .see(self.tokens[opener.token].range.clone(), "this is open");
                self.repairs.faults.push(fault);
                self.edits.push(Edit::Replace(closer.token, opener.bracket));
            }
        }
    }

    /// Closes a bracket where its block ends by indentation, else just before what shows that
    /// it is not closed.
    fn close(&mut self, open: usize, before: Option<usize>) {
        let (open, before) = self.culprit(open, before);
        let mark = self.marks[open];
        let latest = before.map_or(self.tokens.len() - 1, |close| self.marks[close].token);
        let by_indent = self.block_end(open, latest);
        let at = by_indent.unwrap_or(latest);
        let opener = self.tokens[mark.token].range.clone();
        let what = format!("a `{}` is never closed", mark.bracket.open());
        let found = match &self.tokens[at].kind {
            TokenKind::Comma => format!("a `{}` is missing before this", mark.bracket.close()),
            kind => format!("a `{}` is missing before {}", mark.bracket.close(), kind.describe()),
        };
        self.repairs
            .faults
            .push(Fault::new(opener.clone(), what, "this opens it").see(self.tokens[at].range.clone(), found));
        self.repairs.disturbed.push(match by_indent {
            Some(_) => self.tokens[at].range.clone(),
            None if before.is_none() => self.tokens[at].range.clone(),
            None => opener.start..self.tokens[at].range.end,
        });
        self.edits.push(Edit::Insert(at, mark.bracket));
    }

    /// The bracket that is open for too long is often not the one that lacks its partner: inside
    /// it, one that took a partner at the indentation of the outer one is to blame.
    fn culprit(&self, open: usize, before: Option<usize>) -> (usize, Option<usize>) {
        let (mut open, mut before) = (open, before);
        loop {
            let outer = self.marks[open];
            let end = before.unwrap_or(self.marks.len());
            let thief = self.pairs.iter().filter(|(o, c)| open < *o && *c < end).find(|(o, c)| {
                let (inner, closer) = (self.marks[*o], self.marks[*c]);
                inner.bracket == outer.bracket
                    && closer.place.is_first
                    && closer.place.indent == outer.place.indent
                    && inner.place.indent > closer.place.indent
            });
            match thief {
                Some((o, c)) => (open, before) = (*o, Some(*c)),
                None => return (open, before),
            }
        }
    }

    /// The first token after an opening bracket that begins a line no deeper than the line of the
    /// bracket, not inside brackets that match; or the comma before it, if there is one.
    fn block_end(&self, open: usize, latest: usize) -> Option<usize> {
        let mark = self.marks[open];
        let mut at = mark.token + 1;
        while at < latest {
            let place = self.places[at];
            if place.is_first && place.indent <= mark.place.indent {
                let after_comma = self.tokens[at - 1].kind == TokenKind::Comma && at - 1 > mark.token;
                return Some(if after_comma { at - 1 } else { at });
            }
            at = match self.partners.get(&at) {
                Some(close) if *close < latest => close + 1,
                _ => at + 1,
            };
        }
        None
    }
}
