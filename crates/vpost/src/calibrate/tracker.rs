//! `vpost calibrate tracker`.

use std::fmt::Write;
use std::path::PathBuf;

use calibration::tracker::{Frame, TrackerCalibration, Verdict, calibrate};
use calibration::{MeanTraverse, Noise, Reading};
use clap::{Args, ValueEnum};
use diagnostic::Diagnostic;
use machine_model::{Axis, Vector};
use machine_profile::Calibrated;

use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages, Report};

use super::codes::{DOUBTFUL, MISSING, UNFIT, failure, question};
use super::output::{Output, Target, short, warn};
use super::sheet::Sheet;

/// `vpost calibrate tracker X.csv Y.csv Z.csv -o PROFILE`
#[derive(Debug, Args)]
pub struct Tracker {
    /// Traverses of X, of Y and of Z (CSV), in this order.
    #[arg(value_name = "TRAVERSE.csv", num_args = 3, required = true)]
    pub traverses: Vec<PathBuf>,
    #[command(flatten)]
    pub target: Target,
    /// The instrument's frame: aligned to the machine, or to be turned until the lines lie along the axes.
    #[arg(long, value_enum, default_value_t = FrameName::AsMeasured)]
    pub frame: FrameName,
    /// Standard uncertainty of one reading, µm; default: from the repeats, or from the roughness of the lines.
    #[arg(long = "u-um", value_name = "UM", value_parser = crate::arguments::size)]
    pub u_um: Option<f64>,
    /// Use nodes this far apart only: longer chords know their directions better.
    #[arg(long, value_name = "MM", value_parser = crate::arguments::size)]
    pub chord_mm: Option<f64>,
    /// Interval whose directions make G and r01, from 0.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub interval: usize,
    /// Show the cosines without their signs, as Tables 2.6 to 2.12 of Pimushkin 2023 print them. The profile keeps the signs.
    #[arg(long)]
    pub as_published: bool,
    /// Put the tracker's positioning and straightness in place of tables that the base profile has.
    #[arg(long)]
    pub replace_tables: bool,
}

/// How instrument and machine frame belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FrameName {
    /// Readings are taken as they are.
    AsMeasured,
    /// Readings are turned until the lines lie along the axes.
    Fit,
}

const COLUMNS: [&str; 18] = [
    "run",
    "repeat",
    "commanded_x_mm",
    "commanded_y_mm",
    "commanded_z_mm",
    "measured_x_mm",
    "measured_y_mm",
    "measured_z_mm",
    "x_mm",
    "y_mm",
    "z_mm",
    "xm_mm",
    "ym_mm",
    "zm_mm",
    "dir_x",
    "dir_y",
    "dir_z",
    "temp_c",
];

/// Readings of one file and the temperatures beside them.
fn readings(sheet: &Sheet, axis: usize) -> Result<(Vec<Reading>, Vec<f64>), Failure> {
    let own = sheet.has("commanded_x_mm");
    let (commanded, measured) = if own {
        (
            ["commanded_x_mm", "commanded_y_mm", "commanded_z_mm"],
            ["measured_x_mm", "measured_y_mm", "measured_z_mm"],
        )
    } else {
        (["x_mm", "y_mm", "z_mm"], ["xm_mm", "ym_mm", "zm_mm"])
    };
    sheet.need(
        &[commanded, measured].concat(),
        "a traverse has the commanded and the measured position of all three axes",
    )?;
    let direction = ["dir_x", "dir_y", "dir_z"][axis];
    let (mut all, mut temperatures) = (Vec::new(), Vec::new());
    for row in sheet.rows() {
        all.push(Reading {
            commanded_mm: Vector::from(row.three(commanded)?),
            measured_mm: Vector::from(row.three(measured)?),
            direction: row.sign(direction)?,
        });
        temperatures.extend(row.number("temp_c")?);
    }
    Ok((all, temperatures))
}

