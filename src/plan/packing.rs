//! Values as bytes of WGSL types, for uniforms and tables. No GPU here.

use std::ops::Range;

use crate::graph::rows::Row;
use crate::graph::value::{Number, Value, Vector};
use crate::shader::reflect::{Scalar, Type};

/// Writes a value as a type has it in memory, at the start of `out`.
///
/// Numbers convert to the scalar asked for if nothing is lost (a whole Int to `f32`, a Bool to
/// 0 or 1), 3 components fill a vector of 4 with 1 (a colour's alpha), and a matrix takes its
/// components column by column.
///
/// # Errors
/// A message that says what was expected and what was found.
pub fn encode(value: &Value, ty: &Type, out: &mut [u8]) -> Result<(), String> {
    if out.len() < ty.size() as usize {
        return Err(format!("{} needs {} bytes, there are {}", ty.wgsl(), ty.size(), out.len()));
    }
    let mismatch = || format!("expected a value for {}, found {} {value}", ty.wgsl(), value.kind());
    let all = 0..value.component_count();
    match ty {
        Type::Scalar(_) | Type::Atomic(_) if matches!(value, Value::Vector(_)) => Err(mismatch()),
        Type::Scalar(scalar) | Type::Atomic(scalar) => scalar_bytes(value.number(0), *scalar, out).ok_or_else(mismatch),
        Type::Vector { components, scalar } => vector(value, all, *components, *scalar, out).ok_or_else(mismatch),
        Type::Matrix { columns, rows, scalar } => matrix(value, *columns, *rows, *scalar, out).ok_or_else(mismatch),
        Type::Array { element, count: Some(count), stride } => {
            let mut parts = value.components();
            let width = parts.len() / (*count).max(1) as usize;
            if width == 0 || width * *count as usize != parts.len() {
                return Err(mismatch());
            }
            for place in out.chunks_mut((*stride).max(1) as usize).take(*count as usize) {
                let part =
                    if width == 1 { parts.next() } else { Vector::of(parts.by_ref().take(width)).map(Value::Vector) };
                encode(&part.ok_or_else(mismatch)?, element, place)?;
            }
            Ok(())
        }
        Type::Array { count: None, .. } | Type::Struct { .. } => Err(mismatch()),
    }
}

/// Rows of named values as items of a struct.
///
/// # Errors
/// A message that says which row lacks what, or has too much.
pub fn rows(rows: &[Row], item: Option<&Type>, stride: u32) -> Result<Vec<u8>, String> {
    let Some(Type::Struct { name, members, .. }) = item else {
        return Err("a table feeds a buffer of structs, whose members its values are named after".into());
    };
    let mut bytes = vec![0; rows.len() * stride as usize];
    for (index, (row, out)) in rows.iter().zip(bytes.chunks_exact_mut(stride.max(1) as usize)).enumerate() {
        for member in members {
            let value =
                row.get(&*member.name).ok_or_else(|| format!("row {index} lacks `{}` of `{name}`", member.name))?;
            let place = out.get_mut(member.offset as usize..).unwrap_or_default();
            encode(value, &member.ty, place).map_err(|why| format!("row {index}, `{}`: {why}", member.name))?;
        }
        if let Some(other) = row.keys().find(|key| members.iter().all(|m| *m.name != ***key)) {
            return Err(format!("row {index} has `{other}`, which `{name}` has not"));
        }
    }
    Ok(bytes)
}

/// A range of components as a vector.
fn vector(value: &Value, parts: Range<usize>, components: u32, scalar: Scalar, out: &mut [u8]) -> Option<()> {
    let opaque = (parts.len() == 3 && components == 4).then_some(Number::Int(1));
    if opaque.is_none() && parts.len() != components as usize {
        return None;
    }
    let mut places = out.chunks_mut(scalar.size() as usize);
    for index in parts {
        scalar_bytes(value.number(index), scalar, places.next()?)?;
    }
    if opaque.is_some() { scalar_bytes(opaque, scalar, places.next()?) } else { Some(()) }
}

fn matrix(value: &Value, columns: u32, rows: u32, scalar: Scalar, out: &mut [u8]) -> Option<()> {
    if value.component_count() != (columns * rows) as usize {
        return None;
    }
    let stride = scalar.size() as usize * if rows == 2 { 2 } else { 4 };
    for (column, place) in out.chunks_mut(stride).take(columns as usize).enumerate() {
        let first = column * rows as usize;
        vector(value, first..first + rows as usize, rows, scalar, place)?;
    }
    Some(())
}

