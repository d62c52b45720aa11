//! One Rust file: its lines of code, its functions and their parameters.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use anyhow::Context;
use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{
    Attribute, Block, FnArg, ImplItemFn, Item, ItemFn, ItemImpl, ItemMod, Meta, Signature, TraitItemFn, Type,
};

/// A wider line hides code from the count of lines.
const WIDE_LINE: usize = 120;

/// The measures of a file.
pub(crate) struct Source {
    /// From the project's root.
    pub(crate) path: PathBuf,
    /// All lines.
    pub(crate) lines: usize,
    /// Lines too wide to be read at once.
    pub(crate) wide: usize,
    /// Lines that carry something of the language, those of tests apart.
    pub(crate) code: usize,
    pub(crate) test_code: usize,
    /// All of it is tests.
    pub(crate) is_test: bool,
    pub(crate) functions: Vec<Function>,
}

/// A function with a body.
pub(crate) struct Function {
    pub(crate) name: String,
    /// File and line.
    pub(crate) place: String,
    /// From `fn` to the closing brace.
    pub(crate) lines: usize,
    /// Parameters of type `bool`.
    pub(crate) flags: usize,
    pub(crate) is_test: bool,
}

impl Source {
    /// Measures the text of a file.
    ///
    /// # Errors
    /// Text that is not Rust.
    pub(crate) fn measure(path: &Path, text: &str, is_test: bool) -> anyhow::Result<Self> {
        let tokens: TokenStream =
            text.parse().map_err(|error| anyhow::anyhow!("{}: {error}", path.display()))?;
        let mut carrying = BTreeSet::new();
        lines_of(tokens.clone(), &mut carrying);
        let file: syn::File = syn::parse2(tokens).with_context(|| format!("{}: not Rust", path.display()))?;
        let mut finder = Finder { path, functions: Vec::new(), of_tests: BTreeSet::new(), in_test: is_test };
        finder.visit_file(&file);
        let test_code = match is_test {
            true => carrying.len(),
            false => carrying.intersection(&finder.of_tests).count(),
        };
        Ok(Self {
            path: path.to_owned(),
            lines: text.lines().count(),
            wide: text.lines().filter(|line| line.chars().count() > WIDE_LINE).count(),
            code: carrying.len() - test_code,
            test_code,
            is_test,
            functions: finder.functions,
        })
    }
}

/// Lines on which a token stands; comments, and with them documentation, carry none.
fn lines_of(tokens: TokenStream, lines: &mut BTreeSet<usize>) {
    let trees: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    while let Some(tree) = trees.get(at) {
        at += 1;
        match tree {
            TokenTree::Punct(punct) if punct.as_char() == '#' => {
                let inner = matches!(trees.get(at), Some(TokenTree::Punct(next)) if next.as_char() == '!');
                match trees.get(at + usize::from(inner)) {
                    Some(TokenTree::Group(group)) if is_documentation(group.delimiter(), group.stream()) => {
                        at += 1 + usize::from(inner);
                    }
                    _ => lines.extend(range(punct.span())),
                }
            }
            TokenTree::Group(group) => {
                lines.extend(range(group.span_open()));
                lines.extend(range(group.span_close()));
                lines_of(group.stream(), lines);
            }
            other => lines.extend(range(other.span())),
        }
    }
}

fn range(span: Span) -> RangeInclusive<usize> {
    span.start().line..=span.end().line
}

/// What a documentation comment is read as: `[doc = "…"]`.
fn is_documentation(delimiter: Delimiter, inside: TokenStream) -> bool {
    let mut trees = inside.into_iter();
    delimiter == Delimiter::Bracket
        && matches!(trees.next(), Some(TokenTree::Ident(word)) if word == "doc")
        && matches!(trees.next(), Some(TokenTree::Punct(sign)) if sign.as_char() == '=')
}

/// True where an item is compiled for tests only, or is one.
pub(crate) fn for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::Path(path) => path.is_ident("test"),
        Meta::List(list) if list.path.is_ident("cfg") => list.tokens.to_string() == "test",
        _ => false,
    })
}

