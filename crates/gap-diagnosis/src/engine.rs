//! From measurements to an explained gap: search, outliers, proposals, tests.

use machine_model::effects::{EffectKind, Shape};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::assembly::positions;
use crate::bounds::Bounds;
use crate::columns::{Kept, Places};
use crate::doubt::{self, Setting, could_be_turned};
use crate::fit::Solution;
use crate::gram::{Gram, Source};
use crate::library::{JOINT_PLACES, Library, Variant, narrowest_mm};
use crate::noise::{estimate, outliers, quantum_um};
use crate::observation::{Measurements, Scalar};
use crate::pool::Pool;
use crate::propose::{self, Pitches};
use crate::refine::Stage;
use crate::rivals::WITHIN;
use crate::search::{MOST_TRIED, Move, next_move, without};
use crate::space::{Fit, Part, Space};
use crate::term::Term;
use crate::trial::UNPROVEN;

/// Level of the F test, over all questions asked: shared evenly among the effects, and within an effect among
/// its forms. Blunders that pass for damage come on top: 3 % leave room below one false alarm in twenty.
pub(crate) const LEVEL: f64 = 3e-2;
/// Least share of the reducible square that a cause must explain.
pub(crate) const LEAST_SHARE: f64 = 0.02;
/// Most causes named.
const MOST_CAUSES: usize = 8;
/// A correlation that grows by less is the same.
const MORE: f64 = 0.05;
/// Passes of dropping outliers and searching again.
const PASSES: usize = 3;

/// What the search arrived at.
#[derive(Clone, Debug)]
pub(crate) struct Explained {
    /// Equations that were used.
    pub scalars: Vec<Scalar>,
    /// Library with all proposed shapes.
    pub library: Library,
    /// Products of all its columns, raw and whitened.
    pub space: Space,
    /// The model.
    pub parts: Vec<Part>,
    /// Its judgement.
    pub fit: Fit,
    /// It, solved.
    pub solution: Solution,
    /// Rows left out as outliers, ascending.
    pub outliers: Vec<usize>,
    /// Effects of other explanations that are as good (readings that are lengths only).
    pub equally_good: Vec<EffectKind>,
    /// Residuals of the rows left out, µm.
    pub dropped_residuals_um: Vec<f64>,
    /// The effect that would come next and why it did not.
    pub refused: Option<Refused>,
    /// Correlation of a reading with the next one of its run.
    pub phi: f64,
    /// The same as tests and intervals count with, for runs of any length.
    pub caution: f64,
    /// The set-up holds an angle of every run.
    pub turned: bool,
}

impl Explained {
    /// BIC of the whole model, its set-up counted, so that models with different set-ups compare.
    fn evidence(&self) -> f64 {
        self.space.evidence(&self.fit)
    }
}

/// An effect that scored and failed a test.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Refused {
    /// Which.
    pub kind: EffectKind,
    /// Share of the square left that it explains.
    pub share: f64,
    /// Corrected p value.
    pub p: f64,
    /// Which test it failed.
    pub reason: &'static str,
}

/// Runs the search once, outliers and all.
#[must_use]
pub(crate) fn explain_roughly(data: &Measurements, scalars: &[Scalar], without: &[EffectKind]) -> Explained {
    let places = Places::new(&data.rows);
    let source = Source { places: Some(&places), ..source(data, scalars) };
    pass(data, &mut Pool::new(&source), &[], without, Setting::default(), None, Task::Search)
}

/// Runs the search, and again where what it took for granted of noise and set-up does not hold on what it left.
#[must_use]
pub(crate) fn explain(data: &Measurements, scalars: &[Scalar], without: &[EffectKind]) -> Explained {
    let places = Places::new(&data.rows);
    let shifted = weighed_and_settled(data, scalars, without, &places, false);
    if !could_be_turned(data) {
        return shifted;
    }
    let noise = estimate(&data.rows, &shifted.scalars, &shifted.solution.residuals_um, shifted.phi);
    let left = |model: &Explained| {
        let noise = noise.map_or(0.0, |n| n.variance) * model.space.degrees;
        (model.solution.residual_square - noise).max(0.0)
    };
    if left(&shifted) <= 0.0 && shifted.parts.is_empty() {
        return shifted;
    }
    let turned = weighed_and_settled(data, scalars, without, &places, true);
    // Angles of runs explain more than they cost, and most of what no cause explains.
    let better = turned.evidence() < shifted.evidence() - WITHIN && left(&turned) <= 0.5 * left(&shifted);
    if better { turned } else { shifted }
}

