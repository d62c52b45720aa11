//! Cutter compensation: which motions may become pieces that the control offsets as one.

use crate::common;

use common::{dialect, run_with, setup};
use nc_program::Setup;
use toolpath::{Division, Motion};

/// D1 has a cutter of 5 mm radius.
fn divisions(name: &str, text: &str) -> Vec<Division> {
    let setup = Setup { radii_mm: vec![(1, 5.0)], ..setup() };
    let run = run_with(dialect(name), &setup, text);
    if let Some((line, diagnostics)) = &run.refused {
        panic!("line {line} of {text:?} is refused: {diagnostics:#?}");
    }
    let motions = run.steps.into_iter().flat_map(|step| step.motions);
    motions
        .filter_map(|motion| if let Motion::Feed(feed) = motion { Some(feed.division) } else { None })
        .collect()
}

const START: &str = "G17 G90 G54 G40 G94\nG0 X0 Y0 Z10.\n";
const ANY: Division = Division::Any;
const ONE: Division = Division::One;

/// Three radii, in an arc as long as they are on its offset.
const fn long(least_um: u32) -> Division {
    Division::Long { least_um, normal: 2 }
}

#[test]
fn what_leads_along_the_contour_may_be_long_pieces() {
    let text = "G1 X10. F100.\nG41 D1 X20.\nY100.\nG2 X30. Y110. I10. J0\nG3 X50. Y130. I0 J20.\nG1 X90.\nG40 Y150.\nX200.\n";
    let expected = [ANY, ONE, long(15_000), long(10_000), long(20_000), long(15_000), ONE, ANY];
    assert_eq!(divisions("fanuc", &format!("{START}{text}")), expected);
}

#[test]
fn codes_without_a_motion_leave_the_way_on_and_off_to_the_next() {
    let text = "G41 D1\nG1 Z5. F100.\nX20.\nY100.\nG40\nZ10.\nX50.\nX90.\n";
    // A plunge leads nowhere in the plane: the start-up and the end are still to come.
    let expected = [ONE, ONE, long(15_000), ONE, ONE, ANY];
    assert_eq!(divisions("fanuc", &format!("{START}{text}")), expected);
}

#[test]
fn where_the_radius_is_not_certain_each_is_one_block() {
    for (name, words) in
        [("fanuc", "G41 D2"), ("fanuc", "D1\nG41"), ("linuxcnc", "G41.1 D10."), ("linuxcnc", "G41")]
    {
        let text = format!("{START}{words} G1 X20. F100.\nY100.\nX90.\n");
        assert_eq!(divisions(name, &text), [ONE; 3], "{words}");
    }
    // Another D, the other side: led there block by block.
    let text = format!("{START}G41 D1 G1 X20. F100.\nY100.\nD1 X60.\nX90.\nG42 D1 X120.\nX200.\n");
    let (long, one) = (long(15_000), ONE);
    assert_eq!(divisions("fanuc", &text), [one, long, one, long, one, long]);
    // A ramp.
    let text = format!("{START}G41 D1 G1 X20. F100.\nY100. Z9.\nX90.\n");
    assert_eq!(divisions("fanuc", &text), [one, one, long]);
    // As little as a correction may make a level block climb.
    let text = format!("{START}G41 D1 G1 X20. F100.\nY100. Z9.99\nX90.\n");
    let climbing = Division::LongClimbing { least_um: 15_000, normal: 2 };
    assert_eq!(divisions("fanuc", &text), [one, climbing, long]);
    // A circle as small as the cutter.
    let text = format!("{START}G42 D1 G1 X20. F100.\nY100.\nG2 X30. Y110. I10. J0\nG2 X35. Y105. I0 J-5.\n");
    assert_eq!(divisions("fanuc", &text)[2..], [Division::Long { least_um: 30_000, normal: 2 }, ONE]);
}
