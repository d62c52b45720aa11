//! Manual pages and completions, from the same description as the command line.

use clap_complete::Shell;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use serde_json::{Value, json};

use crate::arguments::{Completions, Manual};
use crate::command_line::command;
use crate::file;
use crate::message::{Deed, Failure};
use crate::russian;
use diagnostic::{Language, Text};

/// A manual page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page {
    /// Its file: `vpost-batch-run.1`.
    pub file: String,
    /// Its text (roff).
    pub text: Vec<u8>,
}

/// The page of `vpost`, and behind it one for each command, in a language.
///
/// # Errors
/// None that memory can give; the renderer's signature has them.
pub fn pages(language: Language) -> std::io::Result<Vec<Page>> {
    fn add(
        command: &clap::Command,
        above: Option<&str>,
        language: Language,
        pages: &mut Vec<Page>,
    ) -> std::io::Result<()> {
        pages.push(page(command, above, language)?);
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        for inner in command.get_subcommands().filter(|inner| !inner.is_hide_set()) {
            add(inner, Some(name), language, pages)?;
        }
        Ok(())
    }
    let root = spoken(language);
    let mut pages = Vec::new();
    add(&root, None, language, &mut pages)?;
    Ok(pages)
}

/// The whole command line, in a language.
fn spoken(language: Language) -> clap::Command {
    // `vpost help` has nothing to say on paper.
    let mut root = command().disable_help_subcommand(true);
    root.build();
    match language {
        Language::English => root,
        Language::Russian => russian::spoken(root),
    }
}

/// A command as data (`vpost.commands/1`): what forms are made of.
fn described(command: &clap::Command) -> Value {
    let text = |text: Option<&clap::builder::StyledStr>| text.map(ToString::to_string);
    let argument = |argument: &clap::Arg| {
        let takes = argument.get_action().takes_values();
        let values: Vec<String> =
            argument.get_possible_values().iter().map(|v| v.get_name().to_owned()).collect();
        let defaults: Vec<_> = argument.get_default_values().iter().map(|v| v.to_string_lossy()).collect();
        let many = matches!(argument.get_action(), clap::ArgAction::Append | clap::ArgAction::Count)
            || argument.get_num_args().is_some_and(|count| count.max_values() > 1);
        json!({
            "id": argument.get_id().as_str(),
            "long": argument.get_long(),
            "short": argument.get_short(),
            "value": argument.get_value_names().filter(|_| takes).map(|names| names.join(" ")),
            "values": if takes { values } else { Vec::new() },
            "default": if takes { defaults.first() } else { None },
            "many": many,
            "required": argument.is_required_set(),
            "heading": argument.get_help_heading(),
            "help": text(argument.get_help()),
        })
    };
    let shown = |argument: &&clap::Arg| !argument.is_hide_set() && argument.get_id() != "help";
    json!({
        "name": command.get_name(),
        "about": text(command.get_about()),
        "arguments": command.get_arguments().filter(shown).map(argument).collect::<Vec<_>>(),
        "commands": command.get_subcommands().filter(|inner| !inner.is_hide_set()).map(described).collect::<Vec<_>>(),
    })
}

/// Headings as the renderer writes them, and as `man` knows them in Russian: by `ИМЯ` it finds what `apropos` lists.
const HEADINGS: [(&str, &str); 7] = [
    ("NAME", "ИМЯ"),
    ("SYNOPSIS", "СИНТАКСИС"),
    ("DESCRIPTION", "ОПИСАНИЕ"),
    ("OPTIONS", "КЛЮЧИ"),
    ("Команды", "КОМАНДЫ"),
    ("NOTES", "ПРИМЕЧАНИЯ"),
    ("SEE ALSO", "СМ. ТАКЖЕ"),
];

/// The heading that stands in a line of roff, in a language; other lines as they are.
fn heading(line: &str, language: Language) -> String {
    let said = match language {
        Language::English => None,
        Language::Russian => HEADINGS.iter().find_map(|(english, russian)| {
            let named = line.strip_prefix(".SH ")?.trim_matches('"');
            (named == *english).then(|| format!(".SH \"{russian}\""))
        }),
    };
    said.unwrap_or_else(|| line.to_owned())
}

/// The page of a command; `above` is the one whose subcommand it is.
fn page(command: &clap::Command, above: Option<&str>, language: Language) -> std::io::Result<Page> {
    let man = Man::new(command.clone());
    let name = command.get_display_name().unwrap_or_else(|| command.get_name());
    // The renderer's own title loses its empty date, and what follows slips into its place.
    let manual = Text::pair("vpost manual", "Руководство vpost");
    let mut text = format!(
        ".TH \"{name}\" 1 \"\" \"vpost {}\" \"{}\"\n",
        env!("CARGO_PKG_VERSION"),
        manual.in_language(language)
    )
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
    let text = String::from_utf8_lossy(&text);
    let text: String = text.lines().map(|line| heading(line, language) + "\n").collect();
    Ok(Page { file: man.get_filename(), text: text.into_bytes() })
}

/// Prints the first page or the data, or writes all pages.
pub(crate) fn run(arguments: &Manual, language: Language) -> Result<(), Failure> {
    if arguments.json {
        let mut data = json!({ "schema": "vpost.commands/1", "version": env!("CARGO_PKG_VERSION") });
        data["command"] = described(&spoken(language));
        return file::print(format!("{data}\n").as_bytes());
    }
    let pages = pages(language).map_err(|error| {
        Failure::place(&Text::pair("the manual pages", "страницы руководства"), Deed::Make, &error)
    })?;
    let Some(folder) = &arguments.folder else {
        return pages.first().map_or(Ok(()), |page| file::print(&page.text));
    };
    std::fs::create_dir_all(folder).map_err(file::fails(folder, Deed::Make))?;
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
