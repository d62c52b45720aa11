//! The mode in which the control keeps to the path, written in front of the feeds that need it.

use diagnostic::{Diagnostic, Text, both};
use nc_dialect::{Dialect, Keeps, PathCode, PathKey};
use nc_program::{Compensation, Modal, PathControl};
use nc_syntax::{Block, GCode};
use toolpath::Motion;
use units::decimal::{self, Spelling};

use crate::job::{Job, KEPT_NOWHERE};
use crate::pass::Pass;

/// Of the distances that are written, millimetres or inches.
const DECIMALS: u8 = 6;

/// What the output tells the control of keeping to the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PathMode {
    /// What the program says.
    #[default]
    AsPosted,
    /// On the path, with exact stops.
    Exact,
    /// So near, mm.
    Within(f64),
}

impl PathMode {
    /// How much of the tolerance is the control's, mm.
    #[must_use]
    pub const fn share_mm(self) -> f64 {
        if let Self::Within(mm) = self { mm } else { 0.0 }
    }

    /// How far the control may leave the path, mm.
    const fn most_mm(self) -> f64 {
        match self {
            Self::AsPosted => f64::INFINITY,
            Self::Exact => 0.0,
            Self::Within(mm) => mm,
        }
    }

    /// The block that says it in a unit of so many mm, and how far the control leaves the path behind it, mm; `None` where the
    /// dialect has no words for it.
    #[must_use]
    pub fn block(self, dialect: &Dialect, unit_mm: f64) -> Option<(String, f64)> {
        match self {
            Self::AsPosted => None,
            Self::Exact => exact(dialect).map(|code| (code.to_string(), 0.0)),
            Self::Within(mm) => dialect.path_control.iter().find_map(|row| match row {
                PathCode { key: PathKey::Code(code), keeps: Keeps::Words(letters) } => {
                    let steps = f64::from(10_u32.pow(DECIMALS.into()));
                    let counts = (mm / unit_mm / letters.len() as f64 * steps).floor();
                    let mut block = code.to_string().into_bytes();
                    for letter in letters {
                        block.extend([b' ', *letter]);
                        let spelling = Spelling { trailing_zeros: false, ..Spelling::FIXED };
                        decimal::write(&mut block, counts as i64, DECIMALS, spelling);
                    }
                    let off_mm = counts / steps * unit_mm * letters.len() as f64;
                    (counts > 0.0).then(|| (String::from_utf8_lossy(&block).into_owned(), off_mm))
                }
                _ => None,
            }),
        }
    }
}

/// The code by which the control keeps to the path.
pub(crate) fn exact(dialect: &Dialect) -> Option<GCode> {
    dialect.path_control.iter().find_map(|row| match row {
        PathCode { key: PathKey::Code(code), keeps: Keeps::Exact } => Some(*code),
        _ => None,
    })
}

/// How far the control leaves the path in a state, mm; infinite where nobody knows.
#[inline]
pub(crate) fn leaves_mm(job: &Job<'_>, modal: &Modal) -> f64 {
    let off_mm = modal.path_control.off_mm;
    if off_mm.is_infinite() { job.interpolator.blending_mm.unwrap_or(off_mm) } else { off_mm }
}

impl Pass<'_> {
    /// A feed that came now would be made farther off the path than is asked for.
    pub(crate) fn strays(&self) -> bool {
        leaves_mm(self.job, self.state.interpreter.modal()) > self.job.path_mode.most_mm()
    }

    /// Puts in front of a block that feeds what keeps the control to the path, where that is not in force; `before`: which
    /// compensation was.
    ///
    /// # Errors
    /// VP0535: no block may stand there, or the block says otherwise itself.
    pub(crate) fn keep_to_path(
        &mut self,
        block: &Block<'_>,
        motions: &[Motion],
        before: Compensation,
    ) -> Result<(), Vec<Diagnostic>> {
        if !(self.strays()
            && motions.iter().any(|motion| matches!(motion, Motion::Feed(_) | Motion::Hole(_))))
        {
            return Ok(());
        }
        let modal = self.state.interpreter.modal();
        let line = Some(block.line);
        let Some((text, off_mm)) = self.job.path_mode.block(self.job.dialect, modal.units.mm()) else {
            return Ok(());
        };
        let refused = |why: Text, help: Text| {
            let what = both!(
                "`{text}`, which keeps the control to the path, cannot be put in here",
                "`{text}`, что держит стойку на траектории, сюда не вставить"
            );
            Err(vec![Diagnostic::error(KEPT_NOWHERE, what).at(block.file_range(), why).help(help)])
        };
        if modal.path_control.line == line {
            return refused(
                both!("this block feeds, and says otherwise itself", "этот рабочий ход сам говорит иное"),
                both!("write that code in a block of its own", "запишите этот код отдельным кадром"),
            );
        }
        if before != Compensation::Off {
            return refused(
                both!(
                    "under cutter compensation a block without motion may change the contour",
                    "при коррекции на радиус кадр без движения может изменить контур"
                ),
                both!("write `{text}` before G41 or G42", "напишите `{text}` до G41 или G42"),
            );
        }
        self.insert(&text, block);
        self.state.interpreter.keeps_path(PathControl { off_mm, line });
        Ok(())
    }
}
