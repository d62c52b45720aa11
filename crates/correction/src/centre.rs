//! The words by which a control may be told an arc's centre.

use std::array::from_fn;
use std::f64::consts::TAU;

use machine_model::Vector;
use smallvec::SmallVec;
use toolpath::{Plane, Similarity};

use crate::Centre;
use crate::curve::{Curve, SAME_PLACE_MM};
use crate::grid::{Block, Goal};

/// Output steps below are finer than any arc has to be round, mm.
const FINE_STEP_MM: f64 = 0.000_9;
/// The radii of such an arc may differ by as much as two steps of 0.0001 inch make, mm.
const FINE_ROOM_MM: f64 = 0.005;
/// Where the corrected path is asked for: a centre is fitted to it there, and what misses it there is not tried.
pub(crate) const PLACES: [f64; 3] = [0.25, 0.5, 0.75];

/// A centre to try: the words and what the control makes of them.
pub(crate) struct Candidate {
    pub(crate) words: Centre,
    centre: [f64; 2],
    /// Difference of the radii at start and end, and how far the arc misses the corrected path, together, mm; nothing is better
    /// than the block's own words.
    cost_mm: f64,
}

impl Candidate {
    /// What the control makes of it; `None` where that is another arc altogether: the short way for the long one.
    pub(crate) fn arc(&self, search: &Search<'_>) -> Option<Curve> {
        let Curve::Arc { axes, sweep, .. } = *search.part else { return None };
        let mut curve = Curve::from_centre(search.from, search.to, axes, self.centre, sweep);
        let Curve::Arc { sweep: turned, .. } = &mut curve else { return None };
        if search.own_words && search.block.stated.turns {
            // The block's own P counts the whole turns before the last one; it never makes one of a
            // last turn that came out as nothing.
            *turned += sweep.signum() * whole_turns(sweep) * TAU;
        }
        // Where both rays all but meet, the last bit says whether that is a whole turn or none. The block's own words between
        // its own ends are what the program made of them.
        if is_kept(&self.words) && search.stays() && ((*turned - sweep).abs() - TAU).abs() < 1e-9 {
            *turned = sweep;
        }
        ((*turned - sweep).abs() < 0.5 * sweep.abs().min(1.0)).then_some(curve)
    }
}

/// How many whole turns an arc makes before its last one.
fn whole_turns(sweep: f64) -> f64 {
    ((sweep.abs() / TAU - 1e-9).ceil() - 1.0).max(0.0)
}

/// The block's own words serve.
fn is_kept(words: &Centre) -> bool {
    match words {
        Centre::Offsets(words) => words.iter().all(|word| !matches!(word, Goal::Steps(_))),
        Centre::Radius(word) => *word == Goal::AsStated,
    }
}

/// What the block's frame makes of the circle; `None` for what is no arc, or no circle in the program.
pub(crate) fn in_plane(part: &Curve, block: &Block) -> Option<Similarity> {
    let Curve::Arc { axes, .. } = *part else { return None };
    let plane = [Plane::Xy, Plane::Zx, Plane::Yz].into_iter().find(|plane| plane.axes() == axes)?;
    block.frame.similarity(plane)
}

/// What a centre is looked for.
pub(crate) struct Search<'a> {
    /// The programmed arc.
    pub(crate) part: &'a Curve,
    pub(crate) block: &'a Block,
    /// Where the axes stand.
    pub(crate) from: Vector,
    /// Where the arc's words lead.
    pub(crate) to: Vector,
    /// Commands that bring the tool to `part` at [`PLACES`].
    pub(crate) corrected: [Vector; 3],
    /// The block's own words may stay.
    pub(crate) own_words: bool,
    /// A circle that misses one of `corrected` by more is not tried, mm.
    pub(crate) farthest_mm: f64,
}

/// Centres to try.
pub(crate) struct Candidates(SmallVec<[Candidate; 10]>);

impl Candidates {
    /// The best of those that are left.
    ///
    /// The programmed words first, then by how well the two radii agree – a control that is strict about them alarms, one that
    /// is not makes a small step at the end of the arc – and how well the arc follows the path: along the bisector of the ends
    /// all radii agree.
    pub(crate) fn take_best(&mut self) -> Option<Candidate> {
        let by_cost =
            |(_, a): &(usize, &Candidate), (_, b): &(usize, &Candidate)| a.cost_mm.total_cmp(&b.cost_mm);
        let (best, _) = self.0.iter().enumerate().min_by(by_cost)?;
        Some(self.0.swap_remove(best))
    }
}

