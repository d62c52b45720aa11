//! What is known of a machine's geometry: the input of the rigid-body model.

use crate::axis_tables::AxisTables;
use crate::{Chain, Range, Vector};

/// One linear axis.
///
/// ```
/// use machine_model::{AxisTables, Interpolation, LinearAxis, Range, Table};
///
/// let mut axis = LinearAxis::perfect(Range { low: 0.0, high: 500.0 });
/// let table = Table::new(vec![20.0, 480.0], vec![0.0, 0.005], Interpolation::Linear).unwrap();
/// axis.errors = AxisTables::new(&[Some(table), None, None, None, None, None]);
/// // It may travel farther than it was measured; corrected is only what was measured.
/// assert_eq!(axis.calibrated_mm(), Range { low: 20.0, high: 480.0 });
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LinearAxis {
    /// Commands the axis can take, mm.
    pub travel_mm: Range,
    /// Error functions, mm and rad, of the tool side against the workpiece side, on the line they were
    /// measured along. With `errors_negative`: for motion in the positive direction only. With
    /// `backlash_mm` alone: the mean of both directions.
    pub errors: Option<AxisTables>,
    /// Error functions for motion in the negative direction.
    pub errors_negative: Option<AxisTables>,
    /// Reversal value B, mm: how much further the axis stands after coming from above than from below.
    pub backlash_mm: f64,
    /// Where the other linear axes stood on the measuring line, mm; the entry of the axis itself is not used.
    pub measured_at_mm: Vector,
    /// Tool vector to the point whose motion was measured, mm.
    pub measured_tool_mm: Vector,
}

impl LinearAxis {
    /// An axis without errors.
    #[must_use]
    pub fn perfect(travel_mm: Range) -> Self {
        Self {
            travel_mm,
            errors: None,
            errors_negative: None,
            backlash_mm: 0.0,
            measured_at_mm: Vector::zeros(),
            measured_tool_mm: Vector::zeros(),
        }
    }

    /// Where the axis may be commanded and every table given for it holds.
    #[must_use]
    pub fn calibrated_mm(&self) -> Range {
        [&self.errors, &self.errors_negative].into_iter().flatten().fold(self.travel_mm, |range, tables| {
            let own = tables.range();
            Range { low: range.low.max(own.low), high: range.high.min(own.high) }
        })
    }
}

/// What a rotary axis' location tilt L means: the two readings differ by what the tilt turns at the angle of the axis.
///
/// ```
/// use machine_model::{RotaryAxis, Tilt, Vector};
///
/// assert_eq!(RotaryAxis::perfect(Vector::zeros()).tilt, Tilt::Body);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tilt {
    /// The body leans with its axis: `L Rot` (Zhang 2024; ISG's default).
    #[default]
    Body,
    /// The body turns about the leaning line, upright at 0: `L Rot L⁻¹` (ISG's alternative).
    Axis,
}

/// One rotary axis.
///
/// ```
/// use machine_model::{RotaryAxis, Vector};
///
/// let mut axis = RotaryAxis::perfect(Vector::new(0.0, 0.0, -50.0));
/// assert!(axis.is_perfect());
/// axis.shift_mm = Vector::new(0.0, 0.012, 0.0);
/// assert!(!axis.is_perfect());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RotaryAxis {
    /// Commands the axis can take, rad.
    pub travel_rad: Range,
    /// A point of the ideal axis of rotation, machine frame with all axes at 0, mm.
    pub centre_mm: Vector,
    /// Location: the real axis' displacement (`EX0C EY0C` …) and tilt (`EA0C EB0C` …).
    pub shift_mm: Vector,
    /// Tilt of the axis, rad.
    pub tilt_rad: Vector,
    /// What leans by it.
    pub tilt: Tilt,
    /// Unit vector of the axis of rotation; `None` for that of its letter.
    pub direction: Option<Vector>,
    /// Error motions of what turns against what carries it, mm and rad, over the angle in rad. With `errors_negative`: for
    /// motion in the positive direction only. With `backlash_rad`: the mean of both directions.
    pub errors: Option<AxisTables>,
    /// The same for motion in the negative direction.
    pub errors_negative: Option<AxisTables>,
    /// Reversal value, rad, where the error functions are a mean of both directions.
    pub backlash_rad: f64,
}

impl RotaryAxis {
    /// An axis without errors, turning without limit.
    #[must_use]
    pub fn perfect(centre_mm: Vector) -> Self {
        Self {
            travel_rad: Range { low: f64::NEG_INFINITY, high: f64::INFINITY },
            centre_mm,
            shift_mm: Vector::zeros(),
            tilt_rad: Vector::zeros(),
            tilt: Tilt::Body,
            direction: None,
            errors: None,
            errors_negative: None,
            backlash_rad: 0.0,
        }
    }
    /// True where its error depends on the side from which it came.
    #[must_use]
    pub fn has_play(&self) -> bool {
        self.errors_negative.is_some() || self.backlash_rad != 0.0
    }
    /// The angles that every table covers, and its travel; rad.
    #[must_use]
    pub fn calibrated_rad(&self) -> Range {
        [&self.errors, &self.errors_negative].into_iter().flatten().fold(self.travel_rad, |range, tables| {
            let own = tables.range();
            Range { low: range.low.max(own.low), high: range.high.min(own.high) }
        })
    }
    /// True where it moves exactly as an ideal axis does.
    #[must_use]
    pub fn is_perfect(&self) -> bool {
        let stands_right = self.shift_mm == Vector::zeros() && self.tilt_rad == Vector::zeros();
        stands_right && self.errors.is_none() && !self.has_play()
    }
}

/// Squareness errors of the linear axes, ISO 230-1 signs, rad: equation (5).
///
/// ```
/// use machine_model::Squareness;
///
/// // X and Y open to more than 90°: 100 mm up in Y lead 2 µm back in X.
/// let tilts = Squareness { ec0y_rad: 20e-6, ..Squareness::default() }.tilts();
/// assert!((100.0 * tilts[1].x + 0.002).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Squareness {
    /// Y to X: positive where the angle between +X and +Y exceeds 90°.
    pub ec0y_rad: f64,
    /// Z to X: positive where the angle between +X and +Z is below 90°.
    pub eb0z_rad: f64,
    /// Z to Y: positive where the angle between +Y and +Z exceeds 90°.
    pub ea0z_rad: f64,
}

impl Squareness {
    /// Real minus ideal direction of each linear axis, per mm of travel, first order: equation (5).
    #[must_use]
    pub fn tilts(&self) -> [Vector; 3] {
        [
            Vector::zeros(),
            Vector::new(-self.ec0y_rad, 0.0, 0.0),
            Vector::new(self.eb0z_rad, -self.ea0z_rad, 0.0),
        ]
    }
}

/// All geometry of a machine.
///
/// ```
/// use machine_model::{Chain, Description, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Vector};
///
/// let machine = Description {
///     chain: Chain::parse("[w X Y b Z t]").unwrap(),
///     linear: [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 400.0 })),
///     rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
///     squareness: Squareness { eb0z_rad: 30e-6, ..Squareness::default() },
/// };
/// assert_eq!(RigidBody::new(machine.clone()).unwrap().description(), &machine);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Order of the axes.
    pub chain: Chain,
    /// X, Y, Z.
    pub linear: [LinearAxis; 3],
    /// A, B, C; only those in the chain are used.
    pub rotary: [RotaryAxis; 3],
    /// Between the linear axes.
    pub squareness: Squareness,
}
