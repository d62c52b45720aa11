//! Feeds on whose way rotary axes turn: the tip of the real machine against that of an ideal one, at many places.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use crate::control;

use control::{ALLOWED_MM, OPTIONS, block};
use correction::{Block, CorrectionError, Corrector, Goal, Options, Piece};
use machine_model::{
    AxisTables, Chain, Command, Description, Interpolation, LinearAxis, PathModel, Range, RigidBody,
    RotaryAxis, Squareness, Table, Vector,
};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use toolpath::{Division, Feed, FeedRate, Motion, Position, Shape};

const CHAINS: [&str; 4] = ["[w C A X Y b Z t]", "[w B b X Y Z C t]", "[w b X Y Z C A t]", "[w A b Y X Z t]"];

fn machine(random: &mut impl FnMut(f64) -> f64, chain: &str, monotone: bool) -> RigidBody {
    let interpolation = if monotone { Interpolation::Monotone } else { Interpolation::Linear };
    let mut tables = |low: f64, high: f64, mm: f64, rad: f64| {
        let nodes: Vec<f64> = (0..=24).map(|k| low + (high - low) * f64::from(k) / 24.0).collect();
        AxisTables::new(&std::array::from_fn(|i| {
            let size = if i < 3 { mm } else { rad };
            Table::new(nodes.clone(), nodes.iter().map(|_| random(size)).collect(), interpolation).ok()
        }))
    };
    let linear = [(); 3].map(|()| LinearAxis {
        errors: tables(0.0, 600.0, 0.008, 3e-5),
        ..LinearAxis::perfect(Range { low: 0.0, high: 600.0 })
    });
    let of_rotary = [(); 3].map(|()| tables(-7.0, 7.0, 0.005, 3e-5));
    let mut vector = |size: f64| Vector::from_fn(|_, _| random(size));
    let rotary = of_rotary.map(|errors| RotaryAxis {
        shift_mm: vector(0.03),
        tilt_rad: vector(8e-5),
        errors,
        ..RotaryAxis::perfect(Vector::new(300.0, 300.0, 200.0) + vector(40.0))
    });
    let squareness = Squareness { ec0y_rad: 4e-5, eb0z_rad: -6e-5, ea0z_rad: 2e-5 };
    RigidBody::new(Description { chain: Chain::parse(chain).unwrap(), linear, rotary, squareness }).unwrap()
}

/// Where words bring the axes of a control that knows nothing but them: X, Y, Z in mm, A, B, C in degrees.
fn run(at: &Position, piece: &Piece, block: &Block, own: &Position) -> Position {
    let mut to = *at;
    let standing = block.frame.to_program(at.linear_mm);
    let own_mm = block.frame.to_program(own.linear_mm);
    let program = [0, 1, 2].map(|i| match piece.axes[i] {
        Goal::Stays => standing[i],
        Goal::AsStated => own_mm[i],
        Goal::Steps(counts) if block.incremental[i] => standing[i] + counts as f64 * 1e-3,
        Goal::Steps(counts) => counts as f64 * 1e-3,
    });
    to.linear_mm = block.frame.to_machine(program);
    for (i, word) in piece.rotary.into_iter().flatten().enumerate() {
        to.rotary_deg[i] = match word {
            Goal::Stays => at.rotary_deg[i],
            Goal::AsStated => own.rotary_deg[i],
            Goal::Steps(counts) if block.incremental[i] => at.rotary_deg[i] + counts as f64 * 1e-3,
            Goal::Steps(counts) => counts as f64 * 1e-3,
        };
    }
    to
}

fn between(from: &Position, to: &Position, s: f64, state: &Command) -> Command {
    let mix = |a: [f64; 3], b: [f64; 3]| Vector::from(a) + (Vector::from(b) - Vector::from(a)) * s;
    let rotary_rad = mix(from.rotary_deg, to.rotary_deg).map(f64::to_radians);
    Command { linear_mm: mix(from.linear_mm, to.linear_mm), rotary_rad, ..*state }
}

/// A feed alone, corrected behind a rapid to its start.
struct Case<'m> {
    model: &'m RigidBody,
    start: Position,
    end: Position,
    block: Block,
    options: Options,
}

