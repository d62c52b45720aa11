//! A profile's machine with its effects: what predicts and corrects.

use diagnostic::Speaks;
use machine_model::effects::{Conditions, EffectError, EffectGeometry, EffectKind, EffectTerm};
use machine_model::engines::{BuildError, build};
use machine_model::{Engine, EngineId, PathModel, UnknownCondition, Vector, WithEffects};
use thiserror::Error;
use turning::Lathe;

use crate::{LatheParts, Profile};

/// Why a profile gives no engine.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EngineError {
    /// The profile lacks what the engine is made of.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// An entry is no effect.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// An effect depends on something that is not known.
    #[error(transparent)]
    Condition(#[from] UnknownCondition),
    /// An effect counts from the temperature of the calibration.
    #[error(
        "the effect {effect} counts from the temperature at which the machine was calibrated, which the profile does not give"
    )]
    ReferenceTemperature {
        /// The effect.
        effect: EffectKind,
    },
    /// An engine of mills.
    #[error("engine `{engine}` models no lathe")]
    Lathe {
        /// The engine.
        engine: &'static str,
    },
    /// An engine that knows nothing but its tables.
    #[error("engine `{engine}` cannot take the profile's effects into account: {effects}")]
    WithoutEffects {
        /// The engine.
        engine: &'static str,
        /// Ids of the effects.
        effects: String,
    },
}

impl Speaks for EngineError {
    fn russian(&self) -> String {
        match self {
            Self::Build(error) => error.russian(),
            Self::Effect(error) => error.russian(),
            Self::Condition(error) => error.russian(),
            Self::ReferenceTemperature { effect } => {
                format!("эффект {effect} отсчитывается от температуры калибровки, а её в профиле нет")
            }
            Self::Lathe { engine } => format!("метод `{engine}` токарного станка не моделирует"),
            Self::WithoutEffects { engine, effects } => {
                format!("метод `{engine}` не учитывает эффектов профиля: {effects}")
            }
        }
    }
}

impl Profile {
    /// What effects must know of the machine: chain, rotary axes, temperature of the calibration.
    #[must_use]
    pub fn effect_geometry(&self) -> EffectGeometry {
        let mut geometry = EffectGeometry::from_chain(self.chain());
        for (to, from) in geometry.rotary_centre_mm.iter_mut().zip(&self.description.rotary) {
            *to = from.centre_mm;
        }
        geometry.rotary_direction = [0, 1, 2].map(|axis| self.description.rotary[axis].direction);
        geometry.rotary_tilt = [0, 1, 2].map(|axis| self.description.rotary[axis].tilt);
        if let Some(temperature_c) = self.calibrated.as_ref().and_then(|calibrated| calibrated.temperature_c)
        {
            geometry.reference_temp_c = temperature_c;
        }
        geometry
    }

    /// The effects on this machine. Faults of the measuring instrument are effects too, but the machine does not go
    /// wrong by them: they are left out.
    ///
    /// # Errors
    /// [`EngineError::Effect`] for an entry that is none (loading refuses it);
    /// [`EngineError::ReferenceTemperature`].
    pub fn effect_terms(&self) -> Result<Vec<EffectTerm>, EngineError> {
        let mut terms = self.terms_of_all()?;
        terms.retain(|term| !term.kind().is_instrument());
        Ok(terms)
    }

    /// Those of the machine, and behind them those of the instrument.
    fn terms_of_all(&self) -> Result<Vec<EffectTerm>, EngineError> {
        let geometry = self.effect_geometry();
        let reference = self.calibrated.as_ref().and_then(|calibrated| calibrated.temperature_c);
        let mut terms = Vec::new();
        for entry in &self.effects {
            let term = EffectTerm::from_entry(&entry.id, &entry.parameters)?;
            let effect = term.kind();
            if reference.is_none() && matches!(effect, EffectKind::Thermal(_)) {
                return Err(EngineError::ReferenceTemperature { effect });
            }
            terms.push(term.with_geometry(geometry.clone()));
        }
        terms.sort_by_key(|term| term.kind().is_instrument());
        Ok(terms)
    }

    /// The machine as it really is under these conditions: tables, squareness, rotary axes and effects.
    ///
    /// # Errors
    /// [`EngineError`]: nothing an effect depends on is guessed.
    pub fn machine(&self, conditions: &Conditions) -> Result<WithEffects, EngineError> {
        Ok(WithEffects::new(self.rigid_body.clone(), self.effect_terms()?, *conditions)?)
    }

    /// The machine as the measuring instrument shows it: with the instrument's own faults.
    ///
    /// # Errors
    /// As [`Profile::machine`].
    pub fn measured_machine(&self, conditions: &Conditions) -> Result<WithEffects, EngineError> {
        Ok(WithEffects::new(self.rigid_body.clone(), self.terms_of_all()?, *conditions)?)
    }

    /// The lathe under these conditions; `None` for a mill.
    ///
    /// # Errors
    /// [`EngineError`], as [`Profile::machine`].
    pub fn lathe(&self, conditions: &Conditions) -> Result<Option<Lathe>, EngineError> {
        let Some(parts) = &self.lathe else { return Ok(None) };
        let linear: Box<dyn PathModel> = if self.effects.is_empty() {
            Box::new(self.rigid_body.clone())
        } else {
            Box::new(self.machine(conditions)?)
        };
        let tools = self.tools.iter().map(|(_, length)| -Vector::from(*length));
        let tools: Vec<Vector> = tools.chain([Vector::from(self.default_tool_mm)]).collect();
        let LatheParts { spindle, bending, tip, stations, .. } = parts.clone();
        Ok(Some(Lathe::new(linear, spindle, bending, tip, &tools).with_stations(stations)))
    }

    /// An engine for this profile under these conditions, effects included.
    ///
    /// # Errors
    /// [`EngineError`], also where the engine cannot take the profile's effects into account.
    pub fn engine(&self, id: EngineId, conditions: &Conditions) -> Result<Box<dyn Engine>, EngineError> {
        if let Some(lathe) = self.lathe(conditions)? {
            if id != EngineId::RigidBody {
                return Err(EngineError::Lathe { engine: id.name() });
            }
            return Ok(Box::new(lathe));
        }
        let terms = self.effect_terms()?;
        if terms.is_empty() {
            return Ok(build(id, self.engine_inputs_without_effects())?);
        }
        if id != EngineId::RigidBody {
            let ids: Vec<String> = terms.iter().map(|term| term.kind().to_string()).collect();
            return Err(EngineError::WithoutEffects { engine: id.name(), effects: ids.join(", ") });
        }
        Ok(Box::new(self.machine(conditions)?))
    }
}
