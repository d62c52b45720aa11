//! Programs of a grammar: what posts write, put together by chance, most of it sound.

use std::fmt::Write;

use arbitrary::Unstructured;

#[path = "mixed.rs"]
mod mixed;

pub use mixed::shorthand;

/// A program for a dialect; every choice comes from `bytes`, and they decide how long it gets.
#[must_use]
pub fn program(bytes: &[u8], dialect: &str) -> String {
    let mut writer = Writer::new(bytes, dialect);
    let style = writer.below(32);
    writer.opening(style);
    while !writer.chance.is_empty() && writer.blocks < 60 {
        writer.part();
    }
    writer.closing();
    writer.text
}

struct Writer<'a> {
    chance: Unstructured<'a>,
    dialect: String,
    text: String,
    /// Bodies that follow the end of the program, or precede it in LinuxCNC's files.
    subprograms: String,
    /// Where the program stands, in thousandths of its unit.
    at: [i64; 3],
    incremental: bool,
    plane: u8,
    inch: bool,
    points: bool,
    spaces: bool,
    numbered: bool,
    /// The mark of blocks that may be skipped.
    skip: &'static str,
    blocks: usize,
    /// Labels, loop numbers and subprograms so far.
    labels: usize,
}

impl<'a> Writer<'a> {
    fn new(bytes: &'a [u8], dialect: &str) -> Self {
        Self {
            chance: Unstructured::new(bytes),
            dialect: dialect.to_owned(),
            text: String::new(),
            subprograms: String::new(),
            at: [0; 3],
            incremental: false,
            plane: 17,
            inch: false,
            points: true,
            spaces: true,
            numbered: false,
            skip: "",
            blocks: 0,
            labels: 0,
        }
    }

    fn one_in(&mut self, n: u8) -> bool {
        self.chance.arbitrary::<u8>().is_ok_and(|byte| byte % n == 1)
    }

    fn below(&mut self, n: u64) -> i64 {
        i64::try_from(self.chance.int_in_range(0..=n - 1).unwrap_or(0)).unwrap_or(0)
    }

