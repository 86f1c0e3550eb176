//! Colour tables of cameras: files with the colours of a field in one light.
//!
//! ```
//! use monas_config::colours;
//! use monas_robot::FieldColours;
//!
//! let known = FieldColours { green_luma: 95.0, white_luma: 220.0, ..FieldColours::default() };
//! let text = colours::file(&known, "the hall at noon");
//! let source = yase::Source::new("hall.xml", text);
//! assert_eq!(colours::read(&source), (Some(known), Vec::new()));
//! ```

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use monas_robot::{Colour, FieldColours, ObjectColour};
use yase::{Diagnostic, Source, Span};

use crate::{AttributeRule, Element, ElementRule, Grammar, Kind, Values, paths};

/// The elements of objects.
const OBJECTS: [(&str, Colour); 4] =
    [("orange", Colour::Orange), ("yellow", Colour::Yellow), ("blue", Colour::Blue), ("red", Colour::Red)];

/// The grammar of a colour table.
pub fn grammar() -> Grammar {
    let chroma = Kind::number_in(-8.0, 8.0);
    let [u, v] = [
        AttributeRule::new("u", chroma.clone(), "(U - 128) / Y").required(),
        AttributeRule::new("v", chroma, "(V - 128) / Y").required(),
    ];
    let luma = AttributeRule::new("luma", Kind::number_in(1.0, 255.0), "its brightness Y").required();
    let deviation =
        AttributeRule::new("deviation", Kind::number_in(0.0, 255.0), "standard deviation of its luma")
            .required();
    let width = AttributeRule::new(
        "width",
        Kind::number_in(0.0, 1.0),
        "greatest difference of the angle of its chroma, rad",
    )
    .required();
    let green =
        ElementRule::new("green", "the carpet").attributes([luma.clone(), deviation, u.clone(), v.clone()]);
    let white =
        ElementRule::new("white", "what is white, such as lines").attributes([luma, u.clone(), v.clone()]);
    let colours = ElementRule::new("colours", "the colours of a field in one light")
        .required_child("green")
        .required_child("white");
    let colours = OBJECTS.iter().fold(colours, |colours, (name, _)| colours.child(name));
    let grammar = Grammar::default().root(colours).with(green).with(white);
    OBJECTS.iter().fold(grammar, |grammar, (name, _)| {
        let object = ElementRule::new(name, "the colour of an object, as in white light");
        grammar.with(object.attributes([u.clone(), v.clone(), width.clone()]))
    })
}

/// Reads a file, in XML or TOML, with its diagnostics. There are no colours if one of these is an
/// error.
pub fn load(path: &Path) -> (Option<FieldColours>, Vec<Diagnostic>) {
    match paths::read(path) {
        Ok(source) => read(&source),
        Err(diagnostic) => (None, vec![*diagnostic]),
    }
}

/// As [`load`], from a text in memory.
pub fn read(source: &Arc<Source>) -> (Option<FieldColours>, Vec<Diagnostic>) {
    let grammar = grammar();
    let (elements, mut diagnostics) = grammar.read(source);
    if elements.is_empty() && diagnostics.is_empty() {
        let missing = Diagnostic::error("E0305", Span::default(), "expected `colours`, the file holds none");
        diagnostics.push(missing.in_source(source));
    }
    let is_broken = diagnostics.iter().any(Diagnostic::is_error);
    let colours = elements.first().filter(|_| !is_broken).map(|root| of_element(root, &grammar));
    (colours, diagnostics)
}

fn of_element(root: &Element, grammar: &Grammar) -> FieldColours {
    let mut colours = FieldColours::default();
    for child in root.children() {
        let values = Values::of(child, grammar);
        let number = |key| values.number(key).unwrap_or_default();
        let (luma, u, v) = (number("luma"), number("u"), number("v"));
        if child.is("green") {
            (colours.green_luma, colours.green_u, colours.green_v) = (luma, u, v);
            colours.green_deviation = number("deviation");
        } else if child.is("white") {
            (colours.white_luma, colours.white_u, colours.white_v) = (luma, u, v);
        } else if let Some((_, colour)) = OBJECTS.iter().find(|(name, _)| child.is(name)) {
            colours.objects.push(ObjectColour { colour: (*colour).into(), u, v, width: number("width") });
        }
    }
    colours
}

