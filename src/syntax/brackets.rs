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
    let layout = places(text, tokens);
    let as_written = find_marks(tokens, &layout, false);
    if simulate(&as_written, 0).repairs.is_empty() {
        return Repairs::default();
    }
    let opened = find_marks(tokens, &layout, true);
    let (first, second) = (search(&as_written), search(&opened));
    let (marks, best) = if second.cost <= first.cost { (opened, second) } else { (as_written, first) };
    let openers = best.pairs.iter().map(|(o, c)| (marks[*c].token, marks[*o].token)).collect();
    let partners = best.pairs.iter().map(|(o, c)| (marks[*o].token, marks[*c].token)).collect();
    let mut mender = Mender {
        tokens,
        places: &layout,
        marks: &marks,
        pairs: &best.pairs,
        partners,
        openers,
        edits: Vec::new(),
        repairs: Repairs::default(),
    };
    best.pairs.iter().filter(|(open, _)| marks[*open].is_lost).for_each(|(o, c)| mender.open(marks[*o].token, *c));
    best.repairs.iter().take(MENDED).for_each(|repair| mender.mend(*repair));
    let Mender { edits, repairs, .. } = mender;
    let mended = apply(edits, tokens);
    let holds = simulate(&find_marks(&mended, &places(text, &mended), false), 0).repairs.is_empty();
    if best.repairs.len() <= MENDED && holds {
        *tokens = mended;
    } else {
        // Hardly RON: say what was found, read nothing.
        tokens.drain(..tokens.len() - 1);
    }
    repairs
}

/// The best way to match brackets.
fn search(marks: &[Mark]) -> Outcome {
    let ways = if marks.len() > 20_000 { 1 } else { 3u32.pow(TRIED) };
    (0..ways).map(|way| simulate(marks, way)).min_by_key(|outcome| outcome.cost).unwrap_or_default()
}

