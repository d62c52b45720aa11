//! The diagnosis for people at a terminal.

use std::fmt::Write;

use diagnostic::{Language, Text, say};
use gap_diagnosis::{Diagnosis, Verdict};

use jobs::diagnose::change::Change;

/// The text.
pub(super) fn text(d: &Diagnosis, changes: &[Vec<Change>], language: Language) -> String {
    let mut out = String::new();
    // Writing into a string cannot fail.
    let _ = write(&mut out, d, changes, language);
    out
}

/// What nothing else explains, to what it explains alone, in percent.
fn share(unique: f64, alone: f64) -> String {
    let (low, high) = (format!("{:.0}", 100.0 * unique), format!("{:.0}", 100.0 * alone));
    if low == high { format!("{low} %") } else { format!("{low}..{high} %") }
}

fn write(out: &mut String, d: &Diagnosis, changes: &[Vec<Change>], language: Language) -> std::fmt::Result {
    let said = |text: &Text| text.in_language(language).to_owned();
    let list = |texts: &[Text]| Text::join(texts, ", ").in_language(language).to_owned();
    writeln!(out, "{}: {}\n", said(&d.verdict.words()), said(&d.sentence))?;
    if d.verdict == Verdict::Underpowered {
        return Ok(());
    }
    let g = &d.gap;
    let gap = say!(
        language,
        "gap     {:.1} um RMS, 95 % below {:.1} um, largest {:.1} um, noise {:.2} um ({} rows)",
        "расх.   СКЗ {:.1} мкм, 95 % ниже {:.1} мкм, наибольшее {:.1} мкм, шум {:.2} мкм (строк {})",
        g.rms_um,
        g.p95_um,
        g.max_um,
        g.noise_um,
        g.rows
    );
    writeln!(out, "{gap}")?;
    let places: Vec<String> = d
        .places
        .iter()
        .filter(|c| c.p <= 0.05 && c.by != "voxel" && c.by != "run")
        .take(4)
        .map(|c| {
            let (share, place) = (100.0 * c.share, c.words());
            say!(language, "{share:.0} % in {place}", "{share:.0} % — {place:#}")
        })
        .collect();
    if !places.is_empty() {
        let places = places.join(", ");
        writeln!(out, "{}", say!(language, "where   {places}", "где     {places}"))?;
    }
    let doubted = matches!(d.verdict, Verdict::Partial | Verdict::Unknown);
    for (cause, changes) in d.causes.iter().zip(changes) {
        let first = cause.parameters.first().map_or_else(String::new, |p| {
            // What is added to the model, not what the model then holds.
            p.u95.map_or_else(
                || format!("{} = {:.2}", p.name, p.value),
                |u| format!("{} {:+.2} ± {u:.2}", p.name, p.value),
            )
        });
        let heading = say!(language, "cause   {}  {first}", "причина {}  {first}", cause.effect);
        writeln!(out, "\n{heading}\n        {}", said(&cause.words))?;
        let part = say!(
            language,
            "{} of the gap; RMS {:.1} -> {:.1} um",
            "{} расхождения; СКЗ {:.1} -> {:.1} мкм",
            share(cause.share_unique, cause.share_alone),
            cause.rms_before_um,
            cause.rms_after_um
        );
        writeln!(out, "        {part}")?;
        if !cause.cannot_be_told_from.is_empty() {
            let rivals = cause.cannot_be_told_from.join(", ");
            let told = say!(language, "cannot be told from {rivals}", "не отличить от {rivals}");
            writeln!(out, "        {told}")?;
        }
        if !changes.is_empty() && !doubted {
            let changes: Vec<Text> = changes.iter().map(Change::text).collect();
            let changes = list(&changes);
            writeln!(out, "        {}", say!(language, "change {changes}", "изменить {changes}"))?;
        }
        writeln!(out, "        {}", said(&cause.remedy))?;
    }
    if let Some(last) = d.causes.last() {
        let s = last.shrink_predicted;
        let shrinks = say!(
            language,
            "shrinks by {:.0} % (between {:.0} and {:.0} %) with the cause(s) in the model",
            "с этим в модели уменьшится на {:.0} % (от {:.0} до {:.0} %)",
            100.0 * s.mid,
            100.0 * s.low,
            100.0 * s.high
        );
        writeln!(out, "\n{shrinks}")?;
    }
    if let Some(h) = &d.holdout {
        let unseen = say!(
            language,
            "unseen points: {:.1} -> {:.1} um RMS, {:.0} % ({} rows)",
            "новые точки: СКЗ {:.1} -> {:.1} мкм, {:.0} % (строк {})",
            h.rms_before_um,
            h.rms_after_um,
            100.0 * h.shrink,
            h.rows
        );
        writeln!(out, "{unseen}")?;
        for step in &h.steps {
            let um = say!(language, "um", "мкм");
            writeln!(out, "        {:>8.1} {um}  {}", step.rms_um, said(&step.added))?;
        }
    }
    if !d.leftover.correlates_with.is_empty() {
        let with = list(&d.leftover.correlates_with);
        writeln!(out, "{}", say!(language, "what is left goes with {with}", "остаток связан с: {with}"))?;
    }
    if let Some(absorber) = &d.leftover.absorber {
        writeln!(out, "{}", say!(language, "not named: {absorber}", "не названо: {absorber:#}"))?;
    }
    if let Some(next) = &d.next_measurement {
        let text = &next.text;
        writeln!(out, "{}", say!(language, "next    {text}", "дальше  {text:#}"))?;
        if next.expected_sigma > 0.0 {
            let apart = say!(
                language,
                "(they would then lie {:.0} standard deviations apart)",
                "(тогда между ними будет {:.0} стандартных отклонений)",
                next.expected_sigma
            );
            writeln!(out, "        {apart}")?;
        }
    }
    if !d.outlier_lines.is_empty() {
        let lines: Vec<String> = d.outlier_lines.iter().take(12).map(u64::to_string).collect();
        let more = if d.outlier_lines.len() > 12 { ", ..." } else { "" };
        let left_out = say!(
            language,
            "left out as outliers: {} rows (lines {}{more})",
            "отброшено выбросов: {} (строки {}{more})",
            d.outlier_lines.len(),
            lines.join(", ")
        );
        writeln!(out, "{left_out}")?;
    }
    for note in &d.notes {
        writeln!(out, "{}", say!(language, "note    {note}", "примеч. {note:#}"))?;
    }
    Ok(())
}
