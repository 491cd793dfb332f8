//! Garbage into every entry point: an error or a result, never a panic, and never for long.
//!
//! `CLOSECALL_GARBAGE=600 cargo test --release --test garbage` throws it for ten minutes at each entry point; what makes one panic
//! is kept in target/tmp.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may")]

#[path = "common/entry_points.rs"]
mod entry_points;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use closecall_run::util::panics::caught;

/// What numbers are replaced by.
const NUMBERS: [&str; 20] = [
    "0",
    "-0",
    "-1",
    "1",
    "1e-300",
    "1e300",
    "-1e300",
    "NaN",
    "inf",
    "-inf",
    "1e8",
    "-1e8",
    "1e4",
    "0.01",
    "1000",
    "1e10",
    "9223372036854775808",
    "-1073741824",
    "",
    "18446744073709551616",
];
/// Nothing that is read takes longer.
const LONGEST: Duration = Duration::from_secs(5);

/// The examples of an entry point.
fn examples(entry_point: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fuzz").join(entry_point);
    let mut files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<PathBuf>>();
    files.sort();
    files.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// One change of some bytes.
fn change(random: &mut fastrand::Rng, bytes: &mut Vec<u8>, other: &[u8]) {
    let place = |random: &mut fastrand::Rng, bytes: &[u8]| random.usize(..=bytes.len());
    let at = place(random, bytes);
    let to = (at + random.usize(..40)).min(bytes.len());
    match random.u8(..8) {
        0 if at < bytes.len() => bytes[at] = random.u8(..),
        1 if at < bytes.len() => bytes[at] ^= 1 << random.u8(..8),
        2 => drop(bytes.drain(at..to)),
        3 => {
            let part = bytes[at..to].to_vec();
            bytes.splice(at..at, part.repeat(random.usize(1..4)));
        }
        4 => {
            let from = place(random, other);
            let part = other[from..(from + random.usize(..200)).min(other.len())].to_vec();
            bytes.splice(at..to, part);
        }
        _ => {
            // A whole number, with its sign and exponent, as the likeliest to matter.
            let is_number = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
            let Some(begin) = bytes[at..].iter().position(u8::is_ascii_digit).map(|begin| at + begin) else { return };
            let begin = begin - bytes[..begin].iter().rev().take_while(|byte| is_number(byte)).count();
            let end = begin + bytes[begin..].iter().take_while(|byte| is_number(byte)).count();
            bytes.splice(begin..end, NUMBERS[random.usize(..NUMBERS.len())].bytes());
        }
    }
}

#[test]
fn garbage_is_an_error_or_a_result_and_no_panic() {
    // Some panics are caught on purpose: those of the library that reads Parquet.
    closecall_cli::keep_panics_quiet();
    let each = std::env::var("CLOSECALL_GARBAGE").ok().and_then(|seconds| seconds.parse().ok());
    let each = each.map_or(Duration::from_millis(60), Duration::from_secs);
    let only = std::env::var("CLOSECALL_DOOR").ok();
    for (name, entry_point) in
        entry_points::ALL.into_iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name))
    {
        let examples = examples(name);
        examples.iter().for_each(|example| entry_point(example));
        let mut random = fastrand::Rng::with_seed(each.as_secs());
        let (began, mut thrown) = (Instant::now(), 0);
        while began.elapsed() < each {
            let mut bytes = examples[random.usize(..examples.len())].clone();
            for _ in 0..random.usize(1..6) {
                let other = &examples[random.usize(..examples.len())];
                change(&mut random, &mut bytes, other);
            }
            let before = Instant::now();
            let panicked = caught(|| entry_point(&bytes)).err();
            if panicked.is_some() || before.elapsed() > LONGEST {
                let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("garbage-{name}"));
                std::fs::write(&kept, &bytes).unwrap();
                let why = panicked.map_or_else(|| "too long".to_owned(), |panic| panic.to_string());
                println!("{name}: {} after {:.1?}: {why}", kept.display(), before.elapsed());
                panic!("{why}");
            }
            thrown += 1;
        }
        println!("{name}: {thrown} thrown");
    }
}
