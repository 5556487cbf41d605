//! The one door to files, so that the core can run where there is no file system.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Reads whole files by path. Implementations resolve nothing: a path is taken as it is.
pub trait Files {
    /// The bytes of a file.
    ///
    /// # Errors
    /// As the underlying store reports; `NotFound` means that the file is not there.
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>>;

    /// Whether a file is there.
    fn exists(&self, path: &Path) -> bool;

    /// The names in a folder, in any order; none where a store cannot tell.
    fn names(&self, _folder: &Path) -> Vec<String> {
        Vec::new()
    }
}

/// Files of the operating system.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskFiles;

impl Files for DiskFiles {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        let mut file = std::fs::File::open(path)?;
        let length = file.metadata()?.len();
        // Into shared memory at once: large files are not copied once more. What is no file of a
        // known length is read to its end.
        let mut bytes: Arc<[u8]> = std::iter::repeat_n(0, usize::try_from(length).unwrap_or(0)).collect();
        if let Some(whole) = Arc::get_mut(&mut bytes).filter(|_| length > 0)
            && file.read_exact(whole).is_ok()
            && file.read(&mut [0])? == 0
        {
            return Ok(bytes);
        }
        std::fs::read(path).map(Into::into)
    }

    fn exists(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }
}

/// Files in memory, for tests and for embedding.
#[derive(Clone, Debug, Default)]
pub struct MemoryFiles(pub BTreeMap<PathBuf, Arc<[u8]>>);

impl MemoryFiles {
    #[must_use]
    pub fn with(mut self, path: impl Into<PathBuf>, text: impl AsRef<[u8]>) -> Self {
        self.0.insert(path.into(), text.as_ref().into());
        self
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        self.0.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn exists(&self, path: &Path) -> bool {
        self.0.contains_key(path)
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        let inside = self.0.keys().filter(|path| path.parent() == Some(folder));
        inside.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect()
    }
}

/// What a path names, which decides under which folder of a project it is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Graph,
    Shader,
    Scene,
    Asset,
}

impl Kind {
    fn folder(self) -> &'static str {
        match self {
            Kind::Graph => "graphs",
            Kind::Shader => "shaders",
            Kind::Scene => "scenes",
            Kind::Asset => "scenes",
        }
    }
}

/// A file that was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The path it was read from; `<library>/graphs/...` if the program carries it.
    pub path: PathBuf,
    pub bytes: Arc<[u8]>,
}

/// A file that was not found, or could not be read.
#[derive(Debug)]
pub struct NotFound {
    /// Every path that was looked at, in order. A watcher waits for these.
    pub tried: Vec<PathBuf>,
    /// What the first existing one answered, if one exists but cannot be read.
    pub error: Option<io::Error>,
}

/// Looks for `name` as rule 5 says: beside the file that names it, then under the project's
/// `graphs/` or `shaders/`, then in the library that the program carries. The project is the
/// nearest folder above `beside` that has a folder of that name.
///
/// # Errors
/// If nothing is found or the first one found cannot be read.
pub fn find(files: &dyn Files, kind: Kind, name: &str, beside: Option<&Path>) -> Result<Found, NotFound> {
    let candidates = candidates(kind, Path::new(name), beside);
    for path in &candidates {
        if path.starts_with(LIBRARY) {
            continue;
        }
        if files.exists(path) {
            return match files.read(path) {
                Ok(bytes) => Ok(Found { path: path.clone(), bytes }),
                Err(error) => Err(NotFound { tried: vec![path.clone()], error: Some(error) }),
            };
        }
    }
    let library = candidates
        .iter()
        .filter_map(|path| path.strip_prefix(LIBRARY).ok())
        .map(Path::to_path_buf)
        .chain([normalize(&Path::new(kind.folder()).join(name))])
        .find_map(|path| library_file(&path).map(|bytes| (path, bytes)));
    match library {
        Some((path, bytes)) => Ok(Found { path: Path::new(LIBRARY).join(path), bytes: bytes.into() }),
        None => Err(NotFound { tried: candidates, error: None }),
    }
}

/// The paths, in order, at which a file or folder of this name is looked for.
pub fn candidates(kind: Kind, name: &Path, beside: Option<&Path>) -> Vec<PathBuf> {
    let base = beside.and_then(Path::parent).unwrap_or(Path::new(""));
    let mut candidates = vec![normalize(&base.join(name))];
    if name.is_relative() {
        for folder in base.ancestors() {
            let candidate = normalize(&folder.join(kind.folder()).join(name));
            if !candidates.contains(&candidate) && !folder.starts_with(LIBRARY) {
                candidates.push(candidate);
            }
        }
    }
    candidates
}

/// The prefix of paths of files that the program carries.
pub const LIBRARY: &str = "<library>";

/// A file that the program carries, by its path in the repository (`graphs/...`, `shaders/...`).
pub fn library_file(path: &Path) -> Option<&'static [u8]> {
    let name = path.to_str()?.replace('\\', "/");
    LIBRARY_FILES.binary_search_by(|(known, _)| (*known).cmp(&name)).ok().map(|at| LIBRARY_FILES[at].1)
}

/// All files that the program carries, sorted by path.
pub fn library() -> impl Iterator<Item = &'static str> {
    LIBRARY_FILES.iter().map(|(name, _)| *name)
}

include!(concat!(env!("OUT_DIR"), "/library.rs"));

/// Removes `.` and resolves `..` against what stands before it, without asking the file system.
pub fn normalize(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}
