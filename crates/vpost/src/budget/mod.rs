//! `vpost budget`: what each deviation costs, what they may come to together, and what each may be.

mod arguments;

pub use arguments::Budget;

use diagnostic::both;
use jobs::budget::{json, of, text};

use crate::arguments::Shared;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::settings::machine;
use crate::{file, profile};

/// `vpost budget -m PROFILE`
pub(crate) fn run(arguments: &Budget, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let profile::Loaded { profile, files, .. } = profile::load_mill(machine(&shared.job)?)?;
    Roles::default()
        .reads_all(&both!("the control points", "контрольные точки"), &arguments.asked.points)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &files)
        .writes("--json", arguments.json.as_deref())
        .are_apart()?;
    let mut warnings = Vec::new();
    let study = of(&shared.job, &profile, &arguments.asked, &file::read, &mut warnings);
    warnings.iter().for_each(|report| messages.report(report));
    let study = study?;
    if let Some(path) = &arguments.json {
        file::write(path, &json::bytes(&study))?;
    }
    file::print(text::page(&study).in_language(messages.language()).as_bytes())
}
