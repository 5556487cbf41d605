//! A disk that fills up, a shader that takes its time, folders that vanish.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use meniscus::graph::value::Value;
use meniscus::viewer::action::Action;
use meniscus::viewer::core::Recording;

use crate::desk::{Desk, PATIENCE};
use crate::project::has_adapter;

const SHADER: &str = "shaders/dots/discs.wgsl";

/// A file system in memory with room for a few kilobytes.
struct SmallDisk(PathBuf);

impl SmallDisk {
    /// Absent, and shown as skipped, where mounting is not allowed.
    fn mount(at: PathBuf) -> Option<Self> {
        std::fs::create_dir_all(&at).unwrap();
        let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=48k", "tmpfs"]).arg(&at).output();
        if mount.is_ok_and(|output| output.status.success()) {
            return Some(Self(at));
        }
        eprintln!("skipped: no small file system can be mounted here");
        None
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // What stays mounted goes with the machine.
        _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_disk_that_fills_up_ends_a_recording_and_leaves_whole_pictures() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let Some(disk) = SmallDisk::mount(desk.project.path("disk")) else { return };
    let first = desk.picture();
    let path = disk.0.join("a_##.png");
    desk.core.act(Action::Record(Recording { path, from: 0, to: 59, next: 0 }));
    desk.until("the end of the recording", |core| core.state.recording.is_none());
    let said = desk.notice().to_owned();
    let written = names(&disk.0);
    assert!(!written.is_empty() && written.len() < 60, "{written:?}");
    assert!(said.contains(&format!("recording ended after {} pictures", written.len())), "{said}: {written:?}");
    assert!(said.contains("cannot be written"), "{said}");
    for name in &written {
        assert!(std::fs::read(disk.0.join(name)).unwrap() == first, "{name} is not whole");
    }
    assert!(desk.picture() == first, "the window goes on");
}

#[test]
fn a_shader_that_takes_its_time_is_told_and_can_be_mended_meanwhile() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    // Ten times what a good frame takes, and far less than the slow one on any machine.
    desk.core.state.patience = Duration::from_millis(50);
    // Drivers end loops that never end after some tens of thousands of rounds: many of them take long.
    let good = desk.project.text(SHADER);
    let slow = "var x = corner.at.x; for (var k = 0u; k < 30000u; k++) { x = sin(x * 1.01 + f32(k)); }
        let r2 = dot(corner.at, corner.at) + x * 1e-9;";
    desk.project.write(SHADER, good.replace("let r2 = dot(corner.at, corner.at);", slow));
    let (mut longest, began) = (Duration::ZERO, Instant::now());
    let mut is_mended = false;
    let mut seconds = None;
    while seconds.is_none() {
        assert!(began.elapsed() < PATIENCE * 2, "{is_mended}, {}", desk.notice());
        let before = Instant::now();
        desk.core.tick(before);
        longest = longest.max(before.elapsed());
        if !is_mended && ["has been drawing for", "drawing took"].iter().any(|said| desk.notice().contains(said)) {
            is_mended = true;
            desk.project.write(SHADER, &good);
        }
        if is_mended && desk.core.state.reloads.len() >= 3 && !desk.core.is_drawing() {
            seconds = Some(began.elapsed().as_secs_f64());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    // A software driver draws in the thread that hands over the commands; of others nobody waits for a frame.
    let draws_itself = desk.core.state.device.contains("llvmpipe");
    assert!(draws_itself || longest < Duration::from_millis(500), "the interface waited {longest:?} for a frame");
    assert!(desk.picture() == first);
}

#[test]
fn what_the_driver_compiles_is_compiled_elsewhere() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    for (from, to) in [("color * light", "color.yxz * light"), ("color.yxz * light", "color.zyx * light")] {
        desk.edit(SHADER, from, to);
        let reload = &desk.core.state.reloads[0];
        assert_eq!((reload.pipelines_built, reload.pipelines_late), (1, 0), "{reload:?}");
    }
    desk.edit("graphs/dots.ron", "format: Rgba16Float", "format: Rgba8Unorm");
    let reload = &desk.core.state.reloads[0];
    assert!(reload.pipelines_built > 0 && reload.pipelines_late == 0, "{reload:?}");
}

#[test]
fn state_that_starts_anew_is_named_in_the_list() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::stateful();
    desk.rest();
    desk.edit("graphs/dots.ron", "cells\":   Int(default: 192", "cells\":   Int(default: 64");
    let resets = desk.core.state.reloads[0].resets.clone();
    assert!(resets.len() == 1 && resets[0].contains("starts anew"), "{resets:?}");
    // What has nothing to do with state lets it be.
    desk.edit("shaders/dots/show.wgsl", "+ 0.6 * shine", "+ 0.5 * shine");
    assert_eq!(desk.core.state.reloads[0].resets, [""; 0]);
}

