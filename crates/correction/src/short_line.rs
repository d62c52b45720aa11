//! The motion that programs consist of by millions: short straight lines that go on where the last one ended.
//!
//! What is written is what [`crate::line`] would write, word for word: the same answer of the model, rounded the same
//! way. Only the proof is shorter: bounds that hold everywhere in the volume are looked up instead of being
//! worked out for this stretch. Where they do not suffice the long way is taken.
//!
//! Lines go side by side in lanes, each with a mask of the axes that it names, and as many as are proven from the first
//! on are done.

use std::array::from_fn;

use machine_model::{Command, Everywhere, LANES, Vector};
use units::decimal::nearest_whole;

use crate::corrected::Correction;
use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::direction::heading;
use crate::grid::{Block, Goal};

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
fn figures(everywhere: &Everywhere, squared_mm: [f64; 2], ways_mm: [f64; 2]) -> Correction {
    // At an end the tool is off by the rounding of its command, and what that changes in the error. The error at a place
    // is its correction, but for what the error changes over the correction.
    let [rounded, largest_mm] = squared_mm.map(f64::sqrt);
    let [after_mm, before_mm] = [(rounded, ways_mm[0]), (largest_mm, ways_mm[1])]
        .map(|(end, way)| with_its_error(everywhere, end) + everywhere.chord_bound_mm(way));
    Correction { largest_mm, before_mm, after_mm, ..Correction::default() }
}

/// What is the same for short lines that follow one another.
#[derive(Clone, Copy, Debug)]
pub struct ShortLines {
    /// Tool and rotary axes; place and directions are not used.
    state: Command,
    offset_mm: [f64; 3],
    limit_mm: f64,
    /// An axis this near to a corrected place stands there.
    near_mm: [f64; 3],
    half_step_mm: [f64; 3],
    /// Words are increments.
    incremental: bool,
    /// The error depends on the direction of motion.
    depends: bool,
}

/// Lines that follow each other, in axis commands.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Where the first one starts.
    pub start_mm: [f64; 3],
    /// Where each ends; lanes without a line hold the end of the last.
    pub ends_mm: &'a [[f64; 3]; LANES],
    /// Which of X, Y, Z each has a word for.
    pub names: [[bool; 3]; LANES],
    /// How many lines there are.
    pub count: usize,
}

/// Lines that were corrected the short way: one block of output each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortRun {
    /// How many there are, from the first on.
    pub count: usize,
    /// By line what X, Y, Z become, in output steps; `None` for words that stay or are not there.
    pub counts: [[Option<i64>; 3]; LANES],
    /// Upper bounds that hold for each of them.
    pub worst: Correction,
    rounding: AtEnds,
    correction: AtEnds,
    way_mm: [f64; LANES],
    programmed_mm: [f64; LANES],
    /// Of the corrections at the starts, where an axis with play may hold its place.
    starts: [f64; LANES],
}

impl ShortRun {
    /// The words of a line that has some for these axes.
    pub(crate) fn words(&self, line: usize, names: [bool; 3]) -> [Goal; 3] {
        from_fn(|i| match (self.counts[line][i], names[i]) {
            (Some(counts), _) => Goal::Steps(counts),
            (None, true) => Goal::AsStated,
            (None, false) => Goal::Stays,
        })
    }
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
    /// No number is too large.
    ordinary: [bool; LANES],
}

/// Whole numbers below are told apart with room to spare.
const LARGEST: f64 = 1e15;

