//! A trace is the same whichever kind its file is of; other programs read our files, and we read theirs.
//! Wrong if a column were mixed up, a row misplaced or a bit lost, or if a broken file were accepted,
//! believed, or a panic.

use std::fmt::Write as _;
use std::sync::Arc;

use crate::support::{columns, read, rod_study};
use allocation_counter::measure;
use bytes::Bytes;
use parquet::basic::{Compression, Encoding};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::file::metadata::RowGroupMetaData;
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::record::RowAccessor;
use parquet::schema::parser::parse_message_type;
use phihat::{Events, Fault, Mode};
use phihat_sim::{BLOCK, JointTrace, ParquetTrace, Supervision, Trace};
use phihat_study::Study;

/// Numbers that are drawn, the same in every run.
struct Drawn(u64);

impl Drawn {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, most: usize) -> usize {
        usize::try_from(self.next() % most as u64).unwrap()
    }

    /// Any bits; often what is special; often near to the one before.
    fn number(&mut self, before: f64) -> f64 {
        const SPECIAL: [f64; 9] = [
            0.0,
            -0.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MIN_POSITIVE,
            5e-324,
            f64::MAX,
            0.1,
        ];
        match self.next() % 4 {
            0 => SPECIAL[self.below(SPECIAL.len())],
            1 => f64::from_bits(self.next()),
            _ => before + 1e-3,
        }
    }
}

const HOLD: &str = "[start]\nq_rad = 0.31\n[reference]\nkind = \"hold\"\nq_rad = 0.3\n";

fn planar() -> Study {
    read(
        "duration_s = 1.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.5\nerror_bound_rad = 1e-3\n[gains]\n\
         order = 1\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n\
         [reference]\nkind = \"hold\"\nq_rad = [0.1, 0.2, 0.3]\n",
    )
}

/// A trace of a study's arm in which everything is drawn.
fn drawn(study: &Study, draw: &mut Drawn, samples: usize, supervised: bool) -> Trace {
    let period_ns = study.control.period_ns;
    let first = draw.next() % 1_000_000_000;
    let t_ns = (0..samples as u64).map(|k| first + k * period_ns).collect();
    let mut joints = Vec::new();
    for described in &study.robot.joints {
        let mut joint = JointTrace { name: described.name.clone(), ..JointTrace::default() };
        for column in columns(&mut joint) {
            let mut value = 0.0;
            for _ in 0..samples {
                value = draw.number(value);
                column.push(value);
            }
        }
        joint.saturated = (0..samples).map(|_| draw.next().is_multiple_of(3)).collect();
        joint.rate_limited = (0..samples).map(|_| draw.next().is_multiple_of(2)).collect();
        joints.push(joint);
    }
    let mut supervision = Supervision::default();
    for _ in 0..samples {
        supervision.mode.push(Mode::ALL[draw.below(Mode::ALL.len())]);
        let mut events = Events::NONE;
        for (event, _) in Events::ALL {
            if draw.next().is_multiple_of(5) {
                events |= *event;
            }
        }
        supervision.events.push(events);
        supervision.fault.push(Fault::ALL.get(draw.below(2 * Fault::ALL.len())).copied());
        supervision.brake.push(draw.next().is_multiple_of(2));
    }
    Trace { period_ns, t_ns, joints, supervision: supervised.then_some(supervision) }
}

/// The same to the bit; which number a NaN is does not matter, since CSV does not tell.
fn assert_same(a: &Trace, b: &Trace) {
    assert_eq!(a.t_ns, b.t_ns);
    assert_eq!((a.period_ns, &a.supervision), (b.period_ns, &b.supervision));
    assert_eq!(a.joints.len(), b.joints.len());
    for (a, b) in a.joints.iter().zip(&b.joints) {
        let (mut a, mut b) = (a.clone(), b.clone());
        assert_eq!(
            (&a.name, &a.saturated, &a.rate_limited),
            (&b.name, &b.saturated, &b.rate_limited)
        );
        let bits = |x: &f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
        assert!(a.error_share.iter().map(bits).eq(b.error_share.iter().map(bits)));
        for (a, b) in columns(&mut a).into_iter().zip(columns(&mut b)) {
            assert!(a.iter().map(bits).eq(b.iter().map(bits)));
        }
    }
}

