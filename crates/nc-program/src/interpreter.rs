//! Block by block: check the whole block, then commit it.

use diagnostic::{Diagnostic, both};
use nc_dialect::{Action, Dialect, MCode};
use nc_syntax::{Block, ItemKind, Span, Value};
use smallvec::{SmallVec, smallvec};
use toolpath::{Kinematics, Motion, Mover, Plane};
use units::decimal::Decimal;

use crate::call;
use crate::codes;
use crate::context::{Context, context};
use crate::curves;
use crate::delete;
use crate::environment::{Environment, Owner};
use crate::modal::{
    ArcCentres, Aside, Axes, Axis, Compensation, Distance, FeedMode, LastFeed, Lost, Modal, MotionMode,
    Naming, PathControl, Progress, ReturnLevel, Shifts, Stated, ToolLength, Transform, Units, Why,
    WorkOffset, XWords,
};
use crate::motion;
use crate::moved::Moved;
use crate::naming;
use crate::offset;
use crate::path_control;
use crate::plain::{Plain, PlainEnd, PlainFeeds};
use crate::refusals::interpreter as refusal;
use crate::settings;
use crate::setup::{AfterChange, Setup};
use crate::tilted;
use crate::tip;
use crate::turning;
use crate::under_way::Offset;
use crate::words::{Outcome, Words};

/// What a block means.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// What the axes do, in order: none, one, or one for each repetition of a cycle.
    pub motions: SmallVec<[Motion; 1]>,
    /// The state in which they are done.
    pub context: Context,
    /// The program has ended, with this block or before it.
    pub ends_program: bool,
    /// The X, Y, Z words of this block say where the axes stand (G92, G10 L20), and a frame is made of it:
    /// in an output whose axes stand elsewhere they must say so.
    pub states_position: bool,
}

/// Executes a program block by block.
#[derive(Clone, Debug)]
pub struct Interpreter<'d> {
    pub(crate) env: Environment<'d>,
    pub(crate) modal: Modal,
    /// Of the state in force.
    pub(crate) plain: Plain,
}

impl<'d> Interpreter<'d> {
    /// At the start of a program: the dialect's initial codes, axes where the setup says or unknown.
    ///
    /// Rotary axes that the machine has are unknown until the program moves them, if it matters where they are.
    #[must_use]
    pub fn new(dialect: &'d Dialect, setup: &'d Setup) -> Self {
        let motion_group = dialect.row_of(&Action::Line).map(|entry| entry.group);
        let env = Environment { dialect, setup, motion_group };
        let unknown = Axis::Unknown(Lost { why: Why::Start, line: 0 });
        let mut modal = Modal {
            motion: MotionMode::None,
            cycle: None,
            plane: Plane::Xy,
            distance: Distance::Absolute,
            units: Units::Millimetre,
            x_words: match (&dialect.turning, setup.diameters) {
                (None, _) | (Some(_), Some(false)) => XWords::Radius,
                (Some(_), Some(true)) => XWords::Diameter,
                (Some(_), None) => XWords::Unstated,
            },
            speed_limited: false,
            feed_mode: FeedMode::PerMinute,
            last_feed: LastFeed::Unknown,
            feed: None,
            arc_centres: ArcCentres::Incremental,
            compensation: Compensation::Off,
            offset: Offset::default(),
            path_control: path_control::at_start(dialect),
            return_level: if dialect.codes.iter().any(|entry| entry.action == Action::ReturnR) {
                ReturnLevel::Unsaid
            } else {
                ReturnLevel::Initial
            },
            tool_length: ToolLength::Off,
            vectors: false,
            plane_begun: None,
            curve: None,
            curve_leaves_mm: None,
            kinematics: if setup.tip_at_start { Kinematics::Tip } else { Kinematics::Axes },
            work_offset: WorkOffset { code: None, number: None, zero_mm: None, rewritten: false },
            shifts: Shifts::default(),
            transform: Transform::None,
            unsettled: [false; 3],
            written: Vec::new(),
            written_lengths: Vec::new(),
            frame: None,
            axes: Axes {
                linear: setup.start_mm.map(|start| start.map_or(unknown, Axis::At)),
                rotary: [0, 1, 2].map(|axis| match setup.start_deg[axis] {
                    Some(start) => Axis::At(start),
                    None if setup.has_rotary[axis] && setup.rotary_matters => unknown,
                    None => Axis::At(0.0),
                }),
            },
            named: [Naming::Since(Lost { why: Why::Start, line: 0 }); 3],
            stated: Stated::default(),
            tool_selected: None,
            tool_loaded: None,
            edge_unsaid: false,
            progress: Progress::Leader,
            aside: None,
        };
        if dialect.turning.is_some() {
            modal.axes.linear[1] = Axis::At(0.0);
        }
        settings::initial(&env, &mut modal);
        Self { env, modal, plain: Plain::default() }
    }

