//! Random paths on a straight machine: cut anywhere they are the same path, damaged anywhere they are not.

use machine_model::{
    Chain, Description, LinearAxis, Models, Range, RigidBody, RotaryAxis, Squareness, Vector,
};
use path_comparison::{Act, Comparison, Pointing, Step, Traces, What, compare};
use proptest::prelude::*;
use toolpath::{Arc, Division, Feed, FeedRate, Kinematics, Motion, Plane, Position, Shape};

const LIMIT_MM: f64 = 0.002;

/// A machine without errors.
fn machine(chain: &str) -> RigidBody {
    RigidBody::new(Description {
        chain: Chain::parse(chain).expect("a chain"),
        linear: [(); 3].map(|()| LinearAxis::perfect(Range { low: -500.0, high: 500.0 })),
        rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness::default(),
    })
    .expect("a machine")
}

fn straight() -> RigidBody {
    machine("[w X Y b Z t]")
}

/// What a comparison finds on a machine.
fn found_on(machine: &RigidBody, [wanted, made]: [Vec<Step>; 2]) -> Comparison {
    let retreats = toolpath::PeckRetreats { clearance_mm: 0.25, chip_mm: 0.5 };
    let models = Models { axes: machine, tip: None };
    compare(models, wanted.into_iter(), made.into_iter(), retreats, Traces::Kept, 1.0)
}

fn at(linear_mm: [f64; 3]) -> Position {
    Position { linear_mm, rotary_deg: [0.0; 3] }
}

fn feed(start: [f64; 3], end: [f64; 3], shape: Shape) -> Feed {
    Feed { start: at(start), end: at(end), shape, rate: FeedRate::PerMinute, division: Division::Any }
}

fn step(feed: Feed, line: usize) -> Step {
    let act = Act::Motion {
        motion: Motion::Feed(feed),
        tool_mm: [0.0; 3],
        datum: Default::default(),
        kinematics: Kinematics::Axes,
        feed: Some(100.0),
        dwell: None,
        cycle: None,
    };
    Step { act, line: line as u64, process: 0, limit_mm: LIMIT_MM, compensated: false, pointing: None }
}

fn compared(wanted: &[Feed], made: &[Feed]) -> Comparison {
    let steps =
        |feeds: &[Feed]| -> Vec<Step> { feeds.iter().enumerate().map(|(k, f)| step(*f, k + 1)).collect() };
    found_on(&straight(), [wanted, made].map(steps))
}

/// Lines through places; every third of them an arc of a quarter turn in XY.
fn path(places: &[[f64; 3]]) -> Vec<Feed> {
    let pairs = places.windows(2).enumerate();
    pairs
        .map(|(k, pair)| {
            let [from, to] = [pair[0], pair[1]];
            let arc = k % 3 == 2 && (from[0], from[1]) != (to[0], to[1]);
            // The centre of a quarter turn lies half the chord beside its middle.
            let centre_mm =
                [0.5 * (from[0] + to[0] - (to[1] - from[1])), 0.5 * (from[1] + to[1] + (to[0] - from[0]))];
            let sweep_rad = std::f64::consts::FRAC_PI_2;
            let shape =
                if arc { Shape::Arc(Arc { plane: Plane::Xy, centre_mm, sweep_rad }) } else { Shape::Line };
            feed(from, to, shape)
        })
        .collect()
}

/// The same path in pieces.
fn cut(feeds: &[Feed], pieces: u32) -> Vec<Feed> {
    let mut all = Vec::new();
    for whole in feeds {
        let way = path_comparison::Way::of(whole);
        let mut from = whole.start.linear_mm;
        for k in 1..=pieces {
            let to: [f64; 3] = way.at(f64::from(k) / f64::from(pieces)).into();
            let shape = match whole.shape {
                Shape::Line | Shape::Bezier(_) => Shape::Line,
                Shape::Arc(arc) => Shape::Arc(Arc { sweep_rad: arc.sweep_rad / f64::from(pieces), ..arc }),
            };
            all.push(feed(from, to, shape));
            from = to;
        }
    }
    all
}

