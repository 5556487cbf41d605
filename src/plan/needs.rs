//! What a plan needs of a device, against WebGPU's defaults and against the device at hand.

use std::collections::BTreeMap;

use wgpu_types::{Features, Limits, ShaderStages};

use super::lower::{Lowering, fault, traced};
use super::model::{Bound, Needs, Object, ObjectKind, Pass, PassKind, ShaderUse};
use crate::diagnostic::{Code, Diagnostics, Span};
use crate::shader::reflect::Stage;

/// The largest amount of each thing, and the place that asks for it.
#[derive(Default)]
struct Wanted<'a>([(u64, Option<Place<'a>>); LIMITS.len()]);

/// What asks, and where the parts that it lies in are used.
type Place<'a> = (Span, &'a [Span]);

impl<'a> Wanted<'a> {
    fn at_least(&mut self, limit: Limit, amount: u64, span: Span, trace: &'a [Span]) {
        let entry = &mut self.0[limit as usize];
        if amount > entry.0 {
            *entry = (amount, Some((span, trace)));
        }
    }

    /// By the limits' names.
    fn sorted(&self) -> BTreeMap<&'static str, (u64, Span, &'a [Span])> {
        let asked = LIMITS.iter().zip(&self.0);
        asked.filter_map(|(name, (amount, at))| at.map(|(span, trace)| (*name, (*amount, span, trace)))).collect()
    }
}

/// Collects needs; what the device at hand lacks is an error. `touched` tells of which objects any
/// pass has to do with.
pub(super) fn needs(lowering: &Lowering<'_>, touched: &[bool]) -> (Needs, Diagnostics) {
    let mut wanted = Wanted::default();
    for (building, _) in lowering.objects.iter().zip(touched).filter(|(_, touched)| **touched) {
        of_object(&mut wanted, &building.object);
    }
    for flat in &lowering.flat {
        of_pass(&mut wanted, lowering, &flat.pass, flat.word, &flat.trace);
    }
    let mut found = Diagnostics::new();
    let mut limits = Vec::new();
    let (defaults, device) = (Limits::default(), &lowering.request.limits);
    for (name, (amount, span, trace)) in wanted.sorted() {
        if amount > limit(&defaults, name) {
            limits.push((name.to_owned(), amount, limit(&defaults, name)));
        }
        let has = limit(device, name);
        if amount > has {
            let message = format!("the device has {has} of `{name}`, and {amount} are needed");
            let diagnostic = fault(Code::DEVICE_LIMIT, message, span, format!("needs {amount}"));
            found.push(*traced(diagnostic, trace));
        }
    }
    let lacking = lowering.features - lowering.request.features;
    for (name, _) in lacking.iter_names() {
        let message =
            format!("the graph needs the device feature `{}`, which the device lacks", name.to_ascii_lowercase());
        let root = lowering.program.root.span;
        found.push(match lowering.feature_places.get(name) {
            Some((at, label, trace)) => *traced(fault(Code::DEVICE_LIMIT, message, *at, *label), trace),
            None => fault(Code::DEVICE_LIMIT, message, root, "this graph"),
        });
    }
    (Needs { features: lowering.features, limits }, found)
}

/// Features beyond WebGPU's defaults, by their names.
pub fn feature_names(features: Features) -> Vec<String> {
    features.iter_names().map(|(name, _)| name.to_ascii_lowercase()).collect()
}

fn of_object(wanted: &mut Wanted<'_>, object: &Object) {
    let at = object.span;
    match &object.kind {
        ObjectKind::Texture(t) if t.is_3d => {
            let edge = t.width.max(t.height).max(t.layers);
            wanted.at_least(Limit::max_texture_dimension_3d, u64::from(edge), at, &[]);
        }
        ObjectKind::Texture(t) => {
            wanted.at_least(Limit::max_texture_dimension_2d, u64::from(t.width.max(t.height)), at, &[]);
            wanted.at_least(Limit::max_texture_array_layers, u64::from(t.layers), at, &[]);
        }
        ObjectKind::Buffer(b) => wanted.at_least(Limit::max_buffer_size, b.bytes(), at, &[]),
    }
}

fn of_pass<'a>(wanted: &mut Wanted<'a>, lowering: &Lowering<'_>, pass: &Pass, word: Span, trace: &'a [Span]) {
    let shader = match &pass.kind {
        PassKind::Compute { shader, .. } => shader,
        PassKind::Draw(draw) => {
            wanted.at_least(Limit::max_color_attachments, draw.color.len() as u64, word, trace);
            let bytes: u32 = draw.color.iter().filter_map(|t| t.format.target_pixel_byte_cost()).sum();
            wanted.at_least(Limit::max_color_attachment_bytes_per_sample, u64::from(bytes), word, trace);
            &draw.shader
        }
        _ => return,
    };
    of_bindings(wanted, lowering, shader, word, trace);
    let module = &lowering.modules[shader.module];
    for name in shader.compute.iter() {
        let Some(entry) = module.stage(Stage::Compute).find(|e| e.name == *name) else { continue };
        let Ok(size) = module.workgroup_size(entry, &shader.constants) else { continue };
        let threads = size.iter().map(|n| u64::from(*n)).product();
        wanted.at_least(Limit::max_compute_invocations_per_workgroup, threads, entry.span, trace);
        wanted.at_least(Limit::max_compute_workgroup_size_x, u64::from(size[0]), entry.span, trace);
        wanted.at_least(Limit::max_compute_workgroup_size_y, u64::from(size[1]), entry.span, trace);
        wanted.at_least(Limit::max_compute_workgroup_size_z, u64::from(size[2]), entry.span, trace);
        wanted.at_least(
            Limit::max_compute_workgroup_storage_size,
            u64::from(entry.workgroup_memory),
            entry.span,
            trace,
        );
    }
}

