//! Budgets of machines whose figures can be computed by hand.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

use error_budget::mending::shortest;
use error_budget::tolerances::{Figure, equal_influence};
use error_budget::{Budget, Criteria, Field, Machine, Unit, root_sum_of_squares, worst_case};
use machine_model::effects::{Conditions, EffectTerm};
use machine_model::{
    AxisTables, Chain, Command, Description, Interpolation, LinearAxis, PathModel, Range, RigidBody,
    RotaryAxis, Squareness, Table, Vector, WithEffects,
};
use proptest::prelude::*;

/// Perfect, ± 400 mm.
fn perfect(chain: &str) -> Description {
    let axis = || LinearAxis::perfect(Range { low: -400.0, high: 400.0 });
    let rotary = || RotaryAxis::perfect(Vector::zeros());
    Description {
        chain: Chain::parse(chain).unwrap(),
        linear: [axis(), axis(), axis()],
        rotary: [rotary(), rotary(), rotary()],
        squareness: Squareness::default(),
    }
}

fn machine(description: Description, effects: &[(&str, &[(&str, f64)])]) -> Machine {
    let term = |(id, parameters): &(&str, &[(&str, f64)])| {
        let owned: Vec<_> = parameters.iter().map(|(name, v)| ((*name).to_owned(), *v)).collect();
        EffectTerm::from_entry(id, &owned).unwrap()
    };
    let base = RigidBody::new(description).unwrap();
    let terms = effects.iter().map(term).collect();
    Machine::new(WithEffects::new(base, terms, Conditions::default()).unwrap())
}

/// A function of an axis on two nodes over its travel, all others zero.
fn line(function: usize, low: f64, high: f64) -> AxisTables {
    let mut tables = [const { None }; 6];
    let values = vec![low, high];
    tables[function] = Some(Table::new(vec![-400.0, 400.0], values, Interpolation::Linear).unwrap());
    AxisTables::new(&tables).unwrap()
}

fn at(x: f64, y: f64, z: f64, tool_mm: Vector) -> Command {
    Command { linear_mm: Vector::new(x, y, z), tool_mm, ..Default::default() }
}

fn evaluate(commands: &[Command]) -> impl Fn(&WithEffects) -> Vec<Vector> + Copy + '_ {
    |model| commands.iter().map(|command| model.error_mm(command)).collect()
}

fn names(machine: &Machine) -> Vec<&str> {
    machine.deviations().iter().map(|deviation| deviation.name.as_str()).collect()
}

const SECOND_OF_ARC: f64 = std::f64::consts::PI / 180.0 / 3600.0;

#[test]
fn one_squareness() {
    let mut description = perfect("[w X Y b Z t]");
    description.squareness.ec0y_rad = -200e-6;
    let machine = machine(description, &[]);
    assert_eq!(names(&machine), ["EC0Y"]);
    assert_eq!((machine.deviations()[0].size, machine.deviations()[0].unit), (200e-6, Unit::Angle));
    // |d| = 200 µrad · |y|: 10, 40 and 80 µm.
    let commands = [50.0, -200.0, 400.0].map(|y| at(10.0, y, 5.0, Vector::zeros()));
    let budget = Budget::new(&machine, evaluate(&commands)).unwrap();
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    close(budget.measured.largest_mm, 0.080);
    assert_eq!(budget.measured.largest_at, 2);
    close(budget.measured.spread_mm(), 0.070);
    close(budget.measured.rms_mm, ((0.01_f64.powi(2) + 0.04_f64.powi(2) + 0.08_f64.powi(2)) / 3.0).sqrt());
    let item = &budget.items[0];
    assert_eq!(item.without.largest_mm, 0.0);
    assert_eq!(item.alone, budget.measured);
    // Alone, and linear: each criterion is its own derivative.
    close(item.largest_slope_mm.left, 0.080);
    close(item.largest_slope_mm.right, 0.080);
    close(item.spread_slope_mm.right, 0.070);
    close(item.rms_slope_mm, budget.measured.rms_mm);
    close(worst_case(&budget.field).mm, 0.080);
    assert_eq!(root_sum_of_squares(&budget.field).1, 2);
    close(budget.remainder_mm, 0.0);
}

