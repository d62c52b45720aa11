//! What a diagnosis of turned parts says, in words.

use diagnostic::{Text, both};
use gap_diagnosis::{Cause as Found, NextMeasurement, Parameter, Verdict};

use super::columns::{Cause, CauseRow};

/// A rival that is no cause of the list.
pub(super) const CLAMPING: &str = "how the parts were clamped";
/// A rival of which no single cause is one.
pub(super) const SEVERAL: &str = "several other causes together";

/// A cause of turned parts by its name, in English its id; of what is none, the id.
#[must_use]
pub fn cause_name(id: &str) -> Text {
    let russian = match (Cause::ALL.into_iter().find(|cause| cause.id() == id), id.split_once(" with ")) {
        (Some(Cause::Taper), _) => "наклон оси детали",
        (Some(Cause::Bending), _) => "прогиб детали",
        (Some(Cause::Runout), _) => "биение шпинделя",
        (Some(Cause::Growth), _) => "рост передней бабки",
        (Some(Cause::Wear), _) => "износ инструмента",
        (Some(Cause::Straightness), _) => "прямолинейность EXZ",
        (Some(Cause::Scale), _) => "масштаб X",
        (Some(Cause::Jaws), _) => "кулачки патрона",
        (None, Some((a, b))) => {
            let (a, b) = (cause_name(a), cause_name(b));
            return both!("{a} with {b}", "{a:#} вместе с: {b:#}");
        }
        (None, None) if id == CLAMPING => "установка деталей",
        (None, None) if id == SEVERAL => "несколько других причин вместе",
        (None, None) => id,
    };
    Text::new(id.to_owned(), russian.to_owned())
}

/// A verdict in a sentence.
pub(super) fn meaning(verdict: Verdict) -> Text {
    match verdict {
        Verdict::NoGap => both!("Nothing but noise is left.", "Кроме шума ничего нет."),
        Verdict::Named => both!(
            "Every cause that is told can be nothing else in the list.",
            "Ни одну из названных причин не принять за другую из списка."
        ),
        Verdict::Ambiguous => both!(
            "A cause may be another: do not repair by it yet.",
            "Причина может быть и другой: чинить по ней рано."
        ),
        Verdict::Partial => both!(
            "Something is left that no cause explains.",
            "Остаётся то, чего ни одна причина не объясняет."
        ),
        Verdict::Unknown => both!(
            "Something is there that no cause of the list explains, or unseen parts refute what was found.",
            "Есть то, чего ни одна причина из списка не объясняет, или контрольные детали опровергают найденное."
        ),
        Verdict::NoiseModelSuspect => both!(
            "A reading is none: look at it first.",
            "Одно из показаний неверно: сначала разберитесь с ним."
        ),
        Verdict::Underpowered => both!(
            "Too few readings or parts: twelve rows of two parts at least, several places along Z.",
            "Мало показаний или деталей: не меньше двенадцати строк двух деталей, несколько мест вдоль Z."
        ),
    }
}

/// Which reading is none.
pub(super) fn outlier(row: &CauseRow) -> Text {
    let (line, z_mm) = (row.line, row.z_mm);
    both!(
        " Line {line}, Z {z_mm}, does not belong to its part's others: measure it again, or take the row out.",
        " Строка {line}, Z {z_mm}, не вяжется с остальными показаниями той же детали: измерьте снова или уберите строку."
    )
}

/// What makes too few readings enough.
pub(super) fn more_parts() -> NextMeasurement {
    let text = both!(
        "Measure twelve rows of two parts at least, at several places along Z.",
        "Измерьте не меньше двенадцати строк двух деталей, в нескольких местах вдоль Z."
    );
    NextMeasurement { text, separates: Vec::new(), expected_sigma: 0.0, rows: Vec::new() }
}

/// A cause in a sentence.
pub(super) fn sentence(cause: Cause, numbers: &[Parameter]) -> Text {
    let value = numbers.first().map_or(0.0, |number| number.value);
    match cause {
        Cause::Taper => both!(
            "the axis of the part leans against Z: {:.1} um on the diameter over 100 mm",
            "ось детали наклонена к Z: {:.1} мкм по диаметру на 100 мм",
            value * 0.2
        ),
        Cause::Bending => both!(
            "the part gives way to {value:.0} N more than the profile says",
            "деталь отжимается силой, на {value:.0} Н большей, чем в профиле"
        ),
        Cause::Runout => both!(
            "the spindle's axis moves the same way every turn: {value:.2} um at two waves a turn",
            "ось шпинделя движется одинаково каждый оборот: {value:.2} мкм при двух волнах на оборот"
        ),
        Cause::Growth => both!(
            "the radius changes by {value:.1} um from the first reading to the last, with the time",
            "радиус меняется со временем на {value:.1} мкм от первого показания к последнему"
        ),
        Cause::Wear => both!(
            "the radius changes by {value:.2} um from part to part of one edge",
            "радиус меняется на {value:.2} мкм от детали к детали одной кромки"
        ),
        Cause::Straightness => both!(
            "the carriage runs in a bow along Z: {value:.1} um in the middle against the ends, on the radius",
            "каретка идёт вдоль Z по дуге: {value:.1} мкм в середине относительно концов, по радиусу"
        ),
        Cause::Scale => both!(
            "the error goes with the diameter: {value:.0} um per metre of X",
            "погрешность идёт за диаметром: {value:.0} мкм на метр X"
        ),
        Cause::Jaws => both!(
            "three waves a turn of {value:.2} um, as three jaws press them",
            "три волны на оборот по {value:.2} мкм, как их выжимают три кулачка"
        ),
    }
}

