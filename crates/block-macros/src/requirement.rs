//! What a field requires of its value.

use proc_macro2::TokenStream;
use quote::quote;
use syn::meta::ParseNestedMeta;
use syn::{Error, Expr, Ident, LitStr, Result};

/// What is required of a parameter, as tokens.
#[derive(Default)]
pub struct Requirements {
    /// Variants of `Requirement`.
    list: Vec<TokenStream>,
    /// Other parameters that it is compared with.
    pub others: Vec<Ident>,
    remedy: String,
    at_nothing: String,
}

impl Requirements {
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Takes one word of the attribute; whether it is about requirements.
    pub fn read(&mut self, meta: &ParseNestedMeta) -> Result<bool> {
        let word = meta.path.require_ident()?.to_string();
        match word.as_str() {
            "remedy" => self.remedy = meta.value()?.parse::<LitStr>()?.value(),
            "zero" | "empty" => self.at_nothing = meta.value()?.parse::<LitStr>()?.value(),
            "finite" => self.list.push(quote!(Finite)),
            "positive" => self.list.extend([quote!(Finite), quote!(Above(Number(0.0)))]),
            "negative" => self.list.extend([quote!(Finite), quote!(Below(Number(0.0)))]),
            "not_negative" => self.list.extend([quote!(Finite), quote!(AtLeast(Number(0.0)))]),
            "not_zero" => self.list.extend([quote!(Finite), quote!(NotZero)]),
            "not_empty" => self.list.push(quote!(NotEmpty)),
            "increasing" => self.list.push(quote!(Increasing)),
            "a_unit" => self.list.push(quote!(Unit)),
            "direction" => self.list.extend([quote!(Finite), quote!(Direction)]),
            "as_many_as" => {
                let other: Ident = meta.value()?.parse()?;
                let name = other.to_string();
                self.list.push(quote!(AsManyAs(#name)));
                self.others.push(other);
            }
            "above" | "at_least" | "below" | "at_most" => {
                let bound = self.bound(meta.value()?.parse()?);
                self.list.push(match word.as_str() {
                    "above" => quote!(Above(#bound)),
                    "at_least" => quote!(AtLeast(#bound)),
                    "below" => quote!(Below(#bound)),
                    _ => quote!(AtMost(#bound)),
                });
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// A number, or the name of another parameter: a single word in lower case.
    fn bound(&mut self, value: Expr) -> TokenStream {
        if let Expr::Path(path) = &value
            && let Some(other) = path.path.get_ident()
            && other.to_string().starts_with(|sign: char| sign.is_lowercase())
        {
            let name = other.to_string();
            self.others.push(other.clone());
            return quote!(Parameter(#name));
        }
        quote!(Number((#value) as f64))
    }

    /// Refuses other parameters that the struct does not have itself.
    pub fn known(&self, fields: &[&Ident]) -> Result<()> {
        match self.others.iter().find(|other| !fields.contains(other)) {
            Some(other) => Err(Error::new(
                other.span(),
                format!("`{other}` is not a parameter of this struct; `fn validate` can compare with others"),
            )),
            None => Ok(()),
        }
    }

    /// The constant of this.
    pub fn tokens(&self) -> TokenStream {
        let Self { list, remedy, at_nothing, .. } = self;
        quote! {
            ::blocksim_block::Requirements {
                list: {
                    #[allow(unused_imports)]
                    use ::blocksim_block::{Bound::*, Requirement::*};
                    &[#(#list),*]
                },
                remedy: #remedy,
                at_nothing: #at_nothing,
            }
        }
    }
}
