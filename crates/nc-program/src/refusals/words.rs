//! Refusals of words.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn no_number(letter: char) -> Refusal {
    refusal!(codes::BAD_NUMBER;
        "{letter} has no number", "у {letter} нет числа";
        "a number was expected after it", "после буквы ожидалось число";
        "write the number, or remove the letter", "допишите число или уберите букву"
    )
}

pub(crate) const BLOCK_DELETE_IN_MIDDLE: Refusal = refusal!(const codes::BLOCK_DELETE;
    "block delete stands in the middle of a block", "знак пропуска стоит посреди кадра";
    "only the rest may be skipped", "пропустить можно было бы только остаток";
    "write the words after `/` in a block of their own that starts with `/`",
    "напишите слова после `/` отдельным кадром, который начинается с `/`"
);

pub(crate) fn corner_cannot_be_resolved(letter: char) -> Refusal {
    refusal!(codes::STRAY_ARC_WORD;
        "a corner by `,{letter}` cannot be resolved", "сопряжение `,{letter}` не развернуть";
        "its shape depends on the next block", "его форма зависит от следующего кадра";
        "post roundings as arcs and chamfers as lines", "выводите скругления дугами, а фаски прямыми"
    )
}

pub(crate) fn not_a_whole_number(code: &str, largest: u32, letter: char) -> Refusal {
    refusal!(codes::BAD_NUMBER;
        "{code} is not a whole number from 0 to {largest}", "{code} — не целое число от 0 до {largest}";
        "{letter} takes a whole number", "{letter} принимает целое число";
        "write a whole number without sign", "напишите целое число без знака"
    )
}

pub(crate) const BEHIND_WORDS_OF_BLOCK: Refusal = refusal!(const codes::CYCLE_WORDS;
    "behind the words of its block", "после слов своего кадра";
    "repeats the block so many times", "повторяет кадр столько раз";
    "write each repeat as a block of its own, and a block's number in front of its words",
    "напишите каждое повторение отдельным кадром, а номер кадра перед его словами"
);

pub(crate) fn stands_twice(letter: char, first: impl Display, code: &str) -> Refusal {
    refusal!(codes::LETTER_TWICE;
        "{letter} stands twice in this block: {first} and {code}",
        "{letter} стоит в этом кадре дважды: {first} и {code}";
        "{first} stands before it", "перед ним стоит {first}";
        "remove one of the two", "уберите одно из двух"
    )
}

pub(crate) fn not_in_table(code: &str, name: impl Display) -> Refusal {
    refusal!(codes::UNKNOWN_CODE;
        "{code} is not in the table of dialect {name}", "{code} нет в таблице диалекта {name}";
        "it may move an axis or the frame", "может двигать ось или сместить систему координат";
        "if it does neither, add a row for it to a copy of the grammar and pass that with `--dialect my.toml`",
        "если она не делает ни того, ни другого, добавьте для неё строку в копию таблицы диалекта и дайте её ключом `--dialect my.toml`"
    )
}

pub(crate) fn refused_by_table(code: impl Display, what: &Text) -> Refusal {
    refusal!(codes::REFUSED_CODE;
        "{code} is refused: {what}", "{code} не принимается: {what:#}";
        "what follows would run in another frame", "дальше всё шло бы в другой системе координат";
        "where it does nothing of the kind on this machine, write `harmless = [\"{code}\"]` under `[m_codes]` in the profile; where it switches tool centre point control, name it there under `[kinematics]`",
        "если на этом станке она ничего такого не делает, впишите `harmless = [\"{code}\"]` в раздел `[m_codes]` профиля; если она включает управление по вершине инструмента, назовите её там в разделе `[kinematics]`"
    )
}

pub(crate) fn known_only_while_running(what: &Text) -> Refusal {
    refusal!(codes::NOT_STATIC;
        "{what} is known only while the program runs",
        "{what:#} станет известно только при исполнении программы";
        "a plain number was expected", "ожидалось простое число";
        "post the program without variables and flow; values must be static",
        "выведите программу без переменных и переходов, с постоянными числами"
    )
}
