//! Following an arc with arcs, or with lines where no arc serves.

use std::array::from_fn;
use std::f64::consts::TAU;

use machine_model::{LANES, Vector};
use toolpath::{Plane, Similarity};

use crate::corrector::{CorrectionError, Corrector, Follow};
use crate::curve::Curve;
use crate::deviation::{Pair, Verdict};
use crate::grid::{AxisWord, Block};
use crate::play::Tried;
use crate::{Centre, Piece, PieceKind};

/// Below this chord, in output steps, rounding decides where an arc's centre lies: lines serve better.
const SHORTEST_CHORD_STEPS: f64 = 30.0;
/// Two ends nearer than this are one place: far below every output step, far above rounding of `f64`.
const SAME_PLACE_MM: f64 = 1e-9;

/// Ends nearer than this after more than half a turn are not left to the control to tell apart.
const NEARLY_MEETING_MM: f64 = 0.1;

/// Where the corrected path is asked for: a centre is fitted to it there, and what misses it there is not tried.
const PLACES: [f64; 3] = [0.25, 0.5, 0.75];

/// More than all rounding in comparing with the limit, mm: the model's answers are within 1e-10.
const ROUNDING_MM: f64 = 1e-8;

/// A centre to try: the words and what the control makes of them.
struct Candidate {
    words: Centre,
    centre: [f64; 2],
    /// Difference of the radii at start and end, mm.
    radii_apart: f64,
}

impl Candidate {
    /// What the control makes of it; `None` where that is another arc altogether: the short way for the long one.
    fn arc(&self, follow: &Follow<'_, '_>, part: &Curve, from: Vector, to: Vector) -> Option<Curve> {
        let Curve::Arc { axes, sweep, .. } = *part else { return None };
        let mut curve = Curve::from_centre(from, to, axes, self.centre, sweep < 0.0);
        let Curve::Arc { sweep: turned, .. } = &mut curve else { return None };
        if follow.alone && follow.block.letters.contains(b'P') {
            // The block's own P counts the whole turns before the last one; it never makes one of a
            // last turn that came out as nothing.
            *turned += sweep.signum() * ((sweep.abs() / TAU - 1e-9).ceil() - 1.0).max(0.0) * TAU;
        }
        ((*turned - sweep).abs() < 0.5 * sweep.abs().min(1.0)).then_some(curve)
    }

    /// The block's own words serve.
    fn is_kept(&self) -> bool {
        match self.words {
            Centre::Offsets(words) => words.iter().all(|word| !matches!(word, AxisWord::Write(_))),
            Centre::Radius(word) => word == AxisWord::Keep,
        }
    }
}

/// What the block's frame makes of the circle; `None` for what is no arc, or no circle in the program.
fn in_plane(part: &Curve, block: &Block) -> Option<Similarity> {
    let Curve::Arc { axes, .. } = *part else { return None };
    let plane = [Plane::Xy, Plane::Zx, Plane::Yz].into_iter().find(|plane| plane.axes() == axes)?;
    block.frame.similarity(plane)
}

impl<'m> Corrector<'m> {
    /// Commands arcs from where the axes stand to the end of `part`, as few as hold the tolerance.
    pub(crate) fn follow_arc(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
    ) -> Result<(), CorrectionError> {
        let Curve::Arc { axes: [u, v, _], .. } = *part else { return self.follow_line(follow, part) };
        let Tried::Beyond { distance_mm, s } = self.with_play(follow, part, Self::one_arc)? else {
            return Ok(());
        };
        if !follow.may_split {
            return Err(CorrectionError::MustNotSplit { distance_um: distance_mm * 1e3 });
        }
        follow.alone = false;
        let step = follow.block.step_mm(u).max(follow.block.step_mm(v));
        if part.length_mm() < SHORTEST_CHORD_STEPS * step
            || part.length_mm() < 2.0 * self.options.minimum_segment_mm
        {
            return self.follow_line(follow, part);
        }
        self.follow_arc(follow, &part.part(0.0, s))?;
        self.follow_arc(follow, &part.part(s, 1.0))
    }

