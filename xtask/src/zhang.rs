//! The table of Zhang 2024 (China Mechanical Engineering 35(6)) in the publication's own matrices and formulas: for
//! tests and docs, without a line of the product's model.
//!
//! Chain TZXYMACW: the tool stands in the machine, A in the machine, C on A, the workpiece on C. Numbers in brackets are the
//! publication's. mm and rad; the origin is where A and C should cross.

#![allow(dead_code, reason = "the page and the test use their own parts of this")]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use units::math::{cos, sin};

pub(crate) type Vector = [f64; 3];
/// The upper three rows of a homogeneous matrix.
type Matrix = [[f64; 4]; 3];

/// Nominal length of the bar (L), distance of the tool ball from the axis that does not turn (Z_B1C, Z_B1A).
pub(crate) const BAR_MM: f64 = 100.0;
pub(crate) const LEVER_MM: f64 = 100.0;
/// From the crossing down to the table's surface (Z_CM). Its number is not printed; readings do not depend on it.
const TABLE_MM: f64 = 50.0;

/// Names of the eight errors in the publication and in ISO 230-1, in the order of [`Table::errors`].
pub(crate) const NAMES: [(&str, &str); 8] = [
    ("δYA", "EY0A"),
    ("δZA", "EZ0A"),
    ("SYA", "EB0A"),
    ("SZA", "EC0A"),
    ("δXC", "EX0C"),
    ("δYC", "EY0C"),
    ("SXC", "EA0C"),
    ("SYC", "EB0C"),
];

/// A crooked table, and how far off the spindle's axis the tool ball sits in its cup.
#[derive(Clone, Copy)]
pub(crate) struct Table {
    /// δYA δZA SYA SZA δXC δYC SXC SYC, mm and rad.
    pub(crate) errors: [f64; 8],
    /// eX eY.
    pub(crate) cup_mm: [f64; 2],
}

/// The machine of the experiment. Printed are the largest position error and the cup (section 3.1); that SYC is large, SYA
/// and SZA small, is said in words (section 3.2); all other sizes are ours, as Table 4 is not legible in our copy.
pub(crate) const OF_THE_EXPERIMENT: Table = Table {
    errors: [25.9e-3, -60.4e-3, 22e-6, -17e-6, 203.5e-3, -48.2e-3, 64e-6, 240e-6],
    cup_mm: [-0.0403, -0.0765],
};

/// Table 1: all positions 10 um, all angles 0.005 degrees.
pub(crate) const OF_THE_SIMULATION: Table = Table {
    errors: [10e-3, 10e-3, 87.266e-6, 87.266e-6, 10e-3, 10e-3, 87.266e-6, 87.266e-6],
    cup_mm: [-0.0403, -0.0765],
};

/// Lengths as an instrument shows them: noise and its last digit, 0.1 um. The source gives no noise; 1 um (one standard
/// deviation) is more than makers state for a bar of 100 mm.
pub(crate) fn instrument(seed: u64) -> impl FnMut(f64) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move |length_mm| {
        let normal = (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        ((length_mm + 1e-3 * normal) * 1e4).round() * 1e-4
    }
}

/// What turns, all else standing.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Mode {
    /// A, tool ball at the crossing.
    One,
    /// A, tool ball beside it along X.
    Two,
    /// C, tool ball at the crossing.
    Three,
    /// C, tool ball above it.
    Four,
}

pub(crate) const MODES: [Mode; 4] = [Mode::One, Mode::Two, Mode::Three, Mode::Four];

impl Mode {
    pub(crate) fn turns_a(self) -> bool {
        matches!(self, Self::One | Self::Two)
    }

    /// Where the tool ball is commanded to be, from the crossing.
    pub(crate) fn tool_ball_mm(self) -> Vector {
        match self {
            Self::One | Self::Three => [0.0; 3],
            Self::Two => [LEVER_MM, 0.0, 0.0],
            Self::Four => [0.0, 0.0, LEVER_MM],
        }
    }

    /// From the tool ball to the other at angle 0: (1), (7), (10), (16).
    pub(crate) fn bar_mm(self) -> Vector {
        if self.turns_a() { [0.0, -BAR_MM, 0.0] } else { [BAR_MM, 0.0, 0.0] }
    }
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = [[0.0; 4]; 3];
    for (row, left) in out.iter_mut().zip(a) {
        for (k, cell) in row.iter_mut().enumerate() {
            *cell = (0..3).map(|j| left[j] * b[j][k]).sum::<f64>() + if k == 3 { left[3] } else { 0.0 };
        }
    }
    out
}

fn carried(m: &Matrix, v: Vector) -> Vector {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2] + row[3])
}

