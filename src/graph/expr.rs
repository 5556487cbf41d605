//! Expressions: the tree. Every node has its span inside the string of the file, so that errors
//! point there.

mod parse;

pub use parse::{parse, parse_stat};

use super::value::Value;
use crate::diagnostic::Span;

/// An expression with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    Literal(Value),
    /// A dotted path: a name of the graph, a field of an input (`particles.radius`), an output
    /// of a use (`sort.start`), or one of these with a component (`grid.x`). Which one it is
    /// depends on the names around it.
    Name(String),
    /// A component of an expression that is not a path, such as `size(z).x`.
    Component(Box<Expr>, char),
    Unary(Unary, Box<Expr>),
    Binary(Binary, Box<Expr>, Box<Expr>),
    Call(Function, Vec<Expr>),
    /// `(a, b)`, `(a, b, c)` or `(a, b, c, d)`.
    Vector(Vec<Expr>),
    /// Of statistics: `buffer[3]`, with members of the item behind it.
    Item(Box<Expr>, Box<Expr>, Vec<String>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unary {
    Negate,
    Not,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    And,
    Or,
}

/// Functions of the expression language. Those from `Size` on take a name, not a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    Min,
    Max,
    Ceil,
    Floor,
    Round,
    Log2,
    CeilDiv,
    NextPow2,
    MipCount,
    Size,
    Count,
    Capacity,
    Has,
    Device,
    /// Of statistics, as are those below.
    Mean,
    Sum,
    Nans,
}

impl Function {
    /// What statistics have besides: over all items of a buffer, as `min` and `max` are there too.
    pub const OF_STATS: &'static [(&'static str, Function)] =
        &[("mean", Function::Mean), ("sum", Function::Sum), ("nans", Function::Nans)];

    pub const ALL: &'static [(&'static str, Function)] = &[
        ("min", Function::Min),
        ("max", Function::Max),
        ("ceil", Function::Ceil),
        ("floor", Function::Floor),
        ("round", Function::Round),
        ("log2", Function::Log2),
        ("ceil_div", Function::CeilDiv),
        ("next_pow2", Function::NextPow2),
        ("mip_count", Function::MipCount),
        ("size", Function::Size),
        ("count", Function::Count),
        ("capacity", Function::Capacity),
        ("has", Function::Has),
        ("device", Function::Device),
    ];

    /// Whether its argument is a name rather than a value.
    pub fn takes_name(self) -> bool {
        use Function::{Capacity, Count, Device, Has, Mean, Nans, Size, Sum};
        matches!(self, Size | Count | Capacity | Has | Device | Mean | Sum | Nans)
    }

    pub fn name(self) -> &'static str {
        Self::ALL.iter().chain(Self::OF_STATS).find(|(_, f)| *f == self).map_or("?", |(name, _)| name)
    }
}

impl Expr {
    /// Whether it, or a part of it, is such.
    pub fn any(&self, is_such: &dyn Fn(&Expr) -> bool) -> bool {
        is_such(self)
            || match &self.kind {
                ExprKind::Literal(_) | ExprKind::Name(_) => false,
                ExprKind::Component(e, _) | ExprKind::Unary(_, e) => e.any(is_such),
                ExprKind::Binary(_, a, b) | ExprKind::Item(a, b, _) => a.any(is_such) || b.any(is_such),
                ExprKind::Call(_, list) | ExprKind::Vector(list) => list.iter().any(|e| e.any(is_such)),
            }
    }

    /// Whether it asks `has(input)`, also for a field of the input.
    pub fn asks_for(&self, input: &str) -> bool {
        self.any(&|part| match &part.kind {
            ExprKind::Call(Function::Has, args) => args.iter().any(|arg| match &arg.kind {
                ExprKind::Name(path) => path.split('.').next() == Some(input),
                _ => false,
            }),
            _ => false,
        })
    }

    /// Visits every name in the expression, also those that functions take.
    pub fn names<'a>(&'a self, visit: &mut dyn FnMut(&'a str, Span)) {
        match &self.kind {
            ExprKind::Literal(_) => {}
            ExprKind::Name(name) => visit(name, self.span),
            ExprKind::Component(e, _) | ExprKind::Unary(_, e) => e.names(visit),
            ExprKind::Binary(_, a, b) | ExprKind::Item(a, b, _) => {
                a.names(visit);
                b.names(visit);
            }
            ExprKind::Call(_, list) | ExprKind::Vector(list) => list.iter().for_each(|e| e.names(visit)),
        }
    }
}
