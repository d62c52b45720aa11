//! The document: what was run, how it was scored, what came out.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use gap_lab::{Kind, NoiseKind};

use super::outcome::Outcome;
use super::scores::{
    Rate, Shrinkage, component_right, covered, direction_right, identifiable, of_kind, poor, quantile,
    shrinkage, shrinkage_by_lab, snr,
};
use super::table::{confusion, misses, numbers_off};

/// Circumstances of a run.
pub(crate) struct Run {
    pub(crate) speed: Vec<super::speed::Speed>,
    pub(crate) seed: u64,
    pub(crate) jobs: usize,
    pub(crate) elapsed: Duration,
    pub(crate) version: String,
}

/// Gap in σ at which an oracle that knows the true shape of every name, and asks about each of about 75 names at a
/// level of 1e-3 for all of them together, says yes in half the cases: two-sided normal quantile of 1e-3 / 75.
const ORACLE_SIGMA: f64 = 4.36;

const RULES: &str = include_str!("rules.md");

/// The whole page.
pub(crate) fn page(outcomes: &[Outcome], run: &Run) -> String {
    let mut text = String::from("# The diagnosis on machines with withheld effects\n\n");
    text.push_str("Made by `cargo run -p xtask --release -- gap-bench`; do not edit.\n\n");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    text += &format!(
        "{} · {} cases of seed {} · {} · {} ({cores} cores), {} cases at a time, {:.0} s\n\n",
        date(),
        outcomes.len(),
        run.seed,
        run.version,
        processor(),
        run.jobs,
        run.elapsed.as_secs_f64()
    );
    text.push_str("## Figures\n\n");
    text.push_str(&figures(outcomes));
    speeds(&mut text, &run.speed);
    text.push_str("\n## By kind of noise, by design, by family\n\n");
    text.push_str(&breakdown(outcomes));
    text.push_str(
        "\n## Confusion\n\nSingle effects on designs that can tell them from every other name; families.\n\n",
    );
    text.push_str(&confusion(outcomes));
    text.push('\n');
    text.push_str(RULES);
    text.push_str("\n## Every miss\n");
    text.push_str(&misses(outcomes));
    text.push_str("\n## Numbers that are off\n\n");
    text.push_str(&numbers_off(outcomes));
    text
}

/// The part of the page that belongs on a terminal.
pub(crate) fn summary(page: &str) -> String {
    let from = page.find("## Figures").unwrap_or(0);
    let to = page.find("## Confusion").unwrap_or(page.len());
    page[from..to].to_owned()
}

/// What a figure is to be.
#[derive(Clone, Copy)]
enum Goal {
    None,
    AtLeast(f64),
    AtMost(f64),
    Within(f64, f64),
}

impl Goal {
    fn is_met(self, share: f64) -> bool {
        match self {
            Self::None => true,
            Self::AtLeast(goal) => share >= goal,
            Self::AtMost(goal) => share <= goal,
            Self::Within(low, high) => (low..=high).contains(&share),
        }
    }
}

impl std::fmt::Display for Goal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::None => Ok(()),
            Self::AtLeast(goal) => write!(f, "≥ {:.0} %", 100.0 * goal),
            Self::AtMost(goal) => write!(f, "≤ {:.0} %", 100.0 * goal),
            Self::Within(low, high) => write!(f, "{:.0}–{:.0} %", 100.0 * low, 100.0 * high),
        }
    }
}

/// What stands behind a figure.
const fn miss(is_met: bool) -> &'static str {
    if is_met { "" } else { ", **not met**" }
}

/// A line of the table.
fn line(text: &mut String, name: &str, goal: Goal, rate: Rate) {
    let Rate { hits, total } = rate;
    if total == 0 {
        *text += &format!("| {name} | {goal} | – | – | no case |\n");
        return;
    }
    let met = miss(goal.is_met(rate.share()));
    *text += &format!("| {name} | {goal} | {} | {hits} of {total}{met} |\n", rate.cells());
}

/// What counts.
type Hit = fn(&Outcome) -> bool;

