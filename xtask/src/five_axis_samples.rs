//! Five-axis programs for docs and tests: parts as tips and tool directions, posted for three chains and three dialects.
//!
//! A part knows no machine. With tool centre point control a program holds tips and angles; without it what an ideal
//! machine with the centres below makes of them, which are those of `samples/profiles/five_axis_*.toml`; program zero is
//! that of the machine.

use std::f64::consts::{PI, TAU};

use units::math::{acos, atan2, cos, sin, sin_cos};

type Vector = [f64; 3];

/// Of the tool H1, mm.
const LENGTH_MM: f64 = 120.0;
/// A point of the table's A and of its C.
const TABLE_A_MM: Vector = [0.0, 0.0, -60.0];
const TABLE_C_MM: Vector = [0.0, 0.0, -40.0];
/// A point of a head's B, from the gauge point.
const HEAD_B_MM: Vector = [0.0, 0.0, 90.0];
/// How far the tool is lifted between cuts, along itself, mm.
const LIFT_MM: f64 = 80.0;

/// Where the tip is, and which way the tool points from there.
#[derive(Clone, Copy)]
struct Place {
    tip_mm: Vector,
    towards: Vector,
}

/// One cut: reached from above, fed along, left upwards.
struct Part {
    name: &'static str,
    title: &'static str,
    machine: Machine,
    cuts: Vec<Vec<Place>>,
}

#[derive(Clone, Copy, PartialEq)]
enum Machine {
    /// `[w C A X Y b Z t]`
    TableTable,
    /// `[w C X Y b Z B t]`
    HeadTable,
    /// `[w X Y b Z C B t]`
    HeadHead,
}

#[derive(Clone, Copy, PartialEq)]
enum Dialect {
    Fanuc,
    Sinumerik,
    Linuxcnc,
}

fn add(a: Vector, b: Vector, by: f64) -> Vector {
    [0, 1, 2].map(|i| a[i] + by * b[i])
}

fn unit(v: Vector) -> Vector {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Turned about X, Y or Z (0, 1, 2) through a point, degrees.
fn turned(v: Vector, axis: usize, degrees: f64, centre: Vector) -> Vector {
    let (sin, cos) = sin_cos(degrees.to_radians());
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let (a, b) = (v[i] - centre[i], v[j] - centre[j]);
    let mut to = v;
    (to[i], to[j]) = (centre[i] + cos * a - sin * b, centre[j] + sin * a + cos * b);
    to
}

impl Machine {
    fn letters(self) -> [char; 2] {
        if self == Self::TableTable { ['A', 'C'] } else { ['B', 'C'] }
    }

    fn name(self) -> &'static str {
        match self {
            Self::TableTable => "TABLE-TABLE A C",
            Self::HeadTable => "HEAD B, TABLE C",
            Self::HeadHead => "HEAD-HEAD C B",
        }
    }

    /// Angles of the tilting axis and of C, degrees, C as near to where it was as whole turns bring it.
    fn angles(self, towards: Vector, before_c: f64) -> [f64; 2] {
        let [x, y, z] = towards;
        let tilt = acos(z.clamp(-1.0, 1.0)).to_degrees();
        if tilt < 1e-9 {
            return [0.0, before_c];
        }
        let (tilt, c) = match self {
            // `Rz(-C) Rx(-A) z`, A below 0.
            Self::TableTable => (-tilt, atan2(-x, -y)),
            Self::HeadTable => (tilt, atan2(-y, x)),
            Self::HeadHead => (tilt, atan2(y, x)),
        };
        let c = c.to_degrees();
        [tilt, c + 360.0 * ((before_c - c) / 360.0).round()]
    }

    /// Where X, Y and Z of an ideal machine stand with the tip there.
    fn axes(self, tip_mm: Vector, [tilt, c]: [f64; 2]) -> Vector {
        let tool = [0.0, 0.0, -LENGTH_MM];
        let none = [0.0; 3];
        match self {
            Self::TableTable => {
                let on_c = turned(tip_mm, 2, c, TABLE_C_MM);
                add(turned(on_c, 0, tilt, TABLE_A_MM), tool, -1.0)
            }
            Self::HeadTable => add(turned(tip_mm, 2, c, TABLE_C_MM), turned(tool, 1, tilt, HEAD_B_MM), -1.0),
            Self::HeadHead => add(tip_mm, turned(turned(tool, 1, tilt, HEAD_B_MM), 2, c, none), -1.0),
        }
    }
}

