//! Places of a lathe's words, in millionths of the program's unit, and what its codes say of them.

use nc_dialect::Action;
use nc_program::modal::{Modal, Units, XWords};
use units::decimal::{self, Decimal};

use crate::shorthand::Words;

/// X word and Z, in millionths of the unit.
pub(super) type Spot = [i64; 2];

/// Millionths in a unit.
pub(super) const MILLION: f64 = 1e6;

/// X and Z.
pub(super) const AXES: [u8; 2] = *b"XZ";

/// Radius and Z.
pub(super) type Point = [f64; 2];

/// What a written move is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Code {
    Rapid,
    Line,
    Clockwise,
    CounterClockwise,
    Thread,
}

/// Which codes of a dialect they are.
pub(super) const CODES: [(Action, Code); 5] = [
    (Action::Rapid, Code::Rapid),
    (Action::Line, Code::Line),
    (Action::ArcClockwise, Code::Clockwise),
    (Action::ArcCounterClockwise, Code::CounterClockwise),
    (Action::Thread, Code::Thread),
];

/// Where X and Z stand, as far as the program has said.
pub(super) fn standing(modal: &Modal) -> [Option<i64>; 2] {
    let [x, _, z] = modal.places();
    [x, z].map(|place| place.and_then(|place| within(decimal::round(place * MILLION))))
}

/// X words are diameters; `None`: not said.
pub(super) fn diameters(modal: &Modal) -> Option<bool> {
    match modal.x_words {
        XWords::Diameter => Some(true),
        XWords::Radius => Some(false),
        XWords::DiameterOfAbsolute | XWords::Unstated => None,
    }
}

/// Units of radius and Z in a millionth of the words.
fn scale(modal: &Modal) -> [f64; 2] {
    [if diameters(modal) == Some(true) { 0.5 / MILLION } else { 1.0 / MILLION }, 1.0 / MILLION]
}

/// A place in the plane of radius and Z.
pub(super) fn plane(modal: &Modal, spot: Spot) -> [f64; 2] {
    let scale = scale(modal);
    [0, 1].map(|k| spot[k] as f64 * scale[k])
}

/// The place whose words are nearest.
pub(super) fn spot(modal: &Modal, plane: [f64; 2]) -> Spot {
    let scale = scale(modal);
    [0, 1].map(|k| decimal::round(plane[k] / scale[k]))
}

impl Words<'_, '_> {
    /// True where the block names a place.
    pub(super) fn names_a_place(&self) -> bool {
        let letters: &[u8] = if self.has_increments() { b"XZUW" } else { b"XZ" };
        letters.iter().any(|letter| self.number(*letter).is_some())
    }

    /// U and W are increments.
    fn has_increments(&self) -> bool {
        self.dialect.turning.as_ref().is_some_and(|turning| turning.increments)
    }

    /// Where the words of a motion lead from a place.
    pub(super) fn target(&self, modal: &Modal, at: [Option<i64>; 2]) -> [Option<i64>; 2] {
        [0, 1].map(|axis| {
            let (own, increment) = (AXES[axis], b"UW"[axis]);
            if self.number(own).is_some() {
                let value = self.millionths(modal, own)?;
                if modal.says_places() { Some(value) } else { within(at[axis]? + value) }
            } else if self.has_increments() && self.number(increment).is_some() {
                within(at[axis]? + self.millionths(modal, increment)?)
            } else {
                at[axis]
            }
        })
    }

    /// A length word.
    pub(super) fn millionths(&self, modal: &Modal, letter: u8) -> Option<i64> {
        let (number, _) = self.number(letter)?;
        millionths(self.dialect.numbers.length(number, modal.units == Units::Inch))
    }

    /// A depth that counts least increments where it has no point, on every control (D; P and Q of depths).
    pub(super) fn depth(&self, modal: &Modal, letter: u8) -> Option<i64> {
        let (number, _) = self.number(letter)?;
        let numbers = &self.dialect.numbers;
        let step = match modal.units {
            _ if number.has_point => 0,
            Units::Inch => numbers.least_increment_decimals_inch,
            Units::Millimetre => numbers.least_increment_decimals_mm,
        };
        let Decimal { mantissa, decimals } = number.decimal;
        millionths(Decimal { mantissa, decimals: decimals + step })
    }

    /// The motion code that the block says last.
    pub(super) fn motion(&self) -> Option<Code> {
        self.actions().filter_map(|(action, _)| motion_of(action)).last()
    }

    /// True where the block says itself whose its axis words are.
    pub(super) fn owns_motion(&self) -> bool {
        self.actions().any(|(action, _)| motion_of(action).is_some() || !leaves_words(action))
    }

    /// Its G codes of a kind, as a block.
    pub(super) fn codes(&self, kind: impl Fn(&Action) -> bool) -> Vec<u8> {
        let of_kind = self.actions().filter(|(action, _)| kind(action));
        of_kind.map(|(_, span)| self.block.text(span)).collect::<Vec<_>>().join(&b' ')
    }
}

fn motion_of(action: &Action) -> Option<Code> {
    CODES.iter().find(|(of, _)| of == action).map(|(_, code)| *code)
}

/// True for codes whose words stand beside them, and are no places.
const fn owns_words(action: &Action) -> bool {
    matches!(
        action,
        Action::Dwell
            | Action::DwellBySetting
            | Action::SpeedLimit
            | Action::LimitOrPreset
            | Action::Turning(_)
            | Action::Pass { takes_words: true }
    )
}

/// True for codes at which a single pass ends: they move the frame, or the axes by rules of the control.
pub(super) fn ends_pass(action: &Action) -> bool {
    motion_of(action).is_none()
        && !owns_words(action)
        && !action.keeps_places()
        && !matches!(action, Action::Absolute | Action::Incremental)
}

/// True for codes beside which the words of a block are places.
fn leaves_words(action: &Action) -> bool {
    let frame = matches!(action, Action::WorkOffset(_) | Action::WorkOffsetNumbered | Action::Plane(_));
    !owns_words(action) && (!ends_pass(action) || frame)
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
