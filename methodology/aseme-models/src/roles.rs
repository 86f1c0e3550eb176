//! The System Roles Model of a whole system (SRM): its roles, their capabilities, and the
//! functionalities that implement them.
//!
//! A single refined role is a file of its own, see [`srm`](aseme::srm); this model holds all roles
//! of a system, as the method's tools store them.

use yase::expression::TextPosition;

use crate::meta::{Class, Feature, FeatureValue, Metamodel, ModelInstance, Object, TypedModel, UNLIMITED};

/// Roles, capabilities, activities and functionalities.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SystemRoles {
    /// Activities.
    pub activities: Vec<RoleActivity>,
    /// Capabilities: groups of activities that serve one goal.
    pub capabilities: Vec<Capability>,
    /// The roles.
    pub roles: Vec<Role>,
    /// Functionalities that implement activities.
    pub functionalities: Vec<Functionality>,
}

/// An activity of a role.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct RoleActivity {
    /// Its name.
    pub name: String,
    /// The functionality that implements it, by its index in [`SystemRoles::functionalities`].
    pub functionality: Option<usize>,
    /// Its position in the source.
    pub position: TextPosition,
}

/// The ability to reach a goal.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Capability {
    /// Its name.
    pub name: String,
    /// The activities it consists of, by their indices in [`SystemRoles::activities`].
    pub activities: Vec<usize>,
    /// Its description.
    pub description: String,
    /// Its position in the source.
    pub position: TextPosition,
}

/// A role of an agent.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Role {
    /// The activities of the role itself, by their indices in [`SystemRoles::activities`].
    pub activities: Vec<usize>,
    /// Its formulas, one a line; the first is the role's own.
    pub liveness: String,
    /// Its name.
    pub name: String,
    /// Its capabilities, by their indices in [`SystemRoles::capabilities`].
    pub capabilities: Vec<usize>,
    /// Its position in the source.
    pub position: TextPosition,
    /// The position of its formulas in the source.
    pub liveness_position: TextPosition,
}

/// A functionality that implements activities: a library, a device, an algorithm.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Functionality {
    /// Its permissions.
    pub permissions: String,
    /// Its technology.
    pub technology: String,
    /// Its execution environment.
    pub environment: String,
    /// Its description, which is also its name.
    pub description: String,
    /// Its algorithm.
    pub algorithm: String,
    /// Its position in the source.
    pub position: TextPosition,
}

const ACTIVITIES: usize = 0;
const CAPABILITIES: usize = 1;
const ROLES: usize = 2;
const FUNCTIONALITIES: usize = 3;

static METAMODEL: Metamodel = Metamodel {
    header: "SRM",
    root: "SRMmodel",
    prefix: "SRM",
    namespaces: &["http://www.amcl.tuc.gr/aseme/metamodels/SRM"],
    classes: &[
        Class {
            header: "Activity",
            feature: "activities",
            min_count: 0,
            title: 0,
            features: &[Feature::text("name"), Feature::links("functionality", FUNCTIONALITIES, 1, 1)],
            subclasses: &[],
        },
        Class {
            header: "Capability",
            feature: "capabilities",
            min_count: 0,
            title: 0,
            features: &[
                Feature::text("name"),
                Feature::links("capability_activities", ACTIVITIES, 1, UNLIMITED)
                    .called("activities")
                    .once("activities"),
                Feature::text("description"),
            ],
            subclasses: &[],
        },
        Class {
            header: "Role",
            feature: "roles",
            min_count: 1,
            title: 2,
            features: &[
                Feature::links("role_activities", ACTIVITIES, 1, UNLIMITED)
                    .called("activities")
                    .once("activities"),
                Feature::formulas("liveness"),
                Feature::text("name"),
                Feature::links("capabilities", CAPABILITIES, 0, UNLIMITED),
            ],
            subclasses: &[],
        },
        Class {
            header: "Functionality",
            feature: "functionalities",
            min_count: 1,
            title: 3,
            features: &[
                Feature::text("permissions"),
                Feature::text("technology"),
                Feature::text("environment"),
                Feature::text("description"),
                Feature::text("algorithm"),
                Feature::opposite("activities", ACTIVITIES, 1),
            ],
            subclasses: &[],
        },
    ],
};

impl TypedModel for SystemRoles {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &ModelInstance) -> SystemRoles {
        SystemRoles {
            activities: instance.of(ACTIVITIES).iter().map(activity).collect(),
            capabilities: instance.of(CAPABILITIES).iter().map(capability).collect(),
            roles: instance.of(ROLES).iter().map(role).collect(),
            functionalities: instance.of(FUNCTIONALITIES).iter().map(functionality).collect(),
        }
    }

    fn to_instance(&self) -> ModelInstance {
        ModelInstance {
            objects: vec![
                self.activities.iter().map(activity_object).collect(),
                self.capabilities.iter().map(capability_object).collect(),
                self.roles.iter().map(role_object).collect(),
                self.functionalities.iter().map(functionality_object).collect(),
            ],
        }
    }
}

fn activity(object: &Object) -> RoleActivity {
    RoleActivity {
        name: object.text(0),
        functionality: object.links(1).first().copied(),
        position: object.position,
    }
}

fn activity_object(activity: &RoleActivity) -> Object {
    let functionality = FeatureValue::Links(activity.functionality.into_iter().collect());
    Object::new(vec![FeatureValue::Text(activity.name.clone()), functionality], activity.position)
}

fn capability(object: &Object) -> Capability {
    let activities = object.links(1).to_vec();
    Capability { name: object.text(0), activities, description: object.text(2), position: object.position }
}

fn capability_object(capability: &Capability) -> Object {
    let (name, description) = (capability.name.clone(), capability.description.clone());
    let activities = FeatureValue::Links(capability.activities.clone());
    Object::new(
        vec![FeatureValue::Text(name), activities, FeatureValue::Text(description)],
        capability.position,
    )
}

fn role(object: &Object) -> Role {
    Role {
        activities: object.links(0).to_vec(),
        liveness: object.text(1),
        name: object.text(2),
        capabilities: object.links(3).to_vec(),
        position: object.position,
        liveness_position: object.value_position(1),
    }
}

fn role_object(role: &Role) -> Object {
    let texts = [&role.liveness, &role.name].map(|text| FeatureValue::Text(text.clone()));
    let [liveness, name] = texts;
    let (activities, capabilities) = (role.activities.clone(), role.capabilities.clone());
    Object::new(
        vec![FeatureValue::Links(activities), liveness, name, FeatureValue::Links(capabilities)],
        role.position,
    )
}

fn functionality(object: &Object) -> Functionality {
    Functionality {
        permissions: object.text(0),
        technology: object.text(1),
        environment: object.text(2),
        description: object.text(3),
        algorithm: object.text(4),
        position: object.position,
    }
}

fn functionality_object(it: &Functionality) -> Object {
    let texts = [&it.permissions, &it.technology, &it.environment, &it.description, &it.algorithm];
    let texts = texts.map(|text| FeatureValue::Text(text.clone()));
    Object::new(texts.into_iter().chain([FeatureValue::Derived]).collect(), it.position)
}
