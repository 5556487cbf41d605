//! The sequences of what is open: the worker turns their pages, and the window plays.
//!
//! No more frames are held than are read ahead.

use std::path::PathBuf;

use crate::diagnostic::Diagnostics;
use crate::files::DiskFiles;
use crate::host::{Content, Player, Track, When};

/// Frames that are missing or damaged, as far as they are listed.
const MOST_TOLD: usize = 20;

/// The numbered files of what is open.
#[derive(Debug)]
pub(super) struct Sequences {
    player: Player,
    tracks: Vec<Track>,
    shown: When,
    /// Frames that are missing or damaged, each once.
    told: Diagnostics,
}

impl Sequences {
    /// Absent if the content has none. `shown` is there already.
    pub fn new(content: &Content, shown: When) -> Option<Self> {
        let tracks = content.tracks.clone();
        (!tracks.is_empty()).then(|| Self {
            player: Player::new(&tracks, shown, DiskFiles),
            tracks,
            shown,
            told: Diagnostics::new(),
        })
    }

    /// Puts the frames of a moment into the content, and waits until they are read; tells whether the
    /// moment is another than before.
    pub fn turn(&mut self, content: &mut Content, when: When) -> bool {
        if when == self.shown {
            return false;
        }
        self.shown = when;
        let mut told = Diagnostics::new();
        content.feed(self.player.inputs(when, &mut told));
        for found in told.0 {
            let is_new = self.told.iter().all(|known| known.message != found.message);
            if is_new && self.told.0.len() < MOST_TOLD {
                self.told.push(found);
            }
        }
        true
    }

    /// What is missing or damaged of the frames that were shown so far.
    pub fn told(&self) -> &Diagnostics {
        &self.told
    }

    /// The files that are shown, and those that would come behind the last ones: a solver may be at work.
    pub fn files(&self) -> Vec<PathBuf> {
        let both = |track: &Track| {
            let shown = track.frames.number(self.shown);
            [shown, track.frames.last().saturating_add(1)].map(|frame| track.frames.pattern.path(frame))
        };
        self.tracks.iter().flat_map(both).collect()
    }
}
