//! A map as text for people.

use diagnostic::{Text, both};
use error_map::Statistics;
use machine_model::Vector;

use super::deformation;
use super::second_order::SecondOrder;
use crate::figures::{fixed, printable, triple, um};
use crate::map::study::{Part, Proof, Study, ZeroPoint, freedom_name};

/// The whole text.
#[must_use]
pub fn page(study: &Study) -> Text {
    let mut out = head(study);
    figures(study, &mut out);
    deformations(study, &mut out);
    diagonals(study, &mut out);
    for part in &study.parts {
        zero_points(study, part, &mut out);
    }
    places(study, &mut out);
    if let Some(found) = &study.second_order {
        let nodes = found.nodes;
        out.push(&both!(
            "\nsecond order of rotations, {nodes} nodes\n",
            "\nвторой порядок поворотов, узлов {nodes}\n"
        ));
        for line in second_order_lines(found) {
            out.push(&both!("  {line}\n", "  {line:#}\n"));
        }
    }
    out
}

fn head(study: &Study) -> Text {
    let grid = study.map.grid();
    let axes = ["X", "Y", "Z"].iter().zip(grid.axes()).map(|(name, nodes)| {
        let (range, count) = (nodes.range_mm(), nodes.places_mm().len());
        let (low, high) = (range.low, range.high);
        both!("{name} {low} to {high} mm ({count})", "{name} от {low} до {high} мм ({count})")
    });
    let axes = Text::join(&axes.collect::<Vec<_>>(), ", ");
    let (machine, nodes, engine) = (printable(&study.machine), grid.len(), study.engine);
    let (tool, rotary) =
        (triple(&study.asked.tool_mm, 3), triple(&study.asked.rotary_rad.map(f64::to_degrees), 3));
    both!(
        "{machine}: {nodes} nodes, {axes}\nengine {engine}, tool vector {tool}, rotary axes {rotary}\n",
        "{machine}: узлов {nodes}, {axes:#}\nметод {engine}, вектор инструмента {tool}, поворотные оси {rotary}\n"
    )
}

/// What a field does to small boxes of commands.
fn deformations(study: &Study, out: &mut Text) {
    let Some(figures) = deformation::figures(&study.cells) else { return };
    let heading = both!("of {} cells", "ячеек {}", study.cells.len());
    let [least, largest, rms] =
        [both!("least", "наименьшее"), both!("largest", "наибольшее"), both!("rms", "СКЗ")];
    out.push(&both!(
        "\n{heading:<30} {least:>11} {largest:>11} {rms:>11}\n",
        "\n{heading:<#30} {least:>#11} {largest:>#11} {rms:>#11}\n"
    ));
    for (which, (range, rms)) in figures.iter().enumerate() {
        let name = Text::join([&deformation::WORDS[which], &deformation::unit(which)], ", ");
        let [low, high, rms] = [range.low, range.high, *rms].map(|v| fixed(v, 2));
        let numbers = format!("{low:>11} {high:>11} {rms:>11}");
        out.push(&both!("  {name:<28} {numbers}\n", "  {name:<#28} {numbers}\n"));
    }
}

fn figures(study: &Study, out: &mut Text) {
    let within = fixed(study.asked.within_mm * 1e3, 0);
    out.push(&both!(
        "\nvolumetric error, um      nodes  range X  range Y  range Z      rms     95 %      max   <= {within} um\n",
        "\nпогрешность, мкм          узлов размах X размах Y размах Z      СКЗ     95 %    наиб.   <= {within} мкм\n"
    ));
    for part in &study.parts {
        let f = &part.figures;
        let [x, y, z] = f.component_mm.each_ref().map(|range| um(range.high - range.low));
        let numbers = format!("{:>7} {x:>8} {y:>8} {z:>8} {}", f.nodes, row(f));
        let name = shown(&part.name);
        out.push(&both!("  {name:<22} {numbers}\n", "  {name:<#22} {numbers}\n"));
    }
}

/// A name on one line.
fn shown(name: &Text) -> Text {
    Text::new(printable(name.english()), printable(&format!("{name:#}")))
}

