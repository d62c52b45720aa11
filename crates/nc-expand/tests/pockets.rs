//! Contours with pockets (type II of G71 and G72): whatever the contour, what is written leaves it whole, and no pass of it goes
//! deeper than one depth of cut, or in a rapid through what still stands.

use crate::common;

use common::blocks;
use nc_dialect::Dialect;
use nc_expand::{Environment, Limits, expand};

fn dialect() -> Dialect {
    let mut dialect =
        nc_dialect::builtin("fanuc-lathe").and_then(|dialect| dialect.in_system("A")).expect("a system");
    dialect.turning.as_mut().expect("a lathe").diameters = Some(true);
    dialect
}

fn lines(program: &str) -> Result<Vec<String>, (u16, String)> {
    let dialect = dialect();
    let environment = Environment {
        variables: &[],
        read_external: &common::nothing,
        setup: &common::setup(&dialect),
        limits: Limits::default(),
    };
    let expanded = expand(program.as_bytes(), &dialect, &environment).map_err(|refusal| {
        let first = &refusal.diagnostics[0];
        (first.code.0, first.to_string())
    })?;
    let flat = std::str::from_utf8(expanded.text()).expect("text");
    Ok(blocks(flat).into_iter().map(str::to_owned).collect())
}

/// A move in radius and Z, as chords.
struct Move {
    is_rapid: bool,
    points: Vec<[f64; 2]>,
}

/// An own reader of G0 to G3 with X, Z and I, K or R.
fn moves(lines: &[String]) -> Vec<Move> {
    let (mut at, mut code) = ([0.0, 0.0], 0);
    let mut moves = Vec::new();
    for line in lines {
        let mut words = std::collections::BTreeMap::new();
        for word in line.split_whitespace() {
            let (letter, value) = word.split_at(1);
            if letter == "G" {
                code = value.parse().expect("a code");
            } else {
                words.insert(letter.to_owned(), value.parse::<f64>().expect("a number"));
            }
        }
        let value = |letter: &str| words.get(letter).copied();
        let to = [value("X").map_or(at[0], |x| x / 2.0), value("Z").unwrap_or(at[1])];
        let points = match code {
            0 | 1 => vec![at, to],
            _ => {
                let centre = match value("R") {
                    Some(radius) => by_radius(at, to, radius, code == 2),
                    None => [at[0] + value("I").unwrap_or(0.0), at[1] + value("K").unwrap_or(0.0)],
                };
                arc_points(at, to, centre, code == 2)
            }
        };
        moves.push(Move { is_rapid: code == 0, points });
        at = to;
    }
    moves
}

/// Left of its way lies the centre of G3, less than half a turn.
fn by_radius(from: [f64; 2], to: [f64; 2], radius: f64, clockwise: bool) -> [f64; 2] {
    let chord = [to[0] - from[0], to[1] - from[1]];
    let length = units::math::hypot(chord[0], chord[1]);
    let height = (radius * radius - 0.25 * length * length).max(0.0).sqrt() / length;
    let side = if clockwise { -height } else { height };
    [0.5 * (from[0] + to[0]) + side * chord[1], 0.5 * (from[1] + to[1]) - side * chord[0]]
}

fn arc_points(from: [f64; 2], to: [f64; 2], centre: [f64; 2], clockwise: bool) -> Vec<[f64; 2]> {
    let angle = |p: [f64; 2]| units::math::atan2(p[0] - centre[0], p[1] - centre[1]);
    let turn = std::f64::consts::TAU;
    let by = (angle(to) - angle(from)).rem_euclid(turn);
    let by = if clockwise { by - turn } else { by };
    let radius = units::math::hypot(from[0] - centre[0], from[1] - centre[1]);
    let steps = (500.0 * radius * by.abs()).ceil().max(1.0) as usize;
    let mut points: Vec<_> = (0..=steps)
        .map(|k| {
            let (sin, cos) = units::math::sin_cos(angle(from) + by * k as f64 / steps as f64);
            [centre[0] + radius * sin, centre[1] + radius * cos]
        })
        .collect();
    points.push(to);
    points
}

/// How deep things lie below the start along the way of the passes, by places 0.01 mm apart.
struct Heights {
    depths: Vec<f64>,
}

const STEP: f64 = 0.01;
/// Before this place, on the way to the contour, nothing stands.
const FIRST: usize = 202;

impl Heights {
    /// The deepest place of a path between two neighbours, at both of them.
    fn of(points: &[[f64; 2]], places: usize) -> Self {
        let mut heights = Self { depths: vec![f64::NEG_INFINITY; places] };
        points.windows(2).for_each(|ends| heights.cut(ends[0], ends[1]));
        heights
    }

