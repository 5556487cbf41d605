//! The bytes of a file that may be gzipped. They are unpacked no further than they are asked for,
//! so a small file that claims to unpack to much takes no memory.

use std::io::Read;

use flate2::bufread::MultiGzDecoder;

use crate::scene::particles::error::{Place, ReadError, counted};

/// Deflate packs at most so many bytes into one.
const MOST_PACKED: usize = 1032;
/// What follows the particles is unpacked to verify the checksum, up to here.
const MOST_VERIFIED: u64 = 256 << 20;

pub(super) struct Stream<'a> {
    source: Source<'a>,
    at: usize,
}

enum Source<'a> {
    Plain(&'a [u8]),
    Gzip { packed: usize, decoder: MultiGzDecoder<&'a [u8]>, unpacked: Vec<u8> },
}

impl<'a> Stream<'a> {
    /// Tells by its first bytes whether a file is gzipped.
    pub fn new(bytes: &'a [u8]) -> Self {
        let source = if bytes.starts_with(&[0x1f, 0x8b]) {
            Source::Gzip { packed: bytes.len(), decoder: MultiGzDecoder::new(bytes), unpacked: Vec::new() }
        } else {
            Source::Plain(bytes)
        };
        Self { source, at: 0 }
    }

    pub fn offset(&self) -> usize {
        self.at
    }

    /// The next `count` bytes, which are `what`.
    pub fn take(&mut self, count: usize, what: &str) -> Result<&[u8], ReadError> {
        let start = self.at;
        let end = start.saturating_add(count);
        let found = self.unpack(end)?;
        if found < end {
            return Err(self.error_at(
                start,
                format!(
                    "{what}: expected {}, found {} before the end of the file",
                    counted(count, "byte"),
                    found.saturating_sub(start)
                ),
            ));
        }
        self.at = end;
        let bytes = match &self.source {
            Source::Plain(bytes) => bytes,
            Source::Gzip { unpacked, .. } => unpacked.as_slice(),
        };
        Ok(bytes.get(start..end).unwrap_or_default())
    }

    /// Up to `count` bytes that come next, without moving on.
    pub fn peek(&mut self, count: usize) -> Result<&[u8], ReadError> {
        let (start, end) = (self.at, self.at.saturating_add(count));
        let found = self.unpack(end)?;
        let bytes = match &self.source {
            Source::Plain(bytes) => bytes,
            Source::Gzip { unpacked, .. } => unpacked.as_slice(),
        };
        Ok(bytes.get(start..end.min(found)).unwrap_or_default())
    }

    /// Makes the first `end` bytes available, or as many as there are; tells how many there are.
    fn unpack(&mut self, end: usize) -> Result<usize, ReadError> {
        let Source::Gzip { packed, decoder, unpacked } = &mut self.source else {
            let Source::Plain(bytes) = &self.source else { return Ok(0) };
            return Ok(bytes.len());
        };
        if end <= unpacked.len() {
            return Ok(unpacked.len());
        }
        let possible = packed.saturating_mul(MOST_PACKED);
        if end > possible {
            // The file cannot hold so much; one byte beyond what was asked before proves nothing
            // more, so nothing is unpacked.
            return Ok(unpacked.len());
        }
        let missing = (end - unpacked.len()) as u64;
        // Read a little ahead, as most reads are small.
        let ahead = missing.max(4096);
        match decoder.take(ahead).read_to_end(unpacked) {
            Ok(_) => Ok(unpacked.len()),
            Err(error) => {
                let at = unpacked.len();
                Err(ReadError::new(format!("the gzip data is damaged or cut off: {error}")).at(Place::UnpackedByte(at)))
            }
        }
    }

    /// Unpacks what is left, and so verifies the checksum of a gzipped file.
    pub fn check_end(&mut self) -> Result<(), ReadError> {
        let Source::Gzip { decoder, unpacked, .. } = &mut self.source else { return Ok(()) };
        let at = unpacked.len();
        match std::io::copy(&mut decoder.take(MOST_VERIFIED), &mut std::io::sink()) {
            Ok(_) => Ok(()),
            Err(error) => {
                Err(ReadError::new(format!("the gzip data is damaged or cut off: {error}")).at(Place::UnpackedByte(at)))
            }
        }
    }

    pub fn error_at(&self, offset: usize, message: impl Into<String>) -> ReadError {
        ReadError::new(message).at(match self.source {
            Source::Plain(_) => Place::Byte(offset),
            Source::Gzip { .. } => Place::UnpackedByte(offset),
        })
    }

    /// An error at the byte that would come next.
    pub fn error(&self, message: impl Into<String>) -> ReadError {
        self.error_at(self.at, message)
    }
}
