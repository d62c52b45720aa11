//! Has the machine changed? Two calibrations compared beyond what they are uncertain of: equation (37).

use machine_model::{Command, RigidBody, Vector, Volume};

use crate::tracker::rigid_displacement;

/// How the errors of two calibrations differ over a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Largest difference of the two error fields, mm, after a rigid displacement was taken off.
    pub largest_mm: f64,
    /// Command where it is, mm.
    pub at_mm: Vector,
    /// The difference there, new minus old, mm.
    pub difference_mm: Vector,
    /// Root mean square over the volume, mm.
    pub rms_mm: f64,
    /// Half width of the 95 % interval of a difference, mm; `None` where a calibration does not say how well it is known.
    pub uncertainty_mm: Option<f64>,
}

impl Change {
    /// True where the difference exceeds its uncertainty; `None` where that is not known.
    #[must_use]
    pub fn is_beyond_uncertainty(&self) -> Option<bool> {
        self.uncertainty_mm.map(|u| self.largest_mm > u)
    }
}

/// Grid points per axis.
const GRID: usize = 7;

/// Compares two machines over the volume both know.
///
/// A shift and a small rotation are taken off first: each calibration has its own frame, and a frame is no error.
///
/// * `tool_mm` – tool vector at which they are compared
/// * `uncertainties_mm` – half widths of the 95 % intervals of old and new at the far corner
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
    use machine_model::PathModel;
    if volume.0.iter().any(|range| range.low.partial_cmp(&range.high) != Some(std::cmp::Ordering::Less)) {
        return None;
    }
    let node = |axis: usize, k: usize| {
        let range = volume.0[axis];
        range.low + (range.high - range.low) * k as f64 / (GRID - 1) as f64
    };
    let mut commands = Vec::new();
    for i in 0..GRID {
        for j in 0..GRID {
            for k in 0..GRID {
                commands.push(Vector::new(node(0, i), node(1, j), node(2, k)));
            }
        }
    }
    let error = |model: &RigidBody, at: &Vector| {
        model.error_mm(&Command { linear_mm: *at, rotary_rad: Vector::zeros(), tool_mm, direction: [0; 3] })
    };
    let differences: Vec<Vector> = commands.iter().map(|at| error(new, at) - error(old, at)).collect();
    let moved: Vec<Vector> = commands.iter().zip(&differences).map(|(at, d)| at + d).collect();
    let (shift, turn) = rigid_displacement(&commands, &moved)?;
    let left: Vec<Vector> =
        commands.iter().zip(&differences).map(|(at, d)| d - shift - turn.cross(at)).collect();
    let worst = (0..left.len()).max_by(|a, b| left[*a].norm().total_cmp(&left[*b].norm()))?;
    let [a, b] = uncertainties_mm;
    Some(Change {
        largest_mm: left[worst].norm(),
        at_mm: commands[worst],
        difference_mm: left[worst],
        rms_mm: (left.iter().map(Vector::norm_squared).sum::<f64>() / left.len() as f64).sqrt(),
        uncertainty_mm: a.zip(b).map(|(a, b)| (a * a + b * b).sqrt()),
    })
}
