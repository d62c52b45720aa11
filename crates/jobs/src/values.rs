//! Values of options: read once, where the command line is read.

mod given;
mod of_machine;

use diagnostic::{Language, Text, both};
use error_map::Plane;
pub use given::{Given, Unread, Value};
use machine_model::{EngineId, Range};
use nc_expand::Preset;
pub use of_machine::{AxisTable, Centre, Sense, SquarenessReadings, Travel};

fn finite(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|v| v.is_finite())
}

fn millimetres(text: &str) -> Option<f64> {
    /// A kilometre: no machine is larger, and sums of what is larger lose their micrometres.
    const FARTHEST_MM: f64 = 1e6;
    finite(text).filter(|v| v.abs() <= FARTHEST_MM)
}

fn three<T>(text: &str, of: impl Fn(&str) -> Option<T>) -> Option<[T; 3]> {
    let mut parts = text.split(',').map(of);
    let found = [parts.next()??, parts.next()??, parts.next()??];
    parts.next().is_none().then_some(found)
}

fn assignment(text: &str) -> Option<(&str, &str)> {
    text.split_once('=').map(|(name, value)| (name.trim(), value.trim()))
}

/// `X,Y,Z`, mm.
#[derive(Debug, Clone, Copy)]
pub struct Point3(pub [f64; 3]);

impl Value for Point3 {
    const WHAT: Text = Text::pair("millimetres", "миллиметры");
    const EXAMPLES: &'static [&'static str] = &["400,280,200"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        three(text, millimetres).map(Self).ok_or(None)
    }
}

/// `X,Y,Z`, mm, or some axes by name, rotary ones in degrees: where they stand.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    /// Of X, Y, Z; `None`: not said.
    pub linear_mm: [Option<f64>; 3],
    /// Of A, B, C; `None`: not said.
    pub rotary_deg: [Option<f64>; 3],
}

impl Value for Start {
    const WHAT: Text = Text::pair(
        "millimetres, or axes by name, rotary ones in degrees,",
        "миллиметры или оси по именам, поворотные в градусах,",
    );
    const EXAMPLES: &'static [&'static str] = &["400,280,200", "Z=300,A=0,C=90"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        if !text.contains('=') {
            let linear_mm = three(text, millimetres).ok_or(None)?;
            return Ok(Self { linear_mm: linear_mm.map(Some), rotary_deg: [None; 3] });
        }
        let mut places = [None; 6];
        for part in text.split(',') {
            let (name, value) = assignment(part).ok_or(None)?;
            let axis = ["X", "Y", "Z", "A", "B", "C"].iter().position(|axis| name.eq_ignore_ascii_case(axis));
            let Some(axis) = axis else {
                return Err(Some(both!("there is no axis `{name}`", "оси `{name}` нет")));
            };
            let value = if axis < 3 { millimetres(value) } else { finite(value) };
            if places[axis].replace(value.ok_or(None)?).is_some() {
                return Err(Some(both!("{name} is said twice", "{name} задана дважды")));
            }
        }
        let [x, y, z, a, b, c] = places;
        Ok(Self { linear_mm: [x, y, z], rotary_deg: [a, b, c] })
    }
}

/// `LX,LY,LZ`, mm, none below zero.
#[derive(Debug, Clone, Copy)]
pub struct Size3(pub [f64; 3]);

impl Value for Size3 {
    const WHAT: Text = Text::pair("millimetres", "миллиметры");
    const EXAMPLES: &'static [&'static str] = &["120,80,40"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        three(text, |part| millimetres(part).filter(|v| *v >= 0.0)).map(Self).ok_or(None)
    }
}

/// `G54=X,Y,Z`: machine coordinates of a zero, mm.
#[derive(Debug, Clone)]
pub struct WorkOffset {
    /// `G54`
    pub name: String,
    /// Machine coordinates, mm.
    pub zero_mm: [f64; 3],
}

impl Value for WorkOffset {
    const WHAT: Text = Text::pair("millimetres", "миллиметры");
    const EXAMPLES: &'static [&'static str] = &["G54=100,50,0"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (name, value) = assignment(text).ok_or(None)?;
        let zero_mm = three(value, millimetres).ok_or(None)?;
        Ok(Self { name: name.to_ascii_uppercase(), zero_mm })
    }
}

/// `H1=120`, or the vector `H1=0,0,120`, mm.
#[derive(Debug, Clone, Copy)]
pub struct ToolLength {
    /// 1 of `H1`.
    pub number: u32,
    /// From tip to gauge point, mm.
    pub vector_mm: [f64; 3],
}

