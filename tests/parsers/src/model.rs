//! Model files of all kinds: findings are valid, and a model written in a lossless format reads
//! back as the same model.

use aseme_models::convert::{self, Format, Model};
use yase::Source;

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn model(data: &[u8]) {
    let text = text_of(data);
    let (found, findings) = convert::read(&Source::new("model", text));
    assert_findings_fit(text, &findings);
    let Some((model, _)) = found else { return assert!(!findings.is_empty()) };
    for (_, format) in Format::WORDS {
        match model.write(format, text) {
            Ok(written)
                if written.lost.is_empty()
                    && !matches!(format, Format::Role | Format::Rust)
                    && !matches!(model, Model::Role(_)) =>
            {
                let (again, findings) = convert::read(&Source::new("again", written.text.as_str()));
                assert_findings_fit(&written.text, &findings);
                let again = again.map(|(model, _)| model);
                assert_eq!(again.as_ref(), Some(&model), "{format:?}\n{}", written.text);
            }
            Ok(_) => {}
            Err(refused) => assert!(!refused.is_empty(), "{format:?}"),
        }
    }
    let (_, findings) = aseme_models::statechart_of(&Source::new("model", text));
    assert_findings_fit(text, &findings);
}
