/// The working plane of arcs and cycles (ISO 6983-1: G17, G18, G19).
///
/// ```
/// use toolpath::Plane;
///
/// // A positive turn is right-handed about the normal axis: first, second and normal follow each other round.
/// for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
///     let [first, second, normal] = plane.axes();
///     assert_eq!([(first + 1) % 3, (second + 1) % 3], [second, normal]);
/// }
/// assert_eq!(Plane::Zx.centre_letters(), *b"KI");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Plane {
    /// G17: X to Y, drilling along Z.
    #[default]
    Xy,
    /// G18: Z to X, drilling along Y.
    Zx,
    /// G19: Y to Z, drilling along X.
    Yz,
}

impl Plane {
    /// Indices of the first, second and normal axis; positive rotation turns first towards second.
    #[must_use]
    pub const fn axes(self) -> [usize; 3] {
        match self {
            Self::Xy => [0, 1, 2],
            Self::Zx => [2, 0, 1],
            Self::Yz => [1, 2, 0],
        }
    }

    /// The letters of the centre words in the order of [`Plane::axes`] (I belongs to X, J to Y, K to Z).
    #[must_use]
    pub const fn centre_letters(self) -> [u8; 2] {
        match self {
            Self::Xy => [b'I', b'J'],
            Self::Zx => [b'K', b'I'],
            Self::Yz => [b'J', b'K'],
        }
    }
}
