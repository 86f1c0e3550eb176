//! Diagram files of the original editors (`.kse`, `.iacd`): the notation of GMF.
//!
//! A diagram refers to the elements of a model file and says where each is drawn, relative to the
//! content of the composite that it lies in. Positions and sizes of nodes are read; the corners of
//! lines, which are relative to their anchors, are computed anew.

use std::collections::BTreeMap;

use yase::Diagnostic;
use yase::statechart::{Frame, Point};

use crate::iac::Iac;
use crate::xmi::{self, XmiPaths, elements};

/// Places the nodes of a chart, read from the XMI text `model`, as a diagram of that file does.
/// Returns how many nodes have a place.
///
/// # Errors
/// One of the texts is not XML (E0246), or the diagram says nothing about nodes of the model
/// (E0819).
pub fn apply_diagram(chart: &mut Iac, model: &str, diagram: &str) -> Result<usize, Diagnostic> {
    let (model, diagram) = (xmi::parse(model)?, xmi::parse(diagram)?);
    let paths = XmiPaths::new(&model);
    let starts: BTreeMap<usize, usize> =
        chart.nodes.iter().enumerate().map(|(index, node)| (node.position.0.start, index)).collect();
    let mut count = 0;
    for shape in diagram.descendants().filter(|node| node.tag_name().name() == "children") {
        let (Some(reference), Some(frame)) = (reference(shape), frame(shape)) else { continue };
        let element = paths.find(&reference);
        let element = element.and_then(|id| model.descendants().find(|node| node.id().get_usize() == id));
        let index = element.and_then(|element| starts.get(&xmi::tag(element).start));
        if let Some(&index) = index {
            chart.nodes[index].frame = frame;
            count += 1;
        }
    }
    if count == 0 {
        let message = "the diagram places no node of this model";
        let hint = "a diagram refers to the file it was drawn for, as the editors have stored it";
        return Err(Diagnostic::error("E0819", xmi::tag(diagram.root_element()), message).with_hint(hint));
    }
    Ok(count)
}

/// The place in the model that a shape shows.
fn reference(shape: roxmltree::Node<'_, '_>) -> Option<String> {
    let child = elements(shape).find(|child| child.tag_name().name() == "element");
    let text = child.and_then(|child| child.attribute("href")).or_else(|| shape.attribute("element"))?;
    Some(text.rsplit_once('#').map_or(text, |(_, fragment)| fragment).to_owned())
}

/// The frame of a shape; a size of -1 is that of its content.
fn frame(shape: roxmltree::Node<'_, '_>) -> Option<Frame> {
    let bounds = elements(shape).find(|child| child.tag_name().name() == "layoutConstraint")?;
    let number = |name: &str| bounds.attribute(name).map_or(Some(0.0), |text| text.parse::<f64>().ok());
    let at: Point = (number("x")?, number("y")?);
    let size: Point = (number("width")?, number("height")?);
    let is_usable = [at.0, at.1, size.0, size.1].iter().all(|length| length.abs() < 1e6);
    let size = (size.0 > 0.0 && size.1 > 0.0).then_some(size);
    is_usable.then_some(Frame { at: Some(at), size })
}
