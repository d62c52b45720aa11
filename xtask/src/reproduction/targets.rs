//! The ten measured targets of Table 2.13 against what the engines predict.

use machine_model::engines::build;
use machine_model::{EngineId, PathModel, Squareness, Vector};

use crate::engines::at;
use crate::markdown::{fixed, table, vector};
use crate::stan_s500::{
    inputs, published, rigid_body, squareness, table_slopes, tables, traverse_slopes, traverses,
};

/// A prediction of the error vector in the tracker's frame, mm.
struct Forecast {
    name: String,
    errors: Vec<Vector>,
}

fn forecasts(targets: &[Vector]) -> Vec<Forecast> {
    let traverses = traverses(315);
    let tables = tables();
    let skew = squareness(&tables, &traverses);
    let (seen, held) = (traverse_slopes(&traverses), table_slopes(&tables));
    // The tracker's frame against the model's, whose X axis runs along X but for what the tables say.
    let left = |i: usize, c: usize| seen[i][c] - held[i][c];
    let frame = Vector::new(left(1, 2), -left(0, 2), left(0, 1));
    let alone = rigid_body(&tables, Squareness::default());
    let square = rigid_body(&tables, skew);
    let rigid = |name: &str, error: &dyn Fn(&Vector) -> Vector| Forecast {
        name: name.to_owned(),
        errors: targets.iter().map(error).collect(),
    };
    // The tracker was zeroed at the origin: errors count from there.
    let origin =
        |model: &dyn PathModel, q: &Vector| model.error_mm(&at(*q)) - model.error_mm(&at(Vector::zeros()));
    let scale = |q: &Vector| Vector::from_fn(|i, _| left(i, i) * q[i]);
    let mut all = vec![
        rigid("rigid-body, interferometer tables alone", &|q| alone.error_mm(&at(*q))),
        rigid("rigid-body, interferometer tables alone, errors counted from the origin", &|q| {
            origin(&alone, q)
        }),
        rigid("rigid-body + squareness", &|q| square.error_mm(&at(*q))),
        rigid("rigid-body + squareness, in the tracker's frame", &|q| origin(&square, q) + frame.cross(q)),
        rigid("rigid-body + squareness + scale, in the tracker's frame", &|q| {
            origin(&square, q) + frame.cross(q) + scale(q)
        }),
    ];
    for id in [
        EngineId::Tracker,
        EngineId::TangentialStatic,
        EngineId::TangentialInterval,
        EngineId::TangentialQuasiDifferential,
        EngineId::Kmtpp,
    ] {
        let engine = build(id, inputs(&tables, &traverses, skew)).expect("nothing is lacking");
        let model = engine.path_model().expect("product engines know paths");
        all.push(rigid(id.name(), &|q| model.error_mm(&at(*q))));
    }
    all
}

pub(super) fn section() -> String {
    let rows = published("table_2_13_measured_deviation");
    let targets: Vec<Vector> = rows.iter().map(|r| Vector::new(r[0], r[1], r[2])).collect();
    let measured: Vec<f64> = rows.iter().map(|r| r[3]).collect();
    let rms = |values: &mut dyn Iterator<Item = f64>| (values.map(|v| v * v).sum::<f64>() / 10.0).sqrt();
    let skew = squareness(&tables(), &traverses(315));
    let forecasts = forecasts(&targets);

    let mut text = format!(
        "## The ten targets of Table 2.13\n\n\
         Measured |d| without correction (315 mm cube, tracker), RMS {} mm, against what the engines predict from the other measurements; none of the ten was used. \
         Squareness by least squares through the traverses, less what the slopes of the straightness tables already hold (docs/decisions.md): EC0Y {} µrad, EB0Z {} µrad, EA0Z {} µrad. Printed sums 3.100, 1.579, 1.177, 0.866 mm reproduce, \
         and Table 4.10 repeats its columns (`cargo test -p machine-model published_measurements`).\n\n\
         ```sh\nvpost predict samples/points/table_2_13_targets.csv -m machine-profiles/stan_s500.toml --outside clamp\n```\n\n",
        fixed(rms(&mut measured.iter().copied()), 3),
        fixed(skew.ec0y_rad * 1e6, 0),
        fixed(skew.eb0z_rad * 1e6, 0),
        fixed(skew.ea0z_rad * 1e6, 0),
    );
    let cells: Vec<Vec<String>> = forecasts
        .iter()
        .map(|forecast| {
            let gap = &mut forecast.errors.iter().zip(&measured).map(|(e, m)| e.norm() - m);
            let gap = rms(gap);
            vec![
                forecast.name.clone(),
                fixed(rms(&mut forecast.errors.iter().map(Vector::norm)), 3),
                fixed(gap, 3),
            ]
        })
        .collect();
    text +=
        &table(&["model", r"RMS of predicted \|d\|, mm", r"RMS of predicted − measured \|d\|, mm"], &cells);
    text += "\nA magnitude depends on the frame it is measured in: the tracker's X lies along nothing in particular, so the rows in the tracker's frame are the \
             comparison, and the small figure of the row before them is no evidence. (162, 168, 210) and (230, 230, 230) lie beyond the Z table (200 mm): \
             there the rigid body and KMTPP take the error of the nearest point, as they never extrapolate.\n";
    text += "\nPoint by point, |d| in mm (corrected columns as measured by the publication after its own corrections):\n\n";
    let pick = |name: &str| forecasts.iter().find(|f| f.name == name).map(|f| &f.errors);
    let (tables_alone, tracker) = (pick("rigid-body, interferometer tables alone"), pick("tracker"));
    let cells: Vec<Vec<String>> = (0..rows.len())
        .map(|k| {
            let predicted =
                |errors: Option<&Vec<Vector>>| errors.map_or(String::new(), |e| fixed(e[k].norm(), 3));
            let mut cells = vec![
                vector(&targets[k], 0),
                fixed(measured[k], 3),
                predicted(tables_alone),
                predicted(tracker),
            ];
            cells.extend(rows[k][4..7].iter().map(|v| fixed(*v, 3)));
            let kmtpp = published("table_4_10_measured_deviation");
            let kmtpp = kmtpp.iter().find(|other| other[..3] == rows[k][..3]).map(|other| fixed(other[5], 3));
            cells.push(kmtpp.unwrap_or_else(|| "–".into()));
            cells
        })
        .collect();
    text += &table(
        &[
            "target",
            "measured",
            "interferometer alone",
            "`tracker`",
            "after static",
            "after interval",
            "after quasi-diff.",
            "after KMTPP (4.10)",
        ],
        &cells,
    );
    text += "\nThe columns after correction are measurements on the machine and cannot be recomputed; they are kept as data. \
             What the tables alone miss, and how much of it squareness and scale explain, is the matter of `vpost diagnose`.\n";
    text
}
