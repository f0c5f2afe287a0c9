//! Text as outlines, from the font inside the program: a drawing needs no fonts of the machine.

use tiny_skia::{Path, PathBuilder, Transform};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// DejaVu Sans: Latin, Greek, Cyrillic and a few signs; its licence lies beside it.
const FONT: &[u8] = include_bytes!("../../fonts/DejaVuSans-latin-greek-cyrillic.ttf");

/// The letters of the font.
#[derive(Debug, Clone)]
pub(super) struct Lettering(Face<'static>);

impl Lettering {
    /// Reads the font.
    pub(super) fn new() -> Self {
        Self(Face::parse(FONT, 0).expect("the font inside the program"))
    }

    /// The outlines of a text from the origin to the right, px, y down; none of one without ink. What the font does not have
    /// is an empty box.
    pub(super) fn outlines(&self, text: &str, font_px: f32) -> Option<Path> {
        let (mut pen, mut outlines) = (0.0, Pen(PathBuilder::new(), 0.0));
        for glyph in self.glyphs(text) {
            outlines.1 = pen;
            // A space has no outline.
            let _ = self.0.outline_glyph(glyph, &mut outlines);
            pen += self.advance(glyph);
        }
        let per_unit = font_px / f32::from(self.0.units_per_em());
        outlines.0.finish()?.transform(Transform::from_scale(per_unit, -per_unit))
    }

    /// How wide a text is, px.
    pub(super) fn width(&self, text: &str, font_px: f32) -> f32 {
        let units: f32 = self.glyphs(text).map(|glyph| self.advance(glyph)).sum();
        units * font_px / f32::from(self.0.units_per_em())
    }

    fn glyphs<'a>(&'a self, text: &'a str) -> impl Iterator<Item = GlyphId> + 'a {
        text.chars().map(|letter| self.0.glyph_index(letter).unwrap_or(GlyphId(0)))
    }

    /// From one letter to the next, units of the font.
    fn advance(&self, glyph: GlyphId) -> f32 {
        f32::from(self.0.glyph_hor_advance(glyph).unwrap_or(0))
    }
}

/// Where the next letter is drawn, units of the font.
struct Pen(PathBuilder, f32);

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(self.1 + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(self.1 + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(self.1 + x1, y1, self.1 + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(self.1 + x1, y1, self.1 + x2, y2, self.1 + x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All signs that a plan has by itself.
    #[test]
    fn the_font_has_what_a_plan_says() {
        let lettering = Lettering::new();
        for letter in "0123456789 ABC abc ●○·+°:-.,()äß ДЖ λσ".chars() {
            assert!(lettering.0.glyph_index(letter).is_some_and(|glyph| glyph.0 > 0), "{letter}");
        }
    }

    #[test]
    fn a_text_stands_on_its_line_and_is_as_wide_as_said() {
        let lettering = Lettering::new();
        let bounds = lettering.outlines("Hill 7", 20.0).expect("ink").bounds();
        assert!(bounds.bottom().abs() < 0.5 && (-16.0..=-14.0).contains(&bounds.top()), "{bounds:?}");
        let width = lettering.width("Hill 7", 20.0);
        assert!(bounds.left() > 0.0 && bounds.right() < width && bounds.right() > width - 3.0, "{bounds:?} of {width}");
        assert!(lettering.outlines("  ", 20.0).is_none());
        // What it does not have is a box and no gap.
        assert!(lettering.outlines("雷", 20.0).is_some());
    }
}
