//! Refusals of files as a whole.

use diagnostic::{Refusal, refusal};

use crate::codes;

pub(crate) const TWO_PERCENT_SIGNS: Refusal = refusal!(const codes::AFTER_END;
    "two `%` stand in front of the program", "перед программой два знака `%`";
    "the second `%` closes what the first opens, so this may be behind the end",
    "второй `%` закрывает то, что открыл первый, так что это может быть уже за концом";
    "delete one of the two `%`", "удалите один из двух `%`"
);
