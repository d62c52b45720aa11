//! The rigid-body model as an engine that corrects whole paths.

use std::sync::PoisonError;

use super::{RigidBody, TOOLS_KEPT};
use crate::chord_bound::{chord_bound_mm, everywhere, lies_inside};
use crate::solve::solve;
use crate::turning_bound::{direction_in_turn, error_in_turn};
use crate::{
    Command, Engine, EngineId, Everywhere, LANES, Move, PathModel, Solution, SolveError, Turn, Vector, Volume,
};

impl Engine for RigidBody {
    fn id(&self) -> EngineId {
        EngineId::RigidBody
    }

    fn volume(&self) -> Volume {
        self.volume
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.rotary_inside(target)?;
        self.standing(target, |standing| {
            solve(&target.linear_mm, &self.volume, |q| self.error_at(standing, q, &target.direction))
        })
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for RigidBody {
    fn error_mm(&self, command: &Command) -> Vector {
        self.standing(command, |standing| self.error_at(standing, &command.linear_mm, &command.direction))
    }

    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        if !lies_inside(self, stretch) {
            return f64::INFINITY;
        }
        match &stretch.turn {
            Some(turn) => error_in_turn(self, stretch, turn).0.leaves_chord_mm(),
            None => chord_bound_mm(self, stretch),
        }
    }

    fn follows_turns(&self) -> bool {
        true
    }

    fn error_from_mm(&self, command: &Command, programmed_rad: &Vector) -> Vector {
        if command.rotary_rad == *programmed_rad {
            return self.error_mm(command);
        }
        // Outside the volume the error is that of its nearest point, as everywhere.
        let inside = Command { linear_mm: self.volume.nearest(&command.linear_mm), ..*command };
        let programmed = Command { rotary_rad: *programmed_rad, ..inside };
        let position_mm = self.predict(&inside).position_mm;
        self.standing(&programmed, |standing| {
            standing.turn.tr_mul(&(position_mm - standing.nominal_position(&inside.linear_mm)))
        })
    }

    fn same_tip_mm(&self, linear_mm: &Vector, state: &Command, programmed_rad: &Vector) -> Vector {
        let programmed = Command { rotary_rad: *programmed_rad, ..*state };
        self.reach(&self.nominal_position(linear_mm, &programmed), state)
    }

    fn along_axes(&self, workpiece_mm: &Vector, state: &Command) -> Vector {
        if self.description.chain.table().is_empty() {
            return *workpiece_mm;
        }
        self.standing(state, |standing| standing.turn.tr_mul(workpiece_mm))
    }

    fn table_turns_rad(&self, turn: &Turn) -> f64 {
        let [from, to] = turn.programmed_rad;
        let table = self.description.chain.table();
        table.iter().map(|axis| (to - from)[axis.direction()].abs()).sum()
    }

    fn tip_mm(&self, linear_mm: &Vector, state: &Command) -> Vector {
        // Where nothing turns the tool is the same on both sides of every comparison.
        if self.description.chain.has_rotary() { self.nominal_position(linear_mm, state) } else { *linear_mm }
    }

    fn tilt_rad(&self, command: &Command) -> f64 {
        let [ideal, real] = self.directions(command);
        // Unit vectors: as good for small angles as for large ones.
        2.0 * units::math::asin((0.5 * (real - ideal).norm()).min(1.0))
    }

    fn tool_directions(&self, command: &Command, programmed_rad: &Vector) -> Option<[Vector; 2]> {
        if command.rotary_rad == *programmed_rad {
            return Some(self.directions(command));
        }
        let programmed = Command { rotary_rad: *programmed_rad, ..*command };
        Some([self.ideal_direction(&programmed), self.directions(command)[1]])
    }

    fn direction_bound_rad(&self, stretch: &Move) -> f64 {
        let stands = [stretch.state.rotary_rad; 2];
        let stands = Turn { programmed_rad: stands, commanded_rad: stands, lag_rad: [Vector::zeros(); 2] };
        let turn = stretch.turn.unwrap_or(stands);
        if lies_inside(self, stretch) {
            direction_in_turn(self, stretch, &turn).leaves_chord_mm()
        } else {
            f64::INFINITY
        }
    }

    fn rotary_axes(&self) -> [bool; 3] {
        let mut has = [false; 3];
        self.description
            .chain
            .axes()
            .filter(|axis| !axis.is_linear())
            .for_each(|axis| has[axis.direction()] = true);
        has
    }

    fn in_travel(&self, command: &Command, which: [bool; 3]) -> Result<(), SolveError> {
        self.rotary_within(command, which, |axis| axis.travel_rad)
    }

    fn may_turn_to(&self, command: &Command) -> bool {
        self.rotary_inside(command).is_ok()
    }

    fn everywhere(&self, state: &Command) -> Option<Everywhere> {
        // A table's errors turn with it, a head's lever with the head: their bounds are taken stretch by stretch.
        let plain = !self.table_has_errors && self.description.chain.head().is_empty();
        plain.then(|| {
            // Then the tool is all of the state that they depend on. What is kept is what would be worked out,
            // whoever asks first: a panic elsewhere leaves it as good as it was.
            let kept = || self.everywhere.lock().unwrap_or_else(PoisonError::into_inner);
            let tool = self.nominal_tool(state);
            if let Some((_, known)) = kept().iter().find(|(known, _)| *known == tool) {
                return *known;
            }
            let everywhere = everywhere(self, state);
            let mut kept = kept();
            kept.truncate(TOOLS_KEPT - 1);
            kept.push_front((tool, everywhere));
            everywhere
        })
    }

    fn command_for(&self, target: &Command, everywhere: &Everywhere) -> Result<Vector, SolveError> {
        match self.newton(target, everywhere) {
            Some(command) => Ok(command),
            None => self.solve(target).map(|solution| solution.linear_mm),
        }
    }

    fn commands_for(
        &self,
        targets_mm: &[[f64; 3]; LANES],
        directions: &[[i8; 3]; LANES],
        state: &Command,
        everywhere: &Everywhere,
    ) -> Option<[[f64; LANES]; 3]> {
        self.newton_together(targets_mm, directions, state, everywhere)
    }

    fn depends_on_direction(&self) -> bool {
        self.depends_on_direction
    }

    fn has_rotary_play(&self) -> bool {
        self.has_rotary_play
    }

    fn rotary_reversal_rad(&self, axis: usize, command: &Command) -> f64 {
        self.swivels[axis].reversal_rad(command.rotary_rad[axis])
    }

    fn reversal_mm(&self, axis: usize, command: &Command) -> f64 {
        let link = &self.links[self.place_of[axis]];
        match link.by_direction.as_slice() {
            [negative, _, positive] => {
                let range = self.volume.0[axis];
                let at = command.linear_mm[axis].clamp(range.low, range.high);
                negative.at(at)[axis] - positive.at(at)[axis]
            }
            _ => 0.0,
        }
    }
}
