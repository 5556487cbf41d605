//! How fast particle files reach the device: `cargo bench --bench loading`, with `MENISCUS_BENCH_MILLIONS=12.6` for other sizes.
//!
//! For each file: the time of reading it and copying its bytes, which is what no loader can go below, and the time
//! from the file to the device, as the program goes: read, decoded, checked, packed and written to a buffer. The ratio is
//! what counts; below a half for any file the bench fails. Files are made in the system's temporary folder, and read once before
//! the times are taken, so that the disk does not count.

#![allow(clippy::unwrap_used, reason = "a bench fails by panicking")]

use std::fs;
use std::hint::black_box;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

use meniscus::diagnostic::Diagnostics;
use meniscus::engine::{Gpu, GpuOptions};
use meniscus::files::{DiskFiles, Files as _};
use meniscus::host::sequence::{Frames, Track};
use meniscus::host::{Player, When};
use meniscus::scene::sequence::Pattern;
use meniscus::scene::{convert, particles};

const REPEATS: usize = 5;

fn position(i: usize) -> [f32; 3] {
    [(i % 233) as f32 * 0.01, (i / 233 % 233) as f32 * 0.01, (i / 54_289) as f32 * 0.01]
}

/// Legacy VTK, binary, with velocities or without.
fn vtk(path: &Path, count: usize, velocity: bool) {
    let mut out = BufWriter::new(fs::File::create(path).unwrap());
    write!(out, "# vtk DataFile Version 4.2\nbench\nBINARY\nDATASET POLYDATA\nPOINTS {count} float\n").unwrap();
    (0..count).for_each(|i| position(i).iter().for_each(|x| out.write_all(&x.to_be_bytes()).unwrap()));
    if velocity {
        write!(out, "\nPOINT_DATA {count}\nVECTORS velocity float\n").unwrap();
        (0..count).for_each(|i| position(i + 7).iter().for_each(|x| out.write_all(&x.to_be_bytes()).unwrap()));
    }
}

/// The old BGEO with ids and velocities, as solvers write it.
fn bgeo(path: &Path, count: usize) {
    let mut out = BufWriter::new(fs::File::create(path).unwrap());
    out.write_all(b"BgeoV").unwrap();
    let counts = [5, count as i32, 0, 0, 0, 2, 0, 0, 0];
    counts.iter().for_each(|n| out.write_all(&n.to_be_bytes()).unwrap());
    for (name, kind, size) in [("id", 1_i32, 1_u16), ("velocity", 5, 3)] {
        out.write_all(&(name.len() as u16).to_be_bytes()).unwrap();
        out.write_all(name.as_bytes()).unwrap();
        out.write_all(&size.to_be_bytes()).unwrap();
        out.write_all(&kind.to_be_bytes()).unwrap();
        out.write_all(&vec![0; 4 * usize::from(size)]).unwrap();
    }
    for i in 0..count {
        let [x, y, z] = position(i);
        [x, y, z, 1.0].iter().for_each(|x| out.write_all(&x.to_be_bytes()).unwrap());
        out.write_all(&(i as i32).to_be_bytes()).unwrap();
        position(i + 7).iter().for_each(|x| out.write_all(&x.to_be_bytes()).unwrap());
    }
}

fn xyz(path: &Path, count: usize) {
    let mut out = BufWriter::new(fs::File::create(path).unwrap());
    (0..count).for_each(|i| position(i).iter().for_each(|x| out.write_all(&x.to_le_bytes()).unwrap()));
}

