//! Long checks: benchmarks, corpora, tables for the docs.

mod bench;
mod control;
mod corpus;
mod dist;
mod engines;
mod five_axis_samples;
mod gap_bench;
mod house;
mod map_speed;
mod markdown;
mod page;
mod picture;
mod release;
mod reproduction;
#[path = "../../crates/machine-model/tests/stan_s500/mod.rs"]
mod stan_s500;
mod wrap;
mod zhang;

use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Parser, Subcommand};

/// Makes what the documentation shows, and checks that take longer than a test should.
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Measure the correction of large programs; print a page for docs/performance.md.
    Bench(bench::Options),
    /// Measure the correction of many small programs; print a section for docs/performance.md.
    BenchBatch(bench::batch::Options),
    /// Judge corrected programs on a real control: LinuxCNC's interpreter and motion controller.
    Control(control::Options),
    /// Correct LinuxCNC's samples or its test suite, judge each result twice, and write docs/corpus.md.
    Corpus(corpus::Options),
    /// Pack what people install: an archive for a machine, a Debian package; needs the tools of docs/releasing.md.
    Dist(dist::Options),
    /// Print docs/engines.md: the engines against one another.
    Engines,
    /// Write the five-axis sample programs into a folder.
    FiveAxisSamples {
        /// Where they go.
        #[arg(default_value = "samples/five_axis")]
        folder: PathBuf,
    },
    /// Diagnose machines with withheld effects and write docs/diagnosis-benchmark.md.
    GapBench(gap_bench::Options),
    /// Write the sample measurements into a folder.
    GapSamples {
        /// Where they go.
        #[arg(default_value = "samples/diagnosis")]
        folder: PathBuf,
    },
    /// Measure the house: lines, long files and functions, circles of files, test binaries (docs/house.md).
    House(house::Options),
    /// Time error maps and zero-point searches; use a release build.
    MapSpeed,
    /// Make vpost.html: the command as one file for a browser.
    Page(page::Options),
    /// Draw the README's picture.
    Picture(picture::Options),
    /// Make all that people get of a version: page, archive, Debian package, wheel, notes, checksums.
    Release(release::Options),
    /// Print docs/reproduction.md: printed numbers beside ours.
    Reproduction,
    /// Break the lines of Markdown that are longer than 120 characters.
    Wrap {
        /// The pages.
        #[arg(required = true)]
        pages: Vec<PathBuf>,
    },
}

fn main() -> anyhow::Result<()> {
    let text = match Arguments::parse().task {
        Task::Bench(options) => bench::run_all(&options)?,
        Task::BenchBatch(options) => bench::batch::run_all(&options)?,
        Task::Control(options) => control::run(&options)?,
        Task::Corpus(options) => corpus::run(&options)?,
        Task::Dist(options) => dist::run(&options)?,
        Task::Engines => engines::page(),
        Task::FiveAxisSamples { folder } => five_axis_programs(&folder)?,
        Task::GapBench(options) => gap_bench::run(&options)?,
        Task::GapSamples { folder } => gap_bench::write_samples(&folder)?,
        Task::House(options) => house::run(&options)?,
        Task::MapSpeed => map_speed::page(),
        Task::Page(options) => page::run(&options)?,
        Task::Picture(options) => picture::write(&options)?,
        Task::Release(options) => release::run(&options)?,
        Task::Reproduction => reproduction::page(),
        Task::Wrap { pages } => wrap_pages(&pages)?,
    };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}

/// Writes the five-axis programs, and says for which chain each is.
fn five_axis_programs(folder: &Path) -> anyhow::Result<String> {
    let mut said = String::new();
    for (name, text) in five_axis_samples::files() {
        std::fs::write(folder.join(&name), text)?;
        writeln!(said, "{name}: {}", five_axis_samples::chain_of(&name))?;
    }
    Ok(said)
}

/// Breaks the long lines of files; says which had some.
fn wrap_pages(pages: &[PathBuf]) -> anyhow::Result<String> {
    let mut said = String::new();
    for page in pages {
        let text =
            std::fs::read_to_string(page).with_context(|| format!("{}: unreadable", page.display()))?;
        let made = wrap::wrapped(&text);
        if made != text {
            std::fs::write(page, made).with_context(|| format!("{}: cannot be written", page.display()))?;
            said += &format!("{}\n", page.display());
        }
    }
    Ok(said)
}
