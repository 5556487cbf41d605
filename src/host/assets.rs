//! Particle files and pictures that a scene names, read once for as long as their bytes stay.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use twox_hash::XxHash3_128;

use super::models::Models;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::scene::cube;
use crate::scene::image::Image;
use crate::scene::particles::{self, Attribute, ParticleSet, Taken, Values};

/// Particles with a radius.
#[derive(Debug)]
pub struct Particles {
    pub set: Arc<ParticleSet>,
    /// Metres.
    pub radius_m: f64,
    /// Lowest and highest corner in metres: those of the positions, unless somebody said others.
    pub min: [f32; 3],
    pub max: [f32; 3],
}

impl Particles {
    pub fn new(set: Arc<ParticleSet>, radius_m: f64, bounds: Option<[[f32; 3]; 2]>) -> Self {
        let [min, max] = bounds.unwrap_or([set.min, set.max]);
        Self { set, radius_m, min, max }
    }

    /// No particles, whose attributes fit all that shaders take them for.
    pub(super) fn none(attributes: &[&str]) -> Self {
        let columns = attributes.iter().map(|name| Attribute {
            name: (*name).to_owned(),
            components: 0,
            values: Values::F32(Vec::new()),
        });
        let set = ParticleSet {
            attributes: columns.collect(),
            count: 0,
            dropped: 0,
            radius: None,
            min: [0.0; 3],
            max: [0.0; 3],
            notes: Vec::new(),
        };
        Self::new(Arc::new(set), RADIUS_OF_NONE_M, None)
    }

    /// What shows before a set does: none, with its attributes.
    pub(super) fn before(set: &ParticleSet, radius_m: f64, bounds: Option<[[f32; 3]; 2]>) -> Self {
        Self::new(Arc::new(set.emptied()), radius_m, bounds)
    }
}

/// Nothing has this radius; sizes that are made of it must not be zero.
const RADIUS_OF_NONE_M: f64 = 0.025;

/// A file's content, decoded.
#[derive(Clone, Debug)]
pub enum Asset {
    /// With a radius in metres that the spacing tells, if that was asked for and it tells one.
    Particles(Arc<ParticleSet>, Option<f32>),
    Image(Arc<Image>),
}

/// What was decoded before, by path, with the hash of the bytes it was made from.
#[derive(Debug, Default)]
pub struct Cache {
    assets: BTreeMap<PathBuf, Decoded>,
    sized: BTreeMap<PathBuf, Arc<Particles>>,
    pub(super) models: Models,
    /// A cube's pictures, and what they made.
    cube: Option<(Vec<Arc<Image>>, Arc<Image>)>,
}

#[derive(Debug)]
struct Decoded {
    hash: u128,
    kind: AssetKind,
    asset: Asset,
    found: Diagnostics,
}

/// What a file is to be decoded as.
#[derive(Clone, Debug, PartialEq)]
pub enum AssetKind {
    Particles {
        taken: Taken,
        /// Whether a radius is looked for where the file has none.
        estimate: bool,
    },
    Image,
}

/// A file that is being decoded, on another thread unless it was decoded before.
#[derive(Debug)]
pub struct Pending {
    path: PathBuf,
    hash: u128,
    kind: AssetKind,
    at: Option<Span>,
    work: Work,
}

#[derive(Debug)]
enum Work {
    Done(Asset, Diagnostics),
    Running(JoinHandle<Result<(Asset, Diagnostics), Diagnostic>>),
}

impl Cache {
    /// Begins to decode a file's bytes. Messages point at `at`, where a scene names the file.
    pub fn begin(&self, path: &Path, bytes: Arc<[u8]>, kind: AssetKind, at: Option<Span>) -> Pending {
        let hash = XxHash3_128::oneshot(&bytes);
        let work = match self.assets.get(path) {
            Some(known) if known.hash == hash && known.kind == kind => {
                Work::Done(known.asset.clone(), known.found.clone())
            }
            _ => {
                let (path, kind) = (path.to_owned(), kind.clone());
                Work::Running(thread::spawn(move || match kind {
                    AssetKind::Particles { taken, estimate } => decode_particles(&path, &bytes, &taken, estimate),
                    AssetKind::Image => decode_image(&path, &bytes),
                }))
            }
        };
        Pending { path: path.to_owned(), hash, kind, at, work }
    }

    /// Waits for a file and keeps it.
    pub fn finish(&mut self, pending: Pending, diagnostics: &mut Diagnostics) -> Option<Asset> {
        let Pending { path, hash, kind, at, work } = pending;
        let decoded = match work {
            Work::Done(asset, found) => Ok((asset, found)),
            Work::Running(thread) => thread.join().unwrap_or_else(|_| {
                // A reader that panics is a fault of this program, and no reason to end a watch.
                Err(Diagnostic::error(Code::ASSET, format!("`{}`: the reader failed", path.display())))
            }),
        };
        let label = |found: Diagnostic| match at {
            Some(span) => found.see(span, "named here"),
            None => found,
        };
        match decoded {
            Ok((asset, found)) => {
                found.iter().cloned().for_each(|d| diagnostics.push(label(d)));
                self.assets.insert(path, Decoded { hash, kind, asset: asset.clone(), found });
                Some(asset)
            }
            Err(error) => {
                diagnostics.push(label(error));
                None
            }
        }
    }

