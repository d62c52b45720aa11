//! What several forms of curves are refused for.

use diagnostic::{Diagnostic, Text, both};
use nc_syntax::{Letters, Span};
use toolpath::NurbsFault;

use super::{Begun, refuse};
use crate::words::Words;

pub(super) fn weight_refused(words: &Words<'_, '_, '_>, letter: Letters) -> Box<Diagnostic> {
    refuse(
        words,
        words.span(letter),
        both!("a weight that is not above zero", "вес не больше нуля"),
        both!("the curve would run away from its control points", "кривая ушла бы от контрольных точек"),
    )
    .help(both!(
        "write a weight above zero; 1 for an even curve",
        "напишите вес больше нуля; для обычной кривой 1"
    ))
}

pub(super) fn order_refused(
    words: &Words<'_, '_, '_>,
    letter: u8,
    late: bool,
    [least, most]: [u32; 2],
) -> Box<Diagnostic> {
    let span = words.span(Letters::of(&[letter]));
    let letter = letter as char;
    if late {
        return refuse(
            words,
            span,
            both!("the order of a curve behind its first block", "порядок кривой не в её первом кадре"),
            both!("controls differ in what it changes", "что он меняет, у стоек по-разному"),
        )
        .help(both!(
            "write {letter} in the first block of the curve",
            "напишите {letter} в первом кадре кривой"
        ));
    }
    refuse(
        words,
        span,
        both!("a curve of this order", "кривая такого порядка"),
        both!("{least} to {most} were expected", "ожидалось от {least} до {most}"),
    )
    .help(both!("let the CAM write a curve of order 3 or 4", "выводите из CAM кривую порядка 3 или 4"))
}

pub(super) fn of_fault(words: &Words<'_, '_, '_>, span: Span, fault: &NurbsFault) -> Box<Diagnostic> {
    match fault {
        NurbsFault::TooFewPoints { points, order } => refuse(
            words,
            span,
            both!("too few control points", "слишком мало контрольных точек"),
            both!(
                "{points} with the start; order {order} takes {order}",
                "{points} вместе с началом; порядку {order} нужно {order}"
            ),
        )
        .help(both!(
            "write more control points, or a lower order",
            "напишите больше контрольных точек или меньший порядок"
        )),
        NurbsFault::NotClamped { at_end } => {
            let which =
                if *at_end { both!("last", "последние") } else { both!("first", "первые") };
            refuse(
                words,
                span,
                both!("the {which} knots of the curve differ", "{which:#} узлы кривой различны"),
                both!("the curve would not reach its end point", "кривая не дошла бы до своей крайней точки"),
            )
            .help(both!(
                "write the first and the last knot as often as the order says",
                "повторите первый и последний узел столько раз, каков порядок"
            ))
        }
        NurbsFault::Jumps { .. } => refuse(
            words,
            span,
            both!("too many equal knots inside a curve", "слишком много равных узлов внутри кривой"),
            both!("the curve jumps there", "там кривая имеет разрыв"),
        )
        .help(both!("write it as two curves", "напишите её двумя кривыми")),
        NurbsFault::Weight { .. } | NurbsFault::KnotsDecrease { .. } | NurbsFault::KnotCount { .. } => {
            refuse(
                words,
                span,
                both!("knots and weights that make no curve", "узлы и веса, не задающие кривой"),
                both!("looked at block by block before", "проверены раньше, кадр за кадром"),
            )
            .help(both!(
                "this is a fault of vpost; please report it with the program",
                "это ошибка vpost; сообщите о ней, приложив программу"
            ))
        }
    }
}

pub(super) fn every_knot(begun: &Begun) -> Text {
    both!(
        "write as many blocks with K alone behind the control points as the order says, {}",
        "после контрольных точек напишите столько кадров с одним K, каков порядок: {}",
        begun.degree + 1
    )
}
