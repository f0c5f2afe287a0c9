//! A specification text as lines under the lines that they are indented under.

/// A line and those under it.
#[derive(Debug, Default)]
pub(crate) struct Node {
    pub(crate) text: String,
    pub(crate) below: Vec<Node>,
}

impl Node {
    /// The lines of a text, under a line without text.
    pub(crate) fn parse(text: &str) -> Self {
        let mut lines = text
            .lines()
            .filter(|line| !line.trim().is_empty())
            .map(|line| (line.len() - line.trim_start().len(), line.trim().to_string()))
            .peekable();
        Self { text: String::new(), below: Self::deeper(&mut lines, 0) }
    }

    fn deeper(lines: &mut std::iter::Peekable<impl Iterator<Item = (usize, String)>>, least: usize) -> Vec<Self> {
        let mut nodes = Vec::new();
        while let Some((indent, text)) = lines.next_if(|&(indent, _)| indent >= least) {
            nodes.push(Self { text, below: Self::deeper(lines, indent + 1) });
        }
        nodes
    }

    /// First word of the line.
    pub(crate) fn word(&self) -> &str {
        self.text.split(' ').next().unwrap_or("")
    }

    /// What follows the first word.
    pub(crate) fn rest(&self) -> &str {
        self.text.split_once(' ').map_or("", |(_, rest)| rest)
    }

    /// What stands between the first and the last quotation mark.
    pub(crate) fn quoted(&self) -> &str {
        self.text.split_once('"').and_then(|(_, rest)| rest.rsplit_once('"')).map_or("", |(quoted, _)| quoted)
    }

    /// The line below that begins with a word.
    pub(crate) fn child(&self, word: &str) -> Option<&Self> {
        self.below.iter().find(|node| node.word() == word)
    }

    /// The only line below that is no prose.
    pub(crate) fn body(&self) -> &Self {
        let mut bodies =
            self.below.iter().filter(|node| !["definition", "description", "remark"].contains(&node.word()));
        match (bodies.next(), bodies.next()) {
            (Some(body), None) => body,
            _ => panic!("`{}`: expected one line below that is no prose", self.text),
        }
    }
}
