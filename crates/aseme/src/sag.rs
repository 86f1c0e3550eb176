//! The System Actors Goals model: who takes part in a system, and what each wants of it.

use yase::expression::Place;

use crate::meta::{Class, Feature, Instance, MANY, Metamodel, Object, Typed, Value};

/// Actors and their goals.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Sag {
    /// What they want.
    pub goals: Vec<Goal>,
    /// Who takes part.
    pub actors: Vec<Actor>,
}

/// Somebody or something that takes part in the system.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Actor {
    /// Its name.
    pub name: String,
    /// Where it stands.
    pub place: Place,
}

/// What an actor wants, and of whom it depends.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Goal {
    /// Its name.
    pub name: String,
    /// What it takes to reach it.
    pub requirements: String,
    /// The actor whose goal it is, by its place in [`Sag::actors`].
    pub depender: Option<usize>,
    /// The actors who are to reach it, by their places in [`Sag::actors`].
    pub dependees: Vec<usize>,
    /// Where it stands.
    pub place: Place,
}

const GOALS: usize = 0;
const ACTORS: usize = 1;

static METAMODEL: Metamodel = Metamodel {
    word: "SAG",
    root: "SAGmodel",
    prefix: "SAG",
    namespaces: &["http://www.amcl.tuc.gr/aseme/metamodels/SAG"],
    classes: &[
        Class {
            word: "Goal",
            feature: "goals",
            least: 1,
            title: 1,
            features: &[
                Feature::text("requirements"),
                Feature::text("name"),
                Feature::links("depender", ACTORS, 1, 1),
                Feature::links("dependee", ACTORS, 0, MANY).called("dependees"),
            ],
            subclasses: &[],
        },
        Class {
            word: "Actor",
            feature: "actors",
            least: 1,
            title: 1,
            features: &[Feature::opposite("my_goal", GOALS, 2), Feature::text("name")],
            subclasses: &[],
        },
    ],
};

impl Typed for Sag {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &Instance) -> Sag {
        let goal = |object: &Object| Goal {
            requirements: object.text(0),
            name: object.text(1),
            depender: object.links(2).first().copied(),
            dependees: object.links(3).to_vec(),
            place: object.place,
        };
        let actor = |object: &Object| Actor { name: object.text(1), place: object.place };
        Sag {
            goals: instance.of(GOALS).iter().map(goal).collect(),
            actors: instance.of(ACTORS).iter().map(actor).collect(),
        }
    }

    fn to_instance(&self) -> Instance {
        let goal = |goal: &Goal| {
            let (depender, dependees) = (goal.depender.into_iter().collect(), goal.dependees.clone());
            let texts = [&goal.requirements, &goal.name].map(|text| Value::Text(text.clone()));
            let links = [Value::Links(depender), Value::Links(dependees)];
            Object::new(texts.into_iter().chain(links).collect(), goal.place)
        };
        let actor =
            |actor: &Actor| Object::new(vec![Value::Derived, Value::Text(actor.name.clone())], actor.place);
        Instance {
            objects: vec![self.goals.iter().map(goal).collect(), self.actors.iter().map(actor).collect()],
        }
    }
}
