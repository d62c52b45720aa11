//! `vpost calibrate volumetric`.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

use calibration::volumetric::{Options, Point, PointReading, VolumetricCalibration, calibrate};
use clap::Args;
use diagnostic::Diagnostic;
use machine_model::{Axis, Vector};
use machine_profile::Calibrated;

use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages, Report};

use super::codes::{UNFIT, failure, question};
use super::output::{Output, Target};
use super::sheet::{Row, Sheet};

/// `vpost calibrate volumetric FILES… -o PROFILE`
#[derive(Debug, Args)]
pub struct Volumetric {
    /// Measured points (CSV): dx_um dy_um dz_um, xm_mm ym_mm zm_mm, or length_mm from a station bx_mm by_mm bz_mm.
    #[arg(value_name = "POINTS.csv", required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub target: Target,
    /// Nodes of the tables per axis.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub nodes: usize,
    /// Every so-manieth point is held out of the fit and judges it; 0: none.
    #[arg(long, value_name = "K", default_value_t = 5)]
    pub holdout_every: usize,
}

const COLUMNS: [&str; 25] = [
    "run",
    "x_mm",
    "y_mm",
    "z_mm",
    "dx_um",
    "dy_um",
    "dz_um",
    "xm_mm",
    "ym_mm",
    "zm_mm",
    "length_mm",
    "bx_mm",
    "by_mm",
    "bz_mm",
    "tool_x_mm",
    "tool_y_mm",
    "tool_z_mm",
    "dir_x",
    "dir_y",
    "dir_z",
    "u_um",
    "repeat",
    "temp_c",
    "time_s",
    "note",
];

/// `vpost calibrate volumetric`
pub(super) fn run(arguments: &Volumetric, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let mut points: Vec<Point> = Vec::new();
    let mut runs: BTreeMap<String, usize> = BTreeMap::new();
    let mut temperatures = Vec::new();
    let mut output = Output::start(&arguments.target, shared)?;
    let chain = output.chain(&arguments.target)?;
    let default_tool = output.base.as_ref().map_or([0.0; 3], |base| base.default_tool_mm);
    for path in &arguments.files {
        let sheet = Sheet::read(path, &COLUMNS, &arguments.target.ignore_column)?;
        sheet.need(&["x_mm", "y_mm", "z_mm"], "the commanded position of all three axes is needed")?;
        if !["dx_um", "dy_um", "dz_um", "xm_mm", "length_mm"].iter().any(|c| sheet.has(c)) {
            return Err(question(
                format!("{} has no reading", sheet.name),
                "give dx_um,dy_um,dz_um, or xm_mm,ym_mm,zm_mm, or length_mm with bx_mm,by_mm,bz_mm",
            ));
        }
        for row in sheet.rows() {
            let name = format!("{}:{}", sheet.name, row.text("run"));
            let next = runs.len();
            let run = *runs.entry(name).or_insert(next);
            points.push(point(&row, run, default_tool)?);
            temperatures.extend(row.number("temp_c")?);
        }
    }
    let options = Options { nodes: arguments.nodes, holdout_every: arguments.holdout_every };
    let found = calibrate(&points, &chain, options).map_err(|error| failure("", &[], &error))?;
    file::print(report(&found).as_bytes())?;
    if let Some(([before, after], count)) = found.holdout
        && after >= before
    {
        let message = format!(
            "{count} points that the fit did not see get no better by it: {:.2} um RMS before, {:.2} um after",
            before * 1e3,
            after * 1e3
        );
        return Err(Failure::Refused(vec![Report {
            source: None,
            diagnostics: vec![
                Diagnostic::error(UNFIT, message).help("measure more points, or fit less: `--nodes 3`"),
            ],
        }]));
    }
    write_profile(&mut output, &found);
    let temperature_c =
        (!temperatures.is_empty()).then(|| temperatures.iter().sum::<f64>() / temperatures.len() as f64);
    output.calibrated(
        &arguments.target,
        messages,
        Calibrated {
            temperature_c,
            repeatability_um: Some(found.fitted_rms_mm[1] * 1e3),
            uncertainty_um: Some(found.far_corner_u95_mm * 1e3),
            ..Calibrated::default()
        },
    )?;
    output.write(&arguments.target, messages)
}

