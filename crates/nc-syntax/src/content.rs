//! Is this a part program at all?

use diagnostic::{Code, Diagnostic, Text, both};

use crate::lexer::is_blank;

const UTF_16: Text = Text::pair("text in UTF-16", "текст в UTF-16");
const UTF_16_TO_8: Text = Text::pair(
    "save it as plain text: `iconv -f UTF-16 -t UTF-8 IN > OUT`",
    "сохраните как обычный текст: `iconv -f UTF-16 -t UTF-8 IN > OUT`",
);

/// First bytes of files that people hand over by mistake, and what to do about it.
const MAGIC: [(&[u8], Text, Text); 13] = [
    (
        b"\x7FELF",
        Text::pair("a program for Linux (ELF)", "программа для Linux (ELF)"),
        Text::pair(
            "give the part program, not a program of the computer",
            "дайте управляющую программу станка, а не программу для компьютера",
        ),
    ),
    (
        b"MZ\x90",
        Text::pair("a program for Windows (EXE)", "программа для Windows (EXE)"),
        Text::pair(
            "give the part program, not a program of the computer",
            "дайте управляющую программу станка, а не программу для компьютера",
        ),
    ),
    (
        b"\x89PNG",
        Text::pair("a picture (PNG)", "картинка (PNG)"),
        Text::pair(
            "give the part program, not a picture of it",
            "дайте саму управляющую программу, а не её снимок",
        ),
    ),
    (
        b"\xFF\xD8\xFF",
        Text::pair("a picture (JPEG)", "картинка (JPEG)"),
        Text::pair(
            "give the part program, not a picture of it",
            "дайте саму управляющую программу, а не её снимок",
        ),
    ),
    (
        b"GIF8",
        Text::pair("a picture (GIF)", "картинка (GIF)"),
        Text::pair(
            "give the part program, not a picture of it",
            "дайте саму управляющую программу, а не её снимок",
        ),
    ),
    (
        b"PK\x03\x04",
        Text::pair("a ZIP archive or an office document", "архив ZIP или офисный документ"),
        Text::pair(
            "unpack it and give the part program inside",
            "распакуйте и дайте программу, которая внутри",
        ),
    ),
    (
        b"\x1F\x8B",
        Text::pair("a gzip archive", "архив gzip"),
        Text::pair(
            "unpack it (`gunzip`) and give the part program inside",
            "распакуйте (`gunzip`) и дайте программу, которая внутри",
        ),
    ),
    (
        b"7z\xBC\xAF",
        Text::pair("a 7-Zip archive", "архив 7-Zip"),
        Text::pair(
            "unpack it and give the part program inside",
            "распакуйте и дайте программу, которая внутри",
        ),
    ),
    (
        b"Rar!",
        Text::pair("a RAR archive", "архив RAR"),
        Text::pair(
            "unpack it and give the part program inside",
            "распакуйте и дайте программу, которая внутри",
        ),
    ),
    (
        b"%PDF-",
        Text::pair("a PDF document", "документ PDF"),
        Text::pair("give the part program itself", "дайте саму управляющую программу"),
    ),
    (
        b"\xD0\xCF\x11\xE0",
        Text::pair("an old office document", "старый офисный документ"),
        Text::pair("save it as plain text", "сохраните как обычный текст"),
    ),
    (b"\xFF\xFE", UTF_16, UTF_16_TO_8),
    (b"\xFE\xFF", UTF_16, UTF_16_TO_8),
];

/// How much of a file is looked at.
const SAMPLE: usize = 1 << 16;

