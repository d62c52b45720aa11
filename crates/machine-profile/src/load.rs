//! From TOML text to a checked [`Profile`].

use diagnostic::{Speaks, Text, both};
use machine_model::effects::EffectTerm;
use machine_model::{
    Axis, Chain, Description, EngineId, Interpolation, LinearAxis, Range, RigidBody, Singularity,
};
use units::Angle;

use crate::error::{CHAIN, CONFLICT, EFFECT, FORMAT, ProfileError, VALUE, span};
use crate::field::Around;
use crate::format::{self, Correction, Document, InterpolationName, OutsideName};
use crate::loader::{ABOVE_ZERO, Loader, Read, ZERO_OR_MORE, triple};
use crate::number::{Finite, Spanned};
use crate::profile::{Calibrated, CorrectionOptions, EffectEntry, MeasuringFrame, Outside, Profile};
use crate::tables::ErrorRows;
use crate::toml_error;

/// Reads a profile. Paths of tables are handed to `read` as they are written: it resolves them against
/// the profile's place.
///
/// # Errors
/// Everything found wrong, VP0301 to VP0311, with spans into the profile or the table named.
pub fn load(text: &str, read: Read<'_>) -> Result<Profile, Vec<ProfileError>> {
    let document: Document =
        toml::from_str(text).map_err(|e| vec![ProfileError::profile(toml_error::diagnostic(text, &e))])?;
    let mut loader = Loader { read, errors: Vec::new() };
    let profile = loader.profile(document);
    match profile {
        Some(profile) if loader.errors.is_empty() => Ok(profile),
        _ => Err(loader.errors),
    }
}

/// The finest step that decimals are counted for, mm.
const FINEST_MM: f64 = 1e-6;
/// The Y that a lathe does not have stands at 0; so far it may be named.
const STANDING_MM: f64 = 1.0;

