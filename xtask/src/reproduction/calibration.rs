//! What `vpost calibrate` makes of published measurements.

use calibration::functions::{FunctionReading, runs};
use calibration::iso230_2::evaluate;
use calibration::tracker::{Frame, Verdict, calibrate};
use calibration::{MeanTraverse, Reading};
use machine_model::Vector;

use crate::markdown::{fixed, table, vector};
use crate::stan_s500::traverses;

/// The section.
pub(super) fn section() -> String {
    let mut text = String::from(
        "## Calibration\n\n`vpost calibrate tracker` on the three cubes; G and r01 of interval 1, signed. A chord's direction is known to ± u; carried to the far corner of the cube it \
         is compared with the deviation found there. No repeats are published, so u comes from the roughness of the lines and is an upper bound.\n\n",
    );
    let mut rows = Vec::new();
    for cube in [48, 240, 315] {
        let means = traverses(cube).map(|t| {
            let readings: Vec<Reading> = t
                .nodes_mm
                .iter()
                .zip(&t.measured_mm)
                .map(|(q, measured)| {
                    let mut commanded_mm = Vector::from(t.start_mm);
                    commanded_mm[t.axis] = *q;
                    Reading { commanded_mm, measured_mm: Vector::from(*measured), direction: 0 }
                })
                .collect();
            MeanTraverse::new(t.axis, &readings, None).expect("shipped traverses are traverses")
        });
        let found = calibrate(means, Frame::AsMeasured).expect("shipped traverses belong together");
        let (g, r01) = (found.directions(1).expect("interval 1"), found.offset_mm(1).expect("interval 1"));
        let far = found.far_corner;
        let verdict = match far.verdict() {
            Verdict::Sound => "sound",
            Verdict::Doubtful => "accepted with a warning",
            Verdict::Unfit => "**refused**",
        };
        rows.push(vec![
            format!("{cube} mm"),
            (0..3).map(|k| vector(&g.column(k).into_owned(), 7)).collect::<Vec<_>>().join("<br>"),
            vector(&r01, 6),
            fixed(far.direction_u95_rad * 1e6, 0),
            fixed(far.chord_u95_mm * 1e3, 0),
            fixed(far.deviation_mm * 1e3, 0),
            verdict.to_owned(),
        ]);
    }
    let head = [
        "cube",
        "G, columns X, Y, Z",
        "r01, mm",
        "u of a chord, µrad",
        "at the corner, µm",
        "deviation there, µm",
        "verdict",
    ];
    text += &table(&head, &rows);
    text += "\nThe cosines of all intervals are those of the table above; `--as-published` shows them without signs.\n\n";
    text += &iso230_2();
    text
}

/// Public runs with printed results.
fn iso230_2() -> String {
    let printed: [(&str, &str, [f64; 12]); 3] = [
        (
            "psi_2023",
            "paulscherrerinstitute/ecmccfg, 2023-12-08",
            [
                0.0122, 0.0054, 0.05033, 0.0629, 0.0629, 0.0246, 0.033, 0.0246, 0.0277, 0.06428, 0.08881,
                0.08881,
            ],
        ),
        (
            "psi_2021",
            "paulscherrerinstitute/ecmccfg, 2021-11-10",
            [46.49, 8.29, 7.51, 230.36, 230.36, 54.05, 57.27, 54.05, 36.0, 58.53, 230.36, 230.36],
        ),
        (
            "muts_2022",
            "anderssandstrom/ecmc_target_muts_logger, 2022-10-20",
            [51.24, 35.44, 125.29, 237.15, 237.15, 28.06, 26.46, 28.06, 22.26, 141.39, 243.37, 243.37],
        ),
    ];
    let names = ["B", "B̄", "R↑", "R↓", "R", "E↑", "E↓", "E", "M", "A↑", "A↓", "A"];
    let mut rows: Vec<Vec<String>> = names.iter().map(|name| vec![(*name).to_owned()]).collect();
    for (name, _, results) in &printed {
        let found = evaluate(&runs(&readings(name)).expect("complete runs"), 0.0).expect("complete runs");
        let (up, down) = (found.positive.expect("up"), found.negative.expect("down"));
        let ours = [
            found.reversal.expect("both").value,
            found.mean_reversal.expect("both"),
            up.repeatability.value,
            down.repeatability.value,
            found.repeatability.value,
            up.systematic.value,
            down.systematic.value,
            found.systematic.value,
            found.mean_range.value,
            up.accuracy.value,
            down.accuracy.value,
            found.accuracy.value,
        ];
        let decimals = if results[0] < 1.0 { 5 } else { 2 };
        for ((row, ours), printed) in rows.iter_mut().zip(ours).zip(results) {
            // The report's sums were rounded on the way.
            let same = (ours * 1e3 - printed).abs() <= 2.0 * if decimals == 5 { 1e-5 } else { 1e-2 };
            row.push(format!(
                "{} / {}{}",
                fixed(*printed, decimals),
                fixed(ours * 1e3, decimals),
                if same { "" } else { " **≠**" }
            ));
        }
    }
    let head: Vec<String> = std::iter::once("µm".to_owned())
        .chain(printed.iter().map(|p| format!("`{}` printed / ours", p.0)))
        .collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let sources: Vec<String> = printed.iter().map(|p| format!("`{}`: {}", p.0, p.1)).collect();
    format!(
        "## ISO 230-2\n\nReadings and results that others published (`samples/calibration`, reports of five runs at five targets; {}).\n\n{}\n\
         Two of their lines follow other formulas than the standard's: E is printed as E↑, R as the larger of R↑ and R↓. The standard's E spans both directions, and its R is the largest \
         of `2s↑ + 2s↓ + |B|`, R↑ and R↓ at a target. `cargo test -p calibration --test whole iso230_2::` holds all twelve against exact fractions.\n\n",
        sources.join("; "),
        table(&head, &rows)
    )
}

fn readings(name: &str) -> Vec<FunctionReading> {
    let path = format!("{}/../samples/calibration/iso230_2_{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a sample");
    text.lines()
        .skip(2)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |k: usize| cells[k].parse::<f64>().expect("a number");
            FunctionReading {
                run: cells[0].to_owned(),
                position_mm: number(2),
                value: number(3) * 1e-3,
                direction: number(1) as i8,
            }
        })
        .collect()
}
