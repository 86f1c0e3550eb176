//! The elements of SCXML with their attributes and permitted children.

/// An element of SCXML.
pub(crate) struct ElementGrammar {
    pub(crate) name: &'static str,
    pub(crate) attributes: &'static [&'static str],
    pub(crate) required: &'static [&'static str],
    pub(crate) children: &'static [&'static str],
}

/// Executable contents.
const EXECUTABLE_CONTENT: &[&str] = &["raise", "if", "foreach", "log", "assign", "script", "send", "cancel"];
const BRANCHES: &[&str] =
    &["raise", "if", "foreach", "log", "assign", "script", "send", "cancel", "elseif", "else"];
const NO_ATTRIBUTES: &[&str] = &[];

/// All elements; `<content>`, `<data>` and `<assign>` have arbitrary children.
pub(crate) const ELEMENTS: &[ElementGrammar] = &[
    ElementGrammar {
        name: "scxml",
        attributes: &["initial", "name", "version", "datamodel", "binding", "exmode"],
        required: &[],
        children: &["state", "parallel", "final", "datamodel", "script"],
    },
    ElementGrammar {
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
    ElementGrammar {
        name: "parallel",
        attributes: &["id"],
        required: &[],
        children: &["onentry", "onexit", "transition", "state", "parallel", "history", "datamodel", "invoke"],
    },
    ElementGrammar {
        name: "transition",
        attributes: &["event", "cond", "target", "type"],
        required: &[],
        children: EXECUTABLE_CONTENT,
    },
    ElementGrammar { name: "initial", attributes: &[], required: &[], children: &["transition"] },
    ElementGrammar {
        name: "final",
        attributes: &["id"],
        required: &[],
        children: &["onentry", "onexit", "donedata"],
    },
    ElementGrammar { name: "onentry", attributes: &[], required: &[], children: EXECUTABLE_CONTENT },
    ElementGrammar { name: "onexit", attributes: &[], required: &[], children: EXECUTABLE_CONTENT },
    ElementGrammar { name: "history", attributes: &["id", "type"], required: &[], children: &["transition"] },
    ElementGrammar { name: "raise", attributes: &["event"], required: &["event"], children: NO_ATTRIBUTES },
    ElementGrammar { name: "if", attributes: &["cond"], required: &["cond"], children: BRANCHES },
    ElementGrammar { name: "elseif", attributes: &["cond"], required: &["cond"], children: NO_ATTRIBUTES },
    ElementGrammar { name: "else", attributes: &[], required: &[], children: NO_ATTRIBUTES },
    ElementGrammar {
        name: "foreach",
        attributes: &["array", "item", "index"],
        required: &["array", "item"],
        children: EXECUTABLE_CONTENT,
    },
    ElementGrammar { name: "log", attributes: &["label", "expr"], required: &[], children: NO_ATTRIBUTES },
    ElementGrammar { name: "datamodel", attributes: &[], required: &[], children: &["data"] },
    ElementGrammar {
        name: "data",
        attributes: &["id", "src", "expr"],
        required: &["id"],
        children: NO_ATTRIBUTES,
    },
    ElementGrammar {
        name: "assign",
        attributes: &["location", "expr"],
        required: &["location"],
        children: NO_ATTRIBUTES,
    },
    ElementGrammar { name: "donedata", attributes: &[], required: &[], children: &["content", "param"] },
    ElementGrammar { name: "content", attributes: &["expr"], required: &[], children: NO_ATTRIBUTES },
    ElementGrammar {
        name: "param",
        attributes: &["name", "expr", "location"],
        required: &["name"],
        children: NO_ATTRIBUTES,
    },
    ElementGrammar { name: "script", attributes: &["src"], required: &[], children: NO_ATTRIBUTES },
    ElementGrammar {
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
    ElementGrammar {
        name: "cancel",
        attributes: &["sendid", "sendidexpr"],
        required: &[],
        children: NO_ATTRIBUTES,
    },
    ElementGrammar {
        name: "invoke",
        attributes: &["type", "typeexpr", "src", "srcexpr", "id", "idlocation", "namelist", "autoforward"],
        required: &[],
        children: &["param", "finalize", "content"],
    },
    ElementGrammar { name: "finalize", attributes: &[], required: &[], children: EXECUTABLE_CONTENT },
];

/// Elements with arbitrary children.
pub(crate) const ELEMENTS_WITH_ANY_CONTENT: [&str; 3] = ["content", "data", "assign"];

/// The element with this name.
pub(crate) fn element(name: &str) -> Option<&'static ElementGrammar> {
    ELEMENTS.iter().find(|element| element.name == name)
}
