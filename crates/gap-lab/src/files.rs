//! The files of a case, as text.

use std::fmt::Write;

use crate::AXES;
use crate::design::Layout;
use crate::machine::Machine;
use crate::row::Sight;
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

/// Text of a measurement. `read_mm` is the measured tip at every row, `prefix` names its runs.
pub(crate) fn measurement(
    machine: &Machine,
    layout: &Layout,
    read_mm: &[[f64; 3]],
    observation: Observation,
    declared_um: Option<f64>,
    prefix: &str,
) -> String {
    let shows = layout.columns;
    let rotary = machine.centre.is_some();
    let ball = layout.rows.iter().any(|r| matches!(r.sight, Sight::Ball(_)));
    // A column that nobody measured is not there at all.
    let measured =
        [0, 1, 2].map(|i| layout.rows.iter().any(|r| matches!(r.sight, Sight::Components(mask) if mask[i])));
    let mut header = vec!["run", "x_mm", "y_mm", "z_mm"];
    if rotary {
        header.push("c_deg");
    }
    match observation {
        _ if ball => header.extend(["length_mm", "bx_mm", "by_mm", "bz_mm"]),
        Observation::Displacement => {
            let names = ["dx_um", "dy_um", "dz_um"].into_iter().zip(measured);
            header.extend(names.filter(|(_, measured)| *measured).map(|(name, _)| name));
        }
        Observation::Position => header.extend(["xm_mm", "ym_mm", "zm_mm"]),
        Observation::Magnitude => header.push("d_um"),
    }
    if shows.approach {
        header.extend(["dir_x", "dir_y", "dir_z"]);
    }
    if shows.feed {
        header.push("feed_mm_min");
    }
    if shows.tool {
        header.extend(["tool_x_mm", "tool_y_mm", "tool_z_mm"]);
    }
    for (shown, name) in [(shows.load, "load_kg"), (shows.time, "time_s"), (shows.temperature, "temp_c")] {
        if shown {
            header.push(name);
        }
    }
    header.push("repeat");
    if declared_um.is_some() {
        header.push("u_um");
    }
    let mut text = header.join(",");
    text.push('\n');
    for (row, read) in layout.rows.iter().zip(read_mm) {
        let mut words = vec![format!("{prefix}{}", row.run)];
        words.extend(row.command.map(|v| format!("{v:.4}")));
        if rotary {
            words.push(format!("{:.3}", row.turn.to_degrees()));
        }
        let nominal = machine.nominal(row);
        let off = [0, 1, 2].map(|i| (read[i] - nominal[i]) * 1e3);
        match (row.sight, observation) {
            (Sight::Ball(centre), _) => {
                let square: f64 = (0..3).map(|i| (read[i] - centre[i]) * (read[i] - centre[i])).sum();
                words.push(format!("{:.6}", square.sqrt()));
                words.extend(centre.map(|v| format!("{v:.4}")));
            }
            (Sight::Components(mask), Observation::Displacement) => {
                let shown = (0..3).filter(|i| measured[*i]);
                words.extend(shown.map(|i| if mask[i] { format!("{:.3}", off[i]) } else { String::new() }));
            }
            (Sight::Components(_), Observation::Position) => words.extend(read.map(|v| format!("{v:.6}"))),
            (Sight::Components(_), Observation::Magnitude) => {
                words.push(format!("{:.3}", (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]).sqrt()));
            }
        }
        if shows.approach {
            words.extend(row.approach.map(|v| format!("{v:.0}")));
        }
        if shows.feed {
            words.push(format!("{:.0}", row.feed));
        }
        if shows.tool {
            words.extend(row.tool.map(|v| format!("{v:.1}")));
        }
        for (shown, value) in
            [(shows.load, row.load), (shows.time, row.time), (shows.temperature, row.temperature)]
        {
            if shown {
                words.push(format!("{value:.2}"));
            }
        }
        words.push(row.repeat.to_string());
        if let Some(u) = declared_um {
            words.push(format!("{u:.3}"));
        }
        text.push_str(&words.join(","));
        text.push('\n');
    }
    text
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
