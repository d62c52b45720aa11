//! What both ball-bar adjustments share: the base with a change, and what to say of an adjustment.

use diagnostic::{Language, Text, both};
use std::rc::Rc;

use machine_model::{Description, RigidBody, Vector, WithEffects};
use nalgebra::{DMatrix, DVector};

use crate::adjustment::Estimate;
use crate::error::CalibrationError;
use crate::field;
use crate::student::quantile_95;

/// A good measurement has a reading as far from the others as one that is refused with this chance.
const OUTLIER_CHANCE: f64 = 1e-6;

/// No ball bar resolves less, mm: what is smaller is no contradiction, however small the noise.
pub(crate) const RESOLVED_MM: f64 = 1e-4;

/// The base with something of its description changed; effects and conditions stay.
pub(crate) fn changed(base: &WithEffects, change: impl FnOnce(&mut Description)) -> WithEffects {
    let mut description = base.base().description().clone();
    change(&mut description);
    let machine = RigidBody::new(description).expect("travel and tables are the base's");
    WithEffects::new(machine, base.terms().to_vec(), *base.conditions())
        .expect("the base knew every condition that its effects need")
}

/// The base under the conditions of each run, changed once for all runs of the same conditions.
pub(crate) fn each_changed(
    machines: &[WithEffects],
    change: impl Fn(&WithEffects) -> WithEffects,
) -> Vec<Rc<WithEffects>> {
    let mut done: Vec<(&WithEffects, Rc<WithEffects>)> = Vec::new();
    machines
        .iter()
        .map(|machine| {
            let same = done.iter().find(|(known, _)| known.conditions() == machine.conditions());
            if let Some((_, changed)) = same {
                return Rc::clone(changed);
            }
            let changed = Rc::new(change(machine));
            done.push((machine, Rc::clone(&changed)));
            changed
        })
        .collect()
}

/// Refuses fewer readings than unknowns.
pub(crate) fn too_few(readings: usize, unknowns: usize) -> Result<(), CalibrationError> {
    if readings > unknowns {
        return Ok(());
    }
    Err(CalibrationError::TooFew(both!(
        "{readings} readings for {unknowns} unknowns",
        "отсчётов {readings} на {unknowns} неизвестных"
    )))
}

/// Names of what is not told apart: `EXX from EYX`.
pub(crate) fn from_one_another(names: &[Text]) -> Text {
    let of = |language, between: &str| {
        let names: Vec<&str> = names.iter().map(|name| name.in_language(language)).collect();
        names.join(between)
    };
    Text::new(of(Language::English, " from "), of(Language::Russian, " и "))
}

/// Refuses an adjustment with open combinations, by the names of the parameters that have a share in them.
pub(crate) fn open_error(estimate: &Estimate, names: &[Text]) -> Result<(), CalibrationError> {
    if estimate.open.is_empty() {
        return Ok(());
    }
    let texts: Vec<Text> = estimate
        .open
        .iter()
        .map(|combination| {
            let mut own: Vec<Text> = Vec::new();
            for (name, share) in names.iter().zip(combination) {
                if share.abs() > 0.05 && !own.contains(name) {
                    own.push(name.clone());
                }
            }
            from_one_another(&own)
        })
        .collect();
    Err(CalibrationError::Unobservable(Text::join(&texts, "; ")))
}

/// Refuses an adjustment in which one reading is far from all others.
pub(crate) fn no_outlier(estimate: &Estimate) -> Result<(), CalibrationError> {
    let Some(outlier) = estimate.outlier(OUTLIER_CHANCE).filter(|o| o.residual.abs() > RESOLVED_MM) else {
        return Ok(());
    };
    Err(CalibrationError::Outlier {
        point: outlier.reading,
        message: both!(
            "this length is {:.4} mm {} than all other readings say: {:.0} times its standard deviation",
            "эта длина на {:.4} мм {:#}, чем говорят все остальные отсчёты: это {:.0} её стандартных отклонений",
            outlier.residual.abs(),
            if outlier.residual > 0.0 {
                Text::pair("longer", "больше")
            } else {
                Text::pair("shorter", "меньше")
            },
            outlier.standardised.abs()
        ),
    })
}

/// What 95 % of the places of the field keep, mm, where the machine has these parameters: equation (51c).
///
/// * `positions` – real positions at the places for parameters of the estimate, mm
/// * `changed` – the parameters that the machine has; the others belong to the set-up
/// * `steps` – half the width of the central differences, in the unit of each parameter
pub(crate) fn field_u95_mm(
    estimate: &Estimate,
    positions: &dyn Fn(&DVector<f64>) -> Vec<Vector>,
    changed: &[usize],
    steps: &[f64],
) -> f64 {
    let places_mm = positions(&estimate.values);
    let mut displacements = DMatrix::zeros(3 * places_mm.len(), changed.len());
    for (column, &parameter) in changed.iter().enumerate() {
        let at = |by: f64| {
            let mut moved = estimate.values.clone();
            moved[parameter] += by;
            positions(&moved)
        };
        let (up, down) = (at(steps[parameter]), at(-steps[parameter]));
        for (place, (up, down)) in up.iter().zip(&down).enumerate() {
            let slope = (up - down) / (2.0 * steps[parameter]);
            displacements.fixed_view_mut::<3, 1>(3 * place, column).copy_from(&slope);
        }
    }
    let covariance =
        DMatrix::from_fn(changed.len(), changed.len(), |i, k| estimate.covariance[(changed[i], changed[k])]);
    let spreads = field::spreads(&places_mm, displacements, &covariance);
    field::quantile_of_points(&spreads) * estimate.coverage_factor_95() / quantile_95(None)
}
