//! In front of feeds that would be made farther off the path than is asked for: the block that keeps the control to it.

use diagnostic::{Diagnostic, Text, both};
use nc_program::{Compensation, PathControl};
use nc_syntax::Block;
use toolpath::Motion;

use crate::job::KEPT_NOWHERE;
use crate::pass::Pass;

impl Pass<'_> {
    /// A feed that came now would be made farther off the path than is asked for.
    pub(crate) fn strays(&self) -> bool {
        self.job.leaves_mm(self.state.interpreter.modal()) > self.job.path_mode.most_mm()
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
