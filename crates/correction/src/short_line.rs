//! The motion that programs consist of by millions: one short straight line that goes on where the last one ended.
//!
//! What is written is what [`crate::line`] would write, word for word: the same answer of the model, rounded the same
//! way. Only the proof is shorter: bounds that hold everywhere in the volume are looked up instead of being
//! worked out for this stretch. Where they do not suffice the long way is taken.

use std::array::from_fn;
use std::cmp::Ordering;

use machine_model::{Command, Everywhere, LANES, Vector};

use crate::corrector::{Correction, Corrector};
use crate::curve::Curve;
use crate::grid::{AxisWord, Block};
use crate::play::heading;

/// Room for the rounding of the few additions here, mm.
const SLACK_MM: f64 = 1e-9;

/// Upper bound of a distance in commands together with what the error changes over it, mm.
#[inline]
pub(crate) fn with_its_error(everywhere: &Everywhere, mm: f64) -> f64 {
    mm * (1.0 + everywhere.gradient) + SLACK_MM
}

/// Upper bounds for a line whose ends lie in the volume: equation (P5).
///
/// * `squared_mm` – the larger of its ends' roundings, and of their corrections, mm²
/// * `ways_mm` – the longest way of an axis as commanded, and as programmed
#[inline]
pub(crate) fn figures(everywhere: &Everywhere, squared_mm: [f64; 2], ways_mm: [f64; 2]) -> Correction {
    // At an end the tool is off by the rounding of its command, and what that changes in the error. The error at a place
    // is its correction, but for what the error changes over the correction.
    let [rounded, largest_mm] = squared_mm.map(f64::sqrt);
    let [after_mm, before_mm] = [(rounded, ways_mm[0]), (largest_mm, ways_mm[1])]
        .map(|(end, way)| with_its_error(everywhere, end) + everywhere.chord_bound_mm(way));
    Correction { largest_mm, before_mm, after_mm, ..Correction::default() }
}

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

/// What is the same for short lines that follow one another.
#[derive(Clone, Copy, Debug)]
pub struct ShortLines {
    /// Tool and rotary axes; place and directions are not used.
    pub(crate) state: Command,
    pub(crate) offset_mm: [f64; 3],
    pub(crate) limit_mm: f64,
    /// An axis this near to a corrected place stands there.
    pub(crate) near_mm: [f64; 3],
    pub(crate) half_step_mm: [f64; 3],
    /// The error depends on the direction of motion.
    pub(crate) depends: bool,
}

/// The model's answers for lines before their turn.
#[derive(Clone, Copy, Debug)]
pub struct Foreseen {
    /// The directions that each holds for.
    pub(crate) directions: [[i8; 3]; LANES],
    /// X, Y and Z of each.
    pub(crate) commands_mm: [[f64; LANES]; 3],
}

/// The directions after a motion.
#[inline]
fn turned(mut direction: [i8; 3], start_mm: &[f64; 3], end_mm: &[f64; 3]) -> [i8; 3] {
    for i in 0..3 {
        direction[i] = heading(start_mm[i], end_mm[i], direction[i]);
    }
    direction
}

