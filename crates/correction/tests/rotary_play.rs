//! Play of rotary axes: the tip of a table that follows its commands with lost motion, by formulas of their own.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use crate::control;

use control::{ALLOWED_MM, OPTIONS, block};
use correction::{Block, CorrectionError, Corrector, Goal, Piece, PieceKind};
use machine_model::{
    AxisTables, Chain, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness,
    Table, Vector,
};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use toolpath::{Division, Feed, FeedRate, Motion, Position, Shape};

const ABOUT_A: [f64; 3] = [300.0, 310.0, 180.0];
const ABOUT_C: [f64; 3] = [305.0, 300.0, 240.0];
const TOOL_MM: [f64; 3] = [0.0, 0.0, -120.0];

/// What the axes A and C do when they turn back.
#[derive(Clone, Copy)]
struct Reversal {
    play_urad: [f64; 2],
    /// By so much C carries the part along X by its table of the positive direction more than by that of the negative one.
    sideways_mm: f64,
}

impl From<[f64; 2]> for Reversal {
    fn from(play_urad: [f64; 2]) -> Self {
        Self { play_urad, sideways_mm: 0.0 }
    }
}

fn machine(Reversal { play_urad, sideways_mm }: Reversal) -> RigidBody {
    let linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 700.0 }));
    let mut rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
    for (axis, centre, play) in [(0, ABOUT_A, play_urad[0]), (2, ABOUT_C, play_urad[1])] {
        rotary[axis] = RotaryAxis { backlash_rad: play * 1e-6, ..RotaryAxis::perfect(centre.into()) };
    }
    if sideways_mm != 0.0 {
        let table = |along: f64| {
            let along = Table::new(vec![-20.0, 20.0], vec![along; 2], Interpolation::Linear).ok();
            AxisTables::new(&[along, None, None, None, None, None])
        };
        (rotary[2].errors, rotary[2].errors_negative) = (table(0.5 * sideways_mm), table(-0.5 * sideways_mm));
    }
    let chain = Chain::parse("[w C A X Y b Z t]").unwrap();
    RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
}

/// The tip in the workpiece: `c_C + Rz(-C) (c_A + Rx(-A) (q + t - c_A) - d - c_C)`, angles in degrees; d lies along X.
fn tip(linear_mm: [f64; 3], a: f64, c: f64, sideways_mm: f64) -> [f64; 3] {
    let q: [f64; 3] = std::array::from_fn(|i| linear_mm[i] + TOOL_MM[i]);
    let (sin, cos) = units::math::sin_cos(a.to_radians());
    let (u, v) = (q[1] - ABOUT_A[1], q[2] - ABOUT_A[2]);
    let (y, z) = (ABOUT_A[1] + cos * u + sin * v, ABOUT_A[2] - sin * u + cos * v);
    let (sin, cos) = units::math::sin_cos(c.to_radians());
    let (u, v) = (q[0] - sideways_mm - ABOUT_C[0], y - ABOUT_C[1]);
    [ABOUT_C[0] + cos * u + sin * v, ABOUT_C[1] - sin * u + cos * v, z]
}

/// A table that stands until its command has gone back by its play.
struct Follower {
    stands: f64,
    half: f64,
    /// Which way it moved last.
    side: f64,
}

impl Follower {
    fn follow(&mut self, command: f64) -> f64 {
        let stood = self.stands;
        self.stands = self.stands.clamp(command - self.half, command + self.half);
        // Moving by a rounding is standing.
        self.side =
            if (self.stands - stood).abs() > 1e-11 { (self.stands - stood).signum() } else { self.side };
        self.stands
    }
}

/// Where the words of a piece lead.
fn run(at: &Position, piece: &Piece, block: &Block, own: &Position) -> Position {
    let go = |word: Goal, at: f64, own: f64| match word {
        Goal::Stays => at,
        Goal::AsStated => own,
        Goal::Steps(counts) => counts as f64 * 1e-3,
    };
    let rotary = piece.rotary.unwrap_or([Goal::Stays; 3]);
    let [from, own_mm] = [at, own].map(|place| block.frame.to_program(place.linear_mm));
    Position {
        linear_mm: block.frame.to_machine([0, 1, 2].map(|i| go(piece.axes[i], from[i], own_mm[i]))),
        rotary_deg: [0, 1, 2].map(|i| go(rotary[i], at.rotary_deg[i], own.rotary_deg[i])),
    }
}

