//! The experiments that there are.

use crate::{
    Options, Progress, Results, accuracy, cfar, crossing, estimators, fused, initiation, multi_alternative, outliers,
    plot_accuracy, real_recordings, track_loss, vsmm,
};

/// One experiment. Its results depend on the options alone, and not on [`Options::threads`].
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// Its name on the command line and in the results.
    pub name: &'static str,
    /// What it measures, in a line.
    pub about: &'static str,
    /// Runs it.
    pub run: fn(&Options, &Progress) -> anyhow::Result<Results>,
}

/// All experiments, in the order in which `all` runs them.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment { name: "cfar", about: "false alarms and detections of the CFAR against theory", run: cfar::run },
    Experiment {
        name: "plot-accuracy",
        about: "errors of plots from simulated cells, and whether they are as stated",
        run: plot_accuracy::run,
    },
    Experiment {
        name: "accuracy",
        about: "errors, consistency and modes of one track by kind of motion; with --cells through cells",
        run: accuracy::run,
    },
    Experiment {
        name: "track-loss",
        about: "lost targets and time of tracking among false plots, by association and settings",
        run: track_loss::run,
    },
    Experiment {
        name: "initiation",
        about: "new targets confirmed against false tracks, by threshold and logic",
        run: initiation::run,
    },
    Experiment {
        name: "crossing",
        about: "two drones near each other: shares of runs with a track lost or exchanged",
        run: crossing::run,
    },
    Experiment {
        name: "vsmm",
        about: "turn filters of fixed, adaptive and switching rates on two published examples",
        run: vsmm::run,
    },
    Experiment {
        name: "multi-alternative",
        about: "several hypotheses on acceleration against one of adaptive bandwidth, on published manoeuvres",
        run: multi_alternative::run,
    },
    Experiment {
        name: "estimators",
        about: "every filter on drones, ships and aircraft: errors and consistency on the same plots",
        run: estimators::run,
    },
    Experiment {
        name: "outliers",
        about: "wrong elevations of one radar, judged as whole measurements and channel by channel",
        run: outliers::run,
    },
    Experiment {
        name: "fusion",
        about: "tracks of several radars: accuracy by rule, association with and without registration, classes",
        run: fused::run,
    },
    Experiment {
        name: "real-recordings",
        about: "every filter on a ferry's radar and on an airport's, scored against what others reach on them",
        run: real_recordings::run,
    },
];

/// The name that stands for every experiment.
pub const ALL: &str = "all";

/// The experiments of a name; none if there is no such name.
pub fn named(name: &str) -> Vec<Experiment> {
    EXPERIMENTS.iter().copied().filter(|experiment| name == ALL || experiment.name == name).collect()
}