    fn cut(&mut self, a: [f64; 2], b: [f64; 2]) {
        let (low, high) = if a[0] < b[0] { (a, b) } else { (b, a) };
        // Walls stand on places up to the last digits.
        let (first, last) = ((low[0] / STEP - 1e-4).ceil() as i64, (high[0] / STEP + 1e-4).floor() as i64);
        for k in first.max(0)..=last.min(self.depths.len() as i64 - 1) {
            let place = k as f64 * STEP;
            let share = if high[0] > low[0] { (place - low[0]) / (high[0] - low[0]) } else { 0.0 };
            let is_wall = high[0] - low[0] < 1e-6;
            let depth = if is_wall {
                low[1].max(high[1])
            } else {
                low[1] + share.clamp(0.0, 1.0) * (high[1] - low[1])
            };
            let here = &mut self.depths[k as usize];
            *here = here.max(depth);
        }
    }
}

/// A repeatable row of numbers from 0 to 1.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(u32::MAX >> 1)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        ((low + (high - low) * self.roll()) * 1e3).round() / 1e3
    }
}

/// A contour of lines, grooves, valleys, and half circles in and out, from radius 30 Z 2 towards the chuck; its blocks.
fn contour(dice: &mut Dice, faces: bool) -> String {
    // Depth below the start and way from it.
    let (mut depth, mut way) = (dice.between(4.0, 12.0), 2.0);
    let to = |code: &str, depth: f64, way: f64, more: &str| {
        let [x, z] = if faces { [30.0 - way, 2.0 - depth] } else { [30.0 - depth, 2.0 - way] };
        format!("{code} X{:.3} Z{:.3}{more}\n", 2.0 * x, z)
    };
    let mut text = format!("N10 {}", to("G0", depth, way, ""));
    // Seen with depth for X and way for Z a face is mirrored.
    let (dip, bump) = if faces { ("G3", "G2") } else { ("G2", "G3") };
    for _ in 0..4 + (dice.roll() * 6.0) as usize {
        let (kind, long) = (dice.roll(), dice.between(0.3, 3.0));
        if kind < 0.5 {
            depth = dice.between(1.0, 14.0);
            way += if kind < 0.15 { 0.0 } else { long };
            text += &to("G1", depth, way, "");
        } else if kind < 0.6 {
            way += long;
            text += &to("G1", depth, way, "");
        } else {
            let radius = long.min(depth - 0.5).max(0.2);
            way += 2.0 * radius;
            let (i, k) = if faces { (-radius, 0.0) } else { (0.0, -radius) };
            text += &to(if kind < 0.8 { dip } else { bump }, depth, way, &format!(" I{i:.3} K{k:.3}"));
        }
    }
    way += 1.0;
    let [x, z] = if faces { [30.0 - way, 2.0 - depth] } else { [30.0 - depth, 2.0 - way] };
    format!("{text}N20 G1 X{:.3} Z{:.3}\n", 2.0 * x, z)
}

#[test]
fn passes_leave_the_contour_whole_and_cut_one_depth_each() {
    let mut dice = Dice(19);
    let mut pockets = 0;
    for case in 0..300 {
        let faces = case % 3 == 2;
        let text = contour(&mut dice, faces);
        let (cut, escape) = (dice.between(0.4, 3.0), dice.between(0.1, 1.0));
        let allowance = if case % 2 == 0 { 0.4 } else { 0.0 };
        let (first, second, cycle) = if faces {
            (format!("W{cut:.3}"), format!("U0. W{allowance:.3}"), "G72")
        } else {
            (format!("U{cut:.3}"), format!("U{:.3} W0.", 2.0 * allowance), "G71")
        };
        let program = format!(
            "G0 X60. Z2.\n{cycle} {first} R{escape:.3}\n{cycle} P10 Q20 {second} F0.2\n{text}G70 P10 Q20 F0.1\n"
        );
        let written = lines(&program).unwrap_or_else(|refusal| panic!("{refusal:?}\n{program}"));
        let feeds: Vec<String> = written
            .iter()
            .map(|line| line.replace("F0.2 ", "").replace(" F0.1", "").replace("F0.1", ""))
            .filter(|line| !line.trim().is_empty())
            .collect();
        // Way from Z 2 (radius 30) and depth below what the passes start from.
        let seen = |p: [f64; 2]| {
            let [x, z] = [30.0 - p[0], 2.0 - p[1]];
            if faces { [x, z + allowance] } else { [z, x + allowance] }
        };
        let mut all = moves(&feeds);
        let finishing = all.len() - text.lines().count() - 1;
        let finished: Vec<[f64; 2]> =
            all[finishing..all.len() - 1].iter().flat_map(|one| one.points.clone()).map(seen).collect();
        let end = finished.iter().map(|p| p[0]).fold(0.0, f64::max);
        let places = (end / STEP) as usize + 1;
        let wanted = Heights::of(&finished, places);
        all.truncate(finishing);
        let mut stock = Heights { depths: vec![0.0; places] };
        stock.depths[..FIRST].fill(40.0);
        let context = |what: &str, p: [f64; 2]| {
            format!("case {case}: {what} at {p:?}\n{program}\n{}", written.join("\n"))
        };
        for one in &all[1..] {
            let points: Vec<[f64; 2]> = one.points.iter().copied().map(seen).collect();
            let before = stock.depths.clone();
            let own = Heights::of(&points, places);
            for (k, stood) in before.iter().enumerate().take(places - 1).skip(FIRST) {
                let (depth, p) = (own.depths[k], [k as f64 * STEP, own.depths[k]]);
                if depth == f64::NEG_INFINITY {
                    continue;
                }
                // Finest printed digits, and chords of the own arcs.
                let lowest = wanted.depths[k] - allowance + 2e-5;
                assert!(depth <= lowest, "{}", context("below the contour", p));
                let most = if one.is_rapid { 0.0 } else { cut };
                assert!(depth <= stood + most + 1e-4, "{}", context("through what stands", p));
            }
            points.windows(2).for_each(|ends| stock.cut(ends[0], ends[1]));
        }
        for (k, (have, want)) in stock.depths.iter().zip(&wanted.depths).enumerate() {
            let place = k as f64 * STEP;
            if k >= FIRST && place < end - 2.0 * STEP {
                let off = (have + allowance - want).abs();
                assert!(
                    off < 2e-3 || walls(&wanted, k),
                    "{}",
                    context("not as deep as the contour", [place, *have])
                );
            }
        }
        pockets += usize::from(written.iter().filter(|line| line.starts_with("G0")).count() > 12);
    }
    assert!(pockets > 100, "{pockets}");
}

