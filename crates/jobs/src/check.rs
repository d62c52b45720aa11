//! The closed loop: two programs through the machine model, what they make of the part compared.

use diagnostic::{Text, both};
use machine_model::Models;
use nc_expand::Expanded;
use path_comparison::{Comparison, Course, Lean, Traces};
use rewrite::{Checked, Job};
use serde::Serialize;

use crate::message::Failure;
use crate::settings::Settings;
use crate::summary::{DatumUsed, control_um, json, um};
use crate::{datums, expand};

/// The JSON of `vpost check --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// `vpost.check/1`
    pub schema: &'static str,
    /// No finding.
    pub passed: bool,
    /// That was asked for.
    pub tolerance_um: f64,
    /// Tolerance and rounding of the output.
    pub limit_um: f64,
    /// Of the program as posted.
    pub feed_motions_in: usize,
    /// Of the corrected one.
    pub feed_motions_out: usize,
    /// That the correction put in.
    pub approach_moves: usize,
    /// How far the tool is off the path at most, by the program as posted.
    pub deviation_before_um: f64,
    /// Where.
    pub deviation_before_line: u64,
    /// The same by the corrected program.
    pub deviation_after_um: f64,
    /// Where.
    pub deviation_after_line: u64,
    /// How far the control leaves the corrected path at corners; `null`: not known.
    pub control_um: Option<f64>,
    /// How far the tool leans at most, on a machine that turns it, by the program as posted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_before_urad: Option<f64>,
    /// Where.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_before_line: Option<u64>,
    /// The same by the corrected program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_after_urad: Option<f64>,
    /// Where.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_after_line: Option<u64>,
    /// Touched zeros from which deviations count.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub datums: Vec<DatumUsed>,
    /// Lines that cannot be held within the tolerance; held against what the correction proves of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accepted_lines: Option<usize>,
    /// The control is within what is allowed as well.
    #[serde(skip)]
    pub covers_control: bool,
    /// What distances count from, and what the control adds, in words.
    #[serde(skip)]
    pub said: Vec<Text>,
    /// What is wrong.
    #[serde(serialize_with = "in_english")]
    pub findings: Vec<Text>,
}

impl Outcome {
    /// What a comparison says.
    #[must_use]
    pub fn new(settings: &Settings, checked: &Checked) -> Self {
        let Checked { comparison, datums, accepted, control, findings } = checked;
        let [before, after] = [comparison.leans_before, comparison.leans_after];
        let leans = before.largest_rad > 0.0 || after.largest_rad > 0.0;
        let urad = |lean: Lean| leans.then(|| (lean.largest_rad * 1e9).round() / 1e3);
        Self {
            tilt_before_urad: urad(before),
            tilt_before_line: leans.then_some(before.line),
            tilt_after_urad: urad(after),
            tilt_after_line: leans.then_some(after.line),
            schema: "vpost.check/1",
            passed: findings.is_empty(),
            tolerance_um: um(settings.tolerance_mm()),
            limit_um: um(limit_mm(settings, comparison)),
            feed_motions_in: comparison.wanted,
            feed_motions_out: comparison.commanded,
            approach_moves: comparison.approaches,
            deviation_before_um: um(comparison.before.largest_mm),
            deviation_before_line: comparison.before.line,
            deviation_after_um: um(comparison.after.largest_mm),
            deviation_after_line: comparison.after.line,
            accepted_lines: Some(*accepted).filter(|lines| *lines > 0),
            control_um: control_um(control),
            covers_control: control_um(control).is_some_and(|control_um| {
                let allowed_mm = limit_mm(settings, comparison) + settings.path_mode.share_mm();
                um(comparison.after.largest_mm) + control_um <= um(allowed_mm)
            }),
            said: datums::said(datums).into_iter().chain(control.said()).collect(),
            datums: DatumUsed::all(datums),
            findings: findings.clone(),
        }
    }

    /// The JSON text, one trailing line end.
    #[must_use]
    pub fn json(&self) -> Vec<u8> {
        json(self)
    }

