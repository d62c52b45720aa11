//! Many small programs against one large one of the same bytes, and against their files alone: what a program costs
//! besides its blocks, and from which size on that does not matter.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::ensure;
use clap::Args;

use super::measure::{Run, in_turn, own_cpu_s, run, run_anew};
use super::programs;
use crate::markdown::table;

/// Options of the benchmark of `vpost batch`.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// How many small programs, of each size. 10,000 take 17 GB while they are measured.
    #[arg(long, default_value_t = 10_000)]
    programs: usize,
    /// Mean sizes, kB; the programs of one run from a fifth of it to nine fifths. 82 is the smallest program of a CAM
    /// system among the samples, `plate_fanuc.nc`.
    #[arg(long, value_delimiter = ',', default_values_t = [6, 24, 82])]
    kilobytes: Vec<u64>,
    /// Repetitions, of which the best counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Machine profile.
    #[arg(long, default_value = "machine-profiles/stan_s500.toml")]
    profile: PathBuf,
}

/// So many programs get a process each, to see what starting one costs.
const ALONE: usize = 200;

/// Arguments: how many programs, the programs, the command for each.
const ONE_AFTER_ANOTHER: &str =
    r#"n=$1; shift; for program in "${@:1:n}"; do "${@:n+1}" "$program" -o "$OUT" || exit 1; done"#;

/// What is asked for: the share of one program's throughput.
const WANTED: f64 = 0.8;

/// Measures, and returns a section for docs/performance.md.
pub(crate) fn run_all(options: &Options) -> anyhow::Result<String> {
    ensure!(options.programs > 0 && options.repeat > 0, "nothing to measure");
    let vpost = crate::gap_bench::released()?;
    let folder = tempfile::tempdir()?;
    let mut sizes = Vec::new();
    for kilobytes in &options.kilobytes {
        let bench = Bench { vpost: &vpost, options, folder: folder.path().join(format!("{kilobytes}")) };
        sizes.push(bench.measured(*kilobytes)?);
    }
    let rows: Vec<Vec<String>> = sizes.iter().flat_map(Size::rows).collect();
    let head = [
        "kB",
        "what",
        "s",
        "CPU s",
        "MB per CPU s",
        "of one program",
        "of the same blocks in one file",
        "on the clock",
        "peak MiB",
    ];
    let mut text = format!(
        "{} programs of each size, straight feed motion in three axes.\n\n{}\n",
        options.programs,
        table(&head, &rows)
    );
    for size in &sizes {
        text += &size.besides();
    }
    text += &sizes.first().map(Size::parts).unwrap_or_default();
    if let [first, .., last] = sizes.as_slice() {
        text += &Line::through(first, last).text(&sizes);
    }
    Ok(text)
}

/// The runs of one size.
struct Bench<'a> {
    vpost: &'a Path,
    options: &'a Options,
    folder: PathBuf,
}

/// What the runs of one size took.
struct Size {
    programs: usize,
    bytes: u64,
    /// One program of the same bytes, with one thread and with two.
    one: [Run; 2],
    /// The programs as operations of one.
    joined: Run,
    /// Their files alone, without any correction.
    files: Run,
    /// `batch --jobs 1` and `--jobs 2`.
    batch: [Run; 2],
    /// The batch again, where all is done.
    again: Run,
    /// A process for each of the first programs: how many, their bytes.
    alone: (usize, u64, Run),
}

