//! Blocks out: passed as they are, or rewritten.

use diagnostic::{Code, Diagnostic, both};
use nc_dialect::Dialect;
use nc_syntax::{Block, GCode, Item, ItemKind, PlainLine, Value};

use crate::edit::{Piece, WordEdit};
use crate::habits::{Habits, Increments, Modes, line_end};
use crate::numbers::BlockNumbers;
use crate::splice::{Place, Splices, Style, bit, letters, number_span};
use crate::words::{WORD_NOT_EDITABLE, find_word, is_after_motion, missing, motion_code};

/// A block longer than the control takes.
const BLOCK_TOO_LONG: Code = Code(601);
/// 15 digits are read back exactly; no more.
const MOST_STEPS: u64 = 1_000_000_000_000_000;

/// Writes blocks one after the other, in the order of the program.
///
/// Knows what the output's text looks like so far and which motion code is in force *in the output*;
/// nothing else is carried from block to block.
#[derive(Clone, Debug)]
pub struct Emitter<'d> {
    dialect: &'d Dialect,
    numbers: Option<&'d BlockNumbers>,
    habits: Habits,
    modes: Modes,
    /// Blocks that may be skipped are under way: their switches, and the motion code in force before them.
    aside: Option<(u16, Option<GCode>)>,
}

impl<'d> Emitter<'d> {
    /// At the start of a program, with the codes in force that the dialect says.
    #[must_use]
    pub fn new(dialect: &'d Dialect) -> Self {
        Self { dialect, numbers: None, habits: Habits::new(), modes: Modes::initial(dialect), aside: None }
    }

    /// Gives inserted blocks N numbers that `numbers` shows to be free, if the dialect wants them;
    /// without this, or where the gap is too small, inserted blocks have no number.
    #[must_use]
    pub fn with_numbers(mut self, numbers: &'d BlockNumbers) -> Self {
        self.numbers = Some(numbers).filter(|_| self.dialect.output.number_inserted_blocks);
        self
    }

    /// True where every further block would be written alike.
    #[must_use]
    pub fn continues_as(&self, other: &Self) -> bool {
        self.habits == other.habits && self.modes == other.modes && self.aside == other.aside
    }

    /// Motion code in force in the output.
    #[must_use]
    pub fn motion(&self) -> Option<GCode> {
        self.modes.motion()
    }

    /// Before any block that is not one of plain coordinates: behind blocks that may be skipped, a motion code that
    /// they changed is in force or not.
    pub fn meet(&mut self, block: &Block<'_>) {
        let switches = block.switches();
        if (switches == 0 && self.aside.is_none()) || !block.acts() {
            return;
        }
        if let Some((_, motion)) = self.aside.take_if(|(open, _)| *open != switches)
            && motion != self.modes.motion()
        {
            self.modes.forget_motion();
        }
        if switches != 0 && self.aside.is_none() {
            self.aside = Some((switches, self.modes.motion()));
        }
    }

    /// Copies a block that no edit touches.
    pub fn pass(&mut self, block: &Block<'_>, out: &mut Vec<u8>) {
        self.habits.learn(block);
        self.modes.read(self.dialect, block);
        out.extend_from_slice(block.bytes);
    }

    /// Writes one or more blocks in place of one.
    ///
    /// The first piece is the block itself with the words of `pieces[0]` edited; its comment and every
    /// other word stay. Later pieces are new blocks: block delete copied, a number if there is a free
    /// one, the words that the piece writes. What the control executes after the motion (M0, M5, M9, M30,
    /// G9) moves to the last piece. A motion code is written where the one in force in the output differs.
    /// Where nothing changes, the bytes come out as they are.
    ///
    /// # Errors
    /// VP0601 where a block becomes longer than the control takes; VP0603 where a word to keep or replace
    /// is missing, doubled, or not a plain number. `out` is then as it was.
    pub fn rewrite(
        &mut self,
        block: &Block<'_>,
        pieces: &[Piece],
        out: &mut Vec<u8>,
    ) -> Result<(), Diagnostic> {
        let start = out.len();
        let result = self.write_pieces(block, pieces, out);
        if result.is_err() {
            out.truncate(start);
        }
        result
    }

