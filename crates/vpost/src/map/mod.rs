//! `vpost map`: what the machine does wrong over its volume, and where to put the zero point.

mod arguments;
mod drawn;
mod export;
mod json;
pub(crate) mod options;
mod page;
mod second_order;
mod study;
mod text;

pub use arguments::Map;

use diagnostic::Diagnostic;
use machine_model::{Engine, EngineId, PathModel, Range, Volume};

use crate::arguments::{Outside, Shared};
use crate::message::{Failure, Messages, Report};
use crate::predict::POINT_OUTSIDE;
use crate::roles::Roles;
use crate::settings::machine;
use crate::{conditions, file, profile};

/// `vpost map -m PROFILE`
pub(crate) fn run(arguments: &Map, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let loaded = profile::load_mill(machine(shared)?)?;
    let profile = loaded.profile;
    Roles::default()
        .reads_all("read by the profile", &loaded.files)
        .writes("--csv", arguments.csv.as_deref())
        .writes("--vtk", arguments.vtk.as_deref())
        .writes("--json", arguments.json.as_deref())
        .writes("--html", arguments.html.as_deref())
        .are_apart()?;
    let conditions = conditions::conditions(shared)?;
    let id = shared.job.engine().unwrap_or(EngineId::RigidBody);
    let engine = profile.engine(id, &conditions).map_err(|error| conditions::failure(&error))?;
    let model = model(engine.as_ref())?;
    let asked = options::read(arguments, shared, &profile, model.volume())?;
    let grid_mm = asked.grid.axes().each_ref().map(|nodes| nodes.range_mm());
    outside(asked.part_box_mm.into_iter().chain([grid_mm]), model.volume(), shared, messages)?;
    let study = study::Study::new(&profile, id, model, &asked)?;
    if let Some(path) = &arguments.csv {
        file::write(path, &export::csv(&study))?;
    }
    if let Some(path) = &arguments.vtk {
        file::write(path, &export::vtk(&study))?;
    }
    if let Some(path) = &arguments.json {
        file::write(path, &json::bytes(&study))?;
    }
    if let Some(path) = &arguments.html {
        let facts = facts(arguments, shared, &profile, machine(shared)?, &loaded.hash);
        let json = String::from_utf8(json::bytes(&study)).expect("JSON is UTF-8");
        file::write(path, page::html(&study, &facts, &json).as_bytes())?;
    }
    file::print(text::page(&study).as_bytes())
}

/// What was asked, as it was typed.
fn facts(
    arguments: &Map,
    shared: &Shared,
    profile: &machine_profile::Profile,
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
    }
}

fn model(engine: &dyn Engine) -> Result<&dyn PathModel, Failure> {
    engine.path_model().ok_or_else(|| {
        Failure::option(
            format!("engine `{}` has no forward model: it reproduces a publication", engine.id()),
            "leave `--engine` out, or take one of the engines without `-published`",
        )
    })
}

/// Boxes of nodes that reach outside the calibrated volume: refused, unless the nearest point's error is asked for.
pub(crate) fn outside(
    boxes_mm: impl IntoIterator<Item = [Range; 3]>,
    volume: Volume,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    for ranges in boxes_mm {
        for (axis, range) in ranges.iter().enumerate() {
            let known = volume.0[axis];
            if known.contains(range.low) && known.contains(range.high) {
                continue;
            }
            let message = format!(
                "{} from {} to {} mm reaches outside the calibrated volume, {} to {} mm",
                ['X', 'Y', 'Z'][axis],
                range.low,
                range.high,
                known.low,
                known.high
            );
            if shared.job.outside != Some(Outside::Clamp) {
                let help = "stay inside, or take the nearest point's error with `--outside clamp`";
                return Err(Failure::usage(Diagnostic::error(POINT_OUTSIDE, message).help(help)));
            }
            let help = "the nodes outside have the error of the volume's nearest point";
            let diagnostic = Diagnostic::warning(POINT_OUTSIDE, message).help(help);
            messages.report(&Report { source: None, diagnostics: vec![diagnostic] });
        }
    }
    Ok(())
}
