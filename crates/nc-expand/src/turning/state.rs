//! What has to be known of a lathe's program between two blocks.

use nc_program::Compensation;
use nc_program::modal::{ArcCentres, Distance, FeedMode, Modal, MotionMode, ReturnLevel, Units, XWords};
use nc_syntax::Number;
use nc_syntax::dialect::{Action, Turning, TurningCycle};
use toolpath::Plane;
use units::decimal::Decimal;

use super::{AXES, MILLION, Spot};
use crate::known::{Known, places};
use crate::shorthand::Words;

/// The motion code in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Line,
    Clockwise,
    CounterClockwise,
    Thread,
    /// A single pass, which each block with a place repeats.
    Pass(TurningCycle),
    /// None, or nobody knows which.
    Unknown,
}

/// Modal facts that cycles need.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) motion: Motion,
    pub(super) absolute: bool,
    pub(super) inch: bool,
    /// X words are diameters; `None`: not said.
    pub(super) diameters: Option<bool>,
    /// Where the words of X and Z say that the tool stands, in millionths of the unit.
    pub(super) at: [Option<i64>; 2],
    /// G41 or G42 is in force.
    pub(super) compensated: bool,
    /// G18 is in force.
    pub(super) in_zx: bool,
    /// G99 of systems B and C: a drilling cycle ends at R.
    pub(super) returns_to_r: bool,
    /// G93 is in force.
    pub(super) inverse_time: bool,
    /// G90.1 is in force.
    pub(super) centres_absolute: bool,
    /// The last F, with its point or without.
    pub(super) feed: Option<Number>,
    /// U and W are increments.
    increments: bool,
}

impl State {
    /// At the start of a program.
    pub(super) fn initial(turning: &Turning, known: &Known<'_>) -> Self {
        let mut state = Self {
            motion: Motion::Unknown,
            absolute: true,
            inch: false,
            diameters: None,
            at: [None; 2],
            compensated: false,
            in_zx: false,
            returns_to_r: false,
            inverse_time: false,
            centres_absolute: false,
            feed: None,
            increments: turning.increments,
        };
        state.follow(known.modal());
        state.motion = match known.modal().motion {
            MotionMode::Rapid(_) => Motion::Rapid,
            MotionMode::Line(_) => Motion::Line,
            _ => Motion::Unknown,
        };
        state
    }

    /// Takes over what the one reader knows; motion code and feed apart, which cycles have a part in.
    pub(super) fn follow(&mut self, modal: &Modal) {
        let [x, _, z] = places(modal);
        self.at = [x, z].map(|place| place.and_then(|place| within(units::decimal::round(place * MILLION))));
        self.diameters = match modal.x_words {
            XWords::Diameter => Some(true),
            XWords::Radius => Some(false),
            XWords::DiameterOfAbsolute | XWords::Unstated => None,
        };
        self.absolute = modal.distance == Distance::Absolute;
        self.inch = modal.units == Units::Inch;
        self.compensated = modal.compensation != Compensation::Off;
        self.in_zx = modal.plane == Plane::Zx;
        self.returns_to_r = modal.return_level == ReturnLevel::R;
        self.inverse_time = modal.feed_mode == FeedMode::InverseTime;
        self.centres_absolute = modal.arc_centres == ArcCentres::Absolute;
    }

    /// What a code sets of what cycles and contours ask for within a block, or ahead of the one reader; false where the words of
    /// its block are no places.
    fn set(&mut self, action: &Action) -> bool {
        match action {
            Action::Rapid => self.motion = Motion::Rapid,
            Action::Line => self.motion = Motion::Line,
            Action::ArcClockwise => self.motion = Motion::Clockwise,
            Action::ArcCounterClockwise => self.motion = Motion::CounterClockwise,
            Action::Thread => self.motion = Motion::Thread,
            Action::Absolute => self.absolute = true,
            Action::Incremental => self.absolute = false,
            Action::Compensation(_) => self.compensated = true,
            Action::CompensationOff => self.compensated = false,
            Action::ReturnInitial => self.returns_to_r = false,
            Action::ReturnR => self.returns_to_r = true,
            Action::Dwell
            | Action::DwellBySetting
            | Action::SpeedLimit
            | Action::LimitOrPreset
            | Action::Turning(_)
            | Action::Pass { takes_words: true } => return false,
            _ if action.keeps_places() => {}
            // Whatever moves the frame, or the axes by rules of the control, ends a single pass.
            _ => {
                if matches!(self.motion, Motion::Pass(_)) {
                    self.motion = Motion::Unknown;
                }
                return matches!(
                    action,
                    Action::WorkOffset(_) | Action::WorkOffsetNumbered | Action::Plane(_)
                );
            }
        }
        true
    }

