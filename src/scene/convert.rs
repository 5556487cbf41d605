//! Particle attributes as the bytes that a shader's type wants.

use std::borrow::Cow;

use super::particles::{Attribute, Values};
use crate::shader::reflect::{Scalar, Type};

/// A number in an item: its offset in bytes and its type.
pub type Lane = (u32, Scalar);

/// Every number of a type with its offset, in order. Empty for types that hosts cannot fill.
pub fn lanes(ty: &Type) -> Vec<Lane> {
    let mut out = Vec::new();
    collect(ty, 0, &mut out);
    out
}

fn collect(ty: &Type, offset: u32, out: &mut Vec<Lane>) {
    match ty {
        Type::Scalar(scalar) | Type::Atomic(scalar) => out.push((offset, *scalar)),
        Type::Vector { components, scalar } => {
            out.extend((0..*components).map(|i| (offset + i * scalar.size(), *scalar)));
        }
        Type::Matrix { columns, rows, scalar } => {
            let column = scalar.size() * if *rows == 2 { 2 } else { 4 };
            for c in 0..*columns {
                out.extend((0..*rows).map(|r| (offset + c * column + r * scalar.size(), *scalar)));
            }
        }
        Type::Array { element, count, stride } => {
            (0..count.unwrap_or(0)).for_each(|i| collect(element, offset + i * stride, out));
        }
        Type::Struct { members, .. } => members.iter().for_each(|m| collect(&m.ty, offset + m.offset, out)),
    }
}

/// The rows of `attribute` as items of `stride` bytes and of type `item` (absent: `f32`s); without a
/// copy if that is how they are.
///
/// # Errors
/// If the item has another number of components than the attribute; the text tells both.
pub fn rows<'a>(attribute: &'a Attribute, item: Option<&Type>, stride: u32) -> Result<Cow<'a, [u8]>, String> {
    let components = attribute.components;
    let lanes = match item {
        // An array of a type that holds fewer numbers than a row is read number by number.
        Some(ty) => repeated(lanes(ty), ty.size().max(1), components),
        None => (0..components as u32).map(|i| (i * 4, Scalar::F32)).collect(),
    };
    if lanes.len() != components || lanes.iter().any(|(_, s)| *s == Scalar::Other) {
        let wanted = item.map_or_else(|| "numbers of 32 bits".to_owned(), Type::wgsl);
        return Err(format!(
            "attribute `{}` has {components} numbers a row, which `{wanted}` cannot hold",
            attribute.name
        ));
    }
    let row = match item {
        Some(ty) => (stride as usize).max(1) * (components / self::lanes(ty).len().max(1)).max(1),
        None => components * 4,
    };
    Ok(pack(&attribute.values, components, &lanes, row))
}

fn repeated(lanes: Vec<Lane>, stride: u32, components: usize) -> Vec<Lane> {
    if lanes.is_empty() || lanes.len() >= components || !components.is_multiple_of(lanes.len()) {
        return lanes;
    }
    let times = (components / lanes.len()) as u32;
    (0..times).flat_map(|i| lanes.iter().map(move |(at, s)| (at + i * stride, *s)).collect::<Vec<_>>()).collect()
}

fn pack<'a>(values: &'a Values, components: usize, lanes: &[Lane], row: usize) -> Cow<'a, [u8]> {
    let dense = row == components * 4 && lanes.iter().enumerate().all(|(i, (at, _))| *at as usize == i * 4);
    let all = |scalar| lanes.iter().all(|(_, s)| *s == scalar);
    match values {
        Values::F32(floats) if dense && all(Scalar::F32) => Cow::Borrowed(bytemuck::cast_slice(floats)),
        Values::U32(unsigned) if dense && all(Scalar::U32) => Cow::Borrowed(bytemuck::cast_slice(unsigned)),
        Values::I32(signed) if dense && all(Scalar::I32) => Cow::Borrowed(bytemuck::cast_slice(signed)),
        _ if dense && all(Scalar::F32) => Cow::Owned(bytemuck::cast_slice(&values.to_f32()).to_vec()),
        _ if dense && all(Scalar::U32) => Cow::Owned(bytemuck::cast_slice(&values.to_u32()).to_vec()),
        _ if dense && all(Scalar::I32) => Cow::Owned(bytemuck::cast_slice(&values.to_i32()).to_vec()),
        _ => Cow::Owned(scatter(values, components, lanes, row)),
    }
}

