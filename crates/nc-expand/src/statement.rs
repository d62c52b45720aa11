//! Blocks as statements: what is copied, what is computed, where it goes on.

use diagnostic::{Diagnostic, Refusal, Text, both, refusal};
use nc_dialect::{Action, Dialect, TurningCycle};
use nc_syntax::{Block, GCode, Item, ItemKind, Macros, Reader, Span, Value as WordValue};

use crate::codes;
use crate::control::{Call, Control, Said};
use crate::expression::{Expression, Parser};
use crate::flow::{Taken, assignment, call_of, fanuc_flow, printed, skip_word};
use crate::o_word;
use crate::okuma;
use crate::refusals::calls as refusals;
use crate::siemens;
use crate::value::{Names, Program, Variable};

/// A block of a program.
#[derive(Clone, Debug)]
pub(crate) struct Statement {
    /// Bytes of the file before it.
    pub(crate) offset: u64,
    pub(crate) length: u32,
    pub(crate) line: u32,
    /// Which of the programs in the file it belongs to: O numbers count up.
    pub(crate) section: u32,
    pub(crate) flags: Flags,
    pub(crate) kind: Kind,
}

/// Facts that are asked for at every execution.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flags {
    pub(crate) skip: bool,
    /// M2, M30.
    pub(crate) ends: bool,
    pub(crate) inch: Option<bool>,
    /// A drilling cycle starts or ends: K counts then.
    pub(crate) cycle: Option<bool>,
    /// The N word, with the blanks behind it.
    pub(crate) number: Option<Span>,
    /// It has words besides N and O.
    pub(crate) words: bool,
    /// Nothing but names and comments.
    pub(crate) idle: bool,
    /// A cycle whose contour is a subroutine.
    pub(crate) routine: bool,
    /// A program starts here.
    pub(crate) starts: bool,
}

/// What a block is.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    /// Bytes as they are.
    Copy,
    /// `%`
    Percent,
    /// `O1000`, or `OSUB`, that starts a program.
    Program(Program),
    /// Prints variables (DPRNT): bytes as they are where the flat program sets none of them.
    Print(Vec<Option<Variable>>),
    /// Something to do.
    Complex(Box<Complex>),
    /// Cannot be read; told when it is reached.
    Broken(Box<Diagnostic>),
}

/// A block that computes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Complex {
    pub(crate) assignments: Vec<(Expression, Expression)>,
    /// The block without assignments and calls, where that is not the block itself.
    pub(crate) residual: Option<Vec<u8>>,
    /// Words with values to put in, in the residual's or the block's bytes.
    pub(crate) words: Vec<ComputedWord>,
    /// What is left besides N and comments.
    pub(crate) has_words: bool,
    /// The N word of the residual, with the blanks behind it.
    pub(crate) number: Option<Span>,
    pub(crate) control: Option<Control>,
    /// How many parts its expressions have.
    pub(crate) cost: u32,
}

impl Complex {
    /// True where nothing but the definition of a subroutine starts here.
    pub(crate) fn defines(&self) -> bool {
        matches!(&self.control, Some(Control::O(o)) if matches!(o.word, o_word::OWord::Sub))
    }
}

/// Bytes of a word before and behind its number.
pub(crate) type Around = (Box<[u8]>, Box<[u8]>);

/// A word whose number is computed.
#[derive(Clone, Debug)]
pub(crate) struct ComputedWord {
    pub(crate) letter: u8,
    pub(crate) comma: bool,
    pub(crate) span: Span,
    pub(crate) value: Expression,
    /// Bytes of the word before and behind its number, where these are not the letter alone: `CR=`, `X=IC(` and `)`.
    pub(crate) around: Option<Around>,
}

/// Blocks to statements.
pub(crate) struct Compiler<'d, 'n> {
    pub(crate) dialect: &'d Dialect,
    pub(crate) names: &'n mut Names,
}

type Fault = Box<Diagnostic>;

