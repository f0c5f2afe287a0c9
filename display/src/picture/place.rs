//! Where a site stands in the picture, whose axes are those of the first site: east, north, up of its antenna.

use common::config::Sites;
use common::geodesy::FrameChange;
use common::tracks::{Track, pack};

/// The way from the axes of a site into those of the picture.
#[derive(Debug, Clone, Copy, Default)]
pub struct Placement {
    into_picture: Option<FrameChange>,
    into_site: Option<FrameChange>,
}

impl Placement {
    /// That of each site. Sites whose place is not known are drawn about the same antenna.
    pub fn all(sites: &Sites) -> Vec<Self> {
        let origin = sites.first().site.position;
        let of_site = |index: usize| {
            let own = sites.all()[index].site.position;
            let places = origin.zip(own).filter(|_| index > 0);
            Self {
                into_picture: places.map(|(origin, own)| FrameChange::new(&own, &origin)),
                into_site: places.map(|(origin, own)| FrameChange::new(&origin, &own)),
            }
        };
        (0..sites.all().len()).map(of_site).collect()
    }

    /// A position, m.
    pub fn position_m(&self, position: [f64; 3]) -> [f64; 3] {
        self.into_picture.map_or(position, |change| change.position_m(position))
    }

    /// A position in the picture, in axes of the site, m.
    pub fn of_site_m(&self, position: [f64; 3]) -> [f64; 3] {
        self.into_site.map_or(position, |change| change.position_m(position))
    }

    /// A velocity, or any other vector without a place.
    pub fn vector(&self, vector: [f64; 3]) -> [f64; 3] {
        self.into_picture.map_or(vector, |change| change.vector(vector))
    }

    /// Covariance of the position of a track, m².
    pub fn covariance_m2(&self, track: &Track) -> [[f64; 3]; 3] {
        self.turned(|row, column| track.covariance[pack(3 * row, 3 * column)])
    }

    /// A symmetric 3×3 matrix C of the site's axes as R C Rᵀ.
    pub fn turned(&self, element: impl Fn(usize, usize) -> f64) -> [[f64; 3]; 3] {
        let rows: [[f64; 3]; 3] = std::array::from_fn(|row| std::array::from_fn(|column| element(row, column)));
        if self.into_picture.is_none() {
            return rows;
        }
        let transposed = |of: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|row| std::array::from_fn(|column| of[column][row]))
        };
        // C is symmetric: its rows are its columns, and those of R C become the rows of R (R C)ᵀ.
        let half = transposed(rows.map(|column| self.vector(column)));
        half.map(|row| self.vector(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::config::parse_sites;
    use std::path::Path;

    #[test]
    fn another_site_is_turned_and_shifted_into_the_axes_of_the_first() {
        let site = |name: &str, longitude: f64| {
            format!("[[site]]\nname = \"{name}\"\nposition = {{ latitude_deg = 50.0, longitude_deg = {longitude} }}\n")
        };
        let sites = parse_sites(Path::new("x.toml"), &(site("a", 30.0) + &site("b", 31.0)), &[]).expect("valid");
        let places = Placement::all(&sites);
        assert_eq!(places[0].position_m([1.0, 2.0, 3.0]).map(f64::to_bits), [1.0_f64, 2.0, 3.0].map(f64::to_bits));
        // A degree of longitude at 50° is 71.7 km, and the curvature of the earth takes it below the horizon.
        let [x, y, z] = places[1].position_m([0.0; 3]);
        assert!(
            (x - 71_690.0).abs() < 20.0 && (y - 480.0).abs() < 20.0 && (-420.0..-380.0).contains(&z),
            "{x} {y} {z}"
        );
        let [x, y, z] = places[1].of_site_m([x, y, z]);
        assert!(x.abs() < 1e-6 && y.abs() < 1e-6 && z.abs() < 1e-6, "{x} {y} {z}: there and back");
        // A rotation keeps the trace, and turns an error along the vector with it.
        let along = places[1].vector([0.0, 2.0, 0.0]);
        let turned = places[1].turned(|row, column| if row == 1 && column == 1 { 4.0 } else { 0.0 });
        for row in 0..3 {
            for column in 0..3 {
                assert!((turned[row][column] - along[row] * along[column]).abs() < 1e-12);
            }
        }
    }
}