/// `vpost calibrate tracker`
pub(super) fn run(arguments: &Tracker, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    if let Some(u) = arguments.u_um.filter(|u| !(*u > 0.0 && u.is_finite())) {
        return Err(Failure::option(
            format!("`--u-um {u}` is no uncertainty"),
            "give micrometres above zero",
        ));
    }
    let mut traverses = Vec::new();
    let mut temperatures = Vec::new();
    for (axis, path) in arguments.traverses.iter().enumerate() {
        let sheet = Sheet::read(path, &COLUMNS, &arguments.target.ignore_column)?;
        let (readings, warm) = readings(&sheet, axis)?;
        temperatures.extend(warm);
        let mean = MeanTraverse::new(axis, &readings, arguments.u_um.map(|u| u * 1e-3))
            .map_err(|error| failure(&sheet.name, &file::read(path).unwrap_or_default(), &error))?;
        warn_of_gaps(&sheet.name, &mean, messages);
        traverses.push(match arguments.chord_mm {
            Some(chord) => mean.thinned(chord),
            None => mean,
        });
    }
    let Ok(traverses) = <[MeanTraverse; 3]>::try_from(traverses) else {
        return Err(Failure::option("three traverses are needed", "give X.csv Y.csv Z.csv"));
    };
    let frame = match arguments.frame {
        FrameName::AsMeasured => Frame::AsMeasured,
        FrameName::Fit => Frame::Fitted,
    };
    let found = calibrate(traverses, frame).map_err(|error| failure("", &[], &error))?;
    file::print(report(&found, arguments)?.as_bytes())?;
    judge(&found, messages)?;
    if arguments.target.output.is_none() && arguments.target.against.is_none() {
        return Ok(());
    }
    let temperature_c =
        (!temperatures.is_empty()).then(|| temperatures.iter().sum::<f64>() / temperatures.len() as f64);
    let mut output = Output::start(&arguments.target, shared)?;
    write_profile(&mut output, &found, arguments.replace_tables, arguments.as_published);
    let scatter = found.traverses.iter().map(|t| t.scatter_mm.max()).fold(0.0, f64::max);
    output.calibrated(
        &arguments.target,
        messages,
        Calibrated {
            temperature_c,
            repeatability_um: Some(scatter * 1e3),
            uncertainty_um: Some(found.far_corner.positions_u95_mm * 1e3),
            ..Calibrated::default()
        },
    )?;
    output.write(&arguments.target, messages)
}

fn warn_of_gaps(name: &str, mean: &MeanTraverse, messages: &Messages) {
    let source = || Some(crate::message::Source::whole(name, []));
    let say = |message: String, help: &str| {
        let diagnostics = vec![Diagnostic::warning(MISSING, message).help(help)];
        messages.report(&Report { source: source(), diagnostics });
    };
    if let Some((at, found, usual)) = mean.short_of_runs.first() {
        let message = format!(
            "{} of {} nodes lack readings: {at} mm has {found}, others {usual}",
            mean.short_of_runs.len(),
            mean.nodes.len()
        );
        say(
            message,
            "their means count as less certain; measure them again, or leave the incomplete run out",
        );
    }
    if let Some((from, to, usual)) = mean.gaps.first() {
        say(
            format!("no node between {from} and {to} mm, where the step is {usual} mm elsewhere"),
            "errors between them are taken as a straight line; measure the missing targets if they matter",
        );
    }
}

/// Refuses chords that cannot carry a correction, with the number that condemns them.
fn judge(found: &TrackerCalibration, messages: &Messages) -> Result<(), Failure> {
    let far = &found.far_corner;
    let corner = far.corner_mm.iter().map(|v| short(*v, 3)).collect::<Vec<_>>().join(", ");
    let um = |mm: f64| format!("{:.0}", mm * 1e3);
    let message = format!(
        "a chord of {} mm knows its direction to ±{:.0} urad (95 %), which is ±{} um at the far corner ({corner}); the deviation found there is {} um",
        short(far.chord_mm, 3),
        far.direction_u95_rad * 1e6,
        um(far.chord_u95_mm),
        um(far.deviation_mm)
    );
    let needed = (far.sufficient_chord_mm() / far.chord_mm).ceil() * far.chord_mm;
    let help = format!(
        "measure each node more often, or use longer chords: with these readings `--chord-mm {}` halves it",
        short(needed, 3)
    );
    match far.verdict() {
        Verdict::Sound => Ok(()),
        Verdict::Doubtful => {
            warn(messages, Diagnostic::warning(DOUBTFUL, message).help(help));
            Ok(())
        }
        Verdict::Unfit => Err(Failure::Refused(vec![Report {
            source: None,
            diagnostics: vec![
                Diagnostic::error(UNFIT, format!("these traverses cannot carry a correction: {message}"))
                    .help(help),
            ],
        }])),
    }
}

