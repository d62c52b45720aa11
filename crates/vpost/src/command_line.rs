//! The command line: the main job, and what is asked for besides it.

use std::path::PathBuf;

use clap::error::{ContextKind, ContextValue};
use clap::{Args, CommandFactory, Parser, Subcommand};
use diagnostic::Language;
use jobs::diagnose::plan::Form;

use crate::arguments::{Check, Completions, Correct, Grammar, Lsp, Manual, Predict, Profile, Shared, Solve};
use crate::batch::{Batch, Watch};
use crate::budget::Budget;
use crate::calibrate::Calibrate;
use crate::config::{Config, Held, called};
use crate::diagnose::Diagnose;
use crate::explain::Explain;
use crate::map::Map;
use crate::message::Failure;
use crate::mistaken::{self, Asked};
use crate::restart::Restart;
use crate::{language, russian};

/// Rewrites NC programs so that a measured machine goes where the program says.
#[derive(Debug, Parser)]
#[command(
    name = "vpost",
    version,
    max_term_width = 80,
    subcommand_negates_reqs = true,
    arg_required_else_help = true,
    override_usage = "vpost [OPTIONS] <IN.nc>\n       vpost <COMMAND> [OPTIONS]"
)]
pub struct Arguments {
    /// The work.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The main job.
    #[command(flatten)]
    pub correct: Correct,
    /// What all jobs share.
    #[command(flatten)]
    pub shared: Shared,
}

/// What is asked for besides the main job.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Correct a program: the main job, which needs no name.
    Correct(Correct),
    /// Correct many programs, on all cores or on many machines.
    Batch(Batch),
    /// Correct whatever is saved into a folder.
    Watch(Watch),
    /// Do two programs cut alike on this machine?
    Check(Check),
    /// Begin a corrected program anew at one of its lines.
    Restart(Restart),
    /// Where the machine really goes for commanded points.
    Predict(Predict),
    /// What to command so that the tool reaches points.
    Solve(Solve),
    /// Make a machine profile from an instrument's files.
    Calibrate(Calibrate),
    /// Which unmodelled effect explains the measurements.
    Diagnose(Diagnose),
    /// The error over the volume, and where to put the workpiece.
    Map(Map),
    /// What each deviation of the machine costs.
    Budget(Budget),
    /// Which settings of vpost.toml hold, and from where.
    Config(Config),
    /// Make, check, show or describe machine profiles.
    Profile(Profile),
    /// List or check dialect tables.
    Grammar(Grammar),
    /// What a message means and what to do: VP0509.
    Explain(Explain),
    /// Answer an editor: messages as you type (LSP).
    Lsp(Lsp),
    /// Completions for a shell.
    Completions(Completions),
    /// The manual pages (roff).
    Man(Manual),
}

/// Ids of the options in [`Shared`] that say something of the machine or the program: who reads which.
const OF_MACHINE: [&str; 3] = ["machine", "engine", "at"];
const OF_PROGRAM: [&str; 15] = [
    "dialect",
    "tolerance",
    "accept",
    "work_offset",
    "zero",
    "touched_at",
    "tool",
    "tool_table",
    "linuxcnc_ini",
    "start_at",
    "set",
    "include",
    "decimal",
    "orientation",
    "outside",
];
/// Of those, what a program is read by.
const OF_READING: [&str; 7] =
    ["dialect", "work_offset", "tool", "tool_table", "linuxcnc_ini", "start_at", "decimal"];
/// Of the corrections alone.
const OF_OUTPUT: [&str; 4] = ["guard", "path_control", "strict", "verbose"];

/// Of a plan that is written as a program.
const OF_WRITTEN_PLAN: [&str; 4] = ["dialect", "work_offset", "linuxcnc_ini", "at"];

/// Where settings are read from.
const OF_FILE: [&str; 1] = ["config"];
/// Of every command; its help names them beside `--help`.
pub(crate) const OF_ALL: [&str; 3] = ["quiet", "color", "lang"];

