//! `meniscus view`: the window.

use super::args::ViewArgs;
use super::report::{Exit, report};
use crate::diagnostic::{Diagnostics, Sources};

pub fn run(args: &ViewArgs) -> Exit {
    match view(args) {
        Ok(()) => Exit::Done,
        Err(found) => report(&found, &Sources::new()),
    }
}

#[cfg(feature = "viewer")]
fn view(args: &ViewArgs) -> Result<(), Diagnostics> {
    use std::path::Path;

    use crate::files::DiskFiles;
    use crate::host::renderable;
    use crate::viewer::{Options, run};

    let job = if args.scene.scene == Path::new(HERE) {
        None
    } else {
        renderable(&DiskFiles, &args.scene.scene)?;
        Some(super::session::job(&args.scene))
    };
    let pace = run(Options { job, backend: args.scene.backend.clone() })?;
    if args.timings {
        super::report::say(&pace.line());
    }
    Ok(())
}

#[cfg(not(feature = "viewer"))]
fn view(_args: &ViewArgs) -> Result<(), Diagnostics> {
    use crate::diagnostic::{Code, Diagnostic};

    let message = "this build has no window: it was made without the feature `viewer`";
    Err(Diagnostic::error(Code::USAGE, message)
        .hint("`meniscus watch SCENE -o FILE` follows changes without one")
        .into())
}

/// What stands for no scene: a list of those that are in this folder.
pub const HERE: &str = ".";
