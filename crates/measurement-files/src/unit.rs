//! Units as people write them.

use diagnostic::Text;
use units::{Angle, Length};

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A length.
    Length,
    /// A plane angle, or a slope.
    Angle,
    /// A temperature.
    Temperature,
    /// A time.
    Time,
    /// A feed rate.
    Feed,
    /// A mass.
    Mass,
}

impl Quantity {
    /// As messages name it.
    #[must_use]
    pub fn name(self) -> Text {
        match self {
            Self::Length => Text::pair("a length", "длина"),
            Self::Angle => Text::pair("an angle", "угол"),
            Self::Temperature => Text::pair("a temperature", "температура"),
            Self::Time => Text::pair("a time", "время"),
            Self::Feed => Text::pair("a feed", "подача"),
            Self::Mass => Text::pair("a mass", "масса"),
        }
    }
}

/// A unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// As it stands behind a column's name: `um` of `dx_um`.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// How many mm, rad, °C, s, mm/min or kg it is.
    pub size: f64,
    /// How else people write it, small letters, no spaces and points, `u` for the sign of micro.
    spellings: &'static [&'static str],
}

const fn unit(name: &'static str, quantity: Quantity, size: f64, spellings: &'static [&'static str]) -> Unit {
    Unit { name, quantity, size, spellings }
}

pub(crate) const MM: Unit = unit("mm", Quantity::Length, 1.0, &["мм", "millimeter", "millimetre"]);
pub(crate) const UM: Unit =
    unit("um", Quantity::Length, Length::from_um(1.0).mm(), &["мкм", "micron", "microns"]);
pub(crate) const DEG: Unit =
    unit("deg", Quantity::Angle, Angle::from_deg(1.0).rad(), &["°", "град", "degree", "degrees"]);
pub(crate) const RAD: Unit = unit("rad", Quantity::Angle, 1.0, &["рад"]);
pub(crate) const URAD: Unit =
    unit("urad", Quantity::Angle, Angle::from_urad(1.0).rad(), &["мкрад", "um_per_m", "um/m", "мкм/м"]);
pub(crate) const CELSIUS: Unit = unit("c", Quantity::Temperature, 1.0, &["°c", "°с", "с", "degc", "celsius"]);
pub(crate) const SECOND: Unit = unit("s", Quantity::Time, 1.0, &["с", "сек", "sec"]);
pub(crate) const MM_MIN: Unit = unit("mm_min", Quantity::Feed, 1.0, &["mm/min", "мм/мин"]);
pub(crate) const KG: Unit = unit("kg", Quantity::Mass, 1.0, &["кг"]);

/// All that are read; none that needs an offset (kelvin, Fahrenheit).
static UNITS: [Unit; 19] = [
    MM,
    UM,
    unit("nm", Quantity::Length, 1e-6, &["нм"]),
    unit("m", Quantity::Length, 1e3, &["м"]),
    unit("inch", Quantity::Length, Length::from_inch(1.0).mm(), &["in", "дюйм"]),
    DEG,
    RAD,
    // A µm/mm is a milliradian.
    unit("um_per_mm", Quantity::Angle, 1e-3, &["um/mm", "мкм/мм", "mrad", "мрад", "mm/m", "мм/м"]),
    URAD,
    unit("arcsec", Quantity::Angle, Angle::from_arcsec(1.0).rad(), &["\"", "''", "″", "углс", "углсек"]),
    CELSIUS,
    SECOND,
    unit("min", Quantity::Time, 60.0, &["мин"]),
    unit("h", Quantity::Time, 3600.0, &["ч"]),
    MM_MIN,
    unit("m_min", Quantity::Feed, 1e3, &["m/min", "м/мин"]),
    unit("mm_s", Quantity::Feed, 60.0, &["mm/s", "мм/с"]),
    KG,
    unit("g", Quantity::Mass, 1e-3, &["г"]),
];

impl Unit {
    /// Units of this spelling; `wanted` comes first where the spelling has several (с: °C or seconds).
    pub(crate) fn named(text: &str, wanted: Option<Quantity>) -> Option<Self> {
        let text: String = text.trim().to_lowercase().replace(['µ', 'μ'], "u").replace([' ', '.'], "");
        let found = || UNITS.iter().filter(|u| u.name == text || u.spellings.contains(&text.as_str()));
        found().find(|unit| Some(unit.quantity) == wanted).or_else(|| found().next()).copied()
    }

    /// What numbers in this unit are multiplied by to be in another of the same quantity.
    pub(crate) fn factor_to(self, other: Self) -> f64 {
        // Exactly 1 for one and the same: what is written is then what is read.
        if self.name == other.name { 1.0 } else { self.size / other.size }
    }

    /// Units of a quantity, by name.
    pub(crate) fn of(quantity: Quantity) -> impl Iterator<Item = &'static str> {
        UNITS.iter().filter(move |unit| unit.quantity == quantity).map(|unit| unit.name)
    }
}
