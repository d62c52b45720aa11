//! The profile that a calibration writes, with its tables beside it.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use calibration::rotary_ballbar::Location;
use calibration::{Base, ChangedAxis, SetUp};
use clap::Args;
use diagnostic::{Speaks, notice};
use machine_model::effects::{Conditions, EffectKind};
use machine_model::{Axis, Chain, Command, Component, Description, Six, Vector};
use machine_profile::{Calibrated, Profile, ProfileText};
use measurement_files::micro;

use crate::figures::short;
use crate::message::{Failure, OPTION};
use crate::{lines, profile};

use super::codes::{QUESTION, UNSAID};
use super::work::{NewProfile, Work};

/// An axis that goes less far has none of its own: it stood there while others were measured.
pub(super) const SHORTEST_MM: f64 = 1e-3;

/// What every calibration is told about the profile it makes.
#[derive(Debug, Clone, Args)]
pub struct Target {
    /// Write this profile; without: the report only.
    ///
    /// Its tables go to a folder of the same name beside it. With -m: that profile, with what was measured in place of
    /// what it says.
    #[arg(short, long, value_name = "PROFILE.toml")]
    pub output: Option<PathBuf>,
    /// Name of the machine, for a new profile.
    #[arg(long, value_name = "TEXT")]
    pub name: Option<String>,
    /// Axes of a new profile: "[w X Y b Z t]".
    ///
    /// From the workpiece to the tool, b the bed.
    #[arg(long, value_name = "CHAIN")]
    pub chain: Option<String>,
    /// Day of the measurement: year-month-day.
    #[arg(long, value_name = "DATE")]
    pub date: Option<String>,
    /// Temperature of the machine, °C; else temp_c.
    ///
    /// During the measurement; default: the mean of the files' temp_c.
    #[arg(long, value_name = "C", value_parser = crate::options::finite)]
    pub temperature: Option<f64>,
    /// What it was measured with.
    #[arg(long, value_name = "TEXT")]
    pub instrument: Option<String>,
    /// Has the machine changed since this profile?
    #[arg(long, value_name = "OLD.toml")]
    pub against: Option<PathBuf>,
    /// Column to pass over (repeatable).
    #[arg(long, value_name = "NAME")]
    pub ignore_column: Vec<String>,
}

impl Target {
    /// A profile is made: to be written, or to be compared.
    pub(super) fn writes(&self) -> bool {
        self.output.is_some() || self.against.is_some()
    }
}

/// A profile in the making.
pub(super) struct Output {
    /// Its text.
    pub(super) text: ProfileText,
    /// The profile it is based on.
    pub(super) base: Option<Profile>,
    /// Tables: name inside the profile's folder, bytes.
    tables: Vec<(String, Vec<u8>)>,
    folder: String,
}

/// What is said of a new profile must not contradict the base: the base's would hold without a word.
fn agrees(base: &Profile, target: &Target, work: &Work<'_>) -> Result<(), Failure> {
    let squeezed = |text: &str| text.split_whitespace().collect::<String>();
    let chain = base.chain().to_string();
    // Where the base names no control the new profile takes the one that is said.
    let control = base.control.clone().or_else(|| work.options.dialect.clone()).unwrap_or_default();
    let asked = [
        ("--chain", target.chain.as_deref(), chain),
        ("--dialect", work.options.dialect.as_deref(), control),
    ];
    for (option, said, known) in asked {
        if let Some(said) = said.filter(|said| squeezed(said) != squeezed(&known)) {
            return Err(Failure::usage(notice!(QUESTION;
                "`{option} {said}`, and the base profile says `{known}`",
                "`{option} {said}`, а в исходном профиле `{known}`";
                "leave out `{option}`: it is for a new profile, without `-m`",
                "уберите `{option}`: этот ключ — для нового профиля, без `-m`"
            )));
        }
    }
    Ok(())
}

