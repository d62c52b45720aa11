//! Effects in the machine model: proven bounds, the inverse, frames, conditions.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use crate::machines;

use machine_model::effects::{Conditions, EffectGeometry, EffectKind, EffectTerm, MissingCondition, Shape};
use machine_model::{
    Chain, Command, Engine, LANES, Move, PathModel, Range, RigidBody, RotaryAxis, UnknownCondition, Vector,
    WithEffects,
};
use machines::{Random, TRAVEL_MM, command, machine, perfect};
use units::math;

const KNOWN: Conditions = Conditions {
    temp_c: [Some(27.0), Some(24.0), Some(22.0)],
    time_s: Some(900.0),
    load_kg: Some(40.0),
    feed_mm_min: Some(1500.0),
    share: None,
    since_turn_mm: [Some(2.0), Some(40.0), None],
    curvature_per_mm: Some([0.004, -0.003, 0.0]),
    station_mm: Some([900.0, -700.0, 100.0]),
};

const CHAINS: [&str; 3] = ["[w X Y b Z t]", "[w C A Y X b Z t]", "[w b Z X Y B t]"];

/// A term with every coefficient and random shape; some micrometres, some microradians.
///
/// `beyond`: commands may lie far outside the interval of its polynomials.
fn term(kind: EffectKind, random: &mut Random, chain: &str, beyond: bool) -> EffectTerm {
    let centre = if beyond { 150.0 + random.number(100.0) } else { 200.0 };
    let half = if beyond { 120.0 + random.number(100.0) } else { 200.0 };
    let shape = Shape {
        from_mm: centre - half,
        to_mm: centre + half,
        pitch_mm: 10.0 + random.number(6.0),
        tau_s: 600.0,
        tau2_s: 3000.0,
        time_s: 500.0,
        centre_mm: centre,
        width_mm: 40.0 + random.number(30.0),
    };
    let coefficients: Vec<f64> = kind.coefficient_names().iter().map(|_| random.number(8.0)).collect();
    let mut geometry = EffectGeometry::from_chain(&Chain::parse(chain).unwrap());
    geometry.rotary_centre_mm = [random.vector(50.0), random.vector(50.0), random.vector(50.0)];
    EffectTerm::new(kind, shape, &coefficients, geometry)
}

/// A stretch of the machine's space and its positions, sampled: a line, or a helix.
fn stretch(random: &mut Random, arc: bool) -> (Vec<[f64; 3]>, Move) {
    let length = math::exp(random.number(3.0) - 3.0);
    let start: [f64; 3] = std::array::from_fn(|i| TRAVEL_MM[i] * (0.5 + random.number(0.3)));
    let by: [f64; 3] = std::array::from_fn(|i| TRAVEL_MM[i] * random.number(0.18) * length.min(1.0));
    let sweep = 2.0;
    let samples: Vec<[f64; 3]> = (0..=1000)
        .map(|i| {
            let s = f64::from(i) / 1000.0;
            if arc {
                let (sin, cos) = math::sin_cos(sweep * s);
                [start[0] + by[0] * cos, start[1] + by[0] * sin, start[2] + by[2] * s]
            } else {
                std::array::from_fn(|k| start[k] + by[k] * s)
            }
        })
        .collect();
    let slack = if arc { by[0].abs() * 1e-5 } else { 0.0 };
    let range_mm = std::array::from_fn(|k| Range {
        low: samples.iter().map(|q| q[k]).fold(f64::INFINITY, f64::min) - slack,
        high: samples.iter().map(|q| q[k]).fold(f64::NEG_INFINITY, f64::max) + slack,
    });
    let r = by[0].abs();
    let (speed_mm, acceleration_mm) = if arc {
        ([r * sweep, r * sweep, by[2].abs()], [r * sweep * sweep, r * sweep * sweep, 0.0])
    } else {
        (by.map(f64::abs), [0.0; 3])
    };
    let mut state = command([0.0; 3], random.vector(150.0).into());
    state.rotary_rad = random.vector(1.5);
    state.direction = std::array::from_fn(|_| random.number(1.5) as i8);
    (
        samples,
        Move { range_mm, speed_mm, acceleration_mm, passes: if arc { 2 } else { 1 }, state, turn: None },
    )
}