    /// Tries one arc to the end of `part`; the axes stand where they stood unless it is done.
    fn one_arc(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
        hold: [bool; 3],
    ) -> Result<Tried, CorrectionError> {
        let Curve::Arc { axes: [u, v, _], sweep, .. } = *part else {
            return Ok(Tried::Beyond { distance_mm: f64::INFINITY, s: 0.5 });
        };
        // A mirrored frame turns the other way in the program.
        let clockwise = (sweep < 0.0) != in_plane(part, follow.block).is_some_and(|map| map.mirrored);
        let nominal_end = part.at(1.0);
        let solved = solved_together(follow, part);
        let wanted = match solved {
            Some([.., end]) => end,
            None => self.solve(&follow.machine, nominal_end)?,
        };
        let before = self.standing;
        let from: Vector = before.map(|x| x.unwrap_or(f64::NAN)).into();
        let own_end = follow.own_end(part, &from);
        let axes = self.go_holding(follow.block, &own_end, &wanted, follow.alone, hold);
        let direction = follow.machine.state.direction;
        if let Some(against) = self.against(before, self.standing, follow.came, direction, follow.block) {
            self.standing = before;
            return Ok(Tried::Against(against));
        }
        let mut to: Vector = self.standing.map(|x| x.unwrap_or(f64::NAN)).into();
        let full = sweep.abs() > TAU - 1e-6;
        if full && (to[u] - from[u]).abs() < SAME_PLACE_MM && (to[v] - from[v]).abs() < SAME_PLACE_MM {
            // Through frame and back a place can change its last bit; it is the same place.
            (to[u], to[v]) = (from[u], from[v]);
        }
        if !may_be_one_arc(part, from, to) {
            self.standing = before;
            return Ok(Tried::Beyond { distance_mm: f64::INFINITY, s: 0.5 });
        }
        let mut nearest = f64::INFINITY;
        let limit_mm = self.limit_mm(follow.block);
        let (corrected, sieve) = match solved {
            Some([a, b, c, _]) => ([a, b, c], Sieve::new(part, &[a, b, c], follow, limit_mm)),
            None => (self.solved_one_by_one(follow, part)?, None),
        };
        for candidate in self.candidates(follow, part, from, to, &corrected) {
            if sieve.as_ref().is_some_and(|sieve| sieve.refutes(&candidate, part, from, to)) {
                continue;
            }
            let Some(curve) = candidate.arc(follow, part, from, to) else { continue };
            let pair = Pair { wanted: part, commanded: &curve, in_step: follow.in_step };
            match pair.verdict(&follow.machine, limit_mm) {
                Verdict::Within(bound) => {
                    let kind = PieceKind::Arc { clockwise, centre: candidate.words };
                    let piece = Piece { kind, axes, share: follow.share(part) };
                    follow.finish(piece, bound, (wanted - nominal_end).norm());
                    follow.came = direction;
                    self.note_end(&follow.machine, nominal_end, wanted);
                    return Ok(Tried::Done);
                }
                Verdict::Beyond { distance_mm, .. } => nearest = nearest.min(distance_mm),
            }
        }
        self.standing = before;
        Ok(Tried::Beyond { distance_mm: nearest, s: 0.5 })
    }