    /// The state after the last block that was executed.
    #[must_use]
    pub const fn modal(&self) -> &Modal {
        &self.modal
    }

    /// What the codes of a block make of the state before anything moves, and whose its axis words are then.
    ///
    /// For who writes a block anew by what it will mean; the state stays as it is.
    ///
    /// # Errors
    /// Its codes are refused, whatever its words are.
    pub fn settings(&self, block: &Block<'_>) -> Result<(Modal, Owner), Box<Diagnostic>> {
        let mut words = Words::new(block, self.env.dialect);
        words.read()?;
        let mut state = self.modal.clone();
        if self.env.dialect.turning.is_some() {
            turning::read(&mut words, &mut state)?;
        }
        let demand = settings::apply(&self.env, &words, &self.modal, &mut state)?;
        Ok((state, demand.owner))
    }

    /// What a block that was put in says of how near the control keeps to the path, whether the blocks beside it are skipped or
    /// not.
    pub fn keeps_path(&mut self, said: PathControl) {
        self.modal.path_control = said;
        if let Some(aside) = &mut self.modal.aside {
            aside.skipped.path_control = said;
        }
    }

    /// What is not whole where the program's text ends here, and its line.
    #[must_use]
    pub fn unfinished(&self) -> Option<(Diagnostic, u64)> {
        self.modal.curve.as_ref().map(|begun| begun.at_the_end())
    }

    /// Executes one block. After the end of the program it does nothing.
    ///
    /// # Errors
    /// What the block asks for cannot be told with certainty ([`crate::codes`]); the state is then as it
    /// was before the block.
    pub fn step(&mut self, block: &Block<'_>) -> Result<Step, Vec<Diagnostic>> {
        self.plain = Plain::Unasked;
        let before = self.modal.clone();
        // A closure would take the state along on every block.
        match self.execute(block, &before) {
            Ok(step) => Ok(step),
            Err(diagnostic) => {
                self.modal = before;
                Err(vec![*diagnostic])
            }
        }
    }

    /// What a block means; the state (which comes in equal to `before`) is then the one behind it.
    fn execute(&mut self, block: &Block<'_>, before: &Modal) -> Outcome<Step> {
        let (env, state) = (&self.env, &mut self.modal);
        let mut moved = Moved { repeats: 1, ..Moved::default() };
        if before.progress == Progress::Ended {
            after_end(block)?;
            return Ok(stepped(env, before, state, moved));
        }
        let mut words = Words::new(block, env.dialect);
        words.read()?;
        let acts = block.acts();
        let switches = block.switches();
        // The first block that the switch has nothing to do with must be right in both states.
        let both = match &before.aside {
            Some(aside) if acts && aside.switches != switches => Some(delete::merge(&words, aside, before)?),
            _ => None,
        };
        let before = both.as_ref().unwrap_or(before);
        if both.is_some() {
            *state = before.clone();
        }
        if acts && switches != 0 && state.aside.is_none() {
            let aside = Aside { switches, line: block.line, skipped: before.clone(), moved: false };
            state.aside = Some(Box::new(aside));
        }
        run(env, &mut words, before, state, &mut moved)?;
        moved.by_increment = words.by_increment;
        let mut step = stepped(env, before, state, moved);
        if let Some(mut aside) = state.aside.take() {
            aside.moved |= !step.motions.is_empty();
            if state.progress == Progress::Ended {
                *state = delete::merge(&words, &aside, state)?;
                step.ends_program = false;
            } else {
                state.aside = Some(aside);
            }
        }
        Ok(step)
    }
}