/// The search with weights by component where these scatter differently.
fn weighed_and_settled(
    data: &Measurements,
    scalars: &[Scalar],
    without: &[EffectKind],
    places: &Places,
    turned: bool,
) -> Explained {
    let source = Source { places: Some(places), ..source(data, scalars) };
    let first = settled(data, &source, without, turned, None);
    match doubt::weighed(data, &first, scalars) {
        Some(scalars) => settled(data, &Source { scalars: &scalars, ..source }, without, turned, Some(first)),
        None => first,
    }
}

/// Runs the search, drops lone outliers, and searches again until they stay the same; then once more where the readings
/// of a run turn out to hang together.
fn settled(
    data: &Measurements,
    source: &Source<'_>,
    without: &[EffectKind],
    turned: bool,
    start: Option<Explained>,
) -> Explained {
    let scalars = source.scalars;
    let mut pool = Pool::new(source);
    let mut dropped: Vec<usize> = Vec::new();
    let mut setting = Setting { phi: 0.0, caution: 0.0, turned };
    let mut result = pass(data, &mut pool, &dropped, without, setting, start, Task::Search);
    let lone = |solution: &Solution| {
        let residuals = conditional_residuals(solution, source);
        outliers(&data.rows, scalars, &residuals)
    };
    for nth in 0..PASSES {
        let local = result.parts.iter().any(|p| is_local(result.library.candidates[p.candidate].kind));
        let found =
            if nth == 0 && local { lone(&without_damage(&result, source)) } else { lone(&result.solution) };
        if found == dropped || found.len() * 5 > data.rows.len() {
            break;
        }
        dropped = found;
        result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Search);
    }
    setting.phi = doubt::phi(&data.rows, &result.scalars, &result.solution.residuals_um);
    let hanging = |model: &Explained| {
        doubt::caution(&data.rows, &model.scalars, &model.solution.residuals_um).max(setting.phi)
    };
    // Names that noise made take its smoothness with them: as they go, what is left hangs together more.
    for _ in 0..PASSES {
        let now = hanging(&result);
        if now < setting.caution + MORE || result.parts.is_empty() {
            break;
        }
        setting.caution = now;
        result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Search);
    }
    setting.caution = setting.caution.max(hanging(&result));
    result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Imitate);
    result.outliers.clone_from(&dropped);
    if !dropped.is_empty() {
        let all = conditional_residuals(&result.solution, source);
        let left_out = scalars.iter().zip(all).filter(|(s, _)| dropped.binary_search(&s.row).is_ok());
        result.dropped_residuals_um = left_out.map(|(_, r)| r).collect();
    }
    result
}

const fn is_local(kind: EffectKind) -> bool {
    matches!(kind, EffectKind::Local(_))
}

/// Where the products come from.
#[must_use]
pub(crate) fn source<'a>(data: &'a Measurements, scalars: &'a [Scalar]) -> Source<'a> {
    Source { rows: &data.rows, scalars, runs: data.runs.len(), geometry: &data.geometry, places: None }
}

/// The model without damage at a place.
fn without_damage(model: &Explained, source: &Source<'_>) -> Solution {
    let mut parts = model.parts.clone();
    parts.retain(|p| !is_local(model.library.candidates[p.candidate].kind));
    let sub = model.space.gram.select(&model_columns(&model.library, &parts));
    sub.solve(model.solution.rho, source)
}

fn conditional_residuals(solution: &Solution, source: &Source<'_>) -> Vec<f64> {
    crate::fit::residuals(&solution.terms, &solution.coefficients, source)
        .iter()
        .zip(source.scalars)
        .map(|(r, s)| r - s.along.dot(&solution.run_offsets_um[source.rows[s.row].run]))
        .collect()
}

/// Set-up columns and those of some parts, as positions in the library.
#[must_use]
pub(crate) fn model_columns(library: &Library, parts: &[Part]) -> Vec<usize> {
    let own = parts.iter().flat_map(|p| &library.candidates[p.candidate].variants[p.variant].columns);
    (0..library.nuisances).chain(own.copied()).collect()
}

/// What a pass over the equations does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Task {
    /// Looks for causes.
    Search,
    /// Looks for shapes of other effects that imitate the causes found.
    Imitate,
}

