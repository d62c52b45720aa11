//! What each deviation costs, what they may come to together, and what each may be.

mod control_points;
pub mod json;
pub mod study;
pub mod text;

use std::path::PathBuf;

use clap::Args;
use diagnostic::{Code, both, notice};
use error_budget::Machine;
use machine_model::EngineId;
use machine_profile::Profile;

use crate::conditions::{conditions, failure};
use crate::datums::FromZero;
use crate::lines;
use crate::map::tool;
use crate::message::{Failure, OPTION, Report};
use crate::options::{JobOptions, Read};
use crate::settings::machine;
use crate::values::{Ball, Given, Lattice, Rotary, ToolVector};
pub use control_points::ControlPoints;
use control_points::Taken;
use study::{Study, Target};

/// A machine without deviations has no budget.
const NO_DEVIATIONS: Code = Code(917);
/// Warning: the target cannot be reached while some deviations stay as they are.
const OUT_OF_REACH: Code = Code(918);

/// What is asked of a machine, as it is typed.
#[derive(Debug, Args)]
pub struct BudgetOptions {
    /// Control points: nodes of X, Y and Z, how many over the calibrated volume (22x22x21), or from:to:step in mm for
    /// each (40:880:40,30:450:20,5:505:25).
    #[arg(long, value_name = "NXxNYxNZ|X,Y,Z", default_value = "21x21x21", allow_hyphen_values = true)]
    pub grid: Given<Lattice>,
    /// Control points of a file instead (CSV, as for `vpost predict`); - for standard input.
    #[arg(long, value_name = "POINTS.csv", conflicts_with_all = ["grid", "rotary"])]
    pub points: Option<PathBuf>,
    /// Control points: a ball on the rotary table, at a radius and a height from its centre, mm, which the linear axes
    /// follow through the angles of both rotary axes in steps of 30 degrees; the leading axis turns slowest.
    #[arg(long, value_name = "R=MM,H=MM,lead=AXIS", allow_hyphen_values = true, conflicts_with_all = ["grid", "rotary", "points"])]
    pub ball: Option<Given<Ball>>,
    /// Tool vector, gauge point to tip, mm: an H number of the profile or X,Y,Z; default: the profile's.
    #[arg(long, value_name = "H1|X,Y,Z", allow_hyphen_values = true)]
    pub tool_vector: Option<Given<ToolVector>>,
    /// Where the rotary axes stand at the nodes of the grid, degrees; 0 if not given.
    #[arg(long, value_name = "A=DEG,…", allow_hyphen_values = true)]
    pub rotary: Option<Given<Rotary>>,
    /// Count errors from this zero of the profile, as it was touched.
    #[arg(long, value_name = "G54")]
    pub datum: Option<String>,
    /// Wanted M, largest error at the control points, µm: what to mend, and what each deviation may be.
    #[arg(long, value_name = "UM", allow_hyphen_values = true)]
    pub target: Option<f64>,
    /// Deviations that stay as they are while the others are made smaller: EXX,EC0Y (repeatable).
    #[arg(long, value_name = "NAME,…", requires = "target")]
    pub keep: Vec<String>,
}

