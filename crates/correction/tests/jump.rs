//! An engine that jumps between cells: no path across the jump is called corrected.

use correction::{Block, CorrectionError, Corrector, Options, Outside, Stated};
use machine_model::engines::TangentialInterval;
use machine_model::{Engine, Traverse, Vector};
use toolpath::{Division, Feed, FeedRate, Motion, Partial, Position, Shape};

/// Straight axes but for Y, which turns by 1 mrad at 100 mm: the interval method, which extrapolates
/// the second line back to the origin, jumps there.
fn engine() -> TangentialInterval {
    let nodes_mm = vec![0.0, 50.0, 100.0, 150.0, 200.0];
    let traverse = |axis: usize| {
        let measured = |q: &f64| {
            let mut p = [0.0; 3];
            p[axis] = *q;
            if axis == 1 {
                p[2] = (q - 100.0).max(0.0) * 1e-3;
            }
            p
        };
        let measured_mm = nodes_mm.iter().map(measured).collect();
        Traverse {
            axis,
            nodes_mm: nodes_mm.clone(),
            start_mm: [0.0; 3],
            measured_mm,
            published_cosines: None,
        }
    };
    TangentialInterval::new(&[traverse(0), traverse(1), traverse(2)]).expect("three traverses")
}

fn position(p: Vector) -> Position {
    Position { linear_mm: p.into(), rotary_deg: [0.0; 3] }
}

fn correct(start: Vector, end: Vector) -> Result<usize, CorrectionError> {
    let engine = engine();
    let stated = Stated { axes: [true; 3], ..Stated::default() };
    let block = Block { stated, ..Block::default() };
    let options = Options {
        tolerance_mm: 1e-3,
        accept_mm: 0.0,
        outside: Outside::Refuse,
        minimum_segment_mm: 0.0,
        orientation_rad: 5e-5,
        orientation: correction::Orientation::Tip,
    };
    let mut corrector = Corrector::new(engine.path_model().expect("it is a path model"), options);
    corrector.correct(&Motion::Rapid { start: Partial::default(), end: position(start).into() }, &block)?;
    let feed = Feed {
        start: position(start),
        end: position(end),
        shape: Shape::Line,
        rate: FeedRate::PerMinute,
        division: Division::Any,
    };
    corrector.correct(&Motion::Feed(feed), &block).map(|corrected| corrected.pieces.len())
}

#[test]
fn a_line_across_a_jump_is_refused() {
    let found = correct(Vector::new(20.0, 60.0, 30.0), Vector::new(20.0, 140.0, 30.0));
    assert!(
        matches!(found, Err(CorrectionError::NotWithinTolerance { distance_um, .. }) if distance_um > 10.0),
        "{found:?}"
    );
}

#[test]
fn a_line_inside_one_cell_is_corrected() {
    let found = correct(Vector::new(20.0, 110.0, 30.0), Vector::new(20.0, 140.0, 30.0));
    assert_eq!(found, Ok(1));
}
