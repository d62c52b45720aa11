//! All that people get of a version, into one folder: page, archive, Debian package, wheel, notes, checksums.

use std::path::PathBuf;
use std::process::Command;

use anyhow::Context;

use crate::{dist, page};

/// Where it goes.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// The folder; what is in it stays.
    #[arg(long, default_value = "target/packages")]
    folder: PathBuf,
}

/// Makes everything, and says how large it is.
pub(crate) fn run(options: &Options) -> anyhow::Result<String> {
    // From the project's root on, paths are the same for all.
    let packed = dist::Options::of_this_version(&options.folder);
    dist::run(&packed)?;
    let folder = options.folder.canonicalize()?;
    page::write(&folder.join("vpost.html"))?;
    dist::run_to_end(
        Command::new("maturin")
            .args(["build", "--quiet", "--release", "--locked", "--out"])
            .arg(&folder)
            .env("SOURCE_DATE_EPOCH", dist::epoch()?.to_string()),
    )
    .context("the wheel is made by `maturin`: `pip install maturin`")?;
    let changes = std::fs::read_to_string("CHANGELOG.md")?;
    std::fs::write(folder.join("NOTES.md"), notes(&changes, env!("CARGO_PKG_VERSION"))?)?;
    dist::sums(&folder)
}

/// What the list of changes says of a version.
fn notes<'a>(changes: &'a str, version: &str) -> anyhow::Result<&'a str> {
    let sections = changes.split("\n## ").skip(1);
    let own = sections.map(|section| section.split_once('\n').unwrap_or((section, "")));
    let (_, text) = own
        .into_iter()
        .find(|(title, _)| title.split(' ').next() == Some(version))
        .with_context(|| format!("CHANGELOG.md has no section of {version}"))?;
    Ok(text.trim_start())
}

#[cfg(test)]
mod tests {
    use super::notes;

    #[test]
    fn notes_are_the_version_s_own_section() {
        let changes = "# Changes\n\n## 0.2.0 — today\n\n- New.\n\n## 0.1.0 — before\n\n- Old.\n";
        assert_eq!(notes(changes, "0.2.0").unwrap(), "- New.\n");
        assert_eq!(notes(changes, "0.1.0").unwrap(), "- Old.\n");
        notes(changes, "0.3.0").unwrap_err();
    }
}
