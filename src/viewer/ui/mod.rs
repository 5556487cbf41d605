//! The interface, drawn with egui from what the core knows. It changes nothing but its own
//! [`Layout`]; what a person asks for comes out as actions.

mod ansi;
mod capture;
mod chart;
mod help;
mod messages;
mod nodes;
mod params;
mod passes;
mod picture;
mod reloads;
mod resource;
mod start;
mod status;
mod table;
pub mod theme;
mod time;
mod top;

use egui::{CentralPanel, Frame, Panel, Ui};

use super::action::Action;
use super::core::Core;
use crate::engine::Gpu;

/// Pixels of the picture to one of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    Full,
    Half,
    Quarter,
}

impl Scale {
    pub const ALL: [Scale; 3] = [Scale::Full, Scale::Half, Scale::Quarter];

    pub fn name(self) -> &'static str {
        match self {
            Scale::Full => "full size",
            Scale::Half => "half size",
            Scale::Quarter => "quarter size",
        }
    }

    fn factor(self) -> f32 {
        match self {
            Scale::Full => 1.0,
            Scale::Half => 0.5,
            Scale::Quarter => 0.25,
        }
    }
}

/// What the right side shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Passes,
    Reloads,
}

/// What the middle shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Middle {
    Picture,
    Resource,
    Graph,
}

/// Where things stand in the interface; nothing in the picture hangs on it but its size.
#[derive(Debug)]
pub struct Layout {
    pub shows_params: bool,
    pub shows_side: bool,
    pub side: Side,
    pub scale: Scale,
    pub shows_help: bool,
    pub shows_messages: bool,
    /// Of parameters.
    pub filter: String,
    pub middle: Middle,
    pub resource: resource::View,
    pub nodes: nodes::View,
    /// The graph as lives in memory, in place of nodes.
    pub shows_lives: bool,
    pub capture: capture::Form,
    /// Physical pixels that the picture has on the screen.
    room: Option<[f32; 2]>,
    scenes: Option<Vec<std::path::PathBuf>>,
}

impl Layout {
    pub fn new(_gpu: &Gpu) -> Self {
        Self {
            shows_params: true,
            shows_side: true,
            side: Side::Passes,
            scale: Scale::Full,
            shows_help: false,
            shows_messages: true,
            filter: String::new(),
            middle: Middle::Picture,
            resource: resource::View::default(),
            nodes: nodes::View::default(),
            shows_lives: false,
            capture: capture::Form::default(),
            room: None,
            scenes: None,
        }
    }

    /// Pixels that the picture is to have.
    pub fn picture_size(&self) -> Option<[u32; 2]> {
        let factor = self.scale.factor();
        self.room.map(|room| room.map(|side| (side * factor).round().clamp(16.0, 8192.0) as u32))
    }

    /// Lets go of textures of a device that is gone.
    pub fn forget_textures(&mut self) {
        self.resource.forget_texture();
    }
}

/// Draws everything.
pub fn draw(
    ui: &mut Ui,
    core: &Core,
    layout: &mut Layout,
    picture: Option<egui::TextureId>,
    actions: &mut Vec<Action>,
) {
    top::draw(ui, core, layout, actions);
    status::draw(ui, core);
    if core.state.job.is_none() {
        CentralPanel::default_margins().show(ui, |ui| start::draw(ui, layout, actions));
        help::draw(ui, layout);
        return;
    }
    if layout.shows_params {
        Panel::left("params").default_size(300.0).size_range(220.0..=480.0).show(ui, |ui| {
            params::draw(ui, core, layout, actions);
        });
    }
    if layout.shows_side {
        Panel::right("side")
            .default_size(330.0)
            .size_range(240.0..=560.0)
            .show(ui, |ui| side(ui, core, layout, actions));
    }
    messages::draw(ui, core, layout, actions);
    time::draw(ui, core, actions);
    CentralPanel::no_frame().frame(Frame::NONE.fill(theme::BACKDROP)).show(ui, |ui| {
        middle(ui, core, layout, picture, actions);
    });
    capture::draw(ui, core, layout, actions);
    help::draw(ui, layout);
}

fn middle(ui: &mut Ui, core: &Core, layout: &mut Layout, picture: Option<egui::TextureId>, actions: &mut Vec<Action>) {
    Frame::NONE.inner_margin(4.0).show(ui, |ui| {
        ui.horizontal(|ui| {
            let before = layout.middle;
            for (middle, name) in
                [(Middle::Picture, "Picture"), (Middle::Resource, "Resource"), (Middle::Graph, "Graph")]
            {
                ui.selectable_value(&mut layout.middle, middle, name);
            }
            if before == Middle::Resource && layout.middle != before {
                // Nothing is read back that nobody looks at.
                actions.push(Action::Look(None));
            }
        });
    });
    match layout.middle {
        Middle::Picture => picture::draw(ui, core, layout, picture, actions),
        Middle::Resource => resource::draw(ui, core, layout, actions),
        Middle::Graph => chart::draw(ui, core, layout, actions),
    }
    picture::keys(ui, core, layout, actions);
}

fn side(ui: &mut Ui, core: &Core, layout: &mut Layout, actions: &mut Vec<Action>) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.selectable_value(&mut layout.side, Side::Passes, "Passes");
        ui.selectable_value(&mut layout.side, Side::Reloads, format!("Reloads {}", core.state.reloads.len()));
    });
    ui.separator();
    match layout.side {
        Side::Passes => passes::draw(ui, core, layout, actions),
        Side::Reloads => {
            reloads::draw(ui, core);
            if core.state.counts {
                // Nothing runs for what nobody looks at.
                actions.push(Action::Count(false));
            }
        }
    }
}

/// Whether Escape was pressed, which closes what lies over the picture.
fn is_left(ui: &Ui) -> bool {
    ui.input(|input| input.key_pressed(egui::Key::Escape))
}

/// The end of a path, which tells most.
fn ending(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    format!("..{}", text.chars().skip(count + 2 - most.max(2)).collect::<String>())
}
