use std::fs;

/// Runs `work`, and tells how many bytes more than before were in memory at its peak; `None` where the system does not say.
///
/// Counts the whole process: nothing else may run beside.
pub fn peak_bytes<T>(work: impl FnOnce() -> T) -> (T, Option<u64>) {
    // Forgets the peak that was.
    let before = fs::write("/proc/self/clear_refs", "5").ok().and_then(|()| status("VmRSS:"));
    let result = work();
    let peak = before.and_then(|before| Some(status("VmHWM:")?.saturating_sub(before)));
    (result, peak)
}

/// Bytes in a line of the status that Linux writes for this process.
fn status(line: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let kibibytes = status.lines().find_map(|text| text.strip_prefix(line))?.trim().strip_suffix(" kB")?;
    Some(1024 * kibibytes.parse::<u64>().ok()?)
}

#[cfg(target_os = "linux")]
#[test]
fn memory_that_is_touched_counts() {
    let bytes = 64 << 20;
    let (_, peak) =
        peak_bytes(|| std::hint::black_box(vec![1_u8; bytes]).iter().map(|&byte| u64::from(byte)).sum::<u64>());
    let peak = peak.unwrap();
    // The system takes whole pages, and other tests of this program take a little too.
    assert!(peak > bytes as u64 - (1 << 20) && peak < 2 * bytes as u64, "{peak}");
}
