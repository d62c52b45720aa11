//! The command line of `vpost batch`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

/// `vpost batch`
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Batch {
    /// The same on many machines.
    #[command(subcommand)]
    pub command: Option<BatchCommand>,
    /// What to correct, and where it goes.
    #[command(flatten)]
    pub programs: Programs,
    /// How the work is done.
    #[command(flatten)]
    pub work: Work,
    /// Correct all again, and write over any file.
    ///
    /// Whatever an earlier run left; also over files that vpost did not write.
    #[arg(long)]
    pub force: bool,
}

/// Which programs, and where their corrections go.
#[derive(Debug, Clone, Args)]
pub struct Programs {
    /// NC programs, or folders with all programs in them.
    #[arg(value_name = "DIR|FILES", required = true)]
    pub inputs: Vec<PathBuf>,
    /// Folder of the corrected programs.
    ///
    /// Folders below DIR are repeated in it.
    #[arg(short = 'O', long = "output-dir", value_name = "OUTDIR", required = true)]
    pub output: Option<PathBuf>,
    /// In folders, take such files (repeatable).
    ///
    /// Instead of those with the usual endings of programs.
    #[arg(long, value_name = "PATTERN")]
    pub pattern: Vec<String>,
    /// In folders, leave out such (repeatable).
    ///
    /// Files or folders of this pattern.
    #[arg(long, value_name = "PATTERN")]
    pub exclude: Vec<String>,
}

/// How the work is done.
#[derive(Debug, Clone, Args)]
pub struct Work {
    /// Programs at once; default: one a core.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: Option<u16>,
    /// What became of each program (JSON Lines).
    ///
    /// In the order of the outputs' names; `-` for standard output.
    #[arg(long, value_name = "FILE")]
    pub results: Option<PathBuf>,
}

/// Work on many machines.
#[derive(Debug, Subcommand)]
pub enum BatchCommand {
    /// Write down the programs and how to correct them: the manifest.
    #[command(override_usage = "vpost batch plan [OPTIONS] -O <OUTDIR> --manifest <FILE> <DIR|FILES>...")]
    Plan(Plan),
    /// Correct one share of a manifest's programs.
    Run(Run),
    /// Say which programs of a manifest are not corrected yet.
    Merge(Merge),
}

/// `vpost batch plan`
#[derive(Debug, Args)]
pub struct Plan {
    /// What to correct, and where it goes.
    #[command(flatten)]
    pub programs: Programs,
    /// The manifest to write (JSON Lines).
    #[arg(long, value_name = "FILE")]
    pub manifest: PathBuf,
}

/// `vpost batch run`
#[derive(Debug, Args)]
pub struct Run {
    /// The manifest.
    #[arg(long, value_name = "FILE")]
    pub manifest: PathBuf,
    /// Which share: the I-th of N, I from 1; or `auto/N`: I from `HQ_TASK_ID`, `SLURM_ARRAY_TASK_ID` (both from 1) or
    /// `JOB_COMPLETION_INDEX` (from 0), the first that is set. Default: all.
    #[arg(long, value_name = "I/N")]
    pub shard: Option<String>,
    /// How the work is done.
    #[command(flatten)]
    pub work: Work,
}

/// `vpost batch merge`
#[derive(Debug, Args)]
pub struct Merge {
    /// The manifest.
    #[arg(long, value_name = "FILE")]
    pub manifest: PathBuf,
    /// Print only the shards that must run again, in the form that this engine takes.
    #[arg(long, value_enum, value_name = "ENGINE", requires = "shards")]
    pub missing: Option<EngineForm>,
    /// N of the shards that were run.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub shards: Option<u32>,
    /// Write what became of each program (JSON Lines, in the order of the outputs' names); `-` for standard output.
    #[arg(long, value_name = "FILE")]
    pub results: Option<PathBuf>,
}

/// Who runs the shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EngineForm {
    /// HyperQueue: `hq submit --array …`.
    Hq,
    /// Slurm: `sbatch --array=…`.
    Slurm,
    /// GNU parallel: one number a line.
    Parallel,
}