    /// One picture out of a cross of faces, or of six; the same as before if they are.
    pub fn cube(&mut self, images: Vec<Arc<Image>>, at: Span, diagnostics: &mut Diagnostics) -> Option<Arc<Image>> {
        let is_same = |known: &[Arc<Image>]| {
            known.len() == images.len() && known.iter().zip(&images).all(|(a, b)| Arc::ptr_eq(a, b))
        };
        if let Some((_, made)) = self.cube.as_ref().filter(|(known, _)| is_same(known)) {
            return Some(Arc::clone(made));
        }
        let made = match images.as_slice() {
            [cross] => cube::faces_of_cross(cross).and_then(|faces| cube::equirect(&faces.each_ref())),
            [px, nx, py, ny, pz, nz] => cube::equirect(&[px, nx, py, ny, pz, nz]),
            // Some could not be read, which was reported.
            _ => return None,
        };
        match made.map(Arc::new) {
            Ok(made) => {
                self.cube = Some((images, Arc::clone(&made)));
                Some(made)
            }
            Err(error) => {
                let failed = Diagnostic::error(Code::ASSET, error.message).at(at, "this is no cube");
                diagnostics.push(error.hint.iter().fold(failed, Diagnostic::hint));
                None
            }
        }
    }

    /// A set with its radius; the same as before if neither changed.
    pub fn sized(
        &mut self,
        path: &Path,
        set: Arc<ParticleSet>,
        radius_m: f64,
        bounds: Option<[[f32; 3]; 2]>,
    ) -> Arc<Particles> {
        let sized = Particles::new(set, radius_m, bounds);
        let is_same = |known: &Particles| {
            Arc::ptr_eq(&known.set, &sized.set)
                && (known.radius_m, known.min, known.max) == (sized.radius_m, sized.min, sized.max)
        };
        match self.sized.get(path) {
            Some(known) if is_same(known) => Arc::clone(known),
            _ => {
                let sized = Arc::new(sized);
                self.sized.insert(path.to_owned(), Arc::clone(&sized));
                sized
            }
        }
    }
}

pub(super) fn decode_particles(
    path: &Path,
    bytes: &[u8],
    taken: &Taken,
    estimate: bool,
) -> Result<(Asset, Diagnostics), Diagnostic> {
    let set = particles::read_as(path, bytes, taken).map_err(|error| {
        let failed = Diagnostic::error(Code::ASSET, format!("`{}`: {error}", path.display()));
        error.hint.iter().fold(failed, Diagnostic::hint)
    })?;
    let mut found = Diagnostics::new();
    let shown = path.display();
    if set.count == 0 {
        let why = if set.notes.is_empty() { "the file has no particles".into() } else { set.notes.join("; ") };
        let empty = format!("`{shown}`: {why}: the picture will show none");
        found.push(Diagnostic::warning(Code::ASSET_NOTE, empty));
    } else {
        for note in &set.notes {
            found.push(Diagnostic::note(Code::ASSET_NOTE, format!("`{shown}`: {note}")));
        }
    }
    let wanted = estimate && set.radius.is_none() && set.count > 1;
    let estimated = if wanted { particles::estimate_radius(&set.positions()) } else { None };
    Ok((Asset::Particles(Arc::new(set), estimated), found))
}

fn decode_image(path: &Path, bytes: &[u8]) -> Result<(Asset, Diagnostics), Diagnostic> {
    let image = crate::scene::image::read(bytes).map_err(|error| {
        let failed = Diagnostic::error(Code::ASSET, format!("`{}`: {}", path.display(), error.message));
        error.hint.iter().fold(failed, Diagnostic::hint)
    })?;
    let mut found = Diagnostics::new();
    if image.clipped > 0 {
        let clipped =
            format!("`{}`: {} texels are brighter than 65504 and were clipped", path.display(), image.clipped);
        found.push(Diagnostic::note(Code::ASSET_NOTE, clipped));
    }
    Ok((Asset::Image(Arc::new(image)), found))
}

/// The radius of a set: what somebody said, else the file's, else an estimate that is told.
///
/// # Errors
/// If nobody says and the spacing does not tell.
pub fn radius_m(
    path: &Path,
    set: &ParticleSet,
    estimated: Option<f32>,
    said: Option<f64>,
    diagnostics: &mut Diagnostics,
) -> Result<f64, Diagnostic> {
    if let Some(radius) = said.or(set.radius.map(f64::from)) {
        return Ok(radius);
    }
    if set.count == 0 {
        return Ok(RADIUS_OF_NONE_M);
    }
    match estimated {
        Some(radius) => {
            let said = format!("`{}` gives no radius: {radius:.4} m is estimated from the spacing", path.display());
            diagnostics.push(Diagnostic::note(Code::ASSET_NOTE, said).hint("`--radius METRES` says another"));
            Ok(f64::from(radius))
        }
        None => {
            let why = if set.count == 1 { "there is one particle only" } else { "all particles are in one place" };
            let message = format!("`{}` gives no radius, and the spacing does not tell: {why}", path.display());
            Err(Diagnostic::error(Code::ASSET, message).hint("give it with `--radius METRES`, or `radius:` in a scene"))
        }
    }
}
