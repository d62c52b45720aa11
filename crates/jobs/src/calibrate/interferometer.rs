//! `vpost calibrate interferometer`.

use calibration::functions::{self, refined};
use calibration::iso230_2;
use calibration::measured_line::{AxisOnNodes, Gauge, Zero};
use diagnostic::{Text, both, notice};
use machine_model::{Axis, Component, Interpolation, Six, Squareness, Table};
use measurement_files::micro;
use measurement_files::series::{Origin, Series, Told};

use crate::message::{Failure, OPTION};
use crate::profile::load_mill;

use super::axis_change::Session;
use super::codes::{QUESTION, UNSAID, failure};
use super::options::{Between, Directions, Interferometer, Reference, Slopes};
use super::output::{Output, columns};
use super::page::{Positions, Read};
use super::squareness::{Asked, Functions};
use super::work::Work;
use super::{iso_report, plausibility, sources, squareness};
use crate::figures::short;

/// `vpost calibrate interferometer`
pub(super) fn run(arguments: &Interferometer, work: &Work<'_>) -> Result<(), Failure> {
    let (mut all, angles_read) = read(arguments, work)?;
    let writes = arguments.target.writes();
    if arguments.refine.is_some() && !writes {
        return Err(Failure::usage(notice!(OPTION;
            "`--refine` is for tables, and none are written",
            "`--refine` относится к таблицам, а они не записываются";
            "add `-o PROFILE.toml`", "добавьте `-o PROFILE.toml`"
        )));
    }
    let mut out = Text::EMPTY;
    let mut axes: [Functions; 3] = Default::default();
    let mut found = Vec::new();
    for series in &all {
        plausibility::units(series, work)?;
        plausibility::directions(series, work);
        let fail = |error: &calibration::CalibrationError| failure(&series.source, &[], error);
        let readings = sources::readings(series);
        let function = functions::function(&readings).map_err(|e| fail(&e))?;
        let runs = functions::runs(&readings).map_err(|e| fail(&e))?;
        let mut evaluation = None;
        if function.count > 1 {
            plausibility::copies(series, &runs, &function, work)?;
            if function.scatter.is_some() && series.function == series.axis.direction() {
                let e = iso230_2::evaluate(&runs, arguments.u_um_per_m * 1e-6).map_err(|e| fail(&e))?;
                out.push(&iso_report::lines(&series.name(), &e, 1e3, &Text::pair("um", "мкм")));
                plausibility::conditions_of_the_standard(&series.name(), &e, work);
                evaluation = Some(e);
            }
        }
        if writes {
            plausibility::reversal(series, &function)?;
        }
        found.push(Read::new(series, &function, runs, evaluation));
        axes[series.axis.direction()][series.function] = Some(function);
    }
    let found = Positions(found);
    let show = |temperature_c: Option<f64>, uncertainty_mm: Option<f64>| {
        let files = arguments.paths();
        arguments.shown.write(&found, &files, &arguments.target, work, temperature_c, uncertainty_mm)
    };
    let asked = squareness::from_the_user(arguments, angles_read, &axes)?;
    summary(&mut out, &axes);
    if !writes {
        show(mean_temperature(&all), None)?;
        work.print(&out);
        return Ok(());
    }
    let temperature_c = mean_temperature(&all);
    let mut output = Output::start(&arguments.target, work, load_mill)?;
    let chain = output.chain(&arguments.target)?;
    to_the_line(arguments, &chain, &mut all)?;
    let session = Session::new(arguments, work, &output, &chain, &all)?;
    let uncertainty_mm = change(arguments, &mut output, &session, &all, &asked, &mut out, work)?;
    work.print(&out);
    if arguments.interpolation == Between::Monotone {
        output.text.set_text(&["interpolation"], "monotone");
    }
    output.travel(session.spans(), work);
    let scatter = (0..3).filter_map(|i| axes[i][i].as_ref()?.scatter).reduce(f64::max);
    output.write(&arguments.target, work, temperature_c, [scatter, uncertainty_mm])?;
    show(temperature_c, uncertainty_mm)
}

/// Every function of every file, and the angles between axes that a file gives.
fn read(arguments: &Interferometer, work: &Work<'_>) -> Result<(Vec<Series>, Option<[f64; 3]>), Failure> {
    let mut all: Vec<Series> = Vec::new();
    let mut angles_read: Option<[f64; 3]> = None;
    let told = Told { values: arguments.values, ways: arguments.runs, ..Told::default() };
    for spec in &arguments.files {
        let content = sources::series(spec, told, &arguments.target.ignore_column, work)?;
        angles_read = angles_read.or(content.angles_rad);
        for series in content.series {
            // Further runs of the same function may come in a file of their own.
            let same = |s: &&mut Series| s.axis == series.axis && s.function == series.function;
            match all.iter_mut().find(same) {
                Some(known) => known.append(series),
                None => all.push(series),
            }
        }
    }
    Ok((all, angles_read))
}

