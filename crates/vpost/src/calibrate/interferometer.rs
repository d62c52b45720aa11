//! `vpost calibrate interferometer`.

use std::fmt::Write;

use calibration::functions::{self, Function, FunctionReading, refined, without_slope};
use calibration::iso230_2;
use clap::{Args, ValueEnum};
use diagnostic::Diagnostic;
use machine_model::{Axis, Interpolation, Table};
use machine_profile::Calibrated;

use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages};
use crate::settings;

use super::codes::{MISSING, UNITS, UNSAID, failure, question};
use super::formats::{self, Reference, Series, Values};
use super::output::{Output, Target, warn};
use super::squareness;

/// `vpost calibrate interferometer FILES… -o PROFILE`
#[derive(Debug, Args)]
pub struct Interferometer {
    /// Files with runs or tables. Where a file does not say what it holds: FILE=EXX:um.
    #[arg(value_name = "FILE[=SYMBOL[:UNIT]]", required = true)]
    pub files: Vec<String>,
    #[command(flatten)]
    pub target: Target,
    /// What the numbers of a control's table are.
    #[arg(long, value_enum)]
    pub values: Option<Values>,
    /// Squareness as the instrument gave it, µrad: XY=12,ZX=-3,YZ=5.
    #[arg(long, value_name = "XY=…,ZX=…,YZ=…", allow_hyphen_values = true)]
    pub squareness: Option<String>,
    /// What a positive squareness means to the instrument.
    #[arg(long, value_enum)]
    pub squareness_convention: Option<Convention>,
    /// Slopes of the straightness curves: part of what was read as squareness (they are taken off), or not.
    #[arg(long, value_enum)]
    pub straightness_slopes: Option<Slopes>,
    /// Two directions: a table for each, or the mean and one reversal value.
    #[arg(long, value_enum, default_value_t = Directions::Tables)]
    pub directions: Directions,
    /// Where the tables of axes that carry the workpiece were defined (ISG CSV).
    #[arg(long, value_enum)]
    pub reference: Option<Reference>,
    /// Machine position through which the measured lines ran, mm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub through: Option<String>,
    /// From the gauge point to the optics that moved, mm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub optics: Option<String>,
    /// Write finer tables, with this step.
    #[arg(long, value_name = "MM")]
    pub refine: Option<f64>,
    /// How finer tables, and the profile, go between the targets.
    #[arg(long, value_enum, default_value_t = Between::Linear)]
    pub interpolation: Between,
    /// Relative standard uncertainty of the instrument, µm/m.
    #[arg(long, value_name = "UM_PER_M", default_value_t = 0.5, value_parser = crate::arguments::size_or_zero)]
    pub u_um_per_m: f64,
}

/// What a positive squareness means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Convention {
    /// A right-handed turn, as in ISO 230-1: ZX positive where the angle is below 90°.
    RightHanded,
    /// An angle above 90° in every plane.
    LargerThan90,
}

/// Slopes of straightness curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Slopes {
    /// They say the same as the squareness: take them off.
    Remove,
    /// The squareness was measured against the curves as they are: keep them.
    Keep,
}

/// What becomes of two directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Directions {
    /// `errors` and `errors_negative`.
    Tables,
    /// `errors` is the mean, `backlash_um` the mean reversal value.
    Mean,
}

/// Between the targets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Between {
    /// Straight lines.
    Linear,
    /// A cubic that keeps the shape.
    Monotone,
}

impl Between {
    fn interpolation(self) -> Interpolation {
        match self {
            Self::Linear => Interpolation::Linear,
            Self::Monotone => Interpolation::Monotone,
        }
    }
}

/// Everything read of one axis: its six functions.
pub(super) type Functions = [Option<Function>; 6];

