//! Every trap of "Text" in the list of what breaks programs, by name.

use common::{Language, conventional};
use nc_syntax::{
    Block, EnvelopeFinder, Invalid, ItemKind, Macros, Marks, Paren, Place, Reader, Semicolon, Spells, Value,
};
use proptest::prelude::*;

use crate::common;

/// One line per block: what stands in it, in the order it stands.
fn shown(text: &[u8], language: &dyn Spells) -> Vec<String> {
    let (mut reader, mut block, mut lines) = (Reader::new(text, language), Block::default(), Vec::new());
    while reader.next(&mut block) {
        let items = block.items.iter().map(|item| {
            let text = String::from_utf8_lossy(block.text(item.span));
            match item.kind {
                ItemKind::Word { letter, value: Value::Number(number) } => {
                    format!("{}{}", char::from(letter), number.to_f64())
                }
                ItemKind::Word { letter, value: Value::Expression } => {
                    format!("{}<{text}>", char::from(letter))
                }
                ItemKind::Word { letter, value: Value::Missing } => format!("{}?", char::from(letter)),
                ItemKind::CommaWord { letter, .. } => format!(",{}<{text}>", char::from(letter)),
                ItemKind::Comment => "comment".to_owned(),
                ItemKind::Invalid(why) => format!("{why:?}<{text}>"),
                other => format!("{other:?}<{text}>"),
            }
        });
        lines.push(items.collect::<Vec<_>>().join(" "));
    }
    lines
}

fn one(text: &str) -> String {
    shown(text.as_bytes(), &Marks::default()).join(" | ")
}

fn bytes_of(text: &[u8], marks: &Marks) -> Vec<Vec<u8>> {
    let (mut reader, mut block, mut all) = (Reader::new(text, marks), Block::default(), Vec::new());
    while reader.next(&mut block) {
        all.push(block.bytes.to_vec());
    }
    all
}

#[test]
fn words_need_no_spaces_between_them() {
    assert_eq!(one("N10G0G90X0Y0"), "N10 G0 G90 X0 Y0");
    assert_eq!(one("g1x-.5y+0.5z10.f200"), "G1 X-0.5 Y0.5 Z10 F200");
    assert_eq!(one("G1 X1 N20 Y2"), "G1 X1 N20 Y2");
    assert_eq!(one("\tG54.1\tP12\t"), "G54.1 P12");
}

#[test]
fn a_mark_ends_a_block_and_a_name_ends_at_a_blank() {
    let marks =
        Marks { paren: Paren::None, end_of_block: Some(b'*'), percent_words: true, ..Marks::default() };
    assert_eq!(
        shown(b"%41-A G71*\nN10 G1 X+5 * ;far *\nN99 %41-A G71 *\n", &marks),
        ["Percent<%> Name<41-A> G71", "N10 G1 X5", "comment", "N99 Percent<%> Name<41-A> G71"]
    );
}

#[test]
fn a_number_keeps_how_it_was_written() {
    let (marks, mut block) = (Marks::default(), Block::default());
    assert!(Reader::new(b"X+.50", &marks).next(&mut block));
    let number = block.word(b'X').and_then(|word| word.number()).unwrap();
    assert_eq!((number.decimal.mantissa, number.decimal.decimals), (50, 2));
    assert!(number.has_point && !number.leading_digit && number.sign == nc_syntax::Sign::Plus);
}

#[test]
fn spaces_inside_numbers_where_the_dialect_says_so() {
    assert_eq!(one("G 0 1 X 1 0 . 5 Y - 2"), "G1 X10.5 Y-2");
    assert_eq!(shown(b"X 10.5 Y2", &conventional()), ["X10.5 Y2"]);
    assert_eq!(shown(b"X1 0 Y2", &conventional()), ["X1 Text<0> Y2"]);
}

#[test]
fn numbers_no_control_reads() {
    assert_eq!(one("Xnan"), "Number<Xnan>");
    assert_eq!(one("X1E5"), "Number<X1E5>");
    assert_eq!(one("X--1"), "Number<X--1>");
    assert_eq!(one("G1 X1.2.3 Y2"), "G1 Number<X1.2.3> Y2");
    assert_eq!(one("X1,5"), "Number<X1,5>");
    assert_eq!(one("X1e-7"), "Number<X1e-7>");
    assert_eq!(one("Xinf Y-nan"), "Number<Xinf> Number<Y-nan>");
    assert_eq!(one("X1234567890123456.7"), "TooManyDigits<X1234567890123456.7>");
    assert_eq!(one("X Y2"), "X? Y2");
}

