//! Verdict, causes, places: what the answer says, drawn.

use diagnostic::{Text, both};
use gap_diagnosis::{Cause, Diagnosis, Parameter, Verdict, number_name};
use jobs::diagnose::change::Change;
use report::body::{Body, Fact, Table};
use report::chart::{Bar, Matrix, Range, matrix, ranges, waterfall as waterfall_chart};
use report::numbers::{count, figures, measured, number, percent, prose as said};
use report::text::opening;

use super::names::{cause_heading, named, prose};

/// RMS of the gap as the causes are added.
pub(super) fn waterfall(out: &mut Body, d: &Diagnosis) {
    let first = Bar { label: both!("model as it is", "модель как есть"), value: d.gap.rms_um };
    let added = d
        .causes
        .iter()
        .map(|c| Bar { label: both!("with {}", "+ {:#}", named(&c.effect)), value: c.rms_after_um });
    let bars: Vec<Bar> = std::iter::once(first).chain(added).collect();
    // A row's gap is the length over its components, each of which carries the noise of a reading.
    let rows = d.gap.rows.max(1) as f64;
    let floor = d.gap.noise_um * (d.residuals.len() as f64 / rows).sqrt();
    let title = both!("RMS of the gap as causes are added", "СКЗ расхождения при добавлении причин");
    let noise = both!("noise alone", "один шум");
    out.figure_of(
        &waterfall_chart(out.language(), &title, &bars, Some((floor, &noise))),
        &both!(
            "RMS over the rows, set-up fitted at every step. The dashed line is what noise alone would leave.",
            "СКЗ по строкам, установка подогнана на каждом шаге. Штриховая линия — сколько оставил бы один шум."
        ),
        &Table::of(&bars)
            .words(both!("model", "модель"), |bar| bar.label.clone())
            .numbers(both!("RMS, \u{b5}m", "СКЗ, мкм"), |bar| number(bar.value)),
    );
}

/// Shares and numbers of the causes.
pub(in crate::diagnose) fn causes(out: &mut Body, d: &Diagnosis, changes: &[Vec<Change>]) {
    if d.causes.is_empty() {
        out.p(&both!("No cause is named.", "Причина не названа."));
        return absorber(out, d);
    }
    let range =
        |c: &Cause| Range { label: named(&c.effect), low: c.share_unique, high: c.share_alone, faint: false };
    let shares: Vec<Range> = d.causes.iter().map(range).collect();
    let title = both!(
        "Share of the gap that each cause explains",
        "Доля расхождения, которую объясняет каждая причина"
    );
    out.figure(
        &ranges(out.language(), &title, &shares),
        &both!(
            "Bar: what nothing else explains. Whisker: what it explains alone. Shares of the gap's square above the noise.",
            "Полоса — то, чего больше ничто не объясняет; ус — то, что причина объясняет одна. Доли квадрата расхождения сверх шума."
        ),
    );
    for (cause, changes) in d.causes.iter().zip(changes) {
        one(out, cause, changes);
    }
    absorber(out, d);
}

fn one(out: &mut Body, c: &Cause, changes: &[Change]) {
    cause_heading(out, &named(&c.effect), &c.effect);
    let words = opening(&said(&c.words));
    out.p(&both!("{words}.", "{words:#}."));
    let parameter = |p: &Parameter| {
        let value = p.u95.map_or_else(
            || number(p.value),
            |u| {
                let [value, spread] = measured(p.value, u);
                both!("{value} \u{b1} {spread} (95 %)", "{value:#} \u{b1} {spread:#} (95 %)")
            },
        );
        Fact::new(number_name(&p.name), &value)
    };
    let mut facts: Vec<Fact> = c.parameters.iter().map(parameter).collect();
    facts.push(Fact::new(both!("chance that it is none", "вероятность, что её нет"), &probability(c.p)));
    if !c.cannot_be_told_from.is_empty() {
        let rivals: Vec<Text> = c.cannot_be_told_from.iter().map(|rival| named(rival)).collect();
        facts.push(Fact::new(both!("cannot be told from", "не отличить от"), &Text::join(&rivals, ", ")));
    }
    if !changes.is_empty() {
        let changes: Vec<Text> = changes.iter().map(Change::text).collect();
        facts.push(Fact::new(both!("change", "изменить"), &said(&Text::join(&changes, ", "))));
    }
    out.facts(facts);
    out.typed(&said(&c.remedy));
}

