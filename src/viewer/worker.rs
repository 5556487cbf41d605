//! The thread that loads, checks, plans and compiles, so that no frame waits for any of it. It
//! watches what it last read, and answers each change and each wish with a [`Round`].

use std::cell::Cell;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

use super::params::{self, Overrides};
use super::sequences::Sequences;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::files::DiskFiles;
use crate::host::{Builder, Cache, Content, Job, Planned, When, load};
use crate::reload::{Waker, Watch};

/// What the window wants beside what files say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wants {
    pub params: Overrides,
    /// Pixels; absent: as the scene says.
    pub viewport: Option<[u32; 2]>,
    /// Instance paths that are looked at.
    pub roots: Vec<String>,
    /// Whether statistics are looked at: passes that only they need run then.
    pub stats: bool,
    /// Which frame of sequences.
    pub when: When,
}

/// Why the worker worked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    Opened(PathBuf),
    Changed(Vec<PathBuf>),
    Wanted,
}

/// One piece of work, done.
#[derive(Debug)]
pub struct Round {
    pub cause: Cause,
    /// Absent if something had an error.
    pub planned: Option<Box<Planned>>,
    /// The content as files say, without what the window wants; absent if it was not read anew.
    pub read: Option<Box<Content>>,
    pub diagnostics: Diagnostics,
    pub sources: Sources,
    /// The frame of sequences that it shows.
    pub when: When,
    pub noticing: Duration,
    pub checking: Duration,
    pub building: Duration,
    /// Whether everything that was ordered up to now is in it.
    pub is_last: bool,
}

#[derive(Debug)]
enum Order {
    Open(Box<Job>),
    Reload,
    Want(Wants),
    /// Another device, or more room.
    Build(Box<Builder>),
}

/// The other end of the thread.
#[derive(Debug)]
pub struct Worker {
    orders: Option<Sender<Order>>,
    ordered: Cell<u64>,
    waker: Waker,
    /// Each with how many orders it has heard.
    rounds: Receiver<(Round, u64)>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread. `news` is called whenever a round can be taken.
    ///
    /// # Errors
    /// If the system has no more room for watchers.
    pub fn start(builder: Builder, news: impl Fn() + Send + 'static) -> Result<Self, Diagnostic> {
        let watch = Watch::new().map_err(|error| blind(&error))?;
        let waker = watch.waker();
        let (orders, inbox) = channel();
        let (outbox, rounds) = channel();
        let thread = thread::spawn(move || {
            let mut bench = Bench {
                builder,
                watch,
                inbox,
                outbox,
                heard: 0,
                news: Box::new(news),
                job: None,
                wants: Wants::default(),
                cache: Cache::default(),
                content: None,
                sources: Sources::new(),
                diagnostics: Diagnostics::new(),
                read: Vec::new(),
                sequences: None,
            };
            bench.work();
        });
        Ok(Self { orders: Some(orders), ordered: Cell::new(0), waker, rounds, thread: Some(thread) })
    }

    pub fn open(&self, job: Job) {
        self.send(Order::Open(Box::new(job)));
    }

    pub fn reload(&self) {
        self.send(Order::Reload);
    }

    pub fn want(&self, wants: Wants) {
        self.send(Order::Want(wants));
    }

    pub fn build_with(&self, builder: Builder) {
        self.send(Order::Build(Box::new(builder)));
    }

    /// A round that is done, oldest first.
    pub fn take(&self) -> Option<Round> {
        let (mut round, heard) = self.rounds.try_recv().ok()?;
        round.is_last = heard == self.ordered.get();
        Some(round)
    }

