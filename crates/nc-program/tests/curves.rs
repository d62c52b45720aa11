//! G5, G5.1, G5.2 with G5.3 and G6.2: what is read, and what is refused, each for its own reason.

use crate::common;

use common::{feed, run};
use nc_program::CurvePart;
use proptest::prelude::*;
use toolpath::{Motion, Shape};

const START: &str = "G17 G21 G90\nG0 X0 Y0 Z10.\nF100\n";

/// The places of a curve at even steps of each of its parts.
fn places(motions: &[Motion]) -> Vec<[f64; 3]> {
    let mut places = Vec::new();
    for motion in motions {
        let feed = feed(motion);
        for s in [0.0, 0.25, 0.5, 1.0] {
            places.push(match &feed.shape {
                Shape::Bezier(curve) => curve.at(&feed.start.linear_mm, &feed.end.linear_mm, s),
                _ => std::array::from_fn(|i| {
                    feed.start.linear_mm[i] + (feed.end.linear_mm[i] - feed.start.linear_mm[i]) * s
                }),
            });
        }
    }
    places
}

fn of_last_block(dialect: &str, text: &str) -> Vec<[f64; 3]> {
    let run = run(dialect, &format!("{START}{text}"));
    assert!(run.refused.is_none(), "{text}: {:?}", run.refused);
    let cut =
        run.steps.iter().rev().find(|step| step.context.curve == Some(CurvePart::Cut)).expect("a curve");
    places(&cut.motions)
}

fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12)
}

/// By LinuxCNC's own evaluation (its module `gcode`, version 2.9).
#[test]
fn what_linuxcnc_evaluates() {
    // G5 I0 J3 P0 Q-3 X1 Y1: u of 15/60, 30/60.
    let cubic = of_last_block("linuxcnc", "G5 I0 J3 P0 Q-3 X1 Y1\n");
    assert!(near(cubic[1], [0.15625, 1.0, 10.0]) && near(cubic[2], [0.5, 0.5, 10.0]), "{cubic:?}");
    // The next one goes on as the first has ended.
    let more = of_last_block("linuxcnc", "G5 I0 J3 P0 Q-3 X1 Y1\nG5 P1 Q-2 X3 Y3\n");
    assert!(near(more[1], [1.453125, 2.296875, 10.0]) && near(more[2], [2.375, 2.375, 10.0]), "{more:?}");
    let quadratic = of_last_block("linuxcnc", "G5.1 X2 Y2 I1 J1\n");
    assert!(near(quadratic[2], [1.0, 1.0, 10.0]), "{quadratic:?}");
    // The manual's: five control points with the start, of weight 2 at the end; u = 1.5, 2 and 2.5 of 3.
    let text = "G5.2 X0 Y1 P1 L3\nX2 Y2 P1\nX2 Y0 P1\nX0 Y0 P2\nG5.3\n";
    let nurbs = of_last_block("linuxcnc", text);
    assert_eq!(nurbs.len(), 12);
    assert!(near(nurbs[7], [2.0, 1.0, 10.0]), "{nurbs:?}");
    assert!((nurbs[10][0] - 1.351_206_434_316_351).abs() < 0.2, "{nurbs:?}");
    assert!(near(nurbs[11], [0.0, 0.0, 10.0]), "{nurbs:?}");
    // Increments count from the start of the curve.
    let incremental = of_last_block("linuxcnc", "G0 X10\nG91\nG5.2 X0 Y1 P1 L3\nX1 Y1 P1\nX2 Y0 P1\nG5.3\n");
    assert!(near(incremental[7], [12.0, 0.0, 10.0]), "{incremental:?}");
}

#[test]
fn the_manual_of_the_series_15i() {
    // A NURBS of order 3 with a knot in each block and three behind: a quarter of an ellipse's parabola.
    let text =
        "G6.2 P3 K0. X0. Y0. Z10. R1.\nK0. X0. Y5. Z10. R1.\nK0. X5. Y5. Z10. R1.\nK1.\nK1.\nK1.\nG1 X9.\n";
    let curve = of_last_block("fanuc", text);
    assert!(near(curve[2], [1.25, 3.75, 10.0]) && near(curve[3], [5.0, 5.0, 10.0]), "{curve:?}");
    // In space, and with the default order of 4.
    let text = "G6.2 K0 X0 Y0 Z10000\nK0 X1000 Y0 Z10000\nK0 X1000 Y1000 Z10000\nK0 X1000 Y1000 Z12000\nK1000\nK1000\nK1000\nK1000\n";
    let curve = of_last_block("fanuc", text);
    assert!(near(curve[2], [0.875, 0.5, 10.25]), "{curve:?}");
    // LinuxCNC's, in the plane of G18.
    let text = "G18\nG6.2 X0 Z10 R1 K0 P4 Q1\nX4 Z10 R1 K0\nX4 Z14 R1 K0\nX8 Z14 R1 K0\nG6.2 K1\nG6.2 K1\nG6.2 K1\nG6.2 K1\n";
    let curve = of_last_block("linuxcnc", text);
    assert!(near(curve[2], [4.0, 0.0, 12.0]) && near(curve[3], [8.0, 0.0, 14.0]), "{curve:?}");
}

