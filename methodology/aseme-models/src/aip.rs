//! The Agent Interaction Protocol model (AIP): protocols between agents, and the part of each
//! participant.

use yase::expression::TextPosition;

use crate::meta::{Class, Feature, FeatureValue, Metamodel, ModelInstance, Object, TypedModel, UNLIMITED};

/// Protocols and their participants.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Aip {
    /// The participants.
    pub participants: Vec<Participant>,
    /// The protocols.
    pub protocols: Vec<Protocol>,
}

/// A participant of a protocol.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Participant {
    /// Its name.
    pub name: String,
    /// The rule by which the participant engages in the protocol.
    pub engaging_rules: String,
    /// Its possible outcomes.
    pub outcomes: String,
    /// Its behaviour: the right-hand side of its formula, and further formulas in full below that.
    pub liveness: String,
    /// Its position in the source.
    pub position: TextPosition,
    /// The position of its formulas in the source.
    pub liveness_position: TextPosition,
}

/// A protocol.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Protocol {
    /// Its parts, by their indices in [`Aip::participants`].
    pub participants: Vec<usize>,
    /// Its name.
    pub name: String,
    /// Its position in the source.
    pub position: TextPosition,
}

const PARTICIPANTS: usize = 0;
const PROTOCOLS: usize = 1;

static METAMODEL: Metamodel = Metamodel {
    header: "AIP",
    root: "AIPmodel",
    prefix: "AIP",
    // The first is misspelt in every file of the original tools.
    namespaces: &[
        "http://www.acml.tuc.gr/aseme/metamodels/AIP",
        "http://www.amcl.tuc.gr/aseme/metamodels/AIP",
    ],
    classes: &[
        Class {
            header: "Participant",
            feature: "participants",
            min_count: 2,
            title: 0,
            features: &[
                Feature::text("name"),
                Feature::text("engaging_rules"),
                Feature::text("outcomes"),
                Feature::formulas("liveness"),
            ],
            subclasses: &[],
        },
        Class {
            header: "Protocol",
            feature: "protocols",
            min_count: 1,
            title: 1,
            features: &[Feature::links("participants", PARTICIPANTS, 2, UNLIMITED), Feature::text("name")],
            subclasses: &[],
        },
    ],
};

impl TypedModel for Aip {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &ModelInstance) -> Aip {
        let participant = |object: &Object| Participant {
            name: object.text(0),
            engaging_rules: object.text(1),
            outcomes: object.text(2),
            liveness: object.text(3),
            position: object.position,
            liveness_position: object.value_position(3),
        };
        let protocol = |object: &Object| Protocol {
            participants: object.links(0).to_vec(),
            name: object.text(1),
            position: object.position,
        };
        Aip {
            participants: instance.of(PARTICIPANTS).iter().map(participant).collect(),
            protocols: instance.of(PROTOCOLS).iter().map(protocol).collect(),
        }
    }

    fn to_instance(&self) -> ModelInstance {
        let participant = |it: &Participant| {
            let texts = [&it.name, &it.engaging_rules, &it.outcomes, &it.liveness];
            Object::new(texts.map(|text| FeatureValue::Text(text.clone())).into(), it.position)
        };
        let protocol = |protocol: &Protocol| {
            let values = vec![
                FeatureValue::Links(protocol.participants.clone()),
                FeatureValue::Text(protocol.name.clone()),
            ];
            Object::new(values, protocol.position)
        };
        let participants = self.participants.iter().map(participant).collect();
        ModelInstance { objects: vec![participants, self.protocols.iter().map(protocol).collect()] }
    }
}
