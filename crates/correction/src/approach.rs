//! The way to a corrected start where the axes do not stand there: after a reversal of an axis with lost motion, after
//! motion that is never corrected, after a change of tool length.
//!
//! A reversal is a feed like any other: while play is taken up, and when what lies across the axis changes, the tool must
//! not leave the path. Equation (27). Several ways lead to the start; the first that is proven is taken.

use machine_model::{Command, Vector};
use smallvec::SmallVec;

use crate::corrected::Corrected;
use crate::corrector::{Corrector, Freedom};
use crate::curve::{Curve, SAME_PLACE_MM};
use crate::deviation::Machine;
use crate::direction::{heading, moved};
use crate::error::CorrectionError;
use crate::follow::Whole;
use crate::grid::{Block, Goal};
use crate::{Piece, PieceKind};

/// More than what rounding adds in the figures of a line of an approach, mm.
const ROUNDING_MM: f64 = 1e-8;

/// What lies before the place from which a part of a motion goes on.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Before {
    /// Another motion, from whatever side.
    Another,
    /// The same motion, whose path is smooth there.
    Same,
}

/// Where the tool is on its way to a start.
#[derive(Default)]
struct Tips {
    /// Real places less the start, mm, of which no line between two leaves the straight one by more than `besides_mm`.
    differences: SmallVec<[Vector; 16]>,
    besides_mm: f64,
}

impl Tips {
    /// Upper bound of the distance from the path, mm, which leads from the start on along a tangent: being early or late is no
    /// deviation from it. All of them are compared with one place of the path, as far on as suits them best.
    fn off_mm(&self, tangent: Vector, before: Before, most_mm: f64) -> f64 {
        let along = || self.differences.iter().map(|difference| difference.dot(&tangent));
        let (low, high) = (along().fold(0.0, f64::min), along().fold(0.0, f64::max));
        let least_mm = if before == Before::Same { -most_mm } else { 0.0 };
        let place = tangent * (0.5 * (low + high)).clamp(least_mm, most_mm);
        self.differences.iter().map(|difference| (difference - place).norm()).fold(0.0, f64::max)
            + self.besides_mm
    }
}

/// By how much further than it was already the tool may be off on the way from a place that was not corrected, mm.
const UNCORRECTED_MM: f64 = 1e-4;

/// How an approach gets to the start.
#[derive(Clone, Copy)]
enum Way {
    /// By a line; axes that stand too far on their way come again from behind.
    AtOnce,
    /// The same, and axes whose play would not be taken up come again from behind too.
    FromBehind,
    /// What the turn will move the tool sideways by is undone by half before it; the block behind undoes the rest.
    Halfway,
    /// One axis turns after the other, each at the place for the sides of all.
    OneByOne,
    /// Only the axes that turn take up their play; the block behind undoes what that moves the tool sideways by.
    OnlyTurning,
}

/// How the axes lie in their play before an approach.
#[derive(Clone, Copy)]
struct Lie {
    /// The state in which they are to come to the start.
    state: Command,
    /// That with the axes where they stand.
    here: Command,
    /// On which side of its play each stands; 0: not known.
    side: [i8; 3],
    /// Those that have to take up play.
    turning: [bool; 3],
    /// How far each has yet to go for that, mm.
    lag_mm: [f64; 3],
}

