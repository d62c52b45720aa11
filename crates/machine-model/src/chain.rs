//! Which axis stands on which: the kinematic chain from workpiece to tool.

use std::fmt;

/// A machine axis by its letter.
///
/// ```
/// use machine_model::Axis;
///
/// let b = Axis::from_letter('B').unwrap();
/// assert!(!b.is_linear());
/// // B turns around Y.
/// assert_eq!((b.direction(), Axis::Y.direction()), (1, 1));
/// assert_eq!(Axis::from_letter('b'), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// Along X.
    X,
    /// Along Y.
    Y,
    /// Along Z.
    Z,
    /// Around X.
    A,
    /// Around Y.
    B,
    /// Around Z.
    C,
}

impl Axis {
    /// All six, linear ones first.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::A, Self::B, Self::C];

    /// From its letter, upper case.
    #[must_use]
    pub fn from_letter(letter: char) -> Option<Self> {
        Self::ALL.into_iter().find(|axis| axis.letter() == letter)
    }
    /// Its letter, upper case.
    #[must_use]
    pub const fn letter(self) -> char {
        ['X', 'Y', 'Z', 'A', 'B', 'C'][self as usize]
    }
    /// True for X, Y, Z.
    #[must_use]
    pub const fn is_linear(self) -> bool {
        (self as usize) < 3
    }
    /// 0, 1, 2 for X, Y, Z and likewise for A, B, C: the direction it moves along or around.
    #[must_use]
    pub const fn direction(self) -> usize {
        self as usize % 3
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.letter())
    }
}

/// Why a text is not a chain.
///
/// ```
/// use machine_model::{Chain, ChainError};
///
/// assert_eq!(Chain::parse("w X Y b Z t"), Err(ChainError::Form));
/// assert!(Chain::parse("[w X Y b Y t]").is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChainError {
    /// No brackets around it, or not one character per link.
    #[error("a chain is written like [w X Y b Z t]: links separated by spaces in square brackets")]
    Form,
    /// A link that is neither an axis nor w, b, t.
    #[error("`{0}` is no link of a chain: expected w, b, t or one of X Y Z A B C")]
    UnknownLink(String),
    /// An axis cannot stand in two places.
    #[error("`{0}` stands in the chain twice")]
    Twice(char),
    /// w first, t last, b between.
    #[error(
        "the chain lacks `{0}`: it begins with w (workpiece), ends with t (tool) and holds b (bed) between them"
    )]
    Lacks(char),
    /// The model needs all three.
    #[error("the chain lacks the linear axis {0}")]
    LacksLinear(char),
    /// Turning axes are modelled at the ends of the chain only.
    #[error(
        "{0} stands between linear axes: turning axes must stand next to the workpiece or next to the tool"
    )]
    RotaryBetweenLinear(char),
}

/// The order of the axes from workpiece to tool, ISO 10791-6 style.
///
/// What stands before the bed carries the workpiece, what stands behind it the tool. For linear axes
/// only the order matters; a rotary axis before the bed turns the workpiece, so the workpiece sees the
/// tool turn by the negative command.
///
/// ```
/// use machine_model::{Axis, Chain};
///
/// // A table that moves in X and Y, a head that moves in Z.
/// let mill = Chain::parse("[w X Y b Z t]").unwrap();
/// assert_eq!(mill.linear(), [Axis::X, Axis::Y, Axis::Z]);
/// assert_eq!(mill.to_string(), "[w X Y b Z t]");
/// // A trunnion: the workpiece turns on C, which turns on A.
/// let five = Chain::parse("[w C A X Y b Z t]").unwrap();
/// assert!(five.has_rotary() && !mill.has_rotary());
/// assert!(five.head().is_empty());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain {
    table: Vec<Axis>,
    linear: [Axis; 3],
    head: Vec<Axis>,
    bed_at: usize,
}