/// Largest distance of sampled values from their chord.
fn leaves_chord(values: &[Vector]) -> f64 {
    let (first, last) = (values[0], values[values.len() - 1]);
    let n = (values.len() - 1) as f64;
    values
        .iter()
        .enumerate()
        .map(|(i, e)| (e - first * (1.0 - i as f64 / n) - last * (i as f64 / n)).norm())
        .fold(0.0, f64::max)
}

#[test]
fn no_effect_leaves_its_chord_by_more_than_its_bound() {
    let mut random = Random::new(77);
    // A tracker's faults are never corrected, and so not bounded.
    for kind in EffectKind::all().into_iter().filter(|kind| kind.family() != "tracker") {
        let (mut largest, mut ratio) = (0.0_f64, f64::INFINITY);
        for round in 0..60 {
            let term = term(kind, &mut random, CHAINS[round % 3], true);
            let (samples, stretch) = stretch(&mut random, round % 2 == 1);
            let values: Vec<Vector> = samples
                .iter()
                .map(|q| {
                    let at = Command { linear_mm: (*q).into(), ..stretch.state };
                    term.displacement_mm(&at, &KNOWN).unwrap()
                })
                .collect();
            let (found, bound) = (leaves_chord(&values), term.chord_bound_mm(&stretch, &KNOWN));
            assert!(found <= bound + 1e-13, "{kind}: {found:e} > {bound:e}");
            largest = largest.max(found);
            if found > 1e-9 {
                ratio = ratio.min(bound / found);
            }
        }
        // A bound that is never near is no help: somewhere in sixty stretches it is within a factor of four.
        assert!(largest < 1e-9 || ratio < 4.0, "{kind}: {ratio}");
    }
}

#[test]
fn a_machine_with_all_effects_is_bounded_and_inverted() {
    let mut random = Random::new(3);
    for (round, chain) in CHAINS.iter().cycle().take(24).enumerate() {
        let base = RigidBody::new(machine(round as u64, chain, round % 2 == 0, 1.0)).unwrap();
        let terms: Vec<EffectTerm> = EffectKind::all()
            .into_iter()
            .filter(|kind| !kind.is_instrument())
            .map(|kind| term(kind, &mut random, chain, false))
            .collect();
        let model = WithEffects::new(base, terms, KNOWN).unwrap();
        assert!(model.depends_on_direction());
        let (samples, stretch) = stretch(&mut random, round % 3 == 0);
        let at = |q: &[f64; 3]| Command { linear_mm: (*q).into(), ..stretch.state };
        let values: Vec<Vector> = samples.iter().map(|q| model.error_mm(&at(q))).collect();
        let (found, bound) = (leaves_chord(&values), model.chord_bound_mm(&stretch));
        assert!(found <= bound + 1e-12 && bound.is_finite(), "{found:e} > {bound:e}");
        // What is solved for is where the machine then goes.
        let target = at(&samples[500]);
        let solution = model.solve(&target).unwrap();
        let reached = model.predict(&Command { linear_mm: solution.linear_mm, ..target }).position_mm;
        let there = model.predict(&target);
        assert!((reached - (there.position_mm - there.error_mm)).norm() < 1e-9, "{reached}");
    }
}

