//! Draws: entry points, geometry, targets, depth and stencil.

use wgpu_types::{BufferUsages, ShaderStages};

use super::bind::Stages;
use super::extent::Items;
use super::nodes::{Draft, amount};
use super::{Lowering, Place, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::model::{self as ast, Node};
use crate::plan::model::{
    Access, ArgumentKind, ColorTarget, DepthTarget, Draw, Geometry, ObjectKind, ObjectRef, PassKind, ShaderUse, Stencil,
};
use crate::shader::reflect::{Io, Scalar, Stage, Type};

/// Bytes of one item of indirect arguments: draw, and draw with indices.
const DRAW_BYTES: u64 = 16;
const DRAW_INDEXED_BYTES: u64 = 20;

impl Lowering<'_> {
    pub(super) fn draw(&mut self, s: ScopeId, draw: &ast::Draw, node: &Node, fullscreen: bool) -> Result<Draft> {
        let module = self.shader_module(s, &draw.shader)?;
        let vertex = if fullscreen { None } else { self.entry(s, &module, &draw.shader, Stage::Vertex, true)? };
        let fragment = self.entry(s, &module, &draw.shader, Stage::Fragment, fullscreen)?;
        let mut entries = Vec::new();
        entries.extend(vertex.clone().map(|e| (ShaderStages::VERTEX, e)));
        entries.extend(fragment.clone().map(|e| (ShaderStages::FRAGMENT, e)));
        let meshes = match &draw.meshes {
            Some(name) => Some(self.mesh_input(s, name)?),
            None => None,
        };
        let stages = Stages { module, entries, at: node.word, meshes };
        self.check_interface(s, &stages, fullscreen)?;

        let placeholder =
            ShaderUse { module: 0, compute: None, vertex: None, fragment: None, constants: vec![], bindings: vec![] };
        let mut draft = Draft::new(PassKind::Compute {
            shader: placeholder,
            dispatch: crate::plan::model::Dispatch::Groups([0; 3]),
        });
        let shader = self.feed(s, &stages, &draw.bind, &mut draft);
        let geometry = match &stages.meshes {
            _ if fullscreen => Geometry::Fullscreen,
            Some(meshes) => self.mesh_geometry(s, meshes, draw, vertex.as_deref(), &stages, &mut draft)?,
            None => self.geometry(s, draw, node.word, &mut draft)?,
        };
        let covers = fullscreen && draw.region.is_none() && !fragment.as_ref().is_some_and(|f| f.discards);
        let color = self.targets(s, draw, fragment.as_deref(), covers, node.word, &mut draft);
        let depth = self.depth(s, draw, fragment.as_deref(), node.word, &mut draft);
        let (color, depth) = match (color, depth) {
            (Err(color), Err(depth)) => {
                self.diagnostics.push(*color);
                return Err(depth);
            }
            (color, depth) => (color?, depth?),
        };
        let (extent, samples) = self.extent(s, draw, &color, depth.as_ref(), node.word)?;
        self.check_samples(s, draw, samples, &mut draft)?;
        let region = self.region(s, draw, extent, &mut draft)?;
        draft.kind = PassKind::Draw(Box::new(Draw {
            shader,
            geometry,
            topology: draw.topology,
            cull: draw.cull,
            front_ccw: draw.front_ccw,
            color,
            depth,
            samples,
            region,
            extent,
        }));
        Ok(draft)
    }

    /// What the vertex stage hands on must be what the fragment stage takes.
    fn check_interface(&self, s: ScopeId, stages: &Stages, fullscreen: bool) -> Result<()> {
        let find = |stage| stages.entries.iter().find(|(s, _)| *s == stage).map(|(_, e)| e);
        let Some(fragment) = find(ShaderStages::FRAGMENT) else { return Ok(()) };
        let vertex = find(ShaderStages::VERTEX);
        let uv = Io {
            location: 0,
            name: "uv".into(),
            ty: Type::Vector { components: 2, scalar: Scalar::F32 },
            span: fragment.span,
        };
        let given: Vec<&Io> = if fullscreen { vec![&uv] } else { vertex.iter().flat_map(|v| &v.outputs).collect() };
        for input in &fragment.inputs {
            let from = given.iter().find(|io| io.location == input.location);
            if from.is_some_and(|io| io.ty == input.ty) {
                continue;
            }
            let found = from.map_or("nothing".to_owned(), |io| format!("`{}`", io.ty.wgsl()));
            let message = format!(
                "the fragment stage takes `{}` at location {}, and the vertex stage hands on {found}",
                input.ty.wgsl(),
                input.location
            );
            let mut diagnostic = fault(Code::ENTRY_POINT, message, input.span, "taken here");
            if let Some(io) = from.filter(|_| !fullscreen) {
                diagnostic = diagnostic.see(io.span, "handed on here");
            }
            if fullscreen {
                diagnostic = diagnostic.hint("`Fullscreen` hands on `@location(0) uv: vec2<f32>` and nothing else");
            }
            return Err(traced(diagnostic.see(stages.at, "run by this pass"), &self.scopes[s].trace));
        }
        match vertex.filter(|v| !v.inputs.is_empty() && stages.meshes.is_none()) {
            Some(vertex) => {
                let io = &vertex.inputs[0];
                let message = format!("nothing feeds the vertex input `{}`", io.name);
                let diagnostic = fault(Code::UNBOUND, message, io.span, "vertex input")
                    .see(stages.at, "run by this pass")
                    .hint("`Draw(meshes: ...)` has vertex inputs; here vertices come from `@builtin(vertex_index)` and storage buffers");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
            None => Ok(()),
        }
    }

    fn geometry(&mut self, s: ScopeId, draw: &ast::Draw, word: Span, draft: &mut Draft) -> Result<Geometry> {
        let indices = match &draw.indices {
            Some(name) => {
                let view = ast::View { of: name.clone(), mip: None, layer: None, span: name.span };
                let viewed = self.view(s, &view)?;
                self.buffer_read(s, viewed.view.object, name, draft)?;
                self.buffer_usage(viewed.view.object, BufferUsages::INDEX);
                Some(viewed.view.object)
            }
            None => None,
        };
        if let Some(indirect) = &draw.indirect {
            return self.indirect(s, indirect, indices, draft);
        }
        let instances = match &draw.instances {
            Some(count) => self.count(s, count, "the number of instances", draft)?,
            None => Items::Known(1),
        };
        let vertices = match (&draw.vertices, indices) {
            (Some(count), _) => self.count(s, count, "the number of vertices", draft)?,
            (None, Some(object)) => match &self.object(object).object.kind {
                ObjectKind::Buffer(b) if b.counted => Items::Counted(object, b.items),
                ObjectKind::Buffer(b) => Items::Known(b.items),
                ObjectKind::Texture(_) => Items::Known(0),
            },
            (None, None) => {
                let diagnostic = fault(Code::MISSING_FIELD, "a draw needs `vertices`", word, "this draw")
                    .hint("say `vertices: 3`, `vertices: Each(\"...\")`, `indices: \"...\"` or `draw: Indirect(...)`");
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
        };
        let number = |n: u64| u32::try_from(n).unwrap_or(u32::MAX);
        match (vertices, instances) {
            (Items::Known(v), Items::Known(i)) => Ok(match indices {
                Some(indices) => Geometry::Indexed { indices, count: number(v), instances: number(i) },
                None => Geometry::Direct { vertices: number(v), instances: number(i) },
            }),
            (Items::Counted(..), Items::Counted(..)) => {
                let message = "vertices and instances cannot both come from counted buffers";
                let diagnostic = fault(Code::COUNTED, message, word, "this draw")
                    .hint("draw once for each item (`instances: Each(...)`) with a fixed number of vertices");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
            (Items::Counted(object, _), Items::Known(i)) => {
                let kind =
                    ArgumentKind::Draw { vertices: None, instances: Some(number(i)), indexed: indices.is_some() };
                draft.counted.push((object, kind));
                Ok(Geometry::Indirect { slot: u32::MAX, indices })
            }
            (Items::Known(v), Items::Counted(object, _)) => {
                let kind =
                    ArgumentKind::Draw { vertices: Some(number(v)), instances: None, indexed: indices.is_some() };
                draft.counted.push((object, kind));
                Ok(Geometry::Indirect { slot: u32::MAX, indices })
            }
        }
    }

    /// Reads a whole buffer, as indices or as arguments.
    fn buffer_read(&mut self, s: ScopeId, object: ObjectRef, name: &ast::Name, draft: &mut Draft) -> Result<()> {
        if !matches!(&self.object(object).object.kind, ObjectKind::Buffer(_)) {
            let message = format!("`{}` is {}, not a buffer", name.value, self.describe_object(object));
            return Err(traced(fault(Code::WRONG_KIND, message, name.span, "not a buffer"), &self.scopes[s].trace));
        }
        let access = Access { object, mips: 0..1, layers: 0..1, read: true, write: false, whole: false };
        draft.accesses.push((access, Place::at(name.span, &name.value, false)));
        draft.causes.add(&self.object(object).causes);
        Ok(())
    }

    fn indirect(
        &mut self,
        s: ScopeId,
        indirect: &ast::Indirect,
        indices: Option<ObjectRef>,
        draft: &mut Draft,
    ) -> Result<Geometry> {
        let view = ast::View { of: indirect.buffer.clone(), mip: None, layer: None, span: indirect.buffer.span };
        let object = self.view(s, &view)?.view.object;
        self.buffer_read(s, object, &indirect.buffer, draft)?;
        let item = match &indirect.item {
            Some(expr) => {
                let (item, causes) = self.whole(s, expr, "the item", 0)?;
                draft.causes.add(&causes);
                item as u64
            }
            None => 0,
        };
        let ObjectKind::Buffer(buffer) = &self.object(object).object.kind else { return Ok(Geometry::Fullscreen) };
        if item >= buffer.items {
            let at = indirect.item.as_ref().map_or(indirect.span, |e| e.span);
            let message =
                format!("`{}` has {} items, and item {item} is asked for", indirect.buffer.value, buffer.items);
            return Err(traced(
                fault(Code::OUT_OF_RANGE, message, at, format!("this is {item}")),
                &self.scopes[s].trace,
            ));
        }
        let bytes = if indices.is_some() { DRAW_INDEXED_BYTES } else { DRAW_BYTES };
        if u64::from(buffer.stride) < bytes && self.object(object).layout.is_some() {
            let message = format!(
                "an item of `{}` has {} bytes, and a draw's arguments have {bytes}",
                indirect.buffer.value, buffer.stride
            );
            let declared = self.object(object).layout.as_ref().map(|layout| layout.span);
            let mut diagnostic = fault(Code::BINDING_MISMATCH, message, indirect.span, "arguments of this draw");
            if let Some(span) = declared {
                diagnostic = diagnostic.see(span, "as a shader sees it");
            }
            let hint = match indices {
                Some(_) => "arguments are five u32: indices, instances, first index, base vertex, and 0",
                None => "arguments are four u32: vertices, instances, first vertex, and 0; `array<vec4u>` holds them",
            };
            let diagnostic = diagnostic.hint(hint);
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        self.buffer_usage(object, BufferUsages::STORAGE);
        let offset = u64::from(buffer_header(&self.object(object).object.kind)) + item * stride(self, object);
        draft.arguments = Some((object, offset, indices.is_some()));
        Ok(Geometry::Indirect { slot: u32::MAX, indices })
    }

    /// All targets of a draw have one size and one number of samples.
    fn extent(
        &self,
        s: ScopeId,
        draw: &ast::Draw,
        color: &[ColorTarget],
        depth: Option<&DepthTarget>,
        word: Span,
    ) -> Result<([u32; 2], u32)> {
        let mut first: Option<(Span, String, [u32; 2], u32)> = None;
        let spans = draw.color.iter().map(|t| (t.span, t.to.of.value.as_str()));
        let depth_span = draw.depth.iter().map(|d| (d.span, d.to.of.value.as_str()));
        let views = color.iter().map(|t| &t.view).chain(depth.map(|d| &d.view));
        for ((span, name), view) in spans.take(color.len()).chain(depth_span).zip(views) {
            let ObjectKind::Texture(t) = &self.object(view.object).object.kind else { continue };
            let mip = view.mips.start;
            let size = [(t.width >> mip).max(1), (t.height >> mip).max(1)];
            match &first {
                None => first = Some((span, name.to_owned(), size, t.samples)),
                Some((_, _, other, samples)) if *other == size && *samples == t.samples => {}
                Some((at, other, wanted, samples)) => {
                    let message = format!("the targets `{other}` and `{name}` are not of one size");
                    let label = |size: [u32; 2], n: u32| format!("{} x {}, {}", size[0], size[1], amount(n, "sample"));
                    let diagnostic = fault(Code::TARGET_MISMATCH, message, span, label(size, t.samples))
                        .see(*at, label(*wanted, *samples));
                    return Err(traced(diagnostic, &self.scopes[s].trace));
                }
            }
        }
        match first {
            Some((_, _, size, samples)) => Ok((size, samples)),
            None => {
                let diagnostic =
                    fault(Code::BAD_PASS, "a draw needs a colour or depth target", word, "draws to nothing")
                        .hint("say `color: [\"...\"]` or `depth: Nearest(\"...\")`");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }

    /// `samples` on a pass says what its targets have, and nothing else.
    fn check_samples(&mut self, s: ScopeId, draw: &ast::Draw, samples: u32, draft: &mut Draft) -> Result<()> {
        let Some(expr) = &draw.samples else { return Ok(()) };
        let (said, causes) = self.whole(s, expr, "samples", 1)?;
        draft.causes.add(&causes);
        if said == i64::from(samples) {
            return Ok(());
        }
        let message = format!("the pass says {said} samples, and its targets have {samples}");
        let mut diagnostic = fault(Code::TARGET_MISMATCH, message, expr.span, format!("this is {said}"));
        let target = draw.color.first().map(|t| t.span).or(draw.depth.as_ref().map(|d| d.span));
        if let Some(span) = target {
            diagnostic = diagnostic.see(span, format!("{samples} here"));
        }
        Err(traced(diagnostic.hint("leave `samples` out: the targets decide"), &self.scopes[s].trace))
    }

    fn region(
        &mut self,
        s: ScopeId,
        draw: &ast::Draw,
        extent: [u32; 2],
        draft: &mut Draft,
    ) -> Result<Option<[u32; 4]>> {
        let Some(region) = &draw.region else { return Ok(None) };
        let mut edges = Vec::new();
        for expr in &region.value {
            let (value, causes) = self.known(s, expr)?;
            draft.causes.add(&causes);
            for component in value.components() {
                match component {
                    crate::graph::value::Value::Int(n) => edges.push((n, expr)),
                    _ => return Err(self.mistyped(s, expr, "whole pixels", &value)),
                }
            }
        }
        let fits = match edges.as_slice() {
            [(x, _), (y, _), (w, _), (h, _)] => {
                *x >= 0
                    && *y >= 0
                    && *w >= 1
                    && *h >= 1
                    && x + w <= i64::from(extent[0])
                    && y + h <= i64::from(extent[1])
            }
            _ => false,
        };
        if !fits {
            let numbers: Vec<String> = edges.iter().map(|(n, _)| n.to_string()).collect();
            let message = format!(
                "the region ({}) is not x, y, width and height inside {} x {} pixels",
                numbers.join(", "),
                extent[0],
                extent[1]
            );
            return Err(traced(fault(Code::OUT_OF_RANGE, message, region.span, "the region"), &self.scopes[s].trace));
        }
        Ok(Some([edges[0].0 as u32, edges[1].0 as u32, edges[2].0 as u32, edges[3].0 as u32]))
    }
}

impl Stencil {
    /// Whether it can change what is there.
    pub fn writes(&self) -> bool {
        use crate::graph::model::StencilOperation::Keep;
        self.clear.is_some() || [self.pass, self.fail, self.depth_fail].iter().any(|op| *op != Keep)
    }
}

fn buffer_header(kind: &ObjectKind) -> u32 {
    match kind {
        ObjectKind::Buffer(b) => b.header,
        ObjectKind::Texture(_) => 0,
    }
}

fn stride(low: &Lowering<'_>, object: ObjectRef) -> u64 {
    match &low.object(object).object.kind {
        ObjectKind::Buffer(b) => u64::from(b.stride),
        ObjectKind::Texture(_) => 0,
    }
}