/// Mean of what the files say, °C.
fn mean_temperature(all: &[Series]) -> Option<f64> {
    let said: Vec<f64> = all.iter().flat_map(|s| s.readings.iter().filter_map(|r| r.temperature_c)).collect();
    sources::mean(&said)
}

/// Writes the changed axes and angles into the profile; half width that 95 % of the volume's points keep, mm.
fn change(
    arguments: &Interferometer,
    output: &mut Output,
    session: &Session,
    all: &[Series],
    asked: &Asked,
    out: &mut Text,
    work: &Work<'_>,
) -> Result<Option<f64>, Failure> {
    let temperature_c = arguments.target.temperature;
    let keep = arguments.straightness_slopes == Some(Slopes::Keep);
    // Angles beside the curves as they are belong to a model; so do a control's tables.
    let model = |axis: Axis| {
        (keep && asked.is_given()) || all.iter().any(|s| s.axis == axis && s.origin != Origin::Instrument)
    };
    let mut changes: [Functions; 3] = Default::default();
    let mut made: [Option<AxisOnNodes>; 3] = Default::default();
    let mut on_base: Vec<Axis> = Vec::new();
    for axis in Axis::ALL.into_iter().take(3).filter(|axis| all.iter().any(|s| s.axis == *axis)) {
        let zero = if model(axis) { Zero::Model } else { session.zero(axis) };
        let without_slopes = match zero {
            Zero::Model => arguments.straightness_slopes == Some(Slopes::Remove),
            Zero::Base | Zero::New => !keep,
        };
        let own = session.change(axis, all, Gauge { zero, without_slopes }, temperature_c)?;
        let mut changed = session.changed(axis, &own, zero)?;
        if arguments.directions == Directions::Mean {
            say_directions(axis, all)?;
            changed = changed.averaged(axis.direction());
        }
        write_axis(output, arguments, axis, &changed)?;
        write_line(output, arguments, session, axis, &own, work);
        if zero == Zero::Base {
            changed_lines(out, axis, &own);
            on_base.push(axis);
        }
        changes[axis.direction()] = own;
        made[axis.direction()] = Some(changed);
    }
    let before = session.squareness_before();
    let values = |s: Squareness| [s.ec0y_rad, s.eb0z_rad, s.ea0z_rad];
    let found = if keep || Axis::ALL.into_iter().take(3).any(model) {
        let [c, b, a] = values(before);
        [asked.rad[0].unwrap_or(c), asked.rad[1].unwrap_or(b), asked.rad[2].unwrap_or(a)]
    } else {
        values(session.squareness(&made, asked, mean_temperature(all).or(temperature_c))?)
    };
    if !on_base.is_empty() {
        zeros(out, session, &on_base, arguments.straightness_slopes);
    }
    for (k, name) in ["EC0Y", "EB0Z", "EA0Z"].into_iter().enumerate() {
        // Half a nanoradian is what is written.
        if asked.rad[k].is_some() || (found[k] - values(before)[k]).abs() > 5e-10 {
            output.text.set_number(&["squareness", &format!("{name}_urad")], found[k] * 1e6, 3);
            let why = if asked.rad[k].is_some() {
                Text::pair("was read", "измерен")
            } else {
                Text::pair("is in the base", "взят из исходного профиля")
            };
            out.push(&both!(
                "{name}  {:.3} urad: the angle between the lines {why}\n",
                "{name}  {:.3} мкрад: угол между линиями {why:#}\n",
                found[k] * 1e6
            ));
        }
    }
    if !asked.is_given() && session.is_new() {
        work.warning(notice!(UNSAID;
            "readings of single axes say nothing of the angles between them: the measured lines are taken as square",
            "показания отдельных осей ничего не говорят об углах между ними: измеренные линии приняты перпендикулярными";
            "add `--squareness XY=…,ZX=…,YZ=… --squareness-convention …`, or measure it later with -m",
            "добавьте `--squareness XY=…,ZX=…,YZ=… --squareness-convention …` или измерьте позже с -m"
        ));
    }
    Ok(session.field_u95_mm(&changes, arguments.u_um_per_m * 1e-6).map(|own| {
        // What was not measured is as uncertain as the base says.
        let whole = changes.iter().flatten().all(Option::is_some) && asked.rad.iter().all(Option::is_some);
        if whole { own } else { output.with_base_mm(own, work) }
    }))
}