    /// The centres worth trying, best first.
    fn candidates(
        &self,
        follow: &Follow<'_, '_>,
        part: &Curve,
        from: Vector,
        to: Vector,
        corrected: &[Vector; 3],
    ) -> Vec<Candidate> {
        let Curve::Arc { axes, centre, sweep, radius, .. } = *part else { return Vec::new() };
        let [u, v, _] = axes;
        let block = follow.block;
        let letters = [u, v].map(|axis| b"IJK"[axis]);
        let has_centre = letters.map(|letter| block.letters.contains(letter));
        let by_radius = if has_centre.contains(&true) {
            false
        } else {
            block.letters.contains(b'R') || !block.centre_words
        };
        let scale = in_plane(part, block).map_or(1.0, |map| map.scale);
        let step = scale * block.step_mm(u).max(block.step_mm(v));
        // Two rounded ends and a rounded centre differ by up to two steps in radius; the programmed
        // words may bring more of their own.
        let allowed = (2.0 * step + (radius[1] - radius[0]).abs())
            .min((scale * block.arc_radius_tolerance_mm).max(2.0 * step));
        let mut found = Vec::new();
        let mut push = |words: Centre, at: [f64; 2]| {
            let length = |p: &Vector| {
                let (pu, pv) = (p[u] - at[0], p[v] - at[1]);
                (pu * pu + pv * pv).sqrt()
            };
            let radii_apart = (length(&to) - length(&from)).abs();
            if radii_apart <= allowed {
                found.push(Candidate { words, centre: at, radii_apart });
            }
        };
        if follow.alone && !by_radius {
            let kept = has_centre.map(|has| if has { AxisWord::Keep } else { AxisWord::Omit });
            // Relative centre words are measured from where the axes really stand.
            let start = part.at(0.0);
            let own = if block.arc_centres_absolute {
                centre
            } else {
                [centre[0] + from[u] - start[u], centre[1] + from[v] - start[v]]
            };
            push(Centre::Offsets(kept), own);
        }
        let fitted = fit_centre(part, from, to, corrected);
        if by_radius {
            let own = (radius[0], follow.alone && block.letters.contains(b'R'), scale);
            self.radius_candidates(block, axes, from, to, sweep, fitted, own, &mut push);
        }
        if block.centre_words {
            self.offset_candidates(block, axes, from, fitted, has_centre, &mut push);
        }
        // The programmed words first, then by how well the two radii agree: a control that is strict
        // about them alarms, one that is not makes a small step at the end of the arc.
        found.sort_by(|a, b| b.is_kept().cmp(&a.is_kept()).then(a.radii_apart.total_cmp(&b.radii_apart)));
        found
    }

    /// Rounded centres around the fitted one, as words of the plane.
    fn offset_candidates(
        &self,
        block: &Block,
        [u, v, _]: [usize; 3],
        from: Vector,
        fitted: [f64; 2],
        has_centre: [bool; 2],
        push: &mut impl FnMut(Centre, [f64; 2]),
    ) {
        let mut centre = from;
        (centre[u], centre[v]) = (fitted[0], fitted[1]);
        let (centre_program, from_program) = (block.program(&centre), block.program(&from));
        let origin = |axis: usize| if block.arc_centres_absolute { 0.0 } else { from_program[axis] };
        let counts = [u, v].map(|axis| block.to_counts(axis, centre_program[axis] - origin(axis)));
        for du in [0, -1, 1] {
            for dv in [0, -1, 1] {
                let chosen = [counts[0] + du, counts[1] + dv];
                if chosen == [0, 0] && !block.arc_centres_absolute {
                    // An arc about its own start.
                    continue;
                }
                let mut at = from_program;
                at[u] = origin(u) + block.from_counts(u, chosen[0]);
                at[v] = origin(v) + block.from_counts(v, chosen[1]);
                let machine = block.machine(at);
                let words = [0, 1].map(|i| {
                    // A missing centre word is zero in every dialect, but two missing ones are no arc.
                    let needless =
                        chosen[i] == 0 && !has_centre[i] && !block.arc_centres_absolute && chosen[1 - i] != 0;
                    if needless { AxisWord::Omit } else { AxisWord::Write(chosen[i]) }
                });
                push(Centre::Offsets(words), [machine[u], machine[v]]);
            }
        }
    }

