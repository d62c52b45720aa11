//! Random machines for the tests.

#![allow(clippy::unwrap_used, reason = "helpers of tests may stop the test")]

use machine_model::{
    AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RotaryAxis, Squareness, Table,
    Vector,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Travel of X, Y, Z, mm.
pub(crate) const TRAVEL_MM: [f64; 3] = [400.0, 280.0, 200.0];

/// Seeded numbers.
pub(crate) struct Random(ChaCha8Rng);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }
    /// Uniform in -size..size.
    pub(crate) fn number(&mut self, size: f64) -> f64 {
        (self.0.next_u64() as f64 / u64::MAX as f64 * 2.0 - 1.0) * size
    }
    pub(crate) fn vector(&mut self, size: f64) -> Vector {
        Vector::from_fn(|_, _| self.number(size))
    }
}

pub(crate) fn command(linear_mm: [f64; 3], tool_mm: [f64; 3]) -> Command {
    Command { linear_mm: linear_mm.into(), tool_mm: tool_mm.into(), ..Default::default() }
}

/// A machine without errors.
pub(crate) fn perfect(chain: &str) -> Description {
    perfect_over(chain, TRAVEL_MM)
}

/// The same with these travels, mm.
pub(crate) fn perfect_over(chain: &str, travel_mm: [f64; 3]) -> Description {
    Description {
        chain: Chain::parse(chain).unwrap(),
        linear: travel_mm.map(|high| LinearAxis::perfect(Range { low: 0.0, high })),
        rotary: std::array::from_fn(|_| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness::default(),
    }
}

/// Errors like a worn machine's: 40 µm, 0.3 mrad, 1 mrad out of square, for `scale` 1.
pub(crate) fn machine(seed: u64, chain: &str, monotone: bool, scale: f64) -> Description {
    machine_over(seed, chain, monotone, scale, TRAVEL_MM)
}

/// The same with these travels, mm, each of 10 mm at least.
pub(crate) fn machine_over(
    seed: u64,
    chain: &str,
    monotone: bool,
    scale: f64,
    travel_mm: [f64; 3],
) -> Description {
    let mut random = Random::new(seed);
    let mut machine = perfect_over(chain, travel_mm);
    let interpolation = if monotone { Interpolation::Monotone } else { Interpolation::Linear };
    for (axis, high) in travel_mm.into_iter().enumerate() {
        let set = |random: &mut Random| {
            let mut nodes = vec![0.0];
            while nodes[nodes.len() - 1] < high {
                let next = nodes[nodes.len() - 1] + 17.5 + random.number(5.0);
                nodes.push(if next > high - 5.0 { high } else { next });
            }
            let functions: [Option<Table>; 6] = std::array::from_fn(|i| {
                let size = scale * if i < 3 { 0.04 } else { 3e-4 };
                let values = nodes.iter().map(|_| random.number(size)).collect();
                Some(Table::new(nodes.clone(), values, interpolation).unwrap())
            });
            AxisTables::new(&functions)
        };
        machine.linear[axis].errors = set(&mut random);
        if axis == 1 {
            machine.linear[axis].errors_negative = set(&mut random);
        }
        machine.linear[axis].measured_at_mm = random.vector(100.0);
        machine.linear[axis].measured_tool_mm = random.vector(50.0);
    }
    machine.linear[2].backlash_mm = scale * 0.01;
    machine.squareness = Squareness {
        ec0y_rad: random.number(scale * 1e-3),
        eb0z_rad: random.number(scale * 1e-3),
        ea0z_rad: random.number(scale * 1e-3),
    };
    machine
}
