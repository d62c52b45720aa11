//! Refusals of curves.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) const P_OR_Q_IN_QUADRATIC_CURVE: Refusal = refusal!(const codes::CURVE;
    "P or Q in a quadratic curve", "P или Q в квадратичной кривой";
    "it has one control point, I and J", "контрольная точка у неё одна, I и J";
    "write G5 for a cubic curve", "для кубической кривой напишите G5"
);

pub(crate) fn without_i_and_j(code: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "{code} without both I and J", "{code} без I и J";
        "the control point was expected", "ожидалась контрольная точка";
        "write I and J: from the start to the control point", "напишите I и J: от начала до контрольной точки"
    )
}

pub(crate) fn first_without_i_and_j(code: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "the first {code} without I and J", "первый {code} без I и J";
        "no curve leads here that it could go on from", "сюда не ведёт кривая, которую он мог бы продолжить";
        "write I and J: from the start to the first control point",
        "напишите I и J: от начала до первой контрольной точки"
    )
}

pub(crate) fn only_one_of_i_and_j(code: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "{code} with only one of I and J", "{code} только с одним из I и J";
        "both or neither were expected", "ожидались оба или ни одного";
        "write both I and J", "напишите и I, и J"
    )
}

pub(crate) fn without_p_and_q(code: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "{code} without both P and Q", "{code} без P и Q";
        "the second control point was expected", "ожидалась вторая контрольная точка";
        "write P and Q: from the end to the second control point",
        "напишите P и Q: от конца до второй контрольной точки"
    )
}

pub(crate) const WEIGHT_NOT_ABOVE_ZERO: Refusal = refusal!(const codes::CURVE;
    "a weight that is not above zero", "вес не больше нуля";
    "the curve would run away from its control points", "кривая ушла бы от контрольных точек";
    "write a weight above zero; 1 for an even curve", "напишите вес больше нуля; для обычной кривой 1"
);

pub(crate) fn order_behind_first_block(letter: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "the order of a curve behind its first block", "порядок кривой не в её первом кадре";
        "controls differ in what it changes", "что он меняет, у стоек по-разному";
        "write {letter} in the first block of the curve", "напишите {letter} в первом кадре кривой"
    )
}

pub(crate) fn order_of_curve(least: impl Display, most: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "a curve of this order", "кривая такого порядка";
        "{least} to {most} were expected", "ожидалось от {least} до {most}";
        "let the CAM write a curve of order 3 or 4", "выводите из CAM кривую порядка 3 или 4"
    )
}

pub(crate) fn too_few_control_points(points: impl Display, order: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "too few control points", "слишком мало контрольных точек";
        "{points} with the start; order {order} takes {order}",
        "{points} вместе с началом; порядку {order} нужно {order}";
        "write more control points, or a lower order", "напишите больше контрольных точек или меньший порядок"
    )
}

pub(crate) fn end_knots_differ(which: &Text) -> Refusal {
    refusal!(codes::CURVE;
        "the {which} knots of the curve differ", "{which:#} узлы кривой различны";
        "the curve would not reach its end point", "кривая не дошла бы до своей крайней точки";
        "write the first and the last knot as often as the order says",
        "повторите первый и последний узел столько раз, каков порядок"
    )
}

pub(crate) const EQUAL_KNOTS_INSIDE: Refusal = refusal!(const codes::CURVE;
    "too many equal knots inside a curve", "слишком много равных узлов внутри кривой";
    "the curve jumps there", "там кривая имеет разрыв";
    "write it as two curves", "напишите её двумя кривыми"
);

pub(crate) const KNOTS_AND_WEIGHTS_MAKE_NO_CURVE: Refusal = refusal!(const codes::CURVE;
    "knots and weights that make no curve", "узлы и веса, не задающие кривой";
    "looked at block by block before", "проверены раньше, кадр за кадром";
    "this is a fault of vpost; please report it with the program",
    "это ошибка vpost; сообщите о ней, приложив программу"
);

