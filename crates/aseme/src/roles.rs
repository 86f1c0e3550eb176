//! The System Roles Model of a whole system: its roles, what they can do, and by what that is done.
//!
//! A role that is written to be refined and run has a file of its own, which [`srm`](crate::srm) describes; here are all roles of a
//! system side by side, as the method's tools keep them.

use yase::expression::Place;

use crate::meta::{Class, Feature, Instance, MANY, Metamodel, Object, Typed, Value};

/// Roles, capabilities, activities and functionalities.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SystemRoles {
    /// What is done at a time.
    pub activities: Vec<Activity>,
    /// Activities that serve one goal.
    pub capabilities: Vec<Capability>,
    /// The roles.
    pub roles: Vec<Role>,
    /// By what activities are done.
    pub functionalities: Vec<Functionality>,
}

/// Something that is done at a time.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Activity {
    /// Its name.
    pub name: String,
    /// By what it is done, by its place in [`SystemRoles::functionalities`].
    pub functionality: Option<usize>,
    /// Where it stands.
    pub place: Place,
}

/// The ability to reach a goal.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Capability {
    /// Its name.
    pub name: String,
    /// The activities it consists of, by their places in [`SystemRoles::activities`].
    pub activities: Vec<usize>,
    /// What it is.
    pub description: String,
    /// Where it stands.
    pub place: Place,
}

/// A role: what an agent does.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Role {
    /// The activities of the role itself, by their places in [`SystemRoles::activities`].
    pub activities: Vec<usize>,
    /// Its formulas, one a line; the first is the role's own.
    pub liveness: String,
    /// Its name.
    pub name: String,
    /// What it is capable of, by places in [`SystemRoles::capabilities`].
    pub capabilities: Vec<usize>,
    /// Where it stands.
    pub place: Place,
    /// Where its formulas stand.
    pub liveness_place: Place,
}

/// By what activities are done: a library, a device, an algorithm.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Functionality {
    /// What it may use.
    pub permissions: String,
    /// What it is made with.
    pub technology: String,
    /// Where it runs.
    pub environment: String,
    /// What it is; it is called by that.
    pub description: String,
    /// How it works.
    pub algorithm: String,
    /// Where it stands.
    pub place: Place,
}

const ACTIVITIES: usize = 0;
const CAPABILITIES: usize = 1;
const ROLES: usize = 2;
const FUNCTIONALITIES: usize = 3;

static METAMODEL: Metamodel = Metamodel {
    word: "SRM",
    root: "SRMmodel",
    prefix: "SRM",
    namespaces: &["http://www.amcl.tuc.gr/aseme/metamodels/SRM"],
    classes: &[
        Class {
            word: "Activity",
            feature: "activities",
            least: 0,
            title: 0,
            features: &[Feature::text("name"), Feature::links("functionality", FUNCTIONALITIES, 1, 1)],
            subclasses: &[],
        },
        Class {
            word: "Capability",
            feature: "capabilities",
            least: 0,
            title: 0,
            features: &[
                Feature::text("name"),
                Feature::links("capability_activities", ACTIVITIES, 1, MANY)
                    .called("activities")
                    .once("activities"),
                Feature::text("description"),
            ],
            subclasses: &[],
        },
        Class {
            word: "Role",
            feature: "roles",
            least: 1,
            title: 2,
            features: &[
                Feature::links("role_activities", ACTIVITIES, 1, MANY)
                    .called("activities")
                    .once("activities"),
                Feature::formulas("liveness"),
                Feature::text("name"),
                Feature::links("capabilities", CAPABILITIES, 0, MANY),
            ],
            subclasses: &[],
        },
        Class {
            word: "Functionality",
            feature: "functionalities",
            least: 1,
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

impl Typed for SystemRoles {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &Instance) -> SystemRoles {
        SystemRoles {
            activities: instance.of(ACTIVITIES).iter().map(activity).collect(),
            capabilities: instance.of(CAPABILITIES).iter().map(capability).collect(),
            roles: instance.of(ROLES).iter().map(role).collect(),
            functionalities: instance.of(FUNCTIONALITIES).iter().map(functionality).collect(),
        }
    }

    fn to_instance(&self) -> Instance {
        Instance {
            objects: vec![
                self.activities.iter().map(activity_object).collect(),
                self.capabilities.iter().map(capability_object).collect(),
                self.roles.iter().map(role_object).collect(),
                self.functionalities.iter().map(functionality_object).collect(),
            ],
        }
    }
}

fn activity(object: &Object) -> Activity {
    Activity { name: object.text(0), functionality: object.links(1).first().copied(), place: object.place }
}

fn activity_object(activity: &Activity) -> Object {
    let functionality = Value::Links(activity.functionality.into_iter().collect());
    Object::new(vec![Value::Text(activity.name.clone()), functionality], activity.place)
}

fn capability(object: &Object) -> Capability {
    let activities = object.links(1).to_vec();
    Capability { name: object.text(0), activities, description: object.text(2), place: object.place }
}

fn capability_object(capability: &Capability) -> Object {
    let (name, description) = (capability.name.clone(), capability.description.clone());
    let activities = Value::Links(capability.activities.clone());
    Object::new(vec![Value::Text(name), activities, Value::Text(description)], capability.place)
}

fn role(object: &Object) -> Role {
    Role {
        activities: object.links(0).to_vec(),
        liveness: object.text(1),
        name: object.text(2),
        capabilities: object.links(3).to_vec(),
        place: object.place,
        liveness_place: object.place_of(1),
    }
}

fn role_object(role: &Role) -> Object {
    let texts = [&role.liveness, &role.name].map(|text| Value::Text(text.clone()));
    let [liveness, name] = texts;
    let (activities, capabilities) = (role.activities.clone(), role.capabilities.clone());
    Object::new(vec![Value::Links(activities), liveness, name, Value::Links(capabilities)], role.place)
}

fn functionality(object: &Object) -> Functionality {
    Functionality {
        permissions: object.text(0),
        technology: object.text(1),
        environment: object.text(2),
        description: object.text(3),
        algorithm: object.text(4),
        place: object.place,
    }
}

fn functionality_object(it: &Functionality) -> Object {
    let texts = [&it.permissions, &it.technology, &it.environment, &it.description, &it.algorithm];
    let texts = texts.map(|text| Value::Text(text.clone()));
    Object::new(texts.into_iter().chain([Value::Derived]).collect(), it.place)
}
