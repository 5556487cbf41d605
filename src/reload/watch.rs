//! A set of files, also such as are not there yet, and word of their changes.
//!
//! Folders are watched rather than files, so that saving by renaming over a file, deleting it and
//! putting it back are all seen. Reading a file oneself is no change.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant, SystemTime};

use notify::event::{EventKind, ModifyKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};

use crate::files::{LIBRARY, normalize};

/// Silence after an event that ends a burst: editors write a file in several strokes.
const QUIET: Duration = Duration::from_millis(15);
/// A burst that does not end is a change all the same.
const LONGEST_BURST: Duration = Duration::from_millis(200);

/// Something that happened to a file; absent: somebody wants [`Watch::next`] to return.
type Event = Option<notify::Result<notify::Event>>;

/// Watches a set of files.
#[derive(Debug)]
pub struct Watch {
    watcher: RecommendedWatcher,
    events: Receiver<(Instant, Event)>,
    waker: Waker,
    /// Absolute paths.
    files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
    /// Folders that those stand in.
    above: BTreeSet<PathBuf>,
    /// When the files of the set began to be read: what came before was read.
    read_at: Instant,
    /// Files that changed while they were not watched yet.
    missed: BTreeSet<PathBuf>,
}

/// Ends the wait of a [`Watch`] from another thread.
#[derive(Clone, Debug)]
pub struct Waker(Sender<(Instant, Event)>);

impl Waker {
    pub fn wake(&self) {
        // A watch that is gone does not wait.
        _ = self.0.send((Instant::now(), None));
    }
}

/// What changed in a burst of events.
#[derive(Clone, Debug)]
pub struct Change {
    /// Absolute paths of files of the set, sorted.
    pub files: Vec<PathBuf>,
    /// When the first event of the burst came.
    pub first: Instant,
    /// From the first event, or from the save where the file tells it, to the end of the burst.
    pub noticing: Duration,
}

impl Watch {
    /// # Errors
    /// If the system has no more room for watchers.
    pub fn new() -> notify::Result<Self> {
        let (sender, events) = channel();
        let waker = Waker(sender.clone());
        // A receiver that is gone wants no events.
        let watcher = notify::recommended_watcher(move |event| _ = sender.send((Instant::now(), Some(event))))?;
        let (files, folders, above, missed) = <(BTreeSet<_>, BTreeSet<_>, BTreeSet<_>, BTreeSet<_>)>::default();
        Ok(Self { watcher, events, waker, files, folders, above, read_at: Instant::now(), missed })
    }

    /// What ends a wait in [`Watch::next`].
    pub fn waker(&self) -> Waker {
        self.waker.clone()
    }

