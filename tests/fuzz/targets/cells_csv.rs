//! Any bytes as a table of cells.
#![no_main]

mod cells;
mod scratch;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cells::check("cells.csv", bytes));
