//! The list of codes in `docs/dialects.md`: what becomes of each code, and the program or test that shows it.
//!
//! A program of the corpus proves a row by what the code does in it: the motion under it is corrected, or
//! left alone; the program without it means something else, or the same; it is what the refusal names. The
//! list is written from the tables and from the proofs found: `VPOST_UPDATE_DOCS=1` writes it.

use std::fmt::Write;
use std::path::Path;

use nc_dialect::{Dialect, Row, Rows, Treatment, rows};
use nc_expand::Limits;
use nc_program::{Interpreter, Setup, Step};
use nc_syntax::{Block, GCode, ItemKind, Paren, Reader, Value};
use toolpath::Motion;

use crate::common::{files, messages, root, run};

const DOCUMENT: &str = "docs/dialects.md";
/// What stands above the list.
const MARK: &str = "<!-- tables -->\n";
/// In all others every row has its proof.
const UNPROVEN: [&str; 2] = ["balt-system", "heidenhain-iso"];
const PROFILE: &str = "tests/profiles/corpus.toml";
/// The work offset that this profile lacks.
const GIVEN: &str = "G57";

/// A work offset of the corpus' profile, chosen.
fn offset(dialect: &Dialect) -> &'static str {
    match dialect.name.as_str() {
        "okuma" => "G15 H1",
        "heidenhain-iso" => "G247",
        _ => "G54",
    }
}

/// The dialects of mills; of lathes there are no programs in the corpus as yet.
fn mills() -> impl Iterator<Item = &'static Dialect> {
    let names = nc_dialect::builtin_names().into_iter();
    names.filter_map(nc_dialect::builtin).filter(|dialect| dialect.turning.is_none())
}

/// A program of the corpus, executed as far as its motions.
struct Program {
    /// `accept/helix.nc`
    name: String,
    /// Program flow is executed; `None` where that is refused.
    flat: Option<Vec<u8>>,
    /// Flow was executed.
    flows: bool,
    /// Codes in it, as rows name them, before flow is executed.
    codes: Vec<String>,
    run: Run,
}

/// What a program makes of its blocks, up to the one that is refused.
#[derive(Clone, Debug, Default, PartialEq)]
struct Run {
    steps: Vec<Step>,
    refused: Option<(u16, String)>,
}

impl Program {
    fn read(path: &Path, dialect: &Dialect, setup: &Setup) -> Self {
        let text = std::fs::read(path).expect("readable");
        let folder = path.parent().and_then(Path::file_name).expect("a folder").to_string_lossy();
        let file = path.file_name().expect("a name").to_string_lossy();
        let nothing = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let environment = nc_expand::Environment {
            variables: &[],
            read_external: &nothing,
            setup,
            limits: Limits::default(),
        };
        let (flat, refused) = match nc_expand::expand(&text, dialect, &environment) {
            Ok(expanded) => (Some(expanded.text().to_vec()), None),
            Err(refusal) => {
                let first = &refusal.diagnostics[0];
                (None, Some((first.code.0, first.message.english().to_owned())))
            }
        };
        let run = match &flat {
            Some(flat) => interpret(flat, dialect, setup),
            None => Run { steps: Vec::new(), refused },
        };
        let flows = flat.as_deref().is_some_and(|flat| flat != text.as_slice());
        let mut codes: Vec<String> = words(&text, dialect).into_iter().map(|(code, _)| code).collect();
        codes.sort();
        codes.dedup();
        Self { name: format!("{folder}/{file}"), flat, flows, codes, run }
    }

    /// Number of executed blocks: the shorter a program, the better a proof.
    fn length(&self) -> usize {
        self.run.steps.len()
    }
}

/// Every code of a program as rows name it, with its bytes.
fn words(text: &[u8], dialect: &Dialect) -> Vec<(String, std::ops::Range<usize>)> {
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    let mut found = Vec::new();
    while reader.next(&mut block) {
        for item in &block.items {
            let span = block.file_span(item.span);
            let span = span.start as usize..span.end as usize;
            match item.kind {
                ItemKind::Word { letter: b'G', value: Value::Number(number) } => {
                    if let Some(tenths) = number.tenths() {
                        found.push((GCode(tenths).to_string(), span));
                    }
                }
                ItemKind::Word { letter: b'M', value: Value::Number(number) } => {
                    if let Some(number) = number.integer() {
                        found.push((format!("M{number}"), span));
                    }
                }
                ItemKind::BracketCommand => {
                    let name = dialect.command(block.text(item.span)).map(|row| row.name.clone());
                    found.push((name.unwrap_or_default(), span));
                }
                _ => {}
            }
        }
    }
    found
}

