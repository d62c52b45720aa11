//! Corrected feeds to programmed ones, in order.

use machine_model::{PathModel, Vector};

use super::path::{Feeding, Path, Positioning, distance, for_samples, project};
use super::{Comparison, Mismatch};

/// So many differences are kept; a program that is off in one place may be off in thousands.
const MOST_MISMATCHES: usize = 20;

/// As many limits of way may be gone back, or on, to find the motion or the place of it that a piece was made for.
pub(super) const SHORT_LIMITS: f64 = 4.0;

/// A piece that is off by no more limits than these was made for that motion all the same.
const NEARLY_LIMITS: f64 = 10.0;

pub(super) struct Matcher<'a> {
    pub(super) model: &'a dyn PathModel,
    pub(super) wanted: &'a [Feeding],
    pub(super) limit_mm: f64,
    /// The programmed motion under way.
    pub(super) at: usize,
    /// How far it is done.
    pub(super) s: f64,
    /// The programmed positioning moves that are yet to be made.
    pub(super) positionings: &'a [Positioning],
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

impl<'a> Matcher<'a> {
    pub(super) fn new(model: &'a dyn PathModel, wanted: &'a Path, limit_mm: f64, result: Comparison) -> Self {
        let Path { feeds, positionings } = wanted;
        Self { model, wanted: feeds, limit_mm, at: 0, s: 0.0, positionings, hole_by_moves: false, result }
    }

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

    /// The first motion behind the next positioning move: what comes before that move cannot be of it.
    pub(super) fn due(&self) -> usize {
        self.positionings.first().map_or(self.wanted.len(), |next| next.before.max(self.at))
    }

    /// A motion that need not be made, or not any more.
    pub(super) fn may_be_passed_over(&self, at: usize) -> bool {
        let w = &self.wanted[at];
        self.skippable(w) || (at == self.at && (1.0 - self.s) * w.length_mm <= self.limit_mm)
    }

    pub(super) fn take(&mut self, piece: &Feeding) {
        if !self.drills_anew(piece) && self.again(piece) {
            return;
        }
        let mut at = self.at;
        let mut s0 = self.s;
        let mut first: Option<(usize, Fit)> = None;
        let real = piece.tip(self.model, 1.0);
        let mut ends_where_one_goes_on = false;
        let due = self.due();
        while at < due {
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
                self.made(at, piece, &fit);
                let done = (1.0 - fit.s) * w.length_mm <= self.limit_mm;
                (self.at, self.s) = if done { (at + 1, 0.0) } else { (at, fit.s) };
                return;
            }
            ends_where_one_goes_on |= self.leads_to(w, s0.clamp(0.0, 1.0), &real);
            if first.is_none() {
                first = Some((at, fit));
            }
            if !self.may_be_passed_over(at) {
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
        let behind = || self.wanted.get(self.at).map(|w| (self.at, self.fit(w, piece, 0.0)));
        let nearly = |fit: &Fit| fit.off_mm() <= NEARLY_LIMITS * self.limit_mm;
        let Some((mut at, mut fit)) = first.or_else(|| behind().filter(|(_, fit)| nearly(fit))) else {
            self.mismatch(Mismatch::Extra { commanded_line: piece.line });
            return;
        };
        // What is under way may have ended short of its end: then the piece is of a later one.
        let under_way = at;
        if !nearly(&fit) {
            for later in under_way + 1..self.wanted.len() {
                let w = &self.wanted[later];
                let of_later = self.fit(w, piece, 0.0);
                if nearly(&of_later) {
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
        self.made(at, piece, &fit);
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

    /// Takes note that a piece was made for a motion, and of what had to come before it.
    fn made(&mut self, at: usize, piece: &Feeding, fit: &Fit) {
        self.positioned_before(at);
        self.note(at, fit.distance_mm);
        self.hole_by_moves = !piece.hole;
        let w = &self.wanted[at];
        if w.state.rotary_rad != piece.state.rotary_rad {
            self.mismatch(Mismatch::Turned { wanted_line: w.line, commanded_line: piece.line });
        }
    }

    fn note(&mut self, at: usize, distance_mm: f64) {
        self.result.after.note(distance_mm, self.wanted[at].line);
        let trace = &mut self.result.traces[at];
        trace.after_mm = trace.after_mm.max(distance_mm);
    }

    pub(super) fn mismatch(&mut self, mismatch: Mismatch) {
        if self.result.mismatches.len() < MOST_MISMATCHES {
            self.result.mismatches.push(mismatch);
        } else {
            self.result.more_mismatches += 1;
        }
    }

    /// Says that a motion was not made, or not to its end.
    pub(super) fn left_over(&mut self, at: usize) {
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

    pub(super) fn finish(mut self) -> Comparison {
        self.positioned_before(self.wanted.len());
        for at in self.at..self.wanted.len() {
            self.left_over(at);
        }
        self.result
    }
}
