//! How far the tool would have been off without correction, for the summary.

use machine_model::{Command, Move, turned_by_mm};

use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::short_line::with_its_error;

impl Corrector<'_> {
    /// Upper bound of the error at a place that takes a correction of so many mm: the error at its corrected command is that
    /// correction, and what it changes from one to the other is little. `None` where the model says nothing of that.
    pub(crate) fn error_before_mm(&self, correction_mm: f64) -> Option<f64> {
        let everywhere = self.everywhere.as_ref()?.2.as_deref()?;
        (!self.model.depends_on_direction()).then(|| with_its_error(everywhere, correction_mm))
    }

    /// Upper bound of the deviation that an arc would have had uncorrected, mm: a quarter of it leaves the chord of its ends' errors
    /// by less than the whole.
    ///
    /// * `at_quarters_mm` – its largest correction at s = 0, ¼, ½, ¾, 1
    pub(crate) fn before_by_quarters_mm(&self, whole: &Curve, at_quarters_mm: f64) -> Option<f64> {
        let everywhere = self.everywhere.as_ref()?.2.as_deref()?;
        // Of more than one turn a quarter may pass a place more than twice.
        if whole.turning_rad() > 7.0 || !whole.lies_inside(&everywhere.volume) {
            return None;
        }
        let (speed, acceleration) = whole.fastest(0.0, 0.25)?;
        let bow = everywhere.chord_bound_of_curve_mm(speed, acceleration);
        Some(self.error_before_mm(at_quarters_mm)? + bow).filter(|bound| bound.is_finite())
    }

    /// Upper bound of the deviation that a motion would have had uncorrected, mm.
    ///
    /// * `at_ends_mm` – the largest correction at its ends, where both are known
    pub(crate) fn before_mm(&self, whole: &Curve, state: &Command, at_ends_mm: Option<f64>) -> f64 {
        let at = |s: f64| Command { linear_mm: whole.at(s), ..*state };
        let evaluated = || {
            // Axes that turn on the way take their play with them.
            let turns = self.model.depends_on_direction() && !whole.turns().is_empty();
            let turned = |at: &Command| (0..3).map(|axis| turned_by_mm(self.model, at, axis).norm()).sum();
            let error = |at: Command| self.model.error_mm(&at).norm() + if turns { turned(&at) } else { 0.0 };
            error(at(0.0)).max(error(at(1.0)))
        };
        let ends_mm = at_ends_mm.and_then(|mm| self.error_before_mm(mm)).unwrap_or_else(evaluated);
        let course = whole.fastest(0.0, 1.0);
        let everywhere = self.everywhere.as_ref().and_then(|known| known.2.as_deref());
        let looked_up =
            everywhere.filter(|everywhere| whole.lies_inside(&everywhere.volume)).map(|everywhere| {
                match course {
                    Some((speed, acceleration)) => everywhere.chord_bound_of_circle_mm(speed, acceleration),
                    None => everywhere.chord_bound_mm((whole.at(1.0) - whole.at(0.0)).amax()),
                }
            });
        let between_mm = looked_up.filter(|bow| bow.is_finite()).unwrap_or_else(|| {
            let extent = whole.extent(0.0, 1.0);
            self.model.chord_bound_mm(&Move {
                range_mm: extent.range,
                speed_mm: extent.speed,
                acceleration_mm: extent.acceleration,
                passes: if course.is_some() { 4 } else { 1 },
                state: *state,
                turn: None,
            })
        });
        if between_mm.is_finite() { ends_mm + between_mm } else { ends_mm }
    }
}

#[cfg(test)]
mod tests {
    use machine_model::{PathModel, Vector};
    use proptest::prelude::*;
    use toolpath::{Arc, Plane, Shape};

    use super::*;
    use crate::testing::{block, machine};
    use crate::{Options, Outside};

    proptest! {
        #[test]
        fn an_arc_is_nowhere_further_off_uncorrected(
            monotone: bool, plane in 0usize..3, middle in prop::array::uniform3(60.0f64..140.0), radius in 0.3f64..40.0,
            angle in -4.0f64..4.0, sweep in prop_oneof![-6.2f64..-0.05, 0.05f64..6.2],
        ) {
            let model = machine(monotone);
            let plane = [Plane::Xy, Plane::Zx, Plane::Yz][plane];
            let [u, v, _] = plane.axes();
            let options = Options { tolerance_mm: 0.001, accept_mm: 0.0, outside: Outside::Refuse, minimum_segment_mm: 0.0, orientation_rad: 5e-5, orientation: crate::Orientation::Tip };
            let mut corrector = Corrector::new(&model, options);
            let block = block([3.0, -5.0, -120.0]);
            corrector.heed(&block, [0.0; 3]);
            let place = |angle: f64| {
                let (sin, cos) = units::math::sin_cos(angle);
                let mut place = Vector::from(middle);
                (place[u], place[v]) = (middle[u] + radius * cos, middle[v] + radius * sin);
                place
            };
            let shape = Shape::Arc(Arc { plane, centre_mm: [middle[u], middle[v]], sweep_rad: sweep });
            let whole = Curve::new(place(angle), place(angle + sweep), &shape);
            let (_, at_quarters_mm) = corrector.solved_arc(&corrector.machine(&block, [0.0; 3]), &whole).unwrap();
            let by_quarters = corrector.before_by_quarters_mm(&whole, at_quarters_mm);
            prop_assert!(by_quarters.is_some() || radius > 8.0);
            let state = corrector.state(&block, [0.0; 3]);
            // By the ends, and a bound for the whole.
            let by_ends = corrector.before_mm(&whole, &state, None);
            let bound = by_quarters.unwrap_or(f64::INFINITY).min(by_ends);
            for k in 0..=257 {
                let linear_mm = whole.at(f64::from(k) / 257.0);
                let error_mm = model.error_mm(&Command { linear_mm, ..state }).norm();
                prop_assert!(error_mm <= bound, "{} > {}", error_mm, bound);
            }
        }
    }
}