/// Says whether the bytes can be a part program, before anything is read from them.
///
/// Looks at the first bytes only. Padding (NUL, tape leader) at either end is part of programs.
///
/// # Errors
/// VP0110 where nothing but blanks is there, VP0111 where the bytes are no text.
///
/// ```
/// use nc_syntax::looks_like_program;
///
/// assert!(looks_like_program(b"%\nG0 X1.\n%\n").is_ok());
/// // A drawing handed over by mistake is no program with thousands of unknown words.
/// assert!(looks_like_program(b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n").is_err());
/// assert!(looks_like_program(b" \n\n").is_err());
/// ```
pub fn looks_like_program(bytes: &[u8]) -> Result<(), Diagnostic> {
    let padding = |byte: &u8| is_blank(*byte) || matches!(byte, b'\r' | b'\n');
    let Some(start) = bytes.iter().position(|byte| !padding(byte)) else {
        let found = if bytes.is_empty() {
            both!("the file is empty", "файл пуст")
        } else {
            both!("the file holds nothing but blanks", "в файле одни пробелы")
        };
        return Err(Diagnostic::error(
            Code(110),
            both!("{found}: nothing to correct", "{found:#}: исправлять нечего"),
        )
        .help(both!(
            "check that the post processor wrote the program and that the name is right",
            "проверьте, записал ли постпроцессор программу и верно ли имя файла"
        )));
    };
    let binary = |what: &Text, help: Text| {
        Err(Diagnostic::error(
            Code(111),
            both!("this is {what}, not a part program", "это {what:#}, а не управляющая программа"),
        )
        .at(start as u64..start as u64 + 1, both!("no text from here on", "отсюда и дальше не текст"))
        .help(help))
    };
    for (magic, what, help) in MAGIC {
        // ELF starts with DEL, which is a blank elsewhere.
        if bytes.starts_with(magic) || bytes[start..].starts_with(magic) {
            return binary(&what, help);
        }
    }
    let end = bytes.iter().rposition(|byte| !padding(byte)).map_or(bytes.len(), |at| at + 1);
    let sample = &bytes[start..end.min(start + SAMPLE)];
    // Most programs hold no control characters but line ends, and each of thousands is asked.
    let odd = |byte: u8| (byte < 0x20) & (byte != b'\n') & (byte != b'\r');
    if !sample.iter().fold(false, |found, byte| found | odd(*byte)) {
        return Ok(());
    }
    let nul = sample.iter().filter(|byte| **byte == 0).count();
    let alternate = sample.chunks_exact(2).filter(|pair| (pair[0] == 0) != (pair[1] == 0)).count();
    if nul > 0 && alternate * 10 > sample.len() / 2 * 9 {
        return binary(
            &Text::pair("text in UTF-16", "текст в UTF-16"),
            Text::pair(
                "save it as plain text: `iconv -f UTF-16LE -t UTF-8 IN > OUT`",
                "сохраните как обычный текст: `iconv -f UTF-16LE -t UTF-8 IN > OUT`",
            ),
        );
    }
    let control = sample.iter().filter(|byte| **byte < 0x20 && !padding(byte)).count();
    // A run of NULs is padding wherever it stands, as between two programs of one tape.
    let runs = sample.chunk_by(|a, b| a == b).filter(|run| run[0] == 0).count();
    if (control + runs) * 20 > sample.len() - nul {
        return binary(
            &Text::pair("binary data", "двоичные данные"),
            Text::pair(
                "give the part program itself: plain text, one block per line",
                "дайте саму управляющую программу: обычный текст, в строке один кадр",
            ),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(bytes: &[u8]) -> Option<u16> {
        looks_like_program(bytes).err().map(|diagnostic| diagnostic.code.0)
    }

    #[test]
    fn programs_pass_whatever_pads_them() {
        let mut padded = vec![0; 400];
        padded.extend_from_slice(b"%\r\nG1 X1\r\n%\r\n\x1A");
        padded.extend_from_slice(&[0; 400]);
        for bytes in [
            &b"G1 X1\n"[..],
            b"%\nM2\n%",
            b"\xEF\xBB\xBFG1 X1",
            &padded,
            b"(\xCF\xF0\xE8\xE2\xE5\xF2)\nG0",
            b"M30",
        ] {
            assert_eq!(code(bytes), None);
        }
    }

    #[test]
    fn padding_may_stand_between_blocks() {
        let blocks = b"G1 X10.5 Y20.25\nG1 X11.5 Y21.75\n";
        assert_eq!(code(&[blocks, &[0; 60][..], blocks, &[0; 60], blocks].concat()), None);
    }

    #[test]
    fn nothing_is_named_as_nothing() {
        for bytes in [&b""[..], b"\n\r\n  \t", &[0; 100]] {
            assert_eq!(code(bytes), Some(110));
        }
    }

    #[test]
    fn other_files_are_named() {
        let utf16: Vec<u8> = b"G1 X10.5 Y20.25\r\n".iter().flat_map(|byte| [*byte, 0]).collect();
        let random: Vec<u8> = (0..4096_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        for bytes in [
            &b"\x7FELF\x02\x01\x01"[..],
            b"\x89PNG\r\n\x1A\n",
            b"PK\x03\x04\x14",
            b"\xFF\xFEG\0",
            &utf16,
            &random,
        ] {
            assert_eq!(code(bytes), Some(111));
        }
        let message = looks_like_program(b"PK\x03\x04").unwrap_err();
        assert_eq!(
            message.message.english(),
            "this is a ZIP archive or an office document, not a part program"
        );
    }
}
