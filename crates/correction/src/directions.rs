//! How the rotary axes stand where they are corrected too.

use machine_model::Vector;

/// How the output's rotary axes stand against the program's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Directions {
    /// Output less program, degrees.
    pub(crate) aside_deg: [f64; 3],
    /// Where the program has brought them, degrees.
    pub(crate) program_deg: [f64; 3],
    /// Axes that the program has named.
    pub(crate) named: [bool; 3],
    pub(crate) stand: Stand,
}

/// Where the tool points while the rotary axes stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stand {
    /// Where it shall, at the place that was reached last.
    Reached,
    /// Not where it shall, near a singularity or on the way from there.
    Held,
    /// As the axes were positioned, one after the other or from an unknown place.
    AsPositioned,
}

impl Default for Directions {
    fn default() -> Self {
        Self { aside_deg: [0.0; 3], program_deg: [0.0; 3], named: [false; 3], stand: Stand::AsPositioned }
    }
}

impl Directions {
    pub(crate) fn aside_rad(&self) -> Vector {
        self.aside_deg.map(f64::to_radians).into()
    }

    pub(crate) fn output_deg(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.program_deg[axis] + self.aside_deg[axis])
    }

    pub(crate) fn is_aside(&self) -> bool {
        self.aside_deg != [0.0; 3]
    }

    /// The linear axes go where the tool may point elsewhere.
    pub(crate) fn go_elsewhere(&mut self) {
        if self.stand == Stand::Reached {
            self.stand = Stand::AsPositioned;
        }
    }
}
