//! One axis against its base: what has not changed comes back as zero, whatever the instrument's zero was.

use calibration::functions::{Function, FunctionReading, function};
use calibration::measured_line::{
    AxisOnNodes, FunctionSets, Gauge, MeasuredLine, Zero, angles_between, apply_gauge, settle_directions,
    squareness_for,
};
use machine_model::effects::Conditions;
use machine_model::{
    AxisTables, Chain, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Six, Squareness,
    Table, Vector, WithEffects,
};

/// Tables with constant angles and everything else, on lines that lie anywhere.
fn description() -> Description {
    let axis = |k: usize| {
        let nodes: Vec<f64> = (0..5).map(|i| f64::from(i) * 100.0).collect();
        let tables: [Option<Table>; 6] = std::array::from_fn(|f| {
            let size = if f < 3 { 8e-3 } else { 20e-6 };
            // Some curve, other ones for every function, and a constant.
            let wave = |q: f64| {
                let u = q / 400.0;
                size * (1.0 + (k as f64) - u * (f as f64) + 3.0 * u * u * (1.0 - u) * ((f + k) % 3) as f64)
            };
            let values = nodes.iter().map(|q| wave(*q)).collect();
            Some(Table::new(nodes.clone(), values, Interpolation::Linear).expect("a fair machine"))
        });
        LinearAxis {
            errors: AxisTables::new(&tables),
            backlash_mm: 4e-3 + 1e-3 * k as f64,
            measured_at_mm: Vector::new(40.0, 310.0, 120.0),
            measured_tool_mm: Vector::new(30.0, -20.0, -60.0),
            ..LinearAxis::perfect(Range { low: 0.0, high: 400.0 })
        }
    };
    Description {
        chain: Chain::parse("[w Y X b Z t]").expect("a fair machine"),
        linear: std::array::from_fn(axis),
        rotary: std::array::from_fn(|_| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness { ec0y_rad: 40e-6, eb0z_rad: -25e-6, ea0z_rad: 10e-6 },
    }
}

fn machine(description: &Description) -> WithEffects {
    WithEffects::new(
        RigidBody::new(description.clone()).expect("a fair machine"),
        Vec::new(),
        Conditions::default(),
    )
    .expect("a fair machine")
}

fn line(axis: usize) -> MeasuredLine {
    MeasuredLine { axis, at_mm: Vector::new(180.0, 250.0, 90.0), optics_mm: Vector::new(0.0, 0.0, -120.0) }
}

/// The change of an axis as an instrument would give it: angles zeroed at the first target, its straightedge askew.
fn change(truth: &Description, base: &Description, axis: usize) -> [Option<Function>; 6] {
    let (real, known, line) = (machine(truth), machine(base), line(axis));
    let zero = line.motion(&real, 0.0, 1);
    let mut all: [Option<Function>; 6] = std::array::from_fn(|f| {
        let mut readings = Vec::new();
        for direction in [1, -1] {
            for i in 0..9 {
                let position_mm = 50.0 * f64::from(i);
                let mut read = line.motion(&real, position_mm, direction)[f] - zero[f];
                if f < 3 && f != axis {
                    read += 0.012 - 30e-6 * position_mm;
                }
                let value = read - line.motion(&known, position_mm, direction)[f];
                readings.push(FunctionReading { run: "1".to_owned(), position_mm, value, direction });
            }
        }
        Some(function(&readings).expect("a fair machine"))
    });
    apply_gauge(&mut all, &line, Gauge { zero: Zero::Base, without_slopes: true });
    all
}

#[test]
fn what_has_not_changed_comes_back_as_zero() {
    let base = description();
    for axis in 0..3 {
        for (f, function) in change(&base, &base, axis).iter().enumerate() {
            let function = function.as_ref().expect("a fair machine");
            let both = function.directions.as_ref().expect("a fair machine");
            // A picometre and a nanoradian: products of errors.
            let limit = if f < 3 { 1e-9 } else { 1e-11 };
            assert!(both.iter().flatten().all(|v| v.abs() < limit), "{axis} {f} {both:?}");
        }
    }
}

#[test]
fn a_change_goes_onto_the_line_of_the_base_and_the_lines_keep_their_angles() {
    let base = description();
    let mut truth = base.clone();
    // Y turns about X and Z more than before, and its angles are not zero where the lines cross.
    let more = |q: f64| -> Six { [1e-3, 2e-3, 0.0, 2e-7 * (q - 100.0), 1e-5, 1e-7 * q] };
    let nodes: Vec<f64> = base.linear[1].errors.as_ref().expect("a fair machine").nodes().to_vec();
    let mut changed = AxisOnNodes::new(&base.linear[1], 1, [true; 6], nodes.clone(), FunctionSets::AsInBase);
    for (q, six) in nodes.iter().zip(&mut changed.positive) {
        *six = std::array::from_fn(|k| six[k] + more(*q)[k]);
    }
    truth.linear[1] = changed.axis(&base.linear[1], Interpolation::Linear).expect("a fair machine");
    let lines = [0, 1, 2].map(line);
    let targets: [Vec<f64>; 3] = std::array::from_fn(|_| (0..9).map(|i| 50.0 * f64::from(i)).collect());
    let read = angles_between(&lines, &targets, &machine(&truth));

    let nodes: Vec<f64> = targets[1].clone();
    let mut made = AxisOnNodes::new(&base.linear[1], 1, [true; 6], nodes, FunctionSets::ByDirection);
    made.add(&change(&truth, &base, 1), line(1).arm_mm(&base));
    let mut found = base.clone();
    found.linear[1] = made.axis(&base.linear[1], Interpolation::Linear).expect("a fair machine");
    found.squareness = squareness_for(&lines, &targets, read, base.squareness, |squareness| {
        Ok::<_, ()>(machine(&Description { squareness, ..found.clone() }))
    })
    .expect("a fair machine");
    // A constant angle of Y and what it does to the direction of Z are one thing; the field is what counts: distances.
    let (a, b) = (machine(&truth), machine(&found));
    let corners: Vec<Vector> = (0..8)
        .map(|i| Vector::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 400.0)
        .collect();
    let at = |m: &WithEffects, q: &Vector| {
        let command = machine_model::Command {
            linear_mm: *q,
            tool_mm: Vector::new(0.0, 0.0, -120.0),
            direction: [1, -1, 1],
            ..Default::default()
        };
        m.predict(&command).position_mm
    };
    for p in &corners {
        for q in &corners {
            let [one, other] = [&a, &b].map(|m| (at(m, p) - at(m, q)).norm());
            assert!((one - other).abs() < 2e-6, "{p} {q}: {} um", (one - other) * 1e3);
        }
    }
}

#[test]
fn one_reversal_value_where_the_scatter_allows_no_more() {
    let with = |wander: f64| {
        let mut readings = Vec::new();
        for run in 0..5 {
            for i in 0..9 {
                // A scatter of about 1 µm without chance in it.
                let noise = 1e-3 * (f64::from((run * 7 + i * 3) % 5) - 2.0) / 1.4;
                for direction in [1, -1] {
                    let play = 6e-3 + wander * f64::from(i);
                    let value = noise - f64::from(direction) * play / 2.0;
                    readings.push(FunctionReading {
                        run: run.to_string(),
                        position_mm: f64::from(i) * 50.0,
                        value,
                        direction: direction as i8,
                    });
                }
            }
        }
        let mut found = function(&readings).expect("a fair machine");
        settle_directions(&mut found, [5, 5]);
        found
    };
    let even = with(1e-5);
    let [up, down] = even.directions.as_ref().expect("a fair machine");
    assert!(even.one_reversal);
    assert!(up.iter().zip(down).all(|(u, d)| (d - u - 6.04e-3).abs() < 1e-9), "{up:?} {down:?}");
    assert!(!with(2e-3).one_reversal);
}
