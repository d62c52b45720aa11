//! Products of many columns at once, a chunk of equations at a time.
//!
//! A chunk of all columns stays in the cache, and a tile of two by four products is added up in registers. The order of the
//! additions depends on the number of equations alone.

/// Equations that are multiplied at a time.
pub(crate) const CHUNK: usize = 256;
/// Products are added up in so many partial sums.
const LANES: usize = 2;

/// Values of some columns over a chunk, and the sums of the products of the later ones with all.
#[derive(Clone, Debug)]
pub(crate) struct Tiles {
    count: usize,
    /// Columns before this one are not multiplied with one another.
    first: usize,
    /// Column by column, [`CHUNK`] numbers each.
    values: Vec<f64>,
    /// Row by row: the columns from `first` on, the last one left out.
    sums: Vec<f64>,
}

impl Tiles {
    /// `count` columns; the products wanted are those of `first`..`count - 1` with all.
    #[must_use]
    pub(crate) fn new(count: usize, first: usize) -> Self {
        Self { count, first, values: vec![0.0; count * CHUNK], sums: vec![0.0; (count - 1 - first) * count] }
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
        let (first, count) = (self.first, self.count);
        let mut a = first;
        while a < count - 1 {
            let two = a + 2 < count;
            let mut sums = self.sums[(a - first) * count..].chunks_exact_mut(count);
            let (Some(upper), lower) = (sums.next(), sums.next()) else { break };
            let mut nothing = Vec::new();
            let lower = lower.map_or(nothing.as_mut_slice(), |l| l);
            // Products with the earlier ones of the new columns are known by symmetry.
            for (from, to) in [(0, first), (a, count)] {
                let mut b = from;
                while b < to {
                    if two && b + 4 <= to {
                        let sums = tile([of(a), of(a + 1)], [of(b), of(b + 1), of(b + 2), of(b + 3)]);
                        (0..4).for_each(|j| upper[b + j] += sums[0][j]);
                        (0..4).for_each(|j| lower[b + j] += sums[1][j]);
                        b += 4;
                    } else {
                        upper[b] += tile([of(a)], [of(b)])[0][0];
                        if two {
                            lower[b] += tile([of(a + 1)], [of(b)])[0][0];
                        }
                        b += 1;
                    }
                }
            }
            a += if two { 2 } else { 1 };
        }
    }

    /// Every product wanted, once: two columns and the sum.
    pub(crate) fn products(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let rows = self.sums.chunks_exact(self.count).enumerate();
        rows.flat_map(move |(nth, sums)| {
            let a = self.first + nth;
            let wanted = sums.iter().enumerate().filter(move |(b, _)| *b < self.first || *b >= a);
            wanted.map(move |(b, value)| (a, b, *value))
        })
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
            let mut tiles = Tiles::new(count, first);
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
            let found: Vec<_> = tiles.products().collect();
            assert_eq!(found.len(), (first..count - 1).map(|a| first + count - a).sum::<usize>());
            for (a, b, sum) in found {
                assert!((sum - expected(a, b)).abs() < 1e-9, "{count} {first} {length}: {a} {b}");
            }
        }
    }
}
