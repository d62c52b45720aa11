//! What is printed.

use std::fmt::Write;

use error_budget::OneSided;
use error_budget::mending::Mending;
use error_budget::tolerances::Tolerances;

use super::study::{Combined, MENDING_OUT_OF_REACH, Study, Target};
use crate::figures::{fixed, printable, round, triple, um};

/// The page.
pub(super) fn page(study: &Study) -> String {
    let mut out = head(study);
    items(study, &mut out);
    together(study, &mut out);
    if let Some(target) = &study.target {
        mending(study, target, &mut out);
        tolerances(study, target, &mut out);
    }
    out
}

fn head(study: &Study) -> String {
    let m = &study.budget.measured;
    format!(
        "{}: {} deviations at {} control points, {}\n\nas measured, um: M = max |d| {} at {}, A = max - min {}, rms {}\n",
        printable(&study.name),
        study.budget.items.len(),
        study.points.commands.len(),
        study.points.what,
        um(m.largest_mm),
        place(study, m.largest_at),
        um(m.spread_mm()),
        um(m.rms_mm),
    )
}

fn items(study: &Study, out: &mut String) {
    let measured = &study.budget.measured;
    let _ = writeln!(
        out,
        "\n{:<20} {:>9} {:<20} {:>9}  {:>10} {:>10} {:>10} {:>10} {:>10}  of rms",
        "deviation, um", "size", "", "M alone", "M without", "it brings", "dM/de", "dA/de", "drms/de"
    );
    for item in &study.budget.items {
        let (name, size, unit) = study.deviation(item.deviation);
        let share = if measured.rms_mm > 0.0 { item.rms_slope_mm / measured.rms_mm } else { 0.0 };
        let _ = writeln!(
            out,
            "  {name:<18} {:>9} {unit:<20} {:>9}  {:>10} {:>10} {:>10} {:>10} {:>10} {:>5} %",
            fixed(size, 2),
            um(item.alone.largest_mm),
            um(item.without.largest_mm),
            um(measured.largest_mm - item.without.largest_mm),
            slope(item.largest_slope_mm),
            slope(item.spread_slope_mm),
            um(item.rms_slope_mm),
            fixed(share * 100.0, 1),
        );
    }
    let _ = writeln!(
        out,
        "  all dM/de together {} um: M, less what products of errors add (Euler)\n  the contributions added up miss the whole model by at most {} um, at {}",
        um(study.budget.sum_of_slopes_mm()),
        fixed(study.budget.remainder_mm * 1e3, 4),
        place(study, study.budget.remainder_at),
    );
}

/// One number, or left and right where they differ by what can be seen.
fn slope(slope: OneSided) -> String {
    let (left, right) = (um(slope.left), um(slope.right));
    if left == right { right } else { format!("{left}|{right}") }
}

fn together(study: &Study, out: &mut String) {
    let _ = writeln!(
        out,
        "\n{:<45} {:>9} {:>12}  at\n  {:<43} {:>9} {:>12}  {}",
        "all together, um",
        "figure",
        "whole model",
        "as measured",
        um(study.budget.measured.largest_mm),
        um(study.budget.measured.largest_mm),
        place(study, study.budget.measured.largest_at)
    );
    let mut row = |name: &str, mm: f64, whole_mm: f64, at: usize| {
        let _ = writeln!(out, "  {name:<43} {:>9} {:>12}  {}", um(mm), um(whole_mm), place(study, at));
    };
    let mut both = |name: &str, combined: &Combined| {
        let Combined { worst, worst_whole_mm, squares_mm, squares_at, squares_whole_mm } = combined;
        row(&format!("worst case, {name}"), worst.mm, *worst_whole_mm, worst.at);
        row(&format!("root sum of squares, {name}"), *squares_mm, *squares_whole_mm, *squares_at);
    };
    both("signs free", &study.mirrored);
    both("sizes only", &study.within_sizes);
    out.push_str(
        "  signs free: every deviation as measured or mirrored; sizes only: every function anywhere within its size, up or down
  worst case: no choice of signs at any control point is above it
  root sum of squares: what machines with independent signs have in the mean of squares, no limit; where sizes are two standard
  deviations of normal laws, at least 95 % of machines stay below it at any one point
",
    );
}

