//! What this user may do.

use std::path::Path;

use super::Finding;

const AREA: &str = "permissions";

pub(super) fn findings() -> Vec<Finding> {
    vec![real_time(), sockets(std::env::var_os("XDG_RUNTIME_DIR").as_deref().map(Path::new))]
}

/// Whether threads may be scheduled in real time.
fn real_time() -> Finding {
    match std::fs::read_to_string("/proc/self/limits").ok().as_deref().and_then(priority) {
        Some(0) => Finding::odd(
            AREA,
            "real-time scheduling is not permitted: agents with is_real_time run as ordinary threads",
            "as root write `@realtime - rtprio 99` into /etc/security/limits.conf and join that group",
        ),
        Some(most) => Finding::well(AREA, format!("real-time scheduling up to priority {most}")),
        None => Finding::odd(
            AREA,
            "whether real-time scheduling is permitted cannot be seen",
            "only Linux says it",
        ),
    }
}

/// The highest real-time priority that the limits of a process allow.
fn priority(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max realtime priority"))?;
    match line.split_whitespace().next()? {
        "unlimited" => Some(99),
        number => number.parse().ok(),
    }
}

/// Whether a run can have a control socket.
fn sockets(folder: Option<&Path>) -> Finding {
    let hint = "XDG_RUNTIME_DIR names a folder of yours alone; without it `monas topic` finds no run";
    let Some(folder) = folder else {
        return Finding::odd(AREA, "no control sockets: XDG_RUNTIME_DIR is not set", hint);
    };
    match tempfile::Builder::new().prefix("monas-doctor").tempfile_in(folder) {
        Ok(_) => Finding::well(AREA, format!("control sockets in {}", folder.join("monas").display())),
        Err(error) => Finding::odd(AREA, format!("no control sockets: {}: {error}", folder.display()), hint),
    }
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::*;

    #[test]
    fn limits_are_read() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units\n\
                      Max realtime priority     95                   95\n";
        assert_eq!(priority(limits), Some(95));
        assert_eq!(priority(&limits.replace("95", "unlimited")), Some(99));
        assert_eq!(priority(""), None);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_told() {
        assert_eq!(sockets(None).state, State::Odd);
        assert_eq!(sockets(Some(Path::new("/nowhere"))).state, State::Odd);
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(sockets(Some(folder.path())).state, State::Well);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
    }
}
