//! What this machine offers, and what each shipped graph needs of it.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value as Json, json};
use wgpu_types::{Features, Limits};

use crate::check::{self, Device};
use crate::cli::args::{CheckFormat, InfoArgs};
use crate::cli::report::{Exit, print, report};
use crate::diagnostic::{Code, Diagnostic, Sources};
use crate::engine::{AdapterSummary, Gpu, GpuOptions};
use crate::files::{self, DiskFiles, LIBRARY};
use crate::plan::model::Needs;
use crate::{plan, program};

pub fn run(args: &InfoArgs) -> Exit {
    let adapters = match Gpu::adapters(&GpuOptions::default()) {
        Ok(adapters) => adapters,
        Err(error) => return report(&error.into(), &Sources::new()),
    };
    let graphs = graphs();
    let text = match args.format {
        CheckFormat::Text => text(&adapters, &graphs),
        CheckFormat::Json => format!("{:#}\n", as_json(&adapters, &graphs)),
    };
    match print(&text) {
        Exit::Done if adapters.is_empty() => {
            let none = Diagnostic::error(Code::DEVICE, "no usable graphics adapter");
            let hint = "a software driver is enough: `apt-get install mesa-vulkan-drivers`";
            report(&none.hint(hint).into(), &Sources::new())
        }
        exit => exit,
    }
}

/// The graphs that the program carries and that are no parts, with what each needs.
fn graphs() -> Vec<(String, Result<Needs, usize>)> {
    let names = files::library().filter_map(|path| path.strip_prefix("graphs/"));
    names.filter(|name| !name.contains('/')).map(|name| (name.to_owned(), needs(name))).collect()
}

/// What a graph needs at its defaults; how many errors it has if it cannot be planned.
fn needs(name: &str) -> Result<Needs, usize> {
    let beside = Path::new(LIBRARY).join("graphs").join(name);
    let loaded = program::load(&DiskFiles, &mut Sources::new(), name, Some(&beside));
    let program = loaded.program.ok_or(loaded.diagnostics.iter().count())?;
    let plan = plan::instantiate_stand_in(&program, &check::stand_in(&program));
    plan.map(|plan| plan.needs).map_err(|errors| errors.iter().count())
}

fn words(features: Features) -> Vec<String> {
    features.iter_names().map(|(name, _)| name.to_lowercase().replace('_', "-")).collect()
}

/// Limits that graphs run into, under the names that messages give them.
fn limits(limits: &Limits) -> Vec<(&'static str, u64)> {
    vec![
        ("largest 2D texture", limits.max_texture_dimension_2d.into()),
        ("largest 3D texture", limits.max_texture_dimension_3d.into()),
        ("texture layers", limits.max_texture_array_layers.into()),
        ("bytes of a storage binding", limits.max_storage_buffer_binding_size),
        ("bytes of a buffer", limits.max_buffer_size),
        ("storage buffers a stage", limits.max_storage_buffers_per_shader_stage.into()),
        ("storage textures a stage", limits.max_storage_textures_per_shader_stage.into()),
        ("sampled textures a stage", limits.max_sampled_textures_per_shader_stage.into()),
        ("color targets", limits.max_color_attachments.into()),
        ("threads a workgroup", limits.max_compute_invocations_per_workgroup.into()),
        ("bytes of workgroup memory", limits.max_compute_workgroup_storage_size.into()),
    ]
}

fn text(adapters: &[AdapterSummary], graphs: &[(String, Result<Needs, usize>)]) -> String {
    let mut out = String::new();
    for adapter in adapters {
        let info = &adapter.info;
        _ = writeln!(out, "{} ({}, {:?})", info.name, info.backend, info.device_type);
        _ = writeln!(out, "  driver: {} {}", info.driver, info.driver_info);
        let wanted = crate::engine::wanted_features() & adapter.features;
        let lacking = crate::engine::wanted_features() - adapter.features;
        _ = writeln!(out, "  features: {}", words(wanted).join(", "));
        if !lacking.is_empty() {
            _ = writeln!(out, "  lacks: {}", words(lacking).join(", "));
        }
        for (name, value) in limits(&adapter.limits) {
            _ = writeln!(out, "  {name}: {value}");
        }
        out.push('\n');
    }
    out.push_str("shipped graphs, and what they need beyond WebGPU's defaults\n");
    for (name, needs) in graphs {
        let needs = match needs {
            Ok(needs) => described(needs),
            Err(errors) => format!("cannot be planned: {errors} errors; see `meniscus check`"),
        };
        _ = writeln!(out, "  {name}: {needs}");
    }
    out
}

fn described(needs: &Needs) -> String {
    let limits = needs.limits.iter().map(|(name, needed, default)| format!("{name} of {needed} (default {default})"));
    let all: Vec<String> = words(needs.features).into_iter().chain(limits).collect();
    if all.is_empty() { "nothing".into() } else { all.join(", ") }
}

fn as_json(adapters: &[AdapterSummary], graphs: &[(String, Result<Needs, usize>)]) -> Json {
    let adapter = |a: &AdapterSummary| {
        // Under the names that `check --device` reads them by.
        let limits: Json =
            Device::limits_by_name(&a.limits).map(|(name, value)| (name.to_owned(), json!(value))).collect();
        json!({
            "name": a.info.name, "backend": a.info.backend.to_string(), "type": format!("{:?}", a.info.device_type),
            "driver": a.info.driver, "driver_info": a.info.driver_info,
            "features": words(a.features), "limits": limits,
        })
    };
    let graph = |(name, needs): &(String, Result<Needs, usize>)| match needs {
        Ok(needs) => {
            let limits: Vec<Json> = (needs.limits.iter())
                .map(|(name, needed, default)| json!({"name": name, "needed": needed, "default": default}))
                .collect();
            json!({"graph": name, "features": words(needs.features), "limits": limits})
        }
        Err(errors) => json!({"graph": name, "errors": errors}),
    };
    let adapters: Vec<Json> = adapters.iter().map(adapter).collect();
    json!({"adapters": adapters, "graphs": graphs.iter().map(graph).collect::<Vec<Json>>()})
}
