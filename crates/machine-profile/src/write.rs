//! A profile's text, changed without losing what else stands in it.

use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value, value};

use crate::profile::Calibrated;

/// The text of a profile that is being made or changed; comments and order stay.
#[derive(Clone, Debug)]
pub struct ProfileText {
    document: DocumentMut,
}

impl ProfileText {
    /// A new profile of a machine.
    #[must_use]
    pub fn new(name: &str, chain: &str, control: Option<&str>) -> Self {
        let mut document = DocumentMut::new();
        document["format"] = value(1);
        document["name"] = value(name);
        if let Some(control) = control {
            document["control"] = value(control);
        }
        document["chain"] = value(chain);
        Self { document }
    }

    /// An existing profile's text; `None` where it is not TOML ([`crate::load`] says why).
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        text.parse().ok().map(|document| Self { document })
    }

    /// Gives every table file the profile names another name.
    pub fn rename_tables(&mut self, rename: &mut dyn FnMut(&str) -> String) {
        rename_tables(&mut self.document, rename);
    }

    /// When, how warm, with what and how well it was measured: known facts replace earlier ones, unknown ones go.
    pub fn set_calibrated(&mut self, calibrated: &Calibrated) {
        let mut table = InlineTable::new();
        let mut number = |key: &str, number: Option<f64>| {
            if let Some(number) = number {
                table.insert(key, Value::from(number));
            }
        };
        number("temperature_c", calibrated.temperature_c);
        number("repeatability_um", calibrated.repeatability_um);
        number("uncertainty_um", calibrated.uncertainty_um);
        for (key, text) in [("date", &calibrated.date), ("instrument", &calibrated.instrument)] {
            if let Some(text) = text {
                table.insert(key, Value::from(text.as_str()));
            }
        }
        self.set(&["calibrated"], Value::InlineTable(table));
    }

    /// Sets a text.
    pub fn set_text(&mut self, path: &[&str], text: &str) {
        self.set(path, Value::from(text));
    }

    /// Sets a number, rounded to what is written: `decimals` behind the point.
    pub fn set_number(&mut self, path: &[&str], number: f64, decimals: i32) {
        self.set(path, rounded(number, decimals));
    }

    /// Sets three numbers, rounded.
    pub fn set_triple(&mut self, path: &[&str], numbers: [f64; 3], decimals: i32) {
        let array: Array = numbers.into_iter().map(|n| rounded(n, decimals)).collect();
        self.set(path, Value::Array(array));
    }

    /// Sets lower and upper end, rounded.
    pub fn set_range(&mut self, path: &[&str], [low, high]: [f64; 2], decimals: i32) {
        let array: Array = [rounded(low, decimals), rounded(high, decimals)].into_iter().collect();
        self.set(path, Value::Array(array));
    }

    /// True where the profile says something there.
    #[must_use]
    pub fn says(&self, path: &[&str]) -> bool {
        let mut item = Some(self.document.as_item());
        for key in path {
            item = item.and_then(Item::as_table_like).and_then(|table| table.get(key));
        }
        item.is_some()
    }

    /// Says what a tilt of a rotary axis means where the profile does not: what it carries leans with it, as it was fitted.
    pub fn say_tilt(&mut self, axis: &str) {
        if !self.says(&["rotary", axis, "tilt"]) {
            self.set_text(&["rotary", axis, "tilt"], "body");
        }
    }

    /// Sets the line an axis was measured along: where the other axes stood and the tool vector.
    pub fn set_measured_at(&mut self, axis: char, others: &[(char, f64)], tool_mm: [f64; 3]) {
        let mut table = InlineTable::new();
        for (letter, at) in others {
            table.insert(letter.to_string(), rounded(*at, 6));
        }
        table.insert("tool", Value::Array(tool_mm.into_iter().map(|n| rounded(n, 6)).collect()));
        self.set(&["axis", &axis.to_string(), "measured_at_mm"], Value::InlineTable(table));
    }

    /// Takes a key out.
    pub fn remove(&mut self, path: &[&str]) {
        let Some((last, groups)) = path.split_last() else { return };
        let mut table: Option<&mut dyn toml_edit::TableLike> = Some(self.document.as_table_mut());
        for group in groups {
            table = table.and_then(|t| t.get_mut(group)).and_then(Item::as_table_like_mut);
        }
        if let Some(table) = table {
            table.remove(last);
        }
    }

    fn set(&mut self, path: &[&str], new: Value) {
        let Some((last, groups)) = path.split_last() else { return };
        let mut table: &mut dyn toml_edit::TableLike = self.document.as_table_mut();
        for (depth, group) in groups.iter().enumerate() {
            let item = table.entry(group).or_insert_with(|| {
                let mut own = Table::new();
                // [axis.X] needs no [axis] above it.
                own.set_implicit(depth + 1 < groups.len());
                Item::Table(own)
            });
            if item.as_table_like().is_none() {
                *item = Item::Table(Table::new());
            }
            let Some(own) = item.as_table_like_mut() else { return };
            table = own;
        }
        match table.get_mut(last) {
            Some(item) => replace(item, new),
            None => {
                table.insert(last, Item::Value(new));
            }
        }
    }
}

