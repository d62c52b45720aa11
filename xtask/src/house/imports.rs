//! Which files of a crate import each other.
//!
//! A file imports another when one of its paths ends, doors (`pub use`) followed, in an item that stands there. Tests do not
//! count, nor does a door by itself: a crate's front page that hands out names depends on nothing for it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::Context;
use proc_macro2::{TokenStream, TokenTree};
use serde_json::Value;
use syn::visit::{self, Visit};
use syn::{Expr, Item, ItemMod, ItemUse, Lit, Macro, Meta, UseTree, Visibility};

use super::source::for_tests;

/// The roots of all crates: libraries and commands, from the project's root.
pub(crate) fn roots(metadata: &Value, root: &Path) -> Vec<PathBuf> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let targets = list(&metadata["packages"]).into_iter().flat_map(|package| list(&package["targets"]));
    let crates = targets.filter(|target| ["lib", "bin"].iter().any(|kind| target["kind"][0] == *kind));
    let paths = crates.filter_map(|target| Some(PathBuf::from(target["src_path"].as_str()?)));
    paths.map(|path| path.strip_prefix(root).map(Path::to_owned).unwrap_or(path)).collect()
}

/// What a name means in a module.
enum Name {
    /// An item that stands there.
    Item,
    /// A module below.
    Module(usize),
    /// The name of something elsewhere.
    Alias(Vec<String>),
}

/// A module: a file or a part of one.
struct Module {
    file: usize,
    parent: usize,
    names: BTreeMap<String, Name>,
    /// Modules whose names all stand here too.
    globs: Vec<Vec<String>>,
    /// Paths that are used here, by code and by private imports.
    mentioned: BTreeSet<Vec<String>>,
    is_test: bool,
}

/// The modules of a crate.
pub(crate) struct Tree {
    files: Vec<PathBuf>,
    modules: Vec<Module>,
}

/// No chain of doors is longer; names that lead to themselves end there.
const DEEPEST: usize = 16;

/// The module in which another stands.
#[derive(Clone, Copy)]
struct Above {
    module: usize,
    is_test: bool,
}

impl Tree {
    /// Reads a crate from its root file on.
    ///
    /// # Errors
    /// A file that is not there or not Rust.
    pub(crate) fn read(project: &Path, root: &Path) -> anyhow::Result<Self> {
        let mut tree = Self { files: Vec::new(), modules: Vec::new() };
        let below = root.parent().unwrap_or(Path::new("")).to_owned();
        tree.read_file(project, root, &below, Above { module: 0, is_test: false })?;
        Ok(tree)
    }

    /// Reads a file as a module; files of its modules are in `below`.
    fn read_file(
        &mut self,
        project: &Path,
        path: &Path,
        below: &Path,
        above: Above,
    ) -> anyhow::Result<usize> {
        let text = std::fs::read_to_string(project.join(path))
            .with_context(|| format!("{}: unreadable", path.display()))?;
        let file = syn::parse_file(&text).with_context(|| format!("{}: not Rust", path.display()))?;
        self.files.push(path.to_owned());
        let beside = path.parent().unwrap_or(Path::new(""));
        self.read_module(project, &file.items, self.files.len() - 1, [below, beside], above)
    }

    fn read_module(
        &mut self,
        project: &Path,
        items: &[Item],
        file: usize,
        [below, beside]: [&Path; 2],
        above: Above,
    ) -> anyhow::Result<usize> {
        let own = self.modules.len();
        let (names, globs) = (BTreeMap::new(), Vec::new());
        let Above { module: parent, is_test } = above;
        self.modules.push(Module { file, parent, names, globs, mentioned: BTreeSet::new(), is_test });
        for item in items {
            let Item::Mod(module) = item else {
                self.modules[own].take(item);
                continue;
            };
            let inside = Above { module: own, is_test: is_test || for_tests(&module.attrs) };
            let name = module.ident.to_string();
            let child = match (&module.content, stated_path(module)) {
                (Some((_, items)), _) => {
                    let inner = below.join(&name);
                    self.read_module(project, items, file, [&inner, &inner], inside)?
                }
                (None, Some(path)) => {
                    let path = beside.join(path);
                    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
                    self.read_file(project, &path, &folder, inside)?
                }
                (None, None) => {
                    let (flat, nested) = (below.join(format!("{name}.rs")), below.join(&name).join("mod.rs"));
                    let path = if project.join(&flat).exists() { flat } else { nested };
                    self.read_file(project, &path, &below.join(&name), inside)?
                }
            };
            self.modules[own].names.insert(name, Name::Module(child));
        }
        Ok(own)
    }

    /// Files that hold tests only.
    pub(crate) fn test_files(&self) -> BTreeSet<PathBuf> {
        let of = |is_test: bool| -> BTreeSet<usize> {
            self.modules.iter().filter(|module| module.is_test == is_test).map(|module| module.file).collect()
        };
        of(true).difference(&of(false)).map(|file| self.files[*file].clone()).collect()
    }

    /// The file where a path of a module ends.
    fn file_of(&self, module: usize, path: &[String]) -> Option<usize> {
        self.follow(module, path, DEEPEST).map(|end| self.modules[end].file)
    }