pub(crate) const WEIGHT_WITHOUT_CONTROL_POINT: Refusal = refusal!(const codes::CURVE;
    "a weight without its control point", "вес без контрольной точки";
    "the control points had ended", "контрольные точки уже кончились";
    "write R beside its control point", "пишите R рядом с его контрольной точкой"
);

pub(crate) const CONTROL_POINTS_UNDER_G91: Refusal = refusal!(const codes::CURVE;
    "a curve's control points under G91", "контрольные точки кривой при G91";
    "from the start, or from the point before? manuals do not say",
    "от начала или от прежней точки? руководства молчат";
    "write them under G90", "напишите их при G90"
);

pub(crate) const WORDS_BEHIND_END_OF_CURVE: Refusal = refusal!(const codes::CURVE;
    "words behind the end of a curve", "слова за концом кривой";
    "it has all of its knots", "все её узлы уже заданы";
    "write G0, G1, G2 or G3 behind it, or G6.2 for another curve",
    "напишите за ней G0, G1, G2 или G3, а для новой кривой G6.2"
);

pub(crate) const CURVE_WITHOUT_FIRST_CONTROL_POINT: Refusal = refusal!(const codes::CURVE;
    "a curve without its first control point", "кривая без первой контрольной точки";
    "the control would take where it stands", "стойка взяла бы место, где стоит";
    "write the place where the axes stand as the first control point",
    "напишите место, где стоят оси, первой контрольной точкой"
);

pub(crate) const CURVE_WITHOUT_ORDER_P: Refusal = refusal!(const codes::CURVE;
    "a curve without its order P", "кривая без порядка P";
    "the control would take that of the curve before", "стойка взяла бы порядок прежней кривой";
    "write P in the first block of the curve, 4 for a cubic one",
    "напишите P в первом кадре кривой, для кубической 4"
);

pub(crate) const BLOCK_WITHOUT_KNOT: Refusal = refusal!(const codes::CURVE;
    "a block of a curve without its knot K", "кадр кривой без узла K";
    "K was expected", "ожидалось K";
    "write K in each block of the curve", "пишите K в каждом кадре кривой"
);

pub(crate) fn knots_decrease(found: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "the knots of a curve decrease", "узлы кривой убывают";
        "{found} lies before the one in front of it", "{found} меньше предыдущего";
        "write them in rising order", "пишите их по возрастанию"
    )
}

pub(crate) const CONTROL_POINT_BEHIND_KNOTS_ALONE: Refusal = refusal!(const codes::CURVE;
    "a control point behind knots alone", "контрольная точка после одних узлов";
    "the control points had ended", "контрольные точки уже кончились";
    "write the control points one after the other", "пишите контрольные точки подряд"
);

pub(crate) fn control_point_names_other_axes(letters: &str) -> Refusal {
    refusal!(codes::CURVE;
        "a control point that names other axes", "контрольная точка с другими осями";
        "the first one names {letters}", "первая называет {letters}";
        "name the same axes in each control point", "называйте в каждой контрольной точке одни и те же оси"
    )
}

pub(crate) const FIRST_CONTROL_POINT_ELSEWHERE: Refusal = refusal!(const codes::CURVE;
    "the first control point is not where the axes stand", "первая контрольная точка не там, где стоят оси";
    "the control stops here with an alarm", "стойка здесь остановится с ошибкой";
    "move to it before, or write the place where the axes stand",
    "подойдите к ней до этого или напишите место, где стоят оси"
);

pub(crate) const CURVE_UNDER_CUTTER_COMPENSATION: Refusal = refusal!(const codes::CURVE;
    "a curve under cutter compensation", "кривая при коррекции на радиус";
    "no control offsets it", "ни одна стойка не строит её эквидистанту";
    "cancel the compensation with G40 before it, or let the CAM write the offset path",
    "отмените перед ней коррекцию функцией G40 или выводите эквидистанту из CAM"
);

