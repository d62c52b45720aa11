//! Motions to corrected motions.
