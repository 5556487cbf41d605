//! The page that is there while nothing is open.

use std::path::{Path, PathBuf};

use egui::{ScrollArea, Ui};

use super::Layout;
use crate::viewer::action::Action;

pub fn draw(ui: &mut Ui, layout: &mut Layout, actions: &mut Vec<Action>) {
    ui.add_space(60.0);
    ui.vertical_centered(|ui| {
        ui.heading("Drop a file here");
        ui.add_space(4.0);
        ui.label("a scene (.ron), a mesh (.gltf, .glb, .obj) or particles (.vtk, .vtu, .vtp, .ply, .bgeo, .xyz, .csv, .json, .pdb, .ptc)");
        ui.weak("then, onto what is open: a graph (.ron), a mesh (.gltf, .glb, .obj), an environment (.hdr, .exr, .png, .jpg)");
        ui.add_space(24.0);
        let scenes = layout.scenes.get_or_insert_with(scenes);
        if scenes.is_empty() {
            ui.weak("there are no scenes in this folder or in its folder `scenes`");
            return;
        }
        ui.label("or open a scene of this folder");
        ui.add_space(6.0);
        ScrollArea::vertical().show(ui, |ui| {
            for scene in scenes.iter() {
                if ui.button(scene.display().to_string()).clicked() {
                    actions.push(Action::Open(scene.clone()));
                }
            }
        });
    });
}

/// Scenes here and in `scenes/`.
fn scenes() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in [".", "scenes"] {
        let Ok(entries) = std::fs::read_dir(folder) else { continue };
        for path in entries.flatten().map(|entry| entry.path()) {
            let path = path.strip_prefix(".").map(Path::to_owned).unwrap_or(path);
            if path.extension().is_some_and(|end| end == "ron") && is_scene(&path) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Whether a file is a scene that can be opened by itself: one that has particles.
fn is_scene(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|text| text.contains("Scene(") && text.contains("particles:"))
}