/// One pass without the rows in `dropped`, beginning with the model of `start`.
fn pass(
    data: &Measurements,
    pool: &mut Pool<'_>,
    dropped: &[usize],
    without: &[EffectKind],
    setting: Setting,
    start: Option<Explained>,
    task: Task,
) -> Explained {
    let all = *pool.source();
    let (lost, scalars): (Vec<Scalar>, Vec<Scalar>) =
        all.scalars.iter().partition(|s| dropped.binary_search(&s.row).is_ok());
    let source = Source { scalars: &scalars, ..all };
    // Too few to look anything up.
    let lost = Source { scalars: &lost, places: None, ..all };
    let mut state = State::new(data, &source, pool, lost, without, setting, start);
    match task {
        Task::Search => state.search(),
        Task::Imitate => state.imitate(),
    }
    let State { library, space, parts, fit, refused, .. } = state;
    let sub = space.gram.select(&model_columns(&library, &parts));
    let rho = sub.best_rho(space.rho(fit.level));
    let rho = if space.rho(fit.level) == 0.0 && rho < 1e-3 { 0.0 } else { rho };
    let solution = sub.solve(rho, &source);
    Explained {
        library,
        space,
        parts,
        fit,
        solution,
        outliers: Vec::new(),
        dropped_residuals_um: Vec::new(),
        equally_good: Vec::new(),
        refused,
        phi: setting.phi,
        caution: setting.caution.max(setting.phi),
        turned: setting.turned,
        scalars,
    }
}

/// A search under way.
pub(crate) struct State<'a, 'b> {
    pub(crate) data: &'a Measurements,
    pub(crate) source: &'a Source<'a>,
    without: &'a [EffectKind],
    pub(crate) library: Library,
    pool: &'a mut Pool<'b>,
    /// The equations left out, and their products.
    lost: (Source<'a>, Gram),
    /// Where the columns of the library are in the pool.
    positions: Vec<usize>,
    pitches: [Pitches; 3],
    pub(crate) space: Space,
    pub(crate) parts: Vec<Part>,
    pub(crate) fit: Fit,
    pub(crate) refused: Option<Refused>,
    pub(crate) bounds: Bounds,
    /// Correlation of neighbouring readings of a run.
    pub(crate) phi: f64,
    /// Least variance of a reading, µm²: that of the display's step.
    pub(crate) floor: f64,
}

impl<'a, 'b> State<'a, 'b> {
    /// Begins with the model of `start`, or with nothing.
    fn new(
        data: &'a Measurements,
        source: &'a Source<'a>,
        pool: &'a mut Pool<'b>,
        lost: Source<'a>,
        without: &'a [EffectKind],
        setting: Setting,
        start: Option<Explained>,
    ) -> Self {
        let (library, parts, refused) = start.map_or_else(
            || (Library::new(data, without, setting.turned), Vec::new(), None),
            |s| (s.library, s.parts, s.refused),
        );
        let gone = Gram::new(library.terms.clone(), &lost);
        let positions = pool.positions(&library.terms);
        let space = Space::new(pool.select(&positions).without(&gone), library.nuisances);
        let fit = space.fit(&library, &parts);
        let pitches = [0, 1, 2].map(|axis| Pitches::new(source, axis));
        let lost = (lost, gone);
        let (bounds, phi) = (Bounds::new(data, source.scalars), setting.caution.max(setting.phi));
        let floor = (quantum_um(source.scalars).powi(2) / 12.0).max(1e-12);
        Self {
            data,
            source,
            without,
            library,
            pool,
            lost,
            positions,
            pitches,
            space,
            parts,
            fit,
            refused,
            bounds,
            phi,
            floor,
        }
    }

    fn search(&mut self) {
        self.refused = None;
        // What an earlier search named must pass the tests on these rows, too: beside all others where readings hang together,
        // for what one cause leaves of the others does so as well.
        if self.phi > 0.0 {
            self.weed();
        }
        let earlier = if self.phi > 0.0 { Vec::new() } else { std::mem::take(&mut self.parts) };
        for part in earlier {
            let mut with = self.parts.clone();
            with.push(part);
            let fit = self.space.fit(&self.library, &with);
            if self.objection(&self.parts, part, &fit).is_none() {
                self.parts = with;
            }
        }
        self.fit = self.space.fit(&self.library, &self.parts);
        self.propose();
        for _ in 0..60 {
            let may = |rest: &[Part], part: Part, fit: &Fit| self.objection(rest, part, fit).is_none();
            match next_move(&self.space, &self.library, &self.parts, self.fit.score, may) {
                Move::Change(parts, fit) => {
                    self.parts = parts;
                    self.fit = fit;
                }
                Move::Add(proposed) => {
                    if self.parts.len() >= MOST_CAUSES {
                        break;
                    }
                    match self.admitted(proposed) {
                        Ok((part, fit)) => {
                            self.parts.push(part);
                            self.fit = fit;
                            self.propose();
                        }
                        Err(refused) => {
                            self.refused = refused;
                            break;
                        }
                    }
                }
                Move::Stop => break,
            }
        }
        self.prune();
        self.restrain();
    }

