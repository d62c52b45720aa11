//! Forward: where the machine really goes.

use machine_model::Vector;

use crate::arguments::{Predict, Shared};
use crate::conditions::{conditions, failure};
use crate::message::{Failure, Messages};
use crate::points::{Points, fixed};
use crate::settings::{machine, setup_tool};
use crate::{file, profile};

/// `vpost predict POINTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Predict, shared: &Shared, _: &Messages) -> Result<(), Failure> {
    let profile = profile::load(machine(shared)?)?.profile;
    let bytes = file::read(&arguments.points)?;
    let name = file::name(&arguments.points);
    let points = Points::read(&name, &bytes, setup_tool(&profile))?;
    let conditions = conditions(shared)?;
    let machine = if arguments.include_setup {
        profile.measured_machine(&conditions)
    } else {
        profile.machine(&conditions)
    }
    .map_err(|error| failure(&error))?;
    let setup = &profile.setup;
    let mut out = points.columns.join(",");
    out.push_str(",px_mm,py_mm,pz_mm,dx_um,dy_um,dz_um,d_um\n");
    for (fields, command) in &points.rows {
        let prediction = machine.predict(command);
        let (mut position, mut error) = (prediction.position_mm, prediction.error_mm);
        if arguments.include_setup {
            // The measuring frame turns and shifts what it measures: p' = p + shift + rotation × p.
            let moved = Vector::from(setup.shift_mm) + Vector::from(setup.rotation_rad).cross(&position);
            position += moved;
            error += moved;
        }
        out.push_str(&fields.join(","));
        for value in position.iter() {
            out.push(',');
            out.push_str(&fixed(*value, 9));
        }
        for value in error.iter().copied().chain([error.norm()]) {
            out.push(',');
            out.push_str(&fixed(value * 1e3, 6));
        }
        out.push('\n');
    }
    file::print(out.as_bytes())
}
