//! Show mode: `:S variable <= value … :R >FILE name` (VII.7.2, VII.7.4).

use std::ops::RangeInclusive;

use diagnostics::nearest;

use super::{
    entries::{Entry, Named, ShowEntry},
    forms::{FORCE, GRIP, OPENING},
    lex::Word,
    parser::{Parser, Skip},
};

/// Variables of OBJ-GRIPS (VII.7.2).
pub(super) const OBJ_GRIPS: &[(&str, RangeInclusive<i32>)] = &[("endeff-id#", 1..=3), ("tray-grip#", GRIP)];
/// Variables of PED-PARA (VII.7.4).
pub(super) const PED_PARA: &[(&str, RangeInclusive<i32>)] = &[
    ("ped-appr", OPENING),
    ("ped-grasp-size", OPENING),
    ("ped-force", FORCE),
    ("ped-release-size", OPENING),
    ("ped-table-pos", -3600..=3600),
    ("ped-flip-angle", -3600..=3600),
];

pub fn show(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let mut settings: Vec<(Word<'_>, Word<'_>)> = Vec::new();
    while p.take_if(":R").is_none() {
        let Some(variable) = p.peek().filter(|w| !w.text.starts_with([':', '>', '<', '-'])) else {
            return Err(p.expected("a variable or :R"));
        };
        p.take();
        if p.take_if("<=").is_none() {
            return Err(p.expected(&format!("<= after {}", variable.text)));
        }
        let Some(value) = p.peek() else { return Err(p.expected("a value")) };
        p.take();
        settings.push((variable, value));
    }
    if p.take_if(">FILE").is_none() {
        return Err(p.expected(">FILE after :R"));
    }
    let Some(file) = p.peek() else { return Err(p.expected("OBJ-GRIPS or PED-PARA")) };
    match file.text {
        "OBJ-GRIPS" => {
            p.take();
            let (object, values) = settings_of::<2>(p, &settings, file, "\"object\"", OBJ_GRIPS)?;
            Ok(Entry::ObjGrips(ShowEntry { object, values }))
        }
        "PED-PARA" => {
            p.take();
            let (object, values) = settings_of::<6>(p, &settings, file, "\"p-object\"", PED_PARA)?;
            Ok(Entry::PedPara(ShowEntry { object, values }))
        }
        _ => Err(p.expected("OBJ-GRIPS or PED-PARA")),
    }
}

fn settings_of<const N: usize>(
    p: &mut Parser<'_, '_>,
    settings: &[(Word<'_>, Word<'_>)],
    file: Word<'_>,
    name_variable: &str,
    variables: &[(&str, RangeInclusive<i32>)],
) -> Result<(Named<16>, [i32; N]), Skip> {
    let known = || std::iter::once(name_variable).chain(variables.iter().map(|v| v.0));
    let mut misspelt = false;
    for (i, (variable, _)) in settings.iter().enumerate() {
        if !known().any(|k| k == variable.text) {
            let message = format!("{} has no variable {}", file.text, variable.text);
            p.flaw("show.variable", variable.at, message, None);
            if let Some(near) = nearest(variable.text, known()) {
                p.nearest("variable", near);
            }
            misspelt = true;
        } else if settings.iter().take(i).any(|(v, _)| v.text == variable.text) {
            p.flaw("show.twice", variable.at, format!("{} is set twice", variable.text), None);
            misspelt = true;
        }
    }
    let value_of = |name: &str| settings.iter().find(|(v, _)| v.text == name).map(|(_, value)| *value);
    let missing: Vec<&str> = known().filter(|k| value_of(k).is_none()).collect();
    let Some(object) = value_of(name_variable).filter(|_| missing.is_empty()) else {
        // If one variable is misspelt or set twice, another is missing, so only one error is reported.
        if !misspelt {
            p.flaw("show.missing", file.at, format!("{} needs {}", file.text, missing.join(", ")), None);
        }
        return Err(Skip);
    };
    let object = p.at_word(object, |q| q.name("object"))?;
    let mut values = [0; N];
    for (slot, (name, range)) in values.iter_mut().zip(variables) {
        if let Some(word) = value_of(name) {
            *slot = p.at_word(word, |q| q.integer(name, range.clone()))?;
        }
    }
    Ok((object, values))
}
