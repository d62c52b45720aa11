//! Codes that a program moves under without saying them: on a control that starts otherwise it moves otherwise.

use diagnostic::{Text, both};
use nc_dialect::{CodeEntry, Dialect, MOTION_GROUP};
use nc_program::process::is_mode;
use nc_syntax::{Block, GCode};
use toolpath::{Motion, Shape};

/// What a program leaves to the state in which its control starts.
///
/// It only becomes less, so that the first motions of each kind tell: any, a cut, an arc. A cycle written as moves is a
/// cut as it is, and an arc written as lines is.
pub(super) struct Unsaid<'d> {
    /// Codes of the control's start of whose group none has been said.
    codes: Vec<&'d CodeEntry>,
    /// The line of the first motion of each kind, and the codes unsaid there.
    relied: [Option<(u64, Vec<GCode>)>; 3],
}

impl<'d> Unsaid<'d> {
    /// Nothing is said. A cycle that is in force is seen by what it makes, and ends with the first motion code.
    pub(super) fn at_start(dialect: &'d Dialect) -> Self {
        let rows = dialect.initial.iter().filter_map(|code| dialect.code(*code));
        let codes = rows.filter(|row| is_mode(row) || row.group == MOTION_GROUP).collect();
        Self { codes, relied: Default::default() }
    }

    pub(super) fn say(&mut self, block: &Block<'_>, dialect: &Dialect) {
        if self.relied.iter().all(Option::is_some) {
            return;
        }
        for word in block.words() {
            if let Some(row) = word.g_code().and_then(|code| dialect.code(code)) {
                self.codes.retain(|unsaid| unsaid.group != row.group);
            }
        }
    }

    pub(super) fn rely(&mut self, motion: &Motion, line: u64) {
        let kinds = match motion {
            Motion::Feed(feed) if matches!(feed.shape, Shape::Arc(_)) => 3,
            Motion::Feed(_) | Motion::Hole(_) => 2,
            Motion::Rapid { .. } | Motion::Uncorrected { .. } => 1,
        };
        for relied in &mut self.relied[..kinds] {
            relied.get_or_insert_with(|| (line, self.codes.iter().map(|row| row.code).collect()));
        }
    }

    /// What it relies on and another program says, a sentence each.
    pub(super) fn beside(&self, wanted: &Self) -> Vec<Text> {
        let mut named = Vec::new();
        let mut findings = Vec::new();
        for (there, here) in self.relied.iter().zip(&wanted.relied) {
            let (Some((line, codes)), Some((wanted_line, said))) = (there, here) else { continue };
            for code in codes.iter().filter(|code| !said.contains(code)) {
                if !named.contains(code) {
                    named.push(*code);
                    findings.push(both!(
                        "line {line} of the corrected program moves under {code} only where the control starts in it: the program says it, or another of its kind, up to line {wanted_line}, the corrected one does not",
                        "строка {line} исправленной программы движется с {code}, только если стойка с него начинает: исходная до строки {wanted_line} называет его или другой код той же группы, исправленная — нет"
                    ));
                }
            }
        }
        findings
    }
}
