//! The tool's direction beside its tip (`--orientation full`): rotary words are corrected too. Equations (118) to (120).
//!
//! What linear axes are to tips rotary axes are to directions, with their own grid of output steps: positioning turns the
//! axes that its block names, a feed may have a word for each that the program has named. Where rotary axes then stand
//! while the tool feeds, the linear axes are corrected for a machine whose rotary axes stand aside of the programmed
//! angles ([`Aside`]); where they turn, the path is that of [`crate::Curve::Turn`], split until the direction holds too.
//!
//! Near a singularity a rotary axis would have to turn far for little. There the angles stay as programmed, and on the way
//! there and back no axis is corrected by another amount faster than it may ([`Singularity::most_share`]).

use machine_model::{Aim, Aside, Command, Held, Singularity, SolveError, Vector, aim};
use toolpath::{Division, Feed, Hole, Kinematics, Motion, Mover, Position};
use units::decimal::round;

use crate::corrected::{Corrected, Directed};
use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::directions::Stand;
use crate::error::CorrectionError;
use crate::grid::{Block, Goal};
use crate::options::Outside;
use crate::pointing::{GUARD_RAD, Leans};
use crate::{Piece, PieceKind};

/// Words that turn rotary axes, and where they then stand, degrees.
struct Turned {
    words: [Goal; 3],
    output_deg: [f64; 3],
}

impl Block {
    /// The word of a rotary axis nearest to where it shall stand, and where it then stands, degrees.
    ///
    /// * `own_deg` – where the block's own word would bring it; `None` without one that may stay
    pub(crate) fn turn(
        &self,
        axis: usize,
        wanted_deg: f64,
        stands_deg: f64,
        own_deg: Option<f64>,
    ) -> (Goal, f64) {
        let step = self.rotary_step[axis].max(1);
        let per_degree = self.per_degree(axis);
        let half_deg = 0.5 * step as f64 / per_degree * (1.0 + 1e-9);
        if let Some(own_deg) = own_deg.filter(|own| (wanted_deg - own).abs() <= half_deg) {
            return (Goal::AsStated, own_deg);
        }
        if own_deg.is_none() && (wanted_deg - stands_deg).abs() <= half_deg {
            return (Goal::Stays, stands_deg);
        }
        let origin_deg = if self.rotary_increments() { stands_deg } else { 0.0 };
        let counts = round((wanted_deg - origin_deg) * per_degree / step as f64) * step;
        (Goal::Steps(counts), origin_deg + counts as f64 / per_degree)
    }

    /// Half of the output step of a rotary axis and what rounding adds, rad.
    pub(crate) fn half_turn_step_rad(&self, axis: usize) -> f64 {
        (0.51 * self.rotary_step[axis].max(1) as f64 / self.per_degree(axis)).to_radians()
    }
}

impl<'m> Corrector<'m> {
    /// How far the output's rotary axes stand aside of the program's, degrees.
    #[must_use]
    pub fn aside_deg(&self) -> [f64; 3] {
        self.directions.aside_deg
    }

    /// Corrects a motion with the tool's direction.
    pub(crate) fn correct_directed(
        &mut self,
        motion: &Motion,
        block: &Block,
        limits: &Singularity,
    ) -> Result<Corrected, CorrectionError> {
        for axis in 0..3 {
            self.directions.named[axis] |= block.stated.rotary[axis];
        }
        match motion {
            Motion::Uncorrected { end, by } => {
                self.directions.go_elsewhere();
                let corrected = self.correct_plain(motion, block)?;
                let rotary = self.turn_alone(end.linear_mm, end.rotary_deg, *by, block, limits)?;
                self.directions.program_deg = end.rotary_deg;
                Ok(own_words(corrected, rotary.as_ref(), block))
            }
            Motion::Rapid { end, .. } => {
                self.directions.go_elsewhere();
                let rotary =
                    self.turn_alone(end.linear_mm, end.rotary_deg, Mover::RotaryWords, block, limits)?;
                self.directions.program_deg = end.rotary_deg;
                let corrected = self.correct_aside(motion, block)?;
                Ok(own_words(corrected, rotary.as_ref(), block))
            }
            Motion::Hole(hole) => self.hole_directed(motion, hole, block, limits),
            Motion::Feed(feed) => {
                self.require_directions(block)?;
                let mut corrected = if feed.start.rotary_deg == feed.end.rotary_deg {
                    self.stand_directed(motion, feed, block, limits)?
                } else {
                    self.turn_directed(motion, feed, block, limits)?
                };
                if let Some(directed) = &mut corrected.correction.directed {
                    directed.before_rad = self.leans_rad(feed, block);
                }
                self.directions.program_deg = feed.end.rotary_deg;
                Ok(corrected)
            }
        }
    }

