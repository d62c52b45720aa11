//! The page of a ball bar: the polar plot of each plane, its causes one by one, and location errors.

use calibration::circular_test::{Cause, CirclePoint, CircularTest, Pattern, Sense, Trace};
use calibration::linear_ballbar::{CircleCalibration, Term};
use calibration::rotary_ballbar::RotaryCalibration;
use maud::{Markup, html};
use report::chart::{Magnification, Polar, Round, polar};
use report::page::{Section, figure, folded, table};
use report::text::{number, number_of_digits, percent, shown};
use serde_json::Value;

use super::bars::{Bars, PLANES, SQUARENESS, cause_name, sense_name};
use super::bars_csv;
use super::facts::Facts;
use super::found::Found;
use crate::file;

impl Found for Bars<'_> {
    fn title(&self) -> String {
        let planes: Vec<&str> = self.tests().iter().map(|t| PLANES[t.plane].0).collect();
        match planes.as_slice() {
            [] => "Location errors".to_owned(),
            planes => format!("Ball bar {}", planes.join(", ")),
        }
    }

    fn head(&self, facts: &Facts) -> Markup {
        head(self, facts)
    }

    fn sections(&self) -> Vec<Section> {
        sections(self)
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

fn um(mm: f64) -> String {
    number_of_digits(mm * 1e3, 2)
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

    fn word(&self) -> &'static str {
        match self {
            Self::Open { .. } => "PARTIAL CIRCLE",
            Self::Unexplained => "NO CAUSE",
            Self::Named(p) => match p.cause {
                Cause::Squareness => "SQUARENESS",
                Cause::Mismatch => "SCALE MISMATCH",
                Cause::Backlash(_) => "BACKLASH",
            },
        }
    }

    /// Behind the size of the deviation.
    fn goes_on(&self, plane: usize) -> String {
        match self {
            Self::Open { degrees } => {
                format!(" over the {} degrees that were read", number_of_digits(*degrees, 0))
            }
            Self::Unexplained => "; no cause explains most of it".to_owned(),
            Self::Named(p) => format!(
                "; the largest cause, {}, makes {} \u{b5}m (\u{b1} {}, 95\u{a0}%)",
                cause_name(p.cause, plane),
                um(p.range_mm),
                um(p.half_width_95_mm)
            ),
        }
    }

    /// What to do.
    fn remedy(&self) -> &'static str {
        match self {
            Self::Open { .. } => {
                "Read whole circles before judging by the sizes of the causes: part of a circle lies about a circle of its own."
            }
            Self::Unexplained => {
                "Read circles both ways round with the direction of every reading, and look at straightness, pitch of the screws and servo: a bar that sees none of squareness, scale and play sees one of those, or its own noise."
            }
            Self::Named(p) => match p.cause {
                Cause::Squareness => {
                    "Align the axes, or correct by a profile: a squareness stays what it is until something is moved."
                }
                Cause::Mismatch => {
                    "A bar does not say which of the two axes is too long: measure the positioning of both with an interferometer before correcting."
                }
                Cause::Backlash(_) => {
                    "Look at nut, bearings and the control's own backlash value first; what repeats of it a profile corrects."
                }
            },
        }
    }
}

/// Curves of the base below this are rounding, mm.
const CURVES_MM: f64 = 5e-5;

/// What a profile holds of a plane's causes.
fn held(test: &CircularTest) -> &'static str {
    if test.curves_mm > CURVES_MM {
        "squareness, play and the base's own curves"
    } else {
        "squareness and play"
    }
}

/// The first screen.
fn head(bars: &Bars<'_>, facts: &Facts) -> Markup {
    html! {
        p.muted { "Ball bar: " (shown(&facts.names())) }
        @if let Some(test) = worst(bars) {
            @let verdict = Verdict::of(test);
            p { span.verdict { (verdict.word()) } }
            h1 {
                "Circles in " (PLANES[test.plane].0) " deviate by "
                (if test.bidirectional_mm.is_some() { "G(b)" } else { "G" }) " = " (um(whole_mm(test))) " \u{b5}m"
                (verdict.goes_on(test.plane))
            }
            p { (verdict.remedy()) }
            p {
                "With " (held(test)) " corrected, which is what a profile holds, circles in " (PLANES[test.plane].0)
                " would deviate by " (um(test.corrected_mm)) " \u{b5}m; no cause explains " (um(test.left_mm))
                " \u{b5}m of them. This is said by the same circles: measure again after the correction to prove it."
            }
        }
        @if let (None, Some(found)) = (worst(bars), bars.rotary) { (rotary_head(found)) }
        @match &facts.written {
            Some(path) => p { "Written to " (shown(&file::name(path))) "." },
            None => p.muted { "No profile was written: add -o PROFILE.toml to correct by these readings." },
        }
    }
}

