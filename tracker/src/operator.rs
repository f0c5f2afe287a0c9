//! What an operator has asked for: zones in which tracks begin otherwise than by themselves, tracks to begin and to end.

use common::commands::{
    ACCEPTED, ACQUIRE, ACQUIRED, ACQUISITION_ZONE, Command, DROP, EXCLUSION_ZONE, EXPIRED, LABEL, MAX_ZONES,
    NO_SUCH_TRACK, NO_SUCH_ZONE, REFUSED, REMOVE_ZONE, TOO_MANY,
};

use crate::constants::ACQUISITION_TURNS;
use crate::tracks::handle::Handle;

/// How a track may begin at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Beginning {
    /// By the evidence of its plots.
    Usual,
    /// Confirmed from its first two plots on.
    AtOnce,
    /// Not.
    Never,
}

/// The wishes of an operator that are still to be kept.
#[derive(Debug, Default)]
pub(crate) struct Operator {
    /// Zones, each as the command that has set it.
    zones: Vec<Command>,
    /// Places at which a track is to begin, and the turns that are left for it.
    acquisitions: Vec<(Command, u32)>,
    /// Tracks that end with the next plots.
    pub(crate) dropped: Vec<Handle>,
    /// What has become of acquisitions.
    told: Vec<Command>,
}

impl Operator {
    /// Carries out a command; `track` is the one that it means, if that lives. What comes of it.
    pub(crate) fn carry_out(&mut self, command: &Command, track: Option<Handle>) -> u32 {
        let is_zone = |zone: &Command| zone.name == command.name;
        let corners = command.corners_m();
        if !corners.iter().flatten().all(|coordinate| coordinate.is_finite()) || !command.radius_m.is_finite() {
            return REFUSED;
        }
        match command.kind {
            ACQUIRE if corners.len() == 1 => {
                if self.acquisitions.len() == MAX_ZONES {
                    return TOO_MANY;
                }
                self.acquisitions.push((*command, ACQUISITION_TURNS));
            }
            DROP | LABEL => {
                let Some(track) = track.filter(|track| !self.dropped.contains(track)) else { return NO_SUCH_TRACK };
                self.dropped.extend((command.kind == DROP).then_some(track));
            }
            EXCLUSION_ZONE | ACQUISITION_ZONE if corners.len() >= 3 && !command.name.is_empty() => {
                self.zones.retain(|zone| !is_zone(zone));
                if self.zones.len() == MAX_ZONES {
                    return TOO_MANY;
                }
                self.zones.push(*command);
            }
            REMOVE_ZONE => {
                let before = self.zones.len();
                self.zones.retain(|zone| !is_zone(zone));
                if self.zones.len() == before {
                    return NO_SUCH_ZONE;
                }
            }
            _ => return REFUSED,
        }
        ACCEPTED
    }

    /// How a track may begin at a place east and north of the antenna, m. `usual_radius_m` is the reach of an acquisition that
    /// names none.
    pub(crate) fn beginning_at(&self, place_m: [f64; 2], usual_radius_m: f64) -> Beginning {
        if self.acquisition_at(place_m, usual_radius_m).is_some() {
            return Beginning::AtOnce;
        }
        let within = |kind| self.zones.iter().any(|zone| zone.kind == kind && contains(zone.corners_m(), place_m));
        match () {
            () if within(EXCLUSION_ZONE) => Beginning::Never,
            () if within(ACQUISITION_ZONE) => Beginning::AtOnce,
            () => Beginning::Usual,
        }
    }

    /// The zones, each as the command that has set it.
    pub(crate) fn zones(&self) -> &[Command] {
        &self.zones
    }

    /// Whether anything here says how tracks begin.
    pub(crate) fn has_places(&self) -> bool {
        !self.zones.is_empty() || !self.acquisitions.is_empty()
    }

    /// Notes that the track `id` has begun at a place: if it was asked for there, that is done.
    pub(crate) fn begun(&mut self, place_m: [f64; 2], usual_radius_m: f64, id: u64) {
        if let Some(index) = self.acquisition_at(place_m, usual_radius_m) {
            let (command, _) = self.acquisitions.remove(index);
            self.told.push(Command { track_id: id, outcome: ACQUIRED, ..command });
        }
    }

    /// A turn is over: acquisitions for which nothing could begin are given up.
    pub(crate) fn end_turn(&mut self) {
        self.acquisitions.iter_mut().for_each(|(_, turns)| *turns -= 1);
        let expired = self.acquisitions.extract_if(.., |(_, turns)| *turns == 0);
        self.told.extend(expired.map(|(command, _)| Command { outcome: EXPIRED, ..command }));
    }

    /// What has become of acquisitions since this was asked last.
    pub(crate) fn take_told(&mut self) -> std::vec::Drain<'_, Command> {
        self.told.drain(..)
    }

    fn acquisition_at(&self, place_m: [f64; 2], usual_radius_m: f64) -> Option<usize> {
        self.acquisitions.iter().position(|(command, _)| {
            let [x, y] = command.corners_m[0];
            let radius_m = if command.radius_m > 0.0 { command.radius_m } else { usual_radius_m };
            (place_m[0] - x).hypot(place_m[1] - y) <= radius_m
        })
    }
}

