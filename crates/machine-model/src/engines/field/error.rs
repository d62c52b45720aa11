//! Why vectors make no field, and what is doubtful of one that they make.

use crate::Vector;

/// What the residuals say of the stated noise, where that is something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    /// Standard uncertainty of a component as stated, mm (RMS).
    pub stated_mm: f64,
    /// What the residuals scatter by, as much of it as the fit leaves, mm.
    pub scatter_mm: f64,
}

/// Why vectors make no field. Numbers of vectors count from 0 in the order in which they were given.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// Fewer than the fit can carry.
    #[error("{found} places with error vectors; a field with a stated noise needs at least {needed}")]
    TooFew {
        /// Places found.
        found: usize,
        /// Places needed.
        needed: usize,
    },
    /// They span no volume.
    #[error("all error vectors were measured in one {shape}: they say nothing of the volume around it")]
    Flat {
        /// `place`, `line` or `plane`.
        shape: &'static str,
    },
    /// One place, two vectors, and the noise is too small to make that of one.
    #[error(
        "two vectors of one place differ by {:.2} um in {}, {}",
        apart_mm * 1e3,
        ['X', 'Y', 'Z'][*component],
        if *allowed_mm > 0.0 { format!("more than their uncertainty explains ({:.2} um)", allowed_mm * 1e3) }
        else { "and the noise is stated as 0".to_owned() }
    )]
    Repeated {
        /// The earlier vector.
        first: usize,
        /// The later one.
        second: usize,
        /// 0 X, 1 Y, 2 Z.
        component: usize,
        /// By how much they differ, mm.
        apart_mm: f64,
        /// What would pass, mm.
        allowed_mm: f64,
    },
    /// A lattice that lacks nodes, its vectors to be met exactly.
    #[error(
        "the lattice of {} x {} x {} nodes lacks {missing}, the first at X {} Y {} Z {}",
        counts[0], counts[1], counts[2], place_mm.x, place_mm.y, place_mm.z
    )]
    Hole {
        /// Nodes of X, Y, Z.
        counts: [usize; 3],
        /// How many it lacks.
        missing: usize,
        /// The first of them, mm.
        place_mm: Vector,
    },
    /// Scattered vectors that are to be met exactly.
    #[error("the noise is stated as 0, and the {places} places are no complete lattice")]
    Scattered {
        /// How many.
        places: usize,
    },
    /// Some vectors are exact and some are not.
    #[error("an uncertainty of 0 beside others above 0")]
    Exact {
        /// The exact one.
        vector: usize,
    },
    /// The residuals are not those of the stated noise.
    #[error(
        "the vectors scatter by about {:.3} um around the field that fits them best, and a noise of {:.3} um is stated",
        .0.scatter_mm * 1e3, .0.stated_mm * 1e3
    )]
    Noise(Doubt),
    /// A run lies beside the others.
    #[error(
        "the run of this vector lies {:.2} {:.2} {:.2} um beside the others: it has a set-up, or a direction, of its own",
        offset_mm.x * 1e3, offset_mm.y * 1e3, offset_mm.z * 1e3
    )]
    Offset {
        /// The first vector of the run.
        vector: usize,
        /// By how much, mm.
        offset_mm: Vector,
    },
    /// The equations have no answer.
    #[error("the places of the vectors do not determine a field")]
    NotDetermined,
}
