//! Drawing of figures with `plotters`.

use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::compact::compact;
use super::{Axis, COLOURS, Figure, GREY, Panel, Series, Shape};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Places, Places>>;

/// Blue, vermilion, bluish green, reddish purple, orange, sky blue, black (Okabe & Ito 2008).
const PALETTE: [RGBColor; COLOURS] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];
const BACKGROUND_GREY: RGBColor = RGBColor(130, 130, 130);
const INK: RGBColor = RGBColor(40, 40, 40);

/// Steps in a pixel: `plotters` draws in whole numbers, and lines must not have stairs.
const FINE: u32 = 4;
/// Size of one panel, of one line of the legend and of the titles, steps; and the least width of a figure.
const PANEL: [u32; 2] = [460 * FINE, 330 * FINE];
const LEGEND_LINE: u32 = 24 * FINE;
const TITLE: u32 = 40 * FINE;
const PANEL_TITLE: u32 = 22 * FINE;
const LEAST_WIDTH: u32 = 680 * FINE;
/// Text of ticks and legend, and of titles.
const TEXT: u32 = 16 * FINE;
const TITLE_TEXT: u32 = 20 * FINE;
/// Length of a legend's sample, steps, and width of its letters on the average.
const SAMPLE: i32 = step(28);
const LETTER: f64 = 7.2 * FINE as f64;
/// Half the size of a marker, steps.
const MARKER: i32 = step(4);
const DOT: i32 = 6;
/// Widths of lines, steps.
const THICK: u32 = 2 * FINE;
const THIN: u32 = FINE;

/// Pixels in steps.
const fn step(pixels: i32) -> i32 {
    pixels * FINE as i32
}

impl Figure {
    /// The figure as SVG.
    ///
    /// # Errors
    /// If it cannot be drawn; that is a fault of this module.
    pub fn to_svg(&self) -> anyhow::Result<String> {
        let columns = if self.columns == 0 { self.panels.len() } else { self.columns }.max(1);
        let rows = self.panels.len().div_ceil(columns).max(1);
        let width = (PANEL[0] * columns as u32).max(LEAST_WIDTH);
        let legend = self.legend(width as i32 - step(40));
        let height = TITLE + PANEL[1] * rows as u32 + LEGEND_LINE * legend.len() as u32 + 14 * FINE;
        let mut text = String::new();
        self.draw(&mut text, [width, height], [columns, rows], &legend)
            .map_err(|error| anyhow!("drawing figure {}: {error}", self.name))?;
        // Shown in pixels; the view box keeps the steps.
        let shown = format!("width=\"{}\" height=\"{}\"", width / FINE, height / FINE);
        Ok(compact(&text.replacen(&format!("width=\"{width}\" height=\"{height}\""), &shown, 1)))
    }

    fn draw(
        &self,
        text: &mut String,
        [width, height]: [u32; 2],
        [columns, rows]: [usize; 2],
        legend: &[Vec<&Series>],
    ) -> Result<(), Box<dyn std::error::Error>> {
        let root = SVGBackend::with_string(text, (width, height)).into_drawing_area();
        root.fill(&WHITE)?;
        let title = ("sans-serif", TITLE_TEXT).into_font().color(&INK).pos(Pos::new(HPos::Center, VPos::Center));
        root.draw_text(&self.title, &title, (width as i32 / 2, TITLE as i32 / 2))?;
        let (_, rest) = root.split_vertically(TITLE);
        let (panels, below) = rest.split_vertically(PANEL[1] * rows as u32);
        for (panel, area) in self.panels.iter().zip(panels.split_evenly((rows, columns))) {
            panel.draw(&area)?;
        }
        for (line, entries) in legend.iter().enumerate() {
            let mut x = (width as i32 - entries.iter().map(|series| legend_width(series)).sum::<i32>()) / 2;
            let y = step(8) + (line as u32 * LEGEND_LINE + LEGEND_LINE / 2) as i32;
            for series in entries {
                series.draw_sample(&below, x, y)?;
                x += legend_width(series);
            }
        }
        root.present()?;
        Ok(())
    }

    /// One series of each label, in lines that are not wider than `width`.
    fn legend(&self, width: i32) -> Vec<Vec<&Series>> {
        let mut lines: Vec<Vec<&Series>> = Vec::new();
        let mut room = 0;
        let all = || self.panels.iter().flat_map(|panel| &panel.series);
        for (place, series) in all().enumerate() {
            let again = all().take(place).any(|earlier| earlier.has_legend_of(series));
            if series.label.is_empty() || again {
                continue;
            }
            match lines.last_mut() {
                Some(line) if room >= legend_width(series) => line.push(series),
                _ => {
                    lines.push(vec![series]);
                    room = width;
                }
            }
            room -= legend_width(series);
        }
        lines
    }
}

fn legend_width(series: &Series) -> i32 {
    SAMPLE + step(26) + (LETTER * series.label.chars().count() as f64) as i32
}

