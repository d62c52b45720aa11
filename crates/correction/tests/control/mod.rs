//! A control that knows nothing but the pieces: program words in, axis commands out.

#![allow(clippy::expect_used, reason = "helpers of tests may stop the test")]

use correction::{
    Block, Centre, Corrected, CorrectionError, Corrector, Curve, Goal, Options, Outside, Piece, PieceKind,
    Stated,
};
use machine_model::Vector;
use toolpath::{Division, Feed, FeedRate, Frame, Motion, Partial, Plane, Position, Shape};

/// What a block with words of these letters states.
pub(crate) fn stated(text: &str) -> Stated {
    let each = |names: [char; 3]| names.map(|letter| text.contains(letter));
    Stated {
        axes: each(['X', 'Y', 'Z']),
        rotary: each(['A', 'B', 'C']),
        centre: each(['I', 'J', 'K']),
        radius: text.contains('R'),
        turns: text.contains('P'),
    }
}

pub(crate) fn block(text: &str, incremental: bool) -> Block {
    Block {
        frame: Frame::shift([10.0, -20.0, 5.5]),
        incremental: [incremental; 3],
        stated: stated(text),
        ..Block::default()
    }
}

pub(crate) const OPTIONS: Options = Options {
    tolerance_mm: 1e-3,
    accept_mm: 0.0,
    outside: Outside::Refuse,
    minimum_segment_mm: 0.0,
    orientation_rad: 5e-5,
    orientation: correction::Orientation::Tip,
};
/// What the promise allows at 0.001 mm: 1 µm and half a step on each axis.
pub(crate) const ALLOWED_MM: f64 = 1e-3 + 0.000_866_1;

/// A control: program words in, axis commands out.
pub(crate) struct Control {
    pub(crate) at: Vector,
}

impl Control {
    pub(crate) fn run(
        &mut self,
        piece: &Piece,
        block: &Block,
        own_end: &Vector,
        own_centre: Option<[f64; 2]>,
        plane: Plane,
    ) -> Option<Curve> {
        let standing = block.frame.to_program(self.at.into());
        let own = block.frame.to_program((*own_end).into());
        let value = |axis: usize, word: Goal| match word {
            Goal::Stays => standing[axis],
            Goal::AsStated => own[axis],
            Goal::Steps(counts) if block.incremental[axis] => standing[axis] + counts as f64 * 1e-3,
            Goal::Steps(counts) => counts as f64 * 1e-3,
        };
        let end: Vector = block.frame.to_machine([0, 1, 2].map(|i| value(i, piece.axes[i]))).into();
        let start = std::mem::replace(&mut self.at, end);
        match piece.kind {
            PieceKind::Line => Some(Curve::Line(start, end)),
            PieceKind::Arc { clockwise, centre: Centre::Offsets(words) } => {
                let [u, v, n] = plane.axes();
                let own = own_centre.unwrap_or([f64::NAN; 2]);
                let offset = |k: usize, word: Goal| match word {
                    Goal::Stays => 0.0,
                    Goal::AsStated => own[k],
                    Goal::Steps(counts) => counts as f64 * 1e-3,
                };
                let centre = [start[u] + offset(0, words[0]), start[v] + offset(1, words[1])];
                let angle = |p: &Vector| units::math::atan2(p[v] - centre[1], p[u] - centre[0]);
                let radius = |p: &Vector| units::math::hypot(p[u] - centre[0], p[v] - centre[1]);
                let mut sweep = angle(&end) - angle(&start);
                let same = (start[u] - end[u]).abs() < 1e-9 && (start[v] - end[v]).abs() < 1e-9;
                if clockwise {
                    while sweep > -1e-12 || (same && sweep > -6.0) {
                        sweep -= std::f64::consts::TAU;
                    }
                } else {
                    while sweep < 1e-12 || (same && sweep < 6.0) {
                        sweep += std::f64::consts::TAU;
                    }
                }
                assert!(
                    (radius(&start) - radius(&end)).abs() < 0.005,
                    "radii {} {}",
                    radius(&start),
                    radius(&end)
                );
                Some(Curve::Arc {
                    axes: [u, v, n],
                    centre,
                    angle: angle(&start),
                    sweep,
                    radius: [radius(&start), radius(&end)],
                    ends: [start, end],
                })
            }
            _ => None,
        }
    }
}

