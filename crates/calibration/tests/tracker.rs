//! The STAN S500's traverses against what was printed of them, and what must be refused.

use calibration::tracker::{Frame, TrackerCalibration, Verdict, calibrate, machine};
use calibration::{Base, CalibrationError, MeanTraverse, Noise, Point, PointReading, Reading, SetUp};
use machine_model::Vector;

/// Numbers of a shipped traverse: commanded, measured, printed cosines.
fn rows(cube: u32, axis: usize) -> Vec<[f64; 9]> {
    let name = ["x", "y", "z"][axis];
    let path =
        format!("{}/../../machine-profiles/stan_s500/tracker_{cube}_{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("shipped files are good");
    text.lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> =
                line.split(',').map(|c| c.parse().expect("shipped files are good")).collect();
            cells.try_into().expect("shipped files are good")
        })
        .collect()
}

fn readings(cube: u32, axis: usize) -> Vec<Reading> {
    let reading = |r: [f64; 9]| Reading {
        commanded_mm: Vector::new(r[0], r[1], r[2]),
        measured_mm: Vector::new(r[3], r[4], r[5]),
        direction: 0,
    };
    rows(cube, axis).into_iter().map(reading).collect()
}

fn cube(size: u32) -> TrackerCalibration {
    let traverses =
        [0, 1, 2].map(|i| MeanTraverse::new(i, &readings(size, i), None).expect("shipped files are good"));
    calibrate(traverses, Frame::AsMeasured).expect("shipped files are good")
}

#[test]
fn cosines_are_the_printed_ones_with_their_signs() {
    for (size, printed_signs) in [(48, true), (240, false), (315, false)] {
        let found = cube(size);
        for axis in 0..3 {
            for (k, row) in rows(size, axis).iter().enumerate().skip(1) {
                let ours = found.cosines[axis][k - 1].cosines;
                for c in 0..3 {
                    let value = if printed_signs { ours[c] } else { ours[c].abs() };
                    // Seven printed decimals of numbers made from seven decimals.
                    assert!(
                        (value - row[6 + c]).abs() < 1.5e-7,
                        "cube {size}, axis {axis}, row {k}, {c}: {value}"
                    );
                }
            }
        }
    }
}

#[test]
fn offset_and_directions_are_those_of_the_static_method() {
    // G and r01 of interval 1 solve the target of appendix Б: q = G⁻¹(r - r01), printed 129.902 139.929 105.949.
    let found = cube(315);
    let g = found.directions(1).unwrap();
    let q = g.try_inverse().unwrap() * (Vector::new(130.0, 140.0, 106.0) - found.offset_mm(1).unwrap());
    for (ours, printed) in q.iter().zip([129.902, 139.929, 105.949]) {
        assert!((ours - printed).abs() < 0.000_5, "{ours} {printed}");
    }
}

#[test]
fn squareness_is_that_of_the_profile_s_comment() {
    // machine-profiles/stan_s500.toml: slopes of least-squares lines through the 315 mm cube.
    let s = cube(315).squareness;
    for (ours, noted) in [(s.ec0y_rad, -1100.6), (s.eb0z_rad, 432.2), (s.ea0z_rad, -510.1)] {
        // The comment leaves out products of the lines' tilts against the instrument, a milliradian each.
        assert!((ours * 1e6 - noted).abs() < 0.7, "{} {noted}", ours * 1e6);
    }
}

#[test]
fn the_machine_and_its_set_up_give_the_measured_points_back() {
    let base = Base::bare(machine_model::Chain::parse("[w X Y b Z t]").unwrap());
    let mut points = Vec::new();
    for reading in (0..3).flat_map(|axis| readings(315, axis)) {
        let seen = PointReading::Position(reading.measured_mm.data.0[0].map(Some));
        points.push(Point::new(0, reading.commanded_mm, Vector::zeros(), seen));
    }
    for frame in [Frame::AsMeasured, Frame::Fitted] {
        let found = machine(&points, &base, &cube(315), frame).unwrap();
        let model = machine_model::RigidBody::new(found.description).unwrap();
        let Some(SetUp::Frame(motion)) = found.setups[0] else { unreachable!("a tracker has a frame") };
        for p in &points {
            let PointReading::Position(seen) = p.reading else { unreachable!() };
            let again = motion.apply(&model.predict(&p.command).position_mm);
            // One reading a node: nothing is left but the common point, which three lines read.
            let left = again - Vector::from(seen.map(Option::unwrap));
            assert!(left.norm() < 0.02, "{frame:?} {p:?}: {left}");
        }
    }
}

