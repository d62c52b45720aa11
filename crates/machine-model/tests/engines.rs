//! The product engines against themselves and against what their premises demand.

use crate::machines;
use crate::stan_s500;

use machine_model::engines::{
    BuildError, EngineInputs, Kmtpp, ParametricTable, TangentialInterval, Tracker, build,
};
use machine_model::{
    Command, Engine, EngineId, Interpolation, Move, PathModel, Range, Squareness, Traverse, Vector,
};
use machines::Random;
use stan_s500::{inputs, tables, traverses};

fn at(linear_mm: Vector) -> Command {
    Command { linear_mm, ..Default::default() }
}

fn engine(id: EngineId, interpolation: Interpolation) -> Box<dyn Engine> {
    let mut inputs = inputs(&tables(), &traverses(315), Squareness::default());
    inputs.traverse_interpolation = interpolation;
    build(id, inputs).expect("nothing is lacking")
}

/// Engines with a path model that are continuous, by name.
fn continuous() -> Vec<(String, Box<dyn Engine>)> {
    let mut all = vec![("tracker linear".to_owned(), engine(EngineId::Tracker, Interpolation::Linear))];
    for id in [
        EngineId::Tracker,
        EngineId::TangentialStatic,
        EngineId::TangentialQuasiDifferential,
        EngineId::Kmtpp,
        EngineId::Field,
    ] {
        all.push((id.name().to_owned(), engine(id, Interpolation::Monotone)));
    }
    all
}

/// A straight or bent stretch inside a box: `q(s) = a + s·b + s(1-s)·c`.
struct Stretch {
    start: Vector,
    along: Vector,
    bend: Vector,
}

impl Stretch {
    fn random(random: &mut Random, engine: &dyn Engine, length_mm: f64, bend_mm: f64) -> Self {
        let volume = engine.volume();
        let inside = |random: &mut Random| {
            Vector::from_fn(|i, _| {
                let Range { low, high } = volume.0[i];
                low + (high - low) * (0.5 + random.number(0.4))
            })
        };
        let start = inside(random);
        let mut along = inside(random) - start;
        along *= (length_mm / along.norm()).min(1.0);
        Self { start, along, bend: random.vector(bend_mm) }
    }
    fn place(&self, s: f64) -> Vector {
        self.start + self.along * s + self.bend * (s * (1.0 - s))
    }
    fn as_move(&self) -> Move {
        let range_mm = std::array::from_fn(|i| {
            // The quadratic's range from its Bézier points.
            let points =
                [self.start[i], self.start[i] + 0.5 * (self.along[i] + self.bend[i]), self.place(1.0)[i]];
            Range {
                low: points.iter().copied().fold(f64::MAX, f64::min),
                high: points.iter().copied().fold(f64::MIN, f64::max),
            }
        });
        Move {
            range_mm,
            speed_mm: std::array::from_fn(|i| self.along[i].abs() + self.bend[i].abs()),
            acceleration_mm: std::array::from_fn(|i| 2.0 * self.bend[i].abs()),
            passes: if self.bend == Vector::zeros() { 1 } else { 2 },
            state: at(Vector::zeros()),
            turn: None,
        }
    }
    /// Largest distance of the error from its chord, sampled.
    fn deviation_mm(&self, model: &dyn PathModel) -> f64 {
        let error = |s: f64| model.error_mm(&at(self.place(s)));
        let (first, last) = (error(0.0), error(1.0));
        (1..200)
            .map(|k| f64::from(k) / 200.0)
            .map(|s| (error(s) - first * (1.0 - s) - last * s).norm())
            .fold(0.0, f64::max)
    }
}

#[test]
fn chord_bounds_hold_and_are_not_idle() {
    let mut random = Random::new(5);
    for (name, engine) in continuous() {
        let model = engine.path_model().unwrap();
        for (length, bend) in [(1.0, 0.0), (10.0, 0.0), (100.0, 0.0), (10.0, 3.0), (60.0, 20.0)] {
            let mut ratios = Vec::new();
            for _ in 0..100 {
                let stretch = Stretch::random(&mut random, &*engine, length, bend);
                let (bound, found) = (model.chord_bound_mm(&stretch.as_move()), stretch.deviation_mm(model));
                assert!(
                    found <= bound * (1.0 + 1e-9) + 1e-12,
                    "{name} {length} {bend}: {found:e} > {bound:e}"
                );
                if found > 1e-9 {
                    ratios.push(bound / found);
                }
            }
            ratios.sort_by(f64::total_cmp);
            if let Some(median) = ratios.get(ratios.len() / 2) {
                println!(
                    "{name}, {length} mm, bend {bend}: bound/deviation median {median:.1}, n {}",
                    ratios.len()
                );
                assert!(*median < 40.0, "{name} {length} {bend}: the bound is {median} times too large");
            }
        }
    }
}

