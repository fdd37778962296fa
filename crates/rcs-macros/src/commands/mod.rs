//! `commands!`.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};
use syn::{
    Attribute, Error, Ident, Path, Result, Token, Visibility, braced,
    ext::IdentExt as _,
    parenthesized,
    parse::{Parse, ParseStream},
    parse2,
    punctuated::Punctuated,
};

mod order;

use self::order::Order;
use crate::names;

pub struct Commands {
    attributes: Vec<Attribute>,
    vis: Visibility,
    decide: Ident,
    /// The steps of all commands form a new enum with a variant per table.
    declared: bool,
    step: Ident,
    verb: Path,
    situation: Path,
    /// Given if the situation is a new enum with a variant per entry.
    senses: Option<Path>,
    action: Path,
    others: Vec<Path>, // selected by no command, in the order of their numbers
    order: Option<Order>,
    entries: Vec<Entry>,
}

/// The tables are consulted in turn until one decides.
struct Entry {
    verbs: Vec<Ident>,
    goal: Path,
    chain: Vec<Path>,
}

mod word {
    syn::custom_keyword!(of);
    syn::custom_keyword!(others);
    syn::custom_keyword!(then);
}

impl Parse for Commands {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let attributes = input.call(Attribute::parse_outer)?;
        let vis = input.parse()?;
        input.parse::<Token![fn]>()?;
        let decide = input.parse()?;
        let parameters;
        parenthesized!(parameters in input);
        let verb = parameters.call(Path::parse_mod_style)?;
        parameters.parse::<Token![,]>()?;
        let declared = parameters.parse::<Option<Token![enum]>>()?.is_some();
        let step = parameters.parse()?;
        parameters.parse::<Token![,]>()?;
        let is_new = parameters.parse::<Option<Token![enum]>>()?.is_some();
        let situation = parameters.call(Path::parse_mod_style)?;
        let senses = if is_new {
            parameters.parse::<word::of>()?;
            Some(parameters.call(Path::parse_mod_style)?)
        } else {
            None
        };
        input.parse::<Token![->]>()?;
        let action = input.call(Path::parse_mod_style)?;
        let body;
        braced!(body in input);
        let mut others = Vec::new();
        if body.parse::<Option<word::others>>()?.is_some() {
            body.parse::<Token![:]>()?;
            others =
                Punctuated::<Path, Token![,]>::parse_separated_nonempty_with(&body, Path::parse_mod_style)?
                    .into_iter()
                    .collect();
            body.parse::<Token![;]>()?;
        }
        let order = Order::parse(&body)?;
        let mut entries = Vec::new();
        while !body.is_empty() {
            entries.push(body.parse()?);
        }
        Ok(Self {
            attributes,
            vis,
            decide,
            declared,
            step,
            verb,
            situation,
            senses,
            action,
            others,
            order,
            entries,
        })
    }
}

impl Parse for Entry {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let verbs = Punctuated::<Ident, Token![|]>::parse_separated_nonempty(input)?.into_iter().collect();
        if !input.peek(Token![:]) {
            return Err(
                input.error("`: GOAL` is expected: each command declares its goal (docs/design/tables.md)")
            );
        }
        input.parse::<Token![:]>()?;
        let goal = input.call(Path::parse_mod_style)?;
        input.parse::<Token![=>]>()?;
        let mut chain = vec![input.call(Path::parse_mod_style)?];
        while input.parse::<Option<word::then>>()?.is_some() {
            chain.push(input.call(Path::parse_mod_style)?);
        }
        input.parse::<Token![;]>()?;
        Ok(Self { verbs, goal, chain })
    }
}

impl Entry {
    /// The last table of the chain, whose steps are those of the command.
    fn last(&self) -> &Path {
        self.chain.last().unwrap_or_else(|| unreachable!("a chain is not empty"))
    }

    fn variant(&self) -> &Ident {
        self.verbs.last().unwrap_or_else(|| unreachable!("an entry has a command"))
    }
}

/// The path with another last name; `r#move` decides for a table MOVE.
fn beside(path: &Path, name: impl FnOnce(&str) -> String) -> Path {
    let mut path = path.clone();
    if let Some(last) = path.segments.last_mut() {
        last.ident = Ident::new(&name(&last.ident.unraw().to_string()), last.ident.span());
    }
    path
}

fn camel(table: &Path) -> Ident {
    let last = table.segments.last();
    last.map_or_else(
        || format_ident!("_"),
        |last| Ident::new(&names::camel(&last.ident.unraw().to_string()), last.ident.span()),
    )
}

fn static_of(table: &Path) -> Path {
    beside(table, str::to_uppercase)
}

fn step_of(table: &Path) -> Path {
    beside(table, |name| format!("{}Step", names::camel(name)))
}

