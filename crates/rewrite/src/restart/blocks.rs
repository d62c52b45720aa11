//! The blocks that bring a control into a state, and the tool to where it stood.

use diagnostic::{Text, both};
use nc_dialect::{Action, MOTION_GROUP};
use nc_program::modal::{Axis, Distance, FeedMode, Modal, MotionMode, Progress, ReturnLevel, Transform};
use nc_program::{Compensation, ToolLength};
use nc_syntax::{Block, GCode};
use toolpath::{AXIS_NAMES, Kinematics};
use units::decimal::{self, Decimal};

use super::state::{FeedWord, State, changes_tool};
use crate::words::word;

/// Words of a restart have so many decimals at most.
const DECIMALS: u8 = 6;
/// So far above the place the tool comes down at feed, mm, and so fast, mm/min.
const LAST_MM: f64 = 1.0;
const LAST_FEED_MM_MIN: f64 = 100.0;
/// An axis with play comes from so many reversal values away.
const REVERSALS: f64 = 2.0;
/// Plays below this are none, mm.
const NO_PLAY_MM: f64 = 1e-6;
/// Places nearer than this are one, mm.
const SAME_MM: f64 = 1e-6;

/// The blocks, or why there are none.
pub(super) fn blocks(state: &State<'_>, next: &Block<'_>, safe_mm: Option<f64>) -> Result<Vec<String>, Text> {
    let modal = state.interpreter.modal();
    may_begin(modal)?;
    let mut writer = Writer { state, modal, blocks: Vec::new() };
    writer.modes();
    if changes_tool(state.job.dialect, next) {
        // What the old tool did is over.
        writer.blocks.extend(state.process.word(b'S').map(|speed| speed.to_string()));
    } else {
        goes_on(state, next)?;
        writer.tool()?;
        writer.spindle();
        writer.approach(next, safe_mm)?;
    }
    writer.rest(next)?;
    Ok(writer.blocks)
}

/// What cannot be brought about by blocks of its own.
fn may_begin(modal: &Modal) -> Result<(), Text> {
    let refused = |is: bool, why: Text| if is { Err(why) } else { Ok(()) };
    refused(
        modal.progress == Progress::Ended,
        both!("the program has ended there", "программа там уже закончилась"),
    )?;
    refused(
        modal.aside.is_some(),
        both!("it lies among blocks that may be skipped", "она среди кадров, которые могут быть пропущены"),
    )?;
    refused(
        modal.compensation != Compensation::Off || !modal.offset.is_off(),
        both!("cutter compensation is in force", "действует коррекция на радиус"),
    )?;
    refused(
        modal.curve.is_some() || modal.curve_leaves_mm.is_some() || modal.plane_begun.is_some(),
        both!(
            "it lies inside a curve, or a plane, of several blocks",
            "она внутри кривой или плоскости из нескольких кадров"
        ),
    )?;
    refused(
        modal.kinematics != Kinematics::Axes || modal.vectors,
        both!(
            "the control moves the tip, or in a tilted plane",
            "стойка ведёт вершину или работает в наклонной плоскости"
        ),
    )?;
    refused(
        modal.transform != Transform::None
            || modal.shifts.local_mm != [0.0; 3]
            || modal.shifts.preset_mm != [0.0; 3],
        both!("a shift, a rotation or a scaling is in force", "действует сдвиг, поворот или масштаб"),
    )?;
    refused(
        !modal.written.is_empty() || !modal.written_lengths.is_empty() || modal.work_offset.rewritten,
        both!("the program has written offsets (G10)", "программа записала смещения (G10)"),
    )?;
    refused(
        matches!(modal.tool_length, ToolLength::Written { .. }),
        both!(
            "the tool's length stands in the program (G43.1)",
            "длина инструмента записана в программе (G43.1)"
        ),
    )?;
    refused(
        matches!(modal.return_level, ReturnLevel::Undecided { .. })
            || matches!(modal.motion, MotionMode::Undecided { .. }),
        both!("what is in force depends on a switch", "что действует, зависит от переключателя"),
    )
}

