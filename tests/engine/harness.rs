//! A test runner that can say "ignored" at run time: where there is no adapter, tests that need
//! one are shown so and never as passed. With `CI` set they fail.
//!
//! It understands what `cargo test` hands on: name filters, `--exact`, `--skip`, `--list`,
//! `--ignored`, and leaves the rest alone.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use meniscus::engine::{Engine, Gpu, GpuOptions};

/// A test and its name.
pub type Case = (&'static str, fn(&mut Engine));

/// Lists tests of modules by their paths.
#[macro_export]
macro_rules! cases {
    ($($path:path),* $(,)?) => { &[$((stringify!($path), $path as fn(&mut meniscus::engine::Engine))),*] };
}

struct Options {
    filters: Vec<String>,
    skips: Vec<String>,
    exact: bool,
    list: bool,
    ignored: bool,
}

fn options() -> Options {
    let mut options = Options { filters: Vec::new(), skips: Vec::new(), exact: false, list: false, ignored: false };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--exact" => options.exact = true,
            "--list" => options.list = true,
            "--ignored" => options.ignored = true,
            "--skip" => options.skips.extend(arguments.next()),
            "--test-threads" | "--format" | "--color" | "--logfile" => _ = arguments.next(),
            flag if flag.starts_with('-') => {}
            filter => options.filters.push(filter.to_owned()),
        }
    }
    options
}

impl Options {
    fn takes(&self, name: &str) -> bool {
        let fits = |filter: &String| if self.exact { name == filter } else { name.contains(filter.as_str()) };
        (self.filters.is_empty() || self.filters.iter().any(fits)) && !self.skips.iter().any(fits)
    }
}

/// Runs all cases that the command line chooses, each on the device but with nothing else of
/// the others.
pub fn run(cases: &[Case]) -> ExitCode {
    let options = options();
    if options.list {
        // None is always ignored; who asks for those alone gets an empty list.
        let listed = cases.iter().filter(|(name, _)| options.takes(name) && !options.ignored);
        listed.for_each(|(name, _)| println!("{name}: test"));
        return ExitCode::SUCCESS;
    }
    let chosen: Vec<&Case> = cases.iter().filter(|(name, _)| options.takes(name) && !options.ignored).collect();
    println!("\nrunning {} tests", chosen.len());
    let (mut failed, mut ignored) = (Vec::new(), 0);
    for (name, case) in &chosen {
        match Gpu::open(&GpuOptions::default()) {
            Ok(gpu) => {
                let mut engine = Engine::new(gpu);
                if catch_unwind(AssertUnwindSafe(|| case(&mut engine))).is_ok() {
                    println!("test {name} ... ok");
                } else {
                    println!("test {name} ... FAILED");
                    failed.push(*name);
                }
            }
            Err(diagnostic) if std::env::var_os("CI").is_some() => {
                println!("test {name} ... FAILED, {}", diagnostic.message);
                failed.push(*name);
            }
            Err(diagnostic) => {
                println!("test {name} ... ignored, {}", diagnostic.message);
                ignored += 1;
            }
        }
    }
    let passed = chosen.len() - failed.len() - ignored;
    let result = if failed.is_empty() { "ok" } else { "FAILED" };
    println!("\ntest result: {result}. {passed} passed; {} failed; {ignored} ignored", failed.len());
    failed.iter().for_each(|name| println!("    {name}"));
    if failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