fn scatter(values: &Values, components: usize, lanes: &[Lane], row: usize) -> Vec<u8> {
    let (floats, unsigned, signed) = (values.to_f32(), values.to_u32(), values.to_i32());
    let count = floats.len() / components.max(1);
    let mut bytes = vec![0; count * row];
    for (index, out) in bytes.chunks_exact_mut(row).enumerate() {
        for (component, (at, scalar)) in lanes.iter().enumerate() {
            let from = index * components + component;
            let at = *at as usize;
            match scalar {
                Scalar::F32 => out[at..at + 4].copy_from_slice(&floats[from].to_le_bytes()),
                Scalar::U32 => out[at..at + 4].copy_from_slice(&unsigned[from].to_le_bytes()),
                Scalar::I32 => out[at..at + 4].copy_from_slice(&signed[from].to_le_bytes()),
                Scalar::F16 => {
                    out[at..at + 2].copy_from_slice(&half::f16::from_f32(floats[from]).to_le_bytes());
                }
                Scalar::Other => {}
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::{FileId, Span};
    use crate::shader::reflect::Member;

    fn attribute(components: usize, values: Values) -> Attribute {
        Attribute { name: "x".into(), components, values }
    }

    fn packed3() -> Type {
        let member = |name: &str, offset| Member {
            name: name.into(),
            offset,
            ty: Type::Scalar(Scalar::F32),
            span: Span::new(FileId(0), 0, 0),
        };
        Type::Struct { name: "Packed3".into(), members: vec![member("x", 0), member("y", 4), member("z", 8)], size: 12 }
    }

    #[test]
    fn positions_pack_into_12_bytes_from_either_width() {
        let expected: Vec<u8> = [1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let wide = attribute(3, Values::F64(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        let narrow = attribute(3, Values::F32(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        for set in [&wide, &narrow] {
            assert_eq!(rows(set, Some(&packed3()), 12).as_deref(), Ok(&*expected));
            assert_eq!(rows(set, Some(&Type::Scalar(Scalar::F32)), 4).as_deref(), Ok(&*expected));
            assert_eq!(rows(set, None, 12).as_deref(), Ok(&*expected));
        }
    }

    #[test]
    fn whole_numbers_convert_to_the_declared_type() {
        let ids = attribute(1, Values::I64(vec![0, 7, -1, 5_000_000_000]));
        let unsigned = rows(&ids, Some(&Type::Scalar(Scalar::U32)), 4);
        assert_eq!(unsigned.as_deref(), Ok(bytemuck::cast_slice(&[0u32, 7, 0, u32::MAX])));
        let signed = rows(&ids, Some(&Type::Scalar(Scalar::I32)), 4);
        assert_eq!(signed.as_deref(), Ok(bytemuck::cast_slice(&[0i32, 7, -1, i32::MAX])));
        let floats = rows(&ids, Some(&Type::Scalar(Scalar::F32)), 4);
        assert_eq!(floats.as_deref(), Ok(bytemuck::cast_slice(&[0f32, 7.0, -1.0, 5e9])));
    }

    #[test]
    fn padding_between_items_is_zero() {
        let velocity = attribute(3, Values::F32(vec![1.0, 2.0, 3.0]));
        let wide = Type::Vector { components: 3, scalar: Scalar::F32 };
        let bytes = rows(&velocity, Some(&wide), 16).unwrap_or_default();
        assert_eq!(bytemuck::pod_collect_to_vec::<u8, f32>(&bytes), [1.0, 2.0, 3.0, 0.0]);
    }

    #[test]
    fn another_number_of_components_is_an_error() {
        let density = attribute(1, Values::F32(vec![1.0]));
        let error = rows(&density, Some(&packed3()), 12);
        assert_eq!(
            error.map(Cow::into_owned),
            Err("attribute `x` has 1 numbers a row, which `Packed3` cannot hold".into())
        );
    }
}
