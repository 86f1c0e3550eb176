//! Message sources that a chart reads and that can never deliver.
//!
//! An expression may select the messages of another host or of a certain publisher. A message that
//! never arrives reads as missing, without an error; sources that cannot reach the chart's host are
//! therefore reported before anything starts. Links may deliver messages of any publisher.

use narukom::{Hub, TopicSlot};
use yase::expression::Origin;
use yase::{CompiledChart, Diagnostic, Span};

/// Sources that can reach a host.
pub struct HostPublishers<'a> {
    /// The hub of the host.
    pub hub: &'a Hub,
    /// Publishers on the host.
    pub publishers: &'a [String],
    /// Topics that links deliver from other hosts,
    pub from_others: &'a [TopicSlot],
    /// and from other processes of this host.
    pub from_own: &'a [TopicSlot],
}

/// A diagnostic for each source that cannot deliver.
pub fn out_of_reach(chart: &CompiledChart, reach: &HostPublishers<'_>) -> Vec<Diagnostic> {
    let model = &chart.statechart().name;
    let own = reach.hub.host();
    let warnings = chart.sources().filter_map(|source| {
        let (host, publisher) = meant(&source.origin);
        let slot = TopicSlot::new(source.topic.0);
        let topic = reach.hub.declaration(slot).map_or("?", |topic| topic.path());
        let said = format!("the chart `{model}` reads `{topic}`");
        match (host.filter(|host| *host != own), publisher) {
            (Some(host), _) if !reach.from_others.contains(&slot) => Some(of_host(&said, topic, host, own)),
            (None, Some(name)) if !reach.from_own.contains(&slot) && !reach.knows(name) => {
                Some(of_publisher(&said, name, own, reach.publishers))
            }
            _ => None,
        }
    });
    warnings.collect()
}

impl HostPublishers<'_> {
    fn knows(&self, publisher: &str) -> bool {
        self.publishers.iter().any(|known| known == publisher)
    }
}

/// The selected host and publisher, if any.
fn meant(origin: &Origin) -> (Option<&str>, Option<&str>) {
    match origin {
        Origin::Host(host) => (Some(host), None),
        Origin::Publisher(publisher) => (None, Some(publisher)),
        Origin::HostPublisher { host, publisher } => (Some(host), Some(publisher)),
        _ => (None, None),
    }
}

fn of_host(said: &str, topic: &str, host: &str, own: &str) -> Diagnostic {
    let message = format!("{said} of the host `{host}`, whose messages do not reach `{own}`");
    let hint = format!(
        "add a link: `<receive topics=\"{topic}\"/>`, or remove the host to read the chart's own messages"
    );
    Diagnostic::error("E0320", Span::default(), message).with_hint(hint)
}

fn of_publisher(said: &str, name: &str, own: &str, publishers: &[String]) -> Diagnostic {
    let message = format!("{said} of `{name}`, but `{own}` has no publisher of that name");
    let known: Vec<String> = publishers.iter().map(|name| format!("`{name}`")).collect();
    Diagnostic::error("E0321", Span::default(), message)
        .with_hint(format!("agents publish under their own names: {}", known.join(", ")))
}
