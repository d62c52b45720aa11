//! How the axes moved when a row was read: each one's share of the feed, the way since it last turned, and how the path
//! curved.
//!
//! Rows of a run are taken as points of one path, in the order of their times where all have one, else as they stand. The
//! feed is the path's: on a circle, and on a diagonal of unequal sides, an axis runs at the share that the tangent has along
//! it. A path that ends where it began is taken to have been entered on itself.

use machine_model::Vector;

use crate::equations::observation::Measurements;

/// Steps below this are no motion, mm.
const STILL_MM: f64 = 1e-6;

/// Whether the end of a path is its beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Path {
    Open,
    Closed,
}

impl Measurements {
    /// Fills in the order, the shares and the ways of every row from its neighbours in the run.
    pub fn follow(&mut self) {
        let timed = self.rows.iter().all(|row| row.conditions.time_s.is_some());
        let mut runs: Vec<Vec<usize>> = vec![Vec::new(); self.runs.len()];
        for (index, row) in self.rows.iter().enumerate() {
            runs[row.run].push(index);
        }
        let longest = runs.iter().map(Vec::len).max().unwrap_or(1) as f64;
        let all = self.rows.len() as f64;
        for (nth, index) in runs.iter().flat_map(|run| run.iter().enumerate()) {
            self.rows[*index].order = [*index as f64 / all, nth as f64 / longest];
        }
        for mut run in runs {
            if timed {
                let time = |index: &usize| self.rows[*index].conditions.time_s.unwrap_or_default();
                run.sort_by(|a, b| time(a).total_cmp(&time(b)));
            }
            let at = |place: usize| self.rows[run[place]].command.linear_mm;
            let last = run.len() - 1;
            let steps: Vec<Vector> = (0..last).map(|place| at(place + 1) - at(place)).collect();
            let closed = last > 8 && (at(0) - at(last)).norm() < 2.0 * steps[0].norm();
            let path = if closed { Path::Closed } else { Path::Open };
            let tangents: Vec<Option<Vector>> = (0..=last)
                .map(|place| {
                    let round = at(0) - at(last);
                    let before = place.checked_sub(1).map(|p| steps[p]).or(closed.then_some(round));
                    let after = steps.get(place).copied().or(closed.then_some(round));
                    self.tangent(run[place], before, after)
                })
                .collect();
            let curvatures: Vec<Option<Vector>> = (0..=last)
                .map(|place| {
                    let round = (path == Path::Closed).then(|| at(0) - at(last));
                    let before = place.checked_sub(1).map(|p| steps[p]).or(round);
                    curvature(before?, steps.get(place).copied().or(round)?)
                })
                .collect();
            let ways: [Vec<Option<f64>>; 3] = [0, 1, 2].map(|axis| ways(axis, &tangents, &steps, path));
            for (place, index) in run.iter().enumerate() {
                let conditions = &mut self.rows[*index].conditions;
                conditions.share = tangents[place].map(|t| [t.x.abs(), t.y.abs(), t.z.abs()]);
                conditions.curvature_per_mm = curvatures[place].map(Into::into);
                conditions.since_turn_mm = [0, 1, 2].map(|axis| ways[axis][place]);
            }
        }
    }

    /// Unit vector along which a row was passed; `None` where its neighbours do not tell, or contradict its directions.
    fn tangent(&self, row: usize, before: Option<Vector>, after: Option<Vector>) -> Option<Vector> {
        let moves = |step: &Vector| step.norm() > STILL_MM;
        let (before, after) = (before.filter(moves), after.filter(moves));
        let way = match (before, after) {
            // Passed through; where it turned, what led to it counts.
            (Some(b), Some(a)) if a.dot(&b) > 0.0 => a.normalize() + b.normalize(),
            (Some(b), _) => b,
            (None, Some(a)) => a,
            (None, None) => return None,
        }
        .normalize();
        let stated = self.rows[row].command.direction;
        let agrees = (0..3).all(|a| match stated[a] {
            0 => true,
            d => way[a] * f64::from(d) > -0.02,
        });
        let still = stated == [0; 3] || (0..3).all(|a| stated[a] == 0 || way[a].abs() > 1e-9);
        (agrees && still).then_some(way)
    }
}

