//! The implementation of `Parameters`.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Ident, Result};

use crate::field::{One, Parameter, What, type_text};

/// Parts of the implementation, field by field.
#[derive(Default)]
struct Parts {
    /// Lists of infos.
    infos: Vec<TokenStream>,
    /// Places for what is read.
    places: Vec<TokenStream>,
    /// Reading by index.
    reads: Vec<TokenStream>,
    /// Defaults.
    complete: Vec<TokenStream>,
    /// Values of what is read, by index.
    values_read: Vec<TokenStream>,
    /// Values, by index.
    values: Vec<TokenStream>,
    /// Fields of the whole.
    whole: Vec<TokenStream>,
    /// Validation of groups.
    validate: Vec<TokenStream>,
    /// Parameters since the last group.
    behind: usize,
}

pub fn implementation(ident: &Ident, fields: &[Parameter]) -> Result<TokenStream> {
    let own: Vec<(&Ident, &One)> = fields
        .iter()
        .filter_map(|field| match &field.what {
            What::One(one) => Some((&field.ident, &**one)),
            _ => None,
        })
        .collect();
    let names: Vec<&Ident> = own.iter().map(|(ident, _)| *ident).collect();
    own.iter().try_for_each(|(_, one)| one.requires.known(&names))?;
    let mut parts = Parts::default();
    for field in fields {
        let name = &field.ident;
        match &field.what {
            What::Skip => parts.whole.push(quote!(#name: ::std::default::Default::default())),
            What::Group(defaults) => parts.group(field, defaults),
            What::One(one) => {
                let compared = own.iter().any(|(_, other)| other.requires.others.contains(name));
                parts.one(field, one, compared || !one.requires.is_empty());
            }
        }
    }
    Ok(parts.tokens(ident))
}

impl Parts {
    fn group(&mut self, Parameter { ident: field, ty, .. }: &Parameter, defaults: &[(Ident, syn::Expr)]) {
        let group = quote!(<#ty as ::blocksim_block::Parameters>);
        let known = quote!(#group::INFOS);
        self.infos.push(defaults.iter().fold(known.clone(), |infos, (name, default)| {
            let (name, text) = (name.to_string(), quote!(#default).to_string().replace(' ', ""));
            quote!(&::blocksim_block::private::with_default::<{ #known.len() }>(#infos, #name, #text))
        }));
        self.places.push(quote!(pub #field: #group::Read));
        self.reads.push(quote! {
            if index < #known.len() {
                return #group::read(&mut read.#field, index, values);
            }
            let index = index - #known.len();
        });
        for (name, default) in defaults {
            let text = name.to_string();
            self.complete.push(quote! {
                if read.#field.#name.is_none() && errors.is_right(#text) {
                    read.#field.#name = ::std::option::Option::Some(#default);
                }
            });
        }
        self.complete.push(quote!(#group::complete(&mut read.#field, errors);));
        let behind = std::mem::take(&mut self.behind);
        let by_index = |value: TokenStream| {
            quote! {
                if index < #behind {
                    return ::std::option::Option::None;
                }
                let index = index - #behind;
                if index < #known.len() {
                    return #value;
                }
                let index = index - #known.len();
            }
        };
        self.values_read.push(by_index(quote!(#group::value_read(&read.#field, index))));
        self.values.push(by_index(quote!(#group::value(&self.#field, index))));
        self.whole.push(quote!(#field: #group::whole(read.#field)?));
        self.validate.push(quote!(#group::validate_all(&self.#field, errors);));
    }

    fn one(&mut self, Parameter { ident: field, ty, doc, .. }: &Parameter, one: &One, inspected: bool) {
        let (name, rust_type, unit) = (field.to_string(), type_text(ty), &one.unit);
        let (requires, option) = (one.requires.tokens(), quote!(::std::option::Option));
        let is_difference = one.is_difference;
        let default = match &one.default {
            Some(default) => {
                let text = quote!(#default).to_string().replace(' ', "");
                quote!(#option::Some(#text))
            }
            None => quote!(#option::None),
        };
        self.infos.push(quote! {
            &[::blocksim_block::ParameterInfo {
                name: #name,
                rust_type: #rust_type,
                unit: #unit,
                default: #default,
                doc: #doc,
                requires: #requires,
                is_difference: #is_difference,
            }]
        });
        self.places.push(quote!(pub #field: #option<#ty>));
        self.reads.push(quote! {
            if index == 0 {
                return ::blocksim_block::private::read_value(&mut read.#field, #name, values);
            }
            let index = index - 1;
        });
        if let Some(default) = &one.default {
            self.complete.push(quote! {
                if read.#field.is_none() && errors.is_right(#name) {
                    read.#field = #option::Some(#default);
                }
            });
        }
        if inspected {
            let behind = self.behind;
            let inspect = quote!(dyn ::blocksim_block::Inspect);
            self.values_read.push(quote! {
                if index == #behind {
                    return read.#field.as_ref().map(|value| value as &#inspect);
                }
            });
            self.values.push(quote! {
                if index == #behind {
                    return #option::Some(&self.#field);
                }
            });
        }
        self.behind += 1;
        self.whole.push(quote! {
            #field: match read.#field {
                #option::Some(value) => value,
                #option::None => {
                    return ::std::result::Result::Err(::blocksim_block::private::Missing(#name));
                }
            }
        });
    }

    fn tokens(self, ident: &Ident) -> TokenStream {
        let Self { infos, places, reads, complete, values_read, values, whole, validate, .. } = self;
        quote! {
            #[doc(hidden)]
            #[derive(::std::default::Default)]
            pub struct Read { #(#places),* }

            const LISTS: &[&[::blocksim_block::ParameterInfo]] = &[#(#infos),*];
            const COUNT: usize = ::blocksim_block::private::count(LISTS);

            #[allow(unused_variables)]
            impl ::blocksim_block::Parameters for #ident {
                const INFOS: &'static [::blocksim_block::ParameterInfo] =
                    &::blocksim_block::private::joined::<COUNT>(LISTS);
                const NAMES: &'static [&'static str] =
                    &::blocksim_block::private::names::<COUNT>(Self::INFOS);
                type Read = Read;

                fn read<'de>(
                    read: &mut Read,
                    index: usize,
                    values: &mut dyn ::blocksim_block::private::Values<'de>,
                ) -> ::std::result::Result<(), ::blocksim_block::private::ReadError> {
                    #(#reads)*
                    ::std::unreachable!("a parameter {index} behind the last one")
                }

                fn complete(read: &mut Read, errors: &::blocksim_block::ParamErrors) {
                    #(#complete)*
                }

                fn value_read(
                    read: &Read,
                    index: usize,
                ) -> ::std::option::Option<&dyn ::blocksim_block::Inspect> {
                    #(#values_read)*
                    ::std::option::Option::None
                }

                fn value(&self, index: usize) -> ::std::option::Option<&dyn ::blocksim_block::Inspect> {
                    #(#values)*
                    ::std::option::Option::None
                }

                fn whole(read: Read) -> ::std::result::Result<Self, ::blocksim_block::private::Missing> {
                    ::std::result::Result::Ok(#ident { #(#whole),* })
                }

                fn validate_all(&self, errors: &mut ::blocksim_block::ParamErrors) {
                    #(#validate)*
                    #[allow(unused_imports)]
                    use ::blocksim_block::private::NoValidation as _;
                    self.validate(errors);
                }
            }
        }
    }
}
