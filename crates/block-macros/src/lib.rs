//! `#[derive(BlockMeta)]`: what the manual, the palette and the deserializer know of a kind of block, taken from
//! its source; and `#[derive(Parameters)]`, the same of a group of parameters that several kinds share.

use proc_macro2::TokenStream;
use quote::quote;
use syn::spanned::Spanned;
use syn::{Data, DeriveInput, Error, Expr, Field, Fields, Ident, LitStr, Result, Type, parse_quote};

/// Registers a struct of parameters as a kind of block.
///
/// On the struct: `#[block(category = "Math")]`, or `#[block(category = "Math", symbol = Gain("k"))]` with a variant
/// of `blocksim_block::Symbol` for drawings, and a doc comment, which becomes the page of the manual. On a
/// field: its doc comment, `#[block(unit = "s")]`, `#[block(default = 0.5)]`, `#[block(group)]` for a group of parameters,
/// whose type derives `Parameters`, `#[block(group(v_f = 0.8))]` where one of them has another default, and `#[block(skip)]` for what is not a parameter (filled by `load`; its type must
/// implement `Default`). A bare number is SI where a unit is given; a field without one takes the unit that is written.
///
/// Implements `Parameters`, `serde::Deserialize` (unknown fields are refused), `BlockKind`, and submits a `BlockInfo`.
#[proc_macro_derive(BlockMeta, attributes(block))]
pub fn derive_block_meta(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = syn::parse_macro_input!(input as DeriveInput);
    expand(&input).unwrap_or_else(Error::into_compile_error).into()
}

/// Makes a struct a group of parameters, which several kinds of block have in common.
///
/// Fields say the same of themselves as those of a block. A block has all parameters of the group, as if they stood in the
/// place of its field `#[block(group)]`.
#[proc_macro_derive(Parameters, attributes(block))]
pub fn derive_parameters(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = syn::parse_macro_input!(input as DeriveInput);
    let group = fields_of(&input).map(|fields| {
        let parameters = parameters(&input.ident, &fields);
        quote! { const _: () = { #parameters }; }
    });
    group.unwrap_or_else(Error::into_compile_error).into()
}

/// A field of a struct of parameters.
struct Parameter {
    ident: Ident,
    ty: Type,
    what: What,
    doc: String,
}

/// What a field is.
enum What {
    /// A parameter, with its unit and its default.
    One { unit: String, default: Option<Expr> },
    /// A group of parameters, some with other defaults than the group has.
    Group(Vec<(Ident, Expr)>),
    /// Something that is filled later.
    Skip,
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
    let parameters = parameters(ident, &fields_of(input)?);
    Ok(quote! {
        const _: () = {
            use ::blocksim_block::private::{inventory, serde, typetag};
            #parameters

            impl<'de> serde::Deserialize<'de> for #ident {
                fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> ::std::result::Result<Self, D::Error> {
                    let mut read = <#ident as ::blocksim_block::Parameters>::Read::default();
                    ::blocksim_block::private::read_parameters(
                        #kind,
                        <#ident as ::blocksim_block::Parameters>::NAMES,
                        &mut |index, values| <#ident as ::blocksim_block::Parameters>::read(&mut read, index, values),
                        deserializer,
                    )?;
                    <#ident as ::blocksim_block::Parameters>::whole(read)
                        .map_err(|missing| serde::de::Error::missing_field(missing.0))
                }
            }

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
                    parameters: <#ident as ::blocksim_block::Parameters>::INFOS,
                    file: file!(),
                    line: line!(),
                }
            }
        };
    })
}