impl Case<'_> {
    /// The pieces, each with where it starts and ends in the output.
    fn pieces(&self) -> Result<Vec<(Piece, Position, Position)>, CorrectionError> {
        let mut corrector = Corrector::new(self.model, self.options);
        let rapid = Motion::Rapid { start: self.start.into(), end: self.start.into() };
        corrector.correct(&rapid, &Block { tool_mm: self.block.tool_mm, ..block("XYZ", false) })?;
        let mut at = Position {
            linear_mm: corrector.standing_mm().map(Option::unwrap_or_default),
            rotary_deg: self.start.rotary_deg,
        };
        let (shape, rate, division) = (Shape::Line, FeedRate::InverseTime(1.0), Division::Any);
        let feed = Feed { start: self.start, end: self.end, shape, rate, division };
        let corrected = corrector.correct(&Motion::Feed(feed), &self.block)?;
        let own_words =
            [0, 1, 2].map(|i| if self.block.stated.axes[i] { Goal::AsStated } else { Goal::Stays });
        let untouched = Piece {
            rotary: Some([Goal::AsStated; 3]),
            ..Piece::new(correction::PieceKind::Line, own_words, 1.0)
        };
        let all = if corrected.pieces.is_empty() { vec![untouched] } else { corrected.pieces.to_vec() };
        let mut ran = Vec::new();
        for piece in all {
            let step = Vector::from(self.end.linear_mm) - Vector::from(self.start.linear_mm);
            let mut own = self.end;
            if self.block.incremental == [true; 3] {
                own.linear_mm = (Vector::from(at.linear_mm) + step).into();
            }
            let to = run(&at, &piece, &self.block, &own);
            ran.push((piece, at, to));
            at = to;
        }
        Ok(ran)
    }

    /// The largest distance of the real tip from the ideal one at the same time, mm, and of its programmed direction, rad.
    fn furthest(&self, pieces: &[(Piece, Position, Position)]) -> (f64, f64) {
        let state = Command { tool_mm: self.block.tool_mm.into(), ..Default::default() };
        let (mut so_far, mut worst, mut aside) = (0.0, 0.0_f64, 0.0_f64);
        for (piece, from, to) in pieces {
            for k in 0..=60 {
                let s = f64::from(k) / 60.0;
                let real = between(from, to, s, &state);
                let ideal = between(&self.start, &self.end, so_far + piece.share * s, &state);
                let tip = self.model.tip_mm(&(real.linear_mm + self.model.error_mm(&real)), &real);
                worst = worst.max((tip - self.model.tip_mm(&ideal.linear_mm, &ideal)).norm());
                let [one, other] = [&real, &ideal].map(|command| self.model.directions(command)[0]);
                aside = aside.max((one - other).norm());
            }
            so_far += piece.share;
        }
        (worst, aside)
    }
}

fn numbers(seed: u64) -> impl FnMut(f64) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move |size| (random.next_u64() as f64 / u64::MAX as f64 * 2.0 - 1.0) * size
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_real_tip_follows_the_ideal_one(
        seed: u64, chain in 0usize..4, monotone: bool, incremental: bool,
        length in prop_oneof![Just(0.0), 0.1f64..3.0, 3.0f64..80.0],
        turn in prop_oneof![0.05f64..3.0, 3.0f64..120.0],
    ) {
        let mut random = numbers(seed);
        let model = machine(&mut random, CHAINS[chain], monotone);
        let mut vector = |size: f64| Vector::from_fn(|_, _| random(size));
        let thousandth = |v: Vector| v.map(|v| (v * 1e3).round() * 1e-3);
        let start = thousandth(Vector::new(300.0, 300.0, 250.0) + vector(60.0));
        let turns = model.description().chain.axes().filter(|axis| !axis.is_linear());
        let mut may_turn = Vector::zeros();
        turns.for_each(|axis| may_turn[axis.direction()] = 1.0);
        let from = thousandth(vector(100.0)).component_mul(&may_turn);
        let to = thousandth(from + vector(turn).component_mul(&may_turn));
        let end = thousandth(start + vector(1.0) * length);
        let mut own = block(if length == 0.0 { "ABC" } else { "XYZABC" }, incremental);
        own.tool_mm = [0.0, 0.0, -120.0];
        let place = |linear: Vector, rotary: Vector| {
            Position { linear_mm: linear.into(), rotary_deg: rotary.into() }
        };
        let case = Case {
            model: &model, start: place(start, from), end: place(end, to), block: own, options: OPTIONS,
        };
        prop_assume!(from != to);
        let pieces = match case.pieces() {
            Err(CorrectionError::Solve(_)) => return Ok(()),
            pieces => pieces.unwrap(),
        };
        let shares: f64 = pieces.iter().map(|(piece, ..)| piece.share).sum();
        prop_assert!((shares - 1.0).abs() < 1e-9, "{shares}");
        // The rotary axes end where they were told to, to the last bit but for summing thousandths.
        let last = pieces.last().unwrap().2.rotary_deg;
        prop_assert!((Vector::from(last) - to).norm() < 1e-9, "{last:?} {to:?}");
        let (worst, aside) = case.furthest(&pieces);
        prop_assert!(worst <= ALLOWED_MM, "{} um of {} pieces", worst * 1e3, pieces.len());
        prop_assert!(aside <= 5e-5, "{aside}");
    }
}

/// A split that thousandths cannot say is refused; where nothing is split they need not.
#[test]
fn directions_that_words_cannot_say_are_refused() {
    let mut random = numbers(4);
    let model = machine(&mut random, CHAINS[0], false);
    let at = |x: f64, a: f64, c: f64| Position { linear_mm: [x, 320.0, 260.0], rotary_deg: [a, 0.0, c] };
    let options = Options { orientation_rad: 1e-6, ..OPTIONS };
    let case = |end: Position| Case {
        model: &model,
        start: at(300.0, 10.0, 20.0),
        end,
        block: block("XAC", false),
        options,
    };
    let refused = case(at(330.0, 50.0, 77.0)).pieces();
    assert!(matches!(refused, Err(CorrectionError::Direction { .. })), "{refused:?}");
    assert_eq!(case(at(300.2, 10.05, 20.04)).pieces().unwrap().len(), 1);
}
