//! A profile for people, and its JSON Schema.

mod machine;
mod program;
mod sense;

pub use sense::plus_turns;

use diagnostic::{Language, Text, both};
use machine_model::EngineId;

use toolpath::{ArcChords, Following};

use crate::format::Document;
use crate::profile::{Outside, Profile};

/// The JSON Schema of `format = 1`.
#[must_use]
pub fn schema() -> String {
    let schema = schemars::schema_for!(Document);
    // A schema is plain data: maps with text keys, which JSON can always write.
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}

/// Lines in every language.
#[derive(Default)]
struct Lines(Text);

impl Lines {
    fn line(&mut self, mut said: Text) {
        said.push(&Text::pair("\n", "\n"));
        self.say(&said);
    }

    /// The begin of a line.
    fn say(&mut self, said: &Text) {
        self.0.push(said);
    }
}

impl Profile {
    /// What the profile says, as text: one fact per line, units named.
    #[must_use]
    pub fn show(&self, language: Language) -> String {
        let mut out = Lines::default();
        self.write(&mut out);
        out.0.in_language(language).to_owned()
    }

    fn write(&self, out: &mut Lines) {
        out.line(both!("machine      {}", "станок       {}", self.name));
        self.write_control(out);
        self.write_chain(out);
        self.write_calibration(out);
        self.write_linear_axes(out);
        let s = self.description.squareness;
        out.line(both!(
            "squareness   EC0Y {:.2} urad, EB0Z {:.2} urad, EA0Z {:.2} urad",
            "перпендик.   EC0Y {:.2} мкрад, EB0Z {:.2} мкрад, EA0Z {:.2} мкрад",
            s.ec0y_rad * 1e6,
            s.eb0z_rad * 1e6,
            s.ea0z_rad * 1e6
        ));
        self.write_rotary_axes(out);
        self.write_traverses(out);
        if let Some(field) = &self.field {
            field.write(out);
        }
        let [x, y, z] = self.default_tool_mm;
        out.line(both!("tool         default {x} {y} {z} mm", "инструмент   по умолчанию {x} {y} {z} мм"));
        if let Some(length_mm) = self.gauge_point_mm {
            out.line(both!("  gauge point  {length_mm} mm", "  базовая точка {length_mm} мм"));
        }
        for (number, [x, y, z]) in &self.tools {
            out.line(both!("  H{number}         {x} {y} {z} mm", "  H{number}         {x} {y} {z} мм"));
        }
        for (name, [x, y, z]) in &self.work_offsets {
            out.line(both!("{name}          {x} {y} {z} mm", "{name}          {x} {y} {z} мм"));
        }
        let c = self.correction;
        let outside = if c.outside == Outside::Refuse {
            Text::pair("refused", "отклоняется")
        } else {
            Text::pair("clamped", "берёт ближайшую точку")
        };
        let engine: EngineId = c.engine;
        out.line(both!(
            "correction   engine {engine}, tolerance {} um, feed outside {outside}",
            "коррекция    метод {engine}, допуск {} мкм, рабочий ход вне объёма {outside:#}",
            c.tolerance_um
        ));
        self.write_program_rules(out);
        self.write_kinematics(out);
        for effect in &self.effects {
            let text: Vec<String> =
                effect.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            out.line(both!("effect       {} {}", "эффект       {} {}", effect.id, text.join(", ")));
        }
    }

    fn write_control(&self, out: &mut Lines) {
        if let Some(control) = &self.control {
            out.line(both!("control      {control}", "ЧПУ          {control}"));
        }
        match self.interpolator.blending_mm {
            None => {}
            Some(0.0) => out.line(both!("corners      exact stop", "углы         точный останов")),
            Some(mm) => out.line(both!(
                "corners      the control keeps within {mm} mm of the path",
                "углы         стойка держит траекторию в пределах {mm} мм"
            )),
        }
        match self.interpolator.arcs {
            None => {}
            Some(ArcChords::Length(mm)) => {
                out.line(both!("arcs         chords of {mm} mm", "дуги         хорды по {mm} мм"));
            }
            Some(ArcChords::Tolerance(mm)) => {
                out.line(both!(
                    "arcs         chords {mm} mm beside them",
                    "дуги         хорды в {mm} мм от них"
                ));
            }
        }
        if let Some(acceleration) = self.interpolator.acceleration_mm_s2 {
            out.line(both!("acceleration {acceleration} mm/s²", "ускорение    {acceleration} мм/с²"));
        }
        if let Some(Following { gain_1_s: [x, y, z], feed_forward: [fx, fy, fz], .. }) =
            self.interpolator.following
        {
            out.line(both!(
                "following    gains {x}, {y}, {z} 1/s, feed forward {fx}, {fy}, {fz}",
                "слежение     усиление {x}, {y}, {z} 1/с, упреждение {fx}, {fy}, {fz}"
            ));
        }
    }
}