/// What was executed, as it is told to others.
fn stepped(env: &Environment<'_>, before: &Modal, state: &Modal, moved: Moved) -> Step {
    Step {
        context: context(env, before, state, &moved),
        motions: moved.motions,
        states_position: moved.states_position,
        ends_program: state.progress == Progress::Ended,
    }
}

/// Executes a block on `state` (which comes in equal to `before`) and collects what moves in `moved`.
#[inline]
fn run<'d>(
    env: &Environment<'d>,
    words: &mut Words<'_, '_, 'd>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
) -> Outcome<()> {
    if words.percent {
        // The first `%` opens a tape, unless the program already runs; the next one closes it.
        state.progress = match before.progress {
            Progress::Leader => Progress::Opened,
            Progress::Opened | Progress::OpenedTwice => Progress::OpenedTwice,
            Progress::Running | Progress::Ended => Progress::Ended,
        };
    }
    if let (Progress::Ended, Some(begun)) = (state.progress, &before.curve) {
        return Err(curves::open(words, begun, Span { start: 0, end: 1 }));
    }
    if words.is_idle() || state.progress == Progress::Ended {
        return Ok(());
    }
    if state.progress == Progress::OpenedTwice {
        return Err(opened_twice(words));
    }
    state.progress = Progress::Running;
    if env.dialect.turning.is_some() {
        turning::read(words, state)?;
    }
    let words = &*words;
    let demand = settings::apply(env, words, before, state)?;
    let own_feed = words.number(b'F').filter(|_| demand.owner != Owner::Dwell);
    if env.dialect.turning.is_some() {
        turning::check(env, words, &demand, state)?;
        state.feed = own_feed.map(|(number, _)| number).or(state.feed);
    }
    state.last_feed =
        before.last_feed.after(before.feed_mode, state, own_feed.map(|(number, _)| number.decimal));
    tip::check(words, &demand, before, state)?;
    tilted::check(env, words, &demand, before, state)?;
    curves::check(env, words, before, state)?;
    naming::disturb(env, words, &demand, before, state);
    moved.unnamed = state.named.map(Naming::lost);
    offset::begin(env, words, before, state);
    motion::execute(env, words, &demand, before, state, moved)?;
    offset::end(state, &moved.motions);
    let nowhere =
        |axis: &Axis| matches!(axis, Axis::Unknown(Lost { why: Why::Kinematics | Why::TiltedPlane, .. }));
    let turned = before.kinematics != state.kinematics || before.axes != state.axes;
    let switched = turned && state.axes.linear.iter().all(nowhere);
    if switched && moved.motions.is_empty() {
        // The axes stand, in coordinates that nobody knows.
        moved.motions = smallvec![Motion::Uncorrected { end: state.axes.partial(), by: Mover::Other }];
    }
    if env.dialect.turning.is_some() {
        turning::check_motions(words, state, &moved.motions)?;
    }
    if !words.m_codes.is_empty() {
        miscellaneous(env, words, state, moved)?;
    }
    call::left_alone(env, words, state, moved)?;
    if words.commands.iter().any(|(action, _)| **action == Action::Alarm) {
        state.progress = Progress::Ended;
    }
    naming::name(words, &demand, before, state, moved);
    tilted::check_motions(env, words, &demand, before, state, &moved.motions)
}

/// Behind M2, M30 or the closing `%` nothing is executed here, but on the control somebody may start it:
/// a second program in the same file. Text passes, motion does not.
fn after_end(block: &Block<'_>) -> Outcome<()> {
    if block.items.iter().any(|item| matches!(item.kind, ItemKind::Invalid(_))) {
        return Ok(());
    }
    let moves = |letter: u8| b"XYZABCUVW".contains(&letter);
    let motion =
        block.words().find(|word| moves(word.letter.to_ascii_uppercase()) && word.value != Value::Missing);
    match motion {
        None => Ok(()),
        Some(word) => Err(Box::new(
            Diagnostic::error(codes::AFTER_END, both!("motion behind the end of the program", "движение после конца программы"))
                .at(block.file_span(word.span), both!("nothing before this line leads here, so it would stay uncorrected", "сюда ничто не ведёт, и это осталось бы неисправленным"))
                .help(both!("put a second program or a subprogram in a file of its own; or delete these blocks, or write them as a comment", "вынесите вторую программу или подпрограмму в отдельный файл; или удалите эти кадры, или сделайте их комментарием")),
        )),
    }
}

