//! What a program has brought about before a line: modes, tool, spindle, and where each axis stands in its play.

use diagnostic::Diagnostic;
use machine_model::{Command, Play, Vector};
use nc_dialect::{Action, Dialect, PathKey};
use nc_program::process::{BlockSays, Process, Said, said};
use nc_program::{Interpreter, ToolLength, Units, WorkOffset};
use nc_syntax::Block;
use path_comparison::Way;
use smallvec::SmallVec;
use toolpath::{Feed, Motion, Partial, Position, Shape};
use units::decimal::Decimal;

use crate::job::Job;

/// M codes that leave nothing behind, or what the tool tells: stops, ends, a tool change, overrides.
const PASSING_M: [u16; 8] = [0, 1, 2, 6, 30, 48, 49, 60];
/// A curve by control points is gone along in so many steps.
const CURVE_STEPS: u32 = 64;

/// An F as it was written, and what it was then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FeedWord {
    pub(super) number: Decimal,
    pub(super) mode: nc_program::modal::FeedMode,
    pub(super) units: Units,
}

/// Tool, length and zero that a height belongs to.
type Setting = (Option<u32>, ToolLength, WorkOffset);

/// What a program has brought about so far.
#[derive(Clone)]
pub(super) struct State<'a> {
    pub(super) job: &'a Job<'a>,
    pub(super) interpreter: Interpreter<'a>,
    /// What the program itself has said.
    pub(super) process: Process,
    /// What a code that is no mode, or a command, says of keeping to the path.
    pub(super) path: Option<String>,
    pub(super) feed: Option<FeedWord>,
    /// A tool was brought in.
    pub(super) changed_tool: bool,
    /// M3, M4, M13, M14.
    pub(super) spindle: Option<u16>,
    pub(super) coolant: SmallVec<[u16; 2]>,
    /// What else it has switched, and in which line.
    pub(super) others: Vec<(String, u64)>,
    /// G98 or G99 was said.
    pub(super) return_said: bool,
    pub(super) play: Play,
    /// Where the axes were commanded to last.
    pub(super) at: Command,
    /// What brought Z up last was a rapid: it stands in the air.
    pub(super) rose_by_rapid: bool,
    /// The highest Z, axis command, mm, with each tool and zero.
    highest: Vec<(Setting, f64)>,
}

impl<'a> State<'a> {
    pub(super) fn new(job: &'a Job<'a>) -> Self {
        Self {
            job,
            interpreter: Interpreter::new(job.dialect, job.setup),
            process: Process::default(),
            path: None,
            feed: None,
            changed_tool: false,
            spindle: None,
            coolant: SmallVec::new(),
            others: Vec::new(),
            return_said: false,
            play: Play::unknown(),
            at: Command::default(),
            rose_by_rapid: false,
            highest: Vec::new(),
        }
    }

    /// Takes in a block; true where it moves an axis to a place that it names.
    pub(super) fn step(&mut self, block: &Block<'_>) -> Result<bool, Vec<Diagnostic>> {
        let step = self.interpreter.step(block)?;
        self.changed_tool |= changes_tool(self.job.dialect, block);
        let BlockSays { before: says, behind } = said(block, self.job.dialect, &step);
        for one in says.into_iter().chain(behind) {
            match one {
                Said::Feed(_) => self.feed_word(block),
                Said::Setting(setting) => self.process.set(setting),
                Said::Deed(deed) => self.deed(&deed.to_string(), block.line),
            }
        }
        self.return_said |= block.words().any(|word| {
            use nc_dialect::Action::{ReturnInitial, ReturnR};
            let row = word.g_code().and_then(|code| self.job.dialect.code(code));
            row.is_some_and(|row| matches!(row.action, ReturnInitial | ReturnR))
        });
        self.at.tool_mm = Vector::from(step.context.tool_mm);
        step.motions.iter().for_each(|motion| self.moved(motion));
        Ok(step.motions.iter().any(|motion| !matches!(motion, Motion::Uncorrected { .. })))
    }

    fn feed_word(&mut self, block: &Block<'_>) {
        let modal = self.interpreter.modal();
        let number = block.word(b'F').and_then(|word| word.number());
        self.feed = number.map(|number| FeedWord {
            number: number.decimal,
            mode: modal.feed_mode,
            units: modal.units,
        });
    }

    /// Something is done once, `M8`, `G5.1 Q1`.
    fn deed(&mut self, deed: &str, line: u64) {
        let says_path = |key: &PathKey| match key {
            PathKey::Code(code) => deed.split(' ').next() == Some(&code.to_string()),
            PathKey::Command(name) => deed.starts_with(&name.to_ascii_uppercase()),
        };
        if self.job.dialect.path_control.iter().any(|row| says_path(&row.key)) {
            self.path = Some(deed.to_owned());
            return;
        }
        let Some(code) = deed.strip_prefix('M').and_then(|code| code.parse::<u16>().ok()) else {
            if !deed.starts_with('G') {
                self.others.push((deed.to_owned(), line));
            }
            return;
        };
        match code {
            3 | 4 | 13 | 14 => self.spindle = Some(code),
            5 | 19 => self.spindle = None,
            7 | 8 => self.coolant.extend(Some(code).filter(|code| !self.coolant.contains(code))),
            9 => self.coolant.clear(),
            _ if PASSING_M.contains(&code) => {}
            _ => self.others.push((deed.to_owned(), line)),
        }
    }

