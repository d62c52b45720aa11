//! What each rule of flow makes of a program.

use crate::common;

use common::{blocks, expanded, flat, linuxcnc, refused};

/// A Fanuc program's blocks, comments left out.
fn fanuc(text: &str) -> String {
    blocks(&common::fanuc(text)).join("|")
}

fn linux(text: &str) -> String {
    blocks(&linuxcnc(text)).join("|")
}

/// The blocks of a program with presets and files.
fn given(dialect: &str, text: &str, set: &[&str], files: &[(&str, &str)]) -> String {
    blocks(&flat(dialect, text, set, files)).join("|")
}

#[test]
fn a_program_without_flow_is_not_touched() {
    let text = "%\nO1\n(#1=2 is a comment)\nN10 G1 X1. F100\nM30\n%\n";
    let plain = expanded("fanuc", text, &[], &[]).unwrap();
    assert!(!plain.changed());
    assert_eq!(plain.text(), text.as_bytes());
    // A dialect without a known language passes everything on, to be refused by what comes next.
    assert!(!expanded("perspektiva", "#1=2\nG1 X#1\n", &[], &[]).unwrap().changed());
}

#[test]
fn the_source_line_stays_as_a_comment() {
    let text = "%\nO0001\n#1=2.\nN10 G0 X#1 Y[#1*2] (there)\nWHILE[#1LT4]DO1\nN20 G1 X[#1/3] F100\n#1=#1+1\nEND1\nM98 P1000 L2\nM30\nO1000\nN10 X1.\nM99\n%\nafter\n";
    insta::assert_snapshot!(common::fanuc(text), @r"
    %
    O0001
    (#1=2.)
    (N10 G0 X#1 Y[#1*2] [there])
    N10 G0 X2. Y4. (there)
    (WHILE[#1LT4]DO1)
    (N20 G1 X[#1/3] F100)
    N20 G1 X0.666667 F100
    (#1=#1+1)
    (END1)
    (N20 G1 X[#1/3] F100)
    G1 X1. F100
    (M98 P1000 L2)
    (O1000 CALL 1 OF 2)
    X1.
    (M99)
    (O1000 CALL 2 OF 2)
    X1.
    M30
    %
    after
    ");
}

#[test]
fn fanuc_flow() {
    let cases = [
        // IF … GOTO forwards and backwards; END of a loop.
        ("#1=1\nN1 X#1\n#1=#1+1\nIF[#1LE3]GOTO1\nM30\n", "N1 X1.|X2.|X3.|M30"),
        ("IF[1EQ1]GOTO 20\nX1.\nN20 X2.\nM30\n", "N20 X2.|M30"),
        ("#2=20\nGOTO#2\nX1.\nN20 X2.\nM30\n", "N20 X2.|M30"),
        ("#1=5\nIF[#1 GT 4] THEN #1=4\nX#1\nM30\n", "X4.|M30"),
        // A loop that is not entered; nested loops; a jump out of one.
        ("WHILE[1GT2]DO1\nX1.\nEND1\nX2.\nM30\n", "X2.|M30"),
        (
            "#1=0\nWHILE[#1LT2]DO1\n#2=0\nWHILE[#2LT2]DO2\nX#1Y#2\n#2=#2+1\nEND2\n#1=#1+1\nEND1\nM30\n",
            "X0.Y0.|X0.Y1.|X1.Y0.|X1.Y1.|M30",
        ),
        ("#1=0\nDO1\n#1=#1+1\nIF[#1EQ3]GOTO9\nX#1\nEND1\nN9 M30\n", "X1.|X2.|N9 M30"),
        // Words of all kinds.
        ("#1=54\nG#1\nM30\n", "G54|M30"),
        (
            "#1=3\n#2=-5.25\nM#1 S[#1*100] T#1\nG1 X-#2 Y#2 F[100+#1]\nM30\n",
            "M3 S300 T3|G1 X5.25 Y-5.25 F103.|M30",
        ),
        ("#3=2\n#[100+#3]=7\nX#102\nM30\n", "X7.|M30"),
        ("#1=2\n#2=9\nX##1\nM30\n", "X9.|M30"),
        // An empty variable leaves no word, and is 0 in arithmetic, but is not the number 0.
        ("#1=#0\nX#1 Y[#1+2]\nIF[#1EQ#0]GOTO5\nX9.\nN5 IF[#1EQ0]GOTO6\nX1.\nN6 M30\n", " Y2.|N5 |X1.|N6 M30"),
        // Functions.
        ("#1=FIX[-1.5]\n#2=FUP[-1.5]\n#3=ROUND[2.5]\nX#1Y#2Z#3\nM30\n", "X-1.Y-2.Z3.|M30"),
        ("#1=ATAN[-1]/[-1]\n#2=ATAN[1]\nX#1Y#2\nM30\n", "X225.Y45.|M30"),
        ("X[SIN[30]*10] Y[SQRT[16]] Z[POW[2,3]]\nM30\n", "X5. Y4. Z8.|M30"),
        ("X[1+2*3] Y[[1+2]*3] Z[7 MOD 4]\nM30\n", "X7. Y9. Z3.|M30"),
        ("#1=5 AND 3\n#2=5 OR 2\n#3=5 XOR 1\nX#1Y#2Z#3\nM30\n", "X1.Y7.Z4.|M30"),
        // ROUND in an address rounds to the least increment.
        ("#1=1.23456\nX[ROUND[#1]]\nM30\n", "X1.235|M30"),
        // K of a cycle counts holes, K of an arc is a length.
        (
            "#1=3\nG91 G81 X1. Z-1. R1. K#1 F100\nG80\nG18 G2 X1. Z1. I0 K#1\nM30\n",
            "G91 G81 X1. Z-1. R1. K3 F100|G80|G18 G2 X1. Z1. I0 K3.|M30",
        ),
        // A semicolon ends a block.
        ("#1=2;X#1;Y#1;\nM30;\n", "X2.;|Y2.;|M30;"),
    ];
    for (text, wanted) in cases {
        let found = fanuc(text);
        let found: Vec<&str> = found.split('|').filter(|block| !block.is_empty()).collect();
        let found = found.join("|");
        // `N5 IF …` becomes a comment with its number.
        assert_eq!(found, wanted.replace("N5 |", ""), "{text}");
    }
}

#[test]
fn fanuc_subprograms() {
    let sub = "O1000\nX1.\nM99\n%\n";
    let case = |call: &str| fanuc(&format!("%\nO1\n{call}\nM30\n{sub}"));
    assert_eq!(case("M98 P1000"), "%|O1|X1.|M30|%");
    assert_eq!(case("M98 P1000 L3"), "%|O1|X1.|X1.|X1.|M30|%");
    assert_eq!(case("M98 P31000"), "%|O1|X1.|X1.|X1.|M30|%");
    assert_eq!(case("M98 P0021000"), "%|O1|X1.|X1.|M30|%");
    assert_eq!(case("G0 X5. M98 P1000"), "%|O1|G0 X5.  |X1.|M30|%");
    assert_eq!(case("M98 P1000 L0"), "%|O1|M30|%");
    // M98 shares local variables, G65 has its own.
    let text = "%\nO1\n#1=1\nM98 P2\nX#1\nM30\nO2\n#1=#1+1\nM99\n%\n";
    assert_eq!(fanuc(text), "%|O1|X2.|M30|%");
    let text = "%\nO1\n#1=1\nG65 P2 A5. B#1 X10.\nX#1\nM30\nO2\nX#24Y#1Z#2\n#1=9\nM99\n%\n";
    assert_eq!(fanuc(text), "%|O1|X10.Y5.Z1.|X1.|M30|%");
    // An argument that was not given is empty; one without a point counts least increments.
    let text = "%\nO1\nG65 P2 X100 S100 I1. J2. I3.\nM30\nO2\nX#24Y#25S#19I#4J#5K#7\nM99\n%\n";
    assert_eq!(fanuc(text), "%|O1|X0.1S100I1.J2.K3.|M30|%");
    // M99 P goes on elsewhere in the caller.
    let text = "%\nO1\nM98 P2\nX1.\nN7 X2.\nM30\nO2\nX3.\nM99 P7\n%\n";
    assert_eq!(fanuc(text), "%|O1|X3.|N7 X2.|M30|%");
    // Other files.
    let text = "%\nO1\nM98 P2000\nM30\n%\n";
    assert_eq!(given("fanuc", text, &[], &[("O2000.nc", "%\nO2000\nN1 X7.\nM99\n%\n")]), "%|O1|X7.|M30|%");
    assert_eq!(given("fanuc", text, &[], &[("2000.txt", "X8.\nM99\n")]), "%|O1|X8.|M30|%");
}

#[test]
fn linuxcnc_flow() {
    let cases = [
        // What stands in one block reads the values from before it.
        ("#1=1\n#1=2 X#1\nX#1\nM2\n", "X1.|X2.|M2"),
        ("#<my part>=3\nX#<mypart> Y#<MY PART>\nM2\n", "X3. Y3.|M2"),
        ("#<_g>=3\no<a> sub\nX#<_g>\no<a> endsub\no<a> call\nM2\n", "X3.|M2"),
        // Precedence, division with remainder, logic, comparison with its tolerance.
        ("X[2**3**2] Y[2+3*4] Z[-7 MOD 3]\nM2\n", "X64. Y14. Z2.|M2"),
        ("X[1 EQ 1.00009] Y[1 EQ 1.0002] Z[1 AND 0 OR 1]\nM2\n", "X1. Y0. Z1.|M2"),
        ("X[FIX[-1.5]] Y[FUP[-1.5]] Z[ROUND[-1.5]]\nM2\n", "X-2. Y-1. Z-2.|M2"),
        ("X[ATAN[-1]/[-1]] Y[1/3]\nM2\n", "X-135. Y0.333333333|M2"),
        ("#<a>=1\nX[EXISTS[#<a>]] Y[EXISTS[#<b>]]\nM2\n", "X1. Y0.|M2"),
        // Sums are the same on every processor, and EQ has its tolerance.
        (
            "#1=0\no1 while [#1 LT 0.3]\n#1=[#1+0.1]\no1 endwhile\nX#1\no2 if [COS[90] EQ 0]\nY1\no2 endif\nM2\n",
            "X0.3|Y1|M2",
        ),
        // Branches and loops.
        ("o1 if [0]\nX1\no1 elseif [1]\nX2\no1 else\nX3\no1 endif\nM2\n", "X2|M2"),
        ("o1 if [0]\nX1\no1 elseif [0]\nX2\no1 else\nX3\no1 endif\nM2\n", "X3|M2"),
        ("o1 if [1]\nX1\no1 elseif [1]\nX2\no1 else\nX3\no1 endif\nM2\n", "X1|M2"),
        (
            "#1=0\no1 while [#1 LT 3]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\nX#1\no1 endwhile\nM2\n",
            "X1.|X3.|M2",
        ),
        ("#1=0\no1 do\n#1=[#1+1]\nX#1\no1 while [#1 LT 2]\nM2\n", "X1.|X2.|M2"),
        (
            "#1=0\no1 do\n#1=[#1+1]\no2 if [#1 GT 2]\no1 break\no2 endif\nX#1\no1 while [1]\nX9\nM2\n",
            "X1.|X2.|X9|M2",
        ),
        ("o1 repeat [2]\no2 repeat [2]\nX1\no2 endrepeat\nX2\no1 endrepeat\nM2\n", "X1|X1|X2|X1|X1|X2|M2"),
        ("o1 repeat [3]\nX1\no2 repeat [5]\no1 continue\no2 endrepeat\no1 endrepeat\nM2\n", "X1|X1|X1|M2"),
        ("o1 repeat [0]\nX1\no1 endrepeat\nM2\n", "M2"),
        // Subroutines: arguments, the rest 0, values back, recursion.
        ("o1 sub\nX#1 Y#2 Z#30\no1 endsub [#1+1]\no1 call [5] [6]\nX#<_value>\nM2\n", "X5. Y6. Z0.|X6.|M2"),
        (
            "o1 sub\no2 if [#1 LE 1]\no1 return [1]\no2 endif\no1 call [#1-1]\no1 endsub [#1*#<_value>]\no1 call [5]\nX#<_value>\nM2\n",
            "X120.|M2",
        ),
        ("#1=7\no1 sub\n#1=8\no1 endsub\no1 call\nX#1\nM2\n", "X7.|M2"),
        ("o1 sub\nX1\no1 endsub\n#1=1\no#1 call\nM2\n", "X1|M2"),
        ("M98 P10 L2\nM2\nO10\nX1\nM99\n", "X1|X1|M2"),
    ];
    for (text, wanted) in cases {
        assert_eq!(linux(text), wanted, "{text}");
    }
    let text = "o<slot> call [2]\nM2\n";
    let file = ("slot.ngc", "o<slot> sub\nN5 X#1\no<slot> endsub\nM2\n");
    assert_eq!(given("linuxcnc", text, &[], &[file]), "X2.|M2");
}

#[test]
fn values_from_the_command_line() {
    assert_eq!(given("fanuc", "X#500\nM30\n", &["#500=12.5"], &[]), "X12.5|M30");
    assert_eq!(given("fanuc", "X#5041\nM30\n", &["#5041=-1"], &[]), "X-1.|M30");
    assert_eq!(given("fanuc", "X1. Y#3\nM30\n", &["#3=#0"], &[]), "X1. |M30");
    assert_eq!(given("linuxcnc", "X#<_x>\nM2\n", &["#<_x>=3"], &[]), "X3.|M2");
    assert_eq!(given("linuxcnc", "X[#5399+#31]\nM2\n", &["#5399=1", "#31=2"], &[]), "X3.|M2");
    for bad in ["500=1", "#500", "#x=1", "#500=one", "#500=inf", "#<>=1", "#0=1"] {
        assert_eq!(nc_expand::Preset::parse(bad), None, "{bad}");
    }
}

#[test]
fn a_value_that_is_not_known_may_be_passed_on_but_not_used() {
    assert_eq!(fanuc("#100=#4003\n#101=#100+1\nX1.\nM30\n"), "X1.|M30");
    assert!(
        refused("fanuc", "#100=#4003\n#101=#100+1\nX#101\nM30\n")
            .contains("#4003 is known on the machine only")
    );
}

#[test]
fn refusals() {
    let cases = [
        ("fanuc", "X#500\nM30\n", "VP0121"),
        ("fanuc", "X#1\nM30\n", "VP0121"),
        ("fanuc", "IF[#5041GT0]GOTO1\nN1 M30\n", "VP0121"),
        ("linuxcnc", "X#<_x>\nM2\n", "VP0121"),
        ("linuxcnc", "o1 if [#5399 LT 0]\nX1\no1 endif\nM2\n", "VP0121"),
        ("linuxcnc", "X#<never>\nM2\n", "VP0121"),
        ("fanuc", "#1=1+\nM30\n", "VP0120"),
        ("fanuc", "X[FOO[1]]\nM30\n", "VP0201 not here"),
        ("fanuc", "IF[1EQ1]M30\n", "VP0120"),
        ("linuxcnc", "#1=2+3\nM2\n", "VP0120"),
        ("fanuc", "M98\nM30\n", "VP0120"),
        ("fanuc", "X[1/0]\nM30\n", "VP0122"),
        ("linuxcnc", "X[SQRT[-1]]\nM2\n", "VP0122"),
        ("linuxcnc", "X[ASIN[2]]\nM2\n", "VP0122"),
        ("linuxcnc", "X[LN[0]]\nM2\n", "VP0122"),
        ("linuxcnc", "X[EXP[1000]]\nM2\n", "VP0122"),
        ("fanuc", "#1=0\nWHILE[#1LT1]DO1\n#1=#1+0.1\nX#1\nEND1\nM30\n", "VP0123"),
        ("fanuc", "#1=FIX[0.3*10-0.0000000001]\nM30\n", "VP0123"),
        ("fanuc", "#1=COS[90]\nIF[#1GT0]GOTO5\nN5 M30\n", "VP0123"),
        ("fanuc", "#1=SIN[360]\n#2=ATAN[#1]/[1]\nM30\n", "VP0123"),
        ("linuxcnc", "#1=[COS[90]]\no1 if [#1 GT 0]\nX1\no1 endif\nM2\n", "VP0123"),
        ("linuxcnc", "o1 if [SIN[180]]\nX1\no1 endif\nM2\n", "VP0123"),
        ("linuxcnc", "#1=[FIX[10*SIN[30]]]\nX#1\nM2\n", "VP0123"),
        ("linuxcnc", "#1=[ATAN[SIN[180]]/[COS[180]]]\nX#1\nM2\n", "VP0123"),
        ("fanuc", "#1=1.5\nG#1.\nM30\n", "VP0201 not here"),
        ("fanuc", "M[1.5]\nM30\n", "VP0124"),
        ("fanuc", "M[29+1]\n", "VP0124"),
        ("fanuc", "G[64+1] P1\nM30\n", "VP0124"),
        ("fanuc", "X[999999999999*999999]\nM30\n", "VP0124"),
        ("linuxcnc", "X#[1.5]\nM2\n", "VP0124"),
        ("linuxcnc", "X#[9999]\nM2\n", "VP0124"),
        ("fanuc", "GOTO99\nM30\n", "VP0125"),
        ("fanuc", "GOTO5\nN5 X1.\nN5 X2.\nM30\n", "VP0125"),
        ("fanuc", "WHILE[1EQ1]DO1\nM30\n", "VP0126"),
        ("fanuc", "END1\nM30\n", "VP0126"),
        ("linuxcnc", "o1 if [1]\nM2\n", "VP0126"),
        ("linuxcnc", "o1 endif\nM2\n", "VP0126"),
        ("linuxcnc", "o1 break\nM2\n", "VP0126"),
        ("linuxcnc", "o1 sub\no1 endsub\no1 sub\no1 endsub\nM2\n", "VP0126"),
        ("fanuc", "M98 P77\nM30\n", "VP0127"),
        ("linuxcnc", "o<other> call\nM2\n", "VP0127"),
        ("linuxcnc", "o<../../etc/passwd> call\nM2\n", "VP0128"),
        ("linuxcnc", "o</etc/passwd> call\nM2\n", "VP0128"),
        ("fanuc", "O1\nM98 P2\nM30\nO2\nM98 P2\nM99\n", "VP0129"),
        ("linuxcnc", "o1 sub\no1 call\no1 endsub\no1 call\nM2\n", "VP0129"),
        ("fanuc", "N1 X1.\nGOTO1\n", "VP0130"),
        ("linuxcnc", "#1=0\no1 while [#1 LT 1000000000000]\n#1=[#1+1]\no1 endwhile\nM2\n", "VP0130"),
        ("fanuc", "#2001=5\nX#1\nM30\n", "VP0132"),
        ("linuxcnc", "#5221=5\nM2\n", "VP0132"),
        ("fanuc", "#1=1\nIF[#1EQ1]THEN#3000=1\nM30\n", "VP0133"),
        ("fanuc", "#1=1\n#3000=1 (TOOL BROKEN)\nM30\n", "VP0133"),
        ("linuxcnc", "#1=1\n(ABORT, no tool)\nM2\n", "VP0133"),
        ("fanuc", "/#1=2\nX#1\nM30\n", "VP0134"),
        ("fanuc", "/M98 P1\nM30\nO1\nM99\n", "VP0134"),
        ("fanuc", "X1.\nM99\n", "VP0135"),
        ("fanuc", "M98 P2\nM30\nO2\nX1.\n", "VP0135"),
        ("fanuc", "O1\n#1=1\nX#1\nO2\nX1.\nM99\n", "VP0135"),
        ("linuxcnc", "o1 return\nM2\n", "VP0135"),
        ("linuxcnc", "(a library)\no<a> sub\nX#1\no<a> endsub\nM2\n", "VP0141"),
        ("fanuc", "G4 P100 M98 P2\nM30\nO2\nM99\n", "VP0136"),
        ("fanuc", "M98 P2\nM30\nO2 G91\nG0 X1.\nM99\n", "VP0136"),
        ("fanuc", "M98 P2\nM30\nN5 O2 X1.\nM99\n", "VP0136"),
        ("fanuc", "M98 P2\nM30\nO2 #1=5\nG0 X#1\nM99\n", "VP0136"),
        ("fanuc", "#1=5\nG0 X#1\nO2 #1=6\nM99\n", "VP0135"),
        ("fanuc", "M98 P2\nM30\nO2 M98 P3\nM99\nO3\nX1.\nM99\n", "VP0136"),
        ("fanuc", "#1=2 X1.\nM30\n", "VP0136 or VP0120"),
        ("fanuc", "M98 P31000\nM30\nO1000\nM99\nO31000\nM99\n", "VP0136"),
        ("fanuc", "G65 P2 F100\nM30\nO2\nM99\n", "VP0137"),
        ("fanuc", "G65 P2 N5 A1.\nG65 P2 G1 X1.\nM30\nO2\nM99\n", "VP0136"),
        ("fanuc", "G65 P2 L3 A1.\nM30\nO2\nM99\n", "VP0137"),
    ];
    let mut wrong = Vec::new();
    for (dialect, text, code) in cases {
        if code.contains("not here") {
            continue;
        }
        let said = refused(dialect, text);
        let first = said.lines().next().unwrap_or_default();
        if !code.split(" or ").any(|code| first.contains(code)) {
            wrong.push(format!("{dialect} {text:?}: wanted {code}, got {said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn messages_name_the_way_out() {
    insta::assert_snapshot!(refused("fanuc", "G0 X1.\nG1 X[#500+1] F100\nM30\n"), @r##"
    error[VP0121]: #500 is known on the machine only: nothing in this program sets it before, and an earlier program may have
    at `G1 X[#500+1] F100`: needs the value of #500
    help: `--set "#500=12.5"` with the value that it has there
    "##);
    insta::assert_snapshot!(refused("fanuc", "M98 P1234\nM30\n"), @r"
    error[VP0127]: subprogram O1234 is not in this file, and no file O1234 … 1234.cnc was found
    at `M98 P1234`: called here
    help: `--include DIR` with the folder that holds it
    ");
}

#[test]
fn places_lead_back_to_the_source() {
    let text = "%\nO1\n#1=2\nM98 P2\nM30\nO2\nG1 X#1 F100\nY5. (copied)\nM99\n%\n";
    let expanded = expanded("fanuc", text, &[], &[]).unwrap();
    let flat = String::from_utf8(expanded.text().to_vec()).unwrap();
    let origin = |needle: &str| {
        let at = flat.find(needle).unwrap_or_else(|| panic!("{needle} in {flat}")) as u64;
        let origin = expanded.origin(&(at..at + needle.len() as u64));
        assert_eq!(origin.file, 0);
        &text[origin.span.start as usize..origin.span.end as usize]
    };
    assert_eq!(origin("Y5."), "Y5.");
    assert_eq!(origin("X2."), "G1 X#1 F100\n");
    let line = |needle: &str| {
        let at = flat.find(needle).unwrap();
        expanded.source_line(1 + flat[..at].matches('\n').count() as u64)
    };
    assert_eq!(line("Y5."), (0, 8));
    assert_eq!(line("G1 X2."), (0, 7));
    assert_eq!(line("M30"), (0, 5));
}

#[test]
fn a_stop_under_a_condition_stays_where_it_holds() {
    let text = |value: u8| {
        let program = format!("#1={value}\nIF[#1EQ1]THEN #3006=1(TURN)\nG0 X#1\n#3006=2(ON)\nM30\n");
        String::from_utf8(expanded("fanuc", &program, &[], &[]).unwrap().text().to_vec()).unwrap()
    };
    assert!(text(1).contains("\n#3006=1(TURN)\n") && text(1).contains("\n#3006=2(ON)\n"), "{}", text(1));
    assert!(!text(2).contains("\n#3006=1(TURN)\n"), "{}", text(2));
}

#[test]
fn call_block_runs_a_part_of_the_program() {
    let program =
        "G0 X1\nCALL BLOCK BEG TO FIN\nR1=7\nCALL BLOCK BEG TO FIN\nM30\nBEG: G1 X=R1+1\nX2\nFIN: X3\nX4\n";
    let text = |program: &str| {
        let program = format!("R1=5\n{program}");
        let expanded = expanded("sinumerik", &program, &[], &[])?;
        let text = String::from_utf8(expanded.text().to_vec()).unwrap();
        let plain = text.lines().filter(|line| !line.starts_with(';')).map(|line| line.trim().to_owned());
        Ok::<_, nc_expand::Refusal>(plain.collect::<Vec<_>>())
    };
    let words: Vec<String> = text(program).unwrap();
    let places: Vec<&str> = words.iter().map(|line| line.rsplit([' ', ':']).next().unwrap()).collect();
    assert_eq!(places, ["X1", "X=6.", "X2", "X3", "X=8.", "X2", "X3", "M30"], "{words:?}");
    for (from, to) in [("BEG TO FIN", "FIN TO BEG"), ("BEG TO FIN", "BEG TO ALL")] {
        assert!(text(&program.replacen(from, to, 1)).is_err(), "{to}");
    }
}

#[test]
fn what_is_lost_is_said() {
    let codes = |text: &str| -> Vec<u16> {
        expanded("fanuc", text, &[], &[]).unwrap().warnings().iter().map(|w| w.code.0).collect()
    };
    assert_eq!(codes("#1=2\nX#1\nM30\n"), []);
    assert_eq!(codes("#500=2\nX#500\nM30\n"), [139]);
    assert_eq!(codes("POPEN\nDPRNT[X#1[3]]\nPCLOS\nX1.\nM30\n"), []);
    assert_eq!(codes("#1=5.\nPOPEN\nDPRNT[X#1[3]]\nPCLOS\nX#1\nM30\n"), [140]);
}