/// A wall beside a place, where both heights are right.
fn walls(heights: &Heights, k: usize) -> bool {
    let near = |k: usize| heights.depths.get(k).copied().unwrap_or_default();
    (near(k) - near(k - 1)).abs() > 0.02 || (near(k) - near(k + 1)).abs() > 0.02
}

fn refused(cycle: &str, contour: &str) -> String {
    let program = format!("G0 X60. Z2.\nG71 U1. R0.5\n{cycle}\n{contour}G70 P10 Q20\n");
    lines(&program).expect_err(&program).1
}

#[test]
fn what_would_cut_into_the_contour_is_refused() {
    let pocket = "N10 G0 X40. W0.\nG1 Z-5. F0.1\nX30. Z-10.\nX40. Z-15.\nN20 X60.\n";
    let cycle = |words: &str| format!("G71 P10 Q20 {words} F0.2");
    let said = refused(&cycle("U0.4 W0.1"), pocket);
    assert!(said.contains("an allowance W on a contour with pockets"), "{said}");
    let said = refused(&cycle("U-0.4 W0."), pocket);
    assert!(said.contains("an allowance U that leads into the workpiece"), "{said}");
    // Type I has no pockets; along Z neither of them turns back.
    let said = refused(&cycle("U0.4 W0."), &pocket.replace(" W0.", ""));
    assert!(said.contains("turns back along X"), "{said}");
    let said = refused(&cycle("U0.4 W0."), &pocket.replace("Z-15.", "Z-8."));
    assert!(said.contains("turns back along Z"), "{said}");
    // A collar above the start, with a pocket behind it.
    let collar = "N10 G0 X40. W0.\nG1 Z-5. F0.1\nX64. Z-10.\nX40. Z-15.\nN20 X60.\n";
    let said = refused(&cycle("U0.4 W0."), collar);
    assert!(said.contains("rises beyond the start"), "{said}");
}

#[test]
fn a_pocket_is_cut_along_its_flank() {
    let program = "G0 X60. Z2.\nG71 U5. R0.5\nG71 P10 Q20 U0. W0. F0.2\nN10 G0 X50. W0.\nG1 Z-5. F0.1\nX30. Z-15.\nX50. Z-25.\n\
        N20 X60.\nG70 P10 Q20\n";
    let wanted = [
        "G0 X60. Z2.",
        "F0.2 G0 X50. Z2.",
        "G1 Z-5.",
        // At 50 from where the pocket begins to where it ends, back in the slot, and down its flank.
        "G1 Z-25.",
        "G0 X51. Z-24.5",
        "G0 X51. Z-5.5",
        "G1 X50. Z-5.",
        "G1 X40. Z-10.",
        "G1 Z-20.",
        "G0 X41. Z-19.5",
        // Straight out, and along the contour.
        "G0 X60. Z-19.5",
        "G0 X60. Z2.",
        "G0 X50. Z2.",
        "G1 Z-5.",
        "G1 X30. Z-15.",
        "G1 X50. Z-25.",
        "G1 X60.",
        "G0 X60. Z2.",
    ];
    let written = lines(program).expect("written");
    assert_eq!(written[..wanted.len()], wanted);
}
