//! `--orientation full`: tip and direction of the real machine against those of an ideal one, at many places, by a model of
//! this file's own: homogeneous transformations of nalgebra's rotations, written from equation (9) and nothing of the code.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]
#![allow(clippy::disallowed_methods, reason = "another arithmetic than the code's")]

use crate::control;

use control::{ALLOWED_MM, OPTIONS, block};
use correction::{Block, CorrectionError, Corrector, Directed, Goal, Options, Orientation, Piece};
use machine_model::{
    Axis, AxisTables, Chain, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis,
    Singularity, Squareness, Table, TipControl, Vector,
};
use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use toolpath::{Arc, Division, Feed, FeedRate, Kinematics, Motion, Mover, Partial, Plane, Position, Shape};

/// Table-table, head-table, head-head, and a head that nods about a line of 45 degrees.
const CHAINS: [&str; 4] =
    ["[w C A X Y b Z t]", "[w C b X Y Z B t]", "[w b X Y Z C A t]", "[w b X Y Z C B t]"];
const FULL: Options = Options {
    orientation_rad: 2e-5,
    orientation: Orientation::Full(Singularity { least_sin: 0.02, most_turn_rad: 0.008_7, most_share: 0.1 }),
    ..OPTIONS
};

fn numbers(seed: u64) -> impl FnMut(f64) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move |size| (random.next_u64() as f64 / u64::MAX as f64 * 2.0 - 1.0) * size
}

fn machine(random: &mut impl FnMut(f64) -> f64, chain: usize, crooked: f64) -> RigidBody {
    let mut tables = |low: f64, high: f64, mm: f64, rad: f64| {
        let nodes: Vec<f64> = (0..=24).map(|k| low + (high - low) * f64::from(k) / 24.0).collect();
        let phase = random(3.0);
        AxisTables::new(&std::array::from_fn(|i| {
            let size = crooked * if i < 3 { mm } else { rad };
            let value = |x: &f64| size * (phase + 5.0 * x / (high - low) + i as f64).sin();
            Table::new(nodes.clone(), nodes.iter().map(value).collect(), Interpolation::Linear).ok()
        }))
    };
    let linear = [(); 3].map(|()| LinearAxis {
        errors: tables(0.0, 600.0, 0.01, 2e-5),
        ..LinearAxis::perfect(Range { low: 0.0, high: 600.0 })
    });
    let of_rotary = [(); 3].map(|()| tables(-7.0, 7.0, 0.005, 3e-5));
    let mut vector = |size: f64| Vector::from_fn(|_, _| random(size));
    let mut rotary = of_rotary.map(|errors| RotaryAxis {
        shift_mm: vector(0.03 * crooked),
        tilt_rad: vector(8e-5 * crooked),
        errors,
        ..RotaryAxis::perfect(Vector::new(300.0, 300.0, 200.0) + vector(40.0))
    });
    if CHAINS[chain].contains("t]") && chain != 0 {
        // A head's centres count from the gauge point.
        let head: &[usize] = if chain == 1 { &[1] } else { &[0, 1, 2] };
        head.iter().for_each(|axis| rotary[*axis].centre_mm = vector(5.0));
    }
    if chain == 3 {
        rotary[1].direction = Some(Vector::new(0.0, 1.0, 1.0).normalize());
    }
    let squareness =
        Squareness { ec0y_rad: 4e-5 * crooked, eb0z_rad: -6e-5 * crooked, ea0z_rad: 2e-5 * crooked };
    RigidBody::new(Description { chain: Chain::parse(CHAINS[chain]).unwrap(), linear, rotary, squareness })
        .unwrap()
}

/// A rotation vector as a rotation.
fn small(v: Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(v)
}