fn interpret(text: &[u8], dialect: &Dialect, setup: &Setup) -> Run {
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    let mut interpreter = Interpreter::new(dialect, setup);
    let mut run = Run::default();
    while reader.next(&mut block) {
        match interpreter.step(&block) {
            Ok(step) => run.steps.push(step),
            Err(refused) => {
                run.refused = Some((refused[0].code.0, refused[0].message.english().to_owned()));
                break;
            }
        }
    }
    run
}

/// The steps of the blocks that hold a code.
fn steps_with<'r>(program: &'r Program, code: &str, dialect: &Dialect) -> Vec<&'r Step> {
    let Some(flat) = &program.flat else { return Vec::new() };
    let (mut reader, mut block) = (Reader::new(flat, dialect), Block::default());
    let mut found = Vec::new();
    for step in &program.run.steps {
        if !reader.next(&mut block) {
            break;
        }
        if words(block.bytes, dialect).iter().any(|(has, _)| has == code) {
            found.push(step);
        }
    }
    found
}

/// What a program means where every word of a code is blank; `whole`: every block that has one.
fn without(program: &Program, code: &str, whole: bool, dialect: &Dialect, setup: &Setup) -> Option<Run> {
    let mut flat = program.flat.clone()?;
    for (_, span) in words(&flat, dialect).into_iter().filter(|(has, _)| has == code) {
        let (mut start, mut end) = (span.start, span.end);
        if whole {
            let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
            start = flat[..start].iter().rposition(is_end).map_or(0, |at| at + 1);
            end = flat[end..].iter().position(is_end).map_or(flat.len(), |length| end + length);
        }
        flat[start..end].fill(b' ');
    }
    Some(interpret(&flat, dialect, setup))
}

/// True where the program shows that the row is true.
fn proves(program: &Program, row: &Row, dialect: &Dialect, setup: &Setup) -> bool {
    if !program.codes.contains(&row.code) {
        return false;
    }
    let accepted = program.name.starts_with("accept/") && program.run.refused.is_none();
    let corrected = |motion: &Motion| !matches!(motion, Motion::Uncorrected { .. });
    match row.treatment {
        Treatment::Refused => {
            let Some((number, message)) = &program.run.refused else { return false };
            matches!(number, 208 | 224) && message.starts_with(&format!("{} is refused: ", row.code))
        }
        Treatment::Executed => accepted && program.flows,
        Treatment::Corrected => {
            accepted
                && program.run.steps.iter().any(|step| {
                    step.context.motion_code.is_some_and(|code| code.to_string() == row.code)
                        && step.motions.iter().any(corrected)
                })
        }
        Treatment::NotCorrected => {
            let steps = steps_with(program, &row.code, dialect);
            let mut motions = steps.iter().flat_map(|step| &step.motions).peekable();
            accepted && motions.peek().is_some() && !motions.any(corrected)
        }
        Treatment::Followed => {
            accepted
                && without(program, &row.code, false, dialect, setup).is_some_and(|run| run != program.run)
        }
        Treatment::Passed => {
            accepted
                && [false, true].into_iter().any(|whole| {
                    without(program, &row.code, whole, dialect, setup).is_some_and(|run| run == program.run)
                })
        }
    }
}

/// Shows every row that refuses its code.
const BY_ITS_ROW: &str = "`what_a_table_refuses_is_refused` in tests/dialects.rs";

