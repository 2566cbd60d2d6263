// y = 0.8 u(k) - 0.3 u(k-1) and a little noise; one row is wrong. A guard finds it, and the filter goes on.
mod rlslab;
use rlslab::{names, Filter, List, Step};

fn main() -> Result<(), String> {
    let mut s: u32 = 1;
    let mut draw = || {
        s = s.wrapping_mul(1664525).wrapping_add(1013904223);
        s as f64 / 2147483648.0 - 1.0
    };
    let mut filter = Filter::new("ud", "double", 2, 0.99, "reset")?;
    let (signals, healths) = (names(List::Signals), names(List::Healths));
    let (mut u, mut step) = (0.0, Step::default());
    for row in 0..300 {
        let before = u;
        u = draw();
        let mut y = 0.8 * u - 0.3 * before + 0.01 * draw();
        if row == 200 {
            y += 5.0;
        }
        step = filter.update(&[u, before], y)?;
        if step.signal != 0 {
            println!("row {}: {}", row, signals[step.signal as usize]);
        }
    }
    let theta = filter.theta()?;
    println!("theta {:.2} {:.2}", theta[0], theta[1]);
    println!("{} outlier, {}", filter.counts()?.outliers, healths[step.health as usize]);
    if let Err(message) = Filter::new("udd", "double", 2, 1.0, "") {
        println!("{}", &message[..16]);
    }
    Ok(())
}
