//! TOML text to a dialect.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::control::{
    Action, CodeEntry, Command, Dialect, Flow, FrameRules, Keeps, LatheSign, LengthAfter, MCode, Numbers,
    Output, PathCode, PathKey, RefusedWord, System, Turning, WrittenCycles,
};
use diagnostic::{Code, Diagnostic, Text, both};
use nc_syntax::{GCode, Letters, Marks, Paren};
use toml::Spanned;

use crate::action::{action_named, action_names, nearest};
use crate::checks::{self, wide};
use crate::inherited;
use crate::russian;
use crate::table::{
    self, Alone, CodeRow, CommandRow, FlowRules, Frames, Grammar, LatheRow, LeadName, MRow, OutputRules,
    PercentRule, RoundBrackets, StartUnit, TurningRules, UnderG40, UnderG49, WithoutH, WordRow, WrittenOut,
    ZeroRepeats,
};

/// Reads a grammar.
///
/// `name` is the dialect's name: the file's name without ending. Spans of the diagnostics are bytes of `text`.
///
/// # Errors
/// All that is wrong, in the order of the file: VP0801 what TOML or the field list refuses (alone: the rest is
/// not read then), VP0802 a key that is no code, VP0803 a code twice, VP0804 an unknown action, VP0805 a row
/// that neither says what the code does nor why it is refused, VP0806 a number out of range, VP0807 start codes
/// that the table lacks or that exclude each other, VP0808 letters that cannot be words.
pub fn load(name: &str, text: &str) -> Result<Dialect, Vec<Diagnostic>> {
    let grammar = inherited::read(text).map_err(|wrong| vec![wrong])?;
    let mut wrong = Vec::new();
    let mut m_codes = Vec::new();
    let mut commands = Vec::new();
    for (key, row) in &grammar.m_codes {
        match number_behind(key.get_ref(), 'M').and_then(|digits| digits.parse().ok()) {
            None => wrong.push(no_code(key, "M6")),
            Some(number) => match m_code(number, key, row) {
                Err(diagnostic) => wrong.push(diagnostic),
                Ok(code) => m_codes.push((key.span(), code)),
            },
        }
    }
    for (key, row) in &grammar.commands {
        match command(key, row) {
            Err(diagnostic) => wrong.push(diagnostic),
            Ok(found) => commands.push((key.span(), found)),
        }
    }
    let codes = g_codes(&grammar.codes, &mut wrong);
    let m_codes = unique(m_codes, |entry| entry.number, &mut wrong);
    let commands = unique(commands, |entry| entry.name.clone(), &mut wrong);
    let path_control = path_control(&grammar.path_control, &codes, &commands, &mut wrong);
    let lathe = grammar.lathe.iter().filter_map(|row| lathe(row, &mut wrong)).collect();
    let words = refused_words(&grammar.words, &mut wrong);
    let time = grammar.numbers.dwell_time.as_ref();
    let dwell_time = time.map(|letters| checks::set_of_letters(Some(letters), &mut wrong));
    let initial = checks::start_codes(&grammar.start.codes, &codes, &mut wrong);
    let turning = grammar.turning.as_ref().map(|rules| turning(rules, &codes, &initial, &mut wrong));
    checks::letters(&grammar.text.letters, &mut wrong);
    checks::numbers(&grammar, &mut wrong);
    if !wrong.is_empty() {
        wrong.sort_by_key(|diagnostic| diagnostic.span.as_ref().map_or(0, |span| span.start));
        return Err(wrong);
    }
    let rows = Rows { words, dwell_time, codes, m_codes, commands, path_control, lathe, turning };
    Ok(dialect(name, grammar, rows, initial))
}

/// The rows of a table of G codes, sorted.
fn g_codes(table: &BTreeMap<Spanned<String>, CodeRow>, wrong: &mut Vec<Diagnostic>) -> Vec<CodeEntry> {
    let mut codes = Vec::new();
    for (key, row) in table {
        match number_behind(key.get_ref(), 'G').and_then(tenths) {
            None => wrong.push(no_code(key, "G81 or \"G54.1\"")),
            Some(code) => match action(GCode(code), key, row) {
                Err(diagnostic) => wrong.push(diagnostic),
                Ok(action) => {
                    codes.push((key.span(), CodeEntry { code: GCode(code), group: row.group, action }));
                }
            },
        }
    }
    unique(codes, |entry| entry.code, wrong)
}

