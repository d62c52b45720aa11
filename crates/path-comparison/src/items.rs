//! A program as a row of items: feeds, positioning moves, deeds; cycles as the moves a control makes of them.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use machine_model::{Command, Models, PathModel, Placement, Play, Vector, turned_by_mm};
use smallvec::SmallVec;
use toolpath::{Bezier, Feed, FeedRate, Kinematics, Motion, Partial, PeckRetreats, Position, Shape};

use crate::feeding::{Feeding, Left};
use crate::offset;
use crate::others::{Others, behind_a_switch, has_play};
use crate::positioning::{Kind, Positioning};
use crate::process::Process;
use crate::step::Pointing;
use crate::stretch::{LEVER_MM, POINTING_LEVER_MM, Place, Stretch, TURN_LEVER_MM};
use crate::way::Way;
use crate::{Act, Step};

/// A curve by control points is compared as lines that lie beside it by no more, mm.
const CURVE_MM: f64 = 2e-5;

/// What is done once, by its number.
pub(crate) struct Deed {
    pub(crate) number: u32,
    pub(crate) line: u64,
    pub(crate) process: Process,
}

pub(crate) enum Item {
    Feed(Box<Feeding>),
    Position(Box<Positioning>),
    Deed(Deed),
}

impl Item {
    pub(crate) fn line(&self) -> u64 {
        match self {
            Self::Feed(feed) => feed.line,
            Self::Position(position) => position.line,
            Self::Deed(deed) => deed.line,
        }
    }
}

/// Which of both paths of a program is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// The one as programmed, and how far off it is run uncorrected.
    Wanted,
    /// The one on which the machine really goes.
    Commanded,
}

/// Where the programmed holes with pecks are, and how many pecks they have.
pub(crate) type Counted = Rc<RefCell<VecDeque<(Vector, u32)>>>;

/// The items of a program, made as they are asked for.
pub(crate) struct Items<'m, I> {
    steps: I,
    pub(crate) role: Role,
    pub(crate) retreats: PeckRetreats,
    pub(crate) model: &'m dyn PathModel,
    models: Models<'m>,
    /// Of which of them `model` is one.
    kinematics: Kinematics,
    /// Where the axes stand in their play; `None` where the model knows none.
    pub(crate) play: Option<Play>,
    /// Where the last motion has brought the axes.
    pub(crate) at: Partial,
    /// Where it has brought the path that is compared.
    pub(crate) place: Option<Place>,
    pub(crate) counted: Counted,
    pub(crate) ready: VecDeque<Item>,
    /// Machines that go the same way, and how densely: [`crate::courses`].
    pub(crate) others: Option<Others<'m>>,
    /// Directions are compared, and may be off so far.
    pub(crate) pointing: Option<Pointing>,
    /// Feeds in a row under cutter compensation, those that go on from one another being one.
    compensated: u32,
    /// The last of them, where it may be a piece of a longer one.
    offset: Option<Feed>,
    /// Feed motions so far, a hole being one.
    pub(crate) feeds: usize,
    pub(crate) limit_mm: f64,
}

/// What the items of one step have in common.
#[derive(Clone, Copy)]
pub(crate) struct Common {
    pub(crate) line: u64,
    pub(crate) process: Process,
    pub(crate) limit_mm: f64,
    pub(crate) tool_mm: Vector,
    pub(crate) datum: Placement,
    pub(crate) dwell: Option<u32>,
}

impl Common {
    pub(crate) fn command(&self, linear_mm: Vector, rotary_rad: Vector) -> Command {
        Command {
            linear_mm,
            rotary_rad,
            tool_mm: self.tool_mm,
            datum: self.datum,
            direction: [0; 3],
            ..Default::default()
        }
    }
}

impl<'m, I: Iterator<Item = Step>> Items<'m, I> {
    pub(crate) fn new(
        models: Models<'m>,
        steps: I,
        role: Role,
        retreats: PeckRetreats,
        counted: Counted,
    ) -> Self {
        let model = models.axes;
        let play = has_play(model).then(Play::unknown);
        Self {
            steps,
            role,
            retreats,
            model,
            models,
            kinematics: Kinematics::Axes,
            play,
            at: Partial::default(),
            place: None,
            counted,
            ready: VecDeque::new(),
            others: None,
            pointing: None,
            compensated: 0,
            offset: None,
            feeds: 0,
            limit_mm: 0.0,
        }
    }

    /// The same, and what other machines make of it.
    pub(crate) fn with_others(mut self, others: Others<'m>) -> Self {
        self.others = Some(others);
        self
    }

