//! Monte Carlo sweeps. Wrong if a byte of the answer depends on threads, interruptions or shards, if a figure
//! is not that of the run's whole record, if a written study does not repeat its run, or if a message about
//! bad input does not say what is valid.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use phihat_campaign::sweep::{SweepAnswer, SweepError, SweepOptions, SweepPlan, merge};
use phihat_session::{Dice, Session};
use phihat_sim::Metrics;

const STUDY: &str = "duration_s = 0.3\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.1\nerror_bound_rad = 2e-3\n\
    [gains]\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n\
    [loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = 16\nvelocity = \"differenced\"\n\
    [world]\npayload = { mass_kg = 0.3 }\n\
    [[fault]]\nkind = \"push\"\njoint = \"joint2\"\nstart_s = 0.15\nsize = 1.0\n\
    [reference]\nkind = \"hold\"\npose = \"ready\"\n";

const VARY: [&str; 4] = [
    "world.payload.mass_kg=0..1.5",
    "fault[0].size=normal:0,3",
    "loop.delay_samples=0..2",
    "gains.inertia_kg_m2=times:log:0.5..2",
];

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join(env!("CARGO_PKG_NAME"))
        .join("sweep")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn options(folder: &Path, runs: u64) -> SweepOptions {
    let study = folder.join("arm.toml");
    fs::write(&study, STUDY).unwrap();
    SweepOptions {
        study,
        vary: VARY.map(str::to_owned).to_vec(),
        runs,
        seed: 5,
        uncertified: true,
        out: Some(folder.join("out")),
        ..SweepOptions::default()
    }
}

/// Every file of an answer, but for what only the work needs.
fn answer(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for (under, at) in [("", folder.to_owned()), ("worst/", folder.join("worst"))] {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_file() && !name.starts_with('.') && name != "journal.jsonl" {
                all.insert(format!("{under}{name}"), fs::read(path).unwrap());
            }
        }
    }
    all
}

fn swept(options: &SweepOptions) -> BTreeMap<String, Vec<u8>> {
    assert!(matches!(options.run(&mut ()).unwrap(), SweepAnswer::Whole(_)));
    answer(options.out.as_ref().unwrap())
}

#[test]
fn whenever_it_is_interrupted_the_answer_is_the_same_to_the_last_byte() {
    let place = folder("interrupted");
    let options = SweepOptions { threads: Some(1), ..options(&place, 70) };
    let whole = swept(&options);
    assert!(whole.len() == 15 && whole.contains_key("sweep.json"), "{:?}", whole.keys());
    let out = options.out.clone().unwrap();
    let journal = fs::read(out.join("journal.jsonl")).unwrap();
    let rows = fs::read(out.join("runs.npy")).unwrap();
    let mut dice = Dice::new(3, 0);
    for round in 0..5 {
        // State after a kill: a journal cut at any byte, arbitrary rows where the journal has no entry, no
        // answer.
        fs::write(out.join("journal.jsonl"), &journal[..dice.below(journal.len())]).unwrap();
        let _ = fs::remove_file(out.join("runs.npy"));
        let mut torn = rows.clone();
        let cut = dice.below(torn.len());
        let spoiled = dice.below(2) == 0;
        if spoiled {
            torn[cut..].fill(0xa5);
        } else {
            torn.truncate(cut);
        }
        fs::write(out.join("runs.part"), torn).unwrap();
        let _ = fs::remove_file(out.join("sweep.json"));
        let threads = Some(1 + u16::try_from(round % 3).unwrap());
        assert!(
            swept(&SweepOptions { threads, ..options.clone() }) == whole,
            "{round}: cut {cut}, {spoiled}"
        );
    }
    // Again with everything there, and afresh.
    assert!(swept(&options) == whole);
    assert!(swept(&SweepOptions { fresh: true, threads: Some(4), ..options.clone() }) == whole);
    // Other runs share the folder, and leave nothing of the older ones.
    let fewer = swept(&SweepOptions { runs: 9, ..options.clone() });
    assert!(fewer != whole && swept(&options) == whole);
}

#[test]
fn shards_are_merged_to_what_one_process_leaves() {
    let place = folder("shards");
    let options = options(&place, 100);
    let whole = swept(&options);
    let apart = place.join("apart");
    let shard = |k: u64| {
        let part = SweepOptions {
            shard: Some(format!("{k}/3")),
            out: Some(apart.clone()),
            threads: Some(2),
            ..options.clone()
        };
        match part.run(&mut ()).unwrap() {
            SweepAnswer::Shard { runs, .. } => runs,
            SweepAnswer::Whole(_) => 0,
        }
    };
    let runs: Vec<u64> = [1, 3].map(shard).to_vec();
    let missing = merge(std::slice::from_ref(&apart), None).unwrap_err().to_string();
    assert!(missing.starts_with("shards 2 of 3 are missing"), "{missing}");
    assert_eq!(runs.iter().sum::<u64>() + shard(2), 100);
    // One is lost, and done again; one is changed, and told.
    fs::remove_dir_all(apart.join("shard-3-of-3")).unwrap();
    assert!(matches!(merge(std::slice::from_ref(&apart), None), Err(SweepError::Missing { .. })));
    shard(3);
    let rows = apart.join("shard-1-of-3/runs.npy");
    let bytes = fs::read(&rows).unwrap();
    let mut changed = bytes.clone();
    *changed.last_mut().unwrap() ^= 1;
    fs::write(&rows, changed).unwrap();
    let told = merge(std::slice::from_ref(&apart), None).unwrap_err().to_string();
    assert!(told.contains("changed since its shard was finished"), "{told}");
    fs::write(&rows, bytes).unwrap();
    let merged = merge(std::slice::from_ref(&apart), None).unwrap();
    assert_eq!(merged.summary.runs, 100);
    let mut left = answer(&apart);
    left.remove("shard.json");
    assert!(left == whole, "{:?} and {:?}", left.keys(), whole.keys());
    // A shard of another sweep does not belong.
    let other = SweepOptions {
        shard: Some("2/3".into()),
        seed: 6,
        out: Some(place.join("other")),
        ..options.clone()
    };
    other.run(&mut ()).unwrap();
    let two = [apart.join("shard-1-of-3"), place.join("other/shard-2-of-3")];
    let told = merge(&two, Some(&place.join("two"))).unwrap_err().to_string();
    assert!(told.contains("of another sweep than"), "{told}");
}

