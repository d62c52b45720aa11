//! A plan as an NC program: the same lines, with a stop for each reading.

use std::fmt::Write;

use diagnostic::notice;
use machine_model::Vector;
use nc_syntax::{Paren, Semicolon};

use super::line::{DWELL_S, Line, Spot};
use crate::message::{Failure, OPTION};
use crate::settings::Settings;

/// Feed of the way between lines, mm/min.
const BETWEEN_MM_MIN: f64 = 1000.0;

/// Blocks of one dialect.
struct Blocks<'a> {
    out: String,
    settings: &'a Settings,
    /// Machine coordinates of the program's zero.
    zero_mm: [f64; 3],
    high_z_mm: f64,
    /// Of the rotary axes that turn.
    letters: Vec<(usize, char)>,
}

/// The rotary axes that turn in a plan.
fn turning(plan: &[Line]) -> Vec<(usize, char)> {
    let turns =
        |axis: usize| plan.iter().flat_map(|line| &line.stops).any(|stop| stop.rotary_deg[axis] != 0.0);
    ['A', 'B', 'C'].into_iter().enumerate().filter(|(axis, _)| turns(*axis)).collect()
}

/// The program: slow, Z up between lines, both ways along each, a dwell at every stop.
pub(super) fn text(plan: &[Line], title: &str, settings: &Settings) -> Result<String, Failure> {
    let Some((offset, zero_mm)) = settings.setup.work_offsets.first().cloned() else {
        return Err(Failure::usage(notice!(OPTION;
            "the program needs a work offset, and the profile has none",
            "программе нужно смещение нуля, а в профиле его нет";
            "add `--work-offset G54=0,0,0` with the machine coordinates of its zero",
            "добавьте `--work-offset G54=0,0,0` с координатами станка его нуля"
        )));
    };
    let spots = |line: &Line| {
        let (before, passed) = line.swing.as_ref()?;
        Some(passed.iter().flatten().map(|spot| spot.at_mm.z).fold(before.at_mm.z, f64::max))
    };
    let high = |line: &Line| spots(line).unwrap_or(f64::MIN).max(line.before_mm.z).max(line.turn_mm.z);
    let high_z_mm = plan.iter().map(high).fold(f64::MIN, f64::max);
    let letters = turning(plan);
    let mut blocks = Blocks { out: String::new(), settings, zero_mm, high_z_mm, letters };
    let name = settings.dialect.name.as_str();
    if name == "fanuc" {
        blocks.block("%");
        blocks.block("O9010");
    }
    blocks.comment(title);
    blocks.comment("no workpiece on the table, spindle off");
    blocks.comment(&format!("axis positions are machine coordinates less {offset}"));
    let (units, no_length) = match name {
        // Tool lengths are taken in there by words that vpost leaves to the operator.
        "balt-system" | "sinumerik" => ("G71", None),
        _ => ("G21", Some("G49")),
    };
    blocks.block(&format!("G17 {units} G90 G94 {offset}"));
    match no_length {
        Some(block) => blocks.block(block),
        None => blocks.comment("take off the tool length by hand before this"),
    }
    blocks.comment("the first moves are rapids, z up and then across: override low");
    if let Some(first) = plan.first() {
        blocks.block(&format!("G0 Z{}", blocks.number(2, blocks.high_z_mm)));
        if !blocks.letters.is_empty() {
            blocks.block(&format!("G0 {}", blocks.angles([0.0; 3])));
        }
        let (x, y) = (blocks.number(0, first.before_mm.x), blocks.number(1, first.before_mm.y));
        blocks.block(&format!("G0 X{x} Y{y}"));
    }
    let mut tool_mm = None;
    for line in plan {
        blocks.comment(&line.run);
        if tool_mm != Some(line.tool_mm) {
            let t = line.tool_mm;
            blocks.comment(&format!("target at {:.1} {:.1} {:.1} mm from the gauge point", t.x, t.y, t.z));
            blocks.block("M0");
            tool_mm = Some(line.tool_mm);
        }
        if line.wait_s > 0.0 {
            blocks.comment(&format!("let the axes run for {:.0} minutes first", line.wait_s / 60.0));
            blocks.block("M0");
        }
        if let Some((before, passed)) = &line.swing {
            blocks.swing(line, before, passed);
            continue;
        }
        blocks.to(line.before_mm);
        blocks.block(&format!("F{:.0}.", line.feed_mm_min));
        let half = line.stops.len() / 2;
        for (at, stop) in line.stops.iter().enumerate() {
            if at == half {
                blocks.line(line.turn_mm);
            }
            blocks.line(stop.at_mm);
            if !line.flying {
                blocks.rest();
            }
        }
        blocks.line(line.before_mm);
    }
    blocks.block(&format!("G1 Z{} F{BETWEEN_MM_MIN:.0}.", blocks.number(2, blocks.high_z_mm)));
    blocks.block("M30");
    if name == "fanuc" {
        blocks.block("%");
    }
    Ok(blocks.out)
}

