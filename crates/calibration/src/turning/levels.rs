//! Groups of readings with one unknown each, and the order in which parts were cut.

use super::rows::TurnedReading;

/// Sizes and shifts, numbered.
pub(crate) struct Levels {
    /// Of each row.
    pub(super) of_row: Vec<usize>,
    /// The first row of each.
    pub(super) first: Vec<usize>,
}

impl Levels {
    /// Rows of one key have one level.
    pub(crate) fn by<K: PartialEq>(rows: &[TurnedReading], key: impl Fn(&TurnedReading) -> K) -> Self {
        let mut first: Vec<usize> = Vec::new();
        let of_row = rows.iter().enumerate().map(|(k, row)| {
            first.iter().position(|known| key(&rows[*known]) == key(row)).unwrap_or_else(|| {
                first.push(k);
                first.len() - 1
            })
        });
        let of_row = of_row.collect();
        Self { of_row, first }
    }

    pub(super) fn count(&self) -> usize {
        self.first.len()
    }
}

/// Which part of its tool a row's part is, counted from the mean: by time where all say it, else as the file lists them.
pub(crate) fn order_of_parts(rows: &[TurnedReading], tools: &Levels) -> Vec<f64> {
    let mut order = vec![0.0; rows.len()];
    for level in 0..tools.count() {
        let own: Vec<usize> = (0..rows.len()).filter(|k| tools.of_row[*k] == level).collect();
        order_within(&own, |k| (rows[k].part, rows[k].time_s), &mut order);
    }
    order
}

/// The same for the rows `own` of one tool; `of`: part and time of a row, s.
pub(super) fn order_within(own: &[usize], of: impl Fn(usize) -> (usize, Option<f64>), order: &mut [f64]) {
    let mut parts: Vec<usize> = Vec::new();
    for k in own {
        if !parts.contains(&of(*k).0) {
            parts.push(of(*k).0);
        }
    }
    if own.iter().all(|k| of(*k).1.is_some()) {
        let start = |part: usize| {
            let times =
                own.iter().map(|k| of(*k)).filter(|(of, _)| *of == part).filter_map(|(_, time_s)| time_s);
            times.fold(f64::INFINITY, f64::min)
        };
        parts.sort_by(|a, b| start(*a).total_cmp(&start(*b)));
    }
    for k in own {
        let place = parts.iter().position(|part| *part == of(*k).0).unwrap_or(0);
        order[*k] = place as f64 - 0.5 * (parts.len() - 1) as f64;
    }
}
