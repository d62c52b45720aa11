//! What to measure next: the cheap line that best tells a cause from its rival.

use diagnostic::{Text, both};
use machine_model::Vector;
use nalgebra::DMatrix;

use crate::equations::columns::Source;
use crate::equations::gram::Gram;
use crate::equations::linear::Factor;
use crate::equations::observation::{Measurements, Reading, Row};
use crate::equations::term::Term;
use crate::judgement::answer::NextMeasurement;
use crate::library::candidates::Part;
use crate::search::explanation::Explanation;
use crate::search::moves::without;

/// Points of a proposed line, each way.
const POINTS: usize = 21;

/// A line that could be measured.
pub(crate) struct Line {
    /// In words.
    pub text: Text,
    /// Its rows; the readings do not count.
    pub rows: Vec<Row>,
}

/// Most rivals that one line is asked to tell from a cause.
const RIVALS: usize = 4;
/// So many standard deviations apart two effects are told for certain, and more is worth nothing.
const CERTAIN: f64 = 12.0;

/// The cheapest line that tells a part of the model from its rivals, the worst first; `noise_um` is the noise of a reading.
pub(crate) fn next_measurement(
    data: &Measurements,
    model: &Explanation,
    open: Option<(usize, Vec<Part>)>,
    noise_um: f64,
) -> Option<NextMeasurement> {
    let (place, mut rivals) = open?;
    rivals.truncate(RIVALS);
    let mut columns = model.library.model_columns(&without(&model.parts, place));
    let others = columns.len();
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for rival in &rivals {
        let own = &model.library.form(*rival).columns;
        sets.push((0..others).chain(columns.len()..columns.len() + own.len()).collect());
        columns.extend(own);
    }
    let own = columns.len();
    columns.extend(&model.library.form(model.parts[place]).columns);
    let values = &model.solution.coefficients[model.library.positions(&model.parts, place)];
    let terms: Vec<Term> = columns.iter().map(|c| model.library.terms[*c]).collect();
    let (known, _) = model.space.gram.select(&columns).whitened(model.solution.rho);
    let apart = |products: &DMatrix<f64>| -> Vec<f64> {
        sets.iter().map(|set| separation(products, set, own, values, noise_um)).collect()
    };
    let worth = |sigmas: &[f64]| sigmas.iter().map(|sigma| sigma.min(CERTAIN)).sum::<f64>();
    let now = apart(&known);
    let mut best: Option<(Vec<f64>, Line)> = None;
    for line in lines(data) {
        let mut runs = data.runs.clone();
        runs.push("next".to_owned());
        let extra = Measurements { runs, rows: line.rows.clone(), ..data.clone() };
        let scalars = extra.scalars(None);
        let (fresh, _) =
            Gram::new(terms.clone(), &Source::new(&extra, &scalars)).whitened(model.solution.rho);
        let sigmas = apart(&(&known + fresh));
        let better = |(than, _): &(Vec<f64>, Line)| {
            let (new, old) = (worth(&sigmas), worth(than));
            new > 1.05 * old || (new > 0.95 * old && sigmas[0] > 1.05 * than[0])
        };
        if best.as_ref().is_none_or(better) {
            best = Some((sigmas, line));
        }
    }
    let (sigmas, line) = best?;
    let name = |part: Part| model.library.kind(part).to_string();
    let told: Vec<usize> = (0..rivals.len()).filter(|r| sigmas[*r] >= now[*r] + 1.0).collect();
    let cause = name(model.parts[place]);
    let Some(first) = told.first() else {
        let rival = name(rivals[0]);
        let text = both!(
            "No simple line tells {cause} from {rival}: a different kind of measurement is needed.",
            "Ни одна простая линия не отличит {cause} от {rival}: нужно измерение другого рода."
        );
        return Some(NextMeasurement {
            text,
            separates: [cause, rival].map(Text::same).to_vec(),
            expected_sigma: sigmas[0],
            rows: line.rows,
        });
    };
    let names: Vec<String> = told.iter().map(|r| name(rivals[*r])).collect();
    let (what, names) = (&line.text, names.join(", "));
    let text = both!(
        "Measure {what}: it tells {cause} from {names}.",
        "Измерьте {what:#}: это отличит {cause} от {names}."
    );
    let expected_sigma = told.iter().map(|r| sigmas[*r]).fold(f64::INFINITY, f64::min);
    let separates = [cause, name(rivals[*first])].map(Text::same).to_vec();
    Some(NextMeasurement { text, separates, expected_sigma, rows: line.rows })
}