fn places() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let coordinate = (-2000i32..2000).prop_map(|steps| f64::from(steps) * 0.05);
    prop::collection::vec(prop::array::uniform3(coordinate), 4..12)
}

proptest! {
    #[test]
    fn a_path_in_pieces_is_the_same_path(places in places(), pieces in 1u32..5) {
        let whole = path(&places);
        let found = compared(&whole, &cut(&whole, pieces));
        prop_assert_eq!(&found.mismatches, &Vec::new());
        prop_assert!(found.after.largest_mm < 5e-7, "{}", found.after.largest_mm);
        prop_assert_eq!((found.wanted, found.traces.len()), (whole.len(), whole.len()));
    }

    /// Micrometres, which lie nearer than the limit, at one place: each need not be made, their order need not be kept.
    #[test]
    fn a_thousand_motions_of_a_micrometre_are_one_place(steps in prop::collection::vec((-5i32..5, -5i32..5), 20..200)) {
        let near: Vec<[f64; 3]> = steps.iter().map(|(x, y)| [f64::from(*x) * 1e-4, f64::from(*y) * 1e-4, 0.0]).collect();
        let lines: Vec<Feed> = near.windows(2).map(|pair| feed(pair[0], pair[1], Shape::Line)).collect();
        let stays: Vec<Feed> = lines.iter().map(|_| feed(near[0], near[0], Shape::Line)).collect();
        prop_assert_eq!(compared(&lines, &stays).mismatches, Vec::new());
    }

    #[test]
    fn a_place_beside_the_path_is_found(places in places(), which in 0usize..12, pieces in 2u32..5, by in 2.0f64..100.0) {
        let whole = path(&places);
        let mut made = cut(&whole, pieces);
        // Inside a motion, square to it.
        let k = (which % whole.len()) * pieces as usize;
        let (from, to) = (Vector::from(made[k].start.linear_mm), Vector::from(made[k].end.linear_mm));
        prop_assume!((to - from).norm() > 0.5);
        let aside = (to - from).cross(&Vector::new(0.3, 0.5, 0.8)).normalize() * (by * LIMIT_MM);
        let moved: [f64; 3] = (to + aside).into();
        (made[k].end, made[k + 1].start) = (at(moved), at(moved));
        let found = compared(&whole, &made);
        prop_assert!(!found.mismatches.is_empty());
        prop_assert!(found.after.largest_mm > LIMIT_MM, "{}", found.after.largest_mm);
    }

    #[test]
    fn a_place_left_out_exchanged_or_visited_twice_is_found(places in places(), which in 0usize..12) {
        let lines = |places: &[[f64; 3]]| -> Vec<Feed> {
            places.windows(2).map(|pair| feed(pair[0], pair[1], Shape::Line)).collect()
        };
        let k = 1 + which % (places.len() - 2);
        let [before, here, behind] = [k - 1, k, k + 1].map(|k| Vector::from(places[k]));
        let corner = (here - before).cross(&(behind - here)).norm();
        prop_assume!(corner > 1.0);
        let mut gone = places.clone();
        gone.remove(k);
        let mut exchanged = places.clone();
        exchanged.swap(k - 1, k);
        let mut twice = places.clone();
        twice.splice(k..=k, [places[k], places[k - 1], places[k]]);
        for damaged in [gone, exchanged, twice] {
            prop_assert!(!compared(&lines(&places), &lines(&damaged)).mismatches.is_empty(), "{:?}", damaged);
        }
    }
}

/// The lines of the corrected program that take another time under G93, where a motion is known by its time and not by F.
fn timed(wanted: &[Feed], made: &[Feed]) -> Vec<u64> {
    let steps = |feeds: &[Feed]| -> Vec<Step> {
        let under_g93 = |(k, one): (usize, &Feed)| {
            let act = match step(*one, k + 1).act {
                Act::Motion { motion, tool_mm, datum, kinematics, dwell, cycle, .. } => {
                    Act::Motion { motion, tool_mm, datum, kinematics, dwell, cycle, feed: None }
                }
                act @ Act::Deed(_) => act,
            };
            Step { act, ..step(*one, k + 1) }
        };
        feeds.iter().enumerate().map(under_g93).collect()
    };
    let found = found_on(&straight(), [wanted, made].map(steps));
    assert!(found.mismatches.iter().all(|one| matches!(one.what, What::Time(_))), "{found:?}");
    found.mismatches.iter().map(|one| one.commanded_line).collect()
}

