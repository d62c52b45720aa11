//! A program as a row of items: feeds, positioning moves, deeds; cycles as the moves a control makes of them.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use machine_model::{Command, Models, PathModel, Placement, Play, Vector, singular_sin, turned_by_mm};
use smallvec::SmallVec;
use toolpath::{
    Bezier, CycleKind, Feed, FeedRate, Hole, HoleMove, Kinematics, MOST_PECKS, Motion, Partial, PeckRetreats,
    Position, Shape, whole_pecks,
};

use crate::course::{Course, Others};
use crate::offset;
use crate::step::Pointing;
use crate::stretch::{LEVER_MM, POINTING_LEVER_MM, Place, Span, Stretch, TURN_LEVER_MM};
use crate::way::Way;
use crate::{Act, Step};

/// Largest distance between places that the model is asked for, mm.
const SAMPLE_MM: f64 = 0.5;
/// A piece of an arc leaves the parabola through its ends and its middle by no more, mm: by r θ⁴/512 square to the circle
/// and r θ³/125 along it, which on a helix is aside of the path as far as that is steep.
const PARABOLA_MM: f64 = 1e-7;
/// Largest turn between places, rad.
const SAMPLE_RAD: f64 = 0.5;
/// A curve by control points is compared as lines that lie beside it by no more, mm.
const CURVE_MM: f64 = 2e-5;
/// Largest turn of the rotary axes between them, rad: at 500 mm a place leaves the parabola by some nanometres.
const TURN_RAD: f64 = 0.01;
/// No motion is asked for at more places.
const MOST_SAMPLES: f64 = 100_000.0;
/// So near to where an axis turns it is asked for on either side, mm: above what counts as the same place.
const TURN_MM: f64 = 1e-8;
/// The same of a rotary axis, as a share of the turn between two places.
const TURN_SHARE: f64 = 1e-6;

/// True where what a machine makes of a command depends on how it came there.
pub(crate) fn has_play(model: &dyn PathModel) -> bool {
    model.depends_on_direction() || model.has_rotary_play()
}

/// Where the axes stand in their play behind a switch: a rotary axis is what it was, of a linear one nothing is known.
pub(crate) fn behind_a_switch(model: &dyn PathModel, before: Option<Play>) -> Option<Play> {
    has_play(model).then(|| {
        let mut play = before.unwrap_or(Play::unknown());
        (0..3).for_each(|axis| play.forget(axis, None));
        play
    })
}

/// What must be the same for two motions to go on together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Process {
    pub(crate) number: u32,
    pub(crate) feed: Option<f64>,
    /// What time a motion takes is known.
    pub(crate) is_timed: bool,
    /// Of feeds in a row under cutter compensation the how-manieth: each is a process of its own.
    pub(crate) compensated: Option<u32>,
    /// The cycle that makes it, by number.
    pub(crate) cycle: Option<u32>,
}

impl Process {
    /// Of what is no feed.
    fn of_number(number: u32) -> Self {
        Self { number, feed: None, is_timed: false, compensated: None, cycle: None }
    }
}

/// Which places of a motion's stretches are reached: from a stretch on, those of each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Left {
    /// It lies in the window of what was asked for.
    pub(crate) asked: bool,
    pub(crate) first: usize,
    pub(crate) spans: SmallVec<[Option<Span>; 2]>,
}

impl Left {
    /// Of a stretch.
    pub(crate) fn at(&self, stretch: usize) -> Option<Span> {
        self.spans.get(stretch.checked_sub(self.first)?).copied().flatten()
    }

    /// Some place is.
    pub(crate) fn is_reached(&self) -> bool {
        self.spans.iter().any(Option::is_some)
    }

    /// The next stretch; those in front of the first that is reached are left out.
    pub(crate) fn push(&mut self, stretch: usize, span: Option<Span>) {
        if self.spans.is_empty() {
            if span.is_none() {
                return;
            }
            self.first = stretch;
        }
        // Between two stretches that are asked for none is reached.
        while self.first + self.spans.len() < stretch {
            self.spans.push(None);
        }
        self.spans.push(span);
    }

