//! The System Use Cases model (SUC): use cases from the whole system down to single activities, and
//! the roles that take part.

use yase::expression::TextPosition;

use crate::meta::{Class, Feature, FeatureValue, Metamodel, ModelInstance, Object, TypedModel, UNLIMITED};

/// Roles and use cases.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Suc {
    /// The roles.
    pub roles: Vec<SystemRole>,
    /// The use cases.
    pub usecases: Vec<UseCase>,
}

/// A role in the system or in its environment.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SystemRole {
    /// Its name.
    pub name: String,
    /// The kind of the role.
    pub kind: RoleKind,
    /// Its position in the source.
    pub position: TextPosition,
}

/// The kind of a role.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum RoleKind {
    /// Unspecified, or abstract.
    #[default]
    Abstract,
    /// An agent of the system that is developed.
    System,
    /// An agent that exists already.
    LegacySystem,
    /// An agent outside the system.
    ExternalSystem,
    /// A person.
    Human,
}

/// A use case.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct UseCase {
    /// The roles that take part, by their indices in [`Suc::roles`].
    pub participants: Vec<usize>,
    /// The use cases it consists of, by their indices in [`Suc::usecases`].
    pub includes: Vec<usize>,
    /// Its name.
    pub name: String,
    /// Its specification.
    pub specified_by: String,
    /// Its position in the source.
    pub position: TextPosition,
}

const ROLES: usize = 0;
const USECASES: usize = 1;

/// The kinds of roles as spelled in files.
const KINDS: [(&str, RoleKind); 5] = [
    ("Abstract", RoleKind::Abstract),
    ("System", RoleKind::System),
    ("Legacy_System", RoleKind::LegacySystem),
    ("External_System", RoleKind::ExternalSystem),
    ("Human", RoleKind::Human),
];

static METAMODEL: Metamodel = Metamodel {
    header: "SUC",
    root: "SUCmodel",
    prefix: "SUC",
    namespaces: &["http://www.amcl.tuc.gr/aseme/metamodels/SUC"],
    classes: &[
        Class {
            header: "Role",
            feature: "roles",
            min_count: 2,
            title: 1,
            features: &[
                Feature::opposite("participates_in", USECASES, 0),
                Feature::text("name"),
                Feature::choice("type", &[KINDS[0].0, KINDS[1].0, KINDS[2].0, KINDS[3].0, KINDS[4].0]),
            ],
            subclasses: &[("SystemRole", 2, 1), ("HumanRole", 2, 4)],
        },
        Class {
            header: "UseCase",
            feature: "usecases",
            min_count: 1,
            title: 2,
            features: &[
                Feature::links("participant", ROLES, 0, UNLIMITED).called("participants"),
                Feature::links("include", USECASES, 0, UNLIMITED).called("includes"),
                Feature::text("name"),
                Feature::text("specified_by"),
            ],
            subclasses: &[],
        },
    ],
};

impl TypedModel for Suc {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &ModelInstance) -> Suc {
        let role = |object: &Object| SystemRole {
            name: object.text(1),
            kind: KINDS.get(object.choice(2)).map_or(RoleKind::Abstract, |(_, kind)| *kind),
            position: object.position,
        };
        let usecase = |object: &Object| UseCase {
            participants: object.links(0).to_vec(),
            includes: object.links(1).to_vec(),
            name: object.text(2),
            specified_by: object.text(3),
            position: object.position,
        };
        Suc {
            roles: instance.of(ROLES).iter().map(role).collect(),
            usecases: instance.of(USECASES).iter().map(usecase).collect(),
        }
    }

    fn to_instance(&self) -> ModelInstance {
        let role = |role: &SystemRole| {
            let kind = KINDS.iter().position(|(_, kind)| *kind == role.kind).unwrap_or_default();
            Object::new(
                vec![
                    FeatureValue::Derived,
                    FeatureValue::Text(role.name.clone()),
                    FeatureValue::Choice(kind),
                ],
                role.position,
            )
        };
        let usecase = |usecase: &UseCase| {
            let links =
                [&usecase.participants, &usecase.includes].map(|links| FeatureValue::Links(links.clone()));
            let texts = [&usecase.name, &usecase.specified_by].map(|text| FeatureValue::Text(text.clone()));
            Object::new(links.into_iter().chain(texts).collect(), usecase.position)
        };
        ModelInstance {
            objects: vec![self.roles.iter().map(role).collect(), self.usecases.iter().map(usecase).collect()],
        }
    }
}
