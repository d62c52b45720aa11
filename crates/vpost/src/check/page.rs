//! The check as one page: the tool path coloured by its error before and after, the worst blocks by line.

use diagnostic::{Language, Text, say};
use maud::{Markup, html};
use path_comparison::{Comparison, Trace, Way};
use report::chart::Amounts;
use report::chart::solid::{Solid, Stretch, path};
use report::page::{Page, Section, figure, table};
use report::text::{MICROMETRES, Numbers, shown};

use crate::file::without_folders;

/// What the page is made of.
pub(super) struct Facts<'a> {
    /// Names of the programs, and their texts.
    pub input: &'a str,
    pub output: &'a str,
    pub text: &'a str,
    pub output_text: &'a str,
    pub machine: &'a str,
    pub profile: &'a str,
    pub profile_hash: &'a str,
    pub engine: &'a str,
    pub limit_mm: f64,
    pub passed: bool,
    pub findings: &'a [Text],
    pub origin: crate::origin::Origin,
    /// What holds before the program begins: zeros and tools by name.
    pub setup: Vec<(String, [f64; 3])>,
}

/// Blocks listed.
const WORST: usize = 20;
/// Places of a path that are drawn, at most.
const MOST_PLACES: usize = 20_000;
/// A sample of an arc turns by no more.
const TURN_RAD: f64 = 0.2;

pub(super) fn html(comparison: &Comparison, facts: &Facts<'_>, json: &str, language: Language) -> String {
    let sections = vec![
        Section {
            id: "result",
            title: Text::pair("Result", "Результат"),
            body: result(comparison, facts, language),
        },
        Section {
            id: "path",
            title: Text::pair("The tool path", "Траектория инструмента"),
            body: paths(comparison, facts, language),
        },
        Section {
            id: "worst",
            title: Text::pair("Worst blocks", "Худшие кадры"),
            body: worst(comparison, facts, language),
        },
        Section {
            id: "provenance",
            title: Text::pair("Where this comes from", "Откуда эти данные"),
            body: provenance(facts, language),
        },
    ];
    Page {
        language,
        title: &say!(language, "Check \u{2013} {}", "Проверка \u{2014} {}", facts.output),
        head: head(comparison, facts, language),
        sections,
        json,
        command: "check",
        schema: "vpost.check/1",
    }
    .into_html()
}

fn head(comparison: &Comparison, facts: &Facts<'_>, language: Language) -> Markup {
    let verdict = match facts.passed {
        true => say!(language, "PASSED", "ПРОЙДЕНО"),
        false => say!(language, "FAILED", "НЕ ПРОЙДЕНО"),
    };
    let [before, after, limit] = [comparison.before.largest_mm, comparison.after.largest_mm, facts.limit_mm]
        .map(|mm| um(mm, language));
    html! {
        p.muted {
            (say!(language, "Both programs through the machine model: ", "Обе программы по модели станка: "))
            (shown(facts.machine)) ", " (shown(without_folders(facts.output)))
        }
        p { span.verdict { (verdict) } }
        h1 {
            (say!(
                language,
                "As posted the tool is up to {before} \u{b5}m off its path, as corrected up to {after} \u{b5}m; allowed are {limit} \u{b5}m",
                "По исходной программе инструмент отходит от траектории до {before} мкм, по исправленной — до {after} мкм; допустимо {limit} мкм"
            ))
        }
        p { (next_step(facts, language)) }
        (facts.origin.line(language))
    }
}

/// What to do with this result.
fn next_step(facts: &Facts<'_>, language: Language) -> String {
    if facts.passed {
        say!(
            language,
            "Run the corrected program. It holds for this machine as its profile describes it, with the zeros and tools below.",
            "Запускайте исправленную программу. Она годится для этого станка, каким его описывает профиль, с нулями и инструментами ниже."
        )
    } else {
        say!(
            language,
            "Do not run the corrected program: see the findings, and correct the program as posted once more.",
            "Исправленную программу не запускайте: смотрите, что найдено, и исправьте исходную программу заново."
        )
    }
}

