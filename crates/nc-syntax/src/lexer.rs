//! Items inside one block.

use crate::number::{common_number, end_of_garbage, number, skip_spaces};
use crate::spelling::{Colon, Macros, Named, Paren, Semicolon, Spells};
use crate::value::{
    angle_name, assigned, brackets, expression, flat_comment, is_flow_word, is_function, is_short_flow_word,
    is_siemens_word, nested_comment, o_statement,
};
use crate::{Invalid, Item, ItemKind, Number, Span, Value};

/// The facts of a dialect that reading a block needs, ready to be asked a million times a second.
pub(crate) struct Lexer<'d> {
    pub(crate) paren: Paren,
    pub(crate) semicolon: Semicolon,
    end_of_block: Option<u8>,
    percent_words: bool,
    skip: Option<u8>,
    colon: Colon,
    equals_words: bool,
    labels: bool,
    pub(crate) spaces_inside: bool,
    /// Bit n is set where the n-th letter of the alphabet is a word's letter.
    pub(crate) letters: u32,
    long_words: &'d [(String, u8)],
    language: &'d dyn Spells,
    /// No block is written out as others, which have no comments.
    copies_blocks: bool,
    /// Statements and labels are Siemens'.
    siemens: bool,
    /// Statements are Okuma's.
    okuma: bool,
    /// Statements are those of custom macro B, of which two letters suffice.
    fanuc: bool,
}

/// What may stand between items: white space, and what punches, serial lines and DOS left in files.
///
/// NUL padding, DC1–DC4 (reader control), 0x1A (end of file of CP/M), DEL (a rubbed-out row of tape).
pub(crate) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0 | 0x0B | 0x0C | 0x11..=0x14 | 0x1A | 0x7F)
}

/// First byte at or after `at` that is not blank.
pub(crate) fn skip_blanks(bytes: &[u8], mut at: usize) -> usize {
    while let Some(&byte) = bytes.get(at) {
        // Most bytes are decided by the first comparison.
        if (byte > b' ' && byte != 0x7F) || !is_blank(byte) {
            break;
        }
        at += 1;
    }
    at
}

/// Bytes of the line without trailing blanks.
pub(crate) fn trim_end(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|byte| !is_blank(*byte)).map_or(0, |at| at + 1)
}

impl<'d> Lexer<'d> {
    pub(crate) fn new(language: &'d dyn Spells) -> Self {
        let (marks, macros) = (language.marks(), language.macros());
        let mut letters = 0;
        for letter in &marks.letters {
            let letter = letter.to_ascii_uppercase();
            if letter.is_ascii_uppercase() {
                letters |= 1 << (letter - b'A');
            }
        }
        Self {
            paren: marks.paren,
            semicolon: marks.semicolon,
            end_of_block: marks.end_of_block,
            percent_words: marks.percent_words,
            skip: marks.skip,
            colon: marks.colon,
            equals_words: marks.equals_words,
            labels: marks.labels,
            spaces_inside: marks.spaces_inside,
            letters,
            long_words: &marks.long_words,
            language,
            copies_blocks: language.copies_blocks(),
            siemens: macros == Macros::Siemens,
            okuma: macros == Macros::Okuma,
            fanuc: macros == Macros::Fanuc,
        }
    }

