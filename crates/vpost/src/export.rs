//! `vpost profile export`: the model in the forms that controls take.

use std::path::PathBuf;

use clap::Args;
use diagnostic::{Code, Text, notice};
use jobs::export::{Asked, Format, Sign, of};

use crate::message::{Deed, Failure, Messages};
use crate::{file, profile};

/// Warning: the form holds less than the profile.
const LOST: Code = Code(1112);

/// `vpost profile export`
#[derive(Debug, Args)]
pub struct Export {
    /// Machine profile (TOML).
    #[arg(value_name = "PROFILE.toml")]
    pub profile: PathBuf,
    /// The form.
    #[arg(long, value_enum)]
    pub format: Format,
    /// Folder for the files.
    #[arg(short = 'O', long = "output-folder", value_name = "DIR")]
    pub folder: PathBuf,
    /// Distance of the lattice's points, mm.
    #[arg(long, value_name = "MM", default_value_t = 50.0)]
    pub step: f64,
    /// Whether the lattice holds what the machine does wrong or what the control adds.
    #[arg(long, value_enum, default_value_t = Sign::Errors)]
    pub lattice: Sign,
}

/// `vpost profile export`
pub(crate) fn run(arguments: &Export, messages: &Messages) -> Result<(), Failure> {
    let Export { format, step: step_mm, lattice, .. } = *arguments;
    let made = of(&profile::load(&arguments.profile)?.profile, &Asked { format, step_mm, lattice })?;
    std::fs::create_dir_all(&arguments.folder).map_err(file::fails(&arguments.folder, Deed::Make))?;
    for (name, text) in &made.files {
        file::write(&arguments.folder.join(name), text.as_bytes())?;
    }
    if !made.lost.is_empty() {
        messages.warning(notice!(LOST;
            "this form does not hold {}", "эта форма не вмещает {:#}", Text::join(&made.lost, "; ");
            "correct programs with vpost to have all of the model; never both: what a control compensates must not stand in the profile as well",
            "чтобы была вся модель, исправляйте программы с vpost; но не оба сразу: то, что компенсирует стойка, не должно стоять и в профиле"
        ));
    }
    Ok(())
}
