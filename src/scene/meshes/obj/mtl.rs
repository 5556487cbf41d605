//! Material files of OBJ. Their model of light is of 1990; it is brought to metallic-roughness so:
//!
//! | MTL | glTF |
//! | --- | --- |
//! | `Kd`, `map_Kd` | base colour; a `Kd` of 0 under a picture counts as 1 |
//! | `d`, or 1 - `Tr`; `map_d` | alpha; below 1 it blends, a picture makes holes |
//! | `Pr`, `map_Pr`, else `Ns` | roughness; `(2 / (Ns + 2))^(1/4)`, 1 without `Ns` |
//! | `Pm`, `map_Pm` | metallic; 0 without |
//! | `Ke`, `map_Ke` | emission |
//! | `Ni` | index of refraction, if it is from 1 on |
//! | `norm`, and `map_Bump` or `bump` if the picture is not grey | normal texture |
//!
//! `Ks` has no place in that model: what is not metal reflects by its index of refraction.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::folder;
use super::statements::{lines, numbers, split};
use crate::diagnostic::nearest;
use crate::scene::image::Stored;
use crate::scene::meshes::bundle::Bundle;
use crate::scene::meshes::model::{AlphaMode, Material, Sampler, TextureUse, UvTransform, Wrap};
use crate::scene::meshes::pictures::Pictures;
use crate::scene::meshes::report::{Report, shown};

/// Materials by name, and the pictures that they use.
#[derive(Default)]
pub struct Materials {
    known: HashMap<String, Material>,
    used: Vec<Material>,
    by_name: HashMap<Option<String>, usize>,
    /// Keywords of which it was said that they are not read.
    passed_over: Vec<String>,
    pictures: Pictures,
}

/// What is said of one material.
#[derive(Default)]
struct Said {
    place: String,
    folder: PathBuf,
    numbers: HashMap<&'static str, Vec<f32>>,
    maps: HashMap<&'static str, Map>,
}

/// A use of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
struct Map {
    /// As the file says it, with slashes.
    name: String,
    offset: [f32; 2],
    scale: [f32; 2],
    is_clamped: bool,
    bump: f32,
}

// Writers differ in how they spell these: none is told from another by its case.
const NUMBERS: &[&str] = &["Kd", "Ke", "Ns", "Ni", "d", "Tr", "Pr", "Pm"];
const MAPS: &[(&str, &str)] = &[
    ("map_Kd", "map_Kd"),
    ("map_d", "map_d"),
    ("map_Ke", "map_Ke"),
    ("map_Pr", "map_Pr"),
    ("map_Pm", "map_Pm"),
    ("norm", "norm"),
    ("map_Bump", "bump"),
    ("bump", "bump"),
];
/// Pictures that have no place in the model.
const OTHER_MAPS: &[&str] =
    &["map_Ka", "map_Ks", "map_Ns", "map_Ps", "map_Tr", "map_refl", "refl", "disp", "map_disp", "decal"];
/// Numbers that have no place in the model, and `map_aat`, which is none.
const OTHER_NUMBERS: &[&str] =
    &["Ka", "Ks", "Tf", "illum", "sharpness", "Ps", "Pc", "Pcr", "aniso", "anisor", "map_aat"];

fn is(keyword: &str) -> impl Fn(&&&str) -> bool {
    move |known| known.eq_ignore_ascii_case(keyword)
}

fn map_called(keyword: &str) -> Option<&'static str> {
    MAPS.iter().find(|(known, _)| known.eq_ignore_ascii_case(keyword)).map(|(_, known)| *known)
}

/// The pictures that a material file names.
pub fn pictures(text: &[u8]) -> BTreeSet<String> {
    let named = lines(text).filter_map(|(_, line)| {
        let (keyword, rest) = split(&line)?;
        map_called(keyword)?;
        Some(map(rest).name)
    });
    named.collect()
}

/// What a material file in `folder` means by a name, from the model's folder on.
pub fn from(folder: &Path, name: &str) -> String {
    let is_elsewhere = name.contains(':') || folder.as_os_str().is_empty();
    if is_elsewhere { name.to_owned() } else { folder.join(name).to_string_lossy().into_owned() }
}

