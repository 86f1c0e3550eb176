//! What a chart reads that nobody can ever deliver to it.
//!
//! An expression may say whose message is meant: that of another host, or of a certain publisher. A message that never arrives reads as
//! missing, without a word; so whoever cannot be heard on the chart's host is told before anything starts.

use narukom::{Narukom, TopicSlot};
use yase::expression::Origin;
use yase::{Chart, Diagnostic, Span};

/// A diagnostic for each source that nobody on the host is. Hosts are not linked: what one publishes, no other receives.
pub(crate) fn out_of_reach(chart: &Chart, hub: &Narukom, publishers: &[String]) -> Vec<Diagnostic> {
    let model = &chart.statechart().name;
    let told = chart.sources().filter_map(|source| {
        let (host, publisher) = meant(&source.origin);
        let topic = hub.declaration(TopicSlot::new(source.topic.0)).map_or("?", |topic| topic.path());
        let said = format!("the chart `{model}` reads `{topic}`");
        match (host.filter(|host| *host != hub.host()), publisher) {
            (Some(host), _) => Some(of_host(&said, host, hub.host())),
            (None, Some(name)) if !publishers.iter().any(|known| known == name) => {
                Some(of_publisher(&said, name, hub.host(), publishers))
            }
            _ => None,
        }
    });
    told.collect()
}

/// The host and the publisher that are meant, as far as they are named.
fn meant(origin: &Origin) -> (Option<&str>, Option<&str>) {
    match origin {
        Origin::Host(host) => (Some(host), None),
        Origin::Publisher(publisher) => (None, Some(publisher)),
        Origin::HostPublisher { host, publisher } => (Some(host), Some(publisher)),
        _ => (None, None),
    }
}

fn of_host(said: &str, host: &str, own: &str) -> Diagnostic {
    let message = format!("{said} of the host `{host}`, of which nothing arrives on `{own}`");
    Diagnostic::error("E0320", Span::default(), message).with_hint("without a host in front its own is meant")
}

fn of_publisher(said: &str, name: &str, own: &str, publishers: &[String]) -> Diagnostic {
    let message = format!("{said} of `{name}`, but nobody publishes under that name on `{own}`");
    let known: Vec<String> = publishers.iter().map(|name| format!("`{name}`")).collect();
    Diagnostic::error("E0321", Span::default(), message)
        .with_hint(format!("agents publish under their own names: {}", known.join(", ")))
}
