//! Numbered files, one for each frame: `frames/spray_####.bgeo`. A run of `#` in the file's name stands for
//! the number, with zeros in front to as many digits; longer numbers are written as they are.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Frames a second, where nobody says: what most solvers write.
pub const DEFAULT_RATE: f64 = 25.0;

/// Which files a sequence has, as a scene says it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// First and last; absent: all that are there.
    pub frames: Option<RangeInclusive<u64>>,
    /// Frames a second.
    pub rate: f64,
}

impl Default for Sequence {
    fn default() -> Self {
        Self { frames: None, rate: DEFAULT_RATE }
    }
}

/// A path whose file name has a place for a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Pattern {
    /// The pattern that a path is, if its file name has a run of `#`; the last run counts.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let end = name.rfind('#')? + 1;
        let start = name[..end].trim_end_matches('#').len();
        let (before, after) = (name[..start].to_owned(), name[end..].to_owned());
        Some(Self { folder: path.parent().unwrap_or(Path::new("")).to_owned(), before, digits: end - start, after })
    }

    /// The path of a frame.
    pub fn path(&self, frame: u64) -> PathBuf {
        self.folder.join(format!("{}{frame:0digits$}{}", self.before, self.after, digits = self.digits))
    }

    /// The frame that a file of this name, in the pattern's folder, is.
    pub fn frame(&self, name: &str) -> Option<u64> {
        let number = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        let is_number = number.len() >= self.digits && number.bytes().all(|b| b.is_ascii_digit());
        let frame = number.parse().ok().filter(|_| is_number)?;
        // 007 is not how the pattern `##` writes 7.
        (number.len() == self.digits || !number.starts_with('0')).then_some(frame)
    }

    /// The file's name, with a run of `#` for the number.
    pub fn name(&self) -> String {
        format!("{}{}{}", self.before, "#".repeat(self.digits), self.after)
    }

    /// The same pattern in another folder.
    #[must_use]
    pub fn in_folder(&self, folder: PathBuf) -> Self {
        Self { folder, ..self.clone() }
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_writes_and_reads_numbers() {
        let pattern = Pattern::of(Path::new("a#b/dd_####.bgeo.gz")).expect("a pattern");
        assert_eq!(pattern.path(7), Path::new("a#b/dd_0007.bgeo.gz"));
        assert_eq!(pattern.path(123_456), Path::new("a#b/dd_123456.bgeo.gz"));
        for (name, frame) in
            [("dd_0007.bgeo.gz", Some(7)), ("dd_123456.bgeo.gz", Some(123_456)), ("dd_007.bgeo.gz", None)]
        {
            assert_eq!(pattern.frame(name), frame, "{name}");
        }
        assert_eq!(pattern.frame("dd_00007.bgeo.gz"), None, "five digits begin with no zero");
        assert_eq!(pattern.frame("dd_+007.bgeo.gz"), None);
        assert_eq!(pattern.frame("ee_0007.bgeo.gz"), None);
        assert_eq!(Pattern::of(Path::new("a#/plain.vtk")), None);
        assert_eq!(Pattern::of(Path::new("#.vtk")).map(|p| p.path(12)), Some(PathBuf::from("12.vtk")));
    }
}