/// Curvature of a path between two steps, towards its centre, 1/mm; `None` where it turns a corner, or stands.
fn curvature(before: Vector, after: Vector) -> Option<Vector> {
    /// Cosine of the largest angle between two steps of a curve that is sampled finely enough: 20°.
    const SMOOTH: f64 = 0.94;
    /// Commands that are rounded turn a straight line by so much from step to step, rad.
    const ROUNDING: f64 = 1e-3;
    let way_mm = 0.5 * (before.norm() + after.norm());
    let (from, to) = (before.try_normalize(STILL_MM)?, after.try_normalize(STILL_MM)?);
    let turn = to - from;
    let bends = turn.norm() > ROUNDING;
    (from.dot(&to) > SMOOTH).then(|| if bends { turn / way_mm } else { Vector::zeros() })
}

/// Way since an axis last turned, mm, at every point of a path.
fn ways(axis: usize, tangents: &[Option<Vector>], steps: &[Vector], path: Path) -> Vec<Option<f64>> {
    let mut found = vec![None; tangents.len()];
    let mut way: Option<f64> = None;
    // Round a closed path twice: what the end knows, the beginning learns.
    for pass in 0..=usize::from(path == Path::Closed) {
        for place in 0..tangents.len() {
            let from = place.checked_sub(1).or((pass > 0).then_some(tangents.len() - 1));
            if let Some((from, before, now)) =
                from.and_then(|f| Some((f, tangents[f]?[axis], tangents[place]?[axis])))
            {
                let length = steps.get(from).or(steps.last()).map_or(0.0, Vector::norm);
                way = if before * now < 0.0 {
                    Some(length * now.abs() / (now.abs() + before.abs()))
                } else {
                    way.map(|w| w + length)
                };
            }
            found[place] = way;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_turns_four_times_in_a_circle_both_axes_counted() {
        let angle = |k: usize| 0.005 + f64::to_radians(k as f64);
        let tangents: Vec<Option<Vector>> = (0..360)
            .map(|k| Some(Vector::new(-units::math::sin(angle(k)), units::math::cos(angle(k)), 0.0)))
            .collect();
        let steps: Vec<Vector> = (0..359)
            .map(|k| {
                100.0
                    * Vector::new(
                        units::math::cos(angle(k + 1)) - units::math::cos(angle(k)),
                        units::math::sin(angle(k + 1)) - units::math::sin(angle(k)),
                        0.0,
                    )
            })
            .collect();
        let open = ways(0, &tangents, &steps, Path::Open);
        assert_eq!(open[100], None, "nobody knows where X turned before the run");
        let closed = ways(0, &tangents, &steps, Path::Closed);
        for k in [0, 3, 100, 181, 350] {
            let expected = 100.0 * (angle(k) % std::f64::consts::PI);
            assert!((closed[k].unwrap_or(-1.0) - expected).abs() < 0.3, "{k}: {:?} {expected}", closed[k]);
        }
        assert_eq!(ways(2, &tangents, &steps, Path::Closed)[10], None, "Z stands still");
    }

    #[test]
    fn a_circle_curves_towards_its_centre_and_a_corner_does_not() {
        let at = |degrees: f64| {
            let angle = degrees.to_radians();
            Vector::new(80.0 * units::math::cos(angle), 80.0 * units::math::sin(angle), 0.0)
        };
        let found = curvature(at(30.0) - at(28.0), at(33.0) - at(30.0)).unwrap();
        assert!((found + at(30.0) / 6400.0).norm() < 2e-4, "{found}");
        assert_eq!(curvature(Vector::x(), Vector::y()), None);
        assert_eq!(curvature(Vector::x(), 3.0 * Vector::x()), Some(Vector::zeros()));
        assert_eq!(curvature(Vector::x(), Vector::zeros()), None);
    }
}
