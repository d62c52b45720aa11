//! Has the machine changed? Two calibrations compared beyond what they are uncertain of: equation (37).

use diagnostic::Speaks;
use machine_model::{Command, Description, PathModel, RigidBody, Vector, Volume};

use crate::error::CalibrationError;
use crate::field;
use crate::rigid_motion::RigidMotion;

/// How the errors of two calibrations differ over a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Largest difference of the two error fields, mm, after the rigid motion between their frames was taken off.
    pub largest_mm: f64,
    /// Command where it is, mm.
    pub at_mm: Vector,
    /// The difference there, new minus old, mm.
    pub difference_mm: Vector,
    /// Root mean square over the volume, mm.
    pub rms_mm: f64,
    /// The difference that 95 % of the points keep, mm.
    pub p95_mm: f64,
    /// What 95 % of the points keep where nothing has changed, mm; `None` where a calibration does not say how well it is known.
    pub uncertainty_mm: Option<f64>,
}

/// A machine that has not changed shows this many times what is stated in one comparison of a hundred: the errors of a calibration
/// hang together over the volume, and a field of about ten independent unknowns has χ²(99 %, 10)/10 = 2.3 = 1.5² times its mean
/// square.
const ONE_IN_A_HUNDRED: f64 = 1.5;

impl Change {
    /// True where the fields differ by more than one comparison of a hundred unchanged machines does; `None` where the
    /// uncertainty is not known.
    #[must_use]
    pub fn is_beyond_uncertainty(&self) -> Option<bool> {
        self.uncertainty_mm.map(|u| self.p95_mm > ONE_IN_A_HUNDRED * u)
    }
}

/// Grid points per axis, among which the largest difference is looked for.
const GRID: usize = 7;

/// Compares two machines over the volume both know, coming from both sides.
///
/// The rigid motion that brings one nearest to the other is taken off first: each calibration has its own frame, and a frame is no
/// error. It, RMS and what 95 % of the points keep are taken at places all over the volume, of which the uncertainties speak; a
/// grid with its corners keeps less of them.
///
/// * `tool_mm` – tool vector at which they are compared
/// * `uncertainties_mm` – of old and new: what 95 % of the volume's points keep (51c)
///
/// `None` where the two volumes have nothing in common.
#[must_use]
pub fn compare(
    old: &RigidBody,
    new: &RigidBody,
    volume: &Volume,
    tool_mm: Vector,
    uncertainties_mm: [Option<f64>; 2],
) -> Option<Change> {
    let empty =
        |range: &machine_model::Range| range.low.partial_cmp(&range.high) != Some(std::cmp::Ordering::Less);
    if volume.0.iter().any(|range| empty(range) || !(range.high - range.low).is_finite()) {
        return None;
    }
    let node = |axis: usize, k: usize| {
        let range = volume.0[axis];
        range.low + (range.high - range.low) * k as f64 / (GRID - 1) as f64
    };
    let sides: &[i8] = if old.depends_on_direction() || new.depends_on_direction() { &[1, -1] } else { &[0] };
    let grid: Vec<Vector> = (0..GRID * GRID * GRID)
        .map(|k| Vector::new(node(0, k % GRID), node(1, k / GRID % GRID), node(2, k / GRID / GRID)))
        .collect();
    let commands = |places: &[Vector]| -> Vec<Command> {
        let at = |linear_mm: Vector, side: i8| Command {
            linear_mm,
            tool_mm,
            direction: [side; 3],
            ..Default::default()
        };
        places.iter().flat_map(|place| sides.iter().map(move |side| at(*place, *side))).collect()
    };
    let positions = |model: &RigidBody, commands: &[Command]| -> Vec<Vector> {
        commands.iter().map(|c| model.predict(c).position_mm).collect()
    };
    let spread = commands(&field::places_mm(&volume.0));
    let (from, to) = (positions(old, &spread), positions(new, &spread));
    let motion = RigidMotion::nearest(&from, &to);
    let left = |from: &[Vector], to: &[Vector]| -> Vec<Vector> {
        from.iter().zip(to).map(|(a, b)| b - motion.apply(a)).collect()
    };
    let at_places = left(&from, &to);
    let corners = commands(&grid);
    let at_corners = left(&positions(old, &corners), &positions(new, &corners));
    let worst = (0..corners.len()).max_by(|a, b| at_corners[*a].norm().total_cmp(&at_corners[*b].norm()))?;
    let [a, b] = uncertainties_mm;
    Some(Change {
        largest_mm: at_corners[worst].norm(),
        at_mm: corners[worst].linear_mm,
        difference_mm: at_corners[worst],
        rms_mm: (at_places.iter().map(Vector::norm_squared).sum::<f64>() / at_places.len() as f64).sqrt(),
        p95_mm: p95(&at_places),
        uncertainty_mm: a.zip(b).map(|(a, b)| (a * a + b * b).sqrt()),
    })
}

