//! Rotary axes that turn on the way: the bound of the error, and where the tool points.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use crate::machines;

use machine_model::{
    AxisTables, Command, Description, Engine, Interpolation, Move, PathModel, Range, RigidBody, RotaryPlay,
    Table, Tilt, TipControl, Turn, Vector,
};
use machines::{Random, command, machine, perfect};
use proptest::prelude::*;

const CHAINS: [&str; 5] = [
    "[w C A X Y b Z t]",
    "[w C B b Y X Z t]",
    "[w C b X Y Z B t]",
    "[w X Y b Z C A t]",
    "[w A C b Z X Y B t]",
];

/// Errors of all kinds in every axis; centres far from each other.
fn crooked(seed: u64, chain: &str, monotone: bool) -> RigidBody {
    RigidBody::new(described(seed, chain, monotone)).unwrap()
}

/// The same from both sides: without lost motion.
fn without_play(seed: u64, chain: &str, monotone: bool) -> RigidBody {
    let mut machine = described(seed, chain, monotone);
    for axis in &mut machine.linear {
        (axis.errors_negative, axis.backlash_mm) = (None, 0.0);
    }
    RigidBody::new(machine).unwrap()
}

fn described(seed: u64, chain: &str, monotone: bool) -> Description {
    let mut machine = machine(seed, chain, monotone, 1.0);
    let mut random = Random::new(seed ^ 0x5eed);
    let interpolation = if monotone { Interpolation::Monotone } else { Interpolation::Linear };
    let nodes: Vec<f64> = (0..=40).map(|k| -4.0 + 0.2 * f64::from(k)).collect();
    for rotary in &mut machine.rotary {
        rotary.centre_mm = random.vector(100.0);
        rotary.shift_mm = random.vector(0.05);
        rotary.tilt_rad = random.vector(5e-4);
        rotary.tilt = if seed.is_multiple_of(2) { Tilt::Body } else { Tilt::Axis };
        // Any direction, mostly near none of the machine's.
        rotary.direction = (seed.is_multiple_of(3)).then(|| random.vector(1.0).normalize());
        let mut tables = || {
            AxisTables::new(&std::array::from_fn(|i| {
                let size = if i < 3 { 0.01 } else { 1e-4 };
                let values = nodes.iter().map(|_| random.number(size)).collect();
                Some(Table::new(nodes.clone(), values, interpolation).unwrap())
            }))
        };
        rotary.errors = tables();
        if seed.is_multiple_of(5) {
            rotary.errors_negative = tables();
        } else {
            rotary.backlash_rad = 1e-4;
        }
    }
    machine
}

/// A stretch of it, and its error at s.
struct Way<'m> {
    model: &'m dyn PathModel,
    linear_mm: [Vector; 2],
    turn: Turn,
    state: Command,
}

impl Way<'_> {
    fn at(&self, ends: &[Vector; 2], s: f64) -> Vector {
        ends[0] + (ends[1] - ends[0]) * s
    }

    fn error_mm(&self, s: f64) -> Vector {
        let linear_mm = self.at(&self.linear_mm, s);
        let rotary_rad = self.at(&self.turn.commanded_rad, s);
        let lag_rad = self.at(&self.turn.lag_rad, s);
        let rotary_play = RotaryPlay { lag_rad, ..self.state.rotary_play };
        let command = Command { linear_mm, rotary_rad, rotary_play, ..self.state };
        self.model.error_from_mm(&command, &self.at(&self.turn.programmed_rad, s))
    }

    fn stands(&self) -> bool {
        let Turn { programmed_rad, commanded_rad, lag_rad } = self.turn;
        commanded_rad[0] == commanded_rad[1]
            && programmed_rad == commanded_rad
            && lag_rad == [Vector::zeros(); 2]
    }

    fn bound_mm(&self) -> f64 {
        let [from, to] = self.linear_mm;
        self.model.chord_bound_mm(&Move {
            range_mm: std::array::from_fn(|i| Range { low: from[i].min(to[i]), high: from[i].max(to[i]) }),
            speed_mm: (to - from).abs().into(),
            acceleration_mm: [0.0; 3],
            passes: 1,
            state: Command { rotary_rad: self.turn.commanded_rad[0], ..self.state },
            turn: (!self.stands()).then_some(self.turn),
        })
    }

    /// The largest distance from the chord at many places, mm.
    fn leaves_mm(&self, places: u32) -> f64 {
        let (first, last) = (self.error_mm(0.0), self.error_mm(1.0));
        (0..=places)
            .map(|k| f64::from(k) / f64::from(places))
            .map(|s| (self.error_mm(s) - first * (1.0 - s) - last * s).norm())
            .fold(0.0, f64::max)
    }
}

