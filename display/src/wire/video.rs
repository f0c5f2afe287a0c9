//! Radar video as clients get it: levels of a sector, no finer than a screen can show.

use std::f64::consts::TAU;

use schemars::JsonSchema;
use serde::Serialize;

use super::columns::block;
use crate::picture::video::{DB_FIRST, DB_STEP, SectorVideo};

/// Lines of a radar lie on edges of the grid where both have as many; a rounding error must not put one beside its own.
const ROUNDING: f64 = 1e-6;

/// How fine a client wants the video of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Fineness {
    /// Lines in a turn.
    pub lines: u32,
    /// Cells in a line.
    pub ranges: u32,
}

/// Header of the video of a sector.
#[derive(Debug, Serialize, JsonSchema)]
pub struct VideoHead<'a> {
    r#type: &'static str,
    site: &'a str,
    scan: u32,
    sector: u32,
    time_s: f64,
    azimuth_first_rad: f64,
    azimuth_step_rad: f64,
    lines: usize,
    range_first_m: f64,
    range_step_m: f64,
    ranges: usize,
    db_first: f32,
    db_step: f32,
}

/// The video of a sector as a binary frame, thinned by maxima: what is strong stays visible.
pub fn frame(site: &str, video: &SectorVideo, fineness: Fineness) -> Vec<u8> {
    let grid = Grid::new(video, fineness.lines);
    let ranges = (fineness.ranges as usize).clamp(1, video.ranges);
    let levels = thinned(&video.levels, video.ranges, |line| grid.row(line), [grid.rows(video.lines()), ranges]);
    let coarser_ranges = video.ranges as f64 / ranges as f64;
    let head = VideoHead {
        r#type: "video",
        site,
        scan: video.scan,
        sector: video.sector,
        time_s: video.time_s,
        azimuth_first_rad: grid.azimuth_first_rad(),
        azimuth_step_rad: grid.step_rad,
        lines: grid.rows(video.lines()),
        range_first_m: video.range_first_m + (coarser_ranges - 1.0) / 2.0 * video.range_step_m,
        range_step_m: video.range_step_m * coarser_ranges,
        ranges,
        db_first: DB_FIRST,
        db_step: DB_STEP,
    };
    block(&head, "level", &levels)
}

/// The lines of a turn as a client gets them. They lie at the same azimuths in every sector, however many lines of the radar
/// it has, and in every scan: a client keeps one picture of a turn. A line that two sectors share comes with both.
#[derive(Debug, Clone, Copy)]
struct Grid {
    /// Azimuth of the middle of the first line of the sector, and from there to the next, in lines of the grid.
    first: f64,
    per_line: f64,
    /// Between lines of the grid, rad; negative where the radar turns counter-clockwise.
    step_rad: f64,
}

impl Grid {
    /// At most `wanted` lines in a turn, and no more than the radar has.
    fn new(video: &SectorVideo, wanted: u32) -> Self {
        let of_radar = (TAU / video.azimuth_step_rad.abs() + ROUNDING).floor();
        let lines = of_radar.min(f64::from(wanted)).max(1.0);
        let per_rad = lines / TAU;
        Self {
            first: video.azimuth_first_rad * per_rad,
            per_line: video.azimuth_step_rad * per_rad,
            step_rad: video.azimuth_step_rad.signum() / per_rad,
        }
    }

    /// The line of the grid in which a line of the sector lies, counted from that of its first.
    fn row(&self, line: usize) -> usize {
        let at = |line: usize| (self.first + self.per_line * line as f64 + ROUNDING).floor();
        (at(line) - at(0)).abs() as usize
    }

    /// Lines of the grid in a sector of so many.
    fn rows(&self, lines: usize) -> usize {
        self.row(lines.max(1) - 1) + 1
    }

    /// Middle of the first line, rad.
    fn azimuth_first_rad(&self) -> f64 {
        ((self.first + ROUNDING).floor() + 0.5) * self.step_rad.abs()
    }
}

/// `levels`, line by line of `columns`, as fewer ones: each the maximum of those that it stands for. `new_row` says where a line
/// goes.
fn thinned(
    levels: &[u8],
    columns: usize,
    new_row: impl Fn(usize) -> usize,
    [new_rows, new_columns]: [usize; 2],
) -> Vec<u8> {
    let mut out = vec![0; new_rows * new_columns];
    for (row, line) in levels.chunks_exact(columns.max(1)).enumerate() {
        let new_line = &mut out[new_row(row) * new_columns..][..new_columns];
        for (column, &level) in line.iter().enumerate() {
            let cell = &mut new_line[column * new_columns / columns];
            *cell = (*cell).max(level);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_strong_stays_when_video_is_thinned() {
        let levels = [1, 2, 3, 4, 5, 6, 7, 8, 9, 200, 11, 12];
        assert_eq!(thinned(&levels, 4, |row| row, [3, 4]), levels);
        assert_eq!(thinned(&levels, 4, |_| 0, [1, 2]), [200, 12]);
        assert_eq!(thinned(&levels, 4, |row| row / 2, [2, 1]), [8, 200]);
        assert_eq!(thinned(&[], 4, |_| 0, [1, 1]), [0]);
    }

    /// A turn of 1040 lines in sectors of 32 and 33, as fine as asked for: every line of the radar lies in the line of the grid
    /// that its azimuth says.
    #[test]
    fn lines_lie_at_the_same_azimuths_in_all_sectors() {
        let step_rad = TAU / 1040.0;
        for (wanted, expected) in [(4096, 1040.0), (1040, 1040.0), (1024, 1024.0), (512, 512.0), (64, 64.0)] {
            for turning in [1.0, -1.0] {
                let (mut line, mut seen) = (0, vec![false; expected as usize]);
                for sector in 0..32_u32 {
                    let lines = 32 + (sector % 2) as usize;
                    let video = SectorVideo {
                        scan: 0,
                        sector,
                        time_s: 0.0,
                        azimuth_first_rad: (turning * (f64::from(line) + 0.5) * step_rad).rem_euclid(TAU),
                        azimuth_step_rad: turning * step_rad,
                        range_first_m: 0.0,
                        range_step_m: 1.0,
                        ranges: 1,
                        levels: vec![1; lines],
                    };
                    let grid = Grid::new(&video, wanted);
                    assert!((grid.step_rad * turning - TAU / expected).abs() < 1e-12, "{wanted}: {}", grid.step_rad);
                    let first = (grid.azimuth_first_rad() / TAU * expected).floor() as i64;
                    for of_sector in 0..lines {
                        let azimuth_rad = video.azimuth_first_rad + of_sector as f64 * video.azimuth_step_rad;
                        let its = (azimuth_rad / TAU * expected + 1e-6).floor() as i64;
                        let row = first + turning as i64 * grid.row(of_sector) as i64;
                        assert_eq!(row, its, "{wanted}, line {of_sector} of sector {sector}");
                        seen[row.rem_euclid(expected as i64) as usize] = true;
                    }
                    assert_eq!(grid.rows(lines), grid.row(lines - 1) + 1);
                    line += lines as i32;
                }
                assert!(seen.iter().all(|&seen| seen), "{wanted}: no line of the grid is empty");
            }
        }
    }
}
