//! The line at the bottom: the device, the picture's size, times and memory.

use egui::{Panel, RichText, Ui};

use super::theme;
use crate::viewer::core::Core;

pub fn draw(ui: &mut Ui, core: &Core) {
    let state = &core.state;
    Panel::bottom("status").show(ui, |ui| {
        ui.horizontal(|ui| {
            if let Some((text, at)) = &state.notice
                && at.elapsed().as_secs() < 6
            {
                ui.label(RichText::new(text).color(theme::ACCENT));
                ui.ctx().request_repaint_after(std::time::Duration::from_secs(6));
            } else {
                ui.weak(&state.device);
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                // What takes no time to be seen is not told.
                if let Some(since) = state.busy.filter(|since| since.elapsed() >= SEEN) {
                    ui.label(
                        RichText::new(format!("building {:.1} s", since.elapsed().as_secs_f64())).color(theme::WARN),
                    );
                    ui.ctx().request_repaint_after(std::time::Duration::from_millis(100));
                    ui.separator();
                }
                if core.plan().is_none() {
                    return;
                }
                ui.label(bytes(state.memory_bytes)).on_hover_text("memory of textures and buffers");
                ui.separator();
                let [graph, present] = &state.times;
                ui.label(format!("CPU {:.2} ms", graph.encode.smooth + present.encode.smooth))
                    .on_hover_text("encoding a frame, smoothed");
                ui.separator();
                ui.label(format!("GPU {:.1} ms", graph.gpu.smooth + present.gpu.smooth))
                    .on_hover_text("all passes of a frame, smoothed");
                ui.separator();
                let [width, height] = state.viewport;
                ui.label(format!("{width} x {height} px"));
            });
        });
    });
}

/// The worker is told to be at work after this.
const SEEN: std::time::Duration = std::time::Duration::from_millis(150);

/// A size that people read.
pub fn bytes(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        1_048_576..1_073_741_824 => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
        _ => format!("{:.2} GiB", bytes as f64 / 1_073_741_824.0),
    }
}