impl AxisRun {
    /// Rounds the ends; `programmed`, `wanted` and the first of `commanded` are given. Where a line ends does not depend on the
    /// line before it, but for an axis that has no word.
    #[inline]
    fn round(&mut self, lines: &ShortLines, block: &Block, axis: usize, names: [bool; LANES]) {
        let (offset, half) = (lines.offset_mm[axis], lines.half_step_mm[axis]);
        let (mut steps, mut keeps, mut rounded) = ([0.0; LANES], [false; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let (wanted, programmed) = (self.wanted[lane + 1] - offset, self.programmed[lane + 1] - offset);
            let exact = block.steps(axis, wanted);
            steps[lane] = nearest_whole(exact);
            keeps[lane] = (wanted - programmed).abs() <= half;
            rounded[lane] = block.steps_mm(axis, steps[lane]) + offset;
            self.commanded[lane + 1] = if keeps[lane] { programmed + offset } else { rounded[lane] };
            self.ordinary[lane] = exact.abs() < LARGEST;
        }
        for lane in 0..LANES {
            if !names[lane] {
                // The axis stays where it stands if that is as near as a word would bring it.
                let standing = self.commanded[lane] - offset;
                keeps[lane] = (self.wanted[lane + 1] - offset - standing).abs() <= half;
                self.commanded[lane + 1] = if keeps[lane] { standing + offset } else { rounded[lane] };
            }
            if !keeps[lane] {
                self.counts[lane] = Some(steps[lane] as i64);
            }
        }
    }

    /// The same where words are increments: each counts from where the line before has brought the axis.
    #[inline]
    fn round_increments(&mut self, lines: &ShortLines, block: &Block, axis: usize, names: [bool; LANES]) {
        let (offset, half) = (lines.offset_mm[axis], lines.half_step_mm[axis]);
        for (lane, named) in names.into_iter().enumerate() {
            let standing = self.commanded[lane] - offset;
            let wanted = self.wanted[lane + 1] - offset;
            let by_own_word =
                (self.commanded[lane] + (self.programmed[lane + 1] - self.programmed[lane])) - offset;
            let stays = if named { by_own_word } else { standing };
            let exact = block.steps(axis, wanted - standing);
            let steps = nearest_whole(exact);
            let keeps = (wanted - stays).abs() <= half;
            let reached = if keeps { stays } else { standing + block.steps_mm(axis, steps) };
            self.commanded[lane + 1] = reached + offset;
            self.ordinary[lane] = exact.abs() < LARGEST;
            if !keeps {
                self.counts[lane] = Some(steps as i64);
            }
        }
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

/// The largest.
#[inline]
fn most(each: &[f64]) -> f64 {
    each.iter().copied().fold(0.0, f64::max)
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
    /// What short lines need that are like `block` but for what they state; `None` where there are none.
    #[inline]
    pub fn short_lines(&mut self, block: &Block, rotary_deg: [f64; 3]) -> Option<ShortLines> {
        self.heed(block, rotary_deg);
        let incremental = block.incremental == [true; 3];
        let ordinary = (incremental || block.incremental == [false; 3])
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
            incremental,
            depends: self.model.depends_on_direction(),
        })
    }

    /// Corrects lines the short way, as many as are proven from the first on; `None`, with nothing changed, where the first
    /// must be given to [`Corrector::correct`]. What is done is what that would have said.
    #[inline]
    pub fn short_run(&mut self, lines: &ShortLines, block: &Block, run: &Run<'_>) -> Option<ShortRun> {
        let Some((_, _, Some(everywhere))) = &self.everywhere else { return None };
        if lines.depends && !self.play.is_certain() {
            // By how much the tool may be off for that has to be said.
            return None;
        }
        let (from, answer) = self.stands_at(lines, &run.start_mm.into())?;
        let came = if lines.depends { self.last?.0.direction } else { self.direction };
        let [a, b, c, d] = *run.ends_mm;
        let ends = [run.start_mm, a, b, c, d];
        let mut programmed_mm = [0.0; LANES];
        (0..3).for_each(|axis| lengthen(&mut programmed_mm, &ends.map(|end| end[axis])));
        let (mut direction, mut count) = (self.direction, run.count);
        let mut directions = [direction; LANES];
        for lane in 0..LANES {
            direction = turned(direction, &ends[lane], &ends[lane + 1]);
            directions[lane] = direction;
            if lines.depends && (direction != came || direction.contains(&0)) {
                count = count.min(lane);
            }
        }
        let too_long = |way_mm: f64| everywhere.chord_bound_mm(way_mm) > lines.limit_mm;
        if too_long(most(&programmed_mm)) {
            // Wherever it ends.
            count = programmed_mm[..count].iter().take_while(|way_mm| !too_long(**way_mm)).count();
        }
        if count == 0 {
            return None;
        }
        let wanted = self.model.commands_for(run.ends_mm, &directions, &lines.state, everywhere)?;

        let mut counts = [[None; 3]; LANES];
        let (mut rounding, mut correction): (AtEnds, AtEnds) = Default::default();
        let (mut way_mm, mut holds) = ([0.0; LANES], [true; LANES]);
        let mut commanded = [[0.0; LANES + 1]; 3];
        for axis in 0..3 {
            let mut own = AxisRun {
                programmed: ends.map(|end| end[axis]),
                wanted: behind(answer[axis], &wanted[axis]),
                commanded: [from[axis]; LANES + 1],
                counts: [None; LANES],
                ordinary: [true; LANES],
            };
            let names = run.names.map(|names| names[axis]);
            if lines.incremental {
                own.round_increments(lines, block, axis, names);
            } else {
                own.round(lines, block, axis, names);
            }
            let (near_mm, range) = (lines.near_mm[axis], &everywhere.volume.0[axis]);
            let mut stands = [true; LANES + 1];
            for at in 0..=LANES {
                let (off, by) = (own.commanded[at] - own.wanted[at], own.wanted[at] - own.programmed[at]);
                rounding[at] += off * off;
                correction[at] += by * by;
                // In the volume, and as near to the corrected place as lines ask for that start there.
                stands[at] = off.abs() <= near_mm
                    && range.contains(own.commanded[at])
                    && range.contains(own.programmed[at]);
            }
            for lane in 0..LANES {
                holds[lane] &= own.ordinary[lane] && stands[lane] && stands[lane + 1];
                counts[lane][axis] = own.counts[lane];
            }
            lengthen(&mut way_mm, &own.commanded);
            commanded[axis] = own.commanded;
        }
        let stands = |at: usize| commanded.each_ref().map(|axis| axis[at]);

        let squared_mm = [most(&rounding), most(&correction)];
        let worst = figures(everywhere, squared_mm, [most(&way_mm), most(&programmed_mm)]);
        let starts = from_fn(|lane| correction[lane]);
        let mut found =
            ShortRun { count, counts, worst, rounding, correction, way_mm, programmed_mm, starts };
        // Not a number is not proven either.
        let proven = |correction: &Correction| correction.after_mm < lines.limit_mm;
        if !(proven(&worst) && holds == [true; LANES]) {
            let each = (0..count).take_while(|lane| holds[*lane] && proven(&found.of(everywhere, *lane)));
            found.count = each.count();
        }
        if lines.depends {
            let places: [Vector; LANES + 1] = from_fn(|at| stands(at).into());
            found.starts = from_fn(|lane| {
                // The corrected start is where an axis holds its place.
                let answer =
                    if lane == 0 { answer } else { Vector::from_fn(|axis, _| wanted[axis][lane - 1]) };
                (held(answer, places[lane], came) - Vector::from(ends[lane])).norm_squared()
            });
            found.worst.largest_mm = worst.largest_mm.max(most(&found.starts).sqrt());
            found.count = self.go_short_ways(lines, block, came, &places[..=found.count]);
        }
        let last = found.count.checked_sub(1)?;
        self.standing = stands(found.count).map(Some);
        self.direction = directions[last];
        let target =
            Command { linear_mm: ends[found.count].into(), direction: self.direction, ..lines.state };
        self.last = Some((target, Vector::from_fn(|axis, _| wanted[axis][last])));
        self.expanding = false;
        self.remembered = None;
        Some(found)
    }

    /// What was done with one of the lines.
    #[must_use]
    pub fn correction_of(&self, run: &ShortRun, line: usize) -> Correction {
        match &self.everywhere {
            Some((_, _, Some(everywhere))) => run.of(everywhere, line),
            _ => run.worst,
        }
    }

    /// Leads the axes through their play, from place to place; how often none was on another side than it is computed for.
    fn go_short_ways(
        &mut self,
        lines: &ShortLines,
        block: &Block,
        direction: [i8; 3],
        places: &[Vector],
    ) -> usize {
        let state = Command { direction, ..lines.state };
        let stood = (self.standing, self.direction);
        self.direction = direction;
        for (done, ends) in places.windows(2).enumerate() {
            let before = self.standing;
            self.standing = Into::<[f64; 3]>::into(ends[1]).map(Some);
            if self.against(&state, before, self.standing, block).is_some()
                || self.is_astray(&state, &Curve::Line(ends[0], ends[1]))
            {
                (self.standing, self.direction) = if done == 0 { stood } else { (before, direction) };
                return done;
            }
            self.gone(&state);
        }
        places.len() - 1
    }

    /// Where the axes stand and the corrected place, where that is `start` and the last line left them there.
    #[inline]
    fn stands_at(&self, lines: &ShortLines, start: &Vector) -> Option<(Vector, Vector)> {
        let (last, answer) = self.last?;
        let [Some(x), Some(y), Some(z)] = self.standing else { return None };
        let from = Vector::new(x, y, z);
        let near = |i: usize| (from[i] - answer[i]).abs() <= lines.near_mm[i];
        let stands = last.linear_mm == *start
            && last.tool_mm == lines.state.tool_mm
            && last.datum == lines.state.datum
            && last.rotary_rad == lines.state.rotary_rad
            && near(0)
            && near(1)
            && near(2);
        stands.then_some((from, answer))
    }
}

/// The corrected start as [`Corrector::approach`] takes it: an axis with play that stands a little too far on its way holds
/// its place.
fn held(mut wanted: Vector, standing: Vector, direction: [i8; 3]) -> Vector {
    for i in 0..3 {
        if (wanted[i] - standing[i]) * f64::from(direction[i]) < 0.0 {
            wanted[i] = standing[i];
        }
    }
    wanted
}

impl ShortRun {
    /// The figures of a line.
    fn of(&self, everywhere: &Everywhere, line: usize) -> Correction {
        let ends = |squared: &AtEnds| squared[line].max(squared[line + 1]);
        let squared_mm = [ends(&self.rounding), ends(&self.correction)];
        let mut figures = figures(everywhere, squared_mm, [self.way_mm[line], self.programmed_mm[line]]);
        figures.largest_mm = self.starts[line].max(self.correction[line + 1]).sqrt();
        figures
    }
}
