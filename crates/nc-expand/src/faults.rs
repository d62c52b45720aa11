//! What to say when a program cannot be expanded.

use std::ops::Range;

use diagnostic::{Diagnostic, Refusal, Text, both, refusal};
use nc_syntax::Macros;

use crate::call_stack::CallKind;
use crate::codes;
use crate::evaluate::Fault;
use crate::value::{Names, Variable};
use crate::variables::Protected;

/// Why execution ends.
#[derive(Clone, Debug)]
pub(crate) enum Stop {
    /// A value known on the machine only is needed.
    Unknown(Variable),
    /// There is no value.
    Fault(Fault),
    /// At the statement.
    Said(Box<Refusal>),
    /// Ready, with its place.
    Diagnostic(Box<Diagnostic>),
    /// Ready, about another file that could not be read in.
    InFile(Box<Diagnostic>, String, Vec<u8>),
}

/// A stop in words.
pub(crate) fn say(refusal: Refusal) -> Stop {
    Stop::Said(Box::new(refusal))
}

/// The message, at the statement where execution ended.
pub(crate) fn diagnostic(stop: &Stop, span: Range<u64>, names: &Names, macros: Macros) -> Diagnostic {
    match stop {
        Stop::Diagnostic(diagnostic) | Stop::InFile(diagnostic, ..) => (**diagnostic).clone(),
        Stop::Said(refusal) => (**refusal).clone().at(span),
        Stop::Unknown(variable) => unknown(*variable, span, names, macros),
        Stop::Fault(fault) => arithmetic(fault, span),
    }
}

fn unknown(variable: Variable, span: Range<u64>, names: &Names, macros: Macros) -> Diagnostic {
    let shown = names.show(variable);
    let system = match (variable, macros) {
        (Variable::Numbered(number), Macros::Fanuc) => number >= 1000,
        (Variable::Numbered(number), _) => number > 5000,
        (Variable::Named(_), _) => false,
    };
    let local = match variable {
        Variable::Named(id) if macros == Macros::Siemens => names.is_declared(id),
        Variable::Named(id) => !names.is_global(id),
        Variable::Numbered(_) => false,
    };
    let why = if local {
        both!("it is read before anything sets it", "переменную читают раньше, чем ей что-то присвоено")
    } else if system {
        both!("the control sets it while the program runs", "переменную задаёт стойка во время исполнения")
    } else {
        both!(
            "nothing in this program sets it before, and an earlier program may have",
            "эта программа до этого места переменной ничего не присваивает, а прежняя могла"
        )
    };
    refusal!(codes::UNKNOWN_VALUE;
        "{shown} is known on the machine only: {why}", "значение {shown} известно только на станке: {why:#}";
        "needs the value of {shown}", "нужно значение {shown}";
        "`--set \"{shown}=12.5\"` with the value that it has there",
        "`--set \"{shown}=12.5\"` с тем значением, какое у неё на станке"
    )
    .at(span)
}

fn arithmetic(fault: &Fault, span: Range<u64>) -> Diagnostic {
    match fault {
        Fault::Arithmetic(what) => refusal!(codes::ARITHMETIC;
            "{what}: this has no result", "{what:#}: результата нет";
            "computed here", "вычисляется здесь";
            "correct the expression, or the values given with `--set`",
            "исправьте выражение или значения, заданные ключом `--set`"
        )
        .at(span),
        Fault::TooClose(a, b) => refusal!(codes::TOO_CLOSE;
            "{a} and {b} differ by rounding only: the control's own rounding decides",
            "{a} и {b} различаются только округлением: решит округление самой стойки";
            "decided here", "решается здесь";
            "compare with a margin, as in `IF[ABS[#1-#2]LT0.0005]`, or count turns with whole numbers",
            "сравнивайте с запасом, например `IF[ABS[#1-#2]LT0.0005]`, или считайте проходы целыми числами"
        )
        .at(span),
        Fault::NotWhole(what, value) => refusal!(codes::BAD_VALUE;
            "{what}: {value} is not a whole number", "{what:#}: {value} — не целое число";
            "a whole number was expected", "ожидалось целое число";
            "round it where it is computed, as in `ROUND[#1]`",
            "округлите его там, где оно вычисляется, например `ROUND[#1]`"
        )
        .at(span),
        Fault::NoVariable(number) => refusal!(codes::BAD_VALUE;
            "the control has no variable #{number}", "переменной #{number} у стойки нет";
            "computed here", "вычисляется здесь";
            "correct the number of the variable", "исправьте номер переменной"
        )
        .at(span),
    }
}

