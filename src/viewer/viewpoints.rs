//! Viewpoints that a person keeps, by scene, in the folder for the state of programs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::{Value as Json, json};

use crate::output::Output;
use crate::scene::Camera;

/// Viewpoints by number.
pub type Viewpoints = BTreeMap<u8, Camera>;

/// Those of a scene; none if there are none or they cannot be read.
pub fn load(scene: &Path) -> Viewpoints {
    let Some(file) = file() else { return Viewpoints::new() };
    let entry = read(&file).get(&key(scene)).cloned().unwrap_or_default();
    let slots = entry.as_object().into_iter().flatten();
    slots.filter_map(|(slot, camera)| Some((slot.parse().ok()?, decode(camera)?))).collect()
}

/// Keeps those of a scene, beside those of others.
///
/// # Errors
/// If there is no such folder, or it cannot be written; the text says so.
pub fn save(scene: &Path, viewpoints: &Viewpoints) -> Result<(), String> {
    let file = file().ok_or("there is no home folder")?;
    let mut all = read(&file);
    let slots = viewpoints.iter().map(|(slot, camera)| (slot.to_string(), encode(camera)));
    all.insert(key(scene), Json::Object(slots.collect()));
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
    }
    let output = Output::reserve(&file).map_err(|error| error.message)?;
    output.write(Json::Object(all).to_string().as_bytes()).map_err(|error| error.message)
}

fn file() -> Option<PathBuf> {
    let named = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let state = named("XDG_STATE_HOME").or_else(|| Some(named("HOME")?.join(".local/state")));
    let folder = state.or_else(|| named("LOCALAPPDATA"))?;
    Some(folder.join("meniscus/viewpoints.json"))
}

fn read(file: &Path) -> serde_json::Map<String, Json> {
    let text = std::fs::read(file).unwrap_or_default();
    match serde_json::from_slice(&text) {
        Ok(Json::Object(all)) => all,
        _ => serde_json::Map::new(),
    }
}

fn key(scene: &Path) -> String {
    std::fs::canonicalize(scene).unwrap_or_else(|_| scene.to_owned()).display().to_string()
}

fn encode(camera: &Camera) -> Json {
    json!({
        "eye": camera.eye.to_array(), "target": camera.target.to_array(), "up": camera.up.to_array(),
        "fov": camera.fov_degrees, "near": camera.near_m,
    })
}

fn decode(entry: &Json) -> Option<Camera> {
    let triple = |name: &str| {
        let numbers: Vec<f64> = entry.get(name)?.as_array()?.iter().filter_map(Json::as_f64).collect();
        <[f64; 3]>::try_from(numbers).ok().map(DVec3::from_array)
    };
    let fov_degrees = entry.get("fov")?.as_f64()?;
    let near_m = entry.get("near").and_then(Json::as_f64);
    let camera = Camera { eye: triple("eye")?, target: triple("target")?, up: triple("up")?, fov_degrees, near_m };
    camera.fault().is_none().then_some(camera)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_comes_back_as_it_was_and_nonsense_does_not() {
        let camera = Camera { near_m: Some(0.1), ..Camera::new(DVec3::new(1.5, -2.0, 3.25), DVec3::ZERO, 35.0) };
        assert_eq!(decode(&encode(&camera)), Some(camera));
        assert_eq!(decode(&json!({"eye": [0, 0], "fov": 1})), None);
        assert_eq!(decode(&json!({"eye": [0, 0, 0], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40})), None);
    }
}
