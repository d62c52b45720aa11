//! The main job and its check, on texts.

use std::ffi::OsString;
use std::time::{Duration, Instant};

use jobs::check::{Outcome, closed};
use jobs::message::Failure;
use jobs::options::JobOptions;
use jobs::settings::Settings;
use jobs::summary::Summary;
use path_comparison::Traces;
use pyo3::prelude::*;
use pyo3::pybacked::{PyBackedBytes, PyBackedStr};
use pyo3::types::PyBytes;
use rewrite::Manner;

use crate::messages::{Told, raised, told};

/// A text, after the name that messages know it by.
pub(crate) type Text = (PyBackedStr, PyBackedBytes);

/// How often a long job asks whether Ctrl-C was pressed: people do not notice it, and the work does not either.
const ASKS_EVERY: Duration = Duration::from_millis(100);

fn settings(py: Python<'_>, options: Vec<OsString>) -> PyResult<Settings> {
    let read = || Settings::load(&JobOptions::read(options)?);
    py.detach(read).map_err(|failure| raised(py, &failure))
}

/// The corrected text, the JSON of `--summary`, and warnings.
#[pyfunction]
pub(crate) fn correct<'py>(
    py: Python<'py>,
    text: &[u8],
    name: &str,
    options: Vec<OsString>,
    force: bool,
) -> PyResult<(Bound<'py, PyBytes>, String, Vec<Told>)> {
    let settings = settings(py, options)?;
    let manner = Manner { force, threads: 1, hashes: true };
    let mut asked = Instant::now();
    let progress = |_: f64| {
        if asked.elapsed() < ASKS_EVERY {
            return Ok(());
        }
        asked = Instant::now();
        // SIGINT; what Python raised by it is said again below.
        Python::attach(|py| py.check_signals()).map_err(|_| Failure::Interrupted(2))
    };
    let done = py.detach(|| jobs::correct::text(text, name, &settings, manner, progress));
    let (corrected, program) = done.map_err(|failure| raised(py, &failure))?;
    let summary = String::from_utf8_lossy(&Summary::new(&settings, &program).json()).into_owned();
    let reports = [settings.warnings.as_slice(), program.warnings.as_slice()].concat();
    Ok((PyBytes::new(py, &corrected), summary, told(&reports)))
}

/// The JSON of `check --json`, what `check` prints, and warnings.
#[pyfunction]
pub(crate) fn check(
    py: Python<'_>,
    original: Text,
    corrected: Text,
    options: Vec<OsString>,
) -> PyResult<(String, String, Vec<Told>)> {
    let settings = settings(py, options)?;
    let outcome = py.detach(|| -> Result<Outcome, Failure> {
        settings.path_model()?;
        let [original, corrected] =
            [&original, &corrected].map(|(name, text)| -> (&str, &[u8]) { (name, text) });
        for (name, text) in [original, corrected] {
            jobs::lines::check_lines(text, name)?;
        }
        let checked = closed([original, corrected], &settings, Traces::Forgotten, &|_| ())?;
        Ok(Outcome::new(&settings, &checked))
    });
    let outcome = outcome.map_err(|failure| raised(py, &failure))?;
    let json = String::from_utf8_lossy(&outcome.json()).into_owned();
    Ok((json, outcome.text().english().to_owned(), told(&settings.warnings)))
}