#[test]
fn comments_nested_unclosed_and_in_any_encoding() {
    assert_eq!(one("G1 (a) X1 ;b (c)"), "G1 comment X1 comment");
    assert_eq!(one("(a (b) X1)"), "comment X1 UnclosedBracket<)>");
    assert_eq!(one("G1 X1 (never closed"), "G1 X1 UnclosedComment<(never closed>");
    let nested = Marks { paren: Paren::Comment { nested: true }, ..Marks::default() };
    assert_eq!(shown(b"(a (b) X1) Y2", &nested), ["comment Y2"]);
    for text in
        ["(деталь)X1".as_bytes(), b"(\xE4\xE5\xF2\xE0\xEB\xFC)X1", b"(\xA4\xA5\xE2\xA0\xAB\xEC \x80)X1"]
    {
        assert_eq!(shown(text, &Marks::default()), ["comment X1"]);
    }
    assert_eq!(one("деталь X1"), "Text<деталь> X1");
}

#[test]
fn semicolon_ends_a_block_where_the_dialect_says_so() {
    let text = b"G0 X1; G1 Y2 ;\r\n;\n(a;b) G0;M30";
    let split: [&[u8]; 5] = [b"G0 X1;", b" G1 Y2 ;\r\n", b";\n", b"(a;b) G0;", b"M30"];
    assert_eq!(bytes_of(text, &conventional()), split);
    assert_eq!(shown(text, &conventional()), ["G0 X1", "G1 Y2", "", "comment G0", "M30"]);
}

#[test]
fn every_line_end() {
    let split: [&[u8]; 7] = [b"G0\n", b"X1\r\n", b"X2\r", b"X3\r\r\n", b"\n", b"\r", b"X4"];
    assert_eq!(bytes_of(b"G0\nX1\r\nX2\rX3\r\r\n\n\rX4", &Marks::default()), split);
}

#[test]
fn padding_of_tapes_and_serial_lines() {
    assert_eq!(
        one("\0\0\0%\r\n\u{11}G0 X1\u{13}\r\nM30\r\n%\r\n\0\0\u{1a}").as_str(),
        "Percent<%> | G0 X1 | M30 | Percent<%> | "
    );
    assert_eq!(one("\u{feff}G0 X1"), "G0 X1");
    assert_eq!(one("\u{feff}%\nG0\n%"), "Percent<%> | G0 | Percent<%>");
}

#[test]
fn leader_and_trailer_are_nobodys_program() {
    assert_eq!(
        one("PART 12 FOR G1\n\n%\nO1234 (NAME)\nG1 X1\n%\nnotes X5\n"),
        "Name<PART 12 FOR G1> |  | Percent<%> | O1234 comment | G1 X1 | Percent<%> | Name<notes X5>"
    );
}

#[test]
fn one_percent_or_none_is_a_whole_program() {
    assert_eq!(one("%\nG1 X1\nX2"), "Percent<%> | G1 X1 | X2");
    assert_eq!(one("G1 X1\nX2"), "G1 X1 | X2");
    assert_eq!(one("leader\n%\nG1 X1"), "Name<leader> | Percent<%> | G1 X1");
    assert_eq!(one("G1 X1\nM30\n%\nend of tape"), "G1 X1 | M30 | Percent<%> | Name<end of tape>");
}

#[test]
fn a_percent_between_two_others_is_shown() {
    assert_eq!(
        one("%\nG1 X1\n%\nG1 X2\n%\nend of tape"),
        "Percent<%> | G1 X1 | Percent<%> | G1 X2 | Percent<%> | Name<end of tape>"
    );
}

#[test]
fn blocks_behind_the_last_percent_are_read() {
    assert_eq!(one("%\nG1 X1\n%\nX3"), "Percent<%> | G1 X1 | Percent<%> | X3");
    assert_eq!(one("G1 X1\n%\nX3 (AGAIN)\n"), "G1 X1 | Percent<%> | X3 comment");
    assert_eq!(one("%\nG1 X1\n%PART 2\nX3\n"), "Percent<%> | G1 X1 | Percent<%> Name<PART 2> | X3");
    // Two in front of the program: the second would close it.
    assert_eq!(one("%\n%\nO1\nG1 X1\n"), "Percent<%> | Percent<%> | O1 | G1 X1");
}

