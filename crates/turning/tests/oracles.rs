//! Exact formulas, to 1e-6 µm.

#![allow(clippy::disallowed_methods, reason = "the formulas are the standard library's on purpose")]

use std::f64::consts::{FRAC_PI_2, PI};

use machine_model::{
    AxisTables, Chain, Command, Description, Engine, Interpolation, LinearAxis, Move, PathModel, Range,
    RigidBody, RotaryAxis, Squareness, Table, Vector,
};
use turning::{
    Bending, Clamping, Cylinder, ErrorMotion, Force, Harmonic, Lathe, Section, Spindle, Station, Tailstock,
    Tip, Workpiece,
};

/// 1e-6 µm.
const NEAR_MM: f64 = 1e-9;

fn carriage(squareness: Squareness, straight_x: Option<Table>) -> RigidBody {
    let axis = || LinearAxis::perfect(Range { low: -10.0, high: 400.0 });
    let mut linear = [axis(), axis(), axis()];
    linear[1].travel_mm = Range { low: -1.0, high: 1.0 };
    linear[2].errors = AxisTables::new(&[straight_x, None, None, None, None, None]);
    RigidBody::new(Description {
        chain: Chain::parse("[w b Z X Y t]").expect("a machine"),
        linear,
        rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
        squareness,
    })
    .expect("a machine")
}

fn lathe(spindle: Spindle, bending: Bending, tip: Tip) -> Lathe {
    Lathe::new(Box::new(carriage(Squareness::default(), None)), spindle, bending, tip, &[])
}

fn spindle(synchronous: ErrorMotion) -> Spindle {
    Spindle { synchronous, ..Spindle::default() }
}

fn at(x: f64, z: f64) -> Command {
    Command { linear_mm: Vector::new(x, 0.0, z), ..Default::default() }
}

fn wave(order: u32, amplitude: f64, phase_rad: f64) -> Vec<Harmonic> {
    vec![Harmonic { order, amplitude, phase_rad }]
}

#[test]
fn a_tailstock_aside_turns_a_cone() {
    let tailstock = Some(Tailstock { at_mm: 300.0, offset_mm: [0.025, 0.0] });
    let lathe = lathe(Spindle { tailstock, ..Spindle::default() }, Bending::default(), Tip::default());
    // Distance from the line through (0, 0) and (−0.025, 300).
    for z in [0.0, 100.0, 300.0] {
        let exact = (20.0 * 300.0 + 0.025 * z) / (300.0f64 * 300.0 + 0.025 * 0.025).sqrt();
        assert!((lathe.turned_mm(&at(20.0, z))[0] - exact).abs() < NEAR_MM);
    }
    let cone = 2.0 * (lathe.turned_mm(&at(20.0, 300.0))[0] - 20.0);
    assert!((cone - 0.049_999_86).abs() < 5e-9, "{cone}");
}

#[test]
fn a_station_of_the_turret_shifts_its_own_tool_alone() {
    let [own, other] = [Vector::new(-12.5, 0.03, -41.25), Vector::new(-12.5, 0.0, -41.25)];
    let station = Station { tool_mm: own, shift_mm: [0.008, -0.005] };
    let lathe = lathe(Spindle::default(), Bending::default(), Tip::default()).with_stations(vec![station]);
    let turned = |tool_mm: Vector| lathe.turned_mm(&Command { tool_mm, ..at(32.5, 141.25) });
    let [r, z] = turned(own);
    assert!((r - (20.008f64 * 20.008 + 0.03 * 0.03).sqrt()).abs() < NEAR_MM && (z - 99.995).abs() < NEAR_MM);
    let [r, z] = turned(other);
    assert!((r - 20.0).abs() < NEAR_MM && (z - 100.0).abs() < NEAR_MM);
}

#[test]
fn offsets_in_both_directions_and_at_both_ends() {
    let tailstock = Some(Tailstock { at_mm: 250.0, offset_mm: [-0.015, 0.03] });
    let headstock_mm = [0.010, -0.02];
    let lathe =
        lathe(Spindle { headstock_mm, tailstock, ..Spindle::default() }, Bending::default(), Tip::default());
    let (chuck, end) = (Vector::new(-0.010, 0.02, 0.0), Vector::new(0.015, -0.03, 250.0));
    let along = (end - chuck).normalize();
    for (x, z) in [(20.0, 0.0), (5.0, 125.0), (33.0, 250.0)] {
        let way = Vector::new(x, 0.0, z) - chuck;
        let [r, axial] = lathe.turned_mm(&at(x, z));
        assert!((r - way.cross(&along).norm()).abs() < NEAR_MM);
        assert!((axial - way.dot(&along)).abs() < NEAR_MM);
    }
}

