//! A budget as text for people.

use std::fmt::Write;

use diagnostic::{Text, both};
use error_budget::OneSided;
use error_budget::mending::Mending;
use error_budget::tolerances::Tolerances;

use crate::budget::study::{Combined, MENDING_OUT_OF_REACH, Study, Target};
use crate::figures::{fixed, printable, round, triple, um};

/// The whole text.
#[must_use]
pub fn page(study: &Study) -> Text {
    let mut out = head(study);
    for sentence in study.from_zero.said(study.machine.model()) {
        out.push(&both!("{sentence}\n", "{sentence:#}\n"));
    }
    items(study, &mut out);
    together(study, &mut out);
    if let Some(target) = &study.target {
        mending(study, target, &mut out);
        tolerances(study, target, &mut out);
    }
    out
}

fn head(study: &Study) -> Text {
    let m = &study.budget.measured;
    let (name, deviations) = (printable(&study.name), study.budget.items.len());
    let (points, what) = (study.points.commands.len(), &study.points.what);
    let (at, [largest, spread, rms]) =
        (place(study, m.largest_at), [m.largest_mm, m.spread_mm(), m.rms_mm].map(um));
    both!(
        "{name}: {deviations} deviations at {points} control points, {what}\n\nas measured, um: M = max |d| {largest} at {at}, A = max - min {spread}, rms {rms}\n",
        "{name}: отклонений {deviations}, контрольных точек {points}, {what:#}\n\nкак измерено, мкм: M = max |d| {largest} в {at:#}, A = max - min {spread}, СКЗ {rms}\n"
    )
}

fn items(study: &Study, out: &mut Text) {
    let measured = &study.budget.measured;
    out.push(&both!(
        "\ndeviation, um             size                        M alone   M without  it brings      dM/de      dA/de    drms/de  of rms\n",
        "\nотклонение, мкм       величина                         одно M  M без него       даёт      dM/de      dA/de    dСКЗ/de  от СКЗ\n"
    ));
    for item in &study.budget.items {
        let (name, size, unit) = study.deviation(item.deviation);
        let share = if measured.rms_mm > 0.0 { item.rms_slope_mm / measured.rms_mm } else { 0.0 };
        let [alone, without] = [&item.alone, &item.without].map(|found| um(found.largest_mm));
        let brings = um(measured.largest_mm - item.without.largest_mm);
        let [m, a] = [item.largest_slope_mm, item.spread_slope_mm].map(slope);
        let (size, rms, share) = (fixed(size, 2), um(item.rms_slope_mm), fixed(share * 100.0, 1));
        let row = format!("{alone:>9}  {without:>10} {brings:>10} {m:>10} {a:>10} {rms:>10} {share:>5} %");
        out.push(&both!(
            "  {name:<18} {size:>9} {unit:<20} {row}\n",
            "  {name:<18} {size:>9} {unit:<#20} {row}\n"
        ));
    }
    let (sum, at) = (um(study.budget.sum_of_slopes_mm()), place(study, study.budget.remainder_at));
    let remainder = fixed(study.budget.remainder_mm * 1e3, 4);
    out.push(&both!(
        "  all dM/de together {sum} um: M, less what products of errors add (Euler)\n  the contributions added up miss the whole model by at most {remainder} um, at {at}\n",
        "  все dM/de вместе {sum} мкм: это M без того, что добавляют произведения погрешностей (Эйлер)\n  сумма вкладов расходится с полной моделью не больше чем на {remainder} мкм, в {at:#}\n"
    ));
}

/// One number, or left and right where they differ by what can be seen.
fn slope(slope: OneSided) -> String {
    let (left, right) = (um(slope.left), um(slope.right));
    if left == right { right } else { format!("{left}|{right}") }
}

fn together(study: &Study, out: &mut Text) {
    out.push(&Text::same("\n"));
    let mut row = |name: &Text, figure: &Text, whole: &Text, at: &Text, indent: usize| {
        let width = 45 - indent;
        out.push(&both!(
            "{:indent$}{name:<width$} {figure:>9} {whole:>12}  {at}\n",
            "{:indent$}{name:<#width$} {figure:>#9} {whole:>#12}  {at:#}\n",
            ""
        ));
    };
    row(
        &both!("all together, um", "всё вместе, мкм"),
        &both!("figure", "величина"),
        &both!("whole model", "вся модель"),
        &both!("at", "в"),
        0,
    );
    let mut numbers = |name: &Text, mm: f64, whole_mm: f64, at: usize| {
        row(name, &Text::same(um(mm)), &Text::same(um(whole_mm)), &place(study, at), 2);
    };
    let m = &study.budget.measured;
    numbers(&both!("as measured", "как измерено"), m.largest_mm, m.largest_mm, m.largest_at);
    let signs = [
        (both!("signs free", "знаки любые"), &study.mirrored),
        (both!("sizes only", "только величины"), &study.within_sizes),
    ];
    for (name, Combined { worst, worst_whole_mm, squares_mm, squares_at, squares_whole_mm }) in signs {
        let worst_case = both!("worst case, {name}", "худший случай, {name:#}");
        numbers(&worst_case, worst.mm, *worst_whole_mm, worst.at);
        let squares = both!("root sum of squares, {name}", "корень из суммы квадратов, {name:#}");
        numbers(&squares, *squares_mm, *squares_whole_mm, *squares_at);
    }
    out.push(&Text::pair(
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
    ));
}