    fn moved(&mut self, motion: &Motion) {
        let from_mm = self.at.linear_mm[2];
        match motion {
            Motion::Rapid { end, .. } | Motion::Uncorrected { end, .. } => self.go_if_known(end),
            Motion::Feed(feed) => {
                self.rise(feed.start.linear_mm[2]);
                along(feed, |place| self.go(place));
            }
            Motion::Hole(hole) => {
                self.rise(hole.start.linear_mm[2]);
                let normal = hole.plane.axes()[2];
                let mut above = hole.at_r;
                above.linear_mm[normal] = hole.start.linear_mm[normal];
                let mut bottom = hole.at_r;
                bottom.linear_mm[normal] = hole.bottom_mm;
                [above, bottom, hole.end()].iter().for_each(|place| self.go(place));
            }
        }
        let rises = self.at.linear_mm[2] - from_mm;
        if rises != 0.0 || matches!(motion, Motion::Hole(_)) {
            self.rose_by_rapid =
                matches!(motion, Motion::Hole(_)) || (rises > 0.0 && !matches!(motion, Motion::Feed(_)));
        }
    }

    /// The highest Z, axis command, mm, that was commanded with the tool and the zero in force.
    pub(super) fn highest_mm(&self) -> Option<f64> {
        let here = self.setting();
        self.highest.iter().find(|(setting, _)| *setting == here).map(|(_, z_mm)| *z_mm)
    }

    fn setting(&self) -> Setting {
        let modal = self.interpreter.modal();
        (modal.tool_loaded, modal.tool_length, modal.work_offset)
    }

    fn rise(&mut self, z_mm: f64) {
        let here = self.setting();
        match self.highest.iter_mut().find(|(setting, _)| *setting == here) {
            Some((_, known_mm)) => *known_mm = known_mm.max(z_mm),
            None => self.highest.push((here, z_mm)),
        }
    }

    fn go(&mut self, place: &Position) {
        self.rise(place.linear_mm[2]);
        self.at.linear_mm = Vector::from(place.linear_mm);
        self.at.rotary_rad = Vector::from(place.rotary_deg.map(f64::to_radians));
        self.play.go(self.job.models.axes, &self.at);
        self.play.turn(self.job.models.axes, &self.at, [true; 3]);
    }

    fn go_if_known(&mut self, end: &Partial) {
        for axis in 0..3 {
            self.at.linear_mm[axis] = end.linear_mm[axis].unwrap_or(self.at.linear_mm[axis]);
        }
        self.at.rotary_rad = Vector::from(end.rotary_deg.map(f64::to_radians));
        self.play.go(self.job.models.axes, &self.at);
        self.play.turn(self.job.models.axes, &self.at, end.rotary_known);
        for axis in (0..3).filter(|axis| end.linear_mm[*axis].is_none()) {
            self.play.forget(axis, None);
        }
        end.linear_mm[2].into_iter().for_each(|z_mm| self.rise(z_mm));
    }
}

/// The places of a motion to which each axis goes one way only, from the first behind its start to its end.
fn along(feed: &Feed, mut go: impl FnMut(&Position)) {
    let way = Way::of(feed);
    let inner: Vec<(f64, [f64; 3])> = match feed.shape {
        Shape::Line | Shape::Arc(_) => way.turns().into_iter().map(|s| (s, way.at(s).into())).collect(),
        Shape::Bezier(curve) => {
            let shares = (1..CURVE_STEPS).map(|k| f64::from(k) / f64::from(CURVE_STEPS));
            shares.map(|s| (s, curve.at(&feed.start.linear_mm, &feed.end.linear_mm, s))).collect()
        }
    };
    for (s, linear_mm) in inner {
        let turned = |axis: usize| s * (feed.end.rotary_deg[axis] - feed.start.rotary_deg[axis]);
        let rotary_deg = [0, 1, 2].map(|axis| feed.start.rotary_deg[axis] + turned(axis));
        go(&Position { linear_mm, rotary_deg });
    }
    go(&feed.end);
}

/// A block brings in another tool.
#[must_use]
pub fn changes_tool(dialect: &Dialect, block: &Block<'_>) -> bool {
    block.words().filter(|word| word.letter == b'M').any(|word| {
        let code = word.number().and_then(|number| u16::try_from(number.integer()?).ok());
        code.and_then(|code| dialect.m_code(code)).is_some_and(|row| row.changes_tool)
    })
}

/// A block switches cutter compensation on.
pub(super) fn compensates(dialect: &Dialect, block: &Block<'_>) -> bool {
    let mut rows = block.words().filter_map(|word| word.g_code().and_then(|code| dialect.code(code)));
    rows.any(|row| matches!(row.action, Action::Compensation(_)))
}
