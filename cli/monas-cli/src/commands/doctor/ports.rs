//! Checks of the ports that the links of a configuration listen on.

use std::collections::BTreeSet;

use monas::config::{self, Element, Layers};

use super::{CheckResult, DoctorArguments};
use crate::input::grammar;

const AREA: &str = "ports";

pub(crate) fn findings(arguments: &DoctorArguments) -> Vec<CheckResult> {
    if !arguments.has_configuration() {
        return Vec::new();
    }
    let resolved = config::resolve(&arguments.config, &grammar(), &Layers::new());
    let mut wanted = BTreeSet::new();
    resolved.elements.iter().for_each(|element| listened(element, &mut wanted));
    if wanted.is_empty() {
        return vec![CheckResult::ok(AREA, "no link listens on a port")];
    }
    let tables: Vec<String> = ["/proc/net/tcp", "/proc/net/tcp6"]
        .into_iter()
        .filter_map(|path| std::fs::read_to_string(path).ok())
        .collect();
    match tables.is_empty() {
        true => {
            vec![CheckResult::warning(AREA, "the state of ports is unknown", "it can be read on Linux only")]
        }
        false => wanted.into_iter().map(|port| finding(port, &tables)).collect(),
    }
}

/// Collects the ports of all `<listen>` elements below an element.
fn listened(element: &Element, wanted: &mut BTreeSet<u16>) {
    if element.is("listen") {
        wanted.extend(element.text().rsplit(':').next().and_then(|port| port.parse::<u16>().ok()));
    }
    element.children().iter().for_each(|child| listened(child, wanted));
}

fn finding(port: u16, tables: &[String]) -> CheckResult {
    match tables.iter().any(|table| is_taken(port, table)) {
        true => CheckResult::error(
            AREA,
            format!("port {port} is taken by another program"),
            "`ss -ltnp` shows which",
        ),
        false => CheckResult::ok(AREA, format!("port {port} is free")),
    }
}

/// Whether a socket listens on a port, by a table of `/proc/net`.
fn is_taken(port: u16, table: &str) -> bool {
    table.lines().skip(1).any(|line| {
        let mut columns = line.split_whitespace().skip(1);
        let local = columns.next().and_then(|address| address.rsplit(':').next());
        let is_it = local.and_then(|port| u16::from_str_radix(port, 16).ok()) == Some(port);
        // 0A is the state LISTEN.
        is_it && columns.nth(1) == Some("0A")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid\n\
                         0: 0100007F:1D17 00000000:0000 0A 00000000:00000000 00:00000000 00000000  1000\n\
                         1: 0100007F:1D18 0100007F:1D17 01 00000000:00000000 00:00000000 00000000  1000\n";

    #[test]
    fn only_listeners_occupy_a_port() {
        assert!(is_taken(7447, TABLE));
        assert!(!is_taken(7448, TABLE) && !is_taken(80, TABLE));
    }
}
