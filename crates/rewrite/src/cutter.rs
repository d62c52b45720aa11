//! A mill's cutter under G41 and G42: its centre runs a radius beside the contour that is corrected.

use machine_model::{Command, PathModel, Vector};
use nc_program::{Context, Modal};
use toolpath::{Feed, Motion, Shape};

use crate::job::Job;

/// More than this share of the tolerance is not left to where the centre runs; it is said instead.
const MOST_OF_TOLERANCE: f64 = 0.5;

/// What the centre of a cutter of known radius is off by, beside what its contour is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Beside {
    /// What of it is left of the tolerance, mm.
    pub(crate) reserved_mm: f64,
    /// More than that, mm: to be said.
    pub(crate) said_mm: f64,
}

/// By how much the error of the model differs between the contour and the cutter's centre along a motion.
///
/// `None` where it is not compensated, or its radius is not known. Compared in eight directions about three places: between
/// them it changes as little as the error's slope does.
pub(crate) fn beside(job: &Job<'_>, modal: &Modal, motion: &Motion, context: &Context) -> Option<Beside> {
    let (Some(_), Motion::Feed(feed)) = (context.compensation, motion) else { return None };
    let radius_mm = modal.offset.radius_mm()?;
    let [u, v, _] = context.plane.axes();
    let tool_mm = Vector::from(context.tool_mm);
    let places = [feed.start.linear_mm, middle(feed), feed.end.linear_mm];
    let rotary_rad = Vector::from(feed.start.rotary_deg.map(f64::to_radians));
    let state = Command { rotary_rad, tool_mm, ..Command::default() };
    let most = |place: &[f64; 3]| {
        beside_mm(job.models.axes, &Command { linear_mm: Vector::from(*place), ..state }, [u, v], radius_mm)
    };
    let mm = places.iter().map(most).fold(0.0, f64::max);
    let fits = mm <= MOST_OF_TOLERANCE * job.options.tolerance_mm;
    Some(if fits {
        Beside { reserved_mm: mm, said_mm: 0.0 }
    } else {
        Beside { reserved_mm: 0.0, said_mm: mm }
    })
}

/// The largest difference of the error at a command to those a radius from it, mm.
fn beside_mm(model: &dyn PathModel, at: &Command, plane: [usize; 2], radius_mm: f64) -> f64 {
    let here = model.error_mm(at);
    let aside = |k: u8| {
        let (sin, cos) = units::math::sin_cos(f64::from(k) * std::f64::consts::FRAC_PI_4);
        let mut there = *at;
        there.linear_mm[plane[0]] += radius_mm * cos;
        there.linear_mm[plane[1]] += radius_mm * sin;
        (model.error_mm(&there) - here).norm()
    };
    (0..8).map(aside).fold(0.0, f64::max)
}

/// The middle of a feed, mm.
fn middle(feed: &Feed) -> [f64; 3] {
    let (from, to) = (feed.start.linear_mm, feed.end.linear_mm);
    let mut place = [0, 1, 2].map(|axis| 0.5 * (from[axis] + to[axis]));
    if let Shape::Arc(arc) = &feed.shape {
        let [u, v, _] = arc.plane.axes();
        let (x, y) = (from[u] - arc.centre_mm[0], from[v] - arc.centre_mm[1]);
        let (sin, cos) = units::math::sin_cos(0.5 * arc.sweep_rad);
        place[u] = arc.centre_mm[0] + cos * x - sin * y;
        place[v] = arc.centre_mm[1] + sin * x + cos * y;
    }
    place
}
