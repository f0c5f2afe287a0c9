//! A drawing as SVG text.

use std::fmt::{Display, Write};

/// A drawing of some size, with classes whose style is given at its head.
#[derive(Debug)]
pub(super) struct Svg(String);

impl Svg {
    /// An empty drawing of a size in px; `style` is CSS.
    pub(super) fn new(width: f64, height: f64, title: &str, style: &str) -> Self {
        let title = escaped(title);
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-label=\"{title}\">\n<title>{title}</title>\n<style>{style}</style>\n"
        ))
    }

    /// Adds an element with attributes.
    pub(super) fn element(&mut self, name: &str, class: &str, attributes: &[(&str, &dyn Display)]) {
        // Writing to a text cannot fail.
        let _ = write!(self.0, "<{name} class=\"{class}\"");
        for (key, value) in attributes {
            let _ = write!(self.0, " {key}=\"{value}\"");
        }
        self.0.push_str("/>\n");
    }

    /// A circle.
    pub(super) fn circle(&mut self, class: &str, [x, y]: [f64; 2], radius: f64) {
        self.element("circle", class, &[("cx", &short(x)), ("cy", &short(y)), ("r", &short(radius))]);
    }

    /// A line through points.
    pub(super) fn line(&mut self, class: &str, points: impl IntoIterator<Item = [f64; 2]>) {
        let mut text = String::new();
        for [x, y] in points {
            let _ = write!(text, "{},{} ", short(x), short(y));
        }
        self.element("polyline", class, &[("points", &text.trim_end())]);
    }

    /// A text that begins (`start`), ends or has its middle at a point.
    pub(super) fn text(&mut self, class: &str, [x, y]: [f64; 2], anchor: &str, text: &str) {
        let text = escaped(text);
        let _ = writeln!(
            self.0,
            "<text class=\"{class}\" x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\">{text}</text>",
            short(x),
            short(y)
        );
    }

    /// The whole drawing.
    pub(super) fn finish(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }
}

/// To a hundredth of a px, which nobody sees.
fn short(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_others_cannot_leave_their_place() {
        let mut svg = Svg::new(10.0, 10.0, "a\"><script>", "");
        svg.text("name", [1.0, 2.0], "start", "<b> & c");
        let text = svg.finish();
        assert!(!text.contains("<script") && text.contains("&lt;b> &amp; c"), "{text}");
        assert!(text.starts_with("<svg") && text.ends_with("</svg>\n"));
    }
}