/// Whether a command, by its names from the first on, reads an option of [`Shared`].
pub(crate) fn reads(command: &[&str], option: &str) -> bool {
    let machine = OF_MACHINE.contains(&option);
    match command {
        // Of what works on a machine.
        ["config"] => option == "config",
        _ if option == "config" => reads(command, "machine"),
        // The manifest says which profile and options hold.
        ["batch", "run" | "merge"] => false,
        ["batch", ..] => option != "verbose",
        ["correct" | "watch", ..] => true,
        ["check", ..] => option == "path_control" || (option != "outside" && !OF_OUTPUT.contains(&option)),
        ["restart"] => option == "machine" || OF_READING.contains(&option),
        // A lathe's program, or points.
        ["predict", ..] => {
            !["orientation", "zero", "touched_at"].contains(&option) && !OF_OUTPUT.contains(&option)
        }
        ["diagnose", ..] => {
            ["machine", "engine", "tolerance"].contains(&option) || OF_WRITTEN_PLAN.contains(&option)
        }
        ["solve", ..] => machine,
        ["map" | "budget", ..] => machine || ["outside", "tool"].contains(&option),
        ["calibrate"] => ["machine", "dialect", "at"].contains(&option),
        // Their rows say at which temperature they were read.
        ["calibrate", "rtest" | "turning"] => ["machine", "dialect"].contains(&option),
        ["calibrate", which, ..] => {
            ["machine", "dialect", "at"].contains(&option) || (option == "engine" && *which == "tracker")
        }
        _ => false,
    }
}

/// Options that a command does not list, since they change nothing there, and takes all the same: who checks gives what the
/// correction was given.
fn accepts(command: &[&str], option: &str) -> bool {
    match command {
        ["check"] => ["outside", "strict"].contains(&option),
        ["restart"] => option != "verbose",
        ["batch", ..] => option == "verbose",
        _ => false,
    }
}

/// What a command that reads an option somewhere lacks to read it in this call: what there is no program for is not read.
fn lacks(command: &[&str], option: &str, called: &clap::ArgMatches) -> Option<&'static str> {
    let programmed = |id| called.get_one::<Form>(id) == Some(&Form::Program);
    match command {
        ["predict"] => {
            let of_points = OF_MACHINE.contains(&option) || option == "outside";
            (!of_points && !called.get_flag("lathe")).then_some("--lathe")
        }
        ["diagnose"] => {
            let needs_program =
                OF_WRITTEN_PLAN.contains(&option) && !programmed("plan") && !programmed("next");
            needs_program.then_some("--plan program")
        }
        _ => None,
    }
}

/// The options of [`Shared`] that not every command reads.
fn shared_options() -> impl Iterator<Item = &'static str> {
    OF_MACHINE.into_iter().chain(OF_PROGRAM).chain(OF_OUTPUT).chain(OF_FILE)
}

/// The command line, each command listing what it reads.
#[must_use]
pub fn command() -> clap::Command {
    fn own(root: &clap::Command, names: &[&str], mut command: clap::Command) -> clap::Command {
        for option in shared_options() {
            if let Some(argument) = root.get_arguments().find(|argument| argument.get_id() == option) {
                command = command.arg(argument.clone().global(false).hide(!reads(names, option)));
            }
        }
        let inner: Vec<String> = command.get_subcommands().map(|inner| inner.get_name().to_owned()).collect();
        for name in inner {
            let names: Vec<&str> = names.iter().copied().chain([name.as_str()]).collect();
            command = command.mut_subcommand(&name, |inner| own(root, &names, inner));
        }
        compact(command)
    }
    let mut command = compact(Arguments::command());
    let root = command.clone();
    let inner: Vec<String> = root.get_subcommands().map(|inner| inner.get_name().to_owned()).collect();
    for name in inner {
        command = command.mut_subcommand(&name, |inner| own(&root, &[name.as_str()], inner));
    }
    // The first screen is for the commands; the main job's options are those of `correct`.
    let shown = ["input", "output", "machine", "help", "version"];
    for option in root.get_arguments().map(|argument| argument.get_id().as_str()) {
        if !shown.contains(&option) {
            command = command.mut_arg(option, |argument| argument.hide(true));
        }
    }
    command.after_help(
        "All options: vpost correct --help\n\nExit: 0 done; 1 refused, nothing is written; 2 usage; 75 try again; 130, 143 signal\nExample: vpost in.nc -m machine-profiles/stan_s500.toml -o out.nc",
    )
}

/// An argument as it is typed.
fn option(argument: &clap::Arg) -> String {
    argument.get_long().map_or_else(|| "IN.nc".to_owned(), |long| format!("--{long}"))
}

/// What every command takes stands in one line.
const HELP: &str = "This help; everywhere: -q, --lang en|ru, --color WHEN";

/// Help on one screen, by `-h` and `--help` alike.
fn compact(command: clap::Command) -> clap::Command {
    let help = clap::Arg::new("help").short('h').long("help").action(clap::ArgAction::HelpShort);
    command.disable_help_flag(true).arg(help.help(HELP).help_heading("Messages"))
}