/// What an M code makes of the axes: those that it moves stand anywhere afterwards, or where the setup says that a
/// tool change leaves them. Who says that knows the machine: an axis that was named before stays so, since the frame is
/// the same.
fn leave(env: &Environment<'_>, row: &MCode, line: u64, state: &mut Modal) -> SmallVec<[Motion; 1]> {
    let why = Why::Miscellaneous { code: row.number, changes_tool: row.changes_tool };
    // What the setup says are axis commands.
    let says = row.changes_tool && state.kinematics == Kinematics::Axes;
    let known = |i: usize| if says { env.setup.tool_change[i] } else { AfterChange::Unknown };
    let moved =
        [0, 1, 2].map(|i| row.loses_position[i] && known(i) != AfterChange::Stays && env.moves_axis(i));
    if moved == [false; 3] {
        return SmallVec::new();
    }
    for i in (0..3).filter(|i| moved[*i]) {
        state.axes.linear[i] = Axis::Unknown(Lost { why, line });
    }
    let mut motions = smallvec![Motion::Uncorrected { end: state.axes.partial(), by: Mover::Other }];
    let mut arrives = false;
    for i in (0..3).filter(|i| moved[*i]) {
        if let AfterChange::At(place_mm) = known(i) {
            state.axes.linear[i] = Axis::At(place_mm);
            arrives = true;
        }
    }
    if arrives {
        // Two motions, since the words name no axis: the first takes them from where they stood, whoever follows.
        motions.push(Motion::Uncorrected { end: state.axes.partial(), by: Mover::Other });
    }
    motions
}

/// Two `%` in front of the program: a control that takes the second for the end would execute nothing, one that does
/// not all of it.
fn opened_twice(words: &Words<'_, '_, '_>) -> Box<Diagnostic> {
    let whole = Span { start: 0, end: words.block.bytes.trim_ascii_end().len() as u32 };
    words.refuse(refusal::TWO_PERCENT_SIGNS, whole)
}

/// M codes that the dialect's table names.
fn miscellaneous(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    moved: &mut Moved,
) -> Outcome<()> {
    for &(number, span) in &words.m_codes {
        let Some(row) = env.dialect.m_code(number) else { continue };
        if row.loses_position.contains(&true) {
            let own = matches!(moved.motions.as_slice(), [] | [Motion::Uncorrected { .. }]);
            if !own {
                return Err(call::moves_itself(words, span));
            }
            moved.motions = leave(env, row, words.block.line, state);
        }
        if row.ends_program {
            state.progress = Progress::Ended;
        }
    }
    Ok(())
}

impl Interpreter<'_> {
    /// What plain lines mean now, and where X, Y, Z stand, mm; `None` where none is to be taken for plain.
    #[inline]
    pub fn plain_feeds(&mut self) -> Option<(&PlainFeeds, [f64; 3])> {
        if let Plain::Unasked = self.plain {
            self.plain = Plain::of(&self.env, &self.modal);
        }
        let Plain::Yes(feeds) = &self.plain else { return None };
        let [Axis::At(x), Axis::At(y), Axis::At(z)] = self.modal.axes.linear else { return None };
        Some((feeds, [x, y, z]))
    }

    /// Executes plain lines, of which this is the last and `feed` the last F ([`PlainFeeds::end_of`]).
    #[inline]
    pub fn go_to(&mut self, end: &PlainEnd, feed: Option<Decimal>) {
        self.modal.axes.linear = end.end_mm.map(Axis::At);
        if feed.is_some() {
            self.modal.last_feed = self.modal.last_feed.after(self.modal.feed_mode, &self.modal, feed);
        }
    }
}
