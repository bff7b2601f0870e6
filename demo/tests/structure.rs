//! The sources have no import circles, and no folder has more files than can be taken in at a glance.
//!
//! A file imports another where it names something that is defined there, in a `use` line or by a path. What a folder
//! passes on with `pub use` counts as of the file that defines it. Calls of methods are not followed.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, UseTree};

/// The most source files that lie directly in one folder.
const MOST_FILES: usize = 16;

#[test]
fn the_demo_has_no_import_circles() {
    assert_eq!(circle(&Crate::read(&source_folder("src"))), None);
}

#[test]
fn the_library_has_no_import_circles() {
    assert_eq!(circle(&Crate::read(&source_folder("../src"))), None);
}

#[test]
fn passes_know_neither_each_other_nor_the_order_of_a_frame() {
    let library = Crate::read(&source_folder("../src"));
    let imports = library.imports();
    let passes = imports.iter().filter(|(file, _)| file.starts_with("passes/") && **file != "passes/mod.rs");
    let mut seen = 0;
    for (pass, files) in passes {
        let is_own_folder = |file: &str| file.strip_suffix("/mod.rs").is_some_and(|folder| pass.starts_with(folder));
        let foreign = |file: &&&str| {
            (file.starts_with("passes/") && !is_own_folder(file))
                || file.starts_with("techniques/")
                || **file == "node.rs"
        };
        assert_eq!(files.iter().find(foreign), None, "{pass} imports it");
        seen += 1;
    }
    assert!(seen > 16, "{seen} passes");
}

#[test]
fn no_folder_of_the_demo_is_crowded() {
    assert_eq!(crowded(&source_folder("src")), Vec::<String>::new());
}

#[test]
fn no_folder_of_the_library_is_crowded() {
    assert_eq!(crowded(&source_folder("../src")), Vec::<String>::new());
}

fn source_folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Folders at or below `root` with more than [`MOST_FILES`] source files directly in them.
fn crowded(root: &Path) -> Vec<String> {
    let (mut files, mut crowded) = (0, Vec::new());
    for entry in std::fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            crowded.extend(self::crowded(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files += 1;
        }
    }
    if files > MOST_FILES {
        crowded.push(format!("{} has {files} files", root.display()));
    }
    crowded
}

/// Names of a module, from the crate's root on.
type Names = Vec<String>;

/// The modules of a crate without what is compiled for its tests alone.
#[derive(Default)]
struct Crate {
    modules: BTreeMap<Names, Module>,
}

/// A module, inline or in a file of its own.
#[derive(Default)]
struct Module {
    file: String,
    /// Names that the module defines itself, child modules left out.
    items: BTreeSet<String>,
    uses: Vec<Use>,
    /// All paths that are written in it, in `use` lines or elsewhere. `crate`, `self` and `super` are still in them.
    paths: BTreeSet<Names>,
}

/// One name that a `use` line brings in; `*` for all names of a module.
struct Use {
    name: String,
    path: Names,
}

impl Crate {
    /// The crate of the folder whose root is lib.rs.
    fn read(folder: &Path) -> Self {
        Self::new(&|file| std::fs::read_to_string(folder.join(file)).ok())
    }

    /// The crate of the files that `text` gives by their paths below the root.
    fn new(text: &dyn Fn(&str) -> Option<String>) -> Self {
        let mut all = Self::default();
        let root = text("lib.rs").expect("the crate has a lib.rs");
        all.add_file(text, Vec::new(), "lib.rs".to_owned(), &root);
        all
    }

    fn add_file(&mut self, text: &dyn Fn(&str) -> Option<String>, names: Names, file: String, source: &str) {
        let parsed = syn::parse_file(source).unwrap_or_else(|e| panic!("{file}: {e}"));
        self.add_module(text, names, file, &parsed.items);
    }

