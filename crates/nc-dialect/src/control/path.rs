//! How near a control keeps to the programmed path.

use nc_syntax::GCode;

/// A code or a command of a control's table that says how near the control keeps to the path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathCode {
    /// Which.
    pub key: PathKey,
    /// What it says.
    pub keeps: Keeps,
}

/// What says it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathKey {
    /// `G64`
    Code(GCode),
    /// `CYCLE832`
    Command(String),
}

/// How near the path is kept behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Keeps {
    /// On the path: an exact stop at each corner, or corners no faster than the axes can follow.
    Exact,
    /// Within what these words of its block add up to (`PQ`: corners, and lines that are merged), the second as long as
    /// the first where it does not stand there; without the first nobody says.
    Words(Vec<u8>),
    /// Within the first argument of the command.
    Argument,
    /// Parameters, speed and acceleration decide.
    Unstated,
}
