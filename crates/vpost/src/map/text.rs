//! What is printed.

use std::fmt::Write;

use diagnostic::{Language, Text, say};
use error_map::Statistics;
use error_map::placement::Freedom;
use machine_model::Vector;

use super::deformation;
use super::second_order::SecondOrder;
use super::study::{Kind, Part, Proof, Study, ZeroPoint};
use crate::figures::{fixed, printable, triple, um};

/// The page.
pub(super) fn page(study: &Study, language: Language) -> String {
    let mut out = head(study, language);
    figures(study, language, &mut out);
    deformations(study, language, &mut out);
    diagonals(study, language, &mut out);
    for part in &study.parts {
        zero_points(study, part, language, &mut out);
    }
    places(study, language, &mut out);
    if let Some(found) = &study.second_order {
        second_order(found, language, &mut out);
    }
    out
}

fn head(study: &Study, language: Language) -> String {
    let grid = study.map.grid();
    let axes: Vec<String> = ["X", "Y", "Z"]
        .iter()
        .zip(grid.axes())
        .map(|(name, nodes)| {
            let (range, count) = (nodes.range_mm(), nodes.places_mm().len());
            let (low, high) = (range.low, range.high);
            say!(language, "{name} {low} to {high} mm ({count})", "{name} от {low} до {high} мм ({count})")
        })
        .collect();
    say!(
        language,
        "{}: {} nodes, {}\nengine {}, tool vector {}, rotary axes {}\n",
        "{}: узлов {}, {}\nметод {}, вектор инструмента {}, поворотные оси {}\n",
        printable(&study.machine),
        grid.len(),
        axes.join(", "),
        study.engine,
        triple(&study.tool_mm, 3),
        triple(&study.rotary_rad.map(f64::to_degrees), 3),
    )
}

/// What a field does to small boxes of commands.
fn deformations(study: &Study, language: Language, out: &mut String) {
    let Some(figures) = deformation::figures(&study.cells) else { return };
    let count = study.cells.len();
    let heading = say!(language, "of {count} cells", "ячеек {count}");
    let [least, largest, rms] = [
        say!(language, "least", "наименьшее"),
        say!(language, "largest", "наибольшее"),
        say!(language, "rms", "СКЗ"),
    ];
    let _ = writeln!(out, "\n{heading:<30} {least:>11} {largest:>11} {rms:>11}");
    for (which, (range, rms)) in figures.iter().enumerate() {
        let name = format!(
            "{}, {}",
            deformation::WORDS[which].in_language(language),
            deformation::unit(which, language)
        );
        let numbers = [range.low, range.high, *rms].map(|v| fixed(v, 2));
        let _ = writeln!(out, "  {name:<28} {:>11} {:>11} {:>11}", numbers[0], numbers[1], numbers[2]);
    }
}

fn figures(study: &Study, language: Language, out: &mut String) {
    let heading = say!(
        language,
        "volumetric error, um      nodes  range X  range Y  range Z      rms     95 %      max   <= {} um",
        "погрешность, мкм          узлов размах X размах Y размах Z      СКЗ     95 %    наиб.   <= {} мкм",
        fixed(study.within_mm * 1e3, 0)
    );
    let _ = writeln!(out, "\n{heading}");
    for part in &study.parts {
        let f = &part.figures;
        let range = |axis: usize| um(f.component_mm[axis].high - f.component_mm[axis].low);
        let _ = writeln!(
            out,
            "  {:<22} {:>7} {:>8} {:>8} {:>8} {}",
            printable(part.name.in_language(language)),
            f.nodes,
            range(0),
            range(1),
            range(2),
            row(f)
        );
    }
}

fn diagonals(study: &Study, language: Language, out: &mut String) {
    let heading = say!(
        language,
        "body diagonals (ISO 230-6), um      systematic E     mean M  reversal B  length error",
        "объёмные диагонали (ISO 230-6), мкм  систем. откл. E  среднее M    реверс B  погр. длины"
    );
    let _ = writeln!(out, "\n{heading}");
    for diagonal in &study.diagonals {
        let signs: String = diagonal.signs.iter().map(|s| if *s > 0 { '+' } else { '-' }).collect();
        let _ = writeln!(
            out,
            "  X Y Z {signs}                         {:>12} {:>10} {:>11} {:>13}",
            um(diagonal.systematic_mm),
            um(diagonal.mean_mm),
            um(diagonal.reversal_mm),
            um(diagonal.length_error_mm)
        );
    }
}

