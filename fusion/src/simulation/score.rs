//! System tracks against the truth.

use std::collections::{BTreeMap, BTreeSet};

use common::geodesy::FrameChange;

use super::World;
use crate::comparison::chi_squared;
use crate::gaussian::{Gaussian, STATE};
use crate::system::SystemTrack;

/// Mean square of errors.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Errors {
    squared: f64,
    count: u32,
}

impl Errors {
    fn add(&mut self, squared: f64) {
        self.squared += squared;
        self.count += 1;
    }

    /// Root of the mean square.
    pub fn rms(&self) -> f64 {
        self.mean().sqrt()
    }

    /// Mean square.
    pub fn mean(&self) -> f64 {
        self.squared / f64::from(self.count)
    }
}

/// Scores over some cycles.
#[derive(Debug, Default)]
pub struct Score {
    /// Of position, m: system tracks.
    pub fused: Errors,
    /// Of position, m: local tracks, by radar.
    pub local: Vec<Errors>,
    /// Of position, m: one filter with all measurements.
    pub central: Errors,
    /// Normalised error squared of position and velocity, over its dimensions.
    pub nees: Errors,
    numbers: BTreeMap<u64, BTreeSet<u64>>,
}

/// What a cycle has come to.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Outcome {
    /// System tracks alive.
    pub systems: usize,
    /// Of them, those that all local tracks of one target are part of, and no other.
    pub perfect: usize,
    /// Local tracks that are part of a system track of another target.
    pub wrong: usize,
    /// Local tracks that are part of a system track.
    pub attached: usize,
}

impl Score {
    /// Takes a cycle's system tracks.
    pub fn take<'a>(&mut self, world: &World, systems: impl IntoIterator<Item = SystemTrack<'a>>) -> Outcome {
        let mut outcome = Outcome::default();
        self.local.resize(world.scenario.radars.len(), Errors::default());
        for system in systems {
            let members = || system.contributors.iter().map(|of| of.id);
            outcome.systems += usize::from(!system.ended);
            let Some(owner) = most(members()).filter(|_| !system.ended) else { continue };
            let wrong = members().filter(|&id| id != owner).count();
            outcome.wrong += wrong;
            outcome.attached += system.contributors.len();
            outcome.perfect += usize::from(wrong == 0 && system.contributors.len() == world.scenario.radars.len());
            self.numbers.entry(owner).or_default().insert(system.id);
            self.add(world, owner as usize, &system.estimate);
        }
        outcome
    }

    /// Targets that have had more than one number.
    pub fn renumbered(&self) -> usize {
        self.numbers.values().filter(|numbers| numbers.len() > 1).count()
    }

    /// Error of the system tracks over that of the best radar.
    pub fn over_best(&self) -> f64 {
        self.fused.rms() / self.local.iter().map(Errors::rms).fold(f64::INFINITY, f64::min)
    }

    fn add(&mut self, world: &World, owner: usize, estimate: &Gaussian) {
        let target = &world.scenario.targets[owner];
        let error = estimate.mean - target.state();
        self.fused.add(error.fixed_rows::<3>(0).norm_squared());
        self.nees.add(chi_squared(&error, estimate.covariance) / STATE as f64);
        if let Some(central) = world.central(owner).at(world.time_s()) {
            self.central.add((central.position() - target.position_m).norm_squared());
        }
        for (number, radar) in world.scenario.radars.iter().enumerate() {
            let Some(local) = world.track(number, owner).at(world.time_s()) else { continue };
            let change = FrameChange::new(&world.scenario.centre, &radar.position);
            let truth = change.position_m(target.position_m.into());
            self.local[number].add((local.position() - nalgebra::Vector3::from(truth)).norm_squared());
        }
    }
}

fn most(ids: impl Iterator<Item = u64>) -> Option<u64> {
    let mut count = BTreeMap::new();
    ids.for_each(|id| *count.entry(id).or_insert(0) += 1);
    count.into_iter().max_by_key(|of| of.1).map(|of| of.0)
}
