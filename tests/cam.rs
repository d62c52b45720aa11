//! `vpost` behind a CAM system: FreeCAD posts a job of its own through the script that `samples/cam` has for it.

#![cfg(unix)]

use std::path::Path;
use std::process::{Command, Output};

use crate::common::{messages, root, run};

/// A machine that ships nowhere, and the place for a job on it.
struct Shop(tempfile::TempDir);

/// A block with a contour around it, posted twice: by FreeCAD's own post, and by ours behind it.
const JOB: &str = r#"
import os, sys
import FreeCAD
import Part
sys.path.insert(0, os.getcwd())
try:
    from Path.Main import Job
    from Path.Op import Profile
except ImportError:
    from PathScripts import PathJob as Job, PathProfile as Profile
import vpost_linuxcnc_post as corrected

document = FreeCAD.newDocument()
block = document.addObject("Part::Box", "Cover")
block.Length, block.Width, block.Height = 64, 36, 12
document.recompute()
job = Job.Create("Job", [block])
contour = Profile.Create("Contour")
document.recompute()
parts = [job.Tools.Group[0], contour]
# The header has the time.
corrected.posted_by.export(parts, "posted.nc", "--no-header --no-show-editor")
try:
    text = corrected.export(parts, "corrected.nc", "--no-header")
    with open("returned.nc", "w", newline="") as returned:
        returned.write(text)
except RuntimeError as refused:
    with open("refused.txt", "w") as said:
        said.write(str(refused))
"#;

impl Shop {
    /// * `x_travel_mm` – what the machine can reach and was measured over
    fn new(x_travel_mm: [f64; 2]) -> Self {
        let shop = Self(tempfile::tempdir().expect("a temporary folder"));
        let machine = shop.path("router.toml");
        let [from, to] = x_travel_mm;
        let text = format!(
            "format = 1\nname = \"Garage router\"\ncontrol = \"linuxcnc\"\nchain = \"[w Y b X Z t]\"\n\
             axis.X = {{ travel_mm = [{from}, {to}], resolution_mm = 0.001 }}\n\
             axis.Y = {{ travel_mm = [-30, 910], resolution_mm = 0.001 }}\n\
             axis.Z = {{ travel_mm = [-160, 340], resolution_mm = 0.001 }}\n\
             squareness = {{ EC0Y_urad = 310, EB0Z_urad = -140, EA0Z_urad = 90 }}\n\
             work_offsets_mm = {{ G54 = [212, 377, 41] }}\ntool = {{ lengths_mm = {{ H1 = 73.5 }} }}\n",
        );
        std::fs::write(&machine, text).expect("writable");
        // What the reader of the page changes: where vpost is, and the profile.
        let script =
            std::fs::read_to_string(root().join("samples/cam/vpost_linuxcnc_post.py")).expect("text");
        let own = script
            .replace("[\"vpost\",", &format!("[{:?},", env!("CARGO_BIN_EXE_vpost")))
            .replace("/etc/vpost/my-machine.toml", &machine);
        assert_eq!(own.matches(&machine).count(), 1, "{script}");
        std::fs::write(shop.path("vpost_linuxcnc_post.py"), own).expect("writable");
        std::fs::write(shop.path("job.py"), JOB).expect("writable");
        shop
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    fn text(&self, name: &str) -> Option<String> {
        std::fs::read_to_string(self.path(name)).ok()
    }

    /// `None` where FreeCAD is not installed.
    fn post(&self) -> Option<Output> {
        let freecad = ["freecadcmd", "FreeCADCmd"].into_iter().find(|name| is_there(name))?;
        let ran = Command::new(freecad)
            .arg("job.py")
            .current_dir(self.0.path())
            // Its settings and logs are kept in the home folder.
            .env("HOME", self.0.path())
            .env("QT_QPA_PLATFORM", "offscreen")
            .stdin(std::process::Stdio::null())
            .output();
        Some(ran.expect("FreeCAD starts"))
    }
}

fn is_there(name: &str) -> bool {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders).any(|folder| Path::new(&folder).join(name).is_file())
}

const SKIPPED: &str = "skipped: freecadcmd (Debian: freecad) is not installed";

#[test]
fn freecad_posts_a_job_corrected() {
    let shop = Shop::new([-25.0, 640.0]);
    let Some(ran) = shop.post() else {
        eprintln!("{SKIPPED}");
        return;
    };
    let said = format!("{}{}", String::from_utf8_lossy(&ran.stdout), messages(&ran));
    let corrected = shop.text("corrected.nc").unwrap_or_else(|| panic!("no file: {said}"));
    assert!(corrected.contains("FOR GARAGE ROUTER"), "{corrected}");
    assert_eq!(shop.text("returned.nc"), Some(corrected), "the user interface writes what is returned");
    let [posted, made, machine] = ["posted.nc", "corrected.nc", "router.toml"].map(|name| shop.path(name));
    let check = run(&["check", &posted, &made, "-m", &machine]);
    assert!(check.status.success(), "{}{}", String::from_utf8_lossy(&check.stdout), messages(&check));
}

#[test]
fn freecad_writes_nothing_where_the_program_is_refused() {
    let shop = Shop::new([-25.0, 240.0]);
    if shop.post().is_none() {
        eprintln!("{SKIPPED}");
        return;
    }
    let refused = shop.text("refused.txt").expect("it says why");
    assert!(refused.contains("VP0501") && refused.contains("axis X"), "{refused}");
    assert_eq!((shop.text("corrected.nc"), shop.text("returned.nc")), (None, None));
}

/// What the page shows is the file that is there, in both languages.
#[test]
fn the_script_of_the_page_is_the_sample() {
    let script = std::fs::read_to_string(root().join("samples/cam/vpost_linuxcnc_post.py")).expect("text");
    for page in ["docs/how-to/cam-post-processing.md", "docs/how-to/cam-post-processing.ru.md"] {
        let text = std::fs::read_to_string(root().join(page)).expect("text");
        assert!(text.contains(&format!("```python\n{script}```")), "{page}");
    }
    let own = script.lines().filter(|line| !line.trim().is_empty()).count();
    assert!(own <= 20, "{own} lines: a recipe is to be read at a glance");
}
