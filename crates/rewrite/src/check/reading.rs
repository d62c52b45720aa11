//! A program as the steps that the comparison asks for, block by block.

use std::collections::{BTreeMap, HashMap};

use correction::{HELD_RAD, Orientation};
use diagnostic::Diagnostic;
use machine_model::{Command, Placement, SolveError, Vector};
use nc_dialect::{Action, Dialect};
use nc_expand::Expanded;
use nc_program::process::{BlockSays, Deed, Process, Said, said};
use nc_program::{Context, Interpreter};
use nc_syntax::{Block, GCode, Reader};
use path_comparison::{Act, LEVER_MM, Pointing, Step};
use smallvec::SmallVec;
use toolpath::{CycleKind, Division, Feed, FeedRate, Motion, Position, Shape};

use super::unsaid::Unsaid;
use crate::control::{ControlPart, radii_apart};
use crate::datum::{Datum, LastDatum, going_on};
use crate::feed::minutes;
use crate::job::Job;
use crate::lag::Turns;
use crate::notices::other_tool;
use crate::path_mode::PathMode;

/// What becomes of blocks under `/`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Optional {
    Executed,
    Skipped,
}

/// The processes and deeds of two programs by number: what is alike has one number.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    processes: Vec<Process>,
    process_numbers: HashMap<Process, u32>,
    deeds: Vec<Deed>,
    deed_numbers: HashMap<Deed, u32>,
}

impl Numbers {
    fn of_process(&mut self, process: &Process) -> u32 {
        number(process, &mut self.processes, &mut self.process_numbers)
    }

    fn of_deed(&mut self, deed: &Deed) -> u32 {
        number(deed, &mut self.deeds, &mut self.deed_numbers)
    }

    /// What was numbered.
    pub(super) fn process(&self, number: u32) -> Option<&Process> {
        self.processes.get(number as usize)
    }

    /// What was numbered.
    pub(super) fn deed(&self, number: u32) -> String {
        self.deeds.get(number as usize).map(Deed::to_string).unwrap_or_default()
    }
}

fn number<T: Clone + Eq + std::hash::Hash>(
    value: &T,
    all: &mut Vec<T>,
    numbers: &mut HashMap<T, u32>,
) -> u32 {
    if let Some(number) = numbers.get(value) {
        return *number;
    }
    let number = all.len() as u32;
    all.push(value.clone());
    numbers.insert(value.clone(), number);
    number
}

/// The error of touched zeros, mm, and the context in which each was used first.
pub(super) type Touched = Vec<(Placement, Context)>;

/// A program under way.
pub(super) struct Program<'a, 'n> {
    job: &'a Job<'a>,
    expanded: &'a Expanded<'a>,
    optional: Optional,
    reader: Reader<'a>,
    block: Block<'a>,
    interpreter: Interpreter<'a>,
    numbers: &'n std::cell::RefCell<Numbers>,
    process: Process,
    /// The number of the process, and of the same for what is known by its time, while they are what they were.
    process_numbers: Option<[u32; 2]>,
    feed: Option<f64>,
    datum: LastDatum,
    /// [`Command::datum`] of the last motion.
    placed: Option<Placement>,
    /// Touched zeros in which something was cut.
    pub(super) datums: Vec<Datum>,
    /// What the control adds to the path.
    pub(super) control: ControlPart,
    /// Of lines that cannot be held within the tolerance, how far they may be off, mm.
    pub(super) accepted: Option<&'n BTreeMap<u64, f64>>,
    /// Where asked for: the error of each of them, and in which context it was used first.
    pub(super) touched: Option<&'n std::cell::RefCell<Touched>>,
    /// What it leaves to the control's start.
    pub(super) unsaid: Unsaid<'a>,
    ready: SmallVec<[Step; 4]>,
    ended: bool,
    /// Why it cannot be read on.
    pub(super) refused: Option<Vec<Diagnostic>>,
    /// A block may be skipped.
    pub(super) may_skip: bool,
    /// Gets the share that is read.
    progress: &'n dyn Fn(f64),
    /// Where it is reported next, bytes.
    report_at: u64,
    /// What a line of a file is called.
    line_name: fn((usize, u64)) -> u64,
}

