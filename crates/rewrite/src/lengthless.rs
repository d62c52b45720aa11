//! Tools that cut without a length: no word of the program says how long they are, and angles act along them.

use std::collections::BTreeMap;
use std::ops::Range;

use diagnostic::{Diagnostic, both};
use machine_model::{Command, Vector};
use nc_program::Modal;

use crate::job::{Job, WITHOUT_LENGTH, Warning};

/// By how much longer the tool is taken that says what a length matters, mm.
const LONGER_MM: f64 = 100.0;

/// Each by its T, and where it cut first: bytes and line.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lengthless(BTreeMap<u32, (Range<u64>, u64)>);

impl Lengthless {
    /// A motion cuts in this state.
    pub(crate) fn cut(&mut self, job: &Job<'_>, modal: &Modal, span: &Range<u64>, line: u64) {
        let asked = job.setup.lever_matters && job.dialect.turning.is_none() && modal.tool_length.is_none();
        if let (true, Some(tool)) = (asked, modal.tool_loaded) {
            self.0.entry(tool).or_insert_with(|| (span.clone(), line));
        }
    }

    pub(crate) fn add(&mut self, later: &Self) {
        for (tool, place) in &later.0 {
            self.0.entry(*tool).or_insert_with(|| place.clone());
        }
    }

    /// One tool may be what `default_mm` says; two are not, and none ends where its length begins.
    pub(crate) fn warning(&self, job: &Job<'_>) -> Option<Warning> {
        let default_mm = Vector::from(job.setup.default_tool_mm);
        let (span, line) = self.0.values().min_by_key(|(_, line)| *line)?;
        if self.0.len() == 1 && default_mm != Vector::zeros() {
            return None;
        }
        let names: Vec<String> = self.0.keys().map(|tool| format!("T{tool}")).collect();
        let um = 1e3 * of_a_longer_tool_mm(job, default_mm);
        let diagnostic = Diagnostic::doubt(
            WITHOUT_LENGTH,
            both!(
                "no tool length is in force while {} cut: each tool is taken as default_mm of the profile",
                "при резании инструментами {} не действует коррекция на длину: каждый взят с вектором default_mm профиля",
                names.join(", ")
            ),
        )
        .at(
            span.clone(),
            both!(
                "the first; on this machine {LONGER_MM} mm more of tool are up to {um:.1} um at its tip",
                "первое; на этом станке {LONGER_MM} мм вылета — до {um:.1} мкм на вершине"
            ),
        )
        .help(both!(
            "where the control brings the length in itself, write `t_means_h = true` under `[program]` and the lengths under `[tool] lengths_mm` in the profile; else program G43 and H, or correct each tool's operations apart with its own default_mm",
            "если длину вводит сама стойка, впишите в профиль `t_means_h = true` в раздел `[program]` и длины в `[tool] lengths_mm`; иначе программируйте G43 и H или исправляйте переходы каждого инструмента отдельно со своим default_mm"
        ));
        Some((diagnostic, *line))
    }
}

/// What a longer tool would be off by besides, at the corners of the volume, mm.
fn of_a_longer_tool_mm(job: &Job<'_>, tool_mm: Vector) -> f64 {
    let (model, volume) = (job.models.axes, job.models.axes.volume());
    let mut most_mm = 0.0_f64;
    for corner in 0..8 {
        let far = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { -1e9 } else { 1e9 });
        let error = |tool_mm: Vector| {
            let linear_mm = volume.nearest(&far.into());
            model.error_mm(&Command { linear_mm, tool_mm, ..Default::default() })
        };
        most_mm = most_mm.max((error(tool_mm - Vector::new(0.0, 0.0, LONGER_MM)) - error(tool_mm)).norm());
    }
    most_mm
}
