//! Outcomes as a table for spreadsheets, and the confusion matrix.

use std::collections::BTreeMap;

use gap_lab::Kind;

use super::answer::Answer;
use super::outcome::Outcome;
use super::scores::{Shrinkage, component_right, covered, of_kind, shrinkage, shrinkage_by_lab, snr};

/// One line per case: truth, answer, right or not, reason.
pub(crate) fn outcomes_csv(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "id,plan,noise,truth,snr,expected_sigma,identifiable,verdict,named,set,right,reason,predicted,achieved,achieved_lab,seconds\n",
    );
    for o in outcomes {
        let truth = &o.case.truth;
        let ids: Vec<&str> = truth.effects.iter().map(|e| e.id.as_str()).collect();
        let snr: Vec<String> = truth.effects.iter().map(|e| format!("{:.1}", e.snr)).collect();
        let named: Vec<&str> =
            o.said().map(|a| a.causes.iter().map(|c| c.effect.as_str()).collect()).unwrap_or_default();
        let number = |v: Option<f64>| v.map_or(String::new(), |v| format!("{v:.1}"));
        let (own, lab) = (shrinkage(o), shrinkage_by_lab(o));
        let predicted = own.as_ref().or(lab.as_ref()).map(|s| s.predicted);
        let row = [
            o.case.id.clone(),
            o.case.plan.word().to_owned(),
            o.case.noise.word().to_owned(),
            ids.join(" "),
            snr.join(" "),
            format!("{:.1}", truth.expected_sigma),
            truth.identifiable.to_string(),
            o.said().map_or("none".to_owned(), |a| a.verdict.clone()),
            named.join(" "),
            o.said().map(Answer::set).unwrap_or_default().join(" "),
            o.right().to_string(),
            if o.right() { String::new() } else { o.reason().replace([',', '\n'], ";") },
            number(predicted),
            number(own.map(|s| s.achieved)),
            number(lab.map(|s| s.achieved)),
            format!("{:.3}", o.seconds),
        ];
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}

/// Family of the truth against family of the first name, singles on designs that can tell.
pub(crate) fn confusion(outcomes: &[Outcome]) -> String {
    let mut cells: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    let mut heads: Vec<String> = Vec::new();
    for o in of_kind(outcomes, Kind::Single).filter(|o| o.case.truth.identifiable) {
        let Some(truth) = o.truth() else { continue };
        let family = |id: &str| id.split('.').next().unwrap_or(id).to_owned();
        let named = match o.said() {
            None => "(no answer)".to_owned(),
            Some(a) => match a.first() {
                Some(first) if o.right_first() => family(first),
                Some(first) if family(first) == family(truth) => "(wrong axis)".to_owned(),
                Some(first) => family(first),
                None => "(nothing)".to_owned(),
            },
        };
        if !heads.contains(&named) {
            heads.push(named.clone());
        }
        *cells.entry(family(truth)).or_default().entry(named).or_default() += 1;
    }
    heads.sort();
    let mut text =
        format!("| truth \\ first name | {} |\n|---|{}\n", heads.join(" | "), "---|".repeat(heads.len()));
    for (truth, row) in &cells {
        let numbers: Vec<String> =
            heads.iter().map(|h| row.get(h).map_or(String::new(), usize::to_string)).collect();
        text.push_str(&format!("| {truth} | {} |\n", numbers.join(" | ")));
    }
    text
}

/// Wrong answers by kind and reason, with their cases.
pub(crate) fn misses(outcomes: &[Outcome]) -> String {
    let mut groups: BTreeMap<(Kind, String), Vec<&Outcome>> = BTreeMap::new();
    for o in outcomes.iter().filter(|o| !o.right()) {
        groups.entry((o.case.kind, o.reason())).or_default().push(o);
    }
    let mut text = String::new();
    for ((kind, reason), list) in &groups {
        text.push_str(&format!("\n**{}: {reason}** — {}\n\n", kind.word(), list.len()));
        for o in list {
            let effects: Vec<String> =
                o.case.truth.effects.iter().map(|e| format!("{} at {:.1}", e.id, e.snr)).collect();
            let hidden = if effects.is_empty() { "nothing".to_owned() } else { effects.join(" + ") };
            let said = match &o.answer {
                Ok(a) => {
                    let causes: Vec<String> = a
                        .causes
                        .iter()
                        .map(|c| match c.cannot_be_told_from.as_slice() {
                            [] => c.effect.clone(),
                            rivals => format!("{} (or {})", c.effect, rivals.join(", ")),
                        })
                        .collect();
                    format!("{} {}", a.verdict, causes.join(" + "))
                }
                Err(words) => words.clone(),
            };
            text.push_str(&format!(
                "- `{}` {}, {}, {:.0} σ: {hidden} → {}\n",
                o.case.id,
                o.case.plan.word(),
                o.case.noise.word(),
                o.case.truth.expected_sigma,
                said.trim()
            ));
        }
    }
    if text.is_empty() { "None.\n".into() } else { text }
}

/// Cases whose number is off although the name may be right: shrinkage, parameter, component.
pub(crate) fn numbers_off(outcomes: &[Outcome]) -> String {
    let mut text =
        String::from("| case | plan, noise | hidden | said | what is off |\n|---|---|---|---|---|\n");
    for o in outcomes {
        let mut off = Vec::new();
        let far = |s: &Shrinkage| (s.predicted - s.achieved).abs() > 5.0;
        if let Some(s) = shrinkage(o).filter(far) {
            off.push(format!("shrinkage predicted {:.0}, achieved {:.0}", s.predicted, s.achieved));
        }
        if let Some(s) = shrinkage_by_lab(o).filter(far) {
            off.push(format!("shrinkage predicted {:.0}, by the lab {:.0}", s.predicted, s.achieved));
        }
        if covered(o) == Some(false) {
            let truth = o.case.truth.effects[0].coefficient.map_or(f64::NAN, |(_, value)| value);
            let found = o.said().and_then(|a| a.causes[0].parameters.iter().find(|p| p.u95.is_some()));
            if let Some(p) = found {
                let (value, u95) = (p.value.unwrap_or(f64::NAN), p.u95.unwrap_or(f64::NAN));
                off.push(format!("{} {value:.3} ± {u95:.3}, truth {truth:.3}", p.name));
            }
        }
        if o.case.kind == Kind::Single && snr(o) > 2.0 && component_right(o) == Some(false) {
            off.push(format!("component, truth {:.2?}", o.case.truth.components));
        }
        if off.is_empty() {
            continue;
        }
        let ids: Vec<String> =
            o.case.truth.effects.iter().map(|e| format!("{} at {:.1}", e.id, e.snr)).collect();
        let named: Vec<&str> =
            o.said().map(|a| a.causes.iter().map(|c| c.effect.as_str()).collect()).unwrap_or_default();
        let verdict = o.said().map_or("none", |a| a.verdict.as_str());
        text.push_str(&format!(
            "| `{}` | {}, {} | {} | {verdict} {} | {} |\n",
            o.case.id,
            o.case.plan.word(),
            o.case.noise.word(),
            ids.join(" + "),
            named.join(" + "),
            off.join("; ")
        ));
    }
    text
}