    fn pick<'t>(&mut self, from: &[&'t str]) -> &'t str {
        let at = self.below(from.len() as u64);
        from[usize::try_from(at).unwrap_or(0)]
    }

    /// A step of up to `reach` thousandths either way.
    fn step(&mut self, reach: i64) -> i64 {
        let low = i64::from(self.chance.arbitrary::<i16>().unwrap_or(0));
        low * reach / i64::from(i16::MAX)
    }

    fn number(&self, thousandths: i64) -> String {
        let sign = if thousandths < 0 { "-" } else { "" };
        let (whole, part) = (thousandths.abs() / 1000, thousandths.abs() % 1000);
        if self.points || self.dialect != "fanuc" {
            let text = format!("{sign}{whole}.{part:03}");
            text.trim_end_matches('0').to_owned()
        } else {
            // Least increments.
            format!("{sign}{}", thousandths.abs() * if self.inch { 10 } else { 1 })
        }
    }

    fn word(&self, letter: char, thousandths: i64) -> String {
        let equals = if self.dialect == "sinumerik" && self.points && self.spaces { "=" } else { "" };
        format!("{letter}{equals}{}", self.number(thousandths))
    }

    fn line(&mut self, words: &[String]) {
        self.blocks += 1;
        self.text.push_str(self.skip);
        if self.numbered {
            let _ = write!(self.text, "N{}", 10 * self.blocks);
            if self.spaces {
                self.text.push(' ');
            }
        }
        self.text.push_str(&words.join(if self.spaces { " " } else { "" }));
        self.text.push('\n');
    }

    fn say(&mut self, text: &str) {
        self.line(&[text.to_owned()]);
    }

    fn is_macro(&self) -> bool {
        matches!(self.dialect.as_str(), "fanuc")
    }

    /// The lowest bit of `style` set: lengths without points.
    fn opening(&mut self, style: i64) {
        self.points = style & 1 == 0;
        self.spaces = style & 2 == 0;
        self.numbered = style & 4 != 0 && self.dialect != "linuxcnc";
        self.inch = style & 24 == 24;
        if self.is_macro() {
            self.text.push_str("%\nO0001\n");
        }
        let unit = if self.inch { "G20" } else { "G21" };
        self.say(&format!("{unit} G17 G40 G90 G54"));
        if style & 8 != 0 {
            self.say("G43 H1");
        }
        self.again();
        self.say("F200.");
    }

    /// Goes to a place in all axes, absolutely: after it the program's place is known.
    fn again(&mut self) {
        if self.incremental {
            self.incremental = false;
            self.say("G90");
        }
        let reach = if self.inch { 4_000 } else { 90_000 };
        self.at = [self.step(reach), self.step(reach), self.step(reach)];
        let words: Vec<String> = (0..3).map(|i| self.word(['X', 'Y', 'Z'][i], self.at[i])).collect();
        self.line(&[&["G0".to_owned()][..], &words].concat());
    }

    fn reach(&mut self) -> i64 {
        match (self.below(4), self.inch) {
            (0, _) => 30,
            (1, _) => 1_500,
            (_, false) => 60_000,
            (_, true) => 2_400,
        }
    }

    fn target(&mut self, to: [i64; 3], axes: [bool; 3]) -> Vec<String> {
        let mut words = Vec::new();
        for i in 0..3 {
            if axes[i] {
                words.push(
                    self.word(['X', 'Y', 'Z'][i], if self.incremental { to[i] - self.at[i] } else { to[i] }),
                );
                self.at[i] = to[i];
            }
        }
        words
    }

    fn straight(&mut self, code: &str) {
        let axes = 1 + self.below(7);
        let axes = [axes & 1 != 0, axes & 2 != 0, axes & 4 != 0];
        let mut to = self.at;
        for (i, to) in to.iter_mut().enumerate() {
            if axes[i] {
                let reach = self.reach();
                *to += self.step(reach);
            }
        }
        let mut words: Vec<String> = if code.is_empty() { Vec::new() } else { vec![code.to_owned()] };
        words.extend(self.target(to, axes));
        match self.below(16) {
            0 => words.push("M8".to_owned()),
            1 => words.push("F350.".to_owned()),
            2 => words.push("(to the edge)".to_owned()),
            3 => words.push("S1500".to_owned()),
            4 if self.skip.is_empty() => words.insert(0, "/".to_owned()),
            _ => {}
        }
        self.line(&words);
    }

    fn arc(&mut self) {
        let (u, v, centre) = match self.plane {
            18 => (2, 0, ['K', 'I']),
            19 => (1, 2, ['J', 'K']),
            _ => (0, 1, ['I', 'J']),
        };
        let reach = self.reach().max(500);
        let radius = [self.step(reach), self.step(reach)];
        let clockwise = self.one_in(2);
        let quarter = self.below(5);
        // From the centre to the start, turned.
        let start = [-radius[0], -radius[1]];
        let end = match quarter {
            0 => start,
            1 => [-start[1], start[0]],
            2 => [-start[0], -start[1]],
            3 => [start[1], -start[0]],
            // Symmetric about an axis: on the circle, and at any angle.
            _ => [-start[0], start[1]],
        };
        let mut to = self.at;
        to[u] += radius[0] + end[0];
        to[v] += radius[1] + end[1];
        let helix = self.one_in(4);
        if helix {
            to[3 - u - v] += self.step(5_000);
        }
        let mut axes = [true; 3];
        axes[3 - u - v] = helix;
        if quarter == 0 && self.one_in(2) {
            axes = [false; 3];
        }
        let mut words = vec![if clockwise { "G2" } else { "G3" }.to_owned()];
        words.extend(self.target(to, axes));
        if (1..=3).contains(&quarter) && self.one_in(4) {
            // |R| exactly where it is a whole number; else left to the control's tolerance.
            let square = (radius[0] * radius[0] + radius[1] * radius[1]) as f64;
            let size = whole_root(square);
            words.push(self.word('R', size));
        } else {
            words.push(self.word(centre[0], radius[0]));
            words.push(self.word(centre[1], radius[1]));
        }
        self.line(&words);
    }

    /// A curve by control points in the plane of G17, mostly whole: LinuxCNC's G5, G5.1 or G5.2, elsewhere G6.2.
    fn curve(&mut self) {
        let reach = self.reach().max(500);
        let offset = |generator: &mut Self| [generator.step(reach), generator.step(reach)];
        let mut place = self.at;
        let [u, v] = offset(self);
        (place[0], place[1]) = (place[0] + u, place[1] + v);
        let linuxcnc = self.dialect == "linuxcnc";
        if linuxcnc && self.one_in(2) {
            let cubic = self.one_in(2);
            let mut words = vec![if cubic { "G5" } else { "G5.1" }.to_owned()];
            words.extend(self.target(place, [true, true, false]));
            let [i, j] = offset(self);
            if !cubic || !self.one_in(4) {
                words.extend([self.word('I', i), self.word('J', j)]);
            }
            if cubic {
                let [p, q] = offset(self);
                words.extend([self.word('P', p), self.word('Q', q)]);
            }
            self.line(&words);
            return;
        }
        let order = 3 + self.below(2);
        let points = order - i64::from(self.one_in(8)) + self.below(4);
        let begun = self.at;
        for k in 0..points {
            let [u, v] = if k == 0 && !linuxcnc { [0, 0] } else { offset(self) };
            let mut to = self.at;
            (to[0], to[1]) = (to[0] + u, to[1] + v);
            let mut words = Vec::new();
            if k == 0 {
                words.push(if linuxcnc { "G5.2" } else { "G6.2" }.to_owned());
                words.push(format!("{}{order}", if linuxcnc { 'L' } else { 'P' }));
            }
            words.extend(self.target(to, [true, true, false]));
            if self.incremental {
                // Each counts from the start.
                self.at = begun;
            }
            let weight = 500 + self.below(4) * 500;
            if linuxcnc {
                words.push(self.word('P', weight));
            } else {
                words.push(format!("K{}.", (k - order + 1).max(0)));
                words.push(format!("R{}.{}", weight / 1000, weight % 1000 / 100));
            }
            if self.one_in(8) {
                words.push("F250.".to_owned());
            }
            self.line(&words);
        }
        if !self.one_in(16) {
            if linuxcnc {
                self.say("G5.3");
            } else {
                (0..order).for_each(|_| self.say(&format!("K{}.", points - order + 1)));
            }
        }
        self.straight("G1");
    }

    fn cycle(&mut self) {
        let kind = self.below(8);
        let (deep, near) = (self.at[2] - 1_000 - self.below(9_000), self.at[2] - self.below(1_000));
        let code =
            ["G81", "G82", "G83", "G73", "G85", "G89", "G84", "G81"][usize::try_from(kind).unwrap_or(0)];
        let mut words = vec![self.pick(&["G98", "G99", ""]).to_owned(), code.to_owned()];
        let mut to = self.at;
        to[0] += self.step(9_000);
        to[1] += self.step(9_000);
        words.extend(self.target(to, [true, true, false]));
        if self.incremental {
            words.push(self.word('R', near - self.at[2]));
            words.push(self.word('Z', deep - near));
        } else {
            words.push(self.word('Z', deep));
            words.push(self.word('R', near));
        }
        match code {
            "G82" | "G89" => words.push("P0.5".to_owned()),
            "G83" | "G73" => {
                let peck = 300 + self.below(3_000);
                words.push(self.word('Q', peck));
            }
            _ => {}
        }
        if self.incremental && self.one_in(3) {
            words.push(if self.dialect == "linuxcnc" { "L3" } else { "K3" }.to_owned());
        }
        words.push("F120.".to_owned());
        words.retain(|word| !word.is_empty());
        self.line(&words);
        for _ in 0..self.below(4) {
            let mut to = self.at;
            let axis = usize::from(self.one_in(2));
            to[axis] += self.step(9_000);
            let words = self.target(to, [axis == 0, axis == 1, false]);
            self.line(&words);
        }
        let end = self.pick(&["G80", "G80", "G0"]);
        self.say(end);
        self.again();
    }

    /// Frames: after each the place in the program's own coordinates is said anew.
    fn frame(&mut self) {
        let (a, b) = (self.step(20_000), self.step(20_000));
        let [x, y] = [self.word('X', a), self.word('Y', b)];
        let angle = self.below(360);
        match self.below(12) {
            0 => self.say("G55"),
            1 => self.say("G54"),
            2 => self.say(&format!("G52 {x} {y}")),
            3 => self.say("G52 X0 Y0 Z0"),
            4 => self.say(&format!("G92 {x} {y}")),
            5 => self.say("G92.1"),
            6 if self.dialect == "linuxcnc" => self.say(&format!("G10 L2 P1 {x} {y} R{angle}.")),
            6 => self.say(&format!("G68 {x} {y} R{angle}.")),
            7 => self.say("G69"),
            8 => self.say("G51 X0 Y0 Z0 P1500"),
            9 => self.say("G51.1 X0"),
            10 => self.say("G50"),
            _ => self.say("G50.1 X0"),
        }
        self.again();
    }

    fn setting(&mut self) {
        let code = self.pick(&[
            "G17",
            "G18",
            "G19",
            "G90",
            "G91",
            "G43 H2",
            "G43 H1",
            "G49",
            "G61",
            "G64",
            "G94",
            "M3",
            "(note)",
            "G4 P1",
            "T2 M6",
            "G53 G0 Z300.",
            "G28 G91 Z0",
            "G20",
            "G21",
            "M1",
            "G80",
            "G40",
            "",
        ]);
        self.say(code);
        match code {
            "G17" => self.plane = 17,
            "G18" => self.plane = 18,
            "G19" => self.plane = 19,
            "G90" => self.incremental = false,
            "G91" => self.incremental = true,
            "G20" => self.inch = true,
            "G21" => self.inch = false,
            "G28 G91 Z0" => {
                self.incremental = true;
                self.again();
            }
            _ => {}
        }
        if matches!(code, "G43 H2" | "G43 H1" | "G49" | "T2 M6" | "G53 G0 Z300." | "G20" | "G21") {
            self.again();
        }
    }

    fn compensation(&mut self) {
        let side = self.pick(&["G41 D1", "G42 D2"]).to_owned();
        self.straight(&format!("G1 {side}"));
        for _ in 0..self.below(4) {
            self.straight("");
        }
        self.straight("G1 G40");
    }

    /// Loops, jumps, calls and variables. Bodies move in increments, or to computed places.
    fn flow(&mut self) {
        self.labels += 1;
        let (n, turns) = (self.labels, 1 + self.below(5));
        let (a, b) = (self.step(3_000), self.step(3_000));
        let [x, y] = [self.number(a), self.number(b)];
        let linuxcnc = self.dialect == "linuxcnc";
        if linuxcnc {
            match self.below(5) {
                0 => {
                    self.say(&format!("#{n}=0"));
                    self.say(&format!("o{n} while [#{n} LT {turns}]"));
                    self.say(&format!("G1 X[{x}+#{n}*2.5] Y[{y}*SIN[#{n}*30]]"));
                    self.say(&format!("#{n}=[#{n}+1]"));
                    self.say(&format!("o{n} endwhile"));
                }
                1 => {
                    self.say(&format!("o{n} repeat [{turns}]"));
                    self.say(&format!("G91 G1 X{x} Y{y}"));
                    self.say(&format!("o{n} endrepeat"));
                    self.say("G90");
                    self.incremental = false;
                }
                2 => {
                    let _ = write!(self.subprograms, "o{n} sub\nG91 G1 X#1 Y#2\nG90\no{n} endsub\n");
                    self.incremental = false;
                    for _ in 0..turns {
                        self.say(&format!("o{n} call [{x}] [{y}]"));
                    }
                }
                3 => {
                    self.say(&format!("#<w{n}>=[{x}*2]"));
                    self.say(&format!("o{n} if [#<w{n}> GT 0]"));
                    self.say(&format!("G1 X[#<w{n}>/3]"));
                    self.say(&format!("o{n} else"));
                    self.say(&format!("G1 Y[ABS[#<w{n}>]]"));
                    self.say(&format!("o{n} endif"));
                }
                _ => self.say(&format!("G1 X[SQRT[{turns}]*10] Y[[{x}+{y}]/4] Z[{turns}**2]")),
            }
        } else {
            match self.below(5) {
                0 => {
                    self.say(&format!("#{n}=0"));
                    self.say(&format!("WHILE[#{n}LT{turns}]DO1"));
                    self.say(&format!("G1 X[{x}+#{n}*2.5] Y[{y}*SIN[#{n}*30]]"));
                    self.say(&format!("#{n}=#{n}+1"));
                    self.say("END1");
                }
                1 => {
                    self.say(&format!("#{n}={x}"));
                    self.say(&format!("IF[#{n}GT0]GOTO{}", 7000 + n));
                    self.say(&format!("G1 Y{y}"));
                    self.text.push_str(&format!("N{}\n", 7000 + n));
                    self.say(&format!("G1 X#{n}"));
                }
                2 => {
                    let _ = write!(self.subprograms, "O{}\nG91 G1 X{x} Y{y}\nG90\nM99\n", 1000 + n);
                    self.incremental = false;
                    self.say(&format!("M98 P{} L{turns}", 1000 + n));
                }
                3 => {
                    let _ = write!(self.subprograms, "O{}\nG1 X#1 Y#2 Z[#3-#1]\nM99\n", 2000 + n);
                    self.say(&format!("G65 P{} A{x} B{y} C{turns}.", 2000 + n));
                }
                _ => self.say(&format!("G1 X[SQRT[{turns}]*10] Y[[{x}+{y}]/4] Z[{turns}*2]")),
            }
        }
        self.again();
    }

    /// Blocks that may be skipped, and a place that is the same after both ways.
    fn optional(&mut self) {
        self.skip = if self.one_in(4) { "/2" } else { "/" };
        for _ in 0..=self.below(4) {
            match self.below(8) {
                0..=2 => self.straight("G1"),
                3 => self.straight(""),
                4 => self.straight("G0"),
                5 => self.arc(),
                6 => self.cycle(),
                _ => self.setting(),
            }
        }
        if self.incremental {
            self.incremental = false;
            self.say("G90");
        }
        self.skip = "";
        self.again();
    }

    fn part(&mut self) {
        match self.below(35) {
            32 => self.optional(),
            33..=34 => self.curve(),
            0..=7 => self.straight("G1"),
            8..=10 => self.straight(""),
            11..=12 => self.straight("G0"),
            13..=18 => self.arc(),
            19..=21 => self.cycle(),
            22..=23 => self.frame(),
            24..=26 => self.setting(),
            27 => self.compensation(),
            28..=30 => self.flow(),
            _ => {
                let odd = self.pick(&[
                    "G93",
                    "G1 X1. Y1. F20.",
                    "G1 X10. ,R2.",
                    "G1 Y10. ,C1.",
                    "G16",
                    "G15",
                    "G90.1",
                    "G91.1",
                    "G5.1 Q1",
                    "G61.1",
                    "G0 A10.",
                    "G1 Z-5. G4 P1",
                    "G2 X1. Y1. R-5.",
                    "G1 X0.0005",
                    "G1 X1.23456789",
                    "M99",
                    "G83 Z-10. R1. Q0",
                    "G10 L2 P2 X1. Y1. Z1.",
                    "X10.Y10.",
                ]);
                self.say(odd);
            }
        }
    }

    fn closing(&mut self) {
        if self.dialect == "linuxcnc" {
            self.text.insert_str(0, &self.subprograms);
            self.text.push_str("M2\n");
        } else {
            self.text.push_str("M30\n");
            self.text.push_str(&self.subprograms);
            if self.is_macro() {
                self.text.push_str("%\n");
            }
        }
    }
}

/// Square root in whole thousandths.
fn whole_root(square: f64) -> i64 {
    square.sqrt().round() as i64
}
