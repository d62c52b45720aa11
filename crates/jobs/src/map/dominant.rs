//! Which deviations make the error of a map.

use error_budget::{Budget, Machine};
use machine_model::effects::Conditions;
use machine_model::{EngineId, PathModel, Vector, WithEffects};
use machine_profile::Profile;
use rayon::prelude::*;

use super::asked::Asked;

/// Nodes along an axis: the largest error of a smooth machine lies at an end or near one.
const NODES: usize = 5;
/// One deviation, and what it does to the largest error of the map.
pub struct Dominant {
    /// `EC0Y`
    pub name: String,
    /// The largest error of the machine with it alone, mm.
    pub alone_mm: f64,
    /// The largest error of the machine without it, mm.
    pub without_mm: f64,
}

/// The deviations of the rigid-body model, first the one without which the largest error is smallest; none for models that
/// have no deviations to be taken out one by one.
pub fn dominant(profile: &Profile, id: EngineId, conditions: &Conditions, asked: &Asked) -> Vec<Dominant> {
    if id != EngineId::RigidBody {
        return Vec::new();
    }
    // Under these conditions the engine was built already.
    let Ok(model) = profile.machine(conditions) else { return Vec::new() };
    let machine = Machine::new(model);
    let places: [Vec<f64>; 3] = asked.grid.axes().each_ref().map(|nodes| {
        let all = nodes.places_mm();
        let kept = all.len().min(NODES);
        (0..kept).map(|k| all[if kept > 1 { k * (all.len() - 1) / (kept - 1) } else { 0 }]).collect()
    });
    let mut commands = Vec::new();
    for z in &places[2] {
        for y in &places[1] {
            commands.extend(places[0].iter().map(|x| asked.command(Vector::new(*x, *y, *z), [0; 3])));
        }
    }
    let evaluate = |model: &WithEffects| -> Vec<Vector> {
        commands.par_iter().map(|command| model.error_mm(command)).collect()
    };
    let Some(budget) = Budget::new(&machine, evaluate) else { return Vec::new() };
    budget
        .items
        .iter()
        .map(|item| Dominant {
            name: machine.deviations()[item.deviation].name.clone(),
            alone_mm: item.alone.largest_mm,
            without_mm: item.without.largest_mm,
        })
        .collect()
}
