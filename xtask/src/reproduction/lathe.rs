//! Spirin 2012: the printed matrices of a lathe's chain beside rotations.

use std::fmt::Write;

use nalgebra::Matrix3;
use units::math;

/// Angles at which the matrices are compared, rad: φ, γ, ω.
const ANGLES_RAD: [f64; 3] = [0.7, 0.2, 0.3];

/// The section.
pub(super) fn section() -> String {
    let [(sp, cp), (sg, cg), (so, co)] = ANGLES_RAD.map(math::sin_cos);
    let (s, c) = math::sin_cos(ANGLES_RAD[0] + ANGLES_RAD[1]);
    let turn = Matrix3::new(cp, sp, 0.0, -sp, cp, 0.0, 0.0, 0.0, 1.0);
    let tool = Matrix3::new(cg, sg, 0.0, -sg, cg, 0.0, 0.0, 0.0, 1.0);
    let lean = Matrix3::new(co, 0.0, so, 0.0, 1.0, 0.0, -so, 0.0, co);
    let [first, second] = [cp * sg - sp * sg, cp * sg + sp * cg];
    let rows = [
        (
            "Φ0⁻¹ Φ2⁻¹ of the inverse problem",
            "(cos φ, −sin φ; −sin φ, cos φ)",
            "(cos φ, sin φ; −sin φ, cos φ)",
            Matrix3::new(cp, -sp, 0.0, -sp, cp, 0.0, 0.0, 0.0, 1.0),
            turn,
        ),
        (
            "Φ_Cω",
            "(cos ω, 0, sin ω; −sin ω, 1, cos ω; 0, 0, 1)",
            "(cos ω, 0, sin ω; 0, 1, 0; −sin ω, 0, cos ω)",
            Matrix3::new(co, 0.0, so, -so, 1.0, co, 0.0, 0.0, 1.0),
            lean,
        ),
        (
            "the product with Φ_Cγ, first element",
            "cos φ sin γ − sin φ sin γ",
            "cos φ cos γ − sin φ sin γ",
            Matrix3::new(first, second, 0.0, -sp * cg - cp * sg, cp * cg - sp * sg, 0.0, 0.0, 0.0, 1.0),
            turn * tool,
        ),
        (
            "the product with Φ_Cω, second row, third element",
            "−cos ω sin(φ+γ)",
            "−sin ω sin(φ+γ)",
            Matrix3::new(co * c, s, so * c, -co * s, c, -co * s, -so, 0.0, co),
            turn * tool * lean,
        ),
    ];
    let mut out = String::from(
        "\n## A lathe's chain\n\n\
         Spirin 2012 multiplies workpiece, spindle, carriage and tool. **Defect.** Four of the printed matrices are no \
         rotations: ‖MᵀM − 1‖ at φ = 0.7, γ = 0.2, ω = 0.3 rad. `turning` is built of proper rotations, equations (71) to (73); \
         `cargo test -p turning spirins_printed_matrices` holds both columns.\n\n\
         | matrix | printed | right | printed: away from a rotation | right |\n| --- | --- | --- | --- | --- |\n",
    );
    let away = |m: &Matrix3<f64>| (m.transpose() * m - Matrix3::identity()).norm();
    for (name, printed, right, wrong, sound) in rows {
        writeln!(out, "| {name} | {printed} | {right} | {:.3} | {:.3} |", away(&wrong), away(&sound))
            .expect("a string takes all");
    }
    out.push_str(
        "\nThe scalar equations have slips of their own: `X_C = X0 cos φ − X0 sin φ + A` has X0 for Y0, and `X0 = … − A sin φ` \
         has sin for cos.\n",
    );
    // Measured by an outside judge, which no build runs.
    out.push_str(include_str!("shaft.md"));
    out
}
