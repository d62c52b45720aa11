//! The check as a page in which the error moves: the programmed path, the real one, the corrected one.

use std::path::Path;

use diagnostic::both;
use jobs::causes::Causes;
use jobs::settings::Settings;
use machine_model::Models;
use path_comparison::{Comparison, Trace};
use report::viewer::scene::{Place, Scene};
use report::viewer::thinning::Thinning;
use report::viewer::{Figures, Kind, Viewer, line_of};

use super::page::Facts;
use crate::arguments::Shared;
use crate::conditions::conditions;
use crate::message::{Failure, Messages};
use crate::viewer;

/// Places that are nearer are one, mm.
const SAME_MM: f64 = 1e-6;

/// Writes the page.
///
/// * `program` – as posted: its name and bytes
pub(super) fn write(
    path: &Path,
    program: (&str, &[u8]),
    comparison: &Comparison,
    settings: &Settings,
    facts: &Facts<'_>,
    (shared, messages): (&Shared, &Messages),
) -> Result<(), Failure> {
    let causes = Causes::of(&settings.profile, settings.engine.id(), &conditions(&shared.job)?)?;
    let others: Vec<Models<'_>> = causes.as_ref().map_or_else(Vec::new, Causes::without);
    let (mut scene, called) = drawn(program, comparison, settings, &others, facts)?;
    scene.causes = viewer::causes(causes.as_ref());
    if scene.causes.is_empty() {
        scene.remainder_um = 0.0;
    }

    let called_text: Vec<_> =
        called.iter().map(|(_, _, text)| measurement_files::utf8_or_1251(text)).collect();
    let files: Vec<Vec<&str>> = std::iter::once(facts.text)
        .chain(called_text.iter().map(|text| text.as_ref()))
        .map(|text| text.lines().collect())
        .collect();
    let blocks = viewer::blocks(&scene, |line| {
        let file = files.iter().enumerate().rev().find(|(file, _)| line >= line_of(*file, 0))?;
        file.1.get(usize::try_from(line - line_of(file.0, 1)).ok()?).copied()
    });
    let names: Vec<String> = called.into_iter().map(|(_, name, _)| name).collect();
    let counts = [scene.places.len(), scene.of].map(|count| count.to_string());
    let um = |mm: f64| mm * 1e3;
    let page = Viewer {
        kind: Kind::Check,
        language: messages.language(),
        scene: &scene,
        has_after: true,
        blocks: &blocks,
        files: &names,
        figures: Figures {
            names: vec![
                ("output", crate::file::without_folders(facts.output)),
                ("machine", facts.machine),
                ("drawn", &counts[0]),
                ("of", &counts[1]),
            ],
            numbers: vec![
                ("before", um(comparison.before.largest_mm)),
                ("after", um(comparison.after.largest_mm)),
                ("limit", um(facts.limit_mm)),
                ("path", scene.path_bound_um),
                ("displaced", scene.displaced_bound_um),
                ("remainder", scene.remainder_um),
            ],
        },
        facts: &[
            ("fact_input", facts.input.to_owned()),
            ("fact_output", facts.output.to_owned()),
            ("fact_machine", facts.machine.to_owned()),
            ("fact_profile", format!("{} (BLAKE3 {})", facts.profile, facts.profile_hash)),
            ("fact_calibrated", facts.origin.said().in_language(messages.language()).to_owned()),
            ("fact_engine", facts.engine.to_owned()),
            ("fact_typed", crate::origin::command()),
            ("fact_command", format!("vpost {} check", env!("CARGO_PKG_VERSION"))),
        ],
    };
    viewer::write(path, page)
}

