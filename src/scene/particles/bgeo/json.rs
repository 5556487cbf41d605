//! Binary JSON: a stream of tokens, with strings that are defined once and named by a number, and
//! with arrays of one type in a row of bytes.

use std::collections::HashMap;
use std::rc::Rc;

use half::f16;

use crate::scene::particles::error::ReadError;
use crate::scene::particles::stream::Stream;
use crate::scene::particles::values::{Kind, Layout, Order, Values};

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Null,
    Bool(bool),
    Whole(i64),
    Real(f64),
    Text(Rc<str>),
    ArrayBegin,
    ArrayEnd,
    MapBegin,
    MapEnd,
    /// An array of one type; its data follow.
    Uniform(Items, usize),
}

/// What a uniform array holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Items {
    Numbers(Kind),
    Halves,
    /// In words of 32 bits, the lowest first.
    Bits,
    Text,
    TextNumbers,
}

pub(super) struct Json<'s, 'a> {
    pub stream: &'s mut Stream<'a>,
    order: Order,
    known: HashMap<usize, Rc<str>>,
}

const WHAT: &str = "binary JSON";
const MOST_TEXTS: usize = 16;

impl<'s, 'a> Json<'s, 'a> {
    pub fn new(stream: &'s mut Stream<'a>, order: Order) -> Self {
        Self { stream, order, known: HashMap::new() }
    }

    /// The next token. Definitions of strings and separators are read over.
    pub fn next(&mut self) -> Result<Token, ReadError> {
        loop {
            let at = self.stream.offset();
            return Ok(match self.byte()? {
                0x00 => Token::Null,
                0x10 => Token::Bool(self.byte()? != 0),
                0x11 => self.scalar(Kind::I8)?,
                0x12 => self.scalar(Kind::I16)?,
                0x13 => self.scalar(Kind::I32)?,
                0x14 => self.scalar(Kind::I64)?,
                0x18 => {
                    let bits = self.unsigned(2)?;
                    Token::Real(f16::from_bits(bits as u16).to_f64())
                }
                0x19 => self.scalar(Kind::F32)?,
                0x1a => self.scalar(Kind::F64)?,
                0x21 => self.scalar(Kind::U8)?,
                0x22 => self.scalar(Kind::U16)?,
                0x27 => Token::Text(self.text()?),
                0x30 => Token::Bool(false),
                0x31 => Token::Bool(true),
                0x26 => Token::Text(self.named_text()?),
                0x40 => self.uniform()?,
                0x5b => Token::ArrayBegin,
                0x5d => Token::ArrayEnd,
                0x7b => Token::MapBegin,
                0x7d => Token::MapEnd,
                0x2b => {
                    let id = self.length()?;
                    let text = self.text()?;
                    self.known.insert(id, text);
                    continue;
                }
                0x2d => {
                    let id = self.length()?;
                    self.known.remove(&id);
                    continue;
                }
                // Separators of keys and of values.
                0x3a | 0x2c => continue,
                other => return Err(self.stream.error_at(at, format!("{WHAT}: no token begins with {other:#04x}"))),
            });
        }
    }

    /// Reads over the value that begins with `token`.
    pub fn skip(&mut self, token: Token) -> Result<(), ReadError> {
        let mut depth = 0_usize;
        let mut token = token;
        loop {
            match token {
                Token::ArrayBegin | Token::MapBegin => depth += 1,
                Token::ArrayEnd | Token::MapEnd if depth == 0 => {
                    return Err(self.stream.error(format!("{WHAT}: expected a value, found an end")));
                }
                Token::ArrayEnd | Token::MapEnd => depth -= 1,
                Token::Uniform(items, count) => self.skip_items(items, count)?,
                _ => {}
            }
            if depth == 0 {
                return Ok(());
            }
            token = self.next()?;
        }
    }

    /// Expects the begin of a list or a map of keys and values.
    pub fn begin(&mut self) -> Result<(), ReadError> {
        match self.next()? {
            Token::ArrayBegin | Token::MapBegin => Ok(()),
            other => Err(self.unexpected("an array", &other)),
        }
    }