#[test]
fn each_fault_has_its_own_message() {
    let curve = "G5.2 X0 Y1 P1 L3\nX2 Y2 P1\nX2 Y0 P1\n";
    let table: &[(&str, &str, u16, &str)] = &[
        ("linuxcnc", "G5 X1 Y1 P0 Q1\n", 233, "first G5 without I and J"),
        ("linuxcnc", "G5 X1 Y1 I0 J1 P0 Q1\nG1 X2\nG5 X3 Y3 P0 Q1\n", 233, "first G5 without I and J"),
        ("linuxcnc", "G5 X1 Y1 I0 P0 Q1\n", 233, "only one of I and J"),
        ("linuxcnc", "G5 X1 Y1 I0 J1 P0\n", 233, "without both P and Q"),
        ("linuxcnc", "G5.1 X1 Y1 I0\n", 233, "G5.1 without both I and J"),
        ("linuxcnc", "G5.1 X1 Y1 I0 J1 P0 Q1\n", 233, "P or Q in a quadratic"),
        ("linuxcnc", "G18\nG5 X1 Y1 I0 J1 P0 Q1\n", 233, "outside the plane of G17"),
        ("linuxcnc", "G5 X1 Y1 Z1 I0 J1 P0 Q1\n", 233, "Z in a curve of another plane"),
        ("linuxcnc", "G19\nG5.2 X1 Y1 P1\n", 233, "X in a curve of another plane"),
        ("linuxcnc", "G41 D1\nG5 X1 Y1 I0 J1 P0 Q1\n", 233, "under cutter compensation"),
        ("linuxcnc", "G93\nG5 X1 Y1 I0 J1 P0 Q1 F1\n", 233, "under G93"),
        ("linuxcnc", "G5.2 X1 P1\n", 233, "only one of X, Y"),
        ("linuxcnc", "G5.2 X1 Y1\n", 233, "without its weight P"),
        ("linuxcnc", "G5.2 X1 Y1 P0\n", 233, "not above zero"),
        ("linuxcnc", "G5.2 X1 Y1 P-1\n", 233, "not above zero"),
        ("linuxcnc", "G5.2 X1 Y1 P1 L2\n", 233, "of this order"),
        ("linuxcnc", "G5.2 X1 Y1 P1 L7\n", 233, "of this order"),
        ("linuxcnc", "G5.2 X1 Y1 P1\nX2 Y2 P1 L4\n", 233, "behind its first block"),
        ("linuxcnc", "G5.2 X1 Y1 P1\nP2\n", 233, "weight without its control point"),
        ("linuxcnc", "G5.2 X1 Y1 P1\nG5.3\n", 233, "too few control points"),
        ("linuxcnc", "G5.3\n", 233, "without G5.2 before it"),
        ("linuxcnc", "G5.2 X0 Y1 P1\nX2 Y2 P1\nG5.3 X3 Y3 P1\n", 233, "words beside G5.3"),
        ("linuxcnc", &format!("{curve}G1 X0\n"), 234, "is not whole"),
        ("linuxcnc", &format!("{curve}M2\n"), 234, "is not whole"),
        ("linuxcnc", &format!("{curve}%\n"), 234, "is not whole"),
        ("linuxcnc", &format!("{curve}G54\n"), 234, "is not whole"),
        ("linuxcnc", &format!("/{curve}"), 233, "may be skipped"),
        ("linuxcnc", &format!("{curve}G5.3\nX1\n"), 212, ""),
        ("linuxcnc", "G5 X1 Y1 I0 J1 P0 Q1\nX2 Y2\n", 212, ""),
        ("linuxcnc", "G6.2 X0 Y0 R1 K0\n", 233, "without its order P"),
        ("linuxcnc", "G6.3\n", 208, ""),
        ("fanuc", "G6.2 P5 K0. X0. Y0.\n", 233, "of this order"),
        ("fanuc", "G6.2 K0. X1. Y0.\n", 233, "not where the axes stand"),
        ("fanuc", "G6.2 K0.\n", 233, "without its first control point"),
        ("fanuc", "G6.2 K0. X0. Y0.\nX1. Y1.\n", 233, "without its knot K"),
        ("fanuc", "G6.2 K1. X0. Y0.\nK0.5 X1. Y1.\n", 233, "knots of a curve decrease"),
        ("fanuc", "G6.2 K0. X0. Y0. R0.\n", 233, "not above zero"),
        ("fanuc", "G6.2 K0. X0. Y0.\nK0. X1. Y1. R-1.\n", 233, "not above zero"),
        ("fanuc", "G6.2 K0. X0. Y0.\nK1. X1. Y1. R2\n", 233, "with and without a decimal point"),
        ("fanuc", "G6.2 K0. X0. Y0.\nK0. X1.\n", 233, "names other axes"),
        ("fanuc", "G6.2 K0. X0. Y0.\nK0. X1. Y1.\nK1.\n", 233, "too few control points"),
        ("fanuc", "G6.2 P2 K0. X0. Y0.\nK0. X1. Y1.\nK1.\nK1. X2. Y2.\n", 233, "behind knots alone"),
        (
            "fanuc",
            "G6.2 P3 K0. X0. Y0.\nK0. X1. Y1.\nK1. X1. Y2.\nK1.\nK1.\nK1.\n",
            233,
            "first knots of the curve differ",
        ),
        (
            "fanuc",
            "G6.2 P3 K0. X0. Y0.\nK0. X1. Y1.\nK0. X1. Y2.\nK1.\nK1.\nK2.\n",
            233,
            "last knots of the curve differ",
        ),
        ("fanuc", "G91\nG6.2 K0. X0. Y0.\n", 233, "under G91"),
        ("fanuc", "G6.2 K0. X0. Y0.\nK0. X1. Y1.\nG1 X3.\n", 234, "is not whole"),
        ("fanuc", "G6.2 P2 K0. X0. Y0.\nK0. X1. Y1.\nK1.\nK1.\nX2.\n", 233, "behind the end of a curve"),
    ];
    for (dialect, text, code, message) in table {
        let text = format!("{START}{text}");
        let refused = run(dialect, &text).refused;
        let (_, said) = refused.unwrap_or_else(|| panic!("{text} is not refused"));
        let [said] = said.as_slice() else { panic!("{said:?}") };
        assert_eq!(said.code.0, *code, "{text}: {said:?}");
        assert!(said.to_string().contains(message), "{text}: {said}");
        assert!(said.help.is_some(), "{text}");
    }
}

