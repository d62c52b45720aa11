//! Several short lines at once, side by side: what [`crate::short_line`] does with one after the other.
//!
//! Where a line ends after rounding does not depend on the line before it, so that all ends are rounded together; and what
//! bounds the worst of the lines bounds each. Where one of them is anything but ordinary, all are taken one by one.

use std::cmp::Ordering;

use machine_model::{Command, LANES, Range, Vector};
use units::decimal::nearest_whole;

use crate::corrector::{Correction, Corrector};
use crate::grid::Block;
use crate::short_line::{Foreseen, ShortLines, figures};

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
    /// Upper bounds that hold for each of them: those of [`Corrector::short_line`] are no larger.
    pub worst: Correction,
    rounding: AtEnds,
    correction: AtEnds,
    way_mm: [f64; LANES],
    programmed_mm: [f64; LANES],
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

/// The longest way of an axis on each line.
#[inline]
fn lengthen(longest: &mut [f64; LANES], places: &AtEnds) {
    for (line, longest) in longest.iter_mut().enumerate() {
        *longest = longest.max((places[line + 1] - places[line]).abs());
    }
}

impl Corrector<'_> {
    /// Corrects lines the short way, for which the model was asked by [`Corrector::foresee`]; `None`, with nothing changed,
    /// where [`Corrector::short_line`] must be asked for one after the other.
    ///
    /// Where there is an answer, it is what that would have said.
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
        let (mut way_mm, mut programmed_mm, mut holds) = ([0.0; LANES], [0.0; LANES], true);
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
            lengthen(&mut way_mm, &own.commanded);
            lengthen(&mut programmed_mm, &own.programmed);
            for (line, own) in counts.iter_mut().zip(own.counts) {
                line[axis] = own;
            }
            to[axis] = own.commanded[LANES];
        }

        // As for one line, with the worst of all.
        let most = |each: &[f64]| each.iter().copied().fold(0.0, f64::max);
        let worst =
            figures(everywhere, [most(&rounding), most(&correction)], [most(&way_mm), most(&programmed_mm)]);
        if !holds || worst.after_mm.partial_cmp(&lines.limit_mm) != Some(Ordering::Less) {
            return None;
        }
        self.standing = [Some(to.x), Some(to.y), Some(to.z)];
        self.direction = foreseen.directions[LANES - 1];
        let target = Command { linear_mm: ends[LANES].into(), direction: self.direction, ..lines.state };
        self.last =
            Some((target, Vector::new(wanted[0][LANES - 1], wanted[1][LANES - 1], wanted[2][LANES - 1])));
        self.expanding = false;
        self.remembered = None;
        Some(ShortRun { counts, worst, rounding, correction, way_mm, programmed_mm })
    }

    /// What was done with one of the lines.
    #[must_use]
    pub fn correction_of(&self, run: &ShortRun, line: usize) -> Correction {
        let Some((_, _, Some(everywhere))) = &self.everywhere else { return run.worst };
        let ends = |squared: &AtEnds| squared[line].max(squared[line + 1]);
        let squared_mm = [ends(&run.rounding), ends(&run.correction)];
        figures(everywhere, squared_mm, [run.way_mm[line], run.programmed_mm[line]])
    }
}
