//! Second-order finite rotations: Tables 3.7 to 3.15.

use machine_model::Vector;
use machine_model::finite_rotations::{PointErrors, Translation, Truncation, order_interval};

use crate::markdown::{fixed, table};
use crate::stan_s500::{published, tables};

fn tool() -> Vector {
    Vector::repeat(10.0)
}

fn at_rows(rows: [usize; 3]) -> PointErrors {
    let tables = tables();
    PointErrors {
        linear_mm: [0, 1, 2].map(|i| tables[i].linear_mm(rows[i])),
        angular_rad: [0, 1, 2].map(|i| tables[i].angular_rad(rows[i])),
    }
}

/// The "point" whose errors are the largest or smallest magnitude of every table column by itself.
fn extreme(pick: fn(f64, f64) -> f64) -> PointErrors {
    let tables = tables();
    let over = |i: usize, of: &dyn Fn(usize) -> Vector| {
        let rows = (0..tables[i].positions_mm().len()).map(|k| of(k).abs());
        rows.reduce(|a, b| a.zip_map(&b, pick)).expect("tables have rows")
    };
    PointErrors {
        linear_mm: [0, 1, 2].map(|i| over(i, &|k| tables[i].linear_mm(k))),
        angular_rad: [0, 1, 2].map(|i| over(i, &|k| tables[i].angular_rad(k))),
    }
}

/// One row: name, k, printed and computed |δ| (plus, minus, first order), the interval over all orders.
fn row(name: String, scale: f64, point: &PointErrors, printed: &[f64]) -> Vec<String> {
    let point = point.with_angles_scaled(scale);
    let kinds = [Truncation::AllPlus, Truncation::AllMinus, Truncation::FirstOrder];
    let ours = kinds.map(|kind| point.displacement_mm(&tool(), kind, Translation::Published).norm() * 1e3);
    let mut cells = vec![name, scale.to_string()];
    for (printed, ours) in printed.iter().zip(ours) {
        let mark = if (ours / printed - 1.0).abs() <= 1e-7 { "" } else { " **≠**" };
        cells.push(format!("{} / {}{mark}", fixed(*printed, 6), fixed(ours, 6)));
    }
    let interval = order_interval(&point, &tool(), Translation::Published);
    let inside = ours[..2].iter().all(|um| (interval.low_mm * 1e3..=interval.high_mm * 1e3).contains(um));
    let mark = if inside { "" } else { " (δ₊ or δ₋ outside)" };
    cells.push(format!("{} … {}{mark}", fixed(interval.low_mm * 1e3, 6), fixed(interval.high_mm * 1e3, 6)));
    cells
}

pub(super) fn section() -> String {
    let index = |r: &[f64]| [r[0] as usize, r[1] as usize, r[2] as usize];
    let name = |r: &[f64]| format!("{}/{}/{}", r[0], r[1], r[2]);
    let mut rows =
        vec![row("15/15/5".into(), 1.0, &at_rows([15, 15, 5]), &[54.789_011, 54.789_025, 54.789_039])];
    rows.extend(
        published("table_3_7_second_order").iter().map(|r| row(name(r), 1.0, &at_rows(index(r)), &r[6..])),
    );
    let scaled = published("tables_3_8_to_3_13_scaled_angles");
    rows.extend(scaled.iter().map(|r| row(name(&r[1..]), r[0], &at_rows(index(&r[1..])), &r[4..])));
    for (number, r) in published("tables_3_14_3_15_extreme_points").iter().enumerate() {
        let (name, point) = if number < 7 { ("max", extreme(f64::max)) } else { ("min", extreme(f64::min)) };
        rows.push(row(name.into(), r[1], &point, &r[2..]));
    }
    let head = ["table rows", "k", "δ₊ printed / ours, µm", "δ₋", "first order", "exact, all orders"];
    String::from(
        "## Finite rotations: Appendix A and Tables 3.7–3.15\n\n\
         |δ| in µm for a tool vector of 10 mm along each axis, angles multiplied by k. Computed from table rows as the publication does. Marked ≠ where the difference \
         exceeds 1e-7 of the value. The last column is the exact interval over all admissible orders of the nine rotations.\n\n\
         *Admissible orders.* A carriage turns with its own three rotations together, in whatever order; the carriages follow one another, in whatever \
         order: 6 orders within each of three triads times 6 orders of the triads, 6⁴ = 1296 compositions, multiplied exactly (Rodrigues vectors, no truncated series). \
         The publication bounds the number by 2·6⁴ = 2592, which counts the order of the first two triads twice. The printed pair δ₊, δ₋ is two sign patterns and \
         not the ends of that interval: in every row it lies inside and spans only part of it.\n\n",
    ) + &table(&head, &rows)
        + "\n**Defects**, shown by `cargo test -p machine-model published_finite_rotations`:\n\n\
           1. k = 100, rows 3/5/5, δ₋: printed 65.397367, a repetition of its neighbour; computed 65.463946.\n\
           2. Equation 3.5 has ε_xz·ε_zy among the products of B; the cross product k × j points along −i, and what is missing is ε_yz·ε_zx. All printed numbers contain \
           the slip (with the right product 3/5/5 at k = 1000 differs by 1e-3 of the value). `rotation_as_published` keeps it, the exact interval does not use it.\n\
           3. ρ adds the three translations *of one axis* into one direction, (δ_xx + δ_xy + δ_xz, …); the vector sum is (δ_xx + δ_yx + δ_zx, …). \
           `Translation::Published` keeps it for these tables, `Translation::Physical` is the sum.\n\
           4. The points max and min of Tables 3.14 and 3.15 take the magnitude of every column by itself: no place of the machine has these errors.\n\n"
}
