//! A bar in its clamping, and the force that bends it.

use diagnostic::Speaks;

/// How the bar is held. Supports do not give way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clamping {
    /// Clamped at Z 0, free at its end.
    Chuck,
    /// Clamped at Z 0, borne by a centre.
    ChuckAndTailstock {
        /// The centre, mm from the chuck.
        at_mm: f64,
    },
    /// Borne by two centres, at Z 0 and here.
    Centres {
        /// The tailstock's centre, mm from the headstock's.
        at_mm: f64,
    },
}

/// A bar in its clamping.
#[derive(Clone, Debug, PartialEq)]
pub struct Workpiece {
    /// Z from the chuck and diameter there, mm, from Z 0 on: even between two rows, a step where two have one Z.
    pub diameters_mm: Vec<[f64; 2]>,
    /// Young's modulus, N/mm².
    pub youngs_modulus_n_mm2: f64,
    /// How it is held.
    pub clamping: Clamping,
    /// Steady rests, mm from the chuck.
    pub steady_rests_mm: Vec<f64>,
}

/// The force with which the workpiece and the tool press each other apart, in X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Force {
    /// Itself, N.
    Radial {
        /// N.
        newton: f64,
    },
    /// Specific force × depth × feed.
    Cut {
        /// Radial force per area of the chip, N/mm².
        specific_n_mm2: f64,
        /// Depth of cut, mm on the radius.
        depth_mm: f64,
        /// Feed, mm a turn.
        feed_mm: f64,
    },
}

impl Force {
    /// N.
    ///
    /// ```
    /// use turning::Force;
    ///
    /// assert_eq!(Force::Cut { specific_n_mm2: 800.0, depth_mm: 0.5, feed_mm: 0.1 }.newton(), 40.0);
    /// ```
    #[must_use]
    pub fn newton(self) -> f64 {
        match self {
            Self::Radial { newton } => newton,
            Self::Cut { specific_n_mm2, depth_mm, feed_mm } => specific_n_mm2 * depth_mm * feed_mm,
        }
    }
}

/// Why a bar cannot be reckoned with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorkpieceError {
    /// Nothing to bend.
    #[error("the workpiece needs the diameters of two places or more, from Z 0 on")]
    NoLength,
    /// Places go up from 0, diameters are above 0.
    #[error("diameter {0} of the workpiece is no place of a bar: Z must rise from 0, diameters be above 0")]
    Diameter(usize),
    /// E.
    #[error("Young's modulus {0} N/mm² is not above 0")]
    Modulus(f64),
    /// A support where there is no bar.
    #[error("the {what} at Z {at_mm} mm lies beyond the bar, which ends at {length_mm} mm")]
    BeyondTheBar {
        /// Which support.
        what: &'static str,
        /// Where it stands, mm.
        at_mm: f64,
        /// The bar's length, mm.
        length_mm: f64,
    },
    /// Two supports at one place bear nothing that one does not.
    #[error("two supports stand at Z {at_mm} mm")]
    Twice {
        /// Where, mm.
        at_mm: f64,
    },
}

impl Speaks for WorkpieceError {
    fn russian(&self) -> String {
        match self {
            Self::NoLength => "для детали нужны диаметры в двух местах или больше, начиная с Z 0".to_owned(),
            Self::Diameter(place) => {
                format!("диаметр {place} детали — не место на прутке: Z возрастает от 0, диаметры больше 0")
            }
            Self::Modulus(modulus) => format!("модуль упругости {modulus} Н/мм² не больше 0"),
            Self::BeyondTheBar { what, at_mm, length_mm } => {
                let what = match *what {
                    "steady rest" => "люнет",
                    "tailstock" => "задняя бабка",
                    other => other,
                };
                format!("{what} в Z {at_mm} мм лежит за прутком, который кончается в {length_mm} мм")
            }
            Self::Twice { at_mm } => format!("две опоры стоят в Z {at_mm} мм"),
        }
    }
}
