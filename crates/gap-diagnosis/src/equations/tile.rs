//! Products of many columns at once, a chunk of equations at a time.
//!
//! A chunk of all columns stays in the cache, and a tile of two by four products is added up in registers. The order of the
//! additions depends on the number of equations alone.

use std::ops::Range;

/// Equations that are multiplied at a time.
pub(crate) const CHUNK: usize = 256;
/// Products are added up in so many partial sums.
const LANES: usize = 2;

/// Products that are wanted: of one column or two neighbours with a range of them.
#[derive(Clone, Debug)]
struct Job {
    rows: Range<usize>,
    with: Range<usize>,
}

/// Values of some columns over a chunk, and the sums of the products that are wanted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tiles {
    /// Column by column, [`CHUNK`] numbers each.
    values: Vec<f64>,
    jobs: Vec<Job>,
    /// Job by job, row by row.
    sums: Vec<f64>,
}

impl Tiles {
    /// `count` columns, no products wanted yet.
    pub(crate) fn new(count: usize) -> Self {
        Self { values: vec![0.0; count * CHUNK], ..Self::default() }
    }

    /// Products of some columns with some columns are wanted.
    pub(crate) fn want(&mut self, rows: Range<usize>, with: Range<usize>) {
        for first in rows.clone().step_by(2) {
            let job = Job { rows: first..rows.end.min(first + 2), with: with.clone() };
            self.sums.resize(self.sums.len() + job.rows.len() * with.len(), 0.0);
            self.jobs.push(job);
        }
    }

    /// Products of some columns with one another and with all behind them are wanted.
    pub(crate) fn want_with_later(&mut self, rows: Range<usize>, end: usize) {
        for first in rows.clone().step_by(2) {
            self.want(first..rows.end.min(first + 2), first..end);
        }
    }

    /// The first `length` values of a column.
    pub(crate) fn column(&mut self, column: usize, length: usize) -> &mut [f64] {
        &mut self.values[column * CHUNK..column * CHUNK + length]
    }

    /// Adds the products over the first `length` equations of the chunk.
    pub(crate) fn multiply(&mut self, length: usize) {
        let even = length.next_multiple_of(LANES);
        for values in self.values.chunks_exact_mut(CHUNK) {
            values[length..even].fill(0.0);
        }
        let of = |k: usize| &self.values[k * CHUNK..k * CHUNK + even];
        let mut sums = self.sums.as_mut_slice();
        for Job { rows, with } in &self.jobs {
            let (upper, rest) = std::mem::take(&mut sums).split_at_mut(with.len());
            let two = rows.len() == 2;
            let (lower, rest) = rest.split_at_mut(if two { with.len() } else { 0 });
            sums = rest;
            let a = rows.start;
            let mut b = with.start;
            while b < with.end {
                let place = b - with.start;
                if two && b + 4 <= with.end {
                    let sums = tile([of(a), of(a + 1)], [of(b), of(b + 1), of(b + 2), of(b + 3)]);
                    (0..4).for_each(|j| upper[place + j] += sums[0][j]);
                    (0..4).for_each(|j| lower[place + j] += sums[1][j]);
                    b += 4;
                } else {
                    upper[place] += tile([of(a)], [of(b)])[0][0];
                    if two {
                        lower[place] += tile([of(a + 1)], [of(b)])[0][0];
                    }
                    b += 1;
                }
            }
        }
    }

    /// True where nothing is wanted.
    pub(crate) fn is_idle(&self) -> bool {
        self.sums.is_empty()
    }

    /// Every product that was wanted, once: two columns and the sum.
    pub(crate) fn products(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let pairs = self.jobs.iter().flat_map(|job| {
            let later = job.with.start == job.rows.start;
            let with = job.with.clone();
            job.rows.clone().flat_map(move |a| with.clone().map(move |b| (a, b, !later || b >= a)))
        });
        pairs.zip(&self.sums).filter(|((.., once), _)| *once).map(|((a, b, _), sum)| (a, b, *sum))
    }
}

/// Inner products of every column of `a` with every column of `b`.
#[inline(always)]
fn tile<const A: usize, const B: usize>(a: [&[f64]; A], b: [&[f64]; B]) -> [[f64; B]; A] {
    let length = a[0].len();
    let (a, b) = (a.map(|v| &v[..length]), b.map(|v| &v[..length]));
    let mut sums = [[[0.0; LANES]; B]; A];
    let mut k = 0;
    while k + LANES <= length {
        for i in 0..A {
            for j in 0..B {
                for lane in 0..LANES {
                    sums[i][j][lane] += a[i][k + lane] * b[j][k + lane];
                }
            }
        }
        k += LANES;
    }
    sums.map(|row| row.map(|lanes| lanes.iter().sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every count of columns and equations, so that every remainder occurs.
    #[test]
    fn tiles_are_the_plain_sums() {
        for (count, first, length) in
            [(2, 0, 1), (3, 1, 7), (9, 0, 255), (12, 5, 256), (7, 5, 3), (8, 6, 100)]
        {
            let value = |k: usize, i: usize| ((k * 37 + i * 11) % 23) as f64 - 9.0;
            let mut tiles = Tiles::new(count);
            tiles.want(first..count - 1, 0..first);
            tiles.want_with_later(first..count - 1, count);
            // Twice: a chunk that was longer before must leave nothing behind.
            for (length, offset) in [(CHUNK, 5), (length, 0)] {
                for k in 0..count {
                    let column = tiles.column(k, length).iter_mut().enumerate();
                    column.for_each(|(i, v)| *v = value(k, i + offset));
                }
                tiles.multiply(length);
            }
            let expected = |a: usize, b: usize| -> f64 {
                let sum = |n: usize, o: usize| (o..o + n).map(|i| value(a, i) * value(b, i)).sum::<f64>();
                sum(CHUNK, 5) + sum(length, 0)
            };
            let mut seen = vec![false; count * count];
            for (a, b, sum) in tiles.products() {
                seen[a * count + b] = true;
                assert!((sum - expected(a, b)).abs() < 1e-9, "{count} {first} {length}: {a} {b}");
            }
            let wanted = |a: usize, b: usize| b < first || b >= a;
            assert!((first..count - 1).all(|a| (0..count).all(|b| seen[a * count + b] || !wanted(a, b))));
        }
    }
}
