//! The machine without one of its causes of error at a time.
//!
//! A cause displaces the tool by what is missing without it: the error with all coefficients ε = 1 less that with those of
//! the cause 0, equation (52) and those behind it in `docs/equations.md`. Products of errors make the sum of all causes
//! another number than the whole: second order, some 10 nm for angles of 100 µrad.

use error_budget::{Family, Machine};
use machine_model::effects::Conditions;
use machine_model::{EngineId, FromDatum, Models, PathModel, TipControl, Vector, WithEffects};
use machine_profile::Profile;

use crate::conditions;
use crate::message::Failure;

/// A group of deviations that people name, look for and mend together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cause {
    /// Its key in pages: `squareness`, `positioning`, `straightness`, `angles`, `reversal`, `location`, `rotary`, `effect`.
    pub kind: &'static str,
    /// Which one: `EC0Y`, `EXX`, `X`, `thermal.X`.
    pub symbol: String,
}

/// A machine, and what it is without each of its causes.
pub struct Causes {
    machine: Machine,
    /// In the order of the deviations.
    causes: Vec<Cause>,
    without: Vec<(FromDatum, Option<TipControl>)>,
}

impl Causes {
    /// The causes of a profile's errors; none where they cannot be taken apart: on a lathe, and by engines that know the
    /// machine's errors only as a whole.
    ///
    /// # Errors
    /// The conditions do not suffice for an effect.
    pub fn of(profile: &Profile, engine: EngineId, conditions: &Conditions) -> Result<Option<Self>, Failure> {
        if engine != EngineId::RigidBody || profile.lathe.is_some() {
            return Ok(None);
        }
        let model = profile.machine(conditions).map_err(|error| conditions::failure(&error))?;
        let machine = Machine::new(model);
        let mut causes: Vec<Cause> = Vec::new();
        let mut belongs = Vec::new();
        for deviation in machine.deviations() {
            let cause = cause(&deviation.family(), &deviation.name);
            let known = causes.iter().position(|other| *other == cause);
            belongs.push(known.unwrap_or(causes.len()));
            if known.is_none() {
                causes.push(cause);
            }
        }
        let centres_mm = profile.kinematics.as_ref().map(|known| known.centres_mm.map(Vector::from));
        let without = (0..causes.len()).map(|cause| {
            let coefficients: Vec<f64> =
                belongs.iter().map(|of| if *of == cause { 0.0 } else { 1.0 }).collect();
            let machine = machine.scaled(&coefficients);
            // As the profile's own: no path under it is proven on a machine with effects.
            let tip = centres_mm.filter(|_| profile.effects.is_empty());
            let tip = tip.and_then(|centres_mm| TipControl::new(machine.base(), centres_mm));
            let Ok(machine) = FromDatum::new(Box::new(machine)) else { unreachable!("a model of paths") };
            (machine, tip)
        });
        let without = without.collect();
        Ok(Some(Self { machine, causes, without }))
    }

    /// In the order of [`Causes::without`].
    #[must_use]
    pub fn causes(&self) -> &[Cause] {
        &self.causes
    }

    /// The machine as it is.
    #[must_use]
    pub fn whole(&self) -> &WithEffects {
        self.machine.model()
    }

    /// The machine without each cause.
    #[must_use]
    pub fn without(&self) -> Vec<Models<'_>> {
        self.without
            .iter()
            .map(|(axes, tip)| Models { axes, tip: tip.as_ref().map(|tip| tip as &dyn PathModel) })
            .collect()
    }
}

fn cause(family: &Family, name: &str) -> Cause {
    let (kind, symbol) = match family {
        Family::Squareness => ("squareness", name.to_owned()),
        Family::Positioning(_) => ("positioning", name.to_owned()),
        Family::Straightness(axis) => ("straightness", axis.letter().to_string()),
        Family::Angular(axis) => ("angles", axis.letter().to_string()),
        Family::Reversal(axis) => ("reversal", axis.letter().to_string()),
        Family::Location(axis) => ("location", axis.letter().to_string()),
        Family::Rotary(axis) => ("rotary", axis.letter().to_string()),
        Family::Effect => ("effect", name.to_owned()),
    };
    Cause { kind, symbol }
}
