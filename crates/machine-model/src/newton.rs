//! The inverse for targets that come by millions: one step of Newton's method and steps of the fixed point, for one
//! target or for several side by side.

use std::array::from_fn;

use pulp::{Simd, f64x4};

use crate::LANES;
use crate::lanes::{Lanes, OfAxis, Together, together};
use crate::real::{Real, Triple};
use crate::solve::TOLERANCE_MM;
use crate::{Command, Everywhere, RigidBody, Vector, Volume};

/// Steps of the fixed point behind Newton's.
const ROUNDS: u32 = 4;

impl RigidBody {
    /// `q + e(q) = wanted` by one step of Newton's method, without head and table errors.
    #[inline(always)]
    fn newton_step<T: OfAxis>(
        &self,
        wanted: &[T; 3],
        directions: &T::Directions,
        tool_mm: &Vector,
    ) -> [T; 3] {
        let (error, gradient) = self.chain_error_and_gradient(wanted, directions, tool_mm);
        // (1 + G)⁻¹ e = e - G e + G² e - …
        (Triple(*wanted) - (error - times(&gradient, error - times(&gradient, error)))).0
    }

    /// `q + e(q) - wanted`.
    #[inline(always)]
    fn residual<T: OfAxis>(
        &self,
        q: &[T; 3],
        wanted: &[T; 3],
        directions: &T::Directions,
        tool_mm: &Vector,
    ) -> Triple<T> {
        let error =
            self.chain_error(q, directions, Triple::all(q[0], tool_mm), Triple::all(q[0], &Vector::zeros()));
        (Triple(*q) - Triple(*wanted)) + error
    }

    /// `q + e(q) = target` by one step of Newton's method and steps of the fixed point, on a machine whose head and table
    /// make no errors.
    ///
    /// A step by the residual `r` leaves at most `gradient·|r|`, which need not be evaluated. `None` where that does
    /// not settle at once, or leaves the volume.
    #[inline]
    pub(crate) fn newton(&self, target: &Command, everywhere: &Everywhere) -> Option<Vector> {
        let wanted = target.linear_mm.into();
        if !self.volume.contains(&target.linear_mm) || self.is_rotary_outside(target) {
            return None;
        }
        let mut q = self.newton_step(&wanted, &target.direction, &target.tool_mm);
        for _ in 0..ROUNDS {
            if !self.volume.contains(&q.into()) {
                return None;
            }
            let residual = self.residual(&q, &wanted, &target.direction, &target.tool_mm);
            q = (Triple(q) - residual).0;
            if everywhere.gradient * residual.norm_squared().sqrt() <= TOLERANCE_MM {
                let q = q.into();
                return self.volume.contains(&q).then_some(q);
            }
        }
        None
    }

    /// [`Self::newton`] for several targets: X, Y and Z of each, or `None` where it has no answer for one of them.
    #[inline]
    pub(crate) fn newton_together(
        &self,
        targets_mm: &[[f64; 3]; LANES],
        directions: &[[i8; 3]; LANES],
        state: &Command,
        everywhere: &Everywhere,
    ) -> Option<[[f64; LANES]; 3]> {
        if self.is_rotary_outside(state) {
            return None;
        }
        together(NewtonTogether { model: self, targets_mm, directions, state, everywhere })
    }

    /// [`crate::PathModel::error_mm`] of several commands inside the volume, without head and table errors: X, Y, Z of each.
    #[inline]
    pub(crate) fn errors_together(
        &self,
        q_mm: &[Vector; LANES],
        directions: &[[i8; 3]; LANES],
        tool_mm: &Vector,
    ) -> [Vector; LANES] {
        together(ErrorsTogether { model: self, q_mm, directions, tool_mm })
    }

    #[inline]
    pub(crate) fn is_rotary_outside(&self, state: &Command) -> bool {
        self.description.chain.has_rotary() && self.rotary_inside(state).is_err()
    }
}

/// A matrix, its columns given, times a vector.
#[inline(always)]
fn times<T: OfAxis>(columns: &[Triple<T>; 3], v: Triple<T>) -> Triple<T> {
    let ([a, b, c], [x, y, z]) = (*columns, v.0);
    a.scaled(x) + b.scaled(y) + c.scaled(z)
}

/// [`RigidBody::newton`] for several targets.
struct NewtonTogether<'a> {
    model: &'a RigidBody,
    targets_mm: &'a [[f64; 3]; LANES],
    directions: &'a [[i8; 3]; LANES],
    state: &'a Command,
    everywhere: &'a Everywhere,
}

