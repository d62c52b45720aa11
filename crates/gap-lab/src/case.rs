//! One case: a machine, what it hides, how it was measured, and the files that come of it.

use crate::alias::Alias;
use crate::collinearity::View;
use crate::design::{Layout, Plan};
use crate::dice::Dice;
use crate::effect::Effect;
use crate::files::{self, Observation};
use crate::fresh::Fresh;
use crate::linear::{dot, rms};
use crate::machine::{Contribution, Machine};
use crate::matrix::{carry, shift, tilt, times};
use crate::noise::{NoiseKind, draw};
use crate::outside::Outside;
use crate::plans::{Runs, hold_out, lay_out};
use crate::row::{Row, Sight};
use crate::shape::{Bend, Withheld, form};
use crate::textbook::{variants, visible};
use crate::truth::{TrueEffect, Truth};

/// What a case is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// One effect of the library.
    Single,
    /// Two to four effects of the library.
    Multiple,
    /// Nothing but noise.
    Null,
    /// A cause that has no name.
    Outside,
    /// One effect on a design that cannot tell it from another.
    Aliased,
    /// One effect, and the diagnosis is run without it in its library.
    Removed,
    /// One effect seen by a ball bar.
    BallBar,
    /// One effect of which only the magnitude of the displacement is known.
    Magnitude,
    /// One effect of a rotary table.
    Rotary,
}

impl Kind {
    /// A word for ids and tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Multiple => "multiple",
            Self::Null => "null",
            Self::Outside => "outside",
            Self::Aliased => "aliased",
            Self::Removed => "removed",
            Self::BallBar => "ball-bar",
            Self::Magnitude => "magnitude",
            Self::Rotary => "rotary",
        }
    }
}

/// A case before it is made.
#[derive(Clone, Debug)]
pub struct CaseSpec {
    /// Place in the catalogue.
    pub index: u64,
    /// Seed of the benchmark.
    pub seed: u64,
    /// What the case is for.
    pub kind: Kind,
    /// Plans to try in turn until the effect is visible.
    pub plans: Vec<Plan>,
    /// Withheld effects of the library.
    pub effects: Vec<Effect>,
    /// Signal-to-noise ratio of each.
    pub snr: Vec<f64>,
    /// Noise.
    pub noise: NoiseKind,
    /// Columns of the reading.
    pub observation: Observation,
    pub(crate) outside: Option<Outside>,
    /// The profile knows no error at all; else two in five have tables.
    pub(crate) perfect: bool,
}

/// A case: its files and its truth.
#[derive(Clone, Debug)]
pub struct Case {
    /// Id, for example `single-0042`.
    pub id: String,
    /// What the case is for.
    pub kind: Kind,
    /// How it was measured in the end.
    pub plan: Plan,
    /// Noise.
    pub noise: NoiseKind,
    /// Effect that the diagnosis must be told to leave out of its library.
    pub without: Option<String>,
    /// Name and text of every file the diagnosis may see: `profile.toml`, `measurement.csv`,
    /// `holdout.csv`, and the tables that the profile refers to.
    pub files: Vec<(String, String)>,
    /// The truth as a file, for keeping.
    pub truth_json: String,
    /// The truth.
    pub truth: Truth,
    /// The hold-out and the truth about it.
    pub fresh: Fresh,
}

/// Everything of an attempt that the acceptance looks at.
struct Attempt {
    plan: Plan,
    machine: Machine,
    layout: Layout,
    withheld: Vec<Withheld>,
    effects: Vec<TrueEffect>,
    gap: Vec<f64>,
    sigma: f64,
}

/// No withheld effect displaces the tip by more, mm: what is larger is seen without instruments. (A knock between two
/// runs whose offsets are free needs 100 mm to show at all.)
const LARGEST_MM: f64 = 1.0;
/// What is wished of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wish {
    /// The question that its kind asks, and no two effects much alike.
    Clean,
    /// One that shows its effects.
    Any,
}

/// Attempts before the wish for a clean case is given up.
const STRICT_ATTEMPTS: u64 = 40;

impl CaseSpec {
    /// Name of the case: kind and place in the catalogue.
    #[must_use]
    pub fn id(&self) -> String {
        format!("{}-{:04}", self.kind.word(), self.index)
    }

