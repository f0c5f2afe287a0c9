use common::config::*;
use experiments::follow::*;
use experiments::trajectory::*;
use experiments::world::*;
fn eval(config: &TrackerConfig, runs: u32) -> Vec<f64> {
    let c = Conditions { pfa: 0.0, snr_db: 16.0, swerling: Swerling::One };
    let mut f = Follower::new(config, &c);
    let (mut e, mut p, mut v, mut n, mut k) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut ok = [0.0; 51];
    for run in 0..runs {
        let s = sights(Trajectory::B, &c, 1, run);
        let r = f.run(&s, &c, 1, run);
        for (i, x) in r.scans.iter().enumerate() {
            let sq = |a: [f64; 3]| a.iter().map(|x| x * x).sum::<f64>();
            e += sq(x.position_error_m);
            p += sq(x.predicted_error_m);
            v += sq(x.velocity_error_mps);
            n += x.nees_position;
            k += 1.0;
            let kk = i + 1;
            let m = if (26..=33).contains(&kk) {
                0
            } else if (10..=15).contains(&kk) || (21..=25).contains(&kk) || (34..=39).contains(&kk) {
                2
            } else {
                1
            };
            if (0..3).all(|j| x.probability[m] >= x.probability[j]) {
                ok[kk] += 1.0;
            }
        }
    }
    let mut out = vec![f64::sqrt(e / k), f64::sqrt(p / k), f64::sqrt(v / k), n / k];
    for (a, b) in [(1, 9), (10, 15), (16, 20), (21, 25), (26, 33), (34, 39), (40, 50)] {
        out.push((a..=b).map(|k: usize| ok[k]).sum::<f64>() / f64::from(runs) / f64::from((b - a + 1) as u32));
    }
    out
}
fn main() {
    let c = Conditions { pfa: 0.0, snr_db: 16.0, swerling: Swerling::One };
    let runs = 2000;
    let base = eval(&source_settings(&c), runs);
    println!("source {base:.3?}");
    let mut best: Vec<(f64, String)> = vec![];
    for stay in [0.87, 0.88, 0.89] {
        for a3 in [7.0, 7.5, 8.0] {
            for a2 in [0.6, 0.8, 1.0] {
                for a1 in [0.9, 1.0] {
                    for gamma in [0.2, 0.4] {
                        let config = TrackerConfig {
                            stay_probability: stay,
                            manoeuvre_noise_mps3: a3,
                            velocity_noise_mps2: a2,
                            hover_noise_mps: a1,
                            range_rate_inflation: gamma,
                            ..TrackerConfig::default()
                        };
                        let r = eval(&config, runs);
                        // worst relative deficit
                        let mut worst = f64::NEG_INFINITY;
                        for i in 0..3 {
                            worst = worst.max((r[i] / base[i] - 1.0) * 10.0);
                        }
                        for i in 4..11 {
                            worst = worst.max((base[i] - r[i]) * 10.0);
                        }
                        best.push((worst, format!("stay {stay} a3 {a3} a2 {a2} a1 {a1} g {gamma}: {r:.3?}")));
                    }
                }
            }
        }
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (w, s) in best.iter().take(12) {
        println!("{w:.4} {s}");
    }
}
