//! The command line of `vpost budget`.

use std::path::PathBuf;

use clap::Args;
use jobs::budget::BudgetOptions;

/// `vpost budget`
#[derive(Debug, Args)]
pub struct Budget {
    /// What is asked for.
    #[command(flatten)]
    pub asked: BudgetOptions,
    /// Write all figures (JSON).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}
