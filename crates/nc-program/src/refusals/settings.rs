//! Refusals of settings.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn both_take_the_words(code: &str, other: &str) -> Refusal {
    refusal!(codes::WORDS_OF_TWO;
        "{code} and {other} both take the words of this block",
        "слова этого кадра принимают и {code}, и {other}";
        "whose are the axis words?", "чьи это слова осей?";
        "write the two codes in two blocks", "напишите эти две функции двумя кадрами"
    )
}

pub(crate) const WHILE_FRAME_IN_FORCE: Refusal = refusal!(const codes::FRAME;
    "while a frame of the program is in force", "при действующей системе координат программы";
    "does it end the frame too?", "отменяет ли она и её?";
    "end the frame with TRANS alone before it",
    "отмените перед этим систему координат: TRANS отдельным кадром"
);

pub(crate) const WITHOUT_P: Refusal = refusal!(const codes::WORK_OFFSET;
    "without P", "без P";
    "which of the numbered work offsets?", "какое из нумерованных смещений нуля?";
    "write P1 for the first", "для первого напишите P1"
);

pub(crate) fn p_of_two_codes(code: &str) -> Refusal {
    refusal!(codes::WORDS_OF_TWO;
        "P beside {code} may belong to two codes", "P рядом с {code} может относиться к двум функциям";
        "a work offset's number, or another code's P?", "номер смещения нуля или P другой функции?";
        "write {code} and its P in a block of their own", "напишите {code} и её P отдельным кадром"
    )
}

pub(crate) fn p_without_meaning(code: &str) -> Refusal {
    refusal!(codes::FRAME;
        "P beside {code} has no meaning here", "P рядом с {code} здесь ничего не значит";
        "another work offset on some controls", "на некоторых стойках другое смещение нуля";
        "remove P, or write the numbered work offset in the form this control has",
        "уберите P или напишите нумерованное смещение нуля так, как принято на этой стойке"
    )
}

pub(crate) const NO_WORK_OFFSET_P0: Refusal = refusal!(const codes::WORK_OFFSET;
    "there is no work offset P0", "смещения нуля P0 нет";
    "they count from 1", "счёт идёт с 1";
    "write the number of the work offset", "напишите номер смещения нуля"
);

pub(crate) fn changes_under_transform(what: &Text, name: &Text) -> Refusal {
    refusal!(codes::FRAME;
        "the {what} changes under {name}", "{what:#} меняется, пока действует {name:#}";
        "controls differ in what the centre means then", "что тогда значит центр, у стоек по-разному";
        "cancel the rotation, scaling or mirror before, and write it again afterwards",
        "отмените до этого поворот, масштабирование или зеркальное отображение, а после напишите снова"
    )
}

pub(crate) fn changes_during_cycle(what: &Text) -> Refusal {
    refusal!(codes::CYCLE_WORDS;
        "the {what} changes while a drilling cycle is in force", "{what:#} меняется во время цикла сверления";
        "a cycle is running here", "здесь действует цикл";
        "cancel the cycle with G80 before, and write it again with R and Z afterwards",
        "отмените цикл до этого функцией G80, а после напишите его снова, с R и Z"
    )
}

pub(crate) fn work_offset_not_given(name: impl Display) -> Refusal {
    refusal!(codes::WORK_OFFSET;
        "work offset {name} is not given", "смещение нуля {name} не задано";
        "given by no profile, file or option", "его нет ни в профиле, ни в файлах, ни в ключах";
        "`--work-offset {name}=X,Y,Z` with the machine coordinates of the program's zero, or `{name} = [X, Y, Z]` under `[work_offsets_mm]` in the profile",
        "`--work-offset {name}=X,Y,Z` с координатами станка, где лежит нуль программы, или `{name} = [X, Y, Z]` в разделе `[work_offsets_mm]` профиля"
    )
}
