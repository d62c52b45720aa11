//! Drilling cycles, and the moves that they are made of.

use units::decimal::Decimal;

use crate::{FeedRate, Plane, Position};

/// What a drilling cycle does at the bottom and on the way back; what `correction` may rewrite as moves.
///
/// ```
/// use toolpath::CycleKind;
///
/// // Which cycles can be written as moves.
/// let as_moves = |kind: CycleKind| kind != CycleKind::Synchronised;
/// assert!(as_moves(CycleKind::PeckFull) && !as_moves(CycleKind::Synchronised));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleKind {
    /// G81, G82: feed in, dwell of `dwell` (the P word as written) if any, rapid out.
    Drill,
    /// G85, G89: feed in, dwell if any, feed out to R.
    Bore,
    /// G89 of LinuxCNC: feed in, dwell if any, feed out to where the cycle ends, above R under G98.
    BoreOut,
    /// G83: pecks of `peck_mm`, out to R each time.
    PeckFull,
    /// G73: pecks of `peck_mm`, a short retreat each time.
    PeckChip,
    /// G74, G76, G84, G86, G87, G88: bound to the spindle, cannot be written as moves.
    Synchronised,
}

/// A drilling cycle as it stands when a hole is made.
///
/// ```
/// use toolpath::{Cycle, CycleKind};
///
/// // G99 G83 … Q4.: how many pecks a hole of 15 mm takes.
/// let cycle = Cycle { kind: CycleKind::PeckFull, peck_mm: Some(4.0), dwell: None, return_to_initial: false };
/// assert_eq!(cycle.peck_mm.map(|peck_mm| (15.0 / peck_mm).ceil()), Some(4.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// What it does.
    pub kind: CycleKind,
    /// Peck depth Q, mm, positive.
    pub peck_mm: Option<f64>,
    /// Dwell at the bottom, P as written; none where it is zero.
    pub dwell: Option<Decimal>,
    /// G98: back to the initial level; G99: back to R.
    pub return_to_initial: bool,
}

/// One hole of a drilling cycle, along the plane's normal axis.
///
/// ```
/// use toolpath::{Cycle, CycleKind, FeedRate, Hole, Plane, Position};
///
/// // G98 G81 X50 Y20 Z-8 R2 from Z30, then the same under G99.
/// let at = |z: f64| Position { linear_mm: [50.0, 20.0, z], ..Position::default() };
/// let cycle = Cycle { kind: CycleKind::Drill, peck_mm: None, dwell: None, return_to_initial: true };
/// let hole = Hole {
///     plane: Plane::Xy,
///     start: at(30.0),
///     at_r: at(2.0),
///     bottom_mm: -8.0,
///     first: true,
///     began_mm: 30.0,
///     initial_mm: 30.0,
///     cycle,
///     rate: FeedRate::PerMinute,
/// };
/// assert_eq!(hole.end(), at(30.0));
/// assert_eq!(Hole { cycle: Cycle { return_to_initial: false, ..cycle }, ..hole }.end(), at(2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Working plane; the hole runs along its normal.
    pub plane: Plane,
    /// Where the axes are before the hole.
    pub start: Position,
    /// Position of the hole at R level.
    pub at_r: Position,
    /// Command of the normal axis at the bottom, mm.
    pub bottom_mm: f64,
    /// It begins a series of holes.
    pub first: bool,
    /// Command of the normal axis where the series of holes began, mm: R counts from there under G91.
    pub began_mm: f64,
    /// Command of the normal axis at the level G98 returns to, mm: where the series began, or R where that is higher.
    pub initial_mm: f64,
    /// The cycle's parameters.
    pub cycle: Cycle,
    /// How F is meant.
    pub rate: FeedRate,
}

/// More pecks than this in one hole are a mistake, Q without its point: a hundred millimetres deep in steps of a
/// twentieth.
pub const MOST_PECKS: f64 = 2_000.0;

impl CycleKind {
    /// Drilled in pecks of Q.
    #[must_use]
    pub const fn pecks(self) -> bool {
        matches!(self, Self::PeckFull | Self::PeckChip)
    }

    /// Q says something of it: the depth of a peck, or what is bound to the spindle.
    #[must_use]
    pub const fn takes_q(self) -> bool {
        !matches!(self, Self::Drill | Self::Bore | Self::BoreOut)
    }
}

