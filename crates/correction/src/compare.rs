//! The closed loop: does the tool path of a corrected program follow the programmed one?
//!
//! Shares the geometry of [`Curve`] with the correction, but not its proof: paths are sampled densely
//! and matched in order, whatever blocks they come from. What it finds is therefore a lower bound of
//! the deviation; samples at most 0.5 mm apart miss less than a quarter of the slope jump of a table
//! times that length (1.5 nm for a jump of 12 µm/m).

use machine_model::{Command, PathModel, Vector};
use toolpath::{Motion, Shape};

use crate::curve::Curve;

/// One motion of a program with what the comparison must know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The motion, axis commands.
    pub motion: Motion,
    /// From gauge point to tip, mm.
    pub tool_mm: [f64; 3],
    /// Line of its file.
    pub line: u64,
}

/// A program as its motions.
pub type Program = [Step];

/// A distance and where it is largest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// The largest distance from the programmed path, mm.
    pub largest_mm: f64,
    /// Line of the programmed motion.
    pub line: u64,
}

impl Deviation {
    fn note(&mut self, distance_mm: f64, line: u64) {
        if distance_mm > self.largest_mm {
            *self = Self { largest_mm: distance_mm, line };
        }
    }
}

/// Why two programs are not the same path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mismatch {
    /// The corrected path leaves the programmed one by more than the limit.
    TooFar {
        /// Line of the programmed motion.
        wanted_line: u64,
        /// Line of the corrected motion.
        commanded_line: u64,
        /// Distance, mm.
        distance_mm: f64,
    },
    /// A programmed feed motion that the corrected program does not make.
    Missing {
        /// Its line.
        wanted_line: u64,
    },
    /// A programmed feed motion that the corrected program begins and does not end.
    Short {
        /// Its line.
        wanted_line: u64,
        /// What is left of it, mm.
        left_mm: f64,
    },
    /// A corrected feed motion that belongs to no programmed one.
    Extra {
        /// Its line.
        commanded_line: u64,
    },
}

/// What the comparison found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Feed motions programmed.
    pub wanted: usize,
    /// Feed motions commanded.
    pub commanded: usize,
    /// The programmed path run uncorrected.
    pub before: Deviation,
    /// The corrected path.
    pub after: Deviation,
    /// The first differences.
    pub mismatches: Vec<Mismatch>,
    /// How many more there are.
    pub more_mismatches: usize,
    /// Moves to a corrected start that the correction put in.
    pub approaches: usize,
    /// Every programmed feed motion, in order.
    pub traces: Vec<Trace>,
}

/// A programmed feed motion, and how far the tool is from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// Line of its file.
    pub line: u64,
    /// Where it leads, axis commands.
    pub curve: Curve,
    /// Largest distance from it where it is run uncorrected, mm.
    pub before_mm: f64,
    /// Largest distance of the corrected motions made for it, mm.
    pub after_mm: f64,
}

/// So many differences are kept; a program that is off in one place may be off in thousands.
const MOST_MISMATCHES: usize = 20;

/// Largest distance between samples, mm.
const SAMPLE_MM: f64 = 0.5;

/// As many limits of way may be gone back, or on, to find the motion or the place of it that a piece was made for.
const SHORT_LIMITS: f64 = 4.0;

/// A piece that is off by no more limits than these was made for that motion all the same.
const NEARLY_LIMITS: f64 = 10.0;

struct Feeding {
    curve: Curve,
    length_mm: f64,
    /// How far it leads from where it starts at most: less than its length for a circle.
    reach_mm: f64,
    state: Command,
    line: u64,
    /// A hole: its pecks and the way back may feed over the same line again.
    hole: bool,
}

impl Feeding {
    /// Where the tool really is, at s.
    fn tip(&self, model: &dyn PathModel, s: f64) -> Vector {
        let at = self.curve.at(s);
        at + model.error_mm(&Command { linear_mm: at, ..self.state })
    }
}

