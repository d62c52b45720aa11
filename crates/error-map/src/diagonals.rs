//! The four body diagonals of the volume: positioning accuracy along them as ISO 230-6:2002 reads it.

use machine_model::{Range, Vector};

/// Positioning along one body diagonal, both ways.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagonal {
    /// Signs of the axes along it: `[1, 1, -1]` runs from X-, Y-, Z+ to X+, Y+, Z-.
    pub signs: [i8; 3],
    /// Its beginning, mm, axis command.
    pub from_mm: Vector,
    /// Its end, mm.
    pub to_mm: Vector,
    /// Per target: distance from the beginning and deviation forward and backward, mm.
    pub deviations_mm: Vec<[f64; 3]>,
    /// Systematic positioning deviation, both directions (E): range of all mean deviations, mm.
    pub systematic_mm: f64,
    /// Range of the mean of both directions (M), mm.
    pub mean_mm: f64,
    /// Reversal value (B): largest difference of the directions at a target, mm.
    pub reversal_mm: f64,
    /// Deviation at the end against the beginning, forward, mm: the diagonal is that much too long.
    pub length_error_mm: f64,
}

/// The signs of the diagonals in the order of ISO 230-6: all positive first, then one axis turned each.
const SIGNS: [[i8; 3]; 4] = [[1, 1, 1], [-1, 1, 1], [1, -1, 1], [1, 1, -1]];

/// What an interferometer along each body diagonal of a box would read.
///
/// * `ranges_mm` – the box of axis commands
/// * `targets` – target positions along a diagonal, at least 2; ISO 230-6 wants five per metre
/// * `error_mm` – the machine: volumetric error at a command, with the direction of each axis
///
/// The deviation at a target is the part of `d - d(beginning)` along the diagonal, because the
/// interferometer is set to zero at its beginning, once. What stands square to the beam is not seen.
#[must_use]
pub fn body_diagonals(
    ranges_mm: &[Range; 3],
    targets: u32,
    error_mm: impl Fn(&Vector, [i8; 3]) -> Vector,
) -> Vec<Diagonal> {
    let targets = targets.max(2);
    SIGNS
        .map(|signs| {
            let end = |sign: i8, range: &Range| if sign > 0 { range.high } else { range.low };
            let from_mm = Vector::from_fn(|axis, _| end(-signs[axis], &ranges_mm[axis]));
            let to_mm = Vector::from_fn(|axis, _| end(signs[axis], &ranges_mm[axis]));
            let length = (to_mm - from_mm).norm();
            let along = (to_mm - from_mm).try_normalize(0.0).unwrap_or_default();
            let back = signs.map(|sign| -sign);
            let zero = error_mm(&from_mm, signs);
            let deviations_mm: Vec<[f64; 3]> = (0..targets)
                .map(|target| {
                    let share = f64::from(target) / f64::from(targets - 1);
                    let at = from_mm.lerp(&to_mm, share);
                    let seen = |signs| (error_mm(&at, signs) - zero).dot(&along);
                    [share * length, seen(signs), seen(back)]
                })
                .collect();
            let range = |values: &mut dyn Iterator<Item = f64>| {
                let (low, high) = values
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (v.min(low), v.max(high)));
                high - low
            };
            Diagonal {
                signs,
                from_mm,
                to_mm,
                systematic_mm: range(&mut deviations_mm.iter().flat_map(|row| [row[1], row[2]])),
                mean_mm: range(&mut deviations_mm.iter().map(|row| 0.5 * (row[1] + row[2]))),
                reversal_mm: deviations_mm.iter().map(|row| (row[1] - row[2]).abs()).fold(0.0, f64::max),
                length_error_mm: deviations_mm[deviations_mm.len() - 1][1],
                deviations_mm,
            }
        })
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: [Range; 3] =
        [Range { low: 0.0, high: 300.0 }, Range { low: 0.0, high: 400.0 }, Range { low: 0.0, high: 1200.0 }];

    #[test]
    fn squareness_makes_two_diagonals_longer_and_two_shorter() {
        // dx = -EC0Y·y: above 90° between X and Y the diagonal from corner to corner gets shorter.
        let ec0y = 1e-4;
        let found = body_diagonals(&BOX, 5, |q, _| Vector::new(-ec0y * q.y, 0.0, 0.0));
        // Over 400 mm in y x moves by -0.04 mm; the diagonal is 1300 mm, 300 of it along x.
        let expected = 0.04 * 300.0 / 1300.0;
        let lengths: Vec<f64> = found.iter().map(|d| d.length_error_mm).collect();
        for (length, sign) in lengths.iter().zip([-1.0, 1.0, 1.0, -1.0]) {
            assert!((length - sign * expected).abs() < 1e-15, "{lengths:?}");
        }
        assert!(found.iter().all(|d| (d.systematic_mm - expected).abs() < 1e-15 && d.reversal_mm == 0.0));
    }

    #[test]
    fn backlash_is_the_reversal_value_seen_along_the_diagonal() {
        let found = body_diagonals(&BOX, 9, |_, signs| Vector::new(0.0, 0.0, -0.005 * f64::from(signs[2])));
        for diagonal in found {
            assert!((diagonal.reversal_mm - 0.01 * 1200.0 / 1300.0).abs() < 1e-15);
            assert!(diagonal.mean_mm < 1e-15);
            assert_eq!(diagonal.deviations_mm.len(), 9);
            assert_eq!(diagonal.deviations_mm[0][1], 0.0);
        }
    }
}
