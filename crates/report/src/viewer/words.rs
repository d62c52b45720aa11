//! Every text of the page, in both languages.

use diagnostic::Language;

/// Key, English, Russian. What stands in braces is filled in.
pub(super) const WORDS: &[(&str, &str, &str)] = &[
    ("title_check", "Check in space – {output}", "Проверка в пространстве — {output}"),
    ("title_map", "Error map in space – {machine}", "Карта погрешностей в пространстве — {machine}"),
    ("title_diagnosis", "Diagnosis in space – {file}", "Диагностика в пространстве — {file}"),
    (
        "kind_check",
        "{output} on {machine}, by the machine model",
        "{output} на станке {machine}, по модели станка",
    ),
    ("kind_map", "{machine}, by the machine model", "{machine}, по модели станка"),
    ("kind_diagnosis", "{file}: measured on {machine}", "{file}: измерено на станке {machine}"),
    (
        "head_check",
        "As posted the tool leaves its path by up to {before} µm, as corrected by up to {after} µm; allowed are {limit} µm",
        "По исходной программе инструмент отходит от траектории до {before} мкм, по исправленной — до {after} мкм; допустимо {limit} мкм",
    ),
    (
        "head_map",
        "The tool is up to {before} µm from where it is told to be; with the zero point moved, up to {after} µm",
        "Инструмент стоит до {before} мкм от заданного места; со сдвинутым нулём — до {after} мкм",
    ),
    (
        "head_diagnosis",
        "{verdict_en}: the rows are {before} µm (RMS) from the model, with the causes that were found {after} µm",
        "{verdict_ru}: строки отходят от модели на {before} мкм (СКЗ), с найденными причинами — на {after} мкм",
    ),
    (
        "seen",
        "Displacements are drawn {times} their size; the largest is {largest} µm. Drag to turn, pick a place to see what makes its error.",
        "Смещения показаны увеличенными: {times}; наибольшее — {largest} мкм. Поверните вид, выберите место — и видно, из чего его погрешность.",
    ),
    (
        "seen_without",
        "Displacements are drawn {times} their size. Without {causes} the largest would be {largest} µm.",
        "Смещения показаны увеличенными: {times}. Без причин ({causes}) наибольшее было бы {largest} мкм.",
    ),
    ("still", "Displacements are drawn {times} times their size.", "Увеличение смещений: {times}\u{d7}."),
    ("skip", "Skip to the place that is looked at", "Перейти к выбранному месту"),
    ("languages", "Language", "Язык"),
    (
        "view",
        "The path in space. Arrow keys turn it, with Shift they move it, plus and minus zoom; comma and full stop go from block to block.",
        "Траектория в пространстве. Стрелки поворачивают её, с Shift — сдвигают, плюс и минус — масштаб; запятая и точка — предыдущий и следующий кадр.",
    ),
    ("commanded_check", "programmed", "по программе"),
    ("real_check", "real, as posted", "на самом деле, исходная"),
    ("corrected_check", "real, as corrected", "на самом деле, исправленная"),
    ("commanded_map", "as told", "как задано"),
    ("real_map", "as it is", "как есть"),
    ("corrected_map", "with the zero point moved", "со сдвинутым нулём"),
    ("commanded_diagnosis", "as told", "как задано"),
    ("real_diagnosis", "measured", "измерено"),
    ("corrected_diagnosis", "without what the causes make", "без вклада причин"),
    ("most", "up to {largest} µm", "до {largest} мкм"),
    ("shown", "What is shown", "Что показано"),
    ("magnification", "Magnification", "Увеличение"),
    ("along_check", "Along the program", "По программе"),
    ("along_map", "From node to node", "По узлам"),
    ("along_diagnosis", "From row to row", "По строкам"),
    ("cut", "fade what comes after", "приглушить то, что дальше"),
    ("play", "Play", "Пуск"),
    ("swing", "Swing", "Качать"),
    ("previous", "Previous block", "Предыдущий кадр"),
    ("next", "Next block", "Следующий кадр"),
    ("worst", "Largest", "Наибольшее"),
    ("views", "Views", "Виды"),
    ("view_corner", "Corner", "Угол"),
    ("view_top", "Top", "Сверху"),
    ("view_front", "Front", "Спереди"),
    ("view_side", "Side", "Сбоку"),
    ("in", "Zoom in", "Ближе"),
    ("out", "Zoom out", "Дальше"),
    ("line_check", "Line {line}", "Строка {line}"),
    ("line_map", "Node {line}", "Узел {line}"),
    ("line_diagnosis", "Line {line}", "Строка {line}"),
    ("displaced", "Displacement, µm", "Смещение, мкм"),
    ("size", "size", "длина"),
    (
        "off_check",
        "This motion leaves its path by up to {before} µm as posted, {after} µm as corrected.",
        "Это движение отходит от траектории до {before} мкм по исходной программе, до {after} мкм по исправленной.",
    ),
    ("off_map", "", ""),
    ("off_diagnosis", "", ""),
    ("makers", "Most of it: {list}.", "Больше всего: {list}."),
    ("makers_none", "No cause displaces the tool here.", "Здесь ни одна причина не смещает инструмент."),
    (
        "spoken",
        "Displaced by {real} µm, corrected {after} µm",
        "Смещение {real} мкм, исправленное {after} мкм",
    ),
    ("um", "µm", "мкм"),
    ("mm", "mm", "мм"),
    ("causes", "What makes the error", "Из чего погрешность"),
    (
        "causes_how",
        "Switched off, a cause no longer displaces the real path. Numbers are of the place that is looked at, µm; a minus, and an empty bar, acts against the whole.",
        "Выключенная причина больше не смещает действительную траекторию. Числа — для выбранного места, мкм; минус и пустая полоса — действует против целого.",
    ),
    ("all", "All", "Все"),
    ("none", "None", "Ни одной"),
    ("cause_squareness", "squareness {symbol}", "отклонение от перпендикулярности {symbol}"),
    ("cause_positioning", "positioning {symbol}", "позиционирование {symbol}"),
    ("cause_straightness", "straightness of {symbol}", "отклонение от прямолинейности {symbol}"),
    ("cause_angles", "angles of {symbol}", "повороты {symbol}"),
    ("cause_reversal", "reversal of {symbol}", "реверс {symbol}"),
    ("cause_location", "where {symbol} lies", "положение оси {symbol}"),
    ("cause_rotary", "errors of {symbol}", "погрешности оси {symbol}"),
    ("cause_effect", "{symbol}", "{symbol}"),
    ("keys", "Keys, and what is drawn", "Клавиши, и что нарисовано"),
    (
        "keys_how",
        "In the drawing: arrows turn, Shift and arrows move, + and − zoom, 1 2 3 4 are the views, 0 fits; comma and full stop go to the block before and behind, W to the largest displacement; space plays the program, M swings the error between nothing and its magnified size. A finger turns, two move and zoom.",
        "На рисунке: стрелки поворачивают, Shift и стрелки сдвигают, + и − масштаб, 1 2 3 4 — виды, 0 — целиком; запятая и точка — кадр назад и вперёд, W — наибольшее смещение; пробел проигрывает программу, M качает погрешность от нуля до увеличенной. Один палец поворачивает, два сдвигают и меняют масштаб.",
    ),
    (
        "thinned",
        "{drawn} of {of} places are drawn. Every place that was left out lies within {path} µm of what is drawn, its displacements within {displaced} µm of those between the places that are drawn; places that are drawn have their own numbers.",
        "Нарисовано мест: {drawn} из {of}. Каждое пропущенное лежит не дальше {path} мкм от нарисованного, его смещения — не дальше {displaced} мкм от промежуточных; у нарисованных мест числа свои.",
    ),
    ("whole", "All {of} places are drawn.", "Нарисованы все места: {of}."),
    (
        "remainder",
        "A cause is what is missing when the machine model is evaluated without it. Since errors multiply, the causes do not quite add up to the whole: by {remainder} µm at most.",
        "Причина — то, чего не хватает, если вычислить модель станка без неё. Погрешности перемножаются, поэтому сумма причин не совсем равна целому: разница до {remainder} мкм.",
    ),
    (
        "remainder_diagnosis",
        "Measured is the gap between the rows and the model, the measuring frame aligned; a cause is what it makes of the rows, the frame aligned once more. What the causes do not explain, and what aligning all of them at once does otherwise, is up to {remainder} µm in a row.",
        "Измерено — это расхождение строк и модели после совмещения систем координат; причина — то, что она даёт в строках, тоже после совмещения. Необъяснённое, вместе с разницей от общего совмещения, — до {remainder} мкм в строке.",
    ),
    (
        "undivided",
        "This engine does not say which causes make the error.",
        "Этот метод не говорит, из каких причин складывается погрешность.",
    ),
    ("where_from", "Where this comes from", "Откуда это"),
    ("fact_input", "as posted", "исходная программа"),
    ("fact_output", "as corrected", "исправленная программа"),
    ("fact_measurements", "measurements", "измерения"),
    ("fact_machine", "machine", "станок"),
    ("fact_profile", "profile and its tables", "профиль и его таблицы"),
    ("fact_calibrated", "calibrated", "калибровка"),
    ("fact_engine", "model", "модель"),
    ("fact_grid", "grid", "сетка"),
    ("fact_tool", "tool vector", "вектор инструмента"),
    ("fact_typed", "command", "команда"),
    ("fact_command", "made by", "создано"),
    (
        "foot",
        "This page needs no network and is the same for the same files.",
        "Странице не нужна сеть; для тех же файлов она та же.",
    ),
];

