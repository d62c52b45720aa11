//! Many small programs against one large one of the same bytes, and against their files alone: what a program costs
//! besides its blocks.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, ensure};
use clap::Args;

use super::measure::{Run, best, own_cpu_s, run};
use super::programs;
use crate::markdown::table;

/// Options of the benchmark of `vpost batch`.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// How many small programs.
    #[arg(long, default_value_t = 10_000)]
    programs: u64,
    /// Mean size of one, kB; sizes run from a fifth of it to nine fifths.
    #[arg(long, default_value_t = 6)]
    kilobytes: u64,
    /// Repetitions, of which the best counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Machine profile.
    #[arg(long, default_value = "machine-profiles/stan_s500.toml")]
    profile: std::path::PathBuf,
}

/// Of so many programs each gets a process of its own, to see what starting one costs.
const ALONE: usize = 200;

/// Arguments: how many programs, the programs, the command for each.
const ONE_AFTER_ANOTHER: &str =
    r#"n=$1; shift; for program in "${@:1:n}"; do "${@:n+1}" "$program" -o "$OUT" || exit 1; done"#;

/// Measures, and returns a section for docs/performance.md.
pub(crate) fn run_all(options: &Options) -> anyhow::Result<String> {
    let vpost = crate::gap_bench::released()?;
    let folder = tempfile::tempdir()?;
    let path = |name: &str| folder.path().join(name);
    let release = release(&path("release"), options)?;
    let bytes: u64 = release.iter().map(|program| program.1).sum();
    write(&path("large.nc"), |out| programs::dense(bytes, out))?;
    let sizes = release.iter().map(|program| program.1);
    write(&path("joined.nc"), |out| programs::dense_parts(sizes, out))?;
    let shared = |command: &mut Command| {
        command.args(["-d", "fanuc", "-q", "-m"]).arg(&options.profile).stdout(std::process::Stdio::null());
    };
    // Every run gets a folder of its own, and none is removed before the end: where ten thousand files were just
    // removed, ext4 takes its time to make new ones, whoever makes them.
    let batch = |jobs: usize, folder: PathBuf| {
        let mut command = Command::new(&vpost);
        command.arg("batch").arg(path("release")).arg("-O").arg(folder).args(["--jobs", &jobs.to_string()]);
        shared(&mut command);
        run(&mut command)
    };
    let folders = std::cell::Cell::new(0);
    let last = || path(&format!("out{}", folders.get()));
    let fresh = || {
        folders.set(folders.get() + 1);
        last()
    };
    let single = |name: &str| {
        let mut command = Command::new(&vpost);
        command.arg(path(name)).arg("-o").arg(path("one.out.nc")).env("RAYON_NUM_THREADS", "1");
        shared(&mut command);
        best(options.repeat, || run(&mut command))
    };
    let one = single("large.nc")?;
    let joined = single("joined.nc")?;
    let files = best(options.repeat, || files_alone(&release, &fresh()))?;
    let batch_one = best(options.repeat, || batch(1, fresh()))?;
    let batch_two = best(options.repeat, || batch(2, fresh()))?;
    let again = best(options.repeat, || batch(1, last()))?;
    let alone = alone(&vpost, &path("release"), &path("alone"), &shared)?;

    let whole = bytes as f64 / 1e6;
    let joined_megabytes = path("joined.nc").metadata()?.len() as f64 / 1e6;
    let per_cpu = |run: Run, megabytes: f64| megabytes / run.cpu_s.max(1e-3);
    let row = |what: &str, megabytes: f64, run: Run| {
        vec![
            what.to_owned(),
            format!("{megabytes:.1}"),
            format!("{:.2}", run.wall_s),
            format!("{:.2}", run.cpu_s),
            format!("{:.0}", per_cpu(run, megabytes)),
            format!("{:.0} %", per_cpu(run, megabytes) / per_cpu(one, whole) * 100.0),
            format!("{:.0}", run.peak_mib),
        ]
    };
    let rows = [
        row("one program of the same bytes, 1 thread", whole, one),
        row("all of them one behind the other in one file, 1 thread", joined_megabytes, joined),
        row("their files alone: read, write beside, rename, nothing else", whole, files),
        row(&format!("`batch --jobs 1`, {} programs", options.programs), whole, batch_one),
        row(&format!("`batch --jobs 2`, {} programs", options.programs), whole, batch_two),
        row("the same again: nothing to do, every hash checked", whole, again),
        row(&format!("{ALONE} of them, a process for each"), alone.0, alone.1),
    ];
    let start_ms = (alone.1.cpu_s / ALONE as f64 - alone.0 / ALONE as f64 / per_cpu(one, whole)) * 1e3;
    let each_us = |seconds: f64| seconds / options.programs as f64 * 1e6;
    let [extra_us, opening_us, files_us] =
        [batch_one.cpu_s - one.cpu_s, joined.cpu_s - one.cpu_s, files.cpu_s].map(each_us);
    Ok(format!(
        "{} programs of {:.1} kB on average, straight feed motion in three axes.\n\n{}\n\
        Beyond its cutting blocks a program costs {extra_us:.0} µs in a batch: {opening_us:.0} µs of it are its opening blocks and its approach, {files_us:.0} µs its files, {:.0} µs all else (find, hash, journal, results); in a process of its own {start_ms:.1} ms.\n\
        The batch runs at {:.0} % of what blocks and files take alone.\n",
        options.programs,
        whole * 1e3 / options.programs as f64,
        table(&["what", "MB", "s", "CPU s", "MB per CPU s", "of one program", "peak MiB"], &rows),
        extra_us - opening_us - files_us,
        (joined.cpu_s + files.cpu_s) / batch_one.cpu_s * 100.0,
    ))
}

