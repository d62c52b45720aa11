//! Finite rotations on this machine: what the first order leaves out.

use diagnostic::notice;
use error_map::ErrorMap;
use machine_model::finite_rotations::{
    OrderInterval, Threshold, Translation, Truncation, order_interval, second_order, threshold,
};
use machine_model::{Command, Vector};
use machine_profile::Profile;

use super::asked::Asked;
use crate::message::{Failure, OPTION};

/// Most nodes that are looked at: the errors of machines are smooth, and each costs 1296 compositions.
const MOST_NODES: usize = 2000;
/// Products of errors matter where they reach this, mm.
const LIMIT_MM: f64 = 1e-3;
/// The tool vector of Pimushkin 2023, taken where the map's has no length to be turned.
const PUBLISHED_TOOL_MM: f64 = 10.0;

/// Equations (20) to (22) over the map.
pub struct SecondOrder {
    /// Where exact product and first-order sum of the whole chain differ most, and by how much, mm.
    pub chain_place_mm: Vector,
    /// By how much, mm.
    pub chain_difference_mm: f64,
    /// Angles at which that difference reaches a micrometre.
    pub threshold: Option<Threshold>,
    /// What products of errors are measured by, mm.
    pub limit_mm: f64,
    /// Where the order of rotations matters most, in the published form.
    pub place_mm: Vector,
    /// From gauge point to tip, mm.
    pub tool_mm: Vector,
    /// |δ| to first order, all plus, all minus, mm.
    pub first_mm: f64,
    /// All angles positive.
    pub plus_mm: f64,
    /// All negative.
    pub minus_mm: f64,
    /// Over all orders of rotations.
    pub interval: OrderInterval,
    /// Looked at.
    pub nodes: usize,
}

pub(super) fn of(profile: &Profile, map: &ErrorMap, asked: &Asked) -> Result<SecondOrder, Failure> {
    if asked.rotary_rad != Vector::zeros() {
        return Err(Failure::usage(notice!(OPTION;
            "`--second-order` compares rotations of the linear axes only",
            "`--second-order` сравнивает повороты только линейных осей";
            "leave `--rotary` out", "уберите `--rotary`"
        )));
    }
    let volume = profile.volume();
    let step = map.grid().len().div_ceil(MOST_NODES);
    let commands: Vec<Command> = (0..map.grid().len())
        .step_by(step)
        .map(|index| asked.command(volume.nearest(&map.grid().place_mm(index)), [0; 3]))
        .collect();
    let machine = &profile.description;
    let chain = second_order(machine, &commands).expect("a profile is a machine, a grid has nodes");
    let tool_mm =
        if asked.tool_mm == Vector::zeros() { Vector::repeat(PUBLISHED_TOOL_MM) } else { asked.tool_mm };
    let interval =
        |command: &Command| order_interval(&machine.point_errors(command), &tool_mm, Translation::Physical);
    let width = |found: &OrderInterval| (found.corner_high_mm - found.corner_low_mm).norm();
    let (index, interval) = commands
        .iter()
        .map(interval)
        .enumerate()
        .reduce(|a, b| if width(&b.1) > width(&a.1) { b } else { a })
        .expect("a grid has nodes");
    let errors = machine.point_errors(&commands[index]);
    let length = |truncation| errors.displacement_mm(&tool_mm, truncation, Translation::Physical).norm();
    Ok(SecondOrder {
        chain_place_mm: commands[chain.index].linear_mm,
        chain_difference_mm: chain.difference_mm,
        threshold: threshold(machine, &commands, LIMIT_MM),
        limit_mm: LIMIT_MM,
        place_mm: commands[index].linear_mm,
        tool_mm,
        first_mm: length(Truncation::FirstOrder),
        plus_mm: length(Truncation::AllPlus),
        minus_mm: length(Truncation::AllMinus),
        interval,
        nodes: commands.len(),
    })
}