    /// The item so many behind the next.
    pub(crate) fn peek(&mut self, ahead: usize) -> Option<&mut Item> {
        while self.ready.len() <= ahead {
            let step = self.steps.next()?;
            self.take(&step);
        }
        self.ready.get_mut(ahead)
    }

    /// The feed so many behind the next item, where it is one.
    pub(crate) fn feed(&mut self, ahead: usize) -> Option<&mut Feeding> {
        match self.peek(ahead) {
            Some(Item::Feed(feed)) => Some(feed),
            _ => None,
        }
    }

    /// Takes a positioning move of micrometres for a feed, so that a run goes on over it; false where it is none.
    pub(crate) fn smooth(&mut self, ahead: usize, process: Process) -> bool {
        let Some(item) = self.peek(ahead) else { return false };
        let Item::Position(position) = item else { return false };
        let [Some(from), Some(to)] = position.places else { return false };
        if !position.is_small() {
            return false;
        }
        let stretch = Stretch::new(from, to, None);
        *item = Item::Feed(Box::new(Feeding {
            reach_mm: stretch.length_mm(),
            stretches: SmallVec::from_slice(&[stretch]),
            left: Left::default(),
            line: position.line,
            process,
            minutes: None,
            limit_mm: position.limit_mm,
            airy: [true; 2],
            way: None,
            off_mm: 0.0,
            made_off_mm: 0.0,
            made_line: None,
            made: Vec::new(),
            course: None,
            pointing: None,
            leans_at_most_rad: SmallVec::new(),
            leans_rad: 0.0,
            made_leans_rad: 0.0,
        }));
        true
    }

    pub(crate) fn pop(&mut self) -> Option<Item> {
        self.peek(0)?;
        self.ready.pop_front()
    }

    /// A motion under compensation goes on from the one before it, as a piece of the same block for the control.
    fn goes_on(&mut self, motion: &Motion) -> bool {
        let Motion::Feed(feed) = motion else {
            self.offset = None;
            return false;
        };
        self.offset.replace(*feed).is_some_and(|before| offset::goes_on(&before, feed))
    }

    fn take(&mut self, step: &Step) {
        let Step { act, line, process: number, limit_mm, compensated, pointing } = *step;
        self.pointing = pointing;
        let (motion, tool_mm, datum, kinematics, feed, [dwell, cycle]) = match act {
            Act::Deed(deed) => {
                let process = Process::of_number(number);
                self.ready.push_back(Item::Deed(Deed { number: deed, line, process }));
                return;
            }
            Act::Motion { motion, tool_mm, datum, kinematics, feed, dwell, cycle } => {
                (motion, Vector::from(tool_mm), datum, kinematics, feed, [dwell, cycle])
            }
        };
        if kinematics != self.kinematics {
            self.switch(kinematics);
        }
        if !compensated {
            (self.compensated, self.offset) = (0, None);
        } else if !self.goes_on(&motion) {
            self.compensated += 1;
        }
        let block = Some(self.compensated).filter(|_| compensated && matches!(motion, Motion::Feed(_)));
        let is_timed = motion.inverse_time().is_some();
        let process = Process { number, feed, is_timed, compensated: block, cycle };
        let common = Common { line, process, limit_mm, tool_mm, datum, dwell };
        self.feeds += usize::from(matches!(motion, Motion::Feed(_) | Motion::Hole(_)));
        match motion {
            Motion::Feed(Feed { start, end, shape: Shape::Bezier(curve), rate, .. }) => {
                self.along_a_curve(&common, [start, end], &curve, rate);
            }
            Motion::Feed(feed) => self.feeding(&common, Way::of(&feed), feed.rate, [false; 2]),
            Motion::Rapid { start, end } => self.positioning(&common, start, end, Kind::Rapid),
            Motion::Uncorrected { end, .. } => self.positioning(&common, self.at, end, Kind::Uncorrected),
            Motion::Hole(hole) => self.hole(&common, &hole),
        }
    }

    /// A curve by control points, as so many lines that they are it but for [`CURVE_MM`]: where its parameter runs unevenly no
    /// parabola of it says what is near.
    fn along_a_curve(
        &mut self,
        common: &Common,
        [start, end]: [Position; 2],
        curve: &Bezier,
        rate: FeedRate,
    ) {
        let mut from = start;
        let (from_mm, to_mm) = (start.linear_mm, end.linear_mm);
        let all: Result<(), Infallible> = curve.chords(&from_mm, &to_mm, CURVE_MM, &mut |chord| {
            let to = Position { linear_mm: chord.end_mm, ..end };
            self.feeding(common, Way::line(from, to), rate, [false; 2]);
            from = to;
            Ok(())
        });
        all.unwrap_or_else(|never| match never {});
    }