/// Gives every table file that a profile names another name; what keeps its name keeps its spelling.
pub fn rename_tables(profile: &mut DocumentMut, rename: &mut dyn FnMut(&str) -> String) {
    for group in ["axis", "rotary"] {
        let Some(axes) = profile.get_mut(group).and_then(Item::as_table_like_mut) else { continue };
        for (_, axis) in axes.iter_mut() {
            for file in ["errors", "errors_negative"] {
                rename_at(axis, file, rename);
            }
        }
    }
    if let Some(tracker) = profile.get_mut("tracker") {
        for file in ["x", "y", "z"] {
            rename_at(tracker, file, rename);
        }
    }
    if let Some(field) = profile.get_mut("field") {
        rename_at(field, "file", rename);
    }
}

fn rename_at(table: &mut Item, key: &str, rename: &mut dyn FnMut(&str) -> String) {
    if let Some(item) = table.as_table_like_mut().and_then(|t| t.get_mut(key))
        && let Some(old) = item.as_str()
    {
        let new = rename(old);
        if new != old {
            replace(item, Value::from(new));
        }
    }
}

/// Another value, the comment behind it kept.
fn replace(item: &mut Item, mut new: Value) {
    if let Some(old) = item.as_value() {
        *new.decor_mut() = old.decor().clone();
    }
    *item = Item::Value(new);
}

fn rounded(number: f64, decimals: i32) -> Value {
    let scale = 10f64.powi(decimals);
    let number = (number * scale).round() / scale;
    // Minus zero is nothing anybody measured.
    Value::from(if number == 0.0 { 0.0 } else { number })
}

impl std::fmt::Display for ProfileText {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.document)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_touched_stays() {
        let text = "# a machine\nformat = 1\nname = \"M\"\nchain = \"[w X Y b Z t]\"\n\n[axis.X]\nerrors = \"x.csv\" # from May\n\n[squareness]\nEC0Y_urad = 1.0\n";
        let mut profile = ProfileText::parse(text).unwrap();
        profile.set_number(&["squareness", "EC0Y_urad"], -1180.04, 1);
        profile.set_number(&["squareness", "EA0Z_urad"], 0.01, 1);
        profile.rename_tables(&mut |old| format!("new/{old}"));
        profile.set_text(&["axis", "Y", "errors"], "new/y.csv");
        let out = profile.to_string();
        assert!(out.starts_with("# a machine\nformat = 1\n"), "{out}");
        assert!(out.contains("errors = \"new/x.csv\" # from May\n"), "{out}");
        assert!(out.contains("EC0Y_urad = -1180.0\nEA0Z_urad = 0.0\n"), "{out}");
        assert!(profile.says(&["axis", "X", "errors"]) && profile.says(&["name"]));
        assert!(!profile.says(&["axis", "X", "travel_mm"]) && !profile.says(&["name", "X"]));
        profile.set_range(&["axis", "X", "travel_mm"], [-1.0004, 2.0], 3);
        assert!(profile.to_string().contains("travel_mm = [-1.0, 2.0]"), "{profile}");
        assert!(out.contains("[axis.Y]\nerrors = \"new/y.csv\"\n") && !out.contains("[axis]"), "{out}");
    }
}
