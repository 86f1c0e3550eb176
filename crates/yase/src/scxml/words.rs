//! The elements of SCXML, with their attributes and what may stand in them.

/// An element of SCXML.
pub(super) struct Element {
    pub(super) name: &'static str,
    pub(super) attributes: &'static [&'static str],
    pub(super) required: &'static [&'static str],
    pub(super) children: &'static [&'static str],
}

/// What may be executed.
const CONTENTS: &[&str] = &["raise", "if", "foreach", "log", "assign", "script", "send", "cancel"];
const BRANCHES: &[&str] =
    &["raise", "if", "foreach", "log", "assign", "script", "send", "cancel", "elseif", "else"];
const ANY: &[&str] = &[];

/// Every element; `<content>`, `<data>` and `<assign>` hold what they like.
pub(super) const ELEMENTS: &[Element] = &[
    Element {
        name: "scxml",
        attributes: &["initial", "name", "version", "datamodel", "binding", "exmode"],
        required: &[],
        children: &["state", "parallel", "final", "datamodel", "script"],
    },
    Element {
        name: "state",
        attributes: &["id", "initial"],
        required: &[],
        children: &[
            "onentry",
            "onexit",
            "transition",
            "initial",
            "state",
            "parallel",
            "final",
            "history",
            "datamodel",
            "invoke",
        ],
    },
    Element {
        name: "parallel",
        attributes: &["id"],
        required: &[],
        children: &["onentry", "onexit", "transition", "state", "parallel", "history", "datamodel", "invoke"],
    },
    Element {
        name: "transition",
        attributes: &["event", "cond", "target", "type"],
        required: &[],
        children: CONTENTS,
    },
    Element { name: "initial", attributes: &[], required: &[], children: &["transition"] },
    Element {
        name: "final",
        attributes: &["id"],
        required: &[],
        children: &["onentry", "onexit", "donedata"],
    },
    Element { name: "onentry", attributes: &[], required: &[], children: CONTENTS },
    Element { name: "onexit", attributes: &[], required: &[], children: CONTENTS },
    Element { name: "history", attributes: &["id", "type"], required: &[], children: &["transition"] },
    Element { name: "raise", attributes: &["event"], required: &["event"], children: ANY },
    Element { name: "if", attributes: &["cond"], required: &["cond"], children: BRANCHES },
    Element { name: "elseif", attributes: &["cond"], required: &["cond"], children: ANY },
    Element { name: "else", attributes: &[], required: &[], children: ANY },
    Element {
        name: "foreach",
        attributes: &["array", "item", "index"],
        required: &["array", "item"],
        children: CONTENTS,
    },
    Element { name: "log", attributes: &["label", "expr"], required: &[], children: ANY },
    Element { name: "datamodel", attributes: &[], required: &[], children: &["data"] },
    Element { name: "data", attributes: &["id", "src", "expr"], required: &["id"], children: ANY },
    Element { name: "assign", attributes: &["location", "expr"], required: &["location"], children: ANY },
    Element { name: "donedata", attributes: &[], required: &[], children: &["content", "param"] },
    Element { name: "content", attributes: &["expr"], required: &[], children: ANY },
    Element { name: "param", attributes: &["name", "expr", "location"], required: &["name"], children: ANY },
    Element { name: "script", attributes: &["src"], required: &[], children: ANY },
    Element {
        name: "send",
        attributes: &[
            "event",
            "eventexpr",
            "target",
            "targetexpr",
            "type",
            "typeexpr",
            "id",
            "idlocation",
            "delay",
            "delayexpr",
            "namelist",
        ],
        required: &[],
        children: &["content", "param"],
    },
    Element { name: "cancel", attributes: &["sendid", "sendidexpr"], required: &[], children: ANY },
    Element {
        name: "invoke",
        attributes: &["type", "typeexpr", "src", "srcexpr", "id", "idlocation", "namelist", "autoforward"],
        required: &[],
        children: &["param", "finalize", "content"],
    },
    Element { name: "finalize", attributes: &[], required: &[], children: CONTENTS },
];

/// Elements in which anything may stand.
pub(super) const OPEN: [&str; 3] = ["content", "data", "assign"];

/// The element of a name.
pub(super) fn element(name: &str) -> Option<&'static Element> {
    ELEMENTS.iter().find(|element| element.name == name)
}
