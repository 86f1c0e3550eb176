//! The XMI form of a System Roles Model: `<SRM:SRMmodel>` with `<roles name liveness/>` and
//! `<activities name/>`.

use std::collections::BTreeSet;

use roxmltree::{Document, Node};
use yase::Diagnostic;

use super::Reader;
use crate::xmi::{self, tag};

impl Reader {
    /// Parses the name and the formulas of the model's role.
    pub(crate) fn xmi(&mut self, text: &str) {
        match xmi::parse(text) {
            Ok(document) => self.model(text, &document),
            Err(diagnostic) => self.report(diagnostic),
        }
    }

    fn model(&mut self, text: &str, document: &Document<'_>) {
        let root = document.root_element();
        let name = root.tag_name().name();
        if name != "SRMmodel" {
            let message = format!("this is a `{name}`, not a System Roles Model");
            let hint = "a role is an `SRM:SRMmodel`, or text";
            return self.report(Diagnostic::error("E0230", tag(root), message).with_hint(hint));
        }
        let mut roles = children(root, "roles");
        let Some(role) = roles.next() else {
            let hint = "add `<roles name=.. liveness=../>`";
            return self
                .report(Diagnostic::error("E0247", tag(root), "the model has no role").with_hint(hint));
        };
        if let Some(second) = roles.next() {
            let message = "the model has more than one role; the first is used";
            self.report(
                Diagnostic::error("E0248", tag(second), message).with_hint("put each role into its own file"),
            );
        }
        self.xmi_role(text, role);
        self.unknown_activities(root);
    }

    fn xmi_role(&mut self, text: &str, role: Node<'_, '_>) {
        self.srm.role = role.attribute("name").unwrap_or_default().trim().into();
        let liveness = role.attributes().find(|attribute| attribute.name() == "liveness");
        match liveness.map(|attribute| attribute.range_value()) {
            Some(range) => self.liveness(&xmi::decoded(text, range.clone()), range.into()),
            None => {
                let hint = "add `liveness=\"role=activity\"`";
                self.report(
                    Diagnostic::error("E0233", tag(role), "the role has no formulas").with_hint(hint),
                );
            }
        }
        self.entries.clear();
    }

    /// Reports names that are neither formulas nor activities of the model; they are probably
    /// misspelt.
    fn unknown_activities(&mut self, root: Node<'_, '_>) {
        let liveness = &self.srm.liveness;
        let activities: BTreeSet<&str> =
            children(root, "activities").filter_map(|node| node.attribute("name")).collect();
        let formulas: BTreeSet<&str> =
            liveness.formulas().iter().map(|formula| formula.name.as_str()).collect();
        let known: BTreeSet<&str> = activities.union(&formulas).copied().collect();
        let names = liveness.formulas().iter().flat_map(|formula| liveness.names(formula));
        let unknown = names.filter(|(name, _)| !activities.is_empty() && !known.contains(name));
        let warnings = unknown.map(|(name, span)| {
            let message = format!("the model has no activity `{name}`");
            Diagnostic::warning("E0249", span, message).with_nearest(name, known.iter().copied())
        });
        self.diagnostics.extend(warnings);
    }
}

fn children<'a, 'input>(
    node: Node<'a, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |child| child.has_tag_name(name))
}
