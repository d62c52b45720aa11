//! What stands in one block, by letter.

use std::ops::Range;

use diagnostic::{Diagnostic, Edit, Refusal, Text, both, refusal};
use nc_dialect::{Action, CodeEntry, Dialect, MCode, TWord};
use nc_syntax::{Block, GCode, Invalid, ItemKind, Letters, Number, Span, Value};
use smallvec::SmallVec;

use crate::codes;
use crate::refusals::words as refusal;

/// A refusal on its way out; boxed, so that the way of success stays small.
pub(crate) type Outcome<T> = Result<T, Box<Diagnostic>>;

/// X, Y, Z and their index.
pub(crate) const LINEAR: [u8; 3] = *b"XYZ";
/// A, B, C.
pub(crate) const ROTARY: [u8; 3] = *b"ABC";
pub(crate) const LINEAR_LETTERS: Letters = Letters::of(&LINEAR);
pub(crate) const ROTARY_LETTERS: Letters = Letters::of(&ROTARY);
pub(crate) const AXIS_LETTERS: Letters = LINEAR_LETTERS.or(ROTARY_LETTERS);
pub(crate) const SECONDARY_LETTERS: Letters = Letters::of(b"UVW");
pub(crate) const CENTRE_LETTERS: Letters = Letters::of(b"IJK");
pub(crate) const ARC_LETTERS: Letters = Letters::of(b"IJKR");

/// A G code of the block with the row that explains it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Preparatory<'d> {
    pub(crate) entry: &'d CodeEntry,
    pub(crate) span: Span,
}