impl Hole {
    /// Where the axes are after the hole, as programmed.
    #[must_use]
    pub fn end(&self) -> Position {
        let mut end = self.at_r;
        let normal = self.plane.axes()[2];
        if self.cycle.return_to_initial {
            // A cycle never ends below R: controls take the higher of the two.
            end.linear_mm[normal] = self.initial_mm;
        }
        end
    }

    /// How many pecks deep it is; `None` where it is drilled in one.
    #[must_use]
    pub fn pecks(&self) -> Option<f64> {
        let peck_mm = self.cycle.peck_mm.filter(|peck_mm| self.cycle.kind.pecks() && *peck_mm > 0.0)?;
        let depth_mm = (self.bottom_mm - self.at_r.linear_mm[self.plane.axes()[2]]).abs();
        Some(depth_mm / peck_mm)
    }

    /// The place on its line where the normal axis stands here, axis command.
    #[must_use]
    pub fn at(&self, mm: f64) -> Position {
        let mut place = self.at_r;
        place.linear_mm[self.plane.axes()[2]] = mm;
        place
    }

    /// The level at which it is come to, axis command of the normal axis, mm.
    ///
    /// A start below R rises first. Under G98 one below the initial level (after a hole under G99) rises to that:
    /// LinuxCNC goes across at it, and where a control would not, higher is clear too.
    #[must_use]
    pub fn above_mm(&self) -> f64 {
        let normal = self.plane.axes()[2];
        let (start, least) = (self.start.linear_mm[normal], self.end().linear_mm[normal]);
        if self.bottom_mm < self.at_r.linear_mm[normal] { start.max(least) } else { start.min(least) }
    }

    /// The moves that a control makes of it; of a cycle that is bound to the spindle those of its axes, as if it fed in
    /// and positioned out.
    ///
    /// * `pecks` – in how many it is drilled ([`whole_pecks`]); without effect on other cycles
    pub fn moves(&self, pecks: u32, retreats: PeckRetreats) -> impl Iterator<Item = HoleMove> {
        let hole = *self;
        let normal = hole.plane.axes()[2];
        let (r_mm, above_mm) = (hole.at_r.linear_mm[normal], hole.above_mm());
        let down = if hole.bottom_mm < r_mm { -1.0 } else { 1.0 };
        let deep_mm = (hole.bottom_mm - r_mm).abs();
        let pecks = if hole.pecks().is_some() { pecks } else { 1 };
        let retreat = match hole.cycle.kind {
            CycleKind::PeckFull => Retreat::Out { clearance: retreats.clearance_mm },
            _ => Retreat::Back { by: retreats.chip_mm },
        };
        let mut risen = hole.start;
        risen.linear_mm[normal] = above_mm;
        let come = [
            HoleMove::Rise { to: risen },
            HoleMove::Position { to: hole.at(above_mm) },
            HoleMove::Position { to: hole.at_r },
        ];
        let peck_mm = hole.cycle.peck_mm.unwrap_or(deep_mm);
        let pecked = strokes(peck_depths(deep_mm, peck_mm, pecks), retreat).map(move |stroke| match stroke {
            Stroke::In(mm) if mm == deep_mm => HoleMove::FeedIn { to: hole.at(hole.bottom_mm) },
            Stroke::In(mm) => HoleMove::FeedIn { to: hole.at(r_mm + down * mm) },
            Stroke::Out => HoleMove::Position { to: hole.at_r },
            Stroke::Again(mm) => HoleMove::Position { to: hole.at(r_mm + down * mm) },
        });
        let fed_out = match hole.cycle.kind {
            CycleKind::Bore => Some(hole.at_r),
            CycleKind::BoreOut => Some(hole.end()),
            _ => None,
        };
        let end = [
            hole.cycle.dwell.is_some().then_some(HoleMove::Dwell),
            fed_out.map(|to| HoleMove::FeedOut { to }),
            Some(HoleMove::Leave { to: hole.end() }),
        ];
        come.into_iter().chain(pecked).chain(end.into_iter().flatten())
    }
}

/// One stroke of a drill along its axis, by the depth below R in whatever unit.
///
/// ```
/// use toolpath::{Retreat, Stroke, peck_depths, strokes};
///
/// // 10 mm deep by 4 mm, out each time and down again to half a millimetre above what is drilled.
/// let depths = peck_depths(10.0, 4.0, 3);
/// let found: Vec<Stroke> = strokes(depths, Retreat::Out { clearance: 0.5 }).collect();
/// assert_eq!(found[..4], [Stroke::In(4.0), Stroke::Out, Stroke::Again(3.5), Stroke::In(8.0)]);
/// assert_eq!(found.last(), Some(&Stroke::In(10.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stroke {
    /// Drills down to a depth.
    In(f64),
    /// Out to R.
    Out,
    /// To above what is drilled: down again, or back from the chip.
    Again(f64),
}