proptest! {
    /// Whatever words stand in the blocks of a curve, it is read or refused, and what is read begins and ends where it says.
    #[test]
    fn no_words_lead_astray(
        fanuc: bool,
        blocks in prop::collection::vec((0usize..9, prop::collection::vec((0usize..10, -3i32..6), 0..6)), 1..9),
    ) {
        const CODES: [&str; 9] = ["", "", "", "G5.2", "G5.3", "G5", "G5.1", "G6.2", "G1"];
        let mut text = START.to_owned();
        for (code, words) in &blocks {
            text.push_str(CODES[*code]);
            for (letter, value) in words {
                let letter = b"XYZIJKPQRL"[*letter] as char;
                text.push_str(&format!(" {letter}{value}."));
            }
            text.push('\n');
        }
        let run = run(if fanuc { "fanuc" } else { "linuxcnc" }, &text);
        let mut at = [0.0, 0.0, 10.0];
        for step in &run.steps[3..] {
            for motion in &step.motions {
                if let Motion::Rapid { end, .. } = motion {
                    at = [0, 1, 2].map(|axis| end.linear_mm[axis].unwrap_or(at[axis]));
                }
                let Motion::Feed(feed) = motion else { continue };
                prop_assert_eq!(feed.start.linear_mm, at, "{}", text);
                at = feed.end.linear_mm;
                if let Shape::Bezier(curve) = &feed.shape {
                    prop_assert!(curve.weights().iter().all(|weight| *weight > 0.0), "{}", text);
                    let middle = curve.at(&feed.start.linear_mm, &feed.end.linear_mm, 0.5);
                    prop_assert!(middle.iter().all(|mm| mm.is_finite()), "{}", text);
                }
            }
        }
    }
}
