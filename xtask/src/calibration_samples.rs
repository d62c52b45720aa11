//! Sample measurements for `vpost calibrate`.

use std::fmt::Write;
use std::path::Path;

use gap_lab::calibration::{BarRow, TableTruth, Turns, ball_bar, circles, volume_points};

use crate::markdown::fixed;

/// The crossing of the axes of the sample table, machine coordinates, mm.
const CROSSING: [f64; 3] = [250.0, 150.0, -300.0];

fn bar_csv(rows: &[BarRow]) -> String {
    let mut text = String::from("run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,a_deg,c_deg,spindle_deg,length_mm\n");
    for r in rows {
        let at = [0, 1, 2].map(|i| CROSSING[i] + r.tool_ball_mm[i]);
        let mut angles = [0.0; 3];
        angles[match r.turns {
            Turns::A => 0,
            Turns::C => 1,
            Turns::Spindle => 2,
        }] = r.angle_deg;
        let cells: Vec<String> = at
            .iter()
            .copied()
            .chain([0, 1, 2].map(|i| at[i] + r.bar_mm[i]))
            .chain(angles)
            .map(|v| v.to_string())
            .collect();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{}",
            ["A1", "A2", "C3", "C4", "spindle"][r.test],
            cells.join(","),
            fixed(r.length_mm, 5)
        );
    }
    text
}

/// The table of Zhang 2024: one position error of 203.5 µm, the cup at -40.3 and -76.5 µm, the rest at random.
fn paper_table(seed: u64) -> TableTruth {
    let mut truth = TableTruth::random(seed, 0);
    truth.piges[4] = 203.5;
    truth.cup_um = [-40.3, -76.5];
    truth
}

/// Writes the files and says so.
pub(crate) fn write(folder: &Path) -> anyhow::Result<String> {
    let truth = paper_table(3);
    let mut left = truth;
    for k in [0, 1, 4, 5] {
        // As a first measurement would leave it.
        left.piges[k] = [0.11, -0.07, 0.0, 0.0, 0.09, -0.12][k];
    }
    let table = |truth: &TableTruth, index: u64| bar_csv(&ball_bar(truth, 3, index, 0.3, 10.0, 1));
    let mut written = String::new();
    let mut put = |name: &str, text: String| -> anyhow::Result<()> {
        std::fs::write(folder.join(name), text)?;
        written += &format!("{}\n", folder.join(name).display());
        Ok(())
    };
    put("ballbar_ac.csv", table(&truth, 1))?;
    put("ballbar_ac_compensated.csv", table(&left, 2))?;
    let mut text = String::from("run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,dir_x,dir_y,dir_z,length_mm\n");
    for r in circles(3, 0, 0.3, 6.0).0 {
        let cells: Vec<String> = r.commanded_mm.iter().chain(&r.centre_mm).map(|v| fixed(*v, 4)).collect();
        let d = r.direction;
        let _ = writeln!(
            text,
            "{},{},{},{},{},{}",
            r.run,
            cells.join(","),
            d[0],
            d[1],
            d[2],
            fixed(r.length_mm, 5)
        );
    }
    put("ballbar_circles.csv", text)?;
    let mut text = String::from("run,x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,dx_um,dy_um,dz_um\n");
    for r in volume_points(3, 0, 1.0, 300).0 {
        let cells: Vec<String> = r.commanded_mm.iter().chain(&r.tool_mm).map(|v| fixed(*v, 3)).collect();
        let deviations: Vec<String> = r.deviation_um.iter().map(|v| fixed(*v, 2)).collect();
        let _ = writeln!(text, "{},{},{}", r.run, cells.join(","), deviations.join(","));
    }
    put("volume_points.csv", text)?;
    Ok(written)
}
