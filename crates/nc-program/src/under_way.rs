//! What one block begins and a later one ends: an offset path, a plane of several blocks, a curve.

use std::ops::Range;

use nc_dialect::CurveCode;
use nc_syntax::Letters;
use toolpath::Position;

/// How far cutter compensation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) enum Stage {
    /// Not in force, and led off the contour.
    #[default]
    Off,
    /// In force; the next motion in the plane leads onto the contour.
    Starting,
    /// The tool is led along the contour.
    Led,
    /// No longer in force; the next motion in the plane leads off the contour.
    Ending,
}

/// Cutter compensation as far as it decides what may become of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Offset {
    pub(crate) stage: Stage,
    /// Of the cutter by the D beside G41 or G42, nm; `None`: not known.
    pub(crate) radius_nm: Option<u32>,
}

impl Offset {
    /// A motion is neither offset nor leads off an offset path.
    #[must_use]
    pub fn is_off(self) -> bool {
        self.stage == Stage::Off
    }

    /// The radius of the cutter, mm, where the profile says it of the D in force.
    #[must_use]
    pub fn radius_mm(self) -> Option<f64> {
        self.radius_nm.map(|nm| f64::from(nm) / 1e6)
    }

    /// What holds whether blocks with `/` were executed or skipped.
    pub(crate) fn either(self, other: Self, in_force: bool) -> Self {
        if self == other {
            return self;
        }
        Self { stage: if in_force { Stage::Starting } else { Stage::Ending }, radius_nm: None }
    }
}

/// A plane of several blocks (P2, P3), as far as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneBegun {
    /// P.
    pub(crate) form: u32,
    /// By Q: a point, mm.
    pub(crate) points: [Option<[f64; 3]>; 4],
    /// By Q: a direction.
    pub(crate) directions: [Option<[f64; 3]>; 4],
}

/// A curve of several blocks that is not whole yet.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveBegun {
    /// Line of its first block.
    pub line: u64,
    /// Its first block in the file.
    pub(crate) at: Range<u64>,
    pub(crate) form: CurveCode,
    /// What stays as it is until the curve is whole.
    pub(crate) start: Position,
    pub(crate) degree: usize,
    /// Axis commands, mm.
    pub(crate) points_mm: Vec<[f64; 3]>,
    pub(crate) weights: Vec<f64>,
    pub(crate) knots: Vec<f64>,
    /// Axes that its control points name.
    pub(crate) axes: Letters,
    /// Whether K and R above zero have a decimal point, where one has been read.
    pub(crate) pointed: Option<bool>,
}
