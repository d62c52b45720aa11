//! Manual pages and completions, from the same description as the command line.

use clap_complete::Shell;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};

use crate::arguments::{Completions, Manual};
use crate::command_line::command;
use crate::file;
use crate::message::{Deed, Failure};
use diagnostic::Text;

/// A manual page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page {
    /// Its file: `vpost-batch-run.1`.
    pub file: String,
    /// Its text (roff).
    pub text: Vec<u8>,
}

/// The page of `vpost`, and behind it one for each command.
///
/// # Errors
/// None that memory can give; the renderer's signature has them.
pub fn pages() -> std::io::Result<Vec<Page>> {
    fn add(command: &clap::Command, above: Option<&str>, pages: &mut Vec<Page>) -> std::io::Result<()> {
        pages.push(page(command, above)?);
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        for inner in command.get_subcommands().filter(|inner| !inner.is_hide_set()) {
            add(inner, Some(name), pages)?;
        }
        Ok(())
    }
    // `vpost help` has nothing to say on paper.
    let mut root = command().disable_help_subcommand(true);
    root.build();
    let mut pages = Vec::new();
    add(&root, None, &mut pages)?;
    Ok(pages)
}

/// The page of a command; `above` is the one whose subcommand it is.
fn page(command: &clap::Command, above: Option<&str>) -> std::io::Result<Page> {
    let man = Man::new(command.clone());
    let name = command.get_display_name().unwrap_or_else(|| command.get_name());
    // The renderer's own title loses its empty date, and what follows slips into its place.
    let mut text =
        format!(".TH \"{name}\" 1 \"\" \"vpost {}\" \"vpost manual\"\n", env!("CARGO_PKG_VERSION"))
            .into_bytes();
    man.render_name_section(&mut text)?;
    man.render_synopsis_section(&mut text)?;
    man.render_description_section(&mut text)?;
    man.render_options_section(&mut text)?;
    if command.get_subcommands().any(|inner| !inner.is_hide_set()) {
        man.render_subcommands_section(&mut text)?;
    }
    let mut roff = Roff::default();
    if let Some(notes) = command.get_after_long_help().or_else(|| command.get_after_help()) {
        roff.control("SH", ["NOTES"]);
        // As on the screen: each line is one, an empty one a paragraph.
        for line in notes.to_string().lines() {
            if line.trim().is_empty() {
                roff.control("PP", []);
            } else {
                roff.text([roman(line)]);
                roff.control("br", []);
            }
        }
    }
    if let Some(above) = above {
        roff.control("SH", ["SEE ALSO"]);
        roff.text([roman(format!("{above}(1)"))]);
    }
    roff.to_writer(&mut text)?;
    Ok(Page { file: man.get_filename(), text })
}

/// Prints the first page, or writes all.
pub(crate) fn run(arguments: &Manual) -> Result<(), Failure> {
    let pages = pages().map_err(|error| {
        Failure::place(&Text::pair("the manual pages", "страницы руководства"), Deed::Make, &error)
    })?;
    let Some(folder) = &arguments.folder else {
        return pages.first().map_or(Ok(()), |page| file::print(&page.text));
    };
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::file(&file::name(folder), Deed::Make, &error))?;
    pages.iter().try_for_each(|page| file::write(&folder.join(&page.file), &page.text))
}

/// Completions for a shell.
#[must_use]
pub fn completions(shell: Shell) -> Vec<u8> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command(), "vpost", &mut text);
    text
}

/// Prints completions.
pub(crate) fn print_completions(arguments: &Completions) -> Result<(), Failure> {
    file::print(&completions(arguments.shell))
}