/// The tip in the workpiece, mm, and the tool's direction, of the machine as described, or of its drawing.
fn forward(
    machine: &Description,
    real: bool,
    at: &Position,
    tool_mm: Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let turned = |axis: Axis| {
        let k = axis.direction();
        let data = &machine.rotary[k];
        let about = data.direction.unwrap_or_else(|| Vector3::ith(k, 1.0));
        let mut turn = Rotation3::new(about * at.rotary_deg[k].to_radians());
        let mut shift = Vector3::zeros();
        if real {
            let [x, y, z, a, b, c] =
                data.errors.as_ref().map_or([0.0; 6], |t| t.at(at.rotary_deg[k].to_radians()));
            turn = small(data.tilt_rad).to_rotation_matrix()
                * small(Vector3::new(a, b, c)).to_rotation_matrix()
                * turn;
            shift = data.shift_mm + Vector3::new(x, y, z);
        }
        let centre = Translation3::from(data.centre_mm);
        Isometry3::from_parts(Translation3::from(data.centre_mm + shift), UnitQuaternion::from(turn))
            * centre.inverse()
    };
    let moved = |axis: Axis| {
        let (k, q) = (axis.direction(), at.linear_mm[axis.direction()]);
        let mut way = Vector3::ith(k, q);
        let mut turn = UnitQuaternion::identity();
        if real {
            let Squareness { ec0y_rad, eb0z_rad, ea0z_rad } = machine.squareness;
            way += match k {
                0 => Vector3::zeros(),
                1 => Vector3::new(-ec0y_rad * q, 0.0, 0.0),
                _ => Vector3::new(eb0z_rad * q, -ea0z_rad * q, 0.0),
            };
            let [x, y, z, a, b, c] = machine.linear[k].errors.as_ref().map_or([0.0; 6], |t| t.at(q));
            way += Vector3::new(x, y, z);
            turn = small(Vector3::new(a, b, c));
        }
        Isometry3::from_parts(Translation3::from(way), turn)
    };
    let chain = &machine.chain;
    let (mut tip, mut tool) = (nalgebra::Point3::from(tool_mm), Vector3::z());
    for axis in chain.head().iter().rev() {
        let own = turned(*axis);
        (tip, tool) = (own * tip, own * tool);
    }
    for axis in chain.linear().into_iter().rev() {
        let own = moved(axis);
        (tip, tool) = (own * tip, own * tool);
    }
    for axis in chain.table().iter().rev() {
        let own = turned(*axis);
        (tip, tool) = (own.inverse() * tip, own.inverse() * tool);
    }
    (tip.coords, tool)
}

/// A feed alone, corrected behind a positioning of all axes to its start.
struct Case<'m> {
    model: &'m RigidBody,
    start: Position,
    end: Position,
    shape: Shape,
    block: Block,
    options: Options,
}

/// Where words bring the axes of a control that knows nothing but them.
fn run(at: &Position, piece: &Piece, block: &Block, own: &Position) -> Position {
    let mut to = *at;
    let standing = block.frame.to_program(at.linear_mm);
    let own_mm = block.frame.to_program(own.linear_mm);
    let value = |word: Goal, stands: f64, own: f64, incremental: bool| match word {
        Goal::Stays => stands,
        Goal::AsStated => own,
        Goal::Steps(counts) if incremental => stands + counts as f64 * 1e-3,
        Goal::Steps(counts) => counts as f64 * 1e-3,
    };
    let program = [0, 1, 2].map(|i| value(piece.axes[i], standing[i], own_mm[i], block.incremental[i]));
    to.linear_mm = block.frame.to_machine(program);
    for (i, word) in piece.rotary.into_iter().flatten().enumerate() {
        to.rotary_deg[i] = value(word, at.rotary_deg[i], own.rotary_deg[i], block.incremental == [true; 3]);
    }
    to
}

struct Ran {
    pieces: Vec<(Piece, Position, Position)>,
    /// The first piece is a turn before the motion: the tip stands at its start, and points where it shall behind it.
    leads: bool,
    directed: Directed,
}

