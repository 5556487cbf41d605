//! Walking the pass list: parts, loops, branches, steps, and the passes that have no shader.

use super::names::{Entity, join};
use super::{FlatPass, Lowering, Place, Result, ScopeId, VarId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::model::{self as ast, Name, Node, NodeKind, Sp};
use crate::plan::model::{
    Access, Causes, ObjectId, ObjectKind, ObjectRef, Origin, Pass, PassKind, Ring, Steps, UniformValue, View,
};
use crate::shader::reflect::TextureDimension;

/// Iterations and passes that a plan may have: a frame of so many would take seconds.
const MAX_UNROLLED: u64 = 10_000;

/// What a pass is put together from.
pub(super) struct Draft {
    pub kind: PassKind,
    pub causes: Causes,
    pub accesses: Vec<(Access, Place)>,
    pub counted: Vec<(ObjectRef, crate::plan::model::ArgumentKind)>,
    pub arguments: Option<(ObjectRef, u64, bool)>,
    pub unordered: bool,
}

impl Draft {
    pub fn new(kind: PassKind) -> Self {
        let causes = Causes::default();
        Self { kind, causes, accesses: Vec::new(), counted: Vec::new(), arguments: None, unordered: false }
    }
}

/// A view with what it was asked for, before it becomes part of a pass.
pub(super) struct Viewed {
    pub view: View,
    /// Whether the author named a mip or a layer.
    pub mip_said: bool,
    pub layer_said: bool,
    pub causes: Causes,
}

impl Lowering<'_> {
    pub(super) fn nodes(&mut self, s: ScopeId, nodes: &[Node]) {
        for node in nodes {
            let result = self.node(s, node);
            self.report(result);
        }
    }

    fn node(&mut self, s: ScopeId, node: &Node) -> Result<()> {
        match &node.kind {
            NodeKind::Compute(compute) => {
                let draft = self.compute(s, compute, node)?;
                self.push(s, node, compute.name.as_ref(), &stem(&compute.shader.path.value), draft);
            }
            NodeKind::Draw(draw) | NodeKind::Fullscreen(draw) => {
                let fullscreen = matches!(node.kind, NodeKind::Fullscreen(_));
                let draft = self.draw(s, draw, node, fullscreen)?;
                self.push(s, node, draw.name.as_ref(), &stem(&draw.shader.path.value), draft);
            }
            NodeKind::Clear(clear) => {
                let draft = self.clear(s, clear)?;
                self.push(s, node, clear.name.as_ref(), &format!("clear {}", clear.of.of.value), draft);
            }
            NodeKind::Copy(copy) => {
                let draft = self.copy(s, copy)?;
                self.push(s, node, copy.name.as_ref(), &format!("copy to {}", copy.to.of.value), draft);
            }
            NodeKind::Use(used) => self.part(s, used)?,
            NodeKind::Repeat(repeat) => self.repeat(s, repeat)?,
            NodeKind::If(choice) => {
                let (taken, causes) = self.boolean(s, &choice.test)?;
                self.structure.push(causes);
                self.nodes(s, if taken { &choice.then } else { &choice.otherwise });
                self.structure.pop();
            }
            NodeKind::Steps(steps) => self.steps(s, steps, node.word)?,
        }
        Ok(())
    }

    fn part(&mut self, s: ScopeId, used: &ast::Use) -> Result<()> {
        let child = self.enter(s, used)?;
        self.used.insert(used.name.span);
        if !self.scopes[child].broken {
            let graph = self.scopes[child].graph.clone();
            self.nodes(child, &graph.passes);
        }
        Ok(())
    }

    fn repeat(&mut self, s: ScopeId, repeat: &ast::Repeat) -> Result<()> {
        let (times, causes) = self.whole(s, &repeat.times, "the number of iterations", 0)?;
        let mut swaps = Vec::new();
        for tuple in &repeat.swap {
            let vars = self.swap_vars(s, tuple);
            if let Some(vars) = self.report(vars) {
                swaps.push(vars);
            }
        }
        self.structure.push(causes);
        let outer = self.iteration.clone();
        for i in 0..times {
            self.unroll(s, repeat.times.span)?;
            self.iteration = format!("{outer}[{i}]");
            if let Some(index) = &repeat.index {
                self.scopes[s].counters.push((index.value.clone(), i));
                self.forget_lets(s);
            }
            self.nodes(s, &repeat.passes);
            if repeat.index.is_some() {
                self.scopes[s].counters.pop();
                self.forget_lets(s);
            }
            for vars in &swaps {
                self.rotate(vars);
            }
        }
        self.iteration = outer;
        self.structure.pop();
        Ok(())
    }

    /// Counts an iteration, or a pass in one: loops are unrolled, so that they must end soon.
    pub(super) fn unroll(&mut self, s: ScopeId, at: Span) -> Result<()> {
        self.unrolled += 1;
        if self.unrolled <= MAX_UNROLLED {
            return Ok(());
        }
        let message = format!("loops and parts make more than {MAX_UNROLLED} passes");
        let diagnostic = fault(Code::OUT_OF_RANGE, message, at, "still going on here")
            .hint("every iteration is a pass of its own: do more work in one dispatch, or fewer iterations");
        Err(traced(diagnostic, &self.scopes[s].trace))
    }

    /// What depends on a counter changes with it.
    fn forget_lets(&mut self, s: ScopeId) {
        let count = self.scopes[s].lets.len();
        self.scopes[s].lets = vec![super::LetState::Waiting; count];
    }

    /// After an iteration the names rotate: the first name gets what the last had.
    fn rotate(&mut self, vars: &[VarId]) {
        if let Some(last) = vars.last() {
            let mut carried = self.vars[*last].now;
            for var in vars {
                std::mem::swap(&mut self.vars[*var].now, &mut carried);
            }
        }
    }

    fn swap_vars(&mut self, s: ScopeId, tuple: &Sp<Vec<Name>>) -> Result<Vec<VarId>> {
        let mut vars = Vec::new();
        for name in &tuple.value {
            match self.resolve(s, &name.value, name.span)? {
                Entity::Var(var) => vars.push(var),
                other => {
                    let message = format!("`{}` is {} and cannot be swapped", name.value, other.what());
                    return Err(traced(
                        fault(Code::WRONG_KIND, message, name.span, "in a swap"),
                        &self.scopes[s].trace,
                    ));
                }
            }
        }
        let objects: Vec<ObjectRef> = vars.iter().map(|v| self.vars[*v].now).collect();
        let unlike = (1..vars.len()).find(|i| !self.alike(objects[0], objects[*i]));
        if let Some(i) = unlike {
            let (first, other) = (&tuple.value[0], &tuple.value[i]);
            let (a, b) = (self.describe_object(objects[0]), self.describe_object(objects[i]));
            let message = format!("`{}` and `{}` swap, and are not alike", first.value, other.value);
            let diagnostic = fault(Code::UNLIKE_SWAP, message, tuple.span, "swapped here")
                .see(self.object(objects[0]).object.span, format!("{a}{}", self.extent_of(objects[0])))
                .see(self.object(objects[i]).object.span, format!("{b}{}", self.extent_of(objects[i])))
                .hint(format!("declare one as `Like(\"{}\")`", first.value));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        self.join_swapped(s, tuple, &objects)?;
        Ok(vars)
    }

    fn extent_of(&self, object: ObjectRef) -> String {
        match &self.object(object).object.kind {
            ObjectKind::Texture(t) => format!(", {} x {}, {}", t.width, t.height, amount(t.mips, "mip")),
            ObjectKind::Buffer(b) => format!(" of {}", amount(b.items, "item")),
        }
    }

    fn alike(&self, a: ObjectRef, b: ObjectRef) -> bool {
        let (a, b) = (self.object(a), self.object(b));
        let state = |o: &Origin| matches!(o, Origin::State(_));
        let same = match (&a.object.kind, &b.object.kind) {
            (ObjectKind::Texture(x), ObjectKind::Texture(y)) => {
                (x.format, x.width, x.height, x.layers, x.is_3d, x.mips, x.samples)
                    == (y.format, y.width, y.height, y.layers, y.is_3d, y.mips, y.samples)
            }
            (ObjectKind::Buffer(x), ObjectKind::Buffer(y)) => (x.items, x.counted) == (y.items, y.counted),
            _ => false,
        };
        same && state(&a.object.origin) == state(&b.object.origin)
    }

    /// Names that swap count as one; state that swaps becomes a ring.
    fn join_swapped(&mut self, s: ScopeId, tuple: &Sp<Vec<Name>>, objects: &[ObjectRef]) -> Result<()> {
        let ids: Vec<ObjectId> = objects.iter().map(|o| self.object_id(*o)).collect();
        self.swapped.push(ids.iter().copied().collect());
        let is_state = ids.iter().any(|id| matches!(self.objects[*id].object.origin, Origin::State(_)));
        if !is_state {
            return Ok(());
        }
        let Some(steps) = self.in_steps else {
            let diagnostic = fault(Code::STATE, "state is swapped outside `Steps`", tuple.span, "swapped here")
                .hint("move the loop into the `Steps` that writes the state");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        if self
            .rings
            .iter()
            .any(|ring| ids.iter().all(|id| ring.objects.contains(id)) && ring.objects.len() == ids.len())
        {
            return Ok(());
        }
        let ring = self.rings.len();
        self.rings.push(Ring { objects: ids.clone(), turn: 0, steps });
        for var in &mut self.vars {
            if let ObjectRef::Fixed(id) = var.now
                && let Some(index) = ids.iter().position(|i| *i == id)
            {
                var.now = ObjectRef::Ring { ring, index };
            }
        }
        Ok(())
    }

    fn steps(&mut self, s: ScopeId, steps: &ast::Steps, word: Span) -> Result<()> {
        if self.in_steps.is_some() {
            let diagnostic = fault(Code::STATE, "`Steps` inside `Steps`", word, "the inner one");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let mut causes = Causes::default();
        let rate = match &steps.rate {
            Some(expr) => {
                let (rate, depends) = self.number(s, expr)?;
                causes.add(&depends);
                if rate <= 0.0 {
                    let message = format!("the rate must be above 0 Hz, and is {rate}");
                    return Err(traced(
                        fault(Code::OUT_OF_RANGE, message, expr.span, "the rate"),
                        &self.scopes[s].trace,
                    ));
                }
                Some(rate)
            }
            None => None,
        };
        let name = steps.name.as_ref().map_or("steps", |n| n.value.as_str());
        let index = self.steps.len();
        let path = join(&self.scopes[s].path, name);
        let first = self.flat.len();
        self.steps.push(Steps { path, rate, passes: first..first, key: 0, state: Vec::new() });
        let before: Vec<ObjectRef> = self.vars.iter().map(|v| v.now).collect();
        self.in_steps = Some(index);
        causes.live.insert("step".to_owned());
        self.structure.push(causes);
        self.nodes(s, &steps.passes);
        self.structure.pop();
        self.in_steps = None;
        self.steps[index].passes = first..self.flat.len();
        self.close_steps(s, index, &before, word)
    }

    /// How far each ring turned in a step, and whether anything else ended up swapped.
    fn close_steps(&mut self, s: ScopeId, index: usize, before: &[ObjectRef], word: Span) -> Result<()> {
        // A variable that was first asked for inside had the object that was made with it.
        let at_start = |v: VarId| before.get(v).copied().unwrap_or(ObjectRef::Fixed(v));
        for v in 0..self.vars.len() {
            let now = self.vars[v].now;
            match now {
                ObjectRef::Ring { ring, index: at } if self.rings[ring].steps == index => {
                    let objects = &self.rings[ring].objects;
                    let n = objects.len();
                    let home = match at_start(v) {
                        ObjectRef::Fixed(id) => objects.iter().position(|o| *o == id).unwrap_or(at),
                        ObjectRef::Ring { index, .. } => index,
                    };
                    // Name `home` now has what `at` had; the next step must start from there.
                    self.rings[ring].turn = (at + n - home) % n;
                    self.vars[v].now = ObjectRef::Ring { ring, index: home };
                }
                // What only the steps name holds nothing from one step to the next, whatever it swaps with.
                ObjectRef::Fixed(id) if v < before.len() && at_start(v) != now => {
                    let name = self.objects[id].object.path.clone();
                    let message = format!("`{name}` swaps inside `Steps` and is no state");
                    let diagnostic = fault(Code::STATE, message, word, "an odd number of swaps in a step")
                        .see(self.objects[id].object.span, "declared here")
                        .hint("declare it under `state:`");
                    return Err(traced(diagnostic, &self.scopes[s].trace));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn clear(&mut self, s: ScopeId, clear: &ast::Clear) -> Result<Draft> {
        let mut viewed = self.view(s, &clear.of)?;
        let (value, causes) = self.clear_value(s, &clear.value)?;
        viewed.causes.add(&causes);
        if let ObjectKind::Buffer(_) = &self.object(viewed.view.object).object.kind
            && value.iter().any(|v| *v != value[0])
        {
            let diagnostic = fault(Code::BAD_PASS, "a buffer clears to one value", clear.of.span, "a buffer");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let place = Place::at(clear.of.span, &clear.of.of.value, true);
        let access = whole_write(&viewed.view);
        let mut draft = Draft::new(PassKind::Clear { view: viewed.view, value });
        draft.causes = viewed.causes;
        draft.accesses.push((access, place));
        Ok(draft)
    }

    /// One value for all channels, or four.
    pub(super) fn clear_value(&mut self, s: ScopeId, value: &[crate::graph::expr::Expr]) -> Result<([f64; 4], Causes)> {
        let mut causes = Causes::default();
        let mut channels = Vec::new();
        for expr in value {
            let (value, depends) = self.known(s, expr)?;
            causes.add(&depends);
            for component in value.components() {
                match component.as_f64() {
                    Some(x) if x.is_finite() => channels.push(x),
                    _ => return Err(self.mistyped(s, expr, "a finite number", &value)),
                }
            }
        }
        match channels.as_slice() {
            [] => Ok(([0.0; 4], causes)),
            [x] => Ok(([*x; 4], causes)),
            [r, g, b] => Ok(([*r, *g, *b, 1.0], causes)),
            [r, g, b, a] => Ok(([*r, *g, *b, *a], causes)),
            _ => {
                let at = value.first().map_or(self.scopes[s].graph.span, |e| e.span);
                let message = format!("a clear value has 1, 3 or 4 numbers, not {}", channels.len());
                Err(traced(fault(Code::WRONG_VALUE, message, at, "the value"), &self.scopes[s].trace))
            }
        }
    }

    fn copy(&mut self, s: ScopeId, copy: &ast::Copy) -> Result<Draft> {
        let (from, to) = (self.view(s, &copy.from)?, self.view(s, &copy.to)?);
        let fits = match (&self.object(from.view.object).object.kind, &self.object(to.view.object).object.kind) {
            (ObjectKind::Texture(a), ObjectKind::Texture(b)) => {
                let edge = |n: u32, mip: u32| (n >> mip).max(1);
                let (m, n) = (from.view.mips.start, to.view.mips.start);
                a.format == b.format
                    && a.samples == b.samples
                    && a.is_3d == b.is_3d
                    && edge(a.width, m) == edge(b.width, n)
                    && edge(a.height, m) == edge(b.height, n)
                    && from.view.layers.len() == to.view.layers.len()
                    && from.view.mips.len() == to.view.mips.len()
            }
            (ObjectKind::Buffer(a), ObjectKind::Buffer(b)) => a.items == b.items && a.counted == b.counted,
            _ => false,
        };
        if !fits {
            let message =
                format!("`{}` and `{}` are not alike and cannot be copied", copy.from.of.value, copy.to.of.value);
            let (a, b) = (self.describe_object(from.view.object), self.describe_object(to.view.object));
            let (ea, eb) = (self.extent_of(from.view.object), self.extent_of(to.view.object));
            let diagnostic = fault(Code::BAD_PASS, message, copy.to.span, format!("{b}{eb}"))
                .see(copy.from.span, format!("{a}{ea}"));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let read = Access { read: true, write: false, whole: false, ..whole_write(&from.view) };
        let write = whole_write(&to.view);
        let mut draft = Draft::new(PassKind::Copy { from: from.view, to: to.view });
        draft.causes.add(&from.causes);
        draft.causes.add(&to.causes);
        draft.accesses.push((read, Place::at(copy.from.span, &copy.from.of.value, false)));
        draft.accesses.push((write, Place::at(copy.to.span, &copy.to.of.value, true)));
        Ok(draft)
    }

    /// A view as written: what is not said is whole.
    pub(super) fn view(&mut self, s: ScopeId, view: &ast::View) -> Result<Viewed> {
        let var = match self.resolve(s, &view.of.value, view.of.span)? {
            Entity::Var(var) => var,
            Entity::Absent => {
                return Err(self.absent_here(s, &view.of.value, view.of.span));
            }
            other => {
                let message = format!("`{}` is {}, not a texture or buffer", view.of.value, other.what());
                return Err(traced(
                    fault(Code::WRONG_KIND, message, view.of.span, "named here"),
                    &self.scopes[s].trace,
                ));
            }
        };
        let object = self.vars[var].now;
        let mut causes = Causes::default();
        let (mips, layers, dimension) = match &self.object(object).object.kind {
            ObjectKind::Texture(t) => {
                (t.mips, if t.is_3d { 1 } else { t.layers }, natural_dimension(t.is_3d, t.layers))
            }
            ObjectKind::Buffer(_) => (1, 1, TextureDimension::D2),
        };
        let mut part = |low: &mut Self, expr: &Option<crate::graph::expr::Expr>, what: &str, count: u32| match expr {
            None => Ok(0..count),
            Some(expr) => {
                let (n, depends) = low.whole(s, expr, what, 0)?;
                causes.add(&depends);
                if n >= i64::from(count) {
                    let message =
                        format!("`{}` has {}, and {what} {n} is asked for", view.of.value, amount(count, what));
                    let diagnostic = fault(Code::OUT_OF_RANGE, message, expr.span, format!("this is {n}"))
                        .hint(format!("{what}s count from 0"));
                    return Err(traced(diagnostic, &low.scopes[s].trace));
                }
                Ok(n as u32..n as u32 + 1)
            }
        };
        let mips = part(self, &view.mip, "mip", mips)?;
        let layers = part(self, &view.layer, "layer", layers)?;
        let dimension = if view.layer.is_some() { TextureDimension::D2 } else { dimension };
        causes.add(&self.object(object).causes.clone());
        Ok(Viewed {
            view: View { object, mips, layers, dimension },
            mip_said: view.mip.is_some(),
            layer_said: view.layer.is_some(),
            causes,
        })
    }

    fn push(&mut self, s: ScopeId, node: &Node, name: Option<&Name>, default: &str, draft: Draft) {
        let name = name.map_or(default, |n| n.value.as_str());
        let path = match self.scopes[s].path.as_str() {
            "" => format!("{name}{}", self.iteration),
            scope => format!("{scope}/{name}{}", self.iteration),
        };
        let mut causes = draft.causes;
        for outer in &self.structure {
            causes.add(outer);
        }
        let mut all = draft.accesses;
        // A count that decides how much runs is read, even if the shader does not see it.
        for (object, _) in &draft.counted {
            if !all.iter().any(|(access, _)| access.object == *object) {
                let access =
                    Access { object: *object, mips: 0..1, layers: 0..1, read: true, write: false, whole: false };
                let name = self.object(*object).object.path.clone();
                all.push((access, Place::at(node.word, &name, false)));
            }
        }
        let (accesses, places) = all.into_iter().unzip();
        let pass = Pass {
            path,
            span: node.span,
            unit: 0,
            steps: self.in_steps,
            kind: draft.kind,
            accesses,
            unordered: draft.unordered,
        };
        self.unrolled += 1;
        self.flat.push(FlatPass {
            pass,
            causes,
            word: node.word,
            trace: self.scopes[s].trace.clone(),
            counted: draft.counted,
            arguments: draft.arguments,
            places,
        });
    }

    /// A scalar that must be known now, with the causes kept in `causes`.
    pub(super) fn plain(&mut self, s: ScopeId, expr: &crate::graph::expr::Expr, causes: &mut Causes) -> Result<f64> {
        let (value, depends) = self.number(s, expr)?;
        causes.add(&depends);
        Ok(value)
    }
}

impl Place {
    pub(super) fn at(graph: Span, name: &str, appends: bool) -> Self {
        Self { graph, shader: None, name: name.to_owned(), samples_mips: false, appends }
    }
}

pub(super) fn whole_write(view: &View) -> Access {
    Access {
        object: view.object,
        mips: view.mips.clone(),
        layers: view.layers.clone(),
        read: false,
        write: true,
        whole: true,
    }
}

/// How a whole texture is seen if nobody says otherwise.
pub(super) fn natural_dimension(is_3d: bool, layers: u32) -> TextureDimension {
    match (is_3d, layers) {
        (true, _) => TextureDimension::D3,
        (false, 1) => TextureDimension::D2,
        (false, _) => TextureDimension::D2Array,
    }
}

/// A shader's stem: what a pass is called if nobody says otherwise.
pub(super) fn stem(path: &str) -> String {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    file.strip_suffix(".wgsl").unwrap_or(file).to_owned()
}

/// A value that messages show.
pub(super) fn shown(value: &UniformValue) -> String {
    match value {
        UniformValue::Known(value) => format!("{value} ({})", value.kind()),
        UniformValue::Live(_) => "known only while a frame runs".to_owned(),
    }
}

/// `1 mip`, `3 mips`.
pub(super) fn amount(n: impl Into<u64>, what: &str) -> String {
    let n = n.into();
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
