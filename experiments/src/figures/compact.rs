//! SVG in fewer bytes: what looks the same is written once.
//!
//! `plotters` writes an element for every dot and dash, with its whole style: half a megabyte for some thousand dots. Here
//! neighbouring elements of one style become one path, without the dots that others cover.

use std::collections::HashSet;
use std::fmt::Write;

/// A dot is left out if another of the same path begins in the same square of this side, in steps: a quarter of its width.
const COVERED: i32 = 3;

/// One element that can share a path with others of its style.
struct Piece<'a> {
    /// Everything that must be equal.
    style: Style<'a>,
    /// Its part of the path.
    shape: Shape<'a>,
}

#[derive(Clone, Copy, PartialEq)]
enum Style<'a> {
    /// Radius and colour.
    Dot(&'a str, &'a str),
    /// Colour and width.
    Line(&'a str, &'a str),
}

enum Shape<'a> {
    Dot(i32, i32),
    Line(&'a str),
}

/// The same picture. Elements stand one a line, as `plotters` writes them.
pub(super) fn compact(svg: &str) -> String {
    let mut text = String::new();
    let mut open: Option<Path<'_>> = None;
    for line in svg.lines() {
        let Some(piece) = Piece::read(line) else {
            close(open.take(), &mut text);
            let _ = writeln!(text, "{line}");
            continue;
        };
        if open.as_ref().is_some_and(|path| path.style != piece.style) {
            close(open.take(), &mut text);
        }
        open.get_or_insert_with(|| Path::new(piece.style)).add(&piece.shape);
    }
    close(open, &mut text);
    text
}

/// Writes the path that is under way, if there is one.
fn close(open: Option<Path<'_>>, text: &mut String) {
    if let Some(path) = open {
        path.write(text);
    }
}

impl<'a> Piece<'a> {
    /// The element in `line`, if it is an opaque dot or line.
    fn read(line: &'a str) -> Option<Self> {
        let line = line.strip_suffix("/>")?;
        let value = |name: &str| {
            let (_, rest) = line.split_once(&format!(" {name}=\""))?;
            rest.split_once('"').map(|(value, _)| value)
        };
        if value("opacity")? != "1" {
            return None;
        }
        if line.starts_with("<circle ") && value("stroke")? == "none" {
            let place = Shape::Dot(value("cx")?.parse().ok()?, value("cy")?.parse().ok()?);
            return Some(Self { style: Style::Dot(value("r")?, value("fill")?), shape: place });
        }
        if line.starts_with("<polyline ") && value("fill")? == "none" {
            let style = Style::Line(value("stroke")?, value("stroke-width")?);
            return Some(Self { style, shape: Shape::Line(value("points")?.trim()) });
        }
        None
    }
}

/// A path under way.
struct Path<'a> {
    style: Style<'a>,
    shape: String,
    /// Squares that have a dot.
    dots: HashSet<(i32, i32)>,
}

impl<'a> Path<'a> {
    fn new(style: Style<'a>) -> Self {
        Self { style, shape: String::new(), dots: HashSet::new() }
    }

    fn add(&mut self, shape: &Shape<'_>) {
        match *shape {
            Shape::Dot(x, y) => {
                if self.dots.insert((x.div_euclid(COVERED), y.div_euclid(COVERED))) {
                    let _ = write!(self.shape, "M{x} {y}h0"); // no length: the round ends of the line are the dot
                }
            }
            Shape::Line(points) => {
                let _ = write!(self.shape, "M{points}"); // further points of an `M` are joined by lines
            }
        }
    }

    fn write(self, text: &mut String) {
        let shape = self.shape;
        let _ = match self.style {
            Style::Dot(radius, colour) => {
                let width = 2.0 * radius.parse().unwrap_or(0.0);
                writeln!(
                    text,
                    "<path d=\"{shape}\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
                )
            }
            Style::Line(colour, width) => {
                writeln!(text, "<path d=\"{shape}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>")
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOT: &str = "r=\"6\" opacity=\"1\" fill=\"#828282\" stroke=\"none\" stroke-width=\"1\"/>";
    const LINE: &str = "<polyline fill=\"none\" opacity=\"1\" stroke=\"#0072B2\" stroke-width=\"8\" points=";

    #[test]
    fn elements_of_one_style_share_a_path_and_covered_dots_go() {
        let svg = format!(
            "<svg>\n<circle cx=\"9\" cy=\"3\" {DOT}\n<circle cx=\"10\" cy=\"4\" {DOT}\n<circle cx=\"40\" cy=\"4\" {DOT}\n\
             {LINE}\"1,2 3,4 \"/>\n{LINE}\"5,6 7,8 \"/>\n<text>a</text>\n</svg>\n"
        );
        let expected = "<svg>\n\
             <path d=\"M9 3h0M40 4h0\" stroke=\"#828282\" stroke-width=\"12\" stroke-linecap=\"round\"/>\n\
             <path d=\"M1,2 3,4M5,6 7,8\" fill=\"none\" stroke=\"#0072B2\" stroke-width=\"8\"/>\n<text>a</text>\n</svg>\n";
        assert_eq!(compact(&svg), expected);
        assert_eq!(compact(expected), expected, "once is enough");
    }

    #[test]
    fn what_shows_through_stays_as_it_is() {
        let svg = format!("<circle cx=\"9\" cy=\"3\" {}\n", DOT.replace("opacity=\"1\"", "opacity=\"0.5\""));
        assert_eq!(compact(&svg), svg);
    }

    #[test]
    fn committed_figures_are_compact() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/img");
        let files = std::fs::read_dir(folder).expect("figures").flatten().map(|entry| entry.path());
        let figures = files.filter(|path| path.extension().is_some_and(|extension| extension == "svg"));
        let mut seen = 0;
        for path in figures {
            let svg = std::fs::read_to_string(&path).expect("a figure");
            assert!(compact(&svg) == svg, "{}: draw it again with --figures docs/img", path.display());
            seen += 1;
        }
        assert!(seen > 0);
    }
}