/// Where rotary axes turn a program may be told by its time what the other tells by a speed.
fn by_time(dialect: &Dialect, mut motion: Motion, context: &Context, feed: Option<f64>) -> Motion {
    if let (Motion::Feed(turning), Some(feed)) = (&mut motion, feed)
        && (turning.rate, turning.shape) == (FeedRate::PerMinute, Shape::Line)
        && turning.start.rotary_deg != turning.end.rotary_deg
    {
        let [linear_mm, turned_deg] =
            [|place: &Position| place.linear_mm, |place: &Position| place.rotary_deg]
                .map(|of| (Vector::from(of(&turning.end)) - Vector::from(of(&turning.start))).norm());
        if let Some(minutes) = minutes(dialect, context, [linear_mm, turned_deg], feed / context.unit_mm) {
            turning.rate = FeedRate::InverseTime(1.0 / minutes);
        }
    }
    motion
}

/// Room above what the correction proves of a motion: it adds in another order, mm.
const ROOM_MM: f64 = 2e-5;

/// Of a file so many lines are told apart from those of the next.
const LINES_OF_A_FILE: u64 = 1 << 32;

/// The file and the line of a [`Program::with_files`].
pub(super) const fn file_and_line(name: u64) -> (usize, u64) {
    ((name / LINES_OF_A_FILE) as usize, name % LINES_OF_A_FILE)
}

/// Progress is reported so many times.
const PARTS: u64 = 1000;

impl<'a, 'n> Program<'a, 'n> {
    pub(super) fn new(
        expanded: &'a Expanded<'a>,
        job: &'a Job<'a>,
        optional: Optional,
        numbers: &'n std::cell::RefCell<Numbers>,
        progress: &'n dyn Fn(f64),
    ) -> Self {
        Self {
            job,
            expanded,
            optional,
            reader: Reader::new(expanded.text(), job.dialect),
            block: Block::default(),
            interpreter: Interpreter::new(job.dialect, job.setup),
            numbers,
            process: match job.path_mode {
                PathMode::AsPosted => Process::at_start(job.dialect),
                _ => Process::at_start(job.dialect).without_path_control(job.dialect),
            },
            process_numbers: None,
            feed: None,
            datum: LastDatum::default(),
            placed: None,
            datums: Vec::new(),
            control: ControlPart::default(),
            touched: None,
            accepted: None,
            unsaid: Unsaid::at_start(job.dialect),
            ready: SmallVec::new(),
            ended: false,
            refused: None,
            may_skip: false,
            progress,
            report_at: 0,
            line_name: |(_, line)| line,
        }
    }

    /// The same, lines named together with their file: [`file_and_line`].
    pub(super) fn with_files(mut self) -> Self {
        self.line_name = |(file, line)| file as u64 * LINES_OF_A_FILE + line;
        self
    }

    /// The next block's steps; false behind the last one.
    fn block(&mut self) -> bool {
        let mut block = std::mem::take(&mut self.block);
        let read = !self.ended && self.reader.next(&mut block);
        if read {
            if block.offset >= self.report_at {
                let bytes = self.expanded.text().len().max(1) as u64;
                (self.progress)(block.offset as f64 / bytes as f64);
                self.report_at = block.offset + bytes / PARTS;
            }
            let before = self.interpreter.modal().axes;
            match self.interpreter.step(&block) {
                Err(diagnostics) => (self.refused, self.ended) = (Some(diagnostics), true),
                Ok(mut step) => {
                    let aside = block.switches() != 0;
                    self.may_skip |= aside;
                    // A turn of rotary axes alone at feed rate is a feed as any other.
                    for motion in &mut step.motions {
                        if let Some(turn) = self.turned_at_feed(motion, &before, &step.context) {
                            *motion = turn;
                        }
                    }
                    let says = said(&block, self.job.dialect, &step);
                    if !aside || self.optional == Optional::Executed {
                        self.take(&block, says, &step.motions, &step.context);
                    }
                    self.ended |= step.ends_program && (!aside || self.optional == Optional::Executed);
                }
            }
        }
        if !read && !self.ended {
            self.refused = self.interpreter.unfinished().map(|(unfinished, _)| vec![unfinished]);
        }
        self.block = block;
        read && self.refused.is_none()
    }

