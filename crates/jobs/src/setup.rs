//! Against what programs are read: zeros, tools, and where axes stand.

use diagnostic::notice;
use machine_model::Engine;
use machine_profile::Profile;
use nc_program::{AfterChange, BetweenVectors, Setup};

use crate::message::{Failure, OPTION};
use crate::options::JobOptions;
use crate::stored::Stored;

/// Against what programs are read.
///
/// # Errors
/// A start that contradicts the machine.
pub(crate) fn setup(options: &JobOptions, profile: &Profile, stored: &Stored) -> Result<Setup, Failure> {
    let mut setup = Setup {
        work_offsets: stored.work_offsets.as_ref().unwrap_or(&profile.work_offsets).clone(),
        tools: with_options(options, stored.lengths.as_ref().unwrap_or(&profile.tools)),
        tool_names: profile.tool_names.clone(),
        edge_at_change: profile.program.edge_at_change,
        t_means_h: profile.program.t_means_h,
        noses_mm: noses_mm(profile),
        radii_mm: profile.cutter_radii_mm.clone(),
        default_tool_mm: profile.default_tool_mm,
        gauge_point_mm: profile.gauge_point_mm,
        lever_matters: profile.lever_matters(),
        has_rotary: profile.has_rotary(),
        rotary_matters: profile.rotary_matters(),
        start_mm: [None; 3],
        start_deg: profile.program.rotary_start_deg,
        tool_change: profile.program.tool_change.map(|change| match change {
            machine_profile::AfterChange::Unknown => AfterChange::Unknown,
            machine_profile::AfterChange::Stays => AfterChange::Stays,
            machine_profile::AfterChange::At(place_mm) => AfterChange::At(place_mm),
        }),
        tip_control: nc_program::TipControl::default(),
        rotary_chain: profile.rotary_chain(),
        tilt_rule: profile.kinematics.as_ref().map(|kinematics| kinematics.tilt_rule).unwrap_or_default(),
        vectors: profile
            .kinematics
            .as_ref()
            .and_then(|kinematics| kinematics.great_circle)
            .map(|circle| if circle { BetweenVectors::GreatCircle } else { BetweenVectors::Axes }),
        tip_at_start: profile.kinematics.as_ref().is_some_and(|kinematics| kinematics.at_start),
        diameters: profile.program.diameters,
        lengths_settled: false,
    };
    for given in &options.work_offset {
        match setup.work_offsets.iter_mut().find(|(known, _)| *known == given.name) {
            Some(entry) => entry.1 = given.zero_mm,
            None => setup.work_offsets.push((given.name.clone(), given.zero_mm)),
        }
    }
    if let Some(start) = &options.start_at {
        if setup.tip_at_start && start.linear_mm.iter().any(Option::is_some) {
            return Err(Failure::usage(notice!(OPTION;
                "`--start-at` gives axis commands, and the profile says that programs begin under tool centre point control",
                "`--start-at` задаёт команды осей, а по профилю программы начинаются при управлении по вершине инструмента";
                "give rotary axes alone, as in `--start-at A=0,C=0`: the first rapid that names X, Y and Z says where the tip is",
                "задайте только поворотные оси, например `--start-at A=0,C=0`: где вершина, скажет первый быстрый ход, в котором названы X, Y и Z"
            )));
        }
        if let Some(axis) = (0..3).find(|i| start.rotary_deg[*i].is_some() && !setup.has_rotary[*i]) {
            let name = ["A", "B", "C"][axis];
            return Err(Failure::usage(notice!(OPTION;
                "`--start-at` says where {name} stands, and the machine has no such axis",
                "`--start-at` говорит, где стоит {name}, а такой оси у станка нет";
                "leave it out, or name {name} in `chain` of the profile",
                "уберите её или назовите {name} в `chain` профиля"
            )));
        }
        setup.start_mm = start.linear_mm;
        setup.start_deg = [0, 1, 2].map(|axis| start.rotary_deg[axis].or(setup.start_deg[axis]));
    }
    Ok(setup)
}

/// Where nothing is corrected no program need say where its axes begin: one place is as good as another.
pub(crate) fn start_anywhere(profile: &Profile, engine: &dyn Engine, setup: &mut Setup) {
    let asks = profile.has_errors() || setup.rotary_matters || setup.tip_at_start;
    if let (false, Some(model)) = (asks, engine.path_model()) {
        let middle_mm = model.volume().0.map(|range| 0.5 * (range.low + range.high));
        setup.start_mm = [0, 1, 2].map(|axis| setup.start_mm[axis].or(Some(middle_mm[axis])));
    }
}

/// Radii of the noses of turning tools.
fn noses_mm(profile: &Profile) -> Vec<(u32, f64)> {
    let noses = profile.lathe.iter().flat_map(|lathe| &lathe.noses);
    noses.filter(|(_, nose)| nose.radius_mm > 0.0).map(|(number, nose)| (*number, nose.radius_mm)).collect()
}

/// Length vectors of the H numbers: the profile's and the command line's.
#[must_use]
pub fn tools(options: &JobOptions, profile: &Profile) -> Vec<(u32, [f64; 3])> {
    with_options(options, &profile.tools)
}

fn with_options(options: &JobOptions, known: &[(u32, [f64; 3])]) -> Vec<(u32, [f64; 3])> {
    let mut tools = known.to_vec();
    for given in &options.tool {
        match tools.iter_mut().find(|(known, _)| *known == given.number) {
            Some(entry) => entry.1 = given.vector_mm,
            None => tools.push((given.number, given.vector_mm)),
        }
    }
    tools
}