    /// The module in which a path ends: that which it names, or that in which the item stands that it names.
    fn follow(&self, from: usize, path: &[String], left: usize) -> Option<usize> {
        let mut at = from;
        let mut inside = false;
        for (place, name) in path.iter().enumerate() {
            match name.as_str() {
                "crate" => at = 0,
                "self" => {}
                "super" => at = self.modules[at].parent,
                _ => match self.modules[at].names.get(name) {
                    Some(Name::Module(child)) => at = *child,
                    Some(Name::Item) => return Some(at),
                    Some(Name::Alias(to)) if left > 0 && to != path => {
                        let rest = [to.as_slice(), &path[place + 1..]].concat();
                        return self.follow(at, &rest, left - 1);
                    }
                    _ if left > 0 => {
                        let through = |glob: &Vec<String>| {
                            let module = self.follow(at, glob, left - 1)?;
                            let known = self.modules[module].names.contains_key(name);
                            (known && module != at).then(|| self.follow(module, &path[place..], left - 1))?
                        };
                        let found = self.modules[at].globs.iter().find_map(through);
                        // What a macro made stands where the path led; a first name that nobody knows is another crate.
                        return found.or(inside.then_some(at));
                    }
                    _ => return inside.then_some(at),
                },
            }
            inside = true;
        }
        inside.then_some(at)
    }

    /// Files that lead to each other, in groups of two and more.
    pub(crate) fn circles(&self) -> Vec<Circle> {
        let mut imports: Vec<BTreeMap<usize, BTreeSet<&str>>> = vec![BTreeMap::new(); self.files.len()];
        for (number, module) in self.modules.iter().enumerate().filter(|(_, module)| !module.is_test) {
            for path in &module.mentioned {
                if let Some(file) = self.file_of(number, path).filter(|file| *file != module.file) {
                    imports[module.file].entry(file).or_default().extend(path.last().map(String::as_str));
                }
            }
        }
        let reached: Vec<BTreeSet<usize>> = (0..imports.len()).map(|file| reach(&imports, file)).collect();
        let mut seen = BTreeSet::new();
        let mut circles = Vec::new();
        for file in 0..imports.len() {
            let circle: Vec<usize> =
                reached[file].iter().copied().filter(|other| reached[*other].contains(&file)).collect();
            if circle.len() > 1 && seen.insert(circle.clone()) {
                let path = |file: &usize| self.files[*file].clone();
                let within = |from: &usize| {
                    let inside = imports[*from].iter().filter(|(to, _)| circle.contains(to));
                    let edges = inside.map(|(to, names)| Import {
                        from: path(from),
                        to: path(to),
                        names: names.iter().map(|name| (*name).to_owned()).collect(),
                    });
                    edges.collect::<Vec<_>>()
                };
                circles.push(Circle {
                    files: circle.iter().map(path).collect(),
                    imports: circle.iter().flat_map(within).collect(),
                });
            }
        }
        circles
    }
}

/// Files that lead to each other.
pub(crate) struct Circle {
    pub files: Vec<PathBuf>,
    /// What makes it one.
    pub imports: Vec<Import>,
}

/// One file uses names that stand in another.
pub(crate) struct Import {
    pub from: PathBuf,
    pub to: PathBuf,
    pub names: Vec<String>,
}

/// Files that a file leads to; itself where it is on a circle.
fn reach(imports: &[BTreeMap<usize, BTreeSet<&str>>], from: usize) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(file) = open.pop() {
        open.extend(imports[file].keys().copied().filter(|next| found.insert(*next)));
    }
    found
}

/// The file that `#[path = "…"]` states.
fn stated_path(module: &ItemMod) -> Option<String> {
    module.attrs.iter().find_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("path") => match &pair.value {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    })
}

impl Module {
    fn take(&mut self, item: &Item) {
        let (name, attributes) = match item {
            Item::Use(one) => (None, &one.attrs),
            Item::Fn(one) => (Some(&one.sig.ident), &one.attrs),
            Item::Struct(one) => (Some(&one.ident), &one.attrs),
            Item::Enum(one) => (Some(&one.ident), &one.attrs),
            Item::Union(one) => (Some(&one.ident), &one.attrs),
            Item::Trait(one) => (Some(&one.ident), &one.attrs),
            Item::TraitAlias(one) => (Some(&one.ident), &one.attrs),
            Item::Type(one) => (Some(&one.ident), &one.attrs),
            Item::Const(one) => (Some(&one.ident), &one.attrs),
            Item::Static(one) => (Some(&one.ident), &one.attrs),
            Item::Macro(one) => (one.ident.as_ref(), &one.attrs),
            Item::Impl(one) => (None, &one.attrs),
            _ => return,
        };
        if for_tests(attributes) {
            return;
        }
        if let Some(name) = name {
            self.names.insert(name.to_string(), Name::Item);
        }
        match item {
            Item::Use(one) => self.import(one, true),
            other => Paths { module: self }.visit_item(other),
        }
    }

