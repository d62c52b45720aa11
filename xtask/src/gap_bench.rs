//! Runs `vpost diagnose` on the lab's cases and scores the answers against the truth.
//!
//! The bench knows the command by its files only: it writes the files of a case into a folder of its own,
//! starts the released command there, reads the JSON, and compares. What each figure means stands in
//! [`page`], which writes the document.

mod answer;
mod attempt;
mod circles;
mod outcome;
mod page;
mod scores;
mod speed;
mod table;
mod transport;
mod voxels;

pub(crate) use page::date;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::Args;
use gap_lab::{Case, CaseSpec, catalogue, doubtful};
use rayon::prelude::*;

use attempt::{attempt, read};
use outcome::Outcome;

/// Options of the benchmark.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Number of cases; the mixture of kinds stays the same.
    #[arg(long, default_value_t = 1200)]
    cases: usize,
    /// Seed of the cases.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The command under test; default: the release build beside this program, built first.
    #[arg(long)]
    vpost: Option<PathBuf>,
    /// Cases at the same time.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
    /// Cases whose noise is not what a fit takes for granted, in the place of the usual ones.
    #[arg(long)]
    doubtful: bool,
    /// Ball-bar circles with one to four faults, in the place of the usual cases; nothing is written to docs/ then.
    #[arg(long)]
    circles: bool,
    /// Keep the files of every case, the answers and a table of outcomes in this folder.
    #[arg(long)]
    keep: Option<PathBuf>,
    /// Only cases whose id contains this text; nothing is written to docs/ then.
    #[arg(long)]
    only: Option<String>,
    /// Where the page goes.
    #[arg(long, default_value = "docs/diagnosis-benchmark.md")]
    page: PathBuf,
}

/// Makes the cases, runs the command, writes the page; returns the summary for the terminal.
pub(crate) fn run(options: &Options) -> anyhow::Result<String> {
    let vpost = match &options.vpost {
        Some(path) => path.canonicalize().with_context(|| format!("{} is not there", path.display()))?,
        None => released()?,
    };
    let temporary = std::env::temp_dir().join(format!("gap-bench-{}", std::process::id()));
    let root = options.keep.clone().unwrap_or_else(|| temporary.clone());
    std::fs::create_dir_all(&root)?;
    if options.circles {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(options.jobs).build()?;
        let text = pool.install(|| circles::run(&vpost, &root, options.cases, options.seed))?;
        if options.keep.is_none() {
            std::fs::remove_dir_all(&temporary)?;
        }
        return Ok(text);
    }
    let draw = if options.doubtful { doubtful } else { catalogue };
    let specs: Vec<CaseSpec> = draw(options.cases, options.seed);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.jobs).build()?;
    let started = Instant::now();
    let outcomes: Vec<anyhow::Result<Option<Outcome>>> = pool.install(|| {
        specs
            .par_iter()
            .map(|spec| {
                if options.only.as_ref().is_some_and(|only| !spec.id().contains(only.as_str())) {
                    return Ok(None);
                }
                let case = spec.build();
                let folder = root.join(&case.id);
                let outcome = examine(&vpost, &folder, case)?;
                if options.keep.is_none() {
                    std::fs::remove_dir_all(&folder)?;
                }
                Ok(Some(outcome))
            })
            .collect()
    });
    let mut found = Vec::new();
    for outcome in outcomes {
        found.extend(outcome?);
    }
    if options.keep.is_some() {
        std::fs::write(root.join("outcomes.csv"), table::outcomes_csv(&found))?;
    }
    let speed = match options.only {
        None if !options.doubtful => speed::measure(&vpost, &root)?,
        _ => Vec::new(),
    };
    let run = page::Run {
        speed,
        seed: options.seed,
        jobs: options.jobs,
        elapsed: started.elapsed(),
        version: version(&vpost)?,
    };
    if options.keep.is_none() {
        std::fs::remove_dir_all(&temporary)?;
    }
    let page = page::page(&found, &run);
    if options.only.is_none() && !options.doubtful {
        std::fs::write(&options.page, crate::wrap::wrapped(&page))
            .with_context(|| format!("cannot write {}", options.page.display()))?;
    }
    Ok(page::summary(&page))
}

/// Writes the sample measurements of the documents; returns their names.
pub(crate) fn write_samples(folder: &Path) -> anyhow::Result<String> {
    let mut names = String::new();
    for (name, spec) in gap_lab::sample_cases() {
        let case = spec.build();
        for (file, text) in &case.files {
            let path = match file.as_str() {
                "profile.toml" => folder.join(format!("{name}.toml")),
                "measurement.csv" => folder.join(format!("{name}.csv")),
                // Where there is nothing to predict, nothing is checked on fresh points.
                "holdout.csv" if !case.truth.identifiable => continue,
                "holdout.csv" => folder.join(format!("{name}_holdout.csv")),
                table => bail!("{name}: a sample machine has no table, this one has {table}"),
            };
            std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
            names.push_str(&format!("{}\n", path.display()));
        }
        std::fs::write(folder.join(format!("{name}.truth.json")), &case.truth_json)?;
    }
    Ok(names)
}

/// Builds the command in release mode and says where it lies.
pub(crate) fn released() -> anyhow::Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo).args(["build", "--release", "-q", "-p", "vpost"]).status()?;
    if !status.success() {
        bail!("cargo build --release -p vpost failed");
    }
    let own = std::env::current_exe()?;
    let beside = own.parent().map(|folder| folder.join("vpost")).unwrap_or_default();
    // Run from a debug build, the release folder is next door.
    let path = if beside.is_file() { beside } else { own.with_file_name("../release/vpost") };
    path.canonicalize().with_context(|| format!("no release build of vpost at {}", path.display()))
}

fn version(vpost: &Path) -> anyhow::Result<String> {
    let output = Command::new(vpost).arg("--version").output()?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Writes the files of a case, runs the command and compares.
fn examine(vpost: &Path, folder: &Path, case: Case) -> anyhow::Result<Outcome> {
    std::fs::create_dir_all(folder)?;
    for (name, text) in &case.files {
        std::fs::write(folder.join(name), text)?;
    }
    std::fs::write(folder.join("truth.json"), &case.truth_json)?;
    let mut command = Command::new(vpost);
    command.args(["diagnose", "measurement.csv", "-m", "profile.toml", "--holdout", "holdout.csv"]);
    command.args(["--json", "answer.json", "--write-profile", "found.toml"]);
    if let Some(id) = &case.without {
        command.args(["--without", id]);
    }
    let ran = attempt(command, folder, "diagnose")?;
    let path = folder.join("answer.json");
    let answer = match ran.failure {
        Some(words) => Err(words),
        None => read(&path),
    };
    let transport = match &answer {
        Ok(answer) => transport::check(vpost, folder, &case, answer),
        Err(_) => None,
    };
    let cpu_seconds = ran.cpu_seconds.unwrap_or(ran.seconds);
    Ok(Outcome { case, answer, seconds: ran.seconds, cpu_seconds, transport })
}
