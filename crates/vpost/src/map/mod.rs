//! `vpost map`: what the machine does wrong over its volume, and where to put the zero point.

mod arguments;
mod dominant;
mod drawn;
mod export;
mod json;
mod page;
mod text;
mod viewer;

pub use arguments::Map;

use diagnostic::both;
use jobs::map::asked::Asked;
use jobs::map::study::Study;
use jobs::map::{dominant as deviations, grid, model, rotary, tool};
use machine_model::{Range, Vector, Volume};
use machine_profile::Profile;

use crate::arguments::Shared;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::settings::machine;
use crate::{conditions, file, profile};

/// `vpost map -m PROFILE`
pub(crate) fn run(arguments: &Map, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let loaded = profile::load_mill(machine(&shared.job)?)?;
    let profile = loaded.profile;
    Roles::default()
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &loaded.files)
        .writes("--csv", arguments.csv.as_deref())
        .writes("--vtk", arguments.vtk.as_deref())
        .writes("--json", arguments.json.as_deref())
        .writes("--html", arguments.html.as_deref())
        .writes("--viewer", arguments.viewer.as_deref())
        .are_apart()?;
    let under = conditions::conditions(&shared.job)?;
    let id = profile.forward_engine(shared.job.engine());
    let engine = profile.engine(id, &under).map_err(|error| conditions::failure(&error))?;
    let model = model(engine.as_ref())?;
    let asked = asked(arguments, shared, &profile, model.volume())?;
    jobs::map::require_tool(model, asked.tool_mm)?;
    conditions::doubts(&profile, id).iter().for_each(|report| messages.report(report));
    let grid_mm = asked.grid.axes().each_ref().map(|nodes| nodes.range_mm());
    outside(asked.part_box_mm.into_iter().chain([grid_mm]), model.volume(), shared, messages)?;
    let offsets = jobs::datums::of_offsets(&shared.job, &profile, engine.as_ref())?;
    let study = Study::new(&profile, id, model, offsets, asked)?;
    if let Some(path) = &arguments.csv {
        file::write(path, &export::csv(&study))?;
    }
    if let Some(path) = &arguments.vtk {
        file::write(path, &export::vtk(&study))?;
    }
    if let Some(path) = &arguments.json {
        file::write(path, &json::bytes(&study))?;
    }
    let dominant = deviations::dominant(&profile, id, &under, &study.asked);
    let doubts = conditions::doubts(&profile, id).into_iter().flat_map(|report| report.diagnostics);
    let facts = page::Facts {
        dominant,
        doubts: doubts.map(|doubt| doubt.message).collect(),
        ..facts(arguments, shared, &profile, machine(&shared.job)?, &loaded.hash)
    };
    if let Some(path) = &arguments.viewer {
        viewer::write(path, &profile, model, &study, &facts, (shared, messages))?;
    }
    if let Some(path) = &arguments.html {
        let json = String::from_utf8(json::bytes(&study)).expect("JSON is UTF-8");
        file::write(path, page::html(&study, &facts, &json, messages.language()).as_bytes())?;
    }
    file::print(text::page(&study).in_language(messages.language()).as_bytes())
}

/// Reads the options.
fn asked(arguments: &Map, shared: &Shared, profile: &Profile, volume: Volume) -> Result<Asked, Failure> {
    Ok(Asked {
        grid: grid(&arguments.grid, volume)?,
        tool_mm: tool(arguments.tool_vector.as_ref(), &shared.job, profile)?,
        rotary_rad: rotary(arguments.rotary.as_ref(), profile)?,
        within_mm: arguments.within * 1e-3,
        regions: arguments.region.iter().map(|given| (given.name.clone(), given.ranges_mm)).collect(),
        planes: arguments.plane.iter().map(|given| (given.plane, given.at_mm)).collect(),
        part_box_mm: arguments.part_box.as_ref().map(|given| given.0),
        clamp_mm: arguments.clamp.as_ref().map(|given| Vector::from(given.0)),
        second_order: arguments.second_order,
    })
}

/// What was asked, as it was typed.
fn facts(
    arguments: &Map,
    shared: &Shared,
    profile: &Profile,
    path: &std::path::Path,
    hash: &blake3::Hash,
) -> page::Facts {
    let mut options = vec![("--grid", arguments.grid.to_string())];
    options.extend(arguments.region.iter().map(|v| ("--region", v.to_string())));
    options.extend(arguments.plane.iter().map(|v| ("--plane", v.to_string())));
    options.extend(arguments.part_box.iter().map(|v| ("--part-box", v.to_string())));
    options.extend(arguments.clamp.iter().map(|v| ("--clamp", v.to_string())));
    options.extend(shared.job.at.iter().map(|v| ("--at", v.to_string())));
    page::Facts {
        chain: profile.chain().to_string(),
        profile: file::name(path),
        profile_hash: hash.to_string(),
        options,
        origin: crate::origin::Origin::of(profile),
        dominant: Vec::new(),
        doubts: Vec::new(),
        tolerance_um: shared.job.tolerance.unwrap_or(profile.correction.tolerance_um),
    }
}

/// Boxes of nodes that reach outside the calibrated volume: refused, unless the nearest point's error is asked for.
pub(crate) fn outside(
    boxes_mm: impl IntoIterator<Item = [Range; 3]>,
    volume: Volume,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    for warning in jobs::map::outside(boxes_mm, volume, &shared.job)? {
        messages.report(&warning);
    }
    Ok(())
}
