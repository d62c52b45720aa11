//! Several points evaluated together.
//!
//! A machine is a chain: the error of what lies beyond an axis has to be known before that axis' own. Most of the time of
//! one point is spent waiting for that; points side by side wait together, and share instructions where the processor
//! does four numbers in one. Each goes through the very operations it would go through alone, none of them fused, so that
//! its bits depend neither on its neighbours nor on the processor.

use std::ops::{Add, Mul, Sub};

use pulp::bytemuck::cast;
use pulp::{Simd, f64x4};

use crate::axis_tables::{AxisTables, Cell};
use crate::component::Six;
use crate::link::Link;
use crate::real::Real;
use crate::table::{slope_of, value_of};
use crate::{LANES, Range, Vector};

/// What is done for several points at once.
pub(crate) trait Together {
    /// What comes of it.
    type Output;

    /// Does it with the instructions of `simd`.
    fn with<S: Simd<f64s = f64x4>>(self, simd: S) -> Self::Output;
}

/// Does something for several points with the best instructions that the processor has for it.
#[inline]
pub(crate) fn together<T: Together>(work: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        struct WithFour<T>(T, pulp::x86::V3);
        impl<T: Together> pulp::NullaryFnOnce for WithFour<T> {
            type Output = T::Output;
            #[inline(always)]
            fn call(self) -> Self::Output {
                self.0.with(self.1)
            }
        }
        return simd.vectorize(WithFour(work, simd));
    }
    work.with(pulp::Scalar256b)
}

/// A number for each point.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S> {
    simd: S,
    numbers: f64x4,
}

impl<S: Simd<f64s = f64x4>> Lanes<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, numbers: [f64; LANES]) -> Self {
        Self { simd, numbers: cast(numbers) }
    }

    #[inline(always)]
    pub(crate) fn each(self) -> [f64; LANES] {
        cast(self.numbers)
    }

    /// True where `low <= q < high` for all.
    #[inline(always)]
    fn all_within(self, low: f64, high: f64) -> bool {
        let simd = self.simd;
        let above = simd.less_than_or_equal_f64s(simd.splat_f64s(low), self.numbers);
        let below = simd.less_than_f64s(self.numbers, simd.splat_f64s(high));
        all(simd, simd.and_m64s(above, below))
    }

    /// True where [`Range::contains`] is for each.
    #[inline(always)]
    pub(crate) fn all_in(self, range: &Range) -> bool {
        let simd = self.simd;
        let above = simd.less_than_or_equal_f64s(simd.splat_f64s(range.low), self.numbers);
        let below = simd.less_than_or_equal_f64s(self.numbers, simd.splat_f64s(range.high));
        all(simd, simd.and_m64s(above, below))
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self { numbers: self.simd.sqrt_f64s(self.numbers), ..self }
    }
}

/// True where the mask is for all.
#[inline(always)]
fn all<S: Simd<f64s = f64x4>>(simd: S, mask: S::m64s) -> bool {
    let [a, b, c, d]: [u64; LANES] = cast(simd.transmute_u64s_m64s(mask));
    a & b & c & d == u64::MAX
}

/// The three components of a vector side by side; what is beside them is of no use.
#[derive(Clone, Copy)]
pub(crate) struct Components<S> {
    simd: S,
    numbers: f64x4,
}

impl<S: Simd<f64s = f64x4>> Components<S> {
    /// Three numbers that follow each other.
    #[inline(always)]
    pub(crate) fn of(simd: S, numbers: &[f64], from: usize) -> Self {
        Self { simd, numbers: f64x4(numbers[from], numbers[from + 1], numbers[from + 2], 0.0) }
    }

    #[inline(always)]
    pub(crate) fn vector(simd: S, v: &Vector) -> Self {
        Self { simd, numbers: f64x4(v.x, v.y, v.z, 0.0) }
    }

    /// The same number for each.
    #[inline(always)]
    pub(crate) fn all(self, value: f64) -> Self {
        Self { numbers: self.simd.splat_f64s(value), ..self }
    }

