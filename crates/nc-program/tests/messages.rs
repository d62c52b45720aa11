//! What the user reads.

mod common;

use common::{dialect, message, message_with, setup};
use nc_program::Setup;

#[test]
fn arcs() {
    insta::assert_snapshot!(message("fanuc", "G0 X12.5 Y2. Z0\nN20 G2 X10. Y0 Z0 R0.1\n"), @"");
    insta::assert_snapshot!(message("linuxcnc", "G20 G0 X0 Y0 Z0\nG2 X10 R4.9\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 Z0 X50. Y40.\nG3 X51.853 Y49.000\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z0\nG18 G2 X10. Z1. I5. K.5 J0\nG2 X1. Z1.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z0\nG2 X10. I4.\n"), @"");
}

#[test]
fn positions() {
    insta::assert_snapshot!(message("fanuc", "G0 Z5.\nG1 X10. F100.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 X1. Y1. Z5.\nM6 T2\nG91 G28 X0\nG90 G1 X10. F100.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G91 G0 X1.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 X1. Y1. Z5.\n/X5.\nG1 Y2.\n"), @"");
    let with_c = Setup { has_rotary: [false, false, true], ..setup() };
    insta::assert_snapshot!(message_with(dialect("fanuc"), &with_c, "G0 X1. Y1. Z5.\n"), @"");
    insta::assert_snapshot!(message_with(dialect("fanuc"), &with_c, "G0 A5.\n"), @"");
}

#[test]
fn frames() {
    insta::assert_snapshot!(message("fanuc", "G90 G56\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G43 H3\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G43 Z1.\n"), @"");
    insta::assert_snapshot!(message("linuxcnc", "G43 Z1.\n"), @"");
}

#[test]
fn blocks() {
    insta::assert_snapshot!(message("fanuc", "G0 X1. Y2. X3.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 G90 X1. G91\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G251 X1.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G68 X1. Y1. R30.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "M98 P1000\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G1 X#1\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G1 Xnan\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 X1. R2.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "/G91\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z0\n/G1 X1.\nX0 Y0 Z0\n"), @"");
    insta::assert_snapshot!(message("linuxcnc", "X1\n"), @"");
}

#[test]
fn cycles() {
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z5.\nG81 X1. R1.\n"), @"");
    insta::assert_snapshot!(message("perspektiva", "G0 X0 Y0 Z5.\nG81 X1. R1. Z-1.\nG91 X1.\n"), @"");
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z5.\nG81 X1. R1. Z-1.\nG55 X2.\n"), @"");
    insta::assert_snapshot!(message("linuxcnc", "G0 X0 Y0 Z5\nG93 G1 X1\n"), @"");
}
