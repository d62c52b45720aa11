//! Columns of what is neither machine nor noise: where the measuring frame lies, how the runs are clamped, what the
//! instruments read at zero.

use machine_model::Vector;

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
pub(crate) fn frame(data: &Measurements, clamping: Clamping) -> Vec<Term> {
    let mut terms: Vec<Term> = (0..3).map(Term::SetupShift).chain((0..3).map(Term::SetupRotation)).collect();
    let turned = match clamping {
        Clamping::Shifted => 0,
        Clamping::Turned => data.runs.len(),
    };
    for (run, middle) in middles_mm(data).into_iter().enumerate().take(turned) {
        let centre_mm = middle.into();
        terms.extend((0..3).map(|about| Term::RunRotation { run, about, centre_mm }));
    }
    terms
}

/// Middle of the tips of every run, mm.
pub(crate) fn middles_mm(data: &Measurements) -> Vec<Vector> {
    let mut sums = vec![(0.0, Vector::zeros()); data.runs.len()];
    for row in &data.rows {
        let (count, sum) = &mut sums[row.run];
        *count += 1.0;
        *sum += row.command.linear_mm + row.command.tool_mm;
    }
    sums.into_iter().map(|(count, sum)| sum / f64::max(count, 1.0)).collect()
}

/// Columns of the zero of every instrument, and of the frame of every station, but the first.
pub(crate) fn instruments(data: &Measurements) -> Vec<Term> {
    let count = data.rows.iter().filter_map(|r| r.instrument).max().map_or(0, |m| m + 1);
    let zeros =
        (1..count).flat_map(|instrument| (0..3).map(move |axis| Term::InstrumentShift { instrument, axis }));
    let stations = data.rows.iter().filter_map(|r| r.station).max().map_or(0, |m| m + 1);
    let frames = (1..stations)
        .flat_map(|station| (0..6).map(move |component| Term::StationFrame { station, component }));
    zeros.chain(frames).collect()
}
