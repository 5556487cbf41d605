//! Keys and mouse.

use egui::{Grid, Ui, Window};

use super::Layout;

const KEYS: &[(&str, &str)] = &[
    ("drag", "turn around the target"),
    ("right or middle drag, Shift + drag", "move sideways"),
    ("wheel", "nearer, farther"),
    ("Ctrl + drag", "look around from where you stand"),
    ("Alt + drag", "point, where the graph takes a pointer"),
    ("W A S D, Q E", "fly; Shift is faster"),
    ("F", "look at everything"),
    ("H", "the scene's own camera"),
    ("1 to 9, Ctrl + 1 to 9", "go to a viewpoint, keep one there"),
    ("Space", "play, pause"),
    (", and .", "a frame back, a frame on"),
    ("R", "start again"),
    ("Ctrl + S", "save changed parameters and dropped files to the scene"),
    ("F5", "read all files again"),
    ("F1, Esc", "this help, and away with it"),
];

pub fn draw(ui: &mut Ui, layout: &mut Layout) {
    let mut is_open = layout.shows_help;
    Window::new("Keys and mouse")
        .anchor(egui::Align2::CENTER_TOP, [0.0, 60.0])
        .open(&mut is_open)
        .resizable(false)
        .collapsible(false)
        .show(ui.ctx(), |ui| {
            Grid::new("keys").num_columns(2).spacing([24.0, 6.0]).show(ui, |ui| {
                for (key, what) in KEYS {
                    ui.strong(*key);
                    ui.label(*what);
                    ui.end_row();
                }
            });
            ui.add_space(6.0);
            ui.weak("drop a file on the window to open it");
        });
    layout.shows_help = is_open && !super::is_left(ui);
}
