//! What stands for motions among motions: corners, polar words, counted cycles, codes beside coordinates, calls by name, a
//! control's own cycles, lathes.

use super::Writer;

/// A program of the same posts with shorthand in it; `dialect` as in [`super::program`], lathes with their system behind
/// a blank.
#[must_use]
pub fn shorthand(bytes: &[u8], dialect: &str) -> String {
    let (name, system) = dialect.split_once(' ').unwrap_or((dialect, ""));
    let mut writer = Writer::new(bytes, name);
    if system.is_empty() {
        // With points: who mixes both ways of writing lengths is refused (VP0241), and little of it would be seen.
        let style = 2 * writer.below(16);
        writer.opening(style);
        while !writer.chance.is_empty() && writer.blocks < 60 {
            if writer.one_in(2) {
                writer.short();
            } else {
                writer.part();
            }
        }
        writer.closing();
    } else {
        writer.lathe(system);
    }
    writer.text
}

impl Writer<'_> {
    fn place(&mut self) -> String {
        let (u, v) = (self.step(40_000), self.step(40_000));
        format!("{} {}", self.word('X', u), self.word('Y', v))
    }

    fn size(&mut self) -> String {
        let size = 200 + self.below(3_000);
        self.number(size)
    }

    fn beside(&mut self) -> String {
        let codes = [
            "", "", "G54", "G55", "G43 H2", "G40", "G17", "G94", "M8", "G90", "G21", "G49", "G80", "G64",
            "G4 P1", "G53", "T2", "D1",
        ];
        self.pick(&codes).to_owned()
    }

    /// Anything that a reader with a memory of its own may forget.
    fn short(&mut self) {
        let (a, b) = (self.place(), self.place());
        let (beside, size) = (self.beside(), self.size());
        // A program that its control refuses whole shows nothing: mostly what the dialect has.
        let foreign = self.one_in(16);
        let has = |dialects: &[&str], writer: &Self| foreign || dialects.contains(&writer.dialect.as_str());
        match self.below(16) {
            0..=2 if self.dialect == "sinumerik" => {
                let name = self.pick(&["RND", "CHR", "CHF"]).to_owned();
                self.say(&format!("G1 {a} {name}={size}"));
                self.say(&b);
            }
            0..=2 if has(&["fanuc", "haas", "mitsubishi", "okuma"], self) => {
                let letter = self.pick(&[",R", ",C"]).to_owned();
                self.say(&format!("G1 {a} {letter}{size}"));
                self.say(&b);
            }
            3 => self.say(&format!("{beside} G0 {a}")),
            4 => self.say(&format!("{beside} {a}")),
            5 if has(&["fanuc", "haas", "mitsubishi"], self) => {
                self.say("G16");
                let (radius, angle) = (10 + self.below(30), self.below(360));
                self.say(&format!("{beside} G0 X{radius}. Y{angle}."));
                self.say(&format!("Y{}.", self.blocks % 360));
                self.say("G15");
            }
            6 if has(&["fanuc", "haas", "mitsubishi"], self) => {
                self.say("G68 R30.");
                self.say(&format!("G1 {a}"));
                self.say("G69");
            }
            7..=8 if has(&["fanuc", "haas", "mitsubishi", "linuxcnc"], self) => {
                let count = self.below(5);
                let back = self.pick(&["G98", "G99"]).to_owned();
                let letter = if foreign {
                    self.pick(&["K", "L"])
                } else if self.dialect == "fanuc" {
                    "K"
                } else {
                    "L"
                };
                self.say(&format!("G91 {back} G81 X2. Y1. Z-3. R-1. {letter}{count} F100."));
                if self.one_in(2) {
                    self.say("X1.");
                }
                self.say("G80 G90");
            }
            9 => self.say(&format!("/{beside} G1 {a}")),
            10 => self.say(&format!("G91 {beside} G1 X1. Y2.")),
            11 if self.dialect == "okuma" => {
                self.say("G71 Z60.");
                let back = self.pick(&["M53", "M54"]).to_owned();
                self.say(&format!("G81 {a} Z-5. R2. F100 {back}"));
                self.say(&b);
                self.say("G80");
            }
            12 => self.called(&a, &b, &beside),
            _ => self.say(&format!("G1 {a}")),
        }
    }

    /// Siemens: cycles, patterns and dimensions by name.
    fn called(&mut self, a: &str, b: &str, beside: &str) {
        if self.dialect != "sinumerik" {
            return self.say(a);
        }
        match self.below(7) {
            0 => self.say("CYCLE81(60,0,2,-10)"),
            1 => self.say("CYCLE83(60,0,2,-10,,,4,1,0,0,1,0)"),
            2 => {
                self.say("MCALL CYCLE82(60,0,2,-10,,0.5)");
                self.say(&format!("{beside} {a}"));
                self.say(b);
                self.say("HOLES1(10,10,30,5,8,3)");
                self.say("MCALL");
            }
            3 => self.say("G1 X=IC(5) Y=AC(20) F200"),
            4 => self.say("G91 G1 X=AC(25) Y=IC(2)"),
            5 => self.say("G3 X=IC(10) Y=IC(10) AR=90"),
            _ => self.say("G2 I5 J0 AR=120"),
        }
    }

    /// A lathe's program, X a diameter.
    fn lathe(&mut self, system: &str) {
        let [turn, face, pattern] = match system {
            "C" => ["G72", "G73", "G74"],
            _ => ["G71", "G72", "G73"],
        };
        self.say(if system == "A" { "G21 G18 G40 G99" } else { "G21 G18 G40 G95 G90 G98" });
        self.say("T0101");
        self.say("G0 X60. Z5.");
        self.say("G97 S800 M3 F.2");
        while !self.chance.is_empty() && self.blocks < 50 {
            let (x, z) = (20 + self.below(30), -self.below(30));
            let size = self.size();
            let incremental = if system == "A" { "" } else { self.pick(&["", "", "G91", "G90"]) }.to_owned();
            let wait =
                self.pick(&["", "", "G54", "G55", "T0202", "M8", "G4 U1.", "G98", "G99", "G40"]).to_owned();
            match self.below(14) {
                0 => self.say(&format!("{incremental} G1 X{x}. ,R{size}\nZ{z}.")),
                1 => self.say(&format!("{incremental} G1 Z{z}. ,C{size}\nX{x}.")),
                2 => self.say(&format!("{wait} G0 X{x}. Z{}.", 2 + z.abs())),
                3 => self.say(&format!("{incremental} G1 X{x}. Z{z}.")),
                4 if system == "A" => self.say(&format!("G1 U{}. W-1.", self.blocks % 3)),
                4 => self.say("G91 G1 X1. Z-1."),
                5 => self.say(&format!("G0 X0 Z5.\n{incremental} {wait} G83 Z-20. R-3. Q5000 F.1")),
                6 => self.say(&format!("G0 X30. Z5.\n{incremental} G83 X0 Z-20. R-3. F.1")),
                7 => self.say("G0 X0 Z5.\nG85 Z-20. R-3. F.1"),
                8 => {
                    let (code, n) = (if self.one_in(3) { face } else { turn }, 100 + 10 * self.blocks);
                    self.say("G0 X64. Z2.");
                    self.say(&format!("{code} U2. W2. R1."));
                    let contour = if code == face {
                        format!("N{n} G0 Z-20.\nG1 X40.\nN{} Z1.", n + 1)
                    } else {
                        format!("N{n} G0 X20.\n{incremental} G1 Z-20. ,R1.\nX40.\nN{} Z-30.", n + 1)
                    };
                    self.say(&format!("{code} P{n} Q{} U.4 W.1 F.2 M9\n{contour}", n + 1));
                    if self.one_in(2) {
                        self.say(&format!("G70 P{n} Q{} F.1", n + 1));
                    }
                }
                9 => {
                    let n = 100 + 10 * self.blocks;
                    self.say("G0 X64. Z2.");
                    self.say(&format!("{pattern} U4. W1. R3"));
                    self.say(&format!(
                        "{pattern} P{n} Q{} U.4 W.1 F.2\nN{n} G0 X20.\nG1 Z-20.\nN{} X40.",
                        n + 1,
                        n + 1
                    ));
                }
                10 => {
                    let code = match system {
                        "A" => "G90",
                        "B" => "G77",
                        _ => "G20",
                    };
                    self.say(&format!("G0 X60. Z2.\n{code} X{x}. Z{z}.\nX{}.\nG0 X62.", x - 2));
                }
                11 => self.say(&format!(
                    "G0 X60. Z2.\n{} X{x}. Z{z}. P1000 Q2000",
                    if system == "C" { "G75" } else { "G74" }
                )),
                12 => self.say(&format!("/{wait} G1 X{x}.")),
                _ => self.say("G0 X60. Z5."),
            }
        }
        self.say("M30");
    }
}