impl Output {
    /// From `-m`, or new. `chain` must be known then: nothing about a machine is guessed.
    ///
    /// * `load` – reads the profile of a mill, or of any machine
    pub(super) fn start(
        target: &Target,
        work: &Work<'_>,
        load: fn(&Path) -> Result<profile::Loaded, Failure>,
    ) -> Result<Self, Failure> {
        let stem = target.output.as_deref().and_then(Path::file_stem);
        let folder = stem.map_or_else(|| "calibrated".to_owned(), |s| s.to_string_lossy().into_owned());
        if let Some(path) = &work.options.machine {
            let base = load(path)?.profile;
            agrees(&base, target, work)?;
            let text = profile_text(path)?;
            let Some(mut text) = ProfileText::parse(&text) else {
                return Err(Failure::usage(notice!(QUESTION;
                    "the base profile cannot be edited", "исходный профиль нельзя изменить";
                    "run `vpost profile check` on it", "запустите для него `vpost profile check`"
                )));
            };
            let from = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
            let mut tables = Vec::new();
            let mut broken = None;
            text.rename_tables(&mut |old| {
                let name = Path::new(old)
                    .file_name()
                    .map_or_else(|| old.to_owned(), |n| n.to_string_lossy().into_owned());
                match std::fs::read(from.join(old)) {
                    Ok(bytes) => tables.push((name.clone(), bytes)),
                    Err(error) => broken = Some(Failure::unread(old, &error)),
                }
                format!("{folder}/{name}")
            });
            if let Some(failure) = broken {
                return Err(failure);
            }
            if let Some(name) = &target.name {
                text.set_text(&["name"], name);
            }
            if let (None, Some(dialect)) = (&base.control, &work.options.dialect) {
                text.set_text(&["control"], dialect);
            }
            return Ok(Self { text, base: Some(base), tables, folder });
        }
        let Some(chain) = &target.chain else {
            return Err(Failure::usage(notice!(QUESTION;
                "which machine? its chain of axes is not known", "какой станок? цепь его осей неизвестна";
                "add `-m PROFILE.toml` of the same machine, or `--chain \"[w X Y b Z t]\"`: axes from workpiece (w) by the bed (b) to the tool (t)",
                "добавьте `-m PROFILE.toml` того же станка или `--chain \"[w X Y b Z t]\"`: оси от детали (w) через станину (b) к инструменту (t)"
            )));
        };
        let name = target.name.as_deref().unwrap_or("calibrated machine");
        let text = ProfileText::new(name, chain, work.options.dialect.as_deref());
        Ok(Self { text, base: None, tables: Vec::new(), folder })
    }

    /// The chain the profile will have.
    pub(super) fn chain(&self, target: &Target) -> Result<Chain, Failure> {
        let base = self.base.as_ref().map(|base| Ok(base.chain().clone()));
        base.unwrap_or_else(|| chain(target.chain.as_deref().unwrap_or_default(), "[w X Y b Z t]"))
    }

    /// The machine that readings are compared with: the base's own model, or an ideal one of the chain.
    pub(super) fn measured_from(&self, target: &Target) -> Result<Base, Failure> {
        Ok(match &self.base {
            Some(base) => Base {
                description: base.description.clone(),
                interpolation: base.interpolation,
                is_known: true,
            },
            None => Base::bare(self.chain(target)?),
        })
    }

    /// What the base's effects beyond its tables do at a command under these conditions, mm, workpiece frame.
    pub(super) fn by_effects_mm(
        &self,
        command: &Command,
        conditions: &Conditions,
    ) -> Result<Vector, Failure> {
        let Some(base) = self.base.as_ref().filter(|base| !base.effects.is_empty()) else {
            return Ok(Vector::zeros());
        };
        let machine = base.machine(conditions).map_err(|error| crate::conditions::failure(&error))?;
        Ok(machine.predict(command).position_mm - machine.base().predict(command).position_mm)
    }

