//! The document: what was run, how it was scored, what came out.

use std::fmt::Write;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use gap_lab::{Kind, NoiseKind};

use super::outcome::Outcome;
use super::scores::{
    Rate, Shrinkage, component_right, covered, direction_right, identifiable, of_kind, poor, quantile,
    shrinkage, shrinkage_by_lab,
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
    let words = format!(
        "{} · {} cases of seed {} · {} · {} ({cores} cores), {} cases at a time, {:.0} s\n\n",
        date(),
        outcomes.len(),
        run.seed,
        run.version,
        processor(),
        run.jobs,
        run.elapsed.as_secs_f64()
    );
    text.push_str(&words);
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

/// A line of the table: goal in words, whether it is met.
fn line(text: &mut String, name: &str, goal: &str, rate: Rate, met: impl Fn(f64) -> bool) {
    if rate.total == 0 {
        writeln!(text, "| {name} | {goal} | – | – | no case |").expect("writing to a string cannot fail");
        return;
    }
    let (low, high) = rate.wilson();
    writeln!(
        text,
        "| {name} | {goal} | {:.1} % | {:.1} – {:.1} % | {} of {}{} |",
        100.0 * rate.share(),
        100.0 * low,
        100.0 * high,
        rate.hits,
        rate.total,
        if met(rate.share()) { "" } else { ", **not met**" }
    )
    .expect("writing to a string cannot fail");
}

fn figures(all: &[Outcome]) -> String {
    let mut text = String::from("| figure | goal | found | 95 % interval | cases |\n|---|---|---|---|---|\n");
    let t = &mut text;
    let ladder = [("SNR ≥ 3", 2.0, 99.0, 0.95), ("SNR 1", 0.9, 1.1, 0.92), ("SNR 0.3", 0.2, 0.4, 0.80)];
    for (word, low, high, goal) in ladder {
        let list = identifiable(all, low, high);
        let rate = |l: &[&Outcome]| Rate::of(l.iter().copied(), Outcome::right_first);
        let goal_word = format!("≥ {:.0} %", 100.0 * goal);
        line(
            t,
            &format!("right effect and axis first, {word}, identifiable"),
            &goal_word,
            rate(&list),
            |s| s >= goal,
        );
        line(t, &format!("— of these, poor designs, {word}"), "", rate(&poor(&list)), |_| true);
        let shown = list.iter().copied().filter(|o| o.case.truth.expected_sigma >= ORACLE_SIGMA);
        let shown: Vec<&Outcome> = shown.collect();
        line(
            t,
            &format!("— of these, an oracle sees it in half the cases, {word}"),
            "",
            rate(&shown),
            |_| true,
        );
        let strong: Vec<&Outcome> = list.into_iter().filter(|o| o.case.truth.expected_sigma >= 6.0).collect();
        line(t, &format!("— of these, gap ≥ 6 σ in all, {word}"), "", rate(&strong), |_| true);
    }
    let singles: Vec<&Outcome> = of_kind(all, Kind::Single).collect();
    let seen: Vec<&Outcome> = singles.iter().copied().filter(|o| super::scores::snr(o) > 0.9).collect();
    line(
        t,
        "truth inside the reported set, SNR ≥ 1, silence counts as a miss",
        "≥ 97 %",
        Rate::of(seen.iter().copied(), Outcome::inside),
        |s| s >= 0.97,
    );
    let named: Vec<&Outcome> =
        singles.iter().copied().filter(|o| o.said().is_some_and(|a| !a.causes.is_empty())).collect();
    line(
        t,
        "— where a cause was named, every SNR",
        "",
        Rate::of(named.iter().copied(), Outcome::inside),
        |_| true,
    );
    let sizes: Vec<f64> = named.iter().filter_map(|o| o.said()).map(|a| a.set().len() as f64).collect();
    writeln!(
        t,
        "| — median size of the set | ≤ 2 | {:.0} | | {} |",
        quantile(sizes.clone(), 0.5),
        sizes.len()
    )
    .expect("writing to a string cannot fail");
    line(
        t,
        "aliased design → AMBIGUOUS with the truth inside",
        "≥ 95 %",
        Rate::of(of_kind(all, Kind::Aliased), Outcome::honest),
        |s| s >= 0.95,
    );
    line(
        t,
        "false alarms on nulls of every kind",
        "≤ 5 %",
        Rate::of(of_kind(all, Kind::Null), Outcome::false_alarm),
        |s| s <= 0.05,
    );
    line(
        t,
        "effect outside the library → PARTIAL or UNKNOWN",
        "≥ 85 %",
        Rate::of(of_kind(all, Kind::Outside), Outcome::admits_unknown),
        |s| s >= 0.85,
    );
    line(
        t,
        "true effect removed from the library → PARTIAL or UNKNOWN",
        "≥ 85 %",
        Rate::of(of_kind(all, Kind::Removed), Outcome::admits_unknown),
        |s| s >= 0.85,
    );
    line(t, "confident wrong name, all cases", "≤ 2 %", Rate::of(all, Outcome::confidently_wrong), |s| {
        s <= 0.02
    });
    for (word, low, high, goal) in [("two or three effects", 2, 3, 0.9), ("four effects", 4, 4, 0.0)] {
        let (mut recall, mut precision) = (Rate::default(), Rate::default());
        for o in of_kind(all, Kind::Multiple).filter(|o| (low..=high).contains(&o.case.truth.effects.len())) {
            let missed = o.missed().len();
            (0..o.case.truth.effects.len()).for_each(|k| recall.add(k >= missed));
            let causes = o.said().map(|a| a.causes.as_slice()).unwrap_or_default();
            causes.iter().for_each(|c| precision.add(o.case.truth.effects.iter().any(|e| e.id == c.effect)));
        }
        let goal_word = if goal > 0.0 { "≥ 90 %" } else { "" };
        line(t, &format!("{word}: recall"), goal_word, recall, |s| s >= goal);
        line(t, &format!("{word}: precision"), goal_word, precision, |s| s >= goal);
    }
    let named = |o: &&Outcome| o.said().is_some_and(|a| a.verdict != "PARTIAL");
    let magnitude = |o: &&Outcome| o.case.kind == Kind::Magnitude;
    let claims = || all.iter().filter(|o| named(o) && !magnitude(o));
    let partly = all.iter().filter(|o| !named(o) && !magnitude(o));
    let list: Vec<Shrinkage> = claims().filter_map(shrinkage).collect();
    shrink_lines(t, "NAMED or AMBIGUOUS: hold-out block of the answer", Some(0.9), &list);
    let list: Vec<Shrinkage> = claims().filter_map(shrinkage_by_lab).collect();
    shrink_lines(t, "NAMED or AMBIGUOUS: the lab's own account of the written profile", Some(0.9), &list);
    shrink_lines(t, "PARTIAL: hold-out block", None, &partly.filter_map(shrinkage).collect::<Vec<_>>());
    let list: Vec<Shrinkage> = all.iter().filter(magnitude).filter_map(shrinkage).collect();
    shrink_lines(t, "magnitude only: hold-out block", None, &list);
    let mut coverage = Rate::default();
    all.iter().filter_map(covered).for_each(|hit| coverage.add(hit));
    line(t, "parameter inside its 95 % interval", "90–98 %", coverage, |s| (0.9..=0.98).contains(&s));
    let mut component = Rate::default();
    of_kind(all, Kind::Single)
        .filter(|o| super::scores::snr(o) > 2.0)
        .filter_map(component_right)
        .for_each(|hit| component.add(hit));
    line(t, "where: component right, SNR ≥ 3", "≥ 95 %", component, |s| s >= 0.95);
    let mut direction = Rate::default();
    identifiable(all, 2.0, 99.0).into_iter().filter_map(direction_right).for_each(|hit| direction.add(hit));
    let name = "where: axis and direction right (backlash, lost motion, servo lag and mismatch), SNR ≥ 3";
    line(t, name, "≥ 95 %", direction, |s| s >= 0.95);
    let overlaps: Vec<f64> = of_kind(all, Kind::Single)
        .filter(|o| super::scores::snr(o) > 2.0)
        .filter_map(super::voxels::overlap)
        .collect();
    if !overlaps.is_empty() {
        let mean = overlaps.iter().sum::<f64>() / overlaps.len() as f64;
        let met = if mean >= 0.6 { "" } else { ", **not met**" };
        writeln!(
            t,
            "| where: overlap of the worst 20 % of cells, SNR ≥ 3, mean | ≥ 0.6 | {mean:.2} | | {}{met} |",
            overlaps.len()
        )
        .expect("writing to a string cannot fail");
    }
    line(t, "ball bar: right", "", Rate::of(of_kind(all, Kind::BallBar), Outcome::right), |_| true);
    line(t, "magnitude only: right", "", Rate::of(of_kind(all, Kind::Magnitude), Outcome::right), |_| true);
    line(t, "rotary table: right", "", Rate::of(of_kind(all, Kind::Rotary), Outcome::right), |_| true);
    times(t, all);
    let checked: Vec<f64> = all.iter().filter_map(|o| o.transport).map(|c| c.kinematics_um).collect();
    if !checked.is_empty() {
        let worst = checked.iter().copied().fold(0.0, f64::max);
        writeln!(
            t,
            "| largest difference of the lab's kinematics and the model's | | {:.3} µm | | {} profiles |",
            worst,
            checked.len()
        )
        .expect("writing to a string cannot fail");
    }
    text
}

/// Shrinkage within five points, and the bias; with a goal or, where nothing was promised, without.
fn shrink_lines(t: &mut String, source: &str, goal: Option<f64>, list: &[Shrinkage]) {
    let mut near = Rate::default();
    list.iter().for_each(|s| near.add((s.predicted - s.achieved).abs() <= 5.0));
    let word = if goal.is_some() { "≥ 90 %" } else { "" };
    let name = format!("predicted shrinkage within ±5 points of achieved ({source})");
    line(t, &name, word, near, |s| goal.is_none_or(|g| s >= g));
    if !list.is_empty() {
        let off = || list.iter().map(|s| s.predicted - s.achieved);
        let (mean, middle) = (off().sum::<f64>() / list.len() as f64, quantile(off().collect(), 0.5));
        let (word, met) = match goal {
            Some(_) if mean.abs() > 1.0 => ("≤ 1", "**not met**"),
            Some(_) => ("≤ 1", ""),
            None => ("", ""),
        };
        writeln!(t, "| — bias, points: mean (median) | {word} | {mean:+.2} ({middle:+.2}) | | {met} |")
            .expect("writing to a string cannot fail");
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
        writeln!(
            t,
            "| time of one diagnosis, {word}: median, 95 %, longest | 3000 rows ≤ 2 s | {:.2} s, {:.2} s, {:.2} s | | {} |",
            quantile(list.clone(), 0.5),
            quantile(list.clone(), 0.95),
            quantile(list.clone(), 1.0),
            list.len()
        )
        .expect("writing to a string cannot fail");
    }
}

/// Files of a stated size.
fn speeds(t: &mut String, list: &[super::speed::Speed]) {
    for s in list {
        let peak = s.peak_mib.map_or("memory unknown".to_owned(), |m| format!("{m:.0} MiB"));
        let met = s.cpu_seconds <= s.goal.0 && s.peak_mib.is_none_or(|m| m <= s.goal.1);
        writeln!(
            t,
            "| {} | ≤ {:.0} s, {:.0} MiB | {:.2} s of the processor, {:.2} s on the clock, {peak} ({}) | | {} rows{} |",
            s.what,
            s.goal.0,
            s.goal.1,
            s.cpu_seconds,
            s.seconds,
            s.verdict,
            s.rows,
            if met { "" } else { ", **not met**" }
        )
        .expect("writing to a string cannot fail");
    }
}

/// Shares of right answers in groups, and the verdicts given.
fn breakdown(all: &[Outcome]) -> String {
    let mut text = String::from("| group | right | 95 % interval | cases |\n|---|---|---|---|\n");
    let mut row = |name: String, list: Vec<&Outcome>| {
        let rate = Rate::of(list, Outcome::right);
        if rate.total > 0 {
            let (low, high) = rate.wilson();
            let (share, low, high) = (100.0 * rate.share(), 100.0 * low, 100.0 * high);
            writeln!(
                text,
                "| {name} | {share:.1} % | {low:.1} – {high:.1} % | {} of {} |",
                rate.hits, rate.total
            )
            .expect("writing to a string cannot fail");
        }
    };
    for noise in NoiseKind::ALL {
        row(
            format!("null, {}", noise.word()),
            of_kind(all, Kind::Null).filter(|o| o.case.noise == noise).collect(),
        );
    }
    let mut plans: Vec<&str> = of_kind(all, Kind::Single).map(|o| o.case.plan.word()).collect();
    plans.sort_unstable();
    plans.dedup();
    for plan in plans {
        row(
            format!("single, {plan}"),
            of_kind(all, Kind::Single).filter(|o| o.case.plan.word() == plan).collect(),
        );
    }
    for kind in [Kind::Single, Kind::Removed, Kind::Outside, Kind::BallBar, Kind::Aliased] {
        let family = |o: &Outcome| {
            let id = o.truth().unwrap_or_default();
            if kind == Kind::Outside { id.to_owned() } else { id.split('.').next().unwrap_or(id).to_owned() }
        };
        let mut families: Vec<String> = of_kind(all, kind).map(family).collect();
        families.sort_unstable();
        families.dedup();
        for name in families {
            row(
                format!("{}, {name}", kind.word()),
                of_kind(all, kind).filter(|o| family(o) == name).collect(),
            );
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
