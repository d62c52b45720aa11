//! Refusals of calls.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

/// Things beside each other in one block that belong into two.
const fn beside(message: Text, label: Text) -> Refusal {
    refusal!(const codes::COMBINATION; message; label;
        "write them in two blocks", "напишите их двумя кадрами"
    )
}

const WHOSE: Text = Text::pair("whose are the words?", "чьи это слова?");
const FIRST: Text = Text::pair("which comes first?", "что из них первое?");

pub(crate) const CALL_BESIDE_FLOW: Refusal =
    beside(Text::pair("a call stands beside flow", "вызов стоит рядом с переходом"), WHOSE);
pub(crate) const CALL_BESIDE_CODE: Refusal = beside(
    Text::pair("a subprogram is called beside another code", "подпрограмма вызвана рядом с другой функцией"),
    WHOSE,
);
pub(crate) const CALL_BESIDE_WORDS: Refusal = beside(
    Text::pair("a subprogram is called beside other words", "подпрограмма вызвана рядом с другими словами"),
    WHOSE,
);
pub(crate) const MACRO_BESIDE_CODE: Refusal = beside(
    Text::pair("a macro is called beside another code", "макрос вызван рядом с другой функцией"),
    WHOSE,
);
pub(crate) const WORDS_BESIDE_CALL: Refusal =
    beside(Text::pair("words beside the call of a subprogram", "слова рядом с вызовом подпрограммы"), FIRST);
pub(crate) const WORDS_BESIDE_ASSIGNMENT: Refusal = beside(
    Text::pair("an assignment and words stand in one block", "в одном кадре присваивание и слова"),
    FIRST,
);

pub(crate) const RETURN_WITH_COUNT: Refusal = refusal!(const codes::COMBINATION;
    "M99 with L changes the count of its call", "M99 с L меняет число повторений своего вызова";
    WHOSE;
    "write M99 without L", "напишите M99 без L"
);

pub(crate) const CALL_WITHOUT_PROGRAM: Refusal = refusal!(const codes::SYNTAX;
    "a call without P: which program?", "вызов без P: какая программа?";
    "a P word was expected", "ожидалось слово P";
    "write the number of the program (of the block behind M97), as in `M98 P1000`",
    "напишите номер программы (после M97 — номер кадра), например `M98 P1000`"
);

pub(crate) fn program_or_count(program: impl Display, times: impl Display, number: impl Display) -> Refusal {
    refusal!(codes::COMBINATION;
        "P{program} is a program of this file, and {times} times O{number:04}",
        "P{program} — программа этого файла, но и O{number:04}, повторённая {times} раз";
        "controls differ", "у стоек по-разному";
        "write the count as an L word", "напишите число повторений словом L"
    )
}

pub(crate) fn g65_with_count(passes: impl Display) -> Refusal {
    refusal!(codes::ARGUMENT;
        "G65 with L{passes}: whether the second pass starts with the arguments or with what the first left is not told",
        "G65 с L{passes}: начинается ли второй проход с аргументов или с того, что оставил первый, не сказано";
        "repeated with its own variables", "повторяется со своими переменными";
        "write the call as often as it shall run", "напишите вызов столько раз, сколько он должен исполниться"
    )
}

pub(crate) const COMPUTED_ARGUMENT: Refusal = refusal!(const codes::ARGUMENT;
    "an argument of a program that the control has is computed by this one",
    "аргумент программы, которая есть только в стойке, вычисляет эта программа";
    "the expanded program sets no variables", "развёрнутая программа переменных не задаёт";
    "write the number, or give the called program's file with `--include DIR`",
    "напишите число или дайте файл вызываемой программы ключом `--include DIR`"
);

pub(crate) fn no_argument(letter: char) -> Refusal {
    refusal!(codes::ARGUMENT;
        "{letter} is no argument of a macro", "{letter} — не аргумент макроса";
        "G, L, N, O and P are the call's own", "G, L, N, O и P принадлежат самому вызову";
        "pass the value with another letter", "передайте значение другой буквой"
    )
}