/// All motions at feed rate with what the machine and each cause make of them, and the files that the program called.
///
/// * `program` – as posted: its name and bytes
/// * `others` – the machine without each cause
fn drawn(
    program: (&str, &[u8]),
    comparison: &Comparison,
    settings: &Settings,
    others: &[Models<'_>],
    facts: &Facts<'_>,
) -> Result<(Scene, Vec<jobs::check::CalledFile>), Failure> {
    let traces = &comparison.traces;
    let mut thinning = Thinning::new(size_mm(traces), comparison.before.largest_mm * 1e3, 2 + others.len());
    let (mut read, mut end, mut remainder_um, mut refused) = (0, None, 0.0f64, None);
    let called = jobs::check::courses(program, settings, others, &|_, _| true, &mut |file, course| {
        let Some(trace) = traces.get(read).filter(|_| refused.is_none()) else { return };
        let machines = 1 + others.len();
        let joins = |place: &[f64; 3]| end.is_some_and(|end| apart_mm(place, &end) < SAME_MM);
        let goes_on = course.places_mm.first().is_some_and(joins);
        let made = Made::of(&traces[read], traces[..read].last().filter(|_| goes_on));
        read += 1;
        let last = course.places_mm.len().saturating_sub(1);
        let mut from = 0;
        let after: Vec<Option<[f64; 3]>> =
            course.places_mm.iter().map(|at_mm| made.displaced_mm(at_mm, &mut from, last)).collect();
        let largest_mm =
            after.iter().flatten().map(|mm| apart_mm(mm, &[0.0; 3])).fold(trace.after_mm, f64::max);
        for (k, (at_mm, errors)) in
            course.places_mm.iter().zip(course.errors_mm.chunks_exact(machines)).enumerate()
        {
            let after = after[k];
            // A motion that goes on begins where the last has ended.
            if k == 0 && goes_on {
                continue;
            }
            let place = Place {
                at_mm: *at_mm,
                line: line_of(file, course.line),
                begins: k == 0,
                ends: k == last,
                off_um: [trace.before_mm, largest_mm].map(|mm| (mm * 1e3) as f32),
                unknown_after: after.is_none(),
                displaced_um: viewer::displacements(errors[0], after.unwrap_or_default(), &errors[1..]),
            };
            remainder_um = remainder_um.max(viewer::remainder_um(&place));
            if let Err(too_large) = thinning.push(place) {
                refused = Some(too_large);
                return;
            }
        }
        end = course.places_mm.last().copied();
    })?;
    let too_large = |refused| viewer::too_large(facts.input, &refused);
    if let Some(refused) = refused {
        return Err(too_large(refused));
    }
    let mut scene = thinning.finish().map_err(too_large)?;
    if scene.places.is_empty() {
        let what = both!("the program feeds nowhere", "в программе нет движения на рабочей подаче");
        let help = both!(
            "give a program that cuts: it needs a motion at feed rate (G1, G2, G3, a cycle)",
            "дайте программу, которая режет: нужно движение на рабочей подаче (G1, G2, G3, цикл)"
        );
        return Err(viewer::no_path(facts.input, &what, help));
    }
    scene.remainder_um = remainder_um;
    Ok((scene, called))
}

/// The diagonal of the box around all motions, mm.
fn size_mm(traces: &[Trace]) -> f64 {
    let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for place in traces.iter().flat_map(|trace| [trace.way.at(0.0), trace.way.at(0.5), trace.way.at(1.0)]) {
        for (range, mm) in ranges.iter_mut().zip(place.iter()) {
            *range = (range.0.min(*mm), range.1.max(*mm));
        }
    }
    ranges.iter().map(|(low, high)| (high - low).max(0.0).powi(2)).sum::<f64>().sqrt()
}

fn apart_mm(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Where the corrected program brings the tool for a motion.
struct Made<'t>(&'t [[f64; 3]]);

impl<'t> Made<'t> {
    /// Where nothing is made of a motion, being shorter than the limit, the tool stays at the end of the one that it
    /// goes on from.
    fn of(trace: &'t Trace, before: Option<&'t Trace>) -> Self {
        let made = trace.made_mm.as_slice();
        let before = before.map_or(&[][..], |before| before.made_mm.as_slice());
        Self(if made.is_empty() { &before[before.len().saturating_sub(1)..] } else { made })
    }

    /// From a programmed place to the nearest real one, mm; `None` where nothing was made of the motion.
    ///
    /// * `from` – where the place before was nearest; `places` – how many there are
    fn displaced_mm(&self, at_mm: &[f64; 3], from: &mut usize, places: usize) -> Option<[f64; 3]> {
        let made = self.0;
        if made.len() < 2 {
            return made.first().map(|only| [0, 1, 2].map(|axis| only[axis] - at_mm[axis]));
        }
        // Both run forwards, about evenly.
        let ahead = 16 + 3 * made.len() / places.max(1);
        let segments = from.saturating_sub(2)..(*from + ahead).min(made.len() - 1);
        let foot = |k: usize| {
            let (start, end) = (made[k], made[k + 1]);
            let along = [0, 1, 2].map(|axis| end[axis] - start[axis]);
            let square: f64 = along.iter().map(|v| v * v).sum();
            let dot: f64 = (0..3).map(|axis| (at_mm[axis] - start[axis]) * along[axis]).sum();
            let s = if square > 0.0 { (dot / square).clamp(0.0, 1.0) } else { 0.0 };
            [0, 1, 2].map(|axis| start[axis] + s * along[axis] - at_mm[axis])
        };
        let size = |v: &[f64; 3]| v.iter().map(|v| v * v).sum::<f64>();
        let nearest = segments.map(|k| (k, foot(k))).min_by(|a, b| size(&a.1).total_cmp(&size(&b.1)))?;
        *from = nearest.0;
        Some(nearest.1)
    }
}
