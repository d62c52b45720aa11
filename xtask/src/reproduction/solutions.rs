//! Commands that the publication solved: tangential methods and KMTPP.

use machine_model::engines::published::{KmtppPublished, Method, TangentialPublished};
use machine_model::engines::{
    Kmtpp, PUBLISHED_INTERVAL, ParametricTable, Tangential, TangentialInterval, Tracker,
};
use machine_model::{Engine, Interpolation, PathModel as _, Vector};

use crate::engines::at;
use crate::markdown::{fixed, table, vector};
use crate::stan_s500::{published, tables, traverses};

const TARGET: [f64; 3] = [130.0, 140.0, 106.0];

fn command(engine: &dyn Engine, target: Vector) -> Vector {
    engine.solve(&at(target)).expect("inside the volume").linear_mm
}

fn same_digits(ours: &Vector, printed: &Vector) -> String {
    if (ours - printed).amax() <= 0.500_000_1e-3 { "yes" } else { "**no**" }.to_owned()
}

pub(super) fn tangential() -> String {
    let traverses = traverses(315);
    let target = Vector::from(TARGET);
    let fifty = Vector::repeat(50.0);
    let of = |method| TangentialPublished::new(&traverses, method).expect("shipped traverses");
    let quasi = of(Method::QuasiDifferential);
    let rows = [
        ("static, appendix Б", command(&of(Method::Static), target), [129.902, 139.929, 105.949]),
        ("interval, appendix В", command(&of(Method::Interval), target), [129.768, 139.921, 105.927]),
        ("quasi-differential, appendix Г", command(&quasi, target), [129.844, 139.890, 105.891]),
        ("quasi-differential at (50, 50, 50), §4.3", command(&quasi, fifty), [49.927, 49.936, 49.949]),
    ];
    let cells = rows.map(|(name, ours, printed)| {
        let printed = Vector::from(printed);
        vec![name.to_owned(), vector(&printed, 3), vector(&ours, 6), same_digits(&ours, &printed)]
    });
    let mut text = String::from(
        "## Tangential methods\n\nTarget (130, 140, 106), traverses of the 315 mm cube, cosines without their signs.\n\n",
    );
    text += &table(&["method", "printed q, mm", "ours", "same digits"], &cells);
    text += &format!(
        "\nThe sum R of the quasi-differential method is printed as 120.150625141 135.105955968 105.106431456; ours, from \
         positions to seven decimals, is {}.\n\n\
         With the signs of the cosines, and the interval chosen by the command, the product's engines say:\n\n",
        vector(&quasi.path_sum_mm(&target), 9),
    );
    let signed: [(&str, Vector); 3] = [
        (
            "`tangential-static`",
            command(&Tangential::fixed(&traverses, PUBLISHED_INTERVAL).expect("shipped traverses"), target),
        ),
        (
            "`tangential-interval`",
            command(&TangentialInterval::new(&traverses).expect("shipped traverses"), target),
        ),
        (
            "`tangential-quasi-differential`",
            command(
                &Tangential::quasi_differential(&traverses, PUBLISHED_INTERVAL).expect("shipped traverses"),
                target,
            ),
        ),
    ];
    let cells = signed.map(|(name, q)| vec![name.to_owned(), vector(&q, 6)]);
    text += &table(&["engine", "q, mm"], &cells);
    let jump = TangentialInterval::new(&traverses).expect("shipped traverses").largest_jump();
    text += &format!(
        "\nThe interval method is not continuous: its largest jump between two cells of this cube is {} µm, at {} = {} mm. \
         So `tangential-interval` solves points and refuses paths across cells.\n\n",
        fixed(jump.0 * 1e3, 1),
        ["X", "Y", "Z"][jump.1],
        jump.2,
    );
    text
}

/// Tables 2.6 to 2.8 and 2.10 to 2.12 print absolute values.
pub(super) fn cosines() -> String {
    let mut rows = Vec::new();
    for cube in [48, 240, 315] {
        let (mut all, mut below, mut printed_below) = (0, 0, 0);
        let (mut signed, mut absolute): (f64, f64) = (0.0, 0.0);
        for traverse in traverses(cube) {
            let printed = traverse.published_cosines.as_ref().expect("printed beside the positions");
            for (k, pair) in traverse.measured_mm.windows(2).enumerate() {
                let ours = (Vector::from(pair[1]) - Vector::from(pair[0])).normalize();
                let theirs = Vector::from(printed[k + 1]);
                all += 3;
                below += ours.iter().filter(|c| **c < 0.0).count();
                printed_below += theirs.iter().filter(|c| **c < 0.0).count();
                signed = signed.max((ours - theirs).amax());
                absolute = absolute.max((ours.abs() - theirs).amax());
            }
        }
        rows.push(vec![
            format!("{cube} mm"),
            all.to_string(),
            below.to_string(),
            printed_below.to_string(),
            format!("{signed:.1e}"),
            format!("{absolute:.1e}"),
        ]);
    }
    String::from(
        "## Cosines of the traverses\n\n\
         **Defect.** Tables 2.6–2.8 and 2.10–2.12 print the absolute values of the cosines; Tables 2.2–2.4 (48 mm cube) keep \
         the signs. The measured positions beside them give the signs, so the product's engines use those.\n\n",
    ) + &table(
        &[
            "cube",
            "cosines",
            "below zero",
            "printed below zero",
            "printed − signed, at most",
            "printed − absolute, at most",
        ],
        &rows,
    ) + "\nShown by `cargo test -p machine-model published_cosines`. \
         **Defect.** One interval extrapolated (static) multiplies the noise of its chord by travel/step: 16, 21 and 24 times in the 240, 315 and 48 mm cubes, and the \
         chords of the last are 2 mm short. That cube cannot carry a correction; the publication found the machine worse (its Table 2.5).\n\n"
}

