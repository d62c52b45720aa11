//! What `calibrate rtest` prints, and its JSON.

use calibration::rtest::{
    Basis, FoundTerm, HeldOut, ON_AXIS_MM, RotaryTables, Term, TurnedAxis, WrittenTable,
};
use diagnostic::{Text, both};
use machine_model::Component;
use measurement_files::micro;
use serde_json::{Value, json};

use crate::figures::short;

use super::super::sources::{line, span};
use super::rows::Rows;

const FUNCTIONS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

fn degree(own: &TurnedAxis, groups: usize) -> Text {
    let per_turn = groups.saturating_sub(1);
    match own.basis {
        _ if groups == 0 => Text::pair("none", "нет"),
        _ if groups == 1 => Text::pair("the mean alone", "только среднее"),
        Basis::Turn => both!("{per_turn} a turn", "{per_turn} на оборот"),
        Basis::Arc(_) if groups <= 2 => both!("{per_turn} a turn", "{per_turn} на оборот"),
        Basis::Arc(_) => both!("degree {groups}", "степень {groups}"),
    }
}

fn axis_line(own: &TurnedAxis) -> Text {
    let [low, high] = own.range_rad.map(|rad| short(rad.to_degrees(), 4));
    let hides = if own.arm_mm < ON_AXIS_MM {
        Text::pair("on the axis, which hides how it leans; ", "на самой оси, что скрывает её наклон; ")
    } else {
        Text::EMPTY
    };
    let (used, allowed) = (degree(own, own.groups), degree(own, own.most_groups));
    let more = if own.groups < own.most_groups {
        both!("{allowed} allowed by the angles", "углы допускают: {allowed:#}")
    } else {
        Text::pair(
            "all that the angles allow: more of them might show finer ones",
            "всё, что допускают углы: с большим их числом видны были бы и более тонкие",
        )
    };
    let (axis, angles, arm_mm) = (own.axis, own.angles, own.arm_mm);
    both!(
        "axis {axis}: {angles} angles from {low} to {high} degrees, balls up to {arm_mm:.0} mm from it; {hides}error functions to {used} ({more})\n",
        "ось {axis}: углов {angles}, от {low} до {high} градусов, шары до {arm_mm:.0} мм от неё; {hides:#}функции погрешностей: {used:#} ({more:#})\n"
    )
}

pub(super) fn text(found: &RotaryTables, held: Option<&HeldOut>, rows: &Rows) -> Text {
    let mut out = both!(
        "{} rows in {} runs; noise {:.3} um",
        "строк {} в сериях {}; шум {:.3} мкм",
        rows.read.rows.len(),
        rows.runs.len(),
        found.estimate.sigma * 1e3
    );
    if let Some(free) = found.estimate.degrees_of_freedom {
        out.push(&both!(" with {free} degrees of freedom", " при {free} степенях свободы"));
    }
    if let Some((mm, free)) = found.repeats_mm {
        let um = mm * 1e3;
        out.push(&both!(
            "; repeats within a run {um:.3} um with {free}",
            "; повторы внутри серии {um:.3} мкм при {free}"
        ));
    }
    out.push(&Text::pair("\n", "\n"));
    for own in &found.axes {
        out.push(&axis_line(own));
    }
    for axis in &found.still {
        out.push(&both!(
            "axis {axis}: turns in no run, and stays as in the profile\n",
            "ось {axis}: не поворачивается ни в одной серии и остаётся как в профиле\n"
        ));
    }
    out.push(&Text::pair(
        "location errors     found        95 %     profile\n",
        "погрешн. положения  найдено      95 %     профиль\n",
    ));
    for term in &found.terms {
        out.push(&term_line(term));
    }
    for table in &found.tables {
        out.push(&functions(table));
    }
    out.push(&open(found));
    out.push(&Text::pair(
        "gauge  what turns with the workpiece is its mounting; means and once-per-turn parts are location errors where both look alike\n",
        "отсчёт что поворачивается вместе с деталью — её закрепление; средние и составляющие раз за оборот — погрешности положения, если их не различить\n",
    ));
    out.push(&left(found, held));
    out
}

