//! naga on the assembled text: parsing, binding numbers, validation, and which features it takes.

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use wgpu_types::{DownlevelFlags, Features};

use super::assemble::Assembled;
use super::message;
use crate::diagnostic::Diagnostic;

/// A module that naga accepts.
#[derive(Debug)]
pub(super) struct Parsed {
    pub module: naga::Module,
    pub info: ModuleInfo,
    /// The resources in the order of declaration: binding `i` of group 0 is the `i`-th.
    pub globals: Vec<naga::Handle<naga::GlobalVariable>>,
    /// What the module takes beyond WebGPU's defaults.
    pub features: Features,
}

/// The diagnostics are boxed: they are the rare way out.
pub(super) fn parse(assembled: &Assembled) -> Result<Parsed, Box<Diagnostic>> {
    if let Some(diagnostic) = message::broken_text(assembled) {
        return Err(Box::new(diagnostic));
    }
    let parsed = naga::front::wgsl::Frontend::new().parse(&assembled.whole);
    let mut module = parsed.map_err(|error| Box::new(message::parse_error(&error, assembled)))?;
    let globals = bind(&mut module);
    let validated = validate(&module);
    let (info, features) =
        validated.map_err(|error| Box::new(message::validation_error(&error, &module, assembled)))?;
    Ok(Parsed { module, info, globals, features })
}

/// Numbers the resources in the order of their text, whatever `@group` and `@binding` say.
fn bind(module: &mut naga::Module) -> Vec<naga::Handle<naga::GlobalVariable>> {
    let arena = &mut module.global_variables;
    let mut globals: Vec<_> = arena.iter().filter(|(_, v)| is_resource(v.space)).map(|(handle, _)| handle).collect();
    globals.sort_by_key(|handle| arena.get_span(*handle).to_range().map(|range| range.start));
    for (binding, handle) in globals.iter().enumerate() {
        arena.get_mut(*handle).binding = Some(naga::ResourceBinding { group: 0, binding: binding as u32 });
    }
    globals
}

fn is_resource(space: naga::AddressSpace) -> bool {
    use naga::AddressSpace as Space;
    matches!(space, Space::Uniform | Space::Storage { .. } | Space::Handle)
}

/// Features that let a shader do more and that a graph can report as needs, the stronger of two
/// that cover the same before the weaker.
const FEATURES: &[Features] = &[
    Features::SHADER_F64,
    Features::SHADER_F16,
    Features::SHADER_I16,
    Features::SHADER_INT64_ATOMIC_ALL_OPS,
    Features::SHADER_INT64_ATOMIC_MIN_MAX,
    Features::TEXTURE_INT64_ATOMIC,
    Features::SHADER_INT64,
    Features::TEXTURE_ATOMIC,
    Features::SHADER_FLOAT32_ATOMIC,
    Features::TEXTURE_FORMAT_16BIT_NORM,
    Features::PRIMITIVE_INDEX,
    Features::SHADER_EARLY_DEPTH_TEST,
    Features::DUAL_SOURCE_BLENDING,
    Features::CLIP_DISTANCES,
    Features::SHADER_BARYCENTRICS,
    Features::SHADER_PER_VERTEX,
    Features::SHADER_DRAW_INDEX,
    Features::MEMORY_DECORATION_COHERENT,
    Features::MEMORY_DECORATION_VOLATILE,
    Features::SUBGROUP_BARRIER,
    Features::SUBGROUP_VERTEX,
    Features::SUBGROUP,
];

fn capabilities(features: Features) -> Capabilities {
    wgpu_naga_bridge::features_to_naga_capabilities(features, DownlevelFlags::compliant())
}

type ValidationError = Box<naga::WithSpan<naga::valid::ValidationError>>;

/// With WebGPU's defaults first. Only if those do not suffice is it found, feature by feature,
/// which can be left out.
fn validate(module: &naga::Module) -> Result<(ModuleInfo, Features), ValidationError> {
    let validator = |features| Validator::new(ValidationFlags::all(), capabilities(features));
    let with = |features| validator(features).validate(module).map_err(Box::new);
    let plain = with(Features::empty());
    if let Ok(info) = plain {
        return Ok((info, Features::empty()));
    }
    let mut needed = FEATURES.iter().fold(Features::empty(), |all, feature| all | *feature);
    let mut info = with(needed)?;
    for feature in FEATURES {
        if let Ok(found) = with(needed - *feature) {
            (needed, info) = (needed - *feature, found);
        }
    }
    Ok((info, needed))
}
