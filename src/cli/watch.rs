//! `meniscus watch`: a picture that follows its files. A change is loaded, built and drawn aside;
//! only if all of it works is the picture written. Else the error is shown and the picture stays.

use std::time::{Duration, Instant, SystemTime};

use super::args::WatchArgs;
use super::output::Output;
use super::report::{Exit, report, say};
use super::session::{Opening, job, when};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::engine::any_device_gone;
use crate::files::DiskFiles;
use crate::host::picture::PictureKind;
use crate::host::{Cache, Job, Player, Session, load, renderable};
use crate::reload::{Change, Watch};

pub fn run(args: &WatchArgs) -> Exit {
    match watch(args) {
        Ok(never) => match never {},
        Err(found) => report(&found, &Sources::new()),
    }
}

fn watch(args: &WatchArgs) -> Result<std::convert::Infallible, Diagnostics> {
    let Some(kind) = PictureKind::of(&args.output) else {
        let message = format!("`{}`: pictures are written as .png or .exr", args.output.display());
        return Err(Diagnostic::error(Code::USAGE, message).into());
    };
    renderable(&DiskFiles, &args.scene.scene)?;
    // Told at once if the folder is not there; the place is made anew for each picture.
    drop(Output::reserve(&args.output)?);
    let opening = Opening::begin(args.scene.backend.as_deref());
    let mut watch = Watch::new().map_err(|error| blind(&error))?;
    let mut job = job(&args.scene);
    job.transparent = args.transparent;
    job.when = when(args.when);
    let session = Session::new(opening.wait()?);
    let mut follower = Follower { args, kind, job, session, cache: Cache::default(), reloads: 0 };
    let mut change = None;
    loop {
        let since = SystemTime::now();
        let read = follower.reload(change.as_ref())?;
        watch.set(read.iter().map(|path| path.as_path()), since).map_err(|error| blind(&error))?;
        change = loop {
            if let Some(change) = watch.next(Duration::from_secs(3600)).map_err(|error| blind(&error))? {
                break Some(change);
            }
        };
    }
}

fn blind(error: &notify::Error) -> Diagnostic {
    let message = format!("changes cannot be watched: {error}");
    Diagnostic::error(Code::OUTPUT, message).hint("on Linux, `sysctl fs.inotify.max_user_watches` may be too low")
}

struct Follower<'a> {
    args: &'a WatchArgs,
    kind: PictureKind,
    job: Job,
    session: Session,
    cache: Cache,
    reloads: usize,
}

/// Where the time of a reload went, in milliseconds.
struct Times {
    checking: f64,
    building: f64,
    drawing: f64,
    pipelines: (usize, usize),
}

impl Follower<'_> {
    /// Loads, builds, draws and writes; says what came of it, and gives the files to watch.
    ///
    /// # Errors
    /// If the device is gone. All else is shown, and waits for the next change.
    fn reload(&mut self, change: Option<&Change>) -> Result<Vec<std::path::PathBuf>, Diagnostics> {
        let mut sources = Sources::new();
        let began = Instant::now();
        let loaded = load(&DiskFiles, &mut sources, &self.job, &mut self.cache);
        let checking = began.elapsed();
        let mut found = loaded.diagnostics;
        let drawn = match loaded.content {
            Some(content) => self.picture(content, checking, &mut found),
            None => Err(Diagnostics::new()),
        };
        match drawn {
            Ok(times) => {
                report(&found, &sources);
                say(&self.line(change, &times));
            }
            Err(errors) => {
                let gone = any_device_gone(&errors);
                found.extend(errors);
                if gone {
                    return Err(found);
                }
                report(&found, &sources);
                let kept = if self.reloads > 0 { "the last good picture stays" } else { "there is no picture yet" };
                say(&format!("{kept}; waiting for a change"));
            }
        }
        Ok(loaded.read)
    }

    fn picture(
        &mut self,
        content: crate::host::Content,
        checking: Duration,
        found: &mut Diagnostics,
    ) -> Result<Times, Diagnostics> {
        let began = Instant::now();
        let built = self.session.build(content)?;
        found.extend(built.diagnostics);
        let building = began.elapsed();
        let began = Instant::now();
        let (when, presents) = (self.job.when, self.kind == PictureKind::Png);
        let drawn = if self.session.steps_see_files() {
            self.session.reset()?;
            let mut player = Player::new(self.session.tracks(), when, DiskFiles);
            self.session.draw_at(when, &mut player, presents)?
        } else {
            self.session.draw(when.moment(self.session.tracks().first()), presents)?
        };
        found.extend(drawn.diagnostics);
        let bytes = self.session.encoded(self.kind, self.args.transparent)?;
        Output::reserve(&self.args.output)?.write(&bytes)?;
        Ok(Times {
            checking: ms(checking),
            building: ms(building),
            drawing: ms(began.elapsed()),
            pipelines: (built.pipelines_built, built.pipelines_reused),
        })
    }

    fn line(&mut self, change: Option<&Change>, times: &Times) -> String {
        self.reloads += 1;
        let Times { checking, building, drawing, pipelines: (rebuilt, kept) } = times;
        let output = self.args.output.display();
        let parts = format!("checking {checking:.1}, building {building:.1}, drawing {drawing:.1}");
        let pipelines = format!("{rebuilt} pipelines rebuilt, {kept} kept");
        match change {
            None => format!("{output}: drawn in {:.1} ms ({parts}); {pipelines}", checking + building + drawing),
            Some(change) => {
                let noticing = ms(change.noticing);
                let all = noticing + checking + building + drawing;
                format!("{output}: reloaded in {all:.1} ms (noticing {noticing:.1}, {parts}); {pipelines}")
            }
        }
    }
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
