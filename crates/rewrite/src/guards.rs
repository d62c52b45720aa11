//! Guards in the output: what the program was corrected for is asked of the control.

use diagnostic::{Diagnostic, Text, both};
use nc_emit::{Asked, Stated};
use nc_program::{Compensation, ToolLength, WorkOffset};
use nc_syntax::Block;

use crate::job::{Guards, UNGUARDED};
use crate::pass::Pass;

/// What is in force before a block, as a guard in front of it states it.
pub(crate) struct Before {
    work_offset: WorkOffset,
    stated: Option<Stated>,
    unit_mm: f64,
}

impl Pass<'_> {
    /// What is in force now; `None` where no guards are put.
    pub(crate) fn before_guards(&self) -> Option<Before> {
        let modal = self.state.interpreter.modal();
        (self.job.guards == Guards::Put).then(|| Before {
            work_offset: modal.work_offset,
            stated: self.stated(),
            unit_mm: modal.units.mm(),
        })
    }

    /// What is in force and not guarded yet: the work offset, the tool's length. What the program itself writes needs none.
    fn unguarded(&self) -> [Option<Asked>; 2] {
        if self.job.guards == Guards::None {
            return [None; 2];
        }
        let modal = self.state.interpreter.modal();
        let offset = &modal.work_offset;
        let asked = offset.code.map(|code| Asked::WorkOffset(code, offset.number));
        let offset = asked.filter(|asked| {
            let name = asked.to_string();
            let written = offset.rewritten || modal.written.iter().any(|(written, _)| *written == name);
            offset.zero_mm.is_some() && !written
        });
        let length = match modal.tool_length {
            ToolLength::On { number, .. } if number != 0 => Some(Asked::ToolLength(number)),
            _ => None,
        };
        [offset, length].map(|asked| asked.filter(|asked| !self.state.guarded.asked.contains(asked)))
    }

    /// A motion that came now would be made with a work offset that nobody has asked for.
    pub(crate) fn lacks_guard(&self) -> bool {
        self.unguarded()[0].is_some()
    }

    /// What holds now; `None` where no offset is known, or the frame is more than a shift.
    pub(crate) fn stated(&self) -> Option<Stated> {
        let modal = self.state.interpreter.modal();
        let frame = modal.frame.as_ref().filter(|frame| frame.is_shift())?;
        Some(Stated { zero_mm: modal.work_offset.zero_mm?, added_mm: frame.to_machine([0.0; 3]) })
    }

    /// Puts in front of a block that moves the guard of a work offset that holds without having been chosen.
    pub(crate) fn guard_before(&mut self, block: &Block<'_>, before: &Before) -> Result<(), Vec<Diagnostic>> {
        if self.state.interpreter.modal().work_offset != before.work_offset {
            return Ok(());
        }
        let [offset, _] = self.unguarded();
        self.guard([offset, None], block, before.stated, before.unit_mm)
    }

    /// Puts behind a block the guards of what it chose.
    pub(crate) fn guard_behind(&mut self, block: &Block<'_>, before: &Before) -> Result<(), Vec<Diagnostic>> {
        let modal = self.state.interpreter.modal();
        let (chosen, unit_mm) = (modal.work_offset != before.work_offset, modal.units.mm());
        let [offset, length] = self.unguarded();
        self.guard([offset.filter(|_| chosen), length], block, self.stated(), unit_mm)
    }

    fn guard(
        &mut self,
        unguarded: [Option<Asked>; 2],
        block: &Block<'_>,
        stated: Option<Stated>,
        unit_mm: f64,
    ) -> Result<(), Vec<Diagnostic>> {
        for asked in unguarded.into_iter().flatten() {
            let refused = |why: Text, help: Text| {
                let what =
                    both!("no guard of {asked} can be put in here", "проверку {asked} сюда не вставить");
                Err(vec![Diagnostic::error(UNGUARDED, what).at(block.file_range(), why).help(help)])
            };
            if self.state.interpreter.modal().compensation != Compensation::Off {
                return refused(
                    both!(
                        "under cutter compensation a block without motion may change the contour",
                        "при коррекции на радиус кадр без движения может изменить контур"
                    ),
                    both!(
                        "choose work offset and length before G41 or G42, or correct without `--guard`",
                        "выбирайте смещение нуля и длину до G41 и G42 или исправляйте без `--guard`"
                    ),
                );
            }
            let Some(stated) = stated else {
                return refused(
                    both!(
                        "the frame is turned or scaled here",
                        "система координат здесь повёрнута или масштабирована"
                    ),
                    both!(
                        "choose work offset and length before G68 or G51, or correct without `--guard`",
                        "выбирайте смещение нуля и длину до G68 и G51 или исправляйте без `--guard`"
                    ),
                );
            };
            let lines =
                nc_emit::guard(self.job.dialect, asked, &stated, unit_mm, &mut self.state.guarded.serial);
            if lines.is_empty() && matches!(asked, Asked::WorkOffset(..)) {
                return refused(
                    both!(
                        "in which variables this control keeps that work offset is not known",
                        "в каких переменных эта стойка держит такое смещение нуля, неизвестно"
                    ),
                    both!(
                        "use G54 to G59, or correct without `--guard`",
                        "возьмите G54–G59 или исправляйте без `--guard`"
                    ),
                );
            }
            let longest = self.job.dialect.output.max_block_bytes as usize;
            if longest > 0 && lines.iter().any(|line| line.len() > longest) {
                return refused(
                    both!(
                        "the guard is longer than the control's longest block",
                        "проверка длиннее самого длинного кадра стойки"
                    ),
                    both!("correct without `--guard`", "исправляйте без `--guard`"),
                );
            }
            lines.iter().for_each(|line| self.insert(line, block));
            self.state.guarded.asked.push(asked);
        }
        Ok(())
    }

    /// A line that the program did not have, beside a block.
    pub(crate) fn insert(&mut self, line: &str, block: &Block<'_>) {
        if !self.out.is_empty() && !self.out.ends_with(b"\n") && !self.out.ends_with(b"\r") {
            self.out.push(b'\n');
        }
        self.out.extend_from_slice(line.as_bytes());
        self.out.extend_from_slice(nc_syntax::line_ending(block.bytes));
        self.tally.figures.blocks_out += 1;
    }
}