/// A reversal value of readings that all came from nobody knows where is a guess.
fn say_directions(axis: Axis, all: &[Series]) -> Result<(), Failure> {
    let mut own = all.iter().filter(|s| s.axis == axis && s.function == axis.direction()).peekable();
    let is_silent =
        own.peek().is_some() && own.flat_map(|s| &s.readings).all(|reading| reading.direction == 0);
    if !is_silent {
        return Ok(());
    }
    Err(Failure::usage(notice!(OPTION;
        "`--directions mean`: no reading of E{axis}{axis} says from which side {axis} came, and its reversal value is made of that",
        "`--directions mean`: ни один отсчёт E{axis}{axis} не говорит, с какой стороны подошла ось {axis}, а зона нечувствительности находится по этому";
        "add the column dir (1 upwards, -1 downwards), or leave the option out: one table for both directions is written then",
        "добавьте столбец dir (1 — вверх, -1 — вниз) или уберите ключ: тогда таблица будет одна на оба направления"
    )))
}

/// What the set-up hides, and what was taken for it.
fn zeros(out: &mut Text, session: &Session, on_base: &[Axis], slopes: Option<Slopes>) {
    let slopes = if slopes == Some(Slopes::Keep) {
        Text::EMPTY
    } else {
        Text::pair(", no slope across its axis", ", без наклона поперёк оси")
    };
    let place = |axis: &Axis| {
        let k = axis.direction();
        format!("{axis} {}", short(session.lines[k].at_mm[k], 3))
    };
    let places: Vec<String> = on_base.iter().map(place).collect();
    let places = places.join(", ");
    out.push(&both!(
        "by definition the change is 0 in length on average{slopes}, and in angle at {places}: the instrument's set-up hides it\n",
        "по определению изменение равно 0 по длине в среднем{slopes:#} и по углу в {places}: его скрывает установка прибора\n"
    ));
}

/// What changed against the base.
fn changed_lines(out: &mut Text, axis: Axis, change: &Functions) {
    for (f, function) in change.iter().enumerate() {
        let Some(function) = function else { continue };
        let (scale, unit) = micro(Component::of(f));
        let values = function.directions.iter().flatten().chain([&function.mean]).flatten();
        let (low, high) = sources::span(values.map(|value| value * scale));
        out.push(&both!(
            "E{}{axis}  {low:.3} … {high:.3} {unit} against the base\n",
            "E{}{axis}  {low:.3} … {high:.3} {unit:#} относительно исходного профиля\n",
            Axis::ALL[f]
        ));
    }
}

/// Tables defined at the carriage to the measured line: δ + ε × q·e for axes that carry the workpiece.
fn to_the_line(
    arguments: &Interferometer,
    chain: &machine_model::Chain,
    all: &mut Vec<Series>,
) -> Result<(), Failure> {
    let bed = chain.to_string();
    let carries = |axis: Axis| bed.find(axis.letter()) < bed.find('b');
    let has_angles = |axis: Axis| {
        all.iter().any(|s| s.axis == axis && s.function >= 3 && s.origin == Origin::ControlAtCarriage)
    };
    let concerned: Vec<Axis> =
        Axis::ALL.into_iter().take(3).filter(|axis| carries(*axis) && has_angles(*axis)).collect();
    if concerned.is_empty() {
        return Ok(());
    }
    let letters: Vec<String> = concerned.iter().map(ToString::to_string).collect();
    let Some(reference) = arguments.reference else {
        return Err(Failure::usage(notice!(QUESTION;
            "{} carry the workpiece and have angles: were their tables defined along the measured line or at the carriage?",
            "{} несут деталь и имеют углы: их таблицы заданы вдоль измеренной линии или у каретки?",
            letters.join(", ");
            "add `--reference line` or `--reference carriage`",
            "добавьте `--reference line` или `--reference carriage`"
        )));
    };
    if reference == Reference::Line {
        return Ok(());
    }
    for axis in concerned {
        // ε × q e: along the two directions across the axis.
        let (u, v) = ((axis.direction() + 1) % 3, (axis.direction() + 2) % 3);
        for (direction, angle, sign) in [(u, v, 1.0), (v, u, -1.0)] {
            let find = |function: usize| all.iter().position(|s| s.axis == axis && s.function == function);
            let Some(rotation) = find(3 + angle).map(|at| all[at].clone()) else { continue };
            let mut rows: Vec<(f64, f64)> =
                rotation.readings.iter().map(|r| (r.position_mm, r.value)).collect();
            rows.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (positions, values) = rows.into_iter().unzip();
            let Ok(table) = Table::new(positions, values, Interpolation::Linear) else { continue };
            let own = match find(direction) {
                Some(at) => at,
                None => {
                    let mut flat = Series { function: direction, ..rotation.clone() };
                    flat.readings.iter_mut().for_each(|r| r.value = 0.0);
                    all.push(flat);
                    all.len() - 1
                }
            };
            for reading in &mut all[own].readings {
                reading.value += sign * table.value(reading.position_mm) * reading.position_mm;
            }
        }
    }
    Ok(())
}

