//! Refusals of what is open behind a block delete.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn either_is_in_force(line: impl Display, with: &Text, without: &Text) -> Refusal {
    refusal!(codes::BLOCK_DELETE;
        "after line {line} either {with} or {without} is in force, depending on the block delete switch",
        "после строки {line} состояние зависит от переключателя пропуска кадров: {with:#} или {without:#}";
        "{with} where the blocks with `/` are executed, {without} where they are skipped",
        "{with:#}, если кадры с `/` исполнены, {without:#}, если пропущены";
        "write the code in a block without `/`, or take it back in a block with `/`, so that both ways lead to one state",
        "напишите функцию в кадре без `/` или отмените её в кадре с `/`, чтобы оба случая вели к одному состоянию"
    )
}