/// The check of Serkov 2017: squareness of ± 100″ alone draws, on a circle of R = 150 mm, the ellipse at 45° of a
/// circularity plot: `Δr = -EC0Y R/2 sin 2φ`.
#[test]
fn squareness_alone_is_the_ellipse_at_45_degrees() {
    const R: f64 = 150.0;
    let size = 100.0 * SECOND_OF_ARC;
    let mut description = perfect("[w X Y b Z t]");
    description.squareness.ec0y_rad = size;
    let machine = machine(description, &[]);
    let degrees: Vec<f64> = (0..360).map(f64::from).collect();
    let round: Vec<Command> = degrees
        .iter()
        .map(|deg| {
            let (sin, cos) = units::math::sin_cos(deg.to_radians());
            at(R * cos, R * sin, 0.0, Vector::zeros())
        })
        .collect();
    for sign in [1.0, -1.0] {
        let errors = evaluate(&round)(&machine.scaled(&[sign]));
        let radial: Vec<f64> = errors.iter().zip(&round).map(|(d, c)| d.dot(&c.linear_mm) / R).collect();
        for (radial, deg) in radial.iter().zip(&degrees) {
            let expected = -sign * size * R / 2.0 * units::math::sin(2.0 * deg.to_radians());
            assert!((radial - expected).abs() < 1e-15, "{deg}: {radial} {expected}");
        }
        let largest = (0..360).reduce(|a, b| if radial[b] > radial[a] + 1e-12 { b } else { a });
        assert_eq!(largest, Some(if sign > 0.0 { 135 } else { 45 }), "the long axis of the ellipse");
        // 100″ · 75 mm.
        assert!((radial[largest.unwrap()] - 0.036_361).abs() < 1e-6);
    }
    let budget = Budget::new(&machine, evaluate(&round)).unwrap();
    // M is where y is largest, at 90°: 100″ · 150 mm.
    assert_eq!(budget.measured.largest_at, 90);
    assert!((budget.measured.largest_mm - 0.072_722).abs() < 1e-6);
}

/// Abbe: an angle times the tool, and nothing without it.
#[test]
fn an_angle_acts_by_its_arm() {
    let mut description = perfect("[w X Y b Z t]");
    description.linear[0].errors = Some(line(4, -50e-6, 20e-6));
    let machine = machine(description, &[]);
    assert_eq!(names(&machine), ["EBX"]);
    assert_eq!(machine.deviations()[0].size, 50e-6);
    let with = |tool: Vector| {
        let commands = [-400.0, 400.0].map(|x| at(x, 0.0, 0.0, tool));
        Budget::new(&machine, evaluate(&commands)).unwrap()
    };
    // A turn by EBX moves the end of 120 mm by a chord, 2 L sin(ε/2): 6 µm at -400, 2.4 µm at 400.
    let budget = with(Vector::new(0.0, 0.0, -120.0));
    let chord = |angle: f64| 240.0 * units::math::sin(angle / 2.0);
    assert!((budget.measured.largest_mm - chord(50e-6)).abs() < 1e-15);
    assert!((budget.measured.spread_mm() - (chord(50e-6) - chord(20e-6))).abs() < 1e-15);
    assert!((budget.measured.largest_mm - 0.006).abs() < 1e-10);
    // The arm of EBX is square to Y: a tool along Y is not moved.
    assert_eq!(with(Vector::new(0.0, 90.0, 0.0)).measured.largest_mm, 0.0);
    // Of the size alone it is known that it may be 50 µrad at both ends.
    let sized = machine.at_its_sizes();
    let commands = [-400.0, 400.0].map(|x| at(x, 0.0, 0.0, Vector::new(0.0, 0.0, -120.0)));
    let found = Criteria::of(&evaluate(&commands)(sized.model())).unwrap();
    assert!((found.smallest_mm - chord(50e-6)).abs() < 1e-15);
}

