//! The page of a ball bar: the polar plot of each plane, its causes one by one, and location errors.

use calibration::circular_test::{CirclePoint, CircularTest, Pattern, Sense, Trace};
use calibration::linear_ballbar::{CircleCalibration, Term};
use calibration::rotary_ballbar::RotaryCalibration;
use diagnostic::{Text, both};
use machine_model::Component;
use report::body::{Body, Table};
use report::chart::{Magnification, Polar, Round, polar};
use report::numbers::{count, digits, number, percent};
use report::page::Page;
use report::text::MICROMETRES;
use serde_json::Value;

use super::super::bar_report::{CENTRED_APART, SCALES};
use super::bars::{Bars, PLANES, SQUARENESS, cause_name, sense_name, um};
use super::bars_csv;
use super::circle_verdict::{CLOSED_DEG, Verdict};
use super::facts::Facts;
use super::found::Found;

impl Found for Bars<'_> {
    fn title(&self) -> Text {
        let planes: Vec<&str> = self.tests().iter().map(|t| PLANES[t.plane].0).collect();
        match planes.as_slice() {
            [] => both!("Location errors", "Погрешности положения осей"),
            planes => both!("Ball bar {}", "Телескопический измеритель {}", planes.join(", ")),
        }
    }

    fn head(&self, out: &mut Body, facts: &Facts) {
        out.muted(&both!("Ball bar: {}", "Телескопический измеритель: {}", facts.names()));
        match (worst(self), self.rotary) {
            (Some(test), _) => worst_circle(out, test),
            (None, Some(found)) => rotary_head(out, found),
            (None, None) => {}
        }
        facts.say_written(out);
    }

    fn sections(&self, page: &mut Page) {
        if let Some((found, names)) = self.circles {
            for test in &found.tests {
                plane(page.section(OF_PLANES[test.plane], circles_in(test.plane)), test, names);
            }
            let title = both!("What the circles say together", "Что говорят все окружности вместе");
            together(page.section("together", title), found);
        }
        if let Some(found) = self.rotary {
            let title = both!("Location errors", "Погрешности положения осей");
            locations(page.section("locations", title), found);
        }
    }

    fn json(&self) -> Value {
        Self::json(self)
    }

    fn csv(&self) -> String {
        bars_csv::csv(self)
    }
}

/// The circle that is least round, by both senses or by the worst run.
fn worst<'b>(bars: &'b Bars<'_>) -> Option<&'b CircularTest> {
    bars.tests().iter().max_by(|a, b| whole_mm(a).total_cmp(&whole_mm(b)))
}

/// G(b), or the largest G where one sense was read.
fn whole_mm(test: &CircularTest) -> f64 {
    let largest = test.traces.iter().map(|t| t.circularity_mm).fold(0.0, f64::max);
    test.bidirectional_mm.unwrap_or(largest)
}

/// Curves of the base below this are rounding, mm.
const CURVES_MM: f64 = 5e-5;

/// What a profile holds of a plane's causes.
fn held(test: &CircularTest) -> Text {
    if test.curves_mm > CURVES_MM {
        both!(
            "squareness, backlash and the base's own curves",
            "отклонение от перпендикулярности, люфт и собственные кривые исходного профиля"
        )
    } else {
        both!("squareness and backlash", "отклонение от перпендикулярности и люфт")
    }
}

/// What the first screen says of circles.
fn worst_circle(out: &mut Body, test: &CircularTest) {
    let verdict = Verdict::of(test);
    let symbol = if test.bidirectional_mm.is_some() { "G(b)" } else { "G" };
    let (plane, whole, more) = (PLANES[test.plane].0, um(whole_mm(test)), verdict.goes_on(test.plane));
    out.verdict(
        &verdict.word(),
        &both!(
            "Circles in {plane} deviate by {symbol} = {whole} \u{b5}m{more}",
            "Отклонение окружностей в плоскости {plane}: {symbol} = {whole:#} мкм{more:#}"
        ),
    );
    out.p(&verdict.remedy());
    let (held, corrected, left) = (held(test), um(test.corrected_mm), um(test.left_mm));
    out.p(&both!(
        "With {held} corrected, which is what a profile holds, circles in {plane} would deviate by {corrected} \u{b5}m; no cause explains {left} \u{b5}m of them. This is said by the same circles: measure again after the correction to prove it.",
        "Если исправить то, что хранит профиль ({held:#}), отклонение окружностей в плоскости {plane} будет {corrected:#} мкм; из них {left:#} мкм не объясняет ни одна причина. Это говорят те же окружности: чтобы доказать, измерьте снова после исправления."
    ));
}

