//! The shaders of this repository, without a device.

use std::fs;
use std::path::{Path, PathBuf};

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::files::DiskFiles;
use meniscus::shader::load;

fn shaders(folder: &Path, into: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).map(|entries| entries.flatten().map(|e| e.path()).collect()).unwrap_or_default();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            shaders(&path, into);
        } else if path.extension().is_some_and(|end| end == "wgsl") {
            into.push(path);
        }
    }
}

fn all() -> Vec<PathBuf> {
    let mut out = Vec::new();
    shaders(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), &mut out);
    assert!(!out.is_empty(), "no shaders found");
    out
}

#[test]
fn every_shader_is_valid() {
    let mut shown = String::new();
    for path in all() {
        let mut sources = Sources::new();
        let loaded = load(&DiskFiles, &mut sources, path.to_str().unwrap(), None);
        shown += &render_all(&loaded.diagnostics, &sources, Style::Plain);
        assert_eq!(loaded.module.is_none(), loaded.diagnostics.has_errors(), "{}", path.display());
    }
    assert!(shown.is_empty(), "{shown}");
}

/// naga's own analysis agrees on which globals are used, and on reads and writes where no texture
/// is passed as an argument.
#[test]
fn uses_agree_with_naga() {
    use naga::valid::GlobalUse;
    for path in all() {
        let Some(module) = load(&DiskFiles, &mut Sources::new(), path.to_str().unwrap(), None).module else { continue };
        for entry in &module.entries {
            let index = module.naga.entry_points.iter().position(|p| p.name == entry.name).unwrap();
            let info = module.info.get_entry_point(index);
            for (handle, variable) in module.naga.global_variables.iter().filter(|(_, v)| v.binding.is_some()) {
                let binding = variable.binding.unwrap().binding;
                let ours = entry.uses.iter().find(|u| u.global == binding as usize);
                let place = format!("{}: {} in {}", path.display(), module.globals[binding as usize].name, entry.name);
                assert_eq!(ours.is_some(), !info[handle].is_empty(), "{place}");
                let is_buffer = !matches!(variable.space, naga::AddressSpace::Handle);
                if let Some(ours) = ours.filter(|_| is_buffer) {
                    assert_eq!(ours.read, info[handle].contains(GlobalUse::READ), "{place} is read");
                    assert_eq!(ours.write, info[handle].contains(GlobalUse::WRITE), "{place} is written");
                }
            }
        }
    }
}