/// How near the control keeps to the path.
fn path_control(
    table: &BTreeMap<Spanned<String>, Spanned<String>>,
    codes: &[CodeEntry],
    commands: &[Command],
    wrong: &mut Vec<Diagnostic>,
) -> Vec<PathCode> {
    let mut rows = Vec::new();
    for (written, value) in table {
        let name = written.get_ref();
        let (key, known) = match number_behind(name, 'G').and_then(tenths).map(GCode) {
            Some(code) => (PathKey::Code(code), codes.iter().any(|row| row.code == code)),
            None => (PathKey::Command(name.clone()), commands.iter().any(|row| row.name == *name)),
        };
        if !known {
            let message = both!("`{name}` has no row of its own", "у `{name}` нет своей строки");
            let expected = both!(
                "expected a code or command of this table",
                "ожидалась функция или команда этой таблицы"
            );
            wrong.push(Diagnostic::error(Code(802), message).at(wide(written.span()), expected).help(both!(
                "say under [codes] or [commands] what it does, or delete this line",
                "скажите в [codes] или [commands], что она делает, или удалите эту строку"
            )));
        }
        let keeps = match (value.get_ref().as_str(), value.get_ref().as_bytes()) {
            ("exact", _) => Keeps::Exact,
            ("unstated", _) => Keeps::Unstated,
            ("argument", _) => Keeps::Argument,
            (_, [first, ..]) if value.get_ref().len() <= 2 && first.is_ascii_uppercase() => {
                Keeps::Words(value.get_ref().as_bytes().to_vec())
            }
            (other, _) => {
                let message =
                    both!("`{other}` says nothing of the path", "`{other}` ничего не говорит о траектории");
                let expected = both!(
                    "expected \"exact\", \"unstated\", \"argument\", or the letter of the word that says how far, like \"P\"",
                    "ожидалось \"exact\", \"unstated\", \"argument\" или буква слова, которое задаёт отклонение, например \"P\""
                );
                let found = Diagnostic::error(Code(804), message).at(wide(value.span()), expected);
                wrong.push(found.help(inherited::EVERY_FIELD));
                continue;
            }
        };
        rows.push(PathCode { key, keeps });
    }
    rows
}

/// What a lathe's programs have; the table's own codes are a system too, where it has a name.
fn turning(
    rules: &TurningRules,
    codes: &[CodeEntry],
    initial: &[GCode],
    wrong: &mut Vec<Diagnostic>,
) -> Turning {
    let own = rules.system.iter().map(|name| System {
        name: name.clone(),
        codes: Vec::new(),
        without: Vec::new(),
        increments: rules.increments,
        initial: initial.to_vec(),
    });
    let mut systems: Vec<System> = own.collect();
    for (name, system) in &rules.systems {
        let rows = g_codes(&system.codes, wrong);
        let mut without = Vec::new();
        for code in &system.without {
            match number_behind(code.get_ref(), 'G').and_then(tenths) {
                Some(tenths) => without.push(GCode(tenths)),
                None => wrong.push(no_code(code, "G32")),
            }
        }
        let others = codes
            .iter()
            .filter(|entry| !without.contains(&entry.code) && rows.iter().all(|own| own.code != entry.code));
        let all: Vec<CodeEntry> = others.chain(&rows).cloned().collect();
        let initial = checks::start_codes(&system.start, &all, wrong);
        let increments = system.increments;
        systems.push(System { name: name.clone(), codes: rows, without, increments, initial });
    }
    Turning {
        increments: rules.increments,
        offset_in_t: rules.offset_in_t,
        offset_in_d: rules.offset_in_d,
        thread_lead: match rules.thread_lead {
            LeadName::F => b'F',
            LeadName::K => b'K',
        },
        diameters: None,
        cycles: toolpath::TurningParameters::default(),
        systems,
    }
}

