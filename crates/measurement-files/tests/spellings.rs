//! One table, however it is written, reads to the same values; what two readings are possible of is refused.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use diagnostic::Text;
use measurement_files::{Codes, Kind, Sheet, decoded};
use proptest::prelude::*;

const KIND: Kind<'_> = Kind {
    columns: "run x_mm y_mm dx_um temp_c note",
    expected: Text::pair("expected: run,x_mm,y_mm,dx_um", "ожидалось: run,x_mm,y_mm,dx_um"),
    passes_over: None,
    may_be_empty: false,
    codes: Codes::MEASUREMENTS,
};
const NUMBERS: [&str; 4] = ["x_mm", "y_mm", "dx_um", "temp_c"];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Utf8,
    Utf8WithMark,
    Windows1251,
    Cp866,
    Utf16Little,
    Utf16Big,
}

/// How a spreadsheet of one country, or one program, writes a table.
#[derive(Clone, Debug)]
struct Spelling {
    separator: char,
    comma: bool,
    encoding: Encoding,
    line_end: &'static str,
    /// Separators behind the last cell, rows of separators at the end.
    trailing: usize,
    quoted: bool,
    comments: bool,
    russian: bool,
    says_separator: bool,
}

fn spelling() -> impl Strategy<Value = Spelling> {
    let encoding = prop_oneof![
        Just(Encoding::Utf8),
        Just(Encoding::Utf8WithMark),
        Just(Encoding::Windows1251),
        Just(Encoding::Cp866),
        Just(Encoding::Utf16Little),
        Just(Encoding::Utf16Big)
    ];
    let line_end = prop_oneof![Just("\n"), Just("\r\n"), Just("\r")];
    let separator = prop_oneof![Just(','), Just(';'), Just('\t')];
    (separator, any::<bool>(), encoding, line_end, 0..3_usize, any::<[bool; 4]>()).prop_map(
        |(separator, comma, encoding, line_end, trailing, [quoted, comments, russian, says_separator])| {
            Spelling {
                separator,
                comma,
                encoding,
                line_end,
                trailing,
                // A comma within cells that are cut at commas needs quotes.
                quoted: quoted || (separator == ',' && (comma || russian)),
                comments,
                russian,
                says_separator,
            }
        },
    )
}

/// Counts of thousandths, so that no rounding stands between the spellings.
type Line = (u8, i32, i32, i32, i32);

impl Spelling {
    fn number(&self, thousandths: i32) -> String {
        let text = format!(
            "{}{}.{:03}",
            if thousandths < 0 { "-" } else { "" },
            thousandths.abs() / 1000,
            thousandths.abs() % 1000
        );
        if self.comma { text.replace('.', ",") } else { text }
    }

    fn written(&self, lines: &[Line]) -> Vec<u8> {
        let mut rows: Vec<Vec<String>> = Vec::new();
        let header: [&str; 6] = if self.russian {
            ["Серия", "Задано X, мм", "Y [мм]", "Отклонение X (мкм)", "Температура, °C", "Примечание"]
        } else {
            ["run", "x_mm", "y_mm", "dx_um", "temp_c", "note"]
        };
        rows.push(header.map(str::to_owned).to_vec());
        for (run, x, y, dx, t) in lines {
            let numbers = [x, y, dx, t].map(|v| self.number(*v));
            rows.push(
                [vec![format!("серия {run}")], numbers.to_vec(), vec!["5,5 \"кг\"; ok".to_owned()]].concat(),
            );
        }
        let mut text = String::new();
        if self.says_separator {
            text += &format!("sep={}{}", self.separator, self.line_end);
        }
        if self.comments {
            text += &format!("# 1,5; written by hand{0}{0}", self.line_end);
        }
        let behind = self.separator.to_string().repeat(self.trailing);
        for (number, row) in rows.iter().enumerate() {
            let cells: Vec<String> = row
                .iter()
                .map(|cell| {
                    if self.quoted || cell.contains(['"', self.separator]) {
                        format!("\"{}\"", cell.replace('"', "\"\""))
                    } else {
                        cell.clone()
                    }
                })
                .collect();
            text += &format!("{}{behind}{}", cells.join(&self.separator.to_string()), self.line_end);
            if self.comments && number == 1 {
                text += &format!("# a pause{}", self.line_end);
            }
        }
        for _ in 0..self.trailing {
            text += &format!("{}{}", self.separator.to_string().repeat(5), self.line_end);
        }
        self.encoded(&text)
    }

