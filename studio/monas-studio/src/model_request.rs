//! Requests of a page that edits models.

use serde::Deserialize;
use serde_json::{Map, Value};

/// A request of a page about the models that it may edit. A file is given by its number in the list
/// that the page was sent.
#[derive(Deserialize, Clone, PartialEq, Debug)]
#[serde(tag = "type", deny_unknown_fields)]
pub(crate) enum ModelRequest {
    /// The text of a file.
    #[serde(rename = "model open")]
    Open { file: usize },
    /// The structure of a text.
    #[serde(rename = "model outline")]
    Outline { file: usize, text: String },
    /// Requests all findings about a text.
    #[serde(rename = "model check")]
    Check { file: usize, text: String },
    /// Completions at a position.
    #[serde(rename = "model complete")]
    Complete { text: String, expression: Option<String>, at: usize },
    /// Requests the replacements for an edit.
    #[serde(rename = "model edit")]
    Edit { text: String, edit: Value },
    /// Replaces a file whose revision is known.
    #[serde(rename = "model save")]
    Save { file: usize, text: String, revision: String },
}

impl ModelRequest {
    /// Whether requests of this type are model requests.
    pub(crate) fn is_type(name: &str) -> bool {
        name.starts_with("model ")
    }

    /// Parses a model request: its number, and the request.
    ///
    /// # Errors
    /// A message for people.
    pub(crate) fn read(value: Value) -> (Option<u64>, Result<ModelRequest, String>) {
        let mut fields: Map<String, Value> = match value {
            Value::Object(fields) => fields,
            _ => return (None, Err("not an object".into())),
        };
        let id = fields.remove("id").and_then(|id| id.as_u64());
        let request = match id {
            Some(_) => serde_json::from_value(Value::Object(fields)).map_err(|error| error.to_string()),
            None => Err("the request has no number `id`".into()),
        };
        (id, request)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn requests_are_read_strictly() {
        let read = |value: Value| ModelRequest::read(value).1;
        assert_eq!(
            read(json!({"type": "model open", "id": 1, "file": 2})),
            Ok(ModelRequest::Open { file: 2 })
        );
        for (wrong, word) in [
            (json!({"type": "model open", "file": 2}), "`id`"),
            (json!({"type": "model open", "id": 1, "file": "../x"}), "string"),
            (json!({"type": "model open", "id": 1, "file": 1, "path": "x"}), "path"),
            (json!({"type": "model save", "id": 1, "file": 1, "text": "x"}), "revision"),
            (json!({"type": "model burn", "id": 1}), "burn"),
        ] {
            let reason = read(wrong).unwrap_err();
            assert!(reason.contains(word), "{reason}");
        }
    }
}
