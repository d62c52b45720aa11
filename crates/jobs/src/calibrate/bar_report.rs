//! What `calibrate ballbar` prints.

use calibration::circular_test::CircularTest;
use calibration::linear_ballbar::{CircleCalibration, Term};
use calibration::rotary_ballbar::{RotaryCalibration, Test};
use calibration::rotary_sequence::{Sequence, approximation_mm, sequence};
use diagnostic::{Text, both};
use machine_model::{Axis, Component, Description, Vector};
use measurement_files::micro;

use super::sources::line;

/// The pairs of axes of the planes XY, ZX, YZ.
pub(super) const SCALES: [&str; 3] = ["X-Y", "Z-X", "Y-Z"];

/// Where an A that carries C crosses it; `None` for other tables, for which no sequence was published.
fn crossing(description: &Description) -> Option<Vector> {
    let [a, _, c] = &description.rotary;
    let crosses = (a.centre_mm.y - c.centre_mm.y).abs() < 1e-6;
    (description.chain.table() == [Axis::C, Axis::A] && crosses)
        .then(|| Vector::new(c.centre_mm.x, a.centre_mm.y, a.centre_mm.z))
}

pub(super) fn rotary_report(found: &RotaryCalibration, tests: &[Test], description: &Description) -> Text {
    let crossing = crossing(description);
    let published: Option<Sequence> = crossing.and_then(|at| sequence(tests, &at));
    let mut axes: Vec<String> = found.locations.iter().map(|f| f.location.axis.to_string()).collect();
    axes.dedup();
    let [axes, russian_axes] = [" and ", " и "].map(|and| axes.join(and));
    let (readings, left_um) = (found.estimate.residuals.len(), found.estimate.sigma * 1e3);
    let mut out = Text::new(
        format!(
            "location errors of {axes}, {readings} readings, {left_um:.3} um left (standard deviation)\n"
        ),
        format!(
            "погрешности положения {russian_axes}, отсчётов {readings}, остаток {left_um:.3} мкм (стандартное отклонение)\n"
        ),
    );
    let based = found.locations.iter().any(|f| f.base != 0.0);
    let head = |shown: bool, text: Text| if shown { text } else { Text::EMPTY };
    out.push(&both!(
        "          joint fit        95 %{}{}\n",
        "          уравнив.         95 %{:#}{:#}\n",
        head(published.is_some(), Text::pair("   in sequence", "   по очереди ")),
        head(based, Text::pair("        base", "       исх. "))
    ));
    let columns = |value: f64, half: f64, by: Option<f64>, base: Text| {
        let by = by.map_or_else(String::new, |by| format!(" {by:>10.3}"));
        format!("{value:>10.3} ± {half:>8.3}{by}{}", if based { base } else { Text::EMPTY })
    };
    for (k, f) in found.locations.iter().enumerate() {
        let (scale, unit) = micro(f.location.component);
        let by = published.as_ref().map(|by| by.piges[k] * scale);
        let base = Text::same(format!(" {:>11.3}", f.base * scale));
        let row = columns(f.value * scale, f.half_width_95 * scale, by, base);
        out.push(&line(format_args!("  {}  {row}", f.location.name()), &unit));
    }
    for (k, name) in ["eX", "eY"].into_iter().enumerate() {
        let by = published.as_ref().map(|by| by.cup_mm[k] * 1e3);
        let (value, half) = (found.cup_mm[k] * 1e3, found.cup_half_width_95_mm[k] * 1e3);
        let row = columns(value, half, by, Text::same("            "));
        out.push(&both!(
            "  {name}    {row} um (tool ball against the spindle axis)\n",
            "  {name}    {row} мкм (шарик инструмента относительно оси шпинделя)\n"
        ));
    }
    if let Some(off) = crossing.and_then(|at| approximation_mm(tests, &at, found)) {
        out.push(&both!(
            "  the first-order formulas of the sequence leave the exact chain by up to {:.3} um\n",
            "  формулы первого порядка для этой очерёдности отходят от точной цепи до {:.3} мкм\n",
            off * 1e3
        ));
    }
    out
}