#[test]
fn a_tilted_spindle_turns_a_cone_and_dishes_a_face() {
    let lathe =
        lathe(Spindle { tilt_rad: [0.0, 1e-4], ..Spindle::default() }, Bending::default(), Tip::default());
    let (sin, cos) = 1e-4f64.atan().sin_cos();
    let [r, z] = lathe.turned_mm(&at(30.0, 200.0));
    // The axis leans to +X: the radius shrinks with Z.
    assert!((r - (30.0 * cos - 200.0 * sin)).abs() < NEAR_MM);
    assert!((z - (200.0 * cos + 30.0 * sin)).abs() < NEAR_MM);
    // EA0S leads it to −Y.
    let leaning = self::lathe(
        Spindle { tilt_rad: [1e-4, 0.0], ..Spindle::default() },
        Bending::default(),
        Tip::default(),
    );
    assert!((leaning.height_mm(&at(30.0, 200.0)) - 200.0 * sin).abs() < NEAR_MM);
}

#[test]
fn a_shaft_bends_away() {
    let bar = |clamping| Workpiece {
        diameters_mm: vec![[0.0, 40.0], [300.0, 40.0]],
        youngs_modulus_n_mm2: 210_000.0,
        clamping,
        steady_rests_mm: Vec::new(),
    };
    for (clamping, z, exact) in [
        (Clamping::Chuck, 300.0, 400.0 * 2.7e7 / 3.0),
        (Clamping::Centres { at_mm: 300.0 }, 150.0, 400.0 * 2.7e7 / 48.0),
        (Clamping::ChuckAndTailstock { at_mm: 300.0 }, 150.0, 400.0 * 7.0 * 2.7e7 / 768.0),
    ] {
        let bending = Bending::new(&bar(clamping), Force::Radial { newton: 400.0 }).unwrap();
        let ei = 210_000.0 * PI * 40.0f64.powi(4) / 64.0;
        let gained = lathe(Spindle::default(), bending, Tip::default()).turned_mm(&at(20.0, z))[0] - 20.0;
        assert!((gained - exact / ei).abs() < NEAR_MM, "{clamping:?}");
    }
}

#[test]
fn a_tip_off_centre_turns_a_larger_radius() {
    let lathe = lathe(Spindle::default(), Bending::default(), Tip { height_mm: 0.1, ..Tip::default() });
    let gained = lathe.turned_mm(&at(5.0, 10.0))[0] - 5.0;
    assert!((gained - (25.01f64.sqrt() - 5.0)).abs() < NEAR_MM);
    assert!((1e3 * gained - 0.9999).abs() < 1e-4);
    // A tool that is turned about Z and Y carries its tip with it.
    let turned = self::lathe(
        Spindle::default(),
        Bending::default(),
        Tip { gamma_rad: 0.01, omega_rad: -0.02, ..Tip::default() },
    );
    let command = Command { tool_mm: Vector::new(-50.0, 0.0, 10.0), ..at(90.0, 100.0) };
    let ((sg, cg), (so, co)) = (0.01f64.sin_cos(), (-0.02f64).sin_cos());
    let (along, z) = (-50.0 * co + 10.0 * so, 50.0 * so + 10.0 * co);
    let [r, axial] = turned.turned_mm(&command);
    assert!((r - (90.0 + along * cg).hypot(along * sg)).abs() < NEAR_MM);
    assert!((axial - (100.0 + z)).abs() < NEAR_MM);
}

#[test]
fn an_eccentric_spindle_turns_a_displaced_circle() {
    let motion =
        ErrorMotion { x: wave(1, 0.02, 0.0), y: wave(1, 0.02, -FRAC_PI_2), ..ErrorMotion::default() };
    let lathe = lathe(spindle(motion), Bending::default(), Tip::default());
    for angles in [90, 720] {
        let section = lathe.section(&at(20.0, 50.0), angles);
        for circle in [section.least_squares(), section.minimum_zone()] {
            assert!(circle.roundness_mm < NEAR_MM, "{circle:?}");
            assert!((circle.radius_mm - 20.0).abs() < NEAR_MM);
            assert!(
                (circle.centre_mm[0] + 0.02).abs() < NEAR_MM && circle.centre_mm[1].abs() < NEAR_MM,
                "{circle:?}"
            );
        }
    }
}