    /// The same for people.
    #[must_use]
    pub fn text(&self) -> Text {
        let mut text = both!(
            "{} feed motions in, {} out\nbefore: the tool is up to {:8.3} um off its path (line {})\nafter:  the tool is up to {:8.3} um off its path (line {}), allowed are {:.3} um\n",
            "рабочих ходов было {}, стало {}\nдо:    инструмент отходит от траектории не больше чем на {:8.3} мкм (строка {})\nпосле: инструмент отходит от траектории не больше чем на {:8.3} мкм (строка {}), допускается {:.3} мкм\n",
            self.feed_motions_in,
            self.feed_motions_out,
            self.deviation_before_um,
            self.deviation_before_line,
            self.deviation_after_um,
            self.deviation_after_line,
            self.limit_um,
        );
        if let (Some(before), Some(after)) = (self.tilt_before_urad, self.tilt_after_urad) {
            text.push(&both!(
                "the tool leans by up to {before:.1} urad before (line {}), {after:.1} urad after (line {})\n",
                "инструмент наклонён не больше чем на {before:.1} мкрад до (строка {}), на {after:.1} мкрад после (строка {})\n",
                self.tilt_before_line.unwrap_or_default(),
                self.tilt_after_line.unwrap_or_default(),
            ));
        }
        if let Some(lines) = self.accepted_lines {
            text.push(&both!(
                "{lines} line(s) cannot be held within the tolerance of {} um, and are held against what is proven of them (--accept)\n",
                "строки, которые в допуске {} мкм не удержать: {lines}; сравниваются с тем, что для них доказано (--accept)\n",
                self.tolerance_um
            ));
        }
        for sentence in &self.said {
            text.push(&both!("{sentence}\n", "{sentence:#}\n"));
        }
        for finding in &self.findings {
            text.push(&both!("- {finding}\n", "- {finding:#}\n"));
        }
        text.push(&match (self.passed, self.covers_control) {
            (false, _) => FAILED,
            (true, true) => PASSED,
            (true, false) => PASSED_BY_THE_MACHINE,
        });
        text
    }
}

const PASSED: Text = Text::pair("passed\n", "проверка пройдена\n");
const PASSED_BY_THE_MACHINE: Text =
    Text::pair("passed: the machine's part\n", "проверка пройдена: доля станка\n");
const FAILED: Text = Text::pair("FAILED\n", "ПРОВЕРКА НЕ ПРОЙДЕНА\n");

/// JSON is English in every language.
fn in_english<S: serde::Serializer>(texts: &[Text], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(texts.iter().map(Text::english))
}

/// What the corrected path may be off, mm. A program that feeds nowhere has no limit of its own.
#[must_use]
pub fn limit_mm(settings: &Settings, comparison: &Comparison) -> f64 {
    comparison.limit_mm.max(settings.options.tolerance_mm)
}

/// What is wrong with a corrected program; programs with the names they have in messages.
///
/// # Errors
/// The messages of a program that cannot be read.
pub fn findings_between(
    posted: (&str, &[u8]),
    corrected: (&str, &[u8]),
    settings: &Settings,
) -> Result<Vec<String>, Failure> {
    let findings = closed([posted, corrected], settings, Traces::Forgotten, &|_| ())?.findings;
    Ok(findings.iter().map(|finding| finding.english().to_owned()).collect())
}

/// Both programs through the model, the posted and the corrected one, by the names they have in messages.
///
/// `progress` gets the share that is done, 0 to 1.
///
/// # Errors
/// The messages of a program that cannot be read.
pub fn closed(
    [posted, corrected]: [(&str, &[u8]); 2],
    settings: &Settings,
    traces: Traces,
    progress: &dyn Fn(f64),
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
    let job = Job { force: true, ..settings.job("")? };
    rewrite::check(&job, [&wanted.2, &commanded.2], traces, progress).map_err(|unreadable| {
        let (name, text, expanded) = [&wanted, &commanded][unreadable.program];
        Failure::Refused(expand::reports(expanded, name, text, unreadable.diagnostics))
    })
}

/// Largest distance between places of a [`Course`], mm.
const COURSE_STEP_MM: f64 = 2.0;

/// A program that is called by another: its name and bytes, by the number of its file.
pub type CalledFile = (usize, String, Vec<u8>);

/// Runs a program on the machine and on others beside it: every feed motion in order, with the number of its file (0 is the
/// program itself) and the errors of each machine. One for each trace of [`closed`].
///
/// * `asked` – the file and the line of what is asked for: others may be left out
///
/// # Errors
/// The messages of a program that cannot be read.
pub fn courses(
    (name, text): (&str, &[u8]),
    settings: &Settings,
    others: &[Models<'_>],
    asked: &dyn Fn(usize, u64) -> bool,
    each: &mut dyn FnMut(usize, Course),
) -> Result<Vec<CalledFile>, Failure> {
    let expanded = expand::expanded(text, name, settings)?;
    let job = Job { force: true, ..settings.job("")? };
    let models: Vec<Models<'_>> = std::iter::once(job.models).chain(others.iter().copied()).collect();
    rewrite::courses(&job, &models, &expanded, COURSE_STEP_MM, asked, each)
        .map_err(|diagnostics| Failure::Refused(expand::reports(&expanded, name, text, diagnostics)))?;
    let called = (1..).map_while(|file| {
        let (name, text) = expanded.file(file)?;
        Some((file, name.to_owned(), text.to_vec()))
    });
    Ok(called.collect())
}
