//! What the fields of a struct of parameters say of themselves.

use quote::quote;
use syn::meta::ParseNestedMeta;
use syn::spanned::Spanned;
use syn::{Data, DeriveInput, Error, Expr, Field, Fields, Ident, LitStr, Result, Type, token};

use crate::requirement::Requirements;

/// A field of a struct of parameters.
pub struct Parameter {
    pub ident: Ident,
    pub ty: Type,
    pub what: What,
    pub doc: String,
}

/// What a field is.
pub enum What {
    /// A parameter.
    One(Box<One>),
    /// A group of parameters, some with other defaults than the group has.
    Group(Vec<(Ident, Expr)>),
    /// Something that is filled later.
    Skip,
}

/// A parameter with its unit, its default and what its value must be.
#[derive(Default)]
pub struct One {
    pub unit: String,
    pub default: Option<Expr>,
    pub requires: Requirements,
    pub is_difference: bool,
}

pub fn fields_of(input: &DeriveInput) -> Result<Vec<Parameter>> {
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
    let (mut one, mut group, mut skip, mut is_one) = (One::default(), None, false, false);
    for attr in field.attrs.iter().filter(|attr| attr.path().is_ident("block")) {
        attr.parse_nested_meta(|meta| {
            if meta.path.is_ident("group") {
                group = Some(group_defaults(&meta)?);
            } else if meta.path.is_ident("skip") {
                skip = true;
            } else {
                is_one = true;
                one.read(&meta)?;
            }
            Ok(())
        })?;
    }
    let doc = doc_of(&field.attrs);
    let what = match (group, skip) {
        (None, false) => What::One(Box::new(one)),
        (Some(defaults), false) => What::Group(defaults),
        (None, true) => What::Skip,
        (Some(_), true) => {
            return Err(Error::new(field.span(), "a group is a parameter: it cannot be left out"));
        }
    };
    let one = matches!(what, What::One(_));
    if is_one && !one {
        return Err(Error::new(field.span(), "units, defaults and ranges are those of single parameters"));
    }
    if doc.is_empty() && one {
        return Err(Error::new(
            field.span(),
            "a parameter needs a doc comment: it is its line in the manual",
        ));
    }
    Ok(Parameter { ident, ty: field.ty.clone(), what, doc })
}

impl One {
    fn read(&mut self, meta: &ParseNestedMeta) -> Result<()> {
        if meta.path.is_ident("unit") {
            self.unit = meta.value()?.parse::<LitStr>()?.value();
        } else if meta.path.is_ident("default") {
            self.default = Some(meta.value()?.parse()?);
        } else if meta.path.is_ident("difference") {
            self.is_difference = true;
        } else if !self.requires.read(meta)? {
            return Err(meta.error(
                "expected `unit`, `default`, `difference`, `group`, `skip`, or what the value must be",
            ));
        }
        Ok(())
    }
}

fn group_defaults(meta: &ParseNestedMeta) -> Result<Vec<(Ident, Expr)>> {
    let mut defaults = Vec::new();
    if meta.input.peek(token::Paren) {
        meta.parse_nested_meta(|meta| {
            defaults.push((meta.path.require_ident()?.clone(), meta.value()?.parse()?));
            Ok(())
        })?;
    }
    Ok(defaults)
}

pub fn doc_of(attrs: &[syn::Attribute]) -> String {
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

pub fn type_text(ty: &Type) -> String {
    quote!(#ty).to_string().replace(' ', "")
}
