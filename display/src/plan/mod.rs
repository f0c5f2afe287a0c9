//! `radar-chain picture`: the plan of a recording at one time, without a browser.

mod cells;
mod draw;
mod labels;
mod lettering;
mod png;
mod raster;
mod scale;
mod sheet;
mod style;
mod svg;

use std::path::{Path, PathBuf};

use anyhow::Context;
use common::config::Sites;
use common::process::BadInput;
use common::recording::Recorded;
use common::units::NS_PER_S;

use crate::picture::Picture;
use crate::view::{Deck, Tape, sites_and_extent};
use cells::Cells;
use draw::{Plan, SIZE, Trails};
use raster::Raster;
use sheet::Sheet;
use style::{DAY, NIGHT, Theme};
use svg::Svg;

/// What is drawn.
#[derive(Debug, Clone)]
pub struct Request {
    /// Time from the begin of the recording, s; `None` for its end.
    pub at_s: Option<f64>,
    /// How much of a track's way is shown, s.
    pub trail_s: f64,
    /// Range of the plan, m; `None` for what the radars cover.
    pub range_m: Option<f64>,
    /// Light on dark.
    pub night: bool,
}

/// Draws recordings of one run, one for each site, as SVG or PNG by the name of `out`.
///
/// # Errors
/// A file cannot be read, is not a recording or is of another run; the time lies outside of it; `out` cannot be written.
pub fn draw(files: &[PathBuf], request: &Request, out: &Path) -> anyhow::Result<()> {
    let theme = if request.night { NIGHT } else { DAY };
    let form = Form::of(out)?;
    let tapes = files.iter().map(|file| Tape::open(file)).collect::<anyhow::Result<Vec<_>>>()?;
    let (sites, (from_ns, to_ns)) = sites_and_extent(&tapes)?;
    let length_s = (to_ns - from_ns) as f64 / NS_PER_S;
    let at_s = request.at_s.unwrap_or(length_s);
    // A run of thirty scans of 1 s is a dwell short of 30 s.
    if !(0.0..=length_s.ceil()).contains(&at_s) {
        return Err(BadInput(format!("--at {at_s} is outside of the recording: expected 0 to {length_s:.1} s")).into());
    }
    let at_ns = (from_ns + (at_s * NS_PER_S) as u64).min(to_ns);
    let (picture, trails, cells) = picture_at(&sites, &tapes, at_ns, request.trail_s);
    let when = jiff::Timestamp::from_millisecond((at_ns / 1_000_000) as i64).map(|time| time.to_string());
    let title = format!("{} · {}", sites.names().join(", "), when.unwrap_or_default());
    let plan = Plan {
        picture: &picture,
        sites: sites.all(),
        trails: &trails,
        cells: &cells,
        title: &title,
        range_m: request.range_m,
        theme,
    };
    let mut sheet = form.sheet(&title, &theme);
    plan.draw(sheet.as_mut());
    std::fs::write(out, sheet.finish()).with_context(|| format!("writing {}", out.display()))
}

/// The forms of a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Svg,
    Png,
}

impl Form {
    /// By the name of a file.
    fn of(out: &Path) -> Result<Self, BadInput> {
        let ending = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(BadInput(format!("--out {}: expected a name that ends in .svg or .png", out.display()))),
        }
    }

    /// An empty sheet.
    fn sheet(self, title: &str, theme: &Theme) -> Box<dyn Sheet> {
        let [width, height] = SIZE;
        match self {
            Self::Svg => Box::new(Svg::new(width, height, title, theme)),
            Self::Png => Box::new(Raster::new(width, height, theme)),
        }
    }
}

/// The picture at a time, the ways of its tracks, and the cells of each site that has recorded them.
fn picture_at(sites: &Sites, tapes: &[Tape], at_ns: u64, trail_s: f64) -> (Picture, Trails, Vec<Cells>) {
    let from_ns = at_ns.saturating_sub((trail_s * NS_PER_S) as u64);
    let (mut picture, mut trails) = (Picture::new(sites), Trails::new());
    let mut cells: Vec<Cells> = tapes.iter().map(|_| Cells::default()).collect();
    let mut deck = Deck::from(tapes, from_ns);
    while let Some((site, message)) = deck.next_until(at_ns) {
        if let Recorded::Tracks(header, tracks) = &message
            && header.time_ns >= from_ns
        {
            let place = &picture.sites[site].place;
            for track in tracks {
                trails.entry((site, track.id)).or_default().push(place.position_m(track.position_m()));
            }
        }
        if let Recorded::Dwells(header, amplitudes) = &message {
            cells[site].take(header, amplitudes);
        }
        picture.take(site, message.by_ref(), 0);
    }
    (picture, trails, cells)
}
