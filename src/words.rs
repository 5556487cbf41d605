//! Maps by short words that files of ours name, with a hash that costs little: planning looks up
//! names some thousand times.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A map by name. The hash is no shield against names made to collide: who writes such a graph
/// slows down his own.
pub type Words<T> = HashMap<String, T, WordState>;

pub type WordState = BuildHasherDefault<WordHasher>;

/// Multiplies and rotates, eight bytes at a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct WordHasher(u64);

/// 2^64 divided by the golden ratio, made odd.
const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;

impl WordHasher {
    fn mix(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(FACTOR);
    }
}

impl Hasher for WordHasher {
    fn write(&mut self, bytes: &[u8]) {
        let mut chunks = bytes.chunks_exact(8);
        for chunk in &mut chunks {
            self.mix(chunk.try_into().map_or(0, u64::from_le_bytes));
        }
        let rest = chunks.remainder().iter().fold(0, |all, byte| all << 8 | u64::from(*byte));
        self.mix(rest ^ (bytes.len() as u64) << 56);
    }

    fn write_u8(&mut self, byte: u8) {
        self.mix(byte.into());
    }

    fn write_u32(&mut self, word: u32) {
        self.mix(word.into());
    }

    fn write_u64(&mut self, word: u64) {
        self.mix(word);
    }

    fn write_usize(&mut self, word: usize) {
        self.mix(word as u64);
    }

    /// The map takes its buckets from the low bits and its tags from the high ones.
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 29
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_differ_little_fall_apart() {
        let hash = |word: &str| {
            let mut hasher = WordHasher::default();
            std::hash::Hash::hash(word, &mut hasher);
            hasher.finish()
        };
        let words: Vec<String> = (0..4096).map(|n| format!("b{n}")).collect();
        let low: std::collections::BTreeSet<u64> = words.iter().map(|word| hash(word) % 4096).collect();
        // As many as chance would leave, 1 - 1/e, and some less.
        assert!(low.len() > 2300, "{} of 4096 buckets are taken", low.len());
        let high: std::collections::BTreeSet<u64> = words.iter().map(|word| hash(word) >> 57).collect();
        assert_eq!(high.len(), 128);
    }
}
