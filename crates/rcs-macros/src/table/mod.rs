//! `decision_table!`: from the form to a `match`, an enum of steps, and text.

mod form;

use proc_macro2::{Delimiter, Group, Span, TokenStream, TokenTree};
use quote::{quote, quote_spanned};
use syn::{Ident, Path, Result, parse2};

use self::form::{Condition, Passed, Row, Step, StepGroup, Table};
use crate::{names, variables};

impl Table {
    fn step_type(&self, span: Span) -> TokenStream {
        match &self.step {
            Some(Step::Declared(name)) => respan(quote!(#name), span),
            Some(Step::Named(path)) => respan(quote!(#path), span),
            None => TokenStream::new(),
        }
    }

    /// The brackets have the span of the row's number, where the compiler underlines a dead row.
    fn pattern(&self, group: &StepGroup, row: &Row) -> TokenStream {
        let span = row.number.span();
        let situation = respan_path(&self.situation, span);
        let conditions = row.conditions.iter().map(|Condition { variable, values }| {
            let values = values.iter().map(|value| {
                let types = hidden(&self.situation, value.span());
                let field = variable;
                quote_spanned!(value.span()=> #types::#field::#value)
            });
            quote!(#variable: #( #values )|*)
        });
        let variables = quote_spanned!(span=> #situation { #( #conditions, )* .. });
        let steps = group.steps.iter().map(|step| {
            let of = self.step_type(step.span());
            quote_spanned!(step.span()=> #of::#step)
        });
        let content =
            if group.steps.is_empty() { quote!(_, #variables) } else { quote!(#( #steps )|*, #variables) };
        let mut pattern = Group::new(Delimiter::Parenthesis, content);
        pattern.set_span(span);
        TokenTree::Group(pattern).into()
    }

    fn arm(&self, group: &StepGroup, row: &Row) -> TokenStream {
        let (pattern, number) = (self.pattern(group, row), &row.number);
        if row.is_passed() {
            let value = match (&self.passed, &row.argument) {
                (Some(Passed::Value(of)), Some(value)) => {
                    let of = respan_path(of, value.span());
                    quote_spanned!(value.span()=> #of::#value)
                }
                _ => quote!(()),
            };
            return quote!(#pattern => return ::rcs_core::table::Verdict::Passed(#value),);
        }
        let (name, action) = (&row.action, respan_path(&self.action, row.action.span()));
        let argument = row.argument.as_ref().map(|argument| {
            let types = hidden(&self.action, argument.span());
            let field = Ident::new(&name.to_string(), argument.span());
            quote_spanned!(argument.span()=> (#types::#field::#argument))
        });
        let next = row.next.as_ref().map_or_else(
            || quote!(step),
            |next| {
                let of = self.step_type(next.span());
                quote_spanned!(next.span()=> #of::#next)
            },
        );
        quote!(#pattern => (#number, #action::#name #argument, #next),)
    }

    /// A variant per step whose group has a doc comment.
    fn steps(&self) -> TokenStream {
        let Some(Step::Declared(name)) = &self.step else { return TokenStream::new() };
        let declared = self.groups.iter().filter(|group| !group.attributes.is_empty());
        let variants =
            declared.map(|StepGroup { attributes, steps, .. }| quote!(#( #attributes )* #( #steps )*));
        let (vis, doc) = (&self.vis, format!("Steps of {}: its reference action (V.1.1).", self.title()));
        quote! {
            #[doc = #doc]
            #[derive(Clone, Copy, Debug, PartialEq, Eq, ::rcs_core::Plain)]
            #vis enum #name { #( #variants, )* }
        }
    }

    /// The variables that the rows name, without duplicates.
    fn asked(&self) -> Vec<&Ident> {
        let mut asked: Vec<&Ident> = Vec::new();
        for Condition { variable, .. } in self.rows().flat_map(|(_, row)| &row.conditions) {
            if !asked.contains(&variable) {
                asked.push(variable);
            }
        }
        asked
    }

    fn situation(&self) -> TokenStream {
        let (Some(senses), Some(name)) = (&self.senses, self.situation.get_ident()) else {
            return TokenStream::new();
        };
        let (vis, asked) = (&self.vis, self.asked());
        let of = hidden(senses, name.span());
        let types: Vec<_> = asked.iter().map(|variable| quote!(#of::#variable)).collect();
        let docs = asked.iter().map(|variable| format!("`{variable}`"));
        let (doc, code) =
            (format!("State variables of {}.", self.title()), variables::code(name, &asked, &types));
        let beside = hidden(&self.situation, name.span());
        quote! {
            #[doc = #doc]
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            #vis struct #name { #( #[doc = #docs] pub #asked: #types, )* }

            impl #name {
                /// Name, meaning and values of each variable.
                pub const VARIABLES: &'static [::rcs_core::table::Variable] = &[ #( #types, )* ];

                /// Sense each variable.
                #[must_use]
                #vis fn sense(senses: &#senses<'_>) -> Self {
                    Self { #( #asked: senses.#asked(), )* }
                }

                /// Note what a table above has passed on.
                #vis const fn pass(&mut self, passed: #of::Passed) {
                    #( #of::pass::#asked(&mut self.#asked, passed); )*
                }
            }

            #code

            #[doc(hidden)]
            #[allow(non_snake_case, reason = "the types under the names of the variables")]
            #vis mod #beside {
                pub use super::#of::{ #( #asked, )* };
            }
        }
    }

    /// The name in the manual's spelling: `GET_OBJECT` is `GET-OBJECT`.
    fn title(&self) -> String {
        self.name.to_string().replace('_', "-")
    }

    fn texts(&self) -> Vec<TokenStream> {
        let texts = self.rows().map(|(group, row)| {
            let steps = group.steps.iter().map(ToString::to_string);
            let conditions = row.conditions.iter().map(|Condition { variable, values }| {
                let (variable, values) = (variable.to_string(), values.iter().map(ToString::to_string));
                quote!(::rcs_core::table::Condition { variable: #variable, values: &[ #( #values, )* ] })
            });
            let (number, action) = (&row.number, row.action.to_string());
            let option = |name: &Option<Ident>| match name.as_ref().map(ToString::to_string) {
                Some(text) => quote!(Some(#text)),
                None => quote!(None),
            };
            let (argument, next) = (option(&row.argument), option(&row.next));
            quote! {
                ::rcs_core::table::Row {
                    number: #number,
                    steps: &[ #( #steps, )* ],
                    when: &[ #( #conditions, )* ],
                    action: #action,
                    argument: #argument,
                    next: #next,
                }
            }
        });
        texts.collect()
    }

    fn documentation(&self) -> String {
        let names = |names: &[Ident]| names.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or ");
        let mut text =
            String::from("\n\n| row | step | when | action | next step |\n|---:|---|---|---|---|\n");
        for (group, row) in self.rows() {
            let step = if group.steps.is_empty() { "any".to_owned() } else { names(&group.steps) };
            let conditions: Vec<_> =
                row.conditions.iter().map(|c| format!("{}: {}", c.variable, names(&c.values))).collect();
            let argument = row.argument.as_ref().map(|argument| format!("({argument})")).unwrap_or_default();
            let next = row.next.as_ref().map(ToString::to_string).unwrap_or_default();
            let (number, action) = (&row.number, &row.action);
            let conditions =
                if conditions.is_empty() { "otherwise".to_owned() } else { conditions.join(", ") };
            text += &format!("| {number} | {step} | {conditions} | {action}{argument} | {next} |\n");
        }
        text
    }
}

fn respan(tokens: TokenStream, span: Span) -> TokenStream {
    let moved = tokens.into_iter().map(|mut token| {
        token.set_span(span);
        token
    });
    moved.collect()
}

fn respan_path(path: &Path, span: Span) -> TokenStream {
    respan(quote!(#path), span)
}

/// A hidden module, in which the name of a field or action denotes its type.
fn hidden(of: &Path, span: Span) -> TokenStream {
    let mut path = of.clone();
    if let Some(last) = path.segments.last_mut() {
        last.ident = Ident::new(&format!("__{}", last.ident), span);
    }
    respan_path(&path, span)
}

pub fn expand(input: TokenStream) -> Result<TokenStream> {
    let table: Table = parse2(input)?;
    let Table { attributes, vis, name, decide, situation, action, .. } = &table;
    let title = table.title();
    let doc = names::doc(attributes);
    let (documentation, texts, steps) = (table.documentation(), table.texts(), table.steps());
    let declared = table.situation();
    let step_docs = match &table.step {
        Some(Step::Declared(step)) => quote!(Some(#step::ENUM)),
        Some(Step::Named(step)) => quote!(Some(#step::ENUM)),
        None => quote!(None),
    };
    let arms = table.rows().map(|(group, row)| table.arm(group, row));
    let (generic, step) = match &table.step {
        Some(Step::Declared(step)) => (quote!(), quote!(#step)),
        Some(Step::Named(step)) => (quote!(), quote!(#step)),
        None => (quote!(<Step: Copy>), quote!(Step)),
    };
    let code = if table.step.is_some() { quote!(step.code()) } else { quote!(0) };
    let decision = quote! {
        ::rcs_core::table::Decision {
            row,
            action,
            next,
            values: ::rcs_core::table::Values {
                step: #code,
                variables: ::rcs_core::table::Variables::code(situation),
            },
        }
    };
    let verdict = quote!(::rcs_core::table::Verdict::Decided(#decision));
    let (result, decided) = match &table.passed {
        None => (quote!(::rcs_core::table::Decision<#action, #step>), decision),
        Some(Passed::Nothing) => (quote!(::rcs_core::table::Verdict<#action, #step, ()>), verdict),
        Some(Passed::Value(of)) => (quote!(::rcs_core::table::Verdict<#action, #step, #of>), verdict),
    };
    let see = format!("Decide by [`{name}`].");
    Ok(quote! {
        #( #attributes )*
        #[doc = #documentation]
        #vis static #name: ::rcs_core::table::Table = ::rcs_core::table::Table {
            name: #title,
            doc: &[ #( #doc, )* ],
            variables: <#situation>::VARIABLES,
            actions: <#action>::ACTIONS,
            steps: #step_docs,
            rows: &[ #( #texts, )* ],
            file: file!(),
            line: line!(),
        };

        #steps

        #declared

        #[doc = #see]
        #[must_use]
        #vis fn #decide #generic (step: #step, situation: &#situation) -> #result {
            let (row, action, next): (u8, #action, #step) = match (step, *situation) { #( #arms )* };
            #decided
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The code block of a page that begins with `begin`.
    fn block(page: &str, begin: &str) -> TokenStream {
        let mut blocks = page.split("```rust\n").skip(1).filter_map(|rest| rest.split_once("```"));
        let (code, _) = blocks.find(|(code, _)| code.starts_with(begin)).expect("the page has the block");
        code.parse().expect("the block is code")
    }

    #[test]
    fn page_shows_the_expansion_of_its_table() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/design/tables.md");
        let page = std::fs::read_to_string(path).expect("the page can be read");
        let call = block(&page, "decision_table! {").into_iter().last();
        let Some(TokenTree::Group(table)) = call else { panic!("the table is between braces") };
        let expanded = expand(table.stream()).expect("the table is right").to_string();
        let shown = block(&page, "pub fn release(").to_string();
        // The compiler ignores a comma before the end.
        let plain = |code: &str| code.replace(", }", " }").replace(", )", " )");
        assert!(plain(&expanded).contains(&plain(&shown)), "{expanded}");
    }
}
