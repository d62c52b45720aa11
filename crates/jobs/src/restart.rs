//! A program from one of its lines on.

use diagnostic::{Diagnostic, Text, both, notice};
use rewrite::{NO_RESTART, Restarted};

use crate::message::{Failure, OPTION, Report, Source};
use crate::settings::Settings;

/// A program from a line on, and what is to be said.
#[derive(Debug)]
pub struct Begun {
    /// Its bytes.
    pub text: Vec<u8>,
    /// What the program had switched before and this one does not, and that it bears no mark of a correction.
    pub warning: Option<Report>,
}

/// Writes a program from a line on; `safe_mm`: Z of the way to above the place, program coordinates, mm.
///
/// # Errors
/// The program is refused, or there is no restart at that line.
pub fn from_line(
    text: &[u8],
    name: &str,
    settings: &Settings,
    line: u64,
    safe_mm: Option<f64>,
) -> Result<Begun, Failure> {
    if settings.dialect.turning.is_some() {
        return Err(Failure::usage(notice!(OPTION;
            "programs of lathes are not begun anew in their middle", "программы токарных станков с середины не начинаются";
            "begin at the program's start", "начните с начала программы"
        )));
    }
    let job = settings.job("")?;
    let Restarted { text: written, left_out } = rewrite::restart(&job, text, line, safe_mm)
        .map_err(|diagnostics| Failure::refused(name, text, diagnostics))?;
    let named = |(code, line): &(String, u64)| both!("{code} (line {line})", "{code} (строка {line})");
    let mut said = Vec::new();
    if rewrite::corrected_before(text).is_none() {
        let message = both!(
            "the program does not say that it was corrected",
            "в программе не сказано, что она исправлена"
        );
        said.push(Diagnostic::doubt(NO_RESTART, message).help(both!(
            "give the corrected program, as the control ran it; one in which nothing had to be changed says nothing",
            "дайте исправленную программу, ту, что исполняла стойка; если менять было нечего, отметки в ней нет"
        )));
    }
    if !left_out.is_empty() {
        let all = Text::join(&left_out.iter().map(named).collect::<Vec<_>>(), ", ");
        let message = both!("the program had said {all} before", "до этого программа говорила {all:#}");
        said.push(Diagnostic::doubt(NO_RESTART, message).help(both!(
            "where one of them still matters, do it by hand before the start",
            "если что-то из этого ещё нужно, сделайте это вручную до пуска"
        )));
    }
    let warning =
        (!said.is_empty()).then(|| Report { source: Some(Source::whole(name, text)), diagnostics: said });
    Ok(Begun { text: written, warning })
}
