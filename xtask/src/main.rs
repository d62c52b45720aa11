//! Long checks: benchmarks, corpora, tables for the docs.

mod engines;
mod markdown;
mod reproduction;
#[path = "../../crates/machine-model/tests/stan_s500/mod.rs"]
mod stan_s500;

use std::io::Write;

use clap::{Parser, Subcommand};

/// Makes what the documentation shows, and checks that take longer than a test should.
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Print docs/engines.md: the engines against one another.
    Engines,
    /// Print docs/reproduction.md: printed numbers beside ours.
    Reproduction,
}

fn main() -> anyhow::Result<()> {
    let text = match Arguments::parse().task {
        Task::Engines => engines::page(),
        Task::Reproduction => reproduction::page(),
    };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}
