//! Devices to check against, without having one: what every browser has, what desktops have, or
//! what `info --format json` wrote on another machine.

use serde_json::Value as Json;
use wgpu_types::{Features, Limits};

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::plan::needs::{LIMITS, limit, set_limit};
use crate::shader::reflect::Module;

/// What a device has, under a name for messages.
#[derive(Clone, Debug)]
pub struct Device {
    pub name: String,
    pub features: Features,
    pub limits: Limits,
}

impl Device {
    /// Has everything: what a graph needs is then reported, not refused.
    pub fn anything() -> Self {
        let mut limits = Limits::default();
        for name in LIMITS {
            set_limit(&mut limits, name, u64::MAX);
        }
        Self { name: "any device".into(), features: Features::all(), limits }
    }

    /// What every device with WebGPU has, so every browser with it: no features, the default limits.
    pub fn core() -> Self {
        Self { name: "core".into(), features: Features::empty(), limits: Limits::default() }
    }

    /// What graphics cards of desktops have through Vulkan, Metal and DX12.
    pub fn native() -> Self {
        let features = Features::FLOAT32_FILTERABLE
            | Features::FLOAT32_BLENDABLE
            | Features::TIMESTAMP_QUERY
            | Features::DEPTH32FLOAT_STENCIL8
            | Features::RG11B10UFLOAT_RENDERABLE
            | Features::BGRA8UNORM_STORAGE
            | Features::DUAL_SOURCE_BLENDING
            | Features::SUBGROUP
            | Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES
            | Features::TEXTURE_FORMAT_16BIT_NORM;
        let mut limits = Limits::default();
        for (name, value) in NATIVE {
            set_limit(&mut limits, name, *value);
        }
        Self { name: "native".into(), features, limits }
    }

    /// A device by its name, if it is one of those that are built in.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "core" => Some(Self::core()),
            "native" => Some(Self::native()),
            _ => None,
        }
    }

    /// Reads what `info --format json` writes; its first adapter counts. An object with `features` and
    /// `limits` alone will do, and what it leaves out is as in [`Device::core`].
    ///
    /// # Errors
    /// If the text is no such JSON, or names a feature or limit that there is none of.
    pub fn from_json(file: &str, text: &str) -> Result<Self, Diagnostic> {
        let wrong = |why: String| Diagnostic::error(Code::ASSET, format!("`{file}` describes no device: {why}"));
        let json: Json = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        let adapter = match json.get("adapters") {
            Some(adapters) => adapters.get(0).ok_or_else(|| wrong("it lists no adapter".into()))?,
            None => &json,
        };
        if adapter.get("features").is_none() && adapter.get("limits").is_none() {
            let hint = "it is what `meniscus info --format json` writes: an object with `features` and `limits`";
            return Err(wrong("it has neither `features` nor `limits`".into()).hint(hint));
        }
        let mut device = Self::core();
        device.name = adapter.get("name").and_then(Json::as_str).unwrap_or(file).to_owned();
        match adapter.get("features") {
            None => {}
            Some(Json::Array(names)) => {
                for name in names {
                    let flag = feature(name).map_err(|(why, name)| nearest_feature(wrong(why), &name))?;
                    device.features |= flag;
                }
            }
            Some(_) => return Err(wrong("`features` is no list of names".into())),
        }
        match adapter.get("limits") {
            None => {}
            Some(Json::Object(limits)) => {
                for (name, value) in limits {
                    let Some(value) = value.as_u64() else {
                        return Err(wrong(format!("the limit `{name}` is no whole number from 0")));
                    };
                    if !set_limit(&mut device.limits, name, value) {
                        let unknown = wrong(format!("there is no limit `{name}`"));
                        return Err(unknown.nearest(name, LIMITS.iter().copied()));
                    }
                }
            }
            Some(_) => return Err(wrong("`limits` is no object of names and numbers".into())),
        }
        Ok(device)
    }

    /// What a shader by itself needs and the device lacks.
    pub fn lacking(&self, module: &Module) -> Vec<Diagnostic> {
        // A device takes modules whole: what one entry point needs, all need.
        let Some(entry) = module.entries.first() else { return Vec::new() };
        let lacking = entry.features - self.features;
        let told = lacking.iter_names().map(|(name, _)| {
            let message =
                format!("the shader needs the device feature `{}`, which the device lacks", name.to_ascii_lowercase());
            let found = Diagnostic::error(Code::DEVICE_LIMIT, message).at(entry.span, "this shader needs it");
            self.explain(found, true)
        });
        told.collect()
    }

    /// The diagnostics of a plan for the device, which is named beside what it lacks.
    pub fn explained(&self, found: Diagnostics) -> Diagnostics {
        Diagnostics(found.0.into_iter().map(|diagnostic| self.explain(diagnostic, true)).collect())
    }

    /// Names the device beside what it lacks; what lacks only with other values than the defaults is
    /// no error of the graph.
    pub(super) fn explain(&self, mut found: Diagnostic, is_default: bool) -> Diagnostic {
        if found.id != Code::DEVICE_LIMIT {
            return found;
        }
        if !is_default && found.severity == Severity::Error {
            found.severity = Severity::Warning;
        }
        match self.name.as_str() {
            "core" => found.hint("checked for `core`: what every browser with WebGPU has"),
            "native" => found.hint("checked for `native`: what desktops have through Vulkan, Metal and DX12"),
            name => found.hint(format!("checked for {name}")),
        }
    }

    /// Its limits by name, as files have them.
    pub fn limits_by_name(limits: &Limits) -> impl Iterator<Item = (&'static str, u64)> {
        LIMITS.iter().map(|name| (*name, limit(limits, name)))
    }
}

