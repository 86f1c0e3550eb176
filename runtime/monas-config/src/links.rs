//! Links from a file: topics that cross to other processes and hosts, and their transport.

use std::path::{Path, PathBuf};
use std::time::Duration;

use monas_link::{
    AccessList, HubBridge, LinkSettings, PublishAs, ReceiveRule, Reliability, SendBudget, SendRule,
};
use narukom::Hub;
use yase::{Diagnostic, Span};

use super::element::{Attribute, Element};
use super::grammar::Grammar;
use super::paths;
use super::values::Values;
use monas_link::Certificates;
use monas_link::LinkConfig;
use monas_link::LinkTransport;
use monas_link::ZenohEndpoints;

/// Elements that apply to zenoh only.
const OF_ZENOH: [&str; 3] = ["connect", "listen", "certificates"];

/// Limits of sending in the rules of games: packets of a whole team per game, duration of a game in
/// s, and bytes per packet.
///
/// The figures of the Standard Platform League: 1200 packets of 128 bytes per team, in two halves
/// of ten minutes.
const PROFILES: [(&str, (u32, u64, usize)); 1] = [("spl", (1200, 1200, 128))];

/// Contents of a link before its transport is known.
#[derive(Default)]
struct PartialLink {
    settings: LinkSettings,
    folder: Option<PathBuf>,
    endpoints: ZenohEndpoints,
}

/// Reads links.
pub(crate) struct LinkReader<'a> {
    pub(crate) path: &'a Path,
    pub(crate) grammar: &'a Grammar,
    pub(crate) diagnostics: &'a mut Vec<Diagnostic>,
}

