//! Pieces under cutter compensation: which blocks the control offsets as if they were one.

use toolpath::{Division, Feed, Shape};

/// Directions at a joint that differ by less go on from one another, rad: a correction turns a path by some 1e-4.
const STRAIGHT_RAD: f64 = 0.01;
/// Radii that differ by less are those of one arc in pieces, as a share.
const SAME_RADIUS: f64 = 0.1;
/// Share of the least length below which a piece is too short, so that no correction of a block as long makes it so.
const LEAST_SHARE: f64 = 0.9;

/// What the plane of the offset sees of a feed: its direction at start and end, its length, the radius of an arc (0: a line,
/// negative: clockwise).
struct Seen {
    directions: [[f64; 2]; 2],
    length_mm: f64,
    radius_mm: f64,
}

fn seen(feed: &Feed, normal: u8) -> Seen {
    let (from, to) = (feed.start.linear_mm, feed.end.linear_mm);
    match &feed.shape {
        Shape::Arc(arc) => {
            let [u, v, _] = arc.plane.axes();
            let turn = arc.sweep_rad.signum();
            let across = |place: [f64; 3]| {
                let (x, y) = (place[u] - arc.centre_mm[0], place[v] - arc.centre_mm[1]);
                let radius = units::math::hypot(x, y);
                (radius, [-y * turn / radius, x * turn / radius])
            };
            let ((radius_mm, first), (_, last)) = (across(from), across(to));
            let length_mm = radius_mm * arc.sweep_rad.abs();
            Seen { directions: [first, last], length_mm, radius_mm: radius_mm * turn }
        }
        Shape::Line | Shape::Bezier(_) => {
            let [u, v] = match normal {
                0 => [1, 2],
                1 => [2, 0],
                _ => [0, 1],
            };
            let (x, y) = (to[u] - from[u], to[v] - from[v]);
            let length_mm = units::math::hypot(x, y);
            Seen { directions: [[x / length_mm, y / length_mm]; 2], length_mm, radius_mm: 0.0 }
        }
    }
}

/// The least length of a piece, µm, and the axis that the offset leaves alone. A level block that was corrected climbs by
/// what the machine's error changes.
fn least(feed: &Feed) -> Option<(u32, u8)> {
    match feed.division {
        Division::Long { least_um, normal } | Division::LongClimbing { least_um, normal } => {
            Some((least_um, normal))
        }
        Division::Any | Division::OneBehindLines | Division::One => None,
    }
}

/// A feed goes on from the one before it so that the control's offset of both is that of one block.
pub(crate) fn goes_on(before: &Feed, feed: &Feed) -> bool {
    let (Some((least_um, normal)), Some((least_before_um, same))) = (least(feed), least(before)) else {
        return false;
    };
    if normal != same {
        return false;
    }
    let (first, second) = (seen(before, normal), seen(feed, normal));
    let long = |seen: &Seen, um: u32| seen.length_mm >= LEAST_SHARE * f64::from(um) * 1e-3;
    let ([_, [x0, y0]], [[x1, y1], _]) = (first.directions, second.directions);
    let bend = units::math::atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1);
    let apart = (first.radius_mm - second.radius_mm).abs();
    long(&first, least_before_um)
        && long(&second, least_um)
        && bend.abs() < STRAIGHT_RAD
        && apart <= SAME_RADIUS * first.radius_mm.abs().min(second.radius_mm.abs())
}