fn written(trace: &Trace) -> Vec<u8> {
    let mut file = Vec::new();
    trace.write_parquet(&mut file).unwrap();
    file
}

fn read_back(file: &[u8], study: &Study) -> Trace {
    Trace::read(Bytes::copy_from_slice(file), study).unwrap()
}

fn why(file: &[u8], study: &Study) -> String {
    Trace::read(Bytes::copy_from_slice(file), study).unwrap_err().to_string()
}

#[test]
fn either_kind_reads_back_the_same_bits() {
    let mut draw = Drawn(1);
    for (study, samples) in [
        (planar(), 1),
        (planar(), 9),
        (planar(), 700),
        (rod_study("duration_s = 1.0", HOLD), BLOCK + 5),
    ] {
        for (supervised, bounded) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut trace = drawn(&study, &mut draw, samples, supervised);
            for joint in trace.joints.iter_mut().filter(|_| bounded) {
                joint.error_share = (0..samples).map(|_| draw.number(1.0)).collect();
            }
            let (parquet, mut csv) = (written(&trace), Vec::new());
            trace.write_csv(&mut csv).unwrap();
            let (a, b) = (read_back(&parquet, &study), read_back(&csv, &study));
            assert_same(&a, &trace);
            assert_same(&a, &b);
            let nan =
                |trace: &Trace| trace.joints[0].q.iter().find(|q| q.is_nan()).map(|q| q.to_bits());
            assert_eq!(nan(&a), nan(&trace), "Parquet keeps a NaN's bits too");
        }
    }
}

#[test]
fn a_file_does_not_depend_on_the_blocks_it_came_in() {
    let study = rod_study("duration_s = 1.0", HOLD);
    let trace = drawn(&study, &mut Drawn(2), 2 * BLOCK + 100, true);
    let whole = written(&trace);
    for block in [1, 333, 4095, 4096, 5000] {
        let mut file = ParquetTrace::new(Vec::new());
        let mut taken = 0;
        Trace::read_in(Bytes::from(whole.clone()), &study, block, |part| {
            assert!(part.len() <= block);
            taken += part.len();
            file.block(part).unwrap();
        })
        .unwrap();
        assert_eq!(taken, trace.len());
        assert!(file.finish().unwrap() == whole, "blocks of {block}");
    }
    let reader = SerializedFileReader::new(Bytes::from(whole)).unwrap();
    let rows: Vec<i64> =
        reader.metadata().row_groups().iter().map(RowGroupMetaData::num_rows).collect();
    assert_eq!(rows, [4096, 4096, 100]);
}

#[test]
fn the_formats_own_library_sees_every_value() {
    let study = planar();
    let mut trace = drawn(&study, &mut Drawn(3), 50, true);
    let reader = SerializedFileReader::new(Bytes::from(written(&trace))).unwrap();
    let mut count = 0;
    for (at, row) in reader.get_row_iter(None).unwrap().enumerate() {
        let (row, k) = (row.unwrap(), at / 3);
        assert_eq!(row.get_long(0).unwrap(), i64::try_from(trace.t_ns[k]).unwrap());
        let joint = &mut trace.joints[at % 3];
        assert_eq!(row.get_string(1).unwrap(), &joint.name);
        for (i, column) in columns(joint).into_iter().enumerate() {
            assert_eq!(row.get_double(2 + i).unwrap().to_bits(), column[k].to_bits());
        }
        assert_eq!(row.get_bool(17).unwrap(), joint.saturated[k]);
        assert_eq!(row.get_bool(18).unwrap(), joint.rate_limited[k]);
        let told = trace.supervision.as_ref().unwrap();
        assert_eq!(row.get_string(19).unwrap(), told.mode[k].name());
        let events: Vec<_> = told.events[k].names().collect();
        assert_eq!(row.get_string(20).unwrap(), &events.join(" "));
        assert_eq!(row.get_string(21).unwrap(), told.fault[k].map_or("", Fault::name));
        assert_eq!(row.get_bool(22).unwrap(), told.brake[k]);
        count += 1;
    }
    assert_eq!(count, 150);
}

