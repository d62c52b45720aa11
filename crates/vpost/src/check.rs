//! The closed loop: two programs through the machine model, their tool paths compared.

mod page;

use std::borrow::Cow;
use std::path::Path;

use correction::{Comparison, Mismatch, Step, compare};
use diagnostic::Diagnostic;
use nc_program::Interpreter;
use nc_syntax::dialect::{Action, CodeEntry};
use nc_syntax::{Block, ItemKind, Reader};
use serde::Serialize;

use crate::arguments::{Check, Shared};
use crate::expand;
use crate::file;
use crate::message::{Failure, Messages};
use crate::settings::Settings;

/// A program as the check sees it.
#[derive(Default)]
struct Program {
    steps: Vec<Step>,
    /// Of each step: its block may be skipped.
    aside: Vec<bool>,
    /// Words that are not motion, in order: M, S, T, H, D and G codes that set something.
    events: Vec<Event>,
    /// Steps and words up to an end of the program that may be skipped.
    ends_aside: Option<(usize, usize)>,
    /// Some blocks may be skipped.
    may_skip: bool,
    /// With blocks under `/` executed, and with them skipped.
    output: [Output; 2],
}

/// What decides how coarse the output is.
#[derive(Clone, Copy, Default)]
struct Output {
    inch: bool,
    /// What G51 makes of the output step; 0 where nothing moves.
    scale: f64,
}

/// A word that is not motion.
struct Event {
    text: String,
    line: u64,
    /// Counts the blocks.
    block: u64,
    /// Its block may be skipped.
    aside: bool,
}

/// What becomes of blocks under `/`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Optional {
    Executed,
    Skipped,
}

/// Two programs, with blocks under `/` executed or skipped.
struct Loop {
    comparison: Comparison,
    limit_mm: f64,
    findings: Vec<String>,
}

/// The JSON of `vpost check --json`.
#[derive(Debug, Serialize)]
struct Outcome<'a> {
    schema: &'static str,
    passed: bool,
    tolerance_um: f64,
    limit_um: f64,
    feed_motions_in: usize,
    feed_motions_out: usize,
    approach_moves: usize,
    deviation_before_um: f64,
    deviation_before_line: u64,
    deviation_after_um: f64,
    deviation_after_line: u64,
    findings: &'a [String],
}

/// `vpost check IN.nc OUT.nc -m PROFILE`
pub(crate) fn run(arguments: &Check, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let settings = Settings::load(shared, messages)?;
    let model = settings.path_model()?;
    let read = |path: &Path| Ok((file::name(path), file::read_program(path)?));
    let (wanted_name, wanted) = read(&arguments.input)?;
    let (commanded_name, commanded) = read(&arguments.output)?;
    let Loop { comparison, limit_mm, findings } =
        closed((&wanted_name, &wanted), (&commanded_name, &commanded), &settings)?;
    let passed = findings.is_empty();
    let um = |mm: f64| (mm * 1e6).round() / 1e3;
    if arguments.json || arguments.html.is_some() {
        let outcome = Outcome {
            schema: "vpost.check/1",
            passed,
            tolerance_um: um(settings.options.tolerance_mm),
            limit_um: um(limit_mm),
            feed_motions_in: comparison.wanted,
            feed_motions_out: comparison.commanded,
            approach_moves: comparison.approaches,
            deviation_before_um: um(comparison.before.largest_mm),
            deviation_before_line: comparison.before.line,
            deviation_after_um: um(comparison.after.largest_mm),
            deviation_after_line: comparison.after.line,
            findings: &findings,
        };
        let mut text = serde_json::to_vec_pretty(&outcome).expect("plain values always serialise");
        text.push(b'\n');
        if let Some(path) = &arguments.html {
            let facts = page::Facts {
                input: &wanted_name,
                output: &commanded_name,
                text: &file::decoded(&wanted),
                machine: &settings.profile.name,
                profile: &settings.profile_name,
                profile_hash: &settings.profile_hash.to_string(),
                engine: model.id().name(),
                limit_mm,
                passed,
                findings: &findings,
            };
            let json = String::from_utf8_lossy(&text);
            file::write(path, page::html(&comparison, &facts, &json).as_bytes())?;
        }
        if arguments.json {
            file::print(&text)?;
        }
    }
    if !arguments.json {
        let mut text = format!(
            "{} feed motions in, {} out\nbefore: the tool is up to {:8.3} um off its path (line {})\nafter:  the tool is up to {:8.3} um off its path (line {}), allowed are {:.3} um\n",
            comparison.wanted,
            comparison.commanded,
            um(comparison.before.largest_mm),
            comparison.before.line,
            um(comparison.after.largest_mm),
            comparison.after.line,
            um(limit_mm),
        );
        for finding in &findings {
            text.push_str("- ");
            text.push_str(finding);
            text.push('\n');
        }
        text.push_str(if passed { "passed\n" } else { "FAILED\n" });
        file::print(text.as_bytes())?;
    }
    if passed { Ok(()) } else { Err(Failure::Check) }
}