    fn write_pieces(
        &mut self,
        block: &Block<'_>,
        pieces: &[Piece],
        out: &mut Vec<u8>,
    ) -> Result<(), Diagnostic> {
        let Some((first, later)) = pieces.split_first() else {
            return Err(Diagnostic::error(
                WORD_NOT_EDITABLE,
                both!("a block was replaced by nothing", "кадр заменён пустотой"),
            )
            .at(block.offset..block.offset + block.bytes.len() as u64, both!("this block", "этот кадр"))
            .help(both!(
                "this is a fault of vpost; please report it with the program",
                "это ошибка vpost; сообщите о ней, приложив программу"
            )));
        };
        let written = |edit: &WordEdit| {
            if let WordEdit::Write { counts, .. } = edit { counts.unsigned_abs() } else { 0 }
        };
        if pieces.iter().flat_map(|piece| &piece.words).any(|(_, edit)| written(edit) >= MOST_STEPS) {
            return Err(Diagnostic::error(
                WORD_NOT_EDITABLE,
                both!("a corrected word of more than 15 digits", "исправленное слово длиннее 15 цифр"),
            )
            .at(block.file_range(), both!("exact in no control", "точно этого не хранит ни одна стойка"))
            .help(both!(
                "no machine goes there: check the unit and the decimal points of this block",
                "так далеко не ходит ни один станок: проверьте единицу и десятичные точки этого кадра"
            )));
        }
        let separator = self.habits.learn(block);
        let in_force = self.modes.motion_for(self.dialect, block);
        self.modes.read(self.dialect, block);
        let style = Style {
            long_words: &self.dialect.marks.long_words,
            habits: &self.habits,
            separator: separator.unwrap_or(self.habits.separator),
            increments: Increments::new(&self.dialect.numbers, &self.modes),
        };
        let (content, end) = self.split_end(block);
        // A last line without an end needs one as soon as something follows it.
        let end_between = if end.is_empty() { style.habits.line_end } else { end };

        let mut from = out.len();
        let stays = |item: &Item| later.is_empty() || !is_after_motion(self.dialect, item.kind);
        if !(block.items.iter().all(stays)
            && self.write_numbers(block, first, in_force, &style, content, out))
        {
            out.truncate(from);
            let mut splices = Splices::default();
            splices.make_first_piece(self.dialect, block, (first, later), in_force)?;
            splices.write(block, content, &style, out);
        }
        if let Some(code) = first.motion {
            self.modes.write(self.dialect, code);
        }
        self.check_length(block, &out[from..], content.len())?;

        let mut number = self.free_number(block, later.len());
        for (index, piece) in later.iter().enumerate() {
            out.extend_from_slice(end_between);
            from = out.len();
            let mut line = Line { out, separator: style.separator, started: false };
            self.write_later_piece(block, piece, number, &style, &mut line)?;
            if index + 1 == later.len() {
                self.write_after_motion(block, &mut line);
            }
            number = number.map(|number| number + 1);
            if let Some(code) = piece.motion {
                self.modes.write(self.dialect, code);
            }
            self.check_length(block, &out[from..], 0)?;
        }
        out.extend_from_slice(end);
        Ok(())
    }

    /// Copies a plain line: [`Emitter::pass`] for those who come by millions.
    ///
    /// Of G codes it may hold only the motion code in force in the output.
    #[inline]
    pub fn pass_line(&mut self, line: &PlainLine<'_>, out: &mut Vec<u8>) {
        self.habits.learn_line(line);
        out.extend_from_slice(line.bytes);
    }

