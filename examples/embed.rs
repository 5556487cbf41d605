//! A graph in somebody else's wgpu program: their device and queue, their commands, their
//! textures in and out. There is no window; three frames are drawn, the last of them larger, and
//! the last one is saved.
//!
//! ```text
//! cargo run --example embed -- picture.png
//! ```

use std::error::Error;
use std::f64::consts::TAU;

use glam::DVec3;
use meniscus::embed::{
    Camera, Diagnostics, DiskFiles, Engine, Frame, Gpu, InputInfo, Light, ObjectId, Plan, Program, Report, Request,
    Runner, Sources, Style, Texture, TextureFormat, instantiate, load, render_all, wanted_features,
};

/// Metres.
const RADIUS: f32 = 0.04;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "embedded.png".into());
    // The host's own wgpu: nothing of it is the library's business.
    let instance = wgpu::Instance::default();
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let descriptor = wgpu::DeviceDescriptor {
        required_features: adapter.features() & wanted_features(),
        required_limits: adapter.limits(),
        ..wgpu::DeviceDescriptor::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;

    let mut water = Water::new(Gpu::from_parts(Some(adapter), device.clone(), queue.clone()), [320, 240])?;
    let sky = sky(&device, &queue);
    let mut picture = target(&device, [320, 240]);
    for number in 0..3 {
        if number == 2 {
            // The host's window has another size now.
            water.resize([480, 360])?;
            picture = target(&device, [480, 360]);
        }
        // Version 1 in every frame: it has not changed, so that nothing made from it runs again.
        // Each plan numbers its objects anew.
        let id = water.input("environment")?;
        water.runner()?.share_texture_version(id, &sky, 1).map_err(|d| d.message)?;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        clear(&mut encoder, &picture);
        let output = water.draw(number, &mut encoder)?;
        encoder.copy_texture_to_texture(output.as_image_copy(), picture.as_image_copy(), picture.size());
        queue.submit([encoder.finish()]);
        // Answers of frames before, if they are there; nothing waits.
        if let Some(report) = water.poll() {
            println!(
                "frame {}: {} passes, {:.3} ms on the GPU",
                report.frame,
                report.passes.len(),
                report.gpu_ms().unwrap_or(0.0)
            );
        }
    }
    save(&device, &queue, &picture, &file)?;
    println!("{file}");
    Ok(())
}

/// All that a host keeps of a graph.
struct Water {
    program: Program,
    engine: Engine,
    /// Absent only while another takes its place.
    runner: Option<Runner>,
    particles: Vec<[f32; 3]>,
    size: [u32; 2],
}

impl Water {
    fn new(gpu: Gpu, size: [u32; 2]) -> Result<Self, Box<dyn Error>> {
        // Graphs come from the disk, from memory, or from what the library carries, as this one.
        let mut sources = Sources::new();
        let loaded = load(&DiskFiles, &mut sources, "imai2014.ron", None);
        let program = loaded.program.ok_or_else(|| render_all(&loaded.diagnostics, &sources, Style::Plain))?;
        let particles = ball();
        let mut engine = Engine::new(gpu);
        let plan = plan(&program, &engine, &particles, size).map_err(told)?;
        let runner = engine.prepare(plan, None).map_err(|refused| told(refused.diagnostics))?;
        let mut water = Self { program, engine, runner: Some(runner), particles, size };
        water.upload()?;
        Ok(water)
    }

    fn runner(&mut self) -> Result<&mut Runner, &'static str> {
        self.runner.as_mut().ok_or("nothing was prepared")
    }

    /// The number of the object behind an input. What it has to be comes with it.
    fn input(&mut self, path: &str) -> Result<ObjectId, Box<dyn Error>> {
        let (id, _) = self.runner()?.plan().needs(path).ok_or_else(|| format!("the graph takes no `{path}`"))?;
        Ok(id)
    }

    /// Plans for another size. What did not change stays; if it fails, so does everything.
    fn resize(&mut self, size: [u32; 2]) -> Result<(), Box<dyn Error>> {
        let plan = plan(&self.program, &self.engine, &self.particles, size).map_err(told)?;
        match self.engine.prepare(plan, self.runner.take()) {
            Ok(runner) => self.runner = Some(runner),
            Err(refused) => {
                self.runner = refused.previous;
                return Err(told(refused.diagnostics).into());
            }
        }
        self.size = size;
        self.upload()
    }

    /// Particles, where they are not there already.
    fn upload(&mut self) -> Result<(), Box<dyn Error>> {
        let id = self.input("particles.position")?;
        let runner = self.runner.as_mut().ok_or("nothing was prepared")?;
        if !runner.keeps_input(id) {
            runner.upload_buffer(&self.engine, id, bytemuck::cast_slice(&self.particles)).map_err(|d| d.message)?;
        }
        Ok(())
    }

    fn poll(&mut self) -> Option<Report> {
        self.runner.as_mut()?.poll(&self.engine)
    }

    /// Adds a frame to the host's commands, and gives the texture that it comes to lie in.
    fn draw(&mut self, number: u64, encoder: &mut wgpu::CommandEncoder) -> Result<&wgpu::Texture, Box<dyn Error>> {
        let angle = 0.2 * number as f64;
        let eye = DVec3::new(1.6 * angle.cos(), 0.9, 1.6 * angle.sin());
        let camera = Camera::new(eye, DVec3::ZERO, 45.0);
        let sun = Light { direction: DVec3::new(-0.5, -0.8, -0.4), color: DVec3::ONE, intensity: 4.0 };
        let size = self.size;
        let frame = Frame {
            time: number as f64 / 60.0,
            delta: 1.0 / 60.0,
            frame: number,
            steps: &[],
            // Live inputs, by the names that the graph declares.
            live: &|name, _| match name.split_once('.')? {
                ("camera", field) => camera.field(field, size),
                ("sun", field) => sun.field(field),
                _ => None,
            },
            only: None,
        };
        let runner = self.runner.as_mut().ok_or("nothing was prepared")?;
        runner.encode(&self.engine, &frame, encoder).map_err(told)?;
        let output = runner.plan().outputs.first().ok_or("a graph without outputs")?.object;
        Ok(runner.texture(output).ok_or("the picture is no texture")?)
    }
}

