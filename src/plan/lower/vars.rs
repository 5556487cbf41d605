//! Resources and inputs as variables: their descriptions, evaluated when first asked for.

use wgpu_types::{BufferUsages, TextureUsages};

use super::names::{Entity, join};
use super::nodes::amount;
use super::{Building, Lowering, Result, ScopeId, Var, VarId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::format::{self, TextureFormat};
use crate::graph::expr::Expr;
use crate::graph::model::{InputKind, Mips, ResourceKind, Sp, ViewDimension};
use crate::graph::value::Value;
use crate::plan::model::{Buffer, Causes, InputInfo, Object, ObjectKind, ObjectRef, Origin, Texture};

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
        let made = self.describe(s, &resource.kind, resource.name.span);
        self.evaluating.pop();
        self.scopes[s].resources[i] = None;
        let (kind, mips_auto, causes) = made?;
        let object = Object {
            path: join(&self.scopes[s].path, &resource.name.value),
            kind,
            origin: if resource.state { Origin::State(usize::MAX) } else { Origin::Frame },
            lifetime: None,
            span: resource.name.span,
        };
        let var = self.add_var(Building { object, layout: None, mips_auto, adapts: false, causes });
        self.scopes[s].resources[i] = Some(var);
        Ok(var)
    }

    fn describe(&mut self, s: ScopeId, kind: &ResourceKind, at: Span) -> Result<(ObjectKind, bool, Causes)> {
        match kind {
            ResourceKind::Buffer { items } => {
                let (items, causes) = self.item_count(s, items, "the number of items")?;
                Ok((buffer(items as u64, false), false, causes))
            }
            ResourceKind::Counted { capacity } => {
                let (declared, mut causes) = self.item_count(s, capacity, "the capacity")?;
                let name = self.scopes[s].graph.resources.iter().find(|r| r.name.span == at);
                let path = join(&self.scopes[s].path, name.map_or("", |r| r.name.value.as_str()));
                let items = self.request.capacities.get(&path).copied().unwrap_or(declared as u64);
                causes.inputs.extend(self.request.capacities.contains_key(&path).then(|| path.clone()));
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
    fn item_count(&mut self, s: ScopeId, expr: &Expr, what: &str) -> Result<(i64, Causes)> {
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
        given_layers: Option<&Expr>,
        mips: Option<&Mips>,
        samples: Option<&Expr>,
    ) -> Result<(ObjectKind, bool, Causes)> {
        let mut causes = Causes::default();
        let mut edges = Vec::new();
        for expr in size {
            let (value, depends) = self.known(s, expr)?;
            causes.add(&depends);
            for component in value.components() {
                match component {
                    Value::Int(n) if (1..=MAX_EDGE).contains(n) => edges.push((*n, expr.span)),
                    Value::Int(n) => {
                        let message = format!("a texture's edge must be from 1 to {MAX_EDGE} texels, and is {n}");
                        let mut diagnostic = fault(Code::OUT_OF_RANGE, message, expr.span, format!("this is {value}"));
                        if *n < 1 {
                            diagnostic = diagnostic.hint("`max(1, ...)` keeps it above 0");
                        }
                        return Err(traced(diagnostic, &self.scopes[s].trace));
                    }
                    Value::Float(x) => {
                        let diagnostic = fault(
                            Code::FRACTIONAL,
                            "a texture's size must be whole, and may be fractional",
                            expr.span,
                            format!("this is {x}"),
                        )
                        .hint("say `floor(...)`, `ceil(...)` or `ceil_div(a, b)`");
                        return Err(traced(diagnostic, &self.scopes[s].trace));
                    }
                    other => return Err(self.mistyped(s, expr, "a size", other)),
                }
            }
        }
        let is_3d = dimension == ViewDimension::D3;
        let wanted = if is_3d { 3 } else { 2 };
        if edges.len() == 1 {
            edges = vec![edges[0]; wanted];
        }
        if edges.len() != wanted {
            let at = size.first().map_or(format.span, |e| e.span);
            let message = format!("the texture needs {wanted} edges, and `size` gives {}", edges.len());
            return Err(traced(fault(Code::OUT_OF_RANGE, message, at, "the size"), &self.scopes[s].trace));
        }
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
        let layers =
            if is_3d { edges[2].0 } else { count(self, given_layers, "the number of layers", default_layers)? };
        let samples_given = samples.map(|e| e.span);
        let layers_given = given_layers.map(|e| e.span);
        let samples = count(self, samples, "samples", 1)?;
        let full = i64::from(edges.iter().map(|e| e.0).max().unwrap_or(1).ilog2()) + 1;
        let (mips, auto, mips_span) = match mips {
            Some(Mips::Auto(span)) => (full, true, Some(*span)),
            Some(Mips::Count(expr)) => (count(self, Some(expr), "the number of mips", 1)?, false, Some(expr.span)),
            None => (1, false, None),
        };
        let refuse = |message: String, at: Option<Span>| {
            let diagnostic = fault(Code::OUT_OF_RANGE, message, at.unwrap_or(format.span), "not possible");
            Err(traced(diagnostic, &self.scopes[s].trace))
        };
        if samples != 1 && samples != 4 {
            return refuse(format!("samples must be 1 or 4, and is {samples}"), samples_given);
        }
        if mips > full {
            return refuse(format!("{} x {} texels have {full} mips, not {mips}", edges[0].0, edges[1].0), mips_span);
        }
        if samples > 1 && (mips > 1 || layers > 1 || is_3d) {
            return refuse("a texture with 4 samples has one layer and one mip".into(), samples_given);
        }
        if !is_3d && layers > MAX_LAYERS {
            return refuse(format!("a texture has at most {MAX_LAYERS} layers, not {layers}"), layers_given);
        }
        if dimension == ViewDimension::Cube && (layers % 6 != 0 || edges[0].0 != edges[1].0) {
            let shape = format!("{} x {}, {}", edges[0].0, edges[1].0, amount(layers.unsigned_abs(), "layer"));
            return refuse(format!("a cube is square and has 6 layers or a multiple, not {shape}"), layers_given);
        }
        let clamp = |n: i64| u32::try_from(n).unwrap_or(u32::MAX);
        let texture = Texture {
            format: format.value,
            width: clamp(edges[0].0),
            height: clamp(edges[1].0),
            layers: clamp(layers),
            is_3d,
            mips: clamp(mips),
            samples: clamp(samples),
            usages: TextureUsages::empty(),
        };
        Ok((ObjectKind::Texture(texture), auto, causes))
    }

    /// The variable of a root input that is memory: texture, buffer, counted, table.
    pub(super) fn input_var(&mut self, name: &str, i: usize, info: Option<InputInfo>) -> Result<VarId> {
        if let Some(var) = self.input_vars.get(name) {
            return Ok(*var);
        }
        let graph = self.program.root.clone();
        let input = &graph.inputs[i];
        let counted = matches!(input.kind, InputKind::Counted);
        let kind = match (&input.kind, info) {
            (InputKind::Texture { .. }, Some(InputInfo::Texture(texture))) => ObjectKind::Texture(texture),
            (InputKind::Texture { dimension }, None) if self.stand_in => {
                ObjectKind::Texture(stand_in_texture(dimension.as_ref().map(|d| d.value)))
            }
            (InputKind::Buffer | InputKind::Counted, Some(InputInfo::Buffer { items, stride })) => {
                let mut kind = buffer(items, counted);
                if let ObjectKind::Buffer(b) = &mut kind {
                    b.stride = stride;
                }
                kind
            }
            (InputKind::Table, Some(InputInfo::Table { rows })) => buffer(rows.len() as u64, false),
            (InputKind::Buffer | InputKind::Counted | InputKind::Table, None) if self.stand_in => buffer(1000, counted),
            (kind, Some(_)) => {
                let message = format!("the input `{name}` wants {}, and is fed something else", wanted(kind));
                return Err(Box::new(fault(Code::WRONG_KIND, message, input.name.span, "declared here")));
            }
            (_, None) => return Err(self.missing_input(0, i)),
        };
        let causes = Causes { inputs: [name.to_owned()].into(), ..Causes::default() };
        let object = Object {
            path: name.to_owned(),
            kind,
            origin: Origin::Input(name.to_owned()),
            lifetime: None,
            span: input.name.span,
        };
        let building = Building { object, layout: None, mips_auto: false, adapts: self.stand_in, causes };
        let var = self.add_var(building);
        self.input_vars.insert(name.to_owned(), var);
        Ok(var)
    }

    pub(super) fn attribute_var(
        &mut self,
        input: &str,
        attribute: &str,
        count: u64,
        present: bool,
        span: Span,
    ) -> VarId {
        let path = format!("{input}.{attribute}");
        if let Some(var) = self.input_vars.get(&path) {
            return *var;
        }
        let causes = Causes { inputs: [input.to_owned()].into(), ..Causes::default() };
        let object = Object {
            path: path.clone(),
            kind: buffer(count, false),
            origin: Origin::Attribute { input: input.to_owned(), attribute: attribute.to_owned(), present },
            lifetime: None,
            span,
        };
        let var = self.add_var(Building { object, layout: None, mips_auto: false, adapts: false, causes });
        self.input_vars.insert(path, var);
        var
    }

    /// Checks that every input of a graph instance is fed by the right kind of thing.
    /// Tells whether all are.
    pub(super) fn check_inputs(&mut self, s: ScopeId) -> bool {
        let mut all_fit = true;
        let graph = self.scopes[s].graph.clone();
        for (i, input) in graph.inputs.iter().enumerate() {
            // Asking for it must not count as a use.
            let used = self.used.contains(&input.name.span);
            let fed = self.resolve(s, &input.name.value, input.name.span);
            if !used {
                self.used.remove(&input.name.span);
            }
            let Some(entity) = self.report(fed) else {
                all_fit = false;
                continue;
            };
            if self.scopes[s].parent.is_none() {
                continue;
            }
            if matches!(entity, Entity::Absent) && !input.optional {
                all_fit = false;
                let diagnostic = self.absent_fed(s, i);
                self.diagnostics.push(diagnostic);
            } else if !self.fits_input(&entity, &input.kind) {
                all_fit = false;
                let fed = self.what(&entity);
                let name = &input.name.value;
                let message = format!("the input `{name}` wants {}, and is fed {fed}", wanted(&input.kind));
                let bound = self.scopes[s].binds.get(name).map(|n| n.span);
                let at = bound.or(self.scopes[s].trace.last().copied()).unwrap_or(input.name.span);
                self.diagnostics
                    .push(fault(Code::WRONG_KIND, message, at, "fed here").see(input.name.span, "declared here"));
            }
        }
        all_fit
    }

    fn absent_fed(&self, s: ScopeId, i: usize) -> Diagnostic {
        let input = &self.scopes[s].graph.inputs[i];
        let name = &input.name.value;
        let at = self.scopes[s].trace.last().copied().unwrap_or(input.name.span);
        let message = format!("the part needs `{name}`, and what feeds it may be absent");
        fault(Code::OPTIONAL_INPUT, message, at, "used here")
            .see(input.name.span, "not optional here")
            .hint("use the part inside `If(test: \"has(...)\", then: [...])`, or make its input optional")
    }

    fn fits_input(&self, entity: &Entity, kind: &InputKind) -> bool {
        let object = match entity {
            Entity::Var(var) => Some(&self.object(self.vars[*var].now).object.kind),
            _ => None,
        };
        match (kind, entity, object) {
            (_, Entity::Absent, _) => true,
            (InputKind::Camera, Entity::Input { kind: InputKind::Camera, .. }, _)
            | (InputKind::Light, Entity::Input { kind: InputKind::Light, .. }, _)
            | (InputKind::Pointer, Entity::Input { kind: InputKind::Pointer, .. }, _)
            | (InputKind::Particles { .. }, Entity::Input { kind: InputKind::Particles { .. }, .. }, _) => true,
            // A camera or light that a shader wrote.
            (InputKind::Camera | InputKind::Light, Entity::Var(_), Some(ObjectKind::Buffer(b))) => !b.counted,
            (InputKind::Texture { dimension }, Entity::Var(_), Some(ObjectKind::Texture(texture))) => {
                dimension.as_ref().is_none_or(|d| has_dimension(texture, d.value))
            }
            (InputKind::Buffer | InputKind::Table, Entity::Var(_), Some(ObjectKind::Buffer(b))) => !b.counted,
            (InputKind::Counted, Entity::Var(_), Some(ObjectKind::Buffer(b))) => b.counted,
            _ => false,
        }
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

/// What an input wants, with its article.
fn wanted(kind: &InputKind) -> String {
    let dimension = match kind {
        InputKind::Texture { dimension: Some(d) } => match d.value {
            ViewDimension::D2 => "2D ",
            ViewDimension::D2Array => "2D array ",
            ViewDimension::Cube => "cube ",
            ViewDimension::CubeArray => "cube array ",
            ViewDimension::D3 => "3D ",
        },
        _ => "",
    };
    match kind {
        InputKind::Particles { .. } => "Particles".to_owned(),
        other => format!("a {dimension}{}", other.name()),
    }
}

/// Whether a texture can be seen so.
fn has_dimension(texture: &Texture, dimension: ViewDimension) -> bool {
    let is_square = texture.width == texture.height;
    match dimension {
        ViewDimension::D3 => texture.is_3d,
        ViewDimension::D2 => !texture.is_3d && texture.layers == 1,
        ViewDimension::D2Array => !texture.is_3d,
        ViewDimension::Cube => !texture.is_3d && texture.layers == 6 && is_square,
        ViewDimension::CubeArray => !texture.is_3d && texture.layers.is_multiple_of(6) && is_square,
    }
}

fn buffer(items: u64, counted: bool) -> ObjectKind {
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
