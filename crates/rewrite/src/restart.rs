//! A program from one of its lines on: the blocks that bring the control, the tool and each axis' play to where the program
//! would have them, then its own lines.
//!
//! What is written is read like any program, and where that does not end in the state of the program before the line, to the
//! last mode and to the side of each play, there is no restart.

mod at_line;
mod blocks;
mod state;

use diagnostic::{Code, Diagnostic, Text, both};
use nc_program::Modal;
use nc_program::modal::{Axis, Progress};
use nc_syntax::{Block, Reader, line_ending};

pub use at_line::{Brought, brought_about};
pub use state::changes_tool;

use crate::job::Job;
use state::State;

/// No restart at a line.
pub const NO_RESTART: Code = Code(550);
/// So many blocks before a line are tried for the nearest one that will do.
const TRIED: usize = 2_000;
/// Commands nearer than this are one, mm: below every output step.
const SAME_MM: f64 = 1e-5;

/// A program from a line on.
#[derive(Clone, Debug, PartialEq)]
pub struct Restarted {
    /// Its bytes.
    pub text: Vec<u8>,
    /// What the program had switched before, that no restart knows how to switch again: `M10` and its line.
    pub left_out: Vec<(String, u64)>,
}

/// Writes a program from a line (from 1) on.
///
/// * `safe_mm` – Z, program coordinates, at which the tool goes to above its place; the highest of the program before with
///   the same tool and zero if not given
///
/// # Errors
/// A block before it that cannot be read; VP0550: why there is no restart there, and the nearest line before where there is.
pub fn restart(
    job: &Job<'_>,
    text: &[u8],
    line: u64,
    safe_mm: Option<f64>,
) -> Result<Restarted, Vec<Diagnostic>> {
    let plain = nc_emit::without_guards(text);
    let program = Program { job, text, plain: plain.as_deref().unwrap_or(text), safe_mm };
    let mut walk = Walk::new(&program);
    while walk.next()? {
        if walk.block.line >= line {
            return program.from(&walk.before()).map_err(|why| vec![program.refusal(&walk, &why)]);
        }
    }
    let why = both!("the program has {} lines", "строк в программе {}", walk.block.line);
    let message = both!("no restart at line {line}", "со строки {line} не начать");
    Err(vec![Diagnostic::error(NO_RESTART, message).help(why)])
}

/// A program read block by block.
struct Walk<'p, 'a> {
    reader: Reader<'p>,
    state: State<'a>,
    /// The block that comes next, the state being that before it.
    block: Block<'p>,
    /// How many have been read, it among them.
    number: usize,
    /// Bytes before the first block that does something.
    leader: u64,
}

/// A block, and what the program has brought about before it.
struct Before<'p, 'a> {
    state: State<'a>,
    block: Block<'p>,
    leader: u64,
}

impl<'p, 'a: 'p> Walk<'p, 'a> {
    fn new(program: &Program<'p, 'a>) -> Self {
        let Program { job, plain, .. } = *program;
        let (reader, state) = (Reader::new(plain, job.dialect), State::new(job));
        Self { reader, state, block: Block::default(), number: 0, leader: 0 }
    }

    /// Takes in the block and reads the next; false behind the last.
    fn next(&mut self) -> Result<bool, Vec<Diagnostic>> {
        if self.number > 0 {
            self.state.step(&self.block)?;
        }
        if !self.reader.next(&mut self.block) {
            return Ok(false);
        }
        self.number += 1;
        if nc_expand::computes(&self.block, self.state.job.dialect) {
            return Err(vec![flows(&self.block)]);
        }
        if matches!(self.state.interpreter.modal().progress, Progress::Leader | Progress::Opened) {
            self.leader = self.block.offset;
        }
        Ok(true)
    }

    fn before(&self) -> Before<'p, 'a> {
        Before { state: self.state.clone(), block: self.block.clone(), leader: self.leader }
    }
}

/// The program has to be plain.
fn flows(block: &Block<'_>) -> Diagnostic {
    let message = both!(
        "a program that computes, jumps or calls is not begun anew in its middle",
        "программу с вычислениями, переходами и вызовами с середины не начать"
    );
    Diagnostic::error(NO_RESTART, message)
        .at(block.file_range(), both!("this block does", "этот кадр такой"))
        .help(both!(
            "correct it first: what vpost writes is plain",
            "сначала исправьте её: vpost пишет простую программу"
        ))
}

struct Program<'p, 'a> {
    job: &'a Job<'a>,
    text: &'p [u8],
    /// The same, guards blanked out.
    plain: &'p [u8],
    safe_mm: Option<f64>,
}

impl Program<'_, '_> {
    /// The program from a block on.
    fn from(&self, before: &Before<'_, '_>) -> Result<Restarted, Text> {
        let mut text = self.head(before)?;
        let Before { state, block, leader } = before;
        let at = if *leader == block.offset {
            0
        } else {
            let line_ends = self.text[..block.offset as usize].iter().rposition(|byte| *byte == b'\n');
            line_ends.map_or(0, |at| at + 1)
        };
        text.extend_from_slice(&self.text[at..]);
        Ok(Restarted { text, left_out: state.others.clone() })
    }

    /// What stands before its own lines; nothing where nothing has been said yet.
    fn head(&self, Before { state, block, leader }: &Before<'_, '_>) -> Result<Vec<u8>, Text> {
        if *leader == block.offset {
            return Ok(Vec::new());
        }
        let end_of_line = line_ending(self.text);
        let mut text = self.text[..*leader as usize].to_vec();
        for block in &blocks::blocks(state, block, self.safe_mm)? {
            text.extend_from_slice(block.as_bytes());
            text.extend_from_slice(end_of_line);
        }
        self.proven(&text, state, block)?;
        Ok(text)
    }