#[test]
fn the_small_cube_is_condemned_and_the_large_one_is_not() {
    let small = cube(48).far_corner;
    assert_eq!(small.verdict(), Verdict::Unfit, "{small:?}");
    assert!(small.chord_u95_mm > 0.2 && small.deviation_mm < 0.19, "{small:?}");
    let large = cube(315).far_corner;
    assert_ne!(large.verdict(), Verdict::Unfit, "{large:?}");
    // The same readings on longer chords carry: the remedy that is offered must work.
    let chord = small.sufficient_chord_mm();
    let thinned = [0, 1, 2].map(|i| MeanTraverse::new(i, &readings(48, i), None).unwrap().thinned(chord));
    let again = calibrate(thinned, Frame::AsMeasured).unwrap().far_corner;
    assert_eq!(again.verdict(), Verdict::Sound, "{again:?}");
}

#[test]
fn repeats_give_mean_and_uncertainty() {
    let mut all = Vec::new();
    for (q, offsets) in [(0.0, [0.001, -0.001]), (10.0, [0.002, -0.002]), (20.0, [0.0, 0.0])] {
        for offset in offsets {
            let at = Vector::new(q, 0.0, 0.0);
            all.push(Reading {
                commanded_mm: at,
                measured_mm: at + Vector::new(offset, 0.0, 0.0),
                direction: 0,
            });
        }
    }
    let mean = MeanTraverse::new(0, &all, None).unwrap();
    assert_eq!(mean.noise, Noise::Repeats(3));
    // Squares 2·1e-6 + 2·4e-6 + 0 over 3 degrees of freedom.
    let scatter = (1e-5_f64 / 3.0).sqrt();
    assert!((mean.scatter_mm.x - scatter).abs() < 1e-12);
    assert!((mean.nodes[1].uncertainty_mm.x - scatter / 2f64.sqrt()).abs() < 1e-12);
    assert_eq!(mean.nodes[1].measured_mm.x, 10.0);
}

#[test]
fn missing_runs_and_missing_targets_are_found() {
    let reading = |q: f64| Reading {
        commanded_mm: Vector::new(q, 0.0, 0.0),
        measured_mm: Vector::new(q, 0.0, 0.0),
        direction: 0,
    };
    let targets = [0.0, 10.0, 20.0, 40.0, 50.0];
    let mut all: Vec<Reading> = targets.iter().chain(&targets).map(|q| reading(*q)).collect();
    all.remove(1);
    let mean = MeanTraverse::new(0, &all, None).unwrap();
    assert_eq!(mean.short_of_runs, [(10.0, 1, 2)]);
    assert_eq!(mean.gaps, [(20.0, 40.0, 10.0)]);
}

#[test]
fn wrong_axes_signs_units_and_frames_are_refused() {
    let at = |axis: usize, change: &dyn Fn(Reading) -> Reading| {
        MeanTraverse::new(axis, &readings(315, axis).into_iter().map(change).collect::<Vec<_>>(), None)
    };
    // The Y file where X is expected.
    assert!(
        matches!(MeanTraverse::new(0, &readings(315, 1), None), Err(CalibrationError::Axes(m)) if m.english().contains("it is Y"))
    );
    let micrometres = at(0, &|r| Reading { measured_mm: r.measured_mm * 1000.0, ..r });
    assert!(matches!(micrometres, Err(CalibrationError::Units(m)) if m.english().contains("micrometres")));
    let all = |change: &dyn Fn(Reading) -> Reading, frame| {
        calibrate([0, 1, 2].map(|i| at(i, change).unwrap()), frame).map(|_| ())
    };
    let swapped = |r: Reading| Reading {
        measured_mm: Vector::new(r.measured_mm.y, r.measured_mm.x, r.measured_mm.z),
        ..r
    };
    assert!(
        matches!(all(&swapped, Frame::AsMeasured), Err(CalibrationError::Axes(m)) if m.english().contains("measured Y moves"))
    );
    assert!(
        matches!(all(&swapped, Frame::Fitted), Err(CalibrationError::Axes(m)) if m.english().contains("left-handed"))
    );
    let negated = |r: Reading| Reading {
        measured_mm: Vector::new(r.measured_mm.x, r.measured_mm.y, -r.measured_mm.z),
        ..r
    };
    assert!(
        matches!(all(&negated, Frame::AsMeasured), Err(CalibrationError::Axes(m)) if m.english().contains("falls"))
    );
    // An instrument frame turned by 30° about Z: refused as it is, and brought back by the fit.
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector::z_axis(), 0.5);
    let turned =
        |r: Reading| Reading { measured_mm: turn * r.measured_mm + Vector::new(100.0, 5.0, -3.0), ..r };
    assert!(
        matches!(all(&turned, Frame::AsMeasured), Err(CalibrationError::Axes(m)) if m.english().contains("aligned"))
    );
    let fitted = calibrate([0, 1, 2].map(|i| at(i, &turned).unwrap()), Frame::Fitted).unwrap();
    let s = cube(315).squareness;
    // Angles between lines do not depend on the frame, to second order of 1 mrad.
    assert!((fitted.squareness.ec0y_rad - s.ec0y_rad).abs() < 2e-6);
    assert!((fitted.squareness.ea0z_rad - s.ea0z_rad).abs() < 2e-6);
}
