//! What a control remembers from hole to hole.

/// Bottom and R words as the control remembers them, program mm (increments under G91), and where the series
/// of holes began, axis command, mm: G98 returns there, R counts from there under G91.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Remembered {
    pub(crate) bottom: f64,
    pub(crate) r: f64,
    pub(crate) began_mm: f64,
    pub(crate) incremental: bool,
    /// No R or bottom of this series was rewritten.
    pub(crate) as_programmed: bool,
}
