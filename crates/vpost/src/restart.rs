//! `vpost restart`: a program from one of its lines on.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use diagnostic::both;

use crate::arguments::{Shared, finite};
use crate::message::{Deed, Failure, Messages};
use crate::roles::Roles;
use crate::{file, settings};

/// `vpost restart`
#[derive(Debug, Args)]
pub struct Restart {
    /// The program, as the machine has it; - for standard input.
    #[arg(value_name = "OUT.nc")]
    pub program: PathBuf,
    /// Begin at this line.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub line: u64,
    /// Z of the way above the workpiece, mm.
    ///
    /// Program coordinates; the highest that the program has gone to with this tool if not given.
    #[arg(long = "safe-z", value_name = "MM", allow_hyphen_values = true, value_parser = finite)]
    pub safe_z: Option<f64>,
    /// Write to this file, all or nothing.
    ///
    /// Instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// `vpost restart OUT.nc --line N -m PROFILE`
pub(crate) fn run(arguments: &Restart, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let settings = settings::load(shared, messages)?;
    Roles::default()
        .reads(both!("the program", "программа"), &arguments.program)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &settings.files)
        .writes("--output", arguments.output.as_deref())
        .are_apart()?;
    let (name, text) = (file::name(&arguments.program), file::read_program(&arguments.program)?);
    let begun = jobs::restart::from_line(&text, &name, &settings, arguments.line, arguments.safe_z)?;
    let mut output = file::Output::new(arguments.output.as_deref())?;
    let to = arguments.output.clone().unwrap_or_else(|| PathBuf::from("-"));
    output.write_all(&begun.text).map_err(file::fails(&to, Deed::Write))?;
    output.finish()?;
    begun.warning.iter().for_each(|report| messages.report(report));
    Ok(())
}
