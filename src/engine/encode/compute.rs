//! Dispatches. None of zero workgroups is made.

use super::Encoding;
use crate::engine::bind::DispatchVariant;
use crate::plan::model::{Dispatch, Pass};

pub(super) fn encode(encoding: &mut Encoding<'_, '_>, pass: &Pass, variant: &DispatchVariant) {
    let arguments = &encoding.fixed.arguments;
    encoding.dispatches(pass, (true, true), |compute| {
        compute.set_pipeline(&variant.pipeline);
        if variant.group.is_some() {
            compute.set_bind_group(0, variant.group.as_ref(), &[]);
        }
        match variant.dispatch {
            Dispatch::Groups([x, y, z]) if ![x, y, z].contains(&0) => compute.dispatch_workgroups(x, y, z),
            Dispatch::Groups(_) => {}
            Dispatch::Indirect { slot } => compute.dispatch_workgroups_indirect(arguments, u64::from(slot) * 32),
        }
    });
}