/// No rounding of the fitted centre that [`Search::by_offsets`] tries is further from it, output steps: one and a half in
/// each word.
const FARTHEST_STEPS: f64 = 3.1;

/// What lengths may be off by where they are taken for linear in a centre, mm: a hundredth of the finest output step.
const LINEAR_MM: f64 = 1e-5;

/// Arcs about centres near one: how far they miss the corrected commands, square to them and in their plane.
///
/// Between the ends the radius runs with the angle. Which angle is that of a corrected command matters by the radii's
/// difference times an angle of 1e-4.
#[derive(Default)]
struct Near {
    centre: [f64; 2],
    /// Radius at the end less radius at the start, mm, and by how much it grows as the centre moves, mm per mm.
    apart: f64,
    spread: [f64; 2],
    /// Of the arc about this centre less that of the commands, mm, and by how much it grows.
    missed: [f64; 3],
    change: [[f64; 2]; 3],
    /// Twice the inverse of the distance of the nearest place, 1/mm.
    bend: f64,
}

impl Near {
    /// The largest distance of a corrected command from the arc about a centre, and what the arc's radii differ by at its ends;
    /// both within [`LINEAR_MM`], mm. `None` for a centre that is not near enough for that.
    ///
    /// A distance `r` is `r - n·Δ` from a centre moved by `Δ`, and more by at most `|Δ|²/2(r - |Δ|)`, which is at most `|Δ|²/r` as
    /// long as `|Δ| ≤ r/2`; one is compared with two that weigh 1 together.
    fn missed_mm(&self, centre: [f64; 2]) -> Option<(f64, f64)> {
        let by = [centre[0] - self.centre[0], centre[1] - self.centre[1]];
        let moved_squared = by[0] * by[0] + by[1] * by[1];
        if !self.reaches(moved_squared) {
            return None;
        }
        let along = |change: &[f64; 2]| change[0] * by[0] + change[1] * by[1];
        let missed = (0..3).map(|k| (self.missed[k] + along(&self.change[k])).abs()).fold(0.0, f64::max);
        Some((missed, (self.apart + along(&self.spread)).abs()))
    }

    /// A lower bound of what [`Self::missed_mm`] says of any centre about which the radii differ by at most `apart_mm` at the
    /// ends, mm.
    ///
    /// For three vectors of a plane `a×b·c + b×c·a + c×a·b = 0`: with these weights the sum of three lengths that are linear in
    /// a centre is the same for all centres, and one of them is as large as that asks for.
    fn least_missed_mm(&self, apart_mm: f64) -> f64 {
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let ([first, middle, last], [a, b, c]) = (self.missed, self.change);
        let [of_first, of_middle, of_last] = [cross(b, c), cross(c, a), cross(a, b)];
        let sum = of_first * first + of_middle * middle + of_last * last;
        let by_three = sum.abs() / (of_first.abs() + of_middle.abs() + of_last.abs());
        let [of_first, of_last, of_apart] = [cross(c, self.spread), cross(self.spread, a), cross(a, c)];
        let sum = of_first * first + of_last * last + of_apart * self.apart;
        let by_radii = (sum.abs() - of_apart.abs() * apart_mm) / (of_first.abs() + of_last.abs());
        by_three.max(by_radii)
    }

    /// Centres of which this is the square of the distance, mm², are near enough for [`Self::missed_mm`].
    fn reaches(&self, moved_squared: f64) -> bool {
        moved_squared * self.bend <= LINEAR_MM && moved_squared * self.bend * self.bend <= 1.0
    }
}

fn length([u, v]: [f64; 2]) -> f64 {
    (u * u + v * v).sqrt()
}

