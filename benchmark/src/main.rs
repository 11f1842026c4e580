//! Times the actuator and the rivals in Rust once on one case and prints rows
//! of CSV. `benchmark/bench.py` calls it in turns with the other rivals.
//!
//! ```text
//! benchmark free|steps|van_der_pol|skips|ensemble milliseconds=10 c=100 gamma_s=… reference=case_a.csv
//!     fmu=DielectricElastomerActuator.so
//! ```

mod case;
mod ensemble;
mod fmu;
mod free;
mod host;
mod ours;
mod rivals;
mod row;
mod skips;
mod steps;
mod timing;
mod van_der_pol;

use std::collections::HashMap;
use std::time::Duration;

fn main() {
    let mut words = std::env::args().skip(1);
    let pattern = words.next().unwrap_or_default();
    let arguments: HashMap<String, String> = words
        .map(|word| {
            let (name, value) = word.split_once('=').expect("arguments are name=value");
            (name.to_owned(), value.to_owned())
        })
        .collect();
    let milliseconds: u64 = arguments["milliseconds"].parse().expect("a whole number");
    let least = Duration::from_millis(milliseconds);
    let case = case::Case::new(&arguments);
    match pattern.as_str() {
        "free" => free::run(&case, least),
        "steps" => steps::run(&case, least),
        "van_der_pol" => steps::van_der_pol(&case, &arguments["library"], least),
        "skips" => skips::run(&case, least),
        "ensemble" => ensemble::run(&case, least),
        _ => panic!("the first argument is free, steps, van_der_pol, skips or ensemble"),
    }
}
