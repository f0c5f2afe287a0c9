//! Targets of three kinds, their plots, and the settings with which every filter follows a kind.

use common::config::{BandwidthConfig, BankConfig, TrackerConfig, TurnConfig};
use tracker::plots::measurement::Measurement;
use tracker::plots::radar::Radar;

use crate::multi_alternative::{self, FLIGHTS, Flight};
use crate::trajectory::Trajectory;
use crate::vsmm::{self, EXAMPLES, Example};
use crate::world::{self, Conditions, sights};

/// One scenario.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scenario {
    /// A drone, seen in three dimensions with range rate once a second.
    Drone(Trajectory),
    /// A ship, seen in the plane every 3 s.
    Ship(Example),
    /// An aircraft, seen in the plane with equal errors every so many tenths of a second.
    Aircraft(Flight, usize),
}

/// What is known of a run: step (s), position and velocity of the target and its plot, by scan.
pub(super) struct Run {
    pub(super) step_s: f64,
    pub(super) truth: Vec<[[f64; 3]; 2]>,
    pub(super) plots: Vec<Measurement>,
}

/// All of them.
pub(super) fn all() -> Vec<Scenario> {
    let drones = [Trajectory::Cv, Trajectory::A, Trajectory::B].map(Scenario::Drone);
    let aircraft = [1, 10].map(|every| FLIGHTS.map(|flight| Scenario::Aircraft(flight, every)));
    drones.into_iter().chain(EXAMPLES.map(Scenario::Ship)).chain(aircraft.into_iter().flatten()).collect()
}

impl Scenario {
    pub(super) fn name(&self) -> String {
        match self {
            Self::Drone(trajectory) => format!("drone, {}", trajectory.name()),
            Self::Ship(example) => format!("ship, example {}", example.number),
            Self::Aircraft(flight, every) => format!("aircraft, {}, {} s", flight.name(), *every as f64 * 0.1),
        }
    }

    /// Dimensions in which it moves.
    pub(super) fn axes(&self) -> usize {
        if matches!(self, Self::Drone(_)) { 3 } else { 2 }
    }

    /// First scan whose errors count.
    pub(super) fn first_scan(&self) -> usize {
        match self {
            Self::Aircraft(flight, every) => flight.counted().start / every,
            Self::Drone(_) | Self::Ship(_) => 10,
        }
    }

    pub(super) fn radar(&self) -> Radar {
        if self.axes() == 3 { world::radar() } else { Radar::IN_PLANE }
    }

    pub(super) fn run(&self, seed: u64, run: u32) -> Run {
        let flat = |[x, y]: [f64; 2]| [x, y, 0.0];
        match *self {
            Self::Drone(trajectory) => {
                let sights = sights(trajectory, &Conditions::WITHOUT_CLUTTER, seed, run);
                let state = |sight: &world::Sight| [sight.truth.position_m.into(), sight.truth.velocity_mps.into()];
                Run {
                    step_s: 1.0,
                    truth: sights.iter().map(state).collect(),
                    plots: sights.iter().map(|sight| sight.plot).collect(),
                }
            }
            Self::Ship(example) => {
                let truth = example.truth();
                Run {
                    step_s: vsmm::STEP_S,
                    plots: example.plots(&truth, seed, run),
                    truth: truth.iter().map(|ship| [flat(ship.position_m), flat(ship.velocity_mps)]).collect(),
                }
            }
            Self::Aircraft(flight, every) => {
                let truth: Vec<_> = flight.truth().into_iter().step_by(every).collect();
                Run {
                    step_s: multi_alternative::STEP_S * every as f64,
                    plots: multi_alternative::plots(&truth, seed, run),
                    truth: truth.iter().map(|[position, velocity, _]| [flat(*position), flat(*velocity)]).collect(),
                }
            }
        }
    }

    /// Settings for this kind of target, of every filter.
    pub(super) fn config(&self) -> TrackerConfig {
        let default = TrackerConfig::default();
        let turn = |noise_mps2, step: f64| TurnConfig {
            noise_mps2,
            rates_deg_per_s: [-2.0, -1.0, 0.0, 1.0, 2.0].map(|rate| rate * step).to_vec(),
            greatest_rate_deg_per_s: 2.5 * step,
            spacing_deg_per_s: 2.0 * step,
            ..TurnConfig::default()
        };
        let bank = |greatest_acceleration_mps2, window_scans| BankConfig {
            greatest_acceleration_mps2,
            window_scans,
            ..BankConfig::default()
        };
        let bandwidth = |greatest_acceleration_mps2, narrow_mps2, calm_scans, hold_scans| BandwidthConfig {
            greatest_acceleration_mps2,
            narrow_mps2,
            wide_mps2: 0.5 * greatest_acceleration_mps2,
            calm_scans,
            hold_scans,
            ..BandwidthConfig::default()
        };
        match self {
            Self::Drone(_) => TrackerConfig {
                turn: turn(1.0, 7.0),
                bank: bank(10.0, 1),
                bandwidth: bandwidth(10.0, 0.8, 2, 2),
                ..default
            },
            Self::Ship(_) => TrackerConfig {
                cv_noise_mps2: 0.3,
                hover_noise_mps: 0.3,
                velocity_noise_mps2: 0.1,
                manoeuvre_noise_mps3: 1.0,
                stay_probability: 0.97,
                turn: turn(0.1, 2.0),
                bank: BankConfig { correlation_time_s: 20.0, ..bank(1.0, 2) },
                bandwidth: BandwidthConfig { correlation_time_s: 20.0, ..bandwidth(1.0, 0.05, 4, 4) },
                ..default
            },
            Self::Aircraft(_, every) => {
                let (window, calm, hold) = if *every > 1 { (1, 2, 2) } else { (4, 10, 20) };
                TrackerConfig {
                    cv_noise_mps2: 20.0,
                    velocity_noise_mps2: 3.0,
                    manoeuvre_noise_mps3: 30.0,
                    turn: turn(3.0, 4.7),
                    bank: bank(49.0, window),
                    bandwidth: bandwidth(49.0, 3.0, calm, hold),
                    ..default
                }
            }
        }
    }
}