/// The median of some runs, in milliseconds.
fn median(mut run: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..REPEATS)
        .map(|_| {
            let began = Instant::now();
            run();
            began.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[REPEATS / 2]
}

/// Plays numbered files of `count` particles from the disk at 25 frames a second: the longest wait for a frame once two
/// are read ahead, and how long a frame takes to read.
fn play(folder: &Path, count: usize) {
    const FRAMES: u64 = 24;
    let pattern = Pattern::of(&folder.join("play_##.bgeo")).unwrap();
    (0..FRAMES).for_each(|n| bgeo(&pattern.path(n), count));
    let one_ms = median(|| {
        let path = pattern.path(0);
        black_box(particles::read(&path, &DiskFiles.read(&path).unwrap()).unwrap());
    });
    let track = Track {
        input: "particles".to_owned(),
        frames: Frames::leading(pattern.clone(), 0..=FRAMES - 1, 25.0),
        taken: particles::Taken::default(),
        radius_m: 0.01,
        bounds: None,
        none: None,
    };
    let mut player = Player::new(&[track], When::Frame(0), DiskFiles);
    let (began, mut longest_ms) = (Instant::now(), 0.0_f64);
    for n in 0..FRAMES {
        sleep(Duration::from_millis(40 * n).saturating_sub(began.elapsed()));
        let asked = Instant::now();
        let mut found = Diagnostics::new();
        black_box(player.inputs(When::Frame(n), &mut found));
        assert!(found.is_empty());
        if n > 2 {
            longest_ms = longest_ms.max(asked.elapsed().as_secs_f64() * 1e3);
        }
    }
    (0..FRAMES).for_each(|n| fs::remove_file(pattern.path(n)).unwrap());
    println!(
        "a sequence of {count} particles a frame: {one_ms:.0} ms to read one, longest wait {longest_ms:.0} ms at 25 frames a second"
    );
}

/// Of the speed of reading a file and copying its bytes, what has to be reached.
const LEAST: f64 = 0.5;

fn main() -> ExitCode {
    let millions = std::env::var("MENISCUS_BENCH_MILLIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(12.6_f64);
    let count = (millions * 1e6) as usize;
    let folder = std::env::temp_dir().join(format!("meniscus-loading-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let device =
        Gpu::open(&GpuOptions::default()).map_err(|error| eprintln!("without a device: {}", error.message)).ok();
    println!("{millions} million particles");
    println!("{:>24} {:>8} {:>12} {:>12} {:>12} {:>7}", "file", "MiB", "read+copy", "decoded", "on device", "ratio");
    type Write = fn(&Path, usize);
    let files: [(&str, Write); 4] = [
        ("positions.vtk", |path, count| vtk(path, count, false)),
        ("velocities.vtk", |path, count| vtk(path, count, true)),
        ("ids_velocities.bgeo", bgeo),
        ("positions.xyz", xyz),
    ];
    let mut is_within = true;
    for (name, write) in files {
        let path = folder.join(name);
        write(&path, count);
        is_within &= measure(name, &path, device.as_ref()) >= LEAST;
        fs::remove_file(&path).unwrap();
    }
    play(&folder, 500_000);
    fs::remove_dir_all(&folder).unwrap();
    if is_within {
        return ExitCode::SUCCESS;
    }
    eprintln!("a file loads at less than {LEAST} of the speed at which it is read and copied");
    ExitCode::FAILURE
}

/// How fast a file comes to the device, of the speed of reading and copying it.
fn measure(name: &str, path: &PathBuf, device: Option<&Gpu>) -> f64 {
    let size = fs::read(path).unwrap().len();
    let floor_ms = median(|| {
        let bytes = fs::read(path).unwrap();
        black_box(bytes.clone());
    });
    let decoded_ms = median(|| {
        let bytes = DiskFiles.read(path).unwrap();
        black_box(particles::read(path, &bytes).unwrap());
    });
    let device_ms = device.map(|gpu| {
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size as u64,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        median(|| {
            let bytes = DiskFiles.read(path).unwrap();
            let set = particles::read(path, &bytes).unwrap();
            // What graphs ask for most: the positions.
            let rows = convert::rows(&set.attributes[0], None, 12).unwrap();
            gpu.queue().write_buffer(&buffer, 0, &rows);
            gpu.queue().submit([]);
            gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        })
    });
    let ratio = floor_ms / device_ms.unwrap_or(decoded_ms);
    let mib = size >> 20;
    let device_ms = device_ms.map_or_else(|| "-".into(), |ms| format!("{ms:.0} ms"));
    println!("{name:>24} {mib:>8} {floor_ms:>9.0} ms {decoded_ms:>9.0} ms {device_ms:>12} {ratio:>7.2}");
    ratio
}
