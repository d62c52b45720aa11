//! `vpost calibrate tracker`.

use std::path::PathBuf;

use calibration::Base;
use calibration::tracker::{
    FarCorner, Frame, TrackerCalibration, TrackerMachine, Verdict, calibrate, machine,
};
use calibration::{MeanTraverse, Noise, Point, PointReading, Reading, SetUp};
use clap::{Args, ValueEnum};
use diagnostic::{Diagnostic, Text, both, notice};
use machine_model::effects::Conditions;
use machine_model::{Axis, Command, Component, Vector};
use measurement_files::{Sheet, micro};

use crate::conditions::conditions;
use crate::message::{Failure, Report};
use crate::profile::load_mill;

use super::codes::{DOUBTFUL, MISSING, QUESTION, UNFIT, failure};
use super::output::{Output, Target};
use super::sources::{self, line, span, three};
use super::volumetric::moved;
use super::work::Work;
use crate::figures::short;

/// `vpost calibrate tracker X.csv Y.csv Z.csv -o PROFILE`
#[derive(Debug, Args)]
pub struct Tracker {
    /// Traverses of X, of Y and of Z (CSV), in this order.
    #[arg(value_names = ["X.csv", "Y.csv", "Z.csv"], num_args = 3, required = true)]
    pub traverses: Vec<PathBuf>,
    #[command(flatten)]
    pub target: Target,
    /// The instrument's frame: turned until the lines lie along the axes, or aligned to the machine and taken as it is.
    #[arg(long, value_enum, default_value_t = FrameName::Fit)]
    pub frame: FrameName,
    /// Standard uncertainty of one reading, µm; default: from the repeats, or from the roughness of the lines.
    #[arg(long = "u-um", value_name = "UM", value_parser = crate::options::size)]
    pub u_um: Option<f64>,
    /// Use nodes this far apart only: longer chords know their directions better.
    #[arg(long, value_name = "MM", value_parser = crate::options::size)]
    pub chord_mm: Option<f64>,
    /// Interval whose directions make G and r01, from 0.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub interval: usize,
    /// Show the cosines without their signs, as Tables 2.6 to 2.12 of Pimushkin 2023 print them. The profile keeps the
    /// signs.
    #[arg(long)]
    pub as_published: bool,
}

/// How instrument and machine frame belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FrameName {
    /// Readings are taken as they are.
    AsMeasured,
    /// Readings are turned until the lines lie along the axes.
    Fit,
}

const COLUMNS: &str = "run repeat commanded_x_mm commanded_y_mm commanded_z_mm measured_x_mm measured_y_mm measured_z_mm \
                       x_mm y_mm z_mm xm_mm ym_mm zm_mm dir_x dir_y dir_z temp_c";

const EXPECTED: Text = Text::pair(
    "a traverse has the commanded and the measured position of all three axes",
    "в проходе нужны заданное и измеренное положения всех трёх осей",
);

/// Readings of one file, the temperature beside each.
fn readings(read: &mut AllRead, sheet: Sheet, axis: usize) -> Result<(), Failure> {
    let own = sheet.has("commanded_x_mm");
    let (commanded, measured) = if own {
        (
            ["commanded_x_mm", "commanded_y_mm", "commanded_z_mm"],
            ["measured_x_mm", "measured_y_mm", "measured_z_mm"],
        )
    } else {
        (["x_mm", "y_mm", "z_mm"], ["xm_mm", "ym_mm", "zm_mm"])
    };
    sheet.need(&[commanded, measured].concat(), EXPECTED)?;
    let direction = ["dir_x", "dir_y", "dir_z"][axis];
    read.add(sheet, |row| {
        let reading = Reading {
            commanded_mm: Vector::from(row.three(commanded)?),
            measured_mm: Vector::from(row.three(measured)?),
            direction: row.sign(direction)?,
        };
        Ok((reading, row.number("temp_c")?))
    })
}

/// All that was read, temperatures beside it.
type AllRead = sources::Read<(Reading, Option<f64>)>;

