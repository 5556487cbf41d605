//! From the end of a save to the new picture: `cargo bench --bench reload`.
//!
//! 200 edits of one shader of a shipped graph at 640 x 480, followed as `watch` does. The waiting for
//! a burst of saves to end is part of it. Then the same and edits of a module that nearly all shaders
//! import, followed as the window does: how long its thread works at a time. Needs a device.

#![allow(clippy::unwrap_used, reason = "a bench fails by panicking")]

#[path = "../tests/support/follower.rs"]
mod follower;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use follower::{Follower, Outcome, Times};

const EDITS: usize = 200;
const SCENE: &str = "scenes/dam_break.ron";
const SHADER: &str = "shaders/imai2016/refract.wgsl";
/// A module that nearly all shaders import.
const MODULE: &str = "shaders/lib/camera.wgsl";
const SIZE: [u32; 2] = [640, 480];

fn main() {
    let folder = std::env::temp_dir().join(format!("meniscus-bench-{}", std::process::id()));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for part in ["graphs", "shaders", "scenes"] {
        copy(&root.join(part), &folder.join(part));
    }
    let mut follower = Follower::new(folder.join(SCENE), SIZE);
    let Outcome::Drawn { .. } = follower.reload() else { panic!("the scene does not draw") };
    let shader = folder.join(SHADER);
    let text = std::fs::read_to_string(&shader).unwrap();
    let mut all = Vec::new();
    let (mut waits, mut frames) = (Vec::new(), Vec::new());
    for edit in 0..EDITS {
        // A constant that no picture shows: the module is another one each time.
        std::fs::write(&shader, format!("{text}\nconst EDIT = {edit}u;\n")).unwrap();
        let saved = Instant::now();
        let Outcome::Drawn { times, pipelines_built, .. } = follower.follow() else { panic!("refused") };
        assert_eq!(pipelines_built, 1, "one shader is one pipeline");
        all.push(times);
        waits.push(saved.elapsed());
        frames.push(follower.redraw());
    }
    print(&all, &waits, &frames);
    std::fs::write(&shader, &text).unwrap();
    drop(follower);
    #[cfg(feature = "viewer")]
    for name in [SHADER, MODULE] {
        window::run(&folder, name);
    }
    _ = std::fs::remove_dir_all(folder);
}

fn print(all: &[Times], waits: &[Duration], frames: &[Duration]) {
    let row = |what: &str, pick: &dyn Fn(&Times) -> Duration| {
        let [p50, p99] = percentiles(all.iter().map(pick).collect());
        println!("{what:<28} {p50:>9.1} {p99:>9.1}");
    };
    println!("{:<28} {:>9} {:>9}", format!("ms, over {EDITS} edits"), "p50", "p99");
    row("noticing", &|t| t.noticing);
    row("checking", &|t| t.checking);
    row("building", &|t| t.building);
    row("drawing", &|t| t.drawing);
    row("all but drawing", &|t| t.noticing + t.checking + t.building);
    let [p50, p99] = percentiles(waits.to_vec());
    println!("{:<28} {p50:>9.1} {p99:>9.1}", "from save to picture");
    let [p50, p99] = percentiles(frames.to_vec());
    println!("{:<28} {p50:>9.1} {p99:>9.1}", "a whole frame, drawn again");
}

fn percentiles(mut times: Vec<Duration>) -> [f64; 2] {
    times.sort();
    [0.5, 0.99].map(|share| times[((times.len() - 1) as f64 * share).round() as usize].as_secs_f64() * 1e3)
}

fn copy(from: &PathBuf, to: &PathBuf) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        match path.is_dir() {
            true => copy(&path, &target),
            false => _ = std::fs::copy(&path, &target).unwrap(),
        }
    }
}

#[cfg(feature = "viewer")]
mod window {
    use std::path::Path;
    use std::time::{Duration, Instant};

    use meniscus::engine::{Gpu, GpuOptions};
    use meniscus::host::Job;
    use meniscus::viewer::core::Core;

    use super::{SCENE, SIZE, percentiles};

    const EDITS: usize = 50;

    /// Edits a file and lets a window without a window follow.
    pub fn run(folder: &Path, name: &str) {
        let path = folder.join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        let gpu = Gpu::open(&GpuOptions::default()).unwrap();
        let job = Job { source: folder.join(SCENE), size: Some(SIZE), ..Job::default() };
        let mut core = Core::new(gpu, Some(job), || {}).unwrap();
        core.want_size(SIZE);
        until(&mut core, |core| core.state.frames > 0 && !core.is_drawing());
        let (mut longest, mut handing, mut waits, mut built) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for edit in 0..EDITS {
            std::fs::write(&path, format!("{text}\nconst EDIT_W = {edit}u;\n")).unwrap();
            let (saved, reloads) = (Instant::now(), core.state.reloads.len());
            let [own, handed] = until(&mut core, |core| {
                core.state.reloads.len() > reloads && core.state.reloads[0].drawing_ms.is_some()
            });
            longest.push(own);
            handing.push(handed);
            let reload = &core.state.reloads[0];
            assert!(reload.is_good && reload.pipelines_late == 0, "{reload:?}");
            built = reload.pipelines_built;
            waits.push(saved.elapsed());
        }
        std::fs::write(&path, text).unwrap();
        let most = longest.iter().max().unwrap().as_secs_f64() * 1e3;
        let ([work50, work99], [wait50, wait99]) = (percentiles(longest), percentiles(waits));
        println!("the window, {EDITS} edits of {name}, {built} pipelines built each time");
        println!("{:<28} {wait50:>9.1} {wait99:>9.1}", "from save to picture");
        println!("{:<28} {work50:>9.1} {work99:>9.1}   longest {most:.1}", "its thread's longest work");
        // Software drivers compile and draw meanwhile, in the thread that hands the commands over.
        let [hand50, hand99] = percentiles(handing);
        println!("{:<28} {hand50:>9.1} {hand99:>9.1}", "besides: handing over");
    }

    /// Lets it work until something is so; gives the longest that it worked at a time, and besides that the
    /// longest that the driver took for a frame's commands.
    fn until(core: &mut Core, is_so: impl Fn(&Core) -> bool) -> [Duration; 2] {
        let (began, mut longest, mut handing) = (Instant::now(), Duration::ZERO, Duration::ZERO);
        while !is_so(core) {
            let before = Instant::now();
            core.state.handing_over = Duration::ZERO;
            core.tick(before);
            let handed = core.state.handing_over;
            handing = handing.max(handed);
            longest = longest.max(before.elapsed().saturating_sub(handed));
            assert!(began.elapsed() < Duration::from_secs(60), "{:?}", core.state.findings);
            std::thread::sleep(Duration::from_millis(1));
        }
        [longest, handing]
    }
}
