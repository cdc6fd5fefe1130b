//! `#[derive(BlockMeta)]`: what the manual, the palette and the reader of diagrams know of a kind of block, taken from
//! its source; and `#[derive(Parameters)]`, the same of a group of parameters that several kinds share.

mod field;
mod parameters;
mod requirement;

use proc_macro2::TokenStream;
use quote::quote;
use syn::{DeriveInput, Error, Expr, LitStr, Result, Type, parse_quote};

use field::{doc_of, fields_of};

/// Registers a struct of parameters as a kind of block.
///
/// On the struct: `#[block(category = "Math")]`, or `#[block(category = "Math", symbol = Gain("k"))]` with a variant
/// of `blocksim_block::Symbol` for drawings, and a doc comment, which becomes the page of the manual. On a
/// field: its doc comment, `#[block(unit = "s")]`, `#[block(default = 0.5)]`, `#[block(group)]` for a group of parameters,
/// whose type derives `Parameters`, `#[block(group(v_f = 0.8))]` where one of them has another default, and `#[block(skip)]` for what is
/// not a parameter (filled by `build` or `load`; its type must implement `Default`). A bare number is SI where a unit is given; a field
/// without one takes the unit that is written.
///
/// A field also says what its value must be, all numbers of it where it is a list; `None` is always allowed:
///
/// | written | allowed |
/// |---|---|
/// | `finite` | neither NaN nor infinity |
/// | `positive`, `negative`, `not_negative`, `not_zero` | finite, and on that side of zero |
/// | `above = 1.0`, `at_least = 0.0`, `below = MOST`, `at_most = 1.0` | such a number; infinite ones if they are on this side |
/// | `above = lower`, ... | the same beside another parameter of the struct, by its name |
/// | `not_empty`, `increasing` | a list or text with something in it; a list whose numbers increase |
/// | `a_unit` | a text that names a unit |
/// | `direction` | finite numbers, not all of them zero |
/// | `as_many_as = rows` | a list as long as that of another parameter |
///
/// `remedy = "..."` advises who writes something else, `zero = "..."` who writes zero, `empty = "..."` who writes an empty list. Users read the ranges in the manual and in their
/// editors. What cannot be said like this is found by a function of the struct, `fn validate(&self, errors: &mut ParamErrors)`.
///
/// A block that is worked out from its parameters is another type: `#[block(builds = DcMotor)]` on the struct, and
/// `fn build(self, errors: &mut ParamErrors) -> Option<DcMotor>`, which is called once, where `validate` has found nothing.
///
/// Implements `Parameters` and `BlockKind`, registers the kind with typetag, and submits a `BlockInfo`.
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
    let group = fields_of(&input).and_then(|fields| {
        let parameters = parameters::implementation(&input.ident, &fields)?;
        Ok(quote! { const _: () = { #parameters }; })
    });
    group.unwrap_or_else(Error::into_compile_error).into()
}

/// What `#[block(...)]` says of the struct of a kind.
struct Head {
    category: String,
    symbol: Expr,
    /// What runs, where that is not the struct itself.
    builds: Option<Type>,
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
    let Head { category, symbol, builds } = head_of(input)?;
    let parameters = parameters::implementation(ident, &fields_of(input)?)?;
    let (block, body) = match builds {
        Some(block) => (quote!(#block), quote!(Self::build(self, errors))),
        None => (quote!(Self), quote!(::std::option::Option::Some(self))),
    };
    Ok(quote! {
        const _: () = {
            use ::blocksim_block::private::{FieldsOf, inventory, serde, typetag};
            #parameters

            impl ::blocksim_block::BlockKind for #ident {
                type Block = #block;

                #[allow(unused_variables)]
                fn into_block(
                    self,
                    errors: &mut ::blocksim_block::ParamErrors,
                ) -> ::std::option::Option<Self::Block> {
                    #body
                }
            }

            #[doc(hidden)]
            pub struct OfKind(FieldsOf<#ident>);

            impl<'de> serde::Deserialize<'de> for OfKind {
                fn deserialize<D: serde::Deserializer<'de>>(
                    deserializer: D,
                ) -> ::std::result::Result<Self, D::Error> {
                    FieldsOf::read(#kind, deserializer).map(OfKind)
                }
            }

            #[typetag::deserialize(name = #kind)]
            impl ::blocksim_block::Registered for OfKind {
                fn fields(self: ::std::boxed::Box<Self>) -> ::std::boxed::Box<dyn ::blocksim_block::Fields> {
                    ::std::boxed::Box::new(self.0)
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

fn head_of(input: &DeriveInput) -> Result<Head> {
    let (mut category, mut symbol, mut builds) = (None, parse_quote!(Plain), None);
    for attr in input.attrs.iter().filter(|attr| attr.path().is_ident("block")) {
        attr.parse_nested_meta(|meta| {
            if meta.path.is_ident("category") {
                category = Some(meta.value()?.parse::<LitStr>()?.value());
            } else if meta.path.is_ident("symbol") {
                symbol = meta.value()?.parse()?;
            } else if meta.path.is_ident("builds") {
                builds = Some(meta.value()?.parse()?);
            } else {
                return Err(meta.error("expected `category = \"...\"`, `symbol = ...` or `builds = ...`"));
            }
            Ok(())
        })?;
    }
    let category =
        category.ok_or_else(|| Error::new(input.ident.span(), "missing #[block(category = \"...\")]"))?;
    Ok(Head { category, symbol, builds })
}