/// The mean traverses, and, where there is a profile in the making, every reading as a point.
fn read(
    arguments: &Tracker,
    said: Conditions,
    output: Option<&Output>,
    work: &Work<'_>,
) -> Result<([MeanTraverse; 3], Vec<Point>, AllRead), Failure> {
    let given_mm = arguments.u_um.map(|u| u * 1e-3);
    let (mut traverses, mut points, mut read) = (Vec::new(), Vec::new(), sources::Read::default());
    for (axis, path) in arguments.traverses.iter().enumerate() {
        let sheet = sources::sheet(work.read(path)?, COLUMNS, EXPECTED, &arguments.target.ignore_column)?;
        let (name, text) = (sheet.name().to_owned(), sheet.text().to_owned());
        let first = read.rows.len();
        readings(&mut read, sheet, axis)?;
        let rows = &read.rows[first..];
        let readings: Vec<Reading> = rows.iter().map(|(reading, _)| *reading).collect();
        let mean = MeanTraverse::new(axis, &readings, given_mm)
            .map_err(|error| failure(&name, text.as_bytes(), &error))?;
        warn_of_gaps(&name, &mean, work);
        // A line read once shows its scatter by its roughness only.
        let rough_mm = (mean.noise == Noise::Roughness).then(|| mean.scatter_mm.norm() / 3f64.sqrt());
        traverses.push(match arguments.chord_mm {
            Some(chord) => mean.thinned(chord),
            None => mean,
        });
        if let Some(output) = output {
            let tool_mm =
                output.base.as_ref().map_or(Vector::zeros(), |base| Vector::from(base.default_tool_mm));
            for (reading, warm) in rows {
                let mut direction = [0; 3];
                direction[axis] = reading.direction;
                let linear_mm = reading.commanded_mm;
                let command = Command { linear_mm, tool_mm, direction, ..Command::default() };
                let mut here = said;
                here.temp_c = here.temp_c.map(|known| warm.or(arguments.target.temperature).or(known));
                points.push(Point {
                    run: 0,
                    command,
                    by_effects_mm: output.by_effects_mm(&command, &here)?,
                    reading: PointReading::Position(reading.measured_mm.data.0[0].map(Some)),
                    uncertainty_mm: given_mm.or(rough_mm),
                });
            }
        }
    }
    let Ok(traverses) = <[MeanTraverse; 3]>::try_from(traverses) else { unreachable!("three files") };
    Ok((traverses, points, read))
}

/// `vpost calibrate tracker`
pub(super) fn run(arguments: &Tracker, work: &Work<'_>) -> Result<(), Failure> {
    let Target { chain, .. } = &arguments.target;
    let is_known = arguments.target.writes() || work.options.machine.is_some() || chain.is_some();
    let output = is_known.then(|| Output::start(&arguments.target, work, load_mill)).transpose()?;
    let (traverses, points, read) = read(arguments, conditions(work.options)?, output.as_ref(), work)?;
    let frame = match arguments.frame {
        FrameName::AsMeasured => Frame::AsMeasured,
        FrameName::Fit => Frame::Fitted,
    };
    let found = calibrate(traverses, frame).map_err(|error| failure("", &[], &error))?;
    let Some(mut output) = output else {
        work.print(&report(&found, None, arguments)?);
        return judge_chords(&found, work);
    };
    let base = output.measured_from(&arguments.target)?;
    let changed = machine(&points, &base, &found, frame).map_err(|error| read.refused("x_mm", &error))?;
    let text = report(&found, Some(&changed), arguments)?;
    work.print(&text);
    judge(&changed, &base, work)?;
    judge_chords(&found, work)?;
    if !arguments.target.writes() {
        return Ok(());
    }
    write_profile(&mut output, &found, arguments);
    output.changed(&base, &changed.axes, &changed.description);
    output.set_up(&changed.setups);
    let scatter_mm = found.traverses.iter().map(|t| t.scatter_mm.max()).fold(0.0, f64::max);
    let known_mm = [Some(scatter_mm), Some(changed.field_u95_mm)];
    output.write(&arguments.target, work, read.temperature_c(), known_mm)
}

fn warn_of_gaps(name: &str, mean: &MeanTraverse, work: &Work<'_>) {
    let say = |said: Diagnostic| {
        let source = Some(crate::message::Source::whole(name, []));
        work.report(Report { source, ..Report::warning(said) });
    };
    if let Some((at, found, usual)) = mean.short_of_runs.first() {
        say(notice!(MISSING;
            "{} of {} nodes lack readings: {at} mm has {found}, others {usual}",
            "не хватает показаний в узлах: {} из {}; в {at} мм их {found}, в остальных {usual}",
            mean.short_of_runs.len(), mean.nodes.len();
            "their means count as less certain; measure them again, or leave the incomplete run out",
            "их средние считаются менее точными; измерьте снова или исключите неполный проход"
        ));
    }
    if let Some((from, to, usual)) = mean.gaps.first() {
        say(notice!(MISSING;
            "no node between {from} and {to} mm, where the step is {usual} mm elsewhere",
            "между {from} и {to} мм нет узла, а в других местах шаг {usual} мм";
            "errors between them are taken as a straight line; measure the missing targets if they matter",
            "погрешности между ними приняты по прямой; если это важно, измерьте пропущенные цели"
        ));
    }
}

