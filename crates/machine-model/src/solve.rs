//! The inverse: which command brings the tool to a target. Equation (13).

use nalgebra::Matrix3;

use crate::engine::inside;
use crate::{Solution, SolveError, Vector, Volume};

/// Distance to the target at which a command counts as found, mm.
pub const TOLERANCE_MM: f64 = 1e-10;

/// Rounds of the fixed point before Newton's method takes over: enough for error gradients up to 0.2.
pub(crate) const FIXED_POINT_ROUNDS: u32 = 15;
const NEWTON_ROUNDS: u32 = 30;
/// Step of the difference quotient, mm: large against rounding, small against cells of tables.
const STEP_MM: f64 = 1e-5;

/// Solves `q + e(q) = target` for `q`.
///
/// Fixed point `q ← target - e(q)`, which gains a factor of the error gradient (about 1000) per round;
/// where that does not settle, Newton's method with a difference quotient, steps halved while they do
/// not help. `error` is only asked inside `volume`; an error of exactly zero returns the target's bits.
///
/// # Errors
/// [`SolveError::OutsideVolume`] where the target or the command found leaves the volume;
/// [`SolveError::NotConverged`] where neither method comes within [`TOLERANCE_MM`].
pub fn solve(
    target: &Vector,
    volume: &Volume,
    error: impl Fn(&Vector) -> Vector,
) -> Result<Solution, SolveError> {
    inside(target, volume)?;
    let mut q = *target;
    let mut e = error(&q);
    for iterations in 1..=FIXED_POINT_ROUNDS {
        let residual = (q - target) + e;
        let residual_mm = residual.norm();
        if residual_mm <= TOLERANCE_MM {
            inside(&q, volume)?;
            return Ok(Solution { linear_mm: q, iterations, residual_mm });
        }
        q = target - e;
        e = error(&volume.nearest(&q));
    }
    newton(target, volume, &error)
}

fn newton(
    target: &Vector,
    volume: &Volume,
    error: &impl Fn(&Vector) -> Vector,
) -> Result<Solution, SolveError> {
    // Beyond the volume the error of the nearest point is kept, so that the function stays defined.
    let residual = |q: &Vector| q + error(&volume.nearest(q)) - target;
    let mut q = *target;
    let mut r = residual(&q);
    let mut iterations = FIXED_POINT_ROUNDS + 1;
    for _ in 0..NEWTON_ROUNDS {
        if r.norm() <= TOLERANCE_MM {
            inside(&q, volume)?;
            return Ok(Solution { linear_mm: q, iterations, residual_mm: r.norm() });
        }
        let columns: [Vector; 3] = std::array::from_fn(|axis| {
            let mut step = Vector::zeros();
            step[axis] = STEP_MM;
            (residual(&(q + step)) - residual(&(q - step))) / (2.0 * STEP_MM)
        });
        iterations += 6;
        let Some(inverse) = Matrix3::from_columns(&columns).try_inverse() else { break };
        let mut step = inverse * r;
        for _ in 0..20 {
            let next = residual(&(q - step));
            iterations += 1;
            if next.norm() < r.norm() {
                r = next;
                q -= step;
                break;
            }
            step *= 0.5;
        }
    }
    if r.norm() <= TOLERANCE_MM {
        inside(&q, volume)?;
        return Ok(Solution { linear_mm: q, iterations, residual_mm: r.norm() });
    }
    Err(SolveError::NotConverged { iterations, residual_mm: r.norm() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Range;

    const BOX: Volume = Volume([Range { low: -100.0, high: 100.0 }; 3]);

    #[test]
    fn no_error_gives_the_same_bits() {
        let target = Vector::new(0.1, -0.0, 33.3);
        let solution = solve(&target, &BOX, |_| Vector::zeros()).unwrap();
        assert_eq!(solution.linear_mm.map(f64::to_bits), target.map(f64::to_bits));
        assert_eq!((solution.iterations, solution.residual_mm), (1, 0.0));
    }

    #[test]
    fn large_errors_are_left_to_newton() {
        // Gradient 0.9 and cross terms: the fixed point alone would need hundreds of rounds.
        let error = |q: &Vector| Vector::new(-0.9 * q.x + 0.3 * q.y, 0.8 * q.y, 0.001 * q.x * q.y);
        let solution = solve(&Vector::new(3.0, 5.0, 7.0), &BOX, error).unwrap();
        let back = solution.linear_mm + error(&solution.linear_mm);
        assert!((back - Vector::new(3.0, 5.0, 7.0)).norm() <= TOLERANCE_MM);
        assert!(solution.iterations > FIXED_POINT_ROUNDS);
    }

    #[test]
    fn what_has_no_answer_is_not_answered() {
        // X stands still whatever is commanded.
        let stuck = |q: &Vector| Vector::new(-q.x, 0.0, 0.0);
        assert!(matches!(
            solve(&Vector::new(5.0, 0.0, 0.0), &BOX, stuck),
            Err(SolveError::NotConverged { residual_mm, .. }) if residual_mm > 4.9
        ));
    }

    #[test]
    fn targets_and_answers_outside_are_refused() {
        let outside =
            |target: Vector, shift: f64| solve(&target, &BOX, |_| Vector::new(0.0, shift, 0.0)).unwrap_err();
        assert_eq!(
            outside(Vector::new(0.0, 0.0, 100.001), 0.0),
            SolveError::OutsideVolume { axis: 'Z', value_mm: 100.001, low_mm: -100.0, high_mm: 100.0 }
        );
        assert_eq!(
            outside(Vector::new(0.0, 99.5, 0.0), -1.0),
            SolveError::OutsideVolume { axis: 'Y', value_mm: 100.5, low_mm: -100.0, high_mm: 100.0 }
        );
        assert!(matches!(
            outside(Vector::new(f64::NAN, 0.0, 0.0), 0.0),
            SolveError::OutsideVolume { axis: 'X', .. }
        ));
    }
}
