//! Cycles whose contour is a subroutine, against LinuxCNC's interpreter: a program and what it was expanded to move
//! alike.

use crate::common;

use std::path::Path;
use std::process::{Command, Stdio};

use nc_expand::{Environment, Limits, Refusal, expand};

/// A move of the interpreter: its name and numbers.
type Move = (String, Vec<f64>);

/// Numbers are printed with four decimals; words have six, of the diameter too.
const PRINTED: f64 = 1.2e-4;

fn have_interpreter() -> bool {
    let there = Command::new("rs274").arg("-h").stdin(Stdio::null()).output().is_ok();
    assert!(there || std::env::var_os("CI").is_none(), "linuxcnc-uspace must be installed where CI is set");
    there
}

/// What the interpreter makes of a program.
#[derive(PartialEq)]
enum Played {
    /// Moves that lead somewhere.
    Moves(Vec<Move>),
    Refused,
    /// A contour of which rounding decides whether some depth has a place keeps it in a loop.
    Endless,
}

fn play(text: &str) -> Played {
    let work = tempfile::tempdir().expect("a temporary folder");
    let (program, variables, out) =
        (work.path().join("in.ngc"), work.path().join("var"), work.path().join("out"));
    std::fs::write(&program, text).expect("writable");
    std::fs::write(&variables, "").expect("writable");
    let ran = Command::new("timeout")
        .args(["10", "rs274", "-v"])
        .args([variables.as_os_str(), "-g".as_ref(), program.as_os_str(), out.as_os_str()])
        .env("HOME", work.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .expect("started");
    match ran.code() {
        Some(0) => Played::Moves(read(&out)),
        Some(124) => Played::Endless,
        _ => Played::Refused,
    }
}

fn read(out: &Path) -> Vec<Move> {
    let text = String::from_utf8_lossy(&std::fs::read(out).expect("written")).into_owned();
    let mut at = [f64::NAN; 2];
    let mut moves = Vec::new();
    for line in text.lines() {
        let Some((name, numbers)) = line.split_once('(') else { continue };
        let name = name.split_whitespace().last().unwrap_or_default();
        let numbers: Vec<f64> =
            numbers.trim_end_matches(')').split(", ").filter_map(|n| n.parse().ok()).collect();
        let to = match name {
            "STRAIGHT_FEED" | "STRAIGHT_TRAVERSE" => [numbers[0], numbers[2]],
            // End and centre: Z and X.
            "ARC_FEED" => [numbers[1], numbers[0]],
            _ => continue,
        };
        if (to[0] - at[0]).abs() < PRINTED && (to[1] - at[1]).abs() < PRINTED {
            continue;
        }
        at = to;
        moves.push((name.to_owned(), numbers));
    }
    moves
}

fn written_out(text: &str) -> Result<String, Refusal> {
    let mut dialect = nc_dialect::builtin("linuxcnc-lathe").expect("shipped").clone();
    dialect.turning.as_mut().expect("a lathe").diameters = Some(false);
    let environment = Environment {
        variables: &[],
        read_external: &common::nothing,
        setup: &common::setup(&dialect),
        limits: Limits::default(),
    };
    expand(text.as_bytes(), &dialect, &environment)
        .map(|expanded| String::from_utf8(expanded.text().to_vec()).expect("text"))
}

/// The largest difference, mm; `None` where the moves are others.
fn difference(wanted: &[Move], got: &[Move]) -> Option<f64> {
    let names = |moves: &[Move]| moves.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    if names(wanted) != names(got) {
        return None;
    }
    let pairs = wanted.iter().zip(got).flat_map(|((_, a), (_, b))| a.iter().zip(b));
    Some(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
}

/// Numbers that are the same every time.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1_u64 << 31) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        // Three decimals, as programs have them.
        ((low + (high - low) * self.roll()) * 1e3).round() / 1e3
    }

    fn of(&mut self, count: usize) -> usize {
        ((self.roll() * count as f64) as usize).min(count - 1)
    }
}

