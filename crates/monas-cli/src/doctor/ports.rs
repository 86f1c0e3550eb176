//! Ports that the links of a configuration listen on.

use std::collections::BTreeSet;

use monas::config::{self, Element, Layers};

use super::Finding;
use crate::arguments::DoctorArguments;

const AREA: &str = "ports";

pub(super) fn findings(arguments: &DoctorArguments) -> Vec<Finding> {
    if !arguments.config.exists() {
        return Vec::new();
    }
    let resolved = config::resolve(&arguments.config, &monas_match::grammar(), &Layers::new());
    let mut wanted = BTreeSet::new();
    resolved.elements.iter().for_each(|element| listened(element, &mut wanted));
    if wanted.is_empty() {
        return vec![Finding::well(AREA, "no link listens on a port")];
    }
    let tables: Vec<String> = ["/proc/net/tcp", "/proc/net/tcp6"]
        .into_iter()
        .filter_map(|path| std::fs::read_to_string(path).ok())
        .collect();
    match tables.is_empty() {
        true => vec![Finding::odd(AREA, "whether ports are free cannot be seen", "only Linux says it")],
        false => wanted.into_iter().map(|port| finding(port, &tables)).collect(),
    }
}

/// The ports that links listen on, however deep they stand.
fn listened(element: &Element, wanted: &mut BTreeSet<u16>) {
    if element.is("listen") {
        wanted.extend(element.text().rsplit(':').next().and_then(|port| port.parse::<u16>().ok()));
    }
    element.children().iter().for_each(|child| listened(child, wanted));
}

fn finding(port: u16, tables: &[String]) -> Finding {
    match tables.iter().any(|table| is_taken(port, table)) {
        true => Finding::wrong(
            AREA,
            format!("port {port} is taken by another program"),
            "`ss -ltnp` says by which",
        ),
        false => Finding::well(AREA, format!("port {port} is free")),
    }
}

/// Whether somebody listens on a port, in the system's table of connections.
fn is_taken(port: u16, table: &str) -> bool {
    table.lines().skip(1).any(|line| {
        let mut columns = line.split_whitespace().skip(1);
        let local = columns.next().and_then(|address| address.rsplit(':').next());
        let is_it = local.and_then(|port| u16::from_str_radix(port, 16).ok()) == Some(port);
        // 0A: it listens.
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
    fn only_who_listens_takes_a_port() {
        assert!(is_taken(7447, TABLE));
        assert!(!is_taken(7448, TABLE) && !is_taken(80, TABLE));
    }
}