/// Rows that were read.
struct Rows {
    words: Vec<RefusedWord>,
    dwell_time: Option<Letters>,
    codes: Vec<CodeEntry>,
    m_codes: Vec<MCode>,
    commands: Vec<Command>,
    path_control: Vec<PathCode>,
    lathe: Vec<LatheSign>,
    turning: Option<Turning>,
}

/// The table as a value, once nothing in it is wrong.
fn dialect(name: &str, grammar: Grammar, rows: Rows, initial: Vec<GCode>) -> Dialect {
    let Grammar {
        title,
        extends,
        assumptions,
        text,
        numbers,
        cycles,
        tool_length,
        output,
        flow,
        frames,
        start,
        ..
    } = grammar;
    let Rows { words, dwell_time, codes, m_codes, commands, path_control, lathe, turning } = rows;
    let peck_mm = [cycles.peck_clearance_mm, cycles.chip_retreat_mm].map(Spanned::into_inner);
    Dialect {
        name: name.to_owned(),
        title,
        extends,
        assumptions,
        marks: marks(text, numbers.spaces_inside),
        refused_words: words,
        dwell_time,
        numbers: Numbers {
            point_free: numbers.without_point,
            least_increment_decimals_mm: numbers.least_increment_decimals_mm.into_inner(),
            least_increment_decimals_inch: numbers.least_increment_decimals_inch.into_inner(),
        },
        initial,
        path_control,
        unit_is_kept: start.unit == StartUnit::Kept,
        lathe,
        turning,
        flow: flow_rules(&flow, cycles.written_out, &codes, &commands),
        codes: codes.into(),
        m_codes,
        commands,
        cycle_levels: cycles.levels,
        cycle_repeats: cycles.repeats.into_bytes(),
        zero_repeats_define: cycles.zero_repeats == ZeroRepeats::Define,
        bottom_lies_below_r: cycles.bottom_lies_below_r,
        length_of_loaded_tool: tool_length.without_h == WithoutH::LoadedTool,
        length_under_g40: match tool_length.under_g40 {
            UnderG40::Stays => LengthAfter::Stays,
            UnderG40::Ends => LengthAfter::Ends,
            UnderG40::Unstated => LengthAfter::Unstated,
        },
        length_under_g49: match tool_length.under_g49 {
            UnderG49::Ends => LengthAfter::Ends,
            UnderG49::Unstated => LengthAfter::Unstated,
        },
        length_shifts: tool_length.alone == Alone::Shifts,
        t_word: tool_length.t_word,
        length_at_change: tool_length.at_change,
        writes_lengths: tool_length.writes_lengths,
        edge_in_d: tool_length.edge_in_d,
        calls: Vec::new(),
        frames: frame_rules(frames),
        output: output_rules(output, peck_mm),
    }
}

/// How the text is spelled.
fn marks(text: table::Text, spaces_inside: bool) -> Marks {
    let mut letters = text.letters.into_inner().into_bytes();
    letters.sort_unstable();
    let mut long_words: Vec<(String, u8)> =
        text.long_words.into_iter().map(|(name, letter)| (name, letter.into_inner() as u8)).collect();
    long_words.sort();
    Marks {
        paren: match text.round_brackets {
            RoundBrackets::None => Paren::None,
            RoundBrackets::Comment => Paren::Comment { nested: false },
            RoundBrackets::NestedComment => Paren::Comment { nested: true },
            RoundBrackets::Command => Paren::Command,
        },
        semicolon: text.semicolon,
        end_of_block: text.end_of_block.and_then(byte),
        percent_words: text.percent == PercentRule::NameAndWords,
        skip: text.block_delete.and_then(byte),
        colon: text.colon,
        long_words,
        labels: text.labels,
        equals_words: text.equals_words,
        letters,
        spaces_inside,
    }
}

fn flow_rules(
    flow: &FlowRules,
    written_out: Option<WrittenOut>,
    codes: &[CodeEntry],
    commands: &[Command],
) -> Flow {
    Flow {
        macros: flow.macros,
        packed_repeats: flow.packed_repeats,
        full_circle_atan: flow.full_circle_atan,
        corner_words: flow.corner_words,
        local_calls: flow.local_calls,
        one_value_atan: flow.one_value_atan,
        written_cycles: written_out.map(|rule| WrittenCycles {
            levels: [rule.level, rule.bottom].map(|letter| letter.into_inner() as u8),
            back: rule.back,
        }),
        control_programs: flow.control_programs,
        polar_words: codes.iter().any(|entry| entry.action == Action::PolarOn),
        called: commands.iter().any(|command| matches!(command.action, Some(Action::Called(_)))),
    }
}

