//! The device: finding an adapter, opening it with all that plans may need, and hearing what
//! goes wrong on it. Nothing here panics: what wgpu reports outside an error scope becomes a
//! diagnostic of the next call.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use wgpu_types::{AdapterInfo, Features, Limits, PowerPreference};

use super::claims::Claims;
use super::errors::{self, Faults};
use crate::diagnostic::{Code, Diagnostic};

/// How to choose an adapter.
#[derive(Clone, Debug, Default)]
pub struct GpuOptions {
    /// `vulkan`, `metal`, `dx12` or `gl`; absent: any of them but GL, which stores some things
    /// wrong in silence and so is taken only by name.
    pub backend: Option<String>,
    pub power: PowerPreference,
    /// Features wanted beyond those that plans may need; those that the adapter lacks are left
    /// out.
    pub features: Features,
    /// Features to do without even where the adapter has them: to see what others see.
    pub without: Features,
}

/// One adapter of the machine, as plain data.
#[derive(Clone, Debug)]
pub struct AdapterSummary {
    pub info: AdapterInfo,
    pub features: Features,
    pub limits: Limits,
}

/// An open device. Clones are the same device.
#[derive(Clone, Debug)]
pub struct Gpu {
    instance: Option<wgpu::Instance>,
    adapter: Option<wgpu::Adapter>,
    device: wgpu::Device,
    queue: wgpu::Queue,
    faults: Arc<Mutex<Faults>>,
    uploaded: Arc<AtomicU64>,
    claims: Claims,
}

/// What plans may make use of, where an adapter has it.
const WANTED: &[Features] = &[
    Features::FLOAT32_FILTERABLE,
    Features::FLOAT32_BLENDABLE,
    Features::TIMESTAMP_QUERY,
    Features::TIMESTAMP_QUERY_INSIDE_ENCODERS,
    Features::TIMESTAMP_QUERY_INSIDE_PASSES,
    Features::DEPTH32FLOAT_STENCIL8,
    Features::RG11B10UFLOAT_RENDERABLE,
    Features::BGRA8UNORM_STORAGE,
    Features::DEPTH_CLIP_CONTROL,
    Features::DUAL_SOURCE_BLENDING,
    Features::CLIP_DISTANCES,
    Features::PRIMITIVE_INDEX,
    Features::SHADER_F16,
    Features::SHADER_F64,
    Features::SHADER_INT64,
    Features::SHADER_FLOAT32_ATOMIC,
    Features::SHADER_INT64_ATOMIC_MIN_MAX,
    Features::SHADER_INT64_ATOMIC_ALL_OPS,
    Features::TEXTURE_ATOMIC,
    Features::SUBGROUP,
    Features::SUBGROUP_BARRIER,
    Features::SUBGROUP_VERTEX,
    Features::VERTEX_WRITABLE_STORAGE,
    Features::TEXTURE_FORMAT_16BIT_NORM,
    Features::MULTISAMPLE_ARRAY,
];

/// Longest wait for submitted work. A shader that loops for ever is noticed after it.
const LONGEST_WAIT: Duration = Duration::from_secs(300);

/// The union of all features that the engine asks adapters for.
pub fn wanted_features() -> Features {
    WANTED.iter().fold(Features::empty(), |all, one| all | *one)
}

impl Gpu {
    /// Opens the adapter that the options choose, with every wanted feature that it has and its
    /// own limits.
    ///
    /// # Errors
    /// If no adapter is usable, or it gives no device, with a remedy.
    pub fn open(options: &GpuOptions) -> Result<Self, Diagnostic> {
        let instance = Self::instance(options)?;
        Self::open_on(instance, options, None)
    }

