//! BGEO, plain and gzipped: the old generation (`Bgeo`, version 5, big endian) and the new one
//! (binary JSON).

mod classic;
mod json;
mod stream;
mod tree;

use super::error::{ReadError, shown};
use super::finish::Found;
use super::values::Order;
use stream::Stream;

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
