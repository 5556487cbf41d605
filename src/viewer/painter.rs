//! The window's surface, and egui drawn on it with the engine's own device.

use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use crate::diagnostic::{Code, Diagnostic};
use crate::engine::Gpu;

pub struct Painter {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    renderer: Renderer,
    picture: Option<egui::TextureId>,
    /// The surface has to be configured before it is drawn on again.
    is_outdated: bool,
}

/// One pass of the interface, ready to be painted.
pub struct Paint {
    pub primitives: Vec<egui::ClippedPrimitive>,
    pub textures: egui::TexturesDelta,
    pub pixels_per_point: f32,
}

impl Painter {
    /// # Errors
    /// If the adapter cannot show on this surface.
    pub fn new(gpu: &Gpu, surface: wgpu::Surface<'static>, size: [u32; 2]) -> Result<Self, Diagnostic> {
        let refused = |why: &str| Diagnostic::error(Code::DEVICE, format!("no usable graphics adapter: {why}"));
        let adapter = gpu.adapter().ok_or_else(|| refused("the device has no adapter to show with"))?;
        let formats = surface.get_capabilities(adapter).formats;
        // egui blends in gamma space, and wants a target that does not encode.
        let format = formats.iter().find(|f| !f.is_srgb()).or(formats.first());
        let format = *format.ok_or_else(|| refused("it cannot show in this window"))?;
        let config = surface
            .get_default_config(adapter, size[0].max(1), size[1].max(1))
            .ok_or_else(|| refused("it cannot show in this window"))?;
        let config = wgpu::SurfaceConfiguration {
            format,
            present_mode: wgpu::PresentMode::AutoVsync,
            view_formats: vec![format],
            ..config
        };
        let renderer = Renderer::new(gpu.device(), format, RendererOptions::default());
        Ok(Self { surface, config, renderer, picture: None, is_outdated: true })
    }

    pub fn surface(&self) -> &wgpu::Surface<'static> {
        &self.surface
    }

    /// Goes on with another device of the same instance. What egui had is to be given again.
    pub fn rebind(&mut self, gpu: &Gpu) {
        self.renderer = Renderer::new(gpu.device(), self.config.format, RendererOptions::default());
        self.picture = None;
        self.is_outdated = true;
    }

    pub fn resize(&mut self, size: [u32; 2]) {
        self.is_outdated |= [self.config.width, self.config.height] != size;
        [self.config.width, self.config.height] = size;
    }

    /// Shows this texture as the picture from now on.
    pub fn set_picture(&mut self, gpu: &Gpu, texture: &wgpu::Texture) {
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let filter = wgpu::FilterMode::Linear;
        match self.picture {
            Some(id) => self.renderer.update_egui_texture_from_wgpu_texture(gpu.device(), &view, filter, id),
            None => self.picture = Some(self.renderer.register_native_texture(gpu.device(), &view, filter)),
        }
    }

    pub fn picture(&self) -> Option<egui::TextureId> {
        self.picture
    }

    /// Paints the interface. Tells whether it has to be painted again at once, because the window
    /// changed under it.
    pub fn paint(&mut self, gpu: &Gpu, mut paint: Paint) -> bool {
        let (device, queue) = (gpu.device(), gpu.queue());
        for (id, deltas) in paint.textures.set.drain() {
            for delta in deltas {
                self.renderer.update_texture(device, queue, id, &delta);
            }
        }
        let again = self.draw(gpu, &paint.primitives, paint.pixels_per_point);
        for id in paint.textures.free.drain() {
            self.renderer.free_texture(&id);
        }
        again
    }

    fn draw(&mut self, gpu: &Gpu, primitives: &[egui::ClippedPrimitive], pixels_per_point: f32) -> bool {
        // A window without area shows nothing.
        if self.config.width == 0 || self.config.height == 0 {
            return false;
        }
        if std::mem::take(&mut self.is_outdated) {
            self.surface.configure(gpu.device(), &self.config);
        }
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) => frame,
            wgpu::CurrentSurfaceTexture::Suboptimal(frame) => {
                self.is_outdated = true;
                frame
            }
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.is_outdated = true;
                return true;
            }
            wgpu::CurrentSurfaceTexture::Timeout => return true,
            _ => return false,
        };
        let screen = ScreenDescriptor { size_in_pixels: [self.config.width, self.config.height], pixels_per_point };
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let before = self.renderer.update_buffers(gpu.device(), gpu.queue(), &mut encoder, primitives, &screen);
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("window"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), primitives, &screen);
        gpu.queue().submit(before.into_iter().chain([encoder.finish()]));
        gpu.queue().present(frame);
        false
    }
}