    /// Reads the items of `line` (without its end) from `at` on; returns where the block ends.
    ///
    /// That is the line's end, or one past the mark that ends the block. With `name_line` a first item that
    /// reads as prose is the program's name.
    pub(crate) fn block(&self, line: &[u8], mut at: usize, name_line: bool, items: &mut Vec<Item>) -> usize {
        let first = skip_blanks(line, at);
        if line.get(first) == Some(&b'%') {
            at = self.percent(line, first, items);
        } else if name_line && self.reads_as_prose(&line[first..]) {
            at = self.push_name(line, first, items);
        }
        loop {
            at = skip_blanks(line, at);
            let Some(&byte) = line.get(at) else {
                return line.len();
            };
            if Some(byte) == self.end_of_block {
                return at + 1;
            }
            if byte == b'%' && self.percent_words {
                at = self.percent(line, at, items);
                continue;
            }
            // A letter and a plain number: what nearly every item is. O may start a statement.
            let letter = byte.to_ascii_uppercase();
            if self.has_letter(letter)
                && letter != b'O'
                && let Some((number, end)) = common_number(line, at + 1, self.spaces_inside)
            {
                push(items, ItemKind::Word { letter, value: Value::Number(number) }, at, end);
                at = end;
                continue;
            }
            let (kind, end) =
                if byte.is_ascii_alphabetic() { self.letter(line, at) } else { self.other(line, at) };
            push(items, kind, at, end);
            at = end;
        }
    }

    fn starts_comment(&self, byte: u8) -> bool {
        (byte == b'(' && self.paren != Paren::None)
            || (byte == b';' && self.semicolon != Semicolon::None)
            || Some(byte) == self.end_of_block
    }

    /// A `%` and the name beside it; returns where that ends.
    fn percent(&self, line: &[u8], at: usize, items: &mut Vec<Item>) -> usize {
        push(items, ItemKind::Percent, at, at + 1);
        let name = skip_blanks(line, at + 1);
        if line.get(name).is_none_or(|byte| self.starts_comment(*byte)) {
            return name;
        }
        if !self.percent_words {
            return self.push_name(line, name, items);
        }
        let end = self.end_of_text(line, name);
        push(items, ItemKind::Name, name, end);
        end
    }

    const fn has_letter(&self, letter: u8) -> bool {
        letter.is_ascii_uppercase() && self.letters & 1 << (letter - b'A') != 0
    }

    /// A line that starts with a whole word of prose or with a digit is no block.
    fn reads_as_prose(&self, text: &[u8]) -> bool {
        let run = letters(text);
        match run {
            0 => text.first().is_some_and(u8::is_ascii_digit),
            1 => false,
            _ => {
                let function = text.get(run) == Some(&b'[') && is_function(&text[1..run]);
                let command = self.language.named(text).is_some();
                let statement = self.siemens && self.statement(text, 0).is_some();
                !(function || command || is_flow_word(&text[..run]) || statement)
            }
        }
    }

    /// Okuma: `$PART.MIN%`, the file that a program was in, as the control writes it in front of what it sends. True where
    /// that is the whole line.
    pub(crate) fn file_name(&self, line: &[u8], at: usize, items: &mut Vec<Item>) -> bool {
        let start = skip_blanks(line, at);
        let end = at + trim_end(&line[at..]);
        let is_name = self.okuma && end > start + 2 && line[start] == b'$' && line[end - 1] == b'%';
        if is_name {
            push(items, ItemKind::Name, start, end);
        }
        is_name
    }

    fn push_name(&self, line: &[u8], at: usize, items: &mut Vec<Item>) -> usize {
        let stop = self.before_comment(line, at);
        push(items, ItemKind::Name, at, at + trim_end(&line[at..stop]));
        stop
    }

    /// Where the next comment or the mark of the block's end stands, else the end of the line.
    fn before_comment(&self, line: &[u8], at: usize) -> usize {
        line[at..].iter().position(|byte| self.starts_comment(*byte)).map_or(line.len(), |length| at + length)
    }

