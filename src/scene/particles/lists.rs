//! Files of ParaView that list other files: `.pvd`, `.pvtu`, `.pvtp`, `.vtm`. They hold no particles
//! themselves, and are known so that a person is told which file to name.

use super::error::{Place, ReadError, shown};
use super::finish::Found;

/// Ends of the names of lists.
pub(super) const EXTENSIONS: &[&str] = &["pvd", "pvtu", "pvtp", "vtm"];

/// Attributes that name a file.
const NAMING: &[&[u8]] = &[b" file=", b" Source="];

/// # Errors
/// Always; which file to name is the hint.
pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    let named = files(bytes);
    let count = if named.len() == 1 { "one file".to_owned() } else { format!("{} files", named.len()) };
    let (at, message) = match named.first() {
        Some((at, _)) => (*at, format!("this lists {count} and holds no particles itself")),
        None => (0, "this should list files, and names none".to_owned()),
    };
    let hint = match named.as_slice() {
        [] => "name a file that holds points, such as a .vtu or a .vtp".to_owned(),
        [(_, file)] => format!("name {} instead", shown(file)),
        [(_, file), ..] => {
            format!("name one of them, such as {}, or all by `#` in place of their numbers", shown(file))
        }
    };
    Err(ReadError::new(message).at(Place::in_text(bytes, at)).hint(hint))
}

/// The files that a list names, each with the byte at which it does.
fn files(bytes: &[u8]) -> Vec<(usize, &[u8])> {
    let mut files = Vec::new();
    let mut at = 0;
    while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
        let Some(equals) = rest.iter().position(|&b| b == b'=') else { break };
        let end = at + equals + 1;
        if NAMING.iter().any(|name| bytes[..end].ends_with(name))
            && let Some(&quote @ (b'"' | b'\'')) = bytes.get(end)
            && let Some(length) = bytes[end + 1..].iter().position(|&b| b == quote)
        {
            files.push((end + 1, &bytes[end + 1..end + 1 + length]));
        }
        at = end;
    }
    files
}