/// What the rows do not tell.
fn open(found: &RotaryTables) -> Text {
    let mut out = Text::EMPTY;
    for set in &found.not_told_apart {
        let set = set.join(", ");
        out.push(&both!(
            "not told apart by these rows, not written: {set}\n",
            "по этим строкам не различить, не записано: {set}\n"
        ));
    }
    if !found.unseen.is_empty() {
        let unseen = found.unseen.join(", ");
        out.push(&both!(
            "not seen by these rows, not written: {unseen}\n",
            "по этим строкам не видно, не записано: {unseen}\n"
        ));
    }
    for (part, owners) in &found.counted_as {
        let owners = owners.join(", ");
        out.push(&both!(
            "counted as {owners}, not told from it by these rows: {part}\n",
            "отнесено к {owners}, по этим строкам не отличить: {part}\n"
        ));
    }
    if found.other_rows_tell {
        out.push(&Text::pair(
            "  a ball at three places not in one line, at two heights, tells them apart\n",
            "  их различит шар в трёх точках не на одной прямой, на двух высотах\n",
        ));
    }
    out
}

/// What is left of the rows, and how well the field is known.
fn left(found: &RotaryTables, held: Option<&HeldOut>) -> Text {
    let [before, after] = found.rms_mm.map(|mm| mm * 1e3);
    let mut out = both!(
        "fitted {before:.3} -> {after:.3} um RMS ({} readings)\n",
        "подгонка: СКЗ {before:.3} -> {after:.3} мкм (отсчётов {})\n",
        found.estimate.residuals.len()
    );
    if let Some(HeldOut { readings, rms_before_mm, rms_after_mm, max_after_mm, .. }) = held {
        let [before, after, most] = [rms_before_mm, rms_after_mm, max_after_mm].map(|mm| mm * 1e3);
        out.push(&both!(
            "held out {before:.3} -> {after:.3} um RMS, at most {most:.3} um ({readings} readings, each run about its own offset)\n",
            "контрольные: СКЗ {before:.3} -> {after:.3} мкм, не больше {most:.3} мкм (отсчётов {readings}, каждая серия относительно своего смещения)\n"
        ));
    }
    let less = if found.not_told_apart.is_empty() {
        Text::EMPTY
    } else {
        Text::pair(", what is not written not counted", ", без учёта незаписанного")
    };
    out.push(&both!(
        "field known to ±{:.2} um at 95 % of the places and angles, frames taken off{less}\n",
        "поле известно с точностью ±{:.2} мкм в 95 % мест и углов, без систем координат{less:#}\n",
        found.field_u95_mm * 1e3
    ));
    out
}

fn term_line(own: &FoundTerm) -> Text {
    let (scale, unit) = micro(own.term.component());
    let (name, value, base) = (own.term.name(), (own.base + own.change) * scale, own.base * scale);
    let half = own.half_width_95 * scale;
    match own.term {
        Term::Location(_) if own.is_written => {
            let row = format!("  {name}  {value:>15.3} ± {half:>8.3} {base:>11.3}");
            line(row, &unit)
        }
        Term::Location(_) => both!(
            "  {name}     not determined            {base:>11.3} {unit}, stays\n",
            "  {name}     не определено             {base:>11.3} {unit:#}, остаётся\n"
        ),
        Term::Reversal(_) => both!(
            "  {name}  {value:>9.3} ± {half:>8.3} {unit} about the axis itself, from above less from below: taken off, not written\n",
            "  {name}  {value:>9.3} ± {half:>8.3} {unit:#} вокруг самой оси, сверху минус снизу: вычтено, не записано\n"
        ),
        Term::Coefficient { .. } => Text::EMPTY,
    }
}

fn functions(table: &WrittenTable) -> Text {
    let (axis, nodes) = (table.axis, table.angles_deg.len());
    let [first, last] = [table.angles_deg[0], table.angles_deg[nodes - 1]].map(|deg| short(deg, 6));
    let (um, urad) = (table.between_nodes[0] * 1e3, table.between_nodes[1] * 1e6);
    let mut out = both!(
        "error functions of {axis}, written from {first} to {last} degrees at {nodes} nodes, {um:.3} um and {urad:.3} urad between them\n",
        "функции погрешностей {axis}, записаны от {first} до {last} градусов в узлах ({nodes}), между ними {um:.3} мкм и {urad:.3} мкрад\n"
    );
    for f in (0..6).filter(|f| table.changed[*f]) {
        let (scale, unit) = micro(Component::of(f));
        let (low, high) = span(table.rows.iter().map(|row| row[f] * scale));
        let half = table.half_widths_95.iter().map(|row| row[f] * scale).fold(0.0, f64::max);
        let row = format!("  E{}{}   {low:>9.3} … {high:>9.3} ± {half:.3}", FUNCTIONS[f], table.axis);
        out.push(&line(row, &unit));
    }
    out
}

