//! What axes are told, and where they may go.

use nalgebra::Vector3;

/// A vector in the machine frame, mm.
pub type Vector = Vector3<f64>;
/// A linear map of such vectors.
pub type Matrix = nalgebra::Matrix3<f64>;

/// What the axes are told, with everything the error depends on.
///
/// ```
/// use machine_model::{Command, Vector};
///
/// // X100 Y50 Z20 with a tool of 80 mm, X last moved in its negative direction.
/// let command = Command {
///     linear_mm: Vector::new(100.0, 50.0, 20.0),
///     rotary_rad: Vector::zeros(),
///     tool_mm: Vector::new(0.0, 0.0, -80.0),
///     direction: [-1, 0, 0],
///     ..Default::default()
/// };
/// // A perfect machine without rotary axes has its tip here.
/// assert_eq!(command.linear_mm + command.tool_mm, Vector::new(100.0, 50.0, -60.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// X, Y, Z, machine coordinates, mm.
    pub linear_mm: Vector,
    /// A, B, C, rad.
    pub rotary_rad: Vector,
    /// From the gauge point to the tool tip, mm.
    pub tool_mm: Vector,
    /// Direction in which each linear axis last moved: -1, +1, or 0 where unknown (mean of both).
    pub direction: [i8; 3],
    /// Where the rotary axes stand in their play; by default in its middle.
    pub rotary_play: RotaryPlay,
    /// Where the workpiece lies: errors count from there. By default they count from the measuring frame.
    pub datum: Placement,
}

/// Where a workpiece lies beside where its zero, taken as a place of the measuring frame, would have it: what belongs at p
/// is at `R p + t`. Equation (121).
///
/// ```
/// use machine_model::{Placement, Vector};
///
/// // Dialled parallel to an X axis whose way climbs by 10 um in 100 mm.
/// let (way, x) = (Vector::new(100.0, 0.01, 0.0), Vector::x());
/// let placed = Placement::turned(&x, &way).shifted(Vector::new(0.002, 0.0, 0.0));
/// let place = placed.place(&Vector::new(100.0, 0.0, 0.0));
/// assert!((place - Vector::new(100.002, 0.01, 0.0)).norm() < 1e-6);
/// assert!((placed.meant(&place) - Vector::new(100.0, 0.0, 0.0)).norm() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// t, mm, frame of the workpiece: the machine's error where the zero was touched.
    pub shift_mm: Vector,
    /// `R - 1`; nothing on machines whose rotary axes carry the workpiece.
    pub turn: Matrix,
}

impl Placement {
    /// Turned as one direction is to another, both of any length and less than a right angle apart.
    #[must_use]
    pub fn turned(from: &Vector, to: &Vector) -> Self {
        let (from, to) = (from.normalize(), to.normalize());
        let cross = from.cross(&to).cross_matrix();
        Self { turn: cross + cross * cross / (1.0 + from.dot(&to)), ..Self::default() }
    }

    /// Shifted besides.
    #[must_use]
    pub fn shifted(self, by_mm: Vector) -> Self {
        Self { shift_mm: self.shift_mm + by_mm, ..self }
    }

    /// By which angles it is turned, small ones, rad.
    #[must_use]
    pub fn turn_rad(&self) -> Vector {
        Vector::new(
            self.turn.m32 - self.turn.m23,
            self.turn.m13 - self.turn.m31,
            self.turn.m21 - self.turn.m12,
        ) / 2.0
    }

    /// True where it is turned.
    #[must_use]
    pub fn is_turned(&self) -> bool {
        self.turn != Matrix::zeros()
    }

    /// Where what belongs at a place is, both mm, frame of the workpiece.
    #[must_use]
    pub fn place(&self, meant_mm: &Vector) -> Vector {
        meant_mm + self.turn * meant_mm + self.shift_mm
    }

    /// What belongs at a place: the inverse of [`Self::place`].
    #[must_use]
    pub fn meant(&self, place_mm: &Vector) -> Vector {
        let shifted = place_mm - self.shift_mm;
        shifted + self.turn.tr_mul(&shifted)
    }
}

/// The real way of a linear axis, between two of its commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// The axis: 0, 1, 2.
    pub along: usize,
    /// Axis commands of its ends, mm; `None`: as at the program's zero.
    pub ends_mm: [[Option<f64>; 3]; 2],
    /// Which faces of a workpiece a dial ran on along it: those across X, Y, Z.
    pub faces: [bool; 3],
}