fn rotary_head(out: &mut Body, found: &RotaryCalibration) {
    out.verdict_alone(&both!("LOCATION ERRORS", "ПОЛОЖЕНИЕ ОСЕЙ"));
    let lengths = found.locations.iter().filter(|f| f.location.component == Component::Linear);
    if let Some(f) = lengths.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs())) {
        let (axis, name) = (f.location.axis, f.location.name());
        let (value, half) = (um(f.value), um(f.half_width_95));
        out.headline(&both!(
            "The axis of {axis} lies beside its place: {name} = {value} \u{b5}m (\u{b1} {half}, 95\u{a0}%)",
            "Ось {axis} лежит не на своём месте: {name} = {value:#} мкм (\u{b1} {half:#}, 95\u{a0}%)"
        ));
    }
    out.p(&both!(
        "A profile with these values corrects them wherever the axes turn; the others are below.",
        "Профиль с этими значениями исправляет их при любом повороте осей; остальные ниже."
    ));
}

/// Ids of the planes' sections.
const OF_PLANES: [&str; 3] = ["xy", "zx", "yz"];

fn circles_in(plane: usize) -> Text {
    both!("Circles in {}", "Окружности в плоскости {}", PLANES[plane].0)
}

fn plane(out: &mut Body, test: &CircularTest, names: &[String]) {
    out.side(|out| {
        whole(out, test);
        out.together(|out| figures(out, test));
    });
    out.numbers(&readings(test));
    not_drawn(out, test, names);
    out.heading(&both!("Causes, each on its own", "Причины по отдельности"));
    patterns(out, test);
    out.heading(&both!("Runs", "Проходы"));
    runs(out, test, names);
}

/// Colours of both senses; black where no reading says.
fn class(sense: Sense) -> (&'static str, &'static str) {
    match sense {
        Sense::CounterClockwise => ("round s0", "k0"),
        Sense::Clockwise => ("round s1", "k1"),
        Sense::Unknown => ("round s3", "k3"),
    }
}

fn curve(trace: &Trace, class: &'static str, of: &dyn Fn(&CirclePoint) -> f64) -> Round {
    Round { class, at: trace.points.iter().map(|p| (p.angle_rad, of(p) * 1e3)).collect() }
}

fn points(test: &CircularTest) -> impl Iterator<Item = &CirclePoint> {
    test.traces.iter().flat_map(|t| &t.points)
}

/// A part of every reading about the circle.
fn drawn(test: &CircularTest, of: &dyn Fn(&CirclePoint) -> f64) -> Polar {
    let curves = test.traces.iter().map(|t| curve(t, class(t.sense).0, of)).collect();
    Polar { axes: PLANES[test.plane].1, radius: test.radius_mm * 1e3, curves, keys: Vec::new() }
}

/// How much larger than the circle such deviations are drawn.
fn magnification(test: &CircularTest, deviations_mm: impl Iterator<Item = f64>) -> Magnification {
    let largest = deviations_mm.fold(0.0, |most: f64, mm| most.max(mm.abs()));
    Magnification::of(largest * 1e3, test.radius_mm * 1e3)
}

/// What was read about the least-squares circle, and what was fitted.
fn whole(out: &mut Body, test: &CircularTest) {
    let m = magnification(test, points(test).flat_map(|p| [p.deviation_mm, p.fitted_mm]));
    let mut senses: Vec<Sense> = test.traces.iter().map(|t| t.sense).collect();
    senses.sort();
    senses.dedup();
    let mut drawn = drawn(test, &|p| p.deviation_mm);
    drawn.curves.extend(test.traces.iter().map(|t| curve(t, "fit s2", &|p| p.fitted_mm)));
    drawn.keys = senses.iter().map(|s| (class(*s).1, sense_name(*s))).collect();
    drawn.keys.push(("k2", both!("dashed: what the causes found make", "штрих: вклад найденных причин")));
    let (times, radius, ring) = (number(m.times), digits(test.radius_mm, 1), number(m.ring));
    let described = both!(
        "deviations from the least-squares circle, drawn {times} times larger than the circle",
        "отклонения от средней окружности, увеличение {times:#}\u{d7}"
    );
    out.figure(
        &polar(out.language(), &circles_in(test.plane), &described, &drawn, m),
        &both!(
            "Deviation from the least-squares circle of each run (radius {radius} mm), drawn {times} times larger than the circle; a ring is {ring} \u{b5}m.",
            "Отклонение от средней окружности каждого прохода (радиус {radius:#} мм), увеличение {times:#}\u{d7}; шаг колец {ring:#} мкм."
        ),
    );
}

