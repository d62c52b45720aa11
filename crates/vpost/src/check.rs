//! The closed loop: two programs through the machine model, what they make of the part compared.

mod page;

use std::path::Path;

use nc_expand::Expanded;
use path_comparison::Traces;
use rewrite::Checked;
use serde::Serialize;

use crate::arguments::{Check, Shared};
use crate::expand;
use crate::file;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::settings::Settings;

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
    Roles::default()
        .reads("the program", &arguments.input)
        .reads("the corrected program", &arguments.output)
        .reads_all("read by the profile", &settings.files)
        .writes("--html", arguments.html.as_deref())
        .are_apart()?;
    let model = settings.path_model()?;
    let read = |path: &Path| -> Result<_, Failure> { Ok((file::name(path), file::read_program(path)?)) };
    let (wanted_name, wanted) = read(&arguments.input)?;
    let (commanded_name, commanded) = read(&arguments.output)?;
    let traces = if arguments.html.is_some() { Traces::Kept } else { Traces::Forgotten };
    let Checked { comparison, findings } =
        closed((&wanted_name, &wanted), (&commanded_name, &commanded), &settings, traces)?;
    // A program that feeds nowhere has no limit of its own.
    let limit_mm = comparison.limit_mm.max(settings.options.tolerance_mm);
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
                text: &measurement_files::utf8_or_1251(&wanted),
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
    Ok(closed(posted, corrected, settings, Traces::Forgotten)?.findings)
}

/// Both programs through the model.
fn closed(
    posted: (&str, &[u8]),
    corrected: (&str, &[u8]),
    settings: &Settings,
    traces: Traces,
) -> Result<Checked, Failure> {
    // What is refused is not compared either: its motions would be read as the correction would not read them.
    let questions = settings.questions();
    nc_program::Evidence::of(posted.1, &questions)
        .refusal(&questions)
        .map_err(|finding| Failure::refused(posted.0, posted.1, vec![finding.0]))?;
    // What the output asks the control for moves nothing, and holds on the machine of the profile.
    let unguarded = nc_emit::without_guards(corrected.1);
    let corrected = (corrected.0, unguarded.as_deref().unwrap_or(corrected.1));
    let programs = [posted, corrected].map(|(name, text)| -> Result<_, Failure> {
        nc_syntax::looks_like_program(text)
            .map_err(|diagnostic| Failure::refused(name, text, vec![diagnostic]))?;
        Ok((name, text, expand::expanded(text, name, settings)?))
    });
    let [wanted, commanded] = programs;
    let (wanted, commanded): ((_, _, Expanded<'_>), (_, _, Expanded<'_>)) = (wanted?, commanded?);
    let job = settings.job(true, "")?;
    rewrite::check(&job, [&wanted.2, &commanded.2], traces).map_err(|unreadable| {
        let (name, text, expanded) = [&wanted, &commanded][unreadable.program];
        Failure::Refused(expand::reports(expanded, name, text, unreadable.diagnostics))
    })
}
