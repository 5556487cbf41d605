//! The passes in planned order: time on the GPU with its history, on the CPU, and a switch for each.

use egui::{RichText, ScrollArea, Sense, Stroke, Ui};

use super::{Layout, Middle, theme};
use crate::engine::UnitReport;
use crate::plan::model::Plan;
use crate::viewer::action::Action;
use crate::viewer::core::Core;
use crate::viewer::history::{LENGTH, Series};
use crate::viewer::look::{self, Look};

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    let Some(plan) = core.plan() else {
        ui.weak("nothing is built yet");
        return;
    };
    let [graph, present] = &core.state.times;
    ui.horizontal(|ui| {
        plot(ui, &graph.gpu, [150.0, 34.0]);
        ui.vertical(|ui| {
            ui.label(format!("GPU {:.2} ms", graph.gpu.smooth)).on_hover_text("all passes of the graph, smoothed");
            ui.weak(format!("presenting {:.2} ms", present.gpu.smooth));
            ui.weak(format!("CPU {:.2} ms", graph.encode.smooth))
                .on_hover_text("encoding the graph's passes, smoothed");
        });
    });
    let skipped = plan.passes.iter().filter(|p| core.state.units.get(p.unit).is_some_and(|unit| !unit.ran)).count();
    ui.horizontal(|ui| {
        ui.weak(format!("{} of {} passes ran", plan.passes.len() - skipped, plan.passes.len()));
        let mut all = core.state.runs_all;
        if ui.checkbox(&mut all, "run all").on_hover_text("also passes whose results are there already").changed() {
            actions.push(Action::RunAll(all));
        }
    });
    statistics(ui, core, plan, actions);
    ui.separator();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        rows(ui, core, plan, layout, actions);
        culled(ui, plan);
    });
}

/// The graph's statistics. While they are not looked at, nothing runs for them and nothing is read back.
fn statistics(ui: &mut Ui, core: &Core, plan: &Plan, actions: &mut Vec<Action>) {
    if plan.stats.is_empty() {
        return;
    }
    let shown = ui.collapsing(format!("{} statistics", plan.stats.len()), |ui| {
        egui::Grid::new("statistics").num_columns(2).striped(true).show(ui, |ui| {
            for stat in &plan.stats {
                ui.label(&stat.path).on_hover_text(&stat.text);
                let value = core.state.statistics.iter().find(|known| known.path == stat.path);
                match (value.map(|known| known.value), &stat.missing) {
                    (Some(Some(value)), _) => _ = ui.monospace(value.to_string()),
                    (Some(None), Some(path)) => {
                        _ = ui.weak("no value").on_hover_text(format!("nothing writes `{path}` as things are"));
                    }
                    (Some(None), None) => _ = ui.weak("no value"),
                    (None, _) => _ = ui.weak("-"),
                }
                ui.end_row();
            }
        });
    });
    let is_open = shown.openness > 0.0;
    if is_open != core.state.counts {
        actions.push(Action::Count(is_open));
    }
}

