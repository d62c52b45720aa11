//! `vpost.html`, the command in a page: the command's bytes, no network, a person's way by the keyboard.
//!
//! The page is made by `cargo xtask page` (minutes), into `target/page` or where `VPOST_PAGE` says. Where it is not
//! there the tests say that they were skipped.

use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::browser_pages::{axe, faults};
use crate::common::{SAMPLES, files, root};
use crate::devtools::{Browser, View, decoded};

/// A machine as it was measured, with six tables.
const STAN: &str = "machine-profiles/stan_s500.toml";

/// The page, and a browser for it.
#[expect(clippy::print_stdout, reason = "whoever tests is told")]
fn opened() -> Option<Browser> {
    let page =
        std::env::var_os("VPOST_PAGE").map_or_else(|| root().join("target/page/vpost.html"), PathBuf::from);
    if !page.is_file() {
        println!("skipped: cargo xtask page makes {}", page.display());
        return None;
    }
    let mut browser = Browser::start()?;
    browser.open(&page);
    browser.wait("described.size > 0");
    Some(browser)
}

/// The bytes of a file that the page holds.
fn held(browser: &mut Browser, name: &str) -> Vec<u8> {
    let script = format!(
        "(async () => {{ const blob = files.get({name:?}); const read = new FileReader(); \
         if (!blob) return [...files.keys()].join(); \
         await new Promise(done => {{ read.onload = done; read.readAsDataURL(blob); }}); return read.result; }})()"
    );
    let read = browser.evaluate(&script);
    let read = read.as_str().expect("a text");
    decoded(read.split_once(";base64,").unwrap_or_else(|| panic!("{name} is not among {read}")).1)
}

/// A file with the files that a profile names, as they lie in the folder.
fn with_tables(folder: &Path, profile: &str) -> Vec<PathBuf> {
    let text = std::fs::read_to_string(folder.join(profile)).expect("a profile");
    let tables = text.split('"').filter(|quoted| quoted.ends_with(".csv"));
    let beside = folder.join(profile);
    let beside = beside.parent().expect("a folder");
    std::iter::once(folder.join(profile)).chain(tables.map(|table| beside.join(table))).collect()
}

/// Chooses files, sets options, runs a job, and waits for its end.
fn run_in(browser: &mut Browser, job: &str, given: &[PathBuf], options: &[(&str, &str)]) {
    browser.evaluate(&format!(
        "(files.clear(), made.clear(), typed.clear(), job = JOBS.find(each => each.id === {job:?}), show(), 0)"
    ));
    let given: Vec<&Path> = given.iter().map(PathBuf::as_path).collect();
    browser.choose("#picked", &given);
    browser.wait(&format!("files.size === {}", given.len()));
    for (name, value) in options {
        browser.evaluate(&format!("(typed.set({name:?}, {value:?}), 0)"));
    }
    browser.evaluate("(show(), by('status').textContent = '', by('run').click(), 0)");
    browser.wait("by('cancel').hidden && by('status').textContent");
}

/// Chooses a program `part.nc` and a machine, and corrects it; the folder that the page reads it from.
fn correct_in(browser: &mut Browser, profile: &str, text: &str, options: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.nc");
    std::fs::write(&program, text).expect("writable");
    let mut given = with_tables(&root(), profile);
    given.push(program);
    run_in(browser, "correct", &given, options);
    folder
}

