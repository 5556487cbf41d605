//! Folders for tests, and the program run in them.

#![allow(dead_code, reason = "each test program uses a part of it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder that goes with the test.
#[derive(Debug)]
pub struct Project(PathBuf);

static NEXT: AtomicU32 = AtomicU32::new(0);

impl Project {
    pub fn empty() -> Self {
        let unique = format!("meniscus-test-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let folder = std::env::temp_dir().join(unique);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// With what `meniscus new dots` makes.
    pub fn new() -> Self {
        let project = Self::empty();
        let made = project.run(&["new", "dots"]);
        assert_eq!(made.code, 0, "{}", made.stderr);
        project
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    pub fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub fn edit(&self, name: &str, from: &str, to: &str) {
        let text = self.text(name);
        assert!(text.contains(from), "{name} lacks {from:?}");
        self.write(name, text.replace(from, to));
    }

    /// All files, sorted.
    pub fn files(&self) -> Vec<String> {
        let mut found = Vec::new();
        list(&self.0, &self.0, &mut found);
        found.sort();
        found
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
        command.args(args).current_dir(&self.0).env("NO_COLOR", "1").stdin(Stdio::null());
        command
    }

    pub fn run(&self, args: &[&str]) -> Run {
        Run::from(self.command(args).output().unwrap())
    }
}

impl Drop for Project {
    fn drop(&mut self) {
        // What is left in the folder for temporary files harms nobody.
        _ = std::fs::remove_dir_all(&self.0);
    }
}

fn list(root: &Path, folder: &Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        match path.is_dir() {
            true => list(root, &path, found),
            false => found.push(path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/")),
        }
    }
}

/// How a run of the program ended.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    /// Without what drivers print on their own account.
    pub stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let stderr = String::from_utf8_lossy(&output.stderr);
        let own = stderr.lines().filter(|line| !line.contains("XDG_RUNTIME_DIR"));
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: own.map(|line| format!("{line}\n")).collect(),
        }
    }
}

/// Whether this machine can draw. Where it cannot, the test is shown as skipped, and in CI it fails.
pub fn has_adapter() -> bool {
    use meniscus::engine::{Gpu, GpuOptions};
    match Gpu::open(&GpuOptions::default()) {
        Ok(_) => true,
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "in CI there must be an adapter: {}", error.message);
            eprintln!("skipped: {}", error.message);
            false
        }
    }
}

/// A file of the data beside the repository; absent: the test is shown as skipped.
pub fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: there is no `{}`", path.display());
    None
}
