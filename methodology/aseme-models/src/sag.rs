//! The System Actors Goals model (SAG): the actors of a system and their goals.

use yase::expression::TextPosition;

use crate::meta::{Class, Feature, FeatureValue, Metamodel, ModelInstance, Object, TypedModel, UNLIMITED};

/// Actors and their goals.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Sag {
    /// The goals.
    pub goals: Vec<ActorGoal>,
    /// The actors.
    pub actors: Vec<Actor>,
}

/// An actor of the system: a person, an agent or another system.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Actor {
    /// Its name.
    pub name: String,
    /// Its position in the source.
    pub position: TextPosition,
}

/// A goal of an actor, and the actors it depends on.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ActorGoal {
    /// Its name.
    pub name: String,
    /// Requirements of the goal.
    pub requirements: String,
    /// The actor whose goal it is, by its index in [`Sag::actors`].
    pub depender: Option<usize>,
    /// The actors that are to achieve it, by their indices in [`Sag::actors`].
    pub dependees: Vec<usize>,
    /// Its position in the source.
    pub position: TextPosition,
}

const GOALS: usize = 0;
const ACTORS: usize = 1;

static METAMODEL: Metamodel = Metamodel {
    header: "SAG",
    root: "SAGmodel",
    prefix: "SAG",
    namespaces: &["http://www.amcl.tuc.gr/aseme/metamodels/SAG"],
    classes: &[
        Class {
            header: "Goal",
            feature: "goals",
            min_count: 1,
            title: 1,
            features: &[
                Feature::text("requirements"),
                Feature::text("name"),
                Feature::links("depender", ACTORS, 1, 1),
                Feature::links("dependee", ACTORS, 0, UNLIMITED).called("dependees"),
            ],
            subclasses: &[],
        },
        Class {
            header: "Actor",
            feature: "actors",
            min_count: 1,
            title: 1,
            features: &[Feature::opposite("my_goal", GOALS, 2), Feature::text("name")],
            subclasses: &[],
        },
    ],
};

impl TypedModel for Sag {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &ModelInstance) -> Sag {
        let goal = |object: &Object| ActorGoal {
            requirements: object.text(0),
            name: object.text(1),
            depender: object.links(2).first().copied(),
            dependees: object.links(3).to_vec(),
            position: object.position,
        };
        let actor = |object: &Object| Actor { name: object.text(1), position: object.position };
        Sag {
            goals: instance.of(GOALS).iter().map(goal).collect(),
            actors: instance.of(ACTORS).iter().map(actor).collect(),
        }
    }

    fn to_instance(&self) -> ModelInstance {
        let goal = |goal: &ActorGoal| {
            let (depender, dependees) = (goal.depender.into_iter().collect(), goal.dependees.clone());
            let texts = [&goal.requirements, &goal.name].map(|text| FeatureValue::Text(text.clone()));
            let links = [FeatureValue::Links(depender), FeatureValue::Links(dependees)];
            Object::new(texts.into_iter().chain(links).collect(), goal.position)
        };
        let actor = |actor: &Actor| {
            Object::new(vec![FeatureValue::Derived, FeatureValue::Text(actor.name.clone())], actor.position)
        };
        ModelInstance {
            objects: vec![self.goals.iter().map(goal).collect(), self.actors.iter().map(actor).collect()],
        }
    }
}
