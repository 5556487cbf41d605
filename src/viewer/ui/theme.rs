//! Colours and sizes: dark, quiet, and the same everywhere.

use egui::{Color32, Context, CornerRadius, Stroke, Theme, Visuals};

/// Behind the picture.
pub const BACKDROP: Color32 = Color32::from_gray(18);
pub const ACCENT: Color32 = Color32::from_rgb(86, 170, 214);
pub const GOOD: Color32 = Color32::from_rgb(110, 190, 120);
pub const WARN: Color32 = Color32::from_rgb(226, 182, 84);
pub const BAD: Color32 = Color32::from_rgb(236, 104, 96);
pub const FAINT: Color32 = Color32::from_gray(140);

pub fn apply(context: &Context) {
    context.set_theme(Theme::Dark);
    let mut visuals = Visuals::dark();
    visuals.panel_fill = Color32::from_gray(30);
    visuals.window_fill = Color32::from_gray(34);
    visuals.extreme_bg_color = Color32::from_gray(20);
    visuals.selection.bg_fill = Color32::from_rgb(36, 88, 120);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_gray(235));
    visuals.override_text_color = Some(Color32::from_gray(215));
    visuals.hyperlink_color = ACCENT;
    for widget in [
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(3);
    }
    context.set_visuals_of(Theme::Dark, visuals);
    context.global_style_mut(|style| {
        style.spacing.item_spacing = egui::vec2(6.0, 4.0);
        style.spacing.slider_width = 120.0;
        style.interaction.tooltip_delay = 0.3;
    });
}