fn mending(study: &Study, target: &Target, out: &mut Text) {
    let (wanted, kept) = (round(target.mm * 1e3, 6), kept(study, target));
    out.push(&both!("\ntarget: M at most {wanted} um{kept}\n", "\nцель: M не больше {wanted} мкм{kept:#}\n"));
    match &target.mending {
        _ if target.met => out.push(&both!(
            "  met as measured: M is {} um; nothing needs mending on this machine\n",
            "  достигнута как есть: M равно {} мкм; исправлять на этом станке нечего\n",
            um(study.budget.measured.largest_mm)
        )),
        Mending { steps: None, proven } => {
            let tried = match proven {
                true => Text::EMPTY,
                false => both!("; not all lists were tried", "; перебраны не все списки"),
            };
            let why = &MENDING_OUT_OF_REACH;
            out.push(&both!(
                "  out of reach on this machine: {why}{tried}\n",
                "  на этом станке недостижима: {why:#}{tried:#}\n"
            ));
        }
        Mending { steps: Some(steps), proven } => {
            let why = match proven {
                true => both!("no shorter list does", "короче список не получится"),
                false => both!(
                    "best first; not all shorter lists were tried",
                    "сначала лучшее; более короткие перебраны не все"
                ),
            };
            let heading = both!("to mend, in this order ({why})", "исправить в таком порядке ({why:#})");
            let then = both!("then M", "тогда M");
            out.push(&both!("  {heading:<57} {then:>9}\n", "  {heading:<#57} {then:>#9}\n"));
            for (step, (deviation, after_mm)) in (1..).zip(steps) {
                let (name, size, unit) = study.deviation(*deviation);
                let (size, after) = (fixed(size, 2), um(*after_mm));
                out.push(&both!(
                    "  {step:>3}. {name:<18} {size:>9} {unit:<17} to 0 {after:>9}\n",
                    "  {step:>3}. {name:<18} {size:>9} {unit:<#17} до 0 {after:>9}\n"
                ));
            }
        }
    }
}

fn kept(study: &Study, target: &Target) -> Text {
    let names = target.keep.iter().enumerate().filter(|(_, keep)| **keep);
    let names: Vec<&str> = names.map(|(index, _)| study.deviation(index).0).collect();
    match names.as_slice() {
        [] => Text::EMPTY,
        names => both!("; as they are: {}", "; без изменений: {}", names.join(", ")),
    }
}

fn tolerances(study: &Study, target: &Target, out: &mut Text) {
    out.push(&both!(
        "\ntolerances, +-        measured  worst case  statistical\n",
        "\nдопуски, +-           измерено худш. случ.   статистич.\n"
    ));
    for item in &study.budget.items {
        let index = item.deviation;
        let (name, size, unit) = study.deviation(index);
        let cell = |set: &Option<Tolerances>| match set {
            _ if target.keep[index] => both!("as it is", "как есть"),
            None => both!("none", "нет"),
            Some(set) => study
                .tolerance(set, index)
                .map_or_else(|| both!("any", "любой"), |value| Text::same(value.to_string())),
        };
        let [worst, statistical] = [&target.worst_case, &target.statistical].map(cell);
        let size = fixed(size, 2);
        out.push(&both!(
            "  {name:<18} {size:>9} {worst:>11} {statistical:>12} {unit}\n",
            "  {name:<18} {size:>9} {worst:>#11} {statistical:>#12} {unit:#}\n"
        ));
    }
    let sets = [
        (
            both!("worst case", "худший случай"),
            both!("together at most", "вместе не больше"),
            &target.worst_case,
        ),
        (
            both!("statistical", "статистически"),
            both!("root sum of squares", "корень из суммы квадратов"),
            &target.statistical,
        ),
    ];
    for (name, figure, set) in sets {
        let Some(set) = set else {
            out.push(&both!(
                "  {name}: none; what is kept leaves nothing for the others\n",
                "  {name:#}: нет; оставленное без изменений ничего не оставляет остальным\n"
            ));
            continue;
        };
        let at = place(study, set.at);
        let [each, sum, whole, worst] =
            [set.influence_mm, set.figure_mm, set.whole_model_mm, set.worst.mm].map(um);
        out.push(&both!(
            "  {name}: {each} um each alone; {figure} {sum} um, whole model {whole}, at {at}; worst case {worst}\n",
            "  {name:#}: по {each} мкм каждое; {figure:#} {sum} мкм, вся модель {whole}, в {at:#}; худший случай {worst}\n"
        ));
    }
}

/// A control point in words.
fn place(study: &Study, at: usize) -> Text {
    let command = &study.points.commands[at];
    let mut place = triple(&command.linear_mm, 3);
    for (letter, rad) in ['A', 'B', 'C'].iter().zip(command.rotary_rad.iter()) {
        if *rad != 0.0 {
            let _ = write!(place, " {letter}{}", fixed(rad.to_degrees(), 3));
        }
    }
    if command.direction == [0; 3] {
        return Text::same(place);
    }
    let sign = |way: i8| ["-", "0", "+"][(way.signum() + 1) as usize];
    let from = command.direction.map(sign).concat();
    both!("{place} from {from}", "{place} с подходом {from}")
}