    /// Whether the thread has ended by a fault.
    pub fn is_gone(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    fn send(&self, order: Order) {
        if let Some(orders) = &self.orders {
            // A thread that is gone does nothing any more; the window still runs.
            self.ordered.set(self.ordered.get() + 1);
            _ = orders.send(order);
            self.waker.wake();
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.orders = None;
        self.waker.wake();
        if let Some(thread) = self.thread.take() {
            // A panic there was told by the runtime.
            _ = thread.join();
        }
    }
}

struct Bench {
    builder: Builder,
    watch: Watch,
    inbox: Receiver<Order>,
    outbox: Sender<(Round, u64)>,
    heard: u64,
    news: Box<dyn Fn() + Send>,
    job: Option<Box<Job>>,
    wants: Wants,
    cache: Cache,
    /// As files say.
    content: Option<Content>,
    /// Texts that the content was read from.
    sources: Sources,
    /// What reading them found.
    diagnostics: Diagnostics,
    /// Files that the content was read from.
    read: Vec<PathBuf>,
    sequences: Option<Sequences>,
}

impl Bench {
    fn work(&mut self) {
        loop {
            let (mut load, mut plan) = (None, false);
            loop {
                let order = self.inbox.try_recv();
                self.heard += u64::from(order.is_ok());
                match order {
                    Ok(Order::Open(job)) => {
                        load = Some(Cause::Opened(job.source.clone()));
                        self.job = Some(job);
                        self.content = None;
                    }
                    Ok(Order::Reload) => load = load.or(Some(Cause::Changed(Vec::new()))),
                    Ok(Order::Want(wants)) => {
                        plan |= wants != self.wants;
                        self.wants = wants;
                    }
                    Ok(Order::Build(builder)) => {
                        self.builder = *builder;
                        plan = true;
                    }
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return,
                }
            }
            if let Some(cause) = load {
                self.load(cause, Duration::ZERO);
            } else if plan && self.content.is_some() {
                let (since, began) = (SystemTime::now(), Instant::now());
                if self.turn() {
                    self.watch_files(since);
                }
                self.plan(Cause::Wanted, Duration::ZERO, began);
            } else if plan {
                // Nothing to plan: who asked is told, and waits no longer.
                self.send(self.failed(Cause::Wanted, Diagnostics::new(), Sources::new()));
            } else {
                self.wait();
            }
        }
    }

    fn wait(&mut self) {
        match self.watch.next(Duration::from_secs(3600)) {
            Ok(Some(change)) => {
                let noticing = change.noticing;
                self.load(Cause::Changed(change.files), noticing);
            }
            Ok(None) => {}
            Err(error) => {
                self.tell_blind(&error);
                // Without events nothing but orders can come.
                thread::sleep(Duration::from_millis(200));
            }
        }
    }

    fn load(&mut self, cause: Cause, noticing: Duration) {
        let Some(mut job) = self.job.clone() else {
            // Nothing to read: who asked is told, and waits no longer.
            self.send(self.failed(cause, Diagnostics::new(), Sources::new()));
            return;
        };
        // What has no camera is framed for the window that shows it.
        job.size = job.size.or(self.wants.viewport);
        let (since, began) = (SystemTime::now(), Instant::now());
        let mut sources = Sources::new();
        let loaded = load(&DiskFiles, &mut sources, &job, &mut self.cache);
        self.read = loaded.read;
        match loaded.content {
            Some(content) => {
                (self.sources, self.diagnostics) = (sources, loaded.diagnostics);
                self.sequences = Sequences::new(&content, job.when);
                self.content = Some(content);
                self.turn();
                self.watch_files(since);
                self.plan(cause, noticing, began);
            }
            None => {
                self.watch_files(since);
                let checking = began.elapsed();
                self.send(Round { noticing, checking, ..self.failed(cause, loaded.diagnostics, sources) });
            }
        }
    }

    /// Puts the frames of sequences that are wanted into the content; tells whether they are others.
    fn turn(&mut self) -> bool {
        match (&mut self.content, &mut self.sequences) {
            (Some(content), Some(sequences)) => sequences.turn(content, self.wants.when),
            _ => false,
        }
    }

    fn watch_files(&mut self, since: SystemTime) {
        let frames = self.sequences.as_ref().map(Sequences::files).unwrap_or_default();
        let all = self.read.iter().chain(&frames).map(PathBuf::as_path);
        if let Err(error) = self.watch.set(all, since) {
            self.tell_blind(&error);
        }
    }

    fn plan(&mut self, cause: Cause, noticing: Duration, began: Instant) {
        let Some(read) = self.content.clone() else { return };
        let mut content = read.clone();
        params::apply(&mut content, &self.wants.params);
        content.stats = self.wants.stats;
        content.viewport = self.wants.viewport.unwrap_or(content.viewport);
        let mut diagnostics = self.diagnostics.clone();
        let told = self.sequences.iter().flat_map(|sequences| sequences.told().iter());
        told.for_each(|found| diagnostics.push(found.clone()));
        let looked_at = content.roots.iter().chain(&self.wants.roots).cloned().collect();
        let wanted = Content { roots: looked_at, ..content.clone() };
        // What is looked at may be gone from the graph: that hinders no picture.
        let planned = self.builder.plan(wanted).or_else(|_| self.builder.plan(content));
        let checking = began.elapsed();
        let began = Instant::now();
        let compiled = planned.and_then(|mut planned| self.builder.compile(&mut planned).map(|()| planned));
        let planned = match compiled {
            Ok(planned) => Some(Box::new(planned)),
            Err(found) => {
                diagnostics.extend(found);
                None
            }
        };
        let read = (cause != Cause::Wanted).then(|| Box::new(read));
        let building = began.elapsed();
        let failed = self.failed(cause, diagnostics, self.sources.clone());
        self.send(Round { planned, read, noticing, checking, building, ..failed });
    }

    /// A round that came to nothing.
    fn failed(&self, cause: Cause, diagnostics: Diagnostics, sources: Sources) -> Round {
        Round {
            cause,
            planned: None,
            read: None,
            diagnostics,
            sources,
            when: self.wants.when,
            noticing: Duration::ZERO,
            checking: Duration::ZERO,
            building: Duration::ZERO,
            is_last: true,
        }
    }

    fn tell_blind(&mut self, error: &notify::Error) {
        self.send(self.failed(Cause::Changed(Vec::new()), blind(error).into(), Sources::new()));
    }

    fn send(&self, round: Round) {
        // A window that is gone wants no news.
        _ = self.outbox.send((round, self.heard));
        (self.news)();
    }
}

fn blind(error: &notify::Error) -> Diagnostic {
    let message = format!("changes cannot be watched: {error}");
    Diagnostic::error(Code::OUTPUT, message).hint("on Linux, `sysctl fs.inotify.max_user_watches` may be too low")
}
