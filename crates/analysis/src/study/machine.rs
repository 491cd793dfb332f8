//! On which machine a study ran.

/// The machine's name: its processor and how many threads it runs.
pub fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = information.lines().find(|line| line.starts_with("model name"));
    let model = model.and_then(|line| line.split_once(':')).map_or("unknown processor", |(_, name)| name.trim());
    format!("{model}, {threads} {}, {}", if threads == 1 { "thread" } else { "threads" }, std::env::consts::OS)
}