/// The budget of a machine.
///
/// * `read` – reads the file of the control points
/// * `warnings` – what is to be said of it, also where it fails
///
/// # Errors
/// What is asked for cannot be: another engine, no deviations, points outside the volume.
pub fn of(
    options: &JobOptions,
    profile: &Profile,
    asked: &BudgetOptions,
    read: Read<'_>,
    warnings: &mut Vec<Report>,
) -> Result<Study, Failure> {
    if let Some(id) = options.engine().filter(|id| *id != EngineId::RigidBody) {
        return Err(Failure::usage(notice!(OPTION;
            "engine `{id}` has no deviations to be scaled one by one",
            "у метода `{id}` нет отклонений, которые можно менять по одному";
            "leave `--engine` out: a budget is of the rigid-body model",
            "уберите `--engine`: бюджет считается по модели твёрдых тел"
        )));
    }
    let target_mm = asked.target.map(target_mm).transpose()?;
    let model = profile.machine(&conditions(options)?).map_err(|error| failure(&error))?;
    let machine = Machine::new(model);
    if machine.deviations().is_empty() {
        return Err(without_deviations(options, profile)?);
    }
    let keep = keep(&asked.keep, &machine)?;
    let tool_mm = tool(asked.tool_vector.as_ref(), options, profile)?;
    let mut taken = Taken { options, profile, machine: &machine, tool_mm, warnings };
    let points = match (&asked.ball, &asked.points) {
        (Some(ball), _) => taken.on_a_ball(ball),
        (None, Some(path)) => taken.in_a_file(&lines::name(path), &read(path)?),
        (None, None) => taken.over_the_volume(&asked.grid, asked.rotary.as_ref()),
    }?;
    let from_zero = FromZero::of(options, profile, machine.model(), asked.datum.as_deref())?;
    let target = target_mm.map(|mm| (mm, keep));
    let study = Study::new(profile.name.clone(), machine, points, from_zero, target);
    if study.moves_nothing() {
        return Err(Failure::usage(notice!(NO_DEVIATIONS;
            "no deviation moves any of the control points",
            "ни одно отклонение не сдвигает контрольных точек";
            "take points away from the machine's zero, or with a tool: angles need an arm",
            "возьмите точки вдали от нуля станка или с инструментом: углам нужно плечо"
        )));
    }
    if let Some(why) = study.target.as_ref().and_then(Target::out_of_reach) {
        warnings.push(Report::warning(notice!(OUT_OF_REACH;
            "{} um cannot be reached: {why}", "{} мкм недостижимы: {why:#}", asked.target.unwrap_or(0.0);
            "keep fewer deviations as they are (`--keep`), or raise `--target`",
            "сохраняйте меньше отклонений (`--keep`) или увеличьте `--target`"
        )));
    }
    Ok(study)
}

/// What to say of a profile whose model deviates by nothing.
fn without_deviations(options: &JobOptions, profile: &Profile) -> Result<Failure, Failure> {
    let help = if profile.traverses.is_some() {
        both!(
            "[tracker] is for the tracker engine only: give `errors` of the axes and [squareness], as `vpost calibrate` does",
            "[tracker] — только для метода tracker: дайте `errors` осей и [squareness], как это делает `vpost calibrate`"
        )
    } else {
        both!(
            "give the profile what was measured: `errors` of the axes, [squareness], [rotary.*] or [[effect]] entries",
            "внесите в профиль измеренное: `errors` осей, [squareness], [rotary.*] или разделы [[effect]]"
        )
    };
    Ok(Failure::usage(notice!(NO_DEVIATIONS;
        "{}: the rigid-body model of {} has no deviations", "{}: в модели твёрдых тел станка {} нет отклонений",
        lines::name(machine(options)?), profile.name;
        help
    )))
}

fn target_mm(target_um: f64) -> Result<f64, Failure> {
    /// A metre, µm: what is farther off is a slip.
    const FARTHEST_UM: f64 = 1e6;
    if target_um > 0.0 && target_um <= FARTHEST_UM {
        return Ok(target_um * 1e-3);
    }
    if target_um > FARTHEST_UM {
        return Err(Failure::usage(notice!(OPTION;
            "`--target {target_um}` is more than a metre", "`--target {target_um}` — больше метра";
            "give micrometres: `--target 50`", "дайте микрометры: `--target 50`"
        )));
    }
    Err(Failure::usage(notice!(OPTION;
        "`--target {target_um}`: no machine is that good", "`--target {target_um}`: таких точных станков нет";
        "give micrometres above zero: `--target 50`", "дайте микрометры больше нуля: `--target 50`"
    )))
}

/// Which deviations stay as they are.
fn keep(asked: &[String], machine: &Machine) -> Result<Vec<bool>, Failure> {
    let mut keep = vec![false; machine.deviations().len()];
    for given in asked.iter().flat_map(|list| list.split(',')).map(str::trim) {
        let mut known = false;
        for (deviation, keep) in machine.deviations().iter().zip(&mut keep) {
            if deviation.name.eq_ignore_ascii_case(given) {
                (*keep, known) = (true, true);
            }
        }
        if !known {
            let names: Vec<&str> = machine.deviations().iter().map(|d| d.name.as_str()).collect();
            return Err(Failure::usage(notice!(OPTION;
                "`--keep {given}`: this machine has no such deviation",
                "`--keep {given}`: такого отклонения у станка нет";
                "one of: {}", "одно из: {}", names.join(", ")
            )));
        }
    }
    Ok(keep)
}
