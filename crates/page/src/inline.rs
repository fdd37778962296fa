//! Joins the sources of the page into one HTML file.
//!
//! Modules cannot be imported from `file://`, so they become one script of functions in the order of dependence. Each
//! function returns its module's exports. The form of the sources needs no parser: an import names its bindings in
//! braces and a file of the same directory, a declaration is exported where it is made, and no export changes later.
//! [`bundle`] refuses other sources, and so do the tests.

use std::collections::{BTreeMap, BTreeSet};

use data_encoding::BASE64;
use sha2::{Digest as _, Sha256};

const INDEX: &str = include_str!("../web/index.html"); // the file that the browser reads first
const START: &str = "app.js"; // the module that starts the page
/// The part of [`INDEX`] that loads style and modules during development.
const LINKS: &str =
    "<link rel=\"stylesheet\" href=\"style.css\">\n<script type=\"module\" src=\"app.js\"></script>";

/// Style sheets in their order.
const STYLES: &[(&str, &str)] = &[
    ("style.css", ""),
    ("view/base.css", include_str!("../web/view/base.css")),
    ("view/bar.css", include_str!("../web/view/bar.css")),
    ("view/cell.css", include_str!("../web/view/cell.css")),
    ("view/hierarchy.css", include_str!("../web/view/hierarchy.css")),
    ("view/table.css", include_str!("../web/view/table.css")),
    ("view/rows.css", include_str!("../web/view/rows.css")),
    ("view/lists.css", include_str!("../web/view/lists.css")),
    ("view/side.css", include_str!("../web/view/side.css")),
    ("view/why.css", include_str!("../web/view/why.css")),
    ("view/time.css", include_str!("../web/view/time.css")),
    ("view/controls.css", include_str!("../web/view/controls.css")),
    ("view/layout.css", include_str!("../web/view/layout.css")),
    ("view/print.css", include_str!("../web/view/print.css")),
];
const MODULES: &[(&str, &str)] = &[
    ("app.js", include_str!("../web/app.js")),
    ("cell/frames.js", include_str!("../web/cell/frames.js")),
    ("cell/glb.js", include_str!("../web/cell/glb.js")),
    ("cell/gpu.js", include_str!("../web/cell/gpu.js")),
    ("cell/matrix.js", include_str!("../web/cell/matrix.js")),
    ("cell/renderer.js", include_str!("../web/cell/renderer.js")),
    ("cell/shaders.js", include_str!("../web/cell/shaders.js")),
    ("log/account.js", include_str!("../web/log/account.js")),
    ("log/bytes.js", include_str!("../web/log/bytes.js")),
    ("log/cdr.js", include_str!("../web/log/cdr.js")),
    ("log/connection.js", include_str!("../web/log/connection.js")),
    ("log/explanation.js", include_str!("../web/log/explanation.js")),
    ("log/job.js", include_str!("../web/log/job.js")),
    ("log/lanes.js", include_str!("../web/log/lanes.js")),
    ("log/live.js", include_str!("../web/log/live.js")),
    ("log/log.js", include_str!("../web/log/log.js")),
    ("log/mcap.js", include_str!("../web/log/mcap.js")),
    ("log/messages.js", include_str!("../web/log/messages.js")),
    ("log/processes.js", include_str!("../web/log/processes.js")),
    ("log/protobuf.js", include_str!("../web/log/protobuf.js")),
    ("log/reports.js", include_str!("../web/log/reports.js")),
    ("log/rows.js", include_str!("../web/log/rows.js")),
    ("log/run.js", include_str!("../web/log/run.js")),
    ("log/series.js", include_str!("../web/log/series.js")),
    ("log/state.js", include_str!("../web/log/state.js")),
    ("log/tables.js", include_str!("../web/log/tables.js")),
    ("log/units.js", include_str!("../web/log/units.js")),
    ("view/actions.js", include_str!("../web/view/actions.js")),
    ("view/bar.js", include_str!("../web/view/bar.js")),
    ("view/cell.js", include_str!("../web/view/cell.js")),
    ("view/controls.js", include_str!("../web/view/controls.js")),
    ("view/dom.js", include_str!("../web/view/dom.js")),
    ("view/hierarchy.js", include_str!("../web/view/hierarchy.js")),
    ("view/icons.js", include_str!("../web/view/icons.js")),
    ("view/instruments.js", include_str!("../web/view/instruments.js")),
    ("view/labels.js", include_str!("../web/view/labels.js")),
    ("view/lists.js", include_str!("../web/view/lists.js")),
    ("view/notices.js", include_str!("../web/view/notices.js")),
    ("view/open.js", include_str!("../web/view/open.js")),
    ("view/operate.js", include_str!("../web/view/operate.js")),
    ("view/pointer.js", include_str!("../web/view/pointer.js")),
    ("view/score.js", include_str!("../web/view/score.js")),
    ("view/session.js", include_str!("../web/view/session.js")),
    ("view/side.js", include_str!("../web/view/side.js")),
    ("view/table-rows.js", include_str!("../web/view/table-rows.js")),
    ("view/table.js", include_str!("../web/view/table.js")),
    ("view/timeline-paint.js", include_str!("../web/view/timeline-paint.js")),
    ("view/timeline.js", include_str!("../web/view/timeline.js")),
    ("view/ui.js", include_str!("../web/view/ui.js")),
    ("view/why.js", include_str!("../web/view/why.js")),
];

