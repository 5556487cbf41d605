//! Playing, pausing, stepping and scrubbing.

use egui::{Panel, RichText, Slider, Ui};

use super::theme;
use crate::viewer::action::Action;
use crate::viewer::core::Core;

pub fn draw(ui: &mut Ui, core: &Core, actions: &mut Vec<Action>) {
    let state = &core.state;
    if !state.changes_over_time {
        return;
    }
    let clock = &state.clock;
    Panel::bottom("time").show(ui, |ui| {
        ui.horizontal(|ui| {
            let (text, on) = if clock.is_playing { ("Pause", false) } else { ("Play", true) };
            if ui.add_sized([54.0, 20.0], egui::Button::new(text)).on_hover_text("Space").clicked() {
                actions.push(Action::Play(on));
            }
            for (text, frames, key) in
                [("|<", 0, "restart (R)"), ("<", -1, "a frame back (,)"), (">", 1, "a frame on (.)")]
            {
                if ui.button(text).on_hover_text(key).clicked() {
                    actions.push(if frames == 0 { Action::Restart } else { Action::Step(frames) });
                }
            }
            ui.label(format!("{:.2} s", clock.time_s));
            ui.weak(format!("frame {}", clock.frame()));
            let mut time_s = clock.time_s;
            ui.spacing_mut().slider_width = (ui.available_width() - 110.0).max(60.0);
            let slider = Slider::new(&mut time_s, 0.0..=clock.end_s).show_value(false);
            if ui.add(slider).on_hover_text("time").changed() {
                actions.push(Action::Seek(time_s));
            }
            if clock.is_playing && clock.slowdown > 1.2 {
                ui.label(RichText::new(format!("slowed {:.1} x", clock.slowdown)).color(theme::WARN))
                    .on_hover_text("a frame takes longer than its time: time is slowed so that no step is left out");
            }
        });
    });
}
