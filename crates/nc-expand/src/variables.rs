//! The store of variables: which are local, which are known, which may be written.

use std::collections::BTreeMap;

use nc_syntax::Macros;

use crate::evaluate::{Fault, Variables};
use crate::value::{NameId, Names, Value, Variable};

/// A value given from outside: `--set "#500=12.5"`, `--set "#<_x>=1"`, `--set "#1=#0"` (empty).
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    variable: Name,
    /// `None`: empty.
    value: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
enum Name {
    Number(u32),
    Name(String),
}

impl Preset {
    /// Reads `#500=12.5`. `None` where it is not written so.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (name, value) = text.split_once('=')?;
        let name = name.trim();
        // Siemens' names stand alone.
        if name.starts_with(|c: char| c.is_ascii_alphabetic() || matches!(c, '_' | '$')) {
            let value = value.trim().parse::<f64>().ok().filter(|v| v.is_finite())?;
            return Some(Self { variable: Name::Name(name.to_owned()), value: Some(value) });
        }
        let name = name.strip_prefix('#')?.trim();
        let variable = match name.strip_prefix('<').and_then(|name| name.strip_suffix('>')) {
            Some(name) if !name.trim().is_empty() => Name::Name(name.to_owned()),
            Some(_) => return None,
            None => Name::Number(name.parse().ok().filter(|number| *number > 0)?),
        };
        let value = match value.trim() {
            "#0" => None,
            value => Some(value.parse::<f64>().ok().filter(|v| v.is_finite())?),
        };
        Some(Self { variable, value })
    }
}

/// Why a variable cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Protected {
    /// The control acts on it.
    System,
    /// `#3000`: an alarm.
    Alarm,
    /// `#0`, or a number the control does not have.
    None,
}

/// Local variables of a caller, kept while a subprogram has its own.
#[derive(Clone, Debug)]
pub(crate) struct Saved {
    numbered: Vec<Value>,
    named: BTreeMap<u32, Value>,
}

/// All variables.
#[derive(Clone, Debug)]
pub(crate) struct Store {
    macros: Macros,
    /// `#0` up to the last one that programs may write.
    numbered: Vec<Value>,
    /// Given ones beyond.
    system: BTreeMap<u32, Value>,
    /// Of the running program, by name.
    local: BTreeMap<u32, Value>,
    /// `#<_name>`
    global: BTreeMap<u32, Value>,
    /// Which names are global.
    is_global: Vec<bool>,
    /// Variables that outlive the program and were written.
    pub(crate) kept: Option<Variable>,
}

const FANUC_FIRST_SYSTEM: u32 = 1000;
const LINUXCNC_FIRST_SYSTEM: u32 = 5001;
const LINUXCNC_LAST: u32 = 5602;

impl Store {
    pub(crate) fn new(macros: Macros, names: &mut Names, presets: &[Preset]) -> Self {
        let size = if macros == Macros::Fanuc { FANUC_FIRST_SYSTEM } else { LINUXCNC_FIRST_SYSTEM };
        let mut store = Self {
            macros,
            numbered: (0..size).map(|number| Value::Unknown(Variable::Numbered(number))).collect(),
            system: BTreeMap::new(),
            local: BTreeMap::new(),
            global: BTreeMap::new(),
            is_global: Vec::new(),
            kept: None,
        };
        store.numbered[0] = Value::Null;
        for preset in presets {
            let value = preset.value.map_or(Value::Null, Value::Number);
            match &preset.variable {
                Name::Number(number) => match store.numbered.get_mut(*number as usize) {
                    Some(slot) => *slot = value,
                    None => {
                        store.system.insert(*number, value);
                    }
                },
                Name::Name(name) => {
                    let id = names.id(name.as_bytes());
                    store.learn(names);
                    store.set_named(id, value);
                }
            }
        }
        store
    }

    /// Makes room for names that were read since.
    pub(crate) fn learn(&mut self, names: &Names) {
        let mut at = self.is_global.len();
        while !names.name(NameId(at as u32)).is_empty() {
            self.is_global.push(names.is_global(NameId(at as u32)));
            at += 1;
        }
    }

    pub(crate) fn set_named(&mut self, id: NameId, value: Value) {
        let named = if self.has_global(id) { &mut self.global } else { &mut self.local };
        named.insert(id.0, value);
    }

    fn has_global(&self, id: NameId) -> bool {
        self.is_global.get(id.0 as usize) == Some(&true)
    }

    /// Writes a variable.
    pub(crate) fn set(&mut self, variable: Variable, value: Value) -> Result<(), Protected> {
        match variable {
            Variable::Named(id) => self.set_named(id, value),
            Variable::Numbered(0) => return Err(Protected::None),
            Variable::Numbered(number) => {
                let Some(slot) = self.numbered.get_mut(number as usize) else {
                    return Err(match self.macros {
                        Macros::Fanuc if number == 3000 => Protected::Alarm,
                        Macros::LinuxCnc if number > LINUXCNC_LAST => Protected::None,
                        _ => Protected::System,
                    });
                };
                *slot = value;
                let outlives = match self.macros {
                    Macros::Fanuc => number >= 100,
                    _ => number > 30,
                };
                if outlives && self.kept.is_none() {
                    self.kept = Some(variable);
                }
            }
        }
        Ok(())
    }

    /// Local numbered variables: `#1` to here.
    const fn last_local(&self) -> usize {
        if matches!(self.macros, Macros::Fanuc) { 33 } else { 30 }
    }

    /// Gives a called program its own local variables: arguments where given, else what the control puts there.
    pub(crate) fn enter(&mut self, arguments: &[(u32, Value)]) -> Saved {
        let last = self.last_local();
        let empty = if self.macros == Macros::Fanuc { Value::Null } else { Value::Number(0.0) };
        let numbered = self.numbered[1..=last].to_vec();
        self.numbered[1..=last].fill(empty);
        for (number, value) in arguments {
            self.numbered[*number as usize] = *value;
        }
        Saved { numbered, named: std::mem::take(&mut self.local) }
    }

    /// Gives the caller its own back.
    pub(crate) fn leave(&mut self, saved: Saved) {
        let last = self.last_local();
        self.numbered[1..=last].copy_from_slice(&saved.numbered);
        self.local = saved.named;
    }
}

impl Variables for Store {
    fn value(&self, variable: Variable) -> Result<Value, Fault> {
        match variable {
            Variable::Numbered(number) => match self.numbered.get(number as usize) {
                Some(_) if number == 0 && self.macros == Macros::LinuxCnc => Err(Fault::NoVariable(0.0)),
                Some(value) => Ok(*value),
                None if self.macros == Macros::LinuxCnc && number > LINUXCNC_LAST => {
                    Err(Fault::NoVariable(f64::from(number)))
                }
                None => Ok(self.system.get(&number).copied().unwrap_or(Value::Unknown(variable))),
            },
            Variable::Named(id) => {
                let named = if self.has_global(id) { &self.global } else { &self.local };
                Ok(named.get(&id.0).copied().unwrap_or(Value::Unknown(variable)))
            }
        }
    }

    fn exists(&self, variable: Variable) -> Option<bool> {
        let Variable::Named(id) = variable else { return Some(true) };
        if self.has_global(id) {
            // An earlier program may have left it, or the machine has it.
            self.global.get(&id.0).map(|_| true)
        } else {
            Some(self.local.contains_key(&id.0))
        }
    }
}