impl Materials {
    /// Reads a material file.
    pub fn read(&mut self, file: &str, text: &[u8], bundle: &Bundle, report: &mut Report) {
        let mut name: Option<String> = None;
        let mut said = Said::default();
        for (number, line) in lines(text) {
            let Some((keyword, rest)) = split(&line) else { continue };
            let place = format!("{file}, line {number}");
            if keyword.eq_ignore_ascii_case("newmtl") {
                self.close(name.replace(rest.trim_end().to_owned()), std::mem::take(&mut said), bundle, report);
                (said.place, said.folder) = (place, folder(file).to_owned());
            } else if let Some(known) = NUMBERS.iter().find(is(keyword)) {
                if let Some(values) = factors(rest, &place, report) {
                    said.numbers.insert(known, values);
                }
            } else if let Some(known) = map_called(keyword) {
                said.maps.insert(known, map(rest));
            } else if !OTHER_NUMBERS.iter().any(|known| is(keyword)(&known)) {
                self.pass_over(keyword, &place, report);
            }
        }
        self.close(name, said, bundle, report);
    }

    /// Says of a keyword that it is not read, once.
    fn pass_over(&mut self, keyword: &str, place: &str, report: &mut Report) {
        const MOST_UNKNOWN: usize = 3;
        let known = OTHER_MAPS.iter().find(is(keyword));
        let lower = keyword.to_ascii_lowercase();
        let unknown = self.passed_over.iter().filter(|word| !OTHER_MAPS.iter().any(|known| is(word)(&known))).count();
        if self.passed_over.contains(&lower) || known.is_none() && unknown >= MOST_UNKNOWN {
            return;
        }
        match known {
            Some(known) => report.note(place, format!("`{known}` has no place in the materials here, and is not read")),
            None => report.warn(place, format!("{} is no statement of MTL", shown(keyword))),
        }
        self.passed_over.push(lower);
    }

    fn close(&mut self, name: Option<String>, said: Said, bundle: &Bundle, report: &mut Report) {
        if let Some(name) = name {
            let material = Maker { said: &said, bundle, pictures: &mut self.pictures, report }.material(&name);
            self.known.entry(name).or_insert(material);
        }
    }

    /// The material of a name that a line gives; one like plaster where there is none.
    pub fn index(&mut self, named: Option<(usize, &str)>, report: &mut Report) -> usize {
        let name = named.map(|(_, name)| name);
        let key = name.map(str::to_owned);
        if let Some(index) = self.by_name.get(&key) {
            return *index;
        }
        let material = name.and_then(|name| self.known.get(name)).cloned().unwrap_or_else(|| {
            if let Some((line, name)) = named.filter(|_| !self.known.is_empty()) {
                let close = nearest(name, self.known.keys().map(String::as_str));
                let close = close.map(|close| format!("; did you mean {}?", shown(close))).unwrap_or_default();
                report.warn(format!("line {line}, usemtl"), format!("no material is called {}{close}", shown(name)));
            }
            Material { name: name.unwrap_or_default().to_owned(), ..Material::plain() }
        });
        self.used.push(material);
        self.by_name.insert(key, self.used.len() - 1);
        self.used.len() - 1
    }

    /// Which set of texture coordinates a material's normal texture uses, if it has one.
    pub fn normal_map(&self, index: usize) -> Option<u32> {
        Some(self.used.get(index)?.normal_texture?.uv_set)
    }

    pub fn finish(self) -> (Vec<Material>, Vec<Arc<Stored>>) {
        (self.used, self.pictures.images)
    }
}

/// Numbers of a factor. Colours may be given as `spectral` or `xyz`, which nobody writes.
fn factors(rest: &str, place: &str, report: &mut Report) -> Option<Vec<f32>> {
    if rest.starts_with("spectral") || rest.starts_with("xyz") {
        report.warn(place, "colours by spectrum and in XYZ are not read");
        return None;
    }
    // `d -halo 0.5`: alpha that depends on the angle.
    let values = numbers(rest.trim_start_matches("-halo").trim_start(), place, report)?;
    if values.is_empty() {
        report.error(place, "expected a number, found the end of the line");
        return None;
    }
    Some(values)
}