pub(super) fn kmtpp() -> String {
    let fifty = Vector::repeat(50.0);
    let mut text = String::from(
        "## KMTPP\n\n\
         `kmtpp-published` is the listing of §4.3: nearest table row, Gᵀ in the sum, base rounded to a node. The last column is the same \
         solution with the base q[m] instead of the rounded node: what K and l seem to steer is the rounding.\n\n\
         Table 4.1, target (50, 50, 50), K = 1.5:\n\n",
    );
    let row = |tables: &[ParametricTable; 3],
               gain: f64,
               step: f64,
               target: Vector,
               name: String,
               m: f64,
               printed: Vector| {
        let engine =
            KmtppPublished::new(tables.clone(), &traverses(315), gain, step).expect("shipped tables");
        let solution = engine.solve(&at(target)).expect("inside the volume");
        let trace = engine.trace(&target).expect("inside the volume");
        vec![
            name,
            fixed(m, 0),
            solution.iterations.to_string(),
            vector(&printed, 3),
            vector(&solution.linear_mm, 3),
            same_digits(&solution.linear_mm, &printed),
            vector(&(solution.linear_mm + trace.last_mm - trace.node_mm), 3),
        ]
    };
    let coarse = tables();
    let head = |first| [first, "m printed", "m ours", "q printed", "q ours", "same digits", "q from q[m]"];
    let printed = |row: &[f64], from: usize| Vector::from_column_slice(&row[from..from + 3]);
    let rows: Vec<_> = published("table_4_1_kmtpp_step")
        .iter()
        .map(|r| row(&coarse, 1.5, r[0], fifty, r[0].to_string(), r[1], printed(r, 2)))
        .collect();
    text += &table(&head("l"), &rows);
    text += "\nTable 4.2, l = 0.1:\n\n";
    let rows: Vec<_> = published("table_4_2_kmtpp_gain")
        .iter()
        .map(|r| row(&coarse, r[0], 0.1, fifty, r[0].to_string(), r[1], printed(r, 2)))
        .collect();
    text += &table(&head("K"), &rows);
    text += "\nTables 4.3 (K = 1.5) and 4.4 (K = 1), target (130, 140, 106); the printed columns are said to be positions measured by the tracker:\n\n";
    let rows: Vec<_> = published("tables_4_3_4_4_kmtpp_far_point")
        .iter()
        .map(|r| {
            row(&coarse, r[0], r[1], Vector::from(TARGET), format!("{}, {}", r[0], r[1]), r[2], printed(r, 3))
        })
        .collect();
    text += &table(&head("K, l"), &rows);
    let fine = tables().map(|rows| rows.refined(2.0));
    text += &fine_grid(&fine);
    text += "\nTable 4.9, tables refined linearly to 2 mm, K = 1.5, l = 0.1 (\
             `vpost solve samples/points/table_4_9_targets.csv … --engine kmtpp-published` solves the same points on the coarse tables):\n\n";
    let rows: Vec<_> = published("table_4_9_kmtpp_fine_grid")
        .iter()
        .map(|r| row(&fine, 1.5, 0.1, printed(r, 0), vector(&printed(r, 0), 0), r[3], printed(r, 4)))
        .collect();
    text += &table(&head("target"), &rows);
    text += &left_by_commands(&fine);
    let product = Kmtpp::from_measurements(&coarse, &traverses(315)).expect("shipped tables");
    text += &format!(
        "\n**Defects**, each shown by `cargo test -p machine-model published_kmtpp`:\n\n\
         1. The listing adds Δq·Q_i, the transpose of what equation 4.9 says. Needed for the printed digits.\n\
         2. The base of the last step is the rounded node `[u_x n_x, u_y n_y, u_z n_z]`, while R belongs to q[m]: up to half a table step of error. \
         With q[m] as base (last column) K and l stop to matter. Tables 4.1–4.4 measure this rounding.\n\
         3. Table 4.1: the rows l = 0.1 and l = 0.015 are swapped; Table 4.2's row K = 1.5 repeats the swapped one. The recommended l = 0.1 rests on it.\n\
         4. Tables 4.8 and 4.9: m reproduces in all twelve rows, q of Table 4.9 for (50, 50, 50) only.\n\
         5. Tables 4.3 and 4.4 print \"positions of the drives measured by the tracker\" after the solutions were entered. Nine of the ten are the \
         solutions of the listing themselves, to the last digit (the tenth, K = 1, l = 0.015, is of another run: m is 175, not 152): \
         they are commands, no measurement. So nothing measured supports these two tables.\n\
         6. Table 4.8: the position said to be reached at l = 0.5 is the listing's command less 0.200 0.200 0.100 mm, to the last digit.\n\
         7. The linear errors δ of the same tables are never used.\n\n\
         The consistent engine `kmtpp` needs neither K nor l and gives {} for (50, 50, 50) and {} for (130, 140, 106); it adds EXX, EYY, EZZ. \
         `docs/engines.md` says where its premise and the rigid body part.\n\n",
        vector(&command(&product, fifty), 3),
        vector(&command(&product, Vector::from(TARGET)), 3),
    );
    text
}

