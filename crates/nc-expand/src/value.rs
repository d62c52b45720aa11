//! What a variable can hold.

/// Which variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variable {
    /// `#500`
    Numbered(u32),
    /// `#<name>`, by its place in [`Names`].
    Named(NameId),
}

/// A value as far as it is known before the program runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Value {
    /// A number, the same in every double precision.
    Number(f64),
    /// A number whose last digits depend on the control's library: a sine and all that is computed from it.
    Rounded(f64),
    /// Fanuc's empty variable: 0 in arithmetic, and a word with it is not there.
    Null,
    /// Known on the machine only, because this variable is.
    Unknown(Variable),
}

impl Value {
    pub(crate) const fn digits(self) -> Digits {
        if matches!(self, Self::Rounded(_)) { Digits::Rounded } else { Digits::Exact }
    }
}

/// The last digits of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Digits {
    /// The same on every control.
    Exact,
    /// In doubt: they depend on the control's library.
    Rounded,
}

impl Digits {
    pub(crate) const fn of(self, value: f64) -> Value {
        match self {
            Self::Exact => Value::Number(value),
            Self::Rounded => Value::Rounded(value),
        }
    }
}

/// A name's place in [`Names`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct NameId(pub(crate) u32);

/// A program of a file: `O100`, or Okuma's `OSUB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Program {
    Number(u32),
    Name(NameId),
}

impl Program {
    /// In capitals, a number with four digits.
    pub(crate) fn written(self, names: &Names) -> String {
        match self {
            Self::Number(number) => format!("O{number:04}"),
            Self::Name(name) => names.name(name).to_ascii_uppercase(),
        }
    }
}

/// Names of variables and O-words: lower case, without blanks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names {
    /// Names of Siemens' language, which stand without `#`.
    pub(crate) bare: bool,
    /// Variables that the program declares, and whether they hold whole numbers.
    declared: std::collections::BTreeMap<NameId, bool>,
    names: Vec<String>,
    places: std::collections::BTreeMap<String, NameId>,
}

impl Names {
    /// The place of a name as written.
    pub(crate) fn id(&mut self, written: &[u8]) -> NameId {
        let name: String = String::from_utf8_lossy(written)
            .chars()
            .filter(|c| !c.is_whitespace())
            .map(|c| c.to_ascii_lowercase())
            .collect();
        if let Some(id) = self.places.get(&name) {
            return *id;
        }
        let id = NameId(u32::try_from(self.names.len()).unwrap_or(u32::MAX));
        self.names.push(name.clone());
        self.places.insert(name, id);
        id
    }

    pub(crate) fn name(&self, id: NameId) -> &str {
        self.names.get(id.0 as usize).map_or("", String::as_str)
    }

    /// LinuxCNC: a name that starts with `_` is known everywhere.
    pub(crate) fn is_global(&self, id: NameId) -> bool {
        self.name(id).starts_with('_')
    }

    /// DEF
    pub(crate) fn declare(&mut self, id: NameId, whole: bool) {
        self.declared.insert(id, whole);
    }

    pub(crate) fn is_declared(&self, id: NameId) -> bool {
        self.declared.contains_key(&id)
    }

    /// It holds whole numbers.
    pub(crate) fn is_whole(&self, id: NameId) -> bool {
        self.declared.get(&id) == Some(&true)
    }

    /// As it is written in a program.
    pub(crate) fn show(&self, variable: Variable) -> String {
        match variable {
            Variable::Numbered(number) => format!("#{number}"),
            Variable::Named(id) if self.bare => self.name(id).to_ascii_uppercase(),
            Variable::Named(id) => format!("#<{}>", self.name(id)),
        }
    }
}
