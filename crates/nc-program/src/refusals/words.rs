//! Refusals of words.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both};

use crate::codes;

pub(crate) fn no_number(letter: char) -> Refusal {
    Refusal {
        code: codes::BAD_NUMBER,
        message: both!("{letter} has no number", "у {letter} нет числа"),
        label: both!("a number was expected after it", "после буквы ожидалось число"),
        help: both!("write the number, or remove the letter", "допишите число или уберите букву"),
    }
}

pub(crate) const BLOCK_DELETE_IN_MIDDLE: Refusal = Refusal {
    code: codes::BLOCK_DELETE,
    message: Text::pair("block delete stands in the middle of a block", "знак пропуска стоит посреди кадра"),
    label: Text::pair("only the rest may be skipped", "пропустить можно было бы только остаток"),
    help: Text::pair(
        "write the words after `/` in a block of their own that starts with `/`",
        "напишите слова после `/` отдельным кадром, который начинается с `/`",
    ),
};

pub(crate) fn corner_cannot_be_resolved(letter: char) -> Refusal {
    Refusal {
        code: codes::STRAY_ARC_WORD,
        message: both!("a corner by `,{letter}` cannot be resolved", "сопряжение `,{letter}` не развернуть"),
        label: both!("its shape depends on the next block", "его форма зависит от следующего кадра"),
        help: both!(
            "post roundings as arcs and chamfers as lines",
            "выводите скругления дугами, а фаски прямыми"
        ),
    }
}

pub(crate) fn not_a_whole_number(code: &str, largest: u32, letter: char) -> Refusal {
    Refusal {
        code: codes::BAD_NUMBER,
        message: both!(
            "{code} is not a whole number from 0 to {largest}",
            "{code} — не целое число от 0 до {largest}"
        ),
        label: both!("{letter} takes a whole number", "{letter} принимает целое число"),
        help: both!("write a whole number without sign", "напишите целое число без знака"),
    }
}

pub(crate) const BEHIND_WORDS_OF_BLOCK: Refusal = Refusal {
    code: codes::CYCLE_WORDS,
    message: Text::pair("behind the words of its block", "после слов своего кадра"),
    label: Text::pair("repeats the block so many times", "повторяет кадр столько раз"),
    help: Text::pair(
        "write each repeat as a block of its own, and a block's number in front of its words",
        "напишите каждое повторение отдельным кадром, а номер кадра перед его словами",
    ),
};

pub(crate) fn stands_twice(letter: char, first: impl Display, code: &str) -> Refusal {
    Refusal {
        code: codes::LETTER_TWICE,
        message: both!(
            "{letter} stands twice in this block: {first} and {code}",
            "{letter} стоит в этом кадре дважды: {first} и {code}"
        ),
        label: both!("{first} stands before it", "перед ним стоит {first}"),
        help: both!("remove one of the two", "уберите одно из двух"),
    }
}

pub(crate) fn not_in_table(code: &str, name: impl Display) -> Refusal {
    Refusal {
        code: codes::UNKNOWN_CODE,
        message: both!(
            "{code} is not in the table of dialect {name}",
            "{code} нет в таблице диалекта {name}"
        ),
        label: both!("it may move an axis or the frame", "может двигать ось или сместить систему координат"),
        help: both!(
            "if it does neither, add a row for it to a copy of the grammar and pass that with `--dialect my.toml`",
            "если она не делает ни того, ни другого, добавьте для неё строку в копию таблицы диалекта и дайте её ключом `--dialect my.toml`"
        ),
    }
}

pub(crate) fn refused_by_table(code: impl Display, what: &Text) -> Refusal {
    Refusal {
        code: codes::REFUSED_CODE,
        message: both!("{code} is refused: {what}", "{code} не принимается: {what:#}"),
        label: both!(
            "what follows would run in another frame",
            "дальше всё шло бы в другой системе координат"
        ),
        help: both!(
            "where it does nothing of the kind on this machine, write `harmless = [\"{code}\"]` under `[m_codes]` in the profile; where it switches tool centre point control, name it there under `[kinematics]`",
            "если на этом станке она ничего такого не делает, впишите `harmless = [\"{code}\"]` в раздел `[m_codes]` профиля; если она включает управление по вершине инструмента, назовите её там в разделе `[kinematics]`"
        ),
    }
}

pub(crate) fn known_only_while_running(what: &Text) -> Refusal {
    Refusal {
        code: codes::NOT_STATIC,
        message: both!(
            "{what} is known only while the program runs",
            "{what:#} станет известно только при исполнении программы"
        ),
        label: both!("a plain number was expected", "ожидалось простое число"),
        help: both!(
            "post the program without variables and flow; values must be static",
            "выведите программу без переменных и переходов, с постоянными числами"
        ),
    }
}
