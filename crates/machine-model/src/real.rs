//! Numbers and vectors of one point or of several.

use std::ops::{Add, Mul, Sub};

use crate::Vector;

/// One number, or one for each of several points.
pub(crate) trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The same number for each point that `self` has one for.
    fn all(self, value: f64) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn all(self, value: f64) -> Self {
        value
    }
}

/// A vector, or one for each point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triple<T>(pub(crate) [T; 3]);

impl<T: Real> Triple<T> {
    /// The same for each point that `like` has a number for.
    #[inline(always)]
    pub(crate) fn all(like: T, v: &Vector) -> Self {
        Self([like.all(v.x), like.all(v.y), like.all(v.z)])
    }
    #[inline(always)]
    pub(crate) fn scaled(self, by: T) -> Self {
        let [x, y, z] = self.0;
        Self([x * by, y * by, z * by])
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

macro_rules! each_of_three {
    ($trait:ident, $function:ident, $operator:tt) => {
        impl<T: Real> $trait for Triple<T> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
                Self([ax $operator bx, ay $operator by, az $operator bz])
            }
        }
    };
}

each_of_three!(Add, add, +);
each_of_three!(Sub, sub, -);

impl From<Triple<f64>> for Vector {
    #[inline(always)]
    fn from(v: Triple<f64>) -> Self {
        Self::new(v.0[0], v.0[1], v.0[2])
    }
}
