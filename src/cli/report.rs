//! Saying what was found: people read the error stream, programs the output stream.

use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, Sources, Style, render_all};
use crate::engine::is_device_gone;

/// How a command ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    Done,
    /// Errors in a graph, a scene or a shader.
    Findings,
    /// Wrong usage, or input that cannot be read.
    Usage,
    /// No usable adapter, or a lost device.
    Device,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        match exit {
            Exit::Done => ExitCode::SUCCESS,
            Exit::Findings => ExitCode::from(1),
            Exit::Usage => ExitCode::from(2),
            Exit::Device => ExitCode::from(3),
        }
    }
}

impl Exit {
    /// What the errors among `diagnostics` amount to. A file that is missing or unreadable counts
    /// as unreadable input where no graph or scene names it; an asset always does.
    pub fn of(diagnostics: &Diagnostics) -> Self {
        let mut exit = Exit::Done;
        for found in diagnostics.iter().filter(|d| d.severity == Severity::Error) {
            match Self::of_error(found) {
                Exit::Device => return Exit::Device,
                Exit::Findings => exit = Exit::Findings,
                other if exit == Exit::Done => exit = other,
                _ => {}
            }
        }
        exit
    }

    fn of_error(error: &Diagnostic) -> Self {
        match error.id {
            _ if is_device_gone(error) => Exit::Device,
            Code::ASSET | Code::OUTPUT | Code::USAGE => Exit::Usage,
            Code::FILE_MISSING | Code::FILE_UNREADABLE if error.labels.is_empty() => Exit::Usage,
            _ => Exit::Findings,
        }
    }
}

/// Colours where a person watches and did not ask for none.
pub fn style() -> Style {
    let wanted = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    if wanted && io::stderr().is_terminal() { Style::Colored } else { Style::Plain }
}

/// Shows everything on the error stream and says how the command ends.
pub fn report(diagnostics: &Diagnostics, sources: &Sources) -> Exit {
    if !diagnostics.is_empty() {
        say(&render_all(diagnostics, sources, style()));
    }
    Exit::of(diagnostics)
}

/// A line for people.
pub fn say(text: &str) {
    // A closed error stream is nobody's fault and leaves nobody to tell.
    let mut stderr = io::stderr().lock();
    _ = stderr.write_all(text.as_bytes());
    if !text.ends_with('\n') {
        _ = stderr.write_all(b"\n");
    }
}

/// Data for programs, or for people who asked for it. A reader that has gone away ends it quietly.
pub fn print(text: &str) -> Exit {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            let failed = Diagnostic::error(Code::OUTPUT, format!("the output stream cannot be written: {error}"));
            report(&failed.into(), &Sources::new())
        }
        _ => Exit::Done,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::{FileId, Span};

    #[test]
    fn the_gravest_kind_of_error_decides_the_exit() {
        let asset = || Diagnostic::error(Code::ASSET, "a");
        let named = || Diagnostic::error(Code::FILE_MISSING, "b").at(Span::new(FileId(0), 0, 0), "here");
        let loose = || Diagnostic::error(Code::FILE_MISSING, "c");
        let device = || Diagnostic::error(Code::DEVICE, "the device was lost: d");
        let refused = || Diagnostic::error(Code::DEVICE, "the device refused d");
        let note = || Diagnostic::warning(Code::UNUSED, "e");
        let exit = |list: Vec<Diagnostic>| Exit::of(&Diagnostics(list));
        assert_eq!(exit(vec![]), Exit::Done);
        assert_eq!(exit(vec![note()]), Exit::Done);
        assert_eq!(exit(vec![note(), loose()]), Exit::Usage);
        assert_eq!(exit(vec![named()]), Exit::Findings);
        assert_eq!(exit(vec![asset(), named()]), Exit::Findings);
        assert_eq!(exit(vec![named(), device()]), Exit::Device);
        assert_eq!(exit(vec![refused()]), Exit::Findings);
    }
}