    /// The next key of a list of keys and values, or none at its end.
    pub fn key(&mut self) -> Result<Option<Rc<str>>, ReadError> {
        match self.next()? {
            Token::Text(key) => Ok(Some(key)),
            Token::ArrayEnd | Token::MapEnd => Ok(None),
            other => Err(self.unexpected("a key", &other)),
        }
    }

    pub fn expect_text(&mut self) -> Result<Rc<str>, ReadError> {
        match self.next()? {
            Token::Text(text) => Ok(text),
            other => Err(self.unexpected("a string", &other)),
        }
    }

    pub fn expect_count(&mut self) -> Result<usize, ReadError> {
        match self.next()? {
            Token::Whole(whole) if whole >= 0 => Ok(whole as usize),
            other => Err(self.unexpected("a count", &other)),
        }
    }

    /// All numbers of the value that begins with `token`, however it is nested.
    pub fn numbers(&mut self, token: Token, kind: Kind) -> Result<Values, ReadError> {
        let mut values = Values::empty(kind);
        let mut depth = 0_usize;
        let mut token = token;
        loop {
            match token {
                Token::ArrayBegin => depth += 1,
                Token::ArrayEnd if depth > 0 => depth -= 1,
                Token::Whole(whole) => values.push_whole(whole),
                Token::Real(real) => values.push_real(real),
                Token::Bool(truth) => values.push_whole(truth.into()),
                Token::Uniform(items, count) => self.items(items, count, &mut values)?,
                other => return Err(self.unexpected("a number", &other)),
            }
            if depth == 0 {
                return Ok(values);
            }
            token = self.next()?;
        }
    }

    /// The first texts of a list of texts: a few tell a person enough, and a small file can name
    /// a long one many times.
    pub fn texts(&mut self, token: Token) -> Result<Vec<String>, ReadError> {
        let mut all = Vec::new();
        match token {
            Token::ArrayBegin => loop {
                match self.next()? {
                    Token::Text(text) if all.len() < MOST_TEXTS => all.push(text.to_string()),
                    Token::Text(_) => {}
                    Token::ArrayEnd => return Ok(all),
                    other => return Err(self.unexpected("a string", &other)),
                }
            },
            Token::Uniform(Items::Text, count) => {
                for _ in 0..count {
                    let text = self.text()?;
                    all.extend((all.len() < MOST_TEXTS).then(|| text.to_string()));
                }
            }
            Token::Uniform(Items::TextNumbers, count) => {
                for _ in 0..count {
                    let text = self.named_text()?;
                    all.extend((all.len() < MOST_TEXTS).then(|| text.to_string()));
                }
            }
            other => return Err(self.unexpected("a list of strings", &other)),
        }
        Ok(all)
    }

    pub fn unexpected(&self, expected: &str, found: &Token) -> ReadError {
        let found = match found {
            Token::Null => "null".to_owned(),
            Token::Bool(truth) => truth.to_string(),
            Token::Whole(whole) => whole.to_string(),
            Token::Real(real) => real.to_string(),
            Token::Text(text) => format!("`{}`", text.chars().take(40).collect::<String>().escape_debug()),
            Token::ArrayBegin | Token::Uniform(..) => "an array".to_owned(),
            Token::MapBegin => "a map".to_owned(),
            Token::ArrayEnd | Token::MapEnd => "an end".to_owned(),
        };
        self.stream.error(format!("{WHAT}: expected {expected}, found {found}"))
    }

    fn items(&mut self, items: Items, count: usize, values: &mut Values) -> Result<(), ReadError> {
        let order = self.order;
        let items_kind = match items {
            Items::Numbers(kind) => kind,
            Items::Halves => Kind::U16,
            Items::Bits => Kind::U32,
            Items::Text | Items::TextNumbers => {
                return Err(self.stream.error(format!("{WHAT}: expected numbers, found strings")));
            }
        };
        let stored = if items == Items::Bits { count.div_ceil(32) } else { count };
        let bytes = self.stream.take(stored.saturating_mul(items_kind.size()), WHAT)?;
        if items == Items::Numbers(values.kind()) {
            values.extend(bytes, order);
            return Ok(());
        }
        let layout = Layout { start: 0, stride: items_kind.size(), components: 1 };
        let found = Values::gather(items_kind, bytes, layout, stored, order);
        match (items, &found) {
            (Items::Halves, Values::U16(halves)) => {
                halves.iter().for_each(|&bits| values.push_real(f16::from_bits(bits).to_f64()));
            }
            (Items::Bits, Values::U32(words)) => {
                (0..count).for_each(|i| values.push_whole((words[i / 32] >> (i % 32) & 1).into()));
            }
            (_, Values::I64(wholes)) => wholes.iter().for_each(|&whole| values.push_whole(whole)),
            _ => found.to_f64().into_iter().for_each(|real| values.push_real(real)),
        }
        Ok(())
    }

