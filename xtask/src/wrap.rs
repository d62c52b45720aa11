//! Markdown whose lines fit a screen.

/// Longest line of prose, in characters; tables and blocks may be wider.
const WIDEST: usize = 120;

/// The text with its long lines broken, paragraph by paragraph; tables, headings and blocks stay.
pub(crate) fn wrapped(text: &str) -> String {
    let mut out = String::new();
    let mut paragraph: Vec<&str> = Vec::new();
    let mut in_block = false;
    for line in text.lines() {
        let fence = line.trim_start().starts_with("```");
        in_block ^= fence;
        let stays = in_block || fence || line.trim().is_empty() || line.starts_with(['|', '#', '<']);
        if stays || opens_item(line) {
            flush(&mut paragraph, &mut out);
        }
        if stays {
            out += line;
            out.push('\n');
        } else {
            paragraph.push(line);
        }
    }
    flush(&mut paragraph, &mut out);
    out
}

/// True where a line starts an item of a list.
fn opens_item(line: &str) -> bool {
    marker(line.trim_start()).is_some()
}

/// The mark of a list's item with the space behind it.
fn marker(text: &str) -> Option<&str> {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    let sign = text[digits..].chars().next()?;
    let fits = if digits > 0 { sign == '.' } else { "-*+>".contains(sign) };
    (fits && text[digits + 1..].starts_with(' ')).then(|| &text[..digits + 2])
}

/// Writes a paragraph, broken anew where one of its lines is too long.
fn flush(paragraph: &mut Vec<&str>, out: &mut String) {
    let lines = std::mem::take(paragraph);
    let Some(first) = lines.first() else { return };
    if lines.iter().all(|line| line.chars().count() <= WIDEST) {
        lines.iter().for_each(|line| *out += &format!("{line}\n"));
        return;
    }
    let indent = first.len() - first.trim_start().len();
    let mark = marker(first.trim_start()).unwrap_or_default();
    // A quotation repeats its sign, the other lines of an item stand under its text.
    let follow = if mark == "> " { mark.to_owned() } else { " ".repeat(mark.len()) };
    let text: Vec<&str> =
        lines.iter().map(|line| line.trim().strip_prefix(mark).unwrap_or(line.trim())).collect();
    let mut line = format!("{}{mark}", " ".repeat(indent));
    let mut width = line.chars().count();
    let mut empty = true;
    for word in words(&text.join(" ")) {
        let long = width + 1 + word.chars().count() > WIDEST;
        if long && !empty {
            *out += &format!("{line}\n");
            line = format!("{}{follow}", " ".repeat(indent));
            width = line.chars().count();
            empty = true;
        }
        if !empty {
            line.push(' ');
            width += 1;
        }
        line += &word;
        width += word.chars().count();
        empty = false;
    }
    *out += &format!("{line}\n");
}

/// The words of a paragraph; what stands in backquotes is one.
fn words(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut open = false;
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match found.last_mut() {
            // At the start of a line it would open a list, a heading or a table.
            Some(last) if open || opens_item(&format!("{word} ")) || word.starts_with(['#', '|']) => {
                *last += &format!(" {word}");
            }
            _ => found.push(word.to_owned()),
        }
        open ^= word.matches('`').count() % 2 == 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_break_between_words_and_nowhere_else() {
        let long = "word ".repeat(30);
        let made = wrapped(&format!("# {long}\n\n{long}\nshort\n\n| {long} |\n\n```sh\n{long}\n```\n"));
        let lines: Vec<&str> = made.lines().collect();
        assert_eq!(lines[2].len(), 119);
        assert_eq!(lines[3], format!("{}short", "word ".repeat(6)));
        assert_eq!((lines[0].len(), lines[5].len(), lines[8].len()), (152, 154, 150));
        assert_eq!(wrapped(&made), made);
    }

    #[test]
    fn items_quotations_and_code_stay_what_they_are() {
        let long = "word ".repeat(22);
        let item = wrapped(&format!("- {long}two `a b c` end\n- next\n"));
        assert_eq!(item, format!("- {}two\n  `a b c` end\n- next\n", long));
        let quoted = wrapped(&format!("> {long}\n> {long}\n"));
        assert!(quoted.lines().all(|line| line.starts_with("> word") && line.len() <= 120), "{quoted}");
        // Neither a number with a point nor a dash may open a list.
        let dashed = wrapped(&format!("{long}{} - 12. and\n", "w".repeat(10)));
        assert!(dashed.lines().all(|line| !opens_item(line)), "{dashed}");
    }
}
