//! The gateway's own pages, without script.

use std::fmt::Display;

use crate::page::people::Person;

/// A page with a title and a body, which repeats every two seconds if `again`.
fn document(title: &str, body: &str, again: bool) -> String {
    let refresh = if again { "<meta http-equiv=\"refresh\" content=\"2\">\n" } else { "" };
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n{refresh}\
         <meta name=\"color-scheme\" content=\"dark light\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
         <main>\n<h1>{title}</h1>\n{body}</main>\n</html>\n"
    )
}

const STYLE: &str = "body{font:1rem/1.5 system-ui,sans-serif;margin:0;background:Canvas;color:CanvasText}\
main{max-width:22rem;margin:10vh auto;padding:0 1rem}h1{font-size:1.4rem}label{display:block;margin:1rem 0}\
input,button{font:inherit;display:block;width:100%;box-sizing:border-box;min-height:3rem;padding:.4rem .7rem}\
button{margin-top:1.5rem;font-weight:600}.wrong{border-left:.3rem solid #d33;padding-left:.7rem}";

/// The form for name and secret, after a refusal with its reason.
#[must_use]
pub fn login(cell: &dyn Display, wrong: Option<&str>) -> String {
    let wrong = wrong
        .map_or_else(String::new, |why| format!("<p class=\"wrong\" role=\"alert\">{}</p>\n", escaped(why)));
    let form = "<form method=\"post\" action=\"/login\">\n\
        <label>Name<input name=\"name\" autocomplete=\"username\" autocapitalize=\"none\" spellcheck=\"false\" \
        maxlength=\"16\" required autofocus></label>\n\
        <label>Secret<input name=\"secret\" type=\"password\" autocomplete=\"current-password\" maxlength=\"64\" \
        required></label>\n<button>Log in</button>\n</form>\n\
        <p>The administrator of the cell makes secrets with <code>rcs-gateway person add</code>.</p>\n";
    document(&escaped(&format!("Cell {cell}")), &(wrong + form), false)
}

#[must_use]
pub fn logged_in(cell: &dyn Display, person: &Person) -> String {
    let body = format!(
        "<p>You are logged in as {}, {}.</p>\n<p><a href=\"/\">Open the page of the cell</a></p>\n\
         <form method=\"post\" action=\"/logout\"><button>Log out</button></form>\n",
        escaped(&person.name.to_string()),
        person.role
    );
    document(&escaped(&format!("Cell {cell}")), &body, false)
}

/// A sentence. The browser asks again in two seconds if `again`.
#[must_use]
pub fn notice(title: &str, text: &str, again: bool) -> String {
    document(&escaped(title), &format!("<p>{}</p>\n", escaped(text)), again)
}

fn escaped(text: &str) -> String {
    text.chars().fold(String::new(), |mut all, letter| {
        match letter {
            '&' => all.push_str("&amp;"),
            '<' => all.push_str("&lt;"),
            '>' => all.push_str("&gt;"),
            '"' => all.push_str("&quot;"),
            other => all.push(other),
        }
        all
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped() {
        let page = notice("<b>", "a & \"b\" <script>", false);
        assert!(
            page.contains("&lt;b&gt;") && page.contains("a &amp; &quot;b&quot; &lt;script&gt;"),
            "{page}"
        );
        assert!(login(&"t3", Some("<i>")).contains("&lt;i&gt;"));
    }
}
