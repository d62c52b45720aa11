//! The files of a case, as text.

use std::fmt::Write;

use crate::AXES;
use crate::design::{Columns, Layout};
use crate::machine::Machine;
use crate::row::{Row, Sight};
use crate::truth::Truth;

/// Which columns carry the reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observation {
    /// `dx_um dy_um dz_um`.
    Displacement,
    /// `xm_mm ym_mm zm_mm`; the tool vector is zero then.
    Position,
    /// `d_um`.
    Magnitude,
}

/// Text of the profile: what the machine is believed to be.
pub(crate) fn profile(machine: &Machine, name: &str, tool: [f64; 3]) -> String {
    let mut text = String::new();
    let mut line = |words: std::fmt::Arguments<'_>| {
        text.write_fmt(words).expect("writing to a string cannot fail");
        text.push('\n');
    };
    line(format_args!("format  = 1"));
    line(format_args!("name    = \"{name}\""));
    line(format_args!("control = \"fanuc\""));
    line(format_args!("chain   = \"{}\"", machine.chain_text()));
    line(format_args!(
        "calibrated = {{ date = \"2026-01-15\", temperature_c = 20.0, instrument = \"simulated\" }}"
    ));
    for (axis, letter) in AXES.iter().enumerate() {
        let [low, high] = machine.travel[axis];
        line(format_args!("\n[axis.{letter}]"));
        line(format_args!("travel_mm     = [{low}, {high}]"));
        line(format_args!("resolution_mm = 0.001"));
        if machine.tables[axis].is_some() {
            line(format_args!("errors        = \"{}\"", table_name(axis)));
        }
    }
    if machine.squareness_urad.iter().any(|v| *v != 0.0) {
        let [ec0y, eb0z, ea0z] = machine.squareness_urad;
        line(format_args!("\n[squareness]"));
        line(format_args!("EC0Y_urad = {ec0y:.1}\nEB0Z_urad = {eb0z:.1}\nEA0Z_urad = {ea0z:.1}"));
    }
    if let Some([x, y]) = machine.centre {
        line(format_args!("\n[rotary.C]"));
        line(format_args!("centre_mm = [{x:.1}, {y:.1}, 0.0]"));
    }
    line(format_args!("\n[tool]"));
    line(format_args!("default_mm = [{:.1}, {:.1}, {:.1}]", tool[0], tool[1], tool[2]));
    text
}

/// Name of the file of an axis' table.
pub(crate) fn table_name(axis: usize) -> String {
    format!("axis_{}.csv", AXES[axis].to_ascii_lowercase())
}

/// Text of the tables that the profile refers to, with their names.
pub(crate) fn tables(machine: &Machine) -> Vec<(String, String)> {
    let mut files = Vec::new();
    for (axis, letter) in AXES.iter().enumerate() {
        let Some(table) = &machine.tables[axis] else { continue };
        let mut text = format!(
            "position_mm,EX{letter}_um,EY{letter}_um,EZ{letter}_um,EA{letter}_urad,EB{letter}_urad,EC{letter}_urad\n"
        );
        for (node, values) in table.nodes.iter().zip(&table.values) {
            let words: Vec<String> = values.iter().map(|v| format!("{v:.3}")).collect();
            text.push_str(&format!("{node:.1},{}\n", words.join(",")));
        }
        files.push((table_name(axis), text));
    }
    files
}

/// A column of a measurement: its name, and its cell of a row and the tip that was read there, mm.
type Column<'a> = (&'static str, Box<dyn Fn(&Row, &[f64; 3]) -> String + 'a>);

fn column<'a>(name: &'static str, cell: impl Fn(&Row, &[f64; 3]) -> String + 'a) -> Column<'a> {
    (name, Box::new(cell))
}

/// Three columns of one kind, by the axis.
fn three<'a>(
    names: [&'static str; 3],
    cell: impl Fn(&Row, &[f64; 3], usize) -> String + Copy + 'a,
) -> [Column<'a>; 3] {
    [0, 1, 2].map(|axis| column(names[axis], move |row, read| cell(row, read, axis)))
}

