//! A file of an instrument or a control, and what is read of it.

use std::ops::Range;

use diagnostic::{Code, Diagnostic, Text, both};
use machine_model::Axis;

use crate::codes::{QUESTION, UNREADABLE};
use crate::number::Mark;
use crate::refusal::{Refusal, error};
use crate::text::Piece;
use crate::unit::{MM, Quantity, RAD, Unit};

/// What numbers of a control's table mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Where the axis really was (LinuxCNC COMP_FILE_TYPE = 0).
    Positions,
    /// Actual minus nominal.
    Errors,
    /// What the control adds: nominal minus actual (LinuxCNC COMP_FILE_TYPE = 1).
    Corrections,
}

/// Which way an axis passed its targets in runs whose titles do not say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ways {
    /// Runs 1, 3, 5 … towards plus, the others towards minus.
    Alternating,
    /// All towards plus.
    Up,
    /// All towards minus.
    Down,
}

impl Ways {
    /// Of a run, from 1.
    pub(super) fn of(self, run: usize) -> i8 {
        match self {
            Self::Up => 1,
            Self::Alternating if run % 2 == 1 => 1,
            Self::Alternating | Self::Down => -1,
        }
    }
}

/// What kind of numbers a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// What an instrument read, from its own zero and against its own straightedge.
    Instrument,
    /// Functions of a control's model.
    Control,
    /// The same, at the carriage maybe (ISG).
    ControlAtCarriage,
}

/// One reading of an error function.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesReading {
    /// Run, by any name.
    pub run: String,
    /// Target position of the axis, mm.
    pub position_mm: f64,
    /// Deviation, mm or rad.
    pub value: f64,
    /// Direction of approach: -1, +1, 0 where unknown.
    pub direction: i8,
    /// How warm it was, °C, where the file says it.
    pub temperature_c: Option<f64>,
}

/// Readings of one error function.
#[derive(Clone, Debug)]
pub struct Series {
    /// The axis that moved.
    pub axis: Axis,
    /// 0 to 5: EX EY EZ EA EB EC.
    pub function: usize,
    /// In the order of the file.
    pub readings: Vec<SeriesReading>,
    /// The file.
    pub source: String,
    /// What kind of numbers they are.
    pub origin: Origin,
}

impl Series {
    pub(super) fn new(axis: Axis, function: usize, source: &str, origin: Origin) -> Self {
        Self { axis, function, readings: Vec::new(), source: source.to_owned(), origin }
    }

    pub(super) fn push(&mut self, run: &str, position_mm: f64, value: f64, direction: i8) {
        let run = run.to_owned();
        self.readings.push(SeriesReading { run, position_mm, value, direction, temperature_c: None });
    }

    /// `EXX`.
    #[must_use]
    pub fn name(&self) -> String {
        format!("E{}{}", Axis::ALL[self.function], self.axis)
    }

    /// Further runs of the same function, from a file of their own.
    pub fn append(&mut self, other: Self) {
        let file = other.source;
        let renamed = other.readings.into_iter();
        self.readings.extend(renamed.map(|r| SeriesReading { run: format!("{file}:{}", r.run), ..r }));
    }
}

/// What a file holds.
#[derive(Clone, Debug, Default)]
pub struct Content {
    /// One for each error function.
    pub series: Vec<Series>,
    /// XY, ZX, YZ as the file has them, rad.
    pub angles_rad: Option<[f64; 3]>,
}

impl From<Vec<Series>> for Content {
    fn from(series: Vec<Series>) -> Self {
        Self { series, angles_rad: None }
    }
}

/// What a file may need to be told.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told<'t> {
    /// Function (0 to 5) and axis: `EXX` of `FILE=EXX:um`.
    pub symbol: Option<(usize, Axis)>,
    /// Unit of the deviations.
    pub unit: Option<&'t str>,
    /// What a control's numbers are.
    pub values: Option<Values>,
    /// How runs went that do not say it.
    pub ways: Option<Ways>,
}

