//! The answer: what `vpost diagnose` reports.

use diagnostic::{Text, both};
use machine_model::effects::{EffectKind, EffectTerm};
use machine_model::{Vector, Volume};

use crate::equations::align::rms;

/// The verdicts of the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing above the noise.
    NoGap,
    /// The causes are known.
    Named,
    /// The cause is one of a set that these rows cannot tell apart.
    Ambiguous,
    /// Causes are known, and more than a tenth of the gap is still unexplained.
    Partial,
    /// There is a gap and no effect of the library explains it.
    Unknown,
    /// The noise is not what the file says, or the instrument itself moved.
    NoiseModelSuspect,
    /// Too little was measured to say anything.
    Underpowered,
}

impl Verdict {
    /// Its name in the contract.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoGap => "NO GAP",
            Self::Named => "NAMED",
            Self::Ambiguous => "AMBIGUOUS",
            Self::Partial => "PARTIAL",
            Self::Unknown => "UNKNOWN",
            Self::NoiseModelSuspect => "NOISE MODEL SUSPECT",
            Self::Underpowered => "UNDERPOWERED",
        }
    }

    /// The same for people.
    #[must_use]
    pub const fn words(self) -> Text {
        match self {
            Self::NoGap => Text::pair("NO GAP", "РАСХОЖДЕНИЯ НЕТ"),
            Self::Named => Text::pair("NAMED", "ПРИЧИНА НАЗВАНА"),
            Self::Ambiguous => Text::pair("AMBIGUOUS", "НЕОДНОЗНАЧНО"),
            Self::Partial => Text::pair("PARTIAL", "НАЗВАНА ЧАСТЬ"),
            Self::Unknown => Text::pair("UNKNOWN", "ПРИЧИНА НЕИЗВЕСТНА"),
            Self::NoiseModelSuspect => Text::pair("NOISE MODEL SUSPECT", "СОМНИТЕЛЬНЫЙ ШУМ"),
            Self::Underpowered => Text::pair("UNDERPOWERED", "МАЛО ДАННЫХ"),
        }
    }

    /// True where a part of the gap has no name, or unseen rows refute the causes.
    #[must_use]
    pub const fn leaves_open(self) -> bool {
        matches!(self, Self::Partial | Self::Unknown)
    }
}

/// Size of the gap after alignment, per row (length over the measured components), µm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gap {
    /// Rows used.
    pub rows: usize,
    /// Root mean square.
    pub rms_um: f64,
    /// 95th percentile.
    pub p95_um: f64,
    /// Largest.
    pub max_um: f64,
    /// Standard deviation of the noise of one reading.
    pub noise_um: f64,
}

impl Gap {
    /// Of what was seen of each row, µm.
    #[must_use]
    pub fn new(mut lengths_um: Vec<f64>, noise_um: f64) -> Self {
        let rms_um = rms(&lengths_um);
        lengths_um.sort_by(f64::total_cmp);
        let at = |q: f64| ((lengths_um.len() as f64 - 1.0) * q).round() as usize;
        let quantile = |q: f64| lengths_um.get(at(q)).copied().unwrap_or(0.0);
        Self { rows: lengths_um.len(), rms_um, p95_um: quantile(0.95), max_um: quantile(1.0), noise_um }
    }
}

/// A place where the gap is larger than elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What the rows are sorted by: `component`, `X`, `direction`, `voxel`, `run`, `time`, …
    pub by: String,
    /// Which part of it.
    pub cell: String,
    /// Share of the gap's square that lies there.
    pub share: f64,
    /// How likely a gap spread evenly would show this much here, corrected for the number of cells.
    pub p: f64,
}

impl Cell {
    /// What the rows are sorted by, for people.
    #[must_use]
    pub fn family(&self) -> Text {
        let russian = match self.by.as_str() {
            "component" => "составляющая",
            "direction" => "направление",
            "voxel" => "часть объёма",
            "run" => "серия",
            "feed" => "подача",
            "load" => "нагрузка",
            "tool" => "инструмент",
            "time" => "время",
            axis => axis,
        };
        Text::new(self.by.clone(), russian.to_owned())
    }

    /// Which part of it, for people.
    #[must_use]
    pub fn part(&self) -> Text {
        let russian = match (self.by.as_str(), self.cell.as_str()) {
            ("component", "along the bar") => "вдоль измерителя".to_owned(),
            ("direction", "unknown") => "неизвестно".to_owned(),
            ("feed", cell) => cell.replace("mm/min", "мм/мин"),
            ("load", cell) => cell.replace("kg", "кг"),
            ("tool", cell) => cell.replace("mm", "мм").replace(',', "; "),
            ("time", cell) => cell.replace(" s", " с"),
            (_, cell) => cell.to_owned(),
        };
        // Two points between numbers with a comma.
        Text::new(self.cell.clone(), russian.replace("..", "…"))
    }