fn frame_rules(frames: Frames) -> FrameRules {
    FrameRules {
        p_selects_numbered: frames.p_selects_numbered,
        l20: frames.l20,
        local_is_preset: frames.local_is_preset,
        scaling_step: frames.scaling_step.into_inner(),
        arc_turns: frames.arc_turns,
        rotation_about_tool: frames.rotation_about_tool,
        machine_words_stand_alone: frames.machine_words_stand_alone,
        increments_carry_shift: frames.increments_carry_shift,
    }
}

fn output_rules(output: OutputRules, [peck_clearance_mm, chip_retreat_mm]: [f64; 2]) -> Output {
    Output {
        decimals_inch: output.decimals_inch.into_inner(),
        decimals_feed: output.decimals_feed.into_inner(),
        max_block_bytes: output.max_block_bytes,
        number_inserted_blocks: output.number_inserted_blocks,
        max_block_number: output.max_block_number.into_inner(),
        centre_words: output.centre_words,
        radius_word: output.radius_word,
        arc_radius_tolerance_mm: output.arc_radius_tolerance_mm.into_inner(),
        arc_radius_tolerance_inch: output.arc_radius_tolerance_inch.map(Spanned::into_inner),
        arc_radius_tolerance_share: output.arc_radius_tolerance_share.map_or(0.0, Spanned::into_inner),
        arc_chord_tolerance_mm: output.arc_chord_tolerance_mm.map(Spanned::into_inner),
        rotary_feed: output.rotary_feed,
        largest_inverse_feed: output.largest_inverse_feed.map_or(FIVE_DIGITS, Spanned::into_inner),
        peck_clearance_mm,
        chip_retreat_mm,
    }
}

/// A mark of the table, which [`checks::numbers`] has found to be ASCII.
fn byte(mark: Spanned<char>) -> Option<u8> {
    u8::try_from(mark.into_inner()).ok()
}

/// The letters whose words are refused.
fn refused_words(
    table: &BTreeMap<Spanned<String>, WordRow>,
    wrong: &mut Vec<Diagnostic>,
) -> Vec<RefusedWord> {
    let row = |(key, row): (&Spanned<String>, &WordRow)| match key.get_ref().as_bytes() {
        [letter @ b'A'..=b'Z'] => Some(RefusedWord {
            letter: *letter,
            reason: russian::text(&row.refuse),
            help: russian::text(&row.help),
        }),
        _ => {
            wrong.push(no_code(key, "Q"));
            None
        }
    };
    table.iter().filter_map(row).collect()
}

/// What every control reads of an F of G93: Mitsubishi's and Hurco's manuals and some posts say a digit more.
const FIVE_DIGITS: f64 = 99_999.999;

/// Digits (and point) behind the letter.
fn number_behind(key: &str, letter: char) -> Option<&str> {
    key.strip_prefix(letter).filter(|digits| digits.starts_with(|c: char| c.is_ascii_digit()))
}

/// `54.1` is 541.
fn tenths(digits: &str) -> Option<u16> {
    let (whole, tenth) = match digits.split_once('.') {
        None => (digits, 0),
        Some((whole, tenth)) if tenth.len() == 1 => (whole, tenth.parse().ok()?),
        Some(_) => return None,
    };
    let whole: u16 = whole.parse().ok()?;
    whole.checked_mul(10)?.checked_add(tenth)
}

fn no_code(key: &Spanned<String>, example: &str) -> Diagnostic {
    Diagnostic::error(Code(802), both!("`{}` is not a code", "`{}` — не функция", key.get_ref()))
        .at(wide(key.span()), both!("expected a key like {example}", "ожидался ключ вида {example}"))
        .help(both!(
            "write the capital letter and the number; keys with a point stand in quotes",
            "напишите прописную букву и число; ключ с точкой берётся в кавычки"
        ))
}