    /// The names that an import brings; one that hands them on is a door.
    fn import(&mut self, item: &ItemUse, at_top: bool) {
        let is_door = !matches!(item.vis, Visibility::Inherited);
        let mut open = vec![(Vec::<String>::new(), &item.tree)];
        while let Some((mut path, tree)) = open.pop() {
            let mut name = None;
            match tree {
                UseTree::Path(one) => {
                    path.push(one.ident.to_string());
                    open.push((path, &one.tree));
                    continue;
                }
                UseTree::Group(group) => {
                    open.extend(group.items.iter().map(|tree| (path.clone(), tree)));
                    continue;
                }
                UseTree::Name(one) if one.ident == "self" => name = path.last().cloned(),
                UseTree::Name(one) => {
                    path.push(one.ident.to_string());
                    name = path.last().cloned();
                }
                UseTree::Rename(one) => {
                    if one.ident != "self" {
                        path.push(one.ident.to_string());
                    }
                    name = Some(one.rename.to_string());
                }
                UseTree::Glob(_) if at_top => self.globs.push(path.clone()),
                UseTree::Glob(_) => {}
            }
            if let Some(name) = name.filter(|name| at_top && name != "_" && path != [name.clone()]) {
                self.names.entry(name).or_insert_with(|| Name::Alias(path.clone()));
            }
            if !is_door {
                self.mentioned.insert(path);
            }
        }
    }
}

/// Collects the paths of code.
struct Paths<'m> {
    module: &'m mut Module,
}

impl Paths<'_> {
    /// Paths in the tokens of a macro, which are not parsed.
    fn scan(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for tree in tokens {
            match tree {
                TokenTree::Ident(word) => {
                    if colons != 2 {
                        self.module.mentioned.insert(std::mem::take(&mut path));
                    }
                    path.push(word.to_string());
                    colons = 0;
                }
                TokenTree::Punct(sign) if sign.as_char() == ':' => colons += 1,
                other => {
                    self.module.mentioned.insert(std::mem::take(&mut path));
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.scan(group.stream());
                    }
                }
            }
        }
        self.module.mentioned.insert(path);
    }
}

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let names = path.segments.iter().map(|segment| segment.ident.to_string());
            self.module.mentioned.insert(names.collect());
        }
        visit::visit_path(self, path);
    }
    fn visit_visibility(&mut self, _: &'ast Visibility) {
        // `pub(crate)` names a place and takes nothing from it.
    }
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.module.import(item, false);
    }
    fn visit_macro(&mut self, one: &'ast Macro) {
        self.scan(one.tokens.clone());
        visit::visit_macro(self, one);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circles of a crate of these files.
    fn circles(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a new folder");
            std::fs::write(path, text).expect("a new file");
        }
        let tree = Tree::read(folder.path(), Path::new("lib.rs")).expect("Rust");
        let names = |circle: Circle| circle.files.iter().map(|path| path.display().to_string()).collect();
        tree.circles().into_iter().map(names).collect()
    }

    #[test]
    fn a_door_is_no_import_and_leads_to_the_file_behind_it() {
        let lib = ("lib.rs", "mod a;\nmod b;\npub use a::One;\n");
        let one_way =
            [lib, ("a.rs", "pub(crate) struct One;"), ("b.rs", "use crate::One;\npub struct Two(One);")];
        assert_eq!(circles(&one_way), Vec::<Vec<String>>::new());
        let both = [lib, ("a.rs", "pub struct One(crate::b::Two);"), one_way[2]];
        assert_eq!(circles(&both), [["a.rs", "b.rs"]]);
    }

    #[test]
    fn a_child_that_takes_from_its_parent_is_on_a_circle_where_the_parent_uses_it() {
        let child = ("a/deep.rs", "use super::SIZE;\npub fn area() -> u8 { SIZE }");
        let files = |parent| [("lib.rs", "mod a;"), ("a.rs", parent), child];
        let idle = "pub mod deep;\npub const SIZE: u8 = 2;";
        assert_eq!(circles(&files(idle)), Vec::<Vec<String>>::new());
        let uses = "mod deep;\npub const SIZE: u8 = 2;\nfn twice() -> u8 { 2 * deep::area() }";
        assert_eq!(circles(&files(uses)), [["a.rs", "a/deep.rs"]]);
    }

    #[test]
    fn three_files_globs_and_macros_make_a_circle_and_tests_do_not() {
        let files = |last| {
            [
                ("lib.rs", "mod a;\nmod b;\nmod c;\n"),
                ("a.rs", "use crate::b::*;\nfn x(y: Y) -> Y { y }\npub const X: u8 = 0;"),
                ("b.rs", "pub struct Y;\nfn z() { println!(\"{}\", super::c::Z) }"),
                ("c.rs", last),
            ]
        };
        assert_eq!(circles(&files("pub const Z: u8 = crate::a::X;")), [["a.rs", "b.rs", "c.rs"]]);
        let tested = "pub const Z: u8 = 1;\n#[cfg(test)]\nmod tests { use crate::a::X; }";
        assert_eq!(circles(&files(tested)), Vec::<Vec<String>>::new());
    }
}