/// A line of the shell in a folder in which the same files lie.
fn commanded(given: &[PathBuf], line: &str) -> (TempDir, Option<i32>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for path in given {
        std::fs::copy(path, folder.path().join(path.file_name().expect("a name"))).expect("copied");
    }
    // A page finds tables by their names where they lie without their folder.
    for path in given.iter().filter(|path| path.extension().is_some_and(|ending| ending == "toml")) {
        let text = std::fs::read_to_string(path).expect("a profile");
        for table in text.split('"').filter(|quoted| quoted.ends_with(".csv") && quoted.contains('/')) {
            let place = folder.path().join(table);
            std::fs::create_dir_all(place.parent().expect("a folder")).expect("made");
            std::fs::copy(path.parent().expect("a folder").join(table), place).expect("copied");
        }
    }
    // In a shell that finds the command under test.
    let mut path =
        std::ffi::OsString::from(Path::new(env!("CARGO_BIN_EXE_vpost")).parent().expect("a folder"));
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let mut shell = Command::new("sh");
    let ran =
        shell.args(["-c", line]).current_dir(folder.path()).env("PATH", path).env("LC_ALL", "C").output();
    let ran = ran.expect("a shell");
    (folder, ran.status.code())
}

/// `part.nc` as the page names what comes of it: `part_corrected.nc`.
fn named(path: &Path, addition: &str, ending: Option<&str>) -> String {
    let part = |part: Option<&std::ffi::OsStr>| part.expect("a name").to_string_lossy().into_owned();
    let own = part(path.extension());
    format!("{}_{addition}.{}", part(path.file_stem()), ending.unwrap_or(&own))
}

#[test]
fn a_page_corrects_samples_to_the_command_s_bytes() {
    let Some(mut browser) = opened() else { return };
    let five_axis = files(&root().join("samples/five_axis"), &["nc", "ngc", "mpf"]);
    let five_axis = five_axis.iter().filter_map(|path| {
        let name = path.file_name()?.to_string_lossy().into_owned();
        let dialect =
            ["fanuc", "linuxcnc", "sinumerik"].into_iter().find(|dialect| name.contains(dialect))?;
        Some((path.clone(), dialect, "samples/profiles/five_axis_table_table.toml"))
    });
    let samples = SAMPLES.map(|(path, dialect)| (root().join(path), dialect, STAN));
    let mut done = 0;
    for (program, dialect, profile) in samples.into_iter().chain(five_axis) {
        let mut given = with_tables(&root(), profile);
        given.push(program.clone());
        run_in(&mut browser, "correct", &given, &[("dialect", dialect)]);
        let [output, summary] =
            [named(&program, "corrected", None), named(&program, "summary", Some("json"))];
        let shown =
            browser.evaluate("[...document.querySelectorAll('#found > details pre')].at(-1).textContent");
        let shown = shown.as_str().expect("a command line").to_owned();
        let (folder, status) = commanded(&given, &shown);
        let said = browser.evaluate("by('status').className");
        assert_eq!(said == "good", status == Some(0), "{shown}: {said}, {status:?}");
        if status == Some(0) {
            for name in [&output, &summary] {
                let by_command = std::fs::read(folder.path().join(name)).expect("written");
                assert!(held(&mut browser, name) == by_command, "{name} differs");
            }
            done += 1;
        }
    }
    assert!(done >= 20, "{done} programs were corrected");
    browser.was_quiet();
    browser.end();
}

#[test]
fn a_page_diagnoses_maps_and_calibrates_as_the_command_line_that_it_shows() {
    let Some(mut browser) = opened() else { return };
    let place = |path: &str| root().join(path);
    let gap = vec![place("samples/diagnosis/backlash.csv"), place("samples/diagnosis/backlash.toml")];
    let traverses =
        ["x", "y", "z"].map(|axis| place(&format!("machine-profiles/stan_s500/tracker_315_{axis}.csv")));
    let tracked =
        [("calibrate", "tracker"), ("date", "2023-05-15"), ("name", "mill"), ("chain", "[w X Y b Z t]")];
    for (job, given, options) in [
        ("diagnose", gap, &[][..]),
        ("map", with_tables(&root(), STAN), &[("grid", "9x9x9")]),
        ("calibrate", traverses.to_vec(), &tracked),
    ] {
        run_in(&mut browser, job, &given, options);
        let found = browser.evaluate("by('found').textContent");
        assert_eq!(browser.evaluate("by('status').className"), "good", "{job}: {found}");
        let shown =
            browser.evaluate("[...document.querySelectorAll('#found > details pre')].at(-1).textContent");
        let (folder, status) = commanded(&given, shown.as_str().expect("a command line"));
        assert_eq!(status, Some(0), "{shown}");
        let made = browser.evaluate("[...made.keys()].join()");
        let made: Vec<&str> = made.as_str().expect("names").split(',').collect();
        assert!(made.len() > 1, "{job}: {made:?}");
        for name in made {
            let by_command = std::fs::read(folder.path().join(name)).expect("written");
            assert!(held(&mut browser, name) == by_command, "{job}: {name} differs");
        }
    }
    browser.was_quiet();
    browser.end();
}

