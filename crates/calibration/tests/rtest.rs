//! R-tests of made-up five-axis machines with all 41 deviations: what can be seen is found within its interval, what cannot is
//! named, and the changed machine predicts what nobody measured.

use calibration::rtest::{BallReading, Basis, RotaryTables, Term, calibrate};
use calibration::{Base, CalibrationError};
use machine_model::{
    Axis, AxisTables, Chain, Command, Description, Engine, Interpolation, LinearAxis, PathModel, Range,
    RigidBody, RotaryAxis, Squareness, Table, Vector,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Machines of the test that counts intervals.
const MACHINES: u64 = 6;

const ARC: Range = Range { low: -0.5 * std::f64::consts::PI, high: std::f64::consts::PI / 6.0 };

/// The sum of twelve even ones less six: normal enough for intervals of 95 %, variance 1.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// Smooth functions of an axis between two places: a few waves and a slope, six of them.
fn smooth(random: &mut ChaCha8Rng, low: f64, high: f64, size: [f64; 2]) -> AxisTables {
    let nodes: Vec<f64> = (0..=40).map(|k| low + (high - low) * f64::from(k) / 40.0).collect();
    let function = |f: usize, random: &mut ChaCha8Rng| {
        let parts: Vec<(f64, f64, f64)> =
            (1..=3).map(|k| (f64::from(k) * 2.0, normal(random), normal(random))).collect();
        let scale = size[usize::from(f >= 3)] / 3.0;
        let value = |q: f64| -> f64 {
            let t = (q - low) / (high - low);
            parts
                .iter()
                .map(|(k, a, b)| scale * (a * units::math::cos(k * t) + b * units::math::sin(k * t)))
                .sum()
        };
        Table::new(nodes.clone(), nodes.iter().map(|q| value(*q)).collect(), Interpolation::Linear).ok()
    };
    let all: Vec<Option<Table>> = (0..6).map(|f| function(f, random)).collect();
    AxisTables::new(&all.try_into().expect("six functions")).expect("common nodes")
}

/// The chain of the MS-300 of Serkov 2017, its linear axes with their 21 deviations.
fn base(random: &mut ChaCha8Rng) -> Base {
    let linear = [(); 3].map(|()| {
        let mut axis = LinearAxis::perfect(Range { low: -500.0, high: 500.0 });
        axis.errors = Some(smooth(random, -500.0, 500.0, [0.008, 20e-6]));
        axis
    });
    let squareness = Squareness {
        ec0y_rad: 20e-6 * normal(random),
        eb0z_rad: 20e-6 * normal(random),
        ea0z_rad: 20e-6 * normal(random),
    };
    let mut rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
    rotary[1].travel_rad = Range { low: -1.8, high: 0.7 };
    rotary[1].centre_mm = Vector::new(5.0, 0.0, -40.0);
    let chain = Chain::parse("[w C B b X Y Z t]").expect("a chain");
    Base {
        description: Description { chain, linear, rotary, squareness },
        interpolation: Interpolation::Linear,
        is_known: true,
    }
}

/// A truth in terms: every function of B and C by coefficients of so many groups, mm and rad.
fn truth(random: &mut ChaCha8Rng, from_group: usize) -> Vec<(Term, f64)> {
    let mut all = Vec::new();
    for (axis, basis, groups) in [(Axis::C, Basis::Turn, 5), (Axis::B, Basis::Arc(ARC), 4)] {
        for group in from_group..groups {
            for function in 0..6 {
                for which in 0..basis.values(group, 0.0).len() {
                    let size = if function < 3 { 0.003 } else { 8e-6 };
                    let value = size * normal(random);
                    all.push((Term::Coefficient { axis, function, basis, group, which }, value));
                }
            }
        }
    }
    all
}

/// The base with location errors and these functions; tables at every degree.
fn real(base: &Base, random: &mut ChaCha8Rng, functions: &[(Term, f64)]) -> Description {
    let mut machine = base.description.clone();
    for axis in [1, 2] {
        let rotary = &mut machine.rotary[axis];
        for direction in (0..3).filter(|d| *d != axis) {
            rotary.shift_mm[direction] = 0.020 * normal(random);
            rotary.tilt_rad[direction] = 60e-6 * normal(random);
        }
        let (low, high) = if axis == 1 { (-90, 30) } else { (-360, 360) };
        let nodes: Vec<f64> = (4 * low..=4 * high).map(|q| (0.25 * f64::from(q)).to_radians()).collect();
        let value = |function: usize, angle: f64| -> f64 {
            let of = |(term, value): &(Term, f64)| match term {
                Term::Coefficient { axis: own, function: f, basis, group, which }
                    if own.direction() == axis && *f == function =>
                {
                    value * basis.values(*group, angle)[*which]
                }
                _ => 0.0,
            };
            functions.iter().map(of).sum()
        };
        let table = |function| {
            Table::new(
                nodes.clone(),
                nodes.iter().map(|a| value(function, *a)).collect(),
                Interpolation::Linear,
            )
            .ok()
        };
        rotary.errors = AxisTables::new(&std::array::from_fn(table));
    }
    machine
}

/// A ball at a place of the workpiece, read at angles of B and C, degrees.
fn read(
    machine: &Description,
    ball: usize,
    place_mm: Vector,
    tool_mm: Vector,
    angles: &[(f64, f64)],
    noise_mm: &mut dyn FnMut() -> f64,
) -> Vec<BallReading> {
    let model = RigidBody::new(machine.clone()).expect("a machine");
    let offset_mm = Vector::new(0.031, -0.017, 0.009) * (1.0 + ball as f64);
    angles
        .iter()
        .map(|(b, c)| {
            let rotary_rad = Vector::new(0.0, b.to_radians(), c.to_radians());
            let mut command = Command { linear_mm: Vector::zeros(), rotary_rad, tool_mm, direction: [0; 3] };
            command.linear_mm = model.same_tip_mm(&(place_mm - tool_mm), &command, &Vector::zeros());
            assert!(model.volume().contains(&command.linear_mm), "{command:?}");
            let deviation = model.predict(&command).error_mm + offset_mm;
            BallReading {
                run: ball,
                command,
                turning: [0; 3],
                deviation_mm: [0, 1, 2].map(|i| Some(deviation[i] + noise_mm())),
                uncertainty_mm: None,
            }
        })
        .collect()
}

/// B from -90 to 30 by 10, C by 15, every other pair; four balls that lie in no plane, with tools of four lengths.
fn whole(machine: &Description, noise_mm: &mut dyn FnMut() -> f64) -> Vec<BallReading> {
    let mut angles = Vec::new();
    for b in 0..13 {
        for c in 0..24 {
            if (b + c) % 2 == 0 {
                angles.push((-90.0 + 10.0 * f64::from(b), 15.0 * f64::from(c)));
            }
        }
    }
    let balls = [(120.0, 0.0, 50.0), (-60.0, 100.0, 80.0), (-50.0, -90.0, 20.0), (30.0, 40.0, 150.0)];
    let each = balls.iter().enumerate().map(|(k, (x, y, z))| {
        let tool = Vector::new(0.0, 0.0, -100.0 - 20.0 * k as f64);
        read(machine, k, Vector::new(*x, *y, *z), tool, &angles, noise_mm)
    });
    each.flatten().collect()
}

fn names(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("ball {k}")).collect()
}