pub(super) fn json(found: &RotaryTables, held: Option<&HeldOut>, rows: &Rows) -> Value {
    let axis = |own: &TurnedAxis| {
        json!({ "axis": own.axis.to_string(), "angles": own.angles, "from_deg": own.range_rad[0].to_degrees(),
                "to_deg": own.range_rad[1].to_degrees(), "arm_mm": own.arm_mm,
                "basis": match own.basis { Basis::Turn => "fourier", Basis::Arc(_) => "legendre" },
                "groups": own.groups, "groups_allowed": own.most_groups })
    };
    let freedom = found.estimate.degrees_of_freedom;
    let term = |own: &FoundTerm| {
        let (scale, unit) = micro(own.term.component());
        json!({ "name": own.term.name(), "unit": unit.english(), "value": (own.base + own.change) * scale, "base": own.base * scale,
                "u": own.standard_uncertainty * scale, "degrees_of_freedom": freedom, "u95": own.half_width_95 * scale,
                "written": own.is_written })
    };
    let scales: Vec<f64> = found.terms.iter().map(|own| micro(own.term.component()).0).collect();
    let first = found.estimate.values.len() - found.terms.len();
    let covariance: Vec<Vec<f64>> = (0..scales.len())
        .map(|i| {
            let entry = |k: usize| found.estimate.covariance[(first + i, first + k)] * scales[i] * scales[k];
            (0..scales.len()).map(entry).collect()
        })
        .collect();
    let table = |own: &WrittenTable| {
        let function = |f: usize| {
            let (scale, unit) = micro(Component::of(f));
            let of = |all: &[[f64; 6]]| -> Vec<f64> { all.iter().map(|row| row[f] * scale).collect() };
            json!({ "name": format!("E{}{}", FUNCTIONS[f], own.axis), "unit": unit.english(), "changed": own.changed[f],
                    "values": of(&own.rows), "u95": of(&own.half_widths_95) })
        };
        json!({ "axis": own.axis.to_string(), "angles_deg": own.angles_deg,
                "between_nodes_um": own.between_nodes[0] * 1e3, "between_nodes_urad": own.between_nodes[1] * 1e6,
                "functions": (0..6).filter(|f| own.given[*f]).map(function).collect::<Vec<_>>() })
    };
    let counted = |(part, owners): &(String, Vec<String>)| json!({ "part": part, "owners": owners });
    let offsets: serde_json::Map<String, Value> = rows
        .runs
        .iter()
        .zip(&found.offsets_mm)
        .map(|(run, mm)| (run.clone(), json!([mm.x * 1e3, mm.y * 1e3, mm.z * 1e3])))
        .collect();
    let mut out = json!({
        "schema": "vpost.rtest/1",
        "rows": rows.read.rows.len(),
        "readings": found.estimate.residuals.len(),
        "noise_um": found.estimate.sigma * 1e3,
        "degrees_of_freedom": freedom,
        "repeats_um": found.repeats_mm.map(|(mm, _)| mm * 1e3),
        "stated_um": found.stated_mm.map(|mm| mm * 1e3),
        "axes": found.axes.iter().map(axis).collect::<Vec<_>>(),
        "still": found.still.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "terms": found.terms.iter().map(term).collect::<Vec<_>>(),
        "covariance": covariance,
        "tables": found.tables.iter().map(table).collect::<Vec<_>>(),
        "not_told_apart": found.not_told_apart,
        "not_seen": found.unseen,
        "counted_as": found.counted_as.iter().map(counted).collect::<Vec<_>>(),
        "run_offsets_um": offsets,
        "rms_before_um": found.rms_mm[0] * 1e3,
        "rms_after_um": found.rms_mm[1] * 1e3,
        "field_u95_um": found.field_u95_mm * 1e3,
    });
    if let Some(judged) = held {
        out["holdout"] = json!({ "readings": judged.readings, "rms_before_um": judged.rms_before_mm * 1e3,
            "rms_after_um": judged.rms_after_mm * 1e3, "max_after_um": judged.max_after_mm * 1e3 });
    }
    out
}
