use common::config::*;
use experiments::follow::*;
use experiments::trajectory::*;
use experiments::world::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let what = args[1].as_str();
    let runs: u32 = args[2].parse().unwrap();
    match what {
        "acc" => {
            let c = Conditions { pfa: 0.0, snr_db: 16.0, swerling: Swerling::One };
            for settings in ["source", "default"] {
                let config = if settings == "source" { source_settings(&c) } else { TrackerConfig::default() };
                let mut f = Follower::new(&config, &c);
                let (mut e, mut p, mut v, mut n, mut k) = (0.0, 0.0, 0.0, 0.0, 0.0);
                let mut w = [[0.0; 3]; 51];
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
                        let t = s[i + 2].truth;
                        let kk = i + 1;
                        let m = if (26..=33).contains(&kk) {
                            0
                        } else if (10..=15).contains(&kk) || (21..=25).contains(&kk) || (34..=39).contains(&kk) {
                            2
                        } else {
                            1
                        };
                        let _ = t;
                        if (0..3).all(|j| x.probability[m] >= x.probability[j]) {
                            ok[kk] += 1.0;
                        }
                        for j in 0..3 {
                            w[i + 1][j] += x.probability[j] / f64::from(runs);
                        }
                    }
                }
                println!(
                    "{settings} est {} pred {} vel {} nees {}",
                    f64::sqrt(e / k),
                    f64::sqrt(p / k),
                    f64::sqrt(v / k),
                    n / k
                );
                if runs > 0 {
                    for (n, a, b) in [
                        ("cv1", 1, 9),
                        ("turn", 10, 15),
                        ("cv2", 16, 20),
                        ("brake", 21, 25),
                        ("hover", 26, 33),
                        ("acc", 34, 39),
                        ("cv3", 40, 50),
                    ] {
                        print!(
                            "{n} {:.3} ",
                            (a..=b).map(|k| ok[k]).sum::<f64>() / f64::from(runs) / (b - a + 1) as f64
                        );
                    }
                    println!();
                    continue;
                }
                for k in 1..=50 {
                    print!("{k}:{:.2},{:.2},{:.2} ", w[k][0], w[k][1], w[k][2]);
                }
                println!();
            }
        }
        _ => {
            let trajectory = match args[3].as_str() {
                "B" => Trajectory::B,
                "A" => Trajectory::A,
                "CV" => Trajectory::Cv,
                _ => Trajectory::Random,
            };
            let sw = match args[4].as_str() {
                "0" => Swerling::Zero,
                "3" => Swerling::Three,
                _ => Swerling::One,
            };
            let only = |key: &str, all: &[f64]| -> Vec<f64> {
                std::env::var(key).map_or(all.to_vec(), |v| v.split(',').map(|x| x.parse().unwrap()).collect())
            };
            for pfa in only("F", &[0.1, 0.01, 0.001]) {
                for snr_db in only("S", &[8.0, 10.0, 12.0, 14.0, 16.0]) {
                    let c = Conditions { pfa, snr_db, swerling: sw };
                    let mut config = match what {
                        "source" | "nn" | "sn" => source_settings(&c),
                        _ => TrackerConfig::default(),
                    };
                    if what == "nn" {
                        config.association = Association::Nearest
                    }
                    if what == "sn" {
                        config.association = Association::Strongest
                    }
                    for kv in &args[5..] {
                        let (k, v) = kv.split_once('=').unwrap();
                        let f: f64 = v.parse().unwrap_or(0.0);
                        match k {
                            "snr" => config.snr_db = f,
                            "spread" => config.snr_spread_db = f,
                            "prior" => config.snr_prior_scans = f,
                            "stay" => config.stay_probability = f,
                            "a3" => config.manoeuvre_noise_mps3 = f,
                            "a2" => config.velocity_noise_mps2 = f,
                            "a1" => config.hover_noise_mps = f,
                            "alpha" => config.gate_alpha = f,
                            "C" => config.gate_false_plots = f,
                            "d" => config.detection_probability = f,
                            "gamma" => config.range_rate_inflation = f,
                            "mht" => {
                                config.association = Association::Mht;
                                config.hypotheses = f as u32
                            }
                            "sw" => config.swerling = sw,
                            "true" => {
                                config.snr_db = snr_db;
                                config.snr_spread_db = 0.0;
                                config.snr_prior_scans = 0.0
                            }
                            _ => panic!(),
                        }
                    }
                    let results: Vec<(bool, bool, f64)> = std::thread::scope(|scope| {
                        let hs: Vec<_> = (0..2u32)
                            .map(|t| {
                                let config = config.clone();
                                scope.spawn(move || {
                                    let mut f = Follower::new(&config, &c);
                                    (0..runs)
                                        .filter(|r| r % 2 == t)
                                        .map(|run| {
                                            let s = sights(trajectory, &c, 1, run);
                                            let r = f.run(&s, &c, 1, run);
                                            (r.lost_at.is_some(), r.strayed, f64::from(r.lost_at.unwrap_or(50)))
                                        })
                                        .collect::<Vec<_>>()
                                })
                            })
                            .collect();
                        hs.into_iter().flat_map(|h| h.join().unwrap()).collect()
                    });
                    let n = results.len() as f64;
                    print!(
                        "{:.3}/{:.3}/{:.1} ",
                        results.iter().filter(|r| r.0).count() as f64 / n,
                        results.iter().filter(|r| r.1).count() as f64 / n,
                        results.iter().map(|r| r.2).sum::<f64>() / n
                    );
                }
                println!();
            }
        }
    }
}