    #[inline(always)]
    pub(crate) fn scaled(self, by: f64) -> Self {
        self * self.all(by)
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self { numbers: self.simd.max_f64s(self.numbers, other.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self { numbers: self.simd.min_f64s(self.numbers, other.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self { numbers: self.simd.abs_f64s(self.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn negative(self) -> Self {
        Self { numbers: self.simd.neg_f64s(self.numbers), ..self }
    }

    /// Y, Z, X.
    #[inline(always)]
    pub(crate) fn next(self) -> Self {
        let f64x4(x, y, z, rest) = self.numbers;
        Self { numbers: f64x4(y, z, x, rest), ..self }
    }

    #[inline(always)]
    pub(crate) fn sum(self) -> f64 {
        let f64x4(x, y, z, _) = self.numbers;
        x + y + z
    }

    #[inline(always)]
    pub(crate) fn norm(self) -> f64 {
        let f64x4(x, y, z, _) = (self * self).numbers;
        (x + y + z).sqrt()
    }
}

/// One number, or one for each of several points, that tables of an axis can be asked for.
pub(crate) trait OfAxis: Real {
    /// Directions of motion for each point.
    type Directions;

    /// The six functions of an axis at `q`; `None` where it has no errors.
    fn six(link: &Link, q: Self, directions: &Self::Directions) -> Option<[Self; 6]>;

    /// The same with their slopes.
    fn six_with_slopes(link: &Link, q: Self, directions: &Self::Directions)
    -> Option<([Self; 6], [Self; 6])>;
}

impl OfAxis for f64 {
    type Directions = [i8; 3];

    #[inline(always)]
    fn six(link: &Link, q: Self, directions: &[i8; 3]) -> Option<Six> {
        link.tables(directions[link.axis]).map(|tables| tables.at(q))
    }
    #[inline(always)]
    fn six_with_slopes(link: &Link, q: Self, directions: &[i8; 3]) -> Option<(Six, Six)> {
        link.tables(directions[link.axis]).map(|tables| tables.with_slopes(q))
    }
}

macro_rules! each_lane {
    ($of:ident, $trait:ident, $function:ident, $lanes:ident) => {
        impl<S: Simd<f64s = f64x4>> $trait for $of<S> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self { numbers: self.simd.$lanes(self.numbers, other.numbers), ..self }
            }
        }
    };
}

each_lane!(Lanes, Add, add, add_f64s);
each_lane!(Lanes, Sub, sub, sub_f64s);
each_lane!(Lanes, Mul, mul, mul_f64s);
each_lane!(Components, Add, add, add_f64s);
each_lane!(Components, Sub, sub, sub_f64s);
each_lane!(Components, Mul, mul, mul_f64s);

// No closures from here on where lanes meet: what they call would be compiled for every processor.

impl<S: Simd<f64s = f64x4>> Real for Lanes<S> {
    #[inline(always)]
    fn all(self, value: f64) -> Self {
        Self { numbers: self.simd.splat_f64s(value), ..self }
    }
}

impl<S: Simd<f64s = f64x4>> OfAxis for Lanes<S> {
    type Directions = [[i8; 3]; LANES];

    #[inline(always)]
    fn six(link: &Link, q: Self, directions: &Self::Directions) -> Option<[Self; 6]> {
        let tables = for_lanes(link, directions)?;
        if let Some((cell, t)) = common_cell(&tables, q) {
            return Some(cell.at(t));
        }
        let (cells, t) = Cells::of(&tables, &q.each());
        let (straight, curved, t) = (cells.straight(q.simd), cells.curved(q.simd), Self::new(q.simd, t));
        let [c0, c1] = straight;
        let mut six = c0;
        for i in 0..6 {
            six[i] = match &curved {
                None => c0[i] + t * c1[i],
                Some([c2, c3]) => value_of(&[c0[i], c1[i], c2[i], c3[i]], t),
            };
        }
        Some(six)
    }

    #[inline(always)]
    fn six_with_slopes(
        link: &Link,
        q: Self,
        directions: &Self::Directions,
    ) -> Option<([Self; 6], [Self; 6])> {
        let tables = for_lanes(link, directions)?;
        if let Some((cell, t)) = common_cell(&tables, q) {
            return Some(cell.with_slopes(t));
        }
        let (cells, t) = Cells::of(&tables, &q.each());
        let (straight, curved, t) = (cells.straight(q.simd), cells.curved(q.simd), Self::new(q.simd, t));
        let [c0, c1] = straight;
        let (mut six, mut slopes) = (c0, c1);
        for i in 0..6 {
            match &curved {
                None => six[i] = c0[i] + t * c1[i],
                Some([c2, c3]) => {
                    six[i] = value_of(&[c0[i], c1[i], c2[i], c3[i]], t);
                    slopes[i] = slope_of(&[c0[i], c1[i], c2[i], c3[i]], t);
                }
            }
        }
        Some((six, slopes))
    }
}

/// The cells that several points lie in.
struct Cells<'t>([Cell<'t>; LANES]);

/// The six functions' coefficients of two powers for each point.
type Rows<S> = [[Lanes<S>; 6]; 2];

impl<'t> Cells<'t> {
    /// The cells, and how far each point lies from the lower node of its own.
    #[inline(always)]
    fn of(tables: &[&'t AxisTables; LANES], q: &[f64; LANES]) -> (Self, [f64; LANES]) {
        let [(a, at_a), (b, at_b)] = [tables[0].cell_of(q[0]), tables[1].cell_of(q[1])];
        let [(c, at_c), (d, at_d)] = [tables[2].cell_of(q[2]), tables[3].cell_of(q[3])];
        (Self([a, b, c, d]), [at_a, at_b, at_c, at_d])
    }

    #[inline(always)]
    fn straight<S: Simd<f64s = f64x4>>(&self, simd: S) -> Rows<S> {
        let [a, b, c, d] = &self.0;
        rows(simd, [a.straight, b.straight, c.straight, d.straight])
    }

    /// `None` where all functions are straight lines.
    #[inline(always)]
    fn curved<S: Simd<f64s = f64x4>>(&self, simd: S) -> Option<Rows<S>> {
        static NONE: [Six; 2] = [[0.0; 6]; 2];
        let [a, b, c, d] = &self.0;
        let or_none = [a.curved, b.curved, c.curved, d.curved];
        if let [None, None, None, None] = or_none {
            return None;
        }
        let mut curved = [&NONE; LANES];
        for lane in 0..LANES {
            if let Some(own) = or_none[lane] {
                curved[lane] = own;
            }
        }
        Some(rows(simd, curved))
    }
}

/// Function by function what is stored point by point.
#[inline(always)]
fn rows<S: Simd<f64s = f64x4>>(simd: S, cells: [&[Six; 2]; LANES]) -> Rows<S> {
    let [a, b, c, d] = cells;
    let mut rows = [[Lanes::new(simd, [0.0; LANES]); 6]; 2];
    for power in 0..2 {
        for i in 0..6 {
            rows[power][i] = Lanes::new(simd, [a[power][i], b[power][i], c[power][i], d[power][i]]);
        }
    }
    rows
}

/// The cell that all points lie in, and how far from its lower node; `None` where they lie in several, or outside.
///
/// Points that follow each other mostly do: then what is read of the tables is the same for all.
#[inline(always)]
fn common_cell<'l, S: Simd<f64s = f64x4>>(
    tables: &[&'l AxisTables; LANES],
    q: Lanes<S>,
) -> Option<(Cell<'l>, Lanes<S>)> {
    let [first, ..] = q.each();
    let cell = tables[0].likely_cell(first);
    let mut common = q.all_within(cell.low, cell.high);
    for own in tables {
        common &= std::ptr::eq(*own, tables[0]);
    }
    if common { Some((cell, q - q.all(cell.low))) } else { None }
}

/// The tables of an axis for each point.
#[inline(always)]
fn for_lanes<'l>(link: &'l Link, directions: &[[i8; 3]; LANES]) -> Option<[&'l AxisTables; LANES]> {
    let mut tables = [link.tables(0)?; LANES];
    if link.by_direction.len() > 1 {
        for (tables, direction) in tables.iter_mut().zip(directions) {
            *tables = link.tables(direction[link.axis])?;
        }
    }
    Some(tables)
}
