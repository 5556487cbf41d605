//! Materials of a glTF file, and the textures and images that they use.

use std::borrow::Cow;

use super::accessor::Data;
use super::container::{self, Address};
use super::document::{self, TextureInfo};
use crate::scene::image::Stored;
use crate::scene::meshes::bundle::{Bundle, Refused};
use crate::scene::meshes::model::{AlphaMode, Filter, Material, Sampler, TextureUse, UvTransform, Wrap};
use crate::scene::meshes::pictures::Pictures;
use crate::scene::meshes::report::{Report, shown};

/// The materials of a document, and one more if something has none.
pub struct Materials {
    list: Vec<Material>,
    /// Of a material with glTF's defaults.
    default: Option<usize>,
    pictures: Pictures,
}

impl Materials {
    pub fn read(data: &Data<'_>, bundle: &Bundle, report: &mut Report) -> Self {
        let mut reader = Reader { data, bundle, pictures: Pictures::default(), report };
        let list = data.document.materials.iter().enumerate();
        let list = list.map(|(index, from)| reader.material(from, &name_of(index, &from.name))).collect();
        Self { list, default: None, pictures: reader.pictures }
    }

    /// The material that a primitive names.
    pub fn index(&mut self, named: Option<usize>, place: &str, report: &mut Report) -> Option<usize> {
        match named {
            Some(index) if index < self.list.len() && Some(index) != self.default => Some(index),
            Some(index) => {
                report.error(place, format!("there is no material {index}"));
                None
            }
            None => Some(*self.default.get_or_insert_with(|| {
                self.list.push(Material::default());
                self.list.len() - 1
            })),
        }
    }

    /// Which set of texture coordinates a material's normal texture uses, if it has one.
    pub fn normal_map(&self, index: usize) -> Option<u32> {
        Some(self.list.get(index)?.normal_texture?.uv_set)
    }

    pub fn finish(self) -> (Vec<Material>, Vec<std::sync::Arc<Stored>>) {
        (self.list, self.pictures.images)
    }
}

fn name_of(index: usize, name: &str) -> String {
    if name.is_empty() { format!("material {index}") } else { format!("material {index} ({})", shown(name)) }
}

struct Reader<'a> {
    data: &'a Data<'a>,
    bundle: &'a Bundle,
    pictures: Pictures,
    report: &'a mut Report,
}

impl Reader<'_> {
    fn material(&mut self, from: &document::Material, place: &str) -> Material {
        let metallic_roughness = &from.pbr_metallic_roughness;
        let extensions = &from.extensions;
        let normal = from.normal_texture.as_ref();
        let occlusion = from.occlusion_texture.as_ref();
        if extensions.transmission.as_ref().is_some_and(|t| t.transmission_texture.is_some()) {
            self.report.warn(place, "its transmission texture is not read, only the factor");
        }
        let usual = Material::default();
        let emissive_strength = extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength);
        let transmission = extensions.transmission.as_ref().and_then(|t| t.transmission_factor);
        let ior = extensions.ior.as_ref().and_then(|i| i.ior);
        let mut factor = |value: Option<f32>, usual: f32, most: f32, name: &str| {
            in_range(value.unwrap_or(usual), usual, most, &format!("{place}, {name}"), self.report)
        };
        let color = metallic_roughness.base_color_factor.unwrap_or(usual.base_color_factor);
        let emissive = from.emissive_factor.unwrap_or(usual.emissive_factor);
        let mut material = Material {
            name: from.name.clone(),
            base_color_factor: color.map(|x| factor(Some(x), 1.0, 1.0, "baseColorFactor")),
            metallic_factor: factor(metallic_roughness.metallic_factor, 1.0, 1.0, "metallicFactor"),
            roughness_factor: factor(metallic_roughness.roughness_factor, 1.0, 1.0, "roughnessFactor"),
            emissive_factor: emissive.map(|x| factor(Some(x), 0.0, 1.0, "emissiveFactor")),
            emissive_strength: factor(emissive_strength, 1.0, f32::MAX, "emissiveStrength"),
            // A scale may be negative.
            normal_scale: normal.and_then(|t| t.scale).filter(|scale| scale.is_finite()).unwrap_or(1.0),
            occlusion_strength: factor(occlusion.and_then(|t| t.strength), 1.0, 1.0, "occlusion strength"),
            alpha_mode: match from.alpha_mode {
                document::AlphaMode::Opaque => AlphaMode::Opaque,
                document::AlphaMode::Mask => AlphaMode::Mask,
                document::AlphaMode::Blend => AlphaMode::Blend,
            },
            alpha_cutoff: factor(from.alpha_cutoff, 0.5, f32::MAX, "alphaCutoff"),
            double_sided: from.double_sided,
            ior: factor(ior, 1.5, f32::MAX, "ior"),
            transmission_factor: factor(transmission, 0.0, 1.0, "transmissionFactor"),
            unlit: extensions.unlit.is_some(),
            ..usual
        };
        let mut texture = |info: Option<&TextureInfo>, name| self.texture(info?, &format!("{place}, {name}"));
        material.base_color_texture = texture(metallic_roughness.base_color_texture.as_ref(), "baseColorTexture");
        material.metallic_roughness_texture =
            texture(metallic_roughness.metallic_roughness_texture.as_ref(), "metallicRoughnessTexture");
        material.normal_texture = texture(normal, "normalTexture");
        material.occlusion_texture = texture(occlusion, "occlusionTexture");
        material.emissive_texture = texture(from.emissive_texture.as_ref(), "emissiveTexture");
        material
    }

    fn texture(&mut self, info: &TextureInfo, place: &str) -> Option<TextureUse> {
        let document = self.data.document;
        let Some(texture) = document.textures.get(info.index) else {
            self.report.error(place, format!("there is no texture {}", info.index));
            return None;
        };
        let transform = info.extensions.transform.as_ref();
        let uv_set = transform.and_then(|t| t.tex_coord).unwrap_or(info.tex_coord);
        if uv_set > 1 {
            let message = format!("it uses TEXCOORD_{uv_set}; 0 and 1 are read: the material goes without it");
            self.report.warn(place, message);
            return None;
        }
        let Some(source) = texture.source else {
            let message = format!("texture {} has no image that can be read", info.index);
            self.report.warn(place, format!("{message}: the material goes without it"));
            return None;
        };
        let sampler = match texture.sampler.map(|index| (index, document.samplers.get(index))) {
            None => Sampler::default(),
            Some((index, Some(from))) => sampler(from, &format!("sampler {index}"), self.report),
            Some((index, None)) => {
                self.report.error(format!("texture {}", info.index), format!("there is no sampler {index}"));
                return None;
            }
        };
        let image = self.image(source, place)?;
        let transform = uv_transform(transform, place, self.report);
        Some(TextureUse { image, sampler, uv_set, transform })
    }

    fn image(&mut self, index: usize, user: &str) -> Option<usize> {
        let Some(image) = self.data.document.images.get(index) else {
            self.report.error(user, format!("there is no image {index}"));
            return None;
        };
        let place = format!("image {index}");
        let (data, bundle) = (self.data, self.bundle);
        let bytes = |report: &mut Report| bytes_of(image, data, bundle, &place, report);
        self.pictures.add(&index.to_string(), &place, self.report, bytes)
    }
}

