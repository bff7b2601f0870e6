//! The priority of threads.

/// Puts this thread, and those that it starts, behind the window's: a driver that renders on the processor would keep
/// it waiting.
pub fn step_back() {
    // Linux counts it by thread. It may be refused, and only delays.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::setpriority_process(None, 10);
}
