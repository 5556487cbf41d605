//! What was reloaded, and how long it took.

use egui::{RichText, ScrollArea, Ui};

use super::theme;
use crate::viewer::core::Core;
use crate::viewer::state::Reload;

pub fn draw(ui: &mut Ui, core: &Core) {
    if core.state.reloads.is_empty() {
        ui.weak("nothing was read yet");
    }
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for reload in &core.state.reloads {
            row(ui, reload);
            ui.separator();
        }
    });
}

fn row(ui: &mut Ui, reload: &Reload) {
    ui.horizontal(|ui| {
        let color = if reload.is_good { theme::GOOD } else { theme::BAD };
        ui.label(RichText::new(if reload.is_good { "good" } else { "kept" }).color(color).monospace());
        ui.add(egui::Label::new(&reload.what).truncate()).on_hover_text(&reload.what);
    });
    let ago = reload.at.elapsed().as_secs();
    let ago = if ago < 60 { format!("{ago} s ago") } else { format!("{} min ago", ago / 60) };
    let text = if reload.is_good {
        format!(
            "{:.0} ms in all, {ago}; {} pipelines built, {} kept",
            reload.all_ms(),
            reload.pipelines_built,
            reload.pipelines_kept
        )
    } else {
        let plural = if reload.errors == 1 { "" } else { "s" };
        format!("{} error{plural}, {ago}: the last good picture stays", reload.errors)
    };
    for reset in &reload.resets {
        ui.label(RichText::new(reset).color(theme::WARN));
    }
    ui.weak(text).on_hover_text(format!(
        "noticing {:.1} ms, checking {:.1}, building {:.1}, drawing {}",
        reload.noticing_ms,
        reload.checking_ms,
        reload.building_ms,
        reload.drawing_ms.map_or("-".into(), |ms| format!("{ms:.1}")),
    ));
}