/// The interval tables: directions of every interval with their standard uncertainties.
fn cosines(found: &TrackerCalibration, as_published: bool) -> String {
    let mut text = String::from("axis,from_mm,to_mm,cos_x,cos_y,cos_z,u_cos_x,u_cos_y,u_cos_z\n");
    for (axis, intervals) in found.cosines.iter().enumerate() {
        for one in intervals {
            let c = if as_published { one.cosines.abs() } else { one.cosines };
            let cells: Vec<String> = [one.from_mm, one.to_mm].iter().map(|v| short(*v, 6)).collect();
            let values: Vec<String> = c.iter().chain(one.uncertainty.iter()).map(|v| short(*v, 7)).collect();
            text.push_str(&format!("{},{},{}\n", Axis::ALL[axis], cells.join(","), values.join(",")));
        }
    }
    text
}

fn write_profile(output: &mut Output, found: &TrackerCalibration, replace: bool, as_published: bool) {
    let names: [String; 3] = [0, 1, 2].map(|axis| {
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
        output.table(&format!("tracker_{letter}.csv"), text.into_bytes())
    });
    output.table("cosines.csv", cosines(found, as_published).into_bytes());
    for (letter, name) in ["x", "y", "z"].into_iter().zip(&names) {
        output.text.set_text(&["tracker", letter], name);
    }
    let has_tables =
        !replace && output.base.as_ref().is_some_and(|base| base.rows.iter().any(Option::is_some));
    let mut squareness = found.squareness;
    if has_tables {
        let ends = |axis: usize| {
            let nodes = &found.traverses[axis].nodes;
            (nodes[0].commanded_mm, nodes[nodes.len() - 1].commanded_mm)
        };
        let held = output.squareness_held([0, 1, 2].map(ends));
        squareness.ec0y_rad -= held.ec0y_rad;
        squareness.eb0z_rad -= held.eb0z_rad;
        squareness.ea0z_rad -= held.ea0z_rad;
    } else {
        for (axis, errors) in found.axes.iter().enumerate() {
            let function = |k: usize| Some(errors.errors_mm.iter().map(|e| e[k]).collect());
            let functions = [function(0), function(1), function(2), None, None, None];
            output.errors(Axis::ALL[axis], "errors", &errors.positions_mm, &functions);
            let letter = Axis::ALL[axis].letter();
            output.text.remove(&["axis", &letter.to_string(), "errors_negative"]);
            output.text.remove(&["axis", &letter.to_string(), "backlash_um"]);
            if let Some(reversal) = found.traverses[axis].reversal_mm {
                // The nodes are means of both directions; the profile counts from above minus from below.
                output.text.set_number(
                    &["axis", &letter.to_string(), "backlash_um"],
                    -reversal[axis] * 1e3,
                    3,
                );
            }
            let others: Vec<(char, f64)> =
                (0..3).filter(|&k| k != axis).map(|k| (Axis::ALL[k].letter(), found.origin_mm[k])).collect();
            output.text.set_measured_at(letter, &others, [0.0; 3]);
        }
        output.text.set_triple(&["setup", "shift_mm"], found.setup_shift_mm.into(), 7);
        output.text.set_triple(&["setup", "rotation_urad"], (found.setup_rotation_rad * 1e6).into(), 4);
    }
    for (key, value) in [
        ("EC0Y_urad", squareness.ec0y_rad),
        ("EB0Z_urad", squareness.eb0z_rad),
        ("EA0Z_urad", squareness.ea0z_rad),
    ] {
        output.text.set_number(&["squareness", key], value * 1e6, 2);
    }
}

fn report(found: &TrackerCalibration, arguments: &Tracker) -> Result<String, Failure> {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_report(&mut out, found, arguments)?;
    Ok(out)
}

