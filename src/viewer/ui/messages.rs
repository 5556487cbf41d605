//! Errors, warnings and notes with source lines and carets, while the last good picture stays.

use std::path::PathBuf;

use egui::{Panel, RichText, ScrollArea, Ui};

use super::{Layout, ansi, theme};
use crate::diagnostic::{Diagnostic, Severity, Sources, Style, render};
use crate::viewer::action::Action;
use crate::viewer::core::Core;
use crate::viewer::state::{Findings, short};

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    let Some(findings) = &core.state.findings else { return };
    let (errors, warnings) = findings.counts();
    // Notes alone do not take room from the picture.
    let is_grave = errors > 0 || warnings > 0;
    if !layout.shows_messages && errors == 0 || !is_grave {
        return;
    }
    let height = if errors > 0 { 250.0 } else { 130.0 };
    Panel::bottom("messages").resizable(true).default_size(height).size_range(60.0..=520.0).show(ui, |ui| {
        ui.add_space(2.0);
        headline(ui, core, findings, layout);
        ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            for found in findings.diagnostics.iter() {
                message(ui, found, &findings.sources, actions);
            }
        });
    });
}

fn headline(ui: &mut Ui, core: &Core, findings: &Findings, layout: &mut Layout) {
    let (errors, warnings) = findings.counts();
    let plural = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    ui.horizontal(|ui| {
        if errors > 0 {
            ui.label(RichText::new(plural(errors, "error")).color(theme::BAD).strong());
        }
        if warnings > 0 {
            ui.label(RichText::new(plural(warnings, "warning")).color(theme::WARN).strong());
        }
        if findings.is_stale {
            let text = if core.plan().is_some() { "the last good picture stays" } else { "there is no picture yet" };
            ui.weak(text);
        }
        if errors == 0 {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.small_button("hide").clicked() {
                    layout.shows_messages = false;
                }
            });
        }
    });
}

fn message(ui: &mut Ui, found: &Diagnostic, sources: &Sources, actions: &mut Vec<Action>) {
    if found.severity == Severity::Note {
        return;
    }
    let text = render(found, sources, Style::Colored);
    ui.add(egui::Label::new(ansi::layout(text.trim_end(), 12.5)).selectable(true).extend());
    places(ui, found, sources, actions);
    ui.add_space(6.0);
}

/// The places of a finding, to be opened in an editor.
fn places(ui: &mut Ui, found: &Diagnostic, sources: &Sources, actions: &mut Vec<Action>) {
    if found.labels.is_empty() {
        return;
    }
    ui.horizontal(|ui| {
        ui.weak("open in editor:");
        for label in &found.labels {
            let path = PathBuf::from(sources.path(label.span.file));
            let at = sources.position(label.span.file, label.span.start);
            let text = format!("{}:{}", short(&path), at.line);
            if ui.small_button(text).on_hover_text("with $VISUAL or $EDITOR").clicked() {
                actions.push(Action::Edit { path, line: at.line, column: at.column });
            }
        }
    });
}