/// Where no effect explains a gap: the line on which all axes move, so that what has no name comes back there or does not.
pub(crate) fn once_more(data: &Measurements) -> Option<NextMeasurement> {
    let line = lines(data).into_iter().find(|line| line.text.english().starts_with("the body diagonal"))?;
    let line =
        Line { rows: line.rows.into_iter().map(|r| Row { run: data.runs.len(), ..r }).collect(), ..line };
    let text = both!(
        "Measure {what}, and once more from its other end: what no effect explains must come back there.",
        "Измерьте {what:#} и ещё раз с другого конца: необъяснённое должно там повториться.",
        what = line.text
    );
    let separates =
        vec![Text::pair("what has no name", "то, у чего нет названия,"), Text::pair("chance", "случайность")];
    // Back and forth from one end, then from the other.
    let (there, back) = line.rows.split_at(line.rows.len() / 2);
    let again = back.iter().chain(there).map(|row| Row { run: row.run + 1, ..*row });
    let rows = line.rows.iter().copied().chain(again).collect();
    Some(NextMeasurement { text, separates, expected_sigma: 0.0, rows })
}

/// Length of what some columns cannot imitate of the last ones' displacement, from `own` on; standard deviations.
fn separation(
    products: &DMatrix<f64>,
    imitators: &[usize],
    own: usize,
    values: &[f64],
    noise_um: f64,
) -> f64 {
    let squares: Vec<f64> = (0..products.nrows()).map(|i| products[(i, i)]).collect();
    let with = |i: usize| -> f64 { values.iter().enumerate().map(|(k, v)| v * products[(i, own + k)]).sum() };
    let square: f64 = values.iter().enumerate().map(|(k, v)| v * with(own + k)).sum();
    let factor = Factor::new(products, imitators, &squares);
    let b: Vec<f64> = factor.kept.iter().map(|k| with(*k)).collect();
    let imitated: f64 = factor.forward(&b).iter().map(|v| v * v).sum();
    (square - imitated).max(0.0).sqrt() / noise_um.max(1e-9)
}

/// Cheap lines inside the measured box, the simplest first.
pub(crate) fn lines(data: &Measurements) -> Vec<Line> {
    let Some(typical) = data.rows.get(data.rows.len() / 2).copied() else { return Vec::new() };
    let time = data.rows.iter().filter_map(|r| r.conditions.time_s).max_by(f64::total_cmp);
    let unread = Row::new(data.runs.len(), typical.command, Reading::Displacement([Some(0.0); 3]));
    let base = Row {
        conditions: machine_model::effects::Conditions {
            time_s: time.map(|t| t + 60.0),
            share: None,
            since_turn_mm: [None; 3],
            curvature_per_mm: None,
            ..typical.conditions
        },
        line: typical.line,
        ..unread
    };
    let plain = ends(data);
    let mut lines = Vec::new();
    for (text, from, to) in &plain {
        lines.push(Line {
            text: both!("{text}, both ways", "{text:#}, туда и обратно"),
            rows: both_ways(*from, *to, &base),
        });
    }
    let mut vary = |words: &Text, changed: &Row| {
        for (text, from, to) in &plain {
            lines.push(Line {
                text: both!("{text}, both ways, {words}", "{text:#}, туда и обратно, {words:#}"),
                rows: both_ways(*from, *to, changed),
            });
        }
    };
    let c = base.conditions;
    if let Some(feed) = c.feed_mm_min {
        let other = if feed > 1500.0 { feed / 4.0 } else { feed * 4.0 };
        let mut changed = base;
        changed.conditions.feed_mm_min = Some(other);
        vary(&both!("at {other:.0} mm/min", "на подаче {other:.0} мм/мин"), &changed);
    }
    let mut changed = base;
    changed.command.tool_mm.z -= 100.0;
    vary(&Text::pair("with a tool 100 mm longer", "с инструментом длиннее на 100 мм"), &changed);
    changed.command.tool_mm = base.command.tool_mm + Vector::new(80.0, 0.0, 0.0);
    vary(&Text::pair("with the target 80 mm aside in X", "с отражателем в стороне на 80 мм по X"), &changed);
    // Angles about all three directions show at once.
    changed.command.tool_mm = base.command.tool_mm + Vector::new(80.0, 80.0, -100.0);
    vary(
        &Text::pair(
            "with the target 80 mm aside in X and in Y, on a tool 100 mm longer",
            "с отражателем в стороне на 80 мм по X и по Y, на инструменте длиннее на 100 мм",
        ),
        &changed,
    );
    if let Some(time) = time {
        let mut changed = base;
        changed.conditions.time_s = Some(3.0 * time);
        let minutes = 3.0 * time / 60.0;
        vary(&both!("again after {minutes:.0} min", "ещё раз через {minutes:.0} мин"), &changed);
    }
    if c.temp_c.iter().any(Option::is_some) {
        let mut changed = base;
        changed.conditions.temp_c = c.temp_c.map(|t| t.map(|t| t + 4.0));
        vary(&Text::pair("4 degrees warmer", "при температуре на 4 °C выше"), &changed);
    }
    if let Some(load) = c.load_kg {
        let mut changed = base;
        changed.conditions.load_kg = Some(load + 100.0);
        vary(&Text::pair("with 100 kg more load", "с нагрузкой больше на 100 кг"), &changed);
    }
    lines
}

