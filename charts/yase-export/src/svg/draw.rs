//! The SVG document: boxes, then arrows, then labels.

use std::fmt::Write;

use super::drawing_layout::{Arrow, DrawingLayout, Shape};
use super::lettering::{LABEL_LINE, LABEL_SIZE, NAME_LINE, NAME_SIZE, escaped};
use super::placed::frame;
use crate::highlights::{Highlights, Mark};
use crate::notation::depth_first;
use crate::outline::is_region;
use yase::statechart::{NodeId, NodeKind, Point, Statechart};

const STYLE: &str = "\
text{font-family:system-ui,-apple-system,'Segoe UI','Liberation Sans','DejaVu Sans',sans-serif;fill:#1f2430}\
.name{font-size:13px}.title{font-size:13px;font-weight:600}.label{font-size:11px}.note{font-size:11px;fill:#4a5060}\
.never{fill:#9aa0ab}\
.or{fill:#fffdf2;stroke:#b99a2e}.head{fill:#ffe9a3;stroke:#b99a2e}\
.and{fill:#f2f6fd;stroke:#6d87b8}.and-head{fill:#d5e2f7;stroke:#6d87b8}\
.region{fill:none;stroke:#6d87b8;stroke-dasharray:6 4}\
.basic{fill:#dcf3dc;stroke:#4d8a50}\
.connector{fill:#fff;stroke:#1f2430}.dot{fill:#1f2430}.cross{fill:none;stroke:#1f2430;stroke-width:1.6}\
.arrow{fill:none;stroke:#3b4252;stroke-width:1.2}.unused{fill:none;stroke:#b6bbc4;stroke-width:1.2}\
.ground{fill:#fff;fill-opacity:.88}";

/// Writes the whole document.
pub(crate) fn document(chart: &Statechart, layout: &DrawingLayout<'_>, marks: &Highlights) -> String {
    let mut page = SvgWriter { svg: String::new() };
    let (width, height) = layout.page_size(chart);
    page.line(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\">"
    ));
    page.line(format_args!("<title>{}</title>", escaped(&chart.name)));
    let is_marked = *marks != Highlights::default();
    let (styles, heads) = if is_marked { marked_style() } else { Default::default() };
    page.line(format_args!("<style>{STYLE}{styles}</style>"));
    page.line(format_args!(
        "<defs>{}{}{heads}</defs>",
        head("head", "#3b4252"),
        head("unused-head", "#b6bbc4")
    ));
    page.line(format_args!("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"));
    for id in depth_first(chart) {
        page.marked(marks.of_node(id), |page| page.node(chart, id, layout.shape(id)));
    }
    // where several overlap, the line shows one that was covered
    let (missed, others): (Vec<_>, Vec<_>) =
        layout.arrows.iter().partition(|arrow| arrow.label.mark == Some(Mark::Missed));
    for arrow in missed.into_iter().chain(others) {
        page.marked(arrow.label.mark, |page| page.arrow(arrow));
    }
    for arrow in &layout.arrows {
        page.marked(arrow.label.mark, |page| page.label(arrow));
    }
    page.line(format_args!("</svg>"));
    page.svg
}

fn head(id: &str, colour: &str) -> String {
    format!(
        "<marker id=\"{id}\" viewBox=\"0 0 8 8\" refX=\"7.5\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" \
         orient=\"auto\"><path d=\"M0 .5 8 4 0 7.5z\" fill=\"{colour}\"/></marker>"
    )
}

/// The styles and arrow heads of highlighted parts.
fn marked_style() -> (String, String) {
    let style = |mark: Mark| {
        let (class, colour) = (mark.word(), mark.colour());
        format!(
            ".{class} rect:not(.ground),.{class} circle,.{class} path{{stroke:{colour};stroke-width:2.4}}\
             .{class} polyline{{stroke:{colour};stroke-width:2}}.{class} text{{fill:{colour}}}"
        )
    };
    let styles: String = Mark::ALL.map(style).concat();
    let heads = Mark::ALL.map(|mark| head(&format!("{}-head", mark.word()), mark.colour())).concat();
    let more = ".removed text{text-decoration:line-through}.removed .basic,.missed .basic{fill:#fbe4e2}";
    (styles + more, heads)
}

struct SvgWriter {
    svg: String,
}

impl SvgWriter {
    fn line(&mut self, content: std::fmt::Arguments<'_>) {
        // writing to a String cannot fail
        let _ = writeln!(self.svg, "{content}");
    }

    /// Draws an element within a group of its mark.
    fn marked(&mut self, mark: Option<Mark>, draw: impl FnOnce(&mut SvgWriter)) {
        let Some(mark) = mark else { return draw(self) };
        let begin = self.svg.len();
        self.line(format_args!("<g class=\"{}\">", mark.word()));
        let empty = self.svg.len();
        draw(self);
        if self.svg.len() == empty {
            return self.svg.truncate(begin);
        }
        self.line(format_args!("</g>"));
    }

    fn node(&mut self, chart: &Statechart, id: NodeId, shape: &Shape) {
        match chart.node(id).kind {
            NodeKind::Or if shape.title.is_empty() || is_region(chart, id) => {
                self.rectangle("region", shape.at, shape.size, 4.0);
                self.lettering(shape, "title", 4.0);
            }
            NodeKind::Or => self.composite("or", "head", shape),
            NodeKind::And => self.composite("and", "and-head", shape),
            NodeKind::Basic => {
                self.rectangle("basic", shape.at, shape.size, 10.0);
                let lines = NAME_LINE * shape.title.len() as f64 + LABEL_LINE * shape.notes.len() as f64;
                // in the middle of a box with a given size; the space for arrows is at the bottom
                let is_sized = frame(chart, id).size.is_some();
                self.lettering(shape, "name", if is_sized { (shape.size.1 - lines) / 2.0 } else { 7.5 });
            }
            kind => {
                self.sign(kind, shape);
                self.beside(shape);
            }
        }
    }

