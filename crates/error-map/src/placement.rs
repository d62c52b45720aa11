//! Where to clamp: the place in the volume where a workpiece gets the least error.

use diagnostic::Speaks;
use machine_model::{Range, Vector, Volume};
use nalgebra::Matrix3;

use crate::Statistics;

/// What a set-up can take out of the error: the workpiece is moved or turned, or its frame in the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// The zero point.
    Shift,
    /// The zero point, and a turn about Z: alignment on the table, or a rotated frame (G68).
    ShiftAndTurn,
    /// The zero point and all three turns: shims, or a tilted frame (G68.2).
    Rigid,
}

/// The rigid motion of a box that explains most of its errors, and what it leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidFit {
    /// Motion of the centre, mm: the mean error.
    pub shift_mm: Vector,
    /// Turn about the centre, rad.
    pub rotation_rad: Vector,
    /// The centre, mm.
    pub centre_mm: Vector,
    /// Figures of the errors as they are.
    pub before: Statistics,
    /// Figures of what is left.
    pub after: Statistics,
}

/// A place for a box, mm, axis commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The box.
    pub box_mm: [Range; 3],
    /// What happens in it.
    pub fit: RigidFit,
}

/// The box does not fit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the box is {size_mm} mm long in {axis}, the calibrated volume {room_mm} mm")]
pub struct TooLarge {
    /// X, Y or Z.
    pub axis: char,
    /// Length of the box, mm.
    pub size_mm: f64,
    /// Length of the volume, mm.
    pub room_mm: f64,
}

impl Speaks for TooLarge {
    fn russian(&self) -> String {
        format!("габарит по {} — {} мм, а калиброванный объём — {} мм", self.axis, self.size_mm, self.room_mm)
    }
}

/// Samples of a box per axis: corners, and four places between each two.
const SAMPLES: usize = 6;
/// Places along each axis in the first round.
const PLACES: usize = 13;
/// Rounds of half the step that follow.
const ROUNDS: usize = 6;

/// The rigid motion `s + θ × (q - c)` nearest to errors, by least squares: equation (45).
///
/// To first order in θ; what is neglected is `θ²/2` of the box's size, 0.05 µm for 1 mrad over 100 mm.
/// Turns that the places cannot show (about a line they all lie on) are zero. `None` without places.
#[must_use]
pub fn fit(
    places_mm: &[Vector],
    errors_mm: &[Vector],
    freedom: Freedom,
    tolerance_mm: f64,
) -> Option<RigidFit> {
    let before = Statistics::of(errors_mm, tolerance_mm)?;
    let count = errors_mm.len() as f64;
    let centre_mm = places_mm.iter().sum::<Vector>() / count;
    let shift_mm = errors_mm.iter().sum::<Vector>() / count;
    let mut inertia = Matrix3::zeros();
    let mut moment = Vector::zeros();
    for (place, error) in places_mm.iter().zip(errors_mm) {
        let lever = place - centre_mm;
        inertia += Matrix3::identity() * lever.norm_squared() - lever * lever.transpose();
        moment += lever.cross(&(error - shift_mm));
    }
    let rotation_rad = match freedom {
        Freedom::Shift => Vector::zeros(),
        Freedom::ShiftAndTurn if inertia[(2, 2)] > 0.0 => Vector::new(0.0, 0.0, moment.z / inertia[(2, 2)]),
        Freedom::ShiftAndTurn => Vector::zeros(),
        Freedom::Rigid => {
            let least = 1e-12 * inertia.trace();
            inertia.svd(true, true).solve(&moment, least).unwrap_or_default()
        }
    };
    let left: Vec<Vector> = places_mm
        .iter()
        .zip(errors_mm)
        .map(|(place, error)| error - shift_mm - rotation_rad.cross(&(place - centre_mm)))
        .collect();
    let after = Statistics::of(&left, tolerance_mm)?;
    Some(RigidFit { shift_mm, rotation_rad, centre_mm, before, after })
}

