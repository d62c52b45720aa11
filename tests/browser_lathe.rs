//! Pages of lathes: what `predict --lathe` and `calibrate turning` show, in both languages, and in a browser.

use crate::browser::{Report, data_of, nothing_acted, text};
use crate::browser_calibrate::opens_prints_and_fits;
use crate::calibrate_turning::{BAR, diagnosed};
use crate::common::{messages, run};
use crate::devtools::Browser;

pub(crate) const LATHE: &str = "machine-profiles/generic_lathe.toml";

/// A shaft of 40 mm along 120 mm, with a chamfer, an arc and a collar.
pub(crate) const SHAFT: &str = "%\nO1000\nG21 G18 G40 G99 G54\nG50 S2500\nT0101\nG96 S180 M3\nG0 X80. Z5.\nX36. Z2.\nG1 Z0. F0.2\nX40. Z-2.\n\
Z-120.\nG2 X50. Z-125. R5.\nG1 X60.\nZ-145.\nX80.\nG0 Z5.\nM5\nM30\n%\n";

fn turned(program: &str, more: &[&str]) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (input, page) = (folder.path().join("shaft.nc"), folder.path().join("turned.html"));
    std::fs::write(&input, program).expect("writable");
    let name = |path: &std::path::Path| path.to_str().expect("a plain path").to_owned();
    let (input, html) = (name(&input), name(&page));
    let ran = run(&[&["predict", "--lathe", &input, "-m", LATHE, "--html", &html], more].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

/// A lathe, test pieces of the tutorial (a cone and a barrel) and a further one, written to a folder.
pub(crate) fn written_pieces(folder: &std::path::Path) -> [String; 3] {
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    };
    let lathe = file(
        "lathe.toml",
        "format = 1\nname = \"L\"\ncontrol = \"fanuc-lathe\"\nchain = \"[w S b Z X t]\"\n[program]\ng_code_system = \"A\"\nx = \"diameter\"\n\
        [axis.X]\ntravel_mm = [-20, 160]\n[axis.Z]\ntravel_mm = [-20, 520]\n",
    );
    let header = "part,z_mm,diameter_mm,d_um,tool\n";
    let rows = |part: &str, diameter: u32, read: &[(u32, f64)]| -> String {
        read.iter().map(|(z, um)| format!("{part},{z},{diameter},{um},T1\n")).collect()
    };
    let a = [(80, -11.1), (136, -9.7), (192, -13.9), (248, -24.0), (304, -39.0), (360, -58.2)];
    let b = [(80, -9.4), (136, -8.4), (192, -13.8), (248, -23.3), (304, -37.2), (360, -57.0)];
    let c = [(100, -6.1), (160, -7.7), (220, -15.4), (280, -28.6), (340, -46.5)];
    let parts = file("parts.csv", &[header, &rows("A", 40, &a), &rows("B", 60, &b)].concat());
    [lathe, parts, file("third.csv", &[header, &rows("C", 50, &c)].concat())]
}

fn pieces(more: &[&str]) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [lathe, parts, third] = written_pieces(folder.path());
    let page = folder.path().join("pieces.html");
    let html = page.to_str().expect("a plain path").to_owned();
    let all = ["calibrate", "turning", &parts, "-m", &lathe, "--holdout", &third, "--html", &html, "-q"];
    let ran = run(&[&all, more].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

/// A lathe with a bar, and eight parts that lean by so much.
pub(crate) fn written_diagnosis(folder: &std::path::Path, taper_urad: f64) -> [String; 2] {
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    };
    [
        file("held.toml", &format!("{}{BAR}", crate::calibrate_turning::LATHE)),
        file("leaning.csv", &diagnosed(taper_urad, 0.0, true)),
    ]
}

