//! The S-shaped wall on crooked machines: its error along its normal, before and after, with either `--orientation`.
//!
//! The wall is what the flank of the tool leaves. The machine is a chain of matrices of its own, read from the profile's
//! numbers; nothing of the model.

use std::fmt::Write as _;

use crate::common::{messages, root, run};
use crate::five_axis_parts::s_walls;
use crate::tip_program::{Place, places};

type Vector = [f64; 3];
type Matrix = [[f64; 3]; 3];

/// Of the tool H1.
const LENGTH_MM: f64 = 120.0;
/// How far up the wall reaches along the tool from its tip.
const WALL_MM: f64 = 40.0;

fn plus(a: Vector, b: Vector, by: f64) -> Vector {
    [0, 1, 2].map(|i| a[i] + by * b[i])
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: Vector) -> Vector {
    v.map(|x| x / dot(v, v).sqrt())
}

fn times(m: &Matrix, v: Vector) -> Vector {
    m.map(|row| dot(row, v))
}

fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// A rotary axis as the profile states it.
struct Rotary {
    axis: usize,
    centre_mm: Vector,
    shift_mm: Vector,
    lean_rad: Vector,
}

impl Rotary {
    fn read(profile: &toml::Table, letter: char) -> Self {
        let of = &profile["rotary"][letter.to_string().as_str()];
        let number = |key: &str| of.get(key).map_or(0.0, |v| v.as_float().expect("a number"));
        let centre = of["centre_mm"].as_array().expect("three numbers");
        Self {
            axis: "ABC".find(letter).expect("a rotary axis"),
            centre_mm: [0, 1, 2].map(|i| centre[i].as_float().expect("a number")),
            shift_mm: ["EX", "EY", "EZ"].map(|e| 1e-3 * number(&format!("{e}0{letter}_um"))),
            lean_rad: ["EA", "EB", "EC"].map(|e| 1e-6 * number(&format!("{e}0{letter}_urad"))),
        }
    }

    /// What it turns, by a matrix: small angles to second order.
    fn turn(&self, degrees: f64) -> Matrix {
        let (sin, cos) = units::math::sin_cos(degrees.to_radians());
        let (i, j) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let columns: Matrix = std::array::from_fn(|k| {
            let mut v = [0.0; 3];
            if k == i {
                (v[i], v[j]) = (cos, sin);
            } else if k == j {
                (v[i], v[j]) = (-sin, cos);
            } else {
                v[k] = 1.0;
            }
            let once = cross(self.lean_rad, v);
            plus(plus(v, once, 1.0), cross(self.lean_rad, once), 0.5)
        });
        transposed(&columns)
    }

    fn carries(&self, v: Vector, degrees: f64) -> Vector {
        let from = plus(v, self.centre_mm, -1.0);
        plus(plus(times(&self.turn(degrees), from), self.centre_mm, 1.0), self.shift_mm, 1.0)
    }

    fn undoes(&self, v: Vector, degrees: f64) -> Vector {
        let from = plus(plus(v, self.centre_mm, -1.0), self.shift_mm, -1.0);
        plus(times(&transposed(&self.turn(degrees)), from), self.centre_mm, 1.0)
    }
}

/// A machine: axes of the table from the workpiece on, of the head from the bed on, and which of the two angles each has.
struct Machine {
    table: Vec<(Rotary, usize)>,
    head: Vec<(Rotary, usize)>,
    /// EC0Y, EB0Z, EA0Z, rad.
    square_rad: Vector,
}

impl Machine {
    fn read(text: &str) -> Self {
        let profile: toml::Table = text.parse().expect("TOML");
        let chain = profile["chain"].as_str().expect("a text");
        let (before, after) = chain.split_once('X').expect("an X");
        let rotary = |part: &str| {
            let letters = part.chars().filter(|c| "ABC".contains(*c));
            letters.map(|c| (Rotary::read(&profile, c), usize::from(c == 'C'))).collect()
        };
        let square = |key: &str| 1e-6 * profile["squareness"][key].as_float().expect("a number");
        Self {
            table: rotary(before),
            head: rotary(after),
            square_rad: ["EC0Y_urad", "EB0Z_urad", "EA0Z_urad"].map(square),
        }
    }

    /// As on the drawing, which is what the control computes with.
    fn perfect(text: &str) -> Self {
        let mut machine = Self::read(text);
        machine.square_rad = [0.0; 3];
        for (rotary, _) in machine.table.iter_mut().chain(&mut machine.head) {
            (rotary.shift_mm, rotary.lean_rad) = ([0.0; 3], [0.0; 3]);
        }
        machine
    }

