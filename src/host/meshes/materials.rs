//! Materials of a scene's bodies: the factors and textures that shaders know by name.

use super::Meshes;
use crate::graph::value::Value;
use crate::plan::meshes::MaterialTexture;
use crate::plan::packing;
use crate::scene::meshes::{AlphaMode, Material, TextureUse, UvTransform};
use crate::shader::reflect::Type;

impl Meshes {
    /// The factors of all materials, as a shader's struct wants them.
    pub(in crate::host) fn materials(&self, item: Option<&Type>, stride: u32) -> Result<Vec<u8>, String> {
        let Some(Type::Struct { members, .. }) = item else { return Err("a material is a struct".into()) };
        let mut bytes = vec![0; self.materials.len() * stride as usize];
        for (material, out) in self.materials.iter().zip(bytes.chunks_exact_mut(stride.max(1) as usize)) {
            for member in members {
                let value = factor(material, &member.name).ok_or_else(|| format!("there is no `{}`", member.name))?;
                let place = out.get_mut(member.offset as usize..).unwrap_or_default();
                packing::encode(&value, &member.ty, place).map_err(|why| format!("`{}`: {why}", member.name))?;
            }
        }
        Ok(bytes)
    }

    /// How each texture of each material is looked up.
    pub(in crate::host) fn uses(&self) -> impl Iterator<Item = [Option<TextureUse>; 5]> {
        self.materials.iter().map(|material| slots(material).map(|(_, used)| used))
    }
}

/// The textures of a material, each with the name of its place.
pub(super) fn slots(material: &Material) -> [(MaterialTexture, Option<TextureUse>); 5] {
    MaterialTexture::ALL.map(|slot| {
        let used = match slot {
            MaterialTexture::BaseColor => material.base_color_texture,
            MaterialTexture::MetallicRoughness => material.metallic_roughness_texture,
            MaterialTexture::Normal => material.normal_texture,
            MaterialTexture::Occlusion => material.occlusion_texture,
            MaterialTexture::Emissive => material.emissive_texture,
        };
        (slot, used)
    })
}

/// A factor of a material by the name that shaders know it by.
fn factor(material: &Material, name: &str) -> Option<Value> {
    let vector = |v: &[f32]| Value::vec(v.iter().map(|x| f64::from(*x)));
    let float = |x: f32| Value::Float(f64::from(x));
    let whole = |n: u32| Value::Int(i64::from(n));
    let slot = |ending: &str| {
        let texture = MaterialTexture::named(name, ending)?;
        Some(slots(material)[texture as usize].1)
    };
    if let Some(used) = slot("_texcoord") {
        return Some(whole(used.map_or(0, |used| used.uv_set)));
    }
    if let Some(used) = slot("_transform") {
        return Some(transform(&used.map(|used| used.transform).unwrap_or_default()));
    }
    Some(match name {
        "base_color_factor" => vector(&material.base_color_factor),
        "metallic_factor" => float(material.metallic_factor),
        "roughness_factor" => float(material.roughness_factor),
        "emissive_factor" => vector(&material.emissive_factor),
        "emissive_strength" => float(material.emissive_strength),
        "normal_scale" => float(material.normal_scale),
        "occlusion_strength" => float(material.occlusion_strength),
        "alpha_mode" => whole(match material.alpha_mode {
            AlphaMode::Opaque => 0,
            AlphaMode::Mask => 1,
            AlphaMode::Blend => 2,
        }),
        "alpha_cutoff" => float(material.alpha_cutoff),
        "double_sided" => whole(u32::from(material.double_sided)),
        "unlit" => whole(u32::from(material.unlit)),
        "ior" => float(material.ior),
        "transmission_factor" => float(material.transmission_factor),
        _ => return None,
    })
}

/// Columns of the matrix that takes (u, v, 1) to where a texture is looked up.
fn transform(about: &UvTransform) -> Value {
    let (sin, cos) = about.rotation.sin_cos();
    let [x, y] = about.scale;
    let [u, v] = about.offset;
    Value::vec([cos * x, -sin * x, 0.0, sin * y, cos * y, 0.0, u, v, 1.0].map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::meshes::MATERIAL;

    #[test]
    fn every_factor_that_planning_knows_has_a_value_that_fits() {
        for (name, ty) in MATERIAL {
            let value = factor(&Material::default(), name).unwrap_or_else(|| panic!("no `{name}`"));
            let mut out = vec![0; ty.size() as usize];
            packing::encode(&value, ty, &mut out).unwrap_or_else(|why| panic!("`{name}`: {why}"));
        }
        assert_eq!(factor(&Material::default(), "base_colour_factor"), None);
    }

    #[test]
    fn textures_turn_counter_clockwise_as_they_are_seen() {
        let quarter = UvTransform { rotation: std::f32::consts::FRAC_PI_2, ..UvTransform::default() };
        // v grows downwards: u = (1, 0) turned by a quarter points up, to (0, -1).
        let up: Vec<f64> = transform(&quarter).numbers().take(2).collect();
        assert!(up[0].abs() < 1e-6 && (up[1] + 1.0).abs() < 1e-6, "{up:?}");
    }
}
