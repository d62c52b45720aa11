//! A file as statements, with what its labels and ends belong to.

use std::borrow::Cow;
use std::collections::BTreeMap;

use diagnostic::{Diagnostic, Text, both};
use nc_dialect::{Action, Dialect};
use nc_syntax::{Block, ItemKind, Macros, Reader};

use crate::codes;
use crate::control::{Control, Direction};
use crate::o_word::{Label, OStatement, OWord};
use crate::refusals::calls as refusal;
use crate::statement::{Compiler, Flags, Kind, Statement};
use crate::value::{NameId, Names, Program};

/// In place of where a program starts whose name stands twice.
const TWICE: u32 = u32::MAX;

/// A file.
#[derive(Clone, Debug)]
pub(crate) struct Source<'a> {
    /// Its name, empty for the main program.
    pub(crate) name: String,
    pub(crate) text: Cow<'a, [u8]>,
    pub(crate) statements: Vec<Statement>,
    /// (section, N number, statement), sorted.
    labels: Vec<(u32, u64, u32)>,
    /// Names of labels and the statements they stand before, sorted; block numbers are `n100`.
    names: Vec<(NameId, u32)>,
    /// O-word subroutines by name.
    pub(crate) subroutines: BTreeMap<NameId, u32>,
    /// Programs with an O number, or Okuma's with a name.
    pub(crate) programs: BTreeMap<Program, u32>,
}

/// What a label leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    Statement(u32),
    Missing,
    Twice,
}

impl<'a> Source<'a> {
    /// Reads a file.
    pub(crate) fn read(
        name: String,
        text: Cow<'a, [u8]>,
        dialect: &Dialect,
        names: &mut Names,
    ) -> Result<Self, (Box<Diagnostic>, Vec<u8>)> {
        let mut statements = Vec::new();
        let mut labels = Vec::new();
        let mut named = Vec::new();
        let mut programs = BTreeMap::new();
        let mut section = 0;
        {
            let mut compiler = Compiler { dialect, names };
            let mut reader = Reader::new(&text, dialect);
            let mut block = Block::default();
            let mut percents = 0_u32;
            while reader.next(&mut block) {
                let at = u32::try_from(statements.len()).unwrap_or(u32::MAX);
                let (mut kind, mut flags) = compiler.kind(&block);
                if aborts(&block, dialect) {
                    let span = block.file_span(crate::statement::whole(&block));
                    kind = Kind::Broken(Box::new(refusal::ABORT.at(span)));
                }
                let starts = match &kind {
                    Kind::Program(program) => Some(*program),
                    // With a statement beside its number.
                    Kind::Complex(_) | Kind::Broken(_) => compiler.program(&block),
                    Kind::Copy | Kind::Print(_) | Kind::Percent => None,
                };
                percents += u32::from(matches!(kind, Kind::Percent));
                if let Some(program) = starts {
                    flags.starts = true;
                    section += 1;
                    programs.entry(program).and_modify(|at| *at = TWICE).or_insert(at);
                }
                if flags.number.is_some()
                    && dialect.flow.macros == Macros::Fanuc
                    && let Some(number) = block.word(b'N').and_then(|word| word.number()?.integer())
                {
                    labels.push((section, u64::try_from(number).unwrap_or(u64::MAX), at));
                }
                if dialect.flow.macros.bare_names() {
                    named.extend(label(&block, dialect, compiler.names).map(|name| (name, at)));
                    if let Some(number) = block.word(b'N').and_then(|word| word.number()?.integer()) {
                        named.push((compiler.names.id(format!("n{number}").as_bytes()), at));
                    }
                }
                statements.push(Statement {
                    offset: block.offset,
                    length: u32::try_from(block.bytes.len()).unwrap_or(u32::MAX),
                    line: u32::try_from(block.line).unwrap_or(u32::MAX),
                    section,
                    flags,
                    kind,
                });
                // Behind the second `%` nothing is executed.
                if percents > 1 && !block.items.iter().any(|item| item.kind == ItemKind::Percent) {
                    continue;
                }
            }
        }
        labels.sort_unstable();
        named.sort_unstable();
        let mut source =
            Self { name, text, statements, labels, names: named, subroutines: BTreeMap::new(), programs };
        match source.link(names) {
            Ok(()) => Ok(source),
            Err(diagnostic) => {
                // A statement that cannot be read may be the partner that is missing.
                let broken = source.statements.iter().find_map(|statement| match &statement.kind {
                    Kind::Broken(diagnostic) => Some(diagnostic.clone()),
                    _ => None,
                });
                Err((broken.unwrap_or(diagnostic), source.text.into_owned()))
            }
        }
    }

