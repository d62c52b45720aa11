//! What the page was made from, and how.

use diagnostic::{Language, say};
use gap_diagnosis::{Diagnosis, number_name};
use maud::{Markup, html};
use report::page::table;
use report::text::{Numbers, shown};

use jobs::diagnose::File;

use super::facts::Facts;
use super::names::{named, prose};

/// Most comment lines shown, and most runs.
const MOST: usize = 60;

pub(super) fn body(d: &Diagnosis, facts: &Facts, language: Language) -> Markup {
    let runs: Vec<Vec<String>> = d
        .setup
        .run_offsets_um
        .iter()
        .take(MOST)
        .map(|(run, o)| std::iter::once(run.clone()).chain(o.map(|um| language.number(um))).collect())
        .collect();
    let seen: Vec<Vec<String>> = d
        .detectable
        .iter()
        .map(|s| {
            let unseen = || say!(language, "not visible on these rows", "на этих строках не виден");
            let smallest = s.smallest.map_or_else(unseen, |smallest| language.number(smallest));
            vec![
                named(&s.effect, language),
                number_name(&s.parameter).in_language(language).to_owned(),
                smallest,
            ]
        })
        .collect();
    let run_header = match language {
        Language::English => ["run", "x, \u{b5}m", "y, \u{b5}m", "z, \u{b5}m"],
        Language::Russian => ["серия", "x, мкм", "y, мкм", "z, мкм"],
    };
    let seen_header = match language {
        Language::English => ["effect", "number", "smallest"],
        Language::Russian => ["эффект", "параметр", "наименьшее"],
    };
    html! {
        dl {
            dt { (say!(language, "machine", "станок")) }
            dd { (shown(&facts.machine)) (say!(language, ", chain ", ", цепь ")) (shown(&facts.chain)) }
            (file(&say!(language, "measurements", "измерения"), &facts.measurements))
            (file(&say!(language, "profile and its tables", "профиль и его таблицы"), &facts.profile))
            @if let Some(holdout) = &facts.holdout { (file(&say!(language, "unseen points", "новые точки"), holdout)) }
            dt { (say!(language, "model", "модель")) } dd { (shown(&facts.engine)) }
            dt { (say!(language, "seed", "начальное число")) } dd { (facts.seed) }
            @if !facts.ignored_columns.is_empty() {
                dt { (say!(language, "columns passed over", "пропущенные столбцы")) } dd { (shown(&facts.ignored_columns.join(", "))) }
            }
            @if !facts.without.is_empty() {
                dt { (say!(language, "effects left out", "исключённые эффекты")) } dd { (shown(&facts.without.join(", "))) }
            }
            (facts.origin.rows(language))
            dt { (say!(language, "made by", "создано")) } dd { "vpost " (env!("CARGO_PKG_VERSION")) ", vpost.diagnosis/1" }
        }
        @if !d.notes.is_empty() {
            h3 { (say!(language, "Notes", "Примечания")) }
            ul { @for note in &d.notes { li { (shown(&prose(note, language))) } } }
        }
        @if !d.residuals.is_empty() {
            h3 {
                (say!(
                    language,
                    "Set-up: measuring frame against machine frame",
                    "Установка: система измерения относительно системы станка"
                ))
            }
            p {
                @let [x, y, z] = d.setup.shift_um.map(|um| language.number(um));
                @let [a, b, c] = d.setup.rotation_urad.map(|urad| language.number(urad));
                (say!(
                    language,
                    "Shift {x}, {y}, {z} \u{b5}m; rotation {a}, {b}, {c} \u{b5}rad about X, Y, Z. Fitted with everything else, reported, never blamed.",
                    "Сдвиг {x}; {y}; {z} мкм; поворот {a}; {b}; {c} мкрад вокруг X, Y, Z. Подогнано вместе со всем остальным; сообщается, но причиной не считается."
                ))
            }
            details {
                summary { (say!(language, "Offsets of the runs", "Смещения серий")) }
                (table(language, &run_header, &[1, 2, 3], &runs))
                @if d.setup.run_offsets_um.len() > MOST { p.muted { (say!(language, "The rest is in the JSON.", "Остальное есть в JSON.")) } }
            }
            details {
                summary {
                    (say!(
                        language,
                        "Smallest effects that would have been named",
                        "Наименьшие эффекты, которые были бы названы"
                    ))
                }
                (table(language, &seen_header, &[2], &seen))
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
