//! The nose of a turning tool under G41 and G42: it touches beside the tip for which paths are corrected.

use diagnostic::{Diagnostic, Text, both};
use machine_model::{Command, PathModel, Vector};
use nc_dialect::Side;
use nc_program::{Context, Modal, ToolLength};
use nc_syntax::Block;
use toolpath::{Feed, Motion, Shape};

use crate::job::{Job, NOSE};

/// More than this share of the tolerance is not left to where the nose touches.
const MOST_OF_TOLERANCE: f64 = 0.5;

/// The radius of the nose whose offset is in force, mm, where a profile says it.
pub(crate) fn nose_mm(job: &Job<'_>, modal: &Modal) -> Option<f64> {
    let ToolLength::On { number, .. } = modal.tool_length else { return None };
    job.setup.noses_mm.iter().find(|(known, _)| *known == number).map(|(_, nose_mm)| *nose_mm)
}

/// By how much the error of the model differs at the ends of a motion between the tip and where a nose touches, mm.
///
/// The control leads the nose, whose centre is a radius off the contour, and whose tip is up to a radius off the centre
/// along each axis: where the nose touches, the carriage stands by `(1 + √2) r` at most from where the tip would touch, and
/// the tool's vector is as much longer. Compared in eight directions at both ends: between them it changes as little as
/// the error's slope does.
fn beside_mm(model: &dyn PathModel, nose_mm: f64, tool_mm: [f64; 3], feed: &Feed) -> f64 {
    let reach_mm = (1.0 + std::f64::consts::SQRT_2) * nose_mm;
    let tool_mm = Vector::from(tool_mm);
    let error = |place: [f64; 3], aside: Vector| {
        let linear_mm = Vector::from(place) + aside;
        let (rotary_rad, direction) = (Vector::zeros(), [0; 3]);
        model.error_mm(&Command {
            linear_mm,
            rotary_rad,
            tool_mm: tool_mm - aside,
            direction,
            ..Default::default()
        })
    };
    let difference = |place: [f64; 3]| {
        let here = error(place, Vector::zeros());
        let aside = |k: u8| {
            let (sin, cos) = units::math::sin_cos(f64::from(k) * std::f64::consts::FRAC_PI_4);
            (error(place, reach_mm * Vector::new(cos, 0.0, sin)) - here).norm()
        };
        (0..8).map(aside).fold(0.0, f64::max)
    };
    difference(feed.start.linear_mm).max(difference(feed.end.linear_mm))
}

/// What the nose takes of the tolerance under compensation, mm; nothing where none is led.
///
/// # Errors
/// An inner arc that the nose does not fit into, and a nose that touches where another correction is needed.
pub(crate) fn reserved_mm(
    job: &Job<'_>,
    modal: &Modal,
    motion: &Motion,
    block: &Block<'_>,
    context: &Context,
) -> Result<f64, Vec<Diagnostic>> {
    let (Some(side), Motion::Feed(feed)) = (context.compensation, motion) else { return Ok(0.0) };
    let Some(nose_mm) = nose_mm(job, modal) else { return Ok(0.0) };
    let refuse = |message: Text, label: Text, help: Text| {
        Err(vec![Diagnostic::error(NOSE, message).at(block.file_range(), label).help(help)])
    };
    if let Shape::Arc(arc) = &feed.shape {
        let [u, v, _] = arc.plane.axes();
        let start = feed.start.linear_mm;
        let arc_mm = units::math::hypot(start[u] - arc.centre_mm[0], start[v] - arc.centre_mm[1]);
        // The centre lies on the side of the tool.
        let inner = (arc.sweep_rad > 0.0) == (side == Side::Left);
        if inner && arc_mm < nose_mm {
            return refuse(
                both!(
                    "an inner arc of {arc_mm:.3} mm, and the tool's nose has {nose_mm} mm",
                    "внутренняя дуга {arc_mm:.3} мм, а радиус при вершине резца {nose_mm} мм"
                ),
                both!(
                    "the nose does not fit; controls stop here",
                    "вершина не входит; стойки здесь останавливаются"
                ),
                both!(
                    "take a tool with a smaller nose, or look whether G41 and G42 are swapped",
                    "возьмите резец с меньшим радиусом при вершине или проверьте, не перепутаны ли G41 и G42"
                ),
            );
        }
    }
    let beside_mm = beside_mm(job.models.axes, nose_mm, context.tool_mm, feed);
    if beside_mm > MOST_OF_TOLERANCE * job.options.tolerance_mm {
        return refuse(
            both!(
                "the nose of {nose_mm} mm touches where the machine's error is up to {:.2} um another than at its tip",
                "закругление {nose_mm} мм касается там, где погрешность станка отличается от погрешности в вершине до {:.2} мкм",
                beside_mm * 1e3
            ),
            both!(
                "too much of the tolerance to correct the tip's path for it",
                "слишком большая доля допуска, чтобы исправлять путь вершины"
            ),
            both!(
                "let the CAM write the tip's path, G40 in force, or accept more with `--tolerance`",
                "выводите из CAM путь вершины, при G40, или допустите больше ключом `--tolerance`"
            ),
        );
    }
    Ok(beside_mm)
}
