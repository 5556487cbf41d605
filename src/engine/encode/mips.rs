//! Mips, each layer from level to level.

use wgpu_types as wgt;

use super::{Encoding, compute_pipeline, render_pipeline};
use crate::engine::mips::{MipInto, MipStep};
use crate::engine::pipeline::Pipeline;
use crate::plan::model::Pass;

pub(super) fn encode(encoding: &mut Encoding<'_, '_>, pass: &Pass, pipeline: Option<&Pipeline>, steps: &[MipStep]) {
    for (at, step) in steps.iter().enumerate() {
        let (first, last) = (at == 0, at + 1 == steps.len());
        match &step.into {
            MipInto::Target(view) => {
                let Some(pipeline) = render_pipeline(pipeline) else { return };
                // Every texel is written, what was there does not matter.
                let ops = wgt::Operations { load: wgt::LoadOp::Load, store: wgt::StoreOp::Store };
                let mut render = encoding.recorder.render(&wgpu::RenderPassDescriptor {
                    label: Some(&pass.path),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view,
                        depth_slice: None,
                        resolve_target: None,
                        ops,
                    })],
                    timestamp_writes: encoding.timing.render(encoding.pair, first, last),
                    ..wgpu::RenderPassDescriptor::default()
                });
                render.set_pipeline(pipeline);
                render.set_bind_group(0, &step.group, &[]);
                render.draw(0..3, 0..1);
            }
            MipInto::Groups([x, y, z]) => {
                let Some(pipeline) = compute_pipeline(pipeline) else { return };
                encoding.dispatches(pass, (first, last), |compute| {
                    compute.set_pipeline(pipeline);
                    compute.set_bind_group(0, &step.group, &[]);
                    compute.dispatch_workgroups(*x, *y, *z);
                });
            }
        }
    }
}