impl Loader<'_> {
    fn profile(&mut self, document: Document) -> Option<Profile> {
        if *document.format.get_ref() != 1 {
            let message = both!(
                "format {} of the profile is not known",
                "формат профиля {} неизвестен",
                document.format.get_ref()
            );
            let help = both!(
                "write format = 1, or use a newer vpost",
                "напишите format = 1 или возьмите vpost новее"
            );
            self.refuse(&document.format, FORMAT, message, both!("expected 1", "ожидалось 1"), help);
            return None;
        }
        let lathe_chain = self.lathe_chain(&document);
        let is_lathe = lathe_chain.is_some();
        let lathe = is_lathe.then(|| self.lathe(&document));
        let written = lathe_chain.as_ref().unwrap_or(document.chain.get_ref());
        let chain = match Chain::parse(written) {
            Ok(chain) => Some(chain),
            Err(e) => {
                let help = both!(
                    "write the axes from workpiece (w) to tool (t), b for the bed, like \"[w X Y b Z t]\"",
                    "напишите оси от детали (w) к инструменту (t), станина — b, например \"[w X Y b Z t]\""
                );
                self.refuse(&document.chain, CHAIN, e.text(), both!("this chain", "эта цепь"), help);
                None
            }
        };
        let interpolation = match document.interpolation {
            InterpolationName::Linear => Interpolation::Linear,
            InterpolationName::Monotone => Interpolation::Monotone,
        };
        let control = self.control(document.control.as_ref());
        let calibrated = document.calibrated.as_ref().map(|c| self.calibrated(c));
        let mut rows: [Option<ErrorRows>; 3] = [None, None, None];
        let mut resolution_mm = [0.001; 3];
        let axes = &document.axis;
        let mut linear = Vec::new();
        for (axis, written) in Axis::ALL.into_iter().zip([&axes.X, &axes.Y, &axes.Z]) {
            if is_lathe && axis == Axis::Y && written.is_none() {
                // It has no words that rounding could move it by.
                resolution_mm[1] = FINEST_MM;
                linear.push(Some(LinearAxis::perfect(Range { low: -STANDING_MM, high: STANDING_MM })));
                continue;
            }
            linear.push(self.linear(axis, written.as_ref(), interpolation, &mut rows, &mut resolution_mm));
        }
        let mut resolution_deg = [0.001; 3];
        let rotary = self.rotary(&document, chain.as_ref(), interpolation, &mut resolution_deg);
        let squareness = self.squareness(&document.squareness);
        let traverses = document.tracker.as_ref().and_then(|tracker| self.traverses(tracker));
        let mut tools = self.tools(&document.tool);
        let tool_names = self.tool_names(&document.tool, &tools);
        let cutter_radii_mm = self.cutter_radii(&document);
        let gauge_point_mm = self.gauge_point(&document, lathe.as_ref());
        let has_rotary = [Axis::A, Axis::B, Axis::C]
            .map(|axis| chain.as_ref().is_some_and(|chain| chain.axes().any(|own| own == axis)));
        let (work_offsets, zeros) = self.work_offsets(&document.work_offsets_mm, has_rotary);
        let correction = self.correction(&document.correction);
        let program = self.program_rules(&document, chain.as_ref());
        let kinematics =
            document.kinematics.as_ref().and_then(|written| self.kinematics(written, chain.as_ref()));
        let effects = self.effects(&document.effect);
        let setup = MeasuringFrame {
            shift_mm: triple(document.setup.shift_mm),
            rotation_rad: triple(document.setup.rotation_urad).map(|v| Angle::from_urad(v).rad()),
        };
        let linear: [LinearAxis; 3] = linear.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()?;
        let field = document.field.as_ref().and_then(|written| {
            let turning = if is_lathe {
                Some(both!("a spindle", "шпиндель"))
            } else {
                rotary_axes(chain.as_ref())
            };
            let around = Around {
                travel_mm: linear.each_ref().map(|axis| axis.travel_mm),
                default_tool_mm: triple(document.tool.default_mm),
                noise_um: None,
            };
            self.field(written, turning, around)
        });
        let description = Description { chain: chain?, linear, rotary, squareness };
        let lathe = lathe.map(|mut parts| {
            parts.noses = self.noses(&document.tool, &mut tools);
            parts.stations = self.stations(&document.tool, &tools);
            parts
        });
        let rigid_body = match RigidBody::new(description.clone()) {
            Ok(model) => model,
            Err(e) => {
                let at = [&axes.X, &axes.Y, &axes.Z][Axis::from_letter(e.axis)?.direction()].as_ref()?;
                let help = both!(
                    "travel_mm and the tables' position_mm are both machine coordinates",
                    "и travel_mm, и position_mm таблиц — координаты станка"
                );
                self.refuse(at, CONFLICT, e.text(), both!("this axis", "эта ось"), help);
                return None;
            }
        };
        Some(Profile {
            name: document.name,
            control_at: document.control.as_ref().map(|control| span(&control.span())),
            control: control.dialect,
            interpolator: control.interpolator,
            calibrated,
            description,
            resolution_mm,
            resolution_deg,
            interpolation,
            rows,
            traverses,
            field,
            default_tool_mm: triple(document.tool.default_mm),
            gauge_point_mm,
            tool_names,
            cutter_radii_mm,
            tools,
            work_offsets,
            zeros,
            lengths_touched_at_mm: document.tool.touched_at_mm.map(|place| triple(Some(place))),
            correction,
            program,
            kinematics,
            effects,
            setup,
            lathe,
            rigid_body,
        })
    }

    fn calibrated(&mut self, written: &format::Calibrated) -> Calibrated {
        if let Some(date) = &written.date
            && !is_date(date.get_ref())
        {
            let message = both!("`{}` is not a date", "`{}` — не дата", date.get_ref());
            let label = both!("expected year-month-day", "ожидалось год-месяц-день");
            let help = both!(
                "write year-month-day, like \"2023-05-15\"",
                "напишите год-месяц-день, например \"2023-05-15\""
            );
            self.refuse(date, VALUE, message, label, help);
        }
        let mut number = |given: &Option<_>, name| self.number(given.as_ref(), name, &ZERO_OR_MORE);
        Calibrated {
            repeatability_um: number(&written.repeatability_um, "repeatability_um"),
            uncertainty_um: number(&written.uncertainty_um, "uncertainty_um"),
            date: written.date.as_ref().map(|d| d.get_ref().clone()),
            temperature_c: written.temperature_c.map(|Finite(t)| t),
            instrument: written.instrument.clone(),
        }
    }

    fn correction(&mut self, written: &Correction) -> CorrectionOptions {
        let mut engine = EngineId::RigidBody;
        if let Some(name) = &written.engine {
            let usable = || EngineId::ALL.into_iter().filter(|id| !id.is_published()).map(EngineId::name);
            match EngineId::from_name(name.get_ref()).filter(|id| !id.is_published()) {
                Some(id) => engine = id,
                None => {
                    let message = both!(
                        "`{}` is no engine that corrects programs",
                        "`{}` — не метод, которым исправляют программы",
                        name.get_ref()
                    );
                    let names = usable().collect::<Vec<&str>>().join(", ");
                    let help = match diagnostic::closest(name.get_ref(), usable()) {
                        Some(near) => both!(
                            "did you mean \"{near}\"? Engines: {names}",
                            "имелось в виду \"{near}\"? Методы: {names}"
                        ),
                        None => both!("engines: {names}", "методы: {names}"),
                    };
                    self.refuse(name, VALUE, message, both!("this engine", "этот метод"), help);
                }
            }
        }
        let mut number = |value: &Option<_>, name, bounds, default| {
            self.number(value.as_ref(), name, bounds).unwrap_or(default)
        };
        let usual = Singularity::default();
        let turn_deg = usual.most_turn_rad.to_degrees();
        let Correction { tolerance_um, minimum_segment_mm, orientation_urad, .. } = written;
        let Correction { singular_sin, singular_turn_deg, singular_share, .. } = written;
        CorrectionOptions {
            engine,
            tolerance_um: number(tolerance_um, "tolerance_um", &ABOVE_ZERO, 1.0),
            accept_um: written
                .accept_um
                .as_ref()
                .map(|_| number(&written.accept_um, "accept_um", &ZERO_OR_MORE, 0.0)),
            outside: match written.outside {
                OutsideName::Refuse => Outside::Refuse,
                OutsideName::Clamp => Outside::Clamp,
            },
            minimum_segment_mm: number(minimum_segment_mm, "minimum_segment_mm", &ZERO_OR_MORE, 0.0),
            orientation_urad: number(orientation_urad, "orientation_urad", &ABOVE_ZERO, 50.0),
            directions: matches!(written.orientation, format::OrientationName::Full),
            singularity: Singularity {
                least_sin: number(singular_sin, "singular_sin", &ABOVE_ZERO, usual.least_sin),
                most_turn_rad: number(singular_turn_deg, "singular_turn_deg", &ABOVE_ZERO, turn_deg)
                    .to_radians(),
                most_share: number(singular_share, "singular_share", &ABOVE_ZERO, usual.most_share),
            },
        }
    }

    fn effects(
        &mut self,
        written: &[Spanned<std::collections::BTreeMap<String, Spanned<toml::Value>>>],
    ) -> Vec<EffectEntry> {
        let mut effects = Vec::new();
        for entry in written {
            let mut id = None;
            let mut parameters = Vec::new();
            for (name, value) in entry.get_ref() {
                let number = match value.get_ref() {
                    toml::Value::String(text) if name == "id" => {
                        id = Some((value, text.clone()));
                        continue;
                    }
                    toml::Value::Integer(number) => *number as f64,
                    toml::Value::Float(number) => *number,
                    _ => f64::NAN,
                };
                if number.is_finite() && name != "id" {
                    parameters.push((name.clone(), number));
                } else {
                    let what = if name == "id" {
                        both!("a text", "текст")
                    } else {
                        both!("a finite number", "конечное число")
                    };
                    let message =
                        both!("`{name}` of an effect must be {what}", "`{name}` эффекта — это {what:#}");
                    let label = both!("expected {what}", "ожидалось: {what:#}");
                    self.refuse(value, EFFECT, message, label, Text::EMPTY);
                }
            }
            let Some((place, id)) = id else {
                let message = both!("an effect lacks its id", "у эффекта нет id");
                let help = both!(
                    "add id = \"backlash.X\", or whichever it is",
                    "добавьте id = \"backlash.X\" или какой он есть"
                );
                self.refuse(entry, EFFECT, message, both!("this effect", "этот эффект"), help);
                continue;
            };
            if let Err(e) = EffectTerm::from_entry(&id, &parameters) {
                self.refuse(place, EFFECT, e.text(), both!("this effect", "этот эффект"), Text::EMPTY);
            }
            effects.push(EffectEntry { id, parameters });
        }
        effects
    }
}

/// `rotary axes A, C`, where the chain has some.
fn rotary_axes(chain: Option<&Chain>) -> Option<Text> {
    let letters: Vec<String> =
        chain?.axes().filter(|axis| !axis.is_linear()).map(|axis| axis.letter().to_string()).collect();
    let names = letters.join(", ");
    (!letters.is_empty()).then(|| both!("rotary axes, {names}", "поворотные оси, {names}"))
}

/// Year-month-day of the Gregorian calendar.
fn is_date(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let [year, month, day] = parts[..] else { return false };
    let digits = |part: &str, length: usize| {
        (part.len() == length && part.bytes().all(|b| b.is_ascii_digit()))
            .then(|| part.parse::<u32>().unwrap_or(0))
    };
    let (Some(year), Some(month), Some(day)) = (digits(year, 4), digits(month, 2), digits(day, 2)) else {
        return false;
    };
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        4 | 6 | 9 | 11 => 30,
        2 => 28 + u32::from(leap),
        1..=12 => 31,
        _ => return false,
    };
    (1..=days).contains(&day)
}
