//! The registry of columns: what may stand in a header, in which unit, between which bounds.

use diagnostic::Text;

use crate::unit::{CELSIUS, DEG, KG, MM, MM_MIN, RAD, SECOND, UM, URAD, Unit};

/// Columns that differ by a letter only: `x_mm`, `y_mm`, `z_mm`.
#[derive(Clone, Copy)]
struct Family {
    /// The name without its unit, `%` for the letter.
    name: &'static str,
    letters: Letters,
    /// Of the values that are read, and of the header that people are told to write; `None`: a plain number, or a text.
    units: Option<[Unit; 2]>,
    holds: Holds,
    /// Numbers outside are slips, in the unit of the values.
    range: [f64; 2],
    /// Why there are bounds; what to look for: in English and in Russian.
    beyond: [&'static str; 2],
    /// Other headers, without the unit, as [`plain`] leaves them; `%` for the letter.
    aliases: &'static [&'static str],
    /// The same with the other sign.
    opposite: Option<&'static str>,
}

/// What the cells of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Holds {
    Number,
    Text,
}

/// A column that a file may have.
#[derive(Clone, Debug)]
pub struct Column {
    family: &'static Family,
    letter: &'static str,
    /// By which rows give its values, with their unit: `x_mm`, `EXX_mm`.
    pub key: String,
}