/// Table 4 of Zhang 2024: location errors before and after the compensation of the four positions.
pub(super) fn before_and_after(before: &RotaryCalibration, after: &RotaryCalibration) -> Text {
    let mut out = Text::pair("\n            before      after\n", "\n                до      после\n");
    let mut largest = [0.0_f64; 2];
    for f in &before.locations {
        let Some(g) = after.locations.iter().find(|g| g.location == f.location) else { continue };
        let (scale, unit) = micro(f.location.component);
        let row = format!("  {}  {:>9.2}  {:>9.2}", f.location.name(), f.value * scale, g.value * scale);
        out.push(&line(row, &unit));
        if f.location.component == Component::Linear {
            largest[0] = largest[0].max(f.value.abs() * scale);
            largest[1] = largest[1].max(g.value.abs() * scale);
        }
    }
    let [before, after] = largest;
    out.push(&both!(
        "  largest position error {before:.1} -> {after:.1} um\n",
        "  наибольшая линейная погрешность {before:.1} -> {after:.1} мкм\n"
    ));
    out
}

/// Why circles that were read both ways round have no figures of both.
pub(super) static CENTRED_APART: Text = Text::pair(
    "Both directions were read in runs of their own, each with its own centre and length of the bar: G(b) and H of ISO 230-4 need both about one centre; where nothing was moved between them, give both one run number",
    "Стороны сняты в разных проходах, у каждого свой центр и своя длина измерителя: G(b) и H по ISO 230-4 требуют обе стороны около одного центра; если между ними ничего не двигали, дайте обеим один номер прохода",
);

pub(super) fn circle_report(found: &CircleCalibration) -> Text {
    let (readings, left_um) = (found.estimate.residuals.len(), found.estimate.sigma * 1e3);
    let mut out = both!(
        "circles, {readings} readings, {left_um:.3} um left (standard deviation)\n",
        "окружности, отсчётов {readings}, остаток {left_um:.3} мкм (стандартное отклонение)\n"
    );
    let term = |name: Text, t: Term, (scale, unit): (f64, Text), behind: Text| {
        let (value, half) = (t.value * scale, t.half_width_95 * scale);
        both!(
            "  {name:<12}{value:>9.2} ± {half:.2} {unit}{behind}\n",
            "  {name:<#12}{value:>9.2} ± {half:.2} {unit:#}{behind:#}\n"
        )
    };
    let base = |value: f64| match value {
        0.0 => Text::EMPTY,
        value => both!(" (base {value:.2})", " (исходный {value:.2})"),
    };
    let ratio = || (1e6, both!("um/m", "мкм/м"));
    for (name, found) in ["EC0Y", "EB0Z", "EA0Z"].into_iter().zip(found.squareness_rad) {
        if let Some(t) = found {
            out.push(&term(Text::same(name), t, micro(Component::Angular), base(t.base * 1e6)));
        }
    }
    for (name, found) in SCALES.into_iter().zip(found.mismatch) {
        if let Some(t) = found {
            let why = both!(
                " (one axis against the other: a bar sees no common scale)",
                " (одна ось относительно другой: общего масштаба измеритель не видит)"
            );
            out.push(&term(both!("scale {name}", "масшт. {name}"), t, ratio(), why));
        }
    }
    if let Some(sum) = found.closure {
        let why = both!(" (the three must add up to 0)", " (три вместе должны дать 0)");
        out.push(&term(both!("closure", "сумма"), sum, ratio(), why));
    }
    for (axis, found) in Axis::ALL.iter().zip(found.backlash_mm) {
        out.push(&match found {
            Some(t) => {
                term(both!("backlash {axis}", "люфт {axis}"), t, micro(Component::Linear), base(t.base * 1e3))
            }
            None => both!(
                "  backlash {axis}  not seen: no reading says the direction of {axis} both ways\n",
                "  люфт {axis}      не виден: нет отсчётов с направлением {axis} в обе стороны\n"
            ),
        });
    }
    if found.tests.iter().any(CircularTest::is_centred_apart) {
        out.push(&both!("  {CENTRED_APART}\n", "  {CENTRED_APART:#}\n"));
    }
    out
}