impl<'m> Corrector<'m> {
    /// Brings the axes to the corrected start of a part.
    ///
    /// # Errors
    /// [`CorrectionError::Sideways`] where no way keeps the tool near the path; the axes stand where they stood then.
    pub(crate) fn approach(
        &mut self,
        machine: &mut Machine<'_>,
        part: &Curve,
        block: &Block,
        motion: &Whole,
        corrected: &mut Corrected,
    ) -> Result<(), CorrectionError> {
        if motion.division.is_offset() {
            // From where the axes stand the block holds or does not.
            return Ok(());
        }
        let length_mm = motion.length_mm;
        let before_it = if motion.begins_with(part) { Before::Another } else { Before::Same };
        let start = machine.target(part, 0.0);
        let tangent = if motion.in_step { Vector::zeros() } else { part.tangent(0.0) };
        let mut wanted = self.start_within_reach(machine, start, block)?;
        if let Some(first) = self.first_moves(&wanted, machine.state.direction, block) {
            self.direction = first;
            machine.state.direction = first;
            wanted = self.start_within_reach(machine, start, block)?;
        }
        let [Some(x), Some(y), Some(z)] = self.standing else {
            self.approach_to(machine, wanted, start, block, length_mm, corrected)?;
            return Ok(());
        };
        let from = Vector::new(x, y, z);
        let here = Command { linear_mm: from, ..machine.state };
        if !self.model.depends_on_direction() {
            let off = from - start + self.model.error_mm(&here);
            let beside_mm = (off - off.dot(&tangent) * tangent).norm();
            if self.approach_to(machine, wanted, start, block, length_mm, corrected)?
                && beside_mm <= self.options.tolerance_mm + block.rounding_mm()
            {
                // The tool stands beside the path, a little before or behind its start, and is fed to it from there.
                let told = &mut corrected.correction.after_mm;
                *told = told.max(beside_mm);
            }
            return Ok(());
        }
        // A second approach at one place: what the first left along the path is not to be gone back over.
        let again = self.approached == Some(start);
        let tangent = if again { Vector::zeros() } else { tangent };
        let most_mm = part.length_mm().min(self.limit_mm(block));
        let already = from - start + self.play.error_mm(self.model, &here);
        let already = Tips { differences: SmallVec::from_slice(&[already]), besides_mm: 0.0 };
        let already_mm = already.off_mm(tangent, before_it, most_mm);
        let limit_mm = self.limit_mm(block);
        // From a place that was not corrected the tool comes as it can.
        let allowed_mm = if again || already_mm <= limit_mm { limit_mm } else { already_mm + UNCORRECTED_MM };
        let before = self.clone();
        let (written, correction) = (corrected.pieces.len(), corrected.correction);
        let mut least_mm = f64::INFINITY;
        let all = [Way::AtOnce, Way::FromBehind, Way::Halfway, Way::OneByOne, Way::OnlyTurning];
        // Rather one behind which all play is taken up; else the block behind has to bear the rest.
        for (way, lags) in all.iter().map(|way| (*way, false)).chain(all.iter().map(|way| (*way, true))) {
            let Some(places) = self.places_on(way, machine, start, wanted, block)? else { continue };
            let mut tips = Tips::default();
            for place in places {
                let stood = self.standing_or(&start);
                let play = self.play;
                if self.approach_to(machine, place, start, block, length_mm, corrected)? {
                    self.tips_on_the_way(machine, play, stood, start, &mut tips);
                }
            }
            // Where the block behind begins, on the sides it is computed for.
            let begins = Command { linear_mm: self.standing_or(&start), ..machine.state };
            let begins = begins.linear_mm - start + self.model.error_mm(&begins);
            let begins = Tips { differences: SmallVec::from_slice(&[begins]), besides_mm: 0.0 };
            let begins_mm = begins.off_mm(tangent, before_it, most_mm);
            let off_mm = tips.off_mm(tangent, before_it, most_mm);
            let holds = off_mm <= allowed_mm && begins_mm <= self.limit_mm(block);
            if holds && (lags || self.on_their_sides(machine, block)) {
                if corrected.pieces.len() > written {
                    self.approached = Some(start);
                    let told = &mut corrected.correction.after_mm;
                    // What `check` allows: from a place that was not corrected the tool comes as it can.
                    *told = told.max(off_mm.min(self.options.tolerance_mm + block.rounding_mm()));
                }
                return Ok(());
            }
            least_mm = least_mm.min(off_mm.max(begins_mm));
            *self = before.clone();
            corrected.pieces.truncate(written);
            corrected.correction = correction;
        }
        // An axis that the part leaves alone may stand on either side of its play: it turns too, where it stands in the way else.
        let idle = |i: usize| (part.at(1.0)[i] - start[i]).abs() <= SAME_PLACE_MM;
        let (direction, side) = (machine.state.direction, self.play.side());
        let mut other = direction;
        for i in (0..3).filter(|i| idle(*i) && side[*i] != 0 && side[*i] == direction[*i]) {
            let against = (wanted[i] - from[i]) * f64::from(direction[i]) < -SAME_PLACE_MM;
            if against && self.model.reversal_mm(i, &here) > SAME_PLACE_MM {
                other[i] = -direction[i];
            }
        }
        if other != direction {
            (machine.state.direction, self.direction) = (other, other);
            if self.approach(machine, part, block, motion, corrected).is_ok() {
                return Ok(());
            }
            (machine.state.direction, self.direction) = (direction, before.direction);
        }
        if block.named != [true; 3] {
            // What keeps the tool away may be an axis that must not have a word.
            return match self.furthest_without_word(block, &machine.state, start, block.named) {
                Some((axis, mm)) if mm > limit_mm => {
                    Err(CorrectionError::Unnamed { axis, distance_um: mm * 1e3 })
                }
                // The block behind says what it is.
                _ => Ok(()),
            };
        }
        Err(CorrectionError::Sideways {
            distance_um: least_mm * 1e3,
            tolerance_um: self.options.tolerance_mm * 1e3,
        })
    }