fn h_number(text: &str) -> Option<u32> {
    text.strip_prefix(['H', 'h']).and_then(|digits| digits.parse().ok())
}

impl Value for ToolLength {
    const WHAT: Text = Text::pair("millimetres", "миллиметры");
    const EXAMPLES: &'static [&'static str] = &["H1=120", "H1=0,0,120"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (name, value) = assignment(text).ok_or(None)?;
        let vector_mm = three(value, millimetres).or_else(|| Some([0.0, 0.0, millimetres(value)?]));
        Ok(Self { number: h_number(name).ok_or(None)?, vector_mm: vector_mm.ok_or(None)? })
    }
}

/// From gauge point to tip: the length of an H number, or `X,Y,Z`, mm.
#[derive(Debug, Clone, Copy)]
pub enum ToolVector {
    /// Minus the length of this H number.
    Length(u32),
    /// mm.
    Vector([f64; 3]),
}

impl Value for ToolVector {
    const WHAT: Text = Text::pair("an H number, or millimetres,", "номер H или миллиметры");
    const EXAMPLES: &'static [&'static str] = &["H1", "0,0,-120"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let length = h_number(text).map(Self::Length);
        length.or_else(|| three(text, millimetres).map(Self::Vector)).ok_or(None)
    }
}

impl Value for EngineId {
    const WHAT: Text = Text::pair("its name", "его имя");
    const EXAMPLES: &'static [&'static str] = &["rigid-body"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        Self::from_name(text).ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|id| id.name()).collect();
            let near = diagnostic::closest(text, names.iter().copied());
            let near =
                near.map_or(Text::EMPTY, |near| both!("did you mean {near}? ", "имелось в виду {near}? "));
            Some(both!(
                "there is no such engine; {near}there are {}",
                "такого метода нет; {near:#}есть {}",
                names.join(", ")
            ))
        })
    }
}

impl Value for Language {
    const WHAT: Text = Text::pair("a language that vpost speaks", "язык, на котором говорит vpost,");
    const EXAMPLES: &'static [&'static str] = &["en", "ru"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        Self::from_name(text).ok_or(None)
    }
}

impl Value for Preset {
    const WHAT: Text = Text::pair("a variable and its value", "переменную и её значение");
    const EXAMPLES: &'static [&'static str] = &["\"#500=12.5\"", "\"#<depth>=2\"", "\"#1=#0\""];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        Self::parse(text).ok_or(None)
    }
}

/// A condition that effects depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// Of an axis, °C.
    Temperature(usize),
    /// Of all axes, °C.
    Temperatures,
    /// Since power-on, s.
    Time,
    /// Of the workpiece, kg.
    Load,
    /// mm/min.
    Feed,
}

impl Condition {
    const ALL: [(&'static str, Self); 7] = [
        ("temp_c", Self::Temperatures),
        ("temp_x_c", Self::Temperature(0)),
        ("temp_y_c", Self::Temperature(1)),
        ("temp_z_c", Self::Temperature(2)),
        ("time_s", Self::Time),
        ("load_kg", Self::Load),
        ("feed_mm_min", Self::Feed),
    ];

    /// As it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, known)| *known == self).expect("all are listed").0
    }

    fn is_temperature(self) -> bool {
        matches!(self, Self::Temperature(_) | Self::Temperatures)
    }
}

/// `temp_c=24,load_kg=100`
#[derive(Debug, Clone)]
pub struct Conditions(pub Vec<(Condition, f64)>);

impl Value for Conditions {
    const WHAT: Text = Text::pair("names and values", "имена и значения");
    const EXAMPLES: &'static [&'static str] = &["temp_c=24,load_kg=100"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let one = |part: &str| {
            let (name, value) = assignment(part)
                .ok_or_else(|| both!("`{part}` is not NAME=VALUE", "`{part}` — не ИМЯ=ЗНАЧЕНИЕ"))?;
            let (_, condition) =
                Condition::ALL.into_iter().find(|(known, _)| *known == name).ok_or_else(|| {
                    let names = Condition::ALL.map(|(known, _)| known).join(", ");
                    both!(
                        "there is no condition `{name}`; there are {names}",
                        "условия `{name}` нет; есть {names}"
                    )
                })?;
            let number =
                finite(value).ok_or_else(|| both!("`{value}` is no number", "`{value}` — не число"))?;
            if !condition.is_temperature() && number < 0.0 {
                return Err(both!("`{name}` cannot be below zero", "`{name}` не бывает меньше нуля"));
            }
            Ok((condition, number))
        };
        text.split(',').map(one).collect::<Result<_, Text>>().map(Self).map_err(Some)
    }
}

