//! The Parquet file holds what the CSV file holds. Wrong if a column were mixed up or a row misplaced.
#![cfg(feature = "parquet")]

use crate::support::{rod_study, run};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;

#[test]
fn rows_read_back_as_written() {
    let hold = "[start]\nq_rad = 0.31\n[reference]\nkind = \"hold\"\nq_rad = 0.3\n";
    let trace = run(&rod_study("duration_s = 0.2", hold)).trace;
    let mut file = Vec::new();
    trace.write_parquet(&mut file).unwrap();
    let reader = SerializedFileReader::new(bytes::Bytes::from(file)).unwrap();
    let mut count = 0;
    for (k, row) in reader.get_row_iter(None).unwrap().enumerate() {
        let row = row.unwrap();
        assert_eq!(row.get_long(0).unwrap(), i64::try_from(trace.t_ns[k]).unwrap());
        assert_eq!(row.get_string(1).unwrap(), "hinge");
        assert_eq!(row.get_double(2).unwrap().to_bits(), trace.joints[0].q[k].to_bits());
        assert_eq!(row.get_double(16).unwrap().to_bits(), trace.joints[0].phi_hat[k].to_bits());
        assert_eq!(row.get_bool(17).unwrap(), trace.joints[0].saturated[k]);
        count += 1;
    }
    assert_eq!(count, 200);
}
