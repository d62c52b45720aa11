//! Drilling cycles, hole by hole.

use machine_model::{Command, LANES, Vector};
use smallvec::SmallVec;
use toolpath::{CycleKind, Hole};

use crate::corrected::{Corrected, Correction};
use crate::corrector::{Corrector, MOST_TURNS};
use crate::curve::Curve;
use crate::deviation::{Begun, Machine, Pair, Verdict};
use crate::direction::heading;
use crate::error::CorrectionError;
use crate::grid::{Block, Goal, Stated};
use crate::remembered::Remembered;
use crate::{Piece, PieceKind};

/// Levels whose words are one differ by last bits, mm.
const SAME_LEVEL_MM: f64 = 1e-9;

/// A cycle that stays one block.
struct Kept {
    piece: Piece,
    /// Its words are the program's.
    untouched: bool,
    /// The programmed hole, and the one that the words drill.
    wanted: Curve,
    commanded: Curve,
    /// What the control counts its pecks along.
    pecks: Option<Curve>,
    /// How it leaves the hole at feed, if it does.
    feeds_out: Option<FedOut>,
    /// Where R is, axis command.
    r_mm: f64,
}

/// The way out of a hole at feed, from its bottom.
#[derive(Clone, Copy)]
struct FedOut {
    /// The axis along which it goes.
    normal: usize,
    /// Where it ends: as programmed, and as the words lead.
    wanted: Vector,
    commanded: Vector,
}

impl Kept {
    /// How far its hole is from the programmed one.
    fn verdict(&self, machine: &Machine<'_>, limit_mm: f64) -> Verdict {
        let Self { wanted, commanded, .. } = self;
        let verdict = Pair { wanted, commanded, in_step: false, begun: Begun::No }.verdict(machine, limit_mm);
        let pecks = self.pecks.as_ref().map(|commanded| {
            Pair { wanted, commanded, in_step: true, begun: Begun::No }.verdict(machine, limit_mm)
        });
        let worse = |one: Verdict, other: Verdict| match (one, other) {
            (Verdict::Within(a), Verdict::Within(b)) => Verdict::Within(a.max(b)),
            (Verdict::Beyond { s, distance_mm: a }, Verdict::Beyond { distance_mm: b, .. }) => {
                Verdict::Beyond { s, distance_mm: a.max(b) }
            }
            (beyond @ Verdict::Beyond { .. }, Verdict::Within(_)) | (Verdict::Within(_), beyond) => beyond,
        };
        pecks.into_iter().chain(self.out_again(machine, limit_mm)).fold(verdict, worse)
    }

    /// The same for the way out of a hole that is left at feed: on to above R, or on a machine that goes out another
    /// way than it came in.
    fn out_again(&self, machine: &Machine<'_>, limit_mm: f64) -> Option<Verdict> {
        // Back to where it came in from, the same way is proven already.
        let proven =
            |out: &FedOut| out.wanted == self.wanted.at(0.0) && !machine.model.depends_on_direction();
        let FedOut { normal, wanted, commanded } = self.feeds_out.filter(|out| !proven(out))?;
        let mut out = machine.clone();
        out.state.direction[normal] = -out.state.direction[normal];
        // While its own play is taken up the tool is late on the hole's line, which is no deviation from it.
        let bottom = Command { linear_mm: self.commanded.at(1.0), ..machine.state };
        let turned = Command { direction: out.state.direction, ..bottom };
        let late_mm = (machine.model.error_mm(&turned) - machine.model.error_mm(&bottom))[normal];
        let late = Vector::ith(normal, late_mm);
        let wanted = Curve::Line(self.wanted.at(1.0) + late, wanted + late);
        let commanded = Curve::Line(self.commanded.at(1.0), commanded);
        let pair = Pair { wanted: &wanted, commanded: &commanded, in_step: false, begun: Begun::No };
        Some(pair.verdict(&out, limit_mm))
    }

    fn with(self, correction: Correction) -> Corrected {
        Corrected::block((!self.untouched).then_some(self.piece), correction)
    }
}