fn write_report(
    out: &mut String,
    found: &TrackerCalibration,
    arguments: &Tracker,
) -> Result<std::fmt::Result, Failure> {
    let k = arguments.interval;
    let (Some(g), Some(r01)) = (found.directions(k), found.offset_mm(k)) else {
        return Err(question(
            format!("the traverses have no interval {k}"),
            "intervals are counted from 0; give one that all three have",
        ));
    };
    let show = |v: f64| if arguments.as_published { v.abs() } else { v };
    let text = |out: &mut String| -> std::fmt::Result {
        for (axis, traverse) in found.traverses.iter().enumerate() {
            let letter = Axis::ALL[axis].letter();
            let (first, last) = (&traverse.nodes[0], &traverse.nodes[traverse.nodes.len() - 1]);
            let from = match traverse.noise {
                Noise::Repeats(free) => format!("repeats, {free} degrees of freedom"),
                Noise::Given => "as given".to_owned(),
                Noise::Roughness => "no repeats: from the roughness of the line, an upper bound".to_owned(),
            };
            let s = traverse.scatter_mm * 1e3;
            writeln!(
                out,
                "traverse {letter}   {} … {} mm, {} nodes; scatter x {:.2} y {:.2} z {:.2} um ({from})",
                short(first.commanded_mm, 3),
                short(last.commanded_mm, 3),
                traverse.nodes.len(),
                s.x,
                s.y,
                s.z
            )?;
            if let Some(reversal) = traverse.reversal_mm {
                let r = reversal * 1e3;
                writeln!(
                    out,
                    "  reversal   x {:.2} y {:.2} z {:.2} um (from below minus from above)",
                    r.x, r.y, r.z
                )?;
            }
        }
        let signs = if arguments.as_published { ", signs left out as in the publication" } else { "" };
        writeln!(out, "\ninterval {k}   G, columns X Y Z{signs}")?;
        for row in 0..3 {
            writeln!(
                out,
                "  {:>11.7} {:>11.7} {:>11.7}",
                show(g[(row, 0)]),
                show(g[(row, 1)]),
                show(g[(row, 2)])
            )?;
        }
        writeln!(out, "  r01        {:.6} {:.6} {:.6} mm", r01.x, r01.y, r01.z)?;
        writeln!(out, "\nISO 230-1, machine frame (X along its line, Y in the plane)")?;
        for (axis, line) in found.lines.iter().enumerate() {
            let letter = Axis::ALL[axis].letter();
            writeln!(
                out,
                "  scale {letter}    {:+.1} ± {:.1} um/m",
                (line.slope[axis] - 1.0) * 1e6,
                2.0 * line.uncertainty[axis] * 1e6
            )?;
        }
        let s = found.squareness;
        let angles = [("EC0Y", s.ec0y_rad), ("EB0Z", s.eb0z_rad), ("EA0Z", s.ea0z_rad)];
        for ((name, angle), u) in angles.into_iter().zip(found.squareness_uncertainty_rad) {
            writeln!(out, "  {name}       {:+.1} ± {:.1} urad", angle * 1e6, 2.0 * u * 1e6)?;
        }
        for (axis, errors) in found.axes.iter().enumerate() {
            let letter = Axis::ALL[axis].letter();
            for direction in 0..3 {
                let values = || errors.errors_mm.iter().map(|e| e[direction] * 1e3);
                let (low, high) =
                    (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
                writeln!(out, "  E{}{letter}        {low:.1} … {high:.1} um", Axis::ALL[direction])?;
            }
        }
        let r = found.setup_rotation_rad * 1e6;
        writeln!(
            out,
            "  frame      measuring against machine frame: x {:.1} y {:.1} z {:.1} urad",
            r.x, r.y, r.z
        )?;
        writeln!(out, "  not seen   EA., EB., EC. of every axis: a tracker follows a point, not a carriage")?;
        let far = &found.far_corner;
        let corner = far.corner_mm.iter().map(|v| short(*v, 3)).collect::<Vec<_>>().join(", ");
        writeln!(out, "\nfar corner ({corner}) mm: deviation {:.1} um", far.deviation_mm * 1e3)?;
        writeln!(
            out,
            "  known to ±{:.1} um where positions add (engines rigid-body, tracker)",
            far.positions_u95_mm * 1e3
        )?;
        writeln!(
            out,
            "  known to ±{:.1} um where one chord of {} mm is carried there (cosines, G, r01; tangential engines)",
            far.chord_u95_mm * 1e3,
            short(far.chord_mm, 3)
        )
    };
    Ok(text(out))
}
