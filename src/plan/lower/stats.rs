//! Statistics: what they read of buffers becomes probes, the rest is evaluated as far as it is known.

use super::names::join;
use super::{Entity, Lowering, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::eval;
use crate::graph::expr::{Expr, ExprKind, Function};
use crate::graph::value::Value;
use crate::plan::model::{Buffer, Leaf, ObjectKind, ObjectRef, Origin, Probe, ProbeKind, Stat, UniformValue};
use crate::shader::reflect::{Scalar, Type};

/// A statistic while its expression is walked.
#[derive(Default)]
struct Walk {
    probes: Vec<Probe>,
    missing: Option<String>,
}

impl Lowering<'_> {
    /// The statistics of the graph and of every part that is used, over what is there after the last pass.
    pub fn stats(&mut self) -> Vec<Stat> {
        let mut stats = Vec::new();
        for s in 0..self.scopes.len() {
            let graph = self.scopes[s].graph.clone();
            if self.scopes[s].broken {
                continue;
            }
            for stat in &graph.stats {
                let mut walk = Walk::default();
                let lowered = self.stat(s, &stat.expr, &mut walk);
                let Some(value) = self.report(lowered) else { continue };
                let path = join(&self.scopes[s].path, &stat.name.value);
                let Walk { probes, missing } = walk;
                stats.push(Stat { path, text: stat.text.clone(), value, probes, missing, span: stat.name.span });
            }
        }
        stats
    }

    fn stat(&mut self, s: ScopeId, expr: &Expr, walk: &mut Walk) -> Result<Expr> {
        let replaced = self.replace(s, expr, walk)?;
        let value = match self.scalar(s, &replaced)?.value {
            UniformValue::Live(value) => value,
            UniformValue::Known(value) => Expr { kind: ExprKind::Literal(value), span: expr.span },
        };
        let mut live: Option<(String, Span)> = None;
        value.names(&mut |name, span| {
            if live.is_none() && !name.starts_with('#') {
                live = Some((name.to_owned(), span));
            }
        });
        if let Some((name, span)) = live {
            let message =
                format!("`{name}` changes while frames run, and a statistic is over what a frame left in buffers");
            return Err(self.wrong(s, Code::WRONG_KIND, message, span, "no content of a buffer"));
        }
        // What no numbers make sense of is wrong whatever the buffers hold.
        let tried = |scale: i64| {
            eval::eval_live(&value, &|name| {
                name.strip_prefix('#')?.parse::<i64>().ok().map(|k| Value::Int(scale * k + 2 + scale))
            })
        };
        match tried(1).or_else(|| tried(3)) {
            Some(Value::Int(_) | Value::Float(_) | Value::Bool(_)) => Ok(value),
            Some(other) => {
                let message = format!("a statistic is one number, and this is a {}", other.kind());
                Err(self.wrong(s, Code::EXPRESSION_TYPE, message, expr.span, "no number"))
            }
            None => {
                let message = "the parts of this statistic do not fit together";
                Err(self.wrong(s, Code::EXPRESSION_TYPE, message, expr.span, "has no value"))
            }
        }
    }

    fn wrong(
        &self,
        s: ScopeId,
        id: Code,
        message: impl Into<String>,
        at: Span,
        label: &str,
    ) -> Box<crate::diagnostic::Diagnostic> {
        traced(fault(id, message, at, label), &self.scopes[s].trace)
    }

    /// The expression with names of probes in place of what is read of buffers.
    fn replace(&mut self, s: ScopeId, expr: &Expr, walk: &mut Walk) -> Result<Expr> {
        let kind = match &expr.kind {
            ExprKind::Item(of, index, members) => {
                let ExprKind::Name(path) = &of.kind else { return Ok(expr.clone()) };
                return self.item(s, expr.span, (path, of.span), index, members, walk);
            }
            ExprKind::Call(function, args) => {
                if let Some(probe) = self.over_all(s, *function, args, expr.span, walk)? {
                    return Ok(probe);
                }
                match function.takes_name() {
                    true => return Ok(expr.clone()),
                    false => ExprKind::Call(*function, self.replace_all(s, args, walk)?),
                }
            }
            ExprKind::Literal(_) | ExprKind::Name(_) => return Ok(expr.clone()),
            ExprKind::Component(inner, c) => ExprKind::Component(Box::new(self.replace(s, inner, walk)?), *c),
            ExprKind::Unary(op, inner) => ExprKind::Unary(*op, Box::new(self.replace(s, inner, walk)?)),
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (self.replace(s, a, walk)?, self.replace(s, b, walk)?);
                ExprKind::Binary(*op, Box::new(a), Box::new(b))
            }
            ExprKind::Vector(parts) => ExprKind::Vector(self.replace_all(s, parts, walk)?),
        };
        Ok(Expr { kind, span: expr.span })
    }

    fn replace_all(&mut self, s: ScopeId, list: &[Expr], walk: &mut Walk) -> Result<Vec<Expr>> {
        list.iter().map(|expr| self.replace(s, expr, walk)).collect()
    }

    /// `count(x)` of a counted buffer, and `min`, `max`, `mean`, `sum` and `nans` of a buffer or a member of its items.
    fn over_all(
        &mut self,
        s: ScopeId,
        function: Function,
        args: &[Expr],
        span: Span,
        walk: &mut Walk,
    ) -> Result<Option<Expr>> {
        let kind = match function {
            Function::Count => ProbeKind::Count,
            Function::Min => ProbeKind::Min,
            Function::Max => ProbeKind::Max,
            Function::Mean => ProbeKind::Mean,
            Function::Sum => ProbeKind::Sum,
            Function::Nans => ProbeKind::Nans,
            _ => return Ok(None),
        };
        let [Expr { kind: ExprKind::Name(path), span: at }] = args else { return Ok(None) };
        let found = self.buffer(s, path, *at)?;
        let Some((object, members)) = found else {
            // `min` of one scalar is that, and what `count` takes besides is known.
            return match function {
                Function::Mean | Function::Sum | Function::Nans => {
                    let message = format!("`{}` is over the items of a buffer, and `{path}` is none", function.name());
                    Err(self.wrong(s, Code::WRONG_KIND, message, *at, "no buffer"))
                }
                _ => Ok(None),
            };
        };
        let Some(buffer) = self.content(object, walk) else { return Ok(Some(probe(span, walk, None))) };
        if kind == ProbeKind::Count {
            let is_count = buffer.counted && members.is_empty();
            return Ok(is_count.then(|| probe(span, walk, Some(Probe { object, kind, leaves: Vec::new() }))));
        }
        let name = self.object(object).object.path.clone();
        let leaves = self.leaves(s, &name, *at, &buffer, &members, kind == ProbeKind::Nans)?;
        Ok(Some(probe(span, walk, Some(Probe { object, kind, leaves }))))
    }

    /// `buffer[index].member`.
    fn item(
        &mut self,
        s: ScopeId,
        span: Span,
        (path, at): (&str, Span),
        index: &Expr,
        members: &[String],
        walk: &mut Walk,
    ) -> Result<Expr> {
        let (index_value, _) = self.whole(s, index, "the index of an item", 0)?;
        let Some((object, rest)) = self.buffer(s, path, at)?.filter(|(_, rest)| rest.is_empty()) else {
            let message = format!("`{path}` is no buffer, and has no items");
            return Err(self.wrong(s, Code::WRONG_KIND, message, at, "no buffer"));
        };
        debug_assert!(rest.is_empty(), "a buffer itself");
        let Some(buffer) = self.content(object, walk) else { return Ok(probe(span, walk, None)) };
        let number = index_value as u64;
        if number >= buffer.items {
            let message = format!("`{path}` has {} items, and this is item {number}", buffer.items);
            let diagnostic = fault(Code::OUT_OF_RANGE, message, index.span, "beyond the last")
                .see(self.object(object).object.span, "declared here")
                .hint("the first item is 0");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let leaves = self.leaves(s, path, span, &buffer, members, false)?;
        Ok(probe(span, walk, Some(Probe { object, kind: ProbeKind::Item(number), leaves })))
    }

    /// The buffer that a path names, and the members behind it; nothing if it names something else.
    fn buffer(&mut self, s: ScopeId, path: &str, span: Span) -> Result<Option<(ObjectRef, Vec<String>)>> {
        let mut front = path;
        let mut members: Vec<String> = Vec::new();
        let mut first = None;
        loop {
            match self.resolve(s, front, span) {
                Ok(Entity::Var(var)) => {
                    let object = self.vars[var].now;
                    let is_buffer = matches!(self.object(object).object.kind, ObjectKind::Buffer(_));
                    return Ok(is_buffer.then_some((object, members)));
                }
                Ok(_) if members.is_empty() => return Ok(None),
                Ok(_) => return Err(first.unwrap_or_else(|| self.unknown(s, path, span))),
                Err(error) => first = first.or(Some(error)),
            }
            let Some((shorter, last)) = front.rsplit_once('.') else {
                return Err(first.unwrap_or_else(|| self.unknown(s, path, span)));
            };
            members.insert(0, last.to_owned());
            front = shorter;
        }
    }

    /// What a buffer holds after the frame; nothing, and that is kept, if no pass writes it in this plan.
    fn content(&self, object: ObjectRef, walk: &mut Walk) -> Option<Buffer> {
        let ids: Vec<_> = self.object_ids(object).collect();
        let about = &self.object(object).object;
        let ObjectKind::Buffer(buffer) = &about.kind else { return None };
        let is_written = about.origin != Origin::Frame
            || self
                .flat
                .iter()
                .flat_map(|flat| &flat.pass.accesses)
                .any(|access| access.write && self.object_ids(access.object).any(|id| ids.contains(&id)));
        if !is_written {
            walk.missing = Some(about.path.clone());
            return None;
        }
        Some(buffer.clone())
    }

    /// The numbers that a probe looks at in each item.
    fn leaves(
        &self,
        s: ScopeId,
        path: &str,
        at: Span,
        buffer: &Buffer,
        members: &[String],
        many: bool,
    ) -> Result<Vec<Leaf>> {
        let Some(item) = &buffer.item else {
            let message = format!("no shader says what an item of `{path}` is");
            return Err(self.wrong(s, Code::WRONG_KIND, message, at, "unknown items"));
        };
        let (mut offset, mut ty) = (0, item.clone());
        for member in members {
            match self::member(&ty, member) {
                Some((behind, inner)) => (offset, ty) = (offset + behind, inner),
                None => {
                    let message = format!("an item of `{path}` is `{}`, which has no member `{member}`", ty.wgsl());
                    let mut diagnostic = fault(Code::UNKNOWN_NAME, message, at, "unknown member");
                    if let Type::Struct { members, .. } = &ty {
                        diagnostic = diagnostic.nearest(member, members.iter().map(|m| &*m.name));
                    }
                    return Err(traced(diagnostic, &self.scopes[s].trace));
                }
            }
        }
        let mut leaves = Vec::new();
        spread(&ty, offset, &mut leaves);
        leaves.retain(|leaf| matches!(leaf.scalar, Scalar::F32 | Scalar::I32 | Scalar::U32));
        if leaves.is_empty() || (leaves.len() > 1 && !many) {
            let message = format!("a statistic is over numbers, and this is `{}`", ty.wgsl());
            let diagnostic = fault(Code::EXPRESSION_TYPE, message, at, "no number")
                .hint("name a member or a component: `sum(particles.mass)`, `moments[0].x`");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        Ok(leaves)
    }
}

/// The name of a new probe.
fn probe(span: Span, walk: &mut Walk, probe: Option<Probe>) -> Expr {
    let name = format!("#{}", walk.probes.len());
    walk.probes.extend(probe);
    Expr { kind: ExprKind::Name(name), span }
}

/// Where a member lies, and what it is.
fn member(ty: &Type, name: &str) -> Option<(u32, Type)> {
    match ty {
        Type::Struct { members, .. } => {
            members.iter().find(|member| *member.name == *name).map(|member| (member.offset, member.ty.clone()))
        }
        Type::Vector { components, scalar } => {
            let index = ["x", "y", "z", "w"].iter().position(|c| *c == name)? as u32;
            (index < *components).then_some((index * 4, Type::Scalar(*scalar)))
        }
        _ => None,
    }
}

/// Every number in a type, up to so many as anybody looks at.
fn spread(ty: &Type, offset: u32, leaves: &mut Vec<Leaf>) {
    const MOST: usize = 256;
    if leaves.len() >= MOST {
        return;
    }
    match ty {
        Type::Scalar(scalar) | Type::Atomic(scalar) => leaves.push(Leaf { offset, scalar: *scalar }),
        Type::Vector { components, scalar } => {
            leaves.extend((0..*components).map(|i| Leaf { offset: offset + i * 4, scalar: *scalar }));
        }
        Type::Matrix { columns, rows, scalar } => {
            // Columns of three are as far apart as those of four.
            let stride = if *rows == 2 { 8 } else { 16 };
            for column in 0..*columns {
                leaves
                    .extend((0..*rows).map(|row| Leaf { offset: offset + column * stride + row * 4, scalar: *scalar }));
            }
        }
        Type::Array { element, count, stride } => {
            (0..count.unwrap_or(0).min(MOST as u32)).for_each(|i| spread(element, offset + i * stride, leaves));
        }
        Type::Struct { members, .. } => members.iter().for_each(|m| spread(&m.ty, offset + m.offset, leaves)),
    }
}
