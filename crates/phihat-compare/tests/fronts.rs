//! A small comparison at equal noise: its answer does not depend on the division into shards, and chance is
//! inside its own band.

use std::path::{Path, PathBuf};

use phihat_campaign::Shard;
use phihat_campaign::statistics::{Bootstrap, ErrorTable, ratio};
use phihat_compare::fronts::{
    AtCap, Fronts, FrontsAnswer, FrontsOptions, LoopKnowledge, Restart, Tier,
};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join(env!("CARGO_PKG_NAME"))
        .join(format!("fronts-{name}"));
    _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The arm of Table 1, as few of everything as there can be.
fn options(out: PathBuf, only: &[&str], per_scalar: u32) -> FrontsOptions {
    FrontsOptions {
        study: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies/table1.toml"),
        only: only.iter().map(|id| (*id).to_owned()).collect(),
        quick: true,
        caps: vec![0.01, 0.05],
        per_scalar: Some(per_scalar),
        worlds: Some([1, 1, 3]),
        threads: Some(2),
        out: Some(out),
        ..FrontsOptions::default()
    }
}

fn whole(options: &FrontsOptions) -> (Fronts, [Vec<u8>; 2]) {
    match options.run(&mut ()).unwrap() {
        FrontsAnswer::Whole { fronts, folder, page } => {
            (*fronts, [folder.join("fronts.json"), page].map(|file| std::fs::read(file).unwrap()))
        }
        FrontsAnswer::Shard { .. } => panic!("a shard"),
    }
}

/// In one process, in three parts that know nothing of each other, or cut off in the middle of a line: the same bytes.
#[test]
fn parts_and_interruptions_leave_the_same_bytes() {
    let only = ["pd", "proposed-1"];
    let (all, own) = (folder("all"), folder("parts"));
    let command_is_the_same = |mut files: [Vec<u8>; 2]| {
        files[1] = String::from_utf8(files[1].clone())
            .unwrap()
            .replace("fronts-parts", "fronts-all")
            .into_bytes();
        files
    };
    let (fronts, exact) = whole(&options(all.clone(), &only, 1));
    assert_eq!(fronts.laws.len(), 4);
    looser_is_no_worse(&fronts);
    let mut parts = options(own.clone(), &only, 1);
    for part in 1..=3 {
        let shard = Some(Shard { part, of: 3 });
        let answer =
            FrontsOptions { shard, threads: Some(1), ..parts.clone() }.run(&mut ()).unwrap();
        let FrontsAnswer::Shard { journal, searches } = answer else { panic!("a whole") };
        assert!(searches >= 2 && journal.ends_with(format!("shard-{part}-of-3/journal.jsonl")));
        parts.from.push(journal.parent().unwrap().to_owned());
    }
    assert!(command_is_the_same(whole(&parts).1) == exact);
    let journal = all.join("journal.jsonl");
    let bytes = std::fs::read(&journal).unwrap();
    std::fs::write(&journal, &bytes[..bytes.len() * 2 / 5]).unwrap();
    assert!(whole(&options(all, &only, 1)).1 == exact);
}

/// Laws that could run, but without gains that satisfy every constraint in training and follow in at least
/// one test world: one training world is little.
fn not_followed(fronts: &Fronts) -> Vec<String> {
    let mut without = Vec::new();
    // Its gains are for seven joints.
    let applies = |law: &str| !law.ends_with(" again") && law != "franka-ros-impedance";
    for point in fronts.points.iter().filter(|point| applies(&point.law)) {
        let told = |restart: &Restart| restart.failed.clone();
        let panicked = point.restarts.iter().filter_map(told).find(|why| why.contains("panicked"));
        assert!(panicked.is_none(), "{panicked:?}");
        let refused = point.restarts.iter().all(|restart| restart.failed.is_some());
        if !refused && point.chosen.as_ref().is_none_or(|chosen| chosen.failed >= 1.0) {
            without.push(point.law.clone());
        }
    }
    without
}

