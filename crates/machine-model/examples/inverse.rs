//! Where a crooked machine really goes, and what to tell it so that it goes where it should.
//!
//! X is too long by 20 µm over its travel and rolls by 40 µrad on the way; the tool hangs 120 mm below the point that was measured.
//!
//! ```console
//! $ cargo run -q -p machine-model --example inverse
//! told      X250.0000 Y100.0000 Z50.0000
//! goes      X250.0100 Y100.0014 Z50.0020
//! so tell   X249.9900 Y99.9986 Z49.9980
//! then goes X250.0000 Y100.0000 Z50.0000
//! ```

use machine_model::{
    AxisTables, Chain, Command, Description, Engine, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis,
    Squareness, Table, Vector,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let travel_mm = Range { low: 0.0, high: 500.0 };
    let mut linear = [(); 3].map(|()| LinearAxis::perfect(travel_mm));
    let table = |end| Table::new(vec![0.0, 500.0], vec![0.0, end], Interpolation::Linear);
    linear[0].errors = AxisTables::new(&[Some(table(0.020)?), None, None, Some(table(40e-6)?), None, None]);
    let machine = RigidBody::new(Description {
        chain: Chain::parse("[w X Y b Z t]")?,
        linear,
        rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness::default(),
    })?;

    let tool_mm = Vector::new(0.0, 0.0, -120.0);
    let told = Command { linear_mm: Vector::new(250.0, 100.0, 50.0), tool_mm, ..Default::default() };
    let goes = |linear_mm| machine.predict(&Command { linear_mm, ..told }).position_mm - tool_mm;
    let better = machine.solve(&told)?.linear_mm;
    let line = |name: &str, at: Vector| format!("{name:<9} X{:.4} Y{:.4} Z{:.4}\n", at.x, at.y, at.z);
    let text = line("told", told.linear_mm)
        + &line("goes", goes(told.linear_mm))
        + &line("so tell", better)
        + &line("then goes", goes(better));
    assert!((goes(better) - told.linear_mm).norm() < 1e-9);
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes())?;
    Ok(())
}
