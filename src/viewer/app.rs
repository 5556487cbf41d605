//! The event loop: winit's events to egui and to the core, and paint only when something changed.

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use super::Options;
use super::action::Action;
use super::core::Core;
use super::pace::Pace;
use super::painter::{Paint, Painter};
use super::ui::{self, Layout};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::engine::{Gpu, GpuOptions};

const SIZE: LogicalSize<f64> = LogicalSize::new(1280.0, 800.0);
/// Devices that are lost more often than this in a minute are given up.
const MOST_LOSSES: usize = 3;

/// The worker has something to say.
#[derive(Clone, Copy, Debug)]
struct News;

pub fn run(options: Options) -> Result<Pace, Diagnostics> {
    let events = EventLoop::<News>::with_user_event().build().map_err(|error| no_display(&error.to_string()))?;
    let mut app = App { options, proxy: events.create_proxy(), open: None, outcome: Ok(()), pace: Pace::default() };
    events.run_app(&mut app).map_err(|error| no_display(&error.to_string()))?;
    app.outcome.map(|()| app.pace)
}

fn no_display(why: &str) -> Diagnostic {
    // winit says `os error at FILE:LINE: what happened`; the place is in its own source.
    let why = why.strip_prefix("os error at ").and_then(|rest| rest.split_once(": ")).map_or(why, |(_, what)| what);
    Diagnostic::error(Code::DEVICE, format!("no usable graphics adapter: there is no display for a window: {why}"))
        .hint("`meniscus render SCENE -o FILE` needs none, and `meniscus watch` follows changes without one")
}

struct App {
    options: Options,
    proxy: EventLoopProxy<News>,
    open: Option<Open>,
    outcome: Result<(), Diagnostics>,
    pace: Pace,
}

/// A window with all that belongs to it.
struct Open {
    painter: Painter,
    core: Core,
    input: egui_winit::State,
    layout: Layout,
    window: Arc<Window>,
    gpu_options: GpuOptions,
    /// When egui wants to paint next.
    paint_at: Option<Instant>,
    is_hidden: bool,
    losses: Vec<Instant>,
    title: String,
}

impl ApplicationHandler<News> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match Open::new(events, &self.options, self.proxy.clone()) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(found) => self.end(events, Err(found)),
        }
    }

    fn new_events(&mut self, _events: &ActiveEventLoop, _cause: StartCause) {}

    fn user_event(&mut self, _events: &ActiveEventLoop, _news: News) {}

    fn window_event(&mut self, events: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match event {
            WindowEvent::CloseRequested => return self.end(events, Ok(())),
            // By somebody else: nothing may be asked of it any more.
            WindowEvent::Destroyed => {
                self.open = None;
                return self.end(events, Ok(()));
            }
            WindowEvent::RedrawRequested => {
                let began = Instant::now();
                open.redraw();
                return self.pace.painted(began.elapsed());
            }
            WindowEvent::Resized(size) => open.painter.resize([size.width, size.height]),
            WindowEvent::Occluded(is_hidden) => open.is_hidden = is_hidden,
            WindowEvent::DroppedFile(ref path) => open.core.act(Action::Open(path.clone())),
            _ => {}
        }
        if open.input.on_window_event(&open.window, &event).repaint {
            open.window.request_redraw();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        let began = Instant::now();
        let ticked = open.tick();
        self.pace.worked(began.elapsed());
        match ticked {
            Ok(wake) => events.set_control_flow(wake.map_or(ControlFlow::Wait, ControlFlow::WaitUntil)),
            Err(found) => self.end(events, Err(found)),
        }
    }

    fn exiting(&mut self, _events: &ActiveEventLoop) {
        // The surface goes before the window that it shows on.
        self.open = None;
    }
}

impl App {
    fn end(&mut self, events: &ActiveEventLoop, outcome: Result<(), Diagnostics>) {
        self.outcome = outcome;
        events.exit();
    }
}

