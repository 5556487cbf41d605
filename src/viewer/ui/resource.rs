//! Any resource after any pass: a texture as a picture with its numbers, a buffer as a table.

use egui::{Align2, Color32, ColorImage, ComboBox, DragValue, FontId, Pos2, Rect, RichText, Sense, TextureHandle, Ui};

use super::{Layout, table, theme};
use crate::plan::model::{ObjectKind, Plan};
use crate::viewer::action::Action;
use crate::viewer::core::Core;
use crate::viewer::inspect::{self, Channel, Stats};
use crate::viewer::look::{self, Look, Seen, SeenContent, SeenTexture};

/// How a resource is shown.
#[derive(Default)]
pub struct View {
    filter: String,
    is_choosing: bool,
    /// Absent: what shows most.
    channel: Option<Channel>,
    /// Absent: what shows most.
    range: Option<[f32; 2]>,
    shown: Option<Shown>,
}

impl std::fmt::Debug for View {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("View").field("channel", &self.channel).field("range", &self.range).finish_non_exhaustive()
    }
}

/// What was made of what was seen.
struct Shown {
    serial: u64,
    channel: Channel,
    range: [f32; 2],
    stats: Stats,
    texture: TextureHandle,
}

impl View {
    pub fn forget_texture(&mut self) {
        self.shown = None;
    }
}

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    let Some(plan) = core.plan() else {
        ui.weak("nothing is built yet");
        return;
    };
    egui::Frame::NONE.inner_margin(6.0).show(ui, |ui| {
        let look = chooser(ui, core, plan, &mut layout.resource, actions);
        let Some(look) = look else {
            ui.add_space(8.0);
            ui.weak("choose a resource, or click a pass on the right to see what it reads and writes");
            return;
        };
        match &core.state.seen {
            Some(Seen { content: Err(why), .. }) => _ = ui.label(RichText::new(why).color(theme::WARN)),
            Some(Seen { content: Ok(SeenContent::Texture(texture)), serial, .. }) => {
                self::texture(ui, texture, *serial, &look, &mut layout.resource);
            }
            Some(Seen { content: Ok(SeenContent::Buffer(buffer)), .. }) => table::draw(ui, buffer),
            None => _ = ui.weak("reading..."),
        }
    });
}

/// Which resource, after which pass, which part of it.
fn chooser(ui: &mut Ui, core: &Core, plan: &Plan, view: &mut View, actions: &mut Vec<Action>) -> Option<Look> {
    let before = core.state.look.clone();
    let mut look = before.clone();
    ui.horizontal_wrapped(|ui| {
        let text = look.as_ref().map_or("resource", |look| look.path.as_str()).to_owned();
        let chosen =
            ComboBox::from_id_salt("resource").selected_text(text).width(170.0).height(420.0).show_ui(ui, |ui| {
                let filter =
                    ui.add(egui::TextEdit::singleline(&mut view.filter).hint_text("filter, Enter takes the first"));
                if !view.is_choosing {
                    view.filter.clear();
                    filter.request_focus();
                }
                let mut takes_first = filter.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
                for path in look::paths(plan).into_iter().filter(|path| path.contains(view.filter.trim())) {
                    let is_chosen = look.as_ref().is_some_and(|look| look.path == path);
                    if ui.selectable_label(is_chosen, path).clicked() || std::mem::take(&mut takes_first) {
                        look = Some(Look { path: path.to_owned(), ..Look::default() });
                        (view.channel, view.range) = (None, None);
                        ui.close();
                    }
                }
            });
        view.is_choosing = chosen.inner.is_some();
        if let Some(look) = &mut look {
            after(ui, plan, look);
            part(ui, plan, look);
        }
        match &core.state.hunt {
            Some(hunt) => _ = ui.weak(format!("looking for NaN: pass {} of {}", hunt.next, hunt.of)),
            None => {
                let hunt = ui.button("First NaN").on_hover_text("find the first pass that writes NaN or infinity");
                if hunt.clicked() {
                    actions.push(Action::Hunt);
                }
            }
        }
    });
    if look != before {
        actions.push(Action::Look(look.clone()));
    }
    look
}