/// A block says itself how it moves, or that no cycle is in force.
fn says_motion(state: &State<'_>, next: &Block<'_>) -> bool {
    let row = |code: GCode| state.job.dialect.code(code);
    let mut rows = next.words().filter_map(|word| word.g_code().and_then(row));
    rows.any(|row| row.group == MOTION_GROUP && !matches!(row.action, Action::Cycle(_)))
}

/// What the block goes on with must be something that a block before it can leave behind.
fn goes_on(state: &State<'_>, next: &Block<'_>) -> Result<(), Text> {
    let modal = state.interpreter.modal();
    if says_motion(state, next) {
        return Ok(());
    }
    if modal.cycle.is_some() {
        return Err(both!("a cycle is in force", "действует цикл"));
    }
    match modal.motion {
        MotionMode::Arc(..) | MotionMode::Thread(_) | MotionMode::Curve(..) => Err(both!(
            "it goes on with {} of a block before it",
            "она продолжает {} из кадра перед ней",
            modal.motion.code().map_or_else(String::new, |code| code.to_string())
        )),
        _ => Ok(()),
    }
}

struct Writer<'w, 'a> {
    state: &'w State<'a>,
    modal: &'w Modal,
    blocks: Vec<String>,
}

impl Writer<'_, '_> {
    fn code(&self, action: &Action) -> Result<String, Text> {
        let row = self.state.job.dialect.row_of(action);
        row.map(|row| row.code.to_string())
            .ok_or_else(|| both!("the dialect has no code that is needed", "у диалекта нет нужного кода"))
    }

    /// The modes that the program has said, as far as they say nothing of places: each with words of its own in its own block.
    fn modes(&mut self) {
        let dialect = self.state.job.dialect;
        let mut plain = Vec::new();
        for (code, text) in self.state.process.modes() {
            let Some(row) = dialect.code(code) else { continue };
            match row.action {
                Action::Incremental
                | Action::FeedInverseTime
                | Action::FeedPerRevolution
                | Action::LengthOn
                | Action::LengthOnNegative
                | Action::LengthFromWords => {}
                _ if text.contains(' ') => self.blocks.push(text),
                _ => plain.push(text),
            }
        }
        if self.modal.distance == Distance::Incremental {
            plain.extend(self.code(&Action::Absolute));
        }
        if self.state.return_said {
            let action = if self.modal.return_level == ReturnLevel::R {
                Action::ReturnR
            } else {
                Action::ReturnInitial
            };
            plain.extend(self.code(&action));
        }
        self.blocks.extend(self.state.path.clone());
        if !plain.is_empty() {
            self.blocks.insert(0, plain.join(" "));
        }
    }

    /// The tool in the spindle.
    fn tool(&mut self) -> Result<(), Text> {
        let change = self.state.job.dialect.m_codes.iter().find(|row| row.changes_tool);
        let named = |tool: u32| self.state.job.setup.tool_names.iter().any(|(_, number)| *number == tool);
        match (self.modal.tool_loaded, change) {
            (Some(tool), Some(change)) if !named(tool) => {
                self.blocks.push(format!("T{tool} M{}", change.number));
            }
            (None, _) if !self.state.changed_tool => {}
            _ => {
                return Err(both!("its tool has a name and no number", "у её инструмента имя, а не номер"));
            }
        }
        Ok(())
    }

    fn spindle(&mut self) {
        let speed = self.state.process.word(b'S').map(|speed| speed.to_string());
        let turns = self.state.spindle.map(|code| format!("M{code}"));
        let block: Vec<String> = speed.into_iter().chain(turns).collect();
        self.blocks.extend(Some(block.join(" ")).filter(|block| !block.is_empty()));
        self.blocks.extend(self.state.coolant.iter().map(|code| format!("M{code}")));
    }

