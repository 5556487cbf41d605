//! Lists the graphs, scenes and shaders of the repository as the library that the program carries.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or(io::ErrorKind::NotFound)?);
    let mut names = Vec::new();
    for folder in ["graphs", "scenes", "shaders"] {
        println!("cargo::rerun-if-changed={folder}");
        collect(&root.join(folder), folder, &mut names)?;
    }
    names.sort();
    let mut text = String::from("static LIBRARY_FILES: &[(&str, &[u8])] = &[\n");
    for name in &names {
        let full = root.join(name);
        _ = writeln!(text, "    ({name:?}, include_bytes!({:?})),", full.display().to_string());
    }
    text.push_str("];\n");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?);
    fs::write(out.join("library.rs"), text)
}

fn collect(folder: &Path, name: &str, names: &mut Vec<String>) -> io::Result<()> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    for entry in entries {
        let entry = entry?;
        let Some(file) = entry.file_name().to_str().map(str::to_owned) else { continue };
        let path = format!("{name}/{file}");
        if entry.file_type()?.is_dir() {
            collect(&entry.path(), &path, names)?;
        } else if [".ron", ".wgsl"].iter().any(|end| file.ends_with(end)) {
            names.push(path);
        }
    }
    Ok(())
}
