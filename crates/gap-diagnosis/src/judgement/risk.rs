//! Where a correction by the causes may be used: decided by what it risks, not by how large it is.
//!
//! The rows do not refute one explanation but several: the causes named, and each rival in the place of the cause or
//! the two causes it stands for. Under each the truth at a place is normal, with the mean and the covariance of its own
//! fit, the set-up marginalised. A correction `c` makes a place worse where the truth along it is less than half of it,
//! so that the place passes where with 95 % probability that happens under none of them, by more than what is left of
//! the gap anyway. What physics carries outwards (a scale, a squareness) passes as far as its number is known; what
//! rivals have otherwise away from the places measured does not.

use diagnostic::{Text, both};
use machine_model::effects::EffectKind;
use machine_model::{Range, Vector, Volume};
use nalgebra::{DMatrix, DVector};

use crate::equations::align::{rms, row_lengths};
use crate::equations::noise::tail_factor;
use crate::equations::observation::Row;
use crate::equations::term::Term;
use crate::judgement::assembly::Assembly;
use crate::judgement::shrinkage::LEAST_WEIGHT;
use crate::library::candidates::{Library, Part};
use crate::search::moves::{by_effect, without};
use crate::search::space::{Asked, Fit};
use crate::search::trial::unsupported;

/// Nodes of the grid per axis.
const NODES: usize = 9;
/// Rows whose conditions, tools and directions are tried at every node.
const SAMPLES: usize = 4;
/// Quantile of the normal distribution: 95 %, one side.
const SURE: f64 = 1.645;
/// Nodes are uneven by the golden ratio's multiples, which have no period.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Share of every axis that must pass for a part of the volume to be worth writing.
const WORTH: f64 = 0.5;

/// Where the correction may be used.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Use {
    /// Everywhere it is asked for.
    Everywhere,
    /// In this part alone, and the rival that keeps it from the rest; `None` where the causes' own numbers do.
    Within(Volume, Option<Stand>),
    /// Nowhere, and what forbids it.
    Nowhere(Option<Stand>),
}

/// A rival, and the place of the cause that it stands for.
pub(crate) type Stand = (usize, Part);

/// One explanation that the rows do not refute.
struct Explained {
    /// What stands in it otherwise than in the causes named.
    stand: Option<Stand>,
    /// Its columns of the machine, and what is known of them.
    terms: Vec<Term>,
    values: Vec<f64>,
    covariance: DMatrix<f64>,
}