/// A stretch that leaves the volume: the error of the nearest point is kept, with a kink at the face.
#[test]
fn chord_bounds_hold_across_the_faces_of_the_volume() {
    for (name, engine) in continuous() {
        let model = engine.path_model().unwrap();
        let Range { low, high } = engine.volume().0[0];
        for (from, to) in [(low - 30.0, low + 20.0), (high - 7.0, high + 40.0), (low - 5.0, high + 5.0)] {
            let stretch = Stretch {
                start: Vector::new(from, 120.0, 80.0),
                along: Vector::new(to - from, 11.0, -13.0),
                bend: Vector::zeros(),
            };
            let (bound, found) = (model.chord_bound_mm(&stretch.as_move()), stretch.deviation_mm(model));
            assert!(found <= bound * (1.0 + 1e-9), "{name} {from}..{to}: {found:e} > {bound:e}");
        }
    }
}

#[test]
fn every_inverse_meets_its_own_forward_model() {
    let mut random = Random::new(6);
    for (name, engine) in continuous() {
        let model = engine.path_model().unwrap();
        for _ in 0..300 {
            let target = Stretch::random(&mut random, &*engine, 1.0, 0.0).start;
            let solution = engine.solve(&at(target)).unwrap();
            let back = solution.linear_mm + model.error_mm(&at(solution.linear_mm));
            assert!((back - target).norm() <= 1e-9, "{name}");
            assert!(solution.residual_mm <= 1e-9 && solution.iterations < 10, "{name}: {solution:?}");
        }
    }
}

#[test]
fn the_interval_method_jumps_and_says_where() {
    let engine = TangentialInterval::new(&traverses(315)).unwrap();
    let (jump, axis, q) = engine.largest_jump();
    assert!(jump > 0.02, "{jump}");
    let mut below = Vector::new(100.0, 100.0, 100.0);
    below[axis] = q - 1e-9;
    let mut above = below;
    above[axis] = q;
    let found = (engine.error_mm(&at(above)) - engine.error_mm(&at(below))).norm();
    assert!((found - jump).abs() < 1e-8, "{found} is not {jump}");

    let across = |low: f64, high: f64| {
        let mut stretch = Stretch { start: below, along: Vector::zeros(), bend: Vector::zeros() }.as_move();
        stretch.range_mm[axis] = Range { low, high };
        engine.chord_bound_mm(&stretch)
    };
    assert_eq!(across(q - 3.0, q + 3.0), f64::INFINITY);
    assert_eq!(across(q - 3.0, q), f64::INFINITY);
    assert_eq!(across(q + 1.0, q + 3.0), 0.0);
}

/// A command is only returned if predicting it leads to the target; between cells that move apart none does.
#[test]
fn the_interval_method_refuses_what_no_command_reaches() {
    let engine = TangentialInterval::new(&traverses(315)).unwrap();
    let mut random = Random::new(7);
    for _ in 0..1000 {
        let target = Vector::repeat(150.0) + random.vector(149.0);
        let solution = engine.solve(&at(target)).unwrap();
        let back = solution.linear_mm + engine.error_mm(&at(solution.linear_mm));
        assert!((back - target).norm() <= 1e-9, "{target:?}");
    }
    let mut gaps = 0;
    for node in (1..20).map(|k| 15.0 * f64::from(k)) {
        let there =
            |x: f64| Vector::new(x, 100.0, 100.0) + engine.error_mm(&at(Vector::new(x, 100.0, 100.0)));
        let (before, after) = (there(node - 1e-9), there(node));
        let solved = engine.solve(&at((before + after) / 2.0));
        if after.x - before.x > 1e-3 {
            gaps += 1;
            assert!(solved.unwrap_err().to_string().contains("move apart"));
        } else if after.x - before.x < -1e-3 {
            assert!(solved.is_ok(), "where the maps overlap two commands lead there");
        }
    }
    assert!(gaps > 3, "{gaps}");
}

