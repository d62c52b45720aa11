//! Several short lines at once, side by side: what [`crate::short_line`] does with one after the other.
//!
//! Where a line ends after rounding does not depend on the line before it, so that all ends are rounded together; and what
//! bounds the worst of the lines bounds each. Where one of them is anything but ordinary, all are taken one by one.

use std::cmp::Ordering;

use machine_model::{Command, LANES, Range, Vector};
use units::decimal::nearest_whole;

use crate::corrector::Corrector;
use crate::grid::Block;
use crate::short_line::{Foreseen, ShortLines, with_its_error};

/// Lines that follow each other, in axis commands.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Where the first one starts.
    pub start_mm: [f64; 3],
    /// Where each ends.
    pub ends_mm: &'a [[f64; 3]; LANES],
    /// Which of X, Y, Z each has a word for.
    pub names: [[bool; 3]; LANES],
}

/// Lines that were corrected together: one block of output each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortRun {
    /// By line what X, Y, Z become, in output steps; `None` for words that stay or are not there.
    pub counts: [[Option<i64>; 3]; LANES],
    /// The largest distance between programmed and corrected command at an end, mm.
    pub largest_mm: f64,
    /// The first line that has it.
    pub largest: usize,
}

/// A number for where the first line starts and for the end of each.
type AtEnds = [f64; LANES + 1];

/// One axis of all lines.
struct AxisRun {
    /// Where the lines lead, and the answers of the model.
    programmed: AtEnds,
    wanted: AtEnds,
    /// Where the axis stands.
    commanded: AtEnds,
    counts: [Option<i64>; LANES],
    /// No word has to be added, and no number is too large.
    ordinary: bool,
}

impl AxisRun {
    /// Rounds the ends; `programmed`, `wanted` and the first of `commanded` are given.
    #[inline]
    fn round(&mut self, lines: &ShortLines, block: &Block, axis: usize, names: [bool; LANES]) {
        /// Whole numbers below are told apart with room to spare.
        const LARGEST: f64 = 1e15;
        let (offset, half) = (lines.offset_mm[axis], lines.half_step_mm[axis]);
        let (mut steps, mut keeps) = ([0.0; LANES], [false; LANES]);
        for lane in 0..LANES {
            let (wanted, programmed) = (self.wanted[lane + 1] - offset, self.programmed[lane + 1] - offset);
            let exact = block.steps(axis, wanted);
            steps[lane] = nearest_whole(exact);
            keeps[lane] = (wanted - programmed).abs() <= half;
            let rounded = block.steps_mm(axis, steps[lane]);
            self.commanded[lane + 1] = if keeps[lane] { programmed } else { rounded } + offset;
            self.ordinary &= exact.abs() < LARGEST;
        }
        for lane in 0..LANES {
            if !names[lane] {
                // The axis stays where it stands if that is as near as a word would bring it.
                let standing = self.commanded[lane] - offset;
                self.ordinary &= (self.wanted[lane + 1] - offset - standing).abs() <= half;
                self.commanded[lane + 1] = standing + offset;
            } else if !keeps[lane] {
                self.counts[lane] = Some(steps[lane] as i64);
            }
        }
    }

    /// All places lie in the volume, and the axis stands as near to the corrected ends as lines ask for that start there.
    #[inline]
    fn holds(&self, near_mm: f64, range: &Range) -> bool {
        let mut holds = self.ordinary;
        for at in 0..=LANES {
            holds &= (self.commanded[at] - self.wanted[at]).abs() <= near_mm
                && range.contains(self.commanded[at])
                && range.contains(self.programmed[at]);
        }
        holds
    }
}

/// What holds at the start, and at the ends.
#[inline]
fn behind(start: f64, ends: &[f64; LANES]) -> AtEnds {
    let [a, b, c, d] = *ends;
    [start, a, b, c, d]
}

/// The longest way from end to end.
#[inline]
fn longest(places: &AtEnds, so_far: f64) -> f64 {
    (0..LANES).fold(so_far, |longest, at| longest.max((places[at + 1] - places[at]).abs()))
}

impl Corrector<'_> {
    /// Corrects lines the short way, for which the model was asked by [`Corrector::foresee`]; `None`, with nothing changed,
    /// where [`Corrector::short_line`] must be asked for one after the other.
    ///
    /// Where there is an answer, it is what that would have said, and none of the lines would have raised a bound told
    /// before.
    #[inline]
    pub fn short_run(
        &mut self,
        lines: &ShortLines,
        block: &Block,
        run: &Run<'_>,
        foreseen: &Foreseen,
    ) -> Option<ShortRun> {
        let Some((_, _, Some(everywhere))) = &self.everywhere else { return None };
        if lines.depends {
            return None;
        }
        let (from, answer) = self.stands_at(lines, &run.start_mm.into())?;
        let wanted = &foreseen.commands_mm;
        let [a, b, c, d] = *run.ends_mm;
        let ends = [run.start_mm, a, b, c, d];

        let mut counts = [[None; 3]; LANES];
        let (mut rounding, mut correction): (AtEnds, AtEnds) = Default::default();
        let (mut way_mm, mut programmed_mm, mut holds) = (0.0, 0.0, true);
        let mut to = from;
        for axis in 0..3 {
            let mut own = AxisRun {
                programmed: ends.map(|end| end[axis]),
                wanted: behind(answer[axis], &wanted[axis]),
                commanded: [from[axis]; LANES + 1],
                counts: [None; LANES],
                ordinary: true,
            };
            own.round(lines, block, axis, run.names.map(|names| names[axis]));
            holds &= own.holds(lines.near_mm[axis], &everywhere.volume.0[axis]);
            for at in 0..=LANES {
                let (off, by) = (own.commanded[at] - own.wanted[at], own.wanted[at] - own.programmed[at]);
                rounding[at] += off * off;
                correction[at] += by * by;
            }
            way_mm = longest(&own.commanded, way_mm);
            programmed_mm = longest(&own.programmed, programmed_mm);
            for (line, own) in counts.iter_mut().zip(own.counts) {
                line[axis] = own;
            }
            to[axis] = own.commanded[LANES];
        }

        // As for one line, with the worst of all.
        let rounded = rounding.into_iter().fold(0.0, f64::max).sqrt();
        let after_mm = with_its_error(everywhere, rounded) + everywhere.chord_bound_mm(way_mm);
        let most = correction.into_iter().fold(0.0, f64::max);
        let largest_mm = most.sqrt();
        let before_mm =
            with_its_error(everywhere, largest_mm) + everywhere.chord_bound_of_four_passes_mm(programmed_mm);
        let proven = after_mm.partial_cmp(&lines.limit_mm) == Some(Ordering::Less);
        if !holds || !proven || after_mm > self.told_mm[1] || before_mm > self.told_mm[0] {
            return None;
        }
        self.standing = [Some(to.x), Some(to.y), Some(to.z)];
        self.direction = foreseen.directions[LANES - 1];
        let target = Command { linear_mm: ends[LANES].into(), direction: self.direction, ..lines.state };
        self.last =
            Some((target, Vector::new(wanted[0][LANES - 1], wanted[1][LANES - 1], wanted[2][LANES - 1])));
        self.expanding = false;
        self.remembered = None;
        let end = correction.iter().position(|correction| *correction >= most).unwrap_or(0);
        Some(ShortRun { counts, largest_mm, largest: end.saturating_sub(1) })
    }
}
