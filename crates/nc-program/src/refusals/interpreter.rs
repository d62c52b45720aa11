//! Refusals of files as a whole.

use diagnostic::{Refusal, Text};

use crate::codes;

pub(crate) const TWO_PERCENT_SIGNS: Refusal = Refusal {
    code: codes::AFTER_END,
    message: Text::pair("two `%` stand in front of the program", "перед программой два знака `%`"),
    label: Text::pair(
        "the second `%` closes what the first opens, so this may be behind the end",
        "второй `%` закрывает то, что открыл первый, так что это может быть уже за концом",
    ),
    help: Text::pair("delete one of the two `%`", "удалите один из двух `%`"),
};
