//! What is unknown of the rotary axes, and the machine that has it: equations (100) and (101).

use machine_model::{Axis, AxisTables, Component, Description, Interpolation, Six, Table};

use super::basis::Basis;
use crate::rotary_ballbar::Location;

/// Letters of the six error functions.
pub(crate) const FUNCTIONS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// One unknown of a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// A location error: `EX0C`.
    Location(Location),
    /// A coefficient of an error function: `EXC.cos2`.
    Coefficient {
        /// The axis.
        axis: Axis,
        /// The function as in [`Six`]: EX EY EZ EA EB EC.
        function: usize,
        /// What it is spread over.
        basis: Basis,
        /// The group of the basis.
        group: usize,
        /// Which of the group.
        which: usize,
    },
    /// How much further an axis stands about itself after coming from above than from below.
    Reversal(Axis),
}

impl Term {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Location(location) => location.name(),
            Self::Coefficient { axis, function, basis, group, which } => {
                format!("E{}{axis}.{}", FUNCTIONS[*function], basis.name(*group, *which))
            }
            Self::Reversal(axis) => format!("reversal.{axis}"),
        }
    }

    /// Whether it is counted in mm or rad.
    #[must_use]
    pub fn component(&self) -> Component {
        match self {
            Self::Location(location) => location.component,
            Self::Coefficient { function, .. } => Component::of(*function),
            Self::Reversal(_) => Component::Angular,
        }
    }

    /// The axis it belongs to.
    #[must_use]
    pub fn axis(&self) -> Axis {
        match self {
            Self::Location(location) => location.axis,
            Self::Coefficient { axis, .. } | Self::Reversal(axis) => *axis,
        }
    }
}

/// Change of the six functions of an axis at an angle by the coefficients among the terms.
pub(crate) fn change_at(axis: Axis, angle_rad: f64, terms: &[Term], x: &[f64]) -> Six {
    let mut six = [0.0; 6];
    for (term, value) in terms.iter().zip(x) {
        if let Term::Coefficient { axis: own, function, basis, group, which } = term
            && *own == axis
        {
            six[*function] += value * basis.values(*group, angle_rad)[*which];
        }
    }
    six
}

/// The base with the terms changed by x; exact at the nodes, the angles at which rows were measured.
pub(crate) fn changed(
    base: &Description,
    nodes_rad: &[Vec<f64>; 3],
    terms: &[Term],
    x: &[f64],
) -> Description {
    let mut machine = base.clone();
    for (term, value) in terms.iter().zip(x) {
        if let Term::Location(location) = term {
            location.add(&mut machine, *value);
        }
    }
    for axis in &Axis::ALL[3..] {
        let own = |term: &&Term| matches!(term, Term::Coefficient { axis: own, .. } if own == axis);
        if terms.iter().find(own).is_none() {
            continue;
        }
        let nodes = &nodes_rad[axis.direction()];
        let rotary = &mut machine.rotary[axis.direction()];
        let rows: Vec<Six> = nodes
            .iter()
            .map(|angle| {
                let before = rotary.errors.as_ref().map_or([0.0; 6], |tables| tables.at(*angle));
                let change = change_at(*axis, *angle, terms, x);
                std::array::from_fn(|f| before[f] + change[f])
            })
            .collect();
        rotary.errors = tables(nodes, &rows, Interpolation::Linear);
    }
    machine
}

/// Six functions at nodes.
pub(crate) fn tables(nodes: &[f64], rows: &[Six], interpolation: Interpolation) -> Option<AxisTables> {
    let function =
        |f: usize| Table::new(nodes.to_vec(), rows.iter().map(|row| row[f]).collect(), interpolation).ok();
    AxisTables::new(&std::array::from_fn(function))
}