/// Refuses a field that is known worse than it deviates.
fn judge(changed: &TrackerMachine, base: &Base, work: &Work<'_>) -> Result<(), Failure> {
    let [known, found] = [changed.field_u95_mm, changed.field_p95_mm].map(|mm| short(mm * 1e3, 1));
    let field = both!(
        "the field is known to ±{known} um (95 % of the volume's points), the deviations found are {found} um",
        "поле известно с точностью ±{known} мкм (в 95 % точек объёма), а найденные отклонения — {found} мкм"
    );
    let help = both!("measure each node more often", "измеряйте каждый узел больше раз");
    // A base corrects whatever it did before; without one a correction has to be better than none.
    if !base.is_known && changed.field_u95_mm > changed.field_p95_mm {
        return Err(Failure::unfit(notice!(UNFIT;
            "these traverses cannot carry a correction: {field}", "эти проходы не дают поправки: {field:#}";
            help
        )));
    }
    if !base.is_known && changed.field_u95_mm > 0.5 * changed.field_p95_mm {
        work.warn(DOUBTFUL, field, help);
    }
    Ok(())
}

/// Refuses chords that cannot carry a correction, for the engines that carry one through the volume.
fn judge_chords(found: &TrackerCalibration, work: &Work<'_>) -> Result<(), Failure> {
    let um = |mm: f64| format!("{:.0}", mm * 1e3);
    let far = &found.far_corner;
    let tangential = work.options.engine().is_some_and(|id| id.name().starts_with("tangential"));
    if !tangential || far.verdict() == Verdict::Sound {
        return Ok(());
    }
    let corner = far.corner_mm.iter().map(|v| short(*v, 3)).collect::<Vec<_>>().join(", ");
    let needed = (far.sufficient_chord_mm() / far.chord_mm).ceil() * far.chord_mm;
    let (chord, known_urad) = (short(far.chord_mm, 3), far.direction_u95_rad * 1e6);
    let [known, found] = [far.chord_u95_mm, far.deviation_mm].map(um);
    let message = both!(
        "a chord of {chord} mm knows its direction to ±{known_urad:.0} urad (95 %), which is ±{known} um at the far corner ({corner}); the deviation found there is {found} um",
        "направление хорды {chord} мм известно с точностью ±{known_urad:.0} мкрад (95 %), то есть ±{known} мкм в дальнем углу ({corner}); найденное там отклонение — {found} мкм"
    );
    let help = both!(
        "measure each node more often, or use longer chords: with these readings `--chord-mm {}` halves it",
        "измеряйте каждый узел больше раз или берите хорды длиннее: при этих показаниях `--chord-mm {}` уменьшит её вдвое",
        short(needed, 3)
    );
    if far.verdict() == Verdict::Doubtful {
        work.warn(DOUBTFUL, message, help);
        return Ok(());
    }
    Err(Failure::unfit(notice!(UNFIT;
        "these traverses cannot carry a correction by chords: {message}",
        "эти проходы не дают поправки по хордам: {message:#}";
        help
    )))
}

/// The interval tables: directions of every interval with their standard uncertainties.
fn cosines(found: &TrackerCalibration, arguments: &Tracker) -> String {
    let mut text = String::from("axis,from_mm,to_mm,cos_x,cos_y,cos_z,u_cos_x,u_cos_y,u_cos_z\n");
    for (axis, intervals) in found.cosines.iter().enumerate() {
        for one in intervals {
            let c = if arguments.as_published { one.cosines.abs() } else { one.cosines };
            let cells: Vec<String> = [one.from_mm, one.to_mm].iter().map(|v| short(*v, 6)).collect();
            let values: Vec<String> = c.iter().chain(one.uncertainty.iter()).map(|v| short(*v, 7)).collect();
            text.push_str(&format!("{},{},{}\n", Axis::ALL[axis], cells.join(","), values.join(",")));
        }
    }
    text
}

