//! Wrong if a record is lost or invented by a crash, or the answer depends on threads or interruptions.

use std::fs;
use std::path::{Path, PathBuf};

use phihat_campaign::{Journal, JournalError, RunEnded, run_all};

fn file(name: &str) -> PathBuf {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join("journal");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    let _ = fs::remove_file(&path);
    path
}

fn ids(count: usize) -> Vec<String> {
    (0..count).map(|i| format!("run-{i}")).collect()
}

/// Numbers that do not survive a careless round trip.
fn work(i: usize) -> Vec<f64> {
    assert!(i != 7, "seven is unlucky");
    (0..5).map(|k| ((i * 31 + k) as f64).sqrt() / 3.0).collect()
}

fn answer(path: &Path, threads: usize) -> Vec<RunEnded<Vec<f64>>> {
    run_all(&ids(40), &mut Journal::open(path).unwrap(), threads, &work, |_| ()).unwrap()
}

#[test]
fn records_are_in_order_and_the_same_for_any_number_of_threads() {
    let one = answer(&file("one"), 1);
    assert_eq!(one.len(), 40);
    assert_eq!(one[3], RunEnded::With(work(3)));
    assert_eq!(one[7], RunEnded::Panicked("seven is unlucky".to_owned()));
    for threads in [2, 8, 100] {
        assert_eq!(answer(&file(&format!("threads-{threads}")), threads), one);
    }
}

#[test]
fn a_journal_cut_at_any_byte_is_completed_to_the_same_answer() {
    let whole = file("whole");
    let expected = answer(&whole, 2);
    let bytes = fs::read(&whole).unwrap();
    let cut = file("cut");
    for at in (0..bytes.len()).step_by(211) {
        fs::write(&cut, &bytes[..at]).unwrap();
        let journal = Journal::open(&cut).unwrap();
        let lines = bytes[..at].split(|byte| *byte == b'\n').count() - 1;
        // A line that lacks nothing but its line feed is whole.
        assert!((lines..=lines + 1).contains(&journal.len()), "{at}");
        drop(journal);
        assert_eq!(answer(&cut, 2), expected, "cut at {at}");
        assert_eq!(Journal::open(&cut).unwrap().len(), 40);
    }
}

#[test]
fn a_flipped_byte_costs_one_record_and_never_invents_one() {
    let path = file("flipped");
    let expected = answer(&path, 2);
    let bytes = fs::read(&path).unwrap();
    for at in (0..bytes.len()).step_by(401) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 0x04;
        fs::write(&path, &flipped).unwrap();
        let journal = Journal::open(&path).unwrap();
        assert!(!journal.damaged().is_empty() && journal.len() <= 39, "{at}");
        assert!(journal.len() >= 38, "{at}: a flipped line feed joins two lines, no more");
        drop(journal);
        assert_eq!(answer(&path, 2), expected, "flipped at {at}");
    }
}

#[test]
fn damaged_lines_are_told_by_their_numbers() {
    let path = file("damage");
    answer(&path, 2);
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(Journal::open(&path).unwrap().damage(), None);
    let with_damage = |at: &[usize]| {
        let lines = text.lines().enumerate();
        let lines: Vec<_> =
            lines.map(|(k, line)| if at.contains(&(k + 1)) { "{}" } else { line }).collect();
        fs::write(&path, lines.join("\n") + "\n").unwrap();
        let journal = Journal::open(&path).unwrap();
        assert_eq!(journal.damaged(), at);
        journal.damage().unwrap()
    };
    assert!(with_damage(&[3]).starts_with("line 3 is damaged"));
    assert!(with_damage(&[3, 17]).starts_with("lines 3, 17 are damaged"));
    let many: Vec<_> = (1..=12).collect();
    assert!(with_damage(&many).starts_with("lines 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 and 2 more are"));
}

#[test]
fn two_campaigns_cannot_write_to_one_journal() {
    let path = file("busy");
    let first = Journal::open(&path).unwrap();
    let second = Journal::open(&path);
    assert!(matches!(second, Err(JournalError::Busy(_))), "{second:?}");
    drop(first);
    assert!(Journal::open(&path).is_ok());
}

#[test]
fn only_what_is_missing_is_done() {
    let path = file("missing");
    let half = &ids(40)[..20];
    let count = std::sync::atomic::AtomicUsize::new(0);
    let counted = |i: usize| {
        count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        i
    };
    run_all(half, &mut Journal::open(&path).unwrap(), 2, &counted, |_| ()).unwrap();
    let mut seen = Vec::new();
    let mut journal = Journal::open(&path).unwrap();
    run_all(&ids(40), &mut journal, 2, &counted, |p| seen.push(p.done)).unwrap();
    assert_eq!(count.into_inner(), 40);
    assert_eq!(seen, (20..=40).collect::<Vec<_>>());
}

#[test]
fn ids_are_compared_in_no_time_and_short_runs_share_their_way_to_the_disk() {
    let path = file("many");
    let count = 50_000;
    // Every id twice; two by two they are one run. Compared one with all, or synced one by one, this takes minutes.
    let twice: Vec<String> = (0..count).map(|i| format!("run-{}", i / 2)).collect();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let work = |i: usize| {
        done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        i / 2
    };
    let ended = run_all(&twice, &mut Journal::open(&path).unwrap(), 2, &work, |_| ()).unwrap();
    assert_eq!(done.into_inner(), count / 2);
    assert!(ended.iter().enumerate().all(|(i, ended)| *ended == RunEnded::With(i / 2)));
}

#[test]
fn a_group_is_recorded_whole_or_told() {
    let path = file("group");
    let mut journal = Journal::open(&path).unwrap();
    let runs: Vec<(String, usize)> = (0..300).map(|i| (format!("run-{i}"), i)).collect();
    journal.append_all(runs.iter().map(|(id, i)| (id.as_str(), i))).unwrap();
    drop(journal);
    let journal = Journal::open(&path).unwrap();
    assert_eq!((journal.len(), journal.entry("run-299")), (300, Some("299")));
}