fn action(code: GCode, key: &Spanned<String>, row: &CodeRow) -> Result<Action, Diagnostic> {
    if let Some(refusal) = refusal(key, row.does.is_some(), row.refuse.as_deref(), row.help.as_deref())? {
        return Ok(Action::Refuse { reason: refusal.0, help: refusal.1 });
    }
    let Some(does) = &row.does else {
        return Err(Diagnostic::error(
            Code(805),
            both!(
                "{code} says neither what it does nor why it is refused",
                "у {code} не сказано ни что она делает, ни почему отвергнута"
            ),
        )
        .at(
            wide(key.span()),
            both!(
                "expected `does`, or `refuse` with `help`",
                "ожидалось `does` или `refuse` вместе с `help`"
            ),
        )
        .help(both!(
            "write `{} = {{ group = {}, does = \"pass\" }}` if it moves nothing",
            "если она ничего не двигает, напишите `{} = {{ group = {}, does = \"pass\" }}`",
            key.get_ref(),
            row.group
        )));
    };
    let offset = |action| match (action, &row.offset) {
        (Action::WorkOffset(_), Some(name)) => Action::WorkOffset(name.clone()),
        (action, _) => action,
    };
    action_named(does.get_ref(), code).map(offset).ok_or_else(|| {
        let nearest = nearest(does.get_ref())
            .map_or(Text::EMPTY, |name| both!("did you mean \"{name}\"? ", "имелось в виду \"{name}\"? "));
        Diagnostic::error(
            Code(804),
            both!("`{}` is not something a code does", "`{}` — такого функции не делают", does.get_ref()),
        )
        .at(wide(does.span()), both!("{code} cannot do this", "{code} этого не может"))
        .help(both!(
            "{nearest}known are: {}",
            "{nearest:#}известны: {}",
            action_names().collect::<Vec<_>>().join(", ")
        ))
    })
}

/// Reason and way out, where a row refuses; both or neither must be there.
fn refusal(
    key: &Spanned<String>,
    does: bool,
    refuse: Option<&str>,
    help: Option<&str>,
) -> Result<Option<(Text, Text)>, Diagnostic> {
    let name = key.get_ref();
    let wrong =
        |message: Text, label: Text| Err(Diagnostic::error(Code(805), message).at(wide(key.span()), label));
    match (refuse, help) {
        (Some(_), _) if does => wrong(
            both!("{name} both does something and is refused", "{name} и что-то делает, и отвергнута"),
            both!("keep one of the two", "оставьте одно из двух"),
        ),
        (Some(reason), Some(help)) => Ok(Some((russian::text(reason), russian::text(help)))),
        (Some(_), None) => wrong(
            both!("{name} is refused without a way out", "{name} отвергнута, а выхода не указано"),
            both!("add `help`: what the user can do", "добавьте `help`: что делать"),
        ),
        (None, Some(_)) => wrong(
            both!("{name} has a way out but is not refused", "у {name} указан выход, а она не отвергнута"),
            both!("add `refuse` or remove `help`", "добавьте `refuse` или уберите `help`"),
        ),
        (None, None) => Ok(None),
    }
}

fn m_code(number: u16, key: &Spanned<String>, row: &MRow) -> Result<MCode, Diagnostic> {
    let mut loses_position = [false; 3];
    if let Some(axes) = &row.loses_position {
        for axis in axes.get_ref().chars() {
            let Some(index) = "XYZ".find(axis) else {
                return Err(Diagnostic::error(
                    Code(806),
                    both!("`{axis}` is not a linear axis", "`{axis}` — не линейная ось"),
                )
                .at(wide(axes.span()), both!("expected some of X, Y, Z", "ожидались какие-то из X, Y, Z")));
            };
            loses_position[index] = true;
        }
    }
    let refuse = refusal(key, row.switches.is_some(), row.refuse.as_deref(), row.help.as_deref())?;
    Ok(MCode {
        number,
        after_motion: row.after_motion,
        loses_position,
        ends_program: row.ends_program,
        slash_arguments: row.slash_arguments,
        changes_tool: row.changes_tool,
        switches: row.switches.as_deref().map(russian::text),
        tip: None,
        calls: row.calls,
        refuse,
    })
}

