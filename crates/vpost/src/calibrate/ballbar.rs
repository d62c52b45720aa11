//! `vpost calibrate ballbar`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use calibration::linear_ballbar::{self, CircleCalibration, CircleReading};
use calibration::rotary_ballbar::{self, NAMES, RotaryCalibration, Test, Turning, is_length};
use clap::Args;
use diagnostic::Diagnostic;
use machine_model::{Axis, Vector};
use machine_profile::Calibrated;

use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages};
use crate::settings::triple;

use super::codes::{AXES, UNSAID, failure, question};
use super::output::{Output, Target, warn};
use super::sheet::Sheet;

/// `vpost calibrate ballbar FILES… -o PROFILE`
#[derive(Debug, Args)]
pub struct Ballbar {
    /// Readings (CSV): run, x_mm … z_mm of the moving ball, bx_mm … bz_mm of the other at angle 0, length_mm, and a_deg, c_deg,
    /// spindle_deg or dir_x … dir_z.
    #[arg(value_name = "READINGS.csv", required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub target: Target,
    /// Where the axes of A and C should cross, machine coordinates, mm; default: as the base profile has them.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub crossing: Option<String>,
    /// The same tests after a compensation: a table before and after.
    #[arg(long, value_name = "READINGS.csv")]
    pub after: Option<PathBuf>,
}

const COLUMNS: [&str; 18] = [
    "run",
    "repeat",
    "x_mm",
    "y_mm",
    "z_mm",
    "bx_mm",
    "by_mm",
    "bz_mm",
    "length_mm",
    "a_deg",
    "b_deg",
    "c_deg",
    "spindle_deg",
    "dir_x",
    "dir_y",
    "dir_z",
    "temp_c",
    "note",
];

/// What a file holds.
struct Readings {
    tests: Vec<Test>,
    circles: Vec<CircleReading>,
    temperatures: Vec<f64>,
}

/// One row: run, tool ball, other ball, angles of A, B, C and spindle, length, directions.
struct Line {
    run: String,
    ball: Vector,
    other: Vector,
    angles: [f64; 4],
    length_mm: f64,
    direction: [i8; 3],
}