fn same(a: &Path, b: &Path) -> bool {
    quote!(#a).to_string() == quote!(#b).to_string()
}

fn situation_of(table: &Path) -> Path {
    beside(table, |name| format!("{}Situation", names::camel(name)))
}

/// The paths without duplicates, in the order of their first occurrence.
fn once(paths: impl Iterator<Item = Path>) -> Vec<Path> {
    let mut all = Vec::new();
    for path in paths {
        if !all.iter().any(|other| same(other, &path)) {
            all.push(path);
        }
    }
    all
}

impl Commands {
    /// All tables in the order of their numbers.
    fn tables(&self) -> Vec<Path> {
        let tables = self.entries.iter().flat_map(|entry| &entry.chain).map(static_of);
        once(self.others.iter().cloned().chain(tables))
    }

    fn other(&self, name: &Ident) -> Result<&Path> {
        let is_it = |path: &&Path| path.segments.last().is_some_and(|last| last.ident == *name);
        self.others
            .iter()
            .find(is_it)
            .ok_or_else(|| Error::new(name.span(), format!("{name} is not in the list `others`")))
    }

    fn steps(&self) -> TokenStream {
        if !self.declared {
            return TokenStream::new();
        }
        let (vis, name, verb) = (&self.vis, &self.step, &self.verb);
        let firsts = self.entries.iter().map(|entry| {
            let (verbs, last) = (&entry.verbs, entry.last());
            let (variant, of) = (camel(last), step_of(last));
            quote!(#( #verb::#verbs )|* => Self::#variant(<#of as ::rcs_core::Plain>::ZERO))
        });
        let tables = once(self.entries.iter().map(|entry| entry.last().clone()));
        let (mut variants, mut texts) = (Vec::new(), Vec::new());
        for table in &tables {
            let (variant, of) = (camel(table), step_of(table));
            let doc = format!("Step of [`{}`].", quote!(#table).to_string().replace(' ', ""));
            variants.push(quote!(#[doc = #doc] #variant(#of)));
            texts.push(quote!(Self::#variant(step) => step.text()));
        }
        quote! {
            /// Step of the current command: the reference action of its table (V.1.1).
            #[derive(Clone, Copy, Debug, PartialEq, Eq, ::rcs_core::Plain)]
            #vis enum #name { #( #variants, )* }

            impl #name {
                /// The text in logs and on screens.
                #[must_use]
                pub const fn text(self) -> &'static str {
                    match self { #( #texts, )* }
                }

                /// The step in which a command begins.
                #[must_use]
                pub const fn first(verb: #verb) -> Self {
                    match verb { #( #firsts, )* }
                }
            }
        }
    }

    fn situations(&self) -> TokenStream {
        let Some(senses) = &self.senses else { return TokenStream::new() };
        let (vis, name, verb) = (&self.vis, &self.situation, &self.verb);
        let (mut variants, mut passes, mut sensed) = (Vec::new(), Vec::new(), Vec::new());
        for entry in &self.entries {
            let (variant, verbs) = (entry.variant(), &entry.verbs);
            let of: Vec<_> = entry.chain.iter().map(situation_of).collect();
            let tables: Vec<_> = (0..of.len()).map(|at| format_ident!("table_{at}")).collect();
            sensed.push(quote!(#( #verb::#verbs )|* => Self::#variant(#( #of::sense(senses), )*)));
            let texts = of.iter().map(|of| quote!(#of).to_string().replace(' ', ""));
            let links: Vec<_> = texts.map(|of| format!("[`{of}`]")).collect();
            let doc = format!("Of {}.", links.join(", "));
            variants.push(quote!(#[doc = #doc] #variant(#( #of, )*)));
            passes.push(quote!(Self::#variant(#( #tables, )*) => { #( #tables.pass(passed); )* }));
        }
        let passed = beside(senses, |name| format!("__{name}"));
        quote! {
            /// The state variables of a command: those that its tables test.
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            #vis enum #name { #( #variants, )* }

            impl #name {
                /// Sense what the tables of a command test.
                #[must_use]
                #vis fn sense(verb: #verb, senses: &#senses<'_>) -> Self {
                    match verb { #( #sensed, )* }
                }

                /// Note what a table above those of the command has passed on.
                #vis const fn pass(&mut self, passed: #passed::Passed) {
                    match self { #( #passes, )* }
                }
            }
        }
    }

    fn of_command(&self, tables: &[Path]) -> TokenStream {
        let Self { attributes, vis, decide, step, verb, situation, action, .. } = self;
        let (selector, parameters) = if self.senses.is_some() {
            (quote!(situation), quote!(step: #step, situation: &#situation))
        } else {
            (quote!(verb), quote!(verb: #verb, step: #step, situation: &#situation))
        };
        let arms = self.entries.iter().map(|entry| self.arm(entry, tables));
        quote! {
            #( #attributes )*
            #[must_use]
            #vis fn #decide(#parameters) -> ::rcs_core::table::Choice<#action, #step> {
                match #selector { #( #arms, )* }
            }
        }
    }

    fn goals(&self) -> TokenStream {
        let (vis, verb) = (&self.vis, &self.verb);
        let arms =
            self.entries.iter().map(|Entry { verbs, goal, .. }| quote!(#( #verb::#verbs )|* => &#goal));
        let declared = self.entries.iter().flat_map(|Entry { verbs, goal, .. }| {
            verbs
                .iter()
                .map(move |name| quote!(crate::goal::Declared { command: #verb::#name.text(), goal: &#goal }))
        });
        quote! {
            /// The goals of all commands, in the order of their tables.
            #vis const GOALS: &[crate::goal::Declared] = &[ #( #declared, )* ];

            /// The goal of a command.
            #[must_use]
            #vis const fn goal(verb: #verb) -> &'static crate::goal::Goal {
                match verb { #( #arms, )* }
            }
        }
    }

    fn arm(&self, entry: &Entry, tables: &[Path]) -> TokenStream {
        let (verb, all) = (&self.verb, &self.step);
        let last = entry.last();
        let situations: Vec<Ident> = match &self.senses {
            Some(_) => (0..entry.chain.len()).map(|at| format_ident!("table_{at}")).collect(),
            None => vec![format_ident!("situation"); entry.chain.len()],
        };
        let variant = camel(last);
        let number = |table: &Path| {
            let position = tables.iter().position(|other| same(other, &static_of(table)));
            Literal::u8_suffixed(
                position.and_then(|at| u8::try_from(at).ok()).map_or(0, |at| at.saturating_add(1)),
            )
        };
        let choice = |table: &Path| {
            let number = number(table);
            let next =
                if self.declared { quote!(#all::#variant(decision.next)) } else { quote!(decision.next) };
            quote! {
                ::rcs_core::table::Choice {
                    table: #number, row: decision.row, action: decision.action, next: #next, values: decision.values,
                }
            }
        };
        let decided = choice(last);
        let mut below = entry.chain.iter().zip(&situations).rev();
        let situation = below.next().map(|(_, situation)| situation);
        let mut body = quote! { let decision = #last(step, #situation); #decided };
        for (table, situation) in below {
            let decided = choice(table);
            body = quote! {
                match #table(step, #situation) {
                    ::rcs_core::table::Verdict::Decided(decision) => #decided,
                    ::rcs_core::table::Verdict::Passed(()) => { #body }
                }
            };
        }
        if self.declared {
            let of = step_of(last);
            body = quote! {
                let step = match step {
                    #all::#variant(step) => step,
                    #[allow(unreachable_patterns, reason = "a process may have a single table")]
                    _ => <#of as ::rcs_core::Plain>::ZERO,
                };
                #body
            };
        }
        if self.senses.is_some() {
            let (of, variant) = (&self.situation, entry.variant());
            quote!(#of::#variant(#( #situations, )*) => { #body })
        } else {
            let verbs = entry.verbs.iter().map(|name| quote!(#verb::#name));
            quote!(#( #verbs )|* => { #body })
        }
    }
}

/// Generates steps, goals and tables of the commands, and the functions that consult the tables.
pub fn expand(input: TokenStream) -> Result<TokenStream> {
    let commands: Commands = parse2(input)?;
    let Commands { vis, others, .. } = &commands;
    let (tables, steps, goals) = (commands.tables(), commands.steps(), commands.goals());
    let (situations, of_command) = (commands.situations(), commands.of_command(&tables));
    let numbers = others.iter().zip(1_u8..).map(|(table, number)| {
        let (name, number) = (table.segments.last().map(|last| &last.ident), Literal::u8_suffixed(number));
        let doc =
            format!("Of [`{}`](super::{}).", quote!(#name), quote!(#table).to_string().replace(' ', ""));
        quote!(#[doc = #doc] pub const #name: u8 = #number;)
    });
    let order = commands.order.as_ref().map(|order| order.expand(&commands)).transpose()?;
    Ok(quote! {
        #steps

        #goals

        /// All decision tables; the header of the outputs names one by its position from 1.
        #vis const TABLES: &[&::rcs_core::table::Table] = &[ #( &#tables, )* ];

        /// Numbers of the tables that no command selects.
        #vis mod number { #( #numbers )* }

        #situations

        #of_command

        #order
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn situation_of_a_command_has_the_variables_of_its_tables() {
        let list = "
            fn of_command(Verb, enum Step, enum Situation of Senses) -> Action {
                Pause: goals::REST => pause::pause;
                Go: goals::PLACE => go::go then motion::motion;
                Come | Return: goals::PLACE => go::go then arm::arm;
            }";
        let code = expand(list.parse().expect("tokens")).expect("the list is right").to_string();
        for text in [
            "Pause (pause :: PauseSituation ,)",
            "Go (go :: GoSituation , motion :: MotionSituation ,)",
            "Return (go :: GoSituation , arm :: ArmSituation ,)",
            "Verb :: Come | Verb :: Return => Self :: Return (go :: GoSituation :: sense (senses) , arm",
            "Self :: Go (table_0 , table_1 ,) => { table_0 . pass (passed) ; table_1 . pass (passed) ; }",
            "match situation { Situation :: Pause (table_0 ,) =>",
            "match go :: go (step , table_0)",
        ] {
            assert!(code.contains(text), "{text} in {code}");
        }
        assert_eq!(
            code.matches("Situation :: Go (table_0 , table_1 ,) => {").count(),
            1,
            "one arm for two commands"
        );
    }
}
