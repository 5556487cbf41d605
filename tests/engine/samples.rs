//! Models of other people that lie beside the repository, drawn by the shipped dry scene under an even white sky: there
//! everything looks as its base colour says, so that each pixel can be foretold by a ray through the same triangles and
//! the same picture file. Where the folder is absent, the test says so and checks nothing.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec3, Mat4, Vec3};
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::Engine;
use meniscus::files::{DiskFiles, Files, MemoryFiles};
use meniscus::host::{Cache, Job, Moment, Session, load};
use meniscus::scene::meshes::{self, Model};

pub const SIZE: [u32; 2] = [200, 150];
pub const FOV_DEGREES: f64 = 40.0;

/// What a test brings, and the disk behind it.
struct Beside(MemoryFiles);

impl Files for Beside {
    fn read(&self, path: &Path) -> std::io::Result<Arc<[u8]>> {
        if self.0.exists(path) { self.0.read(path) } else { DiskFiles.read(path) }
    }

    fn exists(&self, path: &Path) -> bool {
        self.0.exists(path) || DiskFiles.exists(path)
    }
}

/// From where to where a camera looks.
#[derive(Clone, Copy)]
pub struct View {
    pub eye: DVec3,
    pub target: DVec3,
}

impl View {
    /// The direction through a place of the picture, in pixels from its upper left.
    fn ray(&self, x: f64, y: f64) -> DVec3 {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let [width, height] = SIZE.map(f64::from);
        let tangent = (FOV_DEGREES.to_radians() / 2.0).tan();
        let (across, above) = ((2.0 * x / width - 1.0) * width / height, 1.0 - 2.0 * y / height);
        (forward + tangent * (across * right + above * up)).normalize()
    }
}

/// A triangle in the world with what its corners bear.
struct Triangle {
    corners: [DVec3; 3],
    uv: [[f32; 2]; 3],
    color: [f32; 3],
    image: Option<usize>,
}

fn triangles(model: &Model, animation: Option<usize>, time_s: f64) -> Vec<Triangle> {
    let world = model.pose(animation, time_s);
    let mut all = Vec::new();
    for (node, world) in model.nodes.iter().zip(&world) {
        for primitive in node.mesh.iter().flat_map(|mesh| &model.meshes[*mesh].primitives) {
            let material = &model.materials[primitive.material];
            let [r, g, b, _] = material.base_color_factor;
            for corners in primitive.indices.as_chunks::<3>().0 {
                let at = |index: u32| Mat4::transform_point3(world, Vec3::from(primitive.positions[index as usize]));
                all.push(Triangle {
                    corners: corners.map(|index| at(index).as_dvec3()),
                    uv: corners.map(|index| primitive.uv0[index as usize]),
                    color: [r, g, b],
                    image: material.base_color_texture.map(|texture| texture.image),
                });
            }
        }
    }
    all
}

/// How far a triangle is along a ray, and where in it the ray meets it (Möller and Trumbore).
fn meet(triangle: &Triangle, from: DVec3, ray: DVec3) -> Option<(f64, [f64; 3])> {
    let [a, b, c] = triangle.corners;
    let (ab, ac) = (b - a, c - a);
    let p = ray.cross(ac);
    let determinant = ab.dot(p);
    if determinant.abs() < 1e-12 {
        return None;
    }
    let v = (from - a).dot(p) / determinant;
    let q = (from - a).cross(ab);
    let (w, t) = (ray.dot(q) / determinant, ac.dot(q) / determinant);
    (v >= 0.0 && w >= 0.0 && v + w <= 1.0 && t > 0.0).then_some((t, [1.0 - v - w, v, w]))
}

/// What a ray meets: its linear base colour, and the most of a white sky that it may mirror where it is no metal.
struct Met {
    color: [f64; 3],
    mirrored: f64,
}