    /// An item that starts with a letter.
    fn letter(&self, line: &[u8], at: usize) -> (ItemKind, usize) {
        let letter = line[at].to_ascii_uppercase();
        if self.siemens
            && let Some(found) = self.statement(line, at)
        {
            return found;
        }
        if line.get(at + 1).is_some_and(u8::is_ascii_alphabetic) {
            if self.okuma
                && let Some(end) = self.okuma_statement(line, at)
            {
                return self.flow(line, at, end);
            }
            // `OMAIN` and `NEND`, where nothing else begins so.
            let known = || self.language.named(&line[at..]).is_some();
            if self.labels && matches!(letter, b'O' | b'N') && !known() {
                return (ItemKind::Name, at + identifier(&line[at..]));
            }
            if let Some(found) = self.letters(line, at) {
                return found;
            }
        } else if letter == b'O' {
            if let Ok((left, _)) = o_statement(&line[at..]) {
                return self.flow(line, at, line.len() - left.len());
            }
            if let Ok((_, name)) = angle_name(&line[at + 1..]) {
                return (ItemKind::Name, at + 1 + name.len());
            }
        }
        if !self.has_letter(letter) {
            return (ItemKind::Invalid(Invalid::Text), self.end_of_text(line, at));
        }
        if let Some(found) = self.numbered_word(line, at) {
            return found;
        }
        let numbered = self.numbered(line, at).unwrap_or(at + 1);
        match self.value(line, numbered) {
            (Ok(Value::Expression), end) if matches!(letter, b'A' | b'B' | b'C') => {
                let value = direct(&line[numbered..end]).map_or(Value::Expression, Value::Number);
                (ItemKind::Word { letter, value }, end)
            }
            (Ok(value), end) => (ItemKind::Word { letter, value }, end),
            (Err(why), end) => (ItemKind::Invalid(why), end),
        }
    }

    /// `A3=0.5`: a long word with a digit in its name.
    fn numbered_word(&self, line: &[u8], at: usize) -> Option<(ItemKind, usize)> {
        if !line.get(at + 1).is_some_and(u8::is_ascii_digit) {
            return None;
        }
        let named = |name: &str| {
            line.get(at..at + name.len()).is_some_and(|text| text.eq_ignore_ascii_case(name.as_bytes()))
                && line.get(skip_spaces(line, at + name.len())) == Some(&b'=')
        };
        let (name, letter) = self.long_words.iter().find(|(name, _)| named(name))?;
        Some(match self.value(line, at + name.len()) {
            (Ok(value), end) => (ItemKind::Word { letter: *letter, value }, end),
            (Err(why), end) => (ItemKind::Invalid(why), end),
        })
    }