fn point(row: &Row<'_>, run: usize, default_tool: [f64; 3]) -> Result<Point, Failure> {
    let commanded = row.three(["x_mm", "y_mm", "z_mm"])?;
    let mut tool = default_tool;
    for (own, column) in tool.iter_mut().zip(["tool_x_mm", "tool_y_mm", "tool_z_mm"]) {
        *own = row.number(column)?.unwrap_or(*own);
    }
    let reading = if let Some(length_mm) = row.number("length_mm")? {
        PointReading::Distance {
            length_mm,
            station_mm: Vector::from(row.three(["bx_mm", "by_mm", "bz_mm"])?),
        }
    } else {
        let mut deviation = [None; 3];
        for i in 0..3 {
            deviation[i] = row.number(["dx_um", "dy_um", "dz_um"][i])?.map(|um| um * 1e-3);
            if let Some(measured) = row.number(["xm_mm", "ym_mm", "zm_mm"][i])? {
                deviation[i] = Some(measured - commanded[i] - tool[i]);
            }
        }
        PointReading::Deviation(deviation)
    };
    Ok(Point {
        run,
        commanded_mm: Vector::from(commanded),
        tool_mm: Vector::from(tool),
        reading,
        uncertainty_mm: row.number("u_um")?.map(|u| u * 1e-3),
    })
}

fn write_profile(output: &mut Output, found: &VolumetricCalibration) {
    for axis in 0..3 {
        let mut functions: [Option<Vec<f64>>; 6] = Default::default();
        for f in found.functions.iter().filter(|f| f.axis == axis) {
            functions[f.function] = Some(f.values.clone());
        }
        output.errors(Axis::ALL[axis], "errors", &found.nodes_mm[axis], &functions);
        let letter = Axis::ALL[axis].letter();
        output.text.remove(&["axis", &letter.to_string(), "errors_negative"]);
        let others: Vec<(char, f64)> =
            (0..3).filter(|&k| k != axis).map(|k| (Axis::ALL[k].letter(), 0.0)).collect();
        output.text.set_measured_at(letter, &others, [0.0; 3]);
    }
    output.text.set_text(&["interpolation"], "linear");
    for (key, term) in ["EC0Y_urad", "EB0Z_urad", "EA0Z_urad"].into_iter().zip(found.squareness_rad) {
        output.text.set_number(&["squareness", key], term.map_or(0.0, |(value, _)| value * 1e6), 3);
    }
}

fn report(found: &VolumetricCalibration) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_report(&mut out, found);
    out
}

fn write_report(out: &mut String, found: &VolumetricCalibration) -> std::fmt::Result {
    writeln!(out, "term   from … to, largest half width of the 95 % intervals")?;
    for f in &found.functions {
        let (scale, unit) = if f.function < 3 { (1e3, "um") } else { (1e6, "urad") };
        let low = f.values.iter().copied().fold(f64::INFINITY, f64::min) * scale;
        let high = f.values.iter().copied().fold(f64::NEG_INFINITY, f64::max) * scale;
        let u = f.half_widths_95.iter().copied().fold(0.0, f64::max) * scale;
        writeln!(
            out,
            "E{}{}    {low:.2} … {high:.2} ± {u:.2} {unit}",
            Axis::ALL[f.function],
            Axis::ALL[f.axis]
        )?;
    }
    for (name, term) in ["EC0Y", "EB0Z", "EA0Z"].into_iter().zip(found.squareness_rad) {
        if let Some((value, half)) = term {
            writeln!(out, "{name}   {:.2} ± {:.2} urad", value * 1e6, half * 1e6)?;
        }
    }
    for (term, rivals) in &found.open {
        if rivals.is_empty() {
            writeln!(out, "{term:<6} open: the points say nothing of it; taken as 0")?;
        } else {
            writeln!(out, "{term:<6} open: these points cannot tell it from {rivals}; taken as 0")?;
        }
    }
    if found.open.iter().any(|(term, _)| matches!(term.chars().nth(1), Some('A' | 'B' | 'C'))) {
        writeln!(
            out,
            "       angles need other tool vectors, or other positions of the axes behind, to be seen"
        )?;
    }
    let [before, after] = found.fitted_rms_mm.map(|v| v * 1e3);
    writeln!(out, "fitted {before:.2} -> {after:.2} um RMS ({} readings)", found.estimate.residuals.len())?;
    if let Some(([before, after], count)) = found.holdout {
        writeln!(out, "unseen {:.2} -> {:.2} um RMS ({count} points)", before * 1e3, after * 1e3)?;
    }
    writeln!(out, "far corner known to ±{:.2} um (95 %)", found.far_corner_u95_mm * 1e3)
}
