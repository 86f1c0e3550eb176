//! `<invoke>` as text.

use super::DocumentWriter;
use super::content::{block_into, given_into, names_into, parameter_into};
use crate::content::{InlineDocument, Invoke};

impl DocumentWriter<'_> {
    pub(crate) fn invoke(&mut self, invoke: &Invoke) {
        let writer = &mut self.writer;
        writer.open("invoke");
        given_into(writer, invoke.kind.as_ref(), "type", "typeexpr");
        given_into(writer, invoke.source.as_ref(), "src", "srcexpr");
        writer.optional("id", invoke.id.as_deref());
        writer.optional("idlocation", invoke.id_location.as_ref().map(|code| code.text.as_str()));
        names_into(writer, &invoke.names);
        if invoke.autoforward {
            writer.attribute("autoforward", "true");
        }
        invoke.parameters.iter().for_each(|parameter| parameter_into(writer, parameter));
        match &invoke.content {
            Some(InlineDocument::Expression(code)) => {
                writer.open("content");
                writer.attribute("expr", &code.text);
                writer.close();
            }
            Some(InlineDocument::Document(document)) => {
                writer.open("content");
                writer.raw(document);
                writer.close();
            }
            None => {}
        }
        if let Some(finalize) = &invoke.finalize {
            writer.open("finalize");
            block_into(writer, finalize);
            writer.close();
        }
        writer.close();
    }
}
