use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};
use syn::{
    Error, Ident, Path, Result, Token, parenthesized,
    parse::{Parse, ParseStream},
    punctuated::Punctuated,
};

use super::{Commands, beside};

mod word {
    syn::custom_keyword!(before);
    syn::custom_keyword!(after);
    syn::custom_keyword!(by);
}

/// `before: EXECUTE, HALT, ACCEPT(request), ORDERED(subordinates -> situation.work); after: EFFECT, CONFIRM;`
pub struct Order {
    before: Vec<Before>, // before that of the command
    after: Vec<After>,   // about the row that fired
}

struct Before {
    table: Ident,
    how: How,
}

/// `CONFIRM`, `EFFECT`, or `EFFECT(advance)`: about the row that fired.
struct After {
    table: Ident,
    /// In `StateVariables`: true if the command has advanced since its last order.
    advance: Option<Ident>,
}

enum How {
    Common,    // in all processes, consulted by `Execution`
    By(Ident), // `JOYSTICK by joystick`: a method of the state
    /// `ORDERED(subordinates -> situation.work)`: a row decides with this field, or passes a value on.
    Row(Row),
}

struct Row {
    variables: Ident,       // in `StateVariables`
    step: Option<Ident>,    // `in link`: the field of the state with its step
    passes: Option<Passes>, // receives the passed value
}

/// `-> situation.work`, or `-> situation` if each table has its own struct.
struct Passes {
    of: Ident,
    field: Option<Ident>,
}

impl Parse for Before {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let table = input.parse()?;
        if input.parse::<Option<word::by>>()?.is_some() {
            return Ok(Self { table, how: How::By(input.parse()?) });
        }
        if !input.peek(syn::token::Paren) {
            return Ok(Self { table, how: How::Common });
        }
        let field;
        parenthesized!(field in input);
        let variables = field.parse()?;
        let step = if field.parse::<Option<Token![in]>>()?.is_some() { Some(field.parse()?) } else { None };
        let passes = if field.parse::<Option<Token![->]>>()?.is_some() {
            let of = field.parse()?;
            let is_named = field.parse::<Option<Token![.]>>()?.is_some();
            Some(Passes { of, field: if is_named { Some(field.parse()?) } else { None } })
        } else {
            None
        };
        Ok(Self { table, how: How::Row(Row { variables, step, passes }) })
    }
}

impl Parse for After {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let table: Ident = input.parse()?;
        let advance = if table == "EFFECT" && input.peek(syn::token::Paren) {
            let field;
            parenthesized!(field in input);
            Some(field.parse()?)
        } else {
            None
        };
        Ok(Self { table, advance })
    }
}

impl Order {
    pub fn parse(input: ParseStream<'_>) -> Result<Option<Self>> {
        if input.parse::<Option<word::before>>()?.is_none() {
            return Ok(None);
        }
        input.parse::<Token![:]>()?;
        let before: Vec<Before> =
            Punctuated::<Before, Token![,]>::parse_separated_nonempty(input)?.into_iter().collect();
        input.parse::<Token![;]>()?;
        let after = if input.parse::<Option<word::after>>()?.is_some() {
            input.parse::<Token![:]>()?;
            let after = Punctuated::<After, Token![,]>::parse_separated_nonempty(input)?;
            input.parse::<Token![;]>()?;
            after.into_iter().collect()
        } else {
            Vec::new()
        };
        let order = Self { before, after };
        order.check()?;
        Ok(Some(order))
    }

    /// EXECUTE is first; tables that can withhold the command precede the others.
    fn check(&self) -> Result<()> {
        let mut rows = false;
        for (position, Before { table, how }) in self.before.iter().enumerate() {
            let is_first = *table == "EXECUTE" && matches!(how, How::Common);
            if (position == 0) != is_first {
                return Err(Error::new(table.span(), "EXECUTE is consulted first, and once"));
            }
            match how {
                How::Row(_) => rows = true,
                How::Common if !is_first && *table != "HALT" => {
                    let text = "`(FIELD)` or `by METHOD` is expected: only EXECUTE and HALT need neither";
                    return Err(Error::new(table.span(), text));
                }
                How::Common | How::By(_) if rows => {
                    let text =
                        "a table that can withhold the command is consulted before those with rows about it";
                    return Err(Error::new(table.span(), text));
                }
                How::Common | How::By(_) => {}
            }
        }
        match self.after.iter().find(|After { table, .. }| table != "EFFECT" && table != "CONFIRM") {
            Some(After { table, .. }) => {
                Err(Error::new(table.span(), "only EFFECT and CONFIRM are consulted after a row"))
            }
            None => Ok(()),
        }
    }