fn of_bindings<'a>(
    wanted: &mut Wanted<'a>,
    lowering: &Lowering<'_>,
    shader: &ShaderUse,
    word: Span,
    trace: &'a [Span],
) {
    for stage in [ShaderStages::COMPUTE, ShaderStages::VERTEX, ShaderStages::FRAGMENT] {
        let mut counts = [0; LIMITS.len()];
        for binding in shader.bindings.iter().filter(|b| b.stages.contains(stage)) {
            let (name, size) = match &binding.bound {
                Bound::Uniform { block } => (
                    Limit::max_uniform_buffers_per_shader_stage,
                    Some((Limit::max_uniform_buffer_binding_size, u64::from(lowering.uniforms[*block].size))),
                ),
                Bound::UniformBuffer { buffer } => {
                    let size = super::memory::bytes(&lowering.object(*buffer).object.kind);
                    (Limit::max_uniform_buffers_per_shader_stage, Some((Limit::max_uniform_buffer_binding_size, size)))
                }
                Bound::Storage { buffer, .. } => {
                    let size = super::memory::bytes(&lowering.object(*buffer).object.kind);
                    (Limit::max_storage_buffers_per_shader_stage, Some((Limit::max_storage_buffer_binding_size, size)))
                }
                Bound::Material { bytes, .. } => (
                    Limit::max_uniform_buffers_per_shader_stage,
                    Some((Limit::max_uniform_buffer_binding_size, u64::from(*bytes))),
                ),
                Bound::Texture { .. } | Bound::MaterialTexture { .. } => {
                    (Limit::max_sampled_textures_per_shader_stage, None)
                }
                Bound::StorageTexture { .. } => (Limit::max_storage_textures_per_shader_stage, None),
                Bound::Sampler { .. } | Bound::MaterialSampler { .. } => (Limit::max_samplers_per_shader_stage, None),
            };
            counts[name as usize] += 1;
            if let Some((limit, size)) = size {
                wanted.at_least(limit, size, word, trace);
            }
        }
        for limit in BINDINGS {
            wanted.at_least(limit, counts[limit as usize], word, trace);
        }
    }
}

/// Limits on how many bindings of a kind a stage has.
const BINDINGS: [Limit; 5] = [
    Limit::max_uniform_buffers_per_shader_stage,
    Limit::max_storage_buffers_per_shader_stage,
    Limit::max_sampled_textures_per_shader_stage,
    Limit::max_storage_textures_per_shader_stage,
    Limit::max_samplers_per_shader_stage,
];

macro_rules! limits {
    ($($name:ident),* $(,)?) => {
        #[derive(Clone, Copy)]
        #[expect(non_camel_case_types, reason = "called as WebGPU calls them")]
        enum Limit {
            $($name),*
        }

        /// Names of the limits that plans are measured by.
        pub const LIMITS: &[&str] = &[$(stringify!($name)),*];

        /// A limit by its name in WebGPU.
        pub fn limit(limits: &Limits, name: &str) -> u64 {
            match name {
                $(stringify!($name) => limits.$name.into(),)*
                _ => u64::MAX,
            }
        }

        /// Sets a limit, to what fits in it. Tells whether there is one of this name.
        pub fn set_limit(limits: &mut Limits, name: &str, value: u64) -> bool {
            match name {
                $(stringify!($name) => limits.$name = value.try_into().unwrap_or(u32::MAX.into()),)*
                _ => return false,
            }
            true
        }
    };
}

limits! {
    max_texture_dimension_2d,
    max_texture_dimension_3d,
    max_texture_array_layers,
    max_buffer_size,
    max_color_attachments,
    max_color_attachment_bytes_per_sample,
    max_compute_invocations_per_workgroup,
    max_compute_workgroup_size_x,
    max_compute_workgroup_size_y,
    max_compute_workgroup_size_z,
    max_compute_workgroup_storage_size,
    max_uniform_buffers_per_shader_stage,
    max_uniform_buffer_binding_size,
    max_storage_buffers_per_shader_stage,
    max_storage_buffer_binding_size,
    max_sampled_textures_per_shader_stage,
    max_storage_textures_per_shader_stage,
    max_samplers_per_shader_stage,
}