/// Text of a measurement. `read_mm` is the measured tip at every row, `prefix` names its runs.
pub(crate) fn measurement(
    machine: &Machine,
    layout: &Layout,
    read_mm: &[[f64; 3]],
    observation: Observation,
    declared_um: Option<f64>,
    prefix: &str,
) -> String {
    let mut columns = vec![column("run", |row, _| format!("{prefix}{}", row.run))];
    columns.extend(three(["x_mm", "y_mm", "z_mm"], |row, _, axis| format!("{:.4}", row.command[axis])));
    if machine.centre.is_some() {
        columns.push(column("c_deg", |row, _| format!("{:.3}", row.turn.to_degrees())));
    }
    columns.extend(readings(machine, layout, observation));
    columns.extend(circumstances(layout.columns));
    columns.push(column("repeat", |row, _| row.repeat.to_string()));
    if let Some(u) = declared_um {
        columns.push(column("u_um", move |_, _| format!("{u:.3}")));
    }
    let mut text = columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",");
    text.push('\n');
    for (row, read) in layout.rows.iter().zip(read_mm) {
        let cells: Vec<String> = columns.iter().map(|(_, cell)| cell(row, read)).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// What was read. A column that nobody measured is not there at all.
fn readings<'a>(machine: &'a Machine, layout: &Layout, observation: Observation) -> Vec<Column<'a>> {
    let off_um = |row: &Row, read: &[f64; 3]| {
        let nominal = machine.nominal(row);
        [0, 1, 2].map(|i| (read[i] - nominal[i]) * 1e3)
    };
    let centre = |row: &Row| match row.sight {
        Sight::Ball(centre) => centre,
        Sight::Components(_) => [0.0; 3],
    };
    if layout.rows.iter().any(|row| matches!(row.sight, Sight::Ball(_))) {
        let length = column("length_mm", move |row, read| {
            let centre = centre(row);
            let square: f64 = (0..3).map(|i| (read[i] - centre[i]) * (read[i] - centre[i])).sum();
            format!("{:.6}", square.sqrt())
        });
        let station =
            three(["bx_mm", "by_mm", "bz_mm"], move |row, _, axis| format!("{:.4}", centre(row)[axis]));
        return [length].into_iter().chain(station).collect();
    }
    match observation {
        Observation::Displacement => {
            let sees = |row: &Row, axis: usize| matches!(row.sight, Sight::Components(mask) if mask[axis]);
            let cell = move |row: &Row, read: &[f64; 3], axis: usize| {
                if sees(row, axis) { format!("{:.3}", off_um(row, read)[axis]) } else { String::new() }
            };
            let all = three(["dx_um", "dy_um", "dz_um"], cell).into_iter().enumerate();
            all.filter(|(axis, _)| layout.rows.iter().any(|row| sees(row, *axis)))
                .map(|(_, own)| own)
                .collect()
        }
        Observation::Position => {
            three(["xm_mm", "ym_mm", "zm_mm"], |_, read, axis| format!("{:.6}", read[axis])).into()
        }
        Observation::Magnitude => vec![column("d_um", move |row, read| {
            let off = off_um(row, read);
            format!("{:.3}", (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]).sqrt())
        })],
    }
}

/// What else is known of a row.
fn circumstances(shows: Columns) -> Vec<Column<'static>> {
    let mut columns = Vec::new();
    if shows.approach {
        columns
            .extend(three(["dir_x", "dir_y", "dir_z"], |row, _, axis| format!("{:.0}", row.approach[axis])));
    }
    if shows.feed {
        columns.push(column("feed_mm_min", |row, _| format!("{:.0}", row.feed)));
    }
    if shows.tool {
        let names = ["tool_x_mm", "tool_y_mm", "tool_z_mm"];
        columns.extend(three(names, |row, _, axis| format!("{:.1}", row.tool[axis])));
    }
    if shows.load {
        columns.push(column("load_kg", |row, _| format!("{:.2}", row.load)));
    }
    if shows.time {
        columns.push(column("time_s", |row, _| format!("{:.2}", row.time)));
    }
    if shows.temperature {
        columns.push(column("temp_c", |row, _| format!("{:.2}", row.temperature)));
    }
    columns
}

/// Text of the truth, JSON.
pub(crate) fn truth(id: &str, kind: &str, plan: &str, noise: &str, truth: &Truth) -> String {
    let effects: Vec<String> = truth
        .effects
        .iter()
        .map(|e| {
            let coefficient = match e.coefficient {
                Some((unit, value)) => {
                    format!(", \"coefficient\": {{ \"unit\": \"{unit}\", \"value\": {value:.6} }}")
                }
                None => String::new(),
            };
            let rivals: Vec<String> = e.rivals.iter().map(|(id, c)| format!("[\"{id}\", {c:.4}]")).collect();
            format!(
                "    {{ \"effect\": \"{}\", \"snr\": {:.4}{coefficient}, \"rivals\": [{}] }}",
                e.id,
                e.snr,
                rivals.join(", ")
            )
        })
        .collect();
    let [x, y, z] = truth.components;
    format!(
        "{{ \"schema\": \"gap-lab.truth/1\", \"id\": \"{id}\", \"kind\": \"{kind}\", \"plan\": \"{plan}\", \
         \"noise\": \"{noise}\",\n  \"sigma_um\": {:.4}, \"run_sigma_um\": {:.4}, \"identifiable\": {}, \
         \"expected_sigma\": {:.3},\n  \"components\": [{x:.4}, {y:.4}, {z:.4}], \"holdout_before_um\": {:.4}, \
         \"holdout_noise_um\": {:.4},\n  \"effects\": [\n{}\n  ] }}\n",
        truth.sigma_um,
        truth.run_sigma_um,
        truth.identifiable,
        truth.expected_sigma,
        truth.holdout_before_um,
        truth.holdout_noise_um,
        effects.join(",\n")
    )
}