/// Where two points hold the maximum, a coefficient pulls at one of them from either side.
#[test]
fn derivatives_of_a_maximum_have_two_sides() {
    let mut description = perfect("[w X Y b Z t]");
    description.linear[0].errors = Some(line(0, 10e-3, 10e-3));
    description.squareness.ec0y_rad = -10e-6;
    let machine = machine(description, &[]);
    // d = 10 µm + 10 µrad · y: 14 µm at both of the first two (z takes no part), 6 µm at the third.
    let commands = [at(0.0, 400.0, 0.0, Vector::zeros()), at(0.0, 400.0, 9.0, Vector::zeros())];
    let budget = Budget::new(&machine, evaluate(&commands)).unwrap();
    let ec0y = budget.items.iter().find(|item| item.deviation == 1).unwrap();
    assert!((ec0y.largest_slope_mm.left - 4e-3).abs() < 1e-15);
    assert_eq!(ec0y.largest_slope_mm.left, ec0y.largest_slope_mm.right);
    // Where the smallest |d| is 0 it grows to both sides: 20 µm at one end, none at the other, and all of EXX moves both.
    let mut description = perfect("[w X Y b Z t]");
    description.linear[0].errors = Some(line(0, 10e-3, 10e-3));
    description.squareness.ec0y_rad = 25e-6;
    let machine = self::machine(description, &[]);
    let ends = [-400.0, 400.0].map(|y| at(0.0, y, 0.0, Vector::zeros()));
    let budget = Budget::new(&machine, evaluate(&ends)).unwrap();
    let exx = budget.items.iter().find(|item| item.deviation == 0).unwrap();
    assert!((budget.measured.spread_mm() - 20e-3).abs() < 1e-15);
    assert!((exx.largest_slope_mm.left - 10e-3).abs() < 1e-15);
    assert!((exx.spread_slope_mm.left - 20e-3).abs() < 1e-15, "{exx:?}");
    assert!(exx.spread_slope_mm.right.abs() < 1e-15, "{exx:?}");
    // Squareness alone has its maximum at both ends; of a straightness added, one end grows and one shrinks.
    let mut description = perfect("[w X Y b Z t]");
    description.squareness.ec0y_rad = -10e-6;
    description.linear[0].errors = Some(line(0, 1e-12, 1e-12));
    let machine = self::machine(description, &[]);
    let ends = [-400.0, 400.0].map(|y| at(0.0, y, 0.0, Vector::zeros()));
    let budget = Budget::new(&machine, evaluate(&ends)).unwrap();
    let exx = budget.items.iter().find(|item| item.deviation == 0).unwrap();
    assert!((exx.largest_slope_mm.left + 1e-12).abs() < 1e-16, "{exx:?}");
    assert!((exx.largest_slope_mm.right - 1e-12).abs() < 1e-16, "{exx:?}");
    // Both ends hold the minimum as well: A does not change to first order on either side, but for both.
    assert!((exx.spread_slope_mm.right - 2e-12).abs() < 1e-16, "{exx:?}");
}

