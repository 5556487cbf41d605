//! Finding the files of a sequence, and the one of them to begin with.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use super::sequence::{Frames, Timeline, When, held};
use crate::diagnostic::{Code, Diagnostic};
use crate::files::{self, Files, Kind};
use crate::scene::sequence::{Pattern, Sequence};

/// A sequence that was found.
#[derive(Debug)]
pub(super) struct Located {
    /// The file that shows at the moment asked for; where none does yet, the first that will.
    pub path: PathBuf,
    pub frames: Frames,
    /// What a person should know of what shows.
    pub told: Vec<Diagnostic>,
}

/// Looks for the files of a pattern where any file that a scene names is looked for. A scene's first
/// sequence makes the `timeline` that the others keep to.
///
/// # Errors
/// If there are none, or of the first sequence none at or before the moment.
pub(super) fn locate(
    files: &dyn Files,
    name: &str,
    sequence: &Sequence,
    (beside, when): (Option<&Path>, When),
    timeline: Option<&Timeline>,
) -> Result<Located, Diagnostic> {
    let (pattern, there) = find(files, name, beside)?;
    let (first, last) = (there.first().copied().unwrap_or(0), there.last().copied().unwrap_or(0));
    let numbers = sequence.frames.clone().unwrap_or(first..=last);
    let frames = Frames::leading(pattern, numbers.clone(), sequence.rate);
    let frames = match timeline {
        None => frames,
        Some(timeline) => {
            let frames = Frames { timeline: timeline.clone(), ..frames };
            // What begins late begins with a file that is there.
            let begins = there.range(numbers.clone()).next().copied().unwrap_or(first);
            let is_late = begins > *timeline.numbers.start() && begins <= *numbers.end();
            if is_late { Frames { numbers: begins..=*numbers.end(), ..frames } } else { frames }
        }
    };
    let mut told: Vec<Diagnostic> = frames.outside(when).into_iter().collect();
    let Some(wanted) = frames.frame(when) else {
        let path = frames.pattern.path(frames.first());
        let message = format!("`{name}` begins with frame {}: until then it is empty", frames.first());
        told.push(Diagnostic::note(Code::ASSET_NOTE, message));
        return Ok(Located { path, frames, told });
    };
    let own = missing(format!("there is no file `{}`", frames.pattern.path(wanted).display()));
    let Some(frame) = nearest(&there, &frames.numbers, wanted) else {
        return Err(missing(format!("frame {wanted}: {}, and none of a frame before it", own.message))
            .hint(format!("there are frames {first} to {last}")));
    };
    let path = frames.pattern.path(frame);
    told.extend((frame != wanted).then(|| held(own, wanted, frame)));
    Ok(Located { path, frames, told })
}

/// The pattern in the first folder that has files of it, and their numbers.
fn find(files: &dyn Files, name: &str, beside: Option<&Path>) -> Result<(Pattern, BTreeSet<u64>), Diagnostic> {
    let Some(pattern) = Pattern::of(Path::new(name)) else {
        return Err(missing(format!("`{name}` has no `#` that stands for a frame's number")));
    };
    let folders = files::candidates(Kind::Asset, pattern.folder(), beside);
    let found = folders.iter().find_map(|folder| {
        let pattern = pattern.in_folder(folder.clone());
        let there = numbered_files(files, &pattern);
        (!there.is_empty()).then_some((pattern, there))
    });
    found.ok_or_else(|| {
        let looked: Vec<String> = folders.iter().map(|f| format!("`{}`", shown(f))).collect();
        missing(format!("no file is named `{name}` with a number in place of the `#`"))
            .hint(format!("looked in {}", looked.join(", ")))
    })
}

fn missing(message: String) -> Diagnostic {
    Diagnostic::error(Code::FILE_MISSING, message)
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
