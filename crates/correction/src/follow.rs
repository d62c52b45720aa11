//! What following a motion needs besides the corrector.

use machine_model::{Command, Singularity, Vector};
use toolpath::{Division, Feed};

use crate::by_commands::{Enclosed, Solved};
use crate::corrected::{Corrected, Directed};
use crate::corrector::{Corrector, Freedom};
use crate::curve::Curve;
use crate::deviation::Machine;
use crate::error::CorrectionError;
use crate::grid::Block;

/// A motion, as far as an approach to a part of it needs it.
#[derive(Clone, Copy)]
pub(crate) struct Whole {
    /// Where it starts as programmed.
    pub(crate) start: Vector,
    /// The rotary axes there, rad, where they turn on the way.
    pub(crate) rotary_rad: Option<Vector>,
    pub(crate) length_mm: f64,
    /// Rotary axes turn on the way.
    pub(crate) in_step: bool,
    /// Whether lines may be put before it.
    pub(crate) division: Division,
}

impl Whole {
    /// True where a part of the motion is its first.
    pub(crate) fn begins_with(&self, part: &Curve) -> bool {
        part.at(0.0) == self.start && part.rotary_rad(0.0) == self.rotary_rad
    }
}

/// Where the rotary axes stand in the output while a motion is written.
#[derive(Clone, Copy)]
pub(crate) struct Turning {
    pub(crate) start_deg: [f64; 3],
    pub(crate) end_deg: [f64; 3],
    /// Of each axis that a piece has turned, in steps of [`Block::rotary_decimals`] from where its words count from.
    pub(crate) written: [Option<i64>; 3],
    /// Where directions are corrected: how the axes stand.
    pub(crate) directed: Option<Standing>,
}

impl Turning {
    pub(crate) fn of(feed: &Feed) -> Self {
        let (start_deg, end_deg) = (feed.start.rotary_deg, feed.end.rotary_deg);
        Self { start_deg, end_deg, written: [None; 3], directed: None }
    }
}

/// How the rotary axes stand while a motion is written whose directions are corrected.
#[derive(Clone, Copy)]
pub(crate) struct Standing {
    /// A, B, C in the output, degrees.
    pub(crate) output_deg: [f64; 3],
    /// The tool points there where it shall.
    pub(crate) reached: bool,
    pub(crate) limits: Singularity,
}

impl Turning {
    /// Notes whether the tool points where it shall, where directions are corrected.
    pub(crate) fn note_direction(&mut self, found: &Directed) {
        if let Some(standing) = &mut self.directed {
            standing.reached = !found.held;
        }
    }
}

impl Standing {
    /// The same, rad.
    pub(crate) fn rotary_rad(&self) -> Vector {
        self.output_deg.map(f64::to_radians).into()
    }
}

/// What following a curve needs besides the corrector.
pub(crate) struct Follow<'a, 'm> {
    pub(crate) machine: Machine<'m>,
    pub(crate) block: &'a Block,
    /// The part is the whole motion, and nothing was put before it: the block's own words may stay.
    pub(crate) alone: bool,
    pub(crate) may_split: bool,
    /// The whole motion: shares are parts of its length.
    pub(crate) whole: Whole,
    /// Nominal end minus nominal start of the whole motion, mm.
    pub(crate) nominal_step: Vector,
    /// What is known of the part that an arc is tried for next.
    pub(crate) solved: Option<Solved>,
    /// What the model says of the arc whose halves are tried next.
    pub(crate) enclosed: Option<Enclosed>,
    /// Places of a line were solved together ([`Corrector::foresee_places`]).
    pub(crate) foreseen: bool,
    /// Where the rotary axes stand in the output, where they turn on the way.
    pub(crate) turning: Option<Turning>,
    /// Way of the linear axes that was written so far, mm: of turns only.
    pub(crate) commanded_mm: f64,
    /// By how much the last line that was tried turned the tool too far from its direction, rad.
    pub(crate) leans_rad: Option<f64>,
    pub(crate) corrected: &'a mut Corrected,
}

impl Follow<'_, '_> {
    /// Where the block's own words would bring the axes, as an axis command.
    ///
    /// Absolute words bring them to the nominal end; incremental ones add the nominal step to where they stand.
    pub(crate) fn own_end(&self, part: &Curve, standing: &Vector) -> Vector {
        self.block.own_end(standing, &self.nominal_step, &part.at(1.0))
    }

