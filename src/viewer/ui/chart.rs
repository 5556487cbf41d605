//! The graph in time: passes are columns in planned order, memory is rows. A bar is a resource's life
//! in its memory; a ring is a read, a dot a write; several bars in one row share memory.

use std::collections::BTreeMap;

use egui::{Align2, Color32, CornerRadius, FontId, Pos2, Rect, ScrollArea, Sense, Stroke, Ui};

use super::{Layout, Middle, nodes, status, theme};
use crate::plan::model::{ObjectId, ObjectRef, Origin, Plan};
use crate::viewer::action::Action;
use crate::viewer::core::Core;
use crate::viewer::look::{self, Look};

const COLUMN: f32 = 22.0;
const ROW: f32 = 22.0;
const LABEL: f32 = 210.0;
const TOP: f32 = 170.0;

/// Objects in the same memory.
struct Lane {
    objects: Vec<ObjectId>,
    bytes: u64,
}

pub fn draw(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    let Some(plan) = core.plan() else {
        ui.weak("nothing is built yet");
        return;
    };
    legend(ui, plan, layout);
    if !layout.shows_lives {
        return nodes::draw(ui, core, layout, actions);
    }
    let lanes = lanes(plan);
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        let lean = TOP * 0.6;
        let size = egui::vec2(LABEL + plan.passes.len() as f32 * COLUMN + lean, TOP + lanes.len() as f32 * ROW + 12.0);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        let chart = Chart { plan, origin: rect.min, height: size.y };
        let pointer = response.hover_pos();
        chart.columns(ui, core, pointer);
        for (index, lane) in lanes.iter().enumerate() {
            chart.lane(ui, index, lane, pointer);
        }
        let hit = pointer.and_then(|at| chart.hit(&lanes, at));
        if let Some((object, pass)) = hit {
            let text = chart.text(object, pass);
            if response.clicked() {
                let path = plan.objects[object].path.clone();
                let after = pass.map(|pass| plan.passes[pass].path.clone());
                actions.push(Action::Look(Some(Look { path, after, ..Look::default() })));
                layout.middle = Middle::Resource;
            }
            response.on_hover_text_at_pointer(text);
        }
    });
}

fn legend(ui: &mut Ui, plan: &Plan, layout: &mut Layout) {
    egui::Frame::NONE.inner_margin(6.0).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.selectable_value(&mut layout.shows_lives, false, "nodes");
            ui.selectable_value(&mut layout.shows_lives, true, "lives in memory");
            ui.separator();
            let held: u64 = plan.memory.keep.iter().map(|slot| slot.bytes).sum();
            ui.label(format!(
                "{} passes; the frame's memory {} (without sharing {}, live at once {})",
                plan.passes.len(),
                status::bytes(held),
                status::bytes(plan.memory.unshared),
                status::bytes(plan.memory.lower_bound),
            ));
            ui.weak(match layout.shows_lives {
                true => "dot: writes, ring: reads, bars in one row share memory; click a bar to look at it",
                false => "blue: reads, amber: writes; drag to move, wheel to scale, double click for all, click a resource to look at it",
            });
        });
    });
}

/// Inputs, then state, then the frame's memory, by first use.
fn lanes(plan: &Plan) -> Vec<Lane> {
    let single = |id: ObjectId| Lane { objects: vec![id], bytes: crate::plan::memory::bytes(&plan.objects[id].kind) };
    let outside = (0..plan.objects.len())
        .filter(|id| plan.objects[*id].lifetime.is_some() && plan.objects[*id].origin != Origin::Frame)
        .map(single);
    let kept = plan.memory.keep.iter().map(|slot| Lane { objects: slot.objects.clone(), bytes: slot.bytes });
    let mut frame: Vec<Lane> = kept.collect();
    frame.sort_by_key(|lane| lane.objects.first().map(|id| (plan.objects[*id].lifetime, *id)));
    outside.chain(frame).collect()
}

struct Chart<'p> {
    plan: &'p Plan,
    origin: Pos2,
    height: f32,
}

