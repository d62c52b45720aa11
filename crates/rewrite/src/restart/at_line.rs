//! What blocks of a program bring about: what is in force behind them, where the axes stand, and what is written for
//! them.

use std::ops::Range;

use diagnostic::Diagnostic;
use nc_emit::BlockNumbers;
use nc_program::modal::Axis;
use nc_program::process::Process;
use nc_syntax::{Block, Reader};

use super::state::State;
use crate::job::Job;
use crate::pass::Pass;

/// Who waits is asked again behind so many bytes.
const ASKED_BYTES: u64 = 1 << 15;

/// What blocks of a program bring about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Brought {
    /// Codes and words in force behind them, as the display of a control lists them: `G1`, `G90`, `T2`, `F500`.
    pub in_force: Vec<String>,
    /// X, Y, Z behind them as words of the program would say them, in its unit.
    pub program: [Option<f64>; 3],
    /// X, Y, Z behind them: axis commands, mm.
    pub command_mm: [Option<f64>; 3],
    /// What the correction writes for them.
    pub written: Vec<u8>,
}

/// What the blocks of a plain program that begin in a span bring about.
///
/// `goes_on` is asked now and then, and ends the work with an error of its own.
///
/// # Errors
/// Why the program cannot be corrected up to their end, or what `goes_on` said.
pub fn brought_about<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    span: &Range<u64>,
    mut goes_on: impl FnMut() -> Result<(), E>,
) -> Result<Brought, E> {
    let mut state = State::new(job);
    state.process = Process::at_start(job.dialect);
    let (mut reader, mut block) = (Reader::new(text, job.dialect), Block::default());
    let mut asked = 0;
    while reader.next(&mut block) && block.offset < span.end {
        state.step(&block)?;
        if block.offset >= asked {
            goes_on()?;
            asked = block.offset + ASKED_BYTES;
        }
    }
    let written = written(text, job, span, goes_on)?;
    let modal = state.interpreter.modal();
    let command_mm = modal.axes.linear.map(Axis::known);
    Ok(Brought { in_force: in_force(&state), program: modal.places(), command_mm, written })
}

/// What a pass writes for the blocks of a span.
fn written<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    span: &Range<u64>,
    mut goes_on: impl FnMut() -> Result<(), E>,
) -> Result<Vec<u8>, E> {
    let numbers = BlockNumbers::new();
    let state = crate::state::State::new(job, &numbers);
    let mut pass = Pass::new(job, state, span.end as usize);
    let mut reader = Reader::new(text, job.dialect);
    let mut begin = None;
    let ends = |pass: &mut Pass<'_>, offset: u64| {
        if offset >= span.start && begin.is_none() {
            begin = Some(pass.out.len());
        }
        goes_on()?;
        let next = if begin.is_some() { span.end } else { span.start };
        pass.next_stop = next.min(offset + ASKED_BYTES);
        Ok(offset >= span.end)
    };
    pass.run::<E>(&mut reader, ends, |_| Ok(()))?;
    let begin = begin.unwrap_or(pass.out.len());
    Ok(pass.out.split_off(begin))
}

/// The motion code, the mode of each group, words and switches that hold.
fn in_force(state: &State<'_>) -> Vec<String> {
    let modal = state.interpreter.modal();
    let word = |letter: u8| state.process.word(letter).map(|word| word.to_string());
    let tool = modal.tool_loaded.map(|tool| format!("T{tool}"));
    let switches = state.spindle.into_iter().chain(state.coolant.iter().copied());
    let feed = state.feed.map(|feed| format!("F{}", feed.number.to_f64()));
    (modal.motion_code().map(|code| code.to_string()).into_iter())
        .chain(state.process.modes().map(|(_, mode)| mode))
        .chain(tool)
        .chain([b'H', b'D', b'S'].into_iter().filter_map(word))
        .chain(switches.map(|code| format!("M{code}")))
        .chain(feed)
        .collect()
}