fn read(path: &Path, crossing: Option<Vector>, ignore: &[String]) -> Result<Readings, Failure> {
    let sheet = Sheet::read(path, &COLUMNS, ignore)?;
    sheet.need(
        &["run", "x_mm", "y_mm", "z_mm", "bx_mm", "by_mm", "bz_mm", "length_mm"],
        "a reading of a ball bar is a length between two balls",
    )?;
    let mut lines: Vec<Line> = Vec::new();
    let mut temperatures = Vec::new();
    for row in sheet.rows() {
        let angle = |column: &str| row.number(column).map(|v| v.unwrap_or(0.0).to_radians());
        lines.push(Line {
            run: row.text("run"),
            ball: Vector::from(row.three(["x_mm", "y_mm", "z_mm"])?),
            other: Vector::from(row.three(["bx_mm", "by_mm", "bz_mm"])?),
            angles: [angle("a_deg")?, angle("b_deg")?, angle("c_deg")?, angle("spindle_deg")?],
            length_mm: row.needed("length_mm")?,
            direction: [row.sign("dir_x")?, row.sign("dir_y")?, row.sign("dir_z")?],
        });
        temperatures.extend(row.number("temp_c")?);
    }
    plausible(&sheet.name, &lines)?;
    let mut runs: Vec<&str> = lines.iter().map(|l| l.run.as_str()).collect();
    runs.dedup();
    runs.sort_unstable();
    runs.dedup();
    let (mut tests, mut circles) = (Vec::new(), Vec::new());
    let mut circle = 0;
    for run in runs {
        let own: Vec<&Line> = lines.iter().filter(|l| l.run == run).collect();
        let moves = |of: &dyn Fn(&Line) -> f64| own.iter().any(|l| (of(l) - of(own[0])).abs() > 1e-9);
        let turning: Vec<usize> = (0..4).filter(|&k| moves(&|l| l.angles[k])).collect();
        let linear = (0..3).any(|i| moves(&|l| l.ball[i]));
        let refuse = |message: String, help: &str| {
            Failure::usage(
                Diagnostic::error(AXES, format!("{}, run `{run}`: {message}", sheet.name)).help(help),
            )
        };
        match (turning.as_slice(), linear) {
            ([], true) => {
                circles.extend(own.iter().map(|l| CircleReading {
                    run: circle,
                    commanded_mm: l.ball,
                    centre_mm: l.other,
                    length_mm: l.length_mm,
                    direction: l.direction,
                }));
                circle += 1;
            }
            ([one], false) => {
                let turning = match one {
                    0 => Turning::A,
                    2 => Turning::C,
                    3 => Turning::Spindle,
                    _ => {
                        return Err(refuse(
                            "B turns; the method is one for tables of A and C".to_owned(),
                            "leave the run out",
                        ));
                    }
                };
                let Some(crossing) = crossing else {
                    return Err(question(
                        "where should the axes of A and C cross?",
                        "add `--crossing X,Y,Z`, or `-m PROFILE` with centre_mm of both axes",
                    ));
                };
                tests.push(Test {
                    turning,
                    tool_ball_mm: own[0].ball - crossing,
                    bar_mm: own[0].other - own[0].ball,
                    readings: own.iter().map(|l| (l.angles[*one], l.length_mm)).collect(),
                });
            }
            ([], false) => {
                return Err(refuse("nothing moves".to_owned(), "a run turns one axis or moves two"));
            }
            _ => {
                return Err(refuse(
                    "linear and rotary axes move, or two rotary ones".to_owned(),
                    "turn one axis a run; the others stand",
                ));
            }
        }
    }
    Ok(Readings { tests, circles, temperatures })
}

/// Lengths must be near what the balls' places say.
fn plausible(name: &str, lines: &[Line]) -> Result<(), Failure> {
    let ratio = |l: &Line| l.length_mm / (l.other - l.ball).norm();
    if let Some(l) = lines.iter().find(|l| (ratio(l) - 1.0).abs() > 0.05) {
        let message = format!(
            "{name}, run `{}`: a length of {} mm, where the balls are {:.3} mm apart",
            l.run,
            l.length_mm,
            (l.other - l.ball).norm()
        );
        return Err(Failure::usage(
            Diagnostic::error(super::codes::UNITS, message)
                .help("give the whole length in mm, not its change; and both balls' places at angle 0"),
        ));
    }
    Ok(())
}