/// Focus on an element by the Tab key alone.
fn tab_to(browser: &mut Browser, selector: &str) {
    for _ in 0..200 {
        if browser.evaluate(&format!("document.activeElement?.matches({selector:?}) ?? false")) == true {
            return;
        }
        browser.press("Tab");
    }
    panic!("no Tab leads to {selector}");
}

/// From nothing to a corrected program: a profile by its form, typed measurements, a diagnosis, a correction.
#[test]
fn a_person_without_a_profile_comes_to_a_corrected_program_by_the_keyboard() {
    let Some(mut browser) = opened() else { return };
    let press = |browser: &mut Browser, selector: &str, key: &str| {
        tab_to(browser, selector);
        browser.press(key);
    };
    let job = |browser: &mut Browser, name: &str| {
        let at = browser.evaluate(&format!("1 + JOBS.findIndex(each => each.id === {name:?})"));
        press(browser, &format!("#jobs button:nth-child({at})"), "Enter");
    };
    let write = |browser: &mut Browser, selector: &str, text: &str| {
        tab_to(browser, selector);
        browser.write(text);
    };
    let run = |browser: &mut Browser| {
        browser.evaluate("(by('status').textContent = '', 0)");
        press(browser, "#run", "Enter");
        browser.wait("by('cancel').hidden && by('status').textContent");
        let found = browser.evaluate("by('status').className + ' ' + by('found').textContent");
        assert!(found.as_str().is_some_and(|found| found.starts_with("good")), "{found}");
    };
    job(&mut browser, "profile_new");
    write(&mut browser, "#field-name", "Mill 7");
    tab_to(&mut browser, "#field-control");
    browser.write("linuxcnc");
    browser.evaluate("(typed.set('control', 'linuxcnc'), 0)");
    press(&mut browser, "input[name=chain]", " ");
    write(&mut browser, "#field-travel", "X=0..500\nY=0..400\nZ=0..300");
    run(&mut browser);
    let profile = String::from_utf8(held(&mut browser, "machine.toml")).expect("text");
    assert!(profile.contains("Mill 7") && profile.contains("linuxcnc"), "{profile}");

    // A square against X and Y: Y leans by 200 urad, read at every 50 mm, twice.
    let mut rows = "run,x_mm,y_mm,z_mm,dx_um,dy_um,repeat\n".to_owned();
    for repeat in 1..=3 {
        for at in 0..8 {
            let noise = f64::from((at * 7 + repeat * 3) % 5 - 2) * 0.2;
            rows += &format!(
                "Y{repeat},250,{y},0,{dx:.1},,{repeat}\n",
                y = at * 50,
                dx = -0.2 * f64::from(at * 50) + noise
            );
            rows += &format!("X{repeat},{x},200,0,,{dy:.1},{repeat}\n", x = at * 50, dy = noise);
        }
    }
    press(&mut browser, "#drop > details > summary", "Enter");
    write(&mut browser, "#typed-name", "square.csv");
    write(&mut browser, "#typed-text", &rows);
    press(&mut browser, "#typed-take", "Enter");
    write(&mut browser, "#typed-name", "");
    browser.evaluate("(by('typed-name').value = 'part.ngc', by('typed-text').value = '', 0)");
    write(
        &mut browser,
        "#typed-text",
        "G21 G90 G17 G54 G61\nG0 X10 Y10 Z50\nG1 Z1 F300\nG1 X10 Y300 F600\nG1 X300 Y300\nG0 Z50\nM2\n",
    );
    press(&mut browser, "#typed-take", "Enter");
    job(&mut browser, "diagnose");
    run(&mut browser);
    let diagnosis = String::from_utf8(held(&mut browser, "square_diagnosis.json")).expect("text");
    assert!(diagnosis.contains("squareness.XY"), "{diagnosis}");
    browser.evaluate("(typed.set('machine', 'square_profile.toml'), 0)");
    job(&mut browser, "correct");
    // It asks where the program's zero lies; the answer is begun by its button.
    browser.evaluate("(by('status').textContent = '', 0)");
    press(&mut browser, "#run", "Enter");
    browser.wait("by('cancel').hidden && by('status').className === 'error'");
    press(&mut browser, ".question button", "Enter");
    assert_eq!(browser.evaluate("document.activeElement.id"), "field-work-offset");
    browser.evaluate("document.activeElement.select()");
    browser.write("G54=20,20,100");
    run(&mut browser);
    let corrected = String::from_utf8(held(&mut browser, "part_corrected.ngc")).expect("text");
    // 200 urad over 290 mm: 58 um.
    assert!(corrected.contains("X10.0") && corrected.contains("Y300"), "{corrected}");
    assert!(!held(&mut browser, "part_corrected_check.html").is_empty());
    browser.was_quiet();
    browser.end();
}