#[test]
fn program_names() {
    assert_eq!(one("%\nO1234\nG0"), "Percent<%> | O1234 | G0");
    assert_eq!(one("%\n:1234 X1\nG0"), "Percent<%> | O1234 X1 | G0");
    assert_eq!(one("%\n<PART-1>\nG0"), "Percent<%> | Name<<PART-1>> | G0");
    assert_eq!(one("%PART 7 (Z)\nG0\n%"), "Percent<%> Name<PART 7> comment | G0 | Percent<%>");
    assert_eq!(
        shown(b"%\n;\nplate_fanuc.nc (FREECAD-FILENAME-GOES-HERE)\nG0\nplate\n%", &conventional()),
        ["Percent<%>", "", "Name<plate_fanuc.nc> comment", "G0", "Text<plate>", "Percent<%>"]
    );
}

#[test]
fn the_file_name_of_an_okuma_stands_in_front() {
    let okuma = &Language { macros: Macros::Okuma, ..Language::default() };
    let text = b"$PART.MIN%\nO100\nG0 X1.\n%";
    assert_eq!(shown(text, okuma), ["Name<$PART.MIN%>", "O100", "G0 X1", "Percent<%>"]);
    assert_eq!(shown(b"%\n$PART.MIN%\nG0\n%", okuma), ["Percent<%>", "Name<$PART.MIN%>", "G0", "Percent<%>"]);
    // A second program in one file, and other controls.
    assert_eq!(shown(b"G0\n$B.MIN%\nG0", okuma)[1], "Text<$B.MIN%>");
    assert_eq!(one("$PART.MIN%\nG0"), "Text<$PART.MIN%> | G0");
}

#[test]
fn block_delete() {
    assert_eq!(one("/G1 X1"), "Skip</> G1 X1");
    assert_eq!(one("/3 N10 G1"), "Skip</3> N10 G1");
    assert_eq!(one("N10 /2 G1"), "N10 Skip</2> G1");
    let without = Marks { skip: None, ..Marks::default() };
    assert_eq!(shown(b"/G1 X1", &without), ["Text</G1> X1"]);
}

#[test]
fn variables_expressions_and_flow() {
    assert_eq!(one("X[#1+2] Y-#102 Z#[100+#1]"), "X<X[#1+2]> Y<Y-#102> Z<Z#[100+#1]>");
    assert_eq!(one("G1 X#<_a b> Ysin[30]"), "G1 X<X#<_a b>> Y<Ysin[30]>");
    assert_eq!(one("#1=2 (set)"), "Flow<#1=2> comment");
    assert_eq!(one("IF[#1EQ2]GOTO10"), "Flow<IF[#1EQ2]GOTO10>");
    assert_eq!(one("N5WHILE[#1LT3]DO1"), "N5 Flow<WHILE[#1LT3]DO1>");
    assert_eq!(one("END1"), "Flow<END1>");
    assert_eq!(one("GOTO#1"), "Flow<GOTO#1>");
    assert_eq!(one("o<probe> call [1] [2]"), "Flow<o<probe> call [1] [2]>");
    assert_eq!(one("O100 endsub"), "Flow<O100 endsub>");
    assert_eq!(one("O100"), "O100");
    assert_eq!(one("X[1+2"), "UnclosedBracket<X[1+2>");
    assert_eq!(one("IF[#1EQ[2]GOTO10"), "UnclosedBracket<IF[#1EQ[2]GOTO10>");
}

#[test]
fn comma_words_are_not_the_words_of_their_letter() {
    assert_eq!(one("X10. ,R5. Y2"), "X10 ,R<,R5.> Y2");
    assert_eq!(one("X10.,C2."), "X10 ,C<,C2.>");
}

#[test]
fn bracket_commands_are_kept_as_commands() {
    let commands = Marks { paren: Paren::Command, ..Marks::default() };
    assert_eq!(shown(b"(UAO,1) ;frame", &commands), ["BracketCommand<(UAO,1)> comment"]);
    assert_eq!(shown(b"(RPT,5", &commands), ["UnclosedBracket<(RPT,5>"]);
}