const NUMBERS: [&str; 15] = [
    "q_rad",
    "dq_rad_s",
    "ddq_rad_s2",
    "q_desired_rad",
    "dq_desired_rad_s",
    "ddq_desired_rad_s2",
    "e_rad",
    "e_integral_rad_s",
    "de_rad_s",
    "q_measured_rad",
    "dq_measured_rad_s",
    "tau_command_nm",
    "tau_applied_nm",
    "phi_nm",
    "phi_hat_nm",
];

/// A trace as another library writes it: its columns nullable, and beside one that is not a trace's.
fn by_others(trace: &Trace, properties: WriterProperties) -> Vec<u8> {
    let mut text = "message other { optional binary note (STRING);".to_owned();
    text += " optional int64 t_ns; optional binary joint (STRING);";
    for name in NUMBERS {
        write!(text, " optional double {name};").unwrap();
    }
    text += " optional boolean saturated; optional boolean rate_limited; }";
    let schema = Arc::new(parse_message_type(&text).unwrap());
    let mut file = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
    let mut joints = trace.joints.clone();
    let n = joints.len();
    let rows = || (0..trace.len() * n).map(|at| (at / n, at % n));
    let mut group = file.next_row_group().unwrap();
    let none: Vec<ByteArray> = Vec::new();
    put::<ByteArrayType>(&mut group, &none, rows().count());
    let t_ns: Vec<i64> = rows().map(|(k, _)| i64::try_from(trace.t_ns[k]).unwrap()).collect();
    put::<Int64Type>(&mut group, &t_ns, t_ns.len());
    let names: Vec<ByteArray> =
        rows().map(|(_, i)| ByteArray::from(trace.joints[i].name.as_str())).collect();
    put::<ByteArrayType>(&mut group, &names, names.len());
    for at in 0..NUMBERS.len() {
        let numbers: Vec<Vec<f64>> =
            joints.iter_mut().map(|joint| columns(joint)[at].clone()).collect();
        let numbers: Vec<f64> = rows().map(|(k, i)| numbers[i][k]).collect();
        put::<DoubleType>(&mut group, &numbers, numbers.len());
    }
    let flags: [fn(&JointTrace) -> &Vec<bool>; 2] =
        [|joint| &joint.saturated, |joint| &joint.rate_limited];
    for flags in flags {
        let flags: Vec<bool> = rows().map(|(k, i)| flags(&trace.joints[i])[k]).collect();
        put::<BoolType>(&mut group, &flags, flags.len());
    }
    group.close().unwrap();
    file.into_inner().unwrap()
}

/// Writes the next column; rows without a value are null.
fn put<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[T::T],
    rows: usize,
) {
    let mut column = group.next_column().unwrap().unwrap();
    let levels = vec![i16::from(!values.is_empty()); rows];
    column.typed::<T>().write_batch(values, Some(&levels), None).unwrap();
    column.close().unwrap();
}

#[test]
fn what_others_write_is_read() {
    let study = planar();
    let trace = drawn(&study, &mut Drawn(4), 500, false);
    let mut count = 0;
    for version in [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0] {
        for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY] {
            for (dictionary, split) in [(true, false), (false, false), (false, true)] {
                let mut properties = WriterProperties::builder()
                    .set_writer_version(version)
                    .set_compression(compression)
                    .set_dictionary_enabled(dictionary)
                    .set_data_page_row_count_limit(190)
                    .set_write_batch_size(64);
                for name in NUMBERS {
                    let with = if split { Encoding::BYTE_STREAM_SPLIT } else { Encoding::PLAIN };
                    properties = properties.set_column_encoding(name.into(), with);
                }
                for name in ["t_ns", "joint", "note"] {
                    properties = properties.set_column_encoding(name.into(), Encoding::PLAIN);
                }
                let file = by_others(&trace, properties.build());
                assert_same(&read_back(&file, &study), &trace);
                count += 1;
            }
        }
    }
    assert_eq!(count, 12);
    let delta = WriterProperties::builder()
        .set_column_dictionary_enabled("t_ns".into(), false)
        .set_column_encoding("t_ns".into(), Encoding::DELTA_BINARY_PACKED);
    assert_same(&read_back(&by_others(&trace, delta.build()), &study), &trace);
}

