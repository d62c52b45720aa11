//! What each deviation brings, and how the criteria depend on it.

use machine_model::{Vector, WithEffects};

use crate::{Criteria, Field, Machine};

/// Coefficients are moved by this for a central difference. The error at a point is a polynomial of second
/// order in each of them but for terms in the cube of an angle: what they leave in the difference is below
/// `L θ³ STEP²/6`, 1e-9 mm for a milliradian and a lever of a metre. A power of two: no rounding of 1 ± STEP.
const STEP: f64 = 1.0 / 16.0;

/// Points whose |d| is that close, relatively, to the largest one hold the maximum together.
const TIE: f64 = 1e-9;

/// A derivative to the left and to the right: they differ where the control point that makes the criterion
/// changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSided {
    /// Where the coefficient shrinks.
    pub left: f64,
    /// Where it grows.
    pub right: f64,
}

impl OneSided {
    fn less(self, other: Self) -> Self {
        Self { left: self.left - other.left, right: self.right - other.right }
    }
}

/// One deviation in the budget.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Its index in [`Machine::deviations`].
    pub deviation: usize,
    /// The machine with this deviation alone.
    pub alone: Criteria,
    /// The machine without it.
    pub without: Criteria,
    /// ∂M/∂ε, mm.
    pub largest_slope_mm: OneSided,
    /// ∂A/∂ε, mm.
    pub spread_slope_mm: OneSided,
    /// ∂RMS/∂ε, mm.
    pub rms_slope_mm: f64,
}

/// The budget of a machine over its control points.
#[derive(Clone, Debug, PartialEq)]
pub struct Budget {
    /// The machine as measured.
    pub measured: Criteria,
    /// Its errors, mm.
    pub errors_mm: Vec<Vector>,
    /// Its deviations, first the one without which M is smallest.
    pub items: Vec<Item>,
    /// What each deviation contributes alone.
    pub field: Field,
    /// Second order: largest distance of the machine's error from the sum of the contributions, mm.
    pub remainder_mm: f64,
    /// The control point where it is largest.
    pub remainder_at: usize,
}

impl Budget {
    /// Evaluates the machine, each deviation alone, the machine without it, and with a little more and less
    /// of it: equations (52), (53).
    ///
    /// * `evaluate` – errors of a machine at the control points, mm, always the same points in the same order
    ///
    /// `None` without control points.
    #[must_use]
    pub fn new(machine: &Machine, evaluate: impl Fn(&WithEffects) -> Vec<Vector>) -> Option<Self> {
        let count = machine.deviations().len();
        let errors_mm = evaluate(machine.model());
        let measured = Criteria::of(&errors_mm)?;
        let mut contributions_mm = Vec::with_capacity(count);
        let mut items = Vec::with_capacity(count);
        for deviation in 0..count {
            let with = |own: f64, others: f64| {
                let of = |other: usize| if other == deviation { own } else { others };
                evaluate(&machine.scaled(&(0..count).map(of).collect::<Vec<_>>()))
            };
            let alone = with(1.0, 0.0);
            let (more, less) = (with(1.0 + STEP, 1.0), with(1.0 - STEP, 1.0));
            let slopes: Vec<Vector> =
                more.iter().zip(&less).map(|(more, less)| (more - less) / (2.0 * STEP)).collect();
            let [largest_slope_mm, smallest] = slopes_of_extremes(&errors_mm, &slopes, &measured);
            items.push(Item {
                deviation,
                alone: Criteria::of(&alone)?,
                without: Criteria::of(&with(0.0, 1.0))?,
                largest_slope_mm,
                spread_slope_mm: largest_slope_mm.less(smallest),
                rms_slope_mm: rms_slope(&errors_mm, &slopes, &measured),
            });
            contributions_mm.push(alone);
        }
        let key = |item: &Item| (item.without.largest_mm, -item.alone.largest_mm);
        items.sort_by(|a, b| {
            let ((m, alone), (other_m, other_alone)) = (key(a), key(b));
            m.total_cmp(&other_m).then(alone.total_cmp(&other_alone)).then(a.deviation.cmp(&b.deviation))
        });
        let field = Field { contributions_mm };
        let left = |point: usize| {
            let sum: Vector = field.contributions_mm.iter().map(|own| own[point]).sum();
            (errors_mm[point] - sum).norm()
        };
        let (remainder_mm, remainder_at) = (0..errors_mm.len())
            .map(|point| (left(point), point))
            .reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        Some(Self { measured, errors_mm, items, field, remainder_mm, remainder_at })
    }

    /// `Σ ε_i ∂M/∂ε_i`: M itself for a machine linear in its coefficients (Euler), else M to second order.
    /// Where the derivative has two sides, the right one.
    #[must_use]
    pub fn sum_of_slopes_mm(&self) -> f64 {
        self.items.iter().map(|item| item.largest_slope_mm.right).sum()
    }
}

/// One-sided derivatives of the largest and of the smallest |d|: among the points that hold the extreme, the one that
/// moves most in its direction (Danskin 1966).
fn slopes_of_extremes(errors_mm: &[Vector], slopes: &[Vector], measured: &Criteria) -> [OneSided; 2] {
    let tie = TIE * measured.largest_mm;
    let unset = [f64::INFINITY, f64::NEG_INFINITY];
    // Per extreme: least left, most right for the largest; the other way round for the smallest.
    let ([mut left, mut right], [mut low_right, mut low_left]) = (unset, unset);
    for (error, slope) in errors_mm.iter().zip(slopes) {
        let length = error.norm();
        // A length grows to both sides of zero.
        let (own_left, own_right) = if length <= tie {
            (-slope.norm(), slope.norm())
        } else {
            let along = error.dot(slope) / length;
            (along, along)
        };
        if length >= measured.largest_mm - tie {
            left = left.min(own_left);
            right = right.max(own_right);
        }
        if length <= measured.smallest_mm + tie {
            low_left = low_left.max(own_left);
            low_right = low_right.min(own_right);
        }
    }
    [OneSided { left, right }, OneSided { left: low_left, right: low_right }]
}

/// `Σ d·∂d/∂ε / (N RMS)`; of a machine without errors 0.
fn rms_slope(errors_mm: &[Vector], slopes: &[Vector], measured: &Criteria) -> f64 {
    let sum: f64 = errors_mm.iter().zip(slopes).map(|(error, slope)| error.dot(slope)).sum();
    if measured.rms_mm > 0.0 { sum / (errors_mm.len() as f64 * measured.rms_mm) } else { 0.0 }
}