    /// Where the lines of a way lead; `None` where it is no other than one before.
    fn places_on(
        &self,
        way: Way,
        machine: &Machine<'_>,
        start: Vector,
        wanted: Vector,
        block: &Block,
    ) -> Result<Option<SmallVec<[Vector; 3]>>, CorrectionError> {
        let direction = machine.state.direction;
        let here = Command { linear_mm: self.standing_or(&start), ..machine.state };
        let lag_mm = self.play.lag_mm(self.model, &here, direction);
        let side = self.play.side();
        let turning = [0, 1, 2].map(|i| side[i] != 0 && (side[i] != direction[i] || lag_mm[i] > 0.0));
        let lie = Lie { state: machine.state, here, side, turning, lag_mm };
        Ok(match way {
            Way::AtOnce | Way::FromBehind => self.at_once(way, &lie, start, wanted, block)?,
            Way::Halfway if block.frame.is_axial() => Some(self.halfway(&lie, start, wanted)?),
            Way::OneByOne if lie.turning.iter().filter(|turns| **turns).count() > 1 => {
                Some(self.one_by_one(&lie, start)?)
            }
            Way::OnlyTurning if block.frame.is_axial() => {
                let mut turned = here.linear_mm;
                (0..3).filter(|i| lie.turning[*i]).for_each(|i| turned[i] = wanted[i]);
                Some([turned].into_iter().collect())
            }
            Way::Halfway | Way::OneByOne | Way::OnlyTurning => None,
        })
    }

    /// By a line, behind one from behind where axes stand too far on their way, or on [`Way::FromBehind`] have to turn.
    fn at_once(
        &self,
        way: Way,
        lie: &Lie,
        start: Vector,
        wanted: Vector,
        block: &Block,
    ) -> Result<Option<SmallVec<[Vector; 3]>>, CorrectionError> {
        let Lie { turning, lag_mm, here: Command { linear_mm: standing, .. }, .. } = *lie;
        let direction = lie.state.direction;
        let mut wanted = wanted;
        let mut turned = self.approachable(&mut wanted, direction, block);
        if let Way::FromBehind = way {
            // Those whose way to the start is no reversal of their play.
            let short = |i: usize| turning[i] && (wanted[i] - standing[i]).abs() < lag_mm[i];
            let found = turned.get_or_insert([0; 3]);
            (0..3).filter(|i| short(*i)).for_each(|i| found[i] = -direction[i]);
            if *found == [0; 3] {
                return Ok(None);
            }
        }
        let mut places = SmallVec::new();
        if let Some(turned) = turned {
            let mut state = lie.state;
            for (direction, new) in state.direction.iter_mut().zip(turned) {
                *direction = if new == 0 { *direction } else { new };
            }
            let mut from_behind = self.solve(&state, start)?;
            // The axes that need not turn do not creep back meanwhile, nor behind that.
            let _ = self.approachable(&mut from_behind, state.direction, block);
            places.push(from_behind);
            for i in 0..3 {
                let way = wanted[i] - from_behind[i];
                if turned[i] == 0 && way * f64::from(direction[i]) < 0.0 {
                    wanted[i] = from_behind[i];
                }
            }
        }
        places.push(wanted);
        Ok(Some(places))
    }