impl Compiler<'_, '_> {
    fn parser<'t>(&mut self, text: &'t [u8]) -> Parser<'t, '_> {
        let macros = self.dialect.flow.macros;
        let spelling = match macros {
            Macros::Siemens => Some(siemens::SPELLING),
            Macros::Okuma => Some(okuma::SPELLING),
            _ => None,
        };
        Parser::new(text, macros, spelling, self.names)
    }

    /// What a block is.
    pub(crate) fn kind(&mut self, block: &Block<'_>) -> (Kind, Flags) {
        let flags = self.flags(&block.items, block.bytes);
        let siemens = self.dialect.flow.macros == Macros::Siemens;
        let reads = |item: &&Item| {
            siemens
                && item.kind == ItemKind::BracketCommand
                && siemens::names_something(block.text(item.span))
        };
        let kind = if block.items.iter().any(|item| item.kind == ItemKind::Percent) {
            Kind::Percent
        } else if let Some(item) = block.items.iter().find(reads) {
            Kind::Broken(wrong(
                block,
                item.span,
                &both!(
                    "plain numbers were expected, since the flat program sets no variables",
                    "ожидались простые числа: развёрнутая программа переменных не задаёт"
                ),
            ))
        } else if needs_work(block, self.dialect) {
            match self.complex(block) {
                Ok(complex) => Kind::Complex(Box::new(complex)),
                Err(diagnostic) => Kind::Broken(diagnostic),
            }
        } else {
            match printed(block, self.dialect) {
                none if none.is_empty() => self.program(block).map_or(Kind::Copy, Kind::Program),
                variables => Kind::Print(variables),
            }
        };
        (kind, flags)
    }

    /// The program that a block starts: `O1000`, or Okuma's `OSUB`.
    pub(crate) fn program(&mut self, block: &Block<'_>) -> Option<Program> {
        // `:10` is a main block of Siemens.
        let siemens = self.dialect.flow.macros == Macros::Siemens;
        if let Some(number) = block.word(b'O').filter(|_| !siemens).and_then(|word| word.number()?.integer())
        {
            return Some(Program::Number(u32::try_from(number).unwrap_or(u32::MAX)));
        }
        let okuma = self.dialect.flow.macros == Macros::Okuma;
        let first = block.items.first().filter(|item| okuma && item.kind == ItemKind::Name)?;
        let name = block.text(first.span);
        name.first()?.eq_ignore_ascii_case(&b'O').then(|| Program::Name(self.names.id(name)))
    }

    fn flags(&self, items: &[Item], bytes: &[u8]) -> Flags {
        let idle = items.iter().all(|item| matches!(item.kind, ItemKind::Comment | ItemKind::Name));
        let mut flags = Flags { idle, ..Flags::default() };
        for item in items {
            flags.words |= !matches!(
                item.kind,
                ItemKind::Comment
                    | ItemKind::Name
                    | ItemKind::Percent
                    | ItemKind::Word { letter: b'N' | b'O', .. }
            );
            match item.kind {
                ItemKind::Skip => flags.skip = true,
                // `NEND` is a number too where it repeats; `OSUB` and `$PART.MIN%` are names.
                ItemKind::Name
                    if self.dialect.marks.labels
                        && !matches!(bytes[item.span.start as usize], b'O' | b'$') =>
                {
                    flags.number = Some(item.span);
                }
                ItemKind::Word { letter: b'N', .. } => {
                    let behind = &bytes[item.span.end as usize..];
                    let blanks = behind.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count() as u32;
                    flags.number = Some(Span { start: item.span.start, end: item.span.end + blanks });
                }
                ItemKind::Word { letter: b'M', value: WordValue::Number(number) } => {
                    let row = number.integer().and_then(|n| self.dialect.m_code(u16::try_from(n).ok()?));
                    flags.ends |= row.is_some_and(|row| row.ends_program);
                }
                ItemKind::Word { letter: b'G', value: WordValue::Number(number) } => {
                    let row = number.tenths().and_then(|t| self.dialect.code(nc_syntax::GCode(t)));
                    match row.map(|row| &row.action) {
                        Some(Action::Inch) => flags.inch = Some(true),
                        Some(Action::Millimetre) => flags.inch = Some(false),
                        Some(Action::Cycle(_)) => flags.cycle = Some(true),
                        Some(Action::Turning(
                            TurningCycle::FinishRoutine
                            | TurningCycle::RoughTurnRoutine(_)
                            | TurningCycle::RoughFaceRoutine(_),
                        )) => flags.routine = true,
                        Some(
                            Action::CycleCancel
                            | Action::Rapid
                            | Action::Line
                            | Action::ArcClockwise
                            | Action::ArcCounterClockwise
                            | Action::Curve(_),
                        ) => flags.cycle = Some(false),
                        _ => {}
                    }
                }
                _ => {}
            }
        }
        flags
    }

    fn complex(&mut self, block: &Block<'_>) -> Result<Complex, Fault> {
        let mut complex = Complex::default();
        // Flow first: what it leaves is read again as words.
        let mut cut: Vec<Span> = Vec::new();
        for item in &block.items {
            if item.kind == ItemKind::Flow {
                self.flow(block, item.span, &mut complex, &mut cut)?;
            }
        }
        if cut.is_empty() {
            self.words(block, block, &mut complex, None)?;
        } else {
            let text = without(block.bytes, &cut);
            let mut reader = Reader::new(&text, self.dialect);
            let mut rest = Block::default();
            reader.next(&mut rest);
            self.words(&rest, block, &mut complex, Some(&text))?;
            if complex.residual.is_none() {
                complex.residual = Some(text);
            }
        }
        if let Some(text) = &complex.residual {
            let mut reader = Reader::new(text, self.dialect);
            let mut rest = Block::default();
            reader.next(&mut rest);
            complex.number = self.flags(&rest.items, rest.bytes).number;
        } else {
            complex.number = self.flags(&block.items, block.bytes).number;
        }
        if complex.control.is_some() && !complex.assignments.is_empty() {
            return Err(wrong(
                block,
                whole(block),
                &both!(
                    "an assignment beside flow cannot be read",
                    "присваивание рядом с переходом не читается"
                ),
            ));
        }
        let named = matches!(&complex.control, Some(Control::Call(call)) if call.program.is_some());
        let refuse = |refusal: Refusal| Err(Box::new(refusal.at(block.file_span(whole(block)))));
        if named && complex.has_words {
            return refuse(refusals::WORDS_BESIDE_CALL);
        }
        let apart = self.dialect.flow.macros != Macros::LinuxCnc;
        if apart && complex.has_words && !complex.assignments.is_empty() {
            return refuse(refusals::WORDS_BESIDE_ASSIGNMENT);
        }
        Ok(complex)
    }

    /// The words of `rest`, which is `block` without what was read already.
    fn words(
        &mut self,
        rest: &Block<'_>,
        block: &Block<'_>,
        complex: &mut Complex,
        text: Option<&[u8]>,
    ) -> Result<(), Fault> {
        let call = self.call_words(rest, block, complex)?;
        let mut cut: Vec<Span> = Vec::new();
        for item in &rest.items {
            let (letter, comma, value) = match item.kind {
                ItemKind::Word { letter, value } => (letter, false, value),
                ItemKind::CommaWord { letter, value } => (letter, true, value),
                ItemKind::Comment | ItemKind::Skip | ItemKind::Name => continue,
                _ => {
                    complex.has_words = true;
                    continue;
                }
            };
            if !comma && call.is_some_and(|taken| taken.contains(letter, rest.text(item.span))) {
                cut.push(item.span);
                continue;
            }
            complex.has_words |= letter != b'N';
            if value == WordValue::Expression && !self.is_plain(rest.text(item.span)) {
                let value = self.word_value(rest.text(item.span), comma, complex);
                let value = value.map_err(|fault| wrong_at(block, rest, item.span, &fault))?;
                let around = self.around(rest.text(item.span));
                complex.words.push(ComputedWord { letter, comma, span: item.span, value, around });
            }
        }
        if !cut.is_empty() {
            // Computed words move to the left by what is cut before them.
            for word in &mut complex.words {
                let shift: u32 = cut
                    .iter()
                    .filter(|span| span.end <= word.span.start)
                    .map(|span| span.end - span.start)
                    .sum();
                word.span = Span { start: word.span.start - shift, end: word.span.end - shift };
            }
            complex.residual = Some(without(text.unwrap_or(rest.bytes), &cut));
        }
        Ok(())
    }

    /// The expression of a word, behind its letter.
    fn word_value(&mut self, text: &[u8], comma: bool, complex: &mut Complex) -> Result<Expression, Text> {
        if self.dialect.flow.macros.bare_names() {
            let value =
                siemens::value_of(text).ok_or_else(|| both!("a value was expected", "ожидалось значение"))?;
            let mut parser = self.parser(&text[value]);
            let value = parser.expression()?;
            parser.end()?;
            complex.cost += parser.cost;
            return Ok(value);
        }
        let letter =
            if comma { 1 + text[1..].iter().position(u8::is_ascii_alphabetic).unwrap_or(0) + 1 } else { 1 };
        let mut parser = self.parser(&text[letter..]);
        let value = parser.operand()?;
        parser.end()?;
        complex.cost += parser.cost;
        Ok(value)
    }

    /// What stands around the number of a word of Siemens.
    fn around(&self, text: &[u8]) -> Option<Around> {
        let value = siemens::value_of(text).filter(|_| self.dialect.flow.macros.bare_names())?;
        Some((text[..value.start].into(), text[value.end..].into()))
    }

    fn is_plain(&self, text: &[u8]) -> bool {
        self.dialect.flow.macros.bare_names() && siemens::is_plain(text)
    }

    /// M98, M99, G65: notes the call, and says which words are its own.
    fn call_words(
        &mut self,
        rest: &Block<'_>,
        block: &Block<'_>,
        complex: &mut Complex,
    ) -> Result<Option<Taken>, Fault> {
        if self.dialect.flow.macros == Macros::Siemens && ends_subprogram(rest) {
            complex.control = Some(Control::Return { to: None });
            return Ok(Some(Taken::End));
        }
        let calls = !self.dialect.flow.macros.bare_names();
        let Some(kind) = call_of(rest, self.dialect.flow).filter(|_| calls) else {
            return Ok(None);
        };
        let refuse = |refusal: Refusal| Box::new(refusal.at(block.file_span(whole(block))));
        if complex.control.is_some() {
            return Err(refuse(refusals::CALL_BESIDE_FLOW));
        }
        self.call_alone(rest, kind).map_err(refuse)?;
        let mut program = None;
        let mut repeats = None;
        let mut arguments = Vec::new();
        for word in rest.words() {
            if matches!(word.letter, b'G' | b'N') || (word.letter == b'M' && kind != Taken::Macro) {
                continue;
            }
            let mut point = true;
            let value = match word.value {
                WordValue::Number(number) => {
                    point = number.has_point;
                    Expression::Number(number.to_f64())
                }
                WordValue::Expression => self
                    .word_value(rest.text(word.span), false, complex)
                    .map_err(|fault| wrong_at(block, rest, word.span, &fault))?,
                WordValue::Missing => {
                    return Err(wrong(
                        block,
                        whole(block),
                        &both!("a letter has no number", "у буквы нет числа"),
                    ));
                }
            };
            match word.letter {
                b'P' => program = Some(value),
                b'L' => repeats = Some(value),
                b'O' => {}
                letter if kind == Taken::Macro => arguments.push((letter, value, point)),
                _ => {}
            }
        }
        complex.control = Some(if kind == Taken::Return {
            if repeats.is_some() {
                return Err(refuse(refusals::RETURN_WITH_COUNT));
            }
            Control::Return { to: program }
        } else {
            Control::Call(Box::new(Call {
                number: program.ok_or_else(|| refuse(refusals::CALL_WITHOUT_PROGRAM))?,
                program: None,
                local: kind == Taken::Local,
                repeats,
                arguments: (kind == Taken::Macro).then_some(arguments),
            }))
        });
        Ok(Some(kind))
    }

    /// Whose the words beside a call are must be certain.
    fn call_alone(&self, rest: &Block<'_>, kind: Taken) -> Result<(), Refusal> {
        let mut codes = rest.words().filter(|word| word.letter == b'G').map(|word| word.g_code());
        if kind == Taken::Macro {
            let alone = codes.all(|code| code == Some(GCode(650)));
            return if alone { Ok(()) } else { Err(refusals::MACRO_BESIDE_CODE) };
        }
        // P and L beside a code that takes them too.
        let simple = |action: &Action| {
            matches!(
                action,
                Action::Rapid
                    | Action::Line
                    | Action::Absolute
                    | Action::Incremental
                    | Action::Plane(_)
                    | Action::WorkOffset(_)
                    | Action::Inch
                    | Action::Millimetre
            )
        };
        if !codes
            .all(|code| code.and_then(|code| self.dialect.code(code)).is_some_and(|row| simple(&row.action)))
        {
            return Err(refusals::CALL_BESIDE_CODE);
        }
        let linuxcnc = self.dialect.flow.macros == Macros::LinuxCnc;
        if linuxcnc && rest.words().any(|word| !b"NMPL".contains(&word.letter)) {
            return Err(refusals::CALL_BESIDE_WORDS);
        }
        Ok(())
    }

    /// A flow item: assignments, conditions, loops, O-words. Notes in `cut` what is no words.
    fn flow(
        &mut self,
        block: &Block<'_>,
        span: Span,
        complex: &mut Complex,
        cut: &mut Vec<Span>,
    ) -> Result<(), Fault> {
        let text = block.text(span);
        let fanuc = self.dialect.flow.macros == Macros::Fanuc;
        let mut parser = self.parser(text);
        let mut read = || -> Result<Option<Control>, Text> {
            if parser.macros.bare_names() {
                cut.push(span);
                let said = match parser.macros {
                    Macros::Okuma => okuma::statement(&mut parser)?,
                    _ => siemens::statement(&mut parser)?,
                };
                return Ok(match said {
                    Said::Assignments(found) => {
                        complex.assignments.extend(found);
                        None
                    }
                    Said::Control(control) => Some(control),
                });
            }
            if parser.peek() == Some(b'#') {
                while parser.peek() == Some(b'#') {
                    let start = parser.at;
                    complex.assignments.push(assignment(&mut parser)?);
                    cut.push(Span { start: span.start + start as u32, end: span.start + parser.at as u32 });
                    if fanuc {
                        parser.end()?;
                    }
                    // Words and further assignments: words are read again, so only find the next `#`.
                    while parser.peek().is_some_and(|byte| byte != b'#') {
                        skip_word(&mut parser)?;
                    }
                }
                return Ok(None);
            }
            cut.push(span);
            let control = if parser.peek() == Some(b'O') && !fanuc {
                Some(Control::O(Box::new(o_word::parse(&mut parser)?)))
            } else if fanuc {
                Some(fanuc_flow(&mut parser)?)
            } else {
                return Err(both!(
                    "this is no statement of this dialect",
                    "такого оператора в этом диалекте нет"
                ));
            };
            parser.end()?;
            Ok(control)
        };
        let control = read();
        complex.cost += parser.cost;
        match control {
            Ok(None) => Ok(()),
            Ok(found) => {
                if complex.control.is_some() {
                    return Err(wrong(
                        block,
                        span,
                        &both!("two statements stand in one block", "в одном кадре два оператора"),
                    ));
                }
                complex.control = found;
                Ok(())
            }
            Err(fault) => Err(wrong(block, span, &fault)),
        }
    }
}

