//! XYZ: positions and nothing else, as raw little-endian `f32` triples or as lines of text.

use super::cursor::Cursor;
use super::error::{Place, ReadError, counted, shown};
use super::finish::Found;
use super::values::{Kind, Layout, Order, Values};

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    if looks_like_text(bytes) { text(bytes) } else { raw(bytes) }
}

/// Whether the start of the file has only what a text of numbers and comments has.
fn looks_like_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    start.iter().all(|&b| b.is_ascii_graphic() || matches!(b, b' ' | b'\t' | b'\r' | b'\n'))
}

fn raw(bytes: &[u8]) -> Result<Found, ReadError> {
    const ROW: usize = 12;
    let over = bytes.len() % ROW;
    if over != 0 {
        let message = format!(
            "expected triples of 4-byte floats, found {} (12 to a particle leave {over} over)",
            counted(bytes.len(), "byte")
        );
        return Err(ReadError::new(message).at(Place::Byte(bytes.len() - over)));
    }
    let layout = Layout { start: 0, stride: ROW, components: 3 };
    Ok(Found::new(Values::gather(Kind::F32, bytes, layout, bytes.len() / ROW, Order::Little)))
}

/// Three numbers a line, between them white space, commas or semicolons; `#` begins a comment.
fn text(bytes: &[u8]) -> Result<Found, ReadError> {
    let mut cursor = Cursor::new(bytes);
    let mut values = Values::empty(Kind::F64);
    loop {
        let start = cursor.offset();
        let Some(line) = cursor.line() else { break };
        let line = line.split(|&b| b == b'#').next().unwrap_or_default();
        let mut count = 0;
        for (at, word) in words(line) {
            if !values.push_text(word) {
                let message = format!("expected a number, found {}", shown(word));
                return Err(ReadError::new(message).at(Place::in_text(bytes, start + at)));
            }
            count += 1;
        }
        if count != 0 && count != 3 {
            let message = format!("expected 3 numbers on a line, found {count}");
            let error = ReadError::new(message).at(Place::in_text(bytes, start));
            return Err(error.hint("further columns need names: give them a header line and the extension .csv"));
        }
    }
    Ok(Found::new(values))
}

/// The words of a line and where in it they begin.
fn words(line: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let between = |b: &u8| b.is_ascii_whitespace() || matches!(b, b',' | b';');
    let mut at = 0;
    line.split(between).filter_map(move |word| {
        let start = at;
        at += word.len() + 1;
        (!word.is_empty()).then_some((start, word))
    })
}
