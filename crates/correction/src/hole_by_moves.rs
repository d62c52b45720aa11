//! A drilling cycle that cannot stay, written as the moves that it is.

use machine_model::{Command, Vector};
use toolpath::{Division, Hole, HoleMove, MOST_PECKS, whole_pecks};

use crate::corrected::Corrected;
use crate::corrector::{Corrector, Freedom, MOST_TURNS};
use crate::curve::Curve;
use crate::deviation::Machine;
use crate::error::CorrectionError;
use crate::follow::{Follow, Whole};
use crate::grid::{Block, Goal};
use crate::{Piece, PieceKind};

impl<'m> Corrector<'m> {
    /// The cycle as the moves it is made of.
    pub(crate) fn expand(
        &mut self,
        hole: &Hole,
        block: &Block,
        machine: &Machine<'m>,
        corrected: &mut Corrected,
    ) -> Result<(), CorrectionError> {
        let normal = hole.plane.axes()[2];
        let pecks = hole.pecks().unwrap_or(1.0);
        if pecks > MOST_PECKS {
            return Err(CorrectionError::TooManyPecks { pecks });
        }
        let may = block.may_have_words();
        // On the way to the next feed, even back, an axis is where it will be on that feed; else where it goes.
        let drills = machine.state;
        let mut leaves = drills;
        leaves.direction[normal] = -drills.direction[normal];
        let words = (block, normal, may);
        let mut at = Vector::from(hole.start.linear_mm);
        for step in hole.moves(whole_pecks(pecks), block.retreats) {
            let to = step.end().map_or(at, |to| to.linear_mm.into());
            match step {
                HoleMove::Rise { .. } if to == at => {}
                // It leaves the axes of the plane where they are: their words say where the hole is.
                HoleMove::Rise { .. } => {
                    self.position((block, normal, block.named), &leaves, to, corrected)?
                }
                HoleMove::Position { .. } => self.position(words, &drills, to, corrected)?,
                HoleMove::Leave { .. } => self.position(words, &leaves, to, corrected)?,
                HoleMove::Dwell => {
                    corrected.pieces.push(Piece::new(PieceKind::Dwell, [Goal::Stays; 3], 0.0));
                }
                HoleMove::FeedIn { .. } => {
                    let state = self.drilling(&machine.state, normal);
                    self.over_the_hole(&state, self.standing_or(&at), (at != to).then_some(normal));
                    let machine = Machine { state, ..machine.clone() };
                    let whole = along(at, (hole.bottom_mm - hole.at_r.linear_mm[normal]).abs());
                    let mut follow = Follow { foreseen: true, ..follow(machine, block, whole, corrected) };
                    self.follow_line(&mut follow, &Curve::Line(at, to))?;
                }
                HoleMove::FeedOut { .. } => {
                    // Out again is a reversal like any other.
                    self.turn_towards(&at, &to);
                    let state = Command { direction: self.direction, ..machine.state };
                    let mut machine = Machine { state, ..machine.clone() };
                    let out = Curve::Line(at, to);
                    let whole = along(at, out.length_mm());
                    self.approach(&mut machine, &out, block, &whole, corrected)?;
                    self.follow_line(&mut follow(machine, block, whole, corrected), &out)?;
                }
            }
            at = to;
        }
        Ok(())
    }

    /// A positioning move of a cycle; along the drilling axis (`normal`) the axes go as `along` says.
    pub(crate) fn position(
        &mut self,
        (block, normal, may): (&Block, usize, [bool; 3]),
        along: &Command,
        to: Vector,
        corrected: &mut Corrected,
    ) -> Result<(), CorrectionError> {
        let before = self.standing;
        let mut turns = 0;
        let (state, wanted, axes) = loop {
            let state = self.drilling(along, normal);
            let wanted = self.solve(&state, to)?;
            let axes = self.go(block, &to, &wanted, &Freedom::of(may));
            let mut reached = self.standing;
            reached[normal] = None;
            turns += 1;
            match self.against(&state, before, reached, block) {
                Some(against) if turns < MOST_TURNS => {
                    self.turn(against);
                    self.standing = before;
                }
                _ => break (state, wanted, axes),
            }
        };
        if axes.iter().any(|goal| *goal != Goal::Stays) {
            corrected.pieces.push(Piece::new(PieceKind::Rapid, axes, 0.0));
        }
        self.gone(&state);
        self.note_end(&state, to, wanted);
        Ok(())
    }
}

/// A motion of the drilling axis, of which the cycle may have other parts.
pub(crate) fn along(start: Vector, length_mm: f64) -> Whole {
    Whole { start, rotary_rad: None, length_mm, in_step: false, division: Division::Any }
}

/// A feed of a cycle, written with words of its own.
pub(crate) fn follow<'a, 'm>(
    machine: Machine<'m>,
    block: &'a Block,
    whole: Whole,
    corrected: &'a mut Corrected,
) -> Follow<'a, 'm> {
    Follow {
        machine,
        block,
        alone: false,
        may_split: true,
        whole,
        nominal_step: Vector::zeros(),
        solved: None,
        enclosed: None,
        foreseen: false,
        leans_rad: None,
        turning: None,
        commanded_mm: 0.0,
        corrected,
    }
}
