//! Inverse: what to command so that the tool reaches points.

use jobs::figures::fixed;
use jobs::points::{self, DIRECTION_COLUMNS, direction_fields};
use jobs::solve::Solver;
use machine_model::Command;

use crate::arguments::{Shared, Solve};
use crate::message::{Failure, Messages};
use crate::settings::{machine, setup_tool};
use crate::{file, profile};

/// `vpost solve POINTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Solve, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let profile = profile::load_mill(machine(&shared.job)?)?.profile;
    let solver = Solver::with_law(&profile, &shared.job, arguments.gain, arguments.step)?;
    solver.doubts(&profile).iter().for_each(|report| messages.report(report));
    let bytes = file::read(&arguments.points)?;
    let name = file::name(&arguments.points);
    let points = points::read(&name, &bytes, setup_tool(&profile), &profile)?;
    let mut out = points.columns.join(",");
    out.push_str(",qx_mm,qy_mm,qz_mm");
    for (axis, has) in ["qa_deg", "qb_deg", "qc_deg"].iter().zip(points.rotary) {
        if has {
            out.push(',');
            out.push_str(axis);
        }
    }
    out.push_str(",iterations,residual_um");
    out.push_str(if solver.turns { DIRECTION_COLUMNS } else { "" });
    out.push('\n');
    for (row, (fields, command)) in points.rows.iter().enumerate() {
        let solution = solver
            .solve(row, command)
            .map_err(|diagnostic| Failure::refused(&name, &bytes, vec![diagnostic]))?;
        out.push_str(&fields.join(","));
        for value in solution.linear_mm.iter() {
            out.push(',');
            out.push_str(&fixed(*value, 9));
        }
        for axis in (0..3).filter(|axis| points.rotary[*axis]) {
            out.push(',');
            out.push_str(&fixed(command.rotary_rad[axis].to_degrees(), 9));
        }
        out.push_str(&format!(",{},{}", solution.iterations, fixed(solution.residual_mm * 1e3, 9)));
        if solver.turns {
            let command = Command { linear_mm: solution.linear_mm, ..*command };
            out.push_str(&direction_fields(profile.rigid_body_without_effects(), &command));
        }
        out.push('\n');
    }
    file::print(out.as_bytes())
}