/// What a cycle block says of its levels, program mm: a goal, what its word comes to, and from where that counts.
struct Levels {
    r: Goal,
    r_value: f64,
    r_origin: f64,
    bottom: Goal,
    bottom_value: f64,
    bottom_origin: f64,
}

/// A place on a hole's line, axis command.
fn on_hole(hole: &Hole, mm: f64) -> Vector {
    hole.at(mm).linear_mm.into()
}

/// What its moves ask the model for, should it be written as moves: where they lead, and where one level comes twice,
/// as it mostly does, the middle of the drilled line.
fn places(hole: &Hole) -> [Vector; LANES] {
    let r_mm = hole.at_r.linear_mm[hole.plane.axes()[2]];
    let (above, after) = (hole.above_mm(), hole.end().linear_mm[hole.plane.axes()[2]]);
    let [r, bottom, above_r, behind] = [r_mm, hole.bottom_mm, above, after].map(|mm| on_hole(hole, mm));
    let middle = Curve::Line(r, bottom).at(0.5);
    if after == r_mm || after == above {
        [r, bottom, above_r, middle]
    } else {
        [r, bottom, if above == r_mm { middle } else { above_r }, behind]
    }
}

impl<'m> Corrector<'m> {
    /// One hole: position, R level and depth move with the machine's error there.
    ///
    /// A cycle drills along one axis. Where the machine leans, the hole's middle is put in place; if its
    /// ends are then out of tolerance and the cycle is nothing but moves, it is written as moves.
    pub(crate) fn hole(&mut self, hole: &Hole, block: &Block) -> Result<Corrected, CorrectionError> {
        let normal = hole.plane.axes()[2];
        let at_r = Vector::from(hole.at_r.linear_mm);
        let at_bottom = on_hole(hole, hole.bottom_mm);
        let places = places(hole);
        let start = Vector::from(hole.start.linear_mm);
        let came = self.direction;
        self.turn_towards(&start, &at_r);
        let flat = hole.bottom_mm == at_r[normal];
        let expandable = hole.cycle.kind != CycleKind::Synchronised;
        // A further hole of a series that is written as moves: its cycle says nothing but, with play, where axes come
        // from.
        let by_moves = self.expanding && expandable && !flat && !self.model.depends_on_direction();
        let before = (self.standing, self.remembered);
        let mut turns = 0;
        let (machine, [top, bottom], kept) = loop {
            let mut machine = self.machine(block, hole.at_r.rotary_deg);
            // The depth is fed one way, whatever way the axis went before; without a depth it is as it came to R.
            machine.state.direction[normal] = heading(at_r[normal], hole.bottom_mm, self.direction[normal]);
            self.foresee_places(&machine, places);
            let (top, bottom) = (self.solve(&machine.state, at_r)?, self.solve(&machine.state, at_bottom)?);
            self.require_reachable(hole, block, &(0.5 * (top + bottom)))?;
            if by_moves {
                break (machine, [top, bottom], None);
            }
            let kept = self.keep_cycle(hole, block, (top, bottom));
            // In the plane an axis that only the correction moves comes from where the correction sends it.
            let mut reached = self.standing;
            reached[normal] = flat.then_some(kept.r_mm);
            turns += 1;
            match self.against(&machine.state, before.0, reached, block) {
                Some(against) if turns < MOST_TURNS => {
                    self.turn(against);
                    (self.standing, self.remembered) = before;
                }
                _ => break (machine, [top, bottom], Some(kept)),
            }
        };
        let down = machine.state.direction[normal];
        let mut correction = Correction {
            largest_mm: (top - at_r).norm().max((bottom - at_bottom).norm()),
            ..Correction::default()
        };
        correction.before_mm = self
            .error_before_mm(correction.largest_mm)
            .unwrap_or_else(|| machine.error(at_r).norm().max(machine.error(at_bottom).norm()));
        // Afterwards the axis has come back out of the hole.
        let out = match (self.standing[normal], &kept) {
            (Some(end), Some(kept)) if flat => heading(kept.r_mm, end, down),
            _ => -down,
        };
        self.direction[normal] = out;
        if let Some(kept) = kept
            && !(self.expanding && expandable)
        {
            let stood = self.play;
            let along = (!flat).then_some(normal);
            (correction.after_mm, correction.leaning_mm) = self.leans(&machine, block, &kept, along);
            if correction.leaning_mm.is_none() || !expandable {
                self.gone_along(&machine.state, &kept.commanded);
                self.gone(&machine.state);
                self.settle(&machine.state, block);
                return Ok(kept.with(correction));
            }
            (correction.after_mm, correction.leaning_mm) = (0.0, None);
            self.play = stood;
            self.expanding = true;
        }
        // What was tried has moved no axis, nor turned one.
        (self.standing, self.remembered) = before;
        self.direction = came;
        if let Some(remembered) = &mut self.remembered {
            remembered.as_programmed = false;
        }
        if !block.named[normal] {
            // Whether the tool stands above R, and to where it returns, no block has said in this frame.
            let distance_um = correction.largest_mm * 1e3;
            return Err(CorrectionError::Unnamed { axis: normal, distance_um });
        }
        let mut corrected = Corrected { pieces: SmallVec::new(), correction };
        self.expand(hole, block, &machine, &mut corrected)?;
        self.direction[normal] = out;
        self.settle(&machine.state, block);
        Ok(corrected)
    }