    /// Refuses a feed of whose direction nothing is known, or that stands in a plane of its own.
    fn require_directions(&self, block: &Block) -> Result<(), CorrectionError> {
        if let Kinematics::Plane(_) = block.kinematics {
            return Err(CorrectionError::DirectionInPlane);
        }
        let plays = self.model.depends_on_direction() || self.model.has_rotary_play();
        if plays || !self.model.follows_turns() {
            return Err(CorrectionError::NoBoundsForTurns);
        }
        Ok(())
    }

    /// Largest angle of the tool's real direction from the ideal one along a feed as it is programmed, at both ends and in
    /// the middle, rad.
    pub(crate) fn leans_rad(&self, feed: &Feed, block: &Block) -> f64 {
        let whole = Curve::of(feed);
        let state = Command {
            rotary_rad: feed.end.rotary_deg.map(f64::to_radians).into(),
            tool_mm: block.tool_mm.into(),
            ..self.state(block, feed.end.rotary_deg)
        };
        let at = |s: f64| {
            let rotary_rad = whole.rotary_rad(s).unwrap_or(state.rotary_rad);
            self.model.tilt_rad(&Command { linear_mm: whole.at(s), rotary_rad, ..state })
        };
        [0.0, 0.5, 1.0].map(at).into_iter().fold(0.0, f64::max)
    }

    /// A motion while the rotary axes stand where the output has brought them.
    fn correct_aside(&mut self, motion: &Motion, block: &Block) -> Result<Corrected, CorrectionError> {
        if !self.directions.is_aside() {
            return self.correct_plain(motion, block);
        }
        let aside = Aside::new(self.model, self.directions.aside_rad());
        let mut turned: Corrector<'_> = self.clone();
        (turned.model, turned.last, turned.known, turned.everywhere) = (&aside, None, None, None);
        let corrected = turned.correct_plain(motion, block)?;
        let Corrector { standing, direction, play, approached, expanding, remembered, .. } = turned;
        (self.standing, self.direction, self.play) = (standing, direction, play);
        (self.approached, self.expanding, self.remembered) = (approached, expanding, remembered);
        (self.last, self.known, self.lead) = (None, None, None);
        Ok(corrected)
    }

    /// Where the rotary axes have to stand at a programmed place.
    ///
    /// Beyond the volume, where the correction of its nearest point is taken, that point's direction is.
    pub(crate) fn aim_at(&self, target: &Command, limits: &Singularity) -> Result<Aim, CorrectionError> {
        match aim(self.model, target, limits) {
            Err(error) if error.is_outside() && self.options.outside == Outside::Clamp => {
                let linear_mm = self.model.volume().nearest(&target.linear_mm);
                match aim(self.model, &Command { linear_mm, ..*target }, limits) {
                    Err(error) if error.is_outside() => Ok(Aim::Held(Held::BeyondTravel)),
                    other => Ok(other?),
                }
            }
            other => Ok(other?),
        }
    }