    /// What is written must end in the state in which the program is.
    fn proven(&self, written: &[u8], wanted: &State<'_>, next: &Block<'_>) -> Result<(), Text> {
        let unread = |_| {
            both!(
                "what would bring the control there cannot be read",
                "того, что привело бы туда стойку, не прочесть"
            )
        };
        let mut reached = State::new(self.job);
        let (mut reader, mut block) = (Reader::new(written, self.job.dialect), Block::default());
        while reader.next(&mut block) {
            reached.step(&block).map_err(unread)?;
        }
        let changes = state::changes_tool(self.job.dialect, next);
        if !changes && self.stands_elsewhere(wanted, &reached) {
            return Err(other_side());
        }
        // What the block itself says needs not be in force before it, nor behind a tool change what comes before a motion.
        let mut wanted = wanted.clone();
        let (mut tail, mut one) =
            (Reader::new(&self.plain[next.offset as usize..], self.job.dialect), Block::default());
        while tail.next(&mut one) {
            let [moves, _] = [wanted.step(&one).map_err(unread)?, reached.step(&one).map_err(unread)?];
            if !changes || moves {
                break;
            }
        }
        let d_holds = wanted.process.word(b'D') != reached.process.word(b'D');
        while d_holds && one.word(b'D').is_none() {
            if state::compensates(self.job.dialect, &one) {
                return Err(both!(
                    "G41 without D counts on a D before it",
                    "G41 без D опирается на D перед ней"
                ));
            }
            if !tail.next(&mut one) {
                break;
            }
        }
        let [a, b] = [&wanted, &reached].map(|state| state.interpreter.modal());
        match differs(a, b) {
            Some(what) => Err(both!("{what} cannot be brought about", "{what:#} не восстановить")),
            None if self.stands_elsewhere(&wanted, &reached) => Err(other_side()),
            None => Ok(()),
        }
    }

    fn stands_elsewhere(&self, wanted: &State<'_>, reached: &State<'_>) -> bool {
        let model = self.job.models.axes;
        let known = wanted.interpreter.modal().axes.linear.iter().all(|axis| axis.known().is_some());
        let step_mm = self
            .job
            .decimals_mm
            .map(|decimals| 0.1_f64.powi(decimals.into()))
            .into_iter()
            .fold(0.0, f64::max);
        let [a, b] = [wanted, reached].map(|state| state.play.error_mm(model, &wanted.at));
        known && (a - b).norm() > step_mm
    }

    /// No restart where a walk has come to, and where there is one before.
    fn refusal(&self, walk: &Walk<'_, '_>, why: &Text) -> Diagnostic {
        let at = &walk.block;
        let mut again = Walk::new(self);
        let mut tried = Vec::new();
        while again.number + 1 < walk.number && again.next() == Ok(true) {
            if again.number + TRIED >= walk.number && again.block.acts() {
                tried.push(again.before());
            }
        }
        let nearest =
            tried.iter().rev().find(|before| self.head(before).is_ok()).map(|before| before.block.line);
        let message = both!("no restart at line {}: {why}", "со строки {} не начать: {why:#}", at.line);
        let refusal =
            Diagnostic::error(NO_RESTART, message).at(at.file_range(), both!("this block", "этот кадр"));
        refusal.help(match nearest {
            Some(line) => both!(
                "the nearest line before it is {line}: `--line {line}`",
                "ближайшая строка перед ней — {line}: `--line {line}`"
            ),
            None => both!(
                "begin at a tool change, or at the program's start",
                "начните со смены инструмента или с начала программы"
            ),
        })
    }
}

/// Play is where it cannot be brought to.
fn other_side() -> Text {
    both!(
        "an axis stands on another side of its play than it can be brought to",
        "ось стоит в своём люфте на другой стороне, чем та, к которой её можно подвести"
    )
}

/// In what two states differ, named; `None` where whatever follows means the same.
fn differs(a: &Modal, b: &Modal) -> Option<Text> {
    let place = |modal: &Modal| modal.axes.linear.map(Axis::known);
    let turned = |modal: &Modal| modal.axes.rotary.map(Axis::known);
    let apart = |a: [Option<f64>; 3], b: [Option<f64>; 3]| {
        a.iter().zip(b).any(|(a, b)| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() > SAME_MM,
            (Some(_), None) => true,
            (None, _) => false,
        })
    };
    let rows = [
        (
            a.motion.code() != b.motion.code() || a.cycle.is_some() != b.cycle.is_some(),
            both!("the motion code", "код движения"),
        ),
        (a.plane != b.plane, both!("the plane", "плоскость")),
        ((a.distance, a.arc_centres) != (b.distance, b.arc_centres), both!("G90 or G91", "G90 или G91")),
        ((a.units, a.x_words) != (b.units, b.x_words), both!("the unit", "единица")),
        (a.feed_mode != b.feed_mode, both!("how F is meant", "смысл F")),
        (a.path_control.off_mm != b.path_control.off_mm, both!("how corners are cut", "режим углов")),
        (a.return_level != b.return_level, both!("G98 or G99", "G98 или G99")),
        (a.tool_length != b.tool_length, both!("the tool's length", "длина инструмента")),
        (
            (a.tool_loaded, a.tool_selected) != (b.tool_loaded, b.tool_selected),
            both!("the tool", "инструмент"),
        ),
        (a.work_offset != b.work_offset || a.frame != b.frame, both!("the work offset", "смещение нуля")),
        (apart(place(a), place(b)), both!("the place", "место")),
        (apart(turned(a), turned(b)), both!("the angles", "углы")),
    ];
    rows.into_iter().find_map(|(differs, what)| differs.then_some(what))
}
