//! Arcs from blocks: planes, centres, radii, helices.

use crate::common;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use common::{centre, feed, motions, refusal, run, sweep};
use toolpath::{Plane, Shape};

fn arc(name: &str, text: &str) -> toolpath::Motion {
    *motions(name, text).last().expect("an arc")
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9, "{a} is not {b}");
}

const START: &str = "G0 X10. Y0. Z5.\n";

#[test]
fn missing_centre_words_are_zero() {
    let motion = arc("fanuc", &format!("{START}G3 X0 Y10. I-10. F100.\n"));
    assert_eq!(centre(&motion), [0.0, 0.0]);
    near(sweep(&motion), FRAC_PI_2);
    // A modal arc block with one word of each.
    let motion = arc("fanuc", &format!("{START}G3 X0 Y10. I-10. F100.\nX10. J-10. Y0\n"));
    near(sweep(&motion), 1.5 * PI);
    let motion = arc("fanuc", &format!("{START}G2 X20. I5.\nX60. I20.\n"));
    assert_eq!((centre(&motion), feed(&motion).end.linear_mm), ([40.0, 0.0], [60.0, 0.0, 5.0]));
}

#[test]
fn full_circles_and_helices() {
    for block in ["G2 I-5.25\n", "G2 X10. Y0 I-5.25\n", "G91 G2 X0 Y0 I-5.25\n"] {
        let motion = arc("fanuc", &format!("{START}{block}"));
        near(sweep(&motion), -TAU);
        assert_eq!(centre(&motion), [4.75, 0.0]);
    }
    let motion = arc("fanuc", &format!("{START}G3 Z-1. I-10.\n"));
    near(sweep(&motion), TAU);
    assert_eq!(feed(&motion).end.linear_mm, [10.0, 0.0, -1.0]);
    let motion = arc("fanuc", &format!("{START}G3 X0 Y10. Z0 R10.\n"));
    assert_eq!(feed(&motion).end.linear_mm, [0.0, 10.0, 0.0]);
}

#[test]
fn planes_have_their_own_order_and_sense() {
    // G18: Z towards X is against the clock. From Z+ to X+ by G3 is a quarter.
    let motion = arc("fanuc", "G0 X0 Y0 Z10.\nG18 G3 X10. Z0 K-10.\n");
    assert_eq!(centre(&motion), [0.0, 0.0]);
    near(sweep(&motion), FRAC_PI_2);
    let Shape::Arc(shape) = feed(&motion).shape else { unreachable!("an arc") };
    assert_eq!(shape.plane, Plane::Zx);
    // G19: Y towards Z.
    let motion = arc("fanuc", "G0 X0 Y10. Z0\nG19 G2 Y0 Z10. J-10.\n");
    near(sweep(&motion), -1.5 * PI);
    let motion = arc("fanuc", "G0 X0 Y10. Z0\nG19 G3 Y0 Z10. R10. X7.\n");
    near(sweep(&motion), FRAC_PI_2);
    assert_eq!(feed(&motion).end.linear_mm, [7.0, 0.0, 10.0]);
}

#[test]
fn absolute_centres() {
    let text = "G55 G90.1\nG0 X10 Y0 Z0\nG3 X0 Y10 I0 J0\n";
    let motion = arc("linuxcnc", text);
    // Program zero of G55 is X100 Y10.
    assert_eq!(centre(&motion), [100.0, 10.0]);
    near(sweep(&motion), FRAC_PI_2);
    assert!(run("linuxcnc", text).steps[2].context.arc_centres_absolute);
    assert_eq!(refusal("linuxcnc", "G90.1 G0 X10 Y0 Z0\nG3 X0 Y10 I0\n"), (206, 2));
    near(sweep(&arc("linuxcnc", "G90.1 G0 X10 Y0 Z0\nG91.1 G91 G3 X-10 Y10 I-10\n")), FRAC_PI_2);
}

#[test]
fn inch_arcs() {
    let motion = arc("linuxcnc", "G20 G0 X1 Y0 Z0\nG3 X0 Y1 I-1\n");
    assert_eq!(centre(&motion), [0.0, 0.0]);
    let motion = arc("linuxcnc", "G20 G0 X1 Y0 Z0\nG3 X0 Y1 R1\n");
    near(centre(&motion)[0], 0.0);
}

#[test]
fn radius_words() {
    near(sweep(&arc("fanuc", &format!("{START}G3 X0 Y10. R10.\n"))), FRAC_PI_2);
    near(sweep(&arc("fanuc", &format!("{START}G3 X0 Y10. R-10.\n"))), 1.5 * PI);
    near(sweep(&arc("fanuc", &format!("{START}G2 X-10. R10.\n"))), -PI);
    // Half the chord is 10; Fanuc allows 0.02 mm, LinuxCNC 0.0279 where radii differ (and less here: it says so itself).
    near(sweep(&arc("fanuc", &format!("{START}G2 X-10. R9.985\n"))), -PI);
    assert_eq!(refusal("linuxcnc", &format!("{START}G2 X-10. R9.97\n")), (203, 2));
    let steps = run("fanuc", &format!("{START}G3 X0 Y10. R10.\nX10. Y0 I-10. J-10.\n")).steps;
    assert_eq!(steps[1..].iter().map(|s| s.context.arc_by_radius).collect::<Vec<_>>(), [true]);
}

#[test]
fn what_an_arc_refuses() {
    let table = [
        ("G3 X0 Y10.\n", 204),
        ("G3 Z1.\n", 204),
        ("G3 X0 Y10. I-10. R10.\n", 206),
        ("G3 X0 Y10. I-10. K1.\n", 206),
        ("G3 X0 Y10. K1.\n", 206),
        ("G3 I0 J0\n", 206),
        ("G3 R5.\n", 206),
        ("G3 X10. Y0 R5.\n", 206),
        ("G3 I-10. P2\n", 206),
        ("G3 X0 Y10. I-10.1\n", 205),
        ("G3 X0 Y10. R5.\n", 203),
        ("G3 X0 Y10. R0\n", 203),
    ];
    for (block, code) in table {
        assert_eq!(refusal("fanuc", &format!("{START}{block}")), (code, 2), "{block}");
    }
    assert_eq!(refusal("fanuc", "G0 X10. Y0\nG3 X0 Y10. I-10.\n"), (213, 2));
    // K0 beside I and J is how some posts write nothing; P1 is one turn.
    near(sweep(&arc("fanuc", &format!("{START}G3 X0 Y10. I-10. J0 K0\n"))), FRAC_PI_2);
    near(sweep(&arc("linuxcnc", &format!("{START}G3 X0 Y10 I-10 P1\n"))), FRAC_PI_2);
}