/// Where rotary axes stand in their play.
///
/// ```
/// use machine_model::{RotaryPlay, Vector};
///
/// // C came from below and has turned back by 10 of its 50 µrad: what it carries has not moved yet.
/// let within = RotaryPlay { direction: [0, 0, 1], lag_rad: Vector::new(0.0, 0.0, 10e-6) };
/// assert_ne!(within, RotaryPlay::default());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotaryPlay {
    /// Direction in which what each axis carries last moved: -1, +1, or 0 where unknown (mean of both).
    pub direction: [i8; 3],
    /// How much further each stands than commanded in that direction, rad about its own line; 0 where all play is taken up.
    pub lag_rad: Vector,
}

/// Closed interval of an axis command, mm.
///
/// ```
/// use machine_model::Range;
///
/// let travel = Range { low: 0.0, high: 500.0 };
/// assert!(travel.contains(500.0) && !travel.contains(500.001) && !travel.contains(f64::NAN));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Range {
    /// True where `v` lies inside or on an end. False for NaN.
    #[must_use]
    #[inline]
    pub fn contains(&self, v: f64) -> bool {
        self.low <= v && v <= self.high
    }
}

/// Where the model knows the machine: the box of axis commands that every table covers.
///
/// ```
/// use machine_model::{Range, Vector, Volume};
///
/// let volume = Volume([Range { low: 0.0, high: 100.0 }; 3]);
/// let outside = Vector::new(120.0, 50.0, -1.0);
/// assert!(!volume.contains(&outside));
/// assert_eq!(volume.nearest(&outside), Vector::new(100.0, 50.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume(pub [Range; 3]);

impl Volume {
    /// True where all axes lie inside.
    #[must_use]
    #[inline]
    pub fn contains(&self, linear_mm: &Vector) -> bool {
        (0..3).all(|i| self.0[i].contains(linear_mm[i]))
    }
    /// The nearest point of the volume.
    #[must_use]
    pub fn nearest(&self, linear_mm: &Vector) -> Vector {
        Vector::from_fn(|i, _| linear_mm[i].clamp(self.0[i].low, self.0[i].high))
    }
}

/// A stretch of a path `q(s)`, 0 ≤ s ≤ 1, of axis commands, as far as bounds need it.
///
/// ```
/// use machine_model::{Move, PathModel};
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// // A line from X10 to X40. Here the error grows evenly, so that it does not leave its chord at all.
/// let stretch = Move {
///     range_mm: [Range { low: 10.0, high: 40.0 }, Range { low: 5.0, high: 5.0 }, Range { low: 0.0, high: 0.0 }],
///     speed_mm: [30.0, 0.0, 0.0],
///     acceleration_mm: [0.0; 3],
///     passes: 1,
///     state: at(0.0, 0.0, 0.0),
///     turn: None,
/// };
/// assert!(machine().chord_bound_mm(&stretch) < 1e-9);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Box that contains every `q(s)`, mm. An axis without acceleration runs from one end of its range
    /// to the other: bounds use where in it a table has its nodes.
    pub range_mm: [Range; 3],
    /// Upper bounds of |dq/ds| per axis, mm.
    pub speed_mm: [f64; 3],
    /// Upper bounds of |d²q/ds²| per axis, mm; zero for a line.
    pub acceleration_mm: [f64; 3],
    /// How often at most each axis passes one place: 1 on a line, 2 on an arc below half a turn.
    pub passes: u8,
    /// Tool vector and directions on this stretch; its `linear_mm` is not used, nor its `rotary_rad` where axes turn.
    pub state: Command,
    /// How the rotary axes turn meanwhile; `None` where they stand as `state` says.
    pub turn: Option<Turn>,
}

/// How the rotary axes turn along a stretch: evenly with s, as they are commanded and as they were programmed. The two
/// differ by rounding only.
///
/// ```
/// use machine_model::{Turn, Vector};
///
/// let turn = Turn {
///     programmed_rad: [Vector::new(0.0, 0.0, 0.1), Vector::new(0.0, 0.0, 0.3)],
///     commanded_rad: [Vector::new(0.0, 0.0, 0.1), Vector::new(0.0, 0.0, 0.300_001)],
///     lag_rad: [Vector::zeros(); 2],
/// };
/// assert!((turn.slip_rad() - 1e-6).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// A, B, C at s = 0 and s = 1 by the program, rad.
    pub programmed_rad: [Vector; 2],
    /// The same as commanded.
    pub commanded_rad: [Vector; 2],
    /// How much further they stand there, [`RotaryPlay::lag_rad`].
    pub lag_rad: [Vector; 2],
}

impl Turn {
    /// Upper bound of the angle between the tool's directions that an ideal machine makes of both, rad: as far as each axis
    /// is off, all of them together.
    #[must_use]
    pub fn slip_rad(&self) -> f64 {
        let [from, to] = [0, 1].map(|end| (self.commanded_rad[end] - self.programmed_rad[end]).abs());
        from.sup(&to).sum()
    }
}
