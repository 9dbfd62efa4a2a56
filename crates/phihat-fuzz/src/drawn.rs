//! Bytes by the thousand, the same for the same seed.

use std::env;
use std::panic::{AssertUnwindSafe, catch_unwind};

use proptest::collection::vec;
use proptest::prelude::any;
use proptest::test_runner::{Config, RngSeed, TestCaseError, TestError, TestRunner};

/// Number of drawn cases without `PHIHAT_FUZZ_CASES`, and that with `PHIHAT_ALL`.
const CASES: u32 = 1_000;
const ALL_CASES: u32 = 5_000;

/// Plays up to `most` bytes, many times: `PHIHAT_FUZZ_CASES` sets the number, `PHIHAT_FUZZ_SEED` the seed.
///
/// # Errors
///
/// Message of the panic, and the shortest bytes found that cause it.
///
/// # Panics
///
/// A variable of the environment is not a number.
pub fn drawn(most: usize, play: impl Fn(&[u8])) -> Result<(), (String, Vec<u8>)> {
    let number = |name: &str| env::var(name).ok().map(|text| text.parse::<u32>());
    let cases = number("PHIHAT_FUZZ_CASES").unwrap_or(Ok(if env::var_os("PHIHAT_ALL").is_some() {
        ALL_CASES
    } else {
        CASES
    }));
    let seed = number("PHIHAT_FUZZ_SEED").unwrap_or(Ok(1));
    let (Ok(cases), Ok(seed)) = (cases, seed) else {
        panic!("PHIHAT_FUZZ_CASES and PHIHAT_FUZZ_SEED are numbers below 2³²")
    };
    let config = Config {
        cases,
        rng_seed: RngSeed::Fixed(u64::from(seed)),
        failure_persistence: None,
        ..Config::default()
    };
    let played = |bytes: Vec<u8>| {
        catch_unwind(AssertUnwindSafe(|| play(&bytes))).map_err(|panic| {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            TestCaseError::fail(text.unwrap_or_default())
        })
    };
    match TestRunner::new(config).run(&vec(any::<u8>(), 0..=most), played) {
        Ok(()) => Ok(()),
        Err(TestError::Fail(why, bytes)) => Err((why.to_string(), bytes)),
        Err(TestError::Abort(why)) => panic!("{why}"),
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::drawn;

    #[test]
    fn the_same_bytes_are_drawn_again() {
        let all = || {
            let seen = RefCell::new(Vec::new());
            drawn(40, |bytes| seen.borrow_mut().push(bytes.to_vec())).unwrap();
            seen.into_inner()
        };
        let first = all();
        assert!(first.len() >= 1000, "{}", first.len());
        assert_eq!(first, all());
    }

    #[test]
    fn what_breaks_is_found_and_cut_short() {
        let (why, bytes) = drawn(40, |bytes| assert!(!bytes.contains(&200), "200 is here"))
            .expect_err("one of many holds a 200");
        assert!(why.contains("200 is here"), "{why}");
        assert_eq!(bytes, [200]);
    }
}