    /// Both.
    #[must_use]
    pub fn words(&self) -> Text {
        let (family, part) = (self.family(), self.part());
        both!("{family} {part}", "{family:#} {part:#}")
    }
}

/// A number of a cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name with unit.
    pub name: String,
    /// Best value.
    pub value: f64,
    /// Half width of the 95 % interval; `None` for numbers that shape the effect (pitch, time constant).
    pub u95: Option<f64>,
}

/// Predicted shrinkage of the gap's RMS: 0 nothing, 1 all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrinkage {
    /// Low end of the interval.
    pub low: f64,
    /// Best value.
    pub mid: f64,
    /// High end.
    pub high: f64,
}

/// An effect that could stand in for a cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Lookalike {
    /// Its id.
    pub effect: String,
    /// Correlation, on this design, of what the cause does with the nearest the other effect can do.
    pub correlation: f64,
    /// How far its extended BIC lies behind the cause's.
    pub behind: f64,
}

/// One cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// The effect with its numbers, ready for a profile; `None` where profiles hold it by other keys, as of a lathe.
    pub term: Option<EffectTerm>,
    /// Its id.
    pub effect: String,
    /// What it is, in words, with its size.
    pub words: Text,
    /// Its numbers.
    pub parameters: Vec<Parameter>,
    /// Share of the reducible gap that nothing else explains.
    pub share_unique: f64,
    /// Share of the reducible gap that it explains alone.
    pub share_alone: f64,
    /// F test, corrected for the number of forms asked about.
    pub p: f64,
    /// Effects these rows cannot tell from it.
    pub cannot_be_told_from: Vec<String>,
    /// The nearest other effects, told apart or not.
    pub nearest: Vec<Lookalike>,
    /// RMS of the gap before this cause is in the model (and after those listed before it), µm.
    pub rms_before_um: f64,
    /// RMS after it, µm.
    pub rms_after_um: f64,
    /// Predicted shrinkage by this cause and those before it, on the hold-out commands or on the rows; where it is.
    pub shrink_predicted: Option<Shrinkage>,
    /// What to do.
    pub remedy: Text,
}

impl Cause {
    /// Of what a profile may hold as an effect.
    #[must_use]
    pub fn kind(&self) -> Option<EffectKind> {
        self.term.as_ref().map(EffectTerm::kind)
    }

    /// True where it is a fault of the measuring instrument.
    pub(crate) fn is_instrument(&self) -> bool {
        self.kind().is_some_and(|kind| kind.is_instrument())
    }

    /// A play below zero: directions of approach or signs that are the wrong way round, or an over-compensated reversal.
    pub(crate) fn is_turned_play(&self) -> bool {
        matches!(self.kind(), Some(EffectKind::Backlash(_)))
            && self.parameters.first().is_some_and(|half_width| half_width.value < 0.0)
    }

    /// True where a fault of the instrument could have shown as well; one that is such a fault stands by its own name.
    fn may_be_the_instrument(&self) -> bool {
        let mut rivals = self.cannot_be_told_from.iter().filter_map(|id| id.parse::<EffectKind>().ok());
        !self.is_instrument() && rivals.any(|kind| kind.is_instrument())
    }
}

/// Measuring frame against machine frame: reported, never blamed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setup {
    /// Shift, µm.
    pub shift_um: [f64; 3],
    /// Rotation, µrad.
    pub rotation_urad: [f64; 3],
    /// Offsets of the runs, µm.
    pub run_offsets_um: Vec<(String, [f64; 3])>,
    /// Angles of the runs, where they are turned against each other, µrad.
    pub run_rotations_urad: Vec<(String, [f64; 3])>,
    /// Zeros of the instruments behind the first one against it, with the half width of the 95 % interval, µm.
    pub instruments_um: Vec<(usize, [(f64, f64); 3])>,
}

/// What the causes leave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Leftover {
    /// RMS per row, µm.
    pub rms_um: f64,
    /// Share of the reducible gap that is left.
    pub phi: f64,
    /// How likely noise alone would leave this much.
    pub lack_of_fit_p: f64,
    /// Where it is largest.
    pub correlates_with: Vec<Text>,
    /// The effect that would absorb most of it, and why it is not named.
    pub absorber: Option<Text>,
}

/// What one equation of a row shows before and after the causes are in the model, alignment taken out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Index of the row.
    pub row: usize,
    /// 0, 1, 2 for a component, 3 for any other direction.
    pub class: usize,
    /// Unit vector along which it is seen.
    pub along: Vector,
    /// Without the causes, µm.
    pub before_um: f64,
    /// With them, µm.
    pub after_um: f64,
}

/// RMS of the unseen points as the model grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// What was added: part of the measuring frame, or a cause.
    pub added: Text,
    /// RMS with it and all before it, µm.
    pub rms_um: f64,
}

