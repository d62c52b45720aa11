//! What a line of a program does on the machine.

use std::ops::Range;

use machine_model::Models;
use nc_expand::Expanded;
use nc_syntax::{Block, Reader};
use rewrite::{Brought, Job};

use crate::causes::{Cause, Causes};
use crate::expand::PipelineEnd;
use crate::message::Failure;
use crate::settings::Settings;
use crate::{check, expand};

/// What a line of a program does on the machine.
#[derive(Clone, Debug)]
pub struct AtLine {
    /// What is in force behind it, where it goes and what is written for it.
    pub brought: Brought,
    /// How far the tool is off where nothing is corrected; `None` where the line feeds nowhere.
    pub off: Option<Off>,
}

/// How far the tool is off its path at the place of a line where that is farthest.
#[derive(Clone, Debug, PartialEq)]
pub struct Off {
    /// Real place minus programmed place, mm.
    pub off_mm: [f64; 3],
    /// What each cause makes of it, mm, the largest first; none where the engine does not tell causes apart.
    pub causes: Vec<(Cause, [f64; 3])>,
}

/// What a line (from 1) of a program does; `None` where it is not executed. A line that is executed more than once is
/// told of its first time, and is off by the most of all times.
///
/// `goes_on` is asked now and then, and ends the work with an error of its own.
///
/// # Errors
/// Why the program cannot be corrected up to that line, or what `goes_on` said.
pub fn of(
    (name, text): (&str, &[u8]),
    settings: &Settings,
    causes: Option<&Causes>,
    line: u64,
    mut goes_on: impl FnMut() -> Result<(), Failure>,
) -> Result<Option<AtLine>, Failure> {
    let expanded = expand::expanded(text, name, settings)?;
    let Some(span) = stretch(&expanded, settings, line) else { return Ok(None) };
    let job = Job { force: true, ..settings.job("")? };
    let brought =
        rewrite::brought_about(expanded.text(), &job, &span, || goes_on().map_err(PipelineEnd::Failed));
    let brought = brought.map_err(|ended| match ended {
        PipelineEnd::Refused(all) => Failure::Refused(expand::reports(&expanded, name, text, all)),
        PipelineEnd::Failed(failure) => failure,
    })?;
    // Of a plain program nothing behind the line bears on it.
    let program = if expanded.changed() { text } else { &text[..span.end as usize] };
    goes_on()?;
    Ok(Some(AtLine { brought, off: off((name, program), settings, causes, line)? }))
}

/// Where the blocks of a line stand in the plain program, the first time that it is executed.
fn stretch(expanded: &Expanded<'_>, settings: &Settings, line: u64) -> Option<Range<u64>> {
    let (mut reader, mut block) = (Reader::new(expanded.text(), &settings.dialect), Block::default());
    let mut found: Option<Range<u64>> = None;
    while reader.next(&mut block) {
        let end = block.offset + block.bytes.len() as u64;
        match (expanded.source_line(block.line) == (0, line), &mut found) {
            (true, Some(span)) => span.end = end,
            (true, None) => found = Some(block.offset..end),
            (false, Some(_)) => break,
            (false, None) => {}
        }
    }
    found
}

fn off(
    program: (&str, &[u8]),
    settings: &Settings,
    causes: Option<&Causes>,
    line: u64,
) -> Result<Option<Off>, Failure> {
    let without: Vec<Models<'_>> = causes.map_or_else(Vec::new, Causes::without);
    let mut farthest: Option<Vec<[f64; 3]>> = None;
    let asked = |file, of| (file, of) == (0, line);
    check::courses(program, settings, &without, &asked, &mut |file, course| {
        if !asked(file, course.line) {
            return;
        }
        for errors in course.errors_mm.chunks_exact(1 + without.len()) {
            if farthest.as_ref().is_none_or(|known| size(known[0]) < size(errors[0])) {
                farthest = Some(errors.to_vec());
            }
        }
    })?;
    let Some([whole, without @ ..]) = farthest.as_deref() else { return Ok(None) };
    let all = causes.map_or(&[][..], Causes::causes);
    let by = |without: &[f64; 3]| [0, 1, 2].map(|axis| whole[axis] - without[axis]);
    let mut causes: Vec<_> = all.iter().cloned().zip(without.iter().map(by)).collect();
    causes.sort_by(|(_, a), (_, b)| size(*b).total_cmp(&size(*a)));
    Ok(Some(Off { off_mm: *whole, causes }))
}

/// Length of a vector, in its unit.
#[must_use]
pub fn size(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
