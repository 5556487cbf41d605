//! Columns of numbers in the width that a file has.

use super::error::{ReadError, counted};
use super::parallel;

/// Which way round the bytes of a number lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    Big,
    Little,
}

/// Where a column lies in rows of bytes: the first byte in a row, the bytes of a row, and the
/// numbers that each row holds of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub start: usize,
    pub stride: usize,
    pub components: usize,
}

/// A number type that files store.
pub(super) trait Number: Copy + Default + PartialEq + Send {
    const SIZE: usize;
    /// Writes the numbers of `bytes` over `out`, as many as there are of both.
    fn fill(out: &mut [Self], bytes: &[u8], order: Order);
    /// Appends all whole numbers that `bytes` holds.
    fn extend(out: &mut Vec<Self>, bytes: &[u8], order: Order);
    fn from_text(word: &str) -> Option<Self>;
    /// The nearest that the type has.
    fn from_whole(number: i64) -> Self;
    fn as_f64(self) -> f64;
    fn as_f32(self) -> f32;
    fn as_i32(self) -> i32;
    fn as_u32(self) -> u32;

    /// A column out of `rows` rows of bytes; `bytes` must hold them.
    fn gather(bytes: &[u8], layout: Layout, rows: usize, order: Order) -> Vec<Self> {
        let Layout { start, stride, components } = layout;
        let is_dense = start == 0 && stride == components * Self::SIZE;
        parallel::filled(rows, components, |first, out: &mut [Self]| {
            let bytes = bytes.get(first * stride..).unwrap_or_default();
            match components {
                _ if is_dense => Self::fill(out, bytes, order),
                _ if stride == 0 => {}
                1 => Self::pick::<1>(out, bytes, layout, order),
                3 => Self::pick::<3>(out, bytes, layout, order),
                _ => {
                    for (out, row) in out.chunks_exact_mut(components.max(1)).zip(bytes.chunks_exact(stride)) {
                        Self::fill(out, row.get(start..).unwrap_or_default(), order);
                    }
                }
            }
        })
    }

    /// `N` numbers out of each row: a loop of known length, several times as fast as one that is not.
    fn pick<const N: usize>(out: &mut [Self], bytes: &[u8], layout: Layout, order: Order) {
        for (out, row) in out.as_chunks_mut::<N>().0.iter_mut().zip(bytes.chunks_exact(layout.stride)) {
            let cell = row.get(layout.start..layout.start + N * Self::SIZE).unwrap_or_default();
            Self::fill(out, cell, order);
        }
    }
}

macro_rules! bytes_of {
    ($type:ty) => {
        const SIZE: usize = size_of::<$type>();
        fn fill(out: &mut [Self], bytes: &[u8], order: Order) {
            let (numbers, _) = bytes.as_chunks();
            match order {
                Order::Big => out.iter_mut().zip(numbers).for_each(|(out, n)| *out = <$type>::from_be_bytes(*n)),
                Order::Little => out.iter_mut().zip(numbers).for_each(|(out, n)| *out = <$type>::from_le_bytes(*n)),
            }
        }
        fn extend(out: &mut Vec<Self>, bytes: &[u8], order: Order) {
            let (numbers, _) = bytes.as_chunks();
            match order {
                Order::Big => out.extend(numbers.iter().map(|n| <$type>::from_be_bytes(*n))),
                Order::Little => out.extend(numbers.iter().map(|n| <$type>::from_le_bytes(*n))),
            }
        }
        fn as_f64(self) -> f64 {
            self as f64
        }
        fn as_f32(self) -> f32 {
            self as f32
        }
    };
}

macro_rules! float {
    ($type:ty) => {
        impl Number for $type {
            bytes_of!($type);
            fn from_text(word: &str) -> Option<Self> {
                word.parse().ok().or_else(|| unusual_float(word).map(|v| v as $type))
            }
            fn from_whole(number: i64) -> Self {
                number as $type
            }
            // `as` between a float and an integer takes the nearest value that the type has.
            fn as_i32(self) -> i32 {
                self as i32
            }
            fn as_u32(self) -> u32 {
                self as u32
            }
        }
    };
}

macro_rules! integer {
    ($($type:ty)*) => { $(
        impl Number for $type {
            bytes_of!($type);
            fn from_text(word: &str) -> Option<Self> {
                word.parse().ok()
            }
            // `as` from a wider integer to a narrower one would take its low bits.
            fn from_whole(number: i64) -> Self {
                i128::from(number).clamp(<$type>::MIN.into(), <$type>::MAX.into()) as $type
            }
            fn as_i32(self) -> i32 {
                i128::from(self).clamp(i32::MIN.into(), i32::MAX.into()) as i32
            }
            fn as_u32(self) -> u32 {
                i128::from(self).clamp(0, u32::MAX.into()) as u32
            }
        }
    )* };
}

