//! Draw arguments that a shader wrote, copied to a slot of the engine's. What stands before the
//! first instance is copied; that stays 0, since nothing ever writes it.

use super::Encoding;
use crate::plan::model::{ObjectRef, Pass};

pub(super) fn encode(
    encoding: &mut Encoding<'_, '_>,
    pass: &Pass,
    from: ObjectRef,
    offset: u64,
    indexed: bool,
    slot: u32,
) {
    let Some(source) = encoding.pool.buffer(encoding.object(from)) else { return };
    let target = &encoding.fixed.arguments;
    let bytes = if indexed { 16 } else { 12 };
    encoding.between(pass, |encoder| {
        encoder.copy_buffer_to_buffer(source, offset, target, u64::from(slot) * 32, bytes);
    });
}