#[test]
fn two_waves_a_turn_are_an_oval() {
    let a = 0.003;
    let lathe = lathe(
        spindle(ErrorMotion { x: wave(2, a, 0.0), ..ErrorMotion::default() }),
        Bending::default(),
        Tip::default(),
    );
    let section = lathe.section(&at(20.0, 50.0), 720);
    for circle in [section.least_squares(), section.minimum_zone()] {
        assert!((circle.roundness_mm - 2.0 * a).abs() < NEAR_MM, "{circle:?}");
        assert!((circle.radius_mm - 20.0).abs() < NEAR_MM);
    }
    let waves = section.waves(8);
    assert!(
        (waves[0].amplitude_mm - a).abs() < NEAR_MM && waves[1..].iter().all(|w| w.amplitude_mm < NEAR_MM)
    );
}

#[test]
fn the_minimum_zone_is_the_least_of_all_centres() {
    let motion = ErrorMotion {
        x: wave(3, 0.004, 0.3),
        y: wave(1, 0.01, 0.0),
        a: wave(2, 1e-5, 0.4),
        ..ErrorMotion::default()
    };
    let section = lathe(spindle(motion), Bending::default(), Tip::default()).section(&at(12.0, 80.0), 360);
    let zone = section.minimum_zone();
    let width = |x: f64, y: f64| {
        let far = section.points_mm().iter().map(|p| (p.x - x).hypot(p.y - y));
        far.clone().fold(0.0, f64::max) - far.fold(f64::INFINITY, f64::min)
    };
    let [x, y] = zone.centre_mm;
    assert!((width(x, y) - zone.roundness_mm).abs() < 1e-12);
    assert!(zone.roundness_mm <= section.least_squares().roundness_mm);
    for k in 0..64 {
        let angle = f64::from(k) * PI / 32.0;
        for by in [1e-6, 1e-4, 1e-3] {
            assert!(width(x + by * angle.cos(), y + by * angle.sin()) >= zone.roundness_mm - 1e-12);
        }
    }
}

#[test]
fn a_cone_is_no_cylinder_and_a_tilted_one_is() {
    let tailstock = Some(Tailstock { at_mm: 300.0, offset_mm: [0.025, 0.0] });
    let cone = lathe(Spindle { tailstock, ..Spindle::default() }, Bending::default(), Tip::default());
    let sections: Vec<Section> =
        [0.0, 50.0, 100.0, 200.0, 300.0].map(|z| cone.section(&at(20.0, z), 72)).to_vec();
    let radii = [0.0, 300.0].map(|z| cone.turned_mm(&at(20.0, z))[0]);
    for found in [Cylinder::least_squares(&sections), Cylinder::minimum_zone(&sections)] {
        assert!((found.cylindricity_mm - (radii[1] - radii[0])).abs() < NEAR_MM, "{found:?}");
    }
    let middle = 0.5 * (radii[0] + radii[1]);
    assert!((Cylinder::minimum_zone(&sections).radius_mm - middle).abs() < NEAR_MM);
    // A cylinder about a tilted line.
    let (sin, cos) = 0.001f64.sin_cos();
    let tilted = [0.0, 40.0, 90.0].map(|z: f64| {
        let ring = (0..48).map(|k| {
            let (s, c) = (f64::from(k) * PI / 24.0).sin_cos();
            Vector::new(15.0 * c * cos + z * sin + 0.1, 15.0 * s, z * cos - 15.0 * c * sin)
        });
        Section::new(ring.collect())
    });
    for found in [Cylinder::least_squares(&tilted), Cylinder::minimum_zone(&tilted)] {
        assert!(found.cylindricity_mm < NEAR_MM && (found.radius_mm - 15.0).abs() < NEAR_MM, "{found:?}");
    }
}

