//! What the whole-program tests share: the command, folders, the second judge.

#![allow(dead_code, reason = "each test binary uses its own part of this")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The project's root.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the project is there")
}

/// The command under test, in the project's root, in English whatever the locale of who tests.
pub(crate) fn vpost() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vpost"));
    command.current_dir(root()).env_remove("NO_COLOR").env("LC_ALL", "C");
    command
}

/// Runs the command with arguments.
pub(crate) fn run(arguments: &[&str]) -> Output {
    vpost().args(arguments).output().expect("the command starts")
}

/// Standard error as text.
pub(crate) fn messages(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder of its own.
pub(crate) struct Place(pub(crate) tempfile::TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// A file there; its path.
    pub(crate) fn write(&self, name: &str, text: &str) -> String {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    }

    /// The corrected program, and what was said of it.
    pub(crate) fn corrected(&self, program: &str, arguments: &[&str]) -> (String, String) {
        let input = self.write("in.nc", program);
        let ran = run(&[&["correct", &input], arguments].concat());
        assert!(ran.status.success(), "{}", messages(&ran));
        (String::from_utf8(ran.stdout.clone()).expect("ASCII"), messages(&ran))
    }

    pub(crate) fn refused(&self, program: &str, arguments: &[&str]) -> String {
        let input = self.write("in.nc", program);
        let ran = run(&[&["correct", &input], arguments].concat());
        assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
        messages(&ran)
    }

    pub(crate) fn check(&self, program: &str, corrected: &str, arguments: &[&str]) -> serde_json::Value {
        let (input, out) = (self.write("in.nc", program), self.write("out.nc", corrected));
        let ran = run(&[&["check", &input, &out, "--json"], arguments].concat());
        serde_json::from_slice(&ran.stdout).expect("JSON")
    }
}

/// Files of a folder with one of the endings, in order.
pub(crate) fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder)
        .map(|entries| entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect())
        .unwrap_or_default();
    found.retain(|path| path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known)));
    found.sort();
    found
}

/// The samples and the dialect of each.
pub(crate) const SAMPLES: [(&str, &str); 10] = [
    ("samples/plate_linuxcnc.nc", "linuxcnc"),
    ("samples/plate_centroid.nc", "centroid"),
    ("samples/dome_fanuc.nc", "fanuc"),
    ("samples/arcs_in_planes_linuxcnc.ngc", "linuxcnc"),
    ("samples/bolt_circle_fanuc.nc", "fanuc"),
    ("samples/bracket_inch_fanuc.nc", "fanuc"),
    ("samples/contour_incremental_fanuc.nc", "fanuc"),
    ("samples/helix_linuxcnc.ngc", "linuxcnc"),
    ("samples/inverse_time_linuxcnc.ngc", "linuxcnc"),
    ("samples/pocket_perspektiva.nc", "perspektiva"),
];

/// True where LinuxCNC's interpreter is installed. On the build machines it must be.
pub(crate) fn have_interpreter() -> bool {
    let there = Command::new("/usr/bin/python3")
        .args(["-c", "import gcode"])
        .output()
        .is_ok_and(|output| output.status.success());
    assert!(there || std::env::var_os("CI").is_none(), "linuxcnc-uspace must be installed where CI is set");
    there
}

/// The second judge: LinuxCNC's interpreter and a model that shares no code with the product.
pub(crate) fn referee(
    input: &Path,
    output: &Path,
    profile: &str,
    dialect: &str,
    more: &[&str],
) -> serde_json::Value {
    let mut command = Command::new("/usr/bin/python3");
    command.current_dir(root()).arg("tests/referee/referee.py");
    command.arg("--in").arg(input).arg("--out").arg(output).args(["--model", profile]);
    if matches!(dialect, "fanuc") {
        command.args(["--least-increment", "3"]);
    }
    command.args(more);
    let ran = command.output().expect("python starts");
    serde_json::from_slice(&ran.stdout)
        .unwrap_or_else(|error| panic!("referee on {}: {error}\n{}", input.display(), messages(&ran)))
}

/// A page as its words are read: the elements that keep a word with a hyphen whole are left out.
pub(crate) fn page(path: impl AsRef<std::path::Path>) -> String {
    let html = std::fs::read_to_string(path).expect("the page was written");
    let mut parts = html.split("<span class=\"w\">");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |read, part| read + &part.replacen("</span>", "", 1))
}
