//! `vpost calibrate turning`: from test pieces to a profile that predicts the next one.

use crate::common::{messages, run};

pub(crate) const LATHE: &str = "format = 1\nname = \"L\"\ncontrol = \"fanuc-lathe\"\nchain = \"[w S b Z X t]\"\n[program]\ng_code_system = \"A\"\nx = \"diameter\"\ndecimal = \"millimetres\"\n[axis.X]\ntravel_mm = [-20, 160]\nresolution_mm = 0.001\n[axis.Z]\ntravel_mm = [-20, 520]\nresolution_mm = 0.001\n[work_offsets_mm]\nG54 = [0, 0, 0]\n";

const TURNED: &str = "%\nO1\nG21 G18 G40 G99 G54\nG0 X80. Z400.\nX40.\nG1 Z80. F0.2\nG0 X80.\nM30\n%\n";

/// What a lathe whose spindle leans by 85 µrad leaves: 0.17 µm on the diameter a millimetre.
fn parts(names: &[&str], sign: f64) -> String {
    let mut text = String::from("part,z_mm,diameter_mm,d_um,tool\n");
    for (part, name) in names.iter().enumerate() {
        for (place, z) in (80..=360).step_by(40).enumerate() {
            let noise = 0.1 * f64::from((part * 5 + place * 3) as u32 % 7) - 0.3;
            text += &format!("{name},{z},40,{:.2},T1\n", sign * -0.17 * f64::from(z) + noise);
        }
    }
    text
}

#[test]
fn test_pieces_become_a_profile_that_predicts_and_one_that_is_refuted_is_not_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path.to_str().expect("a plain name").to_owned()
    };
    let (lathe, program) = (file("lathe.toml", LATHE), file("p.nc", TURNED));
    let measured = file("parts.csv", &parts(&["A", "B", "C"], 1.0));
    let made = folder.path().join("made.toml").to_str().expect("a plain name").to_owned();
    let calibrate =
        |held: &str| run(&["calibrate", "turning", &measured, "-m", &lathe, "--holdout", held, "-o", &made]);
    let refuted = calibrate(&file("wrong.csv", &parts(&["D", "E"], -1.0)));
    assert!(messages(&refuted).contains("VP1103"), "{}", messages(&refuted));
    assert!(!refuted.status.success() && !std::path::Path::new(&made).exists());
    let found = calibrate(&file("held.csv", &parts(&["D", "E"], 1.0)));
    assert!(found.status.success(), "{}", messages(&found));
    let turned = run(&["predict", "--lathe", &program, "-m", &made, "--step", "100"]);
    let text = String::from_utf8(turned.stdout).expect("ASCII");
    let radius_error_um = |z: &str| -> f64 {
        let row = text.lines().find(|line| line.starts_with(z)).unwrap_or_else(|| panic!("{z} in {text}"));
        row.split(',').nth(4).and_then(|cell| cell.parse().ok()).expect("a number")
    };
    // 85 µrad over 200 mm on the radius, the readings good to 0.3 µm.
    let cone_um = radius_error_um("300.") - radius_error_um("100.");
    assert!((cone_um + 17.0).abs() < 0.3, "{cone_um}");
    let one = file("one.csv", &parts(&["A"], 1.0));
    let refused = run(&["calibrate", "turning", &one, "-m", &lathe]);
    assert!(messages(&refused).contains("one part cannot tell its own bending"), "{}", messages(&refused));
    // Where the carriage stood is known only of a tool that the profile knows.
    let tools = file("tools.toml", &format!("{LATHE}[tool]\nlengths_mm = {{ H1 = [0, 0, 60] }}\n"));
    let named = |tool: &str| file("named.csv", &parts(&["A", "B"], 1.0).replace("T1", tool));
    let by_tool = |tool: &str| run(&["calibrate", "turning", &named(tool), "-m", &tools]);
    assert!(
        messages(&by_tool("T1")).contains("which tool of the profile is `T1`?"),
        "{}",
        messages(&by_tool("T1"))
    );
    assert!(messages(&by_tool("T0102")).contains("add its length"), "{}", messages(&by_tool("T0102")));
    assert!(by_tool("T0101-2").status.success(), "{}", messages(&by_tool("T0101-2")));
}