/// The words of a block; every letter but G and M at most once, every value a plain number.
pub(crate) struct Words<'b, 'a, 'd> {
    pub(crate) block: &'b Block<'a>,
    pub(crate) codes: SmallVec<[Preparatory<'d>; 8]>,
    pub(crate) m_codes: SmallVec<[(u16, Span); 4]>,
    /// Commands by name that do something.
    pub(crate) commands: SmallVec<[(&'d Action, Span); 2]>,
    pub(crate) letters: Letters,
    /// `%`
    pub(crate) percent: bool,
    /// X, Y, Z whose word is an increment by its letter: U or W.
    pub(crate) by_increment: [bool; 3],
    /// X words are diameters: half of them is meant.
    pub(crate) diameters: bool,
    pub(crate) dialect: &'d Dialect,
    /// 1 + index of the item, by letter.
    at: [u32; 26],
}

impl<'b, 'a, 'd> Words<'b, 'a, 'd> {
    /// Nothing read yet.
    #[inline]
    pub(crate) fn new(block: &'b Block<'a>, dialect: &'d Dialect) -> Self {
        Self {
            block,
            codes: SmallVec::new(),
            m_codes: SmallVec::new(),
            commands: SmallVec::new(),
            letters: Letters::NONE,
            percent: false,
            by_increment: [false; 3],
            diameters: false,
            dialect,
            at: [0; 26],
        }
    }

    /// Reads the items once; whether the codes agree with each other is not its business, except that
    /// two codes of one modal group are refused here.
    pub(crate) fn read(&mut self) -> Outcome<()> {
        let block = self.block;
        let words = self;
        for (index, item) in block.items.iter().enumerate() {
            match item.kind {
                ItemKind::Word { letter, .. } if !letter.is_ascii_uppercase() => {
                    return Err(Box::new(block.unreadable_at(Invalid::Text, item.span)));
                }
                ItemKind::Word { letter, value: Value::Number(number) } => match letter {
                    b'G' => words.preparatory(number, item.span)?,
                    b'M' => words.miscellaneous(number, item.span)?,
                    _ => words.letter(letter, index, item.span)?,
                },
                ItemKind::Word { letter: b'T', value: Value::Expression }
                    if words.dialect.edge_in_d && block.text(item.span).ends_with(b"\"") =>
                {
                    words.letter(b'T', index, item.span)?;
                }
                ItemKind::Word { letter, value: Value::Expression } => {
                    return Err(
                        words.not_static(item.span, &both!("the value of {}", "значение {}", letter as char))
                    );
                }
                ItemKind::Word { letter, value: Value::Missing } => {
                    return Err(words.refuse(refusal::no_number(letter as char), item.span));
                }
                ItemKind::Comment | ItemKind::Name => {}
                ItemKind::Skip => {
                    if !words.codes.is_empty()
                        || !words.m_codes.is_empty()
                        || !words.letters.without(Letters::of(b"NO")).is_empty()
                    {
                        return Err(words.refuse(refusal::BLOCK_DELETE_IN_MIDDLE, item.span));
                    }
                }
                ItemKind::Percent => words.percent = true,
                ItemKind::CommaWord { letter, .. } => {
                    return Err(words.refuse(refusal::corner_cannot_be_resolved(letter as char), item.span));
                }
                ItemKind::BracketCommand => words.command(item.span)?,
                ItemKind::Flow => {
                    return Err(words.not_static(item.span, &both!("this", "это")));
                }
                ItemKind::Invalid(reason) => {
                    // `L1,3`
                    let letter = block.text(item.span).first().map_or(0, u8::to_ascii_uppercase);
                    let refused = words.refused_word(letter, item.span);
                    return Err(refused.unwrap_or_else(|| Box::new(block.unreadable_at(reason, item.span))));
                }
            }
        }
        if words.dialect.turning.as_ref().is_some_and(|turning| turning.increments) {
            words.increments()?;
        }
        if words.dialect.t_word == TWord::Changes && words.has(Letters::of(b"T")) {
            words.change_tool();
        }
        Ok(())
    }

    /// T is the M code that changes the tool, where that does not stand beside it.
    fn change_tool(&mut self) {
        let changes = |row: &&MCode| row.changes_tool;
        let Some(row) = self.dialect.m_codes.iter().find(changes) else { return };
        if self.m_codes.iter().all(|(number, _)| *number != row.number) {
            self.m_codes.push((row.number, self.span(Letters::of(b"T"))));
        }
    }

    /// U and W stand for X and Z.
    fn increments(&mut self) -> Outcome<()> {
        for (own, axis) in [(b'U', 0), (b'W', 2)] {
            let (letter, at) = (LINEAR[axis], usize::from(own - b'A'));
            if self.at[at] == 0 {
                continue;
            }
            if self.has(Letters::of(&[letter])) {
                let span = self.span(Letters::of(&[own, letter]));
                return Err(self.refuse(
                    refusal!(codes::LETTER_TWICE;
                        "{} stands beside {} in this block",
                        "в этом кадре {} стоит рядом с {}", own as char, letter as char;
                        "both say where one axis goes", "оба слова говорят, куда идёт одна ось";
                        "write {} or {}", "напишите {} или {}", letter as char, own as char
                    ),
                    span,
                ));
            }
            self.by_increment[axis] = true;
            self.at[usize::from(letter - b'A')] = std::mem::take(&mut self.at[at]);
            self.letters = self.letters.without(Letters::of(&[own])).or(Letters::of(&[letter]));
        }
        Ok(())
    }

    /// True where A3, B3 or C3 stands in the block, which are read as U, V, W.
    pub(crate) fn names_direction(&self) -> bool {
        let long = |letter: &u8| {
            self.number(*letter).is_some_and(|(_, span)| {
                let text = self.block.text(span);
                text.len() > 1 && text[1] == b'3' && text[0].to_ascii_uppercase() == letter - b'U' + b'A'
            })
        };
        // A secondary axis beside them would be taken for one.
        let mut named = b"UVW".iter().filter(|letter| self.number(**letter).is_some()).peekable();
        self.has(SECONDARY_LETTERS) && named.peek().is_some() && named.all(long)
    }

    /// True in a lathe's program.
    pub(crate) fn turns(&self) -> bool {
        self.dialect.turning.is_some()
    }

    /// Letters of a lathe's program that add to axes which a lathe of two axes has not, or would be taken for a tool length; and
    /// whether U and W are increments there.
    pub(crate) fn letters_of_other_axes(&self) -> (Letters, bool) {
        match &self.dialect.turning {
            Some(turning) if turning.increments => (Letters::of(b"VH"), true),
            Some(turning) if turning.offset_in_t => (Letters::of(b"H"), false),
            _ => (Letters::NONE, false),
        }
    }

    /// True where nothing is executed: names, comments, `%`, N and O alone.
    pub(crate) fn is_idle(&self) -> bool {
        self.codes.is_empty()
            && self.m_codes.is_empty()
            && self.commands.is_empty()
            && self.letters.without(Letters::of(b"NO")).is_empty()
    }

    pub(crate) const fn has(&self, letters: Letters) -> bool {
        self.letters.any(letters)
    }

    /// The number of a letter with its place.
    pub(crate) fn number(&self, letter: u8) -> Option<(Number, Span)> {
        let at = self.at[usize::from(letter - b'A')];
        if at == 0 {
            return None;
        }
        match self.block.items[at as usize - 1] {
            nc_syntax::Item { kind: ItemKind::Word { value: Value::Number(number), .. }, span } => {
                Some((number, span))
            }
            _ => None,
        }
    }

    /// What stands between the quotation marks of `T="MILL 12"`.
    pub(crate) fn quoted(&self, letter: u8) -> Option<String> {
        let at = self.at[usize::from(letter - b'A')];
        let item = self.block.items.get((at as usize).checked_sub(1)?)?;
        let text = self.block.text(item.span);
        let open = text.iter().position(|byte| *byte == b'"')?;
        let name = text.get(open + 1..text.len() - 1)?;
        Some(String::from_utf8_lossy(name).into_owned())
    }

    /// Value of a length or angle word in the unit it is written in.
    ///
    /// A number without a point counts least increments where the dialect says so. Angles have the
    /// increment of millimetre words (0.001 degree at IS-B).
    pub(crate) fn coordinate(&self, letter: u8, inch: bool) -> Option<f64> {
        let (number, _) = self.number(letter)?;
        let value = self.dialect.numbers.length(number, inch).to_f64();
        Some(if self.diameters && letter == b'X' { 0.5 * value } else { value })
    }

    /// Value as written: F, P, L.
    pub(crate) fn plain(&self, letter: u8) -> Option<f64> {
        self.number(letter).map(|(number, _)| number.decimal.to_f64())
    }

    /// A whole number that is not negative: H, L, K.
    pub(crate) fn whole(&self, letter: u8) -> Outcome<Option<u32>> {
        let Some((number, span)) = self.number(letter) else { return Ok(None) };
        match whole(number).and_then(|value| u32::try_from(value).ok()) {
            Some(value) => Ok(Some(value)),
            None => {
                Err(self
                    .refuse(refusal::not_a_whole_number(&self.text(span), u32::MAX, letter as char), span))
            }
        }
    }

    /// From the first to the last of these letters.
    pub(crate) fn span(&self, letters: Letters) -> Span {
        let mut span: Option<Span> = None;
        for (index, at) in self.at.iter().enumerate() {
            if *at != 0 && letters.contains(b'A' + index as u8) {
                let here = self.block.items[*at as usize - 1].span;
                span = Some(
                    span.map_or(here, |s| Span { start: s.start.min(here.start), end: s.end.max(here.end) }),
                );
            }
        }
        span.unwrap_or(Span { start: 0, end: self.block.bytes.len() as u32 })
    }

    /// The letters of a set that stand in the block, as text: `X, Z`.
    pub(crate) fn names(&self, letters: Letters) -> String {
        self.letters.and(letters).names()
    }

    pub(crate) fn text(&self, span: Span) -> String {
        String::from_utf8_lossy(self.block.text(span)).into_owned()
    }

    pub(crate) fn refuse(&self, refusal: Refusal, span: Span) -> Box<Diagnostic> {
        Box::new(refusal.at(self.file_span(span)))
    }

    /// The same of what is right with a word put in front of it.
    pub(crate) fn refuse_without(&self, word: &str, refusal: Refusal, span: Span) -> Box<Diagnostic> {
        let at = self.file_span(span);
        let edit = Edit::insert(at.start, format!("{word} "));
        Box::new(refusal.at(at).mended_by(edit))
    }

    /// The same of what stands in the place of a text.
    pub(crate) fn refuse_in_place_of(&self, text: String, refusal: Refusal, span: Span) -> Box<Diagnostic> {
        let at = self.file_span(span);
        Box::new(refusal.at(at.clone()).mended_by(Edit::replace(at, text)))
    }

    /// The refusal of a code whose name begins the message.
    pub(crate) fn refuse_code(&self, refusal: Refusal, span: Span) -> Box<Diagnostic> {
        let what = refusal.message;
        let message = both!("{} {what}", "{} {what:#}", self.text(span));
        self.refuse(Refusal { message, ..refusal }, span)
    }

    fn file_span(&self, span: Span) -> Range<u64> {
        self.block.file_span(span)
    }

    fn letter(&mut self, letter: u8, index: usize, span: Span) -> Outcome<()> {
        if let Some(refused) = self.refused_word(letter, span) {
            return Err(refused);
        }
        if letter == b'N' && self.repeats_by_n() {
            return Err(self.refuse_code(refusal::BEHIND_WORDS_OF_BLOCK, span));
        }
        let bit = Letters::of(&[letter]);
        if self.letters.any(bit) {
            let first = self.number(letter).map_or_else(String::new, |(_, first)| self.text(first));
            return Err(self.refuse(refusal::stands_twice(letter as char, first, &self.text(span)), span));
        }
        self.letters = self.letters.or(bit);
        self.at[usize::from(letter - b'A')] = index as u32 + 1;
        Ok(())
    }

    /// The refusal of a word whose letter the table refuses; of its block's code, where that is refused.
    #[inline]
    fn refused_word(&self, letter: u8, span: Span) -> Option<Box<Diagnostic>> {
        let row = self.dialect.refused_words.iter().find(|row| row.letter == letter)?;
        let code = self.codes.iter().find_map(|code| match &code.entry.action {
            Action::Refuse { reason, help } => Some((code.span, reason, help)),
            _ => None,
        });
        let (span, reason, help) = code.unwrap_or((span, &row.reason, &row.help));
        Some(self.refused_code(span, reason, help))
    }

    /// The refusal of a code or a letter by its row of the table.
    pub(crate) fn refused_code(&self, span: Span, reason: &Text, help: &Text) -> Box<Diagnostic> {
        self.refuse(
            refusal!(codes::REFUSED_CODE;
                "{} is refused: {reason}", "{} не принимается: {reason:#}", self.text(span);
                "not understood", "не исполняется";
                help.clone()
            ),
            span,
        )
    }

    /// An N here would repeat the block.
    fn repeats_by_n(&self) -> bool {
        let begun = !self.codes.is_empty() || !self.letters.without(Letters::of(b"O")).is_empty();
        begun && self.dialect.cycle_repeats.contains(&b'N')
    }

    fn preparatory(&mut self, number: Number, span: Span) -> Outcome<()> {
        let entry = number.tenths().and_then(|tenths| self.dialect.code(GCode(tenths)));
        let Some(entry) = entry else {
            return Err(self.refuse(refusal::not_in_table(&self.text(span), &self.dialect.name), span));
        };
        if let Some(other) = self.codes.iter().find(|other| conflict(other.entry, entry)) {
            let (first, second) = (self.text(other.span), self.text(span));
            let message = if other.entry.code == entry.code {
                both!("{second} stands twice in this block", "{second} стоит в этом кадре дважды")
            } else {
                both!(
                    "{first} and {second} stand in one block and exclude each other",
                    "{first} и {second} стоят в одном кадре и исключают друг друга"
                )
            };
            return Err(self.refuse(
                refusal!(codes::SAME_GROUP; message;
                    "{first} stands before it", "перед ним стоит {first}";
                    "write them in two blocks, or remove one", "напишите их двумя кадрами или уберите одну"
                ),
                span,
            ));
        }
        self.codes.push(Preparatory { entry, span });
        Ok(())
    }

    fn miscellaneous(&mut self, number: Number, span: Span) -> Outcome<()> {
        // An M code with decimals or beyond 65535 is no code of any table; it passes like every unknown one.
        if let Some(value) = whole(number).and_then(|value| u16::try_from(value).ok()) {
            let row = self.dialect.m_code(value);
            if let Some(what) = row.and_then(|row| row.switches.as_ref()) {
                let code = GCode(value.saturating_mul(10)).to_string().replace('G', "M");
                return Err(self.refuse(refusal::refused_by_table(code, what), span));
            }
            if let Some((reason, help)) = row.and_then(|row| row.refuse.as_ref()) {
                return Err(self.refused_code(span, reason, help));
            }
            self.m_codes.push((value, span));
        }
        Ok(())
    }

    /// A command by name passes where the dialect's table says that it moves nothing.
    fn command(&mut self, span: Span) -> Outcome<()> {
        let (message, help) = match self.dialect.command(self.block.text(span)) {
            Some(row) => match row.refusal(self.block.text(span)) {
                None => {
                    self.commands.extend(row.action.as_ref().map(|action| (action, span)));
                    return Ok(());
                }
                Some((reason, help)) => (
                    both!("{} is refused: {reason}", "{} не принимается: {reason:#}", row.name),
                    help.clone(),
                ),
            },
            None => (
                both!(
                    "a command that the table of dialect {} does not have",
                    "команда, которой нет в таблице диалекта {}",
                    self.dialect.name
                ),
                both!(
                    "if it moves neither an axis nor the frame, add a row for it to a copy of the grammar and pass that with `--dialect my.toml`",
                    "если она не двигает ни оси, ни системы координат, добавьте для неё строку в копию таблицы диалекта и дайте её ключом `--dialect my.toml`"
                ),
            ),
        };
        Err(self.refuse(
            refusal!(codes::COMMAND; message;
                "it may move the frame or an axis", "может сместить систему координат или двигать ось";
                help
            ),
            span,
        ))
    }

    fn not_static(&self, span: Span, what: &Text) -> Box<Diagnostic> {
        self.refuse(refusal::known_only_while_running(what), span)
    }
}

/// Two codes that may not stand in one block.
fn conflict(a: &CodeEntry, b: &CodeEntry) -> bool {
    if a.group == 0 || b.group == 0 {
        return a.code == b.code;
    }
    let cycle_against_motion = |a: &Action, b: &Action| matches!(a, Action::Cycle(_)) && is_motion(b);
    if cycle_against_motion(&a.action, &b.action) || cycle_against_motion(&b.action, &a.action) {
        return true;
    }
    // G80 beside a motion or a cycle ends the old cycle first; LinuxCNC and Fanuc agree.
    let cancels = |a: &Action, b: &Action| *a == Action::CycleCancel && *b != Action::CycleCancel;
    a.group == b.group && !cancels(&a.action, &b.action) && !cancels(&b.action, &a.action)
}

/// G0 to G3.
pub(crate) const fn is_motion(action: &Action) -> bool {
    matches!(
        action,
        Action::Rapid
            | Action::Line
            | Action::ArcClockwise
            | Action::ArcCounterClockwise
            | Action::Thread
            | Action::Curve(_)
    )
}

/// The value where it is a whole number that is not negative.
fn whole(number: Number) -> Option<u64> {
    number.integer().and_then(|value| u64::try_from(value).ok())
}