    /// From the gauge point to the tip.
    fn tool(&self, angles: [f64; 2]) -> Vector {
        let tip = [0.0, 0.0, -LENGTH_MM];
        self.head.iter().rev().fold(tip, |v, (rotary, k)| rotary.carries(v, angles[*k]))
    }

    /// Where X, Y and Z stand with the tip there.
    fn axes(&self, tip_mm: Vector, angles: [f64; 2]) -> Vector {
        let there = self.table.iter().fold(tip_mm, |v, (rotary, k)| rotary.carries(v, angles[*k]));
        plus(there, self.tool(angles), -1.0)
    }

    /// Tip and direction of the tool in the workpiece.
    fn place(&self, [x, y, z]: Vector, angles: [f64; 2]) -> [Vector; 2] {
        let [c, b, a] = self.square_rad;
        let at = [x - c * y + b * z, y - a * z, z];
        let mut tip = plus(at, self.tool(angles), 1.0);
        let mut towards = [0.0, 0.0, 1.0];
        for (rotary, k) in self.head.iter().rev() {
            towards = times(&rotary.turn(angles[*k]), towards);
        }
        for (rotary, k) in self.table.iter().rev() {
            tip = rotary.undoes(tip, angles[*k]);
            towards = times(&transposed(&rotary.turn(angles[*k])), towards);
        }
        [tip, unit(towards)]
    }
}

/// A stretch of the program, a share of the way along it.
fn between(from: &Place, to: &Place, share: f64) -> (Vector, [f64; 2]) {
    let at = |a: f64, b: f64| a + share * (b - a);
    let tip = [0, 1, 2].map(|i| at(from.tip_mm[i], to.tip_mm[i]));
    (tip, [at(from.tilt_deg, to.tilt_deg), at(from.c_deg, to.c_deg)])
}

/// Largest errors over the wall: along its normal, um; of the tip, um; of the tool's direction, urad.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    wall_um: f64,
    tip_um: f64,
    tilt_urad: f64,
}

impl Worst {
    /// One place of the tool against the stretch that it belongs to: a share of it, or the nearest place.
    ///
    /// Along the motion a tool that is early or late cuts the same wall, but where it turns it has the direction of
    /// elsewhere: so machines that are tens of micrometres off are compared at the same share.
    fn meet(
        &mut self,
        ideal: &Machine,
        [from, to]: [&Place; 2],
        [tip, towards]: [Vector; 2],
        share: Option<f64>,
    ) {
        let along = plus(to.tip_mm, from.tip_mm, -1.0);
        let share = share.unwrap_or_else(|| dot(plus(tip, from.tip_mm, -1.0), along) / dot(along, along));
        let wanted = |share: f64| {
            let (tip, angles) = between(from, to, share);
            ideal.place(ideal.axes(tip, angles), angles)
        };
        let [here, upright] = wanted(share);
        let [behind, ahead] = [wanted(0.0), wanted(1.0)];
        let (off, lean) = (plus(tip, here, -1.0), plus(towards, upright, -1.0));
        self.tip_um = self.tip_um.max(1e3 * dot(off, off).sqrt());
        self.tilt_urad = self.tilt_urad.max(1e6 * dot(lean, lean).sqrt());
        for k in 0..=8 {
            let up = WALL_MM * f64::from(k) / 8.0;
            let on_axis = |place: &[Vector; 2]| plus(place[0], place[1], up);
            // The flank touches where its normal is across the tool and across its motion.
            let normal = unit(cross(upright, plus(on_axis(&ahead), on_axis(&behind), -1.0)));
            self.wall_um = self.wall_um.max(1e3 * dot(plus(off, lean, up), normal).abs());
        }
    }
}

/// Which of the places that are run is the end of each programmed block.
fn ends(ideal: &Machine, real: &Machine, programmed: &[Place], ran: &[Place]) -> Vec<usize> {
    let mut next = 0;
    let mut found = Vec::new();
    for (k, wanted) in programmed.iter().enumerate() {
        let reaches = |place: &Place| {
            let angles = [place.tilt_deg, place.c_deg];
            let [tip, _] = real.place(ideal.axes(place.tip_mm, angles), angles);
            let off = plus(tip, wanted.tip_mm, -1.0);
            let turned = (place.tilt_deg - wanted.tilt_deg).abs().max((place.c_deg - wanted.c_deg).abs());
            // Of the uncorrected machines no tip is off by 0.3 mm, and no two places are that near to each other.
            dot(off, off) < 0.09 && turned < 0.05 && (place.feeds || !wanted.feeds)
        };
        let many = ran[next..].iter().take(40).position(reaches);
        next += many.unwrap_or_else(|| panic!("place {k} is not reached: {:?}", wanted.tip_mm)) + 1;
        found.push(next - 1);
    }
    found
}

