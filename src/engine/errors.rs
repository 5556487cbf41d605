//! What wgpu reports, as diagnostics.

use std::time::Duration;

use super::gpu::Gpu;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};

const LOST: &str = "the device was lost";
const NO_ADAPTER: &str = "no usable graphics adapter";

/// Errors that came outside any scope, and the loss of the device.
#[derive(Debug, Default)]
pub(super) struct Faults {
    lost: Option<String>,
    refused: Vec<String>,
}

impl Faults {
    pub fn lost(&mut self, message: String) {
        self.lost.get_or_insert(message);
    }

    pub fn refused(&mut self, error: &wgpu::Error) {
        // Errors tend to repeat each frame; the first few say it all.
        if self.refused.len() < 8 {
            self.refused.push(one_line(&error.to_string()));
        }
    }

    pub fn take(&mut self) -> Result<(), Diagnostic> {
        if let Some(message) = &self.lost {
            return Err(Diagnostic::error(Code::DEVICE, format!("{LOST}: {message}"))
                .hint("a shader that runs for very long makes drivers give up; try fewer items or a smaller picture"));
        }
        let refused = std::mem::take(&mut self.refused);
        match refused.first() {
            None => Ok(()),
            Some(first) => {
                let diagnostic = Diagnostic::error(Code::DEVICE, format!("the device refused: {first}"));
                Err(refused.iter().skip(1).fold(diagnostic, |d, other| d.hint(format!("also: {other}"))))
            }
        }
    }
}

/// Whether a diagnostic says that there is no device to work with: none was found, or it was
/// lost. Commands then end with exit code 3.
pub fn is_device_gone(diagnostic: &Diagnostic) -> bool {
    diagnostic.id == Code::DEVICE
        && (diagnostic.message.starts_with(LOST) || diagnostic.message.starts_with(NO_ADAPTER))
}

/// Whether any of them [`is_device_gone`].
pub fn any_device_gone(diagnostics: &Diagnostics) -> bool {
    diagnostics.iter().any(is_device_gone)
}

pub(super) fn no_adapter(error: &wgpu::RequestAdapterError) -> Diagnostic {
    let remedy = if cfg!(target_os = "linux") {
        "a software driver is enough: `apt-get install mesa-vulkan-drivers`"
    } else {
        "update the graphics driver"
    };
    Diagnostic::error(Code::DEVICE, NO_ADAPTER)
        .hint(remedy)
        .hint(format!("wgpu found: {}", one_line(&error.to_string())))
}

pub(super) fn no_device(adapter: &wgpu::Adapter, error: &wgpu::RequestDeviceError) -> Diagnostic {
    let name = adapter.get_info().name;
    Diagnostic::error(Code::DEVICE, format!("{NO_ADAPTER}: `{name}` gives no device: {}", one_line(&error.to_string())))
}

pub(super) fn wait_failed(error: &wgpu::PollError, limit: Duration) -> Diagnostic {
    match error {
        wgpu::PollError::Timeout => {
            Diagnostic::error(Code::DEVICE, format!("the device did not finish within {} s", limit.as_secs()))
                .hint("a shader may loop for ever")
        }
        other => Diagnostic::error(Code::DEVICE, format!("waiting for the device failed: {other}")),
    }
}

/// Runs `make` inside error scopes of all three kinds.
///
/// # Errors
/// The first error that wgpu raised in it, on one line.
pub(super) fn scoped<T>(gpu: &Gpu, make: impl FnOnce() -> T) -> Result<T, String> {
    let device = gpu.device();
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let made = make();
    // Scopes end in the reverse order of their begin.
    let errors = [validation, internal, memory].map(|scope| pollster::block_on(scope.pop()));
    match errors.into_iter().flatten().next() {
        None => Ok(made),
        Some(error) => Err(one_line(&error.to_string())),
    }
}

/// What the device refused, at the place in the graph that asked for it.
pub(super) fn refused(what: &str, path: &str, span: Span, error: &str) -> Diagnostic {
    Diagnostic::error(Code::DEVICE, format!("the device refused {what} `{path}`: {error}")).at(span, "asked for here")
}

/// wgpu's reports are chains over several lines.
fn one_line(text: &str) -> String {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ")
}