impl Together for NewtonTogether<'_> {
    type Output = Option<[[f64; LANES]; 3]>;

    #[inline(always)]
    fn with<S: Simd<f64s = f64x4>>(self, simd: S) -> Self::Output {
        let Self { model, targets_mm, directions, state, everywhere } = self;
        let mut targets = [[0.0; LANES]; 3];
        for (lane, target) in targets_mm.iter().enumerate() {
            for axis in 0..3 {
                targets[axis][lane] = target[axis];
            }
        }
        let [x, y, z] = targets;
        let wanted = [Lanes::new(simd, x), Lanes::new(simd, y), Lanes::new(simd, z)];
        if !all_inside(&wanted, &model.volume) {
            return None;
        }
        let (mut found, mut open) = (targets, [true; LANES]);
        let mut q = model.newton_step(&wanted, directions, &state.tool_mm);
        if !all_inside(&q, &model.volume) {
            return None;
        }
        for _ in 0..ROUNDS {
            let residual = model.residual(&q, &wanted, directions, &state.tool_mm);
            q = (Triple(q) - residual).0;
            if !all_inside(&q, &model.volume) {
                return None;
            }
            let left = (residual.norm_squared().sqrt() * q[0].all(everywhere.gradient)).each();
            let better = [q[0].each(), q[1].each(), q[2].each()];
            // Each takes the rounds that it would take alone.
            for lane in 0..LANES {
                if open[lane] && left[lane] <= TOLERANCE_MM {
                    open[lane] = false;
                    for axis in 0..3 {
                        found[axis][lane] = better[axis][lane];
                    }
                }
            }
            if open == [false; LANES] {
                return Some(found);
            }
        }
        None
    }
}

/// The error of several commands.
struct ErrorsTogether<'a> {
    model: &'a RigidBody,
    q_mm: &'a [Vector; LANES],
    directions: &'a [[i8; 3]; LANES],
    tool_mm: &'a Vector,
}

impl Together for ErrorsTogether<'_> {
    type Output = [Vector; LANES];

    #[inline(always)]
    fn with<S: Simd<f64s = f64x4>>(self, simd: S) -> Self::Output {
        let Self { model, q_mm: [a, b, c, d], directions, tool_mm } = self;
        let q = [
            Lanes::new(simd, [a.x, b.x, c.x, d.x]),
            Lanes::new(simd, [a.y, b.y, c.y, d.y]),
            Lanes::new(simd, [a.z, b.z, c.z, d.z]),
        ];
        let tool = Triple::all(q[0], tool_mm);
        let Triple([x, y, z]) = model.chain_error(&q, directions, tool, Triple::all(q[0], &Vector::zeros()));
        let (x, y, z) = (x.each(), y.each(), z.each());
        from_fn(|lane| Vector::new(x[lane], y[lane], z[lane]))
    }
}

/// True where all points lie in the volume.
#[inline(always)]
fn all_inside<S: Simd<f64s = f64x4>>(q: &[Lanes<S>; 3], volume: &Volume) -> bool {
    let [x, y, z] = &volume.0;
    q[0].all_in(x) && q[1].all_in(y) && q[2].all_in(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        AxisTables, Chain, Description, Interpolation, LinearAxis, PathModel, Range, RotaryAxis, Squareness,
        Table,
    };

    /// A processor without instructions for four numbers gives the same bits.
    #[test]
    fn bits_do_not_depend_on_the_processor() {
        for interpolation in [Interpolation::Linear, Interpolation::Monotone] {
            let mut linear = [0, 1, 2].map(|_| LinearAxis::perfect(Range { low: 0.0, high: 120.0 }));
            for (i, axis) in linear.iter_mut().enumerate() {
                let table = |function: usize| {
                    let nodes = [0.0, 20.0, 45.0, 90.0, 120.0];
                    let size = if function < 3 { 0.01 } else { 5e-5 };
                    let value = |k: usize| size * units::math::sin((7 * k + 3 * function + 5 * i) as f64);
                    Table::new(nodes.to_vec(), (0..nodes.len()).map(value).collect(), interpolation).ok()
                };
                axis.errors = AxisTables::new(&std::array::from_fn(table));
            }
            let model = RigidBody::new(Description {
                chain: Chain::parse("[w X Y b Z t]").unwrap(),
                linear,
                rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
                squareness: Squareness { ec0y_rad: 8e-4, eb0z_rad: -3e-4, ea0z_rad: 5e-4 },
            })
            .unwrap();
            let state = Command { tool_mm: Vector::new(3.0, -5.0, -120.0), ..Default::default() };
            let everywhere = model.everywhere(&state).unwrap();
            for k in 0..400 {
                let at = |lane: usize, axis: usize| {
                    60.0 + 55.0 * units::math::sin(f64::from(k) * 0.37 + 0.01 * lane as f64 + axis as f64)
                };
                let targets_mm = std::array::from_fn(|lane| std::array::from_fn(|axis| at(lane, axis)));
                let work = || NewtonTogether {
                    model: &model,
                    targets_mm: &targets_mm,
                    directions: &[[0; 3]; LANES],
                    state: &state,
                    everywhere: &everywhere,
                };
                let found = together(work());
                assert!(found.is_some());
                assert_eq!(found, work().with(pulp::Scalar256b));
            }
        }
    }
}