impl Bench<'_> {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn shared(&self, command: &mut Command) {
        command.args(["-d", "fanuc", "-q", "-m"]).arg(&self.options.profile).stdout(Stdio::null());
    }

    /// Every run gets a folder of its own, and none is removed before the end: ext4 gives out no inode again that was
    /// freed a minute ago, and looks for another one by one, whoever makes a file.
    fn measured(&self, kilobytes: u64) -> anyhow::Result<Size> {
        let release = self.release(kilobytes)?;
        let bytes = release.iter().map(|program| program.1).sum();
        write(&self.path("large.nc"), |out| programs::dense(bytes, out))?;
        let sizes = release.iter().map(|program| program.1);
        write(&self.path("joined.nc"), |out| programs::dense_parts(sizes, out))?;
        let runs = in_turn(self.options.repeat, |number| {
            let out = |name: &str| self.path(&format!("{name}{number}"));
            Ok([
                self.single("large.nc", 1)?,
                self.single("large.nc", 2)?,
                self.single("joined.nc", 1)?,
                files_alone(&release, &out("files"))?,
                self.batch(1, &out("one"))?,
                self.batch(2, &out("two"))?,
                self.batch(1, &out("one"))?,
            ])
        })?;
        let [one, two, joined, files, batch, batch_two, again] = runs;
        Ok(Size {
            programs: release.len(),
            bytes,
            one: [one, two],
            joined,
            files,
            batch: [batch, batch_two],
            again,
            alone: self.alone(&release)?,
        })
    }

    /// Writes the programs; their paths and bytes.
    fn release(&self, kilobytes: u64) -> anyhow::Result<Vec<(PathBuf, u64)>> {
        let mut texts = Vec::new();
        for fifths in 1..=9 {
            let mut text = Vec::new();
            programs::dense(kilobytes * 1000 * fifths / 5, &mut text)?;
            texts.push(text);
        }
        let mut release = Vec::new();
        for (number, text) in texts.iter().cycle().take(self.options.programs).enumerate() {
            let below = self.path("release").join(format!("op{:02}", number % 20));
            std::fs::create_dir_all(&below)?;
            let path = below.join(format!("part{number:05}.nc"));
            std::fs::write(&path, text)?;
            release.push((path, text.len() as u64));
        }
        Ok(release)
    }

    fn single(&self, name: &str, threads: usize) -> anyhow::Result<Run> {
        let mut command = Command::new(self.vpost);
        let out = self.path("one.out.nc");
        command.arg(self.path(name)).arg("-o").arg(&out);
        command.env("RAYON_NUM_THREADS", threads.to_string());
        self.shared(&mut command);
        // One file less is nothing to ext4.
        run_anew(&mut command, &out)
    }

    fn batch(&self, jobs: usize, out: &Path) -> anyhow::Result<Run> {
        let mut command = Command::new(self.vpost);
        command.arg("batch").arg(self.path("release")).arg("-O").arg(out).args(["--jobs", &jobs.to_string()]);
        self.shared(&mut command);
        run(&mut command)
    }

    /// The first programs, a process for each.
    fn alone(&self, release: &[(PathBuf, u64)]) -> anyhow::Result<(usize, u64, Run)> {
        let first = &release[..release.len().min(ALONE)];
        // One shell starts them all, so that the processor's time of all is one figure.
        let mut command = Command::new("bash");
        command
            .args(["-c", ONE_AFTER_ANOTHER, "bash", &first.len().to_string()])
            .args(first.iter().map(|program| &program.0))
            .arg(self.vpost)
            .env("OUT", self.path("alone.out.nc"))
            .env("RAYON_NUM_THREADS", "1");
        self.shared(&mut command);
        Ok((first.len(), first.iter().map(|program| program.1).sum(), run(&mut command)?))
    }
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

/// What the file system takes for a batch's files at the least, and no correction: each is read and written.
fn files_alone(release: &[(PathBuf, u64)], out: &Path) -> anyhow::Result<Run> {
    std::fs::create_dir_all(out)?;
    let (started, begun) = (Instant::now(), own_cpu_s());
    for (number, (path, _)) in release.iter().enumerate() {
        let text = std::fs::read(path)?;
        File::create_new(out.join(format!("{number}")))?.write_all(&text)?;
    }
    Ok(Run { wall_s: started.elapsed().as_secs_f64(), cpu_s: own_cpu_s() - begun, peak_mib: 0.0 })
}

impl Size {
    /// Mean size of a program, kB.
    fn kilobytes(&self) -> f64 {
        self.bytes as f64 / 1e3 / self.programs as f64
    }

    /// A run's processor time for each program, µs.
    fn each_us(&self, run: Run) -> f64 {
        run.cpu_s / self.programs as f64 * 1e6
    }

