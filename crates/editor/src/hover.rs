//! What a line does on the machine, in a few lines.

use std::fmt::Write as _;

use diagnostic::{Language, Text};
use jobs::at_line::{self, AtLine};
use jobs::message::Failure;

use crate::document::Document;
use crate::machine::Machine;
use crate::place::Place;

/// So many causes are named, and none below a tenth of a micrometre.
const MOST_CAUSES: usize = 4;
const LEAST_MM: f64 = 1e-4;
/// So many written lines are shown.
const MOST_LINES: usize = 12;

/// What a line (from 1) does, as Markdown; `None` where it does nothing, or where the program is refused before.
pub(crate) fn of(
    document: &Document,
    place: &Place,
    machine: &Machine,
    line: u64,
    language: Language,
    stop: &dyn Fn() -> bool,
) -> Option<String> {
    let goes_on = || if stop() { Err(Failure::Interrupted(0)) } else { Ok(()) };
    let program = (place.name(), document.text().as_bytes());
    let at = at_line::of(program, &machine.settings, machine.causes.as_ref(), line, goes_on).ok()??;
    Some(said(&at, language))
}

fn said(at: &AtLine, language: Language) -> String {
    let word = |english, russian| Text::pair(english, russian).in_language(language).to_owned();
    let AtLine { brought, off } = at;
    let place =
        |axes: [Option<f64>; 3]| axes.map(|axis| axis.map_or("?".to_owned(), |mm| format!("{mm:.4}")));
    let mut rows = vec![
        (word("program", "программа"), place(brought.program)),
        (word("axes, mm", "оси, мм"), place(brought.command_mm)),
    ];
    if let Some(off) = off {
        let um = off.off_mm.map(|mm| format!("{:+.1}", mm * 1e3));
        rows.push((word("uncorrected off by, µm", "без исправления уход, мкм"), um));
    }
    let mut text = String::from("| | X | Y | Z |\n|---|--:|--:|--:|\n");
    for (name, [x, y, z]) in rows {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "| {name} | {x} | {y} | {z} |");
    }
    let causes: Vec<String> = off
        .iter()
        .flat_map(|off| &off.causes)
        .filter(|(_, mm)| at_line::size(*mm) > LEAST_MM)
        .take(MOST_CAUSES)
        .map(|(cause, mm)| {
            let name = report::viewer::cause(cause.kind, &cause.symbol, language);
            format!("{name} {:.1}", at_line::size(*mm) * 1e3)
        })
        .collect();
    if !causes.is_empty() {
        let _ = write!(text, "\n{}: {}\n", word("most of it, µm", "больше всего, мкм"), causes.join(", "));
    }
    let written = String::from_utf8_lossy(&brought.written);
    let lines: Vec<&str> = written.trim_end().lines().take(MOST_LINES).collect();
    if !lines.is_empty() {
        let more = if written.trim_end().lines().count() > MOST_LINES { "\n…" } else { "" };
        let _ =
            write!(text, "\n{}:\n```nc\n{}{more}\n```\n", word("corrected", "исправлено"), lines.join("\n"));
    }
    let _ = write!(text, "\n{}: `{}`\n", word("in force", "действует"), brought.in_force.join(" "));
    text
}