/// Rows of an axis with a constant angular error and scale; the rest is zero.
fn constant_angle(angle: Vector, scale: f64, axis: usize) -> ParametricTable {
    let positions: Vec<f64> = (0..=20).map(|k| f64::from(k) * 20.0).collect();
    let rows = positions.iter().map(|q| {
        let mut row = [0.0; 6];
        row[axis] = scale * q;
        row[3..].copy_from_slice(angle.as_slice());
        row
    });
    ParametricTable::new(positions.clone(), rows.collect()).expect("a table")
}

fn straight_traverses(directions: [Vector; 3]) -> [Traverse; 3] {
    [0, 1, 2].map(|axis| {
        let nodes_mm: Vec<f64> = (0..=20).map(|k| f64::from(k) * 20.0).collect();
        let measured = |q: &f64| -> [f64; 3] { (directions[axis].normalize() * *q).into() };
        let measured_mm = nodes_mm.iter().map(measured).collect();
        Traverse { axis, nodes_mm, start_mm: [0.0; 3], measured_mm, published_cosines: None }
    })
}

#[test]
fn kmtpp_with_constant_angles_turns_the_straight_line() {
    let angle = Vector::new(1e-3, -2e-3, 5e-4);
    let tables = [0, 1, 2].map(|axis| constant_angle(angle / 3.0, 2e-4, axis));
    let traverses = straight_traverses([Vector::x(), Vector::new(1e-3, 1.0, 0.0), Vector::z()]);
    let engine = Kmtpp::from_measurements(&tables, &traverses).unwrap();
    let q = Vector::new(123.0, 77.0, 311.0);
    let line = q + Vector::new(1e-3, 1.0, 0.0).normalize() * q.y - Vector::y() * q.y;
    let expected =
        line + machine_model::finite_rotations::rodrigues_displacement(&angle, &line) + q * 2e-4 - q;
    assert!((engine.error_mm(&at(q)) - expected).norm() < 1e-12);
    // A rotation that is the same everywhere is integrable: the order of motion does not matter.
    assert!(engine.path_dependence(&q).largest_mm < 1e-11);
}

/// The line integral does not depend on how finely it is cut: tables with ten times the nodes are the
/// same functions.
#[test]
fn kmtpp_integral_does_not_change_when_refined() {
    let coarse = Kmtpp::from_measurements(&tables(), &traverses(315)).unwrap();
    let fine = Kmtpp::from_measurements(&tables().map(|t| t.refined(1.0)), &traverses(315)).unwrap();
    let mut random = Random::new(8);
    for _ in 0..50 {
        let q = Vector::new(200.0, 140.0, 100.0) + random.vector(99.0);
        assert!((coarse.error_mm(&at(q)) - fine.error_mm(&at(q))).norm() < 1e-11);
    }
}

/// A machine far worse than any (white noise of 5 mrad and 0.1 mm), with tables on both sides of the origin and of uneven steps.
fn bent(seed: u64) -> Kmtpp {
    let mut random = Random::new(seed);
    let tables = [0, 1, 2].map(|_| {
        let mut positions = vec![-150.0];
        while positions[positions.len() - 1] < 150.0 {
            positions.push(positions[positions.len() - 1] + 20.0 + random.number(12.0));
        }
        let rows =
            positions.iter().map(|_| std::array::from_fn(|f| random.number(if f < 3 { 0.1 } else { 5e-3 })));
        let rows = rows.collect();
        ParametricTable::new(positions, rows).expect("a table")
    });
    let mut traverses = straight_traverses([0, 1, 2].map(|i| {
        let mut direction = random.vector(0.01);
        direction[i] = 1.0;
        direction
    }));
    for traverse in &mut traverses {
        // From -200 to 200 through the common origin.
        traverse.start_mm[traverse.axis] = -200.0;
        traverse.nodes_mm.iter_mut().for_each(|q| *q -= 200.0);
    }
    Kmtpp::from_measurements(&tables, &traverses).expect("three axes")
}

#[test]
fn kmtpp_bounds_and_inverts_bent_machines_on_both_sides_of_the_origin() {
    for seed in 0..12 {
        let engine = bent(seed);
        let mut random = Random::new(100 + seed);
        let mut ratios = Vec::new();
        for (length, bend) in [(5.0, 0.0), (50.0, 0.0), (200.0, 0.0), (50.0, 20.0)] {
            for _ in 0..25 {
                let stretch = Stretch::random(&mut random, &engine, length, bend);
                let (bound, found) =
                    (engine.chord_bound_mm(&stretch.as_move()), stretch.deviation_mm(&engine));
                assert!(
                    found <= bound * (1.0 + 1e-9) + 1e-12,
                    "{seed} {length} {bend}: {found:e} > {bound:e}"
                );
                ratios.push(bound / found);
                let target = at(stretch.place(0.5));
                let solution = engine.solve(&target).expect("well inside the volume");
                let back = solution.linear_mm + engine.error_mm(&at(solution.linear_mm));
                assert!((back - target.linear_mm).norm() <= 1e-9);
            }
        }
        ratios.sort_by(f64::total_cmp);
        assert!(ratios[ratios.len() / 2] < 60.0, "{seed}: median {}", ratios[ratios.len() / 2]);
    }
}