impl Corrector<'_> {
    /// What short lines need that are like `block` but for their letters; `None` where there are none.
    #[inline]
    pub fn short_lines(&mut self, block: &Block, rotary_deg: [f64; 3]) -> Option<ShortLines> {
        self.heed(block, rotary_deg);
        let ordinary = block.incremental == [false; 3]
            && block.frame.is_shift()
            && block.whole == [false; 3]
            && block.named == [true; 3];
        if !ordinary || self.is_side_unknown() || !matches!(self.everywhere, Some((_, _, Some(_)))) {
            return None;
        }
        Some(ShortLines {
            state: self.state(block, rotary_deg),
            offset_mm: block.frame.offset_mm(),
            limit_mm: self.limit_mm(block),
            near_mm: from_fn(|i| 0.505 * block.step_mm(i)),
            half_step_mm: from_fn(|i| block.half_step_mm(i)),
            depends: self.model.depends_on_direction(),
        })
    }

    /// Asks the model for several lines at once: from `start_mm` to the first of `ends_mm` and on from there.
    ///
    /// What it says is used by [`Corrector::short_run`], and by [`Corrector::short_line`] where the directions are those
    /// foreseen. `None` where it has to be asked for each.
    #[must_use]
    pub fn foresee(
        &self,
        lines: &ShortLines,
        mut start_mm: [f64; 3],
        ends_mm: &[[f64; 3]; LANES],
    ) -> Option<Foreseen> {
        let Some((_, _, Some(everywhere))) = &self.everywhere else { return None };
        let mut direction = self.direction;
        let mut directions = [direction; LANES];
        for (found, end_mm) in directions.iter_mut().zip(ends_mm) {
            direction = turned(direction, &start_mm, end_mm);
            start_mm = *end_mm;
            *found = direction;
        }
        let commands_mm = self.model.commands_for(ends_mm, &directions, &lines.state, everywhere)?;
        Some(Foreseen { directions, commands_mm })
    }

    /// Corrects a line the short way; `None`, with nothing changed, where [`Corrector::correct`] must be asked. Where
    /// there is an answer, it would have been that of [`Corrector::correct`].
    ///
    /// * `foreseen` – by [`Corrector::foresee`], and which of its lines this is
    #[inline]
    pub fn short_line(
        &mut self,
        lines: &ShortLines,
        block: &Block,
        start_mm: [f64; 3],
        end_mm: [f64; 3],
        foreseen: Option<(&Foreseen, usize)>,
    ) -> Option<ShortLine> {
        let line = self.proven_short(lines, block, start_mm, end_mm, foreseen)?;
        self.expanding = false;
        self.remembered = None;
        Some(line)
    }

    #[inline]
    fn proven_short(
        &mut self,
        lines: &ShortLines,
        block: &Block,
        start_mm: [f64; 3],
        end_mm: [f64; 3],
        foreseen: Option<(&Foreseen, usize)>,
    ) -> Option<ShortLine> {
        let Some((_, _, Some(everywhere))) = &self.everywhere else { return None };
        let (start, end): (Vector, Vector) = (start_mm.into(), end_mm.into());
        let ShortLines { state, offset_mm: offset, limit_mm, half_step_mm, depends, .. } = *lines;
        let (from, answer) = self.stands_at(lines, &start)?;
        let direction = turned(self.direction, &start_mm, &end_mm);
        if depends
            && (self.last.is_none_or(|(last, _)| last.direction != direction) || direction.contains(&0))
        {
            return None;
        }
        if everywhere.chord_bound_mm((end - start).amax()) > limit_mm {
            // Too long, wherever it ends.
            return None;
        }
        let target = Command { linear_mm: end, direction, ..state };
        let wanted = match foreseen {
            Some((Foreseen { directions, commands_mm: [x, y, z] }, line))
                if directions[line] == direction =>
            {
                Vector::new(x[line], y[line], z[line])
            }
            _ => self.model.command_for(&target, everywhere).ok()?,
        };

        let mut axes = [AxisWord::Omit; 3];
        let mut reached = [0.0; 3];
        for i in 0..3 {
            let programmed = block.has_axis(i).then_some(end[i] - offset[i]);
            let standing = Some(from[i] - offset[i]);
            (axes[i], reached[i]) =
                block.choose_within(i, half_step_mm[i], wanted[i] - offset[i], programmed, standing);
        }
        let to = block.machine(reached);

        let squared_mm = [
            (to - wanted).norm_squared().max((from - answer).norm_squared()),
            (wanted - end).norm_squared().max((answer - start).norm_squared()),
        ];
        let mut correction = figures(everywhere, squared_mm, [(to - from).amax(), (end - start).amax()]);
        if depends {
            // The corrected start is where an axis holds its place.
            let held = self.held(answer, from);
            correction.largest_mm = (wanted - end).norm_squared().max((held - start).norm_squared()).sqrt();
        }
        let inside = everywhere.volume.contains(&start)
            && everywhere.volume.contains(&from)
            && everywhere.volume.contains(&to);
        // Not a number is not proven either.
        if !inside || correction.after_mm.partial_cmp(&limit_mm) != Some(Ordering::Less) {
            return None;
        }
        let (stood, came) = (self.standing, self.direction);
        self.standing = [Some(to.x), Some(to.y), Some(to.z)];
        self.direction = direction;
        if depends {
            let (state, commanded) = (Command { direction, ..state }, Curve::Line(from, to));
            if self.against(&state, stood, self.standing, block).is_some()
                || self.is_astray(&state, &commanded)
            {
                (self.standing, self.direction) = (stood, came);
                return None;
            }
            self.gone(&state);
        }
        self.last = Some((target, wanted));
        Some(ShortLine { axes, correction })
    }

    /// Where the axes stand and the corrected place, where that is `start` and the last line left them there.
    #[inline]
    pub(crate) fn stands_at(&self, lines: &ShortLines, start: &Vector) -> Option<(Vector, Vector)> {
        let (last, answer) = self.last?;
        let [Some(x), Some(y), Some(z)] = self.standing else { return None };
        let from = Vector::new(x, y, z);
        let near = |i: usize| (from[i] - answer[i]).abs() <= lines.near_mm[i];
        let stands = last.linear_mm == *start
            && last.tool_mm == lines.state.tool_mm
            && last.rotary_rad == lines.state.rotary_rad
            && near(0)
            && near(1)
            && near(2);
        stands.then_some((from, answer))
    }

    /// The corrected start as [`Corrector::approach`] takes it: an axis with play that stands a little too far on its
    /// way holds its place.
    fn held(&self, mut wanted: Vector, standing: Vector) -> Vector {
        for i in 0..3 {
            if (wanted[i] - standing[i]) * f64::from(self.direction[i]) < 0.0 {
                wanted[i] = standing[i];
            }
        }
        wanted
    }
}
