//! Messages about bytes that are not words.

use diagnostic::{Code, Diagnostic, Edit, Text, both};

use crate::{Block, Invalid, MAX_BLOCK_BYTES, Span};

impl Block<'_> {
    /// The message for the first item that could not be read, if any (VP0101–VP0106).
    #[must_use]
    pub fn unreadable(&self) -> Option<Diagnostic> {
        self.first_invalid().map(|(why, span)| self.unreadable_at(why, span))
    }

    /// The message for one item that could not be read.
    #[must_use]
    pub fn unreadable_at(&self, why: Invalid, span: Span) -> Diagnostic {
        let length = self.bytes.len();
        let shown = printable(&self.bytes[span.start as usize..(span.end as usize).min(length)]);
        let (code, message, label, help) = match why {
            Invalid::Number => (
                101,
                both!(
                    "`{shown}` is not a number a control reads",
                    "`{shown}` — не то число, какие читает стойка"
                ),
                both!(
                    "expected a sign, digits and one decimal point",
                    "ожидались знак, цифры и одна десятичная точка"
                ),
                both!(
                    "write it like `X-12.5`: no exponent, one sign, a point and not a comma",
                    "пишите так: `X-12.5` — без показателя степени, один знак, точка, а не запятая"
                ),
            ),
            Invalid::TooManyDigits => (
                102,
                both!("`{shown}` has more than 15 digits", "в `{shown}` больше 15 цифр"),
                both!("not exact in any control", "точно этого не хранит ни одна стойка"),
                both!(
                    "round it to the decimals of the machine's input step, 3 or 4",
                    "округлите до дискреты ввода станка: 3 или 4 знака после точки"
                ),
            ),
            Invalid::UnclosedComment => (
                103,
                both!("the comment is not closed", "комментарий не закрыт"),
                both!("this bracket has no partner in its line", "у этой скобки нет пары в её строке"),
                both!(
                    "close the comment with `)` on the same line",
                    "закройте комментарий скобкой `)` в той же строке"
                ),
            ),
            Invalid::UnclosedBracket => (
                104,
                both!("`{shown}` has a bracket without its partner", "в `{shown}` скобка без пары"),
                both!(
                    "brackets must close in the block they open in",
                    "скобка закрывается в том же кадре, где открыта"
                ),
                both!(
                    "add the missing bracket or remove this one",
                    "добавьте недостающую скобку или уберите эту"
                ),
            ),
            Invalid::Text => not_of_the_dialect(&shown),
            Invalid::TooLong => (
                106,
                both!(
                    "the block is {length} bytes long; the longest that is read is {MAX_BLOCK_BYTES}",
                    "длина кадра {length} байт, а читается не больше {MAX_BLOCK_BYTES}"
                ),
                both!("no line end within that length", "на этой длине нет конца строки"),
                both!(
                    "check that this is a part program and that its line ends arrived with it",
                    "проверьте, что это управляющая программа и что при передаче не пропали концы строк"
                ),
            ),
        };
        // A caret under a gigabyte helps nobody.
        let end = span.end.min(span.start.saturating_add(120));
        let mut refused = Diagnostic::error(Code(code), message)
            .at(self.file_span(Span { start: span.start, end }), label)
            .help(help);
        if let Some(edit) = self.mended(why, span) {
            refused = refused.mended_by(edit);
        }
        refused
    }

    /// The edit that makes of it what was meant, where one does.
    fn mended(&self, why: Invalid, span: Span) -> Option<Edit> {
        let text = self.text(span);
        let at = self.file_span(span);
        match why {
            Invalid::UnclosedComment => {
                let line = self.bytes.trim_ascii_end();
                Some(Edit::insert(self.offset + line.len() as u64, ")"))
            }
            Invalid::Number => {
                let decimal = text.iter().filter(|byte| matches!(byte, b',' | b'.')).eq([&b',']);
                let digits = text.iter().skip(1).all(|byte| byte.is_ascii_digit() || b",+-".contains(byte));
                let comma = text.iter().position(|byte| *byte == b',').filter(|_| decimal && digits)? as u64;
                Some(Edit::replace(at.start + comma..at.start + comma + 1, "."))
            }
            Invalid::Text => {
                let (cyrillic, latin) = cyrillic_twin(&String::from_utf8_lossy(text))?;
                Some(Edit::replace(at.start..at.start + cyrillic.len_utf8() as u64, latin))
            }
            Invalid::TooManyDigits | Invalid::UnclosedBracket | Invalid::TooLong => None,
        }
    }
}