fn mending(study: &Study, target: &Target, out: &mut String) {
    let wanted = round(target.mm * 1e3, 6);
    let _ = writeln!(out, "\ntarget: M at most {wanted} um{}", kept(study, target));
    match &target.mending {
        _ if target.met => {
            let measured = um(study.budget.measured.largest_mm);
            let _ =
                writeln!(out, "  met as measured: M is {measured} um; nothing needs mending on this machine");
        }
        Mending { steps: None, proven } => {
            let tried = if *proven { "" } else { "; not all lists were tried" };
            let _ =
                writeln!(out, "  out of reach on this machine: {}{tried}", MENDING_OUT_OF_REACH.english());
        }
        Mending { steps: Some(steps), proven } => {
            let why =
                if *proven { "no shorter list does" } else { "best first; not all shorter lists were tried" };
            let _ = writeln!(out, "  {:<57} {:>9}", format!("to mend, in this order ({why})"), "then M");
            for (step, (deviation, after_mm)) in steps.iter().enumerate() {
                let (name, size, unit) = study.deviation(*deviation);
                let size = fixed(size, 2);
                let after = um(*after_mm);
                let _ = writeln!(out, "  {:>3}. {name:<18} {size:>9} {unit:<17} to 0 {after:>9}", step + 1);
            }
        }
    }
}

fn kept(study: &Study, target: &Target) -> String {
    let names = target.keep.iter().enumerate().filter(|(_, keep)| **keep);
    let names: Vec<&str> = names.map(|(index, _)| study.deviation(index).0).collect();
    if names.is_empty() { String::new() } else { format!("; as they are: {}", names.join(", ")) }
}

fn tolerances(study: &Study, target: &Target, out: &mut String) {
    let _ = writeln!(
        out,
        "\n{:<20} {:>9} {:>11} {:>12}",
        "tolerances, +-", "measured", "worst case", "statistical"
    );
    for item in &study.budget.items {
        let index = item.deviation;
        let (name, size, unit) = study.deviation(index);
        let cell = |set: &Option<Tolerances>| match set {
            _ if target.keep[index] => "as it is".to_owned(),
            None => "none".to_owned(),
            Some(set) => study.tolerance(set, index).map_or("any".to_owned(), |value| value.to_string()),
        };
        let [worst, statistical] = [&target.worst_case, &target.statistical].map(cell);
        let size = fixed(size, 2);
        let _ = writeln!(out, "  {name:<18} {size:>9} {worst:>11} {statistical:>12} {unit}");
    }
    let sets = [
        ("worst case", "together at most", &target.worst_case),
        ("statistical", "root sum of squares", &target.statistical),
    ];
    for (name, figure, set) in sets {
        let _ = match set {
            None => writeln!(out, "  {name}: none; what is kept leaves nothing for the others"),
            Some(set) => writeln!(
                out,
                "  {name}: {} um each alone; {figure} {} um, whole model {}, at {}; worst case {}",
                um(set.influence_mm),
                um(set.figure_mm),
                um(set.whole_model_mm),
                place(study, set.at),
                um(set.worst.mm)
            ),
        };
    }
}

/// A control point in words.
pub(super) fn place(study: &Study, at: usize) -> String {
    let command = &study.points.commands[at];
    let mut out = triple(&command.linear_mm, 3);
    for (letter, rad) in ['A', 'B', 'C'].iter().zip(command.rotary_rad.iter()) {
        if *rad != 0.0 {
            let _ = write!(out, " {letter}{}", fixed(rad.to_degrees(), 3));
        }
    }
    if command.direction != [0; 3] {
        let sign = |way: i8| ["-", "0", "+"][(way.signum() + 1) as usize];
        let _ = write!(out, " from {}", command.direction.map(sign).concat());
    }
    out
}