    /// The statement with an N number.
    pub(crate) fn label(&self, section: u32, number: u64) -> Found {
        let from = self.labels.partition_point(|(s, n, _)| (*s, *n) < (section, number));
        let same = |at: usize| self.labels.get(at).filter(|(s, n, _)| (*s, *n) == (section, number));
        match (same(from), same(from + 1)) {
            (None, _) => Found::Missing,
            (Some(_), Some(_)) => Found::Twice,
            (Some((_, _, statement)), None) => Found::Statement(*statement),
        }
    }

    /// The statement with a label, looked for from another one.
    pub(crate) fn named(&self, name: NameId, from: u32, direction: Direction) -> Found {
        let start = self.names.partition_point(|label| *label < (name, 0));
        let behind = self.names.partition_point(|label| *label <= (name, from));
        let end = self.names.partition_point(|label| *label <= (name, u32::MAX));
        let pick =
            |forward: bool| match if forward { &self.names[behind..end] } else { &self.names[start..behind] }
            {
                [] => Found::Missing,
                [(_, at)] => Found::Statement(*at),
                _ => Found::Twice,
            };
        match direction {
            Direction::Forward => pick(true),
            Direction::Back => pick(false),
            Direction::Only => match &self.names[start..end] {
                [] => Found::Missing,
                [(_, at)] => Found::Statement(*at),
                _ => Found::Twice,
            },
            Direction::Either => match pick(true) {
                Found::Missing => pick(false),
                found => found,
            },
        }
    }

    /// The program that starts with a statement.
    pub(crate) fn program_at(&self, statement: u32) -> Program {
        let started = self.programs.iter().find(|(_, at)| **at == statement);
        started.map_or(Program::Number(0), |(program, _)| *program)
    }

    /// Bytes of the file of a statement.
    pub(crate) fn bytes(&self, statement: &Statement) -> &[u8] {
        let start = usize::try_from(statement.offset).unwrap_or(usize::MAX).min(self.text.len());
        let end = start.saturating_add(statement.length as usize).min(self.text.len());
        &self.text[start..end]
    }

    /// The statement's bytes of the file, without its end.
    pub(crate) fn span(&self, statement: &Statement) -> std::ops::Range<u64> {
        let trimmed = self.bytes(statement).trim_ascii_end().len() as u64;
        statement.offset..statement.offset + trimmed
    }

