//! Play of machines that are known.

use proptest::prelude::*;

use super::*;
use crate::{
    AxisTables, Chain, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness,
    Table,
};

fn command(x: f64, y: f64) -> Command {
    Command { linear_mm: Vector::new(x, y, 0.0), ..Default::default() }
}

/// X with tables for each direction, 6 to 14 µm apart along it and 3 µm across; Y with lost motion in Z only.
fn machine() -> RigidBody {
    let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
    let nodes = vec![0.0, 40.0, 100.0];
    let table = |values: [f64; 3]| Table::new(nodes.clone(), values.into(), Interpolation::Linear).ok();
    let set = |along: [f64; 3], across: [f64; 3]| {
        AxisTables::new(&[table(along), None, table(across), None, None, None])
    };
    linear[0].errors = set([0.001, 0.002, -0.003], [0.0; 3]);
    linear[0].errors_negative = set([0.007, 0.012, 0.011], [0.003; 3]);
    linear[1].errors = AxisTables::new(&[None, None, table([0.005; 3]), None, None, None]);
    linear[1].errors_negative = AxisTables::new(&[None, None, table([-0.005; 3]), None, None, None]);
    RigidBody::new(Description {
        chain: Chain::parse("[w X Y b Z t]").unwrap(),
        linear,
        rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness::default(),
    })
    .unwrap()
}

#[test]
fn reversal_values_are_those_of_the_tables() {
    let model = machine();
    assert!((model.reversal_mm(0, &command(40.0, 0.0)) - 0.010).abs() < 1e-15);
    assert!((model.reversal_mm(0, &command(100.0, 0.0)) - 0.014).abs() < 1e-15);
    assert_eq!(model.reversal_mm(1, &command(40.0, 0.0)), 0.0);
}

#[test]
fn what_lies_across_turns_with_the_carriage() {
    let model = machine();
    let mut play = Play::unknown();
    let mut error = |x: f64, y: f64| {
        play.go(&model, &command(x, y));
        play.error_mm(&model, &command(x, y))
    };
    error(10.0, 10.0);
    assert_eq!(error(20.0, 20.0).z, 0.005);
    // X goes back, but not by its play; Y has none.
    assert_eq!(error(19.997, 20.0).z, 0.005);
    assert!((error(19.0, 20.0).z - 0.008).abs() < 1e-15);
    assert!((error(19.0, 19.999).z - -0.002).abs() < 1e-15);
}

#[test]
fn a_side_is_known_once_all_play_is_taken_up_for_certain() {
    let model = machine();
    let mut play = Play::unknown();
    let mut unsure_um = |x: f64| {
        play.go(&model, &command(x, 5.0));
        (play.unsure_mm(&model, &command(x, 5.0))[0] * 1e3 * 10.0).round() / 10.0
    };
    // At 40 mm the reversal value is 10 µm.
    assert_eq!([40.0, 40.003, 40.009, 40.011, 39.0].map(&mut unsure_um), [5.0, 7.0, 1.0, 0.0, 0.0]);
}

#[test]
fn play_is_taken_up_where_it_changes_on_the_way() {
    let model = machine();
    for (from, to) in [(9.0, 30.0), (41.0, 20.0)] {
        let (mut play, heading) = (Play::unknown(), if to > from { 1 } else { -1 });
        for x in [from - 10.0 * f64::from(heading), to] {
            play.go(&model, &command(x, 0.0));
        }
        let back = [-heading, 0, 0];
        let lag_mm = play.lag_mm(&model, &command(to, 0.0), back)[0];
        let side_behind = |mm: f64| {
            let mut gone = play;
            gone.go(&model, &command(to - f64::from(heading) * mm, 0.0));
            gone.side()[0]
        };
        assert!(lag_mm > 1e-3, "{lag_mm}");
        assert_eq!([lag_mm - 1e-8, lag_mm + 1e-8].map(side_behind), [heading, -heading]);
    }
}

/// C, whose tables lie 60 µrad apart about its line, and 4 µm in X.
fn swivel() -> RigidBody {
    let linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: -500.0, high: 500.0 }));
    let mut rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
    let travel = Range { low: -4.0, high: 4.0 };
    rotary[2].errors = Some(AxisTables::constant(travel, [0.0; 6]));
    rotary[2].errors_negative = Some(AxisTables::constant(travel, [0.004, 0.0, 0.0, 0.0, 0.0, 60e-6]));
    let chain = Chain::parse("[w C b X Y Z t]").unwrap();
    RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
}