/// What to say of bytes that are no word, comment or command.
fn not_of_the_dialect(shown: &str) -> (u16, Text, Text, Text) {
    if waits(shown) {
        return (
            105,
            both!("`{shown}` waits for another turret or channel", "`{shown}` ждёт другой суппорт или канал"),
            both!(
                "this program is one of several that run together",
                "эта программа — одна из нескольких, идущих вместе"
            ),
            both!(
                "correct the program of each turret apart, each with its own profile, without the waits, and put \
                     them back where they stood",
                "исправьте программу каждого суппорта отдельно, со своим профилем и без ожиданий, \
                     а затем верните их на место"
            ),
        );
    }
    if let Some((cyrillic, latin)) = cyrillic_twin(shown) {
        return (
            105,
            both!(
                "`{shown}` starts with a Cyrillic `{cyrillic}`",
                "`{shown}` начинается с русской буквы `{cyrillic}`"
            ),
            both!(
                "it looks like a Latin letter, and no control reads it",
                "она похожа на латинскую, но ни одна стойка её не прочтёт"
            ),
            both!("type the Latin `{latin}`", "наберите латинскую `{latin}`"),
        );
    }
    (
        105,
        both!(
            "`{shown}` is not a word, a comment or a command of this dialect",
            "`{shown}` — не слово, не комментарий и не команда этого диалекта"
        ),
        both!("expected a letter and a number", "ожидались буква и число"),
        both!(
            "if it is a remark, put it in a comment; if another control reads it, choose that one with `--dialect`",
            "пояснение заключите в комментарий; если это язык другой стойки, выберите её ключом `--dialect`"
        ),
    )
}

/// A mark at which controls with several channels wait for one another: `!1`, `WAITM(1,1,2)`.
fn waits(text: &str) -> bool {
    let upper = text.to_ascii_uppercase();
    text.starts_with('!') || ["WAITM", "WAITE", "WAITMC"].iter().any(|name| upper.starts_with(name))
}

/// The Latin letter that the text's first letter looks like, where that is Cyrillic (UTF-8).
fn cyrillic_twin(text: &str) -> Option<(char, char)> {
    const TWINS: [(char, char); 12] = [
        ('А', 'A'),
        ('В', 'B'),
        ('Е', 'E'),
        ('К', 'K'),
        ('М', 'M'),
        ('Н', 'H'),
        ('О', 'O'),
        ('Р', 'P'),
        ('С', 'C'),
        ('Т', 'T'),
        ('У', 'Y'),
        ('Х', 'X'),
    ];
    let first = text.chars().next()?;
    let upper = first.to_uppercase().next()?;
    let (_, latin) = TWINS.into_iter().find(|(cyrillic, _)| *cyrillic == upper)?;
    // Prose starts with such letters too: only a letter with a number is a mistyped word.
    let number =
        text.chars().nth(1).is_some_and(|next| next.is_ascii_digit() || matches!(next, '.' | '+' | '-'));
    number.then_some((first, latin))
}

/// The bytes as a person can read them: short, nothing that moves a terminal's cursor.
fn printable(bytes: &[u8]) -> String {
    const SHOWN: usize = 32;
    let cut = &bytes[..bytes.len().min(SHOWN)];
    let mut text: String =
        String::from_utf8_lossy(cut).chars().map(|c| if c.is_control() { '\u{FFFD}' } else { c }).collect();
    if cut.len() < bytes.len() {
        text.push('…');
    }
    text
}