/// A machine with everything: all functions of all axes, squareness, a rotary table and a head, two effects.
fn everything(scale: f64) -> Machine {
    let mut description = perfect("[w C X Y b Z B t]");
    let mut number = 0.0_f64;
    let mut next = |by: f64| {
        number += 1.0;
        by * scale * units::math::sin(number)
    };
    for axis in &mut description.linear {
        let mut tables = [const { None }; 6];
        for (function, table) in tables.iter_mut().enumerate() {
            let by = if function < 3 { 20e-3 } else { 100e-6 };
            let values = (0..3).map(|_| next(by)).collect();
            *table = Some(Table::new(vec![-400.0, 30.0, 400.0], values, Interpolation::Monotone).unwrap());
        }
        axis.errors = AxisTables::new(&tables);
    }
    for (axis, shift, tilt) in [(1, [1.0, 0.0, 1.0], [1.0, 0.0, 1.0]), (2, [1.0, 1.0, 0.0], [1.0, 1.0, 0.0])]
    {
        let rotary = &mut description.rotary[axis];
        rotary.shift_mm = Vector::from(shift.map(|v: f64| v * next(30e-3)));
        rotary.tilt_rad = Vector::from(tilt.map(|v: f64| v * next(80e-6)));
        let values: [f64; 6] = std::array::from_fn(|f| next(if f < 3 { 5e-3 } else { 30e-6 }));
        rotary.errors = Some(AxisTables::constant(Range { low: -4.0, high: 4.0 }, values));
    }
    description.squareness =
        Squareness { ec0y_rad: next(90e-6), eb0z_rad: next(90e-6), ea0z_rad: next(90e-6) };
    let scale_x = 40.0 * scale;
    machine(
        description,
        &[("scale.X", &[("scale_um_per_m", scale_x)]), ("backlash.Y", &[("half_width_um", 6.0 * scale)])],
    )
}

/// Points all over the volume and over the angles, some of Serkov's kind: the ball goes round with the table.
fn all_over() -> Vec<Command> {
    let mut commands = Vec::new();
    for i in 0..60 {
        let of = |by: f64| units::math::sin(f64::from(i) * by);
        commands.push(Command {
            linear_mm: Vector::new(390.0 * of(1.1), 380.0 * of(2.3), 370.0 * of(3.7)),
            rotary_rad: Vector::new(0.0, 1.5 * of(0.7), f64::from(i % 12) * 30.0_f64.to_radians() - 3.0),
            tool_mm: Vector::new(0.0, 0.0, -120.0),
            direction: [1, if i % 2 == 0 { 1 } else { -1 }, 0],
            ..Default::default()
        });
    }
    commands
}

#[test]
fn five_axes_add_up_to_second_order() {
    let commands = all_over();
    let of = |scale: f64| Budget::new(&everything(scale), evaluate(&commands)).unwrap();
    let machine = everything(1.0);
    for name in ["EXX", "ECZ", "ECC", "EAB", "EX0B", "EZ0B", "EX0C", "EB0C", "EA0Z", "scale.X", "backlash.Y"]
    {
        assert!(names(&machine).contains(&name), "{:?}", names(&machine));
    }
    assert_eq!(machine.deviations().len(), 5 * 6 + 8 + 3 + 2, "Serkov's 41, and two effects");
    let (whole, half) = (of(1.0), of(0.5));
    // Euler: the derivatives add up to M but for what is of second order; that goes with the square of the scale.
    let left = |budget: &Budget| (budget.sum_of_slopes_mm() - budget.measured.largest_mm).abs();
    assert!(
        left(&whole) < 1e-3 * whole.measured.largest_mm,
        "{} {}",
        left(&whole),
        whole.measured.largest_mm
    );
    assert!(left(&whole) > 1e-7, "a machine without second order would prove nothing: {}", left(&whole));
    assert!((left(&whole) / left(&half) - 4.0).abs() < 0.1, "{} {}", left(&whole), left(&half));
    assert!((whole.remainder_mm / half.remainder_mm - 4.0).abs() < 0.1);
    let rms: f64 = whole.items.iter().map(|item| item.rms_slope_mm).sum();
    assert!((rms / whole.measured.rms_mm - 1.0).abs() < 1e-3);
    // Derivatives are those of the criteria: a difference quotient over a thousandth.
    for item in &whole.items {
        let m = |by: f64| {
            let mut coefficients = vec![1.0; machine.deviations().len()];
            coefficients[item.deviation] = by;
            Criteria::of(&evaluate(&commands)(&machine.scaled(&coefficients))).unwrap()
        };
        let (more, less) = (m(1.0005), m(0.9995));
        let quotient = |of: fn(&Criteria) -> f64| (of(&more) - of(&less)) / 1e-3;
        assert!((quotient(|c| c.largest_mm) - item.largest_slope_mm.right).abs() < 1e-8, "{item:?}");
        assert!((quotient(Criteria::spread_mm) - item.spread_slope_mm.right).abs() < 1e-8, "{item:?}");
        assert!((quotient(|c| c.rms_mm) - item.rms_slope_mm).abs() < 1e-8, "{item:?}");
    }
}

