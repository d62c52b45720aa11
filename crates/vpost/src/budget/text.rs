//! What is printed.

use std::fmt::Write;

use diagnostic::{Language, Text, say};
use error_budget::OneSided;
use error_budget::mending::Mending;
use error_budget::tolerances::Tolerances;

use super::study::{Combined, MENDING_OUT_OF_REACH, Study, Target};
use crate::figures::{fixed, printable, round, triple, um};

/// The page.
pub(super) fn page(study: &Study, language: Language) -> String {
    let mut out = head(study, language);
    for sentence in study.from_zero.said(study.machine.model()) {
        let _ = writeln!(out, "{}", sentence.in_language(language));
    }
    items(study, language, &mut out);
    together(study, language, &mut out);
    if let Some(target) = &study.target {
        mending(study, target, language, &mut out);
        tolerances(study, target, language, &mut out);
    }
    out
}

fn head(study: &Study, language: Language) -> String {
    let m = &study.budget.measured;
    say!(
        language,
        "{}: {} deviations at {} control points, {}\n\nas measured, um: M = max |d| {} at {}, A = max - min {}, rms {}\n",
        "{}: отклонений {}, контрольных точек {}, {}\n\nкак измерено, мкм: M = max |d| {} в {}, A = max - min {}, СКЗ {}\n",
        printable(&study.name),
        study.budget.items.len(),
        study.points.commands.len(),
        study.points.what.in_language(language),
        um(m.largest_mm),
        place(study, m.largest_at, language),
        um(m.spread_mm()),
        um(m.rms_mm),
    )
}

