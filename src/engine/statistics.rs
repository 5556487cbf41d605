//! Statistics: buffers are copied to where they can be read while frames go on, and looked at once
//! they are there.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use super::bind::resolve;
use super::errors;
use super::prepare::{Engine, Runner};
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::model::{ObjectKind, ObjectRef};
use crate::plan::stats::{self, Statistic};

const THERE: u8 = 1;
const FAILED: u8 = 2;

/// Copies on their way back.
#[derive(Debug)]
pub(super) struct Asked {
    copies: Vec<(ObjectRef, wgpu::Buffer, Arc<AtomicU8>)>,
}

impl Runner {
    /// Asks for the plan's statistics of the frame that was submitted last. Waits for nothing; what was
    /// asked for before and is not there yet is forgotten.
    ///
    /// # Errors
    /// If the device refuses the copies.
    pub fn ask_statistics(&mut self, engine: &Engine) -> Result<(), Diagnostic> {
        let gpu = engine.gpu();
        gpu.check()?;
        let mut wanted = Vec::new();
        for object in stats::buffers(&self.plan) {
            let id = resolve(&self.plan, &self.rotation, object);
            if let (ObjectKind::Buffer(about), Some(buffer)) = (&self.plan.objects[id].kind, self.pool.buffer(id)) {
                wanted.push((object, buffer.clone(), about.bytes()));
            }
        }
        let copied = errors::scoped(gpu, || {
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut copies = Vec::with_capacity(wanted.len());
            for (object, buffer, bytes) in &wanted {
                let copy = gpu.device().create_buffer(&wgpu::BufferDescriptor {
                    label: Some("statistics"),
                    size: *bytes,
                    usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                });
                encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, *bytes);
                copies.push((*object, copy, Arc::new(AtomicU8::new(0))));
            }
            gpu.queue().submit([encoder.finish()]);
            for (_, copy, state) in &copies {
                let state = Arc::clone(state);
                copy.map_async(wgpu::MapMode::Read, .., move |mapped| {
                    state.store(if mapped.is_ok() { THERE } else { FAILED }, Ordering::Release);
                });
            }
            copies
        });
        let copies =
            copied.map_err(|e| Diagnostic::error(Code::DEVICE, format!("the device refused statistics: {e}")))?;
        self.asked = Some(Asked { copies });
        Ok(())
    }

    /// The statistics that were asked for, once, as soon as they are there.
    pub fn poll_statistics(&mut self, engine: &Engine) -> Option<Vec<Statistic>> {
        let asked = self.asked.as_ref()?;
        engine.gpu().poll();
        if asked.copies.iter().any(|(_, _, state)| state.load(Ordering::Acquire) == 0) {
            return None;
        }
        let asked = self.asked.take()?;
        let bytes: Vec<(ObjectRef, Vec<u8>)> = (asked.copies.iter())
            .filter(|(_, _, state)| state.load(Ordering::Acquire) == THERE)
            .filter_map(|(object, copy, _)| Some((*object, copy.get_mapped_range(..).ok()?.to_vec())))
            .collect();
        let content = |object: ObjectRef| bytes.iter().find(|(of, _)| *of == object).map(|(_, bytes)| bytes.as_slice());
        Some(stats::values(&self.plan, &content))
    }

    /// The same at once: waits for the GPU.
    ///
    /// # Errors
    /// If the device refuses the copies, or was lost.
    pub fn statistics(&mut self, engine: &Engine) -> Result<Vec<Statistic>, Diagnostic> {
        self.ask_statistics(engine)?;
        engine.gpu().wait()?;
        Ok(self.poll_statistics(engine).unwrap_or_default())
    }
}