/// The test of this file that shows what no program of the corpus can: where a code stands in the output,
/// and an offset that the corpus' profile lacks so that others can be refused for it.
fn named(row: &Row) -> Option<&'static str> {
    if row.note.starts_with("refused while a tool length is in force") {
        return Some("`tool_lengths_after_gost` in crates/nc-program/tests/rules.rs");
    }
    if row.treatment == Treatment::Passed && row.note.starts_with("executed after the motion") {
        return Some("`stops_stay_behind_the_motion` in tests/dialects.rs");
    }
    if row.treatment == Treatment::Followed
        && ["G43.4", "G234", "TRAORI", "TRAFOOF"].contains(&row.code.as_str())
    {
        return Some("`the_tip_goes_where_the_program_says` in tests/five_axis.rs");
    }
    if row.treatment == Treatment::Followed && row.code == "G43.5" {
        return Some("`vectors_are_cut_as_the_angles_are` in tests/orientation.rs");
    }
    if row.treatment == Treatment::Refused && !row.note.starts_with("with more than") {
        return Some(BY_ITS_ROW);
    }
    if row.treatment == Treatment::Corrected
        && ["G5", "G5.1", "G5.2", "G5.3", "G6.2"].contains(&row.code.as_str())
    {
        return Some("`lines_follow_the_exact_curve` in tests/curves.rs");
    }
    if row.treatment == Treatment::Followed && row.code == "G68.2" {
        return Some("`in_a_tilted_plane_the_tip_goes_where_the_program_says` in tests/five_axis.rs");
    }
    if row.treatment == Treatment::Followed && ["G53.1", "G53.6"].contains(&row.code.as_str()) {
        return Some("`g53_1_turns_by_the_rule_of_the_profile_or_not_at_all` in tests/five_axis.rs");
    }
    if row.treatment == Treatment::Followed && ["G254", "G255"].contains(&row.code.as_str()) {
        return Some("`g254_is_the_plane_on_which_the_tool_stands_upright` in tests/five_axis.rs");
    }
    if row.treatment == Treatment::Followed && row.code == "CYCLE800" {
        return Some("`the_tip_goes_where_the_swivelled_plane_says` in tests/swivel.rs");
    }
    (row.code == GIVEN && row.treatment == Treatment::Followed)
        .then_some("`an_offset_given_on_the_command_line_is_followed` in tests/dialects.rs")
}

/// The programs of a dialect, those first that prove best.
fn programs(dialect: &Dialect, setup: &Setup) -> Vec<Program> {
    let folder = root().join("tests/corpus").join(&dialect.name);
    let mut found: Vec<Program> = ["accept", "reject"]
        .iter()
        .flat_map(|kind| files(&folder.join(kind), &["nc", "ngc"]))
        .map(|path| Program::read(&path, dialect, setup))
        .collect();
    found.sort_by(|a, b| (a.length(), &a.name).cmp(&(b.length(), &b.name)));
    found
}

/// Offsets and tools of the corpus' profile.
fn setup() -> Setup {
    let text = std::fs::read_to_string(root().join(PROFILE)).expect("readable");
    let profile: toml::Table = text.parse().expect("TOML");
    let number =
        |value: &toml::Value| value.as_float().or(value.as_integer().map(|n| n as f64)).expect("a number");
    let offsets = profile["work_offsets_mm"].as_table().expect("a table");
    let tools = profile["tool"]["lengths_mm"].as_table().expect("a table");
    Setup {
        work_offsets: offsets
            .iter()
            .map(|(name, zero)| (name.clone(), [0, 1, 2].map(|i| number(&zero[i]))))
            .collect(),
        tools: tools
            .iter()
            .map(|(name, length)| (name[1..].parse().expect("a number"), [0.0, 0.0, number(length)]))
            .collect(),
        ..Setup::default()
    }
}

/// The rows of a dialect that are not those of the one that it extends.
fn own_rows(dialect: &Dialect) -> Rows {
    let mut own = rows(dialect);
    let Some(beneath) = dialect.extends.as_deref().and_then(nc_dialect::builtin).map(rows) else {
        return own;
    };
    own.g_codes.retain(|row| !beneath.g_codes.contains(row));
    own.m_codes.retain(|row| !beneath.m_codes.contains(row));
    own.commands.retain(|row| !beneath.commands.contains(row));
    own
}

