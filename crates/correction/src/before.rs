//! How far the tool would have been off without correction, for the summary.

use machine_model::{Command, Move};

use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::grid::Block;
use crate::short_line::with_its_error;

impl Corrector<'_> {
    /// Upper bound of the error at a place that takes a correction of so many mm: the error at its corrected command is that
    /// correction, and what it changes from one to the other is little. Infinite where the model says nothing of that.
    pub(crate) fn error_before_mm(&self, correction_mm: f64) -> f64 {
        match &self.everywhere {
            Some((_, _, Some(everywhere))) if !self.model.depends_on_direction() => {
                with_its_error(everywhere, correction_mm)
            }
            _ => f64::INFINITY,
        }
    }

    /// [`Self::before_mm`] of an arc.
    ///
    /// * `at_quarters_mm` – its largest correction at s = 0, ¼, ½, ¾, 1
    pub(crate) fn before_arc_mm(
        &self,
        whole: &Curve,
        block: &Block,
        rotary_deg: [f64; 3],
        correction_mm: f64,
        at_quarters_mm: f64,
    ) -> f64 {
        match self.before_by_quarters_mm(whole, at_quarters_mm) {
            Some(bound) if bound <= self.told_mm[0] => 0.0,
            Some(bound) => self.before_mm(whole, block, rotary_deg, correction_mm).min(bound),
            None => self.before_mm(whole, block, rotary_deg, correction_mm),
        }
    }

    /// Upper bound of the deviation that an arc would have had uncorrected, mm: a quarter of it leaves the chord of its ends' errors
    /// by less than the whole.
    fn before_by_quarters_mm(&self, whole: &Curve, at_quarters_mm: f64) -> Option<f64> {
        let everywhere = self.everywhere.as_ref()?.2.as_deref()?;
        // Of more than one turn a quarter may pass a place more than twice.
        if whole.turning_rad() > 7.0 || !whole.lies_inside(&everywhere.volume) {
            return None;
        }
        let (speed, acceleration) = whole.fastest(0.0, 0.25)?;
        Some(self.error_before_mm(at_quarters_mm) + everywhere.chord_bound_of_curve_mm(speed, acceleration))
    }

    /// Bound of the deviation that the program would have had uncorrected, mm; 0 where it cannot exceed that of an earlier
    /// motion.
    ///
    /// * `correction_mm` – the largest at its ends
    pub(crate) fn before_mm(
        &self,
        whole: &Curve,
        block: &Block,
        rotary_deg: [f64; 3],
        correction_mm: f64,
    ) -> f64 {
        let bow = self
            .everywhere
            .as_ref()
            .and_then(|known| known.2.as_deref())
            .filter(|everywhere| whole.lies_inside(&everywhere.volume))
            .map_or(f64::INFINITY, |everywhere| match whole.fastest(0.0, 1.0) {
                Some((speed, acceleration)) => everywhere.chord_bound_of_circle_mm(speed, acceleration),
                // A line.
                None => everywhere.chord_bound_of_four_passes_mm((whole.at(1.0) - whole.at(0.0)).amax()),
            });
        if self.error_before_mm(correction_mm) + bow <= self.told_mm[0] {
            return 0.0;
        }
        let state = self.state(block, rotary_deg);
        let error = |s: f64| self.model.error_mm(&Command { linear_mm: whole.at(s), ..state }).norm();
        let ends = error(0.0).max(error(1.0));
        if ends + bow <= self.told_mm[0] {
            return 0.0;
        }
        let extent = whole.extent(0.0, 1.0);
        let between = self.model.chord_bound_mm(&Move {
            range_mm: extent.range,
            speed_mm: extent.speed,
            acceleration_mm: extent.acceleration,
            passes: 4,
            state,
            turn: None,
        });
        if between.is_finite() { ends + between } else { ends }
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
            let options = Options { tolerance_mm: 0.001, outside: Outside::Refuse, minimum_segment_mm: 0.0, orientation_rad: 5e-5 };
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
            let bound = corrector.before_by_quarters_mm(&whole, at_quarters_mm).unwrap();
            let state = corrector.state(&block, [0.0; 3]);
            for k in 0..=257 {
                let linear_mm = whole.at(f64::from(k) / 257.0);
                let error_mm = model.error_mm(&Command { linear_mm, ..state }).norm();
                prop_assert!(error_mm <= bound, "{} > {}", error_mm, bound);
            }
            // What the summary is told does not depend on which of both bounds is asked first.
            let told = corrector.before_arc_mm(&whole, &block, [0.0; 3], at_quarters_mm, at_quarters_mm);
            prop_assert!(told <= bound);
        }
    }
}
