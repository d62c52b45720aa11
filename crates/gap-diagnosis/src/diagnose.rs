//! The whole diagnosis of one file.

use crate::equations::observation::{Measurements, Scalar};
use crate::judgement::answer::{Diagnosis, Gap, Setup, Verdict};
use crate::judgement::assembly::Assembly;
use crate::judgement::unseen::kept_back;
use crate::options::Options;
use crate::search::lengths::{explained, first_equations};
use diagnostic::{Text, both};

/// Diagnoses the gap between `data` and the model that predicted its rows; `holdout` is never fitted.
#[must_use]
pub fn diagnose(data: &Measurements, holdout: Option<&Measurements>, options: &Options) -> Diagnosis {
    if let Some(answer) = too_little(data, &first_equations(data)) {
        return answer;
    }
    let (model, magnitude_notes) = explained(data, &options.without);
    let mut answer =
        Assembly::new(data, &model).diagnosis(holdout, options, || kept_back(data, &options.without));
    answer.notes.extend(magnitude_notes);
    answer
}

/// Files that cannot carry any statement.
fn too_little(data: &Measurements, scalars: &[Scalar]) -> Option<Diagnosis> {
    let mut missing = Vec::new();
    if scalars.len() < 24 {
        missing.push(both!(
            "{} readings, at least 24 are needed beside the six set-up parameters",
            "отсчётов {}, а сверх шести параметров установки их нужно не меньше 24",
            scalars.len()
        ));
    }
    if data.is_one_run() {
        missing.push(Text::pair(
            "1 run: what is set-up, drift and machine cannot be told; measure at least two lines with a run id each, or one line twice from each side",
            "одна серия: установку и уход не отличить от станка; измерьте хотя бы две линии, каждую со своим именем серии, или одну дважды с каждой стороны",
        ));
    }
    if (0..3).all(|a| data.range_mm(a).1 - data.range_mm(a).0 < 1e-6) && !moves_rotary(data) {
        missing.push(Text::pair("no axis moves in this file", "в этом файле ни одна ось не движется"));
    }
    let first = scalars.first().map(|s| s.gap_um);
    if scalars.iter().all(|s| Some(s.gap_um) == first) {
        missing.push(Text::pair("every reading is the same number", "все отсчёты — одно и то же число"));
    }
    (!missing.is_empty()).then(|| underpowered(data.rows.len(), missing))
}

/// The verdict UNDERPOWERED with what is missing.
#[must_use]
pub fn underpowered(rows: usize, missing: Vec<Text>) -> Diagnosis {
    let list = Text::join(&missing, "; ");
    let sentence = both!("Too little was measured: {list}.", "Измерено слишком мало: {list:#}.");
    let gap = Gap { rows, ..Gap::default() };
    let setup = Some(Setup::default());
    Diagnosis { setup, notes: missing, ..Diagnosis::new(Verdict::Underpowered, sentence, gap) }
}

fn moves_rotary(data: &Measurements) -> bool {
    let first = data.rows.first().map(|r| r.command.rotary_rad);
    data.rows.iter().any(|r| Some(r.command.rotary_rad) != first)
}