fn result(comparison: &Comparison, facts: &Facts<'_>, language: Language) -> Markup {
    let [wanted, commanded] = [comparison.wanted, comparison.commanded].map(|count| language.count(count));
    let largest = |mm: f64, line: u64| {
        let um = um(mm, language);
        say!(language, "{um} \u{b5}m, line {line} as posted", "{um} мкм, строка {line} исходной")
    };
    html! {
        dl {
            dt { (say!(language, "feed motions", "рабочих движений")) }
            dd {
                (say!(
                    language,
                    "{wanted} as posted, {commanded} as corrected",
                    "{wanted} в исходной, {commanded} в исправленной"
                ))
            }
            dt { (say!(language, "largest before", "наибольшее до")) }
            dd { (largest(comparison.before.largest_mm, comparison.before.line)) }
            dt { (say!(language, "largest after", "наибольшее после")) }
            dd { (largest(comparison.after.largest_mm, comparison.after.line)) }
            dt { (say!(language, "moves to a corrected start", "подводов к исправленному началу")) }
            dd { (language.count(comparison.approaches)) }
        }
        @if !facts.findings.is_empty() {
            h3 { (say!(language, "Findings", "Что найдено")) }
            ul { @for finding in facts.findings { li { (shown(&language.prose(finding))) } } }
        }
    }
}

fn paths(comparison: &Comparison, facts: &Facts<'_>, language: Language) -> Markup {
    let Some(solid) = solid(&comparison.traces) else {
        let why = say!(
            language,
            "The program feeds nowhere: there is no path to draw.",
            "В программе нет движений на рабочей подаче: рисовать нечего."
        );
        return html! { p { (why) } };
    };
    let left = comparison.after.largest_mm.max(facts.limit_mm) * 1e3;
    // One scale for before and after: what the correction brings is what is seen.
    let both = (comparison.before.largest_mm * 1e3).max(left);
    let drawing = |title: &str, value: fn(&Trace) -> f64, largest: f64| {
        let all = stretches(&comparison.traces, value, largest);
        let start = comparison.traces.first().map(|first| first.way.at(0.0).into());
        let amounts = Amounts { largest, within: None, unit: MICROMETRES.in_language(language) };
        path(language, title, solid, &all, start, &amounts)
    };
    let posted = say!(language, "Tool path as posted", "Траектория по исходной программе");
    let posted_caption = say!(
        language,
        "Axis commands of the feed motions as posted, coloured by the largest distance of the tool from each motion.",
        "Координаты осей в рабочих движениях исходной программы; цвет — наибольшее расстояние инструмента от каждого движения."
    );
    let corrected = say!(language, "Tool path as corrected", "Траектория по исправленной программе");
    let corrected_caption = say!(
        language,
        "The same motions as corrected, on the same scale.",
        "Те же движения по исправленной программе, на той же шкале."
    );
    let rest = say!(language, "What is left", "Что осталось");
    let rest_caption = say!(
        language,
        "The same on a scale of its own, which ends at what is allowed, or at the largest if that is more.",
        "То же на своей шкале: она кончается на допустимом или на наибольшем, если оно больше."
    );
    html! {
        (figure(language, &drawing(&posted, |t| t.before_mm * 1e3, both), &posted_caption, None))
        (figure(language, &drawing(&corrected, |t| t.after_mm * 1e3, both), &corrected_caption, None))
        @if both > left {
            (figure(language, &drawing(&rest, |t| t.after_mm * 1e3, left), &rest_caption, None))
        }
    }
}

/// The box around everything that is fed.
fn solid(traces: &[Trace]) -> Option<Solid> {
    let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for place in traces.iter().flat_map(|trace| places(&trace.way)) {
        for (range, value) in ranges.iter_mut().zip(place) {
            *range = (range.0.min(value), range.1.max(value));
        }
    }
    ranges.iter().all(|(low, high)| low <= high).then_some(Solid { ranges })
}

/// Places along a motion, ends included.
fn places(way: &Way) -> impl Iterator<Item = [f64; 3]> + use<'_> {
    let pieces = (way.turning_rad() / TURN_RAD).ceil().clamp(1.0, 200.0) as u32;
    (0..=pieces).map(move |k| way.at(f64::from(k) / f64::from(pieces)).into())
}

/// Motions of one colour that follow one another are one stretch; places closer than can be seen are left out, the
/// more the longer the program is.
fn stretches(traces: &[Trace], value: fn(&Trace) -> f64, largest: f64) -> Vec<Stretch> {
    let Some(Solid { ranges }) = solid(traces) else { return Vec::new() };
    let size = ranges.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let mut apart = size / 1500.0;
    loop {
        let found = stretches_apart(traces, value, largest, apart);
        if found.iter().map(|s| s.places.len()).sum::<usize>() <= MOST_PLACES || apart >= size {
            return found;
        }
        apart *= 1.5;
    }
}