/// Moved off by D the arc ends a last digit above the cylinder, which is no pocket for that.
const CYLINDER_BEHIND_AN_ARC: &str = "G21 G18 G90 G8 F100\no102 sub\nG0 X5 Z0\nG1 Z-5\nX9\nG1 Z-17\nX11 Z-19\n\
    G1 Z-27\nG3 X14 Z-30 R3\nG1 Z-41\nX12 Z-43\nZ-46\nX16\nG1 Z-54\no102 endsub\nG0 X21.5 Z3\n\
    G71.2 Q102 X21.5 Z3 D0.1 I1.96 R0.7 F100\nG0 X21.5 Z3\nM2\n";

/// A random contour along Z with a random cycle, in one of four quadrants, with radii or diameters.
fn program(dice: &mut Dice) -> String {
    let pockets = dice.of(2) == 0;
    let (inside, back) = (dice.of(3) == 0, dice.of(4) == 0);
    let twice = dice.of(2) == 0;
    let (mut r, mut z) = (dice.between(4.0, 9.0), 0.0);
    let code = ["G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"][dice.of(7)];
    // What falls along Z and rises in radius for G71 does so along radius and Z for G72.
    let facing = code.starts_with("G72");
    let place = |up: f64, along: f64| {
        let (r, z) = if facing { (40.0 + along, up - 30.0) } else { (up, along) };
        (if inside { 60.0 - r } else { r }, if back { -z } else { z })
    };
    let words = |r: f64, z: f64| {
        let (x, z) = place(r, z);
        format!("X{:.4} Z{z:.4}", if twice { 2.0 * x } else { x })
    };
    let mut contour = vec![format!("G{} {}", dice.of(2), words(r, z))];
    let mut highest = r;
    for _ in 0..3 + dice.of(5) {
        let kinds = if pockets { 7 } else { 5 };
        match dice.of(kinds) {
            0 => z -= dice.between(1.0, 6.0),
            1 => r += dice.between(0.5, 3.0),
            2 => (r, z) = (r + dice.between(0.5, 3.0), z - dice.between(0.5, 5.0)),
            kind => {
                if kind == 5 {
                    (r, z) = (r - dice.between(0.3, 1.5), z - dice.between(0.3, 3.0));
                    contour.push(format!("G1 {}", words(r, z)));
                    continue;
                }
                // An arc about a centre by two angles from Z, above it (G3) or below (G2); a quarter, or across the
                // top.
                let half = std::f64::consts::FRAC_PI_2;
                let radius = dice.between(1.0, 4.0);
                let dome = dice.of(2) == 0;
                let (low, high) = match (kind, dome) {
                    (6, _) => (0.05, 2.0 * half - 0.05),
                    (_, true) => (0.0, half),
                    (_, false) => (half, 2.0 * half),
                };
                let (mut from, mut to) = (low + (high - low) * dice.roll(), low + (high - low) * dice.roll());
                if dice.of(2) == 0 && kind != 6 {
                    (from, to) = (low, high);
                }
                if from > to {
                    (from, to) = (to, from);
                }
                if to - from < 0.3 {
                    continue;
                }
                let side = if dome { 1.0 } else { -1.0 };
                let ((sin, cos), (sin_to, cos_to)) = (units::math::sin_cos(from), units::math::sin_cos(to));
                let about = [r - side * radius * sin, z - radius * cos];
                let end = [about[0] + side * radius * sin_to, about[1] + radius * cos_to];
                let clockwise = !dome ^ inside ^ back ^ facing;
                let code = if clockwise { "G2" } else { "G3" };
                let centre = if dice.of(3) == 0 {
                    format!("R{radius}")
                } else {
                    let ((x, zc), (x0, z0)) = (place(about[0], about[1]), place(r, z));
                    format!("I{:.4} K{:.4}", x - x0, zc - z0)
                };
                (r, z) = (end[0], end[1]);
                contour.push(format!("{code} {} {centre}", words(r, z)));
                highest = highest.max(r).max(about[0] + radius);
                continue;
            }
        }
        highest = highest.max(r);
        contour.push(format!("G1 {}", words(r, z)));
    }
    contour.push(format!("G1 {}", words(highest + dice.between(0.2, 2.0), z - dice.between(0.0, 2.0))));
    let start = words(highest + dice.between(1.0, 4.0), dice.between(0.5, 3.0));
    let distance = if dice.of(2) == 0 { 0.0 } else { dice.between(0.05, 0.6) };
    let cycle = if code == "G70" {
        // From where it starts, or from where roughing has left the tool.
        let before = if dice.of(2) == 0 {
            format!("G70 Q100 {start}")
        } else {
            format!("G71.1 Q100 {start} I2\nG70 Q100")
        };
        format!("{before} D{distance} E{} P{}", dice.between(0.0, 0.1), 1 + dice.of(3))
    } else {
        format!("{code} Q100 {start} D{distance} I{} R{}", dice.between(0.4, 2.0), dice.between(0.1, 0.8))
    };
    let diameters = if twice { "G7" } else { "G8" };
    format!(
        "G21 G18 G90 {diameters} F100\no100 sub\n{}\no100 endsub\nG0 {start}\n{cycle}\nG0 {start}\nM2\n",
        contour.join("\n")
    )
}

