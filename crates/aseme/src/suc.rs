//! The System Use Cases model: what the system is to do, from the whole down to single activities, and which roles take part.

use yase::expression::Place;

use crate::meta::{Class, Feature, Instance, MANY, Metamodel, Object, Typed, Value};

/// Roles and use cases.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Suc {
    /// Who takes part.
    pub roles: Vec<Role>,
    /// What is done.
    pub usecases: Vec<UseCase>,
}

/// Somebody or something in the system or around it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Role {
    /// Its name.
    pub name: String,
    /// What plays it.
    pub kind: RoleKind,
    /// Where it stands.
    pub place: Place,
}

/// What plays a role.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum RoleKind {
    /// Not said, or nothing by itself.
    #[default]
    Abstract,
    /// An agent of the system that is developed.
    System,
    /// An agent that exists already.
    LegacySystem,
    /// An agent outside.
    ExternalSystem,
    /// A person.
    Human,
}

/// Something that is done.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct UseCase {
    /// The roles that take part, by their places in [`Suc::roles`].
    pub participants: Vec<usize>,
    /// The use cases it consists of, by their places in [`Suc::usecases`].
    pub includes: Vec<usize>,
    /// Its name.
    pub name: String,
    /// How it is done.
    pub specified_by: String,
    /// Where it stands.
    pub place: Place,
}

const ROLES: usize = 0;
const USECASES: usize = 1;

/// The kinds of role as files spell them.
const KINDS: [(&str, RoleKind); 5] = [
    ("Abstract", RoleKind::Abstract),
    ("System", RoleKind::System),
    ("Legacy_System", RoleKind::LegacySystem),
    ("External_System", RoleKind::ExternalSystem),
    ("Human", RoleKind::Human),
];

static METAMODEL: Metamodel = Metamodel {
    word: "SUC",
    root: "SUCmodel",
    prefix: "SUC",
    namespaces: &["http://www.amcl.tuc.gr/aseme/metamodels/SUC"],
    classes: &[
        Class {
            word: "Role",
            feature: "roles",
            least: 2,
            title: 1,
            features: &[
                Feature::opposite("participates_in", USECASES, 0),
                Feature::text("name"),
                Feature::choice("type", &[KINDS[0].0, KINDS[1].0, KINDS[2].0, KINDS[3].0, KINDS[4].0]),
            ],
            subclasses: &[("SystemRole", 2, 1), ("HumanRole", 2, 4)],
        },
        Class {
            word: "UseCase",
            feature: "usecases",
            least: 1,
            title: 2,
            features: &[
                Feature::links("participant", ROLES, 0, MANY).called("participants"),
                Feature::links("include", USECASES, 0, MANY).called("includes"),
                Feature::text("name"),
                Feature::text("specified_by"),
            ],
            subclasses: &[],
        },
    ],
};

impl Typed for Suc {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &Instance) -> Suc {
        let role = |object: &Object| Role {
            name: object.text(1),
            kind: KINDS.get(object.choice(2)).map_or(RoleKind::Abstract, |(_, kind)| *kind),
            place: object.place,
        };
        let usecase = |object: &Object| UseCase {
            participants: object.links(0).to_vec(),
            includes: object.links(1).to_vec(),
            name: object.text(2),
            specified_by: object.text(3),
            place: object.place,
        };
        Suc {
            roles: instance.of(ROLES).iter().map(role).collect(),
            usecases: instance.of(USECASES).iter().map(usecase).collect(),
        }
    }

    fn to_instance(&self) -> Instance {
        let role = |role: &Role| {
            let kind = KINDS.iter().position(|(_, kind)| *kind == role.kind).unwrap_or_default();
            Object::new(vec![Value::Derived, Value::Text(role.name.clone()), Value::Choice(kind)], role.place)
        };
        let usecase = |usecase: &UseCase| {
            let links = [&usecase.participants, &usecase.includes].map(|links| Value::Links(links.clone()));
            let texts = [&usecase.name, &usecase.specified_by].map(|text| Value::Text(text.clone()));
            Object::new(links.into_iter().chain(texts).collect(), usecase.place)
        };
        Instance {
            objects: vec![self.roles.iter().map(role).collect(), self.usecases.iter().map(usecase).collect()],
        }
    }
}
