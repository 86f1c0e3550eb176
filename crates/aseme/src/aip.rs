//! The Agent Interaction Protocol model: what agents do together, and the part of each.

use yase::expression::Place;

use crate::meta::{Class, Feature, Instance, MANY, Metamodel, Object, Typed, Value};

/// Protocols and those who take part in them.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Aip {
    /// The parts.
    pub participants: Vec<Participant>,
    /// The protocols.
    pub protocols: Vec<Protocol>,
}

/// A part in a protocol.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Participant {
    /// Its name.
    pub name: String,
    /// When it may be taken.
    pub engaging_rules: String,
    /// What may come of it.
    pub outcomes: String,
    /// What it does: the right-hand side of its formula, and below that further formulas in full.
    pub liveness: String,
    /// Where it stands.
    pub place: Place,
    /// Where its formulas stand.
    pub liveness_place: Place,
}

/// A protocol.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Protocol {
    /// Its parts, by their places in [`Aip::participants`].
    pub participants: Vec<usize>,
    /// Its name.
    pub name: String,
    /// Where it stands.
    pub place: Place,
}

const PARTICIPANTS: usize = 0;
const PROTOCOLS: usize = 1;

static METAMODEL: Metamodel = Metamodel {
    word: "AIP",
    root: "AIPmodel",
    prefix: "AIP",
    // The first is misspelt in every file of the original tools.
    namespaces: &[
        "http://www.acml.tuc.gr/aseme/metamodels/AIP",
        "http://www.amcl.tuc.gr/aseme/metamodels/AIP",
    ],
    classes: &[
        Class {
            word: "Participant",
            feature: "participants",
            least: 2,
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
            word: "Protocol",
            feature: "protocols",
            least: 1,
            title: 1,
            features: &[Feature::links("participants", PARTICIPANTS, 2, MANY), Feature::text("name")],
            subclasses: &[],
        },
    ],
};

impl Typed for Aip {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &Instance) -> Aip {
        let participant = |object: &Object| Participant {
            name: object.text(0),
            engaging_rules: object.text(1),
            outcomes: object.text(2),
            liveness: object.text(3),
            place: object.place,
            liveness_place: object.place_of(3),
        };
        let protocol = |object: &Object| Protocol {
            participants: object.links(0).to_vec(),
            name: object.text(1),
            place: object.place,
        };
        Aip {
            participants: instance.of(PARTICIPANTS).iter().map(participant).collect(),
            protocols: instance.of(PROTOCOLS).iter().map(protocol).collect(),
        }
    }

    fn to_instance(&self) -> Instance {
        let participant = |it: &Participant| {
            let texts = [&it.name, &it.engaging_rules, &it.outcomes, &it.liveness];
            Object::new(texts.map(|text| Value::Text(text.clone())).into(), it.place)
        };
        let protocol = |protocol: &Protocol| {
            let values =
                vec![Value::Links(protocol.participants.clone()), Value::Text(protocol.name.clone())];
            Object::new(values, protocol.place)
        };
        let participants = self.participants.iter().map(participant).collect();
        Instance { objects: vec![participants, self.protocols.iter().map(protocol).collect()] }
    }
}
