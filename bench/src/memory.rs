use std::fs;

/// Runs `work` and returns its result with the peak increase of resident memory, in bytes. The
/// increase is `None` if the system does not report it.
///
/// The whole process is measured, so nothing else may run at the same time.
pub fn peak_bytes<T>(work: impl FnOnce() -> T) -> (T, Option<u64>) {
    // Reset the recorded peak.
    let before = fs::write("/proc/self/clear_refs", "5").ok().and_then(|()| status("VmRSS:"));
    let result = work();
    let peak = before.and_then(|before| Some(status("VmHWM:")?.saturating_sub(before)));
    (result, peak)
}

/// Value in bytes of a line of `/proc/self/status`.
fn status(line: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let kibibytes = status.lines().find_map(|text| text.strip_prefix(line))?.trim().strip_suffix(" kB")?;
    Some(1024 * kibibytes.parse::<u64>().ok()?)
}

#[cfg(target_os = "linux")]
#[test]
fn touched_memory_is_counted() {
    let bytes = 64 << 20;
    let (_, peak) =
        peak_bytes(|| std::hint::black_box(vec![1_u8; bytes]).iter().map(|&byte| u64::from(byte)).sum::<u64>());
    let peak = peak.unwrap();
    // The system allocates whole pages, and other tests of this program use some memory too.
    assert!(peak > bytes as u64 - (1 << 20) && peak < 2 * bytes as u64, "{peak}");
}
