//! A long run is handed over in blocks. Wrong if that changed a bit of its record or its figures, or if
//! memory grew with the length of the run.

use std::convert::Infallible;

use crate::support::{gains, rod_study, run};
use allocation_counter::measure;
use phihat_sim::{
    BLOCK, Ended, Measured, Metrics, ParquetTrace, Simulation, SimulationOutcome, Survival,
    Surviving, Trace, TraceWriter,
};
use phihat_study::Study;

const WORLD: &str = "[spec]\nsettle_s = 0.4\nerror_bound_rad = 1e-3\n[sensor]\nencoder_bits = 16\n\
                     velocity = \"differenced\"\n[loop]\ndelay_samples = 1\ntorque_rate_max_nm_s = 90.0\n\
                     [reference]\nkind = \"sines\"\ncenter_rad = 0.2\nfade_in_s = 0.2\n[[reference.sine]]\n\
                     amplitude_rad = 0.3\nfrequency_hz = 1.5\nphase_rad = 0.4\n";

fn in_blocks(study: &Study, block: usize, mut each: impl FnMut(&Trace)) -> Ended {
    let simulation = Simulation::new(study, &gains(study)).unwrap();
    let Ok(ended) = simulation.stream(
        block,
        |_| (),
        |block| -> Result<(), Infallible> {
            each(block);
            Ok(())
        },
    );
    ended
}

#[test]
fn blocks_are_the_whole_run_to_the_last_bit() {
    let study = rod_study("duration_s = 1.0", WORLD);
    let whole = run(&study);
    let mut csv = Vec::new();
    whole.trace.write_csv(&mut csv).unwrap();
    let metrics = Metrics::of(&whole.trace, &study);
    assert!(metrics.limited_steady_share > 0.0 && metrics.joints[0].tau_step_max_nm > 0.0);
    for block in [1, 7, 250, 999, 1000, 4096] {
        let (mut file, mut measured) = (TraceWriter::new(Vec::new()), Measured::new(&study));
        let (mut count, mut most) = (0, 0);
        let ended = in_blocks(&study, block, |trace| {
            file.block(trace).unwrap();
            measured.block(trace);
            (count, most) = (count + 1, most.max(trace.len()));
        });
        assert_eq!((count, most), (1000_usize.div_ceil(block), block.min(1000)));
        assert_eq!(
            (ended.told_max, ended.told_step_max),
            (whole.told_max.clone(), whole.told_step_max.clone())
        );
        assert!(file.finish().unwrap() == csv, "blocks of {block}");
        assert_eq!(measured.metrics(), metrics, "blocks of {block}");
        let mut read = Measured::new(&study);
        Trace::read_csv_in(csv.as_slice(), &study, block, |trace| {
            assert!(trace.len() <= block);
            read.block(trace);
        })
        .unwrap();
        assert_eq!(read.metrics(), metrics, "read in blocks of {block}");
    }
}

#[test]
fn memory_does_not_grow_with_the_run() {
    let csv = |seconds, block| {
        peak((seconds, block), || {
            let mut file = TraceWriter::new(std::io::sink());
            move |trace: &Trace| file.block(trace).unwrap()
        })
    };
    let (short, long) = (csv(2, 512), csv(40, 512));
    // The study's text is a character longer.
    assert!(long.abs_diff(short) < 100, "{short} and {long} bytes");
    assert!(long < 500_000, "{long} bytes");
    assert!(csv(40, usize::MAX) > 4_000_000, "a whole run is counted");
}

/// Most memory of a run that is handed over in blocks.
fn peak<W: FnMut(&Trace)>((seconds, block): (u32, usize), writer: impl Fn() -> W) -> u64 {
    let study = rod_study(&format!("duration_s = {seconds}.0"), &WORLD.replace("90.0", "900.0"));
    let used = measure(|| {
        let (mut write, mut measured) = (writer(), Measured::new(&study));
        in_blocks(&study, block, |trace| {
            write(trace);
            measured.block(trace);
        });
        assert_eq!(measured.metrics().samples, u64::from(seconds) * 1000);
    });
    used.bytes_max
}