#[test]
fn words_with_an_equals_sign() {
    let sinumerik = Language {
        marks: Marks { equals_words: true, ..Marks::default() },
        commands: &[("MSG", false), ("SOFT", false), ("TRANS", true)],
        ..Language::default()
    };
    assert_eq!(
        shown(b"G1 X=10.5 Y=IC(5 ) Z = R1+2 F=200;c", &sinumerik),
        ["G1 X10.5 Y<Y=IC(5 )> Z<Z = R1+2> F200 comment"]
    );
    assert_eq!(shown(b"TRANS X10 Y20 ;c", &sinumerik), ["BracketCommand<TRANS X10 Y20> comment"]);
    assert_eq!(shown(b"MSG(\"part X1\")", &sinumerik), ["BracketCommand<MSG(\"part X1\")>"]);
    assert_eq!(shown(b"MSG (\"a (b)\") G1 X2", &sinumerik), ["BracketCommand<MSG (\"a (b)\")> G1 X2"]);
    assert_eq!(shown(b"N5 SOFT G1 X2", &sinumerik), ["N5 BracketCommand<SOFT> G1 X2"]);
    // Below a name on the % line, and in any case for a command, a bare line is no name.
    assert_eq!(
        shown(b"%_N_A_MPF\nCYCLE(1)\n", &sinumerik),
        ["Percent<%> Name<_N_A_MPF>", "Text<CYCLE> comment"]
    );
    assert_eq!(shown(b"%\nTRANS X10\n", &sinumerik), ["Percent<%>", "BracketCommand<TRANS X10>"]);
    assert_eq!(shown(b"TRANSMIT", &sinumerik), ["Text<TRANSMIT>"]);
}

#[test]
fn letters_the_dialect_lacks() {
    let few = Marks { letters: b"NGXYZ".to_vec(), ..Marks::default() };
    assert_eq!(shown(b"G1 W10. X1", &few), ["G1 Text<W10.> X1"]);
}

#[test]
fn a_line_longer_than_any_block_is_not_read() {
    let mut text = b"G0\n".to_vec();
    text.extend(std::iter::repeat_n(b"X1 ", 50_000).flatten());
    text.extend_from_slice(b"\nM30");
    let (marks, mut block) = (Marks::default(), Block::default());
    let mut reader = Reader::new(&text, &marks);
    let mut kinds = Vec::new();
    while reader.next(&mut block) {
        kinds.push(block.items[0].kind);
    }
    assert_eq!(kinds[1], ItemKind::Invalid(Invalid::TooLong));
    assert!(matches!(kinds[..], [ItemKind::Word { .. }, _, ItemKind::Word { .. }]));
}

#[test]
fn places_are_the_files() {
    let (marks, mut block) = (Marks::default(), Block::default());
    let mut reader = Reader::new(b"%\nG1 X1\nY--2\n", &marks);
    while reader.next(&mut block) && block.line < 3 {}
    let diagnostic = block.unreadable().unwrap();
    assert_eq!((diagnostic.code.0, diagnostic.span), (101, Some(8..12)));
    assert_eq!(diagnostic.message.english(), "`Y--2` is not a number a control reads");
}

#[test]
fn a_cyrillic_letter_is_named() {
    let (marks, mut block) = (Marks::default(), Block::default());
    assert!(Reader::new("G1 Х10.5 Y2".as_bytes(), &marks).next(&mut block));
    let diagnostic = block.unreadable().unwrap();
    assert_eq!(diagnostic.message.english(), "`Х10.5` starts with a Cyrillic `Х`");
    assert_eq!(diagnostic.help.as_ref().map(|help| help.english()), Some("type the Latin `X`"));
    assert!(Reader::new("деталь".as_bytes(), &marks).next(&mut block));
    assert!(block.unreadable().unwrap().message.english().contains("is not a word"));
}

fn lossless(text: &[u8], marks: &Marks) -> Result<(), TestCaseError> {
    let (mut reader, mut block, mut copy) = (Reader::new(text, marks), Block::default(), Vec::new());
    while reader.next(&mut block) {
        prop_assert_eq!(block.offset, copy.len() as u64);
        prop_assert!(!block.bytes.is_empty());
        copy.extend_from_slice(block.bytes);
        let mut end = 0;
        for item in &block.items {
            prop_assert!(end <= item.span.start && item.span.start < item.span.end, "{:?}", block);
            prop_assert!(item.span.end as usize <= block.bytes.len());
            end = item.span.end;
        }
    }
    prop_assert_eq!(copy, text);
    Ok(())
}

/// Cut into parts at line ends and read one after the other, a program gives the same blocks.
fn in_parts(text: &[u8], marks: &Marks, every: usize) -> Result<(), TestCaseError> {
    let ends = |at: usize| match (text[at - 1], text.get(at)) {
        (b'\n', _) => true,
        (b'\r', next) => !matches!(next, Some(b'\r' | b'\n')),
        _ => false,
    };
    let mut cuts: Vec<usize> = (1..text.len()).filter(|at| ends(*at)).step_by(every).collect();
    cuts.push(text.len());
    let parts = || cuts.iter().scan(0, |from, to| Some((std::mem::replace(from, *to), *to)));
    let mut finder = EnvelopeFinder::new(marks);
    parts().for_each(|(from, to)| finder.see(&text[from..to]));
    let envelope = finder.finish();
    let mut whole = Reader::new(text, marks);
    let (mut expected, mut found) = (Block::default(), Block::default());
    let mut place = Place::START;
    for (from, to) in parts() {
        let mut reader = Reader::part(&text[from..to], marks, envelope, place);
        let mut line = place.line;
        while reader.next(&mut found) {
            prop_assert!(whole.next(&mut expected));
            prop_assert_eq!(&found, &expected);
            line = found.line + 1;
        }
        place = Place { offset: to as u64, line, expects_name: reader.expects_name() };
    }
    prop_assert!(!whole.next(&mut expected));
    Ok(())
}