pub(crate) const CURVE_UNDER_G93: Refusal = refusal!(const codes::CURVE;
    "a curve under G93", "кривая при G93";
    "the time of the whole curve or of its parts? controls differ",
    "время всей кривой или её частей? у стоек по-разному";
    "program the curve with G94", "запрограммируйте кривую при G94"
);

pub(crate) const OUTSIDE_G17: Refusal = refusal!(const codes::CURVE;
    "outside the plane of G17", "не в плоскости G17";
    "this control cuts it in X and Y only", "эта стойка обрабатывает её только в X и Y";
    "write G17 before it, or G5.2 for another plane", "напишите перед ней G17, а для другой плоскости G5.2"
);

pub(crate) fn in_curve_another_plane(letter: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "{letter} in a curve of another plane", "{letter} в кривой другой плоскости";
        "the control does not move it there", "стойка её здесь не перемещает";
        "select the curve's plane with G17, G18 or G19, or move {letter} in a block of its own",
        "выберите плоскость кривой функцией G17, G18 или G19 или переместите {letter} отдельным кадром"
    )
}

pub(crate) fn too_many_control_points(most: impl Display) -> Refusal {
    refusal!(codes::CURVE;
        "a curve of more than {most} control points", "в кривой больше {most} контрольных точек";
        "no control takes so many", "столько не принимает ни одна стойка";
        "let the CAM write several curves", "выводите из CAM несколько кривых"
    )
}

pub(crate) const DECIMAL_POINTS_MIXED: Refusal = refusal!(const codes::CURVE;
    "knots and weights with and without a decimal point", "узлы и веса с десятичной точкой и без неё";
    "without it some controls count thousandths", "без неё некоторые стойки считают тысячные";
    "write all of them with a decimal point", "пишите их все с десятичной точкой"
);

pub(crate) const SKIPPED_BLOCK_OF_CURVE: Refusal = refusal!(const codes::CURVE;
    "a block of a curve that may be skipped", "кадр кривой, который можно пропустить";
    "without it the curve is another", "без него кривая другая";
    "write the curve in blocks without `/`", "напишите кривую кадрами без `/`"
);

pub(crate) const CONTROL_POINT_WITHOUT_WEIGHT_P: Refusal = refusal!(const codes::CURVE;
    "a control point without its weight P", "контрольная точка без веса P";
    "the control would take -1, or the last one", "стойка взяла бы -1 или прежний";
    "write P1 for an even curve", "для обычной кривой напишите P1"
);

pub(crate) const WEIGHT_WITHOUT_POINT: Refusal = refusal!(const codes::CURVE;
    "a weight without its control point", "вес без контрольной точки";
    "only in a curve's first block it is that of the start",
    "только в первом кадре кривой он относится к её началу";
    "write X, Y and P of each control point", "пишите X, Y и P каждой контрольной точки"
);

pub(crate) fn half_a_control_point(letters: &str) -> Refusal {
    refusal!(codes::CURVE;
        "a control point with only one of {letters}", "контрольная точка только с одним словом из {letters}";
        "both were expected", "ожидались оба";
        "write both of each control point", "пишите оба слова каждой контрольной точки"
    )
}

pub(crate) const WITHOUT_G5_2_BEFORE: Refusal = refusal!(const codes::CURVE;
    "without G5.2 before it", "без G5.2 перед ней";
    "no curve has begun", "кривая не начата";
    "begin the curve with G5.2 and its control points", "начните кривую функцией G5.2 и контрольными точками"
);

pub(crate) fn words_beside(code: &str) -> Refusal {
    refusal!(codes::CURVE;
        "words beside {code}", "слова рядом с {code}";
        "the control would leave them out", "стойка бы их пропустила";
        "write the last control point in a block before it",
        "напишите последнюю контрольную точку кадром раньше"
    )
}
