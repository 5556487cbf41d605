//! Filling inputs: bytes from the host, or what another runner holds.

use super::bind::resolve;
use super::carry::Content;
use super::pool::Memory;
use super::prepare::{Engine, Runner};
use super::texel;
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::model::{ObjectId, ObjectKind, ObjectRef, Origin, Texture};

impl Runner {
    /// Writes the bytes of a buffer from its start; the rest stays as it is.
    ///
    /// # Errors
    /// If the object is no buffer or has less room.
    pub fn upload_buffer(&mut self, engine: &Engine, object: ObjectId, bytes: &[u8]) -> Result<(), Diagnostic> {
        self.known(object)?;
        self.own(engine, object)?;
        let buffer = self.pool.buffer(object).ok_or_else(|| self.unfit(object, "is no buffer"))?;
        let room = match &self.plan.objects[object].kind {
            ObjectKind::Buffer(b) => b.bytes(),
            ObjectKind::Texture(_) => 0,
        };
        if bytes.len() as u64 > room {
            return Err(self.unfit(object, &format!("has room for {room} bytes, not for {}", bytes.len())));
        }
        // Writes are of whole words.
        let whole = bytes.len() / 4 * 4;
        engine.gpu().write_buffer(buffer, 0, &bytes[..whole]);
        if whole < bytes.len() {
            let mut word = [0; 4];
            word[..bytes.len() - whole].copy_from_slice(&bytes[whole..]);
            engine.gpu().write_buffer(buffer, whole as u64, &word);
        }
        self.note_content(object, Content::Own);
        Ok(())
    }