/// The text of a file with these colours, to a ten-thousandth; a comment says where they are from.
pub fn file(colours: &FieldColours, comment: &str) -> String {
    let number = |value: &f64| (value * 1e4).round() / 1e4;
    let [green_luma, deviation, green_u, green_v] =
        [&colours.green_luma, &colours.green_deviation, &colours.green_u, &colours.green_v].map(number);
    let [white_luma, white_u, white_v] =
        [&colours.white_luma, &colours.white_u, &colours.white_v].map(number);
    let comment = comment.replace("--", "-");
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <!-- {comment}\n     luma is Y from 0 to 255, u and v are chroma divided by luma; objects as in white light. -->\n\
         <colours>\n  \
         <green luma=\"{green_luma}\" deviation=\"{deviation}\" u=\"{green_u}\" v=\"{green_v}\"/>\n  \
         <white luma=\"{white_luma}\" u=\"{white_u}\" v=\"{white_v}\"/>\n"
    );
    for ObjectColour { colour, u, v, width } in &colours.objects {
        if let Some((name, _)) = OBJECTS.iter().find(|(_, known)| i32::from(*known) == *colour) {
            let [u, v, width] = [u, v, width].map(number);
            let _ = writeln!(text, "  <{name} u=\"{u}\" v=\"{v}\" width=\"{width}\"/>");
        }
    }
    text.push_str("</colours>\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<String> {
        let (colours, diagnostics) = read(&Source::new("hall.xml", text));
        assert_eq!(colours.is_none(), !diagnostics.is_empty());
        diagnostics.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_file_is_read_as_it_was_written() {
        let orange = ObjectColour { colour: Colour::Orange.into(), u: -0.46, v: 0.55, width: 0.12 };
        let colours = FieldColours {
            green_luma: 95.5,
            green_u: -0.25,
            green_v: -0.35,
            green_deviation: 5.0,
            white_luma: 220.0,
            white_u: 0.01,
            white_v: -0.02,
            objects: vec![orange],
        };
        let text = file(&colours, "frame -- one");
        assert_eq!(read(&Source::new("hall.xml", text.clone())).0, Some(colours.clone()), "{text}");
        let toml = "[colours.green]\nluma = 95.5\ndeviation = 5\nu = -0.25\nv = -0.35\n\
                    [colours.white]\nluma = 220\nu = 0.01\nv = -0.02\n\
                    [colours.orange]\nu = -0.46\nv = 0.55\nwidth = 0.12\n";
        assert_eq!(read(&Source::new("hall.toml", toml)), (Some(colours), Vec::new()));
    }

    #[test]
    fn what_is_wrong_is_reported_with_its_place() {
        let white = "<white luma=\"220\" u=\"0\" v=\"0\"/>";
        let green = "<green luma=\"95\" deviation=\"5\" u=\"-0.2\" v=\"-0.3\"/>";
        for (text, expected) in [
            (format!("<colours>{green}</colours>"), "white"),
            (format!("<colours>{green}{white}<pink/></colours>"), "hall.xml:1:"),
            (format!("<colours>{green}<white luma=\"300\" u=\"0\" v=\"0\"/></colours>"), "`luma` is `300`"),
            (format!("<colours>{green}<white luma=\"200\" u=\"0\"/></colours>"), "`v`"),
            (String::new(), "expected `colours`"),
            ("<robot/>".to_owned(), "robot"),
        ] {
            let found = found(&text);
            assert!(found.iter().any(|found| found.contains(expected)), "{text}: {found:?}");
        }
    }
}
