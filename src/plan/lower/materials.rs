//! Materials of meshes: what a draw binds of the one that it shows, by glTF's names.

use wgpu_types::BufferUsages;

use super::bind::Feed;
use super::buffers::same_type;
use super::meshes::MeshInput;
use super::misbound::describe;
use super::names::list;
use super::nodes::Draft;
use super::{Lowering, Place, Result, ScopeId, VarId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::format::SampleKind;
use crate::plan::meshes::{MATERIAL, MATERIAL_ALIGNMENT, MaterialTexture, MeshBuffer, MeshesInfo};
use crate::plan::model::{Access, Bound, ObjectKind};
use crate::shader::reflect::{Global, GlobalKind, Member, TextureDimension, Type};

impl Lowering<'_> {
    /// What of a material a variable of a draw of meshes is called after, if it is.
    pub(super) fn feed_material(
        &mut self,
        s: ScopeId,
        meshes: &MeshInput,
        place: &Feed<'_>,
        draft: &mut Draft,
    ) -> Result<Option<Bound>> {
        let Some(kind) = material_kind(place.global()) else { return Ok(None) };
        draft.causes.add(&self.causes_of(&meshes.root));
        let input = meshes.root.clone();
        match (kind, &place.global().kind) {
            (MaterialKind::Factors, GlobalKind::Uniform(ty)) => {
                self.material_factors(s, meshes, place, ty, draft).map(Some)
            }
            (
                MaterialKind::Texture(texture),
                GlobalKind::Texture { dimension: TextureDimension::D2, multisampled: false, sample: SampleKind::Float },
            ) => Ok(Some(Bound::MaterialTexture { input, texture })),
            (MaterialKind::Sampler(texture), GlobalKind::Sampler { comparison: false }) => {
                Ok(Some(Bound::MaterialSampler { input, texture }))
            }
            (MaterialKind::Factors, _) => Ok(None),
            (_, found) => {
                let global = place.global();
                let wanted = match kind {
                    MaterialKind::Sampler(_) => "a sampler that does not compare",
                    _ => "a 2D texture of floats",
                };
                let message = format!(
                    "the material's `{}` is {wanted}, and the shader declares {}",
                    global.name,
                    describe(found)
                );
                let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "the shader's variable")
                    .see(place.stages.at, "run by this pass")
                    .hint("in a draw of meshes the name is the material's: declare it so, or rename it");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }

    fn material_factors(
        &mut self,
        s: ScopeId,
        meshes: &MeshInput,
        place: &Feed<'_>,
        ty: &Type,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let Type::Struct { members, size, .. } = ty else {
            let message = format!("`material` is a struct of a material's factors, and the shader has `{}`", ty.wgsl());
            let diagnostic = fault(Code::UNIFORM_MISMATCH, message, place.global().span, "the shader's variable")
                .see(place.stages.at, "run by this pass");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        for member in members {
            let found = MATERIAL.iter().find(|(name, _)| *name == &*member.name);
            if found.is_none_or(|(_, ty)| *ty != member.ty) {
                return Err(self.material_misfit(s, place, member, found.map(|(_, ty)| ty)));
            }
        }
        let info = self.mesh_info(&meshes.root);
        let var = self.material_var(&meshes.root, info, ty, *size, meshes.name.span);
        let object = self.vars[var].now;
        self.buffer_usage(object, BufferUsages::UNIFORM);
        let access = Access { object, mips: 0..1, layers: 0..1, read: true, write: false, whole: false };
        let mut at = Place::at(place.at, "material", false);
        at.shader = Some(place.global().span);
        draft.accesses.push((access, at));
        Ok(Bound::Material { buffer: object, bytes: (*size).max(16) })
    }

    /// The buffer of all materials as one shader's struct has them.
    fn material_var(&mut self, root: &str, info: &MeshesInfo, ty: &Type, size: u32, at: Span) -> VarId {
        for n in 0.. {
            let number = if n == 0 { String::new() } else { format!("{n}") };
            let path = format!("{}.material{number}", if root.is_empty() { "(none)" } else { root });
            match self.input_vars.get(&path) {
                Some(var) => {
                    let object = &self.object(self.vars[*var].now).object.kind;
                    let held = match object {
                        ObjectKind::Buffer(b) => b.item.as_ref(),
                        ObjectKind::Texture(_) => None,
                    };
                    if held.is_some_and(|held| same_type(held, ty)) {
                        return *var;
                    }
                }
                None => {
                    let var = self.add_mesh_var(root, info, MeshBuffer::Materials, path.clone(), at);
                    let id = self.object_id(self.vars[var].now);
                    if let ObjectKind::Buffer(buffer) = &mut self.objects[id].object.kind {
                        buffer.stride = size.max(16).next_multiple_of(MATERIAL_ALIGNMENT);
                        buffer.item = Some(ty.clone());
                    }
                    self.input_vars.insert(path, var);
                    return var;
                }
            }
        }
        unreachable!("one of the numbers is free")
    }

    fn material_misfit(&self, s: ScopeId, place: &Feed<'_>, member: &Member, wanted: Option<&Type>) -> Box<Diagnostic> {
        let name = &member.name;
        let names: Vec<&str> = MATERIAL.iter().map(|(name, _)| *name).collect();
        let diagnostic = match wanted {
            Some(ty) => {
                let message =
                    format!("`{name}` of a material is `{}`, and the shader has `{}`", ty.wgsl(), member.ty.wgsl());
                fault(Code::UNIFORM_MISMATCH, message, member.span, format!("`{}`", member.ty.wgsl()))
                    .see(place.stages.at, "run by this pass")
            }
            None => {
                let all: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
                fault(Code::UNBOUND, format!("materials have no `{name}`"), member.span, "the member")
                    .see(place.stages.at, "run by this pass")
                    .nearest(name, names)
                    .hint(format!("materials have {}", list(&all)))
            }
        };
        traced(diagnostic, &self.scopes[s].trace)
    }
}

#[derive(Clone, Copy)]
enum MaterialKind {
    Factors,
    Texture(MaterialTexture),
    Sampler(MaterialTexture),
}

/// What a variable's name stands for in a draw of meshes.
fn material_kind(global: &Global) -> Option<MaterialKind> {
    if &*global.name == "material" && matches!(global.kind, GlobalKind::Uniform(_)) {
        return Some(MaterialKind::Factors);
    }
    MaterialTexture::named(&global.name, "_texture")
        .map(MaterialKind::Texture)
        .or_else(|| MaterialTexture::named(&global.name, "_sampler").map(MaterialKind::Sampler))
}