    /// Makes the case. The same specification gives the same bytes.
    ///
    /// # Panics
    ///
    /// Where no plan of the specification shows the effect at all, after many attempts.
    #[must_use]
    pub fn build(&self) -> Case {
        for attempt in 0..4 * STRICT_ATTEMPTS {
            let mut dice = Dice::new(self.seed, self.index, attempt);
            if let Some(found) = self.attempt(attempt, &mut dice) {
                return self.write(&found, &mut dice);
            }
        }
        panic!("case {} of seed {}: no plan shows {:?}", self.index, self.seed, self.effects)
    }

    fn attempt(&self, attempt: u64, dice: &mut Dice) -> Option<Attempt> {
        let wish = if attempt < STRICT_ATTEMPTS { Wish::Clean } else { Wish::Any };
        let plan = match (attempt as usize) < self.plans.len() {
            true => self.plans[attempt as usize],
            false if self.kind == Kind::Single || self.kind == Kind::Multiple => Plan::Good,
            false => self.plans[attempt as usize % self.plans.len()],
        };
        let mut effects = self.effects.clone();
        if self.kind == Kind::Removed && attempt >= 6 {
            // Some names have no life of their own once they are out of the library: take another.
            effects = vec![dice.pick(&Effect::linear())];
        }
        let mut machine = Machine::random(dice);
        if dice_known(self, attempt) {
            machine = machine.with_known_errors(dice);
        }
        if let Plan::Aliased(..) = plan {
            machine.order = [0, 1, 2];
        }
        if plan == Plan::Turntable {
            let middle = [0, 1].map(|a| (0.5 * (machine.travel[a][0] + machine.travel[a][1])).round());
            machine.centre = Some(middle);
            machine.tables = [None, None, None];
        }
        let runs = match effects.iter().any(|e| e.needs_long_runs()) || dice.chance(0.3) {
            true => Runs::Long,
            false => Runs::OfOneLine,
        };
        let mut layout = lay_out(plan, &machine, runs, dice);
        if self.observation == Observation::Position {
            layout.columns.tool = false;
            layout.rows.iter_mut().for_each(|row| row.tool = [0.0; 3]);
        }
        let bend = if matches!(plan, Plan::Aliased(..)) { Bend::Plain } else { Bend::Natural };
        let mut withheld: Vec<Withheld> = effects
            .iter()
            .map(|e| Withheld {
                effect: Some(*e),
                amplitude: if e.one_signed() { 1.0 } else { dice.sign() },
                form: form(*e, &machine, layout.span, dice, bend),
            })
            .collect();
        if let Some(outside) = self.outside {
            withheld.push(Withheld { effect: None, amplitude: 1.0, form: outside.form(&machine, dice) });
        }
        let sigma = dice.scale(0.5, 2.0);
        self.scaled(
            Attempt { plan, machine, layout, withheld, effects: Vec::new(), gap: Vec::new(), sigma },
            wish,
        )
    }

    /// Gives every withheld effect its size and looks whether the case is what it should be.
    fn scaled(&self, mut a: Attempt, wish: Wish) -> Option<Attempt> {
        let view = View::new(&a.machine, &a.layout);
        let library = if a.withheld.is_empty() { Vec::new() } else { view.library() };
        let rows = a.layout.rows.len() as f64;
        let mut cleaned: Vec<Vec<f64>> = Vec::new();
        for (k, withheld) in a.withheld.iter_mut().enumerate() {
            let field = |r: &Row| {
                let mut c = Contribution::default();
                c.add(&(withheld.form)(r), withheld.amplitude);
                a.machine.displacement(r, &c)
            };
            let (raw, clean) = (view.raw(field), view.clean(field));
            let length = dot(&clean, &clean).sqrt();
            let met = withheld.effect.is_none_or(|e| visible(e, &a.layout));
            if !met || length < 0.1 * dot(&raw, &raw).sqrt() || length == 0.0 {
                return None;
            }
            let snr = self.snr[k];
            let gain = snr * a.sigma * 1e-3 * rows.sqrt() / length;
            let size_mm = |r: &Row| dot(&field(r), &field(r)).sqrt();
            if gain * a.layout.rows.iter().map(size_mm).fold(0.0, f64::max) > LARGEST_MM {
                return None;
            }
            let coefficient =
                withheld.effect.and_then(|e| coefficient(e, &a.machine, &a.layout, &view, &clean));
            let mut rivals: Vec<(String, f64)> = Vec::new();
            if withheld.effect.is_some() {
                let found = View::rivals(&library, &clean, withheld.effect);
                rivals.extend(found.into_iter().map(|(e, c)| (e.id(), c)));
            }
            let id = match (withheld.effect, self.outside) {
                (Some(effect), _) => effect.id(),
                (None, outside) => outside.map_or("outside", Outside::word).to_owned(),
            };
            if wish == Wish::Clean && !self.wanted(&library, &clean, withheld.effect, &rivals) {
                return None;
            }
            a.effects.push(TrueEffect {
                id,
                snr,
                coefficient: coefficient.map(|(unit, value)| (unit, value * gain)),
                rivals,
            });
            withheld.amplitude *= gain;
            cleaned.push(clean.into_iter().map(|v| v * gain).collect());
        }
        let close = |u: &[f64], v: &[f64]| dot(u, v).abs() > 0.7 * (dot(u, u) * dot(v, v)).sqrt();
        if wish == Wish::Clean && (0..cleaned.len()).any(|i| (0..i).any(|j| close(&cleaned[i], &cleaned[j])))
        {
            return None;
        }
        let size = a.layout.rows.iter().map(|r| r.seen([0.0; 3]).len()).sum();
        a.gap = (0..size).map(|i| cleaned.iter().map(|c| c[i]).sum()).collect();
        let mut order: Vec<usize> = (0..a.effects.len()).collect();
        order.sort_by(|i, j| a.effects[*j].snr.total_cmp(&a.effects[*i].snr));
        a.effects = order.into_iter().map(|i| a.effects[i].clone()).collect();
        Some(a)
    }

