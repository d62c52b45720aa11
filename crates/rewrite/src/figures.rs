//! What became of a program, in figures.

use correction::Correction;
use diagnostic::Diagnostic;
use nc_program::Evidence;

use crate::control::ControlPart;
use crate::datum::Datum;

/// What happened, in figures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures {
    /// Blocks read.
    pub blocks_in: u64,
    /// Blocks written.
    pub blocks_out: u64,
    /// Motions that became more than one block.
    pub splits: u64,
    /// Largest correction of an end point, mm, and its line.
    pub largest: (f64, u64),
    /// Proven bound of the path deviation before, mm, and its line.
    pub before: (f64, u64),
    /// Proven bound of the path deviation after, mm, and its line.
    pub after: (f64, u64),
    /// Largest angle between the tool's real and its ideal direction in a feed uncorrected, rad, and its line.
    pub tilt_before: (f64, u64),
    /// The same of what was written, but where directions were held.
    pub tilt: (f64, u64),
    /// Motions whose directions were to be corrected and were not.
    pub held: Held,
    /// Short moves to a corrected start that were put in.
    pub approaches: u64,
    /// Motions that cannot be held within the tolerance: line, and what is proven instead, mm.
    pub accepted: Vec<(u64, f64)>,
    /// What the control adds to the path.
    pub control: ControlPart,
    /// Touched zeros that were used, in the order of the program; one whose tools differ comes once with each.
    pub datums: Vec<Datum>,
    /// What the user should know.
    pub warnings: Vec<Diagnostic>,
}

/// Motions whose directions could not be corrected.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Held {
    /// How many.
    pub motions: u64,
    /// Largest angle that is left there, rad, and its line.
    pub largest: (f64, u64),
    /// Their lines, first to last of lines that follow each other; no more than [`Held::MOST`] of such.
    pub lines: Vec<[u64; 2]>,
}

impl Held {
    /// So many stretches of lines are kept.
    pub const MOST: usize = 1000;

    /// One more in a line, with the angle that is left.
    pub(crate) fn see(&mut self, line: u64, rad: f64) {
        self.motions += 1;
        raise(&mut self.largest, (rad, line));
        self.extend([line; 2]);
    }

    pub(crate) fn add(&mut self, later: &Self) {
        self.motions += later.motions;
        raise(&mut self.largest, later.largest);
        later.lines.iter().for_each(|lines| self.extend(*lines));
    }

    fn extend(&mut self, [first, last]: [u64; 2]) {
        let count = self.lines.len();
        match self.lines.last_mut() {
            Some([_, end]) if first <= *end + 1 => *end = (*end).max(last),
            _ if count < Self::MOST => self.lines.push([first, last]),
            _ => {}
        }
    }

    /// `12-15, 20` and how many more.
    pub(crate) fn names(&self) -> String {
        const MOST: usize = 12;
        let name = |[first, last]: &[u64; 2]| {
            if first == last { first.to_string() } else { format!("{first}-{last}") }
        };
        let names: Vec<String> = self.lines.iter().take(MOST).map(name).collect();
        let more = if self.lines.len() > MOST { ", …" } else { "" };
        names.join(", ") + more
    }
}

impl Figures {
    /// Takes the bounds of a motion in a line.
    #[inline]
    pub(crate) fn raise(&mut self, correction: &Correction, line: u64) {
        raise(&mut self.largest, (correction.largest_mm, line));
        raise(&mut self.before, (correction.before_mm, line));
        raise(&mut self.after, (correction.after_mm, line));
    }

    /// Notes a touched zero.
    pub(crate) fn see(&mut self, datum: &Datum) {
        match self.datums.iter_mut().find(|known| known.is(datum)) {
            Some(known) => known.unsure_mm = known.unsure_mm.max(datum.unsure_mm),
            None => self.datums.push(datum.clone()),
        }
    }

    /// The lines of its places, to be read and changed.
    pub(crate) fn each_line(&mut self, mut see: impl FnMut(&mut u64)) {
        let Self { largest, before, after, tilt_before, tilt, held, accepted, control, .. } = self;
        for (_, line) in [largest, before, after, tilt_before, tilt, &mut held.largest] {
            see(line);
        }
        held.lines.iter_mut().flatten().for_each(&mut see);
        accepted.iter_mut().for_each(|(line, _)| see(line));
        control.lines().for_each(see);
    }

    /// False where [`Figures::raise`] changes nothing.
    #[inline]
    pub(crate) fn would_rise(&self, by: &Correction) -> bool {
        by.largest_mm > self.largest.0 || by.before_mm > self.before.0 || by.after_mm > self.after.0
    }
}

/// A corrected program.
#[derive(Debug, Clone, PartialEq)]
pub struct Corrected {
    /// Its bytes.
    pub text: Vec<u8>,
    /// What was done.
    pub figures: Figures,
    /// What the program as a whole shows; who corrects it judges that.
    pub evidence: Evidence,
}

/// The first of the largest counts.
#[inline]
pub(crate) fn raise(figure: &mut (f64, u64), (value, line): (f64, u64)) {
    if value > figure.0 {
        *figure = (value, line);
    }
}