#[test]
fn a_folder_that_vanishes_and_comes_back_is_followed() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    let (folder, away) = (desk.project.path("shaders"), desk.project.path("away"));
    let reloads = desk.core.state.reloads.len();
    std::fs::rename(&folder, &away).unwrap();
    desk.until("word of the folder", |core| core.state.reloads.len() > reloads);
    assert!(desk.core.state.findings.as_ref().is_some_and(|found| found.is_stale));
    assert!(desk.picture() == first, "the last good picture stays");
    std::fs::rename(&away, &folder).unwrap();
    desk.until("the folder to be back", |core| core.state.findings.as_ref().is_none_or(|found| !found.is_stale));
    desk.edit(SHADER, "color * light", "color.yxz * light");
    assert!(desk.picture() != first, "changes are seen again");
}

#[test]
fn an_error_stays_until_it_is_mended_whatever_is_done_meanwhile() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::resizable();
    desk.edit(SHADER, "color * light", "hue * light");
    let wrong = |desk: &Desk| {
        let findings = desk.core.state.findings.as_ref().unwrap();
        assert!(findings.is_stale && findings.counts().0 == 1, "{findings:?}");
    };
    wrong(&desk);
    // As when the messages take room from the picture.
    desk.core.want_size([160, 80]);
    desk.until("another size", |core| core.state.viewport == [160, 80]);
    desk.rest();
    wrong(&desk);
    let before = desk.picture();
    desk.core.act(Action::Set { path: "size".into(), value: Some(Value::Float(3.0)) });
    desk.rest();
    assert!(desk.picture() != before, "the last good state can still be changed");
    wrong(&desk);
    desk.edit(SHADER, "hue * light", "color * light");
    desk.rest();
    assert!(desk.core.state.findings.is_none());

    // Also where there is nothing at all to draw in another size: nobody waits for it.
    desk.project.write("wrong.ply", "this is no ply");
    desk.core.act(Action::Open(desk.project.path("wrong.ply")));
    desk.until("an error", |core| core.state.findings.as_ref().is_some_and(|found| found.is_stale));
    desk.core.want_size([160, 120]);
    std::thread::sleep(Duration::from_millis(150));
    desk.rest();
    wrong(&desk);
}

#[cfg(unix)]
#[test]
fn links_that_lead_in_a_circle_are_told() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::new();
    let first = desk.picture();
    // A folder in itself, and a file that leads to itself.
    std::os::unix::fs::symlink(".", desk.project.path("shaders/dots/again")).unwrap();
    let shader = desk.project.path(SHADER);
    let kept = desk.project.path("kept.wgsl");
    let reloads = desk.core.state.reloads.len();
    std::fs::rename(&shader, &kept).unwrap();
    std::os::unix::fs::symlink(&shader, &shader).unwrap();
    desk.until("word of the link", |core| core.state.reloads.len() > reloads);
    assert!(desk.core.state.findings.as_ref().is_some_and(|found| found.is_stale));
    assert!(desk.picture() == first);
    std::fs::remove_file(&shader).unwrap();
    std::fs::rename(&kept, &shader).unwrap();
    desk.until("the file to be back", |core| core.state.findings.as_ref().is_none_or(|found| !found.is_stale));
    desk.edit(SHADER, "color * light", "color.yxz * light");
    assert!(desk.picture() != first);
}

#[test]
fn a_window_of_no_size_is_no_trouble() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::resizable();
    desk.rest();
    let first = desk.picture();
    for size in [[16, 16], [1, 1], [0, 0], [0, 300], [160, 120]] {
        desk.core.want_size(size);
        std::thread::sleep(Duration::from_millis(150));
        desk.rest();
        assert!(desk.core.state.findings.as_ref().is_none_or(|found| !found.is_stale), "{size:?}");
    }
    assert!(desk.picture() == first);
}