    fn add_module(&mut self, text: &dyn Fn(&str) -> Option<String>, names: Names, file: String, items: &[Item]) {
        let mut reader = Reader::default();
        items.iter().for_each(|item| reader.visit_item(item));
        let Reader { mut module, inline, outside } = reader;
        module.file.clone_from(&file);
        self.modules.insert(names.clone(), module);
        for (name, items) in inline {
            self.add_module(text, joined(&names, &name), file.clone(), &items);
        }
        for name in outside {
            let names = joined(&names, &name);
            let stem = names.join("/");
            let (file, source) = [format!("{stem}.rs"), format!("{stem}/mod.rs")]
                .into_iter()
                .find_map(|file| text(&file).map(|source| (file, source)))
                .unwrap_or_else(|| panic!("module {stem} has no file"));
            self.add_file(text, names, file, &source);
        }
    }

    /// By file, the files that define what is named in it.
    fn imports(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let mut imports = BTreeMap::<&str, BTreeSet<&str>>::new();
        for (names, module) in &self.modules {
            let files = imports.entry(&module.file).or_default();
            for path in &module.paths {
                files.extend(self.files_of(names, path, 0));
            }
            files.remove(module.file.as_str());
        }
        imports
    }

    /// The files that define what `path`, written in the module `from`, stands for. None for what lies outside of the
    /// crate, and for a path that ends at a module: whoever uses the module names something in it.
    fn files_of(&self, from: &[String], path: &[String], depth: usize) -> Vec<&str> {
        // Modules that glob each other would go on for ever.
        let (Some(module), Some((first, rest)), true) = (self.modules.get(from), path.split_first(), depth < 32) else {
            return Vec::new();
        };
        if rest.is_empty() && first == "*" {
            return vec![&module.file];
        }
        match first.as_str() {
            "crate" => return self.files_of(&[], rest, depth + 1),
            "self" => return self.files_of(from, rest, depth + 1),
            "super" => return self.files_of(&from[..from.len().saturating_sub(1)], rest, depth + 1),
            _ => {}
        }
        let mut files = Vec::new();
        let child = joined(from, first);
        if self.modules.contains_key(&child) && !rest.is_empty() {
            files.extend(self.files_of(&child, rest, depth + 1));
        }
        if module.items.contains(first) {
            files.push(&module.file);
        }
        for brought_in in module.uses.iter().filter(|u| u.name == *first) {
            // `use name;` of another crate would find itself again.
            if brought_in.path.first() != Some(first) || self.modules.contains_key(&child) {
                files.extend(self.files_of(from, &[&brought_in.path, rest].concat(), depth + 1));
            }
        }
        if files.is_empty() {
            for glob in module.uses.iter().filter(|u| u.name == "*") {
                let prefix = &glob.path[..glob.path.len() - 1];
                if prefix.first() != Some(first) {
                    files.extend(self.files_of(from, &[prefix, path].concat(), depth + 1));
                }
            }
        }
        files
    }
}

fn joined(names: &[String], name: &str) -> Names {
    names.iter().cloned().chain([name.to_owned()]).collect()
}

/// Reads the items of one module.
#[derive(Default)]
struct Reader {
    module: Module,
    /// Modules with their items in the same file.
    inline: Vec<(String, Vec<Item>)>,
    /// Modules in files of their own.
    outside: Vec<String>,
}

impl Reader {
    fn define(&mut self, name: &syn::Ident) {
        self.module.items.insert(name.to_string());
    }

    fn add_use(&mut self, tree: &UseTree, prefix: &[String], is_public: bool) {
        let (name, path) = match tree {
            UseTree::Path(path) => {
                return self.add_use(&path.tree, &joined(prefix, &path.ident.to_string()), is_public);
            }
            UseTree::Group(group) => return group.items.iter().for_each(|tree| self.add_use(tree, prefix, is_public)),
            UseTree::Name(name) if name.ident == "self" => {
                (prefix.last().cloned().unwrap_or_default(), prefix.to_vec())
            }
            UseTree::Name(name) => (name.ident.to_string(), joined(prefix, &name.ident.to_string())),
            UseTree::Rename(rename) if rename.ident == "self" => (rename.rename.to_string(), prefix.to_vec()),
            UseTree::Rename(rename) => (rename.rename.to_string(), joined(prefix, &rename.ident.to_string())),
            UseTree::Glob(_) => ("*".to_owned(), joined(prefix, "*")),
        };
        // What is only passed on is imported by those who use it.
        if !is_public {
            self.module.paths.insert(path.clone());
        }
        self.module.uses.push(Use { name, path });
    }