    /// The symbol of a connector.
    fn sign(&mut self, kind: NodeKind, shape: &Shape) {
        match kind {
            NodeKind::Fork | NodeKind::Join => self.rectangle("dot", shape.at, shape.size, 1.0),
            NodeKind::Start => self.circle("dot", shape, 7.0),
            NodeKind::End => {
                self.circle("connector", shape, 9.0);
                self.circle("dot", shape, 5.0);
            }
            NodeKind::Junction => self.circle("dot", shape, 6.0),
            NodeKind::Choice => self.diamond(shape),
            NodeKind::Terminate => self.cross(shape, 9.0),
            NodeKind::EntryPoint => self.circle("connector", shape, 8.0),
            NodeKind::ExitPoint => {
                self.circle("connector", shape, 8.0);
                self.cross(shape, 5.5);
            }
            kind => {
                self.circle("connector", shape, 10.0);
                self.text("label", center(shape), letter(kind));
            }
        }
    }

    fn diamond(&mut self, shape: &Shape) {
        let ((x, y), (half_width, half_height)) = (center(shape), (shape.size.0 / 2.0, shape.size.1 / 2.0));
        let (left, right, top, bottom) = (x - half_width, x + half_width, y - half_height, y + half_height);
        self.line(format_args!(
            "<path class=\"connector\" d=\"M{x:.1} {top:.1} {right:.1} {y:.1} {x:.1} {bottom:.1} {left:.1} {y:.1}z\"/>"
        ));
    }

    fn cross(&mut self, shape: &Shape, half: f64) {
        let (x, y) = center(shape);
        let (left, right, top, bottom) = (x - half, x + half, y - half, y + half);
        self.line(format_args!(
            "<path class=\"cross\" d=\"M{left:.1} {top:.1} {right:.1} {bottom:.1}M{left:.1} {bottom:.1} {right:.1} {top:.1}\"/>"
        ));
    }

    /// The name of a connector, to its right and slightly above its middle, so that a line from its
    /// side runs below.
    fn beside(&mut self, shape: &Shape) {
        let (x, mut y) = (shape.at.0 + shape.size.0 + shape.name_width / 2.0, center(shape).1 - 7.0);
        for line in shape.title.iter().chain(&shape.notes) {
            self.text("label", (x, y), line);
            y += LABEL_LINE;
        }
    }

    fn composite(&mut self, body: &str, head: &str, shape: &Shape) {
        self.rectangle(body, shape.at, shape.size, 4.0);
        self.rectangle(head, shape.at, (shape.size.0, shape.head()), 4.0);
        self.lettering(shape, "title", 4.0);
    }

    fn rectangle(&mut self, class: &str, (x, y): Point, (width, height): Point, radius: f64) {
        self.line(format_args!(
            "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"{radius}\"/>"
        ));
    }

    fn circle(&mut self, class: &str, shape: &Shape, radius: f64) {
        let (x, y) = center(shape);
        self.line(format_args!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>"));
    }

    /// Name and notes of a box, centred, starting at a distance below its upper border.
    fn lettering(&mut self, shape: &Shape, class: &str, below: f64) {
        let (x, mut y) = (center(shape).0, shape.at.1 + below);
        for line in &shape.title {
            self.text(class, (x, y + NAME_LINE / 2.0), line);
            y += NAME_LINE;
        }
        for line in &shape.notes {
            self.text("note", (x, y + LABEL_LINE / 2.0), line);
            y += LABEL_LINE;
        }
    }

    /// One line of text centred at a point.
    fn text(&mut self, class: &str, (x, y): Point, text: &str) {
        let size = if matches!(class, "name" | "title") { NAME_SIZE } else { LABEL_SIZE };
        let base = y + size * 0.35;
        let text = escaped(text);
        self.line(format_args!(
            "<text class=\"{class}\" x=\"{x:.1}\" y=\"{base:.1}\" text-anchor=\"middle\">{text}</text>"
        ));
    }

    fn arrow(&mut self, arrow: &Arrow) {
        let (class, head) = match (arrow.label.mark, arrow.label.never) {
            (Some(mark), _) => ("arrow", format!("{}-head", mark.word())),
            (None, true) => ("unused", "unused-head".into()),
            (None, false) => ("arrow", "head".into()),
        };
        let points: Vec<String> = arrow.points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let points = points.join(" ");
        self.line(format_args!(
            "<polyline class=\"{class}\" points=\"{points}\" marker-end=\"url(#{head})\"/>"
        ));
    }

    fn label(&mut self, arrow: &Arrow) {
        if arrow.label.lines.is_empty() {
            return;
        }
        let ((x, y), (width, height)) = (arrow.label_at, arrow.label.size());
        self.rectangle("ground", (x - width / 2.0, y - height / 2.0), (width, height), 3.0);
        let class = if arrow.label.never { "label never" } else { "label" };
        let first = y - height / 2.0 + 2.0 + LABEL_LINE / 2.0;
        for (index, line) in arrow.label.lines.iter().enumerate() {
            self.text(class, (x, first + LABEL_LINE * index as f64), line);
        }
    }
}

fn center(shape: &Shape) -> Point {
    (shape.at.0 + shape.size.0 / 2.0, shape.at.1 + shape.size.1 / 2.0)
}

/// The letter in the circle of a connector.
fn letter(kind: NodeKind) -> &'static str {
    match kind {
        NodeKind::Condition => "C",
        NodeKind::ShallowHistory => "H",
        NodeKind::DeepHistory => "H*",
        _ => "",
    }
}