fn items(study: &Study, language: Language, out: &mut String) {
    let measured = &study.budget.measured;
    let heading = match language {
        Language::English => [
            "deviation, um",
            "size",
            "",
            "M alone",
            "M without",
            "it brings",
            "dM/de",
            "dA/de",
            "drms/de",
            "of rms",
        ],
        Language::Russian => [
            "отклонение, мкм",
            "величина",
            "",
            "одно M",
            "M без него",
            "даёт",
            "dM/de",
            "dA/de",
            "dСКЗ/de",
            "от СКЗ",
        ],
    };
    let [name, size, unit, alone, without, brings, m, a, rms, share] = heading;
    let _ = writeln!(
        out,
        "\n{name:<20} {size:>9} {unit:<20} {alone:>9}  {without:>10} {brings:>10} {m:>10} {a:>10} {rms:>10}  {share}"
    );
    for item in &study.budget.items {
        let (name, size, unit) = study.deviation(item.deviation);
        let unit = unit.in_language(language);
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
    let sum = say!(
        language,
        "  all dM/de together {} um: M, less what products of errors add (Euler)\n  the contributions added up miss the whole model by at most {} um, at {}",
        "  все dM/de вместе {} мкм: это M без того, что добавляют произведения погрешностей (Эйлер)\n  сумма вкладов расходится с полной моделью не больше чем на {} мкм, в {}",
        um(study.budget.sum_of_slopes_mm()),
        fixed(study.budget.remainder_mm * 1e3, 4),
        place(study, study.budget.remainder_at, language),
    );
    let _ = writeln!(out, "{sum}");
}

/// One number, or left and right where they differ by what can be seen.
fn slope(slope: OneSided) -> String {
    let (left, right) = (um(slope.left), um(slope.right));
    if left == right { right } else { format!("{left}|{right}") }
}

fn together(study: &Study, language: Language, out: &mut String) {
    let at = say!(language, "at", "в");
    let _ = writeln!(
        out,
        "\n{:<45} {:>9} {:>12}  {at}\n  {:<43} {:>9} {:>12}  {}",
        say!(language, "all together, um", "всё вместе, мкм"),
        say!(language, "figure", "величина"),
        say!(language, "whole model", "вся модель"),
        say!(language, "as measured", "как измерено"),
        um(study.budget.measured.largest_mm),
        um(study.budget.measured.largest_mm),
        place(study, study.budget.measured.largest_at, language)
    );
    let mut row = |name: &str, mm: f64, whole_mm: f64, at: usize| {
        let _ =
            writeln!(out, "  {name:<43} {:>9} {:>12}  {}", um(mm), um(whole_mm), place(study, at, language));
    };
    let mut both = |name: &Text, combined: &Combined| {
        let Combined { worst, worst_whole_mm, squares_mm, squares_at, squares_whole_mm } = combined;
        let worst_case = say!(language, "worst case, {name}", "худший случай, {name:#}");
        row(&worst_case, worst.mm, *worst_whole_mm, worst.at);
        let squares = say!(language, "root sum of squares, {name}", "корень из суммы квадратов, {name:#}");
        row(&squares, *squares_mm, *squares_whole_mm, *squares_at);
    };
    both(&Text::pair("signs free", "знаки любые"), &study.mirrored);
    both(&Text::pair("sizes only", "только величины"), &study.within_sizes);
    let explained = Text::pair(
        "  signs free: every deviation as measured or mirrored; sizes only: every function anywhere within its size, up or down
  worst case: no choice of signs at any control point is above it
  root sum of squares: what machines with independent signs have in the mean of squares, no limit; where sizes are two standard
  deviations of normal laws, at least 95 % of machines stay below it at any one point
",
        "  знаки любые: каждое отклонение как измерено или зеркально; только величины: каждая функция где угодно в пределах своей величины, вверх или вниз
  худший случай: никакой выбор знаков ни в одной контрольной точке его не превышает
  корень из суммы квадратов: среднее квадратическое по станкам с независимыми знаками, не предел; если величины — это два стандартных
  отклонения нормальных законов, то в любой отдельной точке его не превышают не меньше 95 % станков
",
    );
    out.push_str(explained.in_language(language));
}

fn mending(study: &Study, target: &Target, language: Language, out: &mut String) {
    let wanted = round(target.mm * 1e3, 6);
    let kept = kept(study, target, language);
    let heading =
        say!(language, "target: M at most {wanted} um{kept}", "цель: M не больше {wanted} мкм{kept}");
    let _ = writeln!(out, "\n{heading}");
    match &target.mending {
        _ if target.met => {
            let measured = um(study.budget.measured.largest_mm);
            let met = say!(
                language,
                "met as measured: M is {measured} um; nothing needs mending on this machine",
                "достигнута как есть: M равно {measured} мкм; исправлять на этом станке нечего"
            );
            let _ = writeln!(out, "  {met}");
        }
        Mending { steps: None, proven } => {
            let tried = if *proven {
                Text::EMPTY
            } else {
                Text::pair("; not all lists were tried", "; перебраны не все списки")
            };
            let why = &MENDING_OUT_OF_REACH;
            let out_of_reach = say!(
                language,
                "out of reach on this machine: {why}{tried}",
                "на этом станке недостижима: {why:#}{tried:#}"
            );
            let _ = writeln!(out, "  {out_of_reach}");
        }
        Mending { steps: Some(steps), proven } => {
            let why = if *proven {
                Text::pair("no shorter list does", "короче список не получится")
            } else {
                Text::pair(
                    "best first; not all shorter lists were tried",
                    "сначала лучшее; более короткие перебраны не все",
                )
            };
            let heading =
                say!(language, "to mend, in this order ({why})", "исправить в таком порядке ({why:#})");
            let _ = writeln!(out, "  {heading:<57} {:>9}", say!(language, "then M", "тогда M"));
            for (step, (deviation, after_mm)) in steps.iter().enumerate() {
                let (name, size, unit) = study.deviation(*deviation);
                let (size, unit, after) = (fixed(size, 2), unit.in_language(language), um(*after_mm));
                let to = say!(language, "to 0", "до 0");
                let _ = writeln!(out, "  {:>3}. {name:<18} {size:>9} {unit:<17} {to} {after:>9}", step + 1);
            }
        }
    }
}

fn kept(study: &Study, target: &Target, language: Language) -> String {
    let names = target.keep.iter().enumerate().filter(|(_, keep)| **keep);
    let names: Vec<&str> = names.map(|(index, _)| study.deviation(index).0).collect();
    if names.is_empty() {
        return String::new();
    }
    say!(language, "; as they are: {}", "; без изменений: {}", names.join(", "))
}

fn tolerances(study: &Study, target: &Target, language: Language, out: &mut String) {
    let _ = writeln!(
        out,
        "\n{:<20} {:>9} {:>11} {:>12}",
        say!(language, "tolerances, +-", "допуски, +-"),
        say!(language, "measured", "измерено"),
        say!(language, "worst case", "худш. случ."),
        say!(language, "statistical", "статистич.")
    );
    for item in &study.budget.items {
        let index = item.deviation;
        let (name, size, unit) = study.deviation(index);
        let unit = unit.in_language(language);
        let cell = |set: &Option<Tolerances>| match set {
            _ if target.keep[index] => say!(language, "as it is", "как есть"),
            None => say!(language, "none", "нет"),
            Some(set) => study
                .tolerance(set, index)
                .map_or_else(|| say!(language, "any", "любой"), |value| value.to_string()),
        };
        let [worst, statistical] = [&target.worst_case, &target.statistical].map(cell);
        let size = fixed(size, 2);
        let _ = writeln!(out, "  {name:<18} {size:>9} {worst:>11} {statistical:>12} {unit}");
    }
    let sets = [
        (
            Text::pair("worst case", "худший случай"),
            Text::pair("together at most", "вместе не больше"),
            &target.worst_case,
        ),
        (
            Text::pair("statistical", "статистически"),
            Text::pair("root sum of squares", "корень из суммы квадратов"),
            &target.statistical,
        ),
    ];
    for (name, figure, set) in sets {
        let line = match set {
            None => say!(
                language,
                "{name}: none; what is kept leaves nothing for the others",
                "{name:#}: нет; оставленное без изменений ничего не оставляет остальным"
            ),
            Some(set) => say!(
                language,
                "{name}: {} um each alone; {figure} {} um, whole model {}, at {}; worst case {}",
                "{name:#}: по {} мкм каждое; {figure:#} {} мкм, вся модель {}, в {}; худший случай {}",
                um(set.influence_mm),
                um(set.figure_mm),
                um(set.whole_model_mm),
                place(study, set.at, language),
                um(set.worst.mm)
            ),
        };
        let _ = writeln!(out, "  {line}");
    }
}

/// A control point in words.
pub(super) fn place(study: &Study, at: usize, language: Language) -> String {
    let command = &study.points.commands[at];
    let mut out = triple(&command.linear_mm, 3);
    for (letter, rad) in ['A', 'B', 'C'].iter().zip(command.rotary_rad.iter()) {
        if *rad != 0.0 {
            let _ = write!(out, " {letter}{}", fixed(rad.to_degrees(), 3));
        }
    }
    if command.direction != [0; 3] {
        let sign = |way: i8| ["-", "0", "+"][(way.signum() + 1) as usize];
        let from = command.direction.map(sign).concat();
        out.push_str(&say!(language, " from {from}", " с подходом {from}"));
    }
    out
}
