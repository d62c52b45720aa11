//! What has to be known of a lathe's program between two blocks.

use nc_syntax::dialect::{Action, Dialect, PlaneCode, Turning, TurningCycle};
use nc_syntax::{ItemKind, Number};
use units::decimal::Decimal;

use super::{AXES, Spot};
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
    /// T brings in another offset.
    offset_in_t: bool,
}

impl State {
    pub(super) fn initial(dialect: &Dialect, turning: &Turning) -> Self {
        let mut state = Self {
            motion: Motion::Unknown,
            absolute: true,
            inch: false,
            diameters: turning.diameters,
            at: [None; 2],
            compensated: false,
            in_zx: false,
            returns_to_r: false,
            inverse_time: false,
            centres_absolute: false,
            feed: None,
            increments: turning.increments,
            offset_in_t: turning.offset_in_t,
        };
        for row in dialect.initial.iter().filter_map(|code| dialect.code(*code)) {
            state.set(&row.action, false);
        }
        state
    }

    /// What a code sets; false where the words of its block are no places of this frame.
    fn set(&mut self, action: &Action, with_places: bool) -> bool {
        match action {
            Action::Rapid => self.motion = Motion::Rapid,
            Action::Line => self.motion = Motion::Line,
            Action::ArcClockwise => self.motion = Motion::Clockwise,
            Action::ArcCounterClockwise => self.motion = Motion::CounterClockwise,
            Action::Thread => self.motion = Motion::Thread,
            Action::Inch | Action::Millimetre => {
                let inch = *action == Action::Inch;
                if self.inch != inch {
                    (self.inch, self.at) = (inch, [None; 2]);
                }
            }
            Action::DiameterOn | Action::DiameterOff | Action::DiameterOfAbsolute => {
                let diameters = match action {
                    Action::DiameterOn => Some(true),
                    Action::DiameterOff => Some(false),
                    _ => None,
                };
                if self.diameters != diameters || diameters.is_none() {
                    (self.diameters, self.at) = (diameters, [None; 2]);
                }
            }
            Action::Absolute => self.absolute = true,
            Action::Incremental => self.absolute = false,
            Action::Compensation(_) => self.compensated = true,
            Action::CompensationOff => self.compensated = false,
            Action::Dwell
            | Action::DwellBySetting
            | Action::SpeedLimit
            | Action::Pass { takes_words: true } => {
                return false;
            }
            // With S alone it moves nothing.
            Action::LimitOrPreset if !with_places => return false,
            // The words of its block are places from its zero already.
            Action::WorkOffset(_) | Action::WorkOffsetNumbered => self.moves_frame(),
            Action::Plane(plane) => self.in_zx = *plane == PlaneCode::Zx,
            Action::FeedInverseTime => self.inverse_time = true,
            Action::FeedPerMinute | Action::FeedPerRevolution => self.inverse_time = false,
            Action::ReturnInitial => self.returns_to_r = false,
            Action::ReturnR => self.returns_to_r = true,
            Action::ArcCentresAbsolute => self.centres_absolute = true,
            Action::ArcCentresIncremental => self.centres_absolute = false,
            _ if action.keeps_places() => {}
            // Whatever moves the frame, or the axes by rules of the control; a single pass ends with it.
            _ => {
                self.moves_frame();
                return false;
            }
        }
        true
    }

    fn moves_frame(&mut self) {
        self.at = [None; 2];
        if matches!(self.motion, Motion::Pass(_)) {
            self.motion = Motion::Unknown;
        }
    }

    /// After the block as it stands.
    pub(super) fn step(&mut self, words: &Words<'_, '_>) {
        let with_places = self.moves(words);
        let mut owned = true;
        for (action, _) in words.actions() {
            owned &= self.set(action, with_places);
        }
        if owned && let Some((feed, _)) = words.number(b'F') {
            self.feed = Some(feed);
        }
        let row = |number: Number| words.dialect.m_code(u16::try_from(number.integer()?).ok()?);
        let loses = words.block.items.iter().any(|item| match item.kind {
            ItemKind::Word { letter: b'M', value: nc_syntax::Value::Number(number) } => {
                row(number).is_some_and(|row| row.loses_position != [false; 3])
            }
            _ => false,
        });
        let offset = self.offset_in_t && words.number(b'T').is_some();
        if loses || offset || words.skipped() {
            self.at = [None; 2];
        }
        if owned && !words.skipped() {
            self.at = self.target(words);
        }
    }

    /// Where the words of a motion lead from here.
    pub(super) fn target(&self, words: &Words<'_, '_>) -> [Option<i64>; 2] {
        [0, 1].map(|axis| {
            let (own, increment) = (AXES[axis], b"UW"[axis]);
            let within = |place: i64| Some(place).filter(|place| place.abs() <= MOST);
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

    /// G98 and G99 of systems B and C in the block of a cycle.
    pub(super) fn set_return(&mut self, words: &Words<'_, '_>) {
        for (action, _) in words.actions() {
            match action {
                Action::ReturnInitial => self.returns_to_r = false,
                Action::ReturnR => self.returns_to_r = true,
                _ => {}
            }
        }
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
            owned &= state.set(action, true);
        }
        !owned || state.motion != Motion::Unknown
    }

    pub(super) fn stands_at(&mut self, spot: Spot) {
        self.at = spot.map(Some);
    }
}

/// Places and sizes up to 400 km, in millionths: the difference of two has 15 digits, which is what a word may have.
const MOST: i64 = 400_000_000_000_000;

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
    whole.filter(|whole| whole.unsigned_abs() <= MOST.unsigned_abs())
}
