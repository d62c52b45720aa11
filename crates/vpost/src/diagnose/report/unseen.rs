//! Forecast against what came of it on points that no fit has seen.

use diagnostic::{Language, say};
use gap_diagnosis::{Diagnosis, Measurements};
use maud::{Markup, html};
use report::chart::{Bar, Interval, cumulative, interval, waterfall};
use report::page::{figure, table};
use report::text::{MICROMETRES, Numbers, shown};

use super::facts::Facts;

/// Most points in the table.
const MOST: usize = 100;

pub(super) fn unseen(
    d: &Diagnosis,
    holdout: Option<&Measurements>,
    facts: &Facts,
    language: Language,
) -> Markup {
    let Some(last) = d.causes.last() else {
        let why = say!(language, "Without causes nothing is predicted.", "Без причин и прогноза нет.");
        return html! { p { (why) } };
    };
    let s = last.shrink_predicted;
    let forecast =
        Interval { low: s.low, mid: s.mid, high: s.high, achieved: d.holdout.as_ref().map(|h| h.shrink) };
    html! {
        (figure(
            language,
            &interval(
                language,
                &say!(language, "Shrinkage of the gap's RMS", "Уменьшение СКЗ расхождения"),
                &forecast,
            ),
            &say!(
                language,
                "How far the RMS of the gap shrinks with all causes in the model: 0 % nothing, 100 % all. The band is the 95 % interval of the forecast.",
                "На сколько уменьшается СКЗ расхождения со всеми причинами в модели: 0 % — нисколько, 100 % — полностью. Полоса — 95-процентный интервал прогноза."
            ),
            None,
        ))
        @match (&d.holdout, holdout) {
            (Some(h), Some(points)) => {
                p {
                    @let (rows, name) = (h.rows, shown(facts.holdout.as_ref().map_or("", |f| f.name.as_str())));
                    @let [before, after] = [h.rms_before_um, h.rms_after_um].map(|um| language.number(um));
                    @let [shrink, mid, low, high] = [h.shrink, s.mid, s.low, s.high].map(|v| language.percent(v));
                    (say!(
                        language,
                        "On {rows} points of {name}, which no fit has seen: {before} to {after} \u{b5}m RMS, {shrink}; predicted were {mid} ({low} to {high}).",
                        "На точках файла {name} (их {rows}), которых не было в подгонке: СКЗ с {before} до {after} мкм, {shrink}; прогноз был {mid} (от {low} до {high})."
                    ))
                }
                (steps(h, language))
                (points_of(h, points, language))
            }
            _ => p.muted {
                (say!(
                    language,
                    "No unseen points were given. Measure some other lines and add --holdout FILE: only they prove the forecast.",
                    "Новых точек не дано. Измерьте другие линии и добавьте --holdout FILE: только они докажут прогноз."
                ))
            }
        }
    }
}

fn steps(h: &gap_diagnosis::Holdout, language: Language) -> Markup {
    let label = |step: &gap_diagnosis::Step| step.added.in_language(language).to_owned();
    let bars: Vec<Bar> = h.steps.iter().map(|s| Bar { label: label(s), value: s.rms_um }).collect();
    let numbers: Vec<Vec<String>> =
        h.steps.iter().map(|s| vec![label(s), language.number(s.rms_um)]).collect();
    let title = say!(
        language,
        "RMS of the unseen points as the model grows",
        "СКЗ новых точек по мере пополнения модели"
    );
    let header = match language {
        Language::English => ["added", "RMS, \u{b5}m"],
        Language::Russian => ["добавлено", "СКЗ, мкм"],
    };
    figure(
        language,
        &waterfall(language, &title, &bars, None, MICROMETRES.in_language(language)),
        &say!(
            language,
            "Each line adds one part to the model. A cause may make single steps worse that the next one makes good: only together they are the machine.",
            "Каждая строка добавляет в модель одну часть. Отдельный шаг может ухудшить то, что исправит следующий: станок — это только все они вместе."
        ),
        Some(table(language, &header, &[1], &numbers)),
    )
}

fn points_of(h: &gap_diagnosis::Holdout, points: &Measurements, language: Language) -> Markup {
    let mut sizes: Vec<(usize, f64, f64)> = Vec::new();
    for r in &h.residuals {
        match sizes.last_mut() {
            Some((row, before, after)) if *row == r.row => {
                *before += r.before_um * r.before_um;
                *after += r.after_um * r.after_um;
            }
            _ => sizes.push((r.row, r.before_um * r.before_um, r.after_um * r.after_um)),
        }
    }
    for (_, before, after) in &mut sizes {
        (*before, *after) = (before.sqrt(), after.sqrt());
    }
    let sorted = |which: &dyn Fn(&(usize, f64, f64)) -> f64| {
        let mut all: Vec<f64> = sizes.iter().map(which).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let numbers: Vec<Vec<String>> = sizes
        .iter()
        .take(MOST)
        .map(|(row, before, after)| {
            let q = points.rows[*row].command.linear_mm;
            let mut cells = vec![points.rows[*row].line.to_string()];
            cells.extend([q.x, q.y, q.z, *before, *after].map(|value| language.number(value)));
            cells
        })
        .collect();
    let title = say!(language, "Unseen points before and after", "Новые точки до и после");
    let header = match language {
        Language::English => ["line", "X, mm", "Y, mm", "Z, mm", "before, \u{b5}m", "after, \u{b5}m"],
        Language::Russian => ["строка", "X, мм", "Y, мм", "Z, мм", "до, мкм", "после, мкм"],
    };
    let (before, after) = (sorted(&|s| s.1), sorted(&|s| s.2));
    figure(
        language,
        &cumulative(language, &title, &before, &after, None, MICROMETRES.in_language(language)),
        &say!(
            language,
            "Share of the unseen points whose gap is smaller than the amount below.",
            "Доля новых точек, расхождение в которых меньше величины внизу."
        ),
        Some(table(language, &header, &[0, 1, 2, 3, 4, 5], &numbers)),
    )
}