/// A run that no fit has seen, without the causes and with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WorseRun {
    /// Index of the run in the file that was read.
    pub run: usize,
    /// RMS without the causes, µm.
    pub before_um: f64,
    /// RMS with them, µm.
    pub after_um: f64,
}

/// Points the fit has not seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Holdout {
    /// Rows.
    pub rows: usize,
    /// RMS without the causes, µm.
    pub rms_before_um: f64,
    /// RMS with them, µm.
    pub rms_after_um: f64,
    /// 1 - after / before.
    pub shrink: f64,
    /// The way from the one to the other.
    pub steps: Vec<Step>,
    /// Point by point.
    pub residuals: Vec<Residual>,
    /// The run that the causes make worse by most, where one is made worse by more than chance.
    pub(crate) worse: Option<WorseRun>,
}

impl Holdout {
    /// Of so many rows, with nothing said of single ones.
    #[must_use]
    pub fn new(rows: usize, rms_before_um: f64, rms_after_um: f64) -> Self {
        let shrink = if rms_before_um > 0.0 { 1.0 - rms_after_um / rms_before_um } else { 0.0 };
        let (steps, residuals) = (Vec::new(), Vec::new());
        Self { rows, rms_before_um, rms_after_um, shrink, steps, residuals, worse: None }
    }
}

/// What would settle it.
#[derive(Clone, Debug, PartialEq)]
pub struct NextMeasurement {
    /// In words.
    pub text: Text,
    /// What it separates: a pair, mostly.
    pub separates: Vec<Text>,
    /// How far apart they would lie, standard deviations; 0 where nothing is to be separated yet.
    pub expected_sigma: f64,
    /// Its rows, readings to be filled in: each run goes along its line and back.
    pub rows: Vec<crate::equations::observation::Row>,
}

impl NextMeasurement {
    /// Id of a row's run: `next`, `next 2` …
    #[must_use]
    pub fn run(&self, row: &crate::equations::observation::Row) -> String {
        match self.rows.first().map_or(0, |first| row.run - first.run) {
            0 => "next".to_owned(),
            more => format!("next {}", more + 1),
        }
    }
}

/// Smallest amplitude that would have been named.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectable {
    /// The effect.
    pub effect: String,
    /// Name of its first coefficient.
    pub parameter: String,
    /// Smallest value seen with certainty; `None` where the design does not show the effect at all.
    pub smallest: Option<f64>,
}

/// The whole answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// In one word.
    pub verdict: Verdict,
    /// In one sentence.
    pub sentence: Text,
    /// Size.
    pub gap: Gap,
    /// Place.
    pub places: Vec<Cell>,
    /// Causes, largest share first.
    pub causes: Vec<Cause>,
    /// Why no correction may be made of the causes, in words; `None` where one may.
    pub withheld: Option<Text>,
    /// The part of the volume to which a correction is limited.
    pub within: Option<Volume>,
    /// Set-up, where there is a measuring frame.
    pub setup: Option<Setup>,
    /// Rest.
    pub leftover: Leftover,
    /// Unseen points.
    pub holdout: Option<Holdout>,
    /// What to measure.
    pub next_measurement: Option<NextMeasurement>,
    /// Lines of the file that were left out.
    pub outlier_lines: Vec<u64>,
    /// What could have been seen.
    pub detectable: Vec<Detectable>,
    /// What the gap depends on where no effect explains it, the best first: a description, no cause.
    pub formulas: Vec<crate::search::formula::Formula>,
    /// What the reader should know about how this was found.
    pub notes: Vec<Text>,
    /// Equation by equation, outliers left out.
    pub residuals: Vec<Residual>,
}

impl Diagnosis {
    /// A verdict that needs no causes.
    #[must_use]
    pub fn new(verdict: Verdict, sentence: Text, gap: Gap) -> Self {
        Self {
            verdict,
            sentence,
            gap,
            places: Vec::new(),
            causes: Vec::new(),
            withheld: None,
            within: None,
            setup: None,
            leftover: Leftover::default(),
            holdout: None,
            next_measurement: None,
            outlier_lines: Vec::new(),
            detectable: Vec::new(),
            formulas: Vec::new(),
            notes: Vec::new(),
            residuals: Vec::new(),
        }
    }

    /// The causes that a profile may take: no unseen row speaks against them, they do no harm under any explanation that the
    /// rows do not refute, and what a fault of the instrument could have shown as well is none of them.
    pub fn corrections(&self) -> impl Iterator<Item = &Cause> {
        let doubted = self.withheld.is_some();
        // A drift in the order of the rows has no number that a profile could hold.
        let holds = |cause: &Cause| cause.term.iter().any(|term| term.coefficients().next().is_some());
        let written = move |cause: &&Cause| !doubted && !cause.may_be_the_instrument() && holds(cause);
        self.causes.iter().filter(written)
    }

    /// True where there are any.
    #[must_use]
    pub fn corrects(&self) -> bool {
        self.corrections().next().is_some()
    }
}