    /// R words around the fitted radius.
    #[expect(
        clippy::too_many_arguments,
        reason = "one arc's geometry; a struct would be made for this call alone"
    )]
    fn radius_candidates(
        &self,
        block: &Block,
        [u, v, _]: [usize; 3],
        from: Vector,
        to: Vector,
        sweep: f64,
        fitted: [f64; 2],
        (own_radius, may_keep, scale): (f64, bool, f64),
        push: &mut impl FnMut(Centre, [f64; 2]),
    ) {
        // Near a half turn the centre runs away with the last digit of R, near a full one R says nothing.
        let chord = [to[u] - from[u], to[v] - from[v]];
        let length = (chord[0] * chord[0] + chord[1] * chord[1]).sqrt();
        if length < SAME_PLACE_MM {
            return;
        }
        let major = sweep.abs() > TAU / 2.0;
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
        if may_keep && let Some(centre) = centre_of(own_radius) {
            push(Centre::Radius(AxisWord::Keep), centre);
        }
        for d in [0, 1, -1] {
            if let Some(centre) = centre_of(block.from_counts(u, counts + d) * scale) {
                let signed = if major { -(counts + d) } else { counts + d };
                push(Centre::Radius(AxisWord::Write(signed)), centre);
            }
        }
    }

    /// Commands that bring the tool to the programmed path at [`PLACES`].
    fn solved_one_by_one(
        &self,
        follow: &Follow<'_, '_>,
        part: &Curve,
    ) -> Result<[Vector; 3], CorrectionError> {
        let [a, b, c] = PLACES.map(|s| self.solve(&follow.machine, part.at(s)));
        Ok([a?, b?, c?])
    }
}

/// The same, and to its end, all at once; `None` where the model has to be asked for each.
fn solved_together(follow: &Follow<'_, '_>, part: &Curve) -> Option<[Vector; LANES]> {
    let machine = &follow.machine;
    let everywhere = machine.everywhere.as_ref()?;
    let [a, b, c] = PLACES;
    let targets = [a, b, c, 1.0].map(|s| part.at(s).into());
    let directions = [machine.state.direction; LANES];
    let [x, y, z] = machine.model.commands_for(&targets, &directions, &machine.state, everywhere)?;
    Some(from_fn(|k| Vector::new(x[k], y[k], z[k])))
}

/// False for ends that no control may be left to make an arc of.
fn may_be_one_arc(part: &Curve, from: Vector, to: Vector) -> bool {
    let Curve::Arc { axes: [u, v, _], sweep, .. } = *part else { return false };
    let full = from[u] == to[u] && from[v] == to[v];
    if full && sweep.abs() < 1.0 {
        return false;
    }
    // All but a full turn: where the ends all but meet, the last digit decides between the whole circle
    // and nothing, and controls have their own idea of what still counts as meeting.
    let gap = Vector::new(to[u] - from[u], to[v] - from[v], 0.0).norm();
    let moved = (part.at(0.0) - from - (part.at(1.0) - to)).norm() > SAME_PLACE_MM;
    full || !moved || sweep.abs() <= TAU / 2.0 || gap >= NEARLY_MEETING_MM
}

/// What shows at [`PLACES`] that an arc is too far from the path, without the model being asked.
///
/// With `q` the corrected command of a place `r` of the path, `q + e(q) = r`, a command `c` is off by
/// `c - r + e(c) = (c - q) + (e(c) - e(q))`, and the second difference is at most `gradient·|c - q|`. What is refuted here
/// is what the proof would have refuted.
struct Sieve {
    /// Corrected command and the path's direction.
    places: [(Vector, Vector); 3],
    gradient: f64,
    limit_mm: f64,
}

impl Sieve {
    /// `None` where the model says nothing of its gradient, and where the distance of what is refuted will be told.
    fn new(part: &Curve, corrected: &[Vector; 3], follow: &Follow<'_, '_>, limit_mm: f64) -> Option<Self> {
        let everywhere = follow.machine.everywhere.as_ref().filter(|_| follow.may_split)?;
        let tangent = |s: f64| if follow.in_step { Vector::zeros() } else { part.tangent(s) };
        let places = from_fn(|k| (corrected[k], tangent(PLACES[k])));
        Some(Self { places, gradient: everywhere.gradient, limit_mm })
    }