impl Panel {
    fn draw(&self, area: &Area<'_>) -> Result<(), Box<dyn std::error::Error>> {
        let extents = || self.series.iter().flat_map(|series| series.shape.extents());
        let x_ends = self.x.ends(extents().map(|[x, _, _]| self.x.place(x)));
        let y_ends = self.y.ends(extents().flat_map(|[_, lo, hi]| [self.y.place(lo), self.y.place(hi)]));
        let (x_ticks, y_ticks) = (self.x.ticks(x_ends), self.y.ticks(y_ends));
        let (head, area) = area.split_vertically(if self.title.is_empty() { 0 } else { PANEL_TITLE });
        let text = ("sans-serif", TEXT).into_font().color(&INK);
        let centred = text.pos(Pos::new(HPos::Center, VPos::Center));
        // Over the diagram, without the labels at its left.
        let middle = i32::midpoint(head.dim_in_pixel().0 as i32, step(60));
        head.draw_text(&self.title, &centred, (middle, PANEL_TITLE as i32 / 2))?;
        let mut builder = ChartBuilder::on(&area);
        builder.margin(8 * FINE).margin_right(20 * FINE).x_label_area_size(46 * FINE).y_label_area_size(70 * FINE);
        let mut chart = builder.build_cartesian_2d(
            Places { ends: x_ends, ticks: x_ticks.clone() },
            Places { ends: y_ends, ticks: y_ticks.clone() },
        )?;
        let text = ("sans-serif", TEXT).into_font().color(&INK);
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(222, 222, 222).stroke_width(THIN))
            .axis_style(INK.stroke_width(THIN))
            .set_all_tick_mark_size(step(5))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style(text.clone())
            .axis_desc_style(text)
            .x_label_formatter(&|&place| self.x.tick(place, &x_ticks))
            .y_label_formatter(&|&place| self.y.tick(place, &y_ticks))
            .draw()?;
        let inside = Inside { x: &self.x, y: &self.y, x_ends, y_ends };
        for series in &self.series {
            series.draw(&mut chart, &inside)?;
        }
        Ok(())
    }
}

/// Places along an axis with ticks at given ones.
struct Places {
    ends: [f64; 2],
    ticks: Vec<f64>,
}

impl Ranged for Places {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, place: &f64, (from, to): (i32, i32)) -> i32 {
        let [lo, hi] = self.ends;
        from + (f64::from(to - from) * (place - lo) / (hi - lo)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.ends[0]..self.ends[1]
    }
}

/// The axes of a panel: which points can be seen, and where.
struct Inside<'a> {
    x: &'a Axis,
    y: &'a Axis,
    x_ends: [f64; 2],
    y_ends: [f64; 2],
}

impl Inside<'_> {
    fn place(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        let (x, y) = (self.x.place(x), self.y.place(y));
        let within = |place: f64, [lo, hi]: [f64; 2]| place >= lo - 1e-9 && place <= hi + 1e-9;
        (within(x, self.x_ends) && within(y, self.y_ends)).then_some((x, y))
    }

    /// Place of an end of a bar, which may lie outside: there the bar is cut.
    fn cut(&self, y: f64, otherwise: f64) -> f64 {
        let place = self.y.place(y);
        if place.is_nan() { otherwise } else { place.clamp(self.y_ends[0], self.y_ends[1]) }
    }

    /// Lines without gaps.
    fn lines(&self, points: &[[f64; 2]]) -> Vec<Vec<(f64, f64)>> {
        let places: Vec<_> = points.iter().map(|&[x, y]| self.place(x, y)).collect();
        places.split(Option::is_none).map(|line| line.iter().copied().flatten().collect()).collect()
    }
}

impl Series {
    fn ink(&self) -> RGBColor {
        if self.colour == GREY { BACKGROUND_GREY } else { PALETTE[self.colour % COLOURS] }
    }

    fn has_legend_of(&self, other: &Self) -> bool {
        let same_shape = std::mem::discriminant(&self.shape) == std::mem::discriminant(&other.shape);
        self.label == other.label && self.colour == other.colour && same_shape
    }

    fn draw(&self, chart: &mut Chart<'_, '_>, inside: &Inside<'_>) -> Result<(), Box<dyn std::error::Error>> {
        let ink = self.ink();
        match &self.shape {
            Shape::Line(points) => {
                let lines = inside.lines(points).into_iter();
                chart.draw_series(lines.map(|line| PathElement::new(line, ink.stroke_width(THICK))))?;
            }
            Shape::Dashed(points) => {
                for line in inside.lines(points) {
                    let dashes = DashedPathElement::new(line, step(7), step(4), ink.stroke_width(THICK));
                    chart.draw_series(std::iter::once(dashes))?;
                }
            }
            Shape::Points(points) => {
                for place in points.iter().filter_map(|&[x, y]| inside.place(x, y)) {
                    self.draw_marker(chart.plotting_area(), place)?;
                }
            }
            Shape::Dots(points) => {
                for place in points.iter().filter_map(|&[x, y]| inside.place(x, y)) {
                    chart.plotting_area().draw(&Circle::new(place, DOT, ink.filled()))?;
                }
            }
            Shape::Measured(points) => {
                for &[x, y, lo, hi] in points {
                    let Some(place) = inside.place(x, y) else { continue };
                    let bar = [lo, hi].map(|end| (place.0, inside.cut(end, inside.y_ends[0])));
                    chart.draw_series(std::iter::once(PathElement::new(bar.to_vec(), ink.stroke_width(THIN))))?;
                    self.draw_marker(chart.plotting_area(), place)?;
                }
            }
            Shape::Band(points) => {
                let upper = points.iter().map(|&[x, _, hi]| (inside.x.place(x), inside.cut(hi, inside.y_ends[0])));
                let lower =
                    points.iter().rev().map(|&[x, lo, _]| (inside.x.place(x), inside.cut(lo, inside.y_ends[0])));
                let outline: Vec<_> = upper.chain(lower).filter(|(x, _)| x.is_finite()).collect();
                chart.draw_series(std::iter::once(Polygon::new(outline, ink.mix(0.18).filled())))?;
            }
        }
        Ok(())
    }

