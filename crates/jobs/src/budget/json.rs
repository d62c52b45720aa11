//! All figures as JSON, `vpost.budget/1`.

use diagnostic::Text;
use error_budget::tolerances::Tolerances;
use error_budget::{Criteria, OneSided};
use serde_json::{Value, json};

use super::study::{Combined, Study, Target};
use crate::figures::{millimetres, round, rounded_um as um};

/// The file's bytes.
pub fn bytes(study: &Study) -> Vec<u8> {
    let budget = &study.budget;
    let document = json!({
        "schema": "vpost.budget/1",
        "machine": study.name,
        "counted_from": study.from_zero.said(study.machine.model()).iter().map(Text::english).collect::<Vec<_>>(),
        "control_points": study.points.commands.len(),
        "measured": criteria(study, &budget.measured),
        "deviations": budget.items.iter().map(|item| {
            let (name, size, unit) = study.deviation(item.deviation);
            let share = if budget.measured.rms_mm > 0.0 { item.rms_slope_mm / budget.measured.rms_mm } else { 0.0 };
            json!({
                "name": name, "size": round(size, 6), "unit": unit.english(),
                "alone": criteria(study, &item.alone),
                "without": criteria(study, &item.without),
                "brings_um": um(budget.measured.largest_mm - item.without.largest_mm),
                "dM_um": slopes(item.largest_slope_mm),
                "dA_um": slopes(item.spread_slope_mm),
                "drms_um": um(item.rms_slope_mm),
                "share_of_rms": round(share, 6),
            })
        }).collect::<Vec<_>>(),
        "sum_of_dM_um": um(budget.sum_of_slopes_mm()),
        "second_order": { "largest_um": round(budget.remainder_mm * 1e3, 6), "at": place(study, budget.remainder_at) },
        "signs_free": combined(study, &study.mirrored),
        "sizes_only": combined(study, &study.within_sizes),
        "target": study.target.as_ref().map(|target| wanted(study, target)),
    });
    crate::summary::json(&document)
}

fn criteria(study: &Study, found: &Criteria) -> Value {
    json!({
        "M_um": um(found.largest_mm), "A_um": um(found.spread_mm()), "rms_um": um(found.rms_mm),
        "at": place(study, found.largest_at),
    })
}

fn slopes(slope: OneSided) -> Value {
    json!({ "left": um(slope.left), "right": um(slope.right) })
}

fn combined(study: &Study, found: &Combined) -> Value {
    let names = study.machine.deviations().iter().map(|deviation| deviation.name.clone());
    let signs: serde_json::Map<String, Value> =
        names.zip(&found.worst.signs).map(|(name, sign)| (name, json!(*sign as i8))).collect();
    json!({
        "worst_case": {
            "um": um(found.worst.mm), "whole_model_um": um(found.worst_whole_mm),
            "at": place(study, found.worst.at), "signs": signs,
        },
        "root_sum_of_squares": {
            "um": um(found.squares_mm), "whole_model_um": um(found.squares_whole_mm),
            "at": place(study, found.squares_at),
        },
    })
}

fn wanted(study: &Study, target: &Target) -> Value {
    let kept = target.keep.iter().enumerate().filter(|(_, keep)| **keep);
    json!({
        "M_um": um(target.mm),
        "keep": kept.map(|(index, _)| study.deviation(index).0).collect::<Vec<_>>(),
        "met_as_measured": target.met,
        "mend": {
            "proven": target.mending.proven,
            "steps": target.mending.steps.as_ref().map(|steps| steps.iter().map(|(deviation, after_mm)| json!({
                "name": study.deviation(*deviation).0, "then_M_um": um(*after_mm),
            })).collect::<Vec<_>>()),
        },
        "tolerances": {
            "worst_case": target.worst_case.as_ref().map(|set| tolerances(study, target, set)),
            "statistical": target.statistical.as_ref().map(|set| tolerances(study, target, set)),
        },
    })
}

fn tolerances(study: &Study, target: &Target, set: &Tolerances) -> Value {
    let each: Vec<Value> = study
        .budget
        .items
        .iter()
        .filter(|item| !target.keep[item.deviation])
        .map(|item| {
            let (name, _, unit) = study.deviation(item.deviation);
            json!({ "name": name, "within": study.tolerance(set, item.deviation), "unit": unit.english() })
        })
        .collect();
    json!({
        "each_alone_um": um(set.influence_mm), "together_um": um(set.figure_mm),
        "whole_model_um": um(set.whole_model_mm), "at": place(study, set.at),
        "worst_case_um": um(set.worst.mm), "each": each,
    })
}

fn place(study: &Study, at: usize) -> Value {
    let command = &study.points.commands[at];
    json!({
        "linear_mm": millimetres(&command.linear_mm),
        "rotary_deg": millimetres(&command.rotary_rad.map(f64::to_degrees)),
        "tool_mm": millimetres(&command.tool_mm),
        "direction": command.direction,
    })
}