/// What to do about a cause.
///
/// * `tailstock_mm` – where the tailstock's centre stands, if there is one
pub(super) fn remedy(cause: Cause, numbers: &[Parameter], tailstock_mm: Option<f64>) -> Text {
    match cause {
        Cause::Taper => match tailstock_mm {
            Some(at_mm) => {
                let offset_um = numbers[0].value * 1e-3 * at_mm;
                both!(
                    "Set the tailstock over, or add {offset_um:.2} to X of `offset_um` under [tailstock].",
                    "Выставьте заднюю бабку либо прибавьте {offset_um:.2} к X в `offset_um` раздела [tailstock]."
                )
            }
            None => both!(
                "Align the headstock, or add {:.2} to `EB0S_urad` under [spindle].",
                "Выставьте переднюю бабку либо прибавьте {:.2} к `EB0S_urad` в разделе [spindle].",
                numbers[1].value
            ),
        },
        Cause::Bending => both!(
            "Add it to `radial_force_n` under [workpiece], or cut with less depth, a sharper edge, a steady rest.",
            "Прибавьте её к `radial_force_n` в разделе [workpiece] либо точите с меньшей глубиной, острой кромкой, с люнетом."
        ),
        Cause::Runout => both!(
            "Look at the spindle's bearings: no correction of X and Z takes roundness away.",
            "Проверьте подшипники шпинделя: коррекцией X и Z некруглость не снять."
        ),
        Cause::Growth => both!(
            "Warm the spindle up before finishing, or correct the offset of X as it grows.",
            "Прогревайте шпиндель перед чистовой обработкой либо правьте коррекцию X по мере роста."
        ),
        Cause::Wear => both!(
            "Take it off the wear offset of X from part to part (twice of it on the diameter), or change the edge earlier.",
            "Вычитайте её из износа X от детали к детали (по диаметру вдвое больше) либо раньше меняйте кромку."
        ),
        Cause::Straightness => both!(
            "`vpost calibrate turning` writes it as EXZ.",
            "`vpost calibrate turning` записывает её как EXZ."
        ),
        Cause::Scale => both!("Measure the positioning of X.", "Измерьте позиционирование X."),
        Cause::Jaws => both!(
            "Clamp with less force, or with soft jaws turned to the diameter.",
            "Зажимайте слабее или в сырых кулачках, расточенных под диаметр."
        ),
    }
}

/// What would settle the first cause that is open.
pub(super) fn next(causes: &[Found]) -> Option<NextMeasurement> {
    let open = causes.iter().find(|own| !own.cannot_be_told_from.is_empty())?;
    let has = |name: &str| open.cannot_be_told_from.iter().any(|rival| rival.contains(name));
    let text = match Cause::ALL.into_iter().find(|cause| cause.id() == open.effect)? {
        Cause::Taper if has("tool.wear") || has("spindle.growth") => both!(
            "Finish one part in the other direction along Z: what comes while it is cut turns round, a taper does not.",
            "Обточите одну деталь в обратном направлении по Z: то, что набегает за проход, перевернётся, конус — нет."
        ),
        Cause::Taper | Cause::Straightness | Cause::Bending => both!(
            "Turn a part of half the diameter, held the same: bending grows sixteenfold, geometry stays.",
            "Обточите деталь половинного диаметра в той же установке: прогиб вырастет в шестнадцать раз, геометрия останется."
        ),
        Cause::Growth | Cause::Wear | Cause::Scale => both!(
            "With time_s filled in, turn one part with a new edge while warm, and the first diameter again.",
            "С заполненным time_s обточите одну деталь новой кромкой на тёплом станке и снова первый диаметр."
        ),
        Cause::Jaws | Cause::Runout => both!(
            "Measure a part between centres, at twelve angles or more.",
            "Измерьте деталь в центрах, не меньше чем под двенадцатью углами."
        ),
    };
    let separates = std::iter::once(&open.effect).chain(&open.cannot_be_told_from);
    let separates = separates.map(Text::same).collect();
    Some(NextMeasurement { text, separates, expected_sigma: 0.0, rows: Vec::new() })
}