    /// Writes a plain line in which nothing but its X, Y and Z words change: [`Emitter::rewrite`] for those who come by
    /// millions.
    ///
    /// * `counts` – what X, Y, Z become, in steps of `10^-decimals`; `None` for words that stay or are not there
    /// * `names` – which of them the line has words for: at least one; the others are put in
    ///
    /// Of G codes the line may hold only the motion code in force in the output, which is also that of its motion.
    ///
    /// # Errors
    /// VP0601 as in `rewrite`; `out` is then as it was.
    #[inline]
    pub fn rewrite_line(
        &mut self,
        line: &PlainLine<'_>,
        counts: [Option<i64>; 3],
        names: [bool; 3],
        decimals: [u8; 3],
        out: &mut Vec<u8>,
    ) -> Result<(), Diagnostic> {
        let separator = self.habits.learn_line(line);
        let style = Style {
            long_words: &self.dialect.marks.long_words,
            habits: &self.habits,
            separator: separator.unwrap_or(self.habits.separator),
            increments: Increments::new(&self.dialect.numbers, &self.modes),
        };
        let from = out.len();
        let content = line.content();
        let mut done = 0;
        let mut missing = [0, 1, 2].map(|axis| if names[axis] { None } else { counts[axis] });
        // Mostly there is none.
        let inserts = missing != [None; 3];
        let mut left = names.iter().filter(|named| **named).count();
        for word in line.words() {
            let letter @ b'X'..=b'Z' = word.letter() else { continue };
            let axis = usize::from(letter - b'X');
            left -= 1;
            if inserts && missing[..axis] != [None; 3][..axis] {
                // In front of the first word that comes behind it in the order of words.
                let start = word.span().start as usize;
                out.extend_from_slice(&content[done..start]);
                done = start;
                for (before, counts) in missing[..axis].iter_mut().enumerate() {
                    style.put_axis(before, counts.take(), decimals, Place::Before, out);
                }
            }
            let (replaced, place) = (word.number(), word.number_span());
            if let Some(counts) = counts[axis]
                && !style.same_value(letter, replaced, counts, decimals[axis])
            {
                // A byte or two: cheaper one by one than by a call.
                content[done..place.start as usize].iter().for_each(|byte| out.push(*byte));
                style.write_in_place(word, counts, decimals[axis], out);
                done = place.end as usize;
            }
            if inserts && left == 0 {
                // Behind the last one.
                out.extend_from_slice(&content[done..place.end as usize]);
                done = place.end as usize;
                for (behind, counts) in missing.iter_mut().enumerate() {
                    style.put_axis(behind, counts.take(), decimals, Place::After, out);
                }
            }
        }
        if done < content.len() {
            out.extend_from_slice(&content[done..]);
        }
        let limit = self.dialect.output.max_block_bytes as usize;
        if limit != 0 && out.len() - from > limit.max(content.len()) {
            let block = Block { bytes: line.bytes, offset: line.offset, line: line.line, items: Vec::new() };
            let too_long = self.check_length(&block, &out[from..], content.len());
            out.truncate(from);
            return too_long;
        }
        line.end().iter().for_each(|byte| out.push(*byte));
        Ok(())
    }

    /// The common case in one pass over the words: only numbers of words that are there already change.
    ///
    /// `false` where it is another case; `out` then holds a part of the block.
    fn write_numbers(
        &self,
        block: &Block<'_>,
        piece: &Piece,
        in_force: Option<GCode>,
        style: &Style<'_>,
        content: &[u8],
        out: &mut Vec<u8>,
    ) -> bool {
        // Words to be put in or taken out make another case.
        let own = letters(block.words().map(|word| word.letter).filter(|letter| *letter != b'G'));
        let fits = |(letter, edit): &(u8, WordEdit)| (own & bit(*letter) != 0) != (*edit == WordEdit::Remove);
        if !piece.words.iter().all(fits) {
            return false;
        }
        let mut motion_is_right = piece.motion.is_none() || piece.motion == in_force;
        let mut seen = 0_u32;
        let mut done = 0;
        for item in &block.items {
            let ItemKind::Word { letter, value } = item.kind else { continue };
            if letter == b'G' {
                if piece.motion.is_some()
                    && let Some(own) = motion_code(self.dialect, item.kind)
                {
                    if piece.motion != Some(own) {
                        return false;
                    }
                    motion_is_right = true;
                }
                continue;
            }
            let Some((_, edit)) = piece.words.iter().find(|(edited, _)| *edited == letter) else { continue };
            if seen & bit(letter) != 0 {
                return false;
            }
            seen |= bit(letter);
            match *edit {
                WordEdit::Keep | WordEdit::Remove => {}
                WordEdit::Write { counts, decimals } => {
                    let Value::Number(replaced) = value else { return false };
                    if !style.same_value(letter, replaced, counts, decimals) {
                        let number = number_span(block, item.span);
                        // A byte or two: cheaper one by one than by a call.
                        content[done..number.start as usize].iter().for_each(|byte| out.push(*byte));
                        style.write_number(letter, Some(replaced), counts, decimals, out);
                        done = number.end as usize;
                    }
                }
            }
        }
        if !motion_is_right {
            return false;
        }
        out.extend_from_slice(&content[done..]);
        true
    }