/// Every reading, and what the causes add to it.
fn readings(test: &CircularTest) -> Table<(Sense, &CirclePoint)> {
    let rows = test.traces.iter().flat_map(|t| t.points.iter().map(move |p| (t.sense, p)));
    let mut table = Table::of(rows)
        .numbers(both!("angle, degrees", "угол, градусы"), |(_, p)| {
            digits(p.angle_rad.to_degrees(), 1)
        })
        .words(both!("direction", "направление"), |(sense, _)| sense_name(*sense))
        .numbers(both!("read, \u{b5}m", "отсчёт, мкм"), |(_, p)| um(p.read_mm))
        .numbers(both!("deviation", "отклонение"), |(_, p)| um(p.deviation_mm))
        .numbers(both!("fitted", "подгонка"), |(_, p)| um(p.fitted_mm));
    for (k, pattern) in test.patterns.iter().enumerate() {
        table = table.numbers(cause_name(pattern.cause, test.plane), |(_, p)| um(p.causes_mm[k]));
    }
    table
}

/// What the readings do not show.
fn not_drawn(out: &mut Body, test: &CircularTest, names: &[String]) {
    for t in test.traces.iter().filter(|t| t.gap_rad.to_degrees() > CLOSED_DEG) {
        let (run, sense) = (names.get(t.run).map_or("", String::as_str), sense_name(t.sense));
        let degrees = digits(360.0 - t.gap_rad.to_degrees(), 0);
        out.p(&both!(
            "Run {run}, {sense}, covers {degrees} degrees of the circle: nothing is drawn where nothing was read, and G and the sizes of causes count what was read alone.",
            "Проход {run}, {sense:#}, охватывает {degrees:#}° окружности: где отсчётов нет, ничего не нарисовано, а G и величины причин относятся только к измеренному."
        ));
    }
    if test.bidirectional_mm.is_none() {
        out.p(&if test.traces.iter().all(|t| t.sense == Sense::Unknown) {
            both!(
                "No reading says which way round it was taken (dir_x, dir_y, dir_z, or dir): G(b), H and backlash are not known.",
                "Ни один отсчёт не говорит, в какую сторону он снят (dir_x, dir_y, dir_z или dir): G(b), H и люфт неизвестны."
            )
        } else if test.is_centred_apart() {
            both!("{CENTRED_APART}.", "{CENTRED_APART:#}.")
        } else {
            both!(
                "Circles in one direction only: G(b) and H need both.",
                "Окружности только в одну сторону: для G(b) и H нужны обе."
            )
        });
    } else if test.hysteresis.is_none() {
        out.p(&both!(
            "Both directions were not read at neighbouring angles: H is not known.",
            "Обе стороны не сняты на соседних углах: H неизвестен."
        ));
    }
}

/// ISO 230-4.
fn figures(out: &mut Body, test: &CircularTest) {
    let mut rows: Vec<(&str, f64, Text)> = Vec::new();
    for sense in [Sense::CounterClockwise, Sense::Clockwise, Sense::Unknown] {
        let own = test.traces.iter().filter(|t| t.sense == sense).map(|t| t.circularity_mm);
        let words = both!("circular deviation, {}", "круговое отклонение, {:#}", sense_name(sense));
        rows.extend(own.reduce(f64::max).map(|largest| ("G", largest, words)));
    }
    let words = both!("circular deviation, both directions", "круговое отклонение, в обе стороны");
    rows.extend(test.bidirectional_mm.map(|both| ("G(b)", both, words)));
    rows.extend(test.hysteresis.map(|h| {
        let at = digits(h.angle_rad.to_degrees(), 1);
        let words = both!("circular hysteresis, at {at} degrees", "круговой гистерезис, на {at:#}°");
        ("H", h.value_mm, words)
    }));
    let [least, largest] = test.radial_mm;
    rows.push(("F\u{a0}min", least, both!("least radial deviation", "наименьшее радиальное отклонение")));
    rows.push(("F\u{a0}max", largest, both!("largest radial deviation", "наибольшее радиальное отклонение")));
    let table = Table::of(rows)
        .words(Text::EMPTY, |(symbol, ..)| Text::same(*symbol))
        .numbers(MICROMETRES.clone(), |(_, mm, _)| um(*mm))
        .words(Text::same("ISO 230-4"), |(.., words)| words.clone());
    out.table(&table);
    out.muted(&both!(
        "About the least-squares circle; F counts from the length that the bar states.",
        "Относительно средней окружности; F отсчитывается от длины, названной измерителем."
    ));
}