/// Writes the list of a dialect; rows without proof are added to `missing`.
fn describe(dialect: &Dialect, setup: &Setup, missing: &mut Vec<String>) -> String {
    let programs = programs(dialect, setup);
    let mut shown = |what: String, found: Option<String>| {
        found.unwrap_or_else(|| {
            missing.push(format!("{}: {what}", dialect.name));
            "—".to_owned()
        })
    };
    let mut proof = |row: &Row| {
        let file = || {
            let program = programs.iter().find(|program| proves(program, row, dialect, setup))?;
            Some(format!("`{}`", program.name))
        };
        shown(format!("{} {}", row.code, row.treatment.name()), named(row).map(str::to_owned).or_else(file))
    };
    let Rows { g_codes, m_codes, commands } = own_rows(dialect);
    let mut out = format!("### `{}`: {}\n\nAssumed:\n\n", dialect.name, dialect.title);
    let mut line = |text: std::fmt::Arguments<'_>| writeln!(out, "{text}").expect("a string takes all");
    for assumption in &dialect.assumptions {
        line(format_args!("- {assumption}"));
    }
    if let Some(beneath) = &dialect.extends {
        line(format_args!("\nAll other codes are those of `{beneath}`."));
    }
    line(format_args!(
        "\n| code | group | what becomes of it | why, or how | proof |\n|---|---|---|---|---|"
    ));
    for row in &g_codes {
        let Row { code, group, treatment, note } = row;
        line(format_args!("| {code} | {group} | {} | {note} | {} |", treatment.name(), proof(row)));
    }
    line(format_args!("\n| code | what becomes of it | why, or how | proof |\n|---|---|---|---|"));
    for row in m_codes.iter().chain(&commands) {
        let command = commands.contains(row);
        let code = if command { format!("`{}`", row.code) } else { row.code.clone() };
        line(format_args!("| {code} | {} | {} | {} |", row.treatment.name(), row.note, proof(row)));
    }
    let refused_as = |wanted: u16| {
        let is = |program: &&Program| program.run.refused.as_ref().is_some_and(|(code, _)| *code == wanted);
        programs.iter().find(is).map(|program| format!("`{}`", program.name))
    };
    let unknown_m = programs.iter().find(|program| {
        let unknown = |code: &&String| {
            code.starts_with('M') && code[1..].parse().is_ok_and(|n| dialect.m_code(n).is_none())
        };
        program.name.starts_with("accept/")
            && program.codes.iter().find(unknown).is_some_and(|code| {
                let row =
                    Row { code: code.clone(), group: 0, treatment: Treatment::Passed, note: String::new() };
                proves(program, &row, dialect, setup)
            })
    });
    let unknown_m = unknown_m.map(|program| format!("`{}`", program.name));
    line(format_args!(
        "\nAny other G code is refused, for it could move an axis: {}. Any other M code is passed: {}.",
        shown("an unknown G code".to_owned(), refused_as(207)),
        shown("an unknown M code".to_owned(), unknown_m),
    ));
    if !commands.is_empty() {
        // Without brackets an unknown name is text that cannot be read.
        let code = if dialect.marks.paren == Paren::Command { 224 } else { 105 };
        let unknown = programs.iter().find(|program| {
            program
                .run
                .refused
                .as_ref()
                .is_some_and(|(found, message)| *found == code && !message.contains(" is refused: "))
        });
        let unknown = unknown.map(|program| format!("`{}`", program.name));
        line(format_args!(
            "Any other command is refused, for it could move the frame: {}.",
            shown("an unknown command".to_owned(), unknown)
        ));
    }
    out
}

#[test]
fn every_code_is_listed_with_its_proof() {
    let setup = setup();
    let mut missing = Vec::new();
    let lists: Vec<String> = mills().map(|dialect| describe(dialect, &setup, &mut missing)).collect();
    missing.retain(|row| !UNPROVEN.iter().any(|name| row.starts_with(&format!("{name}:"))));
    assert!(missing.is_empty(), "{} rows without proof:\n{}", missing.len(), missing.join("\n"));
    let path = root().join(DOCUMENT);
    let document = std::fs::read_to_string(&path).expect("readable");
    let (above, _) = document.split_once(MARK).expect("the mark is there");
    let wanted = crate::wrap::wrapped(&format!("{above}{MARK}\n{}", lists.join("\n")));
    if std::env::var_os("VPOST_UPDATE_DOCS").is_some() {
        std::fs::write(&path, wanted).expect("writable");
    } else {
        assert!(document == wanted, "{DOCUMENT} is stale: VPOST_UPDATE_DOCS=1 writes its lists anew");
    }
}