    /// Those that are reached, by stretch.
    pub(crate) fn reached(&self) -> impl DoubleEndedIterator<Item = (usize, Span)> + '_ {
        self.spans.iter().enumerate().filter_map(|(k, span)| Some((self.first + k, (*span)?)))
    }
}

/// How far a place is off a motion's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Off {
    /// The tip, mm.
    pub(crate) tip_mm: f64,
    /// The tool's direction, rad.
    pub(crate) leans_rad: f64,
    /// How far that may be there, rad.
    pub(crate) leans_at_most_rad: f64,
    /// The farthest rotary axis from its angle, rad, at the best of the places where tip and direction hold; infinite where
    /// there is none.
    pub(crate) aside_rad: f64,
}

impl Off {
    /// No place.
    const FAR: Self = Self {
        tip_mm: f64::INFINITY,
        leans_rad: f64::INFINITY,
        leans_at_most_rad: 1.0,
        aside_rad: f64::INFINITY,
    };

    /// The direction's share of its limit.
    fn leans(&self) -> f64 {
        self.leans_rad / self.leans_at_most_rad
    }

    /// The larger share of tip and direction.
    fn share(&self, limit_mm: f64) -> f64 {
        (self.tip_mm / limit_mm).max(self.leans())
    }
}

/// A feed motion.
pub(crate) struct Feeding {
    pub(crate) stretches: SmallVec<[Stretch; 2]>,
    /// What is reached of it while the other program stands where it does.
    pub(crate) left: Left,
    pub(crate) line: u64,
    pub(crate) process: Process,
    /// What it takes, under G93, where it leads farther than the limit.
    pub(crate) minutes: Option<f64>,
    pub(crate) limit_mm: f64,
    /// How far it leads from where it starts at most, mm: less than its length for a circle.
    pub(crate) reach_mm: f64,
    /// Its start, or its end, lies in the air above the hole that it drills.
    pub(crate) airy: [bool; 2],
    /// `None` for a positioning move of micrometres.
    pub(crate) way: Option<Way>,
    /// Largest distance from its own path, mm: of a programmed motion run uncorrected.
    pub(crate) off_mm: f64,
    /// Largest distance of what was made of it, mm, and the line that makes it.
    pub(crate) made_off_mm: f64,
    pub(crate) made_line: Option<u64>,
    /// Where the tool was brought for it, where that is to be remembered.
    pub(crate) made: Vec<[f64; 3]>,
    /// The errors along it, where they are asked for.
    pub(crate) course: Option<Box<Course>>,
    /// How far the tip and the direction may be off, where directions are compared.
    pub(crate) pointing: Option<(f64, Pointing)>,
    /// Of each stretch: how far the direction may be off there, rad.
    pub(crate) leans_at_most_rad: SmallVec<[f64; 2]>,
    /// Largest angle of the tool from the ideal direction at its own angles, rad.
    pub(crate) leans_rad: f64,
    /// The largest of what was made of it, rad.
    pub(crate) made_leans_rad: f64,
}

impl Feeding {
    /// So far from it is what a line makes of it.
    pub(crate) fn note_made(&mut self, off_mm: f64, line: u64) {
        if self.made_line.is_none() || off_mm > self.made_off_mm {
            self.made_line = Some(line);
        }
        self.made_off_mm = self.made_off_mm.max(off_mm);
    }

    pub(crate) fn start(&self) -> Place {
        self.stretches[0].at(0.0)
    }

    pub(crate) fn end(&self) -> Place {
        self.stretches[self.stretches.len() - 1].at(1.0)
    }

    pub(crate) fn length_mm(&self) -> f64 {
        self.stretches.iter().map(Stretch::length_mm).sum()
    }