/// Writes blocks, leaving out words that say nothing new.
struct Writer {
    dialect: Dialect,
    letters: [char; 2],
    text: String,
    last: [Option<String>; 5],
}

impl Writer {
    fn number(&self, value: f64) -> String {
        let text = format!("{value:.3}");
        let short = text.trim_end_matches('0').trim_end_matches('.');
        let short = if short == "-0" { "0" } else { short };
        if self.dialect == Dialect::Fanuc && !short.contains('.') {
            format!("{short}.")
        } else {
            short.to_owned()
        }
    }

    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    /// X, Y, Z and both angles, as far as they are given and new.
    fn block(&mut self, code: &str, values: [Option<f64>; 5], more: &str) {
        let letters = ['X', 'Y', 'Z', self.letters[0], self.letters[1]];
        let mut words = Vec::new();
        for k in 0..5 {
            let Some(value) = values[k] else { continue };
            let number = self.number(value);
            if self.last[k].as_ref() != Some(&number) {
                let equals = if k > 2 && self.dialect == Dialect::Sinumerik { "=" } else { "" };
                words.push(format!("{}{equals}{number}", letters[k]));
                self.last[k] = Some(number);
            }
        }
        if !words.is_empty() {
            let code = if code.is_empty() { String::new() } else { format!("{code} ") };
            self.line(&format!("{code}{}{more}", words.join(" ")));
        }
    }
}

/// A part in the words of a dialect.
fn post(part: &Part, dialect: Dialect, tcp: bool) -> String {
    let machine = part.machine;
    let mut writer =
        Writer { dialect, letters: machine.letters(), text: String::new(), last: Default::default() };
    let kinematics = if tcp { "TCP" } else { "AXIS WORDS" };
    let title = format!("{}, {}, {kinematics}", part.title, machine.name());
    match dialect {
        Dialect::Fanuc => {
            writer.line("%\nO0018");
            writer.line(&format!("({title})\nG21 G17 G90 G94 G40 G49 G80 G54\nT1 M06\nS9000 M03"));
        }
        Dialect::Sinumerik => {
            writer.line(&format!(";{title}\nG17 G71 G90 G94 G40 G54\nT1\nM6\nD1\nS9000 M3"))
        }
        Dialect::Linuxcnc => writer.line(&format!("({title})\nG21 G17 G90 G94 G40 G49 G54\nT1 M6\nS9000 M3")),
    }
    let (on, off) = match (dialect, tcp) {
        (Dialect::Fanuc, true) => ("G43.4 H1", "G49"),
        (Dialect::Sinumerik, true) => ("TRAORI", "TRAFOOF"),
        (Dialect::Linuxcnc, true) => ("G43 H1\nM428", "M429\nG49"),
        (Dialect::Sinumerik, false) => ("", ""),
        (_, false) => ("G43 H1", "G49"),
    };
    let mut c = 0.0;
    let mut is_on = false;
    for cut in &part.cuts {
        let words = |place: &Place, lift: f64, before_c: f64| {
            let angles = machine.angles(place.towards, before_c);
            let tip = add(place.tip_mm, place.towards, lift);
            let [x, y, z] =
                if tcp { tip } else { add(machine.axes(tip, angles), [0.0, 0.0, LENGTH_MM], -1.0) };
            [x, y, z, angles[0], angles[1]]
        };
        let (Some(first), Some(last)) = (cut.first(), cut.last()) else { continue };
        let above = words(first, LIFT_MM, c);
        c = above[4];
        if !is_on {
            // From below, so that it is known on which side of their play the axes stand.
            writer.block("G0", [None, None, None, Some(above[3] - 1.0), Some(c - 1.0)], "");
        }
        if !(is_on && tcp) {
            // Under tip control the tip would go round with them.
            writer.block("G0", [None, None, None, Some(above[3]), Some(c)], "");
        }
        if !is_on {
            on.lines().for_each(|code| writer.line(code));
            is_on = true;
            (writer.last[0], writer.last[1], writer.last[2]) = (None, None, None);
        }
        writer.block("G0", above.map(Some), "");
        writer.block("G1", words(first, 0.0, c).map(Some), " F1200");
        for place in &cut[1..] {
            let to = words(place, 0.0, c);
            c = to[4];
            writer.block("", to.map(Some), "");
        }
        writer.block("G0", words(last, LIFT_MM, c).map(Some), "");
    }
    off.lines().for_each(|code| writer.line(code));
    writer.line("M5");
    writer.line("M30");
    if dialect == Dialect::Fanuc {
        writer.line("%");
    }
    writer.text
}

