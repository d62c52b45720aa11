//! The page of a ball bar: the polar plot of each plane, its causes one by one, and location errors.

use calibration::circular_test::{Cause, CirclePoint, CircularTest, Pattern, Sense, Trace};
use calibration::linear_ballbar::{CircleCalibration, Term};
use calibration::rotary_ballbar::RotaryCalibration;
use diagnostic::{Language, Text, both, say};
use maud::{Markup, html};
use report::chart::{Magnification, Polar, Round, polar};
use report::page::{Section, figure, folded, table};
use report::text::{MICROMETRES, Numbers, shown};
use serde_json::Value;

use super::super::bar_report::CENTRED_APART;
use super::bars::{Bars, PLANES, SQUARENESS, cause_name, sense_name};
use super::bars_csv;
use super::facts::Facts;
use super::found::Found;
use crate::file;

impl Found for Bars<'_> {
    fn title(&self, language: Language) -> String {
        let planes: Vec<&str> = self.tests().iter().map(|t| PLANES[t.plane].0).collect();
        match planes.as_slice() {
            [] => say!(language, "Location errors", "Погрешности положения осей"),
            planes => {
                say!(language, "Ball bar {}", "Телескопический измеритель {}", planes.join(", "))
            }
        }
    }

    fn head(&self, facts: &Facts, language: Language) -> Markup {
        head(self, facts, language)
    }

    fn sections(&self, language: Language) -> Vec<Section> {
        sections(self, language)
    }

    fn json(&self) -> Value {
        Self::json(self)
    }

    fn csv(&self) -> String {
        bars_csv::csv(self)
    }
}

/// Gaps wider than this are told: the circle was not closed, degrees.
const CLOSED_DEG: f64 = 15.0;

