//! What files of controls are refused for: the message, the place, what to do.

use control_files::{Ini, Machine, Refusal, tool_lengths, work_offsets};

/// Number, message and what stands at the place.
fn said<T: std::fmt::Debug>(read: Result<T, Box<Refusal>>) -> (u16, String, String) {
    let refusal = read.expect_err("refused");
    let at = refusal.source.as_ref().zip(refusal.diagnostic.span.clone()).map(|((_, text), span)| {
        text.get(span.start as usize..span.end as usize).unwrap_or_default().to_owned()
    });
    assert!(refusal.diagnostic.help.is_some());
    (refusal.diagnostic.code.0, refusal.diagnostic.message.english().to_owned(), at.unwrap_or_default())
}

fn table(text: &str) -> (u16, String, String) {
    said(tool_lengths("t", text.as_bytes(), Some(1.0)))
}

#[test]
fn tool_tables() {
    let owned = |code: u16, message: &str, at: &str| (code, message.to_owned(), at.to_owned());
    assert_eq!(
        said(tool_lengths("t", b"T1 Z5\n", None)),
        owned(920, "a tool table of LinuxCNC does not say in which unit its lengths are", "")
    );
    assert_eq!(table("T1 Z5\nT2 Z6\nT1 Z7\n"), owned(920, "T1 stands twice in the tool table", "T1"));
    assert_eq!(table("T1 Z5\nT2 Z 6\n"), owned(920, "`Z` in a tool table of LinuxCNC", "Z"));
    assert_eq!(table("T1 Z5\nP2 Z6\n"), owned(920, "`P2 Z6` in a tool table of LinuxCNC", "P2 Z6"));
    assert_eq!(table("T1 Z5\nT2 K6\n"), owned(920, "`K6` in a tool table of LinuxCNC", "K6"));
    assert_eq!(table("T1 Z5\nT2 Zinf\n"), owned(920, "`Zinf` in a tool table of LinuxCNC", "Zinf"));
    assert_eq!(table("T1 Z5,5\n"), owned(920, "`Z5,5` in a tool table of LinuxCNC", "Z5,5"));
}

#[test]
fn lists_of_offsets() {
    let owned = |code: u16, message: &str, at: &str| (code, message.to_owned(), at.to_owned());
    assert_eq!(
        table("%\nG10 L10 P1 R5.\n"),
        owned(920, "millimetres or inches? the list does not say", "G10 L10 P1 R5.")
    );
    assert_eq!(table("G21\nG10 L10 P1 R120500\n"), owned(920, "R120500 has no decimal point", "120500"));
    assert_eq!(
        table("G21\nG10 L10 P1 R5.\nG10 L10 P1 R5.\n"),
        owned(920, "the length H1 stands twice", "G10 L10 P1 R5.")
    );
    assert_eq!(
        table("G21\nG10 L10 P1 R5.\nG10 L11 P2 R0.1\n"),
        owned(920, "H2 has a wear (L11) and no geometry (L10)", "G10 L11 P2 R0.1")
    );
    assert_eq!(
        table("G21\nG10 L10 P1 R5.\nG10 L20 P1\n"),
        owned(921, "a work offset in a list of tool lengths", "G10 L20 P1")
    );
    assert_eq!(table("G21\nG91\nG10 L10 P1 R5.\n"), owned(920, "`G91` in a list of offsets", "G91"));
    assert_eq!(table("G21\nG10 L10 P1 R5.\nG0 X5.\n"), owned(920, "`G0` in a list of offsets", "G0 X5."));
    assert_eq!(
        table("G21\nG10 L10 P1.5 R5.\n"),
        owned(920, "this block of G10 gives no tool length", "G10 L10 P1.5 R5.")
    );
    // Memory A: one number for each; a radius is none of ours.
    let lengths = tool_lengths("t", b"G21\nG10 L11 P2 R95.5\nG10 L12 P2 R0.\nN5G10L1P7R0\nM30\n%\n", None);
    assert_eq!(lengths.expect("read"), [(2, [0.0, 0.0, 95.5]), (7, [0.0; 3])]);
    let lengths = tool_lengths("t", b"G20 (INCH)\nG10 L10 P2 R4.\nG10 L11 P2 R-.5 ; wear\n", None);
    assert_eq!(lengths.expect("read"), [(2, [0.0, 0.0, 3.5 * 25.4])]);
}

