//! From a name to a module or to what is wrong with it.

use std::path::{Path, PathBuf};

use super::reflect::Module;
use super::{assemble, inspect, parse};
use crate::diagnostic::{Diagnostic, Diagnostics, Sources};
use crate::files::Files;

/// What came of loading a shader.
#[derive(Debug)]
pub struct Loaded {
    /// Absent exactly if there are errors.
    pub module: Option<Module>,
    pub diagnostics: Diagnostics,
    /// The files that were read and, of those that are missing, the paths that were tried: what
    /// a watcher has to look at.
    pub read: Vec<PathBuf>,
}

/// Loads the shader `name`, which the file `beside` names, with all that it imports. Texts are
/// registered in `sources` under the paths at which they were found.
///
/// If the named file itself is missing or unreadable, the diagnostic has no label: the caller
/// knows where the name stands.
pub fn load(files: &dyn Files, sources: &mut Sources, name: &str, beside: Option<&Path>) -> Loaded {
    let gathered = Gathered::new(files, sources, name, beside);
    let parsed = gathered.parse();
    gathered.finish(parsed)
}

/// A shader with its imports, of which many may be parsed at once.
pub(crate) struct Gathered(assemble::Outcome);

/// What parsing gave; nothing if there was no whole text.
pub(crate) struct Parsed(Option<Result<parse::Parsed, Box<Diagnostic>>>);

impl Gathered {
    pub fn new(files: &dyn Files, sources: &mut Sources, name: &str, beside: Option<&Path>) -> Self {
        Self(assemble::assemble(files, sources, name, beside))
    }

    pub fn parse(&self) -> Parsed {
        Parsed(self.0.assembled.as_ref().map(parse::parse))
    }

    pub fn finish(self, parsed: Parsed) -> Loaded {
        let assemble::Outcome { assembled, mut diagnostics, read } = self.0;
        let module = assembled.zip(parsed.0).and_then(|(assembled, parsed)| match parsed {
            Ok(parsed) => Some(inspect::inspect(assembled, parsed)),
            Err(diagnostic) => {
                diagnostics.push(*diagnostic);
                None
            }
        });
        Loaded { module, diagnostics, read }
    }
}