fn zero_points(study: &Study, part: &Part, language: Language, out: &mut String) {
    let heading = say!(
        language,
        "zero point, {:<16} add to work offset, mm          rms     95 %      max   <= {} um",
        "нулевая точка, {:<13} прибавить к смещению нуля, мм   СКЗ     95 %    наиб.   <= {} мкм",
        printable(part.name.in_language(language)),
        fixed(study.within_mm * 1e3, 0)
    );
    let as_it_is = say!(language, "as it is", "как есть");
    let _ = writeln!(out, "\n{heading}\n  {as_it_is:<18} {:>29}  {}", "", row(&part.figures));
    for zero in &part.zero_points {
        let _ = writeln!(
            out,
            "  {:<18} {:>29}  {}",
            zero.kind.name().in_language(language),
            triple(&zero.to_enter_mm(study), study.decimals()),
            row(&zero.figures)
        );
    }
    for zero in &part.zero_points {
        let _ = writeln!(out, "  {}", proof(zero, part, language));
    }
    let Some(median) = part.zero_points.iter().find(|zero| zero.kind == Kind::Median) else { return };
    let add = median.to_enter_mm(study);
    let (x, y, z) = (add.x, add.y, add.z);
    let enter = say!(
        language,
        "to enter the geometric median: change a true work offset by X{x:+.3} Y{y:+.3} Z{z:+.3}; a touched one has the machine's error there in it",
        "чтобы ввести геометрическую медиану, измените точное смещение нуля на X{x:+.3} Y{y:+.3} Z{z:+.3}; в найденном касанием уже есть погрешность станка"
    );
    let _ = writeln!(out, "  {enter}");
    for offset in &study.work_offsets {
        let [from, to] =
            [offset.zero_mm, offset.to_enter_mm(median, study)].map(|v| triple(&v, study.decimals()));
        let (name, how) = (&offset.name, offset.how());
        let how = how.in_language(language);
        let becomes = say!(
            language,
            "{name} ({how}): {from} becomes {to}",
            "{name} ({how}): вместо {from} введите {to}"
        );
        let _ = writeln!(out, "    {becomes}");
    }
}

pub(super) fn proof(zero: &ZeroPoint, part: &Part, language: Language) -> String {
    let n = part.figures.nodes as f64;
    let name = zero.kind.name();
    let name = name.in_language(language);
    match &zero.proof {
        Proof::Node { place_mm, sum_mm, examined } => say!(
            language,
            "{name}: at {}; mean distance {} um; {examined} of {} sums computed, the others are proven larger",
            "{name}: в {}; среднее расстояние {} мкм; вычислено сумм: {examined} из {}, остальные доказано больше",
            triple(place_mm, 3),
            um(sum_mm / n),
            part.figures.nodes
        ),
        Proof::Sum { sum_mm, lower_bound_mm } => {
            let gap = (sum_mm - lower_bound_mm) / sum_mm.max(f64::MIN_POSITIVE);
            say!(
                language,
                "{name}: mean distance {} um; no shift has a sum smaller by more than {gap:.0e} of it",
                "{name}: среднее расстояние {} мкм; никакой сдвиг не уменьшит сумму больше чем на {gap:.0e} её долю",
                um(sum_mm / n)
            )
        }
        Proof::Radius { radius_mm, support } => {
            say!(
                language,
                "{name}: no shift has a smaller largest error than {} um ({support} nodes hold it)",
                "{name}: ни при каком сдвиге наибольшая погрешность не меньше {} мкм (её держат узлы: {support})",
                um(*radius_mm)
            )
        }
        Proof::Count { within, at_most } if within == at_most => {
            say!(
                language,
                "{name}: {within} nodes within, and no shift has more",
                "{name}: в допуске узлов {within}, и больше не даёт никакой сдвиг"
            )
        }
        Proof::Count { within, at_most } => say!(
            language,
            "{name}: {within} nodes within; no shift has more than {at_most} ({} %)",
            "{name}: в допуске узлов {within}; больше {at_most} ({} %) не даёт никакой сдвиг",
            percent(*at_most as f64 / n)
        ),
    }
}

fn places(study: &Study, language: Language, out: &mut String) {
    if study.places.is_empty() {
        return;
    }
    let heading = say!(
        language,
        "where to clamp, if the set-up can       box, mm                                       rms     95 %      max   <= {} um",
        "где закрепить, если можно               габарит, мм                                   СКЗ     95 %    наиб.   <= {} мкм",
        fixed(study.within_mm * 1e3, 0)
    );
    let _ = writeln!(out, "\n{heading}");
    for (freedom, place) in &study.places {
        let span: Vec<String> = ["X", "Y", "Z"]
            .iter()
            .zip(&place.box_mm)
            .map(|(axis, range)| format!("{axis} {}..{}", fixed(range.low, 1), fixed(range.high, 1)))
            .collect();
        let name = freedom_name(*freedom);
        let name = name.in_language(language);
        let _ = writeln!(out, "  {name:<33} {:<40}  {}", span.join(" "), row(&place.fit.after));
        let turn = place.fit.rotation_rad * 1e6;
        let how = say!(
            language,
            "before {} um rms; add {} mm to the work offset, turn by {} urad about {}",
            "до этого СКЗ {} мкм; прибавить к смещению нуля {} мм, повернуть на {} мкрад вокруг {}",
            um(place.fit.before.rms_mm),
            triple(&-place.fit.shift_mm, study.decimals()),
            triple(&-turn, 1),
            triple(&place.fit.centre_mm, 1)
        );
        let _ = writeln!(out, "    {how}");
    }
}