/// Where the axes are and which way they came.
#[derive(Default)]
struct Way {
    at: [Option<f64>; 3],
    direction: [i8; 3],
}

impl Way {
    /// An axis moves; from an unknown place by an unknown way.
    fn axis(&mut self, i: usize, from: Option<f64>, to: Option<f64>) {
        self.direction[i] = match (from, to) {
            (Some(from), Some(to)) if to > from => 1,
            (Some(from), Some(to)) if to < from => -1,
            (Some(_), Some(_)) => self.direction[i],
            _ => 0,
        };
        self.at[i] = to;
    }

    fn line(&mut self, from: &Vector, to: &Vector) -> [i8; 3] {
        (0..3).for_each(|i| self.axis(i, Some(from[i]), Some(to[i])));
        self.direction
    }
}

/// The feed paths of a program, in order.
fn feeding(program: &Program) -> Vec<Feeding> {
    let mut way = Way::default();
    let mut found = Vec::new();
    for step in program {
        let mut push = |curve: Curve, rotary_deg: [f64; 3], direction: [i8; 3], hole: bool| {
            let state = Command {
                linear_mm: Vector::zeros(),
                rotary_rad: Vector::from(rotary_deg.map(f64::to_radians)),
                tool_mm: step.tool_mm.into(),
                direction,
            };
            let (length_mm, reach_mm) = (curve.length_mm(), reach_mm(&curve));
            found.push(Feeding { curve, length_mm, reach_mm, state, line: step.line, hole });
        };
        match &step.motion {
            Motion::Feed(feed) => {
                let (from, to) = (feed.start.linear_mm.into(), feed.end.linear_mm.into());
                let turned = way.line(&from, &to);
                push(Curve::new(from, to, &feed.shape), feed.end.rotary_deg, turned, false);
            }
            Motion::Hole(hole) => {
                let normal = hole.plane.axes()[2];
                let top = Vector::from(hole.at_r.linear_mm);
                let mut bottom = top;
                bottom[normal] = hole.bottom_mm;
                way.line(&hole.start.linear_mm.into(), &top);
                let turned = way.line(&top, &bottom);
                way.line(&bottom, &hole.end().linear_mm.into());
                push(Curve::new(top, bottom, &Shape::Line), hole.at_r.rotary_deg, turned, true);
            }
            Motion::Rapid { start, end } => {
                for i in 0..3 {
                    way.axis(i, start.linear_mm[i], end.linear_mm[i]);
                }
            }
            // By whatever way the control takes.
            Motion::Uncorrected { end } => {
                for i in 0..3 {
                    if end.linear_mm[i].is_none() || end.linear_mm[i] != way.at[i] {
                        way.axis(i, None, end.linear_mm[i]);
                    }
                }
            }
        }
    }
    found
}

/// The largest distance from the start: sampled where it may matter, else the length, which bounds it.
fn reach_mm(curve: &Curve) -> f64 {
    const SHORT_MM: f64 = 0.2;
    let length_mm = curve.length_mm();
    if length_mm > SHORT_MM {
        return length_mm;
    }
    let start = curve.at(0.0);
    let mut reach_mm = 0.0f64;
    for_samples(curve, |s| reach_mm = reach_mm.max((curve.at(s) - start).norm()));
    reach_mm
}

/// Nearest s of a curve to a place, continuing from a known s; not limited to 0..=1.
fn project(curve: &Curve, place: &Vector, near: f64) -> f64 {
    match curve {
        Curve::Line(a, b) => {
            let step = b - a;
            let square = step.norm_squared();
            if square > 0.0 { (place - a).dot(&step) / square } else { 1.0 }
        }
        Curve::Arc { axes: [u, v, n], centre, angle, sweep, radius, ends: [start, end] } => {
            let here = units::math::atan2(place[*v] - centre[1], place[*u] - centre[0]);
            let expected = angle + sweep * near;
            let turns = ((expected - here) / std::f64::consts::TAU).round();
            let by_angle = (here + turns * std::f64::consts::TAU - angle) / sweep;
            // A steep helix is known by its height rather than by its angle: each weighs by the way it makes.
            let rise = end[*n] - start[*n];
            if rise == 0.0 {
                return by_angle;
            }
            let by_height = (place[*n] - start[*n]) / rise;
            let around = 0.5 * (radius[0] + radius[1]) * sweep;
            (by_angle * around * around + by_height * rise * rise) / (around * around + rise * rise)
        }
    }
}

