//! `vpost calibrate volumetric`.

use std::path::PathBuf;

use calibration::rigid_motion::RigidMotion;
use calibration::volumetric::{Options, VolumetricCalibration, calibrate};
use calibration::{Point, PointReading, SetUp};
use clap::Args;
use diagnostic::{Text, both, notice};
use machine_model::{Axis, Component, Vector};
use measurement_files::{Row, micro, numbered};

use crate::conditions::conditions;
use crate::message::Failure;
use crate::profile::load_mill;

use super::codes::{DOUBTFUL, QUESTION, UNFIT};
use super::output::{Output, Target};
use super::sources::{self, line, span, three};
use super::work::Work;

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
    /// One point of so many is held out of a first fit and judges it, spread over the rows; 0: none.
    #[arg(long, value_name = "K", default_value_t = 5)]
    pub holdout_every: usize,
}

const COLUMNS: &str = "run x_mm y_mm z_mm a_deg b_deg c_deg dx_um dy_um dz_um xm_mm ym_mm zm_mm length_mm bx_mm by_mm bz_mm \
                       tool_x_mm tool_y_mm tool_z_mm dir_x dir_y dir_z u_um repeat temp_c time_s load_kg feed_mm_min note";

const EXPECTED: Text = Text::pair(
    "expected: run,x_mm,y_mm,z_mm and dx_um,dy_um,dz_um, or xm_mm,ym_mm,zm_mm, or length_mm,bx_mm,by_mm,bz_mm",
    "ожидалось: run,x_mm,y_mm,z_mm и dx_um,dy_um,dz_um, или xm_mm,ym_mm,zm_mm, или length_mm,bx_mm,by_mm,bz_mm",
);

/// The points of all files, and the names of their runs, with the file where there are several.
fn read(
    arguments: &Volumetric,
    work: &Work<'_>,
    output: &Output,
) -> Result<(sources::Read<Point>, Vec<String>), Failure> {
    let (mut all, mut runs) = (sources::Read::default(), Vec::new());
    let said = conditions(work.options)?;
    for path in &arguments.files {
        let sheet = sources::sheet(work.read(path)?, COLUMNS, EXPECTED, &arguments.target.ignore_column)?;
        sheet.need(
            &["x_mm", "y_mm", "z_mm"],
            both!(
                "the commanded position of all three axes is needed",
                "нужно заданное положение всех трёх осей"
            ),
        )?;
        if !["dx_um", "dy_um", "dz_um", "xm_mm", "length_mm"].iter().any(|c| sheet.has(c)) {
            return Err(Failure::usage(notice!(QUESTION;
                "{} has no reading", "в {} нет показаний", sheet.name();
                "give dx_um,dy_um,dz_um, or xm_mm,ym_mm,zm_mm, or length_mm with bx_mm,by_mm,bz_mm",
                "дайте dx_um,dy_um,dz_um, или xm_mm,ym_mm,zm_mm, или length_mm с bx_mm,by_mm,bz_mm"
            )));
        }
        if sheet.has("length_mm") {
            sheet.need(
                &["bx_mm", "by_mm", "bz_mm"],
                both!(
                    "a distance needs the place of its station, to a few millimetres",
                    "расстоянию нужно место стоянки, с точностью до миллиметров"
                ),
            )?;
        }
        let file = sheet.name().to_owned();
        all.add(sheet, |row| {
            let mut name = row.text("run").into_owned();
            if arguments.files.len() > 1 || name.is_empty() {
                name = format!("{file} {name}").trim_end().to_owned();
            }
            let mut point = point(row, numbered(&mut runs, &name), output)?;
            let here = sources::conditions_of(row, said, arguments.target.temperature)?;
            point.by_effects_mm = output.by_effects_mm(&point.command, &here)?;
            Ok(point)
        })?;
    }
    let stated = all.rows.iter().filter(|point: &&Point| point.uncertainty_mm.is_some()).count();
    sources::all_state_or_none(stated, all.rows.len())?;
    Ok((all, runs))
}

fn point(row: &Row<'_>, run: usize, output: &Output) -> Result<Point, Failure> {
    let command = row.command(output.base.as_ref().map_or([0.0; 3], |base| base.default_tool_mm))?;
    let positions = row.any_of(["xm_mm", "ym_mm", "zm_mm"])?;
    let reading = if let Some(length_mm) = row.number("length_mm")? {
        PointReading::Distance {
            length_mm,
            station_mm: Vector::from(row.three(["bx_mm", "by_mm", "bz_mm"])?),
        }
    } else if positions.iter().any(Option::is_some) {
        PointReading::Position(positions)
    } else {
        let deviations_um = row.any_of(["dx_um", "dy_um", "dz_um"])?;
        PointReading::Deviation(deviations_um.map(|um| um.map(|um| um * 1e-3)))
    };
    let uncertainty_mm = sources::uncertainty_mm(row, "u_um")?;
    Ok(Point { run, command, by_effects_mm: Vector::zeros(), reading, uncertainty_mm })
}