/// A whole number that is not negative.
pub(crate) fn whole(what: &Text, value: f64) -> Result<u64, Stop> {
    let rounded = value.round();
    if (value - rounded).abs() > 1e-4 || !(0.0..=9e15).contains(&rounded) {
        return Err(Stop::Fault(Fault::NotWhole(what.clone(), value)));
    }
    Ok(rounded as u64)
}

pub(crate) fn too_many_steps(limit: u64) -> Stop {
    say(refusal!(codes::STEPS;
        "the program is still running after {limit} repeated steps",
        "после {limit} повторных шагов программа всё ещё не кончилась";
        "reached once more", "сюда попали ещё раз";
        "a loop that never ends? correct its condition, or split the program",
        "цикл без конца? исправьте его условие или разделите программу"
    ))
}

pub(crate) fn too_long(limit: u64) -> Stop {
    say(refusal!(codes::SIZE;
        "the expanded program is longer than {limit} bytes", "развёрнутая программа длиннее {limit} байт";
        "grows here", "растёт здесь";
        "calls or loops that multiply? correct the counts, or split the program",
        "вызовы или циклы умножают друг друга? исправьте числа повторений или разделите программу"
    ))
}

pub(crate) fn too_deep(limit: usize) -> Stop {
    say(refusal!(codes::DEPTH;
        "calls inside one another: more than {limit}", "вложенных вызовов больше {limit}";
        "one call too many", "лишний вызов";
        "a program that calls itself without end? controls refuse it too",
        "программа без конца вызывает себя? стойки этого тоже не примут"
    ))
}

/// * `what` – block number or label, as it is corrected
pub(crate) fn label(shown: &str, what: &Text, why: &Text) -> Stop {
    say(refusal!(codes::LABEL;
        "{shown} cannot be gone to: {why}", "к {shown} не перейти: {why:#}";
        "leads there", "ведёт туда";
        "correct the {what}", "исправьте {what:#}"
    ))
}

pub(crate) fn endless() -> Stop {
    say(refusal!(codes::RETURN;
        "M99 in the main program: it starts again without end",
        "M99 в главной программе: она начинается снова без конца";
        "no call to return from", "возвращаться не из чего";
        "end the program with M30; correct it once and repeat it on the control",
        "закончите программу функцией M30; исправьте её один раз, а повторяйте на стойке"
    ))
}

pub(crate) fn no_call(what: &Text) -> Stop {
    say(refusal!(codes::RETURN;
        "{what}: there is no call to return from", "{what:#}: возвращаться не из чего";
        "reached here", "сюда дошло исполнение";
        "`sub`, `endsub` and `return` belong together, and M98 and M99",
        "`sub`, `endsub` и `return` стоят вместе, как и M98 с M99"
    ))
}

pub(crate) fn no_return(names: &Names, kind: CallKind, macros: Macros) -> Stop {
    let (name, way) = match kind {
        CallKind::Number(program) if macros == Macros::Okuma => (program.written(names), "RTS"),
        CallKind::Number(program) => (program.written(names), "M99"),
        CallKind::Block(number) => (format!("N{number}"), "M99"),
        CallKind::Section(id, _) => (names.name(id).to_ascii_uppercase(), "its last label"),
        CallKind::Program(id) => (names.name(id).to_ascii_uppercase(), "M17"),
        CallKind::Name(id) | CallKind::Routine(id) => (format!("o<{}>", names.name(id)), "`endsub`"),
    };
    say(refusal!(codes::RETURN;
        "subprogram {name} ends without {way}", "подпрограмма {name} кончается без {way}";
        "the end of it", "её конец";
        "end the subprogram with {way}", "закончите подпрограмму: {way}"
    ))
}

pub(crate) fn runs_into(program: &str) -> Stop {
    say(refusal!(codes::RETURN;
        "the main program runs into {program}", "главная программа переходит в {program}";
        "reached without a call", "дошло без вызова";
        "end the main program with M30 before it", "закончите перед ней главную программу функцией M30"
    ))
}

pub(crate) fn nothing_executed(span: Range<u64>) -> Diagnostic {
    refusal!(codes::NOTHING_EXECUTED;
        "the file defines subroutines and executes nothing", "в файле подпрограммы, и ничего не исполняется";
        "defined here, called nowhere", "определена здесь, не вызвана нигде";
        "correct the program that calls it, with `--include DIR` naming this file's folder: the moves depend on the call",
        "исправляйте программу, которая её вызывает, назвав папку этого файла: `--include DIR`; движения зависят от вызова"
    ).at(span)
}