/// Table 4.8: steps recomputed, positions as printed.
fn fine_grid(fine: &[ParametricTable; 3]) -> String {
    let target = Vector::from(TARGET);
    let tracker = tracker();
    let rows: Vec<Vec<String>> = published("table_4_8_kmtpp_fine_grid_step")
        .iter()
        .map(|row| {
            let engine = KmtppPublished::new(fine.clone(), &traverses(315), KmtppPublished::GAIN, row[0])
                .expect("shipped tables");
            let solution = engine.solve(&at(target)).expect("inside the volume");
            let reached = Vector::from_column_slice(&row[2..5]);
            vec![
                row[0].to_string(),
                fixed(row[1], 0),
                solution.iterations.to_string(),
                vector(&reached, 3),
                fixed((reached - target).norm(), 3),
                vector(&solution.linear_mm, 3),
                fixed(left_mm(&tracker, &solution.linear_mm, &target), 3),
            ]
        })
        .collect();
    let text = "\nTable 4.8, tables refined linearly to 2 mm, target (130, 140, 106), K = 1.5. What is printed beside m was measured by the \
                tracker after a correction that is not printed: it can be compared and not recomputed. Beside it what the listing \
                commands, and what the traverses of the same tracker (engine `tracker`) say that this command leaves:\n\n"
        .to_owned();
    let head = ["l", "m printed", "m ours", "reached, printed", "off, mm", "q ours", "left by q ours, mm"];
    text + &table(&head, &rows)
}

/// Table 4.10: what was measured to be left, beside what the traverses say of the commands of Table 4.9.
fn left_by_commands(fine: &[ParametricTable; 3]) -> String {
    let tracker = tracker();
    let listing =
        KmtppPublished::new(fine.clone(), &traverses(315), KmtppPublished::GAIN, KmtppPublished::TIME_STEP)
            .expect("shipped tables");
    let measured = published("table_4_10_measured_deviation");
    let mut sums = [0.0; 7];
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (row, commanded) in measured.iter().zip(published("table_4_9_kmtpp_fine_grid")) {
        let target = Vector::from_column_slice(&row[..3]);
        assert_eq!(row[..3], commanded[..3], "both tables have the same seven points");
        let printed = Vector::from_column_slice(&commanded[4..7]);
        let product = Kmtpp::from_measurements(&tables(), &traverses(315)).expect("shipped tables");
        let left = |q: &Vector| left_mm(&tracker, q, &target);
        let figures = [
            row[3],
            left(&target),
            row[4],
            row[5],
            left(&printed),
            left(&command(&listing, target)),
            left(&command(&product, target)),
        ];
        for (sum, figure) in sums.iter_mut().zip(figures) {
            *sum += figure;
        }
        rows.push(std::iter::once(vector(&target, 0)).chain(figures.map(|mm| fixed(mm, 3))).collect());
    }
    rows.push(std::iter::once("sum".to_owned()).chain(sums.map(|mm| fixed(mm, 3))).collect());
    let text = "\nTable 4.10: deviations measured without correction, by the quasi-differential method and by KMTPP, mm. Beside them what \
                the tracker's traverses of the same cube say (engine `tracker`): |d| without correction, and what the commands leave that \
                Table 4.9 prints, that its listing gives, and that `kmtpp` gives. The commands were measured on another day than the traverses, \
                in a frame that is not told:\n\n"
        .to_owned();
    let head = [
        "target",
        "measured",
        "by traverses",
        "measured, quasi-diff.",
        "measured, KMTPP",
        "q of 4.9",
        "q of the listing",
        "q of `kmtpp`",
    ];
    text + &table(&head, &rows)
}

fn tracker() -> Tracker {
    Tracker::new(&traverses(315), Interpolation::Monotone).expect("shipped traverses")
}

/// Distance from a target to where the traverses say that a command leads, mm.
fn left_mm(tracker: &Tracker, q_mm: &Vector, target_mm: &Vector) -> f64 {
    (q_mm + tracker.error_mm(&at(*q_mm)) - target_mm).norm()
}