fn figures(all: &[Outcome]) -> String {
    let mut text = String::from("| figure | goal | found | 95 % interval | cases |\n|---|---|---|---|---|\n");
    let t = &mut text;
    ladder(t, all);
    let singles: Vec<&Outcome> = of_kind(all, Kind::Single).collect();
    let of = |list: &[&Outcome], hit: Hit| Rate::of(list.iter().copied(), hit);
    let seen: Vec<&Outcome> = singles.iter().copied().filter(|o| snr(o) > 0.9).collect();
    let name = "truth inside the reported set, SNR ≥ 1, silence counts as a miss";
    line(t, name, Goal::AtLeast(0.97), of(&seen, Outcome::inside));
    let named: Vec<&Outcome> =
        singles.iter().copied().filter(|o| o.said().is_some_and(|a| !a.causes.is_empty())).collect();
    line(t, "— where a cause was named, every SNR", Goal::None, of(&named, Outcome::inside));
    let sizes: Vec<f64> = named.iter().filter_map(|o| o.said()).map(|a| a.set().len() as f64).collect();
    let (size, count) = (quantile(sizes.clone(), 0.5), sizes.len());
    *t += &format!("| — median size of the set | ≤ 2 | {size:.0} | | {count} |\n");
    let kinds: [(&str, Goal, Kind, Hit); 4] = [
        (
            "aliased design → AMBIGUOUS with the truth inside",
            Goal::AtLeast(0.95),
            Kind::Aliased,
            Outcome::honest,
        ),
        ("false alarms on nulls of every kind", Goal::AtMost(0.05), Kind::Null, Outcome::false_alarm),
        (
            "effect outside the library → PARTIAL or UNKNOWN",
            Goal::AtLeast(0.85),
            Kind::Outside,
            Outcome::admits_unknown,
        ),
        (
            "true effect removed from the library → PARTIAL or UNKNOWN",
            Goal::AtLeast(0.85),
            Kind::Removed,
            Outcome::admits_unknown,
        ),
    ];
    for (name, goal, kind, hit) in kinds {
        line(t, name, goal, Rate::of(of_kind(all, kind), hit));
    }
    line(t, "confident wrong name, all cases", Goal::AtMost(0.02), Rate::of(all, Outcome::confidently_wrong));
    several(t, all);
    shrinkages(t, all);
    let mut coverage = Rate::default();
    all.iter().filter_map(covered).for_each(|hit| coverage.add(hit));
    line(t, "parameter inside its 95 % interval", Goal::Within(0.9, 0.98), coverage);
    places(t, all);
    for (name, kind) in
        [("ball bar", Kind::BallBar), ("magnitude only", Kind::Magnitude), ("rotary table", Kind::Rotary)]
    {
        line(t, &format!("{name}: right"), Goal::None, Rate::of(of_kind(all, kind), Outcome::right));
    }
    times(t, all);
    let checked: Vec<f64> = all.iter().filter_map(|o| o.transport).map(|c| c.kinematics_um).collect();
    if !checked.is_empty() {
        let (worst, count) = (checked.iter().copied().fold(0.0, f64::max), checked.len());
        *t += &format!(
            "| largest difference of the lab's kinematics and the model's | | {worst:.3} µm | | {count} profiles |\n"
        );
    }
    text
}

/// Single effects, rung by rung.
fn ladder(t: &mut String, all: &[Outcome]) {
    let rungs = [("SNR ≥ 3", 2.0, 99.0, 0.95), ("SNR 1", 0.9, 1.1, 0.92), ("SNR 0.3", 0.2, 0.4, 0.80)];
    for (word, low, high, goal) in rungs {
        let list = identifiable(all, low, high);
        let rate = |l: &[&Outcome]| Rate::of(l.iter().copied(), Outcome::right_first);
        let above = |sigma: f64| {
            let shown = list.iter().copied().filter(|o| o.case.truth.expected_sigma >= sigma);
            rate(&shown.collect::<Vec<_>>())
        };
        let name = format!("right effect and axis first, {word}, identifiable");
        line(t, &name, Goal::AtLeast(goal), rate(&list));
        line(t, &format!("— of these, poor designs, {word}"), Goal::None, rate(&poor(&list)));
        let name = format!("— of these, an oracle sees it in half the cases, {word}");
        line(t, &name, Goal::None, above(ORACLE_SIGMA));
        line(t, &format!("— of these, gap ≥ 6 σ in all, {word}"), Goal::None, above(6.0));
    }
}

