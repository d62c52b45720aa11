//! What is counted on the way through a program.

use std::ops::Range;

use machine_model::Vector;
use nc_program::Evidence;

use crate::datum::Datum;
use crate::figures::{Figures, raise};
use crate::job::{Job, Warning};
use crate::lengthless::Lengthless;
use crate::notices::Notices;

/// What is counted on the way.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tally {
    pub(crate) figures: Figures,
    pub(crate) notices: Notices,
    pub(crate) lengthless: Lengthless,
    pub(crate) evidence: Evidence,
}

impl Tally {
    /// Adds what was counted in the blocks that follow.
    pub(crate) fn add(&mut self, later: &Self) {
        let (figures, more) = (&mut self.figures, &later.figures);
        figures.blocks_in += more.blocks_in;
        figures.blocks_out += more.blocks_out;
        figures.splits += more.splits;
        figures.approaches += more.approaches;
        raise(&mut figures.largest, more.largest);
        raise(&mut figures.before, more.before);
        raise(&mut figures.after, more.after);
        raise(&mut figures.tilt, more.tilt);
        raise(&mut figures.tilt_before, more.tilt_before);
        figures.held.add(&more.held);
        figures.control.add(&more.control);
        figures.accepted.extend(&more.accepted);
        more.datums.iter().for_each(|datum| figures.see(datum));
        self.notices.add(&later.notices);
        self.lengthless.add(&later.lengthless);
        self.evidence.add(&later.evidence);
    }
}

impl Tally {
    /// What was done is to be said, all of the program read.
    pub(crate) fn warnings(&self, job: &Job<'_>) -> Vec<Warning> {
        let mut warnings = self.notices.warnings(&self.figures.held);
        warnings.extend(self.lengthless.warning(job));
        warnings.extend(self.figures.control.warnings(job));
        warnings
    }

    /// Notes the zero that something is cut from in a line, and what is not known of it.
    pub(crate) fn cut_from(&mut self, datum: &Datum, tolerance_mm: f64, (span, line): (&Range<u64>, u64)) {
        let Self { figures, notices, .. } = self;
        if datum.is_outside && !figures.datums.iter().any(|known| known.is(datum)) {
            notices.touched_outside.see(span, line, Vector::from(datum.error_mm).norm());
        }
        if datum.unsure_mm > tolerance_mm {
            notices.touched_by_guess.see(span, line, datum.unsure_mm);
        }
        figures.see(datum);
    }
}
