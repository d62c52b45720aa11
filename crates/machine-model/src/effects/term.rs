//! One `[[effect]]` of a profile as a term of the forward model.

use thiserror::Error;

use super::spec::Spec;
use super::{Conditions, EffectGeometry, EffectKind, MissingCondition, Shape, UnknownEffect};
use crate::{Command, Vector};

/// An effect with numbers: what a profile states and what a prediction adds.
///
/// ```
/// use machine_model::effects::{Conditions, EffectTerm};
/// use machine_model::{Command, Vector};
///
/// // 100 µm too long in a metre: 20 µm at X200.
/// let long = EffectTerm::from_entry("scale.X", &[("scale_um_per_m".to_owned(), 100.0)]).unwrap();
/// let at = Command {
///     linear_mm: Vector::new(200.0, 0.0, 0.0),
///     rotary_rad: Vector::zeros(),
///     tool_mm: Vector::zeros(),
///     direction: [0; 3],
///     ..Default::default()
/// };
/// let moved = long.displacement_mm(&at, &Conditions::default()).unwrap();
/// assert!((moved - Vector::new(0.020, 0.0, 0.0)).norm() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EffectTerm {
    pub(super) kind: EffectKind,
    pub(super) shape: Shape,
    /// One per name of [`EffectKind::coefficient_names`].
    pub(super) coefficients: Vec<f64>,
    pub(super) geometry: EffectGeometry,
}