#[test]
fn spreadsheets() {
    let lengths = |text: &str| tool_lengths("t.csv", text.as_bytes(), None);
    assert_eq!(
        lengths("tool,length_mm\nH2,95.5\nT1,120\n").expect("read"),
        [(1, [0.0, 0.0, 120.0]), (2, [0.0, 0.0, 95.5])]
    );
    // As a spreadsheet saves it here.
    assert_eq!(lengths("Инструмент;Длина, мм\n1;120,5\n").expect("read"), [(1, [0.0, 0.0, 120.5])]);
    assert_eq!(lengths("tool,x_mm,z_mm\n3,12.5,40\n").expect("read"), [(3, [12.5, 0.0, 40.0])]);
    let owned = |message: &str, at: &str| (920, message.to_owned(), at.to_owned());
    assert_eq!(said(lengths("tool,length_mm\nH1,5\n1,6\n")), owned("tool 1 stands twice", "1"));
    assert_eq!(said(lengths("tool,length_mm\nMILL,5\n")), owned("`MILL` is no number of a length", "MILL"));
    assert_eq!(said(lengths("tool,length_mm\nH1,\n")).1, "`length_mm` is empty");
    assert_eq!(said(lengths("tool,diameter_mm\nH1,5\n")).1, "column `length_mm` is missing");
    assert_eq!(
        said(lengths("tool,length_mm,z_mm\nH1,5,5\n")).1,
        "`length_mm` stands beside lengths along X, Y and Z"
    );
    assert_eq!(said(lengths("")).0, 920);
}

#[test]
fn ini_files() {
    let read = |text: &str| Ini::read("m.ini", text.as_bytes());
    let ini = read("# a\n[TRAJ]\nLINEAR_UNITS = mm\nLINEAR_UNITS = inch\n[EMCIO]\nTOOL_TABLE = t.tbl\n")
        .expect("read");
    assert_eq!((ini.unit_mm, ini.tool_table.as_deref(), ini.parameters), (1.0, Some("t.tbl"), None));
    let owned = |code: u16, message: &str, at: &str| (code, message.to_owned(), at.to_owned());
    assert_eq!(
        said(read("[EMCIO]\nTOOL_TABLE = t.tbl\n")),
        owned(920, "no LINEAR_UNITS under [TRAJ]: this is no INI file of a LinuxCNC machine", "")
    );
    assert_eq!(said(read("[TRAJ]\nLINEAR_UNITS = cm\n")), owned(920, "LINEAR_UNITS is `cm`", "cm"));
    assert_eq!(said(read("#INCLUDE a.inc\n")).1, "this INI file takes in others");
    assert_eq!(
        said(read("[EMCIO]\nDB_PROGRAM = ./tools.py\n")),
        owned(921, "the tools of this machine are kept by a program of their own", "./tools.py")
    );
}

#[test]
fn files_of_parameters() {
    let read = |text: &str| work_offsets("m.var", text.as_bytes(), 1.0, [false, false, true]);
    let plain = "5210 0\n5211 7\n5220 1\n5221 1.5\n5222 2\n5223 -3\n5243 4\n";
    let kept = read(plain).expect("read");
    assert_eq!(kept[..2], [("G54".to_owned(), [1.5, 2.0, -3.0]), ("G55".to_owned(), [0.0, 0.0, 4.0])]);
    assert_eq!((kept.len(), kept[8].0.as_str()), (9, "G59.3"));
    let owned = |code: u16, message: &str, at: &str| (code, message.to_owned(), at.to_owned());
    let with = |line: &str| said(read(&format!("{plain}{line}\n")));
    assert_eq!(
        with("5210 1"),
        owned(921, "a shift by G92 was in force when this file was written", "5210 1")
    );
    assert_eq!(with("5220 3"), owned(921, "G56 was in force when this file was written", "5220 3"));
    assert_eq!(with("5250 30"), owned(921, "G55 is turned by 30 degrees about Z", "5250 30"));
    assert_eq!(with("5246 90"), owned(921, "the zero of C under G55 is 90 degrees", "5246 90"));
    // The machine has no A.
    assert!(read(&format!("{plain}5224 90\n")).is_ok());
    assert_eq!(with("offset 3"), owned(920, "this line is no parameter of LinuxCNC", "offset 3"));
    assert_eq!(said(read("5161 0\n")), owned(920, "the file holds no work offset: #5221 is missing", ""));
    assert_eq!(said(read("T1 Z5\n")).0, 920);
}