    /// A wgpu instance for the options, for those who make a surface before they open a device.
    ///
    /// # Errors
    /// If the options name no backend that there is.
    pub fn instance(options: &GpuOptions) -> Result<wgpu::Instance, Diagnostic> {
        Ok(wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: backends(options.backend.as_deref())?,
            flags: wgpu::InstanceFlags::from_env_or_default(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        }))
    }

    /// Opens an adapter of this instance, one that can show on the surface if there is one.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn open_on(
        instance: wgpu::Instance,
        options: &GpuOptions,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, Diagnostic> {
        let request = wgpu::RequestAdapterOptions {
            power_preference: options.power,
            compatible_surface: surface,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&request)).map_err(|e| errors::no_adapter(&e))?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("meniscus"),
            required_features: (adapter.features() & (wanted_features() | options.features)) - options.without,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|e| errors::no_device(&adapter, &e))?;
        let mut gpu = Self::from_parts(Some(adapter), device, queue);
        gpu.instance = Some(instance);
        Ok(gpu)
    }

    /// The instance that it was opened on; an embedder's is not known.
    pub(super) fn opened_on(&self) -> Option<&wgpu::Instance> {
        self.instance.as_ref()
    }

    /// Takes over a device that an embedder opened. Its callbacks for errors and for loss are
    /// replaced by the engine's: once for each device, and clones for all engines on it.
    pub fn from_parts(adapter: Option<wgpu::Adapter>, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let faults = Arc::new(Mutex::new(Faults::default()));
        let uncaptured = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            uncaptured.lock().unwrap_or_else(PoisonError::into_inner).refused(&error);
        }));
        let lost = Arc::clone(&faults);
        device.set_device_lost_callback(move |reason, message| {
            // A device that is dropped or destroyed on purpose is nobody's fault, but nothing runs on it either.
            lost.lock().unwrap_or_else(PoisonError::into_inner).lost(format!("{reason:?}: {message}"));
        });
        Self { instance: None, adapter, device, queue, faults, uploaded: Arc::default(), claims: Claims::default() }
    }

    /// Every adapter of the machine, those of GL only if it is named.
    ///
    /// # Errors
    /// If the options name no backend that there is.
    pub fn adapters(options: &GpuOptions) -> Result<Vec<AdapterSummary>, Diagnostic> {
        let backends = backends(options.backend.as_deref())?;
        let adapters = pollster::block_on(Self::instance(options)?.enumerate_adapters(backends));
        Ok(adapters
            .iter()
            .map(|a| AdapterSummary { info: a.get_info(), features: a.features(), limits: a.limits() })
            .collect())
    }

    pub fn instance_ref(&self) -> Option<&wgpu::Instance> {
        self.instance.as_ref()
    }

    pub fn adapter(&self) -> Option<&wgpu::Adapter> {
        self.adapter.as_ref()
    }

    pub(super) fn claims(&self) -> &Claims {
        &self.claims
    }

    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Writes to a buffer, and counts it.
    pub(super) fn write_buffer(&self, buffer: &wgpu::Buffer, at: u64, bytes: &[u8]) {
        self.uploaded.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        self.queue.write_buffer(buffer, at, bytes);
    }

    /// Writes to a texture, and counts it.
    pub(super) fn write_texture(
        &self,
        texture: wgpu::TexelCopyTextureInfo<'_>,
        bytes: &[u8],
        layout: wgpu::TexelCopyBufferLayout,
        size: wgpu::Extent3d,
    ) {
        self.uploaded.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        self.queue.write_texture(texture, bytes, layout, size);
    }

    /// Bytes that the engine has written to the device up to now.
    pub fn uploaded_bytes(&self) -> u64 {
        self.uploaded.load(Ordering::Relaxed)
    }

    pub fn features(&self) -> Features {
        self.device.features()
    }

    pub fn limits(&self) -> Limits {
        self.device.limits()
    }

    pub fn info(&self) -> AdapterInfo {
        self.device.adapter_info()
    }

    /// What was recorded since the last call: a lost device stays lost, refused work is told
    /// once.
    ///
    /// # Errors
    /// If anything was recorded.
    pub fn check(&self) -> Result<(), Diagnostic> {
        self.faults.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// If it does not end within five minutes, or the device was lost or refused something.
    pub fn wait(&self) -> Result<(), Diagnostic> {
        let waited = self.drain();
        self.check()?;
        waited
    }

    /// The same without asking whether anything was refused.
    ///
    /// # Errors
    /// If it does not end within five minutes.
    pub(super) fn drain(&self) -> Result<(), Diagnostic> {
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: Some(LONGEST_WAIT) });
        waited.map(|_| ()).map_err(|e| errors::wait_failed(&e, LONGEST_WAIT))
    }

    /// Calls back once all that was submitted so far is done, from within [`Gpu::poll`] or a wait.
    pub fn when_done(&self, call: impl FnOnce() + Send + 'static) {
        self.queue.on_submitted_work_done(call);
    }

    /// Lets callbacks of finished work run, without waiting.
    pub fn poll(&self) {
        // Only waiting can fail.
        _ = self.device.poll(wgpu::PollType::Poll);
    }
}

fn backends(name: Option<&str>) -> Result<wgpu::Backends, Diagnostic> {
    let Some(name) = name else {
        return Ok(wgpu::Backends::VULKAN
            | wgpu::Backends::METAL
            | wgpu::Backends::DX12
            | wgpu::Backends::BROWSER_WEBGPU);
    };
    match name.to_ascii_lowercase().as_str() {
        "vulkan" | "vk" => Ok(wgpu::Backends::VULKAN),
        "metal" => Ok(wgpu::Backends::METAL),
        "dx12" => Ok(wgpu::Backends::DX12),
        "gl" | "gles" | "opengl" => Ok(wgpu::Backends::GL),
        "webgpu" => Ok(wgpu::Backends::BROWSER_WEBGPU),
        _ => Err(Diagnostic::error(
            Code::DEVICE,
            format!("unknown backend `{name}`: expected `vulkan`, `metal`, `dx12`, `gl` or `webgpu`"),
        )
        .nearest(name, ["vulkan", "metal", "dx12", "gl", "webgpu"])),
    }
}