#[test]
fn cycles_with_a_subroutine_move_as_the_interpreter_moves() {
    if !have_interpreter() {
        return;
    }
    let asked = |name: &str, usual: u64| {
        std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(usual)
    };
    // More with `ROUTINES=1000 SEED=7`.
    let (count, mut dice) = (asked("ROUTINES", 60), Dice(asked("SEED", 1)));
    let mut programs: Vec<String> = (0..count).map(|_| program(&mut dice)).collect();
    programs.push(CYLINDER_BEHIND_AN_ARC.to_owned());
    let (mut compared, mut moved, mut largest) = (0, 0, 0.0_f64);
    let (mut refused, mut endless, mut other, mut stricter) = (0, 0, Vec::new(), Vec::new());
    for text in programs {
        match (written_out(&text), play(&text)) {
            (Ok(flat), Played::Moves(wanted)) => {
                let Played::Moves(got) = play(&flat) else {
                    panic!("the moves are refused:\n{text}\n{flat}")
                };
                match difference(&wanted, &got) {
                    Some(d) => largest = largest.max(d),
                    None => other.push(text),
                }
                (compared, moved) = (compared + 1, moved + wanted.len());
            }
            // An arc whose ends the offset has parted: the moves are refused as the cycle is.
            (Ok(flat), Played::Refused) => {
                let same = play(&flat) == Played::Refused;
                assert!(same, "the interpreter refuses this cycle, and takes its moves:\n{text}\n{flat}");
                refused += 1;
            }
            (_, Played::Endless) => endless += 1,
            (Err(_), Played::Refused) => refused += 1,
            (Err(refusal), Played::Moves(_)) => stricter.push((refusal.diagnostics[0].to_string(), text)),
        }
    }
    let figures = format!(
        "{compared} of {count} compared, {moved} moves, largest difference {largest} mm; other moves in {}; refused by \
         both {refused}, by the interpreter's never ending {endless}, by us alone {}",
        other.len(),
        stricter.len()
    );
    if let Some(file) = std::env::var_os("FIGURES") {
        std::fs::write(file, &figures).expect("writable");
    }
    assert!(largest < PRINTED, "{figures}");
    assert!(compared * 2 > count, "{figures}");
    // At the top of an arc rounding decides whether there is a move of a thousandth of a millimetre.
    assert!(other.len() as u64 * 500 <= count, "{other:#?}");
    assert!(stricter.len() as u64 * 8 <= count, "{stricter:#?}");
}