    /// Minutes, under G93, and the way that they are shared by, mm: where rotary axes turn, the linear axes may have farther
    /// to go than the tool.
    pub(crate) fn timed(&self) -> (f64, f64) {
        let way_mm =
            || self.length_mm().max(self.way.as_ref().map_or(0.0, Way::length_mm)).max(self.limit_mm);
        self.minutes.map_or((0.0, 0.0), |minutes| (minutes, way_mm()))
    }

    /// So short that rounding decides whether it leads anywhere.
    pub(crate) fn is_short(&self) -> bool {
        /// Rounding at either end, and the limit.
        const LIMITS: f64 = 3.0;
        self.reach_mm <= LIMITS * self.limit_mm
    }

    /// Its end is reached.
    pub(crate) fn is_done(&self) -> bool {
        self.left.at(self.stretches.len() - 1).is_some_and(|span| span.is_at_end())
    }

    /// How far its end is from the last place that is reached, mm; `None` where none is.
    pub(crate) fn left_mm(&self) -> Option<f64> {
        self.left_mm_of(&self.left)
    }

    /// The same where so much is reached.
    pub(crate) fn left_mm_of(&self, left: &Left) -> Option<f64> {
        let (last, span) = left.reached().next_back()?;
        Some((self.end() - self.stretches[last].at(span.high)).norm())
    }

    /// How far a place is off where tip and direction hold best: being late by less than the tip may be off is no deviation
    /// of a direction either, nor of the axes.
    pub(crate) fn off(&self, place: &Place, limit_mm: f64) -> Off {
        /// So many places are looked at on either side of the nearest.
        const LOOKS: i32 = 24;
        /// So many times what is looked at for the best loses a third.
        const THIRDS: u32 = 40;
        /// Shares of the limits that differ by less are rounding.
        const ALIKE: f64 = 1e-6;
        let (mut best, mut least, mut aside_rad) = (Off::FAR, Off::FAR, f64::INFINITY);
        for (stretch, leans_at_most_rad) in self.stretches.iter().zip(&self.leans_at_most_rad) {
            let foot = stretch.foot(place);
            let away_mm = (place - stretch.at(foot)).fixed_rows::<6>(0).norm();
            if away_mm > 4.0 * self.limit_mm && best.tip_mm.is_finite() {
                continue;
            }
            let reach = 2.0 * self.limit_mm / stretch.length_mm().max(self.limit_mm);
            let off = |s: f64| {
                let off = place - stretch.at(s);
                Off {
                    tip_mm: off.fixed_rows::<3>(0).norm(),
                    leans_rad: off.fixed_rows::<3>(3).norm() / POINTING_LEVER_MM,
                    leans_at_most_rad: *leans_at_most_rad,
                    aside_rad: off.fixed_rows::<3>(6).amax() / TURN_LEVER_MM,
                }
            };
            let inside = |s: f64| s.clamp(0.0, 1.0);
            // The larger share has one least value on a stretch.
            let (mut low, mut high) = (inside(foot - reach), inside(foot + reach));
            for _ in 0..THIRDS {
                let third = (high - low) / 3.0;
                let [first, second] = [low + third, high - third].map(|s| off(s).share(limit_mm));
                if first <= second { high -= third } else { low += third }
            }
            let evenly = (-LOOKS..=LOOKS).map(|k| inside(foot + reach * f64::from(k) / f64::from(LOOKS)));
            for own in evenly.chain([0.5 * (low + high)]).map(off) {
                if own.tip_mm <= limit_mm {
                    if own.leans() < least.leans() {
                        least = own;
                    }
                    if own.leans() <= 1.0 {
                        aside_rad = aside_rad.min(own.aside_rad);
                    }
                }
                let [share, so_far] = [own, best].map(|off| off.share(limit_mm));
                // Of places that are as good the nearest.
                if share < so_far - ALIKE || (share < so_far + ALIKE && own.tip_mm < best.tip_mm) {
                    best = own;
                }
            }
        }
        let Off { leans_rad, leans_at_most_rad, .. } =
            if least.leans() <= best.leans() { least } else { best };
        Off { tip_mm: best.tip_mm, leans_rad, leans_at_most_rad, aside_rad }
    }

