//! Refusals of calls.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both};

use crate::codes;

/// Things beside each other in one block that belong into two.
const fn beside(message: Text, label: Text) -> Refusal {
    Refusal {
        code: codes::COMBINATION,
        message,
        label,
        help: Text::pair("write them in two blocks", "напишите их двумя кадрами"),
    }
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

pub(crate) const RETURN_WITH_COUNT: Refusal = Refusal {
    code: codes::COMBINATION,
    message: Text::pair(
        "M99 with L changes the count of its call",
        "M99 с L меняет число повторений своего вызова",
    ),
    label: WHOSE,
    help: Text::pair("write M99 without L", "напишите M99 без L"),
};

pub(crate) const CALL_WITHOUT_PROGRAM: Refusal = Refusal {
    code: codes::SYNTAX,
    message: Text::pair("a call without P: which program?", "вызов без P: какая программа?"),
    label: Text::pair("a P word was expected", "ожидалось слово P"),
    help: Text::pair(
        "write the number of the program (of the block behind M97), as in `M98 P1000`",
        "напишите номер программы (после M97 — номер кадра), например `M98 P1000`",
    ),
};

pub(crate) fn program_or_count(program: impl Display, times: impl Display, number: impl Display) -> Refusal {
    Refusal {
        code: codes::COMBINATION,
        message: both!(
            "P{program} is a program of this file, and {times} times O{number:04}",
            "P{program} — программа этого файла, но и O{number:04}, повторённая {times} раз"
        ),
        label: both!("controls differ", "у стоек по-разному"),
        help: both!("write the count as an L word", "напишите число повторений словом L"),
    }
}

pub(crate) fn g65_with_count(passes: impl Display) -> Refusal {
    Refusal {
        code: codes::ARGUMENT,
        message: both!(
            "G65 with L{passes}: whether the second pass starts with the arguments or with what the first left is not told",
            "G65 с L{passes}: начинается ли второй проход с аргументов или с того, что оставил первый, не сказано"
        ),
        label: both!("repeated with its own variables", "повторяется со своими переменными"),
        help: both!(
            "write the call as often as it shall run",
            "напишите вызов столько раз, сколько он должен исполниться"
        ),
    }
}

pub(crate) const COMPUTED_ARGUMENT: Refusal = Refusal {
    code: codes::ARGUMENT,
    message: Text::pair(
        "an argument of a program that the control has is computed by this one",
        "аргумент программы, которая есть только в стойке, вычисляет эта программа",
    ),
    label: Text::pair("the expanded program sets no variables", "развёрнутая программа переменных не задаёт"),
    help: Text::pair(
        "write the number, or give the called program's file with `--include DIR`",
        "напишите число или дайте файл вызываемой программы ключом `--include DIR`",
    ),
};

pub(crate) fn no_argument(letter: char) -> Refusal {
    Refusal {
        code: codes::ARGUMENT,
        message: both!("{letter} is no argument of a macro", "{letter} — не аргумент макроса"),
        label: both!("G, L, N, O and P are the call's own", "G, L, N, O и P принадлежат самому вызову"),
        help: both!("pass the value with another letter", "передайте значение другой буквой"),
    }
}

pub(crate) const TOO_MANY_GROUPS_OF_ARGUMENTS: Refusal = Refusal {
    code: codes::ARGUMENT,
    message: Text::pair("more than ten groups of I, J and K", "больше десяти групп I, J и K"),
    label: Text::pair("too many", "слишком много"),
    help: Text::pair("pass fewer arguments", "передайте меньше аргументов"),
};

pub(crate) fn argument_without_point(letter: char, number: impl Display) -> Refusal {
    Refusal {
        code: codes::ARGUMENT,
        message: both!(
            "argument {letter}{number} has no point: parameters of the control say what it counts",
            "у аргумента {letter}{number} нет точки: что он считает, решают параметры стойки"
        ),
        label: both!("0.001, 0.01 or 1?", "0.001, 0.01 или 1?"),
        help: both!("write `{letter}{number}.`", "напишите `{letter}{number}.`"),
    }
}

pub(crate) fn stands_twice(written: impl Display) -> Refusal {
    Refusal {
        code: codes::PROGRAM_MISSING,
        message: both!("{written} stands twice in one file", "{written} стоит в файле дважды"),
        label: both!("which of the two is called?", "какая из двух вызвана?"),
        help: both!("give one of them another number", "дайте одной из них другой номер"),
    }
}

pub(crate) fn file_holds(name: impl Display, written: impl Display) -> Refusal {
    Refusal {
        code: codes::PROGRAM_MISSING,
        message: both!("file {name} holds no {written}", "в файле {name} нет {written}"),
        label: both!("called here", "вызвана здесь"),
        help: both!("correct the O number in that file", "исправьте номер O в том файле"),
    }
}

pub(crate) fn unreadable_file(name: impl Display, of_system: &Text) -> Refusal {
    Refusal {
        code: codes::UNREADABLE_FILE,
        message: both!(
            "subprogram file {name} cannot be read: {of_system}",
            "файл подпрограммы {name} не читается: {of_system:#}"
        ),
        label: both!("called here", "вызвана здесь"),
        help: both!(
            "check the file in the folder given with `--include`",
            "проверьте файл в папке, заданной ключом `--include`"
        ),
    }
}

pub(crate) fn no_such_file(what: impl Display, looked: impl Display) -> Refusal {
    Refusal {
        code: codes::PROGRAM_MISSING,
        message: both!(
            "subprogram {what} is not in this file, and no file {looked} was found",
            "подпрограммы {what} нет в этом файле, и файл {looked} не найден"
        ),
        label: both!("called here", "вызвана здесь"),
        help: both!(
            "`--include DIR` with the folder that holds it",
            "`--include DIR` с папкой, где она лежит"
        ),
    }
}

pub(crate) fn file_without_its_sub(name: impl Display) -> Refusal {
    Refusal {
        code: codes::PROGRAM_MISSING,
        message: both!("file {name}.ngc holds no o<{name}> sub", "в файле {name}.ngc нет o<{name}> sub"),
        label: both!("called here", "вызвана здесь"),
        help: both!(
            "the subroutine must have the name of its file",
            "имя подпрограммы должно совпадать с именем файла"
        ),
    }
}

pub(crate) const FLOW_WITHIN_CONTOUR: Refusal = Refusal {
    code: codes::CONTOUR,
    message: Text::pair(
        "a call, a return or a cycle within the contour of a cycle",
        "вызов, возврат или цикл внутри контура цикла",
    ),
    label: Text::pair("the interpreter only reads the contour", "контур интерпретатор только читает"),
    help: Text::pair(
        "write the blocks of the contour themselves between `sub` and `endsub`",
        "напишите между `sub` и `endsub` сами кадры контура",
    ),
};

pub(crate) fn words_beside_call(program: impl Display) -> Refusal {
    Refusal {
        code: codes::COMBINATION,
        message: both!(
            "words beside the number of {program}, which is called",
            "слова рядом с номером {program}, которую вызывают"
        ),
        label: both!("called here", "вызвана здесь"),
        help: both!(
            "write {program} in a block of its own, and the words behind it in the next",
            "напишите {program} отдельным кадром, а слова после неё — следующим"
        ),
    }
}

pub(crate) fn name_leads_out_of_folder(name: impl Display) -> Refusal {
    Refusal {
        code: codes::PATH,
        message: both!(
            "subprogram {name} leads out of the folder it is looked for in",
            "имя подпрограммы {name} выводит из папки, где её ищут"
        ),
        label: both!("called here", "вызвана здесь"),
        help: both!(
            "name the file only, and give its folder with `--include DIR`",
            "назовите только файл, а его папку задайте ключом `--include DIR`"
        ),
    }
}

pub(crate) const ABORT: Refusal = Refusal {
    code: codes::ALARM,
    message: Text::pair("the program stops itself here", "программа здесь сама останавливается"),
    label: Text::pair("reached with the values given", "при заданных значениях исполнение доходит сюда"),
    help: Text::pair(
        "give other values with `--set`, or remove the line",
        "задайте ключом `--set` другие значения или уберите строку",
    ),
};
