//! The programs that are measured: as long as wanted, the same bytes every time.

use std::io::{self, Write};

use units::math::{cos, sin};

/// What opens every program: one operation with one tool.
const OPENING: &str =
    "%\nO1000\nG17 G21 G40 G49 G80 G90 G94\nG54\nT1 M6\nG43 H1\nS12000 M3\nG0 X0. Y0. Z30.\n";
const CLOSING: &str = "G0 Z30.\nM5\nM30\n%\n";
/// Millimetres from block to block, what CAM systems write for finishing.
const STEP_MM: f64 = 0.4;
/// The part lies within ± this of the program's zero in X and Y, mm.
const HALF_MM: [f64; 2] = [130.0, 90.0];

/// A tool that wanders over a wavy surface in small straight steps; all three axes move in every block.
struct Surface {
    turned: f64,
    position: [f64; 2],
}

impl Surface {
    fn next(&mut self) -> [f64; 3] {
        self.turned += 0.003;
        // A slow rosette that fills the part: the way along a Lissajous curve at nearly even speed.
        let (u, v) = (self.turned * 0.31, self.turned * 0.43);
        let target = [HALF_MM[0] * sin(u), HALF_MM[1] * cos(v)];
        let way = [target[0] - self.position[0], target[1] - self.position[1]];
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt().max(1e-9);
        for (position, way) in self.position.iter_mut().zip(way) {
            *position += way / length * STEP_MM;
        }
        let [x, y] = self.position;
        [x, y, 8.0 + 3.0 * sin(x * 0.05) * cos(y * 0.04)]
    }
}

/// How the blocks of a surface are written.
#[derive(Clone, Copy)]
pub(crate) enum Spelling {
    /// `X1. Y2. Z3.`
    Dense,
    /// The same with a comment behind.
    Commented,
    /// The same under G91.
    Increments,
    /// One axis in each block, by turns.
    OneAxis,
}

/// Writes at least `bytes` of straight feed motion.
pub(crate) fn surface(spelling: Spelling, bytes: u64, out: &mut impl Write) -> io::Result<()> {
    out.write_all(OPENING.as_bytes())?;
    surface_blocks(spelling, bytes, out)?;
    out.write_all(CLOSING.as_bytes())
}

/// The same, three coordinates in a block.
pub(crate) fn dense(bytes: u64, out: &mut impl Write) -> io::Result<()> {
    surface(Spelling::Dense, bytes, out)
}

/// Many of [`dense`] as operations of one program: only the marks and the end of the program stand once.
pub(crate) fn dense_parts(parts: impl Iterator<Item = u64>, out: &mut impl Write) -> io::Result<()> {
    let (marks, opening) = OPENING.split_at(OPENING.find('G').unwrap_or(0));
    let (closing, end) = CLOSING.split_at(CLOSING.find("M30").unwrap_or(0));
    out.write_all(marks.as_bytes())?;
    for bytes in parts {
        out.write_all(opening.as_bytes())?;
        surface_blocks(Spelling::Dense, bytes.saturating_sub((OPENING.len() + CLOSING.len()) as u64), out)?;
        out.write_all(closing.as_bytes())?;
    }
    out.write_all(end.as_bytes())
}

