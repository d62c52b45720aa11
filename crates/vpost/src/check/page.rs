//! The check as one page: the tool path coloured by its error before and after, the worst blocks by line.

use std::collections::BTreeMap;

use diagnostic::{Language, Text, both};
use path_comparison::{Comparison, Trace, Way};
use report::body::{Body, Fact, Table};
use report::chart::Amounts;
use report::chart::solid::{Solid, Stretch, path};
use report::numbers::{count, digits, number, prose};
use report::page::Page;
use report::text::short;

use crate::file::without_folders;
use crate::origin::{MACHINE, MODEL, PROFILE};

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
    let title = both!("Check \u{2013} {}", "Проверка \u{2014} {}", facts.output);
    let mut page = Page::new(language, title, "check", "vpost.check/1");
    head(&mut page.head, comparison, facts);
    result(page.section("result", both!("Result", "Результат")), comparison, facts);
    paths(page.section("path", both!("The tool path", "Траектория инструмента")), comparison, facts);
    let out = page.section("worst", both!("Worst blocks", "Худшие кадры"));
    out.heading(&AS_POSTED);
    worst(out, facts.input, comparison, facts.text, |trace| Some(trace.line), |found| found.0);
    out.heading(&AS_CORRECTED);
    worst(out, facts.output, comparison, facts.output_text, |trace| trace.after_line, |found| found.1);
    page.provenance(provenance(facts));
    page.into_html(json)
}

const AS_POSTED: Text = Text::pair("As posted", "Исходная программа");
const AS_CORRECTED: Text = Text::pair("As corrected", "Исправленная программа");

fn head(out: &mut Body, comparison: &Comparison, facts: &Facts<'_>) {
    let (machine, output) = (facts.machine, without_folders(facts.output));
    out.muted(&both!(
        "Both programs through the machine model: {machine}, {output}",
        "Обе программы по модели станка: {machine}, {output}"
    ));
    let [before, after, limit] =
        [comparison.before.largest_mm, comparison.after.largest_mm, facts.limit_mm].map(um);
    let (verdict, next_step) = match facts.passed {
        true => (
            both!("PASSED", "ПРОЙДЕНО"),
            both!(
                "Run the corrected program. It holds for this machine as its profile describes it, with the zeros and tools below.",
                "Запускайте исправленную программу. Она годится для этого станка, каким его описывает профиль, с нулями и инструментами ниже."
            ),
        ),
        false => (
            both!("FAILED", "НЕ ПРОЙДЕНО"),
            both!(
                "Do not run the corrected program: see the findings, and correct the program as posted once more.",
                "Исправленную программу не запускайте: смотрите, что найдено, и исправьте исходную программу заново."
            ),
        ),
    };
    out.verdict(
        &verdict,
        &both!(
            "As posted the tool is up to {before} \u{b5}m off its path, as corrected up to {after} \u{b5}m; allowed are {limit} \u{b5}m",
            "По исходной программе инструмент отходит от траектории до {before:#} мкм, по исправленной — до {after:#} мкм; допустимо {limit:#} мкм"
        ),
    );
    out.p(&next_step);
    out.muted(&facts.origin.said());
}

fn result(out: &mut Body, comparison: &Comparison, facts: &Facts<'_>) {
    let [wanted, commanded] = [comparison.wanted, comparison.commanded].map(count);
    let motions = both!(
        "{wanted} as posted, {commanded} as corrected",
        "{wanted:#} в исходной, {commanded:#} в исправленной"
    );
    let largest = |mm: f64, line: u64| {
        let um = um(mm);
        both!("{um} \u{b5}m, line {line} as posted", "{um:#} мкм, строка {line} исходной")
    };
    let (before, after) = (&comparison.before, &comparison.after);
    out.facts([
        Fact::new(both!("feed motions", "рабочих движений"), &motions),
        Fact::new(both!("largest before", "наибольшее до"), &largest(before.largest_mm, before.line)),
        Fact::new(both!("largest after", "наибольшее после"), &largest(after.largest_mm, after.line)),
        Fact::new(
            both!("moves to a corrected start", "подводов к исправленному началу"),
            &count(comparison.approaches),
        ),
    ]);
    if !facts.findings.is_empty() {
        out.heading(&both!("Findings", "Что найдено"));
        out.list(&facts.findings.iter().map(prose).collect::<Vec<_>>());
    }
}

