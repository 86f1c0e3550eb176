//! Statistics of the links of a run.

use std::io::{self, Write};

use monas::LinkStatistics;
use monas_terminal::table;
use serde_json::{Value, json};

/// Writes a table of what was sent, one of what was received, and mismatches; nothing if there are
/// no links.
pub(crate) fn write(out: &mut dyn Write, links: &[LinkStatistics]) -> io::Result<()> {
    if links.is_empty() {
        return Ok(());
    }
    let header = ["link", "sent", "taken", "sent", "again", "dropped", "too large", "lost", "bytes"];
    writeln!(out, "{}\n", table::of_numbers(header, 2, links.iter().flat_map(sent)))?;
    let header =
        ["link", "received", "of", "arrived", "delivered", "twice", "late", "refused", "gaps", "bytes"];
    writeln!(out, "{}\n", table::of_numbers(header, 3, links.iter().flat_map(received)))?;
    for link in links {
        for difference in &link.report.mismatches {
            writeln!(out, "{}: differs from {}: {}", link.link, difference.host, difference.text)?;
        }
        let counters = &link.report.counters;
        if counters.strangers + counters.foreign + counters.malformed + counters.failed + link.report.overrun
            > 0
        {
            writeln!(
                out,
                "{}: packets of unknown senders {}, of other versions {}, malformed {}, not sent {}, over the limit {}",
                link.link,
                counters.strangers,
                counters.foreign,
                counters.malformed,
                counters.failed,
                link.report.overrun
            )?;
        }
        if counters.waits > 0 {
            writeln!(out, "{}: the bandwidth budget was exhausted {} times", link.link, counters.waits)?;
        }
    }
    Ok(())
}

fn sent(link: &LinkStatistics) -> Vec<[String; 9]> {
    let row = |(path, sent): &(String, monas_link::SentCounters)| {
        let figures =
            [sent.taken, sent.sent, sent.resent, sent.dropped, sent.oversize, sent.lost, sent.bytes];
        let [taken, went, again, dropped, oversize, lost, bytes] = figures.map(|figure| figure.to_string());
        [link.link.clone(), path.clone(), taken, went, again, dropped, oversize, lost, bytes]
    };
    link.report.counters.sent.iter().map(row).collect()
}

fn received(link: &LinkStatistics) -> Vec<[String; 10]> {
    let row = |(host, path, came): &(String, String, monas_link::ReceivedCounters)| {
        let figures =
            [came.arrived, came.delivered, came.duplicates, came.late, came.refused, came.gaps, came.bytes];
        let [arrived, delivered, twice, late, refused, gaps, bytes] =
            figures.map(|figure| figure.to_string());
        let (link, path, host) = (link.link.clone(), path.clone(), host.clone());
        [link, path, host, arrived, delivered, twice, late, refused, gaps, bytes]
    };
    link.report.counters.received.iter().map(row).collect()
}

/// For each link an object with its statistics, one for each sent topic, and one for each topic
/// received from a host.
pub(crate) fn objects(links: &[LinkStatistics]) -> Vec<Value> {
    links.iter().flat_map(of_link).collect()
}

fn of_link(link: &LinkStatistics) -> Vec<Value> {
    let LinkStatistics { host, link: name, report } = link;
    let counters = &report.counters;
    let differences: Vec<String> =
        report.mismatches.iter().map(|differs| format!("{}: {}", differs.host, differs.text)).collect();
    let peers: Vec<&str> = report.peers.iter().map(|(peer, ..)| peer.as_str()).collect();
    let all = json!({"kind": "link", "host": host, "link": name, "peers": peers, "packets": counters.packets,
        "failed": counters.failed, "malformed": counters.malformed, "strangers": counters.strangers,
        "foreign": counters.foreign, "waits": counters.waits, "overrun": report.overrun, "differences": differences});
    let sent = counters.sent.iter().map(|(path, sent)| {
        json!({"kind": "link_sent", "host": host, "link": name, "topic": path, "taken": sent.taken, "lost": sent.lost,
            "sent": sent.sent, "resent": sent.resent, "dropped": sent.dropped, "oversize": sent.oversize,
            "waiting": sent.waiting, "bytes": sent.bytes})
    });
    let received = counters.received.iter().map(|(from, path, came)| {
        json!({"kind": "link_received", "host": host, "link": name, "topic": path, "from": from,
            "arrived": came.arrived, "delivered": came.delivered, "duplicates": came.duplicates, "late": came.late,
            "refused": came.refused, "gaps": came.gaps, "held": came.held, "missing": came.missing,
            "bytes": came.bytes})
    });
    std::iter::once(all).chain(sent).chain(received).collect()
}
