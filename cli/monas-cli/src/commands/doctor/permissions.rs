//! Checks of the user's permissions.

use std::path::PathBuf;

use super::CheckResult;

const AREA: &str = "permissions";

/// The bit of CAP_SYS_NICE, the capability that the limit of priorities does not concern.
const SYS_NICE: u32 = 23;

pub(crate) fn findings() -> Vec<CheckResult> {
    vec![real_time(), sockets(folder())]
}

/// Whether threads may use real-time scheduling.
fn real_time() -> CheckResult {
    real_time_by(monas::permits_real_time, || {
        let read = |file| std::fs::read_to_string(file).unwrap_or_default();
        match is_privileged(&read("/proc/self/status")) {
            true => Some(99),
            false => priority(&read("/proc/self/limits")),
        }
    })
}

/// The highest permitted priority, found by trying from the highest that the limits allow: the
/// system decides, since the limits do not concern privileged users.
fn real_time_by(permits: impl Fn(u8) -> bool, limit: impl Fn() -> Option<u64>) -> CheckResult {
    let max = match permits(99) {
        true => Some(99),
        false => limit().map(|limit| if permits(1) { limit } else { 0 }),
    };
    match max {
        Some(0) => CheckResult::warning(
            AREA,
            "real-time scheduling is not permitted: agents with is_real_time run as ordinary threads",
            "as root write `@realtime - rtprio 99` into /etc/security/limits.conf and join that group",
        ),
        Some(max) => CheckResult::ok(AREA, format!("real-time scheduling up to priority {max}")),
        None => CheckResult::warning(
            AREA,
            "permission for real-time scheduling is unknown",
            "it can be read on Linux only",
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

/// Whether a process, by its status, has CAP_SYS_NICE, as root usually has.
fn is_privileged(status: &str) -> bool {
    let capabilities = status.lines().find_map(|line| line.strip_prefix("CapEff:"));
    let capabilities = capabilities.and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok());
    capabilities.is_some_and(|bits| bits >> SYS_NICE & 1 == 1)
}

/// The folder of control sockets.
#[cfg(unix)]
fn folder() -> Result<PathBuf, String> {
    let folder = monas_link::default_folder().map_err(|error| error.to_string())?;
    // A run creates it.
    Ok(if folder.is_dir() { folder } else { folder.parent().unwrap_or(&folder).to_path_buf() })
}

#[cfg(not(unix))]
fn folder() -> Result<PathBuf, String> {
    Err("they exist only on Unix".into())
}

/// Whether a run can create a control socket.
fn sockets(folder: Result<PathBuf, String>) -> CheckResult {
    let hint = "set XDG_RUNTIME_DIR to a private folder of this user, where `monas topic` finds runs";
    let folder = match folder {
        Ok(folder) => folder,
        Err(reason) => return CheckResult::warning(AREA, format!("no control sockets: {reason}"), hint),
    };
    match tempfile::Builder::new().prefix("monas-doctor").tempfile_in(&folder) {
        Ok(_) => CheckResult::ok(AREA, format!("control sockets in {}", folder.display())),
        Err(error) => {
            CheckResult::warning(AREA, format!("no control sockets: {}: {error}", folder.display()), hint)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::doctor::CheckStatus;

    #[test]
    fn limits_are_read() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units\n\
                      Max realtime priority     95                   95\n";
        assert_eq!(priority(limits), Some(95));
        assert_eq!(priority(&limits.replace("95", "unlimited")), Some(99));
        assert_eq!(priority(""), None);
    }

    #[test]
    fn what_the_system_grants_decides() {
        let by = |granted: u8, limit| real_time_by(|priority| priority <= granted, || limit);
        assert_eq!((by(99, Some(0)).state, by(99, None).state), (CheckStatus::Ok, CheckStatus::Ok));
        assert_eq!(by(40, Some(40)).state, CheckStatus::Ok);
        let refused = [by(0, Some(0)), by(0, Some(99)), by(0, None)];
        assert!(refused.iter().all(|found| found.state == CheckStatus::Warning));
        // The report agrees with the permissions of this process.
        assert_eq!(real_time().state == CheckStatus::Ok, monas::permits_real_time(1));
    }

    #[test]
    fn root_needs_no_limit() {
        assert!(is_privileged("Name:\tmonas\nCapEff:\t000001ffffffffff\n"));
        assert!(
            !is_privileged("CapEff:\t0000000000000000\n") && !is_privileged("CapEff:\t000001ffff7fffff\n")
        );
        assert!(!is_privileged(""));
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_reported() {
        assert_eq!(sockets(Err("none".into())).state, CheckStatus::Warning);
        assert_eq!(sockets(Ok(PathBuf::from("/nowhere"))).state, CheckStatus::Warning);
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(sockets(Ok(folder.path().to_path_buf())).state, CheckStatus::Ok);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
    }
}