/// `vpost calibrate volumetric`
pub(super) fn run(arguments: &Volumetric, work: &Work<'_>) -> Result<(), Failure> {
    let mut output = Output::start(&arguments.target, work, load_mill)?;
    let base = output.measured_from(&arguments.target)?;
    let (read, runs) = read(arguments, work, &output)?;
    let options = Options { nodes: arguments.nodes, holdout_every: arguments.holdout_every };
    let found = calibrate(&read.rows, &base, options).map_err(|error| read.refused("x_mm", &error))?;
    work.print(&report(&found, &runs));
    judge(&found, work)?;
    output.changed(&base, &found.axes, &found.description);
    output.set_up(&found.setups);
    let known_mm = [Some(found.estimate.rms()), Some(found.field_u95_mm)];
    output.write(&arguments.target, work, read.temperature_c(), known_mm)
}

/// Refuses what held-out readings refute; warns where the readings scatter more than they state.
fn judge(found: &VolumetricCalibration, work: &Work<'_>) -> Result<(), Failure> {
    let misfit = found.estimate.misfit;
    let stated = found.estimate.degrees_of_freedom.is_none();
    if let Some(([before, after], count)) = found.holdout
        && found.refuted
    {
        return Err(Failure::unfit(notice!(UNFIT;
            "{count} points that the fit did not see get no better by it: {:.2} um RMS before, {:.2} um after",
            "точки, оставленные для проверки ({count}), лучше не становятся: {:.2} мкм до, {:.2} мкм после (среднеквадратичное)",
            before * 1e3, after * 1e3;
            "measure more points, or fit less: `--nodes 3`",
            "измерьте больше точек или определяйте меньше: `--nodes 3`"
        )));
    }
    if stated && misfit > CONTRADICTION {
        return Err(Failure::unfit(notice!(UNFIT;
            "the readings contradict every machine of this chain: the best one leaves {misfit:.1} times what `u_um` states",
            "показания противоречат любому станку с такой цепью: лучший оставляет в {misfit:.1} раза больше, чем говорит `u_um`";
            "look for exchanged or shifted columns; if the machine is that rough, give more `--nodes` or a larger u_um",
            "ищите переставленные или сдвинутые столбцы; если станок так неровен, дайте больше `--nodes` или больший u_um"
        )));
    }
    if stated && misfit > ROUGH {
        work.warning(notice!(DOUBTFUL;
            "the best machine leaves {misfit:.1} times what `u_um` states: uncertainties are widened by as much",
            "лучший станок оставляет в {misfit:.1} раза больше, чем говорит `u_um`: неопределённости увеличены во столько же раз";
            "give more `--nodes`, or state what the readings really scatter",
            "дайте больше `--nodes` или укажите действительный разброс показаний"
        ));
    }
    Ok(())
}

/// What is left of the readings, in units of their stated uncertainty, is a contradiction above this.
const CONTRADICTION: f64 = 10.0;

/// Above this the stated uncertainty does not explain what is left.
const ROUGH: f64 = 1.5;

/// How an instrument stood.
pub(super) fn moved(motion: &RigidMotion) -> Text {
    let (shift, turn) = (three(&motion.shift_mm, 4), three(&(motion.rotation_rad() * 1e6), 1));
    both!("shift {shift} mm, rotation {turn} urad", "сдвиг {shift} мм, поворот {turn} мкрад")
}