/// Tables of both directions are one function: its size is the larger one, its coefficient multiplies both.
#[test]
fn both_directions_belong_to_one_function() {
    let mut description = perfect("[w X Y b Z t]");
    description.linear[1].errors = Some(line(1, 2e-3, 6e-3));
    description.linear[1].errors_negative = Some(line(1, -9e-3, 4e-3));
    let local: &[(&str, f64)] = &[("centre_mm", 5.0), ("width_mm", 2.0), ("x_um", 2.0), ("y_um", 1.0)];
    let machine = machine(description, &[("local.X", local), ("local.X", local)]);
    assert_eq!(names(&machine), ["EYY", "local.X", "local.X#2"]);
    assert_eq!(machine.deviations()[0].size, 9e-3);
    assert_eq!(machine.deviations()[1].unit, Unit::Whole);
    let from =
        |direction: i8| Command { direction: [0, direction, 0], ..at(300.0, -400.0, 0.0, Vector::zeros()) };
    let commands = [from(1), from(-1)];
    let twice = evaluate(&commands)(&machine.scaled(&[2.0, 0.0, 0.0]));
    assert!((twice[0].y - 4e-3).abs() < 1e-15 && (twice[1].y + 18e-3).abs() < 1e-15, "{twice:?}");
    let sized = evaluate(&commands)(&machine.at_its_sizes().scaled(&[1.0, 0.0, 0.0]));
    assert!(sized.iter().all(|d| (d.y - 9e-3).abs() < 1e-15), "{sized:?}");
}

#[test]
fn a_displaced_table_axis_displaces_as_much_at_every_angle() {
    let mut description = perfect("[w C X Y b Z t]");
    description.rotary[2].shift_mm.x = 0.010;
    let machine = machine(description, &[]);
    assert_eq!(names(&machine), ["EX0C"]);
    let commands: Vec<Command> = (0..12)
        .map(|i| Command {
            rotary_rad: Vector::new(0.0, 0.0, f64::from(i) * 30.0_f64.to_radians()),
            ..at(120.0, 0.0, 50.0, Vector::zeros())
        })
        .collect();
    let budget = Budget::new(&machine, evaluate(&commands)).unwrap();
    assert!((budget.measured.largest_mm - 0.010).abs() < 1e-12);
    assert!(budget.measured.spread_mm() < 1e-12);
}