#[test]
fn each_wrong_cycle_has_its_own_message() {
    let contour = "o100 sub\nG0 X10 Z0\nG1 Z-5\nX20 Z-12\no100 endsub\n";
    let program =
        |before: &str, contour: &str, cycle: &str| format!("G21 G18 G8\n{before}{contour}{cycle}\nM2\n");
    let cycle = "G71 Q100 X30 Z2 D0.5 I2 R0.3";
    let refused = |text: String| written_out(&text).err().map(|refusal| refusal.diagnostics[0].to_string());
    assert_eq!(refused(program("", contour, cycle)), None);
    let cases = [
        (program("G17\n", contour, cycle), "error[VP0143]: a cycle outside G18 G90 G91.1 and G94 or G95"),
        (program("G91\n", contour, cycle), "error[VP0143]: a cycle outside G18 G90 G91.1 and G94 or G95"),
        (program("", contour, "G71 Q100 X30 Z2 U0.5 I2"), "error[VP0143]: U beside this cycle"),
        (
            program("", contour, "G71 Q100 X30 Z2 I0"),
            "error[VP0143]: a distance, a depth or a number of passes that is none",
        ),
        (program("", contour, "G71 Q101 X30 Z2 I1"), "error[VP0144]: no subroutine O101 before this block"),
        (program("", contour, "G71 X30 Z2 I1"), "error[VP0144]: a cycle without Q"),
        (program("", contour, "G73 Q100 X30 Z2 I1"), "not by this room"),
        (program("", contour, "G71 Q100 I1"), "error[VP0143]: where the cycle starts is not known"),
        (
            program("", contour, "G71 Q100 X5 Z2 I1"),
            "error[VP0144]: the cycle starts on the side of the workpiece",
        ),
        (
            program("", &contour.replace("X20 Z-12", "X20 Z-2"), cycle),
            "error[VP0144]: the contour turns back along the axis of the passes",
        ),
        (program("", &contour.replace("G1 Z-5", "G1 Z-5 M8"), cycle), "error[VP0144]: M8 within a contour"),
        (program("", &contour.replace("G1 Z-5", "G91 G1 Z-5"), cycle), "error[VP0144]: G91 within a contour"),
        (
            program("", &contour.replace("G1 Z-5", "G3 X12 Z-5 R5\nX14 Z-7 R9"), cycle),
            "error[VP0144]: an arc without its G3",
        ),
        (
            program("", &contour.replace("G1 Z-5", "G1 Z-5\nZ-7"), cycle),
            "error[VP0144]: two lines that go straight on, and a distance to stay",
        ),
        (
            // 10 less twice 1.1 against 7.5 and 0.3.
            program(
                "",
                "o100 sub\nG0 X5 Z0\nG1 X7.5 Z-5\nZ-8\nX10 Z-12\no100 endsub\n",
                "G71 Q100 X10 Z2 D0.3 I1.1",
            ),
            "error[VP0144]: a pass lies as deep as a place of the contour, but for the last digits of both",
        ),
        (
            program("", &contour.replace("G1 Z-5", "o101 call"), cycle),
            "error[VP0144]: a call, a return or a cycle within the contour of a cycle",
        ),
    ];
    for (text, message) in cases {
        let told = refused(text.clone()).unwrap_or_else(|| "not by this room".to_owned());
        assert_eq!(told, message, "{text}");
    }
}

#[test]
fn a_contour_may_compute() {
    let text = "G21 G18 G8\n#1=7\n#<_deep>=3\no100 sub\n#1=[#1+1]\nG0 X10 Z0\no101 repeat [2]\nG1 Z[-#1*#<_deep>]\n\
        #1=[#1+1]\no101 endrepeat\nG1 X20 Z-12 F77\no100 endsub\nF100\nG70 Q100 X30 Z2\nG0 X[20+#1]\nM2\n";
    let flat = written_out(text).expect("a cycle");
    // Its numbered variables are its own, and begin at zero.
    assert_eq!(
        common::blocks(&flat),
        [
            "G21 G18 G8",
            "F100",
            "G0 X30. Z2.",
            "G0 X10. Z0.",
            "G1 Z-3.",
            "G1 Z-6.",
            "G1 X20. Z-12.",
            "G0 X27.",
            "M2"
        ],
        "{flat}"
    );
}
