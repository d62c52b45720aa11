//! Where axes stand and what is in force, the interpreter alone says: no struct of this room keeps any of it.

use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};

/// Types that say where axes stand, or which modes are in force.
const TYPES: [&str; 12] = [
    "Interpreter",
    "Modal",
    "Distance",
    "Units",
    "Plane",
    "MotionMode",
    "Motion",
    "Axes",
    "Compensation",
    "FeedMode",
    "ReturnLevel",
    "XWords",
];
/// Names under which a field would keep them as plain values.
const NAMES: [&str; 10] = [
    "absolute",
    "incremental",
    "inch",
    "units",
    "plane",
    "motion",
    "feed",
    "stands",
    "diameters",
    "compensated",
];
/// Fields that may, each with its reason.
const ALLOWED: [(&str, &str); 8] = [
    // The one reader itself.
    ("Known", "interpreter"),
    // What the codes of the block in hand make of it: asked anew for every block.
    ("Writer", "here"),
    // What one block says, whenever it is executed.
    ("Flags", "inch"),
    // Of one line, until those that hang on it are written.
    ("Line", "absolute"),
    // Which block of a contour switches it on, and a block's own words.
    ("Contour", "compensated"),
    ("Moves", "incremental"),
    // That nobody knows it.
    ("Unsaid", "feed"),
    // Computing rounds by it, in programs that nobody would interpret twice.
    ("Run", "inch"),
];

#[derive(Default)]
struct Fields {
    within: String,
    kept: Vec<(String, String)>,
}

impl<'ast> Visit<'ast> for Fields {
    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        self.within = item.ident.to_string();
        visit::visit_item_struct(self, item);
    }

    fn visit_item_enum(&mut self, item: &'ast syn::ItemEnum) {
        self.within = item.ident.to_string();
        visit::visit_item_enum(self, item);
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        let name = field.ident.as_ref().map_or_else(|| "0".to_owned(), ToString::to_string);
        let mut types = Types(false);
        types.visit_type(&field.ty);
        if types.0 || NAMES.contains(&name.as_str()) {
            self.kept.push((self.within.clone(), name));
        }
    }
}

/// True once a type is named that says such things.
struct Types(bool);

impl<'ast> Visit<'ast> for Types {
    fn visit_ident(&mut self, ident: &'ast syn::Ident) {
        self.0 |= TYPES.contains(&ident.to_string().as_str());
    }
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

#[test]
fn no_state_of_axes_units_planes_or_modes_stands_here() {
    let found = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    assert!(found.len() > 30, "{}", found.len());
    let mut fields = Fields::default();
    for path in found {
        fields.visit_file(&syn::parse_file(&std::fs::read_to_string(path).unwrap()).unwrap());
    }
    let mut kept = fields.kept;
    kept.sort();
    let mut allowed = ALLOWED.map(|(of, field)| (of.to_owned(), field.to_owned()));
    allowed.sort();
    assert_eq!(kept, allowed, "ask `Known`, which reads what is written");
}
