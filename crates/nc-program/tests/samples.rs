//! The shipped sample programs: which motions they are, and where the faulty one is refused.

use crate::common;

use common::{Run, run_with, setup};
use toolpath::{Motion, Shape};

/// Rapids, lines, arcs, holes and uncorrected motions of a program.
///
/// The expected counts were taken from the texts by a script that knows no more than modal codes. The
/// Centroid post's M25 retracts Z, so it is an uncorrected motion beside M6.
fn census(run: &Run) -> [usize; 5] {
    let mut counts = [0; 5];
    for motion in run.steps.iter().flat_map(|step| &step.motions) {
        let kind = match motion {
            Motion::Rapid { .. } => 0,
            Motion::Feed(feed) => match feed.shape {
                Shape::Line => 1,
                Shape::Arc(_) | Shape::Bezier(_) => 2,
            },
            Motion::Hole(_) => 3,
            Motion::Uncorrected { .. } => 4,
        };
        counts[kind] += 1;
    }
    counts
}

/// Runs a sample under a shipped dialect; samples are ASCII or CP1251, so they are bytes.
fn sample(name: &str, bytes: &[u8]) -> Run {
    let text: String = bytes.iter().map(|byte| if byte.is_ascii() { *byte as char } else { '?' }).collect();
    run_with(common::dialect(name), &setup(), &text)
}

macro_rules! samples {
    ($($test:ident: $dialect:literal, $file:literal, $census:expr;)*) => {
        $(#[test]
        fn $test() {
            let run = sample($dialect, include_bytes!(concat!("../../../samples/", $file)));
            assert!(run.refused.is_none(), "{:?}", run.refused);
            assert_eq!(census(&run), $census);
            assert!(run.steps.last().is_some_and(|step| step.ends_program));
        })*
    };
}

samples! {
    dome: "fanuc", "dome_fanuc.nc", [151, 8175, 0, 0, 2];
    plate_linuxcnc: "linuxcnc", "plate_linuxcnc.nc", [247, 4513, 62, 4, 1];
    plate_centroid: "centroid", "plate_centroid.nc", [247, 4513, 62, 4, 2];
    bolt_circle: "fanuc", "bolt_circle_fanuc.nc", [5, 0, 0, 12, 1];
    pocket: "perspektiva", "pocket_perspektiva.nc", [3, 6, 5, 0, 0];
    contour: "fanuc", "contour_incremental_fanuc.nc", [3, 9, 4, 0, 1];
    helix: "linuxcnc", "helix_linuxcnc.ngc", [3, 2, 5, 0, 0];
    bracket: "fanuc", "bracket_inch_fanuc.nc", [4, 5, 3, 0, 1];
    arcs_in_planes: "linuxcnc", "arcs_in_planes_linuxcnc.ngc", [2, 3, 4, 0, 0];
    inverse_time: "linuxcnc", "inverse_time_linuxcnc.ngc", [2, 5, 1, 0, 0];
}

#[test]
fn the_faulty_post_is_refused_at_its_first_arc_without_centre() {
    let run = sample("fanuc", include_bytes!("../../../samples/plate_fanuc.nc"));
    let Some((line, diagnostics)) = &run.refused else { panic!("accepted") };
    assert_eq!((*line, diagnostics.as_slice().len(), diagnostics[0].code.0), (148, 1, 204));
    assert_eq!(census(&run)[2], 30);
}
