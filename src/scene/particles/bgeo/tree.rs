//! The new generation: geometry as binary JSON, of which the point attributes and single numbers
//! for the whole file are read.

use super::json::{Json, Token};
use super::numbered_texts;
use crate::scene::particles::Attribute;
use crate::scene::particles::error::{ReadError, counted};
use crate::scene::particles::finish::Found;
use crate::scene::particles::stream::Stream;
use crate::scene::particles::values::{Kind, Order, Values};

/// Values that are alike are stored once a page, so rows can take more memory than they have
/// bytes in the file; this is how many times as much they may.
const MOST_UNPACKED: usize = 64;

struct Reader<'s, 'a> {
    json: Json<'s, 'a>,
    points: Option<usize>,
    attributes: Vec<Attribute>,
    globals: Vec<(String, f64)>,
    notes: Vec<String>,
    /// Bytes of all attributes so far.
    unpacked: usize,
}

/// Reads what follows the magic number.
pub(super) fn read(stream: &mut Stream<'_>, order: Order) -> Result<Found, ReadError> {
    let json = Json::new(stream, order);
    let mut reader =
        Reader { json, points: None, attributes: Vec::new(), globals: Vec::new(), notes: Vec::new(), unpacked: 0 };
    reader.json.begin()?;
    while let Some(key) = reader.json.key()? {
        match &*key {
            "pointcount" => reader.points = Some(reader.json.expect_count()?),
            "attributes" => reader.attributes()?,
            _ => reader.skip()?,
        }
    }
    let Some(index) = reader.attributes.iter().position(|a| a.name == "P") else {
        return Err(reader.json.stream.error("expected a point attribute `P`, found none"));
    };
    let position = reader.attributes.remove(index);
    let mut found = Found::new(three(position, &reader.json)?);
    found.attributes = reader.attributes;
    found.globals = reader.globals;
    found.notes = reader.notes;
    Ok(found)
}

/// The first three of the three or four numbers that a position has.
fn three(position: Attribute, json: &Json<'_, '_>) -> Result<Values, ReadError> {
    let Attribute { components, mut values, .. } = position;
    match components {
        3 => Ok(values),
        4 => {
            let keep: Vec<bool> = (0..values.len()).map(|index| index % 4 < 3).collect();
            values.retain_rows(&keep, 1);
            Ok(values)
        }
        other => Err(json.stream.error(format!("expected positions of 3 numbers, found {other}"))),
    }
}

/// How a block stores its numbers.
struct Block {
    size: usize,
    kind: Kind,
    packing: Option<Vec<usize>>,
    page_size: usize,
    /// For each pack, whether a page of it has one value.
    constant: Vec<Vec<bool>>,
    data: Option<Data>,
}

/// What an attribute holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Content {
    Numbers,
    /// Numbers into a list of texts.
    Texts,
    Others,
}

enum Data {
    Pages(Values),
    /// Row after row.
    Rows(Values),
    /// A list for each component.
    Columns(Vec<Values>),
}

impl Reader<'_, '_> {
    fn skip(&mut self) -> Result<(), ReadError> {
        let token = self.json.next()?;
        self.json.skip(token)
    }

    fn attributes(&mut self) -> Result<(), ReadError> {
        self.json.begin()?;
        while let Some(owner) = self.json.key()? {
            match &*owner {
                "pointattributes" => {
                    let rows = self.points.ok_or_else(|| self.json.stream.error("expected `pointcount` before"))?;
                    self.list(rows, true)?;
                }
                "globalattributes" => self.list(1, false)?,
                _ => self.skip()?,
            }
        }
        Ok(())
    }

    /// Pairs of a definition and its values.
    fn list(&mut self, rows: usize, of_points: bool) -> Result<(), ReadError> {
        self.json.begin()?;
        loop {
            match self.json.next()? {
                Token::ArrayBegin => {}
                Token::ArrayEnd => return Ok(()),
                other => return Err(self.json.unexpected("an attribute", &other)),
            }
            let (name, kind) = self.definition()?;
            let (block, texts) = self.body(kind)?;
            match self.json.next()? {
                Token::ArrayEnd => {}
                other => return Err(self.json.unexpected("the end of an attribute", &other)),
            }
            match block {
                Some(block) if of_points => {
                    let (components, values) = (block.size, self.values(&name, block, rows)?);
                    if kind == Content::Texts {
                        self.notes.push(numbered_texts(&name, &texts));
                    }
                    self.attributes.push(Attribute { name, components, values });
                }
                Some(block) if block.size == 1 && kind == Content::Numbers => {
                    let value = self.values(&name, block, rows)?.uniform();
                    self.globals.extend(value.map(|value| (name, value)));
                }
                None if of_points => self.notes.push(format!("attribute `{name}` is left out: it holds no numbers")),
                _ => {}
            }
        }
    }

    /// The name, and what the values are.
    fn definition(&mut self) -> Result<(String, Content), ReadError> {
        let mut name = String::new();
        let mut content = Content::Others;
        self.json.begin()?;
        while let Some(key) = self.json.key()? {
            match &*key {
                "name" => name = self.json.expect_text()?.to_string(),
                "type" => {
                    content = match &*self.json.expect_text()? {
                        "numeric" => Content::Numbers,
                        "string" => Content::Texts,
                        _ => Content::Others,
                    }
                }
                _ => self.skip()?,
            }
        }
        Ok((name, content))
    }

