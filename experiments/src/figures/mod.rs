//! Figures as data: what is to be seen, not how it is drawn (`svg.rs`).
//!
//! One look for all: white ground, units on the axes, the colours of Okabe & Ito (2008), which colour-blind readers can
//! tell apart, and a marker of its own for each colour, so that grey prints can be read too.

pub mod axis;
mod compact;
mod svg;

pub use axis::Axis;

/// One SVG file: panels side by side with a legend for all of them below.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// File name without extension.
    pub name: String,
    /// Above all panels.
    pub title: String,
    /// Panels in a row before the next row begins; 0 for one row.
    pub columns: usize,
    /// From left to right and top to bottom.
    pub panels: Vec<Panel>,
}

/// One diagram.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    /// Above the diagram; empty where the figure's title says everything.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// In the order of drawing.
    pub series: Vec<Series>,
}

/// One line, set of points or band. Series of the same label, colour and shape share their place in the legend.
#[derive(Debug, Clone)]
pub struct Series {
    /// In the legend; empty for none.
    pub label: String,
    /// Index of the colour, counted from 0; [`GREY`] for what is in the background.
    pub colour: usize,
    /// What is drawn.
    pub shape: Shape,
}

/// What is drawn of a series. What is not finite, or outside of fixed limits, leaves a gap.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A solid line through [x, y].
    Line(Vec<[f64; 2]>),
    /// A dashed line through [x, y].
    Dashed(Vec<[f64; 2]>),
    /// A marker at each [x, y].
    Points(Vec<[f64; 2]>),
    /// A dot at each [x, y]: where there are too many for markers.
    Dots(Vec<[f64; 2]>),
    /// A marker at each [x, y] with a bar from lo to hi: [x, y, lo, hi].
    Measured(Vec<[f64; 4]>),
    /// An area between lo and hi: [x, lo, hi].
    Band(Vec<[f64; 3]>),
}

/// Number of colours; indices beyond begin again.
pub const COLOURS: usize = 7;
/// Index of grey: references and backgrounds.
pub const GREY: usize = usize::MAX;

impl Series {
    /// A series of one label, colour and shape.
    pub fn new(label: impl Into<String>, colour: usize, shape: Shape) -> Self {
        Self { label: label.into(), colour, shape }
    }
}

impl Shape {
    /// [x, lowest y, highest y] of everything that is drawn.
    fn extents(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Line(points) | Self::Dashed(points) | Self::Points(points) | Self::Dots(points) => {
                points.iter().map(|&[x, y]| [x, y, y]).collect()
            }
            Self::Measured(points) => points
                .iter()
                .map(|&[x, y, lo, hi]| [x, if lo.is_finite() { lo } else { y }, if hi.is_finite() { hi } else { y }])
                .collect(),
            Self::Band(points) => points.clone(),
        }
    }
}
