//! BGEO, plain and gzipped: the old generation (`Bgeo`, version 5, big endian) and the new one
//! (binary JSON).

mod classic;
mod json;
mod tree;

use super::error::{ReadError, shown};
use super::finish::Found;
use super::stream::Stream;
use super::values::Order;

/// A note about an attribute whose values stand for texts.
fn numbered_texts(name: &str, texts: &[String]) -> String {
    const MOST: usize = 8;
    let listed: Vec<String> =
        texts.iter().take(MOST).enumerate().map(|(i, text)| format!("{i} for {}", shown(text.as_bytes()))).collect();
    let more = if texts.len() > MOST { ", …" } else { "" };
    format!("attribute `{name}` holds text, which is given as numbers: {}{more}", listed.join(", "))
}

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    let mut stream = Stream::new(bytes);
    let magic = &stream.take(5, "the magic number")?.to_vec();
    let found = if magic.starts_with(b"Bgeo") {
        classic::read(&mut stream)?
    } else if magic == b"\x7fNSJb" {
        tree::read(&mut stream, Order::Little)?
    } else if magic == b"\x7fbJSN" {
        tree::read(&mut stream, Order::Big)?
    } else {
        let error = stream.error_at(0, format!("expected `Bgeo` or `\\x7fNSJb`, found {}", shown(magic)));
        let scattered = magic.starts_with(b"PGEOM") || magic.starts_with(b"[");
        return Err(if scattered { error.hint("geometry as text is not read: save it as .bgeo") } else { error });
    };
    stream.check_end()?;
    Ok(found)
}
