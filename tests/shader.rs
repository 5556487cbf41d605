//! WGSL modules: what is told of wrong ones, and what is reflected of good ones.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

#[path = "support/golden.rs"]
mod golden;

mod shader {
    mod errors;
    mod imports;
    mod reflection;
    mod repository;
    mod robust;

    use meniscus::diagnostic::{Sources, Style, render_all};
    use meniscus::files::MemoryFiles;
    use meniscus::shader::reflect::{Entry, Module};
    use meniscus::shader::{Loaded, load};

    /// Loads `main.wgsl` from memory.
    fn load_text(text: &str) -> (Loaded, Sources) {
        load_files(MemoryFiles::default().with("main.wgsl", text))
    }

    fn load_files(files: MemoryFiles) -> (Loaded, Sources) {
        let mut sources = Sources::new();
        let loaded = load(&files, &mut sources, "main.wgsl", None);
        (loaded, sources)
    }

    /// The module of a text that must be good.
    fn module(text: &str) -> Module {
        let (loaded, sources) = load_text(text);
        let shown = render_all(&loaded.diagnostics, &sources, Style::Plain);
        loaded.module.unwrap_or_else(|| panic!("{shown}"))
    }

    fn entry<'a>(module: &'a Module, name: &str) -> &'a Entry {
        module.entries.iter().find(|e| e.name == name).unwrap_or_else(|| panic!("no entry point {name}"))
    }
}
