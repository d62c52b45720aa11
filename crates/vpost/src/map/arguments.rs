//! The command line of `vpost map`.

use std::path::PathBuf;

use clap::Args;
use jobs::map::asked::MapOptions;

/// `vpost map`
#[derive(Debug, Args)]
pub struct Map {
    /// What is asked for.
    #[command(flatten)]
    pub asked: MapOptions,
    /// Write the errors of all nodes (CSV).
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write all figures (JSON).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the map as one page with drawings (HTML).
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write a page in which the error moves.
    ///
    /// A lattice, magnified, cause by cause; HTML with a script of its own.
    #[arg(long, value_name = "FILE")]
    pub viewer: Option<PathBuf>,
    /// Write the map for ParaView (VTK).
    #[arg(long, value_name = "FILE")]
    pub vtk: Option<PathBuf>,
}