/// A bar of 40 mm between chuck and tailstock.
pub(crate) const BAR: &str = "[tailstock]\nat_mm = 400.0\n[workpiece]\ndiameters_mm = [[0, 40], [400, 40]]\ne_gpa = 210.0\nclamping = \"chuck-tailstock\"\nradial_force_n = 0.0\n";

/// Parts of a lathe that wears its tip by 2 µm a part on the radius, or leans, or both.
pub(crate) fn diagnosed(taper_urad: f64, wear_um: f64, is_timed: bool) -> String {
    let mut text = String::from("part,z_mm,diameter_mm,d_um,tool");
    text.push_str(if is_timed { ",time_s\n" } else { "\n" });
    for part in 0..8u32 {
        for (place, z) in (80..=360).step_by(40).enumerate() {
            let noise = 0.1 * f64::from((part * 5 + place as u32 * 3) % 7) - 0.3;
            let d = 2.0 * (taper_urad * 1e-3 * f64::from(z) + wear_um * f64::from(part)) + noise;
            // Two parts are cut soon after each other, then the machine rests: time does not go with the order.
            let time = 600.0 * f64::from(part % 2) + 20_000.0 * f64::from(part / 2).sqrt();
            let diameter = if part % 2 == 0 { 40 } else { 60 };
            text += &format!("P{part},{z},{diameter},{d:.2},T1");
            text += &if is_timed { format!(",{time}\n") } else { "\n".to_owned() };
        }
    }
    text
}

#[test]
fn diagnose_names_a_taper_and_never_a_wear_that_may_be_growth() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path.to_str().expect("a plain name").to_owned()
    };
    let lathe = file("lathe.toml", &format!("{LATHE}{BAR}"));
    let json = folder.path().join("d.json").to_str().expect("a plain name").to_owned();
    let answer = |text: &str| -> (serde_json::Value, String) {
        let parts = file("parts.csv", text);
        let output = run(&["diagnose", &parts, "-m", &lathe, "--json", &json]);
        assert!(output.status.success(), "{}", messages(&output));
        let read = std::fs::read_to_string(&json).expect("written");
        (serde_json::from_str(&read).expect("JSON"), String::from_utf8(output.stdout).expect("UTF-8"))
    };
    let ids = |found: &serde_json::Value| -> Vec<String> {
        let causes = found["causes"].as_array().expect("causes").iter();
        causes.map(|cause| cause["effect"].as_str().expect("an id").to_owned()).collect()
    };
    let (found, said) = answer(&diagnosed(-30.0, 0.0, true));
    assert_eq!(found["schema"], "vpost.diagnosis/1");
    assert_eq!(
        (found["verdict"].as_str(), ids(&found)),
        (Some("NAMED"), vec!["lathe.taper".to_owned()]),
        "{said}"
    );
    let taper = found["causes"][0]["parameters"][0]["value"].as_f64().expect("a number");
    assert!((taper + 30.0).abs() < 0.5, "{taper}");
    assert!(said.contains("tailstock") || said.contains("offset_um"), "{said}");
    // Without the time nothing tells wear from growth.
    let (found, said) = answer(&diagnosed(0.0, 2.0, false));
    assert_eq!(
        (found["verdict"].as_str(), ids(&found)),
        (Some("AMBIGUOUS"), vec!["tool.wear".to_owned()]),
        "{said}"
    );
    assert!(
        said.contains("cannot be told from spindle.growth") && said.contains("next    With time_s"),
        "{said}"
    );
    let (found, said) = answer(&diagnosed(0.0, 0.0, true));
    assert_eq!((found["verdict"].as_str(), ids(&found).len()), (Some("NO GAP"), 0), "{said}");
    let refused =
        run(&["diagnose", &file("p.csv", &diagnosed(0.0, 0.0, true)), "-m", &lathe, "--viewer", &json]);
    assert!(!refused.status.success() && messages(&refused).contains("--viewer"), "{}", messages(&refused));
}