fn stretches_apart(traces: &[Trace], value: fn(&Trace) -> f64, largest: f64, apart: f64) -> Vec<Stretch> {
    let near = |a: &[f64; 3], b: &[f64; 3], reach: f64| {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() <= reach * reach
    };
    let shade = |v: f64| if largest > 0.0 { (v / largest * 10.0).floor() } else { 0.0 };
    let mut all: Vec<Stretch> = Vec::new();
    let mut end = None;
    for trace in traces {
        let value = value(trace);
        let mut way = places(&trace.way);
        let Some(from) = way.next() else { continue };
        let joins = end.is_some_and(|end: [f64; 3]| near(&end, &from, 1e-6));
        let goes_on = joins && all.last().is_some_and(|s| shade(s.value) == shade(value));
        if !goes_on {
            // A stretch that was thinned is drawn to its end before another begins.
            if let (Some(last), Some(end)) = (all.last_mut(), end) {
                last.places.push(end);
            }
            all.push(Stretch { places: vec![from], value });
        }
        let Some(stretch) = all.last_mut() else { continue };
        for place in way {
            if stretch.places.last().is_none_or(|last| !near(last, &place, apart)) {
                stretch.places.push(place);
            }
            end = Some(place);
        }
    }
    if let (Some(last), Some(end)) = (all.last_mut(), end) {
        last.places.push(end);
    }
    all
}

fn worst(comparison: &Comparison, facts: &Facts<'_>, language: Language) -> Markup {
    let list = |text: &str, line: fn(&Trace) -> Option<u64>, of: fn(&(f64, f64)) -> f64| {
        let lines: Vec<&str> = text.lines().collect();
        // A line may be several motions: the worst of them counts.
        let mut by_line: std::collections::BTreeMap<u64, (f64, f64)> = std::collections::BTreeMap::new();
        for trace in &comparison.traces {
            let Some(line) = line(trace) else { continue };
            let found = by_line.entry(line).or_default();
            *found = (found.0.max(trace.before_mm), found.1.max(trace.after_mm));
        }
        let mut all: Vec<(u64, (f64, f64))> = by_line.into_iter().collect();
        all.sort_by(|a, b| of(&b.1).total_cmp(&of(&a.1)).then(a.0.cmp(&b.0)));
        let rows: Vec<Vec<String>> = all
            .into_iter()
            .take(WORST)
            .map(|(line, (before, after))| {
                let text = usize::try_from(line).ok().and_then(|n| lines.get(n.checked_sub(1)?));
                let text = report::text::short(text.copied().unwrap_or_default(), 80);
                vec![line.to_string(), um(before, language), um(after, language), text]
            })
            .collect();
        let header = match language {
            Language::English => ["line", "before, \u{b5}m", "after, \u{b5}m", "block"],
            Language::Russian => ["строка", "до, мкм", "после, мкм", "кадр"],
        };
        table(language, &header, &[0, 1, 2], &rows)
    };
    let of = |name: &str| say!(language, "Lines of {}.", "Строки файла {}.", shown(without_folders(name)));
    html! {
        h3 { (say!(language, "As posted", "Исходная программа")) }
        p.muted { (of(facts.input)) }
        (list(facts.text, |trace| Some(trace.line), |found| found.0))
        h3 { (say!(language, "As corrected", "Исправленная программа")) }
        p.muted { (of(facts.output)) }
        (list(facts.output_text, |trace| trace.after_line, |found| found.1))
    }
}

fn provenance(facts: &Facts<'_>, language: Language) -> Markup {
    html! {
        dl {
            dt { (say!(language, "as posted", "исходная программа")) } dd { (shown(facts.input)) }
            dt { (say!(language, "as corrected", "исправленная программа")) } dd { (shown(facts.output)) }
            dt { (say!(language, "machine", "станок")) } dd { (shown(facts.machine)) }
            dt { (say!(language, "profile and its tables", "профиль и его таблицы")) } dd { (shown(facts.profile)) " " span.muted { "BLAKE3 " (facts.profile_hash) } }
            dt { (say!(language, "model", "модель")) } dd { (facts.engine) }
            @for (name, place) in &facts.setup {
                dt { (shown(name)) }
                dd { (place.map(|v| language.digits(v, 3)).join(" ")) (say!(language, " mm", " мм")) }
            }
            (facts.origin.rows(language))
            dt { (say!(language, "made by", "создано")) } dd { "vpost " (env!("CARGO_PKG_VERSION")) ", vpost.check/1" }
        }
    }
}

fn um(mm: f64, language: Language) -> String {
    language.number(mm * 1e3)
}
