//! Where the program goes on: jumps, and calls that have not returned.

use std::rc::Rc;

use diagnostic::{Text, both};

use crate::call_stack::{CallKind, Frame, Place};
use crate::came::From;
use crate::control::Direction;
use crate::expression::Expression;
use crate::faults::{self, Stop};
use crate::program::{Found, Source};
use crate::run::Run;
use crate::statement::Statement;
use crate::value::{NameId, Value};

impl<'a> Run<'a, '_> {
    pub(crate) fn goto(&mut self, source: &Source<'a>, section: u32, label: &Expression) -> Result<(), Stop> {
        let value = self.known(label)?;
        let number = faults::whole(&Text::pair("a block number", "номер кадра"), value)?;
        self.at.statement = self.block(source, section, number)?;
        Ok(())
    }

    /// The statement with a block number of a program.
    pub(crate) fn block(&self, source: &Source<'a>, section: u32, number: u64) -> Result<u32, Stop> {
        let refuse =
            |why: Text| faults::label(&format!("N{number}"), &both!("block number", "номер кадра"), &why);
        match source.label(section, number) {
            Found::Statement(statement) => Ok(statement),
            Found::Missing => Err(refuse(both!(
                "there is no such block in this program",
                "такого кадра в этой программе нет"
            ))),
            Found::Twice => Err(refuse(both!(
                "the number stands before more than one block",
                "этот номер стоит не перед одним кадром"
            ))),
        }
    }

    /// GOTOF, GOTOB and GOTO.
    pub(crate) fn jump(
        &mut self,
        source: &Source<'a>,
        place: Place,
        to: NameId,
        direction: Direction,
    ) -> Result<(), Stop> {
        self.at.statement = self.labelled(source, place, to, direction)?;
        Ok(())
    }

    /// True where the last block of a section lies behind.
    pub(crate) fn section_ends(&self) -> bool {
        let Some(Frame { kind: CallKind::Section(_, last), back, .. }) = self.frames.last() else {
            return false;
        };
        self.at == Place { statement: last + 1, ..*back }
    }

    /// The block behind a label.
    pub(crate) fn labelled(
        &self,
        source: &Source<'a>,
        place: Place,
        to: NameId,
        direction: Direction,
    ) -> Result<u32, Stop> {
        let refuse = |why: Text| {
            faults::label(&self.names.name(to).to_ascii_uppercase(), &both!("label", "метку"), &why)
        };
        match source.named(to, place.statement, direction) {
            Found::Statement(statement) => Ok(statement),
            Found::Missing => Err(refuse(both!(
                "there is no such label in this direction",
                "в эту сторону такой метки нет"
            ))),
            Found::Twice => Err(refuse(both!(
                "the label stands before more than one block",
                "эта метка стоит не перед одним кадром"
            ))),
        }
    }

    /// M99.
    pub(crate) fn return_by_number(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        to: Option<&Expression>,
    ) -> Result<(), Stop> {
        if self.frames.is_empty() {
            return match to {
                Some(label) => self.goto(source, statement.section, label),
                None if self.dialect.flow.macros.bare_names() => {
                    Err(faults::no_call(&both!("a return outside a subprogram", "возврат вне подпрограммы")))
                }
                None => Err(faults::endless()),
            };
        }
        if matches!(self.frames.last().map(|frame| frame.kind), Some(CallKind::Section(..))) {
            return Err(faults::no_call(&both!("a return inside CALL BLOCK", "возврат внутри CALL BLOCK")));
        }
        if matches!(
            self.frames.last().map(|frame| frame.kind),
            Some(CallKind::Name(_) | CallKind::Routine(_))
        ) {
            return Err(faults::no_call(&both!(
                "M99 in a subroutine that an O-word called",
                "M99 в подпрограмме, которую вызвало слово O"
            )));
        }
        let to = match to {
            Some(label) => Some(self.known(label)?),
            None => None,
        };
        let section = self.frames.last().map_or(0, |frame| frame.section);
        let jump = to.is_some();
        if !self.leave(jump) {
            return Ok(());
        }
        if let Some(number) = to {
            let caller = Rc::clone(&self.sources[self.at.file]);
            return self.goto(&caller, section, &Expression::Number(number));
        }
        Ok(())
    }

    /// Ends a pass of the running call; false where another one begins.
    pub(crate) fn leave(&mut self, for_good: bool) -> bool {
        let Some(mut frame) = self.frames.pop() else { return true };
        if frame.left > 0 && !for_good {
            frame.left -= 1;
            self.at = frame.start;
            self.repeats.clear();
            self.counts.clear();
            self.announce(frame.kind, frame.passes - frame.left, Some(frame.passes), frame.back);
            self.frames.push(frame);
            return false;
        }
        if let CallKind::Routine(_) = frame.kind {
            self.out.fresh_line();
            self.previous = None;
        }
        if let Some(saved) = frame.saved {
            self.store.leave(saved);
        }
        (self.repeats, self.counts) = (frame.repeats, frame.counts);
        self.at = frame.back;
        true
    }

    /// Starts a call.
    pub(crate) fn enter(
        &mut self,
        start: Place,
        kind: CallKind,
        passes: u64,
        arguments: Option<&[(u32, Value)]>,
        section: u32,
        caller: Place,
    ) -> Result<(), Stop> {
        let limit = self.environment.limits.depth;
        // Its own variables would be the caller's.
        let again =
            matches!(kind, CallKind::Program(_)) && self.frames.iter().any(|frame| frame.start == start);
        if again || self.frames.len() >= limit {
            return Err(faults::too_deep(limit));
        }
        let back = self.at;
        let saved = arguments.map(|arguments| self.store.enter(arguments));
        let (repeats, counts) = (std::mem::take(&mut self.repeats), std::mem::take(&mut self.counts));
        let count = self.calls.entry((start.file, start.statement)).or_insert(0);
        *count += 1;
        let (number, of) = match kind {
            CallKind::Number(_) | CallKind::Program(_) | CallKind::Block(_) | CallKind::Section(..) => {
                (1, Some(passes))
            }
            CallKind::Name(_) | CallKind::Routine(_) => (*count, None),
        };
        self.announce(kind, number, of, caller);
        self.frames.push(Frame {
            back,
            start,
            left: passes - 1,
            passes,
            kind,
            saved,
            repeats,
            counts,
            section,
        });
        self.at = start;
        Ok(())
    }

    /// `(O1000 CALL 2 OF 3)`
    fn announce(&mut self, kind: CallKind, number: u64, of: Option<u64>, caller: Place) {
        let name = match kind {
            CallKind::Number(program) => program.written(&self.names),
            CallKind::Block(number) => format!("N{number}"),
            CallKind::Program(id) | CallKind::Section(id, _) => self.names.name(id).to_ascii_uppercase(),
            CallKind::Name(id) | CallKind::Routine(id) => format!("O<{}>", self.names.name(id)),
        };
        let text = match of {
            Some(passes) => format!("{name} CALL {number} OF {passes}"),
            None => format!("{name} CALL {number}"),
        };
        let source = Rc::clone(&self.sources[caller.file]);
        let at = (caller.statement as usize).min(source.statements.len().saturating_sub(1));
        if let Some(statement) = source.statements.get(at) {
            let contour = matches!(kind, CallKind::Routine(_));
            let from = From { contour, ..self.from(statement, caller) };
            self.out.comment(text.as_bytes(), from);
        }
        self.previous = None;
    }
}