    /// Rotary words of a positioning block: those that it has, as they point the tool best where the linear axes end.
    fn turn_alone(
        &mut self,
        end_mm: [Option<f64>; 3],
        end_deg: [f64; 3],
        by: Mover,
        block: &Block,
        limits: &Singularity,
    ) -> Result<Option<Turned>, CorrectionError> {
        let stated = block.stated.rotary;
        if stated == [false; 3] {
            return Ok(None);
        }
        if by == Mover::Other {
            // Where the words lead, uncorrected.
            for axis in (0..3).filter(|axis| stated[*axis]) {
                self.directions.aside_deg[axis] = 0.0;
            }
            self.directions.stand = Stand::AsPositioned;
            return Ok(None);
        }
        let [middle, edge] = {
            let volume = self.model.volume();
            let middle = |axis: usize| 0.5 * (volume.0[axis].low + volume.0[axis].high);
            [[0, 1, 2].map(middle), volume.nearest(&Vector::zeros()).into()]
        };
        // Where it is not known, a place as good as any: each feed is proven for its own.
        let place =
            [0, 1, 2].map(|i| end_mm[i].unwrap_or(if middle[i].is_finite() { middle[i] } else { edge[i] }));
        let known = end_mm.iter().all(Option::is_some);
        let programmed_rad = Vector::from(end_deg.map(f64::to_radians));
        let linear_mm = self.model.volume().nearest(&place.into());
        let target = Command { linear_mm, rotary_rad: programmed_rad, ..self.state(block, end_deg) };
        let plane = matches!(block.kinematics, Kinematics::Plane(_));
        let aimed = if plane { Ok(Aim::Held(Held::TooFar)) } else { aim(self.model, &target, limits) };
        let (wanted_rad, mut stand) = match aimed {
            Ok(Aim::At(rad)) => (rad, if known { Stand::Reached } else { Stand::AsPositioned }),
            Ok(Aim::Held(_)) => (programmed_rad, Stand::Held),
            Err(error @ SolveError::Undefined(..)) => return Err(error.into()),
            // Nothing is cut here.
            Err(_) => (programmed_rad, Stand::AsPositioned),
        };
        let output_deg = self.directions.output_deg();
        let mut turned = Turned { words: [Goal::Stays; 3], output_deg };
        for axis in 0..3 {
            let wanted_deg = aside(end_deg[axis], wanted_rad[axis] - programmed_rad[axis]);
            if stated[axis] {
                let own_deg = self.own_deg(block, axis, end_deg[axis]);
                (turned.words[axis], turned.output_deg[axis]) =
                    block.turn(axis, wanted_deg, output_deg[axis], Some(own_deg));
                self.directions.aside_deg[axis] = turned.output_deg[axis] - end_deg[axis];
            } else if (self.directions.aside_deg[axis].to_radians()
                - (wanted_rad[axis] - programmed_rad[axis]))
                .abs()
                > block.half_turn_step_rad(axis)
                && stand == Stand::Reached
            {
                stand = Stand::AsPositioned;
            }
        }
        self.directions.stand = stand;
        Ok(Some(turned))
    }

    /// Where a block's own rotary word would bring its axis, which the program brings to `end_deg`.
    pub(crate) fn own_deg(&self, block: &Block, axis: usize, end_deg: f64) -> f64 {
        if block.rotary_increments() { end_deg + self.directions.aside_deg[axis] } else { end_deg }
    }

    /// The words of a block on which the rotary axes stand: its own, where it has some, lead to where they stand.
    fn standing_words(&self, block: &Block, rotary_deg: [f64; 3]) -> Option<Turned> {
        if !self.directions.is_aside() || block.stated.rotary == [false; 3] {
            return None;
        }
        let mut turned = Turned { words: [Goal::Stays; 3], output_deg: [0.0; 3] };
        for (axis, programmed_deg) in rotary_deg.into_iter().enumerate() {
            let stands_deg = programmed_deg + self.directions.aside_deg[axis];
            turned.output_deg[axis] = stands_deg;
            if block.stated.rotary[axis] {
                let own_deg = self.own_deg(block, axis, programmed_deg);
                turned.words[axis] = if (own_deg - stands_deg).abs() < 1e-12 {
                    Goal::AsStated
                } else {
                    block.turn(axis, stands_deg, stands_deg, Some(f64::NAN)).0
                };
            }
        }
        Some(turned)
    }

