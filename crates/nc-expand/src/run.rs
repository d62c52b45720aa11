//! Executes a program block by block and writes what is reached.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

use diagnostic::{Text, both};
use nc_dialect::{Action, Dialect};
use nc_syntax::{Macros, Span};

use crate::call_stack::{CallKind, Frame, Place};
use crate::came::From;
use crate::control::{Control, Direction};
use crate::evaluate::{Rules, Variables, number};
use crate::expanded::{Environment, Expanded, Refusal};
use crate::expression::Expression;
use crate::faults::{self, Stop};
use crate::flow;
use crate::lowering::{Driver, Lowered};
use crate::program::Source;
use crate::statement::{Complex, Kind, Statement};
use crate::value::{Names, Value, Variable};
use crate::variables::Store;

/// A place that is reached.
#[derive(Clone, Copy)]
pub(crate) struct Visit {
    pub(crate) place: Place,
    /// Not for the first time.
    pub(crate) again: bool,
}

pub(crate) struct Run<'a, 'e> {
    pub(crate) dialect: &'e Dialect,
    pub(crate) environment: &'e Environment<'e>,
    pub(crate) names: Names,
    pub(crate) store: Store,
    pub(crate) sources: Vec<Rc<Source<'a>>>,
    /// A bit for each statement that was executed.
    visited: Vec<Vec<u64>>,
    pub(crate) out: Driver<'e>,
    pub(crate) frames: Vec<Frame>,
    /// Running `repeat` loops of the running program: head and turns left.
    pub(crate) repeats: Vec<(u32, u64)>,
    /// Running `FOR` loops of the running program: head and last value.
    pub(crate) counts: Vec<(u32, f64)>,
    pub(crate) at: Place,
    pub(crate) previous: Option<Place>,
    steps: u64,
    /// Values that were assigned.
    assigned: u32,
    most_bytes: u64,
    pub(crate) inch: bool,
    pub(crate) cycle: bool,
    /// A block with words was executed.
    started: bool,
    /// The main program did something besides defining subroutines and ending.
    acted: bool,
    /// How often each subroutine was called.
    pub(crate) calls: BTreeMap<(usize, u32), u64>,
    /// File names that were looked for, and what was found.
    pub(crate) externals: BTreeMap<String, Option<usize>>,
    first_output: Option<std::ops::Range<u64>>,
    /// The first call of each program that the control has, where no profile says what it moves.
    pub(crate) left_alone: BTreeMap<String, std::ops::Range<u64>>,
    first_kept: Option<(std::ops::Range<u64>, Variable)>,
}

/// Whether the program goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Next {
    On,
    Ended,
}

/// Executes the program.
pub(crate) fn run<'a, 'e>(
    text: &'a [u8],
    dialect: &'e Dialect,
    environment: &'e Environment<'e>,
) -> Result<Expanded<'a>, Refusal> {
    let mut names = Names::default();
    names.bare = dialect.flow.macros.bare_names();
    let main = Source::read(String::new(), Cow::Borrowed(text), dialect, &mut names)
        .map_err(|(diagnostic, _)| Refusal { diagnostics: vec![*diagnostic], file: None })?;
    let mut store = Store::new(dialect.flow.macros, &mut names, environment.variables);
    store.learn(&names);
    let inch =
        dialect.initial.iter().filter_map(|code| dialect.code(*code)).any(|row| row.action == Action::Inch);
    let mut run = Run {
        dialect,
        environment,
        names,
        store,
        visited: vec![vec![0; main.statements.len() / 64 + 1]],
        sources: vec![Rc::new(main)],
        out: Driver::new(dialect, environment.setup, text),
        frames: Vec::new(),
        repeats: Vec::new(),
        counts: Vec::new(),
        at: Place { file: 0, statement: 0 },
        previous: None,
        steps: 0,
        assigned: 0,
        most_bytes: environment.limits.output_bytes.saturating_add(3 * text.len() as u64),
        inch,
        cycle: false,
        started: false,
        acted: false,
        calls: BTreeMap::new(),
        externals: BTreeMap::new(),
        first_output: None,
        left_alone: BTreeMap::new(),
        first_kept: None,
    };
    run.units(inch);
    match run.all() {
        Ok(()) => match run.first_definition() {
            Some(span) if !run.acted => {
                Err(Refusal { diagnostics: vec![faults::nothing_executed(span)], file: None })
            }
            _ => run.finish(),
        },
        Err(stop) => Err(run.refusal(&stop)),
    }
}