pub(crate) fn block_delete() -> Stop {
    say(refusal!(codes::BLOCK_DELETE;
        "flow behind block delete: the switch on the panel makes two programs of it",
        "ветвление в кадре с пропуском: переключатель на пульте делает из программы две";
        "executed or not?", "исполнять или нет?";
        "remove the `/`, or the statement, and correct the program you mean to run",
        "уберите `/` или оператор и исправляйте ту программу, которую будете исполнять"
    ))
}

pub(crate) fn no_code(letter: char, value: f64) -> Stop {
    say(refusal!(codes::BAD_VALUE;
        "{letter} with the computed value {value} is not taken",
        "{letter} с вычисленным значением {value} не принимается";
        "computed here", "вычисляется здесь";
        "write the code or the count as a plain number", "напишите функцию или счётчик простым числом"
    ))
}

pub(crate) fn too_large(letter: char, value: f64) -> Stop {
    say(refusal!(codes::BAD_VALUE;
        "{letter} with the computed value {value} has more than 15 digits",
        "у {letter} с вычисленным значением {value} больше 15 цифр";
        "computed here", "вычисляется здесь";
        "correct the expression, or the values given with `--set`",
        "исправьте выражение или значения, заданные ключом `--set`"
    ))
}

pub(crate) fn protected(protected: Protected, variable: Variable, names: &Names) -> Stop {
    let shown = names.show(variable);
    match protected {
        Protected::Alarm => say(refusal!(codes::ALARM;
            "the program stops itself with an alarm here",
            "программа здесь сама выдаёт аварийное сообщение и останавливается";
            "reached with the values given", "при заданных значениях исполнение доходит сюда";
            "give the values the program expects with `--set`, or remove the line",
            "задайте ключом `--set` те значения, которых ждёт программа, или уберите строку"
        )),
        Protected::System => say(refusal!(codes::SYSTEM_WRITE;
            "the program writes {shown}, which the control acts on",
            "программа записывает {shown}, а стойка по ней действует";
            "an offset, a position or a switch", "коррекция, положение или переключатель";
            "set it on the control, and remove the line", "задайте её на стойке и уберите строку"
        )),
        Protected::None => say(refusal!(codes::SYSTEM_WRITE;
            "{shown} cannot be written", "{shown} записать нельзя";
            "no such variable", "такой переменной нет";
            "correct the number of the variable", "исправьте номер переменной"
        )),
    }
}

pub(crate) fn lost_assignment(span: Range<u64>, shown: &str) -> Diagnostic {
    Diagnostic::warning(
        codes::LOST_ASSIGNMENT,
        both!(
            "{shown} keeps its value after the program, and the expanded program does not write it",
            "{shown} сохраняет своё значение после программы, а развёрнутая программа его не записывает"
        ),
    )
    .at(span, both!("the first such variable", "первая такая переменная"))
    .help(both!(
        "if another program or the operator reads it, set it on the control",
        "если её читает другая программа или оператор, задайте её на стойке"
    ))
}

pub(crate) fn lost_output(span: Range<u64>) -> Diagnostic {
    Diagnostic::warning(
        codes::LOST_OUTPUT,
        both!(
            "what the program prints is left out of the expanded program",
            "вывод программы на печать в развёрнутую программу не входит"
        ),
    )
    .at(span, both!("the first such block", "первый такой кадр"))
    .help(both!(
        "nothing moves by it; the text is kept as a comment",
        "движения он не вызывает; текст сохранён комментарием"
    ))
}

/// * `call` – `G65 P9810`
pub(crate) fn left_alone(span: Range<u64>, call: &str) -> Diagnostic {
    Diagnostic::doubt(
        codes::LEFT_ALONE,
        both!(
            "{call} is in no file and stays as it is: places among its words are not corrected, and where it leaves the axes is not known",
            "{call} нет ни в одном файле, вызов остаётся как есть: места в его словах не исправлены, а где он оставит оси, неизвестно"
        ),
    )
    .at(
        span,
        both!(
            "work offsets, tool lengths, G90, plane and unit behind it are taken for those before it",
            "смещения нуля, длины, G90, плоскость и единица после него считаются прежними"
        ),
    )
    .help(both!(
        "say what it moves under `[calls]` in the profile: `\"{call}\" = {{ unknown = \"Z\" }}`, or `= \"harmless\"`; or give its file with `--include DIR`",
        "скажите в разделе `[calls]` профиля, что он двигает: `\"{call}\" = {{ unknown = \"Z\" }}` или `= \"harmless\"`, либо дайте его файл ключом `--include DIR`"
    ))
}
