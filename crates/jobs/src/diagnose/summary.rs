//! The diagnosis for people at a terminal.

use super::change::Change;
use diagnostic::{Text, both};
use gap_diagnosis::{Cause, Diagnosis, Verdict};

/// What nothing else explains, to what it explains alone, in percent.
fn share(unique: f64, alone: f64) -> String {
    let (low, high) = (format!("{:.0}", 100.0 * unique), format!("{:.0}", 100.0 * alone));
    if low == high { format!("{low} %") } else { format!("{low}..{high} %") }
}

/// The whole text.
#[must_use]
pub fn text(d: &Diagnosis, changes: &[Vec<Change>]) -> Text {
    let (verdict, sentence) = (d.verdict.words(), &d.sentence);
    let mut out = both!("{verdict}: {sentence}\n\n", "{verdict:#}: {sentence:#}\n\n");
    if d.verdict == Verdict::Underpowered {
        return out;
    }
    let g = &d.gap;
    let (rms, p95, largest, noise, rows) = (g.rms_um, g.p95_um, g.max_um, g.noise_um, g.rows);
    out.push(&both!(
        "gap     {rms:.1} um RMS, 95 % below {p95:.1} um, largest {largest:.1} um, noise {noise:.2} um ({rows} rows)\n",
        "расх.   СКЗ {rms:.1} мкм, 95 % ниже {p95:.1} мкм, наибольшее {largest:.1} мкм, шум {noise:.2} мкм (строк {rows})\n"
    ));
    let places = d.places.iter().filter(|c| c.p <= 0.05 && c.by != "voxel" && c.by != "run").take(4);
    let places: Vec<Text> =
        places.map(|c| both!("{:.0} % in {}", "{:.0} % — {:#}", 100.0 * c.share, c.words())).collect();
    if !places.is_empty() {
        let places = Text::join(&places, ", ");
        out.push(&both!("where   {places}\n", "где     {places:#}\n"));
    }
    let doubted = matches!(d.verdict, Verdict::Partial | Verdict::Unknown);
    for (cause, changes) in d.causes.iter().zip(changes) {
        let changes = if doubted { &[][..] } else { changes.as_slice() };
        out.push(&of_cause(cause, changes));
    }
    gain(&mut out, d);
    rest(&mut out, d);
    out
}

fn of_cause(cause: &Cause, changes: &[Change]) -> Text {
    let first = cause.parameters.first().map_or_else(String::new, |p| {
        // What is added to the model, not what the model then holds.
        p.u95.map_or_else(
            || format!("{} = {:.2}", p.name, p.value),
            |u| format!("{} {:+.2} ± {u:.2}", p.name, p.value),
        )
    });
    let (id, words, share) = (&cause.effect, &cause.words, share(cause.share_unique, cause.share_alone));
    let (before, after) = (cause.rms_before_um, cause.rms_after_um);
    let mut out = both!(
        "\ncause   {id}  {first}\n        {words}\n        {share} of the gap; RMS {before:.1} -> {after:.1} um\n",
        "\nпричина {id}  {first}\n        {words:#}\n        {share} расхождения; СКЗ {before:.1} -> {after:.1} мкм\n"
    );
    if !cause.cannot_be_told_from.is_empty() {
        let rivals = cause.cannot_be_told_from.join(", ");
        out.push(&both!("        cannot be told from {rivals}\n", "        не отличить от {rivals}\n"));
    }
    if !changes.is_empty() {
        let changes = Text::join(&changes.iter().map(Change::text).collect::<Vec<_>>(), ", ");
        out.push(&both!("        change {changes}\n", "        изменить {changes:#}\n"));
    }
    let remedy = &cause.remedy;
    out.push(&both!("        {remedy}\n", "        {remedy:#}\n"));
    out
}

/// What the causes in the model bring, and what unseen points say of that.
fn gain(out: &mut Text, d: &Diagnosis) {
    if let Some(s) = d.causes.last().and_then(|last| last.shrink_predicted) {
        let [low, mid, high] = [s.low, s.mid, s.high].map(|share| 100.0 * share);
        out.push(&both!(
            "\nshrinks by {mid:.0} % (between {low:.0} and {high:.0} %) with the cause(s) in the model\n",
            "\nс этим в модели уменьшится на {mid:.0} % (от {low:.0} до {high:.0} %)\n"
        ));
    }
    if let Some(h) = &d.holdout {
        let (before, after, shrink, rows) = (h.rms_before_um, h.rms_after_um, 100.0 * h.shrink, h.rows);
        out.push(&both!(
            "unseen points: {before:.1} -> {after:.1} um RMS, {shrink:.0} % ({rows} rows)\n",
            "новые точки: СКЗ {before:.1} -> {after:.1} мкм, {shrink:.0} % (строк {rows})\n"
        ));
        for step in &h.steps {
            let (um, added) = (step.rms_um, &step.added);
            out.push(&both!("        {um:>8.1} um  {added}\n", "        {um:>8.1} мкм  {added:#}\n"));
        }
    }
}

/// What is left, what to measure next, and what was left out.
fn rest(out: &mut Text, d: &Diagnosis) {
    if !d.leftover.correlates_with.is_empty() {
        let with = Text::join(&d.leftover.correlates_with, ", ");
        out.push(&both!("what is left goes with {with}\n", "остаток связан с: {with:#}\n"));
    }
    if let Some(absorber) = &d.leftover.absorber {
        out.push(&both!("not named: {absorber}\n", "не названо: {absorber:#}\n"));
    }
    if let Some(next) = &d.next_measurement {
        let (text, sigma) = (&next.text, next.expected_sigma);
        out.push(&both!("next    {text}\n", "дальше  {text:#}\n"));
        if sigma > 0.0 {
            out.push(&both!(
                "        (they would then lie {sigma:.0} standard deviations apart)\n",
                "        (тогда между ними будет {sigma:.0} стандартных отклонений)\n"
            ));
        }
    }
    if !d.outlier_lines.is_empty() {
        let lines: Vec<String> = d.outlier_lines.iter().take(12).map(u64::to_string).collect();
        let more = if d.outlier_lines.len() > 12 { ", ..." } else { "" };
        let (count, lines) = (d.outlier_lines.len(), lines.join(", "));
        out.push(&both!(
            "left out as outliers: {count} rows (lines {lines}{more})\n",
            "отброшено выбросов: {count} (строки {lines}{more})\n"
        ));
    }
    for note in &d.notes {
        out.push(&both!("note    {note}\n", "примеч. {note:#}\n"));
    }
}