/// Why an entry is not an effect.
///
/// ```
/// use machine_model::effects::{EffectError, EffectTerm};
///
/// let entry = |name: &str| EffectTerm::from_entry("backlash.X", &[(name.to_owned(), 3.0)]);
/// assert!(matches!(entry("half_width_mm"), Err(EffectError::UnknownParameter { .. })));
/// assert!(entry("half_width_um").is_ok());
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EffectError {
    /// The id is not in the catalogue.
    #[error(transparent)]
    Unknown(#[from] UnknownEffect),
    /// The parameter does not belong to the effect.
    #[error("{id} has no parameter '{name}'; it knows {known}")]
    UnknownParameter {
        /// The effect.
        id: String,
        /// What was found.
        name: String,
        /// What was expected.
        known: String,
    },
    /// The parameter stands there twice.
    #[error("{id}: '{name}' is given twice")]
    Twice {
        /// The effect.
        id: String,
        /// The parameter.
        name: String,
    },
    /// A parameter without which the effect says nothing.
    #[error("{id} needs '{name}'")]
    Missing {
        /// The effect.
        id: String,
        /// The parameter.
        name: &'static str,
    },
    /// Not a number, or a length that must be positive.
    #[error("{id}: '{name}' = {value} is not possible: {reason}")]
    Value {
        /// The effect.
        id: String,
        /// The parameter.
        name: String,
        /// What was found.
        value: f64,
        /// What was expected.
        reason: &'static str,
    },
}

impl EffectTerm {
    /// A term from its parts; `coefficients` may be shorter than the list of names, the rest is zero.
    #[must_use]
    pub fn new(kind: EffectKind, shape: Shape, coefficients: &[f64], geometry: EffectGeometry) -> Self {
        let mut all = vec![0.0; kind.coefficient_names().len()];
        for (to, from) in all.iter_mut().zip(coefficients) {
            *to = *from;
        }
        Self { kind, shape, coefficients: all, geometry }
    }

    /// Reads an entry of a profile: `id` and its numbers by name, in the unit of the name.
    ///
    /// # Errors
    /// [`EffectError`] for an unknown id, an unknown or repeated name, a number that cannot be, or a missing
    /// shape parameter that a given coefficient needs.
    pub fn from_entry(id: &str, parameters: &[(String, f64)]) -> Result<Self, EffectError> {
        let kind: EffectKind = id.parse()?;
        let (names, shapes) = (kind.coefficient_names(), kind.shape_names());
        let mut shape = Shape::default();
        let mut coefficients = vec![0.0; names.len()];
        for (place, (name, value)) in parameters.iter().enumerate() {
            if parameters.iter().take(place).any(|(other, _)| other == name) {
                return Err(EffectError::Twice { id: id.to_owned(), name: name.clone() });
            }
            let wrong =
                |reason| EffectError::Value { id: id.to_owned(), name: name.clone(), value: *value, reason };
            if !value.is_finite() {
                return Err(wrong("it must be a finite number"));
            }
            if let Some(index) = names.iter().position(|n| n == name) {
                coefficients[index] = *value;
            } else if shapes.clone().any(|known| known == name) {
                let positive = ["tau_s", "tau2_s", "pitch_mm", "width_mm"].contains(&name.as_str());
                if positive && *value <= 0.0 {
                    return Err(wrong("it must be above zero"));
                }
                *shape.field(name) = *value;
            } else {
                let known: Vec<&str> = names.iter().copied().chain(shapes).collect();
                return Err(EffectError::UnknownParameter {
                    id: id.to_owned(),
                    name: name.clone(),
                    known: known.join(", "),
                });
            }
        }
        let term = Self { kind, shape, coefficients, geometry: EffectGeometry::default() };
        term.complete(id, parameters)?;
        Ok(term)
    }

    /// Shape parameters that the coefficients given make necessary.
    fn complete(&self, id: &str, parameters: &[(String, f64)]) -> Result<(), EffectError> {
        let given = |name: &str| parameters.iter().any(|(n, _)| n == name);
        for (name, first) in Spec::of(self.kind).shape.iter().copied() {
            let used = first == 0 || self.coefficients.iter().skip(first).any(|c| *c != 0.0);
            if used && !given(name) {
                return Err(EffectError::Missing { id: id.to_owned(), name });
            }
        }
        if given("to_mm") && self.shape.to_mm <= self.shape.from_mm {
            let (name, value) = ("to_mm".to_owned(), self.shape.to_mm);
            return Err(EffectError::Value {
                id: id.to_owned(),
                name,
                value,
                reason: "it must exceed from_mm",
            });
        }
        Ok(())
    }

    /// The same term on a machine with this chain.
    #[must_use]
    pub fn with_geometry(mut self, geometry: EffectGeometry) -> Self {
        self.geometry = geometry;
        self
    }

    /// The same effect, `factor` times as large: it is linear in its coefficients.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        for coefficient in &mut self.coefficients {
            *coefficient *= factor;
        }
        self
    }

    /// Names, with unit, and values of the coefficients that are not zero.
    pub fn coefficients(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        let names = self.kind.coefficient_names().iter().copied();
        names.zip(self.coefficients.iter().copied()).filter(|(_, value)| *value != 0.0)
    }

    /// Which effect it is.
    #[must_use]
    pub const fn kind(&self) -> EffectKind {
        self.kind
    }

    /// The numbers of a profile entry: every shape parameter that is used and every coefficient that is not zero.
    #[must_use]
    pub fn entry(&self) -> Vec<(&'static str, f64)> {
        let mut shape = self.shape;
        let shapes = self.kind.shape_names().map(|name| (name, *shape.field(name)));
        let mut all: Vec<_> =
            shapes.filter(|(name, v)| *v != 0.0 || *name == "from_mm" || *name == "to_mm").collect();
        if all.iter().all(|(name, v)| (*name == "from_mm" || *name == "to_mm") && *v == 0.0) {
            all.clear();
        }
        all.extend(self.coefficients());
        all
    }

    /// Displacement of the tip by this effect, mm, as the workpiece sees it.
    ///
    /// # Errors
    /// [`MissingCondition`] where it depends on a condition that is not known: it is never guessed.
    pub fn displacement_mm(
        &self,
        command: &Command,
        conditions: &Conditions,
    ) -> Result<Vector, MissingCondition> {
        let mut sum = Vector::zeros();
        for (index, value) in self.coefficients.iter().enumerate().filter(|(_, v)| **v != 0.0) {
            sum += self.kind.unit_displacement_mm(index, &self.shape, command, conditions, &self.geometry)?
                * *value;
        }
        Ok(sum)
    }

    /// True where correction must know the direction of motion.
    #[must_use]
    pub const fn depends_on_direction(&self) -> bool {
        self.kind.depends_on_direction()
    }
}