fn per_minute(from: [f64; 2], to: [f64; 2], f: f64) -> Feed {
    let [from, to] = [from, to].map(|[x, y]| [x, y, 0.0]);
    Feed { rate: FeedRate::InverseTime(f), ..feed(from, to, Shape::Line) }
}

/// A motion within the limit of its end has taken any of the minutes of that way: many for the short piece that goes on a
/// hundred times as fast.
#[test]
fn the_time_of_a_fast_piece_behind_a_slow_one_is_its_own() {
    let line = |from: f64, to: f64, f: f64| per_minute([from, 0.0], [to, 0.0], f);
    let wanted = [line(0.0, 10.0, 1.0), line(10.0, 20.0, 100.0)];
    // By its words the slow one takes less than it should, as rounded words do: by less than 2 %.
    let (slow, first) = (line(0.0, 10.0, 1.005), line(10.0, 10.008, 125_000.0));
    let last = |f: f64| line(10.008, 20.0, f);
    assert_eq!(timed(&wanted, &[slow, first, last(100.08)]), []);
    assert_eq!(timed(&wanted, &[slow, first, last(1000.8)]), [3]);
    assert_eq!(timed(&wanted, &[line(0.0, 10.0, 10.0), first, last(100.08)]), [1]);
}

/// A piece that ends at a corner, a little nearer to the motion behind it, has not gone at that one's speed.
#[test]
fn the_time_of_a_piece_goes_by_its_own_motion() {
    let wanted = [per_minute([0.0, 0.0], [10.0, 0.0], 100.0), per_minute([10.0, 0.0], [10.0, 2.0], 20.0)];
    let made =
        |f: f64| [per_minute([0.0, 0.0], [10.0, 0.0005], f), per_minute([10.0, 0.0005], [10.0, 2.0], 20.0)];
    assert_eq!(timed(&wanted, &made(100.0)), []);
    for f in [1000.0, 300.0, 10.0] {
        assert_eq!(timed(&wanted, &made(f)), [1], "F{f}");
    }
}

/// What is off by a tenth on each of many short pieces adds up: places within the limit are no excuse on every one.
#[test]
fn the_time_of_short_pieces_adds_up() {
    let differs = |count: u32, times: f64| {
        let mm = f64::from(count) * 0.01;
        let wanted = [per_minute([0.0, 0.0], [mm, 0.0], 10.0 / mm)];
        let piece =
            |k: u32| per_minute([f64::from(k) * 0.01, 0.0], [f64::from(k + 1) * 0.01, 0.0], 1000.0 * times);
        !timed(&wanted, &(0..count).map(piece).collect::<Vec<Feed>>()).is_empty()
    };
    for (count, times) in [(1000, 1.1), (1000, 10.0), (100, 1.1), (100, 0.8), (100, 0.1)] {
        assert!(differs(count, times), "{count} {times}");
    }
    for (count, times) in [(1000, 0.99), (1000, 1.0), (1000, 1.01), (100, 0.99), (100, 1.01)] {
        assert!(!differs(count, times), "{count} {times}");
    }
}

/// A direction that may be off by so much everywhere, and a rotary axis.
fn held(leans_rad: f64, aside_deg: f64) -> Option<Pointing> {
    Some(Pointing { leans_rad, leans_near_rad: leans_rad, near_sin: 0.0, aside_deg })
}