    /// Whether the effect on this design is the question that this kind of case asks.
    fn wanted(
        &self,
        library: &[(Effect, crate::linear::Basis, Vec<Vec<f64>>)],
        clean: &[f64],
        effect: Option<Effect>,
        rivals: &[(String, f64)],
    ) -> bool {
        match self.kind {
            Kind::Aliased => !rivals.is_empty(),
            Kind::Multiple => rivals.is_empty(),
            // Without its name (or having none) the gap must not be a mixture of three other names.
            Kind::Removed => rivals.is_empty() && View::beyond_three(library, clean, effect) > 0.25,
            Kind::Outside => View::beyond_three(library, clean, None) > 0.3,
            _ => true,
        }
    }

    fn write(&self, a: &Attempt, dice: &mut Dice) -> Case {
        let small = if self.observation == Observation::Magnitude { 0.05 } else { 1.0 };
        let moved = [0; 3].map(|_| small * dice.between(-0.03, 0.03));
        let turned = [0; 3].map(|_| small * dice.between(-4e-5, 4e-5));
        let set_up = times(&shift(moved), &tilt(turned));
        let offset = self.noise.run_offset(dice);
        let declared = self.noise.declared(dice).map(|k| k * a.sigma);
        let contribution = |r: &Row| {
            let mut c = Contribution::default();
            a.withheld.iter().for_each(|w| c.add(&(w.form)(r), w.amplitude));
            c
        };
        let read = |layout: &Layout, noise: &[[f64; 3]]| -> Vec<[f64; 3]> {
            let rows = layout.rows.iter().zip(noise);
            rows.map(|(row, noise)| {
                let seen = carry(&set_up, a.machine.position(row, &contribution(row)));
                [0, 1, 2].map(|i| seen[i] + a.sigma * 1e-3 * noise[i])
            })
            .collect()
        };
        let noise = draw(self.noise, offset, &a.layout, dice);
        let mut fresh = hold_out(a.plan, &a.machine, &a.layout, dice);
        if self.observation == Observation::Position {
            fresh.rows.iter_mut().for_each(|row| row.tool = [0.0; 3]);
        }
        // A wrong row in the hold-out would only measure itself.
        let fresh_kind = if self.noise == NoiseKind::Outliers { NoiseKind::Plain } else { self.noise };
        let fresh_noise = draw(fresh_kind, offset, &fresh, dice);
        let field: Vec<[f64; 3]> =
            fresh.rows.iter().map(|r| a.machine.displacement(r, &contribution(r)).map(|d| d * 1e3)).collect();
        let id = self.id();
        let tool = a.layout.rows.first().map_or([0.0; 3], |r| r.tool);
        let text = |layout: &Layout, noise: &[[f64; 3]], prefix: &str| {
            files::measurement(&a.machine, layout, &read(layout, noise), self.observation, declared, prefix)
        };
        let mut list = vec![
            ("profile.toml".to_owned(), files::profile(&a.machine, &id, tool)),
            ("measurement.csv".to_owned(), text(&a.layout, &noise, "r")),
            ("holdout.csv".to_owned(), text(&fresh, &fresh_noise, "h")),
        ];
        list.extend(files::tables(&a.machine));
        let noise_um = fresh_noise.iter().map(|n| n.map(|v| v * a.sigma)).collect();
        let fresh = Fresh { machine: a.machine.clone(), layout: fresh, field_um: field, noise_um };
        let truth = truth(a, &fresh, offset);
        let without = (self.kind == Kind::Removed).then(|| truth.effects[0].id.clone());
        Case {
            truth_json: files::truth(&id, self.kind.word(), a.plan.word(), self.noise.word(), &truth),
            id,
            kind: self.kind,
            plan: a.plan,
            noise: self.noise,
            without,
            files: list,
            truth,
            fresh,
        }
    }
}

