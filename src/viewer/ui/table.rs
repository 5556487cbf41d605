//! A buffer as a table: a row for each item, a column for each number of it.

use egui::{Grid, RichText, ScrollArea, Ui};

use super::theme;
use crate::host::dump::Cell;
use crate::viewer::look::{SeenBuffer, is_bad};

/// Items that are searched for what is no number.
const SEARCHED: usize = 200_000;
const COLUMN: f32 = 96.0;

pub fn draw(ui: &mut Ui, buffer: &SeenBuffer) {
    ui.horizontal_wrapped(|ui| {
        let room =
            if buffer.count == buffer.capacity { String::new() } else { format!(", room for {}", buffer.capacity) };
        ui.label(format!("{} items{room}", buffer.count));
        match &buffer.item {
            Some(item) => ui.weak(format!("of {item}, {} bytes each", buffer.stride)),
            None => ui.weak("no shader says what an item is: words of 32 bits"),
        };
        let id = ui.scope_id().with(("bad", buffer.bytes.as_ptr() as usize, buffer.bytes.len()));
        let (bad, first) = ui.ctx().data_mut(|data| *data.get_temp_mut_or_insert_with(id, || buffer.bad(SEARCHED)));
        if let Some(first) = first {
            let text = format!("{bad} items have NaN or infinity, the first is {first}");
            ui.label(RichText::new(text).color(theme::BAD).strong());
        }
    });
    ui.separator();
    let height = ui.text_style_height(&egui::TextStyle::Monospace) + 2.0;
    ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
        Grid::new("headings").min_col_width(COLUMN).max_col_width(COLUMN).show(ui, |ui| {
            ui.strong("item");
            for heading in buffer.table.headings() {
                ui.add(egui::Label::new(RichText::new(heading).strong()).truncate()).on_hover_text(heading);
            }
        });
        ScrollArea::vertical().auto_shrink(false).show_rows(ui, height, buffer.count, |ui, rows| {
            Grid::new("items").min_col_width(COLUMN).max_col_width(COLUMN).start_row(rows.start).striped(true).show(
                ui,
                |ui| {
                    for index in rows {
                        ui.weak(index.to_string());
                        buffer.row(index).into_iter().for_each(|cell| self::cell(ui, cell));
                        ui.end_row();
                    }
                },
            );
        });
    });
}

fn cell(ui: &mut Ui, cell: Cell) {
    let text = match cell {
        Cell::Float(x) if x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e6) => format!("{x:.4e}"),
        Cell::Float(x) => format!("{x:.5}"),
        Cell::Int(i) => i.to_string(),
    };
    let text = RichText::new(text).monospace();
    ui.label(if is_bad(cell) { text.color(theme::BAD).strong() } else { text });
}