    fn take(&mut self, block: &Block<'a>, says: BlockSays, motions: &[Motion], context: &Context) {
        let line = (self.line_name)(self.expanded.source_line(block.line));
        let stated_mm =
            self.accepted.and_then(|accepted| accepted.get(&block.line)).map_or(0.0, |mm| mm + ROOM_MM);
        let limit_mm = (self.job.options.tolerance_mm + rounding_mm(self.job, context)).max(stated_mm);
        self.unsaid.say(block, self.job.dialect);
        says.before.into_iter().for_each(|said| self.say(said, line, limit_mm));
        if self.process.move_by(&context.kinematics) {
            self.process_numbers = None;
        }
        for motion in motions {
            if let Some(unknown) = self.other_tool(block, motion, context) {
                (self.refused, self.ended) = (Some(vec![unknown]), true);
                return;
            }
            let told = by_time(self.job.dialect, *motion, context, self.feed);
            self.unsaid.rely(motion, line);
            let (process, [dwell, cycle]) = match motion {
                Motion::Hole(hole) => {
                    let in_cycle = self.process.in_cycle(self.interpreter.modal().cycle.as_ref());
                    let dwell = hole.cycle.dwell.map(|time| Deed::dwell(self.job.dialect, time));
                    let [own, _] = self.in_force();
                    let mut numbers = self.numbers.borrow_mut();
                    let cycle = numbers.of_process(&in_cycle);
                    // What is bound to the spindle cannot be written as moves.
                    let bound = hole.cycle.kind == CycleKind::Synchronised;
                    let process = if bound { cycle } else { own };
                    (process, [dwell.map(|dwell| numbers.of_deed(&dwell)), Some(cycle).filter(|_| !bound)])
                }
                Motion::Feed(_) if context.thread => {
                    let code = context.motion_code.unwrap_or(GCode(0));
                    let process = self.process.in_thread(code, block);
                    (self.numbers.borrow_mut().of_process(&process), [None; 2])
                }
                _ => (self.in_force()[usize::from(told.inverse_time().is_some())], [None; 2]),
            };
            let feed = self.feed.filter(|_| motion.inverse_time().is_none());
            let (tool_mm, kinematics) = (context.tool_mm, context.kinematics);
            let datum = self.datum.placement(self.job.datums, self.job.machine(), context);
            let cuts = matches!(motion, Motion::Feed(_) | Motion::Hole(_));
            if let Motion::Feed(feed) = &motion {
                let modal = self.interpreter.modal();
                let place = || (block.file_range(), line);
                self.control.cut(self.job, modal, place);
                self.control.lag(self.job, modal, Turns::of(feed), [modal.last_feed], place);
                let apart = radii_apart(motion).unwrap_or_default();
                self.control.arc(self.job, modal, (feed, apart), (&block.file_range(), line));
            }
            if let Some(datum) = cuts.then(|| self.datum.newly_used()).flatten()
                && !self.datums.iter().any(|known| known.is(datum))
            {
                self.datums.push(datum.clone());
                if let Some(touched) = self.touched {
                    touched.borrow_mut().push((datum.placement, context.clone()));
                }
            }
            let motion = going_on(&self.job.models, &told, context, datum, &mut self.placed);
            let act = Act::Motion { motion, tool_mm, datum, kinematics, feed, dwell, cycle };
            let pointing = self.pointing(&motion, context);
            // Where directions are compared they are by themselves.
            let turned_mm = if pointing.is_some() { 0.0 } else { self.turn_rounding_mm(&motion) };
            let limit_mm = (limit_mm * limit_mm + turned_mm * turned_mm).sqrt();
            self.ready.push(Step {
                act,
                line,
                process,
                limit_mm,
                compensated: context.compensation.is_some(),
                pointing,
            });
        }
        says.behind.into_iter().for_each(|said| self.say(said, line, limit_mm));
    }

    fn say(&mut self, said: Said, line: u64, limit_mm: f64) {
        match said {
            Said::Feed(feed) => self.feed = Some(feed),
            Said::Setting(setting) => {
                self.process.set(setting);
                if self.job.path_mode != PathMode::AsPosted {
                    // Written in front of feeds: what the control adds then is told beside the verdict.
                    self.process = self.process.clone().without_path_control(self.job.dialect);
                }
                self.process_numbers = None;
            }
            Said::Deed(deed) => {
                let [process, _] = self.in_force();
                let act = Act::Deed(self.numbers.borrow_mut().of_deed(&deed));
                self.ready.push(Step { act, line, process, limit_mm, compensated: false, pointing: None });
            }
        }
    }

