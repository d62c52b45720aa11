//! All figures as JSON, `vpost.map/1`.

use error_map::Statistics;
use machine_model::{Range, Vector};
use serde_json::{Value, json};

use super::deformation;
use super::drawn::classes;
use super::second_order::SecondOrder;
use super::study::{Part, Proof, Study, ZeroPoint, freedom_name};
use crate::figures::{millimetres, round, rounded_um as um};

/// The file's bytes.
pub fn bytes(study: &Study) -> Vec<u8> {
    let grid = study.map.grid();
    let sizes = classes(study);
    let document = json!({
        "schema": "vpost.map/1",
        "machine": study.machine,
        "engine": study.engine.name(),
        "tool_mm": millimetres(&study.asked.tool_mm),
        "rotary_deg": millimetres(&study.asked.rotary_rad.map(f64::to_degrees)),
        "within_um": um(study.asked.within_mm),
        "nodes": grid.len(),
        "nodes_mm": grid.axes().each_ref().map(|n| n.places_mm().iter().map(|v| round(*v, 9)).collect::<Vec<_>>()),
        "parts": study.parts.iter().map(|p| part(study, p)).collect::<Vec<_>>(),
        "body_diagonals": study.diagonals.iter().map(|d| json!({
            "signs": d.signs,
            "from_mm": millimetres(&d.from_mm),
            "to_mm": millimetres(&d.to_mm),
            "systematic_um": um(d.systematic_mm),
            "mean_um": um(d.mean_mm),
            "reversal_um": um(d.reversal_mm),
            "length_error_um": um(d.length_error_mm),
            "distance_mm": d.deviations_mm.iter().map(|row| round(row[0], 6)).collect::<Vec<_>>(),
            "forward_um": d.deviations_mm.iter().map(|row| um(row[1])).collect::<Vec<_>>(),
            "backward_um": d.deviations_mm.iter().map(|row| um(row[2])).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "places": study.places.iter().map(|(freedom, place)| json!({
            "freedom": freedom_name(*freedom).english(),
            "box_mm": place.box_mm.map(range_mm),
            "centre_mm": millimetres(&place.fit.centre_mm),
            "shift_um": micrometres(&place.fit.shift_mm),
            "rotation_urad": micrometres(&(place.fit.rotation_rad * 1e3)),
            "before": figures(&place.fit.before),
            "after": figures(&place.fit.after),
        })).collect::<Vec<_>>(),
        "curves": study.curves.iter().map(|c| json!({
            "axis": (["X", "Y", "Z"][c.axis]),
            "at_mm": c.at_mm.iter().map(|v| round(*v, 6)).collect::<Vec<_>>(),
            "d_um": c.errors_mm.iter().map(micrometres).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "histogram": { "width_um": um(sizes.width_mm), "before": sizes.before, "after": sizes.after },
        "second_order": study.second_order.as_ref().map(second_order),
        "deformation": deformations(study),
    });
    crate::summary::json(&document)
}

/// Stretch, shear and rotation of the cells of a field.
fn deformations(study: &Study) -> Value {
    let Some(found) = deformation::figures(&study.cells) else { return Value::Null };
    let named = deformation::NAMES.iter().zip(&found).map(|(name, (range, rms))| {
        let figures = json!({
            "range": [round(range.low, 6), round(range.high, 6)],
            "rms": round(*rms, 6),
        });
        ((*name).to_owned(), figures)
    });
    let mut all: serde_json::Map<String, Value> = named.collect();
    all.insert("cells".to_owned(), json!(study.cells.len()));
    Value::Object(all)
}

fn part(study: &Study, part: &Part) -> Value {
    json!({
        "name": part.name.english(),
        "box_mm": part.box_mm.map(range_mm),
        "figures": figures(&part.figures),
        "zero_points": part.zero_points.iter().map(|z| zero_point(study, z)).collect::<Vec<_>>(),
    })
}

fn zero_point(study: &Study, zero: &ZeroPoint) -> Value {
    let enter = zero.to_enter_mm(study);
    let offsets: serde_json::Map<String, Value> = study
        .work_offsets
        .iter()
        .map(|offset| (offset.name.clone(), json!(millimetres(&offset.to_enter_mm(zero, study)))))
        .collect();
    let proof = match &zero.proof {
        Proof::Node { place_mm, sum_mm, examined } => {
            json!({ "node_mm": millimetres(place_mm), "sum_um": um(*sum_mm), "sums_computed": examined })
        }
        Proof::Sum { sum_mm, lower_bound_mm } => {
            json!({ "sum_um": um(*sum_mm), "no_sum_below_um": um(*lower_bound_mm) })
        }
        Proof::Radius { radius_mm, support } => {
            json!({ "no_largest_below_um": um(*radius_mm), "held_by_nodes": support })
        }
        Proof::Count { within, at_most } => json!({ "within": within, "no_count_above": at_most }),
    };
    json!({
        "kind": zero.kind.name().english(),
        "shift_um": micrometres(&zero.shift_mm),
        "add_to_work_offset_mm": millimetres(&enter),
        "work_offsets_mm": offsets,
        "figures": figures(&zero.figures),
        "proof": proof,
    })
}

fn figures(f: &Statistics) -> Value {
    let range = |r: &Range| json!([um(r.low), um(r.high)]);
    let width = |r: &Range| um(r.high - r.low);
    json!({
        "nodes": f.nodes,
        "dx_um": range(&f.component_mm[0]), "dy_um": range(&f.component_mm[1]), "dz_um": range(&f.component_mm[2]),
        "d_um": range(&f.magnitude_mm),
        "range_um": f.component_mm.each_ref().map(width),
        "rms_um": um(f.rms_mm),
        "p95_um": um(f.p95_mm),
        "max_um": um(f.magnitude_mm.high),
        "within": f.within,
        "share_within": round(f.share_within(), 9),
    })
}

fn second_order(found: &SecondOrder) -> Value {
    // Second order is small: nanometres and below are what it is about.
    let fine = |mm: f64| round(mm * 1e3, 9);
    json!({
        "nodes": found.nodes,
        "chain_place_mm": millimetres(&found.chain_place_mm),
        "chain_difference_um": fine(found.chain_difference_mm),
        "limit_um": fine(found.limit_mm),
        "angle_scale": found.threshold.map(|t| round(t.scale, 6)),
        "largest_angle_urad": found.threshold.map(|t| round(t.angle_rad * 1e6, 3)),
        "tool_mm": millimetres(&found.tool_mm),
        "place_mm": millimetres(&found.place_mm),
        "first_order_um": fine(found.first_mm),
        "all_plus_um": fine(found.plus_mm),
        "all_minus_um": fine(found.minus_mm),
        "all_orders_um": [fine(found.interval.low_mm), fine(found.interval.high_mm)],
        "orders": found.interval.orders,
    })
}

fn range_mm(r: Range) -> Value {
    json!([round(r.low, 6), round(r.high, 6)])
}

fn micrometres(v: &Vector) -> [f64; 3] {
    [v.x, v.y, v.z].map(um)
}
