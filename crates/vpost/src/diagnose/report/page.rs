//! The diagnosis as one page, in the order in which people ask: what, how much, where, how sure, what next, from what.

use gap_diagnosis::{Diagnosis, Measurements, Verdict};
use maud::{Markup, html};
use report::page::{Page, Section};
use report::text::{number, shown};

use super::facts::Facts;
use super::rows::Rows;
use super::{causes, pictures, provenance, unseen};
use jobs::diagnose::change::Change;

/// What a page is made of.
pub(in crate::diagnose) struct Report<'a> {
    /// The answer.
    pub diagnosis: &'a Diagnosis,
    /// What acting on each cause changes in the profile.
    pub changes: &'a [Vec<Change>],
    /// The measurements it is about.
    pub data: &'a Measurements,
    /// Measurements no fit has seen.
    pub holdout: Option<&'a Measurements>,
    /// Files, options, versions.
    pub facts: &'a Facts,
    /// The JSON twin.
    pub json: &'a str,
}

impl Report<'_> {
    /// The page.
    pub(in crate::diagnose) fn html(&self) -> String {
        let d = self.diagnosis;
        let rows = Rows::new(d, self.data);
        let sections = [
            Some(Section { id: "waterfall", title: "How the gap shrinks", body: causes::waterfall(d) }),
            Some(Section { id: "causes", title: "Causes", body: causes::causes(d, self.changes) }),
            Some(Section { id: "where", title: "Where the gap lies", body: causes::places(d) }),
            pictures::strips(d, self.data, &rows).map(|body| Section {
                id: "strips",
                title: "The gap over place, time and conditions",
                body,
            }),
            pictures::vectors(d, self.data, &rows).map(|body| Section {
                id: "vectors",
                title: "Error vectors",
                body,
            }),
            pictures::heat(d, self.data, &rows).map(|body| Section {
                id: "slices",
                title: "Slices through the machine",
                body,
            }),
            pictures::distribution(d, &rows, self.facts.tolerance_um).map(|body| Section {
                id: "distribution",
                title: "Before and after",
                body,
            }),
            Some(Section { id: "confounding", title: "What looks alike", body: causes::confounding(d) }),
            Some(Section {
                id: "unseen",
                title: "Predicted and achieved",
                body: unseen::unseen(d, self.holdout, self.facts),
            }),
            Some(Section { id: "next", title: "What to measure next", body: causes::next(d) }),
            Some(Section { id: "outliers", title: "Rows left out", body: causes::outliers(d) }),
            Some(Section {
                id: "provenance",
                title: "Where this comes from",
                body: provenance::body(d, self.facts),
            }),
        ];
        // Where too little was measured there is nothing to draw.
        let drawn = d.verdict != Verdict::Underpowered || !d.residuals.is_empty();
        let kept = |s: &Section| drawn || matches!(s.id, "next" | "provenance");
        Page {
            title: &format!("{} \u{2013} {}", d.verdict.name(), self.facts.machine),
            head: head(d, self.facts),
            sections: sections.into_iter().flatten().filter(kept).collect(),
            json: self.json,
            foot: &format!(
                "vpost {} diagnose. This page needs no network, holds no script and is the same for the same files. Its numbers are in it as JSON (vpost.diagnosis/1).",
                env!("CARGO_PKG_VERSION")
            ),
        }
        .into_html()
    }
}

fn head(d: &Diagnosis, facts: &Facts) -> Markup {
    let g = &d.gap;
    html! {
        p.muted { "Simulation against reality: " (shown(&facts.machine)) ", " (shown(&facts.measurements.name)) }
        p { span.verdict { (d.verdict.name()) } }
        h1 { (shown(&d.sentence)) }
        p { (meaning(d.verdict)) }
        @if g.rms_um > 0.0 {
            p.muted {
                (number(g.rms_um)) " \u{b5}m RMS, 95 % below " (number(g.p95_um)) " \u{b5}m, largest " (number(g.max_um))
                " \u{b5}m, noise of a reading " (number(g.noise_um)) " \u{b5}m, " (g.rows) " rows."
            }
        }
    }
}

/// What a verdict asks of its reader.
fn meaning(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoGap => {
            "The model may be used as it is. What this measurement could not have seen is listed below."
        }
        Verdict::Named => {
            "The causes below explain the gap, and nothing else in the library does. Put them into the profile with --write-profile, or remove them at the machine."
        }
        Verdict::Ambiguous => {
            "The gap is explained, but a cause has a double that these rows cannot tell from it. A correction may use it where it was measured; before repairing anything, measure what is proposed below."
        }
        Verdict::Partial => {
            "The causes below are real, and something else is there that the library has no name for. Correct with care: what is left is no noise."
        }
        Verdict::Unknown => {
            "Something moves the machine that the library has no name for. Do not correct by this; look at where and when the gap is largest."
        }
        Verdict::NoiseModelSuspect => {
            "Look at the instrument and its set-up before the machine: the scatter is not what the file says, or the instrument itself moved."
        }
        Verdict::Underpowered => {
            "No cause is named, because none could be named safely. What is missing is said below."
        }
    }
}