    /// Writes the axes of a changed machine; what the base says beside them stays.
    pub(super) fn changed(&mut self, base: &Base, axes: &[ChangedAxis; 3], machine: &Description) {
        for (axis, own) in axes.iter().enumerate() {
            let name = Axis::ALL[axis];
            let letter = name.letter().to_string();
            self.tables(name, &own.positions_mm, own.given, [Some(&own.errors), own.negative.as_ref()]);
            let linear = &machine.linear[axis];
            if linear.backlash_mm != 0.0 {
                self.text.set_number(&["axis", &letter, "backlash_um"], linear.backlash_mm * 1e3, 4);
            }
            if !base.is_known {
                let others: Vec<(char, f64)> = (0..3)
                    .filter(|&k| k != axis)
                    .map(|k| (Axis::ALL[k].letter(), linear.measured_at_mm[k]))
                    .collect();
                self.text.set_measured_at(name.letter(), &others, linear.measured_tool_mm.into());
            }
        }
        if !base.is_known {
            self.text.set_text(&["interpolation"], "linear");
        }
        let angles = machine.squareness;
        for (key, value) in
            [("EC0Y_urad", angles.ec0y_rad), ("EB0Z_urad", angles.eb0z_rad), ("EA0Z_urad", angles.ea0z_rad)]
        {
            self.text.set_number(&["squareness", key], value * 1e6, 4);
        }
    }

    /// Writes how the instrument stood, where it stood in one place only: a profile holds one `[setup]`. Takes out how
    /// an earlier one did.
    pub(super) fn set_up(&mut self, setups: &[Option<SetUp>]) {
        self.text.remove(&["setup"]);
        if let [Some(SetUp::Frame(motion))] = setups {
            self.text.set_triple(&["setup", "shift_mm"], motion.shift_mm.into(), 7);
            self.text.set_triple(&["setup", "rotation_urad"], (motion.rotation_rad() * 1e6).into(), 4);
        }
    }

    /// Uncertainty of the whole where some of the base stays, mm: what was not measured is as uncertain as the base
    /// says. Warns where it does not say.
    pub(super) fn with_base_mm(&self, found_mm: f64, work: &Work<'_>) -> f64 {
        let Some(base) = &self.base else { return found_mm };
        let stated = base.calibrated.as_ref().and_then(|calibrated| calibrated.uncertainty_um);
        if stated.is_none() {
            work.warning(notice!(UNSAID;
                "the base does not say how well it is known: what was not measured now counts as exact in uncertainty_um",
                "исходный профиль не говорит, насколько точно он известен: не измеренное сейчас считается в uncertainty_um точным";
                "write `uncertainty_um` into `calibrated` of the base, if it is known",
                "впишите `uncertainty_um` в `calibrated` исходного профиля, если она известна"
            ));
        }
        units::math::hypot(found_mm, stated.unwrap_or(0.0) * 1e-3)
    }

    /// Puts a table beside the profile and gives the name by which the profile calls it.
    pub(super) fn table(&mut self, name: &str, bytes: Vec<u8>) -> String {
        self.tables.retain(|(old, _)| old != name);
        self.tables.push((name.to_owned(), bytes));
        format!("{}/{name}", self.folder)
    }

    /// Tables of an axis: towards plus, and towards minus where that is another.
    pub(super) fn tables(
        &mut self,
        axis: Axis,
        positions_mm: &[f64],
        given: [bool; 6],
        both_ways: [Option<&Vec<Six>>; 2],
    ) {
        for (key, rows) in ["errors", "errors_negative"].into_iter().zip(both_ways) {
            let Some(rows) = rows else { continue };
            self.errors(axis, key, positions_mm, &columns(given, rows));
        }
    }

    /// A location error of a rotary axis, in its own unit.
    pub(super) fn location(&mut self, location: &Location, value: f64, decimals: i32) {
        let (scale, unit) = micro(location.component);
        let axis = location.axis.letter().to_string();
        let key = format!("{}_{unit}", location.name());
        self.text.set_number(&["rotary", &axis, &key], value * scale, decimals);
        if location.component == Component::Angular {
            self.text.say_tilt(&axis);
        }
    }