/// True where a block is more than bytes to copy.
pub(crate) fn needs_work(block: &Block<'_>, dialect: &Dialect) -> bool {
    let linuxcnc = dialect.flow.macros == Macros::LinuxCnc;
    if dialect.flow.macros.bare_names() {
        return block.items.iter().any(|item| match item.kind {
            ItemKind::Flow => true,
            ItemKind::Word { value: WordValue::Expression, .. } => !siemens::is_plain(block.text(item.span)),
            _ => false,
        }) || (dialect.flow.macros == Macros::Siemens && ends_subprogram(block));
    }
    block.items.iter().any(|item| match item.kind {
        ItemKind::Flow => true,
        ItemKind::Word { value: WordValue::Expression, .. }
        | ItemKind::CommaWord { value: WordValue::Expression, .. } => true,
        ItemKind::Word { letter: b'M', value: WordValue::Number(number) } => {
            number.integer().is_some_and(|code| dialect.flow.calls(code))
        }
        ItemKind::Word { letter: b'G', value: WordValue::Number(number) } => {
            !linuxcnc && number.tenths() == Some(650)
        }
        _ => false,
    })
}

/// M17
fn ends_subprogram(block: &Block<'_>) -> bool {
    block
        .words()
        .any(|word| word.letter == b'M' && word.number().and_then(|number| number.integer()) == Some(17))
}