#[derive(Clone, Copy, Debug)]
pub enum Content<'a> {
    Log(&'a [u8]), // a packed log ([`crate::pack`])
    /// A run in progress ([`crate::pack_start`]). The page connects to the live view at the address that served it.
    Run(&'a [u8]),
}

/// The page as one file, with a packed log or the start of a run inside.
///
/// The file permits only this script, which does not depend on the texts of the log. With a log it loads nothing. With
/// a run it connects only to its own server.
#[must_use]
pub fn document(title: &str, content: Content<'_>) -> String {
    let style: String = STYLES.iter().map(|(_, text)| compact(text)).collect();
    let script = match bundle(MODULES, START) {
        Ok(script) => harmless(&script),
        // The tests bundle the same sources, so this error reaches no released program.
        Err(error) => format!("document.body.textContent = {error:?};"),
    };
    let (id, data, from) = match content {
        Content::Log(data) => ("log-data", data, "'none'"),
        Content::Run(data) => ("run-data", data, "'self'"),
    };
    let digest = BASE64.encode(&Sha256::digest(script.as_bytes()));
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; img-src blob: data:; \
         connect-src {from}; base-uri 'none'; form-action 'none'"
    );
    let data = BASE64.encode(data);
    let data = format!("<script type=\"application/octet-stream\" id=\"{id}\">{data}</script>\n");
    let head = format!(
        "<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n<style>\n{style}</style>"
    );
    let body = format!("{data}<script type=\"module\">{script}</script>\n</body>");
    INDEX
        .replace("<title>RCS-II/T3</title>", &format!("<title>{}</title>", escaped(title)))
        .replace(LINKS, &head)
        .replace("</body>", &body)
}

/// Joins modules into one script that starts with `start`. The error names the module and its unexpected line.
pub fn bundle(modules: &[(&str, &str)], start: &str) -> Result<String, String> {
    let known: BTreeMap<&str, &str> = modules.iter().map(|(path, text)| (file_name(path), *text)).collect();
    if known.len() != modules.len() {
        return Err("two modules have the same file name: rename one of them".to_owned());
    }
    let (mut script, mut done) = (String::new(), BTreeSet::new());
    append(&known, start, &mut Vec::new(), &mut done, &mut script)?;
    match known.keys().find(|name| !done.contains(**name)) {
        Some(unused) => Err(format!("{unused}: no module imports it: import it or delete it")),
        None => Ok(script),
    }
}

