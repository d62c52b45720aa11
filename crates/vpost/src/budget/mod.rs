//! `vpost budget`: what each deviation costs, what they may come to together, and what each may be.

mod arguments;
mod control_points;
mod json;
mod study;
mod text;

pub use arguments::Budget;

use diagnostic::{Code, Diagnostic, both};
use error_budget::Machine;
use jobs::datums::FromZero;
use machine_model::EngineId;

use crate::arguments::Shared;
use crate::conditions::{conditions, failure};
use crate::message::{Failure, Messages, OPTION, notice};
use crate::roles::Roles;
use crate::settings::machine;
use crate::{file, profile};

/// A machine without deviations has no budget.
const NO_DEVIATIONS: Code = Code(917);
/// Warning: the target cannot be reached while some deviations stay as they are.
const OUT_OF_REACH: Code = Code(918);

/// `vpost budget -m PROFILE`
pub(crate) fn run(arguments: &Budget, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let path = machine(&shared.job)?;
    let profile::Loaded { profile, files, .. } = profile::load_mill(path)?;
    Roles::default()
        .reads_all(&both!("the control points", "контрольные точки"), &arguments.points)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &files)
        .writes("--json", arguments.json.as_deref())
        .are_apart()?;
    if let Some(id) = shared.job.engine().filter(|id| *id != EngineId::RigidBody) {
        return Err(Failure::usage(notice!(OPTION;
            "engine `{id}` has no deviations to be scaled one by one",
            "у метода `{id}` нет отклонений, которые можно менять по одному";
            "leave `--engine` out: a budget is of the rigid-body model",
            "уберите `--engine`: бюджет считается по модели твёрдых тел"
        )));
    }
    let target_mm = arguments.target.map(target_mm).transpose()?;
    let model = profile.machine(&conditions(&shared.job)?).map_err(|error| failure(&error))?;
    let machine = Machine::new(model);
    if machine.deviations().is_empty() {
        let message = both!(
            "{}: the rigid-body model of {} has no deviations",
            "{}: в модели твёрдых тел станка {} нет отклонений",
            file::name(path),
            profile.name
        );
        let traverses = profile.traverses.is_some();
        return Err(Failure::usage(Diagnostic::error(NO_DEVIATIONS, message).help(if traverses {
            both!("[tracker] is for the tracker engine only: give `errors` of the axes and [squareness], as `vpost calibrate` does", "[tracker] — только для метода tracker: дайте `errors` осей и [squareness], как это делает `vpost calibrate`")
        } else {
            both!("give the profile what was measured: `errors` of the axes, [squareness], [rotary.*] or [[effect]] entries", "внесите в профиль измеренное: `errors` осей, [squareness], [rotary.*] или разделы [[effect]]")
        })));
    }
    let keep = keep(arguments, &machine)?;
    let points = control_points::read(arguments, shared, &profile, &machine, messages)?;
    let from_zero = FromZero::of(&shared.job, &profile, machine.model(), arguments.datum.as_deref())?;
    let target = target_mm.map(|mm| (mm, keep));
    let study = study::Study::new(profile.name, machine, points, from_zero, target);
    if study.moves_nothing() {
        return Err(Failure::usage(notice!(NO_DEVIATIONS;
            "no deviation moves any of the control points",
            "ни одно отклонение не сдвигает контрольных точек";
            "take points away from the machine's zero, or with a tool: angles need an arm",
            "возьмите точки вдали от нуля станка или с инструментом: углам нужно плечо"
        )));
    }
    if let Some(why) = study.target.as_ref().and_then(study::Target::out_of_reach) {
        messages.warning(notice!(OUT_OF_REACH;
            "{} um cannot be reached: {why}", "{} мкм недостижимы: {why:#}", arguments.target.unwrap_or(0.0);
            "keep fewer deviations as they are (`--keep`), or raise `--target`",
            "сохраняйте меньше отклонений (`--keep`) или увеличьте `--target`"
        ));
    }
    if let Some(path) = &arguments.json {
        file::write(path, &json::bytes(&study))?;
    }
    file::print(text::page(&study).in_language(messages.language()).as_bytes())
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
fn keep(arguments: &Budget, machine: &Machine) -> Result<Vec<bool>, Failure> {
    let mut keep = vec![false; machine.deviations().len()];
    for given in arguments.keep.iter().flat_map(|list| list.split(',')).map(str::trim) {
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