impl Chart<'_> {
    fn x(&self, pass: usize) -> f32 {
        self.origin.x + LABEL + (pass as f32 + 0.5) * COLUMN
    }

    fn y(&self, lane: usize) -> f32 {
        self.origin.y + TOP + (lane as f32 + 0.5) * ROW
    }

    /// Names of passes, leaning, over a line down; slow ones warmer.
    fn columns(&self, ui: &Ui, core: &Core, pointer: Option<Pos2>) {
        let painter = ui.painter();
        let times = &core.state.times[0];
        let most = self.plan.passes.iter().filter_map(|p| times.pass(&p.path)).map(|s| s.smooth).fold(1e-6, f64::max);
        for (index, pass) in self.plan.passes.iter().enumerate() {
            let x = self.x(index);
            let is_near = pointer.is_some_and(|at| (at.x - x).abs() < COLUMN * 0.5 && at.y > self.origin.y + TOP);
            let line = if is_near { Color32::from_gray(110) } else { Color32::from_gray(42) };
            painter.vline(x, self.origin.y + TOP..=self.origin.y + self.height, Stroke::new(1.0, line));
            let share = times.pass(&pass.path).map_or(0.0, |s| (s.smooth / most) as f32);
            let is_off = core.state.switched_off.contains(&pass.path);
            let color = if is_off { theme::FAINT } else { warm(share) };
            let galley = painter.layout_no_wrap(shortened(&pass.path), FontId::proportional(11.5), color);
            let shape = egui::epaint::TextShape::new(Pos2::new(x - 4.0, self.origin.y + TOP - 6.0), galley, color);
            painter.add(shape.with_angle(-std::f32::consts::FRAC_PI_3));
        }
    }

    fn lane(&self, ui: &Ui, index: usize, lane: &Lane, pointer: Option<Pos2>) {
        let painter = ui.painter();
        let y = self.y(index);
        let is_near = pointer.is_some_and(|at| (at.y - y).abs() < ROW * 0.5);
        let first = lane.objects.first().map_or("", |id| self.plan.objects[*id].path.as_str());
        let more = lane.objects.len().saturating_sub(1);
        let name = if more > 0 { format!("{first} and {more} more") } else { first.to_owned() };
        let color = if is_near { Color32::WHITE } else { Color32::from_gray(180) };
        let at = Pos2::new(self.origin.x + LABEL - 10.0, y);
        let text = format!("{}  {}", cut(&name, 22), status::bytes(lane.bytes));
        painter.text(at, Align2::RIGHT_CENTER, text, FontId::proportional(11.5), color);
        for (nth, id) in lane.objects.iter().enumerate() {
            self.bar(ui, *id, y, nth);
        }
    }

    fn bar(&self, ui: &Ui, id: ObjectId, y: f32, nth: usize) {
        let painter = ui.painter();
        let Some((from, to)) = self.plan.objects[id].lifetime else { return };
        let color = match self.plan.objects[id].origin {
            Origin::Frame => [ACCENT_A, ACCENT_B, ACCENT_C][nth % 3],
            Origin::State(_) => Color32::from_rgb(150, 110, 190),
            _ => Color32::from_gray(105),
        };
        let rect = Rect::from_min_max(Pos2::new(self.x(from) - 8.0, y - 6.0), Pos2::new(self.x(to) + 8.0, y + 6.0));
        painter.rect_filled(rect, CornerRadius::same(5), color.gamma_multiply(0.55));
        for (pass, (reads, writes)) in self.uses(id) {
            let at = Pos2::new(self.x(pass), y);
            if writes {
                painter.circle_filled(at, 4.0, Color32::WHITE);
            }
            if reads {
                painter.circle_stroke(at, if writes { 6.0 } else { 4.0 }, Stroke::new(1.5, Color32::WHITE));
            }
        }
    }

    /// Whether each pass reads and writes an object.
    fn uses(&self, id: ObjectId) -> BTreeMap<usize, (bool, bool)> {
        let mut uses: BTreeMap<usize, (bool, bool)> = BTreeMap::new();
        for (pass, about) in self.plan.passes.iter().enumerate() {
            for access in about.accesses.iter().filter(|a| self.may_be(a.object, id)) {
                let entry = uses.entry(pass).or_default();
                entry.0 |= access.read;
                entry.1 |= access.write;
            }
        }
        uses
    }

    fn may_be(&self, found: ObjectRef, id: ObjectId) -> bool {
        match found {
            ObjectRef::Fixed(other) => other == id,
            ObjectRef::Ring { ring, .. } => self.plan.rings.get(ring).is_some_and(|r| r.objects.contains(&id)),
        }
    }

    /// The bar under the pointer, and the pass if one touches it there.
    fn hit(&self, lanes: &[Lane], at: Pos2) -> Option<(ObjectId, Option<usize>)> {
        let lane = ((at.y - self.origin.y - TOP) / ROW).floor();
        let column = ((at.x - self.origin.x - LABEL) / COLUMN).floor();
        let lane = lanes.get(usize::try_from(lane as i64).ok()?)?;
        if column < 0.0 {
            return lane.objects.first().map(|id| (*id, None));
        }
        let column = column as usize;
        let holds = |id: &&ObjectId| self.plan.objects[**id].lifetime.is_some_and(|(a, b)| (a..=b).contains(&column));
        let id = *lane.objects.iter().find(holds)?;
        Some((id, self.uses(id).contains_key(&column).then_some(column)))
    }

    fn text(&self, object: ObjectId, pass: Option<usize>) -> String {
        let about = &self.plan.objects[object];
        let mut text = format!("{}\n{}", about.path, look::described(about));
        if let Some(pass) = pass {
            let (reads, writes) = self.uses(object).get(&pass).copied().unwrap_or_default();
            let how = match (reads, writes) {
                (true, true) => "read and written",
                (_, true) => "written",
                _ => "read",
            };
            text += &format!("\n{how} by {}", self.plan.passes[pass].path);
        }
        text
    }
}

const ACCENT_A: Color32 = Color32::from_rgb(70, 150, 200);
const ACCENT_B: Color32 = Color32::from_rgb(80, 175, 130);
const ACCENT_C: Color32 = Color32::from_rgb(205, 150, 80);

/// From grey to amber.
fn warm(share: f32) -> Color32 {
    let share = share.clamp(0.0, 1.0).sqrt();
    let mix = |a: f32, b: f32| (a + (b - a) * share) as u8;
    Color32::from_rgb(mix(170.0, 245.0), mix(170.0, 180.0), mix(170.0, 80.0))
}

fn shortened(path: &str) -> String {
    let count = path.chars().count();
    if count <= 28 { path.to_owned() } else { format!("..{}", path.chars().skip(count - 26).collect::<String>()) }
}

fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        text.to_owned()
    } else {
        format!("{}..", text.chars().take(most - 2).collect::<String>())
    }
}
