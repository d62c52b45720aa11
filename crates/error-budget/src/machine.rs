//! A machine with a coefficient for each of its deviations.

use machine_model::effects::EffectTerm;
use machine_model::{Axis, AxisTables, RigidBody, WithEffects};

/// What the size of a deviation is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// mm.
    Length,
    /// rad.
    Angle,
    /// The parameter of an effect, with its unit in its name, as in `half_width_um`.
    Parameter(&'static str),
    /// As it was found: an effect of several parameters is 1.
    Whole,
}

/// One primary deviation of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// ISO 230 symbol: `EYX`, `EC0Y`, `EX0C`; `B(X)` the reversal value of X; or the id of an effect, with a number
    /// from the second one of its kind on. No two of a machine are equal.
    pub name: String,
    /// Largest value of a function over the calibrated range, or the absolute value of a number, above 0.
    pub size: f64,
    /// What the size is counted in.
    pub unit: Unit,
    place: Place,
}

/// What kind of deviation it is, as ISO 230-1 sorts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Positioning error of a linear axis: `EXX`.
    Positioning(Axis),
    /// Straightness errors of a linear axis: `EYX`, `EZX`.
    Straightness(Axis),
    /// Angular errors of a linear axis: `EAX`, `EBX`, `ECX`.
    Angular(Axis),
    /// Reversal value of a linear axis.
    Reversal(Axis),
    /// Squareness of two linear axes.
    Squareness,
    /// Error functions of a rotary axis.
    Rotary(Axis),
    /// Where a rotary axis lies, and how.
    Location(Axis),
    /// An effect beyond the tables.
    Effect,
}

impl Deviation {
    /// What kind it is of.
    ///
    /// ```
    /// use error_budget::{Family, Machine};
    /// use machine_model::effects::Conditions;
    /// use machine_model::{Axis, Chain, Description, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Vector, WithEffects};
    ///
    /// let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
    /// linear[0].backlash_mm = 0.004;
    /// let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
    /// let chain = Chain::parse("[w X Y b Z t]").unwrap();
    /// let squareness = Squareness { ec0y_rad: 20e-6, ..Squareness::default() };
    /// let body = RigidBody::new(Description { chain, linear, rotary, squareness }).unwrap();
    /// let machine = Machine::new(WithEffects::new(body, Vec::new(), Conditions::default()).unwrap());
    /// let families: Vec<Family> = machine.deviations().iter().map(|deviation| deviation.family()).collect();
    /// assert_eq!(families, [Family::Reversal(Axis::X), Family::Squareness]);
    /// ```
    #[must_use]
    pub fn family(&self) -> Family {
        match self.place {
            Place::Function(axis @ 3.., _) => Family::Rotary(Axis::ALL[axis]),
            Place::Function(axis, 3..) => Family::Angular(Axis::ALL[axis]),
            Place::Function(axis, component) if component == axis => Family::Positioning(Axis::ALL[axis]),
            Place::Function(axis, _) => Family::Straightness(Axis::ALL[axis]),
            Place::Reversal(axis @ 3..) => Family::Rotary(Axis::ALL[axis]),
            Place::Reversal(axis) => Family::Reversal(Axis::ALL[axis]),
            Place::Squareness(_) => Family::Squareness,
            Place::Location(axis, _) => Family::Location(Axis::ALL[axis + 3]),
            Place::Effect(_) => Family::Effect,
        }
    }
}

/// Where the machine's description has it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// Error function: axis as in [`Axis::ALL`], component as in [`machine_model::Six`].
    Function(usize, usize),
    /// Of an axis as in [`Axis::ALL`].
    Reversal(usize),
    /// EC0Y, EB0Z, EA0Z.
    Squareness(usize),
    /// Rotary axis, component: 0 to 2 shift, 3 to 5 tilt.
    Location(usize, usize),
    Effect(usize),
}

const COMPONENTS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];
const LETTERS: [char; 3] = ['X', 'Y', 'Z'];

/// A machine as measured, and its deviations.
#[derive(Clone, Debug)]
pub struct Machine {
    model: WithEffects,
    deviations: Vec<Deviation>,
}

impl Machine {
    /// Finds the deviations: every function and number of the description that is not zero, every effect.
    #[must_use]
    pub fn new(model: WithEffects) -> Self {
        let deviations = deviations(&model);
        Self { model, deviations }
    }

    /// The machine as measured, all ε = 1.
    #[must_use]
    pub fn model(&self) -> &WithEffects {
        &self.model
    }

    /// Its deviations: functions by axis, then reversal values, squareness, location errors, effects.
    #[must_use]
    pub fn deviations(&self) -> &[Deviation] {
        &self.deviations
    }

    /// The machine with these coefficients, one for each deviation. Its calibrated volume stays.
    ///
    /// # Panics
    /// Where there is not one coefficient for each deviation.
    #[must_use]
    pub fn scaled(&self, coefficients: &[f64]) -> WithEffects {
        assert_eq!(coefficients.len(), self.deviations.len(), "one coefficient for each deviation");
        let mut description = self.model.base().description().clone();
        let mut terms = self.model.terms().to_vec();
        let mut functions = [[1.0; 6]; 6];
        for (deviation, &by) in self.deviations.iter().zip(coefficients) {
            match deviation.place {
                Place::Function(axis, component) => functions[axis][component] = by,
                Place::Reversal(axis @ 3..) => description.rotary[axis - 3].backlash_rad *= by,
                Place::Reversal(axis) => description.linear[axis].backlash_mm *= by,
                Place::Squareness(0) => description.squareness.ec0y_rad *= by,
                Place::Squareness(1) => description.squareness.eb0z_rad *= by,
                Place::Squareness(_) => description.squareness.ea0z_rad *= by,
                Place::Location(axis, component @ 0..3) => description.rotary[axis].shift_mm[component] *= by,
                Place::Location(axis, component) => description.rotary[axis].tilt_rad[component - 3] *= by,
                Place::Effect(index) => terms[index] = terms[index].clone().scaled(by),
            }
        }
        for (axis, by) in functions.iter().enumerate() {
            let scale = |tables: &mut Option<AxisTables>| *tables = tables.take().map(|t| t.scaled(by));
            if axis < 3 {
                scale(&mut description.linear[axis].errors);
                scale(&mut description.linear[axis].errors_negative);
            } else {
                scale(&mut description.rotary[axis - 3].errors);
                scale(&mut description.rotary[axis - 3].errors_negative);
            }
        }
        self.with(description, terms)
    }

