//! Parameters as controls made from their declarations.

use egui::{ComboBox, DragValue, RichText, ScrollArea, Slider, Ui};

use super::{Layout, theme};
use crate::graph::model::ParamKind;
use crate::graph::value::Value;
use crate::host::Job;
use crate::plan::model::Param;
use crate::viewer::action::Action;
use crate::viewer::core::Core;
use crate::viewer::params::Shown;

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    ui.add_space(4.0);
    header(ui, core, layout, actions);
    ui.separator();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for group in &core.state.groups {
            let matching: Vec<&Shown> = group.params.iter().filter(|p| p.path.contains(layout.filter.trim())).collect();
            if matching.is_empty() {
                continue;
            }
            let title = if group.part.is_empty() { "graph" } else { group.part.as_str() };
            let changed = matching.iter().filter(|p| core.state.overrides.contains_key(&p.path)).count();
            let title = if changed > 0 { format!("{title}  ({changed} changed)") } else { title.to_owned() };
            let is_open = group.part.is_empty() || !layout.filter.trim().is_empty() || core.state.groups.len() == 1;
            egui::CollapsingHeader::new(RichText::new(title).strong())
                .id_salt(("group", &group.part))
                .default_open(is_open)
                .show(ui, |ui| {
                    for shown in matching {
                        parameter(ui, core, shown, actions);
                    }
                });
        }
    });
}

fn header(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.strong("Parameters");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let is_changed = !core.state.overrides.is_empty();
            let has_dropped = core.state.job.as_ref().is_some_and(Job::has_dropped);
            ui.add_enabled_ui(is_changed || has_dropped, |ui| {
                let what = "put the changed values into the scene file, and files that were dropped (Ctrl+S)";
                if ui.button("Save").on_hover_text(what).clicked() {
                    actions.push(Action::Save);
                }
            });
            ui.add_enabled_ui(is_changed, |ui| {
                if ui.button("Reset").on_hover_text("all values as the scene has them").clicked() {
                    actions.push(Action::ResetParams);
                }
            });
        });
    });
    ui.add(egui::TextEdit::singleline(&mut layout.filter).hint_text("filter").desired_width(f32::INFINITY));
}

fn parameter(ui: &mut Ui, core: &Core, shown: &Shown, actions: &mut Vec<Action>) {
    let changed = core.state.overrides.get(&shown.path);
    let value = changed.unwrap_or(&shown.param.value);
    let is_wide = matches!(shown.param.kind, ParamKind::Color | ParamKind::Vec2 | ParamKind::Vec3 | ParamKind::Vec4);
    ui.horizontal(|ui| {
        let color = if changed.is_some() { theme::ACCENT } else { ui.visuals().text_color() };
        let name = ui.label(RichText::new(&shown.name).color(color));
        name.on_hover_ui(|ui| about(ui, shown));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let is_changed = changed.is_some();
            let reset = ui.add_enabled(is_changed, egui::Button::new("x").small().frame(is_changed));
            if reset.on_hover_text("as the scene has it").clicked() {
                actions.push(Action::Set { path: shown.path.clone(), value: None });
            }
            if let Some(unit) = &shown.param.unit {
                ui.weak(unit);
            }
            if !is_wide && let Some(value) = control(ui, shown, value) {
                actions.push(Action::Set { path: shown.path.clone(), value: Some(value) });
            }
        });
    });
    if is_wide {
        // Several numbers have a line of their own.
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
            ui.add_space(18.0);
            if let Some(value) = control(ui, shown, value) {
                actions.push(Action::Set { path: shown.path.clone(), value: Some(value) });
            }
        });
    }
}

fn about(ui: &mut Ui, shown: &Shown) {
    let Param { about, default, min, max, unit, kind, .. } = &shown.param;
    ui.strong(&shown.path);
    if let Some(about) = about {
        ui.label(about);
    }
    let unit = unit.as_deref().unwrap_or_default();
    let default = default.as_ref().map(|d| format!("default {d} {unit}")).unwrap_or_default();
    let range = match (min, max) {
        (Some(min), Some(max)) => format!(", from {min} to {max}"),
        (Some(min), None) => format!(", from {min}"),
        (None, Some(max)) => format!(", up to {max}"),
        (None, None) => String::new(),
    };
    ui.weak(format!("{}, {default}{range}", kind.name()));
}