    /// Distance of a place, mm, and how far along the motion the nearest lies, 0 to 1.
    pub(crate) fn nearest(&self, place: &Place) -> (f64, f64) {
        let mut nearest = (f64::INFINITY, 0.0);
        for (k, stretch) in self.stretches.iter().enumerate() {
            let distance_mm = stretch.distance_mm(place);
            if distance_mm < nearest.0 {
                nearest = (distance_mm, (k as f64 + stretch.foot(place)) / self.stretches.len() as f64);
            }
        }
        nearest
    }
}

/// A move whose end counts and whose way is the control's: G0, a reference return, a turn of rotary axes.
pub(crate) struct Positioning {
    /// Where the axes were, as far as known.
    pub(crate) start: Partial,
    /// Where they end.
    pub(crate) end: Partial,
    /// Where it starts and ends on the path that is compared, as far as known.
    places: [Option<Place>; 2],
    /// The directions in which X, Y and Z move the tool where it ends, of what is made.
    axes: [Vector; 3],
    /// The machine's error there, mm.
    pub(crate) error_mm: f64,
    /// How far aside the tool may end for axes that lie in their play, mm.
    pub(crate) aside_mm: f64,
    /// How far the tool goes there, by the most, when every axis turns, mm.
    pub(crate) turns_mm: f64,
    /// G0, which is corrected, unlike the others.
    pub(crate) rapid: bool,
    /// Made by a cycle.
    pub(crate) of_cycle: bool,
    /// How far a rotary axis may stand aside, degrees.
    pub(crate) aside_deg: f64,
    pub(crate) line: u64,
    pub(crate) process: Process,
    pub(crate) limit_mm: f64,
}

impl Positioning {
    /// It moves the tool by so little that it makes no difference whether it is made, and how.
    pub(crate) fn is_small(&self) -> bool {
        /// Rounding at either end, and the limit there.
        const LIMITS: f64 = 8.0;
        match self.places {
            [Some(from), Some(to)] => (to - from).norm() <= LIMITS * self.limit_mm,
            // As far as known it stays where it is.
            _ => self.start == self.end,
        }
    }

    /// How far each linear axis is from where it would bring the tool to the end of another, mm: with rotary axes aside
    /// it follows them. `None` where one of the ends is not known.
    fn off_mm(&self, wanted: &Self) -> Option<[f64; 3]> {
        let ([_, Some(to)], [_, Some(end)]) = (wanted.places, self.places) else { return None };
        let off = Vector::from(first_three(&(end - to)));
        Some(self.axes.map(|axis| axis.dot(&off)))
    }
}

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
    role: Role,
    retreats: PeckRetreats,
    model: &'m dyn PathModel,
    models: Models<'m>,
    /// Of which of them `model` is one.
    kinematics: Kinematics,
    /// Where the axes stand in their play; `None` where the model knows none.
    play: Option<Play>,
    /// Where the last motion has brought the axes.
    at: Partial,
    /// Where it has brought the path that is compared.
    place: Option<Place>,
    counted: Counted,
    ready: VecDeque<Item>,
    /// Machines that go the same way, and how densely: [`crate::courses`].
    others: Option<Others<'m>>,
    /// Directions are compared, and may be off so far.
    pointing: Option<Pointing>,
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
struct Common {
    line: u64,
    process: Process,
    limit_mm: f64,
    tool_mm: Vector,
    datum: Placement,
    dwell: Option<u32>,
}

