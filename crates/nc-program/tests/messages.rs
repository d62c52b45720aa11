//! What the user reads.

use crate::common;

use common::{dialect, message, message_with, setup};
use nc_program::Setup;

#[test]
fn arcs() {
    insta::assert_snapshot!(message("fanuc", "G0 X12.5 Y2. Z0\nN20 G2 X10. Y0 Z0 R0.1\n"), @r#"
    error[VP0203]: arc radius is smaller than half the chord
      2: `R0.1` R0.1 mm, chord is 3.2016 mm
      help: use I/J centre form, or R of at least 1.6008
    "#);
    insta::assert_snapshot!(message("linuxcnc", "G20 G0 X0 Y0 Z0\nG2 X10 R4.9\n"), @r#"
    error[VP0203]: arc radius is smaller than half the chord
      2: `R4.9` R4.9 inch, chord is 10 inch
      help: use I/J centre form, or R of at least 5
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 Z0 X50. Y40.\nG3 X51.853 Y49.000\n"), @r#"
    error[VP0204]: arc without centre
      2: `X51.853 Y49.000` neither I/J nor R in this block, and neither is modal
      help: post the program again so that each arc block has its I and J (some posts drop unchanged ones), or add R
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z0\nG18 G2 X10. Z1. I5. K.5 J0\nG2 X1. Z1.\n"), @r#"
    error[VP0204]: arc without centre
      3: `X1. Z1.` neither I/K nor R in this block, and neither is modal
      help: post the program again so that each arc block has its I and K (some posts drop unchanged ones), or add R
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z0\nG2 X10. I4.\n"), @r#"
    error[VP0205]: the ends of the arc lie at different distances from its centre
      2: `I4.` radius 4 at the start, 6 mm at the end, 0.02 allowed
      help: correct the end or the centre (I and J are read as measured from the start (G91.1)); where the control takes more, say so with `arc_tolerance_mm` under `[program]` in the profile
    "#);
}

#[test]
fn positions() {
    insta::assert_snapshot!(message("fanuc", "G0 Z5.\nG1 X10. F100.\n"), @r#"
    error[VP0213]: the feed move starts from an unknown position
      2: `X10.` X, Y not known since the start of the program
      help: program a rapid `G90 G0 X… Y…` before this block
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X1. Y1. Z5.\nM6 T2\nG91 G28 X0\nG90 G1 X10. F100.\n"), @r#"
    error[VP0213]: the feed move starts from an unknown position
      4: `X10.` X not known since the reference return in line 3; Y, Z not known since the tool change M6 in line 2
      help: program a rapid `G90 G0 X… Y… Z…` before this block, or say where a tool change leaves the axes: `tool_change = { keeps = "XYZ" }` or a position, under `[program]` in the profile
    "#);
    insta::assert_snapshot!(message("fanuc", "G91 G0 X1.\n"), @r#"
    error[VP0213]: an increment from an unknown position
      1: `X1.` X not known since the start of the program
      help: program a rapid `G90 G0 X…` before this block
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X1. Y1. Z5.\n/X5.\nG1 Y2.\n"), @r#"
    error[VP0213]: the feed move starts from an unknown position
      3: `Y2.` X, Y, Z not known since line 2, which moves or not, depending on the block delete switch
      help: program a rapid `G90 G0 X… Y… Z…` before this block
    "#);
    let with_c = Setup { has_rotary: [false, false, true], rotary_matters: true, ..setup() };
    insta::assert_snapshot!(message_with(dialect("fanuc"), &with_c, "G0 X1. Y1. Z5.\n"), @r#"
    error[VP0213]: a motion of linear axes while a rotary axis is unknown
      1: `X1. Y1. Z5.` C not known since the start of the program
      help: program a rapid `G90 G0 C…` before this block, or say where it stands then, as in `--start-at C=0`; for all programs `rotary_start = { C = 0 }` under `[program]` in the profile
    "#);
    insta::assert_snapshot!(message_with(dialect("fanuc"), &with_c, "G0 A5.\n"), @r#"
    error[VP0219]: the machine has no axis A
      1: `A5.` rotary axes of the profile's chain: C
      help: name A in `chain` of the profile, or remove the word
    "#);
}

#[test]
fn frames() {
    insta::assert_snapshot!(message("fanuc", "G90 G56\n"), @r#"
    error[VP0214]: work offset G56 is not given
      1: `G56` given by no profile, file or option
      help: `--work-offset G56=X,Y,Z` with the machine coordinates of the program's zero, or `G56 = [X, Y, Z]` under `[work_offsets_mm]` in the profile
    "#);
    insta::assert_snapshot!(message("fanuc", "G43 H3\n"), @r#"
    error[VP0215]: tool length H3 is not given
      1: `H3` given by no profile, file or option
      help: `--tool H3=120` for a length of 120 mm, or `lengths_mm = { H3 = 120.0 }` under `[tool]` in the profile
    "#);
    insta::assert_snapshot!(message("fanuc", "G43 Z1.\n"), @r#"
    error[VP0215]: tool length without H
      1: `G43` an H word was expected in this block
      help: write the number of the length, e.g. H1; H0 is no length
    "#);
    insta::assert_snapshot!(message("linuxcnc", "G43 Z1.\n"), @r#"
    error[VP0215]: the length of the loaded tool, and no tool was loaded before
      1: `G43` takes the tool in the spindle: which one?
      help: program T and M6 before it, or H in this block
    "#);
}

#[test]
fn blocks() {
    insta::assert_snapshot!(message("fanuc", "G0 X1. Y2. X3.\n"), @r#"
    error[VP0210]: X stands twice in this block: X1. and X3.
      1: `X3.` X1. stands before it
      help: remove one of the two
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 G90 X1. G91\n"), @r#"
    error[VP0209]: G90 and G91 stand in one block and exclude each other
      1: `G91` G90 stands before it
      help: write them in two blocks, or remove one
    "#);
    insta::assert_snapshot!(message("fanuc", "G251 X1.\n"), @r#"
    error[VP0207]: G251 is not in the table of dialect fanuc
      1: `G251` it may move an axis or the frame
      help: if it does neither, add a row for it to a copy of the grammar and pass that with `--dialect my.toml`
    "#);
    insta::assert_snapshot!(message("fanuc", "G68.2 X1. Y1. Z1. I0 J0 K30.\n"), @r#"
    error[VP0231]: G68.2 is refused: it tilts the working plane
      1: `G68.2` with which centres the control computes is not said
      help: declare what the control computes with as `[kinematics]` in the profile, or post without tilted planes
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z0\nG68 X0 Y0 R30.\nG1 X5. F9\n"), @r#"
    error[VP0227]: the first motion after a rotation, scaling or mirror was switched must be absolute and whole
      3: `X5.` X, Y were expected, in G90: controls differ in where they start otherwise
      help: write X, Y in this block, in G90
    "#);
    insta::assert_snapshot!(message("fanuc", "M198 P1000\n"), @r#"
    error[VP0208]: M198 is refused: calls a subprogram from another store
      1: `M198` not understood
      help: let the CAM write the moves of the subprogram in its place
    "#);
    insta::assert_snapshot!(message("fanuc", "G1 X#1\n"), @r#"
    error[VP0202]: the value of X is known only while the program runs
      1: `X#1` a plain number was expected
      help: post the program without variables and flow; values must be static
    "#);
    insta::assert_snapshot!(message("fanuc", "G1 Xnan\n"), @r#"
    error[VP0101]: `Xnan` is not a number a control reads
      1: `Xnan` expected a sign, digits and one decimal point
      help: write it like `X-12.5`: no exponent, one sign, a point and not a comma
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X1. R2.\n"), @r#"
    error[VP0225]: R has no meaning here
      1: `R2.` this block is no arc
      help: write G2 or G3 for an arc, or remove the word; corner roundings must be posted as arcs
    "#);
    insta::assert_snapshot!(message("fanuc", "/G91\nX5.\n"), @r#"
    error[VP0222]: after line 1 either G91 or G90 is in force, depending on the block delete switch
      2: `X5.` G91 where the blocks with `/` are executed, G90 where they are skipped
      help: write the code in a block without `/`, or take it back in a block with `/`, so that both ways lead to one state
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z0\n/G1 X1.\nX0 Y0 Z0\n"), @r#"
    error[VP0222]: the motion code in force depends on the block delete switch
      3: `X0 Y0 Z0` line 2 changes the motion code and may be skipped
      help: write the motion code in this block
    "#);
    insta::assert_snapshot!(message("linuxcnc", "X1\n"), @r#"
    error[VP0212]: X without a motion code
      1: `X1` no G0, G1, G2, G3 or cycle is in force
      help: write the motion code in this block
    "#);
}

#[test]
fn cycles() {
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z5.\nG81 X1. R1.\n"), @r#"
    error[VP0216]: the drilling cycle has no Z
      2: `X1. R1.` Z was expected here or in an earlier block of this cycle
      help: write Z on the block that starts the cycle
    "#);
    insta::assert_snapshot!(message("perspektiva", "G0 X0 Y0 Z5.\nG81 X1. R1. Z-1.\nG91 X1.\n"), @r#"
    error[VP0217]: Z counts from an earlier R, or was written under another of G90 and G91: controls differ in what it means now
      3: `X1.` R and Z are taken from an earlier block
      help: write R and Z again in this block
    "#);
    insta::assert_snapshot!(message("fanuc", "G0 X0 Y0 Z5.\nG81 X1. R1. Z-1.\nG55 X2.\n"), @r#"
    error[VP0217]: the work offset changes while a drilling cycle is in force
      3: `G55` a cycle is running here
      help: cancel the cycle with G80 before, and write it again with R and Z afterwards
    "#);
    insta::assert_snapshot!(message("linuxcnc", "G0 X0 Y0 Z5\nG93 G1 X1\n"), @r#"
    error[VP0218]: a feed motion under G93 without F
      2: `X1` F was expected in this block
      help: G93 needs F on each feed block; or program G94
    "#);
}