fn surface_blocks(spelling: Spelling, bytes: u64, out: &mut impl Write) -> io::Result<()> {
    let mut written = 0;
    let mut surface = Surface { turned: 0.0, position: [0.0, HALF_MM[1]] };
    let [x, y, z] = surface.next();
    writeln!(out, "G1 X{x:.3} Y{y:.3} Z{z:.3} F1500.")?;
    let mut block = Vec::with_capacity(64);
    if let Spelling::Increments = spelling {
        writeln!(out, "G91")?;
    }
    let steps = |place: [f64; 3]| place.map(|mm| (mm * 1000.0).round());
    let (mut stands, mut turn) = (steps([x, y, z]), 0);
    while written < bytes {
        let place @ [x, y, z] = surface.next();
        block.clear();
        match spelling {
            Spelling::Dense => writeln!(block, "X{x:.3} Y{y:.3} Z{z:.3}")?,
            Spelling::Commented => writeln!(block, "X{x:.3} Y{y:.3} Z{z:.3} (c)")?,
            Spelling::Increments => {
                let to = steps(place);
                let [dx, dy, dz] = [0, 1, 2].map(|axis| (to[axis] - stands[axis]) / 1000.0);
                stands = to;
                writeln!(block, "X{dx:.3} Y{dy:.3} Z{dz:.3}")?;
            }
            Spelling::OneAxis => {
                writeln!(block, "{}{:.3}", toolpath::AXIS_NAMES[turn], place[turn])?;
                turn = (turn + 1) % 3;
            }
        }
        written += block.len() as u64;
        out.write_all(&block)?;
    }
    if let Spelling::Increments = spelling {
        writeln!(out, "G90")?;
    }
    Ok(())
}

/// Writes at least `bytes` of a program as shops have them: surfaces, pockets of arcs, drilled holes, rapids,
/// comments; nine bytes of ten are short straight moves.
pub(crate) fn mixed(bytes: u64, out: &mut impl Write) -> io::Result<()> {
    let mut written = 0;
    let mut surface = Surface { turned: 0.0, position: [0.0, HALF_MM[1]] };
    out.write_all(OPENING.as_bytes())?;
    let mut operation = 0_u32;
    let mut text = Vec::new();
    while written < bytes {
        text.clear();
        operation += 1;
        let [x, y, z] = surface.next();
        writeln!(text, "(OPERATION {operation}: SURFACE, STEP OVER 12 PERCENT)")?;
        writeln!(text, "G0 X{x:.3} Y{y:.3}\nZ{:.3}\nG1 Z{z:.3} F400.\nF1500.", z + 2.0)?;
        for _ in 0..400 {
            let [x, y, z] = surface.next();
            writeln!(text, "X{x:.3} Y{y:.3} Z{z:.3}")?;
        }
        writeln!(text, "G0 Z20.\n(OPERATION {operation}: POCKET)")?;
        let (cx, cy) = (f64::from(operation * 37 % 180) - 90.0, f64::from(operation * 53 % 120) - 60.0);
        writeln!(text, "X{:.3} Y{cy:.3}\nG1 Z4. F300.", cx + 5.0)?;
        for ring in 0..4 {
            let radius = 5.0 + 1.5 * f64::from(ring);
            writeln!(text, "G1 X{:.3} Y{cy:.3} F900.", cx + radius)?;
            writeln!(text, "G3 X{:.3} Y{cy:.3} I{:.3} J0.", cx - radius, -radius)?;
            writeln!(text, "G3 X{:.3} Y{cy:.3} I{radius:.3} J0.", cx + radius)?;
        }
        writeln!(text, "G0 Z20.\n(OPERATION {operation}: HOLES)")?;
        writeln!(text, "G99 G81 X{:.3} Y{:.3} Z-4. R12. F150.", cx - 20.0, cy)?;
        for hole in 1..5 {
            writeln!(text, "X{:.3} Y{:.3}", cx - 20.0 + 8.0 * f64::from(hole), cy)?;
        }
        writeln!(text, "G80\nG0 Z30.")?;
        written += text.len() as u64;
        out.write_all(&text)?;
    }
    out.write_all(CLOSING.as_bytes())
}

/// A sample of `samples/five_axis` cut again and again, from its first positioning to the end of its tool length.
pub(super) fn again(sample: &str, bytes: u64, mut out: impl Write) -> std::io::Result<()> {
    let lines = || sample.split_inclusive('\n');
    let first = lines().take_while(|line| !line.starts_with("G0 ")).map(str::len).sum::<usize>();
    let last = sample.rfind("G49\n").map_or(sample.len(), |at| at + "G49\n".len());
    out.write_all(&sample.as_bytes()[..first])?;
    let mut written = first as u64;
    while written < bytes {
        out.write_all(&sample.as_bytes()[first..last])?;
        written += (last - first) as u64;
    }
    out.write_all(&sample.as_bytes()[last..])
}