impl Common {
    fn command(&self, linear_mm: Vector, rotary_rad: Vector) -> Command {
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

    fn positioning(&mut self, common: &Common, start: Partial, end: Partial, kind: Kind) {
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

    fn error_mm(&self, command: &Command) -> Vector {
        match &self.play {
            None => self.model.error_mm(command),
            Some(play) => play.error_mm(self.model, command),
        }
    }

    /// Where the tool is with its linear axes here, errors included.
    fn place(&self, command: &Command) -> Place {
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

    fn feeding(&mut self, common: &Common, way: Way, rate: FeedRate, airy: [bool; 2]) {
        let length_mm = way.length_mm();
        let (radius_mm, steep) = way.radius_and_steepness();
        let square_rad = (512.0 * PARABOLA_MM / radius_mm.max(1e-9)).sqrt().sqrt();
        let along_rad = units::math::powf(125.0 * PARABOLA_MM / (radius_mm * steep).max(1e-9), 1.0 / 3.0);
        let turn_rad = square_rad.min(along_rad).min(SAMPLE_RAD);
        let pieces = (way.turning_rad() / turn_rad).max(way.rotary_turn_rad() / TURN_RAD);
        let samples = match &self.others {
            None => pieces.max(length_mm / SAMPLE_MM),
            Some(others) => others.pieces(&way, length_mm),
        };
        let real = self.real(common, &way, samples.ceil().clamp(1.0, MOST_SAMPLES));
        let course = self.course(common, &way, &real);
        let leans = |(s, _): &(f64, Vector)| {
            let command = common.command(way.at(*s), way.rotary_rad(*s));
            let both = self.model.tool_directions(&command, &command.rotary_rad);
            both.map_or(0.0, |[ideal, real]| (real - ideal).norm())
        };
        let leans_rad = if self.model.rotary_axes() == [false; 3] {
            0.0
        } else {
            real.iter().map(leans).fold(0.0, f64::max)
        };
        let seen =
            |s: f64, error_mm: &Vector| self.place(&common.command(way.at(s) + error_mm, way.rotary_rad(s)));
        let nominal = |s: f64| seen(s, &Vector::zeros());
        let stretch = |[(s0, e0), (s1, e1)]: [(f64, Vector); 2]| {
            // How far the middle lies beside the chord.
            let bow =
                (!way.is_straight()).then(|| nominal(0.5 * (s0 + s1)) - 0.5 * (nominal(s0) + nominal(s1)));
            Stretch::new(seen(s0, &e0), seen(s1, &e1), bow)
        };
        let pairs = |places: &[(f64, Vector)]| {
            places.windows(2).map(|pair| stretch([pair[0], pair[1]])).collect::<SmallVec<[Stretch; 2]>>()
        };
        let mut off_mm = 0.0f64;
        let stretches = match self.role {
            Role::Commanded => pairs(&real),
            Role::Wanted => {
                let pieces = pieces.ceil().clamp(1.0, MOST_SAMPLES);
                let steps = (0..=pieces as u32).map(|k| (f64::from(k) / pieces, Vector::zeros()));
                let stretches = pairs(&steps.collect::<SmallVec<[_; 4]>>());
                for (s, error) in &real {
                    let k = ((s * pieces) as usize).min(stretches.len() - 1);
                    off_mm = off_mm.max(stretches[k].distance_mm(&seen(*s, error)));
                }
                stretches
            }
        };
        let leans_at_most_rad = self.pointing.map_or_else(SmallVec::new, |pointing| {
            let places = stretches.len();
            let near = |k: usize| {
                let s = k as f64 / places as f64;
                let sin = singular_sin(self.model, &common.command(way.at(s), way.rotary_rad(s)));
                sin.is_some_and(|sin| sin < pointing.near_sin)
            };
            let near: SmallVec<[bool; 4]> = (0..=places).map(near).collect();
            let at_most = |ends: &[bool]| {
                if ends.contains(&true) { pointing.leans_near_rad } else { pointing.leans_rad }
            };
            near.windows(2).map(at_most).collect()
        });
        // Of a long motion its length will do.
        let start = stretches[0].at(0.0);
        let far = || stretches.iter().map(|stretch| (stretch.at(1.0) - start).norm()).fold(0.0, f64::max);
        let reach_mm = if length_mm < 1.0 { far() } else { length_mm };
        self.limit_mm = self.limit_mm.max(common.limit_mm);
        // Tip and direction are found together, and judged apart.
        let leans_mm = self.pointing.map_or(0.0, |pointing| POINTING_LEVER_MM * pointing.leans_near_rad);
        let limit_mm = (common.limit_mm * common.limit_mm + leans_mm * leans_mm).sqrt();
        self.at = Partial {
            linear_mm: Into::<[f64; 3]>::into(way.at(1.0)).map(Some),
            rotary_deg: way.end_rotary_deg(),
            rotary_known: [true; 3],
        };
        self.place = stretches.last().map(|stretch| stretch.at(1.0));
        self.ready.push_back(Item::Feed(Box::new(Feeding {
            stretches,
            left: Left::default(),
            line: common.line,
            process: common.process,
            minutes: match rate {
                // What leads nowhere may be left out, and its F with it.
                FeedRate::InverseTime(f) if reach_mm > common.limit_mm => Some(1.0 / f),
                _ => None,
            },
            limit_mm,
            reach_mm,
            airy,
            way: Some(way),
            off_mm,
            made_off_mm: 0.0,
            made_line: None,
            made: Vec::new(),
            course,
            pointing: self.pointing.map(|pointing| (common.limit_mm, pointing)),
            leans_at_most_rad,
            leans_rad,
            made_leans_rad: 0.0,
        })));
    }

    /// What every machine makes of a way, at the places of the first.
    fn course(&mut self, common: &Common, way: &Way, real: &[(f64, Vector)]) -> Option<Box<Course>> {
        let mut others = self.others.take()?;
        let mut course = Course { line: common.line, places_mm: Vec::new(), errors_mm: Vec::new() };
        for (s, error_mm) in real {
            let here = common.command(way.at(*s), way.rotary_rad(*s));
            let seen =
                |error_mm: Vector| self.place(&Command { linear_mm: here.linear_mm + error_mm, ..here });
            let nominal = seen(Vector::zeros());
            course.places_mm.push(first_three(&nominal));
            let all = std::iter::once(*error_mm).chain(others.errors_mm(&here));
            course.errors_mm.extend(all.map(|error_mm| first_three(&(seen(error_mm) - nominal))));
        }
        self.others = Some(others);
        Some(Box::new(course))
    }

    /// The machine's errors along a way, evenly and wherever an axis turns or has its play taken up.
    fn real(&mut self, common: &Common, way: &Way, samples: f64) -> SmallVec<[(f64, Vector); 4]> {
        let mut cuts: SmallVec<[f64; 4]> = (1..=samples as u32).map(|k| f64::from(k) / samples).collect();
        let command = |s: f64| common.command(way.at(s), way.rotary_rad(s));
        let Some(mut play) = self.play else {
            let all = std::iter::once(0.0).chain(cuts);
            return all.map(|s| (s, self.model.error_mm(&command(s)))).collect();
        };
        let turns = way.turns();
        if !turns.is_empty() {
            cuts.extend(turns);
            cuts.sort_by(f64::total_cmp);
        }
        let mut at = command(0.0);
        play.go(self.model, &at);
        play.turn(self.model, &at, [true; 3]);
        let mut found: SmallVec<[(f64, Vector); 4]> = SmallVec::new();
        found.push((0.0, play.error_mm(self.model, &at)));
        let mut from = 0.0;
        for cut in cuts {
            let to = command(cut);
            let way_mm: [f64; 3] = (to.linear_mm - at.linear_mm).into();
            let direction = way_mm.map(|mm| i8::from(mm > 0.0) - i8::from(mm < 0.0));
            let (side, lag_mm) = (play.side(), play.lag_mm(self.model, &at, direction));
            let mut taken_up: SmallVec<[f64; 6]> = SmallVec::new();
            for axis in 0..3 {
                // Of an axis whose side nobody knows nobody knows either where it changes.
                let turns = direction[axis] != 0 && side[axis] != direction[axis] && side[axis] != 0;
                if turns && way_mm[axis].abs() > lag_mm[axis] + TURN_MM {
                    // What lies across the axis changes there, at once.
                    let around = [lag_mm[axis] - TURN_MM, lag_mm[axis] + TURN_MM];
                    let before_and_behind = around.iter().filter(|mm| **mm > 0.0);
                    taken_up.extend(before_and_behind.map(|mm| where_gone(way, from, cut, axis, *mm)));
                }
            }
            let way_rad: [f64; 3] = (to.rotary_rad - at.rotary_rad).into();
            let heading = way_rad.map(|rad| i8::from(rad > 0.0) - i8::from(rad < 0.0));
            let lag_rad = play.rotary_lag_rad(self.model, &at, heading);
            for axis in (0..3).filter(|axis| lag_rad[*axis] > 0.0) {
                let share = lag_rad[axis] / way_rad[axis].abs();
                // The turn runs evenly, and what changes at once is met from both sides.
                let around = [share - TURN_SHARE, share, share + TURN_SHARE];
                taken_up.extend(
                    around.iter().filter(|s| (0.0..1.0).contains(*s)).map(|s| from + (cut - from) * s),
                );
            }
            taken_up.sort_by(f64::total_cmp);
            for s in taken_up.into_iter().chain([cut]) {
                let here = command(s);
                play.go(self.model, &here);
                play.turn(self.model, &here, [true; 3]);
                found.push((s, play.error_mm(self.model, &here)));
            }
            (from, at) = (cut, to);
        }
        self.play = Some(play);
        found
    }

    /// How many pecks a hole has that is so many of them deep.
    ///
    /// The depth of a corrected cycle is the programmed one but for micrometres: where they decide, it has as many
    /// pecks as the programmed hole there.
    fn pecks_of(&self, hole: &Hole, depth: f64, unsure: f64) -> u32 {
        /// So many holes the one program may be ahead of the other.
        const KEPT: usize = 64;
        /// Holes that are nearer are one, mm.
        const ONE_HOLE_MM: f64 = 1.0;
        let counted = whole_pecks(depth);
        let at = Vector::from(hole.at_r.linear_mm);
        let mut known = self.counted.borrow_mut();
        if self.role == Role::Wanted {
            known.push_back((at, counted));
            if known.len() > KEPT {
                known.pop_front();
            }
            return counted;
        }
        let here = known.iter().rposition(|(known, _)| (known - at).norm() < ONE_HOLE_MM);
        let programmed = here.map(|k| known[k].1).filter(|count| {
            let count = f64::from(*count);
            depth - unsure <= count && count - 1.0 <= depth + unsure
        });
        programmed.unwrap_or(counted)
    }

    /// A cycle, move by move.
    fn hole(&mut self, common: &Common, hole: &Hole) {
        // All moves of a cycle are made with the correction of its hole.
        let ends = [hole.at_r, hole.at(hole.bottom_mm)].into_iter().filter(|_| self.role == Role::Commanded);
        let errors_mm = ends.map(|place| {
            let rotary_rad = Vector::from(place.rotary_deg.map(f64::to_radians));
            self.error_mm(&common.command(Vector::from(place.linear_mm), rotary_rad)).norm()
        });
        let hole_error_mm = errors_mm.fold(0.0, f64::max);
        // A hole of more pecks is compared as one.
        let count = match hole.pecks().zip(hole.cycle.peck_mm) {
            Some((pecks, peck_mm)) if pecks < MOST_PECKS => {
                self.pecks_of(hole, pecks, 8.0 * common.limit_mm / peck_mm)
            }
            _ => 1,
        };
        let mut at = hole.start;
        for step in hole.moves(count, self.retreats) {
            let to = step.end().unwrap_or(at);
            match step {
                HoleMove::FeedIn { .. } => {
                    self.feeding(common, Way::line(at, to), hole.rate, [true, false]);
                }
                HoleMove::FeedOut { .. } => {
                    self.feeding(common, Way::line(at, to), hole.rate, [false, true]);
                }
                HoleMove::Rise { .. } | HoleMove::Position { .. } | HoleMove::Leave { .. } => {
                    self.positioning(common, at.into(), to.into(), Kind::OfCycle);
                    if let Some(Item::Position(made)) = self.ready.back_mut() {
                        made.error_mm = made.error_mm.max(hole_error_mm);
                    }
                }
                HoleMove::Dwell => {
                    if let Some(number) = common.dwell.filter(|_| hole.cycle.kind != CycleKind::Synchronised)
                    {
                        let process = Process::of_number(common.process.number);
                        self.ready.push_back(Item::Deed(Deed { number, line: common.line, process }));
                    }
                }
            }
            at = to;
        }
    }
}

/// X, Y, Z of a place.
pub(crate) fn first_three(place: &Place) -> [f64; 3] {
    [place[0], place[1], place[2]]
}

/// What makes a positioning move.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Rapid,
    OfCycle,
    Uncorrected,
}

/// Where between two places an axis, going one way, has gone so far.
fn where_gone(way: &Way, from: f64, to: f64, axis: usize, mm: f64) -> f64 {
    let start = way.at(from)[axis];
    let (mut low, mut high) = (from, to);
    // To below a picometre of any way.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (way.at(middle)[axis] - start).abs() < mm { low = middle } else { high = middle }
    }
    high
}

/// Ends of a positioning move that are alike: where an axis goes, the tool ends there; one that stays may.
pub(crate) fn ends_alike(wanted: &Positioning, made: &Positioning) -> bool {
    /// Nothing is cut there.
    const LIMITS: f64 = 4.0;
    /// Where an axis was left by its last correction the machine was off by no more, mm; or by twice what it is off here.
    const LEFT_MM: f64 = 1.0;
    /// Angles of directions that are vectors have last digits of their own, degrees.
    const SAME_DEG: f64 = 1e-5;
    for (wanted_deg, made_deg) in wanted.end.rotary_deg.iter().zip(made.end.rotary_deg) {
        let aside_deg = (wanted_deg - made_deg).abs();
        if aside_deg.is_nan() || aside_deg > wanted.aside_deg.max(SAME_DEG) {
            return false;
        }
    }
    if wanted.rapid != made.rapid {
        return false;
    }
    // A control does not correct the moves of a cycle: they are off by the machine's errors, there and where it began.
    let of_cycle_mm = if made.of_cycle { 2.0 * made.error_mm } else { 0.0 };
    // Written as moves they stand as the next feed will want them, from whichever side they come.
    let turns_mm = if wanted.of_cycle { made.turns_mm } else { made.aside_mm };
    let off_mm = made.off_mm(wanted).filter(|_| wanted.rapid);
    let near_mm = LIMITS * wanted.limit_mm + turns_mm + of_cycle_mm;
    (0..3).all(|axis| {
        let [(w_from, w_to), (from, to)] =
            [wanted, made].map(|p| (p.start.linear_mm[axis], p.end.linear_mm[axis]));
        let (Some(w_to), Some(to)) = (w_to, to) else { return true };
        let by_as_much =
            w_from.zip(from).is_some_and(|(w_from, from)| ((w_to - w_from) - (to - from)).abs() <= near_mm);
        // An axis that stands is where its last correction left it.
        let stands = by_as_much
            && w_from.is_some_and(|w_from| (w_to - w_from).abs() <= near_mm)
            && (w_to - to).abs() <= LEFT_MM.max(2.0 * made.error_mm);
        stands
            || match off_mm {
                Some(off_mm) => off_mm[axis].abs() <= near_mm,
                // Uncorrected: what the block moves ends as written or goes as far as written.
                None => by_as_much || (w_to - to).abs() <= near_mm,
            }
    })
}