    fn documentation(&self, commands: &Commands) -> Result<Vec<String>> {
        let mut lines = vec![
            String::from("Consult the tables in the declared order until a row decides:"),
            String::new(),
        ];
        let link = |table: &Ident| -> Result<String> {
            let path = commands.other(table)?;
            Ok(format!("[`{table}`]({})", quote!(#path).to_string().replace(' ', "")))
        };
        for Before { table, how } in &self.before {
            let what = match how {
                How::Common if *table == "EXECUTE" => String::from("is there a command to execute?"),
                How::Common => String::from("have the processes below come to rest?"),
                How::By(method) => format!("consulted by `State::{method}`"),
                How::Row(Row { variables, step, passes }) => {
                    let mut text = format!("about `{variables}`");
                    if let Some(step) = step {
                        text += &format!(", with the step `{step}` of its own");
                    }
                    if let Some(Passes { of, field }) = passes {
                        let field = field.as_ref().map(|field| format!(".{field}")).unwrap_or_default();
                        text += &format!("; it passes `{of}{field}` on");
                    }
                    text
                }
            };
            lines.push(format!("1. {}: {what}", link(table)?));
        }
        lines.push(String::from("1. the table of the command, about `situation`"));
        for After { table, .. } in &self.after {
            let what =
                if *table == "EFFECT" { "a row that gives an order" } else { "a row that reports done" };
            lines.push(format!("1. {}: about {what}", link(table)?));
        }
        Ok(lines)
    }

    pub fn expand(&self, commands: &Commands) -> Result<TokenStream> {
        let Commands { vis, decide: of_command, step, action, .. } = commands;
        let documentation = self.documentation(commands)?;
        let (mut gates, mut rows) = (Vec::new(), Vec::new());
        for Before { table, how } in &self.before {
            let path = commands.other(table)?;
            match how {
                How::Common if *table == "EXECUTE" => {}
                How::Common => gates.push(quote! {
                    let course = match state.execution.halt(number::#table, course, &seen.replaced) {
                        Ok(course) => course,
                        Err(halting) => return <#action as crate::halt::Stopping>::of_halt(halting),
                    };
                }),
                How::By(method) => gates.push(quote_spanned! {method.span()=>
                    let course = match state.#method(course, seen) {
                        Ok(course) => course,
                        Err(action) => return action,
                    };
                }),
                How::Row(row) => rows.push(row.consult(table, path)),
            }
        }
        let first = if commands.declared {
            quote!(#step::first(seen.verb))
        } else {
            quote!(<#step as ::rcs_core::Plain>::ZERO)
        };
        let verb = if commands.senses.is_none() { quote!(seen.verb,) } else { TokenStream::new() };
        let after = |name: &str| self.after.iter().find(|after| after.table == name);
        let effect = after("EFFECT").map(|After { advance, .. }| {
            let advance = match advance {
                Some(field) => quote!(seen.#field),
                None => quote!(crate::halt::Advance::None),
            };
            quote!(let choice = state.execution.effect(number::EFFECT, choice, #advance);)
        });
        let confirm = after("CONFIRM").map(|_| {
            quote! {
                let goal = (goal(seen.verb), seen.proof);
                let choice = state.execution.confirm(number::CONFIRM, state.step, choice, goal);
            }
        });
        Ok(quote! {
            #( #[doc = #documentation] )*
            #vis fn decide(state: &mut super::State, seen: &mut StateVariables) -> #action {
                let course = state.execution.execute(seen.arrival);
                #( #gates )*
                match course {
                    crate::execution::Course::Rest | crate::execution::Course::Refuse => return #action::Wait,
                    crate::execution::Course::Begin => state.step = #first,
                    crate::execution::Course::Continue => {}
                }
                let choice = 'decided: {
                    #( #rows )*
                    #of_command(#verb state.step, &seen.situation)
                };
                #effect
                #confirm
                state.execution.rows.decide(&choice);
                state.step = choice.next;
                choice.action
            }
        })
    }
}

impl Row {
    /// Returns the decision of a row, or stores the value that it passes on.
    fn consult(&self, table: &Ident, path: &Path) -> TokenStream {
        let (function, variables) = (beside(path, str::to_lowercase), &self.variables);
        let (step, decided) = match &self.step {
            None => (quote!(state.step), quote!(break 'decided decision.of(number::#table))),
            Some(own) => (
                quote!(state.#own),
                quote! {{
                    state.#own = decision.next;
                    break 'decided decision.in_step(state.step).of(number::#table)
                }},
            ),
        };
        let passed = match &self.passes {
            None => quote!(::rcs_core::table::Verdict::Passed(()) => {}),
            Some(Passes { of, field }) => {
                let set = match field {
                    Some(field) => quote!(seen.#of.#field = value),
                    None => quote!(seen.#of.pass(value)),
                };
                quote!(::rcs_core::table::Verdict::Passed(value) => #set,)
            }
        };
        quote! {
            match #function(#step, &seen.#variables) {
                ::rcs_core::table::Verdict::Decided(decision) => #decided,
                #passed
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expand(order: &str) -> Result<String> {
        let list = format!(
            "/// Consult the table of a command.
             fn of_command(Verb, enum Step, Situation) -> Action {{
                 others: EXECUTE, accept::ACCEPT, HALT, EFFECT, joystick::JOYSTICK, link::LINK, ordered::ORDERED, CONFIRM;
                 {order}
                 Pause: goals::REST => pause::pause;
             }}"
        );
        crate::commands::expand(list.parse()?).map(|tokens| tokens.to_string())
    }

    fn error(order: &str) -> String {
        expand(order).expect_err(order).to_string()
    }

    fn assert_in_order(code: &str, texts: &[&str]) {
        let mut rest = code;
        for text in texts {
            let at = rest.find(text).unwrap_or_else(|| panic!("{text} in {rest}"));
            rest = &rest[at + text.len()..];
        }
    }

    #[test]
    fn declared_order_is_the_order_of_the_generated_code() {
        let code = expand(
            "before: EXECUTE, JOYSTICK by joystick, HALT, ACCEPT(request), LINK(situation in link),
                     ORDERED(subordinates -> situation.work);
             after: EFFECT(advance), CONFIRM;",
        )
        .expect("the order is right");
        let decide = &code[code.find("fn decide (").expect("the function is generated")..];
        assert_in_order(
            decide,
            &[
                "execution . execute (seen . arrival)",
                "state . joystick (course , seen)",
                "execution . halt (number :: HALT",
                "Course :: Begin => state . step = Step :: first (seen . verb)",
                "accept :: accept (state . step , & seen . request)",
                "link :: link (state . link , & seen . situation)",
                "state . link = decision . next",
                "ordered :: ordered (state . step , & seen . subordinates)",
                "seen . situation . work = value",
                "of_command (seen . verb , state . step , & seen . situation)",
                "execution . effect (number :: EFFECT , choice , seen . advance)",
                "execution . confirm (number :: CONFIRM",
                "state . step = choice . next",
            ],
        );
    }

    #[test]
    fn documentation_lists_the_tables_in_their_order() {
        let code = expand("before: EXECUTE, HALT, ORDERED(subordinates -> situation.work); after: CONFIRM;");
        let texts = [
            "[`EXECUTE`]",
            "[`HALT`]",
            "[`ORDERED`](ordered::ORDERED)",
            "the table of the command",
            "[`CONFIRM`]",
        ];
        let code = code.expect("the order is right");
        assert_in_order(&code[code.find("declared order").expect("it has a comment")..], &texts);
        assert!(!code.contains("execution . effect"), "EFFECT is not consulted");
    }

    #[test]
    fn effect_without_a_field_sees_no_advance() {
        let code = expand("before: EXECUTE; after: EFFECT;").expect("the order is right");
        assert!(
            code.contains("effect (number :: EFFECT , choice , crate :: halt :: Advance :: None)"),
            "{code}"
        );
    }

    #[test]
    fn value_is_passed_to_a_field_or_to_the_situation() {
        let code = |order: &str| expand(order).expect("the order is right");
        let field = code("before: EXECUTE, ORDERED(subordinates -> situation.work);");
        assert!(field.contains("Passed (value) => seen . situation . work = value ,"), "{field}");
        let whole = code("before: EXECUTE, ORDERED(subordinates -> situation);");
        assert!(whole.contains("Passed (value) => seen . situation . pass (value) ,"), "{whole}");
    }

    #[test]
    fn list_without_an_order_generates_no_function_decide() {
        assert!(!expand("").expect("it is a list").contains("fn decide"));
    }

    #[test]
    fn order_without_execute_first_is_an_error() {
        for order in [
            "before: HALT;",
            "before: HALT, EXECUTE;",
            "before: EXECUTE, EXECUTE;",
            "before: EXECUTE(request);",
        ] {
            assert_eq!(error(order), "EXECUTE is consulted first, and once", "{order}");
        }
    }

    #[test]
    fn tables_that_withhold_the_command_come_before_rows_about_it() {
        let text = "a table that can withhold the command is consulted before those with rows about it";
        assert_eq!(error("before: EXECUTE, ACCEPT(request), HALT;"), text);
        assert_eq!(error("before: EXECUTE, ACCEPT(request), JOYSTICK by joystick;"), text);
    }

    #[test]
    fn unknown_and_misplaced_tables_are_errors() {
        assert_eq!(error("before: EXECUTE, SEARCH(watch);"), "SEARCH is not in the list `others`");
        let text = "`(FIELD)` or `by METHOD` is expected: only EXECUTE and HALT need neither";
        assert_eq!(error("before: EXECUTE, ACCEPT;"), text);
        assert_eq!(
            error("before: EXECUTE; after: ACCEPT;"),
            "only EFFECT and CONFIRM are consulted after a row"
        );
    }
}
