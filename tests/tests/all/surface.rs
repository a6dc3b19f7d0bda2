//! What users of the crate `coadjoint` can name, line by line: whatever changes it has to change a snapshot too.
//!
//! Sources are read, not compiled: the items of public modules, what is exported again, members, and the traits that types implement. Left out are tests and what `#[doc(hidden)]` hides; what a macro defines is shown as the macro's call. Of
//! retractions and methods the names are the generator's.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::method;
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::{ToTokens, format_ident, quote};
use syn::{ImplItem, Item, TraitItem, Type, UseTree, Visibility};

#[test]
fn the_public_surface_is_as_reviewed() {
    let source = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../runtime/src"));
    let root = std::fs::read_to_string(source.join("lib.rs")).expect("the root of the crate");
    let mut surface = Surface { modules: BTreeMap::new(), lines: BTreeSet::new() };
    surface.insert(syn::parse_file(&root).expect("Rust").items, source, "crate");
    surface.module("crate", "coadjoint");
    let lines: Vec<String> = surface.lines.into_iter().collect();
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("surface", lines.join("\n")));
}

/// An item's name, and whether it is public; exports have no name.
fn head(item: &Item) -> Option<(String, bool)> {
    let (name, visibility) = match item {
        Item::Const(item) => (item.ident.to_string(), &item.vis),
        Item::Enum(item) => (item.ident.to_string(), &item.vis),
        Item::Fn(item) => (item.sig.ident.to_string(), &item.vis),
        Item::Mod(item) => (item.ident.to_string(), &item.vis),
        Item::Struct(item) => (item.ident.to_string(), &item.vis),
        Item::Trait(item) => (item.ident.to_string(), &item.vis),
        Item::Type(item) => (item.ident.to_string(), &item.vis),
        Item::Use(item) => (String::new(), &item.vis),
        _ => return None,
    };
    Some((name, is_public(visibility)))
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Tokens up to their body, then the attributes that users notice; nothing if they are hidden.
fn shown(tokens: &impl ToTokens) -> Option<String> {
    let (mut kept, mut attributes) = (TokenStream::new(), TokenStream::new());
    let mut tokens = tokens.to_token_stream().into_iter();
    while let Some(token) = tokens.next() {
        match &token {
            TokenTree::Punct(sign) if sign.as_char() == '#' => {
                let attribute = tokens.next()?;
                let text = attribute.to_string();
                if text.starts_with("[doc (hidden") {
                    return None;
                }
                if ["[cfg", "[derive", "[must_use", "[non_exhaustive"].iter().any(|it| text.starts_with(it)) {
                    attributes.extend([token, attribute]);
                }
            }
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => break,
            TokenTree::Ident(ident) if ident == "pub" => {}
            _ => kept.extend([token]),
        }
    }
    let mut text = format!("{kept} {attributes}").trim().to_owned();
    // much as it is written
    for tight in [" ::", ":: ", " <", "< ", " >", " ,", " :", " (", "& ", " ;", "# ", "? "] {
        text = text.replace(tight, tight.trim());
    }
    for (from, to) in [("->", "-> "), ("=<", "= <"), ("=(", "= ("), (",(", ", ("), (",)", ")"), ("  ", " ")] {
        text = text.replace(from, to);
    }
    Some(text)
}

/// What is made of the generator's tables, by name alone: values, and the types that stand for them.
fn generated(call: &syn::ItemMacro) -> Option<Vec<Item>> {
    let (values, variants, types) = match call.mac.path.segments.last()?.ident.to_string().as_str() {
        "retractions" => {
            let names = Retraction::ALL.map(Retraction::name).to_vec();
            ("RetractionKind", names.clone(), names)
        }
        "methods" => {
            let names: Vec<&str> = method::known().iter().map(|method| method.name).collect();
            let members = method::known().into_iter().flat_map(|method| method.named.iter());
            let types = names.iter().copied().chain(members.map(|named| named.name));
            ("Rule", names.clone(), types.collect::<BTreeSet<_>>().into_iter().collect())
        }
        _ => return None,
    };
    let values = format_ident!("{values}");
    let [variants, types] = [variants, types]
        .map(|names| names.into_iter().map(|name| format_ident!("{name}")).collect::<Vec<_>>());
    let items = quote! {
        pub enum #values { #(#variants),* }
        mod markers { #(pub struct #types;)* }
    };
    Some(syn::parse2::<syn::File>(items).expect("Rust").items)
}

/// The module that a path within another one leads to.
fn resolved(path: &[String], module: &str) -> String {
    path.iter().fold(module.to_owned(), |home, step| match step.as_str() {
        "crate" => "crate".to_owned(),
        "super" => home.rsplit_once("::").map_or(home.clone(), |(parent, _)| parent.to_owned()),
        step => format!("{home}::{step}"),
    })
}

/// The path to what `use` gives this name.
fn leaf(tree: &UseTree, mut path: Vec<String>, name: &str) -> Option<Vec<String>> {
    match tree {
        UseTree::Path(tree) => {
            path.push(tree.ident.to_string());
            leaf(&tree.tree, path, name)
        }
        UseTree::Group(group) => group.items.iter().find_map(|tree| leaf(tree, path.clone(), name)),
        UseTree::Name(tree) => (tree.ident == name).then_some(path),
        UseTree::Rename(_) | UseTree::Glob(_) => None,
    }
}

struct Surface {
    /// Every module's items by its path, `crate::run`.
    modules: BTreeMap<String, Vec<Item>>,
    lines: BTreeSet<String>,
}

impl Surface {
    fn line(&mut self, path: &str, tokens: &impl ToTokens) {
        self.lines.extend(shown(tokens).map(|text| format!("{path} | {text}")));
    }

    /// Keeps the items of a file or module, and of those below it.
    fn insert(&mut self, mut items: Vec<Item>, directory: &Path, path: &str) {
        let is_test = |text: String| text.contains("#[cfg(test") || text.contains("#[cfg(all(test");
        items.retain(|item| !shown(item).is_some_and(is_test));
        let is_made = |item: &mut Item| matches!(item, Item::Macro(call) if generated(call).is_some());
        let has_types = ["crate::retraction", "crate::scheme"].contains(&path);
        let calls = items.extract_if(.., |item| has_types && is_made(item));
        let made =
            calls.filter_map(|item| if let Item::Macro(call) = item { generated(&call) } else { None });
        let made: Vec<Item> = made.flatten().collect();
        items.extend(made);
        for item in &items {
            let Item::Mod(module) = item else { continue };
            let below = directory.join(module.ident.to_string());
            let path = format!("{path}::{}", module.ident);
            if let Some((_, items)) = &module.content {
                self.insert(items.clone(), &below, &path);
                continue;
            }
            let text = std::fs::read_to_string(below.join("mod.rs"));
            let text = text.or_else(|_| std::fs::read_to_string(below.with_extension("rs")));
            let text = text.expect("the file of a module");
            self.insert(syn::parse_file(&text).expect("Rust").items, &below, &path);
        }
        self.modules.insert(path.to_owned(), items);
    }

    /// All that is public in a module, under its public path. Exported macros are the root's, wherever they stand.
    fn module(&mut self, module: &str, public: &str) {
        for item in self.modules[module].clone() {
            match (&item, head(&item)) {
                (Item::Use(export), Some((_, true))) if shown(export).is_some() => {
                    self.exported(&export.tree, Vec::new(), module, public);
                }
                (_, Some((name, true))) => self.item(&item, module, &format!("{public}::{name}")),
                (Item::Macro(call), _) if call.ident.is_none() => self.line(public, call),
                _ => {}
            }
        }
        for item in self.modules.clone().values().flatten().filter(|_| module == "crate") {
            let Item::Macro(item) = item else { continue };
            if item.attrs.iter().any(|attribute| attribute.path().is_ident("macro_export")) {
                self.line(public, item);
            }
        }
    }

    /// What `pub use` gives another path. It is shown in full if the one it is taken from is private.
    fn exported(&mut self, tree: &UseTree, mut path: Vec<String>, module: &str, public: &str) {
        let (last, name) = match tree {
            UseTree::Path(tree) => {
                path.push(tree.ident.to_string());
                return self.exported(&tree.tree, path, module, public);
            }
            UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.exported(tree, path.clone(), module, public));
            }
            UseTree::Name(tree) => (tree.ident.to_string(), tree.ident.to_string()),
            UseTree::Rename(tree) => (tree.ident.to_string(), tree.rename.to_string()),
            // of private modules that are made of a table
            UseTree::Glob(_) => {
                let home = resolved(&path, module);
                assert!(
                    home.ends_with("::markers") && !self.is_public(&home),
                    "{module} exports what cannot be seen"
                );
                for item in self.modules[&home].clone() {
                    let (name, _) = head(&item).expect("a type");
                    self.item(&item, &home, &format!("{public}::{name}"));
                }
                return;
            }
        };
        let home = resolved(&path, module);
        self.lines
            .insert(format!("{public}::{name} | use {}", [path, vec![last.clone()]].concat().join("::")));
        let items =
            self.modules.get(&home).filter(|_| !self.is_public(&home) && public != "coadjoint::prelude");
        let is_it = |item: &&Item| !matches!(item, Item::Mod(_)) && head(item) == Some((last.clone(), true));
        for item in items.into_iter().flatten().filter(is_it).cloned().collect::<Vec<_>>() {
            self.item(&item, &home, &format!("{public}::{name}"));
        }
    }

    fn is_public(&self, module: &str) -> bool {
        let Some((parent, last)) = module.rsplit_once("::") else { return true };
        let mut heads = self.modules.get(parent).into_iter().flatten().filter_map(head);
        heads.any(|head| head == (last.to_owned(), true)) && self.is_public(parent)
    }

    /// An item with its members and the traits that it implements.
    fn item(&mut self, item: &Item, module: &str, path: &str) {
        if shown(item).is_none() {
            return;
        }
        self.line(path, item);
        match item {
            Item::Mod(item) => self.module(&format!("{module}::{}", item.ident), path),
            Item::Trait(item) => item.items.iter().for_each(|member| match member {
                TraitItem::Fn(given) if given.default.is_some() => {
                    self.lines.extend(shown(given).map(|text| format!("{path} | {text} {{ … }}")));
                }
                member => self.line(path, member),
            }),
            Item::Enum(item) => item.variants.iter().for_each(|variant| {
                self.line(path, variant);
                let named = variant.fields.iter().filter(|field| field.ident.is_some());
                named.for_each(|field| self.line(&format!("{path}::{}", variant.ident), field));
            }),
            Item::Struct(item) => {
                let fields =
                    item.fields.iter().filter(|field| field.ident.is_some() && is_public(&field.vis));
                fields.for_each(|field| self.line(path, field));
            }
            _ => return,
        }
        let Some((name, _)) = head(item) else { return };
        for block in self.blocks(module, &name) {
            if block.trait_.is_some() {
                self.line(path, &block);
                continue;
            }
            block.items.iter().for_each(|member| match member {
                ImplItem::Fn(member) if is_public(&member.vis) => self.line(path, member),
                ImplItem::Const(member) if is_public(&member.vis) => self.line(path, member),
                _ => {}
            });
        }
    }

    /// The `impl` blocks of a type that is defined in a module, wherever they stand.
    fn blocks(&self, module: &str, name: &str) -> Vec<syn::ItemImpl> {
        let all = self.modules.iter().flat_map(|(place, items)| items.iter().map(move |item| (place, item)));
        let of_it = all.filter_map(|(place, item)| {
            let Item::Impl(block) = item else { return None };
            let Type::Path(of) = &*block.self_ty else { return None };
            let is_named = of.path.segments.last().is_some_and(|last| last.ident == name);
            (is_named && self.home(place, name).as_deref() == Some(module)).then(|| block.clone())
        });
        of_it.collect()
    }

    /// Where what a module calls by this name is defined.
    fn home(&self, module: &str, name: &str) -> Option<String> {
        let items = self.modules.get(module)?;
        let is_here = |item: &Item| {
            !matches!(item, Item::Mod(_) | Item::Use(_)) && head(item).is_some_and(|(found, _)| found == name)
        };
        if items.iter().any(is_here) {
            return Some(module.to_owned());
        }
        let path = items.iter().find_map(|item| match item {
            Item::Use(item) => leaf(&item.tree, Vec::new(), name),
            _ => None,
        })?;
        let next = resolved(&path, module);
        if next == module { None } else { self.home(&next, name) }
    }
}
