//! What was done, for pipelines.

use std::collections::BTreeMap;

use diagnostic::{Text, both};
use serde::Serialize;

use rewrite::{ControlPart, Datum, Digest, Figures};

use crate::correct::Program;
use crate::datums;
use crate::settings::Settings;

/// The JSON of `--summary`.
#[derive(Debug, Serialize)]
pub struct Summary<'a> {
    schema: &'static str,
    version: &'static str,
    input: File<'a>,
    profile: Profile<'a>,
    output: Hash,
    changed: bool,
    engine: &'static str,
    dialect: &'a str,
    tolerance_um: f64,
    blocks_in: u64,
    blocks_out: u64,
    splits: u64,
    approach_moves: u64,
    largest_correction_um: f64,
    largest_correction_line: u64,
    deviation_before_um: f64,
    deviation_before_line: u64,
    deviation_after_um: f64,
    deviation_after_line: u64,
    control_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stops: Option<Stops>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_urad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_line: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    orientation: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_before_urad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_before_line: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    directions_held: Option<DirectionsHeld>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    datums: Vec<DatumUsed>,
    #[serde(skip_serializing_if = "Option::is_none")]
    settings: Option<SettingsFile<'a>>,
    warnings: Vec<Warning>,
}

/// What a settings file said that nobody typed.
#[derive(Debug, Clone, Serialize)]
pub struct SettingsFile<'a> {
    /// Its path.
    pub file: String,
    /// The options, by their long names, as they would be typed.
    pub options: BTreeMap<&'a str, &'a [String]>,
}

/// A touched zero from which deviations count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DatumUsed {
    /// `G54`
    pub work_offset: String,
    /// Its machine coordinate.
    pub at_mm: [f64; 3],
    /// The machine's error where it was touched: by that the part lies off in the measuring frame.
    pub error_um: [f64; 3],
    /// How the part lies turned there about X, Y, Z, where it was dialled parallel to an axis' way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turned_urad: Option<[f64; 3]>,
}

impl DatumUsed {
    /// Of those that a program used.
    #[must_use]
    pub fn all(datums: &[Datum]) -> Vec<Self> {
        let used = |datum: &Datum| Self {
            work_offset: datum.name.clone(),
            at_mm: datum.zero_mm,
            error_um: datum.error_mm.map(um),
            turned_urad: datum
                .placement
                .is_turned()
                .then(|| datum.placement.turn_rad().map(|rad| 1e6 * rad).into()),
        };
        datums.iter().map(used).collect()
    }
}

#[derive(Debug, Serialize)]
struct File<'a> {
    name: &'a str,
    bytes: u64,
    blake3: String,
}

#[derive(Debug, Serialize)]
struct Profile<'a> {
    name: &'a str,
    machine: &'a str,
    blake3: String,
}

/// Blocks at whose ends the control was made to stop.
#[derive(Debug, Serialize)]
struct Stops {
    blocks: u64,
    /// Where the profile says the acceleration.
    seconds_at_most: Option<f64>,
}

/// Motions whose directions were to be corrected and could not.
#[derive(Debug, Serialize)]
struct DirectionsHeld {
    motions: u64,
    largest_urad: f64,
    largest_line: u64,
    /// First and last of lines that follow each other.
    lines: Vec<[u64; 2]>,
}

#[derive(Debug, Serialize)]
struct Hash {
    bytes: u64,
    blake3: String,
}

#[derive(Debug, Serialize)]
struct Warning {
    code: String,
    message: String,
    note: String,
}

/// Micrometres with three decimals: nanometres are below everything that is promised.
#[must_use]
pub fn um(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e3
}

/// How far the control leaves the path at corners; `None`: not known.
#[must_use]
pub fn control_um(control: &ControlPart) -> Option<f64> {
    Some(um(control.off_mm().unwrap_or_default())).filter(|um| um.is_finite())
}

/// Plain values as JSON text, one trailing line end.
#[must_use]
pub fn json(values: &impl Serialize) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(values).expect("plain values always serialise");
    text.push(b'\n');
    text
}

/// Microradians with three decimals.
fn urad(rad: f64) -> f64 {
    (rad * 1e9).round() / 1e3
}

fn corrects_directions(settings: &Settings) -> bool {
    settings.options.orientation != correction::Orientation::Tip
}

/// How far the tool leans uncorrected.
fn before(figures: &Figures) -> Option<(f64, u64)> {
    Some(figures.tilt_before).filter(|(rad, _)| *rad > 0.0)
}

/// How far it leans in what was written.
fn tilt(figures: &Figures) -> Option<(f64, u64)> {
    Some(figures.tilt).filter(|(rad, _)| *rad > 0.0)
}