fn way<'m>(
    model: &'m RigidBody,
    random: &mut Random,
    length_mm: f64,
    turn_rad: f64,
    slip_rad: f64,
) -> Way<'m> {
    let from = Vector::new(200.0, 140.0, 100.0) + random.vector(80.0);
    let angles = random.vector(3.0);
    let programmed_rad = [angles, angles + random.vector(turn_rad)];
    Way {
        model,
        linear_mm: [from, from + random.vector(length_mm)],
        turn: Turn {
            programmed_rad,
            commanded_rad: programmed_rad.map(|angles| angles + random.vector(slip_rad)),
            lag_rad: [random.vector(3.0 * slip_rad), random.vector(3.0 * slip_rad)],
        },
        state: Command { rotary_play: sides(random), ..command([0.0; 3], random.vector(120.0).into()) },
    }
}

/// Any sides of all rotary axes, no lag.
fn sides(random: &mut Random) -> RotaryPlay {
    RotaryPlay { direction: [(); 3].map(|()| random.number(1.49).round() as i8), ..RotaryPlay::default() }
}

/// Programmed and commanded alike.
fn commanded(programmed_rad: [Vector; 2], lag_rad: [Vector; 2]) -> Turn {
    Turn { programmed_rad, commanded_rad: programmed_rad, lag_rad }
}

proptest! {
    /// Equation (61): tip and rotary axes run evenly, the control has other centres.
    #[test]
    fn under_tip_control_neither(
        seed: u64, chain in 0usize..5, monotone: bool, length in 0.0f64..15.0, apart in 0.0f64..0.2,
        turn in prop_oneof![Just(0.0), 0.0f64..0.02, 0.0f64..0.4], lag in prop_oneof![Just(0.0), 0.0f64..2e-4],
    ) {
        let mut random = Random::new(seed);
        let machine = without_play(seed, CHAINS[chain], monotone);
        let centres = machine.description().rotary.each_ref().map(|axis| axis.centre_mm + random.vector(apart));
        let model = TipControl::new(&machine, centres).unwrap();
        let angles = random.vector(3.0);
        let axes = Command {
            rotary_rad: angles, ..command((Vector::new(200.0, 140.0, 100.0) + random.vector(30.0)).into(), random.vector(60.0).into())
        };
        let from = model.tip_command(&axes).linear_mm;
        prop_assert!((model.axis_command(&model.tip_command(&axes)).linear_mm - axes.linear_mm).norm() < 1e-9);
        let lags = [random.vector(lag), random.vector(lag)];
        let turn = commanded([angles, angles + random.vector(turn)], lags);
        let way = Way {
            model: &model, linear_mm: [from, from + random.vector(length)], turn,
            state: Command { rotary_rad: angles, rotary_play: sides(&mut random), ..axes },
        };
        let (bound, found) = (way.bound_mm(), way.leaves_mm(200));
        prop_assert!(found <= bound + 1e-11, "{found} > {bound}");
        let target = Command { linear_mm: way.at(&way.linear_mm, 0.5), ..way.state };
        if let Ok(solution) = model.solve(&target) {
            let reached = solution.linear_mm + model.error_mm(&Command { linear_mm: solution.linear_mm, ..target });
            prop_assert!((reached - target.linear_mm).norm() < 1e-9);
        }
    }

    #[test]
    fn the_error_never_leaves_its_chord_by_more_than_the_bound(
        seed: u64, chain in 0usize..5, monotone: bool, length in 0.0f64..15.0,
        turn in prop_oneof![Just(0.0), 0.0f64..0.02, 0.0f64..0.6], slip in prop_oneof![Just(0.0), 0.0f64..3e-5],
    ) {
        let model = crooked(seed, CHAINS[chain], monotone);
        let way = way(&model, &mut Random::new(seed), length, turn, slip);
        let (bound, found) = (way.bound_mm(), way.leaves_mm(200));
        prop_assert!(found <= bound + 1e-11, "{found} > {bound}");
    }

    /// An ideal machine brings its tip to the same place with other angles; what is commanded for it is no error.
    #[test]
    fn the_same_tip_with_other_angles_is_no_error(
        seed: u64, chain in 0usize..5, slip in 0.0f64..1.0,
    ) {
        let mut random = Random::new(seed);
        let mut ideal = perfect(CHAINS[chain]);
        ideal.rotary.iter_mut().for_each(|rotary| rotary.centre_mm = random.vector(100.0));
        let model = RigidBody::new(ideal).unwrap();
        let (linear_mm, programmed_rad) = (Vector::new(200.0, 140.0, 100.0), random.vector(3.0));
        let state = Command {
            rotary_rad: programmed_rad + random.vector(slip * 1e-3), ..command([0.0; 3], random.vector(100.0).into())
        };
        let there = model.same_tip_mm(&linear_mm, &state, &programmed_rad);
        let error = model.error_from_mm(&Command { linear_mm: there, ..state }, &programmed_rad);
        // As the programmed machine's linear axes see it: it stands aside by as much as it has to be told.
        prop_assert!((there + error - linear_mm).norm() < 1e-9, "{}", there + error - linear_mm);
        let tilt_rad = model.tilt_rad(&Command { linear_mm, ..state });
        prop_assert!(tilt_rad < 1e-12);
    }
}

