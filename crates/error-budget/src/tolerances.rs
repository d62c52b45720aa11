//! What each deviation may be, so that a machine not yet measured keeps a target.

use machine_model::{Vector, WithEffects};

use crate::{Criteria, Extreme, Field, Machine, Unit, balanced_signs, root_sum_of_squares, worst_case};

/// Steps of the search for the influence; each makes the bracket smaller by far more than half.
const MOST_STEPS: usize = 60;
/// The influence is found to this part of itself.
const CLOSE: f64 = 1e-9;

/// No angle gets a larger tolerance, rad: with next to no arm it could be a whole turn, and the model is one of small angles.
const LARGEST_ANGLE_RAD: f64 = 0.01;
/// What moves no control point by more than that, mm, moves none: it is rounding.
const NOTHING_MM: f64 = 1e-9;

/// Which figure keeps the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// All signs at their worst, all functions at their limits at once.
    WorstCase,
    /// Root sum of squares: sizes as multiples of standard deviations of independent deviations.
    Statistical,
}

/// A tolerance for each deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerances {
    /// By deviation: what it may be, in units of its size; `None` where it moves no control point.
    pub factors: Vec<Option<f64>>,
    /// What every deviation that is not kept may bring alone, mm.
    pub influence_mm: f64,
    /// The figure that keeps the target, by sums of contributions, mm.
    pub figure_mm: f64,
    /// The control point that sets it.
    pub at: usize,
    /// The same of the whole model, mm. Worst case: M with the signs that make the figure. Statistical: root mean square
    /// at that point over the machines of [`balanced_signs`].
    pub whole_model_mm: f64,
    /// The worst case of these tolerances, mm: the figure itself, or what the statistical set may come to.
    pub worst: Extreme,
}

/// Equal influence: tolerances by which each deviation may bring the same at the point where it brings most,
/// and all together the target: equation (57). Angles that would need more than 0.01 rad for that get 0.01 rad.
///
/// * `machine`, `field` – [`Machine::at_its_sizes`] and what its deviations contribute
/// * `keep` – deviations that stay as they are
///
/// Where the whole model is above the target, by the second order, all tolerances are made smaller by as much. `None` where
/// those that are kept reach the target by themselves, or no other moves a point.
#[must_use]
pub fn equal_influence(
    machine: &Machine,
    field: &Field,
    keep: &[bool],
    target_mm: f64,
    figure: Figure,
    evaluate: impl Fn(&WithEffects, usize) -> Vector,
    evaluate_all: impl Fn(&WithEffects) -> Vec<Vector>,
) -> Option<Tolerances> {
    let shares: Vec<Share> = machine
        .deviations()
        .iter()
        .zip(field.largest_mm())
        .zip(keep)
        .map(|((deviation, largest_mm), keep)| match deviation.unit {
            _ if *keep => Share::Kept,
            _ if largest_mm <= NOTHING_MM => Share::Nothing,
            Unit::Angle => Share::Of { largest_mm, limit: LARGEST_ANGLE_RAD / deviation.size },
            _ => Share::Of { largest_mm, limit: f64::INFINITY },
        })
        .collect();
    if !shares.iter().any(|share| matches!(share, Share::Of { .. })) {
        return None;
    }
    let factors = |influence_mm: f64| -> Vec<f64> {
        shares.iter().map(|share| share.factor(influence_mm).unwrap_or(0.0)).collect()
    };
    let figure_of = |influence_mm: f64| {
        let scaled = field.scaled(&factors(influence_mm));
        match figure {
            Figure::WorstCase => {
                let worst = worst_case(&scaled);
                (worst.mm, worst.at)
            }
            Figure::Statistical => root_sum_of_squares(&scaled),
        }
    };
    let whole_model = |influence_mm: f64, at: usize, worst: &Extreme| {
        let factors = factors(influence_mm);
        let with = |signs: &[f64]| {
            machine.scaled(&factors.iter().zip(signs).map(|(f, s)| f * s).collect::<Vec<_>>())
        };
        match figure {
            Figure::WorstCase => {
                Criteria::of(&evaluate_all(&with(&worst.signs))).map_or(0.0, |found| found.largest_mm)
            }
            Figure::Statistical => {
                let rows = balanced_signs(keep.len());
                let squares = rows.iter().map(|signs| evaluate(&with(signs), at).norm_squared());
                (squares.sum::<f64>() / rows.len() as f64).sqrt()
            }
        }
    };
    let mut aim_mm = target_mm;
    loop {
        if aim_mm <= 0.0 {
            return None;
        }
        // Below the aim by what rounding may add.
        let below_mm = aim_mm * (1.0 - 1e-12);
        let influence_mm = match shares.iter().all(|share| share.is_proportional_to(aim_mm)) {
            true => below_mm * (below_mm / figure_of(below_mm).0),
            false => influence(|c| figure_of(c).0, below_mm)?,
        };
        let (figure_mm, at) = figure_of(influence_mm);
        let worst = worst_case(&field.scaled(&factors(influence_mm)));
        let whole_model_mm = whole_model(influence_mm, at, &worst);
        if whole_model_mm > target_mm {
            aim_mm -= (whole_model_mm - target_mm).max(CLOSE * target_mm);
            continue;
        }
        let factors = shares.iter().map(|share| share.factor(influence_mm)).collect();
        return Some(Tolerances { factors, influence_mm, figure_mm, at, whole_model_mm, worst });
    }
}

/// What a deviation gets.
enum Share {
    /// It is as it is.
    Kept,
    /// It moves no control point.
    Nothing,
    /// The influence over what it brings at its size, up to a limit.
    Of { largest_mm: f64, limit: f64 },
}

impl Share {
    fn factor(&self, influence_mm: f64) -> Option<f64> {
        match self {
            Self::Kept => Some(1.0),
            Self::Nothing => None,
            Self::Of { largest_mm, limit } => Some((influence_mm / largest_mm).min(*limit)),
        }
    }

    /// Its factor is proportional to all influences up to this one.
    fn is_proportional_to(&self, influence_mm: f64) -> bool {
        match self {
            Self::Kept => false,
            Self::Nothing => true,
            Self::Of { largest_mm, limit } => influence_mm / largest_mm <= *limit,
        }
    }
}

/// The influence whose figure is the aim, not above it. The figure grows with the influence, since a length is convex, and is at
/// least the influence, unless all factors are at their limits.
fn influence(figure_mm: impl Fn(f64) -> f64, aim_mm: f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, aim_mm);
    let (mut below, mut above) = (figure_mm(low) - aim_mm, figure_mm(high) - aim_mm);
    if below > 0.0 {
        return None;
    }
    if above <= 0.0 {
        return Some(high);
    }
    // False position; an end that stays twice counts half (Illinois).
    let mut stayed = 0;
    for _ in 0..MOST_STEPS {
        if high - low <= CLOSE * high {
            break;
        }
        let middle = (high - (high - low) * above / (above - below)).clamp(low, high);
        let found = figure_mm(middle) - aim_mm;
        if found > 0.0 {
            (high, above) = (middle, found);
            below *= if stayed == 1 { 0.5 } else { 1.0 };
            stayed = 1;
        } else {
            (low, below) = (middle, found);
            above *= if stayed == -1 { 0.5 } else { 1.0 };
            stayed = -1;
        }
        if found <= 0.0 && -found <= CLOSE * aim_mm {
            break;
        }
    }
    (low > 0.0).then_some(low)
}