/// Expected from a prototype: 2 to 6 µm at 200 mm on the STAN S500 tables.
#[test]
fn kmtpp_depends_on_the_path() {
    let engine = Kmtpp::from_measurements(&tables(), &traverses(315)).unwrap();
    let found = engine.path_dependence(&Vector::repeat(200.0));
    let um = |a: Vector, b: Vector| (a - b).norm() * 1e3;
    for pair in [
        um(found.straight_mm, found.xyz_mm),
        um(found.straight_mm, found.zyx_mm),
        um(found.xyz_mm, found.zyx_mm),
    ] {
        assert!((1.5..7.0).contains(&pair), "{pair} µm");
    }
    let straight = engine.error_mm(&at(Vector::repeat(200.0))) + Vector::repeat(200.0);
    assert!((straight - found.straight_mm).norm() < 1e-12);
}

#[test]
fn tracker_passes_through_every_measured_point() {
    for interpolation in [Interpolation::Linear, Interpolation::Monotone] {
        let traverses = traverses(315);
        let engine = Tracker::new(&traverses, interpolation).unwrap();
        for traverse in &traverses {
            for (q, measured) in traverse.nodes_mm.iter().zip(&traverse.measured_mm) {
                let mut command = Vector::zeros();
                command[traverse.axis] = *q;
                let there = command + engine.error_mm(&at(command));
                assert!((there - Vector::from(*measured)).norm() < 1e-12);
            }
        }
    }
}

/// Traverses that do not start where they meet, in a tracker frame of its own.
#[test]
fn tracker_takes_positions_relative_to_the_common_origin() {
    let shift = Vector::new(1000.0, -50.0, 7.0);
    let origin = [20.0, 20.0, 40.0];
    let mut moved = straight_traverses([Vector::x(), Vector::y(), Vector::z()]);
    for traverse in &mut moved {
        traverse.start_mm = origin;
        traverse.start_mm[traverse.axis] = 0.0;
        for measured in &mut traverse.measured_mm {
            measured[traverse.axis] -= origin[traverse.axis];
            (0..3).for_each(|c| measured[c] += shift[c]);
        }
    }
    let engine = Tracker::new(&moved, Interpolation::Linear).unwrap();
    assert!(engine.error_mm(&at(Vector::new(37.0, 1.0, 399.0))).norm() < 1e-12);
}

#[test]
fn what_the_profile_lacks_is_named() {
    let message = |id, inputs| build(id, inputs).err().unwrap().to_string();
    for id in EngineId::ALL {
        let text = message(id, EngineInputs::default());
        assert!(text.contains(id.name()) && text.contains("; add "), "{text}");
    }
    let only_tracker = EngineInputs { traverses: Some(traverses(315)), ..EngineInputs::default() };
    assert!(message(EngineId::Kmtpp, only_tracker).contains("[axis.X]"));

    let mut apart = traverses(315);
    apart[1].start_mm[0] = 3.0;
    let inputs = EngineInputs { traverses: Some(apart), ..EngineInputs::default() };
    assert_eq!(
        build(EngineId::Tracker, inputs).err(),
        Some(BuildError::NoCommonOrigin { axis: 'X', first_mm: 3.0, second_mm: 0.0 })
    );
    let mut swapped = traverses(315);
    swapped.swap(0, 1);
    let inputs = EngineInputs { traverses: Some(swapped), ..EngineInputs::default() };
    assert_eq!(build(EngineId::Tracker, inputs).err(), Some(BuildError::TraverseOfOtherAxis { axis: 'X' }));
}

#[test]
fn targets_outside_the_calibrated_volume_are_refused() {
    for id in EngineId::ALL {
        let engine = engine(id, Interpolation::Monotone);
        let error = engine.solve(&at(Vector::new(50.0, 50.0, 500.0))).unwrap_err().to_string();
        assert!(error.contains("axis Z at 500.000 mm"), "{id}: {error}");
        assert!(engine.solve(&at(Vector::new(f64::NAN, 50.0, 50.0))).is_err(), "{id}");
    }
}
