//! `vpost grammar`.

use diagnostic::both;

use crate::arguments::{Grammar, GrammarCommand};
use crate::file;
use crate::message::{Failure, Messages};
use crate::settings::load_dialect;

/// `vpost grammar list|check`
pub(crate) fn run(arguments: &Grammar, messages: &Messages) -> Result<(), Failure> {
    match &arguments.command {
        GrammarCommand::List => {
            let mut text = String::new();
            for name in nc_dialect::builtin_names() {
                let dialect = load_dialect(name)?;
                let said =
                    |phrase: &str| nc_dialect::assumption(phrase).in_language(messages.language()).to_owned();
                text.push_str(&format!("{name}: {}\n", said(&dialect.title)));
                for assumption in &dialect.assumptions {
                    text.push_str(&format!("  - {}\n", said(assumption)));
                }
            }
            file::print(text.as_bytes())
        }
        GrammarCommand::Check { files } => {
            for path in files {
                let dialect = load_dialect(&path.to_string_lossy())?;
                messages.note(&both!(
                    "{}: {} ({} G codes)",
                    "{}: {} (функций G: {})",
                    file::name(path),
                    dialect.title,
                    dialect.codes.len()
                ));
            }
            Ok(())
        }
    }
}