fn every_language() -> impl Strategy<Value = Marks> {
    let paren = prop_oneof![
        Just(Paren::None),
        any::<bool>().prop_map(|nested| Paren::Comment { nested }),
        Just(Paren::Command)
    ];
    let semicolon = prop_oneof![Just(Semicolon::None), Just(Semicolon::Comment)];
    let end_of_block = prop_oneof![Just(None), Just(Some(b';')), Just(Some(b'*'))];
    (paren, semicolon, end_of_block, any::<[bool; 3]>()).prop_map(
        |(paren, semicolon, end_of_block, [equals_words, spaces_inside, percent_words])| {
            let mut marks =
                Marks { paren, semicolon, end_of_block, percent_words, equals_words, ..Marks::default() };
            marks.spaces_inside = spaces_inside;
            marks
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_come_out_as_they_went_in(text in proptest::collection::vec(any::<u8>(), 0..300), marks in every_language()) {
        lossless(&text, &marks)?;
    }

    #[test]
    fn anything_like_a_program_comes_out_as_it_went_in(
        text in "([GXYZNMOFIJKRgx%/(){};,:#=<>\\[\\]\"0-9.+\\- \t\r\n\\x00]|IF|GOTO|nan|E5|SIN|sub|%\n){0,120}",
        marks in every_language(),
        every in 1usize..4,
    ) {
        lossless(text.as_bytes(), &marks)?;
        in_parts(text.as_bytes(), &marks, every)?;
    }

    /// What is written as words is read as these words, with or without spaces.
    #[test]
    fn words_read_back(words in proptest::collection::vec(("[FGIJKMNPQRSTXYZ]", -999_999_i64..1_000_000, 0_usize..5, " {0,2}"), 1..12)) {
        let (mut text, mut expected) = (String::new(), Vec::new());
        for (letter, mantissa, decimals, space) in words {
            let digits = format!("{:0width$}", mantissa.abs(), width = decimals + 1);
            let (whole, part) = digits.split_at(digits.len() - decimals);
            let sign = if mantissa < 0 { "-" } else { "" };
            text.push_str(&format!("{letter}{sign}{whole}{}{part}{space}", if decimals > 0 { "." } else { "" }));
            expected.push((letter.as_bytes()[0], mantissa, decimals as u8));
        }
        let (marks, mut block) = (Marks::default(), Block::default());
        Reader::new(text.as_bytes(), &marks).next(&mut block);
        let found: Vec<_> = block.words().filter_map(|word| {
            word.number().map(|n| (word.letter, n.decimal.mantissa, n.decimal.decimals))
        }).collect();
        prop_assert_eq!(found, expected);
    }
}

/// `X10. /M8`: the motion is the same skipped or not, where M codes alone stand behind the mark that move nothing.
#[test]
fn m_codes_behind_a_mark_in_mid_block_are_text() {
    let fanuc = &Language { marks: common::conventional(), switches: &[3, 8], ..Language::default() };
    let kinds = |text: &str| -> Vec<ItemKind> {
        let (mut reader, mut block) = (Reader::new(text.as_bytes(), fanuc), Block::default());
        assert!(reader.next(&mut block));
        block.items.iter().map(|item| item.kind).collect()
    };
    for text in ["X10. /M8\n", "X10./M8 M03\n", "N5 X10. /2 M8;\n", "X10. /M8 (COOLANT)\n"] {
        assert!(kinds(text).contains(&ItemKind::Comment), "{text}");
        assert!(!kinds(text).contains(&ItemKind::Skip), "{text}");
    }
    // The whole block, motion, what moves or ends, what is done behind the motion, what no table knows.
    for text in [
        "/M8\n",
        "N5 /M8\n",
        "X10. /Y5.\n",
        "X10. /M6\n",
        "X10. /M30\n",
        "X10. /M9\n",
        "X10. /M8 X5.\n",
        "X10. /M777\n",
        "X10. /\n",
    ] {
        assert!(kinds(text).contains(&ItemKind::Skip), "{text}");
    }
}