    /// Upper bound of the deviation of a cycle block from its hole, mm, and the same where it is more than the
    /// tolerance. The axes have gone to the hole then; `along`: the axis that drills it, where it has a depth.
    fn leans(
        &mut self,
        machine: &Machine<'_>,
        block: &Block,
        kept: &Kept,
        along: Option<usize>,
    ) -> (f64, Option<f64>) {
        let limit_mm = self.limit_mm(block);
        self.over_the_hole(&machine.state, kept.commanded.at(0.0), along);
        let pair =
            Pair { wanted: &kept.wanted, commanded: &kept.commanded, in_step: false, begun: Begun::No };
        let verdict = |machine: &Machine<'_>, limit_mm| {
            self.verdict_with_play(machine, &pair, kept.verdict(machine, limit_mm), limit_mm)
        };
        match verdict(machine, limit_mm) {
            Verdict::Within(bound_mm) => (bound_mm, None),
            Verdict::Beyond { distance_mm, .. } => {
                // What is said of it is a bound, not the place that was beyond; the least of some limits that holds.
                let all = Machine { everywhere: None, ..machine.clone() };
                let bound = |factor: f64| match verdict(&all, distance_mm * factor) {
                    Verdict::Within(bound_mm) => Some(bound_mm),
                    Verdict::Beyond { .. } => None,
                };
                let most_mm = [1.01, 1.1, 1.25, 1.5, 2.0, 3.0, f64::INFINITY].into_iter().find_map(bound);
                let most_mm = most_mm.unwrap_or(distance_mm).max(distance_mm);
                (most_mm, Some(most_mm))
            }
        }
    }

    /// Refuses a hole that is out of its place by an axis that must not get a word.
    fn require_reachable(&self, hole: &Hole, block: &Block, middle: &Vector) -> Result<(), CorrectionError> {
        let may = block.may_have_words();
        if may == [true; 3] {
            return Ok(());
        }
        let [first, second, _] = hole.plane.axes();
        let (standing, wanted) = (self.standing_program(block), block.program(middle));
        for axis in [first, second].into_iter().filter(|axis| !may[*axis]) {
            let off_mm = standing[axis].map_or(0.0, |standing| (wanted[axis] - standing).abs());
            if off_mm > self.limit_mm(block) {
                return Err(CorrectionError::Unnamed { axis, distance_um: off_mm * 1e3 });
            }
        }
        Ok(())
    }

    /// The axes have come to a hole. That the play along it is taken up on its first micrometres is no deviation from
    /// it: the tool is late there, in the air or where it has drilled before. Without a depth (`along`: none) nothing
    /// takes it up.
    pub(crate) fn over_the_hole(&mut self, state: &Command, at_mm: Vector, along: Option<usize>) {
        if self.model.depends_on_direction() {
            let at = Command { linear_mm: at_mm, ..*state };
            self.play.go(self.model, &at);
            if let Some(normal) = along {
                self.play.rest(self.model, &at, normal, state.direction[normal]);
            }
        }
    }

    /// The state in which the machine drills: in the plane the axes come from where they came from last.
    pub(crate) fn drilling(&self, state: &Command, normal: usize) -> Command {
        let mut direction = self.direction;
        direction[normal] = state.direction[normal];
        Command { direction, ..*state }
    }

    /// The cycle block with its words moved.
    fn keep_cycle(&mut self, hole: &Hole, block: &Block, (top, bottom): (Vector, Vector)) -> Kept {
        let [first, second, normal] = hole.plane.axes();
        let at_r = Vector::from(hole.at_r.linear_mm);
        let standing = self.standing_or(&Vector::from(hole.start.linear_mm));
        let began_mm = match self.remembered {
            Some(remembered) if !hole.first => remembered.began_mm,
            // Be it right behind another series.
            _ => standing[normal],
        };
        let standing_program = self.standing_program(block);
        // In the plane: half way between what the top and what the bottom need.
        let middle = block.program(&(0.5 * (top + bottom)));
        let step = at_r - Vector::from(hole.start.linear_mm);
        let own = block.program(&block.own_end(&standing, &step, &at_r));
        let mut axes = [Goal::Stays; 3];
        let mut reached = block.program(&standing);
        let may = block.may_have_words();
        for i in [first, second].into_iter().filter(|i| may[*i]) {
            let programmed = block.stated.axes[i].then_some(own[i]);
            (axes[i], reached[i]) = block.choose(i, middle[i], programmed, standing_program[i]);
        }
        block.complete(&mut axes, &mut reached, standing_program);
        axes[normal] = Goal::Stays;
        let Levels { r, r_value, r_origin, bottom, bottom_value, bottom_origin } =
            self.levels(hole, block, (top, bottom), began_mm);
        let r_reached = r_origin + r_value;
        axes[normal] = bottom;
        if axes.iter().all(|word| *word == Goal::Stays) && block.stated == Stated::default() {
            // A repetition at the same place, which has no block of its own yet: only an axis word drills it.
            (axes[first], reached[first]) = block.write(first, reached[first], standing_program[first]);
        }
        let untouched =
            [axes[0], axes[1], axes[2], r].iter().all(|w| matches!(w, Goal::AsStated | Goal::Stays));
        let written = [r, bottom].iter().any(|word| matches!(word, Goal::Steps(_)));
        let as_programmed = self.remembered.is_none_or(|last| last.as_programmed) && !written;
        self.remembered = Some(Remembered {
            bottom: bottom_value,
            r: r_value,
            began_mm,
            incremental: block.incremental[normal],
            as_programmed,
        });
        let mut place = reached;
        place[normal] = r_reached;
        let from = block.machine(place);
        place[normal] = bottom_origin + bottom_value;
        let to = block.machine(place);
        let pecks = hole.cycle.kind.pecks() && hole.cycle.peck_mm.is_some();
        let pecks = pecks.then(|| {
            // The control counts its pecks from R by Q, whatever the depth: where they end counts too.
            let mut unscaled = from;
            unscaled[normal] += hole.bottom_mm - at_r[normal];
            Curve::Line(from, unscaled)
        });
        let mut end = from;
        if hole.cycle.return_to_initial {
            // Never below R.
            let r_mm = from[normal];
            end[normal] =
                if hole.bottom_mm <= at_r[normal] { began_mm.max(r_mm) } else { began_mm.min(r_mm) };
        }
        self.standing = Into::<[f64; 3]>::into(end).map(Some);
        let piece = Piece::new(PieceKind::Cycle { r }, axes, 1.0);
        let (wanted, commanded) = (Curve::Line(at_r, on_hole(hole, hole.bottom_mm)), Curve::Line(from, to));
        let fed_out = match hole.cycle.kind {
            CycleKind::Bore | CycleKind::Synchronised => Some((at_r, from)),
            CycleKind::BoreOut => Some((hole.end().linear_mm.into(), end)),
            _ => None,
        };
        let feeds_out = fed_out
            .filter(|_| hole.bottom_mm != at_r[normal])
            .map(|(wanted, commanded)| FedOut { normal, wanted, commanded });
        Kept { piece, untouched, wanted, commanded, pecks, feeds_out, r_mm: from[normal] }
    }

    /// R and bottom of a cycle block: R from the initial level and the bottom from R under G91.
    ///
    /// * `began_mm` – axis command from which the series of holes began in the output
    fn levels(&self, hole: &Hole, block: &Block, (top, bottom): (Vector, Vector), began_mm: f64) -> Levels {
        let normal = hole.plane.axes()[2];
        let at_r = Vector::from(hole.at_r.linear_mm);
        let is_incremental = block.incremental[normal];
        let stands = self.standing_program(block)[normal];
        let level = |mm: f64| block.program(&on_hole(hole, mm))[normal];
        let (r_wanted, r_own) = (block.program(&top)[normal], level(at_r[normal]));
        let (b_wanted, b_own) = (block.program(&bottom)[normal], level(hole.bottom_mm));
        let (r_origin, own_r_origin) =
            if is_incremental { (level(began_mm), level(hole.began_mm)) } else { (0.0, 0.0) };
        // What the control remembers of R and bottom: what the program told it while nothing was rewritten;
        // else what this output told it last, in the same of G90 and G91. Of holes written as moves it knows nothing.
        let last = self.remembered;
        let remembered = |own: f64, told: fn(&Remembered) -> f64| match &last {
            None => Some(own).filter(|_| !self.expanding),
            Some(last) if last.as_programmed => Some(own),
            Some(last) if !last.incremental && !is_incremental => Some(told(last)),
            Some(_) => None,
        };
        let absolute = Block { incremental: [false; 3], ..block.clone() };
        let own_r = r_own - own_r_origin;
        let r_told = block.stated.radius.then_some(own_r);
        let (mut r, mut r_value) =
            absolute.choose(normal, r_wanted - r_origin, r_told, remembered(own_r, |m| m.r));
        // Where the tool stands at R and the series began higher (G98 behind G99), LinuxCNC crosses at that height,
        // but at R where it stands a micrometre above R: the correction must not decide that.
        let outward = if hole.bottom_mm <= at_r[normal] { 1.0 } else { -1.0 };
        let from_r = hole.cycle.return_to_initial
            && (hole.began_mm - at_r[normal]) * outward > 0.0
            && (hole.start.linear_mm[normal] - at_r[normal]) * outward <= 0.0;
        if let Some(stands) = stands.filter(|_| from_r)
            && (stands - r_origin - r_value) * outward > 0.5 * block.step_mm(normal)
        {
            (r, r_value) = absolute.write(normal, stands - r_origin, None);
        }
        // Where the series began at R, LinuxCNC goes down to it before it crosses once R lies a micrometre higher.
        let began = level(began_mm);
        let began_above = (hole.began_mm - at_r[normal]) * outward >= 0.0;
        if began_above && (r_origin + r_value - began) * outward > SAME_LEVEL_MM {
            (r, r_value) = absolute.write(normal, began - r_origin, None);
        }
        let b_told = block.stated.axes[normal];
        let choose_bottom = |r_value: f64| {
            let (origin, own_origin) = if is_incremental { (r_origin + r_value, r_own) } else { (0.0, 0.0) };
            let own = b_own - own_origin;
            let told = b_told.then_some(own);
            let (word, value) =
                absolute.choose(normal, b_wanted - origin, told, remembered(own, |m| m.bottom));
            (word, value, origin)
        };
        let (mut b, mut b_value, mut b_origin) = choose_bottom(r_value);
        let written = |word: Goal| matches!(word, Goal::Steps(_));
        if is_incremental && written(b) && r == Goal::Stays {
            // Under G91 controls differ in what a remembered R means beside a new bottom: both are said.
            (r, r_value) = absolute.write(normal, r_wanted - r_origin, None);
            (b, b_value, b_origin) = choose_bottom(r_value);
        }
        if is_incremental && written(r) && b == Goal::Stays {
            (b, b_value) = absolute.write(normal, b_wanted - b_origin, None);
        }
        Levels { r, r_value, r_origin, bottom: b, bottom_value: b_value, bottom_origin: b_origin }
    }
}