fn diagonals(study: &Study, out: &mut Text) {
    out.push(&both!(
        "\nbody diagonals (ISO 230-6), um      systematic E     mean M  reversal B  length error\n",
        "\nобъёмные диагонали (ISO 230-6), мкм  систем. откл. E  среднее M    реверс B  погр. длины\n"
    ));
    for d in &study.diagonals {
        let signs = d.signs.map(|sign| if sign > 0 { "+" } else { "-" }).concat();
        let [e, m, b, length] = [d.systematic_mm, d.mean_mm, d.reversal_mm, d.length_error_mm].map(um);
        out.push(&Text::same(format!(
            "  X Y Z {signs}                         {e:>12} {m:>10} {b:>11} {length:>13}\n"
        )));
    }
}

fn zero_points(study: &Study, part: &Part, out: &mut Text) {
    let (name, within, now) = (shown(&part.name), fixed(study.asked.within_mm * 1e3, 0), row(&part.figures));
    out.push(&both!(
        "\nzero point, {name:<16} add to work offset, mm          rms     95 %      max   <= {within} um\n  {:<18} {:>29}  {now}\n",
        "\nнулевая точка, {name:<#13} прибавить к смещению нуля, мм   СКЗ     95 %    наиб.   <= {within} мкм\n  {:<#18} {:>29}  {now}\n",
        both!("as it is", "как есть"),
        ""
    ));
    for zero in &part.zero_points {
        let (name, add) = (zero.kind.name(), triple(&zero.to_enter_mm(study), study.decimals()));
        let numbers = format!("{add:>29}  {}", row(&zero.figures));
        out.push(&both!("  {name:<18} {numbers}\n", "  {name:<#18} {numbers}\n"));
    }
    for zero in &part.zero_points {
        let proof = proof(zero, part);
        out.push(&both!("  {proof}\n", "  {proof:#}\n"));
    }
    let median = part.median();
    let add = median.to_enter_mm(study);
    let (x, y, z) = (add.x, add.y, add.z);
    out.push(&both!(
        "  to enter the geometric median: change a true work offset by X{x:+.3} Y{y:+.3} Z{z:+.3}; a touched one has the machine's error there in it\n",
        "  чтобы ввести геометрическую медиану, измените точное смещение нуля на X{x:+.3} Y{y:+.3} Z{z:+.3}; в найденном касанием уже есть погрешность станка\n"
    ));
    for offset in &study.work_offsets {
        let [from, to] =
            [offset.zero_mm, offset.to_enter_mm(median, study)].map(|v| triple(&v, study.decimals()));
        let (name, how) = (&offset.name, offset.how());
        out.push(&both!(
            "    {name} ({how}): {from} becomes {to}\n",
            "    {name} ({how:#}): вместо {from} введите {to}\n"
        ));
    }
}

/// What is known of a zero point: that no other is better, or by how much at most.
#[must_use]
pub fn proof(zero: &ZeroPoint, part: &Part) -> Text {
    let (nodes, name) = (part.figures.nodes, zero.kind.name());
    let n = nodes as f64;
    match &zero.proof {
        Proof::Node { place_mm, sum_mm, examined } => {
            let (place, mean) = (triple(place_mm, 3), um(sum_mm / n));
            both!(
                "{name}: at {place}; mean distance {mean} um; {examined} of {nodes} sums computed, the others are proven larger",
                "{name:#}: в {place}; среднее расстояние {mean} мкм; вычислено сумм: {examined} из {nodes}, остальные доказано больше"
            )
        }
        Proof::Sum { sum_mm, lower_bound_mm } => {
            let gap = (sum_mm - lower_bound_mm) / sum_mm.max(f64::MIN_POSITIVE);
            let mean = um(sum_mm / n);
            both!(
                "{name}: mean distance {mean} um; no shift has a sum smaller by more than {gap:.0e} of it",
                "{name:#}: среднее расстояние {mean} мкм; никакой сдвиг не уменьшит сумму больше чем на {gap:.0e} её долю"
            )
        }
        Proof::Radius { radius_mm, support } => both!(
            "{name}: no shift has a smaller largest error than {} um ({support} nodes hold it)",
            "{name:#}: ни при каком сдвиге наибольшая погрешность не меньше {} мкм (её держат узлы: {support})",
            um(*radius_mm)
        ),
        Proof::Count { within, at_most } if within == at_most => both!(
            "{name}: {within} nodes within, and no shift has more",
            "{name:#}: в допуске узлов {within}, и больше не даёт никакой сдвиг"
        ),
        Proof::Count { within, at_most } => both!(
            "{name}: {within} nodes within; no shift has more than {at_most} ({} %)",
            "{name:#}: в допуске узлов {within}; больше {at_most} ({} %) не даёт никакой сдвиг",
            percent(*at_most as f64 / n)
        ),
    }
}