    /// Error functions of an axis as a table of the profile; `None` for functions that were not measured.
    pub(super) fn errors(
        &mut self,
        axis: Axis,
        key: &str,
        positions_mm: &[f64],
        functions: &[Option<Vec<f64>>; 6],
    ) {
        let negative = if key == "errors" { "" } else { "_negative" };
        let name = format!("{}{negative}.csv", axis.letter().to_ascii_lowercase());
        let file = self.table(&name, error_table(axis, positions_mm, functions).into_bytes());
        self.text.set_text(&["axis", &axis.letter().to_string(), key], &file);
    }

    /// How far the axes go whose travel nothing says, mm: as far as they were commanded. One that only stood there is
    /// known there alone.
    pub(super) fn travel(&mut self, spans_mm: [[f64; 2]; 3], work: &Work<'_>) {
        let mut stood = Vec::new();
        for (axis, [low, high]) in Axis::ALL.into_iter().zip(spans_mm) {
            let letter = axis.letter().to_string();
            let said = |text: &ProfileText, key: &str| text.says(&["axis", &letter, key]);
            let known = self.base.as_ref().map(|base| base.description.linear[axis.direction()].travel_mm);
            if known.is_some_and(|range| range.high - range.low < 1.5 * SHORTEST_MM) && high > low {
                self.text.remove(&["axis", &letter, "travel_mm"]);
            }
            if said(&self.text, "travel_mm") || said(&self.text, "errors") {
                continue;
            }
            let half = 0.5 * SHORTEST_MM;
            let range = if high > low { [low, high] } else { [low - half, high + half] };
            self.text.set_range(&["axis", &letter, "travel_mm"], range, 6);
            if high <= low {
                stood.push(letter);
            }
        }
        if !stood.is_empty() {
            work.warning(notice!(UNSAID;
                "how far {} can go is not known: the profile holds where it stood, and corrects nothing elsewhere",
                "ход {} неизвестен: профиль верен там, где она стояла, а в других местах ничего не исправляет",
                stood.join(" and ");
                "measure it with -m this profile, or write its travel_mm into the profile",
                "измерьте её с -m этого профиля или впишите в профиль её travel_mm"
            ));
        }
    }

    /// What is known of the measurement; warns of what is not.
    ///
    /// * `known_mm` – how far readings repeat, and how sure the model is
    fn calibrated(
        &mut self,
        target: &Target,
        work: &Work<'_>,
        temperature_c: Option<f64>,
        known_mm: [Option<f64>; 2],
    ) {
        let [repeatability_um, uncertainty_um] =
            known_mm.map(|mm| mm.map(|mm| (mm * 1e3 * 1e3).round() / 1e3));
        let calibrated = Calibrated {
            date: target.date.clone(),
            temperature_c: self.temperature_c(target.temperature.or(temperature_c)),
            instrument: target.instrument.clone(),
            repeatability_um,
            uncertainty_um,
        };
        let missing: Vec<&str> = [
            (calibrated.date.is_none(), "--date"),
            (calibrated.temperature_c.is_none(), "--temperature"),
            (calibrated.instrument.is_none(), "--instrument"),
        ]
        .into_iter()
        .filter_map(|(missing, option)| missing.then_some(option))
        .collect();
        if !missing.is_empty() && target.output.is_some() {
            work.warning(notice!(UNSAID;
                "the profile does not say when, how warm or with what the machine was measured",
                "профиль не говорит, когда, при какой температуре или каким прибором измерен станок";
                "add {}", "добавьте {}", missing.join(", ")
            ));
        }
        self.text.set_calibrated(&calibrated);
    }

    /// The temperature at which the written tables hold, °C: that of the measurement; the base's where its effects say
    /// what a change of temperature does, since their prediction was taken off, and where nobody said another.
    fn temperature_c(&self, measured: Option<f64>) -> Option<f64> {
        let base = self.base.as_ref();
        let before = base.and_then(|base| base.calibrated.as_ref()?.temperature_c);
        let terms = base.and_then(|base| base.effect_terms().ok()).unwrap_or_default();
        let thermal = terms.iter().any(|term| matches!(term.kind(), EffectKind::Thermal(_)));
        if thermal { before } else { measured.or(before) }
    }