/// What a ball beside its place and a bar of another length make: on a scale of its own, for it may be of any size.
fn set_up(out: &mut Body, test: &CircularTest) {
    let m = magnification(test, points(test).map(CirclePoint::set_up_mm));
    let caption = both!(
        "no cause in the machine: the set-up's centre and length, {} \u{b5}m, drawn {} times larger",
        "не причина в станке: центр и длина установки, {:#} мкм, увеличение {:#}\u{d7}",
        um(test.set_up_mm),
        number(m.times)
    );
    let title = both!("Set-up: centre and length", "Установка: центр и длина");
    let drawn = drawn(test, &CirclePoint::set_up_mm);
    out.figure(&polar(out.language(), &title, &caption, &drawn, m), &caption);
}

/// Each cause as a plot of its own, all on one scale, and their sizes.
fn patterns(out: &mut Body, test: &CircularTest) {
    let m = magnification(test, points(test).flat_map(|p| p.causes_mm.iter().copied()));
    let sum_mm = test.sum_of_patterns_mm();
    let name = |p: &Pattern| cause_name(p.cause, test.plane);
    out.side(|out| {
        for (k, p) in test.patterns.iter().enumerate() {
            let (name, size) = (name(p), um(p.range_mm));
            let described = both!(
                "{size} \u{b5}m from the innermost to the outermost",
                "{size:#} мкм между крайними точками"
            );
            let caption = both!("{name}: {size} {MICROMETRES}", "{name:#}: {size:#} {MICROMETRES:#}");
            let drawn = drawn(test, &|p| p.causes_mm[k]);
            out.figure(&polar(out.language(), &name, &described, &drawn, m), &caption);
        }
        set_up(out, test);
    });
    out.muted(&both!(
        "Causes are drawn {} times larger than the circle; a ring is {} \u{b5}m. Shares are of the sum of what the causes make.",
        "Причины нарисованы с увеличением {:#}\u{d7}; шаг колец {:#} мкм. Доли — от суммы вкладов причин.",
        number(m.times),
        number(m.ring)
    ));
    let share = |p: &&Pattern| percent(if sum_mm > 0.0 { p.range_mm / sum_mm } else { 0.0 });
    let table = Table::of(&test.patterns)
        .words(both!("cause", "причина"), |p| name(p))
        .numbers(both!("makes, \u{b5}m", "даёт, мкм"), |p| um(p.range_mm))
        .numbers(both!("\u{b1} 95 %, \u{b5}m", "\u{b1} 95 %, мкм"), |p| um(p.half_width_95_mm))
        .numbers(both!("share", "доля"), share)
        .numbers(both!("G(b) without it, \u{b5}m", "G(b) без неё, мкм"), |p| um(p.without_mm));
    out.table(&table);
    if test.curves_mm > CURVES_MM {
        out.muted(&both!(
            "The base's own curves and effects make {} \u{b5}m.",
            "Собственные кривые и эффекты исходного профиля дают {:#} мкм.",
            um(test.curves_mm)
        ));
    }
    out.muted(&both!(
        "{} \u{b5}m of the deviations, noise with it, no cause explains.",
        "{:#} мкм отклонений, вместе с шумом, не объясняет ни одна причина.",
        um(test.left_mm)
    ));
}

fn runs(out: &mut Body, test: &CircularTest, names: &[String]) {
    let [first, second] = PLANES[test.plane].1;
    let table = Table::of(&test.traces)
        .words(both!("run", "проход"), |t| Text::same(names.get(t.run).map_or("", String::as_str)))
        .words(both!("direction", "направление"), |t| sense_name(t.sense))
        .numbers(both!("readings", "отсчётов"), |t| count(t.points.len()))
        .numbers(both!("G, \u{b5}m", "G, мкм"), |t| um(t.circularity_mm))
        .numbers(both!("ball {first}, \u{b5}m", "шарик {first}, мкм"), |t| um(t.centre_mm[0]))
        .numbers(both!("ball {second}, \u{b5}m", "шарик {second}, мкм"), |t| um(t.centre_mm[1]))
        .numbers(both!("radius, \u{b5}m", "радиус, мкм"), |t| um(t.excess_mm));
    out.table(&table);
    out.muted(&both!(
        "Ball: where the circle finds the fixed ball, against where it was stated. Radius: of the least-squares circle, against the commanded one. Both are the set-up's and not the machine's.",
        "Шарик: где окружность находит неподвижный шарик относительно указанного места. Радиус: средней окружности относительно заданного. То и другое относится к установке, а не к станку."
    ));
}

