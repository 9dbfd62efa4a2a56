//! Findings about this machine.

use serde::Serialize;
use thiserror::Error;

/// One thing about this machine that decides how well it keeps time.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Subject of the finding.
    pub what: &'static str,
    /// True if it is as a control loop needs it.
    pub good: bool,
    /// Setting or value that was found.
    pub found: String,
    /// Recommended change; `None`: none.
    pub change: Option<String>,
}

impl Finding {
    /// As it should be.
    pub(crate) fn good(what: &'static str, found: impl Into<String>) -> Self {
        Self { what, good: true, found: found.into(), change: None }
    }

    /// Not as it should be.
    pub(crate) fn bad(
        what: &'static str,
        found: impl Into<String>,
        change: impl Into<String>,
    ) -> Self {
        Self { what, good: false, found: found.into(), change: Some(change.into()) }
    }
}

/// Why this system keeps no time for a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SystemError {
    /// It is not Linux.
    #[error("real time is for Linux; on this system a drive runs in lock-step only")]
    NotLinux,
}

/// Returns true if a kernel is fully preemptible, by either sign: `/sys/kernel/realtime` holds `1` (up to
/// Linux 6.11), or the version that `uname -v` prints names `PREEMPT_RT` (since the option is in the
/// mainline, 6.12, the only sign).
///
/// ```
/// use phihat_drive::is_preempt_rt;
///
/// assert!(is_preempt_rt(Some("1\n"), "#1 SMP PREEMPT Debian 5.10"));
/// assert!(is_preempt_rt(None, "#1 SMP PREEMPT_RT Debian 6.12.41-1"));
/// assert!(!is_preempt_rt(Some("0\n"), "#1 SMP PREEMPT_DYNAMIC Debian 6.12.41-1"));
/// ```
pub fn is_preempt_rt(sys_kernel_realtime: Option<&str>, version: &str) -> bool {
    let by_file = sys_kernel_realtime.is_some_and(|text| text.trim() == "1");
    by_file || version.split_whitespace().any(|word| word == "PREEMPT_RT")
}
