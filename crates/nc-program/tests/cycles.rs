//! Drilling cycles: which blocks drill, where, and how deep.

use crate::common;

use common::{end, hole, motions, refusal, run};
use toolpath::{CycleKind, Hole, HoleMove, PeckRetreats, Plane};

const START: &str = "G90 G0 X0. Y0. Z10.\n";

/// The holes of a program after [`START`].
fn holes(name: &str, text: &str) -> Vec<Hole> {
    motions(name, &format!("{START}{text}")).iter().skip(1).map(|motion| *hole(motion)).collect()
}

/// X, Y, R level, bottom and Z at the end of each hole, program coordinates.
fn places(name: &str, text: &str) -> Vec<[f64; 5]> {
    holes(name, text)
        .iter()
        .map(|h| {
            [h.at_r.linear_mm[0], h.at_r.linear_mm[1], h.at_r.linear_mm[2], h.bottom_mm, h.end().linear_mm[2]]
        })
        .collect()
}

#[test]
fn a_cycle_without_x_and_y_drills_where_it_stands() {
    // nc-traps: `G83 Z-10. R2. Q3.` without X/Y, then `X10.` drills.
    let holes = holes("fanuc", "G98 G83 Z-10. R2. Q3. F100.\nX10.\n");
    assert_eq!(holes.len(), 2);
    assert_eq!(holes[0].start.linear_mm, [0.0, 0.0, 10.0]);
    assert_eq!(holes[0].at_r.linear_mm, [0.0, 0.0, 2.0]);
    assert_eq!(holes[1].at_r.linear_mm, [10.0, 0.0, 2.0]);
    assert_eq!(holes[1].start.linear_mm, [0.0, 0.0, 10.0]);
    assert_eq!((holes[1].cycle.kind, holes[1].cycle.peck_mm), (CycleKind::PeckFull, Some(3.0)));
}

#[test]
fn which_blocks_drill() {
    let drills = |block: &str| {
        let text = format!("{START}G81 X1. Z-5. R2. F100.\n{block}\n");
        let run = run("fanuc", &text);
        assert!(run.refused.is_none(), "{block}: {:?}", run.refused);
        run.steps[2].motions.len()
    };
    for (block, count) in [
        ("F200.", 0),
        ("M8", 0),
        ("S1000 M3", 0),
        ("G98", 0),
        ("P100", 0),
        ("G4 P100", 0),
        ("G82 P100", 0),
        ("X5.", 1),
        ("Y5.", 1),
        ("Z-6.", 1),
        ("R3.", 1),
        ("X5. K3", 3),
        ("X5. K0", 0),
    ] {
        assert_eq!(drills(block), count, "{block}");
    }
}

#[test]
fn k0_defines_only() {
    assert_eq!(places("fanuc", "G81 X5. Z-5. R2. K0\nX7.\n"), [[7.0, 0.0, 2.0, -5.0, 10.0]]);
    assert_eq!(
        places("fanuc", "G99 G81 Z-5. R2. K0\nX7.\nY1.\n"),
        [[7.0, 0.0, 2.0, -5.0, 2.0], [7.0, 1.0, 2.0, -5.0, 2.0]]
    );
}

#[test]
fn repeats_under_g91_are_holes_of_their_own() {
    let expected: Vec<[f64; 5]> = (1..=5).map(|i| [10.0 * f64::from(i), 0.0, 2.0, -5.0, 10.0]).collect();
    assert_eq!(places("fanuc", "G81 Z-5. R2. K0\nG91 X10. K5\n"), expected);
    let run = run("fanuc", &format!("{START}G91 G99 G81 X10. Y-1. Z-7. R-8. K2\n"));
    assert_eq!(run.steps[1].context.repeats, 2);
    let ends: Vec<[f64; 3]> = run.steps[1].motions.iter().map(|m| hole(m).end().linear_mm).collect();
    assert_eq!(ends, [[10.0, -1.0, 2.0], [20.0, -2.0, 2.0]]);
    // Absolute: the same hole again.
    assert_eq!(places("fanuc", "G81 X3. Z-5. R2. K2\n"), [[3.0, 0.0, 2.0, -5.0, 10.0]; 2]);
}

#[test]
fn r_and_z_under_g91() {
    // R from the initial level, Z from R; the same in LinuxCNC's interpreter (rs274 2.9: 8 and 4, then 7 and 3).
    let text = "G91 G99 G81 X5. Z-4. R-2.\nX5.\n";
    let expected = [[5.0, 0.0, 8.0, 4.0, 8.0], [10.0, 0.0, 8.0, 4.0, 8.0]];
    for name in ["fanuc", "linuxcnc", "perspektiva"] {
        assert_eq!(places(name, text), expected, "{name}");
    }
    let deeper = format!("{text}X5. R-3.\n");
    assert_eq!(places("linuxcnc", &deeper)[2], [15.0, 0.0, 7.0, 3.0, 7.0]);
    assert_eq!(refusal("fanuc", &format!("{START}{deeper}")), (217, 4));
    assert_eq!(places("fanuc", &format!("{text}X5. R-3. Z-4.\n"))[2], [15.0, 0.0, 7.0, 3.0, 7.0]);
}