/// Sections that are all alike, and outlines in which many points are equally far: the choice of the rows that decide is
/// not unique there.
#[test]
fn the_minimum_zone_of_a_cylinder_is_no_wider_than_least_squares() {
    let a = 0.0008;
    for (taper, angles, count) in
        [(0.0, 360, 18), (0.0, 72, 5), (1e-5, 360, 18), (-4e-5, 90, 3), (2e-6, 16, 40)]
    {
        let spindle = spindle(ErrorMotion { x: wave(2, a, 0.0), ..ErrorMotion::default() });
        let spindle = Spindle { tilt_rad: [0.0, taper], ..spindle };
        let lathe = lathe(spindle, Bending::default(), Tip::default());
        let sections: Vec<Section> =
            (0..count).map(|k| lathe.section(&at(30.0, 156.0 + f64::from(k)), angles)).collect();
        let (mean, zone) = (Cylinder::least_squares(&sections), Cylinder::minimum_zone(&sections));
        assert!(zone.cylindricity_mm <= mean.cylindricity_mm + 1e-12, "{taper} {angles}: {mean:?} {zone:?}");
        assert!(zone.cylindricity_mm > a && (zone.radius_mm - 30.0).abs() < 0.01, "{zone:?}");
        // Two waves at every section: no axis makes the zone of it narrower than that of one.
        let round = sections[0].minimum_zone().roundness_mm;
        assert!(
            zone.cylindricity_mm >= round - 1e-9 && zone.cylindricity_mm < round + 0.5e-3,
            "{round} {zone:?}"
        );
    }
}

/// Everything at once.
fn crooked() -> Lathe {
    let table = Table::new(
        vec![-10.0, 40.0, 120.0, 260.0, 400.0],
        vec![0.0, 0.012, -0.004, 0.02, 0.0],
        Interpolation::Monotone,
    );
    let bar = Workpiece {
        diameters_mm: vec![[0.0, 40.0], [120.0, 40.0], [120.0, 32.0], [300.0, 30.0]],
        youngs_modulus_n_mm2: 210_000.0,
        clamping: Clamping::ChuckAndTailstock { at_mm: 295.0 },
        steady_rests_mm: Vec::new(),
    };
    let spindle = Spindle {
        tilt_rad: [3e-5, -6e-5],
        headstock_mm: [0.003, 0.0],
        tailstock: Some(Tailstock { at_mm: 295.0, offset_mm: [0.025, 0.04] }),
        shift_mm: Vector::new(0.004, -0.01, 0.02),
        ..Spindle::default()
    };
    Lathe::new(
        Box::new(carriage(Squareness { eb0z_rad: -8e-5, ..Squareness::default() }, table.ok())),
        spindle,
        Bending::new(&bar, Force::Radial { newton: 400.0 }).expect("a bar"),
        Tip { height_mm: 0.05, ..Tip::default() },
        &[],
    )
}

#[test]
fn what_is_solved_is_turned() {
    let lathe = crooked();
    for (x, z) in [(20.0, 5.0), (20.0, 150.0), (16.0, 290.0), (2.0, 100.0)] {
        let told = lathe.solve(&at(x, z)).unwrap();
        assert_eq!(told.linear_mm.y, 0.0);
        let [r, axial] = lathe.turned_mm(&Command { linear_mm: told.linear_mm, ..at(0.0, 0.0) });
        assert!((r - x).abs() < NEAR_MM && (axial - z).abs() < NEAR_MM, "{x} {z}: {r} {axial}");
    }
    // The face ends at X 0.
    assert!(lathe.near_axis_mm() > 0.1 && lathe.near_axis_mm() < 1.0, "{}", lathe.near_axis_mm());
}

#[test]
fn the_error_stays_within_the_bound_of_its_chord() {
    let lathe = crooked();
    let steps = 400;
    for (from, to) in [
        ((20.0, 5.0), (20.0, 290.0)),
        ((20.0, 100.0), (0.0, 100.0)),
        ((1.0, 50.0), (-1.6, 50.0)),
        ((30.0, 250.0), (10.0, 200.0)),
        ((0.6, 10.0), (0.3, 11.0)),
        ((20.0, 290.0), (20.0, 310.0)),
    ] {
        let on = |s: f64| at(from.0 + s * (to.0 - from.0), from.1 + s * (to.1 - from.1));
        let range = |a: f64, b: f64| Range { low: a.min(b), high: a.max(b) };
        let stretch = Move {
            range_mm: [range(from.0, to.0), range(0.0, 0.0), range(from.1, to.1)],
            speed_mm: [(to.0 - from.0).abs(), 0.0, (to.1 - from.1).abs()],
            acceleration_mm: [0.0; 3],
            passes: 1,
            state: at(0.0, 0.0),
            turn: None,
        };
        let bound = lathe.chord_bound_mm(&stretch);
        let (first, last) = (lathe.error_mm(&on(0.0)), lathe.error_mm(&on(1.0)));
        let away = (0..=steps).map(|k| {
            let s = f64::from(k) / f64::from(steps);
            (lathe.error_mm(&on(s)) - (first * (1.0 - s) + last * s)).norm()
        });
        let largest = away.fold(0.0, f64::max);
        assert!(largest <= bound + 1e-12, "{from:?} {to:?}: {largest} beyond {bound}");
        assert!(bound < 1.0, "{from:?} {to:?}: {bound}");
    }
}

