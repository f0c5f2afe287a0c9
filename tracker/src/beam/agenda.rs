//! Tracks by the time the beam reaches them, and by the time it has passed them: two heaps over unwrapped beam angles.
//!
//! A track has one detection opportunity to come. A message costs the logarithm of the number of tracks for each that it brings out, and looks at no other.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::opportunity::Opportunity;
use crate::tracks::handle::Handle;

/// The opportunities to come.
#[derive(Debug, Default)]
pub struct Agenda {
    /// By the angle at which all plots of the gates have arrived.
    due: BinaryHeap<Reverse<Appointment>>,
    /// By the angle at which the gates begin. Those of opportunities that are over stay until they come to the top.
    begun: BinaryHeap<Reverse<Appointment>>,
}

#[derive(Debug, Clone, Copy)]
struct Appointment {
    angle_rad: f64,
    track: Handle,
}

impl Agenda {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.due.clear();
        self.begun.clear();
    }

    /// Adds the opportunity to come of a track; that before has been taken out.
    pub fn add(&mut self, track: Handle, next: &Opportunity) {
        self.due.push(Reverse(Appointment { angle_rad: next.due_rad(), track }));
        self.begun.push(Reverse(Appointment { angle_rad: next.begins_rad(), track }));
    }

    /// Takes out the first track that is due at `angle_rad`.
    pub fn pop_due(&mut self, angle_rad: f64) -> Option<Handle> {
        let first = self.due.peek().filter(|first| first.0.angle_rad <= angle_rad)?.0;
        self.due.pop();
        Some(first.track)
    }

    /// The angle, at most `angle_rad`, from which on plots may still be claimed. `begins` is asked where the opportunity of a track begins,
    /// if it is alive.
    pub fn claimed_from(&mut self, angle_rad: f64, begins: impl Fn(Handle) -> Option<f64>) -> f64 {
        while let Some(&Reverse(first)) = self.begun.peek() {
            if first.angle_rad >= angle_rad {
                break;
            }
            if begins(first.track).is_some_and(|begins_rad| begins_rad <= first.angle_rad) {
                return first.angle_rad;
            }
            self.begun.pop();
        }
        angle_rad
    }
}

impl Ord for Appointment {
    fn cmp(&self, other: &Self) -> Ordering {
        self.angle_rad.total_cmp(&other.angle_rad).then(self.track.cmp(&other.track))
    }
}

impl PartialOrd for Appointment {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Appointment {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Appointment {}