impl<'a> Run<'a, '_> {
    fn all(&mut self) -> Result<(), Stop> {
        loop {
            let file = self.at.file;
            let source = Rc::clone(&self.sources[file]);
            while self.at.file == file {
                let Some(statement) = source.statements.get(self.at.statement as usize) else {
                    if let Some(frame) = self.frames.last() {
                        return Err(self.no_return(frame.kind));
                    }
                    return Ok(());
                };
                let next = self.step(&source, statement)?;
                if next == Next::Ended {
                    return Ok(());
                }
                if self.section_ends() {
                    self.leave(false);
                }
            }
        }
    }

    /// Executes one block and moves on.
    fn step(&mut self, source: &Source<'a>, statement: &Statement) -> Result<Next, Stop> {
        let visit = self.visit(self.at);
        let place = visit.place;
        self.at.statement += 1;
        let another = statement.flags.starts || matches!(statement.kind, Kind::Percent);
        if let Some(frame) = self.frames.last().filter(|_| another) {
            return Err(self.no_return(frame.kind));
        }
        if statement.flags.starts && self.started {
            let program = match &statement.kind {
                Kind::Program(program) => *program,
                _ => source.program_at(place.statement),
            };
            return Err(faults::runs_into(&program.written(&self.names)));
        }
        match &statement.kind {
            _ if statement.flags.ends && self.called_by_name() => {
                return Err(faults::no_call(&both!(
                    "M2 or M30 in a subprogram: it ends the subprogram, or all of the program",
                    "M2 или M30 в подпрограмме: конец подпрограммы или всей программы"
                )));
            }
            Kind::Copy => {
                self.copy(source, statement, visit);
                self.note(statement);
                self.acted |= statement.flags.words && !statement.flags.ends;
                if statement.flags.routine {
                    self.routine(source, statement, place)?;
                }
                self.spend(u64::from(visit.again))?;
                self.bounded()?;
            }
            Kind::Print(variables) => {
                self.started = true;
                self.print(source, statement, variables, visit);
                self.spend(u64::from(visit.again))?;
                self.bounded()?;
            }
            Kind::Complex(complex) => {
                self.spend(u64::from(visit.again) * (1 + u64::from(complex.cost) / 16))?;
                self.started = true;
                self.acted |= !complex.defines();
                self.complex(source, statement, complex, visit)?;
                self.bounded()?;
                if statement.flags.routine {
                    self.routine(source, statement, place)?;
                }
            }
            Kind::Percent => {
                self.copy(source, statement, visit);
                if self.started {
                    return Ok(Next::Ended);
                }
            }
            Kind::Program(_) => self.copy(source, statement, visit),
            Kind::Broken(diagnostic) => return Err(Stop::Diagnostic(diagnostic.clone())),
        }
        Ok(if statement.flags.ends && !statement.flags.skip { Next::Ended } else { Next::On })
    }

    /// A subprogram ends without its return.
    pub(crate) fn no_return(&self, kind: CallKind) -> Stop {
        faults::no_return(&self.names, kind, self.dialect.flow.macros)
    }

    /// A subprogram of Siemens runs.
    fn called_by_name(&self) -> bool {
        matches!(self.frames.last().map(|frame| frame.kind), Some(CallKind::Program(_)))
    }

    /// The first subroutine that the main program defines.
    fn first_definition(&self) -> Option<std::ops::Range<u64>> {
        let main = &self.sources[0];
        let first = main.subroutines.values().min()?;
        main.statements.get(*first as usize).map(|statement| main.span(statement))
    }

    fn visit(&mut self, place: Place) -> Visit {
        let (word, bit) = (place.statement as usize / 64, 1_u64 << (place.statement % 64));
        let Some(slot) = self.visited.get_mut(place.file).and_then(|bits| bits.get_mut(word)) else {
            return Visit { place, again: true };
        };
        let again = *slot & bit != 0;
        *slot |= bit;
        Visit { place, again }
    }

    pub(crate) fn spend(&mut self, steps: u64) -> Result<(), Stop> {
        self.steps += steps;
        if self.steps > self.environment.limits.steps {
            return Err(faults::too_many_steps(self.environment.limits.steps));
        }
        Ok(())
    }

    fn bounded(&self) -> Result<(), Stop> {
        if self.out.bytes > self.most_bytes {
            return Err(faults::too_long(self.most_bytes));
        }
        Ok(())
    }

    pub(crate) fn from(&self, statement: &Statement, place: Place) -> From {
        From {
            file: u16::try_from(place.file).unwrap_or(u16::MAX),
            offset: statement.offset,
            length: u64::from(statement.length),
            line: statement.line,
            exact: true,
            contour: self.in_routine(),
            number: None,
            assigned: self.assigned,
        }
    }

    /// Modal facts that computing needs.
    pub(crate) fn note(&mut self, statement: &Statement) {
        self.started |= statement.flags.words;
        if let Some(inch) = statement.flags.inch {
            self.units(inch);
        }
        if let Some(cycle) = statement.flags.cycle {
            self.cycle = cycle;
        }
    }

    pub(crate) fn units(&mut self, inch: bool) {
        self.inch = inch;
        if self.dialect.flow.macros == Macros::LinuxCnc {
            for (name, holds) in [(&b"_imperial"[..], inch), (b"_metric", !inch)] {
                let id = self.names.id(name);
                self.store.learn(&self.names);
                self.store.set_named(id, Value::Number(f64::from(holds)));
            }
        }
    }

    /// A new line where the block does not follow the one before in its file.
    fn join(&mut self, place: Place) {
        let follows = self
            .previous
            .is_some_and(|previous| previous.file == place.file && previous.statement + 1 == place.statement);
        if !follows {
            self.out.fresh_line();
        }
        self.previous = Some(place);
    }

    /// The N word that a block loses, which is reached again or called: no number repeats.
    fn dropped_number(&self, statement: &Statement, visit: Visit) -> Option<Span> {
        statement.flags.number.filter(|_| visit.again || !self.frames.is_empty())
    }

    pub(crate) fn copy(&mut self, source: &Source<'a>, statement: &Statement, visit: Visit) {
        self.join(visit.place);
        let bytes = source.bytes(statement);
        let from = self.from(statement, visit.place);
        match self.dropped_number(statement, visit) {
            None if statement.flags.idle || statement.flags.starts => self.out.idle(bytes, from),
            None => self.out.text(bytes, from),
            Some(number) => {
                let rest = [&bytes[..number.start as usize], &bytes[number.end as usize..]].concat();
                self.out.write(&rest, From { number: value_of_number(bytes, number), ..from });
            }
        }
    }

    /// A block that prints stays where the control will have its variables as this program leaves them: untouched.
    fn print(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        variables: &[Option<Variable>],
        visit: Visit,
    ) {
        if self.are_untouched(variables) {
            return self.copy(source, statement, visit);
        }
        if visit.place.file == 0 {
            self.first_output.get_or_insert_with(|| source.span(statement));
        }
        if !visit.again {
            self.join(visit.place);
            let from = self.from(statement, visit.place);
            self.out.comment(source.bytes(statement).trim_ascii_end(), from);
        }
    }

    /// True where the flat program leaves variables as the control will have them.
    pub(crate) fn are_untouched(&self, variables: &[Option<Variable>]) -> bool {
        let untouched = |variable: &Variable| self.store.value(*variable) == Ok(Value::Unknown(*variable));
        variables.iter().all(|variable| variable.as_ref().is_some_and(untouched))
    }

    fn complex(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        complex: &Complex,
        visit: Visit,
    ) -> Result<(), Stop> {
        let place = visit.place;
        if let Some(Control::Call(call)) = &complex.control
            && self.is_left_alone(source, call, place)?
        {
            return self.leave_alone(source, statement, call, visit);
        }
        if statement.flags.skip && (complex.control.is_some() || !complex.assignments.is_empty()) {
            return Err(faults::block_delete());
        }
        let bytes = source.bytes(statement);
        let from = self.from(statement, place);
        let shown = bytes.trim_ascii_end();
        let shown = shown.strip_suffix(b";").unwrap_or(shown);
        if complex.has_words {
            let base: &[u8] = complex.residual.as_deref().unwrap_or(bytes);
            let number = self.dropped_number(statement, visit);
            let text = self.edited(statement, complex, base, complex.number.filter(|_| number.is_some()))?;
            let number = number.and_then(|number| value_of_number(bytes, number));
            self.join(place);
            self.out.comment(shown, from);
            self.out.write(&text, From { number, ..from });
        } else if !visit.again {
            self.join(place);
            self.out.comment(shown, from);
        }
        self.note(statement);
        let mut values = Vec::with_capacity(complex.assignments.len());
        for (target, value) in &complex.assignments {
            values.push((self.target(target)?, self.evaluate(value)?));
        }
        for (variable, value) in values {
            self.assign(variable, value, source, statement, place)?;
        }
        match &complex.control {
            None => Ok(()),
            Some(Control::IfThen(condition, assignments)) => {
                if !self.holds(condition)? {
                    return Ok(());
                }
                if let Some(command) = flow::commanded(bytes, self.dialect) {
                    self.join(place);
                    self.out.write(command, from);
                } else {
                    for (target, value) in assignments {
                        let (variable, value) = (self.target(target)?, self.evaluate(value)?);
                        self.assign(variable, value, source, statement, place)?;
                    }
                }
                Ok(())
            }
            Some(control) => self.control(source, statement, control, place),
        }
    }

    fn control(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        control: &Control,
        place: Place,
    ) -> Result<(), Stop> {
        match control {
            Control::Goto(label) => self.goto(source, statement.section, label),
            Control::IfGoto(condition, label) => {
                if self.holds(condition)? {
                    self.goto(source, statement.section, label)
                } else {
                    Ok(())
                }
            }
            Control::While { condition, end, .. } => {
                if let Some(condition) = condition
                    && !self.holds(condition)?
                {
                    self.at.statement = end + 1;
                }
                Ok(())
            }
            Control::EndWhile { start, .. } => {
                self.at.statement = *start;
                Ok(())
            }
            Control::Call(call) => self.call(source, statement, call, place),
            Control::Return { to } => self.return_by_number(source, statement, to.as_ref()),
            Control::O(o) => self.o_word(source, statement, o, place),
            Control::Jump { condition, to, direction } => {
                let goes = match condition {
                    Some(condition) => self.holds(condition)?,
                    None => true,
                };
                if goes { self.jump(source, place, *to, *direction) } else { Ok(()) }
            }
            Control::Section { from, to } => {
                let [first, last] =
                    [from, to].map(|name| self.labelled(source, place, *name, Direction::Either));
                let (first, last) = (first?, last?);
                if first > last || (first..=last).contains(&place.statement) {
                    return Err(faults::no_call(&both!(
                        "CALL BLOCK of blocks that do not end, or hold it",
                        "CALL BLOCK кадров, которые не кончаются или в которых он стоит сам"
                    )));
                }
                let (start, kind) = (Place { statement: first, ..place }, CallKind::Section(*from, last));
                self.enter(start, kind, 1, None, statement.section, place)
            }
            Control::For { variable, from, to, end } => {
                let (first, last) = (self.known(from)?, self.known(to)?);
                self.assign(*variable, Value::Number(first), source, statement, place)?;
                if first > last {
                    self.at.statement = end + 1;
                } else {
                    self.counts.retain(|(head, _)| *head != place.statement);
                    self.counts.push((place.statement, last));
                }
                Ok(())
            }
            Control::EndFor { start } => self.count(source, statement, *start, place),
            Control::IfThen(..) => Ok(()),
        }
    }

    /// ENDFOR: one more, and back while that is not above the last value.
    fn count(
        &mut self,
        source: &Source<'a>,
        statement: &Statement,
        start: u32,
        place: Place,
    ) -> Result<(), Stop> {
        let head = source.statements.get(start as usize).map(|statement| &statement.kind);
        let last = self.counts.iter().rev().find(|(head, _)| *head == start).map(|(_, last)| *last);
        let (Some(Kind::Complex(complex)), Some(last)) = (head, last) else {
            return Err(faults::no_call(&both!(
                "ENDFOR of a loop that was not entered by its FOR",
                "ENDFOR цикла, в который вошли не через его FOR"
            )));
        };
        let Some(Control::For { variable, .. }) = complex.control else { return Ok(()) };
        let next = self.known(&Expression::Variable(variable))? + 1.0;
        self.assign(variable, Value::Number(next), source, statement, place)?;
        if next <= last {
            self.at.statement = start + 1;
        }
        Ok(())
    }

    pub(crate) fn evaluate(&self, expression: &Expression) -> Result<Value, Stop> {
        Rules { flow: self.dialect.flow, round_decimals: None }
            .evaluate(expression, &self.store)
            .map_err(Stop::Fault)
    }

    /// A value that must be known; an empty variable counts as 0.
    pub(crate) fn known(&self, expression: &Expression) -> Result<f64, Stop> {
        match self.evaluate(expression)? {
            Value::Unknown(variable) => Err(Stop::Unknown(variable)),
            value => Ok(number(value)),
        }
    }

    pub(crate) fn holds(&self, condition: &Expression) -> Result<bool, Stop> {
        match self.evaluate(condition)? {
            Value::Unknown(variable) => Err(Stop::Unknown(variable)),
            value => {
                Rules { flow: self.dialect.flow, round_decimals: None }.truth(value).map_err(Stop::Fault)
            }
        }
    }

    /// The variable on the left of `=`.
    fn target(&self, target: &Expression) -> Result<Variable, Stop> {
        match target {
            Expression::Variable(variable) => Ok(*variable),
            Expression::Indirect(index) => {
                let value = self.known(index)?;
                Rules { flow: self.dialect.flow, round_decimals: None }.index(value).map_err(Stop::Fault)
            }
            _ => Err(Stop::Fault(crate::evaluate::Fault::NoVariable(0.0))),
        }
    }

    fn assign(
        &mut self,
        variable: Variable,
        value: Value,
        source: &Source<'a>,
        statement: &Statement,
        place: Place,
    ) -> Result<(), Stop> {
        if let (Variable::Named(id), Value::Number(v) | Value::Rounded(v)) = (variable, value)
            && self.names.is_whole(id)
            && v.fract() != 0.0
        {
            return Err(Stop::Fault(crate::evaluate::Fault::NotWhole(
                Text::pair("a variable of DEF INT", "переменная DEF INT"),
                v,
            )));
        }
        self.assigned = self.assigned.saturating_add(1);
        // A variable that does not exist is found out by reading it.
        self.store.value(variable).map_err(Stop::Fault)?;
        if let Variable::Named(id) = variable
            && self.names.bare
            && !self.names.is_declared(id)
        {
            self.store.kept = Some(variable);
        }
        self.store
            .set(variable, value)
            .map_err(|protected| faults::protected(protected, variable, &self.names))?;
        if let (Some(kept), None, 0) = (self.store.kept, &self.first_kept, place.file) {
            self.first_kept = Some((source.span(statement), kept));
        }
        Ok(())
    }

    /// The trailer of the file, and the result.
    fn finish(mut self) -> Result<Expanded<'a>, Refusal> {
        let main = Rc::clone(&self.sources[0]);
        let end = main.statements.len();
        let closing = main.statements.iter().rposition(|statement| matches!(statement.kind, Kind::Percent));
        for at in closing.unwrap_or(end)..end {
            let place = Place { file: 0, statement: at as u32 };
            if Some(at) == closing && self.visit(place).again && self.previous != Some(place) {
                break;
            }
            if self.previous != Some(place) {
                self.copy(&main, &main.statements[at], Visit { place, again: false });
            }
        }
        let mut warnings = Vec::new();
        if let Some((span, number)) = self.first_kept {
            warnings.push(faults::lost_assignment(span, &self.names.show(number)));
        }
        if let Some(span) = self.first_output {
            warnings.push(faults::lost_output(span));
        }
        warnings.extend(self.left_alone.iter().map(|(call, span)| faults::left_alone(span.clone(), call)));
        let files: Vec<_> = self.sources[1..].iter().map(|s| (s.name.clone(), s.text.to_vec())).collect();
        let Lowered { out, lowers, same } =
            self.out.end(main.text.len() as u64).map_err(|fault| Refusal::of(*fault, &files))?;
        // Where all of it is left alone it is no other program.
        Ok(match main.text {
            Cow::Borrowed(source) if same && !lowers => {
                Expanded { text: Cow::Borrowed(source), files, warnings, ..Expanded::default() }
            }
            _ => Expanded {
                text: Cow::Owned(out.text),
                files,
                segments: out.segments,
                flows: !same,
                lowers,
                warnings,
            },
        })
    }

    fn refusal(&self, stop: &Stop) -> Refusal {
        // `at` is one past the statement that stopped, unless the file was at its end.
        let place = self.previous_statement();
        let source = &self.sources[place.file];
        let span = source.statements.get(place.statement as usize).map_or(0..0, |s| source.span(s));
        let diagnostic = faults::diagnostic(stop, span, &self.names, self.dialect.flow.macros);
        let file = (place.file > 0).then(|| (source.name.clone(), source.text.to_vec()));
        match stop {
            Stop::InFile(diagnostic, name, text) => Refusal {
                diagnostics: vec![(**diagnostic).clone()],
                file: Some((name.clone(), text.clone())),
            },
            _ => Refusal { diagnostics: vec![diagnostic], file },
        }
    }

    fn previous_statement(&self) -> Place {
        Place { file: self.at.file, statement: self.at.statement.saturating_sub(1) }
    }

    /// Adds a file.
    pub(crate) fn add(&mut self, source: Source<'a>) -> usize {
        self.visited.push(vec![0; source.statements.len() / 64 + 1]);
        self.sources.push(Rc::new(source));
        self.store.learn(&self.names);
        self.sources.len() - 1
    }
}

/// The number of an N word.
fn value_of_number(bytes: &[u8], word: Span) -> Option<u32> {
    std::str::from_utf8(bytes.get(word.start as usize + 1..word.end as usize)?).ok()?.trim().parse().ok()
}
