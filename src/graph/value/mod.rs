//! Values of expressions and parameters.

mod vector;

use std::fmt;

pub use vector::{Number, Vector};

/// A value of the expression language. Its vectors have 2 to 4 components; matrices and rows of tables have more.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Int(i64),
    Float(f64),
    Bool(bool),
    /// A word of a `Choice`.
    Word(String),
    Vector(Vector),
}

impl Value {
    /// What messages call the kind.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Int(_) => "Int",
            Value::Float(_) => "Float",
            Value::Bool(_) => "Bool",
            Value::Word(_) => "word",
            Value::Vector(v) => match (v.get(0), v.len()) {
                (Some(Value::Int(_)), 2) => "vector of 2 Int",
                (Some(Value::Int(_)), 3) => "vector of 3 Int",
                (Some(Value::Int(_)), _) => "vector of 4 Int",
                (Some(Value::Bool(_)), _) => "vector of Bool",
                (_, 2) => "Vec2",
                (_, 3) => "Vec3",
                _ => "Vec4",
            },
        }
    }

    /// As a number, if it is a scalar number.
    pub fn as_f64(&self) -> Option<f64> {
        match self {
            Value::Int(i) => Some(*i as f64),
            Value::Float(f) => Some(*f),
            _ => None,
        }
    }

    /// As an integer, if it is one.
    pub fn as_int(&self) -> Option<i64> {
        match self {
            Value::Int(i) => Some(*i),
            _ => None,
        }
    }

    pub fn as_bool(&self) -> Option<bool> {
        match self {
            Value::Bool(b) => Some(*b),
            _ => None,
        }
    }

    /// How many components it has; a scalar is its own single component.
    pub fn component_count(&self) -> usize {
        if let Value::Vector(v) = self { v.len() } else { 1 }
    }

    /// A component as a plain number; a word is none.
    pub fn number(&self, index: usize) -> Option<Number> {
        match self {
            Value::Vector(v) => v.number(index),
            Value::Int(i) if index == 0 => Some(Number::Int(*i)),
            Value::Float(x) if index == 0 => Some(Number::Float(*x)),
            Value::Bool(b) if index == 0 => Some(Number::Bool(*b)),
            _ => None,
        }
    }

    /// Its components.
    pub fn components(&self) -> impl ExactSizeIterator<Item = Value> + Clone + '_ {
        (0..self.component_count()).map(move |index| match self {
            Value::Vector(v) => v.get(index).unwrap_or(Value::Int(0)),
            scalar => scalar.clone(),
        })
    }

    /// Its numbers, of a vector those of its components. Words and truth values are none.
    pub fn numbers(&self) -> impl Iterator<Item = f64> + Clone + '_ {
        self.components().filter_map(|component| component.as_f64())
    }

    pub fn vec(components: impl IntoIterator<Item = f64>) -> Self {
        Value::Vector(Vector::floats(components))
    }

    /// A vector of whole numbers.
    pub fn ints(components: impl IntoIterator<Item = i64>) -> Self {
        Value::Vector(Vector::ints(components))
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Int(i) => write!(f, "{i}"),
            Value::Float(x) => write!(f, "{x:?}"),
            Value::Bool(b) => write!(f, "{b}"),
            Value::Word(w) => f.write_str(w),
            Value::Vector(v) => {
                f.write_str("(")?;
                for (i, x) in v.iter().enumerate() {
                    if i > 0 {
                        f.write_str(", ")?;
                    }
                    write!(f, "{x}")?;
                }
                f.write_str(")")
            }
        }
    }
}
