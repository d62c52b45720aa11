//! What became of one program.

use super::folder::Grown;
use super::job;
use super::record::{Record, Status};
use crate::message::{Failure, Report};

/// What became of one program.
pub(crate) struct Outcome {
    pub record: Record,
    pub resumed: bool,
    /// Its output, where it is not in its place yet.
    pub grown: Option<Grown>,
    pub told: Vec<Report>,
}

impl Outcome {
    pub(crate) fn of(record: Record) -> Self {
        Self { record, resumed: false, grown: None, told: Vec::new() }
    }

    /// Makes it that of a failure.
    pub(crate) fn fail(&mut self, failure: Failure) {
        let (status, reports) = match failure {
            Failure::Refused(reports) | Failure::Usage(reports) => (Status::Refused, reports),
            Failure::File(report) | Failure::Later(report) => (Status::Failed, vec![report]),
            Failure::Check | Failure::Interrupted(_) | Failure::Said(_) => (Status::Refused, Vec::new()),
        };
        self.record.status = status;
        self.record.errors = reports.iter().flat_map(job::faults).collect();
        self.grown = None;
        self.told = reports;
    }
}