float!(f32);
float!(f64);
integer!(i8 u8 i16 u16 i32 u32 i64 u64);

/// The ways in which C libraries print what is not a number, beyond those that Rust reads.
fn unusual_float(word: &str) -> Option<f64> {
    let bare = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    let negative = if word.starts_with('-') { -1.0 } else { 1.0 };
    if bare.starts_with("nan") || bare.starts_with("1.#qnan") || bare.starts_with("1.#ind") {
        return Some(f64::NAN);
    }
    bare.starts_with("1.#inf").then_some(f64::INFINITY * negative)
}

macro_rules! kinds {
    ($($(#[doc = $doc:literal])* $kind:ident $type:ident $name:literal,)*) => {
        /// The type of an attribute's numbers.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Kind { $($(#[doc = $doc])* $kind,)* }

        /// The values of one attribute, row after row, in the width that the file has.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Values { $($kind(Vec<$type>),)* }

        impl Kind {
            /// Bytes of one number.
            pub fn size(self) -> usize {
                match self { $(Self::$kind => size_of::<$type>(),)* }
            }

            /// The type's name as Rust writes it.
            pub fn name(self) -> &'static str {
                match self { $(Self::$kind => $name,)* }
            }
        }

        impl Values {
            pub fn kind(&self) -> Kind {
                match self { $(Self::$kind(_) => Kind::$kind,)* }
            }

            pub(super) fn empty(kind: Kind) -> Self {
                match kind { $(Kind::$kind => Self::$kind(Vec::new()),)* }
            }

            /// A column out of rows of bytes that the caller has counted.
            pub(super) fn gather(kind: Kind, bytes: &[u8], layout: Layout, rows: usize, order: Order) -> Self {
                match kind { $(Kind::$kind => Self::$kind(<$type>::gather(bytes, layout, rows, order)),)* }
            }

            /// Appends the numbers of `bytes`, which are of this kind.
            pub(super) fn extend(&mut self, bytes: &[u8], order: Order) {
                match self { $(Self::$kind(v) => <$type>::extend(v, bytes, order),)* }
            }

            /// Appends one number written as text; false if it is none of this kind.
            pub(super) fn push_text(&mut self, word: &[u8]) -> bool {
                let Ok(word) = std::str::from_utf8(word) else { return false };
                match self {
                    $(Self::$kind(v) => match <$type>::from_text(word) {
                        Some(number) => { v.push(number); true }
                        None => false,
                    },)*
                }
            }

            /// Appends a number of another type, as near as this one can be to it.
            pub(super) fn push_whole(&mut self, number: i64) {
                match self { $(Self::$kind(v) => v.push(<$type>::from_whole(number)),)* }
            }

            /// See [`Values::push_whole`].
            pub(super) fn push_real(&mut self, number: f64) {
                match self { $(Self::$kind(v) => v.push(number as $type),)* }
            }

            /// Appends numbers `start..start + count` of `other`, which is of this kind and has them.
            pub(super) fn push_part(&mut self, other: &Self, start: usize, count: usize) {
                match (self, other) {
                    $((Self::$kind(all), Self::$kind(more)) => {
                        all.extend_from_slice(more.get(start..start + count).unwrap_or_default());
                    })*
                    _ => {}
                }
            }

            /// Keeps the rows for which `keep` is true.
            pub(super) fn retain_rows(&mut self, keep: &[bool], components: usize) {
                match self { $(Self::$kind(v) => retain_rows(v, keep, components),)* }
            }

            /// Appends `other`; gives it back if its kind is another.
            pub(super) fn append(&mut self, other: Self) -> Result<(), Self> {
                match (self, other) {
                    $((Self::$kind(all), Self::$kind(mut more)) => { all.append(&mut more); Ok(()) })*
                    (_, other) => Err(other),
                }
            }
        }

        /// Runs an expression for the vector that `Values` holds.
        macro_rules! with_vector {
            ($values:expr, $v:ident => $body:expr) => {
                match $values { $(Values::$kind($v) => $body,)* }
            };
        }
    };
}

kinds! {
    F32 f32 "f32",
    F64 f64 "f64",
    I8 i8 "i8",
    U8 u8 "u8",
    I16 i16 "i16",
    U16 u16 "u16",
    I32 i32 "i32",
    U32 u32 "u32",
    I64 i64 "i64",
    U64 u64 "u64",
}

impl Kind {
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// Bytes of `rows` rows of `components` numbers.
    pub(super) fn bytes(self, rows: usize, components: usize) -> Result<usize, ReadError> {
        rows.checked_mul(components).and_then(|n| n.checked_mul(self.size())).ok_or_else(|| {
            ReadError::new(format!("{} of {components} numbers are more than a file can hold", counted(rows, "row")))
        })
    }
}

impl Values {
    /// A number for each of `count` bits, the highest of a byte first; `bytes` has them.
    pub(super) fn from_bits(bytes: &[u8], count: usize) -> Self {
        let bits = bytes.iter().flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1));
        Self::U8(bits.take(count).collect())
    }

    /// Numbers, not rows.
    pub fn len(&self) -> usize {
        with_vector!(self, v => v.len())
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers as `f64`, exact but for 64-bit integers beyond 2^53.
    pub fn to_f64(&self) -> Vec<f64> {
        with_vector!(self, v => v.iter().map(|n| n.as_f64()).collect())
    }

    /// The numbers as `f32`, each rounded to the nearest; nothing is normalised.
    pub fn to_f32(&self) -> Vec<f32> {
        with_vector!(self, v => v.iter().map(|n| n.as_f32()).collect())
    }

    /// The numbers as `i32`: fractions are cut off, what is out of range becomes the nearest
    /// value in range, NaN becomes 0.
    pub fn to_i32(&self) -> Vec<i32> {
        with_vector!(self, v => v.iter().map(|n| n.as_i32()).collect())
    }

    /// The numbers as `u32`, in the way of [`Values::to_i32`].
    pub fn to_u32(&self) -> Vec<u32> {
        with_vector!(self, v => v.iter().map(|n| n.as_u32()).collect())
    }

    /// The value that all numbers have, if they have one.
    pub(super) fn uniform(&self) -> Option<f64> {
        with_vector!(self, v => match v.split_first() {
            Some((first, rest)) if rest.iter().all(|n| n == first) => Some(first.as_f64()),
            _ => None,
        })
    }

    /// One column of rows out of columns of single numbers. Columns of unlike kinds meet as `f64`.
    pub(super) fn interleave(mut columns: Vec<Self>) -> Self {
        if columns.len() == 1 {
            return columns.remove(0);
        }
        let Some(kind) = columns.first().map(Self::kind) else { return Self::F64(Vec::new()) };
        if columns.iter().any(|c| c.kind() != kind) {
            columns = columns.iter().map(|c| Self::F64(c.to_f64())).collect();
        }
        let widths = vec![1; columns.len()];
        Self::weave(&columns, &widths)
    }

    /// One column of rows out of columns of one kind, each with its width of numbers in a row.
    pub(super) fn weave(columns: &[Self], widths: &[usize]) -> Self {
        let Some(kind) = columns.first().map(Self::kind) else { return Self::F64(Vec::new()) };
        if let [only] = columns {
            return only.clone();
        }
        let rows = columns.iter().zip(widths).map(|(c, &width)| c.len() / width.max(1)).min().unwrap_or(0);
        let mut woven = Self::empty(kind);
        for row in 0..rows {
            for (column, &width) in columns.iter().zip(widths) {
                woven.push_part(column, row * width, width);
            }
        }
        woven
    }
}