fn distance(curve: &Curve, place: &Vector, s: f64) -> f64 {
    (curve.at(s.clamp(0.0, 1.0)) - place).norm()
}

/// Compares the real path of `commanded` with the programmed path of `wanted`.
///
/// `limit_mm`: what counts as too far.
#[must_use]
pub fn compare(model: &dyn PathModel, wanted: &Program, commanded: &Program, limit_mm: f64) -> Comparison {
    let (wanted, commanded) = (feeding(wanted), feeding(commanded));
    let mut result = Comparison { wanted: wanted.len(), commanded: commanded.len(), ..Comparison::default() };
    for w in &wanted {
        let mut before_mm = 0.0f64;
        for_samples(&w.curve, |s| {
            let real = w.tip(model, s);
            before_mm = before_mm.max(distance(&w.curve, &real, project(&w.curve, &real, s)));
        });
        result.before.note(before_mm, w.line);
        result.traces.push(Trace { line: w.line, curve: w.curve, before_mm, after_mm: 0.0 });
    }
    let mut matcher =
        Matcher { model, wanted: &wanted, limit_mm, at: 0, s: 0.0, hole_by_moves: false, result };
    for piece in &commanded {
        matcher.take(piece);
    }
    matcher.finish()
}

fn for_samples(curve: &Curve, mut f: impl FnMut(f64)) {
    let pieces = (curve.length_mm() / SAMPLE_MM).ceil().clamp(4.0, 20_000.0);
    let mut k = 0.0;
    while k <= pieces {
        f(k / pieces);
        k += 1.0;
    }
}

struct Matcher<'a> {
    model: &'a dyn PathModel,
    wanted: &'a [Feeding],
    limit_mm: f64,
    /// The programmed motion under way.
    at: usize,
    /// How far it is done.
    s: f64,
    /// The last hole was made by moves, among them perhaps the way back; a cycle makes its way back itself.
    hole_by_moves: bool,
    result: Comparison,
}

/// How one corrected piece lies on one programmed motion.
struct Fit {
    /// Largest distance, mm.
    distance_mm: f64,
    /// Where on the programmed motion it ends.
    s: f64,
    /// How far it runs backwards, mm.
    back_mm: f64,
    /// How far on from where the motion was it begins, mm.
    jump_mm: f64,
}

impl Fit {
    /// Near the motion and on it all the way; into and out of a hole the axis goes as often as it likes.
    fn holds(&self, w: &Feeding, limit_mm: f64) -> bool {
        self.distance_mm <= limit_mm
            && (w.hole || (self.back_mm <= limit_mm && self.jump_mm <= SHORT_LIMITS * limit_mm))
    }

    /// What is wrong with it, mm.
    fn off_mm(&self) -> f64 {
        self.distance_mm.max(self.back_mm).max(self.jump_mm)
    }
}

