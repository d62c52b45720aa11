//! Rotary axes that turn while the tool feeds: their words where a motion is split, and what the motion comes to.
//!
//! The path of such a motion is what an ideal machine of the chain makes of it ([`crate::Curve::Turn`]); all else is as for a
//! line. Rotary words are corrected under [`crate::Orientation::Full`] alone ([`crate::orientation`]). Where a motion is split
//! they are rounded, and the linear axes are told what brings the tip to its place with the angles as they are written.

use machine_model::{Command, Move, Turn, Vector};
use toolpath::Feed;

use crate::corrected::Turned;
use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::error::CorrectionError;
use crate::follow::{Follow, Turning};
use crate::grid::{Block, Goal};

/// So far rotary axes turn at most between places where the error before correction is asked for, rad.
const BEFORE_RAD: f64 = 0.05;

/// Words for the rotary axes at the end of a part, and where they then stand.
pub(crate) struct RotaryWords {
    pub(crate) words: [Goal; 3],
    pub(crate) end_rad: Vector,
    pub(crate) turning: Turning,
    /// With them the tool points where it shall, but for rounding, or nobody asked for that.
    pub(crate) reached: bool,
}

impl Block {
    /// Steps of [`Block::rotary_decimals`] in a degree.
    pub(crate) fn per_degree(&self, axis: usize) -> f64 {
        f64::from(10u32.pow(u32::from(self.rotary_decimals[axis].min(9))))
    }

    /// The step of an axis' words, rad.
    pub(crate) fn rotary_step_rad(&self, axis: usize) -> f64 {
        (self.rotary_step[axis].max(1) as f64 / self.per_degree(axis)).to_radians()
    }

    /// True under G91.
    pub(crate) fn rotary_increments(&self) -> bool {
        self.incremental == [true; 3]
    }

    /// Where from an axis' words count, degrees.
    fn rotary_origin(&self, turning: &Turning, axis: usize) -> f64 {
        if self.rotary_increments() { turning.start_deg[axis] } else { 0.0 }
    }
}

impl Follow<'_, '_> {
    /// The words that bring the rotary axes to the end of a part; `None` where none turns.
    pub(crate) fn rotary_words(&self, part: &Curve) -> Option<RotaryWords> {
        let (mut turning, programmed_rad) = (self.turning?, part.rotary_rad(1.0)?);
        let whole_end = Vector::from(turning.end_deg.map(f64::to_radians));
        let (block, first) = (self.block, self.corrected.pieces.is_empty());
        let (mut words, mut end_rad) = ([Goal::Stays; 3], programmed_rad);
        for axis in 0..3 {
            let own = block.stated.rotary[axis];
            let (from, to) = (turning.start_deg[axis], turning.end_deg[axis]);
            if from == to {
                if own && first {
                    words[axis] = Goal::AsStated;
                }
                continue;
            }
            let (origin, per_degree) = (block.rotary_origin(&turning, axis), block.per_degree(axis));
            let before = turning.written[axis];
            if programmed_rad == whole_end {
                words[axis] = match before.filter(|_| block.rotary_increments()) {
                    Some(before) => Goal::Steps(units::decimal::round((to - origin) * per_degree) - before),
                    None => Goal::AsStated,
                };
                continue;
            }
            let step = block.rotary_step[axis].max(1);
            let steps = (programmed_rad[axis].to_degrees() - origin) * per_degree / step as f64;
            let counts = units::decimal::round(steps) * step;
            if before != Some(counts) {
                let since = if block.rotary_increments() { before.unwrap_or(0) } else { 0 };
                words[axis] = Goal::Steps(counts - since);
            }
            turning.written[axis] = Some(counts);
            end_rad[axis] = (origin + counts as f64 / per_degree).to_radians();
        }
        Some(RotaryWords { words, end_rad, turning, reached: true })
    }
}

impl Corrector<'_> {
    /// Refuses what has no bounds while rotary axes turn.
    pub(crate) fn require_turns(&self) -> Result<(), CorrectionError> {
        if self.model.follows_turns() { Ok(()) } else { Err(CorrectionError::NoBoundsForTurns) }
    }

    /// Refuses a piece whose rotary words turn the tool away from its direction by more than is allowed.
    pub(crate) fn require_direction(&self, turn: &Turn) -> Result<(), CorrectionError> {
        let (slip_rad, allowed_rad) = (turn.slip_rad(), self.options.orientation_rad);
        if slip_rad <= allowed_rad {
            return Ok(());
        }
        Err(CorrectionError::Direction { slip_urad: slip_rad * 1e6, allowed_urad: allowed_rad * 1e6 })
    }

    /// What a motion comes to that was written with a way of so many mm of the linear axes.
    pub(crate) fn turned(
        &self,
        whole: &Curve,
        block: &Block,
        feed: &Feed,
        commanded_mm: f64,
        pieces: usize,
    ) -> Turned {
        let turned_deg = [0, 1, 2].map(|axis| feed.end.rotary_deg[axis] - feed.start.rotary_deg[axis]);
        Turned {
            programmed_mm: whole.linear_mm(),
            commanded_mm,
            rounding_mm: 2.0 * block.rounding_mm() * pieces.max(1) as f64,
            turned_deg: Vector::from(turned_deg).norm(),
        }
    }

    /// Upper bound of the deviation that a motion with rotary axes would have had uncorrected, mm.
    pub(crate) fn before_turning_mm(&self, whole: &Curve, state: &Command) -> f64 {
        let Some((from, to)) = whole.rotary_rad(0.0).zip(whole.rotary_rad(1.0)) else { return 0.0 };
        let parts = ((to - from).abs().sum() / BEFORE_RAD).ceil().clamp(1.0, 1e4);
        let error = |s: f64| {
            let rotary_rad = whole.rotary_rad(s).unwrap_or(from);
            self.model.error_mm(&Command { linear_mm: whole.at(s), rotary_rad, ..*state }).norm()
        };
        let mut at_start = error(0.0);
        let mut worst = at_start;
        for k in 0..parts as u32 {
            let (s0, s1) = (f64::from(k) / parts, f64::from(k + 1) / parts);
            let extent = whole.extent(s0, s1);
            let ends = [s0, s1].map(|s| whole.rotary_rad(s).unwrap_or(from));
            let between = self.model.chord_bound_mm(&Move {
                range_mm: extent.range,
                speed_mm: extent.speed,
                acceleration_mm: extent.acceleration,
                passes: 1,
                state: *state,
                turn: Some(Turn {
                    programmed_rad: ends,
                    commanded_rad: ends,
                    lag_rad: [state.rotary_play.lag_rad; 2],
                }),
            });
            let at_end = error(s1);
            let own = at_start.max(at_end) + if between.is_finite() { between } else { 0.0 };
            (worst, at_start) = (worst.max(own), at_end);
        }
        worst
    }
}