    fn encoded(&self, text: &str) -> Vec<u8> {
        match self.encoding {
            Encoding::Utf8 => text.as_bytes().to_vec(),
            Encoding::Utf8WithMark => [b"\xEF\xBB\xBF", text.as_bytes()].concat(),
            Encoding::Cp866 => cp866(text),
            Encoding::Windows1251 => encoding_rs::WINDOWS_1251.encode(text).0.into_owned(),
            Encoding::Utf16Little => {
                [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
            }
            Encoding::Utf16Big => {
                [0xFE, 0xFF].into_iter().chain(text.encode_utf16().flat_map(u16::to_be_bytes)).collect()
            }
        }
    }
}

fn line() -> impl Strategy<Value = Line> {
    let wide = -2_000_000..2_000_000_i32;
    (any::<u8>(), wide.clone(), wide.clone(), wide, 15_000..25_000_i32)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    /// The values are those of the plain table, whatever the spelling; or, where every comma could stand between thousands,
    /// a refusal.
    #[test]
    fn one_table_reads_the_same_in_every_spelling(lines in prop::collection::vec(line(), 1..12), spelling in spelling()) {
        let bytes = spelling.written(&lines);
        let sheet = match Sheet::read("a.csv", &bytes, &KIND, None) {
            Ok(sheet) => sheet,
            Err(refusal) => {
                let message = refusal.diagnostic.message.english();
                prop_assert!(spelling.comma && message.contains("no other number tells which"), "{message}");
                // Nothing in the table speaks for a decimal comma: every number could be a thousand times larger.
                let could_be_group = |v: i32| (1..1000).contains(&(v.abs() / 1000));
                prop_assert!(lines.iter().all(|(_, x, y, dx, t)| [*x, *y, *dx, *t].into_iter().all(could_be_group)));
                return Ok(());
            }
        };
        prop_assert_eq!(sheet.rows().len(), lines.len());
        for (row, (run, x, y, dx, t)) in sheet.rows().zip(&lines) {
            prop_assert_eq!(row.text("run"), format!("серия {run}"));
            prop_assert_eq!(row.text("note"), "5,5 \"кг\"; ok");
            for (key, thousandths) in NUMBERS.into_iter().zip([x, y, dx, t]) {
                let written: f64 = Spelling { comma: false, ..spelling.clone() }.number(*thousandths).parse().unwrap();
                prop_assert_eq!(row.number(key), Ok(Some(written)));
            }
        }
    }

    /// Whatever the bytes: values, or a refusal whose place lies in the text.
    #[test]
    fn any_bytes_are_answered(bytes in prop::collection::vec(prop_oneof![any::<u8>(), prop::sample::select(b"run,x_mm;\t\"#.0123456789\n\r-".to_vec())], 0..200), header: bool) {
        let bytes = if header { [b"run;x_mm;y_mm\n".as_slice(), &bytes].concat() } else { bytes };
        let read = Sheet::read("a.csv", &bytes, &KIND, None);
        let refusal = match read {
            Ok(sheet) => sheet.rows().find_map(|row| row.number("x_mm").err()),
            Err(refusal) => Some(refusal),
        };
        if let Some(refusal) = refusal {
            let text = decoded(&bytes);
            let span = refusal.diagnostic.span.unwrap_or(0..0);
            prop_assert!(text.get(span.start as usize..span.end as usize).is_some(), "{span:?}");
            prop_assert_eq!(refusal.source.map(|(_, text)| text), Some(text.into_owned()));
        }
    }
}

/// A text as a program under DOS writes it.
fn cp866(text: &str) -> Vec<u8> {
    let byte = |letter: char| match letter {
        'А'..='п' => 0x80 + (letter as u32 - 'А' as u32) as u8,
        'р'..='я' => 0xE0 + (letter as u32 - 'р' as u32) as u8,
        '°' => 0xF8,
        _ => u8::try_from(letter).ok().filter(u8::is_ascii).expect("a letter of the page"),
    };
    text.chars().map(byte).collect()
}

/// Message, what it points at, and help.
fn refused(text: &str) -> (String, String, String) {
    let read = Sheet::read("a.csv", text.as_bytes(), &KIND, Some(&[]));
    let refusal = match read {
        Ok(sheet) => sheet
            .rows()
            .find_map(|row| NUMBERS.into_iter().find_map(|key| row.number(key).err()))
            .unwrap_or_else(|| panic!("it is read: {text}")),
        Err(refusal) => refusal,
    };
    let span = refusal.diagnostic.span.unwrap_or(0..0);
    let place = text[span.start as usize..span.end as usize].to_owned();
    let help = refusal.diagnostic.help.unwrap_or_default();
    (refusal.diagnostic.message.english().to_owned(), place, help.english().to_owned())
}

fn check(text: &str, message: &str, place: &str, help: &str) {
    let found = refused(text);
    assert!(found.0.contains(message) && found.1 == place && found.2.contains(help), "{text}\n{found:?}");
}

#[test]
fn what_can_be_read_in_two_ways_is_refused() {
    check("run;x_mm\na;1,234\n", "`1,234` is 1.234 or 1234", "1,234", "other than three decimals");
    check(
        "run;x_mm;y_mm\na;1,5;2.5\n",
        "`1,5` has a comma where `2.5` has a point",
        "1,5",
        "all with a comma",
    );
    check("run;x_mm\na;1 234,5\n", "marks between its thousands", "1 234,5", "1234,5");
    check("run;x_mm\na;\"1,234.5\"\n", "marks between its thousands", "1,234.5", "1234.5");
    check("run;x_mm,y_mm\na;1,2\n", "can be read as 2 columns and as 2", "run;x_mm,y_mm", "one sign");
    check("run,x_mm,y_mm\na,1,5,2,5\n", "the row has 5 cells, the header 3", "a,1,5,2,5", "0.5, not 0,5");
    // One number elsewhere decides.
    let sheet = Sheet::read("a.csv", b"run;x_mm\na;1,234\na;0,5\n", &KIND, None).unwrap();
    assert_eq!(sheet.row(0).unwrap().number("x_mm"), Ok(Some(1.234)));
}

#[test]
fn units_that_contradict_their_header_are_refused() {
    check("run,x_mm [um]\na,1\n", "says two units, mm and um", "x_mm [um]", "write `x_mm`");
    check("run,\"x, deg\"\na,1\n", "x is a length, deg is an angle", "x, deg", "units of a length: mm, um");
    check("run,x\na,1\n", "column `x` says no unit", "x", "write `x_mm`");
    check(
        "run,x_mm,y_mm\n,mm,um\na,1,2\n",
        "column `y_mm` is in mm, and the row below says um",
        "um",
        "leave one",
    );
    check("run,x_mm\na,12.5 mm\n", "`12.5 mm` is not a number", "12.5 mm", "`x, mm`");
    check("run,x_mm,temp_c\na,1,293\n", "`293` cannot be temp_c", "293", "kelvin");
    check("run,x_mm\na,2e6\n", "`2e6` cannot be x_mm", "2e6", "check the unit");
    // A row of units below headers without them.
    let sheet = Sheet::read("a.csv", "run;X;dX\n;мм;мм\na;1,5;0,01\n".as_bytes(), &KIND, None).unwrap();
    let row = sheet.row(0).unwrap();
    assert_eq!((row.number("x_mm"), row.number("dx_um")), (Ok(Some(1.5)), Ok(Some(10.0))));
}

#[test]
fn rows_and_columns_that_do_not_fit_are_refused() {
    check("run,x_mm,y_mm\na,1\n", "the row has 2 cells, the header 3", "a,1", "empty ones where nothing");
    check("run,x_mm,x_mm\na,1,2\n", "column `x_mm` stands twice", "x_mm", "remove one");
    check("run,x_mm,\"X, mm\"\na,1,2\n", "stands twice: `x_mm` is the same", "X, mm", "remove one");
    check("run,x_nm_,y_mm\na,1,2\n", "column `x_nm_` is unknown", "x_nm_", "did you mean x_mm?");
    check("run,EXX_um,y_mm\na,1,2\n", "an error function of X", "EXX_um", "a file of its own");
    check("run,,x_mm\na,5,2\n", "a column without a name holds something", "5", "give the column a name");
    check("run,\"x_mm\na,1\n", "never closed", "\"", "close it");
    check("run,x_mm\n\"a\"b,1\n", "text behind a closing quote", "b", "two");
    check("run,x_mm\n", "no rows", "", "expected");
    check("", "empty", "", "expected");
    check("run,x_\0mm\na,1\n", "no text", "\0", "UTF-8");
}

/// What people bring in the place of a table; each kind was found in public repositories (docs/instruments.md).
#[test]
fn files_that_are_no_table_are_told_what_they_are() {
    let refused = |bytes: &[u8]| {
        let refusal = Sheet::read("a", bytes, &KIND, Some(&[])).expect_err("no table");
        let help = refusal.diagnostic.help.unwrap_or_default();
        (refusal.diagnostic.message.english().to_owned(), help.english().to_owned())
    };
    let cases: [(&[u8], &str, &str); 11] = [
        (b"PK\x03\x04\x14\0\x06\0", "a workbook", "CSV UTF-8"),
        (b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "an old workbook", "export the readings"),
        (b"%PDF-1.7\n%\xE2\xE3\n", "a printed report", "text or CSV"),
        (
            b"<?xml version=\"1.0\"?>\n<QIFDocument xmlns=\"x\">\n<A>1, 2</A>\n</QIFDocument>\n",
            "QIF",
            "xm_mm",
        ),
        (b"<MTConnectDevices><Header/></MTConnectDevices>\n", "MTConnect", "profile new --from"),
        (b"<data><p x=\"1\"/></data>\n", "it is XML", "export"),
        (b"{\"x\": [1, 2]}\n", "it is JSON", "header"),
        (b"[EMC]\nMACHINE = A\n[TRAJ]\nLINEAR_UNITS = mm\n", "INI file", "--linuxcnc-ini"),
        // Trackers, with a point's name and without.
        (b"2.612e+03 1.915e+02 -2.745e+01\n2.474e+03 5.049e+02 -2.172e+02\n", "no header", "x_mm"),
        (b"P5;-274.556;-3189.212;-248.113;;;;\r\nP6;-275.009;-3137.804;-9.537;;;;\r\n", "no header", "xm_mm"),
        // A coordinate measuring machine.
        (
            b"Plug Plate: 2130A\n\n  Meas X   Meas Y    Nom X\n -80.754 -215.282  -80.743\n",
            "by spaces",
            "; or a tab",
        ),
    ];
    for (bytes, message, help) in cases {
        let found = refused(bytes);
        assert!(
            found.0.contains(message) && found.1.contains(help),
            "{}: {found:?}",
            String::from_utf8_lossy(bytes)
        );
    }
}

/// Units as people write them beside a name, by the end of the column's key.
const UNITS_BESIDE: [(&str, &str); 7] = [
    ("_mm_min", ", мм/мин"),
    ("_mm", ", мм"),
    ("_um", " (мкм)"),
    ("_deg", " [град]"),
    ("_c", ", °C"),
    ("_kg", ", кг"),
    ("_s", ", с"),
];

/// Every name of a column that docs/reference.md promises is read as that column.
#[test]
fn headers_that_the_documents_promise_are_read() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference.md");
    let text = std::fs::read_to_string(path).expect("the reference");
    let table = text.split("| column | other names |").nth(1).expect("the table of names");
    let mut read = 0;
    for row in table.lines().skip(2).take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").collect();
        let keys = cells[0].split('`').skip(1).step_by(2);
        for (key, names) in keys.zip(cells[1].split("; ").filter(|names| !names.contains('`'))) {
            let unit = UNITS_BESIDE.iter().find(|(end, _)| key.ends_with(end)).map_or("", |(_, unit)| unit);
            let outside = names
                .split(" (")
                .next()
                .into_iter()
                .chain(names.split(')').nth(1))
                .flat_map(|n| n.split(", "));
            for name in outside.map(str::trim).filter(|name| !name.is_empty()) {
                let kind = Kind { columns: key, ..KIND };
                let table = format!("\"{name}{unit}\"\n1\n");
                let sheet = Sheet::read("a.csv", table.as_bytes(), &kind, None).unwrap_or_else(|refusal| {
                    panic!("{name}{unit}: {}", refusal.diagnostic.message.english())
                });
                assert!(sheet.has(key), "{name}{unit}");
                read += 1;
            }
        }
    }
    assert!(read > 70, "{read}");
}
