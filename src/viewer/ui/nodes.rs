//! The graph drawn: passes and resources as nodes, what reads and writes as edges. It is moved by dragging and
//! scaled by the wheel; a click on a resource looks at it.

use egui::epaint::CubicBezierShape;
use egui::{
    Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, StrokeKind, Ui, Vec2,
};

use super::{Layout, Middle, passes, status, theme};
use crate::plan::memory;
use crate::plan::model::{ObjectId, Origin, Plan};
use crate::viewer::action::Action;
use crate::viewer::core::Core;
use crate::viewer::graph::{Drawing, How, Item, NODE, Node};
use crate::viewer::look::{self, Look};

const ZOOM: [f32; 2] = [0.05, 2.5];
/// Of the names, at the drawing's own size.
const FONT: f32 = 12.5;
/// Smaller text is not read.
const LEAST_FONT: f32 = 5.0;

/// Smaller names are hard to read.
const READABLE: f32 = 0.8;

/// How the drawing lies in its room.
#[derive(Clone, Debug, Default)]
pub struct View {
    drawing: Drawing,
    /// The build that it was made of.
    built: Option<u64>,
    zoom: f32,
    pan: Vec2,
    /// Highlighted while nothing is under the pointer.
    chosen: Option<Item>,
}

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    let Some(plan) = core.plan() else { return };
    let room = ui.available_rect_before_wrap();
    let view = &mut layout.nodes;
    if view.built != Some(core.builds()) {
        let drawing = Drawing::of(plan);
        let is_other = drawing.nodes.len() != view.drawing.nodes.len();
        (view.drawing, view.built) = (drawing, Some(core.builds()));
        if is_other {
            view.begin(room);
        }
    }
    let response = ui.allocate_rect(room, Sense::click_and_drag());
    view.moved(ui, &response, room);
    let pointer = response.hover_pos();
    let hovered = pointer.and_then(|at| view.drawing.hit(view.inverse(room, at)));
    let chosen = hovered.or_else(|| view.drawing.nodes.iter().position(|node| Some(node.item) == view.chosen));
    let sketch = Sketch { core, plan, view, room, painter: ui.painter_at(room), chosen };
    sketch.edges();
    (0..view.drawing.nodes.len()).for_each(|node| sketch.node(node));
    let Some(node) = hovered else {
        if response.clicked() {
            view.chosen = None;
        }
        return;
    };
    let item = view.drawing.nodes[node].item;
    let text = sketch.text(node);
    if response.clicked() {
        match item {
            Item::Pass(_) => view.chosen = (view.chosen != Some(item)).then_some(item),
            Item::Object(object) => {
                let path = plan.objects[object].path.clone();
                actions.push(Action::Look(Some(Look { path, ..Look::default() })));
                layout.middle = Middle::Resource;
            }
        }
    }
    response.on_hover_text_at_pointer(text);
}

impl View {
    /// All of it, as far as its names can still be read; else from where it begins.
    fn begin(&mut self, room: Rect) {
        self.fit(room);
        if self.zoom < READABLE {
            self.zoom = READABLE;
            let width = self.drawing.size[0] * self.zoom;
            self.pan = Vec2::new((room.width() - width) * 0.5, 12.0);
        }
    }

    /// All of it.
    pub fn fit(&mut self, room: Rect) {
        let size = Vec2::from(self.drawing.size).max(Vec2::splat(1.0));
        let zoom = ((room.width() - 24.0) / size.x).min((room.height() - 24.0) / size.y);
        self.zoom = zoom.clamp(ZOOM[0], 1.0);
        self.pan = (room.size() - size * self.zoom) * 0.5;
    }

    fn moved(&mut self, ui: &Ui, response: &Response, room: Rect) {
        self.pan += response.drag_delta();
        if response.double_clicked() {
            self.fit(room);
        }
        let Some(pointer) = response.hover_pos() else { return };
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let wanted = (self.zoom * (scroll * 0.004).exp() * pinch).clamp(ZOOM[0], ZOOM[1]);
        // What is under the pointer stays there.
        let at = pointer - room.min - self.pan;
        self.pan -= at * (wanted / self.zoom.max(1e-6) - 1.0);
        self.zoom = wanted;
    }

    fn screen(&self, room: Rect, at: [f32; 2]) -> Pos2 {
        room.min + self.pan + Vec2::from(at) * self.zoom
    }

    fn inverse(&self, room: Rect, at: Pos2) -> [f32; 2] {
        ((at - room.min - self.pan) / self.zoom.max(1e-6)).into()
    }
}

struct Sketch<'a> {
    core: &'a Core,
    plan: &'a Plan,
    view: &'a View,
    room: Rect,
    painter: Painter,
    /// The node whose edges are shown before all others.
    chosen: Option<usize>,
}