    /// Share of one program's throughput per second of the processor.
    fn share(&self, run: Run) -> f64 {
        self.one[0].cpu_s / run.cpu_s
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let percent = |share: f64| format!("{:.0} %", share * 100.0);
        // On the clock a run is compared with one program on as many cores.
        let row = |what: &str, run: Run, clock: Option<Run>| {
            vec![
                format!("{:.0}", self.kilobytes()),
                what.to_owned(),
                format!("{:.2}", run.wall_s),
                format!("{:.2}", run.cpu_s),
                format!("{:.0}", self.bytes as f64 / 1e6 / run.cpu_s),
                percent(self.share(run)),
                percent(self.joined.cpu_s / run.cpu_s),
                clock.map_or_else(String::new, |one| percent(one.wall_s / run.wall_s)),
                if run.peak_mib > 0.0 { format!("{:.0}", run.peak_mib) } else { String::new() },
            ]
        };
        let [one, two] = self.one;
        vec![
            row(&format!("one program of {:.0} MB, 1 thread", self.bytes as f64 / 1e6), one, Some(one)),
            row("the same, 2 threads", two, Some(two)),
            row("all of them one behind the other in one file, 1 thread", self.joined, None),
            row("their files alone: read, written, nothing else", self.files, None),
            row("`batch --jobs 1`", self.batch[0], Some(one)),
            row("`batch --jobs 2`", self.batch[1], Some(two)),
            row("the same again: nothing to do, every hash checked", self.again, None),
        ]
    }

    /// What a program costs besides its blocks.
    fn besides(&self) -> String {
        let [one_us, batch_us, files_us] =
            [self.one[0], self.batch[0], self.files].map(|run| self.each_us(run));
        let (count, bytes, run) = self.alone;
        let alone_ms =
            (run.cpu_s - self.one[0].cpu_s / self.bytes as f64 * bytes as f64) / count as f64 * 1e3;
        format!(
            "{:.0} kB: {:.0} µs of a program beyond its {one_us:.0} of one large program; its files alone take {files_us:.0}. In a process of its own {alone_ms:.1} ms.\n",
            self.kilobytes(),
            batch_us - one_us,
        )
    }

    /// The parts of that; to be had of small programs only, since each is a difference of two runs.
    fn parts(&self) -> String {
        let [one_us, joined_us, files_us, batch_us] =
            [self.one[0], self.joined, self.files, self.batch[0]].map(|run| self.each_us(run));
        format!(
            "{:.0} kB: opening blocks and approach {:.0} µs, files {files_us:.0}, all else (find, hash, journal, results) {:.0}. The batch runs at {:.0} % of what blocks and files take alone.\n",
            self.kilobytes(),
            joined_us - one_us,
            batch_us - joined_us - files_us,
            (joined_us + files_us) / batch_us * 100.0,
        )
    }
}

/// A batch's time for a program as a line over its size.
struct Line {
    /// Whatever its size, µs.
    fixed_us: f64,
    /// µs for a kilobyte, and of one large program.
    kilobyte_us: f64,
    one_us: f64,
}

impl Line {
    /// Through the runs of two sizes.
    fn through(small: &Size, large: &Size) -> Self {
        let [small_us, large_us] = [small, large].map(|size| size.each_us(size.batch[0]));
        let kilobyte_us = (large_us - small_us) / (large.kilobytes() - small.kilobytes());
        Self {
            fixed_us: small_us - kilobyte_us * small.kilobytes(),
            kilobyte_us,
            one_us: large.each_us(large.one[0]) / large.kilobytes(),
        }
    }

    /// The share of one program's throughput at a size, as the line has it.
    fn share(&self, kilobytes: f64) -> f64 {
        self.one_us * kilobytes / (self.fixed_us + self.kilobyte_us * kilobytes)
    }

    fn text(&self, sizes: &[Size]) -> String {
        let gained_us = self.one_us - WANTED * self.kilobyte_us;
        let reached = if gained_us > 0.0 {
            format!("from {:.0} kB on", WANTED * self.fixed_us / gained_us)
        } else {
            "at no size".to_owned()
        };
        let shares: Vec<String> = sizes
            .iter()
            .map(|size| {
                let [line, measured] = [self.share(size.kilobytes()), size.share(size.batch[0])];
                format!(
                    "{:.0} kB {:.0} % ({:.0} % measured)",
                    size.kilobytes(),
                    line * 100.0,
                    measured * 100.0
                )
            })
            .collect();
        format!(
            "By the smallest and the largest a program costs {:.0} µs and {:.2} µs for a kB, where one large program takes {:.2}: {:.0} % of its throughput are reached {reached}; {}.\n",
            self.fixed_us,
            self.kilobyte_us,
            self.one_us,
            WANTED * 100.0,
            shares.join(", ")
        )
    }
}
