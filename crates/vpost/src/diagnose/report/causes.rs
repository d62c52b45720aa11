//! Verdict, causes, places: what the answer says, drawn.

use diagnostic::{Language, Text, say};
use gap_diagnosis::{Cause, Diagnosis, Verdict, number_name};
use maud::{Markup, html};
use report::chart::{Bar, Matrix, Range, matrix, ranges, waterfall as waterfall_chart};
use report::page::{figure, table};
use report::text::{MICROMETRES, Numbers, shown};

use super::names::{cause_heading, named, prose};
use jobs::diagnose::change::Change;

/// RMS of the gap as the causes are added.
pub(super) fn waterfall(d: &Diagnosis, language: Language) -> Markup {
    let first =
        Bar { label: say!(language, "model as it is", "модель как есть"), value: d.gap.rms_um };
    let added = d.causes.iter().map(|c| Bar {
        label: say!(language, "with {}", "+ {}", named(&c.effect, language)),
        value: c.rms_after_um,
    });
    let bars: Vec<Bar> = std::iter::once(first).chain(added).collect();
    // A row's gap is the length over its components, each of which carries the noise of a reading.
    let rows = d.gap.rows.max(1) as f64;
    let floor = d.gap.noise_um * (d.residuals.len() as f64 / rows).sqrt();
    let title = say!(language, "RMS of the gap as causes are added", "СКЗ расхождения при добавлении причин");
    let noise = say!(language, "noise alone", "один шум");
    let unit = MICROMETRES.in_language(language);
    let drawing = waterfall_chart(language, &title, &bars, Some((floor, &noise)), unit);
    let numbers: Vec<Vec<String>> =
        bars.iter().map(|b| vec![b.label.clone(), language.number(b.value)]).collect();
    let header = match language {
        Language::English => ["model", "RMS, \u{b5}m"],
        Language::Russian => ["модель", "СКЗ, мкм"],
    };
    figure(
        language,
        &drawing,
        &say!(
            language,
            "RMS over the rows, set-up fitted at every step. The dashed line is what noise alone would leave.",
            "СКЗ по строкам, установка подогнана на каждом шаге. Штриховая линия — сколько оставил бы один шум."
        ),
        Some(table(language, &header, &[1], &numbers)),
    )
}

/// Shares and numbers of the causes.
pub(super) fn causes(d: &Diagnosis, changes: &[Vec<Change>], language: Language) -> Markup {
    if d.causes.is_empty() {
        return html! { p { (say!(language, "No cause is named.", "Причина не названа.")) } (absorber(d, language)) };
    }
    let shares: Vec<Range> = d
        .causes
        .iter()
        .map(|c| Range {
            label: named(&c.effect, language),
            low: c.share_unique,
            high: c.share_alone,
            faint: false,
        })
        .collect();
    html! {
        (figure(
            language,
            &ranges(
                language,
                &say!(
                    language,
                    "Share of the gap that each cause explains",
                    "Доля расхождения, которую объясняет каждая причина"
                ),
                &shares,
            ),
            &say!(
                language,
                "Bar: what nothing else explains. Whisker: what it explains alone. Shares of the gap's square above the noise.",
                "Полоса — то, чего больше ничто не объясняет; ус — то, что причина объясняет одна. Доли квадрата расхождения сверх шума."
            ),
            None,
        ))
        @for (cause, changes) in d.causes.iter().zip(changes) { (one(cause, changes, language)) }
        (absorber(d, language))
    }
}

fn one(c: &Cause, changes: &[Change], language: Language) -> Markup {
    html! {
        (cause_heading(&named(&c.effect, language), &c.effect))
        p { (shown(&language.prose(&c.words))) "." }
        dl {
            @for p in &c.parameters {
                dt { (shown(number_name(&p.name).in_language(language))) }
                dd {
                    @match p.u95 {
                        Some(u) => { @let [value, spread] = language.measured(p.value, u); (value) " \u{b1} " (spread) " (95 %)" },
                        None => (language.number(p.value)),
                    }
                }
            }
            dt { (say!(language, "chance that it is none", "вероятность, что её нет")) } dd { (probability(c.p, language)) }
            @if !c.cannot_be_told_from.is_empty() {
                dt { (say!(language, "cannot be told from", "не отличить от")) } dd {
                    @let rivals: Vec<String> = c.cannot_be_told_from.iter().map(|rival| named(rival, language)).collect();
                    (shown(&rivals.join(", ")))
                }
            }
            @if !changes.is_empty() {
                dt { (say!(language, "change", "изменить")) }
                dd { (shown(&list(&changes.iter().map(Change::text).collect::<Vec<_>>(), language))) }
            }
            dt { (say!(language, "what to do", "что делать")) } dd { (c.remedy.in_language(language)) }
        }
    }
}

