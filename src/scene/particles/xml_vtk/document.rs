//! The elements of a file, up to where the appended section begins.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::scene::particles::error::{Place, ReadError, shown};
use crate::scene::particles::values::{Kind, Order};

/// What a file declares; the numbers are still encoded.
pub(super) struct Document<'a> {
    pub order: Order,
    /// Bytes of the counts that precede binary data.
    pub header_size: usize,
    pub compressor: Option<String>,
    pub pieces: Vec<Piece<'a>>,
    /// Arrays that belong to the whole file.
    pub fields: Vec<DataArray<'a>>,
    pub appended: Option<Appended>,
    /// The byte at which the element `VTKFile` begins.
    pub at: usize,
}

pub(super) struct Piece<'a> {
    pub points: usize,
    pub position: Option<DataArray<'a>>,
    pub data: Vec<DataArray<'a>>,
    /// The byte at which the element begins.
    pub at: usize,
}

pub(super) struct DataArray<'a> {
    pub name: String,
    /// None for strings. Bits are read as bytes.
    pub kind: Option<Kind>,
    /// Eight to a byte in binary data.
    pub bits: bool,
    pub components: usize,
    pub format: Format<'a>,
    /// The byte at which the element begins.
    pub at: usize,
}

#[derive(Clone, Copy)]
pub(super) enum Format<'a> {
    /// The byte at which the text begins, and the text.
    Text(usize, &'a str),
    Base64(&'a str),
    /// From the start of the appended data: bytes or characters of base64.
    Appended(usize),
}

/// The appended section: what follows its underscore.
#[derive(Clone, Copy)]
pub(super) struct Appended {
    pub base64: bool,
    pub start: usize,
}

/// Where the reader is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    Nothing,
    Points,
    PointData,
    FieldData,
}

struct Parser<'a> {
    bytes: &'a [u8],
    head: &'a str,
    reader: Reader<&'a [u8]>,
    document: Document<'a>,
    inside: Inside,
    /// The byte at which the last event began.
    at: usize,
    whole: bool,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Document<'_>, ReadError> {
    let head = head(bytes)?;
    let document = Document {
        order: Order::Little,
        header_size: 4,
        compressor: None,
        pieces: Vec::new(),
        fields: Vec::new(),
        appended: None,
        at: 0,
    };
    let reader = Reader::from_str(head);
    let mut parser = Parser { bytes, head, reader, document, inside: Inside::Nothing, at: 0, whole: false };
    while parser.step()? {}
    if !parser.whole {
        return Err(parser.error_at(head.len(), "expected `</VTKFile>`, found the end of the file"));
    }
    Ok(parser.document)
}

/// What is XML: all, or all before the appended data, which may be any bytes.
fn head(bytes: &[u8]) -> Result<&str, ReadError> {
    const MARK: &[u8] = b"<AppendedData";
    let mark = bytes.windows(MARK.len()).position(|window| window == MARK);
    let end = mark.and_then(|mark| Some(mark + bytes[mark..].iter().position(|&b| b == b'>')? + 1));
    let head = &bytes[..end.unwrap_or(bytes.len())];
    std::str::from_utf8(head).map_err(|error| {
        let at = error.valid_up_to();
        ReadError::new(format!("expected XML, found {}", shown(&head[at..head.len().min(at + 8)])))
            .at(Place::in_text(bytes, at))
    })
}

impl<'a> Parser<'a> {
    /// Reads one event; false when there is no more to read.
    fn step(&mut self) -> Result<bool, ReadError> {
        self.at = self.position();
        let event = self.reader.read_event().map_err(|error| {
            let at = usize::try_from(self.reader.error_position()).unwrap_or(usize::MAX);
            self.error_at(at, format!("this is no XML: {error}"))
        })?;
        match event {
            Event::Start(element) => self.element(&element, true),
            Event::Empty(element) => self.element(&element, false),
            Event::End(element) => {
                match element.name().as_ref() {
                    "VTKFile" => self.whole = true,
                    "Points" | "PointData" | "FieldData" => self.inside = Inside::Nothing,
                    _ => {}
                }
                Ok(true)
            }
            Event::Eof => Ok(false),
            _ => Ok(true),
        }
    }

