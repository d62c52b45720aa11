//! Values that say something of a machine: travels, tables, centres, senses, its squareness.

use crate::values::given::Value;

use crate::values::{assignment, finite, millimetres, range_mm, three};
use diagnostic::Text;
use machine_model::{Axis, Range};

/// `XY=12,ZX=-3,YZ=5`, µrad; planes that are not named are `None`.
#[derive(Debug, Clone, Copy)]
pub struct SquarenessReadings(pub [Option<f64>; 3]);

impl Value for SquarenessReadings {
    const WHAT: Text = Text::pair("µrad,", "мкрад");
    const EXAMPLES: &'static [&'static str] = &["XY=12,ZX=-3,YZ=5"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let mut read = [None; 3];
        for part in text.split(',') {
            let (name, value) = assignment(part).ok_or(None)?;
            let plane = ["XY", "ZX", "YZ"].iter().position(|known| known.eq_ignore_ascii_case(name));
            read[plane.ok_or(None)?] = Some(finite(value).ok_or(None)?);
        }
        Ok(Self(read))
    }
}

/// `X=0..500`
#[derive(Debug, Clone, Copy)]
pub struct Travel {
    /// The axis.
    pub axis: Axis,
    /// mm.
    pub range_mm: Range,
}

impl Value for Travel {
    const WHAT: Text = Text::pair("an axis and millimetres", "ось и миллиметры");
    const EXAMPLES: &'static [&'static str] = &["X=0..500"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (axis, range) = assignment(text).ok_or(None)?;
        let axis = linear_axis(axis).ok_or(None)?;
        // An axis that travels nowhere is none.
        let range_mm = range_mm(range).filter(|range| range.low < range.high).ok_or(None)?;
        Ok(Self { axis, range_mm })
    }
}

/// `X=errors_x.csv`
#[derive(Debug, Clone)]
pub struct AxisTable {
    /// The axis.
    pub axis: Axis,
    /// The file, relative to the profile.
    pub path: String,
}

impl Value for AxisTable {
    const WHAT: Text = Text::pair("an axis and a file", "ось и файл");
    const EXAMPLES: &'static [&'static str] = &["X=errors_x.csv"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (axis, path) = assignment(text).ok_or(None)?;
        let axis = linear_axis(axis).ok_or(None)?;
        (!path.is_empty()).then(|| Self { axis, path: path.to_owned() }).ok_or(None)
    }
}

/// `C=250,200,0`
#[derive(Debug, Clone, Copy)]
pub struct Centre {
    /// The rotary axis.
    pub axis: Axis,
    /// A point of its line, machine coordinates, mm.
    pub point_mm: [f64; 3],
}

impl Value for Centre {
    const WHAT: Text = Text::pair("a rotary axis and millimetres", "поворотную ось и миллиметры");
    const EXAMPLES: &'static [&'static str] = &["C=250,200,0"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (axis, point) = assignment(text).ok_or(None)?;
        let axis = axis_of(axis).filter(|axis| !axis.is_linear()).ok_or(None)?;
        three(point, millimetres).map(|point_mm| Self { axis, point_mm }).ok_or(None)
    }
}

/// `C=right`
#[derive(Debug, Clone, Copy)]
pub struct Sense {
    /// The rotary axis.
    pub axis: Axis,
    /// 1 where plus turns it right-handed about its letter's direction, -1 where against.
    pub sign: f64,
}

impl Sense {
    /// `right` or `left`.
    #[must_use]
    pub fn sign(text: &str) -> Option<f64> {
        match text {
            "right" => Some(1.0),
            "left" => Some(-1.0),
            _ => None,
        }
    }
}

impl Value for Sense {
    const WHAT: Text = Text::pair("a rotary axis and right or left", "поворотную ось и right или left");
    const EXAMPLES: &'static [&'static str] = &["C=right", "C=left"];

    fn read(text: &str) -> Result<Self, Option<Text>> {
        let (axis, way) = assignment(text).ok_or(None)?;
        let axis = axis_of(axis).filter(|axis| !axis.is_linear()).ok_or(None)?;
        Self::sign(way).map(|sign| Self { axis, sign }).ok_or(None)
    }
}

pub(crate) fn linear_axis(text: &str) -> Option<Axis> {
    axis_of(text).filter(|axis| axis.is_linear())
}

pub(crate) fn axis_of(text: &str) -> Option<Axis> {
    let mut letters = text.chars();
    let axis = letters.next().and_then(Axis::from_letter);
    axis.filter(|_| letters.next().is_none())
}
