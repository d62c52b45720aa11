//! Guards in the output: what the program was corrected for is asked of the control.

use diagnostic::Diagnostic;
use nc_emit::{Asked, Stated};
use nc_program::{Compensation, ToolLength};
use nc_syntax::Block;
use smallvec::SmallVec;

use crate::job::{Guards, UNGUARDED};
use crate::pass::Pass;

/// What the output guards already.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Guarded {
    asked: SmallVec<[Asked; 4]>,
    serial: u32,
}

impl Pass<'_> {
    /// What is in force and not guarded yet: the work offset, the tool's length. What the program itself writes needs none.
    fn unguarded(&self) -> [Option<Asked>; 2] {
        if self.job.guards == Guards::None {
            return [None; 2];
        }
        let modal = self.state.interpreter.modal();
        let offset = &modal.work_offset;
        let name = |code| match offset.number {
            Some(p) => format!("{code} P{p}"),
            None => format!("{code}"),
        };
        let offset = offset.code.zip(offset.zero_mm).filter(|(code, _)| {
            let name = name(*code);
            !offset.rewritten && !modal.written.iter().any(|(written, _)| *written == name)
        });
        let offset = offset.map(|(code, _)| Asked::WorkOffset(code, modal.work_offset.number));
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
    ///
    /// * `stated`, `unit_mm` – in force before the block
    pub(crate) fn guard_before(
        &mut self,
        block: &Block<'_>,
        stated: Option<Stated>,
        unit_mm: f64,
    ) -> Result<(), Vec<Diagnostic>> {
        let [offset, _] = self.unguarded();
        self.guard([offset, None], block, stated, unit_mm)
    }

    /// Puts behind a block the guards of what it chose.
    pub(crate) fn guard_behind(&mut self, block: &Block<'_>, chosen: bool) -> Result<(), Vec<Diagnostic>> {
        let (stated, unit_mm) = (self.stated(), self.state.interpreter.modal().units.mm());
        let [offset, length] = self.unguarded();
        self.guard([offset.filter(|_| chosen), length], block, stated, unit_mm)
    }

    fn guard(
        &mut self,
        unguarded: [Option<Asked>; 2],
        block: &Block<'_>,
        stated: Option<Stated>,
        unit_mm: f64,
    ) -> Result<(), Vec<Diagnostic>> {
        for asked in unguarded.into_iter().flatten() {
            let refused = |why: &str, help: &str| {
                let what = match asked {
                    Asked::WorkOffset(code, _) => format!("no guard of {code} can be put in here"),
                    Asked::ToolLength(number) => format!("no guard of H{number} can be put in here"),
                };
                Err(vec![
                    Diagnostic::error(UNGUARDED, what)
                        .at(block.offset..block.offset + block.bytes.trim_ascii_end().len() as u64, why)
                        .help(help),
                ])
            };
            if self.state.interpreter.modal().compensation != Compensation::Off {
                return refused(
                    "under cutter compensation a block without motion may change the contour",
                    "choose work offset and length before G41 or G42, or correct without `--guard`",
                );
            }
            let Some(stated) = stated else {
                return refused(
                    "the frame is turned or scaled here",
                    "choose work offset and length before G68 or G51, or correct without `--guard`",
                );
            };
            let lines =
                nc_emit::guard(self.job.dialect, asked, &stated, unit_mm, &mut self.state.guarded.serial);
            if lines.is_empty() && matches!(asked, Asked::WorkOffset(..)) {
                return refused(
                    "in which variables this control keeps that work offset is not known",
                    "use G54 to G59, or correct without `--guard`",
                );
            }
            let longest = self.job.dialect.output.max_block_bytes as usize;
            if longest > 0 && lines.iter().any(|line| line.len() > longest) {
                return refused(
                    "the guard is longer than the control's longest block",
                    "correct without `--guard`",
                );
            }
            if !self.out.is_empty() && !self.out.ends_with(b"\n") && !self.out.ends_with(b"\r") {
                self.out.extend_from_slice(b"\n");
            }
            let end = &block.bytes[block.bytes.trim_ascii_end().len()..];
            let end =
                end.iter().position(|byte| matches!(byte, b'\n' | b'\r')).map_or(&b"\n"[..], |at| &end[at..]);
            for line in lines {
                self.out.extend_from_slice(line.as_bytes());
                self.out.extend_from_slice(end);
                self.tally.figures.blocks_out += 1;
            }
            self.state.guarded.asked.push(asked);
        }
        Ok(())
    }
}