fn rotary_head(found: &RotaryCalibration) -> Markup {
    let lengths = found.locations.iter().filter(|f| f.location.is_length);
    html! {
        p { span.verdict { "LOCATION ERRORS" } }
        @if let Some(f) = lengths.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs())) {
            h1 {
                "The axis of " (f.location.axis) " lies beside its place: " (f.location.name()) " = " (um(f.value))
                " \u{b5}m (\u{b1} " (um(f.half_width_95)) ", 95\u{a0}%)"
            }
        }
        p { "A profile with these values corrects them wherever the axes turn; the others are below." }
    }
}

/// Ids and titles of the planes' sections.
const OF_PLANES: [(&str, &str); 3] =
    [("xy", "Circles in XY"), ("zx", "Circles in ZX"), ("yz", "Circles in YZ")];

fn sections(bars: &Bars<'_>) -> Vec<Section> {
    let mut out = Vec::new();
    if let Some((found, names)) = bars.circles {
        for test in &found.tests {
            let (id, title) = OF_PLANES[test.plane];
            out.push(Section { id, title, body: plane(test, names) });
        }
        out.push(Section { id: "together", title: "What the circles say together", body: together(found) });
    }
    if let Some(found) = bars.rotary {
        out.push(Section { id: "locations", title: "Location errors", body: locations(found) });
    }
    out
}