fn scalar_bytes(number: Option<Number>, scalar: Scalar, out: &mut [u8]) -> Option<()> {
    let number = number?;
    let bytes: [u8; 4] = match scalar {
        Scalar::F32 => (real(number) as f32).to_le_bytes(),
        Scalar::I32 => i32::try_from(whole(number)?).ok()?.to_le_bytes(),
        Scalar::U32 => u32::try_from(whole(number)?).ok()?.to_le_bytes(),
        Scalar::F16 => {
            let half = half::f16::from_f64(real(number)).to_le_bytes();
            out.get_mut(..2)?.copy_from_slice(&half);
            return Some(());
        }
        Scalar::Other => return None,
    };
    out.get_mut(..4)?.copy_from_slice(&bytes);
    Some(())
}

fn real(number: Number) -> f64 {
    match number {
        Number::Int(i) => i as f64,
        Number::Float(x) => x,
        Number::Bool(b) => f64::from(u8::from(b)),
    }
}

fn whole(number: Number) -> Option<i64> {
    match number {
        Number::Int(i) => Some(i),
        Number::Bool(b) => Some(i64::from(b)),
        // Counts and indices that came through a division, when nothing is lost.
        Number::Float(x) if x.fract() == 0.0 && x.abs() < 9e15 => Some(x as i64),
        Number::Float(_) => None,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
    use super::*;

    fn floats(bytes: &[u8]) -> Vec<f32> {
        bytes.chunks(4).map(|c| f32::from_le_bytes(c.try_into().unwrap())).collect()
    }

    fn encoded(value: &Value, ty: &Type) -> Vec<u8> {
        let mut out = vec![0xaa; ty.size() as usize];
        encode(value, ty, &mut out).unwrap();
        out
    }

    #[test]
    fn scalars_convert_when_nothing_is_lost() {
        assert_eq!(floats(&encoded(&Value::Int(3), &Type::Scalar(Scalar::F32))), [3.0]);
        assert_eq!(encoded(&Value::Bool(true), &Type::Scalar(Scalar::U32)), 1u32.to_le_bytes());
        assert_eq!(encoded(&Value::Int(-2), &Type::Scalar(Scalar::I32)), (-2i32).to_le_bytes());
        assert_eq!(encoded(&Value::Float(0.5), &Type::Scalar(Scalar::F16)), [0x00, 0x38]);
        let mut out = [0; 4];
        assert!(encode(&Value::Int(-1), &Type::Scalar(Scalar::U32), &mut out).is_err());
        assert!(encode(&Value::Float(0.5), &Type::Scalar(Scalar::I32), &mut out).is_err());
        assert!(encode(&Value::Word("x".into()), &Type::Scalar(Scalar::F32), &mut out).is_err());
    }

    #[test]
    fn a_color_of_three_gets_alpha_one() {
        let four = Type::Vector { components: 4, scalar: Scalar::F32 };
        assert_eq!(floats(&encoded(&Value::vec([0.1, 0.2, 0.3]), &four)), [0.1, 0.2, 0.3, 1.0]);
        let two = Type::Vector { components: 2, scalar: Scalar::F32 };
        assert!(encode(&Value::vec([0.1, 0.2, 0.3]), &two, &mut [0; 8]).is_err());
    }

    #[test]
    fn matrices_are_padded_by_columns() {
        let ty = Type::Matrix { columns: 3, rows: 3, scalar: Scalar::F32 };
        let mut out = vec![0; ty.size() as usize];
        encode(&Value::vec((0..9).map(f64::from)), &ty, &mut out).unwrap();
        assert_eq!(floats(&out), [0.0, 1.0, 2.0, 0.0, 3.0, 4.0, 5.0, 0.0, 6.0, 7.0, 8.0, 0.0]);
    }

    #[test]
    fn arrays_are_spread_by_their_stride() {
        let element = Box::new(Type::Vector { components: 2, scalar: Scalar::F32 });
        let ty = Type::Array { element, count: Some(2), stride: 16 };
        let mut out = vec![0; ty.size() as usize];
        encode(&Value::vec([1.0, 2.0, 3.0, 4.0]), &ty, &mut out).unwrap();
        assert_eq!(floats(&out), [1.0, 2.0, 0.0, 0.0, 3.0, 4.0, 0.0, 0.0]);
    }
}
