//! What is said in Russian is all Russian, and says the same as the English.

use crate::browser_lathe::{LATHE, SHAFT, written_pieces};
use crate::common::{files, messages, root, run};

const DIALECTS: [&str; 6] = ["fanuc", "perspektiva", "linuxcnc", "balt-system", "sinumerik", "centroid"];
const PROFILE: &str = "tests/profiles/corpus.toml";

/// What people read of a message: its lines without those of the program and without what stands in backticks.
fn words(said: &str) -> String {
    let quoted = |line: &str| {
        let line = line.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ');
        line.starts_with("| ") && !line.contains('^') || line.starts_with("--> ")
    };
    let lines = said.lines().filter(|line| !quoted(line) && !line.trim_start().starts_with("-->"));
    let text = lines.collect::<Vec<_>>().join("\n");
    text.split('`').step_by(2).collect::<Vec<_>>().join("`")
}

/// The first three Latin words in a row that are no codes, names in capitals, keys, options or paths.
fn latin_sentence(text: &str) -> Option<String> {
    let is_prose = |word: &&str| {
        let word = word.trim_matches(|c: char| c.is_ascii_punctuation() || c == '«' || c == '»');
        word.len() > 1
            && word.bytes().all(|byte| byte.is_ascii_alphabetic() || byte == b'\'')
            && !word.bytes().all(|byte| byte.is_ascii_uppercase())
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    // A list of keys or units is no sentence.
    let goes_on = |three: &&[&str]| three[..2].iter().all(|word| !word.ends_with(','));
    let found = words.windows(3).filter(goes_on).find(|three| three.iter().all(is_prose));
    found.map(|three| three.join(" "))
}

fn codes(said: &str) -> Vec<&str> {
    said.match_indices("[VP").map(|(at, _)| &said[at + 1..at + 7]).collect()
}

fn places(said: &str) -> Vec<&str> {
    said.lines().filter_map(|line| line.trim_start().strip_prefix("--> ")).collect()
}

/// Both outputs: what is wrong with the Russian, if anything.
pub(crate) fn fault(english: &str, russian: &str) -> Option<String> {
    if codes(english) != codes(russian) || places(english) != places(russian) {
        return Some("other codes or places".to_owned());
    }
    let words = words(russian);
    if words.contains("error[") || words.contains("warning[") || words.contains("help:") {
        return Some("an English title".to_owned());
    }
    latin_sentence(&words)
}

#[test]
fn a_latin_sentence_is_found_and_names_are_none() {
    assert_eq!(latin_sentence("ошибка: the arc has no centre").as_deref(), Some("the arc has"));
    assert_eq!(decimal_point("шум 1,2 мкм\nвсего 10.5 мкм"), Some("всего 10.5 мкм"));
    assert_eq!(decimal_point("G1 X10.5 F200\nversion 0.1.0 и"), None);
    let fine = "напишите G90 G0 X10 раздел [tool] профиля CUTTING_EDGE_DEFAULT MD TRANS ATRANS, Renishaw XL";
    assert_eq!(latin_sentence(fine), None);
}

#[test]
fn refusals_of_the_corpus_are_said_in_russian() {
    let (mut failed, mut count, mut seen) = (Vec::new(), 0, std::collections::BTreeSet::new());
    for dialect in DIALECTS {
        for path in files(&root().join("tests/corpus").join(dialect).join("reject"), &["nc", "ngc"]) {
            count += 1;
            let program = path.to_str().expect("a plain path");
            let options = [program, "-m", PROFILE, "-d", dialect];
            let english = messages(&run(&options));
            let russian = messages(&run(&[&options[..], &["--lang", "ru"]].concat()));
            seen.extend(codes(&russian).into_iter().map(str::to_owned));
            if let Some(fault) = fault(&english, &russian) {
                failed.push(format!("{program}: {fault}\n{russian}"));
            }
        }
    }
    assert!(failed.is_empty(), "{} of {count} programs:\n{}", failed.len(), failed.join("\n"));
    assert!(count > 250 && seen.len() > 50, "only {count} programs, {} codes", seen.len());
}

#[test]
fn help_and_wrong_arguments_are_said_in_russian() {
    for command in [
        &[][..],
        &["correct"],
        &["batch"],
        &["batch", "run"],
        &["check"],
        &["calibrate", "tracker"],
        &["map"],
    ] {
        let ran = run(&[command, &["--help", "--lang", "ru"]].concat());
        let help = String::from_utf8_lossy(&ran.stdout).into_owned();
        assert!(ran.status.success() && help.contains("Запуск: vpost"), "{command:?}\n{help}");
        assert!(
            !["Usage", "Options:", "Commands:", "Arguments:"].iter().any(|word| help.contains(word)),
            "{help}"
        );
        let told = help.lines().filter(|line| !line.contains("vpost "));
        let told = told.collect::<Vec<_>>().join("\n");
        assert_eq!(latin_sentence(&told), None, "{command:?}\n{help}");
    }
    let cases: [(&[&str], &str); 6] = [
        (&["part.nc", "--machin", "x"], "ключ `--machin` незнаком"),
        (&["check", "part.nc"], "не хватает: <OUT.nc>"),
        (&["check", "a.nc", "b.nc", "--force"], "ключ `--force` незнаком"),
        (&["check", "a.nc", "b.nc", "--guard"], "`vpost check` не читает `--guard`"),
        (&["part.nc", "--color", "pink"], "`--color <COLOR>`: значения `pink` нет; есть auto, always, never"),
        (&["batch", "frobnicate-it", "--nothing"], "ключ `--nothing` незнаком"),
    ];
    for (arguments, expected) in cases {
        let ran = run(&[arguments, &["--lang", "ru"]].concat());
        let said = messages(&ran);
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}\n{said}");
        assert!(said.starts_with("ошибка: ") && said.contains(expected), "{arguments:?}\n{said}");
        assert_eq!(latin_sentence(&said), None, "{arguments:?}\n{said}");
    }
}

