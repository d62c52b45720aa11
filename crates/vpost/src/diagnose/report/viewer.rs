//! The diagnosis as a page in which the error moves: the rows as told, as measured, and without what the causes make.

use diagnostic::{Language, both};
use machine_model::effects::EffectTerm;
use report::viewer::scene::{CAUSES, Cause, Displacement, Place, Scene};
use report::viewer::{Figures, Kind, Viewer};

use super::alignment::Alignment;
use super::names::named;
use super::page::Report;
use super::rows::Rows;
use crate::message::{Failure, Messages};
use crate::viewer;

impl Report<'_> {
    /// Writes the page.
    ///
    /// * `text` – the measurements as they were read
    pub(in crate::diagnose) fn write_viewer(
        &self,
        path: &std::path::Path,
        text: &str,
        messages: &Messages,
    ) -> Result<(), Failure> {
        let (d, facts) = (self.diagnosis, self.facts);
        let scene = self.scene();
        let name = &facts.measurements.name;
        if scene.places.is_empty() {
            let what =
                both!("no row says anything of the machine", "ни одна строка ничего не говорит о станке");
            let help = both!(
                "measure what `--next` or `--plan` says, or leave `--viewer` out",
                "измерьте то, что называет `--next` или `--plan`, или обойдитесь без `--viewer`"
            );
            return Err(viewer::no_path(name, &what, help));
        }
        let lines: Vec<&str> = text.lines().collect();
        let blocks =
            viewer::blocks(&scene, |line| lines.get(usize::try_from(line.checked_sub(1)?).ok()?).copied());
        let (count, verdict) = (scene.of.to_string(), d.verdict.words());
        let page = Viewer {
            kind: Kind::Diagnosis,
            language: messages.language(),
            scene: &scene,
            has_after: !d.causes.is_empty(),
            blocks: &blocks,
            files: &[],
            figures: Figures {
                names: vec![
                    ("verdict_en", verdict.in_language(Language::English)),
                    ("verdict_ru", verdict.in_language(Language::Russian)),
                    ("machine", &facts.machine),
                    ("file", name),
                    ("drawn", &count),
                    ("of", &count),
                ],
                numbers: vec![
                    ("before", d.gap.rms_um),
                    ("after", d.leftover.rms_um),
                    ("remainder", scene.remainder_um),
                ],
            },
            facts: &[
                ("fact_measurements", format!("{name} (BLAKE3 {})", facts.measurements.hash)),
                (
                    "fact_machine",
                    format!("{}, {}", facts.machine, facts.chain.as_deref().unwrap_or_default()),
                ),
                ("fact_calibrated", facts.origin.said().in_language(messages.language()).to_owned()),
                ("fact_profile", format!("{} (BLAKE3 {})", facts.profile.name, facts.profile.hash)),
                ("fact_engine", facts.engine.clone()),
                ("fact_typed", crate::origin::command()),
                ("fact_command", format!("vpost {} diagnose", env!("CARGO_PKG_VERSION"))),
            ],
        };
        viewer::write(path, page)
    }

    /// The rows as told, as measured, and without each cause.
    fn scene(&self) -> Scene {
        let d = self.diagnosis;
        let rows = Rows::new(d, self.data);
        let mut scene = Scene {
            causes: d
                .causes
                .iter()
                .map(|c| Cause {
                    kind: "effect",
                    symbol: c.effect.clone(),
                    russian: Some(format!("{:#}", named(&c.effect))),
                })
                .collect(),
            ..Scene::default()
        };
        let um = |v: machine_model::Vector| -> Displacement { [v.x as f32, v.y as f32, v.z as f32] };
        // Of what a cause does only that can be seen which was measured and which no alignment takes away.
        let alignment = Alignment::new(&rows, self.data);
        let seen_um: Vec<Vec<f64>> = d
            .causes
            .iter()
            .map(|cause| {
                alignment.seen(|row| {
                    let measured = &self.data.rows[row];
                    let mm = |term: &EffectTerm| {
                        term.displacement_mm(&measured.command, &measured.conditions).ok()
                    };
                    cause.term.as_ref().and_then(mm).unwrap_or_default() * 1e3
                })
            })
            .collect();
        let (mut run, mut equation) = (None, 0);
        for row in &rows.all {
            let measured = &self.data.rows[row.row];
            let (before, after) = row.vectors_um();
            let by = seen_um.iter().map(|seen_um| {
                let parts = row.equations.iter().zip(&seen_um[equation..]);
                um(parts.map(|(seen, value)| seen.along * *value).sum())
            });
            let displaced_um: Vec<Displacement> = [um(before), um(after)].into_iter().chain(by).collect();
            let place = Place {
                at_mm: measured.command.linear_mm.into(),
                line: measured.line,
                begins: run != Some(measured.run),
                ends: true,
                off_um: [0.0; 2],
                unknown_after: false,
                displaced_um,
            };
            run = Some(measured.run);
            equation += row.equations.len();
            if place.displaced_um.len() > CAUSES {
                scene.remainder_um = scene.remainder_um.max(viewer::remainder_um(&place));
            }
            scene.places.push(place);
        }
        // Rows are measured one by one: a file holds thousands, and all of them are drawn.
        scene.of = scene.places.len();
        scene
    }
}