#[test]
fn broken_files_are_refused_with_row_and_column() {
    let study = planar();
    let trace = drawn(&study, &mut Drawn(5), 20, true);
    let changed = |change: fn(&mut Trace)| {
        let mut other = trace.clone();
        change(&mut other);
        why(&written(&other), &study)
    };
    let told = changed(|trace| trace.joints[1].name = "other".to_owned());
    assert!(told.starts_with("row 2: joint \"other\" is not the next one"), "{told}");
    let told = changed(|trace| trace.t_ns[7] += 1);
    assert!(told.starts_with("row 22: time ") && told.contains("does not follow"), "{told}");
    let told = changed(|trace| trace.joints.truncate(2));
    assert!(told.starts_with("row 3: joint "), "{told}");
    let none = Trace::default();
    assert_eq!(
        why(&written(&none), &study),
        "row 0: no sample follows; a trace has one row per sample and joint"
    );
    let file = written(&trace);
    let at = file.windows(8).position(|part| part == b"tracking").unwrap();
    let mut word = file.clone();
    word[at..at + 8].copy_from_slice(b"trackink");
    let told = why(&word, &study);
    assert!(told.contains("mode is \"trackink\"; a word that phihat writes is expected"), "{told}");
    // Another name in the footer: a trace lacks that column.
    let at = file.windows(8).rposition(|part| part == b"dq_rad_s").unwrap();
    let at = file[..at].windows(8).rposition(|part| part == b"dq_rad_s").map_or(at, |first| {
        let schema = file.windows(5).rposition(|part| part == b"trace").unwrap();
        schema + file[schema..].windows(8).position(|part| part == b"dq_rad_s").unwrap().min(first)
    });
    let mut name = file.clone();
    name[at..at + 8].copy_from_slice(b"dq_deg_s");
    let told = why(&name, &study);
    assert_eq!(told, "there is no column dq_rad_s of numbers, which a trace has");
    for cut in [1, 8, 100, file.len() / 2, file.len() - 5] {
        let told = why(&file[..file.len() - cut], &study);
        assert!(told.contains("no whole Parquet file") || told.contains("line 1"), "{told}");
    }
}

/// Size of the text of a caught panic where `RUST_BACKTRACE` requests its stack \[byte\].
const TRACED: u64 = 1 << 27;

/// Whatever a file says of its sizes, reading it takes little more memory than it has bytes.
#[test]
fn a_file_that_claims_much_gets_little() {
    let study = planar();
    let file = written(&drawn(&study, &mut Drawn(6), 300, true));
    let good = measure(|| drop(read_back(&file, &study))).bytes_max;
    let footer = u32::from_le_bytes(file[file.len() - 8..][..4].try_into().unwrap()) as usize;
    let heads = file.windows(4).enumerate().filter(|(_, part)| part[..2] == [0x15, 0x00]);
    let heads: Vec<usize> = heads.map(|(at, _)| at).collect();
    assert!(heads.len() >= 20, "pages are found");
    let places =
        (file.len() - 8 - footer..file.len()).chain(heads.iter().flat_map(|at| *at..at + 16));
    let mut tried = 0;
    let every = if std::env::var_os("PHIHAT_ALL").is_some() { 1 } else { 9 };
    for at in places.filter(|at| *at < file.len()).step_by(every) {
        for with in [0xff, 0x7f, 0x80, 0] {
            let mut broken = file.clone();
            broken[at] = with;
            let used = measure(|| drop(Trace::read(Bytes::from(broken), &study)));
            let most = 2 * good.max(file.len() as u64) + TRACED;
            assert!(used.bytes_max < most, "byte {at}: {} of {most}", used.bytes_max);
            tried += 1;
        }
    }
    assert!(every * tried > 5000, "{tried}");
    // A megabyte of empty structures, a byte each, as columns, row groups, and columns of one.
    for head in [&[0x29, 0xfc][..], &[0x49, 0xfc], &[0x49, 0x1c, 0x19, 0xfc]] {
        let mut claims = b"PAR1".to_vec();
        claims.extend([head, &[0xc0, 0x84, 0x3d]].concat());
        claims.resize(claims.len() + 1_000_000, 0);
        let size = u32::try_from(claims.len() - 4).unwrap();
        claims.extend(size.to_le_bytes());
        claims.extend(b"PAR1");
        let used = measure(|| assert!(Trace::read(Bytes::from(claims), &study).is_err()));
        // A structure that says nothing of itself takes a hundred bytes.
        assert!(used.bytes_max < 100 * 1_000_000, "{head:?}: {}", used.bytes_max);
    }
}
