//! The bar at the top: what is open, and what can be done with it.

use egui::{ComboBox, Panel, Ui};

use super::{Layout, Scale};
use crate::viewer::action::Action;
use crate::viewer::core::Core;
use crate::viewer::state::short;

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    Panel::top("top").show(ui, |ui| {
        ui.add_space(2.0);
        ui.horizontal(|ui| {
            let Some(job) = &core.state.job else {
                ui.strong("Meniscus");
                return;
            };
            ui.strong(short(&job.source)).on_hover_text(job.source.display().to_string());
            if let Some(plan) = core.plan() {
                ui.weak("drawn by");
                ui.label(short(&plan.graph)).on_hover_text(plan.graph.display().to_string());
            }
            given(ui, core, actions);
            ui.separator();
            if ui.button("Frame").on_hover_text("look at everything (F)").clicked() {
                actions.push(Action::Frame);
            }
            if ui.button("Home").on_hover_text("the scene's own camera (H)").clicked() {
                actions.push(Action::Home);
            }
            viewpoints(ui, core, actions);
            ui.separator();
            ComboBox::from_id_salt("scale").selected_text(layout.scale.name()).width(96.0).show_ui(ui, |ui| {
                for scale in Scale::ALL {
                    ui.selectable_value(&mut layout.scale, scale, scale.name());
                }
            });
            if ui.button("Picture...").on_hover_text("write a picture, or record a sequence").clicked() {
                layout.capture.open(core);
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.toggle_value(&mut layout.shows_help, "Help").on_hover_text("keys and mouse (F1)");
                ui.separator();
                ui.toggle_value(&mut layout.shows_side, "Passes");
                ui.toggle_value(&mut layout.shows_params, "Parameters");
                if core.state.findings.is_some() {
                    ui.toggle_value(&mut layout.shows_messages, "Messages");
                }
            });
        });
        ui.add_space(2.0);
    });
}

/// What was dropped onto the scene, each to be taken away again.
fn given(ui: &mut Ui, core: &Core, actions: &mut Vec<Action>) {
    let Some(job) = &core.state.job else { return };
    for path in job.meshes.iter().map(|(_, path)| path).chain(&job.environment) {
        ui.separator();
        ui.label(short(path))
            .on_hover_text(format!("dropped onto the scene: {}\nCtrl+S puts it into the scene file", path.display()));
        if ui.small_button("x").on_hover_text("take it away").clicked() {
            actions.push(Action::TakeAway(path.clone()));
        }
    }
}

fn viewpoints(ui: &mut Ui, core: &Core, actions: &mut Vec<Action>) {
    ui.menu_button("Views", |ui| {
        for slot in 1..=9 {
            ui.horizontal(|ui| {
                let is_there = core.state.viewpoints.contains_key(&slot);
                let go = ui.add_enabled(is_there, egui::Button::new(format!("go to {slot}")));
                if go.on_hover_text(format!("{slot}")).clicked() {
                    actions.push(Action::GoTo(slot));
                }
                if ui.button("keep here").on_hover_text(format!("Ctrl + {slot}")).clicked() {
                    actions.push(Action::Keep(slot));
                }
            });
        }
        ui.separator();
        let save = ui.button("Save the camera to the scene");
        if save.on_hover_text("its `camera:` becomes this one; all else stays").clicked() {
            actions.push(Action::SaveCamera);
            ui.close();
        }
    });
}