fn paths(out: &mut Body, comparison: &Comparison, facts: &Facts<'_>) {
    let Some(solid) = solid(&comparison.traces) else {
        out.p(&both!(
            "The program feeds nowhere: there is no path to draw.",
            "В программе нет движений на рабочей подаче: рисовать нечего."
        ));
        return;
    };
    let left = comparison.after.largest_mm.max(facts.limit_mm) * 1e3;
    // One scale for before and after: what the correction brings is what is seen.
    let whole = (comparison.before.largest_mm * 1e3).max(left);
    let mut draw = |title: Text, value: fn(&Trace) -> f64, largest: f64, caption: Text| {
        let all = stretches(&comparison.traces, value, largest);
        let start = comparison.traces.first().map(|first| first.way.at(0.0).into());
        let amounts = Amounts { largest, within: None };
        out.figure(&path(out.language(), &title, solid, &all, start, &amounts), &caption);
    };
    draw(
        both!("Tool path as posted", "Траектория по исходной программе"),
        |t| t.before_mm * 1e3,
        whole,
        both!(
            "Axis commands of the feed motions as posted, coloured by the largest distance of the tool from each motion.",
            "Координаты осей в рабочих движениях исходной программы; цвет — наибольшее расстояние инструмента от каждого движения."
        ),
    );
    draw(
        both!("Tool path as corrected", "Траектория по исправленной программе"),
        |t| t.after_mm * 1e3,
        whole,
        both!(
            "The same motions as corrected, on the same scale.",
            "Те же движения по исправленной программе, на той же шкале."
        ),
    );
    if whole > left {
        draw(
            both!("What is left", "Что осталось"),
            |t| t.after_mm * 1e3,
            left,
            both!(
                "The same on a scale of its own, which ends at what is allowed, or at the largest if that is more.",
                "То же на своей шкале: она кончается на допустимом или на наибольшем, если оно больше."
            ),
        );
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

fn worst(
    out: &mut Body,
    name: &str,
    comparison: &Comparison,
    text: &str,
    line: fn(&Trace) -> Option<u64>,
    of: fn(&(f64, f64)) -> f64,
) {
    out.muted(&both!("Lines of {}.", "Строки файла {}.", without_folders(name)));
    let lines: Vec<&str> = text.lines().collect();
    // A line may be several motions: the worst of them counts.
    let mut by_line: BTreeMap<u64, (f64, f64)> = BTreeMap::new();
    for trace in &comparison.traces {
        let Some(line) = line(trace) else { continue };
        let found = by_line.entry(line).or_default();
        *found = (found.0.max(trace.before_mm), found.1.max(trace.after_mm));
    }
    let mut all: Vec<(u64, (f64, f64))> = by_line.into_iter().collect();
    all.sort_by(|a, b| of(&b.1).total_cmp(&of(&a.1)).then(a.0.cmp(&b.0)));
    let block = |line: u64| lines.get(usize::try_from(line).ok()?.checked_sub(1)?).copied();
    let table = Table::of(all.into_iter().take(WORST))
        .numbers(both!("line", "строка"), |(line, _)| Text::same(line.to_string()))
        .numbers(both!("before, \u{b5}m", "до, мкм"), |(_, (before, _))| um(*before))
        .numbers(both!("after, \u{b5}m", "после, мкм"), |(_, (_, after))| um(*after))
        .words(both!("block", "кадр"), |(line, _)| {
            Text::same(short(block(*line).unwrap_or_default(), 80))
        });
    out.table(&table);
}

fn provenance(facts: &Facts<'_>) -> Vec<Fact> {
    let mut all = vec![
        Fact::same(both!("as posted", "исходная программа"), facts.input),
        Fact::same(both!("as corrected", "исправленная программа"), facts.output),
        Fact::same(MACHINE, facts.machine),
        Fact::file(PROFILE, facts.profile, Some(facts.profile_hash.to_owned())),
        Fact::same(MODEL, facts.engine),
    ];
    all.extend(facts.setup.iter().map(|(name, place)| {
        let place = Text::join(&place.map(|v| digits(v, 3)), " ");
        Fact::new(Text::same(name), &both!("{place} mm", "{place:#} мм"))
    }));
    all.extend(facts.origin.facts());
    all
}

fn um(mm: f64) -> Text {
    number(mm * 1e3)
}