    /// Takes out causes that fail their tests beside all others, the weakest first.
    fn weed(&mut self) {
        loop {
            let full = self.space.fit(&self.library, &self.parts);
            let failed = (0..self.parts.len()).filter_map(|place| {
                let rest = without(&self.parts, place);
                let refused = self.objection(&rest, self.parts[place], &full)?;
                Some((refused.p, rest, refused))
            });
            let Some((_, rest, refused)) = failed.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            (self.parts, self.refused) = (rest, Some(refused));
        }
    }

    /// The first of some effects that passes its tests, or why the best did not.
    ///
    /// What few runs cannot prove (a knock between two of them explains their offsets) does not keep the next ones from
    /// their tests. What does not hold on other lines ends the search: the structure is there, and has no name.
    fn admitted(&self, proposed: Vec<(Part, Fit)>) -> Result<(Part, Fit), Option<Refused>> {
        let mut first = None;
        for (part, fit) in proposed.into_iter().take(MOST_TRIED) {
            let Some(refused) = self.objection(&self.parts, part, &fit) else { return Ok((part, fit)) };
            let unproven = refused.reason == UNPROVEN;
            first.get_or_insert(refused);
            if !unproven {
                break;
            }
        }
        Err(first)
    }

    /// Forms of other effects whose free numbers imitate the causes: a knock at the time the load came on is a
    /// rival of the load, whatever times a grid happens to hold.
    fn imitate(&mut self) {
        let sub = self.space.gram.select(&model_columns(&self.library, &self.parts));
        let solution = sub.solve(self.space.rho(self.fit.level), self.source);
        for (place, part) in self.parts.clone().into_iter().enumerate() {
            let own = self.library.candidates[part.candidate].kind;
            let columns = positions(&self.library, &self.parts, place);
            let values: Vec<f64> = solution.coefficients[columns.clone()].iter().map(|v| -v).collect();
            let terms = &solution.terms[columns];
            // The gap is what `residuals` starts from.
            let displaced: Vec<f64> = crate::fit::residuals(terms, &values, self.source)
                .iter()
                .zip(self.source.scalars)
                .map(|(r, s)| r - s.gap_um)
                .collect();
            for axis in 0..3 {
                let allowed = |kind: EffectKind| kind != own && !self.without.contains(&kind);
                let kind = EffectKind::Step(axis);
                if let Some((time_s, _)) =
                    propose::knock(self.source, &displaced, axis).filter(|_| allowed(kind))
                {
                    let columns = self.library.add_columns(kind, Shape { time_s, ..Shape::default() }, &[0]);
                    let form = Variant { columns, enriched: false, only_rival: true };
                    self.library.add_variants(kind, vec![form], 0);
                }
                let kind = EffectKind::Local(axis);
                let narrowest = narrowest_mm(self.data, axis);
                if let Some((centre, width, _)) =
                    propose::damage(self.source, &displaced, axis, narrowest).filter(|_| allowed(kind))
                {
                    let mut forms = self.library.place(kind, centre, width);
                    forms.iter_mut().for_each(|form| form.only_rival = true);
                    self.library.add_variants(kind, forms, 0);
                }
            }
        }
        self.grow();
    }

    /// New columns with their products, then everything whitened again.
    fn grow(&mut self) {
        let known = self.space.gram.terms.len();
        let new: Vec<Term> = self.library.terms[known..].to_vec();
        if !new.is_empty() {
            self.positions.extend(self.pool.positions(&new));
            let (source, gone) = &mut self.lost;
            gone.extend(new, source, &mut Kept::default());
            self.space.grow(self.pool.select(&self.positions).without(gone));
            self.fit = self.space.fit(&self.library, &self.parts);
        }
    }