/// What is wrong with a corrected program; programs with the names they have in messages.
pub(crate) fn findings_between(
    posted: (&str, &[u8]),
    corrected: (&str, &[u8]),
    settings: &Settings,
) -> Result<Vec<String>, Failure> {
    Ok(closed(posted, corrected, settings)?.findings)
}

/// Both programs through the model. Where blocks may be skipped, once with and once without them: what is said of the
/// path is said of the way with them, what is wrong is said of both.
fn closed(posted: (&str, &[u8]), corrected: (&str, &[u8]), settings: &Settings) -> Result<Loop, Failure> {
    let wanted = program(posted.0, posted.1, settings)?;
    let commanded = program(corrected.0, corrected.1, settings)?;
    let model = settings.path_model()?;
    let compared = |optional: Optional| {
        let limit_mm =
            settings.options.tolerance_mm + rounding_mm(settings, wanted.output[optional as usize]);
        let comparison = compare(model, &wanted.steps(optional), &commanded.steps(optional), limit_mm);
        let findings = findings(&comparison, &wanted.events(optional), &commanded.events(optional));
        Loop { comparison, limit_mm, findings }
    };
    let mut executed = compared(Optional::Executed);
    if wanted.may_skip || commanded.may_skip {
        for finding in compared(Optional::Skipped).findings {
            if !executed.findings.contains(&finding) {
                executed.findings.push(format!("with the blocks under `/` skipped: {finding}"));
            }
        }
    }
    Ok(executed)
}

/// What rounding adds to the tolerance: half an output step on each axis, as a distance.
fn rounding_mm(settings: &Settings, Output { inch, scale }: Output) -> f64 {
    let decimals = if inch { [settings.dialect.output.decimals_inch; 3] } else { settings.decimals_mm() };
    let unit = if inch { 25.4 } else { 1.0 };
    let half = decimals.map(|d| 0.5 * unit / f64::from(10u32.pow(u32::from(d))));
    scale.max(1.0) * half.iter().map(|h| h * h).sum::<f64>().sqrt()
}

impl Program {
    /// The motions, in order.
    fn steps(&self, optional: Optional) -> Cow<'_, [Step]> {
        match (optional, self.ends_aside) {
            (Optional::Executed, None) => Cow::Borrowed(&self.steps),
            (Optional::Executed, Some((steps, _))) => Cow::Borrowed(&self.steps[..steps]),
            (Optional::Skipped, _) => {
                let kept = self.steps.iter().zip(&self.aside).filter(|(_, aside)| !**aside);
                Cow::Owned(kept.map(|(step, _)| *step).collect())
            }
        }
    }

    /// The words that are not motion, in order.
    fn events(&self, optional: Optional) -> Vec<&Event> {
        match (optional, self.ends_aside) {
            (Optional::Executed, None) => self.events.iter().collect(),
            (Optional::Executed, Some((_, events))) => self.events[..events].iter().collect(),
            (Optional::Skipped, _) => self.events.iter().filter(|event| !event.aside).collect(),
        }
    }
}

fn program(name: &str, text: &[u8], settings: &Settings) -> Result<Program, Failure> {
    nc_syntax::looks_like_program(text)
        .map_err(|diagnostic| Failure::refused(name, text, vec![diagnostic]))?;
    let expanded = expand::expanded(text, name, settings)?;
    let refuse =
        |diagnostics: Vec<Diagnostic>| Failure::Refused(expand::reports(&expanded, name, text, diagnostics));
    let mut program = Program::default();
    let mut interpreter = Interpreter::new(&settings.dialect, &settings.setup);
    let mut reader = Reader::new(expanded.text(), &settings.dialect);
    let mut block = Block::default();
    let mut number = 0;
    while reader.next(&mut block) {
        let step = interpreter.step(&block).map_err(refuse)?;
        let aside = block.switches() != 0;
        let line = expanded.source_line(block.line).1;
        program.may_skip |= aside;
        if !step.motions.is_empty() {
            let executed = program.ends_aside.is_none();
            for (output, counts) in program.output.iter_mut().zip([executed, !aside]) {
                if counts {
                    output.scale = output.scale.max(step.context.frame.largest_scale());
                    output.inch |= step.context.unit_mm != 1.0;
                }
            }
        }
        for motion in &step.motions {
            program.steps.push(Step { motion: *motion, tool_mm: step.context.tool_mm, line });
            program.aside.push(aside);
        }
        number += 1;
        let at = Event { text: String::new(), line, block: number, aside };
        events(&block, &at, settings, &mut program.events);
        if step.ends_program {
            if !aside {
                break;
            }
            program.ends_aside.get_or_insert((program.steps.len(), program.events.len()));
        }
    }
    Ok(program)
}