/// A cubic B-spline with uniform knots, at `t` of 0 to 1 from the second to the last point but one.
fn spline(points: &[Vector], t: f64) -> Vector {
    let spans = points.len() - 3;
    let at = (t * spans as f64).min(spans as f64 - 1e-12);
    let (k, u) = (at as usize, at.fract());
    let (one, two, three, rest) = (u, u * u, u * u * u, 1.0 - u);
    let weights = [
        rest * rest * rest / 6.0,
        (3.0 * three - 6.0 * two + 4.0) / 6.0,
        (3.0 * (one + two - three) + 1.0) / 6.0,
        three / 6.0,
    ];
    weights.iter().zip(&points[k..]).fold([0.0; 3], |sum, (weight, point)| add(sum, *point, *weight))
}

/// The flank of a cylinder along a ruled wall: from a curve below to one above, the radius to the left.
fn flank(
    below: impl Fn(f64) -> Vector,
    above: impl Fn(f64) -> Vector,
    radius_mm: f64,
    places: u32,
) -> Vec<Place> {
    let at = |k: u32| {
        let t = f64::from(k) / f64::from(places);
        let (from, to) = (below(t), above(t));
        let towards = unit(add(to, from, -1.0));
        let step = 1e-4;
        let (behind, ahead) = (below((t - step).max(0.0)), below((t + step).min(1.0)));
        let side = unit(cross(towards, unit(add(ahead, behind, -1.0))));
        Place { tip_mm: add(from, side, radius_mm), towards }
    };
    (0..=places).map(at).collect()
}

/// A wall shaped like an S that leans one way, then the other, as the test piece of ISO 10791-7; its control points are
/// invented, not the standard's.
fn s_piece() -> Part {
    let below = [
        [-110.0, -80.0],
        [-90.0, -40.0],
        [-80.0, 10.0],
        [-45.0, 50.0],
        [-5.0, 30.0],
        [5.0, -30.0],
        [45.0, -50.0],
        [80.0, -10.0],
        [90.0, 40.0],
        [110.0, 80.0],
    ];
    let lean = [
        [9.0, -6.0],
        [12.0, -4.0],
        [14.0, 4.0],
        [6.0, 14.0],
        [-8.0, 12.0],
        [-14.0, -4.0],
        [-8.0, -14.0],
        [8.0, -12.0],
        [14.0, 2.0],
        [12.0, 8.0],
    ];
    let low: Vec<Vector> = below.iter().map(|[x, y]| [*x, *y, 10.0]).collect();
    let high: Vec<Vector> = below.iter().zip(&lean).map(|([x, y], [u, v])| [x + u, y + v, 45.0]).collect();
    let cut = flank(|t| spline(&low, t), |t| spline(&high, t), 8.0, 220);
    Part { name: "s_piece", title: "S-SHAPED WALL", machine: Machine::TableTable, cuts: vec![cut] }
}

/// NAS 979: the flank of a cone of half angle 15 degrees whose base is tilted by 10 degrees and lies beside the table's axis.
fn cone_frustum() -> Part {
    let (radius, height, half_angle) = (45.0, 30.0, 15.0_f64.to_radians());
    let (sin_half, cos_half) = sin_cos(half_angle);
    let tilted = |v: Vector| turned(v, 1, 10.0, [0.0; 3]);
    let ring = |t: f64, up: f64| {
        let r = radius - up * sin_half / cos_half;
        add(tilted([r * cos(TAU * t), r * sin(TAU * t), up]), [30.0, 0.0, 25.0], 1.0)
    };
    let cut = flank(|t| ring(t, 0.0), |t| ring(t, height), -8.0, 240);
    Part { name: "cone_frustum", title: "CONE FRUSTUM NAS 979", machine: Machine::HeadHead, cuts: vec![cut] }
}

/// A blade-like wall whose ruling turns by 40 degrees along it, cut by the flank.
fn swarf() -> Part {
    let below = |t: f64| [-60.0 + 120.0 * t, 12.0 * sin(PI * t), 5.0];
    let above = |t: f64| {
        let lean = (-25.0 + 40.0 * t).to_radians();
        add(below(t), [10.0, 40.0 * sin(lean), 40.0 * cos(lean)], 1.0)
    };
    let cut = flank(below, above, 6.0, 200);
    Part { name: "swarf", title: "SWARF CUT", machine: Machine::HeadTable, cuts: vec![cut] }
}