/// What a ray meets; none where it meets nothing.
fn foretold(model: &Model, all: &[Triangle], view: &View, [x, y]: [f64; 2], is_flipped: bool) -> Option<Met> {
    let ray = view.ray(x, y);
    let hits = all.iter().filter_map(|triangle| Some((triangle, meet(triangle, view.eye, ray)?)));
    let (triangle, (_, weights)) = hits.min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    let texel = triangle.image.map_or([1.0; 3], |image| {
        let image = &model.images[image];
        let [u, v] = [0, 1].map(|axis| (0..3).map(|k| weights[k] * f64::from(triangle.uv[k][axis])).sum::<f64>());
        let v = if is_flipped { 1.0 - v } else { v };
        let place = |x: f64, size: u32| ((x.rem_euclid(1.0) * f64::from(size)) as u32).min(size - 1);
        let index = place(v, image.height) * image.width + place(u, image.width);
        let [r, g, b, _] = image.texels[index as usize];
        [r, g, b].map(|x| {
            let x = f64::from(x) / 255.0;
            if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
        })
    });
    let [a, b, c] = triangle.corners;
    // Schlick's law, and a little more aslant: the shaded normal is not quite the triangle's.
    let cosine = ((b - a).cross(c - a).normalize_or_zero().dot(ray).abs() - 0.1).max(0.0);
    let mirrored = 0.04 + 0.96 * (1.0 - cosine).powi(5);
    Some(Met { color: [0, 1, 2].map(|k| f64::from(triangle.color[k]) * texel[k]), mirrored })
}

/// Pixels that were compared, and those that look otherwise.
#[derive(Debug, Default)]
struct Compared {
    covered: usize,
    empty: usize,
    wrong: usize,
}

/// Compares the pixels that lie wholly inside of something even, or wholly beside it.
fn compared(
    picture: &[[f32; 4]],
    model: &Model,
    view: &View,
    animation: (Option<usize>, f64),
    is_flipped: bool,
) -> Compared {
    let all = triangles(model, animation.0, animation.1);
    let mut found = Compared::default();
    for (row, column) in
        (0..SIZE[1]).step_by(4).flat_map(|row| (0..SIZE[0]).step_by(4).map(move |column| (row, column)))
    {
        let offsets = [[0.5, 0.5], [-0.7, -0.7], [1.7, -0.7], [-0.7, 1.7], [1.7, 1.7]];
        let rays =
            offsets.map(|[x, y]| foretold(model, &all, view, [f64::from(column) + x, f64::from(row) + y], is_flipped));
        let pixel = picture[(row * SIZE[0] + column) as usize];
        if rays.iter().all(Option::is_none) {
            found.empty += 1;
            found.wrong += usize::from(pixel[3] > 0.0);
            continue;
        }
        let Some(met) = rays.into_iter().collect::<Option<Vec<_>>>() else { continue };
        let is_even = |k: usize| met.iter().all(|m| (m.color[k] - met[0].color[k]).abs() < 0.02);
        if !(0..3).all(is_even) {
            continue;
        }
        found.covered += 1;
        let most = 0.03 + met.iter().map(|m| m.mirrored).fold(0.0, f64::max);
        let is_like = (0..3).all(|k| (-0.03..most).contains(&(f64::from(pixel[k]) - met[0].color[k])));
        found.wrong += usize::from(!is_like || pixel[3] < 0.999);
    }
    found
}

fn model_of(path: &Path) -> Model {
    meshes::read(&meshes::gather(&DiskFiles, path, DiskFiles.read(path).unwrap())).unwrap()
}

