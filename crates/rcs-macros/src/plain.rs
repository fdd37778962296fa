//! `#[derive(Plain)]`.

use proc_macro2::{Literal, TokenStream};
use quote::quote;
use syn::{Data, DataEnum, DataStruct, DeriveInput, Error, Field, Fields, Ident, Result, Variant};

use crate::names;

pub fn derive(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    if !input.generics.params.is_empty() {
        return Err(Error::new_spanned(&input.generics, "plain data has no generic parameters"));
    }
    let plain = match &input.data {
        Data::Struct(data) => of_struct(name, data)?,
        Data::Enum(data) if data.variants.is_empty() => {
            return Err(Error::new_spanned(name, "plain data has a value: an enum needs a variant"));
        }
        Data::Enum(data) if data.variants.iter().all(|variant| variant.fields.is_empty()) => {
            of_enum(input, data)?
        }
        Data::Enum(data) => of_union(name, data)?,
        Data::Union(_) => return Err(Error::new_spanned(name, "plain data is a struct or an enum")),
    };
    Ok(quote! {
        #plain

        impl ::core::default::Default for #name {
            fn default() -> Self {
                <Self as ::rcs_core::Plain>::ZERO
            }
        }
    })
}

fn of_struct(name: &Ident, data: &DataStruct) -> Result<TokenStream> {
    let Fields::Named(fields) = &data.fields else {
        return Err(Error::new_spanned(name, "the fields of plain data have names"));
    };
    let (names, types): (Vec<_>, Vec<_>) = fields.named.iter().map(|field| (&field.ident, &field.ty)).unzip();
    let (text, texts) =
        (name.to_string(), names.iter().flat_map(|name| name.as_ref().map(ToString::to_string)));
    Ok(quote! {
        impl #name {
            /// The fields of the byte image.
            pub const STRUCT: &'static ::rcs_core::plain::StructSchema = &::rcs_core::plain::StructSchema::new(
                #text,
                &[ #( ::rcs_core::plain::FieldSchema {
                    name: #texts,
                    schema: <#types as ::rcs_core::Plain>::SCHEMA,
                }, )* ],
            );
        }

        impl ::rcs_core::Plain for #name {
            const SCHEMA: ::rcs_core::plain::Schema = ::rcs_core::plain::Schema::Struct(Self::STRUCT);
            const ZERO: Self = Self { #( #names: <#types as ::rcs_core::Plain>::ZERO, )* };

            // One check of the length covers all fields, because the compiler knows the place of each.
            fn encode(&self, w: &mut ::rcs_core::plain::Writer<'_>) {
                let Some(chunk) = w.chunk::<{ <#name as ::rcs_core::Plain>::SIZE }>() else { return };
                let w = &mut ::rcs_core::plain::Writer::new(chunk);
                #( ::rcs_core::Plain::encode(&self.#names, w); )*
            }

            fn decode(r: &mut ::rcs_core::plain::Reader<'_>) -> Result<Self, ::rcs_core::plain::DecodeError> {
                let r = &mut ::rcs_core::plain::Reader::new(r.chunk::<{ <#name as ::rcs_core::Plain>::SIZE }>()?);
                Ok(Self { #( #names: ::rcs_core::Plain::decode(r)?, )* })
            }
        }
    })
}

fn text_of(variant: &Variant) -> String {
    names::text(&variant.attrs).unwrap_or_else(|| names::words(&variant.ident.to_string(), '-'))
}

fn texts_of(input: &DeriveInput, data: &DataEnum) -> Result<Vec<String>> {
    let style = names::text_style(&input.attrs);
    let styled = |variant: &Variant| match style.as_str() {
        "doc" => Ok(names::clause(&names::doc(&variant.attrs).join(" "))),
        "upper" => Ok(names::words(&variant.ident.to_string(), '-').to_uppercase()),
        "" => Ok(text_of(variant)),
        _ => Err(Error::new_spanned(&input.ident, "`#[text(doc)]` or `#[text(upper)]` is expected")),
    };
    data.variants
        .iter()
        .map(|variant| names::text(&variant.attrs).map_or_else(|| styled(variant), Ok))
        .collect()
}

fn codes() -> impl Iterator<Item = Literal> {
    (0_u8..=u8::MAX).map(Literal::u8_suffixed)
}

fn of_enum(input: &DeriveInput, data: &DataEnum) -> Result<TokenStream> {
    let name = &input.ident;
    let text = name.to_string();
    let variants: Vec<_> = data.variants.iter().map(|variant| &variant.ident).collect();
    let idents: Vec<_> = variants.iter().map(ToString::to_string).collect();
    let texts = texts_of(input, data)?;
    let docs: Vec<_> = data.variants.iter().map(|variant| names::doc(&variant.attrs).join(" ")).collect();
    let codes: Vec<_> = codes().take(variants.len()).collect();
    let first = variants.first();
    Ok(quote! {
        #[allow(dead_code, reason = "not every enum needs every conversion")]
        impl #name {
            /// All variants in the order of their codes.
            pub const ALL: &'static [Self] = &[ #( Self::#variants, )* ];
            /// Name, text and meaning of each variant.
            pub const ENUM: &'static ::rcs_core::plain::EnumSchema = &::rcs_core::plain::EnumSchema {
                name: #text,
                variants: &[ #( ::rcs_core::plain::VariantSchema {
                    code: #codes,
                    name: #idents,
                    text: #texts,
                    doc: #docs,
                }, )* ],
            };

            /// The text in logs and on screens.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self { #( Self::#variants => #texts, )* }
            }

            /// The code in a byte image.
            #[must_use]
            pub const fn code(self) -> u8 {
                match self { #( Self::#variants => #codes, )* }
            }

            /// The variant with a code.
            #[must_use]
            pub fn from_code(code: u8) -> Option<Self> {
                Self::ALL.get(usize::from(code)).copied()
            }

            /// The variant with a text.
            #[must_use]
            pub fn from_text(text: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|variant| variant.text() == text)
            }
        }

        impl ::core::fmt::Display for #name {
            fn fmt(&self, f: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                f.pad(self.text())
            }
        }

        impl ::rcs_core::Plain for #name {
            const SCHEMA: ::rcs_core::plain::Schema = ::rcs_core::plain::Schema::Enum(Self::ENUM);
            const ZERO: Self = Self::#first;

            fn encode(&self, w: &mut ::rcs_core::plain::Writer<'_>) {
                ::rcs_core::Plain::encode(&self.code(), w);
            }

            fn decode(r: &mut ::rcs_core::plain::Reader<'_>) -> Result<Self, ::rcs_core::plain::DecodeError> {
                let found = <u8 as ::rcs_core::Plain>::decode(r)?;
                Self::from_code(found).ok_or(::rcs_core::plain::DecodeError::BadCode { of: #text, found })
            }
        }
    })
}

