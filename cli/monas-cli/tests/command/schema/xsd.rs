//! The subset of XML Schema that the generated schema uses.

use roxmltree::{Document, Node};

/// The violations of a schema in a text.
pub(super) fn validate(schema: &str, text: &str) -> Vec<String> {
    let schema = Document::parse(schema).expect("the schema is XML");
    let document = Document::parse(text).expect("the text is XML");
    let validator = Validator { schema: schema.root_element() };
    let mut wrong = Vec::new();
    match validator.element(document.root_element().tag_name().name()) {
        Some(rule) => validator.check(document.root_element(), rule, &mut wrong),
        None => wrong.push(format!("unknown root {}", document.root_element().tag_name().name())),
    }
    wrong
}

struct Validator<'a> {
    schema: Node<'a, 'a>,
}

/// The elements of a name below a node, except within the types of attributes.
fn below<'a>(node: Node<'a, 'a>, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.descendants().filter(move |one| one.is_element() && one.tag_name().name() == name)
}

impl<'a> Validator<'a> {
    fn element(&self, name: &str) -> Option<Node<'a, 'a>> {
        self.schema
            .children()
            .find(|one| one.tag_name().name() == "element" && one.attribute("name") == Some(name))
    }

    fn check(&self, node: Node<'_, '_>, rule: Node<'a, 'a>, wrong: &mut Vec<String>) {
        let name = node.tag_name().name();
        for given in node.attributes() {
            match below(rule, "attribute").find(|known| known.attribute("name") == Some(given.name())) {
                Some(known) => value(given.name(), given.value(), known, wrong),
                None if below(rule, "anyAttribute").next().is_some() => {}
                None => wrong.push(format!("unknown attribute {} of {name}", given.name())),
            }
        }
        if let Some(base) = below(rule, "extension").next().and_then(|one| one.attribute("base")) {
            typed(name, node.text().unwrap_or_default().trim(), base, wrong);
        }
        for child in node.children().filter(Node::is_element) {
            let inner = child.tag_name().name();
            let mut allowed = below(rule, "choice").flat_map(|choice| below(choice, "element"));
            let is_allowed = allowed.any(|one| one.attribute("ref") == Some(inner));
            match self.element(inner).filter(|_| is_allowed) {
                Some(rule) => self.check(child, rule, wrong),
                None => wrong.push(format!("unknown element {inner} in {name}")),
            }
        }
    }
}

fn value(name: &str, text: &str, rule: Node<'_, '_>, wrong: &mut Vec<String>) {
    let restriction =
        rule.descendants().find(|one| one.tag_name().name() == "restriction").expect("a restriction");
    let count = wrong.len();
    typed(name, text, restriction.attribute("base").unwrap_or_default(), wrong);
    if wrong.len() > count {
        return;
    }
    let facets = |facet: &str| -> Vec<&str> {
        let found = restriction.children().filter(|one| one.tag_name().name() == facet);
        found.filter_map(|one| one.attribute("value")).collect()
    };
    let words = facets("enumeration");
    if !words.is_empty() && !words.contains(&text) {
        wrong.push(format!("{name} is none of the words: {text}"));
    }
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let too_small = facets("minInclusive").iter().any(|min| number(text) < number(min));
    let too_large = facets("maxInclusive").iter().any(|max| number(text) > number(max));
    if too_small || too_large {
        wrong.push(format!("{name} is out of range: {text}"));
    }
}

fn typed(name: &str, text: &str, base: &str, wrong: &mut Vec<String>) {
    let is_right = match base {
        "xs:integer" => text.parse::<i64>().is_ok(),
        "xs:double" => text.parse::<f64>().is_ok(),
        "xs:string" => true,
        other => panic!("the schema uses a type that the test does not know: {other}"),
    };
    if !is_right {
        wrong.push(format!("{name} is no {base}: {text}"));
    }
}