    fn element(&mut self, element: &BytesStart<'a>, has_content: bool) -> Result<bool, ReadError> {
        let inside = |inside: Inside| if has_content { inside } else { Inside::Nothing };
        match element.name().as_ref() {
            "VTKFile" => self.file(element)?,
            "Piece" => self.piece(element)?,
            "Points" => self.inside = inside(Inside::Points),
            "PointData" => self.inside = inside(Inside::PointData),
            "FieldData" => self.inside = inside(Inside::FieldData),
            "Cells" | "CellData" | "Verts" | "Lines" | "Strips" | "Polys" if has_content => {
                self.content(element)?;
            }
            "DataArray" | "Array" if self.inside != Inside::Nothing => self.array(element, has_content)?,
            "AppendedData" => {
                self.appended(element)?;
                return Ok(false);
            }
            _ => {}
        }
        Ok(true)
    }

    fn file(&mut self, element: &BytesStart<'_>) -> Result<(), ReadError> {
        let kind = self.required(element, "type")?;
        if kind != "UnstructuredGrid" && kind != "PolyData" {
            let error = self.error(format!("expected UnstructuredGrid or PolyData, found {}", shown(kind.as_bytes())));
            let parallel = kind.starts_with('P');
            return Err(if parallel {
                error.hint("name the file of one piece instead of the list of pieces")
            } else {
                error
            });
        }
        self.document.at = self.at;
        self.document.order = match self.optional(element, "byte_order")?.as_deref() {
            None | Some("LittleEndian") => Order::Little,
            Some("BigEndian") => Order::Big,
            Some(other) => {
                return Err(
                    self.error(format!("expected LittleEndian or BigEndian, found {}", shown(other.as_bytes())))
                );
            }
        };
        self.document.header_size = match self.optional(element, "header_type")?.as_deref() {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => {
                return Err(
                    self.error(format!("expected the header type UInt32 or UInt64, found {}", shown(other.as_bytes())))
                );
            }
        };
        self.document.compressor = self.optional(element, "compressor")?.filter(|name| !name.is_empty());
        Ok(())
    }

    fn piece(&mut self, element: &BytesStart<'_>) -> Result<(), ReadError> {
        let points = self.required(element, "NumberOfPoints")?;
        let points = self.count("NumberOfPoints", &points)?;
        self.document.pieces.push(Piece { points, position: None, data: Vec::new(), at: self.at });
        Ok(())
    }

    fn array(&mut self, element: &BytesStart<'a>, has_content: bool) -> Result<(), ReadError> {
        let at = self.at;
        let name = self.optional(element, "Name")?.unwrap_or_default();
        let name_of_kind = self.required(element, "type")?;
        let kind = self.kind(&name_of_kind)?;
        let bits = name_of_kind == "Bit";
        let components = self.optional(element, "NumberOfComponents")?;
        let components = components.map_or(Ok(1), |n| self.count("NumberOfComponents", &n))?;
        let format = self.optional(element, "format")?.unwrap_or_else(|| "ascii".to_owned());
        let offset = self.optional(element, "offset")?;
        let (start, text) = if has_content { self.content(element)? } else { (self.position(), "") };
        let format = match (format.as_str(), offset) {
            ("ascii", _) => Format::Text(start, text),
            ("binary", _) => Format::Base64(text),
            ("appended", Some(offset)) => Format::Appended(self.count("offset", &offset)?),
            ("appended", None) => return Err(self.error("an appended array needs an `offset`")),
            (other, _) => {
                let found = shown(other.as_bytes());
                return Err(self.error(format!("expected the format ascii, binary or appended, found {found}")));
            }
        };
        let array = DataArray { name, kind, bits, components, format, at };
        match (self.inside, self.document.pieces.last_mut()) {
            (Inside::FieldData, _) => self.document.fields.push(array),
            (Inside::Points, Some(piece)) => piece.position = piece.position.take().or(Some(array)),
            (Inside::PointData, Some(piece)) => piece.data.push(array),
            _ => return Err(self.error("an array outside of any `Piece`")),
        }
        Ok(())
    }