/// All of the block but its end.
pub(crate) fn whole(block: &Block<'_>) -> Span {
    let start = block.items.first().map_or(0, |item| item.span.start);
    let end = block.items.last().map_or(0, |item| item.span.end);
    Span { start, end }
}

fn wrong(block: &Block<'_>, span: Span, fault: &Text) -> Fault {
    let found: String = String::from_utf8_lossy(block.text(span)).chars().take(60).collect();
    Box::new(
        refusal!(codes::SYNTAX;
            "`{}` cannot be read: {fault}", "`{}` не читается: {fault:#}", found.trim();
            "not understood", "непонятно";
            "write it as the control's manual does, or post the program without variables and flow",
            "напишите так, как в руководстве стойки, или выведите программу без переменных и переходов"
        )
        .at(block.file_span(span)),
    )
}

/// The same where the words were read from a copy: the place is the block.
fn wrong_at(block: &Block<'_>, rest: &Block<'_>, span: Span, fault: &Text) -> Fault {
    let own = std::ptr::eq(block, rest);
    if own { wrong(block, span, fault) } else { wrong(block, whole(block), fault) }
}

/// The bytes without some spans, which are in order.
fn without(bytes: &[u8], cut: &[Span]) -> Vec<u8> {
    let mut text = Vec::with_capacity(bytes.len());
    let mut from = 0;
    for span in cut {
        text.extend_from_slice(&bytes[from..span.start as usize]);
        from = span.end as usize;
    }
    text.extend_from_slice(&bytes[from..]);
    text
}

/// True where a block computes, jumps or calls.
pub(crate) fn flows(block: &Block<'_>, dialect: &Dialect) -> bool {
    dialect.flow.macros != Macros::None && needs_work(block, dialect)
}