#[test]
fn a_row_is_the_run_of_its_written_study_to_the_last_bit() {
    let place = folder("repeated");
    let options = options(&place, 40);
    let vary = VARY.map(str::to_owned);
    let plan = SweepPlan::new((&options.study, None), &vary, (5, 40), true).unwrap();
    let (mut ended, mut kept) = (0, 0);
    let (columns, together) = (plan.columns(), plan.chunk(0..40));
    for run in 0..40 {
        let row = plan.run(run).unwrap();
        // Text, so that NaN equals itself.
        let in_lanes = columns.row(&together[usize::try_from(run).unwrap() * columns.width()..]);
        assert_eq!(format!("{in_lanes:?}"), format!("{:?}", Some(&row)), "{run} in lanes");
        let (text, uncertified) = plan.repeated(run).unwrap();
        let path = place.join(format!("run-{run}.toml"));
        fs::write(&path, text).unwrap();
        let study = phihat_session::read(&path).unwrap();
        assert_eq!(
            (study.seed, study.world.payload.as_ref().map(|p| p.mass)),
            (row.seed, Some(row.values[0]))
        );
        assert!((0.0..=1.5).contains(&row.values[0]) && [0.0, 1.0, 2.0].contains(&row.values[2]));
        let settled = study.clone();
        let (_, trace) = Session::new(study, &path, None, uncertified).unwrap().run(|_| ());
        let metrics = Metrics::of(&trace, &settled);
        if row.figures[0].is_infinite() {
            ended += 1;
            continue;
        }
        kept += u32::from(row.within_spec);
        let worst = |of: fn(&phihat_sim::JointMetrics) -> f64| {
            metrics.joints.iter().map(of).fold(0.0, f64::max)
        };
        let bits = |x: f64| x.to_bits();
        assert_eq!(bits(row.figures[0]), bits(worst(|j| j.error_steady_max_rad)), "{run}");
        assert_eq!(bits(row.figures[2]), bits(worst(|j| j.error_rms_rad)), "{run}");
        assert_eq!(bits(row.figures[7]), bits(worst(|j| j.tau_step_max_nm)), "{run}");
        assert_eq!(row.within_spec, metrics.within_spec, "{run}");
    }
    assert!(
        kept > 0 && kept + ended < 40,
        "{kept} kept, {ended} ended: the sweep tells nothing apart"
    );
}

#[test]
fn what_cannot_vary_is_told_and_leaves_the_disk_as_it_was() {
    let place = folder("refused");
    let options = options(&place, 10);
    let told = |vary: &[&str]| {
        let vary = vary.iter().map(|text| (*text).to_owned()).collect();
        SweepOptions { vary, ..options.clone() }.run(&mut ()).map(drop).unwrap_err().to_string()
    };
    for (vary, words) in [
        ("world.payload.mass_g=0..1", "write `world.payload.mass_kg`"),
        ("world.payload.mass_kg", "write KEY=RANGE"),
        ("world.payload.mass_kg=-1..1", "-1 kg is not possible there"),
        ("world.payload.mass_kg=1..0", "the smaller end comes first"),
        ("world.payload.mass_kg=log:0..1", "begins above 0"),
        ("world.payload.mass_kg=normal:1,0", "above 0"),
        ("world.payload.mass_kg=heavy", "`heavy` is no range"),
        ("world.payload.mass_kg=nan..1", "is no range"),
        ("loop.delay_samples=normal:1,1", "an integer"),
        ("loop.delay_samples=0..0.5", "0.5 samples is not possible"),
        ("world.push[0].torque_nm=times:0.5..2", "the study has no [[push]]"),
        ("world.viscous_extra_nm_s_rad=times:0.5..2", "no number there to multiply"),
        ("seed=1..5", "every run has a seed of its own"),
        ("design.payload_max_kg=0..1", "gains are made once"),
        ("fault[0].start_s=0..9", "the study cannot run"),
    ] {
        let told = told(&[vary]);
        assert!(told.contains(words) && told.starts_with("--vary"), "{vary}: {told}");
    }
    assert!(told(&[]).starts_with("nothing varies"));
    assert!(told(&[VARY[0], VARY[0]]).contains("it varies twice"));
    for shard in ["0/3", "4/3", "3", "a/b", "1/0"] {
        let wrong = SweepOptions { shard: Some(shard.into()), ..options.clone() };
        assert!(wrong.run(&mut ()).unwrap_err().to_string().contains("--shard"), "{shard}");
    }
    assert!(!options.out.unwrap().exists());
}