/// The traverses in the machine's directions, for the engines that work on them.
fn write_profile(output: &mut Output, found: &TrackerCalibration, arguments: &Tracker) {
    for axis in 0..3 {
        let traverse = &found.traverses[axis];
        let mut text = String::from(
            "commanded_x_mm,commanded_y_mm,commanded_z_mm,measured_x_mm,measured_y_mm,measured_z_mm\n",
        );
        for node in &traverse.nodes {
            let mut commanded = traverse.start_mm;
            commanded[axis] = node.commanded_mm;
            let cells: Vec<String> =
                commanded.iter().chain(node.measured_mm.iter()).map(|v| short(*v, 7)).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        let letter = ["x", "y", "z"][axis];
        let name = output.table(&format!("tracker_{letter}.csv"), text.into_bytes());
        output.text.set_text(&["tracker", letter], &name);
    }
    output.table("cosines.csv", cosines(found, arguments).into_bytes());
}

fn report(
    found: &TrackerCalibration,
    changed: Option<&TrackerMachine>,
    arguments: &Tracker,
) -> Result<Text, Failure> {
    let k = arguments.interval;
    let (Some(g), Some(r01)) = (found.directions(k), found.offset_mm(k)) else {
        return Err(Failure::usage(notice!(QUESTION;
            "the traverses have no interval {k}", "интервала {k} в проходах нет";
            "intervals are counted from 0; give one that all three have",
            "интервалы считаются от 0; дайте такой, какой есть во всех трёх"
        )));
    };
    let mut out = Text::EMPTY;
    for (axis, traverse) in found.traverses.iter().enumerate() {
        out.push(&of_traverse(axis, traverse));
    }
    let signs = if arguments.as_published {
        Text::pair(", signs left out as in the publication", ", без знаков, как в публикации")
    } else {
        Text::EMPTY
    };
    out.push(&both!(
        "\ninterval {k}   G, columns X Y Z{signs}\n",
        "\nинтервал {k}   G, столбцы X Y Z{signs:#}\n"
    ));
    let show = |v: f64| if arguments.as_published { v.abs() } else { v };
    for row in 0..3 {
        let [x, y, z] = [0, 1, 2].map(|column| show(g[(row, column)]));
        out.push(&Text::same(format!("  {x:>11.7} {y:>11.7} {z:>11.7}\n")));
    }
    let r01 = three(&r01, 6);
    out.push(&both!("  r01        {r01} mm\n", "  r01        {r01} мм\n"));
    let factor = found.far_corner.coverage_factor;
    out.push(&Text::pair(
        "\nISO 230-1, lines through the common point; 95 %\n",
        "\nISO 230-1, линии через общую точку; 95 %\n",
    ));
    for (axis, line) in found.lines.iter().enumerate() {
        let letter = Axis::ALL[axis].letter();
        let (scale, half) = ((line.slope.norm() - 1.0) * 1e6, factor * line.uncertainty[axis] * 1e6);
        out.push(&both!(
            "  scale {letter}    {scale:+.1} ± {half:.1} um/m\n",
            "  масштаб {letter}  {scale:+.1} ± {half:.1} мкм/м\n"
        ));
    }
    let s = found.squareness;
    let angles = [("EC0Y", s.ec0y_rad), ("EB0Z", s.eb0z_rad), ("EA0Z", s.ea0z_rad)];
    for ((name, angle), u) in angles.into_iter().zip(found.squareness_uncertainty_rad) {
        let (angle, half) = (angle * 1e6, factor * u * 1e6);
        out.push(&line(format_args!("  {name}       {angle:+.1} ± {half:.1}"), &micro(Component::Angular).1));
    }
    if let Some(changed) = changed {
        out.push(&of_machine(changed));
    }
    out.push(&Text::pair(
        "  not seen   EA., EB., EC. of every axis: a tracker follows a point, not a carriage\n",
        "  не видны   EA., EB., EC. каждой оси: трекер следит за точкой, а не за кареткой\n",
    ));
    out.push(&of_far_corner(&found.far_corner));
    Ok(out)
}

fn of_far_corner(far: &FarCorner) -> Text {
    let corner = far.corner_mm.iter().map(|v| short(*v, 3)).collect::<Vec<_>>().join(", ");
    let mut out = both!(
        "\nfar corner ({corner}) mm: deviation {:.1} um\n",
        "\nдальний угол ({corner}) мм: отклонение {:.1} мкм\n",
        far.deviation_mm * 1e3
    );
    out.push(&both!(
        "  known to ±{:.1} um where positions add (engines rigid-body, tracker)\n",
        "  известно с точностью ±{:.1} мкм, если складывать положения (методы rigid-body, tracker)\n",
        far.positions_u95_mm * 1e3
    ));
    out.push(&both!(
        "  known to ±{:.1} um where one chord of {} mm is carried there (cosines, G, r01; tangential engines)\n",
        "  известно с точностью ±{:.1} мкм, если продолжать туда одну хорду {} мм (косинусы, G, r01; методы tangential)\n",
        far.chord_u95_mm * 1e3,
        short(far.chord_mm, 3)
    ));
    out
}

fn of_traverse(axis: usize, traverse: &MeanTraverse) -> Text {
    let letter = Axis::ALL[axis].letter();
    let (first, last) = (&traverse.nodes[0], &traverse.nodes[traverse.nodes.len() - 1]);
    let from = match traverse.noise {
        Noise::Repeats(free) => {
            both!("repeats, {free} degrees of freedom", "по повторам, степеней свободы {free}")
        }
        Noise::Given => Text::pair("as given", "как задано"),
        Noise::Roughness => Text::pair(
            "no repeats: from the roughness of the line, an upper bound",
            "повторов нет: по неровности линии, оценка сверху",
        ),
    };
    let named = |mm: &Vector| format!("x {:.2} y {:.2} z {:.2}", mm.x * 1e3, mm.y * 1e3, mm.z * 1e3);
    let [start, end] = [first, last].map(|node| short(node.commanded_mm, 3));
    let (nodes, scatter) = (traverse.nodes.len(), named(&traverse.scatter_mm));
    let mut out = both!(
        "traverse {letter}   {start} … {end} mm, {nodes} nodes; scatter {scatter} um ({from})\n",
        "проход {letter}     {start} … {end} мм, узлов {nodes}; разброс {scatter} мкм ({from:#})\n"
    );
    if let Some(reversal) = traverse.reversal_mm.as_ref().map(named) {
        out.push(&both!(
            "  reversal   {reversal} um (from below minus from above)\n",
            "  реверс     {reversal} мкм (снизу минус сверху)\n"
        ));
    }
    out
}

fn of_machine(changed: &TrackerMachine) -> Text {
    let mut out = Text::pair(
        "\nmachine (X along its line, Y in its plane), tables without the angles above\n",
        "\nстанок (X вдоль своей линии, Y в своей плоскости), таблицы без углов, названных выше\n",
    );
    for (axis, own) in changed.axes.iter().enumerate() {
        let letter = Axis::ALL[axis].letter();
        for direction in 0..3 {
            let (low, high) = span(own.errors.iter().map(|row| row[direction] * 1e3));
            let name = Axis::ALL[direction];
            out.push(&line(
                format_args!("  E{name}{letter}        {low:.1} … {high:.1}"),
                &micro(Component::Linear).1,
            ));
        }
        if let Some((value, half)) = changed.play_mm[axis] {
            let (value, half) = (value * 1e3, half * 1e3);
            out.push(&both!(
                "  play {letter}     {value:.2} ± {half:.2} um\n",
                "  люфт {letter}     {value:.2} ± {half:.2} мкм\n"
            ));
        }
    }
    if changed.left_out > 0 {
        out.push(&both!(
            "  {} readings lie outside the base's volume and were left out\n",
            "  отсчётов вне объёма исходного профиля: {}, они не использованы\n",
            changed.left_out
        ));
    }
    if let [Some(SetUp::Frame(motion))] = changed.setups.as_slice() {
        let moved = moved(motion);
        out.push(&both!("  set-up     {moved} of the instrument\n", "  установка  {moved:#} прибора\n"));
    }
    out.push(&both!(
        "  field      known to ±{:.2} um at 95 % of the points of the volume, frames taken off; deviations found {:.2} um\n",
        "  поле       известно с точностью ±{:.2} мкм в 95 % точек объёма, без систем координат; найденные отклонения {:.2} мкм\n",
        changed.field_u95_mm * 1e3,
        changed.field_p95_mm * 1e3
    ));
    out
}