pub(crate) const TOO_MANY_GROUPS_OF_ARGUMENTS: Refusal = refusal!(const codes::ARGUMENT;
    "more than ten groups of I, J and K", "больше десяти групп I, J и K";
    "too many", "слишком много";
    "pass fewer arguments", "передайте меньше аргументов"
);

pub(crate) fn argument_without_point(letter: char, number: impl Display) -> Refusal {
    refusal!(codes::ARGUMENT;
        "argument {letter}{number} has no point: parameters of the control say what it counts",
        "у аргумента {letter}{number} нет точки: что он считает, решают параметры стойки";
        "0.001, 0.01 or 1?", "0.001, 0.01 или 1?";
        "write `{letter}{number}.`", "напишите `{letter}{number}.`"
    )
}

pub(crate) fn stands_twice(written: impl Display) -> Refusal {
    refusal!(codes::PROGRAM_MISSING;
        "{written} stands twice in one file", "{written} стоит в файле дважды";
        "which of the two is called?", "какая из двух вызвана?";
        "give one of them another number", "дайте одной из них другой номер"
    )
}

pub(crate) fn file_holds(name: impl Display, written: impl Display) -> Refusal {
    refusal!(codes::PROGRAM_MISSING;
        "file {name} holds no {written}", "в файле {name} нет {written}";
        "called here", "вызвана здесь";
        "correct the O number in that file", "исправьте номер O в том файле"
    )
}

pub(crate) fn unreadable_file(name: impl Display, of_system: &Text) -> Refusal {
    refusal!(codes::UNREADABLE_FILE;
        "subprogram file {name} cannot be read: {of_system}",
        "файл подпрограммы {name} не читается: {of_system:#}";
        "called here", "вызвана здесь";
        "check the file in the folder given with `--include`",
        "проверьте файл в папке, заданной ключом `--include`"
    )
}

pub(crate) fn no_such_file(what: impl Display, looked: impl Display) -> Refusal {
    refusal!(codes::PROGRAM_MISSING;
        "subprogram {what} is not in this file, and no file {looked} was found",
        "подпрограммы {what} нет в этом файле, и файл {looked} не найден";
        "called here", "вызвана здесь";
        "`--include DIR` with the folder that holds it", "`--include DIR` с папкой, где она лежит"
    )
}

pub(crate) fn file_without_its_sub(name: impl Display) -> Refusal {
    refusal!(codes::PROGRAM_MISSING;
        "file {name}.ngc holds no o<{name}> sub", "в файле {name}.ngc нет o<{name}> sub";
        "called here", "вызвана здесь";
        "the subroutine must have the name of its file", "имя подпрограммы должно совпадать с именем файла"
    )
}

pub(crate) const FLOW_WITHIN_CONTOUR: Refusal = refusal!(const codes::CONTOUR;
    "a call, a return or a cycle within the contour of a cycle",
    "вызов, возврат или цикл внутри контура цикла";
    "the interpreter only reads the contour", "контур интерпретатор только читает";
    "write the blocks of the contour themselves between `sub` and `endsub`",
    "напишите между `sub` и `endsub` сами кадры контура"
);

pub(crate) fn words_beside_call(program: impl Display) -> Refusal {
    refusal!(codes::COMBINATION;
        "words beside the number of {program}, which is called",
        "слова рядом с номером {program}, которую вызывают";
        "called here", "вызвана здесь";
        "write {program} in a block of its own, and the words behind it in the next",
        "напишите {program} отдельным кадром, а слова после неё — следующим"
    )
}

pub(crate) fn name_leads_out_of_folder(name: impl Display) -> Refusal {
    refusal!(codes::PATH;
        "subprogram {name} leads out of the folder it is looked for in",
        "имя подпрограммы {name} выводит из папки, где её ищут";
        "called here", "вызвана здесь";
        "name the file only, and give its folder with `--include DIR`",
        "назовите только файл, а его папку задайте ключом `--include DIR`"
    )
}

pub(crate) const ABORT: Refusal = refusal!(const codes::ALARM;
    "the program stops itself here", "программа здесь сама останавливается";
    "reached with the values given", "при заданных значениях исполнение доходит сюда";
    "give other values with `--set`, or remove the line",
    "задайте ключом `--set` другие значения или уберите строку"
);