    /// Finds the end of every loop, branch and subroutine.
    fn link(&mut self, names: &Names) -> Result<(), Box<Diagnostic>> {
        let mut open: Vec<Open> = Vec::new();
        let mut loops: Vec<(u32, u32)> = Vec::new();
        let mut section = 0;
        for at in 0..self.statements.len() {
            let index = at as u32;
            let statement = &self.statements[at];
            if statement.section != section {
                section = statement.section;
                self.require_closed(&loops)?;
            }
            let Kind::Complex(complex) = &statement.kind else { continue };
            match &complex.control {
                Some(Control::While { number, .. }) => loops.push((index, *number)),
                Some(Control::EndWhile { number, .. }) => {
                    let Some((start, _)) = loops.pop().filter(|(_, n)| n == number) else {
                        return Err(self.unmatched(
                            index,
                            both!("this END closes no loop", "это END не закрывает никакого цикла"),
                        ));
                    };
                    if let Some(Control::While { end, .. }) = control(&mut self.statements[start as usize]) {
                        *end = index;
                    }
                    if let Some(Control::EndWhile { start: back, .. }) = control(&mut self.statements[at]) {
                        *back = start;
                    }
                }
                Some(Control::For { .. }) => open.push(Open::new(NameId(u32::MAX), Construct::For, index)),
                Some(Control::EndFor { .. }) => {
                    let Some(head) = open.pop_if(|top| top.kind == Construct::For).map(|top| top.head) else {
                        return Err(self.unmatched(
                            index,
                            both!(
                                "this ENDFOR closes no FOR that is open here",
                                "это ENDFOR не закрывает никакого FOR, открытого здесь"
                            ),
                        ));
                    };
                    if let Some(Control::For { end, .. }) = control(&mut self.statements[head as usize]) {
                        *end = index;
                    }
                    if let Some(Control::EndFor { start }) = control(&mut self.statements[at]) {
                        *start = head;
                    }
                }
                Some(Control::O(o)) => {
                    let o = o.clone();
                    self.link_o(index, &o, &mut open, names)?;
                }
                _ => {}
            }
        }
        self.require_closed(&loops)?;
        match open.pop() {
            None => Ok(()),
            Some(left) => Err(self.unmatched(
                left.head,
                both!("this O-word has no end in its file", "у этого слова O нет конца в его файле"),
            )),
        }
    }

    fn link_o(
        &mut self,
        index: u32,
        o: &OStatement,
        open: &mut Vec<Open>,
        names: &Names,
    ) -> Result<(), Box<Diagnostic>> {
        let Label::Known(label) = o.label else { return Ok(()) };
        let matches = |open: &[Open], kind: Construct| {
            open.last().is_some_and(|top| top.label == label && top.kind == kind)
        };
        match o.word {
            OWord::Call(_) | OWord::Return(_) => {}
            OWord::Sub => {
                if self.subroutines.insert(label, index).is_some() {
                    let message = both!(
                        "subroutine {} is defined twice",
                        "подпрограмма {} определена дважды",
                        names.name(label)
                    );
                    return Err(self.unmatched(index, message));
                }
                open.push(Open::new(label, Construct::Sub, index));
            }
            OWord::If(_) => open.push(Open::new(label, Construct::If, index)),
            OWord::Repeat(_) => open.push(Open::new(label, Construct::Repeat, index)),
            OWord::Do => open.push(Open::new(label, Construct::Do, index)),
            OWord::While(_) if !matches(open, Construct::Do) => {
                open.push(Open::new(label, Construct::While, index));
            }
            OWord::ElseIf(_) | OWord::Else => {
                if !matches(open, Construct::If) {
                    return Err(self.unmatched(
                        index,
                        both!(
                            "this branch belongs to no `if` that is open here",
                            "эта ветвь не относится ни к одному `if`, открытому здесь"
                        ),
                    ));
                }
                if let Some(top) = open.last_mut() {
                    let before = std::mem::replace(&mut top.last, index);
                    top.parts.push(index);
                    self.set(before, |o| o.next = index);
                }
            }
            OWord::Break | OWord::Continue => {
                let Some(around) = open.iter_mut().rev().find(|o| o.label == label && o.kind.is_loop())
                else {
                    return Err(self.unmatched(
                        index,
                        both!(
                            "this belongs to no loop that is open here",
                            "это не относится ни к одному циклу, открытому здесь"
                        ),
                    ));
                };
                around.parts.push(index);
            }
            OWord::EndSub(_) => self.close(index, (label, Construct::Sub), open)?,
            OWord::EndIf => self.close(index, (label, Construct::If), open)?,
            OWord::EndWhile => self.close(index, (label, Construct::While), open)?,
            OWord::EndRepeat => self.close(index, (label, Construct::Repeat), open)?,
            OWord::While(_) => self.close(index, (label, Construct::Do), open)?,
        }
        Ok(())
    }

