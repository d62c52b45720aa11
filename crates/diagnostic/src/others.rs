//! What others say, in every language: the operating system, the reader of TOML.

use std::io::{Error, ErrorKind};

use crate::{Text, both};

/// What the system says of a file: in English its own words.
///
/// A [`Text`] that an error was made of comes out as it went in.
#[must_use]
pub fn of_system(error: &Error) -> Text {
    if let Some(text) = error.get_ref().and_then(|inner| inner.downcast_ref::<Text>()) {
        return text.clone();
    }
    // `tempfile` adds the name of its file, which means nothing to the user.
    let own = error.to_string();
    let own = own.split(" at path ").next().unwrap_or_default();
    let russian = match error.kind() {
        ErrorKind::NotFound => "нет такого файла или папки",
        ErrorKind::PermissionDenied => "нет прав",
        ErrorKind::AlreadyExists => "уже существует",
        ErrorKind::IsADirectory => "это папка",
        ErrorKind::NotADirectory => "это не папка",
        ErrorKind::DirectoryNotEmpty => "папка не пуста",
        ErrorKind::StorageFull => "на устройстве нет места",
        ErrorKind::QuotaExceeded => "исчерпана дисковая квота",
        ErrorKind::ReadOnlyFilesystem => "файловая система только для чтения",
        ErrorKind::FileTooLarge => "файл слишком велик",
        ErrorKind::BrokenPipe => "принимающая программа закрыла канал",
        ErrorKind::InvalidFilename => "недопустимое имя",
        ErrorKind::UnexpectedEof => "файл кончился раньше времени",
        _ => own,
    };
    both!("{own}", "{russian}")
}

/// What the reader of TOML says of a text, in one line; what is not known in Russian stays as it is.
#[must_use]
pub fn of_toml(message: &str) -> Text {
    // serde speaks of Rust's types.
    let english = message
        .lines()
        .collect::<Vec<_>>()
        .join("; ")
        .replace("expected f64", "expected a number")
        .replace("expected i64", "expected a whole number");
    let russian =
        WORDS.iter().fold(english.clone(), |text, (english, russian)| text.replace(english, russian));
    Text::new(english, russian)
}

/// Longer words before those that are part of them.
#[rustfmt::skip]
const WORDS: &[(&str, &str)] = &[
    ("invalid type: ", "значение другого вида: "),
    ("invalid value: ", "недопустимое значение: "),
    ("invalid length ", "неверная длина "),
    ("unknown variant ", "незнакомое значение "),
    ("missing field ", "нет ключа "),
    ("unknown field ", "незнакомый ключ "),
    ("duplicate key", "ключ стоит дважды"),
    ("duplicate field ", "ключ стоит дважды: "),
    ("invalid multi-line basic string", "многострочный текст не закрыт"),
    ("invalid basic string", "текст не закрыт"),
    ("invalid literal string", "текст не закрыт"),
    ("string values must be quoted", "текст берётся в кавычки"),
    ("missing opening quote", "нет открывающей кавычки"),
    ("missing assignment between key-value pairs", "между ключом и значением нет `=`"),
    ("missing comma between key-value pairs", "между ключами нет запятой"),
    ("missing comma between array elements", "в списке нет запятой"),
    ("missing value for key", "у ключа нет значения"),
    ("missing value", "нет значения"),
    ("key with no value", "у ключа нет значения"),
    ("invalid unquoted key", "такой ключ берётся в кавычки"),
    ("unquoted keys cannot be empty", "ключ пуст"),
    ("invalid key-value pair", "это не ключ со значением"),
    ("unexpected key or value", "лишний ключ или значение"),
    ("unexpected content", "лишний текст"),
    ("unclosed inline table", "таблица не закрыта"),
    ("unclosed array table", "заголовок раздела не закрыт"),
    ("unclosed table", "заголовок раздела не закрыт"),
    ("unclosed array", "список не закрыт"),
    ("extra comma in inline table", "лишняя запятая в таблице"),
    ("extra comma in array", "лишняя запятая в списке"),
    ("extra `=`", "лишний знак `=`"),
    ("unexpected leading zero", "число начинается с нуля"),
    ("`_` may only go between digits", "`_` стоит только между цифрами"),
    ("invalid value", "недопустимое значение"),
    ("expected one of ", "ожидалось одно из "),
    ("expected a whole number", "ожидалось целое число"),
    ("expected a number", "ожидалось число"),
    ("expected a string", "ожидался текст"),
    ("expected an array of length ", "ожидался список, его длина "),
    ("expected value", "ожидалось значение"),
    ("expected key", "ожидался ключ"),
    ("expected ", "ожидалось "),
    ("floating point ", "число "),
    ("integer ", "целое число "),
    ("boolean ", "логическое "),
    ("string ", "текст "),
    (", nothing", ", ничего"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Language;

    #[test]
    fn errors_of_the_system_and_of_our_own_are_said_in_both_languages() {
        let text = of_system(&Error::from(ErrorKind::PermissionDenied));
        assert_eq!(text.in_language(Language::Russian), "нет прав");
        let own = Text::pair("closed", "закрыт");
        assert_eq!(of_system(&Error::other(own.clone())), own);
    }

    #[test]
    fn the_reader_of_toml_is_understood() {
        let text = of_toml("invalid type: string \"x\", expected f64\nin `axis`");
        assert_eq!(text.english(), "invalid type: string \"x\", expected a number; in `axis`");
        assert_eq!(
            text.in_language(Language::Russian),
            "значение другого вида: текст \"x\", ожидалось число; in `axis`"
        );
        assert_eq!(of_toml("words of tomorrow").in_language(Language::Russian), "words of tomorrow");
    }
}
