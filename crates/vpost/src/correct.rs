//! `vpost IN.nc -m PROFILE`: the main job on a file.

mod program;

use std::io::IsTerminal;
use std::path::Path;

use diagnostic::{Text, both};
use rewrite::Manner;

use crate::arguments::{self, Shared};
use crate::file;
use crate::interrupt::Interrupt;
use crate::message::{Deed, Failure, Messages};
use crate::progress::Progress;
use crate::roles::Roles;
use crate::summary::Summary;
pub(crate) use jobs::correct::Program;
pub(crate) use program::{Input, program};

/// `vpost IN.nc -m PROFILE`
pub(crate) fn run(
    arguments: &arguments::Correct,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    let path = arguments.input.as_deref().unwrap_or(Path::new("-"));
    let settings = crate::settings::load(shared, messages)?;
    Roles::default()
        .reads(both!("the program", "программа"), path)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &settings.files)
        .reads_folders(&both!("in a folder of subprograms", "файл в папке подпрограмм"), &shared.job.include)
        .writes("--output", arguments.output.as_deref())
        .writes("--summary", arguments.summary.as_deref())
        .are_apart()?;
    let input = Input::open(path);
    let interrupt = Interrupt::listen();
    let shown = Progress::new(messages, arguments.progress);
    let progress = |done: f64| {
        interrupt.check()?;
        shown.report(done);
        Ok(())
    };
    let manner = Manner {
        force: arguments.force,
        threads: rayon::current_num_threads(),
        hashes: arguments.summary.is_some(),
    };
    let mut output = file::Output::new(arguments.output.as_deref())?;
    let mut done = program(input, &settings, manner, &mut output, &progress)?;
    interrupt.check()?;
    shown.report(1.0);
    let told = if is_filter(arguments) && !messages.are_quiet() { notifications(&done) } else { Vec::new() };
    if !told.is_empty() {
        done.output = output.put_in_front(&told).map_err(|error| {
            Failure::place(&Text::pair("standard output", "стандартный вывод"), Deed::WriteTo, &error)
        })?;
    }
    // All that can fail before the program gets its name.
    let summary = match arguments.summary.as_deref() {
        Some(path) => {
            let summary = Summary::new(&settings, &done).held(shared.held.of_summary());
            Some(file::written(path, &summary.json())?)
        }
        None => None,
    };
    output.finish()?;
    summary.map_or(Ok(()), file::Output::finish)?;
    shown.end();
    for report in &done.warnings {
        messages.report(report);
    }
    // Whoever looks on wants to know that it is done; a pipe has the exit status.
    if shared.messages.verbose > 0 || std::io::stderr().is_terminal() {
        messages.note(&Summary::line(&done.figures));
    }
    Ok(())
}

/// LinuxCNC runs vpost as a filter, and reads the program from its standard output.
fn is_filter(arguments: &arguments::Correct) -> bool {
    arguments.progress == Some(arguments::Progress::Linuxcnc) && arguments.output.is_none()
}

/// Warnings as AXIS shows them when it opens a program, a comment each; it shows no messages of a filter that succeeds.
///
/// LinuxCNC's "AXIS GUI": the text ends at a comma; "G-code overview": a line has 255 characters.
fn notifications(done: &Program) -> Vec<String> {
    const LONGEST: usize = 200;
    let shown = |letter| match letter {
        '(' => '[',
        ')' => ']',
        ',' => ';',
        letter if letter.is_ascii() && !letter.is_ascii_control() => letter,
        _ => '?',
    };
    // A program without changes is that which was posted, byte for byte.
    let warnings = done.warnings.iter().filter(|_| done.changed).flat_map(|report| &report.diagnostics);
    warnings
        .map(|warning| {
            let text = format!("vpost {}: {}", warning.code, warning.message.english());
            format!("(AXIS,notify,{})", text.chars().map(shown).take(LONGEST).collect::<String>())
        })
        .collect()
}