/// Distance of a point from a finely sampled path around s, mm.
pub(crate) fn distance(wanted: &Curve, p: &Vector) -> f64 {
    let mut best = (f64::INFINITY, 0.0);
    for k in 0..=400 {
        let s = f64::from(k) / 400.0;
        let d = (wanted.at(s) - p).norm();
        if d < best.0 {
            best = (d, s);
        }
    }
    // The distance is smooth there: narrowing reaches nanometres. A full circle's two ends are one place.
    let refine = |around: f64| {
        let (mut low, mut high) = ((around - 0.0025).max(0.0), (around + 0.0025).min(1.0));
        for _ in 0..60 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if (wanted.at(a) - p).norm() < (wanted.at(b) - p).norm() {
                high = b;
            } else {
                low = a;
            }
        }
        (wanted.at(0.5 * (low + high)) - p).norm()
    };
    [best.1, 0.0, 1.0].map(refine).into_iter().fold(best.0, f64::min)
}

pub(crate) fn position(p: Vector) -> Position {
    Position { linear_mm: p.into(), rotary_deg: [0.0; 3] }
}

/// Brings the corrector and the control to a start by a rapid.
pub(crate) fn begin(corrector: &mut Corrector<'_>, start: Vector) -> Control {
    let block = block("XYZ", false);
    let motion = Motion::Rapid { start: Partial::default(), end: position(start).into() };
    let corrected = corrector.correct(&motion, &block).expect("the start is inside the volume");
    let mut control = Control { at: start };
    if let [piece] = corrected.pieces.as_slice() {
        control.run(piece, &block, &start, None, Plane::Xy);
    }
    control
}

pub(crate) struct Ran {
    pub(crate) corrected: Corrected,
    pub(crate) curves: Vec<Curve>,
}

pub(crate) fn feed(
    corrector: &mut Corrector<'_>,
    control: &mut Control,
    start: Vector,
    end: Vector,
    shape: Shape,
    block: &Block,
) -> Ran {
    tried(corrector, control, start, end, shape, block).expect("the motion can be corrected")
}

pub(crate) fn tried(
    corrector: &mut Corrector<'_>,
    control: &mut Control,
    start: Vector,
    end: Vector,
    shape: Shape,
    block: &Block,
) -> Result<Ran, CorrectionError> {
    let motion = Motion::Feed(Feed {
        start: position(start),
        end: position(end),
        shape,
        rate: FeedRate::PerMinute,
        division: Division::Any,
    });
    let corrected = corrector.correct(&motion, block)?;
    let (plane, centre) = match shape {
        Shape::Arc(arc) => {
            let [u, v, _] = arc.plane.axes();
            (arc.plane, Some([arc.centre_mm[0] - start[u], arc.centre_mm[1] - start[v]]))
        }
        Shape::Line | Shape::Bezier(_) => (Plane::Xy, None),
    };
    let own_end = if block.incremental[0] { control.at + (end - start) } else { end };
    let untouched = [Piece {
        kind: match shape {
            Shape::Line | Shape::Bezier(_) => PieceKind::Line,
            Shape::Arc(arc) => PieceKind::Arc {
                clockwise: arc.sweep_rad < 0.0,
                centre: Centre::Offsets([Goal::AsStated; 2]),
            },
        },
        axes: [0, 1, 2].map(|i| if block.stated.axes[i] { Goal::AsStated } else { Goal::Stays }),
        rotary: None,
        share: 1.0,
    }];
    let pieces = if corrected.pieces.is_empty() { &untouched[..] } else { &corrected.pieces };
    let curves =
        pieces.iter().filter_map(|piece| control.run(piece, block, &own_end, centre, plane)).collect();
    Ok(Ran { corrected, curves })
}
