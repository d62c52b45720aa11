//! The lab's own account of the hold-out: what the written profile predicts there, against the truth.

use std::path::Path;
use std::process::Command;

use gap_lab::{Case, Kind};

use super::answer::Answer;
use super::attempt::attempt;

/// Shrinkage on fresh points, found without the diagnosis' own hold-out block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transport {
    /// Share of it that the written profile takes away.
    pub(crate) share: f64,
    /// Largest difference between the lab's kinematics and the model's on the profile as handed out, µm.
    pub(crate) kinematics_um: f64,
}

/// Families whose effects are a function of the command and its direction only: the points of `predict`
/// carry nothing else.
const UNCONDITIONAL: [&str; 10] = [
    "scale",
    "backlash",
    "lost-motion",
    "squareness",
    "positioning",
    "straightness",
    "pitch",
    "angular",
    "sag",
    "local",
];

/// Predicts the hold-out commands with the profile as it was and as it was found.
pub(crate) fn check(vpost: &Path, folder: &Path, case: &Case, answer: &Answer) -> Option<Transport> {
    let unconditional = |id: &str| UNCONDITIONAL.contains(&id.split('.').next().unwrap_or(id));
    let all = !answer.causes.is_empty() && answer.causes.iter().all(|c| unconditional(&c.effect));
    // A magnitude has no sign: the machine with the opposite error is as good an answer.
    if case.kind == Kind::Magnitude || !all || !folder.join("found.toml").is_file() {
        return None;
    }
    std::fs::write(folder.join("points.csv"), case.fresh.points_csv()).ok()?;
    let before = predict(vpost, folder, "profile.toml")?;
    let after = predict(vpost, folder, "found.toml")?;
    let explained: Vec<[f64; 3]> =
        before.iter().zip(&after).map(|(b, a)| [0, 1, 2].map(|i| a[i] - b[i])).collect();
    if explained.len() != case.fresh.len() {
        return None;
    }
    let known = case.fresh.known_um();
    let kinematics_um = known.iter().zip(&before).flat_map(|(k, b)| [0, 1, 2].map(|i| (k[i] - b[i]).abs()));
    let kinematics_um = kinematics_um.fold(0.0, f64::max);
    let shrink = case.fresh.shrink(&explained);
    Some(Transport { share: shrink.share(), kinematics_um })
}

/// Displacements `dx_um dy_um dz_um` that a profile predicts at the points.
fn predict(vpost: &Path, folder: &Path, profile: &str) -> Option<Vec<[f64; 3]>> {
    let mut command = Command::new(vpost);
    command.args(["predict", "points.csv", "-m", profile]);
    if attempt(command, folder, "predict").ok()?.failure.is_some() {
        return None;
    }
    let text = std::fs::read_to_string(folder.join("predict.out")).ok()?;
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next()?.split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name);
    let columns = [column("dx_um")?, column("dy_um")?, column("dz_um")?];
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let mut values = [0.0; 3];
            for (value, column) in values.iter_mut().zip(columns) {
                *value = cells.get(column)?.parse().ok()?;
            }
            Some(values)
        })
        .collect()
}
