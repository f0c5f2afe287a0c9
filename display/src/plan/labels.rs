//! Numbers of tracks, placed so that none covers another, whatever the order of the sites.

use super::lettering::Lettering;

/// Height of a line of text about its font, px.
const LINE: f64 = 1.1;
/// Of a letter above the line on which it stands, px of a font of one.
const ASCENT: f64 = 0.85;
/// Where a label may stand about its track: to the right or the left, and so many px below its middle. The first that is free.
const PLACES: [(bool, f64); 10] = [
    (true, -8.0),
    (true, 16.0),
    (false, -8.0),
    (false, 16.0),
    (true, 4.0),
    (false, 4.0),
    (true, -24.0),
    (true, 32.0),
    (false, -24.0),
    (false, 32.0),
];
/// Between the middle of a track and its label, px.
const GAP: f64 = 9.0;

/// The places that are taken: left, top, right, bottom, px.
pub(super) struct Labels {
    lettering: Lettering,
    taken: Vec<[f64; 4]>,
}

impl Labels {
    /// A plan without labels.
    pub(super) fn new() -> Self {
        Self { lettering: Lettering::new(), taken: Vec::new() }
    }

    /// Takes the place of what is drawn about a point already, px.
    pub(super) fn reserve(&mut self, [x, y]: [f64; 2], radius: f64) {
        self.taken.push([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Where the label of a track at `at` begins, px; `None` where all its places are taken.
    pub(super) fn place(&mut self, at: [f64; 2], text: &str, font_px: f32) -> Option<[f64; 2]> {
        let (width, height) = (f64::from(self.lettering.width(text, font_px)), f64::from(font_px));
        let places = PLACES.map(|(right, below)| [at[0] + if right { GAP } else { -GAP - width }, at[1] + below]);
        let area = |[left, base]: [f64; 2]| {
            let top = base - ASCENT * height;
            [left, top, left + width, top + LINE * height]
        };
        let is_free = |place: &[f64; 2]| {
            let [left, top, right, bottom] = area(*place);
            self.taken.iter().all(|of| right <= of[0] || of[2] <= left || bottom <= of[1] || of[3] <= top)
        };
        let place = places.into_iter().find(is_free)?;
        self.taken.push(area(place));
        Some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same target, seen by three sites and fused.
    #[test]
    fn labels_of_one_place_stand_beside_each_other() {
        let mut labels = Labels::new();
        labels.reserve([500.0, 500.0], 5.0);
        let places: Vec<_> = (0..20).map(|number| labels.place([500.0, 500.0], &format!("S{number}"), 14.0)).collect();
        let placed: Vec<_> = places.iter().flatten().collect();
        assert!(placed.len() >= 6, "{placed:?}");
        assert!(places.last().is_some_and(Option::is_none), "there is no room for all");
        for (number, one) in labels.taken.iter().enumerate() {
            for other in &labels.taken[..number] {
                let apart = one[2] <= other[0] || other[2] <= one[0] || one[3] <= other[1] || other[3] <= one[1];
                assert!(apart, "{one:?} {other:?}");
            }
        }
        // Somewhere else nothing is in the way.
        assert!(labels.place([100.0, 100.0], "7", 14.0).is_some_and(|[left, base]| left > 108.0 && base < 93.0));
    }
}