/// Parquet has its directory at the end, of which a row group takes some fifteen kilobytes; 4096 samples of a
/// joint are 500.
#[test]
fn memory_of_parquet_grows_by_its_directory_alone() {
    let parquet = |seconds, block| {
        peak((seconds, block), || {
            let mut file = ParquetTrace::new(std::io::sink());
            move |trace: &Trace| file.block(trace).unwrap()
        })
    };
    let (short, long) = (parquet(8, 512), parquet(80, 512));
    let groups = (80 - 8) * 1000 / BLOCK as u64 + 1;
    assert!(long.saturating_sub(short) < 20_000 * groups, "{short} and {long} bytes");
    assert!(long < 1_500_000, "{long} bytes");
    assert!(parquet(80, usize::MAX) > 8_000_000, "a whole run is counted");
}

/// A world in which everything of a survival's figures is there, that ends at its time, diverges, or is stopped.
fn faulted(fault: &str) -> Study {
    rod_study("duration_s = 1.0", &format!("{WORLD}[[fault]]\nstart_s = 0.3\n{fault}\n"))
}

/// The definition of the figures, read from the whole record.
fn by_the_trace(outcome: &SimulationOutcome, from: f64) -> (f64, f64, f64) {
    let joint = &outcome.trace.joints[0];
    let (n, at) = (outcome.trace.len(), outcome.trace.index_at(from));
    let worst = |values: &[f64]| values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    (worst(&joint.e[at..]), worst(&joint.e[n - n / 10..]), worst(&joint.dq[at..]))
}

#[test]
fn figures_alone_are_those_of_the_whole_record() {
    let quiet = faulted("kind = \"push\"\nsize = 0.4");
    let wild = faulted("kind = \"push\"\nsize = 1e5");
    for study in [&quiet, &wild] {
        let whole = run(study);
        let alone = || Simulation::new(study, &gains(study)).unwrap();
        let mut all = (TraceWriter::new(Vec::new()), Measured::new(study));
        let ended = alone().record(&mut all, |_| ()).unwrap();
        let mut csv = Vec::new();
        whole.trace.write_csv(&mut csv).unwrap();
        assert!(all.0.finish().unwrap() == csv);
        assert_eq!(all.1.metrics(), Metrics::of(&whole.trace, study));
        let mut figures = (Measured::new(study), Surviving::new(study));
        let Ok(again) = alone().record(&mut figures, |_| ());
        assert_eq!(again, ended);
        assert_eq!(figures.0.metrics(), Metrics::of(&whole.trace, study));
        let survival = figures.1.survival(&ended, study);
        assert_eq!(survival, Survival::of(&whole, study));
        let told = (survival.error_peak_rad, survival.error_end_rad, survival.velocity_max_rad_s);
        assert_eq!(told, by_the_trace(&whole, 0.3));
        assert_eq!(survival.finite, whole.divergence.is_none());
    }
    assert!(run(&wild).divergence.is_some() && run(&quiet).divergence.is_none());
}

#[test]
fn the_last_tenth_is_found_wherever_a_run_ends() {
    let study = faulted("kind = \"push\"\nsize = 0.4");
    let whole = run(&study);
    for length in [0, 1, 9, 10, 11, 64, 65, 128, 321, 999] {
        let mut outcome = whole.clone();
        let joint = &mut outcome.trace.joints[0];
        for column in [&mut joint.e, &mut joint.dq] {
            column.truncate(length);
        }
        outcome.trace.t_ns.truncate(length);
        let survival = Survival::of(&outcome, &study);
        let told = (survival.error_peak_rad, survival.error_end_rad, survival.velocity_max_rad_s);
        assert_eq!(told, by_the_trace(&outcome, 0.3), "{length}");
    }
}