/// The tokens with the edits made.
fn apply(mut edits: Vec<Edit>, tokens: &[Token]) -> Vec<Token> {
    // At one place brackets close before others open, and inner ones close first.
    edits.sort_by_key(|edit| match edit {
        Edit::Close { at, opener, .. } => (*at, 0, std::cmp::Reverse(*opener)),
        Edit::Open(at, _) => (*at, 1, std::cmp::Reverse(0)),
        Edit::Remove(at) | Edit::Replace(at, _) => (*at, 2, std::cmp::Reverse(0)),
    });
    let mut edits = edits.into_iter().peekable();
    let mut out = Vec::with_capacity(tokens.len());
    for (i, token) in tokens.iter().enumerate() {
        let mut kept = Some(token.clone());
        while let Some(edit) = edits.next_if(|edit| edit.at() == i) {
            let start = token.range.start;
            match edit {
                Edit::Close { bracket, .. } => out.push(Token { kind: TokenKind::Close(bracket), range: start..start }),
                Edit::Open(_, bracket) => {
                    let end = out.last().map_or(start, |before: &Token| before.range.end);
                    out.push(Token { kind: TokenKind::Open(bracket), range: end..end });
                }
                Edit::Remove(_) => kept = None,
                Edit::Replace(_, bracket) => {
                    kept = Some(Token { kind: TokenKind::Close(bracket), range: token.range.clone() });
                }
            }
        }
        out.extend(kept);
    }
    out
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
    /// It is not there, but should be, before the token.
    is_lost: bool,
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

/// The brackets, and with `opened` also an opening one where one is certainly lacking.
fn find_marks(tokens: &[Token], places: &[Place], opened: bool) -> Vec<Mark> {
    let mut marks = Vec::new();
    for (token, t) in tokens.iter().enumerate() {
        let place = places[token];
        if opened && lacks_opener(tokens, token) {
            marks.push(Mark { token, bracket: Bracket::Round, opens: true, is_lost: true, place });
        }
        if let TokenKind::Open(bracket) | TokenKind::Close(bracket) = t.kind {
            let opens = matches!(t.kind, TokenKind::Open(_));
            marks.push(Mark { token, bracket, opens, is_lost: false, place });
        }
    }
    marks
}

/// Whether a round bracket should open before a token: after the word in `each: Texel "z")`, and
/// before a tuple as in `default: 0.5, 0.5), unit: "m"`.
fn lacks_opener(tokens: &[Token], token: usize) -> bool {
    let kind = |at: Option<usize>| at.and_then(|at| tokens.get(at)).map(|t| &t.kind);
    let is_literal =
        |at: usize| matches!(kind(Some(at)), Some(TokenKind::Int(_) | TokenKind::Float(_) | TokenKind::Str(..)));
    let follows_colon = |at: Option<usize>| kind(at) == Some(&TokenKind::Colon);
    let after_word = matches!(kind(token.checked_sub(1)), Some(TokenKind::Ident(_)))
        && follows_colon(token.checked_sub(2))
        && (is_literal(token) || matches!(kind(Some(token)), Some(TokenKind::Ident(_) | TokenKind::Char(_))));
    let in_tuple = follows_colon(token.checked_sub(1))
        && is_literal(token)
        && kind(Some(token + 1)) == Some(&TokenKind::Comma)
        && is_literal(token + 2)
        && kind(Some(token + 3)) != Some(&TokenKind::Colon);
    after_word || in_tuple
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
    let mut open_of = [0usize; 3];
    let (mut way, mut decided) = (way, 0);
    let mut i = 0;
    while i < marks.len() {
        let mark = marks[i];
        if mark.opens {
            stack.push(i);
            open_of[mark.bracket as usize] += 1;
            out.cost += 1000 * usize::from(mark.is_lost);
            i += 1;
            continue;
        }
        let top = stack.last().copied();
        if let Some(open) = top.filter(|open| marks[*open].bracket == mark.bracket) {
            stack.pop();
            open_of[mark.bracket as usize] -= 1;
            out.cost += usize::from(mark.place.is_first && marks[open].place.indent != mark.place.indent);
            out.pairs.push((open, i));
            i += 1;
            continue;
        }
        let choice = if decided < TRIED { way % 3 } else { u32::from(open_of[mark.bracket as usize] == 0) };
        (way, decided) = (way / 3, decided + 1);
        out.cost += 1000;
        if let (0 | 2, Some(open)) = (choice, top) {
            open_of[marks[open].bracket as usize] -= 1;
        }
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
    /// A closing bracket before the token, for the one that opens at another.
    Close {
        at: usize,
        opener: usize,
        bracket: Bracket,
    },
    /// An opening bracket before the token.
    Open(usize, Bracket),
    Remove(usize),
    Replace(usize, Bracket),
}

impl Edit {
    fn at(&self) -> usize {
        match self {
            Edit::Close { at, .. } | Edit::Open(at, _) | Edit::Remove(at) | Edit::Replace(at, _) => *at,
        }
    }
}

/// How an entry of a bracket begins.
#[derive(Clone, Copy, PartialEq)]
enum Sort {
    /// `name:`
    Field,
    /// `"name":`
    Key,
    Item,
}

struct Mender<'a> {
    tokens: &'a [Token],
    places: &'a [Place],
    marks: &'a [Mark],
    pairs: &'a [(usize, usize)],
    /// The token that closes what a token opens.
    partners: HashMap<usize, usize>,
    /// The token that opens what a token closes.
    openers: HashMap<usize, usize>,
    edits: Vec<Edit>,
    repairs: Repairs,
}

impl Mender<'_> {
    fn mend(&mut self, repair: Repair) {
        match repair {
            Repair::Unclosed(open, before) if !self.marks[open].is_lost => self.close(open, before),
            Repair::Unclosed(..) => {}
            Repair::Stray(close, open) => match self.lost_opener(close, open) {
                Some(at) => self.open(at, close),
                None => self.drop(close, open),
            },
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

    /// Takes a closing bracket away.
    fn drop(&mut self, close: usize, open: Option<usize>) {
        let (at, bracket) = (self.marks[close].token, self.marks[close].bracket);
        let range = self.tokens[at].range.clone();
        let label = match open {
            Some(open) => format!("a `{}` is open here", self.marks[open].bracket.open()),
            None => "nothing is open here".into(),
        };
        let what = format!("a `{}` closes nothing", bracket.close());
        self.repairs.faults.push(Fault::new(range.clone(), what, label).hint("remove it"));
        self.repairs.disturbed.push(range);
        self.edits.push(Edit::Remove(at));
    }

    /// Opens a bracket before a token, for a closing one that has no partner.
    fn open(&mut self, at: usize, close: usize) {
        let closer = self.marks[close];
        let gap = self.tokens[at - 1].range.end;
        let what = format!("a `{}` is missing", closer.bracket.open());
        let fault = Fault::new(gap..gap, what, format!("a `{}` is expected here", closer.bracket.open()));
        self.repairs.faults.push(fault.see(self.tokens[closer.token].range.clone(), "this closes it"));
        self.edits.push(Edit::Open(at, closer.bracket));
    }

    /// Before which token an opening bracket was lost, if the tokens tell: a word that is followed
    /// by something other than its bracket, fields in a list, a field whose value goes on after a
    /// comma without a name.
    fn lost_opener(&self, close: usize, open: Option<usize>) -> Option<usize> {
        let first = open.map_or(0, |open| self.marks[open].token + 1);
        let mut at = self.marks[close].token;
        let mut run = None;
        while at > first {
            at -= 1;
            if let Some(opener) = self.openers.get(&at).filter(|opener| **opener >= first) {
                at = *opener;
                continue;
            }
            let next = &self.tokens[at + 1].kind;
            match (self.marks[close].bracket, &self.tokens[at].kind) {
                (Bracket::Round, TokenKind::Ident(_)) => {
                    if next.starts_value() && *next != TokenKind::Open(Bracket::Round) {
                        return Some(at + 1);
                    }
                    if *next == TokenKind::Colon {
                        run = Some(at);
                    }
                }
                (Bracket::Square | Bracket::Curly, TokenKind::Colon) => {
                    let is_field = at > first && matches!(self.tokens[at - 1].kind, TokenKind::Ident(_));
                    if is_field && at + 1 < self.marks[close].token {
                        return Some(at + 1);
                    }
                }
                _ => {}
            }
        }
        // Fields that stand in a list lack their bracket.
        let in_list = open.is_some_and(|open| self.marks[open].bracket == Bracket::Square);
        run.filter(|_| in_list)
    }

    /// Closes a bracket where its block ends by indentation, else just before what shows that
    /// it is not closed.
    fn close(&mut self, open: usize, before: Option<usize>) {
        let (open, before) = self.culprit(open, before);
        let mark = self.marks[open];
        let latest = before.map_or(self.tokens.len() - 1, |close| self.marks[close].token);
        let by_layout = self.block_end(open, latest).into_iter().chain(self.change(mark, latest)).min();
        let at = self.nested(mark.token, by_layout.unwrap_or(latest));
        let opener = self.tokens[mark.token].range.clone();
        let what = format!("a `{}` is never closed", mark.bracket.open());
        let found = match &self.tokens[at].kind {
            TokenKind::Comma => format!("a `{}` is missing before this", mark.bracket.close()),
            kind => format!("a `{}` is missing before {}", mark.bracket.close(), kind.describe()),
        };
        self.repairs
            .faults
            .push(Fault::new(opener.clone(), what, "this opens it").see(self.tokens[at].range.clone(), found));
        self.repairs.disturbed.push(match by_layout {
            Some(_) => self.tokens[at].range.clone(),
            None if before.is_none() => self.tokens[at].range.clone(),
            None => opener.start..self.tokens[at].range.end,
        });
        self.edits.push(Edit::Close { at, opener: mark.token, bracket: mark.bracket });
    }

    /// Moves the end of a bracket so that it neither cuts one that was closed inside it nor leaves
    /// one that was closed around it.
    fn nested(&self, opener: usize, at: usize) -> usize {
        let closed = self.edits.iter().filter_map(|edit| match edit {
            Edit::Close { at, opener, .. } => Some((*opener, *at)),
            _ => None,
        });
        closed.fold(at, |at, (other, end)| match other > opener {
            true if other < at => at.max(end),
            false if end > opener => at.min(end),
            _ => at,
        })
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
                if inner.bracket != outer.bracket {
                    return false;
                }
                let took = closer.place.is_first
                    && closer.place.indent == outer.place.indent
                    && inner.place.indent > closer.place.indent;
                took || self.change(inner, closer.token).is_some()
            });
            match thief {
                Some((o, c)) => (open, before) = (*o, Some(*c)),
                None => return (open, before),
            }
        }
    }

    /// The comma after which the entries of a bracket are of another sort than belongs in it: a
    /// list has no names, a map none without quotes, and a tuple that began without names has none.
    fn change(&self, mark: Mark, latest: usize) -> Option<usize> {
        let sort = |at: usize| {
            let has_colon = self.tokens.get(at + 1).is_some_and(|next| next.kind == TokenKind::Colon);
            match self.tokens[at].kind {
                TokenKind::Ident(_) if has_colon => Sort::Field,
                TokenKind::Str(..) if has_colon => Sort::Key,
                _ => Sort::Item,
            }
        };
        let first = sort(mark.token + 1);
        let mut at = mark.token + 1;
        while at < latest {
            if self.tokens[at].kind == TokenKind::Comma {
                let is_other = match (mark.bracket, sort(at + 1)) {
                    (_, Sort::Item) | (Bracket::Curly, Sort::Key) => false,
                    (Bracket::Square | Bracket::Curly, _) | (Bracket::Round, Sort::Key) => true,
                    (Bracket::Round, Sort::Field) => first == Sort::Item,
                };
                if is_other {
                    return Some(at);
                }
            }
            at = self.partners.get(&at).filter(|close| **close < latest).map_or(at + 1, |close| close + 1);
        }
        None
    }

    /// The first token after an opening bracket that begins a line no deeper than the line of the
    /// bracket, not inside brackets that match; or the comma before it, if there is one.
    fn block_end(&self, open: usize, latest: usize) -> Option<usize> {
        let mark = self.marks[open];
        let mut at = mark.token + 1;
        while at < latest {
            let place = self.places[at];
            if place.is_first && place.indent <= mark.place.indent {
                let is_comma = |at: usize| self.tokens[at].kind == TokenKind::Comma;
                let after_comma = is_comma(at - 1) && at - 1 > mark.token && !is_comma(at);
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