#[test]
fn a_change_to_g91_inside_a_cycle_is_read_as_the_control_reads_it() {
    let text = "G90 G99 G81 X5. Z-4. R2.\nG91 X5.\n";
    assert_eq!(places("fanuc", text)[1], [10.0, 0.0, 2.0, -4.0, 2.0]);
    // rs274: R2 counts from the initial level 10, Z-4 from there.
    assert_eq!(places("linuxcnc", text)[1], [10.0, 0.0, 12.0, 8.0, 12.0]);
    assert_eq!(refusal("perspektiva", &format!("{START}{text}")), (217, 3));
    assert_eq!(
        places("perspektiva", "G90 G99 G81 X5. Z-4. R2.\nG91 X5. R-8. Z-6.\n")[1],
        [10.0, 0.0, 2.0, -4.0, 2.0]
    );
}

#[test]
fn initial_level_is_where_the_series_began() {
    let text = "G99 G81 X1. Z-5. R2.\nX2.\nG98 X3.\nX4.\nG80 G0 Z3.\nG98 G81 X5. Z-5. R2.\n";
    let motions = motions("fanuc", &format!("{START}{text}"));
    let ends: Vec<f64> = motions
        .iter()
        .filter_map(|m| if let toolpath::Motion::Hole(h) = m { Some(h.end().linear_mm[2]) } else { None })
        .collect();
    assert_eq!(ends, [2.0, 2.0, 10.0, 10.0, 3.0]);
    // R above the initial level: no control ends below R (rs274 2.9 moves up first).
    assert_eq!(places("linuxcnc", "G98 G81 X1. Z-5. R12.\n"), [[1.0, 0.0, 12.0, -5.0, 12.0]]);
}

#[test]
fn cycles_in_the_other_planes() {
    let text = "G0 X0. Y0. Z10.\nG18 G81 X5. Z3. R-2. Y-20.\n";
    let holes = motions("fanuc", text);
    let h = hole(&holes[1]);
    assert_eq!(h.plane, Plane::Zx);
    assert_eq!((h.at_r.linear_mm, h.bottom_mm, h.initial_mm), ([5.0, -2.0, 3.0], -20.0, 0.0));
    let text = "G0 X-10. Y0. Z0.\nG19 G99 G85 Y5. Z3. R-2. X20.\nY6.\n";
    let holes = motions("fanuc", text);
    let h = hole(&holes[2]);
    // Drilling towards plus: the initial level is the lower one.
    assert_eq!((h.at_r.linear_mm, h.bottom_mm, h.initial_mm), ([-2.0, 6.0, 3.0], 20.0, -10.0));
    assert_eq!((h.cycle.kind, h.start.linear_mm), (CycleKind::Bore, [-2.0, 5.0, 3.0]));
}

/// As rs274 of LinuxCNC 2.9 moves, and as grblHAL's `mc_canned_drill`: out at feed to R, or on to G98's level.
#[test]
fn where_a_bored_hole_is_left_at_feed() {
    let fed_out_to = |dialect: &str, code: &str| {
        let text = format!("G0 X0. Y0. Z20.\nF100. G98 {code} X1. Z-5. R2. P0.1\n");
        let hole = *hole(&motions(dialect, &text)[1]);
        let retreats = PeckRetreats { clearance_mm: 0.5, chip_mm: 0.5 };
        let out = hole.moves(1, retreats).find_map(|step| match step {
            HoleMove::FeedOut { to } => Some(to.linear_mm[2]),
            _ => None,
        });
        out.unwrap()
    };
    let found = ["fanuc", "mach", "linuxcnc", "grbl"]
        .map(|dialect| ["G85", "G89"].map(|code| fed_out_to(dialect, code)));
    assert_eq!(found, [[2.0, 2.0], [2.0, 2.0], [2.0, 20.0], [20.0, 20.0]]);
}