/// `A=30,C=90`, degrees, by axis; those that are not named are `None`.
#[derive(Debug, Clone, Copy)]
pub struct Rotary(pub [Option<f64>; 3]);

impl Value for Rotary {
    const WHAT: Text = Text::pair("degrees", "градусы");
    const EXAMPLES: &'static [&'static str] = &["A=30,C=90"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let mut angles = [None; 3];
        for part in text.split(',') {
            let (name, value) =
                assignment(part).ok_or_else(|| both!("AXIS=DEGREES is expected", "ожидалось ОСЬ=ГРАДУСЫ"))?;
            let axis = ["A", "B", "C"].iter().position(|known| known.eq_ignore_ascii_case(name));
            let axis =
                axis.ok_or_else(|| both!("the rotary axes are A, B and C", "поворотные оси — A, B и C"))?;
            angles[axis] =
                Some(finite(value).ok_or_else(|| both!("`{value}` is no number", "`{value}` — не число"))?);
        }
        Ok(Self(angles))
    }
}

/// `R=120,H=50,lead=B`: radius and height, mm, and a rotary axis by its letter.
#[derive(Debug, Clone, Copy)]
pub struct Ball {
    /// From the axis of the table, mm.
    pub radius_mm: f64,
    /// Above its centre, mm.
    pub height_mm: f64,
    /// The axis that turns slowest.
    pub lead: char,
}

impl Value for Ball {
    const WHAT: Text = Text::pair("millimetres and an axis", "миллиметры и ось");
    const EXAMPLES: &'static [&'static str] = &["R=120,H=50,lead=B"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (mut radius_mm, mut height_mm, mut lead) = (None, None, None);
        for part in text.split(',') {
            let (name, value) = assignment(part).ok_or(None)?;
            match name {
                "R" => radius_mm = finite(value).filter(|mm| *mm > 0.0),
                "H" => height_mm = finite(value),
                "lead" => lead = ['A', 'B', 'C'].into_iter().find(|axis| value == axis.to_string()),
                _ => return Err(None),
            }
        }
        match (radius_mm, height_mm, lead) {
            (Some(radius_mm), Some(height_mm), Some(lead)) => Ok(Self { radius_mm, height_mm, lead }),
            _ => Err(None),
        }
    }
}

/// `X0..X1,Y0..Y1,Z0..Z1`, mm, the lower end first.
#[derive(Debug, Clone, Copy)]
pub struct Region3(pub [Range; 3]);

impl Value for Region3 {
    const WHAT: Text = Text::pair("millimetres", "миллиметры");
    const EXAMPLES: &'static [&'static str] = &["100..220,50..130,20..60"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        three(text, range_mm).map(Self).ok_or(None)
    }
}

/// `100..220`, mm, the lower end first.
fn range_mm(text: &str) -> Option<Range> {
    let (low, high) = text.split_once("..")?;
    let range = Range { low: millimetres(low)?, high: millimetres(high)? };
    (range.low <= range.high).then_some(range)
}

/// `table=0..200,0..140,0..100`
#[derive(Debug, Clone)]
pub struct NamedRegion {
    /// `table`
    pub name: String,
    /// mm.
    pub ranges_mm: [Range; 3],
}

impl Value for NamedRegion {
    const WHAT: Text = Text::pair("a name and millimetres", "имя и миллиметры");
    const EXAMPLES: &'static [&'static str] = &["table=0..200,0..140,0..100"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        // Names may hold anything; the ranges hold no equals sign.
        let (name, ranges) = text.rsplit_once('=').ok_or(None)?;
        Ok(Self { name: name.trim().to_owned(), ranges_mm: Region3::read(ranges)?.0 })
    }
}

/// `XY=100`: a layer at a place of the third axis, mm; `XY`: all layers.
#[derive(Debug, Clone, Copy)]
pub struct Layer {
    /// Its plane.
    pub plane: Plane,
    /// Along its normal, mm.
    pub at_mm: Option<f64>,
}

impl Value for Layer {
    const WHAT: Text = Text::pair("a plane and millimetres", "плоскость и миллиметры");
    const EXAMPLES: &'static [&'static str] = &["XY=100", "XY"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (name, at_mm) = match assignment(text) {
            Some((name, at)) => (name, Some(millimetres(at).ok_or(None)?)),
            None => (text.trim(), None),
        };
        let plane = Plane::ALL.into_iter().find(|plane| plane.name().eq_ignore_ascii_case(name));
        Ok(Self { plane: plane.ok_or(None)?, at_mm })
    }
}