/// Several effects at once.
fn several(t: &mut String, all: &[Outcome]) {
    let rows = [("two or three effects", 2..=3, Goal::AtLeast(0.9)), ("four effects", 4..=4, Goal::None)];
    for (word, counts, goal) in rows {
        let (mut recall, mut precision) = (Rate::default(), Rate::default());
        for o in of_kind(all, Kind::Multiple).filter(|o| counts.contains(&o.case.truth.effects.len())) {
            let missed = o.missed().len();
            (0..o.case.truth.effects.len()).for_each(|k| recall.add(k >= missed));
            let causes = o.said().map(|a| a.causes.as_slice()).unwrap_or_default();
            causes.iter().for_each(|c| precision.add(o.case.truth.effects.iter().any(|e| e.id == c.effect)));
        }
        line(t, &format!("{word}: recall"), goal, recall);
        line(t, &format!("{word}: precision"), goal, precision);
    }
}

/// How far the gap shrinks, against what was predicted.
fn shrinkages(t: &mut String, all: &[Outcome]) {
    let named = |o: &&Outcome| o.said().is_some_and(|a| a.verdict != "PARTIAL");
    let magnitude = |o: &&Outcome| o.case.kind == Kind::Magnitude;
    let claims = || all.iter().filter(|o| named(o) && !magnitude(o));
    let partly = all.iter().filter(|o| !named(o) && !magnitude(o));
    let goal = Goal::AtLeast(0.9);
    let list: Vec<Shrinkage> = claims().filter_map(shrinkage).collect();
    shrink_lines(t, "NAMED or AMBIGUOUS: hold-out block of the answer", goal, &list);
    let list: Vec<Shrinkage> = claims().filter_map(shrinkage_by_lab).collect();
    shrink_lines(t, "NAMED or AMBIGUOUS: the lab's own account of the written profile", goal, &list);
    shrink_lines(t, "PARTIAL: hold-out block", Goal::None, &partly.filter_map(shrinkage).collect::<Vec<_>>());
    let list: Vec<Shrinkage> = all.iter().filter(magnitude).filter_map(shrinkage).collect();
    shrink_lines(t, "magnitude only: hold-out block", Goal::None, &list);
}

/// Where the gap lies.
fn places(t: &mut String, all: &[Outcome]) {
    let strong = || of_kind(all, Kind::Single).filter(|o| snr(o) > 2.0);
    let mut component = Rate::default();
    strong().filter_map(component_right).for_each(|hit| component.add(hit));
    line(t, "where: component right, SNR ≥ 3", Goal::AtLeast(0.95), component);
    let mut direction = Rate::default();
    identifiable(all, 2.0, 99.0).into_iter().filter_map(direction_right).for_each(|hit| direction.add(hit));
    let name = "where: axis and direction right (backlash, lost motion, servo lag and mismatch), SNR ≥ 3";
    line(t, name, Goal::AtLeast(0.95), direction);
    let overlaps: Vec<f64> = strong().filter_map(super::voxels::overlap).collect();
    if !overlaps.is_empty() {
        let mean = overlaps.iter().sum::<f64>() / overlaps.len() as f64;
        let (count, met) = (overlaps.len(), miss(mean >= 0.6));
        *t += &format!(
            "| where: overlap of the worst 20 % of cells, SNR ≥ 3, mean | ≥ 0.6 | {mean:.2} | | {count}{met} |\n"
        );
    }
}

/// Shrinkage within five points, and the bias; with a goal or, where nothing was promised, without.
fn shrink_lines(t: &mut String, source: &str, goal: Goal, list: &[Shrinkage]) {
    let mut near = Rate::default();
    list.iter().for_each(|s| near.add((s.predicted - s.achieved).abs() <= 5.0));
    let name = format!("predicted shrinkage within ±5 points of achieved ({source})");
    line(t, &name, goal, near);
    if !list.is_empty() {
        let off = || list.iter().map(|s| s.predicted - s.achieved);
        let (mean, middle) = (off().sum::<f64>() / list.len() as f64, quantile(off().collect(), 0.5));
        let (word, met) = match goal {
            Goal::None => ("", ""),
            _ if mean.abs() > 1.0 => ("≤ 1", "**not met**"),
            _ => ("≤ 1", ""),
        };
        *t += &format!("| — bias, points: mean (median) | {word} | {mean:+.2} ({middle:+.2}) | | {met} |\n");
    }
}

