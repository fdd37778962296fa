//! `#[state_variables]`.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::{Error, ImplItem, ImplItemFn, ItemImpl, Result, ReturnType, Type};

use crate::names;

const PASSED: &str = "passed";

fn value(method: &ImplItemFn) -> Result<&Type> {
    match &method.sig.output {
        ReturnType::Type(_, of) if matches!(**of, Type::Path(_)) => Ok(of),
        _ => Err(Error::new_spanned(&method.sig, "a state variable is an enum that derives Plain")),
    }
}

/// Keeps the methods; a hidden module `__Name` has type, text and setter of each variable.
pub fn expand(mut block: ItemImpl) -> Result<TokenStream> {
    let Type::Path(of) = &*block.self_ty else {
        return Err(Error::new_spanned(&block.self_ty, "state variables are methods of a struct"));
    };
    let name = of.path.segments.last().map(|last| &last.ident);
    let module = format_ident!("__{}", name.map(ToString::to_string).unwrap_or_default());
    let (mut variables, mut setters, mut passed) = (Vec::new(), Vec::new(), quote!(()));
    for item in &mut block.items {
        let ImplItem::Fn(method) = item else {
            return Err(Error::new_spanned(item, "each item is a method that senses a state variable"));
        };
        let count = method.attrs.len();
        method.attrs.retain(|attribute| !attribute.path().is_ident(PASSED));
        let (name, of) = (&method.sig.ident, value(method)?);
        let (text, doc) = (name.to_string(), names::doc(&method.attrs).join(" "));
        variables.push(quote! {
            pub type #name = super::#of;
            pub const #name: ::rcs_core::table::Variable =
                ::rcs_core::table::Variable { name: #text, doc: #doc, values: <super::#of>::ENUM };
        });
        if method.attrs.len() < count {
            passed = quote!(super::#of);
            setters.push(quote!(pub const fn #name(field: &mut super::#name, passed: super::Passed) { *field = passed; }));
        } else {
            setters.push(quote!(pub const fn #name(_: &mut super::#name, _: super::Passed) {}));
        }
    }
    Ok(quote! {
        #block

        #[doc(hidden)]
        #[allow(
            non_snake_case, non_camel_case_types, non_upper_case_globals, dead_code, clippy::missing_const_for_fn,
            reason = "what belongs to a variable has its name"
        )]
        pub mod #module {
            #( #variables )*
            /// The type of the variable that a table above passes on.
            pub type Passed = #passed;
            /// Setters, one per variable. Only that of the passed variable changes it.
            pub mod pass { #( #setters )* }
        }
    })
}
