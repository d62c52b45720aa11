//! Languages that tests read with.

use nc_syntax::{Macros, Marks, Named, Semicolon, Spells};

/// Of the conventional type: `;` ends blocks, no spaces in numbers.
pub(crate) fn conventional() -> Marks {
    Marks { semicolon: Semicolon::None, end_of_block: Some(b';'), spaces_inside: false, ..Marks::default() }
}

/// A language with commands, statements, and M codes that only switch.
#[derive(Default)]
pub(crate) struct Language {
    pub(crate) marks: Marks,
    /// Name, and whether it takes the rest of its block.
    pub(crate) commands: &'static [(&'static str, bool)],
    pub(crate) macros: Macros,
    pub(crate) switches: &'static [u16],
}

impl Spells for Language {
    fn marks(&self) -> &Marks {
        &self.marks
    }

    fn named(&self, text: &[u8]) -> Option<Named> {
        let word: Vec<u8> = text.iter().copied().take_while(u8::is_ascii_alphanumeric).collect();
        let (name, takes_block) =
            *self.commands.iter().find(|(name, _)| name.as_bytes().eq_ignore_ascii_case(&word))?;
        Some(Named { length: name.len(), takes_block })
    }

    fn only_switches(&self, m_code: u16) -> bool {
        self.switches.contains(&m_code)
    }

    fn macros(&self) -> Macros {
        self.macros
    }
}
