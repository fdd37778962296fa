//! The form of a decision table, and the errors in it.

use syn::{
    Attribute, Error, Ident, LitInt, Path, Result, Token, Visibility, braced, parenthesized,
    parse::{Parse, ParseStream},
    punctuated::Punctuated,
    spanned::Spanned as _,
    token,
};

use crate::names;

pub struct Table {
    pub attributes: Vec<Attribute>,
    pub vis: Visibility,
    pub name: Ident,
    pub decide: Ident,
    pub step: Option<Step>,
    pub situation: Path,
    /// Given if the table declares a struct of the variables that its rows name.
    pub senses: Option<Path>,
    pub action: Path,
    /// The value that a row passes on if it does not decide.
    pub passed: Option<Passed>,
    pub groups: Vec<StepGroup>,
}

/// The steps are declared by the groups of the table, or belong to a named enum.
pub enum Step {
    Declared(Ident),
    Named(Path),
}

pub enum Passed {
    Nothing,
    Value(Path),
}

/// Rows for the named steps; for any step if none is named.
pub struct StepGroup {
    pub attributes: Vec<Attribute>,
    pub steps: Vec<Ident>,
    pub rows: Vec<Row>,
}

pub struct Row {
    pub number: LitInt,
    pub conditions: Vec<Condition>,
    pub action: Ident,
    pub argument: Option<Ident>,
    pub next: Option<Ident>,
}

pub struct Condition {
    pub variable: Ident,
    pub values: Vec<Ident>,
}

mod word {
    syn::custom_keyword!(of);
    syn::custom_keyword!(or);
    syn::custom_keyword!(any);
    syn::custom_keyword!(consult);
    syn::custom_keyword!(otherwise);
}

impl Parse for Table {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let attributes = input.call(Attribute::parse_outer)?;
        let vis = input.parse()?;
        let name: Ident = input.parse()?;
        input.parse::<Token![:]>()?;
        input.parse::<Token![fn]>()?;
        let decide = input.parse()?;
        let parameters;
        parenthesized!(parameters in input);
        let (step, situation, senses) = head(&name, &parameters)?;
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
        let table = Self { attributes, vis, name, decide, step, situation, senses, action, passed, groups };
        table.check()?;
        Ok(table)
    }
}

/// `enum NewStep, Situation`, `OldStep, Situation` or `Situation`; for `Situation` also `struct of Senses`.
fn head(table: &Ident, input: ParseStream<'_>) -> Result<(Option<Step>, Path, Option<Path>)> {
    let mut step = None;
    if input.parse::<Option<Token![enum]>>()?.is_some() {
        step = Some(Step::Declared(input.parse()?));
    } else if !input.peek(Token![struct]) {
        let first = input.call(Path::parse_mod_style)?;
        if input.is_empty() {
            return Ok((None, first, None));
        }
        step = Some(Step::Named(first));
    }
    if step.is_some() {
        input.parse::<Token![,]>()?;
    }
    let (situation, senses) = if input.parse::<Option<Token![struct]>>()?.is_some() {
        input.parse::<word::of>()?;
        let name = format!("{}Situation", names::camel(&table.to_string().to_lowercase()));
        (Ident::new(&name, table.span()).into(), Some(input.call(Path::parse_mod_style)?))
    } else {
        (input.call(Path::parse_mod_style)?, None)
    };
    if input.is_empty() { Ok((step, situation, senses)) } else { Err(input.error("`)` is expected")) }
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

/// `variable: A | B, other: C`, or `otherwise`.
fn conditions(input: ParseStream<'_>) -> Result<Vec<Condition>> {
    let mut conditions = Vec::new();
    if input.parse::<Option<word::otherwise>>()?.is_some() {
        return Ok(conditions);
    }
    if input.peek(Token![=>]) {
        return Err(input.error("a row without conditions says `otherwise`"));
    }
    while !input.peek(Token![=>]) {
        let variable = input.parse()?;
        input.parse::<Token![:]>()?;
        conditions.push(Condition { variable, values: alternatives(input)? });
        if !input.peek(Token![=>]) {
            input.parse::<Token![,]>()?;
        }
    }
    Ok(conditions)
}

impl Parse for Row {
    fn parse(input: ParseStream<'_>) -> Result<Self> {
        let number = input.parse()?;
        input.parse::<Token![:]>()?;
        let conditions = conditions(input)?;
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
    pub fn is_passed(&self) -> bool {
        self.action == "consult"
    }
}

impl Table {
    pub fn rows(&self) -> impl Iterator<Item = (&StepGroup, &Row)> {
        self.groups.iter().flat_map(|group| group.rows.iter().map(move |row| (group, row)))
    }

    /// Reports errors for which the compiler's message would be unclear.
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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(row: &str) -> Result<Table> {
        syn::parse_str(&format!("pub PAUSE: fn pause(Situation) -> Action {{ {row} }}"))
    }

    #[test]
    fn row_without_conditions_is_printed_as_otherwise() {
        let table = table("1: otherwise => Finish;").expect("the row is right");
        let (_, row) = table.rows().next().expect("a row");
        assert!(row.conditions.is_empty());
        for (row, expected) in [
            ("1: => Finish;", "a row without conditions says `otherwise`"),
            ("1: otherwise, door: Shut => Finish;", "expected `=>`"),
        ] {
            let error = self::table(row).err().expect(row).to_string();
            assert_eq!(error, expected);
        }
    }
}