impl Chain {
    /// Reads `[w C A X Y b Z t]`.
    ///
    /// # Errors
    /// [`ChainError`]; every linear axis must be there, no axis twice, and no rotary axis between linear ones.
    pub fn parse(text: &str) -> Result<Self, ChainError> {
        let inner =
            text.trim().strip_prefix('[').and_then(|t| t.strip_suffix(']')).ok_or(ChainError::Form)?;
        let links: Vec<&str> = inner.split_whitespace().collect();
        let mut axes = Vec::new();
        let mut bed_at = None;
        for (place, link) in links.iter().enumerate() {
            let mut letters = link.chars();
            let letter = match (letters.next(), letters.next()) {
                (Some(letter), None) => letter,
                _ => return Err(ChainError::UnknownLink((*link).to_owned())),
            };
            match letter {
                'w' if place == 0 => {}
                't' if place + 1 == links.len() => {}
                'b' if bed_at.is_none() => bed_at = Some(axes.len()),
                'w' | 't' => {
                    let there = if letter == 'w' { links[0] == "w" } else { links[links.len() - 1] == "t" };
                    return Err(if there { ChainError::Twice(letter) } else { ChainError::Lacks(letter) });
                }
                'b' => return Err(ChainError::Twice('b')),
                _ => {
                    let axis = Axis::from_letter(letter)
                        .ok_or_else(|| ChainError::UnknownLink((*link).to_owned()))?;
                    if axes.contains(&axis) {
                        return Err(ChainError::Twice(letter));
                    }
                    axes.push(axis);
                }
            }
        }
        for (end, letter) in [(links.first(), 'w'), (links.last(), 't')] {
            if end.is_none_or(|link| !link.starts_with(letter)) {
                return Err(ChainError::Lacks(letter));
            }
        }
        let bed_at = bed_at.ok_or(ChainError::Lacks('b'))?;
        if let Some(missing) = Axis::ALL[..3].iter().find(|axis| !axes.contains(axis)) {
            return Err(ChainError::LacksLinear(missing.letter()));
        }
        let first = axes.iter().position(|axis| axis.is_linear()).unwrap_or(0);
        if let Some(between) = axes[first..first + 3].iter().find(|axis| !axis.is_linear()) {
            return Err(ChainError::RotaryBetweenLinear(between.letter()));
        }
        // A turning axis on the far side of the bed from its end would turn the linear axes themselves.
        let (table, rest) = axes.split_at(first);
        let head = &rest[3..];
        if let Some(stray) =
            table.get(bed_at).or_else(|| head.get(..bed_at.saturating_sub(first + 3))?.first())
        {
            return Err(ChainError::RotaryBetweenLinear(stray.letter()));
        }
        Ok(Self { table: table.to_vec(), linear: [rest[0], rest[1], rest[2]], head: head.to_vec(), bed_at })
    }

    /// Rotary axes that turn the workpiece, from the workpiece on.
    #[must_use]
    pub fn table(&self) -> &[Axis] {
        &self.table
    }
    /// The linear axes, from workpiece to tool.
    #[must_use]
    pub fn linear(&self) -> [Axis; 3] {
        self.linear
    }
    /// Rotary axes that turn the tool, towards the tool.
    #[must_use]
    pub fn head(&self) -> &[Axis] {
        &self.head
    }
    /// All axes from workpiece to tool.
    pub fn axes(&self) -> impl Iterator<Item = Axis> + '_ {
        self.table.iter().chain(&self.linear).chain(&self.head).copied()
    }
    /// True where the chain names any of A, B, C.
    #[must_use]
    pub fn has_rotary(&self) -> bool {
        !self.table.is_empty() || !self.head.is_empty()
    }
}

impl fmt::Display for Chain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[w")?;
        for (place, axis) in self.axes().enumerate() {
            if place == self.bed_at {
                write!(f, " b")?;
            }
            write!(f, " {axis}")?;
        }
        if self.bed_at == self.axes().count() {
            write!(f, " b")?;
        }
        write!(f, " t]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_and_writes_chains() {
        for text in
            ["[w X Y b Z t]", "[w C A X Y b Z t]", "[w B Z b X Y t]", "[w C b X Y Z B t]", "[w X Y Z b t]"]
        {
            assert_eq!(Chain::parse(text).unwrap().to_string(), text);
        }
        let chain = Chain::parse("[w C A Y X b Z t]").unwrap();
        assert_eq!(chain.table(), [Axis::C, Axis::A]);
        assert_eq!(chain.linear(), [Axis::Y, Axis::X, Axis::Z]);
        assert!(chain.head().is_empty() && chain.has_rotary());
    }

    #[test]
    fn refuses_what_is_no_chain() {
        let error = |text| Chain::parse(text).unwrap_err();
        assert_eq!(error("w X Y b Z t"), ChainError::Form);
        assert_eq!(error("[w X Y b X Z t]"), ChainError::Twice('X'));
        assert_eq!(error("[w X b Y b Z t]"), ChainError::Twice('b'));
        assert_eq!(error("[w X w Y b Z t]"), ChainError::Twice('w'));
        assert_eq!(error("[X Y b Z t]"), ChainError::Lacks('w'));
        assert_eq!(error("[X w Y b Z t]"), ChainError::Lacks('w'));
        assert_eq!(error("[w X Y b Z]"), ChainError::Lacks('t'));
        assert_eq!(error("[w X Y Z t]"), ChainError::Lacks('b'));
        assert_eq!(error("[]"), ChainError::Lacks('w'));
        assert_eq!(error("[w X b Z t]"), ChainError::LacksLinear('Y'));
        assert_eq!(error("[w X U b Z t]"), ChainError::UnknownLink("U".into()));
        assert_eq!(error("[w XY b Z t]"), ChainError::UnknownLink("XY".into()));
        assert_eq!(error("[w X C Y b Z t]"), ChainError::RotaryBetweenLinear('C'));
        assert_eq!(error("[w b C X Y Z t]"), ChainError::RotaryBetweenLinear('C'));
        assert_eq!(error("[w X Y Z C b t]"), ChainError::RotaryBetweenLinear('C'));
    }
}
