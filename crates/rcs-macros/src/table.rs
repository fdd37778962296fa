//! `decision_table!`.

use proc_macro2::{Delimiter, Group, Span, TokenStream, TokenTree};
use quote::{quote, quote_spanned};
use syn::{
    Attribute, Error, Ident, LitInt, Path, Result, Token, Visibility, braced, parenthesized,
    parse::{Parse, ParseStream},
    parse2,
    punctuated::Punctuated,
    spanned::Spanned as _,
    token,
};

use crate::names;

/// A table as written.
struct Table {
    attributes: Vec<Attribute>,
    vis: Visibility,
    name: Ident,
    decide: Ident,
    step: Option<Step>,
    situation: Path,
    action: Path,
    /// What a row that does not decide passes on.
    passed: Option<Passed>,
    groups: Vec<StepGroup>,
}

/// The type of the steps: declared by the groups of the table, or named.
enum Step {
    Declared(Ident),
    Named(Path),
}

enum Passed {
    Nothing,
    Value(Path),
}

/// Rows for some steps; for any if none is named.
struct StepGroup {
    attributes: Vec<Attribute>,
    steps: Vec<Ident>,
    rows: Vec<Row>,
}

struct Row {
    number: LitInt,
    conditions: Vec<Condition>,
    action: Ident,
    argument: Option<Ident>,
    next: Option<Ident>,
}

struct Condition {
    variable: Ident,
    values: Vec<Ident>,
}

mod word {
    syn::custom_keyword!(or);
    syn::custom_keyword!(any);
    syn::custom_keyword!(consult);
}

impl Parse for Table {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let attributes = input.call(Attribute::parse_outer)?;
        let vis = input.parse()?;
        let name = input.parse()?;
        input.parse::<Token![:]>()?;
        input.parse::<Token![fn]>()?;
        let decide = input.parse()?;
        let parameters;
        parenthesized!(parameters in input);
        let (step, situation) = head(&parameters)?;
        input.parse::<Token![->]>()?;
        let action = input.call(Path::parse_mod_style)?;
        let passed = if input.parse::<Option<word::or>>()?.is_none() {
            None
        } else if input.peek(token::Paren) {
            let nothing;
            parenthesized!(nothing in input);
            if !nothing.is_empty() {
                return Err(nothing.error("`()` or a type is expected"));
            }
            Some(Passed::Nothing)
        } else {
            Some(Passed::Value(input.call(Path::parse_mod_style)?))
        };
        let body;
        braced!(body in input);
        let mut groups = Vec::new();
        if step.is_some() {
            while !body.is_empty() {
                groups.push(body.parse()?);
            }
        } else {
            groups.push(StepGroup { attributes: Vec::new(), steps: Vec::new(), rows: rows(&body)? });
        }
        let table = Self { attributes, vis, name, decide, step, situation, action, passed, groups };
        table.check()?;
        Ok(table)
    }
}

/// `enum NewStep, Situation`, `OldStep, Situation` or `Situation`.
fn head(input: ParseStream<'_>) -> Result<(Option<Step>, Path)> {
    let step = if input.parse::<Option<Token![enum]>>()?.is_some() {
        Step::Declared(input.parse()?)
    } else {
        let first = input.call(Path::parse_mod_style)?;
        if input.is_empty() {
            return Ok((None, first));
        }
        Step::Named(first)
    };
    input.parse::<Token![,]>()?;
    let situation = input.call(Path::parse_mod_style)?;
    if input.is_empty() { Ok((Some(step), situation)) } else { Err(input.error("`)` is expected")) }
}

fn rows(input: ParseStream<'_>) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    while !input.is_empty() {
        rows.push(input.parse()?);
    }
    Ok(rows)
}

/// `A | B`.
fn alternatives(input: ParseStream<'_>) -> Result<Vec<Ident>> {
    Ok(Punctuated::<Ident, Token![|]>::parse_separated_nonempty(input)?.into_iter().collect())
}

impl Parse for StepGroup {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let attributes = input.call(Attribute::parse_outer)?;
        let steps =
            if input.parse::<Option<word::any>>()?.is_some() { Vec::new() } else { alternatives(input)? };
        let body;
        braced!(body in input);
        Ok(Self { attributes, steps, rows: rows(&body)? })
    }
}