fn places(study: &Study, out: &mut Text) {
    if study.places.is_empty() {
        return;
    }
    let within = fixed(study.asked.within_mm * 1e3, 0);
    out.push(&both!(
        "\nwhere to clamp, if the set-up can       box, mm                                       rms     95 %      max   <= {within} um\n",
        "\nгде закрепить, если можно               габарит, мм                                   СКЗ     95 %    наиб.   <= {within} мкм\n"
    ));
    for (freedom, place) in &study.places {
        let (name, fit) = (freedom_name(*freedom), &place.fit);
        let [x, y, z] =
            place.box_mm.map(|range| format!("{}..{}", fixed(range.low, 1), fixed(range.high, 1)));
        let numbers = format!("{:<40}  {}", format!("X {x} Y {y} Z {z}"), row(&fit.after));
        let (rms, add) = (um(fit.before.rms_mm), triple(&-fit.shift_mm, study.decimals()));
        let (turn, centre) = (triple(&(-fit.rotation_rad * 1e6), 1), triple(&fit.centre_mm, 1));
        out.push(&both!(
            "  {name:<33} {numbers}\n    before {rms} um rms; add {add} mm to the work offset, turn by {turn} urad about {centre}\n",
            "  {name:<#33} {numbers}\n    до этого СКЗ {rms} мкм; прибавить к смещению нуля {add} мм, повернуть на {turn} мкрад вокруг {centre}\n"
        ));
    }
}

/// A place with the names of its axes, mm.
fn axes_and(place_mm: &Vector) -> String {
    let [x, y, z] = [place_mm.x, place_mm.y, place_mm.z].map(|mm| fixed(mm, 3));
    format!("X {x} Y {y} Z {z}")
}

/// What products of errors do, in three sentences.
#[must_use]
pub fn second_order_lines(found: &SecondOrder) -> [Text; 3] {
    let fine = |mm: f64| fixed(mm * 1e3, 6);
    let limit = fixed(found.limit_mm * 1e3, 0);
    let (off, at) = (fine(found.chain_difference_mm), axes_and(&found.chain_place_mm));
    let (tool, place, orders) = (triple(&found.tool_mm, 3), axes_and(&found.place_mm), found.interval.orders);
    let [first, plus, minus, low, high] =
        [found.first_mm, found.plus_mm, found.minus_mm, found.interval.low_mm, found.interval.high_mm]
            .map(fine);
    [
        both!(
            "whole chain: exact product and first-order sum differ by at most {off} um, at {at} mm",
            "вся цепь: точное произведение и сумма первого порядка расходятся до {off} мкм, в {at} мм"
        ),
        match &found.threshold {
            Some(threshold) => both!(
                "products of errors reach {limit} um where all angles are k = {} times as large (largest {} urad)",
                "произведения погрешностей достигают {limit} мкм, если все углы увеличить в k = {} раз (наибольший {} мкрад)",
                fixed(threshold.scale, 2),
                fixed(threshold.angle_rad * 1e6, 1)
            ),
            None => both!(
                "products of errors stay below {limit} um for angles up to 0.1 rad",
                "произведения погрешностей меньше {limit} мкм при углах до 0.1 рад"
            ),
        },
        both!(
            "nine rotations of the tool vector {tool} mm in any order, at {place} mm: first order {first} um, all plus {plus}, all minus {minus}, exact {low} to {high} ({orders} orders)",
            "девять поворотов вектора инструмента {tool} мм в любом порядке, в {place} мм: первый порядок {first} мкм, все с плюсом {plus}, все с минусом {minus}, точно от {low} до {high} (порядков {orders})"
        ),
    ]
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