/// The implementation of `Parameters`.
fn parameters(ident: &Ident, fields: &[Parameter]) -> TokenStream {
    let trait_path = quote!(::blocksim_block::Parameters);
    // Lists of infos; places for what is read; reading by index; the whole.
    let (mut infos, mut places, mut reads, mut whole) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for Parameter { ident: field, ty, what, doc } in fields {
        let name = field.to_string();
        match what {
            What::Skip => whole.push(quote!(#field: ::std::default::Default::default())),
            What::Group(defaults) => {
                let known = quote!(<#ty as #trait_path>::INFOS);
                infos.push(defaults.iter().fold(known.clone(), |infos, (name, default)| {
                    let (name, text) = (name.to_string(), quote!(#default).to_string().replace(' ', ""));
                    quote!(&::blocksim_block::private::with_default::<{ #known.len() }>(#infos, #name, #text))
                }));
                places.push(quote!(pub #field: <#ty as #trait_path>::Read));
                reads.push(quote! {
                    if index < <#ty as #trait_path>::INFOS.len() {
                        return <#ty as #trait_path>::read(&mut read.#field, index, values);
                    }
                    let index = index - <#ty as #trait_path>::INFOS.len();
                });
                let (names, values): (Vec<_>, Vec<_>) = defaults.iter().cloned().unzip();
                whole.push(quote! {
                    #field: {
                        #[allow(unused_mut)]
                        let mut group = read.#field;
                        #(group.#names.get_or_insert_with(|| #values);)*
                        <#ty as #trait_path>::whole(group)?
                    }
                });
            }
            What::One { unit, default } => {
                let rust_type = type_text(ty);
                let (shown, value) = match default {
                    Some(default) => {
                        let text = quote!(#default).to_string().replace(' ', "");
                        (quote!(::std::option::Option::Some(#text)), quote!(#default))
                    }
                    None => (
                        quote!(::std::option::Option::None),
                        quote!(return ::std::result::Result::Err(::blocksim_block::private::Missing(#name))),
                    ),
                };
                infos.push(quote! {
                    &[::blocksim_block::ParameterInfo { name: #name, rust_type: #rust_type, unit: #unit, default: #shown, doc: #doc }]
                });
                places.push(quote!(pub #field: ::std::option::Option<#ty>));
                reads.push(quote! {
                    if index == 0 {
                        return ::blocksim_block::private::read_value(&mut read.#field, #name, values);
                    }
                    let index = index - 1;
                });
                whole.push(quote! {
                    #field: match read.#field {
                        ::std::option::Option::Some(value) => value,
                        ::std::option::Option::None => #value,
                    }
                });
            }
        }
    }
    quote! {
        #[doc(hidden)]
        #[derive(::std::default::Default)]
        pub struct Read { #(#places),* }

        const LISTS: &[&[::blocksim_block::ParameterInfo]] = &[#(#infos),*];
        const COUNT: usize = ::blocksim_block::private::count(LISTS);

        impl #trait_path for #ident {
            const INFOS: &'static [::blocksim_block::ParameterInfo] =
                &::blocksim_block::private::joined::<COUNT>(LISTS);
            const NAMES: &'static [&'static str] = &::blocksim_block::private::names::<COUNT>(Self::INFOS);
            type Read = Read;

            fn read<'de>(
                read: &mut Read,
                index: usize,
                values: &mut dyn ::blocksim_block::private::Values<'de>,
            ) -> ::std::result::Result<(), ::blocksim_block::private::ReadError> {
                #(#reads)*
                let _ = (read, values);
                ::std::unreachable!("a parameter {index} behind the last one")
            }

            fn whole(read: Read) -> ::std::result::Result<Self, ::blocksim_block::private::Missing> {
                let _ = &read;
                ::std::result::Result::Ok(#ident { #(#whole),* })
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

fn fields_of(input: &DeriveInput) -> Result<Vec<Parameter>> {
    let Data::Struct(data) = &input.data else {
        return Err(Error::new(input.ident.span(), "parameters are the fields of a struct"));
    };
    match &data.fields {
        Fields::Unit => Ok(Vec::new()),
        Fields::Named(fields) => fields.named.iter().map(parameter_of).collect(),
        Fields::Unnamed(fields) => Err(Error::new(fields.span(), "parameters have names")),
    }
}

fn parameter_of(field: &Field) -> Result<Parameter> {
    let Some(ident) = field.ident.clone() else {
        return Err(Error::new(field.span(), "parameters have names"));
    };
    let (mut unit, mut default) = (None, None);
    let (mut group, mut skip) = (None, false);
    for attr in field.attrs.iter().filter(|attr| attr.path().is_ident("block")) {
        attr.parse_nested_meta(|meta| {
            if meta.path.is_ident("unit") {
                unit = Some(meta.value()?.parse::<LitStr>()?.value());
            } else if meta.path.is_ident("default") {
                default = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("group") {
                let defaults = group.insert(Vec::new());
                if meta.input.peek(syn::token::Paren) {
                    meta.parse_nested_meta(|meta| {
                        defaults.push((meta.path.require_ident()?.clone(), meta.value()?.parse()?));
                        Ok(())
                    })?;
                }
            } else if meta.path.is_ident("skip") {
                skip = true;
            } else {
                return Err(meta.error("expected `unit`, `default`, `group` or `skip`"));
            }
            Ok(())
        })?;
    }
    let doc = doc_of(&field.attrs);
    let what = match (group, skip) {
        (None, false) => What::One { unit: unit.take().unwrap_or_default(), default: default.take() },
        (Some(defaults), false) => What::Group(defaults),
        (None, true) => What::Skip,
        (Some(_), true) => {
            return Err(Error::new(field.span(), "a group is a parameter: it cannot be left out"));
        }
    };
    if unit.is_some() || default.is_some() {
        return Err(Error::new(field.span(), "units and defaults are those of single parameters"));
    }
    if doc.is_empty() && matches!(what, What::One { .. }) {
        return Err(Error::new(
            field.span(),
            "a parameter needs a doc comment: it is its line in the manual",
        ));
    }
    Ok(Parameter { ident, ty: field.ty.clone(), what, doc })
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