impl Blocks<'_> {
    fn block(&mut self, text: &str) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.out, "{text}");
    }

    /// A comment in capitals and plain letters, as every control shows it; nothing where the dialect has none.
    fn comment(&mut self, text: &str) {
        let dialect = &self.settings.dialect;
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || " -.".contains(c) { c.to_ascii_uppercase() } else { ' ' }
        };
        let plain: String = nc_emit::ascii(text).chars().map(plain).collect();
        if matches!(dialect.marks.paren, Paren::Comment { .. }) {
            self.block(&format!("({plain})"));
        } else if dialect.marks.semicolon == Semicolon::Comment {
            self.block(&format!("; {plain}"));
        }
    }

    /// A program coordinate with a decimal point.
    fn number(&self, axis: usize, machine_mm: f64) -> String {
        let value = format!("{:.3}", machine_mm - self.zero_mm[axis]);
        if value == "-0.000" { "0.000".to_owned() } else { value }
    }

    fn line(&mut self, at_mm: Vector) {
        let words: Vec<String> =
            (0..3).map(|a| format!("{}{}", ["X", "Y", "Z"][a], self.number(a, at_mm[a]))).collect();
        self.block(&format!("G1 {}", words.join(" ")));
    }

    /// Words of the rotary axes.
    fn angles(&self, rotary_deg: [f64; 3]) -> String {
        let equals = if self.settings.dialect.name == "sinumerik" { "=" } else { "" };
        let word = |(axis, letter): &(usize, char)| {
            // Half steps of what stops are rounded to.
            let number = format!("{:.3}", rotary_deg[*axis] + 0.0);
            format!("{letter}{equals}{}", if number == "-0.000" { "0.000" } else { &number })
        };
        self.letters.iter().map(word).collect::<Vec<_>>().join(" ")
    }

    /// A line on which rotary axes turn: Z up before they stand where it begins, and when they go back to 0.
    fn swing(&mut self, line: &Line, before: &Spot, passed: &[Vec<Spot>]) {
        let up = self.number(2, self.high_z_mm);
        self.block(&format!("G1 Z{up} F{BETWEEN_MM_MIN:.0}."));
        self.comment("rotary axes turn by a rapid");
        self.block(&format!("G0 {}", self.angles(before.rotary_deg)));
        self.to(before.at_mm);
        self.block(&format!("F{:.0}.", line.feed_mm_min));
        for (stop, passed) in line.stops.iter().zip(passed) {
            for spot in passed {
                self.turned(spot.at_mm, spot.rotary_deg);
            }
            self.turned(stop.at_mm, stop.rotary_deg);
            self.rest();
        }
        self.block(&format!("G1 Z{up} F{BETWEEN_MM_MIN:.0}."));
        self.block(&format!("G0 {}", self.angles([0.0; 3])));
    }

    /// To a place while rotary axes turn.
    fn turned(&mut self, at_mm: Vector, rotary_deg: [f64; 3]) {
        let words: Vec<String> =
            (0..3).map(|a| format!("{}{}", ["X", "Y", "Z"][a], self.number(a, at_mm[a]))).collect();
        self.block(&format!("G1 {} {}", words.join(" "), self.angles(rotary_deg)));
    }

    /// To the beginning of a line: Z up, across, Z down, all at a feed that an operator can stop.
    fn to(&mut self, at_mm: Vector) {
        let up = self.number(2, self.high_z_mm);
        let (x, y) = (self.number(0, at_mm.x), self.number(1, at_mm.y));
        self.block(&format!("G1 Z{up} F{BETWEEN_MM_MIN:.0}."));
        self.block(&format!("G1 X{x} Y{y}"));
        self.block(&format!("G1 Z{}", self.number(2, at_mm.z)));
    }

    /// A dwell in the form of the control; a stop for the operator where that form is not known for certain.
    fn rest(&mut self) {
        let block = match self.settings.dialect.name.as_str() {
            "fanuc" => format!("G4 X{DWELL_S:.1}"),
            "linuxcnc" | "centroid" => format!("G4 P{DWELL_S:.1}"),
            "sinumerik" => format!("G4 F{DWELL_S:.1}"),
            _ => "M0".to_owned(),
        };
        self.block(&block);
    }
}