impl Assembly<'_> {
    /// Where the causes may be corrected for, in a volume or in the box that was measured.
    pub(crate) fn may_be_used(&self, volume: Option<Volume>) -> Use {
        let mut all = vec![self.explained(&self.model.parts, None)];
        all.extend(self.not_refuted());
        let grid = Grid::new(self, volume);
        let slack_um = rms(&row_lengths(&self.model.scalars, &self.gap_after(self.ordered.len())));
        let factor = self.wider() * self.variance();
        let of_terms: Vec<Vec<Vec<Vector>>> =
            all.iter().map(|e| grid.displacements_um(&e.terms, self)).collect();
        let moved = |k: usize, probe: usize| -> Vector {
            let values = all[k].values.iter().zip(&of_terms[k]);
            values.map(|(value, own)| own[probe] * *value).sum()
        };
        let mut harmed: Vec<Option<Option<Stand>>> = vec![None; grid.nodes.len()];
        for probe in 0..grid.nodes.len() * grid.samples.len() {
            let correction = moved(0, probe);
            let size = correction.norm();
            let harmed = &mut harmed[probe % grid.nodes.len()];
            if size <= slack_um || harmed.is_some() {
                continue;
            }
            let along = correction / size;
            *harmed = (0..all.len()).find_map(|k| {
                let seen = DVector::from_iterator(
                    all[k].terms.len(),
                    of_terms[k].iter().map(|own| own[probe].dot(&along)),
                );
                let square = seen.dot(&(&all[k].covariance * &seen));
                let least = moved(k, probe).dot(&along) - SURE * (square.max(0.0) * factor).sqrt();
                (least < 0.5 * (size - slack_um)).then_some(all[k].stand)
            });
        }
        grid.passes(&harmed)
    }

    /// By how much tails and readings that hang together widen what is known of the causes.
    fn wider(&self) -> f64 {
        let model = self.model;
        let tail = tail_factor(&model.scalars, &model.solution.residuals_um, &model.dropped_residuals_um);
        (0..model.parts.len())
            .flat_map(|place| self.inflations(place))
            .fold(tail, |most, own| most.max(tail * own))
    }

    /// Explanations beside the one named that the rows do not refute: another effect, or another form, for one cause or
    /// for two.
    fn not_refuted(&self) -> Vec<Explained> {
        let model = self.model;
        let (library, parts) = (&model.library, &model.parts);
        let score = model.space.fit(library, parts).score;
        let own_prior = model.log_prior(parts);
        let pairs = (0..parts.len()).flat_map(|a| (0..a).map(move |b| vec![b, a]));
        let written =
            |group: &Vec<usize>| group.iter().all(|place| self.corrects(library.kind(parts[*place])));
        let groups = (0..parts.len()).map(|a| vec![a]).chain(pairs).filter(written);
        let mut found = Vec::new();
        for group in groups {
            let mut rest = parts.clone();
            group.iter().rev().for_each(|place| rest = without(&rest, *place));
            // Whatever machines usually have, no model is likelier by that than one without a price.
            let limit = score - 2.0 * (own_prior + units::math::ln(LEAST_WEIGHT));
            let scanned = model.space.scan(library, &rest, Asked::WithRivals);
            let is_other = |(part, _): &(Part, Fit)| {
                let slopes = group.iter().any(|place| library.slopes_as(*part, library.kind(parts[*place])));
                !slopes && !parts.contains(part) && unsupported(library, *part, &self.data.rows).is_none()
            };
            let others = scanned.into_iter().filter(is_other).collect();
            for (part, fit) in by_effect(others, limit) {
                let with: Vec<Part> = rest.iter().copied().chain([part]).collect();
                // What the rows say and what machines usually have, together: an angle that no carriage has may fit
                // better.
                let likelier = model.log_prior(&with) - own_prior - 0.5 * (fit.score - score);
                if likelier > units::math::ln(LEAST_WEIGHT) {
                    found.push(self.explained(&with, Some((group[0], part))));
                }
            }
        }
        found
    }

    /// False for faults of the instrument, and for causes that such a fault could have shown as well: nothing is
    /// written of them.
    fn corrects(&self, kind: EffectKind) -> bool {
        let mut named = self.ordered.iter().filter(|r| self.model.library.kind(r.part) == kind);
        !kind.is_instrument() && !named.any(|r| r.told().any(|rival| rival.kind.is_instrument()))
    }

    /// A model of some parts, of which those count that a correction could be made of.
    fn explained(&self, parts: &[Part], stand: Option<Stand>) -> Explained {
        let sub = self.model.space.gram.select(&self.model.library.model_columns(parts));
        let (values, covariance) = sub.estimate(self.model.solution.rho);
        let is_corrected = |i: &usize| match sub.terms[*i] {
            Term::Effect { kind, .. } => self.corrects(kind),
            _ => false,
        };
        let own: Vec<usize> = (0..sub.terms.len()).filter(is_corrected).collect();
        Explained {
            stand,
            terms: own.iter().map(|i| sub.terms[*i]).collect(),
            values: own.iter().map(|i| values[*i]).collect(),
            covariance: DMatrix::from_fn(own.len(), own.len(), |i, j| covariance[(own[i], own[j])]),
        }
    }
}

/// Places at which the risk is looked at, with conditions as they were measured.
struct Grid {
    /// Places of every axis, mm; one where it does not move.
    axes: [Vec<f64>; 3],
    nodes: Vec<Vector>,
    samples: Vec<Row>,
}

impl Grid {
    fn new(assembly: &Assembly<'_>, volume: Option<Volume>) -> Self {
        let data = assembly.data;
        let axes = [0, 1, 2].map(|a| {
            let (low, high) = volume.map_or(data.range_mm(a), |Volume(all)| (all[a].low, all[a].high));
            let count = if high - low > 1e-6 { NODES } else { 1 };
            let step = (high - low) / (count - 1).max(1) as f64;
            // Even nodes would all see one phase of a screw.
            let uneven =
                |k: usize| if k == 0 || k + 1 == count { 0.0 } else { (k as f64 * GOLDEN).fract() - 0.5 };
            (0..count).map(|k| low + step * (k as f64 + 0.6 * uneven(k))).collect::<Vec<f64>>()
        });
        let [x, y, z] = &axes;
        let plane = |x: f64| y.iter().flat_map(move |y| z.iter().map(move |z| Vector::new(x, *y, *z)));
        let nodes = x.iter().flat_map(|x| plane(*x)).collect();
        let step = data.rows.len().div_ceil(SAMPLES).max(1);
        let samples = data.rows.iter().skip(step / 2).step_by(step).copied().collect();
        Self { axes, nodes, samples }
    }

