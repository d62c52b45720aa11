//! What each deviation costs, what they may come to together, and what each may be.

mod control_points;
pub mod json;
pub mod study;

use diagnostic::{Code, both};
use error_budget::Machine;
use machine_model::EngineId;
use machine_profile::Profile;

use crate::conditions::{conditions, failure};
use crate::datums::FromZero;
use crate::lines;
use crate::map::tool;
use crate::message::{Failure, OPTION, Report, notice};
use crate::options::JobOptions;
use crate::settings::machine;
use crate::values::{Given, ToolVector};
use control_points::Taken;
pub use control_points::{ControlPoints, Points};
use study::{Study, Target};

/// A machine without deviations has no budget.
const NO_DEVIATIONS: Code = Code(917);
/// Warning: the target cannot be reached while some deviations stay as they are.
const OUT_OF_REACH: Code = Code(918);

/// What is asked of a machine.
pub struct Asked<'a> {
    /// Where its error counts.
    pub points: Points<'a>,
    /// The profile's, where none is given.
    pub tool_vector: Option<&'a Given<ToolVector>>,
    /// The zero that errors count from.
    pub datum: Option<&'a str>,
    /// Wanted largest error, µm.
    pub target_um: Option<f64>,
    /// Deviations that stay as they are, names by commas.
    pub keep: &'a [String],
}

/// The budget of a machine, and what is to be said of it.
///
/// # Errors
/// What is asked for cannot be: another engine, no deviations, points outside the volume.
pub fn of(
    options: &JobOptions,
    profile: &Profile,
    asked: &Asked<'_>,
) -> Result<(Study, Vec<Report>), Failure> {
    if let Some(id) = options.engine().filter(|id| *id != EngineId::RigidBody) {
        return Err(Failure::usage(notice!(OPTION;
            "engine `{id}` has no deviations to be scaled one by one",
            "у метода `{id}` нет отклонений, которые можно менять по одному";
            "leave `--engine` out: a budget is of the rigid-body model",
            "уберите `--engine`: бюджет считается по модели твёрдых тел"
        )));
    }
    let target_mm = asked.target_um.map(target_mm).transpose()?;
    let model = profile.machine(&conditions(options)?).map_err(|error| failure(&error))?;
    let machine = Machine::new(model);
    if machine.deviations().is_empty() {
        return Err(without_deviations(options, profile)?);
    }
    let keep = keep(asked.keep, &machine)?;
    let tool_mm = tool(asked.tool_vector, options, profile)?;
    let mut taken = Taken { options, profile, machine: &machine, tool_mm, warnings: Vec::new() };
    let points = taken.points(&asked.points)?;
    let mut warnings = taken.warnings;
    let from_zero = FromZero::of(options, profile, machine.model(), asked.datum)?;
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
            "{} um cannot be reached: {why}", "{} мкм недостижимы: {why:#}", asked.target_um.unwrap_or(0.0);
            "keep fewer deviations as they are (`--keep`), or raise `--target`",
            "сохраняйте меньше отклонений (`--keep`) или увеличьте `--target`"
        )));
    }
    Ok((study, warnings))
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
