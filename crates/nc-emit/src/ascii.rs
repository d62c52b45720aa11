//! Names in the letters that every control shows.

use std::borrow::Cow;

/// A text in ASCII: what is beyond it as it is spelled there, in capitals; `_` for what has no spelling.
///
/// Russian as in passports (ICAO Doc 9303, part 3), but Й, Ю, Я, Ъ, as people read them: Y, YU, YA and nothing.
///
/// ```
/// assert_eq!(nc_emit::ascii("ГФ2171, участок №4"), "GF2171, UCHASTOK NO4");
/// assert_eq!(nc_emit::ascii("Fräse Łódź"), "FrAEse LOdZ");
/// assert_eq!(nc_emit::ascii("X 50%"), "X 50%");
/// ```
#[must_use]
pub fn ascii(text: &str) -> Cow<'_, str> {
    if text.is_ascii() {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_ascii() {
            plain.push(character);
        } else {
            plain.push_str(spelled(character));
        }
    }
    Cow::Owned(plain)
}

fn spelled(character: char) -> &'static str {
    // These have no capital of their own.
    match character {
        'ß' => return "SS",
        'ı' => return "I",
        _ => {}
    }
    match character.to_uppercase().next().unwrap_or(character) {
        'А' | 'À' | 'Á' | 'Â' | 'Ã' | 'Å' | 'Ā' | 'Ă' | 'Ą' => "A",
        'Ä' | 'Æ' => "AE",
        'Б' => "B",
        'Ç' | 'Ć' | 'Č' => "C",
        'Ч' => "CH",
        'Д' | 'Ď' | 'Đ' => "D",
        'Е' | 'Ё' | 'Э' | 'È' | 'É' | 'Ê' | 'Ë' | 'Ē' | 'Ę' | 'Ě' => "E",
        'Ф' => "F",
        'Г' | 'Ґ' | 'Ğ' => "G",
        'И' | 'І' | 'Ì' | 'Í' | 'Î' | 'Ï' | 'Ī' | 'İ' => "I",
        'К' => "K",
        'Х' => "KH",
        'Л' | 'Ł' => "L",
        'М' => "M",
        'Н' | 'Ñ' | 'Ń' | 'Ň' => "N",
        '№' => "NO",
        'О' | 'Ò' | 'Ó' | 'Ô' | 'Õ' | 'Ő' => "O",
        'Ö' | 'Ø' | 'Œ' => "OE",
        'П' => "P",
        'Р' | 'Ř' => "R",
        'С' | 'Ś' | 'Ş' | 'Š' => "S",
        'Ш' => "SH",
        'Щ' => "SHCH",
        'Т' | 'Ť' => "T",
        'Ц' => "TS",
        'У' | 'Ў' | 'Ù' | 'Ú' | 'Û' | 'Ū' | 'Ů' | 'Ű' | '\u{39c}' => "U",
        'Ü' => "UE",
        'В' => "V",
        '×' => "X",
        'Й' | 'Ы' | 'Ý' | 'Ÿ' => "Y",
        'Я' => "YA",
        'Є' => "YE",
        'Ї' => "YI",
        'Ю' => "YU",
        'З' | 'Ź' | 'Ż' | 'Ž' => "Z",
        'Ж' => "ZH",
        '–' | '—' | '−' => "-",
        '\u{a0}' | '\u{202f}' => " ",
        'Ъ' | 'Ь' | '«' | '»' | '“' | '”' | '„' => "",
        _ => "_",
    }
}
