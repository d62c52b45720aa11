//! Several points evaluated together.
//!
//! A machine is a chain: the error of what lies beyond an axis has to be known before that axis' own. Most of the time of
//! one point is spent waiting for that; points side by side wait together, and two share an instruction. Each goes
//! through the very operations it would go through alone, so that its bits do not depend on its neighbours.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

use crate::Vector;
use crate::axis_tables::{AxisTables, Six};
use crate::rigid_body::Link;

/// How many points are evaluated together.
pub const LANES: usize = 4;

/// A number for each point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

/// One number, or one for each of several points.
pub(crate) trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// Directions of motion for each point.
    type Directions;

    /// The same for all.
    fn all(value: f64) -> Self;

    /// The six functions of an axis at `q`; `None` where it has no errors.
    fn six(link: &Link, q: Self, directions: &Self::Directions) -> Option<[Self; 6]>;

    /// The same with their slopes.
    fn six_with_slopes(link: &Link, q: Self, directions: &Self::Directions)
    -> Option<([Self; 6], [Self; 6])>;
}

impl Real for f64 {
    type Directions = [i8; 3];

    #[inline(always)]
    fn all(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn six(link: &Link, q: Self, directions: &[i8; 3]) -> Option<Six> {
        link.tables(directions[link.axis]).map(|tables| tables.at(q))
    }
    #[inline(always)]
    fn six_with_slopes(link: &Link, q: Self, directions: &[i8; 3]) -> Option<(Six, Six)> {
        link.tables(directions[link.axis]).map(|tables| tables.with_slopes(q))
    }
}

macro_rules! each {
    ($trait:ident, $function:ident, $operator:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(from_fn(|lane| self.0[lane] $operator other.0[lane]))
            }
        }
        impl<T: Real> $trait for Triple<T> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i] $operator other.0[i]))
            }
        }
    };
}

each!(Add, add, +);
each!(Sub, sub, -);

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] * other.0[lane]))
    }
}

impl Real for Lanes {
    type Directions = [[i8; 3]; LANES];

    #[inline(always)]
    fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    fn six(link: &Link, q: Self, directions: &Self::Directions) -> Option<[Self; 6]> {
        let tables = for_lanes(link, directions)?;
        // A loop: what is called here would be compiled for every processor.
        let mut rows: [Six; LANES] = [[0.0; 6]; LANES];
        for lane in 0..LANES {
            rows[lane] = tables[lane].at(q.0[lane]);
        }
        Some(from_fn(|function| Self(from_fn(|lane| rows[lane][function]))))
    }

    #[inline(always)]
    fn six_with_slopes(
        link: &Link,
        q: Self,
        directions: &Self::Directions,
    ) -> Option<([Self; 6], [Self; 6])> {
        let tables = for_lanes(link, directions)?;
        let mut rows: [(Six, Six); LANES] = [Default::default(); LANES];
        for lane in 0..LANES {
            rows[lane] = tables[lane].with_slopes(q.0[lane]);
        }
        Some((
            from_fn(|function| Self(from_fn(|lane| rows[lane].0[function]))),
            from_fn(|function| Self(from_fn(|lane| rows[lane].1[function]))),
        ))
    }
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

/// A vector, or one for each point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triple<T>(pub(crate) [T; 3]);

impl<T: Real> Triple<T> {
    /// The same for all points.
    #[inline(always)]
    pub(crate) fn all(v: &Vector) -> Self {
        Self([T::all(v.x), T::all(v.y), T::all(v.z)])
    }
    #[inline(always)]
    pub(crate) fn scaled(self, by: T) -> Self {
        Self(self.0.map(|v| v * by))
    }
    #[inline(always)]
    pub(crate) fn norm_squared(self) -> T {
        let [x, y, z] = self.0;
        x * x + y * y + z * z
    }
    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        Self([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    }
}

impl From<Triple<f64>> for Vector {
    #[inline(always)]
    fn from(v: Triple<f64>) -> Self {
        Self::new(v.0[0], v.0[1], v.0[2])
    }
}