impl Case<'_> {
    fn ran(&self) -> Result<Ran, CorrectionError> {
        let mut corrector = Corrector::new(self.model, self.options);
        let mut at = self.start;
        let mut pieces = Vec::new();
        let approach = Block { tool_mm: self.block.tool_mm, ..block("XYZABC", false) };
        let rapid = Motion::Rapid { start: self.start.into(), end: self.start.into() };
        let positioned = corrector.correct(&rapid, &approach)?;
        for piece in &positioned.pieces {
            at = run(&at, piece, &approach, &self.start);
        }
        let (rate, division) = (FeedRate::InverseTime(1.0), Division::Any);
        let feed = Feed { start: self.start, end: self.end, shape: self.shape, rate, division };
        let corrected = corrector.correct(&Motion::Feed(feed), &self.block)?;
        let own_words =
            self.block.stated.axes.map(|stated| if stated { Goal::AsStated } else { Goal::Stays });
        let own_turns =
            self.block.stated.rotary.map(|stated| if stated { Goal::AsStated } else { Goal::Stays });
        let untouched =
            Piece { rotary: Some(own_turns), ..Piece::new(correction::PieceKind::Line, own_words, 1.0) };
        let all = if corrected.pieces.is_empty() { vec![untouched] } else { corrected.pieces.to_vec() };
        for piece in all {
            let mut own = self.end;
            if self.block.incremental == [true; 3] {
                let step = |a: [f64; 3], b: [f64; 3]| Vector::from(b) - Vector::from(a);
                own.linear_mm =
                    (Vector::from(at.linear_mm) + step(self.start.linear_mm, self.end.linear_mm)).into();
                own.rotary_deg =
                    (Vector::from(at.rotary_deg) + step(self.start.rotary_deg, self.end.rotary_deg)).into();
            }
            let to = run(&at, &piece, &self.block, &own);
            pieces.push((piece, at, to));
            at = to;
        }
        let leads = corrected.correction.approach;
        Ok(Ran { pieces, leads, directed: corrected.correction.directed.unwrap_or_default() })
    }

    /// How far the direction's error on the programmed way is from that in its middle, rad: what standing axes leave at
    /// least.
    fn bends(&self) -> f64 {
        let error = |s: f64| {
            let way = Vector::from(self.end.linear_mm) - Vector::from(self.start.linear_mm);
            let at = place(Vector::from(self.start.linear_mm) + way * s, self.start.rotary_deg.into());
            let tool =
                |real| forward(self.model.description(), real, &at, Vector3::from(self.block.tool_mm)).1;
            tool(true) - tool(false)
        };
        (0..=40).map(|k| (error(f64::from(k) / 40.0) - error(0.5)).norm()).fold(0.0, f64::max)
    }

    /// Largest distance of the real tip from the ideal one, mm, and of the directions, rad, at the same time.
    fn furthest(&self, ran: &Ran) -> (f64, f64) {
        let machine = self.model.description();
        let tool_mm = Vector3::from(self.block.tool_mm);
        let mix = |a: &Position, b: &Position, s: f64| {
            let one = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * s);
            Position { linear_mm: one(a.linear_mm, b.linear_mm), rotary_deg: one(a.rotary_deg, b.rotary_deg) }
        };
        let (mut so_far, mut worst, mut aside) = (0.0, 0.0_f64, 0.0_f64);
        for (nth, (piece, from, to)) in ran.pieces.iter().enumerate() {
            let leads = ran.leads && nth == 0;
            let share = if leads { 0.0 } else { piece.share };
            for k in 0..=40 {
                let s = f64::from(k) / 40.0;
                let ideal = mix(&self.start, &self.end, so_far + share * s);
                let (tip, tool) = forward(machine, true, &mix(from, to, s), tool_mm);
                let (ideal_tip, ideal_tool) = forward(machine, false, &ideal, tool_mm);
                worst = worst.max((tip - ideal_tip).norm());
                if !leads {
                    aside = aside.max((tool - ideal_tool).norm());
                }
            }
            so_far += share;
        }
        (worst, aside)
    }
}

/// Half a step of two rotary words.
const STEP_RAD: f64 = 1.3e-5;

fn thousandth(v: Vector) -> Vector {
    v.map(|v| (v * 1e3).round() * 1e-3)
}

/// Which of A, B, C tilts the tool in each of [`CHAINS`].
const TILTS: [usize; 4] = [0, 1, 0, 1];

/// Angles with the tool well away from the axis that turns about it.
fn tilted(chain: usize, random: &mut impl FnMut(f64) -> f64) -> Vector {
    let mut angles = Vector::zeros();
    angles[TILTS[chain]] = 40.0 + random(25.0);
    angles[2] = random(120.0);
    thousandth(angles)
}