fn retain_rows<T>(values: &mut Vec<T>, keep: &[bool], components: usize) {
    let mut number = 0;
    values.retain(|_| {
        let row = number / components.max(1);
        number += 1;
        keep.get(row).copied().unwrap_or(false)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_another_type_becomes_the_nearest() {
        let pushed = |kind: Kind| {
            let mut values = Values::empty(kind);
            [300, -300, i64::MAX, i64::MIN, 7].into_iter().for_each(|whole| values.push_whole(whole));
            [300.5, -300.5, f64::INFINITY].into_iter().for_each(|real| values.push_real(real));
            values
        };
        assert_eq!(pushed(Kind::U8), Values::U8(vec![255, 0, 255, 0, 7, 255, 0, 255]));
        assert_eq!(pushed(Kind::I8), Values::I8(vec![127, -128, 127, -128, 7, 127, -128, 127]));
        let (min, max) = (i32::MIN, i32::MAX);
        assert_eq!(pushed(Kind::I32), Values::I32(vec![300, -300, max, min, 7, 300, -300, max]));
        assert_eq!(pushed(Kind::U64).len(), 8);
        let floats = vec![300.0, -300.0, i64::MAX as f64, i64::MIN as f64, 7.0, 300.5, -300.5, f64::INFINITY];
        assert_eq!(pushed(Kind::F64), Values::F64(floats));
    }
}
