//! `meniscus test`: declared cases are drawn, each as a fresh run, and what comes out is held
//! against what they expect.

mod picture;
mod read;

use std::path::{Path, PathBuf};

use super::args::TestArgs;
use super::report::{Exit, report, say};
use super::session::Opening;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, Sources};
use crate::files::DiskFiles;
use crate::host::{Cache, Player, Session, load};
use crate::plan::stats::Statistic;
use crate::syntax::first_word;
use read::{Bounds, Case, Suite};

/// Where cases are looked for if no file is named.
const FOLDER: &str = "tests";
/// The word that a file of cases begins with.
const WORD: &str = "Tests";

pub fn run(args: &TestArgs) -> Exit {
    let mut sources = Sources::new();
    let suites = match suites(args, &mut sources) {
        Ok(suites) => suites,
        Err(found) => return report(&found, &sources),
    };
    let (mut passed, mut failed) = (0, Diagnostics::new());
    let mut cache = Cache::default();
    for suite in &suites {
        for case in suite.cases.iter().filter(|case| is_wanted(case, args)) {
            let found = draw(case, args, &mut sources, &mut cache).unwrap_or_else(|found| found);
            let verdict = if found.has_errors() { "FAILED" } else { "ok" };
            say(&format!("{verdict:<6}  {}: {}", suite.path.display(), case.name.value));
            passed += usize::from(!found.has_errors());
            failed.extend(Diagnostics(found.0.into_iter().filter(|d| d.severity == Severity::Error).collect()));
        }
    }
    let all = suites.iter().flat_map(|suite| &suite.cases).filter(|case| is_wanted(case, args)).count();
    if all == 0 {
        let error =
            Diagnostic::error(Code::USAGE, "no case is called so").hint("`--case` takes a part of a case's name");
        return report(&error.into(), &sources);
    }
    let exit = report(&failed, &sources);
    say(&format!("{passed} of {all} case{} passed", if all == 1 { "" } else { "s" }));
    exit
}

fn is_wanted(case: &Case, args: &TestArgs) -> bool {
    args.case.is_empty() || args.case.iter().any(|part| case.name.value.contains(part))
}

/// The files that are named, else all below the folder of tests; nothing is drawn if one of them is
/// wrong.
fn suites(args: &TestArgs, sources: &mut Sources) -> Result<Vec<Suite>, Diagnostics> {
    let mut files = args.files.clone();
    if files.is_empty() {
        gather(Path::new(FOLDER), &mut files);
        files.sort();
    }
    if files.is_empty() {
        let message = format!("no file below `{FOLDER}` begins with `{WORD}(`");
        let error = Diagnostic::error(Code::USAGE, message).hint("name a file of cases: `meniscus test FILE`");
        return Err(error.into());
    }
    let mut found = Diagnostics::new();
    let suites = files.iter().filter_map(|file| read::suite(file, sources, &mut found)).collect();
    if found.has_errors() { Err(found) } else { Ok(suites) }
}

/// Every file of cases in a folder and those below it.
fn gather(folder: &Path, files: &mut Vec<PathBuf>) {
    for path in std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()) {
        if path.is_dir() && !path.is_symlink() {
            gather(&path, files);
        } else if path.extension().is_some_and(|end| end == "ron")
            && std::fs::read_to_string(&path).is_ok_and(|text| first_word(&text) == WORD)
        {
            files.push(path);
        }
    }
}

/// Draws a case on a device of its own; gives what is wrong with what came out.
///
/// # Errors
/// If it cannot be drawn.
fn draw(case: &Case, args: &TestArgs, sources: &mut Sources, cache: &mut Cache) -> Result<Diagnostics, Diagnostics> {
    let opening = Opening::begin(args.backend.as_deref());
    let loaded = load(&DiskFiles, sources, &case.job, cache);
    let content = loaded.content.ok_or(loaded.diagnostics)?;
    let mut session = Session::new(opening.wait()?);
    session.build(content)?;
    let mut found = Diagnostics::new();
    let mut player = Player::new(session.tracks(), case.job.when, DiskFiles);
    session.draw_at(case.job.when, &mut player, case.picture.is_some())?;
    if !case.stats.is_empty() {
        let told = session.statistics()?;
        case.stats.iter().filter_map(|bounds| outside(case, bounds, &told)).for_each(|fault| found.push(fault));
    }
    if let Some(expected) = &case.picture {
        let drawn = session.encoded(crate::host::picture::PictureKind::Png, false)?;
        picture::compare(case, expected, &drawn, args.bless).into_iter().for_each(|fault| found.push(fault));
    }
    Ok(found)
}

/// A statistic that is not what was expected.
fn outside(case: &Case, bounds: &Bounds, told: &[Statistic]) -> Option<Diagnostic> {
    let (case, name) = (&case.name.value, &bounds.name.value);
    let failed = |message: String, label: &str| {
        Some(Diagnostic::error(Code::TEST_FAILED, format!("{case}: {message}")).at(bounds.span, label))
    };
    let Some(statistic) = told.iter().find(|statistic| statistic.path == *name) else {
        let known: Vec<&str> = told.iter().map(|statistic| statistic.path.as_str()).collect();
        let unknown = failed(format!("the graph has no statistic `{name}`"), "expected here")?;
        let hint = match known.as_slice() {
            [] => "a graph declares them under `stats:`".to_owned(),
            known => format!("it has {}", known.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")),
        };
        return Some(unknown.nearest(name, known).hint(hint));
    };
    match statistic.value {
        Some(value) if bounds.holds(value) => None,
        Some(value) => failed(format!("`{name}` is {value}, and must be {bounds}"), "expected so"),
        None => failed(format!("`{name}` has no value, and must be {bounds}"), "expected so"),
    }
}
