//! A drawing as pixels, for a PNG.

use tiny_skia::{
    Color, FillRule, Paint, Path, PathBuilder, Pixmap, PixmapPaint, PremultipliedColorU8, Stroke, Transform,
};

use super::lettering::Lettering;
use super::png::{Pixels, png};
use super::sheet::{Anchor, Shading, Sheet};
use super::style::{Colour, Mark, Theme};

/// Pixels of the file in a px of the drawing, so that it can be printed.
const DENSITY: f32 = 2.0;
/// Outline of bold text over its height.
const BOLD: f32 = 0.06;

/// The pixels of a drawing.
pub(super) struct Raster {
    pixels: Pixmap,
    theme: Theme,
    lettering: Lettering,
}

impl Raster {
    /// An empty drawing of a size in px, which is at least one.
    pub(super) fn new(width: f64, height: f64, theme: &Theme) -> Self {
        let [width, height] = [width, height].map(|side| (side as f32 * DENSITY) as u32);
        let mut pixels = Pixmap::new(width, height).expect("a drawing of one to a few thousand px");
        pixels.fill(opaque(theme.ground));
        Self { pixels, theme: *theme, lettering: Lettering::new() }
    }

    /// Draws a shape in the style of a mark.
    fn draw(&mut self, mark: Mark, shape: &Path, at: Transform) {
        let style = self.theme.style(mark);
        let at = at.post_scale(DENSITY, DENSITY);
        if let Some(colour) = style.fill {
            self.pixels.fill_path(shape, &paint(colour, style.opacity), FillRule::Winding, at, None);
        }
        if let Some((colour, width)) = style.stroke {
            let stroke = Stroke { width, ..Stroke::default() };
            self.pixels.stroke_path(shape, &paint(colour, style.opacity), &stroke, at, None);
        }
    }
}

impl Sheet for Raster {
    fn circle(&mut self, mark: Mark, [x, y]: [f64; 2], radius: f64) {
        if let Some(circle) = PathBuilder::from_circle(x as f32, y as f32, radius as f32) {
            self.draw(mark, &circle, Transform::identity());
        }
    }

    fn line(&mut self, mark: Mark, points: &[[f64; 2]]) {
        let mut path = PathBuilder::new();
        for (number, &[x, y]) in points.iter().enumerate() {
            let (x, y) = (x as f32, y as f32);
            if number == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        // One point is no line.
        if let Some(line) = path.finish() {
            self.draw(mark, &line, Transform::identity());
        }
    }

    fn text(&mut self, mark: Mark, [x, y]: [f64; 2], anchor: Anchor, text: &str) {
        let style = self.theme.style(mark);
        let before = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => self.lettering.width(text, style.font_px) / 2.0,
        };
        let Some(outlines) = self.lettering.outlines(text, style.font_px) else { return };
        let at = Transform::from_translate(x as f32 - before, y as f32);
        self.draw(mark, &outlines, at);
        if let Some(colour) = style.fill.filter(|_| style.bold) {
            let stroke = Stroke { width: BOLD * style.font_px, ..Stroke::default() };
            let at = at.post_scale(DENSITY, DENSITY);
            self.pixels.stroke_path(&outlines, &paint(colour, style.opacity), &stroke, at, None);
        }
    }

    fn shade(&mut self, [x, y]: [f64; 2], shading: &Shading) {
        let Some(mut image) = Pixmap::new(shading.side, shading.side) else { return };
        for (pixel, &opacity) in image.pixels_mut().iter_mut().zip(&shading.opacity) {
            let grey = (u16::from(shading.grey) * u16::from(opacity) / 255) as u8;
            *pixel = PremultipliedColorU8::from_rgba(grey, grey, grey, opacity).expect("grey of at most its opacity");
        }
        let at = Transform::from_translate(x as f32, y as f32).post_scale(DENSITY, DENSITY);
        self.pixels.draw_pixmap(0, 0, image.as_ref(), &PixmapPaint::default(), at, None);
    }

    fn finish(self: Box<Self>) -> Vec<u8> {
        // The sheet is opaque.
        let rgb: Vec<u8> = self.pixels.data().chunks_exact(4).flat_map(|rgba| [rgba[0], rgba[1], rgba[2]]).collect();
        png([self.pixels.width(), self.pixels.height()], Pixels::Rgb, &rgb)
    }
}

fn paint(colour: Colour, opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    let mut colour = opaque(colour);
    colour.apply_opacity(opacity);
    paint.set_color(colour);
    paint
}

fn opaque(colour: Colour) -> Color {
    let [_, red, green, blue] = colour.to_be_bytes();
    Color::from_rgba8(red, green, blue, 255)
}

#[cfg(test)]
mod tests {
    use super::super::style::DAY;
    use super::*;

    /// The colour of the px of the drawing at a place.
    fn at(raster: &Raster, x: u32, y: u32) -> [u8; 3] {
        let pixel = raster.pixels.pixel(2 * x, 2 * y).expect("inside");
        [pixel.red(), pixel.green(), pixel.blue()]
    }

    #[test]
    fn marks_lie_at_their_places_in_their_colours() {
        let mut raster = Raster::new(100.0, 60.0, &DAY);
        raster.circle(Mark::Confirmed, [20.0, 30.0], 5.0);
        raster.line(Mark::Vector, &[[40.0, 30.0], [60.0, 30.0]]);
        raster.circle(Mark::Ring, [80.0, 30.0], 10.0);
        assert_eq!([at(&raster, 20, 30), at(&raster, 50, 30)], [[0x0a, 0x4f, 0x8a]; 2]);
        assert_eq!([at(&raster, 20, 38), at(&raster, 50, 34), at(&raster, 80, 30)], [[255; 3]; 3], "ground");
        assert_ne!(at(&raster, 90, 30), [255; 3], "the ring");
    }

    #[test]
    fn text_is_written_from_its_point_or_about_it() {
        for (anchor, columns) in [(Anchor::Start, 50..80), (Anchor::Middle, 35..66)] {
            let mut raster = Raster::new(100.0, 40.0, &DAY);
            raster.text(Mark::Title, [50.0, 30.0], anchor, "HH");
            let inked: Vec<u32> = (0..100).filter(|&x| (10..30).any(|y| at(&raster, x, y) != [255; 3])).collect();
            let (first, last) = (inked[0], inked[inked.len() - 1]);
            assert!(columns.contains(&first) && columns.contains(&last) && last > first + 15, "{anchor:?}: {inked:?}");
        }
    }

    #[test]
    fn shading_covers_its_square() {
        let mut raster = Raster::new(20.0, 20.0, &DAY);
        let opacity = (0..100).map(|pixel| if pixel == 55 { 255 } else { 0 }).collect();
        raster.shade([10.0, 10.0], &Shading { side: 10, grey: 40, opacity });
        assert_eq!(at(&raster, 15, 15), [40; 3]);
        assert_eq!(at(&raster, 13, 15), [255; 3]);
    }
}