impl Shape {
    /// The field by its name in profiles.
    fn field(&mut self, name: &str) -> &mut f64 {
        match name {
            "from_mm" => &mut self.from_mm,
            "to_mm" => &mut self.to_mm,
            "pitch_mm" => &mut self.pitch_mm,
            "tau_s" => &mut self.tau_s,
            "tau2_s" => &mut self.tau2_s,
            "time_s" => &mut self.time_s,
            "centre_mm" => &mut self.centre_mm,
            _ => &mut self.width_mm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, z: f64, direction: [i8; 3]) -> Command {
        Command {
            linear_mm: Vector::new(x, y, z),
            tool_mm: Vector::new(0.0, 0.0, -100.0),
            direction,
            ..Default::default()
        }
    }

    fn term(id: &str, parameters: &[(&str, f64)]) -> EffectTerm {
        let owned: Vec<_> = parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
        EffectTerm::from_entry(id, &owned).unwrap()
    }

    #[test]
    fn textbook_signs() {
        let known = Conditions {
            temp_c: [Some(23.0); 3],
            time_s: Some(600.0),
            load_kg: Some(10.0),
            feed_mm_min: Some(6000.0),
            ..Conditions::default()
        };
        type Case<'a> = (&'a str, &'a [(&'a str, f64)], Command, [f64; 3]);
        let cases: [Case<'_>; 10] = [
            ("scale.X", &[("scale_um_per_m", 20.0)], at(500.0, 0.0, 0.0, [0; 3]), [0.010, 0.0, 0.0]),
            ("backlash.X", &[("half_width_um", 5.0)], at(1.0, 0.0, 0.0, [1, 0, 0]), [-0.005, 0.0, 0.0]),
            ("lost-motion.EYX", &[("half_width_um", 5.0)], at(1.0, 0.0, 0.0, [-1, 0, 0]), [0.0, 0.005, 0.0]),
            ("squareness.XY", &[("angle_urad", 10.0)], at(0.0, 300.0, 0.0, [0; 3]), [-0.003, 0.0, 0.0]),
            ("squareness.XZ", &[("angle_urad", 10.0)], at(0.0, 0.0, 300.0, [0; 3]), [0.003, 0.0, 0.0]),
            ("squareness.YZ", &[("angle_urad", 10.0)], at(0.0, 0.0, 300.0, [0; 3]), [0.0, -0.003, 0.0]),
            ("thermal.Y", &[("expansion_um_per_m_k", 10.0)], at(0.0, 200.0, 0.0, [0; 3]), [0.0, 0.006, 0.0]),
            ("load.Z", &[("compliance_um_per_kg", 0.5)], at(0.0, 0.0, 0.0, [0; 3]), [0.0, 0.0, -0.005]),
            ("servo-lag.X", &[("lag_ms", 0.1)], at(0.0, 0.0, 0.0, [1, 0, 0]), [-0.010, 0.0, 0.0]),
            ("step.Z", &[("time_s", 500.0), ("shift_um", 4.0)], at(0.0, 0.0, 0.0, [0; 3]), [0.0, 0.0, 0.004]),
        ];
        for (id, parameters, command, expected) in cases {
            let found = term(id, parameters).displacement_mm(&command, &known).unwrap();
            assert!((found - Vector::from(expected)).norm() < 1e-12, "{id}: {found}");
        }
        let roll = term("angular.EAX", &[("from_mm", 0.0), ("to_mm", 100.0), ("p1_urad", 10.0)]);
        // At the far end the rotation is +10 µrad about X; the lever is y = 200, z = 50 - 100.
        let found = roll.displacement_mm(&at(100.0, 200.0, 50.0, [0; 3]), &known).unwrap();
        assert!((found - Vector::new(0.0, 0.0005, 0.002)).norm() < 1e-12, "{found}");
    }

    #[test]
    fn an_entry_survives_writing_and_reading() {
        let geometry = EffectGeometry::default();
        for kind in EffectKind::all() {
            let shape = Shape {
                from_mm: 0.0,
                to_mm: 300.0,
                pitch_mm: 10.0,
                tau_s: 600.0,
                tau2_s: 2400.0,
                time_s: 100.0,
                centre_mm: 50.0,
                width_mm: 30.0,
            };
            let coefficients: Vec<f64> =
                (0..kind.coefficient_names().len()).map(|i| 1.5 + i as f64).collect();
            let term = EffectTerm::new(kind, shape, &coefficients, geometry.clone());
            let entry: Vec<_> = term.entry().into_iter().map(|(n, v)| (n.to_owned(), v)).collect();
            let again = EffectTerm::from_entry(&kind.to_string(), &entry).unwrap();
            assert_eq!(term.entry(), again.entry(), "{kind}");
        }
    }

    #[test]
    fn nothing_is_guessed() {
        let warm = term("warmup.Z", &[("tau_s", 600.0), ("amplitude_um", 20.0)]);
        assert_eq!(
            warm.displacement_mm(&at(0.0, 0.0, 0.0, [0; 3]), &Conditions::default()),
            Err(MissingCondition("time"))
        );
        let entry = |id: &str, p: &[(&str, f64)]| {
            EffectTerm::from_entry(id, &p.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect::<Vec<_>>())
        };
        assert!(entry("backlash.X", &[("half_width_mm", 0.005)]).is_err());
        assert!(entry("warmup.Z", &[("amplitude_um", 1.0)]).is_err());
        assert!(entry("pitch.X", &[("pitch_mm", 0.0), ("sin1_um", 1.0)]).is_err());
        assert!(entry("scale.X", &[("scale_um_per_m", f64::NAN)]).is_err());
        assert!(entry("scale.X", &[("scale_um_per_m", 1.0), ("scale_um_per_m", 2.0)]).is_err());
        assert!(entry("local.X", &[("x_um", 2.0), ("centre_mm", 5.0)]).is_err());
    }
}
