//! Calls: M97, M98, G65, O-words.

use std::borrow::Cow;
use std::io::ErrorKind;
use std::rc::Rc;

use diagnostic::{Text, both, of_system, refusal};
use nc_dialect::PointFree;
use nc_syntax::Macros;

use crate::call_stack::{CallKind, Place};
use crate::codes;
use crate::control::{Call, Control};
use crate::expression::Expression;
use crate::faults::{self, Stop, say, whole};
use crate::flow::variables;
use crate::o_word::{Label, OStatement, OWord};
use crate::program::Source;
use crate::refusals::calls as refusal;
use crate::run::{Run, Visit};
use crate::statement::{Kind, Statement};
use crate::value::{NameId, Program, Value};

impl<'a> Run<'a, '_> {
    /// M97, M98 and G65.
    pub(crate) fn call(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        call: &Call,
        place: Place,
    ) -> Result<(), Stop> {
        if let Some(program) = call.program {
            let passes = match &call.repeats {
                Some(repeats) => whole(
                    &Text::pair("the count of a call", "число повторений вызова"),
                    self.known(repeats)?,
                )?,
                None => 1,
            };
            if passes == 0 {
                return Ok(());
            }
            if self.dialect.flow.macros == Macros::Okuma {
                let program = Program::Name(program);
                let start = self.find_program(source, place.file, program)?;
                return self.enter(start, CallKind::Number(program), passes, None, statement.section, place);
            }
            let start = self.find_named(program)?;
            return self.enter(start, CallKind::Program(program), passes, None, statement.section, place);
        }
        let what = if call.local {
            Text::pair("a block number", "номер кадра")
        } else {
            Text::pair("the number of a program", "номер программы")
        };
        let mut program = whole(&what, self.known(&call.number)?)?;
        let mut passes = match &call.repeats {
            Some(repeats) => {
                whole(&Text::pair("the count of a call", "число повторений вызова"), self.known(repeats)?)?
            }
            None => 1,
        };
        if call.local {
            if passes == 0 {
                return Ok(());
            }
            let start = Place { statement: self.block(source, statement.section, program)?, ..place };
            let kind = CallKind::Block(program);
            return self.enter(start, kind, passes, None, statement.section, place);
        }
        let packed = call.repeats.is_none() && call.arguments.is_none() && program > 9999;
        if packed && self.dialect.flow.packed_repeats {
            if u32::try_from(program)
                .is_ok_and(|number| source.programs.contains_key(&Program::Number(number)))
            {
                return Err(say(refusal::program_or_count(program, program / 10_000, program % 10_000)));
            }
            (passes, program) = (program / 10_000, program % 10_000);
        }
        let arguments = match &call.arguments {
            None => None,
            Some(words) => Some(self.arguments(words)?),
        };
        if arguments.is_some() && passes > 1 {
            return Err(say(refusal::g65_with_count(passes)));
        }
        if passes == 0 {
            return Ok(());
        }
        let program = Program::Number(u32::try_from(program).unwrap_or(u32::MAX));
        let start = self.find_program(source, place.file, program)?;
        self.enter(start, CallKind::Number(program), passes, arguments.as_deref(), statement.section, place)
    }

    /// True where the control has the program of a call, and no file: the profile says so, or its number does.
    pub(crate) fn is_left_alone(
        &mut self,
        source: &Source<'a>,
        call: &Call,
        place: Place,
    ) -> Result<bool, Stop> {
        let Ok(Value::Number(number) | Value::Rounded(number)) = self.evaluate(&call.number) else {
            return Ok(false);
        };
        let packed = self.dialect.flow.packed_repeats && call.repeats.is_none() && call.arguments.is_none();
        let number = if packed && number > 9999.0 { number % 10_000.0 } else { number };
        let number = if number.fract() == 0.0 { number as u32 } else { return Ok(false) };
        let own = self.dialect.flow.control_programs;
        let known =
            self.declared(call, number) || own.is_some_and(|(first, last)| (first..=last).contains(&number));
        if call.local || call.program.is_some() || !known {
            return Ok(false);
        }
        match self.find_program(source, place.file, Program::Number(number)) {
            Err(Stop::Said(said)) if said.code == codes::PROGRAM_MISSING => Ok(true),
            _ => Ok(false),
        }
    }

    /// The profile says what a call moves.
    fn declared(&self, call: &Call, number: u32) -> bool {
        let (letter, tenths) = if call.arguments.is_some() { (b'G', 650) } else { (b'M', 980) };
        self.dialect.control_call(letter, tenths, Some(number)).is_some()
    }

    /// A call of what the control has stays as it is written.
    pub(crate) fn leave_alone(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        call: &Call,
        visit: Visit,
    ) -> Result<(), Stop> {
        let words = source.bytes(statement);
        if !self.are_untouched(&variables(words)) {
            return Err(say(refusal::COMPUTED_ARGUMENT));
        }
        self.copy(source, statement, visit);
        self.note(statement);
        let number = self.known(&call.number)?;
        if visit.place.file == 0 && !self.declared(call, number as u32) {
            let code = if call.arguments.is_some() { "G65" } else { "M98" };
            let span = source.span(statement);
            self.left_alone.entry(format!("{code} P{number}")).or_insert(span);
        }
        Ok(())
    }

    /// Arguments of G65 as local variables.
    ///
    /// I, J and K may come more than once: I1 J1 K1 I2 … are #4 #5 #6 #7 …; where two arguments name one variable,
    /// the later counts.
    fn arguments(
        &self,
        words: &[(u8, crate::expression::Expression, bool)],
    ) -> Result<Vec<(u32, Value)>, Stop> {
        let mut arguments = Vec::with_capacity(words.len());
        let (mut group, mut last) = (0_u32, None);
        for (letter, value, point) in words {
            let variable = match letter {
                b'I' | b'J' | b'K' => {
                    let order = u32::from(letter - b'I');
                    if last.is_some_and(|last| order <= last) {
                        group += 1;
                    }
                    last = Some(order);
                    4 + 3 * group + order
                }
                _ => match argument_variable(*letter) {
                    Some(variable) => variable,
                    None => {
                        return Err(say(refusal::no_argument(*letter as char)));
                    }
                },
            };
            if variable > 33 {
                return Err(say(refusal::TOO_MANY_GROUPS_OF_ARGUMENTS));
            }
            let mut value = self.evaluate(value)?;
            if let (false, Value::Number(number)) = (*point, value) {
                value = Value::Number(self.scaled(*letter, number)?);
            }
            arguments.push((variable, value));
        }
        Ok(arguments)
    }

    /// An argument without a point counts what its letter counts in a motion block.
    fn scaled(&self, letter: u8, number: f64) -> Result<f64, Stop> {
        if number == 0.0 || self.dialect.numbers.point_free == PointFree::Unit {
            return Ok(number);
        }
        match letter {
            b'D' | b'H' | b'M' | b'S' | b'T' => Ok(number),
            b'B' | b'E' | b'F' => Err(say(refusal::argument_without_point(letter as char, number))),
            _ => Ok(number / f64::from(10_u32.pow(u32::from(self.least_increment_decimals().min(9))))),
        }
    }

    /// Where a subprogram of Siemens starts: in a file of its name, which its header may say again.
    fn find_named(&mut self, program: NameId) -> Result<Place, Stop> {
        let name = self.names.name(program).to_ascii_uppercase();
        let lower = name.to_ascii_lowercase();
        let names = [
            format!("{name}.SPF"),
            format!("{lower}.spf"),
            format!("{name}.spf"),
            format!("_N_{name}_SPF"),
            format!("{name}.MPF"),
            name.clone(),
        ];
        let file = self.external(&names, &name)?;
        let source = Rc::clone(&self.sources[file]);
        let first = source.statements.iter().position(|statement| !matches!(statement.kind, Kind::Percent));
        Ok(Place { file, statement: first.unwrap_or(0) as u32 })
    }

    /// Where a program with an O number, or with a name of Okuma's, starts.
    fn find_program(&mut self, source: &Source<'a>, file: usize, program: Program) -> Result<Place, Stop> {
        let written = program.written(&self.names);
        let behind = |file: usize, source: &Source<'_>, at: u32| match source.statements.get(at as usize) {
            // What stands beside its number is executed too, and would be passed over here.
            Some(statement) if statement.flags.words => Err(words_beside(&written)),
            Some(_) => Ok(Place { file, statement: at + 1 }),
            None => Err(say(refusal::stands_twice(&written))),
        };
        if let Some(statement) = source.programs.get(&program) {
            return behind(file, source, *statement);
        }
        for (file, source) in self.sources.iter().enumerate() {
            if let Some(statement) = source.programs.get(&program) {
                return behind(file, source, *statement);
            }
        }
        let names = self.files_of(program, &written);
        let file = self.external(&names, &written)?;
        let source = Rc::clone(&self.sources[file]);
        if let Some(statement) = source.programs.get(&program) {
            return behind(file, &source, *statement);
        }
        if source.programs.is_empty() {
            let first =
                source.statements.iter().position(|statement| !matches!(statement.kind, Kind::Percent));
            return Ok(Place { file, statement: first.unwrap_or(0) as u32 });
        }
        Err(say(refusal::file_holds(&source.name, &written)))
    }

    /// Names of the files in which a program may stand.
    fn files_of(&self, program: Program, written: &str) -> Vec<String> {
        let mut stems = vec![written.to_owned(), written.to_ascii_lowercase()];
        if let Program::Number(number) = program {
            if self.dialect.flow.macros == Macros::LinuxCnc {
                return vec![format!("{number}.ngc")];
            }
            stems.extend([format!("{number:04}"), format!("{number}")]);
        }
        let endings: &[&str] = match self.dialect.flow.macros {
            Macros::Okuma => &["", ".SUB", ".MIN", ".SSB", ".LIB", ".sub", ".min", ".ssb", ".lib"],
            _ => &["", ".nc", ".NC", ".tap", ".txt", ".cnc"],
        };
        let ended =
            |stem: &String| endings.iter().map(|ending| format!("{stem}{ending}")).collect::<Vec<_>>();
        stems.iter().flat_map(ended).collect()
    }

    /// Reads a called file; each name is asked for once.
    fn external(&mut self, names: &[String], what: &str) -> Result<usize, Stop> {
        for name in names {
            match self.externals.get(name) {
                Some(Some(file)) => return Ok(*file),
                Some(None) => continue,
                None => {}
            }
            match (self.environment.read_external)(name) {
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    self.externals.insert(name.clone(), None);
                }
                Err(error) if error.kind() == ErrorKind::InvalidInput => return Err(leaves(name)),
                Err(error) => {
                    return Err(say(refusal::unreadable_file(name, &of_system(&error))));
                }
                Ok(text) => {
                    if let Err(diagnostic) = nc_syntax::looks_like_program(&text) {
                        return Err(say(refusal!(codes::UNREADABLE_FILE;
                            "subprogram file {name}: {}",
                            "файл подпрограммы {name}: {:#}", diagnostic.message;
                            "called here", "вызвана здесь";
                            diagnostic.help.unwrap_or_default()
                        )));
                    }
                    let read = Source::read(name.clone(), Cow::Owned(text), self.dialect, &mut self.names);
                    let source =
                        read.map_err(|(diagnostic, text)| Stop::InFile(diagnostic, name.clone(), text))?;
                    let file = self.add(source);
                    self.externals.insert(name.clone(), Some(file));
                    return Ok(file);
                }
            }
        }
        let looked = match names {
            [one] => one.clone(),
            [first, .., last] => format!("{first} … {last}"),
            [] => String::new(),
        };
        Err(say(refusal::no_such_file(what, looked)))
    }

    /// True while the contour of a cycle is read.
    pub(crate) fn in_routine(&self) -> bool {
        self.frames.iter().any(|frame| matches!(frame.kind, CallKind::Routine(_)))
    }

    /// Puts the subroutine that Q of a cycle names behind its block, which came last. What is missing the cycle itself
    /// refuses.
    pub(crate) fn routine(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        place: Place,
    ) -> Result<(), Stop> {
        if self.in_routine() {
            return Err(within_routine());
        }
        let Some(number) = self.out.last_q else { return Ok(()) };
        let name = self.names.id(number.to_string().as_bytes());
        self.store.learn(&self.names);
        let Some(start) = source.subroutines.get(&name).filter(|start| **start < place.statement) else {
            return Ok(());
        };
        let start = Place { statement: start + 1, ..place };
        self.out.fresh_line();
        self.enter(start, CallKind::Routine(name), 1, Some(&[]), statement.section, place)
    }

    /// An O-word.
    pub(crate) fn o_word(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        o: &OStatement,
        place: Place,
    ) -> Result<(), Stop> {
        match &o.word {
            OWord::Sub => self.at.statement = o.next + 1,
            OWord::EndSub(value) | OWord::Return(value) => self.end_subroutine(o, value.as_ref())?,
            OWord::Call(_) if self.in_routine() => return Err(within_routine()),
            OWord::Call(arguments) => {
                let mut values = Vec::with_capacity(arguments.len());
                for (number, argument) in (1..).zip(arguments) {
                    values.push((number, self.evaluate(argument)?));
                }
                let label = match &o.label {
                    Label::Known(label) => *label,
                    Label::Computed(number) => {
                        let number =
                            whole(&Text::pair("the label of a call", "метка вызова"), self.known(number)?)?;
                        self.names.id(number.to_string().as_bytes())
                    }
                };
                let start = self.find_subroutine(source, place.file, label)?;
                self.enter(start, CallKind::Name(label), 1, Some(&values), statement.section, place)?;
            }
            OWord::If(condition) => {
                if !self.holds(condition)? {
                    self.next_branch(source, o.next)?;
                }
            }
            OWord::ElseIf(_) | OWord::Else => self.at.statement = o.end + 1,
            OWord::EndIf | OWord::Do => {}
            OWord::While(condition) => match (o.foot, self.holds(condition)?) {
                (true, true) | (false, false) => self.at.statement = o.next + 1,
                (true, false) | (false, true) => {}
            },
            OWord::EndWhile => self.at.statement = o.next,
            OWord::Repeat(count) => {
                // The interpreter rounds halves to even: 2.5 turns are two.
                let count = self.known(count)?.round_ties_even();
                if count >= 1.0 {
                    self.repeats.push((place.statement, count.min(9e15) as u64));
                } else {
                    self.at.statement = o.next + 1;
                }
            }
            OWord::EndRepeat => {
                if let Some((_, left)) = self.repeats.last_mut().filter(|(head, _)| *head == o.next) {
                    *left -= 1;
                    if *left > 0 {
                        self.at.statement = o.next + 1;
                    } else {
                        self.repeats.pop();
                    }
                }
            }
            OWord::Break | OWord::Continue => {
                let head = match source.statements.get(o.end as usize).map(|end| &end.kind) {
                    Some(Kind::Complex(complex)) => match &complex.control {
                        Some(Control::O(end)) => end.next,
                        _ => 0,
                    },
                    _ => 0,
                };
                let stays = matches!(o.word, OWord::Continue);
                self.repeats.retain(|(open, _)| *open < head || (stays && *open == head));
                self.at.statement = if stays { o.end } else { o.end + 1 };
            }
        }
        Ok(())
    }

    /// `endsub` and `return`, with the value that they hand back.
    fn end_subroutine(&mut self, o: &OStatement, value: Option<&Expression>) -> Result<(), Stop> {
        let value = value.map(|value| self.evaluate(value)).transpose()?;
        match self.frames.last().map(|frame| frame.kind) {
            Some(CallKind::Routine(_)) if matches!(o.word, OWord::Return(_)) => return Err(within_routine()),
            Some(CallKind::Routine(_)) => {
                self.leave(true);
                return Ok(());
            }
            Some(CallKind::Name(_)) => {}
            _ => {
                let what = both!("`return` outside a subroutine", "`return` вне подпрограммы");
                return Err(faults::no_call(&what));
            }
        }
        self.leave(true);
        let returned = Value::Number(f64::from(u8::from(value.is_some())));
        let value = value.unwrap_or(Value::Number(0.0));
        for (name, value) in [(&b"_value"[..], value), (b"_value_returned", returned)] {
            let id = self.names.id(name);
            self.store.learn(&self.names);
            self.store.set_named(id, value);
        }
        Ok(())
    }

    /// The first branch whose condition holds.
    fn next_branch(&mut self, source: &Source<'a>, mut branch: u32) -> Result<(), Stop> {
        while let Some(Kind::Complex(complex)) =
            source.statements.get(branch as usize).map(|statement| &statement.kind)
            && let Some(Control::O(o)) = &complex.control
            && let OWord::ElseIf(condition) = &o.word
            && !self.holds(condition)?
        {
            self.spend(1)?;
            branch = o.next;
        }
        self.at.statement = branch + 1;
        Ok(())
    }

    fn find_subroutine(&mut self, source: &Source<'a>, file: usize, label: NameId) -> Result<Place, Stop> {
        if let Some(statement) = source.subroutines.get(&label) {
            return Ok(Place { file, statement: statement + 1 });
        }
        for (file, source) in self.sources.iter().enumerate() {
            if let Some(statement) = source.subroutines.get(&label) {
                return Ok(Place { file, statement: statement + 1 });
            }
        }
        let name = self.names.name(label).to_owned();
        if name.contains(['/', '\\', ':', '\0']) || name.starts_with('.') {
            return Err(leaves(&name));
        }
        let file = self.external(&[format!("{name}.ngc")], &format!("o<{name}>"))?;
        match self.sources[file].subroutines.get(&label) {
            Some(statement) => Ok(Place { file, statement: statement + 1 }),
            None => Err(say(refusal::file_without_its_sub(name))),
        }
    }
}

fn within_routine() -> Stop {
    say(refusal::FLOW_WITHIN_CONTOUR)
}

fn words_beside(program: &str) -> Stop {
    say(refusal::words_beside_call(program))
}

fn leaves(name: &str) -> Stop {
    say(refusal::name_leads_out_of_folder(name))
}

/// The local variable of an argument's letter.
const fn argument_variable(letter: u8) -> Option<u32> {
    Some(match letter {
        b'A' => 1,
        b'B' => 2,
        b'C' => 3,
        b'D' => 7,
        b'E' => 8,
        b'F' => 9,
        b'H' => 11,
        b'M' => 13,
        b'Q' => 17,
        b'R' => 18,
        b'S' => 19,
        b'T' => 20,
        b'U' => 21,
        b'V' => 22,
        b'W' => 23,
        b'X' => 24,
        b'Y' => 25,
        b'Z' => 26,
        _ => return None,
    })
}