    /// Writes one layer (or slice of a volume) of one mip, rows tightly packed from the top.
    ///
    /// # Errors
    /// If the object is no texture, or the bytes are not exactly those of the layer.
    pub fn upload_texture(
        &mut self,
        engine: &Engine,
        object: ObjectId,
        mip: u32,
        layer: u32,
        bytes: &[u8],
    ) -> Result<(), Diagnostic> {
        self.known(object)?;
        self.own(engine, object)?;
        let texture = self.pool.texture(object).ok_or_else(|| self.unfit(object, "is no texture"))?;
        let mips = texture.mip_level_count();
        if mip >= mips {
            return Err(self.unfit(object, &format!("has {mips} mips, and no mip {mip}")));
        }
        let (width, height) = ((texture.width() >> mip).max(1), (texture.height() >> mip).max(1));
        let format = texture.format();
        let size = texel::size(format).ok_or_else(|| self.unfit(object, "has a format that cannot be uploaded"))?;
        let (row, expected) = (width as usize * size, width as usize * height as usize * size);
        if bytes.len() != expected {
            let message = format!("takes {expected} bytes for mip {mip}, not {}", bytes.len());
            return Err(self.unfit(object, &message));
        }
        let is_3d = texture.dimension() == wgpu::TextureDimension::D3;
        let layers =
            if is_3d { (texture.depth_or_array_layers() >> mip).max(1) } else { texture.depth_or_array_layers() };
        if layer >= layers {
            return Err(self.unfit(object, &format!("has {layers} layers in mip {mip}, and no layer {layer}")));
        }
        engine.gpu().write_texture(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: mip,
                origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
                aspect: wgpu::TextureAspect::All,
            },
            bytes,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: Some(height) },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        self.note_content(object, Content::Own);
        Ok(())
    }

    /// Makes what another runner on the same device holds this runner's input, without a copy.
    /// To be called again when either was prepared anew, or the other's state turned.
    ///
    /// # Errors
    /// If one of them is nothing like the other, or the other has no memory yet.
    pub fn share(&mut self, object: ObjectId, from: &Runner, source: ObjectRef) -> Result<(), Diagnostic> {
        self.known(object)?;
        let id = from.resolved(source)?;
        let Some(memory) = from.pool.memory(id) else {
            return Err(self.unfit(object, &format!("cannot take `{}`, which is empty", from.plan.objects[id].path)));
        };
        let writes = |runner: &Runner, object: ObjectId| runner.writers.iter().any(|(written, _)| *written == object);
        if writes(self, object) && writes(from, id) {
            let graph = from.plan.graph.display().to_string();
            return Err(self.written_already(object, &graph, &from.plan.objects[id].path));
        }
        self.share_memory(object, memory.clone(), Content::Version(from.stamps[id]))
    }

    /// Makes an embedder's texture this runner's input, without a copy. It counts as changed in
    /// every frame; see [`Runner::share_texture_version`].
    ///
    /// # Errors
    /// If its format, size, mips or layers are not those that the plan was made for.
    pub fn share_texture(&mut self, object: ObjectId, texture: &wgpu::Texture) -> Result<(), Diagnostic> {
        self.share_memory(object, Memory::Texture(texture.clone()), Content::Unversioned)
    }

    /// The same for a texture that has changed only if the version is another than last time.
    ///
    /// # Errors
    /// As [`Runner::share_texture`].
    pub fn share_texture_version(
        &mut self,
        object: ObjectId,
        texture: &wgpu::Texture,
        version: u64,
    ) -> Result<(), Diagnostic> {
        self.share_memory(object, Memory::Texture(texture.clone()), Content::Version(version))
    }

    /// Makes an embedder's buffer this runner's input, without a copy. It counts as changed in
    /// every frame; see [`Runner::share_buffer_version`].
    ///
    /// # Errors
    /// If it is smaller than the plan was made for.
    pub fn share_buffer(&mut self, object: ObjectId, buffer: &wgpu::Buffer) -> Result<(), Diagnostic> {
        self.share_memory(object, Memory::Buffer(buffer.clone()), Content::Unversioned)
    }

    /// The same for a buffer that has changed only if the version is another than last time.
    ///
    /// # Errors
    /// As [`Runner::share_buffer`].
    pub fn share_buffer_version(
        &mut self,
        object: ObjectId,
        buffer: &wgpu::Buffer,
        version: u64,
    ) -> Result<(), Diagnostic> {
        self.share_memory(object, Memory::Buffer(buffer.clone()), Content::Version(version))
    }

    /// Tells that somebody wrote to an object's memory by other ways than this runner's: what
    /// depends on it runs in the next frame.
    pub fn mark_changed(&mut self, object: ObjectId) {
        if let Some(source) = self.sources.get(object) {
            self.note_content(object, *source);
        }
    }

    /// Fills all that passes of a frame write with bytes of ones: NaN for floats, the largest for
    /// whole numbers. A picture that then changes shows that a shader leaves holes in what it
    /// should write whole. Depth and textures of several samples cannot be filled so and stay.
    ///
    /// # Errors
    /// If the device refuses a write.
    pub fn poison(&mut self, engine: &Engine) -> Result<(), Diagnostic> {
        for object in 0..self.plan.objects.len() {
            // What the frame makes behind a cut is not there yet, and what is never stored holds nothing.
            let is_made_later = self.cuts.is_late(self.pool.handle(object)) && self.pool.memory(object).is_none();
            let is_filled = !is_made_later && !self.pool.is_transient(object);
            if self.plan.objects[object].origin != Origin::Frame || !is_filled {
                continue;
            }
            match self.plan.objects[object].kind.clone() {
                ObjectKind::Buffer(buffer) => {
                    self.upload_buffer(engine, object, &vec![0xff; buffer.bytes() as usize])?;
                }
                ObjectKind::Texture(t) if t.samples == 1 && !t.format.is_depth_stencil_format() => {
                    self.poison_texture(engine, object, &t)?;
                }
                ObjectKind::Texture(_) => {}
            }
        }
        Ok(())
    }

    fn poison_texture(&mut self, engine: &Engine, object: ObjectId, about: &Texture) -> Result<(), Diagnostic> {
        let size = texel::size(about.format).unwrap_or(0);
        for mip in 0..about.mips {
            let [width, height] = [about.width, about.height].map(|n| (n >> mip).max(1) as usize);
            let bytes = vec![0xff; width * height * size];
            let layers = if about.is_3d { (about.layers >> mip).max(1) } else { about.layers };
            for layer in 0..layers {
                self.upload_texture(engine, object, mip, layer, &bytes)?;
            }
        }
        Ok(())
    }

    /// The texture that a reference stands for now, for those who show or use it on the same
    /// device.
    pub fn texture(&self, object: ObjectRef) -> Option<&wgpu::Texture> {
        self.pool.texture(self.resolved(object).ok()?)
    }

    /// The buffer that a reference stands for now.
    pub fn buffer(&self, object: ObjectRef) -> Option<&wgpu::Buffer> {
        self.pool.buffer(self.resolved(object).ok()?)
    }

    fn share_memory(&mut self, object: ObjectId, memory: Memory, source: Content) -> Result<(), Diagnostic> {
        self.known(object)?;
        let fits = match (&self.plan.objects[object].kind, &memory) {
            (ObjectKind::Texture(t), Memory::Texture(texture)) => is_like(t, texture),
            (ObjectKind::Buffer(b), Memory::Buffer(buffer)) => buffer.size() >= b.bytes(),
            _ => false,
        };
        if !fits {
            return Err(self.unfit(object, &format!("was planned as {}", self.planned(object))));
        }
        if let Some(lacking) = lacking(&self.plan.objects[object].kind, &memory) {
            let hint = format!("make it with `plan.needs(\"{}\")`'s usages", self.plan.objects[object].path);
            return Err(self.unfit(object, &format!("was given what lacks the usage {lacking}")).hint(hint));
        }
        self.claim(object, &memory)?;
        let is_news = self.pool.share(object, memory);
        if is_news {
            self.forget_variants(object);
        }
        if is_news || source == Content::Unversioned || source != self.sources[object] {
            self.note_content(object, source);
        }
        Ok(())
    }

    /// Of what was taken over from the plan before, another part may be written now.
    pub(super) fn claim_what_is_written(&self) -> Result<(), Diagnostic> {
        let foreign = self.writers.iter().filter_map(|(object, _)| {
            let memory = self.pool.foreign(*object)?;
            Some((self.plan.objects[*object].path.as_str(), memory))
        });
        let written: Vec<_> = foreign.collect();
        self.claimant.claim_only(&written, &self.plan.graph.display().to_string()).map_err(|[path, other, theirs]| {
            let object = self.plan.objects.iter().position(|object| object.path == path).unwrap_or_default();
            self.written_already(object, &other, &theirs)
        })
    }

    fn written_already(&self, object: ObjectId, other: &str, theirs: &str) -> Diagnostic {
        self.unfit(object, &format!("cannot be written where `{theirs}` of {other} is written already"))
            .hint("give each of them a texture or buffer of its own, or let one read what the other writes")
    }

    /// What two graphs write would depend on which of them ran last.
    fn claim(&self, object: ObjectId, memory: &Memory) -> Result<(), Diagnostic> {
        if !self.writers.iter().any(|(written, _)| *written == object) {
            return Ok(());
        }
        let (graph, path) = (self.plan.graph.display().to_string(), &self.plan.objects[object].path);
        let claimed = self.claimant.claim(memory, &graph, path);
        claimed.map_err(|(other, theirs)| self.written_already(object, &other, &theirs))
    }

    /// Gives an object memory of its own to write to.
    fn own(&mut self, engine: &Engine, object: ObjectId) -> Result<(), Diagnostic> {
        self.pool.own(object);
        if self.pool.ensure(engine.gpu(), &self.plan, object)? {
            self.forget_variants(object);
        }
        Ok(())
    }

    /// A number of another plan may be of nothing here.
    fn known(&self, object: ObjectId) -> Result<(), Diagnostic> {
        if object < self.plan.objects.len() {
            return Ok(());
        }
        Err(self.unknown(&format!("object {object}"), self.plan.objects.len()))
    }

    /// The object that a reference stands for now; one of another plan may stand for nothing here.
    pub(super) fn resolved(&self, object: ObjectRef) -> Result<ObjectId, Diagnostic> {
        match object {
            ObjectRef::Fixed(id) => self.known(id)?,
            ObjectRef::Ring { ring, .. } if ring >= self.plan.rings.len() => {
                return Err(self.unknown(&format!("ring {ring}"), self.plan.rings.len()));
            }
            ObjectRef::Ring { .. } => {}
        }
        Ok(resolve(&self.plan, &self.rotation, object))
    }

    fn unknown(&self, what: &str, count: usize) -> Diagnostic {
        let message = format!("there is no {what} in the plan of {}, which has {count}", self.plan.graph.display());
        Diagnostic::error(Code::BAD_PARAMETER, message).hint("ask `plan.needs(path)` again after each plan")
    }

    fn planned(&self, object: ObjectId) -> String {
        match &self.plan.objects[object].kind {
            ObjectKind::Texture(t) => {
                format!(
                    "{} of {} x {} x {}, {} mips",
                    crate::format::name(t.format),
                    t.width,
                    t.height,
                    t.layers,
                    t.mips
                )
            }
            ObjectKind::Buffer(b) => format!("a buffer of {} bytes", b.bytes()),
        }
    }

    fn unfit(&self, object: ObjectId, why: &str) -> Diagnostic {
        let object = &self.plan.objects[object];
        Diagnostic::error(Code::BAD_PARAMETER, format!("`{}` {why}", object.path)).at(object.span, "declared here")
    }
}

/// Usages that passes need and the memory has not.
fn lacking(planned: &ObjectKind, memory: &Memory) -> Option<String> {
    let names = |names: Vec<&str>| (!names.is_empty()).then(|| names.join(" and "));
    match (planned, memory) {
        (ObjectKind::Texture(t), Memory::Texture(texture)) => {
            names((t.usages - texture.usage()).iter_names().map(|(name, _)| name).collect())
        }
        (ObjectKind::Buffer(b), Memory::Buffer(buffer)) => {
            names((b.usages - buffer.usage()).iter_names().map(|(name, _)| name).collect())
        }
        _ => None,
    }
}

fn is_like(planned: &Texture, texture: &wgpu::Texture) -> bool {
    planned.format == texture.format()
        && planned.width == texture.width()
        && planned.height == texture.height()
        && planned.layers == texture.depth_or_array_layers()
        && planned.mips <= texture.mip_level_count()
        && planned.samples == texture.sample_count()
        && planned.is_3d == (texture.dimension() == wgpu::TextureDimension::D3)
}
