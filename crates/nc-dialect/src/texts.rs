//! The grammars that come with the program, as texts.

/// Names and texts, in alphabetical order.
pub(crate) const TEXTS: [(&str, &str); 16] = [
    ("balt-system", include_str!(concat!(env!("GRAMMARS"), "/balt-system.toml"))),
    ("centroid", include_str!(concat!(env!("GRAMMARS"), "/centroid.toml"))),
    ("fagor", include_str!(concat!(env!("GRAMMARS"), "/fagor.toml"))),
    ("fanuc", include_str!(concat!(env!("GRAMMARS"), "/fanuc.toml"))),
    ("fanuc-lathe", include_str!(concat!(env!("GRAMMARS"), "/fanuc-lathe.toml"))),
    ("grbl", include_str!(concat!(env!("GRAMMARS"), "/grbl.toml"))),
    ("haas", include_str!(concat!(env!("GRAMMARS"), "/haas.toml"))),
    ("heidenhain-iso", include_str!(concat!(env!("GRAMMARS"), "/heidenhain-iso.toml"))),
    ("linuxcnc", include_str!(concat!(env!("GRAMMARS"), "/linuxcnc.toml"))),
    ("linuxcnc-lathe", include_str!(concat!(env!("GRAMMARS"), "/linuxcnc-lathe.toml"))),
    ("mach", include_str!(concat!(env!("GRAMMARS"), "/mach.toml"))),
    ("mitsubishi", include_str!(concat!(env!("GRAMMARS"), "/mitsubishi.toml"))),
    ("okuma", include_str!(concat!(env!("GRAMMARS"), "/okuma.toml"))),
    ("perspektiva", include_str!(concat!(env!("GRAMMARS"), "/perspektiva.toml"))),
    ("sinumerik", include_str!(concat!(env!("GRAMMARS"), "/sinumerik.toml"))),
    ("sinumerik-turn", include_str!(concat!(env!("GRAMMARS"), "/sinumerik-turn.toml"))),
];