    /// A turn at the start of a motion that points the tool where it shall, put before it: where rotary axes were
    /// positioned one after the other, or elsewhere.
    pub(crate) fn lead_to(
        &mut self,
        to_rad: &Vector,
        start: &Position,
        block: &Block,
        length_mm: f64,
    ) -> Result<(), CorrectionError> {
        let programmed_rad = Vector::from(start.rotary_deg.map(f64::to_radians));
        let before = self.directions;
        let mut words = [Goal::Stays; 3];
        let mut way_mm = 0.0_f64;
        for axis in (0..3).filter(|axis| before.named[*axis]) {
            let wanted_deg = aside(start.rotary_deg[axis], to_rad[axis] - programmed_rad[axis]);
            let stands_deg = start.rotary_deg[axis] + before.aside_deg[axis];
            let reached_deg;
            (words[axis], reached_deg) = block.turn(axis, wanted_deg, stands_deg, None);
            self.directions.aside_deg[axis] = reached_deg - start.rotary_deg[axis];
            way_mm = way_mm.max((reached_deg - stands_deg).abs().to_radians() * 1000.0);
        }
        if words == [Goal::Stays; 3] {
            return Ok(());
        }
        let linear_mm = Vector::from(start.linear_mm);
        let state = self.state(block, start.rotary_deg);
        let state = Command { rotary_rad: state.rotary_rad + self.directions.aside_rad(), ..state };
        let target = self.model.same_tip_mm(&linear_mm, &state, &programmed_rad);
        let mut wanted = self.solve_afresh(&state, target)?;
        self.leave(&mut wanted, block, block.named);
        let axes = self.go(block, &linear_mm, &wanted, &crate::corrector::Freedom::of(block.named));
        self.gone(&state);
        let share = if length_mm > 0.0 { way_mm / length_mm } else { 1.0 };
        let share = share.max(block.least_share);
        self.lead = Some(Piece { kind: PieceKind::Line, axes, rotary: Some(words), share });
        Ok(())
    }

    fn solve_afresh(&self, state: &Command, nominal: Vector) -> Result<Vector, CorrectionError> {
        Ok(self.model.solve(&Command { linear_mm: nominal, ..*state })?.linear_mm)
    }

    /// A feed, or the way of a hole, on which the rotary axes stand: they may have to be turned a little before it.
    fn point_for(
        &mut self,
        whole: &Curve,
        start: &Position,
        division: Division,
        block: &Block,
        limits: &Singularity,
    ) -> Result<Directed, CorrectionError> {
        let allowed_rad = self.options.orientation_rad - GUARD_RAD;
        let state = self.state(block, start.rotary_deg);
        let held = |leans: Leans| {
            let rad = match leans {
                Leans::Within(rad) | Leans::Beyond { rad, .. } => rad,
            };
            Directed { before_rad: 0.0, after_rad: rad, held: true }
        };
        let within = |rad: f64| Directed { before_rad: 0.0, after_rad: rad, held: false };
        let as_it_stands = match self.leans_standing(whole, &state, allowed_rad) {
            Leans::Within(rad) => return Ok(within(rad)),
            beyond => beyond,
        };
        if self.directions.stand == Stand::Held {
            return Ok(held(as_it_stands));
        }
        let middle = Command { linear_mm: whole.at(0.5), ..state };
        let Aim::At(to_rad) = self.aim_at(&middle, limits)? else {
            self.directions.stand = Stand::Held;
            return Ok(held(as_it_stands));
        };
        if division == Division::Any {
            self.lead_to(&to_rad, start, block, whole.length_mm())?;
        }
        match self.leans_standing(whole, &state, allowed_rad) {
            Leans::Within(rad) => {
                self.directions.stand = Stand::Reached;
                Ok(within(rad))
            }
            Leans::Beyond { rad, .. } => Err(CorrectionError::Leans {
                leans_urad: rad * 1e6,
                allowed_urad: self.options.orientation_rad * 1e6,
            }),
        }
    }