    /// The paths in the tokens of a macro or of an attribute, which nobody has parsed.
    fn add_tokens(&mut self, tokens: TokenStream) {
        let mut path: Names = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.end_path(&mut path);
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                other => {
                    self.end_path(&mut path);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.add_tokens(group.stream());
                    }
                }
            }
        }
        self.end_path(&mut path);
    }

    fn end_path(&mut self, path: &mut Names) {
        if !path.is_empty() {
            self.module.paths.insert(std::mem::take(path));
        }
    }
}

/// Whether something is compiled for tests alone.
fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let is_cfg_test = || attribute.parse_args::<syn::Ident>().is_ok_and(|what| what == "test");
        attribute.path().is_ident("test") || (attribute.path().is_ident("cfg") && is_cfg_test())
    })
}

fn attributes_of(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item(&mut self, item: &'ast Item) {
        if is_for_tests(attributes_of(item)) {
            return;
        }
        match item {
            Item::Const(item) => self.define(&item.ident),
            Item::Enum(item) => self.define(&item.ident),
            Item::Fn(item) => self.define(&item.sig.ident),
            Item::Static(item) => self.define(&item.ident),
            Item::Struct(item) => self.define(&item.ident),
            Item::Trait(item) => self.define(&item.ident),
            Item::Type(item) => self.define(&item.ident),
            Item::Union(item) => self.define(&item.ident),
            Item::Macro(item) => item.ident.iter().for_each(|name| self.define(name)),
            Item::Use(item) => {
                let is_public = !matches!(item.vis, syn::Visibility::Inherited);
                return self.add_use(&item.tree, &[], is_public);
            }
            Item::Mod(item) => {
                match &item.content {
                    Some((_, items)) => self.inline.push((item.ident.to_string(), items.clone())),
                    None => self.outside.push(item.ident.to_string()),
                }
                return;
            }
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !is_for_tests(&function.attrs) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        if !is_for_tests(&field.attrs) {
            visit::visit_field(self, field);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.module.paths.insert(path.segments.iter().map(|s| s.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &'ast syn::Macro) {
        self.add_tokens(called.tokens.clone());
        visit::visit_macro(self, called);
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        // The text of a doc comment is one literal, so that the paths in it do not count.
        if let syn::Meta::List(list) = &attribute.meta {
            self.add_tokens(list.tokens.clone());
        }
    }

    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {
        // The `super` of `pub(super)` imports nothing.
    }
}

/// The shortest circle of imports, as the files along it.
fn circle(all: &Crate) -> Option<String> {
    let imports = all.imports();
    let circles = imports.keys().filter_map(|start| way_back(&imports, start));
    circles.min_by_key(Vec::len).map(|files| files.join(" -> "))
}

/// The shortest way along imports from a file to itself.
fn way_back<'a>(imports: &BTreeMap<&'a str, BTreeSet<&'a str>>, start: &'a str) -> Option<Vec<&'a str>> {
    let mut ways = VecDeque::from([vec![start]]);
    let mut seen = BTreeSet::new();
    while let Some(way) = ways.pop_front() {
        for &next in imports.get(way.last()?)? {
            let longer = [&way[..], &[next]].concat();
            if next == start {
                return Some(longer);
            }
            if seen.insert(next) {
                ways.push_back(longer);
            }
        }
    }
    None
}

/// A crate of these files.
fn made(files: &[(&str, &str)]) -> Crate {
    let files: BTreeMap<_, _> = files.iter().copied().collect();
    Crate::new(&|file| files.get(file).map(|text| (*text).to_owned()))
}

#[test]
fn a_circle_is_found_with_its_path() {
    let by_use = [
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::B; pub struct A(B);"),
        ("b.rs", "use super::a::A; pub struct B(Box<A>);"),
    ];
    assert_eq!(circle(&made(&by_use)).as_deref(), Some("a.rs -> b.rs -> a.rs"));
    let by_path = [("lib.rs", "mod a; mod b;"), by_use[1], ("b.rs", "pub struct B; fn f() { crate::a::g(); }")];
    assert_eq!(circle(&made(&by_path)), None, "a.rs defines no g");
    let by_path = [by_path[0], ("a.rs", "use crate::b; fn f() -> b::B { b::B } pub fn g() {}"), by_path[2]];
    assert_eq!(circle(&made(&by_path)).as_deref(), Some("a.rs -> b.rs -> a.rs"));
    let in_macros = [by_use[0], ("a.rs", "pub const A: u32 = 1; fn f() { println!(\"{}\", super::b::B); }"), by_use[2]];
    let in_macros =
        [in_macros[0], in_macros[1], ("b.rs", "#[error(\"{}\", crate::a::A)] pub struct E; pub const B: u32 = 1;")];
    assert_eq!(circle(&made(&in_macros)).as_deref(), Some("a.rs -> b.rs -> a.rs"));
}

#[test]
fn a_child_that_imports_from_a_parent_that_uses_it_is_a_circle() {
    let parent = "mod child; use child::f; pub const N: u32 = 1; fn g() { f(); }";
    let files =
        [("lib.rs", "mod parent;"), ("parent/mod.rs", parent), ("parent/child.rs", "pub fn f() -> u32 { super::N }")];
    assert_eq!(circle(&made(&files)).as_deref(), Some("parent/child.rs -> parent/mod.rs -> parent/child.rs"));
    let passed_on = "mod child; pub use child::f; pub const N: u32 = 1;";
    let files = [files[0], ("parent/mod.rs", passed_on), files[2]];
    assert_eq!(circle(&made(&files)), None, "the parent only passes it on");
    let passed_on_and_used = "mod child; pub use child::f; pub const N: u32 = 1; fn g() { f(); }";
    let files = [files[0], ("parent/mod.rs", passed_on_and_used), files[2]];
    assert_eq!(circle(&made(&files)).as_deref(), Some("parent/child.rs -> parent/mod.rs -> parent/child.rs"));
}

#[test]
fn what_is_passed_on_comes_from_where_it_is_defined() {
    let files = [
        ("lib.rs", "pub mod folder; pub use folder::a as first;"),
        ("folder/mod.rs", "pub mod a; pub mod b; pub use a::A; pub use b::*;"),
        ("folder/a.rs", "pub struct A;"),
        ("folder/b.rs", "use super::A; use crate::first; pub struct B(A, first::A);"),
    ];
    assert_eq!(circle(&made(&files)), None);
    let imports = made(&files);
    assert_eq!(imports.imports()["folder/b.rs"], BTreeSet::from(["folder/a.rs"]));
    let through_glob = [files[0], files[1], ("folder/a.rs", "use crate::folder::B; pub struct A(Box<B>);"), files[3]];
    assert_eq!(circle(&made(&through_glob)).as_deref(), Some("folder/a.rs -> folder/b.rs -> folder/a.rs"));
}

#[test]
fn tests_docs_and_visibilities_import_nothing() {
    let files = [
        ("lib.rs", "mod a; mod b; #[cfg(test)] mod only_tests;"),
        ("a.rs", "use crate::b::B; pub struct A(B);"),
        (
            "b.rs",
            "/// Of [`crate::a::A`].\npub(super) struct B; #[cfg(test)] mod tests { use crate::a::A; } \
             impl B { #[cfg(test)] fn f() -> crate::a::A {} }",
        ),
    ];
    assert_eq!(circle(&made(&files)), None);
}
