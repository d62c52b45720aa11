//! Files that are no table: what they are instead, and what to give.
//!
//! Asked only where a file was not read, so that nothing that is a table can be taken for something else.

use std::ops::Range;

use diagnostic::{Diagnostic, Text, both};

use crate::number::Mark;
use crate::refusal::{Codes, error};
use crate::text::Piece;

/// Lines of a file in which columns of numbers are looked for.
const LOOKED_AT: usize = 40;

/// What to say of a file that was refused, where its bytes say what it is.
pub(crate) fn instead(bytes: &[u8], text: &str, codes: Codes) -> Option<Diagnostic> {
    if let Some((what, help)) = container(bytes).or_else(|| markup(text)) {
        let message = both!("the file is no table: {what}", "файл — не таблица: {what:#}");
        return Some(Diagnostic::error(codes.unreadable, message).help(help));
    }
    without_header(text, codes)
}

/// Files that programs keep for themselves.
fn container(bytes: &[u8]) -> Option<(Text, Text)> {
    let as_csv = both!(
        "open it there and save the sheet as CSV UTF-8, or as Unicode text",
        "откройте его там и сохраните лист как CSV UTF-8 или как текст Юникод"
    );
    match bytes {
        [b'P', b'K', 3, 4, ..] => Some((
            both!(
                "it is a workbook of a spreadsheet (.xlsx, .ods), or an archive",
                "это книга электронных таблиц (.xlsx, .ods) или архив"
            ),
            as_csv,
        )),
        [0xD0, 0xCF, 0x11, 0xE0, ..] => Some((
            both!(
                "it is an old workbook (.xls), or the own file of an instrument's program",
                "это старая книга (.xls) или собственный файл программы прибора"
            ),
            both!(
                "{as_csv}; of an instrument's program export the readings as text",
                "{as_csv:#}; из программы прибора выведите отсчёты текстом"
            ),
        )),
        [b'%', b'P', b'D', b'F', ..] => Some((
            both!("it is a printed report (PDF)", "это напечатанный отчёт (PDF)"),
            both!(
                "export the readings from the instrument's program as text or CSV",
                "выведите отсчёты из программы прибора текстом или как CSV"
            ),
        )),
        _ => None,
    }
}

/// Texts of other kinds.
fn markup(text: &str) -> Option<(Text, Text)> {
    let start = text.trim_start();
    let head: String = start.chars().take(2000).collect();
    if start.starts_with('<') {
        if head.contains("<QIFDocument") {
            return Some((
                both!(
                    "it is QIF, which describes features of a part",
                    "это QIF: он описывает элементы детали"
                ),
                both!(
                    "write the points as CSV: nominal ones as x_mm,y_mm,z_mm, measured ones as xm_mm,ym_mm,zm_mm",
                    "запишите точки как CSV: номинальные — x_mm,y_mm,z_mm, измеренные — xm_mm,ym_mm,zm_mm"
                ),
            ));
        }
        if head.contains("MTConnect") {
            return Some((
                both!("it is an answer of an MTConnect agent", "это ответ агента MTConnect"),
                both!(
                    "a machine is begun from it by `vpost profile new --from FILE`",
                    "по нему начинают профиль: `vpost profile new --from ФАЙЛ`"
                ),
            ));
        }
        return Some((
            both!("it is XML", "это XML"),
            both!("export the readings as text or CSV", "выведите отсчёты текстом или как CSV"),
        ));
    }
    if start.starts_with('{') {
        return Some((
            both!("it is JSON", "это JSON"),
            both!("write its rows as CSV with a header", "запишите его строки как CSV с заголовком"),
        ));
    }
    let is_ini = ["[EMC]", "[TRAJ]", "[RS274NGC]", "[KINS]"].iter().any(|section| head.contains(section));
    is_ini.then(|| {
        (
            both!("it is the INI file of a LinuxCNC machine", "это INI-файл станка LinuxCNC"),
            both!(
                "zeros and tool lengths come from it by `--linuxcnc-ini FILE`, a profile by `vpost profile new --from FILE`",
                "нули и длины инструмента из него берёт `--linuxcnc-ini ФАЙЛ`, профиль — `vpost profile new --from ФАЙЛ`"
            ),
        )
    })
}

/// Columns of numbers that nothing names, or that are cut by spaces.
fn without_header(text: &str, codes: Codes) -> Option<Diagnostic> {
    let mut lines = Piece::lines(text)
        .map(Piece::trimmed)
        .filter(|line| !line.text.is_empty() && !line.text.starts_with('#'));
    // Lines that end as they did on old Apple computers are one to everybody else.
    let first = lines.next()?.before(&['\r']);
    let help = both!(
        "put a line above it that names the columns, as in run,x_mm,y_mm,z_mm,xm_mm,ym_mm,zm_mm: x_mm … what was commanded, xm_mm … what was measured",
        "добавьте сверху строку с именами столбцов, например run,x_mm,y_mm,z_mm,xm_mm,ym_mm,zm_mm: x_mm … — заданное, xm_mm … — измеренное"
    );
    if numbers(first.text) >= 2 {
        let message = both!(
            "the file has no header: its first line holds numbers",
            "в файле нет заголовка: в первой строке числа"
        );
        return Some(refusal(codes, message, &first, help));
    }
    let by_spaces = |line: &Piece<'_>| !line.text.contains([',', ';', '\t']) && numbers(line.text) >= 2;
    let row = lines.take(LOOKED_AT).find(by_spaces)?;
    let message = both!("the columns are set apart by spaces", "столбцы разделены пробелами");
    let help = both!(
        "put ; or a tab between the cells, in the header as well: a space may stand within a name",
        "поставьте между ячейками ; или табуляцию, и в заголовке тоже: пробел может стоять внутри имени"
    );
    Some(refusal(codes, message, &row, help))
}

fn refusal(codes: Codes, message: Text, line: &Piece<'_>, help: Text) -> Diagnostic {
    let span: Range<usize> = line.span();
    error(codes.column, message, &span, both!("this line", "эта строка"), help)
}

/// How many cells of a line are numbers, however they are set apart.
fn numbers(line: &str) -> usize {
    line.split([';', '\t', ' ', ','])
        .filter(|cell| Mark::Point.number(cell.trim().trim_matches('"')).is_some())
        .count()
}
