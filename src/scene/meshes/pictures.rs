//! The pictures that materials use, each decoded once.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;

use super::report::Report;
use crate::scene::image::{self, Stored};

/// Pictures of one model.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    pub images: Vec<Arc<Stored>>,
    /// What became of each that was asked for.
    known: BTreeMap<String, Option<usize>>,
    texels: usize,
}

/// Texels of all pictures of one model: 2 GiB.
const MOST_TEXELS: usize = 512 << 20;

impl Pictures {
    /// The index of the picture that bears `key`. `bytes` is asked only the first time; where it
    /// has none, it has said why.
    pub fn add<'a>(
        &mut self,
        key: &str,
        place: impl Display,
        report: &mut Report,
        bytes: impl FnOnce(&mut Report) -> Option<std::borrow::Cow<'a, [u8]>>,
    ) -> Option<usize> {
        if let Some(known) = self.known.get(key) {
            return *known;
        }
        let image = bytes(report).and_then(|bytes| self.decode(&bytes, place, report));
        let index = image.map(|image| self.keep(image));
        self.known.insert(key.to_owned(), index);
        index
    }

    /// The index of a picture that was made.
    pub fn keep(&mut self, image: Stored) -> usize {
        self.texels += image.texels.len();
        self.images.push(Arc::new(image));
        self.images.len() - 1
    }

    fn decode(&self, bytes: &[u8], place: impl Display, report: &mut Report) -> Option<Stored> {
        match image::read_stored(bytes, MOST_TEXELS.saturating_sub(self.texels)) {
            Ok(image) => Some(image),
            Err(error) => {
                let hint = error.hint.map(|hint| format!(" ({hint})")).unwrap_or_default();
                report.warn(place, format!("{}{hint}: the material goes without it", error.message));
                None
            }
        }
    }
}
