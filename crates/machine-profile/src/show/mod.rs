//! A profile for people, and its JSON Schema.

mod machine;
mod program;
mod sense;

pub use sense::plus_turns;

use std::fmt::Write as _;

use diagnostic::{Language, Text};
use machine_model::EngineId;

use crate::format::Document;
use crate::profile::{Outside, Profile};

/// The JSON Schema of `format = 1`.
#[must_use]
pub fn schema() -> String {
    let schema = schemars::schema_for!(Document);
    // A schema is plain data: maps with text keys, which JSON can always write.
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}

/// A line in a language.
macro_rules! tell {
    ($out:expr, $language:expr, $($said:tt)+) => {
        writeln!($out, "{}", diagnostic::say!($language, $($said)+))
    };
}
pub(crate) use tell;

impl Profile {
    /// What the profile says, as text: one fact per line, units named.
    #[must_use]
    pub fn show(&self, language: Language) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write(&mut out, language);
        out
    }

    fn write(&self, out: &mut String, language: Language) -> std::fmt::Result {
        tell!(out, language, "machine      {}", "станок       {}", self.name)?;
        if let Some(control) = &self.control {
            tell!(out, language, "control      {control}", "ЧПУ          {control}")?;
        }
        match self.blending_mm {
            None => {}
            Some(0.0) => tell!(out, language, "corners      exact stop", "углы         точный останов")?,
            Some(mm) => tell!(
                out,
                language,
                "corners      the control keeps within {mm} mm of the path",
                "углы         стойка держит траекторию в пределах {mm} мм"
            )?,
        }
        self.write_chain(out, language)?;
        self.write_calibration(out, language)?;
        self.write_linear_axes(out, language)?;
        let s = self.description.squareness;
        tell!(
            out,
            language,
            "squareness   EC0Y {:.2} urad, EB0Z {:.2} urad, EA0Z {:.2} urad",
            "перпендик.   EC0Y {:.2} мкрад, EB0Z {:.2} мкрад, EA0Z {:.2} мкрад",
            s.ec0y_rad * 1e6,
            s.eb0z_rad * 1e6,
            s.ea0z_rad * 1e6
        )?;
        self.write_rotary_axes(out, language)?;
        self.write_traverses(out, language)?;
        if let Some(field) = &self.field {
            field.write(out, language)?;
        }
        let [x, y, z] = self.default_tool_mm;
        tell!(
            out,
            language,
            "tool         default {x} {y} {z} mm",
            "инструмент   по умолчанию {x} {y} {z} мм"
        )?;
        if let Some(length_mm) = self.gauge_point_mm {
            tell!(out, language, "  gauge point  {length_mm} mm", "  базовая точка {length_mm} мм")?;
        }
        for (number, [x, y, z]) in &self.tools {
            tell!(out, language, "  H{number}         {x} {y} {z} mm", "  H{number}         {x} {y} {z} мм")?;
        }
        for (name, [x, y, z]) in &self.work_offsets {
            tell!(out, language, "{name}          {x} {y} {z} mm", "{name}          {x} {y} {z} мм")?;
        }
        let c = self.correction;
        let outside = if c.outside == Outside::Refuse {
            Text::pair("refused", "отклоняется")
        } else {
            Text::pair("clamped", "берёт ближайшую точку")
        };
        let engine: EngineId = c.engine;
        tell!(
            out,
            language,
            "correction   engine {engine}, tolerance {} um, feed outside {outside}",
            "коррекция    метод {engine}, допуск {} мкм, рабочий ход вне объёма {outside:#}",
            c.tolerance_um
        )?;
        self.write_program_rules(out, language)?;
        self.write_kinematics(out, language)?;
        for effect in &self.effects {
            let text: Vec<String> =
                effect.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            tell!(out, language, "effect       {} {}", "эффект       {} {}", effect.id, text.join(", "))?;
        }
        Ok(())
    }
}