/// Every law of the list finds gains that satisfy every constraint and follow, or states why it has none on
/// this arm; a law that is compared with itself is inside its own band, so that no law is better than itself.
#[test]
fn every_law_follows_and_chance_is_inside_its_band() {
    let few = |name: &str, only: &[&str], per_scalar: u32| FrontsOptions {
        caps: vec![0.05],
        worlds: Some([1, 1, 2]),
        restarts: Some(2),
        ..options(folder(name), only, per_scalar)
    };
    let (fronts, [_, page]) = whole(&few("laws", &[], 1));
    // Some laws need a longer search than one evaluation for each scalar and one more.
    let longer = not_followed(&fronts);
    if !longer.is_empty() {
        let ids: Vec<&str> = longer.iter().map(String::as_str).collect();
        let without = not_followed(&whole(&few("longer", &ids, 5)).0);
        assert!(without.is_empty(), "{longer:?}, at last {without:?}");
    }
    let band = fronts.placebo[0];
    assert!(band.pairs == Tier::ALL.len() && band.factor.is_finite(), "{band:?}");
    for law in fronts.laws.iter().filter(|law| law.again.is_some()) {
        let errors = |id: &str| {
            let point = fronts.points.iter().find(|point| point.law == id).unwrap();
            let kept = point.restarts.iter().filter(|restart| restart.feasible());
            let row = |r: &Restart| {
                r.test.iter().map(|t| t.map_or(1.0, |tried| tried.error_rms_rad)).collect()
            };
            ErrorTable::new(kept.map(row).collect()).unwrap()
        };
        let own =
            ratio(&errors(&law.id), &errors(law.again.as_ref().unwrap()), Bootstrap::default());
        let own = own.unwrap();
        assert!(own.ratio <= band.factor && own.ratio >= 1.0 / band.factor, "{own:?} {band:?}");
    }
    let page = String::from_utf8(page).unwrap();
    assert!(page.len() > 20_000 && !page.contains("NaN"));
    // Designed gains are in the head wherever they stand, and so is what laws know of the loop's time.
    let (head, rest) = page.split_once("</header>").unwrap();
    assert!(head.contains("By design, not tuned: "), "{head}");
    assert!(rest.contains("Handed delay and preview too: "));
    knows_no_more(&fronts);
}

/// Every law is compared with one of ours that is handed no more, and there are laws of either kind.
fn knows_no_more(fronts: &Fronts) {
    let law = |id: &str| fronts.laws.iter().find(|law| law.id == id).unwrap();
    for versus in &fronts.versus {
        let (theirs, ours) = (law(&versus.law), law(&versus.ours));
        assert!(ours.tier <= theirs.tier && ours.timing.within(theirs.timing), "{versus:?}");
    }
    assert!(fronts.laws.iter().any(|law| law.timing == LoopKnowledge::default() && law.ours));
    assert!(fronts.laws.iter().any(|law| law.timing != LoopKnowledge::default() && !law.ours));
}

/// The result of the chosen gains in the validation worlds is no worse under a looser cap.
fn looser_is_no_worse(fronts: &Fronts) {
    let mut pairs = 0;
    for law in &fronts.laws {
        let mut points: Vec<_> = fronts
            .points
            .iter()
            .filter(|point| point.law == law.id && point.chosen.is_some())
            .collect();
        points.sort_by(|a, b| a.cap.total_cmp(&b.cap));
        let cost = |point: &AtCap| {
            let chosen = point.chosen.as_ref().unwrap().restart;
            let restart = point.restarts.iter().find(|restart| restart.restart == chosen);
            restart.unwrap().validation.unwrap().cost()
        };
        assert!(points.windows(2).all(|pair| cost(pair[1]) <= cost(pair[0])), "{}", law.id);
        pairs += points.len().saturating_sub(1);
    }
    assert!(pairs > 0, "no law has gains under two caps");
}

/// Options that cannot be used are reported.
#[test]
fn bad_options_are_told() {
    let out = folder("bad");
    let good = options(out.join("none"), &["pd"], 2);
    for (options, word) in [
        (FrontsOptions { caps: vec![1.5], ..good.clone() }, "1.5"),
        (FrontsOptions { caps: vec![f64::NAN], ..good.clone() }, "NaN"),
        (FrontsOptions { only: vec!["pdd".to_owned()], ..good.clone() }, "pdd"),
        (FrontsOptions { from: vec![out.clone()], ..good.clone() }, "no journal"),
        (FrontsOptions { study: out.join("no.toml"), ..good.clone() }, "no.toml"),
    ] {
        let told = options.run(&mut ()).err().unwrap().to_string();
        assert!(told.contains(word), "{told}");
    }
}