impl<'a> Summary<'a> {
    /// The same with what a settings file said.
    #[must_use]
    pub fn held(self, settings: Option<SettingsFile<'a>>) -> Self {
        Self { settings, ..self }
    }

    /// What is said of a program.
    #[must_use]
    pub fn new(settings: &'a Settings, program: &'a Program) -> Self {
        let Program { name, input, output, changed, figures, .. } = program;
        let hex = |digest: &Digest| digest.hash.map_or_else(String::new, |hash| hash.to_hex().to_string());
        Self {
            schema: "vpost.summary/1",
            version: env!("CARGO_PKG_VERSION"),
            input: File { name, bytes: input.bytes, blake3: hex(input) },
            profile: Profile {
                name: &settings.profile_name,
                machine: &settings.profile.name,
                blake3: settings.profile_hash.to_hex().to_string(),
            },
            output: Hash { bytes: output.bytes, blake3: hex(output) },
            changed: *changed,
            engine: settings.engine.id().name(),
            dialect: &settings.dialect.name,
            tolerance_um: um(settings.tolerance_mm()),
            blocks_in: figures.blocks_in,
            blocks_out: figures.blocks_out,
            splits: figures.splits,
            approach_moves: figures.approaches,
            largest_correction_um: um(figures.largest.0),
            largest_correction_line: figures.largest.1,
            deviation_before_um: um(figures.before.0),
            deviation_before_line: figures.before.1,
            deviation_after_um: um(figures.after.0),
            deviation_after_line: figures.after.1,
            control_um: control_um(&figures.control),
            stops: figures
                .control
                .stops()
                .map(|(blocks, seconds)| Stops { blocks, seconds_at_most: seconds }),
            tilt_urad: tilt(figures).map(|(rad, _)| urad(rad)),
            tilt_line: tilt(figures).map(|(_, line)| line),
            orientation: settings
                .profile
                .has_rotary()
                .contains(&true)
                .then(|| if corrects_directions(settings) { "full" } else { "xyz" }),
            tilt_before_urad: before(figures).map(|(rad, _)| urad(rad)),
            tilt_before_line: before(figures).map(|(_, line)| line),
            directions_held: (figures.held.motions > 0).then(|| DirectionsHeld {
                motions: figures.held.motions,
                largest_urad: urad(figures.held.largest.0),
                largest_line: figures.held.largest.1,
                lines: figures.held.lines.clone(),
            }),
            datums: DatumUsed::all(&figures.datums),
            settings: None,
            warnings: settings
                .warnings
                .iter()
                .flat_map(|report| &report.diagnostics)
                .chain(&figures.warnings)
                .map(|warning| Warning {
                    code: warning.code.to_string(),
                    message: warning.message.english().to_owned(),
                    note: warning.label.english().to_owned(),
                })
                .collect(),
        }
    }

    /// The JSON text, one trailing line end.
    #[must_use]
    pub fn json(&self) -> Vec<u8> {
        json(self)
    }

    /// The same in one line for people.
    #[must_use]
    pub fn line(figures: &Figures) -> Text {
        let (before_rad, before_line) = figures.tilt_before;
        let tilt = tilt(figures).map_or(Text::EMPTY, |(rad, line)| {
            // Where directions are corrected what is left is a bound, and another number.
            if rad == before_rad {
                both!(
                    "; tool leans by {:.1} urad (line {line})",
                    "; инструмент наклонён на {:.1} мкрад (строка {line})",
                    rad * 1e6
                )
            } else {
                both!(
                    "; tool leans by {:.1} urad before (line {before_line}), at most {:.1} urad after (line {line})",
                    "; инструмент наклонён на {:.1} мкрад до (строка {before_line}), не больше чем на {:.1} мкрад после (строка {line})",
                    before_rad * 1e6,
                    rad * 1e6
                )
            }
        });
        let mut rest = tilt;
        for sentence in datums::said(&figures.datums).into_iter().chain(figures.control.said()) {
            rest.push(&both!("; {sentence}", "; {sentence:#}"));
        }
        both!(
            "{} blocks in, {} out, {} split; largest correction {:.1} um (line {}); path off by at most {:.1} um before, {:.2} um after{rest}",
            "кадров было {}, стало {}, разделено {}; наибольшая поправка {:.1} мкм (строка {}); отклонение от траектории не больше {:.1} мкм до, {:.2} мкм после{rest:#}",
            figures.blocks_in,
            figures.blocks_out,
            figures.splits,
            figures.largest.0 * 1e3,
            figures.largest.1,
            figures.before.0 * 1e3,
            figures.after.0 * 1e3,
        )
    }
}