/// Whether a polygon contains a point: a ray from it to the east meets an odd number of sides.
fn contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let met = sides.filter(|&(&[ax, ay], &[bx, by])| (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax));
    met.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::label::Label;
    use proptest::prelude::*;

    fn zone(kind: u32, name: &str, corners: &[[f64; 2]]) -> Command {
        Command { name: Label::new(name), ..Command::new(kind, 1, 1).at(corners) }
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];

    #[test]
    fn zones_say_where_tracks_begin_until_they_are_removed() {
        let mut operator = Operator::default();
        let inside = [5.0, 5.0];
        assert_eq!(operator.beginning_at(inside, 1.0), Beginning::Usual);
        assert_eq!(operator.carry_out(&zone(ACQUISITION_ZONE, "a", &SQUARE), None), ACCEPTED);
        assert_eq!(operator.beginning_at(inside, 1.0), Beginning::AtOnce);
        assert_eq!(operator.carry_out(&zone(EXCLUSION_ZONE, "b", &SQUARE), None), ACCEPTED);
        assert_eq!(operator.beginning_at(inside, 1.0), Beginning::Never, "exclusion is stronger");
        assert_eq!(operator.beginning_at([15.0, 5.0], 1.0), Beginning::Usual);
        assert_eq!(operator.carry_out(&zone(REMOVE_ZONE, "b", &[]), None), ACCEPTED);
        assert_eq!(operator.carry_out(&zone(REMOVE_ZONE, "b", &[]), None), NO_SUCH_ZONE);
        assert_eq!(operator.beginning_at(inside, 1.0), Beginning::AtOnce);
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        let mut operator = Operator::default();
        for command in [
            zone(EXCLUSION_ZONE, "two corners", &SQUARE[..2]),
            zone(EXCLUSION_ZONE, "", &SQUARE),
            zone(EXCLUSION_ZONE, "nowhere", &[[f64::NAN, 0.0], [1.0, 0.0], [1.0, 1.0]]),
            zone(ACQUIRE, "", &[]),
            zone(99, "a", &SQUARE),
        ] {
            assert_eq!(operator.carry_out(&command, None), REFUSED, "{}", command.name);
        }
        assert_eq!(operator.carry_out(&zone(DROP, "", &[]), None), NO_SUCH_TRACK);
        for number in 0..MAX_ZONES {
            assert_eq!(operator.carry_out(&zone(EXCLUSION_ZONE, &number.to_string(), &SQUARE), None), ACCEPTED);
        }
        assert_eq!(operator.carry_out(&zone(EXCLUSION_ZONE, "one more", &SQUARE), None), TOO_MANY);
        assert_eq!(operator.carry_out(&zone(ACQUISITION_ZONE, "7", &SQUARE), None), ACCEPTED, "in place of another");
    }

    #[test]
    fn an_acquisition_ends_with_its_track_or_after_some_turns() {
        let mut operator = Operator::default();
        operator.carry_out(&zone(EXCLUSION_ZONE, "all", &SQUARE), None);
        operator.carry_out(&Command::new(ACQUIRE, 5, 6).at(&[[5.0, 5.0]]), None);
        assert_eq!(operator.beginning_at([5.0, 6.0], 2.0), Beginning::AtOnce, "asked for by hand");
        assert_eq!(operator.beginning_at([5.0, 8.0], 2.0), Beginning::Never);
        operator.begun([5.0, 6.0], 2.0, 77);
        let told: Vec<Command> = operator.take_told().collect();
        assert_eq!((told[0].outcome, told[0].track_id, told[0].id), (ACQUIRED, 77, 6));
        assert_eq!(operator.beginning_at([5.0, 6.0], 2.0), Beginning::Never);
        operator.carry_out(&Command::new(ACQUIRE, 5, 7).at(&[[5.0, 5.0]]), None);
        (0..ACQUISITION_TURNS).for_each(|_| operator.end_turn());
        let told: Vec<(u32, u64)> = operator.take_told().map(|command| (command.outcome, command.id)).collect();
        assert_eq!(told, [(EXPIRED, 7)]);
    }

    proptest! {
        /// In a convex polygon are the points on one side of all its sides.
        #[test]
        fn a_polygon_contains_what_all_its_sides_do(point in [-3.0..3.0_f64, -3.0..3.0_f64], corners in 3_u32..12) {
            let angle = |corner: u32| std::f64::consts::TAU * f64::from(corner) / f64::from(corners);
            let polygon: Vec<[f64; 2]> = (0..corners).map(|i| [2.0 * angle(i).cos(), 2.0 * angle(i).sin()]).collect();
            let left = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
            let sides: Vec<f64> =
                (0..polygon.len()).map(|i| left(polygon[i], polygon[(i + 1) % polygon.len()])).collect();
            prop_assume!(sides.iter().all(|side| side.abs() > 1e-9));
            prop_assert_eq!(contains(&polygon, point), sides.iter().all(|&side| side > 0.0));
        }
    }
}