    /// Shapes worth asking about, given what is explained already.
    fn propose(&mut self) {
        let rho = self.space.rho(self.fit.level);
        let sub = self.space.gram.select(&model_columns(&self.library, &self.parts));
        let solution = sub.solve(rho, self.source);
        for axis in 0..3 {
            let kind = EffectKind::Pitch(axis);
            if self.without.contains(&kind) || self.uses(kind) {
                continue;
            }
            let (found, asked) = self.pitches[axis].best(self.source, &solution.residuals_um, axis);
            for pitch in found {
                let variants = propose::pitch_variants(&mut self.library, self.data, axis, pitch);
                self.library.add_variants(kind, variants, asked);
            }
        }
        // Residuals with the runs' offsets put back: a knock between two runs hides in them.
        let marginal = crate::fit::residuals(&sub.terms, &solution.coefficients, self.source);
        for axis in 0..3 {
            let kind = EffectKind::Step(axis);
            if self.without.contains(&kind) || self.uses(kind) {
                continue;
            }
            for residuals in [&solution.residuals_um, &marginal] {
                if let Some((time_s, asked)) = propose::knock(self.source, residuals, axis) {
                    let shape = Shape { time_s, ..Shape::default() };
                    let columns = self.library.add_columns(kind, shape, &[0]);
                    // The grid of the library asked already; a finer one asks at most that often again.
                    self.library.add_variants(
                        kind,
                        vec![Variant { columns, enriched: false, only_rival: false }],
                        asked.min(48),
                    );
                }
            }
        }
        for axis in 0..3 {
            let kind = EffectKind::Local(axis);
            if self.without.contains(&kind) || self.uses(kind) {
                continue;
            }
            if let Some((centre, width, asked)) =
                propose::damage(self.source, &solution.residuals_um, axis, narrowest_mm(self.data, axis))
            {
                let variants = self.library.place(kind, centre, width);
                self.library.add_variants(kind, variants, asked);
            }
        }
        for axis in 0..3 {
            let kind = EffectKind::Joint(axis);
            let few = self.bounds.places[axis] < JOINT_PLACES;
            if self.without.contains(&kind) || self.uses(kind) || few {
                continue;
            }
            if let Some((centre, asked)) = propose::joint(self.source, &solution.residuals_um, axis) {
                let width = 0.4 * narrowest_mm(self.data, axis);
                let variants = self.library.join(kind, centre, width);
                self.library.add_variants(kind, variants, asked.min(48));
            }
        }
        self.refine_shapes(rho);
        self.grow();
    }

    fn uses(&self, kind: EffectKind) -> bool {
        self.parts.iter().any(|p| self.library.candidates[p.candidate].kind == kind)
    }

    /// Refined shapes of the effects in the model.
    fn refine_shapes(&mut self, rho: f64) {
        let columns = model_columns(&self.library, &self.parts);
        let terms = columns.iter().map(|c| (*c, self.library.terms[*c])).collect();
        let stage = Stage::new(self.source, terms, rho);
        for place in 0..self.parts.len() {
            let part = self.parts[place];
            let kind = self.library.candidates[part.candidate].kind;
            let own = self.library.candidates[part.candidate].variants[part.variant].columns.clone();
            let Some((shape, indices)) = self.shape_of(&own) else { continue };
            let narrowest = match kind {
                EffectKind::Local(axis) => narrowest_mm(self.data, axis),
                _ => 0.0,
            };
            let Some(better) = stage.refined(&own, kind, &shape, &indices, narrowest) else { continue };
            if better == shape {
                continue;
            }
            let variants = match kind {
                EffectKind::Pitch(axis) => {
                    propose::pitch_variants(&mut self.library, self.data, axis, better.pitch_mm)
                }
                EffectKind::Local(_) => self.library.place(kind, better.centre_mm, better.width_mm),
                EffectKind::Joint(_) => self.library.join(kind, better.centre_mm, better.width_mm),
                _ => {
                    let columns = self.library.add_columns(kind, better, &indices);
                    vec![Variant { columns, enriched: false, only_rival: false }]
                }
            };
            self.library.add_variants(kind, variants, 0);
        }
    }

    /// The common shape of an effect's columns and their coefficient indices; two time constants have none.
    fn shape_of(&self, columns: &[usize]) -> Option<(Shape, Vec<usize>)> {
        let mut shape: Option<Shape> = None;
        let mut indices = Vec::new();
        for column in columns {
            let Term::Effect { shape: this, index, .. } = self.library.terms[*column] else { return None };
            if shape.is_some_and(|s| s != this) {
                return None;
            }
            shape = Some(this);
            indices.push(index);
        }
        shape.map(|s| (s, indices))
    }
}

/// Probability that an F variate exceeds `ratio`.
#[must_use]
pub(crate) fn f_tail(ratio: f64, numerator: f64, denominator: f64) -> f64 {
    if ratio <= 0.0 || ratio.is_nan() {
        return 1.0;
    }
    FisherSnedecor::new(numerator.max(1.0), denominator.max(1.0)).map_or(1.0, |d| d.sf(ratio))
}
