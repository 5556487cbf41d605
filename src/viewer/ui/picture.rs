//! The picture, and the camera by mouse and keys.

use egui::{Align2, FontId, Key, PointerButton, Pos2, Rect, Sense, Ui};

use super::{Layout, theme};
use crate::scene::Camera;
use crate::viewer::action::Action;
use crate::viewer::camera;
use crate::viewer::core::Core;

/// Radians that a drag over the picture's height turns.
const TURN: f64 = std::f64::consts::PI;

const NUMBERS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

pub fn draw(
    ui: &mut Ui,
    core: &Core,
    layout: &mut Layout,
    picture: Option<egui::TextureId>,
    actions: &mut Vec<Action>,
) {
    let room = ui.available_rect_before_wrap();
    let scale = ui.ctx().pixels_per_point();
    layout.room = Some([room.width() * scale, room.height() * scale]);
    let response = ui.allocate_rect(room, Sense::click_and_drag());
    let painter = ui.painter_at(room);
    match picture {
        Some(id) => {
            let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(id, fit(core.state.viewport, room), whole, egui::Color32::WHITE);
        }
        None => {
            let text =
                if core.state.busy.is_some() { "building the first picture..." } else { "there is no picture yet" };
            painter.text(room.center(), Align2::CENTER_CENTER, text, FontId::proportional(16.0), theme::FAINT);
        }
    }
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let points = core.state.takes_pointer && ui.input(|i| i.modifiers.alt);
    if points {
        point(&response, fit(core.state.viewport, room), actions);
    }
    if let Some(before) = core.state.camera.filter(|_| !points) {
        let moved = by_mouse(ui, &response, by_keys(ui, before), room);
        if moved != before {
            actions.push(Action::Camera(moved));
        }
    }
}

/// The largest rectangle of a picture's shape in the room.
pub fn fit(viewport: [u32; 2], room: Rect) -> Rect {
    let [width, height] = viewport.map(|side| side.max(1) as f32);
    let scale = (room.width() / width).min(room.height() / height);
    Rect::from_center_size(room.center(), egui::vec2(width * scale, height * scale))
}

/// Alt and drag is for graphs that take a pointer.
fn point(response: &egui::Response, place: Rect, actions: &mut Vec<Action>) {
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.drag_stopped()) {
        let part = (at - place.center()) / (place.size() * 0.5);
        let at = [f64::from(part.x), f64::from(-part.y)];
        actions.push(Action::Point { at, is_pressed: response.dragged() });
    }
}

fn by_mouse(ui: &Ui, response: &egui::Response, camera: Camera, room: Rect) -> Camera {
    let mut camera = camera;
    let delta = response.drag_delta() / room.height().max(1.0);
    let (right, down) = (f64::from(delta.x), f64::from(delta.y));
    let modifiers = ui.input(|i| i.modifiers);
    let pans = response.dragged_by(PointerButton::Secondary)
        || response.dragged_by(PointerButton::Middle)
        || modifiers.shift && response.dragged_by(PointerButton::Primary);
    if pans {
        camera = camera::pan(&camera, right, down);
    } else if modifiers.command && response.dragged_by(PointerButton::Primary) {
        camera = camera::look(&camera, right * TURN * 0.5, -down * TURN * 0.5);
    } else if response.dragged_by(PointerButton::Primary) {
        camera = camera::orbit(&camera, -right * TURN, down * TURN);
    }
    if response.hovered() {
        let scroll = ui.input(|i| i.smooth_scroll_delta().y + i.zoom_delta().ln() * 200.0);
        if scroll != 0.0 {
            camera = camera::zoom(&camera, (f64::from(-scroll) * 0.003).exp());
        }
    }
    camera
}

fn by_keys(ui: &Ui, camera: Camera) -> Camera {
    if ui.ctx().text_edit_focused() {
        return camera;
    }
    let (way, is_fast, seconds) = ui.input(|i| {
        let axis = |plus: Key, minus: Key| f64::from(i.key_down(plus)) - f64::from(i.key_down(minus));
        let plain = !i.modifiers.command && !i.modifiers.alt;
        let way = if plain { [axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S)] } else { [0.0; 3] };
        (way, i.modifiers.shift, f64::from(i.stable_dt.min(0.1)))
    });
    if way == [0.0; 3] {
        return camera;
    }
    ui.ctx().request_repaint();
    camera::fly(&camera, way, seconds * if is_fast { 4.0 } else { 1.0 })
}

/// Keys that work wherever no text is typed.
pub fn keys(ui: &Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    if ui.ctx().text_edit_focused() {
        return;
    }
    ui.input(|i| {
        let plain = i.modifiers.is_none();
        let pressed = |key: Key| plain && i.key_pressed(key);
        let table = [
            (Key::F, Action::Frame),
            (Key::H, Action::Home),
            (Key::R, Action::Restart),
            (Key::F5, Action::Reload),
            (Key::Comma, Action::Step(-1)),
            (Key::Period, Action::Step(1)),
            (Key::Space, Action::Play(!core.state.clock.is_playing)),
        ];
        actions.extend(table.into_iter().filter(|(key, _)| pressed(*key)).map(|(_, action)| action));
        if pressed(Key::F1) {
            layout.shows_help = !layout.shows_help;
        }
        for (slot, key) in NUMBERS.into_iter().enumerate() {
            if !i.key_pressed(key) {
                continue;
            }
            let slot = slot as u8 + 1;
            actions.push(if i.modifiers.command { Action::Keep(slot) } else { Action::GoTo(slot) });
        }
        if i.modifiers.command && i.key_pressed(Key::S) {
            actions.push(Action::Save);
        }
    });
}