/// A fitted value: its name, value, half width of its interval, what the base has of it, and its unit.
type Row = (Text, [Text; 3], Text);

/// A table of fitted values; what the base has of them where it has any.
fn terms(out: &mut Body, rows: &[Row]) {
    let is_something = |base: &Text| base.english().chars().any(|c| c.is_ascii_digit() && c != '0');
    let mut table = Table::of(rows)
        .words(Text::EMPTY, |(name, ..)| name.clone())
        .numbers(both!("value", "значение"), |(_, [value, ..], _)| value.clone())
        .numbers(both!("\u{b1} 95 %", "\u{b1} 95 %"), |(_, [_, half, _], _)| half.clone());
    if rows.iter().any(|(_, [.., base], _)| is_something(base)) {
        let title = both!("of it in the base", "из него в исходном");
        table = table.numbers(title, |(_, [.., base], _)| base.clone());
    }
    out.table(&table.words(both!("unit", "единица"), |(.., unit)| unit.clone()));
}

fn together(out: &mut Body, found: &CircleCalibration) {
    let mut rows: Vec<Row> = Vec::new();
    let mut put = |name: Text, term: Option<Term>, scale: f64, unit: Text| {
        let numbers = |t: Term| [t.value, t.half_width_95, t.base].map(|v| digits(v * scale, 2));
        rows.extend(term.map(|t| (name, numbers(t), unit)));
    };
    let ratio = || both!("\u{b5}m/m", "мкм/м");
    for (name, term) in SQUARENESS.into_iter().zip(found.squareness_rad) {
        put(Text::same(name), term, 1e6, both!("\u{b5}rad", "мкрад"));
    }
    for (name, term) in SCALES.into_iter().zip(found.mismatch) {
        put(both!("scale {name}", "масштаб {name}"), term, 1e6, ratio());
    }
    put(both!("closure of the scales", "сумма масштабов"), found.closure, 1e6, ratio());
    for (axis, term) in ["X", "Y", "Z"].into_iter().zip(found.backlash_mm) {
        put(both!("backlash {axis}", "люфт {axis}"), term, 1e3, MICROMETRES.clone());
    }
    let (readings, left) = (count(found.estimate.residuals.len()), um(found.estimate.sigma));
    out.p(&both!(
        "{readings} readings of all planes in one adjustment; {left} \u{b5}m left (standard deviation).",
        "Отсчётов всех плоскостей в одном уравнивании: {readings:#}; остаток {left:#} мкм (стандартное отклонение)."
    ));
    terms(out, &rows);
    out.muted(&both!(
        "A bar sees one scale against another, never both: a common scale looks like a longer bar. The three scales of a machine add up to 0.",
        "Измеритель видит один масштаб относительно другого, но не оба: общий масштаб выглядит как более длинный измеритель. Сумма трёх масштабов станка — 0."
    ));
}

fn locations(out: &mut Body, found: &RotaryCalibration) {
    let row = |f: &calibration::rotary_ballbar::Found| {
        let (scale, unit) = match f.location.component {
            Component::Linear => (1e3, MICROMETRES.clone()),
            Component::Angular => (1e6, both!("\u{b5}rad", "мкрад")),
        };
        let numbers = [f.value, f.half_width_95, f.base].map(|v| digits(v * scale, 3));
        (Text::same(f.location.name()), numbers, unit)
    };
    let (readings, left) = (count(found.estimate.residuals.len()), um(found.estimate.sigma));
    out.p(&both!(
        "{readings} readings, {left} \u{b5}m left (standard deviation). A table that turns under a bar draws no circle of two axes: there is no polar plot of these runs.",
        "Отсчётов {readings:#}, остаток {left:#} мкм (стандартное отклонение). Стол, который поворачивается под измерителем, не чертит окружности двумя осями: полярной диаграммы этих проходов нет."
    ));
    terms(out, &found.locations.iter().map(row).collect::<Vec<_>>());
}
