//! The motion that programs consist of by millions: one short straight line that goes on where the last one ended.
//!
//! What is written is what [`crate::line`] would write, word for word: the same answer of the model, rounded the same
//! way. Only the proof is shorter: bounds that hold everywhere in the volume are looked up instead of being
//! worked out for this stretch. Where they do not suffice, or a figure of the summary could depend on the exact
//! bound, the long way is taken.

use std::cmp::Ordering;

use machine_model::{Command, Vector};
use toolpath::{Feed, Shape};

use crate::corrector::{Correction, Corrector};
use crate::curve::Curve;
use crate::deviation::{Machine, Pair, Verdict};
use crate::grid::{AxisWord, Block};

/// Room for the rounding of the few additions here, mm.
const SLACK_MM: f64 = 1e-9;

/// A line that was corrected the short way: one block of output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortLine {
    /// X, Y, Z words; the block may stay as it is where none is to be written.
    pub axes: [AxisWord; 3],
    /// What was done.
    pub correction: Correction,
}

impl ShortLine {
    /// True where the block stays as it is.
    #[must_use]
    pub fn is_untouched(&self) -> bool {
        !self.axes.iter().any(|word| matches!(word, AxisWord::Write(_)))
    }
}

impl Corrector<'_> {
    /// Corrects a line the short way; `None`, with nothing changed, where [`Corrector::correct`] must be asked. Where
    /// there is an answer, it would have been that of [`Corrector::correct`].
    #[inline]
    pub fn short_line(&mut self, feed: &Feed, block: &Block) -> Option<ShortLine> {
        self.heed(block, feed.end.rotary_deg);
        let line = self.proven_short(feed, block)?;
        self.expanding = false;
        self.remembered = None;
        self.tell(&line.correction);
        Some(line)
    }

    #[inline]
    fn proven_short(&mut self, feed: &Feed, block: &Block) -> Option<ShortLine> {
        let Some((_, _, Some(everywhere))) = &self.everywhere else { return None };
        let (last, answer) = self.last?;
        let (start, end): (Vector, Vector) = (feed.start.linear_mm.into(), feed.end.linear_mm.into());
        let [Some(x), Some(y), Some(z)] = self.standing else { return None };
        let ordinary = matches!(feed.shape, Shape::Line)
            && !block.incremental
            && block.frame.is_shift()
            && block.whole == [false; 3]
            && feed.start.rotary_deg == feed.end.rotary_deg
            && last.linear_mm == start;
        if !ordinary {
            return None;
        }
        let mut direction = self.direction;
        for i in 0..3 {
            if end[i] > start[i] {
                direction[i] = 1;
            } else if end[i] < start[i] {
                direction[i] = -1;
            }
        }
        let state = Command { direction, ..self.state(block, feed.end.rotary_deg) };
        let depends = self.model.depends_on_direction();
        if last.tool_mm != state.tool_mm
            || last.rotary_rad != state.rotary_rad
            || (depends && (last.direction != direction || direction.contains(&0)))
        {
            return None;
        }
        // The axes stand at the corrected start, as the last line left them.
        let from = Vector::new(x, y, z);
        let stands = |i: usize| (from[i] - answer[i]).abs() <= 0.505 * block.step_mm(i);
        if !(stands(0) && stands(1) && stands(2)) {
            return None;
        }
        let target = Command { linear_mm: end, ..state };
        let wanted = self.model.command_for(&target, everywhere).ok()?;

        let offset = block.frame.offset_mm();
        let mut axes = [AxisWord::Omit; 3];
        let mut reached = [0.0; 3];
        for i in 0..3 {
            let programmed = block.has_axis(i).then_some(end[i] - offset[i]);
            (axes[i], reached[i]) =
                block.choose(i, wanted[i] - offset[i], programmed, Some(from[i] - offset[i]));
        }
        let to = block.machine(reached);

        // At an end the tool is off by the rounding of its command, and what that changes in the error.
        let rounded = (to - wanted).norm().max((from - answer).norm());
        let at_ends = rounded * (1.0 + everywhere.gradient) + SLACK_MM;
        let way = to - from;
        let after_mm = at_ends + everywhere.chord_bound_mm(way.amax());
        let limit_mm = self.limit_mm(block);
        // The error at a place is its correction, but for what the error changes over the correction.
        let corrected_mm = (wanted - end).norm();
        let largest = corrected_mm.max((self.held(answer, from, depends) - start).norm());
        let before_mm = largest * (1.0 + everywhere.gradient)
            + SLACK_MM
            + everywhere.chord_bound_of_four_passes_mm((end - start).amax());
        let inside = everywhere.volume.contains(&start)
            && everywhere.volume.contains(&from)
            && everywhere.volume.contains(&to);
        // Not a number is not proven either.
        if !inside || !matches!(after_mm.partial_cmp(&limit_mm), Some(Ordering::Less)) {
            return None;
        }
        let mut correction = Correction { largest_mm: largest, ..Correction::default() };
        if after_mm > self.told_mm[1] {
            let (nominal, commanded) = (Curve::Line(start, end), Curve::Line(from, to));
            let pair = Pair { wanted: &nominal, commanded: &commanded, in_step: false };
            let Verdict::Within(bound) =
                pair.verdict(&Machine { state, ..self.machine(block, feed.end.rotary_deg) }, limit_mm)
            else {
                return None;
            };
            correction.after_mm = bound;
        }
        let (stood, came) = (self.standing, self.direction);
        self.standing = [Some(to.x), Some(to.y), Some(to.z)];
        self.direction = direction;
        if depends && self.against(stood, direction, block).is_some() {
            (self.standing, self.direction) = (stood, came);
            return None;
        }
        if before_mm > self.told_mm[0] {
            self.note_before(&Curve::Line(start, end), block, feed, &mut correction);
        }
        self.last = Some((target, wanted));
        Some(ShortLine { axes, correction })
    }

    /// The corrected start as [`Corrector::approach`] takes it: an axis with play that stands a little too far on its
    /// way holds its place.
    fn held(&self, mut wanted: Vector, standing: Vector, depends: bool) -> Vector {
        if depends {
            for i in 0..3 {
                if (wanted[i] - standing[i]) * f64::from(self.direction[i]) < 0.0 {
                    wanted[i] = standing[i];
                }
            }
        }
        wanted
    }
}