/// What is read of a page: its texts, one a line, and those of its drawings; none of its script, styles and data.
fn texts_of(page: &str) -> String {
    let mut text = String::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        text.push_str(&rest[..start]);
        text.push('\n');
        let tag = &rest[start..];
        let silent = ["script", "style"].into_iter().find(|name| tag[1..].starts_with(name));
        let end = match silent {
            Some(name) => {
                let close = format!("</{name}>");
                tag.find(&close).map_or(tag.len(), |at| at + close.len())
            }
            None => tag.find('>').map_or(tag.len(), |at| at + 1),
        };
        for attribute in ["aria-label=\"", "title=\""] {
            for said in tag[..end].split(attribute).skip(1).filter(|_| silent.is_none()) {
                text.push_str(said.split('"').next().unwrap_or_default());
                text.push('\n');
            }
        }
        rest = &tag[end..];
    }
    text + rest
}

/// Names of machines in samples, and of the manuals that tables cite.
const NAMES: [&str; 8] = [
    "Generic VMC as a field (invented errors)",
    "Mill with a crooked tilting table",
    "Tilting rotary table",
    "vpost calibrate",
    "vpost predict",
    "Mill Operator's Manual",
    "Programming Manual Cycles",
    "Default to Float",
];

/// Every line without a Latin sentence; the first that has one.
fn latin_line(text: &str) -> Option<&str> {
    text.lines().find(|line| {
        let line = NAMES.iter().fold((*line).to_owned(), |line, name| line.replace(name, ""));
        latin_sentence(&line).is_some()
    })
}

/// The first line with a decimal point in a number before a Russian word, as its unit.
fn decimal_point(text: &str) -> Option<&str> {
    let is_pointed = |word: &str| {
        let number = word.trim_matches(|c: char| !c.is_ascii_digit());
        number.contains('.') && number.parse::<f64>().is_ok()
    };
    let is_russian = |word: &str| word.starts_with(|c: char| ('а'..='я').contains(&c) || c == '%');
    text.lines().find(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.windows(2).any(|two| is_pointed(two[0]) && is_russian(two[1]))
    })
}