/// `vpost calibrate interferometer`
pub(super) fn run(arguments: &Interferometer, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    if arguments.refine.is_some_and(|step| !(step > 0.0 && step.is_finite())) {
        return Err(Failure::option("a step of finer tables is above zero", "write `--refine 2`"));
    }
    // Whether they are needed depends on what the files hold; whether they can be read does not.
    triple("--through", arguments.through.as_deref())?;
    triple("--optics", arguments.optics.as_deref())?;
    let mut all: Vec<Series> = Vec::new();
    let mut angles_read: Option<[f64; 3]> = None;
    for spec in &arguments.files {
        let content = formats::read(spec, arguments.values, &arguments.target.ignore_column)?;
        angles_read = angles_read.or(content.angles_rad);
        for series in content.series {
            // Further runs of the same function may come in a file of their own.
            let same = |s: &&mut Series| s.axis == series.axis && s.function == series.function;
            match all.iter_mut().find(same) {
                Some(known) => {
                    let file = series.source.clone();
                    known.readings.extend(
                        series
                            .readings
                            .into_iter()
                            .map(|r| FunctionReading { run: format!("{file}:{}", r.run), ..r }),
                    );
                }
                None => all.push(series),
            }
        }
    }
    let mut out = String::new();
    let mut axes: [Functions; 3] = Default::default();
    for series in &all {
        plausible(series, messages);
        let fail = |error: &calibration::CalibrationError| failure(&series.source, &[], error);
        let function = functions::function(&series.readings).map_err(|e| fail(&e))?;
        let name = format!("E{}{}", Axis::ALL[series.function], series.axis);
        if function.count > 1 {
            let runs = functions::runs(&series.readings).map_err(|e| fail(&e))?;
            if function.scatter.is_some() && series.function == series.axis.direction() {
                let found = iso230_2::evaluate(&runs, arguments.u_um_per_m * 1e-6).map_err(|e| fail(&e))?;
                out.push_str(&super::iso_report::lines(&name, &found, 1e3, "um"));
                conditions_of_the_standard(&name, &found, messages);
            }
        }
        axes[series.axis.direction()][series.function] = Some(function);
    }
    let angles = squareness::from_the_user(arguments, angles_read, &axes)?;
    if arguments.target.output.is_none() && arguments.target.against.is_none() {
        summary(&mut out, &axes);
        return file::print(out.as_bytes());
    }
    let mut output = Output::start(&arguments.target, shared)?;
    let chain = output.chain(&arguments.target)?;
    if all.iter().any(|s| s.reference_asked) {
        to_the_line(arguments, &chain, &mut axes)?;
    }
    if let Some(angles) = angles {
        for (key, value) in
            [("EC0Y_urad", angles.ec0y_rad), ("EB0Z_urad", angles.eb0z_rad), ("EA0Z_urad", angles.ea0z_rad)]
        {
            output.text.set_number(&["squareness", key], value * 1e6, 3);
        }
    } else if output.base.is_none() {
        warn(
            messages,
            Diagnostic::warning(
                UNSAID,
                "tables of single axes say nothing of the angles between them: squareness is taken as 0",
            )
            .help("add `--squareness XY=…,ZX=…,YZ=… --squareness-convention …`"),
        );
    }
    summary(&mut out, &axes);
    file::print(out.as_bytes())?;
    for (axis, functions) in axes.iter().enumerate() {
        write_axis(&mut output, arguments, Axis::ALL[axis], functions, messages)?;
    }
    if arguments.interpolation == Between::Monotone {
        output.text.set_text(&["interpolation"], "monotone");
    }
    let scatter = (0..3).filter_map(|i| axes[i][i].as_ref()?.scatter).reduce(f64::max);
    output.calibrated(
        &arguments.target,
        messages,
        Calibrated {
            repeatability_um: scatter.map(|s| s * 1e3),
            uncertainty_um: far_corner(&axes, arguments.u_um_per_m * 1e-6).map(|u| u * 1e3),
            ..Calibrated::default()
        },
    )?;
    output.write(&arguments.target, messages)
}

