//! Which way an axis goes.

use crate::curve::SAME_PLACE_MM;

/// Which way an axis goes; one that does not move keeps its direction.
#[inline]
pub(crate) fn heading(from: f64, to: f64, otherwise: i8) -> i8 {
    if to > from {
        1
    } else if to < from {
        -1
    } else {
        otherwise
    }
}

/// Which way an axis goes that is carried from command to command; 0 where it stays.
pub(crate) fn moved(from: f64, to: f64) -> i8 {
    if (to - from).abs() > SAME_PLACE_MM { heading(from, to, 0) } else { 0 }
}