/// Writes a file.
fn write(
    path: &Path,
    program: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> anyhow::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    program(&mut out)?;
    Ok(out.flush()?)
}

/// What the file system takes for a batch's files, and no correction: each is read, written beside and renamed.
fn files_alone(release: &[(PathBuf, u64)], out: &Path) -> anyhow::Result<Run> {
    std::fs::create_dir_all(out)?;
    let (started, begun) = (Instant::now(), own_cpu_s());
    for (number, (path, _)) in release.iter().enumerate() {
        let text = std::fs::read(path)?;
        let beside = out.join("beside");
        File::create_new(&beside)?.write_all(&text)?;
        std::fs::rename(beside, out.join(format!("{number}")))?;
    }
    Ok(Run { wall_s: started.elapsed().as_secs_f64(), cpu_s: own_cpu_s() - begun, peak_mib: 0.0 })
}

/// Writes the programs; their paths and bytes.
fn release(folder: &Path, options: &Options) -> anyhow::Result<Vec<(PathBuf, u64)>> {
    let mut release = Vec::new();
    for number in 0..options.programs {
        let below = folder.join(format!("op{:02}", number % 20));
        std::fs::create_dir_all(&below)?;
        let mut text = Vec::new();
        programs::dense(options.kilobytes * 1000 * (1 + number % 9) / 5, &mut text)?;
        let path = below.join(format!("part{number:05}.nc"));
        std::fs::write(&path, &text)?;
        release.push((path, text.len() as u64));
    }
    Ok(release)
}

/// The first programs, a process for each: megabytes, and what all of them took together.
fn alone(
    vpost: &Path,
    release: &Path,
    out: &Path,
    shared: &dyn Fn(&mut Command),
) -> anyhow::Result<(f64, Run)> {
    let folder = release.join("op00");
    let mut paths: Vec<_> = std::fs::read_dir(&folder)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()
        .with_context(|| folder.display().to_string())?;
    paths.sort();
    paths.truncate(ALONE);
    ensure!(paths.len() == ALONE, "only {} programs for a process each", paths.len());
    std::fs::create_dir_all(out)?;
    // One shell starts them all, so that the processor's time of all is one figure.
    let mut command = Command::new("bash");
    command.args(["-c", ONE_AFTER_ANOTHER, "bash"]);
    command
        .arg(ALONE.to_string())
        .args(&paths)
        .arg(vpost)
        .env("OUT", out.join("out.nc"))
        .env("RAYON_NUM_THREADS", "1");
    shared(&mut command);
    let wall = run(&mut command)?;
    let bytes: u64 = paths.iter().filter_map(|path| path.metadata().ok()).map(|data| data.len()).sum();
    Ok((bytes as f64 / 1e6, wall))
}
