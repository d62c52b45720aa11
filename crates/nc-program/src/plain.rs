//! The line that programs consist of by millions: coordinates of a straight feed motion and nothing else.
//!
//! In a state in which such a line can mean only one thing ([`PlainFeeds`]) no state needs to be copied, no code looked
//! up: the words are the end of the motion. Whatever else a block holds, or is in force, is left to
//! [`crate::Interpreter::step`], which does the same by the long way.

use nc_dialect::Numbers;
use nc_syntax::{GCode, PlainLine, PlainWord};
use toolpath::{Division, Feed, FeedRate, Frame, Position, Shape};
use units::decimal::Decimal;

use crate::context::{Context, context};
use crate::environment::Environment;
use crate::modal::{Axis, Compensation, Distance, FeedMode, LastFeed, Modal, MotionMode, Naming, Progress};
use crate::moved::Moved;

/// What is known of plain lines in the state in force.
#[derive(Clone, Debug, Default)]
pub(crate) enum Plain {
    /// Not asked since the last block that was not plain.
    #[default]
    Unasked,
    /// There are none.
    No,
    /// They are feed motions.
    Yes(Box<PlainFeeds>),
}

/// What plain lines mean in the state in force: feed motions, one a line.
#[derive(Clone, Debug)]
pub struct PlainFeeds {
    /// The state in which they are done.
    pub context: Context,
    /// Where the rotary axes stand, degrees.
    pub rotary_deg: [f64; 3],
    code: GCode,
    rate: FeedRate,
    numbers: Numbers,
    inch: bool,
    offset_mm: [f64; 3],
    distance: Distance,
}

/// The end of a plain line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlainEnd {
    /// X, Y, Z in axis commands, mm.
    pub end_mm: [f64; 3],
    /// Which of them the line names.
    pub names: [bool; 3],
    /// Some of them without a decimal point.
    pub bare: bool,
    /// Its F.
    pub feed: Option<Decimal>,
}

impl Plain {
    pub(crate) fn of(env: &Environment<'_>, modal: &Modal) -> Self {
        let MotionMode::Line(code) = modal.motion else { return Self::No };
        let rate = match modal.feed_mode {
            // F must stand in each block.
            FeedMode::InverseTime => return Self::No,
            FeedMode::PerMinute => FeedRate::PerMinute,
            FeedMode::PerRevolution => FeedRate::PerRevolution,
        };
        let known = |axes: &[Axis; 3]| axes.iter().all(|axis| axis.known().is_some());
        let plain = modal.progress == Progress::Running
            && env.dialect.turning.is_none()
            && modal.aside.is_none()
            && modal.cycle.is_none()
            && modal.compensation == Compensation::Off
            && modal.offset.is_off()
            && modal.transform.is_none()
            && modal.unsettled == [false; 3]
            && modal.last_feed != LastFeed::Inverse
            && !modal.edge_unsaid
            && modal.named == [Naming::Named; 3]
            && modal.frame.as_ref().is_some_and(Frame::is_shift)
            && known(&modal.axes.linear);
        let [Axis::At(a), Axis::At(b), Axis::At(c)] = modal.axes.rotary else { return Self::No };
        if !plain {
            return Self::No;
        }
        let moved = Moved { repeats: 1, ..Moved::default() };
        let context = context(env, modal, modal, &moved);
        Self::Yes(Box::new(PlainFeeds {
            rotary_deg: [a, b, c],
            code,
            rate,
            numbers: env.dialect.numbers.clone(),
            inch: context.unit_mm != 1.0,
            offset_mm: context.frame.offset_mm(),
            distance: modal.distance,
            context,
        }))
    }
}

impl PlainFeeds {
    /// Where a plain line leads from `start_mm`; `None` for one that is no feed motion.
    ///
    /// What it says is what [`crate::Interpreter::step`] would say.
    #[must_use]
    #[inline]
    pub fn end_of(&self, line: &PlainLine<'_>, start_mm: [f64; 3]) -> Option<PlainEnd> {
        // Each axis by itself: what is stored by a number found out is waited for when all are read together.
        let ([mut x, mut y, mut z], mut names) = (start_mm, [false; 3]);
        let (mut bare, mut feed) = (false, None);
        for word in line.words() {
            match word.letter() {
                b'X' => (x, names[0]) = (self.place(word, 0, x, &mut bare), true),
                b'Y' => (y, names[1]) = (self.place(word, 1, y, &mut bare), true),
                b'Z' => (z, names[2]) = (self.place(word, 2, z, &mut bare), true),
                b'F' => feed = Some(word.number().decimal),
                b'G' if word.number().tenths() != Some(self.code.0) => return None,
                _ => {}
            }
        }
        (names != [false; 3]).then_some(PlainEnd { end_mm: [x, y, z], names, bare, feed })
    }

    /// Where a word brings its axis from `start_mm`, mm.
    #[inline]
    fn place(&self, word: &PlainWord, axis: usize, start_mm: f64, bare: &mut bool) -> f64 {
        let number = word.number();
        *bare |= !number.has_point;
        let value_mm = self.numbers.length(number, self.inch).to_f64() * self.context.unit_mm;
        match self.distance {
            Distance::Absolute => value_mm + self.offset_mm[axis],
            Distance::Incremental => start_mm + value_mm,
        }
    }

    /// The motion of a plain line.
    #[must_use]
    pub fn feed(&self, start_mm: [f64; 3], end_mm: [f64; 3]) -> Feed {
        let at = |linear_mm| Position { linear_mm, rotary_deg: self.rotary_deg };
        Feed {
            start: at(start_mm),
            end: at(end_mm),
            shape: Shape::Line,
            rate: self.rate,
            division: Division::Any,
        }
    }
}