struct Finder<'p> {
    path: &'p Path,
    functions: Vec<Function>,
    /// Lines of items of tests.
    of_tests: BTreeSet<usize>,
    in_test: bool,
}

impl Finder<'_> {
    /// Enters an item; one of tests lends its lines to them.
    fn within(&mut self, attributes: &[Attribute], end: Option<Span>, walk: impl FnOnce(&mut Self)) {
        let outer = self.in_test;
        if for_tests(attributes) {
            self.in_test = true;
            if let (Some(first), Some(end)) = (attributes.first(), end) {
                self.of_tests.extend(first.pound_token.spans[0].start().line..=end.end().line);
            }
        }
        walk(self);
        self.in_test = outer;
    }

    fn add(&mut self, signature: &Signature, body: &Block) {
        let from = signature.fn_token.span.start().line;
        let flags = signature.inputs.iter().filter(|input| match input {
            FnArg::Typed(typed) => matches!(&*typed.ty, Type::Path(path) if path.path.is_ident("bool")),
            FnArg::Receiver(_) => false,
        });
        self.functions.push(Function {
            name: signature.ident.to_string(),
            place: format!("{}:{from}", self.path.display()),
            lines: body.brace_token.span.close().end().line + 1 - from,
            flags: flags.count(),
            is_test: self.in_test,
        });
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        match item {
            Item::Use(one) => self.within(&one.attrs, Some(one.semi_token.span), |_| ()),
            Item::Const(one) => self.within(&one.attrs, Some(one.semi_token.span), |_| ()),
            other => visit::visit_item(self, other),
        }
    }
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        let end = item.content.as_ref().map(|(brace, _)| brace.span.close());
        self.within(&item.attrs, end, |finder| visit::visit_item_mod(finder, item));
    }
    fn visit_item_impl(&mut self, item: &'ast ItemImpl) {
        self.within(&item.attrs, Some(item.brace_token.span.close()), |finder| {
            visit::visit_item_impl(finder, item)
        });
    }
    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        self.within(&item.attrs, Some(item.block.brace_token.span.close()), |finder| {
            finder.add(&item.sig, &item.block);
            visit::visit_item_fn(finder, item);
        });
    }
    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        self.within(&item.attrs, Some(item.block.brace_token.span.close()), |finder| {
            finder.add(&item.sig, &item.block);
            visit::visit_impl_item_fn(finder, item);
        });
    }
    fn visit_trait_item_fn(&mut self, item: &'ast TraitItemFn) {
        if let Some(body) = &item.default {
            self.add(&item.sig, body);
        }
        visit::visit_trait_item_fn(self, item);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r##"//! A room.

/// Adds.
/// Two lines of documentation.
#[must_use]
pub fn add(a: u8, /* inside */ twice: bool, loud: bool) -> u8 {
    // why

    let text = "two
lines";
    a + u8::from(twice) // behind
}

struct Thing;
impl Thing {
    fn of(flag: &bool) -> bool { *flag }
}

#[cfg(test)]
mod tests {
    #[test]
    fn adds() {
        helper(true);
    }
    fn helper(_: bool) {}
}
"##;

    #[test]
    fn lines_without_code_do_not_count_and_tests_count_apart() {
        let source = Source::measure(Path::new("room.rs"), TEXT, false).expect("Rust");
        // #[must_use] to } without the comment and the empty line: 6; struct and impl: 4; tests: 8.
        assert_eq!((source.code, source.test_code, source.lines), (10, 8, 26));
        let all = Source::measure(Path::new("tests/room.rs"), TEXT, true).expect("Rust");
        assert_eq!((all.code, all.test_code), (0, 18));
    }

    #[test]
    fn functions_have_their_lines_flags_and_kind() {
        let source = Source::measure(Path::new("room.rs"), TEXT, false).expect("Rust");
        let seen: Vec<_> =
            source.functions.iter().map(|f| (f.name.as_str(), f.lines, f.flags, f.is_test)).collect();
        let expected =
            [("add", 7, 2, false), ("of", 1, 0, false), ("adds", 3, 0, true), ("helper", 1, 1, true)];
        assert_eq!(seen, expected);
        assert_eq!(source.functions[0].place, "room.rs:6");
    }
}