    /// The finished profile, read back as every other command will read it.
    fn check(&self, text: &str) -> Result<(Profile, blake3::Hash), Failure> {
        let hasher = std::cell::RefCell::new(blake3::Hasher::new());
        hasher.borrow_mut().update(text.as_bytes());
        let read = |name: &str| {
            let own = name.strip_prefix(&self.folder).and_then(|rest| rest.strip_prefix('/')).unwrap_or(name);
            let found = self.tables.iter().find(|(table, _)| table == own);
            let (_, bytes) = found.ok_or(std::io::ErrorKind::NotFound)?;
            hasher.borrow_mut().update(bytes);
            Ok(bytes.clone())
        };
        let profile = machine_profile::load(text, &read).map_err(|errors| {
            let diagnostics = errors.into_iter().map(|error| error.diagnostic).collect();
            Failure::refused("the profile that would be written", text.as_bytes(), diagnostics)
        })?;
        Ok((profile, hasher.into_inner().finalize()))
    }

    /// Compares with an earlier profile where that is asked; makes the profile, unless it would not be a good one.
    ///
    /// * `known_mm` – how far readings repeat, and how sure the model is
    pub(super) fn write(
        mut self,
        target: &Target,
        work: &Work<'_>,
        temperature_c: Option<f64>,
        known_mm: [Option<f64>; 2],
    ) -> Result<(), Failure> {
        self.calibrated(target, work, temperature_c, known_mm);
        let text = self.text.to_string();
        let (profile, hash) = self.check(&text)?;
        if let Some(old) = &target.against {
            work.print(&super::against::report(old, &profile)?);
        }
        let Some(path) = target.output.clone() else { return Ok(()) };
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf).join(&self.folder);
        work.made.borrow_mut().profile = Some(NewProfile { path, text, folder, tables: self.tables, hash });
        Ok(())
    }
}

/// Reads `--chain`.
///
/// * `example` – one of the machines that are meant
pub(super) fn chain(text: &str, example: &str) -> Result<Chain, Failure> {
    Chain::parse(text).map_err(|error| {
        let error = error.text();
        Failure::usage(notice!(OPTION;
            "`--chain {text}`: {error}", "`--chain {text}`: {error:#}";
            "write the axes as in `--chain \"{example}\"`", "напишите оси так: `--chain \"{example}\"`"
        ))
    })
}

/// A profile as it stands in its file.
pub(super) fn profile_text(path: &Path) -> Result<String, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::unread(&lines::name(path), &error))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Functions one by one; `None` for those that are not given.
pub(super) fn columns(given: [bool; 6], rows: &[Six]) -> [Option<Vec<f64>>; 6] {
    std::array::from_fn(|f| given[f].then(|| rows.iter().map(|row| row[f]).collect()))
}

/// Error functions as CSV, µm with four decimals and µrad with four: finer than any instrument reads.
pub(super) fn error_table(axis: Axis, positions_mm: &[f64], functions: &[Option<Vec<f64>>; 6]) -> String {
    let mut out = String::from(if axis.is_linear() { "position_mm" } else { "position_deg" });
    for (k, function) in functions.iter().enumerate() {
        if function.is_some() {
            let unit = if k < 3 { "um" } else { "urad" };
            let _ = write!(out, ",E{}{axis}_{unit}", Axis::ALL[k]);
        }
    }
    out.push('\n');
    for (row, position) in positions_mm.iter().enumerate() {
        let _ = write!(out, "{}", short(*position, 6));
        for (k, function) in functions.iter().enumerate() {
            if let Some(values) = function {
                let _ = write!(out, ",{}", short(values[row] * if k < 3 { 1e3 } else { 1e6 }, 4));
            }
        }
        out.push('\n');
    }
    out
}
