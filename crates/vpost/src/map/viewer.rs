//! The map as a page in which the error moves: a lattice through the volume, as told, as it is, with the zero point moved.

use std::collections::BTreeMap;
use std::path::Path;

use diagnostic::{Text, both};
use error_map::Nodes;
use jobs::causes::Causes;
use machine_model::{Models, PathModel, Vector};
use machine_profile::Profile;
use report::numbers::digits;
use report::viewer::scene::{Place, Scene};
use report::viewer::{Figures, Kind, Viewer};

use super::page::Facts;
use crate::arguments::Shared;
use crate::conditions::conditions;
use crate::message::{Failure, Messages};
use crate::viewer;
use jobs::map::study::Study;

/// Lines of the lattice across each axis, and places along a line, at most.
const LINES: usize = 5;
const PLACES: usize = 41;

/// Writes the page.
pub(super) fn write(
    path: &Path,
    profile: &Profile,
    model: &dyn PathModel,
    study: &Study,
    facts: &Facts,
    (shared, messages): (&Shared, &Messages),
) -> Result<(), Failure> {
    let causes = Causes::of(profile, study.engine, &conditions(&shared.job)?)?;
    let without: Vec<Models<'_>> = causes.as_ref().map_or_else(Vec::new, Causes::without);
    let shift_mm = study.parts[0].median().shift_mm;
    let axes = study.map.grid().axes();
    let mut scene = Scene { causes: viewer::causes(causes.as_ref()), ..Scene::default() };
    for places in lattice(axes) {
        let last = places.len() - 1;
        for (k, at_mm) in places.into_iter().enumerate() {
            let here = study.asked.command(at_mm, [0; 3]);
            let whole_mm = model.error_mm(&here);
            let others: Vec<[f64; 3]> =
                without.iter().map(|models| models.axes.error_mm(&here).into()).collect();
            let place = Place {
                at_mm: at_mm.into(),
                line: scene.places.len() as u64 + 1,
                begins: k == 0,
                ends: k == last,
                off_um: [0.0; 2],
                unknown_after: false,
                displaced_um: viewer::displacements(whole_mm.into(), (whole_mm - shift_mm).into(), &others),
            };
            if causes.is_some() {
                scene.remainder_um = scene.remainder_um.max(viewer::remainder_um(&place));
            }
            scene.places.push(place);
        }
    }
    if scene.places.is_empty() {
        let what = both!("the grid is a single place", "в сетке единственный узел");
        let help = both!(
            "give the grid more than one node along some axis: `--grid 11x11x11`",
            "дайте сетке больше одного узла хотя бы по одной оси: `--grid 11x11x11`"
        );
        return Err(viewer::no_path(&facts.profile, &what, help));
    }
    scene.of = scene.places.len();
    let count = scene.of.to_string();
    let language = messages.language();
    let said = |text: &Text| text.in_language(language).to_owned();
    let tool = Text::join(&study.asked.tool_mm.iter().map(|mm| digits(*mm, 3)).collect::<Vec<_>>(), " ");
    let grid = axes.iter().zip(["X", "Y", "Z"]).map(|(nodes, axis)| {
        let [low, high] = [nodes.range_mm().low, nodes.range_mm().high].map(|mm| digits(mm, 3));
        both!("{axis} {low} \u{2026} {high} mm", "{axis} {low:#} \u{2026} {high:#} мм")
    });
    let page = Viewer {
        kind: Kind::Map,
        language,
        scene: &scene,
        has_after: true,
        blocks: &BTreeMap::new(),
        files: &[],
        figures: Figures {
            names: vec![("machine", &study.machine), ("drawn", &count), ("of", &count)],
            numbers: vec![
                ("before", study.parts[0].figures.magnitude_mm.high * 1e3),
                ("after", study.parts[0].median().figures.magnitude_mm.high * 1e3),
                ("remainder", scene.remainder_um),
            ],
        },
        facts: &[
            ("fact_machine", format!("{}, {}", study.machine, facts.chain)),
            ("fact_profile", format!("{} (BLAKE3 {})", facts.profile, facts.profile_hash)),
            ("fact_calibrated", said(&facts.origin.said())),
            ("fact_engine", study.engine.name().to_owned()),
            ("fact_grid", said(&Text::join(&grid.collect::<Vec<_>>(), ", "))),
            ("fact_tool", said(&both!("{tool} mm", "{tool:#} мм"))),
            ("fact_typed", crate::origin::command()),
            ("fact_command", format!("vpost {} map", env!("CARGO_PKG_VERSION"))),
        ],
    };
    viewer::write(path, page)
}

/// Lines along each axis through some nodes of the others.
fn lattice(axes: &[Nodes; 3]) -> Vec<Vec<Vector>> {
    let some = |axis: usize, most: usize| -> Vec<f64> {
        let range = axes[axis].range_mm();
        let count = if range.low < range.high { axes[axis].places_mm().len().clamp(2, most) } else { 1 };
        (0..count)
            .map(|k| range.low + (range.high - range.low) * k as f64 / (count - 1).max(1) as f64)
            .collect()
    };
    let mut lines = Vec::new();
    for along in 0..3 {
        let [u, v] = [[1, 2], [0, 2], [0, 1]][along];
        let places = some(along, PLACES);
        if places.len() < 2 {
            continue;
        }
        for across in some(u, LINES) {
            for up in some(v, LINES) {
                let line = places.iter().map(|mm| {
                    let mut at = Vector::zeros();
                    (at[along], at[u], at[v]) = (*mm, across, up);
                    at
                });
                lines.push(line.collect());
            }
        }
    }
    lines
}