impl std::fmt::Debug for Family {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// What stands for `%`, with spaces between.
type Letters = &'static str;

const XYZ: Letters = "x y z";
const ABC: Letters = "a b c";
const XYZABC: Letters = "x y z a b c";
const ONE: Letters = "";
const ERROR_FUNCTION: &str = "E%";
/// Direction of the error, then the axis that moves.
const TRANSLATIONS: Letters = "XX YX ZX XY YY ZY XZ YZ ZZ XA YA ZA XB YB ZB XC YC ZC";
const ROTATIONS: Letters = "AX BX CX AY BY CY AZ BZ CZ AA BA CA AB BB CB AC BC CC";
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

const PLAIN: Family = Family {
    name: "",
    letters: ONE,
    units: None,
    holds: Holds::Number,
    range: ANY,
    beyond: ["", ""],
    aliases: &[],
    opposite: None,
};
/// Places and lengths: no machine is a kilometre long.
const PLACE: Family = Family {
    units: Some([MM, MM]),
    range: [-1e6, 1e6],
    beyond: [
        "no machine is a kilometre long: check the unit",
        "станков длиной в километр не бывает: проверьте единицу",
    ],
    ..PLAIN
};
/// Deviations and their uncertainties.
const DEVIATION: Family = Family {
    units: Some([UM, UM]),
    range: [-1e7, 1e7],
    beyond: [
        "no machine deviates by ten metres: check the unit",
        "отклонений в десять метров не бывает: проверьте единицу",
    ],
    ..PLAIN
};
const TURN: Family = Family {
    units: Some([DEG, DEG]),
    range: [-1e6, 1e6],
    beyond: [
        "no axis turns so often: check the unit",
        "столько оборотов не делает ни одна ось: проверьте единицу",
    ],
    ..PLAIN
};
const TEMPERATURE: Family = Family {
    units: Some([CELSIUS, CELSIUS]),
    range: [-20.0, 60.0],
    beyond: [
        "workshops are colder or warmer only by mistake: is it kelvin or Fahrenheit? Give degrees Celsius",
        "такой температуры в цехе не бывает: это кельвины или градусы Фаренгейта? Дайте градусы Цельсия",
    ],
    ..PLAIN
};
const FEED: Family = Family {
    units: Some([MM_MIN, MM_MIN]),
    range: [0.0, 1e7],
    beyond: ["a feed is above zero: check the unit", "подача больше нуля: проверьте единицу"],
    ..PLAIN
};
const TEXT: Family = Family { holds: Holds::Text, ..PLAIN };

const fn of(base: Family, name: &'static str, letters: Letters, aliases: &'static [&'static str]) -> Family {
    Family { name, letters, aliases, ..base }
}

const POSITION: &str = "position";

static FAMILIES: &[Family] = &[
    of(TEXT, "run", ONE, &["серия", "проход", "линия", "установка", "set up", "setup"]),
    of(PLACE, "%", XYZ, &["command %", "nominal %", "координата %", "задано %", "% задано", "ось %"]),
    of(TURN, "%", ABC, &["angle %", "угол %", "поворот %", "ось %"]),
    of(TURN, "spindle", ONE, &["шпиндель", "угол шпинделя"]),
    of(
        Family { opposite: Some("c%"), ..DEVIATION },
        "d%",
        XYZ,
        &["d %", "delta %", "error %", "deviation %", "отклонение %", "погрешность %", "ошибка %"],
    ),
    of(DEVIATION, "d", ONE, &[]),
    of(DEVIATION, "deviation", ONE, &["radial deviation", "отклонение", "отклонение радиуса"]),
    of(TURN, "angle", ONE, &["угол"]),
    of(PLACE, "radius", ONE, &["радиус"]),
    of(TEXT, "plane", ONE, &["плоскость"]),
    of(PLACE, "%m", XYZ, &["actual %", "% measured", "измерено %", "% измерено", "факт %"]),
    of(PLACE, "length", ONE, &["distance", "bar length", "длина", "расстояние"]),
    of(PLACE, "b%", XYZ, &["centre %", "center %", "ball %", "центр %", "шар %"]),
    of(PLACE, "commanded_%", XYZ, &[]),
    of(PLACE, "measured_%", XYZ, &[]),
    of(PLAIN, "published_cos_%", XYZ, &[]),
    of(PLACE, "tool_%", XYZ, &["вылет %", "инструмент %"]),
    of(PLAIN, "dir_%", XYZABC, &["direction %", "направление %"]),
    of(PLAIN, "dir", ONE, &["direction", "направление"]),
    of(PLACE, POSITION, ONE, &["target", "позиция", "положение", "координата"]),
    of(TURN, POSITION, ONE, &["angle", "угол", "позиция", "положение"]),
    of(Family { units: Some([MM, UM]), ..PLAIN }, ERROR_FUNCTION, TRANSLATIONS, &[]),
    of(Family { units: Some([RAD, URAD]), ..PLAIN }, ERROR_FUNCTION, ROTATIONS, &[]),
    of(FEED, "feed", ONE, &["подача"]),
    of(Family { units: Some([KG, KG]), ..PLAIN }, "load", ONE, &["mass", "масса", "нагрузка"]),
    of(Family { units: Some([SECOND, SECOND]), ..PLAIN }, "time", ONE, &["время"]),
    of(TEMPERATURE, "temp", ONE, &["temperature", "температура"]),
    of(TEMPERATURE, "temp_%", XYZ, &["temperature %", "температура %"]),
    of(PLAIN, "repeat", ONE, &["повтор", "повторение"]),
    of(DEVIATION, "u", ONE, &["uncertainty", "неопределенность"]),
    of(DEVIATION, "u_%", XYZ, &["uncertainty %", "неопределенность %"]),
    of(TEXT, "instrument", ONE, &["прибор"]),
    of(TEXT, "artefact", ONE, &["artifact", "эталон", "мера"]),
    of(TEXT, "station", ONE, &["станция"]),
    of(TEXT, "part", ONE, &["деталь", "образец", "test piece"]),
    of(TEXT, "feature", ONE, &["элемент"]),
    of(TEXT, "tool", ONE, &["инструмент"]),
    of(PLACE, "diameter", ONE, &["диаметр"]),
    of(TEXT, "note", ONE, &["comment", "примечание", "комментарий"]),
];

impl Column {
    fn all() -> impl Iterator<Item = Self> {
        FAMILIES.iter().flat_map(|family| {
            family.letters.split(' ').map(move |letter| {
                let name = filled(family.name, letter);
                Self { family, letter, key: with_unit(&name, family.units.map(|units| units[0])) }
            })
        })
    }

    /// The column of this key.
    pub(crate) fn of(key: &str) -> Option<Self> {
        Self::all().find(|column| column.key == key)
    }

    /// The axis of which a header names an error function.
    pub(crate) fn axis_of_error_function(header: &str) -> Option<char> {
        let all: Vec<Self> = Self::all().filter(|column| column.family.name == ERROR_FUNCTION).collect();
        match said(header, &all) {
            Said::Column { place, .. } => all[place].letter.chars().nth(1),
            _ => None,
        }
    }

    /// The name without its unit: `dx`.
    #[must_use]
    pub fn name(&self) -> String {
        filled(self.family.name, self.letter)
    }

    /// The header to write: `dx_um`.
    #[must_use]
    pub fn header(&self) -> String {
        with_unit(&self.name(), self.family.units.map(|units| units[1]))
    }

    /// What values are given in.
    #[must_use]
    pub fn unit(&self) -> Option<Unit> {
        self.family.units.map(|units| units[0])
    }

    pub(crate) fn holds(&self) -> Holds {
        self.family.holds
    }

    /// Why this is no value of the column, where it is none.
    pub(crate) fn beyond(&self, value: f64) -> Option<Text> {
        let ([low, high], [english, russian]) = (self.family.range, self.family.beyond);
        (!(low..=high).contains(&value)).then(|| Text::pair(english, russian))
    }

    /// Sign of the column that this heading, without its unit, names; `None` where it names another.
    ///
    /// * `axis` – that of a table of error functions: `Position X` is the position there, and so is `X`
    fn is_named(&self, heading: &str, axis: Option<char>) -> Option<f64> {
        let mut heading = plain(heading);
        if let Some(axis) = axis.filter(|_| self.family.name == POSITION) {
            if heading.len() == 1 && heading.starts_with(axis) {
                return Some(1.0);
            }
            if heading.ends_with([' ', axis].iter().collect::<String>().as_str()) {
                heading.truncate(heading.len() - 2);
            }
        }
        let is = |pattern: &str| plain(&filled(pattern, self.letter)) == heading;
        if is(self.family.name) || self.family.aliases.iter().any(|alias| is(alias)) {
            return Some(1.0);
        }
        self.family.opposite.is_some_and(is).then_some(-1.0)
    }
}

fn filled(pattern: &str, letter: &str) -> String {
    pattern.replace('%', letter)
}

fn with_unit(name: &str, unit: Option<Unit>) -> String {
    unit.map_or_else(|| name.to_owned(), |unit| format!("{name}_{}", unit.name))
}

/// A heading as it is compared: small letters, one space for what stands between words, `d` for Δ, and Latin letters for the
/// Cyrillic ones that look like them in names of axes.
fn plain(heading: &str) -> String {
    let latin = |word: &str| -> Option<String> {
        let letter = |c| match c {
            'х' => Some('x'),
            'у' => Some('y'),
            'а' => Some('a'),
            'в' => Some('b'),
            'с' => Some('c'),
            'е' => Some('e'),
            'a'..='z' => Some(c),
            _ => None,
        };
        (word.chars().count() <= 3).then(|| word.chars().map(letter).collect())?
    };
    let lower = heading.to_lowercase().replace('ё', "е").replace(['δ', '∆'], "d").replace('№', "no ");
    let words = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(|word| latin(word).unwrap_or_else(|| word.to_owned())).collect::<Vec<_>>().join(" ")
}

/// What a header says.
#[derive(Debug)]
pub(crate) enum Said {
    /// Its cells are values of this column of the list, to be multiplied by this.
    Column {
        place: usize,
        factor: f64,
        unit: Option<Unit>,
    },
    /// A column of the list that has units, and none is said.
    NoUnit {
        place: usize,
    },
    /// A column of the list with a unit that it cannot have.
    WrongUnit {
        place: usize,
        unit: Unit,
    },
    /// Two units.
    TwoUnits {
        place: usize,
        units: [Unit; 2],
    },
    /// Several columns of the list.
    Several {
        places: [usize; 2],
    },
    Unknown,
}

/// Reads a header: `x_mm`, `x, mm`, `dx [um]`, `Отклонение X (мкм)`, `EXX_arcsec`.
pub(crate) fn said(header: &str, known: &[Column]) -> Said {
    // As it is written in most files, with no way to read it otherwise.
    if let Some(place) = known.iter().position(|column| column.key == header || column.header() == header) {
        let unit = if known[place].key == header { 0 } else { 1 };
        return of_unit(place, &known[place], 1.0, known[place].family.units.map(|units| units[unit]));
    }
    let (mut rest, mut units): (&str, Vec<&str>) = (header.trim(), Vec::new());
    let axis = only_axis(known);
    // The same spelling may be several units (с: °C and seconds): the column says which is meant.
    let unit_of = |place: usize, text: &str| {
        Unit::named(text, known[place].unit().map(|own| own.quantity)).expect("taken off as a unit")
    };
    loop {
        let named: Vec<(usize, f64)> = known
            .iter()
            .enumerate()
            .filter_map(|(place, column)| Some((place, column.is_named(rest, axis)?)))
            .collect();
        // Columns of one name differ in what they measure.
        let fits = |(place, _): &(usize, f64)| {
            units.first().is_none_or(|text| {
                known[*place].unit().is_some_and(|own| own.quantity == unit_of(*place, text).quantity)
            })
        };
        let fitting: Vec<_> = named.iter().copied().filter(fits).collect();
        match (named.as_slice(), fitting.as_slice()) {
            ([], _) => {}
            (_, [(place, sign)]) | ([(place, sign)], _) => {
                let said: Vec<Unit> = units.iter().map(|text| unit_of(*place, text)).collect();
                return match said[..] {
                    [a, b, ..] if a.name != b.name => Said::TwoUnits { place: *place, units: [b, a] },
                    _ => of_unit(*place, &known[*place], *sign, said.first().copied()),
                };
            }
            (_, [(a, _), (b, _), ..]) | ([(a, _), (b, _), ..], _) => {
                return Said::Several { places: [*a, *b] };
            }
        }
        let Some((shorter, unit)) = without_unit(rest) else { return Said::Unknown };
        rest = shorter;
        units.push(unit);
    }
}

/// The axis of the error functions in the list, in small; `None` where there are none, or of several axes.
fn only_axis(known: &[Column]) -> Option<char> {
    let functions = known.iter().filter(|column| column.family.name == ERROR_FUNCTION);
    let mut axes = functions.filter_map(|column| column.letter.chars().nth(1));
    let first = axes.next()?;
    axes.all(|axis| axis == first).then(|| first.to_ascii_lowercase())
}

fn of_unit(place: usize, column: &Column, sign: f64, unit: Option<Unit>) -> Said {
    match (column.unit(), unit) {
        (None, None) => Said::Column { place, factor: sign, unit },
        (Some(own), Some(unit)) if own.quantity == unit.quantity => {
            Said::Column { place, factor: sign * unit.factor_to(own), unit: Some(unit) }
        }
        (_, Some(unit)) => Said::WrongUnit { place, unit },
        (Some(_), None) => Said::NoUnit { place },
    }
}

/// A heading without the unit at its end, and that: in brackets, behind a comma, a space, an underline or a stroke.
fn without_unit(heading: &str) -> Option<(&str, &str)> {
    let is_unit = |text: &str| Unit::named(text, None).is_some();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, inner)) = heading.strip_suffix(close).and_then(|rest| rest.rsplit_once(open)) {
            return Some((name.trim(), inner)).filter(|_| is_unit(inner));
        }
    }
    let ends = heading.match_indices([',', ' ', '_', '/']);
    let mut parts = ends.map(|(at, mark)| (heading[..at].trim(), &heading[at + mark.len()..]));
    parts.find(|(name, unit)| !name.is_empty() && is_unit(unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(keys: &[&str]) -> Vec<Column> {
        keys.iter().map(|key| Column::of(key).expect("a column")).collect()
    }

    #[test]
    fn headers_of_people() {
        let known =
            columns(&["run", "x_mm", "a_deg", "dx_um", "temp_c", "time_s", "tool_x_mm", "feed_mm_min"]);
        for (header, key, factor) in [
            ("x_mm", "x_mm", 1.0),
            ("x, mm", "x_mm", 1.0),
            ("X [mm]", "x_mm", 1.0),
            ("Х, мм", "x_mm", 1.0),
            ("x_m", "x_mm", 1e3),
            ("Задано X (мм)", "x_mm", 1.0),
            ("dx [um]", "dx_um", 1.0),
            ("ΔX, мкм", "dx_um", 1.0),
            ("dx_mm", "dx_um", 1e3),
            ("Отклонение X мкм", "dx_um", 1.0),
            ("cx_um", "dx_um", -1.0),
            ("Угол А, град", "a_deg", 1.0),
            ("Температура, °С", "temp_c", 1.0),
            ("Время, с", "time_s", 1.0),
            ("Подача, мм/мин", "feed_mm_min", 1.0),
            ("Вылет X, мм", "tool_x_mm", 1.0),
            ("Серия", "run", 1.0),
        ] {
            let Said::Column { place, factor: found, .. } = said(header, &known) else {
                panic!("{header}: {:?}", said(header, &known))
            };
            assert_eq!((known[place].key.as_str(), (found / factor * 1e9).round()), (key, 1e9), "{header}");
        }
        assert!(matches!(said("X", &known), Said::NoUnit { place: 1 }));
        // A table of one axis may name it beside the position; of another it is not the position.
        let known = columns(&["position_mm", "EXX_mm", "EYX_mm"]);
        for header in ["Положение X, мм", "Позиция Х (мм)", "Target X [mm]", "X, мм", "position_mm"]
        {
            assert!(matches!(said(header, &known), Said::Column { place: 0, .. }), "{header}");
        }
        assert!(matches!(said("Положение Y, мм", &known), Said::Unknown));
        let several = columns(&["position_mm", "EXX_mm", "EYY_mm"]);
        assert!(matches!(said("Положение X, мм", &several), Said::Unknown));
        let known =
            columns(&["run", "x_mm", "a_deg", "dx_um", "temp_c", "time_s", "tool_x_mm", "feed_mm_min"]);
        assert!(matches!(said("x_mm [um]", &known), Said::TwoUnits { place: 1, .. }));
        assert!(matches!(said("dx_deg", &known), Said::WrongUnit { place: 3, .. }));
        assert!(matches!(said("run, mm", &known), Said::WrongUnit { place: 0, .. }));
        assert!(matches!(said("dz_um", &known), Said::Unknown));
    }

    /// No name of a column is another's as well, in the kind of file that has most of them.
    #[test]
    fn names_are_those_of_one_column() {
        let keys = "run x_mm y_mm a_deg b_deg dx_um dy_um d_um xm_mm ym_mm length_mm bx_mm by_mm dir_x dir_y \
                    feed_mm_min tool_x_mm tool_y_mm load_kg time_s temp_c temp_x_c repeat u_um u_x_um instrument \
                    artefact station note spindle_deg";
        let known = columns(&keys.split_whitespace().collect::<Vec<_>>());
        for (place, column) in known.iter().enumerate() {
            let names = column.family.aliases.iter().chain([&column.family.name]);
            for name in names.map(|name| filled(name, column.letter)) {
                let header =
                    column.unit().map_or_else(|| name.clone(), |unit| format!("{name}, {}", unit.name));
                let found = said(&header, &known);
                assert!(
                    matches!(found, Said::Column { place: own, .. } if own == place),
                    "{header}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn error_functions_are_known_by_symbol_and_unit() {
        let known = columns(&["position_mm", "EXX_mm", "EAX_rad"]);
        for (header, place, factor) in
            [("EXX_um", 1, 1e-3), ("EXX_mm", 1, 1.0), ("EAX_um_per_mm", 2, 1e-3), ("EAX_urad", 2, 1e-6)]
        {
            let Said::Column { place: found, factor: by, .. } = said(header, &known) else {
                panic!("{header}")
            };
            assert_eq!((found, by), (place, factor), "{header}");
        }
        assert!(matches!(said("EAX_um", &known), Said::WrongUnit { .. }));
        assert!(matches!(said("EXX", &known), Said::NoUnit { .. }));
    }
}
