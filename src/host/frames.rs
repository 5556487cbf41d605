//! Finding the files of a sequence, and the one of them to begin with.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use super::inputs::Frames;
use super::sequence::{When, held};
use crate::diagnostic::{Code, Diagnostic};
use crate::files::{self, Files, Kind};
use crate::scene::sequence::{Pattern, Sequence};

/// A sequence that was found.
#[derive(Debug)]
pub(super) struct Located {
    /// The file that shows at the moment asked for.
    pub path: PathBuf,
    pub frames: Frames,
    /// If that is not its own file.
    pub held: Option<Diagnostic>,
}

/// Looks for the files of a pattern where any file that a scene names is looked for.
///
/// # Errors
/// If there are none, or none at or before the moment.
pub(super) fn locate(
    files: &dyn Files,
    name: &str,
    sequence: &Sequence,
    beside: Option<&Path>,
    when: When,
) -> Result<Located, Diagnostic> {
    let missing = |message: String| Diagnostic::error(Code::FILE_MISSING, message);
    let Some(pattern) = Pattern::of(Path::new(name)) else {
        return Err(missing(format!("`{name}` has no `#` that stands for a frame's number")));
    };
    let folders = files::candidates(Kind::Asset, pattern.folder(), beside);
    let found = folders.iter().find_map(|folder| {
        Some((folder, numbered_files(files, &pattern.in_folder(folder.clone()))))
            .filter(|(_, frames)| !frames.is_empty())
    });
    let Some((folder, there)) = found else {
        let looked: Vec<String> = folders.iter().map(|f| format!("`{}`", shown(f))).collect();
        return Err(missing(format!("no file is named `{name}` with a number in place of the `#`"))
            .hint(format!("looked in {}", looked.join(", "))));
    };
    let pattern = pattern.in_folder(folder.clone());
    let (first, last) = (there.first().copied().unwrap_or(0), there.last().copied().unwrap_or(0));
    let frames = sequence.frames.clone().unwrap_or(first..=last);
    let wanted = when.frame(&frames, sequence.rate);
    let own = missing(format!("there is no file `{}`", pattern.path(wanted).display()));
    let Some(frame) = nearest(&there, &frames, wanted) else {
        return Err(missing(format!("frame {wanted}: {}, and none of a frame before it", own.message))
            .hint(format!("there are frames {first} to {last}")));
    };
    let path = pattern.path(frame);
    let held = (frame != wanted).then(|| held(own, wanted, frame));
    Ok(Located { path, frames: Frames { pattern, frames, rate: sequence.rate }, held })
}

/// The numbers of a pattern's files, in its own folder.
pub(crate) fn numbered_files(files: &dyn Files, pattern: &Pattern) -> BTreeSet<u64> {
    files.names(pattern.folder()).iter().filter_map(|name| pattern.frame(name)).collect()
}

/// The frame itself or the nearest one before it that is there.
fn nearest(there: &BTreeSet<u64>, frames: &RangeInclusive<u64>, wanted: u64) -> Option<u64> {
    there.range(*frames.start()..=wanted).next_back().copied()
}

fn shown(folder: &Path) -> String {
    if folder.as_os_str().is_empty() { ".".to_owned() } else { folder.display().to_string() }
}