/// Lines along the axes and their diagonals in the measured box: in words, from where, to where.
fn ends(data: &Measurements) -> Vec<(Text, Vector, Vector)> {
    let range = [0, 1, 2].map(|a| data.range_mm(a));
    let travels: Vec<usize> = (0..3).filter(|a| range[*a].1 > range[*a].0).collect();
    let at = |share: f64| Vector::from_fn(|a, _| range[a].0 + share * (range[a].1 - range[a].0));
    let (low, middle, high) = (at(0.0), at(0.5), at(1.0));
    let name = |a: usize| ["X", "Y", "Z"][a];
    let mut all: Vec<(Text, Vector, Vector)> = Vec::new();
    for place in [middle, low, high] {
        for a in &travels {
            let (mut from, mut to) = (place, place);
            (from[*a], to[*a]) = (low[*a], high[*a]);
            let others: Vec<String> =
                (0..3).filter(|b| b != a).map(|b| format!("{} {:.0}", name(b), place[b])).collect();
            let (along, others) = (name(*a), others.join(", "));
            all.push((
                both!("a line along {along} at {others}", "линию вдоль {along} при {others}"),
                from,
                to,
            ));
        }
    }
    for (i, a) in travels.iter().enumerate() {
        for b in travels.iter().skip(i + 1) {
            let (mut from, mut to) = (middle, middle);
            (from[*a], to[*a], from[*b], to[*b]) = (low[*a], high[*a], low[*b], high[*b]);
            let plane = format!("{}{}", name(*a), name(*b));
            all.push((both!("the diagonal in {plane}", "диагональ в плоскости {plane}"), from, to));
            (from[*b], to[*b]) = (high[*b], low[*b]);
            all.push((
                both!("the other diagonal in {plane}", "другую диагональ в плоскости {plane}"),
                from,
                to,
            ));
        }
    }
    all.push((Text::pair("the body diagonal", "объёмную диагональ"), low, high));
    all
}

fn both_ways(from: Vector, to: Vector, base: &Row) -> Vec<Row> {
    let row = |share: f64, sign: f64| {
        let mut row = *base;
        row.command.linear_mm = from + (to - from) * share;
        row.command.direction = std::array::from_fn(|a| {
            let step = sign * (to[a] - from[a]);
            if step > 0.0 {
                1
            } else if step < 0.0 {
                -1
            } else {
                0
            }
        });
        row
    };
    // Uneven steps: an even one cannot tell a screw's period from a curve.
    let share = |k: usize| {
        let uneven = if k == 0 || k + 1 == POINTS { 0.0 } else { (k as f64 * 0.618_034).fract() - 0.5 };
        (k as f64 + 0.6 * uneven) / (POINTS - 1) as f64
    };
    (0..POINTS).map(|k| row(share(k), 1.0)).chain((0..POINTS).rev().map(|k| row(share(k), -1.0))).collect()
}