impl Open {
    fn new(events: &ActiveEventLoop, options: &Options, proxy: EventLoopProxy<News>) -> Result<Self, Diagnostics> {
        let attributes = Window::default_attributes().with_title("meniscus").with_inner_size(SIZE);
        let window = events.create_window(attributes).map_err(|error| no_display(&error.to_string()))?;
        let window = Arc::new(window);
        let gpu_options = GpuOptions { backend: options.backend.clone(), ..GpuOptions::default() };
        let instance = Gpu::instance(&gpu_options)?;
        let surface = instance.create_surface(Arc::clone(&window)).map_err(|error| no_display(&error.to_string()))?;
        let gpu = Gpu::open_on(instance, &gpu_options, Some(&surface))?;
        let size = window.inner_size();
        let painter = Painter::new(&gpu, surface, [size.width, size.height])?;
        let layout = Layout::new(&gpu);
        let input = input(&window, &gpu, egui::Context::default());
        let core = Core::new(gpu, options.job.clone(), move || _ = proxy.send_event(News))?;
        Ok(Self {
            painter,
            core,
            input,
            layout,
            window,
            gpu_options,
            paint_at: None,
            is_hidden: false,
            losses: Vec::new(),
            title: String::new(),
        })
    }

    /// Lets the core work; gives the time of the next tick.
    fn tick(&mut self) -> Result<Option<Instant>, Diagnostics> {
        let now = Instant::now();
        let tick = self.core.tick(now);
        if tick.is_lost {
            self.recover(now)?;
        }
        if tick.repaint || self.paint_at.is_some_and(|at| at <= now) {
            self.paint_at = None;
            self.window.request_redraw();
        }
        let again = tick.again.map(|again| now + again);
        Ok([again, self.paint_at].into_iter().flatten().min())
    }

    fn redraw(&mut self) {
        if self.core.take_screen_change()
            && let Some(texture) = self.core.screen().texture()
        {
            self.painter.set_picture(self.core.gpu(), texture);
        }
        let raw = self.input.take_egui_input(&self.window);
        let context = self.input.egui_ctx().clone();
        let mut actions = Vec::new();
        let picture = self.painter.picture();
        let output = context.run_ui(raw, |ui| ui::draw(ui, &self.core, &mut self.layout, picture, &mut actions));
        self.input.handle_platform_output(&self.window, output.platform_output);
        actions.into_iter().for_each(|action| self.core.act(action));
        if let Some(size) = self.layout.picture_size() {
            self.core.want_size(size);
        }
        let delay = output.viewport_output.get(&egui::ViewportId::ROOT).map_or(Duration::MAX, |v| v.repaint_delay);
        self.paint_at = Instant::now().checked_add(delay).filter(|_| delay < Duration::from_secs(3600));
        let pixels_per_point = output.pixels_per_point;
        let primitives = context.tessellate(output.shapes, pixels_per_point);
        let paint = Paint { primitives, textures: output.textures_delta, pixels_per_point };
        if self.painter.paint(self.core.gpu(), paint) && !self.is_hidden {
            self.paint_at = Some(Instant::now() + Duration::from_millis(10));
        }
        let title = self.core.state.title();
        if title != self.title {
            self.window.set_title(&title);
            self.title = title;
        }
    }

    /// Goes on with another device, unless they are lost again and again.
    fn recover(&mut self, now: Instant) -> Result<(), Diagnostics> {
        self.losses.retain(|at| now.saturating_duration_since(*at) < Duration::from_secs(60));
        self.losses.push(now);
        let lost = self.core.state.findings.as_ref().map(|f| f.diagnostics.clone());
        let instance = self.core.gpu().instance_ref().cloned();
        let (Some(instance), true) = (instance, self.losses.len() <= MOST_LOSSES) else {
            return Err(lost.unwrap_or_default());
        };
        let gpu = Gpu::open_on(instance, &self.gpu_options, Some(self.painter.surface()))?;
        self.painter.rebind(&gpu);
        // What egui has on the old device goes with its context; where things stand stays.
        let context = egui::Context::default();
        let memory = self.input.egui_ctx().memory(Clone::clone);
        context.memory_mut(|fresh| *fresh = memory);
        self.layout.forget_textures();
        self.input = input(&self.window, &gpu, context);
        self.core.replace_device(gpu)?;
        Ok(())
    }
}

fn input(window: &Window, gpu: &Gpu, context: egui::Context) -> egui_winit::State {
    ui::theme::apply(&context);
    let most = usize::try_from(gpu.limits().max_texture_dimension_2d).ok();
    let scale = window.scale_factor() as f32;
    egui_winit::State::new(context, egui::ViewportId::ROOT, window, Some(scale), None, most)
}
