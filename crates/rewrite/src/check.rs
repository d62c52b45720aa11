//! Two programs through the machine model, what they make of the part compared.

mod findings;
mod reading;
mod unsaid;

use std::cell::RefCell;
use std::collections::BTreeMap;

use diagnostic::{Diagnostic, Text, both};
use machine_model::{Models, Placement};
use nc_expand::Expanded;
use nc_program::Context;
use path_comparison::{Comparison, Course, Mismatch, Traces, What, compare};

use crate::control::ControlPart;
use crate::datum::Datum;
use crate::figures::Corrected;
use crate::job::{Guards, Job};
use crate::path_mode::PathMode;
use crate::whole::pass;
use crate::words::retreats;
use reading::{Numbers, Optional, Program, file_and_line};

/// How the corrected program compares with the posted one.
#[derive(Debug)]
pub struct Checked {
    /// Distances and counts, of blocks under `/` executed.
    pub comparison: Comparison,
    /// Touched zeros from which distances count.
    pub datums: Vec<Datum>,
    /// Lines that cannot be held within the tolerance, and were held against what the correction proves of them instead.
    pub accepted: usize,
    /// What the control adds to the path of the second program.
    pub control: ControlPart,
    /// What differs, a sentence each; none where the program passes.
    pub findings: Vec<Text>,
}

/// A program that cannot be read on.
#[derive(Debug)]
pub struct Unreadable {
    /// The first of both, or the second.
    pub program: usize,
    /// Why; spans are those of the plain program.
    pub diagnostics: Vec<Diagnostic>,
}