fn bytes_of<'a>(
    image: &'a document::Image,
    data: &'a Data<'_>,
    bundle: &'a Bundle,
    place: &str,
    report: &mut Report,
) -> Option<Cow<'a, [u8]>> {
    let lacks = |report: &mut Report, why: String| report.warn(place, format!("{why}: the material goes without it"));
    match (image.buffer_view, image.uri.as_deref().map(container::address)) {
        (Some(view), _) => data.view(view, &place, report).map(Cow::Borrowed),
        (None, Some(Address::Data(text))) => {
            container::data(text).map(Cow::Owned).map_err(|message| lacks(report, message)).ok()
        }
        (None, Some(Address::File(name))) => {
            let gone = |why: &Refused| lacks(report, format!("{} {why}", shown(&name)));
            bundle.other(&name).map(Cow::Borrowed).map_err(gone).ok()
        }
        (None, None) => {
            lacks(report, "it has neither `uri` nor `bufferView`".into());
            None
        }
    }
}

/// A factor from 0 to `most`; what is outside is moved there, and said.
fn in_range(value: f32, usual: f32, most: f32, place: &str, report: &mut Report) -> f32 {
    if (0.0..=most).contains(&value) {
        return value;
    }
    let taken = if value.is_nan() { usual } else { value.clamp(0.0, most) };
    report.warn(place, format!("{value} is out of range, and {taken} is taken"));
    taken
}

fn uv_transform(from: Option<&document::TextureTransform>, place: &str, report: &mut Report) -> UvTransform {
    let usual = UvTransform::default();
    let Some(from) = from else { return usual };
    let transform = UvTransform {
        offset: from.offset.unwrap_or(usual.offset),
        rotation: from.rotation.unwrap_or(usual.rotation),
        scale: from.scale.unwrap_or(usual.scale),
    };
    let numbers = [transform.offset, transform.scale, [transform.rotation, 0.0]];
    if numbers.as_flattened().iter().all(|x| x.is_finite()) {
        return transform;
    }
    report.warn(place, "its transform has a number that is not finite, and is left out");
    usual
}

fn sampler(from: &document::Sampler, place: &str, report: &mut Report) -> Sampler {
    let mut unknown =
        |name: &str, code: u32| report.warn(place, format!("{name} {code} is not known, and is left out"));
    let mut wrap = |code: Option<u32>, name| match code {
        None | Some(10_497) => Wrap::Repeat,
        Some(33_071) => Wrap::Clamp,
        Some(33_648) => Wrap::Mirror,
        Some(code) => {
            unknown(name, code);
            Wrap::Repeat
        }
    };
    let (wrap_u, wrap_v) = (wrap(from.wrap_s, "wrapS"), wrap(from.wrap_t, "wrapT"));
    let mag = match from.mag_filter {
        None | Some(9729) => Filter::Linear,
        Some(9728) => Filter::Nearest,
        Some(code) => {
            unknown("magFilter", code);
            Filter::Linear
        }
    };
    let (min, mip) = match from.min_filter {
        None | Some(9987) => (Filter::Linear, Some(Filter::Linear)),
        Some(9728) => (Filter::Nearest, None),
        Some(9729) => (Filter::Linear, None),
        Some(9984) => (Filter::Nearest, Some(Filter::Nearest)),
        Some(9985) => (Filter::Linear, Some(Filter::Nearest)),
        Some(9986) => (Filter::Nearest, Some(Filter::Linear)),
        Some(code) => {
            unknown("minFilter", code);
            (Filter::Linear, Some(Filter::Linear))
        }
    };
    Sampler { wrap_u, wrap_v, mag, min, mip }
}