    /// The text of an element that was just opened, without the elements in it.
    fn content(&mut self, element: &BytesStart<'_>) -> Result<(usize, &'a str), ReadError> {
        let start = self.position();
        let read = self.reader.read_to_end(element.name());
        let span = read.map_err(|error| self.error(format!("this element does not end: {error}")))?;
        let end = usize::try_from(span.end).unwrap_or(usize::MAX);
        let text = self.head.get(start..end).unwrap_or_default();
        let before = text.split('<').next().unwrap_or_default();
        if before.len() == text.len() || !before.trim().is_empty() {
            return Ok((start, before));
        }
        let after = text.rfind('>').map_or(0, |at| at + 1);
        Ok((start + after, &text[after..]))
    }

    fn appended(&mut self, element: &BytesStart<'_>) -> Result<(), ReadError> {
        let base64 = match self.required(element, "encoding")?.as_str() {
            "raw" => false,
            "base64" => true,
            other => {
                return Err(
                    self.error(format!("expected the encoding raw or base64, found {}", shown(other.as_bytes())))
                );
            }
        };
        let after = self.head.len();
        let rest = self.bytes.get(after..).unwrap_or_default();
        let mark = rest.iter().position(|b| !b.is_ascii_whitespace());
        match mark {
            Some(mark) if rest[mark] == b'_' => {
                self.document.appended = Some(Appended { base64, start: after + mark + 1 });
                self.whole = true;
                Ok(())
            }
            _ => Err(self.error_at(after, "expected `_`, which begins the appended data")),
        }
    }

    fn kind(&self, name: &str) -> Result<Option<Kind>, ReadError> {
        Ok(Some(match name {
            "String" => return Ok(None),
            "Float32" => Kind::F32,
            "Float64" => Kind::F64,
            "Int8" => Kind::I8,
            "UInt8" | "Bit" => Kind::U8,
            "Int16" => Kind::I16,
            "UInt16" => Kind::U16,
            "Int32" => Kind::I32,
            "UInt32" => Kind::U32,
            "Int64" => Kind::I64,
            "UInt64" => Kind::U64,
            _ => return Err(self.error(format!("expected a type such as Float32, found {}", shown(name.as_bytes())))),
        }))
    }

    fn count(&self, what: &str, text: &str) -> Result<usize, ReadError> {
        text.trim()
            .parse()
            .map_err(|_| self.error(format!("expected a whole number for `{what}`, found {}", shown(text.as_bytes()))))
    }

    fn required(&self, element: &BytesStart<'_>, name: &str) -> Result<String, ReadError> {
        self.optional(element, name)?.ok_or_else(|| {
            let element = String::from_utf8_lossy(element.name().as_ref().as_bytes()).into_owned();
            self.error(format!("`{element}` has no attribute `{name}`"))
        })
    }

    fn optional(&self, element: &BytesStart<'_>, name: &str) -> Result<Option<String>, ReadError> {
        let found =
            element.try_get_attribute(name).map_err(|error| self.error(format!("a wrong attribute: {error}")))?;
        let Some(attribute) = found else { return Ok(None) };
        let value = attribute.normalized_value(quick_xml::XmlVersion::Implicit1_0);
        value.map(|v| Some(v.into_owned())).map_err(|error| self.error(format!("a wrong attribute: {error}")))
    }

    fn position(&self) -> usize {
        usize::try_from(self.reader.buffer_position()).unwrap_or(usize::MAX)
    }

    /// An error at the element that was read last.
    fn error(&self, message: impl Into<String>) -> ReadError {
        self.error_at(self.at, message)
    }

    fn error_at(&self, at: usize, message: impl Into<String>) -> ReadError {
        ReadError::new(message).at(Place::in_text(self.bytes, at))
    }
}