/// A PNG of one row after the other.
pub fn png(width: u32, texels: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let height = texels.len() as u32 / width;
    let picture = image::RgbImage::from_raw(width, height, texels.as_flattened().to_vec()).unwrap();
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn drawn(engine: &mut Engine, path: &Path, view: &View, time_s: f64) -> Vec<[f32; 4]> {
    lit(engine, "imai2016.ron", MemoryFiles::default(), path, view, &Lights { sky: 255, sun: None }, time_s)
}

/// The light of an even sky, and where a sun of intensity 1 stands.
pub struct Lights {
    pub sky: u8,
    pub sun: Option<DVec3>,
}

/// The light that a camera sees of a mesh file.
pub fn lit(
    engine: &mut Engine,
    graph: &str,
    files: MemoryFiles,
    path: &Path,
    view: &View,
    lights: &Lights,
    time_s: f64,
) -> Vec<[f32; 4]> {
    let triple = |v: DVec3| format!("({:?}, {:?}, {:?})", v.x, v.y, v.z);
    let floor = if graph.starts_with("imai") { "\"dry.floor\": false, " } else { "" };
    let scene = format!(
        "Scene(graph: {graph:?}, camera: Camera(eye: {}, target: {}, fov: {FOV_DEGREES:?}), size: ({}, {}),
            lights: {{\"sun\": Light(direction: {}, intensity: {:?})}}, environment: \"even.png\",
            meshes: {{\"meshes\": [{path:?}]}}, params: {{{floor}\"antialias\": false}})",
        triple(view.eye),
        triple(view.target),
        SIZE[0],
        SIZE[1],
        triple(-lights.sun.unwrap_or(DVec3::Y)),
        if lights.sun.is_some() { 1.0 } else { 0.0 },
    );
    let files = Beside(files.with("sample.ron", scene).with("even.png", png(8, &[[lights.sky; 3]; 32])));
    let (mut sources, mut cache) = (Sources::new(), Cache::default());
    let job = Job { source: PathBuf::from("sample.ron"), ..Job::default() };
    let loaded = load(&files, &mut sources, &job, &mut cache);
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let mut session = Session::new(engine.gpu().clone());
    session.build(loaded.content.unwrap_or_else(|| panic!("{said}"))).unwrap();
    session.draw(Moment::at_time(time_s), true).unwrap();
    session.light().unwrap().rgba
}

/// A view of a model from a direction, as far away as its size asks for.
fn view_of(model: &Model, animation: Option<usize>, from: DVec3) -> View {
    // Over all of an animation, so that each time has the same view.
    let boxes = (0..8).filter_map(|k| model.bounds(&model.pose(animation, f64::from(k) * 0.5)));
    let (min, max) = boxes.fold((Vec3::MAX, Vec3::MIN), |(min, max), b| (min.min(b.min), max.max(b.max)));
    let (middle, size) = ((min + max).as_dvec3() / 2.0, f64::from((max - min).length()));
    View { eye: middle + from.normalize() * size * 1.5, target: middle }
}

fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/assets/gltf");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
    }
    folder.canonicalize().ok()
}

pub fn samples_look_as_their_files_say(engine: &mut Engine) {
    let Some(folder) = folder() else { return };
    for (name, least) in [("BoxTextured", 0.1), ("Duck", 0.1), ("Suzanne", 0.005)] {
        let path = folder.join(name).join("glTF").join(name).with_extension("gltf");
        let model = model_of(&path);
        let mut upside_down = Compared::default();
        for from in [DVec3::new(1.0, 0.7, 1.6), DVec3::new(-1.2, 0.3, -1.0)] {
            let view = view_of(&model, None, from);
            let picture = drawn(engine, &path, &view, 0.0);
            let found = compared(&picture, &model, &view, (None, 0.0), false);
            assert!(found.covered > 60 && found.empty > 150, "{name} from {from}: {found:?}");
            assert!(found.wrong * 100 <= found.covered, "{name} from {from}: {found:?}");
            let turned = compared(&picture, &model, &view, (None, 0.0), true);
            upside_down.covered += turned.covered;
            upside_down.wrong += turned.wrong;
        }
        // The same with pictures upside down must not do. (What is of one colour looks like itself.)
        let wrong = upside_down.wrong as f64 / upside_down.covered as f64;
        assert!(wrong > least, "{name}, upside down: {upside_down:?}");
    }
}

pub fn the_animated_sample_moves_as_its_file_says(engine: &mut Engine) {
    let Some(folder) = folder() else { return };
    let path = folder.join("BoxAnimated/glTF-Binary/BoxAnimated.glb");
    let model = model_of(&path);
    let view = view_of(&model, Some(0), DVec3::new(1.0, 0.6, 1.4));
    let times = [0.25, 1.2, 2.6];
    for time_s in times {
        let picture = drawn(engine, &path, &view, time_s);
        let found = compared(&picture, &model, &view, (Some(0), time_s), false);
        assert!(found.covered > 40 && found.empty > 150, "at {time_s} s: {found:?}");
        assert!(found.wrong * 50 <= found.covered, "at {time_s} s: {found:?}");
        // What it is at other times must not do.
        for other in times.into_iter().filter(|other| *other != time_s) {
            let found = compared(&picture, &model, &view, (Some(0), other), false);
            assert!(found.wrong * 20 > found.covered, "at {time_s} s, as at {other} s: {found:?}");
        }
    }
}
