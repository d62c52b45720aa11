//! What a control makes of the path, however right its words are.

use std::f64::consts::PI;

use crate::{Feed, Following, Shape};

/// What parameters of a control say of how it keeps to the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interpolator {
    /// How far it leaves the path at corners where a program does not say, mm: 0 where it stops at each; `None`: not known.
    pub blending_mm: Option<f64>,
    /// How it cuts arcs, where it does not follow them.
    pub arcs: Option<ArcChords>,
    /// Along the path, mm/s²; `None`: not known.
    pub acceleration_mm_s2: Option<f64>,
    /// How the axes follow; `None`: taken as if at once.
    pub following: Option<Following>,
}

/// How a control cuts arcs into straight lines whose ends lie on the arc, all alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArcChords {
    /// As many as fit along the arc with this length, mm (Klipper, `resolution` of `[gcode_arcs]`).
    Length(f64),
    /// As many whole ones as chords this far beside the arc fit along it, mm (Grbl 1.1, `$12`): fewer than that distance asks
    /// for.
    Tolerance(f64),
}

impl ArcChords {
    /// How far the chords of a motion lie beside its arc, mm: `r (1 - cos(sweep / 2 n))` for n of them, 0 for other motions.
    ///
    /// ```
    /// use toolpath::{Arc, ArcChords, Division, Feed, FeedRate, Plane, Position, Shape};
    ///
    /// let at = |x: f64, y: f64| Position { linear_mm: [x, y, 0.0], ..Position::default() };
    /// let arc = Arc { plane: Plane::Xy, centre_mm: [0.0, 0.0], sweep_rad: std::f64::consts::FRAC_PI_2 };
    /// let (start, end, rate) = (at(30.0, 0.0), at(0.0, 30.0), FeedRate::PerMinute);
    /// let quarter = Feed { start, end, shape: Shape::Arc(arc), rate, division: Division::Any };
    /// // 47.1 mm, 47 chords of 1.003 mm.
    /// assert!((1e3 * ArcChords::Length(1.0).leaves_mm(&quarter) - 4.188).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn leaves_mm(self, motion: &Feed) -> f64 {
        let Shape::Arc(arc) = motion.shape else { return 0.0 };
        let [first, second, normal] = arc.plane.axes();
        let radius =
            |at: &[f64; 3]| units::math::hypot(at[first] - arc.centre_mm[0], at[second] - arc.centre_mm[1]);
        let (start, end) = (&motion.start.linear_mm, &motion.end.linear_mm);
        let radius_mm = radius(start).max(radius(end));
        let along_mm = radius_mm * arc.sweep_rad.abs();
        let chords = match self {
            Self::Length(mm) => units::math::hypot(along_mm, end[normal] - start[normal]) / mm,
            Self::Tolerance(mm) => along_mm / 2.0 / (mm * (2.0 * radius_mm - mm)).max(0.0).sqrt(),
        };
        let whole = if chords.is_finite() { chords.floor().max(1.0) } else { 1.0 };
        let half_rad = arc.sweep_rad.abs() / 2.0 / whole;
        radius_mm * (1.0 - units::math::sin_cos(half_rad.min(PI)).1)
    }
}