/// A refusal that only its row decides needs no program: one with the code alone, and another one without it.
#[test]
fn what_a_table_refuses_is_refused() {
    let setup = setup();
    let mut tried = 0;
    for dialect in mills() {
        let Rows { g_codes, m_codes, commands } = rows(dialect);
        for row in g_codes.iter().chain(&m_codes).chain(&commands) {
            if named(row) != Some(BY_ITS_ROW) {
                continue;
            }
            tried += 1;
            let begin = format!("{} G90\nG0 X10. Y10. Z60.\n", offset(dialect));
            let bracketed = commands.contains(row) && dialect.marks.paren == Paren::Command;
            let code = if bracketed { format!("({})", row.code) } else { row.code.clone() };
            let run = interpret(format!("{begin}{code}\nG1 Z50. F200.\n").as_bytes(), dialect, &setup);
            let Some((number, message)) = &run.refused else {
                panic!("{}: {} is not refused", dialect.name, row.code);
            };
            assert!(matches!(number, 208 | 224), "{}: {} is VP{number:04}", dialect.name, row.code);
            let why = format!("{} is refused: {}", row.code, row.note);
            assert!(why.starts_with(message.as_str()), "{message}\n{why}");
            assert_eq!(run.steps.len(), 2, "{}: {}", dialect.name, row.code);
            let run = interpret(format!("{begin}G1 Z50. F200.\n").as_bytes(), dialect, &setup);
            assert_eq!(run.refused, None, "{}", dialect.name);
        }
    }
    assert!(tried > 150, "{tried}");
}

/// M0, M5, M9 and their like end up behind the last piece of a block that is split, and nowhere else.
#[test]
fn stops_stay_behind_the_motion() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.nc");
    let program = program.to_str().expect("a plain path");
    for dialect in mills() {
        for row in dialect.m_codes.iter().filter(|row| row.after_motion && row.loses_position == [false; 3]) {
            let stop = format!("M{}", row.number);
            let by_g71 = ["balt-system", "fagor", "heidenhain-iso", "sinumerik"];
            let inch_free = if by_g71.contains(&dialect.name.as_str()) { "G71" } else { "G21" };
            let offset = offset(dialect);
            let text = format!(
                "G17 {inch_free} G40 {offset} G90\nG0 X10. Y10. Z60.\nG1 Z50. F200.\nX900. Y700. {stop}\n"
            );
            std::fs::write(program, text).expect("writable");
            let ran = run(&[program, "-m", PROFILE, "-d", &dialect.name]);
            assert!(ran.status.success(), "{} {stop}: {}", dialect.name, messages(&ran));
            let out = String::from_utf8_lossy(&ran.stdout).into_owned();
            let lines: Vec<&str> = out.lines().collect();
            let split = lines.iter().filter(|line| line.contains('X') && !line.contains("G0")).count();
            assert!(split > 3, "{} {stop} stands in a block that is not split:\n{out}", dialect.name);
            let at: Vec<usize> = (0..lines.len()).filter(|i| lines[*i].contains(&stop)).collect();
            assert_eq!(at, [lines.len() - 1], "{} {stop}:\n{out}", dialect.name);
        }
    }
}

/// The same program is refused without the offset, and corrected for where the offset puts it.
#[test]
fn an_offset_given_on_the_command_line_is_followed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.nc");
    std::fs::write(&program, format!("{GIVEN}\nG0 X10. Y10. Z60.\nG1 Z50. F200.\nX90. Y70.\n"))
        .expect("writable");
    let program = program.to_str().expect("a plain path");
    let mut tried = 0;
    for dialect in mills() {
        let followed = |row: &&Row| row.code == GIVEN && row.treatment == Treatment::Followed;
        if rows(dialect).g_codes.iter().find(followed).is_none() {
            continue;
        }
        tried += 1;
        let without = run(&[program, "-m", PROFILE, "-d", &dialect.name]);
        assert!(messages(&without).contains("VP0214"), "{}: {}", dialect.name, messages(&without));
        let corrected = |offset: &str| {
            let given = format!("{GIVEN}={offset}");
            let ran = run(&[program, "-m", PROFILE, "-d", &dialect.name, "--work-offset", &given]);
            assert!(ran.status.success(), "{}: {}", dialect.name, messages(&ran));
            ran.stdout
        };
        assert_ne!(corrected("100,80,40"), corrected("300,250,90"), "{}", dialect.name);
    }
    assert_eq!(
        tried, 10,
        "all but balt-system, which chooses origins by commands, okuma, which does by H, and heidenhain-iso, which \
         has them set by hand"
    );
}

#[test]
fn the_page_says_what_each_row_may_do() {
    let page = std::fs::read_to_string(root().join(DOCUMENT)).expect("it stands there");
    let missing: Vec<&str> =
        nc_dialect::action_names().filter(|name| !page.contains(&format!("`{name}`"))).collect();
    assert!(missing.is_empty(), "{DOCUMENT} does not say what these do: {missing:?}");
}