/// How a drill comes back between pecks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Retreat {
    /// Out to R, and down again to so far above what is drilled.
    Out {
        /// How far.
        clearance: f64,
    },
    /// By so much: the chip breaks.
    Back {
        /// By how much.
        by: f64,
    },
}

/// The strokes of a hole whose pecks reach these depths, one behind the other.
pub fn strokes(depths: impl Iterator<Item = f64>, retreat: Retreat) -> impl Iterator<Item = Stroke> {
    let mut drilled = None;
    depths.flat_map(move |depth| {
        let back = drilled.replace(depth).map(|done: f64| match retreat {
            Retreat::Out { clearance } => (Some(Stroke::Out), Stroke::Again(done - clearance.min(done))),
            Retreat::Back { by } => (None, Stroke::Again(done - by.min(done))),
        });
        let (out, again) = back.unzip();
        out.flatten().into_iter().chain(again).chain([Stroke::In(depth)])
    })
}

/// The depths of so many even pecks, the last one at the bottom.
pub fn peck_depths(deep: f64, peck: f64, pecks: u32) -> impl Iterator<Item = f64> {
    (1..pecks).map(move |count| f64::from(count) * peck).chain([deep])
}

/// In how many pecks a hole is drilled that is so many of them deep: the last one may be shorter, by a billionth also
/// longer.
#[must_use]
pub fn whole_pecks(pecks: f64) -> u32 {
    (pecks - 1e-9).ceil().max(1.0) as u32
}

/// How far a peck goes back, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeckRetreats {
    /// A full peck (G83) resumes feeding this far above the last depth.
    pub clearance_mm: f64,
    /// A chip-breaking peck (G73) retreats by so much.
    pub chip_mm: f64,
}

/// One move of a drilling cycle.
///
/// ```
/// use toolpath::{Cycle, CycleKind, FeedRate, Hole, HoleMove, PeckRetreats, Plane, Position};
///
/// // G99 G83 X50 Y20 Z-8 R2 Q4 from Z30: in to Z-2, out to R, down again to Z-1.5, on to Z-6, …
/// let at = |z: f64| Position { linear_mm: [50.0, 20.0, z], ..Position::default() };
/// let hole = Hole {
///     plane: Plane::Xy,
///     start: at(30.0),
///     at_r: at(2.0),
///     bottom_mm: -8.0,
///     first: true,
///     began_mm: 30.0,
///     initial_mm: 30.0,
///     cycle: Cycle { kind: CycleKind::PeckFull, peck_mm: Some(4.0), dwell: None, return_to_initial: false },
///     rate: FeedRate::PerMinute,
/// };
/// assert_eq!(hole.pecks(), Some(2.5));
/// let moves: Vec<HoleMove> = hole.moves(3, PeckRetreats { clearance_mm: 0.5, chip_mm: 0.5 }).collect();
/// let fed = moves.iter().filter_map(|step| match step {
///     HoleMove::FeedIn { to } => Some(to.linear_mm[2]),
///     _ => None,
/// });
/// assert_eq!(fed.collect::<Vec<_>>(), [-2.0, -6.0, -8.0]);
/// assert_eq!(moves[5], HoleMove::Position { to: at(-1.5) });
/// assert_eq!(moves.last(), Some(&HoleMove::Leave { to: at(2.0) }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoleMove {
    /// Up to where the way across is clear, from a start below; else nowhere.
    Rise {
        /// Where it ends.
        to: Position,
    },
    /// Over the hole, down to R, and between pecks.
    Position {
        /// Where it ends.
        to: Position,
    },
    /// Drills, from where the last move ended.
    FeedIn {
        /// Where it ends.
        to: Position,
    },
    /// G4 with the cycle's P.
    Dwell,
    /// Out again at feed rate.
    FeedOut {
        /// Where it ends.
        to: Position,
    },
    /// Away from the hole.
    Leave {
        /// Where it ends.
        to: Position,
    },
}

impl HoleMove {
    /// Where it ends; `None` for a dwell.
    #[must_use]
    pub const fn end(&self) -> Option<Position> {
        match self {
            Self::Rise { to }
            | Self::Position { to }
            | Self::FeedIn { to }
            | Self::FeedOut { to }
            | Self::Leave { to } => Some(*to),
            Self::Dwell => None,
        }
    }
}