    fn stand_directed(
        &mut self,
        motion: &Motion,
        feed: &Feed,
        block: &Block,
        limits: &Singularity,
    ) -> Result<Corrected, CorrectionError> {
        let whole = Curve::of(feed);
        let directed = self.point_for(&whole, &feed.start, feed.division, block, limits)?;
        let words = self.standing_words(block, feed.end.rotary_deg);
        let led = self.lead.is_some();
        let mut corrected = self.correct_aside(motion, block)?;
        if !led {
            corrected = own_words(corrected, words.as_ref(), block);
        }
        corrected.correction.directed = Some(directed);
        Ok(corrected)
    }

    fn hole_directed(
        &mut self,
        motion: &Motion,
        hole: &Hole,
        block: &Block,
        limits: &Singularity,
    ) -> Result<Corrected, CorrectionError> {
        self.require_directions(block)?;
        let rotary_deg = hole.at_r.rotary_deg;
        let at_r = hole.at_r.linear_mm;
        let mut words = self.turn_alone(at_r.map(Some), rotary_deg, Mover::RotaryWords, block, limits)?;
        let whole = Curve::Line(at_r.into(), hole.at(hole.bottom_mm).linear_mm.into());
        let directed = self.point_for(&whole, &hole.at_r, Division::One, block, limits)?;
        if words.is_none() {
            words = self.standing_words(block, rotary_deg);
        }
        let mut corrected = self.correct_aside(motion, block)?;
        corrected = own_words(corrected, words.as_ref(), block);
        let state = self.state(block, rotary_deg);
        let before_rad = [whole.at(0.0), whole.at(1.0)]
            .map(|linear_mm| self.model.tilt_rad(&Command { linear_mm, ..state }))
            .into_iter()
            .fold(0.0, f64::max);
        corrected.correction.directed = Some(Directed { before_rad, ..directed });
        self.directions.program_deg = rotary_deg;
        Ok(corrected)
    }
}

/// An angle with its correction, degrees: the same bits without one.
pub(crate) fn aside(programmed_deg: f64, by_rad: f64) -> f64 {
    if by_rad == 0.0 { programmed_deg } else { programmed_deg + by_rad.to_degrees() }
}

/// Puts the rotary words of a block into the first piece that stands for it; the block itself where none does.
fn own_words(mut corrected: Corrected, turned: Option<&Turned>, block: &Block) -> Corrected {
    let Some(&Turned { words, .. }) = turned else { return corrected };
    if !words.iter().any(|word| matches!(word, Goal::Steps(_))) {
        return corrected;
    }
    match corrected.pieces.first_mut() {
        Some(first) => first.rotary = Some(words),
        None => {
            let axes = block.stated.axes.map(|stated| if stated { Goal::AsStated } else { Goal::Stays });
            let (kind, rotary) = (PieceKind::AsStated, Some(words));
            corrected.pieces.push(Piece { kind, axes, rotary, share: 1.0 });
        }
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_where_rounding_would_bring_them_no_nearer() {
        let block = Block::default();
        assert_eq!(block.turn(0, 30.0004, 0.0, Some(30.0)), (Goal::AsStated, 30.0));
        assert_eq!(block.turn(0, 30.0006, 0.0, Some(30.0)), (Goal::Steps(30_001), 30.001));
        assert_eq!(block.turn(0, 30.0004, 30.0, None), (Goal::Stays, 30.0));
        let increments = Block { incremental: [true; 3], ..Block::default() };
        let (word, reached) = increments.turn(2, 30.0016, 29.0, Some(30.0));
        assert_eq!(word, Goal::Steps(1002));
        assert!((reached - 30.002).abs() < 1e-12);
    }
}