fn um(mm: f64, language: Language) -> String {
    language.digits(mm * 1e3, 2)
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

/// What the circles of a plane say first.
enum Verdict<'t> {
    /// They are no whole circles: sizes of causes count what was read.
    Open { degrees: f64 },
    /// More than any cause makes is explained by none.
    Unexplained,
    /// The largest cause.
    Named(&'t Pattern),
}

impl<'t> Verdict<'t> {
    fn of(test: &'t CircularTest) -> Self {
        let gap_deg = test.traces.iter().map(|t| t.gap_rad.to_degrees()).fold(0.0, f64::max);
        if gap_deg > CLOSED_DEG {
            return Self::Open { degrees: 360.0 - gap_deg };
        }
        match test.patterns.first() {
            Some(p) if p.range_mm > p.half_width_95_mm && p.range_mm > test.left_mm => Self::Named(p),
            _ => Self::Unexplained,
        }
    }

    fn word(&self) -> Text {
        match self {
            Self::Open { .. } => Text::pair("PARTIAL CIRCLE", "НЕПОЛНАЯ ОКРУЖНОСТЬ"),
            Self::Unexplained => Text::pair("NO CAUSE", "НЕТ ПРИЧИНЫ"),
            Self::Named(p) => match p.cause {
                Cause::Squareness => Text::pair("SQUARENESS", "ПЕРПЕНДИКУЛЯРНОСТЬ"),
                Cause::Mismatch => Text::pair("SCALE MISMATCH", "РАЗНЫЙ МАСШТАБ"),
                Cause::Backlash(_) => Text::pair("BACKLASH", "ЛЮФТ"),
            },
        }
    }

    /// Behind the size of the deviation.
    fn goes_on(&self, plane: usize, language: Language) -> String {
        match self {
            Self::Open { degrees } => say!(
                language,
                " over the {} degrees that were read",
                " на измеренных {}°",
                language.digits(*degrees, 0)
            ),
            Self::Unexplained => say!(
                language,
                "; no cause explains most of it",
                "; большей части не объясняет ни одна причина"
            ),
            Self::Named(p) => say!(
                language,
                "; the largest cause, {}, makes {} \u{b5}m (\u{b1} {}, 95\u{a0}%)",
                "; главная причина, {:#}, даёт {} мкм (\u{b1} {}, 95\u{a0}%)",
                cause_name(p.cause, plane),
                um(p.range_mm, language),
                um(p.half_width_95_mm, language)
            ),
        }
    }

    /// What to do.
    fn remedy(&self) -> Text {
        match self {
            Self::Open { .. } => Text::pair(
                "Read whole circles before judging by the sizes of the causes: part of a circle lies about a circle of its own.",
                "Прежде чем судить по величине причин, снимите полные окружности: часть окружности ложится на свою собственную.",
            ),
            Self::Unexplained => Text::pair(
                "Read circles both ways round with the direction of every reading, and look at straightness, pitch of the screws and servo: a bar that sees none of squareness, scale and backlash sees one of those, or its own noise.",
                "Снимите окружности в обе стороны с направлением каждого отсчёта и проверьте прямолинейность, шаг винтов и приводы: если измеритель не видит ни перпендикулярности, ни масштаба, ни люфта, он видит одно из этого или собственный шум.",
            ),
            Self::Named(p) => match p.cause {
                Cause::Squareness => Text::pair(
                    "Align the axes, or correct by a profile: a squareness stays what it is until something is moved.",
                    "Выверьте оси или исправляйте по профилю: отклонение от перпендикулярности не меняется, пока ничего не сдвинуто.",
                ),
                Cause::Mismatch => Text::pair(
                    "A bar does not say which of the two axes is too long: measure the positioning of both with an interferometer before correcting.",
                    "Которая из двух осей длиннее, измеритель не говорит: прежде чем исправлять, измерьте позиционирование обеих интерферометром.",
                ),
                Cause::Backlash(_) => Text::pair(
                    "Look at nut, bearings and the control's own backlash value first; what repeats of it a profile corrects.",
                    "Сначала проверьте гайку, подшипники и значение люфта в самом ЧПУ; то, что повторяется, исправит профиль.",
                ),
            },
        }
    }
}

/// Curves of the base below this are rounding, mm.
const CURVES_MM: f64 = 5e-5;

/// What a profile holds of a plane's causes.
fn held(test: &CircularTest) -> Text {
    if test.curves_mm > CURVES_MM {
        Text::pair(
            "squareness, backlash and the base's own curves",
            "отклонение от перпендикулярности, люфт и собственные кривые исходного профиля",
        )
    } else {
        Text::pair("squareness and backlash", "отклонение от перпендикулярности и люфт")
    }
}

/// The first screen.
fn head(bars: &Bars<'_>, facts: &Facts, language: Language) -> Markup {
    html! {
        p.muted { (say!(language, "Ball bar: ", "Телескопический измеритель: ")) (shown(&facts.names())) }
        @if let Some(test) = worst(bars) {
            @let verdict = Verdict::of(test);
            p { span.verdict { (verdict.word().in_language(language)) } }
            h1 {
                @let symbol = if test.bidirectional_mm.is_some() { "G(b)" } else { "G" };
                (say!(
                    language,
                    "Circles in {} deviate by {symbol} = {} \u{b5}m",
                    "Отклонение окружностей в плоскости {}: {symbol} = {} мкм",
                    PLANES[test.plane].0,
                    um(whole_mm(test), language)
                ))
                (verdict.goes_on(test.plane, language))
            }
            p { (verdict.remedy().in_language(language)) }
            p {
                (say!(
                    language,
                    "With {} corrected, which is what a profile holds, circles in {} would deviate by {} \u{b5}m; no cause explains {} \u{b5}m of them. This is said by the same circles: measure again after the correction to prove it.",
                    "Если исправить то, что хранит профиль ({:#}), отклонение окружностей в плоскости {} будет {} мкм; из них {} мкм не объясняет ни одна причина. Это говорят те же окружности: чтобы доказать, измерьте снова после исправления.",
                    held(test),
                    PLANES[test.plane].0,
                    um(test.corrected_mm, language),
                    um(test.left_mm, language)
                ))
            }
        }
        @if let (None, Some(found)) = (worst(bars), bars.rotary) { (rotary_head(found, language)) }
        @match &facts.written {
            Some(path) => p { (super::written_to(&file::name(path), language)) },
            None => p.muted { (super::NOT_WRITTEN.in_language(language)) },
        }
    }
}

fn rotary_head(found: &RotaryCalibration, language: Language) -> Markup {
    let lengths = found.locations.iter().filter(|f| f.location.is_length);
    html! {
        p { span.verdict { (say!(language, "LOCATION ERRORS", "ПОЛОЖЕНИЕ ОСЕЙ")) } }
        @if let Some(f) = lengths.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs())) {
            h1 {
                (say!(
                    language,
                    "The axis of {} lies beside its place: {} = {} \u{b5}m (\u{b1} {}, 95\u{a0}%)",
                    "Ось {} лежит не на своём месте: {} = {} мкм (\u{b1} {}, 95\u{a0}%)",
                    f.location.axis,
                    f.location.name(),
                    um(f.value, language),
                    um(f.half_width_95, language)
                ))
            }
        }
        p {
            (say!(
                language,
                "A profile with these values corrects them wherever the axes turn; the others are below.",
                "Профиль с этими значениями исправляет их при любом повороте осей; остальные ниже."
            ))
        }
    }
}