impl Matcher<'_> {
    fn fit(&self, w: &Feeding, piece: &Feeding, s0: f64) -> Fit {
        let mut fit = Fit { distance_mm: 0.0, s: s0, back_mm: 0.0, jump_mm: 0.0 };
        for_samples(&piece.curve, |s| {
            let real = piece.tip(self.model, s);
            let on = project(&w.curve, &real, fit.s);
            fit.distance_mm = fit.distance_mm.max(distance(&w.curve, &real, on));
            fit.back_mm = fit.back_mm.max((fit.s - on) * w.length_mm);
            if s == 0.0 {
                fit.jump_mm = (on - s0) * w.length_mm;
            }
            fit.s = on;
        });
        fit
    }

    /// Too short to need a motion of its own: the axes may not move a step.
    fn skippable(&self, w: &Feeding) -> bool {
        w.reach_mm <= self.limit_mm
    }

    fn take(&mut self, piece: &Feeding) {
        if !self.drills_anew(piece) && self.again(piece) {
            return;
        }
        let mut at = self.at;
        let mut s0 = self.s;
        let mut first: Option<(usize, Fit)> = None;
        let real = piece.tip(self.model, 1.0);
        let mut ends_where_one_goes_on = false;
        while at < self.wanted.len() {
            let w = &self.wanted[at];
            let fit = self.fit(w, piece, s0);
            if fit.holds(w, self.limit_mm) {
                // Before motions in between are passed over, what was made last has a claim to it.
                if at > self.at && self.lingers(piece) {
                    return;
                }
                if fit.jump_mm > self.limit_mm && self.ends_near_last(piece, &real) {
                    // Of a motion that is yet to be made it would leave out more than a limit.
                    self.result.approaches += 1;
                    return;
                }
                self.note(at, fit.distance_mm);
                self.hole_by_moves = !piece.hole;
                let done = (1.0 - fit.s) * w.length_mm <= self.limit_mm;
                (self.at, self.s) = if done { (at + 1, 0.0) } else { (at, fit.s) };
                return;
            }
            let skip = self.skippable(w) || (at == self.at && (1.0 - self.s) * w.length_mm <= self.limit_mm);
            ends_where_one_goes_on |= self.leads_to(w, s0.clamp(0.0, 1.0), &real);
            if first.is_none() {
                first = Some((at, fit));
            }
            if !skip {
                break;
            }
            at += 1;
            s0 = 0.0;
        }
        if self.lingers(piece) {
            return;
        }
        // A short move that ends on the last of the last motion, or where one of the next goes on, is an approach.
        if (piece.length_mm < 1.0 && ends_where_one_goes_on) || self.ends_near_last(piece, &real) {
            self.result.approaches += 1;
            return;
        }
        let Some((mut at, mut fit)) = first else {
            self.mismatch(Mismatch::Extra { commanded_line: piece.line });
            return;
        };
        // What is under way may have ended short of its end: then the piece is of a later one.
        let under_way = at;
        if fit.off_mm() > NEARLY_LIMITS * self.limit_mm {
            for later in under_way + 1..self.wanted.len() {
                let w = &self.wanted[later];
                let of_later = self.fit(w, piece, 0.0);
                if of_later.off_mm() <= NEARLY_LIMITS * self.limit_mm {
                    (at, fit) = (later, of_later);
                    break;
                }
                if !self.skippable(w) {
                    break;
                }
            }
        }
        if at > under_way {
            self.left_over(under_way);
        }
        let w = &self.wanted[at];
        self.note(at, fit.distance_mm);
        self.hole_by_moves = !piece.hole;
        if !fit.holds(w, self.limit_mm) {
            self.mismatch(Mismatch::TooFar {
                wanted_line: w.line,
                commanded_line: piece.line,
                distance_mm: fit.off_mm(),
            });
        }
        // Go on as if it had been meant for this motion, so that one bad block is one mismatch.
        (self.at, self.s) = if (1.0 - fit.s) * w.length_mm <= NEARLY_LIMITS * self.limit_mm {
            (at + 1, 0.0)
        } else {
            (at, fit.s.clamp(0.0, 1.0))
        };
    }

    /// A short move that ends on the last of the last motion.
    ///
    /// Taken for done, a motion may have a limit of way left; the pieces of that way begin a limit away from it.
    fn ends_near_last(&self, piece: &Feeding, real: &Vector) -> bool {
        let Some(w) = self.at.checked_sub(1).filter(|_| self.s == 0.0).map(|last| &self.wanted[last]) else {
            return false;
        };
        let s = project(&w.curve, real, 1.0);
        piece.length_mm < 1.0
            && (1.0 - s) * w.length_mm <= 2.0 * self.limit_mm
            && distance(&w.curve, real, s) <= self.limit_mm
    }

    /// The place is where a motion goes on, or on its way near there: the play along the way is not yet taken up.
    fn leads_to(&self, w: &Feeding, s0: f64, real: &Vector) -> bool {
        let near = |s: f64| (w.curve.at(s) - real).norm() <= self.limit_mm;
        let s = project(&w.curve, real, s0);
        near(s0) || (near(s) && (s - s0).abs() * w.length_mm <= SHORT_LIMITS * self.limit_mm)
    }

    /// The next hole, from its top, be it where the last one was.
    fn drills_anew(&self, piece: &Feeding) -> bool {
        let Some(next) = self.wanted.get(self.at).filter(|w| w.hole && self.s == 0.0) else { return false };
        let place = |s: f64| project(&next.curve, &piece.tip(self.model, s), s);
        let from = place(0.0);
        from.abs() * next.length_mm <= self.limit_mm
            && place(1.0) > from
            && self.fit(next, piece, 0.0).distance_mm <= self.limit_mm
    }

    /// A piece of motions not much longer than the limit: it lies on several of them, and was taken for a later one.
    ///
    /// What is under way stays: the pieces that follow may be of the later one, or linger too.
    fn lingers(&mut self, piece: &Feeding) -> bool {
        let mut length_mm = 0.0;
        for at in (0..self.at).rev() {
            let w = &self.wanted[at];
            length_mm += w.length_mm;
            if w.hole || length_mm > SHORT_LIMITS * self.limit_mm {
                return false;
            }
            let fit = self.fit(w, piece, 0.5);
            if fit.distance_mm <= self.limit_mm {
                self.note(at, fit.distance_mm);
                return true;
            }
        }
        false
    }

    /// A further feed in the hole just drilled: the way back of a boring cycle, a piece of it.
    fn again(&mut self, piece: &Feeding) -> bool {
        let Some(hole) = self
            .at
            .checked_sub(1)
            .map(|before| &self.wanted[before])
            .filter(|w| w.hole && self.s == 0.0 && self.hole_by_moves)
        else {
            return false;
        };
        let fit = self.fit(hole, piece, 1.0);
        if fit.distance_mm <= self.limit_mm {
            self.note(self.at - 1, fit.distance_mm);
            return true;
        }
        // Play taken up before the way back: only where it ends counts.
        let real = piece.tip(self.model, 1.0);
        let s = project(&hole.curve, &real, 1.0);
        let approach = piece.length_mm < 1.0 && distance(&hole.curve, &real, s) <= self.limit_mm;
        self.result.approaches += usize::from(approach);
        approach
    }

    fn note(&mut self, at: usize, distance_mm: f64) {
        self.result.after.note(distance_mm, self.wanted[at].line);
        let trace = &mut self.result.traces[at];
        trace.after_mm = trace.after_mm.max(distance_mm);
    }

    fn mismatch(&mut self, mismatch: Mismatch) {
        if self.result.mismatches.len() < MOST_MISMATCHES {
            self.result.mismatches.push(mismatch);
        } else {
            self.result.more_mismatches += 1;
        }
    }

    /// Says that a motion was not made, or not to its end.
    fn left_over(&mut self, at: usize) {
        let s = if at == self.at { self.s } else { 0.0 };
        let w = &self.wanted[at];
        let left_mm = ((1.0 - s) * w.length_mm).min(w.reach_mm);
        if left_mm > self.limit_mm {
            let wanted_line = w.line;
            self.mismatch(if s > 0.0 {
                Mismatch::Short { wanted_line, left_mm }
            } else {
                Mismatch::Missing { wanted_line }
            });
        }
    }

    fn finish(mut self) -> Comparison {
        for at in self.at..self.wanted.len() {
            self.left_over(at);
        }
        self.result
    }
}
