//! The compiled half of the Python package `vpost`: jobs on bytes, for `python/vpost` to make values of.
//!
//! What Python sees is `python/vpost/__init__.py`. Arrays come and go as the bytes of their numbers (little-endian
//! doubles, rows of three), so that one compiled file serves every Python from 3.8 on and every NumPy. Options come as
//! on a command line, since the same reader refuses them then in the same words.

#![expect(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]

mod jobs_on_points;
mod jobs_on_programs;
mod messages;
mod rows;

use pyo3::prelude::*;

/// Module `vpost._vpost`.
#[pymodule]
mod _vpost {
    #[pymodule_export]
    use crate::jobs_on_points::{budget, calibrate, diagnose, map, predict, solve};
    #[pymodule_export]
    use crate::jobs_on_programs::{check, correct};
}