/// `EXX`: function and axis.
#[must_use]
pub fn symbol(text: &str) -> Option<(usize, Axis)> {
    let letters: Vec<char> = text.chars().collect();
    let [error, direction, axis] = letters[..] else { return None };
    let direction = Axis::from_letter(direction.to_ascii_uppercase())?;
    let axis = Axis::from_letter(axis.to_ascii_uppercase()).filter(|a| a.is_linear())?;
    error.eq_ignore_ascii_case(&'E').then_some((direction as usize, axis))
}

/// A file that is read.
pub(super) struct File<'f> {
    pub(super) name: &'f str,
    pub(super) text: &'f str,
    pub(super) told: Told<'f>,
}

impl<'f> File<'f> {
    /// Lines that say something.
    pub(super) fn lines(&self) -> impl Iterator<Item = Piece<'f>> + Clone + use<'f> {
        Piece::lines(self.text).map(Piece::trimmed).filter(|line| !line.text.is_empty())
    }

    pub(super) fn refuse(&self, code: Code, span: Range<usize>, message: Text, help: Text) -> Box<Refusal> {
        Refusal::of(self.name, self.text, error(code, message, &span, both!("here", "здесь"), help))
    }

    pub(super) fn damaged(&self, span: Range<usize>, message: Text) -> Box<Refusal> {
        let help = both!("the file is damaged; export it again", "файл повреждён; выведите его снова");
        self.refuse(UNREADABLE, span, message, help)
    }

    pub(super) fn question(&self, message: &Text, help: Text) -> Box<Refusal> {
        Refusal::without_text(
            Diagnostic::error(QUESTION, both!("{} {message}", "{} {message:#}", self.name)).help(help),
        )
    }

    pub(super) fn function(&self) -> Result<(usize, Axis), Box<Refusal>> {
        self.told.symbol.ok_or_else(|| {
            let message = both!(
                "does not say which error function it holds",
                "не говорит, какая в нём функция погрешности"
            );
            let help = both!(
                "write `{}=EXX:um`: the standard's symbol and the unit of the deviations",
                "напишите `{}=EXX:um`: обозначение по стандарту и единицу отклонений",
                self.name
            );
            self.question(&message, help)
        })
    }

    /// mm or rad per unit; `known`: the unit that the file says.
    pub(super) fn factor(&self, function: usize, known: Option<&str>) -> Result<f64, Box<Refusal>> {
        let own = if function < 3 { MM } else { RAD };
        let wanted = if own.quantity == Quantity::Length { "um, mm" } else { "urad, arcsec, um_per_mm, rad" };
        let Some(unit) = self.told.unit.or(known) else {
            return Err(self.question(&both!("does not say the unit of its deviations", "не говорит, в какой единице отклонения"),
                both!("write it behind the symbol, as in `{}=EXX:um`; um or mm for lengths, urad, arcsec, um_per_mm or rad for angles", "напишите её после обозначения, например `{}=EXX:um`; um или mm для длин, urad, arcsec, um_per_mm или rad для углов",
                    self.name
                ),
            ));
        };
        let found = Unit::named(unit, Some(own.quantity)).filter(|unit| unit.quantity == own.quantity);
        let refusal = || {
            let message = both!(
                "{}: `{unit}` is no unit of this function",
                "{}: `{unit}` — не единица этой функции",
                self.name
            );
            Refusal::without_text(
                Diagnostic::error(QUESTION, message).help(both!("one of: {wanted}", "одно из: {wanted}")),
            )
        };
        Ok(found.ok_or_else(refusal)?.factor_to(own))
    }

    pub(super) fn values(&self, options: &Text) -> Result<Values, Box<Refusal>> {
        self.told.values.ok_or_else(|| {
            let message = both!(
                "is a control's table: are its numbers what the axis did, or what the control adds?",
                "— таблица стойки: её числа — отклонения оси или то, что прибавляет стойка?"
            );
            self.question(&message, both!("add `--values {options}`", "добавьте `--values {options:#}`"))
        })
    }
}

/// All words of a line as numbers.
pub(super) fn numbers(line: &str) -> Option<Vec<f64>> {
    line.split([' ', '\t', ';', ',']).filter(|w| !w.is_empty()).map(|w| Mark::Point.number(w)).collect()
}
