//! Cycles of lathes written out as the moves they are.
//!
//! Fanuc's single passes (G90, G92, G94 of system A), contours (G70 to G73), pecks (G74, G75) and threads (G76), by
//! their names in systems A, B and C. What each of them does is told by the manual (B-64304EN-1, Series 0i-D, lathe
//! system: "Canned cycle", "Multiple repetitive cycle"), and by parameters of the control, which the profile has to say
//! ([`toolpath::TurningParameters`]).
//!
//! * [`drawing`]: corners and angles of drawings, where they come and in contours.
//! * [`pass`]: one pass there and back, repeated by each block that names a place.
//! * [`contour`]: the blocks between P and Q as a way in the plane.
//! * [`rough`]: passes down to a contour, and the contour itself; [`pockets`]: where it has pockets.
//! * [`pecks`]: grooves and holes; [`drill`]: holes on the axis.
//! * [`routine`]: LinuxCNC's contours, which are subroutines; [`profile`]: their geometry; [`levels`]: passes down to them.
//! * [`writer`]: what all of them know at a block, and [`held`]: what they hold from block to block.
//! * [`threads`]: a thread in several passes; [`compound`]: that of LinuxCNC.
//!
//! Places are whole millionths of the program's unit, X as its words have it: sums of them are exact. Where a pass ends
//! on a slope or an arc, the place is rounded to one of them.

mod compound;
mod contour;
mod drawing;
mod drill;
mod emit;
mod held;
mod levels;
mod pass;
mod pecks;
mod pieces;
mod place;
mod pockets;
mod profile;
mod rough;
mod routine;
mod threads;
mod writer;

use nc_dialect::{Action, Dialect, Turning, TurningCycle};
use nc_program::Compensation;
use nc_syntax::Block;

use crate::came::{Came, Fault, Held};
use crate::known::{Lower, Rewriting};
use crate::refusals::turning as refusal;
use crate::shorthand::actions;
use drawing::Drawing;
use place::may_stand_beside;
use writer::{Writer, cycle_of};

/// True where the block has a cycle that is written out, or may have words of a drawing without a comma.
pub(crate) fn needed(block: &Block<'_>, dialect: &Dialect) -> bool {
    dialect.turning.as_ref().is_some_and(|turning| {
        let draws = turning.cycles.plain_drawing && drawing::may_draw(block, turning);
        draws || actions(block, dialect).any(|(action, _)| matches!(action, Action::Turning(_)))
    })
}

/// Holds a lathe's program, whose cycles name blocks anywhere in it, and writes it at its end.
pub(crate) struct Lathe<'d> {
    out: Rewriting<'d>,
    turning: &'d Turning,
    held: Vec<Held>,
}

impl<'d> Lathe<'d> {
    pub(crate) const fn new(out: Rewriting<'d>, turning: &'d Turning) -> Self {
        Self { out, turning, held: Vec::new() }
    }
}

impl<'d> Lower<'d> for Lathe<'d> {
    fn came(&mut self, came: &Came<'_>) -> Result<(), Fault> {
        self.held.push(Held::of(came));
        Ok(())
    }

    fn fresh_line(&mut self) {
        if let Some(held) = self.held.last_mut() {
            held.end_line(self.out.marks.line_ending);
        }
    }

    fn out(&mut self) -> Option<&mut Rewriting<'d>> {
        None
    }

    fn end(mut self: Box<Self>) -> (Rewriting<'d>, Result<(), Fault>) {
        let blocks: Vec<Came<'_>> = self.held.iter_mut().map(Held::taken).collect();
        let ended = Writer::new(&blocks, self.turning, &mut self.out).all();
        (self.out, ended)
    }
}

impl Writer<'_, '_, '_> {
    fn all(mut self) -> Result<(), Fault> {
        let mut at = 0;
        while at < self.blocks.len() {
            at = self.block(at)?;
        }
        Ok(())
    }

    /// Writes a block, and says which one is next.
    fn block(&mut self, at: usize) -> Result<usize, Fault> {
        let words = self.words(at);
        if !self.out.wakes(words.block) {
            self.out.block(&self.blocks[at]);
            return Ok(at + 1);
        }
        let mut drawing = Drawing::new(self.blocks, self.out, self.open || self.pass.is_some());
        if let Some(span) = drawing.first_drawn(&words) {
            let next = drawing.lines(at, span)?;
            for index in at..next {
                self.said(&self.words(index));
            }
            return Ok(next);
        }
        let beside = self.out.known.settings(&words.codes(may_stand_beside), words.from);
        self.here = beside.unwrap_or_else(|| self.out.known.modal().clone());
        let Some((cycle, span)) = cycle_of(&words) else {
            if self.repeats(&words) {
                self.repeated(at)?;
            } else {
                self.plain(at)?;
            }
            return Ok(at + 1);
        };
        if words.skipped() {
            return Err(words.fault(refusal::CYCLE_BEHIND_BLOCK_DELETE, span));
        }
        if self.out.known.modal().compensation != Compensation::Off {
            return Err(words.fault(refusal::CYCLE_UNDER_COMPENSATION, span));
        }
        match cycle {
            TurningCycle::TurnPass | TurningCycle::ThreadPass | TurningCycle::FacePass => {
                self.first_pass(at, cycle, span)?;
            }
            TurningCycle::RoughTurn | TurningCycle::RoughFace | TurningCycle::RoughPattern => {
                return self.rough(at, cycle, span);
            }
            TurningCycle::FinishRoutine
            | TurningCycle::RoughTurnRoutine(_)
            | TurningCycle::RoughFaceRoutine(_) => return self.routine(at, cycle, span),
            TurningCycle::Finish => self.finish(at, span)?,
            TurningCycle::PeckFace | TurningCycle::PeckGroove => self.pecks(at, cycle, span)?,
            TurningCycle::DrillFace => self.drill(at, span)?,
            TurningCycle::BoreFace => self.bore(at, span)?,
            // Where K is the lead of a thread, its cycle has LinuxCNC's words.
            TurningCycle::ThreadPasses if self.turning.thread_lead == b'K' => {
                self.compound_thread(at, span)?;
            }
            TurningCycle::ThreadPasses => self.thread(at, span)?,
        }
        Ok(at + 1)
    }

    /// A block that is no cycle's.
    fn plain(&mut self, at: usize) -> Result<(), Fault> {
        let words = &self.words(at);
        if self.pass.is_none() && self.open && words.names_a_place() && !words.owns_motion() {
            return Err(words.fault(refusal::AXIS_WORDS_WITHOUT_MOTION_CODE, words.whole()));
        }
        self.said(words);
        self.out.block(&self.blocks[at]);
        Ok(())
    }
}
