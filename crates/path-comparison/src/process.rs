//! What belongs to a motion beside its path.

/// What must be the same for two motions to go on together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Process {
    pub(crate) number: u32,
    pub(crate) feed: Option<f64>,
    /// What time a motion takes is known.
    pub(crate) is_timed: bool,
    /// Of feeds in a row under cutter compensation the how-manieth: each is a process of its own.
    pub(crate) compensated: Option<u32>,
    /// The cycle that makes it, by number.
    pub(crate) cycle: Option<u32>,
}

impl Process {
    /// Of what is no feed.
    pub(crate) fn of_number(number: u32) -> Self {
        Self { number, feed: None, is_timed: false, compensated: None, cycle: None }
    }
}