/// `vpost calibrate ballbar`
pub(super) fn run(arguments: &Ballbar, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let base = shared.machine.as_deref().map(crate::profile::load).transpose()?.map(|loaded| loaded.profile);
    let crossing = match &arguments.crossing {
        Some(text) => Some(Vector::from(triple("--crossing", text, text, "0,0,0")?)),
        None => base.as_ref().map(|b| {
            let [a, _, c] = &b.description.rotary;
            Vector::new(c.centre_mm.x, a.centre_mm.y, a.centre_mm.z)
        }),
    };
    let ignore = &arguments.target.ignore_column;
    let mut all = Readings { tests: Vec::new(), circles: Vec::new(), temperatures: Vec::new() };
    for path in &arguments.files {
        let own = read(path, crossing, ignore)?;
        let offset = all.circles.iter().map(|c| c.run + 1).max().unwrap_or(0);
        all.tests.extend(own.tests);
        all.circles.extend(own.circles.into_iter().map(|c| CircleReading { run: c.run + offset, ..c }));
        all.temperatures.extend(own.temperatures);
    }
    let fail = |error: calibration::CalibrationError| failure("", &[], &error);
    let rotary =
        if all.tests.is_empty() { None } else { Some(rotary_ballbar::calibrate(&all.tests).map_err(fail)?) };
    let circles = if all.circles.is_empty() {
        None
    } else {
        Some(linear_ballbar::calibrate(&all.circles).map_err(fail)?)
    };
    let mut out = String::new();
    // Writing to a String cannot fail.
    if let Some(found) = &rotary {
        let _ = rotary_report(&mut out, found);
        if let Some(path) = &arguments.after {
            let after = rotary_ballbar::calibrate(&read(path, crossing, ignore)?.tests).map_err(fail)?;
            let _ = before_and_after(&mut out, found, &after);
        }
    }
    if let Some(found) = &circles {
        let _ = circle_report(&mut out, found);
    }
    file::print(out.as_bytes())?;
    if arguments.target.output.is_none() && arguments.target.against.is_none() {
        return Ok(());
    }
    let mut output = Output::start(&arguments.target, shared)?;
    if let Some(found) = &rotary {
        for (k, name) in NAMES.iter().enumerate() {
            let axis = &name[3..];
            let (key, scale) =
                if is_length(k) { (format!("{name}_um"), 1e3) } else { (format!("{name}_urad"), 1e6) };
            output.text.set_number(&["rotary", axis, &key], found.piges[k] * scale, 3);
        }
    }
    if let Some(found) = &circles {
        write_circles(&mut output, found, &all.circles, messages);
    }
    let sigma = rotary
        .iter()
        .map(|r| r.estimate.sigma)
        .chain(circles.iter().map(|c| c.estimate.sigma))
        .fold(0.0, f64::max);
    let temperature_c = (!all.temperatures.is_empty())
        .then(|| all.temperatures.iter().sum::<f64>() / all.temperatures.len() as f64);
    output.calibrated(
        &arguments.target,
        messages,
        Calibrated { temperature_c, repeatability_um: Some(sigma * 1e3), ..Calibrated::default() },
    )?;
    output.write(&arguments.target, messages)
}

fn write_circles(
    output: &mut Output,
    found: &CircleCalibration,
    readings: &[CircleReading],
    messages: &Messages,
) {
    let range = |axis: usize| {
        let values = || readings.iter().map(|r| r.commanded_mm[axis]);
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    };
    let held = output.squareness_held([0, 1, 2].map(range));
    let held = [held.ec0y_rad, held.eb0z_rad, held.ea0z_rad];
    for (k, key) in ["EC0Y_urad", "EB0Z_urad", "EA0Z_urad"].into_iter().enumerate() {
        if let Some(term) = found.squareness_rad[k] {
            output.text.set_number(&["squareness", key], (term.value - held[k]) * 1e6, 3);
        }
    }
    for axis in &Axis::ALL[..3] {
        let Some(term) = found.backlash_mm[axis.direction()] else { continue };
        let two = output
            .base
            .as_ref()
            .is_some_and(|b| b.description.linear[axis.direction()].errors_negative.is_some());
        if two {
            let message = format!(
                "the tables of {axis} for both directions hold its reversal already: {:.2} um is not written",
                term.value * 1e3
            );
            warn(
                messages,
                Diagnostic::warning(UNSAID, message)
                    .help("measure the tables again if they are older than the circle"),
            );
        } else {
            output.text.set_number(&["axis", &axis.letter().to_string(), "backlash_um"], term.value * 1e3, 3);
        }
    }
}