fn probability(p: f64) -> Text {
    if p < 1e-9 {
        both!("below 1 in 1,000,000,000", "меньше 1 на 1\u{a0}000\u{a0}000\u{a0}000")
    } else {
        figures(format!("{p:.1e}"))
    }
}

fn absorber(out: &mut Body, d: &Diagnosis) {
    if let Some(absorber) = &d.leftover.absorber {
        let absorber = prose(absorber);
        out.muted(&both!("Not named: {absorber}.", "Не названо: {absorber:#}."));
    }
    if !d.leftover.correlates_with.is_empty() {
        let with = said(&Text::join(&d.leftover.correlates_with, ", "));
        out.p(&both!("What is left goes with {with}.", "Остаток связан с: {with:#}."));
    }
}

/// Where the gap lies.
pub(super) fn places(out: &mut Body, d: &Diagnosis) {
    let shown = || d.places.iter().filter(|c| c.by != "voxel" && c.by != "run");
    let sure = shown().filter(|c| c.p <= 0.05).take(3).map(|c| {
        let (share, place) = (percent(c.share), said(&c.words()));
        both!("{share} of the gap is {place}", "{share:#} расхождения — {place:#}")
    });
    let sure = Text::join(&sure.collect::<Vec<_>>(), "; ");
    out.p(&if sure.is_empty() {
        both!(
            "No place, direction or condition holds more of the gap than its number of readings explains.",
            "Ни в каком месте, направлении или условии расхождения не больше, чем следует из числа отсчётов."
        )
    } else {
        both!("{sure}.", "{sure:#}.")
    });
    let drawn: Vec<Range> = shown()
        .map(|c| Range { label: said(&c.words()), low: c.share, high: c.share, faint: c.p > 0.05 })
        .collect();
    if drawn.is_empty() {
        return;
    }
    let title = both!("Share of the gap by place and condition", "Доля расхождения по месту и условиям");
    out.figure_of(
        &ranges(out.language(), &title, &drawn),
        &both!(
            "Faint bars: no more than an even spread would show by chance (p above 0.05, corrected for the number of cells).",
            "Бледные полосы — не больше, чем случайно дало бы равномерное расхождение (p больше 0,05 с поправкой на число ячеек)."
        ),
        &Table::of(&d.places)
            .words(both!("by", "по"), |c| said(&c.family()))
            .words(both!("cell", "ячейка"), |c| said(&c.part()))
            .numbers(both!("share", "доля"), |c| percent(c.share))
            .numbers(Text::same("p"), |c| figures(format!("{:.3}", c.p))),
    );
}

/// Most columns of the matrix.
const MOST_COLUMNS: usize = 14;