/// Feeds from place to place; the largest distance of the real tip from the programmed one at the same time, mm, and how
/// many lines were written.
fn furthest(
    reversal: impl Into<Reversal>,
    places: &[Position],
    corrected: bool,
) -> Result<(f64, usize), CorrectionError> {
    let reversal @ Reversal { play_urad, sideways_mm } = reversal.into();
    let model = machine(reversal);
    let mut corrector = Corrector::new(&model, OPTIONS);
    let words = Block { tool_mm: TOOL_MM, ..block("XYZAC", false) };
    // From below, so that it is known where the tables stand.
    let mut before = places[0];
    before.rotary_deg = before.rotary_deg.map(|deg| deg - 1.0);
    corrector.correct(&Motion::Rapid { start: before.into(), end: places[0].into() }, &words)?;
    let mut at = places[0];
    if corrected {
        at.linear_mm = corrector.standing_mm().map(Option::unwrap_or_default);
    }
    let mut tables: [Follower; 2] = std::array::from_fn(|k| {
        let half = 0.5 * (play_urad[k] * 1e-6).to_degrees();
        Follower { stands: places[0].rotary_deg[2 * k] - half, half, side: 1.0 }
    });
    let (mut worst, mut lines) = (0.0_f64, 0);
    for pair in places.windows(2) {
        let [start, end] = [pair[0], pair[1]];
        let (shape, rate, division) = (Shape::Line, FeedRate::InverseTime(1.0), Division::Any);
        let answer = corrector.correct(&Motion::Feed(Feed { start, end, shape, rate, division }), &words)?;
        let own = Piece {
            rotary: Some([Goal::AsStated; 3]),
            ..Piece::new(PieceKind::Line, [Goal::AsStated; 3], 1.0)
        };
        let untouched = answer.pieces.is_empty() || !corrected;
        let pieces = if untouched { vec![own] } else { answer.pieces.to_vec() };
        lines += pieces.len();
        let mut gone = 0.0;
        // What pieces have over the whole motion is that of approaches.
        let mut before = pieces.iter().map(|piece| piece.share).sum::<f64>() - 1.0;
        for piece in &pieces {
            let to = run(&at, piece, &words, &end);
            // An approach leads to where the next piece begins, at the start or where a table turns back on the way: no rotary
            // axis moves in it.
            let still = piece.rotary.is_none_or(|words| words == [Goal::Stays; 3]);
            let approach = still && piece.share <= before + 1e-9;
            let share = if approach { 0.0 } else { piece.share };
            before -= piece.share - share;
            for k in 0..=400 {
                let mix = |a: f64, b: f64, s: f64| a + (b - a) * s;
                let s = f64::from(k) / 400.0;
                let command = [0, 2].map(|i| mix(at.rotary_deg[i], to.rotary_deg[i], s));
                let linear = std::array::from_fn(|i| mix(at.linear_mm[i], to.linear_mm[i], s));
                let angles = [tables[0].follow(command[0]), tables[1].follow(command[1])];
                let real = tip(linear, angles[0], angles[1], 0.5 * sideways_mm * tables[1].side);
                let t = (gone + share * s).min(1.0);
                let place = std::array::from_fn(|i| mix(start.linear_mm[i], end.linear_mm[i], t));
                let [a, c] = [0, 2].map(|i| mix(start.rotary_deg[i], end.rotary_deg[i], t));
                let wanted = tip(place, a, c, 0.0);
                let off = (0..3).map(|i| (real[i] - wanted[i]).powi(2)).sum::<f64>().sqrt();
                worst = worst.max(off);
            }
            gone += share;
            at = to;
        }
    }
    Ok((worst, lines))
}

fn at(linear_mm: [f64; 3], a: f64, c: f64) -> Position {
    Position { linear_mm, rotary_deg: [a, 0.0, c] }
}

