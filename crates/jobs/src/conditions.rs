//! What the machine's effects depend on besides the command: `--at temp_c=24,load_kg=100`.

use diagnostic::{Code, Diagnostic, Speaks, Text, both, notice};
use machine_model::effects::Conditions;
use machine_model::{Engine, EngineId};
use machine_profile::{EngineError, Profile};

use crate::message::{Failure, OPTION, Report};
use crate::options::JobOptions;
use crate::values::Condition;

/// An effect depends on a condition that nobody gave.
pub const UNKNOWN_CONDITION: Code = Code(401);
/// The engine cannot take the profile's effects into account.
pub const ENGINE_WITHOUT_EFFECTS: Code = Code(402);

/// Warning: another temperature than that of the calibration.
const OTHER_TEMPERATURE: Code = Code(1111);

/// The conditions of the command line; later ones fill in, none may stand there twice.
///
/// # Errors
/// The one that does.
pub fn conditions(options: &JobOptions) -> Result<Conditions, Failure> {
    let mut found = Conditions::default();
    for given in &options.at {
        for (condition, value) in &given.0 {
            // One temperature for all axes beside one of an axis says two things of that axis.
            let places: Vec<&mut Option<f64>> = match condition {
                Condition::Temperatures => found.temp_c.iter_mut().collect(),
                Condition::Temperature(axis) => vec![&mut found.temp_c[*axis]],
                Condition::Time => vec![&mut found.time_s],
                Condition::Load => vec![&mut found.load_kg],
                Condition::Feed => vec![&mut found.feed_mm_min],
            };
            for place in places {
                if place.replace(*value).is_some() {
                    return Err(Failure::usage(notice!(OPTION;
                        "`--at {given}`: `{}` is given twice",
                        "`--at {given}`: `{}` дано дважды", condition.name();
                        "leave one", "оставьте одно"
                    )));
                }
            }
        }
    }
    Ok(found)
}

/// A warning where the machine is warmer or colder than it was calibrated, and no effect of the profile says what that does: steel
/// (11.5 µm/m/K) over the longest edge of the calibrated volume, where that exceeds the tolerance.
///
/// # Errors
/// A condition that is given twice.
pub fn temperature(
    profile: &Profile,
    options: &JobOptions,
    tolerance_um: f64,
) -> Result<Option<Report>, Failure> {
    const STEEL_UM_PER_M_K: f64 = 11.5;
    let Some(calibrated_c) = profile.calibrated.as_ref().and_then(|c| c.temperature_c) else {
        return Ok(None);
    };
    let temperatures = conditions(options)?.temp_c;
    let mut worst: Option<(char, f64, f64)> = None;
    for (axis, temperature) in temperatures.iter().enumerate() {
        let letter = ['X', 'Y', 'Z'][axis];
        let said = profile.effects.iter().any(|e| e.id == format!("thermal.{letter}"));
        let Some(temperature) = temperature.filter(|_| !said) else { continue };
        let range = profile.volume().0[axis];
        let length_m = (range.high - range.low) * 1e-3;
        let um = (temperature - calibrated_c).abs() * STEEL_UM_PER_M_K * length_m;
        if length_m.is_finite() && um > tolerance_um && worst.is_none_or(|(_, _, most)| um > most) {
            worst = Some((letter, temperature, um));
        }
    }
    Ok(worst.map(|(letter, temperature, um)| {
        Report::warning(notice!(OTHER_TEMPERATURE;
            "the machine was calibrated at {calibrated_c} °C and is used at {temperature} °C: steel grows by {um:.1} um over the volume in {letter}",
            "станок откалиброван при {calibrated_c} °C, а работает при {temperature} °C: сталь удлиняется по {letter} на длине объёма на {um:.1} мкм";
            "calibrate at the temperature of use, or give the profile a `thermal.{letter}` effect",
            "калибруйте при рабочей температуре или внесите в профиль эффект `thermal.{letter}`"
        ))
    }))
}

/// What the profile leaves in doubt, where this engine uses it.
#[must_use]
pub fn doubts(profile: &Profile, id: EngineId) -> Option<Report> {
    let diagnostics = profile.doubts(id);
    (!diagnostics.is_empty()).then_some(Report { source: None, diagnostics })
}

/// The engine of a name or of the profile, with the profile's effects under the conditions of the command line.
///
/// # Errors
/// The profile lacks what the engine takes, or the options a condition.
pub fn engine(profile: &Profile, id: EngineId, options: &JobOptions) -> Result<Box<dyn Engine>, Failure> {
    profile.engine(id, &conditions(options)?).map_err(|error| failure(&error))
}

/// What to say, and what to type.
#[must_use]
pub fn failure(error: &EngineError) -> Failure {
    let (code, help) = match error {
        EngineError::Build(_) => (
            OPTION,
            both!(
                "see `vpost profile show` for what the profile gives",
                "что есть в профиле, покажет `vpost profile show`"
            ),
        ),
        EngineError::Effect(_) => {
            (UNKNOWN_CONDITION, both!("correct the profile's [[effect]]", "исправьте [[effect]] профиля"))
        }
        EngineError::Condition(unknown) => {
            let option = match unknown.condition.0 {
                "temperature" => both!(
                    "`--at temp_c=24` (degrees Celsius; one axis: temp_x_c)",
                    "`--at temp_c=24` (градусы Цельсия; для одной оси: temp_x_c)"
                ),
                "time" => both!(
                    "`--at time_s=3600` (seconds since power-on, as in the measurements)",
                    "`--at time_s=3600` (секунды от включения, как в измерениях)"
                ),
                "load" => both!("`--at load_kg=100`", "`--at load_kg=100`"),
                "feed" => {
                    both!(
                        "`--at feed_mm_min=500`: the feed for which points are wanted; a program's F is not what the axes do near corners and stops, so it is not taken for it",
                        "`--at feed_mm_min=500`: подача, для которой нужны точки; F программы не годится — у углов и остановок оси идут не с ней"
                    )
                }
                _ => Text::same("`--at`"),
            };
            (
                UNKNOWN_CONDITION,
                both!(
                    "say it: {option}; or take the effect out of the profile",
                    "скажите её: {option:#}; или уберите эффект из профиля"
                ),
            )
        }
        EngineError::ReferenceTemperature { .. } => (
            UNKNOWN_CONDITION,
            both!(
                "add it to the profile: calibrated = {{ temperature_c = 20.0 }}",
                "добавьте её в профиль: calibrated = {{ temperature_c = 20.0 }}"
            ),
        ),
        EngineError::Lathe { .. } => {
            (OPTION, both!("use `--engine rigid-body`", "возьмите `--engine rigid-body`"))
        }
        EngineError::WithoutEffects { .. } => (
            ENGINE_WITHOUT_EFFECTS,
            both!(
                "use `--engine rigid-body`, which can, or take the [[effect]] entries out of the profile",
                "возьмите `--engine rigid-body`, он учитывает, или уберите разделы [[effect]] из профиля"
            ),
        ),
    };
    Failure::usage(Diagnostic::error(code, error.text()).help(help))
}