fn command(key: &Spanned<String>, row: &CommandRow) -> Result<Command, Diagnostic> {
    let name = key.get_ref();
    let sound = name.len() > 1
        && name.starts_with(|c: char| c.is_ascii_uppercase() || matches!(c, '#' | '$'))
        && name[1..].chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    if !sound {
        return Err(Diagnostic::error(
            Code(802),
            both!("`{name}` is not a command's name", "`{name}` — не имя команды"),
        )
        .at(
            wide(key.span()),
            both!(
                "expected capital letters, at least two",
                "ожидались прописные латинские буквы, не меньше двух"
            ),
        ));
    }
    // With few arguments it does something, with more it is refused.
    let does = row.does.is_some() && row.passes_with.is_none();
    let refuse = refusal(key, does, row.refuse.as_deref(), row.help.as_deref())?;
    let action = match &row.does {
        None => None,
        Some(does) => Some(action_named(does.get_ref(), GCode(0)).ok_or_else(|| {
            Diagnostic::error(
                Code(804),
                both!(
                    "`{}` is not something a command does",
                    "`{}` — такого команды не делают",
                    does.get_ref()
                ),
            )
            .at(wide(does.span()), both!("{name} cannot do this", "{name} этого не может"))
        })?),
    };
    Ok(Command { name: name.clone(), action, refuse, passes_with: row.passes_with })
}

/// A sign of a lathe; `None`, and what is wrong noted, where it cannot be read.
fn lathe(row: &LatheRow, wrong: &mut Vec<Diagnostic>) -> Option<LatheSign> {
    let mut codes = Vec::with_capacity(row.codes.len());
    for code in &row.codes {
        match number_behind(code.get_ref(), 'G').and_then(tenths) {
            Some(tenths) => codes.push(GCode(tenths)),
            None => {
                wrong.push(no_code(code, "G50"));
                return None;
            }
        }
    }
    let digits = match &row.digits {
        None => None,
        Some(written) => match written.get_ref().as_bytes() {
            [letter @ b'A'..=b'Z', count @ b'2'..=b'8'] => Some((*letter, *count - b'0')),
            _ => {
                wrong.push(
                    Diagnostic::error(
                        Code(806),
                        both!(
                            "`{}` is no letter and count",
                            "`{}` — не буква с числом цифр",
                            written.get_ref()
                        ),
                    )
                    .at(
                        wide(written.span()),
                        both!(
                            "expected a letter and how many digits, like T4",
                            "ожидались буква и число цифр, например T4"
                        ),
                    ),
                );
                return None;
            }
        },
    };
    Some(LatheSign {
        codes,
        commands: row.commands.clone(),
        alone: row.alone,
        with: checks::set_of_letters(row.with.as_ref(), wrong),
        without: checks::set_of_letters(row.without.as_ref(), wrong),
        digits,
        sure: row.sure,
        says: russian::text(&row.says),
        mill: russian::text(&row.mill),
    })
}

/// Sorted rows; a second row of the same code is reported at its key.
fn unique<T, K: Ord>(
    mut rows: Vec<(Range<usize>, T)>,
    key: impl Fn(&T) -> K,
    wrong: &mut Vec<Diagnostic>,
) -> Vec<T> {
    rows.sort_by(|(at, a), (bt, b)| key(a).cmp(&key(b)).then(at.start.cmp(&bt.start)));
    for pair in rows.windows(2) {
        if key(&pair[0].1) == key(&pair[1].1) {
            wrong.push(
                Diagnostic::error(
                    Code(803),
                    both!("a code stands twice in the table", "функция стоит в таблице дважды"),
                )
                .at(
                    wide(pair[1].0.clone()),
                    both!("the same code as in another row", "та же функция, что и в другой строке"),
                )
                .help(both!(
                    "remove one of the rows: `G1` and `G01` are the same code",
                    "уберите одну из строк: `G1` и `G01` — одна и та же функция"
                )),
            );
        }
    }
    rows.into_iter().map(|(_, row)| row).collect()
}
