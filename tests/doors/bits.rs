// The lines of tests/portability/digest.cpp, which has what is computed, from Rust.
#[path = "../../docs/examples/rust/rlslab.rs"]
mod rlslab;
use rlslab::{names, Filter, List};

const D: usize = 5;
const ROWS: usize = 1000;
const HALF: usize = 500;

fn hashed(numbers: &[f64]) -> String {
    let (mut first, mut second) = (1u64, 1u64);
    for byte in numbers.iter().flat_map(|x| x.to_bits().to_le_bytes()) {
        first = (257 * first + byte as u64) % 4294967291;
        second = (65599 * second + byte as u64) % 4294967291;
    }
    format!("{:08x}{:08x}", first, second)
}

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().collect();
    let verb = arguments.get(1).map_or("", String::as_str);
    let folder = arguments.get(2).map_or("", String::as_str);
    let mut s: u32 = 1;
    let records: Vec<f64> = (0..ROWS * (D + 1))
        .map(|_| {
            s = s.wrapping_mul(1664525).wrapping_add(1013904223);
            (s >> 8) as f64 / 8388608.0 - 1.0
        })
        .collect();
    for arithmetic in names(List::Arithmetics) {
        for variant in names(List::Variants) {
            let mut filter = Filter::new(variant, arithmetic, D, 0.9921875, "")?;
            let path = format!("{}/{}.{}", folder, variant, arithmetic);
            let mut from = 0;
            if verb == "load" {
                filter.load(&std::fs::read(&path).map_err(|e| e.to_string())?)?;
                from = HALF;
            }
            for k in from..ROWS {
                if k == HALF && verb == "save" {
                    std::fs::write(&path, filter.save()?).map_err(|e| e.to_string())?;
                }
                let row = &records[k * (D + 1)..(k + 1) * (D + 1)];
                filter.update(&row[..D], row[D])?;
            }
            let numbers = [filter.theta()?, filter.gain()?, filter.matrix()?].concat();
            println!("{} {} {}", variant, arithmetic, hashed(&numbers));
        }
    }
    Ok(())
}
