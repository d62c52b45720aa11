//! The causes that some rows are asked about, and what they explain.

use nalgebra::DVector;
use units::math;

use super::columns::{Cause, CauseRow, Columns};
use super::mixed::{Fitted, Mixed, Noise};

/// Chance of a name that is none, over all causes.
const LEVEL: f64 = 0.01;
/// A column of which less is its own is one of the others.
const OWN: f64 = 1e-6;

/// The causes that are asked for, with their columns.
pub(super) struct Asked<'a> {
    pub(super) columns: &'a Columns<'a>,
    pub(super) mixed: Mixed,
    pub(super) all: Vec<(Cause, Vec<DVector<f64>>)>,
    pub(super) weights: Vec<f64>,
}

pub(super) fn indicator(rows: &[CauseRow], of: impl Fn(&CauseRow) -> f64) -> DVector<f64> {
    DVector::from_iterator(rows.len(), rows.iter().map(of))
}

/// One column for each different key.
pub(super) fn levels<K: PartialEq>(rows: &[CauseRow], key: impl Fn(&CauseRow) -> K) -> Vec<DVector<f64>> {
    let mut keys: Vec<K> = Vec::new();
    for row in rows {
        if !keys.contains(&key(row)) {
            keys.push(key(row));
        }
    }
    keys.iter().map(|own| indicator(rows, |row| f64::from(u8::from(key(row) == *own)))).collect()
}

/// Where the centre of each cross section lies: one wave a turn is the clamping's, in the machine or on the instrument.
pub(super) fn centres(rows: &[CauseRow]) -> Vec<DVector<f64>> {
    let turned: Vec<CauseRow> = rows.iter().filter(|row| row.angle_rad.is_some()).cloned().collect();
    let mut sections: Vec<(usize, f64)> = Vec::new();
    for row in &turned {
        if !sections.contains(&(row.part, row.z_mm)) {
            sections.push((row.part, row.z_mm));
        }
    }
    let wave = |section: &(usize, f64), of: fn(f64) -> f64| {
        indicator(rows, |row| match row.angle_rad {
            Some(angle) if (row.part, row.z_mm) == *section => of(angle),
            _ => 0.0,
        })
    };
    sections.iter().flat_map(|section| [wave(section, math::cos), wave(section, math::sin)]).collect()
}

/// What has a size of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sizes {
    /// Each tool, and each part of which none is named.
    OfTools,
    /// Each part with each tool.
    OfParts,
}

impl<'a> Asked<'a> {
    pub(super) fn new(columns: &'a Columns<'a>, parts: &[usize], sizes: Sizes) -> Self {
        let rows = columns.rows;
        // Stated of all rows, or alike in all.
        let stated: Option<Vec<f64>> = rows.iter().map(|row| row.uncertainty_mm).collect();
        let noise = if stated.is_some() { Noise::Stated } else { Noise::Common };
        let weights = stated.unwrap_or_else(|| vec![1.0; rows.len()]);
        let weigh = |column: DVector<f64>| DVector::from_fn(rows.len(), |k, _| column[k] / weights[k]);
        let weighed = |all: Vec<DVector<f64>>| all.into_iter().map(weigh).collect::<Vec<DVector<f64>>>();
        let centres = centres(rows);
        let with = |own: Vec<DVector<f64>>| weighed(own.into_iter().chain(centres.clone()).collect());
        let cells = with(levels(rows, |row| (row.part, row.tool)));
        let sizes = match sizes {
            Sizes::OfParts => cells.clone(),
            Sizes::OfTools => with(levels(rows, |row| (row.tool, row.tool.is_none().then_some(row.part)))),
        };
        let shared = weighed(
            parts.iter().map(|part| indicator(rows, |row| f64::from(u8::from(row.part == *part)))).collect(),
        );
        let readings = weigh(indicator(rows, |row| row.gap_mm));
        let mixed = Mixed::new(readings, sizes, &cells, shared, noise);
        let mut asked = Self { columns, mixed, all: Vec::new(), weights: weights.clone() };
        for cause in Cause::ALL {
            let own: Vec<DVector<f64>> = weighed(columns.cause(cause))
                .into_iter()
                .filter(|column| column.norm() > 0.0 && asked.mixed.seen(column) > OWN)
                .collect();
            if !own.is_empty() {
                asked.all.push((cause, own));
            }
        }
        asked
    }

