//! `#[derive(Variables)]`.

use proc_macro2::TokenStream;
use quote::{ToTokens, format_ident, quote};
use syn::{Data, DeriveInput, Error, Fields, Ident, Result, spanned::Spanned as _};

use crate::names;

/// All values as one number.
pub fn code(name: &Ident, fields: &[&Ident], types: &[impl ToTokens]) -> TokenStream {
    quote! {
        const _: () = assert!(
            ::rcs_core::table::Variable::combinations(#name::VARIABLES).is_some(),
            "the values of the state variables do not fit into one number: divide the table",
        );

        impl ::rcs_core::table::Variables for #name {
            fn code(&self) -> u64 {
                let code = 0_u64;
                #( let code = code.wrapping_mul(u64::try_from(<#types>::ALL.len()).unwrap_or(u64::MAX))
                    .wrapping_add(u64::from(self.#fields.code())); )*
                code
            }
        }
    }
}

/// A hidden module `__Name` has the type of each variable under the name of its field.
pub fn derive(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    let Data::Struct(data) = &input.data else {
        return Err(Error::new_spanned(name, "state variables are the fields of a struct"));
    };
    let Fields::Named(fields) = &data.fields else {
        return Err(Error::new_spanned(name, "state variables have names"));
    };
    let vis = &input.vis;
    let module = format_ident!("__{name}");
    let idents: Vec<_> = fields.named.iter().filter_map(|field| field.ident.as_ref()).collect();
    let types: Vec<_> = fields.named.iter().map(|field| &field.ty).collect();
    let texts: Vec<_> = idents.iter().map(ToString::to_string).collect();
    let docs: Vec<_> = fields.named.iter().map(|field| names::doc(&field.attrs).join(" ")).collect();
    for field in &fields.named {
        if !matches!(field.ty, syn::Type::Path(_)) {
            return Err(Error::new(field.ty.span(), "a state variable is an enum that derives Plain"));
        }
    }
    let code = code(name, &idents, &types);
    Ok(quote! {
        impl #name {
            /// Name, meaning and values of each variable.
            pub const VARIABLES: &'static [::rcs_core::table::Variable] = &[ #( ::rcs_core::table::Variable {
                name: #texts,
                doc: #docs,
                values: <#types>::ENUM,
            }, )* ];
        }

        #code

        #[doc(hidden)]
        #[allow(non_snake_case, non_camel_case_types, dead_code, reason = "a type under the name of each field")]
        #vis mod #module {
            #( pub type #idents = super::#types; )*
        }
    })
}
