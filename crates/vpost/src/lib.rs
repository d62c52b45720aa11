//! The command: arguments, files, messages, exit status.
//!
//! The roof of the house; [`rewrite`] below it is where the text wing and the mathematics wing meet.

pub mod arguments;
mod asked;
pub mod batch;
pub mod budget;
pub mod calibrate;
mod check;
mod color;
pub mod command_line;
pub mod config;
mod correct;
pub mod diagnose;
mod exit_status;
pub mod explain;
pub mod export;
mod file;
mod grammar;
mod growing;
mod interrupt;
pub mod language;
mod lsp;
pub mod manual;
pub mod map;
mod message;
mod mistaken;
mod origin;
mod predict;
mod profile_command;
pub mod profile_new;
mod progress;
mod questions;
pub mod restart;
mod roles;
mod russian;
pub mod session;
mod settings;
mod solve;
mod source;
mod terminal;
mod to_disk;
mod turned;
mod viewer;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

pub use jobs::values;
use jobs::{conditions, expand, figures, profile, summary};

use diagnostic::Language;

use arguments::{Color, MessageOptions};
use command_line::{Arguments, Command};
use exit_status::{DONE, REFUSED, TRY_AGAIN, USAGE};
use interrupt::Interrupt;
use message::{Failure, Messages};

/// Runs the command and says how it ended.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    once(&arguments, Vec::new())
}

/// Runs the command, and asks somebody at a terminal what is missing.
///
/// * `answers` – what they answered so far
fn once(words: &[OsString], mut answers: asked::Answers) -> ExitCode {
    let arguments: Vec<OsString> = words.iter().cloned().chain(answers.iter().map(OsString::from)).collect();
    let held = match config::find(&arguments) {
        Ok(held) => held,
        Err(failure) => return unusable(&failure, &arguments),
    };
    let arguments = match Arguments::read(arguments.clone(), held) {
        Ok(arguments) => arguments,
        Err(error) => return unread(&error, &arguments),
    };
    // From here on: opening a named pipe waits, too.
    let interrupt = Interrupt::listen();
    let MessageOptions { color, quiet, language, .. } = &arguments.shared.messages;
    let language = language::chosen(language.as_deref().copied());
    let messages = Messages::new(*color, language);
    let held = &arguments.shared.held;
    // What a file says is not silenced by the file.
    if let Some(note) = held.note().filter(|_| !*quiet || held.says("quiet")) {
        messages.note(&note);
    }
    let messages = if *quiet { messages.quiet() } else { messages };
    let result = arguments.files_are_right().and_then(|()| match &arguments.command {
        Some(Command::Correct(a)) => correct::run(a, &arguments.shared, &messages),
        Some(Command::Batch(a)) => batch::run(a, &arguments.shared, &messages),
        Some(Command::Watch(a)) => batch::watch(a, &arguments.shared, &messages),
        Some(Command::Check(a)) => check::run(a, &arguments.shared, &messages),
        Some(Command::Restart(a)) => restart::run(a, &arguments.shared, &messages),
        Some(Command::Predict(a)) => predict::run(a, &arguments.shared, &messages),
        Some(Command::Solve(a)) => solve::run(a, &arguments.shared, &messages),
        Some(Command::Calibrate(a)) => calibrate::run(a, &arguments.shared, &messages),
        Some(Command::Diagnose(a)) => diagnose::run(a, &arguments.shared, &messages),
        Some(Command::Map(a)) => map::run(a, &arguments.shared, &messages),
        Some(Command::Budget(a)) => budget::run(a, &arguments.shared, &messages),
        Some(Command::Config(a)) => config::run(a, held, &messages),
        Some(Command::Profile(a)) => profile_command::run(a, &messages),
        Some(Command::Grammar(a)) => grammar::run(a, &messages),
        Some(Command::Explain(a)) => explain::run(a, language),
        Some(Command::Lsp(a)) => lsp::run(a, arguments.shared.messages.language.as_deref().copied()),
        Some(Command::Completions(a)) => manual::print_completions(a),
        Some(Command::Man(a)) => manual::run(a, language),
        None => correct::run(&arguments.correct, &arguments.shared, &messages),
    });
    let result = match result {
        Ok(()) if !answers.is_empty() => asked::keep(&answers, &arguments, &messages),
        result => result,
    };
    match result {
        Ok(()) => ExitCode::from(DONE),
        Err(failure) => {
            // What failed because it was told to end was told to end.
            let failure = match (interrupt.check(), failure) {
                (Err(interrupted), Failure::Refused(_) | Failure::File(_)) => interrupted,
                (_, failure) => failure,
            };
            messages.failure(&failure);
            if let (Failure::Refused(_) | Failure::Usage(_), Some(answer)) =
                (&failure, asked::answer(&failure, &arguments, &answers, &messages))
            {
                answers.push(answer);
                return once(words, answers);
            }
            ExitCode::from(match failure {
                Failure::Refused(_) | Failure::File(_) | Failure::Check => REFUSED,
                Failure::Usage(_) => USAGE,
                Failure::Interrupted(signal) => 128 + signal,
                Failure::Later(_) => TRY_AGAIN,
                Failure::Said(status) => status,
            })
        }
    }
}

/// Says what is wrong with arguments, or the help that they ask for.
fn unread(error: &clap::Error, arguments: &[OsString]) -> ExitCode {
    let said = jobs::options::unread(error)
        .or_else(|| mistaken::programs(error, &command_line::command(), arguments));
    if let Some(failure) = said {
        return unusable(&failure, arguments);
    }
    let status = if error.use_stderr() { USAGE } else { DONE };
    let printed = if error.use_stderr() {
        // It quotes what was typed, or what a script put there.
        let text = match language::of_arguments(arguments) {
            Language::English => error.render().to_string(),
            Language::Russian => russian::error(error),
        };
        writeln!(std::io::stderr(), "{}", terminal::shown(text.trim_end())).is_ok()
    } else {
        error.print().is_ok() && open_streams::is_stdout_open()
    };
    // Help that nobody got is not done; a usage error that nobody reads is one all the same.
    ExitCode::from(if printed { status } else { status.max(REFUSED) })
}

/// Says a usage error that is found before it is known how to say it.
fn unusable(failure: &Failure, arguments: &[OsString]) -> ExitCode {
    Messages::new(Color::Auto, language::of_arguments(arguments)).failure(failure);
    ExitCode::from(USAGE)
}