/// Nodes of three axes: how many, or from:to:step, mm.
#[derive(Debug, Clone, Copy)]
pub enum Lattice {
    /// Over the volume.
    Counts([u64; 3]),
    /// mm.
    Stepped([[f64; 3]; 3]),
}

impl Value for Lattice {
    const WHAT: Text =
        Text::pair("numbers of nodes, or from:to:step in mm,", "числа узлов или от:до:шаг в мм");
    const EXAMPLES: &'static [&'static str] = &["22x22x21", "40:880:40,30:450:20,5:505:25"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        if text.contains(':') {
            let stepped = three(text, |part| {
                let mut numbers = part.split(':').map(millimetres);
                let found = [numbers.next()??, numbers.next()??, numbers.next()??];
                numbers.next().is_none().then_some(found)
            });
            return stepped.map(Self::Stepped).ok_or_else(|| {
                Some(both!("three times from:to:step are expected", "ожидалось трижды от:до:шаг"))
            });
        }
        let counts = three(&text.replace(['x', 'X', '×'], ","), |part| part.trim().parse::<u64>().ok());
        counts
            .map(Self::Counts)
            .ok_or_else(|| Some(both!("three whole numbers are expected", "ожидались три целых числа")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused<T: Value>(text: &str) -> String {
        match text.parse::<Given<T>>() {
            Ok(_) => panic!("{text} was read"),
            Err(unread) => format!("{} / {}", unread.message("--o", text), unread.help("--o")),
        }
    }

    /// Whatever is an example can be read.
    fn examples<T: Value>() {
        for example in T::EXAMPLES {
            assert!(example.trim_matches('"').parse::<Given<T>>().is_ok(), "{example}");
        }
    }

    #[test]
    fn examples_can_be_read() {
        examples::<Point3>();
        examples::<Start>();
        examples::<Size3>();
        examples::<WorkOffset>();
        examples::<ToolLength>();
        examples::<ToolVector>();
        examples::<EngineId>();
        examples::<Preset>();
        examples::<Conditions>();
        examples::<Rotary>();
        examples::<SquarenessReadings>();
        examples::<Region3>();
        examples::<Travel>();
        examples::<AxisTable>();
        examples::<Centre>();
        examples::<Sense>();
        examples::<NamedRegion>();
        examples::<Layer>();
        examples::<Lattice>();
    }

    #[test]
    fn what_cannot_be_read_says_how_it_is_written() {
        assert_eq!(
            refused::<WorkOffset>("G54=1,2"),
            "`--o G54=1,2` cannot be read / write millimetres as in `--o G54=100,50,0`"
        );
        for wrong in ["1,2", "1,2,3,4", "1,2,nan", "1,2,inf", "1,2,1e7", ""] {
            assert!(refused::<Point3>(wrong).contains("cannot be read"), "{wrong}");
        }
        for wrong in ["1,2", "X=1,2", "X=", "A=inf", "X1", ""] {
            assert!(refused::<Start>(wrong).contains("cannot be read"), "{wrong}");
        }
        assert!(refused::<Start>("U=3").contains("there is no axis `U`"));
        assert!(refused::<Start>("A=3,a=4").contains("a is said twice"));
        assert!(refused::<ToolLength>("H1=1,2").contains("`--o H1=120` or `--o H1=0,0,120`"));
        assert!(refused::<Size3>("1,-2,3").contains("120,80,40"));
        assert!(refused::<Region3>("3..1,0..1,0..1").contains("cannot be read"));
        assert!(refused::<Conditions>("temp=3").contains("there is no condition `temp`; there are temp_c"));
        assert!(refused::<Conditions>("load_kg=-1").contains("below zero"));
        assert!(refused::<Rotary>("D=3").contains("the rotary axes are A, B and C"));
        assert!(refused::<Lattice>("1x2").contains("three whole numbers"));
        assert!(refused::<EngineId>("magic").contains("rigid-body"));
    }

    #[test]
    fn a_manifest_keeps_what_was_typed() {
        let given: Given<WorkOffset> = "g54= 1,2, 3.50".parse().unwrap();
        assert_eq!((given.name.as_str(), given.zero_mm), ("G54", [1.0, 2.0, 3.5]));
        let json = serde_json::to_string(&given).unwrap();
        assert_eq!(json, "\"g54= 1,2, 3.50\"");
        assert_eq!(serde_json::from_str::<Given<WorkOffset>>(&json).unwrap(), given);
        assert!(serde_json::from_str::<Given<WorkOffset>>("\"G54\"").is_err());
    }
}