/// Where desktops go beyond the defaults, rounded down to what the weakest of them has.
const NATIVE: &[(&str, u64)] = &[
    ("max_texture_dimension_2d", 16_384),
    ("max_texture_array_layers", 2048),
    ("max_buffer_size", 1 << 31),
    ("max_storage_buffer_binding_size", 1 << 30),
    ("max_storage_buffers_per_shader_stage", 16),
    ("max_storage_textures_per_shader_stage", 8),
    ("max_sampled_textures_per_shader_stage", 48),
    ("max_color_attachment_bytes_per_sample", 64),
    ("max_compute_invocations_per_workgroup", 1024),
    ("max_compute_workgroup_size_x", 1024),
    ("max_compute_workgroup_size_y", 1024),
    ("max_compute_workgroup_storage_size", 32_768),
];

/// A feature by the name that browsers or wgpu give it.
fn feature(name: &Json) -> Result<Features, (String, String)> {
    let Some(name) = name.as_str() else { return Err((format!("the feature {name} is no name"), String::new())) };
    let plain = name.replace('-', "_");
    match Features::all().iter_names().find(|(known, _)| known.eq_ignore_ascii_case(&plain)) {
        Some((_, flag)) => Ok(flag),
        None => Err((format!("there is no feature `{name}`"), plain)),
    }
}

fn nearest_feature(diagnostic: Diagnostic, name: &str) -> Diagnostic {
    let known: Vec<String> = Features::all().iter_names().map(|(known, _)| known.to_ascii_lowercase()).collect();
    diagnostic.nearest(name, known.iter().map(String::as_str))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_native_device_has_all_that_a_core_one_has() {
        let (core, native) = (Device::core(), Device::native());
        for name in LIMITS {
            assert!(limit(&native.limits, name) >= limit(&core.limits, name), "{name}");
            assert!(limit(&Device::anything().limits, name) >= limit(&native.limits, name), "{name}");
        }
    }

    #[test]
    fn files_say_what_a_device_has() {
        let text = r#"{"adapters": [{"name": "Card", "features": ["float32-blendable", "SHADER_F16"],
                       "limits": {"max_buffer_size": 5}}]}"#;
        let device = Device::from_json("a.json", text).expect("a device");
        assert_eq!(device.name, "Card");
        assert_eq!(device.features, Features::FLOAT32_BLENDABLE | Features::SHADER_F16);
        assert_eq!(device.limits.max_buffer_size, 5);
        assert_eq!(device.limits.max_bind_groups, Limits::default().max_bind_groups);
        let said = |text: &str| Device::from_json("a.json", text).expect_err("no device").message;
        assert!(said("{").starts_with("`a.json` describes no device: EOF"));
        assert!(said("{}").contains("neither `features` nor `limits`"));
        assert!(said(r#"{"adapters": []}"#).contains("lists no adapter"));
        assert!(said(r#"{"features": ["wings"]}"#).contains("there is no feature `wings`"));
        assert!(said(r#"{"limits": {"max_bufer_size": 5}}"#).contains("there is no limit `max_bufer_size`"));
        assert!(said(r#"{"limits": {"max_buffer_size": -5}}"#).contains("no whole number"));
    }
}
