//! Walking the pass list: parts, loops, branches.

use super::{CauseSet, FlatPass, LetState, Lowering, Place, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::model::{self as ast, Name, Node, NodeKind};
use crate::plan::model::{Access, ObjectRef, Pass, PassKind, UniformValue};

/// Iterations and passes that a plan may have: a frame of so many would take seconds.
const MAX_UNROLLED: u64 = 10_000;

/// What a pass is put together from.
pub(super) struct Draft {
    pub kind: PassKind,
    pub causes: CauseSet,
    pub accesses: Vec<(Access, Place)>,
    pub counted: Vec<(ObjectRef, crate::plan::model::ArgumentKind)>,
    pub arguments: Option<(ObjectRef, u64, bool)>,
    pub unordered: bool,
}

impl Draft {
    pub fn new(kind: PassKind) -> Self {
        let causes = CauseSet::default();
        Self { kind, causes, accesses: Vec::new(), counted: Vec::new(), arguments: None, unordered: false }
    }
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
    pub(super) fn forget_lets(&mut self, s: ScopeId) {
        for value in &mut self.scopes[s].lets {
            if matches!(value, LetState::Known { counts: true, .. }) {
                *value = LetState::Waiting;
            }
        }
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
        if !draft.counted.is_empty() || draft.arguments.is_some() {
            // As many threads as were counted write as much: what was there before may show behind it.
            all.iter_mut().filter(|(_, place)| place.shader.is_some()).for_each(|(access, _)| access.whole = false);
        }
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
    pub(super) fn plain(&mut self, s: ScopeId, expr: &crate::graph::expr::Expr, causes: &mut CauseSet) -> Result<f64> {
        let (value, depends) = self.number(s, expr)?;
        causes.add(&depends);
        Ok(value)
    }
}

impl Place {
    pub(super) fn at(graph: Span, name: &str, appends: bool) -> Self {
        Self { graph, shader: None, name: name.into(), samples_mips: false, appends }
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
