//! Targets of a draw: colour, resolve, depth and stencil.

use wgpu_types::{Features, TextureFormatFeatureFlags, TextureUsages};

use super::nodes::{Draft, amount};
use super::view::whole_write;
use super::{Lowering, Place, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::format::{self, SampleKind, TextureFormat};
use crate::graph::model as ast;
use crate::plan::model::{Access, ColorTarget, DepthTarget, ObjectKind, Stencil, Texture, View};
use crate::shader::reflect::{Entry, Io, Scalar, Type};

impl Lowering<'_> {
    pub(super) fn targets(
        &mut self,
        s: ScopeId,
        draw: &ast::Draw,
        fragment: Option<&Entry>,
        covers: bool,
        word: Span,
        draft: &mut Draft,
    ) -> Result<Vec<ColorTarget>> {
        let mut targets = Vec::new();
        let mut wrong = None;
        for (i, target) in draw.color.iter().enumerate() {
            let output = fragment.and_then(|f| f.outputs.iter().find(|o| o.location as usize == i));
            match self.target(s, target, i, fragment, output, covers, draft) {
                Ok(made) => targets.push(made),
                Err(fault) => {
                    if let Some(earlier) = wrong.replace(fault) {
                        self.diagnostics.push(*earlier);
                    }
                }
            }
        }
        if let Some(fault) = wrong {
            return Err(fault);
        }
        for output in fragment.iter().flat_map(|f| &f.outputs) {
            if output.location as usize >= draw.color.len() {
                let message = format!(
                    "the fragment stage puts out `@location({})`, and the pass has {}",
                    output.location,
                    amount(draw.color.len() as u64, "colour target")
                );
                let diagnostic = fault(Code::TARGET_MISMATCH, message, output.span, "put out here")
                    .see(word, "this pass")
                    .hint("add a target to `color`, or drop the output");
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
        }
        Ok(targets)
    }

    #[expect(clippy::too_many_arguments, reason = "one target with everything that it must fit")]
    fn target(
        &mut self,
        s: ScopeId,
        target: &ast::Target,
        location: usize,
        fragment: Option<&Entry>,
        output: Option<&Io>,
        covers: bool,
        draft: &mut Draft,
    ) -> Result<ColorTarget> {
        let (view, texture) = self.target_view(s, &target.to, draft)?;
        let format = texture.format;
        let declared = self.object(view.object).object.span;
        if format == TextureFormat::Rg11b10Ufloat {
            self.need(s, Features::RG11B10UFLOAT_RENDERABLE, target.span, "a target of this format needs it");
        }
        if format.is_depth_stencil_format() || !format::is_renderable(format, self.features) {
            let message = format!("a texture of {} cannot be a colour target", format::name(format));
            let diagnostic =
                fault(Code::FORMAT, message, target.span, "a colour target").see(declared, "declared here");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        if texture.is_3d {
            let diagnostic = fault(Code::FORMAT, "a 3D texture cannot be a target", target.span, "a target")
                .see(declared, "declared here")
                .hint("render into the layers of a 2D array, or write a storage texture");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let Some(output) = output else {
            let message = format!("nothing puts out `@location({location})` for `{}`", target.to.of.value);
            let mut diagnostic = fault(Code::TARGET_MISMATCH, message, target.span, format!("target {location}"));
            if let Some(fragment) = fragment {
                diagnostic = diagnostic.see(fragment.span, "the fragment stage");
            }
            diagnostic = diagnostic.hint(format!("put out `@location({location})`, or drop the target"));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        if !output_fits(&output.ty, format, target.blend.as_ref().map(|b| &b.value)) {
            let message = format!(
                "`{}` is {}, and the shader puts out `{}`",
                target.to.of.value,
                format::name(format),
                output.ty.wgsl()
            );
            let diagnostic = fault(Code::TARGET_MISMATCH, message, output.span, format!("`{}`", output.ty.wgsl()))
                .see(target.span, format!("target {location}"))
                .see(declared, "declared here");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        if let Some(blend) = &target.blend {
            self.check_blend(s, format, blend.span, declared)?;
        }
        let clear = match &target.clear {
            Some(value) => {
                let (value, causes) = self.clear_value(s, &value.value)?;
                draft.causes.add(&causes);
                Some(value)
            }
            None => None,
        };
        let all = target.write == [true; 4];
        let discard_before = clear.is_none() && covers && all && target.blend.is_none();
        let whole = clear.is_some() || discard_before;
        self.texture_usage(view.object, TextureUsages::RENDER_ATTACHMENT);
        let access = Access { read: !whole, whole, ..whole_write(&view) };
        draft.accesses.push((access, Place::at(target.span, &target.to.of.value, false)));
        let resolve = match &target.resolve {
            Some(resolve) => Some(self.resolve_target(s, resolve, &view, &texture, draft)?),
            None => None,
        };
        Ok(ColorTarget {
            view,
            format,
            clear,
            discard_before,
            blend: target.blend.as_ref().map(|b| b.value),
            write: target.write,
            resolve,
        })
    }

    fn check_blend(&mut self, s: ScopeId, format: TextureFormat, at: Span, declared: Span) -> Result<()> {
        if format::is_blendable(format, self.features) {
            return Ok(());
        }
        if format::is_float32(format) {
            self.need(s, Features::FLOAT32_BLENDABLE, at, "blending 32-bit floats needs it");
            return Ok(());
        }
        let message = format!("a target of {} cannot blend", format::name(format));
        let diagnostic = fault(Code::FORMAT, message, at, "blends")
            .see(declared, "declared here")
            .hint("formats of normalized numbers and floats can; whole numbers cannot");
        Err(traced(diagnostic, &self.scopes[s].trace))
    }

    fn resolve_target(
        &mut self,
        s: ScopeId,
        resolve: &ast::View,
        from: &View,
        texture: &Texture,
        draft: &mut Draft,
    ) -> Result<View> {
        let (view, to) = self.target_view(s, resolve, draft)?;
        let size = |t: &Texture, v: &View| ((t.width >> v.mips.start).max(1), (t.height >> v.mips.start).max(1));
        if texture.samples != 4
            || to.samples != 1
            || to.format != texture.format
            || size(&to, &view) != size(texture, from)
        {
            let message = format!("`{}` cannot take the resolved samples", resolve.of.value);
            let diagnostic = fault(Code::TARGET_MISMATCH, message, resolve.span, self.describe_object(view.object))
                .see(self.object(from.object).object.span, self.describe_object(from.object))
                .hint("resolve 4 samples into a texture of the same format and size without samples");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let flags = texture.format.guaranteed_format_features(Features::empty()).flags;
        if !flags.contains(TextureFormatFeatureFlags::MULTISAMPLE_RESOLVE) {
            let message = format!("samples of {} cannot be resolved", format::name(texture.format));
            let diagnostic = fault(Code::FORMAT, message, resolve.span, "resolved here")
                .see(self.object(from.object).object.span, "declared here")
                .hint("let a shader read them as `texture_multisampled_2d`");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        self.texture_usage(view.object, TextureUsages::RENDER_ATTACHMENT);
        draft.accesses.push((whole_write(&view), Place::at(resolve.span, &resolve.of.value, false)));
        Ok(view)
    }

    /// A view that a draw can write: one mip, one layer.
    fn target_view(&mut self, s: ScopeId, at: &ast::View, draft: &mut Draft) -> Result<(View, Texture)> {
        let mut viewed = self.view(s, at)?;
        draft.causes.add(&viewed.causes);
        let ObjectKind::Texture(texture) = self.object(viewed.view.object).object.kind.clone() else {
            let message = format!("`{}` is a buffer and cannot be a target", at.of.value);
            return Err(traced(fault(Code::WRONG_KIND, message, at.span, "a target"), &self.scopes[s].trace));
        };
        if !viewed.mip_said {
            viewed.view.mips = 0..1;
        }
        if viewed.view.layers.len() > 1 {
            let message = format!("`{}` has {} layers, and a target is one", at.of.value, viewed.view.layers.len());
            let diagnostic = fault(Code::BAD_PASS, message, at.span, "which layer?")
                .hint(format!("say `(to: \"{}\", layer: 0)`", at.of.value));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        viewed.view.dimension = crate::shader::reflect::TextureDimension::D2;
        Ok((viewed.view, texture))
    }

    pub(super) fn depth(
        &mut self,
        s: ScopeId,
        draw: &ast::Draw,
        fragment: Option<&Entry>,
        word: Span,
        draft: &mut Draft,
    ) -> Result<Option<DepthTarget>> {
        let Some(depth) = &draw.depth else {
            if let Some(fragment) = fragment.filter(|f| f.writes_frag_depth) {
                let message = "the fragment stage writes `frag_depth`, and the pass has no depth target";
                let diagnostic = fault(Code::TARGET_MISMATCH, message, fragment.span, "writes depth")
                    .see(word, "run by this pass")
                    .hint("say `depth: Nearest(\"...\")`");
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
            return Ok(None);
        };
        let (view, texture) = self.target_view(s, &depth.to, draft)?;
        let format = texture.format;
        let declared = self.object(view.object).object.span;
        if !format.has_depth_aspect() {
            let message = format!("`{}` has no depth: it is {}", depth.to.of.value, format::name(format));
            let diagnostic = fault(Code::FORMAT, message, depth.span, "the depth target")
                .see(declared, "declared here")
                .hint("declare it as Depth32Float");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        if depth.stencil.is_some() && !format.has_stencil_aspect() {
            let message = format!("`{}` has no stencil: it is {}", depth.to.of.value, format::name(format));
            let diagnostic = fault(Code::FORMAT, message, depth.span, "tests stencil")
                .see(declared, "declared here")
                .hint("declare it as Depth24PlusStencil8 or Depth32FloatStencil8");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let clear = match &depth.clear {
            Some(expr) => {
                let clear = self.plain(s, expr, &mut draft.causes)?;
                if !(0.0..=1.0).contains(&clear) {
                    let message = format!("depth clears to a value from 0 to 1, not {clear}");
                    return Err(traced(
                        fault(Code::OUT_OF_RANGE, message, expr.span, "the value"),
                        &self.scopes[s].trace,
                    ));
                }
                Some(clear as f32)
            }
            None => None,
        };
        let bias = match &depth.bias {
            Some((constant, slope)) => {
                (self.plain(s, constant, &mut draft.causes)? as i32, self.plain(s, slope, &mut draft.causes)? as f32)
            }
            None => (0, 0.0),
        };
        let stencil = match &depth.stencil {
            Some(stencil) => Some(self.stencil(s, stencil, draft)?),
            None => None,
        };
        self.texture_usage(view.object, TextureUsages::RENDER_ATTACHMENT);
        if format == TextureFormat::Depth32FloatStencil8 {
            self.need(s, Features::DEPTH32FLOAT_STENCIL8, depth.span, "this format needs it");
        }
        let writes = depth.write || clear.is_some() || stencil.as_ref().is_some_and(Stencil::writes);
        // Clearing one aspect leaves the other as it is.
        let clears_stencil = stencil.as_ref().is_some_and(|s| s.clear.is_some());
        let whole = clear.is_some() && (clears_stencil || !format.has_stencil_aspect());
        let read = clear.is_none() || (stencil.is_some() && !clears_stencil);
        let access = Access { read, write: writes, whole, ..whole_write(&view) };
        draft.accesses.push((access, Place::at(depth.span, &depth.to.of.value, false)));
        Ok(Some(DepthTarget { view, format, compare: depth.compare, write: depth.write, clear, bias, stencil }))
    }

    fn stencil(&mut self, s: ScopeId, stencil: &ast::Stencil, draft: &mut Draft) -> Result<Stencil> {
        let (reference, causes) = self.whole(s, &stencil.reference, "the stencil reference", 0)?;
        draft.causes.add(&causes);
        let clear = match &stencil.clear {
            Some(expr) => {
                let (clear, causes) = self.whole(s, expr, "the stencil's clear value", 0)?;
                draft.causes.add(&causes);
                Some(clear as u32)
            }
            None => None,
        };
        Ok(Stencil {
            compare: stencil.compare,
            pass: stencil.pass,
            fail: stencil.fail,
            depth_fail: stencil.depth_fail,
            reference: reference as u32,
            read_mask: stencil.read_mask,
            write_mask: stencil.write_mask,
            clear,
        })
    }
}

/// Whether a fragment output can go to a format: the same kind of numbers, channels enough, and
/// an alpha where blending reads it.
fn output_fits(ty: &Type, format: TextureFormat, blend: Option<&ast::Blend>) -> bool {
    let (components, scalar) = match ty {
        Type::Scalar(scalar) => (1, *scalar),
        Type::Vector { components, scalar } => (*components, *scalar),
        _ => return false,
    };
    let kind = match scalar {
        Scalar::F32 | Scalar::F16 => SampleKind::Float,
        Scalar::I32 => SampleKind::Sint,
        Scalar::U32 => SampleKind::Uint,
        Scalar::Other => return false,
    };
    let alpha = blend.is_some_and(|b| {
        [b.color.source, b.color.target, b.alpha.source, b.alpha.target]
            .iter()
            .any(|f| matches!(f, ast::Factor::SrcAlpha | ast::Factor::OneMinusSrcAlpha))
    });
    format::sample_kind(format) == kind && components >= format::channels(format) && (!alpha || components == 4)
}