    pub(super) fn everything(&self) -> Vec<DVector<f64>> {
        self.all.iter().flat_map(|(_, own)| own.clone()).collect()
    }

    /// The columns without those that others before them are.
    pub(super) fn independent(&self, columns: &[DVector<f64>]) -> Vec<DVector<f64>> {
        let mut kept: Vec<DVector<f64>> = Vec::new();
        for column in columns {
            if self.mixed.own_share(column, &kept) > OWN {
                kept.push(column.clone());
            }
        }
        kept
    }

    pub(super) fn of(&self, causes: &[usize]) -> Vec<DVector<f64>> {
        causes.iter().flat_map(|k| self.all[*k].1.clone()).collect()
    }

    /// Chance that columns beside others are noise; 1 where the others are these.
    pub(super) fn p_beside(&self, own: &[DVector<f64>], others: &[DVector<f64>]) -> f64 {
        let mut model = self.independent(others);
        let before = model.len();
        for column in own {
            if self.mixed.own_share(column, &model) > OWN {
                model.push(column.clone());
            }
        }
        let tested: Vec<usize> = (before..model.len()).collect();
        if tested.is_empty() { 1.0 } else { self.mixed.fit(&model).p(&tested) }
    }

    /// Of a cause beside others.
    pub(super) fn p(&self, cause: usize, others: &[usize]) -> f64 {
        self.p_beside(&self.all[cause].1, &self.of(others))
    }

    pub(super) fn level(&self) -> f64 {
        LEVEL / self.all.len().max(1) as f64
    }

    /// Causes that are needed, the surest first: one after the other, and none that the later ones made needless.
    pub(super) fn selected(&self) -> Vec<usize> {
        let mut selected: Vec<usize> = Vec::new();
        loop {
            let open = (0..self.all.len()).filter(|k| !selected.contains(k));
            let best = open.map(|k| (k, self.p(k, &selected))).min_by(|a, b| a.1.total_cmp(&b.1));
            match best {
                Some((k, p)) if p < self.level() => selected.push(k),
                _ => break,
            }
        }
        let mut place = 0;
        while place < selected.len() {
            let others: Vec<usize> = selected.iter().copied().filter(|k| *k != selected[place]).collect();
            if self.p(selected[place], &others) < self.level() {
                place += 1;
            } else {
                selected.remove(place);
                place = 0;
            }
        }
        selected
    }

    pub(super) fn typical(&self) -> f64 {
        self.weights.iter().sum::<f64>() / self.weights.len().max(1) as f64
    }

    pub(super) fn weighed(&self, column: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(column.len(), |k, _| column[k] / self.weights[k])
    }

    /// Every part's own lean, as a clamping makes it.
    pub(super) fn tilts(&self, parts: &[usize]) -> Vec<DVector<f64>> {
        self.columns.tilts(parts).map(|column| self.weighed(&column)).collect()
    }

    /// Of the squares that are no noise, those that a model explains beyond another.
    pub(super) fn share(&self, before: &[DVector<f64>], after: &[DVector<f64>], found: &Fitted) -> f64 {
        let [gap, before, after] = [&[], before, after].map(|model| self.mixed.rms_with(model));
        let signal = (gap * gap - found.noise * found.noise).max(f64::MIN_POSITIVE);
        ((before * before - after * after) / signal).clamp(0.0, 1.0)
    }

    /// What causes that were found do to each row, mm.
    pub(super) fn effect_mm(
        &self,
        selected: &[usize],
        found: &Fitted,
        is_asked: impl Fn(Cause) -> bool,
    ) -> DVector<f64> {
        let mut place = 0;
        let mut sum = DVector::zeros(self.weights.len());
        for k in selected {
            let (own, columns) = &self.all[*k];
            for (i, column) in columns.iter().enumerate().filter(|_| is_asked(*own)) {
                let value = found.values[place + i];
                sum += DVector::from_fn(column.len(), |row, _| column[row] * self.weights[row] * value);
            }
            place += columns.len();
        }
        sum
    }
}