/// What a block says besides where to go.
fn events(block: &Block<'_>, at: &Event, settings: &Settings, events: &mut Vec<Event>) {
    for item in &block.items {
        let ItemKind::Word { letter, .. } = item.kind else { continue };
        let counts = match letter {
            b'M' | b'S' | b'T' | b'H' | b'D' => true,
            b'G' => block
                .words()
                .find(|word| word.span == item.span)
                .and_then(|word| word.g_code())
                .is_some_and(|code| settings.dialect.code(code).is_none_or(sets_something)),
            _ => false,
        };
        if counts {
            let text: String =
                block.text(item.span).iter().map(|byte| byte.to_ascii_uppercase() as char).collect();
            events.push(Event { text, ..*at });
        }
    }
}

/// False for motion codes and for what only a cycle needs: a cycle may be written as moves.
fn sets_something(entry: &CodeEntry) -> bool {
    const MOTION_GROUP: u8 = 1;
    entry.group != MOTION_GROUP
        && !matches!(
            entry.action,
            Action::Dwell
                | Action::DwellP
                | Action::Cycle(_)
                | Action::CycleCancel
                | Action::ReturnInitial
                | Action::ReturnR
        )
}

fn findings(comparison: &Comparison, wanted: &[&Event], commanded: &[&Event]) -> Vec<String> {
    let mut findings: Vec<String> = comparison
        .mismatches
        .iter()
        .map(|mismatch| match mismatch {
            Mismatch::TooFar { wanted_line, commanded_line, distance_mm } => format!(
                "line {commanded_line} of the corrected program is {:.3} um off the path of line {wanted_line}",
                distance_mm * 1e3
            ),
            Mismatch::Missing { wanted_line } => {
                format!("the motion of line {wanted_line} is missing from the corrected program")
            }
            Mismatch::Short { wanted_line, left_mm } => {
                format!("the corrected program ends {:.3} um short of the end of line {wanted_line}", left_mm * 1e3)
            }
            Mismatch::Extra { commanded_line } => {
                format!("line {commanded_line} of the corrected program belongs to no programmed motion")
            }
            Mismatch::Turned { wanted_line, commanded_line } => {
                format!("the rotary axes stand elsewhere in line {commanded_line} of the corrected program than in line {wanted_line}")
            }
            Mismatch::NotPositioned { wanted_line } => {
                format!("the positioning of line {wanted_line} is missing from the corrected program")
            }
            Mismatch::PositionedElsewhere { commanded_line } => {
                format!("line {commanded_line} of the corrected program positions the tool where the program does not")
            }
        })
        .collect();
    if comparison.more_mismatches > 0 {
        findings.push(format!("and {} more of the path", comparison.more_mismatches));
    }
    if let Some((a, b)) = different(wanted, commanded) {
        findings.push(format!(
            "the programs say different things besides motion: {} on line {} against {} on line {}",
            a.text, a.line, b.text, b.line
        ));
    } else if wanted.len() != commanded.len() {
        findings.push(format!(
            "the programs say different things besides motion: {} words against {}",
            wanted.len(),
            commanded.len()
        ));
    }
    findings
}

/// The first words that differ. The order within a posted block means nothing: of its pieces the last one has what is
/// executed behind the motion.
fn different<'e>(wanted: &[&'e Event], commanded: &[&'e Event]) -> Option<(&'e Event, &'e Event)> {
    let mut rest = commanded;
    for block in wanted.chunk_by(|a, b| a.block == b.block) {
        let (here, behind) = rest.split_at(block.len().min(rest.len()));
        let sorted = |events: &[&'e Event]| {
            let mut texts: Vec<&str> = events.iter().map(|event| event.text.as_str()).collect();
            texts.sort_unstable();
            texts
        };
        if here.len() == block.len() && sorted(block) != sorted(here) {
            return block.iter().copied().zip(here.iter().copied()).find(|(a, b)| a.text != b.text);
        }
        rest = behind;
    }
    None
}