    /// What one of each term displaces, sample by sample at every node, from its mean over the rows: every part of a
    /// program is touched off somewhere, and a shift of all is nobody's fault.
    fn displacements_um(&self, terms: &[Term], assembly: &Assembly<'_>) -> Vec<Vec<Vector>> {
        let data = assembly.data;
        let of_term = |term: &Term| {
            let at = |row: &Row| term.displacement_um(row, &data.geometry);
            let middle = data.rows.iter().map(at).sum::<Vector>() / data.rows.len().max(1) as f64;
            let probes =
                self.samples.iter().flat_map(|sample| self.nodes.iter().map(move |node| (sample, node)));
            let moved = probes.map(|(sample, node)| {
                let mut row = *sample;
                row.command.linear_mm = *node;
                at(&row) - middle
            });
            moved.collect()
        };
        terms.iter().map(of_term).collect()
    }

    /// The largest box without harm that is found by cutting off, again and again, the side with most of it.
    fn passes(&self, harmed: &[Option<Option<Stand>>]) -> Use {
        let Some(forbids) = harmed.iter().flatten().next().copied() else { return Use::Everywhere };
        let count = [0, 1, 2].map(|a| self.axes[a].len());
        let mut kept = count.map(|count| (0, count - 1));
        let at = |place: [usize; 3]| harmed[(place[0] * count[1] + place[1]) * count[2] + place[2]];
        loop {
            let share = |ranges: [(usize, usize); 3]| {
                let [x, y, z] = ranges.map(|(from, to)| from..=to);
                let all = x.flat_map(|x| {
                    y.clone().flat_map({
                        let z = z.clone();
                        move |y| z.clone().map(move |z| [x, y, z])
                    })
                });
                let (bad, nodes) =
                    all.fold((0.0, 0.0), |(bad, n), p| (bad + f64::from(u8::from(at(p).is_some())), n + 1.0));
                bad / nodes
            };
            if share(kept) == 0.0 {
                break;
            }
            let sides = (0..6).filter(|side| kept[side / 2].0 < kept[side / 2].1);
            let slab = |side: usize| {
                let (from, to) = kept[side / 2];
                let mut slab = kept;
                slab[side / 2] = if side.is_multiple_of(2) { (from, from) } else { (to, to) };
                share(slab)
            };
            let Some(worst) = sides.max_by(|a, b| slab(*a).total_cmp(&slab(*b))) else {
                return Use::Nowhere(forbids);
            };
            if worst.is_multiple_of(2) { kept[worst / 2].0 += 1 } else { kept[worst / 2].1 -= 1 }
        }
        let thin =
            (0..3).any(|a| count[a] > 1 && ((kept[a].1 - kept[a].0) as f64) < WORTH * (count[a] - 1) as f64);
        if thin {
            return Use::Nowhere(forbids);
        }
        let range = |a: usize| Range { low: self.axes[a][kept[a].0], high: self.axes[a][kept[a].1] };
        Use::Within(Volume([0, 1, 2].map(range)), forbids)
    }
}

impl Use {
    /// The rival that decides, and the cause that it stands for.
    pub(crate) fn stand(&self) -> Option<Stand> {
        match self {
            Self::Everywhere => None,
            Self::Within(_, stand) | Self::Nowhere(stand) => *stand,
        }
    }

    /// Why the correction is not for the whole volume.
    pub(crate) fn words(&self, library: &Library) -> Option<Text> {
        let why = match self.stand().map(|(_, part)| library.kind(part)) {
            None => Text::pair(
                "their numbers are known too badly away from the places measured: measure there, too",
                "вдали от измеренных точек их числа известны слишком плохо: измерьте и там",
            ),
            Some(rival) => both!(
                "these rows do not refute {rival}, which moves the tool otherwise away from the places measured; the measurement proposed next does",
                "эти строки не опровергают {rival}, а он вдали от измеренных точек смещает инструмент иначе; это решит предложенное следующее измерение"
            ),
        };
        match self {
            Self::Everywhere => None,
            Self::Within(Volume([x, y, z]), _) => Some(both!(
                "The correction is written for X {:.0} to {:.0}, Y {:.0} to {:.0}, Z {:.0} to {:.0} mm alone: {why}.",
                "Коррекция записывается только для X от {:.0} до {:.0}, Y от {:.0} до {:.0}, Z от {:.0} до {:.0} мм: {why:#}.",
                x.low,
                x.high,
                y.low,
                y.high,
                z.low,
                z.high
            )),
            Self::Nowhere(_) => Some(both!(
                "No correction is made of the causes, for it could make places worse: {why}.",
                "По причинам ничего не исправляется, где-то коррекция могла бы навредить: {why:#}."
            )),
        }
    }
}