fn probability(p: f64, language: Language) -> String {
    if p < 1e-9 {
        say!(language, "below 1 in 1,000,000,000", "меньше 1 на 1\u{a0}000\u{a0}000\u{a0}000")
    } else {
        language.figures(format!("{p:.1e}"))
    }
}

/// Texts one behind the other.
fn list(texts: &[Text], language: Language) -> String {
    language.prose(&Text::join(texts, ", "))
}

fn absorber(d: &Diagnosis, language: Language) -> Markup {
    html! {
        @if let Some(absorber) = &d.leftover.absorber { p.muted {
            (say!(language, "Not named: ", "Не названо: ")) (shown(&prose(absorber, language))) "."
        } }
        @if !d.leftover.correlates_with.is_empty() {
            p {
                (say!(language, "What is left goes with ", "Остаток связан с: "))
                (shown(&list(&d.leftover.correlates_with, language))) "."
            }
        }
    }
}

/// Where the gap lies.
pub(super) fn places(d: &Diagnosis, language: Language) -> Markup {
    let drawn: Vec<Range> = d
        .places
        .iter()
        .filter(|c| c.by != "voxel" && c.by != "run")
        .map(|c| Range { label: language.prose(&c.words()), low: c.share, high: c.share, faint: c.p > 0.05 })
        .collect();
    let sure: Vec<String> = d
        .places
        .iter()
        .filter(|c| c.p <= 0.05 && c.by != "voxel" && c.by != "run")
        .take(3)
        .map(|c| {
            let (share, place) = (language.percent(c.share), language.prose(&c.words()));
            say!(language, "{share} of the gap is {place}", "{share} расхождения — {place}")
        })
        .collect();
    let numbers: Vec<Vec<String>> = d
        .places
        .iter()
        .map(|c| {
            let [by, cell] = [c.family(), c.part()].map(|text| language.prose(&text));
            vec![by, cell, language.percent(c.share), language.figures(format!("{:.3}", c.p))]
        })
        .collect();
    let header = match language {
        Language::English => ["by", "cell", "share", "p"],
        Language::Russian => ["по", "ячейка", "доля", "p"],
    };
    html! {
        p {
            @if sure.is_empty() {
                (say!(
                    language,
                    "No place, direction or condition holds more of the gap than its number of readings explains.",
                    "Ни в каком месте, направлении или условии расхождения не больше, чем следует из числа отсчётов."
                ))
            }
            @else { (shown(&sure.join("; "))) "." }
        }
        @if !drawn.is_empty() {
            (figure(
                language,
                &ranges(
                    language,
                    &say!(
                        language,
                        "Share of the gap by place and condition",
                        "Доля расхождения по месту и условиям"
                    ),
                    &drawn,
                ),
                &say!(
                    language,
                    "Faint bars: no more than an even spread would show by chance (p above 0.05, corrected for the number of cells).",
                    "Бледные полосы — не больше, чем случайно дало бы равномерное расхождение (p больше 0,05 с поправкой на число ячеек)."
                ),
                Some(table(language, &header, &[2, 3], &numbers)),
            ))
        }
    }
}

/// Most columns of the matrix.
const MOST_COLUMNS: usize = 14;