fn second_order(found: &SecondOrder, language: Language, out: &mut String) {
    let nodes = found.nodes;
    let heading =
        say!(language, "second order of rotations, {nodes} nodes", "второй порядок поворотов, узлов {nodes}");
    let _ = writeln!(out, "\n{heading}");
    for line in second_order_lines(found, language) {
        let _ = writeln!(out, "  {line}");
    }
}

/// A place with the names of its axes, mm.
fn axes_and(place_mm: &Vector) -> String {
    let [x, y, z] = [place_mm.x, place_mm.y, place_mm.z].map(|mm| fixed(mm, 3));
    format!("X {x} Y {y} Z {z}")
}

/// What products of errors do, in three sentences.
pub(super) fn second_order_lines(found: &SecondOrder, language: Language) -> [String; 3] {
    let limit = fixed(found.limit_mm * 1e3, 0);
    [
        say!(
            language,
            "whole chain: exact product and first-order sum differ by at most {} um, at {} mm",
            "вся цепь: точное произведение и сумма первого порядка расходятся до {} мкм, в {} мм",
            fixed(found.chain_difference_mm * 1e3, 6),
            axes_and(&found.chain_place_mm)
        ),
        match &found.threshold {
            Some(threshold) => say!(
                language,
                "products of errors reach {limit} um where all angles are k = {} times as large (largest {} urad)",
                "произведения погрешностей достигают {limit} мкм, если все углы увеличить в k = {} раз (наибольший {} мкрад)",
                fixed(threshold.scale, 2),
                fixed(threshold.angle_rad * 1e6, 1)
            ),
            None => say!(
                language,
                "products of errors stay below {limit} um for angles up to 0.1 rad",
                "произведения погрешностей меньше {limit} мкм при углах до 0.1 рад"
            ),
        },
        say!(
            language,
            "nine rotations of the tool vector {} mm in any order, at {} mm: first order {} um, all plus {}, all minus {}, exact {} to {} ({} orders)",
            "девять поворотов вектора инструмента {} мм в любом порядке, в {} мм: первый порядок {} мкм, все с плюсом {}, все с минусом {}, точно от {} до {} (порядков {})",
            triple(&found.tool_mm, 3),
            axes_and(&found.place_mm),
            fixed(found.first_mm * 1e3, 6),
            fixed(found.plus_mm * 1e3, 6),
            fixed(found.minus_mm * 1e3, 6),
            fixed(found.interval.low_mm * 1e3, 6),
            fixed(found.interval.high_mm * 1e3, 6),
            found.interval.orders
        ),
    ]
}

impl ZeroPoint {
    /// What to add to a work offset: minus the error, in whole output steps. Equation (41).
    pub(super) fn to_enter_mm(&self, study: &Study) -> Vector {
        study.rounded(&-self.shift_mm)
    }
}

impl Study {
    /// In whole output steps.
    pub(super) fn rounded(&self, mm: &Vector) -> Vector {
        // A negative zero would be printed as one.
        Vector::from_fn(|axis, _| {
            (mm[axis] / self.resolution_mm[axis]).round() * self.resolution_mm[axis] + 0.0
        })
    }

    /// Decimals that show the finest output step.
    pub(super) fn decimals(&self) -> usize {
        let finest = self.resolution_mm.iter().copied().fold(f64::INFINITY, f64::min);
        (3..6).find(|d| finest * 10f64.powi(*d) >= 1.0 - 1e-9).map_or(6, |d| d as usize)
    }
}

/// What the set-up can do, in words.
pub(super) fn freedom_name(freedom: Freedom) -> Text {
    match freedom {
        Freedom::Shift => Text::pair("shift the zero point", "сдвинуть нулевую точку"),
        Freedom::ShiftAndTurn => Text::pair("shift, and turn about Z", "сдвинуть и повернуть вокруг Z"),
        Freedom::Rigid => Text::pair("shift, and turn about X, Y and Z", "сдвинуть и повернуть вокруг XYZ"),
    }
}

/// RMS, 95 %, largest, share within.
fn row(figures: &Statistics) -> String {
    format!(
        "{:>8} {:>8} {:>8} {:>8} %",
        um(figures.rms_mm),
        um(figures.p95_mm),
        um(figures.magnitude_mm.high),
        percent(figures.share_within())
    )
}

fn percent(share: f64) -> String {
    fixed(share * 100.0, 2)
}
