//! Feeds on whose way rotary axes turn, with the direction of the tool.

use machine_model::{Aim, Command, Singularity, Vector};
use toolpath::{Feed, Motion};

use crate::corrected::Corrected;
use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::directions::Stand;
use crate::error::CorrectionError;
use crate::follow::{Follow, Standing};
use crate::grid::{Block, Goal};
use crate::options::Orientation;
use crate::orientation::aside;
use crate::pointing::{GUARD_RAD, Leans};
use crate::turning::RotaryWords;

impl<'m> Corrector<'m> {
    /// A feed on whose way rotary axes turn.
    pub(crate) fn turn_directed(
        &mut self,
        motion: &Motion,
        feed: &Feed,
        block: &Block,
        limits: &Singularity,
    ) -> Result<Corrected, CorrectionError> {
        if self.directions.stand == Stand::AsPositioned {
            let start = Curve::Line(feed.start.linear_mm.into(), feed.start.linear_mm.into());
            let state = self.state(block, feed.start.rotary_deg);
            let allowed_rad = self.options.orientation_rad - GUARD_RAD;
            self.directions.stand = if let Leans::Within(_) = self.leans_standing(&start, &state, allowed_rad)
            {
                Stand::Reached
            } else {
                match self.aim_at(&Command { linear_mm: start.at(0.0), ..state }, limits)? {
                    Aim::At(to_rad) => {
                        self.lead_to(&to_rad, &feed.start, block, Curve::of(feed).length_mm())?;
                        Stand::Reached
                    }
                    Aim::Held(_) => Stand::Held,
                }
            };
        }
        self.correct_plain(motion, block)
    }

    /// How the rotary axes stand where a feed begins on whose way they turn; `None` where directions are not corrected.
    pub(crate) fn standing_at(&self, feed: &Feed) -> Option<Standing> {
        let Orientation::Full(limits) = self.options.orientation else { return None };
        let output_deg = [0, 1, 2].map(|axis| feed.start.rotary_deg[axis] + self.directions.aside_deg[axis]);
        Some(Standing { output_deg, reached: self.directions.stand == Stand::Reached, limits })
    }

    /// Takes note of how they stand where it ends.
    pub(crate) fn stand_at(&mut self, standing: &Standing, end_deg: [f64; 3]) {
        self.directions.aside_deg = [0, 1, 2].map(|axis| standing.output_deg[axis] - end_deg[axis]);
        self.directions.stand = if standing.reached { Stand::Reached } else { Stand::Held };
    }

    /// The words that point the tool where it shall at the end of a part, as far as the axes may be corrected on its way.
    pub(crate) fn directed_words(
        &self,
        follow: &Follow<'_, '_>,
        part: &Curve,
        standing: &Standing,
    ) -> Result<Option<RotaryWords>, CorrectionError> {
        let (Some(mut turning), Some(programmed_rad), Some(from_rad)) =
            (follow.turning, part.rotary_rad(1.0), part.rotary_rad(0.0))
        else {
            return Ok(None);
        };
        let block = follow.block;
        let target = Command { linear_mm: part.at(1.0), rotary_rad: programmed_rad, ..follow.machine.state };
        let (wanted_rad, mut reached) = match self.aim_at(&target, &standing.limits)? {
            Aim::At(rad) => (rad - programmed_rad, true),
            Aim::Held(_) => (Vector::zeros(), false),
        };
        let most_rad = standing.limits.most_share * (programmed_rad - from_rad).abs().sum();
        let whole_end = Vector::from(turning.end_deg.map(f64::to_radians)) == programmed_rad;
        let first = follow.corrected.pieces.is_empty();
        let mut words = [Goal::Stays; 3];
        let mut output_deg = standing.output_deg;
        for axis in 0..3 {
            let programmed_deg =
                if whole_end { turning.end_deg[axis] } else { programmed_rad[axis].to_degrees() };
            let stands_rad = (standing.output_deg[axis] - from_rad[axis].to_degrees()).to_radians();
            let room = most_rad + block.half_turn_step_rad(axis);
            let by_rad = wanted_rad[axis].clamp(stands_rad - room, stands_rad + room);
            reached &= (by_rad - wanted_rad[axis]).abs() <= 1e-12;
            let own = block.stated.rotary[axis];
            if !own && !self.directions.named[axis] {
                // No word of the program has said where it is.
                continue;
            }
            let own_deg = match (own && whole_end, block.rotary_increments()) {
                (false, _) => None,
                (true, false) => Some(turning.end_deg[axis]),
                (true, true) if first => Some(self.own_deg(block, axis, turning.end_deg[axis])),
                (true, true) => None,
            };
            (words[axis], output_deg[axis]) =
                block.turn(axis, aside(programmed_deg, by_rad), standing.output_deg[axis], own_deg);
        }
        turning.directed = Some(Standing { output_deg, reached, ..*standing });
        let end_rad = Vector::from_fn(|axis, _| {
            let programmed_deg = turning.end_deg[axis];
            // What stays at the programmed angle has its bits.
            if output_deg[axis] == programmed_deg && whole_end {
                programmed_rad[axis]
            } else {
                output_deg[axis].to_radians()
            }
        });
        Ok(Some(RotaryWords { words, end_rad, turning, reached }))
    }
}
