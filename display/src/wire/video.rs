//! Radar video as clients get it: levels of a sector, no finer than a screen can show.

use serde::Serialize;

use super::columns::block;
use crate::picture::video::{DB_FIRST, DB_STEP, SectorVideo};

/// How fine a client wants the video of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fineness {
    /// Lines in a scan.
    pub lines: u32,
    /// Cells in a line.
    pub ranges: u32,
}

/// Header of the video of a sector.
#[derive(Debug, Serialize)]
struct VideoHead<'a> {
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
    let share = video.lines() as f64 / f64::from(video.lines_per_scan.max(1));
    let wanted = (f64::from(fineness.lines) * share).round() as usize;
    let (lines, ranges) = (wanted.clamp(1, video.lines().max(1)), (fineness.ranges as usize).clamp(1, video.ranges));
    let levels = thinned(&video.levels, [video.lines(), video.ranges], [lines, ranges]);
    let coarser = video.lines() as f64 / lines as f64;
    let coarser_ranges = video.ranges as f64 / ranges as f64;
    let centre = |coarser: f64| (coarser - 1.0) / 2.0;
    let head = VideoHead {
        r#type: "video",
        site,
        scan: video.scan,
        sector: video.sector,
        time_s: video.time_s,
        azimuth_first_rad: video.azimuth_first_rad + centre(coarser) * video.azimuth_step_rad,
        azimuth_step_rad: video.azimuth_step_rad * coarser,
        lines,
        range_first_m: video.range_first_m + centre(coarser_ranges) * video.range_step_m,
        range_step_m: video.range_step_m * coarser_ranges,
        ranges,
        db_first: DB_FIRST,
        db_step: DB_STEP,
    };
    block(&head, "level", &levels)
}

/// Rows and columns of `levels`, row by row, as fewer ones: each the maximum of those that it stands for.
fn thinned(levels: &[u8], [rows, columns]: [usize; 2], [new_rows, new_columns]: [usize; 2]) -> Vec<u8> {
    let mut out = vec![0; new_rows * new_columns];
    if rows == 0 || columns == 0 {
        return out;
    }
    for (row, line) in levels.chunks_exact(columns).enumerate() {
        let new_row = row * new_rows / rows;
        let new_line = &mut out[new_row * new_columns..][..new_columns];
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
        assert_eq!(thinned(&levels, [3, 4], [3, 4]), levels);
        assert_eq!(thinned(&levels, [3, 4], [1, 2]), [200, 12]);
        assert_eq!(thinned(&levels, [3, 4], [2, 1]), [8, 200]);
        assert_eq!(thinned(&[], [0, 4], [1, 1]), [0]);
    }
}
