//! Which tracks the beam has passed, and which it has reached: two heaps over unwrapped beam angles.
//!
//! A track has one passage to come. A message costs the logarithm of the number of tracks for each that it brings out, and looks at no other.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::tracks::handle::Handle;
use crate::tracks::track::Passage;

/// The passages to come.
#[derive(Debug, Default)]
pub struct Agenda {
    /// By the angle at which all plots of the gates have arrived.
    due: BinaryHeap<Reverse<Appointment>>,
    /// By the angle at which the gates begin. Those of passages that are over stay until they come to the top.
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

    /// Notes the passage to come of a track; that before has been taken.
    pub fn note(&mut self, track: Handle, passage: &Passage) {
        self.due.push(Reverse(Appointment { angle_rad: passage.due_rad(), track }));
        self.begun.push(Reverse(Appointment { angle_rad: passage.begins_rad(), track }));
    }

    /// Takes the first track that is due at `angle_rad`.
    pub fn take_due(&mut self, angle_rad: f64) -> Option<Handle> {
        let first = self.due.peek().filter(|first| first.0.angle_rad <= angle_rad)?.0;
        self.due.pop();
        Some(first.track)
    }

    /// The angle, at most `angle_rad`, from which on plots may still be claimed. `begins` is asked where the passage of a track begins,
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
