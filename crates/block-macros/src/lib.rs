//! `#[derive(BlockMeta)]`: what the manual, the palette and the deserializer know of a kind of block, taken from
//! its source.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::spanned::Spanned;
use syn::{Data, DeriveInput, Error, Expr, Field, Fields, LitStr, Result, Type, parse_quote};

/// Registers a struct of parameters as a kind of block.
///
/// On the struct: `#[block(category = "Math")]`, or `#[block(category = "Math", symbol = Gain("k"))]` with a variant
/// of `blocksim_block::Symbol` for drawings, and a doc comment, which becomes the page of the manual. On a
/// field: its doc comment, `#[block(unit = "s")]`, `#[block(default = 0.5)]`, and `#[block(skip)]` for what is
/// not a parameter (filled by `load`; its type must implement `Default`). A bare number is SI where a unit is
/// given; a field without one takes the unit that is written.
///
/// Implements `serde::Deserialize` (unknown fields are refused), `BlockKind`, and submits a `BlockInfo`.
#[proc_macro_derive(BlockMeta, attributes(block))]
pub fn derive_block_meta(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = syn::parse_macro_input!(input as DeriveInput);
    expand(&input).unwrap_or_else(Error::into_compile_error).into()
}

/// What a field says of itself.
struct Parameter {
    field: Field,
    unit: String,
    default: Option<Expr>,
    skip: bool,
    doc: String,
}

