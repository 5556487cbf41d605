//! What a file holds: particles with their attributes, a mesh with its materials, a picture, a scene, a graph.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::{Value as Json, json};

use super::ron;
use crate::cli::args::{CheckFormat, InfoArgs};
use crate::cli::report::{Exit, print, report};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::files::{DiskFiles, Files as _};
use crate::host::{named, numbered_files};
use crate::scene::meshes::{self, Material, Model};
use crate::scene::particles::{self, ParticleSet};
use crate::scene::{image, sequence::Pattern};

/// What a file holds, for people and for programs.
pub(super) struct Told {
    pub text: String,
    pub json: Json,
}

/// A number with as many digits as its type has.
fn shown(number: f64, kind: &str) -> String {
    if kind == "f32" { (number as f32).to_string() } else { number.to_string() }
}

/// What a row of numbers is written as, with as many digits as tell.
fn numbers(row: [f32; 3]) -> String {
    row.map(|x| format!("{x:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()).join(" ")
}

pub(super) fn run(args: &InfoArgs) -> Exit {
    let (mut texts, mut all) = (Vec::new(), Vec::new());
    let (mut sources, mut found) = (Sources::new(), Diagnostics::new());
    for path in &args.files {
        if let Some(Told { text, json }) = tell(path, &mut sources, &mut found) {
            texts.push(text);
            all.push(json);
        }
    }
    let text = match args.format {
        CheckFormat::Text => texts.join("\n"),
        CheckFormat::Json => format!("{:#}\n", Json::Array(all)),
    };
    let exit = report(&found, &sources);
    match print(&text) {
        Exit::Done => exit,
        failed => failed,
    }
}

fn tell(path: &Path, sources: &mut Sources, found: &mut Diagnostics) -> Option<Told> {
    if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("ron")) {
        return ron::tell(path, sources, found);
    }
    let is_known = particles::known_extension(path) || meshes::known_extension(path) || is_picture(path);
    if !is_known {
        let message = format!("`{}` is no scene, graph, particle file, mesh or picture", path.display());
        let ends: Vec<String> = particles::extensions().collect();
        let hint = format!("known are .ron, .gltf, .glb, .obj, .{}, {}", PICTURES.join(", ."), ends.join(", "));
        found.push(Diagnostic::error(Code::USAGE, message).hint(hint));
        return None;
    }
    let (first, mut told) = match numbered(path, found)? {
        Some((first, told)) => (first, told),
        None => (path.to_owned(), Told { text: String::new(), json: json!({}) }),
    };
    let bytes = named(&DiskFiles, &first).map_err(|error| found.push(error)).ok()?;
    let shown = first.display();
    let mut tells = |kind: &str, more: Told| {
        _ = write!(told.text, "{shown}: {kind}\n{}", more.text);
        told.json["file"] = json!(first.display().to_string());
        told.json[kind] = more.json;
    };
    if is_picture(path) {
        tells("picture", of_picture(path, &bytes, found)?);
        return Some(told);
    }
    let model = meshes::known_extension(path).then(|| meshes::read(&meshes::gather(&DiskFiles, &first, bytes.clone())));
    let is_particles = particles::known_extension(path);
    if is_particles {
        let set = particles::read(&first, &bytes).map_err(|error| {
            let failed = Diagnostic::error(Code::ASSET, format!("`{shown}`: {error}"));
            found.push(error.hint.iter().fold(failed, Diagnostic::hint));
        });
        tells("particles", of_particles(&set.ok()?));
    }
    match model {
        // What holds points only is no mesh, and nothing is wrong with it.
        Some(Ok(model)) if !is_particles || model.triangle_count() > 0 => {
            found.extend(model.diagnostics.clone());
            tells("mesh", of_model(&model));
        }
        Some(Err(wrong)) if !is_particles => {
            found.extend(wrong);
            return None;
        }
        _ => {}
    }
    Some(told)
}

/// The first file of a sequence, and what there is to tell of all.
fn numbered(path: &Path, found: &mut Diagnostics) -> Option<Option<(PathBuf, Told)>> {
    let Some(pattern) = Pattern::of(path).filter(|_| !DiskFiles.exists(path)) else { return Some(None) };
    let there: BTreeSet<u64> = numbered_files(&DiskFiles, &pattern);
    let (Some(first), Some(last)) = (there.first().copied(), there.last().copied()) else {
        let message = format!("no file is named `{}` with a number in place of the `#`", path.display());
        found.push(Diagnostic::error(Code::FILE_MISSING, message));
        return None;
    };
    let missing: Vec<u64> = (first..=last).filter(|frame| !there.contains(frame)).take(20).collect();
    let mut text = format!("{}: {} files, frames {first} to {last}\n", path.display(), there.len());
    if !missing.is_empty() {
        let all: Vec<String> = missing.iter().map(u64::to_string).collect();
        let more = if missing.len() == 20 { " and perhaps more" } else { "" };
        _ = writeln!(text, "  missing: {}{more}", all.join(", "));
    }
    let json = json!({"sequence": {"files": there.len(), "first": first, "last": last, "missing": missing}});
    Some(Some((pattern.path(first), Told { text, json })))
}

fn of_particles(set: &ParticleSet) -> Told {
    let mut text = String::new();
    _ = writeln!(text, "  count: {}", set.count);
    let estimated = if set.radius.is_none() { particles::estimate_radius(&set.positions()) } else { None };
    _ = match (set.radius, estimated) {
        (Some(radius), _) => writeln!(text, "  radius: {radius} m, from the file"),
        (None, Some(radius)) => writeln!(text, "  radius: about {radius:.4} m, estimated from the spacing"),
        (None, None) => writeln!(text, "  radius: not known"),
    };
    _ = writeln!(text, "  box: {} to {} m, if a unit is a metre and y is up", numbers(set.min), numbers(set.max));
    text.push_str("  attributes:\n");
    let width = set.attributes.iter().map(|a| a.name.chars().count()).max().unwrap_or(0);
    let mut attributes = Vec::new();
    for attribute in &set.attributes {
        let (kind, components) = (attribute.values.kind().name(), attribute.components);
        let values = attribute.values.to_f64();
        let finite = || values.iter().copied().filter(|x| x.is_finite());
        let (low, high) = (finite().reduce(f64::min), finite().reduce(f64::max));
        let range = match (low, high) {
            (Some(low), Some(high)) if low == high => format!("all {}", shown(low, kind)),
            (Some(low), Some(high)) => format!("{} to {}", shown(low, kind), shown(high, kind)),
            _ => String::new(),
        };
        _ = writeln!(text, "    {:width$}  {components} x {kind:3}  {range}", attribute.name);
        attributes.push(json!({
            "name": attribute.name, "components": components, "type": kind, "least": low, "greatest": high,
        }));
    }
    set.notes.iter().for_each(|note| _ = writeln!(text, "  note: {note}"));
    let json = json!({
        "count": set.count, "dropped": set.dropped, "radius": set.radius, "estimated_radius": estimated,
        "min": set.min, "max": set.max, "attributes": attributes, "notes": set.notes,
    });
    Told { text, json }
}

fn of_model(model: &Model) -> Told {
    let primitives = || model.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let vertices: usize = primitives().map(|p| p.positions.len()).sum();
    let first = if model.animations.is_empty() { None } else { Some(0) };
    let bounds = model.bounds(&model.pose(first, 0.0));
    let nodes = model.nodes.len();
    let placed = if nodes == 1 { "one node".to_owned() } else { format!("{nodes} nodes") };
    let mut text = format!("  triangles: {}, with {vertices} vertices, in {placed}\n", model.triangle_count());
    if let Some(bounds) = bounds {
        let [min, max] = [bounds.min, bounds.max].map(|corner| numbers(corner.to_array()));
        _ = writeln!(text, "  box: {min} to {max} m, if a unit is a metre and y is up");
    }
    let materials: Vec<Json> = model.materials.iter().map(|material| of_material(model, material, &mut text)).collect();
    for animation in &model.animations {
        _ = writeln!(text, "  animation: `{}`, {} s", animation.name, animation.duration_s);
    }
    let seen = |node: &meshes::Node| Some((node.name.clone(), model.cameras.get(node.camera?)?.name.clone()));
    let seen = model.nodes.iter().filter_map(seen).map(|(node, lens)| if node.is_empty() { lens } else { node });
    seen.for_each(|name| _ = writeln!(text, "  camera: `{name}`"));
    if !model.lights.is_empty() {
        _ = writeln!(text, "  lights: {}", model.lights.len());
    }
    let animations = model.animations.iter().map(|a| json!({"name": a.name, "seconds": a.duration_s}));
    let json = json!({
        "triangles": model.triangle_count(), "vertices": vertices, "nodes": nodes,
        "min": bounds.map(|b| b.min.to_array()), "max": bounds.map(|b| b.max.to_array()),
        "materials": materials, "animations": animations.collect::<Vec<Json>>(),
        "cameras": model.cameras.len(), "lights": model.lights.len(),
    });
    Told { text, json }
}

fn of_material(model: &Model, material: &Material, text: &mut String) -> Json {
    let textures = [
        ("base colour", material.base_color_texture),
        ("metallic and roughness", material.metallic_roughness_texture),
        ("normal", material.normal_texture),
        ("occlusion", material.occlusion_texture),
        ("emissive", material.emissive_texture),
    ];
    let used: Vec<(String, [u32; 2])> = textures
        .iter()
        .filter_map(|(name, texture)| {
            let image = model.images.get((*texture)?.image)?;
            Some(((*name).to_owned(), [image.width, image.height]))
        })
        .collect();
    let shown: Vec<String> = used.iter().map(|(name, [width, height])| format!("{name} {width} x {height}")).collect();
    let name = if material.name.is_empty() { "without a name".to_owned() } else { format!("`{}`", material.name) };
    let pictures = if shown.is_empty() { "no pictures".to_owned() } else { shown.join(", ") };
    _ = writeln!(text, "  material: {name}, {pictures}");
    let pictures = used.iter().map(|(name, size)| json!({"for": name, "size": size}));
    json!({"name": material.name, "pictures": pictures.collect::<Vec<Json>>()})
}

/// Ends of the names of pictures.
const PICTURES: &[&str] = &["png", "jpg", "jpeg", "hdr", "exr"];

fn is_picture(path: &Path) -> bool {
    path.extension().is_some_and(|end| PICTURES.iter().any(|known| end.eq_ignore_ascii_case(known)))
}

fn of_picture(path: &Path, bytes: &[u8], found: &mut Diagnostics) -> Option<Told> {
    let image = image::read(bytes).map_err(|error| {
        let failed = Diagnostic::error(Code::ASSET, format!("`{}`: {}", path.display(), error.message));
        found.push(error.hint.iter().fold(failed, Diagnostic::hint));
    });
    let image = image.ok()?;
    let (width, height) = (image.width, image.height);
    let brightest = image.texels.iter().flat_map(|[r, g, b, _]| [r, g, b]).map(|x| x.to_f32()).fold(0.0, f32::max);
    let mut text = format!("  size: {width} x {height}\n  brightest: {brightest:.3}, as linear light\n");
    if width == 2 * height {
        text.push_str("  2 to 1: fits as `environment:`\n");
    }
    if image.clipped > 0 {
        _ = writeln!(text, "  note: {} texels are brighter than 65504 and are clipped", image.clipped);
    }
    let json = json!({"width": width, "height": height, "brightest": brightest, "clipped": image.clipped});
    Some(Told { text, json })
}