/// Compares a posted and a corrected program on the machine as it is. Where blocks may be skipped, once with and once
/// without them: what is said of the path is said of the way with them, what is wrong is said of both.
///
/// `progress` gets the share of the corrected program that is read, 0 to 1, each time anew.
///
/// # Errors
/// [`Unreadable`] of the first program that cannot be read to its end.
pub fn check(
    job: &Job<'_>,
    programs: [&Expanded<'_>; 2],
    traces: Traces,
    progress: &dyn Fn(f64),
) -> Result<Checked, Unreadable> {
    let first = check_within(job, programs, traces, progress, &BTreeMap::new())?;
    if first.findings.is_empty() {
        return Ok(first);
    }
    // Of what cannot be held within the tolerance the correction says so itself.
    let accepted = accepted(job, programs[0]);
    if accepted.is_empty() { Ok(first) } else { check_within(job, programs, traces, progress, &accepted) }
}

/// Of each line that cannot be held within the tolerance, what the correction proves of it instead, mm.
fn accepted(job: &Job<'_>, posted: &Expanded<'_>) -> BTreeMap<u64, f64> {
    let job = Job { force: true, guards: Guards::default(), path_mode: PathMode::default(), ..*job };
    let corrected = pass::<Vec<Diagnostic>>(posted.text(), &job, |_| false, |line| line, |_| Ok(()));
    let Ok(Some(Corrected { figures, .. })) = corrected else { return BTreeMap::new() };
    let mut accepted = BTreeMap::new();
    for (line, off_mm) in figures.accepted {
        let most: &mut f64 = accepted.entry(line).or_default();
        *most = most.max(off_mm);
    }
    accepted
}

fn check_within(
    job: &Job<'_>,
    programs: [&Expanded<'_>; 2],
    traces: Traces,
    progress: &dyn Fn(f64),
    accepted: &BTreeMap<u64, f64>,
) -> Result<Checked, Unreadable> {
    let run = |optional: Optional, traces: Traces, wider: f64| {
        let numbers = RefCell::new(Numbers::default());
        let [wanted, commanded] = programs;
        let mut steps = [
            Program::new(wanted, job, optional, &numbers, &|_| ()),
            Program::new(commanded, job, optional, &numbers, progress),
        ];
        steps[0].accepted = Some(accepted);
        let [w, c] = &mut steps;
        let comparison = compare(job.models, &mut *w, &mut *c, retreats(job.dialect), traces, wider);
        // The one that the other was compared with may end early: what cannot be read is refused all the same.
        for (program, steps) in steps.iter_mut().enumerate() {
            steps.by_ref().for_each(drop);
            if let Some(diagnostics) = steps.refused.take() {
                return Err(Unreadable { program, diagnostics });
            }
        }
        let may_skip = steps.iter().any(|program| program.may_skip);
        let [Program { datums, unsaid: here, .. }, Program { unsaid: there, mut control, .. }] = steps;
        control.lines().for_each(|line| *line = commanded.source_line(*line).1);
        Ok((comparison, numbers.into_inner(), datums, control, may_skip, there.beside(&here)))
    };
    let compared = |optional: Optional, traces: Traces| {
        let (mut comparison, mut numbers, datums, control, may_skip, unsaid) = run(optional, traces, 1.0)?;
        for wider in WIDER.into_iter().take_while(|_| strays(&comparison)) {
            let kept = if traces == Traces::Forgotten { Traces::Kept } else { traces };
            let (measured, named, ..) = run(optional, kept, wider)?;
            if let Some(measured) = in_a_corridor(measured, wider) {
                (comparison, numbers) = (measured, named);
                break;
            }
        }
        let mut findings = findings::of(&comparison, &numbers);
        findings.extend(unsaid);
        Ok((Checked { comparison, datums, accepted: accepted.len(), control, findings }, may_skip))
    };
    let (mut executed, may_skip) = compared(Optional::Executed, traces)?;
    if may_skip {
        for finding in compared(Optional::Skipped, Traces::Forgotten)?.0.findings {
            if !executed.findings.contains(&finding) {
                executed.findings.push(both!(
                    "with the blocks under `/` skipped: {finding}",
                    "если кадры с `/` пропущены: {finding:#}"
                ));
            }
        }
    }
    if programs[0].text() == programs[1].text() {
        // Nearest places of a path may be nearer than those of the same moment.
        executed.comparison.after = executed.comparison.before;
    }
    if !executed.findings.is_empty() && nc_emit::find_provenance(programs[1].text()).is_none() {
        let finding = both!(
            "this program was not corrected: it bears no mark of vpost",
            "эта программа не исправлена: в ней нет отметки vpost"
        );
        executed.findings.insert(0, finding);
    }
    Ok(executed)
}

/// Corridors in which a program that leaves its path is measured, in limits, narrowest first: in one that holds all of it each
/// motion is compared with the one it was made for, and how far it is off is known.
const WIDER: [f64; 3] = [4.0, 32.0, 256.0];
/// So many motions that are off are named.
const MOST_BEYOND: usize = 20;

/// Something of the path is not where it should be.
fn strays(comparison: &Comparison) -> bool {
    comparison.mismatches.iter().any(|mismatch| matches!(mismatch.what, What::TooFar(_) | What::Extra))
}

/// What a comparison in a wider corridor says of motions that are off; `None` where that does not hold the path either.
fn in_a_corridor(mut comparison: Comparison, wider: f64) -> Option<Comparison> {
    let path = |mismatch: &Mismatch| {
        matches!(mismatch.what, What::TooFar(_) | What::Extra | What::Missing | What::Short(_))
    };
    if comparison.more_mismatches > 0 || comparison.mismatches.iter().any(path) {
        return None;
    }
    comparison.limit_mm /= wider;
    let beyond = comparison.traces.iter().filter(|trace| trace.after_mm > trace.limit_mm / wider);
    let beyond: Vec<Mismatch> = beyond
        .map(|trace| Mismatch {
            what: What::TooFar(trace.after_mm),
            wanted_line: trace.line,
            commanded_line: trace.after_line.unwrap_or_default(),
        })
        .collect();
    if beyond.is_empty() {
        return None;
    }
    comparison.more_mismatches = beyond.len().saturating_sub(MOST_BEYOND);
    comparison.mismatches.splice(..0, beyond.into_iter().take(MOST_BEYOND));
    Some(comparison)
}

/// Runs a program on several machines: every feed motion with its file, and with the errors of each machine along it,
/// blocks under `/` executed. See [`path_comparison::courses`].
///
/// * `asked` – the file and the line of what is asked for
///
/// # Errors
/// What cannot be read of it.
pub fn courses(
    job: &Job<'_>,
    models: &[Models<'_>],
    program: &Expanded<'_>,
    step_mm: f64,
    asked: &dyn Fn(usize, u64) -> bool,
    each: &mut dyn FnMut(usize, Course),
) -> Result<(), Vec<Diagnostic>> {
    let numbers = RefCell::new(Numbers::default());
    let touched = RefCell::new(Vec::new());
    let mut steps = Program::new(program, job, Optional::Executed, &numbers, &|_| ()).with_files();
    steps.touched = Some(&touched);
    let datum_of = |machine: usize, own: Placement| -> Placement {
        let of = |(placement, _): &&(Placement, Context)| *placement == own;
        let placement = |(_, context): &(Placement, Context)| {
            job.datums.placement(models[machine].axes, job.dialect, context)
        };
        touched.borrow().iter().find(of).map_or(own, placement)
    };
    let asked = |name: u64| {
        let (file, line) = file_and_line(name);
        asked(file, line)
    };
    path_comparison::courses(
        models,
        &mut steps,
        retreats(job.dialect),
        step_mm,
        &asked,
        &datum_of,
        &mut |mut course| {
            let (file, line) = file_and_line(course.line);
            course.line = line;
            each(file, course);
        },
    );
    steps.refused.take().map_or(Ok(()), Err)
}
