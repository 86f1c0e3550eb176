//! Scheduling of a thread by the system: real-time scheduling and the permitted cores, where the
//! system allows them.
//!
//! The result is verified afterwards, since a system may report success and do something else.
//! Refusals are reported in one line, and the thread continues without the refused settings.

use monas_core::scheduling::Scheduling;

/// Applies the settings to the calling thread. Returns what the system does not grant.
pub(crate) fn apply(wanted: &Scheduling, was: &Scheduling) -> Vec<String> {
    let mut refused = Vec::new();
    if wanted.real_time || was.real_time {
        refused.extend(system::schedule(wanted).err());
    }
    if wanted.cores != was.cores {
        refused.extend(system::pin(&wanted.cores).err());
    }
    refused
}

/// Whether the system grants real-time scheduling with this priority, from 1 to 99: a short-lived
/// thread requests it.
pub fn permits_real_time(priority: u8) -> bool {
    let wanted = Scheduling { priority: priority.into(), real_time: true, ..Scheduling::default() };
    let tried = std::thread::Builder::new().spawn(move || system::schedule(&wanted).is_ok());
    tried.is_ok_and(|thread| thread.join().unwrap_or(false))
}

#[cfg(target_os = "linux")]
mod system {
    use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
    use thread_priority::unix::{
        NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id, thread_schedule_policy_param,
    };
    use thread_priority::{ThreadPriority, ThreadPriorityOsValue, ThreadPriorityValue};

    use super::Scheduling;

    /// The priorities of the system's real-time scheduling.
    const REAL_TIME_PRIORITIES: std::ops::RangeInclusive<i32> = 1..=99;

    pub(crate) fn schedule(wanted: &Scheduling) -> Result<(), String> {
        let level = wanted.priority.clamp(*REAL_TIME_PRIORITIES.start(), *REAL_TIME_PRIORITIES.end());
        let (policy, priority) = match wanted.real_time {
            true => {
                let value = ThreadPriorityValue::try_from(level as u8).map_err(|error| error.to_string())?;
                (
                    ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
                    ThreadPriority::Crossplatform(value),
                )
            }
            false => {
                let priority = ThreadPriority::Os(ThreadPriorityOsValue::default());
                (ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Other), priority)
            }
        };
        let thread = thread_native_id();
        set_thread_priority_and_policy(thread, priority, policy).map_err(|error| {
            let hint = "allow it with `ulimit -r 99` or CAP_SYS_NICE";
            format!("real-time scheduling is not permitted ({error}): its thread is scheduled like any other; {hint}")
        })?;
        match thread_schedule_policy_param(thread) {
            Ok((is, _)) if is == policy => Ok(()),
            Ok((is, _)) => Err(format!("the system accepted the scheduling {policy:?} but uses {is:?}")),
            Err(error) => Err(format!("the scheduling cannot be read: {error}")),
        }
    }

    pub(crate) fn pin(cores: &[usize]) -> Result<(), String> {
        let mut wanted = CpuSet::new();
        match cores {
            [] => (0..CpuSet::MAX_CPU).for_each(|core| wanted.set(core)),
            cores => cores.iter().filter(|core| **core < CpuSet::MAX_CPU).for_each(|core| wanted.set(*core)),
        }
        sched_setaffinity(None, &wanted).map_err(|error| {
            format!("it cannot be bound to the cores {cores:?} ({error}): it runs on any")
        })?;
        let is = sched_getaffinity(None).map_err(|error| format!("its cores cannot be read: {error}"))?;
        match cores.iter().all(|core| is.is_set(*core))
            && (cores.is_empty() || is.count() as usize <= cores.len())
        {
            true => Ok(()),
            false => Err(format!("the system accepted the cores {cores:?} but does not use them")),
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use super::Scheduling;

    pub(crate) fn schedule(_: &Scheduling) -> Result<(), String> {
        Err("real-time scheduling needs Linux: its thread is scheduled like any other".into())
    }

    pub(crate) fn pin(_: &[usize]) -> Result<(), String> {
        Err("binding threads to cores needs Linux: it runs on any".into())
    }
}