    /// From here on X, Y and Z are something else: nothing of where they were is comparable.
    fn switch(&mut self, kinematics: Kinematics) {
        self.kinematics = kinematics;
        self.model = self.models.of(kinematics).unwrap_or(self.models.axes);
        self.play = behind_a_switch(self.model, self.play);
        self.at.linear_mm = [None; 3];
        self.place = None;
        if let Some(others) = &mut self.others {
            others.switch(kinematics);
        }
    }

    pub(crate) fn positioning(&mut self, common: &Common, start: Partial, end: Partial, kind: Kind) {
        let rotary_rad = Vector::from(end.rotary_deg.map(f64::to_radians));
        let position = |model: &dyn PathModel, play: &mut Play| {
            // From where the program begins a first move has a direction too.
            for place in [start, end] {
                let known = Vector::from(place.linear_mm.map(|at| at.unwrap_or(0.0)));
                let turned = Vector::from(place.rotary_deg.map(f64::to_radians));
                play.go(model, &common.command(known, rotary_rad));
                play.turn(model, &common.command(known, turned), place.rotary_known);
            }
            for axis in 0..3 {
                let [from, to] = [start.linear_mm[axis], end.linear_mm[axis]];
                // By whatever way the control takes, and from wherever.
                let unknown = to.is_none() || from.is_none() || (kind == Kind::Uncorrected && from != to);
                if unknown {
                    play.forget(axis, to);
                }
            }
        };
        if let Some(play) = &mut self.play {
            position(self.model, play);
        }
        for (model, play) in self.others.iter_mut().flat_map(Others::playing) {
            position(model, play);
        }
        let error = end.complete().map(|end| {
            let at = Vector::from(end.linear_mm);
            (at, self.error_mm(&common.command(at, rotary_rad)))
        });
        let play_mm =
            |at: &Vector, axis| self.model.reversal_mm(axis, &common.command(*at, rotary_rad)).max(0.0);
        // Only of what is made it is asked how far it may be aside.
        let known = self.play.as_ref().and(error.as_ref()).filter(|_| self.role == Role::Commanded);
        let aside_mm = known.map_or(0.0, |(at, _)| (0..3).map(|axis| play_mm(at, axis)).sum());
        let turns_mm = known.map_or(0.0, |(at, _)| {
            let here = common.command(*at, rotary_rad);
            (0..3).map(|axis| turned_by_mm(self.model, &here, axis).norm()).sum()
        });
        let role = self.role;
        let linear = error.map(|(at, error)| if role == Role::Wanted { at } else { at + error });
        let place = linear.map(|linear| self.place(&common.command(linear, rotary_rad)));
        let tip_mm = |at: Vector| self.model.tip_mm(&at, &common.command(at, rotary_rad));
        let zero_mm = tip_mm(Vector::zeros());
        let axes = [Vector::x(), Vector::y(), Vector::z()].map(|axis| tip_mm(axis) - zero_mm);
        self.ready.push_back(Item::Position(Box::new(Positioning {
            start,
            end,
            axes,
            places: [std::mem::replace(&mut self.place, place), place],
            error_mm: error.map_or(0.0, |(_, error)| error.norm()),
            aside_mm,
            turns_mm,
            rapid: kind != Kind::Uncorrected,
            of_cycle: kind == Kind::OfCycle,
            aside_deg: self.pointing.map_or(0.0, |pointing| pointing.aside_deg),
            line: common.line,
            process: Process::of_number(common.process.number),
            limit_mm: common.limit_mm,
        })));
        self.at = end;
    }

    /// Where the tool is with its linear axes here, errors included.
    pub(crate) fn place(&self, command: &Command) -> Place {
        let (tip, rotary) = (self.model.tip_mm(&command.linear_mm, command), command.rotary_rad);
        let role = usize::from(self.role == Role::Commanded);
        let directions = || self.model.tool_directions(command, &command.rotary_rad);
        let (turned, coarse) = match self.pointing.and_then(|_| directions()) {
            Some(both) => (both[role] * POINTING_LEVER_MM, rotary * TURN_LEVER_MM),
            None => (rotary * LEVER_MM, Vector::zeros()),
        };
        let all = [tip, turned, coarse].map(Into::<[f64; 3]>::into);
        Place::from_row_slice(all.as_flattened())
    }

    pub(crate) fn error_mm(&self, command: &Command) -> Vector {
        match &self.play {
            None => self.model.error_mm(command),
            Some(play) => play.error_mm(self.model, command),
        }
    }
}