    /// The codes that may stand beside a cycle, and hold for its block.
    pub(super) fn settings(&mut self, words: &Words<'_, '_>) {
        for (action, _) in words.actions().filter(|(action, _)| may_stand_beside(action)) {
            self.set(action);
        }
    }

    /// After the block as it stands, as far as nothing but lines and arcs is concerned.
    pub(super) fn step(&mut self, words: &Words<'_, '_>) {
        let mut owned = true;
        for (action, _) in words.actions() {
            owned &= self.set(action);
        }
        if owned {
            self.feed = words.number(b'F').map(|(feed, _)| feed).or(self.feed);
            self.at = self.target(words);
        }
    }

    /// Where the words of a motion lead from here.
    pub(super) fn target(&self, words: &Words<'_, '_>) -> [Option<i64>; 2] {
        [0, 1].map(|axis| {
            let (own, increment) = (AXES[axis], b"UW"[axis]);
            if words.number(own).is_some() {
                let value = self.length(words, own)?;
                if self.absolute { Some(value) } else { within(self.at[axis]? + value) }
            } else if self.increments && words.number(increment).is_some() {
                within(self.at[axis]? + self.length(words, increment)?)
            } else {
                self.at[axis]
            }
        })
    }

    /// A length word in millionths of the unit.
    pub(super) fn length(&self, words: &Words<'_, '_>, letter: u8) -> Option<i64> {
        let (number, _) = words.number(letter)?;
        millionths(words.dialect.numbers.length(number, self.inch))
    }

    /// A depth that counts least increments where it has no point, on every control (D; P and Q of depths).
    pub(super) fn depth(&self, words: &Words<'_, '_>, letter: u8) -> Option<i64> {
        let (number, _) = words.number(letter)?;
        let numbers = &words.dialect.numbers;
        let step = if self.inch {
            numbers.least_increment_decimals_inch
        } else {
            numbers.least_increment_decimals_mm
        };
        let Decimal { mantissa, decimals } = number.decimal;
        let step = if number.has_point { 0 } else { step };
        millionths(Decimal { mantissa, decimals: decimals + step })
    }

    /// True where the block names a place.
    pub(super) fn moves(&self, words: &Words<'_, '_>) -> bool {
        let letters: &[u8] = if self.increments { b"XZUW" } else { b"XZ" };
        letters.iter().any(|letter| words.number(*letter).is_some())
    }

    /// True where the block says itself whose its axis words are.
    pub(super) fn owns_motion(&self, words: &Words<'_, '_>) -> bool {
        let mut state = Self { motion: Motion::Unknown, ..self.clone() };
        let mut owned = true;
        for (action, _) in words.actions() {
            owned &= state.set(action);
        }
        !owned || state.motion != Motion::Unknown
    }

    pub(super) fn stands_at(&mut self, spot: Spot) {
        self.at = spot.map(Some);
    }
}

/// Places and sizes up to 400 km, in millionths: the difference of two has 15 digits, which is what a word may have.
const MOST: i64 = 400_000_000_000_000;

fn within(place: i64) -> Option<i64> {
    Some(place).filter(|place| place.unsigned_abs() <= MOST.unsigned_abs())
}

/// True for codes that set something for the block of a cycle and those behind it, and move nothing.
pub(super) const fn may_stand_beside(action: &Action) -> bool {
    matches!(
        action,
        Action::FeedPerMinute
            | Action::FeedPerRevolution
            | Action::Absolute
            | Action::Incremental
            | Action::ReturnInitial
            | Action::ReturnR
            | Action::Plane(_)
            | Action::CompensationOff
            | Action::Pass { takes_words: false }
    )
}

/// A decimal number in millionths, finer digits rounded; `None` where it is no place of any machine.
pub(super) fn millionths(Decimal { mantissa, decimals }: Decimal) -> Option<i64> {
    let shift = 6_i32 - i32::from(decimals);
    let power = 10_i64.checked_pow(shift.unsigned_abs())?;
    let whole = if shift >= 0 {
        mantissa.checked_mul(power)
    } else {
        // Half a millionth is 0.013 um of an inch, far below the step of any control.
        Some((mantissa + mantissa.signum() * (power / 2)) / power)
    };
    whole.and_then(within)
}
