//! What the profile and the command line say together.

pub(crate) use jobs::settings::*;

use crate::arguments::Shared;
use crate::message::{Failure, Messages};

/// Reads profile and dialect, applies the options, and says what is to be said of them.
pub(crate) fn load(shared: &Shared, messages: &Messages) -> Result<Settings, Failure> {
    let settings = Settings::load(&shared.job)?;
    for warning in &settings.warnings {
        messages.report(warning);
    }
    Ok(settings)
}
