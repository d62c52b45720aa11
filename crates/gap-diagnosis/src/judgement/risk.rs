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

use crate::effects::{curve_axis, gives_way_to};
use crate::equations::align::{rms, row_lengths};
use crate::equations::noise::tail_factor;
use crate::equations::observation::{Row, Scalar};
use crate::equations::term::Term;
use crate::judgement::assembly::Assembly;
use crate::judgement::shrinkage::LEAST_WEIGHT;
use crate::library::candidates::{Library, Part};
use crate::search::explanation::Reason;
use crate::search::moves::{by_effect, halves, with, without};
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
/// Share of every axis, and of the rows, that must pass for a part of the volume to be worth writing: what agrees only
/// where nobody measured agrees by chance.
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
    /// How each of them turns the measuring frame, µrad.
    turns: Vec<Vector>,
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
        let of_terms: Vec<Vec<Vec<Vector>>> = all.iter().map(|e| grid.displacements_um(e, self)).collect();
        let moved = |k: usize, probe: usize| -> Vector {
            let values = all[k].values.iter().zip(&of_terms[k]);
            values.map(|(value, own)| own[probe] * *value).sum()
        };
        let mut harmed: Vec<Option<Option<Stand>>> = vec![None; grid.nodes.len()];
        for probe in 0..grid.nodes.len() * grid.samples.len() {
            let correction = moved(0, probe);
            let size = correction.norm();
            let node = probe % grid.nodes.len();
            let harmed = &mut harmed[node];
            if size <= slack_um || harmed.is_some() {
                continue;
            }
            let curves =
                (0..all[0].terms.len()).filter(|i| self.is_guessed(&all[0].terms[*i], &grid.nodes[node]));
            let guessed: Vector = curves.map(|i| of_terms[0][i][probe] * all[0].values[i]).sum();
            if guessed.norm() > slack_um {
                *harmed = Some(None);
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
        grid.passes(&harmed, &self.data.rows)
    }

    /// True of a curve beyond the ends of the way on which its axis was read: unlike a line, or a screw's turns, it may
    /// go on there in any way.
    fn is_guessed(&self, term: &Term, place_mm: &Vector) -> bool {
        /// Share of that way: the curves of the library have a summit every sixth of it.
        const BEYOND: f64 = 0.1;
        let axis = term.kind().filter(|kind| !matches!(kind, EffectKind::Pitch(_))).and_then(curve_axis);
        axis.is_some_and(|axis| {
            let (low, high) = self.model.library.sampling[axis].range_mm;
            let slack_mm = BEYOND * (high - low);
            place_mm[axis] < low - slack_mm || place_mm[axis] > high + slack_mm
        })
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
    /// for two, and two for one: a squareness and a curve for a droop, a plainer play and a drift for a play.
    fn not_refuted(&self) -> Vec<Explained> {
        let model = self.model;
        let (library, parts) = (&model.library, &model.parts);
        let score = model.space.fit(library, parts).score;
        let own_prior = model.log_prior(parts);
        let least = units::math::ln(LEAST_WEIGHT);
        // Whatever machines usually have, no model is likelier by that than one without a price.
        let limit = score - 2.0 * (own_prior + least);
        let scan = |rest: &[Part]| model.space.scan(library, rest, Asked::WithRivals);
        let likely = |rest: &[Part], scanned: &[(Part, Fit)], group: &[usize]| {
            let is_other = |(part, _): &(Part, Fit)| {
                let slopes = group.iter().any(|place| library.slopes_as(*part, library.kind(parts[*place])));
                !slopes && !parts.contains(part) && unsupported(library, *part, &self.data.rows).is_none()
            };
            let others = by_effect(scanned.iter().copied().filter(is_other).collect(), limit);
            let all = others.into_iter().filter_map(|(part, fit)| {
                let all = with(rest, part);
                // What the rows say and what machines usually have, together: an angle that no carriage has may fit
                // better.
                let likelier = model.log_prior(&all) - own_prior - 0.5 * (fit.score - score);
                (likelier > least).then_some((part, all))
            });
            all.collect::<Vec<_>>()
        };
        let pairs = (0..parts.len()).flat_map(|a| (0..a).map(move |b| vec![b, a]));
        let written =
            |group: &Vec<usize>| group.iter().all(|place| self.corrects(library.kind(parts[*place])));
        let groups = (0..parts.len()).map(|a| vec![a]).chain(pairs).filter(written);
        let mut found = Vec::new();
        for group in groups {
            let rest = group.iter().rev().fold(parts.clone(), |rest, place| without(&rest, *place));
            let scanned = scan(&rest);
            let singles = likely(&rest, &scanned, &group);
            found.extend(singles.iter().map(|(part, all)| self.explained(all, Some((group[0], *part)))));
            let [place] = group[..] else { continue };
            let kind = library.kind(parts[place]);
            let mut firsts = halves(library, parts[place], &scanned);
            firsts.retain(|first| singles.iter().all(|(single, _)| single != first));
            for first in firsts {
                let is_plainer = library.kind(first) == kind;
                let is_second = |(part, _): &(Part, Fit)| match library.kind(*part) {
                    second if is_plainer => second.is_instrument(),
                    second => gives_way_to(kind, second),
                };
                let rest = with(&rest, first);
                let seconds: Vec<_> = scan(&rest).into_iter().filter(is_second).collect();
                for (second, all) in likely(&rest, &seconds, &group) {
                    found.push(self.explained(&all, Some((place, if is_plainer { second } else { first }))));
                }
            }
        }
        found.extend(self.with_what_is_little());
        found
    }

    /// The causes beside one that passed the tests and has too little share of what the rows show to be named: it may have
    /// more elsewhere.
    fn with_what_is_little(&self) -> Option<Explained> {
        let model = self.model;
        let little = model.refused.as_ref().filter(|refused| matches!(refused.reason, Reason::Little(_)))?;
        let scanned = model.space.scan(&model.library, &model.parts, Asked::Nameable);
        let same = scanned.into_iter().filter(|(part, _)| model.library.kind(*part) == little.kind).collect();
        let (part, _) = *by_effect(same, f64::INFINITY).first()?;
        Some(self.explained(&with(&model.parts, part), Some((self.ordered.first()?.place, part))))
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
        // Shift and turn of the frame come first.
        let turn = |i: &usize| {
            let frame = sub.towards(&[0, 1, 2, 3, 4, 5], *i).coefficients(self.alignment);
            Vector::new(frame[3], frame[4], frame[5])
        };
        Explained {
            stand,
            terms: own.iter().map(|i| sub.terms[*i]).collect(),
            turns: own.iter().map(turn).collect(),
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

    /// What one of each term of an explanation displaces, sample by sample at every node, less the frame that fits it best
    /// on the rows: every part of a program is touched off and laid down somewhere, and a shift and a turn of all are
    /// nobody's fault.
    fn displacements_um(&self, explained: &Explained, assembly: &Assembly<'_>) -> Vec<Vec<Vector>> {
        let data = assembly.data;
        let read = Vector::from([0, 1, 2].map(|component| {
            let shows = |s: &Scalar| s.along[component] != 0.0;
            f64::from(u8::from(assembly.model.scalars.iter().any(shows)))
        }));
        let of_term = |(term, turn): (&Term, &Vector)| {
            let at = |row: &Row| {
                let tip_m = 1e-3 * data.geometry.nominal_tip_mm(&row.command);
                term.displacement_um(row, &data.geometry) - turn.cross(&tip_m).component_mul(&read)
            };
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
        explained.terms.iter().zip(&explained.turns).map(of_term).collect()
    }

    /// The largest box without harm that is worth writing.
    fn passes(&self, harmed: &[Option<Option<Stand>>], rows: &[Row]) -> Use {
        let Some(forbids) = harmed.iter().flatten().next().copied() else { return Use::Everywhere };
        let thick = |a: usize| {
            let last = self.axes[a].len() - 1;
            let ranges = (0..=last).flat_map(move |from| (from..=last).map(move |to| [from, to]));
            ranges.filter(move |[from, to]| (to - from) as f64 >= WORTH * last as f64)
        };
        let range =
            |a: usize, [from, to]: [usize; 2]| Range { low: self.axes[a][from], high: self.axes[a][to] };
        let boxes = thick(0).flat_map(|x| thick(1).flat_map(move |y| thick(2).map(move |z| [x, y, z])));
        let holds = |volume: &[Range; 3], place: &Vector| {
            (0..3).all(|a| self.axes[a].len() == 1 || volume[a].contains(place[a]))
        };
        let bad: Vec<&Vector> =
            self.nodes.iter().zip(harmed).filter(|(_, harm)| harm.is_some()).map(|(node, _)| node).collect();
        let passing =
            boxes.map(|sides| (sides, [0, 1, 2].map(|a| range(a, sides[a])))).filter(|(_, volume)| {
                let seen = || rows.iter().filter(|row| holds(volume, &row.command.linear_mm)).count();
                !bad.iter().any(|node| holds(volume, node)) && seen() as f64 >= WORTH * rows.len() as f64
            });
        let nodes = |sides: &[[usize; 2]; 3]| sides.iter().map(|[from, to]| to - from + 1).product::<usize>();
        let largest = passing.max_by_key(|(sides, _)| nodes(sides));
        largest.map_or(Use::Nowhere(forbids), |(_, volume)| Use::Within(Volume(volume), forbids))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine nodes an axis, harm at the second of X and the fifth of Y, whatever Z is.
    #[test]
    fn the_largest_part_without_harm_is_written_where_rows_are() {
        let axes = [(); 3].map(|()| (0..9).map(f64::from).collect::<Vec<f64>>());
        let place = |k: usize| Vector::new((k / 81) as f64, (k / 9 % 9) as f64, (k % 9) as f64);
        let nodes: Vec<Vector> = (0..729).map(place).collect();
        let harmed: Vec<_> =
            nodes.iter().map(|node| (node.x == 1.0 && node.y == 4.0).then_some(None)).collect();
        let grid = Grid { axes, nodes, samples: Vec::new() };
        let rows = |x_mm: f64| {
            let mut row = crate::tests::measured(crate::tests::GOOD, |_| Vector::zeros()).rows[0];
            row.command.linear_mm = Vector::new(x_mm, 4.0, 4.0);
            [row]
        };
        let whole = Range { low: 0.0, high: 8.0 };
        let part = Volume([Range { low: 2.0, ..whole }, whole, whole]);
        assert_eq!(grid.passes(&harmed, &rows(6.0)), Use::Within(part, None));
        // Where they were read on the other side, that part is one that nobody measured.
        assert_eq!(grid.passes(&harmed, &rows(1.0)), Use::Nowhere(None));
        assert_eq!(grid.passes(&vec![None; 729], &rows(1.0)), Use::Everywhere);
    }
}
