//! The block that programs consist of by millions: coordinates of a straight feed motion and nothing else.
//!
//! In a state in which such a block can mean only one thing ([`state`]) no state needs to be copied, no code looked
//! up: the words are the end of the motion. Whatever else a block holds, or is in force, is left to
//! [`Interpreter::step`], which does the same by the long way.

use nc_syntax::dialect::GCode;
use nc_syntax::{Block, ItemKind, Number, Value};
use toolpath::{Feed, FeedRate, Position, Shape};

use crate::interpreter::{Context, Interpreter, context};
use crate::modal::{Axis, Compensation, Distance, FeedMode, Modal, MotionMode, Progress};
use crate::motion::Moved;
use crate::settings::Environment;

/// What is known of plain blocks in the state in force.
#[derive(Clone, Debug, Default)]
pub(crate) enum Plain {
    /// Not asked since the last block that was not plain.
    #[default]
    Unasked,
    /// There are none.
    No,
    /// They are feed motions of this code, in this context.
    Yes(Box<(GCode, FeedRate, Context)>),
}

/// A plain block, executed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainFeed<'i> {
    /// Its motion.
    pub feed: Feed,
    /// Which of X, Y, Z it names.
    pub names: [bool; 3],
    /// The state in which it is done: that of the last plain block, unless another kind of block came between.
    pub context: &'i Context,
}

impl Plain {
    fn of(env: &Environment<'_>, modal: &Modal) -> Self {
        let MotionMode::Line(code) = modal.motion else { return Self::No };
        let rate = match modal.feed_mode {
            // F must stand in each block.
            FeedMode::InverseTime => return Self::No,
            FeedMode::PerMinute => FeedRate::PerMinute,
            FeedMode::PerRevolution => FeedRate::PerRevolution,
        };
        let known = |axes: &[Axis; 3]| axes.iter().all(|axis| axis.known().is_some());
        let plain = modal.progress == Progress::Running
            && modal.cycle.is_none()
            && modal.distance == Distance::Absolute
            && modal.compensation == Compensation::Off
            && modal.transform.is_none()
            && modal.unsettled == [false; 3]
            && modal.frame.is_some_and(|frame| frame.is_shift())
            && known(&modal.axes.linear)
            && known(&modal.axes.rotary);
        if !plain {
            return Self::No;
        }
        let moved = Moved { repeats: 1, ..Moved::default() };
        Self::Yes(Box::new((code, rate, context(env, modal, modal, &moved, false))))
    }
}

impl Interpreter<'_> {
    /// Executes a block that is plain; `None`, with nothing done, for any other.
    ///
    /// What it says is what [`Interpreter::step`] would say: one feed motion.
    #[inline]
    pub fn plain_feed(&mut self, block: &Block<'_>) -> Option<PlainFeed<'_>> {
        if let Plain::Unasked = self.plain {
            self.plain = Plain::of(&self.env, &self.modal);
        }
        let Plain::Yes(state) = &self.plain else { return None };
        let (code, rate, context) = &**state;
        let mut words: [Option<Number>; 3] = [None; 3];
        let mut seen = 0_u32;
        for item in &block.items {
            let ItemKind::Word { letter, value: Value::Number(number) } = item.kind else { return None };
            let bit = 1 << (letter & 31);
            if seen & bit != 0 {
                return None;
            }
            seen |= bit;
            match letter {
                b'X' | b'Y' | b'Z' => words[usize::from(letter - b'X')] = Some(number),
                b'N' | b'F' => {}
                b'G' if number.tenths() == Some(code.0) => {}
                _ => return None,
            }
        }
        let numbers = &self.env.dialect.numbers;
        let inch = context.unit_mm != 1.0;
        let offset_mm = context.frame.offset_mm();
        let [Axis::At(x), Axis::At(y), Axis::At(z)] = self.modal.axes.linear else { return None };
        let [Axis::At(a), Axis::At(b), Axis::At(c)] = self.modal.axes.rotary else { return None };
        let start = Position { linear_mm: [x, y, z], rotary_deg: [a, b, c] };
        let mut end = start;
        for i in 0..3 {
            if let Some(number) = words[i] {
                end.linear_mm[i] = numbers.length(number, inch).to_f64() * context.unit_mm + offset_mm[i];
            }
        }
        let names = words.map(|word| word.is_some());
        if names == [false; 3] {
            return None;
        }
        self.modal.axes.linear = end.linear_mm.map(Axis::At);
        let feed = Feed { start, end, shape: Shape::Line, rate: *rate, may_split: true };
        Some(PlainFeed { feed, names, context })
    }
}
