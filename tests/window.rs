//! A real window under a virtual display. Skipped, visibly, where there is no Xvfb, xdotool or ImageMagick; in CI
//! they must be there.

#![cfg(all(feature = "viewer", target_os = "linux"))]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/project.rs"]
mod project;

use std::process::{Command, Stdio};

use project::{Project, has_adapter};

const TOOLS: &[&str] = &["xvfb-run", "Xvfb", "xauth", "xdotool", "import", "convert", "compare"];

fn has_tools() -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let is_there = |tool: &str| std::env::split_paths(&paths).any(|folder| folder.join(tool).is_file());
    let missing: Vec<&str> = TOOLS.iter().copied().filter(|tool| !is_there(tool)).collect();
    if missing.is_empty() {
        return true;
    }
    assert!(std::env::var_os("CI").is_none(), "in CI there must be {}", missing.join(", "));
    eprintln!("skipped: there is no {}", missing.join(", "));
    false
}

#[test]
fn a_window_starts_draws_takes_input_shows_an_error_and_recovers() {
    if !has_tools() || !has_adapter() {
        return;
    }
    let project = Project::new();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/window/drive.sh");
    let driven = Command::new("xvfb-run")
        .args(["-a", "-s", "-screen 0 1280x800x24", script, env!("CARGO_BIN_EXE_meniscus")])
        .current_dir(project.path(""))
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&driven.stdout).into_owned() + &String::from_utf8_lossy(&driven.stderr);
    if let Some(folder) = std::env::var_os("MENISCUS_KEEP") {
        for name in project.files().iter().filter(|name| name.ends_with(".png")) {
            std::fs::copy(project.path(name), std::path::Path::new(&folder).join(name)).unwrap();
        }
    }
    assert!(driven.status.success(), "{said}");
}