impl Arguments {
    /// Refuses files that by their names are something else than what is asked for.
    pub(crate) fn files_are_right(&self) -> Result<(), Failure> {
        let (programs, asked): (Vec<&PathBuf>, Asked) = match &self.command {
            None => (self.correct.input.iter().collect(), Asked::Program),
            Some(Command::Correct(correct)) => (correct.input.iter().collect(), Asked::Program),
            Some(Command::Check(check)) => (vec![&check.input, &check.output], Asked::Program),
            Some(Command::Restart(restart)) => (vec![&restart.program], Asked::Program),
            Some(Command::Batch(batch)) => (batch.programs.inputs.iter().collect(), Asked::Many),
            _ => (Vec::new(), Asked::Program),
        };
        programs.into_iter().try_for_each(|path| mistaken::program(path, asked))?;
        self.shared.job.machine.as_deref().map_or(Ok(()), mistaken::profile)
    }

    /// Reads a command line.
    ///
    /// # Errors
    /// What clap refuses, help and version among it; options that the command does not read.
    pub fn read(
        arguments: impl IntoIterator<Item = std::ffi::OsString>,
        mut held: Held,
    ) -> Result<Self, clap::Error> {
        let arguments: Vec<std::ffi::OsString> = arguments.into_iter().collect();
        let command = held.applied(command());
        let mut command = match language::of_arguments(&arguments) {
            Language::English => command,
            Language::Russian => russian::spoken(command),
        };
        let matches = command.try_get_matches_from_mut(&arguments);
        let is_plain = matches.as_ref().is_ok_and(|matches| {
            let is_there = |input: &PathBuf| input.exists();
            matches.subcommand().is_some() || matches.get_one("input").is_none_or(is_there)
        });
        if !is_plain && let Some(error) = mistaken::command(&command, &arguments) {
            return Err(error);
        }
        let matches = matches?;
        let given = |matches: &clap::ArgMatches, id: &str| {
            matches.try_contains_id(id).is_ok()
                && matches.value_source(id) == Some(clap::parser::ValueSource::CommandLine)
        };
        let (names, at) = called(&matches);
        if let Some((first, _)) = matches.subcommand() {
            let of_main = Correct::augment_args(clap::Command::new("correct"));
            let stray = of_main.get_arguments().find(|argument| given(&matches, argument.get_id().as_str()));
            let unread = |option: &&str| {
                !(reads(&names, option) || accepts(&names, option)) || lacks(&names, option, at).is_some()
            };
            let ignored = shared_options().find(|option| given(at, option) && unread(option));
            let without = ignored.and_then(|option| lacks(&names, option, at));
            let ignored = ignored
                .and_then(|option| command.get_arguments().find(|argument| argument.get_id() == option));
            if let Some(argument) = stray.or(ignored) {
                let without = without.filter(|_| stray.is_none());
                let message = format!(
                    "`vpost {}` does not read `{}`{}\n\nSee `vpost {} --help`",
                    names.join(" "),
                    option(argument),
                    without.map_or_else(String::new, |other| format!(" without `{other}`")),
                    if stray.is_some() { first.to_owned() } else { names.join(" ") },
                );
                let without = without.map_or_else(String::new, |other| format!(" без `{other}`"));
                let russian =
                    format!("`vpost {}` не читает `{}`{without}", names.join(" "), option(argument));
                let mut error = command.error(clap::error::ErrorKind::ArgumentConflict, message);
                error.insert(ContextKind::Custom, ContextValue::String(russian));
                return Err(error);
            }
        }
        held.kept.retain(|kept| !given(at, &kept.id) && lacks(&names, &kept.id, at).is_none());
        let mut read: Self = clap::FromArgMatches::from_arg_matches(&matches)?;
        read.shared.held = held;
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every option that a command reads stands in its help: those of all commands in the line of `--help`.
    #[test]
    fn every_option_stands_in_the_help_of_its_command() {
        fn below(command: &clap::Command, above: &[String], wrong: &mut Vec<String>) {
            let text = command.clone().render_help().to_string();
            let names: Vec<&str> = above.iter().map(String::as_str).collect();
            let read = shared_options().filter(|option| reads(&names, option)).chain(OF_ALL);
            for id in read {
                let root = super::command();
                let option = root.get_arguments().find(|argument| argument.get_id() == id);
                let option = option.unwrap_or_else(|| panic!("{id} is an option"));
                let short = option.get_short().map(|short| format!("-{short}"));
                let long = format!("--{}", option.get_long().unwrap_or_default());
                if !text.contains(&long) && !short.is_some_and(|short| text.contains(&format!("{short},"))) {
                    wrong.push(format!("{names:?}: {long}"));
                }
            }
            for inner in command.get_subcommands().filter(|inner| inner.get_name() != "help") {
                let names: Vec<String> = above.iter().cloned().chain([inner.get_name().to_owned()]).collect();
                below(inner, &names, wrong);
            }
        }
        let mut root = command();
        root.build();
        let mut wrong = Vec::new();
        below(&root, &[], &mut wrong);
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