impl Parse for Row {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let number = input.parse()?;
        input.parse::<Token![:]>()?;
        let mut conditions = Vec::new();
        while !input.peek(Token![=>]) {
            let variable = input.parse()?;
            input.parse::<Token![:]>()?;
            conditions.push(Condition { variable, values: alternatives(input)? });
            if !input.peek(Token![=>]) {
                input.parse::<Token![,]>()?;
            }
        }
        input.parse::<Token![=>]>()?;
        let action = input.parse()?;
        let argument = if input.peek(token::Paren) {
            let content;
            parenthesized!(content in input);
            let argument = content.parse()?;
            if !content.is_empty() {
                return Err(content.error("`)` is expected: an action has one argument"));
            }
            Some(argument)
        } else {
            None
        };
        let next = if input.parse::<Option<Token![->]>>()?.is_some() { Some(input.parse()?) } else { None };
        input.parse::<Token![;]>()?;
        Ok(Self { number, conditions, action, argument, next })
    }
}

impl Row {
    /// The row does not decide: the next table is consulted.
    fn is_passed(&self) -> bool {
        self.action == "consult"
    }
}

impl Table {
    fn rows(&self) -> impl Iterator<Item = (&StepGroup, &Row)> {
        self.groups.iter().flat_map(|group| group.rows.iter().map(move |row| (group, row)))
    }

    /// What the compiler would not say well.
    fn check(&self) -> Result<()> {
        for ((_, row), expected) in self.rows().zip(1_u8..) {
            if row.number.base10_parse::<u8>()? != expected {
                let found = &row.number;
                let text = format!("rows are numbered in order: {expected} is expected, {found} is found");
                return Err(Error::new(found.span(), text));
            }
            if row.is_passed() && self.passed.is_none() {
                let text = "this table has to decide: `consult` needs `-> Action or Type` in its head";
                return Err(Error::new(row.action.span(), text));
            }
            if row.is_passed() && row.next.is_some() {
                return Err(Error::new(row.next.span(), "the next table decides on the step"));
            }
            if row.next.is_some() && self.step.is_none() {
                return Err(Error::new(row.next.span(), "this table has no steps"));
            }
            let twice = row.conditions.iter().enumerate().find(|(at, condition)| {
                row.conditions.iter().take(*at).any(|other| other.variable == condition.variable)
            });
            if let Some((_, condition)) = twice {
                return Err(Error::new(condition.variable.span(), "the row asks for this variable already"));
            }
        }
        Ok(())
    }

    /// The type of the steps in a pattern or an expression, at `span`.
    fn step_type(&self, span: Span) -> TokenStream {
        match &self.step {
            Some(Step::Declared(name)) => respan(quote!(#name), span),
            Some(Step::Named(path)) => respan(quote!(#path), span),
            None => TokenStream::new(),
        }
    }

    /// The pattern of a row. Its brackets bear the span of the row's number, so that a dead row is underlined there.
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
            return quote!(#pattern => ::rcs_core::table::Verdict::Passed(#value),);
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
        let decision = quote! {
            ::rcs_core::table::Decision { row: #number, action: #action::#name #argument, next: #next }
        };
        match self.passed {
            None => quote!(#pattern => #decision,),
            Some(_) => quote!(#pattern => ::rcs_core::table::Verdict::Decided(#decision),),
        }
    }

    /// The enum of the steps, if the table declares it: a variant for each step whose group has a doc comment.
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

    /// The name as the manual would write it: `GET_OBJECT` is `GET-OBJECT`.
    fn title(&self) -> String {
        self.name.to_string().replace('_', "-")
    }

    /// The rows as text.
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

    /// The rows as a table of the documentation.
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
            let (number, conditions, action) = (&row.number, conditions.join(", "), &row.action);
            text += &format!("| {number} | {step} | {conditions} | {action}{argument} | {next} |\n");
        }
        text
    }
}

/// The same tokens at another place of the source.
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

/// The hidden module beside a type, in which each field or action is the name of its type.
fn hidden(of: &Path, span: Span) -> TokenStream {
    let mut path = of.clone();
    if let Some(last) = path.segments.last_mut() {
        last.ident = Ident::new(&format!("__{}", last.ident), span);
    }
    respan_path(&path, span)
}

/// The table as text, the enum of its steps, and the function that decides.
pub fn expand(input: TokenStream) -> Result<TokenStream> {
    let table: Table = parse2(input)?;
    let Table { attributes, vis, name, decide, situation, action, .. } = &table;
    let title = table.title();
    let doc = names::doc(attributes);
    let (documentation, texts, steps) = (table.documentation(), table.texts(), table.steps());
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
    let result = match &table.passed {
        None => quote!(::rcs_core::table::Decision<#action, #step>),
        Some(Passed::Nothing) => quote!(::rcs_core::table::Verdict<#action, #step, ()>),
        Some(Passed::Value(of)) => quote!(::rcs_core::table::Verdict<#action, #step, #of>),
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

        #[doc = #see]
        #[must_use]
        #vis fn #decide #generic (step: #step, situation: &#situation) -> #result {
            match (step, *situation) { #( #arms )* }
        }
    })
}
