//! Columns of what is neither machine nor noise: where the measuring frame lies, how the runs are clamped, what the
//! instruments read at zero.

use crate::equations::observation::Measurements;
use crate::equations::term::Term;

/// How the set-ups of the runs of a file may differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Clamping {
    /// By a shift.
    #[default]
    Shifted,
    /// By angles, too.
    Turned,
}

/// Columns of the measuring frame: shift and rotation, and where runs are turned against each other, those of every run
/// about its middle.
#[must_use]
pub(crate) fn frame(data: &Measurements, clamping: Clamping) -> Vec<Term> {
    let mut terms: Vec<Term> = (0..3).map(Term::SetupShift).chain((0..3).map(Term::SetupRotation)).collect();
    let turned = match clamping {
        Clamping::Shifted => 0,
        Clamping::Turned => data.runs.len(),
    };
    for run in 0..turned {
        let tips =
            || data.rows.iter().filter(|r| r.run == run).map(|r| r.command.linear_mm + r.command.tool_mm);
        let count = tips().count().max(1) as f64;
        let centre_mm: [f64; 3] = (tips().sum::<machine_model::Vector>() / count).into();
        terms.extend((0..3).map(|about| Term::RunRotation { run, about, centre_mm }));
    }
    terms
}

/// Columns of the zero of every instrument, and of the frame of every station, but the first.
#[must_use]
pub(crate) fn instruments(data: &Measurements) -> Vec<Term> {
    let count = data.rows.iter().filter_map(|r| r.instrument).max().map_or(0, |m| m + 1);
    let zeros =
        (1..count).flat_map(|instrument| (0..3).map(move |axis| Term::InstrumentShift { instrument, axis }));
    let stations = data.rows.iter().filter_map(|r| r.station).max().map_or(0, |m| m + 1);
    let frames = (1..stations)
        .flat_map(|station| (0..6).map(move |component| Term::StationFrame { station, component }));
    zeros.chain(frames).collect()
}
