//! Linux for a control thread: clock, FIFO scheduling, locked memory.

use std::fs;
use std::thread;

use rustix::mm::{MlockAllFlags, mlockall, munlockall};
use rustix::process::{Resource, getrlimit};
use rustix::system::uname;
use rustix::thread::{CpuSet, clock_nanosleep_absolute, sched_setaffinity};
use rustix::time::{ClockId, Timespec, clock_gettime};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use crate::finding::{Finding, SystemError, is_preempt_rt};

/// Priority in the FIFO class: above other programs and below the kernel's own threads.
const PRIORITY: u8 = 80;

/// A clock that wakes a loop at absolute times, so that a late sample does not make the next one late.
#[derive(Debug)]
pub(crate) struct HostClock {
    /// Time from one sample to the next \[ns\].
    period: u64,
    /// When the next sample is due \[ns\].
    due: u64,
    /// Delay of the last wake-up \[ns\].
    late: u64,
}

impl HostClock {
    #[expect(clippy::unnecessary_wraps, reason = "other systems have none")]
    pub(crate) fn new(period_ns: u64) -> Result<Self, SystemError> {
        Ok(Self { period: period_ns, due: now_ns(), late: 0 })
    }

    /// The first sample is due now.
    pub(crate) fn start(&mut self) {
        self.due = now_ns();
    }

    /// Sleeps until the next sample is due.
    pub(crate) fn wait(&mut self) {
        let due = self.due;
        #[expect(clippy::cast_possible_wrap, reason = "a time since the machine's start")]
        let until =
            Timespec { tv_sec: (due / 1_000_000_000) as i64, tv_nsec: (due % 1_000_000_000) as _ };
        // A signal cuts a sleep short.
        while now_ns() < due && clock_nanosleep_absolute(ClockId::Monotonic, &until).is_err() {}
        self.late = now_ns().saturating_sub(due);
        self.due = due + self.period;
    }

    #[expect(clippy::unused_self, reason = "the same on every system")]
    pub(crate) fn now_ns(&self) -> u64 {
        now_ns()
    }

    pub(crate) fn late_ns(&self) -> u64 {
        self.late
    }
}

fn now_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec.unsigned_abs() * 1_000_000_000 + now.tv_nsec.unsigned_abs()
}

/// Gives this thread FIFO priority, on one processor if requested, and locks the program's memory; returns
/// what was granted or refused.
pub(crate) fn enter(processor: Option<usize>) -> Vec<Finding> {
    let mut found = vec![fifo(), memory()];
    found.extend(processor.map(pinned));
    found
}

fn fifo() -> Finding {
    let what = "scheduling";
    let change = "allow FIFO: `rtprio 95` for this user in /etc/security/limits.conf, or CAP_SYS_NICE; in a container, \
        its option for real-time priorities";
    let Ok(value) = ThreadPriorityValue::try_from(PRIORITY) else {
        return Finding::bad(what, "no such priority", change);
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::Crossplatform(value);
    match set_thread_priority_and_policy(thread_native_id(), priority, policy) {
        Ok(()) => Finding::good(what, format!("FIFO, priority {PRIORITY}")),
        Err(why) => Finding::bad(what, format!("FIFO is refused: {why:?}"), change),
    }
}

fn memory() -> Finding {
    let what = "memory";
    match mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE) {
        Ok(()) => Finding::good(what, "locked"),
        Err(why) => {
            let limit = getrlimit(Resource::Memlock).current;
            let limit = limit.map_or("none".to_owned(), |bytes| format!("{} kB", bytes / 1024));
            let found = format!("cannot be locked: {why}; the limit is {limit}");
            let change =
                "`memlock unlimited` for this user in /etc/security/limits.conf, or CAP_IPC_LOCK";
            Finding::bad(what, found, change)
        }
    }
}

fn pinned(processor: usize) -> Finding {
    let what = "processor";
    let change = "a processor that this program may use: `taskset -p $$` lists them";
    if processor >= CpuSet::MAX_CPU {
        return Finding::bad(what, format!("there is no processor {processor}"), change);
    }
    let mut set = CpuSet::new();
    set.set(processor);
    match sched_setaffinity(None, &set) {
        Ok(()) => Finding::good(what, format!("{processor}")),
        Err(why) => Finding::bad(what, format!("{processor} is refused: {why}"), change),
    }
}

/// Findings about this machine's settings, without a measurement. Settings that are tried here are undone.
#[expect(clippy::unnecessary_wraps, reason = "other systems tell nothing")]
pub(crate) fn look() -> Result<Vec<Finding>, SystemError> {
    let tried = thread::scope(|scope| scope.spawn(|| vec![fifo(), memory()]).join());
    // It fails where nothing was locked, and there nothing is to be undone.
    let _ = munlockall();
    let mut found = vec![kernel()];
    found.extend(tried.unwrap_or_default());
    found.push(governor());
    Ok(found)
}

fn kernel() -> Finding {
    let file = fs::read_to_string("/sys/kernel/realtime").ok();
    let name = uname();
    let version = name.version().to_string_lossy();
    let release = name.release().to_string_lossy();
    if is_preempt_rt(file.as_deref(), &version) {
        return Finding::good("kernel", format!("{release}, PREEMPT_RT"));
    }
    let change = "a kernel with PREEMPT_RT: on Debian `linux-image-rt-amd64`, on Ubuntu `pro enable realtime-kernel`";
    Finding::bad("kernel", format!("{release}, without PREEMPT_RT"), change)
}

fn governor() -> Finding {
    let what = "processor frequency";
    let mut all = Vec::new();
    for entry in fs::read_dir("/sys/devices/system/cpu").into_iter().flatten().flatten() {
        let path = entry.path().join("cpufreq/scaling_governor");
        all.extend(fs::read_to_string(path).ok().map(|name| name.trim().to_owned()));
    }
    all.sort();
    all.dedup();
    match all.as_slice() {
        [] => Finding::good(what, "not told by this system"),
        [only] if only == "performance" => Finding::good(what, "governor `performance`"),
        other => Finding::bad(
            what,
            format!("governor `{}`", other.join("`, `")),
            "`cpupower frequency-set -g performance`",
        ),
    }
}