fn found(rows: &[BallReading], base: &Base) -> Result<RotaryTables, CalibrationError> {
    let runs = rows.iter().map(|row| row.run + 1).max().unwrap_or(0);
    calibrate(rows, base, &names(runs))
}

fn silent() -> impl FnMut() -> f64 {
    || 0.0
}

#[test]
fn every_term_lies_in_its_interval_as_often_as_it_says_and_unseen_places_are_predicted() {
    let (mut inside, mut all) = (0, 0);
    let mut by_name: std::collections::BTreeMap<String, (u64, u64)> = Default::default();
    for seed in 0..MACHINES {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let base = base(&mut random);
        let functions = truth(&mut random, 2);
        let machine = real(&base, &mut random, &functions);
        let mut noise = || 0.001 * normal(&mut random);
        let rows = whole(&machine, &mut noise);
        let unseen_angles: Vec<(f64, f64)> = (0..60)
            .map(|k| (-88.0 + 1.9 * f64::from(k), 41.0 * f64::from(k) - 350.0))
            .map(|(b, c)| (b, c % 360.0))
            .collect();
        let unseen = read(
            &machine,
            0,
            Vector::new(80.0, -70.0, 110.0),
            Vector::new(0.0, 0.0, -130.0),
            &unseen_angles,
            &mut silent(),
        );
        let result = found(&rows, &base).unwrap();
        assert!(result.not_told_apart.is_empty() && result.unseen.is_empty(), "{:?}", result.not_told_apart);
        // Noise of 1 µm, of 3744 readings.
        assert!((result.estimate.sigma - 0.001).abs() < 6e-5, "{}", result.estimate.sigma);
        for term in &result.terms {
            let real = match term.term {
                Term::Location(location) => {
                    let own = &machine.rotary[location.axis.direction()];
                    if location.is_length {
                        own.shift_mm[location.direction]
                    } else {
                        own.tilt_rad[location.direction]
                    }
                }
                other => functions.iter().find(|(own, _)| *own == other).map_or(0.0, |(_, value)| *value),
            };
            assert!(term.is_written);
            let is_in = (term.base + term.change - real).abs() <= term.half_width_95;
            all += 1;
            inside += u64::from(is_in);
            let own = by_name.entry(term.term.name()).or_default();
            *own = (own.0 + u64::from(is_in), own.1 + 1);
        }
        let held = result.held_out(&unseen, &base).unwrap();
        println!(
            "{seed} {:?} {held:?} field {}",
            result.axes.iter().map(|a| a.groups).collect::<Vec<_>>(),
            result.field_u95_mm
        );
        assert!(held.rms_before_mm > 0.010 && held.rms_after_mm < 0.0005, "{held:?}");
        assert!(held.max_after_mm < 2.5 * result.field_u95_mm, "{held:?} {}", result.field_u95_mm);
    }
    let worst = by_name.iter().min_by(|a, b| (a.1.0 * b.1.1).cmp(&(b.1.0 * a.1.1))).unwrap();
    println!("{inside} of {all}; worst {worst:?}");
    let share = f64::from(inside as u32) / f64::from(all as u32);
    assert!((0.92..0.98).contains(&share), "{inside} of {all}");
}