    /// How far a direction may be off, where directions are corrected: so far as it is uncorrected near a singularity, and
    /// where rotary axes lag behind one.
    fn pointing(&self, motion: &Motion, context: &Context) -> Option<Pointing> {
        /// Last bits, and what a direction changes by between the places that are looked at.
        const ROOM: f64 = 1.05;
        let Orientation::Full(limits) = self.job.options.orientation else { return None };
        let leans_rad = self.job.options.orientation_rad + 1e-9;
        let model = self.job.models.of(context.kinematics).unwrap_or(self.job.models.axes);
        let mut most_rad = 0.0_f64;
        if let Motion::Feed(feed) = motion {
            let mix = |a: [f64; 3], b: [f64; 3], s: f64| Vector::from(a) * (1.0 - s) + Vector::from(b) * s;
            let turns = feed.start.rotary_deg != feed.end.rotary_deg;
            let places = if turns { 16 } else { 2 };
            for k in 0..=places {
                let s = f64::from(k) / f64::from(places);
                let at = Command {
                    linear_mm: mix(feed.start.linear_mm, feed.end.linear_mm, s),
                    rotary_rad: mix(feed.start.rotary_deg, feed.end.rotary_deg, s).map(f64::to_radians),
                    tool_mm: context.tool_mm.into(),
                    direction: [0; 3],
                    ..Default::default()
                };
                most_rad = most_rad.max(model.tilt_rad(&at));
            }
        }
        Some(Pointing {
            leans_rad,
            leans_near_rad: leans_rad + ROOM * most_rad,
            // So far from it the last of what an axis is turned aside by is taken back, in the last piece that is held.
            near_sin: limits.least_sin + limits.most_turn_rad / limits.most_share + HELD_RAD,
            aside_deg: limits.most_turn_rad.to_degrees() * ROOM,
        })
    }

    /// The numbers of the process in force and of the same for a motion that is known by its time.
    fn in_force(&mut self) -> [u32; 2] {
        *self.process_numbers.get_or_insert_with(|| {
            let by_time = self.process.by_time(self.job.dialect);
            [&self.process, &by_time].map(|process| self.numbers.borrow_mut().of_process(process))
        })
    }

    /// The refusal of a cut with a tool that the model knows nothing of.
    fn other_tool(&self, block: &Block<'_>, motion: &Motion, context: &Context) -> Option<Diagnostic> {
        if !matches!(motion, Motion::Feed(_) | Motion::Hole(_)) {
            return None;
        }
        let (linear_mm, rotary_rad, direction) = (Vector::zeros(), Vector::zeros(), [0; 3]);
        let command = Command {
            linear_mm,
            rotary_rad,
            tool_mm: context.tool_mm.into(),
            direction,
            ..Default::default()
        };
        match self.job.models.axes.knows(&command) {
            Err(error @ SolveError::OtherTool { .. }) => Some(other_tool(&error, block.file_range())),
            _ => None,
        }
    }

    /// What the rounding of rotary words adds where they turn on a feed's way: half a step each, as the comparison sees it.
    fn turn_rounding_mm(&self, motion: &Motion) -> f64 {
        let Motion::Feed(Feed { start, end, .. }) = motion else { return 0.0 };
        let half_rad = |axis: usize| {
            let (decimals, steps) = self.job.rotary_steps[axis];
            let step_deg = f64::from(steps) / f64::from(10u32.pow(u32::from(decimals)));
            if start.rotary_deg[axis] == end.rotary_deg[axis] { 0.0 } else { 0.5 * step_deg.to_radians() }
        };
        let [a, b, c] = [0, 1, 2].map(half_rad);
        LEVER_MM * (a * a + b * b + c * c).sqrt()
    }

    fn turned_at_feed(
        &self,
        motion: &Motion,
        before: &nc_program::modal::Axes,
        context: &Context,
    ) -> Option<Motion> {
        let Motion::Uncorrected { end, .. } = motion else { return None };
        let code = self.job.dialect.code(context.motion_code?)?;
        let start = before.partial().complete()?;
        let end = end.complete()?;
        let feeds = code.action == Action::Line
            && start.linear_mm == end.linear_mm
            && start.rotary_deg != end.rotary_deg;
        let feed = |start: Position, end: Position| {
            let rate = FeedRate::PerMinute;
            Motion::Feed(Feed { start, end, shape: Shape::Line, rate, division: Division::OneBehindLines })
        };
        feeds.then(|| feed(start, end))
    }
}

impl Iterator for Program<'_, '_> {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        while self.ready.is_empty() {
            if !self.block() {
                return None;
            }
            self.ready.reverse();
        }
        self.ready.pop()
    }
}

/// What rounding adds to the tolerance: half an output step on each axis, as a distance.
fn rounding_mm(job: &Job<'_>, context: &Context) -> f64 {
    let inch = context.unit_mm != 1.0;
    let decimals = if inch { [job.dialect.output.decimals_inch; 3] } else { job.decimals_mm };
    let half =
        [0, 1, 2].map(|axis| 0.5 * context.word_mm(axis) / f64::from(10u32.pow(u32::from(decimals[axis]))));
    context.frame.largest_scale().max(1.0) * half.iter().map(|h| h * h).sum::<f64>().sqrt()
}