fn report(found: &VolumetricCalibration, runs: &[String]) -> Text {
    let mut out = Text::pair(
        "change from … to, largest half width of the 95 % intervals\n",
        "изменение от … до, наибольшая полуширина 95-процентных интервалов\n",
    );
    for f in &found.functions {
        let (scale, unit) = micro(Component::of(f.function));
        let (low, high) = span(f.values.iter().map(|value| value * scale));
        let u = f.half_widths_95.iter().copied().fold(0.0, f64::max) * scale;
        let (function, axis) = (Axis::ALL[f.function], Axis::ALL[f.axis]);
        out.push(&line(format_args!("E{function}{axis}    {low:.2} … {high:.2} ± {u:.2}"), &unit));
    }
    out.push(&Text::pair("machine\n", "станок\n"));
    for (name, (value, half)) in ["EC0Y", "EB0Z", "EA0Z"].into_iter().zip(found.squareness_rad) {
        let (scale, unit) = micro(Component::Angular);
        out.push(&line(format_args!("{name}   {:.2} ± {:.2}", value * scale, half * scale), &unit));
    }
    for (axis, play) in found.play_mm.iter().enumerate() {
        if let Some((value, half)) = play {
            let (axis, value, half) = (Axis::ALL[axis], value * 1e3, half * 1e3);
            out.push(&both!(
                "play {axis} {value:.2} ± {half:.2} um\n",
                "люфт {axis} {value:.2} ± {half:.2} мкм\n"
            ));
        }
    }
    open(found, &mut out);
    out.push(&Text::pair(
        "gauge  X along its line, Y in its plane (EYX, EZX, EZY change by no slope); changes of positioning, straightness and of\n       the angles of the two axes next to the workpiece are 0 in the mean; slopes of EXY, EXZ, EYZ are squareness\n",
        "отсчёт X вдоль своей линии, Y в своей плоскости (у EYX, EZX, EZY нет наклона); изменения позиционирования, прямолинейности\n       и углов двух ближних к детали осей в среднем равны 0; наклоны EXY, EXZ, EYZ — это отклонения от перпендикулярности\n",
    ));
    set_ups(found, runs, &mut out);
    if found.left_out > 0 {
        out.push(&both!(
            "{} points lie outside the base's volume and were left out\n",
            "точек вне объёма исходного профиля: {}, они не использованы\n",
            found.left_out
        ));
    }
    let [before, after] = found.fitted_rms_mm.map(|v| v * 1e3);
    out.push(&both!(
        "fitted {before:.2} -> {after:.2} um RMS ({} readings)\n",
        "подгонка: СКЗ {before:.2} -> {after:.2} мкм (отсчётов {})\n",
        found.estimate.residuals.len()
    ));
    if let Some(([before, after], count)) = found.holdout {
        let [before, after] = [before, after].map(|mm| mm * 1e3);
        out.push(&both!(
            "unseen {before:.2} -> {after:.2} um RMS ({count} points)\n",
            "новые точки: СКЗ {before:.2} -> {after:.2} мкм (точек {count})\n"
        ));
    }
    out.push(&both!(
        "field known to ±{:.2} um at 95 % of the points of the volume, frames taken off\n",
        "поле известно с точностью ±{:.2} мкм в 95 % точек объёма, без систем координат\n",
        found.field_u95_mm * 1e3
    ));
    out
}

/// What the points do not tell.
fn open(found: &VolumetricCalibration, out: &mut Text) {
    for (term, rivals) in &found.open {
        out.push(&if rivals.is_empty() {
            both!(
                "{term:<6} open: the points say nothing of it; as in the base\n",
                "{term:<#6} открыто: точки ничего об этом не говорят; как в исходном профиле\n"
            )
        } else {
            both!(
                "{term:<6} open in part, which these points cannot tell from {rivals}: that stays as in the base\n",
                "{term:<#6} открыто в той части, которую эти точки не различают ({rivals:#}): она остаётся как в исходном профиле\n"
            )
        });
    }
    if found.open.iter().any(|(term, _)| matches!(term.english().chars().nth(1), Some('A' | 'B' | 'C'))) {
        out.push(&Text::pair(
            "       angles need other tool vectors in one run, or other positions of the axes behind, to be seen\n",
            "       чтобы увидеть углы, нужны другие векторы инструмента в одной серии или другие положения следующих осей\n",
        ));
    }
}

/// How the instrument stood in each run.
fn set_ups(found: &VolumetricCalibration, runs: &[String], out: &mut Text) {
    for (run, setup) in runs.iter().zip(&found.setups) {
        out.push(&match setup {
            Some(SetUp::Frame(motion)) => {
                let moved = moved(motion);
                both!("set-up {run}: {moved}\n", "установка {run}: {moved:#}\n")
            }
            Some(SetUp::Station { place_mm, zero_mm }) => both!(
                "station {run}: {} mm, zero {zero_mm:.4} mm\n",
                "станция {run}: {} мм, нуль {zero_mm:.4} мм\n",
                three(place_mm, 4)
            ),
            None => Text::EMPTY,
        });
    }
    if found.setups.len() > 1 {
        out.push(&both!(
            "       [setup] of a profile is one: of these {} none is written, and `predict --include-setup` adds none\n",
            "       раздел [setup] в профиле один: из этих {} не записана ни одна, и `predict --include-setup` ничего не прибавит\n",
            found.setups.len()
        ));
    }
}