fn times(t: &mut String, all: &[Outcome]) {
    let rows = |o: &&Outcome| o.case.files[1].1.lines().count() - 1;
    let long = || all.iter().filter(|o| rows(o) >= 1500);
    let lists: [(&str, Vec<f64>); 3] = [
        ("processor, all cases", all.iter().map(|o| o.cpu_seconds).collect()),
        ("processor, 1500 rows and more", long().map(|o| o.cpu_seconds).collect()),
        ("clock, 1500 rows and more", long().map(|o| o.seconds).collect()),
    ];
    for (word, list) in lists {
        if list.is_empty() {
            continue;
        }
        let [middle, most, longest] = [0.5, 0.95, 1.0].map(|share| quantile(list.clone(), share));
        let count = list.len();
        *t += &format!(
            "| time of one diagnosis, {word}: median, 95 %, longest | 3000 rows ≤ 2 s | {middle:.2} s, {most:.2} s, {longest:.2} s | | {count} |\n"
        );
    }
}

/// Files of a stated size.
fn speeds(t: &mut String, list: &[super::speed::Speed]) {
    for super::speed::Speed { what, rows, seconds, cpu_seconds, peak_mib, verdict, goal } in list {
        let peak = peak_mib.map_or("memory unknown".to_owned(), |m| format!("{m:.0} MiB"));
        let (most_s, most_mib) = goal;
        let met = miss(cpu_seconds <= most_s && peak_mib.is_none_or(|m| m <= *most_mib));
        *t += &format!(
            "| {what} | ≤ {most_s:.0} s, {most_mib:.0} MiB | {cpu_seconds:.2} s of the processor, {seconds:.2} s on the clock, {peak} ({verdict}) | | {rows} rows{met} |\n"
        );
    }
}

/// Shares of right answers in groups, and the verdicts given.
fn breakdown(all: &[Outcome]) -> String {
    let mut text = String::from("| group | right | 95 % interval | cases |\n|---|---|---|---|\n");
    let mut row = |name: String, list: &mut dyn Iterator<Item = &Outcome>| {
        let rate = Rate::of(list, Outcome::right);
        if rate.total > 0 {
            text += &format!("| {name} | {} | {} of {} |\n", rate.cells(), rate.hits, rate.total);
        }
    };
    let of = |kind| of_kind(all, kind);
    for noise in NoiseKind::ALL {
        row(format!("null, {}", noise.word()), &mut of(Kind::Null).filter(|o| o.case.noise == noise));
    }
    let mut plans: Vec<&str> = of(Kind::Single).map(|o| o.case.plan.word()).collect();
    plans.sort_unstable();
    plans.dedup();
    for plan in plans {
        row(format!("single, {plan}"), &mut of(Kind::Single).filter(|o| o.case.plan.word() == plan));
    }
    for kind in [Kind::Single, Kind::Removed, Kind::Outside, Kind::BallBar, Kind::Aliased] {
        let family = |o: &Outcome| {
            let id = o.truth().unwrap_or_default();
            if kind == Kind::Outside { id.to_owned() } else { id.split('.').next().unwrap_or(id).to_owned() }
        };
        let mut families: Vec<String> = of(kind).map(family).collect();
        families.sort_unstable();
        families.dedup();
        for name in families {
            row(format!("{}, {name}", kind.word()), &mut of(kind).filter(|o| family(o) == name));
        }
    }
    text
}

/// Today, from the system's clock, as year-month-day.
pub(crate) fn date() -> String {
    let days = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs() / 86_400) as i64;
    // Days since 1970 to a date of the Gregorian calendar, counted from 1 March of year 0.
    let day = days + 719_468;
    let era = day.div_euclid(146_097);
    let of_era = day.rem_euclid(146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + era * 400 + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{of_month:02}")
}

/// Name of the processor, where the system tells.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split(':').nth(1));
    name.map_or_else(|| std::env::consts::ARCH.to_owned(), |n| n.trim().to_owned())
}