impl Search<'_> {
    /// The arc has the ends that were programmed.
    fn stays(&self) -> bool {
        let near = |s: f64, place: Vector| (self.part.at(s) - place).norm() < SAME_PLACE_MM;
        near(0.0, self.from) && near(1.0, self.to)
    }

    /// The centres worth trying.
    pub(crate) fn candidates(&self) -> Candidates {
        let mut found = Candidates(SmallVec::new());
        let Curve::Arc { axes: [u, v, _], centre, .. } = *self.part else { return found };
        let block = &*self.block.of_centres();
        let has_centre = [u, v].map(|axis| block.stated.centre[axis]);
        let by_radius = !has_centre.contains(&true) && (block.stated.radius || !block.centre_words);
        let scale = in_plane(self.part, block).map_or(1.0, |map| map.scale);
        let step = scale * block.step_mm(u).max(block.step_mm(v));
        // Two rounded ends and a rounded centre differ by up to two steps in radius; the programmed
        // words may bring more of their own.
        let programmed = self.part.radii_apart_mm();
        let room = if step < FINE_STEP_MM { FINE_ROOM_MM } else { 2.0 * step };
        let allowed = (room + programmed).min((scale * block.arc_radius_tolerance_mm).max(programmed));
        let fitted = self.fitted();
        let near = self.near(fitted);
        let mut push = |words: Centre, centre: [f64; 2]| {
            let told = near.missed_mm(centre).or_else(|| self.near(centre).missed_mm(centre));
            if let Some((missed_mm, radii_apart)) = told
                && radii_apart <= allowed
                && missed_mm <= self.farthest_mm
                && (is_kept(&words) || !block.arcs_become_lines)
            {
                let cost_mm = if is_kept(&words) { f64::NEG_INFINITY } else { radii_apart + missed_mm };
                found.0.push(Candidate { words, centre, cost_mm });
            }
        };
        if self.own_words && !by_radius {
            let kept = has_centre.map(|has| if has { Goal::AsStated } else { Goal::Stays });
            // Relative centre words are measured from where the axes really stand.
            let start = self.part.at(0.0);
            let own = if block.arc_centres_absolute {
                centre
            } else {
                [centre[0] + self.from[u] - start[u], centre[1] + self.from[v] - start[v]]
            };
            push(Centre::Offsets(kept), own);
        }
        if by_radius {
            self.by_radius(fitted, scale, &mut push);
        }
        // An arc of half a turn on a machine out of square is an ellipse that no circle follows.
        let hopeless = near.reaches(FARTHEST_STEPS * FARTHEST_STEPS * step * step)
            && near.least_missed_mm(allowed) > self.farthest_mm + 2.0 * SAME_PLACE_MM;
        if block.centre_words && !hopeless {
            self.by_offsets(fitted, has_centre, &mut push);
        }
        found
    }

    /// What arcs about centres near one have to do with the corrected commands.
    fn near(&self, centre: [f64; 2]) -> Near {
        let Curve::Arc { axes: [u, v, _], .. } = *self.part else { return Near::default() };
        let [a, b, c] = &self.corrected;
        let ways = [&self.from, a, b, c, &self.to].map(|p| [p[u] - centre[0], p[v] - centre[1]]);
        let radii = ways.map(length);
        let units: [[f64; 2]; 5] = from_fn(|k| {
            let inverse = 1.0 / radii[k];
            ways[k].map(|component| component * inverse)
        });
        let [first, .., last] = units;
        let spread = from_fn(|i| first[i] - last[i]);
        Near {
            centre,
            apart: radii[4] - radii[0],
            spread,
            missed: from_fn(|k| radii[0] + (radii[4] - radii[0]) * PLACES[k] - radii[k + 1]),
            change: from_fn(|k| from_fn(|i| units[k + 1][i] - first[i] + spread[i] * PLACES[k])),
            bend: 2.0 / radii.into_iter().fold(f64::INFINITY, f64::min),
        }
    }

    /// Rounded centres around the fitted one, as words of the plane.
    fn by_offsets(&self, fitted: [f64; 2], has_centre: [bool; 2], push: &mut impl FnMut(Centre, [f64; 2])) {
        let Curve::Arc { axes: [u, v, _], .. } = *self.part else { return };
        let block = &*self.block.of_centres();
        let mut centre = self.from;
        (centre[u], centre[v]) = (fitted[0], fitted[1]);
        let (centre_program, from_program) = (block.program(&centre), block.program(&self.from));
        let origin = |axis: usize| if block.arc_centres_absolute { 0.0 } else { from_program[axis] };
        let counts = [u, v].map(|axis| block.to_counts(axis, centre_program[axis] - origin(axis)));
        let mut nearest = from_program;
        nearest[u] = origin(u) + block.from_counts(u, counts[0]);
        nearest[v] = origin(v) + block.from_counts(v, counts[1]);
        let nearest = block.machine(nearest);
        // What a step of either word moves the centre by.
        let step = |axis: usize| [u, v].map(|of| block.frame.matrix()[of][axis] * block.step_mm(axis));
        let steps = [step(u), step(v)];
        for du in [0, -1, 1] {
            for dv in [0, -1, 1] {
                let chosen = [counts[0] + du, counts[1] + dv];
                if chosen == [0, 0] && !block.arc_centres_absolute {
                    // An arc about its own start.
                    continue;
                }
                let words = [0, 1].map(|i| {
                    // A missing centre word is zero in every dialect, but two missing ones are no arc.
                    let needless =
                        chosen[i] == 0 && !has_centre[i] && !block.arc_centres_absolute && chosen[1 - i] != 0;
                    if needless { Goal::Stays } else { Goal::Steps(chosen[i]) }
                });
                let centre =
                    [0, 1].map(|i| nearest[[u, v][i]] + steps[0][i] * du as f64 + steps[1][i] * dv as f64);
                push(Centre::Offsets(words), centre);
            }
        }
    }

    /// R words around the fitted radius; `scale`: of the frame.
    fn by_radius(&self, fitted: [f64; 2], scale: f64, push: &mut impl FnMut(Centre, [f64; 2])) {
        let Curve::Arc { axes: [u, v, _], sweep, radius, .. } = *self.part else { return };
        let Self { from, to, .. } = self;
        let block = &*self.block.of_centres();
        // Near a half turn the centre runs away with the last digit of R, near a full one R says nothing.
        let chord = [to[u] - from[u], to[v] - from[v]];
        let length = length(chord);
        if length < SAME_PLACE_MM {
            return;
        }
        let major = sweep.abs() - whole_turns(sweep) * TAU > TAU / 2.0;
        let centre_of = |radius: f64| {
            // Half a turn: the programmed radius and half the chord are the same number but for its last bits.
            let height2 = radius * radius - 0.25 * length * length;
            let height2 = if height2.abs() < 1e-9 * radius * radius { 0.0 } else { height2 };
            if height2 < 0.0 {
                return None;
            }
            // Left of the chord for a counter-clockwise minor arc.
            let side = if (sweep > 0.0) == major { -1.0 } else { 1.0 };
            let k = side * height2.sqrt() / length;
            Some([0.5 * (from[u] + to[u]) - chord[1] * k, 0.5 * (from[v] + to[v]) + chord[0] * k])
        };
        let (ru, rv) = (from[u] - fitted[0], from[v] - fitted[1]);
        let counts = block.to_counts(u, (ru * ru + rv * rv).sqrt() / scale);
        if self.own_words
            && block.stated.radius
            && let Some(centre) = centre_of(radius[0])
        {
            push(Centre::Radius(Goal::AsStated), centre);
        }
        for d in [0, 1, -1] {
            if let Some(centre) = centre_of(block.from_counts(u, counts + d) * scale) {
                let signed = if major { -(counts + d) } else { counts + d };
                push(Centre::Radius(Goal::Steps(signed)), centre);
            }
        }
    }

    /// The centre of the circle through both ends that is nearest to the corrected path between them.
    ///
    /// With `|q - C|² = |A - C|²` linear in C: least squares over three places in between, along the
    /// bisector of the ends, or in both directions where the ends nearly coincide.
    fn fitted(&self) -> [f64; 2] {
        let Curve::Arc { axes: [u, v, _], sweep, centre, .. } = *self.part else { return [0.0; 2] };
        let Self { from, to, .. } = self;
        let places = self.corrected.map(|q| [q[u] - from[u], q[v] - from[v]]);
        let end = [to[u] - from[u], to[v] - from[v]];
        // Relative to the start: 2 C·q = |q|².
        if sweep.abs() < 0.9 * TAU {
            let length2 = end[0] * end[0] + end[1] * end[1];
            let normal = [-end[1], end[0]];
            let (mut above, mut below) = (0.0, 0.0);
            for q in &places {
                // C = end/2 + λ·normal.
                let weight = 2.0 * (q[0] * normal[0] + q[1] * normal[1]);
                let rest = q[0] * q[0] + q[1] * q[1] - (q[0] * end[0] + q[1] * end[1]);
                above += weight * rest;
                below += weight * weight;
            }
            if below <= 0.0 || length2 <= 0.0 {
                return centre;
            }
            let lambda = above / below;
            return [
                from[u] + 0.5 * end[0] + lambda * normal[0],
                from[v] + 0.5 * end[1] + lambda * normal[1],
            ];
        }
        let (mut a, mut b, mut d, mut p, mut r) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for q in places.iter().chain([&end]) {
            let square = 0.5 * (q[0] * q[0] + q[1] * q[1]);
            a += q[0] * q[0];
            b += q[0] * q[1];
            d += q[1] * q[1];
            p += q[0] * square;
            r += q[1] * square;
        }
        let determinant = a * d - b * b;
        if determinant <= 0.0 {
            return centre;
        }
        [from[u] + (d * p - b * r) / determinant, from[v] + (a * r - b * p) / determinant]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use units::math::sin_cos;

    use super::*;
    use crate::testing::block;

    /// On a machine out of square half a turn becomes half an ellipse: no centre serves, and none is tried.
    #[test]
    fn no_centre_is_tried_for_half_an_ellipse() {
        let place = |angle: f64, shear: f64| {
            let (sin, cos) = sin_cos(angle);
            Vector::new(10.0 * cos + shear * 10.0 * sin, 10.0 * sin, 0.0)
        };
        for (start, shear, tried) in
            [(0.0, 1e-3, false), (0.8, 2e-3, false), (0.0, 1e-5, true), (0.8, 1e-5, true)]
        {
            let at = |s: f64| place(start + s * TAU / 2.0, shear);
            let part = Curve::Arc {
                axes: Plane::Xy.axes(),
                centre: [0.0; 2],
                angle: start,
                sweep: TAU / 2.0,
                radius: [10.0; 2],
                ends: [place(start, 0.0), place(start + TAU / 2.0, 0.0)],
            };
            let block = block([0.0; 3]);
            let search = Search {
                part: &part,
                block: &block,
                from: at(0.0),
                to: at(1.0),
                corrected: PLACES.map(at),
                own_words: false,
                farthest_mm: 0.0018,
            };
            let least = search.near(search.fitted()).least_missed_mm(0.002);
            assert_eq!(least <= search.farthest_mm, tried, "{start} {shear}: {least}");
            assert_eq!(!search.candidates().0.is_empty(), tried, "{start} {shear}");
        }
    }

    proptest! {
        #[test]
        fn what_an_arc_misses_near_a_centre(
            radius in 0.05f64..300.0, angle in -4.0f64..4.0, sweep in 0.05f64..6.2,
            off in prop::array::uniform5(-0.005f64..0.005), by in prop::array::uniform2(-0.01f64..0.01),
        ) {
            let place = |k: usize| {
                let (sin, cos) = sin_cos(angle + 0.25 * k as f64 * sweep);
                let r = radius + off[k];
                Vector::new(20.0 + r * cos, -30.0 + r * sin, 0.0)
            };
            let part = Curve::Arc {
                axes: Plane::Xy.axes(), centre: [20.0, -30.0], angle, sweep, radius: [radius; 2],
                ends: [place(0), place(4)],
            };
            let corrected = [place(1), place(2), place(3)];
            let block = block([0.0; 3]);
            let search = Search {
                part: &part, block: &block, from: place(0), to: place(4), corrected, own_words: false, farthest_mm: 1.0,
            };
            let centre = [20.0 + by[0], -30.0 + by[1]];
            let r = |k: usize| length([place(k).x - centre[0], place(k).y - centre[1]]);
            let missed = (1..4).map(|k| (r(0) + (r(4) - r(0)) * 0.25 * k as f64 - r(k)).abs()).fold(0.0, f64::max);
            let (own, apart) = search.near(centre).missed_mm(centre).unwrap();
            prop_assert!((own - missed).abs() < 1e-12 && (apart - (r(4) - r(0)).abs()).abs() < 1e-12);
            let given = search.near([20.0, -30.0]);
            match given.missed_mm(centre) {
                Some((near, near_apart)) => {
                    prop_assert!(given.least_missed_mm(near_apart) <= near + SAME_PLACE_MM);
                    prop_assert!((near - missed).abs() <= LINEAR_MM && (near_apart - apart).abs() <= LINEAR_MM);
                }
                None => prop_assert!(length(by) > 1e-3 * radius.sqrt()),
            }
        }
    }
}