/// After which pass: those that write it, or the end of the frame.
fn after(ui: &mut Ui, plan: &Plan, look: &mut Look) {
    let Some((found, object)) = look::find(plan, &look.path) else { return };
    let text = look.after.clone().map_or_else(|| "end of the frame".to_owned(), |pass| format!("after {pass}"));
    ComboBox::from_id_salt("after").selected_text(text).width(170.0).height(420.0).show_ui(ui, |ui| {
        ui.selectable_value(&mut look.after, None, "end of the frame");
        let mut passes = look::writers(plan, found);
        // A pass that does not write it may be chosen in the list of passes.
        passes.extend(look.after.as_ref().and_then(|pass| plan.passes.iter().position(|p| p.path == *pass)));
        passes.sort_unstable();
        passes.dedup();
        for pass in passes {
            let path = &plan.passes[pass].path;
            ui.selectable_value(&mut look.after, Some(path.clone()), format!("after {path}"));
        }
    });
    ui.weak(look::described(object));
}

fn part(ui: &mut Ui, plan: &Plan, look: &mut Look) {
    let Some((_, object)) = look::find(plan, &look.path) else { return };
    let ObjectKind::Texture(texture) = &object.kind else { return };
    if texture.mips > 1 {
        ui.add(DragValue::new(&mut look.mip).range(0..=texture.mips - 1).prefix("mip ").speed(0.05));
    }
    if texture.layers > 1 {
        ui.add(DragValue::new(&mut look.layer).range(0..=texture.layers - 1).prefix("layer ").speed(0.05));
    }
}

fn texture(ui: &mut Ui, seen: &SeenTexture, serial: u64, look: &Look, view: &mut View) {
    let channel = view.channel.filter(|c| c.is_there(seen.channels)).unwrap_or(Channel::usual(seen.channels));
    prepare(ui, seen, serial, channel, view);
    ui.horizontal_wrapped(|ui| {
        for other in Channel::ALL.into_iter().filter(|c| c.is_there(seen.channels)) {
            if ui.selectable_label(other == channel, other.name()).clicked() {
                (view.channel, view.range) = (Some(other), None);
            }
        }
        ui.separator();
        range(ui, view);
    });
    let Some(shown) = &view.shown else { return };
    numbers(ui, &shown.stats);
    histogram(ui, shown);
    let room = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(room, Sense::hover());
    let place = super::picture::fit([seen.width, seen.height], room);
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    ui.painter().image(shown.texture.id(), place, whole, Color32::WHITE);
    if let Some(pointer) = response.hover_pos().filter(|at| place.contains(*at)) {
        under_pointer(ui, seen, look, place, pointer);
    }
}

/// Makes the picture of what was seen, if it is another one.
fn prepare(ui: &Ui, seen: &SeenTexture, serial: u64, channel: Channel, view: &mut View) {
    let kept = view.shown.take().filter(|shown| shown.serial == serial && shown.channel == channel);
    let stats = match &kept {
        Some(shown) => shown.stats.clone(),
        None => Stats::of_texels(&seen.texels, channel),
    };
    let range = view.range.unwrap_or_else(|| stats.usual_range());
    if let Some(shown) = kept.filter(|shown| shown.range == range) {
        view.shown = Some(shown);
        return;
    }
    let pixels: Vec<u8> = inspect::shown(&seen.texels, channel, range).into_flattened();
    let size = [seen.width as usize, seen.height as usize];
    if pixels.len() != size[0] * size[1] * 3 {
        return;
    }
    let texture = ui.ctx().load_texture("resource", ColorImage::from_rgb(size, &pixels), egui::TextureOptions::NEAREST);
    view.shown = Some(Shown { serial, channel, range, stats, texture });
}

