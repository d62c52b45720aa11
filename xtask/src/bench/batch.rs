//! Many small programs against one large one of the same bytes: what a program costs besides its blocks.

use std::io::Write;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, ensure};
use clap::Args;

use super::measure::{Run, best, run};
use super::programs;
use crate::markdown::table;

/// Options of the benchmark of `vpost batch`.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// How many small programs.
    #[arg(long, default_value_t = 10_000)]
    programs: u64,
    /// Mean size of one, kB; sizes run from a fifth of it to nine fifths.
    #[arg(long, default_value_t = 12)]
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
    let bytes = release(&path("release"), options)?;
    let mut large = std::io::BufWriter::new(std::fs::File::create(path("large.nc"))?);
    programs::dense(bytes, &mut large)?;
    large.flush()?;
    let shared = |command: &mut Command| {
        command.args(["-d", "fanuc", "-q", "-m"]).arg(&options.profile).stdout(std::process::Stdio::null());
    };
    let batch = |jobs: usize, fresh: bool| {
        let mut command = Command::new(&vpost);
        command
            .arg("batch")
            .arg(path("release"))
            .arg("-O")
            .arg(path("out"))
            .args(["--jobs", &jobs.to_string()]);
        shared(&mut command);
        best(options.repeat, || {
            if fresh && path("out").exists() {
                std::fs::remove_dir_all(path("out"))?;
            }
            run(&mut command)
        })
    };
    let mut single = Command::new(&vpost);
    single.arg(path("large.nc")).arg("-o").arg(path("large.out.nc")).env("RAYON_NUM_THREADS", "1");
    shared(&mut single);

    let one = best(options.repeat, || run(&mut single))?;
    let batch_one = batch(1, true)?;
    let batch_two = batch(2, true)?;
    let again = batch(1, false)?;
    let alone = alone(&vpost, &path("release"), &path("alone"), &shared)?;

    let whole = bytes as f64 / 1e6;
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
        row(&format!("`batch --jobs 1`, {} programs", options.programs), whole, batch_one),
        row(&format!("`batch --jobs 2`, {} programs", options.programs), whole, batch_two),
        row("the same again: nothing to do, every hash checked", whole, again),
        row(&format!("{ALONE} of them, a process for each"), alone.0, alone.1),
    ];
    let start_ms = (alone.1.cpu_s / ALONE as f64 - alone.0 / ALONE as f64 / per_cpu(one, whole)) * 1e3;
    let extra_us = (batch_one.cpu_s - one.cpu_s) / options.programs as f64 * 1e6;
    Ok(format!(
        "{} programs of {:.1} kB on average, straight feed motion in three axes.\n\n{}\nBeyond its blocks a program costs {extra_us:.0} µs in a batch (open, read, hash, write, rename, journal), and {start_ms:.1} ms in a process of its own.\n",
        options.programs,
        whole * 1e3 / options.programs as f64,
        table(&["what", "MB", "s", "CPU s", "MB per CPU s", "of one program", "peak MiB"], &rows),
    ))
}

/// Writes the programs; their bytes together.
fn release(folder: &Path, options: &Options) -> anyhow::Result<u64> {
    let mut bytes = 0;
    for number in 0..options.programs {
        let below = folder.join(format!("op{:02}", number % 20));
        std::fs::create_dir_all(&below)?;
        let mut text = Vec::new();
        programs::dense(options.kilobytes * 1000 * (1 + number % 9) / 5, &mut text)?;
        bytes += text.len() as u64;
        std::fs::write(below.join(format!("part{number:05}.nc")), text)?;
    }
    Ok(bytes)
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
