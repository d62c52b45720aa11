//! What a header of a column says, or why it says nothing.

use diagnostic::{Code, Diagnostic, Text, both, closest};

use crate::columns::{Column, Said, said};
use crate::refusal::error;
use crate::table::{Cell, Record, value};
use crate::unit::{Quantity, Unit};

/// A unit that stands alone in a cell.
pub(crate) fn lone_unit(text: &str, cell: &Cell, wanted: Option<Quantity>) -> Option<Unit> {
    Unit::named(value(text, cell).trim_matches(['[', ']', '(', ')']), wanted)
}

/// What headers mean.
pub(crate) struct Header<'h> {
    pub(crate) text: &'h str,
    pub(crate) known: &'h [Column],
    pub(crate) code: Code,
    /// Headers to pass over, where a command can be told them.
    pub(crate) ignore: Option<&'h [String]>,
    /// The row of units below.
    pub(crate) units: Option<Record>,
}

impl Header<'_> {
    /// Column of the kind and factor of a header.
    pub(crate) fn column(&self, at: usize, cell: &Cell) -> Result<(usize, f64), Diagnostic> {
        let known = self.known;
        let header = value(self.text, cell);
        let refuse = |message: Text, help: Text| {
            let message = both!("column `{header}`{message}", "столбец `{header}`{message:#}");
            Err(error(self.code, message, &cell.span, both!("this column", "этот столбец"), help))
        };
        let write = |place: usize| both!("write `{}`", "напишите `{}`", known[place].header());
        let below_cell = self.units.as_ref().map(|units| &units.cells[at]);
        let below =
            |place: usize| lone_unit(self.text, below_cell?, known[place].unit().map(|unit| unit.quantity));
        let wrong = |place: usize, unit: Unit| {
            let name = known[place].name();
            let Some(own) = known[place].unit().map(|unit| unit.quantity) else {
                return refuse(both!(": {name} has no unit", ": у {name} нет единицы"), write(place));
            };
            let units: Vec<&str> = Unit::of(own).collect();
            let message = both!(
                ": {name} is {}, {} is {}",
                ": {name} — {:#}, а {} — {:#}",
                own.name(),
                unit.name,
                unit.quantity.name()
            );
            let help = both!(
                "{}; units of {}: {}",
                "{:#}; единицы для величины «{:#}»: {}",
                write(place),
                own.name(),
                units.join(", ")
            );
            refuse(message, help)
        };
        match said(&header, known) {
            Said::Column { place, factor, unit } => match (unit, below(place), below_cell) {
                (Some(above), Some(below), Some(below_cell)) if above.name != below.name => {
                    let message = both!(
                        "column `{header}` is in {}, and the row below says {}",
                        "столбец `{header}` в {}, а строка под ним говорит {}",
                        above.name,
                        below.name
                    );
                    let label = both!("another unit", "другая единица");
                    let help = both!("leave one of the two out", "уберите одну из двух");
                    Err(error(self.code, message, &below_cell.span, label, help))
                }
                _ => Ok((place, factor)),
            },
            Said::NoUnit { place } => match below(place).zip(known[place].unit()) {
                Some((below, own)) if below.quantity == own.quantity => Ok((place, below.factor_to(own))),
                Some((below, _)) => wrong(place, below),
                None => refuse(both!(" says no unit", " не называет единицы"), write(place)),
            },
            Said::WrongUnit { place, unit } => wrong(place, unit),
            Said::TwoUnits { place, units: [a, b] } => refuse(
                both!(" says two units, {} and {}", " называет две единицы: {} и {}", a.name, b.name),
                write(place),
            ),
            Said::Several { places } => {
                let [a, b] = places.map(|place| known[place].header());
                let message = both!(" may be {a} or {b}", " — это {a} или {b}?");
                refuse(message, both!("write `{a}` or `{b}`", "напишите `{a}` или `{b}`"))
            }
            Said::Unknown => {
                let (message, help) = self.unknown(&header);
                refuse(message, help)
            }
        }
    }

    /// What to say of a header that no column has: message behind it, and help.
    fn unknown(&self, header: &str) -> (Text, Text) {
        if let Some(axis) = Column::axis_of_error_function(header) {
            let message = both!(
                " is an error function of {axis}, and the file is of another axis",
                " — функция погрешности оси {axis}, а файл другой оси"
            );
            let help = both!("give each axis a file of its own", "дайте каждой оси отдельный файл");
            return (message, help);
        }
        let names: Vec<String> = self.known.iter().map(Column::header).collect();
        if ["axis", "ось"].contains(&header.to_lowercase().as_str())
            && names.iter().any(|name| name == "position_mm")
        {
            return (
                both!(": a file holds the readings of one axis", ": в файле — отсчёты одной оси"),
                both!(
                    "split the rows by this column into a file for each axis, without it and with readings that name the axis (EXX_um in that of X, EYY_um in that of Y); then give all files to one command",
                    "разделите строки по этому столбцу на файлы, по одному на ось, без него и с отсчётами, названными по оси (EXX_um в файле X, EYY_um в файле Y); затем дайте все файлы одной команде"
                ),
            );
        }
        let near = closest(header, names.iter().map(String::as_str));
        let mut help =
            near.map_or(Text::EMPTY, |near| both!("did you mean {near}? ", "имелось в виду {near}? "));
        help.push(&both!("known here: {}", "здесь известны: {}", names.join(", ")));
        if self.ignore.is_some() {
            help.push(&both!(
                "; or pass it over with `--ignore-column {header}`",
                "; или пропустите его: `--ignore-column {header}`"
            ));
        }
        (both!(" is unknown", " неизвестен"), help)
    }
}
