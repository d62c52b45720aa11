//! `vpost map`: what the machine does wrong over its volume, and where to put the zero point.

mod arguments;
mod dominant;
mod page;
mod viewer;

pub use arguments::Map;

use diagnostic::both;
use jobs::map::{dominant as deviations, export, json, model, of, text};
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
    let id = profile.forward_engine(shared.job.engine());
    let engine = conditions::engine(&profile, id, &shared.job)?;
    let mut warnings = Vec::new();
    let study = of(&shared.job, &profile, engine.as_ref(), &arguments.asked, &mut warnings);
    warnings.iter().for_each(|report| messages.report(report));
    let study = study?;
    if let Some(path) = &arguments.csv {
        file::write(path, &export::csv(&study))?;
    }
    if let Some(path) = &arguments.vtk {
        file::write(path, &export::vtk(&study))?;
    }
    if let Some(path) = &arguments.json {
        file::write(path, &json::bytes(&study))?;
    }
    let under = conditions::conditions(&shared.job)?;
    let dominant = deviations::dominant(&profile, id, &under, &study.asked);
    let doubts = conditions::doubts(&profile, id).into_iter().flat_map(|report| report.diagnostics);
    let facts = page::Facts {
        dominant,
        doubts: doubts.map(|doubt| doubt.message).collect(),
        ..facts(arguments, shared, &profile, machine(&shared.job)?, &loaded.hash)
    };
    if let Some(path) = &arguments.viewer {
        viewer::write(path, &profile, model(engine.as_ref())?, &study, &facts, (shared, messages))?;
    }
    if let Some(path) = &arguments.html {
        let json = String::from_utf8(json::bytes(&study)).expect("JSON is UTF-8");
        file::write(path, page::html(&study, &facts, &json, messages.language()).as_bytes())?;
    }
    file::print(text::page(&study).in_language(messages.language()).as_bytes())
}

/// What was asked, as it was typed.
fn facts(
    arguments: &Map,
    shared: &Shared,
    profile: &Profile,
    path: &std::path::Path,
    hash: &blake3::Hash,
) -> page::Facts {
    let asked = &arguments.asked;
    let mut options = vec![("--grid", asked.grid.to_string())];
    options.extend(asked.region.iter().map(|v| ("--region", v.to_string())));
    options.extend(asked.plane.iter().map(|v| ("--plane", v.to_string())));
    options.extend(asked.part_box.iter().map(|v| ("--part-box", v.to_string())));
    options.extend(asked.clamp.iter().map(|v| ("--clamp", v.to_string())));
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
