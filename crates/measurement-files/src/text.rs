//! Bytes to text.

use std::borrow::Cow;

use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1251};

/// Text that may be older than UTF-8: then it is Windows-1251, as controls and instruments of the region write.
/// No two texts become the same, so ids stay apart.
#[must_use]
pub fn utf8_or_1251(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => WINDOWS_1251.decode_without_bom_handling(bytes).0,
    }
}

/// The number of a name, in order of appearance: 0 is the first of `names`, to which a new one is added.
pub fn numbered(names: &mut Vec<String>, name: &str) -> usize {
    names.iter().position(|known| known == name).unwrap_or_else(|| {
        names.push(name.to_owned());
        names.len() - 1
    })
}

/// The text of a file: UTF-8 with or without a byte order mark, UTF-16 (Excel's "Unicode text"), else Windows-1251.
///
/// Places in what is refused count bytes of this text.
#[must_use]
pub fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => utf8_or_1251(rest),
        [0xFF, 0xFE, rest @ ..] => UTF_16LE.decode_without_bom_handling(rest).0,
        [0xFE, 0xFF, rest @ ..] => UTF_16BE.decode_without_bom_handling(rest).0,
        // No table begins with NUL, nor has one behind its first letter.
        [1..=0xFF, 0, ..] => UTF_16LE.decode_without_bom_handling(bytes).0,
        [0, 1..=0xFF, ..] => UTF_16BE.decode_without_bom_handling(bytes).0,
        _ => utf8_or_1251(bytes),
    }
}
