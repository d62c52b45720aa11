//! Engines by the names of the command line.

use crate::EngineId;

const NAMES: [(EngineId, &str); 11] = [
    (EngineId::RigidBody, "rigid-body"),
    (EngineId::Tracker, "tracker"),
    (EngineId::TangentialStatic, "tangential-static"),
    (EngineId::TangentialInterval, "tangential-interval"),
    (EngineId::TangentialQuasiDifferential, "tangential-quasi-differential"),
    (EngineId::Kmtpp, "kmtpp"),
    (EngineId::Field, "field"),
    (EngineId::TangentialStaticPublished, "tangential-static-published"),
    (EngineId::TangentialIntervalPublished, "tangential-interval-published"),
    (EngineId::TangentialQuasiDifferentialPublished, "tangential-quasi-differential-published"),
    (EngineId::KmtppPublished, "kmtpp-published"),
];

impl EngineId {
    /// All engines, the default first, the published variants last.
    pub const ALL: [Self; 11] = {
        let mut all = [Self::RigidBody; 11];
        let mut i = 0;
        while i < all.len() {
            all[i] = NAMES[i].0;
            i += 1;
        }
        all
    };

    /// The name on the command line and in profiles.
    #[must_use]
    pub fn name(self) -> &'static str {
        NAMES.iter().find(|(id, _)| *id == self).map_or("", |(_, name)| name)
    }

    /// The engine of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        NAMES.iter().find(|(_, known)| *known == name).map(|(id, _)| *id)
    }

    /// True for the variants that reproduce a publication: `solve` only, never a program.
    #[must_use]
    pub fn is_published(self) -> bool {
        matches!(
            self,
            Self::TangentialStaticPublished
                | Self::TangentialIntervalPublished
                | Self::TangentialQuasiDifferentialPublished
                | Self::KmtppPublished
        )
    }
}

impl std::fmt::Display for EngineId {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_engine_is_found_by_its_name() {
        for id in EngineId::ALL {
            assert_eq!(EngineId::from_name(id.name()), Some(id));
            assert_eq!(id.is_published(), id.name().ends_with("-published"));
        }
        assert_eq!(EngineId::from_name("rigid_body"), None);
    }
}
