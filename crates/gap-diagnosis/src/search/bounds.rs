//! Bounds that no cause may exceed: what it does between the places measured, and what its physics allows.
//!
//! A fit is tied down at the places that were measured and nowhere else. A wave or a polynomial that passes through ten
//! readings of 40 µm may swing by millimetres between them, and two causes nearly alike with opposite signs cancel where
//! they were fitted and nowhere else. So every cause is evaluated between the places, too.

use std::cell::RefCell;
use std::rc::Rc;

use machine_model::Vector;
use machine_model::effects::{EffectGeometry, EffectKind, legendre};

use crate::effects::{self, Why, is_straight};
use crate::equations::noise::median;
use crate::equations::observation::{Measurements, Row, Scalar};
use crate::equations::term::Term;

/// A cause may displace by so many times the largest reading: twice is what two causes that overlap can need.
const LARGEST: f64 = 2.0;
/// Rows at which a cause is evaluated, and places per axis between which it is.
const ROWS: usize = 240;
const PLACES: usize = 120;
/// Where between two places, as shares of their distance.
const BETWEEN: [f64; 4] = [0.2, 0.4, 0.6, 0.8];

/// Points of a file at which causes are evaluated.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    /// Rows of the file, then points between the places of each axis.
    probes: Vec<Row>,
    /// How many of them are rows.
    measured: usize,
    /// What the terms asked about displace there, one by one: a search asks for the same causes again and again.
    known: RefCell<Vec<(Term, Rc<[Vector]>)>>,
    /// Largest reading, µm: measured minus predicted, from the median of its component.
    largest_um: f64,
    /// Largest difference of two readings of a component, µm: what an axis that leans or stretches shows from end to end,
    /// while the measuring frame takes up to half of it off each reading.
    widest_um: f64,
}

impl Bounds {
    /// Rows and points between them, evenly thinned.
    pub(crate) fn new(data: &Measurements, scalars: &[Scalar]) -> Self {
        let mut probes: Vec<Row> =
            data.rows.iter().step_by(data.rows.len().div_ceil(ROWS).max(1)).copied().collect();
        let measured = probes.len();
        for axis in 0..3 {
            let mut rows: Vec<&Row> = data.rows.iter().collect();
            let place = |row: &Row| row.command.linear_mm[axis];
            rows.sort_by(|a, b| place(a).total_cmp(&place(b)));
            rows.dedup_by(|b, a| place(b) - place(a) < 1e-3);
            let step = rows.len().div_ceil(PLACES).max(1);
            for pair in rows.windows(2).step_by(step) {
                for share in BETWEEN {
                    let mut row = *pair[0];
                    row.command.linear_mm[axis] += share * (place(pair[1]) - place(pair[0]));
                    probes.push(row);
                }
            }
        }
        let (mut largest_um, mut widest_um): (f64, f64) = (0.0, 0.0);
        for class in 0..4 {
            let gaps = || scalars.iter().filter(|s| s.class == class).map(|s| s.gap_um);
            if let Some(middle) = median(&mut gaps().collect::<Vec<f64>>()) {
                largest_um = gaps().fold(largest_um, |most, gap| most.max((gap - middle).abs()));
                let ends = gaps().fold((middle, middle), |(low, high), gap| (gap.min(low), gap.max(high)));
                widest_um = widest_um.max(ends.1 - ends.0);
            }
        }
        Self { probes, measured, known: RefCell::default(), largest_um, widest_um }
    }

    /// Displacements by some terms at and between the places measured, µm.
    fn displacements_um(&self, terms: &[(Term, f64)], geometry: &EffectGeometry) -> Vec<Vector> {
        let mut sums = vec![Vector::zeros(); self.probes.len()];
        for (term, value) in terms {
            let own = self.displaced_by(term, geometry);
            sums.iter_mut().zip(own.iter()).for_each(|(sum, own)| *sum += own * *value);
        }
        sums
    }

    /// What one of a term displaces at and between the places measured, µm.
    fn displaced_by(&self, term: &Term, geometry: &EffectGeometry) -> Rc<[Vector]> {
        let known = self.known.borrow().iter().find(|(known, _)| known == term).map(|(_, all)| all.clone());
        known.unwrap_or_else(|| {
            let all: Rc<[Vector]> =
                self.probes.iter().map(|row| term.displacement_um(row, geometry)).collect();
            self.known.borrow_mut().push((*term, all.clone()));
            all
        })
    }

    /// Mean over the rows of what [`Self::displacements_um`] gives.
    fn mean(&self, all: &[Vector]) -> Vector {
        all.iter().take(self.measured).sum::<Vector>() / self.measured.max(1) as f64
    }

    /// Largest displacement by some terms at and between the places measured, from their mean over the rows, µm.
    fn excursion_um(&self, terms: &[(Term, f64)], geometry: &EffectGeometry) -> f64 {
        let all = self.displacements_um(terms, geometry);
        let mean = self.mean(&all);
        all.iter().map(|d| (d - mean).amax()).fold(0.0, f64::max)
    }

    /// True where a play that varies along its axis is lost at some places and gained at others.
    fn changes_sign(&self, axis: usize, terms: &[(Term, f64)]) -> bool {
        /// Noise may take a play that all but vanishes at one end to this share of the largest beyond zero.
        const BEYOND: f64 = 0.25;
        let lost = self.probes.iter().map(|row| {
            let at_mm = row.command.linear_mm[axis];
            let part = |(term, um): &(Term, f64)| match term {
                Term::Effect { index, shape, .. } => um * legendre(*index, shape.relative(at_mm)),
                _ => 0.0,
            };
            terms.iter().map(part).sum::<f64>()
        });
        let (low, high) = lost.fold((0.0_f64, 0.0_f64), |(low, high), um| (low.min(um), high.max(um)));
        f64::min(-low, high) > BEYOND * f64::max(-low, high)
    }

    /// What is wrong with a cause of these numbers; `None` where nothing is.
    pub(crate) fn broken_by(
        &self,
        kind: EffectKind,
        terms: &[(Term, f64)],
        geometry: &EffectGeometry,
    ) -> Option<Why> {
        if let Some(reason) = implausible(kind, terms) {
            return Some(reason);
        }
        if let EffectKind::Backlash(axis) = kind
            && self.changes_sign(axis, terms)
        {
            return Some([
                "what is lost at a reversal changes its sign along the axis, which no play does",
                "потеря при реверсе меняет знак вдоль оси, чего с люфтом не бывает",
            ]);
        }
        let largest_um = if is_straight(kind) { self.widest_um } else { self.largest_um };
        let harmful = self.excursion_um(terms, geometry) > LARGEST * largest_um;
        harmful.then_some([
            "between the places measured it would displace by more than twice the largest reading",
            "между измеренными точками он дал бы смещение больше удвоенного наибольшего отсчёта",
        ])
    }
}

/// Logarithm of how plausible coefficients are before anything is measured, as far as it parts effects that look alike.
pub(crate) fn log_prior(values: &[(Term, f64)]) -> f64 {
    let of = |(term, value): &(Term, f64)| match term {
        Term::Effect { kind, .. } => -0.5 * (value / effects::of(*kind).search.usual).powi(2),
        _ => 0.0,
    };
    values.iter().map(of).sum()
}

/// Numbers that no machine has.
fn implausible(kind: EffectKind, terms: &[(Term, f64)]) -> Option<Why> {
    let (most, why) = effects::of(kind).search.most?;
    terms.iter().any(|(_, value)| value.abs() > most).then_some(why)
}
