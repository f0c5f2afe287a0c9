//! The seam for the forms of a drawing: what a plan is drawn on.

use super::style::Mark;

/// Where a text stands about its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    /// It begins there.
    Start,
    /// It has its middle there.
    Middle,
}

/// A square of one grey, px by px more or less opaque, row by row from the top.
#[derive(Debug)]
pub(super) struct Shading {
    /// px.
    pub(super) side: u32,
    /// 0 black, 255 white.
    pub(super) grey: u8,
    /// Of each px.
    pub(super) opacity: Vec<u8>,
}

/// A sheet of paper with the origin in its upper left corner; all lengths in px.
pub(super) trait Sheet {
    /// A circle.
    fn circle(&mut self, mark: Mark, centre: [f64; 2], radius: f64);
    /// A line through points; where the mark is filled, the area inside it.
    fn line(&mut self, mark: Mark, points: &[[f64; 2]]);
    /// A line of text.
    fn text(&mut self, mark: Mark, at: [f64; 2], anchor: Anchor, text: &str);
    /// Shades a square whose upper left corner is at `corner`.
    fn shade(&mut self, corner: [f64; 2], shading: &Shading);
    /// The file of the drawing.
    fn finish(self: Box<Self>) -> Vec<u8>;
}
