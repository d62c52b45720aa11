//! Squareness as an instrument or a file gave it, and what must be asked of it.

use calibration::functions::{self, Function, SquarenessConvention, straight_line};
use diagnostic::notice;
use machine_model::{Axis, Squareness};

use crate::message::Failure;

use super::codes::QUESTION;
use super::options::{Convention, Interferometer};

/// Everything read of one axis: its six functions.
pub(super) type Functions = [Option<Function>; 6];

/// Squareness that somebody read.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Asked {
    /// EC0Y, EB0Z, EA0Z in the model's signs, rad; `None` where nobody gave one.
    pub(super) rad: [Option<f64>; 3],
}

impl Asked {
    pub(super) fn is_given(&self) -> bool {
        self.rad.iter().any(Option::is_some)
    }
}

/// The squareness that was read, in the model's signs.
///
/// * `from_file_rad` – XY, ZX, YZ as a file had them
pub(super) fn from_the_user(
    arguments: &Interferometer,
    from_file_rad: Option<[f64; 3]>,
    axes: &[Functions; 3],
) -> Result<Asked, Failure> {
    let read_rad = match &arguments.squareness {
        Some(given) => given.0.map(|urad| Some(urad? * 1e-6)),
        None => match from_file_rad {
            Some(angles) => angles.map(Some),
            None => return Ok(Asked::default()),
        },
    };
    let convention = match arguments.squareness_convention {
        Some(Convention::RightHanded) => SquarenessConvention::RightHanded,
        Some(Convention::LargerThan90) => SquarenessConvention::LargerThan90,
        None => {
            return Err(Failure::usage(notice!(QUESTION;
                "what does a positive squareness mean? instruments disagree",
                "что значит положительная перпендикулярность? у приборов по-разному";
                "add `--squareness-convention right-handed` (ISO 230-1: ZX positive where the angle between +Z and +X is below 90°) or `--squareness-convention larger-than90` (positive above 90° in every plane)",
                "добавьте `--squareness-convention right-handed` (ISO 230-1: ZX положительна, если угол между +Z и +X меньше 90°) или `--squareness-convention larger-than90` (положительна при угле больше 90° в каждой плоскости)"
            )));
        }
    };
    if arguments.straightness_slopes.is_none()
        && let Some((name, urad)) = steepest(axes)
    {
        return Err(Failure::usage(notice!(QUESTION;
            "{name} has a slope of {urad:.1} urad: is it part of the squareness that was read, or beside it?",
            "у {name} наклон {urad:.1} мкрад: он входит в измеренную перпендикулярность или дан отдельно от неё?";
            "add `--straightness-slopes remove` where the squareness holds it already, or `--straightness-slopes keep`",
            "добавьте `--straightness-slopes remove`, если он уже есть в перпендикулярности, или `--straightness-slopes keep`"
        )));
    }
    Ok(Asked { rad: in_the_models_signs(read_rad, convention) })
}

/// The straightness with the largest slope, where that matters: more than 1 µm over its length.
fn steepest(axes: &[Functions; 3]) -> Option<(String, f64)> {
    let mut worst: Option<(String, f64)> = None;
    for (axis, functions) in axes.iter().enumerate() {
        for (f, function) in functions.iter().enumerate().take(3).filter(|(f, _)| *f != axis) {
            let Some(function) = function else { continue };
            let slope = straight_line(&function.positions_mm, &function.mean).0;
            let length = function.positions_mm[function.positions_mm.len() - 1] - function.positions_mm[0];
            if (slope * length).abs() > 1e-3
                && worst.as_ref().is_none_or(|(_, w)| slope.abs() * 1e6 > w.abs())
            {
                worst = Some((format!("E{}{}", Axis::ALL[f], Axis::ALL[axis]), slope * 1e6));
            }
        }
    }
    worst
}

/// Signs of the model for what an instrument calls squareness, plane by plane.
fn in_the_models_signs(read_rad: [Option<f64>; 3], convention: SquarenessConvention) -> [Option<f64>; 3] {
    let Squareness { ec0y_rad, eb0z_rad, ea0z_rad } =
        functions::squareness(read_rad.map(Option::unwrap_or_default), convention);
    let all = [ec0y_rad, eb0z_rad, ea0z_rad];
    std::array::from_fn(|k| read_rad[k].map(|_| all[k]))
}
