//! Components of one kind, in place: what cameras and lights say is asked for in every frame, and
//! a vector that lay on the heap would cost an allocation each time.

use std::fmt;

use super::Value;

/// As many as a matrix of 4 by 4 has.
const IN_PLACE: usize = 16;

/// Numbers or truth values, all of one kind. Up to 16 lie in the value itself.
#[derive(Clone)]
pub struct Vector {
    kind: Kind,
    parts: Parts,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Int,
    Float,
    Bool,
}

/// A component by itself, a word of the machine wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    Int(i64),
    Float(f64),
    Bool(bool),
}

/// The bits of each component.
#[derive(Clone)]
enum Parts {
    Few([u64; IN_PLACE], u8),
    Many(Vec<u64>),
}

impl Vector {
    fn empty(kind: Kind) -> Self {
        Self { kind, parts: Parts::Few([0; IN_PLACE], 0) }
    }

    pub fn floats(components: impl IntoIterator<Item = f64>) -> Self {
        let mut vector = Self::empty(Kind::Float);
        components.into_iter().for_each(|x| vector.push_bits(x.to_bits()));
        vector
    }

    pub fn ints(components: impl IntoIterator<Item = i64>) -> Self {
        let mut vector = Self::empty(Kind::Int);
        components.into_iter().for_each(|i| vector.push_bits(i as u64));
        vector
    }

    /// Of scalars: Int among Float becomes Float; `None` if they are no numbers and not all Bool.
    pub fn of(components: impl IntoIterator<Item = Value>) -> Option<Self> {
        let mut vector = Self::empty(Kind::Int);
        for component in components {
            vector.push(&component)?;
        }
        Some(vector)
    }

    /// Adds a scalar; `None` if it does not go with those that are there.
    pub fn push(&mut self, component: &Value) -> Option<()> {
        let (kind, bits) = bits(component)?;
        match (self.kind, kind) {
            (now, kind) if now == kind => self.push_bits(bits),
            _ if self.is_empty() => {
                self.kind = kind;
                self.push_bits(bits);
            }
            (Kind::Int, Kind::Float) => {
                self.bits_mut().iter_mut().for_each(|bits| *bits = (*bits as i64 as f64).to_bits());
                self.kind = Kind::Float;
                self.push_bits(bits);
            }
            (Kind::Float, Kind::Int) => self.push_bits((bits as i64 as f64).to_bits()),
            _ => return None,
        }
        Some(())
    }

    fn push_bits(&mut self, bits: u64) {
        match &mut self.parts {
            Parts::Few(few, count) if usize::from(*count) < IN_PLACE => {
                few[usize::from(*count)] = bits;
                *count += 1;
            }
            Parts::Few(few, _) => {
                let mut many = few.to_vec();
                many.push(bits);
                self.parts = Parts::Many(many);
            }
            Parts::Many(many) => many.push(bits),
        }
    }

    fn bits(&self) -> &[u64] {
        match &self.parts {
            Parts::Few(few, count) => &few[..usize::from(*count)],
            Parts::Many(many) => many,
        }
    }

    fn bits_mut(&mut self) -> &mut [u64] {
        match &mut self.parts {
            Parts::Few(few, count) => &mut few[..usize::from(*count)],
            Parts::Many(many) => many,
        }
    }

    pub fn len(&self) -> usize {
        self.bits().len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A component, as the scalar that it is.
    pub fn get(&self, index: usize) -> Option<Value> {
        self.bits().get(index).map(|bits| scalar(self.kind, *bits))
    }

    /// The same for those who read many, as cameras are packed in every frame.
    pub fn number(&self, index: usize) -> Option<Number> {
        let bits = *self.bits().get(index)?;
        Some(match self.kind {
            Kind::Int => Number::Int(bits as i64),
            Kind::Float => Number::Float(f64::from_bits(bits)),
            Kind::Bool => Number::Bool(bits != 0),
        })
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = Value> + Clone + '_ {
        self.bits().iter().map(|bits| scalar(self.kind, *bits))
    }

    /// Whether both have the same bits: 0 is not -0 here, and a NaN is itself.
    pub fn has_bits_of(&self, other: &Self) -> bool {
        self.kind == other.kind && self.bits() == other.bits()
    }
}

impl Default for Vector {
    fn default() -> Self {
        Self::empty(Kind::Int)
    }
}

fn scalar(kind: Kind, bits: u64) -> Value {
    match kind {
        Kind::Int => Value::Int(bits as i64),
        Kind::Float => Value::Float(f64::from_bits(bits)),
        Kind::Bool => Value::Bool(bits != 0),
    }
}

fn bits(value: &Value) -> Option<(Kind, u64)> {
    match value {
        Value::Int(i) => Some((Kind::Int, *i as u64)),
        Value::Float(x) => Some((Kind::Float, x.to_bits())),
        Value::Bool(b) => Some((Kind::Bool, u64::from(*b))),
        Value::Word(_) | Value::Vector(_) => None,
    }
}

/// As its components are: 0 is -0, and a NaN equals nothing.
impl PartialEq for Vector {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind && self.len() == other.len() && self.iter().eq(other.iter())
    }
}

impl fmt::Debug for Vector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_of_one_kind() {
        let of = |parts: &[Value]| Vector::of(parts.iter().cloned());
        let mixed = of(&[Value::Int(1), Value::Float(0.5), Value::Int(-3)]);
        assert_eq!(mixed, Some(Vector::floats([1.0, 0.5, -3.0])));
        assert_eq!(of(&[Value::Int(1), Value::Int(-2)]), Some(Vector::ints([1, -2])));
        assert_ne!(Vector::ints([1]), Vector::floats([1.0]));
        assert_eq!(of(&[Value::Bool(true), Value::Int(1)]), None);
        assert_eq!(of(&[Value::Word("x".into())]), None);
        let truths: Vec<Value> = of(&[Value::Bool(true), Value::Bool(false)]).iter().flat_map(Vector::iter).collect();
        assert_eq!(truths, [Value::Bool(true), Value::Bool(false)]);
    }

    #[test]
    fn many_components_are_kept_too() {
        let numbers = || (0..40).map(|i| f64::from(i) / 2.0);
        let many = Vector::floats(numbers());
        assert_eq!(many.len(), 40);
        assert!(many.iter().eq(numbers().map(Value::Float)));
        assert_eq!(many.get(39), Some(Value::Float(19.5)));
        assert_eq!(many.get(40), None);
    }

    #[test]
    fn bits_are_more_than_values() {
        let (zero, minus, nan) = (Vector::floats([0.0]), Vector::floats([-0.0]), Vector::floats([f64::NAN]));
        assert!(zero == minus && !zero.has_bits_of(&minus));
        assert!(nan != nan.clone() && nan.has_bits_of(&nan.clone()));
    }
}
