//! Forward: where the machine really goes.

use diagnostic::{Code, Diagnostic};
use machine_model::{Engine, EngineId, Vector, rotation};

use crate::arguments::{Outside, Predict, Shared};
use crate::conditions::{conditions, failure};
use crate::figures::fixed;
use crate::message::{Failure, Messages, Report};
use crate::points::{self, DIRECTION_COLUMNS, direction_fields};
use crate::settings::{machine, setup_tool};
use crate::{file, profile};

/// Points outside the calibrated volume.
pub(crate) const POINT_OUTSIDE: Code = Code(909);

/// `vpost predict POINTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Predict, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    if arguments.lathe {
        return crate::turned::run(arguments, shared, messages);
    }
    let profile = profile::load_mill(machine(shared)?)?.profile;
    let bytes = file::read(&arguments.points)?;
    let name = file::name(&arguments.points);
    let points = points::read(&name, &bytes, setup_tool(&profile), &profile)?;
    let conditions = conditions(shared)?;
    let machine = if arguments.include_setup {
        profile.measured_machine(&conditions)
    } else {
        profile.machine(&conditions)
    }
    .map_err(|error| failure(&error))?;
    let other = shared.job.engine().filter(|id| *id != EngineId::RigidBody);
    let engine = other.map(|id| crate::conditions::engine(&profile, id, shared)).transpose()?;
    let other = match &engine {
        None => None,
        Some(engine) => Some(engine.path_model().ok_or_else(|| {
            Failure::option(
                format!("engine `{}` has no forward model: it reproduces a publication", engine.id()),
                "use it with `vpost solve`",
            )
        })?),
    };
    let volume = other.map_or_else(|| machine.volume(), |other| other.volume());
    let mut outside: Option<(usize, usize)> = None;
    let setup = &profile.setup;
    let mut out = points.columns.join(",");
    out.push_str(",px_mm,py_mm,pz_mm,dx_um,dy_um,dz_um,d_um");
    let turns = other.is_none() && profile.chain().has_rotary();
    out.push_str(if turns { DIRECTION_COLUMNS } else { "" });
    out.push('\n');
    for (row, (fields, command)) in points.rows.iter().enumerate() {
        if !volume.contains(&command.linear_mm) || machine.base().rotary_inside(command).is_err() {
            outside = Some(outside.map_or((row, 1), |(first, count)| (first, count + 1)));
        }
        let (mut position, mut error) = match other {
            None => {
                let prediction = machine.predict(command);
                (prediction.position_mm, prediction.error_mm)
            }
            Some(other) => {
                let error = other.error_mm(command);
                (command.linear_mm + command.tool_mm + error, error)
            }
        };
        if arguments.include_setup {
            // The measuring frame turns and shifts what it measures: p' = R p + shift, by any angle.
            let turn = rotation::of_any_size(&Vector::from(setup.rotation_rad));
            let moved = turn * position + Vector::from(setup.shift_mm) - position;
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
        if turns {
            out.push_str(&direction_fields(machine.base(), command));
        }
        out.push('\n');
    }
    if let Some((first, count)) = outside {
        let message = format!("{count} of {} points lie outside the calibrated volume", points.rows.len());
        if shared.job.outside == Some(Outside::Refuse) {
            let diagnostic =
                Diagnostic::error(POINT_OUTSIDE, format!("{message}, the first is point {}", first + 1))
                    .help("leave them out, or drop `--outside refuse` to take the nearest point's error");
            return Err(Failure::refused(&name, &bytes, vec![diagnostic]));
        }
        let diagnostic = Diagnostic::warning(POINT_OUTSIDE, message).help(format!(
            "point {} is the first; each has the error of the volume's nearest point",
            first + 1
        ));
        messages.report(&Report { source: None, diagnostics: vec![diagnostic] });
    }
    file::print(out.as_bytes())
}
