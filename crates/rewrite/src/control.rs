//! What the control adds to the path: corners that it blends, modes that leave the path by an amount of their own.

use std::ops::Range;

use diagnostic::{Diagnostic, Text, both};
use nc_dialect::{Dialect, Keeps, PathCode, PathKey};
use nc_program::{Modal, PathControl};
use nc_syntax::GCode;

use crate::job::{CONTROL_LEAVES, Job, Warning};

/// Where something is cut with the control farthest off the path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ControlPart(Option<Cut>);

#[derive(Debug, Clone, PartialEq)]
struct Cut {
    by: PathControl,
    span: Range<u64>,
    line: u64,
}

impl ControlPart {
    /// A feed is made in this state; the corners of a hole lie in the air.
    #[inline]
    pub(crate) fn cut(&mut self, job: &Job<'_>, modal: &Modal, place: impl FnOnce() -> (Range<u64>, u64)) {
        let mut by = modal.path_control;
        if by.off_mm.is_infinite() {
            by.off_mm = job.blending_mm.unwrap_or(f64::INFINITY);
        }
        if self.off_mm().is_none_or(|known_mm| by.off_mm > known_mm) {
            let (span, line) = place();
            self.0 = Some(Cut { by, span, line });
        }
    }

    pub(crate) fn add(&mut self, later: &Self) {
        if later.off_mm() > self.off_mm() {
            self.clone_from(later);
        }
    }

    /// By how much the control leaves the path at most, mm; infinite where nobody says, `None` where nothing is cut.
    #[must_use]
    pub fn off_mm(&self) -> Option<f64> {
        self.0.as_ref().map(|cut| cut.by.off_mm)
    }

    /// The lines of its places.
    pub(crate) fn lines(&mut self) -> impl Iterator<Item = &mut u64> {
        self.0.iter_mut().flat_map(|cut| cut.by.line.iter_mut().chain([&mut cut.line]))
    }

    /// What it adds to the path, in words; `None` where it adds nothing.
    #[must_use]
    pub fn said(&self) -> Option<Text> {
        let Cut { by, line, .. } = self.0.as_ref().filter(|cut| cut.by.off_mm > 0.0)?;
        Some(if by.off_mm.is_finite() {
            both!(
                "the control adds up to {:.1} um at corners (line {line})",
                "стойка добавляет на углах до {:.1} мкм (строка {line})",
                1e3 * by.off_mm
            )
        } else {
            both!(
                "what the control adds at corners is not known",
                "что добавляет на углах стойка, неизвестно"
            )
        })
    }

    /// What the tolerance does not cover.
    pub(crate) fn warning(&self, job: &Job<'_>) -> Option<Warning> {
        let Cut { by, span, line } =
            self.0.as_ref().filter(|cut| cut.by.off_mm > job.options.tolerance_mm)?;
        let tolerance_um = 1e3 * job.options.tolerance_mm;
        let message = if by.off_mm.is_finite() {
            both!(
                "the control itself may leave the path by up to {:.1} um at corners: more than the tolerance of {tolerance_um} um",
                "сама стойка может сойти с траектории на углах до {:.1} мкм: больше допуска {tolerance_um} мкм",
                1e3 * by.off_mm
            )
        } else {
            both!(
                "by how much the control itself leaves the path at corners is not known: the tolerance of {tolerance_um} um is the machine's part",
                "насколько сама стойка сходит с траектории на углах, неизвестно: допуск {tolerance_um} мкм — только доля станка"
            )
        };
        let label = match by.line {
            Some(line) => both!(
                "the first motion that is cut so; line {line} says how",
                "первое такое рабочее движение; режим задан в строке {line}"
            ),
            None => both!(
                "the first motion that is cut so: as the control starts",
                "первое такое рабочее движение: в том режиме, с каким стойка начинает"
            ),
        };
        let name = &job.dialect.name;
        let settled = both!(
            "say in the profile what it does, `control = {{ dialect = \"{name}\", blending = {{ mode = \"tolerance\", tolerance_mm = 0.005 }} }}` or `{{ mode = \"exact-stop\" }}`",
            "скажите в профиле, что она делает: `control = {{ dialect = \"{name}\", blending = {{ mode = \"tolerance\", tolerance_mm = 0.005 }} }}` или `{{ mode = \"exact-stop\" }}`"
        );
        let help = match exact(job.dialect) {
            Some(code) => {
                both!("write {code} before it, or {settled}", "напишите перед ним {code} или {settled:#}")
            }
            None => settled,
        };
        Some((Diagnostic::doubt(CONTROL_LEAVES, message).at(span.clone(), label).help(help), *line))
    }
}

/// The code by which the control keeps to the path.
fn exact(dialect: &Dialect) -> Option<GCode> {
    dialect.path_control.iter().find_map(|row| match row {
        PathCode { key: PathKey::Code(code), keeps: Keeps::Exact } => Some(*code),
        _ => None,
    })
}