#[test]
fn the_page_has_no_fault_of_accessibility() {
    let (Some(mut browser), Some(axe)) = (opened(), axe()) else { return };
    let pictures = root().join("target/pictures");
    std::fs::create_dir_all(&pictures).expect("writable");
    for language in ["en", "ru"] {
        browser.evaluate(&format!("speak({language:?})"));
        browser.wait(&format!("document.documentElement.lang === {language:?}"));
        browser
            .evaluate("(files.clear(), typed.clear(), typed.set('dialect', 'linuxcnc'), job = JOBS[0], 0)");
        browser.evaluate("(by('example').click(), by('status').textContent = '', by('run').click(), 0)");
        browser.wait("by('cancel').hidden && by('status').textContent && by('looked')");
        for (name, view) in [
            ("desk", View::DESK),
            ("dark", View::DARK),
            ("tablet", View { width: 820, ..View::DESK }),
            ("phone", View::PHONE),
            ("dark-phone", View::DARK_PHONE),
        ] {
            browser.look(View { is_calm: true, ..view });
            let found = faults(&mut browser, &axe, &[]);
            assert!(found.is_empty(), "{language} {name}: {found:#?}");
            let wide = browser.evaluate("document.documentElement.scrollWidth <= innerWidth");
            assert_eq!(wide, true, "{language} {name}: wider than the screen");
            for (at, picture) in browser.whole_picture().into_iter().enumerate() {
                std::fs::write(pictures.join(format!("alone-{language}-{name}-{at}.png")), picture)
                    .expect("writable");
            }
        }
    }
    browser.end();
}