fn rows(ui: &mut Ui, core: &Core, plan: &Plan, layout: &mut Layout, actions: &mut Vec<Action>) {
    for (index, pass) in plan.passes.iter().enumerate() {
        let is_on = !core.state.switched_off.contains(&pass.path);
        ui.horizontal(|ui| {
            let mut on = is_on;
            if ui.checkbox(&mut on, "").on_hover_text("whether this pass runs").changed() {
                actions.push(Action::Switch { pass: pass.path.clone(), on });
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let unit = core.state.units.get(pass.unit).filter(|_| is_on && pass.steps.is_none());
                match core.state.times[0].pass(&pass.path).filter(|_| is_on) {
                    Some(series) if unit.is_some_and(|unit| !unit.ran) => {
                        let text = RichText::new("skipped").color(theme::FAINT);
                        ui.label(text).on_hover_text("nothing that it depends on has changed: its results are kept");
                        plot(ui, series, [60.0, 14.0]);
                    }
                    Some(series) => {
                        ui.monospace(format!("{:7.3} ms", series.smooth)).on_hover_text("on the GPU");
                        plot(ui, series, [60.0, 14.0]);
                        if let Some(recording) = core.state.times[0].recording(&pass.path) {
                            let text = RichText::new(format!("{:4.0} µs", recording.smooth * 1e3));
                            ui.label(text.monospace().color(theme::FAINT)).on_hover_text(
                                "recording it on the CPU; of draws that share a render pass the first has it all",
                            );
                        }
                    }
                    None => _ = ui.weak("-"),
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    // The end of a long path tells most.
                    let most = (ui.available_width() / 7.0) as usize;
                    let text = RichText::new(super::ending(&pass.path, most));
                    let text = if is_on { text } else { text.color(theme::FAINT).strikethrough() };
                    let label = ui.add(egui::Label::new(text).truncate().sense(Sense::click()));
                    let label =
                        label.on_hover_text(format!("{}\n{}\nclick: what it reads and writes", pass.path, why(unit)));
                    egui::Popup::menu(&label).show(|ui| accesses(ui, plan, index, layout, actions));
                });
            });
        });
    }
}

/// Why a pass ran or did not.
pub fn why(unit: Option<&UnitReport>) -> String {
    match unit {
        None => "runs with each step, or is switched off".into(),
        Some(unit) if !unit.ran => "skipped: nothing that it depends on has changed".into(),
        Some(unit) => {
            let why: Vec<String> = unit.why.iter().map(ToString::to_string).collect();
            format!("ran: {}", why.join(", "))
        }
    }
}

/// What a pass touches; each can be looked at after it.
fn accesses(ui: &mut Ui, plan: &Plan, index: usize, layout: &mut Layout, actions: &mut Vec<Action>) {
    let pass = &plan.passes[index];
    ui.strong(&pass.path);
    for access in &pass.accesses {
        let Some(object) = look::object(plan, access.object) else { continue };
        let how = match (access.read, access.write) {
            (true, true) => "reads and writes",
            (_, true) => "writes",
            _ => "reads",
        };
        let button = ui.button(format!("{how} {}", object.path)).on_hover_text(look::described(object));
        if button.clicked() {
            let after = Some(pass.path.clone());
            let (mip, layer) = (access.mips.start, access.layers.start);
            actions.push(Action::Look(Some(Look { path: object.path.clone(), after, mip, layer })));
            layout.middle = Middle::Resource;
            ui.close();
        }
    }
}

fn culled(ui: &mut Ui, plan: &Plan) {
    if plan.culled.is_empty() {
        return;
    }
    ui.add_space(6.0);
    ui.collapsing(format!("{} not needed", plan.culled.len()), |ui| {
        for culled in &plan.culled {
            ui.label(RichText::new(&culled.path).color(theme::FAINT)).on_hover_text(&culled.why);
            ui.weak(&culled.why);
        }
    });
}

/// A small curve of the last frames.
pub fn plot(ui: &mut Ui, series: &Series, size: [f32; 2]) {
    let (rect, response) = ui.allocate_exact_size(size.into(), Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, theme::BACKDROP);
    let top = series.largest().max(1e-6) * 1.1;
    let step = rect.width() / (LENGTH - 1) as f32;
    let from = rect.right() - step * series.values.len().saturating_sub(1) as f32;
    let points: Vec<egui::Pos2> = series
        .values
        .iter()
        .enumerate()
        .map(|(i, ms)| egui::pos2(from + step * i as f32, rect.bottom() - (ms / top) as f32 * rect.height()))
        .collect();
    painter.line(points, Stroke::new(1.0, theme::ACCENT));
    response.on_hover_text(format!(
        "last {:.3} ms, smoothed {:.3} ms, most {:.3} ms of {} frames",
        series.values.back().copied().unwrap_or(0.0),
        series.smooth,
        series.largest(),
        series.values.len()
    ));
}