/// A text; a key that there is not is a mistake of this room, and shows itself.
pub(super) fn word(key: &str, language: Language) -> &str {
    match (WORDS.iter().find(|(known, ..)| *known == key), language) {
        (Some((_, english, _)), Language::English) => english,
        (Some((.., russian)), Language::Russian) => russian,
        (None, _) => key,
    }
}

/// A cause of error in words, by its kind and which one: squareness EC0Y.
#[must_use]
pub fn cause(kind: &str, symbol: &str, language: Language) -> String {
    say(&format!("cause_{kind}"), language, &[("symbol", symbol.to_owned())])
}

/// A text with what stands in its braces filled in.
pub(super) fn say(key: &str, language: Language, values: &[(&str, String)]) -> String {
    values.iter().fold(word(key, language).to_owned(), |text, (name, value)| {
        text.replace(&format!("{{{name}}}"), value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What stands in braces, in order of the alphabet. What is itself a text is there in each language, which its name
    /// ends in.
    fn blanks<'t>(text: &'t str, language: &str) -> Vec<&'t str> {
        let names = text.split('{').skip(1).filter_map(|rest| rest.split('}').next());
        let mut found: Vec<&str> = names.map(|name| name.strip_suffix(language).unwrap_or(name)).collect();
        found.sort_unstable();
        found
    }

    #[test]
    fn both_languages_say_the_same_things() {
        for (at, (key, english, russian)) in WORDS.iter().enumerate() {
            assert!(WORDS[..at].iter().all(|(other, ..)| other != key), "{key} stands twice");
            assert_eq!(blanks(english, "_en"), blanks(russian, "_ru"), "{key}");
            assert_eq!(english.is_empty(), russian.is_empty(), "{key}");
        }
    }

    /// The script asks for no text that there is not, and every text is asked for.
    #[test]
    fn every_text_is_used() {
        let script = include_str!("viewer.js");
        let page = include_str!("page.rs");
        for (key, ..) in WORDS {
            let family = key.rsplit_once('_').map_or(*key, |(family, _)| family);
            let named = |text: &str| {
                [
                    format!("'{key}'"),
                    format!("\"{key}\""),
                    format!("'{family}_'"),
                    format!("\"{family}\""),
                    format!("\"{family}_"),
                ]
                .iter()
                .any(|quoted| text.contains(quoted))
            };
            let by_caller = ["fact_", "cause_", "remainder_"].iter().any(|start| key.starts_with(start));
            assert!(by_caller || named(script) || named(page), "{key} is used nowhere");
        }
    }
}