fn payload(variant: &Variant) -> Result<Option<&Field>> {
    match &variant.fields {
        Fields::Unit => Ok(None),
        Fields::Unnamed(fields) if fields.unnamed.len() == 1 => Ok(fields.unnamed.first()),
        other => Err(Error::new_spanned(
            other,
            "a variant of plain data is bare or carries one value: `Name(Type)`",
        )),
    }
}

fn of_union(name: &Ident, data: &DataEnum) -> Result<TokenStream> {
    let text = name.to_string();
    let (mut schemas, mut encode, mut decode, mut zero) = (Vec::new(), Vec::new(), Vec::new(), None);
    for (variant, code) in data.variants.iter().zip(0_u8..=u8::MAX) {
        let (ident, label) = (&variant.ident, text_of(variant));
        let word = names::identifier(&label, &code);
        let (schema, pattern, size, written, read) = match payload(variant)? {
            None => (quote!(None), quote!(Self::#ident), quote!(0), quote!(), quote!(Self::#ident)),
            Some(Field { ty, .. }) => (
                quote!(Some(<#ty as ::rcs_core::Plain>::SCHEMA)),
                quote!(Self::#ident(value)),
                quote!(<#ty as ::rcs_core::Plain>::SIZE),
                quote!(::rcs_core::Plain::encode(value, w);),
                quote!(Self::#ident(<#ty as ::rcs_core::Plain>::decode(r)?)),
            ),
        };
        zero.get_or_insert_with(|| match &variant.fields {
            Fields::Unnamed(fields) => {
                let types = fields.unnamed.iter().map(|field| &field.ty);
                quote!(Self::#ident( #( <#types as ::rcs_core::Plain>::ZERO )* ))
            }
            _ => quote!(Self::#ident),
        });
        schemas.push(quote! {
            ::rcs_core::plain::UnionVariant { code: #code, text: #label, name: #word, payload: #schema }
        });
        encode.push(quote! {
            #pattern => {
                w.put(&[#code]);
                #written
                w.zeros(const { Self::UNION.payload_size().saturating_sub(#size) });
            }
        });
        decode.push(quote! {
            #code => {
                let value = #read;
                r.zeros(const { Self::UNION.payload_size().saturating_sub(#size) })?;
                Ok(value)
            }
        });
    }
    Ok(quote! {
        impl #name {
            /// The variants of the byte image.
            pub const UNION: &'static ::rcs_core::plain::UnionSchema =
                &::rcs_core::plain::UnionSchema::new(#text, &[ #( #schemas, )* ]);
        }

        impl ::rcs_core::Plain for #name {
            const SCHEMA: ::rcs_core::plain::Schema = ::rcs_core::plain::Schema::Union(Self::UNION);
            const ZERO: Self = #zero;

            fn encode(&self, w: &mut ::rcs_core::plain::Writer<'_>) {
                match self { #( #encode )* }
            }

            fn decode(r: &mut ::rcs_core::plain::Reader<'_>) -> Result<Self, ::rcs_core::plain::DecodeError> {
                match <u8 as ::rcs_core::Plain>::decode(r)? {
                    #( #decode )*
                    found => Err(::rcs_core::plain::DecodeError::BadCode { of: #text, found }),
                }
            }
        }
    })
}
