//! What a name that nothing bears may have meant.

use naga::front::wgsl::ParseError;

use crate::diagnostic::Diagnostic;
use crate::files;
use crate::shader::assemble::Assembled;
use crate::shader::declare::Declarations;
use crate::shader::scan::{Kind, scan};

/// Adds the nearest name that is known, and the library file that declares the name.
pub(super) fn suggest(diagnostic: Diagnostic, found: &ParseError, assembled: &Assembled) -> Diagnostic {
    let Some((span, _)) = found.labels().next() else { return diagnostic };
    if !found.message().starts_with("no definition in scope") {
        return diagnostic;
    }
    let Some(name) = span.to_range().and_then(|range| assembled.whole.get(range)) else { return diagnostic };
    match library_file(name) {
        Some(path) => diagnostic.hint(format!("`{path}` declares it: `#import \"{path}\"`")),
        None => diagnostic.nearest(name, known(name, assembled)),
    }
}

/// Names that the module declares or that WGSL brings.
fn known<'a>(name: &str, assembled: &'a Assembled) -> Vec<&'a str> {
    let mut known: Vec<&str> = assembled.declarations.names().collect();
    for (text, scan) in &assembled.texts {
        for pair in scan.tokens.windows(2) {
            let is_local = matches!(pair[0].text(text), "let" | "var" | "const") || pair[1].is(b':');
            let word = if pair[1].is(b':') { pair[0] } else { pair[1] };
            if is_local && word.kind == Kind::Word {
                known.push(word.text(text));
            }
        }
    }
    known.extend(naga::keywords::wgsl::BUILTIN_IDENTIFIERS);
    known.retain(|k| *k != name);
    known
}

/// The carried library file that declares a name, by the path that an import would use.
fn library_file(name: &str) -> Option<&'static str> {
    let shaders = files::library().filter(|path| path.starts_with("shaders/lib/"));
    let declares = |path: &&str| {
        let text = files::library_file(path.as_ref()).and_then(|bytes| std::str::from_utf8(bytes).ok());
        text.is_some_and(|text| {
            let mut declarations = Declarations::default();
            // The places are not asked for, so any file will do.
            declarations.add(crate::diagnostic::FileId(0), text, &scan(text));
            declarations.name(name).is_some()
        })
    };
    shaders.filter(declares).find_map(|path| path.strip_prefix("shaders/"))
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::diagnostic::nearest;

    #[test]
    fn names_that_only_others_declare_are_not_known() {
        assert_eq!(library_file("no_library_declares_this"), None);
        assert_eq!(nearest("clmap", naga::keywords::wgsl::BUILTIN_IDENTIFIERS.iter().copied()).unwrap(), "clamp");
    }
}