fn expand(input: &DeriveInput) -> Result<TokenStream> {
    let ident = &input.ident;
    let kind = ident.to_string();
    let doc = doc_of(&input.attrs);
    if doc.is_empty() {
        return Err(Error::new(
            ident.span(),
            "a kind of block needs a doc comment: it is its page in the manual",
        ));
    }
    let (category, symbol) = category_and_symbol_of(input)?;
    let parameters = parameters_of(input)?;
    let infos = parameters.iter().filter(|p| !p.skip).map(|p| {
        let name = p.field.ident.as_ref().map(ToString::to_string).unwrap_or_default();
        let rust_type = type_text(&p.field.ty);
        let (unit, doc) = (&p.unit, &p.doc);
        let default = match &p.default {
            Some(default) => {
                let text = quote!(#default).to_string().replace(' ', "");
                quote!(Some(#text))
            }
            None => quote!(None),
        };
        quote! {
            ::blocksim_block::ParameterInfo { name: #name, rust_type: #rust_type, unit: #unit, default: #default, doc: #doc }
        }
    });
    let deserialize = deserialize(ident, &parameters);
    Ok(quote! {
        const _: () = {
            use ::blocksim_block::private::{inventory, serde, typetag};
            #deserialize

            #[typetag::deserialize]
            impl ::blocksim_block::BlockKind for #ident {
                fn into_block(self: ::std::boxed::Box<Self>) -> ::std::boxed::Box<dyn ::blocksim_block::Block> {
                    self
                }
            }

            inventory::submit! {
                ::blocksim_block::BlockInfo {
                    kind: #kind,
                    category: #category,
                    symbol: { use ::blocksim_block::{Curve::*, Symbol::*}; #symbol },
                    doc: #doc,
                    parameters: &[#(#infos),*],
                    file: file!(),
                    line: line!(),
                }
            }
        };
    })
}

/// Reads through a twin of the struct, so that the default of a parameter stands in one place.
fn deserialize(ident: &syn::Ident, parameters: &[Parameter]) -> TokenStream {
    let name = ident.to_string();
    let mut twin_fields = Vec::new();
    let mut defaults = Vec::new();
    let mut moves = Vec::new();
    for p in parameters {
        let (field, ty) = (&p.field.ident, &p.field.ty);
        if p.skip {
            moves.push(quote!(#field: ::std::default::Default::default()));
            continue;
        }
        moves.push(quote!(#field: twin.#field));
        match &p.default {
            Some(value) => {
                let function =
                    format_ident!("default_{}", field.as_ref().map(ToString::to_string).unwrap_or_default());
                let path = function.to_string();
                twin_fields.push(quote!(#[serde(default = #path)] #field: #ty));
                defaults.push(quote!(fn #function() -> #ty { #value }));
            }
            None => twin_fields.push(quote!(#field: #ty)),
        }
    }
    if parameters.is_empty() {
        return quote! {
            impl<'de> serde::Deserialize<'de> for #ident {
                fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> ::std::result::Result<Self, D::Error> {
                    #[derive(serde::Deserialize)]
                    #[serde(crate = "serde", rename = #name, deny_unknown_fields)]
                    struct Twin {}
                    Twin::deserialize(deserializer).map(|_| #ident)
                }
            }
        };
    }
    quote! {
        impl<'de> serde::Deserialize<'de> for #ident {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> ::std::result::Result<Self, D::Error> {
                #(#defaults)*
                #[derive(serde::Deserialize)]
                #[serde(crate = "serde", rename = #name, deny_unknown_fields)]
                struct Twin { #(#twin_fields),* }
                Twin::deserialize(deserializer).map(|twin| #ident { #(#moves),* })
            }
        }
    }
}

fn category_and_symbol_of(input: &DeriveInput) -> Result<(String, Expr)> {
    let (mut category, mut symbol) = (None, parse_quote!(Plain));
    for attr in input.attrs.iter().filter(|attr| attr.path().is_ident("block")) {
        attr.parse_nested_meta(|meta| {
            if meta.path.is_ident("category") {
                category = Some(meta.value()?.parse::<LitStr>()?.value());
                return Ok(());
            }
            if meta.path.is_ident("symbol") {
                symbol = meta.value()?.parse()?;
                return Ok(());
            }
            Err(meta.error("expected `category = \"...\"` or `symbol = ...`"))
        })?;
    }
    let category =
        category.ok_or_else(|| Error::new(input.ident.span(), "missing #[block(category = \"...\")]"))?;
    Ok((category, symbol))
}

fn parameters_of(input: &DeriveInput) -> Result<Vec<Parameter>> {
    let Data::Struct(data) = &input.data else {
        return Err(Error::new(input.ident.span(), "a kind of block is a struct"));
    };
    match &data.fields {
        Fields::Unit => Ok(Vec::new()),
        Fields::Named(fields) => fields.named.iter().map(parameter_of).collect(),
        Fields::Unnamed(fields) => Err(Error::new(fields.span(), "parameters have names")),
    }
}

fn parameter_of(field: &Field) -> Result<Parameter> {
    let mut parameter = Parameter {
        field: field.clone(),
        unit: String::new(),
        default: None,
        skip: false,
        doc: doc_of(&field.attrs),
    };
    for attr in field.attrs.iter().filter(|attr| attr.path().is_ident("block")) {
        attr.parse_nested_meta(|meta| {
            if meta.path.is_ident("unit") {
                parameter.unit = meta.value()?.parse::<LitStr>()?.value();
            } else if meta.path.is_ident("default") {
                parameter.default = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("skip") {
                parameter.skip = true;
            } else {
                return Err(meta.error("expected `unit`, `default` or `skip`"));
            }
            Ok(())
        })?;
    }
    if parameter.doc.is_empty() && !parameter.skip {
        return Err(Error::new(
            field.span(),
            "a parameter needs a doc comment: it is its line in the manual",
        ));
    }
    Ok(parameter)
}

fn doc_of(attrs: &[syn::Attribute]) -> String {
    let mut lines = Vec::new();
    for attr in attrs.iter().filter(|attr| attr.path().is_ident("doc")) {
        if let syn::Meta::NameValue(pair) = &attr.meta
            && let Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) = &pair.value
        {
            let line = text.value();
            lines.push(line.strip_prefix(' ').unwrap_or(&line).to_owned());
        }
    }
    lines.join("\n").trim().to_owned()
}

fn type_text(ty: &Type) -> String {
    quote!(#ty).to_string().replace(' ', "")
}