    /// To the place where the tool stood: up, above it, down, each axis from the side from which it came.
    fn approach(&mut self, next: &Block<'_>, safe_mm: Option<f64>) -> Result<(), Text> {
        let rapid = self.code(&Action::Rapid)?;
        let Some(frame) = self.modal.frame.as_ref().filter(|frame| frame.is_shift()) else {
            return Err(both!("the work offset is not known there", "смещение нуля там неизвестно"));
        };
        let unit_mm = self.modal.units.mm();
        let word = |axis: usize, axis_mm: f64| {
            let mut machine_mm = [0.0; 3];
            machine_mm[axis] = axis_mm;
            written(AXIS_NAMES[axis], frame.to_program(machine_mm)[axis] / unit_mm)
        };
        let length = match self.modal.tool_length {
            ToolLength::On { number, negative, .. } => {
                let action = if negative { Action::LengthOnNegative } else { Action::LengthOn };
                format!("{} H{number}", self.code(&action)?)
            }
            _ => String::new(),
        };
        let stands = self.modal.axes.linear.map(Axis::known);
        let (Some(z_mm), Some(highest_mm)) = (stands[2], self.state.highest_mm()) else {
            if stands[..2].iter().any(Option::is_some) {
                return Err(both!(
                    "how high the tool stands there is not known",
                    "на какой высоте там инструмент, неизвестно"
                ));
            }
            // The program itself names Z before it feeds.
            self.blocks.extend(Some(length).filter(|length| !length.is_empty()));
            return Ok(());
        };
        let up_mm = match safe_mm {
            None => highest_mm,
            Some(safe_mm) => frame.to_machine([0.0, 0.0, safe_mm])[2].max(z_mm),
        };
        let up = [rapid.as_str(), &length, &word(2, up_mm)].join(" ").replace("  ", " ");
        self.blocks.push(up);
        self.rotary_and_plane(stands, &rapid, &word);
        let in_force = self.down([up_mm, z_mm], &rapid, &|z_mm| word(2, z_mm))?;
        self.motion_code(next, in_force, &|action, feed| match feed {
            Some(feed) => format!("{action} {} {feed}", word(2, z_mm)),
            None => format!("{action} {}", word(2, z_mm)),
        })
    }

    /// From above to the place, and which motion code is in force there.
    fn down(
        &mut self,
        [up_mm, z_mm]: [f64; 2],
        rapid: &str,
        word: &dyn Fn(f64) -> String,
    ) -> Result<Action, Text> {
        let (model, state) = (self.state.job.models.axes, self.state);
        let reversal_mm = model.reversal_mm(2, &state.at);
        if reversal_mm > NO_PLAY_MM && state.play.side()[2] > 0 {
            if !state.rose_by_rapid {
                return Err(both!(
                    "Z has come up there at feed, and has play, which cannot be had from above",
                    "Z поднялась туда на рабочей подаче, и у неё люфт; сверху так не подойти"
                ));
            }
            // In the air: from a little below, as it came.
            let into_mm = state.play.lag_mm(model, &state.at, state.play.side())[2];
            let mut places = [z_mm - REVERSALS * reversal_mm, z_mm + into_mm, z_mm].map(word).to_vec();
            places.dedup();
            self.blocks.extend(places.iter().map(|place| format!("{rapid} {place}")));
            return Ok(Action::Rapid);
        }
        if up_mm - z_mm <= SAME_MM {
            return Ok(Action::Rapid);
        }
        if state.feed.is_none() {
            // Nothing has been cut.
            self.blocks.push(format!("{rapid} {}", word(z_mm)));
            return Ok(Action::Rapid);
        }
        if up_mm - z_mm > LAST_MM {
            self.blocks.push(format!("{rapid} {}", word(z_mm + LAST_MM)));
        }
        let feed = self.slowly()?;
        self.blocks.push(format!("{} {} {feed}", self.code(&Action::Line)?, word(z_mm)));
        Ok(Action::Line)
    }

    /// F of the way back, per minute.
    fn slowly(&mut self) -> Result<String, Text> {
        if self.modal.feed_mode != FeedMode::PerMinute {
            let speed = self.code(&Action::FeedPerMinute)?;
            self.blocks.push(speed);
        }
        Ok(written('F', (LAST_FEED_MM_MIN / self.modal.units.mm() * 100.0).round() / 100.0))
    }

