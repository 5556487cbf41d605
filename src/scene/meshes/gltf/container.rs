//! What surrounds a glTF document: the chunks of a `.glb` file, and addresses of buffers and images.

use std::borrow::Cow;

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// A file's JSON and the binary chunk after it.
pub struct Container<'a> {
    pub json: &'a [u8],
    pub binary: Option<&'a [u8]>,
}

const JSON: &[u8; 4] = b"JSON";
const BINARY: &[u8; 4] = b"BIN\0";

/// Splits a file; its name does not decide which form it has.
///
/// # Errors
/// Place and message.
pub fn open(bytes: &[u8]) -> Result<Container<'_>, (String, String)> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Container { json: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), binary: None });
    }
    let fault = |at: usize, message: String| Err((format!("byte {at}"), message));
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return fault(bytes.len(), "the file ends within its header of 12 bytes".into());
    };
    if version != 2 {
        return fault(4, format!("this is version {version} of the binary form; version 2 is read"));
    }
    let Some(whole) = bytes.get(..length) else {
        return fault(8, format!("the header says {length} bytes, the file has {}", bytes.len()));
    };
    let (mut json, mut binary, mut at) = (None, None, 12);
    while at < whole.len() {
        let (Some(size), Some(kind)) = (word(whole, at), whole.get(at + 4..at + 8)) else {
            return fault(at, "the file ends within the header of a chunk".into());
        };
        let Some(chunk) = whole[at + 8..].get(..size) else {
            return fault(at, format!("a chunk says {size} bytes, {} are left", whole.len() - at - 8));
        };
        match json {
            None if kind == JSON => json = Some(chunk),
            None => return fault(at, "the first chunk must be JSON".into()),
            Some(_) if kind == BINARY && binary.is_none() => binary = Some(chunk),
            // Chunks of extensions are read over.
            Some(_) => {}
        }
        at = (at + 8 + size).next_multiple_of(4);
    }
    match json {
        Some(json) => Ok(Container { json, binary }),
        None => fault(12, "the file has no chunk of JSON".into()),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let four = bytes.get(at..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*four)).ok()
}

/// Where the bytes of a buffer or an image are.
pub enum Address<'a> {
    /// In the address itself.
    Data(&'a str),
    /// In a file, by its path from the document.
    File(Cow<'a, str>),
}

pub fn address(uri: &str) -> Address<'_> {
    match uri.get(..5) {
        Some(scheme) if scheme.eq_ignore_ascii_case("data:") => Address::Data(&uri[5..]),
        _ => Address::File(decode_percent(uri)),
    }
}

/// The bytes of an address that holds them.
///
/// # Errors
/// A message.
pub fn data(address: &str) -> Result<Vec<u8>, String> {
    let Some((kind, content)) = address.split_once(',') else {
        return Err("a data URI needs a comma before its data".into());
    };
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Ok(percent(content));
    }
    let lenient = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let engine = GeneralPurpose::new(&alphabet::STANDARD, lenient);
    engine.decode(content.trim()).map_err(|error| format!("the data URI is no base64: {error}"))
}

/// Turns `%20` and its like into what they stand for, if that is text.
fn decode_percent(uri: &str) -> Cow<'_, str> {
    if !uri.contains('%') {
        return Cow::Borrowed(uri);
    }
    String::from_utf8(percent(uri)).map_or(Cow::Borrowed(uri), Cow::Owned)
}

fn percent(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let code = after.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) if *first == b'%' => {
                bytes.push(byte);
                rest = &after[2..];
            }
            _ => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    bytes
}
