//! Following an arc with arcs, or with lines where no arc serves.

use std::f64::consts::TAU;

use machine_model::Vector;
use toolpath::Division;

use crate::by_commands::{Enclosed, Solved};
use crate::centre::{PLACES, Search, in_plane};
use crate::corrector::Corrector;
use crate::curve::{Curve, SAME_PLACE_MM};
use crate::deviation::{Machine, Pair, Verdict};
use crate::error::CorrectionError;
use crate::follow::Follow;
use crate::play::{Creep, Tried};
use crate::{Goal, Piece, PieceKind};

/// Below this chord, in output steps, rounding decides where an arc's centre lies: lines serve better.
const SHORTEST_CHORD_STEPS: f64 = 30.0;

/// Ends nearer than this after more than half a turn are not left to the control to tell apart.
const NEARLY_MEETING_MM: f64 = 0.1;

/// A circle this much beyond the limit from a corrected command is not put to the proof, mm: between the two the error changes
/// by the gradient of a few micrometres, and the distance is known within 1e-5.
const BEYOND_DOUBT_MM: f64 = 2e-5;

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
        self.require_named(follow, part, self.limit_mm(follow.block))?;
        if !follow.may_split || follow.least_share(part) > 0.5 {
            return Err(self.not_to_be_split(follow, distance_mm));
        }
        follow.alone = false;
        if follow.block.arcs_become_lines && !follow.whole.division.is_offset() {
            return self.follow_line(follow, part);
        }
        let step = follow.block.step_mm(u).max(follow.block.step_mm(v));
        if part.length_mm() < SHORTEST_CHORD_STEPS * step
            || part.length_mm() < 2.0 * self.options.minimum_segment_mm
        {
            if follow.whole.division.is_offset() {
                return Err(self.not_to_be_split(follow, distance_mm));
            }
            return self.follow_line(follow, part);
        }
        let halves = part.split(s);
        let solved = solved_halves(follow, part, s);
        if let [Some(first), Some(second)] = &solved {
            follow.enclosed = Enclosed::of(&follow.machine, &halves, [first, second]);
        }
        for (half, solved) in halves.iter().zip(solved) {
            follow.solved = solved;
            self.follow_arc(follow, half)?;
        }
        Ok(())
    }

    /// Tries one arc to the end of `part`; the axes stand where they stood unless it is done.
    fn one_arc(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
        creep: Creep,
    ) -> Result<Tried, CorrectionError> {
        let Curve::Arc { axes: [u, v, _], sweep, .. } = *part else {
            return Ok(Tried::Beyond { distance_mm: f64::INFINITY, s: 0.5 });
        };
        // A mirrored frame turns the other way in the program.
        let clockwise = (sweep < 0.0) != in_plane(part, follow.block).is_some_and(|map| map.mirrored);
        let nominal_end = part.at(1.0);
        let direction = follow.machine.state.direction;
        if follow.solved.is_none_or(|solved| solved.direction != direction) {
            follow.solved = self.solved_arc(&follow.machine, part).map(|(solved, _)| solved);
        }
        let wanted = match &follow.solved {
            Some(solved) => solved.end(),
            None => self.solve(&follow.machine.state, nominal_end)?,
        };
        let before = self.standing;
        let from: Vector = before.map(|x| x.unwrap_or(f64::NAN)).into();
        let own_end = follow.own_end(part, &from);
        let axes = self.go(follow.block, &own_end, &wanted, &follow.freedom(part, creep.held()));
        if !matches!(creep, Creep::Counted)
            && let Some(against) = self.against(&follow.machine.state, before, self.standing, follow.block)
        {
            self.standing = before;
            return Ok(Tried::Against(against));
        }
        let mut to: Vector = self.standing.map(|x| x.unwrap_or(f64::NAN)).into();
        let full = sweep.abs() > TAU - 1e-6;
        if full && (to[u] - from[u]).abs() < SAME_PLACE_MM && (to[v] - from[v]).abs() < SAME_PLACE_MM {
            // Through frame and back a place can change its last bit; it is the same place.
            (to[u], to[v]) = (from[u], from[v]);
        }
        let moved = axes.iter().any(|word| matches!(word, Goal::Steps(_)));
        if !may_be_one_arc(part, from, to) || (follow.block.arcs_become_lines && moved) {
            self.standing = before;
            return Ok(Tried::Beyond { distance_mm: f64::INFINITY, s: 0.5 });
        }
        let mut nearest = f64::INFINITY;
        let limit_mm = self.limit_mm(follow.block);
        let corrected = match &follow.solved {
            Some(solved) => solved.between(),
            None => {
                let [a, b, c] = PLACES.map(|s| self.solve(&follow.machine.state, part.at(s)));
                [a?, b?, c?]
            }
        };
        // How far what cannot be split is off has to be said.
        let sieved = follow.solved.filter(|_| follow.may_split);
        let search = Search {
            part,
            block: follow.block,
            from,
            to,
            corrected,
            own_words: follow.alone,
            farthest_mm: if sieved.is_some() { limit_mm + BEYOND_DOUBT_MM } else { f64::INFINITY },
        };
        let mut candidates = search.candidates();
        while let Some(candidate) = candidates.take_best() {
            let Some(curve) = candidate.arc(&search) else { continue };
            let pair = Pair {
                wanted: part,
                commanded: &curve,
                in_step: follow.whole.in_step,
                begun: self.begun(follow, part),
            };
            // A control that offsets the circle does so by one of its radii: what they differ by, beyond what was programmed,
            // may stand off the path at the other end.
            let aside_mm = match follow.whole.division {
                Division::One | Division::Long { .. } | Division::LongClimbing { .. } => {
                    (curve.radii_apart_mm() - part.radii_apart_mm()).max(0.0)
                }
                Division::Any | Division::OneBehindLines => 0.0,
            };
            let limit_mm = limit_mm - aside_mm;
            let verdict =
                pair.verdict_by(&follow.machine, sieved.as_ref(), follow.enclosed.as_ref(), limit_mm);
            match self.verdict_with_play(&follow.machine, &pair, verdict, limit_mm) {
                Verdict::Within(bound) => {
                    let kind = PieceKind::Arc { clockwise, centre: candidate.words };
                    let piece = Piece::new(kind, axes, follow.share(part));
                    follow.finish(piece, bound + aside_mm, (wanted - nominal_end).norm());
                    self.gone_along(&follow.machine.state, &curve);
                    self.note_end(&follow.machine.state, nominal_end, wanted);
                    return Ok(Tried::Done);
                }
                Verdict::Beyond { distance_mm, .. } => nearest = nearest.min(distance_mm + aside_mm),
            }
        }
        self.standing = before;
        Ok(Tried::Beyond { distance_mm: nearest, s: 0.5 })
    }

    /// Commands that bring the tool to an arc, its places all solved at once, and the largest correction at them, mm; `None` where
    /// the model has to be asked for each.
    pub(crate) fn solved_arc(&self, machine: &Machine<'_>, part: &Curve) -> Option<(Solved, f64)> {
        let places = part.at_quarters();
        let [start, a, b, c, end] = places;
        let [first, second, third, end] = machine.solved_together([a, b, c, end])?;
        let commands = [self.solve(&machine.state, start).ok()?, first, second, third, end];
        let squared = commands.iter().zip(&places).map(|(command, place)| (command - place).norm_squared());
        let largest_mm = squared.fold(0.0, f64::max).sqrt();
        Some((Solved { commands, direction: machine.state.direction }, largest_mm))
    }
}

/// What is known of a part for its halves, and what both lack.
fn solved_halves(follow: &Follow<'_, '_>, part: &Curve, s: f64) -> [Option<Solved>; 2] {
    let Some(Solved { commands: [start, a, middle, b, end], direction }) = follow.solved.filter(|_| s == 0.5)
    else {
        return [None; 2];
    };
    if direction != follow.machine.state.direction {
        return [None; 2];
    }
    let Some([p, q, r, t]) = follow.machine.solved_together(part.at_odd_eighths()) else { return [None; 2] };
    [[start, p, a, q, middle], [middle, r, b, t, end]].map(|commands| Some(Solved { commands, direction }))
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