    /// The values, and the texts that they stand for.
    fn body(&mut self, content: Content) -> Result<(Option<Block>, Vec<String>), ReadError> {
        let mut block = None;
        let mut texts = Vec::new();
        self.json.begin()?;
        while let Some(key) = self.json.key()? {
            match (&*key, content) {
                ("values", Content::Numbers) | ("indices", Content::Texts) => block = Some(self.block()?),
                ("strings", Content::Texts) => {
                    let token = self.json.next()?;
                    texts = self.json.texts(token)?;
                }
                _ => self.skip()?,
            }
        }
        Ok((block, texts))
    }

    fn block(&mut self) -> Result<Block, ReadError> {
        let mut block =
            Block { size: 1, kind: Kind::F32, packing: None, page_size: 0, constant: Vec::new(), data: None };
        self.json.begin()?;
        while let Some(key) = self.json.key()? {
            match &*key {
                "size" => block.size = self.json.expect_count()?,
                "storage" => block.kind = self.storage()?,
                "pagesize" => block.page_size = self.json.expect_count()?,
                "packing" => {
                    let widths = self.all_numbers(Kind::I64)?.to_f64();
                    block.packing = Some(widths.into_iter().map(|width| width as usize).collect());
                }
                "constantpageflags" => {
                    let flags = self.each(Kind::U8)?;
                    block.constant = flags.iter().map(|f| f.to_u32().iter().map(|&flag| flag != 0).collect()).collect();
                }
                "rawpagedata" => block.data = Some(Data::Pages(self.all_numbers(block.kind)?)),
                "tuples" => block.data = Some(Data::Rows(self.all_numbers(block.kind)?)),
                "arrays" => block.data = Some(Data::Columns(self.each(block.kind)?)),
                _ => self.skip()?,
            }
        }
        Ok(block)
    }

    fn storage(&mut self) -> Result<Kind, ReadError> {
        let name = self.json.expect_text()?;
        Ok(match &*name {
            "fpreal16" | "fpreal32" => Kind::F32,
            "fpreal64" => Kind::F64,
            "bool" | "uint8" => Kind::U8,
            "int8" => Kind::I8,
            "int16" => Kind::I16,
            "int32" => Kind::I32,
            "int64" => Kind::I64,
            _ => return Err(self.json.unexpected("a storage such as `fpreal32`", &Token::Text(name))),
        })
    }

    fn all_numbers(&mut self, kind: Kind) -> Result<Values, ReadError> {
        let token = self.json.next()?;
        self.json.numbers(token, kind)
    }

    /// The numbers of each item of a list.
    fn each(&mut self, kind: Kind) -> Result<Vec<Values>, ReadError> {
        let mut items = Vec::new();
        self.json.begin()?;
        loop {
            match self.json.next()? {
                Token::ArrayEnd => return Ok(items),
                item => items.push(self.json.numbers(item, kind)?),
            }
        }
    }

    /// The numbers of a block, row after row.
    fn values(&mut self, name: &str, mut block: Block, rows: usize) -> Result<Values, ReadError> {
        let data = block.data.take();
        let size = block.kind.bytes(rows, block.size).map_or(usize::MAX, |bytes| bytes);
        self.unpacked = self.unpacked.saturating_add(size);
        let most = self.json.stream.offset().saturating_mul(MOST_UNPACKED).saturating_add(1 << 20);
        let values = match data {
            _ if block.size == 0 => Err("expected at least a number a row, found none".to_owned()),
            _ if self.unpacked > most => Err(format!("{} need more data than there is", counted(rows, "row"))),
            Some(Data::Pages(raw)) => block.pages(&raw, rows),
            Some(Data::Rows(values)) => Ok(values),
            Some(Data::Columns(columns)) => Ok(Values::interleave(columns)),
            None => Err("expected its values, found none".to_owned()),
        };
        let count = rows.saturating_mul(block.size);
        let values = values.and_then(|values| match values.len() {
            found if found == count => Ok(values),
            found => Err(format!("expected {}, found {found}", counted(count, "number"))),
        });
        values.map_err(|message| self.json.stream.error(format!("attribute `{name}`: {message}")))
    }
}

impl Block {
    /// Undoes pages: in each, pack after pack, a row of a pack after the other.
    fn pages(&self, raw: &Values, rows: usize) -> Result<Values, String> {
        let whole = vec![self.size];
        let packing = self.packing.as_ref().unwrap_or(&whole);
        let sum = packing.iter().fold(0_usize, |sum, width| sum.saturating_add(*width));
        if sum != self.size || (self.page_size == 0 && rows > 0) {
            return Err(format!("a packing of {sum} numbers for {} in pages of {}", self.size, self.page_size));
        }
        let mut columns: Vec<Values> = packing.iter().map(|_| Values::empty(self.kind)).collect();
        let mut at = 0;
        let mut first_row = 0;
        let mut page = 0;
        while first_row < rows {
            let rows_here = self.page_size.min(rows - first_row);
            for (pack, (&width, column)) in packing.iter().zip(&mut columns).enumerate() {
                let constant = self.constant.get(pack).and_then(|flags| flags.get(page)).copied().unwrap_or(false);
                let stored = if constant { width } else { width * rows_here };
                if stored > raw.len() - at {
                    return Err(format!("page {page} needs {}, found {}", counted(stored, "number"), raw.len() - at));
                }
                let times = if constant { rows_here } else { 1 };
                (0..times).for_each(|_| column.push_part(raw, at, stored));
                at += stored;
            }
            first_row += rows_here;
            page += 1;
        }
        if at != raw.len() {
            return Err(format!("expected {}, found {}", counted(at, "number"), raw.len()));
        }
        Ok(Values::weave(&columns, packing))
    }
}