#[test]
fn machines_of_ini_files() {
    let owned = |code: u16, message: &str, at: &str| (code, message.to_owned(), at.to_owned());
    let read = |text: &str| said(Machine::read("m.ini", text.as_bytes(), None));
    assert_eq!(
        read("[TRAJ]\nCOORDINATES = X Y Z\n"),
        owned(920, "no LINEAR_UNITS under [TRAJ]: this is no INI file of a LinuxCNC machine", "")
    );
    assert_eq!(read("[TRAJ]\nLINEAR_UNITS = mm\n"), owned(920, "no axis of this INI file has limits", ""));
    assert_eq!(read("[DISPLAY]\nLATHE = 1\n[TRAJ]\nLINEAR_UNITS = mm\n"), owned(921, "this is a lathe", "1"));
    assert_eq!(
        read("[KINS]\nKINEMATICS = pentakins\n[TRAJ]\nLINEAR_UNITS = mm\n"),
        owned(921, "this machine has no axes X, Y and Z of its own", "pentakins")
    );
    assert_eq!(
        read("[TRAJ]\nLINEAR_UNITS = mm\n[AXIS_X]\nMIN_LIMIT = low\nMAX_LIMIT = 5\n"),
        owned(920, "`low` is no limit of X", "low")
    );
}

#[test]
fn machines_of_agents() {
    let owned = |code: u16, message: &str, at: &str| (code, message.to_owned(), at.to_owned());
    let read = |text: &str| said(Machine::read("probe.xml", text.as_bytes(), None));
    let (code, message, _) = read("<MTConnectDevices>\n<Devices></MTConnectDevices>");
    assert!(code == 920 && message.starts_with("line 2: "), "{message}");
    assert_eq!(
        read("<MTConnectStreams/>"),
        owned(920, "`MTConnectStreams` describes no machine", "MTConnectStreams")
    );
    let device = |name: &str, axes: &str| format!("<Device name='{name}'><Axes>{axes}</Axes></Device>");
    let of = |devices: &str| format!("<MTConnectDevices><Devices>{devices}</Devices></MTConnectDevices>");
    let axis = |limits: &str| {
        format!(
            "<Linear name='X'><DataItem type='POSITION' units='MILLIMETER'><Constraints>{limits}</Constraints></DataItem></Linear>"
        )
    };
    let plain = axis("");
    assert_eq!(read(&of("<Agent/>")), owned(921, "no device of this file has linear axes", ""));
    let two = of(&(device("VF-2", &plain) + &device("ST-10", &plain)));
    assert_eq!(read(&two), owned(921, "the file describes several machines: VF-2, ST-10", ""));
    assert_eq!(
        said(Machine::read("probe.xml", two.as_bytes(), Some("VF-3"))).1,
        "there is no device `VF-3` with axes"
    );
    assert!(Machine::read("probe.xml", two.as_bytes(), Some("VF-2")).is_ok());
    assert_eq!(
        read(&of(&device("m", &(plain.clone() + &plain)))),
        owned(921, "two axes are called X", "Linear")
    );
    assert_eq!(
        read(&of(&device("m", &axis("<Minimum>0</Minimum><Maximum>NaN</Maximum>")))),
        owned(920, "`NaN` is no limit of X", "Maximum")
    );
    let inch = axis("<Minimum>0</Minimum><Maximum>20</Maximum>").replace("MILLIMETER", "INCH");
    assert_eq!(read(&of(&device("m", &inch))), owned(920, "the position of X is in `INCH`", "DataItem"));
    let twice = axis("<Minimum>0</Minimum><Maximum>500</Maximum>").replace(
        "</Linear>",
        "<Specification type='POSITION'><Minimum>0</Minimum><Maximum>508</Maximum></Specification></Linear>",
    );
    assert_eq!(
        read(&of(&device("m", &twice))),
        owned(920, "X has limits twice, and they differ", "Specification")
    );
}