/// Where one error function differs most between two calibrations of an axis, at the nodes of both their tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FunctionChange {
    /// Index of the axis, X first.
    pub axis: usize,
    /// Index of the function: EX, EY, EZ, EA, EB, EC.
    pub function: usize,
    /// Command of that axis where the mean of both directions differs most, mm.
    pub at_mm: f64,
    /// By how much there, new minus old, mm or rad; zero and, where it is sideways, slope of the two set-ups taken off.
    pub by: f64,
    /// By how much the mean reversal value (coming from above less coming from below) differs, mm or rad.
    pub reversal: f64,
}

/// Changes of every function of every axis that has tables or play in both; equation (37) function by function.
///
/// Zero and slope are medians, so that a change at one place does not move what it is measured from.
#[must_use]
pub fn by_function(old: &Description, new: &Description) -> Vec<FunctionChange> {
    let mut found = Vec::new();
    for (axis, (a, b)) in old.linear.iter().zip(&new.linear).enumerate() {
        let low = a.calibrated_mm().low.max(b.calibrated_mm().low);
        let high = a.calibrated_mm().high.min(b.calibrated_mm().high);
        let tables = [a, b].into_iter().flat_map(|x| x.errors.iter().chain(&x.errors_negative));
        let mut nodes: Vec<f64> = tables.flat_map(|t| t.nodes().iter().copied()).collect();
        nodes.retain(|q| (low..=high).contains(q));
        nodes.sort_by(f64::total_cmp);
        nodes.dedup();
        if nodes.len() < 3 {
            continue;
        }
        for function in 0..6 {
            let of = |x: &machine_model::LinearAxis, q: f64| {
                let above = x.errors.as_ref().map_or(0.0, |t| t.at(q)[function]);
                let play = if function == axis { x.backlash_mm } else { 0.0 };
                match &x.errors_negative {
                    Some(t) => (0.5 * (above + t.at(q)[function]), t.at(q)[function] - above),
                    None => (above, play),
                }
            };
            let differences: Vec<(f64, f64)> =
                nodes.iter().map(|q| (of(b, *q).0 - of(a, *q).0, of(b, *q).1 - of(a, *q).1)).collect();
            let half = nodes.len() / 2;
            let sideways = function < 3 && function != axis;
            let slope = if sideways {
                let rises = (0..nodes.len() - half)
                    .map(|i| (differences[i + half].0 - differences[i].0) / (nodes[i + half] - nodes[i]));
                median(rises.collect())
            } else {
                0.0
            };
            let level = |i: usize| differences[i].0 - slope * nodes[i];
            let zero = median((0..nodes.len()).map(level).collect());
            let size = |i: &usize| (level(*i) - zero).abs();
            let Some(worst) = (0..nodes.len()).max_by(|i, j| size(i).total_cmp(&size(j))) else { continue };
            let reversal = differences.iter().map(|d| d.1).sum::<f64>() / differences.len() as f64;
            found.push(FunctionChange {
                axis,
                function,
                at_mm: nodes[worst],
                by: level(worst) - zero,
                reversal,
            });
        }
    }
    found
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

/// What 95 % of the lengths keep.
fn p95(vectors: &[Vector]) -> f64 {
    let mut lengths: Vec<f64> = vectors.iter().map(Vector::norm).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get((lengths.len() * 95).div_ceil(100).saturating_sub(1)).copied().unwrap_or(0.0)
}

/// What 95 % of the places deviate by at most from an ideal machine in the best frame, mm.
pub(crate) fn departure_p95_mm(machine: &Description, commands: &[Command]) -> Result<f64, CalibrationError> {
    let machine = RigidBody::new(machine.clone()).map_err(|error| CalibrationError::Axes(error.text()))?;
    let places = commands.iter().map(|c| machine.predict(c));
    let (real, ideal): (Vec<Vector>, Vec<Vector>) =
        places.map(|p| (p.position_mm, p.position_mm - p.error_mm)).unzip();
    let motion = RigidMotion::nearest(&ideal, &real);
    let left: Vec<Vector> = ideal.iter().zip(&real).map(|(a, b)| b - motion.apply(a)).collect();
    Ok(p95(&left))
}
