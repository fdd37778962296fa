//! `#[derive(Actions)]`.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::{Data, DeriveInput, Error, Fields, Result};

use crate::names;

/// A hidden module `__Name` has the type of each argument under the name of its action.
pub fn derive(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    let Data::Enum(data) = &input.data else {
        return Err(Error::new_spanned(name, "actions are the variants of an enum"));
    };
    let vis = &input.vis;
    let module = format_ident!("__{name}");
    let (mut schemas, mut aliases) = (Vec::new(), Vec::new());
    for variant in &data.variants {
        let (ident, text) = (&variant.ident, variant.ident.to_string());
        let doc = names::doc(&variant.attrs).join(" ");
        let argument = match &variant.fields {
            Fields::Unit => quote!(None),
            Fields::Unnamed(fields) if fields.unnamed.len() == 1 => {
                let types = fields.unnamed.iter().map(|field| &field.ty);
                aliases.extend(
                    fields
                        .unnamed
                        .iter()
                        .map(|field| &field.ty)
                        .map(|ty| quote!(pub type #ident = super::#ty;)),
                );
                quote!(Some(#( <#types>::ENUM )*))
            }
            other => {
                return Err(Error::new_spanned(
                    other,
                    "an action is bare or carries one enum: `Fail(Reason)`",
                ));
            }
        };
        schemas.push(quote!(::rcs_core::table::ActionText { name: #text, doc: #doc, argument: #argument }));
    }
    Ok(quote! {
        impl #name {
            /// Name, meaning and argument of each action.
            pub const ACTIONS: &'static [::rcs_core::table::ActionText] = &[ #( #schemas, )* ];
        }

        #[doc(hidden)]
        #[allow(non_snake_case, dead_code, reason = "the type of an argument under the name of its action")]
        #vis mod #module {
            #( #aliases )*
        }
    })
}
