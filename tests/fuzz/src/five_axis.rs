//! Programs of a grammar with rotary words, for the tilting table of `tests/profiles/fuzz_five_axis.toml`.

use std::fmt::Write;

use arbitrary::Unstructured;

const DIALECTS: [&str; 3] = ["fanuc", "linuxcnc", "sinumerik"];

/// A program and its dialect; every choice comes from `bytes`, and they decide how long it gets.
#[must_use]
pub(crate) fn program(bytes: &[u8]) -> (&'static str, Vec<u8>) {
    let mut chance = Unstructured::new(bytes);
    let dialect = DIALECTS[chance.int_in_range(0..=2_usize).unwrap_or(0)];
    let damages = chance.int_in_range(0..=11_u8).unwrap_or(0).saturating_sub(8);
    let mut writer = Writer { chance, dialect, text: String::new(), tip: [0; 3], turned: [0; 2] };
    writer.say(if dialect == "sinumerik" { "G17 G710 G90 G94 G54" } else { "G17 G21 G90 G94 G54" });
    let zero = writer.rotary([0, 0]);
    writer.say(&format!("G0 {zero}"));
    let mut parts = 0;
    while parts < 6 && (parts == 0 || !writer.chance.is_empty()) {
        writer.part();
        parts += 1;
    }
    writer.say("M30");
    let mut text = writer.text.into_bytes();
    for _ in 0..damages {
        damage(&mut text, &mut writer.chance);
    }
    (dialect, text)
}

/// A byte is changed, left out or doubled, or a line is.
fn damage(text: &mut Vec<u8>, chance: &mut Unstructured<'_>) {
    let Some(last) = text.len().checked_sub(1) else { return };
    let at = chance.int_in_range(0..=last).unwrap_or(0);
    let line = |text: &[u8]| {
        let start = text[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let end = text[at..].iter().position(|byte| *byte == b'\n').map_or(text.len(), |end| at + end + 1);
        start..end
    };
    match chance.int_in_range(0..=4_u8).unwrap_or(0) {
        0 => text[at] = b"0123456789.-GMXYZABCIJKF= "[chance.int_in_range(0..=25_usize).unwrap_or(0)],
        1 => drop(text.remove(at)),
        2 => drop(text.drain(line(text))),
        3 => {
            let copy = text[line(text)].to_vec();
            text.splice(at..at, copy);
        }
        _ => text.insert(at, b"0123456789.-"[chance.int_in_range(0..=11_usize).unwrap_or(0)]),
    }
}

struct Writer<'a> {
    chance: Unstructured<'a>,
    dialect: &'static str,
    text: String,
    /// Where the words have put X, Y and Z, thousandths of a millimetre.
    tip: [i64; 3],
    /// And A and C, thousandths of a degree.
    turned: [i64; 2],
}

