//! Writing a picture or a sequence.

use std::path::PathBuf;

use egui::{DragValue, Ui, Window};

use super::Layout;
use crate::viewer::action::Action;
use crate::viewer::core::{Core, Recording, free_name};

/// What is filled in.
#[derive(Clone, Debug, Default)]
pub struct Form {
    is_open: bool,
    path: String,
    from: u64,
    to: u64,
}

impl Form {
    pub fn open(&mut self, core: &Core) {
        self.is_open = true;
        let job = core.state.job.as_ref();
        let stem = job.and_then(|job| Some(job.source.file_stem()?.to_string_lossy().into_owned()));
        self.path = free_name(stem.as_deref().unwrap_or("picture"), "png").display().to_string();
        let clock = &core.state.clock;
        (self.from, self.to) = match clock.beat.last {
            Some(last) => (clock.beat.first, last),
            None => (clock.frame(), clock.frame() + 59),
        };
    }
}

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    let form = &mut layout.capture;
    let mut is_open = form.is_open;
    let shown = Window::new("Write a picture").open(&mut is_open).resizable(false).collapsible(false);
    shown.default_width(360.0).default_pos([420.0, 44.0]).show(ui.ctx(), |ui| {
        ui.label("file: .png as the screen shows it, .exr linear light");
        ui.add(egui::TextEdit::singleline(&mut form.path).desired_width(f32::INFINITY));
        let [width, height] = core.state.viewport;
        ui.weak(format!("{width} x {height} pixels, as the window has it"));
        ui.horizontal(|ui| {
            if ui.button("Write this picture").clicked() {
                actions.push(Action::Shoot(PathBuf::from(form.path.trim())));
                form.is_open = false;
            }
        });
        ui.separator();
        match &core.state.recording {
            Some(recording) => {
                let text = format!("{} of {}", recording.next - recording.from, recording.to - recording.from + 1);
                ui.add(egui::ProgressBar::new(recording.part()).text(text));
                if ui.button("Stop").clicked() {
                    actions.push(Action::StopRecording);
                }
            }
            None => {
                ui.horizontal(|ui| {
                    ui.label("frames");
                    ui.add(DragValue::new(&mut form.from));
                    ui.label("to");
                    ui.add(DragValue::new(&mut form.to));
                    ui.weak(format!("{} a second", core.state.clock.beat.rate));
                    if ui.button("Record").clicked() {
                        let path = PathBuf::from(form.path.trim());
                        let (from, to) = (form.from, form.to);
                        actions.push(Action::Record(Recording { path, from, to, next: from }));
                    }
                });
            }
        }
    });
    layout.capture.is_open &= is_open && !super::is_left(ui);
}
