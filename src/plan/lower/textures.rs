//! Textures as shaders see them: dimension, sample type, format and filtering.

use wgpu_types::{Features, TextureUsages};

use super::bind::Feed;
use super::nodes::Draft;
use super::view::Viewed;
use super::{Lowering, Result, ScopeId, fault, traced};
use crate::diagnostic::Code;
use crate::format::{self, SampleKind, TextureFormat};
use crate::plan::model::{Bound, ObjectKind, ObjectRef, View};
use crate::shader::reflect::{GlobalKind, TextureDimension, Use};

impl Lowering<'_> {
    pub(super) fn feed_texture(
        &mut self,
        s: ScopeId,
        place: &Feed<'_>,
        mut viewed: Viewed,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let GlobalKind::Texture { dimension, multisampled, sample } = place.wanted.global.kind else {
            return Err(self.mismatch_object(s, place, viewed.view.object));
        };
        let object = viewed.view.object;
        self.adapt(object, dimension, multisampled, stand_in_format(sample), &mut viewed);
        let ObjectKind::Texture(texture) = self.object(object).object.kind.clone() else {
            return Err(self.mismatch_object(s, place, object));
        };
        if format::sample_kind(texture.format) != sample || (texture.samples > 1) != multisampled {
            return Err(self.mismatch_object(s, place, object));
        }
        self.fit_dimension(s, place, &mut viewed.view, dimension)?;
        let filtered = place.wanted.filtered && sample == SampleKind::Float;
        if filtered && !format::is_filterable(texture.format, Features::empty()) {
            if !format::is_float32(texture.format) {
                let message = format!("{} cannot be filtered", format::name(texture.format));
                let diagnostic =
                    fault(Code::FORMAT, message, place.wanted.global.span, "sampled with a linear sampler")
                        .see(place.at, "in this pass")
                        .see(self.object(object).object.span, "declared here")
                        .hint("use a nearest sampler or `textureLoad`");
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
            let at = place.wanted.global.span;
            self.need(s, Features::FLOAT32_FILTERABLE, at, "sampling 32-bit floats with a linear sampler needs it");
        }
        self.texture_usage(object, TextureUsages::TEXTURE_BINDING);
        let auto = self.object(object).mips_auto && viewed.view.mips.len() > 1;
        let used = Use { read: true, write: false, ..place.wanted.used };
        let mut access = self.access(place, &viewed.view, used, auto);
        // Until the planner has made them, only mip 0 has content.
        if auto {
            access.0.mips = 0..viewed.view.mips.end;
        }
        draft.accesses.push(access);
        Ok(Bound::Texture { view: viewed.view, sample, filtered, multisampled })
    }

    pub(super) fn feed_storage_texture(
        &mut self,
        s: ScopeId,
        place: &Feed<'_>,
        mut viewed: Viewed,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let GlobalKind::StorageTexture { dimension, format, read, write } = place.wanted.global.kind else {
            return Err(self.mismatch_object(s, place, viewed.view.object));
        };
        let object = viewed.view.object;
        self.adapt(object, dimension, false, format, &mut viewed);
        let ObjectKind::Texture(texture) = self.object(object).object.kind.clone() else {
            return Err(self.mismatch_object(s, place, object));
        };
        if texture.format != format || texture.samples > 1 {
            return Err(self.mismatch_object(s, place, object));
        }
        if !viewed.mip_said {
            viewed.view.mips = 0..1;
        }
        self.fit_dimension(s, place, &mut viewed.view, dimension)?;
        let storable = format.guaranteed_format_features(Features::empty()).allowed_usages;
        let read_write = read
            && write
            && !matches!(format, TextureFormat::R32Float | TextureFormat::R32Uint | TextureFormat::R32Sint);
        if !storable.contains(TextureUsages::STORAGE_BINDING) || read_write {
            let (at, needed) = (place.wanted.global.span, Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);
            self.need(s, needed, at, "storing to this format so needs it");
        }
        self.texture_usage(object, TextureUsages::STORAGE_BINDING);
        draft.accesses.push(self.access(place, &viewed.view, place.wanted.used, false));
        Ok(Bound::StorageTexture { view: viewed.view, format, read, write })
    }

    pub(super) fn texture_usage(&mut self, object: ObjectRef, usage: TextureUsages) {
        for id in self.object_ids(object) {
            if let ObjectKind::Texture(texture) = &mut self.objects[id].object.kind {
                texture.usages |= usage;
            }
        }
    }

    /// A stand-in for an input takes the shape that the first shader wants.
    fn adapt(
        &mut self,
        object: ObjectRef,
        dimension: TextureDimension,
        multisampled: bool,
        format: TextureFormat,
        viewed: &mut Viewed,
    ) {
        let id = self.object_id(object);
        let building = &mut self.objects[id];
        if !building.adapts {
            return;
        }
        let ObjectKind::Texture(texture) = &mut building.object.kind else { return };
        building.adapts = false;
        texture.format = format;
        texture.samples = if multisampled { 4 } else { 1 };
        texture.is_3d = dimension == TextureDimension::D3;
        texture.layers = match dimension {
            TextureDimension::D1 | TextureDimension::D2 => texture.layers,
            TextureDimension::D2Array => texture.layers.max(2),
            TextureDimension::Cube => 6,
            TextureDimension::CubeArray => 12,
            TextureDimension::D3 => 64,
        };
        if !viewed.layer_said {
            viewed.view.layers = 0..if texture.is_3d { 1 } else { texture.layers };
        }
    }

    fn fit_dimension(&self, s: ScopeId, place: &Feed<'_>, view: &mut View, wanted: TextureDimension) -> Result<()> {
        let ObjectKind::Texture(t) = &self.object(view.object).object.kind else {
            return Err(self.mismatch_object(s, place, view.object));
        };
        let layers = view.layers.len();
        let fits = match wanted {
            TextureDimension::D1 => false,
            TextureDimension::D2 => !t.is_3d && layers == 1,
            TextureDimension::D2Array => !t.is_3d,
            TextureDimension::Cube => !t.is_3d && layers == 6 && t.width == t.height,
            TextureDimension::CubeArray => !t.is_3d && layers.is_multiple_of(6) && t.width == t.height,
            TextureDimension::D3 => t.is_3d,
        };
        if !fits {
            return Err(self.mismatch_object(s, place, view.object));
        }
        view.dimension = wanted;
        Ok(())
    }
}

fn stand_in_format(sample: SampleKind) -> TextureFormat {
    match sample {
        SampleKind::Float => TextureFormat::Rgba16Float,
        SampleKind::Sint => TextureFormat::R32Sint,
        SampleKind::Uint => TextureFormat::R32Uint,
        SampleKind::Depth => TextureFormat::Depth32Float,
    }
}