/// The axis' tables.
fn write_axis(
    output: &mut Output,
    arguments: &Interferometer,
    axis: Axis,
    changed: &AxisOnNodes,
) -> Result<(), Failure> {
    let letter = axis.letter().to_string();
    let nodes = &changed.nodes_mm;
    /// More than any control's table, and small enough for every text.
    const MOST_NODES: f64 = 1e5;
    if arguments.refine.is_some_and(|step| (nodes[nodes.len() - 1] - nodes[0]) / step > MOST_NODES) {
        return Err(Failure::usage(notice!(OPTION;
            "`--refine` makes more than {MOST_NODES} rows for {axis}",
            "`--refine` даёт для {axis} больше {MOST_NODES} строк";
            "use a larger step", "возьмите шаг больше"
        )));
    }
    let put = |output: &mut Output, key: &str, rows: &[Six]| {
        let all = columns(changed.given, rows);
        match arguments.refine {
            None => output.errors(axis, key, nodes, &all),
            Some(step) => {
                let fine = |v: &Vec<f64>| refined(nodes, v, step, arguments.interpolation.interpolation());
                let made = all.each_ref().map(|v| v.as_ref().and_then(fine));
                let positions = made.iter().flatten().next().map(|(p, _)| p.clone()).unwrap_or_default();
                output.errors(axis, key, &positions, &made.map(|m| m.map(|(_, v)| v)));
            }
        }
    };
    put(output, "errors", &changed.positive);
    output.text.remove(&["axis", &letter, "errors_negative"]);
    output.text.remove(&["axis", &letter, "backlash_um"]);
    if let Some(negative) = &changed.negative {
        put(output, "errors_negative", negative);
    }
    if changed.backlash_mm != 0.0 {
        output.text.set_number(&["axis", &letter, "backlash_um"], changed.backlash_mm * 1e3, 4);
    }
    Ok(())
}

/// Where the axis was measured, unless its functions stay on the line of the base's.
fn write_line(
    output: &mut Output,
    arguments: &Interferometer,
    session: &Session,
    axis: Axis,
    change: &Functions,
    work: &Work<'_>,
) {
    if session.keeps_line(axis) {
        return;
    }
    let line = &session.lines[axis.direction()];
    if arguments.through.is_some() || arguments.optics.is_some() {
        let others = (0..3).filter(|&k| k != axis.direction());
        let others: Vec<(char, f64)> = others.map(|k| (Axis::ALL[k].letter(), line.at_mm[k])).collect();
        output.text.set_measured_at(axis.letter(), &others, line.optics_mm.into());
    } else if change[3..].iter().any(Option::is_some) {
        work.warning(notice!(UNSAID;
            "the line along which {axis} was measured is not known: taken through 0 of the other axes, at the gauge point",
            "линия, вдоль которой измерена {axis}, неизвестна: принята через 0 остальных осей, в базовой точке";
            "its angles act from that line on: add `--through X,Y,Z` and `--optics X,Y,Z`",
            "её углы действуют от этой линии: добавьте `--through X,Y,Z` и `--optics X,Y,Z`"
        ));
    }
}

fn summary(out: &mut Text, axes: &[Functions; 3]) {
    for (axis, functions) in axes.iter().enumerate() {
        for (f, function) in functions.iter().enumerate() {
            let Some(function) = function else { continue };
            let (scale, unit) = micro(Component::of(f));
            let (low, high) = sources::span(function.mean.iter().map(|value| value * scale));
            let directions = both!(", both directions", ", оба направления");
            let directions = function.directions.as_ref().map_or(Text::EMPTY, |_| directions);
            let scatter = function.scatter.map_or(Text::EMPTY, |s| {
                both!(", scatter {:.3} {unit}", ", разброс {:.3} {unit:#}", s * scale)
            });
            let (of, axis, targets) = (Axis::ALL[f], Axis::ALL[axis], function.positions_mm.len());
            out.push(&both!(
                "E{of}{axis}  {low:.3} … {high:.3} {unit}, {targets} targets{directions}{scatter}\n",
                "E{of}{axis}  {low:.3} … {high:.3} {unit:#}, целей {targets}{directions:#}{scatter:#}\n"
            ));
        }
    }
}