/// Where directions are compared, what the tool leans at the start of a feed is none of its tip's distance.
#[test]
fn a_lean_at_the_start_is_no_distance_of_the_tip() {
    let table = machine("[w A b X Y Z t]");
    // Along the axis of A: the tip stays where it is.
    let along = |a_deg: f64| {
        let place = |x: f64, a: f64| Position { linear_mm: [x, 0.0, 0.0], rotary_deg: [a, 0.0, 0.0] };
        Feed { start: place(0.0, a_deg), end: place(10.0, 10.0), ..feed([0.0; 3], [0.0; 3], Shape::Line) }
    };
    let pointing = held(100e-6, 1.0);
    let steps = |a_deg: f64| vec![Step { pointing, ..step(along(a_deg), 1) }];
    let found = found_on(&table, [10.0, 10.0 + 60e-6_f64.to_degrees()].map(steps));
    assert!(found.mismatches.is_empty(), "{found:?}");
    assert!(found.after.largest_mm < 1e-9, "{found:?}");
    assert!((found.leans_after.largest_rad - 60e-6).abs() < 1e-9, "{found:?}");
}

/// A tool along the axis of the table points the same way at each of its angles; the axis may not stand anywhere for that.
#[test]
fn an_axis_along_the_tool_stands_at_its_angle() {
    let table = machine("[w C b X Y Z t]");
    let pointing = held(100e-6, 0.5);
    let plunge = |end_deg: f64| {
        let place = |z: f64, c: f64| Position { linear_mm: [0.0, 0.0, z], rotary_deg: [0.0, 0.0, c] };
        let feed = Feed {
            start: place(0.0, 10.0),
            end: place(10.0, end_deg),
            ..feed([0.0; 3], [0.0; 3], Shape::Line)
        };
        vec![Step { pointing, ..step(feed, 1) }]
    };
    for (made_deg, stands) in [(30.0, true), (30.4, true), (30.6, false), (31.0, false), (29.0, false)] {
        let found = found_on(&table, [30.0, made_deg].map(plunge));
        assert_eq!(found.mismatches.is_empty(), stands, "{made_deg} {found:?}");
        assert!(found.mismatches.iter().all(|mismatch| mismatch.what == What::Turned), "{found:?}");
        assert!(found.after.largest_mm < 1e-7, "{found:?}");
    }
}

/// What the tool may lean is no room for its tip: a corner cut by twice the limit is one, though each piece ends on the path.
#[test]
fn a_corner_is_not_cut_by_what_the_tool_may_lean() {
    let table = machine("[w C b X Y Z t]");
    let pointing = held(200e-6, 0.5);
    let along = |places: &[[f64; 2]]| {
        let lines = places.windows(2).enumerate().map(|(k, pair)| {
            let [from, to] = [pair[0], pair[1]].map(|[x, y]| [x, y, 0.0]);
            Step { pointing, ..step(feed(from, to, Shape::Line), k + 1) }
        });
        lines.collect::<Vec<Step>>()
    };
    let corner = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]];
    for (cut_mm, holds) in
        [(0.0, true), (0.5 * LIMIT_MM, true), (2.0 * LIMIT_MM, false), (4.0 * LIMIT_MM, false)]
    {
        // The corner is as far from the middle of the cut.
        let back = cut_mm * std::f64::consts::SQRT_2;
        let made = [[0.0, 0.0], [10.0 - back, 0.0], [10.0, back], [10.0, 10.0]];
        let found = found_on(&table, [along(&corner), along(&made)]);
        assert_eq!(found.mismatches.is_empty(), holds, "{cut_mm} {found:?}");
    }
}

#[test]
fn an_arc_turns_back_at_its_quarters() {
    let half = 0.5f64.sqrt() * 10.0;
    for sense in [1.0, -1.0] {
        let sweep_rad = sense * std::f64::consts::PI;
        let arc = Arc { plane: Plane::Xy, centre_mm: [0.0, 0.0], sweep_rad };
        let way = path_comparison::Way::of(&feed([half, half, 0.0], [-half, -half, 0.0], Shape::Arc(arc)));
        let found: Vec<[f64; 2]> =
            way.turns().into_iter().map(|s| [way.at(s).x.round() + 0.0, way.at(s).y.round() + 0.0]).collect();
        let wanted = if sense > 0.0 { [[0.0, 10.0], [-10.0, 0.0]] } else { [[10.0, 0.0], [0.0, -10.0]] };
        assert_eq!(found, wanted);
    }
}