impl LinkReader<'_> {
    /// A link, if it has no errors and is enabled.
    pub(crate) fn link(&mut self, element: &Element) -> Option<LinkConfig> {
        let errors = self.errors();
        let is_refused = self.is_refused(element);
        let values = Values::of(element, self.grammar);
        let is_zenoh = values.word("transport", &[("local", false), ("zenoh", true)]).unwrap_or(false);
        let mut draft = PartialLink::default();
        draft.settings.name = values.text("name").unwrap_or_default().to_owned();
        draft.settings.accepts_unlinked = values.flag("guests").unwrap_or_default();
        if let Some(beat) = values.duration("beat") {
            draft.settings.beat = beat;
        }
        let clock = values.text("clock").map(str::to_owned);
        draft.folder = values.text("folder").map(PathBuf::from);
        draft.endpoints.realm = values.text("realm").map(str::to_owned);
        draft.endpoints.scouting = values.flag("scouting").unwrap_or_default();
        draft.endpoints.shared_memory = values.flag("shared_memory").unwrap_or(true);
        self.misplaced(element, is_zenoh);
        if let Some(named) = values.given("access") {
            draft.settings.access = self.access(named).unwrap_or_default();
        }
        self.content(element, &mut draft);
        if !is_refused {
            self.contradictions(element, &draft.settings, errors);
        }
        let transport = match is_zenoh {
            true => self.zenoh(element, draft.endpoints, &draft.settings.access, errors),
            false => LinkTransport::Local { folder: draft.folder },
        };
        let enabled = values.flag("enable").unwrap_or(true);
        (enabled && !is_refused && self.errors() == errors).then_some(LinkConfig {
            settings: draft.settings,
            transport,
            clock,
        })
    }

    /// Whether the grammar has reported an error in it.
    fn is_refused(&self, element: &Element) -> bool {
        let span = element.span();
        self.diagnostics.iter().any(|found| {
            let is_here = found.source.as_ref().is_some_and(|source| source.name == element.source().name);
            found.is_error() && is_here && (span.start..=span.end).contains(&found.span.start)
        })
    }

    fn errors(&self) -> usize {
        self.diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count()
    }

    fn content(&mut self, element: &Element, draft: &mut PartialLink) {
        for child in element.children() {
            if child.is("send") {
                draft.settings.send.extend(self.send(child));
            } else if child.is("receive") {
                draft.settings.receive.extend(self.receive(child));
            } else if child.is("budget") {
                draft.settings.budget = self.budget(child);
            } else if child.is("connect") {
                draft.endpoints.connect.extend(self.endpoint(child, false));
            } else if child.is("listen") {
                draft.endpoints.listen.extend(self.endpoint(child, true));
            } else if child.is("certificates") {
                draft.endpoints.certificates = self.certificates(child);
            }
        }
        // Topics that are wrong are reported themselves.
        if !element.children().iter().any(|child| child.is("send") || child.is("receive")) {
            let message = "the link neither sends nor receives anything";
            let hint = "add topics: `<send topics=\"soccer/*\"/>`, `<receive topics=\"soccer/ball\"/>`";
            self.diagnostics.push(element.error("E0330", element.name_span(), message).with_hint(hint));
        }
    }

    fn send(&mut self, element: &Element) -> Option<SendRule> {
        let values = Values::of(element, self.grammar);
        let words = [("reliable", Reliability::Reliable), ("best_effort", Reliability::BestEffort)];
        let reliability = values.word("reliability", &words).unwrap_or_default();
        let priority = values.number("priority")?;
        let topics = values.given("topics")?;
        Some(SendRule { topics: self.pattern(element, topics)?, reliability, priority })
    }

    fn receive(&mut self, element: &Element) -> Option<ReceiveRule> {
        let values = Values::of(element, self.grammar);
        let index =
            values.word("as", &[("other", PublishAs::Other), ("own", PublishAs::Own)]).unwrap_or_default();
        let topics = values.given("topics")?;
        Some(ReceiveRule { topics: self.pattern(element, topics)?, publish_as: index })
    }

    /// A pattern that matches a topic of the program.
    fn pattern(&mut self, element: &Element, topics: &Attribute) -> Option<String> {
        let hub = self.hub(element)?;
        match hub.matching(&topics.value) {
            Ok(_) => Some(topics.value.clone()),
            Err(error) => {
                self.diagnostics.push(topics.error("E0331", error.to_string()));
                None
            }
        }
    }

    /// A hub with the topics of the program, for look-ups.
    fn hub(&mut self, element: &Element) -> Option<Hub> {
        let hub = Hub::with_linked_topics("configuration");
        hub.map_err(|error| {
            self.diagnostics.push(element.error("E0331", element.name_span(), error.to_string()))
        })
        .ok()
    }

    fn budget(&mut self, element: &Element) -> Option<SendBudget> {
        let values = Values::of(element, self.grammar);
        let (profile, robots) = (values.word("profile", &PROFILES), values.number::<u32>("robots"));
        let (packets, payload) = (values.number("packets"), values.number("payload"));
        let window = values.duration("window");
        match (profile, packets, window, payload) {
            (Some((packets, seconds, payload)), None, None, None) => {
                let length = Duration::from_secs(seconds);
                Some(SendBudget::of_game(packets, length, robots.unwrap_or(1), payload))
            }
            (None, Some(packets), Some(window), Some(payload)) if robots.is_none() => {
                Some(SendBudget { packets, window, payload })
            }
            _ => {
                let message = "a budget is a profile, or `packets`, `window` and `payload`";
                let hint = "`<budget profile=\"spl\" robots=\"5\"/>`, or `<budget packets=\"240\" window=\"20min\" payload=\"128\"/>`";
                self.diagnostics.push(element.error("E0332", element.name_span(), message).with_hint(hint));
                None
            }
        }
    }

    /// An endpoint; a port alone is local to this computer.
    fn endpoint(&mut self, element: &Element, listens: bool) -> Option<String> {
        let text = element.text();
        if listens && text.parse::<u16>().is_ok() {
            return Some(format!("tcp/127.0.0.1:{text}"));
        }
        if is_endpoint(text) {
            return Some(text.to_owned());
        }
        let message = format!("`{text}` is not an endpoint");
        let hint = match listens {
            true => {
                "`tcp/127.0.0.1:7447` or `tls/0.0.0.0:7447`; a port alone, such as `7447`, is local to this computer"
            }
            false => "`tcp/192.168.1.20:7447` or `tls/robot_2:7447`",
        };
        self.diagnostics.push(element.error("E0333", element.text_span(), message).with_hint(hint));
        None
    }

    fn certificates(&mut self, element: &Element) -> Option<Certificates> {
        let values = Values::of(element, self.grammar);
        let [authority, certificate, key] =
            ["authority", "certificate", "key"].map(|key| self.file(values.given(key)?));
        Some(Certificates { authority: authority?, certificate: certificate?, key: key? })
    }

    /// A named file; it must exist.
    fn file(&mut self, named: &Attribute) -> Option<PathBuf> {
        match paths::locate(self.path, &named.value) {
            Ok(found) => Some(found),
            Err(hint) => {
                let diagnostic = named.error("E0316", format!("no file `{}`", named.value));
                self.diagnostics.push(match hint {
                    Some(hint) => diagnostic.with_hint(format!("did you mean `{hint}`?")),
                    None => diagnostic,
                });
                None
            }
        }
    }

    fn access(&mut self, named: &Attribute) -> Option<AccessList> {
        let found = self.file(named)?;
        let source = paths::read(&found).map_err(|unread| self.diagnostics.push(*unread)).ok()?;
        let (list, errors) = AccessList::parse(&source.text);
        for error in errors {
            let line = line_span(&source.text, error.line);
            let message = format!("access: {}", error.message);
            self.diagnostics.push(Diagnostic::error("E0334", line, message).in_source(&source));
        }
        Some(list)
    }

    /// Reports settings that do not apply to the transport.
    fn misplaced(&mut self, element: &Element, zenoh: bool) {
        let keys: &[&str] = if zenoh { &["folder"] } else { &["realm", "scouting", "shared_memory"] };
        let transport = if zenoh { "zenoh" } else { "local" };
        for given in element.attributes() {
            if keys.iter().any(|key| given.is(key)) {
                let message = format!("`{}` has no effect with the transport `{transport}`", given.name);
                let hint = match zenoh {
                    true => "a `folder` is for `transport=\"local\"`",
                    false => "use `transport=\"zenoh\"` to reach other computers",
                };
                self.diagnostics.push(given.name_error("E0335", message).with_hint(hint));
            }
        }
        for child in element.children().iter().filter(|_| !zenoh) {
            if OF_ZENOH.iter().any(|name| child.is(name)) {
                let message = format!("`<{}>` has no effect with the transport `local`", child.name());
                let hint = "use `transport=\"zenoh\"` to reach other computers";
                self.diagnostics.push(element.error("E0335", child.name_span(), message).with_hint(hint));
            }
        }
    }

    /// Reports errors found by the link itself, if its settings are valid individually.
    fn contradictions(&mut self, element: &Element, settings: &LinkSettings, errors: usize) {
        if self.errors() > errors {
            return;
        }
        let Some(hub) = self.hub(element) else { return };
        if let Err(error) = HubBridge::new(&hub, settings.clone(), 0) {
            self.diagnostics.push(element.error("E0336", element.name_span(), error.to_string()));
        }
    }

    fn zenoh(
        &mut self,
        element: &Element,
        endpoints: ZenohEndpoints,
        access: &AccessList,
        errors: usize,
    ) -> LinkTransport {
        self.lacking_zenoh(element);
        if endpoints.listen.is_empty() && endpoints.connect.is_empty() && !endpoints.scouting {
            let message = "the link neither listens nor connects, and discovery is off";
            let hint =
                "add `<listen>7447</listen>`, `<connect>tcp/192.168.1.20:7447</connect>` or `scouting=\"1\"`";
            self.diagnostics.push(element.error("E0333", element.name_span(), message).with_hint(hint));
        }
        let secured = |endpoint: &String| endpoint.starts_with("tls/");
        let is_secured = endpoints.listen.iter().chain(&endpoints.connect).any(secured);
        if is_secured && endpoints.certificates.is_none() {
            let message = "an endpoint starts with `tls/`, but the link has no certificates";
            let hint =
                "`<certificates authority=\"team.pem\" certificate=\"robot_1.pem\" key=\"robot_1.key\"/>`";
            self.diagnostics.push(element.error("E0333", element.name_span(), message).with_hint(hint));
        }
        let open = endpoints.listen.iter().chain(&endpoints.connect).find(|endpoint| !secured(endpoint));
        if let (Some(open), Some(_)) = (open, &endpoints.certificates) {
            let message = format!("the link has certificates, but its endpoint `{open}` does not use them");
            let hint = "endpoints with certificates start with `tls/`";
            self.diagnostics.push(element.error("E0333", element.name_span(), message).with_hint(hint));
        }
        if self.errors() == errors {
            self.unusable(element, &endpoints, access);
        }
        LinkTransport::Zenoh(endpoints)
    }

    /// The program is built without zenoh.
    #[cfg(not(feature = "zenoh"))]
    fn lacking_zenoh(&mut self, element: &Element) {
        let message = "this program was built without the transport `zenoh`";
        let hint = "build it with `--features zenoh`, or use `transport=\"local\"` on one computer";
        self.diagnostics.push(match element.attribute("transport") {
            Some(given) => given.error("E0337", message).with_hint(hint),
            None => element.error("E0337", element.name_span(), message).with_hint(hint),
        });
    }

    #[cfg(feature = "zenoh")]
    fn lacking_zenoh(&mut self, _: &Element) {}

    /// Reports errors found by zenoh: certificate files without certificates.
    #[cfg(feature = "zenoh")]
    fn unusable(&mut self, element: &Element, endpoints: &ZenohEndpoints, access: &AccessList) {
        if let Err(error) = endpoints.settings().check(access) {
            self.diagnostics.push(element.error("E0336", element.name_span(), error.to_string()));
        }
    }

    #[cfg(not(feature = "zenoh"))]
    fn unusable(&mut self, _: &Element, _: &ZenohEndpoints, _: &AccessList) {}
}

/// `tcp/HOST:PORT` or `tls/HOST:PORT`: the transports that zenoh is built with here.
fn is_endpoint(text: &str) -> bool {
    let Some((protocol, address)) = text.split_once('/') else { return false };
    let Some((host, port)) = address.rsplit_once(':') else { return false };
    ["tcp", "tls"].contains(&protocol) && !host.is_empty() && port.parse::<u16>().is_ok()
}

/// The span of a line, counted from 1.
fn line_span(text: &str, line: usize) -> Span {
    let before: usize = text.split_inclusive('\n').take(line - 1).map(str::len).sum();
    let length = text[before..].lines().next().unwrap_or_default().len();
    Span::new(before, before + length)
}