/// A twisted blade on a conical hub: lines of a ball along it, the tool leaning away from the blade by 12 degrees and
/// towards the hub's axis where it comes nearer to it.
fn impeller_blade() -> Part {
    let blade = |t: f64, h: f64| {
        let angle = 0.9 * t + 0.15 * h + 0.4;
        let r = 28.0 + 34.0 * t;
        [r * cos(angle), r * sin(angle), 52.0 - 36.0 * t * t + 18.0 * h]
    };
    let line = |h: f64, back: bool| {
        let at = |k: u32| {
            let t = f64::from(if back { 60 - k } else { k }) / 60.0;
            let step = 1e-4;
            let along = |u: f64, v: f64| {
                unit(add(blade(t + u * step, h + v * step), blade(t - u * step, h - v * step), -1.0))
            };
            let normal = unit(cross(along(1.0, 0.0), along(0.0, 1.0)));
            let up = along(0.0, 1.0);
            let lean = 12.0_f64.to_radians();
            let towards =
                unit(add([up[0] * cos(lean), up[1] * cos(lean), up[2] * cos(lean)], normal, sin(lean)));
            // The ball's centre lies its radius beside the blade, the tip that much below it along the tool.
            let centre = add(blade(t, h), normal, 3.0);
            Place { tip_mm: add(centre, towards, -3.0), towards }
        };
        (0..=60).map(at).collect::<Vec<_>>()
    };
    let cut = (0..4).flat_map(|k| line(1.0 - f64::from(k) / 4.0, k % 2 == 1)).collect();
    Part { name: "impeller_blade", title: "IMPELLER BLADE", machine: Machine::TableTable, cuts: vec![cut] }
}

/// The five free faces of a cube turned by 20 degrees: a square contour on each, the axes indexed.
fn cube() -> Part {
    let half = 35.0;
    let centre = [0.0, 0.0, half];
    let place = |v: Vector| add(turned(v, 2, 20.0, [0.0; 3]), centre, 1.0);
    let faces: [(Vector, Vector); 5] = [
        ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
        ([-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
        ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
    ];
    let contour = |(out, along): &(Vector, Vector)| {
        let across = cross(*out, *along);
        let corner = |u: f64, v: f64| {
            let on_face = add(add([0.0; 3], *along, u), across, v);
            Place { tip_mm: place(add(on_face, *out, half - 2.0)), towards: turned(*out, 2, 20.0, [0.0; 3]) }
        };
        [(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0), (-20.0, -20.0)]
            .map(|(u, v)| corner(u, v))
            .to_vec()
    };
    let cuts = faces.iter().map(contour).collect();
    Part { name: "cube", title: "CUBE, FIVE FACES", machine: Machine::HeadTable, cuts }
}

/// Every file by name, with what stands in it.
pub(crate) fn files() -> Vec<(String, String)> {
    let parts = [s_piece(), cone_frustum(), swarf(), impeller_blade(), cube()];
    let dialects = [
        (Dialect::Fanuc, "fanuc", "nc"),
        (Dialect::Sinumerik, "sinumerik", "mpf"),
        (Dialect::Linuxcnc, "linuxcnc", "ngc"),
    ];
    let mut all = Vec::new();
    for part in &parts {
        for (dialect, name, ending) in dialects {
            for (tcp, kind) in [(true, "tcp"), (false, "axes")] {
                all.push((format!("{}_{name}_{kind}.{ending}", part.name), post(part, dialect, tcp)));
            }
        }
    }
    all
}

/// The S-shaped wall for every chain, by the name of its profile: LinuxCNC's words, tool centre point control.
#[allow(dead_code, reason = "a test asks for them")]
pub(crate) fn s_walls() -> [(&'static str, String); 3] {
    let machines = [
        ("table_table", Machine::TableTable),
        ("head_table", Machine::HeadTable),
        ("head_head", Machine::HeadHead),
    ];
    machines.map(|(name, machine)| (name, post(&Part { machine, ..s_piece() }, Dialect::Linuxcnc, true)))
}

/// The chain that a file is posted for, as its profile is named.
pub(crate) fn chain_of(file: &str) -> &'static str {
    match file.split('_').next() {
        Some("cone") => "head_head",
        Some("swarf" | "cube") => "head_table",
        _ => "table_table",
    }
}
