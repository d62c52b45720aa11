//! The first-order sum of all errors: equation (14), an independent check of the exact product.

use crate::{Command, Description, Vector};

/// Volumetric error of the linear axes to first order, mm.
///
/// `d = Σ δ_i + squareness + Σ ε_i × (Σ_{j after i} q_j·e_j + t - ℓ_i)`, methods of ISO 230-1 and
/// Teleshevsky 2013 (formula 1 is this for the chain X, Y, Z). Neglects products of errors: about 1 µm
/// per metre and milliradian squared. Rotary axes are taken as perfect.
///
/// The command must lie inside the tables' range.
#[must_use]
pub fn first_order_error_mm(machine: &Description, command: &Command) -> Vector {
    let order = machine.chain.linear();
    let q = command.linear_mm;
    let skew = machine.squareness;
    let mut d = Vector::new(-skew.ec0y_rad * q.y + skew.eb0z_rad * q.z, -skew.ea0z_rad * q.z, 0.0);
    for (place, link) in order.iter().enumerate() {
        let axis = link.direction();
        let data = &machine.linear[axis];
        let direction = command.direction[axis];
        let at = |tables: &Option<crate::AxisTables>| tables.as_ref().map_or([0.0; 6], |t| t.at(q[axis]));
        let mut e = at(&data.errors);
        if data.errors_negative.is_some() {
            let negative = at(&data.errors_negative);
            let share = [1.0, 0.5, 0.0][(direction.signum() + 1) as usize];
            e = std::array::from_fn(|i| e[i] + share * (negative[i] - e[i]));
        }
        e[axis] -= 0.5 * data.backlash_mm * f64::from(direction.signum());
        let mut lever = command.tool_mm - data.measured_tool_mm;
        for later in &order[place + 1..] {
            let j = later.direction();
            lever[j] += q[j] - data.measured_at_mm[j];
        }
        d += Vector::new(e[0], e[1], e[2]) + Vector::new(e[3], e[4], e[5]).cross(&lever);
    }
    d
}