/// Deviations that are much too small or too large for their unit.
fn plausible(series: &Series, messages: &Messages) {
    let mut sizes: Vec<f64> = series.readings.iter().map(|r| r.value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let large = sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(0.0);
    let name = format!("E{}{}", Axis::ALL[series.function], series.axis);
    // 0.05 µm and 0.05 µrad; 0.5 mm and 5 mrad.
    let (low, high) = if series.function < 3 { (5e-5, 0.5) } else { (5e-8, 5e-3) };
    if large > 0.0 && large < low && sizes.len() > 3 {
        let message = format!(
            "{}: nine readings of ten of {name} are below {}: are they in a larger unit than said?",
            series.source,
            if series.function < 3 { "0.05 um" } else { "0.05 urad" }
        );
        warn(
            messages,
            Diagnostic::warning(UNITS, message)
                .help("few machines are that good: check µm against mm, µrad against arc seconds"),
        );
    } else if large > high {
        let message = format!(
            "{}: readings of {name} reach {:.0} {}: are they in a smaller unit than said?",
            series.source,
            large * if series.function < 3 { 1e3 } else { 1e6 },
            if series.function < 3 { "um" } else { "urad" }
        );
        warn(
            messages,
            Diagnostic::warning(UNITS, message).help("check µm against mm and nm, µrad against arc seconds"),
        );
    }
}

/// What ISO 230-2 asks of a test.
fn conditions_of_the_standard(name: &str, found: &iso230_2::Evaluation, messages: &Messages) {
    let length = found.targets[found.targets.len() - 1].position - found.targets[0].position;
    let mut short = Vec::new();
    if found.runs.iter().any(|n| *n < 5) {
        short.push(format!("{} and {} runs instead of five in each direction", found.runs[0], found.runs[1]));
    }
    let least = if length < 1000.0 { 5.0 } else { 5.0 * length / 1000.0 };
    if (found.targets.len() as f64) < least {
        short.push(format!("{} targets over {length} mm instead of {least:.0}", found.targets.len()));
    }
    if !short.is_empty() {
        let message =
            format!("{name} is evaluated after ISO 230-2 but was not measured so: {}", short.join("; "));
        warn(
            messages,
            Diagnostic::warning(MISSING, message).help("do not quote the figures as those of the standard"),
        );
    }
}

/// Tables defined at the carriage to the measured line: δ + ε × q·e for axes that carry the workpiece.
fn to_the_line(
    arguments: &Interferometer,
    chain: &machine_model::Chain,
    axes: &mut [Functions; 3],
) -> Result<(), Failure> {
    let bed = chain.to_string();
    let carries = |axis: Axis| bed.find(axis.letter()) < bed.find('b');
    let concerned: Vec<Axis> = Axis::ALL[..3]
        .iter()
        .copied()
        .filter(|a| carries(*a) && axes[a.direction()][3..].iter().any(Option::is_some))
        .collect();
    if concerned.is_empty() {
        return Ok(());
    }
    let letters: Vec<String> = concerned.iter().map(ToString::to_string).collect();
    let Some(reference) = arguments.reference else {
        return Err(question(
            format!(
                "{} carry the workpiece and have angles: were their tables defined along the measured line or at the carriage?",
                letters.join(", ")
            ),
            "add `--reference line` or `--reference carriage`",
        ));
    };
    if reference == Reference::Line {
        return Ok(());
    }
    for axis in concerned.into_iter().map(Axis::direction) {
        // ε × q e: along the two directions across the axis.
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (direction, angle, sign) in [(u, v, 1.0), (v, u, -1.0)] {
            let Some(rotation) = axes[axis][3 + angle].clone() else { continue };
            let table =
                Table::new(rotation.positions_mm.clone(), rotation.mean.clone(), Interpolation::Linear);
            let Ok(table) = table else { continue };
            let own = axes[axis][direction].get_or_insert_with(|| Function {
                positions_mm: rotation.positions_mm.clone(),
                mean: vec![0.0; rotation.mean.len()],
                directions: None,
                scatter: None,
                count: 1,
            });
            let positions = own.positions_mm.clone();
            let move_all = |values: &mut Vec<f64>| {
                for (value, q) in values.iter_mut().zip(&positions) {
                    *value += sign * table.value(*q) * q;
                }
            };
            move_all(&mut own.mean);
            if let Some(both) = &mut own.directions {
                both.iter_mut().for_each(move_all);
            }
        }
    }
    Ok(())
}

/// Half width of the 95 % interval of the deviation at the far end, mm: means of repeats, levers and the instrument.
fn far_corner(axes: &[Functions; 3], relative: f64) -> Option<f64> {
    let length = |i: usize| {
        let positions = axes[i].iter().flatten().map(|f| &f.positions_mm);
        positions.map(|p| p[p.len() - 1] - p[0]).fold(0.0, f64::max)
    };
    let reach = (0..3).map(|i| length(i) * length(i)).sum::<f64>().sqrt();
    let mut variance = 0.0;
    let mut known = false;
    for (axis, functions) in axes.iter().enumerate() {
        for (f, function) in functions.iter().enumerate() {
            let Some(Function { scatter: Some(scatter), count, .. }) = function else { continue };
            known = true;
            let lever = if f < 3 { 1.0 } else { reach };
            let u = scatter / (*count as f64).sqrt() * lever;
            variance += u * u;
            if f == axis {
                let own = relative * length(axis);
                variance += own * own;
            }
        }
    }
    known.then(|| 2.0 * variance.sqrt())
}

/// Function values at other positions, straight between its own; the slope taken off where asked.
fn sampled(values: &[f64], function: &Function, nodes: &[f64]) -> Option<Vec<f64>> {
    let table = Table::new(function.positions_mm.clone(), values.to_vec(), Interpolation::Linear).ok()?;
    Some(nodes.iter().map(|q| table.value(*q)).collect())
}

fn write_axis(
    output: &mut Output,
    arguments: &Interferometer,
    axis: Axis,
    functions: &Functions,
    messages: &Messages,
) -> Result<(), Failure> {
    let given = || functions.iter().flatten();
    if given().next().is_none() {
        return Ok(());
    }
    let letter = axis.letter().to_string();
    let low = given().map(|f| f.positions_mm[0]).fold(f64::NEG_INFINITY, f64::max);
    let high = given().map(|f| f.positions_mm[f.positions_mm.len() - 1]).fold(f64::INFINITY, f64::min);
    let mut nodes: Vec<f64> =
        given().flat_map(|f| &f.positions_mm).copied().filter(|q| low <= *q && *q <= high).collect();
    nodes.sort_by(f64::total_cmp);
    nodes.dedup_by(|a, b| (*a - *b).abs() < 1e-4);
    if nodes.len() < 2 {
        return Err(question(
            format!("the functions of {axis} were measured over ranges without a common part"),
            "leave one of them out",
        ));
    }
    /// More than any control's table, and small enough for every text.
    const MOST_NODES: f64 = 1e5;
    if arguments.refine.is_some_and(|step| (nodes[nodes.len() - 1] - nodes[0]) / step > MOST_NODES) {
        let message = format!("`--refine` makes more than {MOST_NODES} rows for {axis}");
        return Err(Failure::option(message, "use a larger step"));
    }
    let two = given().any(|f| f.directions.is_some());
    let both = two && arguments.directions == Directions::Tables;
    let remove = arguments.straightness_slopes == Some(Slopes::Remove);
    let values = |f: usize, side: Option<usize>| -> Option<Vec<f64>> {
        let function = functions[f].as_ref()?;
        let own = match (side, &function.directions) {
            (Some(side), Some(directions)) => &directions[side],
            _ => &function.mean,
        };
        let straight = f < 3 && f != axis.direction();
        let own = if remove && straight { without_slope(&function.positions_mm, own) } else { own.clone() };
        sampled(&own, function, &nodes)
    };
    let put = |output: &mut Output, key: &str, side: Option<usize>| {
        let all: [Option<Vec<f64>>; 6] = std::array::from_fn(|f| values(f, side));
        match arguments.refine {
            None => output.errors(axis, key, &nodes, &all),
            Some(step) => {
                let fine = |v: &Vec<f64>| refined(&nodes, v, step, arguments.interpolation.interpolation());
                let made = all.each_ref().map(|v| v.as_ref().and_then(fine));
                let positions = made.iter().flatten().next().map(|(p, _)| p.clone()).unwrap_or_default();
                output.errors(axis, key, &positions, &made.map(|m| m.map(|(_, v)| v)));
            }
        }
    };
    output.text.remove(&["axis", &letter, "errors_negative"]);
    output.text.remove(&["axis", &letter, "backlash_um"]);
    put(output, "errors", both.then_some(0));
    if both {
        put(output, "errors_negative", Some(1));
    } else if two
        && let Some(function) = &functions[axis.direction()]
        && let Some([up, down]) = &function.directions
    {
        let mean: f64 = down.iter().zip(up).map(|(d, u)| d - u).sum::<f64>() / up.len() as f64;
        output.text.set_number(&["axis", &letter, "backlash_um"], mean * 1e3, 3);
    }
    let has_angles = functions[3..].iter().any(Option::is_some);
    if arguments.through.is_some() || arguments.optics.is_some() {
        let through = triple("--through", arguments.through.as_deref())?;
        let optics = triple("--optics", arguments.optics.as_deref())?;
        let others: Vec<(char, f64)> =
            (0..3).filter(|&k| k != axis.direction()).map(|k| (Axis::ALL[k].letter(), through[k])).collect();
        output.text.set_measured_at(axis.letter(), &others, optics);
    } else if has_angles && output.base.as_ref().is_none_or(|base| base.rows[axis.direction()].is_none()) {
        warn(
            messages,
            Diagnostic::warning(UNSAID, format!("the line along which {axis} was measured is not known: taken through 0 of the other axes, at the gauge point"))
                .help("its angles act from that line on: add `--through X,Y,Z` and `--optics X,Y,Z`"),
        );
    }
    Ok(())
}

fn triple(option: &str, text: Option<&str>) -> Result<[f64; 3], Failure> {
    text.map_or(Ok([0.0; 3]), |text| settings::triple(option, text, text, "400,200,-50"))
}

fn summary(out: &mut String, axes: &[Functions; 3]) {
    for (axis, functions) in axes.iter().enumerate() {
        for (f, function) in functions.iter().enumerate() {
            let Some(function) = function else { continue };
            let (scale, unit) = if f < 3 { (1e3, "um") } else { (1e6, "urad") };
            let low = function.mean.iter().copied().fold(f64::INFINITY, f64::min) * scale;
            let high = function.mean.iter().copied().fold(f64::NEG_INFINITY, f64::max) * scale;
            let both = if function.directions.is_some() { ", both directions" } else { "" };
            let scatter =
                function.scatter.map_or_else(String::new, |s| format!(", scatter {:.3} {unit}", s * scale));
            // Writing to a String cannot fail.
            let _ = writeln!(
                out,
                "E{}{}  {low:.3} … {high:.3} {unit}, {} targets{both}{scatter}",
                Axis::ALL[f],
                Axis::ALL[axis],
                function.positions_mm.len()
            );
        }
    }
}
