//! A plan as an NC program: the same lines, with a stop for each reading.

use std::fmt::Write;

use diagnostic::both;
use machine_model::Vector;
use nc_syntax::dialect::{Paren, Semicolon};

use super::lines::{DWELL_S, Line};
use crate::message::Failure;
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
}

/// The program: slow, Z up between lines, both ways along each, a dwell at every stop.
pub(super) fn text(plan: &[Line], title: &str, settings: &Settings) -> Result<String, Failure> {
    let Some((offset, zero_mm)) = settings.setup.work_offsets.first().cloned() else {
        return Err(Failure::option(
            both!(
                "the program needs a work offset, and the profile has none",
                "программе нужно смещение нуля, а в профиле его нет"
            ),
            both!(
                "add `--work-offset G54=0,0,0` with the machine coordinates of its zero",
                "добавьте `--work-offset G54=0,0,0` с координатами станка его нуля"
            ),
        ));
    };
    let high_z_mm = plan.iter().flat_map(|l| [l.before_mm.z, l.turn_mm.z]).fold(f64::MIN, f64::max);
    let mut blocks = Blocks { out: String::new(), settings, zero_mm, high_z_mm };
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
        let plain: String = text.chars().map(plain).collect();
        if matches!(dialect.paren, Paren::Comment { .. }) {
            self.block(&format!("({plain})"));
        } else if dialect.semicolon == Semicolon::Comment {
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