fn place(linear: Vector, rotary: Vector) -> Position {
    Position { linear_mm: linear.into(), rotary_deg: rotary.into() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    /// Tip within tolerance and direction within `orientation_urad` everywhere, while all axes run.
    #[test]
    fn tip_and_direction_follow_the_ideal_machine(
        seed: u64, chain in 0usize..4, incremental: bool,
        length in prop_oneof![Just(0.0), 0.1f64..3.0, 3.0f64..60.0],
        turn in prop_oneof![Just(0.0), 0.05f64..3.0, 3.0f64..12.0],
    ) {
        let mut random = numbers(seed);
        let model = machine(&mut random, chain, 1.0);
        let from = tilted(chain, &mut random);
        let mut vector = |size: f64| Vector::from_fn(|_, _| random(size));
        let start = thousandth(Vector::new(300.0, 300.0, 350.0) + vector(60.0));
        let may_turn = Vector::from_fn(|axis, _| f64::from(u8::from(axis == 2 || axis == TILTS[chain])));
        let to = thousandth(from + vector(turn).component_mul(&may_turn));
        let end = thousandth(start + vector(1.0) * length);
        prop_assume!(start != end || from != to);
        let letters = if start == end { "ABC" } else { "XYZABC" };
        let mut own = block(letters, incremental);
        own.tool_mm = [0.0, 0.0, -120.0];
        let case = Case { model: &model, start: place(start, from), end: place(end, to), shape: Shape::Line, block: own, options: FULL };
        let ran = match case.ran() {
            Err(CorrectionError::Solve(_)) => return Ok(()),
            // No standing angles point it along the whole way: refused, and rightly.
            Err(CorrectionError::Leans { .. }) if from == to => {
                prop_assert!(case.bends() + STEP_RAD >= FULL.orientation_rad, "{} urad", case.bends() * 1e6);
                return Ok(());
            }
            ran => ran.unwrap(),
        };
        prop_assert!(!ran.directed.held);
        let (worst, aside) = case.furthest(&ran);
        prop_assert!(worst <= ALLOWED_MM, "{} um of {} pieces", worst * 1e3, ran.pieces.len());
        prop_assert!(aside <= FULL.orientation_rad, "{} urad of {} pieces", aside * 1e6, ran.pieces.len());
        // What is said is no less than what is found, and the tip alone would have left it aside.
        prop_assert!(aside <= ran.directed.after_rad + 1e-12, "{} > {}", aside, ran.directed.after_rad);
        // No other branch, and no turn more or less.
        let last = ran.pieces.last().unwrap().2.rotary_deg;
        // The axis about the tool is put aside by 1/sin of the tilt more than the tool: towards it that grows to the cap.
        let is_tilted = [from, to].iter().all(|at| at[TILTS[chain]].to_radians().sin().abs() > 0.2);
        let most_deg = if is_tilted { 0.1 } else { 0.008_7_f64.to_degrees() };
        prop_assert!((Vector::from(last) - to).amax() < most_deg, "{last:?} {to:?}");
    }

    /// On a machine without errors nothing changes, near a singularity or not.
    #[test]
    fn a_perfect_machine_keeps_its_words(seed: u64, chain in 0usize..4, turn in 0.0f64..50.0, tilt in -1.0f64..40.0) {
        let mut random = numbers(seed);
        let model = machine(&mut random, chain, 0.0);
        let mut from = tilted(chain, &mut random);
        from[TILTS[chain]] = (tilt * 1e3).round() * 1e-3;
        let start = thousandth(Vector::new(300.0, 300.0, 350.0) + Vector::from_fn(|_, _| random(60.0)));
        let mut to = from;
        to[2] += (turn * 1e3).round() * 1e-3;
        let case = Case {
            model: &model, start: place(start, from), end: place(start + Vector::new(1.0, 2.0, 0.0), to),
            shape: Shape::Line, block: block("XYZABC", false), options: FULL,
        };
        let ran = case.ran().unwrap();
        prop_assert_eq!(ran.pieces.len(), 1);
        prop_assert_eq!(ran.pieces[0].0.rotary, Some([Goal::AsStated; 3]));
        prop_assert_eq!(ran.directed.after_rad, 0.0);
    }
}

/// An arc while the rotary axes stand where they point the tool: it stays an arc, and turned by as much.
#[test]
fn arcs_are_cut_with_the_tool_where_it_shall_point() {
    for chain in 0..4 {
        let mut random = numbers(7 + chain as u64);
        let model = machine(&mut random, chain, 1.0);
        let angles = tilted(chain, &mut random);
        let at = |x: f64, y: f64| place(Vector::new(x, y, 350.0), angles);
        let arc = Arc { plane: Plane::Xy, centre_mm: [300.0, 300.0], sweep_rad: std::f64::consts::FRAC_PI_2 };
        let (start, end) = (at(320.0, 300.0), at(300.0, 320.0));
        let mut own = block("XYIJ", false);
        own.tool_mm = [0.0, 0.0, -120.0];
        let options = Options { orientation_rad: 4e-5, ..FULL };
        let mut corrector = Corrector::new(&model, options);
        let rapid = Motion::Rapid { start: Partial::default(), end: start.into() };
        corrector.correct(&rapid, &Block { tool_mm: own.tool_mm, ..block("XYZABC", false) }).unwrap();
        let (rate, division) = (FeedRate::PerMinute, Division::Any);
        let feed = Feed { start, end, shape: Shape::Arc(arc), rate, division };
        let corrected = corrector.correct(&Motion::Feed(feed), &own).unwrap();
        let directed = corrected.correction.directed.unwrap();
        assert!(
            corrected.pieces.iter().all(|piece| matches!(piece.kind, correction::PieceKind::Arc { .. })),
            "{corrected:?}"
        );
        assert!(
            !directed.held && directed.after_rad <= 4e-5 && directed.before_rad > 4e-5,
            "{chain} {directed:?}"
        );
    }
}

/// Through the tool standing along the axis that turns about it: the tip holds, no axis turns far, nothing jumps, and it
/// is said.
#[test]
fn a_singular_passage_is_held_and_said() {
    for chain in [0, 1, 2] {
        let mut random = numbers(70 + chain as u64);
        let model = machine(&mut random, chain, 1.0);
        let tilt = TILTS[chain];
        let mut from = Vector::new(0.0, 0.0, 33.0);
        let mut to = from;
        (from[tilt], to[tilt]) = (40.0, -40.0);
        let start = Vector::new(310.0, 280.0, 350.0);
        let mut own = block("XYZABC", false);
        own.tool_mm = [0.0, 0.0, -120.0];
        let case = Case {
            model: &model,
            start: place(start, from),
            end: place(start + Vector::new(5.0, 3.0, 1.0), to),
            shape: Shape::Line,
            block: own,
            options: FULL,
        };
        let ran = case.ran().unwrap();
        let (worst, _) = case.furthest(&ran);
        assert!(worst <= ALLOWED_MM, "{chain}: {} um", worst * 1e3);
        assert!(ran.directed.held, "{chain}");
        let mut so_far = 0.0;
        for (piece, at, next) in &ran.pieces {
            let share = [so_far, so_far + piece.share];
            so_far += piece.share;
            let aside = |stands: &Position, s: f64| {
                let programmed = from + (to - from) * s;
                Vector::from(stands.rotary_deg) - programmed
            };
            let [before, behind] = [aside(at, share[0]), aside(next, share[1])];
            assert!(behind.amax() <= 0.5 + 1e-3, "{chain}: {behind:?}");
            // A tenth of the turn, and rounding at either end.
            let most = 0.1 * (to - from).abs().sum() * piece.share + 2.1e-3;
            assert!((behind - before).amax() <= most, "{chain}: {before:?} {behind:?} {most}");
        }
        // Away from it the direction holds again.
        let (last, at_end) = (ran.pieces.last().unwrap(), ran.pieces.last().unwrap().2);
        let machine = model.description();
        let tool = forward(machine, true, &at_end, Vector3::from(case.block.tool_mm)).1;
        let ideal = forward(machine, false, &case.end, Vector3::from(case.block.tool_mm)).1;
        assert!((tool - ideal).norm() <= FULL.orientation_rad, "{chain} {last:?}");
    }
}

/// Under tool centre point control too: the words are those of a tip.
#[test]
fn under_tip_control_directions_hold() {
    for chain in 0..4 {
        let mut random = numbers(170 + chain as u64);
        let model = machine(&mut random, chain, 1.0);
        let centres = model.description().rotary.each_ref().map(|axis| axis.centre_mm);
        let tip = TipControl::new(&model, centres).unwrap();
        let from = tilted(chain, &mut random);
        let mut to = from;
        (to[2], to[TILTS[chain]]) = (to[2] + 14.0, to[TILTS[chain]] - 9.0);
        let tool_mm = [0.0, 0.0, -120.0];
        let command = |linear: Vector, rotary: Vector| machine_model::Command {
            linear_mm: linear,
            rotary_rad: rotary.map(f64::to_radians),
            tool_mm: tool_mm.into(),
            ..Default::default()
        };
        let start = thousandth(tip.tip_command(&command(Vector::new(300.0, 310.0, 350.0), from)).linear_mm);
        let end = thousandth(start + Vector::new(11.0, -7.0, 2.0));
        let own = Block { kinematics: Kinematics::Tip, tool_mm, ..block("XYZABC", false) };
        let mut corrector = Corrector::new(&model, FULL).with_tip_control(Some(&tip));
        let (start, end) = (place(start, from), place(end, to));
        let rapid = Motion::Rapid { start: Partial::default(), end: start.into() };
        let mut at = start;
        for piece in corrector.correct(&rapid, &own).unwrap().pieces {
            at = run(&at, &piece, &own, &start);
        }
        let (rate, division) = (FeedRate::PerMinute, Division::Any);
        let feed = Feed { start, end, shape: Shape::Line, rate, division };
        let corrected = corrector.correct(&Motion::Feed(feed), &own).unwrap();
        assert!(corrected.correction.directed.is_some_and(|directed| !directed.held), "{chain}");
        let mut so_far = 0.0;
        for piece in &corrected.pieces {
            let to = run(&at, piece, &own, &end);
            for k in 0..=20 {
                let s = f64::from(k) / 20.0;
                let mix = |a: [f64; 3], b: [f64; 3], s: f64| {
                    Vector::from(a) + (Vector::from(b) - Vector::from(a)) * s
                };
                let u = so_far + piece.share * s;
                let wanted = mix(start.linear_mm, end.linear_mm, u) + Vector::from(tool_mm);
                let angles = mix(at.rotary_deg, to.rotary_deg, s);
                let axes = tip.axis_command(&command(mix(at.linear_mm, to.linear_mm, s), angles));
                let real = forward(model.description(), true, &place(axes.linear_mm, angles), tool_mm.into());
                let programmed = place(Vector::zeros(), mix(start.rotary_deg, end.rotary_deg, u));
                let ideal = forward(model.description(), false, &programmed, tool_mm.into());
                assert!(
                    (real.0 - wanted).norm() <= ALLOWED_MM,
                    "{chain}: {} um",
                    (real.0 - wanted).norm() * 1e3
                );
                assert!(
                    (real.1 - ideal.1).norm() <= FULL.orientation_rad,
                    "{chain}: {} urad",
                    (real.1 - ideal.1).norm() * 1e6
                );
            }
            at = to;
            so_far += piece.share;
        }
    }
}

/// Axes that were positioned one after the other are turned a little before the first feed where that is needed; those of
/// G53 stand as told.
#[test]
fn positioning_turns_what_it_names_and_the_feed_the_rest() {
    let mut led = 0;
    for seed in 0..12 {
        let mut random = numbers(seed);
        let model = machine(&mut random, 0, 1.0);
        let mut corrector = Corrector::new(&model, FULL);
        let turn = |a: f64, c: f64, by: Mover| Motion::Uncorrected {
            end: Partial {
                linear_mm: [Some(300.0), Some(310.0), Some(350.0)],
                rotary_deg: [a, 0.0, c],
                rotary_known: [true; 3],
            },
            by,
        };
        let first = corrector.correct(&turn(40.0, 0.0, Mover::RotaryWords), &block("A", false)).unwrap();
        let words = first.pieces.first().and_then(|piece| piece.rotary);
        assert!(words.is_none_or(|words| words[1..] == [Goal::Stays; 2]), "{first:?}");
        corrector.correct(&turn(40.0, 170.0, Mover::RotaryWords), &block("C", false)).unwrap();
        let at = |x: f64| place(Vector::new(x, 310.0, 350.0), Vector::new(40.0, 0.0, 170.0));
        let rapid = Motion::Rapid { start: at(300.0).into(), end: at(300.0).into() };
        corrector.correct(&rapid, &block("XYZ", false)).unwrap();
        let (rate, division) = (FeedRate::PerMinute, Division::Any);
        let feed = Feed { start: at(300.0), end: at(305.0), shape: Shape::Line, rate, division };
        let fed = corrector.correct(&Motion::Feed(feed), &block("X", false)).unwrap();
        led += u32::from(fed.pieces.len() > 1 && matches!(fed.pieces[0].rotary, Some([Goal::Steps(_), ..])));
        let directed = fed.correction.directed.unwrap();
        assert!(!directed.held && directed.after_rad <= FULL.orientation_rad, "{seed}: {directed:?}");
        // In machine coordinates the words lead where they say.
        let told = corrector.correct(&turn(10.0, 20.0, Mover::Other), &block("AC", false)).unwrap();
        assert!(told.pieces.is_empty());
    }
    assert!(led > 3, "{led}");
}