/// What is said of the whole volume holds for each stretch, and places solved together are those solved alone, bit for bit.
#[test]
fn what_holds_everywhere_holds_for_each_effect() {
    let mut random = Random::new(19);
    let kinds =
        EffectKind::all().into_iter().filter(|kind| !kind.is_instrument() && !kind.depends_on_direction());
    for kind in kinds {
        for round in 0..24 {
            let chain = CHAINS[round % 2];
            let mut description = machine(round as u64, chain, round % 2 == 0, 1.0);
            for axis in &mut description.linear {
                (axis.errors_negative, axis.backlash_mm) = (None, 0.0);
            }
            description.rotary.iter_mut().for_each(|axis| *axis = RotaryAxis::perfect(axis.centre_mm));
            let base = RigidBody::new(description).unwrap();
            let model =
                WithEffects::new(base.clone(), vec![term(kind, &mut random, chain, true)], KNOWN).unwrap();
            let (samples, stretch) = stretch(&mut random, false);
            let [alone, everywhere] = [base.everywhere(&stretch.state), model.everywhere(&stretch.state)];
            let (alone, everywhere) = (alone.unwrap(), everywhere.unwrap());
            let at = |q: &[f64; 3]| Command { linear_mm: (*q).into(), ..stretch.state };
            let own = |q: &[f64; 3]| model.error_mm(&at(q)) - base.error_mm(&at(q));
            let values: Vec<Vector> = samples.iter().map(own).collect();
            let longest = stretch.speed_mm.into_iter().fold(0.0, f64::max);
            let bow = everywhere.chord_bound_mm(longest) - alone.chord_bound_mm(longest);
            // Infinite less infinite says nothing: long stretches.
            assert!(bow.is_nan() || leaves_chord(&values) <= bow + 1e-12, "{kind}: {bow:e}");
            let length = (Vector::from(samples[1]) - Vector::from(samples[0])).norm();
            let steep = values.windows(2).map(|pair| (pair[1] - pair[0]).norm() / length).fold(0.0, f64::max);
            let of_effect = everywhere.gradient - alone.gradient;
            // More would be no help: what a command is rounded by is multiplied by it.
            assert!(steep <= of_effect + 1e-9 && of_effect < 0.2, "{kind}: {steep:e} > {of_effect:e}");
            let targets = [0, 300, 600, 1000].map(|k| samples[k]);
            let directions = [stretch.state.direction; LANES];
            let [x, y, z] = model.commands_for(&targets, &directions, &stretch.state, &everywhere).unwrap();
            for (lane, target) in targets.iter().enumerate() {
                let one = model.solve(&at(target)).unwrap().linear_mm;
                assert_eq!(
                    [x[lane], y[lane], z[lane]].map(f64::to_bits),
                    [one.x, one.y, one.z].map(f64::to_bits)
                );
            }
        }
    }
}

/// Where the table turns, an effect of a linear axis turns with the workpiece, one of the table does not.
#[test]
fn effects_act_where_they_arise() {
    let chain = "[w C X Y b Z t]";
    let base = RigidBody::new(perfect(chain)).unwrap();
    let geometry = EffectGeometry::from_chain(&Chain::parse(chain).unwrap());
    let mut at = command([100.0, 20.0, 30.0], [0.0; 3]);
    at.rotary_rad.z = std::f64::consts::FRAC_PI_2;
    let one = |kind: EffectKind| EffectTerm::new(kind, Shape::default(), &[10.0], geometry.clone());
    let scale = WithEffects::new(base.clone(), vec![one(EffectKind::Scale(0))], KNOWN).unwrap();
    assert!((scale.error_mm(&at) - Vector::new(0.001, 0.0, 0.0)).norm() < 1e-15);
    assert!((scale.predict(&at).error_mm - Vector::new(0.0, -0.001, 0.0)).norm() < 1e-15);
    let kind = EffectKind::Rotary { component: 0, axis: 2 };
    let shifted = WithEffects::new(base, vec![one(kind)], KNOWN).unwrap();
    let seen = one(kind).displacement_mm(&at, &KNOWN).unwrap();
    assert!(
        (seen - Vector::new(0.0, 0.01, 0.0)).norm() < 1e-15,
        "what the table carries is displaced: {seen}"
    );
    assert!((shifted.predict(&at).error_mm - seen).norm() < 1e-15, "as the workpiece sees it");
}

#[test]
fn a_condition_that_nobody_gave_is_named() {
    let base = RigidBody::new(perfect(CHAINS[0])).unwrap();
    let mut random = Random::new(1);
    let needs = [
        (EffectKind::Thermal(1), "temperature"),
        (EffectKind::Warmup(2), "time"),
        (EffectKind::Step(0), "time"),
        (EffectKind::Load(2), "load"),
        (EffectKind::ServoLag(0), "feed"),
        (EffectKind::ServoMismatch(0, 1), "feed"),
        (EffectKind::Contraction, "feed"),
    ];
    for kind in EffectKind::all().into_iter().filter(|kind| !kind.is_instrument()) {
        let term = term(kind, &mut random, CHAINS[0], false);
        let made = WithEffects::new(base.clone(), vec![term], Conditions::default());
        match needs.iter().find(|(needy, _)| needy.family() == kind.family()) {
            Some((_, what)) => {
                let expected = UnknownCondition { effect: kind, condition: MissingCondition(what) };
                assert_eq!(made.unwrap_err(), expected);
            }
            None => assert!(made.is_ok(), "{kind}"),
        }
    }
}