/// The place for a box with the smallest RMS error after the best rigid motion.
///
/// * `size_mm` – lengths of the box; its sides stay along the axes
/// * `error_mm` – volumetric error at an axis command, mm
///
/// Tries 13 places along each axis, each sampled at 6×6×6 points, then closes in on the best six times with half the
/// step. The errors of machines are smooth over a box, so between tried places nothing much better
/// hides; it is not proven.
///
/// # Errors
/// [`TooLarge`] where the box is longer than the volume.
pub fn search(
    volume: &Volume,
    size_mm: &Vector,
    freedom: Freedom,
    tolerance_mm: f64,
    error_mm: impl Fn(&Vector) -> Vector,
) -> Result<Place, TooLarge> {
    let low = Vector::from_fn(|axis, _| volume.0[axis].low);
    let room = Vector::from_fn(|axis, _| volume.0[axis].high - volume.0[axis].low) - size_mm;
    for axis in 0..3 {
        // A box as long as the volume fits, decimals of both apart.
        if !(room[axis] >= -1e-9 * size_mm[axis] && size_mm[axis] >= 0.0) {
            return Err(TooLarge {
                axis: ['X', 'Y', 'Z'][axis],
                size_mm: size_mm[axis],
                room_mm: room[axis] + size_mm[axis],
            });
        }
    }
    let room = room.sup(&Vector::zeros());
    let at = |corner: &Vector| {
        let along = |axis: usize, i: usize| corner[axis] + size_mm[axis] * i as f64 / (SAMPLES - 1) as f64;
        let places: Vec<Vector> = (0..SAMPLES.pow(3))
            .map(|n| {
                let i = [n % SAMPLES, n / SAMPLES % SAMPLES, n / (SAMPLES * SAMPLES)];
                Vector::from_fn(|axis, _| along(axis, i[axis]).min(volume.0[axis].high))
            })
            .collect();
        let errors: Vec<Vector> = places.iter().map(&error_mm).collect();
        let fit = fit(&places, &errors, freedom, tolerance_mm).expect("a box has samples");
        let box_mm = [0, 1, 2].map(|axis| Range { low: corner[axis], high: corner[axis] + size_mm[axis] });
        Place { box_mm, fit }
    };
    let better = |a: &Place, b: &Place| a.fit.after.rms_mm < b.fit.after.rms_mm;
    let last = (PLACES - 1) as f64;
    let mut best = at(&low);
    for n in 0..PLACES.pow(3) {
        let i = [n % PLACES, n / PLACES % PLACES, n / (PLACES * PLACES)];
        // Along an axis without room all places are the same one.
        if (0..3).any(|axis| room[axis] == 0.0 && i[axis] > 0) {
            continue;
        }
        let found = at(&(low + Vector::from_fn(|axis, _| room[axis] * i[axis] as f64 / last)));
        if better(&found, &best) {
            best = found;
        }
    }
    let mut step = room / last;
    for _ in 0..ROUNDS {
        step *= 0.5;
        let from = Vector::from_fn(|axis, _| best.box_mm[axis].low);
        for n in 0..27 {
            let i = [n % 3, n / 3 % 3, n / 9];
            let corner = Vector::from_fn(|axis, _| {
                let moved = from[axis] + step[axis] * (f64::from(i[axis]) - 1.0);
                moved.clamp(low[axis], low[axis] + room[axis])
            });
            let found = at(&corner);
            if better(&found, &best) {
                best = found;
            }
        }
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VOLUME: Volume = Volume([
        Range { low: 0.0, high: 400.0 },
        Range { low: -100.0, high: 200.0 },
        Range { low: 0.0, high: 200.0 },
    ]);

    #[test]
    fn a_rigid_motion_is_found_and_leaves_nothing() {
        let shift = Vector::new(0.01, -0.02, 0.005);
        let turn = Vector::new(1e-4, -2e-4, 3e-4);
        let centre = Vector::new(50.0, 60.0, 70.0);
        let places: Vec<Vector> = (0..27)
            .map(|n| centre + Vector::from_fn(|a, _| 10.0 * (f64::from(n / 3i32.pow(a as u32) % 3) - 1.0)))
            .collect();
        let errors: Vec<Vector> = places.iter().map(|p| shift + turn.cross(&(p - centre))).collect();
        let found = fit(&places, &errors, Freedom::Rigid, 0.001).unwrap();
        assert!((found.shift_mm - shift).norm() < 1e-15);
        assert!((found.rotation_rad - turn).norm() < 1e-15);
        assert!(found.after.magnitude_mm.high < 1e-14);
        let about_z = fit(&places, &errors, Freedom::ShiftAndTurn, 0.001).unwrap();
        assert_eq!((about_z.rotation_rad.x, about_z.rotation_rad.y), (0.0, 0.0));
        assert!((about_z.rotation_rad.z - 3e-4).abs() < 1e-15);
        assert!(found.after.rms_mm < about_z.after.rms_mm && about_z.after.rms_mm < found.before.rms_mm);
        // Places on a line along X say nothing of a turn about X.
        let line: Vec<Vector> = places.iter().map(|p| Vector::new(p.x, 0.0, 0.0)).collect();
        let errors: Vec<Vector> = line.iter().map(|p| turn.cross(p)).collect();
        let found = fit(&line, &errors, Freedom::Rigid, 0.001).unwrap();
        assert!(found.rotation_rad.x.abs() < 1e-12 && (found.rotation_rad.y - turn.y).abs() < 1e-12);
    }

    /// Errors that bend everywhere but near one corner of the box' places.
    #[test]
    fn the_quiet_corner_is_found() {
        let quiet = Vector::new(310.0, -20.0, 60.0);
        let error = |q: &Vector| {
            let away = q - quiet;
            Vector::new(1e-8 * away.y.powi(3), 1e-8 * away.z.powi(3), 1e-8 * away.x.powi(3))
        };
        let size = Vector::new(60.0, 40.0, 80.0);
        let found = search(&VOLUME, &size, Freedom::Rigid, 0.001, error).unwrap();
        let centre = Vector::from_fn(|a, _| 0.5 * (found.box_mm[a].low + found.box_mm[a].high));
        assert!((centre - quiet).amax() < 1.0, "{centre}");
        for axis in 0..3 {
            assert!(VOLUME.0[axis].low <= found.box_mm[axis].low);
            assert!(found.box_mm[axis].high <= VOLUME.0[axis].high + 1e-9);
        }
    }

    #[test]
    fn a_box_may_fill_the_volume_and_not_exceed_it() {
        let still = |_: &Vector| Vector::new(0.003, 0.0, 0.0);
        let all = search(&VOLUME, &Vector::new(400.0, 300.0, 200.0), Freedom::Shift, 0.001, still).unwrap();
        assert_eq!(all.box_mm[1], Range { low: -100.0, high: 200.0 });
        assert!(all.fit.after.magnitude_mm.high < 1e-15);
        let error = search(&VOLUME, &Vector::new(1.0, 300.5, 1.0), Freedom::Shift, 0.001, still).unwrap_err();
        assert_eq!(error.to_string(), "the box is 300.5 mm long in Y, the calibrated volume 300 mm");
        assert!(search(&VOLUME, &Vector::new(1.0, f64::NAN, 1.0), Freedom::Shift, 0.001, still).is_err());
    }
}
