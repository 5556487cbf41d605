//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use crate::diagnostic::{Code, Diagnostic};

/// A file that will be written. It is made beside its final place before any work is done, so that
/// a folder that is missing or may not be written to is told at once, and takes its place when all
/// of it is there. Dropped before that, it leaves nothing.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    partial: PathBuf,
}

impl Output {
    /// Reserves the place beside `path`.
    ///
    /// # Errors
    /// If `path` is a folder, or a file cannot be made beside it.
    pub fn reserve(path: &Path) -> Result<Self, Diagnostic> {
        let refuse =
            |why: &str| Diagnostic::error(Code::OUTPUT, format!("`{}` cannot be written: {why}", path.display()));
        let Some(name) = path.file_name() else { return Err(refuse("this names no file")) };
        if path.is_dir() {
            return Err(refuse("this is a folder").hint("give the name of a file in it"));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            let missing = format!("there is no folder `{}`", folder.display());
            return Err(refuse(&missing).hint(format!("make it with `mkdir -p {}`", folder.display())));
        }
        let partial = folder.join(format!(".{}.{}.part", name.to_string_lossy(), std::process::id()));
        File::create(&partial).map_err(|error| refuse(&error.to_string()))?;
        Ok(Self { path: path.to_owned(), partial })
    }

    /// Writes everything and puts it in place of what was there.
    ///
    /// # Errors
    /// If the disk is full or the file cannot be replaced; then what was there stays.
    pub fn write(self, bytes: &[u8]) -> Result<(), Diagnostic> {
        if let Ok(before) = fs::metadata(&self.path) {
            // Who may read and write it stays as it was, where the system lets us say so.
            _ = fs::set_permissions(&self.partial, before.permissions());
        }
        let written = fs::write(&self.partial, bytes).and_then(|()| fs::rename(&self.partial, &self.path));
        written.map_err(|error| {
            Diagnostic::error(Code::OUTPUT, format!("`{}` cannot be written: {error}", self.path.display()))
        })
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        // After success the name is gone; after a failure there is nobody to tell of another.
        _ = fs::remove_file(&self.partial);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("meniscus-output-{name}-{}", std::process::id()));
        _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a temporary folder");
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder").flatten();
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = folder("whole");
        let path = folder.join("a.png");
        drop(Output::reserve(&path).expect("reserved"));
        assert_eq!(names(&folder), [""; 0]);
        Output::reserve(&path).expect("reserved").write(b"one").expect("written");
        Output::reserve(&path).expect("reserved").write(b"two").expect("written");
        assert_eq!(fs::read(&path).expect("a file"), b"two");
        assert_eq!(names(&folder), ["a.png"]);
        _ = fs::remove_dir_all(&folder);
    }

    #[test]
    fn a_missing_folder_and_a_folder_are_told_at_once() {
        let folder = folder("missing");
        let missing = Output::reserve(&folder.join("no/such/a.png")).expect_err("no folder");
        assert!(missing.message.contains("there is no folder"), "{}", missing.message);
        assert!(!missing.hints.is_empty());
        let itself = Output::reserve(&folder).expect_err("a folder");
        assert!(itself.message.ends_with("this is a folder"), "{}", itself.message);
        _ = fs::remove_dir_all(&folder);
    }
}