fn plane(test: &CircularTest, names: &[String]) -> Markup {
    html! {
        div.side { (whole(test)) div { (figures(test)) } }
        (folded(&readings(test)))
        (not_drawn(test, names))
        h3 { "Causes, each on its own" }
        (patterns(test))
        h3 { "Runs" }
        (runs(test, names))
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
fn whole(test: &CircularTest) -> Markup {
    let (name, axes) = PLANES[test.plane];
    let radius = test.radius_mm * 1e3;
    let largest = points(test).map(|p| p.deviation_mm.abs().max(p.fitted_mm.abs())).fold(0.0, f64::max) * 1e3;
    let m = Magnification::of(largest, radius);
    let mut senses: Vec<Sense> = test.traces.iter().map(|t| t.sense).collect();
    senses.sort();
    senses.dedup();
    let mut keys: Vec<(&'static str, String)> =
        senses.iter().map(|s| (class(*s).1, sense_name(*s).to_owned())).collect();
    keys.push(("k2", "dashed: what the causes found make".to_owned()));
    let read = test.traces.iter().map(|t| curve(t, class(t.sense).0, &|p| p.deviation_mm));
    let fitted = test.traces.iter().map(|t| curve(t, "fit s2", &|p| p.fitted_mm));
    let drawn = Polar { axes, radius, curves: read.chain(fitted).collect(), keys };
    let times = number(m.times);
    let described =
        format!("deviations from the least-squares circle, drawn {times} times larger than the circle");
    let caption = format!(
        "Deviation from the least-squares circle of each run (radius {} mm), drawn {times} times larger than the circle; a ring is {} \u{b5}m.",
        number_of_digits(test.radius_mm, 1),
        number(m.ring)
    );
    let title = format!("Circles in {name}");
    figure(&polar(&title, &described, &drawn, m, "\u{b5}m"), &caption, None)
}

/// Every reading, and what the causes add to it.
fn readings(test: &CircularTest) -> Markup {
    let rows: Vec<Vec<String>> = test
        .traces
        .iter()
        .flat_map(|t| t.points.iter().map(move |p| (t.sense, p)))
        .map(|(sense, p)| {
            let mut row = vec![number_of_digits(p.angle_rad.to_degrees(), 1), sense_name(sense).to_owned()];
            row.extend([p.read_mm, p.deviation_mm, p.fitted_mm].map(um));
            row.extend(p.causes_mm.iter().map(|c| um(*c)));
            row
        })
        .collect();
    let causes: Vec<String> = test.patterns.iter().map(|p| cause_name(p.cause, test.plane)).collect();
    let header = ["angle, degrees", "direction", "read, \u{b5}m", "deviation", "fitted"];
    let header: Vec<&str> = header.into_iter().chain(causes.iter().map(String::as_str)).collect();
    let numbers: Vec<usize> = std::iter::once(0).chain(2..header.len()).collect();
    table(&header, &numbers, &rows)
}

/// What the readings do not show.
fn not_drawn(test: &CircularTest, names: &[String]) -> Markup {
    let open = |t: &&Trace| t.gap_rad.to_degrees() > CLOSED_DEG;
    html! {
        @for t in test.traces.iter().filter(open) {
            p {
                "Run " (shown(names.get(t.run).map_or("", String::as_str))) ", " (sense_name(t.sense)) ", covers "
                (number_of_digits(360.0 - t.gap_rad.to_degrees(), 0))
                " degrees of the circle: nothing is drawn where nothing was read, and G and the sizes of causes count what was read alone."
            }
        }
        @if test.bidirectional_mm.is_none() {
            p {
                @if test.traces.iter().all(|t| t.sense == Sense::Unknown) {
                    "No reading says which way round it was taken (dir_x, dir_y, dir_z, or dir): G(b), H and backlash are not known."
                } @else {
                    "Circles in one direction only: G(b) and H need both."
                }
            }
        } @else if test.hysteresis.is_none() {
            p { "Both directions were not read at neighbouring angles: H is not known." }
        }
    }
}

/// ISO 230-4.
fn figures(test: &CircularTest) -> Markup {
    let row = |symbol: &str, value: String, words: String| vec![symbol.to_owned(), value, words];
    let mut rows = Vec::new();
    for sense in [Sense::CounterClockwise, Sense::Clockwise, Sense::Unknown] {
        let own = test.traces.iter().filter(|t| t.sense == sense).map(|t| t.circularity_mm);
        if let Some(largest) = own.reduce(f64::max) {
            rows.push(row("G", um(largest), format!("circular deviation, {}", sense_name(sense))));
        }
    }
    if let Some(both) = test.bidirectional_mm {
        rows.push(row("G(b)", um(both), "circular deviation, both directions".to_owned()));
    }
    if let Some(h) = test.hysteresis {
        let words =
            format!("circular hysteresis, at {} degrees", number_of_digits(h.angle_rad.to_degrees(), 1));
        rows.push(row("H", um(h.value_mm), words));
    }
    rows.push(row("F\u{a0}min", um(test.radial_mm[0]), "least radial deviation".to_owned()));
    rows.push(row("F\u{a0}max", um(test.radial_mm[1]), "largest radial deviation".to_owned()));
    html! {
        (table(&["", "\u{b5}m", "ISO 230-4"], &[1], &rows))
        p.muted { "About the least-squares circle; F counts from the length that the bar states." }
    }
}

/// What a ball beside its place and a bar of another length make: on a scale of its own, for it may be of any size.
fn set_up(test: &CircularTest) -> Markup {
    let (_, axes) = PLANES[test.plane];
    let radius = test.radius_mm * 1e3;
    let m =
        Magnification::of(points(test).fold(0.0, |most: f64, p| most.max(p.set_up_mm().abs())) * 1e3, radius);
    let curves = test.traces.iter().map(|t| curve(t, class(t.sense).0, &CirclePoint::set_up_mm)).collect();
    let drawn = Polar { axes, radius, curves, keys: Vec::new() };
    let caption = format!(
        "no cause in the machine: the set-up's centre and length, {} \u{b5}m, drawn {} times larger",
        um(test.set_up_mm),
        number(m.times)
    );
    figure(&polar("Set-up: centre and length", &caption, &drawn, m, "\u{b5}m"), &caption, None)
}

/// Each cause as a plot of its own, all on one scale, and their sizes.
fn patterns(test: &CircularTest) -> Markup {
    let (_, axes) = PLANES[test.plane];
    let radius = test.radius_mm * 1e3;
    let parts = points(test).flat_map(|p| &p.causes_mm);
    let m = Magnification::of(parts.fold(0.0, |most: f64, v| most.max(v.abs())) * 1e3, radius);
    let sum_mm = test.sum_of_patterns_mm();
    let share = |mm: f64| percent(if sum_mm > 0.0 { mm / sum_mm } else { 0.0 });
    let one = |(k, p): (usize, &Pattern)| {
        let curves = test.traces.iter().map(|t| curve(t, class(t.sense).0, &|p| p.causes_mm[k])).collect();
        let name = cause_name(p.cause, test.plane);
        let drawn = Polar { axes, radius, curves, keys: Vec::new() };
        let described = format!("{} \u{b5}m from the innermost to the outermost", um(p.range_mm));
        let caption = format!("{name}: {} \u{b5}m", um(p.range_mm));
        figure(&polar(&name, &described, &drawn, m, "\u{b5}m"), &caption, None)
    };
    let row = |p: &Pattern| {
        vec![
            cause_name(p.cause, test.plane),
            um(p.range_mm),
            um(p.half_width_95_mm),
            share(p.range_mm),
            um(p.without_mm),
        ]
    };
    let rows: Vec<Vec<String>> = test.patterns.iter().map(row).collect();
    let header = ["cause", "makes, \u{b5}m", "\u{b1} 95 %, \u{b5}m", "share", "G(b) without it, \u{b5}m"];
    html! {
        div.side {
            @for part in test.patterns.iter().enumerate() { (one(part)) }
            (set_up(test))
        }
        p.muted {
            "Causes are drawn " (number(m.times)) " times larger than the circle; a ring is " (number(m.ring))
            " \u{b5}m. Shares are of the sum of what the causes make."
        }
        (table(&header, &[1, 2, 3, 4], &rows))
        @if test.curves_mm > CURVES_MM {
            p.muted { "The base's own curves and effects make " (um(test.curves_mm)) " \u{b5}m." }
        }
        p.muted { (um(test.left_mm)) " \u{b5}m of the deviations, noise with it, no cause explains." }
    }
}

fn runs(test: &CircularTest, names: &[String]) -> Markup {
    let [first, second] = PLANES[test.plane].1;
    let row = |t: &Trace| {
        let mut row = vec![
            names.get(t.run).cloned().unwrap_or_default(),
            sense_name(t.sense).to_owned(),
            t.points.len().to_string(),
        ];
        row.extend([t.circularity_mm, t.centre_mm[0], t.centre_mm[1], t.excess_mm].map(um));
        row
    };
    let rows: Vec<Vec<String>> = test.traces.iter().map(row).collect();
    let centre = [first, second].map(|axis| format!("ball {axis}, \u{b5}m"));
    let header = ["run", "direction", "readings", "G, \u{b5}m", &centre[0], &centre[1], "radius, \u{b5}m"];
    html! {
        (table(&header, &[2, 3, 4, 5, 6], &rows))
        p.muted { "Ball: where the circle finds the fixed ball, against where it was stated. Radius: of the least-squares circle, against the commanded one. Both are the set-up's and not the machine's." }
    }
}

/// A table of fitted values; what the base has of them where it has any.
fn terms(rows: &[[String; 5]]) -> Markup {
    let with_base = rows.iter().any(|row| row[3].chars().any(|c| c.is_ascii_digit() && c != '0'));
    let header = ["", "value", "\u{b1} 95 %", "of it in the base", "unit"];
    let kept = |k: &usize| with_base || *k != 3;
    let columns: Vec<usize> = (0..header.len()).filter(kept).collect();
    let header: Vec<&str> = columns.iter().map(|k| header[*k]).collect();
    let row = |row: &[String; 5]| columns.iter().map(|k| row[*k].clone()).collect();
    let numbers: Vec<usize> = (1..header.len() - 1).collect();
    table(&header, &numbers, &rows.iter().map(row).collect::<Vec<_>>())
}

fn together(found: &CircleCalibration) -> Markup {
    let mut rows = Vec::new();
    let mut put = |name: String, term: Option<Term>, scale: f64, unit: &str| {
        if let Some(t) = term {
            let [value, half, base] =
                [t.value, t.half_width_95, t.base].map(|v| number_of_digits(v * scale, 2));
            rows.push([name, value, half, base, unit.to_owned()]);
        }
    };
    for (name, term) in SQUARENESS.into_iter().zip(found.squareness_rad) {
        put(name.to_owned(), term, 1e6, "\u{b5}rad");
    }
    for (name, term) in super::super::bar_report::SCALES.into_iter().zip(found.mismatch) {
        put(format!("scale {name}"), term, 1e6, "\u{b5}m/m");
    }
    put("closure of the scales".to_owned(), found.closure, 1e6, "\u{b5}m/m");
    for (axis, term) in ["X", "Y", "Z"].into_iter().zip(found.backlash_mm) {
        put(format!("backlash {axis}"), term, 1e3, "\u{b5}m");
    }
    html! {
        p {
            (found.estimate.residuals.len()) " readings of all planes in one adjustment; " (um(found.estimate.sigma))
            " \u{b5}m left (standard deviation)."
        }
        (terms(&rows))
        p.muted { "A bar sees one scale against another, never both: a common scale looks like a longer bar. The three scales of a machine add up to 0." }
    }
}

fn locations(found: &RotaryCalibration) -> Markup {
    let row = |f: &calibration::rotary_ballbar::Found| {
        let (scale, unit) = if f.location.is_length { (1e3, "\u{b5}m") } else { (1e6, "\u{b5}rad") };
        let [value, half, base] = [f.value, f.half_width_95, f.base].map(|v| number_of_digits(v * scale, 3));
        [f.location.name(), value, half, base, unit.to_owned()]
    };
    let rows: Vec<[String; 5]> = found.locations.iter().map(row).collect();
    html! {
        p {
            (found.estimate.residuals.len()) " readings, " (um(found.estimate.sigma))
            " \u{b5}m left (standard deviation). A table that turns under a bar draws no circle of two axes: there is no polar plot of these runs."
        }
        (terms(&rows))
    }
}
