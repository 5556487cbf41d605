//! Playing, pausing, stepping and scrubbing.

use egui::{DragValue, Panel, RichText, Slider, Ui};

use super::theme;
use crate::viewer::action::Action;
use crate::viewer::clock::{Beat, Clock};
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
            scrub(ui, clock, actions);
            if clock.is_playing && clock.slowdown > 1.2 {
                ui.label(RichText::new(format!("slowed {:.1} x", clock.slowdown)).color(theme::WARN))
                    .on_hover_text("a frame takes longer than its time: time is slowed so that no step is left out");
            }
        });
    });
}

/// A slider over the frames of a sequence, else over time.
fn scrub(ui: &mut Ui, clock: &Clock, actions: &mut Vec<Action>) {
    let Beat { rate, first, last } = clock.beat;
    let Some(last) = last else {
        ui.weak(format!("frame {}", clock.frame()));
        let mut time_s = clock.time_s;
        ui.spacing_mut().slider_width = (ui.available_width() - 110.0).max(60.0);
        let slider = Slider::new(&mut time_s, 0.0..=clock.end_s).show_value(false);
        if ui.add(slider).on_hover_text("time").changed() {
            actions.push(Action::Seek(time_s));
        }
        return;
    };
    let mut repeats = clock.repeats;
    if ui.checkbox(&mut repeats, "repeat").on_hover_text("after the last frame comes the first").changed() {
        actions.push(Action::Repeat(repeats));
    }
    let mut frame = clock.frame();
    let number = ui.add(DragValue::new(&mut frame).range(first..=last).prefix("frame "));
    ui.weak(format!("of {first} to {last}, {rate} a second"));
    ui.spacing_mut().slider_width = (ui.available_width() - 110.0).max(60.0);
    let slider = ui.add(Slider::new(&mut frame, first..=last).show_value(false));
    if slider.on_hover_text("frames of the sequence").changed() || number.changed() {
        actions.push(Action::Seek(clock.time_of(frame)));
    }
}