    /// The motion code that the program goes on with.
    ///
    /// * `there` – a block with a code, and F, that moves to where the tool stands
    fn motion_code(
        &mut self,
        next: &Block<'_>,
        in_force: Action,
        there: &dyn Fn(&str, Option<&str>) -> String,
    ) -> Result<(), Text> {
        if says_motion(self.state, next) {
            return Ok(());
        }
        match (self.modal.motion, in_force) {
            (MotionMode::Line(_), Action::Rapid) => {
                let (line, feed) = (self.code(&Action::Line)?, self.slowly()?);
                self.blocks.push(there(&line, Some(&feed)));
            }
            (MotionMode::Rapid(_), Action::Line) => {
                let rapid = self.code(&Action::Rapid)?;
                self.blocks.push(there(&rapid, None));
            }
            (MotionMode::None, _) => self.blocks.extend(self.code(&Action::CycleCancel)),
            _ => {}
        }
        Ok(())
    }

    /// Above the place.
    fn rotary_and_plane(
        &mut self,
        stands: [Option<f64>; 3],
        rapid: &str,
        word: &dyn Fn(usize, f64) -> String,
    ) {
        let has = self.state.job.setup.has_rotary;
        let turned = (0..3).filter(|axis| has[*axis]).filter_map(|axis| {
            self.modal.axes.rotary[axis].known().map(|deg| written(AXIS_NAMES[3 + axis], deg))
        });
        let turned: Vec<String> = turned.collect();
        if !turned.is_empty() {
            self.blocks.push(format!("{rapid} {}", turned.join(" ")));
        }
        let model = self.state.job.models.axes;
        let (at, side) = (&self.state.at, self.state.play.side());
        let into_mm = self.state.play.lag_mm(model, at, side);
        let mut steps: [Vec<String>; 3] = Default::default();
        for (axis, mm) in (0..2).filter_map(|axis| Some((axis, stands[axis]?))) {
            let (heading, reversal_mm) = (f64::from(side[axis]), model.reversal_mm(axis, at));
            let has_play = reversal_mm > NO_PLAY_MM && side[axis] != 0;
            steps[0].push(word(axis, if has_play { mm - heading * REVERSALS * reversal_mm } else { mm }));
            steps[1].push(word(axis, if has_play { mm + heading * into_mm[axis] } else { mm }));
            steps[2].push(word(axis, mm));
        }
        let mut steps: Vec<String> = steps.into_iter().map(|words| words.join(" ")).collect();
        steps.dedup();
        self.blocks
            .extend(steps.iter().filter(|words| !words.is_empty()).map(|words| format!("{rapid} {words}")));
    }

    /// What must not be in force before: how F and distances are meant, the next tool.
    fn rest(&mut self, next: &Block<'_>) -> Result<(), Text> {
        let (mode, unit) = (self.modal.feed_mode, self.modal.units);
        let code = match mode {
            FeedMode::PerMinute => Action::FeedPerMinute,
            FeedMode::PerRevolution => Action::FeedPerRevolution,
            FeedMode::InverseTime => Action::FeedInverseTime,
        };
        let held = self.state.feed.filter(|feed| feed.mode == mode && feed.units == unit);
        let needs = self.state.feed.is_some() && mode != FeedMode::InverseTime && next.word(b'F').is_none();
        if needs && held.is_none() {
            return Err(both!("which F holds there is not known", "какое F там действует, неизвестно"));
        }
        let feed = held.map(|FeedWord { number, .. }| word(b'F', number));
        let code = self.code(&code).ok().filter(|_| mode != FeedMode::PerMinute);
        let block: Vec<String> = code.into_iter().chain(feed).collect();
        self.blocks.extend(Some(block.join(" ")).filter(|block| !block.is_empty()));
        if self.modal.distance == Distance::Incremental {
            self.blocks.extend(self.code(&Action::Incremental));
        }
        let selected = self.modal.tool_selected.filter(|tool| Some(*tool) != self.modal.tool_loaded);
        self.blocks.extend(selected.filter(|_| next.word(b'T').is_none()).map(|tool| format!("T{tool}")));
        Ok(())
    }
}

/// A word with its point, without zeros behind the last figure that counts.
fn written(letter: char, value: f64) -> String {
    let steps = f64::from(10_u32.pow(DECIMALS.into()));
    word(letter as u8, Decimal { mantissa: decimal::round(value * steps), decimals: DECIMALS })
}