impl Writer<'_> {
    fn say(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn below(&mut self, n: u32) -> u32 {
        self.chance.int_in_range(0..=n - 1).unwrap_or(0)
    }

    /// Up to `reach` thousandths either way.
    fn step(&mut self, reach: i64) -> i64 {
        i64::from(self.chance.arbitrary::<i16>().unwrap_or(0)) * reach / i64::from(i16::MAX)
    }

    fn number(&self, thousandths: i64) -> String {
        let sign = if thousandths < 0 { "-" } else { "" };
        let text = format!("{sign}{}.{:03}", thousandths.abs() / 1000, thousandths.abs() % 1000);
        let text = text.trim_end_matches('0');
        if self.dialect == "sinumerik" { text.trim_end_matches('.').to_owned() } else { text.to_owned() }
    }

    fn rotary(&mut self, [a, c]: [i64; 2]) -> String {
        let (a_text, c_text) = (self.number(a), self.number(c));
        let equals = if self.dialect == "sinumerik" { "=" } else { "" };
        if equals == "="
            && (0..360_000).contains(&c)
            && (c - self.turned[1]).abs() < 170_000
            && self.below(4) == 0
        {
            self.turned = [a, c];
            return format!("A={a_text} C=DC({c_text})");
        }
        self.turned = [a, c];
        format!("A{equals}{a_text} C{equals}{c_text}")
    }

    fn linear(&mut self, [x, y, z]: [i64; 3]) -> String {
        self.tip = [x, y, z];
        format!("X{} Y{} Z{}", self.number(x), self.number(y), self.number(z))
    }

    fn place(&mut self, high: bool) -> String {
        let z = if high { 50_000 } else { 0 };
        let to = [self.step(40_000), self.step(40_000), z + self.step(8_000)];
        self.linear(to)
    }

    fn angles(&mut self) -> String {
        let to = [-20_000 + self.step(24_000), self.step(200_000)];
        self.rotary(to)
    }

    /// A little on from where all axes stand.
    fn on(&mut self, turns: bool) -> String {
        let reach = [300, 3_000, 15_000][self.below(3) as usize];
        let to = [0, 1, 2].map(|axis| self.tip[axis] + self.step(reach));
        let mut words = self.linear(to);
        if turns {
            let [a, c] = self.turned;
            let to = [(a + self.step(reach)).clamp(-60_000, 25_000), c + self.step(3 * reach)];
            let turned = match self.below(8) {
                0 => String::new(),
                1 => {
                    self.turned[1] = to[1];
                    let equals = if self.dialect == "sinumerik" { "=" } else { "" };
                    format!("C{equals}{}", self.number(to[1]))
                }
                _ => self.rotary(to),
            };
            let _ = write!(words, " {turned}");
        }
        words
    }

    fn part(&mut self) {
        match self.below(8) {
            0 => self.indexed(),
            1 => self.plane(),
            2 => self.vectors(),
            3 | 4 => self.led(),
            _ => self.axes(),
        }
    }

    /// Rotary axes positioned, then a cut of the linear axes.
    fn indexed(&mut self) {
        let (angles, place) = (self.angles(), self.place(true));
        self.say(&format!("G0 {angles}"));
        self.say(&format!("G0 {place}"));
        for n in 0..=self.below(5) {
            let on = self.on(false);
            self.say(&format!("G1 {on}{}", if n == 0 { " F500" } else { "" }));
        }
    }

    /// All axes at once, as axis commands; by chance under inverse time.
    fn axes(&mut self) {
        let (angles, place) = (self.angles(), self.place(true));
        self.say(&format!("G0 {place} {angles}"));
        let timed = self.below(4) == 0;
        if timed {
            self.say("G93");
        }
        for n in 0..=self.below(7) {
            let on = self.on(true);
            let feed = if timed {
                " F30."
            } else if n == 0 {
                " F600."
            } else {
                ""
            };
            self.say(&format!("G1 {on}{feed}"));
        }
        if timed {
            self.say("G94");
        }
    }

    /// The tip led by the control.
    fn led(&mut self) {
        let (on, off) = match self.dialect {
            "fanuc" => ("G43.4 H1", "G49"),
            "linuxcnc" => ("G43 H1\nM428", "M429\nG49"),
            _ => ("TRAORI", "TRAFOOF"),
        };
        self.say(on);
        let (place, angles) = (self.place(false), self.angles());
        self.say(&format!("G0 {place} {angles}"));
        let timed = self.below(6) == 0;
        if timed {
            self.say("G93");
        }
        for n in 0..=self.below(9) {
            let on = self.on(true);
            let feed = if timed {
                " F30."
            } else if n == 0 {
                " F600."
            } else {
                ""
            };
            self.say(&format!("G1 {on}{feed}"));
        }
        if timed {
            self.say("G94");
        }
        self.say(off);
        let place = self.place(true);
        self.say(&format!("G0 {place}"));
    }

    /// Directions as vectors, the tip led.
    fn vectors(&mut self) {
        let (on, off, names) = match self.dialect {
            "sinumerik" => ("TRAORI", "TRAFOOF", ["A3=", "B3=", "C3="]),
            "fanuc" => ("G43.5 H1", "G49", ["I", "J", "K"]),
            _ => return self.led(),
        };
        let angles = self.rotary([-20_000, 40_000]);
        self.say(&format!("G0 {angles}"));
        self.say(on);
        let place = self.place(false);
        let mut toward = [220, 260, 940];
        for n in 0..=self.below(7) {
            let words = if n == 0 { place.clone() } else { self.on(false) };
            let code = match n {
                0 => "G0",
                _ => "G1",
            };
            let feed = if n == 1 { " F600." } else { "" };
            let vector: Vec<String> =
                (0..3).map(|axis| format!("{}{}", names[axis], self.number(toward[axis]))).collect();
            self.say(&format!("{code} {words} {}{feed}", vector.join(" ")));
            toward = [toward[0] + self.step(60), toward[1] + self.step(60), toward[2]];
        }
        self.say(off);
        let place = self.place(true);
        self.say(&format!("G0 {place}"));
    }

    /// A tilted plane, its angles programmed or found by the control.
    fn plane(&mut self) {
        let tilt = 1_000 * i64::from(1 + self.below(50));
        match self.dialect {
            "fanuc" => {
                let turned = self.rotary([-tilt, 0]);
                let by_rule = self.below(2) == 0;
                if !by_rule {
                    self.say(&format!("G0 {turned}"));
                }
                self.say(&format!("G68.2 X0. Y0. Z0. I0. J{} K0.", self.number(tilt)));
                if by_rule {
                    self.say("G53.1");
                }
                self.cut("G43 H1");
                self.say("G49\nG69");
            }
            "sinumerik" => {
                self.turned = [-tilt, 0];
                self.say(&format!(
                    "CYCLE800(0,\"\",0,57,0,0,0,{},0,0,0,0,0,-1)",
                    self.number(tilt).trim_end_matches('.')
                ));
                self.cut("");
                self.say("CYCLE800()");
            }
            _ => return self.indexed(),
        }
        let place = self.place(true);
        self.say(&format!("G0 {place}"));
    }

    fn cut(&mut self, length: &str) {
        self.say("G0 X0. Y0.");
        self.say(&format!("G0 {length} Z40."));
        self.tip = [0, 0, 40_000];
        for n in 0..=self.below(4) {
            let on = self.on(false);
            self.say(&format!("G1 {on}{}", if n == 0 { " F500." } else { "" }));
        }
        if self.below(2) == 0 {
            let [x, y, z] = self.tip;
            let radius = 1_000 + self.step(900);
            self.say(&format!(
                "G2 X{} Y{} I{} J0.",
                self.number(x + 2 * radius),
                self.number(y),
                self.number(radius)
            ));
            self.say(&format!("G0 Z{}", self.number(z + 30_000)));
        }
    }
}