impl Sketch<'_> {
    fn edges(&self) {
        let drawing = &self.view.drawing;
        // Those of the chosen node last, so that they lie on top.
        for is_on_top in [false, true] {
            for edge in &drawing.edges {
                let is_chosen = self.chosen.is_some_and(|node| edge.from == node || edge.to == node);
                if is_chosen != is_on_top {
                    continue;
                }
                let color = match edge.how {
                    How::Reads => theme::ACCENT,
                    How::Makes | How::GoesOn | How::Returns => theme::WARN,
                };
                let (strength, width) = match (self.chosen.is_some(), is_chosen) {
                    (_, true) => (1.0, 2.0),
                    (true, false) => (0.10, 1.0),
                    (false, false) => (0.42, 1.2),
                };
                let stroke = Stroke::new(width, color.gamma_multiply(strength));
                self.edge(&drawing.nodes[edge.from], &drawing.nodes[edge.to], stroke);
            }
        }
    }

    fn edge(&self, from: &Node, to: &Node, stroke: Stroke) {
        let half = NODE[1] * 0.5;
        let a = self.view.screen(self.room, [from.at[0], from.at[1] + half]);
        let b = self.view.screen(self.room, [to.at[0], to.at[1] - half]);
        let bend = ((b.y - a.y).abs() * 0.4).max(14.0 * self.view.zoom);
        // One that leads back goes around beside.
        let aside = if b.y < a.y { NODE[0] * 0.9 * self.view.zoom } else { 0.0 };
        let points = [a, a + Vec2::new(aside, bend), b + Vec2::new(aside, -bend), b];
        let curve = CubicBezierShape::from_points_stroke(points, false, Color32::TRANSPARENT, stroke);
        if curve.visual_bounding_rect().intersects(self.room) {
            self.painter.add(Shape::CubicBezier(curve));
        }
    }

    fn node(&self, index: usize) {
        let node = &self.view.drawing.nodes[index];
        let middle = self.view.screen(self.room, node.at);
        let rect = Rect::from_center_size(middle, Vec2::from(NODE) * self.view.zoom);
        if !rect.intersects(self.room) {
            return;
        }
        let is_near = self
            .chosen
            .is_none_or(|chosen| chosen == index || self.view.drawing.neighbours(chosen).any(|other| other == index));
        let shares = self.chosen.is_some_and(|chosen| self.share_memory(chosen, index));
        let strength = if is_near || shares { 1.0 } else { 0.25 };
        match node.item {
            Item::Pass(pass) => self.pass(pass, rect, strength),
            Item::Object(object) => self.object(object, rect, strength),
        }
        let outline = match (self.chosen == Some(index), shares) {
            (true, _) => Some(Color32::WHITE),
            (_, true) => Some(MEMORY),
            _ => None,
        };
        if let Some(color) = outline {
            let radius = self.radius(node.item);
            self.painter.rect_stroke(rect.expand(2.0), radius, Stroke::new(1.5, color), StrokeKind::Outside);
        }
    }

    fn radius(&self, item: Item) -> CornerRadius {
        let round = if matches!(item, Item::Pass(_)) { 3.0 } else { NODE[1] * 0.5 };
        CornerRadius::same((round * self.view.zoom) as u8)
    }

    fn pass(&self, pass: usize, rect: Rect, strength: f32) {
        let (about, state) = (&self.plan.passes[pass], &self.core.state);
        let is_off = state.switched_off.contains(&about.path);
        let ran = state.units.get(about.unit).is_none_or(|unit| unit.ran) || about.steps.is_some();
        let series = state.times[0].pass(&about.path);
        let share = series.map_or(0.0, |series| series.smooth / state.times[0].gpu.smooth.max(1e-6));
        let fill = warm(share as f32).gamma_multiply(if is_off { 0.3 } else { strength });
        self.painter.rect_filled(rect, self.radius(Item::Pass(pass)), fill);
        let color = Color32::WHITE.gamma_multiply(if is_off { 0.4 } else { strength });
        let time = match series {
            _ if is_off => "off".to_owned(),
            _ if !ran => "skipped".to_owned(),
            Some(series) => format!("{:.2} ms", series.smooth),
            None => String::new(),
        };
        self.lines(rect, &about.path, &format!("{}", pass + 1), &time, color);
    }

    fn object(&self, object: ObjectId, rect: Rect, strength: f32) {
        let about = &self.plan.objects[object];
        let radius = self.radius(Item::Object(object));
        self.painter.rect_filled(rect, radius, kind_color(&about.origin).gamma_multiply(strength));
        let is_output = self
            .plan
            .outputs
            .iter()
            .any(|output| look::object(self.plan, output.object).is_some_and(|found| found.path == about.path));
        let first = if is_output { "output" } else { short_kind(&about.origin) };
        let size = status::bytes(memory::bytes(&about.kind));
        self.lines(rect, &about.path, first, &size, Color32::from_gray(235).gamma_multiply(strength));
        self.life(about.lifetime, rect, strength);
    }

    /// From when to when it is used, of all passes.
    fn life(&self, lifetime: Option<(usize, usize)>, rect: Rect, strength: f32) {
        let Some((first, last)) = lifetime.filter(|_| rect.height() > 12.0) else { return };
        let line = rect.shrink2(Vec2::new(rect.height() * 0.5, 0.0));
        let part = |pass: usize| line.left() + line.width() * pass as f32 / self.plan.passes.len().max(1) as f32;
        let y = rect.bottom() - 3.0 * self.view.zoom;
        let thick = (2.5 * self.view.zoom).max(1.0);
        self.painter.hline(line.x_range(), y, Stroke::new(thick, Color32::from_black_alpha(90)));
        let life = Stroke::new(thick, Color32::WHITE.gamma_multiply(0.75 * strength));
        self.painter.hline(part(first)..=part(last + 1), y, life);
    }

    /// A name, and below it two small words left and right.
    fn lines(&self, rect: Rect, name: &str, left: &str, right: &str, color: Color32) {
        let size = FONT * self.view.zoom;
        if size < LEAST_FONT {
            return;
        }
        // Whole sizes: each one is drawn into the fonts' texture.
        let font = FontId::proportional(size.round().max(LEAST_FONT));
        let small = FontId::proportional((size * 0.8).round().max(LEAST_FONT));
        let inner = rect.shrink2(Vec2::new(9.0 * self.view.zoom, 2.0 * self.view.zoom));
        let painter = self.painter.with_clip_rect(inner.expand(1.0).intersect(self.room));
        let most = (inner.width() / (font.size * 0.5)) as usize;
        painter.text(inner.left_top(), Align2::LEFT_TOP, super::ending(name, most), font, color);
        let faint = color.gamma_multiply(0.75);
        let bottom = inner.bottom() - 3.0 * self.view.zoom;
        let at = |x: f32| Pos2::new(x, bottom);
        painter.text(at(inner.left()), Align2::LEFT_BOTTOM, left, small.clone(), faint);
        painter.text(at(inner.right()), Align2::RIGHT_BOTTOM, right, small, faint);
    }

    /// Whether two nodes are resources in the same memory.
    fn share_memory(&self, a: usize, b: usize) -> bool {
        let nodes = &self.view.drawing.nodes;
        let (Item::Object(a), Item::Object(b)) = (nodes[a].item, nodes[b].item) else { return false };
        a != b && self.sharing(a).any(|other| other == b)
    }

    fn sharing(&self, object: ObjectId) -> impl Iterator<Item = ObjectId> {
        let slot = self.plan.memory.keep.iter().find(|slot| slot.objects.contains(&object));
        slot.into_iter().flat_map(|slot| slot.objects.iter().copied())
    }

    fn text(&self, node: usize) -> String {
        match self.view.drawing.nodes[node].item {
            Item::Pass(pass) => {
                let about = &self.plan.passes[pass];
                let unit = self.core.state.units.get(about.unit).filter(|_| about.steps.is_none());
                format!("{}\npass {} of {}\n{}", about.path, pass + 1, self.plan.passes.len(), passes::why(unit))
            }
            Item::Object(object) => {
                let about = &self.plan.objects[object];
                let mut text = format!("{}\n{}", about.path, look::described(about));
                if let Some((first, last)) = about.lifetime {
                    text += &format!("\nused from pass {} to {}", first + 1, last + 1);
                }
                let others = self.sharing(object).filter(|other| *other != object);
                let others: Vec<&str> = others.map(|other| self.plan.objects[other].path.as_str()).collect();
                if !others.is_empty() {
                    text += &format!("\nshares memory with {}", others.join(", "));
                }
                text + "\nclick: look at it"
            }
        }
    }
}

/// Around what shares memory with the node that is looked at.
const MEMORY: Color32 = Color32::from_rgb(205, 150, 230);

fn kind_color(origin: &Origin) -> Color32 {
    match origin {
        Origin::Frame => Color32::from_rgb(38, 74, 84),
        Origin::State(_) => Color32::from_rgb(82, 58, 104),
        _ => Color32::from_rgb(62, 70, 58),
    }
}

fn short_kind(origin: &Origin) -> &'static str {
    match origin {
        Origin::Frame => "",
        Origin::State(_) => "state",
        _ => "input",
    }
}

/// From grey to amber with the share of the frame's time.
fn warm(share: f32) -> Color32 {
    let share = share.clamp(0.0, 1.0).sqrt();
    let mix = |a: f32, b: f32| (a + (b - a) * share) as u8;
    Color32::from_rgb(mix(66.0, 196.0), mix(66.0, 112.0), mix(70.0, 34.0))
}
