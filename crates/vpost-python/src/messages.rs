//! Messages as Python's values and exceptions.

use diagnostic::{Diagnostic, Severity};
use jobs::message::{Failure, Report, Source, Wording};
use pyo3::prelude::*;

/// What Python makes a `Message` of: severity, code, message, label, help; file, line, column; the printed text.
pub(crate) type Told = (
    &'static str,
    String,
    String,
    String,
    Option<String>,
    Option<String>,
    Option<usize>,
    Option<usize>,
    String,
);

/// The messages of reports, in order.
pub(crate) fn told(reports: &[Report]) -> Vec<Told> {
    let wording = Wording::plain();
    let of = |report: &Report| {
        let texts: Vec<String> = wording.rendered(report).collect();
        report.diagnostics.iter().zip(texts).map(|(d, text)| one(d, report.source.as_ref(), text)).collect()
    };
    reports.iter().flat_map(|report| -> Vec<Told> { of(report) }).collect()
}

fn one(diagnostic: &Diagnostic, source: Option<&Source>, text: String) -> Told {
    let Diagnostic { severity, code, message, label, help, span, .. } = diagnostic;
    let severity = match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Doubt => "doubt",
    };
    let place = source.zip(span.as_ref()).map(|(source, span)| source.place(span));
    (
        severity,
        code.to_string(),
        message.english().to_owned(),
        label.english().to_owned(),
        help.as_ref().map(|help| help.english().to_owned()),
        source.map(|source| source.name.clone()),
        place.map(|(line, _)| line),
        place.map(|(_, column)| column),
        text,
    )
}

/// A failure as an exception: `vpost.Refused`, or what Python itself raised meanwhile.
pub(crate) fn raised(py: Python<'_>, failure: &Failure) -> PyErr {
    let text = Wording::plain().text(failure);
    if matches!(failure, Failure::Interrupted(_)) {
        return pyo3::exceptions::PyKeyboardInterrupt::new_err(text);
    }
    let messages = told(failure.reports());
    let exception = py
        .import("vpost._messages")
        .and_then(|module| module.getattr("Refused"))
        .and_then(|class| class.call1((text, messages)));
    match exception {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}