#[test]
fn what_cannot_be_done_is_said_in_the_page() {
    let Some(mut browser) = opened() else { return };
    let place = |path: &str| root().join(path);
    // No profile; two profiles; a profile without its tables; an archive that is none.
    run_in(&mut browser, "correct", &[place("samples/helix_linuxcnc.ngc")], &[]);
    assert_eq!(browser.evaluate("by('status').textContent"), "Needed: machine profile. Drop the file above.");
    let two = [place("samples/helix_linuxcnc.ngc"), place(STAN), place("machine-profiles/perfect.toml")];
    run_in(&mut browser, "correct", &two, &[]);
    assert_eq!(browser.evaluate("by('status').textContent"), "2 files could be machine profile: choose one.");
    run_in(&mut browser, "correct", &two[..2], &[("dialect", "linuxcnc")]);
    let found = browser.evaluate("by('status').className + ' ' + by('found').textContent");
    let found = found.as_str().expect("a text");
    assert!(found.starts_with("error") && found.contains("stan_s500/interferometer_x.csv"), "{found}");
    // A file that changes behind the page's back is not corrected from two halves.
    let folder = correct_in(&mut browser, STAN, "G21 G90 G17 G54\nG1 X1 F100\n", &[("dialect", "linuxcnc")]);
    std::fs::write(folder.path().join("part.nc"), "G21 G90 G17 G54\nG1 X2 F100\nG1 X3\n").expect("writable");
    browser.evaluate("(by('status').textContent = '', by('run').click(), 0)");
    browser.wait("by('cancel').hidden && by('status').textContent");
    assert_eq!(
        browser.evaluate("by('status').textContent"),
        "part.nc cannot be read: it may have been changed or moved. Drop it again."
    );
    let archive = folder.path().join("parts.zip");
    std::fs::write(&archive, "no archive").expect("writable");
    browser.choose("#picked", &[&archive]);
    browser.wait("!by('list-said').hidden");
    let said = browser.evaluate("by('list-said').textContent");
    assert!(
        said.as_str().is_some_and(|said| said.starts_with("parts.zip: this archive is damaged")),
        "{said}"
    );
    browser.was_quiet();
    browser.end();
}

/// What the command asks for is one click away in the page.
#[test]
fn a_question_is_answered_by_a_click() {
    let Some(mut browser) = opened() else { return };
    let text = "G21 G90 G17 G54\nG0 X10. Y10. Z50\nG1 Z1. F300\nG1 X100. Y80.\nM30\n";
    let _given = correct_in(&mut browser, "machine-profiles/generic_vmc.toml", text, &[]);
    let said = browser.evaluate("by('status').className + ' ' + by('status').textContent");
    assert!(said.as_str().is_some_and(|said| said.starts_with("error")), "{said}");
    browser.evaluate(
        "(by('status').textContent = '', [...document.querySelectorAll('.question button')]
        .find(button => button.textContent === '--decimal millimetres').click(), 0)",
    );
    browser.wait("by('cancel').hidden && by('status').textContent");
    let said = browser.evaluate("by('found').textContent");
    assert_eq!(browser.evaluate("by('status').className"), "good", "{said}");
    browser.was_quiet();
    browser.end();
}

