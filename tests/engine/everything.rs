//! All files of other people that lie beside the repository are rendered: particles as the command line takes them,
//! meshes and environments in a scene that names them. Where the folder is absent, the test says so and checks nothing.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::Engine;
use meniscus::files::{DiskFiles, Files};
use meniscus::host::{Cache, Job, Moment, Session, load};
use meniscus::scene::particles;

/// What belongs to other files, or is for people.
const BESIDE: [&str; 8] = ["md", "txt", "license", "bin", "mtl", "png", "jpg", "json"];
const MESHES: [&str; 3] = ["gltf", "glb", "obj"];
const SCENE: &str = "walked.ron";

/// The disk, and a scene that is not on it.
struct Beside(Arc<[u8]>);

impl Files for Beside {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        if path == Path::new(SCENE) { Ok(Arc::clone(&self.0)) } else { DiskFiles.read(path) }
    }

    fn exists(&self, path: &Path) -> bool {
        path == Path::new(SCENE) || DiskFiles.exists(path)
    }
}

fn gather(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { gather(&path, all) } else { all.push(path) }
    }
}

fn extension(path: &Path) -> String {
    let name = path.file_name().unwrap().to_string_lossy().to_ascii_lowercase();
    name.rsplit('.').next().unwrap_or_default().to_owned()
}

/// Renders a particle file or a scene; gives how many pixels something covers.
fn covered(session: &mut Session, cache: &mut Cache, source: &Path, files: &dyn Files) -> usize {
    let job = Job { source: source.to_owned(), size: Some([96, 72]), ..Job::default() };
    let mut sources = Sources::new();
    let loaded = load(files, &mut sources, &job, cache);
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let content = loaded.content.unwrap_or_else(|| panic!("{}: {said}", source.display()));
    session
        .build(content)
        .unwrap_or_else(|d| panic!("{}: {}", source.display(), render_all(&d, &sources, Style::Plain)));
    session.draw(Moment::default(), true).unwrap_or_else(|d| panic!("{}: {d:#?}", source.display()));
    let light = session.light().unwrap();
    assert!(light.rgba.iter().flatten().all(|x| x.is_finite()), "{}", source.display());
    light.rgba.iter().filter(|texel| texel[3] > 0.0).count()
}

fn scene(meshes: Option<&Path>, environment: Option<&Path>, repository: &Path) -> Beside {
    let mesh = meshes.map_or_else(|| repository.join("scenes/assets/block.obj"), Path::to_owned);
    let sky = environment.map_or_else(String::new, |path| format!("environment: {path:?},"));
    let sun = "lights: {\"sun\": Light(direction: (-0.4, -0.8, -0.4), intensity: 3.0)}";
    let text = format!(
        "Scene(graph: \"imai2016.ron\", {sun}, {sky} meshes: {{\"meshes\": [{mesh:?}]}}, params: {{\"dry.floor\": false}})"
    );
    Beside(text.into_bytes().into())
}

pub fn files_beside_the_repository_render(engine: &mut Engine) {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = repository.join("../shared/data");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return;
    }
    let mut all = Vec::new();
    gather(&folder.canonicalize().unwrap(), &mut all);
    all.sort();
    let (mut session, mut cache) = (Session::new(engine.gpu().clone()), Cache::default());
    let (mut sets, mut meshes, mut skies) = (0, 0, 0);
    for path in &all {
        let end = extension(path);
        if particles::known_extension(path) && end != "json" {
            // A surface is particles too: its corners.
            assert!(covered(&mut session, &mut cache, path, &DiskFiles) > 20, "{}", path.display());
            sets += 1;
        } else if MESHES.contains(&end.as_str()) {
            let files = scene(Some(path), None, repository);
            assert!(covered(&mut session, &mut cache, Path::new(SCENE), &files) > 300, "{}", path.display());
            meshes += 1;
        } else if end == "hdr" {
            let files = scene(None, Some(path), repository);
            assert!(covered(&mut session, &mut cache, Path::new(SCENE), &files) > 300, "{}", path.display());
            skies += 1;
        } else {
            assert!(BESIDE.contains(&end.as_str()), "{} is of no kind that is rendered", path.display());
        }
    }
    println!("rendered {sets} particle files, {meshes} meshes and {skies} environments of {} files", all.len());
    assert!(sets >= 20 && meshes >= 13 && skies >= 1, "{sets} {meshes} {skies}");
}