/// Ids of the planes' sections.
const OF_PLANES: [&str; 3] = ["xy", "zx", "yz"];

fn circles_in(plane: usize) -> Text {
    both!("Circles in {}", "Окружности в плоскости {}", PLANES[plane].0)
}

fn sections(bars: &Bars<'_>, language: Language) -> Vec<Section> {
    let mut out = Vec::new();
    if let Some((found, names)) = bars.circles {
        for test in &found.tests {
            let (id, title) = (OF_PLANES[test.plane], circles_in(test.plane));
            out.push(Section { id, title, body: plane(test, names, language) });
        }
        out.push(Section {
            id: "together",
            title: Text::pair("What the circles say together", "Что говорят все окружности вместе"),
            body: together(found, language),
        });
    }
    if let Some(found) = bars.rotary {
        out.push(Section {
            id: "locations",
            title: Text::pair("Location errors", "Погрешности положения осей"),
            body: locations(found, language),
        });
    }
    out
}

fn plane(test: &CircularTest, names: &[String], language: Language) -> Markup {
    html! {
        div.side { (whole(test, language)) div { (figures(test, language)) } }
        (folded(language, &readings(test, language)))
        (not_drawn(test, names, language))
        h3 { (say!(language, "Causes, each on its own", "Причины по отдельности")) }
        (patterns(test, language))
        h3 { (say!(language, "Runs", "Проходы")) }
        (runs(test, names, language))
    }
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

/// What was read about the least-squares circle, and what was fitted.
fn whole(test: &CircularTest, language: Language) -> Markup {
    let axes = PLANES[test.plane].1;
    let radius = test.radius_mm * 1e3;
    let largest = points(test).map(|p| p.deviation_mm.abs().max(p.fitted_mm.abs())).fold(0.0, f64::max) * 1e3;
    let m = Magnification::of(largest, radius);
    let mut senses: Vec<Sense> = test.traces.iter().map(|t| t.sense).collect();
    senses.sort();
    senses.dedup();
    let mut keys: Vec<(&'static str, String)> =
        senses.iter().map(|s| (class(*s).1, sense_name(*s).in_language(language).to_owned())).collect();
    keys.push(("k2", say!(language, "dashed: what the causes found make", "штрих: вклад найденных причин")));
    let read = test.traces.iter().map(|t| curve(t, class(t.sense).0, &|p| p.deviation_mm));
    let fitted = test.traces.iter().map(|t| curve(t, "fit s2", &|p| p.fitted_mm));
    let drawn = Polar { axes, radius, curves: read.chain(fitted).collect(), keys };
    let times = language.number(m.times);
    let described = say!(
        language,
        "deviations from the least-squares circle, drawn {times} times larger than the circle",
        "отклонения от средней окружности, увеличение {times}\u{d7}"
    );
    let caption = say!(
        language,
        "Deviation from the least-squares circle of each run (radius {} mm), drawn {times} times larger than the circle; a ring is {} \u{b5}m.",
        "Отклонение от средней окружности каждого прохода (радиус {} мм), увеличение {times}\u{d7}; шаг колец {} мкм.",
        language.digits(test.radius_mm, 1),
        language.number(m.ring)
    );
    let title = circles_in(test.plane);
    let title = title.in_language(language);
    let unit = MICROMETRES.in_language(language);
    figure(language, &polar(language, title, &described, &drawn, m, unit), &caption, None)
}

/// Every reading, and what the causes add to it.
fn readings(test: &CircularTest, language: Language) -> Markup {
    let rows: Vec<Vec<String>> = test
        .traces
        .iter()
        .flat_map(|t| t.points.iter().map(move |p| (t.sense, p)))
        .map(|(sense, p)| {
            let sense = sense_name(sense).in_language(language).to_owned();
            let mut row = vec![language.digits(p.angle_rad.to_degrees(), 1), sense];
            row.extend([p.read_mm, p.deviation_mm, p.fitted_mm].map(|mm| um(mm, language)));
            row.extend(p.causes_mm.iter().map(|c| um(*c, language)));
            row
        })
        .collect();
    let causes: Vec<Text> = test.patterns.iter().map(|p| cause_name(p.cause, test.plane)).collect();
    let header = match language {
        Language::English => ["angle, degrees", "direction", "read, \u{b5}m", "deviation", "fitted"],
        Language::Russian => ["угол, градусы", "направление", "отсчёт, мкм", "отклонение", "подгонка"],
    };
    let header: Vec<&str> =
        header.into_iter().chain(causes.iter().map(|cause| cause.in_language(language))).collect();
    let numbers: Vec<usize> = std::iter::once(0).chain(2..header.len()).collect();
    table(language, &header, &numbers, &rows)
}

/// What the readings do not show.
fn not_drawn(test: &CircularTest, names: &[String], language: Language) -> Markup {
    let open = |t: &&Trace| t.gap_rad.to_degrees() > CLOSED_DEG;
    html! {
        @for t in test.traces.iter().filter(open) {
            p {
                (say!(
                    language,
                    "Run {}, {}, covers {} degrees of the circle: nothing is drawn where nothing was read, and G and the sizes of causes count what was read alone.",
                    "Проход {}, {:#}, охватывает {}° окружности: где отсчётов нет, ничего не нарисовано, а G и величины причин относятся только к измеренному.",
                    shown(names.get(t.run).map_or("", String::as_str)),
                    sense_name(t.sense),
                    language.digits(360.0 - t.gap_rad.to_degrees(), 0)
                ))
            }
        }
        @if test.bidirectional_mm.is_none() {
            p {
                @if test.traces.iter().all(|t| t.sense == Sense::Unknown) {
                    (say!(
                        language,
                        "No reading says which way round it was taken (dir_x, dir_y, dir_z, or dir): G(b), H and backlash are not known.",
                        "Ни один отсчёт не говорит, в какую сторону он снят (dir_x, dir_y, dir_z или dir): G(b), H и люфт неизвестны."
                    ))
                } @else if test.is_centred_apart() {
                    (CENTRED_APART.in_language(language)) "."
                } @else {
                    (say!(
                        language,
                        "Circles in one direction only: G(b) and H need both.",
                        "Окружности только в одну сторону: для G(b) и H нужны обе."
                    ))
                }
            }
        } @else if test.hysteresis.is_none() {
            p {
                (say!(
                    language,
                    "Both directions were not read at neighbouring angles: H is not known.",
                    "Обе стороны не сняты на соседних углах: H неизвестен."
                ))
            }
        }
    }
}

/// ISO 230-4.
fn figures(test: &CircularTest, language: Language) -> Markup {
    let row = |symbol: &str, value: String, words: String| vec![symbol.to_owned(), value, words];
    let mut rows = Vec::new();
    for sense in [Sense::CounterClockwise, Sense::Clockwise, Sense::Unknown] {
        let own = test.traces.iter().filter(|t| t.sense == sense).map(|t| t.circularity_mm);
        if let Some(largest) = own.reduce(f64::max) {
            let words =
                say!(language, "circular deviation, {}", "круговое отклонение, {:#}", sense_name(sense));
            rows.push(row("G", um(largest, language), words));
        }
    }
    if let Some(both) = test.bidirectional_mm {
        let words =
            say!(language, "circular deviation, both directions", "круговое отклонение, в обе стороны");
        rows.push(row("G(b)", um(both, language), words));
    }
    if let Some(h) = test.hysteresis {
        let words = say!(
            language,
            "circular hysteresis, at {} degrees",
            "круговой гистерезис, на {}°",
            language.digits(h.angle_rad.to_degrees(), 1)
        );
        rows.push(row("H", um(h.value_mm, language), words));
    }
    let [least, largest] = test.radial_mm.map(|mm| um(mm, language));
    let words = say!(language, "least radial deviation", "наименьшее радиальное отклонение");
    rows.push(row("F\u{a0}min", least, words));
    let words = say!(language, "largest radial deviation", "наибольшее радиальное отклонение");
    rows.push(row("F\u{a0}max", largest, words));
    html! {
        (table(language, &["", MICROMETRES.in_language(language), "ISO 230-4"], &[1], &rows))
        p.muted {
            (say!(
                language,
                "About the least-squares circle; F counts from the length that the bar states.",
                "Относительно средней окружности; F отсчитывается от длины, названной измерителем."
            ))
        }
    }
}

/// What a ball beside its place and a bar of another length make: on a scale of its own, for it may be of any size.
fn set_up(test: &CircularTest, language: Language) -> Markup {
    let (_, axes) = PLANES[test.plane];
    let radius = test.radius_mm * 1e3;
    let m =
        Magnification::of(points(test).fold(0.0, |most: f64, p| most.max(p.set_up_mm().abs())) * 1e3, radius);
    let curves = test.traces.iter().map(|t| curve(t, class(t.sense).0, &CirclePoint::set_up_mm)).collect();
    let drawn = Polar { axes, radius, curves, keys: Vec::new() };
    let caption = say!(
        language,
        "no cause in the machine: the set-up's centre and length, {} \u{b5}m, drawn {} times larger",
        "не причина в станке: центр и длина установки, {} мкм, увеличение {}\u{d7}",
        um(test.set_up_mm, language),
        language.number(m.times)
    );
    let title = say!(language, "Set-up: centre and length", "Установка: центр и длина");
    let unit = MICROMETRES.in_language(language);
    figure(language, &polar(language, &title, &caption, &drawn, m, unit), &caption, None)
}

/// Each cause as a plot of its own, all on one scale, and their sizes.
fn patterns(test: &CircularTest, language: Language) -> Markup {
    let (_, axes) = PLANES[test.plane];
    let radius = test.radius_mm * 1e3;
    let parts = points(test).flat_map(|p| &p.causes_mm);
    let m = Magnification::of(parts.fold(0.0, |most: f64, v| most.max(v.abs())) * 1e3, radius);
    let sum_mm = test.sum_of_patterns_mm();
    let share = |mm: f64| language.percent(if sum_mm > 0.0 { mm / sum_mm } else { 0.0 });
    let one = |(k, p): (usize, &Pattern)| {
        let curves = test.traces.iter().map(|t| curve(t, class(t.sense).0, &|p| p.causes_mm[k])).collect();
        let name = cause_name(p.cause, test.plane);
        let drawn = Polar { axes, radius, curves, keys: Vec::new() };
        let size = um(p.range_mm, language);
        let described = say!(
            language,
            "{size} \u{b5}m from the innermost to the outermost",
            "{size} мкм между крайними точками"
        );
        let (name, unit) = (name.in_language(language), MICROMETRES.in_language(language));
        let caption = format!("{name}: {size} {unit}");
        figure(language, &polar(language, name, &described, &drawn, m, unit), &caption, None)
    };
    let row = |p: &Pattern| {
        vec![
            cause_name(p.cause, test.plane).in_language(language).to_owned(),
            um(p.range_mm, language),
            um(p.half_width_95_mm, language),
            share(p.range_mm),
            um(p.without_mm, language),
        ]
    };
    let rows: Vec<Vec<String>> = test.patterns.iter().map(row).collect();
    let header = match language {
        Language::English => {
            ["cause", "makes, \u{b5}m", "\u{b1} 95 %, \u{b5}m", "share", "G(b) without it, \u{b5}m"]
        }
        Language::Russian => ["причина", "даёт, мкм", "\u{b1} 95 %, мкм", "доля", "G(b) без неё, мкм"],
    };
    html! {
        div.side {
            @for part in test.patterns.iter().enumerate() { (one(part)) }
            (set_up(test, language))
        }
        p.muted {
            (say!(
                language,
                "Causes are drawn {} times larger than the circle; a ring is {} \u{b5}m. Shares are of the sum of what the causes make.",
                "Причины нарисованы с увеличением {}\u{d7}; шаг колец {} мкм. Доли — от суммы вкладов причин.",
                language.number(m.times),
                language.number(m.ring)
            ))
        }
        (table(language, &header, &[1, 2, 3, 4], &rows))
        @if test.curves_mm > CURVES_MM {
            p.muted {
                (say!(
                    language,
                    "The base's own curves and effects make {} \u{b5}m.",
                    "Собственные кривые и эффекты исходного профиля дают {} мкм.",
                    um(test.curves_mm, language)
                ))
            }
        }
        p.muted {
            (say!(
                language,
                "{} \u{b5}m of the deviations, noise with it, no cause explains.",
                "{} мкм отклонений, вместе с шумом, не объясняет ни одна причина.",
                um(test.left_mm, language)
            ))
        }
    }
}

fn runs(test: &CircularTest, names: &[String], language: Language) -> Markup {
    let [first, second] = PLANES[test.plane].1;
    let row = |t: &Trace| {
        let mut row = vec![
            names.get(t.run).cloned().unwrap_or_default(),
            sense_name(t.sense).in_language(language).to_owned(),
            language.count(t.points.len()),
        ];
        row.extend(
            [t.circularity_mm, t.centre_mm[0], t.centre_mm[1], t.excess_mm].map(|mm| um(mm, language)),
        );
        row
    };
    let rows: Vec<Vec<String>> = test.traces.iter().map(row).collect();
    let centre = [first, second].map(|axis| say!(language, "ball {axis}, \u{b5}m", "шарик {axis}, мкм"));
    let header = match language {
        Language::English => {
            ["run", "direction", "readings", "G, \u{b5}m", &centre[0], &centre[1], "radius, \u{b5}m"]
        }
        Language::Russian => {
            ["проход", "направление", "отсчётов", "G, мкм", &centre[0], &centre[1], "радиус, мкм"]
        }
    };
    html! {
        (table(language, &header, &[2, 3, 4, 5, 6], &rows))
        p.muted {
            (say!(
                language,
                "Ball: where the circle finds the fixed ball, against where it was stated. Radius: of the least-squares circle, against the commanded one. Both are the set-up's and not the machine's.",
                "Шарик: где окружность находит неподвижный шарик относительно указанного места. Радиус: средней окружности относительно заданного. То и другое относится к установке, а не к станку."
            ))
        }
    }
}

/// A table of fitted values; what the base has of them where it has any.
fn terms(rows: &[[String; 5]], language: Language) -> Markup {
    let with_base = rows.iter().any(|row| row[3].chars().any(|c| c.is_ascii_digit() && c != '0'));
    let header = match language {
        Language::English => ["", "value", "\u{b1} 95 %", "of it in the base", "unit"],
        Language::Russian => ["", "значение", "\u{b1} 95 %", "из него в исходном", "единица"],
    };
    let kept = |k: &usize| with_base || *k != 3;
    let columns: Vec<usize> = (0..header.len()).filter(kept).collect();
    let header: Vec<&str> = columns.iter().map(|k| header[*k]).collect();
    let row = |row: &[String; 5]| columns.iter().map(|k| row[*k].clone()).collect();
    let numbers: Vec<usize> = (1..header.len() - 1).collect();
    table(language, &header, &numbers, &rows.iter().map(row).collect::<Vec<_>>())
}

fn together(found: &CircleCalibration, language: Language) -> Markup {
    let mut rows = Vec::new();
    let mut put = |name: String, term: Option<Term>, scale: f64, unit: Text| {
        if let Some(t) = term {
            let [value, half, base] =
                [t.value, t.half_width_95, t.base].map(|v| language.digits(v * scale, 2));
            rows.push([name, value, half, base, unit.in_language(language).to_owned()]);
        }
    };
    for (name, term) in SQUARENESS.into_iter().zip(found.squareness_rad) {
        put(name.to_owned(), term, 1e6, Text::pair("\u{b5}rad", "мкрад"));
    }
    for (name, term) in super::super::bar_report::SCALES.into_iter().zip(found.mismatch) {
        put(say!(language, "scale {name}", "масштаб {name}"), term, 1e6, Text::pair("\u{b5}m/m", "мкм/м"));
    }
    let closure = say!(language, "closure of the scales", "сумма масштабов");
    put(closure, found.closure, 1e6, Text::pair("\u{b5}m/m", "мкм/м"));
    for (axis, term) in ["X", "Y", "Z"].into_iter().zip(found.backlash_mm) {
        put(say!(language, "backlash {axis}", "люфт {axis}"), term, 1e3, Text::pair("\u{b5}m", "мкм"));
    }
    html! {
        p {
            (say!(
                language,
                "{} readings of all planes in one adjustment; {} \u{b5}m left (standard deviation).",
                "Отсчётов всех плоскостей в одном уравнивании: {}; остаток {} мкм (стандартное отклонение).",
                language.count(found.estimate.residuals.len()),
                um(found.estimate.sigma, language)
            ))
        }
        (terms(&rows, language))
        p.muted {
            (say!(
                language,
                "A bar sees one scale against another, never both: a common scale looks like a longer bar. The three scales of a machine add up to 0.",
                "Измеритель видит один масштаб относительно другого, но не оба: общий масштаб выглядит как более длинный измеритель. Сумма трёх масштабов станка — 0."
            ))
        }
    }
}

fn locations(found: &RotaryCalibration, language: Language) -> Markup {
    let row = |f: &calibration::rotary_ballbar::Found| {
        let (scale, unit) = if f.location.is_length {
            (1e3, Text::pair("\u{b5}m", "мкм"))
        } else {
            (1e6, Text::pair("\u{b5}rad", "мкрад"))
        };
        let [value, half, base] = [f.value, f.half_width_95, f.base].map(|v| language.digits(v * scale, 3));
        [f.location.name(), value, half, base, unit.in_language(language).to_owned()]
    };
    let rows: Vec<[String; 5]> = found.locations.iter().map(row).collect();
    html! {
        p {
            (say!(
                language,
                "{} readings, {} \u{b5}m left (standard deviation). A table that turns under a bar draws no circle of two axes: there is no polar plot of these runs.",
                "Отсчётов {}, остаток {} мкм (стандартное отклонение). Стол, который поворачивается под измерителем, не чертит окружности двумя осями: полярной диаграммы этих проходов нет.",
                language.count(found.estimate.residuals.len()),
                um(found.estimate.sigma, language)
            ))
        }
        (terms(&rows, language))
    }
}
