//! What is printed.

use std::fmt::Write;

use error_map::Statistics;
use error_map::placement::Freedom;
use machine_model::Vector;

use super::deformation;
use super::second_order::SecondOrder;
use super::study::{Kind, Part, Proof, Study, ZeroPoint};
use crate::figures::{fixed, printable, triple, um};

/// The page.
pub(super) fn page(study: &Study) -> String {
    let mut out = head(study);
    figures(study, &mut out);
    deformations(study, &mut out);
    diagonals(study, &mut out);
    for part in &study.parts {
        zero_points(study, part, &mut out);
    }
    places(study, &mut out);
    if let Some(found) = &study.second_order {
        second_order(found, &mut out);
    }
    out
}

fn head(study: &Study) -> String {
    let grid = study.map.grid();
    let axes: Vec<String> = ["X", "Y", "Z"]
        .iter()
        .zip(grid.axes())
        .map(|(name, nodes)| {
            let range = nodes.range_mm();
            format!("{name} {} to {} mm ({})", range.low, range.high, nodes.places_mm().len())
        })
        .collect();
    format!(
        "{}: {} nodes, {}\nengine {}, tool vector {}, rotary axes {}\n",
        printable(&study.machine),
        grid.len(),
        axes.join(", "),
        study.engine,
        triple(&study.tool_mm, 3),
        triple(&study.rotary_rad.map(f64::to_degrees), 3),
    )
}

/// What a field does to small boxes of commands.
fn deformations(study: &Study, out: &mut String) {
    let Some(figures) = deformation::figures(&study.cells) else { return };
    let _ = writeln!(
        out,
        "\nof {:<27} {:>11} {:>11} {:>11}",
        format!("{} cells", study.cells.len()),
        "least",
        "largest",
        "rms"
    );
    for (which, (range, rms)) in figures.iter().enumerate() {
        let name = format!("{}, {}", deformation::WORDS[which], deformation::unit(which));
        let numbers = [range.low, range.high, *rms].map(|v| fixed(v, 2));
        let _ = writeln!(out, "  {name:<28} {:>11} {:>11} {:>11}", numbers[0], numbers[1], numbers[2]);
    }
}

fn figures(study: &Study, out: &mut String) {
    let _ = writeln!(
        out,
        "\nvolumetric error, um      nodes  range X  range Y  range Z      rms     95 %      max   <= {} um",
        fixed(study.within_mm * 1e3, 0)
    );
    for part in &study.parts {
        let f = &part.figures;
        let range = |axis: usize| um(f.component_mm[axis].high - f.component_mm[axis].low);
        let _ = writeln!(
            out,
            "  {:<22} {:>7} {:>8} {:>8} {:>8} {}",
            printable(&part.name),
            f.nodes,
            range(0),
            range(1),
            range(2),
            row(f)
        );
    }
}

fn diagonals(study: &Study, out: &mut String) {
    let _ = writeln!(
        out,
        "\nbody diagonals (ISO 230-6), um      systematic E     mean M  reversal B  length error"
    );
    for diagonal in &study.diagonals {
        let signs: String = diagonal.signs.iter().map(|s| if *s > 0 { '+' } else { '-' }).collect();
        let _ = writeln!(
            out,
            "  X Y Z {signs}                         {:>12} {:>10} {:>11} {:>13}",
            um(diagonal.systematic_mm),
            um(diagonal.mean_mm),
            um(diagonal.reversal_mm),
            um(diagonal.length_error_mm)
        );
    }
}

fn zero_points(study: &Study, part: &Part, out: &mut String) {
    let _ = writeln!(
        out,
        "\nzero point, {:<16} add to work offset, mm          rms     95 %      max   <= {} um",
        printable(&part.name),
        fixed(study.within_mm * 1e3, 0)
    );
    let _ = writeln!(out, "  {:<18} {:>29}  {}", "as it is", "", row(&part.figures));
    for zero in &part.zero_points {
        let _ = writeln!(
            out,
            "  {:<18} {:>29}  {}",
            zero.kind.name(),
            triple(&zero.to_enter_mm(study), study.decimals()),
            row(&zero.figures)
        );
    }
    for zero in &part.zero_points {
        let _ = writeln!(out, "  {}", proof(zero, part));
    }
    let Some(median) = part.zero_points.iter().find(|zero| zero.kind == Kind::Median) else { return };
    let add = median.to_enter_mm(study);
    let _ = writeln!(
        out,
        "  to enter the geometric median: change each work offset by X{:+.3} Y{:+.3} Z{:+.3}",
        add.x, add.y, add.z
    );
    for (name, offset) in &study.work_offsets {
        let from = Vector::from(*offset);
        let _ = writeln!(
            out,
            "    {name}: {} becomes {}",
            triple(&from, study.decimals()),
            triple(&(from + add), study.decimals())
        );
    }
}