/// What `diagnose` says of them.
fn diagnosis(taper_urad: f64, more: &[&str]) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [lathe, parts] = written_diagnosis(folder.path(), taper_urad);
    let page = folder.path().join("diagnosis.html");
    let html = page.to_str().expect("a plain path").to_owned();
    let ran = run(&[&["diagnose", &parts, "-m", &lathe, "--html", &html], more].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    Report { folder, page }
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Deviations of the radius along the cylinder of 40 mm, its ends apart, µm.
fn along_the_shaft(turned: &serde_json::Value) -> f64 {
    let places = turned["places"].as_array().expect("places").iter();
    let inside = places.filter(|place| (182.0..297.0).contains(&number(&place["z_mm"])));
    inside.map(|place| number(&place["radius_error_um"]).abs()).fold(0.0, f64::max)
}

#[test]
fn the_page_of_a_shaft_says_what_the_correction_brings() {
    let page = text(&turned(SHAFT, &["--section", "190", "--section", "290"]).page);
    let data = data_of(&page);
    let (before, after) = (along_the_shaft(&data), along_the_shaft(&data["corrected"]));
    // The tolerance of 1 µm, and half a step of 0.5 µm on the radius as a distance with that of Z.
    assert!(before > 2.0 && after <= 1.0 + 0.56, "{before} {after}");
    // What the first screen says is what the numbers say: cylinders without the places where Z moves an edge.
    let cylinder = |turned: &serde_json::Value| {
        let all = turned["cylinders"].as_array().expect("cylinders").clone();
        let own = all.into_iter().find(|c| number(&c["nominal_radius_mm"]) == 20.0).expect("the shaft");
        number(&own["cylindricity_um"])
    };
    let (real, left) = (cylinder(&data), cylinder(&data["corrected"]));
    assert!(real < 20.0 && left < real && left > 1.6, "{real} {left}: 1.6 µm are the spindle's");
    let head = page.split("<nav").next().expect("a head");
    assert!(head.contains("The turned surface is up to") && head.contains("Corrected by vpost"), "{head}");
    assert!(head.contains("Roundness (RONt, least squares) is up to 1.60"), "{head}");
    // Two waves a turn of 0.8 µm in X: that wave alone, and roundness twice of it.
    let sections = data["sections"].as_array().expect("sections");
    assert_eq!(sections.len(), 2);
    for (section, z) in sections.iter().zip([190.0, 290.0]) {
        assert_eq!(number(&section["z_mm"]), z);
        assert!((number(&section["roundness_um"]) - 1.6).abs() < 2e-3, "{section}");
        assert!((number(&section["waves"][0]["amplitude_um"]) - 0.8).abs() < 1e-3, "{section}");
        assert!(number(&section["waves"][1]["amplitude_um"]) < 1e-3, "{section}");
    }
    // r − √(r² − f²/4) beside f²/8r.
    assert!(page.contains(">6.27</td>") && page.contains(">6.25</td>"), "roughness");
    let russian = text(&turned(SHAFT, &["--lang", "ru"]).page);
    assert!(russian.contains("<html lang=\"ru\">") && russian.contains("Обточенная поверхность отходит"));
    assert!(russian.contains("После исправления программы") && !russian.contains("Numbers"));
    // The same bytes: the folder alone, which the page names, is another.
    let again = turned(SHAFT, &["--section", "190", "--section", "290"]);
    assert_eq!(page.len(), text(&again.page).len());
}

#[test]
fn a_page_says_that_a_program_is_refused_and_where_nothing_is_turned() {
    // A thread over the bent shaft cannot be corrected; what the turning leaves is shown all the same.
    let page = text(
        &turned(&SHAFT.replace("M5\n", "X39.\nG32 Z-100. F1.5\nG0 X80.\nM5\n"), &["--accept", "0"]).page,
    );
    assert!(page.contains("vpost does not correct this program") && page.contains("VP0503"), "{page}");
    assert!(data_of(&page)["corrected"].is_null());
    let folder = tempfile::tempdir().expect("a temporary folder");
    let input = folder.path().join("shaft.nc");
    std::fs::write(&input, SHAFT).expect("writable");
    let (input, page) = (input.to_str().expect("plain"), folder.path().join("p.html"));
    let html = page.to_str().expect("plain");
    let ran = run(&["predict", "--lathe", input, "-m", LATHE, "--html", html, "--section", "900"]);
    assert!(!ran.status.success() && messages(&ran).contains("nothing is turned at `--section 900`"));
    assert!(!page.exists());
    let over = run(&["predict", "--lathe", input, "-m", LATHE, "--html", input]);
    assert!(!over.status.success() && messages(&over).contains("VP0004"), "{}", messages(&over));
}

#[test]
fn the_page_of_test_pieces_says_what_their_report_says() {
    let page = text(&pieces(&[]).page);
    let data = data_of(&page);
    assert_eq!(data["made"]["files"].as_array().map(Vec::len), Some(2));
    let cone = number(&data["terms"][0]["value"]);
    // 280 mm, on the diameter.
    let head = page.split("<nav").next().expect("a head");
    let said = format!(
        "it is a cone, {:.1}\u{a0}\u{b5}m thicker on the diameter at the chuck",
        2.0 * 280.0 * cone * 1e-3
    );
    assert!(head.contains(&said), "{said}: {head}");
    assert!(head.contains("5 of them, 15.1\u{a0}\u{2192}\u{a0}0.38"), "{head}");
    assert!(head.contains("Wear and growth cannot be told apart by these parts: add the column time_s"));
    // Both kinds of reading are drawn: twelve that were fitted, five that were not.
    let dots = |class: &str| {
        let path = page.split(&format!("class=\"dots {class}\"")).nth(1).expect("dots");
        path.split('>').next().expect("a path").matches("h0").count()
    };
    assert_eq!((dots("s0"), dots("s1")), (12, 5));
    let russian = text(&pieces(&["--lang", "ru"]).page);
    assert!(
        russian.contains("он конусный, у патрона толще") && russian.contains("По этим образцам не различить"),
        "{russian}"
    );
}

#[test]
fn the_page_of_a_diagnosis_says_what_the_summary_says() {
    let page = text(&diagnosis(-30.0, &[]).page);
    let data = data_of(&page);
    assert_eq!(
        (data["schema"].as_str(), data["verdict"].as_str()),
        (Some("vpost.diagnosis/1"), Some("NAMED"))
    );
    let head = page.split("<nav").next().expect("a head");
    assert!(head.contains("NAMED") && head.contains("The axis of the part leans against Z"), "{head}");
    assert!(head.contains("tailstock"), "what to do: {head}");
    let rows = number(&data["gap"]["rows"]) as usize;
    for class in ["s0", "s1"] {
        let path = page.split(&format!("class=\"dots {class}\"")).nth(1).expect("dots");
        assert_eq!(path.split('>').next().expect("a path").matches("h0").count(), rows, "{class}");
    }
    let russian = text(&diagnosis(-30.0, &["--lang", "ru"]).page);
    assert!(russian.contains("Ось детали наклонена к Z") && russian.contains("Радиусы деталей"), "{russian}");
    assert!(!russian.contains("Unseen") && !russian.contains("the causes"), "{russian}");
    let quiet = text(&diagnosis(0.0, &[]).page);
    assert!(quiet.contains("NO GAP") && quiet.contains("Nothing but noise is left"), "{quiet}");
    assert_eq!(page.len(), text(&diagnosis(-30.0, &[]).page).len());
}

#[test]
fn pages_of_lathes_open_print_and_fit_a_telephone() {
    let Some(mut browser) = Browser::start() else { return };
    let russian = ["--lang", "ru"];
    let reports = [
        (turned(SHAFT, &[]), 5, 4),
        (turned(SHAFT, &russian), 5, 4),
        (pieces(&[]), 4, 1),
        (diagnosis(-30.0, &russian), 4, 2),
    ];
    for (report, sections, drawings) in reports {
        opens_prints_and_fits(&mut browser, &report, sections, drawings, 1..8);
    }
    browser.end();
}

#[test]
fn nothing_in_a_turning_program_can_act() {
    let act = "document.documentElement.id='acted'";
    let comment = format!("(<script>{act}</script> <img src=x onerror={act}>)");
    // The refused block stands on the page as it stands in the program.
    let thread = format!("X39.\nG32 Z-100. F1.5 {comment}\nG0 X80.\nM5\n");
    let report = turned(&SHAFT.replace("M5\n", &thread), &["--accept", "0"]);
    let page = text(&report.page);
    assert_eq!(page.matches("<script").count(), 1, "the data block is the only one");
    assert!(page.contains("&lt;script&gt;"), "{page}");
    nothing_acted(Browser::start(), &report);
}