#[test]
fn the_shortest_list_is_the_shortest_of_all_sets() {
    let machine = everything(1.0);
    let commands = all_over();
    let budget = Budget::new(&machine, evaluate(&commands)).unwrap();
    let count = machine.deviations().len();
    // All but nine stay as they are, so that all 512 sets can be tried.
    let free = [0, 4, 9, 16, 22, 30, 33, 38, 40];
    let keep: Vec<bool> = (0..count).map(|deviation| !free.contains(&deviation)).collect();
    let m_of = |set: usize| {
        let of = |d: usize| {
            free.iter().position(|f| *f == d).map_or(1.0, |k| 1.0 - f64::from((set >> k & 1) as u8))
        };
        let coefficients: Vec<f64> = (0..count).map(of).collect();
        Criteria::of(&evaluate(&commands)(&machine.scaled(&coefficients))).unwrap().largest_mm
    };
    let every: Vec<(u32, f64)> = (0..512_usize).map(|set| (set.count_ones(), m_of(set))).collect();
    let best = every.iter().map(|(_, m)| *m).fold(f64::INFINITY, f64::min);
    let mut lengths = Vec::new();
    for share in [0.999, 0.9, 0.7, 0.4, 0.1, 0.02] {
        let target = best + share * (budget.measured.largest_mm - best);
        let found = shortest(&machine, &budget, &keep, target, evaluate(&commands));
        let least = every.iter().filter(|(_, m)| *m <= target).map(|(length, _)| *length).min().unwrap();
        assert!(found.proven);
        let steps = found.steps.unwrap();
        assert_eq!(steps.len(), least as usize, "{target}");
        let reached = steps.last().unwrap().1;
        let smallest = every.iter().filter(|(length, _)| *length == least).map(|(_, m)| *m);
        let smallest = smallest.fold(f64::INFINITY, f64::min);
        assert!(reached <= target && reached - smallest < 1e-4 * smallest, "{reached} {smallest}");
        lengths.push(least);
    }
    assert!(lengths[0] == 1 && lengths[5] > 3, "{lengths:?}");
    let none = shortest(&machine, &budget, &keep, 0.9 * best, evaluate(&commands));
    assert_eq!((none.steps, none.proven), (None, true));
    let nothing = shortest(&machine, &budget, &keep, budget.measured.largest_mm, evaluate(&commands));
    assert_eq!(nothing.steps, Some(vec![]));
    // A target below the second order of the sums: nothing less than everything.
    let free = vec![false; count];
    let all = shortest(&machine, &budget, &free, 1e-9, evaluate(&commands)).steps.unwrap();
    assert!(all.len() == count && all[count - 1].1 < 1e-12, "{all:?}");
}

fn sized(machine: &Machine, commands: &[Command]) -> (Machine, Field) {
    let sized = machine.at_its_sizes();
    let count = machine.deviations().len();
    let alone = |deviation: usize| {
        let coefficients: Vec<f64> = (0..count).map(|d| if d == deviation { 1.0 } else { 0.0 }).collect();
        evaluate(commands)(&sized.scaled(&coefficients))
    };
    let contributions_mm = (0..count).map(alone).collect();
    (sized, Field { contributions_mm })
}

#[test]
fn tolerances_hold_the_target_and_bring_as_much_each() {
    let machine = everything(1.0);
    let commands = all_over();
    let (sized, field) = sized(&machine, &commands);
    let count = machine.deviations().len();
    let one = |model: &WithEffects, point: usize| model.error_mm(&commands[point]);
    let set = |keep: &[bool], target: f64, figure| {
        equal_influence(&sized, &field, keep, target, figure, one, evaluate(&commands))
    };
    let free = vec![false; count];
    for (figure, target) in [(Figure::WorstCase, 0.050), (Figure::Statistical, 0.050)] {
        let found = set(&free, target, figure).unwrap();
        assert!(found.whole_model_mm <= target && found.figure_mm > 0.999 * target, "{found:?}");
        for (factor, largest) in found.factors.iter().zip(field.largest_mm()) {
            let brings = factor.unwrap() * largest;
            assert!((brings / found.influence_mm - 1.0).abs() < 1e-12);
        }
        let factors: Vec<f64> = found.factors.iter().map(|f| f.unwrap()).collect();
        let scaled = field.scaled(&factors);
        let expected = match figure {
            Figure::WorstCase => worst_case(&scaled).mm,
            Figure::Statistical => root_sum_of_squares(&scaled).0,
        };
        assert!((found.figure_mm - expected).abs() < 1e-12);
    }
    let [worst, statistical] = [Figure::WorstCase, Figure::Statistical]
        .map(|figure| set(&free, 0.050, figure).unwrap().influence_mm);
    assert!(statistical > 2.0 * worst, "the looser set: {statistical} {worst}");
    // The first two stay: the others get less, and together all of it.
    let mut keep = free;
    keep[0] = true;
    keep[1] = true;
    for figure in [Figure::WorstCase, Figure::Statistical] {
        let found = set(&keep, 0.050, figure).unwrap();
        assert_eq!(found.factors[..2], [Some(1.0), Some(1.0)]);
        assert!(found.whole_model_mm <= 0.050 && found.figure_mm > 0.999 * 0.050, "{found:?}");
        assert!(set(&keep, 0.001, figure).is_none(), "what is kept is more than that");
    }
}