    /// The marker of the series' colour.
    fn draw_marker<C: CoordTranslate>(
        &self,
        area: &DrawingArea<SVGBackend<'_>, C>,
        place: C::From,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        C::From: Clone + 'static,
    {
        let ink = self.ink().filled();
        let m = MARKER;
        let element = EmptyElement::at(place);
        match self.colour % COLOURS {
            1 => area.draw(&(element + Polygon::new([(-m, m), (m, m), (0, -m)], ink)))?,
            2 => area.draw(&(element + Rectangle::new([(-m, -m), (m, m)], ink)))?,
            3 => area.draw(&(element + Polygon::new([(-m, 0), (0, m), (m, 0), (0, -m)], ink)))?,
            4 => area.draw(&(element + Polygon::new([(-m, -m), (m, -m), (0, m)], ink)))?,
            5 => area.draw(&(element + Circle::new((0, 0), m, self.ink().stroke_width(THICK))))?,
            _ => area.draw(&(element + Circle::new((0, 0), m, ink)))?,
        }
        Ok(())
    }

    fn draw_sample(&self, area: &Area<'_>, x: i32, y: i32) -> Result<(), Box<dyn std::error::Error>> {
        let ink = self.ink();
        let ends = [(x, y), (x + SAMPLE, y)];
        match &self.shape {
            Shape::Line(_) => area.draw(&PathElement::new(ends.to_vec(), ink.stroke_width(THICK)))?,
            Shape::Dashed(_) => area.draw(&DashedPathElement::new(ends, step(7), step(4), ink.stroke_width(THICK)))?,
            Shape::Points(_) => self.draw_marker(area, (x + SAMPLE / 2, y))?,
            Shape::Dots(_) => area.draw(&Circle::new((x + SAMPLE / 2, y), DOT, ink.filled()))?,
            Shape::Measured(_) => {
                let middle = x + SAMPLE / 2;
                area.draw(&PathElement::new(
                    vec![(middle, y - step(9)), (middle, y + step(9))],
                    ink.stroke_width(THIN),
                ))?;
                self.draw_marker(area, (middle, y))?;
            }
            Shape::Band(_) => {
                area.draw(&Rectangle::new([(x, y - step(6)), (x + SAMPLE, y + step(6))], ink.mix(0.18).filled()))?;
            }
        }
        let text = ("sans-serif", TEXT).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw_text(&self.label, &text, (x + SAMPLE + step(6), y))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_one_svg_with_every_label_once() {
        let series = |label: &str| {
            let shapes = [
                Shape::Line(vec![[0.0, 1.0], [1.0, f64::NAN], [2.0, 3.0], [3.0, 4.0]]),
                Shape::Dashed(vec![[0.0, 1.0], [3.0, 2.0]]),
                Shape::Points(vec![[1.0, 1.0]]),
                Shape::Dots(vec![[2.0, 1.0]]),
                Shape::Measured(vec![[1.0, 2.0, f64::NAN, 3.0]]),
                Shape::Band(vec![[0.0, 1.0, 2.0], [3.0, 2.0, 4.0]]),
            ];
            shapes
                .into_iter()
                .zip(0..)
                .map(|(shape, colour)| Series::new(format!("{label} {colour}"), colour, shape))
                .collect()
        };
        let panel = |title: &str| Panel {
            title: title.into(),
            x: Axis::linear("time / s"),
            y: Axis::log("error / m"),
            series: series("kind"),
        };
        let figure = Figure {
            name: "test".into(),
            title: "All shapes".into(),
            columns: 2,
            panels: ["east", "north", "up"].map(panel).into(),
        };
        let svg = figure.to_svg().expect("a figure");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for (text, count) in [("All shapes", 1), ("east", 1), ("kind 0", 1), ("kind 4", 1), ("time / s", 3)] {
            assert_eq!(svg.matches(text).count(), count, "{text}");
        }
        assert!(!svg.contains("NaN"), "{svg}");
    }

    #[test]
    fn an_empty_figure_can_be_drawn() {
        let figure = Figure { panels: vec![Panel::default()], ..Figure::default() };
        assert!(figure.to_svg().is_ok());
    }
}