fn range(ui: &mut Ui, view: &mut View) {
    let Some(shown) = &view.shown else { return };
    let [mut low, mut high] = shown.range;
    let speed = f64::from((high - low).abs()).max(1e-6) * 0.005;
    ui.weak("black");
    let from = ui.add(DragValue::new(&mut low).speed(speed).max_decimals(5));
    ui.weak("white");
    let to = ui.add(DragValue::new(&mut high).speed(speed).max_decimals(5));
    if from.changed() || to.changed() {
        view.range = Some([low, high]);
    }
    if ui.small_button("auto").on_hover_text("all but the outermost thousandth").clicked() {
        view.range = None;
    }
    if ui.small_button("0 to 1").clicked() {
        view.range = Some([0.0, 1.0]);
    }
}

fn numbers(ui: &mut Ui, stats: &Stats) {
    ui.horizontal_wrapped(|ui| {
        match stats.range {
            Some([low, high]) => {
                ui.monospace(format!("min {low:.6}  max {high:.6}  mean {:.6}", stats.mean));
            }
            None => _ = ui.weak("no finite number"),
        }
        if stats.nans > 0 {
            let [r, g, b] = inspect::NAN;
            ui.label(RichText::new(format!("{} NaN", stats.nans)).color(Color32::from_rgb(r, g, b)).strong());
        }
        if stats.infinities > 0 {
            let [r, g, b] = inspect::INFINITE;
            let text = format!("{} infinite", stats.infinities);
            ui.label(RichText::new(text).color(Color32::from_rgb(r, g, b)).strong());
        }
    });
}

fn histogram(ui: &mut Ui, shown: &Shown) {
    let size = egui::vec2(ui.available_width(), 44.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, Color32::from_gray(24));
    let bars = &shown.stats.histogram;
    let most = bars.iter().copied().max().unwrap_or(1).max(1);
    let width = rect.width() / bars.len().max(1) as f32;
    for (i, count) in bars.iter().enumerate() {
        // Of a logarithm, so that few outliers are seen beside many.
        let height = (f64::from(*count) + 1.0).ln() / (f64::from(most) + 1.0).ln();
        let left = rect.left() + width * i as f32;
        let top = rect.bottom() - height as f32 * (rect.height() - 2.0);
        let bar = Rect::from_min_max(Pos2::new(left, top), Pos2::new(left + width - 0.5, rect.bottom()));
        painter.rect_filled(bar, 0.0, theme::ACCENT);
    }
    if let (Some([low, high]), Some(at)) = (shown.stats.range, response.hover_pos()) {
        let bar = (((at.x - rect.left()) / width) as usize).min(bars.len().saturating_sub(1));
        let step = (f64::from(high) - f64::from(low)) / bars.len().max(1) as f64;
        let from = f64::from(low) + step * bar as f64;
        let text = format!("{} numbers from {from:.5} to {:.5}", bars.get(bar).unwrap_or(&0), from + step);
        response.on_hover_text_at_pointer(text);
    }
}

fn under_pointer(ui: &Ui, seen: &SeenTexture, look: &Look, place: Rect, at: Pos2) {
    let part = (at - place.min) / place.size();
    let x = ((part.x * seen.width as f32) as u32).min(seen.width.saturating_sub(1));
    let y = ((part.y * seen.height as f32) as u32).min(seen.height.saturating_sub(1));
    let Some(texel) = seen.texels.get((y * seen.width + x) as usize) else { return };
    let numbers: Vec<String> = texel.iter().take(seen.channels as usize).map(|x| format!("{x:.6}")).collect();
    let text = format!("({x}, {y})  {}", numbers.join("  "));
    let painter = ui.painter();
    let place = place.left_bottom() + egui::vec2(6.0, -6.0);
    let galley = painter.layout_no_wrap(text, FontId::monospace(13.0), Color32::WHITE);
    let rect = Align2::LEFT_BOTTOM.anchor_size(place, galley.size());
    painter.rect_filled(rect.expand(4.0), 3.0, Color32::from_black_alpha(200));
    painter.galley(rect.min, galley, Color32::WHITE);
    _ = look;
}