    /// The block without what ends it, and what ends it.
    fn split_end<'a>(&self, block: &Block<'a>) -> (&'a [u8], &'a [u8]) {
        let mut at = block.bytes.len() - line_end(block.bytes).len();
        if let Some(mark) = self.dialect.marks.end_of_block
            && let Some(before) = block.bytes[..at].trim_ascii_end().strip_suffix(&[mark])
            && block.items.last().is_none_or(|item| item.span.end as usize <= before.len())
        {
            at = before.len();
        }
        block.bytes.split_at(at)
    }

    fn check_length(&self, block: &Block<'_>, text: &[u8], original: usize) -> Result<(), Diagnostic> {
        let limit = self.dialect.output.max_block_bytes as usize;
        if limit == 0 || text.len() <= limit.max(original) {
            return Ok(());
        }
        Err(Diagnostic::error(
            BLOCK_TOO_LONG,
            both!("the corrected block has {} characters, the control takes {limit}", "в исправленном кадре знаков {}, а стойка принимает {limit}", text.len()),
        )
        .at(
            block.file_range(),
            both!("becomes `{}`", "станет `{}`", String::from_utf8_lossy(text)),
        )
        .help(both!("move the comment to a line of its own, or raise `max_block_bytes` in the grammar if the control takes more", "перенесите комментарий в отдельную строку или увеличьте `max_block_bytes` в таблице диалекта, если стойка принимает больше")))
    }

    /// First of the numbers for `count` inserted blocks.
    fn free_number(&self, block: &Block<'_>, count: usize) -> Option<u32> {
        let own = block.items.iter().find_map(|item| match item.kind {
            ItemKind::Word { letter: b'N', value: Value::Number(number) } => number.integer(),
            _ => None,
        })?;
        let own = u32::try_from(own).ok()?;
        self.numbers?.free_after(own, u32::try_from(count).ok()?, self.dialect.output.max_block_number)
    }

    fn write_later_piece(
        &self,
        block: &Block<'_>,
        piece: &Piece,
        number: Option<u32>,
        style: &Style<'_>,
        line: &mut Line<'_>,
    ) -> Result<(), Diagnostic> {
        for item in &block.items {
            match item.kind {
                ItemKind::Skip => line.add(block.text(item.span)),
                ItemKind::Word { letter: b'N', .. } => {
                    if let Some(number) = number {
                        let width = block.text(item.span).iter().filter(|byte| byte.is_ascii_digit()).count();
                        line.blank();
                        style.write_letter(b'N', line.out);
                        style.write_padded(number, width, line.out);
                    }
                }
                _ => {}
            }
        }
        if let Some(motion) = piece.motion.filter(|_| piece.motion != self.modes.motion()) {
            line.blank();
            style.write_g(motion, line.out);
        }
        let rank = |(letter, _): &(u8, WordEdit)| crate::splice::rank(*letter);
        let mut words = std::borrow::Cow::Borrowed(piece.words.as_slice());
        if !words.is_sorted_by_key(rank) {
            words.to_mut().sort_by_key(rank);
        }
        for &(letter, edit) in words.iter() {
            match edit {
                WordEdit::Remove => {}
                WordEdit::Keep => {
                    let (span, _) = find_word(block, letter)?.ok_or_else(|| missing(block, letter))?;
                    line.add(block.text(span));
                }
                WordEdit::Write { counts, decimals } => {
                    // The block's G and M words are codes of its own, not spellings of this one (`G4` of a
                    // cycle's dwell).
                    let own = if matches!(letter, b'G' | b'M') { None } else { find_word(block, letter)? };
                    let replaced = own.and_then(|(_, value)| match value {
                        Value::Number(number) => Some(number),
                        Value::Expression | Value::Missing => None,
                    });
                    line.blank();
                    style.write_letter(letter, line.out);
                    style.write_number(letter, replaced, counts, decimals, line.out);
                }
            }
        }
        Ok(())
    }

    /// What the control does behind a block's motion stands in the last of its pieces.
    fn write_after_motion(&self, block: &Block<'_>, line: &mut Line<'_>) {
        for item in &block.items {
            if is_after_motion(self.dialect, item.kind) {
                line.add(block.text(item.span));
            }
        }
    }
}

/// A new block being written: words with the file's separator between them.
struct Line<'o> {
    out: &'o mut Vec<u8>,
    separator: &'static [u8],
    started: bool,
}

impl Line<'_> {
    fn blank(&mut self) {
        if self.started {
            self.separator.iter().for_each(|byte| self.out.push(*byte));
        }
        self.started = true;
    }

    fn add(&mut self, text: &[u8]) {
        self.blank();
        self.out.extend_from_slice(text);
    }
}