/// How much larger the bound is than what dense sampling finds.
#[test]
fn the_bound_is_not_far_from_the_truth() {
    let mut random = Random::new(3);
    let mut ratios: Vec<f64> = (0..300)
        .map(|seed| {
            let model = crooked(seed, CHAINS[seed as usize % 5], seed % 2 == 0);
            let way = way(&model, &mut random, 4.0, 0.05, 0.0);
            way.bound_mm() / way.leaves_mm(400)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    println!("median {:.2}, 90 % {:.2}", ratios[150], ratios[270]);
    assert!(ratios[150] < 4.0, "{}", ratios[150]);
}

/// The same under tip control, where it is finite: a stretch of 4 mm on which the table turns by 3 degrees.
#[test]
fn the_bound_under_tip_control_is_not_far_either() {
    let mut random = Random::new(3);
    let mut ratios: Vec<f64> = (0..300)
        .map(|seed| {
            let machine = without_play(seed, CHAINS[seed as usize % 5], seed % 2 == 0);
            let centres = machine.description().rotary.each_ref().map(|axis| axis.centre_mm);
            let model = TipControl::new(&machine, centres).unwrap();
            let angles = random.vector(3.0);
            let turn = commanded([angles, angles + random.vector(0.05)], [Vector::zeros(); 2]);
            let axes =
                Command { rotary_rad: angles, ..command([200.0, 140.0, 100.0], random.vector(60.0).into()) };
            let from = model.tip_command(&axes).linear_mm;
            let linear_mm = [from, from + random.vector(4.0)];
            let way = Way { model: &model, linear_mm, turn, state: axes };
            way.bound_mm() / way.leaves_mm(400)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    println!("median {:.2}, 90 % {:.2}", ratios[150], ratios[270]);
    assert!(ratios[150] < 15.0, "{}", ratios[150]);
}

/// A table leaning by 300 µrad about Y: the tool leans the other way, whatever the table's own angle about X is but for
/// what turns the axis of leaning away.
#[test]
fn a_leaning_table_tilts_the_tool() {
    let mut leaning = perfect("[w C A X Y b Z t]");
    leaning.rotary[0].tilt_rad = Vector::new(0.0, 3e-4, 0.0);
    let model = RigidBody::new(leaning).unwrap();
    for angle in [0.0, 0.7, -1.2] {
        let mut at = command([10.0, 20.0, 30.0], [0.0, 0.0, -100.0]);
        at.rotary_rad = Vector::new(angle, 0.0, 1.0);
        assert!((model.tilt_rad(&at) - 3e-4).abs() < 1e-9, "{}", model.tilt_rad(&at));
    }
    let [ideal, real] = model.directions(&command([0.0; 3], [0.0, 0.0, -100.0]));
    assert_eq!(ideal, Vector::z());
    assert!((real - Vector::new(-3e-4, 0.0, 1.0)).norm() < 1e-7, "{real}");
}
