//! What the tests of several rooms share.

use std::array::from_fn;

use machine_model::{
    AxisTables, Chain, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness,
    Table, Vector,
};

use crate::Block;

/// A machine with errors of all kinds in 0 to 200 mm.
pub(crate) fn machine(monotone: bool) -> RigidBody {
    let interpolation = if monotone { Interpolation::Monotone } else { Interpolation::Linear };
    let mut linear = [0, 1, 2].map(|_| LinearAxis::perfect(Range { low: 0.0, high: 200.0 }));
    for (i, axis) in linear.iter_mut().enumerate() {
        let table = |function: usize| {
            let nodes = [0.0, 31.0, 64.0, 90.0, 131.0, 200.0];
            let size = if function < 3 { 0.004 } else { 2e-5 };
            let value = |k: usize| size * units::math::sin((7 * k + 3 * function + 5 * i) as f64);
            Table::new(nodes.to_vec(), (0..nodes.len()).map(value).collect(), interpolation).ok()
        };
        axis.errors = AxisTables::new(&from_fn(table));
    }
    let description = Description {
        chain: Chain::parse("[w X Y b Z t]").unwrap(),
        linear,
        rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness { ec0y_rad: 8e-4, eb0z_rad: -3e-4, ea0z_rad: 5e-4 },
    };
    RigidBody::new(description).unwrap()
}

/// A block in millimetres with steps of 1 µm and without words.
pub(crate) fn block(tool_mm: [f64; 3]) -> Block {
    Block {
        tool_mm,
        arc_radius_tolerance_mm: 0.01,
        retreats: toolpath::PeckRetreats { clearance_mm: 0.0, chip_mm: 0.0 },
        ..Block::default()
    }
}
