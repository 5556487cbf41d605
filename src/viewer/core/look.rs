//! Reading back what is looked at, only while it is looked at.

use super::Core;
use crate::host::{Live, Read};
use crate::plan::model::{ObjectKind, Plan};
use crate::viewer::look::{self, Look, Seen, SeenBuffer, SeenContent, SeenTexture};

/// A search for the first pass that writes a number that is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hunt {
    /// The pass that is looked at next.
    pub next: usize,
    pub of: usize,
}

impl Core {
    /// Reads what is looked at, if it is not what was read last. Tells whether there is news.
    pub(super) fn look(&mut self) -> bool {
        let Some(look) = self.state.look.clone() else {
            self.looked = None;
            return self.state.seen.take().is_some() | self.end_part();
        };
        let key = (look.clone(), self.state.frames, self.version);
        if self.looked.as_ref() == Some(&key) {
            return false;
        }
        let content = self.seen(&look);
        self.serial += 1;
        self.state.seen = Some(Seen { look, serial: self.serial, content });
        self.looked = Some(key);
        true
    }

    fn seen(&mut self, look: &Look) -> Result<SeenContent, String> {
        match &look.after {
            Some(pass) => {
                let plan = self.plan().ok_or("nothing is built yet")?;
                let last = index_of(plan, pass).ok_or_else(|| format!("there is no pass `{pass}` any more"))?;
                let off = &self.state.switched_off;
                let only: Vec<bool> =
                    plan.passes.iter().enumerate().map(|(i, p)| i <= last && !off.contains(&p.path)).collect();
                self.run_only(&only)?;
            }
            None => _ = self.end_part(),
        }
        self.read(&look.path, look.mip, look.layer)
    }

    /// Runs chosen passes; the next frame runs all again.
    fn run_only(&mut self, only: &[bool]) -> Result<(), String> {
        let camera = self.state.camera.ok_or("there is no camera yet")?;
        let (time_s, frame) = (self.fed_s, self.state.clock.frame_at(self.fed_s));
        let live = Live { camera, time_s, delta_s: 0.0, frame, steps: &[], only: Some(only) };
        self.is_part = true;
        let ran = self.session.run_part(&live).map_err(|found| first(&found));
        // Times of a part say nothing about a frame.
        self.session.answers();
        ran
    }

    /// After a part of the passes ran alone, all run again. Tells whether they have to.
    pub(super) fn end_part(&mut self) -> bool {
        let was = std::mem::take(&mut self.is_part);
        if was {
            self.made = None;
            self.run_all = true;
        }
        was
    }

    fn read(&mut self, path: &str, mip: u32, layer: u32) -> Result<SeenContent, String> {
        let plan = self.plan().ok_or("nothing is built yet")?;
        let (found, object) = look::find(plan, path).ok_or_else(|| format!("there is no `{path}` in this graph"))?;
        let kind = object.kind.clone();
        let (mip, layer) = match &kind {
            ObjectKind::Texture(t) => (mip.min(t.mips.saturating_sub(1)), layer.min(t.layers.saturating_sub(1))),
            ObjectKind::Buffer(_) => (0, 0),
        };
        let read = self.session.read(found, mip, layer).map_err(|error| error.message)?;
        Ok(match (read, &kind) {
            (Read::Buffer(bytes), ObjectKind::Buffer(buffer)) => SeenContent::Buffer(SeenBuffer::new(buffer, &bytes)),
            (Read::Texture(data), _) => SeenContent::Texture(SeenTexture {
                width: data.width,
                height: data.height,
                channels: crate::format::channels(data.format),
                format: format!("{:?}", data.format),
                texels: data.to_rgba_f32(),
            }),
            (Read::Buffer(_), ObjectKind::Texture(_)) => return Err(format!("`{path}` has no content yet")),
        })
    }

    /// Looks for the first pass that writes NaN or infinity: one pass at each call.
    pub(super) fn hunt(&mut self) -> bool {
        let Some(hunt) = self.state.hunt.clone() else { return false };
        let Some(plan) = self.plan() else {
            self.state.hunt = None;
            return true;
        };
        if hunt.next >= plan.passes.len() {
            self.state.hunt = None;
            self.end_part();
            self.state.say("no pass of the frame writes NaN or infinity");
            return true;
        }
        let pass = &plan.passes[hunt.next];
        let (path, written) = (pass.path.clone(), written(plan, hunt.next));
        let only: Vec<bool> = (0..plan.passes.len()).map(|i| i == hunt.next).collect();
        if let Err(why) = self.run_only(&only) {
            self.state.hunt = None;
            self.state.say(why);
            return true;
        }
        for (resource, mip, layer) in written {
            if let Ok(content) = self.read(&resource, mip, layer)
                && let Some(what) = bad(&content)
            {
                self.state.hunt = None;
                self.state.say(format!("`{path}` is the first pass that writes {what}: into `{resource}`"));
                self.state.look = Some(Look { path: resource, after: Some(path), mip, layer });
                return true;
            }
        }
        self.state.hunt = Some(Hunt { next: hunt.next + 1, of: self.plan().map_or(0, |p| p.passes.len()) });
        true
    }
}

/// What a pass writes: the resource, mip and layer.
fn written(plan: &Plan, pass: usize) -> Vec<(String, u32, u32)> {
    let mut found = Vec::new();
    for access in plan.passes[pass].accesses.iter().filter(|a| a.write) {
        let Some(object) = look::object(plan, access.object) else { continue };
        match &object.kind {
            ObjectKind::Buffer(_) => found.push((object.path.clone(), 0, 0)),
            ObjectKind::Texture(t) if t.samples == 1 => {
                let parts = access.mips.clone().flat_map(|mip| access.layers.clone().map(move |layer| (mip, layer)));
                found.extend(parts.map(|(mip, layer)| (object.path.clone(), mip, layer)));
            }
            ObjectKind::Texture(_) => {}
        }
    }
    found
}

fn bad(content: &SeenContent) -> Option<&'static str> {
    match content {
        SeenContent::Texture(texture) => {
            let mut numbers = texture.texels.iter().flatten();
            let found = numbers.find(|x| !x.is_finite())?;
            Some(if found.is_nan() { "NaN" } else { "infinity" })
        }
        SeenContent::Buffer(buffer) => {
            buffer.item.as_ref()?;
            buffer.bad(usize::MAX).1.map(|_| "NaN or infinity")
        }
    }
}

fn index_of(plan: &Plan, pass: &str) -> Option<usize> {
    plan.passes.iter().position(|p| p.path == pass)
}

fn first(found: &crate::diagnostic::Diagnostics) -> String {
    found.iter().next().map_or_else(|| "the device refused".to_owned(), |d| d.message.clone())
}