fn worst(ideal: &Machine, real: &Machine, programmed: &[Place], ran: &[Place], is_corrected: bool) -> Worst {
    let mut worst = Worst::default();
    let mut first = 0;
    for (k, last) in ends(ideal, real, programmed, ran).into_iter().enumerate() {
        // The first feed goes down to the wall, and not along it.
        if k > 1 && programmed[k].feeds && programmed[k - 1].feeds {
            let stretch = [&programmed[k - 1], &programmed[k]];
            for piece in ran[first.max(1) - 1..=last].windows(2) {
                for part in 0..=8 {
                    let share = f64::from(part) / 8.0;
                    let (tip, angles) = between(&piece[0], &piece[1], share);
                    let place = real.place(ideal.axes(tip, angles), angles);
                    worst.meet(ideal, stretch, place, (!is_corrected).then_some(share));
                }
            }
        }
        first = last + 1;
    }
    worst
}

/// A profile without play of its rotary axes, under which directions are not corrected.
fn without_play(chain: &str) -> String {
    let path = root().join(format!("samples/profiles/five_axis_{chain}.toml"));
    let text = std::fs::read_to_string(path).expect("readable");
    let lines = text.lines().filter(|line| !line.starts_with("backlash_urad"));
    lines.collect::<Vec<_>>().join("\n") + "\n[correction]\ntolerance_um = 1.0\norientation_urad = 20.0\n"
}

#[test]
fn full_brings_the_wall_within_tolerance_and_lever() {
    let mut table = String::new();
    for (chain, program) in s_walls() {
        let folder = tempfile::tempdir().expect("a folder");
        let [from, to, machine] = ["wall.ngc", "out.ngc", "machine.toml"]
            .map(|name| folder.path().join(name).to_str().expect("plain").to_owned());
        let profile = without_play(chain);
        std::fs::write(&from, &program).expect("writable");
        std::fs::write(&machine, &profile).expect("writable");
        let (ideal, real) = (Machine::perfect(&profile), Machine::read(&profile));
        let programmed = places(&program);
        assert!(programmed.len() > 220, "{chain}: {} places", programmed.len());
        let before = worst(&ideal, &real, &programmed, &programmed, false);
        let after = ["xyz", "full"].map(|orientation| {
            let options = ["-m", &machine, "--zero", "true", "-d", "linuxcnc", "--orientation", orientation];
            let ran = run(&[&[from.as_str(), "-o", &to], &options[..]].concat());
            assert!(ran.status.success(), "{chain} {orientation}: {}", messages(&ran));
            let check = run(&[&["check", &from, &to], &options[..]].concat());
            assert!(check.status.success(), "{chain}: {}", String::from_utf8_lossy(&check.stdout));
            let text = std::fs::read_to_string(&to).expect("readable");
            worst(&ideal, &real, &programmed, &places(&text), true)
        });
        let [tip_alone, full] = after;
        // Half a step of X, Y and Z may come on top of the tolerance.
        let tip_um = 1.0 + 0.5 * 3.0_f64.sqrt();
        let orientation_urad = 20.0;
        assert!(before.wall_um > 8.0 && before.tilt_urad > 30.0, "{chain}: {} um", before.wall_um);
        assert!(tip_alone.tip_um < tip_um && full.tip_um < tip_um, "{chain}");
        // The tip alone: what the lean does over the height of the wall stays.
        assert!((tip_alone.tilt_urad - before.tilt_urad).abs() < 12.0, "{chain}");
        assert!(full.tilt_urad < orientation_urad, "{chain}: {} urad", full.tilt_urad);
        let allowed_um = 1.0 + 1e-3 * WALL_MM * orientation_urad;
        assert!(full.wall_um < allowed_um && tip_alone.wall_um > full.wall_um + 0.5, "{chain}: {full:?}");
        writeln!(
            table,
            "| `{chain}` | {:.1} | {:.1} | {:.1} | {:.0} | {:.0} | {:.0} |",
            before.wall_um,
            tip_alone.wall_um,
            full.wall_um,
            before.tilt_urad,
            tip_alone.tilt_urad,
            full.tilt_urad
        )
        .expect("a string takes all");
    }
    println!("{table}");
    let page = std::fs::read_to_string(root().join("docs/five-axis.md")).expect("readable");
    assert!(page.contains(&table), "docs/five-axis.md has\n{table}");
}
