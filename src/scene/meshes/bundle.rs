//! A mesh file with the files that it names: everything that reading it needs, so that reading
//! can happen on another thread and the same bytes need not be read twice.

use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use twox_hash::XxHash3_128;

use crate::files::{self, Files, LIBRARY};

/// The bytes of a mesh file and of the files that it names.
#[derive(Clone, Debug)]
pub struct Bundle {
    pub path: PathBuf,
    pub bytes: Arc<[u8]>,
    /// What each reference in the file led to, by its text.
    pub(super) others: BTreeMap<String, Result<Arc<[u8]>, Refused>>,
    /// Every other file that was looked for, found or not: what a watcher waits for.
    pub looked_at: Vec<PathBuf>,
}

/// Why a reference leads to no bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Refused {
    /// There is no such file.
    Missing,
    /// The file is there, and this is what the system said.
    Unreadable(String),
    /// Files may name only what lies in their own folder or below it.
    Outside,
    /// An address of a network.
    Remote,
}

impl Refused {
    /// How to mend it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Missing => "keep the files of a model together",
            Self::Unreadable(_) => "see whether the file may be read",
            Self::Outside | Self::Remote => "copy it into the folder of the model",
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => f.write_str("is not there"),
            Self::Unreadable(why) => write!(f, "cannot be read: {why}"),
            Self::Outside => f.write_str("lies outside of the model's folder, and is not read"),
            Self::Remote => f.write_str("is an address elsewhere, and is not read"),
        }
    }
}

impl Bundle {
    /// A file that names no others.
    pub fn alone(path: impl AsRef<Path>, bytes: Arc<[u8]>) -> Self {
        Self { path: path.as_ref().to_owned(), bytes, others: BTreeMap::new(), looked_at: Vec::new() }
    }

    /// Equal for equal content of all files.
    pub fn hash(&self) -> u128 {
        let mut all = XxHash3_128::oneshot(&self.bytes).to_le_bytes().to_vec();
        for (name, other) in &self.others {
            all.extend(XxHash3_128::oneshot(name.as_bytes()).to_le_bytes());
            match other {
                Ok(bytes) => all.extend(XxHash3_128::oneshot(bytes).to_le_bytes()),
                Err(why) => all.extend(format!("{why:?}").bytes()),
            }
        }
        XxHash3_128::oneshot(&all)
    }

    /// Reads the file that `name` means, seen from this file's own folder.
    pub(super) fn fetch(&mut self, files: &dyn Files, name: &str) {
        if self.others.contains_key(name) {
            return;
        }
        let found = match inside(name) {
            Err(refused) => Err(refused),
            Ok(inner) => {
                let path = files::normalize(&self.path.parent().unwrap_or(Path::new("")).join(inner));
                let found = read(files, &path).map_err(|error| match error.kind() {
                    io::ErrorKind::NotFound => Refused::Missing,
                    _ => Refused::Unreadable(error.to_string()),
                });
                self.looked_at.push(path);
                found
            }
        };
        self.others.insert(name.to_owned(), found);
    }

    /// Fetches what `name` means; where it is a whole path of another computer, also a file of that
    /// name in `folder`.
    pub(super) fn fetch_or_beside(&mut self, files: &dyn Files, folder: &Path, name: &str) {
        self.fetch(files, name);
        if let Some(beside) = beside(folder, name).filter(|_| self.other(name).is_err()) {
            self.fetch(files, &beside);
        }
    }

    /// What [`Bundle::fetch_or_beside`] found, with the name under which it did.
    pub(super) fn other_or_beside(&self, folder: &Path, name: &str) -> Result<(String, &[u8]), &Refused> {
        let found = |name: String| self.other(&name).map(|bytes| (name, bytes));
        found(name.to_owned()).or_else(|why| beside(folder, name).and_then(|name| found(name).ok()).ok_or(why))
    }

    /// What a reference led to.
    pub(super) fn other(&self, name: &str) -> Result<&[u8], &Refused> {
        self.others.get(name).map_or(Err(&Refused::Missing), |found| found.as_deref())
    }

    /// Bytes of all files together.
    pub(super) fn size(&self) -> usize {
        self.bytes.len() + self.others.values().flatten().map(|bytes| bytes.len()).sum::<usize>()
    }
}

fn read(files: &dyn Files, path: &Path) -> io::Result<Arc<[u8]>> {
    match path.strip_prefix(LIBRARY) {
        Ok(carried) => files::library_file(carried).map(Into::into).ok_or_else(|| io::ErrorKind::NotFound.into()),
        Err(_) => files.read(path),
    }
}

/// A file in `folder` of the last name of a path, if that begins at a root or a drive.
fn beside(folder: &Path, name: &str) -> Option<String> {
    let name = name.replace('\\', "/");
    let (_, last) = name.rsplit_once('/').filter(|_| name.starts_with('/') || drive(&name).is_some())?;
    (!last.is_empty()).then(|| folder.join(last).to_string_lossy().into_owned())
}

/// What follows the letter of a drive.
fn drive(name: &str) -> Option<&str> {
    let (letter, rest) = name.split_once(':')?;
    (letter.len() == 1 && letter.chars().all(|c| c.is_ascii_alphabetic())).then_some(rest)
}

/// The path that a reference means, from the folder of the file that is read on. A file that came
/// from elsewhere must not make this program open what its sender could not have meant to send.
fn inside(name: &str) -> Result<PathBuf, Refused> {
    if name.split_once(':').is_some_and(|(scheme, _)| scheme.len() > 1 && scheme.chars().all(|c| c.is_alphanumeric())) {
        return Err(Refused::Remote);
    }
    if drive(name).is_some() {
        return Err(Refused::Outside);
    }
    let inner = files::normalize(Path::new(&name.replace('\\', "/")));
    let stays = inner.components().all(|part| matches!(part, Component::Normal(_)));
    if stays && inner.components().next().is_some() { Ok(inner) } else { Err(Refused::Outside) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::MemoryFiles;

    #[test]
    fn references_stay_in_the_folder_of_the_file() {
        let files = MemoryFiles::default()
            .with("a/b/skin.png", "1")
            .with("a/b/more/deep.png", "2")
            .with("a/secret.png", "3")
            .with("/etc/secret", "4");
        let mut bundle = Bundle::alone("a/b/thing.obj", Arc::from(*b"x"));
        for name in ["skin.png", "more\\deep.png", "gone.png", "../secret.png", "/etc/secret", "http://a/b.png", ""] {
            bundle.fetch(&files, name);
        }
        bundle.fetch(&files, "more/../skin.png");
        bundle.fetch(&files, "more/../../secret.png");
        let found = |name: &str| bundle.others[name].as_ref().map(|bytes| bytes.to_vec());
        assert_eq!(found("skin.png"), Ok(b"1".to_vec()));
        assert_eq!(found("more\\deep.png"), Ok(b"2".to_vec()));
        assert_eq!(found("more/../skin.png"), Ok(b"1".to_vec()));
        assert_eq!(found("gone.png"), Err(&Refused::Missing));
        for outside in ["../secret.png", "/etc/secret", "more/../../secret.png", ""] {
            assert_eq!(found(outside), Err(&Refused::Outside), "{outside}");
        }
        assert_eq!(found("http://a/b.png"), Err(&Refused::Remote));
        assert_eq!(bundle.looked_at.len(), 4, "what is refused is not looked for");
    }
}
