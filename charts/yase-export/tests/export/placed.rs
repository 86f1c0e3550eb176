//! Elements with a given position are drawn there, and nothing covers them.

use roxmltree::Document;
use yase::statechart::{Frame, Layout, Point};
use yase::{NodeId, Statechart};
use yase_export::to_svg;

use super::text::chart;

fn machine() -> Statechart {
    chart(
        "light",
        "START
off BASIC
on OR
  START
  dim BASIC
  bright BASIC
light/START -> off
off -> on : button
on/START -> dim
dim -> bright : more
on -> off : button
",
    )
}

fn node(chart: &Statechart, name: &str) -> NodeId {
    chart.find(name).unwrap()
}

fn put(chart: &mut Statechart, name: &str, at: Option<Point>, size: Option<Point>) {
    let id = node(chart, name);
    chart.layout.frames.insert(id, Frame { at, size });
}

fn number(node: roxmltree::Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// Left, top, width and height of the boxes of a class, in the order of the drawing.
fn boxes(svg: &str, class: &str) -> Vec<[f64; 4]> {
    let document = Document::parse(svg).unwrap();
    let nodes = document.descendants().filter(|node| node.attribute("class") == Some(class));
    nodes.map(|it| ["x", "y", "width", "height"].map(|name| number(it, name))).collect()
}

fn arrows(svg: &str) -> Vec<Vec<Point>> {
    let document = Document::parse(svg).unwrap();
    let point = |text: &str| {
        let (x, y) = text.split_once(',').unwrap();
        (x.parse().unwrap(), y.parse().unwrap())
    };
    let nodes = document.descendants().filter(|node| node.attribute("class") == Some("arrow"));
    nodes.map(|it| it.attribute("points").unwrap().split(' ').map(point).collect()).collect()
}

#[test]
fn states_have_their_given_positions_and_sizes() {
    let mut light = machine();
    put(&mut light, "light/START", Some((0.0, 0.0)), None);
    put(&mut light, "off", Some((10.0, 60.0)), Some((200.0, 50.0)));
    put(&mut light, "on", Some((300.0, 20.0)), None);
    let svg = to_svg(&light);
    let [root, on] = boxes(&svg, "or")[..] else { panic!("two composites: {svg}") };
    let head = boxes(&svg, "head")[0];
    // the content begins below the title, slightly inside the border
    let origin = (root[0] + 14.0, head[1] + head[3] + 14.0);
    let off = boxes(&svg, "basic")[0];
    assert_eq!(off, [origin.0 + 10.0, origin.1 + 60.0, 200.0, 50.0]);
    assert_eq!((on[0], on[1]), (origin.0 + 300.0, origin.1 + 20.0));
    let document = Document::parse(&svg).unwrap();
    let name = document.descendants().find(|it| it.text() == Some("off") && it.has_tag_name("text")).unwrap();
    let middle = (off[0] + off[2] / 2.0, off[1] + off[3] / 2.0);
    // the base line is slightly below the middle of the text
    let (x, y) = (number(name, "x"), number(name, "y"));
    assert!(x == middle.0 && (0.0..6.0).contains(&(y - middle.1)), "{x} {y} in {off:?}");
    assert!(root[0] + root[2] >= on[0] + on[2] && root[1] + root[3] >= on[1] + on[3], "it holds all");
    assert_eq!(arrows(&svg).len(), 5, "every transition is drawn");
    let moved = |by: f64| {
        let mut light = light.clone();
        put(&mut light, "on", Some((300.0 + by, 20.0)), None);
        boxes(&to_svg(&light), "basic")[1][0]
    };
    assert_eq!(moved(100.0) - moved(0.0), 100.0, "what is inside goes along");
}

#[test]
fn elements_without_positions_are_below_the_others() {
    let mut light = machine();
    put(&mut light, "off", Some((0.0, 0.0)), None);
    let svg = to_svg(&light);
    let (off, on) = (boxes(&svg, "basic")[0], boxes(&svg, "or")[1]);
    assert!(on[1] > off[1] + off[3], "{off:?} above {on:?}");
}

#[test]
fn a_size_too_small_for_what_is_inside_is_made_larger() {
    let mut light = machine();
    let plain = boxes(&to_svg(&light), "or")[1];
    put(&mut light, "on", None, Some((1.0, 1.0)));
    assert_eq!(boxes(&to_svg(&light), "or")[1], plain);
    put(&mut light, "on", None, Some((400.0, 300.0)));
    let on = boxes(&to_svg(&light), "or")[1];
    assert_eq!([on[2], on[3]], [400.0, 300.0]);
}

#[test]
fn an_arrow_goes_by_its_corners_and_the_page_holds_them() {
    let mut light = machine();
    let (off, on) = (node(&light, "off"), node(&light, "on"));
    let find = |chart: &Statechart, from, to| {
        chart.transitions().find(|(_, it)| (it.source, it.target) == (from, to)).unwrap().0
    };
    let transition = find(&light, on, off);
    light.layout.bends.insert(transition, vec![(900.0, 20.0), (900.0, 40.0)]);
    let svg = to_svg(&light);
    let root = boxes(&svg, "or")[0];
    let bent: Vec<Vec<Point>> = arrows(&svg).into_iter().filter(|it| it.len() == 4).collect();
    let bent = bent.iter().find(|it| it[1].0 > 800.0).unwrap();
    assert_eq!((bent[1].0 - root[0]).fract(), (bent[2].0 - root[0]).fract());
    assert_eq!(bent[2].1 - bent[1].1, 20.0);
    let document = Document::parse(&svg).unwrap();
    assert!(number(document.root_element(), "width") >= bent[1].0 + 16.0);
}

#[test]
fn without_places_nothing_is_drawn_otherwise() {
    let light = machine();
    let mut said = light.clone();
    said.layout.frames.insert(node(&light, "off"), Frame::default());
    let off = node(&light, "off");
    let loose = said.transitions().find(|(_, it)| it.source == off).unwrap().0;
    said.layout.bends.insert(loose, Vec::new());
    assert_eq!(to_svg(&said), to_svg(&light));
    said.layout = Layout::default();
    assert_eq!(to_svg(&said), to_svg(&light));
}