    /// `M1=3` and `S2=500` are M3 of the first spindle and S500 of the second: where their `=` stands.
    fn numbered(&self, line: &[u8], at: usize) -> Option<usize> {
        if !self.equals_words || !matches!(line[at].to_ascii_uppercase(), b'M' | b'S') {
            return None;
        }
        let digits = line[at + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        (digits > 0 && line.get(at + 1 + digits) == Some(&b'=')).then_some(at + 1 + digits)
    }

    /// Siemens: a label (`NAME:`), a statement (`IF R1>5 GOTOF NAME`) or assignments (`R1=5 R2=R1*2`).
    fn statement(&self, line: &[u8], at: usize) -> Option<(ItemKind, usize)> {
        let length = identifier(&line[at..]);
        let name = &line[at..at + length];
        // `L100 P2` calls a subprogram.
        let call = name.first().is_some_and(|first| first.eq_ignore_ascii_case(&b'L'))
            && length > 1
            && name[1..].iter().all(u8::is_ascii_digit)
            && line.get(at + length) != Some(&b'=');
        // `CALL BLOCK A TO B` runs a part of the program; other calls are commands.
        let behind = skip_spaces(line, at + length);
        let section = name.eq_ignore_ascii_case(b"CALL")
            && line[behind..behind + identifier(&line[behind..])].eq_ignore_ascii_case(b"BLOCK");
        if is_siemens_word(name) || call || section {
            return Some(self.flow(line, at, at + length));
        }
        let number = name.first().is_some_and(|first| first.eq_ignore_ascii_case(&b'R'))
            && length > 1
            && name[1..].iter().all(u8::is_ascii_digit);
        let long = length > 1 && !name[1].is_ascii_digit();
        if !(number || long) {
            return None;
        }
        let behind = skip_spaces(line, at + length);
        if !matches!(line.get(behind), Some(b':' | b'=')) {
            return None;
        }
        let known = self.language.named(name).is_some()
            || self.long_words.iter().any(|(word, _)| word.as_bytes().eq_ignore_ascii_case(name));
        if known {
            return None;
        }
        match (line.get(behind), line.get(behind + 1)) {
            (Some(b':'), next) if next != Some(&b'=') && long => Some((ItemKind::Name, behind + 1)),
            (Some(b'='), next) if next != Some(&b'=') => Some(self.flow(line, at, at + length)),
            _ => None,
        }
    }

    /// Okuma: `CALL O10`, `RTS`, or a variable and `=`: where its name ends.
    fn okuma_statement(&self, line: &[u8], at: usize) -> Option<usize> {
        let length = identifier(&line[at..]);
        let name = &line[at..at + length];
        if [&b"CALL"[..], b"RTS"].iter().any(|word| word.eq_ignore_ascii_case(name)) {
            return Some(at + length);
        }
        let behind = skip_spaces(line, at + length);
        let assigns = line.get(behind) == Some(&b'=') && line.get(behind + 1) != Some(&b'=');
        let known = self.language.named(&line[at..]).is_some();
        (assigns && !known).then_some(at + length)
    }

    /// Several letters in a row: a statement, a command, a function as value, or nothing a control reads.
    ///
    /// `None` where the first letter is a word's letter and a function follows it.
    #[cold]
    fn letters(&self, line: &[u8], at: usize) -> Option<(ItemKind, usize)> {
        let run = letters(&line[at..]);
        let name = &line[at..at + run];
        if is_flow_word(name) || (self.fanuc && is_short_flow_word(name)) {
            return Some(self.macro_statement(line, at, at + run));
        }
        if line.get(at + run) == Some(&b'=')
            && let Some((_, letter)) =
                self.long_words.iter().find(|(known, _)| known.as_bytes().eq_ignore_ascii_case(name))
        {
            return Some(match self.value(line, at + run) {
                (Ok(value), end) => (ItemKind::Word { letter: *letter, value }, end),
                (Err(why), end) => (ItemKind::Invalid(why), end),
            });
        }
        if let Some(command) = self.language.named(&line[at..]) {
            return Some((ItemKind::BracketCommand, end_of_command(command, line, at)));
        }
        if is_function(&name[1..]) && line.get(skip_spaces(line, at + run)) == Some(&b'[') {
            return None;
        }
        let why = if matches!(&name[1..].to_ascii_lowercase()[..], b"nan" | b"inf" | b"infinity") {
            Invalid::Number
        } else {
            Invalid::Text
        };
        Some((ItemKind::Invalid(why), end_of_garbage(line, at)))
    }

    /// What follows a word's letter, which stands just before `at`.
    fn value(&self, line: &[u8], at: usize) -> (Result<Value, Invalid>, usize) {
        let start = skip_spaces(line, at);
        if self.equals_words && line.get(start) == Some(&b'=') {
            return self.assigned(line, skip_spaces(line, start + 1));
        }
        match line.get(start) {
            Some(b'0'..=b'9' | b'.') => {}
            Some(b'+' | b'-') => {
                let after = skip_spaces(line, start + 1);
                if line
                    .get(after)
                    .is_some_and(|byte| matches!(byte, b'#' | b'[') || byte.is_ascii_alphabetic())
                {
                    return self.expression(line, start);
                }
            }
            Some(b'#' | b'[') => return self.expression(line, start),
            // Only reached with a letter where `letters` saw a function glued to this word's letter.
            Some(byte) if start == at && byte.is_ascii_alphabetic() => return self.expression(line, start),
            _ => return (Ok(Value::Missing), at),
        }
        let (found, end) = number(line, start, self.spaces_inside);
        (found.map(Value::Number), end)
    }

    fn expression(&self, line: &[u8], at: usize) -> (Result<Value, Invalid>, usize) {
        if let Ok((left, _)) = expression(&line[at..]) {
            return (Ok(Value::Expression), line.len() - left.len());
        }
        let stop = self.before_comment(line, at);
        let text = &line[at..stop];
        let open = text.iter().any(|byte| matches!(byte, b'[' | b'<'));
        let why = if open { Invalid::UnclosedBracket } else { Invalid::Number };
        let end = if open { at + trim_end(text) } else { self.end_of_text(line, at) };
        (Err(why), end)
    }

    fn assigned(&self, line: &[u8], at: usize) -> (Result<Value, Invalid>, usize) {
        let stop = line[at..].iter().position(|byte| *byte == b';').map_or(line.len(), |length| at + length);
        let Ok((left, found)) = assigned(&line[at..stop]) else {
            return (Err(Invalid::UnclosedBracket), stop);
        };
        let end = stop - left.len();
        if found.is_empty() {
            return if left.is_empty() {
                (Ok(Value::Missing), at)
            } else {
                (Err(Invalid::UnclosedBracket), stop)
            };
        }
        // `X=10.5Y=3` glues the next word on; a plain number ends by itself.
        if let (Ok(plain), after) = number(line, at, false)
            && (after >= end || line[after].is_ascii_alphabetic())
        {
            return (Ok(Value::Number(plain)), after);
        }
        (Ok(Value::Expression), end)
    }

    /// An item that does not start with a letter.
    fn other(&self, line: &[u8], at: usize) -> (ItemKind, usize) {
        let byte = line[at];
        if self.skip == Some(byte)
            && let Some(end) = self.slash_arguments(line, at)
        {
            return (ItemKind::Comment, end);
        }
        if self.skip == Some(byte)
            && self.copies_blocks
            && let Some(end) = self.switches_only(line, at)
        {
            return (ItemKind::Comment, end);
        }
        match byte {
            b'(' => self.round_bracket(line, at),
            b';' if self.semicolon == Semicolon::Comment => (ItemKind::Comment, line.len()),
            b':' if self.colon == Colon::Comment && skip_blanks(line, 0) == at => {
                (ItemKind::Comment, line.len())
            }
            b':' if self.colon == Colon::Number => match number(line, skip_spaces(line, at + 1), false) {
                (Ok(plain), end) => (ItemKind::Word { letter: b'O', value: Value::Number(plain) }, end),
                (Err(_), _) => (ItemKind::Invalid(Invalid::Text), self.end_of_text(line, at)),
            },
            b'_' | b'$' if self.siemens => self
                .statement(line, at)
                .unwrap_or_else(|| (ItemKind::Invalid(Invalid::Text), self.end_of_text(line, at))),
            b'#' => self.macro_statement(line, at, at + 1),
            b'$' => match self.language.named(&line[at..]) {
                Some(command) => (ItemKind::BracketCommand, end_of_command(command, line, at)),
                None => (ItemKind::Invalid(Invalid::Text), self.end_of_text(line, at)),
            },
            b',' => self.comma_word(line, at),
            b'<' => match angle_name(&line[at..]) {
                Ok((_, name)) => (ItemKind::Name, at + name.len()),
                Err(_) => (ItemKind::Invalid(Invalid::UnclosedBracket), self.end_of_text(line, at)),
            },
            b'[' => match brackets(&line[at..]) {
                Ok((_, found)) => (ItemKind::Invalid(Invalid::Text), at + found.len()),
                Err(_) => (ItemKind::Invalid(Invalid::UnclosedBracket), self.before_comment(line, at)),
            },
            b']' | b')' => (ItemKind::Invalid(Invalid::UnclosedBracket), at + 1),
            _ if self.skip == Some(byte) => {
                let level = line.get(at + 1).is_some_and(u8::is_ascii_digit);
                (ItemKind::Skip, at + 1 + usize::from(level))
            }
            _ => (ItemKind::Invalid(Invalid::Text), self.end_of_text(line, at)),
        }
    }

    /// `M94/1/2`: where the arguments of an M code that has them end.
    fn slash_arguments(&self, line: &[u8], at: usize) -> Option<usize> {
        let is_digit = |byte: &u8| byte.is_ascii_digit();
        let digits = line[..at].iter().rev().take_while(|byte| is_digit(byte)).count();
        let (before, number) = line[..at].split_at(at - digits);
        let number = std::str::from_utf8(number).ok()?.parse().ok()?;
        if !before.last().is_some_and(|byte| byte.eq_ignore_ascii_case(&b'M'))
            || !self.language.has_slash_arguments(number)
        {
            return None;
        }
        let mut end = at;
        while line.get(end) == Some(&b'/') && line.get(end + 1).is_some_and(is_digit) {
            end += 1 + line[end + 1..].iter().take_while(|byte| is_digit(byte)).count();
        }
        (end > at).then_some(end)
    }

    /// `X10. /M8`: a mark in mid-block skips what follows it. Where that is M codes alone which move nothing, and which
    /// stand on the first piece of a split block as on the block, the motion is the same skipped or not: text, to where it
    /// ends.
    fn switches_only(&self, line: &[u8], at: usize) -> Option<usize> {
        let before = line[..at].trim_ascii();
        let number = before.first().is_some_and(|byte| byte.eq_ignore_ascii_case(&b'N'))
            && before[1..].iter().all(u8::is_ascii_digit);
        if before.is_empty() || number {
            return None;
        }
        let mut end = at + 1 + usize::from(line.get(at + 1).is_some_and(u8::is_ascii_digit));
        let mut any = false;
        loop {
            let next = skip_blanks(line, end);
            match line.get(next) {
                Some(b'M' | b'm') => {}
                // What ends the block, or comments on it.
                None | Some(b';') => break,
                Some(byte) if self.starts_comment(*byte) => break,
                Some(_) => return None,
            }
            let digits = line[next + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            let number = std::str::from_utf8(&line[next + 1..next + 1 + digits]).ok()?.parse().ok()?;
            if !self.language.only_switches(number) || line.get(next + 1 + digits) == Some(&b'=') {
                return None;
            }
            (end, any) = (next + 1 + digits, true);
        }
        any.then_some(end)
    }

    fn round_bracket(&self, line: &[u8], at: usize) -> (ItemKind, usize) {
        let (found, kind, why) = match self.paren {
            Paren::None => return (ItemKind::Invalid(Invalid::Text), self.end_of_text(line, at)),
            Paren::Comment { nested: false } => {
                (flat_comment(&line[at..]), ItemKind::Comment, Invalid::UnclosedComment)
            }
            Paren::Comment { nested: true } => {
                (nested_comment(&line[at..]), ItemKind::Comment, Invalid::UnclosedComment)
            }
            Paren::Command => {
                (nested_comment(&line[at..]), ItemKind::BracketCommand, Invalid::UnclosedBracket)
            }
        };
        match found {
            Ok((_, found)) => (kind, at + found.len()),
            Err(_) => (ItemKind::Invalid(why), at + trim_end(&line[at..])),
        }
    }

    /// `,R5.`: the comma stands just before the letter, or blanks do between.
    fn comma_word(&self, line: &[u8], at: usize) -> (ItemKind, usize) {
        let start = skip_spaces(line, at + 1);
        let letter = line.get(start).map_or(0, u8::to_ascii_uppercase);
        let alone = !line.get(start + 1).is_some_and(u8::is_ascii_alphabetic);
        if letter.is_ascii_uppercase() && alone {
            return match self.value(line, start + 1) {
                (Ok(value), end) => (ItemKind::CommaWord { letter, value }, end),
                (Err(why), end) => (ItemKind::Invalid(why), end),
            };
        }
        (ItemKind::Invalid(Invalid::Text), self.end_of_text(line, at))
    }

    /// A statement, or a command where the dialect's table has it by its first word: `#3006=1`, `DPRNT[X#1[3]]`.
    fn macro_statement(&self, line: &[u8], at: usize, least: usize) -> (ItemKind, usize) {
        match self.flow(line, at, least) {
            (ItemKind::Flow, end) if self.language.named(&line[at..]).is_some() => {
                (ItemKind::BracketCommand, end)
            }
            found => found,
        }
    }

    /// A statement to the next comment; brackets must close within it.
    fn flow(&self, line: &[u8], at: usize, least: usize) -> (ItemKind, usize) {
        let stop = self.before_comment(line, least);
        let text = &line[at..stop];
        let end = at + trim_end(text).max(least - at);
        let mut depth = 0_i64;
        for byte in text {
            depth += i64::from(*byte == b'[') - i64::from(*byte == b']');
            if depth < 0 {
                break;
            }
        }
        if depth == 0 { (ItemKind::Flow, end) } else { (ItemKind::Invalid(Invalid::UnclosedBracket), end) }
    }

    /// Where bytes that mean nothing end: at a blank or a comment.
    fn end_of_text(&self, line: &[u8], at: usize) -> usize {
        let rest = &line[at + 1..];
        let length = rest.iter().take_while(|byte| !is_blank(**byte) && !self.starts_comment(**byte)).count();
        at + 1 + length
    }
}

/// How many bytes of a name of Siemens stand at the start: letters, digits, `_`; `$` first.
fn identifier(text: &[u8]) -> usize {
    let starts = |byte: &u8| byte.is_ascii_alphabetic() || matches!(byte, b'_' | b'$');
    if !text.first().is_some_and(starts) {
        return 0;
    }
    1 + text[1..].iter().take_while(|byte| byte.is_ascii_alphanumeric() || **byte == b'_').count()
}

/// `=DC(90)`, `=AC(90)`, `=ACP(90)`, `=ACN(90)` of a rotary axis: its angle.
fn direct(text: &[u8]) -> Option<Number> {
    let inside = text.trim_ascii_start().strip_prefix(b"=")?.trim_ascii();
    let (name, inside) = inside.split_at_checked(identifier(inside))?;
    let inside = inside.trim_ascii_start().strip_prefix(b"(")?.strip_suffix(b")")?.trim_ascii();
    let (plain, end) = number(inside, 0, false);
    let is_way = [&b"DC"[..], b"AC", b"ACP", b"ACN"].iter().any(|way| way.eq_ignore_ascii_case(name));
    plain.ok().filter(|_| is_way && end == inside.len())
}

/// How many ASCII letters stand at the start.
fn letters(text: &[u8]) -> usize {
    text.iter().take_while(|byte| byte.is_ascii_alphabetic()).count()
}

/// A refused command takes the rest of the block with it, to a `;`: whose words they are is not known.
///
/// One that passes takes its value (`LIMS=2000`) or its round brackets only, so that a motion beside it is not overlooked.
fn end_of_command(command: Named, line: &[u8], at: usize) -> usize {
    if command.takes_block {
        let stop = line[at..].iter().position(|byte| *byte == b';').map_or(line.len(), |length| at + length);
        return at + trim_end(&line[at..stop]);
    }
    let end = at + command.length;
    if line.get(end) == Some(&b'=') {
        return end + line[end..].iter().take_while(|byte| !is_blank(**byte) && **byte != b';').count();
    }
    match nested_comment(&line[skip_spaces(line, end)..]) {
        Ok((left, _)) => line.len() - left.len(),
        Err(_) => end,
    }
}

#[inline]
fn push(items: &mut Vec<Item>, kind: ItemKind, start: usize, end: usize) {
    // A block is at most MAX_BLOCK_BYTES long.
    items.push(Item { kind, span: Span { start: start as u32, end: end as u32 } });
}