#[test]
fn results_and_pages_are_said_in_russian() {
    const STAN: &str = "machine-profiles/stan_s500.toml";
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    let (page, viewer, out) = (at("page.html"), at("viewer.html"), at("out.nc"));
    let plate = ["samples/plate_linuxcnc.nc", "-m", STAN, "-d", "linuxcnc"];
    assert!(run(&[&plate[..], &["-o", &out]].concat()).status.success());
    let shaft = at("shaft.nc");
    std::fs::write(&shaft, SHAFT).expect("writable");
    let [lathe, parts, third] = written_pieces(folder.path());
    let tracker = ["x", "y", "z"].map(|axis| format!("machine-profiles/stan_s500/tracker_48_{axis}.csv"));
    let [x, y, z] = tracker.each_ref().map(String::as_str);
    let mill = "[w X Y b Z t]";
    let commands: &[&[&str]] = &[
        &["calibrate", "ballbar", "samples/calibration/ballbar_circles.csv", "--html", &page],
        &[
            "calibrate",
            "ballbar",
            "samples/calibration/ballbar_ac.csv",
            "--chain",
            "[w C A X Y b Z t]",
            "--crossing",
            "250,150,-300",
            "--after",
            "samples/calibration/ballbar_ac_compensated.csv",
            "--html",
            &page,
        ],
        &["calibrate", "interferometer", "samples/calibration/iso230_2_muts_2022.csv", "--html", &page],
        &[
            "calibrate",
            "rtest",
            "samples/calibration/rtest_bc.csv",
            "-m",
            "samples/profiles/table_bc.toml",
            "--holdout",
            "samples/calibration/rtest_bc_unseen.csv",
        ],
        &["calibrate", "tracker", x, y, z, "--chain", mill, "--against", STAN],
        &[
            "calibrate",
            "volumetric",
            "samples/calibration/volume_points.csv",
            "--chain",
            mill,
            "--nodes",
            "4",
        ],
        &["map", "-m", STAN, "--grid", "9x9x9", "--clamp", "120,80,40", "--second-order", "--html", &page],
        &["map", "-m", STAN, "--grid", "5x5x5", "--viewer", &viewer],
        &["map", "-m", "samples/field/generic_vmc_field.toml", "--grid", "5x5x5", "--html", &page],
        &["budget", "-m", STAN, "--target", "100", "--keep", "EXX,EYY", "--grid", "3x3x3"],
        &[
            "budget",
            "-m",
            "samples/budget/ms300_like.toml",
            "--points",
            "samples/budget/ball_points.csv",
            "--target",
            "1",
        ],
        &["check", plate[0], &out, "-m", STAN, "-d", "linuxcnc", "--html", &page, "--viewer", &viewer],
        &["check", plate[0], plate[0], "-m", STAN, "-d", "linuxcnc", "--html", &page],
        &[
            "diagnose",
            "samples/diagnosis/squareness_and_scale.csv",
            "-m",
            "samples/diagnosis/squareness_and_scale.toml",
            "--holdout",
            "samples/diagnosis/squareness_and_scale_holdout.csv",
            "--html",
            &page,
            "--viewer",
            &viewer,
        ],
        &[
            "diagnose",
            "samples/diagnosis/one_feed.csv",
            "-m",
            "samples/diagnosis/one_feed.toml",
            "--html",
            &page,
        ],
        &[
            "diagnose",
            "samples/diagnosis/nothing.csv",
            "-m",
            "samples/diagnosis/nothing.toml",
            "--html",
            &page,
        ],
        &["predict", "--lathe", &shaft, "-m", LATHE, "--section", "190", "--html", &page],
        &["calibrate", "turning", &parts, "-m", &lathe, "--holdout", &third, "--html", &page],
        &["diagnose", &parts, "-m", &lathe],
        &["profile", "show", STAN],
        &["profile", "show", "samples/profiles/tilting_table.toml"],
        &["profile", "show", "machine-profiles/generic_lathe.toml"],
        &["profile", "show", "samples/field/generic_vmc_field.toml"],
        &["profile", "show", "tests/profiles/five_axis.toml"],
        &["grammar", "list"],
    ];
    let mut failed = Vec::new();
    for command in commands {
        let ran = run(&[command, &["--lang", "ru"][..]].concat());
        let printed = String::from_utf8_lossy(&ran.stdout).into_owned();
        assert!(ran.status.code().is_some_and(|code| code < 2), "{command:?}\n{}", messages(&ran));
        let mut said = vec![("messages", words(&messages(&ran)))];
        // Rows of numbers under the keys of the contract.
        if command[0] != "predict" {
            assert!(printed.chars().any(|c| ('а'..='я').contains(&c)), "{command:?}\n{printed}");
            said.push(("printed", printed));
        }
        for (file, name) in [(&page, "page"), (&viewer, "viewer")] {
            if let Some(html) = command.contains(&file.as_str()).then(|| std::fs::read_to_string(file)) {
                let html = html.expect("written");
                assert!(html.contains("<html lang=\"ru\">"), "{command:?}");
                let text = texts_of(&html);
                failed.extend(decimal_point(&text).map(|line| format!("{command:?}, {name}: {line}")));
                said.push((name, text));
            }
        }
        for (what, text) in said {
            failed.extend(latin_line(&text).map(|line| format!("{command:?}, {what}: {line}")));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn a_language_is_asked_for_or_the_locale_says_it() {
    let said = |locale: &str, more: &[&str]| {
        let mut command = crate::common::vpost();
        command.env("LC_ALL", locale).args(["no-such.nc", "-m", PROFILE]).args(more);
        messages(&command.output().expect("the command starts"))
    };
    assert!(said("C", &[]).starts_with("error[VP0001]"));
    assert!(said("ru_RU.UTF-8", &[]).starts_with("ошибка[VP0001]"), "{}", said("ru_RU.UTF-8", &[]));
    assert!(said("ru_RU.UTF-8", &["--lang", "en"]).starts_with("error[VP0001]"));
    assert!(said("no_such", &[]).starts_with("error[VP0001]"));
    let wrong = said("C", &["--lang", "xx"]);
    assert!(wrong.starts_with("error[VP0002]") && wrong.contains("`--lang ru`"), "{wrong}");
    let wrong = said("ru", &["--lang", "xx"]);
    assert!(wrong.starts_with("ошибка[VP0002]") && wrong.contains("`--lang ru`"), "{wrong}");
}

/// What issue 20 calls bad input, each with words of its own in both languages.
#[test]
fn bad_input_is_said_in_both_languages() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    };
    let no_axes =
        at("no_axes.ini", "[EMC]\nMACHINE = mill\n[TRAJ]\nLINEAR_UNITS = mm\nCOORDINATES = X Y Z\n");
    let turned = at("turned.ini", "[RS274NGC]\nPARAMETER_FILE = turned.var\n[TRAJ]\nLINEAR_UNITS = mm\n");
    at("turned.var", "5220 1\n5221 0\n5222 0\n5223 0\n5230 15\n");
    let far = at("far.ini", "[RS274NGC]\nPARAMETER_FILE = far.var\n[TRAJ]\nLINEAR_UNITS = inch\n");
    at("far.var", "5220 1\n5221 400\n5222 3\n5223 1\n");
    let program = at("in.ngc", "G21 G90 G94 G17 G54\nG0 X0 Y0 Z50\nG1 X10 F200\nM2\n");
    let job = |ini: &str| {
        [
            "correct",
            &program,
            "-m",
            "machine-profiles/stan_s500.toml",
            "-d",
            "linuxcnc",
            "--linuxcnc-ini",
            ini,
        ]
        .map(str::to_owned)
        .to_vec()
    };
    let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let cases: [(Vec<String>, i32, &str, &str); 6] = [
        (words("explain VP9999"), 2, "there is no message `VP9999`", "сообщения `VP9999` нет"),
        (words("explain arc"), 2, "there is no message `arc`", "сообщения `arc` нет"),
        (
            ["profile", "new", "--from", &no_axes].map(str::to_owned).to_vec(),
            1,
            "no axis of this INI file has limits",
            "ни у одной оси этого INI-файла нет пределов",
        ),
        (job(&no_axes), 1, "work offset G54 is not given", "смещение нуля G54 не задано"),
        (job(&turned), 1, "G54 is turned by 15 degrees about Z", "G54 повёрнуто вокруг Z на 15 градусов"),
        (
            job(&far),
            1,
            "the program's zero is at X 10160.000 mm: is the work offset",
            "нуль программы в X 10160.000 мм: смещение нуля",
        ),
    ];
    for (arguments, status, english, russian) in cases {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let [en, ru] = ["en", "ru"].map(|language| run(&[&arguments[..], &["--lang", language]].concat()));
        assert_eq!((en.status.code(), ru.status.code()), (Some(status), Some(status)), "{arguments:?}");
        let (en, ru) = (messages(&en), messages(&ru));
        assert!(en.contains(english), "{arguments:?}: {en}");
        assert!(ru.contains(russian), "{arguments:?}: {ru}");
        assert_eq!(fault(&en, &ru), None, "{arguments:?}: {ru}");
    }
}