    /// The machine on which every error function has its size everywhere: what is known of functions of
    /// which only the size is known. Numbers and effects are as measured.
    ///
    /// The error at a command depends on the functions by their values there only, so over all functions
    /// within ± their sizes it is largest, to first order, for some choice of signs of this machine.
    #[must_use]
    pub fn at_its_sizes(&self) -> Self {
        let mut description = self.model.base().description().clone();
        let sizes = |axis: usize| -> machine_model::Six {
            std::array::from_fn(|component| {
                let place = Place::Function(axis, component);
                self.deviations.iter().find(|known| known.place == place).map_or(0.0, |known| known.size)
            })
        };
        for (axis, data) in description.linear.iter_mut().enumerate() {
            let range = data.calibrated_mm();
            data.errors = data.errors.take().map(|_| AxisTables::constant(range, sizes(axis)));
            data.errors_negative = None;
        }
        for (axis, data) in description.rotary.iter_mut().enumerate() {
            data.errors = data.errors.take().map(|t| AxisTables::constant(t.range(), sizes(axis + 3)));
            data.errors_negative = None;
        }
        Self {
            model: self.with(description, self.model.terms().to_vec()),
            deviations: self.deviations.clone(),
        }
    }

    fn with(&self, description: machine_model::Description, terms: Vec<EffectTerm>) -> WithEffects {
        let base = RigidBody::new(description).expect("factors leave the ranges of tables as they are");
        WithEffects::new(base, terms, *self.model.conditions())
            .expect("the conditions were enough for the same effects before")
    }
}

fn deviations(model: &WithEffects) -> Vec<Deviation> {
    let description = model.base().description();
    let mut found = Vec::new();
    let mut add = |name: String, size: f64, unit, place| {
        let size = size.abs();
        if size > 0.0 {
            found.push(Deviation { name, size, unit, place });
        }
    };
    let unit = |component: usize| if component < 3 { Unit::Length } else { Unit::Angle };
    for (axis, letter) in COMPONENTS.into_iter().enumerate() {
        let largest = if axis < 3 {
            let data = &description.linear[axis];
            let all = [&data.errors, &data.errors_negative].into_iter().flatten();
            all.map(|tables| tables.largest(data.calibrated_mm())).reduce(larger)
        } else {
            let data = &description.rotary[axis - 3];
            let all = [&data.errors, &data.errors_negative].into_iter().flatten();
            all.map(|tables| tables.largest(data.calibrated_rad())).reduce(larger)
        };
        for (component, size) in largest.unwrap_or_default().into_iter().enumerate() {
            let name = format!("E{}{letter}", COMPONENTS[component]);
            add(name, size, unit(component), Place::Function(axis, component));
        }
    }
    for (axis, data) in description.linear.iter().enumerate() {
        add(format!("B({})", LETTERS[axis]), data.backlash_mm, Unit::Length, Place::Reversal(axis));
    }
    for (axis, data) in (3..).zip(&description.rotary) {
        add(format!("B({})", COMPONENTS[axis]), data.backlash_rad, Unit::Angle, Place::Reversal(axis));
    }
    let square = &description.squareness;
    let square = [("EC0Y", square.ec0y_rad), ("EB0Z", square.eb0z_rad), ("EA0Z", square.ea0z_rad)];
    for (index, (name, size)) in square.into_iter().enumerate() {
        add(name.to_owned(), size, Unit::Angle, Place::Squareness(index));
    }
    let turning = |axis: &Axis| description.chain.axes().any(|known| known == *axis);
    for axis in Axis::ALL[3..].iter().filter(|axis| turning(axis)) {
        let data = &description.rotary[axis.direction()];
        for (component, size) in data.shift_mm.iter().chain(data.tilt_rad.iter()).copied().enumerate() {
            let name = format!("E{}0{}", COMPONENTS[component], axis.letter());
            add(name, size, unit(component), Place::Location(axis.direction(), component));
        }
    }
    for (index, term) in model.terms().iter().enumerate() {
        let mut coefficients = term.coefficients();
        let (size, unit) = match (coefficients.next(), coefficients.next()) {
            (Some((name, value)), None) => (value, Unit::Parameter(name)),
            (Some(_), Some(_)) => (1.0, Unit::Whole),
            (None, _) => continue,
        };
        // A machine may be damaged in two places: `local.X`, `local.X#2`.
        let before = model.terms()[..index].iter().filter(|other| other.kind() == term.kind()).count();
        let number = if before > 0 { format!("#{}", before + 1) } else { String::new() };
        add(format!("{}{number}", term.kind()), size, unit, Place::Effect(index));
    }
    found
}

fn larger(a: machine_model::Six, b: machine_model::Six) -> machine_model::Six {
    std::array::from_fn(|component| a[component].max(b[component]))
}