#[test]
fn a_table_stands_until_its_play_is_taken_up() {
    let model = swivel();
    let at = |c: f64| Command { rotary_rad: Vector::new(0.0, 0.0, c), ..command(100.0, 0.0) };
    let mut play = Play::unknown();
    // The tool at X 100 as the workpiece sees it, µm: where the table stands further, it lies behind in Y, but for a hundredth.
    let mut seen_um = |c: f64| {
        play.turn(&model, &at(c), [true; 3]);
        let tip = model.tip_mm(&(at(c).linear_mm + play.error_mm(&model, &at(c))), &at(c));
        let turned = at(c).rotary_rad.z;
        [tip.x - 100.0 * units::math::cos(turned), tip.y + 100.0 * units::math::sin(turned)]
            .map(|mm| (mm * 1e5).round() * 1e-2)
    };
    let near = |seen: [f64; 2], wanted: [f64; 2]| (0..2).all(|i| (seen[i] - wanted[i]).abs() < 0.08);
    // From the middle of its play: off by half of it, until that is taken up.
    assert!(near(seen_um(0.0), [-2.0, -3.0]), "{:?}", seen_um(0.0));
    assert!(near(seen_um(20e-6), [-2.0, -1.0]), "{:?}", seen_um(20e-6));
    assert!(near(seen_um(0.010), [0.0, 0.0]));
    // Back by 20 and 59 µrad: it has not moved, and is off by that at an arm of 100 mm.
    assert!(near(seen_um(0.010 - 20e-6), [0.0, -2.0]), "{:?}", seen_um(0.010 - 20e-6));
    assert!(near(seen_um(0.010 - 59e-6), [0.0, -5.9]));
    // Then it follows, 60 µrad behind and on the other side.
    assert!(near(seen_um(0.009), [-4.0, -6.0]), "{:?}", seen_um(0.009));
    // And forth again.
    assert!(near(seen_um(0.009 + 30e-6), [-4.0, -3.0]));
    assert!(near(seen_um(0.010), [0.0, 0.0]));
}

proptest! {
    /// At the side of its play a machine is what the model says for that direction.
    #[test]
    fn behind_a_long_way_the_direction_tells_all(from in 0.0f64..45.0, way in 0.02f64..50.0, back: bool) {
        let model = machine();
        let (from, to) = if back { (from + way, from) } else { (from, from + way) };
        let mut play = Play::unknown();
        for x in [50.0, from, to] {
            play.go(&model, &command(x, 5.0));
        }
        let direction = [if back { -1 } else { 1 }, 0, 0];
        prop_assert_eq!(play.side(), direction);
        prop_assert_eq!(play.lag_mm(&model, &command(to, 5.0), direction), [0.0; 3]);
        let told = model.error_mm(&Command { direction, ..command(to, 5.0) });
        prop_assert!((play.error_mm(&model, &command(to, 5.0)) - told).norm() < 1e-12);
    }

    /// However often it is asked on the way, the carriage ends where it ends, and never goes against the command.
    #[test]
    fn the_way_counts_and_not_its_pieces(places in prop::collection::vec(10.0f64..10.03, 2..12), pieces in 1u32..9) {
        let model = machine();
        // From a side that is known.
        let mut once = Play::unknown();
        [5.0, 9.0].into_iter().for_each(|x| once.go(&model, &command(x, 0.0)));
        let mut often = once;
        let mut before: Option<f64> = None;
        for to in places {
            let tip = |play: &Play, x: f64| x + play.error_mm(&model, &command(x, 0.0)).x;
            if let Some(from) = before {
                let mut last = tip(&often, from);
                for k in 1..=pieces {
                    let x = from + (to - from) * f64::from(k) / f64::from(pieces);
                    often.go(&model, &command(x, 0.0));
                    let now = tip(&often, x);
                    // It stands but for what the mean curve changes by over the play.
                    prop_assert!((now - last) * (to - from).signum() >= -1e-8, "{} {}", last, now);
                    last = now;
                }
            } else {
                often.go(&model, &command(to, 0.0));
            }
            once.go(&model, &command(to, 0.0));
            prop_assert!((tip(&once, to) - tip(&often, to)).abs() < 1e-12);
            before = Some(to);
        }
    }
}
