//! What the page was made from, and how.

use gap_diagnosis::Diagnosis;
use maud::{Markup, html};
use report::page::table;
use report::text::{number, shown};

use jobs::diagnose::File;

use super::facts::Facts;

/// Most comment lines shown, and most runs.
const MOST: usize = 60;

pub(super) fn body(d: &Diagnosis, facts: &Facts) -> Markup {
    let runs: Vec<Vec<String>> = d
        .setup
        .run_offsets_um
        .iter()
        .take(MOST)
        .map(|(run, o)| std::iter::once(run.clone()).chain(o.map(number)).collect())
        .collect();
    let seen: Vec<Vec<String>> = d
        .detectable
        .iter()
        .map(|s| {
            let smallest = s.smallest.map_or_else(|| "not visible on these rows".to_owned(), number);
            vec![s.effect.clone(), s.parameter.clone(), smallest]
        })
        .collect();
    html! {
        dl {
            dt { "machine" } dd { (shown(&facts.machine)) ", chain " (shown(&facts.chain)) }
            @if !facts.calibrated.is_empty() { dt { "calibrated" } dd { (shown(&facts.calibrated)) } }
            (file("measurements", &facts.measurements))
            (file("profile and its tables", &facts.profile))
            @if let Some(holdout) = &facts.holdout { (file("unseen points", holdout)) }
            dt { "model" } dd { (shown(&facts.engine)) }
            dt { "seed" } dd { (facts.seed) }
            @if !facts.ignored_columns.is_empty() {
                dt { "columns passed over" } dd { (shown(&facts.ignored_columns.join(", "))) }
            }
            @if !facts.without.is_empty() {
                dt { "effects left out" } dd { (shown(&facts.without.join(", "))) }
            }
            dt { "made by" } dd { "vpost " (env!("CARGO_PKG_VERSION")) ", vpost.diagnosis/1" }
        }
        @if !d.notes.is_empty() {
            h3 { "Notes" }
            ul { @for note in &d.notes { li { (shown(note)) } } }
        }
        @if !d.residuals.is_empty() {
            h3 { "Set-up: measuring frame against machine frame" }
            p {
                "Shift " (number(d.setup.shift_um[0])) ", " (number(d.setup.shift_um[1])) ", " (number(d.setup.shift_um[2]))
                " \u{b5}m; rotation " (number(d.setup.rotation_urad[0])) ", " (number(d.setup.rotation_urad[1])) ", "
                (number(d.setup.rotation_urad[2])) " \u{b5}rad about X, Y, Z. Fitted with everything else, reported, never blamed."
            }
            details {
                summary { "Offsets of the runs" }
                (table(&["run", "x, \u{b5}m", "y, \u{b5}m", "z, \u{b5}m"], &[1, 2, 3], &runs))
                @if d.setup.run_offsets_um.len() > MOST { p.muted { "The rest is in the JSON." } }
            }
            details {
                summary { "Smallest effects that would have been named" }
                (table(&["effect", "number", "smallest"], &[2], &seen))
            }
        }
    }
}

fn file(role: &str, file: &File) -> Markup {
    html! {
        dt { (role) }
        dd {
            (shown(&file.name)) " " span.muted { "BLAKE3 " (file.hash) }
            @for comment in file.comments.iter().take(MOST) { br; span.muted { (shown(comment)) } }
        }
    }
}