    /// Half of what the turn will move the tool sideways by is undone before it.
    fn halfway(
        &self,
        lie: &Lie,
        start: Vector,
        wanted: Vector,
    ) -> Result<SmallVec<[Vector; 3]>, CorrectionError> {
        let Lie { side, turning, here, .. } = *lie;
        let (direction, standing) = (lie.state.direction, here.linear_mm);
        let before = [0, 1, 2].map(|i| if side[i] == 0 { direction[i] } else { side[i] });
        let stayed = self.solve(&Command { direction: before, ..lie.state }, start)?;
        let (mut halfway, mut first, mut turned) = (standing, standing, standing);
        for i in 0..3 {
            let width_mm = self.model.reversal_mm(i, &here).max(0.0);
            let play = if turning[i] { f64::from(direction[i]) * width_mm } else { 0.0 };
            // What the turn moves the tool by along this axis, its own play apart.
            let middle = stayed[i] + 0.5 * (wanted[i] - stayed[i] - play);
            let way = middle - standing[i];
            if width_mm <= SAME_PLACE_MM || way * f64::from(before[i]) >= 0.0 {
                halfway[i] = middle;
                first[i] = middle;
                turned[i] = middle + play;
            } else if turning[i] {
                // That lies behind its own turn, which comes before that of the others.
                first[i] = middle + play;
                turned[i] = middle + play;
            }
        }
        Ok([halfway, first, turned].into_iter().collect())
    }

    /// One axis turns after the other.
    fn one_by_one(&self, lie: &Lie, start: Vector) -> Result<SmallVec<[Vector; 3]>, CorrectionError> {
        let Lie { side, turning, here, .. } = *lie;
        let (direction, standing) = (lie.state.direction, here.linear_mm);
        let mut state = lie.state;
        state.direction = [0, 1, 2].map(|i| if side[i] == 0 { direction[i] } else { side[i] });
        let mut places: SmallVec<[Vector; 3]> = SmallVec::new();
        let mut at = standing;
        for i in (0..3).filter(|i| turning[*i]) {
            state.direction[i] = direction[i];
            let wanted = self.solve(&state, start)?;
            for j in 0..3 {
                let back = (wanted[j] - at[j]) * f64::from(state.direction[j]) < 0.0;
                // One that would go back into its play waits for its turn, or for the block behind.
                if j == i || !back || self.model.reversal_mm(j, &here) <= SAME_PLACE_MM {
                    at[j] = wanted[j];
                }
            }
            places.push(at);
        }
        Ok(places)
    }

    /// All axes have taken up their play but for a rounding.
    fn on_their_sides(&self, machine: &Machine<'_>, block: &Block) -> bool {
        let at = Command { linear_mm: self.standing_or(&Vector::zeros()), ..machine.state };
        let lag_mm = self.play.lag_mm(self.model, &at, machine.state.direction);
        lag_mm.into_iter().all(|lag_mm| lag_mm <= block.largest_step_mm())
    }

    /// A line to a corrected start, where the axes do not stand there; true where one was written.
    ///
    /// # Errors
    /// [`CorrectionError::Unnamed`] where it would be the first line of a block that gives an axis of its own another frame:
    /// no word says where that axis begins.
    pub(crate) fn approach_to(
        &mut self,
        machine: &Machine<'_>,
        mut wanted: Vector,
        start: Vector,
        block: &Block,
        length_mm: f64,
        corrected: &mut Corrected,
    ) -> Result<bool, CorrectionError> {
        // Axes that must not have a word stay, whatever a turn would ask of them.
        self.leave(&mut wanted, block, block.named);
        let standing = self.standing_program(block);
        let to = block.program(&wanted);
        corrected.correction.largest_mm = corrected.correction.largest_mm.max((wanted - start).norm());
        // Standing within rounding of the corrected start is standing there; the last block chose so.
        let away = (0..3).any(|i| standing[i].is_none_or(|v| (v - to[i]).abs() > 0.51 * block.step_mm(i)));
        if !away {
            return Ok(false);
        }
        let before = self.standing;
        let axes = self.go(block, &start, &wanted, &Freedom::of(block.named));
        let ways =
            (0..3).map(|i| before[i].zip(self.standing[i]).map_or(0.0, |(from, to)| (to - from).powi(2)));
        let way_mm = ways.sum::<f64>().sqrt();
        let share = if length_mm > 0.0 { way_mm / length_mm } else { 1.0 };
        self.gone(&machine.state);
        let written = axes.iter().any(|word| *word != Goal::Stays) && before != self.standing;
        if written {
            let reframed = (0..3).find(|i| block.reframed[*i] && block.stated.axes[*i]);
            if let Some(axis) = reframed.filter(|_| corrected.pieces.is_empty()) {
                return Err(CorrectionError::Unnamed { axis, distance_um: way_mm * 1e3 });
            }
            // No rotary axis turns on it, whatever the block's words say.
            let rotary = machine.turns.then_some([Goal::Stays; 3]);
            let share = share.max(block.least_share);
            corrected.pieces.push(Piece { kind: PieceKind::Line, axes, rotary, share });
            corrected.correction.approach = true;
        }
        Ok(written)
    }