/// A picture with the options before its name.
fn map(text: &str) -> Map {
    let mut map = Map { scale: [1.0; 2], bump: 1.0, ..Map::default() };
    let mut rest = text.trim();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        rest = after.trim_start();
        let (least, most) = match option {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            _ => (1, 1),
        };
        let mut values = Vec::new();
        for number in 0..most {
            let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            let value = word.parse::<f32>();
            // A name that is a number is none of up to three numbers.
            if number >= least && (value.is_err() || after.is_empty()) {
                break;
            }
            values.push(value.ok().filter(|value| value.is_finite()));
            map.is_clamped |= option == "-clamp" && word == "on";
            rest = after.trim_start();
        }
        let value = |at: usize, usual: f32| values.get(at).copied().flatten().unwrap_or(usual);
        match option {
            "-o" => map.offset = [value(0, 0.0), value(1, 0.0)],
            "-s" => map.scale = [value(0, 1.0), value(1, 1.0)],
            "-bm" => map.bump = value(0, 1.0),
            _ => {}
        }
    }
    map.name = rest.replace('\\', "/");
    map
}

struct Maker<'a> {
    said: &'a Said,
    bundle: &'a Bundle,
    pictures: &'a mut Pictures,
    report: &'a mut Report,
}

impl Maker<'_> {
    fn number(&self, name: &str) -> Option<f32> {
        self.said.numbers.get(name)?.first().copied()
    }

    fn part(&self, name: &str, usual: f32) -> f32 {
        self.number(name).unwrap_or(usual).clamp(0.0, 1.0)
    }

    fn color(&self, name: &str) -> Option<[f32; 3]> {
        let values = self.said.numbers.get(name)?;
        // One number stands for all three.
        let last = *values.last()?;
        Some(std::array::from_fn(|i| values.get(i).copied().unwrap_or(last).max(0.0)))
    }

    fn material(&mut self, name: &str) -> Material {
        let plain = Material::plain();
        let [r, g, b, _] = plain.base_color_factor;
        let mut color = self.color("Kd").unwrap_or([r, g, b]);
        if self.said.maps.contains_key("map_Kd") && (color == [0.0; 3] || !self.said.numbers.contains_key("Kd")) {
            color = [1.0; 3];
        }
        let [r, g, b] = color.map(|x| x.min(1.0));
        let alpha = self.number("d").or(self.number("Tr").map(|tr| 1.0 - tr)).unwrap_or(1.0).clamp(0.0, 1.0);
        let emission = self.color("Ke").unwrap_or_default();
        // A factor ends at 1; what is brighter goes into the strength.
        let strength = emission.into_iter().fold(1.0, f32::max);
        let shininess = self.number("Ns").map(|ns| (2.0 / (ns.max(0.0) + 2.0)).powf(0.25));
        let mut material = Material {
            name: name.to_owned(),
            base_color_factor: [r, g, b, alpha],
            alpha_mode: if alpha < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque },
            metallic_factor: self.part("Pm", 0.0),
            roughness_factor: self.number("Pr").or(shininess).unwrap_or(plain.roughness_factor).clamp(0.0, 1.0),
            emissive_factor: emission.map(|x| x / strength),
            emissive_strength: strength,
            ior: self.number("Ni").filter(|ni| *ni >= 1.0).unwrap_or(plain.ior),
            ..plain
        };
        self.textures(&mut material);
        material
    }

    fn textures(&mut self, material: &mut Material) {
        material.base_color_texture = self.texture("map_Kd");
        material.emissive_texture = self.texture("map_Ke");
        if material.emissive_texture.is_some() && !self.said.numbers.contains_key("Ke") {
            material.emissive_factor = [1.0; 3];
        }
        self.coverage(material);
        self.metallic_roughness(material);
        material.normal_texture = self.texture("norm");
        if material.normal_texture.is_none() {
            material.normal_texture = self.texture("bump").filter(|texture| {
                let is_grey = self.pictures.images[texture.image].texels.iter().all(|[r, g, b, _]| r == g && g == b);
                if is_grey {
                    self.report.warn(&self.said.place, "its bump map is one of heights, which are not read");
                }
                !is_grey
            });
            material.normal_scale = self.said.maps.get("bump").map_or(1.0, |map| map.bump);
        }
    }

    /// A picture of coverage becomes the alpha of the base colour's.
    fn coverage(&mut self, material: &mut Material) {
        let Some(texture) = self.texture("map_d") else { return };
        material.alpha_mode = AlphaMode::Mask;
        let coverage = Arc::clone(&self.pictures.images[texture.image]);
        let base = material.base_color_texture.map(|texture| Arc::clone(&self.pictures.images[texture.image]));
        if base.as_ref().is_some_and(|base| Arc::ptr_eq(base, &coverage)) {
            return;
        }
        let has_alpha = coverage.texels.iter().any(|texel| texel[3] < 255);
        let alpha = |texel: [u8; 4]| if has_alpha { texel[3] } else { texel[0] };
        let merged = self.merge(base.as_deref(), Some(&coverage), |base, coverage| {
            let [r, g, b, _] = base.unwrap_or([255; 4]);
            [r, g, b, coverage.map_or(255, alpha)]
        });
        if let Some(image) = merged {
            material.base_color_texture = Some(TextureUse { image, ..material.base_color_texture.unwrap_or(texture) });
        }
    }

    /// Two grey pictures become the two channels of one.
    fn metallic_roughness(&mut self, material: &mut Material) {
        let (roughness, metallic) = (self.texture("map_Pr"), self.texture("map_Pm"));
        let Some(texture) = roughness.or(metallic) else { return };
        let image = |texture: Option<TextureUse>| texture.map(|t| Arc::clone(&self.pictures.images[t.image]));
        let (first, second) = (image(roughness), image(metallic));
        let merged = self.merge(first.as_deref(), second.as_deref(), |roughness, metallic| {
            [255, roughness.map_or(255, |r| r[0]), metallic.map_or(255, |m| m[0]), 255]
        });
        let Some(image) = merged else { return };
        material.metallic_roughness_texture = Some(TextureUse { image, ..texture });
        // A picture says it all unless a number is there to scale it.
        for (name, texture, factor) in
            [("Pr", roughness, &mut material.roughness_factor), ("Pm", metallic, &mut material.metallic_factor)]
        {
            if texture.is_some() && !self.said.numbers.contains_key(name) {
                *factor = 1.0;
            }
        }
    }

    /// A picture made of two of one size, or of one.
    fn merge(
        &mut self,
        a: Option<&Stored>,
        b: Option<&Stored>,
        texel: impl Fn(Option<[u8; 4]>, Option<[u8; 4]>) -> [u8; 4],
    ) -> Option<usize> {
        let size = |image: &Stored| (image.width, image.height);
        let (width, height) = a.or(b).map(size)?;
        if a.zip(b).is_some_and(|(a, b)| size(a) != size(b)) {
            self.report.warn(&self.said.place, "two of its pictures make one, but differ in size: they are left out");
            return None;
        }
        let at = |image: Option<&Stored>, index: usize| image.and_then(|image| image.texels.get(index)).copied();
        let count = width as usize * height as usize;
        let texels = (0..count).map(|index| texel(at(a, index), at(b, index))).collect();
        Some(self.pictures.keep(Stored { width, height, texels }))
    }

    fn texture(&mut self, which: &str) -> Option<TextureUse> {
        let map = self.said.maps.get(which)?;
        let place = &self.said.place;
        let bundle = self.bundle;
        let name = from(&self.said.folder, &map.name);
        let bytes = |report: &mut Report| match bundle.other_or_beside(&self.said.folder, &name) {
            Ok((found, bytes)) => {
                if found != name {
                    report.note(place, format!("{} is a path of elsewhere: {} is read", shown(&name), shown(&found)));
                }
                Some(Cow::Borrowed(bytes))
            }
            Err(why) => {
                report.warn(place, format!("{} {why}: the material goes without it", shown(&name)));
                None
            }
        };
        let image = self.pictures.add(&name, place, self.report, bytes)?;
        let wrap = if map.is_clamped { Wrap::Clamp } else { Wrap::Repeat };
        let [u, v] = map.scale;
        // v grows upwards in OBJ: 1 - ((1 - v) * scale + offset).
        let offset = [map.offset[0], 1.0 - v - map.offset[1]];
        Some(TextureUse {
            image,
            sampler: Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() },
            uv_set: 0,
            transform: UvTransform { offset, rotation: 0.0, scale: [u, v] },
        })
    }
}