/// C comes from below, goes back by 30°, then forth; A back and forth by less than its play.
#[test]
fn a_reversal_is_led_at_its_arm() {
    let places = [
        at([400.0, 300.0, 400.0], 5.0, 10.0),
        at([410.0, 300.0, 401.0], 8.0, 20.0),
        at([420.0, 310.0, 401.0], 7.999, -10.0),
        at([420.0, 310.0, 401.0], 8.0, -9.0),
        at([380.0, 330.0, 405.0], 12.0, -9.001),
    ];
    let (uncorrected, _) = furthest([40.0, 60.0], &places, false).unwrap();
    let (off, lines) = furthest([40.0, 60.0], &places, true).unwrap();
    // An arm of some 160 mm, half a play of 20 and 30 µrad.
    assert!(uncorrected > 0.005, "{uncorrected}");
    assert!(off <= ALLOWED_MM, "{off} mm, {lines} lines");
    // Without play no word is changed.
    assert_eq!(furthest([0.0, 0.0], &places, true).unwrap(), (0.0, 4));
}

/// Where C turns back its table moves the part at once: by up to twice the tolerance that is led round, half before and half
/// behind, whatever the steps are.
#[test]
fn a_table_that_moves_sideways_is_met_halfway() {
    let places = [
        at([400.0, 300.0, 400.0], 5.0, 10.0),
        at([410.0, 300.0, 401.0], 8.0, 20.0),
        at([420.0, 310.0, 401.0], 7.999, -10.0),
        at([420.0, 310.0, 402.0], 8.0, -9.0),
        at([380.0, 330.0, 405.0], 12.0, -9.002),
    ];
    for sideways_mm in [0.0015, -0.0019, 0.002] {
        let reversal = Reversal { play_urad: [0.0; 2], sideways_mm };
        let (off, lines) = furthest(reversal, &places, true).unwrap();
        assert!(off <= ALLOWED_MM, "{off} mm of {sideways_mm}, {lines} lines");
    }
    // Half of it is more than may be.
    let reversal = Reversal { play_urad: [0.0; 2], sideways_mm: 0.006 };
    let refused = furthest(reversal, &places, true).unwrap_err();
    assert!(matches!(refused, CorrectionError::Sideways { .. }), "{refused:?}");
}

/// C's angle comes out of a sum with a last bit more than its word has: saying it again turns nothing back.
#[test]
fn a_last_bit_is_no_reversal() {
    let stands = 60.727 + 4.0 * f64::EPSILON * 60.0;
    let places = [
        at([302.811, 297.999, 400.0], -10.607, 51.906),
        at([302.811, 297.999, 400.0], -4.801, stands),
        at([302.811, 297.999, 400.0], -4.794, stands),
        at([302.811, 297.999, 400.0], -5.265, 60.745),
    ];
    let reversal = Reversal { play_urad: [5.0, 0.0], sideways_mm: -0.001_926 };
    let (off, lines) = furthest(reversal, &places, true).unwrap();
    assert!(off <= ALLOWED_MM && lines == 4, "{off} mm, {lines} lines");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_tip_follows_whatever_turns_back(
        seed: u64, play_a in prop_oneof![Just(0.0), 5.0f64..150.0], play_c in 5.0f64..150.0,
        sideways_mm in prop_oneof![Just(0.0), -0.002f64..0.002],
        steps in prop::collection::vec((0.0f64..20.0, prop_oneof![Just(0.0), 0.0f64..0.01, 0.0f64..25.0]), 2..7),
    ) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut number = |size: f64| ((random.next_u64() as f64 / u64::MAX as f64 * 2.0 - 1.0) * size * 1e3).round() * 1e-3;
        let mut place = at([300.0 + number(60.0), 300.0 + number(60.0), 400.0], number(30.0), number(90.0));
        let mut places = vec![place];
        for (length, turn) in steps {
            place.linear_mm = place.linear_mm.map(|mm| ((mm + number(length)) * 1e3).round() * 1e-3);
            for axis in [0, 2] {
                place.rotary_deg[axis] = ((place.rotary_deg[axis] + number(turn)) * 1e3).round() * 1e-3;
            }
            places.push(place);
        }
        // A reversal inside the play moves nothing at once.
        let play_c = if sideways_mm == 0.0 { play_c } else { 0.0 };
        let (off, lines) = match furthest(Reversal { play_urad: [play_a, play_c], sideways_mm }, &places, true) {
            Ok(done) => done,
            // Half of it and rounding come to the tolerance, and a turn of two steps has no place for it: refused.
            Err(CorrectionError::Sideways { distance_um, .. }) if distance_um > 1.8 => return Ok(()),
            Err(error) => panic!("{error}"),
        };
        prop_assert!(off <= ALLOWED_MM, "{off} mm, {lines} lines");
    }
}