    /// Where the tool is on a line to where the axes stand: equation (27).
    ///
    /// * `play`, `from` – where they were, and where they stood
    fn tips_on_the_way(
        &self,
        machine: &Machine<'_>,
        play: machine_model::Play,
        from: Vector,
        place: Vector,
        tips: &mut Tips,
    ) {
        let way = self.standing_or(&from) - from;
        let at = |t: f64| Command { linear_mm: from + way * t, ..machine.state };
        let headings = [0, 1, 2].map(|i| moved(from[i], from[i] + way[i]));
        let lag_mm = play.lag_mm(self.model, &at(0.0), headings);
        let taken_up = (0..3).filter(|i| headings[*i] != 0).map(|i| lag_mm[i] / way[i].abs());
        let mut times: SmallVec<[f64; 5]> = taken_up.filter(|t| *t < 1.0).collect();
        times.extend([0.0, 1.0]);
        let stood = play.side();
        // Those that turn, and those that lines before have left on the way to another side.
        let on_the_way = play.lag_mm(self.model, &at(0.0), stood);
        let turns = |i: &usize| headings[*i] != 0 && headings[*i] != stood[*i] || on_the_way[*i] > 0.0;
        let turning: SmallVec<[usize; 3]> = (0..3).filter(|i| stood[*i] != 0).filter(turns).collect();
        for t in times {
            let (mut play, at) = (play, at(t));
            play.go(self.model, &at);
            // When what lies across an axis changes, nobody has measured.
            for choice in 0..1_usize << turning.len() {
                let mut sides = play.side();
                for (bit, axis) in turning.iter().enumerate() {
                    sides[*axis] = if choice >> bit & 1 == 0 { stood[*axis] } else { -stood[*axis] };
                }
                let error = play.error_on_mm(self.model, &at, sides);
                tips.differences.push(at.linear_mm - place + error);
            }
        }
        let line = Curve::Line(from, from + way);
        tips.besides_mm =
            tips.besides_mm.max(machine.leaves_chord_mm(&line.extent(0.0, 1.0), 1) + ROUNDING_MM);
    }

    /// The directions with those of the axes that are not known and that an approach would move.
    fn first_moves(&self, wanted: &Vector, direction: [i8; 3], block: &Block) -> Option<[i8; 3]> {
        if !self.model.depends_on_direction() {
            return None;
        }
        let mut found = direction;
        for i in 0..3 {
            let Some(standing) = self.standing[i] else { continue };
            if direction[i] == 0 && (wanted[i] - standing).abs() > 0.5 * block.axis_step_mm(i) {
                found[i] = heading(standing, wanted[i], 0);
            }
        }
        (found != direction).then_some(found)
    }

    /// Where the approach to a corrected start shall bring the axes, `wanted` being that start.
    ///
    /// An axis that stands a little too far on its way holds its place: going back would put it into its play.
    /// One that stands much too far must come again from behind: it is returned as to be turned first.
    fn approachable(&self, wanted: &mut Vector, direction: [i8; 3], block: &Block) -> Option<[i8; 3]> {
        let mut turned = [0; 3];
        for i in 0..3 {
            let Some(standing) = self.standing[i] else { continue };
            let way = wanted[i] - standing;
            if way * f64::from(direction[i]) < 0.0 {
                if way.abs() <= 0.5 * self.options.tolerance_mm + block.axis_step_mm(i) {
                    wanted[i] = standing;
                } else {
                    turned[i] = -direction[i];
                }
            }
        }
        (turned != [0; 3]).then_some(turned)
    }
}
