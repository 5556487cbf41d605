//! XYZ: positions and nothing else, as raw little-endian `f32` triples or as lines of text.

use super::cursor::Cursor;
use super::error::{Place, ReadError, counted, shown};
use super::finish::Found;
use super::values::{Kind, Layout, Order, Values};

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    if looks_like_text(bytes) { text(bytes) } else { raw(bytes) }
}

/// Whether the start of the file has only what a text has: no control characters, and letters beyond
/// ASCII in UTF-8, or of any code in comments. Raw numbers have zeros or halves of letters soon.
fn looks_like_text(bytes: &[u8]) -> bool {
    const LOOKED_AT: usize = 4096;
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    if start.iter().any(|b| b.is_ascii_control() && !matches!(b, b'\t' | b'\r' | b'\n')) {
        return false;
    }
    let is_text = match std::str::from_utf8(start) {
        Ok(text) => !text.contains(is_rare_control),
        // The last letter may be cut where no more is looked at.
        Err(error) => error.error_len().is_none() && bytes.len() > LOOKED_AT,
    };
    is_text || start.split(|&b| b == b'\n').all(|line| uncommented(line).is_ascii())
}

/// Control characters beyond ASCII, which no text has.
fn is_rare_control(c: char) -> bool {
    c.is_control() && !c.is_ascii()
}

fn uncommented(line: &[u8]) -> &[u8] {
    line.split(|&b| b == b'#').next().unwrap_or_default()
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

const NAMES_ARE_CSV: &str = "a file that begins with a line of names is read with the extension .csv";

/// Three numbers a line, between them white space, commas or semicolons; `#` begins a comment.
fn text(bytes: &[u8]) -> Result<Found, ReadError> {
    let mut cursor = Cursor::of_text(bytes);
    let mut values = Values::empty(Kind::F64);
    loop {
        let start = cursor.offset();
        let Some(line) = cursor.line() else { break };
        let mut count = 0;
        for (at, word) in words(uncommented(line)) {
            if !values.push_text(word) {
                let message = format!("expected a number, found {}", shown(word));
                let error = ReadError::new(message).at(Place::in_text(bytes, start + at));
                let is_header = values.is_empty() && word.first().is_some_and(u8::is_ascii_alphabetic);
                return Err(if is_header { error.hint(NAMES_ARE_CSV) } else { error });
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
