//! What the cycles of a lathe hold from block to block.

use std::collections::BTreeMap;

use nc_dialect::{Dialect, TurningCycle};

use super::place::Spot;
use crate::came::Came;
use crate::shorthand::Words;

/// Indices of blocks by their N, and whether all of one N stand in one place of the source.
pub(super) type Numbers = BTreeMap<i64, (Vec<usize>, bool)>;

/// The blocks that have an N, or had one in the source.
pub(super) fn numbers(blocks: &[Came<'_>], dialect: &Dialect) -> Numbers {
    let mut numbers = Numbers::new();
    for (index, came) in blocks.iter().enumerate() {
        let own = Words::of(came, dialect).number(b'N');
        let number = own.map_or(came.from.number.map(i64::from), |(number, _)| number.integer());
        let Some(number) = number else { continue };
        let (indices, one_place) = numbers.entry(number).or_insert((Vec::new(), true));
        let place = |index: usize| (blocks[index].from.file, blocks[index].from.offset);
        *one_place &= indices.last().is_none_or(|last| place(*last) == place(index));
        indices.push(index);
    }
    numbers
}

/// What a pass holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    pub(super) cycle: TurningCycle,
    /// Where each pass starts and ends.
    pub(super) start: Spot,
    /// Where the cut ends; `None`: not named yet.
    pub(super) to: [Option<i64>; 2],
    /// R: millionths of the unit, of radius or Z.
    pub(super) taper: i64,
}

/// What the blocks without P and Q said.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FirstBlocks {
    /// Depth of cut of G71 and G72, millionths of the unit, radius.
    pub(super) depth: [Option<i64>; 2],
    /// Escape of G71 and G72.
    pub(super) escape: [Option<i64>; 2],
    /// Relief of G73 along radius and Z.
    pub(super) relief: Option<[i64; 2]>,
    /// Cuts of G73.
    pub(super) cuts: Option<i64>,
    /// Return of G74 and G75.
    pub(super) peck_return: [Option<i64>; 2],
    /// What the first block of G76 says.
    pub(super) thread: Option<ThreadSettings>,
}

/// What the first block of a thread says; lengths are millionths of the unit, radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThreadSettings {
    pub(super) finishing_passes: i64,
    pub(super) chamfer_leads: f64,
    pub(super) tip_deg: f64,
    pub(super) least: i64,
    pub(super) allowance: i64,
}
