//! `--dump PATH=FILE`: any texture or buffer as a file.

use std::path::PathBuf;

use super::output::Output;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::host::Session;
use crate::host::dump::{DumpKind, Items, write};
use crate::host::picture::{self, PictureKind, Texels};
use crate::plan::model::{Buffer, ObjectKind, ObjectRef};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Picture(PictureKind),
    Items(DumpKind),
}

/// A dump that was asked for.
#[derive(Debug)]
pub struct Asked {
    path: String,
    file: PathBuf,
    format: Format,
}

/// A dump whose place is made.
#[derive(Debug)]
pub struct Dump {
    /// Instance path.
    pub path: String,
    format: Format,
    output: Output,
}

/// Reads `PATH=FILE`s.
///
/// # Errors
/// If a file's extension is none that anything is written as.
pub fn parse(given: &[(String, String)]) -> Result<Vec<Asked>, Diagnostics> {
    let mut found = Diagnostics::new();
    let mut asked = Vec::new();
    for (path, file) in given {
        let file = PathBuf::from(file);
        let format = PictureKind::of(&file).map(Format::Picture).or(DumpKind::of(&file).map(Format::Items));
        match format {
            Some(format) => asked.push(Asked { path: path.clone(), file, format }),
            None => {
                let message = format!(
                    "`{}`: textures are written as .png or .exr, buffers as .ply, .obj, .csv, .json or .bin",
                    file.display()
                );
                found.push(Diagnostic::error(Code::USAGE, message));
            }
        }
    }
    if found.is_empty() { Ok(asked) } else { Err(found) }
}

/// Makes the places of all dumps.
///
/// # Errors
/// If one cannot be written.
pub fn reserve(asked: Vec<Asked>) -> Result<Vec<Dump>, Diagnostic> {
    let reserve = |a: Asked| Output::reserve(&a.file).map(|output| Dump { path: a.path, format: a.format, output });
    asked.into_iter().map(reserve).collect()
}

impl Dump {
    /// Reads from the device what was asked for, and writes it.
    ///
    /// # Errors
    /// If there is nothing of that path, it cannot be written in that format, or the device fails.
    pub fn write(self, session: &mut Session) -> Result<Diagnostics, Diagnostic> {
        let Some((object, kind)) = session.object(&self.path) else {
            let names = session.plan().map(|p| p.names.keys().map(String::as_str).collect::<Vec<_>>());
            let unknown = format!("there is no texture or buffer `{}` to dump", self.path);
            return Err(Diagnostic::error(Code::USAGE, unknown).nearest(&self.path, names.unwrap_or_default()));
        };
        let kind = kind.clone();
        let mut notes = Diagnostics::new();
        let bytes = match (self.format, &kind) {
            (Format::Picture(format), ObjectKind::Texture(_)) => {
                let texels = session.texels(object)?;
                if format == PictureKind::Png {
                    notes.extend(clamped(&self.path, &texels));
                }
                match format {
                    PictureKind::Png => picture::texels_png(&texels),
                    PictureKind::Exr => picture::exr(&texels),
                }
            }
            (Format::Items(format), ObjectKind::Buffer(buffer)) => items(session, object, buffer, format)?,
            (_, ObjectKind::Texture(_)) => Err("it is a texture, which is written as .png or .exr".into()),
            (_, ObjectKind::Buffer(_)) => {
                Err("it is a buffer, which is written as .ply, .obj, .csv, .json or .bin".into())
            }
        };
        let refuse =
            |why: String| Diagnostic::error(Code::USAGE, format!("`{}` cannot be dumped so: {why}", self.path));
        self.output.write(&bytes.map_err(refuse)?)?;
        Ok(notes)
    }
}

fn items(
    session: &Session,
    object: ObjectRef,
    buffer: &Buffer,
    format: DumpKind,
) -> Result<Result<Vec<u8>, String>, Diagnostic> {
    let bytes = session.bytes(object)?;
    let count = match bytes.first_chunk::<4>() {
        Some(count) if buffer.counted => u64::from(u32::from_le_bytes(*count)).min(buffer.items),
        _ => buffer.items,
    };
    let items = Items {
        bytes: bytes.get(buffer.header as usize..).unwrap_or_default(),
        stride: buffer.stride as usize,
        count: usize::try_from(count).unwrap_or(usize::MAX),
        item: buffer.item.as_ref(),
    };
    Ok(write(&items, format))
}

/// A note if a PNG cannot hold a texture's values.
fn clamped(path: &str, texels: &Texels) -> Diagnostics {
    let channels = texels.channels.min(3) as usize;
    let values = || texels.rgba.iter().flat_map(|p| &p[..channels]).copied().filter(|x| x.is_finite());
    let (low, high) = values().fold((0.0f32, 1.0f32), |(low, high), x| (low.min(x), high.max(x)));
    if low >= 0.0 && high <= 1.0 {
        return Diagnostics::new();
    }
    let message = format!("`{path}` has values from {low} to {high}: the PNG shows 0 to 1");
    Diagnostic::note(Code::ASSET_NOTE, message).hint("an .exr keeps them").into()
}