    /// The end of what is open, of a label and a kind.
    fn close(
        &mut self,
        index: u32,
        (label, kind): (NameId, Construct),
        open: &mut Vec<Open>,
    ) -> Result<(), Box<Diagnostic>> {
        let Some(top) = open.pop_if(|top| top.label == label && top.kind == kind) else {
            let why = both!("this closes nothing that is open here", "здесь нечего закрывать");
            return Err(self.unmatched(index, why));
        };
        self.set(top.last, |o| o.next = index);
        for part in top.parts.iter().chain([&top.head]) {
            self.set(*part, |o| o.end = index);
        }
        self.set(index, |o| {
            o.next = top.head;
            o.foot = kind == Construct::Do;
        });
        Ok(())
    }

    fn set(&mut self, at: u32, change: impl FnOnce(&mut OStatement)) {
        if let Some(Control::O(o)) = self.statements.get_mut(at as usize).and_then(control) {
            change(o);
        }
    }

    /// Refuses a loop that is still open at the end of its program.
    fn require_closed(&self, loops: &[(u32, u32)]) -> Result<(), Box<Diagnostic>> {
        let Some((start, _)) = loops.last() else { return Ok(()) };
        let message = both!("this loop has no END in its program", "у этого цикла нет END в его программе");
        Err(self.unmatched(*start, message))
    }

    fn unmatched(&self, at: u32, message: Text) -> Box<Diagnostic> {
        let span = self.statements.get(at as usize).map_or(0..0, |statement| self.span(statement));
        Box::new(Diagnostic::error(codes::STRUCTURE, message).at(span, both!("without its partner", "без пары")).help(
            both!("loops, branches and subroutines end where they begin: in the same file, inside one another", "циклы, ветви и подпрограммы кончаются там, где начинаются: в том же файле, одни внутри других"),
        ))
    }
}

/// The name of a block's label.
fn label(block: &Block<'_>, dialect: &Dialect, names: &mut Names) -> Option<NameId> {
    block.items.iter().filter(|item| item.kind == ItemKind::Name).find_map(|item| {
        let name = match block.text(item.span) {
            name if dialect.marks.labels => Some(name).filter(|name| name[0].eq_ignore_ascii_case(&b'N')),
            name => name.strip_suffix(b":"),
        }?;
        Some(names.id(name))
    })
}

fn control(statement: &mut Statement) -> Option<&mut Control> {
    if let Kind::Complex(complex) = &mut statement.kind { complex.control.as_mut() } else { None }
}

/// LinuxCNC: `(ABORT, text)` ends the program with an error.
fn aborts(block: &Block<'_>, dialect: &Dialect) -> bool {
    block.items.iter().any(|item| {
        let text = block.text(item.span);
        let alarm = || dialect.command(text)?.action.as_ref().filter(|does| **does == Action::Alarm);
        if item.kind == ItemKind::BracketCommand {
            return alarm().is_some();
        }
        dialect.flow.macros == Macros::LinuxCnc && item.kind == ItemKind::Comment && {
            let start: Vec<u8> = text[1..]
                .iter()
                .filter(|byte| !byte.is_ascii_whitespace())
                .take(6)
                .map(u8::to_ascii_lowercase)
                .collect();
            start == b"abort,"
        }
    })
}

/// What is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Construct {
    Sub,
    If,
    While,
    Do,
    Repeat,
    For,
}

impl Construct {
    const fn is_loop(self) -> bool {
        matches!(self, Self::While | Self::Do | Self::Repeat)
    }
}

struct Open {
    label: NameId,
    kind: Construct,
    head: u32,
    /// The last branch.
    last: u32,
    /// Branches, breaks, continues.
    parts: Vec<u32>,
}

impl Open {
    const fn new(label: NameId, kind: Construct, head: u32) -> Self {
        Self { label, kind, head, last: head, parts: Vec::new() }
    }
}

/// Facts of a block that is not there.
impl Default for Statement {
    fn default() -> Self {
        Self { offset: 0, length: 0, line: 0, section: 0, flags: Flags::default(), kind: Kind::Copy }
    }
}