#[test]
fn the_error_stays_within_the_bound_on_an_arc() {
    let lathe = crooked();
    // A quarter about (20, 50) from (20, 40) to (10, 50): q = centre + 10·(−sin, −cos).
    let on = |s: f64| {
        let (sin, cos) = (s * FRAC_PI_2).sin_cos();
        at(20.0 - 10.0 * sin, 50.0 - 10.0 * cos)
    };
    let (speed, acceleration) = (10.0 * FRAC_PI_2, 10.0 * FRAC_PI_2 * FRAC_PI_2);
    let stretch = Move {
        range_mm: [
            Range { low: 10.0, high: 20.0 },
            Range { low: 0.0, high: 0.0 },
            Range { low: 40.0, high: 50.0 },
        ],
        speed_mm: [speed, 0.0, speed],
        acceleration_mm: [acceleration, 0.0, acceleration],
        passes: 2,
        state: at(0.0, 0.0),
        turn: None,
    };
    let bound = lathe.chord_bound_mm(&stretch);
    let (first, last) = (lathe.error_mm(&on(0.0)), lathe.error_mm(&on(1.0)));
    for k in 0..=200 {
        let s = f64::from(k) / 200.0;
        let away = (lathe.error_mm(&on(s)) - (first * (1.0 - s) + last * s)).norm();
        assert!(away <= bound, "{s}: {away} beyond {bound}");
    }
}

/// Spirin's printed matrices that are no rotations, and the right ones.
#[test]
fn spirins_printed_matrices() {
    use nalgebra::Matrix3;
    let (phi, gamma, omega) = (0.7f64, 0.2f64, 0.3f64);
    let ((sp, cp), (sg, cg), (so, co)) = (phi.sin_cos(), gamma.sin_cos(), omega.sin_cos());
    let away = |m: Matrix3<f64>| (m.transpose() * m - Matrix3::identity()).norm();
    let turn = Matrix3::new(cp, sp, 0.0, -sp, cp, 0.0, 0.0, 0.0, 1.0);
    let tool = Matrix3::new(cg, sg, 0.0, -sg, cg, 0.0, 0.0, 0.0, 1.0);
    let lean = Matrix3::new(co, 0.0, so, 0.0, 1.0, 0.0, -so, 0.0, co);
    // The inverse turn, as the product of the second problem prints it.
    assert!(away(Matrix3::new(cp, -sp, 0.0, -sp, cp, 0.0, 0.0, 0.0, 1.0)) > 0.1);
    // ω: the bottom row stands in the middle.
    assert!(away(Matrix3::new(co, 0.0, so, -so, 1.0, co, 0.0, 0.0, 1.0)) > 0.1);
    // φ and γ: the first element lacks cos γ.
    let printed = Matrix3::new(
        cp * sg - sp * sg,
        cp * sg + sp * cg,
        0.0,
        -sp * cg - cp * sg,
        -sp * sg + cp * cg,
        0.0,
        0.0,
        0.0,
        1.0,
    );
    assert!(away(printed) > 0.1);
    // All together: the last element of the second row has cos ω for sin ω.
    let (s, c) = (phi + gamma).sin_cos();
    let last = |element: f64| Matrix3::new(co * c, s, so * c, -co * s, c, element, -so, 0.0, co);
    assert!(away(last(-co * s)) > 0.1);
    for right in [turn, tool, lean, last(-so * s)] {
        assert!(away(right) < 1e-15);
    }
    assert!((turn * tool * lean - last(-so * s)).norm() < 1e-15);
}