/// Found by an outside hand: what was made before stays, and what another folder has is nobody's.
#[test]
fn a_page_takes_and_loses_nothing_by_its_name_alone() {
    let Some(mut browser) = opened() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(&path, text).expect("writable");
        path
    };
    let text = "G21 G90 G17 G54 G61\nG0 X10 Y10 Z50\nG1 Z30 F300\nG1 X60 Y50\nM2\n";
    let mut given = with_tables(&root(), STAN);
    given.push(write("p.ngc", text));
    run_in(&mut browser, "correct", &given, &[("dialect", "linuxcnc"), ("zero", "true")]);
    let first = held(&mut browser, "p_corrected.ngc");
    let again = |browser: &mut Browser, option: &str, value: &str| {
        browser.evaluate(&format!("(typed.set({option:?}, {value:?}), show(), 0)"));
        browser.evaluate("(by('status').textContent = '', by('run').click(), 0)");
        browser.wait("by('cancel').hidden && by('status').textContent");
    };
    // A refusal leaves what was there.
    again(&mut browser, "work-offset", "G54=9000,9000,9000");
    assert_eq!(browser.evaluate("by('status').className"), "error");
    assert!(held(&mut browser, "p_corrected.ngc") == first);
    // A program of the same name and another ending has a summary of its own.
    let other = write("p.nc", text);
    browser.choose("#picked", &[&other]);
    browser.wait("files.has('p.nc')");
    browser.evaluate("(typed.delete('work-offset'), typed.set('correct input', 'p.nc'), 0)");
    again(&mut browser, "zero", "true");
    let summary = String::from_utf8(held(&mut browser, "p_summary_2.json")).expect("text");
    assert!(summary.contains("\"p.nc\""), "{summary}");
    // The same file anew is said.
    browser.choose("#picked", &[&other]);
    browser.wait("!by('list-said').hidden");
    let said = browser.evaluate("by('list-said').textContent");
    assert!(said.as_str().is_some_and(|said| said.starts_with("p.nc was there already")), "{said}");
    // Tables and settings of a folder are not another's.
    let profile = std::fs::read_to_string(root().join(STAN)).expect("a profile");
    let in_page = format!(
        "(files.clear(), typed.clear(), files.set('A/mill.toml', new Blob([{profile:?}])), \
         files.set('B/stan_s500/interferometer_x.csv', new Blob(['position_mm,EXX_um\\n0,0\\n'])), \
         files.set('B/vpost.toml', new Blob(['work-offset = \"G54=1,2,3\"'])), \
         files.set('A/part.ngc', new Blob([{text:?}])), job = JOBS[0], typed.set('machine', 'A/mill.toml'), 0)"
    );
    browser.evaluate(&in_page);
    again(&mut browser, "dialect", "linuxcnc");
    let found = browser.evaluate("by('found').textContent");
    let found = found.as_str().expect("a text");
    assert!(found.contains("cannot read the table stan_s500/interferometer_x.csv"), "{found}");
    assert!(!found.contains("was taken from"), "{found}");
    // The only profile there is no answer where settings name another.
    browser.evaluate("(files.set('A/vpost.toml', new Blob(['machine = \"other.toml\"'])), typed.clear(), 0)");
    again(&mut browser, "dialect", "linuxcnc");
    let found = browser.evaluate("by('found').textContent");
    assert!(found.as_str().is_some_and(|found| found.contains("cannot read A/other.toml")), "{found}");
    browser.was_quiet();
    browser.end();
}

/// An example's number is nobody's answer: the field waits for a person.
#[test]
fn a_number_of_an_example_is_left_to_be_said() {
    let Some(mut browser) = opened() else { return };
    let text = "G21 G90 G17 G54\nG43 H7\nG0 X10 Y10 Z50\nG1 Z30 F300\nM2\n";
    let _given = correct_in(&mut browser, STAN, text, &[("dialect", "linuxcnc")]);
    let buttons = "[...document.querySelectorAll('.question button')]";
    browser.evaluate(&format!("({buttons}.find(one => one.textContent.startsWith('--tool H7')).click(), 0)"));
    assert_eq!(browser.evaluate("document.activeElement.id"), "field-tool");
    assert_eq!(browser.evaluate("document.activeElement.value"), "H7=…");
    browser.end();
}

/// What is dropped is taken; what the browser gives no page from the disk is said, with the way to it.
#[test]
fn a_page_takes_what_is_dropped_on_it() {
    let Some(mut browser) = opened() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.nc");
    std::fs::write(&program, "G21 G90\nM30\n").expect("writable");
    let profile = root().join("machine-profiles/perfect.toml");
    browser.drag("#drop", &[&program, &profile]);
    browser.wait("[...files.keys()].join() === 'part.nc,perfect.toml'");
    assert_eq!(held(&mut browser, "part.nc"), b"G21 G90\nM30\n");
    assert_eq!(browser.evaluate("by('list-said').textContent"), "");
    browser.drag("#drop", &[folder.path()]);
    browser.wait("by('list-said').textContent.includes('Choose a folder')");
    browser.was_quiet();
    browser.end();
}