    fn skip_items(&mut self, items: Items, count: usize) -> Result<(), ReadError> {
        let size = match items {
            Items::Numbers(kind) => count.saturating_mul(kind.size()),
            Items::Halves => count.saturating_mul(2),
            Items::Bits => count.div_ceil(32) * 4,
            Items::Text | Items::TextNumbers => {
                for _ in 0..count {
                    let length = self.length()?;
                    if items == Items::Text {
                        self.stream.take(length, WHAT)?;
                    }
                }
                0
            }
        };
        self.stream.take(size, WHAT).map(|_| ())
    }

    fn uniform(&mut self) -> Result<Token, ReadError> {
        let at = self.stream.offset();
        let items = match self.byte()? {
            0x10 => Items::Bits,
            0x11 => Items::Numbers(Kind::I8),
            0x12 => Items::Numbers(Kind::I16),
            0x13 => Items::Numbers(Kind::I32),
            0x14 => Items::Numbers(Kind::I64),
            0x18 => Items::Halves,
            0x19 => Items::Numbers(Kind::F32),
            0x1a => Items::Numbers(Kind::F64),
            0x21 => Items::Numbers(Kind::U8),
            0x22 => Items::Numbers(Kind::U16),
            0x27 => Items::Text,
            0x26 => Items::TextNumbers,
            other => {
                return Err(self.stream.error_at(at, format!("{WHAT}: no array holds items of type {other:#04x}")));
            }
        };
        Ok(Token::Uniform(items, self.length()?))
    }

    fn scalar(&mut self, kind: Kind) -> Result<Token, ReadError> {
        let order = self.order;
        let mut value = Values::empty(kind);
        value.extend(self.stream.take(kind.size(), WHAT)?, order);
        Ok(match value {
            Values::I64(v) => Token::Whole(v.first().copied().unwrap_or_default()),
            other if kind.is_float() => Token::Real(other.uniform().unwrap_or(f64::NAN)),
            other => Token::Whole(other.uniform().unwrap_or_default() as i64),
        })
    }

    fn named_text(&mut self) -> Result<Rc<str>, ReadError> {
        let id = self.length()?;
        let text = self.known.get(&id).cloned();
        text.ok_or_else(|| self.stream.error(format!("{WHAT}: string {id} was not defined")))
    }

    fn text(&mut self) -> Result<Rc<str>, ReadError> {
        let length = self.length()?;
        Ok(String::from_utf8_lossy(self.stream.take(length, WHAT)?).into())
    }

    /// A length takes one byte, or a byte that tells its size and then 2, 4 or 8.
    fn length(&mut self) -> Result<usize, ReadError> {
        let at = self.stream.offset();
        let length = match self.byte()? {
            short @ 0..=0xf0 => u64::from(short),
            0xf2 => self.unsigned(2)?,
            0xf4 => self.unsigned(4)?,
            0xf8 => self.unsigned(8)?,
            other => return Err(self.stream.error_at(at, format!("{WHAT}: no length begins with {other:#04x}"))),
        };
        usize::try_from(length).map_err(|_| self.stream.error_at(at, format!("{WHAT}: a length of {length}")))
    }

    fn unsigned(&mut self, size: usize) -> Result<u64, ReadError> {
        let order = self.order;
        let bytes = self.stream.take(size, WHAT)?;
        let append = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        Ok(match order {
            Order::Big => bytes.iter().fold(0, append),
            Order::Little => bytes.iter().rev().fold(0, append),
        })
    }

    fn byte(&mut self) -> Result<u8, ReadError> {
        Ok(self.stream.take(1, WHAT)?.first().copied().unwrap_or_default())
    }
}
