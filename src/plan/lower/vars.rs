//! Resources and inputs as variables: their descriptions, evaluated when first asked for.

use wgpu_types::{BufferUsages, Features, TextureFormatFeatureFlags, TextureUsages};

use super::names::{Entity, join};
use super::nodes::amount;
use super::{Building, CauseKind, CauseSet, Lowering, Result, ScopeId, Var, VarId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::format::{self, TextureFormat};
use crate::graph::expr::Expr;
use crate::graph::model::{Mips, Node, NodeKind, ResourceKind, Sp, ViewDimension};
use crate::graph::value::Value;
use crate::plan::model::{Buffer, Object, ObjectKind, ObjectRef, Origin, Texture};

/// No device has larger textures; layers are tracked one by one.
const MAX_EDGE: i64 = 65_536;
const MAX_LAYERS: i64 = 2048;
/// More items than any memory has.
const MAX_ITEMS: i64 = 1 << 40;

impl Lowering<'_> {
    pub(super) fn add_var(&mut self, building: Building) -> VarId {
        self.objects.push(building);
        self.vars.push(Var { now: ObjectRef::Fixed(self.objects.len() - 1) });
        self.vars.len() - 1
    }

    /// A declared resource's variable; its description is evaluated now if it was not yet.
    pub(super) fn resource(&mut self, s: ScopeId, i: usize) -> Result<VarId> {
        let graph = self.scopes[s].graph.clone();
        let resource = &graph.resources[i];
        self.used.insert(resource.name.span);
        if let Some(var) = self.scopes[s].resources[i] {
            if var != VarId::MAX {
                return Ok(var);
            }
            return Err(self.circle(s, resource.name.span));
        }
        // Marks it as being evaluated, to find circles.
        self.scopes[s].resources[i] = Some(VarId::MAX);
        self.evaluating.push((resource.name.span, resource.name.value.clone()));
        let made = self.describe_outside(s, &resource.kind, resource.name.span);
        self.evaluating.pop();
        self.scopes[s].resources[i] = None;
        let (kind, mips_auto, causes) = made?;
        let object = Object {
            path: join(&self.scopes[s].path, &resource.name.value),
            kind,
            origin: if resource.state { Origin::State(usize::MAX) } else { Origin::Frame },
            empty: match &resource.kind {
                ResourceKind::Counted { empty, .. } => empty.clone(),
                _ => None,
            },
            lifetime: None,
            span: resource.name.span,
        };
        let var = self.add_var(Building { object, layout: None, mips_auto, adapts: false, causes });
        self.scopes[s].resources[i] = Some(var);
        Ok(var)
    }

    /// What a resource would be with what its part is given now.
    pub(super) fn describe_anew(&mut self, s: ScopeId, i: usize) -> Result<ObjectKind> {
        let graph = self.scopes[s].graph.clone();
        let resource = &graph.resources[i];
        self.describe_outside(s, &resource.kind, resource.name.span).map(|(kind, ..)| kind)
    }

    /// Resources are the same in every iteration: they see no counter of a loop.
    fn describe_outside(&mut self, s: ScopeId, kind: &ResourceKind, at: Span) -> Result<(ObjectKind, bool, CauseSet)> {
        let counters = std::mem::take(&mut self.scopes[s].counters);
        self.forget_lets(s);
        let made = self.describe(s, kind, at);
        self.scopes[s].counters = counters;
        made.map_err(|fault| {
            let names = |name: &String| fault.message == format!("nothing is called `{name}`");
            match counters_of(&self.scopes[s].graph.passes).iter().any(names) {
                true => Box::new(fault.hint("a resource is the same in every iteration and sees no counter of a loop")),
                false => fault,
            }
        })
    }

    fn describe(&mut self, s: ScopeId, kind: &ResourceKind, at: Span) -> Result<(ObjectKind, bool, CauseSet)> {
        match kind {
            ResourceKind::Buffer { items } => {
                let (items, causes) = self.item_count(s, items, "the number of items")?;
                Ok((buffer(items as u64, false), false, causes))
            }
            ResourceKind::Counted { capacity, .. } => {
                let (declared, mut causes) = self.item_count(s, capacity, "the capacity")?;
                let name = self.scopes[s].graph.resources.iter().find(|r| r.name.span == at);
                let path = join(&self.scopes[s].path, name.map_or("", |r| r.name.value.as_str()));
                let items = self.request.capacities.get(&path).copied().unwrap_or(declared as u64);
                if self.request.capacities.contains_key(&path) {
                    causes.add(&self.causes.set(CauseKind::Input, &path));
                }
                Ok((buffer(items, true), false, causes))
            }
            ResourceKind::Like(name) => match self.resolve(s, &name.value, name.span)? {
                Entity::Var(var) => {
                    let like = self.object(self.vars[var].now);
                    let mut kind = like.object.kind.clone();
                    if let ObjectKind::Buffer(buffer) = &mut kind {
                        buffer.usages = BufferUsages::empty();
                    } else if let ObjectKind::Texture(texture) = &mut kind {
                        texture.usages = TextureUsages::empty();
                    }
                    Ok((kind, like.mips_auto, like.causes.clone()))
                }
                other => {
                    let message = format!("`{}` is {}, not a texture or buffer", name.value, other.what());
                    Err(traced(fault(Code::WRONG_KIND, message, name.span, "named here"), &self.scopes[s].trace))
                }
            },
            ResourceKind::Texture { format, size, dimension, layers, mips, samples } => {
                self.texture(s, format, size, *dimension, layers.as_ref(), mips.as_ref(), samples.as_ref())
            }
        }
    }

    /// How many items a buffer has.
    fn item_count(&mut self, s: ScopeId, expr: &Expr, what: &str) -> Result<(i64, CauseSet)> {
        let (n, causes) = self.whole(s, expr, what, 0)?;
        if n > MAX_ITEMS {
            let message = format!("{what} must be at most {MAX_ITEMS}, and is {n}");
            let diagnostic = fault(Code::OUT_OF_RANGE, message, expr.span, format!("this is {n}"));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        Ok((n, causes))
    }

    #[expect(clippy::too_many_arguments, reason = "the fields of one declaration")]
    fn texture(
        &mut self,
        s: ScopeId,
        format: &Sp<TextureFormat>,
        size: &[Expr],
        dimension: ViewDimension,
        layers_given: Option<&Expr>,
        mips: Option<&Mips>,
        samples_given: Option<&Expr>,
    ) -> Result<(ObjectKind, bool, CauseSet)> {
        let is_3d = dimension == ViewDimension::D3;
        let (edges, mut causes) = self.edges(s, format.span, size, if is_3d { 3 } else { 2 })?;
        let mut count = |low: &mut Self, expr: Option<&Expr>, what: &str, default: i64| -> Result<i64> {
            match expr {
                Some(expr) => {
                    let (n, depends) = low.whole(s, expr, what, 1)?;
                    causes.add(&depends);
                    Ok(n)
                }
                None => Ok(default),
            }
        };
        let default_layers = if dimension == ViewDimension::Cube { 6 } else { 1 };
        let layers = if is_3d { edges[2] } else { count(self, layers_given, "the number of layers", default_layers)? };
        let samples = count(self, samples_given, "samples", 1)?;
        let full = i64::from(edges.iter().max().map_or(1, |edge| edge.unsigned_abs()).ilog2()) + 1;
        let (mips, auto, mips_span) = match mips {
            Some(Mips::Auto(span)) => (full, true, Some(*span)),
            Some(Mips::Count(expr)) => (count(self, Some(expr), "the number of mips", 1)?, false, Some(expr.span)),
            None => (1, false, None),
        };
        let (layers_span, samples_span) = (layers_given.map(|e| e.span), samples_given.map(|e| e.span));
        let is_cube = dimension == ViewDimension::Cube;
        let wrong = if samples != 1 && samples != 4 {
            Some((format!("samples must be 1 or 4, and is {samples}"), samples_span))
        } else if mips > full {
            Some((format!("{} x {} texels have {full} mips, not {mips}", edges[0], edges[1]), mips_span))
        } else if samples > 1 && (mips > 1 || layers > 1 || is_3d) {
            Some(("a texture with 4 samples has one layer and one mip".into(), samples_span))
        } else if !is_3d && layers > MAX_LAYERS {
            Some((format!("a texture has at most {MAX_LAYERS} layers, not {layers}"), layers_span))
        } else if is_cube && (layers % 6 != 0 || edges[0] != edges[1]) {
            let shape = format!("{} x {}, {}", edges[0], edges[1], amount(layers.unsigned_abs(), "layer"));
            Some((format!("a cube is square and has 6 layers or a multiple, not {shape}"), layers_span))
        } else {
            None
        };
        if let Some((message, at)) = wrong {
            let diagnostic = fault(Code::OUT_OF_RANGE, message, at.unwrap_or(format.span), "not possible");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let clamp = |n: i64| u32::try_from(n).unwrap_or(u32::MAX);
        let texture = Texture {
            format: format.value,
            width: clamp(edges[0]),
            height: clamp(edges[1]),
            layers: clamp(layers),
            is_3d,
            mips: clamp(mips),
            samples: clamp(samples),
            usages: TextureUsages::empty(),
        };
        self.check_format(s, &texture, auto, format.span)?;
        Ok((ObjectKind::Texture(texture), auto, causes))
    }

    /// The edges of a texture in texels: as many as `wanted`, each from 1 to what devices have.
    fn edges(&mut self, s: ScopeId, at: Span, size: &[Expr], wanted: usize) -> Result<(Vec<i64>, CauseSet)> {
        let mut causes = CauseSet::default();
        let mut edges = Vec::new();
        for expr in size {
            let (value, depends) = self.known(s, expr)?;
            causes.add(&depends);
            for component in value.components() {
                edges.push(self.edge(s, expr, &value, &component)?);
            }
        }
        if edges.len() == 1 {
            edges = vec![edges[0]; wanted];
        }
        if edges.len() != wanted {
            let at = size.first().map_or(at, |e| e.span);
            let message = format!("the texture needs {wanted} edges, and `size` gives {}", edges.len());
            return Err(traced(fault(Code::OUT_OF_RANGE, message, at, "the size"), &self.scopes[s].trace));
        }
        Ok((edges, causes))
    }

    fn edge(&self, s: ScopeId, expr: &Expr, whole: &Value, component: &Value) -> Result<i64> {
        let diagnostic = match component {
            Value::Int(n) if (1..=MAX_EDGE).contains(n) => return Ok(*n),
            Value::Int(n) => {
                let message = format!("a texture's edge must be from 1 to {MAX_EDGE} texels, and is {n}");
                let diagnostic = fault(Code::OUT_OF_RANGE, message, expr.span, format!("this is {whole}"));
                if *n < 1 { diagnostic.hint("`max(1, ...)` keeps it above 0") } else { diagnostic }
            }
            Value::Float(x) => {
                let message = "a texture's size must be whole, and may be fractional";
                fault(Code::FRACTIONAL, message, expr.span, format!("this is {x}"))
                    .hint("say `floor(...)`, `ceil(...)` or `ceil_div(a, b)`")
            }
            other => return Err(self.mistyped(s, expr, "a size", other)),
        };
        Err(traced(diagnostic, &self.scopes[s].trace))
    }

    /// Whether there are textures of this format with such a shape, samples and automatic mips.
    fn check_format(&mut self, s: ScopeId, texture: &Texture, mips_auto: bool, at: Span) -> Result<()> {
        let features = texture.format.guaranteed_format_features(Features::empty());
        let is_depth = texture.format.is_depth_stencil_format();
        let can_store = features.allowed_usages.contains(TextureUsages::STORAGE_BINDING);
        let can_draw = !texture.is_3d && features.allowed_usages.contains(TextureUsages::RENDER_ATTACHMENT);
        let what = if texture.is_3d && is_depth {
            "cannot be a 3D texture"
        } else if texture.samples > 1 && !features.flags.contains(TextureFormatFeatureFlags::MULTISAMPLE_X4) {
            "cannot have 4 samples"
        } else if mips_auto && (is_depth || !(can_draw || can_store)) {
            "cannot have automatic mips"
        } else {
            if texture.format == TextureFormat::Depth32FloatStencil8 {
                self.need(s, Features::DEPTH32FLOAT_STENCIL8, at, "this format needs it");
            }
            return Ok(());
        };
        let message = format!("a texture of {} {what}", format::name(texture.format));
        Err(traced(fault(Code::FORMAT, message, at, "this format"), &self.scopes[s].trace))
    }

    /// What an entity is, more exactly than [`Entity::what`].
    pub(super) fn what(&self, entity: &Entity) -> String {
        match entity {
            Entity::Var(var) => self.describe_object(self.vars[*var].now),
            other => other.what().to_owned(),
        }
    }

    /// `a 2D array texture of R32Float with 2 layers`, `a counted buffer`.
    pub(super) fn describe_object(&self, object: ObjectRef) -> String {
        match &self.object(object).object.kind {
            ObjectKind::Texture(t) => {
                let shape = match (t.is_3d, t.layers, t.samples) {
                    (true, ..) => "a 3D texture".to_owned(),
                    (_, _, 4) => "a texture with 4 samples".to_owned(),
                    (_, 1, _) => "a 2D texture".to_owned(),
                    (_, n, _) => format!("a texture with {n} layers"),
                };
                format!("{shape} of {}", format::name(t.format))
            }
            ObjectKind::Buffer(b) if b.counted => "a counted buffer".to_owned(),
            ObjectKind::Buffer(_) => "a buffer".to_owned(),
        }
    }
}

/// Names of the counters of all loops.
fn counters_of(nodes: &[Node]) -> Vec<String> {
    let inside = |node: &Node| match &node.kind {
        NodeKind::Repeat(repeat) => {
            let own = repeat.index.iter().map(|index| index.value.clone());
            own.chain(counters_of(&repeat.passes)).collect()
        }
        NodeKind::Steps(steps) => counters_of(&steps.passes),
        NodeKind::If(choice) => [counters_of(&choice.then), counters_of(&choice.otherwise)].concat(),
        _ => Vec::new(),
    };
    nodes.iter().flat_map(inside).collect()
}

pub(super) fn buffer(items: u64, counted: bool) -> ObjectKind {
    let header = if counted { 4 } else { 0 };
    ObjectKind::Buffer(Buffer { stride: 4, items, header, counted, item: None, usages: BufferUsages::empty() })
}

pub(crate) fn stand_in_texture(dimension: Option<ViewDimension>) -> Texture {
    let (is_3d, layers) = match dimension {
        Some(ViewDimension::D3) => (true, 64),
        Some(ViewDimension::D2Array) => (false, 2),
        Some(ViewDimension::Cube) => (false, 6),
        Some(ViewDimension::CubeArray) => (false, 12),
        _ => (false, 1),
    };
    Texture {
        format: TextureFormat::Rgba16Float,
        width: 64,
        height: 64,
        layers,
        is_3d,
        mips: 1,
        samples: 1,
        usages: TextureUsages::empty(),
    }
}