/// How alike the causes are to other effects on this design.
pub(super) fn confounding(d: &Diagnosis, language: Language) -> Markup {
    if d.causes.is_empty() {
        let why = say!(
            language,
            "No cause is named, so there is nothing to be confused with.",
            "Причина не названа, так что и путать не с чем."
        );
        return html! { p { (why) } };
    }
    let mut columns: Vec<(String, f64)> = Vec::new();
    for near in d.causes.iter().flat_map(|c| &c.nearest) {
        match columns.iter_mut().find(|(name, _)| *name == near.effect) {
            Some((_, best)) => *best = best.max(near.correlation),
            None => columns.push((near.effect.clone(), near.correlation)),
        }
    }
    columns.sort_by(|a, b| b.1.total_cmp(&a.1));
    columns.truncate(MOST_COLUMNS);
    let values = d
        .causes
        .iter()
        .flat_map(|c| {
            columns
                .iter()
                .map(|(name, _)| c.nearest.iter().find(|n| n.effect == *name).map(|n| n.correlation))
        })
        .collect();
    let m = Matrix {
        rows: d.causes.iter().map(|c| named(&c.effect, language)).collect(),
        columns: columns.into_iter().map(|(name, _)| named(&name, language)).collect(),
        values,
        limit: 0.98,
    };
    let numbers: Vec<Vec<String>> = d
        .causes
        .iter()
        .flat_map(|c| {
            c.nearest.iter().map(|n| {
                let behind = if n.behind < 1e6 {
                    language.number(n.behind)
                } else {
                    say!(language, "far", "далеко")
                };
                let correlation = language.figures(format!("{:.3}", n.correlation));
                vec![named(&c.effect, language), named(&n.effect, language), correlation, behind]
            })
        })
        .collect();
    let header = match language {
        Language::English => ["cause", "other effect", "correlation", "behind by BIC"],
        Language::Russian => ["причина", "другой эффект", "корреляция", "отставание по BIC"],
    };
    let title = say!(
        language,
        "Likeness of causes and other effects on these rows",
        "Сходство причин и других эффектов на этих строках"
    );
    figure(
        language,
        &matrix(language, &title, &m),
        &say!(
            language,
            "Correlation of what a cause does to these rows with the nearest that another effect can do, set-up taken out. From 0.98 on (framed) no reading of these rows tells them apart; empty cells are less alike than those shown.",
            "Корреляция того, что причина делает с этими строками, с ближайшим, на что способен другой эффект, без установки. От 0,98 (в рамке) ни один отсчёт этих строк их не различает; пустые клетки похожи меньше показанных."
        ),
        Some(table(language, &header, &[2, 3], &numbers)),
    )
}

/// What to measure next.
pub(super) fn next(d: &Diagnosis, language: Language) -> Markup {
    html! {
        @if let Some(next) = &d.next_measurement {
            p { (shown(&prose(&next.text, language))) }
            @if next.expected_sigma > 0.0 { p.muted {
                @let ([one, other], sigma) = (&next.separates, language.number(next.expected_sigma));
                @let [one, other] = [one, other].map(|id| prose(id, language));
                (shown(&say!(
                    language,
                    "{one} and {other} would then lie {sigma} standard deviations apart.",
                    "Тогда {one} и {other} разойдутся на {sigma} стандартных отклонений."
                )))
            } }
        } @else if d.verdict == Verdict::Underpowered {
            ul { @for note in &d.notes { li { (shown(&prose(note, language))) } } }
            p {
                (say!(
                    language,
                    "A plan that makes the causes of this machine separable: vpost diagnose --plan FILE -m PROFILE.",
                    "План, по которому причины этого станка различимы: vpost diagnose --plan FILE -m PROFILE."
                ))
            }
        } @else {
            p {
                (say!(
                    language,
                    "Nothing is needed to tell the causes from others.",
                    "Чтобы отличить причины от других, ничего не нужно."
                ))
            }
        }
    }
}

/// Rows that stand alone.
pub(super) fn outliers(d: &Diagnosis, language: Language) -> Markup {
    const MOST: usize = 200;
    let lines: Vec<String> = d.outlier_lines.iter().take(MOST).map(u64::to_string).collect();
    html! {
        @if lines.is_empty() { p { (say!(language, "None.", "Таких нет.")) } }
        @else {
            p {
                @let count = language.count(d.outlier_lines.len());
                (say!(
                    language,
                    "{count} rows lie more than 4.5 robust standard deviations from the model and from their neighbours, and were not used. Lines of the file: ",
                    "Дальше 4,5 робастных стандартных отклонений от модели и от соседей лежит строк: {count}; они не использованы. Строки файла: "
                ))
                (lines.join(", "))
                @if let Some(more) = d.outlier_lines.len().checked_sub(MOST + 1) {
                    (say!(language, ", and {} more", " и ещё {}", more + 1))
                }
                "."
            }
        }
    }
}
