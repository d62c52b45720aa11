//! Refusals of words of drawings.

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) const ROTATION_WITHOUT_CENTRE: Refusal = refusal!(const codes::SHORTHAND;
    "a rotation without its centre", "поворот без центра";
    "it turns about where the tool stands, which is not known: name both axes of the plane before it, in G90",
    "он идёт вокруг места, где стоит инструмент, а оно неизвестно: назовите до него обе оси плоскости при G90";
    "write the centre beside it", "напишите рядом центр"
);

/// A corner behind which no line stands.
pub(crate) const fn without_next_line(label: Text) -> Refusal {
    refusal!(const codes::SHORTHAND;
        "a corner without a next line", "сопряжение без следующей прямой";
        label; POST_IT
    )
}

/// A corner that cannot be written out.
pub(crate) const fn corner(label: Text) -> Refusal {
    refusal!(const codes::SHORTHAND;
        "a corner that cannot be written out", "сопряжение, которое нельзя развернуть";
        label; POST_IT
    )
}

const POST_IT: Text =
    Text::pair("post roundings as arcs and chamfers as lines", "выводите скругления дугами, а фаски прямыми");

/// Polar words that cannot be written out.
pub(crate) const fn polar(label: Text) -> Refusal {
    refusal!(const codes::SHORTHAND;
        "polar words that cannot be written out", "полярные слова, которые нельзя развернуть";
        label;
        "write the points in X and Y, G15 in force", "напишите точки в X и Y, при G15"
    )
}

/// A drawing's word of a lathe that cannot be written out.
pub(crate) const fn drawing(label: Text) -> Refusal {
    refusal!(const codes::SHORTHAND;
        "a drawing's word that cannot be written out", "слово чертежа, которое нельзя развернуть";
        label;
        "post roundings as arcs, chamfers and slopes as lines with X and Z",
        "выводите скругления дугами, фаски и уклоны прямыми с X и Z"
    )
}

pub(crate) const START_NOT_KNOWN: Refusal = drawing(Text::pair(
    "where the line starts is not known: name X and Z before it",
    "неизвестно, откуда начинается прямая: назовите до неё X и Z",
));

pub(crate) const DIAMETER_OR_RADIUS: Refusal = drawing(Text::pair(
    "whether X is a diameter or a radius is not said",
    "не сказано, диаметр X или радиус",
));