#[test]
fn parameters_are_modal_until_the_cycle_ends() {
    let holes = holes("fanuc", "G73 X1. Z-5. R2. Q1.5 P100\nX2.\nG81 X3.\nG84 X4. Z-6.\n");
    assert_eq!(
        (holes[1].cycle.kind, holes[1].cycle.peck_mm, holes[1].cycle.dwell.is_some()),
        (CycleKind::PeckChip, Some(1.5), true)
    );
    assert_eq!((holes[2].cycle.kind, holes[2].bottom_mm), (CycleKind::Drill, -5.0));
    // P is kept, but G81 does not dwell.
    assert_eq!(holes[2].cycle.dwell, None);
    assert_eq!((holes[3].cycle.kind, holes[3].bottom_mm), (CycleKind::Synchronised, -6.0));
    // Nor do pecks by the P of another cycle, which the next one that dwells has all the same.
    let dwells = |text: &str| self::holes("fanuc", text).last().unwrap().cycle.dwell.is_some();
    assert!(!dwells("G82 X1. Z-5. R2. P100 F100.\nG83 X2. Q2.\n"));
    assert!(dwells("G82 X1. Z-5. R2. P100 F100.\nG83 X2. Q2.\nG82 X3.\n"));
    assert_eq!(refusal("fanuc", "G0 X0. Y0. Z9.\nG81 X1. Z-5. R2.\nG80\nG81 X2.\n"), (216, 4));
    assert_eq!(refusal("fanuc", "G0 X0. Y0. Z9.\nG81 X1. Z-5. R2.\nG0 X2.\nG82 X2. R2.\n"), (216, 4));
}

#[test]
fn levels_shift_with_the_frame() {
    let holes = motions("fanuc", "G55 G43 H1 G0 X0. Y0. Z10.\nG81 X1. Z-5. R2.\n");
    let h = hole(&holes[1]);
    assert_eq!((h.at_r.linear_mm, h.bottom_mm, h.initial_mm), ([101.0, 10.0, 123.0], 116.0, 131.0));
    let inch = motions("linuxcnc", "G20 G0 X0 Y0 Z1\nG99 G83 X1 Z-1 R.1 Q.1\n");
    let h = hole(&inch[1]);
    assert_eq!((h.at_r.linear_mm, h.bottom_mm, h.cycle.peck_mm), ([25.4, 0.0, 2.54], -25.4, Some(2.54)));
}

#[test]
fn motion_codes_and_g80_end_a_cycle() {
    assert_eq!(
        end("fanuc", &format!("{START}G81 X1. Z-5. R2.\nG1 X3. Z0.\n")),
        [Some(3.0), Some(0.0), Some(0.0)]
    );
    assert_eq!(end("fanuc", &format!("{START}G81 X1. Z-5. R2.\nG80 X3.\n"))[0], Some(3.0));
}

#[test]
fn what_a_cycle_refuses() {
    let begin = format!("{START}G81 X1. Z-5. R2.\n");
    let table = [
        ("G55 X2.\n", 217),
        ("G43 H1 X2.\n", 217),
        ("G18 X2.\n", 217),
        ("G20 X2.\n", 217),
        ("Q2.\n", 217),
        ("X2. K2 L2\n", 217),
        ("X2. K1.5\n", 211),
        ("X2. K-1\n", 211),
        ("X2. K10000\n", 217),
        ("G83 X2. Q0\n", 217),
        ("G28 Z0\n", 226),
        ("G31 Z0\n", 226),
        ("G53 Z0\n", 226),
    ];
    for (block, code) in table {
        assert_eq!(refusal("fanuc", &format!("{begin}{block}")), (code, 3), "{block}");
    }
    let table = [
        ("G81 X1. Z-5.\n", 216, 1),
        ("G81 X1. R2.\n", 216, 1),
        ("G81 X1. Y1. R2. Z-5.\n", 213, 1),
        ("G0 X0. Y0.\nG81 X1. Y1. R2. Z-5.\n", 213, 2),
        ("G0 X0. Y0.\nG91 G81 X1. Y1. R2. Z-5.\n", 213, 2),
        ("G0 X0. Y0. Z0.\nG91 G81 X1. Z-5.\n", 216, 2),
    ];
    for (text, code, line) in table {
        assert_eq!(refusal("fanuc", text), (code, line), "{text}");
    }
}

/// LinuxCNC starts in G99 and keeps G98 between programs: where the levels differ the program has to say one.
#[test]
fn a_return_level_that_nobody_says_is_asked_where_it_matters() {
    assert_eq!(refusal("linuxcnc", "G21 G0 X0 Y0 Z10\nG81 X10 Z-5 R2 F100\n"), (216, 2));
    for said in ["G21 G99 G0 X0 Y0 Z10\nG81 X10 Z-5 R2 F100\n", "G21 G0 X0 Y0 Z2\nG81 X10 Z-5 R2 F100\n"] {
        assert_eq!(hole(&motions("linuxcnc", said)[1]).end().linear_mm[2], 2.0, "{said}");
    }
}
