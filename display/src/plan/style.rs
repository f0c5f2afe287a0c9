//! How the marks of a plan look, by day and by night.

/// What a plan is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    /// A range ring.
    Ring,
    /// A line of the azimuth scale.
    Spoke,
    /// Text of the scales.
    Scale,
    /// What the plan shows.
    Title,
    /// Other text.
    Note,
    /// A plot.
    Plot,
    /// A true target.
    Truth,
    /// The way of a track.
    Trail,
    /// Where a track will be.
    Vector,
    /// A confirmed track.
    Confirmed,
    /// A tentative track.
    Tentative,
    /// A system track.
    System,
    /// The number of a track.
    Number,
    /// A radar.
    Site,
}

impl Mark {
    /// All of them.
    pub(super) const ALL: [Self; 14] = [
        Self::Ring,
        Self::Spoke,
        Self::Scale,
        Self::Title,
        Self::Note,
        Self::Plot,
        Self::Truth,
        Self::Trail,
        Self::Vector,
        Self::Confirmed,
        Self::Tentative,
        Self::System,
        Self::Number,
        Self::Site,
    ];

    /// Its class in SVG.
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Ring => "ring",
            Self::Spoke => "spoke",
            Self::Scale => "scale",
            Self::Title => "title",
            Self::Note => "note",
            Self::Plot => "plot",
            Self::Truth => "truth",
            Self::Trail => "trail",
            Self::Vector => "vector",
            Self::Confirmed => "confirmed",
            Self::Tentative => "tentative",
            Self::System => "system",
            Self::Number => "number",
            Self::Site => "site",
        }
    }
}

/// 0xRRGGBB.
pub(super) type Colour = u32;

/// How a mark is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Style {
    /// Of its inside and of text.
    pub(super) fill: Option<Colour>,
    /// Of its outline, with its width, px.
    pub(super) stroke: Option<(Colour, f32)>,
    /// Of the whole mark.
    pub(super) opacity: f32,
    /// Height of its text, px.
    pub(super) font_px: f32,
    /// Whether its text is bold.
    pub(super) bold: bool,
}

/// The colours of a sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Theme {
    /// Of the sheet.
    pub(super) ground: Colour,
    /// Grey of the cells, 0 black.
    pub(super) shade: u8,
    grid: Colour,
    scale: Colour,
    title: Colour,
    note: Colour,
    plot: Colour,
    truth: Colour,
    trail: Colour,
    track: Colour,
    number: Colour,
}

/// Dark on a light sheet.
pub(super) const DAY: Theme = Theme {
    ground: 0xff_ffff,
    shade: 150,
    grid: 0xc3_ccd4,
    scale: 0x5a_6b78,
    title: 0x16_242e,
    note: 0x3c_4c57,
    plot: 0xb0_7a1e,
    truth: 0x7a_8791,
    trail: 0x0a_6bb5,
    track: 0x0a_4f8a,
    number: 0x0a_3d69,
};
/// Light on a dark one.
pub(super) const NIGHT: Theme = Theme {
    ground: 0x0b_1218,
    shade: 90,
    grid: 0x26_3541,
    scale: 0x8f_a3b2,
    title: 0xe6_eef4,
    note: 0xb4_c3cf,
    plot: 0xe0_b050,
    truth: 0x88_95a0,
    trail: 0x58_b0f0,
    track: 0x9b_d2ff,
    number: 0xcf_e8ff,
};

impl Theme {
    /// How a mark is drawn on this sheet.
    pub(super) fn style(&self, mark: Mark) -> Style {
        let filled = |colour| Style { fill: Some(colour), stroke: None, opacity: 1.0, font_px: 14.0, bold: false };
        let outlined = |colour, width| Style { fill: None, stroke: Some((colour, width)), ..filled(colour) };
        match mark {
            Mark::Ring | Mark::Spoke => outlined(self.grid, 1.0),
            Mark::Scale => Style { font_px: 12.0, ..filled(self.scale) },
            Mark::Title => Style { font_px: 20.0, ..filled(self.title) },
            Mark::Note => filled(self.note),
            Mark::Plot => Style { opacity: 0.55, ..filled(self.plot) },
            Mark::Truth => outlined(self.truth, 1.5),
            Mark::Trail => Style { opacity: 0.55, ..outlined(self.trail, 1.5) },
            Mark::Vector => outlined(self.track, 2.0),
            Mark::Confirmed => filled(self.track),
            Mark::Tentative => Style { fill: Some(self.ground), ..outlined(self.track, 1.5) },
            Mark::System => outlined(self.number, 1.5),
            Mark::Number => Style { bold: true, ..filled(self.number) },
            Mark::Site => filled(self.title),
        }
    }
}