/// An angle with next to no arm would need a turn to bring its share: it gets 0.01 rad and no more.
#[test]
fn angles_without_an_arm_stay_small() {
    let mut description = perfect("[w X Y b Z t]");
    description.linear[0].errors = Some(line(4, -50e-6, 20e-6));
    description.squareness.ec0y_rad = 10e-6;
    let machine = machine(description, &[]);
    let budget_of = |arm: f64| {
        let commands = [at(100.0, 400.0, 0.0, Vector::new(0.0, 0.0, -arm))];
        let (sized, field) = sized(&machine, &commands);
        let one = |model: &WithEffects, point: usize| model.error_mm(&commands[point]);
        let keep = [false, false];
        equal_influence(&sized, &field, &keep, 0.020, Figure::WorstCase, one, evaluate(&commands)).unwrap()
    };
    // An arm of 100 mm: half of 20 µm each, 100 µrad of EBX and 25 µrad over 400 mm.
    let found = budget_of(100.0);
    assert!((found.factors[0].unwrap() * 50.0 - 100.0).abs() < 1e-3, "{found:?}");
    assert!((found.factors[1].unwrap() * 10.0 - 25.0).abs() < 1e-3, "{found:?}");
    // A micrometre: 0.01 rad bring a hundredth of one, and squareness gets the rest.
    let found = budget_of(1e-3);
    assert!((found.factors[0].unwrap() * 50e-6 - 0.01).abs() < 1e-12, "{found:?}");
    assert!((found.factors[1].unwrap() * 10.0 - (0.020 - 1e-5) / 400.0 * 1e6).abs() < 1e-3, "{found:?}");
    assert!(found.whole_model_mm <= 0.020);
    // Less than a picometre: any.
    assert_eq!(budget_of(1e-6).factors[0], None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Whatever functions stay within their sizes: the whole model stays below the worst case of the sizes.
    #[test]
    fn no_function_within_its_size_is_above_the_worst_case(values in prop::collection::vec(-1.0..1.0_f64, 54)) {
        let machine = everything(1.0);
        let commands = all_over();
        let (sized, field) = sized(&machine, &commands);
        let worst = worst_case(&field);
        // Any functions of the linear axes, any sizes of the rest.
        let mut description = sized.model().base().description().clone();
        let mut values = values.into_iter();
        for axis in &mut description.linear {
            let sizes = axis.errors.as_ref().unwrap().at(0.0);
            let table = |size: f64, values: Vec<f64>| {
                let values = values.into_iter().map(|v| v * size).collect();
                Some(Table::new(vec![-400.0, -10.0, 400.0], values, Interpolation::Linear).unwrap())
            };
            axis.errors = AxisTables::new(&sizes.map(|size| table(size, values.by_ref().take(3).collect())));
        }
        let terms = sized.model().terms().to_vec();
        let any = WithEffects::new(RigidBody::new(description).unwrap(), terms, Conditions::default()).unwrap();
        let found = Criteria::of(&evaluate(&commands)(&any)).unwrap().largest_mm;
        // Second order of this machine, with room.
        prop_assert!(found <= worst.mm * 1.001, "{found} {}", worst.mm);
    }
}