/// How alike the causes are to other effects on this design.
pub(super) fn confounding(out: &mut Body, d: &Diagnosis) {
    if d.causes.is_empty() {
        return out.p(&both!(
            "No cause is named, so there is nothing to be confused with.",
            "Причина не названа, так что и путать не с чем."
        ));
    }
    let mut columns: Vec<(&str, f64)> = Vec::new();
    for near in d.causes.iter().flat_map(|c| &c.nearest) {
        match columns.iter_mut().find(|(name, _)| *name == near.effect) {
            Some((_, best)) => *best = best.max(near.correlation),
            None => columns.push((&near.effect, near.correlation)),
        }
    }
    columns.sort_by(|a, b| b.1.total_cmp(&a.1));
    columns.truncate(MOST_COLUMNS);
    let alike = |c: &Cause, name: &str| c.nearest.iter().find(|n| n.effect == name).map(|n| n.correlation);
    let row = |c| columns.iter().map(|(name, _)| alike(c, name)).collect::<Vec<_>>();
    let m = Matrix {
        rows: d.causes.iter().map(|c| named(&c.effect)).collect(),
        columns: columns.iter().map(|(name, _)| named(name)).collect(),
        values: d.causes.iter().flat_map(row).collect(),
        limit: 0.98,
    };
    let title = both!(
        "Likeness of causes and other effects on these rows",
        "Сходство причин и других эффектов на этих строках"
    );
    let pairs = d.causes.iter().flat_map(|c| c.nearest.iter().map(move |near| (c, near)));
    out.figure_of(
        &matrix(out.language(), &title, &m),
        &both!(
            "Correlation of what a cause does to these rows with the nearest that another effect can do, set-up taken out. From 0.98 on (framed) no reading of these rows tells them apart; empty cells are less alike than those shown.",
            "Корреляция того, что причина делает с этими строками, с ближайшим, на что способен другой эффект, без установки. От 0,98 (в рамке) ни один отсчёт этих строк их не различает; пустые клетки похожи меньше показанных."
        ),
        &Table::of(pairs)
            .words(both!("cause", "причина"), |(c, _)| named(&c.effect))
            .words(both!("other effect", "другой эффект"), |(_, near)| named(&near.effect))
            .numbers(both!("correlation", "корреляция"), |(_, near)| figures(format!("{:.3}", near.correlation)))
            .numbers(both!("behind by BIC", "отставание по BIC"), |(_, near)| match near.behind < 1e6 {
                true => number(near.behind),
                false => both!("far", "далеко"),
            }),
    );
}

/// What to measure next.
pub(in crate::diagnose) fn next(out: &mut Body, d: &Diagnosis) {
    if let Some(next) = &d.next_measurement {
        out.p(&prose(&next.text));
        if let [one, other] = &next.separates[..]
            && next.expected_sigma > 0.0
        {
            let [one, other] = [one, other].map(prose);
            let sigma = number(next.expected_sigma);
            out.muted(&both!(
                "{one} and {other} would then lie {sigma} standard deviations apart.",
                "Тогда {one:#} и {other:#} разойдутся на {sigma:#} стандартных отклонений."
            ));
        }
    } else if d.verdict == Verdict::Underpowered {
        out.list(&d.notes.iter().map(prose).collect::<Vec<_>>());
        out.p(&both!(
            "A plan that makes the causes of this machine separable: vpost diagnose --plan FILE -m PROFILE.",
            "План, по которому причины этого станка различимы: vpost diagnose --plan FILE -m PROFILE."
        ));
    } else {
        out.p(&both!(
            "Nothing is needed to tell the causes from others.",
            "Чтобы отличить причины от других, ничего не нужно."
        ));
    }
}

/// Rows that stand alone.
pub(super) fn outliers(out: &mut Body, d: &Diagnosis) {
    const MOST: usize = 200;
    if d.outlier_lines.is_empty() {
        return out.p(&both!("None.", "Таких нет."));
    }
    let lines: Vec<String> = d.outlier_lines.iter().take(MOST).map(u64::to_string).collect();
    let (all, lines) = (count(d.outlier_lines.len()), lines.join(", "));
    let more = match d.outlier_lines.len().saturating_sub(MOST) {
        0 => Text::EMPTY,
        more => both!(", and {more} more", " и ещё {more}"),
    };
    out.p(&both!(
        "{all} rows lie more than 4.5 robust standard deviations from the model and from their neighbours, and were not used. Lines of the file: {lines}{more}.",
        "Дальше 4,5 робастных стандартных отклонений от модели и от соседей лежит строк: {all:#}; они не использованы. Строки файла: {lines}{more:#}."
    ));
}