/// Exact, by cofactors: the printed matrices of small angles are not quite rotations.
fn inverse(m: &Matrix) -> Matrix {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    let mut out = [[0.0; 4]; 3];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, cell) in row.iter_mut().enumerate().take(3) {
            *cell = minor(j, i) / determinant;
        }
        row[3] = -(0..3).map(|j| row[j] * m[j][3]).sum::<f64>();
    }
    out
}

pub(crate) fn distance(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

impl Table {
    /// A table as on the drawing.
    pub(crate) const PERFECT: Self = Self { errors: [0.0; 8], cup_mm: [0.0; 2] };

    /// (2): from A's frame to the machine's.
    fn a(&self, angle: f64) -> Matrix {
        let [y, z, s_y, s_z, ..] = self.errors;
        let (s, c) = (sin(angle), cos(angle));
        let error = [[1.0, -s_z, s_y, 0.0], [s_z, 1.0, 0.0, y], [-s_y, 0.0, 1.0, z]];
        times(&error, &[[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0]])
    }

    /// (11): from C's frame to A's.
    fn c(&self, angle: f64) -> Matrix {
        let [_, _, _, _, x, y, s_x, s_y] = self.errors;
        let (s, c) = (sin(angle), cos(angle));
        let error = [[1.0, 0.0, s_y, x], [0.0, 1.0, -s_x, y], [-s_y, s_x, 1.0, 0.0]];
        times(&error, &[[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, -TABLE_MM]])
    }

    /// From the workpiece's frame to the machine's.
    fn pose(&self, a: f64, c: f64) -> Matrix {
        times(&self.a(a), &self.c(c))
    }

    /// Where a tool tip in the machine is in the workpiece, whose frame is the machine's on a table as drawn, axes at 0.
    pub(crate) fn in_workpiece(&self, tip_mm: Vector, a: f64, c: f64) -> Vector {
        let [x, y, z] = carried(&inverse(&self.pose(a, c)), tip_mm);
        [x, y, z - TABLE_MM]
    }

    /// The other way: where X, Y and Z bring a tip that belongs there.
    pub(crate) fn in_machine(&self, tip_mm: Vector, a: f64, c: f64) -> Vector {
        carried(&self.pose(a, c), [tip_mm[0], tip_mm[1], tip_mm[2] + TABLE_MM])
    }

    /// How far the tool leans in the workpiece from where it leans on a table as drawn, rad.
    pub(crate) fn tilt(&self, a: f64, c: f64) -> f64 {
        let upright = |table: &Self| {
            let m = inverse(&table.pose(a, c));
            let v = [m[0][2], m[1][2], m[2][2]];
            v.map(|x| x / distance(v, [0.0; 3]))
        };
        // The chord: as good as the angle where that is small.
        distance(upright(self), upright(&Self::PERFECT))
    }

    fn balls_at_zero(&self, mode: Mode) -> (Vector, Vector) {
        let [x, y, z] = mode.tool_ball_mm();
        let tool = [x + self.cup_mm[0], y + self.cup_mm[1], z];
        let bar = mode.bar_mm();
        (tool, [0, 1, 2].map(|i| tool[i] + bar[i]))
    }

    /// Length of the bar by the matrices: (3), (4) exactly, (12) to (14).
    pub(crate) fn length_mm(&self, mode: Mode, angle: f64) -> f64 {
        let pose = |at: f64| if mode.turns_a() { self.a(at) } else { times(&self.a(0.0), &self.c(at)) };
        let (tool, other) = self.balls_at_zero(mode);
        distance(tool, carried(&times(&pose(angle), &inverse(&pose(0.0))), other))
    }

    /// Length of the bar to a ball 100 mm along X while the spindle turns (Fig. 7).
    pub(crate) fn spindle_length_mm(&self, angle: f64) -> f64 {
        let [x, y] = self.cup_mm;
        let (s, c) = (sin(angle), cos(angle));
        distance([c * x - s * y, s * x + c * y, 0.0], [x + BAR_MM, y, 0.0])
    }

    /// x, y, z of the bar as printed in (6), (9), (15), (18), whose squares add up to the square of its length.
    pub(crate) fn printed_bar_mm(&self, mode: Mode, angle: f64) -> Vector {
        let [y_a, z_a, s_ya, s_za, x_c, y_c, s_xc, s_yc] = self.errors;
        let [e_x, e_y] = self.cup_mm;
        let (s, c, l, lever) = (sin(angle), cos(angle), BAR_MM, LEVER_MM);
        let both = s_ya + s_yc;
        let along_x = l * (s_za + s_ya * s - s_za * c);
        let upwards = l * (both * (1.0 - c) + s_xc * s);
        match mode {
            Mode::One => {
                [along_x, (e_y - l - y_a) * c + z_a * s + y_a - e_y, (e_y - l - y_a) * s - z_a * c + z_a]
            }
            Mode::Two => [
                along_x,
                (e_y - l - y_a - lever * s_za) * c + lever * s_za - (lever * s_ya - z_a) * s + y_a - e_y,
                (e_y - l - y_a - lever * s_za) * s + (lever * s_ya - z_a) * c - lever * s_ya + z_a,
            ],
            Mode::Three => [
                (l + e_x - x_c) * c + (y_a + y_c - e_y) * s + x_c - e_x,
                (l + e_x - x_c) * s - (y_a + y_c - e_y) * c + y_a + y_c - e_y,
                upwards,
            ],
            Mode::Four => [
                (l + e_x - x_c - lever * both) * c
                    + (y_a + y_c - e_y - lever * s_xc) * s
                    + lever * both
                    + x_c
                    - e_x,
                (l + e_x - x_c - lever * both) * s - (y_a + y_c - e_y - lever * s_xc) * c - lever * s_xc
                    + y_a
                    + y_c
                    - e_y,
                upwards,
            ],
        }
    }

    /// The change of length as printed in (19) to (22).
    pub(crate) fn printed_change_mm(&self, mode: Mode, angle: f64) -> f64 {
        let [y_a, z_a, s_ya, s_za, x_c, y_c, s_xc, s_yc] = self.errors;
        let [e_x, e_y] = self.cup_mm;
        let [by_cos, by_sin, one] = match mode {
            Mode::One => [e_y - y_a, -z_a, y_a - e_y],
            Mode::Two => [e_y - y_a - LEVER_MM * s_za, LEVER_MM * s_ya - z_a, y_a - e_y + LEVER_MM * s_za],
            Mode::Three => [x_c - e_x, y_a + y_c - e_y, e_x - x_c],
            Mode::Four => {
                let lever = LEVER_MM * (s_ya + s_yc);
                [x_c - e_x + lever, y_a + y_c - e_y - LEVER_MM * s_xc, e_x - x_c - lever]
            }
        };
        by_cos * cos(angle) + by_sin * sin(angle) + one
    }

    /// x of the other ball in the first test: as printed in (4), and by the matrices.
    pub(crate) fn x_of_the_first_test_mm(&self, angle: f64) -> [f64; 2] {
        let [_, _, s_ya, s_za, ..] = self.errors;
        let e_x = self.cup_mm[0];
        let printed = e_x - BAR_MM * s_za + BAR_MM * (s_ya * sin(angle) - s_za * cos(angle));
        let (_, other) = self.balls_at_zero(Mode::One);
        [printed, carried(&times(&self.a(angle), &inverse(&self.a(0.0))), other)[0]]
    }
}

/// Every five degrees, over the turn; few tables tilt all the way round. 0 is where the other ball was put.
pub(crate) fn angles_deg(mode: Mode) -> impl Iterator<Item = i32> {
    let range = if mode.turns_a() { -90..=90 } else { 0..=360 };
    range.step_by(5)
}

/// A table for `vpost calibrate ballbar`: the four tests and a spindle turn, a reading every five degrees, `runs` times.
pub(crate) fn readings_csv(table: &Table, runs: usize, mut read_mm: impl FnMut(f64) -> f64) -> String {
    let mut text = String::from("run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,a_deg,c_deg,spindle_deg,length_mm\n");
    let mut row = |run: &str, tool: Vector, bar: Vector, angles: [f64; 3], length: f64| {
        let cells: Vec<String> = tool
            .into_iter()
            .chain([0, 1, 2].map(|i| tool[i] + bar[i]))
            .chain(angles)
            .map(|v| v.to_string())
            .collect();
        text += &format!("{run},{},{length:.4}\n", cells.join(","));
    };
    for (mode, name) in MODES.into_iter().zip(["A1", "A2", "C3", "C4"]) {
        for _ in 0..runs {
            for degrees in angles_deg(mode).map(f64::from) {
                let angles = if mode.turns_a() { [degrees, 0.0, 0.0] } else { [0.0, degrees, 0.0] };
                let length = read_mm(table.length_mm(mode, degrees.to_radians()));
                row(name, mode.tool_ball_mm(), mode.bar_mm(), angles, length);
            }
        }
    }
    for _ in 0..runs {
        for degrees in angles_deg(Mode::Three).map(f64::from) {
            let length = read_mm(table.spindle_length_mm(degrees.to_radians()));
            row("spindle", [0.0; 3], [BAR_MM, 0.0, 0.0], [0.0, 0.0, degrees], length);
        }
    }
    text
}