fn append(
    known: &BTreeMap<&str, &str>,
    name: &str,
    open: &mut Vec<String>,
    done: &mut BTreeSet<String>,
    script: &mut String,
) -> Result<(), String> {
    if done.contains(name) {
        return Ok(());
    }
    if open.iter().any(|waiting| waiting == name) {
        return Err(format!("{name}: imports itself through {}: break the circle", open.join(", ")));
    }
    let text = known.get(name).ok_or_else(|| format!("{name}: no such module"))?;
    let module = Module::read(text).map_err(|error| format!("{name}: {error}"))?;
    open.push(name.to_owned());
    for (_, from) in &module.imports {
        append(known, from, open, done, script)?;
    }
    open.pop();
    done.insert(name.to_owned());
    let imports =
        module.imports.iter().map(|(names, from)| format!("const {{{names}}} = {}();\n", getter(from)));
    let imports: String = imports.collect();
    let exports = module.exports.join(", ");
    // Each module runs once, at its place in the order.
    script.push_str(&format!(
        "const {getter} = ((exports) => () => exports)((() => {{\n{imports}{body}return {{ {exports} }};\n}})());\n",
        getter = getter(name),
        body = compact(&module.body),
    ));
    Ok(())
}

#[derive(Default)]
struct Module {
    imports: Vec<(String, String)>, // names of bindings, and the file name of the module that has them
    exports: Vec<String>,
    body: String, // the text without its imports, and without the word `export`
}

impl Module {
    fn read(text: &str) -> Result<Self, String> {
        let mut module = Self::default();
        let mut statement = String::new();
        for (number, line) in (1..).zip(text.lines()) {
            if statement.is_empty() && !line.starts_with("import ") {
                let line = module.exported(line).map_err(|error| format!("line {number}: {error}"))?;
                module.body.push_str(line);
                module.body.push('\n');
                continue;
            }
            statement.push_str(line);
            if line.ends_with(';') {
                let import = import(&statement).ok_or_else(|| {
                    format!("line {number}: `import {{ names }} from './file.js';` was expected, found {statement}")
                })?;
                module.imports.push(import);
                statement.clear();
            }
        }
        Ok(module)
    }

    /// Removes the word `export` from a line and stores the exported name.
    fn exported<'a>(&mut self, line: &'a str) -> Result<&'a str, String> {
        let Some(declaration) = line.strip_prefix("export ") else { return Ok(line) };
        let kinds = ["async function* ", "async function ", "function* ", "function ", "class ", "const "];
        let named = kinds
            .iter()
            .find_map(|kind| declaration.strip_prefix(kind))
            .ok_or_else(|| format!("an exported function, class or constant was expected, found {line}"))?;
        let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '$';
        let name: String = named.chars().take_while(|letter| is_part(*letter)).collect();
        if name.is_empty() {
            return Err(format!("an exported name was expected, found {line}"));
        }
        self.exports.push(name);
        Ok(declaration)
    }
}

fn import(statement: &str) -> Option<(String, String)> {
    let (names, rest) = statement.strip_prefix("import {")?.split_once('}')?;
    let path = rest.trim().strip_prefix("from '")?.strip_suffix("';")?;
    // A renamed binding would need other code in the script.
    (path.starts_with('.') && !names.contains(" as ")).then(|| (names.to_owned(), file_name(path).to_owned()))
}

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

fn getter(file: &str) -> String {
    let stem = file.strip_suffix(".js").unwrap_or(file);
    format!("module_{}", stem.replace('-', "_"))
}