fn plan(program: &Program, engine: &Engine, particles: &[[f32; 3]], size: [u32; 2]) -> Result<Plan, Diagnostics> {
    let mut request = Request::new(size, engine.gpu().features(), engine.gpu().limits());
    let bound = f64::from(RADIUS) * 14.0;
    let info = InputInfo::Particles {
        count: particles.len() as u64,
        radius: f64::from(RADIUS),
        min: [-bound; 3],
        max: [bound; 3],
        attributes: vec![("position".into(), 3)],
    };
    let environment = Texture {
        format: TextureFormat::Rgba16Float,
        width: SKY[0],
        height: SKY[1],
        layers: 1,
        is_3d: false,
        mips: 1,
        samples: 1,
        // What passes need besides is added: see `plan.needs("environment")`.
        usages: wgpu::TextureUsages::empty(),
    };
    request.inputs.insert("particles".into(), info);
    request.inputs.insert("environment".into(), InputInfo::Texture(environment));
    request.inputs.insert("camera".into(), InputInfo::Camera);
    request.inputs.insert("sun".into(), InputInfo::Light);
    instantiate(program, &request)
}

fn told(diagnostics: Diagnostics) -> String {
    let messages: Vec<&str> = diagnostics.iter().map(|d| d.message.as_str()).collect();
    messages.join("\n")
}

/// Positions inside a ball.
fn ball() -> Vec<[f32; 3]> {
    let steps = -7..=7;
    let grid = steps.clone().flat_map(|x| steps.clone().map(move |y| (x, y)));
    let all = grid.flat_map(|(x, y)| (-7..=7).map(move |z| [x, y, z].map(|n| n as f32 * 1.8 * RADIUS)));
    all.filter(|p| p.iter().map(|x| x * x).sum::<f32>() < (12.0 * RADIUS).powi(2)).collect()
}

const SKY: [u32; 2] = [64, 32];

/// What the host shows where the graph shows nothing.
const BACKDROP: [f32; 3] = [0.5, 0.65, 0.85];

/// The host's own texture, which the graph reads.
fn sky(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::Texture {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("the host's sky"),
        size: wgpu::Extent3d { width: SKY[0], height: SKY[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels = (0..SKY[1]).flat_map(|y| {
        (0..SKY[0]).flat_map(move |x| {
            let up = 1.0 - f64::from(y) / f64::from(SKY[1]);
            let band = 0.1 * (f64::from(x) / f64::from(SKY[0]) * TAU).sin();
            [0.3 + 0.4 * up + band, 0.45 + 0.4 * up, 0.6 + 0.5 * up, 1.0].map(|v| half::f16::from_f64(v).to_bits())
        })
    });
    let texels: Vec<u16> = texels.collect();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SKY[0] * 8), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, texture.size());
    texture
}

/// What the host shows: light, as the graph makes it.
fn target(device: &wgpu::Device, [width, height]: [u32; 2]) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("the host's picture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// A pass of the host's in front of the graph's, in the same commands.
fn clear(encoder: &mut wgpu::CommandEncoder, picture: &wgpu::Texture) {
    let view = picture.create_view(&wgpu::TextureViewDescriptor::default());
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("the host's pass"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        ..wgpu::RenderPassDescriptor::default()
    });
}

/// Reads the picture back and saves it over the backdrop, with white at 1.
fn save(device: &wgpu::Device, queue: &wgpu::Queue, picture: &wgpu::Texture, file: &str) -> Result<(), Box<dyn Error>> {
    let (width, height) = (picture.width(), picture.height());
    let row = (width * 8).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("the host's copy"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), into, picture.size());
    queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None })?;
    let bytes = buffer.get_mapped_range(..)?.to_vec();
    let light = |x: u32, y: u32, channel: u32| {
        let at = (y * row + x * 8 + channel * 2) as usize;
        f32::from(half::f16::from_le_bytes([bytes[at], bytes[at + 1]]))
    };
    // Alpha is multiplied in, and says how much of the host's own backdrop is covered.
    let over =
        |x: u32, y: u32, channel: u32| light(x, y, channel) + (1.0 - light(x, y, 3)) * BACKDROP[channel as usize];
    let picture = image::RgbImage::from_fn(width, height, |x, y| {
        image::Rgb([0, 1, 2].map(|channel| (over(x, y, channel).clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8))
    });
    picture.save(file)?;
    Ok(())
}
