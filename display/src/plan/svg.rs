//! A drawing as SVG text.

use std::fmt::{Display, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::png::{Pixels, png};
use super::sheet::{Anchor, Shading, Sheet};
use super::style::{Mark, Theme};

/// A drawing of some size, with a class for each mark whose style is given at its head.
#[derive(Debug)]
pub(super) struct Svg(String);

impl Svg {
    /// An empty drawing of a size in px.
    pub(super) fn new(width: f64, height: f64, title: &str, theme: &Theme) -> Self {
        let title = escaped(title);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-label=\"{title}\">\n<title>{title}</title>\n<style>svg{{font-family:'DejaVu Sans',sans-serif}}"
        );
        for mark in Mark::ALL {
            text.push_str(&rule(mark, theme));
        }
        let ground = colour(Some(theme.ground));
        let mut svg = Self(text + "</style>\n");
        svg.element("rect", &[("width", &"100%"), ("height", &"100%"), ("fill", &ground)]);
        svg
    }

    /// Adds an element with attributes.
    fn element(&mut self, name: &str, attributes: &[(&str, &dyn Display)]) {
        // Writing to a text cannot fail.
        let _ = write!(self.0, "<{name}");
        for (key, value) in attributes {
            let _ = write!(self.0, " {key}=\"{value}\"");
        }
        self.0.push_str("/>\n");
    }
}

impl Sheet for Svg {
    fn circle(&mut self, mark: Mark, [x, y]: [f64; 2], radius: f64) {
        let class = mark.class();
        self.element("circle", &[("class", &class), ("cx", &short(x)), ("cy", &short(y)), ("r", &short(radius))]);
    }

    fn line(&mut self, mark: Mark, points: &[[f64; 2]]) {
        let points: Vec<String> = points.iter().map(|&[x, y]| format!("{},{}", short(x), short(y))).collect();
        self.element("polyline", &[("class", &mark.class()), ("points", &points.join(" "))]);
    }

    fn text(&mut self, mark: Mark, [x, y]: [f64; 2], anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
        };
        let (class, x, y, text) = (mark.class(), short(x), short(y), escaped(text));
        let _ = writeln!(self.0, "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{text}</text>");
    }

    fn shade(&mut self, [x, y]: [f64; 2], shading: &Shading) {
        let pixels: Vec<u8> = shading.opacity.iter().flat_map(|&opacity| [shading.grey, opacity]).collect();
        let image = png([shading.side; 2], Pixels::GreyAlpha, &pixels);
        let address = format!("data:image/png;base64,{}", STANDARD.encode(image));
        let side = shading.side;
        self.element("image", &[("x", &x), ("y", &y), ("width", &side), ("height", &side), ("href", &address)]);
    }

    fn finish(mut self: Box<Self>) -> Vec<u8> {
        self.0.push_str("</svg>\n");
        self.0.into_bytes()
    }
}

/// The style of a mark as a rule of CSS.
fn rule(mark: Mark, theme: &Theme) -> String {
    let style = theme.style(mark);
    let mut rule = format!(".{}{{fill:{}", mark.class(), colour(style.fill));
    if let Some((of_line, width)) = style.stroke {
        let _ = write!(rule, ";stroke:{};stroke-width:{width}", colour(Some(of_line)));
    }
    if style.opacity < 1.0 {
        let _ = write!(rule, ";opacity:{}", style.opacity);
    }
    let _ = write!(rule, ";font-size:{}px", style.font_px);
    if style.bold {
        rule.push_str(";font-weight:bold");
    }
    rule + "}"
}

fn colour(of: Option<u32>) -> String {
    of.map_or("none".into(), |colour| format!("#{colour:06x}"))
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
    use super::super::style::DAY;
    use super::*;

    #[test]
    fn names_of_others_cannot_leave_their_place() {
        let mut svg = Svg::new(10.0, 10.0, "a\"><script>", &DAY);
        svg.text(Mark::Note, [1.0, 2.0], Anchor::Start, "<b> & c");
        let text = String::from_utf8(Box::new(svg).finish()).expect("text");
        assert!(!text.contains("<script") && text.contains("&lt;b> &amp; c"), "{text}");
        assert!(text.starts_with("<svg") && text.ends_with("</svg>\n"));
    }

    #[test]
    fn a_mark_has_the_style_of_its_theme() {
        assert_eq!(
            rule(Mark::Trail, &DAY),
            ".trail{fill:none;stroke:#0a6bb5;stroke-width:1.5;opacity:0.55;font-size:14px}"
        );
        assert_eq!(rule(Mark::Number, &DAY), ".number{fill:#0a3d69;font-size:14px;font-weight:bold}");
    }
}