pub(super) fn proof(zero: &ZeroPoint, part: &Part) -> String {
    let n = part.figures.nodes as f64;
    let name = zero.kind.name();
    match &zero.proof {
        Proof::Node { place_mm, sum_mm, examined } => format!(
            "{name}: at {}; mean distance {} um; {examined} of {} sums computed, the others are proven larger",
            triple(place_mm, 3),
            um(sum_mm / n),
            part.figures.nodes
        ),
        Proof::Sum { sum_mm, lower_bound_mm } => {
            let gap = (sum_mm - lower_bound_mm) / sum_mm.max(f64::MIN_POSITIVE);
            format!(
                "{name}: mean distance {} um; no shift has a sum smaller by more than {gap:.0e} of it",
                um(sum_mm / n)
            )
        }
        Proof::Radius { radius_mm, support } => {
            format!(
                "{name}: no shift has a smaller largest error than {} um ({support} nodes hold it)",
                um(*radius_mm)
            )
        }
        Proof::Count { within, at_most } if within == at_most => {
            format!("{name}: {within} nodes within, and no shift has more")
        }
        Proof::Count { within, at_most } => format!(
            "{name}: {within} nodes within; no shift has more than {at_most} ({} %)",
            percent(*at_most as f64 / n)
        ),
    }
}

fn places(study: &Study, out: &mut String) {
    if study.places.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "\nwhere to clamp, if the set-up can       box, mm                                       rms     95 %      max   <= {} um",
        fixed(study.within_mm * 1e3, 0)
    );
    for (freedom, place) in &study.places {
        let span: Vec<String> = ["X", "Y", "Z"]
            .iter()
            .zip(&place.box_mm)
            .map(|(axis, range)| format!("{axis} {}..{}", fixed(range.low, 1), fixed(range.high, 1)))
            .collect();
        let name = freedom_name(*freedom);
        let _ = writeln!(out, "  {name:<33} {:<40}  {}", span.join(" "), row(&place.fit.after));
        let turn = place.fit.rotation_rad * 1e6;
        let _ = writeln!(
            out,
            "    before {} um rms; add {} mm to the work offset, turn by {} urad about {}",
            um(place.fit.before.rms_mm),
            triple(&-place.fit.shift_mm, study.decimals()),
            triple(&-turn, 1),
            triple(&place.fit.centre_mm, 1)
        );
    }
}

fn second_order(found: &SecondOrder, out: &mut String) {
    let _ = writeln!(out, "\nsecond order of rotations, {} nodes", found.nodes);
    for line in second_order_lines(found) {
        let _ = writeln!(out, "  {line}");
    }
}

/// What products of errors do, in three sentences.
pub(super) fn second_order_lines(found: &SecondOrder) -> [String; 3] {
    let limit = fixed(found.limit_mm * 1e3, 0);
    [
        format!(
            "whole chain: exact product and first-order sum differ by at most {} um, at {}",
            fixed(found.chain_difference_mm * 1e3, 6),
            triple(&found.chain_place_mm, 3)
        ),
        match &found.threshold {
            Some(threshold) => format!(
                "products of errors reach {limit} um where all angles are k = {} times as large (largest {} urad)",
                fixed(threshold.scale, 2),
                fixed(threshold.angle_rad * 1e6, 1)
            ),
            None => format!("products of errors stay below {limit} um for angles up to 0.1 rad"),
        },
        format!(
            "nine rotations of the tool vector {} in any order, at {}: first order {} um, all plus {}, all minus {}, exact {} to {} ({} orders)",
            triple(&found.tool_mm, 3),
            triple(&found.place_mm, 3),
            fixed(found.first_mm * 1e3, 6),
            fixed(found.plus_mm * 1e3, 6),
            fixed(found.minus_mm * 1e3, 6),
            fixed(found.interval.low_mm * 1e3, 6),
            fixed(found.interval.high_mm * 1e3, 6),
            found.interval.orders
        ),
    ]
}

impl ZeroPoint {
    /// What to add to a work offset: minus the error, in whole output steps. Equation (41).
    pub(super) fn to_enter_mm(&self, study: &Study) -> Vector {
        Vector::from_fn(|axis, _| {
            let step = study.resolution_mm[axis];
            // A negative zero would be printed as one.
            -(self.shift_mm[axis] / step).round() * step + 0.0
        })
    }
}

impl Study {
    /// Decimals that show the finest output step.
    pub(super) fn decimals(&self) -> usize {
        let finest = self.resolution_mm.iter().copied().fold(f64::INFINITY, f64::min);
        (3..6).find(|d| finest * 10f64.powi(*d) >= 1.0 - 1e-9).map_or(6, |d| d as usize)
    }
}

/// What the set-up can do, in words.
pub(super) fn freedom_name(freedom: Freedom) -> &'static str {
    match freedom {
        Freedom::Shift => "shift the zero point",
        Freedom::ShiftAndTurn => "shift, and turn about Z",
        Freedom::Rigid => "shift, and turn about X, Y and Z",
    }
}

/// RMS, 95 %, largest, share within.
fn row(figures: &Statistics) -> String {
    format!(
        "{:>8} {:>8} {:>8} {:>8} %",
        um(figures.rms_mm),
        um(figures.p95_mm),
        um(figures.magnitude_mm.high),
        percent(figures.share_within())
    )
}

fn percent(share: f64) -> String {
    fixed(share * 100.0, 2)
}