    /// Watches exactly `paths` from now on. Files that were not watched before and that were saved
    /// after `read_since` count as changed: they may have been read before.
    ///
    /// # Errors
    /// If a folder cannot be watched; the set stays in part as it was.
    pub fn set<'a>(&mut self, paths: impl IntoIterator<Item = &'a Path>, read_since: SystemTime) -> notify::Result<()> {
        let mut files = BTreeSet::new();
        for path in paths.into_iter().filter(|path| !path.starts_with(LIBRARY)) {
            files.insert(absolute(path));
            // A link's target is saved elsewhere.
            files.extend(std::fs::canonicalize(path).ok());
        }
        let folders: BTreeSet<PathBuf> = files.iter().filter_map(|file| nearest_folder(file)).collect();
        for folder in folders.difference(&self.folders) {
            self.watcher.watch(folder, RecursiveMode::NonRecursive)?;
        }
        // A folder that is moved away says nothing: the one that it stands in does.
        let above: BTreeSet<PathBuf> = above(&folders).difference(&folders).cloned().collect();
        for folder in above.difference(&self.above).filter(|folder| !self.folders.contains(*folder)) {
            // It may be nobody's to look at; all else is seen without it.
            _ = self.watcher.watch(folder, RecursiveMode::NonRecursive);
        }
        for folder in self.folders.union(&self.above).filter(|f| !folders.contains(*f) && !above.contains(*f)) {
            // It may have gone by itself.
            _ = self.watcher.unwatch(folder);
        }
        let saved_since = |file: &&PathBuf| saved(file).is_some_and(|saved| saved >= read_since);
        self.missed = files.difference(&self.files).filter(saved_since).cloned().collect();
        let ago = SystemTime::now().duration_since(read_since).unwrap_or_default();
        self.read_at = Instant::now().checked_sub(ago).unwrap_or(self.read_at);
        (self.files, self.folders, self.above) = (files, folders, above);
        Ok(())
    }

    /// Waits for a change; `None` if there is none within `patience`, or if somebody wakes it.
    ///
    /// # Errors
    /// If the system stops telling of changes.
    pub fn next(&mut self, patience: Duration) -> notify::Result<Option<Change>> {
        let deadline = Instant::now() + patience;
        let mut changed = std::mem::take(&mut self.missed);
        let mut first = (!changed.is_empty()).then(Instant::now);
        let mut last = first;
        loop {
            let until = match (first, last) {
                (Some(first), Some(last)) => (last + QUIET).min(first + LONGEST_BURST),
                _ => deadline,
            };
            match self.events.recv_timeout(until.saturating_duration_since(Instant::now())) {
                Ok((_, None)) if first.is_none() => return Ok(None),
                Ok((_, None)) => {}
                Ok((at, Some(event))) => {
                    let found = self.relevant(&event?);
                    if !found.is_empty() && at >= self.read_at {
                        first.get_or_insert(at);
                        last = Some(at);
                        changed.extend(found);
                    }
                }
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(notify::Error::generic("the system no longer tells of changes"));
                }
            }
        }
        Ok(first.map(|first| Change {
            noticing: noticing(&changed, first),
            files: changed.into_iter().collect(),
            first,
        }))
    }

    /// Which files of the set an event may concern: those it names, and all below a folder that
    /// it names.
    fn relevant(&self, event: &notify::Event) -> Vec<PathBuf> {
        let changes = match event.kind {
            EventKind::Create(_) | EventKind::Remove(_) => true,
            EventKind::Modify(ModifyKind::Metadata(_)) => false,
            EventKind::Modify(_) => true,
            // The system lost events: anything may have changed.
            _ if event.need_rescan() => return self.files.iter().cloned().collect(),
            _ => false,
        };
        let concerned = |file: &&PathBuf| changes && event.paths.iter().any(|path| file.starts_with(path));
        // A watched folder reports itself when something in it is touched.
        let is_watched = |path: &PathBuf| self.folders.contains(path) || self.above.contains(path);
        let itself = event.paths.iter().all(is_watched) && path_is_there(event);
        if itself { Vec::new() } else { self.files.iter().filter(concerned).cloned().collect() }
    }
}

fn path_is_there(event: &notify::Event) -> bool {
    !matches!(event.kind, EventKind::Remove(_) | EventKind::Create(_) | EventKind::Modify(ModifyKind::Name(_)))
}

fn absolute(path: &Path) -> PathBuf {
    normalize(&std::path::absolute(path).unwrap_or_else(|_| path.to_owned()))
}

/// The folders above, up to the one around that in which all of them stand.
fn above(folders: &BTreeSet<PathBuf>) -> BTreeSet<PathBuf> {
    let (Some(first), Some(last)) = (folders.first(), folders.last()) else { return BTreeSet::new() };
    // Of a sorted set the first and the last have no more in common than all.
    let common = first.ancestors().find(|ancestor| last.starts_with(ancestor));
    let end = common.and_then(Path::parent).or(common);
    let up = |folder: &PathBuf| {
        let chain = folder.ancestors().skip(1).map(Path::to_owned);
        chain.take_while(|ancestor| end.is_some_and(|end| ancestor.starts_with(end))).collect::<Vec<_>>()
    };
    folders.iter().flat_map(up).collect()
}

/// The folder to watch for a file: its own, or the nearest above it that is there.
fn nearest_folder(file: &Path) -> Option<PathBuf> {
    file.ancestors().skip(1).find(|folder| folder.is_dir()).map(Path::to_owned)
}

fn saved(file: &Path) -> Option<SystemTime> {
    std::fs::metadata(file).and_then(|data| data.modified()).ok()
}

fn noticing(files: &BTreeSet<PathBuf>, first: Instant) -> Duration {
    let since_event = first.elapsed();
    let now = SystemTime::now();
    let since_save = files.iter().filter_map(|file| now.duration_since(saved(file)?).ok()).max();
    // A file that was moved into place may have been saved long ago.
    since_save.filter(|age| *age < since_event + Duration::from_secs(1)).unwrap_or(since_event).max(since_event)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folders_above_end_around_all_of_them() {
        let set = |all: &[&str]| all.iter().map(PathBuf::from).collect::<BTreeSet<_>>();
        let found = above(&set(&["/home/a/p/graphs/parts", "/home/a/p/graphs", "/home/a/p/shaders/dots"]));
        assert_eq!(found, set(&["/home/a", "/home/a/p", "/home/a/p/graphs", "/home/a/p/shaders"]));
        assert_eq!(above(&set(&["/a/b", "/c"])), set(&["/", "/a"]));
        assert_eq!(above(&set(&["/a"])), set(&["/"]));
        assert_eq!(above(&set(&[])), set(&[]));
    }
}