fn rotary_report(out: &mut String, found: &RotaryCalibration) -> std::fmt::Result {
    writeln!(
        out,
        "location errors of A and C, {} readings, {:.3} um left (standard deviation)",
        found.estimate.residuals.len(),
        found.estimate.sigma * 1e3
    )?;
    writeln!(out, "          joint fit        95 %   in sequence")?;
    for (k, name) in NAMES.iter().enumerate() {
        let (scale, unit) = if is_length(k) { (1e3, "um") } else { (1e6, "urad") };
        let sequential = found
            .sequential
            .map_or_else(|| "         -".to_owned(), |(p, _)| format!("{:>10.3}", p[k] * scale));
        writeln!(
            out,
            "  {name}  {:>10.3} ± {:>8.3} {sequential} {unit}",
            found.piges[k] * scale,
            found.estimate.half_width_95(k) * scale
        )?;
    }
    for (k, name) in ["eX", "eY"].into_iter().enumerate() {
        let sequential = found
            .sequential
            .map_or_else(|| "         -".to_owned(), |(_, c)| format!("{:>10.3}", c[k] * 1e3));
        writeln!(
            out,
            "  {name}    {:>10.3} ± {:>8.3} {sequential} um (tool ball against the spindle axis)",
            found.cup_mm[k] * 1e3,
            found.estimate.half_width_95(8 + k) * 1e3
        )?;
    }
    if let Some(off) = found.approximation_mm {
        writeln!(
            out,
            "  the first-order formulas of the sequence leave the exact chain by up to {:.3} um",
            off * 1e3
        )?;
    }
    Ok(())
}

/// Table 4 of Zhang 2024: location errors before and after the compensation of the four positions.
fn before_and_after(
    out: &mut String,
    before: &RotaryCalibration,
    after: &RotaryCalibration,
) -> std::fmt::Result {
    writeln!(out, "\n            before      after")?;
    let mut largest = [0.0_f64; 2];
    for (k, name) in NAMES.iter().enumerate() {
        let (scale, unit) = if is_length(k) { (1e3, "um") } else { (1e6, "urad") };
        writeln!(out, "  {name}  {:>9.2}  {:>9.2} {unit}", before.piges[k] * scale, after.piges[k] * scale)?;
        if is_length(k) {
            largest[0] = largest[0].max(before.piges[k].abs() * scale);
            largest[1] = largest[1].max(after.piges[k].abs() * scale);
        }
    }
    writeln!(out, "  largest position error {:.1} -> {:.1} um", largest[0], largest[1])
}

fn circle_report(out: &mut String, found: &CircleCalibration) -> std::fmt::Result {
    writeln!(
        out,
        "circles, {} readings, {:.3} um left (standard deviation)",
        found.estimate.residuals.len(),
        found.estimate.sigma * 1e3
    )?;
    for (name, term) in ["EC0Y", "EB0Z", "EA0Z"].into_iter().zip(found.squareness_rad) {
        if let Some(t) = term {
            writeln!(out, "  {name}        {:>9.2} ± {:.2} urad", t.value * 1e6, t.half_width_95 * 1e6)?;
        }
    }
    for (name, term) in ["X-Y", "Z-X", "Y-Z"].into_iter().zip(found.mismatch) {
        if let Some(t) = term {
            writeln!(
                out,
                "  scale {name}   {:>9.2} ± {:.2} um/m (one axis against the other: a bar sees no common scale)",
                t.value * 1e6,
                t.half_width_95 * 1e6
            )?;
        }
    }
    if let [Some(a), Some(b), Some(c)] = found.mismatch {
        let closure = (a.value + b.value + c.value) * 1e6;
        let u = (a.half_width_95 * a.half_width_95
            + b.half_width_95 * b.half_width_95
            + c.half_width_95 * c.half_width_95)
            .sqrt()
            * 1e6;
        writeln!(out, "  closure     {closure:>9.2} ± {u:.2} um/m (the three must add up to 0)")?;
    }
    for (axis, term) in Axis::ALL.iter().zip(found.backlash_mm) {
        match term {
            Some(t) => {
                writeln!(out, "  backlash {axis}  {:>9.2} ± {:.2} um", t.value * 1e3, t.half_width_95 * 1e3)?
            }
            None => writeln!(
                out,
                "  backlash {axis}  not seen: no reading says the direction of {axis} both ways"
            )?,
        }
    }
    Ok(())
}