/// Removes comments, indentation and empty lines. It treats every `/*` as a comment, also in a text, and removes the
/// indentation of a text over several lines. The sources have no text for which this matters.
fn compact(source: &str) -> String {
    let mut code = String::with_capacity(source.len());
    let mut rest = source;
    while let Some((before, comment)) = rest.split_once("/*") {
        code.push_str(before);
        rest = comment.split_once("*/").map_or("", |(_, after)| after);
    }
    code.push_str(rest);
    let lines = code.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// The script without texts that would end its element.
fn harmless(script: &str) -> String {
    script.replace("</script", "<\\/script").replace("<!--", "<\\!--")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{fs, path::Path};

    #[test]
    fn a_module_is_run_after_those_that_it_imports() {
        let modules = [
            ("app.js", "import { two } from './sub/two.js';\ntwo();\n"),
            (
                "sub/two.js",
                "import {\n  one,\n} from '../one.js';\nexport function two() { return one + 1; }\n",
            ),
            ("one.js", "const half = 0.5;\nexport const one = 2 * half;\n"),
        ];
        let script = bundle(&modules, "app.js").unwrap();
        let place = |text: &str| script.find(text).unwrap_or_else(|| panic!("{text} is not in\n{script}"));
        assert!(place("const one = 2 * half;") < place("function two()"));
        assert!(place("function two()") < place("two();\n"));
        assert!(place("return { one };") < place("return { two };"));
        assert!(!script.contains("import ") && !script.contains("export "), "{script}");
    }

    #[test]
    fn comments_and_indentation_are_left_out() {
        let source = "/**\n * Adds.\n * @param {number} a\n */\nfunction add(/** @type {number} */ a) {\n\n  // Why.\n  \
                      return a + 1; // \u{2192}\n}\n";
        assert_eq!(compact(source), "function add( a) {\nreturn a + 1; // \u{2192}\n}\n");
        assert_eq!(compact("a { b: c }\n/* never closed"), "a { b: c }\n");
    }

    #[test]
    fn sources_in_another_form_are_refused() {
        let cases = [
            ("import x from './one.js';", "line 1"),
            ("import { a as b } from './one.js';", "line 1"),
            ("import { a } from 'react';", "line 1"),
            ("export default 1;", "exported function"),
            ("export let a = 1;", "exported function"),
            ("import { one } from './three.js';", "no such module"),
            ("import { app } from './app.js';", "break the circle"),
            ("", "no module imports it"),
        ];
        for (text, expected) in cases {
            let error =
                bundle(&[("app.js", text), ("one.js", "export const one = 1;")], "app.js").unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }

    #[test]
    fn the_sources_of_the_page_become_one_script() {
        let script = bundle(MODULES, START).unwrap();
        assert!(!script.contains("\nimport ") && !script.contains("\nexport "));
    }

    /// Paths of the page's files with this ending, except tests.
    fn files(directory: &Path, ending: &str, found: &mut BTreeSet<String>) {
        for entry in fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                files(&path, ending, found);
            } else if name.ends_with(ending) && !name.ends_with(".test.js") {
                found.insert(name);
            }
        }
    }

    #[test]
    fn every_source_is_embedded() {
        let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("web");
        for (embedded, ending) in [(MODULES, ".js"), (STYLES, ".css")] {
            let mut found = BTreeSet::new();
            files(&web, ending, &mut found);
            let embedded: BTreeSet<String> =
                embedded.iter().map(|(path, _)| file_name(path).to_owned()).collect();
            assert_eq!(embedded, found);
        }
        // The style sheets that the page loads while it is developed are those that are embedded.
        let imported: String =
            STYLES.iter().skip(1).map(|(path, _)| format!("@import '{path}';\n")).collect();
        assert!(include_str!("../web/style.css").starts_with(&imported));
    }

    #[test]
    fn a_document_needs_no_other_file_and_has_the_log_inside() {
        let page = document("a < b", Content::Log(b"\x89MCAP0\r\n"));
        let live = document("t", Content::Run(b""));
        assert!(page.contains("<title>a &lt; b</title>"));
        assert!(page.contains("connect-src 'none'") && live.contains("connect-src 'self'"));
        assert!(page.contains(&format!("id=\"log-data\">{}</script>", BASE64.encode(b"\x89MCAP0\r\n"))));
        for outside in ["src=", "href=\"style", "@import", "http://", "https://"] {
            let lines: Vec<&str> = page.lines().filter(|line| line.contains(outside)).collect();
            assert!(lines.iter().all(|line| line.contains("www.w3.org")), "{outside}: {lines:?}");
        }
        assert!(live.len() < 300_000, "{} bytes without a log", live.len());
    }
}