    /// The words of a piece: the block's own may stay where it stands for the block.
    pub(crate) fn freedom(&self, part: &Curve, hold: [bool; 3]) -> Freedom {
        let held = match part {
            Curve::Arc { .. } => [false; 3],
            _ => self.block.held(&part.at(0.0), &part.at(1.0)),
        };
        let hold = [0, 1, 2].map(|axis| hold[axis] || held[axis]);
        let freedom = Freedom::of(self.block.may_have_words()).holding(hold);
        if self.alone { freedom.keeping_words() } else { freedom }
    }

    /// The least share of a part that may be a piece of its own; above a half where it must stay one. A line in the place of an
    /// arc that is offset would be offset to other ends.
    pub(crate) fn least_share(&self, part: &Curve) -> f64 {
        let Division::Long { least_um, normal } = self.whole.division else { return 0.0 };
        let along = |axis: usize| part.at(1.0)[axis] - part.at(0.0)[axis];
        let mm = match part {
            Curve::Line(..) => {
                let [u, v] = match normal {
                    0 => [1, 2],
                    1 => [0, 2],
                    _ => [0, 1],
                };
                units::math::hypot(along(u), along(v))
            }
            Curve::Arc { sweep, radius, .. } => radius[0].min(radius[1]) * sweep.abs(),
            Curve::Turn { .. } => 0.0,
        };
        f64::from(least_um) * 1e-3 / mm.max(f64::MIN_POSITIVE)
    }

    pub(crate) fn share(&self, part: &Curve) -> f64 {
        if self.whole.length_mm > 0.0 { part.length_mm() / self.whole.length_mm } else { 1.0 }
    }
}

impl Corrector<'_> {
    /// The axis that is furthest from where it should be at the end of a part, of those that must not have a word, or at its
    /// start, of those that must not have had one before it; mm.
    fn furthest_unnamed(&self, follow: &Follow<'_, '_>, part: &Curve) -> Option<(usize, f64)> {
        let block = follow.block;
        if block.named == [true; 3] {
            return None;
        }
        let ends = [(0.0, block.named), (1.0, block.may_have_words())];
        let off = ends.into_iter().filter_map(|(s, may)| {
            let mut state = follow.machine.state;
            state.rotary_rad = part.rotary_rad(s).unwrap_or(state.rotary_rad);
            self.furthest_without_word(block, &state, part.at(s), may)
        });
        off.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Of the axes that must not have a word the one that stands furthest from where a place asks for it, mm.
    pub(crate) fn furthest_without_word(
        &self,
        block: &Block,
        state: &Command,
        place: Vector,
        may: [bool; 3],
    ) -> Option<(usize, f64)> {
        let standing = self.standing_program(block);
        let wanted = block.program(&self.solve(state, place).ok()?);
        let off = |i: usize| (wanted[i] - standing[i].unwrap_or(wanted[i])).abs();
        (0..3).filter(|i| !may[*i]).map(|i| (i, off(i))).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// An axis that the block names first: where on its way it is at a place in between, no block has said.
    pub(crate) fn guessed_own(&self, block: &Block) -> Option<usize> {
        (0..3).find(|axis| !block.incremental[*axis] && block.stated.axes[*axis] && !block.named[*axis])
    }

    /// Why a part that is off its path must not be split.
    pub(crate) fn not_to_be_split(&self, follow: &Follow<'_, '_>, distance_mm: f64) -> CorrectionError {
        let distance_um = distance_mm * 1e3;
        match self.guessed_own(follow.block) {
            Some(axis) => CorrectionError::Unnamed { axis, distance_um },
            None => CorrectionError::MustNotSplit { distance_um },
        }
    }

    /// Refuses a part where what keeps it off its path by more than `least_mm` is an axis that must not have a word.
    pub(crate) fn require_named(
        &self,
        follow: &Follow<'_, '_>,
        part: &Curve,
        least_mm: f64,
    ) -> Result<(), CorrectionError> {
        match self.furthest_unnamed(follow, part) {
            Some((axis, mm)) if mm > least_mm => {
                Err(CorrectionError::Unnamed { axis, distance_um: mm * 1e3 })
            }
            _ => Ok(()),
        }
    }
}