/// The control of a parameter; gives a value if a person changed it.
fn control(ui: &mut Ui, shown: &Shown, value: &Value) -> Option<Value> {
    let param = &shown.param;
    match &param.kind {
        ParamKind::Int => int(ui, param, value),
        ParamKind::Float => float(ui, param, value),
        ParamKind::Bool => {
            let mut on = matches!(value, Value::Bool(true));
            ui.checkbox(&mut on, "").changed().then_some(Value::Bool(on))
        }
        ParamKind::Choice(words) => {
            let Value::Word(word) = value else { return None };
            let mut picked = word.clone();
            ComboBox::from_id_salt(&shown.path).selected_text(word).width(110.0).show_ui(ui, |ui| {
                for word in words {
                    ui.selectable_value(&mut picked, word.value.clone(), &word.value);
                }
            });
            (picked != *word).then_some(Value::Word(picked))
        }
        ParamKind::Color => color(ui, value),
        ParamKind::Vec2 | ParamKind::Vec3 | ParamKind::Vec4 => vector(ui, value),
    }
}

fn bound(value: Option<&Value>) -> Option<f64> {
    value.and_then(Value::as_f64)
}

fn int(ui: &mut Ui, param: &Param, value: &Value) -> Option<Value> {
    let Value::Int(before) = value else { return None };
    let mut now = *before;
    let (low, high) = (bound(param.min.as_ref()), bound(param.max.as_ref()));
    let changed = match (low, high) {
        (Some(low), Some(high)) if high - low <= 4096.0 => {
            ui.add(Slider::new(&mut now, low as i64..=high as i64)).changed()
        }
        _ => {
            let range = low.map_or(i64::MIN, |x| x as i64)..=high.map_or(i64::MAX, |x| x as i64);
            ui.add(DragValue::new(&mut now).range(range).speed(0.2)).changed()
        }
    };
    (changed && now != *before).then_some(Value::Int(now))
}

fn float(ui: &mut Ui, param: &Param, value: &Value) -> Option<Value> {
    let before = value.as_f64()?;
    let mut now = before;
    let (low, high) = (bound(param.min.as_ref()), bound(param.max.as_ref()));
    let changed = match (low, high) {
        (Some(low), Some(high)) => {
            let is_wide = low > 0.0 && high / low > 200.0;
            let slider = Slider::new(&mut now, low..=high).logarithmic(is_wide).max_decimals(4);
            ui.add(slider.clamping(egui::SliderClamping::Always)).changed()
        }
        _ => {
            let range = low.unwrap_or(f64::NEG_INFINITY)..=high.unwrap_or(f64::INFINITY);
            let speed = (before.abs() * 0.01).max(0.001);
            ui.add(DragValue::new(&mut now).range(range).speed(speed).max_decimals(4)).changed()
        }
    };
    (changed && now != before && now.is_finite()).then_some(Value::Float(now))
}

fn vector(ui: &mut Ui, value: &Value) -> Option<Value> {
    let mut numbers: Vec<f64> = value.numbers().collect();
    let mut changed = false;
    // The row runs from the right.
    for number in numbers.iter_mut().rev() {
        let speed = (number.abs() * 0.01).max(0.001);
        changed |= ui.add(DragValue::new(number).speed(speed).max_decimals(3)).changed();
    }
    (changed && numbers.iter().all(|x| x.is_finite())).then(|| Value::vec(numbers))
}

/// Linear and unbounded: numbers, and a swatch that picks a hue with the largest number kept.
fn color(ui: &mut Ui, value: &Value) -> Option<Value> {
    let numbers: Vec<f64> = value.numbers().collect();
    let largest = numbers.iter().take(3).copied().fold(0.0, f64::max).max(1.0);
    let mut rgb: [f32; 3] = std::array::from_fn(|i| (numbers.get(i).copied().unwrap_or(0.0) / largest) as f32);
    let picked = ui.color_edit_button_rgb(&mut rgb).on_hover_text("linear colour").changed();
    if picked {
        let mut now: Vec<f64> = rgb.iter().map(|x| f64::from(*x) * largest).collect();
        now.extend(numbers.get(3));
        return Some(Value::vec(now));
    }
    vector(ui, value)
}