    /// Without an angle: unit vectors from the centre, halved twice. What [`Candidate::arc`] would not take for this arc need
    /// not be told from it.
    fn refutes(&self, candidate: &Candidate, part: &Curve, from: Vector, to: Vector) -> bool {
        let Curve::Arc { axes: [u, v, n], sweep, .. } = *part else { return false };
        if sweep.abs() > TAU + 1e-6 {
            return false;
        }
        let [cu, cv] = candidate.centre;
        let (start, end) = ([from[u] - cu, from[v] - cv], [to[u] - cu, to[v] - cv]);
        let radii = [length(start), length(end)];
        let (start, end) = (unit(start), unit(end));
        let middle = half_way(start, end, sweep);
        let is_off = |k: usize, way: [f64; 2]| {
            let at = |ends: [f64; 2]| ends[0] + (ends[1] - ends[0]) * PLACES[k];
            let mut command = Vector::zeros();
            (command[u], command[v]) = (cu + at(radii) * way[0], cv + at(radii) * way[1]);
            command[n] = at([from[n], to[n]]);
            self.is_off(k, &command)
        };
        is_off(0, half_way(start, middle, 0.5 * sweep))
            || is_off(2, half_way(middle, end, 0.5 * sweep))
            || is_off(1, middle)
    }

    /// True where a command at one of [`PLACES`] is too far from the path.
    fn is_off(&self, k: usize, command: &Vector) -> bool {
        let (corrected, tangent) = self.places[k];
        let off = command - corrected;
        let square = (off - tangent * off.dot(&tangent)).norm();
        square - self.gradient * off.norm() > self.limit_mm + ROUNDING_MM
    }
}

fn length([u, v]: [f64; 2]) -> f64 {
    (u * u + v * v).sqrt()
}

fn unit(of: [f64; 2]) -> [f64; 2] {
    let length = length(of);
    of.map(|component| component / length)
}

/// The unit vector half way of a turn from one to another, which is at most a whole one.
fn half_way(from: [f64; 2], to: [f64; 2], turn_rad: f64) -> [f64; 2] {
    // It lies along their sum, and square to their difference: the longer of both says it well.
    let (sum, apart) = ([from[0] + to[0], from[1] + to[1]], [from[0] - to[0], from[1] - to[1]]);
    if turn_rad.abs() < 0.25 * TAU {
        unit(sum)
    } else if turn_rad.abs() > 0.75 * TAU {
        unit(sum).map(|component| -component)
    } else {
        unit([-apart[1] * turn_rad.signum(), apart[0] * turn_rad.signum()])
    }
}

/// The centre of the circle through both ends that is nearest to the corrected path between them.
///
/// With `|q - C|² = |A - C|²` linear in C: least squares over three places in between, along the
/// bisector of the ends, or in both directions where the ends nearly coincide.
fn fit_centre(part: &Curve, from: Vector, to: Vector, corrected: &[Vector; 3]) -> [f64; 2] {
    let Curve::Arc { axes: [u, v, _], sweep, centre, .. } = *part else { return [0.0; 2] };
    let places = corrected.map(|q| [q[u] - from[u], q[v] - from[v]]);
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
        return [from[u] + 0.5 * end[0] + lambda * normal[0], from[v] + 0.5 * end[1] + lambda * normal[1]];
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use units::math::sin_cos;

    use super::*;

    proptest! {
        #[test]
        fn half_way_is_half_the_angle(angle in -7.0f64..7.0, turn in prop_oneof![-TAU..TAU, Just(TAU), Just(-TAU), -1e-6f64..1e-6]) {
            let way = |angle: f64| { let (sin, cos) = sin_cos(angle); [cos, sin] };
            let (found, expected) = (half_way(way(angle), way(angle + turn), turn), way(angle + 0.5 * turn));
            prop_assert!(length([found[0] - expected[0], found[1] - expected[1]]) < 1e-14);
        }
    }
}
