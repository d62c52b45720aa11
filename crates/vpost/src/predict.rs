//! Forward: where the machine really goes.

use diagnostic::Severity;
use jobs::datums::FromZero;
use jobs::figures::fixed;
use jobs::points::{self, DIRECTION_COLUMNS, direction_fields};
use jobs::predict::{Frame, PointsOutside, Prediction, Predictor};

use crate::arguments::{Predict, Shared};
use crate::message::{Failure, Messages, Report};
use crate::settings::{machine, setup_tool};
use crate::{file, profile};

/// `vpost predict POINTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Predict, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    if arguments.lathe {
        return crate::turned::run(arguments, shared, messages);
    }
    let profile = profile::load_mill(machine(&shared.job)?)?.profile;
    let bytes = file::read(&arguments.points)?;
    let name = file::name(&arguments.points);
    let points = points::read(&name, &bytes, setup_tool(&profile), &profile)?;
    let frame = if arguments.include_setup { Frame::Measuring } else { Frame::Machine };
    let predictor = Predictor::new(&profile, &shared.job, frame)?;
    let mut out = points.columns.join(",");
    out.push_str(",px_mm,py_mm,pz_mm,dx_um,dy_um,dz_um,d_um");
    let zero = arguments.datum.as_deref();
    let datum = FromZero::of(&shared.job, &profile, predictor.model(), zero)?.placement(predictor.model());
    out.push_str(if zero.is_some() { ",ax_um,ay_um,az_um,a_um" } else { "" });
    out.push_str(if predictor.turns() { DIRECTION_COLUMNS } else { "" });
    out.push('\n');
    predictor.doubts().iter().for_each(|report| messages.report(report));
    for (row, (fields, command)) in points.rows.iter().enumerate() {
        predictor
            .require_tool(row, command)
            .map_err(|diagnostic| Failure::refused(&name, &bytes, vec![diagnostic]))?;
        let absolute = predictor.predict(command);
        let Prediction { position_mm, error_mm } = absolute.from_datum(&datum);
        out.push_str(&fields.join(","));
        for value in position_mm.iter() {
            out.push(',');
            out.push_str(&fixed(*value, 9));
        }
        let measured = zero.map(|_| absolute.error_mm);
        for value in [Some(error_mm), measured].iter().flatten().flat_map(|mm| [mm.x, mm.y, mm.z, mm.norm()])
        {
            out.push(',');
            out.push_str(&fixed(value * 1e3, 6));
        }
        if predictor.turns() {
            out.push_str(&direction_fields(predictor.base(), command));
        }
        out.push('\n');
    }
    let outside = PointsOutside::of(points.rows.iter().map(|(_, command)| predictor.contains(command)));
    if let Some(outside) = outside {
        let diagnostic = outside.diagnostic(&shared.job);
        if diagnostic.severity == Severity::Error {
            return Err(Failure::refused(&name, &bytes, vec![diagnostic]));
        }
        messages.report(&Report { source: None, diagnostics: vec![diagnostic] });
    }
    file::print(out.as_bytes())
}