/// Two cases in five have a profile with tables of its own. The stream's purpose is "tabl" in ASCII.
fn dice_known(spec: &CaseSpec, attempt: u64) -> bool {
    !spec.perfect && Dice::new(spec.seed, spec.index, attempt ^ 0x7461_626c).chance(0.4)
}

/// Coefficient of the single textbook column that fits the cleaned effect best, in the unit of the name.
fn coefficient(
    effect: Effect,
    machine: &Machine,
    layout: &Layout,
    view: &View<'_>,
    clean: &[f64],
) -> Option<(&'static str, f64)> {
    let (unit, per_mm) = match effect {
        Effect::Scale(_) => ("um_per_m", 1e6),
        Effect::Backlash(_) | Effect::LostMotion(..) | Effect::RotaryC(_) => ("um", 1e3),
        Effect::Squareness(..) => ("urad", 1e6),
        Effect::Load(_) => ("um_per_kg", 1e3),
        // mm of lag per mm/min is a time in minutes.
        Effect::ServoLag(_) => ("ms", 6e4),
        // The column of a unit lag on one axis and its opposite on the other: the difference is twice that.
        Effect::ServoMismatch(..) => ("ms", 1.2e5),
        // More columns than one, or another unit in every row.
        Effect::Thermal(_)
        | Effect::Warmup(_)
        | Effect::Positioning(_)
        | Effect::Straightness(..)
        | Effect::Pitch(_)
        | Effect::Angular(..)
        | Effect::Sag(_)
        | Effect::Step(_)
        | Effect::Local(_)
        | Effect::Eccentricity
        | Effect::ProbeLobing
        | Effect::InstrumentDrift => return None,
    };
    let all = variants(effect, machine, layout);
    let column = view.clean(|r| all[0][0](r));
    Some((unit, per_mm * dot(&column, clean) / dot(&column, &column)))
}

fn truth(a: &Attempt, fresh: &Fresh, offset: f64) -> Truth {
    let (mut components, mut per_row, mut at) = ([0.0; 3], Vec::new(), 0);
    for row in &a.layout.rows {
        let seen = row.seen([0.0; 3]).len();
        let values = &a.gap[at..at + seen];
        per_row.push(dot(values, values) * 1e6);
        if let Sight::Components(mask) = row.sight {
            for (i, value) in (0..3).filter(|i| mask[*i]).zip(values) {
                components[i] += value * value;
            }
        }
        at += seen;
    }
    let whole: f64 = components.iter().sum();
    if whole > 0.0 {
        components = components.map(|c| c / whole);
    }
    Truth {
        identifiable: !a.effects.is_empty() && a.effects.iter().all(|e| e.rivals.is_empty()),
        expected_sigma: rms(&a.gap) * 1e3 * (a.gap.len() as f64).sqrt() / a.sigma,
        effects: a.effects.clone(),
        sigma_um: a.sigma,
        run_sigma_um: offset * a.sigma,
        components,
        gap: a.layout.rows.iter().map(|r| r.command).zip(per_row).collect(),
        holdout_before_um: fresh.shrink(&vec![[0.0; 3]; fresh.len()]).before_um,
        holdout_noise_um: fresh.noise_rms_um(),
    }
}

/// The true effects of an alias, for the catalogue.
pub(crate) fn aliased_spec(alias: Alias, turn: usize) -> (Plan, Effect) {
    (Plan::Aliased(alias, turn), alias.truth(turn))
}
