//! `vpost profile`.

use diagnostic::both;

use crate::arguments::{Profile, ProfileCommand};
use crate::message::{Failure, Messages};
use crate::settings::check_control;
use crate::{conditions, export, file, profile, profile_new};

/// `vpost profile check|show|new|export|schema`
pub(crate) fn run(arguments: &Profile, messages: &Messages) -> Result<(), Failure> {
    match &arguments.command {
        ProfileCommand::Check { profile: path } => {
            let loaded = profile::load(path)?;
            check_control(path, &loaded.profile)?;
            let doubts = conditions::doubts(&loaded.profile, loaded.profile.correction.engine);
            doubts.iter().for_each(|report| messages.report(report));
            messages.note(&both!(
                "{}: a good profile of {}",
                "{}: профиль станка {} в порядке",
                file::name(path),
                loaded.profile.name
            ));
            Ok(())
        }
        ProfileCommand::Show { profile: path } => {
            let loaded = profile::load(path)?;
            file::print(loaded.profile.show(messages.language()).as_bytes())
        }
        ProfileCommand::New(a) => profile_new::run(a, messages),
        ProfileCommand::Export(a) => export::run(a, messages),
        ProfileCommand::Schema => file::print(machine_profile::schema().as_bytes()),
    }
}
